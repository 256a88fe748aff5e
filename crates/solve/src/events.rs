//! The event iteration: with `pre` values fixed everything is solved; then `pre` becomes the new values; until nothing
//! changes.

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

/// What an event did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventOutcome {
    /// A discrete value changed.
    pub changed: bool,
    /// A state was set by `reinit`.
    pub reinitialised: bool,
    /// A crossing that the integrator saw did not take place.
    pub refused: bool,
    /// The message of a `terminate`.
    pub terminate: Option<String>,
    /// Assertions inside `when` that failed: index into `Dae::actions`, and the text.
    pub failed: Vec<(usize, String)>,
}

/// Why an event has no consistent end.
#[derive(Clone, Debug, PartialEq)]
pub enum EventFailure {
    /// The blocks could not be solved.
    Blocks(BlockFailure),
    /// Discrete values that kept changing.
    Endless(Vec<VarId>),
}

/// The machinery of events, allocated once.
#[derive(Debug)]
pub struct EventHandler {
    blocks: BlockWorkspace,
    /// Variable, its slot and the slot of its `pre` value, of every discrete variable.
    discrete: Vec<(VarId, usize, usize)>,
    /// Slot of the mode of each `sample`.
    samples: Vec<usize>,
    /// Slots and values of the `reinit`s of one pass.
    reinits: Vec<(usize, f64)>,
    /// Made for the first event that takes a second pass.
    stale: Option<StaleBlocks>,
}

impl EventHandler {
    /// For the event blocks of a system.
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

    /// `pre` of all discrete variables becomes their value.
    pub fn settle_pre(&self, values: &mut [f64]) {
        for &(_, now, before) in &self.discrete {
            values[before] = values[now];
        }
    }

    /// The same within an iteration: what reads them waits for the next pass.
    fn move_pre(&self, stale: &mut StaleBlocks, values: &mut [f64]) {
        for &(_, now, before) in &self.discrete {
            if values[before] != values[now] {
                values[before] = values[now];
                stale.touch(before);
            }
        }
    }

    /// What the last iteration left open, and what switched there ([`BlockWorkspace::kept`]).
    pub fn kept(&self) -> Option<(&[VarId], Unknown)> {
        self.blocks.kept()
    }

    /// Whether loops may end at another root than that at hand.
    pub fn may_jump(&mut self, allowed: bool) {
        self.blocks.may_jump(allowed);
    }

    /// Whether a loop was solved by a search in the last iteration, and may have jumped.
    pub fn searched(&self) -> bool {
        self.blocks.searched()
    }

    /// Raises the mode of a `sample`; the iteration lowers it again.
    pub fn raise(&self, sample: usize, values: &mut [f64]) {
        values[self.samples[sample]] = 1.0;
    }

    fn changed(&self, values: &[f64]) -> bool {
        self.discrete.iter().any(|&(_, now, before)| values[now] != values[before])
    }

    /// Iterates at the time and states in `values`.
    ///
    /// # Errors
    /// [`EventFailure`]; `values` is where it failed.
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
        self.blocks.run(&system.event, &setting, values).map_err(EventFailure::Blocks)?;
        system.aliases(values);
        for pass in 1..PASSES {
            let changed = self.changed(values);
            if !changed && !self.samples_up(values) {
                return Ok(outcome);
            }
            let mut stale = self.stale.take().unwrap_or_else(|| StaleBlocks::new(system));
            if changed {
                outcome.changed = true;
                self.act(system, values, &mut outcome);
                self.reinits.iter().for_each(|&(slot, _)| stale.touch(slot));
                if pass + 10 >= PASSES {
                    moving.extend(self.discrete.iter().filter(|d| values[d.1] != values[d.2]).map(|d| d.0));
                }
                self.move_pre(&mut stale, values);
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

    fn samples_up(&self, values: &[f64]) -> bool {
        self.samples.iter().any(|&now| values[now] != 0.0)
    }

    /// `sample` holds only at its instant (MLS 3.7.5). Its end is a change of its own, for which `pre` of it is still
    /// true: `when pre(c) and not c` fires at the instant of the pulse.
    fn lower_samples(&self, stale: &mut StaleBlocks, values: &mut [f64]) {
        for &now in &self.samples {
            if values[now] != 0.0 {
                values[now] = 0.0;
                stale.touch(now);
            }
        }
    }

    /// Does what fires in this pass. New values of states are computed before any of them is set.
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
