//! Components: from declarations with their modifiers to nodes, and what is refused on the way.

pub mod components;
pub(in crate::instance) mod expandable;
pub mod overconstrained;
pub(in crate::instance) mod restrictions;
