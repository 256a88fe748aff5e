//! The gap between model and bench: where it lies, which effect causes it, how far it shrinks.
//!
//! [`effects`] reads the effect models, [`circuit`] the places of the nominal model, [`hypotheses`] puts every effect at
//! every place where it fits, [`shapes`] fits their grids to the recordings, `capacity` their bounds to the nodes, and [`augment`] writes the nominal model with
//! effects attached. [`problem`] makes of it what the [`filter`] runs over the recordings; [`fit`], [`screen`] and
//! [`locate`] weigh parameters, effects and places by their [`evidence`]; [`diagnose`] puts all together into a
//! [`verdict`]. [`estimate`] and [`select`] are the judge by simulation of left-out data, with the constants of
//! [`policy`] and the [`mistakes`] of recordings among its hypotheses. [`fixed`] writes the corrected model into one file, [`report`] the page, with the [`whiteness`] of
//! what is left. [`plan`] says before measuring
//! what an experiment would show.

pub mod augment;
mod begin;
mod capacity;
pub mod circuit;
pub mod data;
pub mod diagnose;
pub mod effects;
pub mod estimate;
pub mod evidence;
pub mod figures;
pub mod filter;
pub mod fit;
pub mod fixed;
pub mod held;
pub mod hypotheses;
pub mod levels;
pub mod lines;
pub mod locate;
pub mod mistakes;
mod passive;
pub mod plan;
pub mod policy;
pub mod problem;
pub mod recording;
pub mod report;
pub mod screen;
pub mod select;
pub mod shapes;
pub mod step;
pub mod study;
pub mod verdict;
pub mod whiteness;
pub mod words;
