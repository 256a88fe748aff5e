//! Estimates: a model simulated from its inputs alone, with derivatives; its parameters as MAP estimate within their
//! tolerances, with errors as correlated as they are.

pub mod candidate;
pub mod exponential;
pub mod map;
pub mod simulation;
pub mod start;
#[cfg(test)]
mod tests;
pub mod uncertainty;

pub use candidate::{CandidateModel, FitCoordinate};
pub use map::{FitTask, ModelFit, NormalEquations, SignalWeights};
