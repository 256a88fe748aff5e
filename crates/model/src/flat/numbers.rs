//! Which component of the flat model a scope is.

use crate::instance::ScopeId;

/// The numbers of components, by their scopes.
pub(super) struct ComponentNumbers(Vec<u32>);

impl ComponentNumbers {
    /// Components are numbered in the order of their scopes.
    pub(super) fn new(scopes: &[ScopeId]) -> ComponentNumbers {
        let places = scopes.iter().map(|s| s.0 as usize + 1).max().unwrap_or(0);
        let mut all = vec![0; places];
        for (&scope, i) in scopes.iter().zip(0u32..) {
            all[scope.0 as usize] = i;
        }
        ComponentNumbers(all)
    }

    /// The component of a scope; 0, the model itself, for what is none.
    pub(super) fn of(&self, scope: ScopeId) -> u32 {
        self.0.get(scope.0 as usize).copied().unwrap_or(0)
    }
}
