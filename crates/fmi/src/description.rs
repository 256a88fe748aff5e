//! Writes `modelDescription.xml` by the schemas of FMI 2.0.5 and 3.0.2.
//!
//! An [`FmiInterface`] enters, the text of the file leaves; `bramah export` calls [`fn@write`]. The two versions name
//! elements and attributes differently, and version 2 counts variables from 1 where version 3 uses value references.
//!
//! The order of the elements follows the schemas, which prescribe it.

use super::interface::{FmiCausality, FmiInterface, FmiVariable, ModelExchangeRole};
use bramah_expr::units::MeasurementUnit;
use bramah_plot::svg::escape;
use bramah_results::{Kind, number};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The model identifier: the name of the library in the folder `binaries/`, and the prefix of its functions where the
/// standard uses one.
pub const IDENTIFIER: &str = "bramah";

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0
    Two,
    /// FMI 3.0
    Three,
}

/// Writes the description.
///
/// `token` ties the description to the packed texts. No date is written, so that the same circuit gives the same bytes.
pub fn write(interface: &FmiInterface, version: FmiVersion, token: &str, description: &str) -> String {
    let three = version == FmiVersion::Three;
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let guid = if three { "instantiationToken" } else { "guid" };
    let _ = writeln!(
        out,
        "<fmiModelDescription fmiVersion=\"{}\" modelName=\"{}\" {guid}=\"{token}\" description=\"{}\" \
         generationTool=\"bramah {}\" variableNamingConvention=\"structured\"{}>",
        if three { "3.0" } else { "2.0" },
        escape(&interface.class),
        line(description),
        env!("CARGO_PKG_VERSION"),
        if three { String::new() } else { format!(" numberOfEventIndicators=\"{}\"", interface.indicators().len()) },
    );
    // Model Exchange is left out where the model needs its own integrator.
    if interface.alone.is_none() {
        let needless =
            if three { "needsCompletedIntegratorStep=\"false\"" } else { "completedIntegratorStepNotNeeded=\"true\"" };
        let _ = writeln!(out, "  <ModelExchange modelIdentifier=\"{IDENTIFIER}\" {needless}/>");
    }
    let state = if three { "canGetAndSetFMUState" } else { "canGetAndSetFMUstate" };
    let serialize = if three { "canSerializeFMUState" } else { "canSerializeFMUstate" };
    let _ = writeln!(
        out,
        "  <CoSimulation modelIdentifier=\"{IDENTIFIER}\" canHandleVariableCommunicationStepSize=\"true\" \
         {state}=\"true\" {serialize}=\"true\"/>"
    );
    units(&mut out, interface);
    types(&mut out, interface, three);
    out.push_str("  <LogCategories>\n    <Category name=\"logStatusError\" description=\"Why a call failed\"/>\n");
    out.push_str(
        "    <Category name=\"logStatusWarning\" description=\"What the model warns of\"/>\n  </LogCategories>\n",
    );
    let [start, stop, interval, tolerance] = interface.experiment.map(number::text);
    let _ = writeln!(
        out,
        "  <DefaultExperiment startTime=\"{start}\" stopTime=\"{stop}\" tolerance=\"{tolerance}\" stepSize=\"{interval}\"/>"
    );
    out.push_str("  <ModelVariables>\n");
    // The time is the first variable of both versions and has the value reference 0.
    if three {
        out.push_str(
            "    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"/>\n",
        );
    } else {
        out.push_str("    <ScalarVariable name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"><Real/></ScalarVariable>\n");
    }
    for (port, reference) in interface.ports.iter().zip(1..) {
        out.push_str(&if three { variable_3(port, reference) } else { variable_2(port, reference) });
    }
    out.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    structure(&mut out, interface, three);
    out.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    out
}

/// A text on one line, escaped for an attribute.
fn line(text: &str) -> String {
    escape(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Writes the units of all Real variables: each as powers of the base units, with its display units.
///
/// Display units that cannot be converted are left out. Nothing is written when no variable has a unit.
fn units(out: &mut String, interface: &FmiInterface) {
    // Sorted maps, so that the order does not depend on a hash.
    let mut all: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for signal in interface.ports.iter().map(|p| &p.signal).filter(|s| !s.unit.is_empty() && s.kind == Kind::Real) {
        let shown = all.entry(&signal.unit).or_default();
        if !signal.display_unit.is_empty() && signal.display_unit != signal.unit {
            shown.insert(&signal.display_unit);
        }
    }
    if all.is_empty() {
        return;
    }
    out.push_str("  <UnitDefinitions>\n");
    for (name, shown) in all {
        // A unit that cannot be parsed is still declared, because variables refer to it.
        let Ok(unit) = MeasurementUnit::parse(name) else {
            let _ = writeln!(out, "    <Unit name=\"{}\"/>", escape(name));
            continue;
        };
        let _ = writeln!(out, "    <Unit name=\"{}\">\n      <BaseUnit{}/>", escape(name), base(&unit));
        for other in shown {
            let Some((factor, offset)) = MeasurementUnit::parse(other).ok().and_then(|o| linear(&unit, &o)) else {
                continue;
            };
            let offset = if offset == 0.0 { String::new() } else { format!(" offset=\"{}\"", number::text(offset)) };
            let _ = writeln!(
                out,
                "      <DisplayUnit name=\"{}\" factor=\"{}\"{offset}/>",
                escape(other),
                number::text(factor)
            );
        }
        out.push_str("    </Unit>\n");
    }
    out.push_str("  </UnitDefinitions>\n");
}

/// The attributes of a `BaseUnit`: exponents other than 0, factor and offset. Empty for fractional exponents.
fn base(unit: &MeasurementUnit) -> String {
    let mut out = String::new();
    // The standard has whole exponents only.
    let Some(exponents) = unit.exponents() else { return out };
    for (name, exponent) in ["kg", "m", "s", "A", "K", "mol", "cd", "rad"].iter().zip(exponents) {
        if exponent != 0 {
            let _ = write!(out, " {name}=\"{exponent}\"");
        }
    }
    let (factor, offset) = (unit.factor(), unit.offset);
    if factor != 1.0 {
        let _ = write!(out, " factor=\"{}\"", number::text(factor));
    }
    if offset != 0.0 {
        let _ = write!(out, " offset=\"{}\"", number::text(offset));
    }
    out
}

/// Factor and offset of `other = factor*unit + offset`. `None`: the units are of different kinds.
fn linear(unit: &MeasurementUnit, other: &MeasurementUnit) -> Option<(f64, f64)> {
    // Two points determine the line.
    let offset = unit.convert(0.0, other)?;
    Some((unit.convert(1.0, other)? - offset, offset))
}

/// Writes the enumeration types that variables use, each once.
fn types(out: &mut String, interface: &FmiInterface, three: bool) {
    let mut seen = BTreeSet::new();
    let mut text = String::new();
    for port in &interface.ports {
        let Kind::Enumeration(literals) = &port.signal.kind else { continue };
        let name = type_name(literals);
        if !seen.insert(name.clone()) {
            continue;
        }
        let items: String =
            // Items count from 1, as literals do in Modelica.
            (1..).zip(literals).map(|(k, l)| format!("<Item name=\"{}\" value=\"{k}\"/>", escape(l))).collect();
        let _ = match three {
            true => writeln!(text, "    <EnumerationType name=\"{name}\">{items}</EnumerationType>"),
            false => writeln!(text, "    <SimpleType name=\"{name}\"><Enumeration>{items}</Enumeration></SimpleType>"),
        };
    }
    if !text.is_empty() {
        let _ = write!(out, "  <TypeDefinitions>\n{text}  </TypeDefinitions>\n");
    }
}

/// The name of an enumeration type. Enumerations with the same literals share one.
fn type_name(literals: &[String]) -> String {
    escape(&format!("enumeration({})", literals.join(", ")))
}

/// The attributes `causality`, `variability` and `initial` of a variable.
fn words(port: &FmiVariable) -> (&'static str, &'static str, Option<&'static str>) {
    // Only Real variables may change between events.
    let varies = if port.signal.kind == Kind::Real { "continuous" } else { "discrete" };
    match port.causality {
        FmiCausality::Parameter => ("parameter", "fixed", Some("exact")),
        // The standard allows `fixed` for parameters that cannot change after the initialization.
        FmiCausality::Calculated => ("calculatedParameter", "fixed", Some("calculated")),
        FmiCausality::Input => ("input", varies, None),
        FmiCausality::Output => ("output", varies, Some("calculated")),
        FmiCausality::Local => ("local", varies, Some("calculated")),
    }
}

/// The attributes that all types of variables have. `reference` is the value reference.
///
/// They are name, value reference, causality, variability and, where they exist, `initial` and the description.
fn head(port: &FmiVariable, reference: usize) -> String {
    let (causality, variability, initial) = words(port);
    let mut out = format!(
        "name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"",
        escape(&port.signal.name)
    );
    if let Some(initial) = initial {
        let _ = write!(out, " initial=\"{initial}\"");
    }
    if !port.signal.description.is_empty() {
        let _ = write!(out, " description=\"{}\"", line(&port.signal.description));
    }
    out
}

/// The attributes of a number: type, unit, limits and start value.
fn number_attributes(port: &FmiVariable) -> String {
    let signal = &port.signal;
    let mut out = String::new();
    if let Kind::Enumeration(literals) = &signal.kind {
        let _ = write!(out, " declaredType=\"{}\"", type_name(literals));
    }
    if signal.kind == Kind::Real && !signal.unit.is_empty() {
        let _ = write!(out, " unit=\"{}\"", escape(&signal.unit));
        // A display unit is named only when it was declared with the unit above.
        let known = MeasurementUnit::parse(&signal.unit).ok().zip(MeasurementUnit::parse(&signal.display_unit).ok());
        let other = !signal.display_unit.is_empty() && signal.display_unit != signal.unit;
        if other && known.is_some_and(|(u, d)| u.convert(0.0, &d).is_some()) {
            let _ = write!(out, " displayUnit=\"{}\"", escape(&signal.display_unit));
        }
    }
    let whole = signal.kind != Kind::Real;
    // Limits of integers are 32-bit numbers in the schema.
    let largest = if whole { f64::from(i32::MAX) } else { LARGEST };
    for (name, limit) in [("min", port.min), ("max", port.max)] {
        if let Some(limit) = limit.filter(|l| l.abs() < largest) {
            let _ = write!(out, " {name}=\"{}\"", text(limit, whole));
        }
    }
    if let Some(start) = port.start {
        let _ = write!(out, " start=\"{}\"", text(start, whole));
    }
    out
}

/// Limits of larger magnitude are not written.
const LARGEST: f64 = 1e300;

/// A number as text; `whole` for integers and enumerations.
fn text(value: f64, whole: bool) -> String {
    if whole { format!("{}", value as i64) } else { number::text(value) }
}

/// A variable in the form of FMI 3.
fn variable_3(port: &FmiVariable, reference: usize) -> String {
    let head = head(port, reference);
    match port.signal.kind {
        Kind::Real => format!("    <Float64 {head}{}{}/>\n", number_attributes(port), derivative(port, 1)),
        Kind::Integer => format!("    <Int32 {head}{}/>\n", number_attributes(port)),
        Kind::Enumeration(_) => format!("    <Enumeration {head}{}/>\n", number_attributes(port)),
        Kind::Boolean => format!("    <Boolean {head}{}/>\n", boolean_start(port)),
    }
}

/// A variable in the form of FMI 2.
fn variable_2(port: &FmiVariable, reference: usize) -> String {
    let head = head(port, reference);
    let inner = match port.signal.kind {
        // The time is variable 1 of FMI 2, so the first variable of the interface is number 2.
        Kind::Real => format!("<Real{}{}/>", number_attributes(port), derivative(port, 2)),
        Kind::Integer => format!("<Integer{}/>", number_attributes(port)),
        Kind::Enumeration(_) => format!("<Enumeration{}/>", number_attributes(port)),
        Kind::Boolean => format!("<Boolean{}/>", boolean_start(port)),
    };
    format!("    <ScalarVariable {head}>{inner}</ScalarVariable>\n")
}

/// The start attribute of a Boolean.
///
/// Empty for variables without start value.
fn boolean_start(port: &FmiVariable) -> String {
    port.start.map_or_else(String::new, |s| format!(" start=\"{}\"", s != 0.0))
}

/// The attribute that names the state of a derivative; empty for other variables. `first` is the number of the first
/// variable.
fn derivative(port: &FmiVariable, first: usize) -> String {
    match port.role {
        ModelExchangeRole::Rate(state) => format!(" derivative=\"{}\"", state + first),
        _ => String::new(),
    }
}

/// Writes the model structure: outputs, derivatives and initial unknowns.
///
/// Dependencies are left out, which means that each unknown depends on everything.
fn structure(out: &mut String, interface: &FmiInterface, three: bool) {
    let indexed = || interface.ports.iter().zip(1_usize..);
    let outputs: Vec<usize> = indexed().filter(|(p, _)| p.causality == FmiCausality::Output).map(|(_, i)| i).collect();
    let rates: Vec<usize> = interface.rates().iter().map(|i| i + 1).collect();
    let is_state = |i: usize| interface.ports.iter().any(|p| p.role == ModelExchangeRole::Rate(i - 1));
    // States are computed at the initialization, so they are initial unknowns too.
    let unknown = |p: &FmiVariable, i: usize| {
        matches!(p.causality, FmiCausality::Output | FmiCausality::Calculated) || rates.contains(&i) || is_state(i)
    };
    let unknowns: Vec<usize> = indexed().filter(|(p, i)| unknown(p, *i)).map(|(_, i)| i).collect();
    if three {
        outputs.iter().for_each(|i| out.push_str(&format!("    <Output valueReference=\"{i}\"/>\n")));
        let mut list = |name: &str, items: &[usize]| {
            items.iter().for_each(|i| out.push_str(&format!("    <{name} valueReference=\"{i}\"/>\n")));
        };
        let indicators: Vec<usize> = interface.indicators().iter().map(|i| i + 1).collect();
        list("ContinuousStateDerivative", &rates);
        list("InitialUnknown", &unknowns);
        list("EventIndicator", &indicators);
        return;
    }
    // FMI 2 counts variables from 1 and the time comes first, so all indices are larger by one.
    let list = |name: &str, items: &[usize]| match items {
        [] => String::new(),
        items => {
            let items: String = items.iter().map(|i| format!("<Unknown index=\"{}\"/>", i + 1)).collect();
            format!("    <{name}>{items}</{name}>\n")
        }
    };
    out.push_str(&list("Outputs", &outputs));
    out.push_str(&list("Derivatives", &rates));
    out.push_str(&list("InitialUnknowns", &unknowns));
}
