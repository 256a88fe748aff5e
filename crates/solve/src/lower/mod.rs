//! From the sorted DAE to a [`ExecutableSystem`]: programs over one flat array of values for the residual, its exact sparse
//! Jacobian, zero crossings, outputs, events and the start.
//!
//! [`lower`] is the entry. How the array is laid out says [`ValueLayout`]; which explicit variables IDA never sees says
//! `eliminate`; how equal expressions share one kernel says `shape`.

mod blocks;
mod code;
mod conditions;
mod continuous;
mod eliminate;
mod follow;
mod interpret;
mod jacobian;
mod layout;
mod native;
mod parameters;
mod program;
mod shape;
mod system;
mod translate;
mod trap;

pub use layout::{ValueLayout, ValueSlot};
pub use program::Program;
pub use system::ExecutableSystem;
pub use trap::NonFiniteTrap;

use bramah_expr::{ExprId, VarId};
use bramah_model::structure::{Dae, Unknown};
use conditions::ConditionsDraft;
use continuous::{ContinuousDraft, CrossingsDraft, Observables, QuantitiesDraft};
use eliminate::ContinuousPlan;
use jacobian::Differentials;
use layout::slot;
use parameters::BindingEvaluator;
use program::{DefinitionOrder, KernelDefinitions, ProgramAssembler};
use rustc_hash::FxHashMap;
use shape::{KernelShaper, KernelTable};
use std::sync::Arc;
use system::SystemPrograms;

/// How to lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoweringOptions {
    /// Compile to machine code what runs often enough to pay for it; else everything is interpreted. Both give the same
    /// bits.
    pub native: bool,
    /// Integrate conserved quantities where the model states them (`Dae::conserved`), and let the states follow. Not for
    /// callers who integrate the states themselves or carry sensitivities along.
    pub conserve: bool,
}

impl Default for LoweringOptions {
    fn default() -> Self {
        LoweringOptions { native: true, conserve: true }
    }
}

impl LoweringOptions {
    /// Interpreted only: for models that run once.
    pub const INTERPRETED: LoweringOptions = LoweringOptions { native: false, conserve: true };
}

/// A value that is not finite came out. [`ExecutableSystem::trap`] finds where it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonFinite;

/// An unknown of the IDA system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownColumn {
    /// The variable.
    pub variable: VarId,
    /// What it is to the integrator.
    pub role: ColumnRole,
}

/// What an unknown is to the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnRole {
    /// A state that is integrated.
    State,
    /// A state that follows from a conserved quantity.
    Following,
    /// A conserved quantity: integrated, but no state of the model.
    Quantity,
    /// An algebraic unknown.
    Algebraic,
}

impl UnknownColumn {
    /// A state of the model.
    pub fn is_state(&self) -> bool {
        matches!(self.role, ColumnRole::State | ColumnRole::Following)
    }

    /// Its derivative stands in the equations.
    pub fn is_differential(&self) -> bool {
        matches!(self.role, ColumnRole::State | ColumnRole::Quantity)
    }
}

/// A conserved quantity that is integrated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConservedIntegral {
    /// The column of the quantity.
    pub column: usize,
    /// The column of the state that follows from it.
    pub state: usize,
    /// The slot of the quantity as it is by the states.
    pub slot: ValueSlot,
    /// The slot of its derivative by the state that follows, as far as it is known.
    pub slope: ValueSlot,
    /// Where that derivative stands in the Jacobian, with the sign turned; `None` where it vanishes.
    pub entry: Option<usize>,
    /// The entries of its row there.
    pub row: Vec<usize>,
}

/// Compressed sparse columns: rows of column `j` are `rowidx[colptr[j]..colptr[j + 1]]`, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SparsityPattern {
    /// Rows and columns.
    pub n: usize,
    /// `n + 1` positions in `rowidx`.
    pub colptr: Vec<usize>,
    /// Row of each entry.
    pub rowidx: Vec<usize>,
}

impl SparsityPattern {
    /// Number of entries.
    pub fn nnz(&self) -> usize {
        self.rowidx.len()
    }
}

/// One explicit assignment inside a [`BlockCode`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AssignTarget {
    /// What is computed.
    pub unknown: Unknown,
    /// Its slot.
    pub slot: usize,
    /// Index into `Dae::equations`.
    pub equation: u32,
    /// The value's expression, for [`ExecutableSystem::trap`].
    pub value: ExprId,
}

/// Explicit assignments in order, as one program.
///
/// Modes of crossings stand alone: a program that computes modes computes nothing else, and none of its modes reads
/// another of them. The solver corrects a mode after its program has run (a relation that has just crossed zero keeps
/// its new value, whatever the rounding), and what follows must read the corrected value.
#[derive(Clone, Debug)]
pub struct AssignCode {
    /// What it computes, in order.
    pub targets: Vec<AssignTarget>,
    /// Computes all targets from the slots of what came before.
    pub program: Program,
}

/// An algebraic loop. Set the tearing slots, run `residual`, read the residual slots; for Newton run `jacobian` after
/// that and read the matrix of d residual / d tearing from its slots.
#[derive(Clone, Debug)]
pub struct LoopCode {
    /// Iteration unknowns.
    pub tearing: Vec<Unknown>,
    /// The slot of each tearing unknown.
    pub tearing_slots: Vec<usize>,
    /// Variables that follow explicitly.
    pub inner: Vec<AssignTarget>,
    /// The slot of each residual, as many as tearing unknowns.
    pub residual_slots: Vec<usize>,
    /// The expression of each residual and its equation (index into `Dae::equations`).
    pub residuals: Vec<(ExprId, u32)>,
    /// Computes inner variables and residuals.
    pub residual: Program,
    /// Structure of the matrix: rows are residuals, columns are tearing unknowns.
    pub pattern: SparsityPattern,
    /// Computes inner variables, and the matrix into `jacobian_slots`.
    pub jacobian: Program,
    /// The slot of each entry of `pattern`.
    pub jacobian_slots: Vec<usize>,
    /// The residuals are affine in the tearing unknowns: one Newton step solves them.
    pub linear: bool,
}

/// A loop through discrete equations: solve `continuous`, run `discrete`, until no discrete value changes.
#[derive(Clone, Debug)]
pub struct MixedCode {
    /// With discrete values frozen; `Assign` and `KernelLoop` only.
    pub continuous: Vec<BlockCode>,
    /// The discrete equations, in order; several programs because modes stand alone.
    pub discrete: Vec<AssignCode>,
}

/// A step of the event or initial system.
#[derive(Clone, Debug)]
pub enum BlockCode {
    /// Neighbouring explicit assignments of the sorted system, joined.
    Assign(AssignCode),
    /// An algebraic loop.
    Loop(Box<LoopCode>),
    /// A loop through discrete equations.
    Mixed(Box<MixedCode>),
}

/// Conditions that are evaluated together; see [`ExecutableSystem::actions`] and [`ExecutableSystem::asserts`].
#[derive(Clone, Debug)]
pub struct ConditionProgram {
    /// Computes all slots below from the slots of variables.
    pub program: Program,
    /// Per entry of `Dae::actions` whether it fires (not 0), or per entry of `Dae::asserts` whether it holds (not 0).
    pub holds: Vec<usize>,
    /// Per action the new value of a `reinit` or the condition of an `assert`; `None` for `terminate` and for asserts
    /// outside `when`.
    pub value: Vec<Option<usize>>,
}

/// A row of the IDA system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResidualRow {
    /// Index into `Dae::equations`.
    pub equation: u32,
    /// What it was made for.
    pub kind: ResidualRowKind,
    /// The right side, or the residual: for [`ExecutableSystem::trap`].
    pub value: ExprId,
}

/// What a row of the IDA system was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualRowKind {
    /// `der(x) - value` for the state of the column with the row's own number.
    Derivative,
    /// `v - value` for the algebraic unknown of the column with the row's own number.
    Explicit,
    /// `x - solution` for the state of the row's own number: the solution has the quantity of this column.
    Follows(usize),
    /// The residual of a loop.
    Residual,
}

/// Lowers a model.
pub fn lower(dae: Arc<Dae>, options: &LoweringOptions) -> ExecutableSystem {
    let layout = ValueLayout::new(&dae);
    let plan = eliminate::plan(&dae, &layout, true, options.conserve);
    lower_planned(dae, layout, plan, options)
}

/// Lowers a model for evaluation point by point: all that is explicit stays so, however much it fills the Jacobian,
/// because nobody factorises it.
pub fn lower_explicit(dae: Arc<Dae>, options: &LoweringOptions) -> ExecutableSystem {
    let layout = ValueLayout::new(&dae);
    let plan = eliminate::plan(&dae, &layout, false, false);
    lower_planned(dae, layout, plan, options)
}

fn lower_planned(
    dae: Arc<Dae>,
    layout: ValueLayout,
    plan: ContinuousPlan,
    options: &LoweringOptions,
) -> ExecutableSystem {
    let mut shaper = KernelShaper::new(&dae, layout);
    let drafts = ProgramDrafts::new(&dae, &plan, &mut shaper);
    let KernelShaper { kernels, mut layout, .. } = shaper;
    kernels.numbers().for_each(|number| {
        layout.number(number);
    });
    drafts.assemble(dae, plan, layout, kernels, options)
}

/// The definitions of all programs, before the programs are made: code needs to know all slots.
struct ProgramDrafts {
    bindings: (Vec<VarId>, KernelDefinitions),
    continuous: ContinuousDraft,
    observables: Observables,
    crossings: CrossingsDraft,
    quantities: QuantitiesDraft,
    actions: ConditionsDraft,
    asserts: ConditionsDraft,
    event: Vec<blocks::BlockDraft>,
    initial: Vec<blocks::BlockDraft>,
    hoisted: KernelDefinitions,
}

impl ProgramDrafts {
    fn new(dae: &Dae, plan: &ContinuousPlan, shaper: &mut KernelShaper) -> ProgramDrafts {
        let inline = FxHashMap::default();
        let modes = dae.crossings.iter().map(|crossing| crossing.mode).collect();
        let bindings = parameters::draft(dae, shaper);
        let continuous = continuous::draft(plan, shaper);
        let observables = Observables::new(dae, plan, shaper);
        let crossings = continuous::crossings(dae, shaper);
        let quantities = continuous::quantities(plan, shaper);
        let actions = conditions::actions(dae, shaper);
        let asserts = conditions::asserts(dae, shaper);
        let event = blocks::BlockDrafter::new(shaper, false, &inline, &modes).blocks(&dae.event);
        let initial = blocks::BlockDrafter::new(shaper, true, &inline, &modes).blocks(&dae.initial);
        let hoisted = shaper.hoisted_definitions();
        ProgramDrafts {
            bindings,
            continuous,
            observables,
            crossings,
            quantities,
            actions,
            asserts,
            event,
            initial,
            hoisted,
        }
    }

    fn assemble(
        self,
        dae: Arc<Dae>,
        plan: ContinuousPlan,
        layout: ValueLayout,
        kernels: KernelTable,
        options: &LoweringOptions,
    ) -> ExecutableSystem {
        let functions = Arc::new(kernels.pool.functions.clone());
        let kernels = Arc::new(kernels);
        let mut programs = SystemPrograms { functions, kernels: kernels.clone(), ..SystemPrograms::default() };
        programs.column_slots = plan.columns.iter().map(|c| slot(layout.var(c.variable))).collect();
        programs.row_slots = self.continuous.row_slots;
        programs.entries = self.continuous.entries;
        programs.torn = plan.torn;
        programs.crossing_slots = self.crossings.slots;
        programs.aliases = alias_slots(&dae, &layout);
        programs.late = late_parameters(&dae);
        programs.bindings = BindingEvaluator::new(&self.bindings.0, &self.bindings.1, &kernels, &layout);

        let mut assembler = ProgramAssembler::new(&kernels, &layout, options.native);
        let by_need = DefinitionOrder::Dependency;
        assembler.often(true);
        programs.residual = assembler.assemble(&self.continuous.residual, by_need, None);
        let with_observables = self.observables.before(&kernels, &self.crossings.defs);
        programs.crossings = assembler.assemble(&with_observables, by_need, None);
        assembler.often(false);
        let Differentials { defs, products, .. } = self.continuous.jacobian;
        programs.jacobian = assembler.assemble(&defs, by_need, Some(products));
        // a model with samples spends much of its time at events
        assembler.often(!dae.samples.is_empty());
        programs.crossings_alone = assembler.assemble(&self.crossings.defs, by_need, None);
        programs.quantities = assembler.assemble(&self.quantities.defs, by_need, None);
        assembler.often(true);
        for alone in &self.quantities.alone {
            let with_observables = self.observables.before(&kernels, alone);
            programs.along.push(assembler.assemble(&with_observables, by_need, None));
        }
        assembler.often(false);
        programs.observe = assembler.assemble(&self.observables.defs, by_need, None);
        let actions = self.actions.assemble(None, &mut assembler);
        let asserts = self.asserts.assemble(Some(&self.observables), &mut assembler);
        let event = blocks::assemble(self.event, &mut assembler);
        assembler.often(false);
        programs.observables = self.observables;
        programs.hoisted = assembler.assemble(&self.hoisted, by_need, None);
        let initial = blocks::assemble(self.initial, &mut assembler);
        let (entries, loops) = assembler.compile(&programs.functions);
        programs.loops = Arc::new(loops);
        programs.native = options.native;

        let standing_asserts = conditions::standing(&dae);
        let mut system = ExecutableSystem {
            columns: plan.columns,
            rows: plan.rows,
            integrals: located(self.quantities.integrals, &self.continuous.pattern),
            pattern: self.continuous.pattern,
            root_crossings: self.crossings.list,
            dae,
            layout,
            event,
            initial,
            actions,
            asserts,
            standing_asserts,
            programs,
        };
        system.finish(&entries);
        system
    }
}

/// With the places of the derivatives in the Jacobian.
fn located(mut integrals: Vec<ConservedIntegral>, pattern: &SparsityPattern) -> Vec<ConservedIntegral> {
    let of_row: FxHashMap<usize, usize> =
        integrals.iter().enumerate().map(|(i, integral)| (integral.state, i)).collect();
    for column in 0..pattern.n {
        for k in pattern.colptr[column]..pattern.colptr[column + 1] {
            let row = pattern.rowidx[k];
            let Some(&i) = of_row.get(&row) else { continue };
            integrals[i].row.push(k);
            if row == column {
                integrals[i].entry = Some(k);
            }
        }
    }
    integrals
}

fn alias_slots(dae: &Dae, layout: &ValueLayout) -> Vec<(ValueSlot, ValueSlot, bool)> {
    let place = |v| slot(layout.var(v));
    dae.aliases.iter().map(|a| (place(a.variable), place(a.target), a.negated)).collect()
}

/// Per variable: a parameter with a binding that depends on one found by the initial system.
fn late_parameters(dae: &Dae) -> Vec<bool> {
    if dae.free_parameters.is_empty() {
        return Vec::new();
    }
    let fixed = shape::fixed_parameters(dae);
    let mut late = vec![false; fixed.len()];
    for v in &dae.parameters {
        late[v.index()] = !fixed[v.index()];
    }
    late
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod random_tests;
