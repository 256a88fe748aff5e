//! Grids of shapes fitted to what the recordings can show: times to the sampling step, thresholds to the values that
//! occur, forms over a potential to its range, frequencies to the lines that the nominal model has not.

use super::circuit::{CircuitTopology, same_kind};
use super::data::RecordingData;
use super::effects::{EffectCoefficient, ShapeParameter};
use super::hypotheses::{AttachmentSite, EffectAttachment, Hypothesis, SensorSignal};
use super::lines;
use super::problem::DiagnosisProblem;
use bramah_expr::units::MeasurementUnit;
use std::collections::BTreeMap;

/// The sampling step for which the effects' own grids of times are made, s.
const STEP: f64 = 1e-3;
/// Times are at most this part of the longest recording, and are looked for, a decade further each, up to this one.
const LASTING: f64 = 1.0 / 3.0;
const LOOKED_FOR: f64 = 0.1;
/// Thresholds are tried where so much of what occurs lies below them.
const QUANTILES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 0.95];
/// Part of the speeds that are no jumps.
const USUAL: f64 = 0.995;
/// A corner is at most so wide, in parts of the greatest value at its place: what moves less would never leave it.
const CORNER: f64 = 0.02;
/// Distances (play, deflection before a friction breaks loose) are looked for in decades between these parts of the travel: the
/// resolution of a fine position sensor, and a play that takes a third of the motion.
const DISTANCES: [f64; 2] = [1e-5, 0.3];
/// One turn, rad: a shaft that turns on and on has no longer travel.
const TURN: f64 = std::f64::consts::TAU;
/// Friction that falls with speed falls over these parts of the greatest speed.
const FALLS: [f64; 3] = [0.01, 0.05, 0.2];

/// What is periodic is seen to come again: periods that the recordings cover, at least.
const REPEATS: f64 = 2.0;
/// Pressure of the surroundings, Pa.
const ATMOSPHERE: f64 = 101_325.0;

/// A variable of a port: its potential, or what flows through it.
type PortVariable = (usize, bool);
/// What the nominal model says of such variables over all recordings, one after the other, SI.
type NominalTrajectories = BTreeMap<PortVariable, Vec<f64>>;
/// A limit of a signal is tried at these parts of the way from its least to its greatest size.
const PARTS: [f64; 4] = [0.4, 0.6, 0.8, 0.97];

/// Fits all grids.
pub fn fit(problem: &mut DiagnosisProblem<'_>) {
    let slower = problem.step() / STEP;
    let longest = problem.train.iter().map(RecordingData::duration).fold(0.0, f64::max);
    let potentials = potentials(problem);
    let sizes = sizes(problem);
    let times: Vec<&[f64]> = problem.train.iter().map(|r| &r.times[..]).collect();
    let ranged = |a: &mut EffectAttachment| {
        range(a, &potentials, &times).is_none_or(|range| {
            let known = !range.is_empty();
            a.base.extend(range);
            known
        })
    };
    let periodic = problem.hypotheses.iter().any(|h| h.shapes.iter().any(|s| s.line));
    let lines = if periodic { lines::lines(problem) } else { Vec::new() };
    let mut hypotheses = std::mem::take(&mut problem.hypotheses);
    let attachments = hypotheses.iter_mut().flat_map(|h| &mut h.attachments);
    attachments.for_each(|a| take_surroundings(a, &potentials, &times));
    hypotheses.retain_mut(|h| h.attachments.iter_mut().all(ranged));
    problem.hypotheses = hypotheses;
    let recordings = problem.train.len();
    for h in &mut problem.hypotheses {
        each_its_own(&mut h.coefficients, recordings);
        let site = h.attachments[0].site.clone();
        let size = size(&site, &sizes);
        if let (AttachmentSite::Command(_), Some((_, most))) = (&site, size) {
            // the range of a command shows in the recordings only
            h.passes = Some(most);
        }
        for shape in &mut h.shapes {
            if let (true, Some(travel)) = (shape.order, turned(&site, &potentials, &problem.circuit)) {
                shape.grid.retain(|n| n * travel >= REPEATS);
            } else if shape.line {
                shape.grid.clone_from(&lines);
            } else if shape.unit == "s" {
                time(shape, slower, longest);
            } else if let (true, Some(fastest)) = (is_speed(shape), fastest(&site, &potentials, &times)) {
                if is_corner(shape) {
                    corner(shape, fastest);
                } else {
                    shape.grid = FALLS.iter().map(|part| part * fastest).collect();
                }
            } else if let (true, Some(most)) = (is_corner(shape), greatest(shape, &site, &potentials, &problem.circuit))
            {
                corner(shape, most);
            } else if let (true, Some(travel)) = (is_distance(shape), travel(&site, &potentials)) {
                distances(shape, travel);
            } else if let Some(occurs) = values(shape, &site, &potentials) {
                shape.grid = QUANTILES.iter().map(|q| occurs[(q * (occurs.len() - 1) as f64) as usize]).collect();
                shape.grid.retain(|x| *x > 0.0);
                shape.grid.dedup();
                // a brim makes no sense at the pressures of a press, nor a relief valve at those of a level
                if shape.grid.iter().any(|x| shape.min.is_some_and(|m| *x < m) || shape.max.is_some_and(|m| *x > m)) {
                    shape.grid.clear();
                }
            } else if let (true, Some((least, most))) = (shape.limit, size) {
                shape.grid = PARTS.iter().map(|part| least + part * (most - least)).collect();
            } else if let (true, AttachmentSite::Command(name), Some((_, most))) = (shape.relative, &site, size) {
                let declared = problem.circuit.inputs.iter().find(|i| i.name == *name).and_then(|i| i.nominal);
                shape.grid.iter_mut().for_each(|x| *x *= most / declared.unwrap_or(1.0));
            }
        }
    }
    problem.hypotheses.retain(|h| h.shapes.iter().all(|s| !s.grid.is_empty()));
}

/// Coefficients that differ from recording to recording, one for each.
fn each_its_own(coefficients: &mut Vec<EffectCoefficient>, recordings: usize) {
    let (own, mut all): (Vec<_>, Vec<_>) = coefficients.drain(..).partition(|c| c.recording.is_some());
    let numbered = |k: usize| own.iter().map(move |c| EffectCoefficient { recording: Some(k), ..c.clone() });
    all.extend((0..recordings).flat_map(numbered));
    *coefficients = all;
}

/// A corner that is left by most of what occurs, and may be as wide as all of it.
fn corner(shape: &mut ShapeParameter, most: f64) {
    shape.grid[0] = shape.grid[0].min(CORNER * most);
    shape.occurs = Some(most);
}

/// A time within what the recordings show: what takes longer than a part of them to fade is not seen to fade at all.
fn time(shape: &mut ShapeParameter, slower: f64, longest: f64) {
    let most = LASTING * longest;
    shape.grid.iter_mut().for_each(|x| *x = (*x * slower).min(most));
    let further = |x: &f64| Some(10.0 * x).filter(|x| *x <= LOOKED_FOR * longest);
    let last = shape.grid.last().copied();
    shape.grid.extend(std::iter::successors(last.as_ref().and_then(further), further));
    shape.grid.dedup();
    shape.max = Some(shape.max.map_or(most, |m| m.min(most)));
}

/// Distances in decades from the effect's own, down to what no machine shows and up to what hinders every motion.
fn distances(shape: &mut ShapeParameter, travel: f64) {
    let [least, most] = DISTANCES.map(|part| part * travel);
    let Some((low, high)) = extent(&shape.grid) else { return };
    let below = std::iter::successors(Some(0.1 * low), |x| Some(0.1 * x)).take_while(|x| *x >= least);
    let above = std::iter::successors(Some(10.0 * high), |x| Some(10.0 * x)).take_while(|x| *x <= most);
    shape.grid.extend(below.chain(above));
    shape.grid.retain(|x| *x <= travel);
    shape.grid.sort_by(f64::total_cmp);
}

/// Ports at which an effect acts, where a potential of theirs counts.
fn ports(site: &AttachmentSite) -> Vec<usize> {
    match *site {
        AttachmentSite::Node(p) => vec![p],
        AttachmentSite::Across(a, b) => vec![a, b],
        _ => Vec::new(),
    }
}

/// Whether a shape is the speed over which a friction changes sign, or falls.
fn is_speed(shape: &ShapeParameter) -> bool {
    ["rad/s", "m/s"].iter().any(|u| same_kind(&shape.unit, u))
}

/// Whether a shape is the width over which something changes sign: it has one value, in the unit of what changes it.
fn is_corner(shape: &ShapeParameter) -> bool {
    shape.grid.len() == 1 && !shape.relative && !shape.unit.is_empty()
}

/// Whether a shape is a distance of two bodies.
fn is_distance(shape: &ShapeParameter) -> bool {
    ["rad", "m"].iter().any(|u| same_kind(&shape.unit, u))
}

/// Greatest size of what a corner's effect depends on: the potential of its place, or what flows through it; nothing where
/// the shape has another unit, or nothing happens.
fn greatest(
    shape: &ShapeParameter,
    site: &AttachmentSite,
    potentials: &NominalTrajectories,
    circuit: &CircuitTopology,
) -> Option<f64> {
    let (p, values) = match *site {
        AttachmentSite::Node(p) | AttachmentSite::Across(p, _) => {
            (&circuit.ports[p].potential, acting(site, potentials)?)
        }
        AttachmentSite::Into(p) => (&circuit.ports[p].through, potentials.get(&(p, true))?.clone()),
        _ => return None,
    };
    let (least, most) = extent(&values)?;
    Some(most.max(-least)).filter(|most| *most > 0.0 && same_kind(&shape.unit, &p.unit))
}

/// How far a site travels, one side against the other where it has two; nothing where it stands still.
fn travel(site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<f64> {
    let (least, most) = extent(&acting(site, potentials)?)?;
    Some((most - least).min(TURN)).filter(|t| *t > 0.0)
}

/// Least and greatest of some values; nothing where none is finite.
fn extent(values: &[f64]) -> Option<(f64, f64)> {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold(None, |known: Option<(f64, f64)>, v| Some(known.map_or((v, v), |(l, m)| (l.min(v), m.max(v)))))
}

/// Turns that a shaft makes in the nominal model.
fn turned(site: &AttachmentSite, potentials: &NominalTrajectories, circuit: &CircuitTopology) -> Option<f64> {
    let (AttachmentSite::Node(p) | AttachmentSite::Across(p, _)) = site else { return None };
    let angle = acting(site, potentials).filter(|_| same_kind(&circuit.ports[*p].potential.unit, "rad"))?;
    let (least, most) = extent(&angle)?;
    Some((most - least) / TURN)
}

/// Greatest speed at a site, of one side against the other where it has two; nothing where it stands still.
fn fastest(site: &AttachmentSite, potentials: &NominalTrajectories, times: &[&[f64]]) -> Option<f64> {
    speeds(&acting(site, potentials)?, times).last().copied().filter(|v| *v > 0.0)
}

/// The potential of a site, of one side against the other where it has two.
fn acting(site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<Vec<f64>> {
    let of = |p: usize| potentials.get(&(p, false));
    match *site {
        AttachmentSite::Node(p) => of(p).cloned(),
        AttachmentSite::Across(a, b) => Some(of(a)?.iter().zip(of(b)?).map(|(a, b)| a - b).collect()),
        _ => None,
    }
}

fn compared(h: &Hypothesis) -> impl Iterator<Item = PortVariable> {
    let measured =
        |s: &ShapeParameter| s.threshold || s.level || s.order || is_speed(s) || is_corner(s) || is_distance(s);
    let compared = h.shapes.iter().any(measured) || h.attachments.iter().any(|a| surroundings(a).is_some());
    let site = &h.attachments[0].site;
    let potentials = ports(site).into_iter().map(|p| (p, false));
    let through = if let AttachmentSite::Into(p) = site { Some((*p, true)) } else { None };
    potentials.chain(through).filter(move |_| compared)
}

/// The parameter of an effect that is the pressure of the surroundings.
fn surroundings(a: &EffectAttachment) -> Option<&String> {
    a.effect.as_ref()?.surroundings.as_ref()
}

/// Counts pressures from the surroundings where the model does: no machine at rest has half of them.
fn take_surroundings(a: &mut EffectAttachment, potentials: &NominalTrajectories, times: &[&[f64]]) {
    let Some((name, pressure)) = surroundings(a).cloned().zip(acting(&a.site, potentials)) else { return };
    let begins = times.iter().scan(0, |from, t| {
        let first = pressure.get(*from).copied();
        *from += t.len();
        first
    });
    if begins.fold(f64::INFINITY, f64::min) < 0.5 * ATMOSPHERE {
        a.base.push((name, "0".into()));
    }
}

/// The variable whose range an effect takes.
fn ranged(a: &EffectAttachment) -> Option<PortVariable> {
    let effect = a.effect.as_ref()?;
    let range = effect.range.as_ref()?;
    let i = &effect.interface;
    if let (AttachmentSite::Into(p), Some(through)) = (&a.site, &i.through) {
        return (through.name == range.of).then_some((*p, true));
    }
    let mut read = i.potential.iter().zip(ports(&a.site)).chain(i.sense.iter().zip(a.sense.iter().copied()));
    read.find(|(q, _)| q.name == range.of).map(|(_, p)| (p, false))
}

/// The parameters that take the range of a potential, with their values; empty where it stands still or is not known,
/// `None` for effects without.
fn range(a: &EffectAttachment, potentials: &NominalTrajectories, times: &[&[f64]]) -> Option<Vec<(String, String)>> {
    let names = a.effect.as_ref()?.range.as_ref()?;
    let potential = ranged(a).and_then(|p| potentials.get(&p)).map_or(&[][..], Vec::as_slice);
    let values = if names.rate { speeds(potential, times) } else { potential.to_vec() };
    let Some((least, most)) = extent(&values) else { return Some(Vec::new()) };
    let moves = most - least > 1e-9 * most.abs().max(least.abs());
    let value = |name: &String, x: f64| (name.clone(), format!("{x:e}"));
    Some(if moves { vec![value(&names.least, least), value(&names.most, most)] } else { Vec::new() })
}

/// Sizes of the rate of a potential that is known over all recordings, one after the other; without the few greatest,
/// which are jumps.
fn speeds(potential: &[f64], times: &[&[f64]]) -> Vec<f64> {
    let mut from = 0;
    let mut speeds = Vec::new();
    for times in times {
        let Some(own) = potential.get(from..from + times.len()) else { break };
        from += times.len();
        let rate = |(x, t): (&[f64], &[f64])| ((x[1] - x[0]) / (t[1] - t[0])).abs();
        speeds.extend(own.windows(2).zip(times.windows(2)).map(rate).filter(|v| v.is_finite()));
    }
    speeds.sort_by(f64::total_cmp);
    speeds.truncate((USUAL * speeds.len() as f64) as usize);
    speeds
}

/// Variables of all ports that a threshold, a corner or a range needs, as the nominal model has them; empty where it has none.
fn potentials(problem: &DiagnosisProblem<'_>) -> NominalTrajectories {
    let mut wanted: Vec<PortVariable> = problem.hypotheses.iter().flat_map(compared).collect();
    wanted.extend(problem.hypotheses.iter().flat_map(|h| &h.attachments).filter_map(ranged));
    wanted.sort_unstable();
    wanted.dedup();
    let signal = |(i, &(p, flows)): (usize, &PortVariable)| {
        let port = &problem.circuit.ports[p];
        let own = if flows { &port.through } else { &port.potential };
        SensorSignal { name: format!("potential_{i}"), variable: format!("{}.{}", port.name, own.name), scale: 1.0 }
    };
    let signals: Vec<SensorSignal> = wanted.iter().enumerate().map(signal).collect();
    let found = if wanted.is_empty() { None } else { problem.observe(&signals) };
    let in_si = |((p, flows), mut values): (PortVariable, Vec<f64>)| {
        let port = &problem.circuit.ports[p];
        let unit = MeasurementUnit::parse(if flows { &port.through.unit } else { &port.potential.unit });
        let (factor, offset) = unit.map_or((1.0, 0.0), |u| (u.factor(), u.offset));
        values.iter_mut().for_each(|v| *v = *v * factor + offset);
        ((p, flows), values)
    };
    wanted.into_iter().zip(found.unwrap_or_default()).map(in_si).collect()
}

/// What a threshold at this site is compared with, sorted.
fn values(shape: &ShapeParameter, site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<Vec<f64>> {
    let mut values = match *site {
        _ if !shape.threshold && !shape.level => return None,
        AttachmentSite::Across(p, _) if shape.level => acting(&AttachmentSite::Node(p), potentials)?,
        _ => acting(site, potentials)?,
    };
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    if values.is_empty() { None } else { Some(values) }
}

/// Least and greatest size of each signal, of each input, and of each signal inside the model as the nominal one has it.
fn sizes(problem: &DiagnosisProblem<'_>) -> BTreeMap<String, (f64, f64)> {
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
    let links = problem.circuit.links.iter().map(|l| l.signal.name.clone());
    let inside: Vec<SensorSignal> = links
        .enumerate()
        .map(|(i, variable)| SensorSignal { name: format!("inside_{i}"), variable, scale: 1.0 })
        .collect();
    let known = if inside.is_empty() { None } else { problem.observe(&inside) };
    for (s, values) in inside.iter().zip(known.unwrap_or_default()) {
        sizes.insert(s.variable.clone(), range(&mut values.into_iter()));
    }
    sizes.retain(|_, (least, most)| least < most);
    sizes
}

fn size(site: &AttachmentSite, sizes: &BTreeMap<String, (f64, f64)>) -> Option<(f64, f64)> {
    match site {
        AttachmentSite::Sensor(name) | AttachmentSite::Command(name) => sizes.get(name).copied(),
        _ => None,
    }
}
