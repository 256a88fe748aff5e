//! Bounds of effects that are a part of what a node has already.
//!
//! Example: gas that warms under compression gives way late by less than it gives way at once. The capacity of a node
//! is read off the nominal model: how fast its potential reacts to a flow.
//! Enters and leaves: the problem, whose hypotheses get bounds or are removed. Called by `study`.

use super::circuit::same_kind;
use super::data::InputSegment;
use super::estimate::start::ParameterisedModel;
use super::hypotheses::{AttachmentSite, Hypothesis};
use super::problem::DiagnosisProblem;
use std::collections::BTreeMap;

/// Typical part of the node's own capacity. It is small enough for the coefficient to count as a size, not as a share
/// of a whole (see `EffectCoefficient::whole`).
const USUAL: f64 = 0.05;

/// Bounds such effects by the smallest capacity of their nodes, and removes those at nodes without one.
pub fn bound(problem: &mut DiagnosisProblem<'_>) {
    let part = |h: &Hypothesis| h.coefficients.iter().any(|c| c.part);
    if !problem.hypotheses.iter().any(part) {
        return;
    }
    let capacities = capacities(problem).unwrap_or_default();
    let limit = |h: &mut Hypothesis| {
        if !part(h) {
            return true;
        }
        let of_node = |site: &AttachmentSite| capacities.get(site).copied().unwrap_or(0.0);
        // a coefficient shared by several nodes must fit at each of them
        let capacity = h.attachments.iter().map(|a| of_node(&a.site)).fold(f64::INFINITY, f64::min);
        for c in h.coefficients.iter_mut().filter(|c| c.part) {
            (c.max, c.nominal) = (Some(capacity), USUAL * capacity);
        }
        capacity > 0.0 && capacity.is_finite()
    };
    problem.hypotheses.retain_mut(limit);
}

/// Capacity of each node: flow over the rate of potential that it causes at once, in the units of the model.
/// `None` if the nominal model does not compile or cannot be evaluated.
fn capacities(problem: &DiagnosisProblem<'_>) -> Option<BTreeMap<AttachmentSite, f64>> {
    let sources = problem.node_sources();
    let model = problem.assemble(&[], &sources).ok()?;
    let first = problem.train.first()?;
    let units: Vec<String> = problem.signals.iter().map(|s| problem.unit(s)).collect();
    let valued = ParameterisedModel {
        plan: &model.plan,
        theta: &model.theta,
        sizes: &model.sizes,
        correction: model.correction,
        travel: &model.travel,
        units: &units,
        deviations: &problem.full_scale,
    };
    let begun = valued.begin(first, None, None)?;
    let (mut local, k) = (begun.local, first.settled());
    let mut u = InputSegment::new(first).from;
    first.input(k, &mut u);
    // at the end of the first recording's beginning, where the state is known
    local.linearize(first.times[k], &begun.state, &model.theta, &u).ok()?;
    let mut found = BTreeMap::new();
    for (&source, parameter) in sources.iter().zip(model.sources.clone()) {
        let site = &problem.disturbances[source].attachments[0].site;
        let AttachmentSite::Node(port) = site else { continue };
        let unit = &problem.circuit.ports[*port].potential.unit;
        let own = |i: &usize| model.plan.state_unit(*i).is_some_and(|u| same_kind(u, unit));
        // a flow acts on several states at once; the potential itself is the one of its unit that reacts most
        let answer =
            (0..local.rates.len()).filter(own).map(|i| local.linear.b[(i, parameter)].abs()).fold(0.0, f64::max);
        if answer > 0.0 && answer.is_finite() {
            found.insert(site.clone(), 1.0 / answer);
        }
    }
    Some(found)
}
