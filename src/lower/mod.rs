//! From the sorted DAE to a [`System`]: programs over one flat array of values for the residual, its exact sparse
//! Jacobian, zero crossings, outputs, events and the start.
//!
//! [`lower`] is the entry. How the array is laid out says [`Layout`]; which explicit variables IDA never sees says
//! `eliminate`; how equal expressions share one kernel says `shape`.

#[allow(dead_code, reason = "used by the programs that follow")]
mod layout;
mod program;
mod system;

pub use layout::{Layout, Slot};
pub use program::Program;
pub use system::System;

use crate::expr::{ExprId, VarId};
use crate::structure::{Dae, Unknown};
use std::sync::Arc;

/// How to lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Compile to machine code; else everything is interpreted. Both give the same bits.
    pub native: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options { native: true }
    }
}

/// A value that is not finite came out. [`System::trap`] finds where it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonFinite;

/// The first operation that made a value that is not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Trap {
    /// The operation with its numbers, as in `sqrt(-3.2)`.
    pub operation: String,
    /// The same operation as the user wrote it, as in `sqrt(valve.dp)`.
    pub written: String,
    /// Its value: infinite or NaN.
    pub value: f64,
}

/// An unknown of the IDA system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// The variable.
    pub variable: VarId,
    /// True for a state (differential), false for an algebraic unknown.
    pub state: bool,
}

/// Compressed sparse columns: rows of column `j` are `rowidx[colptr[j]..colptr[j + 1]]`, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pattern {
    /// Rows and columns.
    pub n: usize,
    /// `n + 1` positions in `rowidx`.
    pub colptr: Vec<usize>,
    /// Row of each entry.
    pub rowidx: Vec<usize>,
}

impl Pattern {
    /// Number of entries.
    pub fn nnz(&self) -> usize {
        self.rowidx.len()
    }
}

/// One explicit assignment inside a [`BlockCode`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// What is computed.
    pub unknown: Unknown,
    /// Its slot.
    pub slot: usize,
    /// Index into `Dae::equations`.
    pub equation: u32,
    /// The value's expression, for [`System::trap`].
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
    pub targets: Vec<Target>,
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
    pub inner: Vec<Target>,
    /// The slot of each residual, as many as tearing unknowns.
    pub residual_slots: Vec<usize>,
    /// The expression of each residual and its equation (index into `Dae::equations`).
    pub residuals: Vec<(ExprId, u32)>,
    /// Computes inner variables and residuals.
    pub residual: Program,
    /// Structure of the matrix: rows are residuals, columns are tearing unknowns.
    pub pattern: Pattern,
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
    /// With discrete values frozen; `Assign` and `Loop` only.
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

/// Conditions that are evaluated together; see [`System::actions`] and [`System::asserts`].
#[derive(Clone, Debug)]
pub struct Conditions {
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
pub struct Row {
    /// Index into `Dae::equations`.
    pub equation: u32,
    /// What it was made for.
    pub kind: RowKind,
    /// The right side, or the residual: for [`System::trap`].
    pub value: ExprId,
}

/// What a row of the IDA system was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// `der(x) - value` for the state of the column with the row's own number.
    Derivative,
    /// `v - value` for the algebraic unknown of the column with the row's own number.
    Explicit,
    /// The residual of a loop.
    Residual,
}

/// Lowers a model.
pub fn lower(dae: Arc<Dae>, _options: &Options) -> System {
    let layout = Layout::new(&dae);
    let columns = dae.states.iter().map(|&variable| Column { variable, state: true }).collect();
    let nothing = Conditions { program: Program::default(), holds: Vec::new(), value: Vec::new() };
    System {
        layout,
        columns,
        rows: Vec::new(),
        pattern: Pattern::default(),
        root_crossings: Vec::new(),
        event: Vec::new(),
        initial: Vec::new(),
        actions: nothing.clone(),
        asserts: nothing,
        dae,
    }
}
