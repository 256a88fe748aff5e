//! Analyses of a compiled model that need more than one run, or derivatives of its equations.
//!
//! A compiled model enters, together with a study file (`study`), an experiment file (`experiment`) or options of the
//! command line. Linear models, operating points, estimated parameters, sweeps, sensitivities and power balances leave.
//! The command (`src/cli`), the Rust front `bramah` and the crate `gap` call it.
//!
//! Most analyses stand on derivatives. [`lift()`] turns parameters and inputs into constant states, so that one
//! Jacobian of the system holds all derivatives; [`local`] evaluates this Jacobian at single points; [`tangent`] runs
//! the lifted model together with its sensitivities.

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
