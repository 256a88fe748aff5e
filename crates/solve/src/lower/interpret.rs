//! Register bytecode over the array of values.
//!
//! It is the reference for machine code, and it runs what is not worth compiling. [`KernelCode`] enters; [`Bytecode`]
//! leaves it. Every operand is a place in the array of values: a slot, the slot of a number, or a place in the scratch
//! region at the end of the array. Scratch places carry the mark [`SCRATCH`] until [`Bytecode::relocate`] knows where
//! that region begins.

use super::code::{CodeBranch, CodeStep, KernelCode, RegisterOperand};
use super::layout::{ValueLayout, ValueSlot, slot};
use bramah_expr::function::Function;
use bramah_expr::{BinaryFunction, FunctionId, RelationalOp, UnaryFunction, math};

/// Marks a place that is counted from the beginning of the scratch region.
pub const SCRATCH: ValueSlot = 1 << 31;

/// The operations. Operands `a`, `b`, `c` and the result `dst` are places, if not stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum BytecodeOperation {
    /// `dst = a`
    Move,
    /// `dst` = the number with the low bits `a` and the high bits `b`.
    Number,
    /// `dst = -a`
    Neg,
    /// `dst` = 1 when `a` is 0, else 0.
    Not,
    /// `dst = |a|`
    Abs,
    /// Square root of `a`.
    Sqrt,
    /// Largest integer not above `a`.
    Floor,
    /// -1, 0 or 1.
    Sign,
    /// Exponential function of `a`.
    Exp,
    /// Natural logarithm of `a`.
    Log,
    /// Logarithm of `a` to base 10.
    Log10,
    /// Sine of `a` in radians.
    Sin,
    /// Cosine of `a` in radians.
    Cos,
    /// Tangent of `a` in radians.
    Tan,
    /// Arc sine in radians.
    Asin,
    /// Arc cosine in radians.
    Acos,
    /// Arc tangent in radians.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// `dst = a + b`; the following operations have two operands.
    Add,
    /// `dst = a - b`
    Sub,
    /// `dst = a b`
    Mul,
    /// `dst = a / b`
    Div,
    /// `a` to the power `b`.
    Pow,
    /// Angle of the point with x = `b` and y = `a`.
    Atan2,
    /// The smaller operand.
    Min,
    /// The larger operand.
    Max,
    /// 1 when both operands are not 0, else 0.
    And,
    /// 1 when an operand is not 0, else 0.
    Or,
    /// 1 when `a < b`, else 0; the following relations are of the same kind.
    Lt,
    /// 1 when `a <= b`.
    Le,
    /// 1 when `a > b`.
    Gt,
    /// 1 when `a >= b`.
    Ge,
    /// 1 when `a = b`.
    Eq,
    /// 1 when `a <> b`.
    Ne,
    /// `dst = if c <> 0 then a else b`
    Select,
    /// Continues at instruction `b`.
    Jump,
    /// Continues at instruction `b` when `a` is 0.
    JumpIfZero,
    /// Calls the user function of call site `a`.
    Call,
}

/// One instruction.
#[derive(Clone, Copy, Debug)]
struct BytecodeInstruction {
    /// What is computed.
    op: BytecodeOperation,
    /// Place of the result.
    dst: ValueSlot,
    /// First operand.
    a: ValueSlot,
    /// Second operand.
    b: ValueSlot,
    /// Third operand.
    c: ValueSlot,
}

/// A call of a user function.
#[derive(Clone, Debug)]
struct CallSite {
    /// The function.
    function: FunctionId,
    /// Places of the arguments.
    args: Vec<ValueSlot>,
    /// For each output that is used its number and its place.
    outputs: Vec<(u32, ValueSlot)>,
}

/// Instructions that compute one kernel or one piece of straight code.
#[derive(Clone, Debug, Default)]
pub struct Bytecode {
    /// The instructions in order.
    instructions: Vec<BytecodeInstruction>,
    /// The call sites of user functions.
    calls: Vec<CallSite>,
    /// Number of scratch places needed.
    scratch: u32,
}

impl Bytecode {
    /// Code whose inputs are slots, and whose outputs go to the slots in `targets`.
    pub fn straight(code: &KernelCode, targets: &[ValueSlot], layout: &ValueLayout) -> Bytecode {
        let mut writer = BytecodeWriter::new(code, layout, 0, |input| input);
        // writing an output early is wrong where a later instruction still reads the old value of its slot
        if !writer.reads_any(code, targets) {
            writer.write_in_place(code, targets);
        }
        writer.finish(code, targets)
    }

    /// Code whose input `i` is at scratch place `i`, and whose output `k` goes to scratch place `inputs + k`.
    pub fn looped(code: &KernelCode, inputs: u32, layout: &ValueLayout) -> Bytecode {
        let targets: Vec<ValueSlot> = (inputs..).take(code.outputs.len()).map(|place| SCRATCH | place).collect();
        let mut writer = BytecodeWriter::new(code, layout, inputs + slot(targets.len()), |input| SCRATCH | input);
        writer.write_in_place(code, &targets);
        writer.finish(code, &targets)
    }

    /// Number of instructions.
    pub fn len(&self) -> usize {
        self.instructions.len()
    }

    /// Number of scratch places needed.
    pub fn scratch(&self) -> u32 {
        self.scratch
    }

    /// Replaces marked places by slots, with the scratch region beginning at `base`.
    pub fn relocate(&mut self, base: ValueSlot) {
        let fix = |place: &mut ValueSlot| {
            if *place & SCRATCH != 0 {
                *place = (*place & !SCRATCH) + base;
            }
        };
        for i in &mut self.instructions {
            fix(&mut i.dst);
            match i.op {
                // their operands are bits, instructions and call sites, not places
                BytecodeOperation::Number | BytecodeOperation::Jump | BytecodeOperation::Call => {}
                BytecodeOperation::JumpIfZero => fix(&mut i.a),
                _ => [&mut i.a, &mut i.b, &mut i.c].into_iter().for_each(fix),
            }
        }
        for call in &mut self.calls {
            call.args.iter_mut().for_each(fix);
            call.outputs.iter_mut().for_each(|(_, place)| fix(place));
        }
    }

    /// Runs the code once.
    pub fn run(&self, functions: &[Function], v: &mut [f64]) {
        let code = &self.instructions[..];
        let mut pc = 0;
        while let Some(i) = code.get(pc) {
            pc += 1;
            let (a, b) = (i.a as usize, i.b as usize);
            let value = match i.op {
                BytecodeOperation::Move => v[a],
                BytecodeOperation::Number => f64::from_bits(u64::from(i.b) << 32 | u64::from(i.a)),
                BytecodeOperation::Neg => -v[a],
                BytecodeOperation::Not => math::truth(v[a] == 0.0),
                BytecodeOperation::Abs => v[a].abs(),
                BytecodeOperation::Sqrt => v[a].sqrt(),
                BytecodeOperation::Floor => math::floor(v[a]),
                BytecodeOperation::Sign => math::sign(v[a]),
                BytecodeOperation::Exp => math::exp(v[a]),
                BytecodeOperation::Log => math::log(v[a]),
                BytecodeOperation::Log10 => math::log10(v[a]),
                BytecodeOperation::Sin => math::sin(v[a]),
                BytecodeOperation::Cos => math::cos(v[a]),
                BytecodeOperation::Tan => math::tan(v[a]),
                BytecodeOperation::Asin => math::asin(v[a]),
                BytecodeOperation::Acos => math::acos(v[a]),
                BytecodeOperation::Atan => math::atan(v[a]),
                BytecodeOperation::Sinh => math::sinh(v[a]),
                BytecodeOperation::Cosh => math::cosh(v[a]),
                BytecodeOperation::Tanh => math::tanh(v[a]),
                BytecodeOperation::Add => v[a] + v[b],
                BytecodeOperation::Sub => v[a] - v[b],
                BytecodeOperation::Mul => v[a] * v[b],
                BytecodeOperation::Div => v[a] / v[b],
                BytecodeOperation::Pow => math::pow(v[a], v[b]),
                BytecodeOperation::Atan2 => math::atan2(v[a], v[b]),
                BytecodeOperation::Min => math::min(v[a], v[b]),
                BytecodeOperation::Max => math::max(v[a], v[b]),
                BytecodeOperation::And => math::truth(v[a] != 0.0 && v[b] != 0.0),
                BytecodeOperation::Or => math::truth(v[a] != 0.0 || v[b] != 0.0),
                BytecodeOperation::Lt => math::truth(v[a] < v[b]),
                BytecodeOperation::Le => math::truth(v[a] <= v[b]),
                BytecodeOperation::Gt => math::truth(v[a] > v[b]),
                BytecodeOperation::Ge => math::truth(v[a] >= v[b]),
                BytecodeOperation::Eq => math::truth(v[a] == v[b]),
                BytecodeOperation::Ne => math::truth(v[a] != v[b]),
                BytecodeOperation::Select => v[if v[i.c as usize] == 0.0 { b } else { a }],
                BytecodeOperation::Jump => {
                    pc = b;
                    continue;
                }
                BytecodeOperation::JumpIfZero => {
                    if v[a] == 0.0 {
                        pc = b;
                    }
                    continue;
                }
                BytecodeOperation::Call => {
                    self.calls[a].run(functions, v);
                    continue;
                }
            };
            v[i.dst as usize] = value;
        }
    }
}

impl CallSite {
    /// Calls the function with its arguments and stores the outputs that are used.
    fn run(&self, functions: &[Function], v: &mut [f64]) {
        let args: Vec<f64> = self.args.iter().map(|&arg| v[arg as usize]).collect();
        let function = &functions[self.function.0 as usize];
        // an output that the function does not set stays NaN, which the solver detects
        let mut out = vec![f64::NAN; function.outputs.len()];
        function.call(functions, &args, &mut out);
        for &(output, place) in &self.outputs {
            v[place as usize] = out[output as usize];
        }
    }
}

/// Writes the instructions of one kernel.
struct BytecodeWriter<'a, F> {
    /// The slots of the model, for constants.
    layout: &'a ValueLayout,
    /// The place of each input.
    input: F,
    /// The place of each register.
    places: Vec<ValueSlot>,
    /// The code so far.
    bytecode: Bytecode,
}

impl<'a, F: Fn(u32) -> ValueSlot> BytecodeWriter<'a, F> {
    /// Gives each register a scratch place of its own.
    fn new(code: &KernelCode, layout: &'a ValueLayout, first_register: u32, input: F) -> Self {
        let places = (first_register..).take(code.registers as usize).map(|place| SCRATCH | place).collect();
        let scratch = first_register + code.registers;
        BytecodeWriter { layout, input, places, bytecode: Bytecode { scratch, ..Bytecode::default() } }
    }

    /// Writes all steps, and the moves of outputs that are not in place.
    fn finish(mut self, code: &KernelCode, targets: &[ValueSlot]) -> Bytecode {
        self.steps(&code.steps);
        for (&output, &target) in code.outputs.iter().zip(targets) {
            let from = self.place(output);
            self.copy(from, target);
        }
        self.bytecode
    }

    /// Lets registers that are outputs live in the places of the outputs, which saves moves.
    fn write_in_place(&mut self, code: &KernelCode, targets: &[ValueSlot]) {
        for (&output, &target) in code.outputs.iter().zip(targets) {
            if let RegisterOperand::Register(r) = output
                && self.places[r as usize] & SCRATCH != 0
            {
                self.places[r as usize] = target;
            }
        }
    }

    /// Whether the code reads one of these slots.
    fn reads_any(&self, code: &KernelCode, targets: &[ValueSlot]) -> bool {
        let mut targets = targets.to_vec();
        targets.sort_unstable();
        let mut found = false;
        visit_operands(&code.steps, &mut |operand| {
            if let RegisterOperand::Input(input) = operand {
                found |= targets.binary_search(&(self.input)(input)).is_ok();
            }
        });
        found |= code.outputs.iter().any(|output| match *output {
            RegisterOperand::Input(input) => targets.binary_search(&(self.input)(input)).is_ok(),
            _ => false,
        });
        found
    }

    /// Appends an instruction.
    fn push(&mut self, op: BytecodeOperation, dst: ValueSlot, [a, b, c]: [ValueSlot; 3]) {
        self.bytecode.instructions.push(BytecodeInstruction { op, dst, a, b, c });
    }

    /// Appends a move, if the places differ.
    fn copy(&mut self, from: ValueSlot, to: ValueSlot) {
        if from != to {
            self.push(BytecodeOperation::Move, to, [from; 3]);
        }
    }

    /// The place of an operand.
    fn place(&mut self, operand: RegisterOperand) -> ValueSlot {
        match operand {
            RegisterOperand::Input(input) => (self.input)(input),
            RegisterOperand::Register(r) => self.places[r as usize],
            RegisterOperand::Number(bits) => self.layout.known_number(bits).unwrap_or_else(|| self.number(bits)),
        }
    }

    /// The place of a number that has no slot. It is written into a scratch place by an instruction.
    fn number(&mut self, bits: u64) -> ValueSlot {
        let place = SCRATCH | self.bytecode.scratch;
        self.bytecode.scratch += 1;
        #[allow(clippy::cast_possible_truncation, reason = "the two halves")]
        self.push(BytecodeOperation::Number, place, [bits as u32, (bits >> 32) as u32, 0]);
        place
    }

    /// Writes steps in order.
    fn steps(&mut self, steps: &[CodeStep]) {
        for step in steps {
            self.step(step);
        }
    }

    /// Writes one step.
    fn step(&mut self, step: &CodeStep) {
        match step {
            &CodeStep::Unary(op, dst, a) => {
                let a = self.place(a);
                self.push(unary(op), self.places[dst as usize], [a; 3]);
            }
            &CodeStep::Binary(op, dst, a, b) => {
                let (a, b) = (self.place(a), self.place(b));
                self.push(binary(op), self.places[dst as usize], [a, b, a]);
            }
            &CodeStep::Rel(rel, dst, a, b) => {
                let (a, b) = (self.place(a), self.place(b));
                self.push(relation(rel), self.places[dst as usize], [a, b, a]);
            }
            &CodeStep::Select { dst, c, a, b } => {
                let places = [self.place(a), self.place(b), self.place(c)];
                self.push(BytecodeOperation::Select, self.places[dst as usize], places);
            }
            CodeStep::Branch { dst, c, then, otherwise } => {
                self.branch(self.places[*dst as usize], *c, then, otherwise)
            }
            CodeStep::Call { function, args, outputs } => {
                let args = args.iter().map(|&arg| self.place(arg)).collect();
                let outputs = outputs.iter().map(|&(output, dst)| (output, self.places[dst as usize])).collect();
                let site = slot(self.bytecode.calls.len());
                self.bytecode.calls.push(CallSite { function: *function, args, outputs });
                self.push(BytecodeOperation::Call, 0, [site; 3]);
            }
        }
    }

    /// Writes an `if` with jumps over the side that is not chosen. The targets of jumps are filled in afterwards.
    fn branch(&mut self, dst: ValueSlot, c: RegisterOperand, then: &CodeBranch, otherwise: &CodeBranch) {
        let c = self.place(c);
        let over_then = self.bytecode.instructions.len();
        self.push(BytecodeOperation::JumpIfZero, 0, [c; 3]);
        self.side(then, dst);
        let over_otherwise = self.bytecode.instructions.len();
        self.push(BytecodeOperation::Jump, 0, [0; 3]);
        self.bytecode.instructions[over_then].b = slot(self.bytecode.instructions.len());
        self.side(otherwise, dst);
        self.bytecode.instructions[over_otherwise].b = slot(self.bytecode.instructions.len());
    }

    /// Writes one side of a branch.
    fn side(&mut self, side: &CodeBranch, dst: ValueSlot) {
        self.steps(&side.steps);
        let value = self.place(side.value.expect("a finished branch has a value"));
        self.copy(value, dst);
    }
}

/// Calls `visit` for every operand of the steps, in branches too.
pub fn visit_operands(steps: &[CodeStep], visit: &mut impl FnMut(RegisterOperand)) {
    for step in steps {
        match step {
            &CodeStep::Unary(_, _, a) => visit(a),
            &CodeStep::Binary(_, _, a, b) | &CodeStep::Rel(_, _, a, b) => [a, b].into_iter().for_each(&mut *visit),
            &CodeStep::Select { c, a, b, .. } => [c, a, b].into_iter().for_each(&mut *visit),
            CodeStep::Branch { c, then, otherwise, .. } => {
                visit(*c);
                for side in [then, otherwise] {
                    visit_operands(&side.steps, visit);
                    side.value.into_iter().for_each(&mut *visit);
                }
            }
            CodeStep::Call { args, .. } => args.iter().copied().for_each(&mut *visit),
        }
    }
}

/// The operation of a function of one argument.
fn unary(op: UnaryFunction) -> BytecodeOperation {
    match op {
        UnaryFunction::Neg => BytecodeOperation::Neg,
        UnaryFunction::Not => BytecodeOperation::Not,
        UnaryFunction::Abs => BytecodeOperation::Abs,
        UnaryFunction::Sign => BytecodeOperation::Sign,
        UnaryFunction::Sqrt => BytecodeOperation::Sqrt,
        UnaryFunction::Exp => BytecodeOperation::Exp,
        UnaryFunction::Log => BytecodeOperation::Log,
        UnaryFunction::Log10 => BytecodeOperation::Log10,
        UnaryFunction::Sin => BytecodeOperation::Sin,
        UnaryFunction::Cos => BytecodeOperation::Cos,
        UnaryFunction::Tan => BytecodeOperation::Tan,
        UnaryFunction::Asin => BytecodeOperation::Asin,
        UnaryFunction::Acos => BytecodeOperation::Acos,
        UnaryFunction::Atan => BytecodeOperation::Atan,
        UnaryFunction::Sinh => BytecodeOperation::Sinh,
        UnaryFunction::Cosh => BytecodeOperation::Cosh,
        UnaryFunction::Tanh => BytecodeOperation::Tanh,
        UnaryFunction::Floor => BytecodeOperation::Floor,
    }
}

/// The operation of a function of two arguments.
fn binary(op: BinaryFunction) -> BytecodeOperation {
    match op {
        BinaryFunction::Add => BytecodeOperation::Add,
        BinaryFunction::Sub => BytecodeOperation::Sub,
        BinaryFunction::Mul => BytecodeOperation::Mul,
        BinaryFunction::Div => BytecodeOperation::Div,
        BinaryFunction::Pow => BytecodeOperation::Pow,
        BinaryFunction::Atan2 => BytecodeOperation::Atan2,
        BinaryFunction::Min => BytecodeOperation::Min,
        BinaryFunction::Max => BytecodeOperation::Max,
        BinaryFunction::And => BytecodeOperation::And,
        BinaryFunction::Or => BytecodeOperation::Or,
    }
}

/// The operation of a relation.
fn relation(rel: RelationalOp) -> BytecodeOperation {
    match rel {
        RelationalOp::Lt => BytecodeOperation::Lt,
        RelationalOp::Le => BytecodeOperation::Le,
        RelationalOp::Gt => BytecodeOperation::Gt,
        RelationalOp::Ge => BytecodeOperation::Ge,
        RelationalOp::Eq => BytecodeOperation::Eq,
        RelationalOp::Ne => BytecodeOperation::Ne,
    }
}
