//! Kernels from expressions: expressions that differ only in the slots of their leaves share one kernel.
//!
//! An expression is copied into the pool of the [`KernelTable`], with its leaves numbered in the order in which they
//! are met. The pool shares equal nodes, so two expressions have the same kernel exactly when their copies are the same
//! node. Subexpressions that depend on parameters alone become leaves too (they are hoisted): their values are computed
//! once per set of parameters.

use super::layout::{ValueLayout, ValueSlot, slot};
use super::program::KernelDefinitions;
use bramah_expr::{ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction, VarId};
use bramah_model::flat::Variability;
use bramah_model::structure::Dae;
use rustc_hash::FxHashMap;

/// Index of a [`Kernel`] in the table.
pub type KernelId = u32;

/// Expressions over numbered inputs that are computed together.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Kernel {
    /// Number of inputs. Input `i` is `ExprNode::Var(VarId(i))` in the pool.
    pub inputs: u32,
    /// The expressions of the outputs.
    pub outputs: Vec<ExprId>,
}

/// All kernels of a model.
#[derive(Clone, Debug, Default)]
pub struct KernelTable {
    /// The expressions of all kernels. Its functions are those of the model and their derivatives.
    pub pool: Exprs,
    /// The kernels by index.
    list: Vec<Kernel>,
    /// The index of each kernel.
    index: FxHashMap<Kernel, KernelId>,
    /// Derivatives computed so far, by expression and input.
    partials: FxHashMap<(ExprId, u32), ExprId>,
}

impl KernelTable {
    /// The kernel with this index.
    pub fn get(&self, kernel: KernelId) -> &Kernel {
        &self.list[kernel as usize]
    }

    /// All numbers that occur in the kernels.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        (0..self.pool.len()).filter_map(|id| self.pool.as_num(ExprId(slot(id))))
    }

    /// The index of a kernel; adds it where it is new.
    pub fn intern(&mut self, kernel: Kernel) -> KernelId {
        if let Some(&known) = self.index.get(&kernel) {
            return known;
        }
        let fresh = slot(self.list.len());
        self.list.push(kernel.clone());
        self.index.insert(kernel, fresh);
        fresh
    }

    /// The symbolic derivative of an expression with respect to one of its inputs.
    pub fn partial(&mut self, e: ExprId, input: u32) -> ExprId {
        if let Some(&known) = self.partials.get(&(e, input)) {
            return known;
        }
        let leaf = self.pool.var(VarId(input));
        let partial = self.pool.differentiate(e, leaf);
        self.partials.insert((e, input), partial);
        partial
    }
}

/// An expression as a node of the kernel pool and the slots of its inputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KernelExpression {
    /// The node in the kernel pool.
    pub expr: ExprId,
    /// The slot of each input.
    pub inputs: Vec<ValueSlot>,
}

/// How leaves and phases are treated while expressions are copied.
#[derive(Clone, Copy, Debug)]
pub struct ShapingRules<'a> {
    /// Whether this is the initial system, where `homotopy` depends on its parameter. Elsewhere it is its first
    /// argument.
    pub initial: bool,
    /// Explicit variables that are replaced by their definitions, by slot.
    pub inline: &'a FxHashMap<ValueSlot, ExprId>,
    /// Whether subexpressions that depend on parameters alone become leaves.
    pub hoist: bool,
}

/// What a node of the model becomes in a kernel.
enum ShapeNode {
    /// An input that reads this slot.
    Leaf(ValueSlot),
    /// The copy of another node of the model.
    Other(ExprId),
    /// A number.
    Number(f64),
    /// `homotopy(actual, simplified)` in the initial system.
    Homotopy(ExprId, ExprId),
    /// The same operation on the copies of its operands.
    Operation,
}

/// Copies expressions of a model into kernels.
pub struct KernelShaper<'a> {
    /// The expressions of the model.
    source: &'a Exprs,
    /// The slots of the model, to which those of hoisted parts are added.
    pub layout: ValueLayout,
    /// The kernels made so far.
    pub kernels: KernelTable,
    /// For each node of the model whether it depends on parameters alone.
    fixed: Vec<bool>,
    /// Hoisted subexpressions in the order in which they were found, with their slots.
    pub hoisted: Vec<(ExprId, ValueSlot)>,
    /// The slot of each hoisted subexpression.
    hoisted_index: FxHashMap<ExprId, ValueSlot>,
    /// Results for expressions without inlining: node, start and number of its inputs in `shape_inputs`.
    shapes: FxHashMap<(ExprId, bool), (ExprId, u32, u32)>,
    /// The inputs of all entries of `shapes`.
    shape_inputs: Vec<ValueSlot>,
    /// Whether the model uses `homotopy`, so that results differ between the initial system and others.
    has_homotopy: bool,
    /// For each node of the model the stamp of its last copy, and that copy.
    memo: Vec<(u32, ExprId)>,
    /// For each slot the stamp of its last use, and its input number there.
    numbered: Vec<(u32, u32)>,
    /// Number of the present call of `shape_all`. Entries with older stamps are invalid.
    stamp: u32,
    /// Nodes still to be copied.
    stack: Vec<ExprId>,
}

impl<'a> KernelShaper<'a> {
    /// A shaper for the expressions of this model.
    pub fn new(dae: &'a Dae, layout: ValueLayout) -> Self {
        let source = &dae.exprs;
        let mut pool = Exprs::default();
        pool.functions.clone_from(&source.functions);
        KernelShaper {
            source,
            kernels: KernelTable { pool, ..KernelTable::default() },
            fixed: fixed_nodes(source, &fixed_parameters(dae)),
            hoisted: Vec::new(),
            hoisted_index: FxHashMap::default(),
            shapes: FxHashMap::default(),
            shape_inputs: Vec::new(),
            has_homotopy: (0..source.len()).any(|id| matches!(source.node(ExprId(slot(id))), ExprNode::Homotopy(..))),
            memo: vec![(0, Exprs::ZERO); source.len()],
            numbered: vec![(0, 0); layout.len()],
            layout,
            stamp: 0,
            stack: Vec::new(),
        }
    }

    /// The kernel expression of an expression of the model.
    pub fn shape(&mut self, e: ExprId, rules: &ShapingRules) -> KernelExpression {
        let key = (e, rules.initial && self.has_homotopy);
        let plain = rules.hoist && rules.inline.is_empty();
        if plain && let Some(&(expr, start, len)) = self.shapes.get(&key) {
            return KernelExpression { expr, inputs: self.shape_inputs[start as usize..][..len as usize].to_vec() };
        }
        let (exprs, inputs) = self.shape_all(&[e], rules);
        if plain {
            self.shapes.insert(key, (exprs[0], slot(self.shape_inputs.len()), slot(inputs.len())));
            self.shape_inputs.extend_from_slice(&inputs);
        }
        KernelExpression { expr: exprs[0], inputs }
    }

    /// The kernel expressions of several expressions over common inputs.
    pub fn shape_all(&mut self, roots: &[ExprId], rules: &ShapingRules) -> (Vec<ExprId>, Vec<ValueSlot>) {
        self.stamp += 1;
        let mut inputs = Vec::new();
        self.stack.extend(roots.iter().rev());
        // an explicit stack: expressions may be deeper than the call stack allows
        while let Some(&top) = self.stack.last() {
            if self.known(top).is_some() || self.finish(top, rules, &mut inputs) {
                self.stack.pop();
            }
        }
        let exprs = roots.iter().map(|&e| self.known(e).expect("roots are finished last")).collect();
        (exprs, inputs)
    }

    /// The copy of a node in the present call; `None` if it is not made yet.
    fn known(&self, e: ExprId) -> Option<ExprId> {
        let (stamp, copy) = self.memo[e.index()];
        (stamp == self.stamp).then_some(copy)
    }

    /// Copies a node whose operands are copied. Otherwise pushes the missing operands and returns false.
    fn finish(&mut self, e: ExprId, rules: &ShapingRules, inputs: &mut Vec<ValueSlot>) -> bool {
        let copy = match self.turn(e, rules) {
            ShapeNode::Leaf(slot) => Some(self.input(slot, inputs)),
            ShapeNode::Number(value) => Some(self.kernels.pool.num(value)),
            ShapeNode::Other(other) => self.wanted(&[other]).then(|| self.known(other).expect("just seen")),
            ShapeNode::Homotopy(actual, simplified) => {
                self.wanted(&[actual, simplified]).then(|| self.homotopy(actual, simplified, inputs))
            }
            ShapeNode::Operation => {
                let source = self.source;
                self.wanted(source.operands(e).as_slice()).then(|| self.copy(e))
            }
        };
        if let Some(copy) = copy {
            self.memo[e.index()] = (self.stamp, copy);
        }
        copy.is_some()
    }

    /// Decides what a node becomes.
    fn turn(&mut self, e: ExprId, rules: &ShapingRules) -> ShapeNode {
        let node = self.source.node(e);
        match node {
            ExprNode::Num(bits) => ShapeNode::Number(f64::from_bits(bits)),
            // `sample` is an event of known time: its mode is set by the driver, its expression is never true by itself
            ExprNode::Sample(..) => ShapeNode::Number(0.0),
            ExprNode::Homotopy(actual, simplified) if rules.initial => ShapeNode::Homotopy(actual, simplified),
            ExprNode::Homotopy(actual, _) => ShapeNode::Other(actual),
            _ => match self.layout.leaf(node) {
                Some(slot) => rules.inline.get(&slot).map_or(ShapeNode::Leaf(slot), |&value| ShapeNode::Other(value)),
                None if rules.hoist && self.fixed[e.index()] => ShapeNode::Leaf(self.hoisted_slot(e)),
                None => ShapeNode::Operation,
            },
        }
    }

    /// The definitions of all hoisted subexpressions.
    pub fn hoisted_definitions(&mut self) -> KernelDefinitions {
        let inline = FxHashMap::default();
        let rules = ShapingRules { initial: false, inline: &inline, hoist: false };
        let mut defs = KernelDefinitions::default();
        for (e, target) in self.hoisted.clone() {
            let shaped = self.shape(e, &rules);
            defs.define(&mut self.kernels, target, &shaped);
        }
        defs
    }

    /// The slot of a hoisted subexpression, made at its first use.
    fn hoisted_slot(&mut self, e: ExprId) -> ValueSlot {
        if let Some(&known) = self.hoisted_index.get(&e) {
            return known;
        }
        let fresh = self.layout.work(1);
        self.hoisted.push((e, fresh));
        self.hoisted_index.insert(e, fresh);
        fresh
    }

    /// Whether all operands are copied. Pushes those that are not, the first on top.
    fn wanted(&mut self, operands: &[ExprId]) -> bool {
        let before = self.stack.len();
        for &operand in operands.iter().rev() {
            if self.known(operand).is_none() {
                self.stack.push(operand);
            }
        }
        self.stack.len() == before
    }

    /// The input node for a slot; the slot becomes a new input at its first use.
    fn input(&mut self, slot: ValueSlot, inputs: &mut Vec<ValueSlot>) -> ExprId {
        if self.numbered.len() <= slot as usize {
            self.numbered.resize(self.layout.len(), (0, 0));
        }
        let (stamp, number) = &mut self.numbered[slot as usize];
        if *stamp != self.stamp {
            *stamp = self.stamp;
            *number = super::layout::slot(inputs.len());
            inputs.push(slot);
        }
        self.kernels.pool.var(VarId(*number))
    }

    /// `lambda*actual + (1 - lambda)*simplified`, which is exactly `actual` at lambda = 1.
    fn homotopy(&mut self, actual: ExprId, simplified: ExprId, inputs: &mut Vec<ValueSlot>) -> ExprId {
        let lambda = self.input(slot(ValueLayout::LAMBDA), inputs);
        let (a, s) = (self.known(actual).expect("copied"), self.known(simplified).expect("copied"));
        let pool = &mut self.kernels.pool;
        // without the selection a simplified part that is not finite would spoil the actual system
        let arrived = pool.rel(RelationalOp::Eq, lambda, Exprs::ONE);
        let rest = pool.sub(Exprs::ONE, lambda);
        let (left, right) = (pool.mul(lambda, a), pool.mul(rest, s));
        let mix = pool.add(left, right);
        pool.if_(arrived, a, mix)
    }

    /// The copy of an operation whose operands are copied.
    fn copy(&mut self, e: ExprId) -> ExprId {
        let (memo, stamp) = (&self.memo, self.stamp);
        copy_node(self.source, e, &mut self.kernels.pool, |operand| {
            debug_assert_eq!(memo[operand.index()].0, stamp, "arguments are copied first");
            memo[operand.index()].1
        })
    }
}

/// Makes the node `e` of pool `from` in pool `to`; `of` gives the copies of its operands.
///
/// Relations and floors that are events become plain ones.
pub fn copy_node(from: &Exprs, e: ExprId, to: &mut Exprs, of: impl Fn(ExprId) -> ExprId) -> ExprId {
    match from.node(e) {
        ExprNode::Num(bits) => to.num(f64::from_bits(bits)),
        ExprNode::Unary(op, a) => to.unary(op, of(a)),
        ExprNode::Binary(op, a, b) => to.binary(op, of(a), of(b)),
        ExprNode::Rel(rel, a, b) | ExprNode::EventRel(rel, a, b) => to.rel(rel, of(a), of(b)),
        ExprNode::EventFloor(a) => to.unary(UnaryFunction::Floor, of(a)),
        ExprNode::If(c, a, b) => to.if_(of(c), of(a), of(b)),
        ExprNode::Call(function, output, args) => {
            let args: Vec<ExprId> = from.args(args).iter().map(|&arg| of(arg)).collect();
            to.call(function, output, &args)
        }
        leaf => to.intern(leaf),
    }
}

/// For each variable whether it is a parameter or constant whose value is known before the initial system is solved.
pub fn fixed_parameters(dae: &Dae) -> Vec<bool> {
    let mut fixed: Vec<bool> =
        dae.variables.iter().map(|v| !v.input && v.variability <= Variability::Parameter).collect();
    if dae.free_parameters.is_empty() {
        return fixed;
    }
    for v in &dae.free_parameters {
        fixed[v.index()] = false;
    }
    // in the order of their bindings, so a dependent parameter sees the final answer for those it reads
    for &v in &dae.parameters {
        if let Some(binding) = dae.variables[v.index()].binding {
            fixed[v.index()] &= dae.exprs.variables(binding).iter().all(|used| fixed[used.index()]);
        }
    }
    fixed
}

/// For each node whether it depends on fixed parameters and numbers alone.
fn fixed_nodes(pool: &Exprs, parameters: &[bool]) -> Vec<bool> {
    let mut fixed: Vec<bool> = Vec::with_capacity(pool.len());
    for id in 0..pool.len() {
        let e = ExprId(slot(id));
        let own = match pool.node(e) {
            ExprNode::Num(_) => true,
            ExprNode::Var(v) => parameters.get(v.index()).copied().unwrap_or(false),
            ExprNode::Time | ExprNode::Der(_) | ExprNode::Pre(_) | ExprNode::Sample(..) => false,
            ExprNode::Initial | ExprNode::Terminal | ExprNode::Homotopy(..) => false,
            _ => true,
        };
        fixed.push(own && pool.operands(e).as_slice().iter().all(|operand| fixed[operand.index()]));
    }
    fixed
}
