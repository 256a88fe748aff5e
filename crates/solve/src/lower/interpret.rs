//! Register bytecode over the array of values: the reference for machine code, and what runs where compiling would
//! cost more than it saves.
//!
//! Every operand is a place in the array of values: a slot, the slot of a number, or a place in the scratch region at
//! the array's end. Scratch places carry [`SCRATCH`] until [`Bytecode::relocate`] knows where that region begins.

use super::code::{Branch, Code, Operand, Step};
use super::layout::{Layout, Slot, slot};
use bramah_expr::function::Function;
use bramah_expr::{Binary, FunctionId, Rel, Unary, math};

/// Marks a place counted from the beginning of the scratch region.
pub const SCRATCH: Slot = 1 << 31;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Op {
    Move,
    /// The bits of a number in `a` (low) and `b` (high).
    Number,
    Neg,
    Not,
    Abs,
    Sqrt,
    Floor,
    Sign,
    Exp,
    Log,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Atan2,
    Min,
    Max,
    And,
    Or,
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
    /// `if c <> 0 then a else b`
    Select,
    /// Go on at instruction `b`.
    Jump,
    /// Go on at instruction `b` when `a` is 0.
    JumpIfZero,
    /// The call site `a`.
    Call,
}

#[derive(Clone, Copy, Debug)]
struct Instruction {
    op: Op,
    dst: Slot,
    a: Slot,
    b: Slot,
    c: Slot,
}

#[derive(Clone, Debug)]
struct CallSite {
    function: FunctionId,
    args: Vec<Slot>,
    outputs: Vec<(u32, Slot)>,
}

/// Instructions that compute one kernel.
#[derive(Clone, Debug, Default)]
pub struct Bytecode {
    instructions: Vec<Instruction>,
    calls: Vec<CallSite>,
    scratch: u32,
}

impl Bytecode {
    /// Code whose inputs are slots, each output going to the slot in `targets`.
    pub fn straight(code: &Code, targets: &[Slot], layout: &Layout) -> Bytecode {
        let mut writer = Writer::new(code, layout, 0, |input| input);
        if !writer.reads_any(code, targets) {
            writer.write_in_place(code, targets);
        }
        writer.finish(code, targets)
    }

    /// Code whose input number `i` is at scratch place `i`, and whose output number `k` goes to scratch place
    /// `inputs + k`.
    pub fn looped(code: &Code, inputs: u32, layout: &Layout) -> Bytecode {
        let targets: Vec<Slot> = (inputs..).take(code.outputs.len()).map(|place| SCRATCH | place).collect();
        let mut writer = Writer::new(code, layout, inputs + slot(targets.len()), |input| SCRATCH | input);
        writer.write_in_place(code, &targets);
        writer.finish(code, &targets)
    }

    /// Number of instructions.
    pub fn len(&self) -> usize {
        self.instructions.len()
    }

    /// How many scratch places the code needs.
    pub fn scratch(&self) -> u32 {
        self.scratch
    }

    /// Tells where the scratch region begins.
    pub fn relocate(&mut self, base: Slot) {
        let fix = |place: &mut Slot| {
            if *place & SCRATCH != 0 {
                *place = (*place & !SCRATCH) + base;
            }
        };
        for i in &mut self.instructions {
            fix(&mut i.dst);
            match i.op {
                Op::Number | Op::Jump | Op::Call => {}
                Op::JumpIfZero => fix(&mut i.a),
                _ => [&mut i.a, &mut i.b, &mut i.c].into_iter().for_each(fix),
            }
        }
        for call in &mut self.calls {
            call.args.iter_mut().for_each(fix);
            call.outputs.iter_mut().for_each(|(_, place)| fix(place));
        }
    }

    /// Runs once.
    pub fn run(&self, functions: &[Function], v: &mut [f64]) {
        let code = &self.instructions[..];
        let mut pc = 0;
        while let Some(i) = code.get(pc) {
            pc += 1;
            let (a, b) = (i.a as usize, i.b as usize);
            let value = match i.op {
                Op::Move => v[a],
                Op::Number => f64::from_bits(u64::from(i.b) << 32 | u64::from(i.a)),
                Op::Neg => -v[a],
                Op::Not => math::truth(v[a] == 0.0),
                Op::Abs => v[a].abs(),
                Op::Sqrt => v[a].sqrt(),
                Op::Floor => math::floor(v[a]),
                Op::Sign => math::sign(v[a]),
                Op::Exp => math::exp(v[a]),
                Op::Log => math::log(v[a]),
                Op::Log10 => math::log10(v[a]),
                Op::Sin => math::sin(v[a]),
                Op::Cos => math::cos(v[a]),
                Op::Tan => math::tan(v[a]),
                Op::Asin => math::asin(v[a]),
                Op::Acos => math::acos(v[a]),
                Op::Atan => math::atan(v[a]),
                Op::Sinh => math::sinh(v[a]),
                Op::Cosh => math::cosh(v[a]),
                Op::Tanh => math::tanh(v[a]),
                Op::Add => v[a] + v[b],
                Op::Sub => v[a] - v[b],
                Op::Mul => v[a] * v[b],
                Op::Div => v[a] / v[b],
                Op::Pow => math::pow(v[a], v[b]),
                Op::Atan2 => math::atan2(v[a], v[b]),
                Op::Min => math::min(v[a], v[b]),
                Op::Max => math::max(v[a], v[b]),
                Op::And => math::truth(v[a] != 0.0 && v[b] != 0.0),
                Op::Or => math::truth(v[a] != 0.0 || v[b] != 0.0),
                Op::Lt => math::truth(v[a] < v[b]),
                Op::Le => math::truth(v[a] <= v[b]),
                Op::Gt => math::truth(v[a] > v[b]),
                Op::Ge => math::truth(v[a] >= v[b]),
                Op::Eq => math::truth(v[a] == v[b]),
                Op::Ne => math::truth(v[a] != v[b]),
                Op::Select => v[if v[i.c as usize] == 0.0 { b } else { a }],
                Op::Jump => {
                    pc = b;
                    continue;
                }
                Op::JumpIfZero => {
                    if v[a] == 0.0 {
                        pc = b;
                    }
                    continue;
                }
                Op::Call => {
                    self.calls[a].run(functions, v);
                    continue;
                }
            };
            v[i.dst as usize] = value;
        }
    }
}

impl CallSite {
    fn run(&self, functions: &[Function], v: &mut [f64]) {
        let args: Vec<f64> = self.args.iter().map(|&arg| v[arg as usize]).collect();
        let function = &functions[self.function.0 as usize];
        let mut out = vec![f64::NAN; function.outputs.len()];
        function.call(functions, &args, &mut out);
        for &(output, place) in &self.outputs {
            v[place as usize] = out[output as usize];
        }
    }
}

/// Writes the instructions of one kernel.
struct Writer<'a, F> {
    layout: &'a Layout,
    input: F,
    /// Where each register lives.
    places: Vec<Slot>,
    bytecode: Bytecode,
}

impl<'a, F: Fn(u32) -> Slot> Writer<'a, F> {
    fn new(code: &Code, layout: &'a Layout, first_register: u32, input: F) -> Self {
        let places = (first_register..).take(code.registers as usize).map(|place| SCRATCH | place).collect();
        let scratch = first_register + code.registers;
        Writer { layout, input, places, bytecode: Bytecode { scratch, ..Bytecode::default() } }
    }

    fn finish(mut self, code: &Code, targets: &[Slot]) -> Bytecode {
        self.steps(&code.steps);
        for (&output, &target) in code.outputs.iter().zip(targets) {
            let from = self.place(output);
            self.copy(from, target);
        }
        self.bytecode
    }

    /// Lets registers that are outputs live where the outputs go.
    fn write_in_place(&mut self, code: &Code, targets: &[Slot]) {
        for (&output, &target) in code.outputs.iter().zip(targets) {
            if let Operand::Register(r) = output
                && self.places[r as usize] & SCRATCH != 0
            {
                self.places[r as usize] = target;
            }
        }
    }

    /// Whether the code reads one of these slots, so that writing early would change what is read later.
    fn reads_any(&self, code: &Code, targets: &[Slot]) -> bool {
        let mut targets = targets.to_vec();
        targets.sort_unstable();
        let mut found = false;
        visit_operands(&code.steps, &mut |operand| {
            if let Operand::Input(input) = operand {
                found |= targets.binary_search(&(self.input)(input)).is_ok();
            }
        });
        found |= code.outputs.iter().any(|output| match *output {
            Operand::Input(input) => targets.binary_search(&(self.input)(input)).is_ok(),
            _ => false,
        });
        found
    }

    fn push(&mut self, op: Op, dst: Slot, [a, b, c]: [Slot; 3]) {
        self.bytecode.instructions.push(Instruction { op, dst, a, b, c });
    }

    fn copy(&mut self, from: Slot, to: Slot) {
        if from != to {
            self.push(Op::Move, to, [from; 3]);
        }
    }

    fn place(&mut self, operand: Operand) -> Slot {
        match operand {
            Operand::Input(input) => (self.input)(input),
            Operand::Register(r) => self.places[r as usize],
            Operand::Number(bits) => self.layout.known_number(bits).unwrap_or_else(|| self.number(bits)),
        }
    }

    /// A number that came up after the slots were given out.
    fn number(&mut self, bits: u64) -> Slot {
        let place = SCRATCH | self.bytecode.scratch;
        self.bytecode.scratch += 1;
        #[allow(clippy::cast_possible_truncation, reason = "the two halves")]
        self.push(Op::Number, place, [bits as u32, (bits >> 32) as u32, 0]);
        place
    }

    fn steps(&mut self, steps: &[Step]) {
        for step in steps {
            self.step(step);
        }
    }

    fn step(&mut self, step: &Step) {
        match step {
            &Step::Unary(op, dst, a) => {
                let a = self.place(a);
                self.push(unary(op), self.places[dst as usize], [a; 3]);
            }
            &Step::Binary(op, dst, a, b) => {
                let (a, b) = (self.place(a), self.place(b));
                self.push(binary(op), self.places[dst as usize], [a, b, a]);
            }
            &Step::Rel(rel, dst, a, b) => {
                let (a, b) = (self.place(a), self.place(b));
                self.push(relation(rel), self.places[dst as usize], [a, b, a]);
            }
            &Step::Select { dst, c, a, b } => {
                let places = [self.place(a), self.place(b), self.place(c)];
                self.push(Op::Select, self.places[dst as usize], places);
            }
            Step::Branch { dst, c, then, otherwise } => self.branch(self.places[*dst as usize], *c, then, otherwise),
            Step::Call { function, args, outputs } => {
                let args = args.iter().map(|&arg| self.place(arg)).collect();
                let outputs = outputs.iter().map(|&(output, dst)| (output, self.places[dst as usize])).collect();
                let site = slot(self.bytecode.calls.len());
                self.bytecode.calls.push(CallSite { function: *function, args, outputs });
                self.push(Op::Call, 0, [site; 3]);
            }
        }
    }

    fn branch(&mut self, dst: Slot, c: Operand, then: &Branch, otherwise: &Branch) {
        let c = self.place(c);
        let over_then = self.bytecode.instructions.len();
        self.push(Op::JumpIfZero, 0, [c; 3]);
        self.side(then, dst);
        let over_otherwise = self.bytecode.instructions.len();
        self.push(Op::Jump, 0, [0; 3]);
        self.bytecode.instructions[over_then].b = slot(self.bytecode.instructions.len());
        self.side(otherwise, dst);
        self.bytecode.instructions[over_otherwise].b = slot(self.bytecode.instructions.len());
    }

    fn side(&mut self, side: &Branch, dst: Slot) {
        self.steps(&side.steps);
        let value = self.place(side.value.expect("a finished branch has a value"));
        self.copy(value, dst);
    }
}

/// Calls `visit` for every operand of the steps.
pub fn visit_operands(steps: &[Step], visit: &mut impl FnMut(Operand)) {
    for step in steps {
        match step {
            &Step::Unary(_, _, a) => visit(a),
            &Step::Binary(_, _, a, b) | &Step::Rel(_, _, a, b) => [a, b].into_iter().for_each(&mut *visit),
            &Step::Select { c, a, b, .. } => [c, a, b].into_iter().for_each(&mut *visit),
            Step::Branch { c, then, otherwise, .. } => {
                visit(*c);
                for side in [then, otherwise] {
                    visit_operands(&side.steps, visit);
                    side.value.into_iter().for_each(&mut *visit);
                }
            }
            Step::Call { args, .. } => args.iter().copied().for_each(&mut *visit),
        }
    }
}

fn unary(op: Unary) -> Op {
    match op {
        Unary::Neg => Op::Neg,
        Unary::Not => Op::Not,
        Unary::Abs => Op::Abs,
        Unary::Sign => Op::Sign,
        Unary::Sqrt => Op::Sqrt,
        Unary::Exp => Op::Exp,
        Unary::Log => Op::Log,
        Unary::Log10 => Op::Log10,
        Unary::Sin => Op::Sin,
        Unary::Cos => Op::Cos,
        Unary::Tan => Op::Tan,
        Unary::Asin => Op::Asin,
        Unary::Acos => Op::Acos,
        Unary::Atan => Op::Atan,
        Unary::Sinh => Op::Sinh,
        Unary::Cosh => Op::Cosh,
        Unary::Tanh => Op::Tanh,
        Unary::Floor => Op::Floor,
    }
}

fn binary(op: Binary) -> Op {
    match op {
        Binary::Add => Op::Add,
        Binary::Sub => Op::Sub,
        Binary::Mul => Op::Mul,
        Binary::Div => Op::Div,
        Binary::Pow => Op::Pow,
        Binary::Atan2 => Op::Atan2,
        Binary::Min => Op::Min,
        Binary::Max => Op::Max,
        Binary::And => Op::And,
        Binary::Or => Op::Or,
    }
}

fn relation(rel: Rel) -> Op {
    match rel {
        Rel::Lt => Op::Lt,
        Rel::Le => Op::Le,
        Rel::Gt => Op::Gt,
        Rel::Ge => Op::Ge,
        Rel::Eq => Op::Eq,
        Rel::Ne => Op::Ne,
    }
}
