//! States that nothing measured depends on (those of effects at their off value): carried along beside the filter,
//! without covariance.

use super::data::Recording;
use super::step::Exponential;
use crate::analysis::local::Local;
use nalgebra::{DMatrix, DVector};

/// States that nothing measured depends on, in groups that depend on each other.
pub(super) struct Passive {
    groups: Vec<Group>,
}

struct Group {
    states: Vec<usize>,
    exponential: Exponential,
}

impl Passive {
    pub(super) fn new(local: &Local, states: &[usize], reads: &DMatrix<bool>) -> Self {
        let mut groups: Vec<Vec<usize>> = states.iter().map(|&i| vec![i]).collect();
        let numeric = states.iter().flat_map(|&i| states.iter().map(move |&j| (i, j))).filter(|&at| reads[at]);
        for (i, j) in local.plan().couplings().chain(numeric) {
            let place = |state: usize| groups.iter().position(|g| g.contains(&state));
            if let (Some(one), Some(other)) = (place(i), place(j))
                && one != other
            {
                let moved = groups.remove(one.max(other));
                groups[one.min(other)].extend(moved);
            }
        }
        let group = |states: Vec<usize>| {
            let n = states.len();
            Group { states, exponential: Exponential::new(n, 0) }
        };
        Passive { groups: groups.into_iter().map(group).collect() }
    }

    /// x next = x + integral (x' + A from the active states' half step).
    pub(super) fn step(&mut self, local: &Local, active: &[usize], moved: &[f64], x: &mut [f64], h: f64) {
        for group in &mut self.groups {
            group.step(local, active, moved, x, h);
        }
    }
}

impl Group {
    fn step(&mut self, local: &Local, active: &[usize], moved: &[f64], x: &mut [f64], h: f64) {
        let (n, full) = (self.states.len(), &local.linear.a);
        let fresh = DMatrix::from_fn(n, n, |i, j| full[(self.states[i], self.states[j])]);
        self.exponential.compute(&fresh, h, None);
        let rate = DVector::from_fn(n, |i, _| {
            let row = self.states[i];
            let along: f64 = active.iter().zip(moved).map(|(&j, dx)| full[(row, j)] * dx).sum();
            local.rates[row] + 0.5 * along
        });
        let change = &self.exponential.integral * rate;
        self.states.iter().zip(change.iter()).for_each(|(&i, dx)| x[i] += dx);
    }
}

/// Points at which dependences are looked for: at a single one a limiter may hide them.
const POINTS: usize = 12;

/// States from which no path of dependence leads to an output, and all dependences of rates on states.
pub(super) fn passive_states(
    local: &mut Local,
    recording: &Recording,
    theta: &[f64],
    start: &[f64],
    sizes: &[f64],
) -> (Vec<usize>, DMatrix<bool>) {
    let n = start.len();
    let mut reads = DMatrix::from_element(n, n, false);
    let mut seen = vec![false; n];
    let mut u = vec![0.0; recording.inputs.len()];
    for point in 0..POINTS {
        let k = point * (recording.len() - 1) / POINTS;
        recording.input(k, &mut u);
        // about the start, each state another way
        let side = |i: usize| [0.0, 0.1, -0.07, 0.3][(point + point / 4 * i) % 4];
        let x: Vec<f64> = (0..n).map(|i| start[i] + side(i) * sizes[i]).collect();
        if local.linearize(recording.times[k], &x, theta, &u).is_err() {
            continue;
        }
        let (a, c) = (&local.linear.a, &local.linear.c);
        reads.zip_apply(a, |r, a| *r |= a != 0.0);
        seen.iter_mut().enumerate().for_each(|(j, s)| *s |= c.column(j).iter().any(|v| *v != 0.0));
    }
    loop {
        let more: Vec<usize> = (0..n).filter(|&j| !seen[j] && (0..n).any(|i| seen[i] && reads[(i, j)])).collect();
        if more.is_empty() {
            break;
        }
        more.into_iter().for_each(|j| seen[j] = true);
    }
    ((0..n).filter(|&j| !seen[j]).collect(), reads)
}
