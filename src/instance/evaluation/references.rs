//! Component references: `a.b[i].c` to the variables it means.

use crate::instance::deduce::Body;
use crate::instance::errors::{list_names, nearest, short};
use crate::instance::expressions::{Pick, QUANTITY, Work};
use crate::instance::lookup::{Builtin, Found};
use crate::instance::modifiers::Binding;
use crate::instance::template::Kind;
use crate::instance::value::Val;
use crate::instance::{ElementState, Instance, Node, NodeId, ScopeId, View};
use crate::diag::{Code, Diagnostic, Span};
use crate::types::{Type, Variability};
use crate::syntax::ast::{ClassKind, Expr, ExprKind, Reference, ReferencePart, Subscript};
use crate::syntax::symbol::Symbol;
use std::rc::Rc;

/// Most statements of an algorithm section of a model.
const MOST_SECTION_STEPS: usize = 1_000_000;

/// Components picked by a reference: with dimensions when arrays are passed through.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Sizes of the arrays passed through.
    pub dims: Vec<usize>,
    /// How many of the sizes, counted from the last, belong to the component named last.
    pub own: usize,
    /// What counts along these.
    pub by: Rc<[Type]>,
    /// The components, row-major; shared, for a reference to one element of a long array passes through the whole.
    pub nodes: Rc<[NodeId]>,
}

impl<'a> Instance<'a, '_> {
    /// A loop variable or local of the function being evaluated.
    pub(in crate::instance) fn local(&self, name: Symbol) -> Option<usize> {
        let frame = self.eval.frame;
        let found = self.eval.locals[frame..].iter().rposition(|(n, _)| *n == name).map(|i| i + frame);
        found.filter(|i| !(self.eval.before && self.eval.section.contains(i)))
    }

    /// The value of a reference.
    pub(in crate::instance) fn reference(&mut self, r: &'a Reference, view: View) -> Option<Val> {
        let first = &r.parts[0];
        if !r.global {
            if let Some(i) = self.local(first.name.name) {
                let value = self.eval.locals[i].1.clone();
                return self.local_part(value, r, view);
            }
            if r.parts.len() == 1 && first.name.name == "time" {
                return self.time(r.span);
            }
        }
        match self.start(r, view)? {
            Found::Component(scope, index) => {
                let node = self.element_node(scope, index, r)?;
                self.select_value(node, r, 0, view)
            }
            Found::Class(class) => self.class_value(Found::Class(class), r, view),
            Found::Builtin(b) => self.class_value(Found::Builtin(b), r, view),
        }
    }

    fn time(&mut self, span: Span) -> Option<Val> {
        if self.eval.constant {
            return self.fail(Code::NotConstant, "`time` is not known before the run", span);
        }
        Some(Val::Scalar(self.exprs.time(), Type::Real))
    }

    /// Fields and indices of a local.
    fn local_part(&mut self, mut value: Val, r: &'a Reference, view: View) -> Option<Val> {
        let first = &r.parts[0];
        if !first.subscripts.is_empty() {
            let by = self.counted_by(view, first.name.name);
            value = self.subscript_by(value, &first.subscripts, &by, view, r.span)?;
        }
        for part in &r.parts[1..] {
            value = self.field(&value, part.name.name, part.name.span)?;
            value = self.subscript(value, &part.subscripts, view, r.span)?;
        }
        Some(value)
    }

    /// What counts along the dimensions with which a local of a function, or of an algorithm section, was declared.
    pub(in crate::instance) fn counted_by(&mut self, view: View, name: Symbol) -> Vec<Type> {
        let Some(Found::Component(scope, index)) = self.lookup(view, name) else { return Vec::new() };
        let template = self.scope(scope).template.clone();
        let element = &template.elements[index as usize];
        let Kind::Component(declared) = element.kind else { return Vec::new() };
        let own = View { scope, base: element.base };
        let by = |s: &'a Subscript| match s {
            Subscript::Expr(e) => self.enumeration_range(e, own).and_then(|v| v.first().and_then(Val::element_type)),
            Subscript::All(_) => None,
        };
        declared.subscripts.iter().map(by).map(|by| by.unwrap_or(Type::Integer)).collect()
    }

    /// A field of a record, or of every record of an array.
    pub(in crate::instance) fn field(&mut self, value: &Val, name: Symbol, span: Span) -> Option<Val> {
        match value {
            Val::Record(record) => match record.fields.iter().find(|(n, _)| *n == name) {
                Some((_, v)) => Some(v.clone()),
                None => {
                    let names: Vec<Symbol> = record.fields.iter().map(|(n, _)| *n).collect();
                    self.unknown_name(name, span, &names);
                    None
                }
            },
            Val::Array { dims, elements } => {
                let parts: Option<Vec<Val>> = elements.iter().map(|v| self.field(v, name, span)).collect();
                let parts = parts?;
                let inner = parts.first().map_or(Vec::new(), |v| v.dims().to_vec());
                let all: Vec<Val> = parts.iter().flat_map(|v| v.elements().to_vec()).collect();
                Some(Val::array(dims.iter().copied().chain(inner).collect(), all))
            }
            _ => self.fail(Code::UnknownName, &format!("{} has no field `{name}`", value.describe()), span),
        }
    }

    /// What the first part of a reference means, or a message.
    fn start(&mut self, r: &Reference, view: View) -> Option<Found<'a>> {
        let name = r.parts[0].name;
        let found = if r.global { self.lookup(crate::instance::ROOT, name.name) } else { self.lookup(view, name.name) };
        if found.is_none() {
            let names = self.visible_names(view);
            self.unknown_name(name.name, name.span, &names);
        }
        if let Some(Found::Component(scope, index)) = found
            && !r.global
            && self.is_variable_around(view, scope, index)
        {
            let class = self.scope(view.scope).template.class;
            let class = self.library.full_name(class);
            self.report(
                Diagnostic::new(Code::UnknownName, format!("`{}` belongs to what lies around `{class}`", name.name))
                    .at(name.span, "only constants of enclosing classes can be read")
                    .help("give it to the class as a parameter, an input or through `inner` and `outer`")
                    .note("Modelica 3.6, 5.3.1"),
            );
            return None;
        }
        found
    }

    /// Whether a component found around a class is a variable of an instance, which only constants may be (MLS 5.3.1).
    ///
    /// A function called through a component, as in `oil.density(p)`, reads what that holds; no other function is found there.
    fn is_variable_around(&self, mut view: View, scope: ScopeId, index: u32) -> bool {
        // the modifiers of a short class stand around it
        while let Some(base) = self.scope(view.scope).template.bases.get(view.base as usize).filter(|b| b.short) {
            view = base.parent;
        }
        let (found, from) = (self.scope(scope), self.scope(view.scope));
        if scope == view.scope || !found.component || matches!(from.template.kind, ClassKind::Function { .. }) {
            return false;
        }
        match found.template.elements[index as usize].kind {
            Kind::Component(c) => {
                let constant = Some(crate::syntax::ast::Variability::Constant);
                c.prefix.variability != constant && found.prefix.variability != constant
            }
            Kind::Class(_) => false,
        }
    }

    pub(in crate::instance) fn unknown_name(&mut self, name: Symbol, span: Span, names: &[Symbol]) {
        let mut d = Diagnostic::new(Code::UnknownName, format!("there is no `{}` here", short(name.as_str())))
            .at(span, "not found");
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(list_names("known here are", names)),
        };
        self.report(d);
    }

    fn visible_names(&self, view: View) -> Vec<Symbol> {
        let frame = self.eval.frame;
        let mut names: Vec<Symbol> = self.eval.locals[frame..].iter().map(|(n, _)| *n).collect();
        names.extend(self.scope(view.scope).template.elements.iter().map(|e| e.name));
        names
    }

    /// The node of an element, with a message when it is absent.
    fn element_node(&mut self, scope: ScopeId, index: u32, r: &Reference) -> Option<NodeId> {
        let busy = matches!(self.scope(scope).elements[index as usize], ElementState::Busy);
        if let Some(node) = self.component(scope, index) {
            return Some(node);
        }
        let name = self.scope(scope).template.elements[index as usize].name;
        if busy {
            self.report(
                Diagnostic::new(Code::CyclicParameter, format!("`{name}` is needed to build itself"))
                    .at(r.span, "used here while its size or condition is being found"),
            );
        } else if !self.diagnostics.iter().any(Diagnostic::is_error) {
            self.report(
                Diagnostic::new(Code::UnknownName, format!("the conditional component `{name}` is not there"))
                    .at(r.span, "its condition is false")
                    .help("use it only in `connect`, which vanishes with it, or under the same condition"),
            );
        }
        None
    }

    /// A node as a selection.
    pub fn selection(&self, node: NodeId) -> Selection {
        match self.node(node) {
            Node::Array { dims, by, elements } => {
                Selection { dims: dims.clone(), own: dims.len(), by: by.clone(), nodes: elements.clone() }
            }
            _ => Selection { dims: Vec::new(), own: 0, by: Rc::from([]), nodes: Rc::from([node]) },
        }
    }

    /// Follows a reference from a component; `part` is the part that named it.
    fn select_value(&mut self, node: NodeId, r: &'a Reference, part: usize, view: View) -> Option<Val> {
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate().skip(part) {
            if i > part {
                match self.descend(&at, p) {
                    Descent::Nodes(next) => at = next,
                    Descent::Class(found) => {
                        let rest = Reference { global: false, parts: r.parts[i..].to_vec(), span: r.span };
                        return self.class_tail(found, &rest, view);
                    }
                    Descent::Failed => return None,
                }
            }
            if !p.subscripts.is_empty() {
                match self.subscript_selection(&at, p, view, r.span)? {
                    Ok(next) => at = next,
                    // An index known at run time only: continue with values.
                    Err(()) => return self.dynamic_selection(&at, r, i, view),
                }
            }
        }
        self.selection_value(&at, r.span)
    }

    /// Sizes of what a reference to components of the model selects: they are known where the values are not. `None` where
    /// it is anything else.
    pub(in crate::instance) fn declared_dims(&mut self, e: &'a Expr, view: View) -> Option<Vec<usize>> {
        let ExprKind::Reference(r) = &e.kind else { return None };
        if !self.eval.constant || !r.global && self.local(r.parts[0].name.name).is_some() {
            return None;
        }
        let from = if r.global { crate::instance::ROOT } else { view };
        let Found::Component(scope, index) = self.lookup(from, r.parts[0].name.name)? else { return None };
        let node = self.component(scope, index)?;
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate() {
            if i > 0 {
                let Descent::Nodes(next) = self.descend(&at, p) else { return None };
                at = next;
            }
            if !p.subscripts.is_empty() {
                at = self.subscript_selection(&at, p, view, r.span)?.ok()?;
            }
        }
        Some(at.dims)
    }

    /// Sizes of an expression whose value may change, where its form tells them.
    pub(in crate::instance) fn shape(&mut self, e: &'a Expr, view: View) -> Option<Vec<usize>> {
        let before = std::mem::replace(&mut self.eval.constant, true);
        let found = self.shape_inside(e, view);
        self.eval.constant = before;
        found
    }

    fn shape_inside(&mut self, e: &'a Expr, view: View) -> Option<Vec<usize>> {
        use crate::syntax::ast::BinaryOp as B;
        match &e.kind {
            ExprKind::Reference(r) if r.parts.len() == 1 && r.parts[0].name.name == "time" => Some(Vec::new()),
            ExprKind::Reference(_) => self.declared_dims(e, view),
            ExprKind::Integer(_) | ExprKind::Real(_) | ExprKind::Boolean(_) => Some(Vec::new()),
            ExprKind::Unary(_, a) => self.shape_inside(a, view),
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.shape_inside(a, view)?, self.shape_inside(b, view)?);
                match (op, a.len(), b.len()) {
                    (_, 0, 0) | (B::Pow, ..) => Some(a),
                    (_, 0, _) => Some(b),
                    (_, _, 0) => Some(a),
                    (B::Mul, 2, 2) => Some(vec![a[0], b[1]]),
                    (B::Mul, 2, 1) => Some(vec![a[0]]),
                    (B::Mul, 1, 2) => Some(vec![b[1]]),
                    (B::Mul, 1, 1) => Some(Vec::new()),
                    _ => Some(a),
                }
            }
            ExprKind::Array(items) => {
                let inner = items.iter().find_map(|e| self.shape_inside(e, view))?;
                Some(std::iter::once(items.len()).chain(inner).collect())
            }
            ExprKind::Matrix(rows) => {
                let mut all = [0, 0];
                for row in rows {
                    let mut width = 0;
                    let mut height = 1;
                    for e in row {
                        let part = self.shape_inside(e, view)?;
                        height = part.first().copied().unwrap_or(1);
                        width += part.get(1).copied().unwrap_or(1);
                    }
                    all = [all[0] + height, width];
                }
                Some(all.to_vec())
            }
            ExprKind::If { branches, otherwise } => {
                for (condition, value) in branches {
                    let mark = self.diagnostics.len();
                    let known = self.constant_boolean(condition, view);
                    self.diagnostics.truncate(mark);
                    if known != Some(false) {
                        return self.shape_inside(value, view);
                    }
                }
                self.shape_inside(otherwise, view)
            }
            ExprKind::Call { function, args, .. } if function.parts.len() == 1 => {
                match function.parts[0].name.name.as_str() {
                    "fill" => {
                        let inner = self.shape_inside(args.first()?, view)?;
                        let mark = self.diagnostics.len();
                        let outer: Option<Vec<usize>> = args[1..].iter().map(|e| self.dimension(e, view)).collect();
                        self.diagnostics.truncate(mark);
                        Some(outer?.into_iter().chain(inner).collect())
                    }
                    "noEvent" | "pre" | "der" | "abs" | "sqrt" | "sin" | "cos" | "exp" => {
                        self.shape_inside(args.first()?, view)
                    }
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn dynamic_selection(&mut self, at: &Selection, r: &'a Reference, part: usize, view: View) -> Option<Val> {
        let mut value = self.selection_value(at, r.span)?;
        value = self.subscript_by(value, &r.parts[part].subscripts, &at.by, view, r.span)?;
        for p in &r.parts[part + 1..] {
            value = self.field(&value, p.name.name, p.name.span)?;
            value = self.subscript(value, &p.subscripts, view, r.span)?;
        }
        Some(value)
    }

    pub(in crate::instance) fn subscript_selection(
        &mut self,
        at: &Selection,
        p: &'a ReferencePart,
        view: View,
        span: Span,
    ) -> Option<Result<Selection, ()>> {
        if p.subscripts.len() > at.own {
            let message = if at.own == 0 {
                format!("`{}` is not an array", p.name.name)
            } else {
                format!("`{}` has {} dimensions, not {}", p.name.name, at.own, p.subscripts.len())
            };
            return self.fail(Code::BadIndex, &message, span);
        }
        // Indices belong to the component just named: the last dimensions came with it.
        let own = at.dims.len() - at.own;
        let mut picks: Vec<Pick> = at.dims[..own].iter().map(|&n| Pick::Many((0..n).collect())).collect();
        for ((s, &size), &by) in p.subscripts.iter().zip(&at.dims[own..]).zip(&*at.by) {
            match self.index(s, (size, Some(by)), view, span)? {
                Pick::Symbolic(_) => return Some(Err(())),
                known => picks.push(known),
            }
        }
        picks.extend(at.dims[picks.len()..].iter().map(|&n| Pick::Many((0..n).collect())));
        let (dims, places) = crate::instance::expressions::places(&at.dims, &picks);
        let nodes = places.into_iter().map(|i| at.nodes[i]).collect();
        Some(Ok(Selection { dims, own: 0, by: Rc::from([]), nodes }))
    }

    /// One step down: a component or class inside the selected components.
    fn descend(&mut self, at: &Selection, p: &ReferencePart) -> Descent<'a> {
        let name = p.name.name;
        let mut nodes = Vec::new();
        let mut inner: Option<(Vec<usize>, Rc<[Type]>)> = None;
        for &node in &*at.nodes {
            let Node::Object(scope) = *self.node(node) else {
                let whole = self.node_name(node);
                self.report(
                    Diagnostic::new(Code::UnknownName, format!("`{whole}` has no element `{}`", short(name.as_str())))
                        .at(p.name.span, "it is a simple variable"),
                );
                return Descent::Failed;
            };
            let template = self.scope(scope).template.clone();
            let Some(&i) = template.by_name.get(&name) else {
                self.unknown_member(scope, name, p.name.span);
                return Descent::Failed;
            };
            if template.elements[i as usize].protected {
                self.protected_element(scope, name, p.name.span);
            }
            if matches!(template.elements[i as usize].kind, Kind::Class(_)) {
                let owner = View { scope, base: 0 };
                return match self.lookup(owner, name) {
                    Some(found) => Descent::Class(found),
                    None => Descent::Failed,
                };
            }
            let child = match self.component(scope, i) {
                Some(c) => c,
                None => {
                    if !self.diagnostics.iter().any(Diagnostic::is_error) {
                        let whole = self.scope(scope).name.clone();
                        self.report(
                            Diagnostic::new(
                                Code::UnknownName,
                                format!("the conditional component `{name}` of `{whole}` is not there"),
                            )
                            .at(p.name.span, "its condition is false"),
                        );
                    }
                    return Descent::Failed;
                }
            };
            let chosen = self.selection(child);
            if inner.as_ref().is_some_and(|(d, _)| *d != chosen.dims) {
                self.fail::<()>(
                    Code::SizeMismatch,
                    "the elements of this array have parts of different sizes",
                    p.name.span,
                );
                return Descent::Failed;
            }
            inner = Some((chosen.dims, chosen.by));
            nodes.extend_from_slice(&chosen.nodes);
        }
        let (inner, by) = inner.unwrap_or_else(|| (Vec::new(), Rc::from([])));
        let own = inner.len();
        let dims = at.dims.iter().copied().chain(inner).collect();
        Descent::Nodes(Selection { dims, own, by, nodes: nodes.into() })
    }

    fn protected_element(&mut self, scope: ScopeId, name: Symbol, span: Span) {
        let (instance, class) = (self.scope(scope).name.clone(), self.scope(scope).template.class);
        let class = self.library.full_name(class);
        self.report(
            Diagnostic::new(Code::UnknownName, format!("`{instance}.{name}` is protected"))
                .at(span, format!("`{class}` keeps this element to itself"))
                .instance(instance)
                .class(class)
                .help("use a public variable, or declare it above `protected` in its class"),
        );
    }

    fn unknown_member(&mut self, scope: ScopeId, name: Symbol, span: Span) {
        let s = self.scope(scope);
        let template = s.template.clone();
        let instance = s.name.clone();
        let class = self.library.full_name(template.class);
        let names: Vec<Symbol> = template.elements.iter().filter(|e| !e.protected).map(|e| e.name).collect();
        let mut d = Diagnostic::new(Code::UnknownName, format!("`{instance}` has no `{}`", short(name.as_str())))
            .at(span, format!("`{class}` has no element of this name"))
            .instance(instance)
            .class(class);
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(list_names("it has", &names)),
        };
        self.report(d);
    }

    /// The name of a component as the user knows it.
    pub fn node_name(&self, node: NodeId) -> String {
        match self.node(node) {
            Node::Var(i) => self.variables[*i as usize].name.clone(),
            Node::Object(s) => self.scope(*s).name.clone(),
            Node::Array { elements, .. } => {
                let first = elements.first().map_or(String::new(), |&e| self.node_name(e));
                first.rsplit_once('[').map_or(first.clone(), |(head, _)| head.to_string())
            }
        }
    }

    /// The value of a class reference: a constant of a package, a literal of an enumeration.
    fn class_value(&mut self, mut found: Found<'a>, r: &'a Reference, view: View) -> Option<Val> {
        for (i, part) in r.parts.iter().enumerate().skip(1) {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            let inside = self.member(&found, part.name.name);
            if let Some(inside) = &inside {
                self.check_member(&found, inside, part.name);
            }
            match inside {
                Some(Found::Component(scope, index)) => {
                    if let Found::Class(c) = &found
                        && self.library.class(c.class).prefixes.partial
                    {
                        let name = self.library.full_name(c.class);
                        let d = Diagnostic::new(
                            Code::Partial,
                            format!("`{name}` is partial: its constants may be missing"),
                        );
                        let d = d.at(r.span, "read here").help("name a package that extends it");
                        self.report(d.note("Modelica 3.6, 5.3.2"));
                        return None;
                    }
                    let node = self.element_node(scope, index, r)?;
                    return self.select_value(node, r, i, view);
                }
                Some(next) => found = next,
                None => {
                    self.unknown_in_class(&found, part);
                    return None;
                }
            }
        }
        if let Found::Class(class) = &found
            && let Some(function) = self.function_value(class, Vec::new())
        {
            return Some(function);
        }
        self.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    /// The rest of a reference that reached a class inside a component.
    fn class_tail(&mut self, mut found: Found<'a>, r: &Reference, _view: View) -> Option<Val> {
        for part in &r.parts[1..] {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            match self.member(&found, part.name.name)? {
                Found::Component(scope, index) => {
                    let node = self.element_node(scope, index, r)?;
                    let at = self.selection(node);
                    return self.by_value(|s| s.selection_value(&at, r.span));
                }
                next => found = next,
            }
        }
        self.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    fn by_value<T>(&mut self, f: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.eval.constant, true);
        let value = f(self);
        self.eval.constant = before;
        value
    }

    fn literal(&mut self, found: &Found<'a>, name: Symbol) -> Option<Val> {
        let builtin = match found {
            Found::Builtin(b) => *b,
            Found::Class(c) => self.template(c.class, c.parent).builtin?,
            Found::Component(..) => return None,
        };
        let Builtin::Enumeration(i) = builtin else { return None };
        let k = self.enumerations[i as usize].literals.iter().position(|l| *l == name)?;
        Some(Val::Scalar(self.exprs.num(k as f64 + 1.0), Type::Enumeration(i)))
    }

    fn unknown_in_class(&mut self, found: &Found<'a>, part: &ReferencePart) {
        let (class, mut names) = match found {
            Found::Class(c) => {
                let t = self.template(c.class, c.parent);
                let literals = match t.builtin {
                    Some(Builtin::Enumeration(i)) => self.enumerations[i as usize].literals.clone(),
                    _ => Vec::new(),
                };
                let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).chain(literals).collect();
                (self.library.full_name(c.class), names)
            }
            Found::Builtin(Builtin::Enumeration(i)) => {
                let e = &self.enumerations[*i as usize];
                (e.name.clone(), e.literals.clone())
            }
            _ => ("this type".into(), Vec::new()),
        };
        if let Found::Class(c) = found {
            names.extend(self.library.folder_members(c.class));
        }
        let name = part.name.name;
        let mut d = Diagnostic::new(Code::UnknownName, format!("`{class}` has no `{}`", short(name.as_str())))
            .at(part.name.span, "not found");
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(list_names("it has", &names)),
        };
        self.report(d);
    }

    /// The value of selected components.
    pub(in crate::instance) fn selection_value(&mut self, at: &Selection, span: Span) -> Option<Val> {
        let values: Option<Vec<Val>> = at.nodes.iter().map(|&n| self.node_value(n, span)).collect();
        let mut values = values?;
        if at.dims.is_empty() {
            return values.pop();
        }
        Some(Val::array(at.dims.clone(), values))
    }

    /// The value of a component: a variable, or a record.
    pub fn node_value(&mut self, node: NodeId, span: Span) -> Option<Val> {
        match self.node(node) {
            Node::Var(i) => self.variable_value(*i, span),
            Node::Array { .. } => {
                let at = self.selection(node);
                self.selection_value(&at, span)
            }
            Node::Object(scope) => self.record_value(*scope, span),
        }
    }

    fn record_value(&mut self, scope: ScopeId, span: Span) -> Option<Val> {
        let template = self.scope(scope).template.clone();
        if !matches!(template.kind, ClassKind::Record { .. } | ClassKind::Connector { .. }) {
            let name = self.scope(scope).name.clone();
            let class = self.library.full_name(template.class);
            self.report(
                Diagnostic::new(Code::TypeMismatch, format!("`{name}` is a component, not a value"))
                    .at(span, format!("an instance of `{class}`"))
                    .help("name one of its variables"),
            );
            return None;
        }
        let mut fields = Vec::new();
        for (i, element) in (0u32..).zip(&template.elements) {
            if matches!(element.kind, Kind::Component(_))
                && let Some(node) = self.component(scope, i)
            {
                fields.push((element.name, self.node_value(node, span)?));
            }
        }
        let class = self.operator_class_of(&template);
        Some(Val::Record(Rc::new(crate::instance::value::Record { fields, class })))
    }

    /// The value of a scalar variable: itself, or its number where values count.
    fn variable_value(&mut self, i: u32, span: Span) -> Option<Val> {
        let data = &self.variables[i as usize];
        // Constants of packages are not part of the model, so only their value can stand in it.
        let by_value = data.string
            || data.object
            || (data.variability <= Variability::Parameter && (self.eval.constant || data.id.0 == u32::MAX));
        if by_value {
            return self.known_value(i, span);
        }
        if self.eval.constant {
            let name = data.name.clone();
            let declared = data.span;
            self.report(
                Diagnostic::new(Code::NotConstant, format!("`{name}` is not known before the run"))
                    .at(span, "a constant or parameter is needed here")
                    .at(declared, "declared here as a variable")
                    .help(format!("declare `{name}` as `parameter`, or use something that is one")),
            );
            return None;
        }
        let (id, ty) = (data.id, data.ty);
        if id.0 == u32::MAX {
            let (name, declared) = (data.name.clone(), data.span);
            let d = Diagnostic::new(Code::Restricted, format!("`{name}` belongs to no component"));
            let d = d.at(span, "used here").at(declared, "declared here, in a class that is used as a package");
            self.report(d.note("Modelica 3.6, 4.6").help("declare it `constant`, or in the model"));
            return None;
        }
        Some(Val::Scalar(self.exprs.var(id), ty))
    }

    /// The value of a constant or parameter.
    pub(in crate::instance) fn known_value(&mut self, i: u32, span: Span) -> Option<Val> {
        let data = &mut self.variables[i as usize];
        if let Some(known) = &data.constant {
            return known.clone().ok();
        }
        if data.busy {
            let (name, declared) = (data.name.clone(), data.span);
            self.report(
                Diagnostic::new(Code::CyclicParameter, format!("`{name}` depends on itself"))
                    .at(declared, "its value leads back to itself")
                    .at(span, "used here")
                    .help("give one of the parameters of the circle a number"),
            );
            return None;
        }
        data.busy = true;
        data.structural = true;
        let value = self.find_known(i, span);
        let data = &mut self.variables[i as usize];
        data.busy = false;
        data.constant = Some(value.clone().ok_or(()));
        value
    }

    fn find_known(&mut self, i: u32, span: Span) -> Option<Val> {
        let data = &self.variables[i as usize];
        let (name, declared, ty) = (data.name.clone(), data.span, data.ty);
        let start = data.attributes.iter().find(|(n, _)| *n == "start").map(|(_, b)| b.clone());
        match data.binding.clone().or(start) {
            Some(b) => {
                let value = self.bound(i, &b, true)?;
                self.coerce(value, ty, &name, b.expr.span)
            }
            None => {
                self.report(
                    Diagnostic::new(Code::NoValue, format!("`{name}` has no value"))
                        .at(declared, "declared without `= value`")
                        .at(span, "its value is needed here")
                        .instance(name.clone())
                        .help(format!(
                            "give it one where it is used, as in `({} = ...)`, or with `--set {name}=...`",
                            name.rsplit('.').next().unwrap_or(&name)
                        )),
                );
                None
            }
        }
    }

    /// The value bound to a variable; a quantity given from outside is converted to the variable's unit.
    pub fn bound(&mut self, i: u32, b: &Binding<'a>, constant: bool) -> Option<Val> {
        if Some(b.expr.span.file) == self.eval.override_file
            && let Some(v) = self.outside_value(i, b)
        {
            return v;
        }
        let value = self.binding_value(b, constant)?;
        let data = &self.variables[i as usize];
        match (data.string, &value) {
            (false, Val::Text(_) | Val::Object(_)) if !data.object => {
                let name = data.name.clone();
                let message = format!("`{name}` is {} and cannot take {}", type_name(data.ty), value.describe());
                let numeric = data.ty == Type::Real;
                let mut d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
                if numeric {
                    d = d.help("write a number without quotes, in the SI unit of the variable: 200 bar are `200e5`; only `--set` and experiment files take units");
                }
                self.report(d);
                None
            }
            (_, other) if data.object && !matches!(other, Val::Object(_)) => {
                let name = data.name.clone();
                let message = format!("`{name}` is an external object and cannot take {}", value.describe());
                self.report(Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name));
                None
            }
            (true, other) if !matches!(other, Val::Text(_)) => {
                let name = data.name.clone();
                let message = format!("`{name}` is a String and cannot take {}", value.describe());
                let d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
                self.report(d.help("write a text in quotes; `String(x)` makes one of a number"));
                None
            }
            _ => Some(value),
        }
    }

    /// Values from outside may be quantities with units, literals of the variable's own enumeration, and texts without
    /// quotes.
    fn outside_value(&mut self, i: u32, b: &Binding<'a>) -> Option<Option<Val>> {
        let data = &self.variables[i as usize];
        if data.string && !matches!(b.expr.kind, ExprKind::String(_)) {
            return self.eval.texts.get(&data.name).map(|raw| Some(Val::text(raw.trim())));
        }
        match &b.expr.kind {
            ExprKind::Call { function, args, .. } if function.parts[0].name.name == QUANTITY => {
                let (number, unit) = (self.eval(&args[0], b.view)?, self.eval(&args[1], b.view)?);
                let x = number.as_number(&self.exprs)?;
                let unit = unit.as_text(&self.exprs)?;
                Some(self.converted(i, x, &unit).map(|x| Val::Scalar(self.exprs.num(x), Type::Real)))
            }
            ExprKind::Reference(r) if r.parts.len() == 1 => {
                let Type::Enumeration(e) = self.variables[i as usize].ty else { return None };
                let at = self.enumerations[e as usize].literals.iter().position(|l| *l == r.parts[0].name.name)?;
                Some(Some(Val::Scalar(self.exprs.num(at as f64 + 1.0), Type::Enumeration(e))))
            }
            _ => None,
        }
    }

    fn converted(&mut self, i: u32, x: f64, unit: &str) -> Option<f64> {
        let name = self.variables[i as usize].name.clone();
        let own = self.text_attribute(i, "unit").unwrap_or_default();
        let parsed = (crate::units::Unit::parse(unit), crate::units::Unit::parse(&own));
        let converted = match parsed {
            (Ok(from), Ok(to)) => from.convert(x, &to),
            _ => None,
        };
        if converted.is_none() {
            self.report(
                Diagnostic::new(Code::BadSet, format!("`{x} {unit}` cannot be given to `{name}`"))
                    .note(if own.is_empty() {
                        format!("`{name}` has no unit")
                    } else {
                        format!("`{name}` is in `{own}`")
                    })
                    .help("give a plain number in the variable's own unit, or a unit of the same kind"),
            );
        }
        converted
    }

    /// An attribute that is a text, such as `unit`.
    pub fn text_attribute(&mut self, i: u32, attribute: &str) -> Option<String> {
        let found = self.variables[i as usize].attributes.iter().find(|(n, _)| *n == attribute);
        let b = found.map(|(_, b)| b.clone())?;
        if let (ExprKind::String(s), true) = (&b.expr.kind, b.access.is_empty()) {
            return Some(s.to_string());
        }
        let value = self.binding_value(&b, true)?;
        let text = value.as_text(&self.exprs);
        let reported = |d: &Diagnostic| d.labels.first().is_some_and(|l| l.span == b.expr.span);
        if text.is_none() && !self.diagnostics.iter().any(reported) {
            let name = self.variables[i as usize].name.clone();
            let message = format!("`{attribute}` of `{name}` is a String and cannot take {}", value.describe());
            let d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
            self.report(d.help(format!("write a text in quotes, as in `{attribute} = \"...\"`")));
        }
        text
    }

    /// An attribute that must be known while the model is built, such as `fixed`.
    pub fn known_attribute(&mut self, i: u32, attribute: Symbol, b: &Binding<'a>, ty: Type) -> Option<f64> {
        let value = self.binding_value(b, true)?;
        let name = format!("{}.{attribute}", self.variables[i as usize].name);
        self.coerce(value, ty, &name, b.expr.span)?.as_number(&self.exprs)
    }

    /// Texts have no place in the flat model: those of the model's own parameters are looked at here, read or not.
    pub fn check_texts(&mut self) {
        for i in 0..u32::try_from(self.variables.len()).expect("limited above") {
            let data = &self.variables[i as usize];
            let given = data.binding.is_some() || data.variability <= Variability::Parameter;
            if data.string && given && data.constant.is_none() && self.scope(data.scope).component {
                let span = data.span;
                self.known_value(i, span);
            }
        }
    }

    pub(in crate::instance) fn type_words(&self, ty: Type) -> String {
        match ty {
            Type::Enumeration(i) => format!("an enumeration `{}`", short(&self.enumerations[i as usize].name)),
            other => type_name(other).into(),
        }
    }

    /// Checks a value against the type of the variable that takes it.
    pub fn coerce(&mut self, value: Val, ty: Type, name: &str, span: Span) -> Option<Val> {
        match &value {
            Val::Text(_) | Val::Object(_) => Some(value),
            Val::Scalar(e, own) => match (own, ty) {
                (a, b) if *a == b => Some(value),
                (Type::Integer, Type::Real) => Some(Val::Scalar(*e, Type::Real)),
                _ => {
                    let (wanted, given) = (self.type_words(ty), self.type_words(*own));
                    let d =
                        Diagnostic::new(Code::TypeMismatch, format!("`{name}` is {wanted} and cannot take {given}"))
                            .at(span, "the value")
                            .help(conversion(*own, ty));
                    self.report(d.instance(name.to_string()));
                    None
                }
            },
            _ => {
                let d = Diagnostic::new(
                    Code::SizeMismatch,
                    format!("`{name}` is a single value, {}, and cannot take {}", type_name(ty), value.describe()),
                )
                .at(span, "the value");
                self.report(d.instance(name.to_string()));
                None
            }
        }
    }
}

/// How a value of one type is made one of another.
fn conversion(from: Type, to: Type) -> &'static str {
    match (from, to) {
        (Type::Real, Type::Integer) => {
            "`integer(x)` is the whole number below `x`, `div(a, b)` divides whole numbers; or declare it as Real"
        }
        (Type::Real | Type::Integer, Type::Boolean) => "write a relation, as in `x > 0`, or `true` and `false`",
        (Type::Boolean, Type::Real | Type::Integer) => "write `if b then 1 else 0`",
        (Type::Enumeration(_), Type::Real | Type::Integer) => "`Integer(e)` is the number of an enumeration value",
        (_, Type::Enumeration(_)) => "give one of the literals of its type, as in `Type.literal`",
        _ => "declare both with the same type",
    }
}

fn type_name(ty: Type) -> &'static str {
    match ty {
        Type::Real => "a Real",
        Type::Integer => "an Integer",
        Type::Boolean => "a Boolean",
        Type::Enumeration(_) => "an enumeration",
    }
}

enum Descent<'a> {
    Nodes(Selection),
    Class(Found<'a>),
    Failed,
}

impl<'a> Instance<'a, '_> {
    /// The ports a reference names, starting from an element; `Some(None)` if a conditional component on the way is
    /// absent, for then the connection vanishes.
    pub fn port_selection(
        &mut self,
        r: &'a Reference,
        scope: ScopeId,
        index: u32,
        view: View,
    ) -> Option<Option<Selection>> {
        let Some(node) = self.component(scope, index) else {
            let absent = matches!(self.scope(scope).elements[index as usize], ElementState::Absent);
            return absent.then_some(None);
        };
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate() {
            if i > 0 {
                if self.any_absent(&at, p.name.name) {
                    return Some(None);
                }
                match self.descend(&at, p) {
                    Descent::Nodes(next) => at = next,
                    _ => return None,
                }
            }
            if !p.subscripts.is_empty() {
                match self.subscript_selection(&at, p, view, r.span)? {
                    Ok(next) => at = next,
                    Err(()) => {
                        return self.fail(
                            Code::NotConstant,
                            "the index of a port must be known before the run",
                            r.span,
                        );
                    }
                }
            }
        }
        Some(Some(at))
    }

    /// The one component that a reference names.
    pub(in crate::instance) fn named_node(&mut self, r: &'a Reference, view: View) -> Option<NodeId> {
        let from = if r.global { crate::instance::ROOT } else { view };
        let Found::Component(scope, index) = self.lookup(from, r.parts[0].name.name)? else { return None };
        let mut node = self.component(scope, index)?;
        for (i, part) in r.parts.iter().enumerate() {
            if i > 0 {
                let Node::Object(s) = *self.node(node) else { return None };
                let index = *self.scope(s).template.by_name.get(&part.name.name)?;
                node = self.component(s, index)?;
            }
            if !part.subscripts.is_empty() {
                let at = self.selection(node);
                let [one] = self.subscript_selection(&at, part, view, r.span)?.ok()?.nodes[..] else { return None };
                node = one;
            }
        }
        Some(node)
    }

    fn any_absent(&mut self, at: &Selection, name: Symbol) -> bool {
        at.nodes.iter().any(|&n| {
            let Node::Object(s) = *self.node(n) else { return false };
            let Some(&i) = self.scope(s).template.by_name.get(&name) else { return false };
            matches!(self.scope(s).elements[i as usize], ElementState::Absent)
        })
    }

    /// Runs something for every value of the iterators, innermost last.
    pub fn for_each(
        &mut self,
        iterators: &'a [crate::syntax::ast::Iterator],
        repeated: Body<'a>,
        view: View,
        body: &mut dyn FnMut(&mut Self),
    ) {
        let Some((first, rest)) = iterators.split_first() else { return body(self) };
        let Some(values) = self.iterate(first, repeated, view) else { return };
        for value in values {
            self.eval.locals.push((first.name.name, value));
            self.for_each(rest, repeated, view, body);
            self.eval.locals.pop();
        }
    }
}

/// Doors for `flat`, which walks the equations.
impl<'a> Instance<'a, '_> {
    /// The values of a loop variable.
    pub fn loop_values(
        &mut self,
        iterator: &'a crate::syntax::ast::Iterator,
        body: &'a [crate::syntax::ast::Equation],
        view: View,
    ) -> Option<Vec<Val>> {
        self.iterate(iterator, Body::Equations(body), view)
    }

    /// Enters a loop variable.
    pub fn push_local(&mut self, name: Symbol, value: Val) {
        self.eval.locals.push((name, value));
    }

    /// Leaves the innermost loop variable.
    pub fn pop_local(&mut self) {
        self.eval.locals.pop();
    }

    /// Switches events of relations off or on; returns what was before.
    pub fn set_no_event(&mut self, off: bool) -> bool {
        std::mem::replace(&mut self.eval.no_event, off)
    }

    /// The whole value of an element named in an algorithm section.
    pub fn element_value(&mut self, view: View, part: &ReferencePart) -> Option<Val> {
        match self.lookup(view, part.name.name) {
            Some(Found::Component(scope, index)) => {
                let node = self.component(scope, index)?;
                self.node_value(node, part.name.span)
            }
            _ => {
                let names = self.visible_names(view);
                self.unknown_name(part.name.name, part.name.span, &names);
                None
            }
        }
    }

    /// Carries out an algorithm section of the model on the `count` locals that were pushed for it.
    pub fn run_section(
        &mut self,
        section: &'a [crate::syntax::ast::Statement],
        view: View,
        count: usize,
    ) -> Option<()> {
        self.eval.work = Work::allowed([MOST_SECTION_STEPS, MOST_SECTION_STEPS]);
        self.eval.not_inline = false;
        let end = self.eval.locals.len();
        self.eval.section = end - count..end;
        self.eval.calls.clear();
        self.eval.guards.clear();
        let done = self.execute(section, view).map(|_| ());
        self.eval.section = 0..0;
        done
    }

    /// Calls a function for what it asserts.
    pub fn call_keeping_assertions(&mut self, call: &'a Expr, view: View) -> Vec<crate::instance::algorithm::AlgorithmCall> {
        let before = std::mem::replace(&mut self.eval.keep_asserts, true);
        self.eval.calls.clear();
        self.eval_all(call, view);
        self.eval.keep_asserts = before;
        std::mem::take(&mut self.eval.calls)
    }

    /// Removes the last locals and hands out their values.
    pub fn take_locals(&mut self, count: usize) -> Vec<Val> {
        let at = self.eval.locals.len() - count;
        self.eval.locals.split_off(at).into_iter().map(|(_, v)| v).collect()
    }

    /// What must hold besides equations, and `terminate`s, met outside `when` since the last call.
    pub fn take_calls(&mut self) -> Vec<crate::instance::algorithm::AlgorithmCall> {
        std::mem::take(&mut self.eval.calls)
    }

    /// The `when`s met since the last call.
    pub fn take_whens(&mut self) -> Vec<crate::instance::algorithm::AlgorithmWhen> {
        std::mem::take(&mut self.eval.whens)
    }
}
