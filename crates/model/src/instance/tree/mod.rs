//! What classes hold, which modifiers reach their elements, and what names mean.
//!
//! - [`template`] collects the elements and bases of a class.
//! - [`modifiers`] sorts modifiers by the elements they are for.
//! - [`lookup`] finds what a name means at a place.

pub mod lookup;
pub mod modifiers;
pub mod template;
