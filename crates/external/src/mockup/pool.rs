//! Instances of a unit, each found by what was done to it.
//!
//! To the equations a unit is a function: its state is a number, the fingerprint of all that was done since it was made,
//! and each step gives the number of the next state. Nothing else is kept in the run, so that it can be repeated, resumed
//! within the process, iterated at an event, branched for derivatives, and done many times at once. Here the numbers have
//! instances behind them. An instance that stands where a run is serves at once; where there is none, one is made and does
//! again what the number stands for.

use super::description::{FmuCausality, FmuDescription, FmuInterface};
use super::native::ImportedFmuInstance;
use super::{FmuError, ImportedFmu};
use rustc_hash::FxHashMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Fingerprints are whole numbers that an `f64` holds.
const BITS: u32 = 52;
/// Instances that stand ready at most; one that has not served for longest goes first.
const MOST_READY: usize = 32;
/// Things done that are kept before those that no instance stands behind are forgotten.
const MOST_KEPT: usize = 1 << 20;
/// Passes of an event iteration at most.
const MOST_PASSES: usize = 1000;

/// What is done to an instance.
#[derive(Clone, Debug, PartialEq)]
pub enum InstanceAction {
    /// From a time to another (s), with these inputs.
    Step { from: f64, to: f64, inputs: Box<[f64]> },
    /// An event at this time (s), with these states and inputs.
    Event { time: f64, states: Box<[f64]>, inputs: Box<[f64]> },
}

impl InstanceAction {
    /// The number of the state that it leads to.
    fn after(&self, state: u64) -> u64 {
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

/// A whole number below 2 to the power of [`BITS`], and above 0. Each word is mixed as SplitMix64 does. Source: G. L. Steele,
/// D. Lea, C. H. Flood, OOPSLA 2014.
fn fingerprint(words: &[u64]) -> u64 {
    let mixed = words.iter().fold(words.len() as u64, |hash, word| {
        let z = (hash ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    });
    (mixed >> (64 - BITS)).max(1)
}

/// What came of an event.
#[derive(Clone, Debug)]
pub struct InstanceEventResult {
    /// The state behind it.
    pub state: u64,
    /// The next event of known time (s).
    pub next: Option<f64>,
    /// The continuous states.
    pub states: Vec<f64>,
}

/// An instance with what it is used for.
struct InstanceSlot {
    instance: ImportedFmuInstance,
    /// Where it stands.
    state: u64,
    /// When it entered initialization (s), while it is there.
    initial: Option<f64>,
    /// The inputs as they were set last.
    inputs: Vec<f64>,
}

/// Where a state comes from.
enum InstanceStateOrigin {
    /// Parameters, as numbers.
    Root(Arc<[f64]>),
    /// A state, and what was done.
    Done(u64, Arc<InstanceAction>),
}

#[derive(Default)]
struct InstancePoolState {
    ready: Vec<InstanceSlot>,
    /// States at which instances are at work.
    busy: Vec<u64>,
    origins: FxHashMap<u64, InstanceStateOrigin>,
    /// How many origins there may be before they are sifted.
    most: usize,
}

/// All instances of a unit.
pub struct InstancePool {
    unit: Arc<ImportedFmu>,
    /// Texts by the indices of their variables.
    texts: Vec<(usize, String)>,
    /// The parameters, as indices of variables.
    pub parameters: Vec<usize>,
    /// The inputs, as indices of variables.
    pub inputs: Vec<usize>,
    /// The outputs, as indices of variables.
    pub outputs: Vec<usize>,
    shelf: Mutex<InstancePoolState>,
    /// What went wrong last in any call.
    failure: Mutex<Option<FmuError>>,
    returned: Condvar,
}

impl InstancePool {
    /// Without instances as yet.
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

    /// Whether the unit computes directional derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.unit.offer.derivatives
    }

    /// What the unit says of itself.
    pub fn description(&self) -> &FmuDescription {
        &self.unit.description
    }

    /// Notes what went wrong.
    pub fn note(&self, why: &FmuError) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(why.clone());
    }

    /// What went wrong last in any call.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|why| self.words(why))
    }

    /// As a sentence.
    pub fn words(&self, why: &FmuError) -> String {
        format!("the unit `{}`: {why}", self.description().name)
    }

    fn shelf(&self) -> MutexGuard<'_, InstancePoolState> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The state before anything is done, with these parameters.
    pub fn root(&self, parameters: &[f64]) -> u64 {
        let words: Vec<u64> = parameters.iter().map(|x| x.to_bits()).collect();
        let root = fingerprint(&words);
        self.shelf().origins.entry(root).or_insert_with(|| InstanceStateOrigin::Root(parameters.into()));
        root
    }

    /// Whether nothing was done yet.
    pub fn is_root(&self, state: u64) -> bool {
        matches!(self.shelf().origins.get(&state), Some(InstanceStateOrigin::Root(_)))
    }

    /// Does something to a state: the state behind it.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn step(&self, state: u64, from: f64, to: f64, inputs: &[f64]) -> Result<u64, FmuError> {
        let act = InstanceAction::Step { from, to, inputs: inputs.into() };
        let after = act.after(state);
        if !self.shelf().ready.iter().any(|s| s.state == after) {
            self.with(state, |slot, pool| pool.act(slot, &act))?;
        }
        self.shelf().note(after, state, act)?;
        Ok(after)
    }

    /// An event.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn event(
        &self,
        state: u64,
        time: f64,
        states: &[f64],
        inputs: &[f64],
    ) -> Result<InstanceEventResult, FmuError> {
        let act = InstanceAction::Event { time, states: states.into(), inputs: inputs.into() };
        let after = act.after(state);
        let (next, states) = self.with(state, |slot, pool| pool.act(slot, &act))?;
        self.shelf().note(after, state, act)?;
        Ok(InstanceEventResult { state: after, next, states })
    }

    /// Looks at an instance that stands at a state, at a time (s) with these states and inputs.
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

    /// Acts on an instance that stands at a state; one that refuses is used no more.
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

    fn take(&self, state: u64) -> Result<InstanceSlot, FmuError> {
        let mut shelf = self.shelf();
        loop {
            if let Some(i) = shelf.ready.iter().rposition(|s| s.state == state) {
                let slot = shelf.ready.remove(i);
                shelf.busy.push(state);
                return Ok(slot);
            }
            if !self.only_once() || shelf.busy.is_empty() {
                break;
            }
            shelf = self.returned.wait(shelf).unwrap_or_else(PoisonError::into_inner);
        }
        let (root, parameters, acts) = shelf.path(state)?;
        let spare = if self.only_once() || shelf.ready.len() >= MOST_READY {
            (!shelf.ready.is_empty()).then(|| shelf.ready.remove(0))
        } else {
            None
        };
        shelf.busy.push(state);
        shelf.sift();
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

    fn only_once(&self) -> bool {
        self.unit.offer.only_once
    }

    /// An instance with everything done to it again. A spare one is taken back to its beginning where the process cannot
    /// hold another one, and else replaced: resetting is what units do worst.
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

    /// Parameters and texts of an instance that is as it was made.
    fn set_up(&self, slot: &mut InstanceSlot, parameters: &[f64]) -> Result<(), FmuError> {
        for (&i, value) in self.parameters.iter().zip(spread(self, &self.parameters, parameters)) {
            let v = &self.description().variables[i];
            // what was not changed is left alone
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

    fn act(&self, slot: &mut InstanceSlot, act: &InstanceAction) -> Result<(Option<f64>, Vec<f64>), FmuError> {
        let at_root = self.is_root(slot.state);
        let found = match act {
            InstanceAction::Step { from, to, inputs } => {
                if at_root {
                    self.initialize(slot, *from)?;
                    self.set_inputs(slot, inputs, true)?;
                    slot.instance.exit_initialization()?;
                }
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

    /// The unit's event iteration: the next event of known time, and the continuous states.
    fn iterate(
        &self,
        slot: &mut InstanceSlot,
        at_root: bool,
        states: &[f64],
    ) -> Result<(Option<f64>, Vec<f64>), FmuError> {
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

    fn initialize(&self, slot: &mut InstanceSlot, time: f64) -> Result<(), FmuError> {
        match slot.initial {
            Some(t) if t == time => Ok(()),
            Some(_) => {
                // a run with another start time, or a derivative by it
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

    /// Sets inputs that have changed; those with discrete values only where `all` may be set.
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
            // discrete ones are as they were
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

    fn set_continuous(&self, slot: &mut InstanceSlot, states: &[f64], inputs: &[f64]) -> Result<(), FmuError> {
        if !states.is_empty() {
            slot.instance.set_states(states)?;
        }
        self.set_inputs(slot, inputs, false)
    }

    /// Reads variables one after the other.
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

/// Numbers by variable.
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
    /// One instance less is at work.
    fn leave(&mut self, state: u64) {
        if let Some(i) = self.busy.iter().position(|s| *s == state) {
            self.busy.swap_remove(i);
        }
    }

    /// Notes where a state comes from.
    fn note(&mut self, after: u64, before: u64, act: InstanceAction) -> Result<(), FmuError> {
        let origin =
            self.origins.entry(after).or_insert_with(|| InstanceStateOrigin::Done(before, Arc::new(act.clone())));
        match origin {
            InstanceStateOrigin::Done(b, a) if *b == before && **a == act => Ok(()),
            _ => Err("two of its states have the same fingerprint; another communication step helps".into()),
        }
    }

    /// What a state stands for: its root with the parameters there, and what was done since.
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

    /// Forgets what was done for runs of which no instance is left.
    fn sift(&mut self) {
        if self.origins.len() < self.most.max(MOST_KEPT) {
            return;
        }
        let mut kept: FxHashMap<u64, InstanceStateOrigin> = FxHashMap::default();
        let standing: Vec<u64> = self.ready.iter().map(|s| s.state).chain(self.busy.iter().copied()).collect();
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
