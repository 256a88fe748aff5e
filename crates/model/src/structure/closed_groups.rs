//! Groups of nodes that exchange nothing with a reference, such as a circuit without ground.
//!
//! In such a group every sum of flows follows from the others. Each sum can still be matched with an unknown, so the
//! system looks structurally regular but is singular. In a closed group each flow occurs in exactly two sums, and with
//! suitable factors the sums add up to `0 = 0`.
//!
//! The factors are signs and what the flows are multiplied with. Where mass passes, the balance of a component is
//! `rho(p_a) q_a + rho(p_b) q_b = 0` and that of a node `q_1 + q_2 = 0`. The densities of all flows at a node are one
//! expression of its pressure, so they count as one factor.
//!
//! `analysis` calls [`find`] after the regularity check; a group found ends the analysis with a message.

use super::Alias;
use super::draft::{DaeDraft, EquationRole, SystemRole};
use crate::flat::FlatEquation;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use std::collections::BTreeMap;

/// The first closed group: its flows in ascending order. `None` where there is none. The work grows almost linearly
/// with the number of terms.
///
/// An example is a loop of two resistors: `i1 + i2 = 0` at one node and `-i1 - i2 = 0` at the other.
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
        // A flow in two sums joins them. A flow in any other number of sums opens them: it cannot cancel in pairs.
        match &uses[..] {
            // a s + b t = 0 makes the flow vanish
            [(a, s), (b, t)] if a != b => groups.join(*a, *b, &s.over(t).negative()),
            _ => uses.iter().for_each(|(row, _)| groups.open(*row)),
        }
    }
    // A set of rows is closed if no row was opened and all factors around its circles agree.
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

/// Excludes sums that contain a flow of no other sum: that flow cannot cancel. Without such a sum, flows of it may
/// occur in one sum only, so the exclusion is repeated until nothing changes.
fn leave_out_ends(sums: &[FlowSum], uses: &mut [Vec<(u32, FlowFactor)>], groups: &mut FlowGroups) {
    let mut alone: Vec<usize> = (0..uses.len()).filter(|&v| uses[v].len() == 1).collect();
    while let Some(v) = alone.pop() {
        // The flow may have been in the list more than once.
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

/// A sum of unknowns with their factors, in ascending order of unknowns.
type FlowSum = Vec<(VarId, FlowFactor)>;

/// A factor: a number times integer powers of expressions. Two factors are equal if number and powers agree;
/// expressions are hash-consed, so equal expressions have equal ids.
#[derive(Clone, Debug, PartialEq)]
struct FlowFactor {
    /// The numeric part.
    number: f64,
    /// Expressions with their exponents. No exponent is 0.
    powers: BTreeMap<ExprId, i32>,
}

impl FlowFactor {
    /// The factor 1.
    fn one() -> Self {
        FlowFactor { number: 1.0, powers: BTreeMap::new() }
    }

    /// The factor with the opposite sign.
    fn negative(mut self) -> Self {
        self.number = -self.number;
        self
    }

    /// The product with another factor to the power `exponent`.
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

    /// The quotient by another factor.
    fn over(&self, other: &FlowFactor) -> Self {
        self.times(other, -1)
    }

    /// Whether it is 1 up to rounding.
    fn is_one(&self) -> bool {
        self.powers.is_empty() && (self.number - 1.0).abs() < 1e-12
    }
}

/// Finds the continuous equations that are sums of unknowns. Flows may have factors that change; other unknowns may
/// have a sign only.
struct FlowSumFinder<'d> {
    /// The system after alias elimination.
    draft: &'d DaeDraft,
    /// By variable: declared `flow`, or equal to one that is.
    flow: Vec<bool>,
    /// By variable: the other side of the first equation that has the variable as one of its sides.
    definition: Vec<Option<ExprId>>,
}

impl<'d> FlowSumFinder<'d> {
    /// Marks flows and collects definitions.
    fn new(draft: &'d DaeDraft, aliases: &[Alias]) -> Self {
        let mut flow: Vec<bool> = draft.variables.iter().map(|v| v.flow).collect();
        // A representative of an alias set may lack the `flow` prefix although one of its aliases has it.
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

    /// The sums among the continuous equations, in their order.
    fn collect(&self) -> Vec<FlowSum> {
        let rows = self.draft.equations.iter().zip(&self.draft.kinds);
        rows.filter(|(_, kind)| **kind == EquationRole::Continuous).filter_map(|(e, _)| self.terms(e)).collect()
    }

    /// The terms of `lhs - rhs`. `None` where the equation is no such sum or a variable occurs twice.
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

    /// Whether an expression is a flow variable or its negative.
    fn is_flow(&self, e: ExprId) -> bool {
        match self.draft.exprs.node(e) {
            ExprNode::Var(v) => self.draft.role(v) == SystemRole::Continuous && self.flow[v.index()],
            ExprNode::Unary(UnaryFunction::Neg, a) => self.is_flow(a),
            _ => false,
        }
    }

    /// The factor that an expression contributes where it multiplies a flow.
    ///
    /// A variable is replaced by its definition, so that equal densities are recognised. `None` for a factor that does
    /// not vary: constant times flow is a resistance, and the equation is no balance.
    /// The exponent is 1; the numeric part of a factor comes from signs only.
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

/// Union-find over rows that share flows, with the factor of each row relative to its root.
struct FlowGroups {
    /// By row: its parent and the factor of the row relative to it.
    parent: Vec<(u32, FlowFactor)>,
    /// By root: whether no row of the set is open.
    closed: Vec<bool>,
}

impl FlowGroups {
    /// Every row in a closed set of its own.
    fn new(rows: usize) -> Self {
        FlowGroups { parent: (0..rows as u32).map(|r| (r, FlowFactor::one())).collect(), closed: vec![true; rows] }
    }

    /// The root of a row and the factor of the row relative to the root. Shortens the path.
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

    /// States that row `b` counts `ratio` times row `a`. If both are in one set already and the ratio differs from the
    /// known one, the sums do not add up to 0, and the set is open.
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

    /// Marks the set of a row as open.
    fn open(&mut self, row: u32) {
        let root = self.find(row).0;
        self.closed[root as usize] = false;
    }

    /// Whether the set of a row is closed.
    fn is_closed(&mut self, row: u32) -> bool {
        let root = self.find(row).0;
        self.closed[root as usize]
    }
}
