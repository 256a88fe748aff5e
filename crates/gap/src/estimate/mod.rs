//! Estimation: simulation of a model from its inputs alone, and the MAP estimate of its parameters.
//!
//! - `exponential`: matrix exponential and its integrals. `simulation`: a run along a recording with sensitivities.
//! - `start`: the initial state of a recording.
//! - `candidate`: a model with free coordinates, its residuals and their sensitivities.
//! - `map`: the MAP estimate of the coordinates. `uncertainty`: standard deviations of the estimate.
//!
//! Method: `docs/gap_method.md`, "Simulation and fit".

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
