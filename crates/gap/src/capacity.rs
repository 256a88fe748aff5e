//! Effects that are a part of what a node has already: gas that warms under compression gives way late by less than it
//! gives way at once. What a node has is read off the nominal model: how fast its potential answers to a flow.

use super::circuit::same_kind;
use super::data::InputSegment;
use super::estimate::start::ParameterisedModel;
use super::hypotheses::{AttachmentSite, Hypothesis};
use super::problem::DiagnosisProblem;
use std::collections::BTreeMap;

/// Usual part of the node's own capacity. It is also far enough below the whole for the coefficient to count as a size, not
/// as something that is there or not.
const USUAL: f64 = 0.05;

/// Bounds such effects by the smallest capacity of their nodes; where there is none they make no sense.
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
        let capacity = h.attachments.iter().map(|a| of_node(&a.site)).fold(f64::INFINITY, f64::min);
        for c in h.coefficients.iter_mut().filter(|c| c.part) {
            (c.max, c.nominal) = (Some(capacity), USUAL * capacity);
        }
        capacity > 0.0 && capacity.is_finite()
    };
    problem.hypotheses.retain_mut(limit);
}

/// Per node, the flow over the rate of its potential that it causes at once.
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
    local.linearize(first.times[k], &begun.state, &model.theta, &u).ok()?;
    let mut found = BTreeMap::new();
    for (&source, parameter) in sources.iter().zip(model.sources.clone()) {
        let site = &problem.disturbances[source].attachments[0].site;
        let AttachmentSite::Node(port) = site else { continue };
        let unit = &problem.circuit.ports[*port].potential.unit;
        let own = |i: &usize| model.plan.state_unit(*i).is_some_and(|u| same_kind(u, unit));
        let answer =
            (0..local.rates.len()).filter(own).map(|i| local.linear.b[(i, parameter)].abs()).fold(0.0, f64::max);
        if answer > 0.0 && answer.is_finite() {
            found.insert(site.clone(), 1.0 / answer);
        }
    }
    Some(found)
}
