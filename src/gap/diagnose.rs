//! The whole diagnosis: noise, tolerances, places, effects one after another, and how far the gap shrinks.

mod conclusion;
mod driven;
mod lost;

use super::data::Recording;
use super::effects::Coefficient;
use super::fit::{self, Fit, Prior, vuong};
use super::held;
use super::hypotheses::Hypothesis;
use super::locate::{self, Located};
use super::problem::{Assembled, Chosen, Problem};
use super::recording::{self, Gross};
use super::screen::{self, Accepted, Candidate};
use super::verdict::Verdict;
use conclusion::Conclusion;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Effects that are looked for one after another, at most.
const MOST_EFFECTS: usize = 4;
/// Candidates of a screen that are refined,
const REFINED: usize = 5;
/// Gain that a candidate must promise to be refined, nats.
const PROMISING: f64 = 5.0;
/// Candidates behind this part of the best one's gain are not refined.
const FAR: f64 = 0.1;
/// Deviation of the share of such an effect from the whole.
const WHOLE: f64 = 0.3;
/// Samples with which their shapes are tried.
const TRIED: usize = 1500;
/// Candidates that are there or not.
const BOUNDED: usize = 4;
/// Shapes without a name that are refined beside, each of another kind; and what one must be ahead of the best effect, nats and as part of that
/// effect's gain, before nothing that is known explains the gap: a form other than the library's is no other cause.
const SHAPES: usize = 5;
const AHEAD: f64 = 15.0;
const AHEAD_PART: f64 = 0.2;
/// Part of its gain that a shape must have by what the inputs alone bring about.
const DRIVEN: f64 = 0.25;
/// Iterations with which candidates are compared before the front is polished, and candidates polished.
const RACE: usize = 2;
const POLISHED: usize = 5;
/// Mean square of whitened innovations beyond which the levels of the nominal model are no levels.
const BROKEN: f64 = 100.0;
/// Rounds at most in which the levels of the nominal model settle.
const SETTLING: usize = 5;
/// Factor by which they grow in one of them.
const GROWTH: f64 = 30.0;
/// Part of the sources' levels with which a candidate is tried as well.
const QUIET: f64 = 0.1;
/// A candidate that is so much worse than the model without it is not tried further, nats.
const HOPELESS: f64 = 3e3;
/// Gain that an effect must have to be accepted, nats.
const ACCEPTED: f64 = 8.0;
/// Vuong statistic that it must have.
const CONSISTENT: f64 = 2.0;
/// Gain from which an effect may be one that acts rarely, nats; and how much more it must win than lose.
const RARE: f64 = 30.0;
const RARE_RATIO: f64 = 3.5;
/// Part of the simulated gap that opens again without it, of what all effects together close.
const CLOSES: f64 = 0.07;
/// Candidates this near are equally good: the simpler one stands first, nats.
const AS_GOOD: f64 = 2.0;
/// Alternatives this near cannot be told apart, nats.
const NEAR: f64 = 6.0;
/// Nor those this near that no block prefers clearly.
const NEAR_IF_INCONSISTENT: f64 = 15.0;
/// Vuong statistic below which an alternative is worse for certain.
const CERTAINLY_WORSE: f64 = -1.64;

/// A stage of the diagnosis, for progress bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Noise, tolerances, levels.
    Anchor,
    /// Places.
    Locate,
    /// All hypotheses at once, looking for the n-th effect.
    Screen(usize),
    /// The best ones one by one.
    Refine(usize),
    /// Held recordings.
    Held,
}

/// A refined candidate.
struct Refined {
    accepted: Accepted,
    assembled: Assembled,
    fit: Fit,
}

impl Refined {
    /// With the fitted values; a choice among variants has its price.
    fn new(problem: &Problem<'_>, accepted: Accepted, assembled: Assembled, mut fit: Fit) -> Self {
        fit.evidence -= screen::variants_cost(&problem.hypotheses[accepted.chosen.hypothesis]);
        let values = assembled.attached.last().map_or_else(Vec::new, |own| values(&fit, own));
        let chosen = Chosen { values, ..accepted.chosen };
        Refined { accepted: Accepted { chosen, ..accepted }, assembled, fit }
    }

    fn is_shape(&self, problem: &Problem<'_>) -> bool {
        problem.hypotheses[self.accepted.chosen.hypothesis].is_shape()
    }
}

/// An accepted effect with what came with it.
struct Found {
    gain: f64,
    t: f64,
    alternatives: Vec<(Chosen, f64)>,
}

/// A gap that no effect explains, by its shape.
struct Shaped {
    /// Index into [`Problem::hypotheses`].
    hypothesis: usize,
    /// Nats gained.
    gain: f64,
    /// Part of the simulated gap's square on the train recordings that it closes.
    closes: f64,
}

/// A refined candidate of one round, for the ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The effect that was looked for: 1, 2, ...
    pub round: usize,
    /// What, with fitted values.
    pub chosen: Chosen,
    /// Gain in evidence, nats.
    pub gain: f64,
    /// Block-wise Vuong statistic over the model before.
    pub t: f64,
    /// Log likelihood won in the blocks that gain, and lost in the others, nats, not scaled.
    pub won_and_lost: (f64, f64),
}

/// What the search came to; held recordings have not been touched.
pub struct Search {
    /// The nominal model with parameters within their tolerances.
    base: Fit,
    base_model: Assembled,
    places: Vec<Located>,
    accepted: Vec<Accepted>,
    found: Vec<Found>,
    last: Fit,
    last_model: Assembled,
    /// What is left after the effects, by its shape.
    shape: Option<Shaped>,
    /// Places that are left.
    left: Vec<Located>,
    /// All refined candidates.
    trials: Vec<Trial>,
    /// Gross errors of the recordings.
    gross: Vec<Gross>,
    /// Share of hypotheses that would have been seen at typical size.
    visible: f64,
}

/// Why there is no verdict.
#[derive(Clone, Debug)]
pub enum Trouble {
    /// The nominal model with its sources could not be compiled.
    Model(Vec<crate::diag::Diagnostic>),
    /// The nominal model cannot follow the recordings: at what time, and why.
    Diverges(f64, String),
}

/// Searches on the train recordings.
///
/// # Errors
/// [`Trouble`].
pub fn search(problem: &Problem<'_>, progress: &mut dyn FnMut(Stage)) -> Result<Search, Trouble> {
    progress(Stage::Anchor);
    let gross = recording::gross_errors(problem);
    let (base, base_model) = anchor(problem, &problem.noise_floor)?;
    progress(Stage::Locate);
    let places = locate::locate(problem, &base, &[]);
    let mut search = Search {
        last: base.clone(),
        last_model: base_model.clone(),
        base,
        base_model,
        places,
        accepted: Vec::new(),
        found: Vec::new(),
        shape: None,
        left: Vec::new(),
        visible: 0.0,
        trials: Vec::new(),
        gross,
    };
    while search.gross.is_empty() && search.accepted.len() < MOST_EFFECTS && search.step(problem, progress) {}
    search.prune(problem);
    progress(Stage::Locate);
    search.left = if search.accepted.is_empty() {
        search.places.clone()
    } else {
        locate::locate(problem, &search.last, &search.accepted)
    };
    Ok(search)
}

/// The nominal model fitted within its tolerances.
fn anchor(problem: &Problem<'_>, noise: &[f64]) -> Result<(Fit, Assembled), Trouble> {
    let model = problem.assemble(&[], &problem.node_sources()).map_err(Trouble::Model)?;
    let diverges = || Trouble::Diverges(0.0, "the model has no values on the way".into());
    let levels = fit::first_levels(&model, noise, &problem.train).ok_or_else(|| why(problem, &model, noise))?;
    let priors = fit::tolerance_priors(problem);
    let settled = |rounds: usize, growth: f64| {
        let mut setting = model.setting(&levels, noise, Vec::new());
        fit::adjust_slowly(&mut setting, &problem.train, rounds, growth)?;
        fit::fit(setting, &priors, &problem.train, None, fit::ITERATIONS)
    };
    let first = match settled(1, f64::INFINITY) {
        Some(first) if first.misfit() < BROKEN => first,
        // levels that were found far from where they lead are found step by step
        broken => settled(SETTLING, GROWTH).or(broken).ok_or_else(diverges)?,
    };
    Ok((fit::polish(first, &problem.train, None), model))
}

fn why(problem: &Problem<'_>, model: &Assembled, noise: &[f64]) -> Trouble {
    let setting = model.setting(&[], noise, Vec::new());
    for r in &problem.train {
        if let Err((time, e)) = super::filter::run(&setting, r, 0, usize::MAX, false) {
            return Trouble::Diverges(time, e.to_string());
        }
    }
    Trouble::Diverges(0.0, "the model has no values on the way".into())
}

impl Search {
    /// Looks for one more effect; true when one was accepted.
    fn step(&mut self, problem: &Problem<'_>, progress: &mut dyn FnMut(Stage)) -> bool {
        let number = self.accepted.len() + 1;
        progress(Stage::Screen(number));
        let candidates = screen::screen(problem, &self.last, &self.accepted);
        if number == 1 {
            let seen = candidates.iter().filter(|c| c.visible > ACCEPTED).count();
            self.visible = seen as f64 / candidates.len().max(1) as f64;
        }
        let (mut chosen, rest) = promising(problem, candidates);
        chosen.extend(self.unseen(problem, &chosen));
        progress(Stage::Refine(number));
        let mut refined = self.refined(problem, &chosen);
        if let Some(front) = refined.first() {
            let others = siblings(problem, &rest, front);
            refined.extend(self.refined(problem, &others));
            refined.sort_by(|a, b| b.fit.evidence.total_cmp(&a.fit.evidence));
        }
        self.sharpen(problem, &mut refined);
        refined.sort_by(|a, b| b.fit.evidence.total_cmp(&a.fit.evidence));
        if let Some(front) = refined.first() {
            self.relevel(problem, &front.fit);
        }
        let trials: Vec<Trial> = refined.iter().map(|r| self.trial(number, r)).collect();
        self.trials.extend(trials);
        let (shapes, mut refined): (Vec<Refined>, Vec<Refined>) =
            refined.into_iter().partition(|r| r.is_shape(problem));
        if let Some(shape) = shapes.into_iter().find(|s| self.nothing_known(problem, s, refined.first())) {
            self.shaped(problem, shape);
            return false;
        }
        if refined.is_empty() {
            return false;
        }
        if let Some((best, found)) = self.lost(problem, &refined) {
            // nothing further can be weighed beside an effect that the filter cannot follow
            self.accept(best, found);
            return false;
        }
        let best = refined.remove(simplest(problem, &refined));
        let gain = self.gain(&best.fit);
        let t = vuong(&best.fit.blocks, &self.last.blocks);
        let count = problem.tolerances.len();
        let returned = self.last.prior_cost(count) - best.fit.prior_cost(count);
        let h = &problem.hypotheses[best.accepted.chosen.hypothesis];
        // a parameter that is let go always returns from its bound, and acts at all times; a second effect at the place of
        // another may mend that one's form only
        let site = |a: &Accepted| &problem.hypotheses[a.chosen.hypothesis].attachments[0].site;
        let again = self.accepted.iter().any(|a| site(a) == &h.attachments[0].site);
        let always = h.family == "parameter" || again;
        let seldom = !always && (returned > 0.5 * gain || rare(&best.fit, &self.last, gain));
        let consistent = t > CONSISTENT || seldom;
        if gain < ACCEPTED || !consistent {
            return false;
        }
        let near = |r: &&Refined| {
            let behind = best.fit.evidence - r.fit.evidence;
            let worse = vuong(&r.fit.blocks, &best.fit.blocks) < CERTAINLY_WORSE;
            behind < NEAR || behind < NEAR_IF_INCONSISTENT && !worse
        };
        let alternatives = refined
            .iter()
            .filter(near)
            .map(|r| (r.accepted.chosen.clone(), best.fit.evidence - r.fit.evidence))
            .collect();
        self.accept(best, Found { gain, t, alternatives });
        true
    }

    fn accept(&mut self, best: Refined, found: Found) {
        self.found.push(found);
        self.accepted.push(best.accepted);
        self.adopt(best.fit, best.assembled);
    }

    /// Nats that a fit is ahead of the last one.
    fn gain(&self, fit: &Fit) -> f64 {
        fit.evidence - self.last.evidence
    }

    /// Takes a fit of the accepted effects as the last one, with their values.
    fn adopt(&mut self, fit: Fit, model: Assembled) {
        for (a, places) in self.accepted.iter_mut().zip(&model.attached) {
            a.chosen.values = values(&fit, places);
        }
        self.last = fit;
        self.last_model = model;
    }

    /// Whether a shape explains so much more than the best effect that the effect is not the cause, and does so by what
    /// the inputs bring about: in the filter a resonance may also follow the colour of a disturbance.
    fn nothing_known(&self, problem: &Problem<'_>, shape: &Refined, best: Option<&Refined>) -> bool {
        let gain = self.gain(&shape.fit);
        let named = best.map_or(0.0, |b| self.gain(&b.fit)).max(0.0);
        let rival = best.filter(|_| named > 0.0).map_or(&self.last, |b| &b.fit);
        let ahead = gain > ACCEPTED && gain - named > AHEAD.max(AHEAD_PART * named);
        let consistent = || vuong(&shape.fit.blocks, &rival.blocks) > CONSISTENT || rare(&shape.fit, rival, gain - named);
        let driven = || driven::gain(problem, shape, &self.last).is_some_and(|driven| driven > DRIVEN * gain);
        ahead && consistent() && driven()
    }

    /// Takes down what is left by its shape. Effects found before are dropped where the shape without them explains more
    /// than they do: they only stood near it.
    fn shaped(&mut self, problem: &Problem<'_>, shape: Refined) {
        let hypothesis = shape.accepted.chosen.hypothesis;
        let gain = self.gain(&shape.fit);
        let mut with = shape.fit;
        if !self.accepted.is_empty()
            && let Some((alone, _)) = fitted(problem, &self.base, std::slice::from_ref(&shape.accepted))
        {
            let alone = alone.at_share(self.last.share);
            if alone.evidence > self.last.evidence {
                self.accepted.clear();
                self.found.clear();
                self.adopt(self.base.clone().at_share(self.last.share), self.base_model.clone());
                with = alone;
            }
        }
        let gap = |f: &Fit| simulated(problem, f, &with.setting.noise).total;
        let before = gap(&self.last);
        let closes = if before > 0.0 { 1.0 - (gap(&with) / before).powi(2) } else { 0.0 };
        self.shape = Some(Shaped { hypothesis, gain, closes });
    }

    fn trial(&self, round: usize, r: &Refined) -> Trial {
        Trial {
            round,
            chosen: r.accepted.chosen.clone(),
            gain: self.gain(&r.fit),
            t: vuong(&r.fit.blocks, &self.last.blocks),
            won_and_lost: won_and_lost(&r.fit, &self.last),
        }
    }

    /// Fits candidates one by one; best first.
    fn refined(&self, problem: &Problem<'_>, chosen: &[Candidate]) -> Vec<Refined> {
        let mut refined: Vec<Refined> = chosen.par_iter().filter_map(|c| self.refine(problem, c)).collect();
        refined.sort_by(|a, b| b.fit.evidence.total_cmp(&a.fit.evidence));
        refined
    }

    /// Fits one candidate together with everything accepted before. An effect that is there or not (a rectifying sensor)
    /// looks small from where it is not: it begins as a whole, and less than half of it would be something else.
    fn refine(&self, problem: &Problem<'_>, candidate: &Candidate) -> Option<Refined> {
        let h = &problem.hypotheses[candidate.chosen.hypothesis];
        let mut whole = candidate.clone();
        if bounded(h) {
            for (i, c) in h.coefficients.iter().enumerate() {
                let Some(max) = share(c) else { continue };
                whole.chosen.values[i] = max;
                let prior = &mut whole.priors[i];
                (prior.mean, prior.sigma, prior.min) = (max, WHOLE * max, 0.5 * max);
            }
            self.shape_of_whole(problem, h, &mut whole);
        }
        let accepted = whole.accepted();
        let mut all = self.accepted.clone();
        all.push(accepted.clone());
        let (fit, assembled) = fitted(problem, &self.last, &all)?;
        Some(Refined::new(problem, accepted, assembled, fit))
    }

    /// Gives a whole effect the shape that fits it: that of a small share of it may be nothing like (a twentieth of twenty
    /// samples' delay is one sample's).
    fn shape_of_whole(&self, problem: &Problem<'_>, h: &Hypothesis, whole: &mut Candidate) {
        let variants = screen::variants(h, whole.chosen.hypothesis);
        let (count, first) = (h.coefficients.len(), &problem.train[..1]);
        if variants.len() < 2 {
            return;
        }
        let likelihood = |shapes: &[f64]| {
            let mut values = whole.chosen.values.clone();
            values[count..].copy_from_slice(shapes);
            let mut all = self.accepted.clone();
            all.push(Accepted { chosen: Chosen { values, ..whole.chosen }, priors: whole.priors.clone() });
            let (model, _) = ready(problem, &self.last, &all)?;
            let levels: Vec<f64> = self.last.setting.sources.iter().map(|s| s.level).collect();
            let setting = model.setting(&levels, &self.last.setting.noise, Vec::new());
            Some(fit::passes(&setting, first, TRIED, false)?[0].likelihood)
        };
        let best = variants
            .iter()
            .filter_map(|v| Some((likelihood(&v.values[count..])?, &v.values[count..])))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, shapes)) = best {
            whole.chosen.values[count..].copy_from_slice(shapes);
            let priors = h.shapes.iter().zip(shapes).map(|(s, &x)| screen::shape_prior(s, x));
            whole.priors.splice(count.., priors);
        }
    }

    /// Those at the front are fitted to the end: comparisons are between optima only. The share of independent samples is
    /// that of the whitest: a model that explains what is missing leaves white innovations, and then all samples count.
    fn sharpen(&mut self, problem: &Problem<'_>, refined: &mut Vec<Refined>) {
        let sharper = |(i, r): (usize, Refined)| {
            if i >= POLISHED {
                return r;
            }
            let mut fit = r.fit;
            fit.evidence += screen::variants_cost(&problem.hypotheses[r.accepted.chosen.hypothesis]);
            let fit = fit::polish(fit, &problem.train, Some(self.last.search_share()));
            Refined::new(problem, r.accepted, r.assembled, fit)
        };
        let taken = std::mem::take(refined);
        let polished: Vec<Refined> = taken.into_par_iter().enumerate().map(sharper).collect();
        let share = polished.iter().take(POLISHED).map(|r| r.fit.own_share()).fold(self.last.share, f64::max);
        refined.extend(polished.into_iter().map(|r| Refined { fit: r.fit.at_share(share), ..r }));
        self.last = self.last.clone().at_share(share);
    }

    /// Fits the model without a further effect from the levels and noise that the best candidate led to: what they alone
    /// gain is no gain of the effect.
    fn relevel(&mut self, problem: &Problem<'_>, front: &Fit) {
        let mut setting = self.last.setting.clone();
        setting.sources.iter_mut().zip(&front.setting.sources).for_each(|(own, s)| own.level = s.level);
        setting.noise.clone_from(&front.setting.noise);
        let share = self.last.share;
        let fit = fit::fit(setting, &self.last.priors, &problem.train, Some(share), fit::ITERATIONS);
        if let Some(fit) = fit
            && fit.evidence > self.last.evidence
        {
            self.last = fit::polish(fit, &problem.train, Some(share));
            if self.accepted.is_empty() {
                self.base = self.last.clone();
            }
        }
    }

    /// Drops again what closes little of the simulated gap now that everything else is there: one effect hides another,
    /// so this is asked at the end only.
    fn prune(&mut self, problem: &Problem<'_>) {
        while !self.accepted.is_empty() {
            let noise = self.last.setting.noise.clone();
            let gap = |f: &Fit| simulated(problem, f, &noise);
            let full = gap(&self.last);
            let closable = gap(&self.base).beyond(&full);
            let without = |i: usize| {
                let rest: Vec<Accepted> =
                    (0..self.accepted.len()).filter(|k| *k != i).map(|k| self.accepted[k].clone()).collect();
                if rest.is_empty() {
                    return Some((self.base.clone(), self.base_model.clone()));
                }
                fitted(problem, &self.last, &rest)
            };
            let least = (0..self.accepted.len())
                .filter_map(|i| without(i).map(|(f, m)| (gap(&f).beyond(&full) / closable.max(1e-300), i, f, m)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match least {
                Some((closes, i, fit, model)) if closes < CLOSES => {
                    self.accepted.remove(i);
                    self.found.remove(i);
                    self.adopt(fit, model);
                }
                _ => break,
            }
        }
    }
}

/// Gap of a fit on the train recordings, simulated from the inputs alone.
fn simulated(problem: &Problem<'_>, f: &Fit, noise: &[f64]) -> held::Gap {
    held::gap(&held::simulate_all(&f.setting, &problem.train), &problem.train, noise, &problem.full_scale)
}

/// What is refined: the best effects, the best of those that are there or not, which may look small from where they are
/// not, and the best shape of each kind. And the rest.
fn promising(problem: &Problem<'_>, candidates: Vec<Candidate>) -> (Vec<Candidate>, Vec<Candidate>) {
    let h = |c: &Candidate| &problem.hypotheses[c.chosen.hypothesis];
    let front = candidates.iter().find(|c| !h(c).is_shape()).map_or(0.0, |c| c.gain);
    let (mut effects, mut switched) = (0, 0);
    let mut kinds = BTreeSet::new();
    candidates.into_iter().partition(|c| {
        let worth = c.gain > PROMISING.max(FAR * front);
        if h(c).is_shape() {
            worth && kinds.len() < SHAPES && kinds.insert(h(c).effect.clone())
        } else if bounded(h(c)) {
            switched += 1;
            c.gain > PROMISING && switched <= BOUNDED
        } else {
            effects += 1;
            worth && effects <= REFINED
        }
    })
}

/// Other effects that are there or not at the place of the best one: from where they are not they all look alike (a lag,
/// a dead time).
fn siblings(problem: &Problem<'_>, rest: &[Candidate], front: &Refined) -> Vec<Candidate> {
    let h = |c: &Chosen| &problem.hypotheses[c.hypothesis];
    let own = h(&front.accepted.chosen);
    let alike = |c: &&Candidate| {
        let other = h(&c.chosen);
        c.gain > PROMISING && bounded(other) && other.attachments[0].site == own.attachments[0].site
    };
    if bounded(own) { rest.iter().filter(alike).cloned().collect() } else { Vec::new() }
}

/// The value at which a coefficient stands for the whole effect, if it is a share of one.
fn share(c: &Coefficient) -> Option<f64> {
    c.max.filter(|m| m.is_finite() && *m <= 10.0 * c.nominal.abs())
}

fn bounded(h: &Hypothesis) -> bool {
    h.family != "parameter" && h.coefficients.iter().any(|c| share(c).is_some())
}

/// An effect that acts in few blocks gains much there and loses next to nothing elsewhere; the mean over all blocks
/// does not show it.
fn rare(with: &Fit, without: &Fit, gain: f64) -> bool {
    let (won, lost) = won_and_lost(with, without);
    gain > RARE && won > RARE_RATIO * lost
}

/// Log likelihood won in the blocks that gain, and lost in the others, not scaled.
fn won_and_lost(with: &Fit, without: &Fit) -> (f64, f64) {
    let blocks = with.blocks.iter().zip(&without.blocks);
    blocks.fold((0.0, 0.0), |(won, lost), (a, b)| if a > b { (won + a - b, lost) } else { (won, lost + b - a) })
}

/// Among the candidates that are practically as good as the first, the one with the fewest parameters.
fn simplest(problem: &Problem<'_>, refined: &[Refined]) -> usize {
    let size = |r: &Refined| {
        let h = &problem.hypotheses[r.accepted.chosen.hypothesis];
        h.coefficients.len() + h.shapes.len()
    };
    let front = refined[0].fit.evidence;
    let level = refined.iter().take_while(|r| front - r.fit.evidence < AS_GOOD).count();
    (0..level).min_by_key(|&i| (size(&refined[i]), i)).unwrap_or(0)
}

fn values(fit: &Fit, places: &[usize]) -> Vec<f64> {
    places.iter().map(|&p| fit.setting.theta[p]).collect()
}

/// The model with a set of effects at the values of an earlier fit, and the priors of all that is free.
fn ready(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Assembled, Vec<Prior>)> {
    let chosen: Vec<Chosen> = accepted.iter().map(|a| a.chosen.clone()).collect();
    let mut assembled = problem.assemble(&chosen, &problem.node_sources()).ok()?;
    locate::carry(from, accepted, &mut assembled);
    let mut priors = fit::tolerance_priors(problem);
    for (places, a) in assembled.attached.iter().zip(accepted) {
        for (&parameter, prior) in places.iter().zip(&a.priors) {
            let own = Prior { parameter, ..prior.clone() };
            match priors.iter_mut().find(|p| p.parameter == parameter) {
                Some(p) => *p = own,
                None => priors.push(own),
            }
        }
    }
    Some((assembled, priors))
}

/// Fits a set of effects, from the values of an earlier fit.
fn fitted(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Fit, Assembled)> {
    let (assembled, priors) = ready(problem, from, accepted)?;
    let levels: Vec<f64> = from.setting.sources.iter().map(|s| s.level).collect();
    let setting = assembled.setting(&levels, &from.setting.noise, Vec::new());
    let fit = |s| fit::fit(s, &priors, &problem.train, Some(from.search_share()), RACE);
    let first = fit(setting.clone());
    if let Some(f) = &first
        && f.evidence < from.evidence - HOPELESS
    {
        return first.map(|f| (f, assembled));
    }
    // sources as strong as the model before needed them may hide how right this one is: weaker ones are tried too
    let mut adjusted = setting.clone();
    fit::adjust(&mut adjusted, &problem.train);
    let mut quiet = setting;
    quiet.sources.iter_mut().for_each(|s| s.level *= QUIET);
    let fits = [first, fit(adjusted), fit(quiet)];
    let best = fits.into_iter().flatten().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
    Some((best, assembled))
}

impl Search {
    /// The verdict. `held` is read here and nowhere before; without held recordings the train ones stand in.
    pub fn verdict(&self, problem: &Problem<'_>, held: &[Recording], seconds: f64) -> Verdict {
        Conclusion { problem, search: self }.verdict(held, seconds)
    }

    /// The accepted effects with their fitted values.
    pub fn accepted(&self) -> &[Accepted] {
        &self.accepted
    }

    /// Everything that was refined, round by round, best first.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// The model as the study gives it.
    pub fn nominal(&self, problem: &Problem<'_>) -> super::filter::Setting {
        Conclusion { problem, search: self }.nominal()
    }

    /// The final fit and its model.
    pub fn last(&self) -> (&Fit, &Assembled) {
        (&self.last, &self.last_model)
    }

    /// The fit within tolerances and its model.
    pub fn tolerated(&self) -> (&Fit, &Assembled) {
        (&self.base, &self.base_model)
    }
}
