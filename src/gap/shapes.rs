//! Grids of shapes fitted to what the recordings can show: times to the sampling step, thresholds to the values that
//! occur.

use super::hypotheses::{Hypothesis, Signal, Site};
use super::problem::Problem;
use std::collections::BTreeMap;

/// The sampling step for which the effects' own grids of times are made, s.
const STEP: f64 = 1e-3;
/// Thresholds are tried where so much of what occurs lies below them.
const QUANTILES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 0.95];
/// A limit of a signal is tried at these parts of the way from its least to its greatest size.
const PARTS: [f64; 4] = [0.4, 0.6, 0.8, 0.97];

/// Fits all grids.
pub fn fit(problem: &mut Problem<'_>) {
    let slower = problem.step() / STEP;
    let potentials = potentials(problem);
    let sizes = sizes(problem);
    for h in &mut problem.hypotheses {
        let site = h.attachments[0].site.clone();
        let occurs = values(&site, &potentials);
        let size = size(&site, &sizes);
        for shape in &mut h.shapes {
            if shape.unit == "s" && slower > 1.0 {
                shape.grid.iter_mut().for_each(|x| *x *= slower);
            } else if let (true, Some(occurs)) = (shape.threshold, &occurs) {
                shape.grid = QUANTILES.iter().map(|q| occurs[(q * (occurs.len() - 1) as f64) as usize]).collect();
                shape.grid.retain(|x| *x > 0.0);
                shape.grid.dedup();
            } else if let (true, Some((least, most))) = (shape.limit, size) {
                shape.grid = PARTS.iter().map(|part| least + part * (most - least)).collect();
            }
        }
    }
    problem.hypotheses.retain(|h| h.shapes.iter().all(|s| !s.grid.is_empty()));
}

fn thresholds(h: &Hypothesis) -> impl Iterator<Item = usize> {
    let ports = match h.attachments[0].site {
        Site::Node(p) => vec![p],
        Site::Across(a, b) => vec![a, b],
        _ => Vec::new(),
    };
    let compared = h.shapes.iter().any(|s| s.threshold);
    ports.into_iter().filter(move |_| compared)
}

/// Potentials of all ports that a threshold is compared with, as the nominal model has them; empty where it has none.
fn potentials(problem: &Problem<'_>) -> BTreeMap<usize, Vec<f64>> {
    let mut ports: Vec<usize> = problem.hypotheses.iter().flat_map(thresholds).collect();
    ports.sort_unstable();
    ports.dedup();
    let signal = |(i, &p): (usize, &usize)| {
        let port = &problem.circuit.ports[p];
        Signal {
            name: format!("potential_{i}"),
            variable: format!("{}.{}", port.name, port.potential.name),
            scale: 1.0,
        }
    };
    let signals: Vec<Signal> = ports.iter().enumerate().map(signal).collect();
    let found = if ports.is_empty() { None } else { problem.observe(&signals) };
    ports.into_iter().zip(found.unwrap_or_default()).collect()
}

/// What a threshold at this site is compared with, sorted.
fn values(site: &Site, potentials: &BTreeMap<usize, Vec<f64>>) -> Option<Vec<f64>> {
    let mut values = match site {
        Site::Node(p) => potentials.get(p)?.clone(),
        Site::Across(a, b) => potentials.get(a)?.iter().zip(potentials.get(b)?).map(|(a, b)| a - b).collect(),
        _ => return None,
    };
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    if values.is_empty() { None } else { Some(values) }
}

/// Least and greatest size of each signal and of each input, by name.
fn sizes(problem: &Problem<'_>) -> BTreeMap<String, (f64, f64)> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let start = (f64::INFINITY, 0.0_f64);
        values.filter(|v| v.is_finite()).fold(start, |(least, most), v| (v.abs().min(least), v.abs().max(most)))
    };
    let mut sizes = BTreeMap::new();
    for (i, s) in problem.signals.iter().enumerate() {
        let mut values = problem.train.iter().flat_map(|r| r.signals[i].iter().copied());
        sizes.insert(s.name.clone(), range(&mut values));
    }
    for (i, input) in problem.circuit.inputs.iter().enumerate() {
        let mut values = problem.train.iter().filter_map(|r| r.inputs.get(i)).flat_map(|u| u.iter().copied());
        sizes.insert(input.name.clone(), range(&mut values));
    }
    sizes.retain(|_, (least, most)| least < most);
    sizes
}

fn size(site: &Site, sizes: &BTreeMap<String, (f64, f64)>) -> Option<(f64, f64)> {
    match site {
        Site::Sensor(name) | Site::Command(name) => sizes.get(name).copied(),
        _ => None,
    }
}
