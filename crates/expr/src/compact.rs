//! Removes nodes that nothing refers to any more. The crate `model` calls this when its stages have left many behind.

use super::{ExprId, ExprNode, Exprs};

impl Exprs {
    /// Keeps only the nodes that the roots reach, and changes the roots to the new ids. All other ids become invalid.
    /// Functions are kept.
    pub fn compact(&mut self, roots: &mut [&mut ExprId]) {
        let wanted: Vec<ExprId> = roots.iter().map(|r| **r).collect();
        let mut fresh = Exprs {
            // Functions refer to no nodes, so they move unchanged.
            functions: std::mem::take(&mut self.functions),
            tangents: std::mem::take(&mut self.tangents),
            partials: std::mem::take(&mut self.partials),
            ..Exprs::default()
        };
        // The new id of each old node. Operands have smaller ids, so theirs are known in time.
        let mut place = vec![Exprs::ZERO; self.len()];
        for e in self.reachable(&wanted, |_| true) {
            place[e.index()] = fresh.copied(self, e, &place);
        }
        for root in roots {
            **root = place[root.index()];
        }
        *self = fresh;
    }

    /// Adds a node of the old pool to this one. `place` has the new ids of its operands.
    /// All nodes that it refers to must have been copied before.
    fn copied(&mut self, from: &Exprs, e: ExprId, place: &[ExprId]) -> ExprId {
        let to = |e: ExprId| place[e.index()];
        let node = match from.node(e) {
            ExprNode::Unary(op, a) => ExprNode::Unary(op, to(a)),
            ExprNode::Binary(op, a, b) => ExprNode::Binary(op, to(a), to(b)),
            ExprNode::Rel(rel, a, b) => ExprNode::Rel(rel, to(a), to(b)),
            ExprNode::EventRel(rel, a, b) => ExprNode::EventRel(rel, to(a), to(b)),
            ExprNode::EventFloor(a) => ExprNode::EventFloor(to(a)),
            ExprNode::If(c, a, b) => ExprNode::If(to(c), to(a), to(b)),
            ExprNode::Sample(a, b) => ExprNode::Sample(to(a), to(b)),
            ExprNode::Delay(a, b) => ExprNode::Delay(to(a), to(b)),
            ExprNode::Homotopy(a, b) => ExprNode::Homotopy(to(a), to(b)),
            ExprNode::Call(function, output, args) => {
                let args: Vec<ExprId> = from.args(args).iter().map(|&a| to(a)).collect();
                return self.call(function, output, &args);
            }
            leaf => leaf,
        };
        // Without simplification: the node was simplified when it was built.
        self.intern(node)
    }
}
