//! Units of measurement: reading unit strings and converting values.

mod dimension;
mod symbols;
pub mod unit;

pub use dimension::Dimension;
pub use dimension::power_of;
pub use unit::{MeasurementUnit, UnitError, quantity};
