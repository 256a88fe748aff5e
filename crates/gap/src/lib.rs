//! The gap between model and machine: where it lies, which effect causes it, how far it shrinks. [`fn@diagnose`] does it all.
//!
//! Data goes one way. [`study`] reads the question into a [`problem`]: [`effects`] reads the effect models, [`circuit`] the
//! places of the nominal model, [`hypotheses`] puts every effect at every place where it fits, [`shapes`] fits their grids
//! to the recordings, `capacity` their bounds to the nodes, [`mistakes`] adds what may be wrong with the recordings, and
//! [`augment`] writes the nominal model with effects attached. [`estimate`] fits such a model to the recordings, within the
//! budget of a [`clock`]; [`select`] judges on left-out data which hypothesis is taken, with the constants of [`policy`].
//! [`verdict`] says what came out, in [`figures`] and [`words`]; [`fixed`] writes the corrected model into one file,
//! [`report`] the page, with the [`whiteness`] of what is left. [`plan`] says before measuring what an experiment would
//! show.

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
