//! State selection: dummy derivatives after S. E. Mattsson and G. Söderlind, Index reduction in differential-algebraic
//! equations using dummy derivatives, SIAM J. Sci. Comput. 14, 1993.
//!
//! Enters: the system after index reduction and the values of the parameters. Leaves: the derivatives that are not
//! integrated, and the groups in which another choice may become necessary. `analysis` calls [`select`] once.
//!
//! Every differentiated equation makes one derivative superfluous; that derivative becomes an algebraic unknown, a
//! dummy. The choice goes level by level, from the highest derivatives down. At each level a regular square part of the
//! Jacobian of the differentiated equations is chosen by Gaussian elimination: columns that should rather not be states
//! come first, and among equals the largest pivot wins.

use super::draft::DaeDraft;
use super::incidence::NONE;
use super::pantelides::IndexReduction;
use super::{StateChoice, StateSelection};
use crate::flat::StateSelect;
use bramah_expr::differentiate::Differentiator;
use bramah_expr::eval::EvaluationCache;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::FxHashMap;

/// The outcome of state selection.
#[derive(Debug, Default)]
pub(super) struct DummyChoice {
    /// Columns of the reduction that are dummies: derivatives that are not integrated. Ascending.
    pub dummies: Vec<u32>,
    /// Groups among which another choice may become necessary.
    pub selections: Vec<StateSelection>,
}

/// Chooses the dummies of a reduced system, as many as there are differentiated equations.
///
/// `parameters` has a value for each variable, NaN where it is no known parameter. `preferred` lists states that the
/// solver asks for.
///
/// An example is the pendulum in Cartesian coordinates: `x^2 + y^2 = L^2` is differentiated twice. At the higher level
/// one of the two accelerations becomes a dummy, at the lower level the velocity in the same coordinate. The position
/// and the velocity in the other coordinate remain as states.
pub(super) fn select(
    draft: &mut DaeDraft,
    reduction: &IndexReduction,
    parameters: &[f64],
    preferred: &StateChoice,
) -> DummyChoice {
    let mut choice = DummyChoice::default();
    // Index at most 1: all derivatives are integrated.
    if reduction.is_trivial() {
        return choice;
    }
    let mut level = DerivativeLevel::highest(draft, reduction);
    while !level.rows.is_empty() {
        let dummies = level.solve(draft, reduction, parameters, preferred, &mut choice.selections);
        choice.dummies.extend_from_slice(&dummies);
        level = level.below(reduction, &dummies);
    }
    choice.dummies.sort_unstable();
    choice
}

/// The differentiated equations of one level, with the derivatives in them that may become dummies.
struct DerivativeLevel {
    /// One row for each equation.
    rows: Vec<LevelRow>,
}

/// A differentiated equation. Its Jacobian entries are the same at every level: the partial derivative of `dF/dt` by
/// `dx/dt` is that of `F` by `x`.
#[derive(Clone, Debug)]
struct LevelRow {
    /// The row of the reduction at this level.
    row: u32,
    /// Columns of this level with the partial derivatives by them. Entries that are 0 are left out.
    entries: Vec<(u32, ExprId)>,
}

impl DerivativeLevel {
    /// The first level: equations that were differentiated and not differentiated again.
    fn highest(draft: &mut DaeDraft, reduction: &IndexReduction) -> DerivativeLevel {
        // One differentiator for each column: it keeps the derivatives of subexpressions that rows share.
        let mut by_leaf: FxHashMap<u32, Differentiator> = FxHashMap::default();
        let mut rows = Vec::new();
        for row in 0..reduction.equations.len() as u32 {
            if reduction.integral[row as usize] == NONE || reduction.derivative[row as usize] != NONE {
                continue;
            }
            let equation = draft.equations[reduction.equations[row as usize] as usize];
            let residual = draft.exprs.sub(equation.lhs, equation.rhs);
            // A highest derivative that is the variable itself was never differentiated and cannot become a dummy.
            let columns: Vec<u32> =
                reduction.highest(row).filter(|&c| reduction.columns[c as usize].integral != NONE).collect();
            let mut entries = Vec::with_capacity(columns.len());
            for c in columns {
                let leaf = reduction.leaf(&mut draft.exprs, c);
                let by = by_leaf.entry(c).or_insert_with(|| Differentiator::new(leaf));
                entries.push((c, by.derive(&mut draft.exprs, residual)));
            }
            entries.retain(|&(_, e)| e != Exprs::ZERO);
            rows.push(LevelRow { row, entries });
        }
        DerivativeLevel { rows }
    }

    /// The next lower level: predecessors of the rows that are themselves derivatives, with the integrals of the
    /// dummies as candidates. The order of a dummy is lowered by one because the lower derivative has to be chosen from
    /// the same chain.
    fn below(&self, reduction: &IndexReduction, dummies: &[u32]) -> DerivativeLevel {
        let is_dummy: rustc_hash::FxHashSet<u32> = dummies.iter().copied().collect();
        let mut rows = Vec::new();
        for row in &self.rows {
            let lower = reduction.integral[row.row as usize];
            if reduction.integral[lower as usize] == NONE {
                continue;
            }
            let dummies = row.entries.iter().filter(|(c, _)| is_dummy.contains(c));
            let entries = dummies
                .map(|&(c, e)| (reduction.columns[c as usize].integral, e))
                .filter(|&(c, _)| reduction.columns[c as usize].integral != NONE);
            rows.push(LevelRow { row: lower, entries: entries.collect() });
        }
        DerivativeLevel { rows }
    }

    /// Chooses as many dummies as rows, group by group of rows that share columns. Appends to `selections` the groups
    /// whose choice may have to change during the run.
    fn solve(
        &self,
        draft: &mut DaeDraft,
        reduction: &IndexReduction,
        parameters: &[f64],
        preferred: &StateChoice,
        selections: &mut Vec<StateSelection>,
    ) -> Vec<u32> {
        let mut all = Vec::new();
        for group in self.groups() {
            let rows: Vec<&LevelRow> = group.iter().map(|&i| &self.rows[i as usize]).collect();
            let order = candidates(draft, reduction, &rows, preferred);
            let dummies = eliminate(draft, &rows, &order, parameters);
            selections.extend(selection(draft, reduction, &rows, &order, &dummies));
            all.extend(dummies);
        }
        all
    }

    /// Row numbers, grouped: two rows are in one group if they share columns, directly or through other rows. Groups
    /// are independent of each other, which keeps the eliminations small.
    fn groups(&self) -> Vec<Vec<u32>> {
        let mut union = petgraph::unionfind::UnionFind::<u32>::new(self.rows.len());
        let mut first: FxHashMap<u32, u32> = FxHashMap::default();
        for (i, row) in self.rows.iter().enumerate() {
            for (c, _) in &row.entries {
                let owner = *first.entry(*c).or_insert(i as u32);
                union.union(owner, i as u32);
            }
        }
        let mut index: FxHashMap<u32, usize> = FxHashMap::default();
        let mut groups: Vec<Vec<u32>> = Vec::new();
        for i in 0..self.rows.len() as u32 {
            let slot = *index.entry(union.find(i)).or_insert(groups.len());
            if slot == groups.len() {
                groups.push(Vec::new());
            }
            groups[slot].push(i);
        }
        groups
    }
}

/// A candidate: how much its integral should be a state, and its column. Smaller becomes a dummy first.
type DummyRank = (StatePreference, u32);

/// How much a variable should be a state; the fields are compared in their order. Larger values rather stay states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StatePreference {
    /// The attribute `stateSelect`.
    select: StateSelect,
    /// The solver asks for it, in a [`StateChoice`].
    asked: bool,
    /// Its start is a condition: `fixed`, or given by the model for one of its components.
    said: bool,
    /// It has a start value.
    given: bool,
}

/// The columns of some rows with their preference, least wanted states first.
/// Columns of equal preference come in ascending order.
fn candidates(
    draft: &DaeDraft,
    reduction: &IndexReduction,
    rows: &[&LevelRow],
    preferred: &StateChoice,
) -> Vec<DummyRank> {
    let mut columns: Vec<u32> = rows.iter().flat_map(|row| row.entries.iter().map(|&(c, _)| c)).collect();
    columns.sort_unstable();
    columns.dedup();
    let wish = |c: u32| {
        let v = integral_variable(reduction, c);
        let attributes = &draft.variables[v.index()];
        // A choice asked for by the solver goes before everything but `never` and `always`.
        // A choice asked for by the solver goes before everything but `never` and `always`.
        let asked = preferred.preferred.contains(&v);
        let select = match attributes.state_select {
            StateSelect::Avoid | StateSelect::Default | StateSelect::Prefer if asked => StateSelect::Prefer,
            other => other,
        };
        StatePreference { select, asked, said: attributes.start_is_said(), given: attributes.start.is_some() }
    };
    let mut ranked: Vec<DummyRank> = columns.into_iter().map(|c| (wish(c), c)).collect();
    ranked.sort_unstable();
    ranked
}

/// The variable of which a column is the derivative.
fn integral_variable(reduction: &IndexReduction, column: u32) -> VarId {
    let integral = reduction.columns[column as usize].integral;
    reduction.variable(integral).expect("a derivative of a derivative has made the latter a variable")
}

/// The dummies of one group.
///
/// The Jacobian is evaluated where the run starts. Entries that vanish there by accident or cannot be evaluated may
/// lower the rank; then the elimination is repeated at a shifted point.
/// With `shift` 1 a full rank is likely: only a Jacobian that is singular almost everywhere stays deficient.
fn eliminate(draft: &DaeDraft, rows: &[&LevelRow], order: &[DummyRank], parameters: &[f64]) -> Vec<u32> {
    // What the solver asks for fits the point that the run has reached, not the start.
    if !order.iter().any(|(wish, _)| wish.asked) {
        let at_start = CoefficientPoint { draft, parameters, shift: 0.0 };
        let found = pivots(rows, order, &mut at_start.values(rows));
        if found.len() == rows.len() {
            return found;
        }
    }
    let elsewhere = CoefficientPoint { draft, parameters, shift: 1.0 };
    pivots(rows, order, &mut elsewhere.values(rows))
}

/// A point at which coefficients are evaluated: start values, moved by an irregular amount times `shift`.
struct CoefficientPoint<'a> {
    /// The system.
    draft: &'a DaeDraft,
    /// By variable: the value of a parameter, NaN for others.
    parameters: &'a [f64],
    /// 0 for the start itself, 1 for a generic point.
    shift: f64,
}

impl CoefficientPoint<'_> {
    /// The entries of the rows as numbers: one map from columns to values for each row. What is not finite counts as 0.
    fn values(&self, rows: &[&LevelRow]) -> Vec<FxHashMap<u32, f64>> {
        let mut evaluation = EvaluationCache::default();
        let mut value = |e: ExprId| {
            let found = evaluation.value(&self.draft.exprs, e, &mut |node| self.leaf(node));
            if found.is_finite() { found } else { 0.0 }
        };
        rows.iter().map(|row| row.entries.iter().map(|&(c, e)| (c, value(e))).collect()).collect()
    }

    /// The value of a leaf at this point. Derivatives and `pre` values are 0 at the start.
    fn leaf(&self, node: ExprNode) -> f64 {
        match node {
            ExprNode::Var(v) if !self.parameters.get(v.index()).is_none_or(|p| p.is_nan()) => {
                self.parameters[v.index()]
            }
            ExprNode::Var(v) => self.start(v) + self.shift * irregular(v),
            ExprNode::Der(v) | ExprNode::Pre(v) => self.shift * irregular(v),
            _ => 0.0,
        }
    }

    /// The start value of a variable; 0 where none is given.
    fn start(&self, v: VarId) -> f64 {
        let parameter = |node: ExprNode| match node {
            ExprNode::Var(p) => self.parameters.get(p.index()).copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let given = self.draft.variables[v.index()].start;
        given.map_or(0.0, |e| self.draft.exprs.eval(e, &mut { parameter }))
    }
}

/// A number between 0.3 and 1.3 that depends on the variable without a pattern: multiples of the golden ratio modulo 1.
/// So coefficients of different variables do not cancel by accident.
fn irregular(v: VarId) -> f64 {
    0.3 + (f64::from(v.0) * 0.618_033_988_749_895 + 0.1).fract()
}

/// A pivot below this part of the largest entry of its row counts as 0.
const SMALLEST_PIVOT: f64 = 1e-6;

/// Gaussian elimination that returns the pivot columns, at most as many as rows.
///
/// `order` is worked through class by class of equal preference, least wanted states first; within a class the largest
/// scaled pivot is taken. `values` is overwritten.
///
/// A class with more than 500 columns is taken in order, since the best pivot would cost a search over the class each
/// time.
fn pivots(rows: &[&LevelRow], order: &[DummyRank], values: &mut [FxHashMap<u32, f64>]) -> Vec<u32> {
    // Scaling by rows makes pivots of equations in different units comparable.
    let scales: Vec<f64> = values.iter().map(|row| row.values().fold(0.0, |m: f64, v| m.max(v.abs()))).collect();
    let mut free: Vec<usize> = (0..rows.len()).collect();
    let mut by_column: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for (i, row) in rows.iter().enumerate() {
        for (c, _) in &row.entries {
            by_column.entry(*c).or_default().push(i);
        }
    }
    let mut is_free = vec![true; rows.len()];
    let mut found = Vec::with_capacity(rows.len());
    for class in order.chunk_by(|a, b| a.0 == b.0) {
        let mut open: Vec<u32> = class.iter().map(|&(_, c)| c).collect();
        while !open.is_empty() && !free.is_empty() {
            let best = open.iter().enumerate().filter_map(|(at, &c)| {
                let rows = by_column.get(&c)?;
                let candidates = rows.iter().filter(|&&r| is_free[r]);
                let scaled =
                    candidates.map(|&r| (values[r].get(&c).map_or(0.0, |v| v.abs()) / scales[r].max(1e-300), r));
                let (size, row) = scaled.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
                (size > SMALLEST_PIVOT).then_some((size, at, row))
            });
            // A large class is taken in order: looking for the best pivot each time would be quadratic.
            let best = if open.len() > 500 {
                { best }.next()
            } else {
                best.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))
            };
            // No column of this class has a usable pivot; the next class may have one.
            let Some((_, at, row)) = best else { break };
            let column = open.remove(at);
            found.push(column);
            is_free[row] = false;
            free.retain(|&r| r != row);
            reduce_rows(values, &mut by_column, row, column, &is_free);
        }
    }
    found
}

/// Subtracts multiples of the pivot row from all free rows, so that the column vanishes in them. Updates `by_column`
/// for new entries.
fn reduce_rows(
    values: &mut [FxHashMap<u32, f64>],
    by_column: &mut FxHashMap<u32, Vec<usize>>,
    pivot: usize,
    column: u32,
    is_free: &[bool],
) {
    let mut pivot_row: Vec<(u32, f64)> = values[pivot].iter().map(|(&c, &v)| (c, v)).collect();
    // The order of a hash map varies; sorted entries keep the result deterministic.
    pivot_row.sort_unstable_by_key(|entry| entry.0);
    let by = values[pivot][&column];
    let mut targets: Vec<usize> = by_column[&column].iter().copied().filter(|&r| is_free[r]).collect();
    targets.sort_unstable();
    targets.dedup();
    for row in targets {
        let factor = values[row].get(&column).copied().unwrap_or(0.0) / by;
        if factor == 0.0 {
            continue;
        }
        for &(c, v) in &pivot_row {
            let before = values[row].get(&c).copied();
            let after = before.unwrap_or(0.0) - factor * v;
            // A difference of rounding errors would become a pivot of no meaning.
            let vanished = c == column || after.abs() <= 1e-12 * (factor * v).abs();
            values[row].insert(c, if vanished { 0.0 } else { after });
            if before.is_none() {
                by_column.entry(c).or_default().push(row);
            }
        }
    }
}

/// Jacobians with more entries are not handed on: to watch them would cost more than the run.
const LARGEST_SELECTION: usize = 1_000_000;

/// The record of a group for the solver. `None` where the Jacobian is constant, where all candidates are dummies, or
/// where the Jacobian is too large.
fn selection(
    draft: &DaeDraft,
    reduction: &IndexReduction,
    rows: &[&LevelRow],
    order: &[DummyRank],
    dummies: &[u32],
) -> Option<StateSelection> {
    // A constant Jacobian stays regular during the run.
    let varying = rows.iter().flat_map(|row| &row.entries).any(|&(_, e)| {
        let found = draft.exprs.dependencies(&[e]);
        found.time
            || !found.ders.is_empty()
            || found.vars.iter().any(|&v| draft.role(v) != super::draft::SystemRole::Parameter)
    });
    if !varying || order.len() == rows.len() || order.len() * rows.len() > LARGEST_SELECTION {
        return None;
    }
    let mut columns: Vec<u32> = order.iter().map(|&(_, c)| c).collect();
    columns.sort_unstable();
    let entry = |row: &LevelRow, c: u32| row.entries.iter().find(|e| e.0 == c).map_or(Exprs::ZERO, |e| e.1);
    let mut dummies: Vec<VarId> = dummies.iter().map(|&c| integral_variable(reduction, c)).collect();
    dummies.sort_unstable();
    Some(StateSelection {
        candidates: columns.iter().map(|&c| integral_variable(reduction, c)).collect(),
        dummies,
        rows: rows.iter().map(|row| columns.iter().map(|&c| entry(row, c)).collect()).collect(),
    })
}
