//! Reference evaluation over the pool.
//!
//! Each node is computed once; of an `if` only the chosen branch is. Relations with and without event are evaluated as
//! they stand, `homotopy` gives its first argument. Deep expressions do not recurse.

use super::{ExprId, ExprNode, Exprs, math};
use rustc_hash::FxHashMap;

/// Remembers the values of nodes while the leaves stay as they are.
#[derive(Clone, Debug, Default)]
pub struct EvaluationCache {
    values: FxHashMap<ExprId, f64>,
    stack: Vec<ExprId>,
}

impl EvaluationCache {
    /// The value of `e`. `leaf` gives the values of `Time`, `Var`, `Der`, `Pre`, `Sample`, `Initial` and `Terminal`.
    pub fn value(&mut self, pool: &Exprs, e: ExprId, leaf: &mut impl FnMut(ExprNode) -> f64) -> f64 {
        self.stack.push(e);
        while let Some(&top) = self.stack.last() {
            if self.values.contains_key(&top) || self.finish(pool, top, leaf) {
                self.stack.pop();
            }
        }
        self.values[&e]
    }

    /// Computes a node whose arguments are known; else puts those on the stack that are needed first and says false.
    fn finish(&mut self, pool: &Exprs, e: ExprId, leaf: &mut impl FnMut(ExprNode) -> f64) -> bool {
        let node = pool.node(e);
        let value = match node {
            ExprNode::If(c, a, b) => {
                let Some(&c) = self.values.get(&c) else {
                    self.stack.push(c);
                    return false;
                };
                self.known(if c == 0.0 { b } else { a })
            }
            // at rest a delayed value is the value
            ExprNode::Homotopy(a, _) | ExprNode::Delay(a, _) => self.known(a),
            ExprNode::Num(bits) => Some(f64::from_bits(bits)),
            ExprNode::Time | ExprNode::Var(_) | ExprNode::Der(_) | ExprNode::Pre(_) => Some(leaf(node)),
            ExprNode::Sample(..) | ExprNode::Initial | ExprNode::Terminal => Some(leaf(node)),
            _ => {
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

    fn known(&mut self, e: ExprId) -> Option<f64> {
        let value = self.values.get(&e).copied();
        if value.is_none() {
            self.stack.push(e);
        }
        value
    }

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
            _ => unreachable!("leaves, `if` and `homotopy` are computed where they are found"),
        }
    }
}

impl Exprs {
    /// The value of `e`, given those of the leaves as [`EvaluationCache::value`] asks for them.
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
