//! What the search came to, said as a verdict.

use super::super::data::Recording;
use super::super::figures::{self, Left};
use super::super::filter::Setting;
use super::super::held;
use super::super::hypotheses::{Hypothesis, Site};
use super::super::locate::Located;
use super::super::problem::{Chosen, Problem, Tolerance};
use super::super::recording::Gross;
use super::super::screen::Accepted;
use super::super::verdict as v;
use super::super::verdict::{alternative, ratio, spots};
use super::refine::fitted;
use super::{Search, Shaped, driven};
use std::collections::BTreeMap;

/// Evidence for any place from which something is left, nats.
const NOTICED: f64 = 30.0;
/// Share of independent samples from which the filter's innovations are white.
const WHITE: f64 = 0.5;
/// Evidence for a place at which a gap counts as located, nats.
const LOCATED: f64 = 100.0;
/// The three models whose gaps are compared, and those for what each effect closes.
pub(super) struct Conclusion<'a> {
    pub problem: &'a Problem<'a>,
    pub search: &'a Search,
}

impl Conclusion<'_> {
    /// `held` is read here and nowhere before.
    pub fn verdict(&self, held: &[Recording], seconds: f64) -> v::Verdict {
        let s = self.search;
        let problem = self.problem;
        let held = if held.is_empty() { &problem.train[..] } else { held };
        let nominal = self.nominal();
        let models = [&nominal, &s.base.setting, &s.last.setting];
        let on_held = models.map(|f| held::simulate_all(f, held));
        let left_of_held = on_held.each_ref().map(|runs| Left::new(runs, held));
        let left_of_train = models.map(|f| Left::new(&held::simulate_all(f, &problem.train), &problem.train));
        let noise = &s.last.setting.noise;
        let [n, _, e] = on_held.each_ref().map(|runs| held::gap(runs, held, noise, &problem.full_scale));
        let measurable = n.total > 2.0 * n.error && n.total > 0.0;
        let [nominal_total, tolerated, effects_total] =
            left_of_held.each_ref().map(|l| l.total(&problem.full_scale).filter(|_| measurable));
        let share = ratio(effects_total, nominal_total);
        let open = figures::open(problem, &left_of_held[2], held);
        // a slow error of one sensor is a disturbance whose colour is another: what has a name would have been named
        let physical =
            |l: &&Located| !matches!(problem.disturbances[l.disturbance].attachments[0].site, Site::Sensor(_));
        let located = s.left.iter().find(physical);
        let of_sensor = s.left.iter().filter(|l| !physical(l)).map(|l| l.evidence).fold(0.0, f64::max);
        let place = located.filter(|l| l.evidence > LOCATED.max(of_sensor) && share.is_none_or(|s| s > 0.1));
        // what several times the noise leaves open is something, even where no place stands out; disturbances that the
        // filter follows as it should leave as much
        let followed = s.base.share > WHITE && s.left.iter().all(|l| l.evidence < NOTICED);
        let plain = share.is_some_and(|share| share > 0.1) && e.is_plain(noise, &problem.full_scale) && !followed;
        let outside = s.accepted.is_empty() && (place.is_some() || plain || s.shape.is_some());
        let verdict = match () {
            () if !s.gross.is_empty() => "recording_error",
            () if !s.accepted.is_empty() => "effects",
            () if outside => "outside_library",
            () if !open.is_empty() => "gap_open",
            () if s.visible < 0.2 => "undecidable",
            () => "nothing_found",
        };
        v::Verdict {
            schema: 1,
            verdict,
            noise: self.by_signal(&s.last.setting.noise),
            assumed: problem.tolerances.iter().filter(|t| t.assumed).map(|t| (t.name.clone(), t.sigma)).collect(),
            recording: self.gross(),
            places: self.places(&s.places),
            effects: self.effects(held, [&left_of_held[1], &left_of_held[2]]),
            drifts: self.drifts(),
            gap: v::Gaps {
                held: figures::side(problem, left_of_held.each_ref(), held),
                train: figures::side(problem, left_of_train.each_ref(), &problem.train),
            },
            closed: share.map(|s| 1.0 - s),
            closed_by_effects: ratio(effects_total, tolerated).map(|s| 1.0 - s),
            weighed: Vec::new(),
            unexplained: v::Unexplained {
                share,
                place: self.left_at(place),
                shape: s.shape.as_ref().map(|shape| vec![self.term(shape)]),
            },
            open,
            next_experiment: self.next_experiment(verdict),
            seconds,
        }
    }

    /// Where something is left: at the place of its shape, or where a source is needed.
    fn left_at(&self, located: Option<&Located>) -> Option<String> {
        let of_shape = self.search.shape.as_ref().map(|s| &self.problem.hypotheses[s.hypothesis]);
        let of_source = located.map(|l| &self.problem.disturbances[l.disturbance]);
        of_shape.or(of_source).map(|h| h.attachments[0].place.place.clone())
    }

    fn term(&self, shape: &Shaped) -> v::Term {
        let effect = self.problem.hypotheses[shape.hypothesis].attachments[0].effect.as_ref();
        v::Term { term: effect.map_or_else(String::new, |e| e.description.clone()), r2: shape.closes }
    }

    fn gross(&self) -> Vec<v::RecordingError> {
        let error = |g: &Gross| v::RecordingError {
            file: self.problem.files[g.recording].clone(),
            signal: self.problem.signals[g.signal].name.clone(),
            error: g.error,
            value: g.value,
        };
        self.search.gross.iter().map(error).collect()
    }

    fn next_experiment(&self, verdict: &str) -> Option<String> {
        let ambiguous = self.search.found.iter().any(|f| !f.alternatives.is_empty());
        match verdict {
            "undecidable" => Some(
                "more excitation: steps of the inputs over their whole range, then slow triangles through zero".into(),
            ),
            "effects" if ambiguous => Some(v::PARTING.into()),
            _ => None,
        }
    }

    /// The model as the study gives it.
    pub fn nominal(&self) -> Setting {
        let model = &self.search.base_model;
        let mut setting =
            model.setting(&self.search.base.setting.sources_times(0.0), &self.search.last.setting.noise, Vec::new());
        for (i, t) in self.problem.tolerances.iter().enumerate() {
            setting.theta[i] = t.nominal;
        }
        setting
    }

    /// The raw gap of a model, of full scale; `None` where a run stops early.
    fn total(&self, setting: &Setting, recordings: &[Recording]) -> Option<f64> {
        Left::new(&held::simulate_all(setting, recordings), recordings).total(&self.problem.full_scale)
    }

    fn by_signal(&self, values: &[f64]) -> BTreeMap<String, f64> {
        self.problem.signals.iter().zip(values).map(|(s, v)| (s.name.clone(), *v)).collect()
    }

    fn places(&self, places: &[Located]) -> Vec<v::Located> {
        // the place of a shape is better known than that of a source without any
        let shape = self.search.shape.iter().map(|s| (&self.problem.hypotheses[s.hypothesis], s.gain));
        let place = |h: &Hypothesis| h.attachments[0].place.place.clone();
        let shaped: Vec<String> = shape.clone().map(|(h, _)| place(h)).collect();
        let sources = places
            .iter()
            .map(|l| (&self.problem.disturbances[l.disturbance], l.evidence))
            .filter(|(h, _)| !shaped.contains(&place(h)));
        let all: Vec<(&Hypothesis, f64)> = shape.chain(sources).filter(|(_, evidence)| *evidence > 0.0).collect();
        let total: f64 = all.iter().map(|(_, evidence)| evidence).sum();
        let located = |(h, evidence): &(&Hypothesis, f64)| {
            let place = &h.attachments[0].place;
            v::Located {
                place: place.place.clone(),
                node: place.node.clone(),
                kind: place.kind.word(),
                evidence: *evidence,
                share: evidence / total,
            }
        };
        all.iter().map(located).collect()
    }

    /// `left` is what parameters within tolerances, and the effects with them, leave of the held recordings.
    fn effects(&self, held: &[Recording], left: [&Left; 2]) -> Vec<v::Effect> {
        let s = self.search;
        let [tolerated, full] = left.map(|l| l.total(&self.problem.full_scale));
        let tolerated = tolerated.unwrap_or(0.0);
        let mut gaps = BTreeMap::new();
        (0..s.accepted.len())
            .map(|i| {
                let (alone, last) = self.closing(i, held, tolerated, full, &mut gaps);
                let h = self.hypothesis(&s.accepted[i].chosen);
                let found = &s.found[i];
                v::Effect {
                    effect: h.effect.clone(),
                    family: h.family.clone(),
                    places: spots(h),
                    evidence: found.gain,
                    t: found.t,
                    closes_alone: alone,
                    closes_last: last,
                    parameters: self.estimates(i, h),
                    indistinguishable: found
                        .alternatives
                        .iter()
                        .map(|(c, behind)| alternative(self.hypothesis(c), *behind))
                        .collect(),
                }
            })
            .collect()
    }

    fn hypothesis(&self, chosen: &Chosen) -> &Hypothesis {
        &self.problem.hypotheses[chosen.hypothesis]
    }

    /// What an effect closes alone, and what opens again without it, of the gap within tolerances. `gaps` keeps those of sets
    /// of effects: of two, each alone is the other one left out.
    fn closing(
        &self,
        i: usize,
        held: &[Recording],
        tolerated: f64,
        full: Option<f64>,
        gaps: &mut BTreeMap<Vec<usize>, Option<f64>>,
    ) -> (v::Maybe, v::Maybe) {
        let s = self.search;
        if tolerated <= 0.0 {
            return (None, None);
        }
        if s.accepted.len() == 1 {
            let closes = full.map(|full| 1.0 - full / tolerated);
            return (closes, closes);
        }
        let found = |set: &[usize]| {
            let accepted: Vec<Accepted> = set.iter().map(|&k| s.accepted[k].clone()).collect();
            let (fit, _) = fitted(self.problem, &s.base, &accepted)?;
            self.total(&driven::simulating(self.problem, fit).setting, held)
        };
        let mut gap = |set: Vec<usize>| *gaps.entry(set.clone()).or_insert_with(|| found(&set));
        let alone = gap(vec![i]).map(|g| 1.0 - g / tolerated);
        let without = gap((0..s.accepted.len()).filter(|k| *k != i).collect());
        (alone, without.zip(full).map(|(g, full)| (g - full) / tolerated))
    }

    fn estimates(&self, i: usize, h: &Hypothesis) -> BTreeMap<String, v::Estimate> {
        let s = self.search;
        let places = &s.last_model.attached[i];
        let names =
            h.coefficients.iter().map(|c| (&c.name, &c.unit)).chain(h.shapes.iter().map(|s| (&s.name, &s.unit)));
        let estimate = |(&place, (name, unit)): (&usize, (&String, &String))| {
            let prior = s.last.priors.iter().position(|p| p.parameter == place);
            let std = prior.map_or(0.0, |k| s.last.deviation(k));
            (name.clone(), v::Estimate { value: s.last.setting.theta[place], std, unit: unit.clone() })
        };
        places.iter().zip(names).map(estimate).collect()
    }

    fn drifts(&self) -> Vec<v::Drift> {
        let fit = &self.search.last;
        let drift = |(i, t): (usize, &Tolerance)| {
            let value = fit.setting.theta[i];
            v::Drift {
                parameter: t.name.clone(),
                nominal: t.nominal,
                value,
                std: fit.deviation(i),
                tolerances: (value - t.nominal) / t.sigma,
            }
        };
        self.problem.tolerances.iter().enumerate().map(drift).collect()
    }
}
