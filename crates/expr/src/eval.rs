//! Evaluates expressions on numbers. This is the reference for the kernels of the crate `solve`.
//!
//! Each node is computed once, and of an `if` only the branch that is taken. Relations are evaluated as they stand,
//! with
//! or without event; `homotopy` gives its first operand. Deep expressions do not recurse.

use super::{ExprId, ExprNode, Exprs, math};
use rustc_hash::FxHashMap;

/// The values of nodes. It is valid as long as the values of the leaves do not change.
#[derive(Clone, Debug, Default)]
pub struct EvaluationCache {
    /// The value of each node computed so far.
    values: FxHashMap<ExprId, f64>,
    /// Nodes to be computed; those on top are needed for those below.
    stack: Vec<ExprId>,
}

impl EvaluationCache {
    /// The value of `e`. `leaf` gives the values of `Time`, `Var`, `Der`, `Pre`, `Sample`, `Initial` and `Terminal`
    /// nodes.
    pub fn value(&mut self, pool: &Exprs, e: ExprId, leaf: &mut impl FnMut(ExprNode) -> f64) -> f64 {
        self.stack.push(e);
        while let Some(&top) = self.stack.last() {
            if self.values.contains_key(&top) || self.finish(pool, top, leaf) {
                self.stack.pop();
            }
        }
        self.values[&e]
    }

    /// Computes a node if its operands are known, and returns true.
    /// Else it pushes the operands that are needed and returns false.
    fn finish(&mut self, pool: &Exprs, e: ExprId, leaf: &mut impl FnMut(ExprNode) -> f64) -> bool {
        let node = pool.node(e);
        let value = match node {
            // The condition is needed first, as it decides which branch is evaluated.
            ExprNode::If(c, a, b) => {
                let Some(&c) = self.values.get(&c) else {
                    self.stack.push(c);
                    return false;
                };
                self.known(if c == 0.0 { b } else { a })
            }
            // At rest a delayed value is the value itself.
            ExprNode::Homotopy(a, _) | ExprNode::Delay(a, _) => self.known(a),
            ExprNode::Num(bits) => Some(f64::from_bits(bits)),
            ExprNode::Time | ExprNode::Var(_) | ExprNode::Der(_) | ExprNode::Pre(_) => Some(leaf(node)),
            ExprNode::Sample(..) | ExprNode::Initial | ExprNode::Terminal => Some(leaf(node)),
            _ => {
                // Unknown operands are pushed, and the node is tried again once they are known.
                let operands = pool.operands(e);
                let missing = operands.as_slice().iter().rev().filter(|operand| !self.values.contains_key(operand));
                let before = self.stack.len();
                self.stack.extend(missing);
                (self.stack.len() == before).then(|| self.combine(pool, e))
            }
        };
        if let Some(value) = value {
            self.values.insert(e, value);
        }
        value.is_some()
    }

    /// The value of a node, which is pushed to be computed first if it is not known.
    /// `None` if it was pushed.
    fn known(&mut self, e: ExprId) -> Option<f64> {
        let value = self.values.get(&e).copied();
        if value.is_none() {
            self.stack.push(e);
        }
        value
    }

    /// The value of a node from those of its operands.
    /// All operands must be known.
    fn combine(&self, pool: &Exprs, e: ExprId) -> f64 {
        let of = |a: ExprId| self.values[&a];
        match pool.node(e) {
            ExprNode::Unary(op, a) => math::unary(op, of(a)),
            ExprNode::Binary(op, a, b) => math::binary(op, of(a), of(b)),
            ExprNode::Rel(rel, a, b) | ExprNode::EventRel(rel, a, b) => math::truth(math::holds(rel, of(a), of(b))),
            ExprNode::EventFloor(a) => math::floor(of(a)),
            ExprNode::Call(function, output, args) => {
                let function = &pool.functions[function.0 as usize];
                let args: Vec<f64> = pool.args(args).iter().map(|&arg| of(arg)).collect();
                let mut out = vec![f64::NAN; function.outputs.len()];
                function.call(&pool.functions, &args, &mut out);
                out[output as usize]
            }
            // `finish` has handled all other kinds of nodes.
            _ => unreachable!("leaves, `if` and `homotopy` are computed where they are found"),
        }
    }
}

impl Exprs {
    /// The value of `e`. `leaf` gives the values of the leaves, as for [`EvaluationCache::value`].
    #[inline]
    pub fn eval(&self, e: ExprId, leaf: &mut impl FnMut(ExprNode) -> f64) -> f64 {
        EvaluationCache::default().value(self, e, leaf)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Exprs, RelationalOp, VarId};

    #[test]
    fn only_the_chosen_branch_is_evaluated() {
        let mut p = Exprs::default();
        let (x, y) = (p.var(VarId(0)), p.var(VarId(1)));
        let positive = p.rel(RelationalOp::Gt, x, Exprs::ZERO);
        let e = p.if_(positive, x, y);
        let mut asked = Vec::new();
        let value = p.eval(e, &mut |node| {
            asked.push(node);
            3.0
        });
        assert_eq!((value, asked), (3.0, vec![p.node(x)]));
    }

    #[test]
    fn deep_sums_evaluate() {
        let mut p = Exprs::default();
        let mut sum = p.time();
        for i in 0..100_000 {
            let x = p.var(VarId(i));
            sum = p.add(x, sum);
        }
        assert_eq!(p.eval(sum, &mut |_| 1.0), 100_001.0);
    }
}
