//! From Modelica text to sorted equations.
//!
//! A [`compile::Request`] enters, with a world to read files from; flat equations ([`compile::flatten`]) or a sorted system
//! ([`compile::sort`]) leave, with the messages of all stages. Each stage is a module with one entry function.

pub mod compile;
pub mod flat;
pub mod instance;
pub mod network;
pub mod resolve;
pub mod shipped;
pub mod structure;
pub mod unit_check;
