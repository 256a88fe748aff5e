//! The numbers of components: from a scope of the instance to its entry in `FlatModel::instances`.
//!
//! Scopes include packages, functions and connectors; the flat model numbers component instances only.

use crate::instance::ScopeId;

/// By scope: the number of its component.
pub(super) struct ComponentNumbers(Vec<u32>);

impl ComponentNumbers {
    /// Numbers components in the order of their scopes.
    pub(super) fn new(scopes: &[ScopeId]) -> ComponentNumbers {
        let places = scopes.iter().map(|s| s.0 as usize + 1).max().unwrap_or(0);
        let mut all = vec![0; places];
        for (&scope, i) in scopes.iter().zip(0u32..) {
            all[scope.0 as usize] = i;
        }
        ComponentNumbers(all)
    }

    /// The component of a scope; 0, the model itself, for a scope that is no component.
    pub(super) fn of(&self, scope: ScopeId) -> u32 {
        self.0.get(scope.0 as usize).copied().unwrap_or(0)
    }
}
