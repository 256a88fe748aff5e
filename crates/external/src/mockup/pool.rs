//! Instances of an FMU, each identified by what was done to it.
//!
//! To the equations a unit is a pure function. Its state is a number: the fingerprint of all actions since it was made.
//! Each step gives the number of the next state. A run stores nothing else, so it can be repeated, resumed within the
//! process, iterated at an event, branched for derivatives, and executed many times at once.
//!
//! This module finds an instance for each number. An instance that is in the state serves at once. If there is none, a
//! new one is made, and the actions since the root are repeated on it.

use super::description::{FmuCausality, FmuDescription, FmuInterface};
use super::native::ImportedFmuInstance;
use super::{FmuError, ImportedFmu};
use rustc_hash::FxHashMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The number of bits of a fingerprint. Such integers are exact in an `f64`.
const BITS: u32 = 52;
/// The largest number of idle instances. Beyond it the one that was used least recently is removed.
const MOST_READY: usize = 32;
/// The number of recorded states at which those without an instance are forgotten.
const MOST_KEPT: usize = 1 << 20;
/// The largest number of passes of an event iteration.
const MOST_PASSES: usize = 1000;

/// An action on an instance, which leads from one state to the next.
#[derive(Clone, Debug, PartialEq)]
pub enum InstanceAction {
    /// A communication step between two times (s), with the inputs at its beginning.
    Step { from: f64, to: f64, inputs: Box<[f64]> },
    /// An event at a time (s), with the continuous states and inputs there.
    Event { time: f64, states: Box<[f64]>, inputs: Box<[f64]> },
}

impl InstanceAction {
    /// The number of the state that the action leads to.
    fn after(&self, state: u64) -> u64 {
        // The kind of action is a word too, so that a step and an event with equal numbers differ.
        let mut words = vec![state];
        match self {
            InstanceAction::Step { from, to, inputs } => {
                words.extend([1, from.to_bits(), to.to_bits()]);
                words.extend(inputs.iter().map(|x| x.to_bits()));
            }
            InstanceAction::Event { time, states, inputs } => {
                words.extend([2, time.to_bits()]);
                words.extend(states.iter().chain(inputs).map(|x| x.to_bits()));
            }
        }
        fingerprint(&words)
    }
}

/// A hash of some words, a whole number from 1 to 2 to the power of [`BITS`], exclusive.
/// Each word is mixed as in SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
fn fingerprint(words: &[u64]) -> u64 {
    let mixed = words.iter().fold(words.len() as u64, |hash, word| {
        let z = (hash ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    });
    (mixed >> (64 - BITS)).max(1)
}

/// The result of an event.
#[derive(Clone, Debug)]
pub struct InstanceEventResult {
    /// The state after the event.
    pub state: u64,
    /// The time of the next event that is known in advance (s).
    pub next: Option<f64>,
    /// The continuous states after the event.
    pub states: Vec<f64>,
}

/// An instance with the state that it is in.
struct InstanceSlot {
    /// The instance.
    instance: ImportedFmuInstance,
    /// The number of its state.
    state: u64,
    /// The time at which it entered initialization mode (s). `None` in any other mode.
    initial: Option<f64>,
    /// The inputs that were set last, element by element. Empty if none were set.
    inputs: Vec<f64>,
}

/// How a state was reached.
enum InstanceStateOrigin {
    /// The state of a new instance with these parameters, element by element.
    Root(Arc<[f64]>),
    /// Another state, and the action on it.
    Done(u64, Arc<InstanceAction>),
}

/// What changes as instances are used. A mutex guards it.
#[derive(Default)]
struct InstancePoolState {
    /// Idle instances, the one used least recently first.
    ready: Vec<InstanceSlot>,
    /// The states in which instances are in use. A state may occur several times.
    busy: Vec<u64>,
    /// How each known state was reached.
    origins: FxHashMap<u64, InstanceStateOrigin>,
    /// The number of origins at which they are sifted next.
    most: usize,
}

/// All instances of one component's unit.
pub struct InstancePool {
    /// The unit.
    unit: Arc<ImportedFmu>,
    /// The values of text parameters, by the indices of their variables.
    texts: Vec<(usize, String)>,
    /// The parameters that can be set, as indices of variables.
    pub parameters: Vec<usize>,
    /// The inputs, as indices of variables.
    pub inputs: Vec<usize>,
    /// The outputs, as indices of variables.
    pub outputs: Vec<usize>,
    /// The instances and states.
    shelf: Mutex<InstancePoolState>,
    /// The last failure of any call.
    failure: Mutex<Option<FmuError>>,
    /// Signals that an instance in use was returned.
    returned: Condvar,
}

impl InstancePool {
    /// A pool without instances. The first call makes one.
    pub fn new(unit: Arc<ImportedFmu>, texts: Vec<(usize, String)>) -> Self {
        InstancePool {
            parameters: super::text::offered(&unit.description),
            inputs: unit.description.of(FmuCausality::Input),
            outputs: unit.description.of(FmuCausality::Output),
            unit,
            texts,
            shelf: Mutex::default(),
            failure: Mutex::default(),
            returned: Condvar::new(),
        }
    }

    /// True if the unit computes directional derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.unit.offer.derivatives
    }

    /// The content of the unit's `modelDescription.xml`.
    pub fn description(&self) -> &FmuDescription {
        &self.unit.description
    }

    /// Records a failure.
    pub fn note(&self, why: &FmuError) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(why.clone());
    }

    /// The last failure of any call, as a sentence.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|why| self.words(why))
    }

    /// The sentence about a failure, with the name of the unit.
    pub fn words(&self, why: &FmuError) -> String {
        format!("the unit `{}`: {why}", self.description().name)
    }

    /// Locks the instances. A panic in another thread leaves them consistent, so a poisoned lock is taken.
    fn shelf(&self) -> MutexGuard<'_, InstancePoolState> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of the state of a new instance with these parameters.
    pub fn root(&self, parameters: &[f64]) -> u64 {
        let words: Vec<u64> = parameters.iter().map(|x| x.to_bits()).collect();
        let root = fingerprint(&words);
        self.shelf().origins.entry(root).or_insert_with(|| InstanceStateOrigin::Root(parameters.into()));
        root
    }

    /// True if the state is that of a new instance.
    pub fn is_root(&self, state: u64) -> bool {
        matches!(self.shelf().origins.get(&state), Some(InstanceStateOrigin::Root(_)))
    }

    /// Does a communication step from a state, and gives the number of the state after it.
    ///
    /// # Errors
    /// The unit refuses, its path is forgotten, or two states have the same fingerprint.
    pub fn step(&self, state: u64, from: f64, to: f64, inputs: &[f64]) -> Result<u64, FmuError> {
        let act = InstanceAction::Step { from, to, inputs: inputs.into() };
        let after = act.after(state);
        // The solver may ask for a step that was done already; then nothing is to be done.
        if !self.shelf().ready.iter().any(|s| s.state == after) {
            self.with(state, |slot, pool| pool.act(slot, &act))?;
        }
        self.shelf().note(after, state, act)?;
        Ok(after)
    }

    /// Handles an event in a state.
    ///
    /// # Errors
    /// As for [`InstancePool::step`].
    pub fn event(
        &self,
        state: u64,
        time: f64,
        states: &[f64],
        inputs: &[f64],
    ) -> Result<InstanceEventResult, FmuError> {
        let act = InstanceAction::Event { time, states: states.into(), inputs: inputs.into() };
        let after = act.after(state);
        // An event is always executed, because its results are wanted and not only the state.
        let (next, states) = self.with(state, |slot, pool| pool.act(slot, &act))?;
        self.shelf().note(after, state, act)?;
        Ok(InstanceEventResult { state: after, next, states })
    }

    /// Lets `see` read an instance in a state, at a time (s) with these continuous states and inputs.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn look<T>(
        &self,
        state: u64,
        time: f64,
        states: &[f64],
        inputs: &[f64],
        see: impl Fn(&mut ImportedFmuInstance) -> Result<T, FmuError>,
    ) -> Result<T, FmuError> {
        self.with(state, |slot, pool| {
            // Before the start the instance is in initialization mode; later a unit of Co-Simulation is read as its
            // step left it.
            if pool.is_root(slot.state) {
                pool.initialize(slot, time)?;
                pool.set_inputs(slot, inputs, true)?;
            } else if pool.unit.kind == FmuInterface::ModelExchange {
                slot.instance.set_time(time)?;
                pool.set_continuous(slot, states, inputs)?;
            }
            see(&mut slot.instance)
        })
    }

    /// Runs `act` on an instance in a state. An instance whose call failed is dropped, as its state is unknown.
    fn with<T>(
        &self,
        state: u64,
        act: impl Fn(&mut InstanceSlot, &InstancePool) -> Result<T, FmuError>,
    ) -> Result<T, FmuError> {
        let mut slot = self.take(state)?;
        let done = act(&mut slot, self);
        let mut shelf = self.shelf();
        shelf.leave(state);
        if done.is_ok() {
            shelf.ready.push(slot);
        }
        drop(shelf);
        self.returned.notify_all();
        done
    }

    /// Takes an instance in a state out of the pool, or makes one. The caller must return it by `leave`.
    ///
    /// # Errors
    /// No instance can be made, or the path to the state fails when it is repeated.
    fn take(&self, state: u64) -> Result<InstanceSlot, FmuError> {
        let mut shelf = self.shelf();
        loop {
            // The one used last is preferred, which keeps the order by use.
            if let Some(i) = shelf.ready.iter().rposition(|s| s.state == state) {
                let slot = shelf.ready.remove(i);
                shelf.busy.push(state);
                return Ok(slot);
            }
            // A process may hold only one instance of some units: wait until it is free.
            if !self.only_once() || shelf.busy.is_empty() {
                break;
            }
            shelf = self.returned.wait(shelf).unwrap_or_else(PoisonError::into_inner);
        }
        let (root, parameters, acts) = shelf.path(state)?;
        // An instance must go: the only one, or the oldest if there are too many. Making another one replaces it.
        let spare = if self.only_once() || shelf.ready.len() >= MOST_READY {
            (!shelf.ready.is_empty()).then(|| shelf.ready.remove(0))
        } else {
            None
        };
        shelf.busy.push(state);
        shelf.sift();
        // Repeating the actions may take long and must not block other threads.
        drop(shelf);
        let made = self.make(spare, root, &parameters, &acts);
        if made.is_err() {
            let mut shelf = self.shelf();
            shelf.leave(state);
            drop(shelf);
            self.returned.notify_all();
        }
        made
    }

    /// True if the process can hold only one instance of the unit.
    fn only_once(&self) -> bool {
        self.unit.offer.only_once
    }

    /// Makes an instance in the state that the actions lead to, by repeating them.
    /// A spare instance is reset only if the process cannot hold another one; else it is replaced by a new instance.
    /// Many units implement resetting badly.
    fn make(
        &self,
        spare: Option<InstanceSlot>,
        root: u64,
        parameters: &[f64],
        acts: &[Arc<InstanceAction>],
    ) -> Result<InstanceSlot, FmuError> {
        let instance = match spare {
            Some(mut slot) if self.only_once() => {
                slot.instance.reset()?;
                slot.instance
            }
            _ => ImportedFmuInstance::new(&self.unit.code()?, &self.description().name, self.unit.kind)?,
        };
        let mut slot = InstanceSlot { instance, state: root, initial: None, inputs: Vec::new() };
        self.set_up(&mut slot, parameters)?;
        for act in acts {
            self.act(&mut slot, act)?;
        }
        Ok(slot)
    }

    /// Sets the parameters and texts of a new instance.
    fn set_up(&self, slot: &mut InstanceSlot, parameters: &[f64]) -> Result<(), FmuError> {
        for (&i, value) in self.parameters.iter().zip(spread(self, &self.parameters, parameters)) {
            let v = &self.description().variables[i];
            // A unit may refuse to have some parameters set, even to the value that they have.
            if v.start != value {
                slot.instance.set(v.passed, v.reference, &value)?;
            }
        }
        for (i, text) in &self.texts {
            let v = &self.description().variables[*i];
            if v.text != *text {
                slot.instance.set_text(v.reference, text)?;
            }
        }
        Ok(())
    }

    /// Executes an action on an instance, and updates its state.
    /// An event gives the time of the next one and the continuous states; a step gives neither.
    /// The instance must be in the state from which the action starts.
    fn act(&self, slot: &mut InstanceSlot, act: &InstanceAction) -> Result<(Option<f64>, Vec<f64>), FmuError> {
        let at_root = self.is_root(slot.state);
        let found = match act {
            InstanceAction::Step { from, to, inputs } => {
                if at_root {
                    self.initialize(slot, *from)?;
                    self.set_inputs(slot, inputs, true)?;
                    slot.instance.exit_initialization()?;
                }
                // Inputs are set again after initialization, as some units compute them anew when the mode ends.
                self.set_inputs(slot, inputs, true)?;
                slot.instance.step(*from, *to)?;
                (None, Vec::new())
            }
            InstanceAction::Event { time, states, inputs } => {
                if at_root {
                    self.initialize(slot, *time)?;
                    self.set_inputs(slot, inputs, true)?;
                    slot.instance.exit_initialization()?;
                } else {
                    slot.instance.set_time(*time)?;
                    // The order of FMI: the step is completed in continuous-time mode, then discrete inputs are set in
                    // event mode.
                    self.set_continuous(slot, states, inputs)?;
                    slot.instance.completed_step()?;
                    slot.instance.enter_event()?;
                    self.set_inputs(slot, inputs, true)?;
                }
                self.iterate(slot, at_root, states)?
            }
        };
        slot.state = act.after(slot.state);
        slot.initial = None;
        Ok(found)
    }

    /// Executes the event iteration of the unit until it needs no further pass.
    /// Gives the time of the next known event, and the continuous states. Those of a new instance are always read.
    fn iterate(
        &self,
        slot: &mut InstanceSlot,
        at_root: bool,
        states: &[f64],
    ) -> Result<(Option<f64>, Vec<f64>), FmuError> {
        // After initialization the states are the unit's own.
        let mut changed = at_root;
        for _ in 0..MOST_PASSES {
            let update = slot.instance.update()?;
            changed |= update.states_changed;
            if update.terminate {
                return Err("it wants the run to end".into());
            }
            if !update.again {
                slot.instance.enter_continuous()?;
                let mut states = states.to_vec();
                if changed {
                    slot.instance.states(&mut states)?;
                }
                return Ok((update.next, states));
            }
        }
        Err("its event iteration does not end".into())
    }

    /// Puts a new instance into initialization mode at a time (s).
    /// Its parameters have been set before.
    fn initialize(&self, slot: &mut InstanceSlot, time: f64) -> Result<(), FmuError> {
        match slot.initial {
            Some(t) if t == time => Ok(()),
            Some(_) => {
                // A run with another start time, or a derivative by it: the mode cannot be entered twice.
                let (_, parameters, _) = self.shelf().path(slot.state)?;
                if self.only_once() {
                    slot.instance.reset()?;
                } else {
                    slot.instance =
                        ImportedFmuInstance::new(&self.unit.code()?, &self.description().name, self.unit.kind)?;
                }
                (slot.initial, slot.inputs) = (None, Vec::new());
                self.set_up(slot, &parameters)?;
                self.initialize(slot, time)
            }
            None => {
                slot.instance.enter_initialization(time)?;
                slot.initial = Some(time);
                Ok(())
            }
        }
    }

    /// Sets the inputs that have changed. Discrete ones are set only with `all`, because FMI allows that in event mode
    /// only.
    fn set_inputs(&self, slot: &mut InstanceSlot, inputs: &[f64], all: bool) -> Result<(), FmuError> {
        let before = spread(self, &self.inputs, &slot.inputs);
        for (k, (&i, value)) in self.inputs.iter().zip(spread(self, &self.inputs, inputs)).enumerate() {
            let v = &self.description().variables[i];
            if before.get(k) != Some(&value) && (all || v.continuous) {
                slot.instance.set(v.passed, v.reference, &value)?;
            }
        }
        if all {
            slot.inputs = inputs.to_vec();
        } else {
            // Discrete inputs keep the values that were set last.
            let continuous = self.inputs.iter().flat_map(|&i| {
                let v = &self.description().variables[i];
                std::iter::repeat_n(v.continuous, v.size())
            });
            for (k, is_continuous) in continuous.enumerate() {
                if is_continuous && k < slot.inputs.len() {
                    slot.inputs[k] = inputs[k];
                }
            }
        }
        Ok(())
    }

    /// Sets the continuous states and continuous inputs, between events.
    /// FMI forbids setting discrete inputs here.
    fn set_continuous(&self, slot: &mut InstanceSlot, states: &[f64], inputs: &[f64]) -> Result<(), FmuError> {
        if !states.is_empty() {
            slot.instance.set_states(states)?;
        }
        self.set_inputs(slot, inputs, false)
    }

    /// Appends the values of variables, element by element, to `into`.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn read(
        &self,
        instance: &ImportedFmuInstance,
        variables: &[usize],
        into: &mut Vec<f64>,
    ) -> Result<(), FmuError> {
        for &i in variables {
            let v = &self.description().variables[i];
            let at = into.len();
            into.resize(at + v.size(), f64::NAN);
            instance.get(v.passed, v.reference, &mut into[at..])?;
        }
        Ok(())
    }
}

/// Splits numbers into those of each variable. Missing numbers give empty or short parts.
/// Each variable takes as many numbers as it has elements.
fn spread(pool: &InstancePool, variables: &[usize], numbers: &[f64]) -> Vec<Vec<f64>> {
    let mut rest = numbers;
    let mut part = |i: &usize| {
        let (own, behind) = rest.split_at(pool.description().variables[*i].size().min(rest.len()));
        rest = behind;
        own.to_vec()
    };
    variables.iter().map(&mut part).collect()
}

impl InstancePoolState {
    /// One instance less is in use in a state.
    fn leave(&mut self, state: u64) {
        if let Some(i) = self.busy.iter().position(|s| *s == state) {
            self.busy.swap_remove(i);
        }
    }

    /// Records how a state was reached.
    ///
    /// # Errors
    /// The state is known with another origin: two states have the same fingerprint.
    fn note(&mut self, after: u64, before: u64, act: InstanceAction) -> Result<(), FmuError> {
        let origin =
            self.origins.entry(after).or_insert_with(|| InstanceStateOrigin::Done(before, Arc::new(act.clone())));
        match origin {
            InstanceStateOrigin::Done(b, a) if *b == before && **a == act => Ok(()),
            _ => Err("two of its states have the same fingerprint; another communication step helps".into()),
        }
    }

    /// How a state was reached: the state of its root, the parameters there, and the actions since, in order.
    ///
    /// # Errors
    /// The state is not known, as after a restart of the process.
    fn path(&self, mut state: u64) -> Result<(u64, Arc<[f64]>, Vec<Arc<InstanceAction>>), FmuError> {
        let mut acts = Vec::new();
        loop {
            match self.origins.get(&state) {
                Some(InstanceStateOrigin::Root(parameters)) => {
                    acts.reverse();
                    return Ok((state, parameters.clone(), acts));
                }
                Some(InstanceStateOrigin::Done(before, act)) => {
                    acts.push(act.clone());
                    state = *before;
                }
                None => return Err("its state is known only to the run that has computed it".into()),
            }
        }
    }

    /// Forgets the origins of states that no instance leads back to. Roots are kept.
    /// It runs only when there are many origins, and doubles the number at which it runs next.
    fn sift(&mut self) {
        if self.origins.len() < self.most.max(MOST_KEPT) {
            return;
        }
        let mut kept: FxHashMap<u64, InstanceStateOrigin> = FxHashMap::default();
        let standing: Vec<u64> = self.ready.iter().map(|s| s.state).chain(self.busy.iter().copied()).collect();
        // Each state in use keeps all states on the way to it; a path that was kept already ends the loop.
        for mut state in standing {
            while let Some(origin) = self.origins.remove(&state) {
                let before = match &origin {
                    InstanceStateOrigin::Root(_) => None,
                    InstanceStateOrigin::Done(before, _) => Some(*before),
                };
                kept.insert(state, origin);
                match before {
                    Some(before) => state = before,
                    None => break,
                }
            }
        }
        let roots = std::mem::take(&mut self.origins);
        kept.extend(roots.into_iter().filter(|(_, o)| matches!(o, InstanceStateOrigin::Root(_))));
        self.origins = kept;
        self.most = 2 * self.origins.len();
    }
}

impl std::fmt::Debug for InstancePool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "instances of {}", self.description().name)
    }
}
