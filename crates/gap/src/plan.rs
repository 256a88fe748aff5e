//! Before measuring: which effects a planned experiment would show at their usual size, which it could not tell apart, and
//! which further sensor or other excitation would. The nominal model is driven by the planned inputs, and the slopes of its
//! signals with all hypotheses are weighed by the sensors' noise and accuracy; how much of one effect's trajectory another one's
//! could take over follows from their products.

use super::data::RecordingData;
use super::estimate::candidate::SensitivityProducts as Sums;
use super::estimate::{CandidateModel, ModelFit, SignalWeights};
use super::hypotheses::{Hypothesis, NetworkLocation, SensorSignal};
use super::policy::{ACCURACY, ALPHA, SEEN};
use super::problem::{DiagnosisProblem, HypothesisValues};
use super::select::models::{attached, beginnings};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// Usual sizes that an effect may have in the place of another.
const LARGEST: f64 = 30.0;
/// Samples at which a model shows whether it has values.
const FEWEST: usize = 8;
/// Samples looked at in all; more are counted, not run.
const SAMPLES: usize = 4000;
/// Further sensors that are weighed, at most.
const SENSORS: usize = 8;
/// A parameter that is out of tolerance is so many tolerances off.
const OUT: f64 = 3.0;
/// Noise of a further sensor as part of its range.
const NOISE: f64 = 3e-3;
/// Levels of a staircase and of a sequence of steps.
const LEVELS: usize = 8;

/// What a planned experiment would show.
#[derive(Clone, Debug, Serialize)]
pub struct ExperimentPlan {
    /// Version of this form.
    pub schema: u32,
    /// Every effect at every place with what it would gain at its usual size.
    pub hypotheses: Vec<EffectDetectability>,
    /// Pairs that could not be told apart: the first one is there, and the second explains it nearly as well.
    pub confused: Vec<EffectPair>,
    /// Other excitations of the same inputs over the same range and time.
    pub excitations: Vec<ExperimentChange>,
    /// Further sensors, one at a time.
    pub sensors: Vec<ExperimentChange>,
}

/// An effect at its usual size.
#[derive(Clone, Debug, Serialize)]
pub struct EffectDetectability {
    /// Its class.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Where.
    pub places: Vec<String>,
    /// What it would gain, nats.
    pub nats: f64,
}

/// Two effects, as numbers into [`ExperimentPlan::hypotheses`].
#[derive(Clone, Debug, Serialize)]
pub struct EffectPair {
    /// The one that is there.
    pub there: usize,
    /// The one that stands in for it.
    pub instead: usize,
    /// How far the second is behind, nats.
    pub behind: f64,
}

/// What another excitation or a further sensor would change.
#[derive(Clone, Debug, Serialize)]
pub struct ExperimentChange {
    /// The excitation, or the variable that the sensor shows.
    pub what: String,
    /// Effects that would be seen.
    pub seen: usize,
    /// Of the confused pairs, how many it tells apart.
    pub separates: usize,
}

/// Weighs the plan, which stands in the problem as simulated train recordings. `None` where the nominal model does not
/// reach their end.
pub fn plan(problem: &mut DiagnosisProblem<'_>, progress: &mut dyn FnMut(&str)) -> Option<ExperimentPlan> {
    progress("the plan");
    let planned = WhitenedProducts::new(problem)?;
    let hypotheses: Vec<EffectDetectability> =
        problem.hypotheses.iter().enumerate().map(|(i, h)| planned.seen(h, i)).collect();
    let confused = planned.confused();
    let change = |what: String, products: &WhitenedProducts| ExperimentChange {
        what,
        seen: (0..hypotheses.len()).filter(|&h| products.nats(h) > SEEN).count(),
        separates: confused.iter().filter(|p| products.behind(p.there, p.instead) > certain()).count(),
    };
    let measured = problem.train.clone();
    let mut excitations = Vec::new();
    for (name, trajectory) in EXCITATIONS {
        progress(name);
        if excite(problem, &measured[0], trajectory).is_some()
            && let Some(products) = WhitenedProducts::new(problem)
        {
            excitations.push(change(name.to_string(), &products));
        }
    }
    problem.train = measured;
    let mut sensors = Vec::new();
    for signal in further(problem) {
        progress(&signal.variable);
        if let Some(products) = with_sensor(problem, &signal) {
            sensors.push(change(signal.variable, &products));
        }
    }
    let order = |all: &mut Vec<ExperimentChange>| all.sort_by_key(|c| std::cmp::Reverse((c.separates, c.seen)));
    order(&mut excitations);
    order(&mut sensors);
    Some(ExperimentPlan { schema: 1, hypotheses, confused, excitations, sensors })
}

/// Products of the whitened columns of all hypotheses, what tolerances can take over taken out.
struct WhitenedProducts {
    gram: DMatrix<f64>,
    /// Per hypothesis its variants: columns, and the size of each coefficient.
    variants: Vec<Vec<(Range<usize>, Vec<f64>)>>,
}

impl WhitenedProducts {
    fn new(problem: &DiagnosisProblem<'_>) -> Option<Self> {
        // what is there as a whole or not at all would change the model for all others
        let vanishes = |h: &Hypothesis| h.coefficients.iter().all(|c| c.whole().is_none());
        let attachable = |h: &Hypothesis| h.family != "parameter" && !h.changes_order && !h.is_shape() && vanishes(h);
        let chosen: Vec<HypothesisValues> = (0..problem.hypotheses.len())
            .filter(|&i| attachable(&problem.hypotheses[i]))
            .flat_map(|hypothesis| {
                let all = beginnings(&problem.hypotheses[hypothesis]).into_iter();
                all.map(move |values| HypothesisValues { hypothesis, values })
            })
            .collect();
        let model = joined(problem, chosen)?;
        let tolerances = problem.tolerances.len();
        let mut variants = vec![Vec::new(); problem.hypotheses.len()];
        let mut first = tolerances;
        for (c, places) in model.causes.iter().zip(&model.model.attached) {
            let of_cause = |k: &usize| places.contains(&model.coordinates[*k].parameter);
            let count = (first..model.coordinates.len()).take_while(of_cause).count();
            variants[c.hypothesis].push((first..first + count, vec![1.0; count]));
            first += count;
        }
        for (i, h) in problem.hypotheses.iter().enumerate().filter(|(_, h)| h.family == "parameter") {
            let name = &h.attachments[0].place.place;
            let place = problem.tolerances.iter().position(|t| t.name == *name);
            variants[i].extend(place.map(|t| (t..t + 1, vec![OUT])));
        }
        let gram = without_tolerances(&gram(problem, model)?, tolerances)?;
        Some(WhitenedProducts { gram, variants })
    }

    fn seen(&self, h: &Hypothesis, index: usize) -> EffectDetectability {
        let places = h.places().iter().map(|p: &&NetworkLocation| p.place.clone()).collect();
        EffectDetectability { effect: h.effect.clone(), family: h.family.clone(), places, nats: self.nats(index) }
    }

    /// Nats that a hypothesis gains at its usual size, in the variant that shows most.
    fn nats(&self, h: usize) -> f64 {
        self.variants[h].iter().map(|v| 0.5 * self.square(v)).fold(0.0, f64::max)
    }

    fn square(&self, (columns, sizes): &(Range<usize>, Vec<f64>)) -> f64 {
        let own = self.gram.view((columns.start, columns.start), (sizes.len(), sizes.len()));
        let d = DVector::from_column_slice(sizes);
        d.dot(&(own * &d)).max(0.0)
    }

    /// Nats by which the best variant of one effect is behind another that is there at its usual size.
    fn behind(&self, there: usize, instead: usize) -> f64 {
        let Some(v) = self.variants[there].iter().max_by(|a, b| self.square(a).total_cmp(&self.square(b))) else {
            return f64::INFINITY;
        };
        let (columns, sizes) = v;
        let (d, all) = (DVector::from_column_slice(sizes), self.square(v));
        let taken = |(others, most): &(Range<usize>, Vec<f64>)| {
            let k = most.len();
            let cross = self.gram.view((others.start, columns.start), (k, sizes.len())) * &d;
            let mut own = self.gram.view((others.start, others.start), (k, k)).clone_owned();
            (0..k).for_each(|i| own[(i, i)] += (LARGEST * most[i]).powi(-2));
            own.cholesky().map_or(0.0, |f| cross.dot(&f.solve(&cross)))
        };
        let best = self.variants[instead].iter().map(taken).fold(0.0, f64::max);
        if best > 0.0 { 0.5 * (all - best).max(0.0) } else { f64::INFINITY }
    }

    /// All pairs of effects of which the first would be seen and the second explains it nearly as well.
    fn confused(&self) -> Vec<EffectPair> {
        let count = self.variants.len();
        let mut found = Vec::new();
        for there in (0..count).filter(|&h| self.nats(h) > SEEN) {
            for instead in (0..count).filter(|&h| h != there) {
                let behind = self.behind(there, instead);
                if behind < certain() {
                    found.push(EffectPair { there, instead, behind });
                }
            }
        }
        found.sort_by(|a, b| a.behind.total_cmp(&b.behind));
        found
    }
}

/// A model with all hypotheses that can be attached together: where all cannot, halves of halves are tried.
fn joined(problem: &DiagnosisProblem<'_>, chosen: Vec<HypothesisValues>) -> Option<CandidateModel> {
    let model = |chosen: &[HypothesisValues]| {
        let model = attached(problem, chosen, None, 0, 0).ok()?;
        // what is compiled may have no values where it begins
        let first = beginning(problem.train.first()?, FEWEST);
        model.errors(&model.present(), &first, Some(0)).map(|_| model)
    };
    fn fitting(
        joins: &dyn Fn(&[HypothesisValues]) -> bool,
        mut chosen: Vec<HypothesisValues>,
    ) -> Vec<HypothesisValues> {
        if joins(&chosen) || chosen.is_empty() {
            return chosen;
        }
        if chosen.len() == 1 {
            return Vec::new();
        }
        let right = chosen.split_off(chosen.len() / 2);
        let mut fine = fitting(joins, chosen);
        fine.extend(fitting(joins, right));
        fine
    }
    model(&fitting(&|chosen| model(chosen).is_some(), chosen))
}

/// Products of the slopes of all coordinates over the train recordings.
fn gram(problem: &DiagnosisProblem<'_>, model: CandidateModel) -> Option<DMatrix<f64>> {
    let all: usize = problem.train.iter().map(RecordingData::len).sum();
    let each = (SAMPLES / problem.train.len().max(1)).max(FEWEST);
    let used: Vec<RecordingData> = problem.train.iter().map(|r| beginning(r, each)).collect();
    let square = |(n, f): (&f64, &f64)| n * n + (ACCURACY * f).powi(2);
    let square = problem.noise_floor.iter().zip(&problem.full_scale).map(square).collect();
    let weights = SignalWeights { square, tau: vec![1.0; problem.signals.len()] };
    let x = model.present();
    let evaluated = model.evaluate(&x, &used)?;
    let Sums { slopes, .. } = ModelFit { candidate: model, x, evaluated, weights }.sums(|_, _| true);
    let seen: usize = used.iter().map(RecordingData::len).sum();
    Some(slopes * (all as f64 / seen.max(1) as f64))
}

/// The first samples of a recording.
fn beginning(r: &RecordingData, samples: usize) -> RecordingData {
    let first = |values: &Arc<[f64]>| -> Arc<[f64]> { values[..samples.min(values.len())].into() };
    RecordingData {
        times: first(&r.times),
        inputs: r.inputs.iter().map(first).collect(),
        linear: r.linear.clone(),
        signals: r.signals.iter().map(first).collect(),
    }
}

/// Nats from which one effect is told from another.
fn certain() -> f64 {
    (1.0 / ALPHA).ln()
}

/// Takes out of all columns what the tolerances, each within its own, explain: G - C (T + 1)^-1 C', in units of them.
fn without_tolerances(gram: &DMatrix<f64>, count: usize) -> Option<DMatrix<f64>> {
    let mut own = gram.view((0, 0), (count, count)).clone_owned();
    (0..count).for_each(|i| own[(i, i)] += 1.0);
    let cross = gram.rows(0, count).clone_owned();
    let solved = own.cholesky()?.solve(&cross);
    Some(gram - cross.tr_mul(&solved))
}

/// A trajectory over the time from 0 to 1, with values from 0 to 1.
type ExcitationProfile = fn(f64) -> f64;

const EXCITATIONS: [(&str, ExcitationProfile); 5] =
    [("steps", steps), ("slow triangle", triangle), ("chirp", chirp), ("staircase", staircase), ("hold", |_| 0.75)];

/// Levels in an order that makes steps of all sizes.
fn steps(t: f64) -> f64 {
    let order = [0.5, 1.0, 0.25, 0.75, 0.0, 0.6, 0.1, 0.9];
    order[((t * 2.0 * LEVELS as f64) as usize) % LEVELS]
}

fn triangle(t: f64) -> f64 {
    1.0 - (2.0 * t - 1.0).abs()
}

/// From two periods in the whole time up to eighty times as fast.
fn chirp(t: f64) -> f64 {
    let ratio: f64 = 80.0;
    0.5 + 0.5 * (std::f64::consts::TAU * 2.0 * (ratio.powf(t) - 1.0) / ratio.ln()).sin()
}

fn staircase(t: f64) -> f64 {
    (triangle(t) * LEVELS as f64).floor() / LEVELS as f64
}

/// Drives the inputs that the plan moves with another trajectory over the same range, alone.
fn excite(problem: &mut DiagnosisProblem<'_>, planned: &RecordingData, trajectory: ExcitationProfile) -> Option<()> {
    let (t0, count) = (planned.times[0], planned.len());
    let span = planned.times[count - 1] - t0;
    let drive = |samples: &Arc<[f64]>| -> Arc<[f64]> {
        let (low, high) = ends(samples);
        if high > low {
            planned.times.iter().map(|t| low + (high - low) * trajectory((t - t0) / span)).collect()
        } else {
            samples.clone()
        }
    };
    let inputs = planned.inputs.iter().map(drive).collect();
    problem.train = vec![RecordingData { inputs, ..planned.clone() }];
    problem.show()
}

/// Least and greatest of some values.
fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
}

/// Potentials that nothing measures yet, one a node.
fn further(problem: &DiagnosisProblem<'_>) -> Vec<SensorSignal> {
    let measured: BTreeSet<&str> = problem.signals.iter().map(|s| s.variable.as_str()).collect();
    let mut found = Vec::new();
    for node in problem.circuit.nodes.iter().filter(|n| !n.fixed) {
        let names = node.ports.iter().map(|&p| {
            let port = &problem.circuit.ports[p];
            format!("{}.{}", port.name, port.potential.name)
        });
        let names: Vec<String> = names.collect();
        if let Some(first) = names.first()
            && !names.iter().any(|n| measured.contains(n.as_str()))
        {
            found.push(SensorSignal { name: first.clone(), variable: first.clone(), scale: 1.0 });
        }
    }
    let values = problem.observe(&found).unwrap_or_default();
    let mut moving: Vec<SensorSignal> = Vec::new();
    let mut trajectories: Vec<Vec<f64>> = problem.observe(&problem.signals).unwrap_or_default();
    for (signal, trajectory) in found.into_iter().zip(values) {
        let (low, high) = ends(&trajectory);
        let alike = |other: &Vec<f64>| other.iter().zip(&trajectory).all(|(a, b)| (a - b).abs() <= 1e-6 * (high - low));
        if high > low && !trajectories.iter().any(alike) {
            moving.push(SensorSignal { scale: high - low, ..signal });
            trajectories.push(trajectory);
        }
    }
    moving.truncate(SENSORS);
    moving
}

fn with_sensor(problem: &mut DiagnosisProblem<'_>, signal: &SensorSignal) -> Option<WhitenedProducts> {
    problem.signals.push(signal.clone());
    problem.noise_floor.push(NOISE * signal.scale);
    problem.full_scale.push(signal.scale);
    let products = problem.show().and_then(|()| WhitenedProducts::new(problem));
    problem.signals.pop();
    problem.noise_floor.pop();
    problem.full_scale.pop();
    problem.show()?;
    products
}

impl ExperimentPlan {
    /// The plan in words, for people.
    pub fn words(&self) -> String {
        let seen = self.hypotheses.iter().filter(|h| h.nats > SEEN).count();
        let name = |i: usize| {
            let h = &self.hypotheses[i];
            format!("{} at {}", h.effect, h.places.join(" + "))
        };
        let mut text = format!(
            "Of {} effects {seen} would be seen at their usual size. {} pairs could not be separated{}\n",
            self.hypotheses.len(),
            self.confused.len(),
            if self.confused.is_empty() { "." } else { ":" },
        );
        for p in self.confused.iter().take(SHOWN) {
            text.push_str(&format!(
                "  {}, if it is there, or {} ({:.1} nats behind)\n",
                name(p.there),
                name(p.instead),
                p.behind
            ));
        }
        if self.confused.len() > SHOWN {
            text.push_str(&format!("  and {} more\n", self.confused.len() - SHOWN));
        }
        for (what, changes) in [("excitation", &self.excitations), ("further sensor", &self.sensors)] {
            for c in changes {
                text.push_str(&format!(
                    "{what} {}: separates {} of them, shows {} effects\n",
                    c.what, c.separates, c.seen
                ));
            }
        }
        text
    }
}

/// Pairs that are shown in words.
const SHOWN: usize = 12;
