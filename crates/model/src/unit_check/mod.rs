//! The unit check: every flat equation, binding, start value and assignment.
//!
//! Enters: a [`FlatModel`]. Leaves: warnings; units never stop a model from running. `compile::sort` calls [`check`].
//!
//! `measure` says what is known about the unit of an expression and how operators combine it. `infer` lists the
//! relations in which units must fit, and finds the units of variables that declare none. This file compares both sides
//! of each relation and the arguments of each operation, and writes the messages. The check is silent where a unit is
//! not known.

mod infer;
mod measure;

use crate::flat::FlatModel;
use bramah_expr::units::{MeasurementUnit, UnitError};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, VarId};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use infer::{RelationSide, UnitInference, UnitRelation};
use measure::{PartialUnit, UnitDifference, UnitKnowledge};
use rustc_hash::FxHashSet;

/// The most terms that a message lists.
const MOST_TERMS: usize = 8;

/// Warnings where units do not fit, in the order of the model's equations.
///
/// W232 is for units that cannot be read, W230 for sides of different dimension, W231 for sides of one dimension in
/// different units. A place in the text is reported once, however many instances its class has. What is not known is
/// not reported.
pub fn check(model: &FlatModel) -> Vec<Diagnostic> {
    let relations = infer::relations(model);
    let (mut units, unreadable) = UnitInference::declared(model, &relations);
    let mut found = unreadable_units(model, &unreadable);
    found.extend(display_units(model));
    units.infer(&relations);
    let mut seen = FxHashSet::default();
    let mut mismatches = Vec::new();
    for (number, relation) in relations.iter().enumerate() {
        mismatches.clear();
        // Nodes are compared while they are evaluated: a node shared by relations may get another unit from the next
        // one.
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

/// Two quantities that should have the same unit and do not.
struct UnitMismatch {
    /// How they differ.
    difference: UnitDifference,
    /// The node inside the relation at which they meet; `None` for the two sides of the relation itself.
    part: Option<ExprId>,
    /// The unit of the first one.
    left: PartialUnit,
    /// The unit of the second one.
    right: PartialUnit,
}

/// Compares two units. `None` where they agree or one of them is not known.
/// Unknown units and numbers never make a mismatch.
fn mismatch(part: Option<ExprId>, left: UnitKnowledge, right: UnitKnowledge) -> Option<UnitMismatch> {
    let (left, right) = (left.known()?, right.known()?);
    let difference = left.difference(right)?;
    Some(UnitMismatch { difference, part, left, right })
}

/// Compares the sides of a relation, after its nodes have been evaluated.
/// A lone expression has no sides to compare.
fn outer_mismatch(units: &UnitInference, relation: &UnitRelation) -> Option<UnitMismatch> {
    mismatch(None, units.side(relation.lhs), units.of(relation.rhs))
}

/// Compares the arguments of a node: terms of a sum, sides of a comparison, branches of an `if`, and arguments that
/// must be numbers. `None` for other nodes.
///
/// In sums the zero point is ignored: a temperature and a difference of temperatures may be added.
fn inner_mismatch(units: &UnitInference, e: ExprId) -> Option<UnitMismatch> {
    let number = UnitKnowledge::Known(PartialUnit::NUMBER);
    let (left, right) = match units.model.exprs.node(e) {
        // Both sides of a comparison are in one unit.
        ExprNode::Rel(_, a, b) | ExprNode::EventRel(_, a, b) => (units.of(a), units.of(b)),
        ExprNode::Binary(BinaryFunction::Sub | BinaryFunction::Add, a, b) => {
            // A temperature and a difference of temperatures may be added.
            let free = |e| units.of(e).known().map_or(units.of(e), |q| UnitKnowledge::Known(q.shifted()));
            (free(a), free(b))
        }
        ExprNode::Binary(BinaryFunction::Min | BinaryFunction::Max | BinaryFunction::Atan2, a, b) => {
            (units.of(a), units.of(b))
        }
        ExprNode::If(_, a, b) | ExprNode::Homotopy(a, b) => (units.of(a), units.of(b)),
        ExprNode::Unary(op, a) if infer::takes_numbers(op) => (units.of(a), number),
        ExprNode::Binary(BinaryFunction::Pow, _, b) => (units.of(b), number),
        _ => return None,
    };
    mismatch(Some(e), left, right)
}

/// The warning about a mismatch: what meets where, in which units, and the variables that take part.
///
/// The message says what meets in which units; notes list the variables, and further places show from which equations
/// the units of undeclared variables follow.
fn report(
    units: &UnitInference,
    relations: &[UnitRelation],
    relation: &UnitRelation,
    mismatch: &UnitMismatch,
) -> Diagnostic {
    let model = units.model;
    let code = match mismatch.difference {
        UnitDifference::Dimension => Code::UnitMismatch,
        UnitDifference::Factor => Code::UnitFactor,
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
    for (v, span, line) in
        terms(units, relations, mismatch.part.map_or(RelationSide::Expr(relation.rhs), RelationSide::Expr), relation)
    {
        diagnostic = diagnostic.note(line);
        if let Some(span) = span.filter(|&span| span != relation.span) {
            let text = format!("the unit of `{}` follows from this", model.variables[v.index()].name);
            diagnostic = diagnostic.at(span, text);
        }
    }
    match mismatch.difference {
        // Only units of one dimension can be converted.
        UnitDifference::Factor => diagnostic.help(conversion(mismatch)),
        UnitDifference::Dimension => diagnostic,
    }
}

/// The two sides that are compared. `None` for a side that is no expression, such as the plain number that a function
/// wants.
/// For a function or an exponent only the argument is shown.
fn meeting_places(
    units: &UnitInference,
    relation: &UnitRelation,
    mismatch: &UnitMismatch,
) -> (Option<RelationSide>, Option<RelationSide>) {
    let Some(part) = mismatch.part else { return (relation.lhs, Some(RelationSide::Expr(relation.rhs))) };
    match units.model.exprs.node(part) {
        ExprNode::Unary(_, a) | ExprNode::Binary(BinaryFunction::Pow, _, a) => (Some(RelationSide::Expr(a)), None),
        ExprNode::Binary(_, a, b)
        | ExprNode::Rel(_, a, b)
        | ExprNode::EventRel(_, a, b)
        | ExprNode::If(_, a, b)
        | ExprNode::Homotopy(a, b) => (Some(RelationSide::Expr(a)), Some(RelationSide::Expr(b))),
        _ => (None, None),
    }
}

/// A unit as the user wrote it if the side is a variable that declares it; else in SI base units.
/// So `bar` is printed as `bar` and not as 100000 Pa.
fn named(units: &UnitInference, side: RelationSide, quantity: PartialUnit) -> String {
    let variable = match side {
        RelationSide::Var(v) => Some(v),
        RelationSide::Expr(e) => match units.model.exprs.node(e) {
            ExprNode::Var(v) | ExprNode::Pre(v) => Some(v),
            _ => None,
        },
    };
    let written = variable.and_then(|v| units.model.variables[v.index()].unit.as_deref());
    written.filter(|text| !text.is_empty()).map_or_else(|| quantity.to_string(), String::from)
}

/// The message, and the label at the place.
/// An example: "`p + q` adds Pa and m3/s", with the label "Pa + m3/s".
fn words(
    model: &FlatModel,
    relation: &UnitRelation,
    mismatch: &UnitMismatch,
    left: &str,
    right: &str,
) -> (String, String) {
    let Some(part) = mismatch.part else {
        let lhs = match relation.lhs {
            Some(RelationSide::Var(v)) => model.variables[v.index()].name.clone(),
            Some(RelationSide::Expr(e)) => infer::text(model, e),
            None => String::new(),
        };
        let rhs = infer::text(model, relation.rhs);
        let message = format!("`{lhs} = {rhs}`: the left side is in {left}, the right side in {right}");
        return (message, format!("{left} = {right}"));
    };
    let whole = infer::text(model, part);
    match model.exprs.node(part) {
        ExprNode::Binary(BinaryFunction::Add, ..) => {
            (format!("`{whole}` adds {left} and {right}"), format!("{left} + {right}"))
        }
        ExprNode::Binary(BinaryFunction::Sub, ..) => {
            (format!("`{whole}` subtracts {right} from {left}"), format!("{left} - {right}"))
        }
        ExprNode::Rel(..)
        | ExprNode::EventRel(..)
        | ExprNode::Binary(BinaryFunction::Min | BinaryFunction::Max | BinaryFunction::Atan2, ..) => {
            (format!("`{whole}` compares {left} with {right}"), format!("{left} against {right}"))
        }
        ExprNode::Unary(..) => {
            (format!("the argument of `{whole}` is in {left}, not a number"), format!("{left} here"))
        }
        ExprNode::Binary(BinaryFunction::Pow, ..) => {
            (format!("the exponent of `{whole}` is in {left}"), format!("{left} here"))
        }
        _ => (format!("the two values of `{whole}` are in {left} and {right}"), format!("{left} or {right}")),
    }
}

/// The variables of a side with their units, one line each, and the place from which the unit of an undeclared one
/// follows. At most [`MOST_TERMS`] lines; variables without a known unit are left out.
///
/// A derivative or `pre` counts as its variable. `relation` is the one that the mismatch belongs to.
fn terms(
    units: &UnitInference,
    relations: &[UnitRelation],
    side: RelationSide,
    relation: &UnitRelation,
) -> Vec<(VarId, Option<Span>, String)> {
    let model = units.model;
    let mut roots = Vec::new();
    if let RelationSide::Expr(e) = side {
        roots.push(e);
    }
    // For a mismatch of the relation itself both sides matter.
    if let (Some(RelationSide::Expr(lhs)), true) = (relation.lhs, roots == [relation.rhs]) {
        roots.push(lhs);
    }
    let leaves = model.exprs.dependencies(&roots);
    let mut vars: Vec<VarId> = [leaves.vars, leaves.ders, leaves.pres].concat();
    vars.sort_unstable();
    vars.dedup();
    let mut lines = Vec::new();
    for v in vars {
        let variable = &model.variables[v.index()];
        let UnitKnowledge::Known(quantity) = units.variables[v.index()] else { continue };
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

/// Advice how to convert: by the offset of a temperature, or by the factor between the units.
/// A difference of offsets means degC against K.
fn conversion(mismatch: &UnitMismatch) -> String {
    let (left, right) = (mismatch.left, mismatch.right);
    let shift = right.offset - left.offset;
    if shift.abs() > 1e-6 {
        return "convert one side: a value in degC is the value in K less 273.15".into();
    }
    let factor = bramah_expr::print::number(right.factor / left.factor, Some(7));
    format!("convert one side, or declare both in the same unit: the right one is {factor} of the left one")
}

/// The warning about one unit string.
/// A class with many instances is reported once.
/// The help shows the notation.
fn unreadable_units(model: &FlatModel, unreadable: &[infer::UnreadableUnit]) -> Vec<Diagnostic> {
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

/// Warnings for a `displayUnit` of another dimension than the `unit`, once for each pair of units.
/// The code is W230. Strings that cannot be read are skipped here.
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
        let (Ok(own), Ok(shown)) = (MeasurementUnit::parse(unit), MeasurementUnit::parse(display)) else { continue };
        if own.dimension != shown.dimension && !display.is_empty() && !unit.is_empty() {
            let message = format!("`{}` is in {unit} and cannot be displayed in {display}", variable.name);
            found.push(Diagnostic::new(Code::UnitMismatch, message).at(variable.origin.span, "declared here"));
        }
    }
    found
}

#[cfg(test)]
mod tests;
