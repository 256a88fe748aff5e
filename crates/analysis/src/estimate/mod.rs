//! The uncertainty of estimates from recordings with correlated errors.
//!
//! Residuals and Jacobian of a weighted least-squares fit enter; covariance and degrees of freedom of the unknowns
//! leave ([`spread()`]), or the correlation time of errors ([`correlation`]). [`crate::identify`] and the diagnosis in
//! `crates/gap` both use these functions, so that the same data give the same standard deviations in both.

mod autoregression;
pub mod correlation;
mod quasi_newton;
mod spread;

pub use spread::{LinearizedEstimate, ResidualSeries, spread};
