//! Scalar expressions from the flat model on: a pool of hash-consed nodes.
//! The crate `model` builds expressions here from the evaluated text; `structure` differentiates and rewrites them;
//! `solve` lowers them to kernels.
//!
//! An [`ExprId`] is a node of a directed acyclic graph inside one [`Exprs`] pool. Equal expressions have equal ids, so
//! common subexpressions are shared and a comparison is one of integers.
//! Every value is an `f64`: Booleans are 0 and 1, enumeration literals count from 1, Integers are exact up to 2^53.

pub mod types;
pub mod units;

pub mod affine;
pub mod build;
mod compact;
pub mod differentiate;
pub mod eval;
pub mod from_text;
pub mod function;
pub mod interpret;
pub mod math;
pub mod print;
mod rules;
mod tangent;
pub mod visit;

use hashbrown::hash_table::{Entry, HashTable};
use rustc_hash::{FxBuildHasher, FxHashMap};
use std::hash::{BuildHasher, Hash, Hasher};

/// A scalar variable: index into `FlatModel::variables` and, later, `Dae::variables`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VarId(pub u32);

/// A user function that stays a call: index into [`Exprs::functions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub u32);

/// A node in an [`Exprs`] pool. It is meaningless in another pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ExprId(pub u32);

impl VarId {
    /// The index as `usize`.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl ExprId {
    /// The index as `usize`.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The arguments of a call: a range of the pool's argument list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ArgumentRange {
    /// The index of the first argument.
    start: u32,
    /// The number of arguments.
    len: u32,
}

/// Operators and functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the mathematical functions of these names")]
pub enum UnaryFunction {
    Neg,
    Not,
    Abs,
    /// The sign: -1, 0 or 1.
    Sign,
    Sqrt,
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
    /// The largest whole number not above the argument. It makes no event; see [`ExprNode::EventFloor`].
    Floor,
}

impl UnaryFunction {
    /// All functions in the order of their declaration.
    pub const ALL: [UnaryFunction; 18] = [
        UnaryFunction::Neg,
        UnaryFunction::Not,
        UnaryFunction::Abs,
        UnaryFunction::Sign,
        UnaryFunction::Sqrt,
        UnaryFunction::Exp,
        UnaryFunction::Log,
        UnaryFunction::Log10,
        UnaryFunction::Sin,
        UnaryFunction::Cos,
        UnaryFunction::Tan,
        UnaryFunction::Asin,
        UnaryFunction::Acos,
        UnaryFunction::Atan,
        UnaryFunction::Sinh,
        UnaryFunction::Cosh,
        UnaryFunction::Tanh,
        UnaryFunction::Floor,
    ];
}

/// Operators and functions of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the operators of these names")]
pub enum BinaryFunction {
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
}

/// Relations between two values.
/// `Gt` and `Ge` could be written as `Lt` and `Le` with exchanged sides. They are kept, so that messages show what the
/// user wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the relations of these names")]
pub enum RelationalOp {
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
}

/// One node. The methods of [`Exprs`] build nodes; they simplify and share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExprNode {
    /// A number, by the bits of its `f64`, so that nodes can be compared and hashed.
    Num(u64),
    /// Simulated time in seconds.
    Time,
    /// The value of a variable.
    Var(VarId),
    /// The time derivative of a variable.
    Der(VarId),
    /// The value of a discrete variable before the current event (`pre` of Modelica).
    Pre(VarId),
    /// A function of one argument.
    Unary(UnaryFunction, ExprId),
    /// A function of two arguments.
    Binary(BinaryFunction, ExprId, ExprId),
    /// A relation evaluated as it stands, without an event: inside `noEvent`, or between discrete values.
    Rel(RelationalOp, ExprId, ExprId),
    /// A relation whose change is an event. `structure` replaces it by a discrete variable with a zero crossing.
    EventRel(RelationalOp, ExprId, ExprId),
    /// `floor` whose change is an event. `structure` replaces it by a discrete variable with zero crossings.
    EventFloor(ExprId),
    /// The second operand if the first is not 0, else the third. Only the one that is taken needs to be finite.
    If(ExprId, ExprId, ExprId),
    /// True at the times `start + k*interval` for k = 0, 1, ... Both operands are parameter expressions.
    Sample(ExprId, ExprId),
    /// `delay(a, time)`: the value of `a` a time ago (s), or its start value before the start. The time is a parameter
    /// expression. `structure` replaces the node by an input that the run itself records.
    Delay(ExprId, ExprId),
    /// True during initialization, else false.
    Initial,
    /// True at the end of a successful run.
    Terminal,
    /// `homotopy(actual, simplified)`: `actual`, except while the solver approaches a start from the simplified model.
    Homotopy(ExprId, ExprId),
    /// One output of a user function, by its index, with scalar arguments.
    Call(FunctionId, u32, ArgumentRange),
}

/// Hashes two words a node, which is faster than one write for each field: the pool looks up every node that is built.
/// The bytes of numbers are swapped, because small whole numbers differ in their highest bits only, which this hash
/// would not spread.
impl Hash for ExprNode {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // High bits keep nodes with a free 32-bit field apart from those with small tags. Collisions cost time, not
        // correctness.
        let (kind, a, b) = match *self {
            ExprNode::Num(bits) => return state.write_u64(bits.swap_bytes()),
            ExprNode::Time => (1, 0, 0),
            ExprNode::Var(v) => (2, v.0, 0),
            ExprNode::Der(v) => (3, v.0, 0),
            ExprNode::Pre(v) => (4, v.0, 0),
            ExprNode::Unary(op, a) => (0x100 | op as u32, a.0, 0),
            ExprNode::Binary(op, a, b) => (0x200 | op as u32, a.0, b.0),
            ExprNode::Rel(op, a, b) => (0x300 | op as u32, a.0, b.0),
            ExprNode::EventRel(op, a, b) => (0x400 | op as u32, a.0, b.0),
            ExprNode::EventFloor(a) => (5, a.0, 0),
            ExprNode::If(c, a, b) => (c.0 ^ 0x8000_0000, a.0, b.0),
            ExprNode::Sample(a, b) => (6, a.0, b.0),
            ExprNode::Initial => (7, 0, 0),
            ExprNode::Terminal => (8, 0, 0),
            ExprNode::Homotopy(a, b) => (9, a.0, b.0),
            ExprNode::Delay(a, b) => (10, a.0, b.0),
            ExprNode::Call(f, output, args) => (f.0 ^ 0x4000_0000, output, args.start),
        };
        state.write_u64(u64::from(kind));
        state.write_u64(u64::from(a) << 32 | u64::from(b));
    }
}

/// The hash of a node in the index of the pool.
/// The same function hashes nodes in the table and nodes that are looked up.
fn hash(node: &ExprNode) -> u64 {
    FxBuildHasher.hash_one(node)
}

/// A pool of expressions. It only grows; [`Exprs::compact`] makes it small again.
/// Node 0 is the number 0, and node 1 the number 1.
#[derive(Clone, Debug)]
pub struct Exprs {
    /// All nodes; an [`ExprId`] is an index here.
    nodes: Vec<ExprNode>,
    /// The ids of all nodes by the hash of their nodes. The nodes themselves are in `nodes` only.
    index: HashTable<ExprId>,
    /// The node of each variable's value, or node 0 if there is none. Half of all requests are for these.
    leaves: Vec<ExprId>,
    /// The arguments of all calls, one list after the other.
    args: Vec<ExprId>,
    /// The range of each argument list in `args`.
    arg_index: FxHashMap<Box<[ExprId]>, ArgumentRange>,
    /// For each function its tangent function, which takes values and tangents and returns tangents.
    tangents: FxHashMap<FunctionId, FunctionId>,
    /// For each function and input the function of the derivatives of all outputs by that input.
    partials: FxHashMap<(FunctionId, u32), FunctionId>,
    /// User functions that could not be written as expressions. A [`FunctionId`] is an index here.
    pub functions: Vec<function::Function>,
}

impl Default for Exprs {
    fn default() -> Self {
        let mut pool = Exprs {
            nodes: Vec::new(),
            index: HashTable::new(),
            leaves: Vec::new(),
            args: Vec::new(),
            arg_index: FxHashMap::default(),
            tangents: FxHashMap::default(),
            partials: FxHashMap::default(),
            functions: Vec::new(),
        };
        // The ids `ZERO` and `ONE` rely on this order.
        pool.num(0.0);
        pool.num(1.0);
        pool
    }
}

impl Exprs {
    /// The number 0, which is also `false`.
    pub const ZERO: ExprId = ExprId(0);
    /// The number 1, which is also `true`.
    pub const ONE: ExprId = ExprId(1);

    /// The node of an id.
    #[inline]
    pub fn node(&self, e: ExprId) -> ExprNode {
        self.nodes[e.index()]
    }

    /// The number of nodes. Ids are `0..len`, and the operands of a node have smaller ids than the node.
    #[inline]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Always false: the pool holds 0 and 1 from the beginning.
    #[inline]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The arguments of a call, in order.
    #[inline]
    pub fn args(&self, args: ArgumentRange) -> &[ExprId] {
        &self.args[args.start as usize..(args.start + args.len) as usize]
    }

    /// The id of exactly this node, without simplification. It is added if it is new.
    pub fn intern(&mut self, node: ExprNode) -> ExprId {
        let nodes = &self.nodes;
        let same = |e: &ExprId| nodes[e.index()] == node;
        match self.index.entry(hash(&node), same, |e| hash(&nodes[e.index()])) {
            Entry::Occupied(found) => *found.get(),
            Entry::Vacant(place) => {
                // A new node stands behind its operands, so that ascending ids are an order of evaluation.
                let e = ExprId(u32::try_from(nodes.len()).expect("fewer than 2^32 nodes"));
                place.insert(e);
                self.nodes.push(node);
                e
            }
        }
    }

    /// The id of exactly this node. `None` if it is not in the pool.
    fn find(&self, node: &ExprNode) -> Option<ExprId> {
        self.index.find(hash(node), |e| self.nodes[e.index()] == *node).copied()
    }

    /// The value, if the node is a number.
    #[inline]
    pub fn as_num(&self, e: ExprId) -> Option<f64> {
        match self.node(e) {
            ExprNode::Num(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// A number. Minus zero becomes zero, so that equal numbers are one node.
    #[inline]
    pub fn num(&mut self, value: f64) -> ExprId {
        let value = if value == 0.0 { 0.0 } else { value };
        self.intern(ExprNode::Num(value.to_bits()))
    }

    /// A Boolean value as a number.
    #[inline]
    pub fn boolean(&mut self, value: bool) -> ExprId {
        if value { Self::ONE } else { Self::ZERO }
    }

    /// Simulated time (s).
    #[inline]
    pub fn time(&mut self) -> ExprId {
        self.intern(ExprNode::Time)
    }

    /// The value of a variable.
    #[inline]
    pub fn var(&mut self, v: VarId) -> ExprId {
        // Node 0 stands for "none", which is no variable.
        match self.leaves.get(v.index()) {
            Some(&e) if e != Self::ZERO => e,
            _ => self.new_leaf(v),
        }
    }

    /// The node of a variable that is not in `leaves` yet.
    /// Small indices enter the table, so that the next request is a single access.
    fn new_leaf(&mut self, v: VarId) -> ExprId {
        let (e, known) = (self.intern(ExprNode::Var(v)), self.leaves.len());
        // Locals of functions have very large indices, for which the table would become too long. They are found by
        // hash.
        if v.index() < 2 * known + 1024 {
            self.leaves.resize(known.max(v.index() + 1), Self::ZERO);
            self.leaves[v.index()] = e;
        }
        e
    }

    /// The time derivative of a variable.
    #[inline]
    pub fn der(&mut self, v: VarId) -> ExprId {
        self.intern(ExprNode::Der(v))
    }

    /// The value of a discrete variable before the current event.
    #[inline]
    pub fn pre(&mut self, v: VarId) -> ExprId {
        self.intern(ExprNode::Pre(v))
    }

    /// One output of a call. Several outputs are several nodes with the same arguments.
    #[inline]
    pub fn call(&mut self, function: FunctionId, output: u32, args: &[ExprId]) -> ExprId {
        let args = self.intern_args(args);
        self.intern(ExprNode::Call(function, output, args))
    }

    /// The range of an argument list, which is added if it is new.
    /// Argument lists are never removed.
    fn intern_args(&mut self, args: &[ExprId]) -> ArgumentRange {
        if let Some(&a) = self.arg_index.get(args) {
            return a;
        }
        let found = ArgumentRange {
            start: u32::try_from(self.args.len()).expect("fewer than 2^32 arguments"),
            len: u32::try_from(args.len()).expect("fewer than 2^32 arguments"),
        };
        self.args.extend_from_slice(args);
        self.arg_index.insert(args.into(), found);
        found
    }
}
