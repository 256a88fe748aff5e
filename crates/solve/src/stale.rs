//! Which blocks of the event system must be solved again in an event iteration: those that read changed values.
//!
//! After its first pass an iteration changes little: `pre` values, modes of `sample`, states that are set. All other
//! blocks would give the same results, including loops, which are expensive. `events` uses it from the second pass on.

use crate::lower::{BlockCode, ExecutableSystem};
use bramah_expr::ExprId;

/// The dependences between the event blocks, and which blocks are stale.
#[derive(Debug)]
pub struct StaleBlocks {
    /// For each slot where its readers begin in `readers`; one more entry for the end.
    starts: Vec<u32>,
    /// Blocks in the order of the slots that they read.
    readers: Vec<u32>,
    /// For each block the slots that it computes.
    computed: Vec<Vec<usize>>,
    /// For each block whether it is stale.
    waiting: Vec<bool>,
    /// Values that the present block had computed before.
    before: Vec<f64>,
}

impl StaleBlocks {
    /// The dependences of the event blocks of a system. No block is stale.
    pub fn new(system: &ExecutableSystem) -> Self {
        let computed: Vec<Vec<usize>> = system.event.iter().map(computed).collect();
        let mut maker = vec![None; system.layout.len()];
        for (number, slots) in (0_u32..).zip(&computed) {
            slots.iter().for_each(|&slot| maker[slot] = Some(number));
        }
        let mut reads: Vec<(usize, u32)> = Vec::new();
        for (number, block) in (0..).zip(&system.event) {
            // what a block computes itself does not make it stale
            let slots = read(system, block).into_iter().filter(|&slot| maker[slot] != Some(number));
            reads.extend(slots.map(|slot| (slot, number)));
        }
        reads.sort_unstable();
        let starts = (0..=system.layout.len()).map(|slot| reads.partition_point(|r| r.0 < slot) as u32).collect();
        StaleBlocks {
            starts,
            readers: reads.iter().map(|r| r.1).collect(),
            waiting: vec![false; computed.len()],
            computed,
            before: Vec::new(),
        }
    }

    /// Marks the blocks that read this slot as stale.
    pub fn touch(&mut self, slot: usize) {
        for &reader in &self.readers[self.starts[slot] as usize..self.starts[slot + 1] as usize] {
            self.waiting[reader as usize] = true;
        }
    }

    /// Whether a block is stale, and marks it as up to date. Its present results are stored for [`Self::compare`].
    pub fn take(&mut self, block: usize, values: &[f64]) -> bool {
        let waited = std::mem::take(&mut self.waiting[block]);
        if waited {
            self.before.clear();
            self.before.extend(self.computed[block].iter().map(|&slot| values[slot]));
        }
        waited
    }

    /// Marks the readers of all results of this block that have changed as stale.
    pub fn compare(&mut self, block: usize, values: &[f64]) {
        for k in 0..self.before.len() {
            let slot = self.computed[block][k];
            // by bits, so that NaN equals NaN
            if values[slot].to_bits() != self.before[k].to_bits() {
                self.touch(slot);
            }
        }
    }
}

/// The slots that a block computes.
fn computed(block: &BlockCode) -> Vec<usize> {
    match block {
        BlockCode::Assign(run) => run.targets.iter().map(|t| t.slot).collect(),
        BlockCode::Loop(l) => l.tearing_slots.iter().copied().chain(l.inner.iter().map(|t| t.slot)).collect(),
        BlockCode::Mixed(mixed) => {
            let discrete = mixed.discrete.iter().flat_map(|run| &run.targets).map(|t| t.slot);
            mixed.continuous.iter().flat_map(computed).chain(discrete).collect()
        }
    }
}

/// The slots that a block reads: variables, derivatives and `pre` values.
fn read(system: &ExecutableSystem, block: &BlockCode) -> Vec<usize> {
    let (layout, found) = (&system.layout, system.dae.exprs.dependencies(&expressions(block)));
    let vars = found.vars.iter().map(|&v| layout.var(v));
    let ders = found.ders.iter().filter_map(|&v| layout.der(v));
    let pres = found.pres.iter().filter_map(|&v| layout.pre(v));
    vars.chain(ders).chain(pres).collect()
}

/// All expressions of a block.
fn expressions(block: &BlockCode) -> Vec<ExprId> {
    match block {
        BlockCode::Assign(run) => run.targets.iter().map(|t| t.value).collect(),
        BlockCode::Loop(l) => l.inner.iter().map(|t| t.value).chain(l.residuals.iter().map(|r| r.0)).collect(),
        BlockCode::Mixed(mixed) => {
            let discrete = mixed.discrete.iter().flat_map(|run| &run.targets).map(|t| t.value);
            mixed.continuous.iter().flat_map(expressions).chain(discrete).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lower::{LoweringOptions, lower};
    use bramah_expr::VarId;
    use std::sync::Arc;

    /// A counter at a clock, and a loop for `y` that only the state reaches.
    fn system() -> ExecutableSystem {
        let text = "model M
               discrete Integer n(start = 0, fixed = true);
               Real x(start = 1, fixed = true), y;
             equation
               y^3 + y = x;
               der(x) = n - x;
               when sample(0, 0.1) then
                 n = pre(n) + 1;
               end when;
             end M;";
        let flat = bramah_model::compile::flatten_text(text, None).value.expect("sound").flat;
        let dae = bramah_model::compile::analyze(&flat).value.expect("sound");
        lower(Arc::new(dae), &LoweringOptions::INTERPRETED)
    }

    /// Whether a loop waits, and whether anything else does, after a slot has changed.
    fn waits(system: &ExecutableSystem, slot: usize) -> (bool, bool) {
        let mut stale = StaleBlocks::new(system);
        stale.touch(slot);
        let values = system.layout.values();
        let mut found = (false, false);
        for (number, block) in system.event.iter().enumerate() {
            if stale.take(number, &values) {
                *(if matches!(block, BlockCode::Loop(_)) { &mut found.0 } else { &mut found.1 }) = true;
            }
        }
        found
    }

    #[test]
    fn a_loop_waits_for_what_it_reads_alone() {
        let system = system();
        let named = |name: &str| {
            let at = system.dae.variables.iter().position(|v| v.name == name).expect("a variable");
            VarId(u32::try_from(at).expect("few"))
        };
        let before = system.layout.pre(named("n")).expect("it is discrete");
        assert_eq!(waits(&system, before), (false, true));
        assert!(waits(&system, system.layout.var(named("x"))).0);
    }
}
