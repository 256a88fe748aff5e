//! All hypotheses at once: one pass of the filter gives every column, and the evidence of each hypothesis costs a small
//! factorisation.

use super::effects::{Coefficient, Shape};
use super::evidence::{self, Free};
use super::filter::colour::Colour;
use super::filter::{self, Source, Tape};
use super::fit::{self, Fit, Prior};
use super::hypotheses::Hypothesis;
use super::problem::{Assembled, Chosen, Problem, Tolerance};
use nalgebra::DMatrix;
use std::ops::Range;

/// The background is tried as fitted, and reduced: what a hypothesis explains must be allowed to leave it.
const FULL: f64 = 1.0;
const REDUCED: f64 = 0.1;
/// And with silent sources, where what is left of a signal is so many times its noise.
const OPEN: f64 = 2.0;
/// A gain by which the filter sees something plainly, nats.
const HIDING: f64 = 200.0;
/// Samples over which a joint model is tried.
const BEGINNING: usize = 2;
/// Typical sizes that a coefficient may have at most, as prior deviation: those of a sensor or a command are known by their
/// range, machines differ by more than that, and drag behind a gear grows with the cube of its ratio.
const LARGEST: f64 = 1e5;
const LARGEST_OF_RANGE: f64 = 30.0;

/// A hypothesis with its evidence in the linear model.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What, with the estimate of its coefficients and the variant of its shapes.
    pub chosen: Chosen,
    /// Gain in log evidence, nats.
    pub gain: f64,
    /// Priors of coefficients and shapes.
    pub priors: Vec<Prior>,
    /// The gain that an effect of typical size would bring, nats.
    pub visible: f64,
}

impl Candidate {
    /// As if it were accepted.
    pub fn accepted(&self) -> Accepted {
        Accepted { chosen: self.chosen.clone(), priors: self.priors.clone() }
    }
}

/// How far a data sheet is usually off where it is wrong, as part of the value.
const WRONG_SHEET: f64 = 0.3;
/// Beyond so many times that, something else is wrong.
const AT_MOST: f64 = 5.0;

/// Something accepted before.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// What, with values.
    pub chosen: Chosen,
    /// Priors of coefficients and shapes; `parameter` is not meaningful.
    pub priors: Vec<Prior>,
}

/// One variant of a hypothesis in the joint model.
struct Entry {
    hypothesis: usize,
    values: Vec<f64>,
    columns: Range<usize>,
}

/// The joint model of all hypotheses beside those accepted.
pub struct Screen<'a> {
    problem: &'a Problem<'a>,
    drifts: Vec<usize>,
    chosen: Vec<Chosen>,
    assembled: Assembled,
}

impl<'a> Screen<'a> {
    /// `None` where nothing can be attached.
    pub fn new(problem: &'a Problem<'a>, accepted: &[Accepted]) -> Option<Self> {
        let (drifts, effects): (Vec<usize>, Vec<usize>) =
            (0..problem.hypotheses.len()).partition(|&h| problem.hypotheses[h].family == "parameter");
        let taken = |c: &Chosen| {
            let same = |a: &Chosen| problem.hypotheses[c.hypothesis].same(&c.values, &a.values);
            accepted.iter().any(|a| a.chosen.hypothesis == c.hypothesis && same(&a.chosen))
        };
        let chosen: Vec<Chosen> = effects
            .into_iter()
            .filter(|&h| !problem.hypotheses[h].changes_order)
            .flat_map(|h| variants(&problem.hypotheses[h], h))
            .filter(|c| !taken(c))
            .collect();
        let open = |h: &usize| !accepted.iter().any(|a| a.chosen.hypothesis == *h);
        let drifts: Vec<usize> = drifts.into_iter().filter(open).collect();
        let before: Vec<Chosen> = accepted.iter().map(|a| a.chosen.clone()).collect();
        let (chosen, assembled) = attachable(problem, &before, chosen)?;
        Some(Screen { problem, drifts, chosen, assembled })
    }

    /// Weighs every hypothesis as the filter sees it, whose sources follow what moves slowly; best first, one entry a
    /// hypothesis.
    pub fn followed(&self, base: &Fit, accepted: &[Accepted]) -> Vec<Candidate> {
        let joints = |factor| self.joints(base, accepted, &Background::of(base, factor));
        let (full, reduced) = rayon::join(|| joints(FULL), || joints(REDUCED));
        let floor = full.iter().map(|joint| joint.floor).reduce(f64::max);
        let mut found = weighed(&full, &self.drifts, None);
        if floor.is_some() {
            merge(&mut found, weighed(&reduced, &self.drifts, floor));
        }
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        found
    }

    /// Weighs every hypothesis by what the inputs alone bring about, beside a model fitted by that: what it leaves is
    /// noise, as strong and as coloured as it is. Nothing where it leaves no more than the sensors' noise.
    pub fn driven(&self, course: &Fit, accepted: &[Accepted], noise: &[f64]) -> Vec<Candidate> {
        if course.setting.noise.iter().zip(noise).all(|(left, noise)| *left < OPEN * noise) {
            return Vec::new();
        }
        weighed(&self.joints(course, accepted, &Background::of(course, FULL)), &self.drifts, None)
    }

    fn joints(&self, base: &Fit, accepted: &[Accepted], background: &Background) -> Vec<Joint<'a>> {
        let own = Joint::new(self.problem, base, accepted, &self.assembled, &self.chosen, background);
        own.map_or_else(|| Joint::halves(self.problem, base, accepted, &self.chosen, background), |joint| vec![joint])
    }
}

/// Whether the filter sees something plainly. What is there or not promises anything from where it is not.
pub fn is_plain(problem: &Problem<'_>, followed: &[Candidate]) -> bool {
    let plain = |c: &Candidate| c.gain >= HIDING && !problem.hypotheses[c.chosen.hypothesis].is_bounded();
    followed.iter().any(plain)
}

/// What joint models say of their hypotheses and of all drifts, best first.
fn weighed(joints: &[Joint<'_>], drifts: &[usize], floor: Option<f64>) -> Vec<Candidate> {
    let mut found = Vec::new();
    joints.iter().for_each(|joint| merge(&mut found, joint.weigh(drifts, floor)));
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// Adds what was weighed in another joint model: of each hypothesis the best.
fn merge(found: &mut Vec<Candidate>, others: Vec<Candidate>) {
    for c in others {
        match found.iter_mut().find(|f| f.chosen.hypothesis == c.chosen.hypothesis) {
            Some(f) if f.gain < c.gain => *f = c,
            Some(_) => {}
            None => found.push(c),
        }
    }
}

/// Levels of the sources and of the noise under which hypotheses are weighed, and the share of samples that count.
struct Background {
    sources: Vec<Source>,
    noise: Vec<f64>,
    colours: Vec<Colour>,
    share: f64,
}

impl Background {
    /// Those of a fit, with its sources times a factor.
    fn of(base: &Fit, factor: f64) -> Self {
        Background {
            sources: base.setting.sources_times(factor),
            noise: base.setting.noise.clone(),
            colours: base.setting.colours.clone(),
            share: base.search_share(),
        }
    }
}

/// A hypothesis at its off value with each choice of its shapes.
pub fn variants(h: &Hypothesis, index: usize) -> Vec<Chosen> {
    let off: Vec<f64> = h.coefficients.iter().map(|c| c.off).collect();
    let one = |shapes: Vec<(String, f64)>| Chosen {
        hypothesis: index,
        values: off.iter().copied().chain(shapes.into_iter().map(|s| s.1)).collect(),
    };
    h.variants().into_iter().map(one).collect()
}

/// Those that can be attached beside those `before`, and the model with them: where all together cannot, halves are tried.
pub fn attachable(problem: &Problem<'_>, before: &[Chosen], chosen: Vec<Chosen>) -> Option<(Vec<Chosen>, Assembled)> {
    let joined = |chosen: &[Chosen]| {
        let all: Vec<Chosen> = before.iter().chain(chosen).cloned().collect();
        let assembled = problem.assembled(&all, &problem.node_sources(), before.len()).ok()?;
        begins(problem, &assembled).then_some(assembled)
    };
    if let Some(assembled) = joined(&chosen) {
        return Some((chosen, assembled));
    }
    let fine = fitting(&|chosen| joined(chosen).is_some(), chosen);
    let assembled = joined(&fine)?;
    Some((fine, assembled))
}

/// Those of which halves of halves can be attached.
fn fitting(joins: &dyn Fn(&[Chosen]) -> bool, mut chosen: Vec<Chosen>) -> Vec<Chosen> {
    if chosen.len() <= 1 {
        return Vec::new();
    }
    let right = chosen.split_off(chosen.len() / 2);
    let half = |half: Vec<Chosen>| if joins(&half) { half } else { fitting(joins, half) };
    let mut fine = half(chosen);
    fine.extend(half(right));
    fine
}

/// Whether a model has values and derivatives at its start: what is compiled may be singular at its off value.
fn begins(problem: &Problem<'_>, assembled: &Assembled) -> bool {
    let setting = assembled.setting(&[], &problem.noise_floor, Vec::new());
    problem.train.first().is_some_and(|r| filter::run(&setting, r, 0, BEGINNING, Tape::Nothing).is_ok())
}

/// The Gram matrices of the joint model.
struct Joint<'a> {
    entries: Vec<Entry>,
    /// What everything is weighed against: tolerances, then what was accepted.
    common: Vec<Free>,
    /// Scaled Gram matrix and scaled log likelihood.
    gram: DMatrix<f64>,
    likelihood: f64,
    /// Log evidence without any hypothesis.
    floor: f64,
    problem: &'a Problem<'a>,
}

impl<'a> Joint<'a> {
    fn new(
        problem: &'a Problem<'a>,
        base: &Fit,
        accepted: &[Accepted],
        assembled: &Assembled,
        chosen: &[Chosen],
        background: &Background,
    ) -> Option<Self> {
        let mut assembled = assembled.clone();
        let mut common = fit::tolerance_priors(problem);
        for prior in &common {
            assembled.theta[prior.parameter] = base.setting.theta[prior.parameter];
        }
        for (places, a) in assembled.attached.iter().zip(accepted) {
            for ((&place, value), prior) in places.iter().zip(&a.chosen.values).zip(&a.priors) {
                assembled.theta[place] = *value;
                common.push(Prior { parameter: place, ..prior.clone() });
            }
        }
        assembled.begin_like(&base.setting, &problem.train);
        let mut columns: Vec<usize> = common.iter().map(|p| p.parameter).collect();
        let mut entries = Vec::new();
        for (places, c) in assembled.attached[accepted.len()..].iter().zip(chosen) {
            let count = problem.hypotheses[c.hypothesis].coefficients.len();
            let first = columns.len();
            columns.extend(&places[..count.min(places.len())]);
            entries.push(Entry { hypothesis: c.hypothesis, values: c.values.clone(), columns: first..columns.len() });
        }
        let mut setting = assembled.setting(&background.sources, &background.noise, columns);
        setting.common = common.len();
        setting.colours.clone_from(&background.colours);
        if !setting.sources.is_empty() {
            setting.cuts.clone_from(&base.cuts);
        }
        setting.groups = entries.iter().map(|e| e.columns.clone()).collect();
        let passes = fit::passes(&setting, &problem.train, usize::MAX, Tape::Nothing)?;
        let width = setting.columns.len() + 1;
        let gram = passes.iter().fold(DMatrix::zeros(width, width), |sum, p| sum + &p.gram) * background.share;
        let likelihood = background.share * passes.iter().map(|p| p.likelihood).sum::<f64>();
        let common = common.iter().enumerate().map(|(column, p)| p.about(assembled.theta[p.parameter], column));
        let common: Vec<Free> = common.collect();
        let floor = likelihood + evidence::explain(&gram, &common)?.evidence;
        Some(Joint { entries, common, gram, likelihood, floor, problem })
    }

    /// Several where one joint model has no values somewhere on the way: halves of halves, without those that fail alone.
    fn halves(
        problem: &'a Problem<'a>,
        base: &Fit,
        accepted: &[Accepted],
        chosen: &[Chosen],
        background: &Background,
    ) -> Vec<Self> {
        let before: Vec<Chosen> = accepted.iter().map(|a| a.chosen.clone()).collect();
        let own = |chosen: &[Chosen]| {
            let (chosen, assembled) = attachable(problem, &before, chosen.to_vec())?;
            Joint::new(problem, base, accepted, &assembled, &chosen, background)
        };
        let half = |chosen: &[Chosen]| match own(chosen) {
            Some(joint) => vec![joint],
            None if chosen.len() > 1 => Joint::halves(problem, base, accepted, chosen, background),
            None => Vec::new(),
        };
        let (left, right) = chosen.split_at(chosen.len() / 2);
        if left.is_empty() || own(&[]).is_none() {
            return Vec::new();
        }
        [half(left), half(right)].into_iter().flatten().collect()
    }

    /// All hypotheses of this joint model and all drifts, over `floor` or over no hypothesis in this background if that
    /// is more likely.
    fn weigh(&self, drifts: &[usize], floor: Option<f64>) -> Vec<Candidate> {
        let floor = floor.map_or(self.floor, |f| f.max(self.floor));
        let mut best: Vec<Candidate> = Vec::new();
        let mut note = |c: Candidate| match best.iter_mut().find(|b| b.chosen.hypothesis == c.chosen.hypothesis) {
            Some(b) if b.gain < c.gain => *b = c,
            Some(_) => {}
            None => best.push(c),
        };
        for entry in &self.entries {
            if let Some(mut c) = self.entry(entry) {
                // a choice among variants has its price
                let cost = variants_cost(&self.problem.hypotheses[entry.hypothesis]);
                c.gain += self.likelihood - floor - cost;
                note(c);
            }
        }
        for &h in drifts {
            if let Some(mut c) = self.drift(h) {
                c.gain += self.likelihood - floor;
                note(c);
            }
        }
        best.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        best
    }

    /// Evidence of one variant; coefficients that come out on the wrong side of their bounds are left at their off value.
    fn entry(&self, entry: &Entry) -> Option<Candidate> {
        let h = &self.problem.hypotheses[entry.hypothesis];
        let blocks = self.problem.blocks();
        let mut prior_sigmas = Vec::new();
        let mut visible = 0.0;
        for (column, c) in entry.columns.clone().zip(&h.coefficients) {
            let info = evidence::new_information(&self.gram, column, &self.common);
            prior_sigmas.push(deviation(c, info, blocks));
            visible += 0.5 * c.nominal * c.nominal * info;
        }
        let mut active: Vec<usize> = (0..prior_sigmas.len()).collect();
        loop {
            if active.is_empty() {
                return None;
            }
            let coefficient = |&i: &usize| Free {
                column: entry.columns.start + i,
                mean: 0.0,
                sigma: prior_sigmas[i],
                bounds: (f64::NEG_INFINITY, f64::INFINITY),
            };
            let set: Vec<Free> = self.common.iter().cloned().chain(active.iter().map(coefficient)).collect();
            let found = evidence::explain(&self.gram, &set)?;
            let value = |k: usize| h.coefficients[active[k]].off + found.estimate[self.common.len() + k];
            let wrong = (0..active.len()).find(|&k| {
                let c = &h.coefficients[active[k]];
                c.min.is_some_and(|m| value(k) < m) || c.off == 0.0 && c.max.is_some_and(|m| m <= 0.0 && value(k) > m)
            });
            if let Some(k) = wrong {
                active.remove(k);
                continue;
            }
            let mut values = entry.values.clone();
            for (k, &i) in active.iter().enumerate() {
                let c = &h.coefficients[i];
                values[i] = value(k).min(c.max.unwrap_or(f64::INFINITY));
            }
            let priors = priors(h, &values, &prior_sigmas);
            let chosen = Chosen { hypothesis: entry.hypothesis, values };
            return Some(Candidate { chosen, gain: found.evidence, priors, visible });
        }
    }

    /// A parameter far beyond its tolerance.
    fn drift(&self, hypothesis: usize) -> Option<Candidate> {
        let h = &self.problem.hypotheses[hypothesis];
        let index = drifting(self.problem, h)?;
        let t = &self.problem.tolerances[index];
        let others: Vec<Free> = self.common.iter().filter(|f| f.column != index).cloned().collect();
        let info = evidence::new_information(&self.gram, index, &others);
        let broad = wrong_sheet(t);
        let (min, max) = (t.min.max(t.nominal - AT_MOST * broad), t.max.min(t.nominal + AT_MOST * broad));
        let mut wide = self.common.clone();
        let own = &mut wide[index];
        let present = t.nominal - own.mean;
        (own.sigma, own.bounds) = (broad, (min - present, max - present));
        let found = evidence::explain(&self.gram, &wide)?;
        let value = (present + found.estimate[index]).clamp(min, max);
        let prior = Prior { parameter: index, mean: t.nominal, sigma: broad, open: true, min, max };
        let visible = 0.5 * (10.0 * t.sigma).powi(2) * info;
        let chosen = Chosen { hypothesis, values: vec![value] };
        Some(Candidate { chosen, gain: found.evidence, priors: vec![prior], visible })
    }
}

/// Deviation of a coefficient's prior when nothing else is known of it: what one block of samples would tell.
pub fn deviation(c: &Coefficient, information: f64, blocks: f64) -> f64 {
    let largest = c.nominal.abs().max(1e-300) * if c.relative { LARGEST_OF_RANGE } else { LARGEST };
    (blocks / information.max(1e-300)).sqrt().min(largest)
}

/// Priors of an effect: of its coefficients with these deviations about their off values, then of its shapes.
pub fn priors(h: &Hypothesis, values: &[f64], sigmas: &[f64]) -> Vec<Prior> {
    let coefficient = |(c, sigma): (&Coefficient, &f64)| Prior {
        parameter: 0,
        mean: c.off,
        sigma: *sigma,
        open: true,
        min: c.min.unwrap_or(f64::NEG_INFINITY),
        max: c.max.unwrap_or(f64::INFINITY),
    };
    let mut priors: Vec<Prior> = h.coefficients.iter().zip(sigmas).map(coefficient).collect();
    priors.extend(h.shapes.iter().zip(&values[h.coefficients.len()..]).map(|(s, &value)| shape_prior(s, value)));
    priors
}

/// Prior of a shape about the value of its grid.
pub fn shape_prior(s: &Shape, value: f64) -> Prior {
    Prior {
        parameter: 0,
        mean: value,
        sigma: 0.5 * value.abs().max(1e-300),
        open: false,
        min: (0.1 * value).min(10.0 * value).max(s.min.unwrap_or(f64::NEG_INFINITY)),
        max: (0.1 * value).max(10.0 * value).min(s.max.unwrap_or(f64::INFINITY)),
    }
}

/// How far a data sheet is off where it is wrong.
pub fn wrong_sheet(t: &Tolerance) -> f64 {
    (3.0 * t.sigma).max(WRONG_SHEET * t.nominal.abs())
}

/// Nats that the choice among the variants of a hypothesis costs.
pub fn variants_cost(h: &Hypothesis) -> f64 {
    (h.shapes.iter().map(|s| s.grid.len()).product::<usize>() as f64).ln()
}

/// The tolerance that a drift moves.
pub fn drifting(problem: &Problem<'_>, h: &Hypothesis) -> Option<usize> {
    let name = &h.attachments[0].place.place;
    problem.tolerances.iter().position(|t| t.name == *name)
}
