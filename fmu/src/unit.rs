//! A unit: from its texts to a run that is taken from step to step.

#![allow(clippy::disallowed_methods, reason = "reads its resources")]

use bramah::internals::fmi::{FmiCausality, FmiInterface, ModelExchangeRole, PackedRequest, packed};
use bramah::results::Kind;
use bramah::{Error, Exchange, InputPort, Interpolation, OwnedExchange, OwnedStepping, Probe, Simulation, State};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// A way to run a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuMode {
    /// From step to step.
    CoSimulation,
    /// By the simulator's integrator.
    ModelExchange,
}

/// A model under way.
enum FmuEngine {
    Stepping(OwnedStepping),
    Exchange(OwnedExchange),
}

impl FmuEngine {
    fn time(&mut self) -> f64 {
        match self {
            FmuEngine::Stepping(run) => run.with(|r| r.time()),
            FmuEngine::Exchange(run) => run.with(|r| r.time()),
        }
    }

    fn probe(&mut self, name: &str) -> Result<Probe, Error> {
        match self {
            FmuEngine::Stepping(run) => run.with(|r| r.probe(name)),
            FmuEngine::Exchange(run) => run.with(|r| r.probe(name)),
        }
    }

    fn get(&mut self, probe: Probe) -> Result<f64, Error> {
        match self {
            FmuEngine::Stepping(run) => Ok(run.with(|r| r.get(probe))),
            FmuEngine::Exchange(run) => run.with(|r| r.get(probe)),
        }
    }

    fn input(&mut self, name: &str) -> Result<InputPort, Error> {
        match self {
            FmuEngine::Stepping(run) => run.with(|r| r.input(name)),
            FmuEngine::Exchange(run) => run.with(|r| r.input(name)),
        }
    }

    fn set(&mut self, input: InputPort, value: f64) {
        match self {
            FmuEngine::Stepping(run) => run.with(|r| r.set(input, value)),
            FmuEngine::Exchange(run) => run.with(|r| r.set(input, value)),
        }
    }
}

/// A run under way, with what was looked up in it, by port.
struct FmuRun {
    engine: FmuEngine,
    probes: Vec<Option<Probe>>,
    inputs: Vec<Option<InputPort>>,
}

/// How the last call ended, where it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallOutcome {
    /// As asked.
    On,
    /// The model has called `terminate`.
    Terminated,
}

/// A state of a unit, to come back to.
#[derive(Clone, Debug)]
pub struct FmuSnapshot {
    given: BTreeMap<usize, f64>,
    state: Option<State>,
    ready: bool,
}

/// What was compiled in this process, by token: instances of one unit share its code. A token is a digest of the texts.
static COMPILED: Mutex<BTreeMap<String, (Simulation, FmiInterface)>> = Mutex::new(BTreeMap::new());

/// An instance.
pub struct FmuInstance {
    kind: FmuMode,
    /// As it was compiled.
    fresh: Simulation,
    simulation: Simulation,
    interface: FmiInterface,
    /// How many continuous states and functions that watch for events there are.
    counts: [usize; 2],
    /// Values set from outside, by port.
    given: BTreeMap<usize, f64>,
    run: Option<FmuRun>,
    /// Initialization is over: inputs now act from step to step.
    ready: bool,
}

impl FmuInstance {
    /// Compiles what lies in the folder of resources.
    ///
    /// # Errors
    /// What a user reads.
    pub fn new(resources: &Path, token: &str, kind: FmuMode) -> Result<Self, String> {
        let mut compiled = COMPILED.lock().unwrap_or_else(PoisonError::into_inner);
        let (simulation, interface) = match compiled.get(token) {
            Some(known) => known.clone(),
            None => {
                let made = Self::compile(resources, token)?;
                compiled.insert(token.to_owned(), made.clone());
                made
            }
        };
        if let (FmuMode::ModelExchange, Some(why)) = (kind, interface.alone) {
            return Err(format!("there is no Model Exchange: {why}"));
        }
        let (fresh, given) = (simulation.clone(), BTreeMap::new());
        let counts = [interface.rates().len(), interface.indicators().len()];
        Ok(FmuInstance { kind, fresh, simulation, interface, counts, given, run: None, ready: false })
    }

    fn compile(resources: &Path, token: &str) -> Result<(Simulation, FmiInterface), String> {
        let file = resources.join(packed::FILE);
        let text = std::fs::read_to_string(&file).map_err(|why| format!("`{}`: {why}", file.display()))?;
        let packed = PackedRequest::from_json(&text).map_err(|why| format!("`{}`: {why}", file.display()))?;
        if packed.token != token {
            return Err("the token is not that of this unit: description and binary do not belong together".to_owned());
        }
        let simulation = Simulation::compile(&packed, &packed.request()).map_err(|e| e.full())?;
        let interface = FmiInterface::new(&simulation, &packed.outputs)?;
        Ok((simulation, interface))
    }

    /// Times in seconds and the relative tolerance of the run to come.
    pub fn setup(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) {
        let settings = self.simulation.settings();
        // steps may go on after this time: it says how long the run is about
        let length = settings.stop_time - settings.start_time;
        settings.stop_time = stop.filter(|stop| *stop > start).unwrap_or(start + length);
        settings.start_time = start;
        settings.tolerance = tolerance.unwrap_or(settings.tolerance);
        self.run = None;
    }

    /// Where the run stands, in seconds.
    pub fn time(&mut self) -> f64 {
        match &mut self.run {
            Some(run) => run.engine.time(),
            None => self.simulation.settings().start_time,
        }
    }

    /// The value behind a reference.
    ///
    /// # Errors
    /// There is no such reference, or no initial values.
    pub fn get(&mut self, reference: u32) -> Result<f64, String> {
        let Some(port) = (reference as usize).checked_sub(1) else { return Ok(self.time()) };
        let name = self.name(port)?;
        match self.interface.ports[port].causality {
            FmiCausality::Parameter | FmiCausality::Calculated if self.run.is_none() => {
                return self.simulation.get(&name).map_err(|e| e.full());
            }
            // the run takes it over with its next step
            FmiCausality::Input if self.given.contains_key(&port) => return Ok(self.given[&port]),
            _ => {}
        }
        let rate = match self.interface.ports[port].role {
            ModelExchangeRole::Plain => None,
            ModelExchangeRole::Rate(state) => {
                let state = &self.interface.ports[state].signal.name;
                Some(self.simulation.rate_probe(state).map_err(|e| e.full())?)
            }
            ModelExchangeRole::Indicator(k) => return self.exchange(|e| e.indicators().map(|all| all[k])),
        };
        let run = self.begun()?;
        let probe = match (run.probes[port], rate) {
            (Some(probe), _) | (None, Some(probe)) => probe,
            (None, None) => run.engine.probe(&name).map_err(|e| e.full())?,
        };
        run.probes[port] = Some(probe);
        run.engine.get(probe).map_err(|e| e.full())
    }

    /// Sets a parameter before the start, or an input.
    ///
    /// # Errors
    /// The variable cannot be set, or cannot have this value.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        let port = (reference as usize).checked_sub(1).ok_or("the time cannot be set")?;
        let name = self.name(port)?;
        if let Kind::Enumeration(literals) = &self.interface.ports[port].signal.kind
            && !(1..=literals.len()).any(|literal| literal as f64 == value)
        {
            return Err(format!("`{name}` cannot be {value}: its values are 1 to {}", literals.len()));
        }
        match self.interface.ports[port].causality {
            FmiCausality::Parameter if !self.ready => {
                self.simulation.set(&name, value).map_err(|e| e.full())?;
                self.run = None;
            }
            FmiCausality::Input if !value.is_finite() => return Err(format!("the input `{name}` cannot be {value}")),
            FmiCausality::Input if self.ready => {
                let run = self.begun()?;
                let input = match run.inputs[port] {
                    Some(input) => input,
                    None => run.engine.input(&name).map_err(|e| e.full())?,
                };
                run.inputs[port] = Some(input);
                run.engine.set(input, value);
            }
            FmiCausality::Input => self.run = None,
            FmiCausality::Parameter => return Err(format!("the parameter `{name}` keeps its value after the start")),
            _ => return Err(format!("`{name}` follows from others and cannot be set")),
        }
        self.given.insert(port, value);
        Ok(())
    }

    /// Ends initialization.
    ///
    /// # Errors
    /// There are no initial values.
    pub fn start(&mut self) -> Result<(), String> {
        self.begun()?;
        self.ready = true;
        Ok(())
    }

    /// Goes on to a time.
    ///
    /// # Errors
    /// Why the run cannot go on.
    pub fn step_to(&mut self, time: f64) -> Result<CallOutcome, String> {
        let FmuEngine::Stepping(run) = &mut self.begun()?.engine else { return Err("there are no steps".to_owned()) };
        run.with(|r| r.step_to(time)).map_err(|e| e.full())?;
        Ok(if run.with(|r| r.terminated().is_some()) { CallOutcome::Terminated } else { CallOutcome::On })
    }

    /// Acts on the model of Model Exchange.
    ///
    /// # Errors
    /// This is not Model Exchange; what the act says.
    pub fn exchange<T>(&mut self, act: impl FnOnce(&mut Exchange<'_>) -> Result<T, Error>) -> Result<T, String> {
        match &mut self.begun()?.engine {
            FmuEngine::Exchange(run) => run.with(act).map_err(|e| e.full()),
            FmuEngine::Stepping(_) => Err("this is a function of Model Exchange".to_owned()),
        }
    }

    /// How many functions watch for events.
    pub fn indicators(&self) -> usize {
        self.counts[1]
    }

    /// How many continuous states there are.
    pub fn states(&self) -> usize {
        self.counts[0]
    }

    /// Warnings since the last call.
    pub fn warnings(&mut self) -> Vec<String> {
        let Some(run) = &mut self.run else { return Vec::new() };
        let warnings = match &mut run.engine {
            FmuEngine::Stepping(run) => run.with(|r| r.warnings()),
            FmuEngine::Exchange(run) => run.with(|r| r.warnings()),
        };
        warnings.into_iter().map(|d| d.message).collect()
    }

    /// Back to where it was after instantiation.
    pub fn reset(&mut self) {
        self.simulation = self.fresh.clone();
        self.given.clear();
        (self.run, self.ready) = (None, false);
    }

    /// A state to come back to.
    ///
    /// # Errors
    /// Those of Model Exchange are not kept.
    pub fn snapshot(&mut self) -> Result<FmuSnapshot, String> {
        let state = match self.run.as_mut().map(|run| &mut run.engine) {
            None => None,
            Some(FmuEngine::Stepping(run)) => Some(run.with(|r| r.state())),
            Some(FmuEngine::Exchange(_)) => return Err("states of Model Exchange cannot be kept".to_owned()),
        };
        Ok(FmuSnapshot { given: self.given.clone(), state, ready: self.ready })
    }

    /// Goes back to a state.
    ///
    /// # Errors
    /// The state is of another model.
    pub fn restore(&mut self, snapshot: &FmuSnapshot) -> Result<(), String> {
        self.given.clone_from(&snapshot.given);
        // parameters that were set after the snapshot go back as well; times and tolerance stay
        let settings = self.simulation.settings();
        let (start, stop, tolerance) = (settings.start_time, settings.stop_time, settings.tolerance);
        self.simulation = self.fresh.clone();
        let settings = self.simulation.settings();
        (settings.start_time, settings.stop_time, settings.tolerance) = (start, stop, tolerance);
        for (&port, &value) in &snapshot.given {
            if self.interface.ports[port].causality == FmiCausality::Parameter {
                self.simulation.set(&self.interface.ports[port].signal.name, value).map_err(|e| e.full())?;
            }
        }
        self.ready = snapshot.ready;
        self.run = None;
        if let Some(state) = &snapshot.state {
            self.run = Some(self.begin(Some(state))?);
        }
        Ok(())
    }

    /// A snapshot as bytes.
    pub fn bytes(snapshot: &FmuSnapshot) -> Vec<u8> {
        let mut out = vec![u8::from(snapshot.ready), u8::from(snapshot.state.is_some())];
        out.extend((snapshot.given.len() as u64).to_le_bytes());
        for (&port, value) in &snapshot.given {
            out.extend((port as u64).to_le_bytes());
            out.extend(value.to_le_bytes());
        }
        out.extend(snapshot.state.iter().flat_map(State::bytes));
        out
    }

    /// What [`FmuInstance::bytes`] has written; `None` for the bytes of another model.
    pub fn read_bytes(&self, bytes: &[u8]) -> Option<FmuSnapshot> {
        let (&[ready, has_state], rest) = bytes.split_first_chunk::<2>()?;
        let (count, mut rest) = rest.split_first_chunk::<8>()?;
        let mut given = BTreeMap::new();
        for _ in 0..u64::from_le_bytes(*count) {
            let (port, after) = rest.split_first_chunk::<8>()?;
            let (value, after) = after.split_first_chunk::<8>()?;
            let port = usize::try_from(u64::from_le_bytes(*port)).ok()?;
            self.interface.ports.get(port)?;
            given.insert(port, f64::from_le_bytes(*value));
            rest = after;
        }
        let names = || self.simulation.model().dae.variables.iter().map(|v| v.name.clone()).collect();
        let state = if has_state == 1 { Some(State::from_bytes(names(), rest)?) } else { None };
        Some(FmuSnapshot { given, state, ready: ready == 1 })
    }

    fn name(&self, port: usize) -> Result<String, String> {
        let found = self.interface.ports.get(port).map(|p| p.signal.name.clone());
        found.ok_or_else(|| format!("there is no variable with the value reference {}", port + 1))
    }

    /// The run; it begins with what was set so far.
    fn begun(&mut self) -> Result<&mut FmuRun, String> {
        if self.run.is_none() {
            self.run = Some(self.begin(None)?);
        }
        self.run.as_mut().ok_or_else(|| "the run has not begun".to_owned())
    }

    fn begin(&mut self, from: Option<&State>) -> Result<FmuRun, String> {
        let ports = self.interface.ports.len();
        let simulation = self.prepared()?;
        let engine = match self.kind {
            FmuMode::CoSimulation => OwnedStepping::new(simulation, from).map(FmuEngine::Stepping),
            FmuMode::ModelExchange => OwnedExchange::new(simulation).map(FmuEngine::Exchange),
        };
        let engine = engine.map_err(|e| e.full())?;
        Ok(FmuRun { engine, probes: vec![None; ports], inputs: vec![None; ports] })
    }

    /// The simulation with the inputs that were set, for the initial values.
    fn prepared(&mut self) -> Result<Simulation, String> {
        let mut simulation = self.simulation.clone();
        let start = simulation.settings().start_time;
        for (&port, &value) in &self.given {
            let ports = &self.interface.ports[port];
            if ports.causality == FmiCausality::Input {
                let input = simulation.input(&ports.signal.name, &[start], &[value], Interpolation::Held);
                input.map_err(|e| e.full())?;
            }
        }
        Ok(simulation)
    }
}
