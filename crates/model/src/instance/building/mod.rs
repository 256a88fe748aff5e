//! Components: from declarations with their modifiers to nodes, and what is refused on the way.

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
