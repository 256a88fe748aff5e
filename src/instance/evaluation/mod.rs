//! Expressions and statements carried out: symbolic in the flat model, by number where a value must be known.

pub mod algorithm;
pub mod deduce;
pub mod expressions;
pub(in crate::instance) mod overload;
pub mod references;
pub mod value;
