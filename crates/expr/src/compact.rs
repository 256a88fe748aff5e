//! A pool without the nodes that nothing refers to any more.

use super::{ExprId, Exprs, Node};

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
            Node::Unary(op, a) => Node::Unary(op, to(a)),
            Node::Binary(op, a, b) => Node::Binary(op, to(a), to(b)),
            Node::Rel(rel, a, b) => Node::Rel(rel, to(a), to(b)),
            Node::EventRel(rel, a, b) => Node::EventRel(rel, to(a), to(b)),
            Node::EventFloor(a) => Node::EventFloor(to(a)),
            Node::If(c, a, b) => Node::If(to(c), to(a), to(b)),
            Node::Sample(a, b) => Node::Sample(to(a), to(b)),
            Node::Delay(a, b) => Node::Delay(to(a), to(b)),
            Node::Homotopy(a, b) => Node::Homotopy(to(a), to(b)),
            Node::Call(function, output, args) => {
                let args: Vec<ExprId> = from.args(args).iter().map(|&a| to(a)).collect();
                return self.call(function, output, &args);
            }
            leaf => leaf,
        };
        self.intern(node)
    }
}
