//! From the result of a search to the verdict.
//!
//! Enters: the problem, an [`EffectSearchResult`] and the held recordings. Leaves: a [`Verdict`]. Simulates the nominal
//! model, the one within tolerances and the corrected one on all recordings, and fits models with some of the effects
//! for the figures of what each effect closes. Called by `diagnose`.

use super::super::circuit::same_kind;
use super::super::clock::Deadline;
use super::super::data::RecordingData;
use super::super::estimate::CandidateModel;
use super::super::estimate::candidate::RecordingResiduals;
use super::super::figures::{self, GapFigures};
use super::super::hypotheses::{AttachmentSite, Hypothesis, SensorSignal};
use super::super::mistakes;
use super::super::problem::{DiagnosisProblem, HypothesisValues, SignalDisplayUnit, ToleranceParameter, through};
use super::super::select::choose::{AcceptedEffect, HypothesisTrial};
use super::super::select::models;
use super::super::select::search::EffectSearchResult;
use super::super::select::weighed::{CrossValidatedFit, at_nominal, weighed};
use super::{
    EXCITING, EffectFlow, GapSummary, MissingTerm, OptionalNumber, PARTING, ParameterDrift, ParameterEstimate,
    PlaceEvidence, RecordingError, UnexplainedGap, Verdict, VerdictEffect,
};
use super::{alternative, ratio, spots};
use crate::policy::VISIBLE;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Litres per minute in one cubic metre per second.
const LITRES_A_MINUTE: f64 = 60_000.0;

/// The verdict of a search that took `seconds`. Without held recordings the train recordings stand in for them.
pub fn conclude(
    problem: &DiagnosisProblem<'_>,
    found: &EffectSearchResult,
    held: &[RecordingData],
    seconds: f64,
) -> Verdict {
    let last = &found.last.fit;
    let conclusion = VerdictBuilder {
        problem,
        found,
        held: if held.is_empty() { &problem.train } else { held },
        own: held.is_empty(),
        // the rule of all estimates needs a run with sensitivities; if that stops early, the information matrix stands
        // in
        deviations: last.uncertainty(&problem.train).unwrap_or_else(|| last.deviations()),
    };
    conclusion.verdict(seconds)
}

/// Everything from which a verdict is made.
struct VerdictBuilder<'a> {
    /// What was diagnosed.
    problem: &'a DiagnosisProblem<'a>,
    /// Result of the search.
    found: &'a EffectSearchResult,
    /// Held recordings, or the train ones.
    held: &'a [RecordingData],
    /// There are no held recordings: `held` are the train recordings.
    own: bool,
    /// Standard deviation of each coordinate of the last model, in the coordinate's units.
    deviations: Vec<f64>,
}

impl VerdictBuilder<'_> {
    /// Builds the verdict. Three models are compared: the nominal one, the one within tolerances, and the one with all
    /// effects.
    fn verdict(&self, seconds: f64) -> Verdict {
        let (problem, found) = (self.problem, self.found);
        let base = &found.base.fit;
        let nominal = at_nominal(problem, &base.candidate, &base.x);
        let last = &found.last.fit;
        // the nominal model is the one within tolerances at its data sheet
        let models = [(&base.candidate, &nominal), (&base.candidate, &base.x), (&last.candidate, &last.x)];
        let on_held = models.map(|(c, x)| self.left(c, x));
        let on_train = models.map(|(c, x)| GapFigures::of(&errors(c, x, &problem.train, true)));
        let [first, tolerated, effects] = on_held.each_ref().map(|l| l.total(&problem.full_scale));
        let share = ratio(effects, first);
        let open = figures::open(problem, &on_held[2], self.held);
        let recording = self.recording();
        let named: Vec<VerdictEffect> = self.effects([&on_held[1], &on_held[2]]);
        // the order is part of the schema: the first that holds
        let verdict = match () {
            () if !recording.is_empty() => "recording_error",
            () if !named.is_empty() => "effects",
            () if found.shape.is_some() => "outside_library",
            () if !open.is_empty() || last.candidate.is_bent(&last.x) => "gap_open",
            () if found.visible < VISIBLE => "undecidable",
            () => "nothing_found",
        };
        let ambiguous = found.taken.iter().any(|t| !t.set.is_empty());
        Verdict {
            schema: 1,
            verdict,
            noise: problem.signals.iter().zip(&problem.noise_floor).map(|(s, n)| (s.name.clone(), *n)).collect(),
            assumed: problem.tolerances.iter().filter(|t| t.assumed).map(|t| (t.name.clone(), t.sigma)).collect(),
            recording,
            places: self.places(),
            effects: named,
            asked: found.asked.clone(),
            drifts: self.drifts(),
            gap: GapSummary {
                held: figures::side(problem, on_held.each_ref(), self.held),
                train: figures::side(problem, on_train.each_ref(), &problem.train),
            },
            closed: share.map(|s| 1.0 - s),
            closed_by_effects: ratio(effects, tolerated).map(|s| 1.0 - s),
            weighed: found.trials.iter().map(|t| self.weighed(t)).collect(),
            unexplained: self.unexplained(share),
            open,
            next_experiment: match verdict {
                "undecidable" => Some(EXCITING.into()),
                "effects" if ambiguous => Some(PARTING.into()),
                _ => None,
            },
            seconds,
        }
    }

    /// Figures of a model at the coordinates `x` on the held recordings, without noise subtracted.
    fn left(&self, candidate: &CandidateModel, x: &[f64]) -> GapFigures {
        GapFigures::of(&errors(candidate, x, self.held, self.own))
    }

    /// The hypothesis of chosen values.
    fn of(&self, chosen: &HypothesisValues) -> &Hypothesis {
        &self.problem.hypotheses[chosen.hypothesis]
    }

    /// The hypothesis of an accepted effect.
    fn hypothesis(&self, taken: &AcceptedEffect) -> &Hypothesis {
        &self.problem.hypotheses[taken.hypothesis]
    }

    /// What stays unexplained, with the place and form of an accepted shape. `share`: part of the nominal gap that is
    /// left.
    fn unexplained(&self, share: OptionalNumber) -> UnexplainedGap {
        let shape = self.found.shape.as_ref().map(|s| (s, self.hypothesis(s)));
        let term = |(taken, h): (&AcceptedEffect, &Hypothesis)| {
            let effect = h.attachments[0].effect.as_ref();
            MissingTerm { term: effect.map_or_else(String::new, |e| e.description.clone()), closes: taken.closes }
        };
        UnexplainedGap {
            share,
            place: shape.map(|(_, h)| h.attachments[0].place.place.clone()),
            shape: shape.map(|s| vec![term(s)]),
        }
    }

    /// Errors of the recordings: an entry for each file, also for errors that cannot be told from the accepted one.
    /// A wrong unit of a column is in every file of the study.
    fn recording(&self) -> Vec<RecordingError> {
        let named = self.found.taken.iter().filter(|t| self.hypothesis(t).is_recording_error());
        let with = |t: &AcceptedEffect| {
            let others = t.set.iter().map(|(c, _)| self.of(c)).filter(|h| h.is_recording_error());
            std::iter::once(self.hypothesis(t)).chain(others).collect::<Vec<_>>()
        };
        let mistakes: Vec<&Hypothesis> = named.flat_map(with).collect();
        let of_file = |h: &Hypothesis, file: &String| {
            let value = mistakes::factor(h);
            let error = if value < 0.0 { "sign" } else { "factor" };
            RecordingError { file: file.clone(), signal: h.attachments[0].place.place.clone(), error, value }
        };
        self.problem.files.iter().flat_map(|f| mistakes.iter().map(move |h| of_file(h, f))).collect()
    }

    /// Accepted effects with what each closes of the gap within tolerances. Errors of recordings are left out.
    /// The two figures are those of the model within tolerances and of the model with all effects, on held recordings.
    fn effects(&self, [tolerated, last]: [&GapFigures; 2]) -> Vec<VerdictEffect> {
        let total = |l: &GapFigures| l.total(&self.problem.full_scale);
        let (tolerated, full) = (total(tolerated), total(last));
        let taken = &self.found.taken;
        let flows = self.flows();
        let gaps = self.gaps_with(tolerated, full);
        let effect = |(i, t): (usize, &AcceptedEffect)| {
            let h = self.hypothesis(t);
            if h.is_recording_error() {
                return None;
            }
            // each model is fitted anew, so that other parameters can take over
            let (alone, without) = (gaps[&vec![i]], gaps[&without(i, taken.len())]);
            Some(VerdictEffect {
                effect: h.effect.clone(),
                family: h.family.clone(),
                description: h.attachments[0].effect.as_ref().map_or_else(String::new, |e| e.description.clone()),
                places: spots(h),
                flow: flows.get(&i).cloned(),
                evidence: t.evidence,
                t: t.t,
                closes_alone: ratio(alone, tolerated).map(|g| 1.0 - g),
                closes_last: without.zip(full).and_then(|(w, f)| ratio(Some(w - f), tolerated)),
                parameters: self.estimates(i, h),
                indistinguishable: t.set.iter().map(|(c, behind)| alternative(self.of(c), *behind)).collect(),
            })
        };
        taken.iter().enumerate().filter_map(effect).collect()
    }

    /// Held gaps of the models with each effect alone, and with all others, by the numbers of the effects that are
    /// kept. `tolerated` is the gap without any effect and `full` that with all; neither is computed again.
    fn gaps_with(&self, tolerated: OptionalNumber, full: OptionalNumber) -> BTreeMap<Vec<usize>, OptionalNumber> {
        let taken = &self.found.taken;
        let effects = (0..taken.len()).filter(|&i| !self.hypothesis(&taken[i]).is_recording_error());
        let kept: BTreeSet<Vec<usize>> = effects.flat_map(|i| [vec![i], without(i, taken.len())]).collect();
        let gap = |kept: Vec<usize>| {
            let gap = match kept.len() {
                0 => tolerated,
                all if all == taken.len() => full,
                _ => self.gap_with(&kept),
            };
            (kept, gap)
        };
        kept.into_par_iter().map(gap).collect()
    }

    /// What flows through each effect over the train recordings, by its number; none for signals and parameters.
    /// The model with all effects is simulated from its own start, with the fitted parameters.
    fn flows(&self) -> BTreeMap<usize, EffectFlow> {
        let fit = &self.found.last.fit;
        let causes = fit.causes();
        let through = |(i, c): (usize, &HypothesisValues)| Some((i, through(i, self.of(c))?));
        let (numbers, signals): (Vec<usize>, Vec<SensorSignal>) = causes.iter().enumerate().filter_map(through).unzip();
        if numbers.is_empty() {
            return BTreeMap::new();
        }
        let found = self.problem.observe_with(&causes, Some(&fit.tolerances()), &signals).unwrap_or_default();
        let flow = |(i, values): (usize, Vec<f64>)| {
            let interface = &self.of(&causes[i]).attachments[0].effect.as_ref()?.interface;
            let shown = self.spoken(&interface.through.as_ref()?.unit);
            let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt();
            // an effect through which nothing flows has no figure
            let known = largest.is_finite() && largest > 0.0;
            known.then(|| {
                (i, EffectFlow { largest: shown.value(largest), rms: shown.value(rms), unit: shown.unit.clone() })
            })
        };
        numbers.into_iter().zip(found).filter_map(flow).collect()
    }

    /// Unit in which a quantity is shown: that of a column of the same kind, else l/min for volume flows, else its own.
    /// `unit`: the unit as the model writes it.
    fn spoken(&self, unit: &str) -> SignalDisplayUnit {
        let own = self.problem.signals.iter().zip(&self.problem.shown);
        let alike = own.filter(|(s, _)| same_kind(&self.problem.unit(s), unit)).map(|(_, shown)| shown.clone());
        let usual =
            same_kind(unit, "m3/s").then(|| SignalDisplayUnit { unit: "l/min".into(), factor: LITRES_A_MINUTE });
        alike.chain(usual).next().unwrap_or(SignalDisplayUnit { unit: unit.into(), factor: 1.0 })
    }

    /// Held gap of the model with some of the effects, fitted anew; `None` if it cannot be simulated.
    /// `kept`: numbers of the effects. The fit has no deadline.
    fn gap_with(&self, kept: &[usize]) -> OptionalNumber {
        let all = self.found.last.fit.causes();
        let causes: Vec<HypothesisValues> = kept.iter().map(|&i| all[i].clone()).collect();
        let candidate =
            models::candidate(self.problem, &causes, Some(&self.found.base.fit.tolerances()), causes.len())?;
        let x = candidate.present();
        let CrossValidatedFit { fit, .. } =
            weighed(self.problem, &models::sensors(self.problem), (candidate, x), Deadline::default())?;
        self.left(&fit.candidate, &fit.x).total(&self.problem.full_scale)
    }

    /// Estimates of the coefficients and shapes of the i-th effect, by name, with standard deviations.
    /// Those of a sensor effect that count in the unit of its signal also get the unit of the study's column.
    fn estimates(&self, i: usize, h: &Hypothesis) -> BTreeMap<String, ParameterEstimate> {
        let fit = &self.found.last.fit;
        let theta = fit.candidate.theta(&fit.x);
        // a relative parameter counts in the unit of the signal and is shown in the unit of its column
        let sensor = match &h.attachments[0].site {
            AttachmentSite::Sensor(name) => self.problem.signals.iter().position(|s| s.name == *name),
            _ => None,
        };
        let column = sensor.map(|k| (self.problem.unit(&self.problem.signals[k]), self.problem.shown[k].clone()));
        let of_signal = |relative: bool, unit: &str| match &column {
            Some((si, shown)) if relative && unit.is_empty() => (si.clone(), Some(shown.clone())),
            _ => (unit.to_string(), None),
        };
        let coefficients = h.coefficients.iter().map(|c| (&c.name, of_signal(c.relative, &c.unit)));
        let names = coefficients.chain(h.shapes.iter().map(|s| (&s.name, of_signal(s.relative, &s.unit))));
        let estimate = |(&place, (name, (unit, shown))): (&usize, (&String, (String, Option<SignalDisplayUnit>)))| {
            let free = fit.candidate.coordinates.iter().position(|c| c.parameter == place);
            // first order: deviation of the coordinate times its derivative
            let std = free.map_or(0.0, |k| self.deviations[k] * fit.candidate.coordinates[k].slope(fit.x[k]));
            (name.clone(), ParameterEstimate { value: theta[place], std, unit, shown })
        };
        fit.candidate.model.attached[i].iter().zip(names).map(estimate).collect()
    }

    /// All parameters with tolerances, as fitted in the last model, in the order of the problem.
    fn drifts(&self) -> Vec<ParameterDrift> {
        let fit = &self.found.last.fit;
        let theta = fit.candidate.theta(&fit.x);
        let drift = |(i, t): (usize, &ToleranceParameter)| ParameterDrift {
            parameter: t.name.clone(),
            nominal: t.nominal,
            value: theta[i],
            std: self.deviations[i] * t.sigma,
            tolerances: (!t.free).then(|| (theta[i] - t.nominal) / t.sigma),
        };
        self.problem.tolerances.iter().enumerate().map(drift).collect()
    }

    /// A trial as the verdict lists it, with the reason in words.
    /// Scores are `None` where the hypothesis was not fitted.
    fn weighed(&self, trial: &HypothesisTrial) -> super::HypothesisAssessment {
        let h = self.of(&trial.chosen);
        super::HypothesisAssessment {
            step: trial.step,
            effect: h.effect.clone(),
            family: h.family.clone(),
            places: spots(h),
            gap: trial.found.map(|f| f.gap),
            t: trial.found.map(|f| f.t),
            evidence: trial.found.map(|f| f.evidence),
            refused: trial.reason.as_ref().map(ToString::to_string),
        }
    }

    /// Places of what was accepted first, then those of the other hypotheses of the first step, with their evidence.
    /// Each place is listed once, with the first evidence that names it.
    fn places(&self) -> Vec<PlaceEvidence> {
        let mut all: Vec<PlaceEvidence> = Vec::new();
        let mut add = |h: &Hypothesis, evidence: f64| {
            let place = &h.attachments[0].place;
            if evidence > 0.0 && !all.iter().any(|l| l.place == place.place) {
                let (place, node, kind) = (place.place.clone(), place.node.clone(), place.kind.word());
                all.push(PlaceEvidence { place, node, kind, evidence, share: 0.0 });
            }
        };
        let named = self.found.taken.iter().chain(&self.found.shape);
        named.for_each(|t| add(self.hypothesis(t), t.evidence));
        for t in self.found.trials.iter().filter(|t| t.step == 1) {
            add(self.of(&t.chosen), t.found.map_or(0.0, |f| f.evidence));
        }
        // shares are among the places that are listed
        let total: f64 = all.iter().map(|l| l.evidence).sum();
        all.iter_mut().for_each(|l| l.share = l.evidence / total);
        all
    }
}

/// Residuals of a model on recordings; `None` where a simulation stops early.
/// `own`: they are the train recordings, so that coefficients per recording apply.
fn errors(
    candidate: &CandidateModel,
    x: &[f64],
    recordings: &[RecordingData],
    own: bool,
) -> Vec<Option<RecordingResiduals>> {
    recordings.par_iter().enumerate().map(|(i, r)| candidate.errors(x, r, own.then_some(i))).collect()
}

/// Numbers of all effects but one, of `effects` in all.
fn without(one: usize, effects: usize) -> Vec<usize> {
    (0..effects).filter(|k| *k != one).collect()
}
