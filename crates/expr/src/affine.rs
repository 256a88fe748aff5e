//! Affine expressions, `e = coefficient*leaf + rest` with both parts free of the leaf, and equations solved for a leaf.
//! `structure` solves linear equations by them, where the structure of an expression shows that it is affine.

use super::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};
use rustc_hash::FxHashMap;

/// The parts of an affine expression `coefficient*leaf + rest`. Both are free of the leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AffineForm {
    /// The factor of the leaf. It may be an expression.
    pub coefficient: ExprId,
    /// The part without the leaf.
    pub rest: ExprId,
}

impl Exprs {
    /// `e` as an affine expression of `leaf`. `None` if its structure does not show that it is one.
    /// The coefficient is 0 if `e` does not depend on the leaf.
    pub fn linear_in(&mut self, e: ExprId, leaf: ExprId) -> Option<AffineForm> {
        // A node that is not in the map is free of the leaf.
        let mut parts: FxHashMap<ExprId, AffineForm> = FxHashMap::default();
        parts.insert(leaf, AffineForm { coefficient: Self::ONE, rest: Self::ZERO });
        // Operands have smaller ids, so no node with a smaller id than the leaf can contain it.
        for node in self.reachable(&[e], |node| node > leaf) {
            let operands = self.operands(node);
            if operands.as_slice().iter().any(|operand| parts.contains_key(operand)) {
                let part = self.affine_node(node, &parts)?;
                parts.insert(node, part);
            }
        }
        Some(parts.get(&e).copied().unwrap_or(AffineForm { coefficient: Self::ZERO, rest: e }))
    }

    /// Solves `lhs = rhs` for `leaf`: its value, and the coefficient that it was divided by.
    /// `None` if the equation is not affine in the leaf, or the coefficient is the number 0.
    /// The value has no meaning where the coefficient vanishes during the run.
    pub fn solve_for(&mut self, lhs: ExprId, rhs: ExprId, leaf: ExprId) -> Option<(ExprId, ExprId)> {
        let left = self.linear_in(lhs, leaf)?;
        let right = self.linear_in(rhs, leaf)?;
        let coefficient = self.sub(left.coefficient, right.coefficient);
        if coefficient == Self::ZERO {
            return None;
        }
        let rest = self.sub(right.rest, left.rest);
        Some((self.div(rest, coefficient), coefficient))
    }

    /// A node as affine expression, from those of its operands. At least one operand contains the leaf.
    /// `None` if the node is not affine in it.
    /// Products and quotients are affine only if the other operand is free of the leaf.
    fn affine_node(&mut self, node: ExprId, parts: &FxHashMap<ExprId, AffineForm>) -> Option<AffineForm> {
        let of = |e: ExprId| parts.get(&e).copied().unwrap_or(AffineForm { coefficient: Self::ZERO, rest: e });
        let free = |e: ExprId| !parts.contains_key(&e);
        match self.node(node) {
            ExprNode::Unary(UnaryFunction::Neg, a) => Some(self.each_part(of(a), of(a), |pool, x, _| pool.neg(x))),
            ExprNode::Binary(op @ (BinaryFunction::Add | BinaryFunction::Sub), a, b) => {
                Some(self.each_part(of(a), of(b), |pool, x, y| pool.binary(op, x, y)))
            }
            // The factor that is free of the leaf multiplies both parts.
            ExprNode::Binary(BinaryFunction::Mul, a, b) if free(b) => {
                Some(self.each_part(of(a), of(a), |pool, x, _| pool.mul(x, b)))
            }
            ExprNode::Binary(BinaryFunction::Mul, a, b) if free(a) => {
                Some(self.each_part(of(b), of(b), |pool, x, _| pool.mul(a, x)))
            }
            ExprNode::Binary(BinaryFunction::Div, a, b) if free(b) => {
                Some(self.each_part(of(a), of(a), |pool, x, _| pool.div(x, b)))
            }
            // With a condition that contains the leaf there is a kink or jump.
            ExprNode::If(c, a, b) if free(c) => Some(self.each_part(of(a), of(b), |pool, x, y| pool.if_(c, x, y))),
            ExprNode::Homotopy(a, b) => Some(self.each_part(of(a), of(b), Exprs::homotopy)),
            _ => None,
        }
    }

    /// Applies an operation to the coefficients and to the rests of two affine expressions.
    /// `change` builds one part from the parts of both operands.
    fn each_part(
        &mut self,
        a: AffineForm,
        b: AffineForm,
        mut change: impl FnMut(&mut Exprs, ExprId, ExprId) -> ExprId,
    ) -> AffineForm {
        AffineForm { coefficient: change(self, a.coefficient, b.coefficient), rest: change(self, a.rest, b.rest) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RelationalOp, VarId};

    fn vars(p: &mut Exprs) -> (ExprId, ExprId, ExprId) {
        (p.var(VarId(0)), p.var(VarId(1)), p.var(VarId(2)))
    }

    #[test]
    fn lone_leaves_and_free_expressions() {
        let mut p = Exprs::default();
        let (x, a, _) = vars(&mut p);
        assert_eq!(p.linear_in(x, x), Some(AffineForm { coefficient: Exprs::ONE, rest: Exprs::ZERO }));
        assert_eq!(p.linear_in(a, x), Some(AffineForm { coefficient: Exprs::ZERO, rest: a }));
        assert_eq!(p.solve_for(x, a, x), Some((a, Exprs::ONE)));
        assert_eq!(p.solve_for(a, a, x), None);
    }

    #[test]
    fn sums_and_products_solve() {
        let mut p = Exprs::default();
        let (x, a, b) = vars(&mut p);
        let product = p.mul(a, x);
        let left = p.sub(product, b);
        let (value, coefficient) = p.solve_for(left, Exprs::ZERO, x).expect("affine");
        let expected = p.div(b, a);
        assert_eq!((value, coefficient), (expected, a));
        let sum = p.add(a, b);
        let minus_x = p.neg(x);
        let minus_sum = p.neg(sum);
        assert_eq!(p.solve_for(minus_x, sum, x).map(|found| found.0), Some(minus_sum));
    }

    #[test]
    fn branches_stay_affine_and_conditions_do_not() {
        let mut p = Exprs::default();
        let (x, a, b) = vars(&mut p);
        let c = p.rel(RelationalOp::Lt, a, b);
        let branch = p.if_(c, x, a);
        let affine = p.linear_in(branch, x).expect("affine");
        let coefficient = p.if_(c, Exprs::ONE, Exprs::ZERO);
        assert_eq!(affine.coefficient, coefficient);
        let on_x = p.rel(RelationalOp::Lt, x, b);
        let kink = p.if_(on_x, x, a);
        assert_eq!(p.linear_in(kink, x), None);
        let square = p.mul(x, x);
        assert_eq!(p.linear_in(square, x), None);
    }
}
