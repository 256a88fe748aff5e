//! The library inside the units that `bramah export` writes: the same for every circuit. It compiles the texts in
//! `resources/` when a unit is instantiated.
//!
//! [`unit`] is a unit as Rust sees it; `c` is what a simulator calls, for FMI 2.0 and 3.0, and holds all `unsafe`.

#![deny(unsafe_op_in_unsafe_fn)]

mod c;
mod unit;
