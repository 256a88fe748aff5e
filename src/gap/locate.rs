//! Where the gap lies, before anything is named: each place gets a slow source of its own, and what the recordings gain
//! in likelihood by it ranks the places.

use super::data::Recording;
use super::filter::{self, SILENT, Setting, Source, Tape};
use super::fit::{self, Fit};
use super::levels;
use super::problem::{Assembled, Problem, SLOWER};
use super::screen::Accepted;
use rayon::prelude::*;

/// Samples of each recording that are looked at, at most.
const SAMPLES: usize = 1200;
/// A place counts when it gains so much, nats.
const GAIN: f64 = 4.0;
/// Strengths tried, in units of what one sample shows.
const STRENGTHS: [f64; 2] = [1.0, 12.0];

/// How much worse a filter with slow sources is that has gone astray, nats.
const ASTRAY: f64 = 1e3;

/// A place and the evidence for something missing there.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// Index into [`Problem::disturbances`].
    pub disturbance: usize,
    /// Gain in log likelihood, scaled, nats.
    pub evidence: f64,
}

/// Ranks all places beside what was accepted: greedily, each time the place that gains most.
pub fn locate(problem: &Problem<'_>, base: &Fit, accepted: &[Accepted]) -> Vec<Located> {
    let chosen: Vec<_> = accepted.iter().map(|a| a.chosen.clone()).collect();
    let all: Vec<usize> = (0..problem.disturbances.len()).collect();
    let Ok(assembled) = problem.assemble(&chosen, &all) else { return Vec::new() };
    let Some(loud) = setting(problem, base, &assembled, accepted) else { return Vec::new() };
    let fast = base.setting.sources.len();
    let Some(loudly) = fit::passes(&loud, &problem.train, SAMPLES, Tape::Whole) else { return Vec::new() };
    let whole = |passes: &[filter::Pass]| passes.iter().map(|p| p.likelihood).sum::<f64>();
    // linearised where the slow sources lead; where they lead astray, where the model without them goes
    let mut quiet = loud.clone();
    quiet.sources[fast..].iter_mut().for_each(|s| s.level *= SILENT);
    let quietly = fit::passes(&quiet, &problem.train, SAMPLES, Tape::Whole);
    let (passes, setting, louder) = match quietly {
        Some(quietly) if whole(&loudly) < whole(&quietly) - ASTRAY => (quietly, quiet, 1.0 / SILENT),
        _ => (loudly, loud, 1.0),
    };
    let tapes: Vec<&[filter::Step]> = passes.iter().flat_map(|p| &p.tapes).map(Vec::as_slice).collect();
    let mut factors = vec![1.0; fast];
    factors.resize(setting.sources.len(), SILENT);
    let value = |factors: &[f64]| {
        let scaled = |(i, f): (usize, &f64)| if i < fast { *f } else { f * louder };
        let scaled: Vec<f64> = factors.iter().enumerate().map(scaled).collect();
        tapes.iter().map(|t| levels::likelihood(&setting, t, &scaled)).sum::<f64>()
    };
    let mut best = value(&factors);
    let mut found = Vec::new();
    for _ in 0..3 {
        let trials: Vec<(usize, f64)> =
            (fast..factors.len()).filter(|&i| factors[i] < 1e-3).flat_map(|i| STRENGTHS.map(|s| (i, s))).collect();
        let results: Vec<(f64, usize, f64)> = trials
            .par_iter()
            .map(|&(i, s)| {
                let mut changed = factors.clone();
                changed[i] = s;
                (value(&changed), i, s)
            })
            .collect();
        if found.is_empty() {
            found = first_ranking(&results, best, base.search_share(), fast);
        }
        let Some(&(top, i, s)) = results.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if base.search_share() * (top - best) < GAIN {
            break;
        }
        factors[i] = s;
        best = top;
    }
    rank(&mut found, &factors, fast, &value, best, base.search_share());
    found
}

/// What is missing at a place over a recording, sample by sample in the unit of its source: what the filter makes of the
/// sources there, a slow one beside the fitted one, from the samples so far. The last sample is left out. `None` where the
/// filter has no values.
pub fn course(
    problem: &Problem<'_>,
    base: &Fit,
    accepted: &[Accepted],
    disturbance: usize,
    recording: &Recording,
) -> Option<Vec<f64>> {
    let chosen: Vec<_> = accepted.iter().map(|a| a.chosen.clone()).collect();
    let all: Vec<usize> = (0..problem.disturbances.len()).collect();
    let assembled = problem.assemble(&chosen, &all).ok()?;
    let mut setting = setting(problem, base, &assembled, accepted)?;
    let fast = base.setting.sources.len();
    let slow = setting.sources.swap_remove(fast + disturbance);
    setting.sources.truncate(fast);
    let followed = |strength: &f64| {
        let mut with = setting.clone();
        with.sources.push(Source { level: slow.level * strength, ..slow.clone() });
        let pass = filter::run(&with, recording, 0, recording.len(), Tape::Whole).ok()?;
        Some((pass, with.sources))
    };
    let (pass, sources) =
        STRENGTHS.iter().filter_map(followed).max_by(|a, b| a.0.likelihood.total_cmp(&b.0.likelihood))?;
    let steps = pass.tapes.first()?;
    let states = steps.first()?.correction.len() - sources.len();
    let there: Vec<usize> = (0..sources.len()).filter(|&i| sources[i].parameter == slow.parameter).collect();
    let mut z = vec![0.0; sources.len()];
    let value = |step: &filter::Step| {
        there.iter().for_each(|&i| z[i] += step.correction[states + i]);
        let sum = there.iter().map(|&i| z[i] * sources[i].level).sum();
        // sources only decay
        there.iter().for_each(|&i| z[i] *= step.transition[(states + i, states + i)]);
        sum
    };
    Some(steps.iter().map(value).collect())
}

/// What each place gains alone.
fn first_ranking(results: &[(f64, usize, f64)], base: f64, share: f64, fast: usize) -> Vec<Located> {
    let mut found: Vec<Located> = Vec::new();
    for &(value, i, _) in results {
        let evidence = share * (value - base);
        match found.iter_mut().find(|f| f.disturbance == i - fast) {
            Some(f) => f.evidence = f.evidence.max(evidence),
            None => found.push(Located { disturbance: i - fast, evidence }),
        }
    }
    found
}

/// Places chosen come first, by what is lost when they are dropped again; then the others by what they gain alone.
fn rank(found: &mut [Located], factors: &[f64], fast: usize, value: &impl Fn(&[f64]) -> f64, best: f64, share: f64) {
    let chosen = |f: &Located| factors[fast + f.disturbance] > 1e-3;
    for f in found.iter_mut() {
        if chosen(f) {
            let mut without = factors.to_vec();
            without[fast + f.disturbance] = SILENT;
            f.evidence = share * (best - value(&without));
        }
    }
    found.sort_by(|a, b| chosen(b).cmp(&chosen(a)).then(b.evidence.total_cmp(&a.evidence)));
}

/// The fitted model with its fast sources and a slow one at every place.
fn setting(problem: &Problem<'_>, base: &Fit, assembled: &Assembled, accepted: &[Accepted]) -> Option<Setting> {
    let mut scaled = assembled.clone();
    carry(base, accepted, &mut scaled);
    scaled.begin_like(&base.setting, &problem.train);
    let first = fit::first_sources(&scaled, &base.setting.noise, &problem.train)?;
    let nodes = problem.node_sources();
    let mut setting = scaled.setting(&[], &base.setting.noise, Vec::new());
    for (&node, source) in nodes.iter().zip(&base.setting.sources) {
        setting.sources.push(Source { parameter: scaled.sources.start + node, ..source.clone() });
    }
    setting.sources.extend(first.into_iter().map(|s| Source { tau: SLOWER * s.tau, ..s }));
    Some(setting)
}

/// Values of tolerances and accepted effects from a fit into another model.
pub fn carry(base: &Fit, accepted: &[Accepted], assembled: &mut Assembled) {
    for i in assembled.free.clone() {
        assembled.theta[i] = base.setting.theta[i];
    }
    for (places, a) in assembled.attached.iter().zip(accepted) {
        for (&place, value) in places.iter().zip(&a.chosen.values) {
            assembled.theta[place] = *value;
        }
    }
}
