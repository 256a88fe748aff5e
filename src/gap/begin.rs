//! Where a recording begins: the state that its first samples lead to. The model's own start may be far from it, and what
//! is linearised there (a limiter at its end, a spring wound up) may make the filter sure of a state that is none. So the
//! first samples are gone through again from where they lead (Gauss-Newton on the state before the first sample).

use super::data::Recording;
use super::filter::{self, Filter, Setting};
use nalgebra::{DMatrix, DVector};

/// Times at most that the first samples are gone through.
const ROUNDS: usize = 4;
/// A change of the state that is none, in its sizes.
const SMALL: f64 = 1e-3;
/// Log likelihood that another start must gain, nats.
const BETTER: f64 = 0.1;

/// The start of a recording from `start`, which is left where nothing better is found.
pub(super) fn state(
    setting: &Setting,
    recording: &Recording,
    start: &[f64],
    hidden: &[usize],
    reads: &DMatrix<bool>,
) -> Vec<f64> {
    let setting = &Setting { common: start.len(), ..setting.alone() };
    let (mut best, mut likelihood) = (start.to_vec(), f64::NEG_INFINITY);
    let mut tried = best.clone();
    for _ in 0..ROUNDS {
        let Some(found) = gone_through(setting, recording, &tried, hidden, reads) else { break };
        if found.likelihood < likelihood + BETTER {
            break;
        }
        (best, likelihood) = (tried.clone(), found.likelihood);
        if found.change.amax() < SMALL {
            break;
        }
        let moved = found.change.iter().zip(&found.states).map(|(change, &x)| (x, change * setting.sizes[x]));
        moved.for_each(|(x, dx)| tried[x] += dx);
    }
    best
}

struct Beginning {
    likelihood: f64,
    /// States that are filtered, and by how many sizes each should have begun elsewhere.
    states: Vec<usize>,
    change: DVector<f64>,
}

/// Runs the filter over the samples that only estimate the state.
fn gone_through(
    setting: &Setting,
    recording: &Recording,
    start: &[f64],
    hidden: &[usize],
    reads: &DMatrix<bool>,
) -> Option<Beginning> {
    let samples = recording.settled();
    let (local, theta) = filter::at_first(setting, recording, Some(start)).ok()?;
    let mut filter = Filter::new(setting, local, theta, start.to_vec(), recording, hidden, reads);
    let prior = filter.follow_start();
    for k in 0..samples {
        filter.sample(k, samples).ok()?;
    }
    let states = filter.states().to_vec();
    let pass = filter.finish();
    let n = states.len();
    let mut information = pass.gram.view((0, 0), (n, n)).into_owned();
    (0..n).for_each(|i| information[(i, i)] += 1.0 / prior[i]);
    let change = information.cholesky()?.solve(&pass.gram.view((0, n), (n, 1)).column(0).into_owned());
    let finite = pass.likelihood.is_finite() && change.iter().all(|v| v.is_finite());
    finite.then_some(Beginning { likelihood: pass.likelihood, states, change })
}
