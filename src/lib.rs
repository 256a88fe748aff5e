//! Bramah: an acausal component-network simulator for electro-hydraulic machines.
//!
//! The stages stand here in the order in which a circuit passes through them.

pub mod diag;
pub mod units;
pub mod world;

pub mod shipped;

pub mod syntax;

pub mod resolve;

pub mod instance;

pub mod network;

pub mod expr;
pub mod flat;
pub mod structure;

pub mod lower;

mod compile;

pub use compile::{Flattened, Model, Outcome, Request, analyze, compile, flatten, flatten_text, sort};

pub mod results;

pub mod solve;

pub mod plot;

pub mod experiment;

pub mod cli;
