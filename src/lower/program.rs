//! A [`Program`]: kernels over the array of values, run in order.

/// Something to compute, reading and writing slots of one array of values. Cheap to clone; shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Program {}

impl Program {
    /// Computes. `values` has the length of the layout.
    pub fn run(&self, _values: &mut [f64]) {}
}
