//! Units of measurement: reading unit strings, converting values, and checking equations.

pub mod check;
mod dimension;
mod infer;
mod measure;
mod symbols;
pub mod unit;

pub use check::check;
pub use dimension::Dimension;
pub use unit::{Unit, UnitError, quantity};
