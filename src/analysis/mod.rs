//! What is asked of a model beyond one run: derivatives of its right-hand side, and all that stands on them.

pub mod grid;
pub mod identify;
pub mod lift;
pub mod linear;
pub mod local;
pub mod steady;

pub use lift::{Lifted, lift};
pub use local::{Local, LocalError};
