//! What a unit shows of its model: the list that the description names and the library answers for.

use crate::Simulation;
use crate::circuit::Parameter;
use crate::results::{Globs, Signal};
use rustc_hash::FxHashSet;

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
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
pub struct Port {
    /// Name, units, description, type.
    pub signal: Signal,
    /// What it is for.
    pub causality: Causality,
    /// The value before the start, of parameters and inputs.
    pub start: Option<f64>,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
}

/// All of them.
#[derive(Clone, Debug)]
pub struct Interface {
    /// The class.
    pub class: String,
    /// Variables in the order of their value references.
    pub ports: Vec<Port>,
    /// Start and stop time, interval (s), relative tolerance.
    pub experiment: [f64; 4],
}

impl Interface {
    /// What a compiled model shows. Outputs are the model's own, and those of its variables that `outputs` names.
    ///
    /// # Errors
    /// The pattern that no variable matches.
    pub fn new(simulation: &Simulation, outputs: &[String]) -> Result<Self, String> {
        let wanted = Globs::new(outputs);
        let variables = simulation.variables();
        if let Some(unknown) = wanted.unused(variables.iter().map(|v| v.name.as_str())).first() {
            return Err((*unknown).to_owned());
        }
        let inputs = simulation.inputs();
        let own = simulation.outputs();
        let is_output = |s: &Signal| own.contains(&s.name) || wanted.matches(&s.name);
        let mut ports: Vec<Port> = simulation.parameters().into_iter().map(parameter).collect();
        ports.extend(
            inputs
                .iter()
                .map(|s| Port { start: simulation.start_of(&s.name).ok(), ..Port::new(s.clone(), Causality::Input) }),
        );
        let seen: FxHashSet<&str> = inputs.iter().map(|s| s.name.as_str()).collect();
        let others = variables.iter().filter(|s| !seen.contains(s.name.as_str()));
        ports.extend(
            others.map(|s| Port::new(s.clone(), if is_output(s) { Causality::Output } else { Causality::Local })),
        );
        let settings = simulation.asked();
        let experiment = [settings.start_time, settings.stop_time, settings.interval, settings.tolerance];
        Ok(Interface { class: simulation.model().flat.class.clone(), ports, experiment })
    }
}

impl Port {
    fn new(signal: Signal, causality: Causality) -> Self {
        Port { signal, causality, start: None, min: None, max: None }
    }
}

fn parameter(p: Parameter) -> Port {
    let settable = p.root && !p.structural;
    let causality = if settable { Causality::Parameter } else { Causality::Calculated };
    Port { start: settable.then_some(p.value), min: p.min, max: p.max, ..Port::new(p.signal, causality) }
}
