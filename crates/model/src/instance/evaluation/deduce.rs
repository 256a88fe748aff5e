//! Loops without a range, `for i loop x[i] = ...`: it is `1:size(x, 1)`, after an array that the variable indexes alone
//! (MLS 10.4.1.1, 11.2.2.1).

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
    /// An element of an array or reduction.
    Expr(&'a Expr),
    /// Equations.
    Equations(&'a [Equation]),
    /// Statements.
    Statements(&'a [Statement]),
}

impl<'a> Evaluator<'_, 'a, '_> {
    /// How often a loop over `name` runs, where an array tells.
    pub(in crate::instance) fn deduced_extent(
        &mut self,
        name: Symbol,
        body: LoopBody<'a>,
        view: LookupContext,
    ) -> Option<ArrayExtent> {
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

    /// The size of the array that `parts[..=part]` names without its subscripts.
    fn indexed_size(
        &mut self,
        r: &'a ComponentReference,
        part: usize,
        dimension: usize,
        view: LookupContext,
    ) -> Option<ArrayExtent> {
        let first = r.parts[0].name.name;
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

    /// A component, or the first element of an array of them.
    fn first_of(&mut self, scope: crate::instance::ScopeId, index: u32) -> Option<crate::instance::NodeId> {
        let node = self.instance.builder().component(scope, index)?;
        match self.instance.node(node) {
            InstanceNode::Array { elements, .. } => elements.first().copied(),
            _ => Some(node),
        }
    }
}

/// The first parts of the names in a declaration's sizes and value.
pub(in crate::instance) fn names_of_declaration(c: &ComponentDeclaration) -> Vec<Symbol> {
    let mut found = Vec::new();
    let mut see = |r: &ComponentReference| found.push(r.parts[0].name.name);
    c.subscripts.iter().for_each(|s| subscript(s, &mut see));
    if let Some(value) = c.modification.as_ref().and_then(|m| m.value.as_ref()) {
        expression(value, &mut see);
    }
    found
}

fn is_name(s: &Subscript, name: Symbol) -> bool {
    matches!(s, Subscript::Expr(Expr { kind: ExprKind::Reference(r), .. })
        if r.parts.len() == 1 && r.parts[0].subscripts.is_empty() && r.parts[0].name.name == name)
}

/// Shows all references to `see`.
fn walk<'a>(body: LoopBody<'a>, see: &mut dyn FnMut(&'a ComponentReference)) {
    match body {
        LoopBody::Expr(e) => expression(e, see),
        LoopBody::Equations(list) => list.iter().for_each(|e| equation(e, see)),
        LoopBody::Statements(list) => list.iter().for_each(|s| statement(s, see)),
    }
}

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

fn expression<'a>(e: &'a Expr, see: &mut dyn FnMut(&'a ComponentReference)) {
    if let ExprKind::Reference(r) = &e.kind {
        see(r);
    }
    e.each_child(&mut |inner| expression(inner, see));
}

fn subscript<'a>(s: &'a Subscript, see: &mut dyn FnMut(&'a ComponentReference)) {
    if let Subscript::Expr(e) = s {
        expression(e, see);
    }
}
