//! Linear dependence between equations that their structure does not show.
//!
//! `v1 = a - b`, `v2 = b - c` and `v3 = c - a` can be matched with `a`, `b` and `c`, yet their sum says `v1 + v2 + v3 =
//! 0`: of three capacitors in a ring only two are states. Index reduction by structure differentiates a constraint only
//! where it is written as one. So it is written here: where equations have a linear combination in which all
//! derivatives of highest order cancel, the combination replaces that one of them which is differentiated least.
//! Factors may be constants, parameters, and single expressions that change: where mass passes a node, `rho(p) q_a +
//! m_a = 0`, `rho(p) q_b + m_b = 0` and `q_a + q_b = 0` say `m_a + m_b = 0`.
//!
//! Let `c` be the offsets of the equations and `d` those of the variables (see `offsets`). The entry `(i, j)` of the
//! system Jacobian is the partial derivative of `f_i` by the derivative of order `d_j - c_i` of `x_j`. Where `u J = 0`
//! for the rows of a set, the `f_l` with the smallest offset is replaced by the sum of `u_i` times `f_i` differentiated
//! `c_i - c_l` times. Each replacement makes the sum of `d` minus that of `c` smaller, so the process ends. It is the
//! linear combination method of G. Tan, N. Nedialkov and J. Pryce (Conversion methods for improving structural analysis
//! of differential-algebraic equation systems, BIT 57, 2017).
//!
//! `offsets` computes `c` and `d`, `linear` reads equations as sums, `elimination` finds the dependent rows with
//! numbers, `symbolic` finds their factors as expressions, `combination` writes the new equation. `analysis` calls
//! [`expose`] before index reduction; `initial` calls [`following`].

mod combination;
mod elimination;
mod linear;
mod offsets;
mod symbolic;

use super::draft::DaeDraft;
use super::messages;
use super::pantelides::IndexReduction;
use super::parameters::SignAnalysis;
use crate::flat::FlatEquation;
use bramah_expr::visit::NodeTraversal;
use bramah_expr::{ExprId, ExprNode, VarId};
use bramah_syntax::diag::Diagnostic;
use combination::EquationCombination;
use elimination::RowCombination;
use linear::{LinearForm, Monomial};
use offsets::{ChainPosition, DerivativeOffsets};

/// The columns and rows of the continuous equations, after every hidden constraint has been written as one.
///
/// `fixable` says whether parameters may be fixed with the structure where equations depend on each other only by their
/// values. Errors: equations that repeat each other (E301) or contradict each other (E303), constraints that cannot be
/// differentiated (E304).
pub(super) fn expose(
    draft: &mut DaeDraft,
    known: &mut SignAnalysis,
    fixable: bool,
) -> Result<IndexReduction, Diagnostic> {
    let mut degrees = i64::MAX;
    loop {
        let mut reduction = IndexReduction::new(draft);
        let places = offsets::places(&reduction);
        // Without offsets the system is structurally singular, which `reduce` reports. The sum of degrees must fall
        // with each round; where it does not, the combinations have exposed nothing.
        let offsets = DerivativeOffsets::new(&reduction, &places).filter(|found| found.degrees() < degrees);
        let Some(offsets) = offsets else { return Ok(reduction) };
        degrees = offsets.degrees();
        let jacobian = SystemJacobian::new(draft, known, &reduction, (places, offsets));
        let mut changed: Vec<usize> = Vec::new();
        for found in jacobian.vanishing() {
            // The combination was found with the old form of an equation; the next round looks at the new form.
            if found.iter().any(|(row, _)| changed.contains(row)) {
                continue;
            }
            let Some(combined) = EquationCombination::new(draft, known, (&jacobian, &reduction), &found, fixable)
            else {
                continue;
            };
            if let Some(left) = combined.contradiction(draft) {
                return Err(jacobian.explain(draft, known, &reduction, &combined.rows, left));
            }
            combined.write(draft, &mut reduction, jacobian.equations[combined.replaced])?;
            changed.push(combined.replaced);
        }
        if changed.is_empty() {
            return Ok(reduction);
        }
    }
}

/// Equations, by their position, that follow from others before them with the parameters as they are. `column` gives
/// the column of a leaf that is an unknown. Equations that are not linear in the unknowns take no part. Ascending.
pub(super) fn following(
    draft: &DaeDraft,
    known: &mut SignAnalysis,
    equations: &[FlatEquation],
    column: impl Fn(ExprNode) -> Option<u32>,
) -> Vec<usize> {
    let mut walk = NodeTraversal::default();
    let (mut places, mut rows, mut columns) = (Vec::new(), Vec::new(), 0);
    for (i, equation) in equations.iter().enumerate() {
        let linear = LinearForm::new(draft, known, [equation.lhs, equation.rhs], |leaf| Some((column(leaf)?, 0)));
        let factors = linear.terms.iter().flat_map(|(_, factor)| factor.expressions());
        // What is no linear term must be free of unknowns, factors included.
        let others: Vec<ExprId> = linear.rest.iter().map(|term| term.0).chain(factors).collect();
        let mut is_linear = true;
        walk.each(&draft.exprs, &others, |_, node| {
            is_linear &= column(node).is_none();
            is_linear
        });
        let entries: Vec<(u32, &Monomial)> = linear.terms.iter().map(|((c, _), factor)| (*c, factor)).collect();
        if let Some(row) = row(draft, known, &entries).filter(|_| is_linear) {
            columns = row.iter().fold(columns, |most, entry| most.max(entry.0 as usize + 1));
            places.push(i);
            rows.push(row);
        }
    }
    elimination::following(&rows, columns).into_iter().map(|row| places[row]).collect()
}

/// The system Jacobian, restricted to the equations that are linear in the derivatives of highest order. Its columns
/// are chains: a variable with its derivatives.
struct SystemJacobian {
    /// By column of the reduction: its chain and its order in the chain.
    places: Vec<ChainPosition>,
    /// By chain: the order of its highest derivative after index reduction.
    highest: Vec<u32>,
    /// By row: the index of its equation in the draft.
    equations: Vec<usize>,
    /// By row: how often the equation will be differentiated.
    offsets: Vec<u32>,
    /// By row: the numeric factors of highest derivatives, by chain.
    rows: Vec<elimination::EliminationRow>,
    /// By chain: whether some equation contains its highest derivative other than linearly.
    beyond: Vec<bool>,
}

impl SystemJacobian {
    /// Collects the rows of all equations of the reduction.
    fn new(
        draft: &DaeDraft,
        known: &mut SignAnalysis,
        reduction: &IndexReduction,
        (places, DerivativeOffsets { rows: offsets, chains: highest }): (Vec<ChainPosition>, DerivativeOffsets),
    ) -> Self {
        let beyond = vec![false; places.len()];
        let (equations, rows) = (Vec::new(), Vec::new());
        let mut made = SystemJacobian { places, highest, equations, offsets: Vec::new(), rows, beyond };
        let mut walk = NodeTraversal::default();
        for (&equation, offset) in reduction.equations.iter().zip(offsets) {
            let linear = made.linear_form(draft, known, reduction, equation as usize);
            // The chains whose highest derivative occurs in some expressions.
            let mut within = |parts: Vec<ExprId>| {
                let mut chains = Vec::new();
                walk.each(&draft.exprs, &parts, |_, node| {
                    let place = made.place(draft, reduction, node);
                    chains.extend(place.filter(|&place| made.is_highest(place, offset)).map(|place| place.0));
                    true
                });
                chains
            };
            let entries = made.entries_at(offset, &linear);
            let in_factors = within(entries.iter().flat_map(|(_, factor)| factor.expressions()).collect());
            let in_rest = within(linear.rest.iter().map(|term| term.0).collect());
            // A highest derivative in the rest makes the equation nonlinear: it is no row.
            let row = row(draft, known, &entries).filter(|_| in_rest.is_empty());
            let chains = entries.iter().map(|entry| entry.0).filter(|_| row.is_none());
            let beyond: Vec<u32> = chains.chain(in_rest.iter().chain(&in_factors).copied()).collect();
            beyond.into_iter().for_each(|chain| made.beyond[chain as usize] = true);
            if let Some(row) = row {
                made.equations.push(equation as usize);
                made.offsets.push(offset);
                made.rows.push(row);
            }
        }
        made
    }

    /// The chain and order of a leaf; `None` for what is no continuous unknown.
    fn place(&self, draft: &DaeDraft, reduction: &IndexReduction, leaf: ExprNode) -> Option<ChainPosition> {
        reduction.column(draft, leaf).map(|c| self.places[c as usize])
    }

    /// Whether the derivative at this place becomes a highest derivative when an equation with this offset is
    /// differentiated.
    fn is_highest(&self, (chain, order): ChainPosition, offset: u32) -> bool {
        order + offset == self.highest[chain as usize]
    }

    /// The equation of a row as a sum.
    fn linear(&self, draft: &DaeDraft, known: &mut SignAnalysis, reduction: &IndexReduction, row: usize) -> LinearForm {
        self.linear_form(draft, known, reduction, self.equations[row])
    }

    /// An equation of the draft as a sum.
    /// Its places are those of the present reduction.
    fn linear_form(
        &self,
        draft: &DaeDraft,
        known: &mut SignAnalysis,
        reduction: &IndexReduction,
        equation: usize,
    ) -> LinearForm {
        let sides = [draft.equations[equation].lhs, draft.equations[equation].rhs];
        LinearForm::new(draft, known, sides, |leaf| self.place(draft, reduction, leaf))
    }

    /// The terms of a row that contain highest derivatives, by chain. A chain may occur more than once.
    /// The factors are borrowed from the sum.
    fn entries<'l>(&self, row: usize, linear: &'l LinearForm) -> Vec<(u32, &'l Monomial)> {
        self.entries_at(self.offsets[row], linear)
    }

    /// The terms that contain highest derivatives for an equation with this offset.
    fn entries_at<'l>(&self, offset: u32, linear: &'l LinearForm) -> Vec<(u32, &'l Monomial)> {
        let highest = linear.terms.iter().filter(|(place, _)| self.is_highest(*place, offset));
        highest.map(|((chain, _), factor)| (*chain, factor)).collect()
    }

    /// Whether an expression in an equation with this offset contains a highest derivative.
    fn holds_highest(&self, draft: &DaeDraft, reduction: &IndexReduction, e: ExprId, offset: u32) -> bool {
        let mut found = false;
        NodeTraversal::default().each(&draft.exprs, &[e], |_, node| {
            found |= self.place(draft, reduction, node).is_some_and(|place| self.is_highest(place, offset));
            !found
        });
        found
    }

    /// The linear combinations of rows that vanish, with numeric factors.
    /// Each combination is minimal: without one of its rows the others are independent.
    fn vanishing(&self) -> Vec<RowCombination> {
        elimination::vanishing(&self.rows, self.places.len())
    }

    /// The diagnostic where equations add up to nothing, or to `left`, which contains no unknown.
    /// One equation alone means that its own unknowns cancel.
    fn explain(
        &self,
        draft: &DaeDraft,
        known: &mut SignAnalysis,
        reduction: &IndexReduction,
        rows: &[usize],
        left: ExprId,
    ) -> Diagnostic {
        let equations: Vec<FlatEquation> = rows.iter().map(|&row| draft.equations[self.equations[row]]).collect();
        if let [only] = equations.as_slice() {
            return messages::cancelling(draft, only);
        }
        if known.value(&draft.exprs, left) != Some(0.0) {
            return messages::contradiction(draft, &equations, left);
        }
        let free = self.free_combination();
        let free: Vec<(VarId, f64)> =
            free.iter().filter_map(|&(chain, part)| Some((reduction.variable(chain)?, part))).collect();
        messages::repeated(draft, &equations, &free)
    }

    /// Chains that can change together while every equation holds, each with its part: a vector of the null space. The
    /// columns of the Jacobian take the place of rows for this. Empty where there is none.
    fn free_combination(&self) -> Vec<(u32, f64)> {
        let mut columns: Vec<elimination::EliminationRow> = vec![Vec::new(); self.places.len()];
        for (r, row) in self.rows.iter().enumerate() {
            row.iter().for_each(|&(chain, value)| columns[chain as usize].push((r as u32, value)));
        }
        // A chain that occurs nonlinearly may be determined by what is not in the Jacobian.
        let linear = |&c: &usize| !self.beyond[c] && !columns[c].is_empty();
        let chains: Vec<usize> = (0..columns.len()).filter(linear).collect();
        let columns: Vec<elimination::EliminationRow> = chains.iter().map(|&c| columns[c].clone()).collect();
        let found = elimination::vanishing(&columns, self.rows.len()).into_iter().next().unwrap_or_default();
        found.into_iter().map(|(i, part)| (chains[i] as u32, part)).collect()
    }
}

/// A row of numbers from its entries: the factors of each chain added up, in ascending order of chains. `None` where a
/// factor is 0 or not finite with the parameters as they are.
fn row(
    draft: &DaeDraft,
    known: &mut SignAnalysis,
    entries: &[(u32, &Monomial)],
) -> Option<elimination::EliminationRow> {
    let mut row = elimination::EliminationRow::new();
    for (chain, factor) in entries {
        let value = factor.value(draft, known);
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        match row.iter_mut().find(|entry| entry.0 == *chain) {
            Some(entry) => entry.1 += value,
            None => row.push((*chain, value)),
        }
    }
    row.retain(|entry| entry.1 != 0.0);
    row.sort_unstable_by_key(|entry| entry.0);
    Some(row)
}
