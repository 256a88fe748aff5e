//! Steady states: where all rates vanish that anything depends on.
//!
//! Pseudo-transient continuation: implicit Euler steps that grow as the rates fall, and so become Newton's method.
//! Source: C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508.

use super::linear::Chosen;
use super::local::{Local, LocalError};
use crate::solve::State;
use nalgebra::{DMatrix, DVector};

/// A steady state.
#[derive(Clone, Debug)]
pub struct Steady {
    /// Values of the states, in the order of the plan; those that nothing depends on are where they were.
    pub x: Vec<f64>,
    /// The largest rate left, over the state's usual size, in 1/s.
    pub rest: f64,
    /// States that move on without effect on others, such as the angle of a shaft that turns.
    pub idle: Vec<usize>,
    /// Steps taken.
    pub steps: usize,
}

/// Why there is none.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Unsteady {
    /// The equations have no solution where the search led.
    #[error("{0}")]
    Local(#[from] LocalError),
    /// The search did not come to rest; the state whose rate stays largest and that rate over its usual size.
    #[error("the search did not come to rest")]
    Restless {
        /// Index of the state.
        state: usize,
        /// Rate over usual size, in 1/s.
        rate: f64,
    },
}

/// Rates below this part of a state's usual size and second count as zero.
const REST: f64 = 1e-9;
/// Most steps.
const STEPS: usize = 400;

/// The steady state reached from a state of the model, with its inputs and parameters.
///
/// # Errors
/// [`Unsteady`].
pub fn steady(chosen: &Chosen, from: &State) -> Result<(Steady, Local), Unsteady> {
    let (theta, u) = chosen.given(from);
    let mut local = chosen.at(from)?;
    let x = local.state();
    let found = settle(&mut local, from.time, x, &theta, &u)?;
    Ok((found, local))
}

/// The steady state of `local` reached from `x`.
///
/// # Errors
/// [`Unsteady`].
pub fn settle(local: &mut Local, time: f64, x: Vec<f64>, theta: &[f64], u: &[f64]) -> Result<Steady, Unsteady> {
    let nominals = local.nominals();
    let mut x = x;
    let n = x.len();
    local.linearize(time, &x, theta, u)?;
    let mut size = norm(local, &nominals, &idle(&local.linear.a));
    let mut step = 1e-3;
    for count in 0..STEPS {
        let unmoved = idle(&local.linear.a);
        if size <= REST {
            return Ok(Steady { x, rest: size, idle: unmoved, steps: count });
        }
        let next = euler(local, &x, &nominals, &unmoved, step);
        let found = next.filter(|x| x.iter().all(|v| v.is_finite())).filter(|next| {
            // a step over several times the usual sizes leads nowhere known
            let far = (0..n).any(|i| (next[i] - x[i]).abs() > 3.0 * nominals[i].max(x[i].abs()));
            !far || step < 1e-9
        });
        let taken = found.filter(|next| local.linearize(time, next, theta, u).is_ok());
        let Some(next) = taken else {
            step *= 0.2;
            local.linearize(time, &x, theta, u)?;
            continue;
        };
        let now = norm(local, &nominals, &idle(&local.linear.a));
        // rates may rise on the way, as they do in a run
        step = (step * (size / now.max(1e-30)).clamp(0.2, 5.0) * 1.5).clamp(1e-12, 1e15);
        (x, size) = (next, now);
    }
    let unmoved = idle(&local.linear.a);
    let rates = (0..n).filter(|i| !unmoved.contains(i)).map(|i| (i, (local.rates[i] / nominals[i]).abs()));
    let (state, rate) = rates.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
    Err(Unsteady::Restless { state, rate })
}

/// The largest rate over the usual size of its state.
fn norm(local: &Local, nominals: &[f64], idle: &[usize]) -> f64 {
    let rates = local.rates.iter().zip(nominals).enumerate().filter(|(i, _)| !idle.contains(i));
    rates.map(|(_, (r, n))| (r / n).abs()).fold(0.0, f64::max)
}

/// One implicit Euler step in units of the usual sizes; idle states stay.
fn euler(local: &Local, x: &[f64], nominals: &[f64], idle: &[usize], step: f64) -> Option<Vec<f64>> {
    let n = x.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| {
        let moves = !idle.contains(&i) && !idle.contains(&j);
        let own = f64::from(u8::from(i == j));
        if moves { own / step - local.linear.a[(i, j)] * nominals[j] / nominals[i] } else { own }
    });
    let rates = DVector::from_fn(n, |i, _| if idle.contains(&i) { 0.0 } else { local.rates[i] / nominals[i] });
    let change = matrix.lu().solve(&rates)?;
    Some((0..n).map(|i| x[i] + change[i] * nominals[i]).collect())
}

/// States that no rate depends on, but those of other such states.
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
    use crate::analysis::linear::Choice;
    use crate::circuit::Simulation;
    use crate::compile::Request;
    use crate::world::MemoryWorld;

    fn found(text: &str) -> Result<(Steady, Vec<String>), Unsteady> {
        let world = MemoryWorld::single("m.mo", text);
        let request = Request { source: "m.mo".into(), ..Request::default() };
        let mut simulation = Simulation::compile(&world, &request).expect("sound");
        let state = simulation.stop_time(1e-9).run().expect("starts").state;
        let chosen = Chosen::new(&simulation.model().flat, &Choice::default(), &[]).expect("fits");
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

    #[test]
    fn a_model_that_never_rests_says_which_state_moves() {
        let text = "model M Real x(start = 0, fixed = true), y; equation der(x) = 1 + 0.5*sin(x); y = x; end M;";
        assert!(matches!(found(text), Err(Unsteady::Restless { state: 0, .. })));
    }
}
