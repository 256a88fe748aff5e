//! Walks over expressions: operands, reachable nodes, dependencies, substitution.
//!
//! Nothing here recurses, so that a sum of a million terms needs no deep stack. Operands have smaller ids than their
//! node, so the reachable nodes in ascending order are in an order of evaluation.

use super::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::{FxBuildHasher, FxHashMap, FxHashSet};

/// The operands of one node. Up to three are stored here, those of a call are borrowed from the pool.
/// It avoids an allocation for each node.
#[derive(Clone, Copy, Debug)]
pub struct NodeOperands<'a> {
    /// The operands of nodes that are no calls.
    few: [ExprId; 3],
    /// How many of `few` are used.
    len: usize,
    /// The arguments of a call, else empty.
    many: &'a [ExprId],
}

impl NodeOperands<'_> {
    /// The operands in order.
    #[inline]
    pub fn as_slice(&self) -> &[ExprId] {
        if self.many.is_empty() { &self.few[..self.len] } else { self.many }
    }
}

/// The leaves of some expressions. Each list is sorted and has no duplicates.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeafDependencies {
    /// Variables whose value occurs.
    pub vars: Vec<VarId>,
    /// Variables whose time derivative occurs.
    pub ders: Vec<VarId>,
    /// Variables whose value before the event occurs.
    pub pres: Vec<VarId>,
    /// True if time occurs.
    pub time: bool,
}

/// A record of visited nodes that can be reused for many walks over one pool.
#[derive(Clone, Debug, Default)]
pub struct NodeTraversal {
    /// For each node the stamp of the walk that visited it last.
    marks: Vec<u32>,
    /// The stamp of the current walk, so that marks need not be cleared between walks.
    stamp: u32,
    /// Nodes still to be visited.
    stack: Vec<ExprId>,
}

impl NodeTraversal {
    /// Calls `visit` once for every node reachable from `roots`, a node before its operands.
    /// If `visit` returns false, the operands of that node are not followed.
    pub fn each(&mut self, pool: &Exprs, roots: &[ExprId], mut visit: impl FnMut(ExprId, ExprNode) -> bool) {
        // The stamps start again: marks of old walks would otherwise look current.
        if self.stamp == u32::MAX {
            self.marks.clear();
            self.stamp = 0;
        }
        self.stamp += 1;
        self.marks.resize(pool.len().max(self.marks.len()), 0);
        self.stack.clear();
        // Reversed, because the stack is read from its end and the roots are to be visited in order.
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
    /// The operands of a node. Leaves have none.
    /// For an `if` they are the condition and both branches; for a call its arguments.
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

    /// The same node with its operands replaced by `change`, simplified. Leaves stay as they are.
    /// `change` is called once for each operand, in order.
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
                // The arguments are copied, because building a node may move the list that holds them.
                let args: Vec<ExprId> = self.args(args).to_vec().into_iter().map(change).collect();
                self.call(function, output, &args)
            }
            _ => e,
        }
    }

    /// All nodes reachable from `roots` for which `enter` returns true, in an order of evaluation (operands first).
    /// A node that is not entered is left out, and so is what only it leads to.
    pub fn reachable(&self, roots: &[ExprId], mut enter: impl FnMut(ExprId) -> bool) -> Vec<ExprId> {
        // Most expressions are small, and one allocation is enough for them.
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

    /// The number of distinct nodes of an expression.
    /// Shared nodes count once.
    #[inline]
    pub fn node_count(&self, e: ExprId) -> usize {
        self.reachable(&[e], |_| true).len()
    }

    /// All leaves that the expressions depend on.
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
        // Nodes are in the order of their ids, which is not the order of the variables.
        found.vars.sort_unstable();
        found.ders.sort_unstable();
        found.pres.sort_unstable();
        found
    }

    /// The variables whose value occurs, sorted.
    #[inline]
    pub fn variables(&self, e: ExprId) -> Vec<VarId> {
        self.dependencies(&[e]).vars
    }

    /// The variables whose time derivative occurs, sorted.
    #[inline]
    pub fn derivatives(&self, e: ExprId) -> Vec<VarId> {
        self.dependencies(&[e]).ders
    }

    /// True if `part` occurs in `e`, or is `e`.
    /// The search stops as soon as the part is found.
    pub fn contains(&self, e: ExprId, part: ExprId) -> bool {
        let mut found = false;
        self.reachable(&[e], |node| {
            found |= node == part;
            // Operands have smaller ids, so a node with a smaller id than `part` cannot contain it.
            !found && node > part
        });
        found
    }

    /// The expression `e` with parts replaced, see [`Substitution`].
    #[inline]
    pub fn substitute(&mut self, e: ExprId, replacements: &[(ExprId, ExprId)]) -> ExprId {
        Substitution::new(replacements.iter().copied()).apply(self, e)
    }
}

/// Replaces parts of expressions by others. Replacements are not searched for further parts.
/// One value serves any number of expressions of one pool, and remembers what it has replaced.
#[derive(Clone, Debug, Default)]
pub struct Substitution {
    /// The replacement of each node seen so far.
    memo: FxHashMap<ExprId, ExprId>,
}

impl Substitution {
    /// Replaces the first of each pair by the second.
    #[inline]
    pub fn new(replacements: impl IntoIterator<Item = (ExprId, ExprId)>) -> Self {
        Substitution { memo: replacements.into_iter().collect() }
    }

    /// The expression with all replacements made.
    pub fn apply(&mut self, pool: &mut Exprs, e: ExprId) -> ExprId {
        // Operands come first, so their replacements are known when their node is rebuilt.
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
