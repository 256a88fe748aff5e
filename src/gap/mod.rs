//! The gap between model and bench: where it lies, which effect causes it, how far it shrinks.
//!
//! [`effects`] reads the effect models, [`circuit`] the places of the nominal model, [`hypotheses`] puts every effect at
//! every place where it fits, and [`augment`] writes the nominal model with effects attached.

pub mod augment;
pub mod circuit;
pub mod effects;
pub mod hypotheses;
