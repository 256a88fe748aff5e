//! The event iteration (MLS 8.6, 8.3.5): solve with fixed `pre` values, then set `pre` to the new values, and repeat
//! until nothing changes.
//!
//! The driver calls [`EventHandler::iterate`] with the array of values at the time of an event. Actions of `when`
//! clauses (`reinit`, `assert`, `terminate`) are carried out after each pass that changed a discrete value. Later
//! passes solve only blocks whose inputs have changed (`stale`).

use super::blocks::{BlockContext, BlockFailure, BlockWorkspace};
use super::modes::CrossingModes;
use super::newton::VariableScales;
use super::report::message_text;
use super::stale::StaleBlocks;
use crate::lower::ExecutableSystem;
use bramah_expr::VarId;
use bramah_model::structure::{EventActionKind, Unknown};

/// Passes before the iteration counts as endless.
const PASSES: usize = 200;

/// What an event changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventOutcome {
    /// Whether a discrete value changed.
    pub changed: bool,
    /// Whether a state was set by `reinit`.
    pub reinitialised: bool,
    /// Whether a crossing that the integrator saw did not take place.
    pub refused: bool,
    /// The message of the first `terminate`; `None` without one.
    pub terminate: Option<String>,
    /// Assertions inside `when` that failed: index into `Dae::actions`, and the text.
    pub failed: Vec<(usize, String)>,
}

/// Why an event has no consistent end.
#[derive(Clone, Debug, PartialEq)]
pub enum EventFailure {
    /// A block could not be solved.
    Blocks(BlockFailure),
    /// Discrete values kept changing; holds the variables.
    Endless(Vec<VarId>),
}

/// The event system with its workspace, allocated once.
#[derive(Debug)]
pub struct EventHandler {
    /// Workspace of the event blocks.
    blocks: BlockWorkspace,
    /// For each discrete variable its slot and the slot of its `pre` value.
    discrete: Vec<(VarId, usize, usize)>,
    /// Slot of the mode of each `sample`.
    samples: Vec<usize>,
    /// Slots and new values of the `reinit`s of one pass.
    reinits: Vec<(usize, f64)>,
    /// Dependences between blocks. Made for the first event that takes a second pass.
    stale: Option<StaleBlocks>,
}

impl EventHandler {
    /// Prepares the event blocks of a system.
    pub fn new(system: &ExecutableSystem, scales: &VariableScales, modes: &CrossingModes) -> Self {
        let samples = system.dae.samples.iter().map(|s| s.mode);
        let mut variables: Vec<VarId> = system.dae.discrete.iter().copied().chain(samples.clone()).collect();
        variables.sort_unstable();
        variables.dedup();
        let layout = &system.layout;
        EventHandler {
            blocks: BlockWorkspace::new(&system.event, scales, modes),
            discrete: variables.into_iter().filter_map(|v| Some((v, layout.var(v), layout.pre(v)?))).collect(),
            samples: samples.map(|v| layout.var(v)).collect(),
            reinits: Vec::new(),
            stale: None,
        }
    }

    /// Sets `pre` of all discrete variables to their present value.
    pub fn settle_pre(&self, values: &mut [f64]) {
        for &(_, now, before) in &self.discrete {
            values[before] = values[now];
        }
    }

    /// The same within an iteration; blocks that read a changed `pre` value become stale.
    fn move_pre(&self, stale: &mut StaleBlocks, values: &mut [f64]) {
        for &(_, now, before) in &self.discrete {
            if values[before] != values[now] {
                values[before] = values[now];
                stale.touch(before);
            }
        }
    }

    /// The unknown that the last iteration left open, with the discrete variables of its loop
    /// ([`BlockWorkspace::kept`]).
    pub fn kept(&self) -> Option<(&[VarId], Unknown)> {
        self.blocks.kept()
    }

    /// Sets whether loops may end at another root than the present one.
    pub fn may_jump(&mut self, allowed: bool) {
        self.blocks.may_jump(allowed);
    }

    /// Whether a loop was solved by a search in the last iteration and may be at another root.
    pub fn searched(&self) -> bool {
        self.blocks.searched()
    }

    /// Sets the mode of a `sample` to true; the iteration sets it to false again.
    pub fn raise(&self, sample: usize, values: &mut [f64]) {
        values[self.samples[sample]] = 1.0;
    }

    /// Whether a discrete value differs from its `pre` value.
    fn changed(&self, values: &[f64]) -> bool {
        self.discrete.iter().any(|&(_, now, before)| values[now] != values[before])
    }

    /// Iterates at the time and states in `values`.
    ///
    /// # Errors
    /// [`EventFailure`]. `values` then holds the point of the failure.
    pub fn iterate(
        &mut self,
        system: &ExecutableSystem,
        scales: &VariableScales,
        modes: &CrossingModes,
        values: &mut [f64],
    ) -> Result<EventOutcome, EventFailure> {
        let setting = BlockContext { system, scales, modes };
        let mut outcome = EventOutcome::default();
        let mut moving = Vec::new();
        // the first pass solves everything, since the states have moved since the last event
        self.blocks.run(&system.event, &setting, values).map_err(EventFailure::Blocks)?;
        system.aliases(values);
        for pass in 1..PASSES {
            let changed = self.changed(values);
            // consistent: no value differs from its `pre` value and no sample is active
            if !changed && !self.samples_up(values) {
                return Ok(outcome);
            }
            let mut stale = self.stale.take().unwrap_or_else(|| StaleBlocks::new(system));
            if changed {
                outcome.changed = true;
                self.act(system, values, &mut outcome);
                self.reinits.iter().for_each(|&(slot, _)| stale.touch(slot));
                // only variables that still change in the last passes are named in the message
                if pass + 10 >= PASSES {
                    moving.extend(self.discrete.iter().filter(|d| values[d.1] != values[d.2]).map(|d| d.0));
                }
                self.move_pre(&mut stale, values);
            // samples end only after everything that they cause has settled
            } else {
                self.lower_samples(&mut stale, values);
            }
            self.blocks.run_stale(&mut stale, &system.event, &setting, values).map_err(EventFailure::Blocks)?;
            system.aliases(values);
            self.stale = Some(stale);
        }
        moving.sort_unstable();
        moving.dedup();
        Err(EventFailure::Endless(moving))
    }

    /// Whether the mode of a `sample` is true.
    fn samples_up(&self, values: &[f64]) -> bool {
        self.samples.iter().any(|&now| values[now] != 0.0)
    }

    /// Ends all samples: `sample` is true only at its instant (MLS 3.7.5).
    ///
    /// The end is a change of its own, with `pre` of the sample still true, so that `when pre(c) and not c` fires at
    /// the same instant.
    fn lower_samples(&self, stale: &mut StaleBlocks, values: &mut [f64]) {
        for &now in &self.samples {
            if values[now] != 0.0 {
                values[now] = 0.0;
                stale.touch(now);
            }
        }
    }

    /// Carries out the actions that fire in this pass. New values of states are computed before any of them is set.
    pub fn act(&mut self, system: &ExecutableSystem, values: &mut [f64], outcome: &mut EventOutcome) {
        if system.dae.actions.is_empty() {
            return;
        }
        system.actions.program.run(values);
        self.reinits.clear();
        for (i, action) in system.dae.actions.iter().enumerate() {
            if values[system.actions.holds[i]] == 0.0 {
                continue;
            }
            match (&action.kind, system.actions.value[i]) {
                (EventActionKind::Reinit(v, _), Some(slot)) => self.reinits.push((system.layout.var(*v), values[slot])),
                (EventActionKind::Terminate(message), _) => {
                    outcome.terminate.get_or_insert_with(|| message_text(system, message, values));
                }
                (EventActionKind::Assert(assert), Some(slot)) if values[slot] == 0.0 => {
                    outcome.failed.push((i, message_text(system, &assert.message, values)));
                }
                _ => {}
            }
        }
        outcome.reinitialised |= !self.reinits.is_empty();
        for &(slot, value) in &self.reinits {
            values[slot] = value;
        }
    }
}
