//! Diagnosis of the gap between a model and recordings of a real machine.
//!
//! It says at which place the two differ, which effect of a library explains it, and how far the gap shrinks with it.
//! The entry is [`fn@diagnose`]; the method is described in `docs/gap_method.md`.
//!
//! The stages, in the order of the data:
//! - [`study`] reads a study file, its nominal model and its recordings into a [`problem`].
//! - [`effects`] reads the library of effect models, [`circuit`] the nodes, ports and signals of the nominal model.
//! - [`hypotheses`] puts every effect at every place where its units fit; [`mistakes`] adds wrong signs and units of
//!   columns.
//! - [`shapes`] fits the grids of nonlinear parameters to the recordings, with frequencies from [`lines`]; `capacity`
//!   bounds shares of a node's capacity.
//! - [`augment`] writes the nominal model with effects attached as Modelica text, which is compiled like any other
//!   model.
//! - [`estimate`] fits such a model to the recordings (MAP estimate), within the budget of a [`clock`].
//! - [`select`] compares the fitted models on left-out data with the constants of [`policy`] and accepts effects.
//! - [`verdict`] states the result with its [`figures`]; [`words`] and [`report`] show it, with the [`whiteness`] of
//!   the residuals; [`fixed`] writes the corrected model.
//!
//! [`plan`] is separate: it predicts before measuring which effects a planned experiment would show.

pub mod augment;
mod capacity;
pub mod circuit;
pub mod clock;
pub mod data;
mod diagnose;
pub mod effects;
pub mod estimate;
pub mod figures;
pub mod fixed;
pub mod hypotheses;
pub mod lines;
pub mod mistakes;
pub mod plan;
pub mod policy;
pub mod problem;
pub mod report;
pub mod select;
pub mod shapes;
pub mod study;
pub mod verdict;
pub mod whiteness;
pub mod words;

pub use clock::Budget;
pub use diagnose::{DiagnoseOptions, Diagnosis, diagnose, diagnose_as};
pub use select::search::Stage;
pub use verdict::Verdict;
