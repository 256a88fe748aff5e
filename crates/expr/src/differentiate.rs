//! Exact derivatives: partial ones by a leaf, and the total one by time.

use super::rules::{self, ExprAlgebra};
use super::{ArgumentRange, BinaryFunction, ExprId, ExprNode, Exprs, FunctionId, RelationalOp, UnaryFunction, VarId};
use rustc_hash::FxHashMap;

/// A leaf whose time derivative depends on the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DerivativeLeaf {
    /// The value of a variable.
    Var(VarId),
    /// The time derivative of a variable.
    Der(VarId),
}

/// Partial derivatives by one leaf; every other leaf counts as constant. One value serves any number of expressions of
/// one pool and remembers what it has done, so that shared parts are differentiated once.
#[derive(Clone, Debug)]
pub struct Differentiator {
    memo: FxHashMap<ExprId, ExprId>,
}

impl Differentiator {
    /// Derivatives by `leaf`: `pool.var(v)`, `pool.der(v)`, `pool.pre(v)`, or any other node taken as a unit.
    pub fn new(leaf: ExprId) -> Self {
        Differentiator { memo: std::iter::once((leaf, Exprs::ONE)).collect() }
    }

    /// Derivatives along a direction: pairs of leaves and their derivatives, every other leaf counting as constant.
    pub fn along(leaves: impl IntoIterator<Item = (ExprId, ExprId)>) -> Self {
        Differentiator { memo: leaves.into_iter().collect() }
    }

    /// The derivative of `e`.
    pub fn derive(&mut self, pool: &mut Exprs, e: ExprId) -> ExprId {
        for node in pool.reachable(&[e], |node| !self.memo.contains_key(&node)) {
            let derivative = node_derivative(pool, node, &self.memo);
            self.memo.insert(node, derivative);
        }
        self.memo[&e]
    }
}

/// Total derivatives by time. One value serves any number of expressions of one pool, as [`Differentiator`] does.
#[derive(Clone, Debug, Default)]
pub struct TimeDerivative {
    memo: FxHashMap<ExprId, ExprId>,
}

impl TimeDerivative {
    /// The time derivative of `e`. `leaf` says what the derivative of a variable or of a derivative is: another
    /// expression, 0 for what is constant between events, or `None` for what cannot be differentiated, which is then
    /// the error.
    pub fn derive(
        &mut self,
        pool: &mut Exprs,
        e: ExprId,
        leaf: &mut impl FnMut(&mut Exprs, DerivativeLeaf) -> Option<ExprId>,
    ) -> Result<ExprId, DerivativeLeaf> {
        for node in pool.reachable(&[e], |node| !self.memo.contains_key(&node)) {
            let derivative = match pool.node(node) {
                ExprNode::Time => Exprs::ONE,
                ExprNode::Delay(a, time) => pool.delay(self.memo[&a], time),
                ExprNode::Var(v) => leaf(pool, DerivativeLeaf::Var(v)).ok_or(DerivativeLeaf::Var(v))?,
                ExprNode::Der(v) => leaf(pool, DerivativeLeaf::Der(v)).ok_or(DerivativeLeaf::Der(v))?,
                _ => node_derivative(pool, node, &self.memo),
            };
            self.memo.insert(node, derivative);
        }
        Ok(self.memo[&e])
    }
}

impl Exprs {
    /// The derivative of `e` by `leaf`, as [`Differentiator`] computes it.
    pub fn differentiate(&mut self, e: ExprId, leaf: ExprId) -> ExprId {
        Differentiator::new(leaf).derive(self, e)
    }

    /// The derivative of `e` by time, as [`TimeDerivative`] computes it.
    pub fn time_derivative(
        &mut self,
        e: ExprId,
        leaf: &mut impl FnMut(&mut Exprs, DerivativeLeaf) -> Option<ExprId>,
    ) -> Result<ExprId, DerivativeLeaf> {
        TimeDerivative::default().derive(self, e, leaf)
    }
}

/// The derivative of a node whose arguments' derivatives are known. Leaves are constant.
fn node_derivative(pool: &mut Exprs, e: ExprId, memo: &FxHashMap<ExprId, ExprId>) -> ExprId {
    let of = |a: ExprId| Some(memo[&a]).filter(|&d| d != Exprs::ZERO);
    let derivative = match pool.node(e) {
        ExprNode::Unary(op, a) => of(a).and_then(|da| rules::unary(pool, op, &a, &e, da)),
        ExprNode::Binary(op, a, b) => rules::binary(pool, op, (&a, &b, &e), of(a), of(b)),
        ExprNode::If(c, a, b) => rules::branch(pool, c, of(a), of(b)),
        ExprNode::Homotopy(a, b) => Some(pool.homotopy(memo[&a], memo[&b])),
        ExprNode::Call(function, output, args) => Some(call_derivative(pool, function, output, args, memo)),
        _ => None,
    };
    derivative.unwrap_or(Exprs::ZERO)
}

/// The sum over the arguments of the function's derivative times the argument's.
fn call_derivative(
    pool: &mut Exprs,
    function: FunctionId,
    output: u32,
    args: ArgumentRange,
    memo: &FxHashMap<ExprId, ExprId>,
) -> ExprId {
    let args = pool.args(args).to_vec();
    let mut sum = Exprs::ZERO;
    for (input, arg) in (0..).zip(&args) {
        let inner = memo[arg];
        if inner != Exprs::ZERO {
            let partial = pool.derivative_function(function, input);
            let outer = pool.call(partial, output, &args);
            let term = pool.mul(outer, inner);
            sum = pool.add(sum, term);
        }
    }
    sum
}

impl ExprAlgebra for Exprs {
    type E = ExprId;

    fn num(&mut self, value: f64) -> ExprId {
        Exprs::num(self, value)
    }
    fn unary(&mut self, op: UnaryFunction, a: ExprId) -> ExprId {
        Exprs::unary(self, op, a)
    }
    fn binary(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> ExprId {
        Exprs::binary(self, op, a, b)
    }
    fn rel(&mut self, rel: RelationalOp, a: ExprId, b: ExprId) -> ExprId {
        Exprs::rel(self, rel, a, b)
    }
    fn if_(&mut self, c: ExprId, a: ExprId, b: ExprId) -> ExprId {
        Exprs::if_(self, c, a, b)
    }
}

#[cfg(test)]
#[path = "differentiate_tests.rs"]
mod tests;
