//! A linear combination of equations as a new equation.
//!
//! Enters: rows that `elimination` found to be dependent. Leaves: the sum of their equations with symbolic factors,
//! written in the place of one of them. `expose` in the parent module calls [`EquationCombination::new`],
//! `contradiction` and `write`.

use super::super::draft::{DaeDraft, SystemRole};
use super::super::pantelides::IndexReduction;
use super::super::parameters::{self, SignAnalysis};
use super::SystemJacobian;
use super::elimination::RowCombination;
use super::linear::{LinearForm, Monomial};
use super::offsets::ChainPosition;
use super::symbolic::{self, MonomialSum};
use crate::flat::FlatEquation;
use bramah_expr::{ExprId, Exprs};
use bramah_syntax::diag::Diagnostic;

/// The sum of some equations, each differentiated so often that their derivatives of highest order cancel.
pub(super) struct EquationCombination {
    /// The rows of the Jacobian that take part, ascending.
    pub rows: Vec<usize>,
    /// The row whose equation the sum replaces.
    pub replaced: usize,
    /// Unknowns and their derivatives with their factors. Like terms are added up.
    terms: Vec<(ChainPosition, Monomial)>,
    /// All other terms, each with how often it is differentiated, and their factors.
    rest: Vec<((ExprId, u32), Monomial)>,
}

impl EquationCombination {
    /// Adds up the rows of a combination. `fixable` allows parameters to be fixed.
    ///
    /// `None` where the rows depend on each other by values only (of what changes, or of parameters that may not be
    /// fixed), where no row can be replaced, or where the sum still contains a derivative of highest order.
    /// `found` lists the rows with numeric factors, which hold for the present values only.
    pub fn new(
        draft: &mut DaeDraft,
        known: &mut SignAnalysis,
        (jacobian, reduction): (&SystemJacobian, &IndexReduction),
        found: &RowCombination,
        fixable: bool,
    ) -> Option<Self> {
        let rows: Vec<usize> = found.iter().map(|term| term.0).collect();
        let mut linear: Vec<LinearForm> =
            rows.iter().map(|&row| jacobian.linear(draft, known, reduction, row)).collect();
        let factors = factors(draft, known, jacobian, found, &mut linear, fixable)?;
        let offsets = || rows.iter().map(|&row| jacobian.offsets[row]);
        let least = offsets().min()?;
        // The replaced row must have the smallest offset, so that the others need only be differentiated, and a factor
        // that cannot vanish, so that the set of solutions stays the same.
        let mut may_be = |i: &usize| {
            let [factor]: &[Monomial] = &factors[*i] else { return false };
            jacobian.offsets[rows[*i]] == least && factor.expressions().all(|e| known.is_nonzero(&draft.exprs, e))
        };
        let is_number = |i: &usize| factors[*i].iter().all(Monomial::is_number);
        // A numeric factor is preferred to an expression; the last such row is taken.
        let place = (0..rows.len()).rev().find(|i| is_number(i) && may_be(i));
        let place = place.or_else(|| (0..rows.len()).rev().find(may_be))?;
        let mut made =
            EquationCombination { replaced: rows[place], terms: Vec::new(), rest: Vec::new(), rows: rows.clone() };
        for ((offset, linear), factors) in offsets().zip(&linear).zip(&factors) {
            let times = offset - least;
            // The derivative of a product with a varying factor would have more terms than are handled here.
            let varying = |e: ExprId| known.value(&draft.exprs, e).is_none();
            if times > 0 && linear.terms.iter().flat_map(|t| t.1.expressions()).any(varying) {
                return None;
            }
            for factor in factors {
                for ((chain, order), of_term) in &linear.terms {
                    add_to(&mut made.terms, (*chain, order + times), of_term.clone().times(factor, 1));
                }
                for (e, of_rest) in &linear.rest {
                    add_to(&mut made.rest, (*e, times), of_rest.clone().times(factor, 1));
                }
            }
        }
        made.is_lower(draft, known, (jacobian, reduction), least).then_some(made)
    }

    /// Whether no derivative of highest order is left, neither in terms nor in factors. `offset` is that of the
    /// replaced row.
    /// Only then has the combination lowered the order of the system.
    fn is_lower(
        &self,
        draft: &DaeDraft,
        known: &mut SignAnalysis,
        (jacobian, reduction): (&SystemJacobian, &IndexReduction),
        offset: u32,
    ) -> bool {
        let mut varying: Vec<ExprId> = Vec::new();
        for factor in self.terms.iter().map(|t| &t.1).chain(self.rest.iter().map(|t| &t.1)) {
            varying.extend(factor.expressions().filter(|&e| known.value(&draft.exprs, e).is_none()));
        }
        let rest = self.rest.iter().map(|&((e, times), _)| (e, offset + times));
        let mut parts = rest.chain(varying.iter().map(|&e| (e, offset)));
        self.terms.iter().all(|(place, _)| !jacobian.is_highest(*place, offset))
            && parts.all(|(e, offset)| !jacobian.holds_highest(draft, reduction, e, offset))
    }

    /// What is left where the sum contains no unknown: 0 where the equations repeat each other, else an expression that
    /// would have to be 0. `None` where the sum is an equation for unknowns.
    /// The caller ends the analysis with a message in the first two cases.
    pub fn contradiction(&self, draft: &mut DaeDraft) -> Option<ExprId> {
        let mut sum = Exprs::ZERO;
        for ((e, times), factor) in &self.rest {
            let found = draft.exprs.dependencies(&[*e]);
            let unknown = found.vars.iter().chain(&found.ders).any(|v| draft.role(*v) == SystemRole::Continuous);
            if unknown || *times > 0 {
                return None;
            }
            let factor = factor.expression(&mut draft.exprs);
            let term = draft.exprs.mul(factor, *e);
            sum = draft.exprs.add(sum, term);
        }
        self.terms.is_empty().then_some(sum)
    }

    /// Writes the sum in the place of equation `at`. Adds the derivatives that it needs. `Err` where one does not exist
    /// (E304).
    /// The equation becomes `sum = 0` and keeps its origin.
    pub fn write(&self, draft: &mut DaeDraft, reduction: &mut IndexReduction, at: usize) -> Result<(), Diagnostic> {
        let equation = draft.equations[at];
        let mut sum = Exprs::ZERO;
        let mut add = |draft: &mut DaeDraft, factor: &Monomial, e: ExprId| {
            let factor = factor.expression(&mut draft.exprs);
            let term = draft.exprs.mul(factor, e);
            sum = draft.exprs.add(sum, term);
        };
        for ((chain, order), factor) in &self.terms {
            let leaf = reduction.derivative_of(draft, *chain, *order);
            add(draft, factor, leaf);
        }
        for ((e, times), factor) in &self.rest {
            let mut e = *e;
            for _ in 0..*times {
                e = reduction.differentiate(draft, &equation, e)?;
            }
            add(draft, factor, e);
        }
        draft.equations[at] = FlatEquation { lhs: sum, rhs: Exprs::ZERO, ..equation };
        Ok(())
    }
}

/// Adds a term to the like one, if there is one. Terms that cancel are removed.
/// Two terms are like if their places and the expressions in their factors are equal.
fn add_to<T: PartialEq>(terms: &mut Vec<(T, Monomial)>, of: T, factor: Monomial) {
    let Some(at) = terms.iter().position(|t| t.0 == of && t.1.is_like(&factor)) else {
        return terms.push((of, factor));
    };
    match symbolic::sum(&terms[at].1, &factor) {
        Some(sum) => terms[at].1 = sum,
        None => drop(terms.swap_remove(at)),
    }
}

/// The factors by which rows add up to 0, one sum for each row.
///
/// First choice are factors that hold whatever the expressions in the rows are worth. Where rows depend on each other
/// only with the parameters as they are, these parameters are fixed if that is allowed, and the factors are numbers.
/// `None` where neither is possible.
/// Parameters that are fixed become constants of the model: see `parameters::fix`.
fn factors(
    draft: &mut DaeDraft,
    known: &mut SignAnalysis,
    jacobian: &SystemJacobian,
    found: &RowCombination,
    linear: &mut [LinearForm],
    fixable: bool,
) -> Option<Vec<MonomialSum>> {
    let rows: Vec<Vec<(u32, &Monomial)>> =
        found.iter().zip(&*linear).map(|(&(row, _), linear)| jacobian.entries(row, linear)).collect();
    let expressions: Vec<ExprId> = rows.iter().flatten().flat_map(|(_, factor)| factor.expressions()).collect();
    let numbers = || found.iter().map(|&(_, factor)| vec![Monomial::number(factor)]).collect();
    // All entries are numbers, so the factors of the elimination are exact up to rounding.
    if expressions.is_empty() {
        return Some(numbers());
    }
    if let Some(factors) = symbolic::factors(&rows) {
        return Some(factors);
    }
    if !fixable || expressions.iter().any(|&e| known.value(&draft.exprs, e).is_none()) {
        return None;
    }
    let parameters = draft.exprs.dependencies(&expressions).vars;
    parameters::fix(draft, &parameters);
    // With fixed parameters their factors are numbers; else like terms would not cancel.
    for factor in linear.iter_mut().flat_map(|l| &mut l.terms).map(|term| &mut term.1) {
        if factor.expressions().all(|e| known.value(&draft.exprs, e).is_some()) {
            *factor = Monomial::number(factor.value(draft, known));
        }
    }
    Some(numbers())
}
