//! The unit check: every flat equation, binding, start value and assignment.

mod infer;
mod measure;

use crate::flat::FlatModel;
use bramah_expr::units::{Unit, UnitError};
use bramah_expr::{Binary, ExprId, Node, VarId};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use infer::{Relation, Side, Units};
use measure::{Difference, Measure, Quantity};
use rustc_hash::FxHashSet;

/// So many terms are listed in a message.
const MOST_TERMS: usize = 8;

/// Warnings where units do not fit, in the order of the model's equations: W232 for units that cannot be read, W230 for
/// sides of different dimension, W231 for sides of one dimension in different units. A place in the text is reported once,
/// however many instances its class has. What is not known is not reported.
pub fn check(model: &FlatModel) -> Vec<Diagnostic> {
    let relations = infer::relations(model);
    let (mut units, unreadable) = Units::declared(model, &relations);
    let mut found = unreadable_units(model, &unreadable);
    found.extend(display_units(model));
    units.infer(&relations);
    let mut seen = FxHashSet::default();
    let mut mismatches = Vec::new();
    for (number, relation) in relations.iter().enumerate() {
        mismatches.clear();
        units.evaluate(number, |units, e| mismatches.extend(inner_mismatch(units, e)));
        mismatches.extend(outer_mismatch(&units, relation));
        for mismatch in &mismatches {
            // A part shared by several relations is reported with the first of them.
            let fresh = mismatch.part.is_none_or(|part| seen.insert((None, Some(part))));
            if fresh && seen.insert((Some(relation.span), None)) {
                found.push(report(&units, &relations, relation, mismatch));
            }
        }
    }
    found
}

/// Two quantities that should have the same unit.
struct Mismatch {
    difference: Difference,
    /// The node inside the relation at which they meet; `None` for the relation itself.
    part: Option<ExprId>,
    left: Quantity,
    right: Quantity,
}

fn mismatch(part: Option<ExprId>, left: Measure, right: Measure) -> Option<Mismatch> {
    let (left, right) = (left.known()?, right.known()?);
    let difference = left.difference(right)?;
    Some(Mismatch { difference, part, left, right })
}

fn outer_mismatch(units: &Units, relation: &Relation) -> Option<Mismatch> {
    mismatch(None, units.side(relation.lhs), units.of(relation.rhs))
}

fn inner_mismatch(units: &Units, e: ExprId) -> Option<Mismatch> {
    let number = Measure::Known(Quantity::NUMBER);
    let (left, right) = match units.model.exprs.node(e) {
        Node::Rel(_, a, b) | Node::EventRel(_, a, b) => (units.of(a), units.of(b)),
        Node::Binary(Binary::Sub | Binary::Add, a, b) => {
            // A temperature and a difference of temperatures may be added.
            let free = |e| units.of(e).known().map_or(units.of(e), |q| Measure::Known(q.shifted()));
            (free(a), free(b))
        }
        Node::Binary(Binary::Min | Binary::Max | Binary::Atan2, a, b) => (units.of(a), units.of(b)),
        Node::If(_, a, b) | Node::Homotopy(a, b) => (units.of(a), units.of(b)),
        Node::Unary(op, a) if infer::takes_numbers(op) => (units.of(a), number),
        Node::Binary(Binary::Pow, _, b) => (units.of(b), number),
        _ => return None,
    };
    mismatch(Some(e), left, right)
}

fn report(units: &Units, relations: &[Relation], relation: &Relation, mismatch: &Mismatch) -> Diagnostic {
    let model = units.model;
    let code = match mismatch.difference {
        Difference::Dimension => Code::UnitMismatch,
        Difference::Factor => Code::UnitFactor,
    };
    let places = meeting_places(units, relation, mismatch);
    let [left, right] = [(places.0, mismatch.left), (places.1, mismatch.right)]
        .map(|(place, quantity)| place.map_or_else(|| quantity.to_string(), |side| named(units, side, quantity)));
    let (message, label) = words(model, relation, mismatch, &left, &right);
    let instance = &model.instances[relation.instance as usize];
    let mut diagnostic = Diagnostic::new(code, message).at(relation.span, label).class(&instance.class);
    if !instance.name.is_empty() {
        diagnostic = diagnostic.instance(&instance.name);
    }
    for (v, span, line) in terms(units, relations, mismatch.part.map_or(Side::Expr(relation.rhs), Side::Expr), relation)
    {
        diagnostic = diagnostic.note(line);
        if let Some(span) = span.filter(|&span| span != relation.span) {
            let text = format!("the unit of `{}` follows from this", model.variables[v.index()].name);
            diagnostic = diagnostic.at(span, text);
        }
    }
    match mismatch.difference {
        Difference::Factor => diagnostic.help(conversion(mismatch)),
        Difference::Dimension => diagnostic,
    }
}

/// What is compared, when it is an expression.
fn meeting_places(units: &Units, relation: &Relation, mismatch: &Mismatch) -> (Option<Side>, Option<Side>) {
    let Some(part) = mismatch.part else { return (relation.lhs, Some(Side::Expr(relation.rhs))) };
    match units.model.exprs.node(part) {
        Node::Unary(_, a) | Node::Binary(Binary::Pow, _, a) => (Some(Side::Expr(a)), None),
        Node::Binary(_, a, b)
        | Node::Rel(_, a, b)
        | Node::EventRel(_, a, b)
        | Node::If(_, a, b)
        | Node::Homotopy(a, b) => (Some(Side::Expr(a)), Some(Side::Expr(b))),
        _ => (None, None),
    }
}

/// A unit as the user wrote it when the expression is a variable that declares it.
fn named(units: &Units, side: Side, quantity: Quantity) -> String {
    let variable = match side {
        Side::Var(v) => Some(v),
        Side::Expr(e) => match units.model.exprs.node(e) {
            Node::Var(v) | Node::Pre(v) => Some(v),
            _ => None,
        },
    };
    let written = variable.and_then(|v| units.model.variables[v.index()].unit.as_deref());
    written.filter(|text| !text.is_empty()).map_or_else(|| quantity.to_string(), String::from)
}

/// The message, and what stands under the place.
fn words(model: &FlatModel, relation: &Relation, mismatch: &Mismatch, left: &str, right: &str) -> (String, String) {
    let Some(part) = mismatch.part else {
        let lhs = match relation.lhs {
            Some(Side::Var(v)) => model.variables[v.index()].name.clone(),
            Some(Side::Expr(e)) => infer::text(model, e),
            None => String::new(),
        };
        let rhs = infer::text(model, relation.rhs);
        let message = format!("`{lhs} = {rhs}`: the left side is in {left}, the right side in {right}");
        return (message, format!("{left} = {right}"));
    };
    let whole = infer::text(model, part);
    match model.exprs.node(part) {
        Node::Binary(Binary::Add, ..) => (format!("`{whole}` adds {left} and {right}"), format!("{left} + {right}")),
        Node::Binary(Binary::Sub, ..) => {
            (format!("`{whole}` subtracts {right} from {left}"), format!("{left} - {right}"))
        }
        Node::Rel(..) | Node::EventRel(..) | Node::Binary(Binary::Min | Binary::Max | Binary::Atan2, ..) => {
            (format!("`{whole}` compares {left} with {right}"), format!("{left} against {right}"))
        }
        Node::Unary(..) => (format!("the argument of `{whole}` is in {left}, not a number"), format!("{left} here")),
        Node::Binary(Binary::Pow, ..) => (format!("the exponent of `{whole}` is in {left}"), format!("{left} here")),
        _ => (format!("the two values of `{whole}` are in {left} and {right}"), format!("{left} or {right}")),
    }
}

/// The variables of an expression with their units, and where the unit of an undeclared one was found.
fn terms(units: &Units, relations: &[Relation], side: Side, relation: &Relation) -> Vec<(VarId, Option<Span>, String)> {
    let model = units.model;
    let mut roots = Vec::new();
    if let Side::Expr(e) = side {
        roots.push(e);
    }
    if let (Some(Side::Expr(lhs)), true) = (relation.lhs, roots == [relation.rhs]) {
        roots.push(lhs);
    }
    let leaves = model.exprs.dependencies(&roots);
    let mut vars: Vec<VarId> = [leaves.vars, leaves.ders, leaves.pres].concat();
    vars.sort_unstable();
    vars.dedup();
    let mut lines = Vec::new();
    for v in vars {
        let variable = &model.variables[v.index()];
        let Measure::Known(quantity) = units.variables[v.index()] else { continue };
        let line = match (&variable.unit, units.found_in.get(&v)) {
            (Some(unit), None) => (v, None, format!("`{}` is in {unit}", variable.name)),
            (_, Some(&found)) => {
                let span = relations[found as usize].span;
                (v, Some(span), format!("`{}` has no unit; the equations put it in {quantity}", variable.name))
            }
            _ => continue,
        };
        lines.push(line);
    }
    lines.truncate(MOST_TERMS);
    lines
}

fn conversion(mismatch: &Mismatch) -> String {
    let (left, right) = (mismatch.left, mismatch.right);
    let shift = right.offset - left.offset;
    if shift.abs() > 1e-6 {
        return "convert one side: a value in degC is the value in K less 273.15".into();
    }
    let factor = bramah_expr::print::number(right.factor / left.factor, Some(7));
    format!("convert one side, or declare both in the same unit: the right one is {factor} of the left one")
}

fn unreadable_units(model: &FlatModel, unreadable: &[infer::Unreadable]) -> Vec<Diagnostic> {
    let mut seen = FxHashSet::default();
    let mut found = Vec::new();
    for (v, error) in unreadable {
        let variable = &model.variables[v.index()];
        if seen.insert((variable.origin.span, error)) {
            found.push(unreadable_unit(model, *v, error));
        }
    }
    found
}

fn unreadable_unit(model: &FlatModel, v: VarId, error: &UnitError) -> Diagnostic {
    let variable = &model.variables[v.index()];
    let class = &model.instances[variable.origin.instance as usize].class;
    Diagnostic::new(Code::UnknownUnit, format!("{error} (variable `{}`)", variable.name))
        .at(variable.origin.span, "declared here")
        .class(class)
        .help("units are written as in `N.m`, `m3/s`, `J/(kg.K)`, `l/min`, `rev/min`, `degC`")
}

/// A `displayUnit` of another dimension than the `unit`.
fn display_units(model: &FlatModel) -> Vec<Diagnostic> {
    let mut seen = FxHashSet::default();
    let mut found = Vec::new();
    for variable in &model.variables {
        let (Some(unit), Some(display)) = (variable.unit.as_deref(), variable.display_unit.as_deref()) else {
            continue;
        };
        if unit == display || !seen.insert((unit, display)) {
            continue;
        }
        let (Ok(own), Ok(shown)) = (Unit::parse(unit), Unit::parse(display)) else { continue };
        if own.dimension != shown.dimension && !display.is_empty() && !unit.is_empty() {
            let message = format!("`{}` is in {unit} and cannot be displayed in {display}", variable.name);
            found.push(Diagnostic::new(Code::UnitMismatch, message).at(variable.origin.span, "declared here"));
        }
    }
    found
}

#[cfg(test)]
mod tests;
