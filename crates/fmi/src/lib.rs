//! A circuit as a functional mock-up unit (FMI 2.0.5 and 3.0.2, Co-Simulation and Model Exchange).
//!
//! The unit holds a library that is the same for all circuits, and the texts that the circuit was made of: [`packed`]
//! writes and reads them. The library compiles them when the unit is instantiated, in some milliseconds, so that writer
//! and unit see the same [`interface`]; [`description`] writes it as `modelDescription.xml`.

pub mod description;
pub mod interface;
pub mod packed;

pub use interface::{FmiCausality, FmiInterface, FmiVariable, ModelExchangeRole};
pub use packed::{PackedRequest, ReadRecorder};
