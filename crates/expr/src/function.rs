//! User functions whose bodies cannot be written out as expressions: small scalar programs over numbered slots.
//! The crate `model` builds them, [`super::interpret`] runs them, `solve` compiles them, and `tangent` differentiates
//! them.
//!
//! Arrays occupy consecutive slots, row by row. Their sizes are known when the function is built, so there is one
//! [`Function`] for each combination of argument sizes. Slots `0..inputs` are the scalar inputs.

use super::{BinaryFunction, FunctionId, RelationalOp, UnaryFunction};
use std::sync::Arc;

/// A function that is carried out in Rust. It must be pure: equal arguments give equal bits, however often it is
/// called.
pub trait ExternalFunction: std::fmt::Debug + Send + Sync {
    /// One output, by its index. NaN if there is no value.
    fn value(&self, output: usize, args: &[f64]) -> f64;

    /// The derivatives of all outputs by one input, as a function of the same arguments. `None` if they are 0.
    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>>;

    /// The reason why the last call gave no number. `None` if it succeeded.
    fn trouble(&self) -> Option<String> {
        None
    }

    /// The last failure of any call so far, of the function, its derivatives, and others that share its state.
    fn failure(&self) -> Option<String> {
        None
    }
}

/// A shared function that is carried out in Rust. Two handles are equal if they are of the same object.
#[derive(Clone, Debug)]
pub struct ExternalFunctionHandle(pub Arc<dyn ExternalFunction>);

impl PartialEq for ExternalFunctionHandle {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Function {
    /// The function carried out in Rust, if this one assigns an output of it.
    pub fn external(&self) -> Option<&dyn ExternalFunction> {
        self.body.iter().find_map(|statement| match statement {
            SlotStatement::Assign(_, SlotExpr::External(function, ..)) => Some(&*function.0),
            _ => None,
        })
    }
}

/// A function as a program over slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// The full name as the user wrote it, for messages.
    pub name: String,
    /// The number of scalar inputs, which are in slots `0..inputs`.
    pub inputs: u32,
    /// The number of all slots: inputs, outputs and locals.
    pub slots: u32,
    /// The slot of each scalar output, in order.
    pub outputs: Vec<u32>,
    /// The statements, executed in order.
    pub body: Vec<SlotStatement>,
}

/// A statement of such a program.
#[derive(Clone, Debug, PartialEq)]
pub enum SlotStatement {
    /// `slot := value`.
    Assign(u32, SlotExpr),
    /// `slots[base + offset] := value`. An offset outside `0..len` ends the call.
    AssignAt {
        /// The first slot of the array.
        base: u32,
        /// The number of its slots.
        len: u32,
        /// The offset of the element, row by row from 0.
        offset: SlotExpr,
        /// The value to be stored.
        value: SlotExpr,
    },
    /// A call of another function, whose outputs are stored in slots.
    Call {
        /// The function that is called.
        function: FunctionId,
        /// Its scalar arguments.
        args: Vec<SlotExpr>,
        /// The slot for each output, in order. `None` drops an output.
        outputs: Vec<Option<u32>>,
    },
    /// `if`: branches with their conditions in order, then the `else` branch.
    If(Vec<(SlotExpr, Vec<SlotStatement>)>, Vec<SlotStatement>),
    /// `for slot in from:step:to`. The bounds are evaluated once, before the first turn.
    For {
        /// The slot of the loop variable.
        slot: u32,
        /// The first value.
        from: SlotExpr,
        /// The step, which may be negative.
        step: SlotExpr,
        /// The bound, included.
        to: SlotExpr,
        /// The statements of the loop.
        body: Vec<SlotStatement>,
    },
    /// `while`: the condition, and the statements of the loop.
    While(SlotExpr, Vec<SlotStatement>),
    /// `break`: leaves the innermost loop.
    Break,
    /// `return`: ends the function.
    Return,
    /// `assert(condition, message)`. If the condition is 0, the call ends and its outputs are NaN.
    Assert(SlotExpr, String),
}

/// A scalar expression over slots, as a tree without sharing.
#[derive(Clone, Debug, PartialEq)]
pub enum SlotExpr {
    /// A number.
    Num(f64),
    /// The value of a slot.
    Slot(u32),
    /// `slots[base + offset]`. An offset outside `0..len` ends the call.
    At {
        /// The first slot of the array.
        base: u32,
        /// The number of its slots.
        len: u32,
        /// The offset of the element, row by row from 0.
        offset: Box<SlotExpr>,
    },
    /// An operator or function of one argument.
    Unary(UnaryFunction, Box<SlotExpr>),
    /// An operator or function of two arguments.
    Binary(BinaryFunction, Box<SlotExpr>, Box<SlotExpr>),
    /// A relation, whose value is 0 or 1.
    Rel(RelationalOp, Box<SlotExpr>, Box<SlotExpr>),
    /// The second expression if the first is not 0, else the third. Only that one is evaluated.
    If(Box<SlotExpr>, Box<SlotExpr>, Box<SlotExpr>),
    /// One output of another function, by its index.
    Call(FunctionId, u32, Vec<SlotExpr>),
    /// One output of a function that is carried out in Rust, by its index.
    External(ExternalFunctionHandle, u32, Vec<SlotExpr>),
}
