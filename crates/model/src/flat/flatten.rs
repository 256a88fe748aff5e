//! Flattening: from the component tree to scalar variables and equations.
//!
//! [`flatten`] is the entry of the module. It numbers the components, makes the variables with their attributes and
//! bindings, lets `EquationFlattener` walk the equation sections, writes the equations of connections (MLS 9.2), and
//! checks the balance of the components.

use super::census::BalanceCensus;
use super::equations::EquationFlattener;
use super::numbers::ComponentNumbers;
use super::{
    ElementOrigin, ExperimentAnnotation, FlatEquation, FlatModel, FlatVariable, InstanceInfo, OriginKind, ScalarType,
    StartValueConfidence, StateSelect, Variability,
};
use super::{balance, discrete, equations, overconstrained, ports, streams};
use crate::instance::{ElementState, Instance, InstanceNode, LookupContext, ScopeId};
use crate::network::{Network, component_scopes};
use bramah_expr::{ExprId, Exprs, VarId};
use bramah_syntax::ast::{self, ClassBody, Modification, ModificationArgumentKind};
use bramah_syntax::diag::{Code, Diagnostic, StageResult};
use bramah_syntax::symbol::Symbol;

/// Flattens an instance. The expression pool and the diagnostics of the instance move into the result.
///
/// The result always has a value; it may have errors among its diagnostics.
///
/// `network` must be that of the instance. Codes: E212 and E213 for values, E103 and W107 for ports, E105 for joined
/// outputs; what `EquationFlattener` and `discrete` report comes on top.
pub fn flatten(instance: &mut Instance<'_, '_>, network: &Network) -> StageResult<FlatModel> {
    let scopes = component_scopes(instance);
    let mut flat = FlatModel { class: class_name(instance, instance.root), ..FlatModel::default() };
    let numbers = ComponentNumbers::new(&scopes);
    flat.instances = scopes.iter().map(|&s| instance_info(instance, s, &numbers)).collect();
    flat.experiment = experiment(instance);
    flat.varied = instance.varied;
    // Before any expression is evaluated: `inStream` needs to know the joined streams.
    streams::prepare(instance, network);
    variables(instance, &numbers, &mut flat);
    instance.parameters().check_texts();
    EquationFlattener::new(instance, &numbers, &mut flat).walk(&scopes);
    connections(instance, network, &numbers, &mut flat);
    overconstrained::equations(instance, network, &numbers, &mut flat);
    streams::equations(instance, network, &numbers, &mut flat);
    discrete::check(instance, &flat);
    // After all evaluation: only then it is known which parameters the structure depends on.
    for (v, &i) in flat.variables.iter_mut().zip(&instance.order) {
        if v.variability == Variability::Parameter && instance.variables[i as usize].structural {
            v.variability = Variability::Constant;
        }
    }
    flat.enumerations = instance
        .enumerations
        .iter()
        .map(|e| (e.name.clone(), e.literals.iter().map(|l| l.as_str().to_string()).collect()))
        .collect();
    // Before the pool moves out of the instance, which evaluates types for this.
    let constraints = instance.builder().constraint_sizes();
    flat.exprs = std::mem::take(&mut instance.exprs);
    let mut diagnostics = std::mem::take(&mut instance.diagnostics);
    // With equations missing because of errors, the counts would mislead.
    if !diagnostics.iter().any(Diagnostic::is_error) {
        let census = BalanceCensus::take(instance, network, &flat, &scopes, &constraints);
        let signals = ports::SignalConnections::new(instance, network, &flat, &census, &scopes);
        let doubts = balance::doubts(instance, &signals, &flat, &census, &scopes);
        diagnostics.extend(ports::open_lines(&flat, &census));
        diagnostics.extend(ports::uneven(instance, &flat, &census, &scopes));
        diagnostics.extend(signals.joined_outputs());
        flat.doubts = doubts;
    }
    // Bodies of functions were built in the same pool, with variables of their own; later stages must not see these.
    if !flat.exprs.functions.is_empty() {
        flat.compact();
    }
    StageResult::new(flat, diagnostics)
}

/// The full name of the class of a scope.
/// Messages and pictures show it.
fn class_name(instance: &Instance<'_, '_>, scope: ScopeId) -> String {
    instance.library.full_name(instance.scope(scope).template.class)
}

/// The record of a component for messages. The model itself, which has no owner, is its own parent.
/// Parents have smaller numbers than their parts, so the number of the parent is known.
fn instance_info(instance: &Instance<'_, '_>, scope: ScopeId, numbers: &ComponentNumbers) -> InstanceInfo {
    let s = instance.scope(scope);
    let parent = s.owner.map_or(0, |owner| numbers.of(owner));
    InstanceInfo { name: s.name.clone(), class: class_name(instance, scope), parent, span: s.span }
}

/// Makes all variables, in declaration order.
/// The place of a variable in the list is its `VarId`.
fn variables(instance: &mut Instance<'_, '_>, numbers: &ComponentNumbers, flat: &mut FlatModel) {
    flat.variables.reserve_exact(instance.order.len());
    for k in 0..instance.order.len() {
        let i = instance.order[k];
        let v = variable(instance, i, numbers, flat);
        flat.variables.push(v);
    }
}

/// Makes the flat variable of entry `i` of `Instance::variables`, with attributes and binding.
///
/// A parameter is settable from outside if it is neither `final` nor protected. `stateSelect` is kept for Reals only.
fn variable(instance: &mut Instance<'_, '_>, i: u32, numbers: &ComponentNumbers, flat: &mut FlatModel) -> FlatVariable {
    let data = &instance.variables[i as usize];
    let origin = ElementOrigin { span: data.span, instance: numbers.of(data.scope), kind: OriginKind::Declared };
    // Only inputs and outputs of the model itself connect to the outside.
    let input = data.top && data.causality == Some(ast::CausalityPrefix::Input);
    let output = data.top && data.causality == Some(ast::CausalityPrefix::Output);
    let mut v = FlatVariable {
        input,
        output,
        flow: data.flow,
        settable: data.variability == Variability::Parameter && !data.final_ && !data.hidden,
        hidden: data.hidden,
        unwanted: data.unwanted,
        // The default of `fixed` is true for parameters and false for variables (MLS 4.8).
        // The default of `fixed` is true for parameters and false for variables.
        fixed: data.variability <= Variability::Parameter,
        description: data.description.map(Into::into),
        state_select: if data.ty == ScalarType::Real { data.state_select } else { StateSelect::Default },
        ..FlatVariable::plain(data.name.clone(), data.ty, data.variability, origin)
    };
    attributes(instance, i, &mut v);
    binding(instance, i, &mut v, flat);
    v
}

/// Whether a unit measures temperature: K, degC and others of the same dimension.
/// For such a variable it matters whether it is a difference.
fn is_temperature(unit: &str) -> bool {
    let parse = bramah_expr::units::MeasurementUnit::parse;
    matches!((parse(unit), parse("K")), (Ok(unit), Ok(kelvin)) if unit.dimension == kelvin.dimension)
}

/// Evaluates the attributes of a variable. A `start`, `min`, `max` or `nominal` that changes during the run is an
/// error.
///
/// All other attributes are ignored here. `unit` and `displayUnit` are texts, kept as written.
/// `fixed` and `unbounded` must be known now, the others may depend on parameters.
/// A value of the wrong type is reported when it is coerced to the type of the variable.
fn attributes(instance: &mut Instance<'_, '_>, i: u32, v: &mut FlatVariable) {
    for k in 0..instance.variables[i as usize].attributes.len() {
        let (name, b) = instance.variables[i as usize].attributes[k].clone();
        match name.as_str() {
            "unit" => {
                v.unit = instance.parameters().text_attribute(i, "unit").filter(|u| !u.is_empty()).map(Into::into);
                v.difference = v.unit.as_deref().is_some_and(is_temperature)
                    && instance.parameters().is_difference(i) == Some(true);
            }
            "displayUnit" => {
                v.display_unit =
                    instance.parameters().text_attribute(i, "displayUnit").filter(|u| !u.is_empty()).map(Into::into);
            }
            // Evaluated for its errors only.
            "quantity" => {
                instance.parameters().text_attribute(i, "quantity");
            }
            "fixed" => {
                if let Some(x) = instance.parameters().known_attribute(i, name, &b, ScalarType::Boolean) {
                    v.fixed = x != 0.0;
                    v.confidence.free = x == 0.0;
                }
            }
            "unbounded" => {
                instance.parameters().known_attribute(i, name, &b, ScalarType::Boolean);
            }
            "start" | "min" | "max" | "nominal" => {
                let Some(value) = instance.parameters().bound(i, &b, false) else { continue };
                let Some(value) = instance.parameters().coerce(value, v.ty, &format!("{}.{name}", v.name), b.expr.span)
                else {
                    continue;
                };
                let e = value.scalar().map(|(e, _)| e);
                if e.is_some_and(|e| instance.variability(e) > Variability::Parameter) {
                    let message = format!("`{name}` of `{}` must be known before the run", v.name);
                    instance.diagnostics.push(
                        Diagnostic::new(Code::NotConstant, message)
                            .at(b.expr.span, "this changes during it")
                            .at(v.origin.span, "declared here")
                            .help("only parameters and constants may stand here"),
                    );
                    continue;
                }
                match name.as_str() {
                    "start" => {
                        v.start = e;
                        let (depth, reach) = given(instance, i, b.view.scope, e);
                        v.confidence = StartValueConfidence { depth, reach, ..v.confidence };
                    }
                    "min" => v.min = e,
                    "max" => v.max = e,
                    _ => v.nominal = e,
                }
            }
            _ => {}
        }
    }
}

/// How far outside a start value was given, and how far from there it reaches in: `depth` and `reach` of a
/// [`StartValueConfidence`].
///
/// The place is where the value is written, or further out where one of the parameters in it gets its value.
///
/// For `start = p` with `p` bound in the model to a number, the place is the model, whatever the class of the component
/// says. The reach is the depth of the place less that of the variable: 0 where the component that declares the
/// variable gives the value itself.
fn given(instance: &Instance<'_, '_>, variable: u32, written: ScopeId, start: Option<ExprId>) -> (u32, i32) {
    let mut least = depth(instance, written);
    for parameter in start.into_iter().flat_map(|e| instance.exprs.variables(e)) {
        let mut next = Some(parameter);
        // Parameters in a circle have a message of their own, but this loop must end in any case.
        for _ in 0..LONGEST_CHAIN {
            let Some(p) = next else { break };
            let Some(b) = &instance.variable(p).binding else { break };
            let (view, expr) = (b.view, b.expr);
            least = least.min(depth(instance, view.scope));
            next = lone_parameter(instance, view, expr);
        }
    }
    let own = depth(instance, instance.variables[variable as usize].scope);
    (least, i32::try_from(least).unwrap_or(i32::MAX).saturating_sub(i32::try_from(own).unwrap_or(i32::MAX)))
}

/// The longest chain of parameters bound to each other that is followed.
const LONGEST_CHAIN: usize = 30;

/// The parameter that a binding consists of; `None` where it is any other expression, or a name with dots.
/// Only such bindings pass a value on unchanged.
fn lone_parameter(instance: &Instance<'_, '_>, view: LookupContext, expr: &ast::Expr) -> Option<VarId> {
    let ast::ExprKind::Reference(r) = &expr.kind else { return None };
    let [part] = r.parts.as_slice() else { return None };
    let scope = instance.scope(view.scope);
    let &index = scope.template.by_name.get(&part.name.name)?;
    let ElementState::Node(node) = scope.elements[index as usize] else { return None };
    let InstanceNode::Var(v) = instance.node(node) else { return None };
    Some(instance.variables[*v as usize].id)
}

/// The number of components around the elements of a scope, 0 for the model itself. `u32::MAX` for scopes outside the
/// model, such as packages.
/// It says how near to the user a modifier was written.
fn depth(instance: &Instance<'_, '_>, mut scope: ScopeId) -> u32 {
    let mut depth = 0;
    while scope != instance.root {
        let Some(owner) = instance.scope(scope).owner else { return u32::MAX };
        scope = owner;
        depth += 1;
    }
    depth
}

/// Evaluates the binding of a variable. It stays with a parameter, a constant or a top-level input; for other variables
/// it becomes an equation (MLS 4.4).
///
/// A parameter or constant must not depend on what changes during the run (E212), a constant not on parameters. A
/// top-level input keeps its binding as a default and starts there. The binding of a stream variable also goes to the
/// mixture, as what leaves.
fn binding(instance: &mut Instance<'_, '_>, i: u32, v: &mut FlatVariable, flat: &mut FlatModel) {
    let parameter = v.variability <= Variability::Parameter;
    // The binding of a stream variable of a port applies only where the component has no parts joined to the port.
    if instance.streams.outside.contains(&i) {
        return;
    }
    let Some(b) = instance.variables[i as usize].binding.clone() else {
        if parameter && v.fixed {
            missing_value(instance, i, v);
        }
        return;
    };
    let value = instance.parameters().bound(i, &b, false);
    let watched = instance.statements().take_calls();
    let Some(value) = value else { return };
    let Some(value) = instance.parameters().coerce(value, v.ty, &v.name, b.expr.span) else { return };
    let Some((e, _)) = value.scalar() else { return };
    // Calls inside the binding may assert something about their arguments.
    equations::watch(instance, flat, watched, v.origin.instance);
    if v.variability == Variability::Constant && instance.variability(e) == Variability::Parameter {
        instance.diagnostics.push(
            Diagnostic::new(
                Code::NotConstant,
                format!("the constant `{}` is given a value that parameters change", v.name),
            )
            .at(b.expr.span, "this is no constant")
            .at(v.origin.span, "declared here")
            .help("declare it as `parameter`"),
        );
        return;
    }
    if parameter && instance.variability(e) > Variability::Parameter {
        instance.diagnostics.push(
            Diagnostic::new(Code::NotConstant, format!("the parameter `{}` is given a value that changes", v.name))
                .at(b.expr.span, "this is not known before the run")
                .at(v.origin.span, "declared here")
                .help("drop `parameter`, or use parameters only"),
        );
        return;
    }
    // A binding that varies is no default that could be held: such an input is given by its own equation.
    v.input &= instance.variability(e) <= Variability::Parameter;
    if parameter || v.input {
        v.binding = Some(e);
        // An input starts at its default, and stays there unless it is driven.
        v.start = if v.input { Some(e) } else { v.start };
        return;
    }
    if instance.variables[i as usize].stream {
        instance.mixing().leaves_with(i, e);
    }
    let id = instance.variables[i as usize].id;
    let lhs = instance.exprs.var(id);
    let origin = ElementOrigin { span: b.expr.span, kind: OriginKind::Binding, ..v.origin };
    flat.equations.push(FlatEquation { lhs, rhs: e, origin });
}

/// A parameter without a binding takes its start value (MLS 8.6). Without that it is an error.
///
/// The code is E213. The help shows a modifier and the option `--set`. Free parameters are not asked for a value.
/// With a start value there is no message, since it may have been given on purpose.
fn missing_value(instance: &mut Instance<'_, '_>, i: u32, v: &mut FlatVariable) {
    if v.start.is_some() {
        v.binding = v.start;
        return;
    }
    let _ = i;
    let short = v.name.rsplit('.').next().unwrap_or(&v.name).to_string();
    let word = if v.variability == Variability::Constant { "constant" } else { "parameter" };
    instance.diagnostics.push(
        Diagnostic::new(Code::NoValue, format!("the {word} `{}` has no value", v.name))
            .at(v.origin.span, "declared without `= value`")
            .instance(v.name.clone())
            .help(format!(
                "give it one where the component is used, as in `({short} = ...)`, or with `--set {}=...`",
                v.name
            )),
    );
}

/// Appends the equations of connections: potentials equal, flows summed, open flows zero (MLS 9.2).
///
/// The order is: potentials, flows, members of buses without a connection, open flows. The origin of an equation is the
/// `connect` that brought its member, or the declaration of an open port.
fn connections(instance: &mut Instance<'_, '_>, network: &Network, numbers: &ComponentNumbers, flat: &mut FlatModel) {
    // A set of `n` potentials gives `n - 1` equations, each with the first member.
    for set in &network.potentials {
        let first = instance.variables[set.members[0].0 as usize].id;
        let lhs = instance.exprs.var(first);
        for &(i, span) in &set.members[1..] {
            let rhs = instance.exprs.var(instance.variables[i as usize].id);
            let origin = ElementOrigin { span, instance: numbers.of(set.scope), kind: OriginKind::ConnectPotential };
            flat.equations.push(FlatEquation { lhs, rhs, origin });
        }
    }
    for set in &network.flows {
        let mut sum: Option<ExprId> = None;
        // Flows of inside connectors count positive, those of outside connectors negative (MLS 9.2).
        for &(i, outside) in &set.members {
            let e = instance.exprs.var(instance.variables[i as usize].id);
            sum = Some(match (sum, outside) {
                (None, false) => e,
                (None, true) => instance.exprs.neg(e),
                (Some(s), false) => instance.exprs.add(s, e),
                (Some(s), true) => instance.exprs.sub(s, e),
            });
        }
        let origin = ElementOrigin { span: set.span, instance: numbers.of(set.scope), kind: OriginKind::ConnectFlow };
        flat.equations.push(FlatEquation { lhs: sum.unwrap_or(Exprs::ZERO), rhs: Exprs::ZERO, origin });
    }
    // Members of a bus that nothing gives a value.
    for &i in &network.unused {
        let data = &instance.variables[i as usize];
        let origin = ElementOrigin { span: data.span, instance: numbers.of(data.scope), kind: OriginKind::OpenPort };
        let lhs = instance.exprs.var(data.id);
        flat.equations.push(FlatEquation { lhs, rhs: Exprs::ZERO, origin });
    }
    // Flows of ports that nothing is connected to from outside.
    for &i in &network.open {
        let data = &instance.variables[i as usize];
        let origin = ElementOrigin { span: data.span, instance: numbers.of(data.scope), kind: OriginKind::OpenPort };
        let lhs = instance.exprs.var(data.id);
        flat.equations.push(FlatEquation { lhs, rhs: Exprs::ZERO, origin });
    }
}

/// The `experiment` annotation of the model, or else of the first class that it extends and that has one.
///
/// Times are in seconds. Arguments that are no literal numbers are ignored.
/// A class without the annotation inherits that of its base, as a whole.
fn experiment(instance: &mut Instance<'_, '_>) -> ExperimentAnnotation {
    let template = instance.scope(instance.root).template.clone();
    let mut experiment = ExperimentAnnotation::default();
    for base in &template.bases {
        if !matches!(base.ast.body, ClassBody::Long(_) | ClassBody::Short { .. }) {
            continue;
        }
        let Some(m) = base.ast.annotation.as_ref().and_then(|a| argument(a, "experiment")) else { continue };
        let number = |name: &str| argument(m, name).and_then(|m| m.value.as_ref()).and_then(ast::Expr::as_number);
        experiment.start_time = experiment.start_time.or(number("StartTime"));
        experiment.stop_time = experiment.stop_time.or(number("StopTime"));
        // Tools write 0 where a number of output rows was chosen instead.
        experiment.interval = experiment.interval.or(number("Interval").filter(|interval| *interval > 0.0));
        experiment.tolerance = experiment.tolerance.or(number("Tolerance"));
        break;
    }
    experiment
}

/// The modification of `name` among the arguments of an annotation.
/// `None` where the annotation does not mention it.
fn argument<'m>(m: &'m Modification, name: &str) -> Option<&'m Modification> {
    let wanted = Symbol::new(name);
    m.arguments.iter().find_map(|a| match &a.kind {
        ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == wanted => Some(m),
        _ => None,
    })
}
