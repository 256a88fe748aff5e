//! The judge: hypotheses are compared on data that were left out, simulated from the inputs alone.

pub mod choose;
pub mod compare;
pub mod confirm;
pub mod criteria;
pub mod folds;
pub mod matched;
pub mod models;
pub mod rivals;
pub mod screen;
pub mod search;
pub mod weighed;
