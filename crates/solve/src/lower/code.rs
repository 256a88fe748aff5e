//! Intermediate code of one kernel, from which both the bytecode and the machine code are made.
//!
//! Expressions enter; a [`KernelCode`] of register steps leaves. A branch of an `if` is computed only when chosen, if
//! it is expensive enough to be worth a jump: everything that only that branch needs is computed inside it, everything
//! else before. Cheap branches are both computed, and one is selected. That is safe, because no floating-point
//! operation traps.

use bramah_expr::math::PowerMethod;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, FunctionId, RelationalOp, UnaryFunction};
use rustc_hash::FxHashMap;

/// Where an operand comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RegisterOperand {
    /// The number of an `ExprNode::Var`: an input of the kernel, or a slot, depending on who made the expressions.
    Input(u32),
    /// A number, by its bits.
    Number(u64),
    /// The result of an earlier step.
    Register(u32),
}

/// One step. Each register is written once.
#[derive(Clone, Debug, PartialEq)]
pub enum CodeStep {
    /// A function of one argument.
    Unary(UnaryFunction, u32, RegisterOperand),
    /// A function of two arguments. `Pow` with a integer or root exponent never occurs; such powers are written out.
    Binary(BinaryFunction, u32, RegisterOperand, RegisterOperand),
    /// 1 when the relation holds, else 0.
    Rel(RelationalOp, u32, RegisterOperand, RegisterOperand),
    /// `dst = if c <> 0 then a else b`, with both sides computed before.
    Select { dst: u32, c: RegisterOperand, a: RegisterOperand, b: RegisterOperand },
    /// The same, computing only the chosen side.
    Branch { dst: u32, c: RegisterOperand, then: CodeBranch, otherwise: CodeBranch },
    /// A call of a user function; for each output that is used its number and register.
    Call { function: FunctionId, args: Vec<RegisterOperand>, outputs: Vec<(u32, u32)> },
}

/// One side of a [`CodeStep::Branch`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CodeBranch {
    /// The steps that only this side needs.
    pub steps: Vec<CodeStep>,
    /// The value of this side; `None` only while the branch is being built.
    pub value: Option<RegisterOperand>,
}

/// The code of a kernel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KernelCode {
    /// The steps in order.
    pub steps: Vec<CodeStep>,
    /// The value of each output.
    pub outputs: Vec<RegisterOperand>,
    /// Number of registers.
    pub registers: u32,
    /// Number of nodes of the expressions, for limits on size.
    pub size: usize,
}

/// A branch that costs more than this (in units of [`node_cost`]) is skipped by a jump when it is not chosen.
const WORTH_A_JUMP: u32 = 12;

/// The cost of one node, in units of an addition.
fn node_cost(node: ExprNode) -> u32 {
    match node {
        ExprNode::Unary(UnaryFunction::Neg | UnaryFunction::Not | UnaryFunction::Abs | UnaryFunction::Floor, _) => 1,
        ExprNode::Unary(UnaryFunction::Sqrt | UnaryFunction::Sign, _) => 4,
        ExprNode::Unary(..) | ExprNode::Binary(BinaryFunction::Pow | BinaryFunction::Atan2, ..) => 20,
        ExprNode::Binary(BinaryFunction::Div, ..) => 4,
        ExprNode::Binary(..) | ExprNode::Rel(..) | ExprNode::If(..) => 1,
        // a user function may contain loops
        ExprNode::Call(..) => 1000,
        _ => 0,
    }
}

impl KernelCode {
    /// Makes code that computes `outputs`. Leaves are `ExprNode::Var` (inputs) and `ExprNode::Num`.
    pub fn new(pool: &Exprs, outputs: &[ExprId]) -> KernelCode {
        let nodes = pool.reachable(outputs, |_| true);
        let mut builder = CodeBuilder::new(pool, &nodes);
        builder.assign_regions(outputs);
        builder.fill_regions();
        // region 0 is the code outside all branches
        let steps = builder.emit(0);
        let outputs = outputs.iter().map(|&e| builder.operand(e)).collect();
        KernelCode { steps, outputs, registers: builder.registers, size: nodes.len() }
    }
}

/// A place in the code: the code outside all branches, or one side of a branch.
#[derive(Clone, Copy)]
struct CodeRegion {
    /// The region around it.
    parent: u32,
    /// Number of branches around it.
    depth: u32,
}

/// No use of the node is known yet.
const UNUSED: u32 = u32::MAX;

/// Builds the code of one kernel.
struct CodeBuilder<'a> {
    /// The expressions.
    pool: &'a Exprs,
    /// All nodes needed, operands before their users.
    nodes: &'a [ExprId],
    /// The position of each node in `nodes`.
    index: FxHashMap<ExprId, u32>,
    /// For each node its region.
    region: Vec<u32>,
    /// All regions.
    regions: Vec<CodeRegion>,
    /// For each `if` that is worth a jump the regions of its two sides.
    branches: FxHashMap<u32, (u32, u32)>,
    /// For each region its nodes, in order.
    contents: Vec<Vec<u32>>,
    /// For each node that is written the operand that holds its value.
    operands: Vec<RegisterOperand>,
    /// Calls written so far: region and function call, to the position of the step.
    calls: FxHashMap<(u32, ExprNode), usize>,
    /// Number of registers used.
    registers: u32,
}

impl<'a> CodeBuilder<'a> {
    /// Nothing is placed yet.
    fn new(pool: &'a Exprs, nodes: &'a [ExprId]) -> Self {
        CodeBuilder {
            pool,
            nodes,
            index: nodes.iter().copied().zip(0..).collect(),
            region: vec![UNUSED; nodes.len()],
            regions: vec![CodeRegion { parent: 0, depth: 0 }],
            branches: FxHashMap::default(),
            contents: Vec::new(),
            operands: vec![RegisterOperand::Number(0); nodes.len()],
            calls: FxHashMap::default(),
            registers: 0,
        }
    }

    /// Finds for each node the innermost region that contains all its uses.
    ///
    /// The nodes are visited from the outputs to the leaves, so that all uses of a node are known when it is reached.
    /// An `if` that is worth a jump opens two regions.
    fn assign_regions(&mut self, outputs: &[ExprId]) {
        let costs = self.costs();
        for &e in outputs {
            self.region[self.index[&e] as usize] = 0;
        }
        // backwards: all users of a node come after it
        for i in (0..self.nodes.len()).rev() {
            let here = self.region[i];
            match self.pool.node(self.nodes[i]) {
                ExprNode::If(c, a, b) if self.worth_a_jump(&costs, a, b) => {
                    let (then, otherwise) = (self.new_region(here), self.new_region(here));
                    self.branches.insert(u32::try_from(i).expect("fewer than 2^32 nodes"), (then, otherwise));
                    self.used(c, here);
                    self.used(a, then);
                    self.used(b, otherwise);
                }
                _ => {
                    for &operand in self.pool.operands(self.nodes[i]).as_slice() {
                        self.used(operand, here);
                    }
                }
            }
        }
    }

    /// The cost of each node with all its operands.
    ///
    /// Shared parts count as often as they are used. The cost is limited to 1000, so that it cannot overflow.
    fn costs(&self) -> Vec<u32> {
        let mut costs: Vec<u32> = Vec::with_capacity(self.nodes.len());
        for &e in self.nodes {
            let operands = self.pool.operands(e);
            let inner: u32 = operands.as_slice().iter().map(|o| costs[self.index[o] as usize]).sum();
            costs.push((inner + node_cost(self.pool.node(e))).min(1000));
        }
        costs
    }

    /// Whether one side of an `if` is expensive enough for a jump.
    fn worth_a_jump(&self, costs: &[u32], a: ExprId, b: ExprId) -> bool {
        let cost = |e: ExprId| costs[self.index[&e] as usize];
        cost(a).max(cost(b)) > WORTH_A_JUMP
    }

    /// A new region inside `parent`.
    fn new_region(&mut self, parent: u32) -> u32 {
        let depth = self.regions[parent as usize].depth + 1;
        self.regions.push(CodeRegion { parent, depth });
        u32::try_from(self.regions.len() - 1).expect("fewer than 2^32 branches")
    }

    /// Notes a use of a node in a region: its region becomes the innermost one around all uses.
    fn used(&mut self, e: ExprId, region: u32) {
        let i = self.index[&e] as usize;
        self.region[i] = match self.region[i] {
            UNUSED => region,
            known => self.common(known, region),
        };
    }

    /// The innermost region that contains both regions.
    fn common(&self, mut a: u32, mut b: u32) -> u32 {
        while a != b {
            let (ra, rb) = (self.regions[a as usize], self.regions[b as usize]);
            if ra.depth >= rb.depth {
                a = ra.parent;
            }
            if rb.depth >= ra.depth {
                b = rb.parent;
            }
        }
        a
    }

    /// Lists the nodes of each region.
    fn fill_regions(&mut self) {
        self.contents = vec![Vec::new(); self.regions.len()];
        for (i, &region) in (0..).zip(&self.region) {
            self.contents[region as usize].push(i);
        }
    }

    /// The operand that holds the value of a node.
    fn operand(&self, e: ExprId) -> RegisterOperand {
        self.operands[self.index[&e] as usize]
    }

    /// A new register.
    fn register(&mut self) -> u32 {
        self.registers += 1;
        self.registers - 1
    }

    /// Writes the steps of a region.
    fn emit(&mut self, region: u32) -> Vec<CodeStep> {
        let mut steps = Vec::new();
        for i in std::mem::take(&mut self.contents[region as usize]) {
            let operand = self.emit_node(region, i, &mut steps);
            self.operands[i as usize] = operand;
        }
        steps
    }

    /// Writes the steps of one node and returns its value.
    fn emit_node(&mut self, region: u32, i: u32, steps: &mut Vec<CodeStep>) -> RegisterOperand {
        let pool = self.pool;
        match pool.node(self.nodes[i as usize]) {
            ExprNode::Var(v) => RegisterOperand::Input(v.0),
            ExprNode::Num(bits) => RegisterOperand::Number(bits),
            ExprNode::Unary(op, a) => {
                let a = self.operand(a);
                self.push(steps, |dst| CodeStep::Unary(op, dst, a))
            }
            ExprNode::Binary(BinaryFunction::Pow, a, b) => self.emit_power(self.operand(a), self.operand(b), steps),
            ExprNode::Binary(op, a, b) => {
                let (a, b) = (self.operand(a), self.operand(b));
                self.push(steps, |dst| CodeStep::Binary(op, dst, a, b))
            }
            ExprNode::Rel(rel, a, b) => {
                let (a, b) = (self.operand(a), self.operand(b));
                self.push(steps, |dst| CodeStep::Rel(rel, dst, a, b))
            }
            ExprNode::If(c, a, b) => self.emit_if(i, (c, a, b), steps),
            node @ ExprNode::Call(..) => self.emit_call(region, node, steps),
            other => unreachable!("{other:?} is replaced when shapes are made"),
        }
    }

    /// Appends a step that writes a new register.
    fn push(&mut self, steps: &mut Vec<CodeStep>, step: impl FnOnce(u32) -> CodeStep) -> RegisterOperand {
        let dst = self.register();
        steps.push(step(dst));
        RegisterOperand::Register(dst)
    }

    /// Writes an `if`: a selection, or a branch where it has regions.
    fn emit_if(&mut self, i: u32, (c, a, b): (ExprId, ExprId, ExprId), steps: &mut Vec<CodeStep>) -> RegisterOperand {
        let condition = self.operand(c);
        let Some(&(then, otherwise)) = self.branches.get(&i) else {
            let (a, b) = (self.operand(a), self.operand(b));
            return self.push(steps, |dst| CodeStep::Select { dst, c: condition, a, b });
        };
        let then = CodeBranch { steps: self.emit(then), value: Some(self.operand(a)) };
        let otherwise = CodeBranch { steps: self.emit(otherwise), value: Some(self.operand(b)) };
        self.push(steps, |dst| CodeStep::Branch { dst, c: condition, then, otherwise })
    }

    /// Writes a power as [`bramah_expr::math::pow`] computes it, so that all evaluators agree to the bit.
    fn emit_power(
        &mut self,
        x: RegisterOperand,
        exponent: RegisterOperand,
        steps: &mut Vec<CodeStep>,
    ) -> RegisterOperand {
        let way = match exponent {
            RegisterOperand::Number(bits) => PowerMethod::of(f64::from_bits(bits)),
            _ => PowerMethod::General,
        };
        match way {
            PowerMethod::General => self.push(steps, |dst| CodeStep::Binary(BinaryFunction::Pow, dst, x, exponent)),
            PowerMethod::Sqrt => self.push(steps, |dst| CodeStep::Unary(UnaryFunction::Sqrt, dst, x)),
            PowerMethod::FourthRoot => {
                let root = self.push(steps, |dst| CodeStep::Unary(UnaryFunction::Sqrt, dst, x));
                self.push(steps, |dst| CodeStep::Unary(UnaryFunction::Sqrt, dst, root))
            }
            PowerMethod::Whole(n) => self.emit_whole_power(x, n, steps),
        }
    }

    /// Writes a power with an integer exponent by repeated squaring, and a negative one as a reciprocal.
    fn emit_whole_power(&mut self, x: RegisterOperand, n: i32, steps: &mut Vec<CodeStep>) -> RegisterOperand {
        let one = RegisterOperand::Number(1f64.to_bits());
        let (mut left, mut square, mut product) = (n.unsigned_abs(), x, None);
        while left > 0 {
            if left & 1 == 1 {
                product = Some(match product {
                    None => square,
                    Some(p) => self.push(steps, |dst| CodeStep::Binary(BinaryFunction::Mul, dst, p, square)),
                });
            }
            left >>= 1;
            if left > 0 {
                square = self.push(steps, |dst| CodeStep::Binary(BinaryFunction::Mul, dst, square, square));
            }
        }
        let value = product.unwrap_or(one);
        if n < 0 { self.push(steps, |dst| CodeStep::Binary(BinaryFunction::Div, dst, one, value)) } else { value }
    }

    /// Writes a call. Calls of one function with the same arguments in the same region become one step.
    fn emit_call(&mut self, region: u32, node: ExprNode, steps: &mut Vec<CodeStep>) -> RegisterOperand {
        let ExprNode::Call(function, output, args) = node else { unreachable!("only calls come here") };
        let key = (region, ExprNode::Call(function, 0, args));
        let dst = self.register();
        if let Some(&position) = self.calls.get(&key)
            && let Some(CodeStep::Call { outputs, .. }) = steps.get_mut(position)
        {
            outputs.push((output, dst));
            return RegisterOperand::Register(dst);
        }
        let args = self.pool.args(args).iter().map(|&arg| self.operand(arg)).collect();
        self.calls.insert(key, steps.len());
        steps.push(CodeStep::Call { function, args, outputs: vec![(output, dst)] });
        RegisterOperand::Register(dst)
    }
}
