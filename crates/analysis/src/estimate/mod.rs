//! What every estimate from recordings stands on: over how many samples errors resemble each other, and how far an
//! estimate may be off because of them. [`crate::identify`] and the diagnosis weigh errors and give standard deviations
//! by these rules alone, so that the same question has the same answer.

mod autoregression;
pub mod correlation;
mod quasi_newton;
mod spread;

pub use spread::{LinearizedEstimate, ResidualSeries, spread};
