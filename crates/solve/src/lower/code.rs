//! Straight code of one kernel: what the interpreter and the compiler to machine code both start from.
//!
//! A branch of an `if` is entered only when chosen, if it is worth a jump: everything that only that branch needs is
//! computed inside it, everything else before. Cheap branches are both computed and one is selected; no operation on
//! floating-point numbers traps.

use bramah_expr::math::Power;
use bramah_expr::{Binary, ExprId, Exprs, FunctionId, Node, Rel, Unary};
use rustc_hash::FxHashMap;

/// Where an argument comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand {
    /// An input of the kernel, or a slot: what the numbers of `Node::Var` mean to whoever made the expressions.
    Input(u32),
    /// A number, by its bits.
    Number(u64),
    /// The result of an earlier step.
    Register(u32),
}

/// One step; each register is written once.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A function of one argument.
    Unary(Unary, u32, Operand),
    /// A function of two arguments; never `Pow` with a whole or root exponent, those are written out.
    Binary(Binary, u32, Operand, Operand),
    /// 1 when the relation holds, else 0.
    Rel(Rel, u32, Operand, Operand),
    /// `dst = if c <> 0 then a else b`, both at hand.
    Select { dst: u32, c: Operand, a: Operand, b: Operand },
    /// The same, computing only the chosen one.
    Branch { dst: u32, c: Operand, then: Branch, otherwise: Branch },
    /// Outputs of a user function: number of the output and register.
    Call { function: FunctionId, args: Vec<Operand>, outputs: Vec<(u32, u32)> },
}

/// One side of a [`Step::Branch`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branch {
    /// What only this side needs.
    pub steps: Vec<Step>,
    /// The value; `None` only while the branch is being built.
    pub value: Option<Operand>,
}

/// The code of a kernel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Code {
    /// In order.
    pub steps: Vec<Step>,
    /// The value of each output.
    pub outputs: Vec<Operand>,
    /// Number of registers.
    pub registers: u32,
    /// Number of nodes, for limits on size.
    pub size: usize,
}

/// A branch that costs more than this (see [`node_cost`]) is jumped over when not needed.
const WORTH_A_JUMP: u32 = 12;

/// The cost of one node, in additions.
fn node_cost(node: Node) -> u32 {
    match node {
        Node::Unary(Unary::Neg | Unary::Not | Unary::Abs | Unary::Floor, _) => 1,
        Node::Unary(Unary::Sqrt | Unary::Sign, _) => 4,
        Node::Unary(..) | Node::Binary(Binary::Pow | Binary::Atan2, ..) => 20,
        Node::Binary(Binary::Div, ..) => 4,
        Node::Binary(..) | Node::Rel(..) | Node::If(..) => 1,
        Node::Call(..) => 1000,
        _ => 0,
    }
}

impl Code {
    /// Code that computes `outputs`. Leaves are `Node::Var` (an input) and `Node::Num`.
    pub fn new(pool: &Exprs, outputs: &[ExprId]) -> Code {
        let nodes = pool.reachable(outputs, |_| true);
        let mut builder = Builder::new(pool, &nodes);
        builder.assign_regions(outputs);
        builder.fill_regions();
        let steps = builder.emit(0);
        let outputs = outputs.iter().map(|&e| builder.operand(e)).collect();
        Code { steps, outputs, registers: builder.registers, size: nodes.len() }
    }
}

/// A place in the code: the whole, or one side of a branch.
#[derive(Clone, Copy)]
struct Region {
    parent: u32,
    depth: u32,
}

const UNUSED: u32 = u32::MAX;

struct Builder<'a> {
    pool: &'a Exprs,
    nodes: &'a [ExprId],
    index: FxHashMap<ExprId, u32>,
    /// Per node, its region.
    region: Vec<u32>,
    regions: Vec<Region>,
    /// Per node, the regions of its branches, if it is an `if` worth a jump.
    branches: FxHashMap<u32, (u32, u32)>,
    contents: Vec<Vec<u32>>,
    operands: Vec<Operand>,
    calls: FxHashMap<(u32, Node), usize>,
    registers: u32,
}

impl<'a> Builder<'a> {
    fn new(pool: &'a Exprs, nodes: &'a [ExprId]) -> Self {
        Builder {
            pool,
            nodes,
            index: nodes.iter().copied().zip(0..).collect(),
            region: vec![UNUSED; nodes.len()],
            regions: vec![Region { parent: 0, depth: 0 }],
            branches: FxHashMap::default(),
            contents: Vec::new(),
            operands: vec![Operand::Number(0); nodes.len()],
            calls: FxHashMap::default(),
            registers: 0,
        }
    }

    /// Finds for each node the innermost region that holds all its uses.
    fn assign_regions(&mut self, outputs: &[ExprId]) {
        let costs = self.costs();
        for &e in outputs {
            self.region[self.index[&e] as usize] = 0;
        }
        for i in (0..self.nodes.len()).rev() {
            let here = self.region[i];
            match self.pool.node(self.nodes[i]) {
                Node::If(c, a, b) if self.worth_a_jump(&costs, a, b) => {
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

    /// What each node costs with all it needs, counting shared parts as often as they are used, up to a limit.
    fn costs(&self) -> Vec<u32> {
        let mut costs: Vec<u32> = Vec::with_capacity(self.nodes.len());
        for &e in self.nodes {
            let operands = self.pool.operands(e);
            let inner: u32 = operands.as_slice().iter().map(|o| costs[self.index[o] as usize]).sum();
            costs.push((inner + node_cost(self.pool.node(e))).min(1000));
        }
        costs
    }

    fn worth_a_jump(&self, costs: &[u32], a: ExprId, b: ExprId) -> bool {
        let cost = |e: ExprId| costs[self.index[&e] as usize];
        cost(a).max(cost(b)) > WORTH_A_JUMP
    }

    fn new_region(&mut self, parent: u32) -> u32 {
        let depth = self.regions[parent as usize].depth + 1;
        self.regions.push(Region { parent, depth });
        u32::try_from(self.regions.len() - 1).expect("fewer than 2^32 branches")
    }

    fn used(&mut self, e: ExprId, region: u32) {
        let i = self.index[&e] as usize;
        self.region[i] = match self.region[i] {
            UNUSED => region,
            known => self.common(known, region),
        };
    }

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

    fn fill_regions(&mut self) {
        self.contents = vec![Vec::new(); self.regions.len()];
        for (i, &region) in (0..).zip(&self.region) {
            self.contents[region as usize].push(i);
        }
    }

    fn operand(&self, e: ExprId) -> Operand {
        self.operands[self.index[&e] as usize]
    }

    fn register(&mut self) -> u32 {
        self.registers += 1;
        self.registers - 1
    }

    fn emit(&mut self, region: u32) -> Vec<Step> {
        let mut steps = Vec::new();
        for i in std::mem::take(&mut self.contents[region as usize]) {
            let operand = self.emit_node(region, i, &mut steps);
            self.operands[i as usize] = operand;
        }
        steps
    }

    fn emit_node(&mut self, region: u32, i: u32, steps: &mut Vec<Step>) -> Operand {
        let pool = self.pool;
        match pool.node(self.nodes[i as usize]) {
            Node::Var(v) => Operand::Input(v.0),
            Node::Num(bits) => Operand::Number(bits),
            Node::Unary(op, a) => {
                let a = self.operand(a);
                self.push(steps, |dst| Step::Unary(op, dst, a))
            }
            Node::Binary(Binary::Pow, a, b) => self.emit_power(self.operand(a), self.operand(b), steps),
            Node::Binary(op, a, b) => {
                let (a, b) = (self.operand(a), self.operand(b));
                self.push(steps, |dst| Step::Binary(op, dst, a, b))
            }
            Node::Rel(rel, a, b) => {
                let (a, b) = (self.operand(a), self.operand(b));
                self.push(steps, |dst| Step::Rel(rel, dst, a, b))
            }
            Node::If(c, a, b) => self.emit_if(i, (c, a, b), steps),
            node @ Node::Call(..) => self.emit_call(region, node, steps),
            other => unreachable!("{other:?} is replaced when shapes are made"),
        }
    }

    fn push(&mut self, steps: &mut Vec<Step>, step: impl FnOnce(u32) -> Step) -> Operand {
        let dst = self.register();
        steps.push(step(dst));
        Operand::Register(dst)
    }

    fn emit_if(&mut self, i: u32, (c, a, b): (ExprId, ExprId, ExprId), steps: &mut Vec<Step>) -> Operand {
        let condition = self.operand(c);
        let Some(&(then, otherwise)) = self.branches.get(&i) else {
            let (a, b) = (self.operand(a), self.operand(b));
            return self.push(steps, |dst| Step::Select { dst, c: condition, a, b });
        };
        let then = Branch { steps: self.emit(then), value: Some(self.operand(a)) };
        let otherwise = Branch { steps: self.emit(otherwise), value: Some(self.operand(b)) };
        self.push(steps, |dst| Step::Branch { dst, c: condition, then, otherwise })
    }

    /// Powers as [`bramah_expr::math::pow`] computes them, written out where the exponent is known.
    fn emit_power(&mut self, x: Operand, exponent: Operand, steps: &mut Vec<Step>) -> Operand {
        let way = match exponent {
            Operand::Number(bits) => Power::of(f64::from_bits(bits)),
            _ => Power::General,
        };
        match way {
            Power::General => self.push(steps, |dst| Step::Binary(Binary::Pow, dst, x, exponent)),
            Power::Sqrt => self.push(steps, |dst| Step::Unary(Unary::Sqrt, dst, x)),
            Power::FourthRoot => {
                let root = self.push(steps, |dst| Step::Unary(Unary::Sqrt, dst, x));
                self.push(steps, |dst| Step::Unary(Unary::Sqrt, dst, root))
            }
            Power::Whole(n) => self.emit_whole_power(x, n, steps),
        }
    }

    fn emit_whole_power(&mut self, x: Operand, n: i32, steps: &mut Vec<Step>) -> Operand {
        let one = Operand::Number(1f64.to_bits());
        let (mut left, mut square, mut product) = (n.unsigned_abs(), x, None);
        while left > 0 {
            if left & 1 == 1 {
                product = Some(match product {
                    None => square,
                    Some(p) => self.push(steps, |dst| Step::Binary(Binary::Mul, dst, p, square)),
                });
            }
            left >>= 1;
            if left > 0 {
                square = self.push(steps, |dst| Step::Binary(Binary::Mul, dst, square, square));
            }
        }
        let value = product.unwrap_or(one);
        if n < 0 { self.push(steps, |dst| Step::Binary(Binary::Div, dst, one, value)) } else { value }
    }

    /// Calls of one function with the same arguments in the same region are one call.
    fn emit_call(&mut self, region: u32, node: Node, steps: &mut Vec<Step>) -> Operand {
        let Node::Call(function, output, args) = node else { unreachable!("only calls come here") };
        let key = (region, Node::Call(function, 0, args));
        let dst = self.register();
        if let Some(&position) = self.calls.get(&key)
            && let Some(Step::Call { outputs, .. }) = steps.get_mut(position)
        {
            outputs.push((output, dst));
            return Operand::Register(dst);
        }
        let args = self.pool.args(args).iter().map(|&arg| self.operand(arg)).collect();
        self.calls.insert(key, steps.len());
        steps.push(Step::Call { function, args, outputs: vec![(output, dst)] });
        Operand::Register(dst)
    }
}
