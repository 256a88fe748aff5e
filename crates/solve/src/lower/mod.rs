//! Lowering: from the sorted DAE to an [`ExecutableSystem`], whose programs compute over one flat array of values.
//!
//! [`lower`] is the entry; `circuit` and `analysis` call it once per model. `eliminate` decides which explicit
//! variables IDA sees as unknowns. `shape` turns expressions into kernels, so that equal expressions share code.
//! `continuous`, `blocks`, `conditions` and `parameters` collect the definitions of each program, `jacobian`
//! differentiates them by the chain rule. `program` orders definitions and merges them into loops and straight code.
//! `code` is the common intermediate form, which `interpret` runs as bytecode and `native` compiles with Cranelift
//! (`translate`). [`ValueLayout`] gives every number its place in the array.

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

/// Options of [`lower`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoweringOptions {
    /// Whether programs that run often enough to pay for it are compiled to machine code. Interpreter and machine code
    /// give the same bits.
    pub native: bool,
    /// Whether conserved quantities (`Dae::conserved`) are integrated in place of their states, which then follow from
    /// them.
    ///
    /// Must be false for callers that integrate the states themselves or compute sensitivities.
    pub conserve: bool,
}

impl Default for LoweringOptions {
    fn default() -> Self {
        LoweringOptions { native: true, conserve: true }
    }
}

impl LoweringOptions {
    /// Interpreter only: for models that run once.
    pub const INTERPRETED: LoweringOptions = LoweringOptions { native: false, conserve: true };
}

/// A computed value is not finite. [`ExecutableSystem::trap`] finds the operation that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonFinite;

/// An unknown of the IDA system: one column of the Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownColumn {
    /// The variable whose value the column holds.
    pub variable: VarId,
    /// How the integrator treats it.
    pub role: ColumnRole,
}

/// How the integrator treats an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnRole {
    /// A state that is integrated: its derivative stands in the equations.
    State,
    /// A state whose value follows from a conserved quantity.
    Following,
    /// A conserved quantity: integrated, but no state of the model.
    Quantity,
    /// An algebraic unknown: a tearing variable of a loop, or an explicit variable that is kept.
    Algebraic,
}

impl UnknownColumn {
    /// Whether it is a state of the model, integrated or following.
    pub fn is_state(&self) -> bool {
        matches!(self.role, ColumnRole::State | ColumnRole::Following)
    }

    /// Whether its derivative stands in the equations.
    pub fn is_differential(&self) -> bool {
        matches!(self.role, ColumnRole::State | ColumnRole::Quantity)
    }
}

/// A conserved quantity that is integrated, such as the mass of oil in a volume, and the state that follows from it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConservedIntegral {
    /// The column of the quantity.
    pub column: usize,
    /// The column of the state that follows from it; the row of the same number determines it.
    pub state: usize,
    /// The slot of the quantity as computed from the states.
    pub slot: ValueSlot,
    /// The slot of its derivative with respect to the following state, from the last Jacobian.
    pub slope: ValueSlot,
    /// Index of that derivative in the Jacobian, where it has the opposite sign; `None` where it vanishes.
    pub entry: Option<usize>,
    /// Indices of all entries of the state's row in the Jacobian.
    pub row: Vec<usize>,
}

/// Compressed sparse columns: the rows of column `j` are `rowidx[colptr[j]..colptr[j + 1]]`, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SparsityPattern {
    /// Number of rows and of columns.
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
    /// The variable or derivative that is computed.
    pub unknown: Unknown,
    /// Its slot.
    pub slot: usize,
    /// The equation it comes from, as an index into `Dae::equations`.
    pub equation: u32,
    /// The expression of its value, for [`ExecutableSystem::trap`].
    pub value: ExprId,
}

/// Explicit assignments in order, as one program.
///
/// Modes of crossings are separate: a program that computes modes computes nothing else, and none of its modes reads
/// another of them. The solver corrects a mode after its program has run (a relation that has just crossed zero keeps
/// its new value, whatever the rounding), and later programs must read the corrected value.
#[derive(Clone, Debug)]
pub struct AssignCode {
    /// The assignments, in order.
    pub targets: Vec<AssignTarget>,
    /// Computes all targets from slots computed earlier.
    pub program: Program,
}

/// An algebraic loop with n tearing unknowns and n residuals.
///
/// To evaluate it, set the tearing slots, run `residual`, and read the residual slots. For Newton's method run
/// `jacobian` after that and read the matrix d residual / d tearing from its slots.
#[derive(Clone, Debug)]
pub struct LoopCode {
    /// The iteration unknowns.
    pub tearing: Vec<Unknown>,
    /// The slot of each tearing unknown.
    pub tearing_slots: Vec<usize>,
    /// Variables of the loop that follow explicitly from the tearing unknowns.
    pub inner: Vec<AssignTarget>,
    /// The slot of each residual.
    pub residual_slots: Vec<usize>,
    /// The expression of each residual, and its equation as an index into `Dae::equations`.
    pub residuals: Vec<(ExprId, u32)>,
    /// Computes inner variables and residuals.
    pub residual: Program,
    /// Pattern of the n x n matrix: rows are residuals, columns are tearing unknowns.
    pub pattern: SparsityPattern,
    /// Computes inner variables, and the matrix into `jacobian_slots`.
    pub jacobian: Program,
    /// The slot of each entry of `pattern`.
    pub jacobian_slots: Vec<usize>,
    /// Whether the residuals are affine in the tearing unknowns, so that one Newton step solves them.
    pub linear: bool,
}

/// A loop through discrete equations.
///
/// The solver repeats `continuous` and `discrete` until no discrete value changes.
#[derive(Clone, Debug)]
pub struct MixedCode {
    /// The continuous blocks, with discrete values frozen. Contains `Assign` and `Loop` only.
    pub continuous: Vec<BlockCode>,
    /// The discrete equations in order; several programs because modes are separate.
    pub discrete: Vec<AssignCode>,
}

/// One step of the event system or of the initial system.
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
    /// One slot per entry of `Dae::actions` (not 0: it fires) or of `Dae::asserts` (not 0: it holds).
    pub holds: Vec<usize>,
    /// One entry per action: the slot of the new value of a `reinit`, or of the condition of an `assert`.
    ///
    /// `None` for `terminate` and for assertions outside `when`.
    pub value: Vec<Option<usize>>,
}

/// A row of the IDA system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResidualRow {
    /// The equation it comes from, as an index into `Dae::equations`.
    pub equation: u32,
    /// The form of the row.
    pub kind: ResidualRowKind,
    /// The right side, or the residual, for [`ExecutableSystem::trap`].
    pub value: ExprId,
}

/// The form of a row of the IDA system. Row i belongs to column i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualRowKind {
    /// `der(x) - value` for the state or conserved quantity of the same column.
    Derivative,
    /// `v - value` for the algebraic unknown of the same column.
    Explicit,
    /// `x - solution` for the state of the same column; at the solution the quantity of the given column has its value.
    Follows(usize),
    /// The residual of a loop.
    Residual,
}

/// Lowers a model for integration.
pub fn lower(dae: Arc<Dae>, options: &LoweringOptions) -> ExecutableSystem {
    let layout = ValueLayout::new(&dae);
    let plan = eliminate::plan(&dae, &layout, true, options.conserve);
    lower_planned(dae, layout, plan, options)
}

/// Lowers a model for evaluation point by point.
///
/// All explicit variables stay explicit, however much they fill the Jacobian, because nobody factorizes it.
pub fn lower_explicit(dae: Arc<Dae>, options: &LoweringOptions) -> ExecutableSystem {
    let layout = ValueLayout::new(&dae);
    let plan = eliminate::plan(&dae, &layout, false, false);
    lower_planned(dae, layout, plan, options)
}

/// Lowers a model whose IDA unknowns are planned already.
fn lower_planned(
    dae: Arc<Dae>,
    layout: ValueLayout,
    plan: ContinuousPlan,
    options: &LoweringOptions,
) -> ExecutableSystem {
    let mut shaper = KernelShaper::new(&dae, layout);
    let drafts = ProgramDrafts::new(&dae, &plan, &mut shaper);
    let KernelShaper { kernels, mut layout, .. } = shaper;
    // derivatives contain numbers that the model does not: they get slots before the code is made
    kernels.numbers().for_each(|number| {
        layout.number(number);
    });
    drafts.assemble(dae, plan, layout, kernels, options)
}

/// The definitions of all programs. Programs are made afterwards, because code needs to know all slots.
struct ProgramDrafts {
    /// Parameters with bindings, and their definitions.
    bindings: (Vec<VarId>, KernelDefinitions),
    /// Residual and Jacobian.
    continuous: ContinuousDraft,
    /// Everything that follows explicitly from the unknowns.
    observables: Observables,
    /// Root functions.
    crossings: CrossingsDraft,
    /// Conserved quantities and their rates.
    quantities: QuantitiesDraft,
    /// Actions of `when` clauses.
    actions: ConditionsDraft,
    /// Assertions outside `when`.
    asserts: ConditionsDraft,
    /// Blocks of the event system.
    event: Vec<blocks::BlockDraft>,
    /// Blocks of the initial system.
    initial: Vec<blocks::BlockDraft>,
    /// Subexpressions that depend on parameters alone.
    hoisted: KernelDefinitions,
}

impl ProgramDrafts {
    /// Collects all definitions.
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
        // last, because the definitions above decide which parts are hoisted
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

    /// Makes all programs and compiles what must be compiled before the first run.
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
        // residual and crossings run at every step, the Jacobian less often
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
        // all kernels are compiled in one module
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

/// Adds to each conserved quantity the indices of its row in the Jacobian.
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

/// Slots of alias and target, and whether the alias has the opposite sign.
fn alias_slots(dae: &Dae, layout: &ValueLayout) -> Vec<(ValueSlot, ValueSlot, bool)> {
    let place = |v| slot(layout.var(v));
    dae.aliases.iter().map(|a| (place(a.variable), place(a.target), a.negated)).collect()
}

/// For each variable whether it is a parameter whose binding depends on one found by the initial system.
///
/// Empty where the initial system finds no parameters.
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
