//! What `when` clauses do and what `assert`s demand, as slots to be looked at.

use super::continuous::Observables;
use super::layout::Slot;
use super::program::{Assembler, Defs, Order};
use super::shape::{Rules, Shaper};
use super::{Conditions, Program};
use bramah_expr::visit::Walk;
use bramah_expr::{ExprId, Node};
use bramah_model::flat::Variability;
use bramah_model::structure::{ActionKind, Dae};
use rustc_hash::FxHashMap;

/// Conditions whose definitions are made and whose program is not.
#[derive(Debug)]
pub struct ConditionsDraft {
    defs: Defs,
    code: Conditions,
}

impl ConditionsDraft {
    fn new() -> Self {
        let code = Conditions { program: Program::default(), holds: Vec::new(), value: Vec::new() };
        ConditionsDraft { defs: Defs::default(), code }
    }

    fn define(&mut self, e: ExprId, shaper: &mut Shaper) -> usize {
        let inline = FxHashMap::default();
        let shaped = shaper.shape(e, &Rules { initial: false, inline: &inline, hoist: true });
        let target: Slot = shaper.layout.work(1);
        self.defs.define(&mut shaper.kernels, target, &shaped);
        target as usize
    }

    /// The conditions with their program, which first computes what `before` computes.
    pub fn assemble(mut self, before: Option<&Observables>, assembler: &mut Assembler) -> Conditions {
        let kernels = assembler.kernels();
        let defs = before.map_or_else(|| self.defs.clone(), |before| before.before(kernels, &self.defs));
        self.code.program = assembler.assemble(&defs, Order::Dependency, None);
        self.code
    }
}

/// `dae.actions`: whether they fire, and their values.
pub fn actions(dae: &Dae, shaper: &mut Shaper) -> ConditionsDraft {
    let mut draft = ConditionsDraft::new();
    for action in &dae.actions {
        let fires = draft.define(action.fires, shaper);
        let value = match &action.kind {
            ActionKind::Reinit(_, value) => Some(*value),
            ActionKind::Assert(assert) => Some(assert.condition),
            ActionKind::Terminate(_) => None,
        };
        let value = value.map(|value| draft.define(value, shaper));
        draft.code.holds.push(fires);
        draft.code.value.push(value);
    }
    draft
}

/// The entries of `dae.asserts` that speak of parameters alone whose values stand before the start.
pub fn standing(dae: &Dae) -> Vec<usize> {
    let mut walk = Walk::default();
    let mut stands = |condition: ExprId| {
        let mut stands = true;
        walk.each(&dae.exprs, &[condition], |e, node| {
            stands &= match node {
                Node::Num(_) => true,
                Node::Var(v) => {
                    let still = dae.variables[v.index()].variability <= Variability::Parameter;
                    still && !dae.free_parameters.contains(&v)
                }
                _ => !dae.exprs.operands(e).as_slice().is_empty(),
            };
            stands
        });
        stands
    };
    (0..dae.asserts.len()).filter(|&i| stands(dae.asserts[i].condition)).collect()
}

/// `dae.asserts`: whether they hold.
pub fn asserts(dae: &Dae, shaper: &mut Shaper) -> ConditionsDraft {
    let mut draft = ConditionsDraft::new();
    for assert in &dae.asserts {
        let holds = draft.define(assert.condition, shaper);
        draft.code.holds.push(holds);
        draft.code.value.push(None);
    }
    draft
}
