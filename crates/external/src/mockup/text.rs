//! The Modelica class that stands for an FMU in a circuit.
//! A description enters, Modelica text leaves, which is compiled like any other.
//!
//! The class has the parameters, inputs and outputs of the unit, in SI units. Its equations call the functions that the
//! class `FMU`, which it extends, declares; `functions` carries these out. The state of the unit is a number in a
//! discrete
//! variable. Co-Simulation calls `advance` at samples; Model Exchange calls `evaluate` in continuous equations and
//! `event`
//! in a when-clause.

use super::description::{
    FmuCausality, FmuDataType, FmuDescription, FmuInterface, FmuStandard, FmuVariable, UnitConversion,
};
use super::functions::NEVER;
use std::fmt::Write;

/// Names that the class `FMU` and the generated class use themselves. A variable of such a name is quoted.
const OWN: [&str; 21] = [
    "file", "kind", "step", "Unit", "begin", "start", "advance", "evaluate", "event", "unit", "settings", "root",
    "taken", "given", "happened", "states", "rates", "started", "last", "held", "count",
];

/// The communication step if the unit suggests none (s).
const STEP: f64 = 0.01;

/// The parameters that a circuit may set, as indices of variables: those with a start value.
pub fn offered(description: &FmuDescription) -> Vec<usize> {
    let all = description.of(FmuCausality::Parameter);
    all.into_iter().filter(|&i| !description.variables[i].start.is_empty()).collect()
}

/// The text of the class for one interface.
/// It is a complete text with `model FMU` and `end FMU`.
pub fn class(description: &FmuDescription, kind: FmuInterface) -> String {
    let d = description;
    let (parameters, texts) = (offered(d), d.texts());
    let (inputs, outputs) = (d.of(FmuCausality::Input), d.of(FmuCausality::Output));
    let mut out = format!("model FMU {}\n  extends .FMU;\n", quoted(&title(d, kind)));
    let v = |i: &usize| &d.variables[*i];
    parameters.iter().for_each(|i| out += &parameter(v(i)));
    for i in &texts {
        let t = v(i);
        let _ = writeln!(out, "  parameter String {} = {}{};", name(&t.name), quoted(&t.text), comment(t));
    }
    inputs.iter().for_each(|i| out += &port(v(i), "Input"));
    outputs.iter().for_each(|i| out += &port(v(i), "Output"));
    if kind == FmuInterface::CoSimulation {
        let step = d.step.unwrap_or(STEP);
        let _ = writeln!(
            out,
            "  parameter Real step(unit = \"s\", min = 1e-9) = {step:e} \"Communication step: outputs hold from one point to the next\";"
        );
    }
    // The texts are passed as one string of lines, which the constructor splits.
    let said = texts.iter().map(|i| format!("\"{i}=\" + {} + \"\\n\"", name(&v(i).name)));
    let said: Vec<String> = std::iter::once("\"\"".to_owned()).chain(said).collect();
    let _ = writeln!(out, "protected\n  final parameter Unit unit = Unit(file, kind, {});", said.join(" + "));
    let numbers = |list: &[usize], reversed: bool| list_of(list.iter().flat_map(|i| elements(v(i), reversed)));
    // Parameters are converted to the units of the FMU.
    let _ = writeln!(out, "  final parameter Real root = begin(unit, {});", numbers(&parameters, true));
    let sizes = |list: &[usize]| list.iter().map(|i| v(i).size()).sum::<usize>();
    let body = match kind {
        FmuInterface::CoSimulation => co_simulation(sizes(&outputs)),
        FmuInterface::ModelExchange => model_exchange(d, sizes(&outputs)),
    };
    let given = sizes(&inputs);
    let _ = writeln!(out, "  Real given[{given}] \"Inputs in the unit's own units\";");
    let [declared, equations] = body;
    out += &declared;
    let _ = writeln!(out, "equation\n  given = {};", numbers(&inputs, true));
    out += &equations;
    out += &assigned(d, kind, &outputs);
    out + "end FMU;\n"
}

/// The description of the class: what the unit is, which standard and interface it has, and which tool made it.
/// It is shown as the description string of the class.
fn title(d: &FmuDescription, kind: FmuInterface) -> String {
    let what = if d.description.is_empty() { d.name.clone() } else { format!("{}: {}", d.name, d.description) };
    let version = match d.version {
        FmuStandard::Two => "2.0",
        FmuStandard::Three => "3.0",
    };
    let tool = if d.tool.is_empty() { String::new() } else { format!(", by {}", d.tool) };
    format!("{what} (FMI {version}, {}{tool})", kind.name())
}

/// Declarations and equations for Co-Simulation, with this number of scalar outputs.
/// The unit is stepped at communication points. Outputs are held in between, and inputs are those of the point before.
/// Gives the declarations and initial equations, then the equations.
fn co_simulation(outputs: usize) -> [String; 2] {
    let n = 1 + outputs;
    let declared = format!(
        "  discrete Real taken[{n}] \"State, outputs\";
  // Inputs of the last point are kept, because a step covers the interval before the event.
  discrete Real held[size(given, 1)] \"Inputs at the last communication point\";
  discrete Real last \"The last communication point\";
initial equation
  taken = advance(unit, {n}, root, time, time, given);
  held = given;
  last = time;
"
    );
    let equations = format!(
        "  when sample(0, step) then
    taken = advance(unit, {n}, pre(taken[1]), pre(last), time, pre(held));
    held = given;
    last = time;
  end when;
"
    );
    [declared, equations]
}

/// Declarations and equations for Model Exchange, with this number of scalar outputs.
/// Derivatives, event indicators and outputs are computed between events; discrete values change at events.
/// Gives the declarations and initial equations, then the equations.
fn model_exchange(d: &FmuDescription, outputs: usize) -> [String; 2] {
    let (n, z) = (d.states.len(), d.indicators);
    let discrete = d.of(FmuCausality::Output).into_iter().map(|i| &d.variables[i]).filter(|v| !v.continuous);
    let discrete: usize = discrete.map(FmuVariable::size).sum();
    let (all, at_events) = (n + z + outputs, 2 + n + discrete);
    let nominal: Vec<String> = d.states.iter().map(|s| format!("{:e}", nominal(&d.variables[s.0]))).collect();
    let states = if n == 0 { String::new() } else { format!("(nominal = {{{}}})", nominal.join(", ")) };
    let names: Vec<&str> = d.states.iter().map(|s| d.variables[s.0].name.as_str()).collect();
    // An event is where an indicator changes between positive and not positive, in either direction.
    let crossings = (1..=z).map(|k| n + k).flat_map(|k| [format!("rates[{k}] > 0"), format!("rates[{k}] <= 0")]);
    let inputs = d.of(FmuCausality::Input);
    // A discrete input changes only at events, and the unit must then see it in event mode.
    let mut changes = Vec::new();
    for v in inputs.iter().map(|&i| &d.variables[i]) {
        if !v.passed.is_real() {
            changes.extend(subscripted(v).iter().map(|e| format!("change({e})")));
        }
    }
    // `started` becomes true in the first event iteration: the unit's own first event iteration runs there.
    let when: Vec<String> = ["started".to_owned(), "time >= pre(happened[2])".to_owned()]
        .into_iter()
        .chain(crossings)
        .chain(changes)
        .collect();
    // The unit may set new states at any event.
    let reinit: String = (1..=n).map(|k| format!("    reinit(states[{k}], happened[{}]);\n", 2 + k)).collect();
    let start = if n == 0 { String::new() } else { format!("  states = happened[3:{}];\n", 2 + n) };
    let flow = if n == 0 { String::new() } else { format!("  der(states) = rates[1:{n}];\n") };
    let (names, found) = (quoted(&names.join(", ")), at_events - 2);
    let declared = format!(
        "  Real states[{n}]{states} {names};
  Real rates[{all}] \"Derivatives, event indicators, outputs\";
  discrete Real happened[{at_events}] \"State of the unit, its next event, continuous states, discrete outputs\";
  Boolean started(start = false, fixed = true);
initial equation
  happened = cat(1, {{root, {NEVER:e}}}, start(unit, {found}, root, time, given));
{start}"
    );
    let equations = format!(
        "  started = not initial();
  rates = evaluate(unit, {all}, pre(happened[1]), time, states, given);
{flow}  when {{{}}} then
    happened = event(unit, {at_events}, pre(happened[1]), time, states, given);
{reinit}  end when;
",
        when.join(", "),
    );
    [declared, equations]
}

/// The nominal value of a state, or 1 if the unit gives none.
/// Solvers scale the state by it.
fn nominal(v: &FmuVariable) -> f64 {
    v.limits[2].map(f64::abs).filter(|x| *x > 0.0).unwrap_or(1.0)
}

/// The equations that take the outputs from the results of the functions, in SI units.
fn assigned(d: &FmuDescription, kind: FmuInterface, outputs: &[usize]) -> String {
    let n = d.states.len();
    // The positions of the first output: after the state, after derivatives and indicators, or after state, next event
    // and
    // continuous states.
    let (mut at, mut at_event) =
        if kind == FmuInterface::CoSimulation { (2, 2) } else { (n + d.indicators + 1, 3 + n) };
    let mut out = String::new();
    for v in outputs.iter().map(|&i| &d.variables[i]) {
        for (k, element) in subscripted(v).into_iter().enumerate() {
            let from = match kind {
                FmuInterface::CoSimulation => format!("taken[{}]", at + k),
                FmuInterface::ModelExchange if v.continuous => format!("rates[{}]", at + k),
                FmuInterface::ModelExchange => format!("happened[{}]", at_event + k),
            };
            let _ = writeln!(out, "  {element} = {};", converted(v, &from, false));
        }
        at += v.size();
        at_event += if v.continuous { 0 } else { v.size() };
    }
    out
}

/// The elements of a variable as expressions in SI units, or `reversed`: converted to the units of the FMU.
fn elements(v: &FmuVariable, reversed: bool) -> Vec<String> {
    subscripted(v).into_iter().map(|e| converted(v, &e, reversed)).collect()
}

/// An expression converted from the units of the FMU to SI, or `reversed`. Other types than Real are only converted in
/// type.
fn converted(v: &FmuVariable, e: &str, reversed: bool) -> String {
    let UnitConversion { factor, offset, .. } = v.scale;
    match (v.passed, reversed) {
        (FmuDataType::Boolean, true) => format!("(if {e} then 1 else 0)"),
        (FmuDataType::Boolean, false) => format!("{e} > 0.5"),
        // Numbers are rounded to the nearest integer.
        (p, false) if !p.is_real() => format!("integer({e} + 0.5)"),
        _ if factor == 1.0 && offset == 0.0 => e.to_owned(),
        (_, true) if offset == 0.0 => format!("{e}/{factor:e}"),
        (_, true) => format!("({e} - ({offset:e}))/{factor:e}"),
        (_, false) if offset == 0.0 => format!("{factor:e}*{e}"),
        (_, false) => format!("{factor:e}*{e} + ({offset:e})"),
    }
}

/// The names of a variable's elements with their subscripts, row by row. A scalar gives one name.
/// Subscripts count from 1.
fn subscripted(v: &FmuVariable) -> Vec<String> {
    let name = name(&v.name);
    if v.dims.is_empty() {
        return vec![name];
    }
    let place = |mut k: usize| {
        // The linear position is split from the last dimension, which runs fastest.
        let mut index = vec![0; v.dims.len()];
        for (i, n) in v.dims.iter().enumerate().rev() {
            index[i] = k % n + 1;
            k /= n;
        }
        index.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    };
    (0..v.size()).map(|k| format!("{name}[{}]", place(k))).collect()
}

/// An array constructor of some expressions. An empty one needs a function, because Modelica has no empty `{}`.
/// The items are complete expressions.
fn list_of(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    if items.is_empty() { "zeros(0)".to_owned() } else { format!("{{{}}}", items.join(", ")) }
}

/// The Modelica type of a variable. All integer types are `Integer`.
fn ty(v: &FmuVariable) -> &'static str {
    match v.passed {
        FmuDataType::Boolean => "Boolean",
        p if p.is_real() => "Real",
        _ => "Integer",
    }
}

/// The dimensions of a variable in brackets. Empty for a scalar.
fn dims(v: &FmuVariable) -> String {
    let sizes: Vec<String> = v.dims.iter().map(ToString::to_string).collect();
    if sizes.is_empty() { String::new() } else { format!("[{}]", sizes.join(", ")) }
}

/// The declaration of an input or output connector. `direction` is `Input` or `Output`.
/// It has the units and the description of the variable.
fn port(v: &FmuVariable, direction: &str) -> String {
    format!("  Interfaces.{}{direction} {}{}{}{};\n", ty(v), name(&v.name), dims(v), attributes(v, false), comment(v))
}

/// The declaration of a parameter with its start value, in SI units.
/// Its limits become `min` and `max`.
fn parameter(v: &FmuVariable) -> String {
    let value = |x: &f64| match ty(v) {
        "Boolean" => (*x != 0.0).to_string(),
        "Integer" => format!("{x}"),
        _ => format!("{:e}", v.scale.factor * x + v.scale.offset),
    };
    let values: Vec<String> = v.start.iter().map(value).collect();
    let value = if v.dims.is_empty() { values.first().cloned().unwrap_or_default() } else { nested(&v.dims, &values) };
    let (name, limits) = (name(&v.name), attributes(v, true));
    format!("  parameter {} {name}{}{limits} = {value}{};\n", ty(v), dims(v), comment(v))
}

/// An array constructor in nested braces, such as `{{1, 2}, {3, 4}}`, from elements row by row.
/// Each level of braces is a dimension, the first one outermost.
fn nested(dims: &[usize], values: &[String]) -> String {
    match dims {
        [] | [_] => format!("{{{}}}", values.join(", ")),
        [_, rest @ ..] => {
            let size: usize = rest.iter().product();
            let parts: Vec<String> = values.chunks(size.max(1)).map(|part| nested(rest, part)).collect();
            format!("{{{}}}", parts.join(", "))
        }
    }
}

/// The modification of a declaration with its units, and with `limited` also with the limits of a parameter.
/// The values at connectors come from the circuit, so that the limits of inputs and outputs do not apply.
fn attributes(v: &FmuVariable, limited: bool) -> String {
    let each = if v.dims.is_empty() { "" } else { "each " };
    let mut all = Vec::new();
    if !v.scale.si.is_empty() {
        all.push(format!("{each}unit = {}", quoted(&v.scale.si)));
    }
    if !v.scale.shown.is_empty() {
        all.push(format!("{each}displayUnit = {}", quoted(&v.scale.shown)));
    }
    let number =
        |x: f64| if ty(v) == "Integer" { format!("{x}") } else { format!("{:e}", v.scale.factor * x + v.scale.offset) };
    if limited && ty(v) != "Boolean" {
        // A negative factor exchanges the smallest and the largest value.
        let mut limits = [v.limits[0], v.limits[1]];
        if v.scale.factor < 0.0 {
            limits.swap(0, 1);
        }
        for (key, limit) in ["min", "max"].into_iter().zip(limits) {
            all.extend(limit.map(|x| format!("{each}{key} = {}", number(x))));
        }
    }
    if all.is_empty() { String::new() } else { format!("({})", all.join(", ")) }
}

/// The description of a variable as a comment. Empty if it has none.
fn comment(v: &FmuVariable) -> String {
    if v.description.is_empty() { String::new() } else { format!(" {}", quoted(&v.description)) }
}

/// A variable's name as a Modelica identifier: unchanged if it is one that nothing else uses, else in single quotes.
fn name(name: &str) -> String {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let plain = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name.chars().all(letter);
    if plain && !OWN.contains(&name) && !is_keyword(name) {
        return name.to_owned();
    }
    let mut out = "'".to_owned();
    for c in name.chars() {
        match c {
            '\'' | '\\' | '"' => out.extend(['\\', c]),
            // Control characters may not stand in a name.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out + "'"
}

/// True for keywords of the language, and for names that are always known.
/// They may not be used as names of variables.
fn is_keyword(name: &str) -> bool {
    const WORDS: &str = " algorithm and annotation block break class connect connector constant constrainedby der discrete \
        each else elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow for \
        function if import impure in initial inner input loop model not operator or outer output package parameter partial \
        protected public pure record redeclare replaceable return stream then true type when while within time Real \
        Integer Boolean String ";
    WORDS.contains(&format!(" {name} "))
}

/// A text as a Modelica string literal.
/// Quotes and backslashes are escaped, and other control characters become blanks.
fn quoted(text: &str) -> String {
    let mut out = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out += "\\n",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out + "\""
}
