//! Describes a circuit as a functional mock-up unit (FMI 2.0.5 and 3.0.2, Co-Simulation and Model Exchange).
//!
//! A compiled `Simulation` enters. The list of its variables ([`interface`]) and the text of `modelDescription.xml`
//! ([`description`]) leave. `bramah export` writes them into a unit.
//!
//! The runtime library of a unit is the same for all circuits. The unit also holds the texts of its circuit
//! ([`packed`]), which the library compiles when the unit is instantiated, in some milliseconds. So writer and unit
//! derive the same interface from the same texts.

pub mod description;
pub mod interface;
pub mod packed;

pub use interface::{FmiCausality, FmiInterface, FmiVariable, ModelExchangeRole};
pub use packed::{PackedRequest, ReadRecorder};
