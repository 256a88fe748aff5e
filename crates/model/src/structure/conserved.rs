//! What the solver may integrate in place of states: mass in place of pressure.
//!
//! Enters: statements `Connections.conserved(mass, rate, p)` of the flat model and the chosen states. Leaves: one
//! [`ConservedQuantity`] for each state that has such a statement. States, starts and everything computed from them
//! stay as they are; the solver adds the mass as an unknown from which the pressure follows.
//!
//! A linear multistep method keeps every linear invariant of what it integrates up to rounding. The mass of a closed
//! circuit is a linear invariant of the masses of its volumes, not of their pressures. With pressures as unknowns it
//! drifts, in a stiff liquid by far more than the tolerance (C. W. Gear, SIAM J. Sci. Stat. Comput. 7 (1986) 734, on
//! invariants under multistep methods).
//!
//! Volumes joined without a resistance have one pressure. The sum of their masses is conserved. The rate of that sum is
//! what all other components bring: the flows between the volumes cancel by the equations of the connections.

use super::ConservedQuantity;
use super::cancelling::{VariableSum, factor, terms};
use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::parameters::SignAnalysis;
use crate::flat::{self, ScalarType};
use bramah_expr::{ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::VecDeque;

/// How many definitions are followed to recognise equal densities: from the density that a volume uses to the law of
/// the oil.
const DEPTH: u32 = 3;

/// The conserved quantities of the states, in the order in which the model states them. A statement about a variable
/// that is no state is ignored. `states` is ascending.
/// Statements about one variable form a group: their volumes have one pressure.
pub(super) fn find(draft: &mut DaeDraft, known: &mut SignAnalysis, states: &[VarId]) -> Vec<ConservedQuantity> {
    if draft.conserved.is_empty() {
        return Vec::new();
    }
    let mut groups: Vec<(VarId, Vec<flat::ConservationDeclaration>)> = Vec::new();
    let mut at: FxHashMap<VarId, usize> = FxHashMap::default();
    for stated in &draft.conserved {
        let ExprNode::Var(state) = draft.exprs.node(stated.state) else { continue };
        if states.binary_search(&state).is_ok() {
            let place = *at.entry(state).or_insert(groups.len());
            if place == groups.len() {
                groups.push((state, Vec::new()));
            }
            groups[place].1.push(*stated);
        }
    }
    // Balances are needed only where several volumes share a state; to collect them costs a pass over all equations.
    let joined = groups.iter().any(|(_, members)| members.len() > 1);
    let balances = if joined { BalanceEquations::new(draft, known) } else { BalanceEquations::default() };
    groups.into_iter().filter_map(|(state, members)| conserved(draft, &balances, state, &members)).collect()
}

/// The quantity of one state, from all statements about it. Adds the variable of the solver and its equation to the
/// draft. `None` where the common rate of several volumes cannot be found.
///
/// With several statements the quantity is the sum of theirs, and so is the nominal value.
fn conserved(
    draft: &mut DaeDraft,
    balances: &BalanceEquations,
    state: VarId,
    members: &[flat::ConservationDeclaration],
) -> Option<ConservedQuantity> {
    let rate = match members {
        [one] => one.rate,
        all => balances.joint_rate(&mut draft.exprs, &all.iter().map(|m| m.rate).collect::<Vec<_>>())?,
    };
    let first = members[0];
    let (mut quantity, mut nominal) = (first.quantity, nominal(draft, first.quantity));
    for member in &members[1..] {
        quantity = draft.exprs.add(quantity, member.quantity);
        let more = self::nominal(draft, member.quantity);
        nominal = draft.exprs.add(nominal, more);
    }
    let name = format!("{} (integrated)", draft.text(quantity));
    let variable = draft.make_variable(name, ScalarType::Real, SystemRole::Continuous, first.origin);
    draft.variables[variable.index()].nominal = Some(nominal);
    let (lhs, rhs) = (draft.exprs.var(variable), quantity);
    draft.add_equation(flat::FlatEquation { lhs, rhs, origin: first.origin }, EquationRole::Definition);
    let equation = u32::try_from(draft.equations.len() - 1).expect("fewer than 2^32 equations");
    Some(ConservedQuantity { state, variable, quantity, rate, equation })
}

/// The nominal value of a quantity: that of the variable, or 1.
/// The solver scales its error test with it.
fn nominal(draft: &DaeDraft, quantity: ExprId) -> ExprId {
    match draft.exprs.node(quantity) {
        ExprNode::Var(v) => draft.variables[v.index()].nominal.unwrap_or(Exprs::ONE),
        _ => Exprs::ONE,
    }
}

/// The equations that are sums of variables with constant factors, those of connections among them.
/// It is empty where no state has several statements.
#[derive(Default)]
struct BalanceEquations {
    /// The sums.
    rows: Vec<VariableSum>,
    /// By variable: the rows that contain it.
    users: FxHashMap<VarId, Vec<usize>>,
    /// By variable: whether it is the flow of a connector.
    flows: Vec<bool>,
    /// By variable: the right side of the first continuous equation that has the variable as its left side.
    given: FxHashMap<VarId, ExprId>,
}

impl BalanceEquations {
    /// Collects sums and definitions from the continuous equations.
    fn new(draft: &DaeDraft, known: &mut SignAnalysis) -> BalanceEquations {
        let flows = draft.variables.iter().map(|v| v.flow).collect();
        let mut balances = BalanceEquations { flows, ..BalanceEquations::default() };
        for (equation, kind) in draft.equations.iter().zip(&draft.kinds) {
            if *kind != EquationRole::Continuous {
                continue;
            }
            if let ExprNode::Var(v) = draft.exprs.node(equation.lhs) {
                balances.given.entry(v).or_insert(equation.rhs);
            }
            if let Some(sum) = terms(draft, known, equation) {
                for (v, _) in &sum {
                    balances.users.entry(*v).or_default().push(balances.rows.len());
                }
                balances.rows.push(sum);
            }
        }
        balances
    }

    /// The sum of the rates of volumes with one pressure, in terms of the flows that others bring.
    ///
    /// Each rate must be `rest + density*flow`. Flows with the same density are summed and replaced by the flows that
    /// enter the group from outside. `None` where a rate has another form or the connections do not determine the sum.
    ///
    /// An example is two volumes on one node: `der(m1) = rho*q1 + a`, `der(m2) = rho*q2 + b`, and the connection states
    /// `q1 + q2 + q3 = 0`. The sum of the rates is `a + b - rho*q3`.
    fn joint_rate(&self, pool: &mut Exprs, rates: &[ExprId]) -> Option<ExprId> {
        let mut sum = Exprs::ZERO;
        let mut flows: Vec<(ExprId, VariableSum)> = Vec::new();
        for &rate in rates {
            let candidates = pool.variables(rate);
            let flow = candidates.into_iter().filter(|v| self.flows[v.index()]).find_map(|v| {
                let leaf = pool.var(v);
                let affine = pool.linear_in(rate, leaf)?;
                // A flow with a numeric coefficient carries no density: it is no volume flow of an oil volume.
                (pool.as_num(affine.coefficient).is_none()).then_some((v, affine))
            });
            let (flow, affine) = flow?;
            sum = pool.add(sum, affine.rest);
            let (density, sign) = match pool.node(affine.coefficient) {
                ExprNode::Unary(UnaryFunction::Neg, density) => (density, -1.0),
                _ => (affine.coefficient, 1.0),
            };
            // Densities are compared by what they are computed from, since each volume has its own variable for it.
            let density = self.meaning(pool, density, DEPTH);
            match flows.iter_mut().find(|(known, _)| *known == density) {
                Some((_, flows)) => flows.push((flow, sign)),
                None => flows.push((density, vec![(flow, sign)])),
            }
        }
        for (coefficient, flows) in flows {
            let others = self.brought(&netted(flows))?;
            for (v, factor) in others {
                let (v, factor) = (pool.var(v), pool.num(factor));
                let term = pool.mul(factor, v);
                let term = pool.mul(coefficient, term);
                sum = pool.add(sum, term);
            }
        }
        Some(sum)
    }

    /// An expression with variables replaced by their definitions, up to `depth` definitions deep. Densities at joined
    /// ports are variables of each volume; this makes equal ones the same expression.
    /// Shared parts are rewritten once.
    fn meaning(&self, pool: &mut Exprs, e: ExprId, depth: u32) -> ExprId {
        let mut images: FxHashMap<ExprId, ExprId> = FxHashMap::default();
        for part in pool.reachable(&[e], |_| true) {
            let image = match pool.node(part) {
                ExprNode::Var(v) if depth > 0 => match self.given.get(&v) {
                    Some(&given) => self.meaning(pool, given, depth - 1),
                    None => part,
                },
                _ if pool.operands(part).as_slice().iter().all(|a| images[a] == *a) => part,
                _ => pool.with_operands(part, |a| images[&a]),
            };
            images.insert(part, image);
        }
        images[&e]
    }

    /// The sum of these flows as a sum of other variables. Combines balances along connections until one combination
    /// contains all the flows. `None` where the balances do not connect them, or not with equal factors.
    ///
    /// It starts from a balance that contains the first flow. For each further flow it looks for a way to a balance
    /// with that flow and subtracts the rows on the way, so that the variables they share vanish.
    fn brought(&self, flows: &[(VarId, f64)]) -> Option<VariableSum> {
        let wanted: FxHashSet<VarId> = flows.iter().map(|f| f.0).collect();
        let Some((first, rest)) = flows.split_first() else { return Some(VariableSum::new()) };
        // A single flow is its own sum.
        if rest.is_empty() {
            return Some(vec![*first]);
        }
        let start = *self.users.get(&first.0)?.iter().find(|&&r| self.rows[r].len() > 1)?;
        let mut joint = self.rows[start].clone();
        let mut used: FxHashSet<usize> = FxHashSet::default();
        used.insert(start);
        for (flow, _) in rest {
            if joint.iter().all(|(v, _)| v != flow) {
                let way = self.way(&joint, &used, &wanted, *flow)?;
                for (shared, row) in way {
                    joint = without(&joint, &self.rows[row], shared)?;
                    used.insert(row);
                }
            }
        }
        // each flow in its own direction
        let directed = |(v, sign): &(VarId, f64)| factor(&joint, *v) * sign;
        let one = directed(first);
        // The combination is the sum of the flows only if each occurs with its sign times one common factor.
        let equal = flows.iter().all(|flow| (directed(flow) - one).abs() <= 1e-12 * one.abs());
        let others = joint.iter().filter(|(v, _)| !wanted.contains(v)).map(|&(v, f)| (v, -f / one));
        (equal && one != 0.0).then(|| others.collect())
    }

    /// The rows that lead from a sum to a row with `flow`, each with the variable that it shares with the sum so far.
    /// Breadth first, so the way is a shortest one. Rows in `used` and variables in `wanted` are not crossed. `None`
    /// where no row with the flow is reachable.
    /// A row is visited once at most.
    fn way(
        &self,
        from: &VariableSum,
        used: &FxHashSet<usize>,
        wanted: &FxHashSet<VarId>,
        flow: VarId,
    ) -> Option<Vec<(VarId, usize)>> {
        let mut came: FxHashMap<usize, (VarId, Option<usize>)> = FxHashMap::default();
        let mut open: VecDeque<usize> = VecDeque::new();
        let reach =
            |sum: &VariableSum, by: Option<usize>, came: &mut FxHashMap<usize, _>, open: &mut VecDeque<usize>| {
                for (v, _) in sum.iter().filter(|(v, _)| !wanted.contains(v)) {
                    for &row in self.users[v].iter().filter(|row| !used.contains(row)) {
                        came.entry(row).or_insert_with(|| {
                            open.push_back(row);
                            (*v, by)
                        });
                    }
                }
            };
        reach(from, None, &mut came, &mut open);
        while let Some(row) = open.pop_front() {
            if self.rows[row].iter().any(|(v, _)| *v == flow) {
                // Follow the predecessors back to the start.
                let mut way = Vec::new();
                let mut at = Some(row);
                while let Some(row) = at {
                    let (shared, before) = came[&row];
                    way.push((shared, row));
                    at = before;
                }
                way.reverse();
                return Some(way);
            }
            reach(&self.rows[row], Some(row), &mut came, &mut open);
        }
        None
    }
}

/// Adds up repeated variables and drops those whose factors cancel: a flow that only passes from one volume to another.
fn netted(mut flows: VariableSum) -> VariableSum {
    flows.sort_unstable_by_key(|f| f.0);
    flows.dedup_by(|later, kept| {
        let same = later.0 == kept.0;
        kept.1 += if same { later.1 } else { 0.0 };
        same
    });
    flows.retain(|f| f.1 != 0.0);
    flows
}

/// The combination `a - ratio*b` in which a variable of both does not occur. `None` where its factor in `b` is 0.
fn without(a: &VariableSum, b: &VariableSum, shared: VarId) -> Option<VariableSum> {
    let ratio = factor(a, shared) / factor(b, shared);
    let mut all: Vec<VarId> = a.iter().chain(b).map(|t| t.0).filter(|&v| v != shared).collect();
    all.sort_unstable();
    all.dedup();
    let combined = all.into_iter().map(|v| (v, factor(a, v) - ratio * factor(b, v)));
    ratio.is_finite().then(|| combined.filter(|t| t.1 != 0.0).collect())
}
