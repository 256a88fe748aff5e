//! The list of all expressions of a flat model, for what must change every one of them.
//!
//! A new field with expressions must be added to [`FlatModel::roots`], else compaction leaves stale expressions in it.

use super::{FlatAssertion, FlatModel, MessagePart, WhenAction};
use bramah_expr::ExprId;

impl FlatModel {
    /// Drops expressions that nothing refers to. All `ExprId`s of the model are renumbered.
    /// `flatten` calls it if the model has functions.
    pub(super) fn compact(&mut self) {
        let mut pool = std::mem::take(&mut self.exprs);
        pool.compact(&mut self.roots());
        self.exprs = pool;
    }

    /// References to all expressions that the model holds.
    /// They come in a fixed order: variables, equations, clauses, assertions, conserved quantities.
    fn roots(&mut self) -> Vec<&mut ExprId> {
        let mut roots: Vec<&mut ExprId> = Vec::new();
        for v in &mut self.variables {
            roots.extend([&mut v.binding, &mut v.start, &mut v.min, &mut v.max, &mut v.nominal].into_iter().flatten());
        }
        for e in self.equations.iter_mut().chain(&mut self.initial_equations) {
            roots.extend([&mut e.lhs, &mut e.rhs]);
        }
        for branch in self.whens.iter_mut().flat_map(|w| &mut w.branches) {
            roots.extend(&mut branch.conditions);
            branch.actions.iter_mut().for_each(|a| action(a, &mut roots));
        }
        self.asserts.iter_mut().for_each(|a| assert(a, &mut roots));
        roots.extend(self.conserved.iter_mut().flat_map(|c| [&mut c.quantity, &mut c.rate, &mut c.state]));
        roots
    }
}

/// Adds the expressions of a statement in a `when`.
fn action<'m>(a: &'m mut WhenAction, roots: &mut Vec<&'m mut ExprId>) {
    match a {
        WhenAction::Assign { value, .. } => roots.push(value),
        WhenAction::Reinit { value, guard, .. } => roots.extend([value, guard]),
        WhenAction::Assert(a) => assert(a, roots),
        WhenAction::Terminate { message, guard, .. } => {
            roots.push(guard);
            parts(&mut message.parts, roots);
        }
    }
}

/// Adds the expressions of an assertion.
fn assert<'m>(a: &'m mut FlatAssertion, roots: &mut Vec<&'m mut ExprId>) {
    roots.push(&mut a.condition);
    parts(&mut a.message.parts, roots);
}

/// Adds the values inside a message.
fn parts<'m>(parts: &'m mut [MessagePart], roots: &mut Vec<&'m mut ExprId>) {
    roots.extend(parts.iter_mut().filter_map(|p| match p {
        MessagePart::Value(e, _) => Some(e),
        MessagePart::Text(_) => None,
    }));
}
