//! Reads `modelDescription.xml` of FMI 2.0 and 3.0, the description of a unit.
//! XML text enters; variables, states, capabilities and unit conversions leave. The parent module opens units by it.
//!
//! Numbers are kept in the unit's own measurement units; [`UnitConversion`] converts them to SI.
//! Source: the sections of both standards on the model description schema.

use super::FmuError;
use bramah_expr::units::MeasurementUnit;
use roxmltree::{Document, Node, ParsingOptions};
use rustc_hash::FxHashMap;

/// A version of the FMI standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuStandard {
    /// FMI 2.0.
    Two,
    /// FMI 3.0 and its minor versions.
    Three,
}

/// An interface of FMI, by which a unit is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuInterface {
    /// The unit has its own solver and is stepped from one communication point to the next.
    CoSimulation,
    /// The unit computes derivatives, which are integrated together with the circuit.
    ModelExchange,
}

impl FmuInterface {
    /// The name in the standards.
    pub fn name(self) -> &'static str {
        match self {
            FmuInterface::CoSimulation => "Co-Simulation",
            FmuInterface::ModelExchange => "Model Exchange",
        }
    }
}

/// The capabilities of a unit for one interface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FmuCapabilities {
    /// The model identifier: the name of its library without extension.
    pub identifier: String,
    /// True if a process can hold only one instance.
    pub only_once: bool,
    /// True if the unit computes directional derivatives.
    pub derivatives: bool,
}

/// The type of a variable, which selects the function that passes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the types of the standard by their names")]
pub enum FmuDataType {
    Float64,
    Float32,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    String,
}

impl FmuDataType {
    /// The type that an XML element stands for. `None` for types that are not supported, such as clocks and binaries.
    fn of(version: FmuStandard, element: &str) -> Option<Self> {
        Some(match (version, element) {
            (FmuStandard::Two, "Real") | (FmuStandard::Three, "Float64") => FmuDataType::Float64,
            // Enumerations are 32-bit integers in FMI 2.0 and 64-bit integers in FMI 3.0.
            (FmuStandard::Two, "Integer" | "Enumeration") | (FmuStandard::Three, "Int32") => FmuDataType::Int32,
            (_, "Boolean") => FmuDataType::Boolean,
            (_, "String") => FmuDataType::String,
            (FmuStandard::Two, _) => return None,
            (_, "Float32") => FmuDataType::Float32,
            (_, "Int8") => FmuDataType::Int8,
            (_, "UInt8") => FmuDataType::UInt8,
            (_, "Int16") => FmuDataType::Int16,
            (_, "UInt16") => FmuDataType::UInt16,
            (_, "UInt32") => FmuDataType::UInt32,
            (_, "Int64" | "Enumeration") => FmuDataType::Int64,
            (_, "UInt64") => FmuDataType::UInt64,
            _ => return None,
        })
    }

    /// True for floating-point types, which alone have measurement units.
    pub fn is_real(self) -> bool {
        matches!(self, FmuDataType::Float64 | FmuDataType::Float32)
    }
}

/// The conversion from a measurement unit of the FMU to SI: `factor*x + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitConversion {
    /// The SI unit in the notation of Modelica. Empty if it is not known.
    pub si: String,
    /// The unit for display. Empty if it is the SI unit or not known.
    pub shown: String,
    /// The size of the unit in SI units.
    pub factor: f64,
    /// The SI value of the unit's zero.
    pub offset: f64,
}

impl Default for UnitConversion {
    fn default() -> Self {
        UnitConversion { si: String::new(), shown: String::new(), factor: 1.0, offset: 0.0 }
    }
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuCausality {
    /// Set before the start.
    Parameter,
    /// Set from outside at any time.
    Input,
    /// Computed for the outside.
    Output,
    /// Local, calculated, structural or independent.
    Other,
}

/// A variable of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct FmuVariable {
    /// Its name.
    pub name: String,
    /// What it means.
    pub description: String,
    /// The value reference, by which functions identify the variable.
    pub reference: u32,
    /// The type that functions pass.
    pub passed: FmuDataType,
    /// Its role.
    pub causality: FmuCausality,
    /// True if it may change between events. Only real variables can.
    pub continuous: bool,
    /// The size of each dimension. Empty for a scalar.
    pub dims: Vec<usize>,
    /// Start values in the unit's own measurement unit, row by row. Empty if the unit computes them.
    pub start: Vec<f64>,
    /// The start value of a text variable.
    pub text: String,
    /// The smallest and the largest value, and the nominal one, in the unit's own measurement unit.
    pub limits: [Option<f64>; 3],
    /// The conversion to SI.
    pub scale: UnitConversion,
    /// For a derivative, its state: first as the file refers to it, after [`resolve`] as an index of variables.
    state: Option<usize>,
    /// The dimensions as the file gives them.
    sizes: Vec<FmuDimension>,
}

/// One dimension of an array.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FmuDimension {
    /// A number.
    Given(usize),
    /// The start value of the variable with this value reference (a structural parameter).
    Of(u32),
}

impl FmuVariable {
    /// The number of its elements.
    pub fn size(&self) -> usize {
        self.dims.iter().product()
    }
}

/// The description of a unit.
#[derive(Clone, Debug)]
pub struct FmuDescription {
    /// The version of the standard.
    pub version: FmuStandard,
    /// The name of the model.
    pub name: String,
    /// The description of the model. Empty if there is none.
    pub description: String,
    /// The tool that generated the unit. Empty if it is not named.
    pub tool: String,
    /// The GUID (FMI 2.0) or instantiation token (FMI 3.0), which the library checks.
    pub token: String,
    /// The capabilities for Co-Simulation. `None` if the unit lacks this interface.
    pub co_simulation: Option<FmuCapabilities>,
    /// The capabilities for Model Exchange. `None` if the unit lacks this interface.
    pub model_exchange: Option<FmuCapabilities>,
    /// The variables in the order of the file. Those of unsupported types are left out.
    pub variables: Vec<FmuVariable>,
    /// The continuous states, each with its derivative, as indices of variables.
    pub states: Vec<(usize, usize)>,
    /// The number of event indicators.
    pub indicators: usize,
    /// The communication step that the unit suggests (s).
    pub step: Option<f64>,
}

/// The largest number of elements of all variables. A larger one is probably a mistaken size.
const MOST_VALUES: usize = 1_000_000;

impl FmuDescription {
    /// Reads the XML text.
    ///
    /// # Errors
    /// It is no valid XML or no description, has another version of FMI, or contradicts itself.
    pub fn read(text: &str) -> Result<Self, FmuError> {
        // The limit bounds memory; the parser also refuses entities, with which small files can grow without bound.
        let options = ParsingOptions { nodes_limit: 10_000_000, ..ParsingOptions::default() };
        let tree = Document::parse_with_options(text, options)
            .map_err(|why| format!("its `modelDescription.xml` is no valid XML: {why}"))?;
        let root = tree.root_element();
        if root.tag_name().name() != "fmiModelDescription" {
            return Err("its `modelDescription.xml` describes no unit".into());
        }
        let version = match root.attribute("fmiVersion") {
            Some("2.0") => FmuStandard::Two,
            Some(v) if v.starts_with("3.") => FmuStandard::Three,
            Some(other) => return Err(format!("it follows FMI {other}; bramah takes 2.0 and 3.0").into()),
            None => return Err("its `modelDescription.xml` names no version of FMI".into()),
        };
        let token = if version == FmuStandard::Two { "guid" } else { "instantiationToken" };
        let types = types(root, version);
        let mut variables = Vec::new();
        for node in child(root, "ModelVariables").into_iter().flat_map(elements) {
            variables.extend(variable(node, version, &types)?);
        }
        resolve(&mut variables, version)?;
        let (states, indicators) = structure(root, version, &variables)?;
        let co_simulation = child(root, "CoSimulation");
        let number = |node: Option<Node<'_, '_>>, name| node?.attribute(name)?.trim().parse::<f64>().ok();
        // Without a step for experiments, the unit's own step is the best guess.
        let step = number(child(root, "DefaultExperiment"), "stepSize");
        let step = step.or_else(|| number(co_simulation, "fixedInternalStepSize"));
        Ok(FmuDescription {
            version,
            name: root.attribute("modelName").unwrap_or("unit").to_owned(),
            description: root.attribute("description").unwrap_or_default().to_owned(),
            tool: root.attribute("generationTool").unwrap_or_default().to_owned(),
            token: root.attribute(token).unwrap_or_default().to_owned(),
            co_simulation: co_simulation.map(offer).transpose()?,
            model_exchange: child(root, "ModelExchange").map(offer).transpose()?,
            variables,
            states,
            indicators,
            // A step of zero or less counts as none.
            step: step.filter(|s| s.is_finite() && *s > 0.0),
        })
    }

    /// The capabilities for an interface. `None` if the unit lacks it.
    pub fn offer(&self, kind: FmuInterface) -> Option<&FmuCapabilities> {
        match kind {
            FmuInterface::CoSimulation => self.co_simulation.as_ref(),
            FmuInterface::ModelExchange => self.model_exchange.as_ref(),
        }
    }

    /// The numeric variables of a role, as indices.
    pub fn of(&self, causality: FmuCausality) -> Vec<usize> {
        let all = self.variables.iter().enumerate();
        all.filter(|(_, v)| v.causality == causality && v.passed != FmuDataType::String).map(|(i, _)| i).collect()
    }

    /// The scalar text parameters, as indices of variables.
    pub fn texts(&self) -> Vec<usize> {
        let all = self.variables.iter().enumerate();
        let is = |v: &FmuVariable| {
            v.causality == FmuCausality::Parameter && v.passed == FmuDataType::String && v.dims.is_empty()
        };
        all.filter(|(_, v)| is(v)).map(|(i, _)| i).collect()
    }
}

/// The child elements of a node.
/// Text and comments between elements are skipped.
fn elements<'a, 'b>(node: Node<'a, 'b>) -> impl Iterator<Item = Node<'a, 'b>> {
    node.children().filter(Node::is_element)
}

/// The first child element with this name.
/// `None` if there is none.
fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    elements(node).find(|c| c.tag_name().name() == name)
}

/// The value of a Boolean attribute. False if it is missing.
fn flag(node: Node<'_, '_>, name: &str) -> bool {
    matches!(node.attribute(name), Some("true" | "1"))
}

/// The capabilities from the element of an interface.
///
/// # Errors
/// The model identifier is missing, or is no plain name: it becomes part of a path.
/// Missing flags are false.
fn offer(node: Node<'_, '_>) -> Result<FmuCapabilities, FmuError> {
    let identifier = node.attribute("modelIdentifier").unwrap_or_default().to_owned();
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    if identifier.is_empty() || !identifier.chars().all(letter) {
        return Err(format!("`modelIdentifier` is `{identifier}`, which names no library").into());
    }
    Ok(FmuCapabilities {
        identifier,
        only_once: flag(node, "canBeInstantiatedOnlyOncePerProcess"),
        derivatives: flag(node, "providesDirectionalDerivative") || flag(node, "providesDirectionalDerivatives"),
    })
}

/// The elements that variables refer to by name.
struct TypeDefinitions<'a, 'b> {
    /// Type definitions by their names.
    types: FxHashMap<&'a str, Node<'a, 'b>>,
    /// Unit definitions by their names.
    units: FxHashMap<&'a str, Node<'a, 'b>>,
}

/// Collects type and unit definitions.
/// Those without a name are left out.
fn types<'a, 'b>(root: Node<'a, 'b>, version: FmuStandard) -> TypeDefinitions<'a, 'b> {
    let all = child(root, "TypeDefinitions").into_iter().flat_map(elements);
    // In FMI 2.0 the attributes are in a child element, such as `Real`.
    let types = all.filter_map(|t| {
        let inner = if version == FmuStandard::Two { elements(t).next()? } else { t };
        Some((t.attribute("name")?, inner))
    });
    let units = child(root, "UnitDefinitions").into_iter().flat_map(elements);
    TypeDefinitions { types: types.collect(), units: units.filter_map(|u| Some((u.attribute("name")?, u))).collect() }
}

/// Reads a variable. `None` if its type is not supported.
///
/// # Errors
/// The name is missing, or a number cannot be read.
/// Attributes that cannot be read as numbers are ignored, except for reference, start and sizes.
fn variable(
    node: Node<'_, '_>,
    version: FmuStandard,
    types: &TypeDefinitions<'_, '_>,
) -> Result<Option<FmuVariable>, FmuError> {
    let name = node.attribute("name").ok_or("a variable has no name")?.to_owned();
    let inner = match version {
        FmuStandard::Two => elements(node).find(|c| FmuDataType::of(version, c.tag_name().name()).is_some()),
        FmuStandard::Three => Some(node),
    };
    // FMI 2.0 has the attributes in a child element named after the type; FMI 3.0 has the type as the element itself.
    let Some(inner) = inner else { return Ok(None) };
    let Some(passed) = FmuDataType::of(version, inner.tag_name().name()) else { return Ok(None) };
    let declared = inner.attribute("declaredType").and_then(|t| types.types.get(t).copied());
    // An attribute of the variable takes precedence over that of its declared type.
    let said = |key: &str| inner.attribute(key).or_else(|| declared.and_then(|d| d.attribute(key)));
    let wrong = |what: &str, text: &str| format!("`{text}` is no {what} of the variable `{name}`");
    let number = |key: &str| said(key).and_then(|text| text.trim().parse::<f64>().ok()).filter(|x| x.is_finite());
    let reference = node.attribute("valueReference").unwrap_or_default();
    let reference = reference.trim().parse().map_err(|_| wrong("value reference", reference))?;
    let causality = match node.attribute("causality") {
        Some("parameter") => FmuCausality::Parameter,
        Some("input") => FmuCausality::Input,
        Some("output") => FmuCausality::Output,
        _ => FmuCausality::Other,
    };
    let start = inner.attribute("start").unwrap_or_default();
    let start = match passed {
        FmuDataType::String => Vec::new(),
        _ => start
            .split_whitespace()
            .map(|s| value(s).ok_or_else(|| wrong("start value", s)))
            .collect::<Result<_, _>>()?,
    };
    let text = child(inner, "Start").and_then(|s| s.attribute("value")).or_else(|| inner.attribute("start"));
    let dims = elements(inner).filter(|c| c.tag_name().name() == "Dimension");
    let sizes = dims.map(|d| match (d.attribute("start"), d.attribute("valueReference").unwrap_or_default()) {
        (Some(n), _) => n.trim().parse().map(FmuDimension::Given).map_err(|_| wrong("size", n)),
        (None, n) => n.trim().parse().map(FmuDimension::Of).map_err(|_| wrong("size", n)),
    });
    let unit = said("unit").unwrap_or_default();
    let scale = if passed.is_real() { scale(unit, said("displayUnit"), types)? } else { UnitConversion::default() };
    // Continuous is the default of real variables.
    let discrete = matches!(node.attribute("variability"), Some("discrete" | "constant" | "fixed" | "tunable"));
    Ok(Some(FmuVariable {
        description: node.attribute("description").unwrap_or_default().to_owned(),
        reference,
        passed,
        causality,
        continuous: passed.is_real() && !discrete,
        dims: Vec::new(),
        sizes: sizes.collect::<Result<_, String>>()?,
        start,
        text: if passed == FmuDataType::String { text.unwrap_or_default().to_owned() } else { String::new() },
        limits: ["min", "max", "nominal"].map(number),
        scale,
        state: inner.attribute("derivative").and_then(|d| d.trim().parse().ok()),
        name,
    }))
}

/// A number or Boolean value. `None` if it is neither.
/// Boolean values are `true` and `false`.
fn value(text: &str) -> Option<f64> {
    match text {
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ => text.parse().ok(),
    }
}

/// Resolves references between variables: the states of derivatives, and sizes given by other variables.
///
/// # Errors
/// A state or size does not exist, there are too many elements, or start values do not fit the size.
fn resolve(variables: &mut [FmuVariable], version: FmuStandard) -> Result<(), FmuError> {
    let at: FxHashMap<u32, usize> = variables.iter().enumerate().map(|(i, v)| (v.reference, i)).collect();
    let count = variables.len();
    for v in variables.iter_mut() {
        v.state = match (v.state, version) {
            // FMI 2.0 counts variables from 1; FMI 3.0 uses value references.
            (Some(index), FmuStandard::Two) => {
                Some(index.checked_sub(1).filter(|i| *i < count).ok_or_else(|| no_state(&v.name))?)
            }
            (Some(reference), FmuStandard::Three) => {
                let found = u32::try_from(reference).ok().and_then(|r| at.get(&r).copied());
                Some(found.ok_or_else(|| no_state(&v.name))?)
            }
            (None, _) => None,
        };
    }
    let size = |size: &FmuDimension| match *size {
        FmuDimension::Given(n) => Some(n),
        FmuDimension::Of(reference) => {
            let start = *variables[*at.get(&reference)?].start.first()?;
            (0.0..1e9).contains(&start).then_some(start as usize)
        }
    };
    let dims: Vec<Option<Vec<usize>>> = variables.iter().map(|v| v.sizes.iter().map(size).collect()).collect();
    for (v, dims) in variables.iter_mut().zip(dims) {
        v.dims = dims.ok_or_else(|| format!("the sizes of `{}` are not known", v.name))?;
    }
    let mut values = 0usize;
    for v in variables.iter_mut() {
        let size = v.dims.iter().try_fold(1usize, |n, d| n.checked_mul(*d));
        values = size.and_then(|n| values.checked_add(n)).unwrap_or(usize::MAX);
        if values > MOST_VALUES {
            return Err(format!("its variables hold more than {MOST_VALUES} values").into());
        }
        // One start value serves all elements of an array.
        if v.start.len() == 1 && v.size() > 1 {
            v.start = vec![v.start[0]; v.size()];
        }
        if !v.start.is_empty() && v.start.len() != v.size() {
            return Err(format!("`{}` has {} values and {} start values", v.name, v.size(), v.start.len()).into());
        }
    }
    Ok(())
}

/// The error about a derivative whose state does not exist.
/// `name` is that of the derivative.
fn no_state(name: &str) -> FmuError {
    format!("`{name}` is the derivative of a variable that is not there").into()
}

/// The continuous states with their derivatives, as indices of variables, and the number of event indicators.
///
/// # Errors
/// A derivative names no state, or there are too many indicators.
fn structure(
    root: Node<'_, '_>,
    version: FmuStandard,
    variables: &[FmuVariable],
) -> Result<(Vec<(usize, usize)>, usize), FmuError> {
    let structure = child(root, "ModelStructure");
    let at: FxHashMap<u32, usize> = variables.iter().enumerate().map(|(i, v)| (v.reference, i)).collect();
    let named = |node: Node<'_, '_>| -> Option<usize> {
        match version {
            FmuStandard::Two => node.attribute("index")?.trim().parse::<usize>().ok()?.checked_sub(1),
            FmuStandard::Three => at.get(&node.attribute("valueReference")?.trim().parse::<u32>().ok()?).copied(),
        }
    };
    let derivatives: Vec<Node<'_, '_>> = match version {
        FmuStandard::Two => structure.and_then(|s| child(s, "Derivatives")).into_iter().flat_map(elements).collect(),
        FmuStandard::Three => structure
            .into_iter()
            .flat_map(elements)
            .filter(|n| n.tag_name().name() == "ContinuousStateDerivative")
            .collect(),
    };
    let mut states = Vec::new();
    for node in derivatives {
        let found = named(node).and_then(|i| Some((variables.get(i)?.state?, i)));
        states.push(found.ok_or("a derivative of its `ModelStructure` is the derivative of nothing")?);
    }
    // FMI 2.0 gives the number; in FMI 3.0 indicators are variables, possibly arrays.
    let indicators = match version {
        FmuStandard::Two => root.attribute("numberOfEventIndicators").and_then(|n| n.trim().parse().ok()).unwrap_or(0),
        FmuStandard::Three => {
            let all = structure.into_iter().flat_map(elements).filter(|n| n.tag_name().name() == "EventIndicator");
            let sizes = all.map(|n| named(n).and_then(|i| variables.get(i)).map_or(1, FmuVariable::size));
            sizes.sum()
        }
    };
    if indicators > MOST_VALUES {
        return Err("it has too many event indicators".into());
    }
    Ok((states, indicators))
}

/// The SI base units of FMI, in the order in which they are written.
const BASE: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

/// The conversion of a measurement unit to SI: by its definition in the file, or else by its name.
/// `shown` is the display unit.
///
/// # Errors
/// The definition has no number where one is due, or a factor of 0.
fn scale(unit: &str, shown: Option<&str>, types: &TypeDefinitions<'_, '_>) -> Result<UnitConversion, FmuError> {
    if unit.is_empty() {
        return Ok(UnitConversion::default());
    }
    let known = MeasurementUnit::parse(unit).ok();
    let base = types.units.get(unit).and_then(|u| child(*u, "BaseUnit"));
    let number = |key: &str, otherwise: f64| {
        let text = base.and_then(|b| b.attribute(key));
        text.map_or(Some(otherwise), |t| t.trim().parse().ok().filter(|x: &f64| x.is_finite()))
    };
    let exponents = match base {
        Some(b) => {
            let of = |key: &str| b.attribute(key).map_or(Some(0), |n| n.trim().parse::<i16>().ok());
            BASE.map(of).into_iter().collect::<Option<Vec<i16>>>()
        }
        None => known.and_then(|u| u.exponents()).map(|e| e.to_vec()),
    };
    // The definition in the file counts, even if the name is a known unit of another size.
    let (factor, offset) = match (base, known) {
        (Some(_), _) => (number("factor", 1.0), number("offset", 0.0)),
        (None, Some(u)) => (Some(u.factor()), Some(u.to_si(0.0))),
        // A unit that is not known is passed on as a number without a unit.
        (None, None) => (Some(1.0), Some(0.0)),
    };
    let (Some(factor), Some(offset)) = (factor.filter(|f| *f != 0.0), offset) else {
        return Err(format!("the definition of the unit `{unit}` cannot be read").into());
    };
    let coherent = |u: &MeasurementUnit| {
        u.factor() == 1.0 && u.to_si(0.0) == 0.0 && u.exponents().map(|e| e.to_vec()) == exponents
    };
    // A known name of the same unit is preferred to the product of base units.
    let si = match &exponents {
        _ if known.as_ref().is_some_and(coherent) => unit.to_owned(),
        Some(exponents) => product(exponents),
        None => String::new(),
    };
    let can_show = |name: &&str| !si.is_empty() && MeasurementUnit::parse(name).is_ok();
    let shown = shown.filter(can_show).or(Some(unit).filter(can_show)).unwrap_or_default();
    let shown = if shown == si { String::new() } else { shown.to_owned() };
    Ok(UnitConversion { si, shown, factor, offset })
}

/// Names of derived units that stand for one quantity only. `J`, for example, would also fit a torque.
const NAMED: [&str; 9] = ["Pa", "N", "W", "V", "Ohm", "F", "H", "T", "Wb"];

/// A unit as a product of base units such as `kg.m2.s-1`, or by its name if it has one.
fn product(exponents: &[i16]) -> String {
    let is = |name: &&str| MeasurementUnit::parse(name).is_ok_and(|u| u.exponents().is_some_and(|e| e == *exponents));
    if let Some(name) = NAMED.into_iter().find(is) {
        return name.to_owned();
    }
    let part = |(name, n): (&str, &i16)| match n {
        0 => None,
        1 => Some(name.to_owned()),
        _ => Some(format!("{name}{n}")),
    };
    let text: Vec<String> = BASE.into_iter().zip(exponents).filter_map(part).collect();
    if text.is_empty() { "1".to_owned() } else { text.join(".") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two(inside: &str) -> String {
        format!(
            r#"<fmiModelDescription fmiVersion="2.0" modelName="M" guid="g" numberOfEventIndicators="1">
               <CoSimulation modelIdentifier="m"/>{inside}</fmiModelDescription>"#
        )
    }

    fn wrong(text: &str) -> String {
        FmuDescription::read(text).unwrap_err().to_string()
    }

    #[test]
    fn variables_have_units_types_and_states() {
        let text = two(
            r#"<UnitDefinitions><Unit name="bar"><BaseUnit kg="1" m="-1" s="-2" factor="1e5"/></Unit></UnitDefinitions>
            <TypeDefinitions><SimpleType name="P"><Real unit="bar" max="300"/></SimpleType></TypeDefinitions>
            <ModelVariables>
              <ScalarVariable name="p" valueReference="7" causality="input"><Real declaredType="P" start="2"/></ScalarVariable>
              <ScalarVariable name="x" valueReference="8"><Real/></ScalarVariable>
              <ScalarVariable name="der(x)" valueReference="9"><Real derivative="2" unit="1/s"/></ScalarVariable>
              <ScalarVariable name="on" valueReference="0" causality="parameter"><Boolean start="true"/></ScalarVariable>
            </ModelVariables><ModelStructure><Derivatives><Unknown index="3"/></Derivatives></ModelStructure>"#,
        );
        let d = FmuDescription::read(&text).unwrap();
        let p = &d.variables[0];
        assert_eq!((p.scale.si.as_str(), p.scale.factor, p.scale.shown.as_str()), ("Pa", 1e5, "bar"));
        assert_eq!((p.limits[1], p.start.as_slice(), p.reference), (Some(300.0), &[2.0][..], 7));
        assert_eq!((d.states.as_slice(), d.indicators), (&[(1, 2)][..], 1));
        assert_eq!(d.variables[3].start, [1.0]);
    }

    #[test]
    fn arrays_have_sizes() {
        let text = r#"<fmiModelDescription fmiVersion="3.0" modelName="M" instantiationToken="t">
            <ModelVariables><UInt64 name="n" valueReference="1" causality="structuralParameter" start="3"/>
            <Float64 name="u" valueReference="2" causality="input" start="1 2 3"><Dimension valueReference="1"/></Float64>
            <Float64 name="A" valueReference="3" start="5"><Dimension start="2"/><Dimension start="2"/></Float64>
            <Clock name="c" valueReference="4"/></ModelVariables></fmiModelDescription>"#;
        let d = FmuDescription::read(text).unwrap();
        assert_eq!((d.variables[1].dims.as_slice(), d.variables.len()), (&[3][..], 3));
        assert_eq!(d.variables[2].start, [5.0; 4]);
    }

    #[test]
    fn wrong_descriptions_say_why() {
        assert!(wrong("<a>").contains("no valid XML"));
        assert!(wrong("<a/>").contains("describes no unit"));
        assert!(wrong(r#"<fmiModelDescription fmiVersion="1.0"/>"#).contains("FMI 1.0"));
        assert!(
            wrong(&two(
                "<ModelVariables><ScalarVariable name='a' valueReference='x'><Real/></ScalarVariable></ModelVariables>"
            ))
            .contains("value reference")
        );
        assert!(wrong(&two("").replace("\"m\"", "\"../m\"")).contains("names no library"));
        let bomb = r#"<!DOCTYPE a [<!ENTITY x "xxxx">]><fmiModelDescription fmiVersion="2.0"/>"#;
        assert!(wrong(bomb).contains("no valid XML"));
        let huge = two("").replace("2.0", "3.0").replace(
            "</fmi",
            r#"<ModelVariables><Float64 name="A" valueReference="3"><Dimension start="99999999999"/></Float64></ModelVariables></fmi"#,
        );
        assert!(wrong(&huge).contains("more than"));
    }
}
