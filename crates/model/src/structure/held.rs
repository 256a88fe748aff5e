//! Bodies that cannot move: their position is a constant, and its second derivative meets their acceleration.
//!
//! Enters: the system after index reduction. Leaves: notes. `analysis` calls [`find`] once.

use super::draft::{DaeDraft, SystemRole};
use super::pantelides::IndexReduction;
use super::{Alias, messages, places};
use crate::flat::FlatEquation;
use bramah_expr::VarId;
use bramah_syntax::diag::Diagnostic;

/// A note for each position that parameters alone fix. It is a note and no warning, because a locked rotor may be
/// intended.
/// A position that belongs to connectors only gives no note.
pub(super) fn find(draft: &DaeDraft, reduction: &IndexReduction, aliases: &[Alias]) -> Vec<Diagnostic> {
    let held = reduction.constraints_twice_differentiated().filter_map(|(v, row)| {
        let equation = draft.equations[row];
        let bodies = bodies(draft, aliases, v);
        (is_constant(draft, &equation, v) && !bodies.is_empty())
            .then(|| messages::held_still(draft, &bodies, &equation))
    });
    held.collect()
}

/// Whether an equation contains nothing but the variable `v` and parameters.
fn is_constant(draft: &DaeDraft, equation: &FlatEquation, v: VarId) -> bool {
    let found = draft.exprs.dependencies(&[equation.lhs, equation.rhs]);
    let known = |other: &VarId| *other == v || draft.role(*other) == SystemRole::Parameter;
    !found.time && found.ders.is_empty() && found.pres.is_empty() && found.vars.iter().all(known)
}

/// The names of a position outside of connectors, ascending: `v` and its aliases.
fn bodies(draft: &DaeDraft, aliases: &[Alias], v: VarId) -> Vec<VarId> {
    let others = aliases.iter().filter(|a| a.target == v).map(|a| a.variable);
    let own = |v: &VarId| !places::is_connector(&draft.variables, draft.variables[v.index()].origin.instance);
    let mut found: Vec<VarId> = std::iter::once(v).chain(others).filter(own).collect();
    found.sort_unstable();
    found
}
