//! The variables of a unit: which there are, in which order, and what they may be used for.
//!
//! A compiled `Simulation` enters, an [`FmiInterface`] leaves. The description lists it and the runtime library answers
//! by it. Both derive it from the same texts, so the value references agree.

use bramah_circuit::Parameter;
use bramah_circuit::Simulation;
use bramah_results::{GlobPatterns, Kind, Signal};
use rustc_hash::FxHashSet;

/// The causality of a variable in the sense of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmiCausality {
    /// May be set before the start of a run.
    Parameter,
    /// A parameter that others determine, or on which the structure of the model depends. It cannot be set.
    Calculated,
    /// Set by the importing tool during a run.
    Input,
    /// Offered to other models.
    Output,
    /// Any other variable; may be read.
    Local,
}

/// A variable of a unit. Its value reference is its index in the list plus 1; 0 is the time.
#[derive(Clone, Debug, PartialEq)]
pub struct FmiVariable {
    /// Name, units, description, type.
    pub signal: Signal,
    /// What it may be used for.
    pub causality: FmiCausality,
    /// The value before the start in the unit of the signal. `None` for variables that are computed.
    pub start: Option<f64>,
    /// Lower limit; `None` when there is none.
    pub min: Option<f64>,
    /// Upper limit; `None` when there is none.
    pub max: Option<f64>,
    /// Its role in Model Exchange.
    pub role: ModelExchangeRole,
}

/// The role of a variable in Model Exchange, where the importing tool integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelExchangeRole {
    /// No special role, or a state.
    Plain,
    /// The derivative of the state with this index in the list of variables.
    Rate(usize),
    /// The event indicator with this number: an event occurs where it changes its sign.
    Indicator(usize),
}

/// All variables of a unit, with its default experiment.
#[derive(Clone, Debug)]
pub struct FmiInterface {
    /// Full name of the class.
    pub class: String,
    /// Variables in the order of their value references.
    pub ports: Vec<FmiVariable>,
    /// Start time, stop time and output interval in seconds, and the relative tolerance.
    pub experiment: [f64; 4],
    /// Why Model Exchange is not offered. `None`: it is.
    pub alone: Option<&'static str>,
}

impl FmiInterface {
    /// The variables of a compiled model. Outputs are the model's own and those that a pattern of `outputs` matches.
    ///
    /// # Errors
    /// The first pattern that matches no variable.
    pub fn new(simulation: &Simulation, outputs: &[String]) -> Result<Self, String> {
        let wanted = GlobPatterns::new(outputs);
        let variables = simulation.variables();
        if let Some(unknown) = wanted.unused(variables.iter().map(|v| v.name.as_str())).first() {
            return Err((*unknown).to_owned());
        }
        let inputs = simulation.inputs();
        let own = simulation.outputs();
        let is_output = |s: &Signal| own.contains(&s.name) || wanted.matches(&s.name);
        // Parameters, inputs, other variables, then those of Model Exchange: the order is part of the value references.
        let mut ports: Vec<FmiVariable> = simulation.parameters().into_iter().map(parameter).collect();
        ports.extend(inputs.iter().map(|s| FmiVariable {
            start: simulation.start_of(&s.name).ok(),
            ..FmiVariable::new(s.clone(), FmiCausality::Input)
        }));
        // Inputs are among the variables too and must not appear twice.
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

    /// Indices of the derivatives, in the order of the states.
    pub fn rates(&self) -> Vec<usize> {
        self.places(|role| matches!(role, ModelExchangeRole::Rate(_)))
    }

    /// Indices of the event indicators.
    pub fn indicators(&self) -> Vec<usize> {
        self.places(|role| matches!(role, ModelExchangeRole::Indicator(_)))
    }

    /// Indices of the variables whose role `is` accepts.
    fn places(&self, is: impl Fn(ModelExchangeRole) -> bool) -> Vec<usize> {
        self.ports.iter().enumerate().filter(|(_, p)| is(p.role)).map(|(i, _)| i).collect()
    }
}

impl FmiVariable {
    /// A variable without start value, limits and role.
    fn new(signal: Signal, causality: FmiCausality) -> Self {
        FmiVariable { signal, causality, start: None, min: None, max: None, role: ModelExchangeRole::Plain }
    }
}

/// Adds the variables of Model Exchange: hidden states, derivatives of all states, and event indicators.
fn exchanged(simulation: &Simulation, ports: &mut Vec<FmiVariable>) {
    let states = simulation.states();
    // The derivative of a state must refer to a variable of the description, so hidden states are added first.
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
        // A unit with two slashes would be ambiguous, so the derivative gets none.
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

/// A parameter. It can be set only when no other parameter determines it and the structure does not depend on it.
fn parameter(p: Parameter) -> FmiVariable {
    let settable = p.root && !p.structural;
    let causality = if settable { FmiCausality::Parameter } else { FmiCausality::Calculated };
    FmiVariable { start: settable.then_some(p.value), min: p.min, max: p.max, ..FmiVariable::new(p.signal, causality) }
}
