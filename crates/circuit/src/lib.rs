//! Circuits from Rust: built component by component, or read from text, compiled once and run many times.
//!
//! [`Circuit`] writes the model that its calls describe and hands it to the same pipeline as a file, so that both give
//! the same instance. [`Simulation`] is a compiled model with the settings of a run; clones share the compiled code.

mod callback;
pub mod compiled;
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

use bramah_model::compile::Request;
use bramah_model::instance::Override;
use bramah_syntax::diag::{Code, Diagnostic, Error};
use bramah_syntax::world::MemoryWorld;
use std::fmt::Write;
use std::sync::Arc;

/// A circuit under construction.
///
/// Names and classes are checked when the circuit is compiled, with the messages that a file would get.
///
/// ```
/// use bramah::Circuit;
///
/// # fn main() -> Result<(), bramah::Error> {
/// let mut circuit = Circuit::new("Press");
/// circuit
///     .inner("oil", "Oil.Water") // what components take as `outer`
///     .redeclare("function density", "Oil.Compression.constantModulus")
///     .input("u", "m3/s") // driven from outside
///     .set("start", "6 l/min")
///     .add("volume", "Hydraulic.Volume")
///     .set("V", "1 l")
///     .set("p_start", 20e5)
///     .add("load", "Hydraulic.Orifice")
///     .set("A", "2 mm2")
///     .add("tank", "Hydraulic.Tank")
///     .add("source", "Hydraulic.FlowSource")
///     .set("useInput", true)
///     .connect("u", "source.q_in")
///     .connect("source.port", "volume.port")
///     .connect("volume.port", "load.port_a")
///     .connect("load.port_b", "tank.port");
/// let simulation = circuit.compile()?;
/// assert_eq!(simulation.get("volume.V")?, 1e-3);
/// assert_eq!(simulation.inputs()[0].name, "u");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Circuit {
    name: String,
    declarations: String,
    components: Vec<CircuitComponent>,
    connections: Vec<(String, String)>,
    equations: Vec<String>,
    /// Parameters that were set before there was a component.
    astray: Vec<String>,
}

/// A component with what modifies it.
#[derive(Clone, Debug)]
struct CircuitComponent {
    /// `inner ` or nothing.
    prefix: &'static str,
    name: String,
    class: String,
    /// Modifiers in Modelica.
    modifiers: Vec<String>,
    /// Values with a unit of their own: the compiler knows the variable's.
    quantities: Vec<(String, String)>,
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
        self.component("", name.into(), class.into())
    }

    /// Adds a component that others take as `outer`, such as the oil: `inner("oil", "Oil.Water")`.
    pub fn inner(&mut self, name: impl Into<String>, class: impl Into<String>) -> &mut Self {
        self.component("inner ", name.into(), class.into())
    }

    /// Adds an input, a real signal in a unit, whose values come from outside during a run ([`Simulation::input`],
    /// [`Stepping`]). It can be connected; `set("start", ..)` gives it a value that counts where nothing drives it.
    pub fn input(&mut self, name: impl Into<String>, unit: &str) -> &mut Self {
        self.component("", name.into(), "Interfaces.RealInput".into());
        if unit.is_empty() { self } else { self.set("unit", format!("\"{unit}\"")) }
    }

    fn component(&mut self, prefix: &'static str, name: String, class: String) -> &mut Self {
        self.components.push(CircuitComponent { prefix, name, class, modifiers: Vec::new(), quantities: Vec::new() });
        self
    }

    /// Modifies the component added last: `set("V", "1 l")`, `set("V", 1e-3)`, `set("p.start", "2*p_0")`. Values are
    /// Modelica expressions in the variable's unit, or numbers with a unit of their own. Before any component was added
    /// there is nothing to modify, and the circuit does not compile.
    pub fn set(&mut self, parameter: impl Into<String>, value: impl ToString) -> &mut Self {
        let (parameter, value) = (parameter.into(), value.to_string());
        match self.components.last_mut() {
            // A unit of its own is no Modelica; the compiler converts it, since it knows the unit of the parameter.
            Some(c) if is_quantity(&value) => c.quantities.push((parameter, value)),
            Some(c) => c.modifiers.push(format!("{parameter} = {value}")),
            // Reported by `compile`, so that calls can be chained without results.
            None => self.astray.push(parameter),
        }
        self
    }

    /// Exchanges a replaceable class of the component added last, named with its kind:
    /// `redeclare("function density", "Oil.Compression.constantModulus")`, `redeclare("package Medium", "MyMedium")`.
    pub fn redeclare(&mut self, element: impl Into<String>, class: impl Into<String>) -> &mut Self {
        let (element, class) = (element.into(), class.into());
        match self.components.last_mut() {
            Some(c) => c.modifiers.push(format!("redeclare {element} = {class}")),
            None => self.astray.push(element),
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
    /// Values with units of their own are comments in it: they are given when it is compiled.
    pub fn text(&self) -> String {
        let mut text = format!("model {}\n", self.name);
        for line in self.declarations.lines() {
            let _ = writeln!(text, "  {line}");
        }
        for CircuitComponent { prefix, name, class, modifiers, quantities } in &self.components {
            let list = if modifiers.is_empty() { String::new() } else { format!("({})", modifiers.join(", ")) };
            let _ = writeln!(text, "  {prefix}{class} {name}{list};");
            for (parameter, value) in quantities {
                // As a comment, which shows the value without changing the text that is compiled.
                let _ = writeln!(text, "  // {name}.{parameter} = {value}");
            }
        }
        text.push_str("equation\n");
        for (a, b) in &self.connections {
            let _ = writeln!(text, "  connect({a}, {b});");
        }
        for e in &self.equations {
            // The caller may have written the semicolon or not.
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
        let given = |c: &CircuitComponent| {
            let of = c.name.clone();
            let values = c.quantities.clone().into_iter();
            values.map(move |(parameter, value)| Override { name: format!("{of}.{parameter}"), value })
        };
        let request = Request {
            source: file.into(),
            model: Some(self.name.clone()),
            // Values with units are given like those of the command's option `--set`.
            overrides: self.components.iter().flat_map(given).collect(),
            ..Request::default()
        };
        Simulation::compile(&world, &request)
    }
}

/// A number with a unit, which is no Modelica.
fn is_quantity(value: &str) -> bool {
    matches!(bramah_expr::units::quantity(value), Ok((_, Some(_))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn emptying(oil: fn(&mut Circuit)) -> Circuit {
        let mut circuit = Circuit::new("Emptying");
        oil(&mut circuit);
        circuit.add("volume", "Hydraulic.Volume").set("V", "1 l").set("p_start", "10 bar");
        circuit.add("orifice", "Hydraulic.Orifice").add("tank", "Hydraulic.Tank");
        circuit.connect("volume.port", "orifice.port_a").connect("orifice.port_b", "tank.port");
        circuit
    }

    /// Water that no component takes would leave them all with the default oil.
    #[test]
    fn an_oil_that_nobody_takes_is_an_error() {
        let plain = emptying(|c| _ = c.add("oil", "Oil.Water")).compile().unwrap_err().to_string();
        assert!(plain.contains("E016") && plain.contains("`oil` is not `inner`"), "{plain}");
        let named = emptying(|c| _ = c.inner("water", "Oil.Water")).compile().unwrap_err().to_string();
        assert!(named.contains("E016") && named.contains("`inner oil`"), "{named}");
        let taken = emptying(|c| _ = c.inner("oil", "Oil.Water")).compile().unwrap();
        assert_eq!(taken.get("volume.V").unwrap(), 1e-3);
        assert_eq!(taken.get("volume.p_start").unwrap(), 1e6);
    }

    #[test]
    fn values_with_wrong_units_are_errors() {
        let mut circuit = emptying(|_| {});
        circuit.add("other", "Hydraulic.Volume").set("V", "1 bar");
        let said = circuit.compile().unwrap_err().full();
        assert!(said.contains("E023") && said.contains("`other.V` is in `m3`"), "{said}");
    }

    #[test]
    fn a_value_for_no_component_is_an_error() {
        let mut circuit = Circuit::new("Empty");
        circuit.set("V", 1.0).add("tank", "Hydraulic.Tank");
        let said = circuit.compile().unwrap_err().to_string();
        assert!(said.contains("`set(\"V\", ..)` has no component"), "{said}");
    }
}
