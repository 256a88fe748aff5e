//! Operating points: states in which all rates vanish that anything depends on.
//!
//! A prepared model ([`LinearizationSetup`]) and a state of a run enter; a [`SteadyState`] leaves, or a model state at
//! rest ([`rest`]). The commands `bramah steady`, `linearize --steady` and `partition` call it.
//!
//! The search is pseudo-transient continuation: implicit Euler steps that grow as the rates fall, and so approach
//! Newton's method. Source: C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508. States that nothing depends
//! on, such as the angle of a turning shaft, need not rest.

use super::linear::LinearizationSetup;
use super::local::{LocalError, LocalEvaluator};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_expr::units::MeasurementUnit;
use bramah_model::structure::StateChoice;
use bramah_results::{Trajectory, number};
use bramah_solve::{Control, Settings, State, signals, simulate};
use bramah_syntax::diag::{Code, Diagnostic};
use nalgebra::{DMatrix, DVector};
use std::sync::atomic::AtomicBool;

/// An operating point.
#[derive(Clone, Debug)]
pub struct SteadyState {
    /// Values of the states, in the order of the plan. Idle states keep the values from which the search started.
    pub x: Vec<f64>,
    /// The largest remaining rate, over the nominal value of its state, in 1/s.
    pub rest: f64,
    /// States that may move on because nothing else depends on them, such as the angle of a turning shaft. Of angles
    /// that are joined by springs one stands for all.
    pub idle: Vec<usize>,
    /// Steps of the search.
    pub steps: usize,
}

/// Why no operating point was found.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SteadyStateError {
    /// The equations have no solution at a point of the search.
    #[error("{0}")]
    Local(#[from] LocalError),
    /// The search ended before all rates vanished.
    #[error("the search did not come to rest")]
    Restless {
        /// Index of the state with the largest remaining rate.
        state: usize,
        /// That rate over the nominal value of the state, in 1/s.
        rate: f64,
    },
}

impl SteadyStateError {
    /// The diagnostic for a user, with the name of the state.
    pub fn said(&self, chosen: &LinearizationSetup) -> Diagnostic {
        let d = Diagnostic::new(Code::InitialFailed, format!("no steady state was found: {self}"));
        match self {
            SteadyStateError::Restless { state, rate } => {
                let v = chosen.plan.state_variables().nth(*state);
                let name = v.map_or_else(String::new, |v| chosen.plan.system.dae.variables[v.index()].name.clone());
                let rate = number::rounded(*rate, 3);
                d.note(format!("`{name}` still moves by {rate} of its usual size a second")).help(
                    "give start values nearer to it, or look at a run: it may oscillate, or rest on a command in time",
                )
            }
            SteadyStateError::Local(_) => d.help("give start values nearer to it"),
        }
    }
}

/// A rate below this, over the nominal value of its state, counts as zero; in 1/s.
const REST: f64 = 1e-9;
/// Largest number of steps.
const STEPS: usize = 400;

/// Shares of the experiment's length after which a failed search starts again.
const LATER: [f64; 3] = [0.01, 0.1, 1.0];

/// An operating point as a state of the model.
///
/// When the search from `state` fails, as between valves that open and close on the way, the model runs for 1, 10 and
/// 100 % of the experiment's length, and the search starts again from there.
///
/// # Errors
/// [`SteadyStateError`] of the first search.
pub fn rest(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    state: &State,
    interrupt: &AtomicBool,
) -> Result<State, SteadyStateError> {
    let from = |at: &State| steady(chosen, at).map(|(found, _)| put(chosen, &found.x, at.clone()));
    // Without a solution of the equations a run would not help either.
    let why = match from(state) {
        Err(why @ SteadyStateError::Restless { .. }) => why,
        other => return other,
    };
    let experiment = Settings::from_experiment(&model.dae.experiment);
    let mut at = state.clone();
    for part in LATER {
        let length = part * (experiment.stop_time - experiment.start_time);
        let Ok((_, after)) = run_from(model, chosen, &at, length, &[], interrupt) else { break };
        // The time stays that of the operating point, and with it what the sources command.
        at = State { time: state.time, ..after };
        if let Ok(found) = from(&at) {
            return Ok(found);
        }
    }
    Err(why)
}

/// A state of the model with its states set to `x`.
fn put(chosen: &LinearizationSetup, x: &[f64], mut state: State) -> State {
    for (v, &x) in chosen.plan.state_variables().zip(x) {
        state.values[v.index()] = x;
    }
    state
}

/// Runs the model from a state for `length` seconds, with the values of the raised parameters in that state.
///
/// Returns two rows, start and end, and the state at the end.
///
/// # Errors
/// The diagnostics of a run that did not reach its end.
pub fn run_from(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    state: &State,
    length: f64,
    wanted: &[VarId],
    interrupt: &AtomicBool,
) -> Result<(Trajectory, State), Vec<Diagnostic>> {
    let settings = Settings {
        start_time: state.time,
        stop_time: state.time + length,
        interval: length,
        tolerance: 1e-8,
        parameters: chosen.raised().map(|v| (v, state.values[v.index()])).collect(),
        wanted: wanted.to_vec(),
        event_rows: false,
        ..Settings::from_experiment(&model.dae.experiment)
    };
    let mut rows = Trajectory::new(signals(&model.dae, wanted));
    let mut reselect = |choice: &StateChoice| model.with_states(choice);
    let mut control = Control { interrupt: Some(interrupt), reselect: Some(&mut reselect), ..Control::default() };
    let run = simulate(&model.system, &settings, &[], Some(state), &mut rows, &mut control);
    if run.end.is_success() { Ok((rows, run.state)) } else { Err(run.diagnostics) }
}

/// Finds an operating point from a state of the model, with its inputs and parameters.
///
/// # Errors
/// [`SteadyStateError`].
pub fn steady(chosen: &LinearizationSetup, from: &State) -> Result<(SteadyState, LocalEvaluator), SteadyStateError> {
    let (theta, u) = chosen.given(from);
    let mut local = chosen.at(from)?;
    let x = local.state();
    let found = search(&mut local, (from.time, &theta, &u), &x, &[]).or_else(|why| {
        // Angles of shafts joined by springs may move on together. A search that allows this holds fewer states fixed
        // and may find another operating point, so it runs only when the first one has failed.
        let places = places(chosen);
        if places.is_empty() || !matches!(why, SteadyStateError::Restless { .. }) {
            return Err(why);
        }
        search(&mut local, (from.time, &theta, &u), &x, &places).map_err(|_| why)
    })?;
    Ok((found, local))
}

/// Indices of the states that are angles or positions, recognised by their units.
fn places(chosen: &LinearizationSetup) -> Vec<usize> {
    let variables = &chosen.plan.system.dae.variables;
    let is_place = |unit: &str| ["rad", "m"].iter().any(|place| same_kind(unit, place));
    let units = chosen.plan.state_variables().map(|v| variables[v.index()].unit.as_deref().unwrap_or(""));
    units.enumerate().filter(|(_, unit)| is_place(unit)).map(|(k, _)| k).collect()
}

/// Whether two units convert into each other. An angle is no plain number here.
fn same_kind(a: &str, b: &str) -> bool {
    matches!((MeasurementUnit::parse(a), MeasurementUnit::parse(b)), (Ok(a), Ok(b)) if (a.dimension, a.angle) == (b.dimension, b.angle))
}

/// Finds an operating point of `local` from `x`, at a time with parameters `theta` and inputs `u`.
///
/// # Errors
/// [`SteadyStateError`].
pub fn settle(
    local: &mut LocalEvaluator,
    time: f64,
    x: Vec<f64>,
    theta: &[f64],
    u: &[f64],
) -> Result<SteadyState, SteadyStateError> {
    search(local, (time, theta, u), &x, &[])
}

/// An operating point from which others can be reached.
#[derive(Clone, Debug)]
pub struct OperatingPoint {
    /// Its states, in the order of the plan.
    pub x: Vec<f64>,
    /// A state of the model that holds its time, parameters and inputs.
    pub given: State,
}

/// How often a change that is too large is halved: down to a thirty-second of it.
const HALVINGS: u32 = 5;

/// Finds the operating point with other values of parameters and inputs, directly or over points between.
///
/// The outputs of `local` are then those of the new point.
///
/// # Errors
/// The [`SteadyStateError`] of the direct attempt.
pub fn reach(
    chosen: &LinearizationSetup,
    local: &mut LocalEvaluator,
    from: &OperatingPoint,
    target: &[(VarId, f64)],
) -> Result<OperatingPoint, SteadyStateError> {
    go(chosen, local, from, target, HALVINGS)
}

/// The recursion of [`reach`], with the number of halvings left.
fn go(
    chosen: &LinearizationSetup,
    local: &mut LocalEvaluator,
    from: &OperatingPoint,
    target: &[(VarId, f64)],
    halvings: u32,
) -> Result<OperatingPoint, SteadyStateError> {
    let mut given = from.given.clone();
    target.iter().for_each(|&(v, value)| given.values[v.index()] = value);
    let (theta, u) = chosen.given(&given);
    let why = match settle(local, given.time, from.x.clone(), &theta, &u) {
        Ok(found) => return Ok(OperatingPoint { x: found.x, given }),
        Err(why) if halvings > 0 => why,
        Err(why) => return Err(why),
    };
    let middle = |&(v, value): &(VarId, f64)| (v, 0.5 * (from.given.values[v.index()] + value));
    let middle: Vec<(VarId, f64)> = target.iter().map(middle).collect();
    // The first half may be halved again; then the second half starts from its end.
    let half = go(chosen, local, from, &middle, halvings - 1).map_err(|_| why)?;
    go(chosen, local, &half, target, halvings - 1)
}

/// The search itself. States among `places` may move on together where nothing depends on this motion.
fn search(
    local: &mut LocalEvaluator,
    (time, theta, u): (f64, &[f64], &[f64]),
    x: &[f64],
    places: &[usize],
) -> Result<SteadyState, SteadyStateError> {
    let nominals = local.nominals();
    let mut x = x.to_vec();
    let n = x.len();
    local.linearize(time, &x, theta, u)?;
    let mut at = ScaledLinearization::new(local, &nominals, places);
    let mut size = at.norm();
    // A short first step follows the transient; it grows at once where the rates fall.
    let mut step = 1e-3;
    for count in 0..STEPS {
        if size <= REST {
            return Ok(SteadyState { x, rest: size, idle: at.idle, steps: count });
        }
        let next = at.euler(&x, &nominals, step);
        let found = next.filter(|x| x.iter().all(|v| v.is_finite())).filter(|next| {
            // A step over several nominal values leaves the range in which the Jacobian says anything. Very short steps
            // are taken anyway, so that the search does not stall.
            let far = (0..n).any(|i| (next[i] - x[i]).abs() > 3.0 * nominals[i].max(x[i].abs()));
            !far || step < 1e-9
        });
        let taken = found.filter(|next| local.linearize(time, next, theta, u).is_ok());
        let Some(next) = taken else {
            step *= 0.2;
            local.linearize(time, &x, theta, u)?;
            // The rejected point is undone, and the shorter step uses the Jacobian at the last accepted one.
            continue;
        };
        at = ScaledLinearization::new(local, &nominals, places);
        let now = at.norm();
        // Switched evolution relaxation: the step grows as the rates fall. They may rise on the way, as in a run.
        step = (step * (size / now.max(1e-30)).clamp(0.2, 5.0) * 1.5).clamp(1e-12, 1e15);
        (x, size) = (next, now);
    }
    let rates = (0..n).filter(|i| !at.idle.contains(i)).map(|i| (i, at.rates[i].abs()));
    let (state, rate) = rates.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
    Err(SteadyStateError::Restless { state, rate })
}

/// Rates and Jacobian in units of the states' nominal values.
struct ScaledLinearization {
    /// d x'/d x, n by n.
    a: DMatrix<f64>,
    /// The rates, in 1/s.
    rates: Vec<f64>,
    /// States that are left out of the search.
    idle: Vec<usize>,
}

impl ScaledLinearization {
    /// Scales the linearisation of `local` and finds its idle states.
    fn new(local: &LocalEvaluator, nominals: &[f64], places: &[usize]) -> Self {
        let n = nominals.len();
        let a = DMatrix::from_fn(n, n, |i, j| local.linear.a[(i, j)] * nominals[j] / nominals[i]);
        let rates = local.rates.iter().zip(nominals).map(|(r, n)| r / n).collect();
        let mut scaled = ScaledLinearization { idle: idle(&a), a, rates };
        let joined: Vec<usize> = places.iter().copied().filter(|p| !scaled.idle.contains(p)).collect();
        for (leader, others) in together(&scaled.a, &joined) {
            // The others are counted relative to the leader; on the leader itself nothing depends any more.
            for (other, ratio) in others {
                scaled.rates[other] -= ratio * scaled.rates[leader];
                let row = scaled.a.row(other) - scaled.a.row(leader) * ratio;
                scaled.a.set_row(other, &row);
            }
            scaled.a.column_mut(leader).fill(0.0);
            scaled.idle.push(leader);
        }
        scaled
    }

    /// The largest rate of a state that is not idle, in 1/s.
    fn norm(&self) -> f64 {
        let rates = self.rates.iter().enumerate().filter(|(i, _)| !self.idle.contains(i));
        rates.map(|(_, r)| r.abs()).fold(0.0, f64::max)
    }

    /// The states after one implicit Euler step of `step` seconds. Idle states keep their values. `None` where the
    /// matrix is singular.
    fn euler(&self, x: &[f64], nominals: &[f64], step: f64) -> Option<Vec<f64>> {
        let n = x.len();
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            let moves = !self.idle.contains(&i) && !self.idle.contains(&j);
            let own = f64::from(u8::from(i == j));
            if moves { own / step - self.a[(i, j)] } else { own }
        });
        let rates = DVector::from_fn(n, |i, _| if self.idle.contains(&i) { 0.0 } else { self.rates[i] });
        let change = matrix.lu().solve(&rates)?;
        Some((0..n).map(|i| x[i] + change[i] * nominals[i]).collect())
    }
}

/// Terms cancel when their sum is below this share of them.
const CANCEL: f64 = 1e-9;

/// Groups among `states` that can move on together without an effect on any rate.
///
/// Such are the angles of shafts that are joined by springs and gears: a vector in the null space of their columns of
/// `a`. Each group has one leader, and the others with their rates relative to the leader's.
fn together(a: &DMatrix<f64>, states: &[usize]) -> Vec<(usize, Vec<(usize, f64)>)> {
    // Rows are scaled, so that one tolerance fits all of them.
    let mut m = a.select_columns(states);
    for mut row in m.row_iter_mut() {
        let most = row.amax();
        if most > 0.0 {
            row /= most;
        }
    }
    let whole = m.clone();
    // Gauss-Jordan elimination, so that independent groups stay apart.
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    let mut leaders = Vec::new();
    for column in 0..states.len() {
        let free = (0..m.nrows()).filter(|r| pivots.iter().all(|p| p.0 != *r));
        let Some(row) = free.max_by(|x, y| m[(*x, column)].abs().total_cmp(&m[(*y, column)].abs())) else { break };
        if m[(row, column)].abs() <= CANCEL {
            // A column without a pivot depends on the columns before it: it spans one vector of the null space.
            leaders.push(column);
            continue;
        }
        let pivot = m.row(row) / m[(row, column)];
        for other in (0..m.nrows()).filter(|r| *r != row) {
            let rest = m.row(other) - &pivot * m[(other, column)];
            m.set_row(other, &rest);
        }
        m.set_row(row, &pivot);
        pivots.push((row, column));
    }
    let group = |&leader: &usize| {
        let others = pivots.iter().map(|&(row, column)| (column, -m[(row, leader)]));
        let others: Vec<(usize, f64)> = others.filter(|o| o.1.abs() > CANCEL).collect();
        // The original rows confirm what elimination with its rounding found.
        let cancels = whole.row_iter().all(|row| {
            let terms = || others.iter().map(|&(c, ratio)| row[c] * ratio).chain([row[leader]]);
            terms().sum::<f64>().abs() <= CANCEL * terms().map(f64::abs).sum::<f64>()
        });
        cancels.then(|| (states[leader], others.iter().map(|&(c, ratio)| (states[c], ratio)).collect()))
    };
    leaders.iter().filter_map(group).collect()
}

/// The states that move on where all motion is at constant rates; empty at rest.
///
/// `None` where the motion changes a rate, which is no steady state.
pub fn moving(a: &DMatrix<f64>, rates: &[f64], nominals: &[f64]) -> Option<Vec<usize>> {
    let moving: Vec<usize> = (0..rates.len()).filter(|&k| rates[k].abs() > MOVES * nominals[k]).collect();
    // x'' = A x' must vanish in every row.
    let constant = a.row_iter().all(|row| {
        let terms = || moving.iter().map(|&k| row[k] * rates[k]);
        terms().sum::<f64>().abs() <= MOVES * terms().map(f64::abs).sum::<f64>()
    });
    constant.then_some(moving)
}

/// A rate above this, over the nominal value of its state, counts as motion; in 1/s.
const MOVES: f64 = 1e-4;

/// States on which no rate depends, or only rates of other such states.
pub fn idle(a: &DMatrix<f64>) -> Vec<usize> {
    let n = a.nrows();
    let mut idle: Vec<usize> = Vec::new();
    loop {
        let more = (0..n).find(|j| !idle.contains(j) && (0..n).all(|i| idle.contains(&i) || a[(i, *j)] == 0.0));
        match more {
            Some(j) => idle.push(j),
            None => return idle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::InputOutputSelection;
    use bramah_circuit::Simulation;
    use bramah_model::compile::Request;
    use bramah_syntax::world::MemoryWorld;

    fn found(text: &str) -> Result<(SteadyState, Vec<String>), SteadyStateError> {
        let world = MemoryWorld::single("m.mo", text);
        let request = Request { source: "m.mo".into(), ..Request::default() };
        let mut simulation = Simulation::compile(&world, &request).expect("sound");
        let state = simulation.stop_time(1e-9).run().expect("starts").state;
        let chosen =
            LinearizationSetup::new(&simulation.model().flat, &InputOutputSelection::default(), &[]).expect("fits");
        let names = chosen.plan.state_variables().map(|v| chosen.plan.system.dae.variables[v.index()].name.clone());
        let names = names.collect();
        steady(&chosen, &state).map(|(s, _)| (s, names))
    }

    #[test]
    fn a_stiff_circuit_comes_to_rest_and_a_shaft_may_turn() {
        let text = "model M
            Real p(start = 1e5, nominal = 1e6, fixed = true), w(start = 0, nominal = 100, fixed = true);
            Real phi(start = 0, fixed = true);
          equation
            der(p) = 1e12*(1e-5*w - 1e-9*sqrt(noEvent(max(p, 1)))); 0.01*der(w) = 20 - 1e-5*p - 0.01*w; der(phi) = w;
          end M;";
        let (steady, names) = found(text).expect("has one");
        let value = |n: &str| steady.x[names.iter().position(|m| m == n).expect("a state")];
        assert_eq!(steady.idle.len(), 1);
        assert!(value("phi").abs() < 1e-9);
        let (p, w) = (value("p"), value("w"));
        assert!((1e-5 * w - 1e-9 * p.sqrt()).abs() < 1e-11 && (20.0 - 1e-5 * p - 0.01 * w).abs() < 1e-6, "{p} {w}");
    }

    /// Two shafts with a spring and a gear between them turn on together, each at its own rate.
    #[test]
    fn shafts_joined_by_a_spring_turn_together() {
        let text = "model M
            Real a(start = 0, fixed = true, unit = \"rad\"), b(start = 0.2, fixed = true, unit = \"rad\");
            Real w(start = 0, fixed = true), v(start = 0, fixed = true);
          equation
            der(a) = w; der(b) = v;
            0.1*der(w) = 10 - 0.5*w - 1000*(a - 3*b) - 2*(w - 3*v); 0.3*der(v) = 3*(1000*(a - 3*b) + 2*(w - 3*v)) - 0.5*v;
          end M;";
        let (steady, names) = found(text).expect("turns");
        let value = |n: &str| steady.x[names.iter().position(|m| m == n).expect("a state")];
        // 10 = 0.5 w + torque, 3 torque = 0.5 v, w = 3 v
        let v = 10.0 / (0.5 * 3.0 + 0.5 / 3.0);
        assert!((value("v") - v).abs() < 1e-6 && (value("w") - 3.0 * v).abs() < 1e-6, "{steady:?}");
        assert!((1000.0 * (value("a") - 3.0 * value("b")) - 0.5 * v / 3.0).abs() < 1e-6, "{steady:?}");
        assert_eq!(steady.idle.len(), 1);
        // pressures that rise together are no motion
        let oil = text.replace("\"rad\"", "\"Pa\"");
        assert!(matches!(found(&oil), Err(SteadyStateError::Restless { .. })));
    }

    /// Constant rates on which nothing depends are motion; a rate that grows with it, or lets others follow, is not.
    #[test]
    fn what_moves_on_and_what_is_not_at_rest() {
        let turning = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -5.0]);
        assert_eq!(moving(&turning, &[20.0, 1e-9], &[1.0, 1.0]), Some(vec![0]));
        assert_eq!(moving(&turning, &[20.0, 3.0], &[1.0, 1.0]), None);
        assert_eq!(moving(&turning, &[0.0, 0.0], &[1.0, 1.0]), Some(vec![]));
        let sprung = DMatrix::from_row_slice(2, 2, &[7.0, -14.0, -3.0, 6.0]);
        assert_eq!(moving(&sprung, &[20.0, 10.0], &[1.0, 1.0]), Some(vec![0, 1]));
        assert_eq!(moving(&sprung, &[20.0, 9.0], &[1.0, 1.0]), None);
    }

    #[test]
    fn a_model_that_never_rests_says_which_state_moves() {
        let text = "model M Real x(start = 0, fixed = true), y; equation der(x) = 1 + 0.5*sin(x); y = x; end M;";
        assert!(matches!(found(text), Err(SteadyStateError::Restless { state: 0, .. })));
    }
}
