//! Definitions and programs of the event system and the initial system.
//!
//! The sorted blocks of the DAE enter. [`BlockDrafter`] turns them into drafts, which hold kernel definitions;
//! [`assemble`] makes the programs of [`BlockCode`] from the drafts once all slots are known.

use super::jacobian::{Differentials, JacobianEntry, compress};
use super::layout::{ValueSlot, slot};
use super::program::{DefinitionOrder, KernelDefinitions, ProgramAssembler};
use super::shape::{KernelExpression, KernelShaper, ShapingRules};
use super::{AssignCode, AssignTarget, BlockCode, LoopCode, MixedCode, Program, SparsityPattern};
use bramah_expr::{ExprId, VarId};
use bramah_model::structure::{AlgebraicLoop, BltBlock, ExplicitAssignment, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// A block whose definitions are made but whose programs are not, because programs need the slots of all blocks.
#[derive(Debug)]
pub enum BlockDraft {
    /// Neighbouring explicit assignments.
    Assign(AssignDraft),
    /// An algebraic loop.
    Loop(Box<LoopDraft>),
    /// A loop through discrete equations.
    Mixed { continuous: Vec<BlockDraft>, discrete: Vec<AssignDraft> },
}

/// Explicit assignments that become one program.
///
/// They are either all modes of crossings, none of which reads another, or contain no modes. Either all depend on `pre`
/// values or none does.
#[derive(Debug, Default)]
pub struct AssignDraft {
    /// Whether they are modes.
    modes: bool,
    /// Whether they depend on `pre` values.
    moved: bool,
    /// What is computed, in order.
    targets: Vec<AssignTarget>,
    /// Slots of the targets.
    slots: FxHashSet<ValueSlot>,
    /// Their definitions.
    defs: KernelDefinitions,
}

/// An algebraic loop with the definitions of its residual and of its matrix.
#[derive(Debug)]
pub struct LoopDraft {
    /// The loop, with empty programs.
    code: LoopCode,
    /// Definitions of inner variables and residuals.
    residual: KernelDefinitions,
    /// Definitions of inner variables and derivatives.
    jacobian: Differentials,
}

/// Makes the drafts of one sorted system.
pub struct BlockDrafter<'s, 'a> {
    /// Turns expressions into kernels.
    shaper: &'s mut KernelShaper<'a>,
    /// How expressions are treated: `homotopy` is kept in the initial system only.
    rules: ShapingRules<'s>,
    /// The modes of crossings.
    modes: &'s FxHashSet<VarId>,
    /// Slots that depend on `pre` values. They may change from pass to pass of an event iteration, all others keep the
    /// values of its first pass. Empty for the initial system, which has no passes.
    moved: FxHashSet<ValueSlot>,
}

impl<'s, 'a> BlockDrafter<'s, 'a> {
    /// A drafter for the event system, or for the `initial` one. `inline` is an empty map.
    pub fn new(
        shaper: &'s mut KernelShaper<'a>,
        initial: bool,
        inline: &'s FxHashMap<ValueSlot, ExprId>,
        modes: &'s FxHashSet<VarId>,
    ) -> Self {
        let moved = if initial { FxHashSet::default() } else { shaper.layout.pre_slots().collect() };
        BlockDrafter { shaper, rules: ShapingRules { initial, inline, hoist: true }, modes, moved }
    }

    /// The drafts of a sorted system, in order.
    ///
    /// Among neighbouring assignments, those that stay constant through an event iteration come first, so that its
    /// later passes need not run them.
    pub fn blocks(&mut self, blocks: &[BltBlock]) -> Vec<BlockDraft> {
        let mut drafts: Vec<BlockDraft> = Vec::new();
        let mut later: Vec<(AssignTarget, KernelExpression)> = Vec::new();
        for block in blocks {
            if let BltBlock::Assign(assign) = block {
                let (target, shaped) = self.assign(assign);
                // placed behind the assignments that stay constant, up to the next loop
                if self.moves(&shaped.inputs) {
                    self.moved.insert(slot(target.slot));
                    later.push((target, shaped));
                } else {
                    self.join(&mut drafts, false, target, &shaped);
                }
                continue;
            }
            // a loop reads the assignments before it, so the delayed ones must be placed now
            for (target, shaped) in later.drain(..) {
                self.join(&mut drafts, true, target, &shaped);
            }
            let draft = match block {
                BltBlock::Loop(l) => BlockDraft::Loop(Box::new(draft_loop(l, &self.rules, self.shaper))),
                BltBlock::Mixed(mixed) => {
                    let discrete = self.discrete(&mixed.discrete);
                    BlockDraft::Mixed { continuous: self.blocks(&mixed.continuous), discrete }
                }
                BltBlock::Assign(_) => unreachable!("taken above"),
            };
            self.follow(&draft);
            drafts.push(draft);
        }
        for (target, shaped) in later {
            self.join(&mut drafts, true, target, &shaped);
        }
        drafts
    }

    /// Adds an assignment to the last draft if that accepts it, else to a new one.
    fn join(&mut self, drafts: &mut Vec<BlockDraft>, moved: bool, target: AssignTarget, shaped: &KernelExpression) {
        let modes = self.is_mode(target.unknown);
        if !matches!(drafts.last(), Some(BlockDraft::Assign(run)) if run.moved == moved && run.takes(modes, shaped)) {
            drafts.push(BlockDraft::Assign(AssignDraft { modes, moved, ..AssignDraft::default() }));
        }
        if let Some(BlockDraft::Assign(run)) = drafts.last_mut() {
            run.add(target, shaped, self.shaper);
        }
    }

    /// Whether an input depends on `pre` values.
    fn moves(&self, inputs: &[ValueSlot]) -> bool {
        !self.moved.is_empty() && inputs.iter().any(|input| self.moved.contains(input))
    }

    /// Notes the slots that a loop computes from `pre` values. Mixed loops always count as depending on them.
    fn follow(&mut self, draft: &BlockDraft) {
        match draft {
            BlockDraft::Loop(l) if !self.moves(l.residual.slots()) => {}
            _ => draft.computes(&mut |made| {
                self.moved.insert(made);
            }),
        }
    }

    /// The drafts of the discrete equations of a mixed loop, in their given order.
    fn discrete(&mut self, assigns: &[ExplicitAssignment]) -> Vec<AssignDraft> {
        let mut runs: Vec<AssignDraft> = Vec::new();
        for assign in assigns {
            let (target, shaped) = self.assign(assign);
            let modes = self.is_mode(target.unknown);
            match runs.last_mut() {
                Some(run) if run.takes(modes, &shaped) => run.add(target, &shaped, self.shaper),
                _ => {
                    let mut run = AssignDraft { modes, ..AssignDraft::default() };
                    run.add(target, &shaped, self.shaper);
                    runs.push(run);
                }
            }
        }
        runs
    }

    /// Whether an unknown is the mode of a crossing.
    fn is_mode(&self, unknown: Unknown) -> bool {
        matches!(unknown, Unknown::Var(v) if self.modes.contains(&v))
    }

    /// Target and kernel of an explicit assignment.
    fn assign(&mut self, assign: &ExplicitAssignment) -> (AssignTarget, KernelExpression) {
        (target(assign, self.shaper), self.shaper.shape(assign.value, &self.rules))
    }
}

impl BlockDraft {
    /// Calls `visit` for the slot of every unknown of the block.
    fn computes(&self, visit: &mut impl FnMut(ValueSlot)) {
        match self {
            BlockDraft::Assign(run) => run.targets.iter().for_each(|t| visit(slot(t.slot))),
            BlockDraft::Loop(l) => {
                l.code.tearing_slots.iter().for_each(|&s| visit(slot(s)));
                l.code.inner.iter().for_each(|t| visit(slot(t.slot)));
            }
            BlockDraft::Mixed { continuous, discrete } => {
                continuous.iter().for_each(|draft| draft.computes(visit));
                discrete.iter().flat_map(|run| &run.targets).for_each(|t| visit(slot(t.slot)));
            }
        }
    }
}

impl AssignDraft {
    /// Whether an assignment may join: of the same kind, and if it is a mode, without reading a mode of this draft.
    fn takes(&self, modes: bool, shaped: &KernelExpression) -> bool {
        self.modes == modes && !(modes && shaped.inputs.iter().any(|input| self.slots.contains(input)))
    }

    /// Adds an assignment.
    fn add(&mut self, target: AssignTarget, shaped: &KernelExpression, shaper: &mut KernelShaper) {
        self.defs.define(&mut shaper.kernels, slot(target.slot), shaped);
        self.slots.insert(slot(target.slot));
        self.targets.push(target);
    }

    /// Makes the program.
    fn assemble(self, order: DefinitionOrder, assembler: &mut ProgramAssembler) -> AssignCode {
        AssignCode { program: assembler.assemble(&self.defs, order, None), targets: self.targets }
    }
}

/// The target of an explicit assignment.
fn target(assign: &ExplicitAssignment, shaper: &KernelShaper) -> AssignTarget {
    let &ExplicitAssignment { unknown, value, equation } = assign;
    AssignTarget { unknown, slot: shaper.layout.unknown(unknown), equation, value }
}

/// The draft of an algebraic loop.
fn draft_loop(l: &AlgebraicLoop, rules: &ShapingRules, shaper: &mut KernelShaper) -> LoopDraft {
    let one = shaper.layout.number(1.0);
    let mut residual = KernelDefinitions::default();
    let mut jacobian = Differentials::default();
    let tearing_slots: Vec<usize> = l.tearing.iter().map(|&unknown| shaper.layout.unknown(unknown)).collect();
    for (column, &tearing) in (0..).zip(&tearing_slots) {
        // the derivative of a tearing unknown with respect to itself is 1
        jacobian.seed(slot(tearing), column, one);
    }
    let inner: Vec<AssignTarget> = l.inner.iter().map(|assign| target(assign, shaper)).collect();
    let first = shaper.layout.work(l.residuals.len());
    let residual_slots: Vec<usize> = (0..l.residuals.len()).map(|k| first as usize + k).collect();
    // inner variables are read by later definitions, residuals by nobody
    let definitions = inner.iter().map(|t| (t.value, t.slot, true));
    let residuals = l.residuals.iter().zip(&residual_slots).map(|(&(e, _), &place)| (e, place, false));
    for (value, place, is_read) in definitions.chain(residuals) {
        let shaped = shaper.shape(value, rules);
        residual.define(&mut shaper.kernels, slot(place), &shaped);
        jacobian.define(shaper, slot(place), &shaped, is_read);
    }
    let (pattern, jacobian_slots) = loop_matrix(&jacobian, &residual_slots, shaper);
    let code = LoopCode {
        tearing: l.tearing.clone(),
        tearing_slots,
        inner,
        residual_slots,
        residuals: l.residuals.clone(),
        residual: Program::default(),
        pattern,
        jacobian: Program::default(),
        jacobian_slots,
        linear: l.linear,
    };
    LoopDraft { code, residual, jacobian }
}

/// Pattern of the matrix of a loop, and the slot of each entry.
fn loop_matrix(
    jacobian: &Differentials,
    residuals: &[usize],
    shaper: &mut KernelShaper,
) -> (SparsityPattern, Vec<usize>) {
    let zero = shaper.layout.number(0.0);
    let mut entries = Vec::new();
    for (row, &residual) in (0..).zip(residuals) {
        let gradient = jacobian.gradient(slot(residual)).iter();
        entries.extend(gradient.map(|&(column, plus)| JacobianEntry { column, row, plus, minus: zero }));
    }
    let (pattern, slots) = compress(residuals.len(), entries, zero);
    (pattern, slots.into_iter().map(|(plus, _)| plus as usize).collect())
}

/// Makes the programs of all drafts.
pub fn assemble(drafts: Vec<BlockDraft>, assembler: &mut ProgramAssembler) -> Vec<BlockCode> {
    drafts.into_iter().map(|draft| assemble_one(draft, assembler)).collect()
}

/// Makes the programs of one block.
fn assemble_one(draft: BlockDraft, assembler: &mut ProgramAssembler) -> BlockCode {
    match draft {
        BlockDraft::Assign(run) => BlockCode::Assign(run.assemble(DefinitionOrder::Dependency, assembler)),
        BlockDraft::Loop(l) => {
            let LoopDraft { mut code, residual, jacobian } = *l;
            code.residual = assembler.assemble(&residual, DefinitionOrder::Dependency, None);
            let Differentials { defs, products, .. } = jacobian;
            code.jacobian = assembler.assemble(&defs, DefinitionOrder::Dependency, Some(products));
            BlockCode::Loop(Box::new(code))
        }
        BlockDraft::Mixed { continuous, discrete } => BlockCode::Mixed(Box::new(MixedCode {
            continuous: assemble(continuous, assembler),
            // discrete equations of a loop may read a value of the previous pass, so their order is kept
            discrete: discrete.into_iter().map(|run| run.assemble(DefinitionOrder::Given, assembler)).collect(),
        })),
    }
}

/// Calls `visit` for every program of the blocks.
pub fn each_program(blocks: &mut [BlockCode], visit: &mut impl FnMut(&mut Program)) {
    for block in blocks {
        match block {
            BlockCode::Assign(run) => visit(&mut run.program),
            BlockCode::Loop(l) => {
                visit(&mut l.residual);
                visit(&mut l.jacobian);
            }
            BlockCode::Mixed(mixed) => {
                each_program(&mut mixed.continuous, visit);
                mixed.discrete.iter_mut().for_each(|run| visit(&mut run.program));
            }
        }
    }
}
