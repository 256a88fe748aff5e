//! Definitions of the conditions of `when` actions and of assertions.
//!
//! `lower` calls [`actions`], [`asserts`] and [`standing`]. The result is a [`ConditionProgram`], which the event
//! iteration and the driver run.

use super::continuous::Observables;
use super::layout::ValueSlot;
use super::program::{DefinitionOrder, KernelDefinitions, ProgramAssembler};
use super::shape::{KernelShaper, ShapingRules};
use super::{ConditionProgram, Program};
use bramah_expr::visit::NodeTraversal;
use bramah_expr::{ExprId, ExprNode};
use bramah_model::flat::Variability;
use bramah_model::structure::{Dae, EventActionKind};
use rustc_hash::FxHashMap;

/// Conditions whose definitions are made but whose program is not.
#[derive(Debug)]
pub struct ConditionsDraft {
    /// The definitions.
    defs: KernelDefinitions,
    /// The slots of the results, with an empty program.
    code: ConditionProgram,
}

impl ConditionsDraft {
    /// No conditions.
    fn new() -> Self {
        let code = ConditionProgram { program: Program::default(), holds: Vec::new(), value: Vec::new() };
        ConditionsDraft { defs: KernelDefinitions::default(), code }
    }

    /// Adds the definition of an expression and returns its new slot.
    fn define(&mut self, e: ExprId, shaper: &mut KernelShaper) -> usize {
        let inline = FxHashMap::default();
        let shaped = shaper.shape(e, &ShapingRules { initial: false, inline: &inline, hoist: true });
        let target: ValueSlot = shaper.layout.work(1);
        self.defs.define(&mut shaper.kernels, target, &shaped);
        target as usize
    }

    /// Makes the program. It first computes those variables of `before` that the conditions read.
    pub fn assemble(mut self, before: Option<&Observables>, assembler: &mut ProgramAssembler) -> ConditionProgram {
        let kernels = assembler.kernels();
        let defs = before.map_or_else(|| self.defs.clone(), |before| before.before(kernels, &self.defs));
        self.code.program = assembler.assemble(&defs, DefinitionOrder::Dependency, None);
        self.code
    }
}

/// `dae.actions`: whether they fire, and their values.
///
/// The value of a `reinit` is its new state, that of an `assert` its condition. `terminate` has none.
pub fn actions(dae: &Dae, shaper: &mut KernelShaper) -> ConditionsDraft {
    let mut draft = ConditionsDraft::new();
    for action in &dae.actions {
        let fires = draft.define(action.fires, shaper);
        let value = match &action.kind {
            EventActionKind::Reinit(_, value) => Some(*value),
            EventActionKind::Assert(assert) => Some(assert.condition),
            EventActionKind::Terminate(_) => None,
        };
        let value = value.map(|value| draft.define(value, shaper));
        draft.code.holds.push(fires);
        draft.code.value.push(value);
    }
    draft
}

/// The entries of `dae.asserts` whose conditions depend only on parameters that are known before the start.
///
/// They are checked once per set of parameters, before the initial system is solved.
pub fn standing(dae: &Dae) -> Vec<usize> {
    let mut walk = NodeTraversal::default();
    let mut stands = |condition: ExprId| {
        let mut stands = true;
        walk.each(&dae.exprs, &[condition], |e, node| {
            stands &= match node {
                ExprNode::Num(_) => true,
                ExprNode::Var(v) => {
                    let still = dae.variables[v.index()].variability <= Variability::Parameter;
                    still && !dae.free_parameters.contains(&v)
                }
                // an operation passes, its operands are visited in turn; any other leaf depends on the run
                _ => !dae.exprs.operands(e).as_slice().is_empty(),
            };
            stands
        });
        stands
    };
    (0..dae.asserts.len()).filter(|&i| stands(dae.asserts[i].condition)).collect()
}

/// `dae.asserts`: whether they hold.
pub fn asserts(dae: &Dae, shaper: &mut KernelShaper) -> ConditionsDraft {
    let mut draft = ConditionsDraft::new();
    for assert in &dae.asserts {
        let holds = draft.define(assert.condition, shaper);
        draft.code.holds.push(holds);
        draft.code.value.push(None);
    }
    draft
}
