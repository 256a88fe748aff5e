//! The whole diagnosis: noise, tolerances, places, effects one after another, and how far the gap shrinks.

mod conclusion;
mod driven;
mod lost;
mod order;
mod prune;
mod refine;

use super::data::Recording;
use super::effects::Coefficient;
use super::filter::{SILENT, Setting, Tape};
use super::fit::{self, Fit, Prior, vuong};
use super::held;
use super::hypotheses::Attachment;
use super::locate::{self, Located};
use super::problem::{Assembled, Chosen, Problem};
use super::recording::{self, Gross};
use super::screen::{self, Accepted, Candidate, Screen};
use super::verdict::Verdict;
use conclusion::Conclusion;
use rayon::prelude::*;
use refine::{AT_BOUND, Refined, best_first, fitted, hidden, promising, siblings, values};

/// Effects that are looked for one after another, at most.
const MOST_EFFECTS: usize = 4;
/// What a shape without a name must be ahead of the best effect, nats and as part of that effect's gain, before nothing
/// that is known explains the gap: a form other than the library's is no other cause.
const AHEAD: f64 = 15.0;
const AHEAD_PART: f64 = 0.2;
/// Part of its gain that a shape must have by what the inputs alone bring about.
const DRIVEN: f64 = 0.25;
/// Mean square of whitened innovations beyond which the levels of the nominal model are no levels.
const BROKEN: f64 = 100.0;
/// And beyond which the filter has gone where the model means nothing: what it says there is rounding.
const ASTRAY: f64 = 1e6;
/// Rounds at most in which the levels of the nominal model settle.
const SETTLING: usize = 5;
/// Factor by which they grow in one of them.
const GROWTH: f64 = 30.0;
/// Gain from which an effect counts as seen, nats.
pub(super) const SEEN: f64 = 8.0;
/// Gain that an effect must have to be accepted, nats: the best of some hundred hypotheses gains much of it by chance.
const CLAIMED: f64 = 12.0;
/// Vuong statistic that it must have.
const CONSISTENT: f64 = 2.0;
/// Vuong statistic that makes up for a gain that is small because few samples count.
const CERTAIN: f64 = 5.0;
/// Gain from which an effect may be one that acts rarely, nats; and how much more it must win than lose.
const RARE: f64 = 20.0;
const RARE_RATIO: f64 = 4.0;
/// Part of the blocks that gain where nearly every one does: by chance half of them do.
const EVERYWHERE: f64 = 0.9;
/// Part of the gain of an accepted effect that a further one of its family or at its place must reach: less is a form
/// other than the library's, not another cause.
const FORM: f64 = 0.25;
/// And any other effect: of a strong effect's form so much remains anywhere.
const REMAINS: f64 = 0.003;
/// Candidates this near are equally good: the simpler one stands first, nats.
const AS_GOOD: f64 = 2.0;
/// Alternatives this near cannot be told apart, nats.
pub(super) const NEAR: f64 = 6.0;
/// Nor those this near that no block prefers clearly.
const NEAR_IF_INCONSISTENT: f64 = 15.0;
/// Part of a gain by which it depends on the levels that were found on the way.
const SCATTER: f64 = 0.02;
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

/// An accepted effect with what came with it.
struct Found {
    gain: f64,
    t: f64,
    alternatives: Vec<(Chosen, f64)>,
}

impl Found {
    /// What the best candidate has over the model before, and those of the others that cannot be told from it.
    fn over(before: &Fit, best: &Refined, others: &[Refined]) -> Self {
        let behind = |r: &Refined| (r.accepted.chosen.clone(), best.fit.evidence - r.fit.evidence);
        Found {
            gain: best.fit.evidence - before.evidence,
            t: vuong(&best.fit.blocks, &before.blocks),
            alternatives: others.iter().filter(|r| near(r, best)).map(behind).collect(),
        }
    }
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

impl Trial {
    /// What a candidate has over the model before.
    fn over(before: &Fit, round: usize, r: &Refined) -> Self {
        Trial {
            round,
            chosen: r.accepted.chosen.clone(),
            gain: r.fit.evidence - before.evidence,
            t: vuong(&r.fit.blocks, &before.blocks),
            won_and_lost: won_and_lost(&r.fit, before),
        }
    }
}

/// A shape that explains more than the best effect, while effects are looked for that together explain as much: two
/// causes at one place may look like one that nobody knows.
struct Pending {
    shape: Refined,
    /// Effects accepted before, and their fit.
    accepted: usize,
    last: Fit,
    last_model: Assembled,
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
    pending: Option<Pending>,
    /// Places that are left.
    left: Vec<Located>,
    /// All refined candidates.
    trials: Vec<Trial>,
    /// Hypotheses that change the model's order and were far from fitting.
    unfit: Vec<usize>,
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
        pending: None,
        left: Vec::new(),
        visible: 0.0,
        trials: Vec::new(),
        unfit: Vec::new(),
        gross,
    };
    while search.gross.is_empty() && search.accepted.len() < MOST_EFFECTS && search.step(problem, progress) {}
    search.shape_or_effects(problem);
    search.prune(problem);
    progress(Stage::Locate);
    loop {
        search.left = if search.accepted.is_empty() {
            search.places.clone()
        } else {
            locate::locate(problem, &search.last, &search.accepted)
        };
        search.simulate(problem);
        if !search.drop_unsure(problem) {
            return Ok(search);
        }
    }
}

/// The nominal model fitted within its tolerances, from its own parameters and from those that bring it nearest to the
/// recordings by the inputs alone: strong sources may hold it where the first ones led.
fn anchor(problem: &Problem<'_>, noise: &[f64]) -> Result<(Fit, Assembled), Trouble> {
    let model = problem.assemble(&[], &problem.node_sources()).map_err(Trouble::Model)?;
    let sources = fit::first_sources(&model, noise, &problem.train).ok_or_else(|| why(problem, &model, noise))?;
    let priors = fit::tolerance_priors(problem);
    let nominal = model.setting(&sources, noise, Vec::new());
    let mut silent = model.setting(&[], &problem.full_scale, Vec::new());
    silent.sources.clear();
    let near = driven::fitted(&problem.train, silent, &priors, None).map(|f| {
        let mut setting = nominal.clone();
        setting.theta[model.free.clone()].copy_from_slice(&f.setting.theta[model.free.clone()]);
        (setting, f.setting.noise)
    });
    let starts: Vec<Setting> = std::iter::once(nominal).chain(near.iter().map(|n| n.0.clone())).collect();
    let followed = |s| settled(problem, s, &priors).filter(|fit| fit.misfit() < ASTRAY);
    let mut fits: Vec<Fit> = starts.into_par_iter().filter_map(followed).collect();
    if let (true, Some((setting, noise))) = (fits.is_empty(), near) {
        // a sensor that folds its signal may drive sources to where the filter has no values: then what the model does not
        // know is noise
        let silent = Setting { sources: setting.sources_times(SILENT), noise, ..setting };
        fits.extend(fit::fit(silent, &priors, &problem.train, None, fit::ITERATIONS));
    }
    let share = fits.iter().map(|f| f.share).fold(0.0, f64::max);
    let best = fits.into_iter().map(|f| f.at_share(share)).max_by(|a, b| a.evidence.total_cmp(&b.evidence));
    let diverges = || Trouble::Diverges(0.0, "the model has no values on the way".into());
    Ok((fit::polish(best.ok_or_else(diverges)?, &problem.train, None), model))
}

/// Levels and parameters from those in the setting.
fn settled(problem: &Problem<'_>, from: Setting, priors: &[Prior]) -> Option<Fit> {
    let in_rounds = |rounds: usize, growth: f64| {
        let mut setting = from.clone();
        fit::adjust_slowly(&mut setting, &problem.train, rounds, growth)?;
        fit::fit(setting, priors, &problem.train, None, fit::ITERATIONS)
    };
    match in_rounds(1, f64::INFINITY) {
        Some(first) if first.misfit() < BROKEN => Some(first),
        // levels that were found far from where they lead are found step by step
        broken => in_rounds(SETTLING, GROWTH).or(broken),
    }
}

fn why(problem: &Problem<'_>, model: &Assembled, noise: &[f64]) -> Trouble {
    let setting = model.setting(&[], noise, Vec::new());
    for r in &problem.train {
        if let Err((time, e)) = super::filter::run(&setting, r, 0, usize::MAX, Tape::Nothing) {
            return Trouble::Diverges(time, e.to_string());
        }
    }
    Trouble::Diverges(0.0, "the model has no values on the way".into())
}

impl Search {
    /// Looks for one more effect; true when one was accepted and another may follow.
    fn step(&mut self, problem: &Problem<'_>, progress: &mut dyn FnMut(Stage)) -> bool {
        let number = self.accepted.len() + 1;
        progress(Stage::Screen(number));
        let screen = Screen::new(problem, &self.accepted);
        let followed = screen.as_ref().map_or_else(Vec::new, |s| s.followed(&self.last, &self.accepted));
        if number == 1 {
            let seen = followed.iter().filter(|c| c.visible > SEEN).count();
            self.visible = seen as f64 / followed.len().max(1) as f64;
        }
        let plain = screen::is_plain(problem, &followed);
        let course = if plain { None } else { self.course(problem) };
        let driven = screen.zip(course.as_ref()).map_or_else(Vec::new, |(s, c)| c.screened(&s, &self.last));
        progress(Stage::Refine(number));
        let refined = self.ranked(problem, followed, &driven);
        self.trials.extend(refined.iter().map(|r| Trial::over(&self.last, number, r)));
        let further = self.decide(problem, refined);
        let open = self.accepted.len() < number && self.shape.is_none() && self.pending.is_none();
        further || open && course.is_some_and(|c| self.course_explained(problem, &c, driven))
    }

    /// The promising candidates, refined; best first.
    fn ranked(&mut self, problem: &Problem<'_>, followed: Vec<Candidate>, driven: &[Candidate]) -> Vec<Refined> {
        let (mut chosen, rest) = promising(problem, &self.last, followed);
        hidden(&mut chosen, driven);
        chosen.extend(self.unseen(problem, &chosen));
        chosen.extend(self.late(problem, &chosen));
        chosen.extend(self.reordering(problem));
        let mut refined = self.refined(problem, &chosen);
        if let Some(front) = refined.first() {
            let others = siblings(problem, &chosen, &rest, front);
            refined.extend(self.refined(problem, &others));
            best_first(&mut refined);
            let kin = self.kin(problem, &refined);
            refined.extend(self.refined(problem, &kin));
            best_first(&mut refined);
        }
        self.sharpen(problem, &mut refined);
        best_first(&mut refined);
        if let Some(front) = refined.first() {
            self.relevel(problem, &front.fit);
        }
        refined
    }

    /// Accepts the best effect if it is convincing; true when another may follow.
    fn decide(&mut self, problem: &Problem<'_>, refined: Vec<Refined>) -> bool {
        let (shapes, mut refined): (Vec<Refined>, Vec<Refined>) =
            refined.into_iter().partition(|r| r.is_shape(problem));
        if let Some(shape) = shapes.into_iter().find(|s| self.nothing_known(problem, s, refined.first())) {
            let effect = refined.first().is_some_and(|best| self.convinces(problem, best));
            let first = self.pending.is_none();
            if first && effect {
                let (last, last_model) = (self.last.clone(), self.last_model.clone());
                self.pending = Some(Pending { shape, accepted: self.accepted.len(), last, last_model });
            } else if first {
                self.shaped(problem, shape);
            }
            if !effect {
                return false;
            }
        }
        if refined.is_empty() {
            return false;
        }
        if let Some((best, found)) = self.lost(problem, &refined) {
            // nothing further can be weighed beside an effect that the filter cannot follow, nor can a shape
            self.pending = None;
            self.accept(best, found);
            return false;
        }
        refined.retain(|r| !self.halved(problem, r));
        if refined.is_empty() {
            return false;
        }
        // what is as good as the form of an accepted effect is no other cause
        let mends = |r: &Refined| self.mends_form(problem, &r.accepted, self.gain(&r.fit));
        let form = refined.iter().any(|r| as_good(r, &refined[0]) && mends(r));
        let best = refined.remove(simplest(problem, &refined, self.last.evidence));
        if form || !self.convinces(problem, &best) || mends(&best) {
            return false;
        }
        let found = Found::over(&self.last, &best, &refined);
        self.accept(best, found);
        // a second effect is looked for beside a shape, a third one only where the two come near it
        let behind = |p: &Pending| self.accepted.len() > p.accepted + 1 && p.shape.fit.evidence > self.last.evidence;
        !self.pending.as_ref().is_some_and(behind)
    }

    /// Whether an effect gains enough, and in most blocks, or where it acts.
    fn convinces(&self, problem: &Problem<'_>, best: &Refined) -> bool {
        let gain = self.gain(&best.fit);
        let count = problem.tolerances.len();
        let returned = self.last.prior_cost(count) - best.fit.prior_cost(count);
        let h = &problem.hypotheses[best.accepted.chosen.hypothesis];
        // a parameter that is let go always returns from its bound, and acts at all times; so does what has no point at
        // which it begins (a time is none); a second effect at the place of another may mend that one's form only
        let site = |a: &Accepted| &problem.hypotheses[a.chosen.hypothesis].attachments[0].site;
        let again = self.accepted.iter().any(|a| site(a).is_at(&h.attachments[0].site));
        let returns = h.family != "parameter" && !again && returned > 0.5 * gain;
        let begins = h.shapes.iter().any(|s| s.unit != "s");
        let seldom = returns || !again && begins && rare(&best.fit, &self.last, gain);
        let t = vuong(&best.fit.blocks, &self.last.blocks);
        // where one block gains more than all others together the mean is as unsure as that one is rare
        let steady = || t > CONSISTENT || everywhere(&best.fit, &self.last);
        // blocks are long against most colours: where they agree so well it does not matter how few samples count
        gain >= CLAIMED && (seldom || steady())
            || gain > 0.0 && t > CERTAIN && won_and_lost(&best.fit, &self.last).0 > RARE
    }

    /// Whether an effect that is there or not would rather be there by less than half: it is something else.
    fn halved(&self, problem: &Problem<'_>, r: &Refined) -> bool {
        let h = &problem.hypotheses[r.accepted.chosen.hypothesis];
        let at_bound = |(i, c): (usize, &Coefficient)| {
            c.whole().is_some() && r.accepted.chosen.values[i] <= r.accepted.priors[i].min * (1.0 + AT_BOUND)
        };
        h.is_bounded() && h.coefficients.iter().enumerate().any(at_bound)
    }

    /// Whether an effect is the remainder of an accepted one of its family at its place, or a small one of its family, at a
    /// node of its, or a tiny one anywhere: the machine's form may differ from that one's.
    fn mends_form(&self, problem: &Problem<'_>, best: &Accepted, gain: f64) -> bool {
        let h = &problem.hypotheses[best.chosen.hypothesis];
        let site = &h.attachments[0].site;
        let least = |a: &Accepted, gain: f64| {
            let other = &problem.hypotheses[a.chosen.hypothesis];
            let place = &other.attachments[0].site;
            let kin = other.family == h.family;
            if kin && place.is_at(site) {
                f64::INFINITY
            } else if kin || place.is_at(site) || place.meets(site, &problem.circuit) {
                FORM * gain
            } else {
                REMAINS * gain
            }
        };
        let least = self.accepted.iter().zip(&self.found).map(|(a, f)| least(a, f.gain)).fold(0.0, f64::max);
        h.family != "parameter" && !h.shapes.iter().any(|s| s.order) && gain < least
    }

    fn accept(&mut self, best: Refined, found: Found) {
        self.found.push(found);
        self.accepted.push(best.accepted);
        self.adopt(best.fit, best.assembled);
    }

    /// Whether a hypothesis is accepted.
    fn has(&self, hypothesis: usize) -> bool {
        self.accepted.iter().any(|a| a.chosen.hypothesis == hypothesis)
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
        let ahead = gain > SEEN && gain - named > AHEAD.max(AHEAD_PART * named);
        // what acts seldom may as well be a disturbance that came once: a shape has to explain most blocks better
        let consistent = || vuong(&shape.fit.blocks, &rival.blocks) > CONSISTENT;
        // or brings it about better than the best effect does
        let by_rival = || best.and_then(|b| driven::gain(problem, b, &self.last)).unwrap_or(0.0).max(0.0);
        let driven = || {
            let driven = driven::gain(problem, shape, &self.last);
            driven.is_some_and(|driven| driven > DRIVEN * gain || driven > CLAIMED && driven > AHEAD + by_rival())
        };
        ahead && consistent() && driven()
    }

    /// Goes back to the shape that is pending where the effects accepted since do not explain as much together.
    fn shape_or_effects(&mut self, problem: &Problem<'_>) {
        let Some(Pending { shape, accepted, last, last_model }) = self.pending.take() else { return };
        let share = self.last.share;
        let shape = Refined { fit: shape.fit.at_share(share), ..shape };
        if shape.fit.evidence > self.last.evidence {
            self.accepted.truncate(accepted);
            self.found.truncate(accepted);
            self.adopt(last.at_share(share), last_model);
            self.shaped(problem, shape);
        }
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
        let gap = |f: &Fit| held::gap_of(problem, &f.setting, &problem.train, &with.setting.noise).total;
        let before = gap(&self.last);
        let closes = if before > 0.0 { 1.0 - (gap(&with) / before).powi(2) } else { 0.0 };
        self.shape = Some(Shaped { hypothesis, gain, closes });
    }

    /// Takes parameters that simulate better, where there are such; with effects, if they are still more likely than the
    /// model without: a course may come near where disturbances are taken for parameters and the effect is gone.
    fn simulate(&mut self, problem: &Problem<'_>) {
        let (last, model) = (driven::simulating(problem, self.last.clone()), self.last_model.clone());
        let base = if self.accepted.is_empty() { last.clone() } else { driven::simulating(problem, self.base.clone()) };
        if self.accepted.is_empty() || fit::likelihood(&last.setting, &problem.train) > Some(self.base.likelihood) {
            self.adopt(last, model);
        }
        self.base = base;
    }
}

/// Whether the data cannot tell a candidate from the best one.
fn near(r: &Refined, best: &Refined) -> bool {
    let behind = best.fit.evidence - r.fit.evidence;
    let worse = certainly_worse(&r.fit, &best.fit);
    behind < NEAR || behind < NEAR_IF_INCONSISTENT && !worse
}

/// Whether a model is worse than the best one in most blocks, its fewer parameters counted in.
fn certainly_worse(fit: &Fit, best: &Fit) -> bool {
    let price = (fit.likelihood - best.likelihood) - (fit.evidence - best.evidence) / best.share;
    let each = price / best.blocks.len().max(1) as f64;
    let best: Vec<f64> = best.blocks.iter().map(|b| b + each).collect();
    vuong(&fit.blocks, &best) < CERTAINLY_WORSE
}

/// An effect that acts in few blocks gains much there and loses next to nothing elsewhere; the mean over all blocks
/// does not show it.
fn rare(with: &Fit, without: &Fit, gain: f64) -> bool {
    let (won, lost) = won_and_lost(with, without);
    gain > RARE && won > RARE_RATIO * lost
}

/// Whether nearly every block gains.
fn everywhere(with: &Fit, without: &Fit) -> bool {
    let gained = with.blocks.iter().zip(&without.blocks).filter(|(a, b)| a > b).count();
    gained as f64 > EVERYWHERE * with.blocks.len() as f64
}

/// Log likelihood won in the blocks that gain, and lost in the others, not scaled.
fn won_and_lost(with: &Fit, without: &Fit) -> (f64, f64) {
    let blocks = with.blocks.iter().zip(&without.blocks);
    blocks.fold((0.0, 0.0), |(won, lost), (a, b)| if a > b { (won + a - b, lost) } else { (won, lost + b - a) })
}

/// Whether a candidate is practically as good as another one.
fn as_good(r: &Refined, front: &Refined) -> bool {
    front.fit.evidence - r.fit.evidence < AS_GOOD && !certainly_worse(&r.fit, &front.fit)
}

/// Among the candidates that are practically as good as the first, the one with the fewest parameters and states that
/// leaves the machine nearest to its data sheet, and of its family the one at the fewest nodes. An effect that cuts a
/// connection is named only where the data tell it from all others that leave the network as it is: slip of a pump's shaft
/// is a leak across the pump, but for the inertia in between.
fn simplest(problem: &Problem<'_>, refined: &[Refined], before: f64) -> usize {
    let h = |r: &Refined| &problem.hypotheses[r.accepted.chosen.hypothesis];
    let size = |r: &Refined| {
        let states = h(r).attachments[0].effect.as_ref().map_or(0, |e| e.states);
        (h(r).changes_order, h(r).coefficients.len() + h(r).shapes.len() + states)
    };
    let front = &refined[0];
    let behind = |r: &Refined| front.fit.evidence - r.fit.evidence;
    let rivals = |r: &Refined| {
        let scatter = SCATTER * (front.fit.evidence - before);
        let whole = h(front).changes_order && !h(r).changes_order && h(r).family != h(front).family;
        whole && (behind(r) < scatter || near(r, front)) || as_good(r, front)
    };
    let sheet = |r: &Refined| behind(r) + r.fit.prior_cost(problem.tolerances.len());
    let simpler = |a: &usize, b: &usize| {
        let (a, b) = (&refined[*a], &refined[*b]);
        size(a).cmp(&size(b)).then(sheet(a).total_cmp(&sheet(b)))
    };
    let equal: Vec<usize> = (0..refined.len()).filter(|&i| i == 0 || rivals(&refined[i])).collect();
    let Some(best) = equal.iter().copied().min_by(simpler) else { return 0 };
    let nodes = |i: &usize| {
        let touched = |a: &Attachment| a.site.free_ports(&problem.circuit).len();
        h(&refined[*i]).attachments.iter().map(touched).sum::<usize>()
    };
    let alike =
        |i: &usize| h(&refined[*i]).family == h(&refined[best]).family && size(&refined[*i]) == size(&refined[best]);
    let kin = equal.into_iter().filter(alike);
    kin.min_by(|a, b| nodes(a).cmp(&nodes(b)).then_with(|| simpler(a, b))).unwrap_or(best)
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

    /// Places where something is left, most first.
    pub fn left(&self) -> &[Located] {
        &self.left
    }

    /// Everything that was refined, round by round, best first.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// The model as the study gives it.
    pub fn nominal(&self, problem: &Problem<'_>) -> Setting {
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
