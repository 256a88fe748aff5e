//! Sums that cancel against each other further than their structure shows.
//!
//! A star connection of windings without neutral states `i1 + i2 + i3 = 0`; the zero-sequence inductance states `3*i0 =
//! i1 + i2 + i3`. Together they mean `i0 = 0`, so `i0` is no state, although neither equation shows that. This step
//! finds pairs of sums of which one, subtracted from a multiple of the other, leaves a single variable. It replaces one
//! of the two by `variable = 0`. All other sums stay as they were written.
//!
//! `analysis` calls [`replace`] after alias elimination. `conserved` reuses [`terms`] and [`factor`].

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::parameters::SignAnalysis;
use crate::flat::{FlatEquation, Variability};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use rustc_hash::FxHashMap;

/// A factor whose size is below this part of the factors it comes from counts as 0.
const CANCELLED: f64 = 1e-12;
/// Sums with more terms are not compared, to bound the work.
const LONGEST: usize = 64;

/// Replaces sums of which another one leaves a single variable by `variable = 0`. Equations of the model are compared
/// with each other; initial equations are compared with each other and with those of the model.
///
/// For `i1 + i2 + i3 = 0` and `3*i0 = i1 + i2 + i3` the second one becomes `i0 = 0`.
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
    // From here on an initial equation takes part in each pair, and only initial equations are replaced: an equation
    // that holds at the start only must not change one that holds always.
    let first = sums.rows.len();
    let of_start: Vec<usize> = (0..draft.initial_equations.len()).collect();
    sums.extend(draft, known, &draft.initial_equations, &of_start);
    sums.reduce(first, |i, v| found.push((i, v)));
    for (i, v) in found {
        set(&mut draft.exprs, &mut draft.initial_equations[i], v);
    }
}

/// Makes an equation say `v = 0`.
fn set(pool: &mut Exprs, equation: &mut FlatEquation, v: VarId) {
    (equation.lhs, equation.rhs) = (pool.var(v), Exprs::ZERO);
}

/// A sum of variables with constant factors, in ascending order of variables. No variable occurs twice.
pub(super) type VariableSum = Vec<(VarId, f64)>;

/// The sums that are compared.
#[derive(Default)]
struct CancellationRows {
    /// Each equation, by its index, with its sum. Rows of the model come before initial ones.
    rows: Vec<(usize, VariableSum)>,
    /// By variable: the rows that contain it, or contained it once.
    users: FxHashMap<VarId, Vec<usize>>,
}

impl CancellationRows {
    /// Adds those of the equations `which` that are sums. An equation with a single variable states that it is 0; the
    /// variable is dropped from all rows.
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

    /// Calls `found` with every equation from row `first` on that another one reduces to a single variable.
    ///
    /// Repeats until no pair is left, because each variable that is 0 makes other sums shorter. Of two rows the longer
    /// one is replaced, unless it is before `first`.
    fn reduce(&mut self, first: usize, mut found: impl FnMut(usize, VarId)) {
        let mut reduced = true;
        while std::mem::take(&mut reduced) {
            for row in 0..self.rows.len() {
                let Some((other, v)) = self.single_beside(row, first) else { continue };
                let replaced = if other >= first { other } else { row };
                found(self.rows[replaced].0, v);
                self.set_zero(v);
                // An empty row takes part in no further pair.
                self.rows[replaced].1.clear();
                reduced = true;
            }
        }
    }

    /// Drops a variable that is 0 from all rows.
    fn set_zero(&mut self, v: VarId) {
        for row in self.users.remove(&v).unwrap_or_default() {
            self.rows[row].1.retain(|term| term.0 != v);
        }
    }

    /// A partner for a row: another row that contains all its variables and at most one more, so that both together
    /// leave a single variable. Returns the partner and that variable. One of the two rows is at or after `first`.
    /// `None` where there is no partner.
    fn single_beside(&self, row: usize, first: usize) -> Option<(usize, VarId)> {
        let sum = &self.rows[row].1;
        // A partner contains all variables of the row, so it is enough to try the users of the rarest one.
        let rarest = sum.iter().map(|(v, _)| &self.users[v]).min_by_key(|rows| rows.len())?;
        let mut others = rarest.iter().copied().filter(|&other| other != row && row.max(other) >= first);
        others.find_map(|other| single(sum, &self.rows[other].1).map(|v| (other, v)))
    }
}

/// The factor of a variable in a sum; 0 where it does not occur. Binary search.
pub(super) fn factor(sum: &VariableSum, v: VarId) -> f64 {
    sum.binary_search_by_key(&v, |t| t.0).map_or(0.0, |i| sum[i].1)
}

/// The only variable that is left when a multiple of `b` is subtracted from `a`. `b` must be as long as `a` or longer
/// by one. `None` where more or less than one variable is left.
fn single(a: &VariableSum, b: &VariableSum) -> Option<VarId> {
    if a.len() < 2 || b.len() < a.len() || b.len() > a.len() + 1 {
        return None;
    }
    let ratios = a.iter().map(|&(v, x)| x / factor(b, v)).filter(|r| r.is_finite());
    // At most one variable does not cancel. So of the ratios of any two shared variables one is the right multiple.
    ratios.take(2).find_map(|ratio| {
        let all = a.iter().chain(b).map(|t| t.0);
        let left = |v: &VarId| {
            let (x, y) = (factor(a, *v), ratio * factor(b, *v));
            (x - y).abs() > CANCELLED * x.abs().max(y.abs())
        };
        // Each shared variable comes from both sums, so three entries are enough to see two different ones.
        let mut rest: Vec<VarId> = all.filter(left).take(3).collect();
        rest.dedup();
        match rest[..] {
            [v] => Some(v),
            _ => None,
        }
    })
}

/// The terms of `lhs - rhs` where that is a sum of continuous unknowns with factors that no run changes: numbers and
/// constants. `None` for anything else, for repeated variables, and for more than [`LONGEST`] terms.
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
    // A variable that occurs twice may cancel; such an equation is left to other steps.
    let distinct = found.windows(2).all(|pair| pair[0].0 != pair[1].0);
    (distinct && found.iter().all(|t| t.1 != 0.0 && t.1.is_finite())).then_some(found)
}
