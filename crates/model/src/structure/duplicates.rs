//! Common subexpressions between assignments: what is computed twice.
//!
//! Where several components join, each computes the density of the oil there. In the sorted system the later of two
//! equal assignments takes the value of the earlier one, and so do the users of its variable, which makes more
//! assignments equal.
//!
//! Enters and leaves: the blocks of the continuous system. `analysis` calls [`share`] after sorting. Shared before
//! sorting, the common variable would be a worse place to tear loops.

use super::{BltBlock, ExplicitAssignment, Unknown};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::FxHashMap;

/// Lets equal assignments share their value, in the order of the blocks. `behind` are expressions that are read after
/// all blocks; they are rewritten too.
///
/// An example: `a := rho(p)`, `b := rho(p)`, `c := b + 1` become `a := rho(p)`, `b := a`, `c := a + 1`.
pub(super) fn share<'e>(exprs: &mut Exprs, blocks: &mut [BltBlock], behind: impl Iterator<Item = &'e mut ExprId>) {
    let mut shared = CommonExpressions { exprs, first: FxHashMap::default(), images: FxHashMap::default() };
    for block in blocks {
        match block {
            BltBlock::Assign(assign) => shared.assign(assign),
            BltBlock::Loop(l) => {
                l.inner.iter_mut().for_each(|assign| shared.assign(assign));
                for (residual, _) in &mut l.residuals {
                    *residual = shared.image(*residual);
                }
            }
            // The continuous system, the only one that this is called for, has no mixed loops.
            BltBlock::Mixed(_) => {}
        }
    }
    behind.for_each(|e| *e = shared.read(*e));
}

/// What has been computed so far.
struct CommonExpressions<'a> {
    /// The pool.
    exprs: &'a mut Exprs,
    /// By value: the variable that has it already.
    first: FxHashMap<ExprId, VarId>,
    /// Expressions in terms of the variables that stay. It is empty until two assignments are equal. A variable is
    /// replaced from its second assignment on; no expression before that contains it.
    images: FxHashMap<ExprId, ExprId>,
}

impl CommonExpressions<'_> {
    /// Rewrites one assignment and records its value. Only values worth sharing count: operations, conditions and
    /// calls.
    fn assign(&mut self, assign: &mut ExplicitAssignment) {
        assign.value = self.image(assign.value);
        let Unknown::Var(v) = assign.unknown else { return };
        if !matches!(
            self.exprs.node(assign.value),
            ExprNode::Unary(..) | ExprNode::Binary(..) | ExprNode::If(..) | ExprNode::Call(..)
        ) {
            return;
        }
        match self.first.get(&assign.value) {
            None => {
                self.first.insert(assign.value, v);
            }
            Some(&same) => {
                assign.value = self.exprs.var(same);
                let replaced = self.exprs.var(v);
                self.images.insert(replaced, assign.value);
            }
        }
    }

    /// Rewrites an expression with variables in the place of all parts that an assignment has computed.
    fn read(&mut self, e: ExprId) -> ExprId {
        let e = self.image(e);
        let mut images: FxHashMap<ExprId, ExprId> = FxHashMap::default();
        for part in self.exprs.reachable(&[e], |_| true) {
            let image = match self.first.get(&part) {
                // The expression itself may be the value of an assignment; it stays an expression of parts.
                Some(&v) if part != e => self.exprs.var(v),
                _ => {
                    let operands = self.exprs.operands(part);
                    let operands: Vec<(ExprId, ExprId)> = operands.as_slice().iter().map(|a| (*a, images[a])).collect();
                    image_of(self.exprs, part, &operands)
                }
            };
            images.insert(part, image);
        }
        images[&e]
    }

    /// Rewrites an expression in terms of the variables that stay. The images of all its parts are kept for later
    /// calls.
    fn image(&mut self, e: ExprId) -> ExprId {
        if self.images.is_empty() {
            return e;
        }
        for part in self.exprs.reachable(&[e], |part| !self.images.contains_key(&part)) {
            let image = match self.exprs.operands(part).as_slice() {
                [] => part,
                operands => {
                    let images: Vec<(ExprId, ExprId)> = operands.iter().map(|a| (*a, self.images[a])).collect();
                    image_of(self.exprs, part, &images)
                }
            };
            self.images.insert(part, image);
        }
        self.images[&e]
    }
}

/// A node with replaced operands; the node itself where no operand changes.
fn image_of(exprs: &mut Exprs, e: ExprId, operands: &[(ExprId, ExprId)]) -> ExprId {
    if operands.iter().all(|(a, b)| a == b) {
        return e;
    }
    let change = |a: ExprId| operands.iter().find(|(from, _)| *from == a).map_or(a, |(_, to)| *to);
    exprs.with_operands(e, change)
}
