//! Walking over expressions: what they depend on, replacing leaves, affine parts.
//!
//! Nothing here recurses, so a sum of a million terms is no danger; arguments have smaller ids than their node, so the
//! reachable nodes in the order of their ids are in an order of evaluation.

use super::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::{FxBuildHasher, FxHashMap, FxHashSet};

/// The arguments of one node.
#[derive(Clone, Copy, Debug)]
pub struct NodeOperands<'a> {
    few: [ExprId; 3],
    len: usize,
    many: &'a [ExprId],
}

impl NodeOperands<'_> {
    /// The arguments in order.
    pub fn as_slice(&self) -> &[ExprId] {
        if self.many.is_empty() { &self.few[..self.len] } else { self.many }
    }
}

/// The leaves of some expressions, each list sorted and without repetition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeafDependencies {
    /// Variables whose value occurs.
    pub vars: Vec<VarId>,
    /// Variables whose time derivative occurs.
    pub ders: Vec<VarId>,
    /// Variables whose value before the event occurs.
    pub pres: Vec<VarId>,
    /// Time occurs.
    pub time: bool,
}

/// A reusable record of visited nodes, for many walks over one pool.
#[derive(Clone, Debug, Default)]
pub struct NodeTraversal {
    marks: Vec<u32>,
    stamp: u32,
    stack: Vec<ExprId>,
}

impl NodeTraversal {
    /// Calls `visit` once for every node reachable from `roots`, parents before children. When `visit` says false, the
    /// arguments of that node are not followed.
    pub fn each(&mut self, pool: &Exprs, roots: &[ExprId], mut visit: impl FnMut(ExprId, ExprNode) -> bool) {
        if self.stamp == u32::MAX {
            self.marks.clear();
            self.stamp = 0;
        }
        self.stamp += 1;
        self.marks.resize(pool.len().max(self.marks.len()), 0);
        self.stack.clear();
        self.stack.extend(roots.iter().rev());
        while let Some(e) = self.stack.pop() {
            if std::mem::replace(&mut self.marks[e.index()], self.stamp) == self.stamp {
                continue;
            }
            if visit(e, pool.node(e)) {
                self.stack.extend(pool.operands(e).as_slice().iter().rev());
            }
        }
    }
}

impl Exprs {
    /// The arguments of a node; none for leaves.
    pub fn operands(&self, e: ExprId) -> NodeOperands<'_> {
        let none = Self::ZERO;
        let (few, len) = match self.node(e) {
            ExprNode::Num(_)
            | ExprNode::Time
            | ExprNode::Var(_)
            | ExprNode::Der(_)
            | ExprNode::Pre(_)
            | ExprNode::Initial
            | ExprNode::Terminal => ([none; 3], 0),
            ExprNode::Unary(_, a) | ExprNode::EventFloor(a) => ([a, none, none], 1),
            ExprNode::Binary(_, a, b)
            | ExprNode::Rel(_, a, b)
            | ExprNode::EventRel(_, a, b)
            | ExprNode::Sample(a, b)
            | ExprNode::Delay(a, b)
            | ExprNode::Homotopy(a, b) => ([a, b, none], 2),
            ExprNode::If(c, a, b) => ([c, a, b], 3),
            ExprNode::Call(_, _, args) => return NodeOperands { few: [none; 3], len: 0, many: self.args(args) },
        };
        NodeOperands { few, len, many: &[] }
    }

    /// The same node with other arguments, simplified.
    pub fn with_operands(&mut self, e: ExprId, mut change: impl FnMut(ExprId) -> ExprId) -> ExprId {
        match self.node(e) {
            ExprNode::Unary(op, a) => self.unary(op, change(a)),
            ExprNode::EventFloor(a) => self.event_floor(change(a)),
            ExprNode::Binary(op, a, b) => self.binary(op, change(a), change(b)),
            ExprNode::Rel(rel, a, b) => self.rel(rel, change(a), change(b)),
            ExprNode::EventRel(rel, a, b) => self.event_rel(rel, change(a), change(b)),
            ExprNode::Sample(a, b) => self.sample(change(a), change(b)),
            ExprNode::Delay(a, b) => self.delay(change(a), change(b)),
            ExprNode::Homotopy(a, b) => self.homotopy(change(a), change(b)),
            ExprNode::If(c, a, b) => self.if_(change(c), change(a), change(b)),
            ExprNode::Call(function, output, args) => {
                let args: Vec<ExprId> = self.args(args).to_vec().into_iter().map(change).collect();
                self.call(function, output, &args)
            }
            _ => e,
        }
    }

    /// All nodes reachable from `roots` for which `enter` says true, in an order of evaluation (arguments first).
    /// A node that is not entered is left out, and so is what only it leads to.
    pub fn reachable(&self, roots: &[ExprId], mut enter: impl FnMut(ExprId) -> bool) -> Vec<ExprId> {
        // most expressions are small: one allocation is enough for them
        let mut seen = FxHashSet::with_capacity_and_hasher(28, FxBuildHasher);
        let mut stack = Vec::with_capacity(28);
        stack.extend_from_slice(roots);
        let mut found = Vec::with_capacity(28);
        while let Some(e) = stack.pop() {
            if seen.insert(e) && enter(e) {
                found.push(e);
                stack.extend_from_slice(self.operands(e).as_slice());
            }
        }
        found.sort_unstable();
        found
    }

    /// How many different nodes an expression has.
    pub fn node_count(&self, e: ExprId) -> usize {
        self.reachable(&[e], |_| true).len()
    }

    /// Everything that the expressions depend on.
    pub fn dependencies(&self, roots: &[ExprId]) -> LeafDependencies {
        let mut found = LeafDependencies::default();
        for e in self.reachable(roots, |_| true) {
            match self.node(e) {
                ExprNode::Var(v) => found.vars.push(v),
                ExprNode::Der(v) => found.ders.push(v),
                ExprNode::Pre(v) => found.pres.push(v),
                ExprNode::Time => found.time = true,
                _ => {}
            }
        }
        found.vars.sort_unstable();
        found.ders.sort_unstable();
        found.pres.sort_unstable();
        found
    }

    /// The variables whose value occurs, sorted.
    pub fn variables(&self, e: ExprId) -> Vec<VarId> {
        self.dependencies(&[e]).vars
    }

    /// The variables whose time derivative occurs, sorted.
    pub fn derivatives(&self, e: ExprId) -> Vec<VarId> {
        self.dependencies(&[e]).ders
    }

    /// Whether `part` occurs in `e` (or is `e`).
    pub fn contains(&self, e: ExprId, part: ExprId) -> bool {
        let mut found = false;
        self.reachable(&[e], |node| {
            found |= node == part;
            // Arguments have smaller ids, so below a smaller id there is nothing to find.
            !found && node > part
        });
        found
    }

    /// `e` with parts replaced; see [`Substitution`].
    pub fn substitute(&mut self, e: ExprId, replacements: &[(ExprId, ExprId)]) -> ExprId {
        Substitution::new(replacements.iter().copied()).apply(self, e)
    }
}

/// Replaces parts of expressions by others. What is put in is not searched again. One value serves any number of
/// expressions of one pool and remembers what it has done.
#[derive(Clone, Debug, Default)]
pub struct Substitution {
    memo: FxHashMap<ExprId, ExprId>,
}

impl Substitution {
    /// Replaces each first by its second.
    pub fn new(replacements: impl IntoIterator<Item = (ExprId, ExprId)>) -> Self {
        Substitution { memo: replacements.into_iter().collect() }
    }

    /// The expression with everything replaced.
    pub fn apply(&mut self, pool: &mut Exprs, e: ExprId) -> ExprId {
        for node in pool.reachable(&[e], |node| !self.memo.contains_key(&node)) {
            let changed = pool.with_operands(node, |operand| self.memo[&operand]);
            self.memo.insert(node, changed);
        }
        self.memo[&e]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deep_sums_do_not_overflow() {
        let mut p = Exprs::default();
        let mut sum = p.time();
        for i in 0..100_000 {
            let x = p.var(VarId(i));
            sum = p.add(sum, x);
        }
        assert_eq!(p.variables(sum).len(), 100_000);
        assert_eq!(p.node_count(sum), 200_001);
        let (x, y) = (p.var(VarId(7)), p.der(VarId(7)));
        assert!(p.contains(sum, x) && !p.contains(sum, y));
        let other = p.substitute(sum, &[(x, y)]);
        assert_eq!(p.derivatives(other), [VarId(7)]);
        assert!(!p.contains(other, x));
    }

    #[test]
    fn substitution_simplifies_and_does_not_follow_itself() {
        let mut p = Exprs::default();
        let (x, y) = (p.var(VarId(0)), p.var(VarId(1)));
        let difference = p.sub(x, y);
        assert_eq!(p.substitute(difference, &[(x, y)]), Exprs::ZERO);
        let swapped = p.sub(y, x);
        assert_eq!(p.substitute(difference, &[(x, y), (y, x)]), swapped);
    }

    #[test]
    fn walks_see_each_node_once() {
        let mut p = Exprs::default();
        let (x, y) = (p.var(VarId(0)), p.der(VarId(1)));
        let product = p.mul(x, y);
        let root = p.add(product, x);
        let mut walk = NodeTraversal::default();
        for _ in 0..2 {
            let mut seen = Vec::new();
            walk.each(&p, &[root], |e, _| {
                seen.push(e);
                true
            });
            assert_eq!(seen, [root, product, x, y]);
        }
    }
}
