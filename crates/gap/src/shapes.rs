//! Fits the grids of nonlinear parameters to what the recordings can show.
//!
//! Times go to the sampling step, thresholds to values that occur, speeds and distances to the motion, frequencies to
//! spectral lines that the nominal model lacks. Hypotheses whose grid becomes empty are removed.
//! Enters and leaves: the problem, before the search. Called by `study`. Method: `docs/gap_method.md`, "Order of the
//! hypotheses", second paragraph.

use super::circuit::{CircuitTopology, same_kind};
use super::data::RecordingData;
use super::effects::{EffectCoefficient, ShapeParameter, ShapeRole};
use super::hypotheses::{AttachmentSite, EffectAttachment, Hypothesis, SensorSignal};
use super::lines;
use super::problem::DiagnosisProblem;
use bramah_expr::units::MeasurementUnit;
use std::collections::BTreeMap;

/// Sampling step for which the effects' own grids of times are made, s.
const STEP: f64 = 1e-3;
/// Greatest time of a shape, as part of the longest recording.
const LASTING: f64 = 1.0 / 3.0;
/// Greatest time that is added to the grid, decade by decade, as part of the longest recording.
const LOOKED_FOR: f64 = 0.1;
/// Quantiles of the values that occur at which thresholds are tried.
const QUANTILES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 0.95];
/// Part of the speeds that are kept; the greatest ones are jumps.
const USUAL: f64 = 0.995;
/// Greatest width of a corner, in parts of the greatest value at its place. What moves less would never leave the
/// corner.
const CORNER: f64 = 0.02;
/// Least and greatest distance that is tried (play, deflection before a friction breaks loose), in parts of the travel:
/// the resolution of a fine position sensor, and a play of a third of the motion.
const DISTANCES: [f64; 2] = [1e-5, 0.3];
/// Greatest travel of a shaft, rad: one that turns on and on has no longer travel.
const TURN: f64 = std::f64::consts::TAU;
/// Speeds over which a friction that falls with speed falls, in parts of the greatest speed.
const FALLS: [f64; 3] = [0.01, 0.05, 0.2];

/// Least number of periods that the recordings must cover for something periodic to be seen.
const REPEATS: f64 = 2.0;
/// Ambient pressure, Pa.
const ATMOSPHERE: f64 = 101_325.0;

/// A variable of a port: port index, and `true` for what flows through it, `false` for its potential.
type PortVariable = (usize, bool);
/// Trajectories of such variables in the nominal model over all recordings one after the other, SI.
type NominalTrajectories = BTreeMap<PortVariable, Vec<f64>>;
/// Parts of the way from the least to the greatest size of a signal at which limits are tried.
const PARTS: [f64; 4] = [0.4, 0.6, 0.8, 0.97];

/// Fits the grids of all hypotheses, and removes hypotheses that cannot be fitted to these recordings.
/// Coefficients that differ from recording to recording are multiplied, and parameters for ranges get their values.
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
    let periodic = problem.hypotheses.iter().any(|h| h.shapes.iter().any(|s| s.role == ShapeRole::SpectralLine));
    // the spectra take a run of the nominal model, so they are only computed for hypotheses that need them
    let lines = if periodic { lines::lines(problem) } else { Vec::new() };
    let mut hypotheses = std::mem::take(&mut problem.hypotheses);
    // ambient pressure and ranges are parameters of the effect instances, not shapes
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
            // the model does not state the range of a command; the recordings show it
            h.passes = Some(most);
        }
        // the kinds of shapes exclude each other; the first that fits counts
        for shape in &mut h.shapes {
            if let (true, Some(travel)) = (shape.role == ShapeRole::Order, turned(&site, &potentials, &problem.circuit))
            {
                shape.grid.retain(|n| n * travel >= REPEATS);
            } else if shape.role == ShapeRole::SpectralLine {
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
                // a grid outside of the bounds belongs to another kind of machine: a brim to levels, a relief valve to
                // high pressures
                if shape.grid.iter().any(|x| shape.min.is_some_and(|m| *x < m) || shape.max.is_some_and(|m| *x > m)) {
                    shape.grid.clear();
                }
            } else if let (true, Some((least, most))) = (shape.role == ShapeRole::Limit, size) {
                shape.grid = PARTS.iter().map(|part| least + part * (most - least)).collect();
            } else if let (true, AttachmentSite::Command(name), Some((_, most))) = (shape.relative, &site, size) {
                let declared = problem.circuit.inputs.iter().find(|i| i.name == *name).and_then(|i| i.nominal);
                shape.grid.iter_mut().for_each(|x| *x *= most / declared.unwrap_or(1.0));
            }
        }
    }
    problem.hypotheses.retain(|h| h.shapes.iter().all(|s| !s.grid.is_empty()));
}

/// Replaces coefficients that differ from recording to recording by one for each recording.
fn each_its_own(coefficients: &mut Vec<EffectCoefficient>, recordings: usize) {
    let (own, mut all): (Vec<_>, Vec<_>) = coefficients.drain(..).partition(|c| c.recording.is_some());
    let numbered = |k: usize| own.iter().map(move |c| EffectCoefficient { recording: Some(k), ..c.clone() });
    all.extend((0..recordings).flat_map(numbered));
    *coefficients = all;
}

/// Limits a corner so that most of what occurs leaves it. As a free width it may become as wide as all of what occurs.
fn corner(shape: &mut ShapeParameter, most: f64) {
    shape.grid[0] = shape.grid[0].min(CORNER * most);
    shape.occurs = Some(most);
}

/// Scales times to the sampling step and limits them by the length of the recordings. What takes longer to fade is not
/// seen to fade at all.
fn time(shape: &mut ShapeParameter, slower: f64, longest: f64) {
    let most = LASTING * longest;
    shape.grid.iter_mut().for_each(|x| *x = (*x * slower).min(most));
    // up from the largest value of the grid, a decade each
    let further = |x: &f64| Some(10.0 * x).filter(|x| *x <= LOOKED_FOR * longest);
    let last = shape.grid.last().copied();
    shape.grid.extend(std::iter::successors(last.as_ref().and_then(further), further));
    shape.grid.dedup();
    shape.max = Some(shape.max.map_or(most, |m| m.min(most)));
}

/// Adds distances in decades around the effect's own, within the limits of [`DISTANCES`].
fn distances(shape: &mut ShapeParameter, travel: f64) {
    let [least, most] = DISTANCES.map(|part| part * travel);
    let Some((low, high)) = extent(&shape.grid) else { return };
    let below = std::iter::successors(Some(0.1 * low), |x| Some(0.1 * x)).take_while(|x| *x >= least);
    let above = std::iter::successors(Some(10.0 * high), |x| Some(10.0 * x)).take_while(|x| *x <= most);
    shape.grid.extend(below.chain(above));
    shape.grid.retain(|x| *x <= travel);
    shape.grid.sort_by(f64::total_cmp);
}

/// Ports of a site at a node or between two nodes; empty for other sites.
fn ports(site: &AttachmentSite) -> Vec<usize> {
    match *site {
        AttachmentSite::Node(p) => vec![p],
        AttachmentSite::Across(a, b) => vec![a, b],
        _ => Vec::new(),
    }
}

/// Whether a shape is a speed: one over which a friction changes sign, or falls.
fn is_speed(shape: &ShapeParameter) -> bool {
    ["rad/s", "m/s"].iter().any(|u| same_kind(&shape.unit, u))
}

/// Whether a shape is a width over which something changes sign: it has a single value, in the unit of what changes it.
fn is_corner(shape: &ShapeParameter) -> bool {
    shape.grid.len() == 1 && !shape.relative && !shape.unit.is_empty()
}

/// Whether a shape is a distance of two bodies, such as a play.
fn is_distance(shape: &ShapeParameter) -> bool {
    ["rad", "m"].iter().any(|u| same_kind(&shape.unit, u))
}

/// Greatest absolute value of what a corner depends on: the potential of its site, or what flows through it.
/// `None` if the shape has another unit, or nothing moves.
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

/// Range of the potential of a site, of one side against the other if it has two; `None` if it stands still.
fn travel(site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<f64> {
    let (least, most) = extent(&acting(site, potentials)?)?;
    Some((most - least).min(TURN)).filter(|t| *t > 0.0)
}

/// Least and greatest finite value; `None` if there is none.
fn extent(values: &[f64]) -> Option<(f64, f64)> {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold(None, |known: Option<(f64, f64)>, v| Some(known.map_or((v, v), |(l, m)| (l.min(v), m.max(v)))))
}

/// Turns that a shaft makes in the nominal model; `None` for a potential that is no angle.
fn turned(site: &AttachmentSite, potentials: &NominalTrajectories, circuit: &CircuitTopology) -> Option<f64> {
    let (AttachmentSite::Node(p) | AttachmentSite::Across(p, _)) = site else { return None };
    let angle = acting(site, potentials).filter(|_| same_kind(&circuit.ports[*p].potential.unit, "rad"))?;
    let (least, most) = extent(&angle)?;
    Some((most - least) / TURN)
}

/// Greatest speed at a site, of one side against the other if it has two; `None` if it stands still.
fn fastest(site: &AttachmentSite, potentials: &NominalTrajectories, times: &[&[f64]]) -> Option<f64> {
    speeds(&acting(site, potentials)?, times).last().copied().filter(|v| *v > 0.0)
}

/// Potential of a site, of one side against the other if it has two; `None` for other sites and unknown potentials.
fn acting(site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<Vec<f64>> {
    let of = |p: usize| potentials.get(&(p, false));
    match *site {
        AttachmentSite::Node(p) => of(p).cloned(),
        AttachmentSite::Across(a, b) => Some(of(a)?.iter().zip(of(b)?).map(|(a, b)| a - b).collect()),
        _ => None,
    }
}

/// Variables of the first place of a hypothesis that its grids need.
fn compared(h: &Hypothesis) -> impl Iterator<Item = PortVariable> {
    let measured = |s: &ShapeParameter| {
        matches!(s.role, ShapeRole::Threshold | ShapeRole::Level | ShapeRole::Order)
            || is_speed(s)
            || is_corner(s)
            || is_distance(s)
    };
    let compared = h.shapes.iter().any(measured) || h.attachments.iter().any(|a| surroundings(a).is_some());
    let site = &h.attachments[0].site;
    let potentials = ports(site).into_iter().map(|p| (p, false));
    let through = if let AttachmentSite::Into(p) = site { Some((*p, true)) } else { None };
    potentials.chain(through).filter(move |_| compared)
}

/// Parameter of an effect for the ambient pressure; `None` if it has none.
fn surroundings(a: &EffectAttachment) -> Option<&String> {
    a.effect.as_ref()?.surroundings.as_ref()
}

/// Sets the ambient pressure to 0 where the model counts pressures from it.
/// That is assumed if a recording begins below half of the atmospheric pressure, which no machine at rest has.
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

/// The variable whose range an effect takes; `None` if it takes none.
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

/// Parameters that take the range of a variable, with their values.
/// Empty if the variable stands still or is unknown; `None` for effects without such parameters.
fn range(a: &EffectAttachment, potentials: &NominalTrajectories, times: &[&[f64]]) -> Option<Vec<(String, String)>> {
    let names = a.effect.as_ref()?.range.as_ref()?;
    let potential = ranged(a).and_then(|p| potentials.get(&p)).map_or(&[][..], Vec::as_slice);
    let values = if names.rate { speeds(potential, times) } else { potential.to_vec() };
    let Some((least, most)) = extent(&values) else { return Some(Vec::new()) };
    let moves = most - least > 1e-9 * most.abs().max(least.abs());
    let value = |name: &String, x: f64| (name.clone(), format!("{x:e}"));
    Some(if moves { vec![value(&names.least, least), value(&names.most, most)] } else { Vec::new() })
}

/// Absolute rates of a potential over all recordings, sorted, without the greatest ones, which are jumps.
/// `times`: times of the samples of each recording, s.
fn speeds(potential: &[f64], times: &[&[f64]]) -> Vec<f64> {
    let mut from = 0;
    let mut speeds = Vec::new();
    // no rate is taken across the end of a recording
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

/// Variables of all ports that thresholds, corners and ranges need, in the nominal model; empty if a simulation stops
/// early. The nominal model starts as it is, and all variables come from one run, in SI units.
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

/// Values with which a threshold at this site is compared, sorted; `None` for other shapes.
/// A level is compared with the first potential alone, also between two nodes.
fn values(shape: &ShapeParameter, site: &AttachmentSite, potentials: &NominalTrajectories) -> Option<Vec<f64>> {
    let mut values = match *site {
        _ if !matches!(shape.role, ShapeRole::Threshold | ShapeRole::Level) => return None,
        AttachmentSite::Across(p, _) if shape.role == ShapeRole::Level => acting(&AttachmentSite::Node(p), potentials)?,
        _ => acting(site, potentials)?,
    };
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    if values.is_empty() { None } else { Some(values) }
}

/// Least and greatest absolute value of each signal, input and signal inside the model, by name. What stands still is
/// left out.
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

/// Least and greatest absolute value of the signal of a site; `None` for other sites and signals that stand still.
fn size(site: &AttachmentSite, sizes: &BTreeMap<String, (f64, f64)>) -> Option<(f64, f64)> {
    match site {
        AttachmentSite::Sensor(name) | AttachmentSite::Command(name) => sizes.get(name).copied(),
        _ => None,
    }
}
