//! Tests of the gap between model and machine.

mod effects;
mod gap;
mod measured;
mod recordings;
#[path = "../rig/mod.rs"]
mod rig;
mod slopes;
mod thresholds;
