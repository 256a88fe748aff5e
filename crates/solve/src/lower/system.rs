//! The lowered model.

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

/// A model ready to run: immutable, `Send + Sync`, shared by parallel runs. Each run owns one array of values, made by
/// `system.layout.values()`; every method below that takes `values` wants that array.
#[derive(Clone, Debug)]
pub struct ExecutableSystem {
    /// The model.
    pub dae: Arc<Dae>,
    /// Where values live.
    pub layout: ValueLayout,
    /// The unknowns of the IDA system: states in the order of the DAE, then algebraic unknowns.
    pub columns: Vec<UnknownColumn>,
    /// The rows of the IDA system, as many as columns.
    pub rows: Vec<ResidualRow>,
    /// Structure of dF/dy + cj dF/dyp. Every diagonal entry is present where the row was made for the column.
    pub pattern: SparsityPattern,
    /// The entries of `Dae::crossings` that need a root function (relations and floors, not times), in order.
    pub root_crossings: Vec<usize>,
    /// The conserved quantities among the unknowns.
    pub integrals: Vec<ConservedIntegral>,
    /// The system at events: given states, inputs and `pre` values, computes everything else.
    pub event: Vec<BlockCode>,
    /// The system at the start: computes states, derivatives and everything else.
    pub initial: Vec<BlockCode>,
    /// `Dae::actions`: what fires, and the values of `reinit` and `assert`. Run after the event blocks.
    pub actions: ConditionProgram,
    /// `Dae::asserts`, with all explicit variables they need: run after [`ExecutableSystem::load`].
    pub asserts: ConditionProgram,
    /// The entries of `Dae::asserts` about parameters alone.
    pub standing_asserts: Vec<usize>,
    pub(super) programs: SystemPrograms,
}

/// What the methods of [`ExecutableSystem`] run.
#[derive(Clone, Debug, Default)]
pub(super) struct SystemPrograms {
    pub kernels: Arc<KernelTable>,
    pub functions: Arc<Vec<Function>>,
    pub bindings: BindingEvaluator,
    /// Parameters that depend on ones found by the initial system.
    pub late: Vec<bool>,
    pub hoisted: Program,
    pub residual: Program,
    pub jacobian: Program,
    /// Per matrix entry, the slots of what is added and subtracted.
    pub entries: Vec<(ValueSlot, ValueSlot)>,
    /// Per column, the slot of its variable.
    pub column_slots: Vec<ValueSlot>,
    /// Per row, the slot of its right side.
    pub row_slots: Vec<ValueSlot>,
    /// Columns whose derivative is read from yp, and its slot.
    pub torn: Vec<(usize, ValueSlot)>,
    /// Root functions with the explicit variables they need, and without.
    pub crossings: Program,
    pub crossings_alone: Program,
    pub crossing_slots: Vec<ValueSlot>,
    /// Conserved quantities and their rates, from all variables.
    pub quantities: Program,
    /// Each quantity alone, with the explicit variables it needs.
    pub along: Vec<Program>,
    pub loops: Arc<CompiledLoops>,
    /// Whether programs that are made later are compiled when they run often.
    pub native: bool,
    pub observables: Observables,
    pub observe: Program,
    /// Alias, target, negated.
    pub aliases: Vec<(ValueSlot, ValueSlot, bool)>,
    /// Where the scratch region begins.
    pub scratch: ValueSlot,
}

impl ExecutableSystem {
    /// Computes parameters from their bindings (entries of `overridden`, by `VarId::index`, keep the value they have in
    /// `values`; an empty slice overrides nothing), and then everything that depends on parameters alone.
    /// To be called again whenever a parameter's value has been changed.
    pub fn evaluate_parameters(&self, values: &mut [f64], overridden: &[bool]) {
        let p = &self.programs;
        let wanted = |v: VarId| !overridden.get(v.index()).copied().unwrap_or(false);
        p.bindings.run(&p.functions, values, wanted);
        p.hoisted.run(values);
    }

    /// Recomputes what depends on parameters that the initial system has found.
    pub fn parameters_changed(&self, values: &mut [f64]) {
        let p = &self.programs;
        p.bindings.run(&p.functions, values, |v| p.late.get(v.index()).copied().unwrap_or(false));
    }

    /// The start value of a variable, if one is given.
    pub fn start(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].start, values)
    }

    /// The size of usual values of a variable: positive, 1 when nothing sensible is given.
    pub fn nominal(&self, v: VarId, values: &[f64]) -> f64 {
        let nominal = self.attribute(self.dae.variables[v.index()].nominal, values).map_or(1.0, f64::abs);
        if nominal.is_finite() && nominal > 0.0 { nominal } else { 1.0 }
    }

    /// The smallest sensible value of a variable, if one is given.
    pub fn min(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].min, values)
    }

    /// The largest sensible value of a variable, if one is given.
    pub fn max(&self, v: VarId, values: &[f64]) -> Option<f64> {
        self.attribute(self.dae.variables[v.index()].max, values)
    }

    fn attribute(&self, e: Option<ExprId>, values: &[f64]) -> Option<f64> {
        e.map(|e| self.eval(e, values))
    }

    /// Puts time and the IDA unknowns into their slots.
    pub fn load(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64]) {
        values[ValueLayout::TIME] = t;
        for (&slot, &y) in self.programs.column_slots.iter().zip(y) {
            values[slot as usize] = y;
        }
        for &(column, slot) in &self.programs.torn {
            values[slot as usize] = yp[column];
        }
    }

    /// The residual F(t, y, yp) into `r`. Rows are not scaled. A row made for an explicit derivative is
    /// `der(x) - value`, one for a kept explicit variable `v - value`, one for a state that follows from a quantity
    /// `x - solution`, one from a loop its residual as it stands.
    ///
    /// # Errors
    /// When an entry of `r` is not finite.
    pub fn residual(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], r: &mut [f64]) -> Result<(), NonFinite> {
        self.rows(t, y, yp, values, r)?;
        for (integral, program) in self.integrals.iter().zip(&self.programs.along) {
            r[integral.state] = y[integral.state] - self.following(integral, program, y, values, r).ok_or(NonFinite)?;
        }
        Ok(())
    }

    /// The value of a state that has the quantity in `y`, all else as it is.
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
        values[place] = start;
        found
    }

    /// The rows, those of states that follow from a quantity as what it lacks.
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

    /// Whether [`ExecutableSystem::rate_residual`] is one in which every unknown has a derivative of its own.
    pub fn gives_rates(&self) -> bool {
        let torn = |column: usize| self.programs.torn.iter().any(|t| t.0 == column);
        self.rows.iter().enumerate().all(|(i, row)| match row.kind {
            ResidualRowKind::Derivative => true,
            ResidualRowKind::Follows(_) => !torn(i),
            ResidualRowKind::Explicit | ResidualRowKind::Residual => false,
        })
    }

    /// The residual, with `der(x) - value` for states that follow from a quantity.
    ///
    /// # Errors
    /// When an entry of `r` is not finite.
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

    /// Conserved quantities into their slots and their rates into those of their derivatives, from the slots of all
    /// variables.
    pub fn quantities(&self, values: &mut [f64]) {
        self.programs.quantities.run(values);
    }

    /// dF/dy + cj dF/dyp into `val`, in the order of `pattern`.
    ///
    /// # Errors
    /// When an entry is not finite.
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

    /// Per entry of `root_crossings` left side minus right side, or the argument of a `floor`, into `g`.
    pub fn crossings(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], g: &mut [f64]) {
        self.load(t, y, yp, values);
        self.programs.crossings.run(values);
        self.copy_crossings(values, g);
    }

    /// The same from the slots as they are (after the event or initial blocks have run).
    pub fn crossings_from(&self, values: &mut [f64], g: &mut [f64]) {
        self.programs.crossings_alone.run(values);
        self.copy_crossings(values, g);
    }

    fn copy_crossings(&self, values: &[f64], g: &mut [f64]) {
        for (g, &slot) in g.iter_mut().zip(&self.programs.crossing_slots) {
            *g = values[slot as usize];
        }
    }

    /// Fills the slots of all variables and derivatives from y, yp and the discrete slots. Derivatives of states come
    /// from their equations where they are explicit, else from yp.
    pub fn observe(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64]) {
        self.load(t, y, yp, values);
        self.programs.observe.run(values);
    }

    /// A program that fills the slots of these variables, to be run after [`ExecutableSystem::load`].
    pub fn observe_only(&self, wanted: &[VarId]) -> Program {
        let p = &self.programs;
        let slots = wanted.iter().filter_map(|&v| self.layout.leaf(ExprNode::Var(v)));
        let defs = p.observables.needed(&p.kernels, slots);
        let mut assembler = ProgramAssembler::with_loops(&p.kernels, &self.layout, p.native, &p.loops);
        let mut program = assembler.assemble(&defs, DefinitionOrder::Dependency, None);
        let room = self.layout.len() - p.scratch as usize;
        assert!(program.scratch() as usize <= room, "`late_scratch` is an upper bound");
        program.finish(p.scratch, p.scratch as usize + program.scratch() as usize, &p.functions, &[]);
        program
    }

    /// Copies targets of aliases into the aliases' slots.
    pub fn aliases(&self, values: &mut [f64]) {
        for &(alias, target, negated) in &self.programs.aliases {
            let value = values[target as usize];
            values[alias as usize] = if negated { -value } else { value };
        }
    }

    /// The value of any expression of the model by the reference interpreter: for messages and what is rare.
    pub fn eval(&self, e: ExprId, values: &[f64]) -> f64 {
        self.dae.exprs.eval(e, &mut |node| self.leaf(node, values))
    }

    /// Sizes of residual and Jacobian in pieces (loops and straight code) and instructions, for tests and measurements.
    pub fn code_sizes(&self) -> [(usize, usize); 2] {
        [&self.programs.residual, &self.programs.jacobian].map(|program| (program.kernels(), program.size()))
    }

    /// Last touch to all programs: where the scratch region begins and what has been compiled.
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

    /// The value of a leaf.
    pub(super) fn leaf(&self, node: ExprNode, values: &[f64]) -> f64 {
        self.layout.leaf(node).map_or(0.0, |slot| values[slot as usize])
    }

    /// The first operation in `e` that makes a value that is not finite, in the order of evaluation.
    pub fn trap(&self, e: ExprId, values: &[f64]) -> Option<NonFiniteTrap> {
        trap::find(self, e, values)
    }
}
