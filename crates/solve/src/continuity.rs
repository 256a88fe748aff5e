//! Variables that the equations differentiate but that are no states must not jump at events: their derivative between
//! events says nothing of a jump, so that the impulse it takes (a force on a mass, a flow into a volume, a voltage at an
//! inductor) would be missing in all balances.

use super::newton::VariableScales;
use crate::lower::ExecutableSystem;
use bramah_expr::VarId;

/// A jump counts from this many tolerances on: what the corrector leaves in algebraic unknowns is below.
const JUMP: f64 = 100.0;

/// A variable that has jumped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableJump {
    /// The variable.
    pub variable: VarId,
    /// Its value before the event.
    pub before: f64,
    /// And behind it.
    pub after: f64,
}

/// The watch over one run.
#[derive(Debug)]
pub struct ContinuityMonitor {
    /// Variable, slot and size of a jump that counts beside the part of the value.
    watched: Vec<(VarId, usize, f64)>,
    relative: f64,
    before: Vec<f64>,
}

impl ContinuityMonitor {
    /// For the variables of a system.
    pub fn new(system: &ExecutableSystem, scales: &VariableScales, tolerance: f64) -> Self {
        let relative = JUMP * tolerance;
        let watched: Vec<_> = system
            .dae
            .differentiated
            .iter()
            .map(|&v| (v, system.layout.var(v), relative * scales.nominal[v.index()]))
            .collect();
        ContinuityMonitor { before: vec![0.0; watched.len()], watched, relative }
    }

    /// Remembers the values just before an event.
    pub fn remember(&mut self, values: &[f64]) {
        for (before, &(_, slot, _)) in self.before.iter_mut().zip(&self.watched) {
            *before = values[slot];
        }
    }

    /// The largest jump since then, in tolerances.
    pub fn jump(&self, values: &[f64]) -> Option<VariableJump> {
        let jumps = self.watched.iter().zip(&self.before).filter_map(|(&(variable, slot, absolute), &before)| {
            let after = values[slot];
            let size = (after - before).abs() / (absolute + self.relative * before.abs().max(after.abs()));
            (size > 1.0).then_some((size, VariableJump { variable, before, after }))
        });
        jumps.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, jump)| jump)
    }
}
