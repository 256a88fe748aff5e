//! Diagnostics of a run: which variable of which component, which equation, and what the user can do.
//!
//! The driver, `initialize` and `point` pass what they know of a failure; a [`Diagnostic`] leaves. It names variables
//! as the user wrote them, marks an equation or a declaration, and adds a help text. Codes E3xx to E5xx and W5xx are
//! explained in docs/errors. Nothing here influences the run.

use super::blocks::BlockFailure;
use super::continuity::VariableJump;
use super::newton::{NewtonFailure, NewtonFailureReason};
use crate::lower::{ExecutableSystem, NonFiniteTrap};
use bramah_expr::{ExprId, ExprNode, VarId};
use bramah_model::flat::{ElementOrigin, FlatEquation, MessagePart, MessageTemplate, ScalarType};
use bramah_model::structure::{AlgebraicLoop, BltBlock, Dae, Unknown, places};
use bramah_syntax::diag::{Code, Diagnostic};

/// Rows of a table in a message at most.
const ROWS: usize = 8;

/// The name of an unknown as the user knows it: the full name of the variable, or `der(name)`.
pub fn name(dae: &Dae, unknown: Unknown) -> String {
    match unknown {
        Unknown::Var(v) => dae.variables[v.index()].name.clone(),
        Unknown::Der(v) => format!("der({})", dae.variables[v.index()].name),
    }
}

/// Full name and class of the component of an origin.
///
/// `None` for the model itself, which has no name.
fn component(dae: &Dae, origin: ElementOrigin) -> Option<(&str, &str)> {
    let instance = dae.instances.get(origin.instance as usize)?;
    (!instance.name.is_empty()).then_some((instance.name.as_str(), instance.class.as_str()))
}

/// A diagnostic at a place of the model, with the name and class of its component.
///
/// `label` is the text under the marked place.
pub fn at_origin(dae: &Dae, code: Code, text: impl Into<String>, origin: ElementOrigin, label: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(code, text).at(origin.span, label);
    match component(dae, origin) {
        Some((instance, class)) => diagnostic.instance(instance).class(class),
        None => diagnostic,
    }
}

/// The text of a message of the model (`assert`, `terminate`).
///
/// Values in it are evaluated from the slots and printed as `String(..)` prints them.
pub fn message_text(system: &ExecutableSystem, message: &MessageTemplate, values: &[f64]) -> String {
    let mut text = String::new();
    for part in &message.parts {
        match part {
            MessagePart::Text(words) => text.push_str(words),
            MessagePart::Value(e, ty) => text.push_str(&value_text(&system.dae, system.eval(*e, values), *ty)),
        }
    }
    text
}

/// A value as text, by its type. Enumerations are stored as the index of the literal, counted from 1.
fn value_text(dae: &Dae, value: f64, ty: ScalarType) -> String {
    match ty {
        ScalarType::Real => number(value),
        ScalarType::Integer => format!("{value:.0}"),
        ScalarType::Boolean => (value != 0.0).to_string(),
        ScalarType::Enumeration(e) => {
            let literals = dae.enumerations.get(e as usize).map(|e| &e.1);
            // a value of 0 wraps around and finds no literal
            let index = (value as usize).wrapping_sub(1);
            literals.and_then(|l| l.get(index)).cloned().unwrap_or_else(|| number(value))
        }
    }
}

/// A number with six significant digits, as `%g` prints it.
///
/// All numbers in messages of this crate are printed so.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    // rounding to six digits first: 999999.9 becomes 1e6 and so gets the exponent form
    let rounded = format!("{value:.5e}");
    let (mantissa, exponent) = rounded.split_once('e').expect("written with an exponent");
    let exponent: i32 = exponent.parse().expect("a whole number");
    let trim = |s: &str| {
        if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_string() } else { s.to_string() }
    };
    if (-5..6).contains(&exponent) {
        trim(&format!("{value:.*}", usize::try_from(5 - exponent).unwrap_or(0)))
    } else {
        format!("{}e{exponent}", trim(mantissa))
    }
}

/// An aligned table of three columns below a heading: text to the left, numbers to the right.
fn table(heading: [&str; 3], rows: impl Iterator<Item = [String; 3]>) -> String {
    let rows: Vec<[String; 3]> = std::iter::once(heading.map(str::to_string)).chain(rows).collect();
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths = [width(0), width(1), width(2)];
    let line = |r: &[String; 3]| {
        format!("{:<a$}  {:>b$}  {:>c$}", r[0], r[1], r[2], a = widths[0], b = widths[1], c = widths[2])
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The first operation of the continuous equations that is not finite, and its equation.
///
/// The equation is an index into `Dae::equations`. The equations are searched in the order of their evaluation, because
/// later values are not finite as a consequence. `None` when all values are finite.
pub fn find_trap(system: &ExecutableSystem, values: &[f64]) -> Option<(NonFiniteTrap, u32)> {
    let found = |e: ExprId, equation: u32| system.trap(e, values).map(|trap| (trap, equation));
    for block in &system.dae.continuous {
        let trap = match block {
            BltBlock::Assign(a) => found(a.value, a.equation),
            BltBlock::Loop(l) => {
                let inner = l.inner.iter().map(|a| (a.value, a.equation));
                inner.chain(l.residuals.iter().copied()).find_map(|(e, equation)| found(e, equation))
            }
            // mixed loops occur in the event and initial systems only
            BltBlock::Mixed(_) => None,
        };
        if trap.is_some() {
            return trap;
        }
    }
    None
}

/// Messages of external functions (tables, C code) about calls that gave no number, without repetitions.
pub fn troubles(system: &ExecutableSystem) -> Vec<String> {
    let mut troubles: Vec<String> = system.dae.exprs.functions.iter().filter_map(|f| f.external()?.failure()).collect();
    troubles.dedup();
    troubles
}

/// E504: a value is not finite.
///
/// `trap` holds the operation and its equation. With `None` the message can only name the time. A message of an
/// external function replaces the description of the operation, because it says more.
pub fn non_finite(system: &ExecutableSystem, t: f64, trap: Option<(NonFiniteTrap, u32)>) -> Diagnostic {
    let Some((trap, equation)) = trap else {
        return Diagnostic::new(Code::NonFinite, format!("a value is not finite at time {} s", number(t)));
    };
    let NonFiniteTrap { operation, written, value, trouble } = trap;
    let text = match &trouble {
        Some(trouble) => format!("{trouble} (at time {} s)", number(t)),
        None => format!("`{written}` is not finite at time {} s: {operation} = {value}", number(t)),
    };
    let origin = system.dae.equations.get(equation as usize).map(|e| e.origin);
    let diagnostic = match origin {
        Some(origin) => at_origin(&system.dae, Code::NonFinite, text, origin, "in this equation"),
        None => Diagnostic::new(Code::NonFinite, text),
    };
    if trouble.is_some() {
        return diagnostic.note(format!("so `{written}` has no value"));
    }
    diagnostic
        .help("limit the argument (`max`, `noEvent(if ...)`), or check the start values and parameters it depends on")
}

/// E504: a derivative in the Jacobian is not finite.
///
/// `row` is the equation and `column` the unknown. A typical cause is the square root at 0.
pub fn infinite_derivative(system: &ExecutableSystem, t: f64, row: usize, column: usize) -> Diagnostic {
    let v = name(&system.dae, Unknown::Var(system.columns[column].variable));
    let text = match troubles(system).pop() {
        Some(trouble) => format!("{trouble} (at time {} s)", number(t)),
        None => format!("how fast an equation changes with `{v}` is not finite at time {} s", number(t)),
    };
    equation_diagnostic(&system.dae, Code::NonFinite, text, system.rows[row].equation).help(
        "look for the root of 0, a power of 0 with an exponent below 1, or a parameter that is 0 where it divides",
    )
}

/// E509: a variable that is differentiated jumps at an event.
///
/// `t` is the time in seconds. The help names the ends of a line of the library where that can be the cause.
pub fn jump(system: &ExecutableSystem, t: f64, jump: &VariableJump) -> Diagnostic {
    let variable = &system.dae.variables[jump.variable.index()];
    let unit = variable.unit.as_deref().filter(|u| *u != "1").map_or_else(String::new, |u| format!(" {u}"));
    let (from, to) = (number(jump.before), number(jump.after));
    let text = format!(
        "`{}` jumps from {from} to {to}{unit} at time {} s, and its derivative is needed",
        variable.name,
        number(t)
    );
    let line = component(&system.dae, variable.origin).filter(|found| chooses_ends(&system.dae, found.0));
    let at_line = line.map_or(String::new(), |(line, _)| {
        format!("; with `volume_a = false` or `volume_b = false`, no volume lies at that end of `{line}`")
    });
    at_origin(&system.dae, Code::ImpulseLost, text, variable.origin, "this must be continuous")
        .note("an equation that is differentiated ties it to a mass, a volume or the like; the jump takes an impulse that no equation holds, and that would be missing in all balances")
        .help(format!("smooth the command that jumps (`Signal.SecondOrder`, a ramp), let a source follow it by a filter of its own (`exact = false`), or put a spring, a resistance or another storage between{at_line}"))
}

/// A diagnostic for a block of the event or initial system that failed.
///
/// `code` says which of both systems it was; `when` is a part of the text, as in `at the start`. A value that is not
/// finite gets E504 instead of `code`.
pub fn block_failure(
    system: &ExecutableSystem,
    code: Code,
    failure: &BlockFailure,
    values: &[f64],
    when: &str,
) -> Diagnostic {
    match failure {
        BlockFailure::Loop(failure) => loop_failure(system, code, failure, values, when),
        BlockFailure::NonFinite(target) => {
            let trap = system.trap(target.value, values).map(|trap| (trap, target.equation));
            let t = values[crate::lower::ValueLayout::TIME];
            match trap {
                Some(trap) => non_finite(system, t, Some(trap)),
                None => {
                    let text = format!("`{}` is not finite {when}", name(&system.dae, target.unknown));
                    equation_diagnostic(&system.dae, Code::NonFinite, text, target.equation)
                }
            }
        }
        BlockFailure::Mixed(variables, None) => changing(system, code, variables, when),
        BlockFailure::Mixed(variables, Some(unknown)) => shared(system, code, variables, *unknown, when),
    }
}

/// A diagnostic at an equation (index into `Dae::equations`), or without a place where the index is invalid.
fn equation_diagnostic(dae: &Dae, code: Code, text: String, equation: u32) -> Diagnostic {
    match dae.equations.get(equation as usize) {
        Some(e) => at_origin(dae, code, text, e.origin, "this equation"),
        None => Diagnostic::new(code, text),
    }
}

/// A diagnostic for an algebraic loop without a solution.
///
/// Special causes come first: a missing pressure reference, an operation that is not finite, and a state in one branch
/// of an `if` only. Otherwise the message shows the unknowns with their guesses and the equation with the largest
/// residual.
fn loop_failure(
    system: &ExecutableSystem,
    code: Code,
    failure: &NewtonFailure,
    values: &[f64],
    when: &str,
) -> Diagnostic {
    let equation = failure.residuals.first().map(|r| r.0).or_else(|| failure.non_finite.first().copied());
    // a missing pressure reference has its own message, which says more than the residuals
    if let Some(reported) = equation.and_then(|e| no_pressure_level(&system.dae, loop_of(&system.dae, e)?)) {
        return reported;
    }
    if let (NewtonFailureReason::NonFinite, Some(&equation)) = (&failure.reason, failure.non_finite.first())
        && let Some(trap) = trap_in_loop(system, equation, values)
    {
        return non_finite(system, values[crate::lower::ValueLayout::TIME], Some(trap));
    }
    let dae = &system.dae;
    // residuals are sorted, the largest first
    let worst = failure.residuals.first().map_or(0, |r| r.0);
    let names = failure.unknowns.iter().take(3).map(|u| format!("`{}`", name(dae, u.0)));
    let names = names.collect::<Vec<_>>().join(", ");
    let more = if failure.unknowns.len() > 3 { ", ..." } else { "" };
    let text = match &failure.reason {
        NewtonFailureReason::Singular(u) => {
            format!("the equations for {names}{more} do not determine `{}` {when}", name(dae, *u))
        }
        NewtonFailureReason::NonFinite => format!("the equations for {names}{more} have no finite value {when}"),
        NewtonFailureReason::NoConvergence => format!("no solution found for {names}{more} {when}"),
    };
    let rows = failure.unknowns.iter().take(ROWS).map(|&(u, from, to)| [name(dae, u), number(from), number(to)]);
    let residual = failure.residuals.first().map_or(0.0, |r| r.1);
    if let (NewtonFailureReason::Singular(_), Some(v)) =
        (&failure.reason, dae.equations.get(worst as usize).and_then(|e| one_sided(dae, e)))
    {
        let v = &dae.variables[v.index()].name;
        return equation_diagnostic(dae, code, text, worst)
            .note(format!(
                "`{v}` is a state in one branch of an `if` only, and a circuit has the same states all the time"
            ))
            .help(format!(
                "write an equation for `der({v})` in every branch, and set `{v}` by `reinit` where it jumps"
            ));
    }
    equation_diagnostic(dae, code, text, worst)
        .note(table(["unknown", "first guess", "now"], rows))
        .note(format!(
            "after {} iterations the marked equation is furthest from holding: {} (in nominal values)",
            failure.iterations,
            number(residual)
        ))
        .help("give `start` values near the solution and `nominal` values of the right size to the unknowns above")
}

/// A variable whose derivative stands in only one branch of an `if` of an equation.
///
/// The number of states would change with the condition, which this solver does not support. `None`: there is none.
fn one_sided(dae: &Dae, equation: &FlatEquation) -> Option<VarId> {
    let nodes = dae.exprs.reachable(&[equation.lhs, equation.rhs], |_| true);
    nodes.into_iter().find_map(|e| {
        let ExprNode::If(_, a, b) = dae.exprs.node(e) else { return None };
        let (a, b) = (dae.exprs.derivatives(a), dae.exprs.derivatives(b));
        a.iter().find(|v| !b.contains(v)).or_else(|| b.iter().find(|v| !a.contains(v))).copied()
    })
}

/// The operation behind a residual that is not finite, with its equation.
///
/// Inner variables of the loop are searched first, because the residual reads them.
fn trap_in_loop(system: &ExecutableSystem, equation: u32, values: &[f64]) -> Option<(NonFiniteTrap, u32)> {
    let dae = &system.dae;
    let inner = loop_of(dae, equation).into_iter().flat_map(|l| &l.inner);
    let behind = inner.clone().find_map(|a| Some((system.trap(a.value, values)?, a.equation)));
    behind.or_else(|| {
        let e = dae.equations.get(equation as usize)?;
        let trap = system.trap(e.lhs, values).or_else(|| system.trap(e.rhs, values))?;
        Some((trap, equation))
    })
}

/// The loop of the initial or event system of which an equation is a residual; `None` when it is in none.
fn loop_of(dae: &Dae, equation: u32) -> Option<&AlgebraicLoop> {
    let blocks = dae.initial.iter().chain(&dae.event).flat_map(|block| match block {
        BltBlock::Mixed(mixed) => mixed.continuous.as_slice(),
        other => std::slice::from_ref(other),
    });
    let mut loops = blocks.filter_map(|block| match block {
        BltBlock::Loop(l) if l.residuals.iter().any(|r| r.1 == equation) => Some(l),
        _ => None,
    });
    loops.next()
}

/// E302: a loop solves for pressures of ports, and no pressure from outside the loop enters it.
///
/// The dependence of densities on these pressures makes the equations regular, but fixes no level. Example: two flow
/// sources with an orifice between them need a tank. `None` when the loop has no pressures, or when one enters.
fn no_pressure_level(dae: &Dae, l: &AlgebraicLoop) -> Option<Diagnostic> {
    let variable = |v: VarId| &dae.variables[v.index()];
    let is_connector = |v: VarId| places::is_connector(&dae.variables, variable(v).origin.instance);
    // the pressure of a port may be an alias of the unknown that is solved for
    let names =
        |v: VarId| std::iter::once(v).chain(dae.aliases.iter().filter(move |a| a.target == v).map(|a| a.variable));
    let ports = |v: VarId| names(v).filter(|&v| !variable(v).flow && is_connector(v)).collect::<Vec<VarId>>();
    let is_pressure = |v: &VarId| matches!(variable(*v).unit.as_deref(), Some("Pa" | "bar"));
    let unknowns = l.tearing.iter().copied().chain(l.inner.iter().map(|a| a.unknown));
    let solved: Vec<VarId> = unknowns.filter_map(|u| if let Unknown::Var(v) = u { Some(v) } else { None }).collect();
    let levels: Vec<VarId> = solved.iter().copied().filter(is_pressure).flat_map(ports).collect();
    let first = *levels.first()?;
    let roots: Vec<ExprId> = l.inner.iter().map(|a| a.value).chain(l.residuals.iter().map(|r| r.0)).collect();
    // what the loop reads but does not compute: one such pressure of a port is a reference
    let mut read = dae.exprs.dependencies(&roots).vars.into_iter().filter(|v| !solved.contains(v));
    if read.any(|v| is_pressure(&v) && !ports(v).is_empty()) {
        return None;
    }
    let mut owners: Vec<&str> = Vec::new();
    for &v in &levels {
        let connector = dae.instances[variable(v).origin.instance as usize].parent;
        let owner = dae.instances[connector as usize].name.as_str();
        if !owner.is_empty() && !owners.contains(&owner) {
            owners.push(owner);
        }
    }
    let text = format!("nothing fixes the pressure level of {{{}}}", owners.join(", "));
    let place = places::place_of(&dae.variables, &dae.instances, first);
    let line = owners.iter().find(|owner| chooses_ends(dae, owner));
    let at_line = line.map_or(String::new(), |l| format!("; at an end of `{l}`, `volume_a` or `volume_b` is one"));
    let label = format!("`{}` and the others hang on each other alone", variable(first).name);
    Some(
        Diagnostic::new(Code::NoReference, text)
            .at(place, label)
            .note("no pressure from elsewhere enters their equations, and what the density changes with pressure does not fix it")
            .help(format!("connect a tank, a volume or a fixed pressure to one of these nodes{at_line}")),
    )
}

/// Whether a component is a line that may have a volume at each end, recognized by its parameter `volume_a`.
fn chooses_ends(dae: &Dae, component: &str) -> bool {
    dae.variables.iter().any(|v| v.name == format!("{component}.volume_a"))
}

/// The components of these variables, each once, in the order of the variables.
fn switching<'a>(dae: &'a Dae, variables: &[VarId]) -> Vec<&'a str> {
    let mut components: Vec<&str> = Vec::new();
    for v in variables {
        if let Some((instance, _)) = component(dae, dae.variables[v.index()].origin)
            && !components.contains(&instance)
        {
            components.push(instance);
        }
    }
    components
}

/// The warning that parts hold a load together while the equations do not determine the share of each.
///
/// `variables` are the discrete variables of these parts. `unknown` is the quantity that keeps its value.
pub fn shared_load(system: &ExecutableSystem, variables: &[VarId], unknown: Unknown, t: f64) -> Diagnostic {
    let dae = &system.dae;
    let names: Vec<String> = switching(dae, variables).iter().take(ROWS).map(|c| format!("`{c}`")).collect();
    let text = format!("{} hold one load together, and nothing says how they share it", names.join(", "));
    let made = match variables.first() {
        Some(v) => at_origin(dae, Code::SharedLoad, text, dae.variables[v.index()].origin, "switches here"),
        None => Diagnostic::new(Code::SharedLoad, text),
    };
    made.note(format!(
        "since time {} s; `{}` stays as it was, the others carry the rest. Motion and the sum of the loads do not depend on it",
        number(t),
        name(dae, unknown)
    ))
    .help("put what is elastic in reality between the parts where the share of each of them matters")
}

/// W511: a loop continues at another root.
///
/// `column` is the unknown that moved most, `from` and `to` are its values before and after, in its unit.
pub fn root_jumped(system: &ExecutableSystem, t: f64, column: usize, from: f64, to: f64) -> Diagnostic {
    let variable = &system.dae.variables[system.columns[column].variable.index()];
    let unit = variable.unit.as_deref().filter(|u| *u != "1").map_or_else(String::new, |u| format!(" {u}"));
    let text =
        format!("`{}` jumps from {} to {}{unit} at time {} s", variable.name, number(from), number(to), number(t));
    at_origin(&system.dae, Code::RootJumped, text, variable.origin, "this variable")
        .note("the equations that are solved together for it have more than one solution; that at hand has ended there, and the run goes on from another one. Further jumps are not reported")
        .help("where the jump is not meant, add what moves between the solutions: a mass, a capacitor, a volume, a lag")
}

/// The error that something is undetermined with certain discrete values.
///
/// Example: the shares of two dry frictions that hold one shaft. With a single component the cause is a missing mass.
fn shared(system: &ExecutableSystem, code: Code, variables: &[VarId], unknown: Unknown, when: &str) -> Diagnostic {
    let dae = &system.dae;
    let components = switching(dae, variables);
    let names: Vec<String> = components.iter().take(ROWS).map(|c| format!("`{c}`")).collect();
    let text = format!("`{}` is not determined {when} while {} hold", name(dae, unknown), names.join(", "));
    let diagnostic = match variables.first() {
        Some(v) => at_origin(dae, code, text, dae.variables[v.index()].origin, "switches here"),
        None => Diagnostic::new(code, text),
    };
    if components.len() == 1 {
        return diagnostic
            .note("what slides there has no mass, so that nothing says how fast a force beyond the holding one moves it")
            .help("put a mass or an inertia where the friction acts, or make it smooth (`SmoothBearingFriction`, `SmoothSupportFriction`)");
    }
    diagnostic
        .note("parts that hold one rigid body share its load in no unique way")
        .help("leave one dry friction to each rigid body, make the others smooth (`SmoothBearingFriction`, `SmoothSupportFriction`), or put what is elastic in reality between them")
}

/// The error that discrete values change without end, or contradict each other.
pub fn changing(system: &ExecutableSystem, code: Code, variables: &[VarId], when: &str) -> Diagnostic {
    let dae = &system.dae;
    let names = variables.iter().take(ROWS).map(|v| format!("`{}`", dae.variables[v.index()].name));
    let names = names.collect::<Vec<_>>().join(", ");
    let text = format!("no consistent values of {names} {when}");
    let diagnostic = match variables.first() {
        Some(v) => at_origin(dae, code, text, dae.variables[v.index()].origin, "changes without end"),
        None => Diagnostic::new(code, text),
    };
    diagnostic
        .note("each change of one of them makes another one change back")
        .help("give the model a state between: hysteresis, `pre(..)`, or a small inertia or volume")
}

/// E501: the integrator gave up.
///
/// `h` is the last step in seconds, `why` the cause in words. `errors` are the weighted local errors of the unknowns
/// and `y` their values, both by column. The unknown with the largest error is named as the limiting one.
pub fn step_collapse(system: &ExecutableSystem, t: f64, h: f64, why: &str, errors: &[f64], y: &[f64]) -> Diagnostic {
    let dae = &system.dae;
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&a, &b| errors[b].abs().total_cmp(&errors[a].abs()));
    let text = |v: Option<&usize>| match v {
        Some(&i) => {
            let v = name(dae, Unknown::Var(system.columns[i].variable));
            format!("the step size collapsed at time {} s ({why}); `{v}` limits it", number(t))
        }
        None => format!("the step size collapsed at time {} s ({why})", number(t)),
    };
    let first = order.first();
    let rows = order
        .iter()
        .take(ROWS)
        .map(|&i| [name(dae, Unknown::Var(system.columns[i].variable)), number(y[i]), number(errors[i].abs())]);
    let mut diagnostic = match first.and_then(|&i| system.rows.get(i)) {
        Some(row) => equation_diagnostic(dae, Code::StepTooSmall, text(first), row.equation),
        None => Diagnostic::new(Code::StepTooSmall, text(first)),
    };
    if let Some(&i) = first {
        let origin = dae.variables[system.columns[i].variable.index()].origin;
        if let Some((instance, class)) = component(dae, origin) {
            diagnostic = diagnostic.instance(instance).class(class);
        }
    }
    diagnostic
        .note(format!("the last step was {} s", number(h)))
        .note(table(["variable", "value", "error / tolerance"], rows))
        .help("look for a jump or an infinite slope in the equations of this variable; a smaller tolerance or a `nominal` of the right size may help")
}

/// Adds to a collapse that an equation determines nothing at these values, which explains the collapse better.
///
/// Labels and help of the collapse are replaced. `equation` is an index into `Dae::equations`.
pub fn idle_equation(system: &ExecutableSystem, collapse: Diagnostic, equation: u32) -> Diagnostic {
    let Some(origin) = system.dae.equations.get(equation as usize).map(|e| e.origin) else { return collapse };
    let component = component(&system.dae, origin).map(|(name, class)| format!(" (`{name}`, a `{class}`)"));
    let mut collapse = collapse;
    collapse.labels.clear();
    collapse.help.clear();
    collapse
        .at(origin.span, "with the values there, this equation determines no unknown")
        .note(format!(
            "there the marked equation{} holds only quantities that have memory, so that nothing says how they move on",
            component.unwrap_or_default()
        ))
        .help("where an element lets go (play, a switch, a closed valve) something else must tell what happens to what was joined: an inertia, a volume, or a small damping or leakage of the element itself")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_like_percent_g() {
        let cases = [
            (0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (1e5 / 3.0, "33333.3"),
            (1.23456789e-7, "1.23457e-7"),
            (1e6, "1e6"),
            (0.1, "0.1"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn tables_are_aligned() {
        let rows = [["tank.level".to_string(), "1".to_string(), "20".to_string()]];
        insta::assert_snapshot!(table(["unknown", "guess", "now"], rows.into_iter()), @r"
        unknown     guess  now
        tank.level      1   20
        ");
    }
}
