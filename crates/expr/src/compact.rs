//! A pool without the nodes that nothing refers to any more.

use super::{ExprId, ExprNode, Exprs};

impl Exprs {
    /// Keeps only what the roots reach, and rewrites them.
    pub fn compact(&mut self, roots: &mut [&mut ExprId]) {
        let wanted: Vec<ExprId> = roots.iter().map(|r| **r).collect();
        let mut fresh = Exprs {
            functions: std::mem::take(&mut self.functions),
            tangents: std::mem::take(&mut self.tangents),
            partials: std::mem::take(&mut self.partials),
            ..Exprs::default()
        };
        let mut place = vec![Exprs::ZERO; self.len()];
        for e in self.reachable(&wanted, |_| true) {
            place[e.index()] = fresh.copied(self, e, &place);
        }
        for root in roots {
            **root = place[root.index()];
        }
        *self = fresh;
    }

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
        self.intern(node)
    }
}
