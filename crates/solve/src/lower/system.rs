//! The lowered model: all programs, and the methods that evaluate residual, Jacobian, crossings and outputs.
//!
//! [`ExecutableSystem`] is the result of `lower`. The solver reaches its programs only through the methods below.

use super::blocks;
use super::continuous::Observables;
use super::follow;
use super::layout::ValueSlot;
use super::native::NativeEntry;
use super::parameters::BindingEvaluator;
use super::program::{CompiledLoops, DefinitionOrder, ProgramAssembler, late_scratch};
use super::shape::KernelTable;
use super::trap::{self, NonFiniteTrap};
use super::{
    BlockCode, ConditionProgram, ConservedIntegral, NonFinite, Program, ResidualRow, ResidualRowKind, SparsityPattern,
    UnknownColumn, ValueLayout,
};
use bramah_expr::function::Function;
use bramah_expr::{ExprId, ExprNode, VarId};
use bramah_model::structure::Dae;
use std::sync::Arc;

/// A model ready to run: immutable, `Send + Sync`, shared by parallel runs.
///
/// Each run owns one array of values, made by `system.layout.values()`. Every method that takes `values` wants that
/// array.
#[derive(Clone, Debug)]
pub struct ExecutableSystem {
    /// The sorted model it was made from.
    pub dae: Arc<Dae>,
    /// The slot of every number in the array of values.
    pub layout: ValueLayout,
    /// The unknowns of the IDA system: states in the order of the DAE, then quantities and algebraic unknowns.
    pub columns: Vec<UnknownColumn>,
    /// The rows of the IDA system, as many as columns.
    pub rows: Vec<ResidualRow>,
    /// Pattern of dF/dy + cj dF/dy'. The diagonal entry is present where the row was made for the column.
    pub pattern: SparsityPattern,
    /// The entries of `Dae::crossings` that need a root function (relations and floors, not times), ascending.
    pub root_crossings: Vec<usize>,
    /// The conserved quantities among the unknowns.
    pub integrals: Vec<ConservedIntegral>,
    /// The event system: from states, inputs and `pre` values it computes everything else.
    pub event: Vec<BlockCode>,
    /// The initial system: computes states, derivatives and everything else.
    pub initial: Vec<BlockCode>,
    /// `Dae::actions`: what fires, and the values of `reinit` and `assert`. Run after the event blocks.
    pub actions: ConditionProgram,
    /// `Dae::asserts`, with all explicit variables they read. Run after [`ExecutableSystem::load`].
    pub asserts: ConditionProgram,
    /// The entries of `Dae::asserts` that depend on parameters alone.
    pub standing_asserts: Vec<usize>,
    /// The programs behind the methods.
    pub(super) programs: SystemPrograms,
}

/// The programs that the methods of [`ExecutableSystem`] run, with the slots of their results.
#[derive(Clone, Debug, Default)]
pub(super) struct SystemPrograms {
    /// All kernels, for programs that are made later.
    pub kernels: Arc<KernelTable>,
    /// User functions that programs call.
    pub functions: Arc<Vec<Function>>,
    /// Computes parameters from their bindings.
    pub bindings: BindingEvaluator,
    /// For each variable whether it is a parameter that depends on one found by the initial system.
    pub late: Vec<bool>,
    /// Computes subexpressions that depend on parameters alone.
    pub hoisted: Program,
    /// Computes the right sides of all rows.
    pub residual: Program,
    /// Computes the entries of the Jacobian.
    pub jacobian: Program,
    /// For each matrix entry the slots of the terms with plus and minus sign.
    pub entries: Vec<(ValueSlot, ValueSlot)>,
    /// For each column the slot of its variable.
    pub column_slots: Vec<ValueSlot>,
    /// For each row the slot of its right side.
    pub row_slots: Vec<ValueSlot>,
    /// Columns whose derivative is read from y', and the slot of that derivative.
    pub torn: Vec<(usize, ValueSlot)>,
    /// Computes root functions with the explicit variables they need.
    pub crossings: Program,
    /// Computes root functions from the slots of all variables.
    pub crossings_alone: Program,
    /// The slot of each root function.
    pub crossing_slots: Vec<ValueSlot>,
    /// Computes conserved quantities and their rates from the slots of all variables.
    pub quantities: Program,
    /// Computes each quantity alone, with the explicit variables it needs.
    pub along: Vec<Program>,
    /// Compiled loops, shared with programs that are made later.
    pub loops: Arc<CompiledLoops>,
    /// Whether programs that are made later may be compiled.
    pub native: bool,
    /// Definitions of all explicit variables, for programs that are made later.
    pub observables: Observables,
    /// Computes all explicit variables.
    pub observe: Program,
    /// Slot of the alias, slot of the target, and whether the sign is negated.
    pub aliases: Vec<(ValueSlot, ValueSlot, bool)>,
    /// First slot of the scratch region at the end of the array.
    pub scratch: ValueSlot,
}

impl ExecutableSystem {
    /// Computes parameters from their bindings, and then everything that depends on parameters alone.
    ///
    /// Entries of `overridden`, indexed by `VarId::index`, keep the value they have in `values`; an empty slice
    /// overrides nothing. Must be called again whenever a parameter has changed.
    pub fn evaluate_parameters(&self, values: &mut [f64], overridden: &[bool]) {
        let p = &self.programs;
        let wanted = |v: VarId| !overridden.get(v.index()).copied().unwrap_or(false);
        p.bindings.run(&p.functions, values, wanted);
        p.hoisted.run(values);
    }

    /// Recomputes parameters that depend on ones found by the initial system.
    pub fn parameters_changed(&self, values: &mut [f64]) {
        let p = &self.programs;
        p.bindings.run(&p.functions, values, |v| p.late.get(v.index()).copied().unwrap_or(false));
    }

    /// The start value of a variable; `None` when it has none.
    pub fn start(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].start, values)
    }

    /// The nominal value of a variable: positive, and 1 when the attribute is missing or not usable.
    pub fn nominal(&self, v: VarId, values: &[f64]) -> f64 {
        let nominal = self.attribute(self.dae.variables[v.index()].nominal, values).map_or(1.0, f64::abs);
        if nominal.is_finite() && nominal > 0.0 { nominal } else { 1.0 }
    }

    /// The attribute `min` of a variable; `None` when it has none.
    pub fn min(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].min, values)
    }

    /// The attribute `max` of a variable; `None` when it has none.
    pub fn max(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].max, values)
    }

    /// The value of an attribute with the present parameters.
    fn attribute(&self, e: Option<ExprId>, values: &[f64]) -> Option<f64> {
        e.map(|e| self.eval(e, values))
    }

    /// Writes time and the unknowns of IDA into their slots.
    ///
    /// Derivatives have slots only where they are tearing variables; all others are computed.
    pub fn load(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64]) {
        values[ValueLayout::TIME] = t;
        for (&slot, &y) in self.programs.column_slots.iter().zip(y) {
            values[slot as usize] = y;
        }
        for &(column, slot) in &self.programs.torn {
            values[slot as usize] = yp[column];
        }
    }

    /// Writes the residual F(t, y, y') to `r`, one entry per row. Rows are not scaled.
    ///
    /// The forms of the rows are those of [`ResidualRowKind`].
    ///
    /// # Errors
    /// An entry of `r` is not finite.
    pub fn residual(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], r: &mut [f64]) -> Result<(), NonFinite> {
        self.rows(t, y, yp, values, r)?;
        // rows of following states need a search along the state
        for (integral, program) in self.integrals.iter().zip(&self.programs.along) {
            r[integral.state] = y[integral.state] - self.following(integral, program, y, values, r).ok_or(NonFinite)?;
        }
        Ok(())
    }

    /// The value of a state at which its conserved quantity has the value in `y`. All other values stay as they are.
    ///
    /// `None` when the search finds no solution.
    fn following(
        &self,
        integral: &ConservedIntegral,
        program: &Program,
        y: &[f64],
        values: &mut [f64],
        r: &[f64],
    ) -> Option<f64> {
        let place = self.programs.column_slots[integral.state] as usize;
        let (start, wanted) = (y[integral.state], y[integral.column]);
        let mut slope = values[integral.slope as usize];
        let along = |x: f64| {
            values[place] = x;
            program.run(values);
            values[integral.slot as usize]
        };
        let found = follow::solve(along, wanted, start, wanted - r[integral.state], &mut slope);
        // other rows and later evaluations must see the unknown of IDA, not the solution
        values[place] = start;
        found
    }

    /// Writes all rows; a row of a following state holds the difference between its quantity and the value by the
    /// states.
    fn rows(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], r: &mut [f64]) -> Result<(), NonFinite> {
        self.load(t, y, yp, values);
        self.programs.residual.run(values);
        let mut finite = true;
        for (i, (row, &place)) in self.rows.iter().zip(&self.programs.row_slots).enumerate() {
            let value = values[place as usize];
            r[i] = match row.kind {
                ResidualRowKind::Derivative => yp[i] - value,
                ResidualRowKind::Explicit => y[i] - value,
                ResidualRowKind::Follows(quantity) => y[quantity] - value,
                ResidualRowKind::Residual => value,
            };
            finite &= r[i].is_finite();
        }
        if finite { Ok(()) } else { Err(NonFinite) }
    }

    /// Whether [`ExecutableSystem::rate_residual`] has the form `y' - f(t, y)` for every unknown.
    pub fn gives_rates(&self) -> bool {
        let torn = |column: usize| self.programs.torn.iter().any(|t| t.0 == column);
        self.rows.iter().enumerate().all(|(i, row)| match row.kind {
            ResidualRowKind::Derivative => true,
            ResidualRowKind::Follows(_) => !torn(i),
            ResidualRowKind::Explicit | ResidualRowKind::Residual => false,
        })
    }

    /// Writes the residual with `der(x) - value` in the rows of following states.
    ///
    /// # Errors
    /// An entry of `r` is not finite.
    pub fn rate_residual(
        &self,
        t: f64,
        y: &[f64],
        yp: &[f64],
        values: &mut [f64],
        r: &mut [f64],
    ) -> Result<(), NonFinite> {
        self.rows(t, y, yp, values, r)?;
        for state in self.integrals.iter().map(|i| i.state) {
            let der = self.layout.der(self.columns[state].variable).expect("a state");
            r[state] = yp[state] - values[der];
        }
        if r.iter().all(|r| r.is_finite()) { Ok(()) } else { Err(NonFinite) }
    }

    /// Computes conserved quantities into their slots, and their rates into the slots of their derivatives.
    ///
    /// The slots of all variables must be up to date.
    pub fn quantities(&self, values: &mut [f64]) {
        self.programs.quantities.run(values);
    }

    /// Writes dF/dy + cj dF/dy' to `val`, in the order of `pattern`.
    ///
    /// # Errors
    /// An entry is not finite.
    pub fn jacobian(
        &self,
        t: f64,
        cj: f64,
        y: &[f64],
        yp: &[f64],
        values: &mut [f64],
        val: &mut [f64],
    ) -> Result<(), NonFinite> {
        self.load(t, y, yp, values);
        values[ValueLayout::CJ] = cj;
        self.programs.jacobian.run(values);
        let mut finite = true;
        for (entry, &(plus, minus)) in val.iter_mut().zip(&self.programs.entries) {
            *entry = values[plus as usize] - values[minus as usize];
            finite &= entry.is_finite();
        }
        // The row is x - solution(q): dividing the row of q - quantity(x) by minus its slope gives the derivatives of
        // that.
        for integral in &self.integrals {
            let slope = integral.entry.map_or(0.0, |k| -val[k]);
            values[integral.slope as usize] = slope;
            for &k in &integral.row {
                val[k] /= -slope;
                finite &= val[k].is_finite();
            }
        }
        if finite { Ok(()) } else { Err(NonFinite) }
    }

    /// Writes the root functions to `g`: left side minus right side, or the argument of a `floor`.
    ///
    /// There is one entry per entry of `root_crossings`. Explicit variables are computed on the way.
    pub fn crossings(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], g: &mut [f64]) {
        self.load(t, y, yp, values);
        self.programs.crossings.run(values);
        self.copy_crossings(values, g);
    }

    /// The same from the slots as they are, after the event or initial blocks have run.
    pub fn crossings_from(&self, values: &mut [f64], g: &mut [f64]) {
        self.programs.crossings_alone.run(values);
        self.copy_crossings(values, g);
    }

    /// Copies the root functions from their slots.
    fn copy_crossings(&self, values: &[f64], g: &mut [f64]) {
        for (g, &slot) in g.iter_mut().zip(&self.programs.crossing_slots) {
            *g = values[slot as usize];
        }
    }

    /// Fills the slots of all variables and derivatives from y, y' and the discrete slots.
    ///
    /// Derivatives of states come from their equations where these are explicit, otherwise from y'.
    pub fn observe(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64]) {
        self.load(t, y, yp, values);
        self.programs.observe.run(values);
    }

    /// A program that fills the slots of these variables. It must be run after [`ExecutableSystem::load`].
    pub fn observe_only(&self, wanted: &[VarId]) -> Program {
        let p = &self.programs;
        let slots = wanted.iter().filter_map(|&v| self.layout.leaf(ExprNode::Var(v)));
        let defs = p.observables.needed(&p.kernels, slots);
        let mut assembler = ProgramAssembler::with_loops(&p.kernels, &self.layout, p.native, &p.loops);
        let mut program = assembler.assemble(&defs, DefinitionOrder::Dependency, None);
        // the scratch region was sized when the system was made and cannot grow
        let room = self.layout.len() - p.scratch as usize;
        assert!(program.scratch() as usize <= room, "`late_scratch` is an upper bound");
        program.finish(p.scratch, p.scratch as usize + program.scratch() as usize, &p.functions, &[]);
        program
    }

    /// Copies the targets of aliases into the slots of the aliases.
    pub fn aliases(&self, values: &mut [f64]) {
        for &(alias, target, negated) in &self.programs.aliases {
            let value = values[target as usize];
            values[alias as usize] = if negated { -value } else { value };
        }
    }

    /// The value of any expression of the model by the reference interpreter, for messages and rare evaluations.
    pub fn eval(&self, e: ExprId, values: &[f64]) -> f64 {
        self.dae.exprs.eval(e, &mut |node| self.leaf(node, values))
    }

    /// For residual and Jacobian: number of loops and pieces of straight code, and number of instructions.
    pub fn code_sizes(&self) -> [(usize, usize); 2] {
        [&self.programs.residual, &self.programs.jacobian].map(|program| (program.kernels(), program.size()))
    }

    /// Completes all programs: tells them where the scratch region begins and which code has been compiled.
    pub(super) fn finish(&mut self, entries: &[NativeEntry]) {
        let mut scratch = self.programs.bindings.scratch();
        self.each_program(&mut |program| scratch = scratch.max(program.scratch()));
        let late = late_scratch(&self.programs.observables.defs, &self.programs.kernels);
        let base = self.layout.work(late.max(scratch as usize));
        let (len, functions) = (self.layout.len(), self.programs.functions.clone());
        self.programs.scratch = base;
        self.programs.bindings.relocate(base);
        self.each_program(&mut |program| program.finish(base, len, &functions, entries));
    }

    /// From now on machine code is run, as after many runs.
    #[cfg(test)]
    pub(super) fn hurry(&mut self) {
        self.each_program(&mut |program| program.hurry());
    }

    /// Calls `visit` for every program of the system.
    fn each_program(&mut self, visit: &mut impl FnMut(&mut Program)) {
        let p = &mut self.programs;
        for program in [&mut p.hoisted, &mut p.residual, &mut p.jacobian, &mut p.crossings] {
            visit(program);
        }
        for program in [&mut p.crossings_alone, &mut p.quantities, &mut p.observe].into_iter().chain(&mut p.along) {
            visit(program);
        }
        visit(&mut self.actions.program);
        visit(&mut self.asserts.program);
        blocks::each_program(&mut self.event, visit);
        blocks::each_program(&mut self.initial, visit);
    }

    /// The value of a leaf of an expression; 0 where it has no slot.
    pub(super) fn leaf(&self, node: ExprNode, values: &[f64]) -> f64 {
        self.layout.leaf(node).map_or(0.0, |slot| values[slot as usize])
    }

    /// The first operation in `e`, in the order of evaluation, that makes a value that is not finite.
    ///
    /// `None` when the value of `e` is finite.
    pub fn trap(&self, e: ExprId, values: &[f64]) -> Option<NonFiniteTrap> {
        trap::find(self, e, values)
    }
}
