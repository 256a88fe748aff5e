//! Predictions before measuring: what a planned experiment would show.
//!
//! It answers which effects would be seen at their usual size, which could not be told apart, and which further sensor
//! or other excitation would help. Enters: a problem whose train recordings are simulated with the planned inputs.
//! Leaves: an [`ExperimentPlan`]. The sensitivities of the signals to all hypotheses are weighted by the sensors' noise
//! and accuracy. From their products follows how much of one effect's trajectory another effect could take over.

use super::data::RecordingData;
use super::estimate::candidate::SensitivityProducts as Sums;
use super::estimate::{CandidateModel, ModelFit, SignalWeights};
use super::hypotheses::{Hypothesis, NetworkLocation, SensorSignal};
use super::problem::{DiagnosisProblem, HypothesisValues};
use super::select::models::{attached, beginnings};
use crate::policy::{ACCURACY, ALPHA, SEEN};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// Usual sizes that an effect may have when it stands in for another one.
const LARGEST: f64 = 30.0;
/// Samples over which a joined model is tested for values.
const FEWEST: usize = 8;
/// Most samples that are simulated; the result is scaled up to all of them.
const SAMPLES: usize = 4000;
/// Most further sensors that are tried.
const SENSORS: usize = 8;
/// Deviation of a parameter out of tolerance, in tolerances.
const OUT: f64 = 3.0;
/// Noise of a further sensor as part of its range.
const NOISE: f64 = 3e-3;
/// Levels of a staircase and of a sequence of steps.
const LEVELS: usize = 8;

/// What a planned experiment would show.
#[derive(Clone, Debug, Serialize)]
pub struct ExperimentPlan {
    /// Version of this layout.
    pub schema: u32,
    /// Every hypothesis with what it would gain at its usual size.
    pub hypotheses: Vec<EffectDetectability>,
    /// Pairs that could not be told apart, the closest first.
    pub confused: Vec<EffectPair>,
    /// Other excitations of the same inputs over the same range and time, the most useful first.
    pub excitations: Vec<ExperimentChange>,
    /// Further sensors, one at a time, the most useful first.
    pub sensors: Vec<ExperimentChange>,
}

/// A hypothesis and what it would gain.
#[derive(Clone, Debug, Serialize)]
pub struct EffectDetectability {
    /// Class of the effect.
    pub effect: String,
    /// Family of the effect.
    pub family: String,
    /// Its places.
    pub places: Vec<String>,
    /// Evidence at its usual size, nats.
    pub nats: f64,
}

/// Two effects that could be confused, as indices into [`ExperimentPlan::hypotheses`].
#[derive(Clone, Debug, Serialize)]
pub struct EffectPair {
    /// The one that is missing in the model.
    pub there: usize,
    /// The one that explains nearly as much.
    pub instead: usize,
    /// How far the second is behind, nats.
    pub behind: f64,
}

/// What another excitation or a further sensor would change.
#[derive(Clone, Debug, Serialize)]
pub struct ExperimentChange {
    /// Name of the excitation, or the variable that the sensor measures.
    pub what: String,
    /// Number of effects that would be seen.
    pub seen: usize,
    /// Number of the confused pairs that could be told apart.
    pub separates: usize,
}

/// Evaluates a plan. `progress` is called with the name of each part. `None` if a simulation of the nominal model stops
/// early. The problem has its planned recordings again at the end.
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
    // the sensors are tried with the planned inputs again
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

/// Products of the whitened sensitivities of all hypotheses, without what tolerance parameters can take over.
struct WhitenedProducts {
    /// Products, columns by columns, in squared deviations.
    gram: DMatrix<f64>,
    /// Per hypothesis its variants: range of columns, and the usual size of each coefficient in units of its
    /// coordinate.
    variants: Vec<Vec<(Range<usize>, Vec<f64>)>>,
}

impl WhitenedProducts {
    /// Products for the train recordings of a problem. `None` if the model cannot be simulated.
    fn new(problem: &DiagnosisProblem<'_>) -> Option<Self> {
        // a share of a whole changes the model for all others when it is attached
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
        // a parameter uses the column of its tolerance
        for (i, h) in problem.hypotheses.iter().enumerate().filter(|(_, h)| h.family == "parameter") {
            let name = &h.attachments[0].place.place;
            let place = problem.tolerances.iter().position(|t| t.name == *name);
            variants[i].extend(place.map(|t| (t..t + 1, vec![OUT])));
        }
        let gram = without_tolerances(&gram(problem, model)?, tolerances)?;
        Some(WhitenedProducts { gram, variants })
    }

    /// The entry of a hypothesis in the plan.
    fn seen(&self, h: &Hypothesis, index: usize) -> EffectDetectability {
        let places = h.places().iter().map(|p: &&NetworkLocation| p.place.clone()).collect();
        EffectDetectability { effect: h.effect.clone(), family: h.family.clone(), places, nats: self.nats(index) }
    }

    /// Nats that a hypothesis gains at its usual size, in the variant that shows most.
    fn nats(&self, h: usize) -> f64 {
        self.variants[h].iter().map(|v| 0.5 * self.square(v)).fold(0.0, f64::max)
    }

    /// Squared norm of a variant at its usual size.
    fn square(&self, (columns, sizes): &(Range<usize>, Vec<f64>)) -> f64 {
        let own = self.gram.view((columns.start, columns.start), (sizes.len(), sizes.len()));
        let d = DVector::from_column_slice(sizes);
        d.dot(&(own * &d)).max(0.0)
    }

    /// Nats by which the best variant of `instead` is behind `there`, which is present at its usual size.
    /// Infinite if one of them has no variant. A substitute may have up to [`LARGEST`] usual sizes, as a prior.
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
            // a prior of its usual sizes keeps the substitute within reason
            (0..k).for_each(|i| own[(i, i)] += (LARGEST * most[i]).powi(-2));
            own.cholesky().map_or(0.0, |f| cross.dot(&f.solve(&cross)))
        };
        let best = self.variants[instead].iter().map(taken).fold(0.0, f64::max);
        if best > 0.0 { 0.5 * (all - best).max(0.0) } else { f64::INFINITY }
    }

    /// All pairs of which the first would be seen and the second explains it nearly as well.
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

/// A model with all hypotheses that can be attached together. If all cannot, halves of the list are tried.
/// `None` if even the rest cannot be simulated.
fn joined(problem: &DiagnosisProblem<'_>, chosen: Vec<HypothesisValues>) -> Option<CandidateModel> {
    let model = |chosen: &[HypothesisValues]| {
        let model = attached(problem, chosen, None, 0, 0).ok()?;
        // a model that compiles may still not be evaluable, so its first samples are simulated
        let first = beginning(problem.train.first()?, FEWEST);
        model.errors(&model.present(), &first, Some(0)).map(|_| model)
    };
    /// The largest sublist found by halving whose parts each join.
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

/// Products of the weighted sensitivities of all coordinates over the train recordings; `None` if a simulation stops
/// early. Tolerance parameters come first, then the columns of the hypotheses.
fn gram(problem: &DiagnosisProblem<'_>, model: CandidateModel) -> Option<DMatrix<f64>> {
    let all: usize = problem.train.iter().map(RecordingData::len).sum();
    let each = (SAMPLES / problem.train.len().max(1)).max(FEWEST);
    let used: Vec<RecordingData> = problem.train.iter().map(|r| beginning(r, each)).collect();
    // accuracy counts like noise: an error that repeats is no less an error
    let square = |(n, f): (&f64, &f64)| n * n + (ACCURACY * f).powi(2);
    let square = problem.noise_floor.iter().zip(&problem.full_scale).map(square).collect();
    let weights = SignalWeights { square, tau: vec![1.0; problem.signals.len()] };
    let x = model.present();
    let evaluated = model.evaluate(&x, &used)?;
    let Sums { slopes, .. } = ModelFit { candidate: model, x, evaluated, weights }.sums(|_, _| true);
    let seen: usize = used.iter().map(RecordingData::len).sum();
    // samples that were not simulated are assumed to say as much as the others
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

/// Nats from which on one effect is told from another.
fn certain() -> f64 {
    (1.0 / ALPHA).ln()
}

/// The products without what the tolerance parameters explain, each within its tolerance: G - C' (T + 1)^-1 C in units
/// of the tolerances. `None` if the system is singular.
fn without_tolerances(gram: &DMatrix<f64>, count: usize) -> Option<DMatrix<f64>> {
    let mut own = gram.view((0, 0), (count, count)).clone_owned();
    (0..count).for_each(|i| own[(i, i)] += 1.0);
    let cross = gram.rows(0, count).clone_owned();
    let solved = own.cholesky()?.solve(&cross);
    Some(gram - cross.tr_mul(&solved))
}

/// A trajectory over the time from 0 to 1, with values from 0 to 1.
type ExcitationProfile = fn(f64) -> f64;

/// Excitations that are tried, with their names.
const EXCITATIONS: [(&str, ExcitationProfile); 5] =
    [("steps", steps), ("slow triangle", triangle), ("chirp", chirp), ("staircase", staircase), ("hold", |_| 0.75)];

/// Levels in an order that makes steps of all sizes.
fn steps(t: f64) -> f64 {
    let order = [0.5, 1.0, 0.25, 0.75, 0.0, 0.6, 0.1, 0.9];
    order[((t * 2.0 * LEVELS as f64) as usize) % LEVELS]
}

/// A slow triangle: up in the first half, down in the second.
fn triangle(t: f64) -> f64 {
    1.0 - (2.0 * t - 1.0).abs()
}

/// A sine from two periods in the complete time up to eighty times that frequency.
fn chirp(t: f64) -> f64 {
    let ratio: f64 = 80.0;
    0.5 + 0.5 * (std::f64::consts::TAU * 2.0 * (ratio.powf(t) - 1.0) / ratio.ln()).sin()
}

/// A triangle in steps.
fn staircase(t: f64) -> f64 {
    (triangle(t) * LEVELS as f64).floor() / LEVELS as f64
}

/// Replaces the recordings by one in which the planned inputs that move follow another trajectory over the same range.
/// `None` if the simulation stops early.
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

/// Potentials that nothing measures yet, one per node, with their range as scale. At most [`SENSORS`].
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
        // a potential that moves like a known one would add nothing
        let alike = |other: &Vec<f64>| other.iter().zip(&trajectory).all(|(a, b)| (a - b).abs() <= 1e-6 * (high - low));
        if high > low && !trajectories.iter().any(alike) {
            moving.push(SensorSignal { scale: high - low, ..signal });
            trajectories.push(trajectory);
        }
    }
    moving.truncate(SENSORS);
    moving
}

/// Products with a further sensor; the problem is left as it was. `None` if a simulation stops early.
fn with_sensor(problem: &mut DiagnosisProblem<'_>, signal: &SensorSignal) -> Option<WhitenedProducts> {
    problem.signals.push(signal.clone());
    problem.noise_floor.push(NOISE * signal.scale);
    problem.full_scale.push(signal.scale);
    let products = problem.show().and_then(|()| WhitenedProducts::new(problem));
    // removed whether or not the products could be computed
    problem.signals.pop();
    problem.noise_floor.pop();
    problem.full_scale.pop();
    problem.show()?;
    products
}

impl ExperimentPlan {
    /// The plan as text for people.
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

/// Most pairs that the text lists.
const SHOWN: usize = 12;
