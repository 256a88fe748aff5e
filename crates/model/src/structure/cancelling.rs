//! Sums that cancel against each other further than their structure shows.
//!
//! A star of windings without neutral says `i1 + i2 + i3 = 0`, the inductance that its zero sequence sees `3*i0 = i1 + i2 +
//! i3`: together `i0 = 0`, so that `i0` is no state, which neither equation tells. Only what leaves a single variable
//! is replaced; all other sums stay as they were written.

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::parameters::SignAnalysis;
use crate::flat::{FlatEquation, Variability};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use rustc_hash::FxHashMap;

/// A factor below this part of those it comes from has cancelled.
const CANCELLED: f64 = 1e-12;
/// Longer sums are not compared.
const LONGEST: usize = 64;

/// Replaces sums of which another one leaves a single variable by `variable = 0`: those of the model by themselves, then
/// those that hold at the start with the help of the model's.
pub(super) fn replace(draft: &mut DaeDraft, known: &mut SignAnalysis) {
    let mut sums = CancellationRows::default();
    let of_model: Vec<usize> =
        (0..draft.equations.len()).filter(|&i| draft.kinds[i] == EquationRole::Continuous).collect();
    sums.extend(draft, known, &draft.equations, &of_model);
    let mut found = Vec::new();
    sums.reduce(0, |i, v| found.push((i, v)));
    for (i, v) in found.drain(..) {
        set(&mut draft.exprs, &mut draft.equations[i], v);
    }
    let first = sums.rows.len();
    let of_start: Vec<usize> = (0..draft.initial_equations.len()).collect();
    sums.extend(draft, known, &draft.initial_equations, &of_start);
    sums.reduce(first, |i, v| found.push((i, v)));
    for (i, v) in found {
        set(&mut draft.exprs, &mut draft.initial_equations[i], v);
    }
}

fn set(pool: &mut Exprs, equation: &mut FlatEquation, v: VarId) {
    (equation.lhs, equation.rhs) = (pool.var(v), Exprs::ZERO);
}

/// Variables with their factors, in the order of variables.
pub(super) type VariableSum = Vec<(VarId, f64)>;

#[derive(Default)]
struct CancellationRows {
    /// The equations, with their sums.
    rows: Vec<(usize, VariableSum)>,
    /// The rows that hold a variable, or held it.
    users: FxHashMap<VarId, Vec<usize>>,
}

impl CancellationRows {
    /// Adds those of these equations that are sums.
    fn extend(&mut self, draft: &DaeDraft, known: &mut SignAnalysis, equations: &[FlatEquation], which: &[usize]) {
        let mut zero = Vec::new();
        for &i in which {
            match terms(draft, known, &equations[i]) {
                Some(sum) if sum.len() == 1 => zero.push(sum[0].0),
                Some(sum) if sum.len() > 1 => {
                    for (v, _) in &sum {
                        self.users.entry(*v).or_default().push(self.rows.len());
                    }
                    self.rows.push((i, sum));
                }
                _ => {}
            }
        }
        zero.into_iter().for_each(|v| self.set_zero(v));
    }

    /// Calls `found` with every equation from row `first` on that another one reduces to a single variable; until none is
    /// left, for each makes others shorter. Of two, the longer one is replaced where it may be.
    fn reduce(&mut self, first: usize, mut found: impl FnMut(usize, VarId)) {
        let mut reduced = true;
        while std::mem::take(&mut reduced) {
            for row in 0..self.rows.len() {
                let Some((other, v)) = self.single_beside(row, first) else { continue };
                let replaced = if other >= first { other } else { row };
                found(self.rows[replaced].0, v);
                self.set_zero(v);
                self.rows[replaced].1.clear();
                reduced = true;
            }
        }
    }

    /// Takes a variable that is 0 out of all sums.
    fn set_zero(&mut self, v: VarId) {
        for row in self.users.remove(&v).unwrap_or_default() {
            self.rows[row].1.retain(|term| term.0 != v);
        }
    }

    /// A row that holds all variables of this one and at most one more, and the single variable that both leave; one of them
    /// from row `first` on.
    fn single_beside(&self, row: usize, first: usize) -> Option<(usize, VarId)> {
        let sum = &self.rows[row].1;
        let rarest = sum.iter().map(|(v, _)| &self.users[v]).min_by_key(|rows| rows.len())?;
        let mut others = rarest.iter().copied().filter(|&other| other != row && row.max(other) >= first);
        others.find_map(|other| single(sum, &self.rows[other].1).map(|v| (other, v)))
    }
}

/// The factor of a variable in a sum; 0 where it does not occur.
pub(super) fn factor(sum: &VariableSum, v: VarId) -> f64 {
    sum.binary_search_by_key(&v, |t| t.0).map_or(0.0, |i| sum[i].1)
}

/// The only variable of a multiple of `b`, as long or longer by one, taken from `a`.
fn single(a: &VariableSum, b: &VariableSum) -> Option<VarId> {
    if a.len() < 2 || b.len() < a.len() || b.len() > a.len() + 1 {
        return None;
    }
    let ratios = a.iter().map(|&(v, x)| x / factor(b, v)).filter(|r| r.is_finite());
    ratios.take(2).find_map(|ratio| {
        let all = a.iter().chain(b).map(|t| t.0);
        let left = |v: &VarId| {
            let (x, y) = (factor(a, *v), ratio * factor(b, *v));
            (x - y).abs() > CANCELLED * x.abs().max(y.abs())
        };
        let mut rest: Vec<VarId> = all.filter(left).take(3).collect();
        rest.dedup();
        match rest[..] {
            [v] => Some(v),
            _ => None,
        }
    })
}

/// The terms of `lhs - rhs` where that is a sum of continuous unknowns with factors that no run changes.
pub(super) fn terms(draft: &DaeDraft, known: &mut SignAnalysis, equation: &FlatEquation) -> Option<VariableSum> {
    let pool = &draft.exprs;
    let mut number = |e: ExprId| {
        let constant = |v: &VarId| draft.variables[v.index()].variability == Variability::Constant;
        pool.as_num(e).or_else(|| known.value(pool, e).filter(|_| pool.variables(e).iter().all(constant)))
    };
    let mut found = VariableSum::new();
    let mut open = vec![(equation.lhs, 1.0), (equation.rhs, -1.0)];
    while let Some((e, factor)) = open.pop() {
        match pool.node(e) {
            _ if e == Exprs::ZERO => {}
            ExprNode::Var(v) if draft.role(v) == SystemRole::Continuous => found.push((v, factor)),
            ExprNode::Unary(UnaryFunction::Neg, a) => open.push((a, -factor)),
            ExprNode::Binary(BinaryFunction::Add, a, b) => open.extend([(a, factor), (b, factor)]),
            ExprNode::Binary(BinaryFunction::Sub, a, b) => open.extend([(a, factor), (b, -factor)]),
            ExprNode::Binary(BinaryFunction::Mul, a, b) => match (number(a), number(b)) {
                (Some(x), _) => open.push((b, factor * x)),
                (_, Some(x)) => open.push((a, factor * x)),
                _ => return None,
            },
            ExprNode::Binary(BinaryFunction::Div, a, b) => open.push((a, factor / number(b)?)),
            _ => return None,
        }
        if found.len() > LONGEST {
            return None;
        }
    }
    found.sort_unstable_by_key(|t| t.0);
    let distinct = found.windows(2).all(|pair| pair[0].0 != pair[1].0);
    (distinct && found.iter().all(|t| t.1 != 0.0 && t.1.is_finite())).then_some(found)
}
