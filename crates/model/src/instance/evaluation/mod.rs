//! Expressions and statements carried out: symbolic in the flat model, by number where a value must be known.

pub mod algorithm;
pub mod deduce;
pub mod expressions;
pub(in crate::instance) mod indices;
pub(in crate::instance) mod operators;
pub(in crate::instance) mod overload;
pub(in crate::instance) mod parameters;
pub(in crate::instance) mod ports;
pub(in crate::instance) mod ranges;
pub mod references;
pub(in crate::instance) mod sections;
pub(in crate::instance) mod shapes;
pub(in crate::instance) mod state;
pub mod streams;
pub mod value;
