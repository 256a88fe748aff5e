//! Trajectories: what a run or a bench has recorded; written, read and compared.

pub mod trajectory;

pub use trajectory::{Kind, Signal, Trajectory};
