//! What the solver may integrate in place of states: mass in place of pressure.
//!
//! A method with several steps keeps every linear invariant of what it integrates to rounding. The mass of a closed
//! circuit is one of the masses of its volumes, not of their pressures: with pressures as the solver's unknowns it
//! drifts, in a stiff liquid by far more than the tolerance (C. W. Gear, SIAM J. Sci. Stat. Comput. 7 (1986) 734, on
//! invariants under multistep methods). The library states the balance beside the equations that determine the pressure,
//! `Connections.conserved(mass, rate, p)`: states, starts and everything that is computed from them stay as they are,
//! and the solver adds the mass as an unknown from which the pressure follows.
//!
//! Volumes joined without a resistance have one pressure. Their sum is conserved, and its rate is what all others bring:
//! the sum of their flows by the equations of the connections between them.

use super::ConservedQuantity;
use super::cancelling::{VariableSum, factor, terms};
use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::parameters::SignAnalysis;
use crate::flat::{self, ScalarType};
use bramah_expr::{ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::VecDeque;

/// Definitions are followed so far: from the density that a volume counts with to the law of the oil.
const DEPTH: u32 = 3;

/// The quantities of all states that have one.
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
    let joined = groups.iter().any(|(_, members)| members.len() > 1);
    let balances = if joined { BalanceEquations::new(draft, known) } else { BalanceEquations::default() };
    groups.into_iter().filter_map(|(state, members)| conserved(draft, &balances, state, &members)).collect()
}

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

fn nominal(draft: &DaeDraft, quantity: ExprId) -> ExprId {
    match draft.exprs.node(quantity) {
        ExprNode::Var(v) => draft.variables[v.index()].nominal.unwrap_or(Exprs::ONE),
        _ => Exprs::ONE,
    }
}

/// Equations that are sums of variables with constant factors, those of connections among them.
#[derive(Default)]
struct BalanceEquations {
    rows: Vec<VariableSum>,
    /// The rows that hold a variable.
    users: FxHashMap<VarId, Vec<usize>>,
    /// Whether a variable is the flow of a connector.
    flows: Vec<bool>,
    /// What equations `variable = expression` say.
    given: FxHashMap<VarId, ExprId>,
}

impl BalanceEquations {
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

    /// The sum of the rates of volumes with one pressure, in terms of what others bring. Each rate is `rest + density*flow`
    /// with the same density. `None` where the connections do not show that.
    fn joint_rate(&self, pool: &mut Exprs, rates: &[ExprId]) -> Option<ExprId> {
        let mut sum = Exprs::ZERO;
        let mut flows: Vec<(ExprId, VariableSum)> = Vec::new();
        for &rate in rates {
            let candidates = pool.variables(rate);
            let flow = candidates.into_iter().filter(|v| self.flows[v.index()]).find_map(|v| {
                let leaf = pool.var(v);
                let affine = pool.linear_in(rate, leaf)?;
                (pool.as_num(affine.coefficient).is_none()).then_some((v, affine))
            });
            let (flow, affine) = flow?;
            sum = pool.add(sum, affine.rest);
            let (density, sign) = match pool.node(affine.coefficient) {
                ExprNode::Unary(UnaryFunction::Neg, density) => (density, -1.0),
                _ => (affine.coefficient, 1.0),
            };
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

    /// An expression with what the equations give in the place of its variables, through a few of them: the densities at
    /// joined ports are variables of each volume.
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

    /// The sum of these flows as a sum of others.
    fn brought(&self, flows: &[(VarId, f64)]) -> Option<VariableSum> {
        let wanted: FxHashSet<VarId> = flows.iter().map(|f| f.0).collect();
        let Some((first, rest)) = flows.split_first() else { return Some(VariableSum::new()) };
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
        let equal = flows.iter().all(|flow| (directed(flow) - one).abs() <= 1e-12 * one.abs());
        let others = joint.iter().filter(|(v, _)| !wanted.contains(v)).map(|&(v, f)| (v, -f / one));
        (equal && one != 0.0).then(|| others.collect())
    }

    /// The rows that lead from a sum to one with `flow`, each with the variable that it shares with those before.
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

/// With each variable once: what only passes from one volume to the other goes.
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

/// The combination of two sums in which a variable of both does not occur.
fn without(a: &VariableSum, b: &VariableSum, shared: VarId) -> Option<VariableSum> {
    let ratio = factor(a, shared) / factor(b, shared);
    let mut all: Vec<VarId> = a.iter().chain(b).map(|t| t.0).filter(|&v| v != shared).collect();
    all.sort_unstable();
    all.dedup();
    let combined = all.into_iter().map(|v| (v, factor(a, v) - ratio * factor(b, v)));
    ratio.is_finite().then(|| combined.filter(|t| t.1 != 0.0).collect())
}
