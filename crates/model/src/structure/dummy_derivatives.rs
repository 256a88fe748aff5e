//! Which variables are integrated: dummy derivatives after Mattsson and Söderlind (SIAM J. Sci. Comput. 14, 1993).
//!
//! Every differentiated equation makes one derivative superfluous; it becomes an algebraic unknown, a dummy. Level by
//! level, from the highest derivatives down, a regular square part of the Jacobian of the differentiated equations is
//! chosen by elimination: columns that should rather not be states are offered first, and among equals the largest
//! pivot wins.

use super::draft::DaeDraft;
use super::incidence::NONE;
use super::pantelides::IndexReduction;
use super::{StateChoice, StateSelection};
use crate::flat::StateSelect;
use bramah_expr::differentiate::Differentiator;
use bramah_expr::eval::EvaluationCache;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::FxHashMap;

/// What came out.
#[derive(Debug, Default)]
pub(super) struct DummyChoice {
    /// Columns that are dummies: derivatives that are not integrated.
    pub dummies: Vec<u32>,
    /// Groups among which another choice may become necessary.
    pub selections: Vec<StateSelection>,
}

/// Chooses the dummies of a reduced system.
pub(super) fn select(
    draft: &mut DaeDraft,
    reduction: &IndexReduction,
    parameters: &[f64],
    preferred: &StateChoice,
) -> DummyChoice {
    let mut choice = DummyChoice::default();
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

/// The differentiated equations of one level, with the derivatives of them that may become dummies.
struct DerivativeLevel {
    rows: Vec<LevelRow>,
}

/// A differentiated equation: its Jacobian entries do not change from level to level.
#[derive(Clone, Debug)]
struct LevelRow {
    /// The row of the reduction at this level.
    row: u32,
    /// Columns of this level with the partial derivatives by them.
    entries: Vec<(u32, ExprId)>,
}

impl DerivativeLevel {
    fn highest(draft: &mut DaeDraft, reduction: &IndexReduction) -> DerivativeLevel {
        let mut by_leaf: FxHashMap<u32, Differentiator> = FxHashMap::default();
        let mut rows = Vec::new();
        for row in 0..reduction.equations.len() as u32 {
            if reduction.integral[row as usize] == NONE || reduction.derivative[row as usize] != NONE {
                continue;
            }
            let equation = draft.equations[reduction.equations[row as usize] as usize];
            let residual = draft.exprs.sub(equation.lhs, equation.rhs);
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

    /// The level below: predecessors that are themselves derivatives, with the integrals of the dummies.
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

    /// As many dummies as rows, group by group of rows that share columns.
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

    /// Rows connected by common columns.
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

/// A column with how much its integral wants to be a state; smaller becomes a dummy first.
type DummyRank = (StatePreference, u32);

/// Larger values rather stay states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StatePreference {
    select: StateSelect,
    asked: bool,
    said: bool,
    given: bool,
}

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

/// The values of the Jacobian where the run starts; entries that vanish there by accident or cannot be evaluated are
/// tried again at some other point if the rank is too low.
fn eliminate(draft: &DaeDraft, rows: &[&LevelRow], order: &[DummyRank], parameters: &[f64]) -> Vec<u32> {
    // What the solver asks for fits the point that the run has come to, not the start.
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

/// Where coefficients are evaluated: start values, moved by an irregular amount times `shift`.
struct CoefficientPoint<'a> {
    draft: &'a DaeDraft,
    parameters: &'a [f64],
    shift: f64,
}

impl CoefficientPoint<'_> {
    /// Dense enough for elimination: by row, column and value.
    fn values(&self, rows: &[&LevelRow]) -> Vec<FxHashMap<u32, f64>> {
        let mut evaluation = EvaluationCache::default();
        let mut value = |e: ExprId| {
            let found = evaluation.value(&self.draft.exprs, e, &mut |node| self.leaf(node));
            if found.is_finite() { found } else { 0.0 }
        };
        rows.iter().map(|row| row.entries.iter().map(|&(c, e)| (c, value(e))).collect()).collect()
    }

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

    fn start(&self, v: VarId) -> f64 {
        let parameter = |node: ExprNode| match node {
            ExprNode::Var(p) => self.parameters.get(p.index()).copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let given = self.draft.variables[v.index()].start;
        given.map_or(0.0, |e| self.draft.exprs.eval(e, &mut { parameter }))
    }
}

/// A number that depends on the variable without any pattern, between 0.3 and 1.3.
fn irregular(v: VarId) -> f64 {
    0.3 + (f64::from(v.0) * 0.618_033_988_749_895 + 0.1).fract()
}

/// Pivots below this part of the largest entry of their row count as 0.
const SMALLEST_PIVOT: f64 = 1e-6;

/// Columns of a regular square part, least wanted states first; among columns of equal wish the best pivot first.
fn pivots(rows: &[&LevelRow], order: &[DummyRank], values: &mut [FxHashMap<u32, f64>]) -> Vec<u32> {
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

/// Clears a column from all free rows with the pivot row.
fn reduce_rows(
    values: &mut [FxHashMap<u32, f64>],
    by_column: &mut FxHashMap<u32, Vec<usize>>,
    pivot: usize,
    column: u32,
    is_free: &[bool],
) {
    let mut pivot_row: Vec<(u32, f64)> = values[pivot].iter().map(|(&c, &v)| (c, v)).collect();
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
            let vanished = c == column || after.abs() <= 1e-12 * (factor * v).abs();
            values[row].insert(c, if vanished { 0.0 } else { after });
            if before.is_none() {
                by_column.entry(c).or_default().push(row);
            }
        }
    }
}

/// Larger Jacobians are not handed on: watching them would cost more than the run.
const LARGEST_SELECTION: usize = 1_000_000;

/// The record of a group whose Jacobian changes during the run and that leaves a choice.
fn selection(
    draft: &DaeDraft,
    reduction: &IndexReduction,
    rows: &[&LevelRow],
    order: &[DummyRank],
    dummies: &[u32],
) -> Option<StateSelection> {
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
