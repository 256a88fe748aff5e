//! Evaluation of expressions and execution of statements.
//!
//! The results are symbolic expressions of the flat model, or numbers where the structure needs a value.
//! - [`expressions`] is the entry; `operators`, `indices`, `ranges` and [`references`] handle the forms of expressions.
//! - `parameters` finds values of parameters, `shapes` sizes of what has no value, [`deduce`] ranges of loops without
//!   one.
//! - [`algorithm`] executes statements, `sections` is the entry for `flat`, [`streams`] mixes what flows carry.
//! - `overload` has the operators of operator records, `state` the mode and the locals.

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
