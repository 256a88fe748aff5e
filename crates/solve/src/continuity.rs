//! Check that differentiated variables do not jump at events (E509).
//!
//! Index reduction differentiates some equations. Variables that are differentiated there but are no states must stay
//! continuous: their derivative between events contains nothing of a jump. The impulse that a jump takes (a force on a
//! mass, a flow into a volume, a voltage at an inductor) would be missing in all balances.

use super::newton::VariableScales;
use crate::lower::ExecutableSystem;
use bramah_expr::VarId;

/// A change counts as a jump from this many tolerances on. Corrector errors of algebraic unknowns are smaller.
const JUMP: f64 = 100.0;

/// A variable that has jumped at an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableJump {
    /// The variable.
    pub variable: VarId,
    /// Its value before the event.
    pub before: f64,
    /// Its value after the event.
    pub after: f64,
}

/// The variables to be checked, with their values before the present event.
#[derive(Debug)]
pub struct ContinuityMonitor {
    /// Variable, slot, and the absolute part of the change that counts as a jump.
    watched: Vec<(VarId, usize, f64)>,
    /// The part of the value that counts as a jump in addition.
    relative: f64,
    /// Values before the event, in the order of `watched`.
    before: Vec<f64>,
}

impl ContinuityMonitor {
    /// Watches the differentiated variables of a system.
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

    /// Stores the values just before an event.
    pub fn remember(&mut self, values: &[f64]) {
        for (before, &(_, slot, _)) in self.before.iter_mut().zip(&self.watched) {
            *before = values[slot];
        }
    }

    /// The largest jump since then in tolerances; `None` when nothing has jumped.
    pub fn jump(&self, values: &[f64]) -> Option<VariableJump> {
        let jumps = self.watched.iter().zip(&self.before).filter_map(|(&(variable, slot, absolute), &before)| {
            let after = values[slot];
            let size = (after - before).abs() / (absolute + self.relative * before.abs().max(after.abs()));
            (size > 1.0).then_some((size, VariableJump { variable, before, after }))
        });
        jumps.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, jump)| jump)
    }
}
