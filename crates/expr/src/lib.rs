//! The one expression type from `flat` down: a pool of hash-consed scalar nodes.
//!
//! An [`ExprId`] is a node of a directed acyclic graph inside one [`Exprs`] pool; equal expressions have equal ids, so
//! sharing is free and comparison is one integer. Every value is an `f64`: Booleans are 0 and 1, enumeration values
//! count from 1, Integers are exact up to 2^53.

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

/// A flat variable: index into `FlatModel::variables` and, later, `Dae::variables`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VarId(pub u32);

/// A user function that could not be written as one expression: index into `Exprs::functions`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub u32);

/// A node in an [`Exprs`] pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ExprId(pub u32);

impl VarId {
    /// The index as `usize`.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl ExprId {
    /// The index as `usize`.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Arguments of a call: a stretch of `Exprs::args`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ArgumentRange {
    start: u32,
    len: u32,
}

/// Functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the mathematical functions of these names")]
pub enum UnaryFunction {
    Neg,
    Not,
    Abs,
    /// -1, 0 or 1.
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
    /// Largest whole number not above the argument; without event.
    Floor,
}

impl UnaryFunction {
    /// All of them.
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

/// Functions of two arguments.
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

/// Relations. `Gt` and `Ge` are written as `Lt` and `Le` with sides swapped where only the value counts; they stay as
/// written here so that messages show what the user wrote.
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

/// One node. Build nodes through the methods of [`Exprs`], which simplify and share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExprNode {
    /// A number, by its bits.
    Num(u64),
    /// Simulated time in seconds.
    Time,
    /// The value of a variable.
    Var(VarId),
    /// The time derivative of a variable.
    Der(VarId),
    /// The value of a discrete-valued variable before the event.
    Pre(VarId),
    /// A function of one argument.
    Unary(UnaryFunction, ExprId),
    /// A function of two arguments.
    Binary(BinaryFunction, ExprId, ExprId),
    /// A relation evaluated as it stands; makes no event (inside `noEvent`, or between discrete values).
    Rel(RelationalOp, ExprId, ExprId),
    /// A relation whose change is an event. `structure` replaces it by a discrete variable with a zero crossing.
    EventRel(RelationalOp, ExprId, ExprId),
    /// `floor` whose change is an event. `structure` replaces it by a discrete variable with zero crossings.
    EventFloor(ExprId),
    /// If the condition is not 0 the second, else the third. Only the chosen one need be finite.
    If(ExprId, ExprId, ExprId),
    /// True at `start + k interval`, k = 0, 1, ... Both are parameter expressions.
    Sample(ExprId, ExprId),
    /// `delay(a, time)`: the value so long ago, before the start that at the start; the time is a parameter expression.
    /// `structure` replaces it by an input that the run itself records.
    Delay(ExprId, ExprId),
    /// True during initialization.
    Initial,
    /// True at the end of a successful run.
    Terminal,
    /// `homotopy(actual, simplified)`.
    Homotopy(ExprId, ExprId),
    /// One output of a user function, with scalarised arguments.
    Call(FunctionId, u32, ArgumentRange),
}

/// Two words a node instead of one write per field: the pool is asked for every node of every equation. The bytes of
/// numbers are swapped, for small whole numbers differ in their highest bits only, which the hash would not spread.
impl Hash for ExprNode {
    fn hash<H: Hasher>(&self, state: &mut H) {
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

fn hash(node: &ExprNode) -> u64 {
    FxBuildHasher.hash_one(node)
}

/// A pool of expressions. Node 0 is the number 0 and node 1 the number 1.
#[derive(Clone, Debug)]
pub struct Exprs {
    nodes: Vec<ExprNode>,
    /// Where each node stands: the ids alone, for the nodes are in the list already.
    index: HashTable<ExprId>,
    /// The node of each variable's value, 0 for none: half of all requests are for these.
    leaves: Vec<ExprId>,
    args: Vec<ExprId>,
    arg_index: FxHashMap<Box<[ExprId]>, ArgumentRange>,
    /// The function that takes values and tangents and returns tangents, by original.
    tangents: FxHashMap<FunctionId, FunctionId>,
    /// The derivative of all outputs by one input, by original and input.
    partials: FxHashMap<(FunctionId, u32), FunctionId>,
    /// User functions that stay calls.
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
        pool.num(0.0);
        pool.num(1.0);
        pool
    }
}

impl Exprs {
    /// The number 0, also `false`.
    pub const ZERO: ExprId = ExprId(0);
    /// The number 1, also `true`.
    pub const ONE: ExprId = ExprId(1);

    /// The node behind an id.
    pub fn node(&self, e: ExprId) -> ExprNode {
        self.nodes[e.index()]
    }

    /// How many nodes there are; ids are `0..len`, and a node's arguments have smaller ids than the node.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never: the pool always holds 0 and 1.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The arguments of a call.
    pub fn args(&self, args: ArgumentRange) -> &[ExprId] {
        &self.args[args.start as usize..(args.start + args.len) as usize]
    }

    /// The id of exactly this node, without simplification.
    pub fn intern(&mut self, node: ExprNode) -> ExprId {
        let nodes = &self.nodes;
        let same = |e: &ExprId| nodes[e.index()] == node;
        match self.index.entry(hash(&node), same, |e| hash(&nodes[e.index()])) {
            Entry::Occupied(found) => *found.get(),
            Entry::Vacant(place) => {
                let e = ExprId(u32::try_from(nodes.len()).expect("fewer than 2^32 nodes"));
                place.insert(e);
                self.nodes.push(node);
                e
            }
        }
    }

    /// The id of exactly this node, if it is there.
    fn find(&self, node: &ExprNode) -> Option<ExprId> {
        self.index.find(hash(node), |e| self.nodes[e.index()] == *node).copied()
    }

    /// The value, if the node is a number.
    pub fn as_num(&self, e: ExprId) -> Option<f64> {
        match self.node(e) {
            ExprNode::Num(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// A number. Minus zero becomes zero so that equal numbers are one node.
    pub fn num(&mut self, value: f64) -> ExprId {
        let value = if value == 0.0 { 0.0 } else { value };
        self.intern(ExprNode::Num(value.to_bits()))
    }

    /// A truth value.
    pub fn boolean(&mut self, value: bool) -> ExprId {
        if value { Self::ONE } else { Self::ZERO }
    }

    /// Time.
    pub fn time(&mut self) -> ExprId {
        self.intern(ExprNode::Time)
    }

    /// The value of a variable.
    pub fn var(&mut self, v: VarId) -> ExprId {
        match self.leaves.get(v.index()) {
            Some(&e) if e != Self::ZERO => e,
            _ => self.new_leaf(v),
        }
    }

    fn new_leaf(&mut self, v: VarId) -> ExprId {
        let (e, known) = (self.intern(ExprNode::Var(v)), self.leaves.len());
        // locals of functions have numbers far away
        if v.index() < 2 * known + 1024 {
            self.leaves.resize(known.max(v.index() + 1), Self::ZERO);
            self.leaves[v.index()] = e;
        }
        e
    }

    /// The derivative of a variable.
    pub fn der(&mut self, v: VarId) -> ExprId {
        self.intern(ExprNode::Der(v))
    }

    /// The value of a variable before the event.
    pub fn pre(&mut self, v: VarId) -> ExprId {
        self.intern(ExprNode::Pre(v))
    }

    /// A call of a user function; one node per output.
    pub fn call(&mut self, function: FunctionId, output: u32, args: &[ExprId]) -> ExprId {
        let args = self.intern_args(args);
        self.intern(ExprNode::Call(function, output, args))
    }

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
