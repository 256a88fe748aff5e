//! What is asked of a model beyond one run: derivatives of its right-hand side, and all that stands on them.

pub mod estimate;
pub mod experiment;
pub mod study;

pub mod balance;
pub mod grid;
pub mod identify;
pub mod lift;
pub mod linear;
pub mod local;
pub mod noise;
pub mod partition;
pub mod sensitivity;
mod simulation;
pub mod steady;
pub mod sweep;
pub mod tangent;

pub use lift::{StateAugmentedModel, lift};
pub use local::{LocalError, LocalEvaluator};
pub use simulation::Analyze;
pub use tangent::TangentModel;
