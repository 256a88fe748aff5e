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
//! Models and libraries in files: `Simulation::from_file("Press.mo")`; what reads files takes a [`world::World`], of which
//! [`world::DiskWorld`] is this machine's disk and [`world::MemoryWorld`] holds texts.
//!
//! | to | use |
//! |---|---|
//! | compile and run | [`Simulation`], from text, a file, a shipped class or a [`Circuit`] built in Rust |
//! | run step by step with inputs from outside | [`Simulation::stepping`], [`Stepping`] |
//! | read results | [`Trajectory`], and [`results`] for files and comparisons |
//! | linear models, steady states, sensitivities | [`Simulation::linearize`], [`Simulation::steady`], [`Simulation::sensitivity`], [`linear`] |
//! | parameters from recordings | [`identify`] |
//! | where model and machine differ | [`diagnose`], with its [`verdict`] |
//! | say what is wrong | [`Error`] and its [`Diagnostic`]s |
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
//! Without any feature, circuits can be compiled and run.
//!
//! # Stability
//!
//! Stable are the items on this page and those that they name. The stages of compiler and solver are reachable in
//! [`internals`] for tools that look inside. They change without notice.

#![deny(missing_docs)]

#[cfg(feature = "cli")]
mod cli;

#[doc(inline)]
pub use bramah_results as results;
#[doc(inline)]
pub use bramah_syntax::world;

#[doc(inline)]
pub use bramah_circuit::{
    Circuit, Exchange, InputPort, Outcome, OwnedExchange, OwnedStepping, Parameter, Probe, Simulation, Stepping,
};
#[doc(inline)]
pub use bramah_model::{compile::Request, instance::Override};
#[doc(inline)]
pub use bramah_results::{Kind, Signal, Trajectory};
#[doc(inline)]
pub use bramah_solve::{Control, End, Interpolation, Progress, Settings, State, Statistics};
#[doc(inline)]
pub use bramah_syntax::diag::{Code, Diagnostic, Error, Severity, Sources};

#[cfg(feature = "analysis")]
#[doc(inline)]
pub use bramah_analysis::{
    Analyze,
    identify::{Identified, IdentifyMethod, IdentifyOptions, identify, identify_as},
    sensitivity::Sensitivity,
};
#[cfg(feature = "gap")]
#[doc(inline)]
pub use bramah_gap::{Budget, DiagnoseOptions, Diagnosis, Stage, Verdict, diagnose, diagnose_as};

/// Linear models, as [`Simulation::linearize`] returns them: matrices, poles, zeros, responses and files.
#[cfg(feature = "analysis")]
pub mod linear {
    pub use bramah_analysis::linear::{Pole, Quantity, StateSpace, csv, mat, modelica, poles, response, words, zeros};
}

/// The [`Verdict`] of a diagnosis and the types of its fields.
#[cfg(feature = "gap")]
pub mod verdict {
    pub use bramah_gap::verdict::*;
}

/// The stages of compiler, solver and diagnosis, in the order in which a circuit passes through them.
///
/// They are not stable and change without notice.
pub mod internals {
    /// The command line.
    #[cfg(feature = "cli")]
    pub mod cli {
        pub use crate::cli::*;
    }
    #[cfg(feature = "analysis")]
    pub use bramah_analysis::{self as analysis, experiment, study};
    #[cfg(feature = "lsp")]
    pub use bramah_editor as editor;
    pub use bramah_expr::{types, units};
    #[cfg(feature = "gap")]
    pub use bramah_gap as gap;
    pub use bramah_model::{flat, instance, network, resolve, shipped, structure, unit_check};
    pub use bramah_solve::lower;
    pub use bramah_syntax::diag;
    pub use {
        bramah_circuit as circuit, bramah_expr as expr, bramah_external as external, bramah_fmi as fmi,
        bramah_plot as plot, bramah_solve as solve, bramah_syntax as syntax,
    };

    /// Compilation: from a request to a model ready to run.
    pub mod compile {
        pub use bramah_circuit::compiled::*;
        pub use bramah_model::compile::*;
    }
}
