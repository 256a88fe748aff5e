//! Circuits from Rust: built component by component, or read from text, compiled once and run many times.
//!
//! [`Circuit`] writes the model that its calls describe and hands it to the same pipeline as a file, so that both give
//! the same instance. [`Simulation`] is a compiled model with the settings of a run; clones share the compiled code.

mod callback;
mod exchange;
mod owned;
mod parameters;
mod simulation;
mod stepping;

pub use exchange::Exchange;
pub use owned::{OwnedExchange, OwnedStepping};
pub use parameters::Parameter;
pub use simulation::{Outcome, Simulation};
pub use stepping::{InputPort, Probe, Stepping};

use crate::compile::Request;
use crate::diag::{Code, Diagnostic, Error};
use crate::instance::Override;
use crate::world::MemoryWorld;
use std::fmt::Write;
use std::sync::Arc;

/// A circuit under construction.
///
/// Names and classes are checked when the circuit is compiled, with the messages that a file would get.
#[derive(Clone, Debug, Default)]
pub struct Circuit {
    name: String,
    declarations: String,
    components: Vec<(String, String, Vec<(String, String)>)>,
    connections: Vec<(String, String)>,
    equations: Vec<String>,
    /// Parameters that were set before there was a component.
    astray: Vec<String>,
}

impl Circuit {
    /// An empty circuit; the name becomes the model's.
    pub fn new(name: impl Into<String>) -> Self {
        Circuit { name: name.into(), ..Circuit::default() }
    }

    /// Declares classes of the circuit's own, in Modelica.
    pub fn declare(&mut self, text: &str) -> &mut Self {
        self.declarations.push_str(text);
        self.declarations.push('\n');
        self
    }

    /// Adds a component of a class that ships with bramah or was declared.
    pub fn add(&mut self, name: impl Into<String>, class: impl Into<String>) -> &mut Self {
        self.components.push((name.into(), class.into(), Vec::new()));
        self
    }

    /// Modifies the component added last: `set("V", "1e-3")`, `set("p.start", "5e5")`. Values are Modelica
    /// expressions, in the variable's unit. Before any component was added there is nothing to modify, and the circuit does
    /// not compile.
    pub fn set(&mut self, parameter: impl Into<String>, value: impl ToString) -> &mut Self {
        match self.components.last_mut() {
            Some((.., modifiers)) => modifiers.push((parameter.into(), value.to_string())),
            None => self.astray.push(parameter.into()),
        }
        self
    }

    /// Joins two ports.
    pub fn connect(&mut self, a: impl Into<String>, b: impl Into<String>) -> &mut Self {
        self.connections.push((a.into(), b.into()));
        self
    }

    /// Adds an equation in Modelica.
    pub fn equation(&mut self, text: impl Into<String>) -> &mut Self {
        self.equations.push(text.into());
        self
    }

    /// The circuit as Modelica text.
    pub fn text(&self) -> String {
        let mut text = format!("model {}\n", self.name);
        for line in self.declarations.lines() {
            let _ = writeln!(text, "  {line}");
        }
        for (name, class, modifiers) in &self.components {
            let list: Vec<String> = modifiers.iter().map(|(n, v)| format!("{n} = {v}")).collect();
            let list = if list.is_empty() { String::new() } else { format!("({})", list.join(", ")) };
            let _ = writeln!(text, "  {class} {name}{list};");
        }
        text.push_str("equation\n");
        for (a, b) in &self.connections {
            let _ = writeln!(text, "  connect({a}, {b});");
        }
        for e in &self.equations {
            let _ = writeln!(text, "  {};", e.trim_end_matches(';'));
        }
        let _ = writeln!(text, "end {};", self.name);
        text
    }

    /// Compiles the circuit.
    ///
    /// # Errors
    /// The diagnostics of the first stage that finds something wrong; their places are in [`Circuit::text`].
    pub fn compile(&self) -> Result<Simulation, Error> {
        if let Some(parameter) = self.astray.first() {
            let text = format!("`set(\"{parameter}\", ..)` has no component to modify");
            let d = Diagnostic::new(Code::BadSet, text).help("it modifies the component that was added last");
            return Err(Error { diagnostics: vec![d], sources: Arc::default() });
        }
        let file = format!("{}.mo", self.name);
        let world = MemoryWorld::single(&file, self.text());
        let request = Request {
            source: file.into(),
            model: Some(self.name.clone()),
            overrides: Vec::<Override>::new(),
            ..Request::default()
        };
        Simulation::compile(&world, &request)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_for_no_component_is_an_error() {
        let mut circuit = Circuit::new("Empty");
        circuit.set("V", 1.0).add("tank", "Hydraulic.Tank");
        let said = circuit.compile().unwrap_err().to_string();
        assert!(said.contains("`set(\"V\", ..)` has no component"), "{said}");
    }
}
