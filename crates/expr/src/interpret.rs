//! The interpreter of functions: runs a [`Function`] on numbers. Native code is compared with it.
//!
//! All slots are 0 at the beginning. A call ends at once if it takes too many steps, nests too deeply, indexes outside
//! an
//! array, or fails an `assert`. Its outputs are then NaN, and the solver treats the point as one without a value.

use super::function::{Function, SlotExpr, SlotStatement};
use super::{FunctionId, math};

/// The number of statements and loop turns that one outermost call may take, those of inner calls included.
pub const STEP_BUDGET: u64 = 10_000_000;

/// The number of calls that may be active inside each other.
pub const DEPTH_LIMIT: u32 = 200;

/// The reason why a call has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum CallFailure {
    /// It took more than [`STEP_BUDGET`] steps.
    Steps {
        /// The function that ran at that moment.
        function: String,
    },
    /// More than [`DEPTH_LIMIT`] calls were active inside each other.
    Depth {
        /// The function whose call was one too many.
        function: String,
    },
    /// An index outside of its array.
    Index {
        /// The function with the index.
        function: String,
        /// The offset, row by row from 0. It may be fractional, negative or NaN.
        offset: f64,
        /// The number of elements of the array.
        len: u32,
    },
    /// An `assert` failed.
    Assert {
        /// The function with the assertion.
        function: String,
        /// The message of the assertion.
        message: String,
    },
}

// Messages show these texts, with indices counted from 1 as in Modelica.
impl std::fmt::Display for CallFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            CallFailure::Steps { function } => write!(f, "`{function}` did not end within {STEP_BUDGET} steps"),
            CallFailure::Depth { function } => write!(f, "`{function}` is called more than {DEPTH_LIMIT} levels deep"),
            CallFailure::Index { function, offset, len } => {
                write!(f, "element {} of an array of {len} in `{function}`", offset + 1.0)
            }
            CallFailure::Assert { function, message } => write!(f, "{message} (in `{function}`)"),
        }
    }
}

impl Function {
    /// Computes all outputs, which are NaN if the call fails.
    /// `all` is the pool's list of functions. `args` has `inputs` values, and `out` one element for each output.
    pub fn call(&self, all: &[Function], args: &[f64], out: &mut [f64]) {
        if self.try_call(all, args, out).is_err() {
            out.fill(f64::NAN);
        }
    }

    /// As [`Function::call`], with the reason if there is no value. Then `out` is left as it was.
    pub fn try_call(&self, all: &[Function], args: &[f64], out: &mut [f64]) -> Result<(), CallFailure> {
        Interpreter { all, left: STEP_BUDGET, depth: 0 }.call(self, args.to_vec(), |output, value| out[output] = value)
    }
}

/// How a list of statements ended.
/// Statements return it, so that loops and calls know whether to continue.
enum ExecutionFlow {
    /// At its end.
    Next,
    /// By `break`: the innermost loop ends.
    Break,
    /// By `return`: the function ends.
    Return,
}

/// The state of one outermost call.
struct Interpreter<'a> {
    /// The functions of the pool.
    all: &'a [Function],
    /// The steps that are left.
    left: u64,
    /// The number of active calls.
    depth: u32,
}

/// The state of one active function.
/// Slots are private to it: recursive calls have frames of their own.
struct StackFrame<'a> {
    /// The function.
    function: &'a Function,
    /// The values of its slots.
    slots: Vec<f64>,
}

impl<'a> Interpreter<'a> {
    /// Calls a function. `result` gets the index and value of each output.
    ///
    /// # Errors
    /// The call, or one inside it, has no value.
    fn call(
        &mut self,
        function: &'a Function,
        mut args: Vec<f64>,
        mut result: impl FnMut(usize, f64),
    ) -> Result<(), CallFailure> {
        if self.depth == DEPTH_LIMIT {
            return Err(CallFailure::Depth { function: function.name.clone() });
        }
        self.depth += 1;
        // The arguments become the first slots.
        args.resize(function.slots as usize, 0.0);
        let mut frame = StackFrame { function, slots: args };
        self.statements(&mut frame, &function.body)?;
        for (output, &slot) in function.outputs.iter().enumerate() {
            result(output, frame.slots[slot as usize]);
        }
        // After an error the depth does not matter, because the outermost call ends too.
        self.depth -= 1;
        Ok(())
    }

    /// Counts a step.
    ///
    /// # Errors
    /// The budget is used up.
    fn step(&mut self, frame: &StackFrame) -> Result<(), CallFailure> {
        if self.left == 0 {
            return Err(CallFailure::Steps { function: frame.function.name.clone() });
        }
        self.left -= 1;
        Ok(())
    }

    /// Executes statements in order, until one of them leaves the list.
    fn statements(
        &mut self,
        frame: &mut StackFrame<'a>,
        body: &'a [SlotStatement],
    ) -> Result<ExecutionFlow, CallFailure> {
        for stmt in body {
            self.step(frame)?;
            match self.statement(frame, stmt)? {
                ExecutionFlow::Next => {}
                ended => return Ok(ended),
            }
        }
        Ok(ExecutionFlow::Next)
    }

    /// Executes one statement.
    /// Compound statements return the flow of their bodies.
    fn statement(&mut self, frame: &mut StackFrame<'a>, stmt: &'a SlotStatement) -> Result<ExecutionFlow, CallFailure> {
        match stmt {
            SlotStatement::Assign(slot, value) => frame.slots[*slot as usize] = self.term(frame, value)?,
            SlotStatement::AssignAt { base, len, offset, value } => {
                // The value is computed before the offset, as in native code.
                let value = self.term(frame, value)?;
                let at = self.element(frame, *base, *len, offset)?;
                frame.slots[at] = value;
            }
            SlotStatement::Call { function, args, outputs } => {
                let args = self.terms(frame, args)?;
                let slots = &mut frame.slots;
                self.call(self.function(*function), args, |output, value| {
                    if let Some(Some(slot)) = outputs.get(output) {
                        slots[*slot as usize] = value;
                    }
                })?;
            }
            SlotStatement::If(branches, otherwise) => {
                for (condition, body) in branches {
                    if self.term(frame, condition)? != 0.0 {
                        return self.statements(frame, body);
                    }
                }
                return self.statements(frame, otherwise);
            }
            SlotStatement::For { slot, from, step, to, body } => {
                return self.count(frame, *slot, [from, step, to], body);
            }
            SlotStatement::While(condition, body) => return self.repeat(frame, condition, body),
            SlotStatement::Break => return Ok(ExecutionFlow::Break),
            SlotStatement::Return => return Ok(ExecutionFlow::Return),
            SlotStatement::Assert(condition, message) => {
                if self.term(frame, condition)? == 0.0 {
                    let function = frame.function.name.clone();
                    return Err(CallFailure::Assert { function, message: message.clone() });
                }
            }
        }
        Ok(ExecutionFlow::Next)
    }

    /// Executes a `for` loop over the range `from`, `step`, `to`.
    /// The bounds are evaluated once. `break` in the body ends the loop only.
    fn count(
        &mut self,
        frame: &mut StackFrame<'a>,
        slot: u32,
        range: [&'a SlotExpr; 3],
        body: &'a [SlotStatement],
    ) -> Result<ExecutionFlow, CallFailure> {
        let from = self.term(frame, range[0])?;
        let step = self.term(frame, range[1])?;
        let to = self.term(frame, range[2])?;
        // The tolerance makes 0:0.1:1 have eleven values in spite of rounding.
        let last = ((to - from) / step + 1e-10).floor();
        let mut turn = 0.0;
        while turn <= last {
            self.step(frame)?;
            // Computed from the number of the turn, so that rounding errors do not add up.
            frame.slots[slot as usize] = from + turn * step;
            match self.statements(frame, body)? {
                ExecutionFlow::Next => {}
                ExecutionFlow::Break => break,
                ExecutionFlow::Return => return Ok(ExecutionFlow::Return),
            }
            turn += 1.0;
        }
        Ok(ExecutionFlow::Next)
    }

    /// Executes a `while` loop.
    /// The condition is evaluated before each turn.
    fn repeat(
        &mut self,
        frame: &mut StackFrame<'a>,
        condition: &'a SlotExpr,
        body: &'a [SlotStatement],
    ) -> Result<ExecutionFlow, CallFailure> {
        while self.term(frame, condition)? != 0.0 {
            self.step(frame)?;
            match self.statements(frame, body)? {
                ExecutionFlow::Next => {}
                ExecutionFlow::Break => break,
                ExecutionFlow::Return => return Ok(ExecutionFlow::Return),
            }
        }
        Ok(ExecutionFlow::Next)
    }

    /// The function of an id.
    /// The id must be one of the pool from which `all` comes.
    fn function(&self, id: FunctionId) -> &'a Function {
        &self.all[id.0 as usize]
    }

    /// The values of several expressions, in order.
    fn terms(&mut self, frame: &StackFrame<'a>, terms: &'a [SlotExpr]) -> Result<Vec<f64>, CallFailure> {
        terms.iter().map(|term| self.term(frame, term)).collect()
    }

    /// The value of an expression.
    /// Operands are evaluated from left to right; of an `if` only the branch that is taken.
    fn term(&mut self, frame: &StackFrame<'a>, term: &'a SlotExpr) -> Result<f64, CallFailure> {
        Ok(match term {
            SlotExpr::Num(value) => *value,
            SlotExpr::Slot(slot) => frame.slots[*slot as usize],
            SlotExpr::At { base, len, offset } => {
                let at = self.element(frame, *base, *len, offset)?;
                frame.slots[at]
            }
            SlotExpr::Unary(op, a) => math::unary(*op, self.term(frame, a)?),
            SlotExpr::Binary(op, a, b) => {
                let a = self.term(frame, a)?;
                math::binary(*op, a, self.term(frame, b)?)
            }
            SlotExpr::Rel(rel, a, b) => {
                let a = self.term(frame, a)?;
                math::truth(math::holds(*rel, a, self.term(frame, b)?))
            }
            SlotExpr::If(c, a, b) => {
                let branch = if self.term(frame, c)? == 0.0 { b } else { a };
                self.term(frame, branch)?
            }
            SlotExpr::Call(function, output, args) => {
                self.step(frame)?;
                let args = self.terms(frame, args)?;
                let mut found = f64::NAN;
                self.call(self.function(*function), args, |number, value| {
                    if number == *output as usize {
                        found = value;
                    }
                })?;
                found
            }
            SlotExpr::External(function, output, args) => {
                self.step(frame)?;
                function.0.value(*output as usize, &self.terms(frame, args)?)
            }
        })
    }

    /// The slot of an element of an array.
    ///
    /// # Errors
    /// The offset is not in `0..len`. NaN is not either.
    /// `base` and `len` are the slots of the array.
    fn element(
        &mut self,
        frame: &StackFrame<'a>,
        base: u32,
        len: u32,
        offset: &'a SlotExpr,
    ) -> Result<usize, CallFailure> {
        let offset = self.term(frame, offset)?;
        if offset >= 0.0 && offset < f64::from(len) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and a u32")]
            let whole = offset as usize;
            return Ok(base as usize + whole);
        }
        Err(CallFailure::Index { function: frame.function.name.clone(), offset, len })
    }
}

#[cfg(test)]
#[path = "interpret_tests.rs"]
mod tests;
