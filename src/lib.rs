//! Bramah: an acausal component-network simulator for electro-hydraulic machines.
//!
//! A circuit is text in a strict subset of Modelica, or built in Rust; bramah turns it into a differential-algebraic
//! system, reduces it, compiles it to machine code and solves it with SUNDIALS IDA.
//!
//! ```
//! use bramah::Circuit;
//!
//! # fn main() -> Result<(), bramah::Error> {
//! let mut circuit = Circuit::new("Emptying");
//! circuit
//!     .declare(
//!         "connector Port Real p(unit = \"Pa\"); flow Real q(unit = \"m3/s\"); end Port;
//!          model Vessel
//!            Port port;
//!            parameter Real C(unit = \"m3/Pa\") = 1e-12;
//!            Real p(unit = \"Pa\", start = 1e6, fixed = true, nominal = 1e5);
//!          equation
//!            p = port.p;
//!            C*der(p) = port.q;
//!          end Vessel;
//!          model Leak
//!            Port port;
//!            parameter Real G(unit = \"m3/(s.Pa)\") = 1e-12;
//!          equation
//!            port.q = G*port.p;
//!          end Leak;",
//!     )
//!     .add("vessel", "Vessel")
//!     .add("leak", "Leak")
//!     .connect("vessel.port", "leak.port");
//!
//! let mut simulation = circuit.compile()?;
//! let first = simulation.stop_time(1.0).run()?;
//! let p = first.trajectory.column("vessel.p").expect("the vessel has a pressure");
//! assert!((p[p.len() - 1] - 1e6 * (-1.0f64).exp()).abs() < 10.0);
//!
//! // Another leak without compiling again, and then on from where the run ended.
//! simulation.set("leak.G", 2e-12)?;
//! let second = simulation.run()?;
//! let third = simulation.stop_time(2.0).run_from(&second.state)?;
//! assert_eq!(third.trajectory.times.first(), Some(&1.0));
//! # Ok(())
//! # }
//! ```
//!
//! Models and libraries in files are read through a [`world::World`]: `cli::DiskWorld` for the files of this machine
//! (`Simulation::compile(&DiskWorld, &Request { source: "Press.mo".into(), ..Request::default() })`), [`world::MemoryWorld`]
//! for texts at hand, or your own.
//!
//! `examples/` has a program for each use: `simulate`, `build`, `watch` (rows as they come), `cosimulate` (inputs set from
//! outside at 1 kHz), `trajectories`, `linearize`, `identify`, `coverage` (how often its
//! intervals hold the truth), `diagnose`.
//!
//! # Features
//!
//! | feature | brings |
//! |---|---|
//! | `cli` (default) | the command, with all below |
//! | `lsp` | what editors ask about texts |
//! | `plot` | pictures as PNG; SVG and HTML are always there |
//! | `parquet` | trajectories and tables of sweeps as Parquet |
//! | `gap` | the diagnosis: where model and machine differ |
//! | `analysis` | linear models, identification, sweeps, studies, experiment files |
//!
//! Without any, circuits are compiled and run.
//!
//! The stages stand here in the order in which a circuit passes through them.

#![deny(missing_docs)]

pub mod diag;
pub mod units;
pub mod world;

pub mod shipped;

pub mod syntax;

pub mod resolve;

pub mod expr;
#[doc(hidden)]
pub mod external;
pub mod types;

pub mod results;

pub mod instance;

pub mod network;

pub mod flat;
pub mod unit_check;

pub mod structure;

pub mod lower;

mod compile;

pub use compile::{
    Flattened, Model, Outcome, Request, Runnable, analyze, compile, flatten, flatten_text, graph, inspect, runnable, sort,
};

pub mod solve;

pub mod circuit;

#[cfg(feature = "analysis")]
pub mod analysis;

pub use circuit::{Circuit, Simulation, Stepping};
pub use diag::Error;

pub mod plot;

#[cfg(feature = "analysis")]
pub mod experiment;

#[cfg(feature = "analysis")]
pub mod study;

#[cfg(feature = "gap")]
pub mod gap;

#[cfg(feature = "lsp")]
pub mod editor;

#[cfg(feature = "cli")]
pub mod cli;
