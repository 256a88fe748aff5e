//! Groups of nodes that exchange nothing with a reference, such as a circuit without ground.
//!
//! There every sum of flows follows from the others, although each could be matched with an unknown: the system looks
//! regular but is singular. Such sums have coefficients of plus or minus one, and in a closed group each flow stands in
//! exactly two of them, so that with suitable signs they add up to `0 = 0`.

use super::draft::{Draft, Role, RowKind};
use crate::expr::{Binary, ExprId, Exprs, Node, Unary, VarId};
use crate::flat::Equation;

/// The first closed group: the flows of its sums, ascending.
pub(super) fn find(draft: &Draft) -> Option<Vec<VarId>> {
    let sums = sums(draft);
    let mut uses: Vec<Vec<(u32, bool)>> = vec![Vec::new(); draft.variables.len()];
    for (i, sum) in sums.iter().enumerate() {
        for &(v, negated) in sum {
            uses[v.index()].push((i as u32, negated));
        }
    }
    let mut groups = Groups::new(sums.len());
    for uses in uses.iter().filter(|u| !u.is_empty()) {
        match uses[..] {
            // Rows with opposite signs of the flow are added, rows with equal signs subtracted.
            [(a, s), (b, t)] if a != b => groups.join(a, b, s == t),
            _ => uses.iter().for_each(|&(row, _)| groups.open(row)),
        }
    }
    let closed = (0..sums.len() as u32).find(|&row| groups.is_closed(row))?;
    let root = groups.find(closed).0;
    let mut flows: Vec<VarId> = Vec::new();
    for (i, sum) in sums.iter().enumerate() {
        if groups.find(i as u32).0 == root {
            flows.extend(sum.iter().map(|term| term.0));
        }
    }
    flows.sort_unstable();
    flows.dedup();
    Some(flows)
}

/// Continuous equations that are sums of unknowns with coefficients of plus or minus one.
fn sums(draft: &Draft) -> Vec<Vec<(VarId, bool)>> {
    let continuous = draft.equations.iter().zip(&draft.kinds).filter(|(_, kind)| **kind == RowKind::Continuous);
    continuous.filter_map(|(equation, _)| terms(draft, equation)).collect()
}

/// The terms of `lhs - rhs`; `true` is minus.
fn terms(draft: &Draft, equation: &Equation) -> Option<Vec<(VarId, bool)>> {
    let mut found = Vec::new();
    let mut stack: Vec<(ExprId, bool)> = vec![(equation.rhs, true), (equation.lhs, false)];
    while let Some((e, negated)) = stack.pop() {
        match draft.exprs.node(e) {
            Node::Var(v) if draft.role(v) == Role::Continuous => found.push((v, negated)),
            Node::Unary(Unary::Neg, a) => stack.push((a, !negated)),
            Node::Binary(Binary::Add, a, b) => stack.extend([(b, negated), (a, negated)]),
            Node::Binary(Binary::Sub, a, b) => stack.extend([(b, !negated), (a, negated)]),
            _ if e == Exprs::ZERO => {}
            _ => return None,
        }
    }
    found.sort_unstable();
    let distinct = found.windows(2).all(|pair| pair[0].0 != pair[1].0);
    (distinct && !found.is_empty()).then_some(found)
}

/// Rows joined by common flows, with the sign of each row relative to its root.
struct Groups {
    parent: Vec<(u32, bool)>,
    closed: Vec<bool>,
}

impl Groups {
    fn new(rows: usize) -> Self {
        Groups { parent: (0..rows as u32).map(|r| (r, false)).collect(), closed: vec![true; rows] }
    }

    fn find(&mut self, row: u32) -> (u32, bool) {
        let (mut at, mut turned) = (row, false);
        while self.parent[at as usize].0 != at {
            // Halve the path on the way.
            let (next, sign) = self.parent[at as usize];
            let (beyond, further) = self.parent[next as usize];
            self.parent[at as usize] = if next == beyond { (next, sign) } else { (beyond, sign != further) };
            turned ^= self.parent[at as usize].1;
            at = self.parent[at as usize].0;
        }
        (at, turned)
    }

    fn join(&mut self, a: u32, b: u32, turned: bool) {
        let ((a, s), (b, t)) = (self.find(a), self.find(b));
        let turned = turned ^ s ^ t;
        if a != b {
            self.parent[b as usize] = (a, turned);
            self.closed[a as usize] &= self.closed[b as usize];
        } else if turned {
            self.closed[a as usize] = false;
        }
    }

    fn open(&mut self, row: u32) {
        let root = self.find(row).0;
        self.closed[root as usize] = false;
    }

    fn is_closed(&mut self, row: u32) -> bool {
        let root = self.find(row).0;
        self.closed[root as usize]
    }
}
