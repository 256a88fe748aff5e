//! What a unit shows of its model: the list that the description names and the library answers for.

use bramah_circuit::Parameter;
use bramah_circuit::Simulation;
use bramah_results::{GlobPatterns, Kind, Signal};
use rustc_hash::FxHashSet;

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmiCausality {
    /// May be set before the start.
    Parameter,
    /// A parameter that others decide, or on which the structure of the model depends.
    Calculated,
    /// Set from outside during a run.
    Input,
    /// Meant for others.
    Output,
    /// Anything else.
    Local,
}

/// A variable of the unit. Its value reference is its index plus 1; 0 is the time.
#[derive(Clone, Debug, PartialEq)]
pub struct FmiVariable {
    /// Name, units, description, type.
    pub signal: Signal,
    /// What it is for.
    pub causality: FmiCausality,
    /// The value before the start, of parameters and inputs.
    pub start: Option<f64>,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// What it is of Model Exchange.
    pub role: ModelExchangeRole,
}

/// What a variable is of Model Exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelExchangeRole {
    /// Nothing in particular, or a state.
    Plain,
    /// The derivative of the state at this place in the list.
    Rate(usize),
    /// A function whose change of sign is an event, by its number.
    Indicator(usize),
}

/// All of them.
#[derive(Clone, Debug)]
pub struct FmiInterface {
    /// The class.
    pub class: String,
    /// Variables in the order of their value references.
    pub ports: Vec<FmiVariable>,
    /// Start and stop time, interval (s), relative tolerance.
    pub experiment: [f64; 4],
    /// Why there is no Model Exchange; `None` where there is.
    pub alone: Option<&'static str>,
}

impl FmiInterface {
    /// What a compiled model shows. Outputs are the model's own, and those of its variables that `outputs` names.
    ///
    /// # Errors
    /// The pattern that no variable matches.
    pub fn new(simulation: &Simulation, outputs: &[String]) -> Result<Self, String> {
        let wanted = GlobPatterns::new(outputs);
        let variables = simulation.variables();
        if let Some(unknown) = wanted.unused(variables.iter().map(|v| v.name.as_str())).first() {
            return Err((*unknown).to_owned());
        }
        let inputs = simulation.inputs();
        let own = simulation.outputs();
        let is_output = |s: &Signal| own.contains(&s.name) || wanted.matches(&s.name);
        let mut ports: Vec<FmiVariable> = simulation.parameters().into_iter().map(parameter).collect();
        ports.extend(inputs.iter().map(|s| FmiVariable {
            start: simulation.start_of(&s.name).ok(),
            ..FmiVariable::new(s.clone(), FmiCausality::Input)
        }));
        let seen: FxHashSet<&str> = inputs.iter().map(|s| s.name.as_str()).collect();
        let others = variables.iter().filter(|s| !seen.contains(s.name.as_str()));
        ports.extend(others.map(|s| {
            FmiVariable::new(s.clone(), if is_output(s) { FmiCausality::Output } else { FmiCausality::Local })
        }));
        let settings = simulation.run_settings();
        let experiment = [settings.start_time, settings.stop_time, settings.interval, settings.tolerance];
        let alone = simulation.keeps_its_integrator();
        if alone.is_none() {
            exchanged(simulation, &mut ports);
        }
        Ok(FmiInterface { class: simulation.model().flat.class.clone(), ports, experiment, alone })
    }

    /// Places of derivatives, in the order of the states.
    pub fn rates(&self) -> Vec<usize> {
        self.places(|role| matches!(role, ModelExchangeRole::Rate(_)))
    }

    /// Places of the functions whose change of sign is an event.
    pub fn indicators(&self) -> Vec<usize> {
        self.places(|role| matches!(role, ModelExchangeRole::Indicator(_)))
    }

    fn places(&self, is: impl Fn(ModelExchangeRole) -> bool) -> Vec<usize> {
        self.ports.iter().enumerate().filter(|(_, p)| is(p.role)).map(|(i, _)| i).collect()
    }
}

impl FmiVariable {
    fn new(signal: Signal, causality: FmiCausality) -> Self {
        FmiVariable { signal, causality, start: None, min: None, max: None, role: ModelExchangeRole::Plain }
    }
}

/// Adds what Model Exchange passes on: states that are hidden, derivatives, and functions that watch for events.
fn exchanged(simulation: &Simulation, ports: &mut Vec<FmiVariable>) {
    let states = simulation.states();
    for state in &states {
        if !ports.iter().any(|p| p.signal.name == state.name) {
            ports.push(FmiVariable::new(state.clone(), FmiCausality::Local));
        }
    }
    for state in states {
        let at = ports.iter().position(|p| p.signal.name == state.name).unwrap_or_default();
        let unit = match state.unit.as_str() {
            "" => String::new(),
            "1" => "1/s".to_owned(),
            unit => format!("{unit}/s"),
        };
        let unit = if unit.matches('/').count() > 1 { String::new() } else { unit };
        let signal = Signal { name: format!("der({})", state.name), unit, kind: Kind::Real, ..Signal::default() };
        ports.push(FmiVariable { role: ModelExchangeRole::Rate(at), ..FmiVariable::new(signal, FmiCausality::Local) });
    }
    for k in 0..simulation.indicators() {
        let signal = Signal { name: format!("eventIndicators[{}]", k + 1), kind: Kind::Real, ..Signal::default() };
        ports.push(FmiVariable {
            role: ModelExchangeRole::Indicator(k),
            ..FmiVariable::new(signal, FmiCausality::Local)
        });
    }
}

fn parameter(p: Parameter) -> FmiVariable {
    let settable = p.root && !p.structural;
    let causality = if settable { FmiCausality::Parameter } else { FmiCausality::Calculated };
    FmiVariable { start: settable.then_some(p.value), min: p.min, max: p.max, ..FmiVariable::new(p.signal, causality) }
}
