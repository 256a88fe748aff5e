//! Groups of nodes that exchange nothing with a reference, such as a circuit without ground.
//!
//! There every sum of flows follows from the others, although each could be matched with an unknown: the system looks
//! regular but is singular. In a closed group each flow stands in exactly two sums, so that with suitable factors they
//! add up to `0 = 0`. The factors are signs, and what the flows are multiplied with: where mass passes, the balance of
//! a component is `rho(p_a) q_a + rho(p_b) q_b = 0`, that of a node `q_1 + q_2 = 0`, and the densities of all that ends
//! at the node are one expression of its pressure.

use super::Alias;
use super::draft::{DaeDraft, EquationRole, SystemRole};
use crate::flat::FlatEquation;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use std::collections::BTreeMap;

/// The first closed group: the flows of its sums, ascending.
pub(super) fn find(draft: &DaeDraft, aliases: &[Alias]) -> Option<Vec<VarId>> {
    let sums = FlowSumFinder::new(draft, aliases).collect();
    let mut uses: Vec<Vec<(u32, FlowFactor)>> = vec![Vec::new(); draft.variables.len()];
    for (i, sum) in sums.iter().enumerate() {
        for (v, factor) in sum {
            uses[v.index()].push((i as u32, factor.clone()));
        }
    }
    let mut groups = FlowGroups::new(sums.len());
    leave_out_ends(&sums, &mut uses, &mut groups);
    for uses in uses.iter().filter(|u| !u.is_empty()) {
        match &uses[..] {
            // a s + b t = 0 makes the flow vanish
            [(a, s), (b, t)] if a != b => groups.join(*a, *b, &s.over(t).negative()),
            _ => uses.iter().for_each(|(row, _)| groups.open(*row)),
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

/// A sum with a flow that no other sum holds cannot take part; without it, other flows stand alone.
fn leave_out_ends(sums: &[FlowSum], uses: &mut [Vec<(u32, FlowFactor)>], groups: &mut FlowGroups) {
    let mut alone: Vec<usize> = (0..uses.len()).filter(|&v| uses[v].len() == 1).collect();
    while let Some(v) = alone.pop() {
        let Some(&(row, _)) = uses[v].first() else { continue };
        groups.open(row);
        for (u, _) in &sums[row as usize] {
            let of_flow = &mut uses[u.index()];
            of_flow.retain(|(r, _)| *r != row);
            if of_flow.len() == 1 {
                alone.push(u.index());
            }
        }
    }
}

/// Unknowns with their factors.
type FlowSum = Vec<(VarId, FlowFactor)>;

/// A number times powers of expressions.
#[derive(Clone, Debug, PartialEq)]
struct FlowFactor {
    number: f64,
    powers: BTreeMap<ExprId, i32>,
}

impl FlowFactor {
    fn one() -> Self {
        FlowFactor { number: 1.0, powers: BTreeMap::new() }
    }

    fn negative(mut self) -> Self {
        self.number = -self.number;
        self
    }

    fn times(&self, other: &FlowFactor, exponent: i32) -> Self {
        let mut product = self.clone();
        product.number *= other.number.powi(exponent);
        for (e, n) in &other.powers {
            let power = product.powers.entry(*e).or_insert(0);
            *power += n * exponent;
            if *power == 0 {
                product.powers.remove(e);
            }
        }
        product
    }

    fn over(&self, other: &FlowFactor) -> Self {
        self.times(other, -1)
    }

    fn is_one(&self) -> bool {
        self.powers.is_empty() && (self.number - 1.0).abs() < 1e-12
    }
}

/// Looks for continuous equations that are sums of unknowns, the flows among them with factors.
struct FlowSumFinder<'d> {
    draft: &'d DaeDraft,
    /// By variable: declared `flow`, or equal to one that is.
    flow: Vec<bool>,
    /// What a variable equals, if an equation says so.
    definition: Vec<Option<ExprId>>,
}

impl<'d> FlowSumFinder<'d> {
    fn new(draft: &'d DaeDraft, aliases: &[Alias]) -> Self {
        let mut flow: Vec<bool> = draft.variables.iter().map(|v| v.flow).collect();
        for alias in aliases {
            flow[alias.target.index()] |= flow[alias.variable.index()];
        }
        let mut definition = vec![None; draft.variables.len()];
        for equation in &draft.equations {
            for (side, other) in [(equation.lhs, equation.rhs), (equation.rhs, equation.lhs)] {
                if let ExprNode::Var(v) = draft.exprs.node(side) {
                    definition[v.index()].get_or_insert(other);
                }
            }
        }
        FlowSumFinder { draft, flow, definition }
    }

    fn collect(&self) -> Vec<FlowSum> {
        let rows = self.draft.equations.iter().zip(&self.draft.kinds);
        rows.filter(|(_, kind)| **kind == EquationRole::Continuous).filter_map(|(e, _)| self.terms(e)).collect()
    }

    /// The terms of `lhs - rhs`.
    fn terms(&self, equation: &FlatEquation) -> Option<FlowSum> {
        let mut found = FlowSum::new();
        let mut stack = vec![(equation.rhs, FlowFactor::one().negative()), (equation.lhs, FlowFactor::one())];
        while let Some((e, factor)) = stack.pop() {
            match self.draft.exprs.node(e) {
                ExprNode::Var(v) if self.draft.role(v) == SystemRole::Continuous => found.push((v, factor)),
                ExprNode::Unary(UnaryFunction::Neg, a) => stack.push((a, factor.negative())),
                ExprNode::Binary(BinaryFunction::Add, a, b) => stack.extend([(b, factor.clone()), (a, factor)]),
                ExprNode::Binary(BinaryFunction::Sub, a, b) => {
                    stack.extend([(b, factor.clone().negative()), (a, factor)])
                }
                ExprNode::Binary(BinaryFunction::Mul, a, b) => match (self.is_flow(a), self.is_flow(b)) {
                    (false, true) => stack.push((b, factor.times(&self.factor(a)?, 1))),
                    (true, false) => stack.push((a, factor.times(&self.factor(b)?, 1))),
                    _ => return None,
                },
                _ if e == Exprs::ZERO => {}
                _ => return None,
            }
        }
        found.sort_unstable_by_key(|term| term.0);
        let distinct = found.windows(2).all(|pair| pair[0].0 != pair[1].0);
        (distinct && !found.is_empty()).then_some(found)
    }

    /// A flow, with either sign.
    fn is_flow(&self, e: ExprId) -> bool {
        match self.draft.exprs.node(e) {
            ExprNode::Var(v) => self.draft.role(v) == SystemRole::Continuous && self.flow[v.index()],
            ExprNode::Unary(UnaryFunction::Neg, a) => self.is_flow(a),
            _ => false,
        }
    }

    /// What a flow is multiplied with: by what it equals, so that equal ones are recognised. Nothing constant: that is
    /// a resistance, and no balance.
    fn factor(&self, e: ExprId) -> Option<FlowFactor> {
        let exprs = &self.draft.exprs;
        let continuous = |v: &VarId| self.draft.role(*v) == SystemRole::Continuous;
        let equal = match exprs.node(e) {
            ExprNode::Var(v) if continuous(&v) => self.definition[v.index()].unwrap_or(e),
            _ => e,
        };
        let varies = exprs.dependencies(&[equal]).vars.iter().any(continuous);
        varies.then(|| FlowFactor { number: 1.0, powers: BTreeMap::from([(equal, 1)]) })
    }
}

/// Rows joined by common flows, with the factor of each row relative to its root.
struct FlowGroups {
    parent: Vec<(u32, FlowFactor)>,
    closed: Vec<bool>,
}

impl FlowGroups {
    fn new(rows: usize) -> Self {
        FlowGroups { parent: (0..rows as u32).map(|r| (r, FlowFactor::one())).collect(), closed: vec![true; rows] }
    }

    fn find(&mut self, row: u32) -> (u32, FlowFactor) {
        let (mut at, mut factor) = (row, FlowFactor::one());
        while self.parent[at as usize].0 != at {
            // Halve the path on the way.
            let (next, own) = self.parent[at as usize].clone();
            let (beyond, further) = self.parent[next as usize].clone();
            if next != beyond {
                self.parent[at as usize] = (beyond, own.times(&further, 1));
            }
            factor = factor.times(&self.parent[at as usize].1, 1);
            at = self.parent[at as usize].0;
        }
        (at, factor)
    }

    /// Row `b` counts `ratio` times row `a`.
    fn join(&mut self, a: u32, b: u32, ratio: &FlowFactor) {
        let ((a, s), (b, t)) = (self.find(a), self.find(b));
        let ratio = s.times(ratio, 1).over(&t);
        if a != b {
            self.parent[b as usize] = (a, ratio);
            self.closed[a as usize] &= self.closed[b as usize];
        } else if !ratio.is_one() {
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
