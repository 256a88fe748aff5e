//! Components: from declarations with their modifiers to nodes, and the checks on the way.
//!
//! - [`components`] builds nodes and scalar variables; the other files help it.
//! - `given` takes values from outside, `outer` finds `inner` components, `redeclared` checks replacements.
//! - `expandable` adds members to buses, [`overconstrained`] notes types whose values depend on each other.
//! - `restrictions` checks what a class of a kind may hold, `mockup` puts FMUs in the place of components.

pub mod components;
pub(in crate::instance) mod expandable;
pub(in crate::instance) mod given;
#[cfg(feature = "fmi")]
pub(in crate::instance) mod mockup;
pub(in crate::instance) mod numbers;
pub(in crate::instance) mod outer;
pub mod overconstrained;
pub(in crate::instance) mod redeclared;
pub(in crate::instance) mod restrictions;
