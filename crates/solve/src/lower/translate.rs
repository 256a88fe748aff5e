//! Translation of kernel code into Cranelift instructions.
//!
//! `native` calls it for each function to be compiled. It must compute the same bits as `interpret`: the same
//! operations in the same order, no fused multiply-add, and the same functions of the C library.

use super::code::{CodeBranch, CodeStep, KernelCode, RegisterOperand};
use super::layout::ValueSlot;
use super::native::CALL_FUNCTION;
use bramah_expr::function::Function;
use bramah_expr::{BinaryFunction, RelationalOp, UnaryFunction};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::immediates::Offset32;
use cranelift_codegen::ir::types::{F64, I8, I32};
use cranelift_codegen::ir::{
    BlockArg, FuncRef, InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Type, Value,
};
use cranelift_frontend::FunctionBuilder;
use cranelift_jit::JITModule;
use cranelift_module::{FuncId, Module};
use rustc_hash::FxHashMap;

/// Writes the instructions of one function.
pub struct NativeTranslator<'a> {
    /// The function that is being written.
    pub builder: FunctionBuilder<'a>,
    /// The module that holds it.
    module: &'a mut JITModule,
    /// Functions outside the machine code, by name.
    imports: &'a FxHashMap<&'static str, FuncId>,
    /// The user's functions, for the number of their results.
    functions: &'a [Function],
    /// Imports that this function has declared.
    used: FxHashMap<&'static str, FuncRef>,
    /// The type of pointers.
    pointer: Type,
    /// Array of values, table of slots, number of rows, user functions.
    arguments: [Value; 4],
    /// The value of each register of the kernel code.
    registers: Vec<Value>,
    /// Registers that hold the result of a relation or logical operation, as an integer.
    truths: FxHashMap<u32, Value>,
    /// Inputs that are loaded already.
    inputs: FxHashMap<u32, Value>,
    /// Number of branches around the present place.
    depth: u32,
}

impl<'a> NativeTranslator<'a> {
    /// Starts a function of four pointer-sized arguments: values, table, number of rows, functions.
    pub fn new(
        mut builder: FunctionBuilder<'a>,
        module: &'a mut JITModule,
        imports: &'a FxHashMap<&'static str, FuncId>,
        functions: &'a [Function],
    ) -> Self {
        let pointer = module.target_config().pointer_type();
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let p = builder.block_params(block);
        let arguments = [p[0], p[1], p[2], p[3]];
        NativeTranslator {
            builder,
            module,
            imports,
            functions,
            used: FxHashMap::default(),
            pointer,
            arguments,
            registers: Vec::new(),
            truths: FxHashMap::default(),
            inputs: FxHashMap::default(),
            depth: 0,
        }
    }

    /// Writes code whose inputs are slots and whose outputs go to `targets`.
    pub fn straight(&mut self, code: &KernelCode, targets: &[ValueSlot]) {
        self.body(code);
        // all outputs are computed before the first one is stored, since a target may be an input too
        let outputs: Vec<Value> = code.outputs.iter().map(|&output| self.value(output)).collect();
        for (&value, &target) in outputs.iter().zip(targets) {
            let offset = slot_offset(target);
            self.builder.ins().store(MemFlagsData::trusted(), value, self.arguments[0], offset);
        }
        self.builder.ins().return_(&[]);
    }

    /// Writes `for row in table { load inputs; compute; store outputs }`.
    pub fn looped(&mut self, code: &KernelCode, inputs: u32) {
        let [_, table, rows, _] = self.arguments;
        // bytes of a row: one 32-bit slot per input and output
        let width = 4 * i64::from(inputs) + 4 * i64::try_from(code.outputs.len()).expect("a small number");
        let bytes = self.builder.ins().imul_imm_s(rows, width);
        let end = self.builder.ins().iadd(table, bytes);
        let (header, body, exit) =
            (self.builder.create_block(), self.builder.create_block(), self.builder.create_block());
        let row = self.builder.append_block_param(header, self.pointer);
        self.builder.ins().jump(header, &[BlockArg::Value(table)]);
        self.builder.switch_to_block(header);
        let more = self.builder.ins().icmp(IntCC::UnsignedLessThan, row, end);
        self.builder.ins().brif(more, body, &[], exit, &[]);
        self.builder.switch_to_block(body);
        self.builder.seal_block(body);
        self.row(code, inputs, row);
        let next = self.builder.ins().iadd_imm_s(row, width);
        self.builder.ins().jump(header, &[BlockArg::Value(next)]);
        self.builder.seal_block(header);
        self.builder.switch_to_block(exit);
        self.builder.seal_block(exit);
        self.builder.ins().return_(&[]);
    }

    /// Writes the body of the loop for the row at this address: loads its inputs, computes, and stores its outputs.
    fn row(&mut self, code: &KernelCode, inputs: u32, row: Value) {
        for input in 0..inputs {
            let address = self.address(row, input);
            let value = self.builder.ins().load(F64, MemFlagsData::trusted(), address, 0);
            self.inputs.insert(input, value);
        }
        self.body(code);
        for (k, &output) in (inputs..).zip(&code.outputs) {
            let value = self.value(output);
            let address = self.address(row, k);
            self.builder.ins().store(MemFlagsData::trusted(), value, address, 0);
        }
    }

    /// The address of the value whose slot stands in place `k` of the row.
    fn address(&mut self, row: Value, k: u32) -> Value {
        let offset = Offset32::new(4 * i32::try_from(k).expect("a small number"));
        let slot = self.builder.ins().uload32(MemFlagsData::trusted(), row, offset);
        let bytes = self.builder.ins().ishl_imm_u(slot, 3);
        self.builder.ins().iadd(self.arguments[0], bytes)
    }

    /// Writes all steps of the kernel.
    fn body(&mut self, code: &KernelCode) {
        let nothing = Value::from_u32(0);
        self.registers = vec![nothing; code.registers as usize];
        self.steps(&code.steps);
    }

    /// Writes steps in order.
    fn steps(&mut self, steps: &[CodeStep]) {
        for step in steps {
            self.step(step);
        }
    }

    /// Writes one step and assigns its register.
    fn step(&mut self, step: &CodeStep) {
        match step {
            &CodeStep::Unary(op, dst, a) => self.registers[dst as usize] = self.unary(op, dst, a),
            &CodeStep::Binary(op, dst, a, b) => self.registers[dst as usize] = self.binary(op, dst, a, b),
            &CodeStep::Rel(rel, dst, a, b) => {
                let (a, b) = (self.value(a), self.value(b));
                let truth = self.builder.ins().fcmp(relation(rel), a, b);
                self.registers[dst as usize] = self.as_number(dst, truth);
            }
            &CodeStep::Select { dst, c, a, b } => {
                let (c, a, b) = (self.truth(c), self.value(a), self.value(b));
                self.registers[dst as usize] = self.builder.ins().select(c, a, b);
            }
            CodeStep::Branch { dst, c, then, otherwise } => {
                self.registers[*dst as usize] = self.branch(*c, then, otherwise);
            }
            CodeStep::Call { function, args, outputs } => self.call(function.0, args, outputs),
        }
    }

    /// The value of an operand: a register, a constant, or an input that is loaded at its first use.
    fn value(&mut self, operand: RegisterOperand) -> Value {
        match operand {
            RegisterOperand::Register(r) => self.registers[r as usize],
            RegisterOperand::Number(bits) => self.builder.ins().f64const(f64::from_bits(bits)),
            RegisterOperand::Input(input) => match self.inputs.get(&input) {
                Some(&known) => known,
                None => self.load(input),
            },
        }
    }

    /// Loads a slot. Only loads outside all branches are remembered, because others may not have been executed.
    fn load(&mut self, input: u32) -> Value {
        let (values, offset) = (self.arguments[0], slot_offset(input));
        let value = self.builder.ins().load(F64, MemFlagsData::trusted(), values, offset);
        if self.depth == 0 {
            self.inputs.insert(input, value);
        }
        value
    }

    /// Whether a value is not 0, as an integer.
    ///
    /// Results of relations are known as integers already, which saves a comparison.
    fn truth(&mut self, operand: RegisterOperand) -> Value {
        if let RegisterOperand::Register(r) = operand
            && let Some(&known) = self.truths.get(&r)
        {
            return known;
        }
        let (value, zero) = (self.value(operand), self.builder.ins().f64const(0.0));
        self.builder.ins().fcmp(FloatCC::NotEqual, value, zero)
    }

    /// 1 or 0 as a floating-point number. The integer is remembered for later conditions.
    fn as_number(&mut self, dst: u32, truth: Value) -> Value {
        self.truths.insert(dst, truth);
        let (one, zero) = (self.builder.ins().f64const(1.0), self.builder.ins().f64const(0.0));
        self.builder.ins().select(truth, one, zero)
    }

    /// Writes a function of one argument.
    ///
    /// Negation, absolute value, square root, sign and `not` are instructions. All others call the function of the
    /// interpreter.
    fn unary(&mut self, op: UnaryFunction, dst: u32, a: RegisterOperand) -> Value {
        let name = match op {
            UnaryFunction::Not => return self.not(dst, a),
            UnaryFunction::Neg | UnaryFunction::Abs | UnaryFunction::Sqrt | UnaryFunction::Sign => "",
            UnaryFunction::Exp => "exp",
            UnaryFunction::Log => "log",
            UnaryFunction::Log10 => "log10",
            UnaryFunction::Sin => "sin",
            UnaryFunction::Cos => "cos",
            UnaryFunction::Tan => "tan",
            UnaryFunction::Asin => "asin",
            UnaryFunction::Acos => "acos",
            UnaryFunction::Atan => "atan",
            UnaryFunction::Sinh => "sinh",
            UnaryFunction::Cosh => "cosh",
            UnaryFunction::Tanh => "tanh",
            UnaryFunction::Floor => "floor",
        };
        let a = self.value(a);
        match op {
            UnaryFunction::Neg => self.builder.ins().fneg(a),
            UnaryFunction::Abs => self.builder.ins().fabs(a),
            UnaryFunction::Sqrt => self.builder.ins().sqrt(a),
            UnaryFunction::Sign => self.sign(a),
            _ => self.import(name, &[a]),
        }
    }

    /// Logical negation.
    fn not(&mut self, dst: u32, a: RegisterOperand) -> Value {
        let truth = self.truth(a);
        let one = self.builder.ins().iconst(I8, 1);
        let turned = self.builder.ins().bxor(truth, one);
        self.as_number(dst, turned)
    }

    /// The sign of a value: -1, 0 or 1, and NaN for NaN.
    fn sign(&mut self, a: Value) -> Value {
        let (zero, one) = (self.builder.ins().f64const(0.0), self.builder.ins().f64const(1.0));
        let minus = self.builder.ins().f64const(-1.0);
        // a + 0 is +0 for both zeros and stays NaN for NaN
        let rest = self.builder.ins().fadd(a, zero);
        let negative = self.builder.ins().fcmp(FloatCC::LessThan, a, zero);
        let positive = self.builder.ins().fcmp(FloatCC::GreaterThan, a, zero);
        let lower = self.builder.ins().select(negative, minus, rest);
        self.builder.ins().select(positive, one, lower)
    }

    /// Writes a function of two arguments. `Pow` and `Atan2` call the function of the interpreter.
    fn binary(&mut self, op: BinaryFunction, dst: u32, a: RegisterOperand, b: RegisterOperand) -> Value {
        if let BinaryFunction::And | BinaryFunction::Or = op {
            let (a, b) = (self.truth(a), self.truth(b));
            // both sides are computed already: logical operations do not skip the second one
            let both = self.builder.ins();
            let truth = if op == BinaryFunction::And { both.band(a, b) } else { both.bor(a, b) };
            return self.as_number(dst, truth);
        }
        let (a, b) = (self.value(a), self.value(b));
        match op {
            BinaryFunction::Add => self.builder.ins().fadd(a, b),
            BinaryFunction::Sub => self.builder.ins().fsub(a, b),
            BinaryFunction::Mul => self.builder.ins().fmul(a, b),
            BinaryFunction::Div => self.builder.ins().fdiv(a, b),
            BinaryFunction::Min => self.first_if(FloatCC::LessThanOrEqual, a, b),
            BinaryFunction::Max => self.first_if(FloatCC::GreaterThanOrEqual, a, b),
            BinaryFunction::Atan2 => self.import("atan2", &[a, b]),
            _ => self.import("pow", &[a, b]),
        }
    }

    /// `a` when it compares so with `b` or is NaN, else `b`.
    fn first_if(&mut self, condition: FloatCC, a: Value, b: Value) -> Value {
        let compares = self.builder.ins().fcmp(condition, a, b);
        let not_a_number = self.builder.ins().fcmp(FloatCC::Unordered, a, a);
        let first = self.builder.ins().bor(compares, not_a_number);
        self.builder.ins().select(first, a, b)
    }

    /// Writes an `if` of which only the chosen side is computed.
    ///
    /// Both sides jump to a block that receives the value as its parameter.
    fn branch(&mut self, c: RegisterOperand, then: &CodeBranch, otherwise: &CodeBranch) -> Value {
        let c = self.truth(c);
        let [yes, no, merge] = [(); 3].map(|()| self.builder.create_block());
        let result = self.builder.append_block_param(merge, F64);
        self.builder.ins().brif(c, yes, &[], no, &[]);
        self.depth += 1;
        for (block, side) in [(yes, then), (no, otherwise)] {
            self.builder.switch_to_block(block);
            self.builder.seal_block(block);
            self.steps(&side.steps);
            let value = self.value(side.value.expect("a finished branch has a value"));
            self.builder.ins().jump(merge, &[BlockArg::Value(value)]);
        }
        self.depth -= 1;
        self.builder.switch_to_block(merge);
        self.builder.seal_block(merge);
        result
    }

    /// The reference to an imported function, declared in this function at its first use.
    fn reference(&mut self, name: &'static str) -> FuncRef {
        let (module, builder, id) = (&mut *self.module, &mut self.builder, self.imports[name]);
        *self.used.entry(name).or_insert_with(|| module.declare_func_in_func(id, builder.func))
    }

    /// Calls an imported function.
    fn import(&mut self, name: &'static str, args: &[Value]) -> Value {
        let function = self.reference(name);
        let call = self.builder.ins().call(function, args);
        self.builder.inst_results(call)[0]
    }

    /// Calls a user function. Arguments and results pass through the stack.
    ///
    /// `outputs` holds for each output that is used its number and register.
    fn call(&mut self, function: u32, args: &[RegisterOperand], outputs: &[(u32, u32)]) {
        let results = self.functions[function as usize].outputs.len();
        let (inputs, out) = (self.stack(args.len()), self.stack(results));
        let from = self.builder.ins().stack_addr(self.pointer, inputs, 0);
        for (i, &arg) in (0..).zip(args) {
            let value = self.value(arg);
            self.builder.ins().store(MemFlagsData::trusted(), value, from, slot_offset(i));
        }
        let callee = self.reference(CALL_FUNCTION);
        let number = self.builder.ins().iconst(I32, i64::from(function));
        let to = self.builder.ins().stack_addr(self.pointer, out, 0);
        self.builder.ins().call(callee, &[self.arguments[3], number, from, to]);
        for &(output, dst) in outputs {
            let offset = slot_offset(output);
            self.registers[dst as usize] = self.builder.ins().load(F64, MemFlagsData::trusted(), to, offset);
        }
    }

    /// A stack slot for this many numbers.
    fn stack(&mut self, numbers: usize) -> StackSlot {
        let bytes = 8 * u32::try_from(numbers.max(1)).expect("a small number");
        self.builder.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, bytes, 3))
    }
}

/// The offset of a slot in bytes.
fn slot_offset(slot: ValueSlot) -> Offset32 {
    Offset32::new(i32::try_from(8 * i64::from(slot)).expect("layouts are small enough for 32-bit offsets"))
}

/// The condition code of a relation. All but `<>` are false for NaN.
fn relation(rel: RelationalOp) -> FloatCC {
    match rel {
        RelationalOp::Lt => FloatCC::LessThan,
        RelationalOp::Le => FloatCC::LessThanOrEqual,
        RelationalOp::Gt => FloatCC::GreaterThan,
        RelationalOp::Ge => FloatCC::GreaterThanOrEqual,
        RelationalOp::Eq => FloatCC::Equal,
        RelationalOp::Ne => FloatCC::NotEqual,
    }
}
