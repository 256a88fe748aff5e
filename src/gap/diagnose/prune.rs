//! Effects that are dropped again once everything else is there.

use super::super::fit::Fit;
use super::super::held;
use super::super::problem::{Assembled, Problem};
use super::super::screen::Accepted;
use super::Search;
use super::refine::fitted;

/// Part of the simulated gap that opens again without it, of what all effects together close.
const CLOSES: f64 = 0.07;
/// An effect without which the model simulates so many times better has been taken for another.
const WORSE: f64 = 1.5;
/// Deviations by which the last fit tells some value of an effect from none, at least: in 110 plants made anew all effects
/// that were there did so by 6.4 or more.
const SURE: f64 = 5.5;

impl Search {
    /// Drops again what closes little of the simulated gap now that everything else is there: one effect hides another,
    /// so this is asked at the end only.
    pub(super) fn prune(&mut self, problem: &Problem<'_>) {
        while !self.accepted.is_empty() {
            let noise = self.last.setting.noise.clone();
            let gap = |f: &Fit| held::gap_of(problem, &f.setting, &problem.train, &noise);
            let full = gap(&self.last);
            let closable = gap(&self.base).beyond(&full);
            // of several that could go the one goes that was the least sure
            let least = (0..self.accepted.len())
                .filter_map(|i| self.without(problem, i).map(|(f, m)| (i, f, m)))
                .filter(|(_, f, _)| {
                    let gap = gap(f);
                    gap.beyond(&full) < CLOSES * closable || WORSE * gap.total < full.total
                })
                .min_by(|a, b| self.found[a.0].gain.total_cmp(&self.found[b.0].gain));
            let Some((i, fit, model)) = least else { break };
            self.take_out(i, fit, model);
        }
    }

    /// Drops the least sure effect of which the last fit, by what the inputs alone bring about, cannot tell any value from
    /// none; true where there was one. Sources may have led the filter to see it.
    pub(super) fn drop_unsure(&mut self, problem: &Problem<'_>) -> bool {
        let all = (0..self.accepted.len()).map(|i| (i, self.sureness(problem, i)));
        let unsure = all.filter(|(_, sure)| *sure < SURE).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((i, fit, model)) = unsure.and_then(|(i, _)| self.without(problem, i).map(|(f, m)| (i, f, m))) else {
            return false;
        };
        self.take_out(i, fit, model);
        true
    }

    /// By how many deviations the last fit tells an effect's values from none: the surest of them, for one through which an
    /// effect is stiff (what flows over an edge) may be anything large. The parameters count as known: what a tolerance
    /// might also be (a loss in proportion to speed and a smaller displacement) lies beyond it, or the fit without would do.
    fn sureness(&self, problem: &Problem<'_>, i: usize) -> f64 {
        if problem.hypotheses[self.accepted[i].chosen.hypothesis].family == "parameter" {
            return f64::INFINITY;
        }
        let sure = |place: &usize| {
            let prior = self.last.priors.iter().position(|p| p.parameter == *place);
            let deviation = prior.map_or(0.0, |k| self.last.deviation_knowing(k, problem.tolerances.len()));
            let value = self.last.setting.theta[*place].abs();
            if deviation > 0.0 { value / deviation } else { f64::INFINITY }
        };
        self.last_model.attached[i].iter().map(sure).fold(0.0, f64::max)
    }

    /// The fit without one of the accepted effects.
    fn without(&self, problem: &Problem<'_>, i: usize) -> Option<(Fit, Assembled)> {
        let rest: Vec<Accepted> =
            (0..self.accepted.len()).filter(|k| *k != i).map(|k| self.accepted[k].clone()).collect();
        if rest.is_empty() {
            return Some((self.base.clone(), self.base_model.clone()));
        }
        fitted(problem, &self.last, &rest)
    }

    fn take_out(&mut self, i: usize, fit: Fit, model: Assembled) {
        self.accepted.remove(i);
        self.found.remove(i);
        self.adopt(fit, model);
    }
}
