//! Running a [`Function`]: the reference that native code is compared with.
//!
//! Slots start as 0. A call that goes on for too long, nests too deeply, leaves an array or fails an `assert` ends at
//! once; its outputs are then NaN, so that the solver treats the point as one where the model has no value.

use super::function::{Function, SlotExpr, SlotStatement};
use super::{FunctionId, math};

/// Statements and loop turns that one outermost call may take, calls inside it included.
pub const STEP_BUDGET: u64 = 10_000_000;

/// How deeply functions may call each other.
pub const DEPTH_LIMIT: u32 = 200;

/// Why a call has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum CallFailure {
    /// More than [`STEP_BUDGET`] steps.
    Steps {
        /// The function that ran when the budget was used up.
        function: String,
    },
    /// More than [`DEPTH_LIMIT`] calls inside each other.
    Depth {
        /// The function that was called once too often.
        function: String,
    },
    /// An index outside its array.
    Index {
        /// The function.
        function: String,
        /// The zero-based row-major offset.
        offset: f64,
        /// The number of elements.
        len: u32,
    },
    /// A failed `assert`.
    Assert {
        /// The function.
        function: String,
        /// Its message.
        message: String,
    },
}

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
    /// The outputs for these inputs; all NaN when the call fails. `all` is the pool's list of functions, `args` has
    /// `inputs` values, `out` as many as there are outputs.
    pub fn call(&self, all: &[Function], args: &[f64], out: &mut [f64]) {
        if self.try_call(all, args, out).is_err() {
            out.fill(f64::NAN);
        }
    }

    /// As [`Function::call`], with the reason when there is no value; `out` is then not written.
    pub fn try_call(&self, all: &[Function], args: &[f64], out: &mut [f64]) -> Result<(), CallFailure> {
        Interpreter { all, left: STEP_BUDGET, depth: 0 }.call(self, args.to_vec(), |output, value| out[output] = value)
    }
}

/// What ended a list of statements.
enum ExecutionFlow {
    Next,
    Break,
    Return,
}

/// One outermost call.
struct Interpreter<'a> {
    all: &'a [Function],
    left: u64,
    depth: u32,
}

/// One running function.
struct StackFrame<'a> {
    function: &'a Function,
    slots: Vec<f64>,
}

impl<'a> Interpreter<'a> {
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
        args.resize(function.slots as usize, 0.0);
        let mut frame = StackFrame { function, slots: args };
        self.statements(&mut frame, &function.body)?;
        for (output, &slot) in function.outputs.iter().enumerate() {
            result(output, frame.slots[slot as usize]);
        }
        self.depth -= 1;
        Ok(())
    }

    fn step(&mut self, frame: &StackFrame) -> Result<(), CallFailure> {
        if self.left == 0 {
            return Err(CallFailure::Steps { function: frame.function.name.clone() });
        }
        self.left -= 1;
        Ok(())
    }

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

    fn statement(&mut self, frame: &mut StackFrame<'a>, stmt: &'a SlotStatement) -> Result<ExecutionFlow, CallFailure> {
        match stmt {
            SlotStatement::Assign(slot, value) => frame.slots[*slot as usize] = self.term(frame, value)?,
            SlotStatement::AssignAt { base, len, offset, value } => {
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
        // A little more than the quotient, so that 0:0.1:1 has eleven values.
        let last = ((to - from) / step + 1e-10).floor();
        let mut turn = 0.0;
        while turn <= last {
            self.step(frame)?;
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

    fn function(&self, id: FunctionId) -> &'a Function {
        &self.all[id.0 as usize]
    }

    fn terms(&mut self, frame: &StackFrame<'a>, terms: &'a [SlotExpr]) -> Result<Vec<f64>, CallFailure> {
        terms.iter().map(|term| self.term(frame, term)).collect()
    }

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
