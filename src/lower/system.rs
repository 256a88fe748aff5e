//! The lowered model.

use super::{BlockCode, Column, Conditions, Layout, NonFinite, Pattern, Program, Row, Trap};
use crate::expr::{ExprId, VarId};
use crate::structure::Dae;
use std::sync::Arc;

/// A model ready to run: immutable, `Send + Sync`, shared by parallel runs. Each run owns one array of values, made by
/// `system.layout.values()`; every method below that takes `values` wants that array.
#[derive(Clone, Debug)]
pub struct System {
    /// The model.
    pub dae: Arc<Dae>,
    /// Where values live.
    pub layout: Layout,
    /// The unknowns of the IDA system: states in the order of the DAE, then algebraic unknowns.
    pub columns: Vec<Column>,
    /// The rows of the IDA system, as many as columns.
    pub rows: Vec<Row>,
    /// Structure of dF/dy + cj dF/dyp. Every diagonal entry is present where the row was made for the column.
    pub pattern: Pattern,
    /// The entries of `Dae::crossings` that need a root function (relations and floors, not times), in order.
    pub root_crossings: Vec<usize>,
    /// The system at events: given states, inputs and `pre` values, computes everything else.
    pub event: Vec<BlockCode>,
    /// The system at the start: computes states, derivatives and everything else.
    pub initial: Vec<BlockCode>,
    /// `Dae::actions`: what fires, and the values of `reinit` and `assert`. Run after the event blocks.
    pub actions: Conditions,
    /// `Dae::asserts`, with all explicit variables they need: run after [`System::load`].
    pub asserts: Conditions,
}

impl System {
    /// Computes parameters from their bindings (entries of `overridden`, by `VarId::index`, keep the value they have in
    /// `values`; an empty slice overrides nothing), and then everything that depends on parameters alone.
    /// To be called again whenever a parameter's value has been changed.
    pub fn evaluate_parameters(&self, _values: &mut [f64], _overridden: &[bool]) {}

    /// Recomputes what depends on parameters alone, after a parameter was found by the initial system.
    pub fn parameters_changed(&self, _values: &mut [f64]) {}

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
    pub fn load(&self, t: f64, y: &[f64], _yp: &[f64], values: &mut [f64]) {
        values[Layout::TIME] = t;
        for (column, y) in self.columns.iter().zip(y) {
            values[self.layout.var(column.variable)] = *y;
        }
    }

    /// The residual F(t, y, yp) into `r`. Rows are not scaled. A row made for an explicit derivative is
    /// `der(x) - value`, one for a kept explicit variable `v - value`, one from a loop its residual as it stands.
    ///
    /// # Errors
    /// When an entry of `r` is not finite.
    pub fn residual(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], r: &mut [f64]) -> Result<(), NonFinite> {
        self.load(t, y, yp, values);
        if r.iter().all(|r| r.is_finite()) { Ok(()) } else { Err(NonFinite) }
    }

    /// dF/dy + cj dF/dyp into `val`, in the order of `pattern`.
    ///
    /// # Errors
    /// When an entry is not finite.
    pub fn jacobian(
        &self,
        t: f64,
        _cj: f64,
        y: &[f64],
        yp: &[f64],
        values: &mut [f64],
        val: &mut [f64],
    ) -> Result<(), NonFinite> {
        self.load(t, y, yp, values);
        if val.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(NonFinite) }
    }

    /// Per entry of `root_crossings` left side minus right side, or the argument of a `floor`, into `g`.
    pub fn crossings(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64], _g: &mut [f64]) {
        self.load(t, y, yp, values);
    }

    /// The same from the slots as they are (after the event or initial blocks have run).
    pub fn crossings_from(&self, _values: &mut [f64], _g: &mut [f64]) {}

    /// Fills the slots of all variables and derivatives from y, yp and the discrete slots. Derivatives of states come
    /// from their equations where they are explicit, else from yp.
    pub fn observe(&self, t: f64, y: &[f64], yp: &[f64], values: &mut [f64]) {
        self.load(t, y, yp, values);
        self.aliases(values);
    }

    /// A program that fills the slots of these variables, to be run after [`System::load`].
    pub fn observe_only(&self, _wanted: &[VarId]) -> Program {
        Program::default()
    }

    /// Copies targets of aliases into the aliases' slots.
    pub fn aliases(&self, values: &mut [f64]) {
        for alias in &self.dae.aliases {
            let value = values[self.layout.var(alias.target)];
            values[self.layout.var(alias.variable)] = if alias.negated { -value } else { value };
        }
    }

    /// The value of any expression of the model by the reference interpreter: for messages and what is rare.
    pub fn eval(&self, _e: ExprId, _values: &[f64]) -> f64 {
        0.0
    }

    /// The first operation in `e` that makes a value that is not finite, in the order of evaluation.
    pub fn trap(&self, _e: ExprId, _values: &[f64]) -> Option<Trap> {
        None
    }
}
