//! Selection of effects: hypotheses are fitted and compared on left-out data, simulated from the inputs alone.
//!
//! `search` is the entry and goes effect by effect. One step of it passes through the other modules in this order:
//! - `screen` orders all hypotheses by what a linear model of each promises; `models` makes the models.
//! - `rivals` fits the most promising ones; `weighed` fits with two weightings and keeps the left-out errors of
//!   `folds`.
//! - `criteria` scores each fit, with the tests of `compare` and the refined evidence of `matched`.
//! - `confirm` evaluates held recordings; `choose` accepts one hypothesis or none.
//!
//! Evidence is in nats (natural logarithm of a likelihood ratio), gaps are parts of full scale unless stated otherwise.
//! `before` is always the model of the step without the hypothesis, a rival the same model with it.
//!
//! The criteria are those of `docs/gap_method.md`, "When an effect is accepted" and "Which of several is taken".

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
