//! Loops without a range: `for i loop x[i] := ...; end for` runs over `1:size(x, 1)` (MLS 10.4.1.1, 11.2.2.1).
//!
//! The body is searched for arrays that the loop variable alone indexes. Their sizes must agree.
//! Other parts of the compiler use the walk over references as well, see `names_of_declaration`.

use crate::instance::evaluation::ranges::ArrayExtent;
use crate::instance::lookup::LookupResult;
use crate::instance::{Evaluator, InstanceNode, LookupContext};
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{
    ComponentDeclaration, ComponentReference, Equation, EquationKind, Expr, ExprKind, Statement, StatementKind,
    Subscript,
};
use bramah_syntax::diag::{Code, Diagnostic};
use bramah_syntax::symbol::Symbol;

/// What a loop repeats.
#[derive(Clone, Copy)]
pub enum LoopBody<'a> {
    /// The expression of an array or reduction: `{x[i] for i}`.
    Expr(&'a Expr),
    /// The equations of a `for` equation.
    Equations(&'a [Equation]),
    /// The statements of a `for` statement.
    Statements(&'a [Statement]),
}

impl<'a> Evaluator<'_, 'a, '_> {
    /// The dimension over which a loop with the variable `name` runs.
    ///
    /// It is that of the arrays indexed by `name` alone. `None` if there is none, or after a message if their sizes
    /// differ.
    ///
    /// ```text
    /// for i loop
    ///   x[i] = 2 * y[i];    // 1:size(x, 1), and y must have the same size
    /// end for;
    /// ```
    pub(in crate::instance) fn deduced_extent(
        &mut self,
        name: Symbol,
        body: LoopBody<'a>,
        view: LookupContext,
    ) -> Option<ArrayExtent> {
        // Each entry: the reference, the index of the part with the subscript, and the position of the subscript.
        let mut found: Vec<(&'a ComponentReference, usize, usize)> = Vec::new();
        walk(body, &mut |r| {
            for (p, part) in r.parts.iter().enumerate() {
                found.extend(part.subscripts.iter().position(|s| is_name(s, name)).map(|k| (r, p, k)));
            }
        });
        let mut first: Option<ArrayExtent> = None;
        for (r, part, dimension) in found {
            let Some(size) = self.indexed_size(r, part, dimension, view) else { continue };
            match first {
                None => first = Some(size),
                Some(other) if other.size != size.size => {
                    let message = format!(
                        "the loop over `{name}` indexes arrays of {} and of {} elements",
                        other.size, size.size
                    );
                    let d = Diagnostic::new(Code::SizeMismatch, message).at(r.span, "of another size");
                    self.instance.report(d.help(format!("write `for {name} in 1:n`")).note("Modelica 3.6, 11.2.2.1"));
                    return None;
                }
                Some(_) => {}
            }
        }
        first
    }

    /// Dimension `dimension` of the array that `parts[..=part]` names without its subscripts.
    /// `None` if that is no array.
    ///
    /// A local of a function has the sizes of its value. A component has those of its node.
    /// `view` is the place of the loop.
    /// Without subscripts means that `x[i].y[j]` asks for the array `y` of the first element of `x`.
    fn indexed_size(
        &mut self,
        r: &'a ComponentReference,
        part: usize,
        dimension: usize,
        view: LookupContext,
    ) -> Option<ArrayExtent> {
        let first = r.parts[0].name.name;
        // Only a reference that begins with the array itself can be a local here.
        if part == 0
            && let Some(i) = self.instance.local(first)
        {
            let size = *self.instance.eval.locals[i].1.dims().get(dimension)?;
            let by = self.counted_by(view, first).get(dimension).copied().unwrap_or(ScalarType::Integer);
            return Some(ArrayExtent { size, by });
        }
        let LookupResult::Component(mut scope, mut index) = self.instance.names().lookup(view, first)? else {
            return None;
        };
        // Elements of a component array have the same sizes, so the first one stands for all.
        for step in &r.parts[1..=part] {
            let first = self.first_of(scope, index)?;
            let InstanceNode::Object(inner) = *self.instance.node(first) else { return None };
            scope = inner;
            index = *self.instance.scope(inner).template.by_name.get(&step.name.name)?;
        }
        let node = self.instance.builder().component(scope, index)?;
        match self.instance.node(node) {
            InstanceNode::Array { dims, by, .. } => {
                Some(ArrayExtent { size: *dims.get(dimension)?, by: by[dimension] })
            }
            _ => None,
        }
    }

    /// The node of a component, or of the first element of a component array. `None` for an empty array.
    fn first_of(&mut self, scope: crate::instance::ScopeId, index: u32) -> Option<crate::instance::NodeId> {
        let node = self.instance.builder().component(scope, index)?;
        match self.instance.node(node) {
            InstanceNode::Array { elements, .. } => elements.first().copied(),
            _ => Some(node),
        }
    }
}

/// The first parts of all names in the dimensions and the value of a declaration.
/// The order in which locals of a function are initialized depends on them.
pub(in crate::instance) fn names_of_declaration(c: &ComponentDeclaration) -> Vec<Symbol> {
    let mut found = Vec::new();
    let mut see = |r: &ComponentReference| found.push(r.parts[0].name.name);
    c.subscripts.iter().for_each(|s| subscript(s, &mut see));
    if let Some(value) = c.modification.as_ref().and_then(|m| m.value.as_ref()) {
        expression(value, &mut see);
    }
    found
}

/// Whether a subscript consists of the name `name` alone.
fn is_name(s: &Subscript, name: Symbol) -> bool {
    matches!(s, Subscript::Expr(Expr { kind: ExprKind::Reference(r), .. })
        if r.parts.len() == 1 && r.parts[0].subscripts.is_empty() && r.parts[0].name.name == name)
}

/// Calls `see` for every reference in a loop body, in the order of the text, inside subscripts too.
fn walk<'a>(body: LoopBody<'a>, see: &mut dyn FnMut(&'a ComponentReference)) {
    match body {
        LoopBody::Expr(e) => expression(e, see),
        LoopBody::Equations(list) => list.iter().for_each(|e| equation(e, see)),
        LoopBody::Statements(list) => list.iter().for_each(|s| statement(s, see)),
    }
}

/// Calls `see` for the references of one equation. Conditions of `if` and `when`, and ranges, are left out.
/// Both sides of an equation and the arguments of calls are searched.
fn equation<'a>(e: &'a Equation, see: &mut dyn FnMut(&'a ComponentReference)) {
    match &e.kind {
        EquationKind::Equal(a, b) | EquationKind::Connect(a, b) => [a, b].into_iter().for_each(|e| expression(e, see)),
        EquationKind::If { branches, otherwise } => {
            branches.iter().for_each(|(_, body)| walk(LoopBody::Equations(body), see));
            walk(LoopBody::Equations(otherwise), see);
        }
        EquationKind::For { body, .. } => walk(LoopBody::Equations(body), see),
        EquationKind::When(branches) => branches.iter().for_each(|(_, body)| walk(LoopBody::Equations(body), see)),
        EquationKind::Call(call) => expression(call, see),
    }
}

/// Calls `see` for the references of one statement. Conditions and ranges are left out.
/// Targets of assignments are searched as well, because their subscripts determine the loop.
/// An outer loop over the same array counts like any other reference.
fn statement<'a>(s: &'a Statement, see: &mut dyn FnMut(&'a ComponentReference)) {
    match &s.kind {
        StatementKind::Assign(a, b) => [a, b].into_iter().for_each(|e| expression(e, see)),
        StatementKind::AssignTuple(targets, call) => {
            targets.iter().flatten().for_each(|e| expression(e, see));
            expression(call, see);
        }
        StatementKind::Call(call) => expression(call, see),
        StatementKind::If { branches, otherwise } => {
            branches.iter().for_each(|(_, body)| walk(LoopBody::Statements(body), see));
            walk(LoopBody::Statements(otherwise), see);
        }
        StatementKind::For { body, .. } | StatementKind::While(_, body) => walk(LoopBody::Statements(body), see),
        StatementKind::When(branches) => branches.iter().for_each(|(_, body)| walk(LoopBody::Statements(body), see)),
        StatementKind::Break | StatementKind::Return => {}
    }
}

/// Calls `see` for the references in an expression, from outside inwards.
fn expression<'a>(e: &'a Expr, see: &mut dyn FnMut(&'a ComponentReference)) {
    if let ExprKind::Reference(r) = &e.kind {
        see(r);
    }
    e.each_child(&mut |inner| expression(inner, see));
}

/// Calls `see` for the references in a subscript.
fn subscript<'a>(s: &'a Subscript, see: &mut dyn FnMut(&'a ComponentReference)) {
    if let Subscript::Expr(e) = s {
        expression(e, see);
    }
}
