//! Bramah: an acausal component-network simulator for electro-hydraulic machines.
//!
//! The stages stand here in the order in which a circuit passes through them.

pub mod diag;
pub mod units;
pub mod world;

pub mod syntax;

pub mod expr;
pub mod flat;
pub mod structure;

pub mod lower;

pub mod results;

pub mod solve;

pub mod plot;

pub mod experiment;

pub mod cli;
