//! Units of measurement: reads unit strings, converts values between units, and compares dimensions.
//! Models have units in the notation of Modelica (3.6, chapter 19), recordings and studies in that of engineers.

mod dimension;
mod symbols;
pub mod unit;

pub use dimension::Dimension;
pub use dimension::power_of;
pub use unit::{MeasurementUnit, UnitError, quantity};
