//! User functions with algorithm bodies that cannot be inlined: a small scalar program over numbered slots.
//!
//! Arrays are laid out row-major in consecutive slots, with sizes known when the function is built (one [`Function`]
//! per combination of argument sizes). Slots `0..inputs` are the scalarised inputs.

use super::{BinaryFunction, FunctionId, RelationalOp, UnaryFunction};
use std::sync::Arc;

/// A function that is carried out in Rust: the same bits for the same arguments, however often it is asked.
pub trait ExternalFunction: std::fmt::Debug + Send + Sync {
    /// One output; not a number where there is none.
    fn value(&self, output: usize, args: &[f64]) -> f64;

    /// The derivatives of all outputs by one argument, as a function of the same arguments; `None` where they are 0.
    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>>;

    /// What went wrong in the last call, where it gave no number.
    fn trouble(&self) -> Option<String> {
        None
    }

    /// What went wrong in any call so far of it, of its derivatives and of what belongs together with it.
    fn failure(&self) -> Option<String> {
        None
    }
}

/// A handle of such a function; two are equal where they are the same one.
#[derive(Clone, Debug)]
pub struct ExternalFunctionHandle(pub Arc<dyn ExternalFunction>);

impl PartialEq for ExternalFunctionHandle {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Function {
    /// The function that is carried out in Rust, where this one only calls it.
    pub fn external(&self) -> Option<&dyn ExternalFunction> {
        self.body.iter().find_map(|statement| match statement {
            SlotStatement::Assign(_, SlotExpr::External(function, ..)) => Some(&*function.0),
            _ => None,
        })
    }
}

/// A compiled function body.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// The full name, as the user wrote it.
    pub name: String,
    /// Number of scalar inputs: slots `0..inputs`.
    pub inputs: u32,
    /// Number of slots in all.
    pub slots: u32,
    /// The slot of each scalar output.
    pub outputs: Vec<u32>,
    /// The program.
    pub body: Vec<SlotStatement>,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub enum SlotStatement {
    /// `slot := value`
    Assign(u32, SlotExpr),
    /// `slots[base + offset] := value`; the offset is checked against `len`.
    AssignAt {
        /// First slot of the array.
        base: u32,
        /// Number of slots of the array.
        len: u32,
        /// Zero-based row-major offset.
        offset: SlotExpr,
        /// The value.
        value: SlotExpr,
    },
    /// Outputs of another function into slots (`None` skips one).
    Call {
        /// The function.
        function: FunctionId,
        /// Its scalar arguments.
        args: Vec<SlotExpr>,
        /// Where its scalar outputs go, by output number.
        outputs: Vec<Option<u32>>,
    },
    /// `if`
    If(Vec<(SlotExpr, Vec<SlotStatement>)>, Vec<SlotStatement>),
    /// `for slot in from:step:to`, bounds evaluated once.
    For {
        /// The loop variable.
        slot: u32,
        /// First value.
        from: SlotExpr,
        /// Step.
        step: SlotExpr,
        /// Last value.
        to: SlotExpr,
        /// The body.
        body: Vec<SlotStatement>,
    },
    /// `while`
    While(SlotExpr, Vec<SlotStatement>),
    /// `break`
    Break,
    /// `return`
    Return,
    /// `assert(condition, message)`: a failed one makes the outputs NaN and stops the call.
    Assert(SlotExpr, String),
}

/// A scalar expression over slots.
#[derive(Clone, Debug, PartialEq)]
pub enum SlotExpr {
    /// A number.
    Num(f64),
    /// A slot.
    Slot(u32),
    /// `slots[base + offset]`, offset checked against `len`.
    At {
        /// First slot.
        base: u32,
        /// Number of slots.
        len: u32,
        /// Zero-based row-major offset.
        offset: Box<SlotExpr>,
    },
    /// A function of one argument.
    Unary(UnaryFunction, Box<SlotExpr>),
    /// A function of two arguments.
    Binary(BinaryFunction, Box<SlotExpr>, Box<SlotExpr>),
    /// A relation.
    Rel(RelationalOp, Box<SlotExpr>, Box<SlotExpr>),
    /// Only the chosen branch is evaluated.
    If(Box<SlotExpr>, Box<SlotExpr>, Box<SlotExpr>),
    /// One scalar output of another function.
    Call(FunctionId, u32, Vec<SlotExpr>),
    /// One output of a function carried out in Rust.
    External(ExternalFunctionHandle, u32, Vec<SlotExpr>),
}
