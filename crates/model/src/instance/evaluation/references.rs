//! Component references: `a.b[i].c` to the variables it means.

use crate::instance::errors::{list_names, nearest, short};
use crate::instance::evaluation::indices::Pick;
use crate::instance::lookup::{Builtin, Found};
use crate::instance::template::Kind;
use crate::instance::value::Val;
use crate::instance::{ElementState, Evaluator, Node, NodeId, ScopeId, View};
use bramah_expr::types::{Type, Variability};
use bramah_syntax::ast::{ClassKind, Reference, ReferencePart, Subscript};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

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

impl<'a> Evaluator<'_, 'a, '_> {
    /// The value of a reference.
    pub(in crate::instance) fn reference(&mut self, r: &'a Reference, view: View) -> Option<Val> {
        let first = &r.parts[0];
        if !r.global {
            if let Some(i) = self.instance.local(first.name.name)
                && !(self.instance.eval.section.contains(&i) && lies_beside(&self.instance.eval.locals[i].1, r))
            {
                let value = self.instance.eval.locals[i].1.clone();
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
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "`time` is not known before the run", span);
        }
        Some(Val::Scalar(self.instance.exprs.time(), Type::Real))
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
        let Some(Found::Component(scope, index)) = self.instance.names().lookup(view, name) else { return Vec::new() };
        let template = self.instance.scope(scope).template.clone();
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
            _ => self.instance.fail(Code::UnknownName, &format!("{} has no field `{name}`", value.describe()), span),
        }
    }

    /// What the first part of a reference means, or a message.
    fn start(&mut self, r: &Reference, view: View) -> Option<Found<'a>> {
        let name = r.parts[0].name;
        let found = if r.global {
            self.instance.names().lookup(crate::instance::ROOT, name.name)
        } else {
            self.instance.names().lookup(view, name.name)
        };
        if found.is_none() {
            let names = self.visible_names(view);
            self.unknown_name(name.name, name.span, &names);
        }
        if let Some(Found::Component(scope, index)) = found
            && !r.global
            && self.is_variable_around(view, scope, index)
        {
            let class = self.instance.scope(view.scope).template.class;
            let class = self.instance.library.full_name(class);
            self.instance.report(
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
        while let Some(base) =
            self.instance.scope(view.scope).template.bases.get(view.base as usize).filter(|b| b.short)
        {
            view = base.parent;
        }
        let (found, from) = (self.instance.scope(scope), self.instance.scope(view.scope));
        if scope == view.scope || !found.component || matches!(from.template.kind, ClassKind::Function { .. }) {
            return false;
        }
        match found.template.elements[index as usize].kind {
            Kind::Component(c) => {
                let constant = Some(bramah_syntax::ast::Variability::Constant);
                c.prefix.variability != constant && found.prefix.variability != constant
            }
            Kind::Class(_) => false,
        }
    }

    pub(in crate::instance) fn unknown_name(&mut self, name: Symbol, span: Span, names: &[Symbol]) {
        let mut d = Diagnostic::new(Code::UnknownName, format!("there is no `{}` here", short(name.as_str())))
            .at(span, "not found");
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.meant(near),
            None => d.help(list_names("known here are", names)),
        };
        self.instance.report(d);
    }

    pub(in crate::instance) fn visible_names(&self, view: View) -> Vec<Symbol> {
        let frame = self.instance.eval.frame;
        let mut names: Vec<Symbol> = self.instance.eval.locals[frame..].iter().map(|(n, _)| *n).collect();
        names.extend(self.instance.scope(view.scope).template.elements.iter().map(|e| e.name));
        names
    }

    /// The node of an element, with a message when it is absent.
    fn element_node(&mut self, scope: ScopeId, index: u32, r: &Reference) -> Option<NodeId> {
        let busy = matches!(self.instance.scope(scope).elements[index as usize], ElementState::Busy);
        if let Some(node) = self.instance.builder().component(scope, index) {
            return Some(node);
        }
        let name = self.instance.scope(scope).template.elements[index as usize].name;
        if busy {
            self.instance.report(
                Diagnostic::new(Code::CyclicParameter, format!("`{name}` is needed to build itself"))
                    .at(r.span, "used here while its size or condition is being found"),
            );
        } else if !self.instance.diagnostics.iter().any(Diagnostic::is_error) {
            self.instance.report(
                Diagnostic::new(Code::UnknownName, format!("the conditional component `{name}` is not there"))
                    .at(r.span, "its condition is false")
                    .help("use it only in `connect`, which vanishes with it, or under the same condition"),
            );
        }
        None
    }

    /// A node as a selection.
    pub fn selection(&self, node: NodeId) -> Selection {
        match self.instance.node(node) {
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
            return self.instance.fail(Code::BadIndex, &message, span);
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
        let (dims, places) = crate::instance::evaluation::indices::places(&at.dims, &picks);
        let nodes = places.into_iter().map(|i| at.nodes[i]).collect();
        Some(Ok(Selection { dims, own: 0, by: Rc::from([]), nodes }))
    }

    /// One step down: a component or class inside the selected components.
    pub(in crate::instance) fn descend(&mut self, at: &Selection, p: &ReferencePart) -> Descent<'a> {
        let name = p.name.name;
        let mut nodes = Vec::new();
        let mut inner: Option<(Vec<usize>, Rc<[Type]>)> = None;
        for &node in &*at.nodes {
            let Node::Object(scope) = *self.instance.node(node) else {
                let whole = self.instance.node_name(node);
                self.instance.report(
                    Diagnostic::new(Code::UnknownName, format!("`{whole}` has no element `{}`", short(name.as_str())))
                        .at(p.name.span, "it is a simple variable"),
                );
                return Descent::Failed;
            };
            let template = self.instance.scope(scope).template.clone();
            let Some(&i) = template.by_name.get(&name) else {
                self.unknown_member(scope, name, p.name.span);
                return Descent::Failed;
            };
            if template.elements[i as usize].protected {
                self.protected_element(scope, name, p.name.span);
            }
            if matches!(template.elements[i as usize].kind, Kind::Class(_)) {
                let owner = View { scope, base: 0 };
                return match self.instance.names().lookup(owner, name) {
                    Some(found) => Descent::Class(found),
                    None => Descent::Failed,
                };
            }
            let child = match self.instance.builder().component(scope, i) {
                Some(c) => c,
                None => {
                    if !self.instance.diagnostics.iter().any(Diagnostic::is_error) {
                        let whole = self.instance.scope(scope).name.clone();
                        self.instance.report(
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
                self.instance.evaluator().instance.fail::<()>(
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
        let (instance, class) = (self.instance.scope(scope).name.clone(), self.instance.scope(scope).template.class);
        let class = self.instance.library.full_name(class);
        self.instance.report(
            Diagnostic::new(Code::UnknownName, format!("`{instance}.{name}` is protected"))
                .at(span, format!("`{class}` keeps this element to itself"))
                .instance(instance)
                .class(class)
                .help("use a public variable, or declare it above `protected` in its class"),
        );
    }

    fn unknown_member(&mut self, scope: ScopeId, name: Symbol, span: Span) {
        let s = self.instance.scope(scope);
        let template = s.template.clone();
        let instance = s.name.clone();
        let class = self.instance.library.full_name(template.class);
        let names: Vec<Symbol> = template.elements.iter().filter(|e| !e.protected).map(|e| e.name).collect();
        let mut d = Diagnostic::new(Code::UnknownName, format!("`{instance}` has no `{}`", short(name.as_str())))
            .at(span, format!("`{class}` has no element of this name"))
            .instance(instance)
            .class(class);
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.meant(near),
            None => d.help(list_names("it has", &names)),
        };
        self.instance.report(d);
    }

    /// The value of a class reference: a constant of a package, a literal of an enumeration.
    fn class_value(&mut self, mut found: Found<'a>, r: &'a Reference, view: View) -> Option<Val> {
        for (i, part) in r.parts.iter().enumerate().skip(1) {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            let inside = self.instance.names().member(&found, part.name.name);
            if let Some(inside) = &inside {
                self.instance.names().check_member(&found, inside, part.name);
            }
            match inside {
                Some(Found::Component(scope, index)) => {
                    if let Found::Class(c) = &found
                        && self.instance.library.class(c.class).prefixes.partial
                    {
                        let name = self.instance.library.full_name(c.class);
                        let d = Diagnostic::new(
                            Code::Partial,
                            format!("`{name}` is partial: its constants may be missing"),
                        );
                        let d = d.at(r.span, "read here").help("name a package that extends it");
                        self.instance.report(d.note("Modelica 3.6, 5.3.2"));
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
            && let Some(function) = self.instance.calls().function_value(class, Vec::new())
        {
            return Some(function);
        }
        self.instance.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    /// The rest of a reference that reached a class inside a component.
    fn class_tail(&mut self, mut found: Found<'a>, r: &Reference, _view: View) -> Option<Val> {
        for part in &r.parts[1..] {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            match self.instance.names().member(&found, part.name.name)? {
                Found::Component(scope, index) => {
                    let node = self.element_node(scope, index, r)?;
                    let at = self.selection(node);
                    return self
                        .instance
                        .in_mode(|m| m.constant = true, |s| s.evaluator().selection_value(&at, r.span));
                }
                next => found = next,
            }
        }
        self.instance.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    fn literal(&mut self, found: &Found<'a>, name: Symbol) -> Option<Val> {
        let builtin = match found {
            Found::Builtin(b) => *b,
            Found::Class(c) => self.instance.names().template(c.class, c.parent).builtin?,
            Found::Component(..) => return None,
        };
        let Builtin::Enumeration(i) = builtin else { return None };
        let k = self.instance.enumerations[i as usize].literals.iter().position(|l| *l == name)?;
        Some(Val::Scalar(self.instance.exprs.num(k as f64 + 1.0), Type::Enumeration(i)))
    }

    fn unknown_in_class(&mut self, found: &Found<'a>, part: &ReferencePart) {
        let (class, mut names) = match found {
            Found::Class(c) => {
                let t = self.instance.names().template(c.class, c.parent);
                let literals = match t.builtin {
                    Some(Builtin::Enumeration(i)) => self.instance.enumerations[i as usize].literals.clone(),
                    _ => Vec::new(),
                };
                let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).chain(literals).collect();
                (self.instance.library.full_name(c.class), names)
            }
            Found::Builtin(Builtin::Enumeration(i)) => {
                let e = &self.instance.enumerations[*i as usize];
                (e.name.clone(), e.literals.clone())
            }
            _ => ("this type".into(), Vec::new()),
        };
        if let Found::Class(c) = found {
            names.extend(self.instance.library.folder_members(c.class));
        }
        let name = part.name.name;
        let mut d = Diagnostic::new(Code::UnknownName, format!("`{class}` has no `{}`", short(name.as_str())))
            .at(part.name.span, "not found");
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.meant(near),
            None => d.help(list_names("it has", &names)),
        };
        self.instance.report(d);
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
        match self.instance.node(node) {
            Node::Var(i) => self.variable_value(*i, span),
            Node::Array { .. } => {
                let at = self.selection(node);
                self.selection_value(&at, span)
            }
            Node::Object(scope) => self.record_value(*scope, span),
        }
    }

    fn record_value(&mut self, scope: ScopeId, span: Span) -> Option<Val> {
        let template = self.instance.scope(scope).template.clone();
        if !matches!(template.kind, ClassKind::Record { .. } | ClassKind::Connector { .. }) {
            let name = self.instance.scope(scope).name.clone();
            let class = self.instance.library.full_name(template.class);
            self.instance.report(
                Diagnostic::new(Code::TypeMismatch, format!("`{name}` is a component, not a value"))
                    .at(span, format!("an instance of `{class}`"))
                    .help("name one of its variables"),
            );
            return None;
        }
        let mut fields = Vec::new();
        for (i, element) in (0u32..).zip(&template.elements) {
            if matches!(element.kind, Kind::Component(_))
                && let Some(node) = self.instance.builder().component(scope, i)
            {
                fields.push((element.name, self.node_value(node, span)?));
            }
        }
        let class = self.instance.operators().operator_class_of(&template);
        Some(Val::Record(Rc::new(crate::instance::value::Record { fields, class })))
    }

    /// The value of a scalar variable: itself, or its number where values count.
    fn variable_value(&mut self, i: u32, span: Span) -> Option<Val> {
        let data = &self.instance.variables[i as usize];
        // Constants of packages are not part of the model, so only their value can stand in it.
        let by_value = data.string
            || data.object
            || (data.variability <= Variability::Parameter
                && (self.instance.eval.mode.constant || data.id.0 == u32::MAX));
        if by_value {
            return self.instance.parameters().known_value(i, span);
        }
        if self.instance.eval.mode.constant {
            let name = data.name.clone();
            let declared = data.span;
            self.instance.report(
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
            self.instance.report(d.note("Modelica 3.6, 4.6").help("declare it `constant`, or in the model"));
            return None;
        }
        Some(Val::Scalar(self.instance.exprs.var(id), ty))
    }
}

/// Whether a reference names a variable of a component that is no value, of which an algorithm section assigns other ones.
fn lies_beside(mut value: &Val, r: &Reference) -> bool {
    for part in &r.parts[1..] {
        value = value.elements().first().unwrap_or(value);
        let Val::Record(record) = value else { return false };
        match record.fields.iter().find(|(name, _)| *name == part.name.name) {
            Some((_, field)) => value = field,
            None => return true,
        }
    }
    false
}

pub(in crate::instance) enum Descent<'a> {
    Nodes(Selection),
    Class(Found<'a>),
    Failed,
}
