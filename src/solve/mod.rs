//! From a lowered system to a trajectory: initialization, integration by SUNDIALS IDA, events.

pub mod ida;
pub mod linear;
