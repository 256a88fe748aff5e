//! Exact symbolic derivatives: partial ones by a leaf or along a direction, and total ones by time.
//! `structure` reduces the index by time derivatives; `solve` makes Jacobians of partial ones.
//! The rules for each function are in `rules`; calls use the derivative functions of `tangent`.

use super::rules::{self, ExprAlgebra};
use super::{ArgumentRange, BinaryFunction, ExprId, ExprNode, Exprs, FunctionId, RelationalOp, UnaryFunction, VarId};
use rustc_hash::FxHashMap;

/// A leaf whose time derivative only the model can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DerivativeLeaf {
    /// The value of a variable.
    Var(VarId),
    /// The time derivative of a variable.
    Der(VarId),
}

/// Partial derivatives by one leaf. Every other leaf counts as constant.
/// One value serves any number of expressions of one pool, and remembers the derivatives of all nodes, so that shared
/// subexpressions are differentiated once.
#[derive(Clone, Debug)]
pub struct Differentiator {
    /// The derivative of each node seen so far.
    memo: FxHashMap<ExprId, ExprId>,
}

impl Differentiator {
    /// Derivatives by `leaf`: `pool.var(v)`, `pool.der(v)`, `pool.pre(v)`, or any other node that is to count as a
    /// leaf.
    pub fn new(leaf: ExprId) -> Self {
        Differentiator { memo: std::iter::once((leaf, Exprs::ONE)).collect() }
    }

    /// Derivatives along a direction, given by pairs of a leaf and its derivative. Other leaves count as constant.
    pub fn along(leaves: impl IntoIterator<Item = (ExprId, ExprId)>) -> Self {
        Differentiator { memo: leaves.into_iter().collect() }
    }

    /// The derivative of `e`.
    pub fn derive(&mut self, pool: &mut Exprs, e: ExprId) -> ExprId {
        // Operands come before their node, and what is known is not entered again.
        for node in pool.reachable(&[e], |node| !self.memo.contains_key(&node)) {
            let derivative = node_derivative(pool, node, &self.memo);
            self.memo.insert(node, derivative);
        }
        self.memo[&e]
    }
}

/// Total derivatives by time. One value serves any number of expressions of one pool, as for [`Differentiator`].
#[derive(Clone, Debug, Default)]
pub struct TimeDerivative {
    /// The time derivative of each node seen so far.
    memo: FxHashMap<ExprId, ExprId>,
}

impl TimeDerivative {
    /// The time derivative of `e`.
    /// `leaf` gives the derivative of a variable or of a derivative: another expression, or 0 for what is constant
    /// between
    /// events.
    ///
    /// # Errors
    /// `leaf` returned `None` for the leaf in the error, which cannot be differentiated.
    pub fn derive(
        &mut self,
        pool: &mut Exprs,
        e: ExprId,
        leaf: &mut impl FnMut(&mut Exprs, DerivativeLeaf) -> Option<ExprId>,
    ) -> Result<ExprId, DerivativeLeaf> {
        for node in pool.reachable(&[e], |node| !self.memo.contains_key(&node)) {
            let derivative = match pool.node(node) {
                ExprNode::Time => Exprs::ONE,
                // The delay time is a parameter, so the derivative is delayed like the value.
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
    /// The derivative of `e` by `leaf`. For many derivatives a [`Differentiator`] is faster.
    pub fn differentiate(&mut self, e: ExprId, leaf: ExprId) -> ExprId {
        Differentiator::new(leaf).derive(self, e)
    }

    /// The derivative of `e` by time. For many derivatives a [`TimeDerivative`] is faster.
    pub fn time_derivative(
        &mut self,
        e: ExprId,
        leaf: &mut impl FnMut(&mut Exprs, DerivativeLeaf) -> Option<ExprId>,
    ) -> Result<ExprId, DerivativeLeaf> {
        TimeDerivative::default().derive(self, e, leaf)
    }
}

/// The derivative of a node from those of its operands. Leaves count as constant.
/// `memo` has the derivatives of all operands.
fn node_derivative(pool: &mut Exprs, e: ExprId, memo: &FxHashMap<ExprId, ExprId>) -> ExprId {
    // The rules take `None` for a zero, and then build nothing for it.
    let of = |a: ExprId| Some(memo[&a]).filter(|&d| d != Exprs::ZERO);
    let derivative = match pool.node(e) {
        ExprNode::Unary(op, a) => of(a).and_then(|da| rules::unary(pool, op, &a, &e, da)),
        ExprNode::Binary(op, a, b) => rules::binary(pool, op, (&a, &b, &e), of(a), of(b)),
        // The condition has no derivative: at an event another branch is taken.
        ExprNode::If(c, a, b) => rules::branch(pool, c, of(a), of(b)),
        ExprNode::Homotopy(a, b) => Some(pool.homotopy(memo[&a], memo[&b])),
        ExprNode::Call(function, output, args) => Some(call_derivative(pool, function, output, args, memo)),
        _ => None,
    };
    derivative.unwrap_or(Exprs::ZERO)
}

/// The chain rule for a call: the sum over the arguments of the function's derivative times the argument's.
/// Each argument with a derivative adds one call of the derivative function by that input.
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
