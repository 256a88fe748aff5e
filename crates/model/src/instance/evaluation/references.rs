//! Component references: `a.b[i].c` to the variables it means.

use crate::instance::errors::{list_names, nearest, short};
use crate::instance::evaluation::indices::SubscriptValue;
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::template::TemplateElementKind;
use crate::instance::value::ModelicaValue;
use crate::instance::{ElementState, Evaluator, InstanceNode, LookupContext, NodeId, ScopeId};
use bramah_expr::types::{ScalarType, Variability};
use bramah_syntax::ast::{ClassKind, ComponentReference, ReferencePart, Subscript};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// Components picked by a reference: with dimensions when arrays are passed through.
#[derive(Clone, Debug)]
pub struct NodeSelection {
    /// Sizes of the arrays passed through.
    pub dims: Vec<usize>,
    /// How many of the sizes, counted from the last, belong to the component named last.
    pub own: usize,
    /// What counts along these.
    pub by: Rc<[ScalarType]>,
    /// The components, row-major; shared, for a reference to one element of a long array passes through the whole.
    pub nodes: Rc<[NodeId]>,
}

impl<'a> Evaluator<'_, 'a, '_> {
    /// The value of a reference.
    pub(in crate::instance) fn reference(
        &mut self,
        r: &'a ComponentReference,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
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
            LookupResult::Component(scope, index) => {
                let node = self.element_node(scope, index, r)?;
                self.select_value(node, r, 0, view)
            }
            LookupResult::Class(class) => self.class_value(LookupResult::Class(class), r, view),
            LookupResult::Builtin(b) => self.class_value(LookupResult::Builtin(b), r, view),
        }
    }

    fn time(&mut self, span: Span) -> Option<ModelicaValue> {
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "`time` is not known before the run", span);
        }
        Some(ModelicaValue::Scalar(self.instance.exprs.time(), ScalarType::Real))
    }

    /// Fields and indices of a local.
    fn local_part(
        &mut self,
        mut value: ModelicaValue,
        r: &'a ComponentReference,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
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
    pub(in crate::instance) fn counted_by(&mut self, view: LookupContext, name: Symbol) -> Vec<ScalarType> {
        let Some(LookupResult::Component(scope, index)) = self.instance.names().lookup(view, name) else {
            return Vec::new();
        };
        let template = self.instance.scope(scope).template.clone();
        let element = &template.elements[index as usize];
        let TemplateElementKind::Component(declared) = element.kind else { return Vec::new() };
        let own = LookupContext { scope, base: element.base };
        let by = |s: &'a Subscript| match s {
            Subscript::Expr(e) => {
                self.enumeration_range(e, own).and_then(|v| v.first().and_then(ModelicaValue::element_type))
            }
            Subscript::All(_) => None,
        };
        declared.subscripts.iter().map(by).map(|by| by.unwrap_or(ScalarType::Integer)).collect()
    }

    /// A field of a record, or of every record of an array.
    pub(in crate::instance) fn field(
        &mut self,
        value: &ModelicaValue,
        name: Symbol,
        span: Span,
    ) -> Option<ModelicaValue> {
        match value {
            ModelicaValue::Record(record) => match record.fields.iter().find(|(n, _)| *n == name) {
                Some((_, v)) => Some(v.clone()),
                None => {
                    let names: Vec<Symbol> = record.fields.iter().map(|(n, _)| *n).collect();
                    self.unknown_name(name, span, &names);
                    None
                }
            },
            ModelicaValue::Array { dims, elements } => {
                let parts: Option<Vec<ModelicaValue>> = elements.iter().map(|v| self.field(v, name, span)).collect();
                let parts = parts?;
                let inner = parts.first().map_or(Vec::new(), |v| v.dims().to_vec());
                let all: Vec<ModelicaValue> = parts.iter().flat_map(|v| v.elements().to_vec()).collect();
                Some(ModelicaValue::array(dims.iter().copied().chain(inner).collect(), all))
            }
            _ => self.instance.fail(Code::UnknownName, &format!("{} has no field `{name}`", value.describe()), span),
        }
    }

    /// What the first part of a reference means, or a message.
    fn start(&mut self, r: &ComponentReference, view: LookupContext) -> Option<LookupResult<'a>> {
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
        if let Some(LookupResult::Component(scope, index)) = found
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
    fn is_variable_around(&self, mut view: LookupContext, scope: ScopeId, index: u32) -> bool {
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
            TemplateElementKind::Component(c) => {
                let constant = Some(bramah_syntax::ast::VariabilityPrefix::Constant);
                c.prefix.variability != constant && found.prefix.variability != constant
            }
            TemplateElementKind::Class(_) => false,
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

    pub(in crate::instance) fn visible_names(&self, view: LookupContext) -> Vec<Symbol> {
        let frame = self.instance.eval.frame;
        let mut names: Vec<Symbol> = self.instance.eval.locals[frame..].iter().map(|(n, _)| *n).collect();
        names.extend(self.instance.scope(view.scope).template.elements.iter().map(|e| e.name));
        names
    }

    /// The node of an element, with a message when it is absent.
    fn element_node(&mut self, scope: ScopeId, index: u32, r: &ComponentReference) -> Option<NodeId> {
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
    pub fn selection(&self, node: NodeId) -> NodeSelection {
        match self.instance.node(node) {
            InstanceNode::Array { dims, by, elements } => {
                NodeSelection { dims: dims.clone(), own: dims.len(), by: by.clone(), nodes: elements.clone() }
            }
            _ => NodeSelection { dims: Vec::new(), own: 0, by: Rc::from([]), nodes: Rc::from([node]) },
        }
    }

    /// Follows a reference from a component; `part` is the part that named it.
    fn select_value(
        &mut self,
        node: NodeId,
        r: &'a ComponentReference,
        part: usize,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate().skip(part) {
            if i > part {
                match self.descend(&at, p) {
                    ReferenceTarget::Nodes(next) => at = next,
                    ReferenceTarget::Class(found) => {
                        let rest = ComponentReference { global: false, parts: r.parts[i..].to_vec(), span: r.span };
                        return self.class_tail(found, &rest, view);
                    }
                    ReferenceTarget::Failed => return None,
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

    fn dynamic_selection(
        &mut self,
        at: &NodeSelection,
        r: &'a ComponentReference,
        part: usize,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
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
        at: &NodeSelection,
        p: &'a ReferencePart,
        view: LookupContext,
        span: Span,
    ) -> Option<Result<NodeSelection, ()>> {
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
        let mut picks: Vec<SubscriptValue> =
            at.dims[..own].iter().map(|&n| SubscriptValue::Many((0..n).collect())).collect();
        for ((s, &size), &by) in p.subscripts.iter().zip(&at.dims[own..]).zip(&*at.by) {
            match self.index(s, (size, Some(by)), view, span)? {
                SubscriptValue::Symbolic(_) => return Some(Err(())),
                known => picks.push(known),
            }
        }
        picks.extend(at.dims[picks.len()..].iter().map(|&n| SubscriptValue::Many((0..n).collect())));
        let (dims, places) = crate::instance::evaluation::indices::places(&at.dims, &picks);
        let nodes = places.into_iter().map(|i| at.nodes[i]).collect();
        Some(Ok(NodeSelection { dims, own: 0, by: Rc::from([]), nodes }))
    }

    /// One step down: a component or class inside the selected components.
    pub(in crate::instance) fn descend(&mut self, at: &NodeSelection, p: &ReferencePart) -> ReferenceTarget<'a> {
        let name = p.name.name;
        let mut nodes = Vec::new();
        let mut inner: Option<(Vec<usize>, Rc<[ScalarType]>)> = None;
        for &node in &*at.nodes {
            let InstanceNode::Object(scope) = *self.instance.node(node) else {
                let whole = self.instance.node_name(node);
                self.instance.report(
                    Diagnostic::new(Code::UnknownName, format!("`{whole}` has no element `{}`", short(name.as_str())))
                        .at(p.name.span, "it is a simple variable"),
                );
                return ReferenceTarget::Failed;
            };
            let template = self.instance.scope(scope).template.clone();
            let Some(&i) = template.by_name.get(&name) else {
                self.unknown_member(scope, name, p.name.span);
                return ReferenceTarget::Failed;
            };
            if template.elements[i as usize].protected {
                self.protected_element(scope, name, p.name.span);
            }
            if matches!(template.elements[i as usize].kind, TemplateElementKind::Class(_)) {
                let owner = LookupContext { scope, base: 0 };
                return match self.instance.names().lookup(owner, name) {
                    Some(found) => ReferenceTarget::Class(found),
                    None => ReferenceTarget::Failed,
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
                    return ReferenceTarget::Failed;
                }
            };
            let chosen = self.selection(child);
            if inner.as_ref().is_some_and(|(d, _)| *d != chosen.dims) {
                self.instance.evaluator().instance.fail::<()>(
                    Code::SizeMismatch,
                    "the elements of this array have parts of different sizes",
                    p.name.span,
                );
                return ReferenceTarget::Failed;
            }
            inner = Some((chosen.dims, chosen.by));
            nodes.extend_from_slice(&chosen.nodes);
        }
        let (inner, by) = inner.unwrap_or_else(|| (Vec::new(), Rc::from([])));
        let own = inner.len();
        let dims = at.dims.iter().copied().chain(inner).collect();
        ReferenceTarget::Nodes(NodeSelection { dims, own, by, nodes: nodes.into() })
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
    fn class_value(
        &mut self,
        mut found: LookupResult<'a>,
        r: &'a ComponentReference,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
        for (i, part) in r.parts.iter().enumerate().skip(1) {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            let inside = self.instance.names().member(&found, part.name.name);
            if let Some(inside) = &inside {
                self.instance.names().check_member(&found, inside, part.name);
            }
            match inside {
                Some(LookupResult::Component(scope, index)) => {
                    if let LookupResult::Class(c) = &found
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
        if let LookupResult::Class(class) = &found
            && let Some(function) = self.instance.calls().function_value(class, Vec::new())
        {
            return Some(function);
        }
        self.instance.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    /// The rest of a reference that reached a class inside a component.
    fn class_tail(
        &mut self,
        mut found: LookupResult<'a>,
        r: &ComponentReference,
        _view: LookupContext,
    ) -> Option<ModelicaValue> {
        for part in &r.parts[1..] {
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            match self.instance.names().member(&found, part.name.name)? {
                LookupResult::Component(scope, index) => {
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

    fn literal(&mut self, found: &LookupResult<'a>, name: Symbol) -> Option<ModelicaValue> {
        let builtin = match found {
            LookupResult::Builtin(b) => *b,
            LookupResult::Class(c) => self.instance.names().template(c.class, c.parent).builtin?,
            LookupResult::Component(..) => return None,
        };
        let BuiltinType::Enumeration(i) = builtin else { return None };
        let k = self.instance.enumerations[i as usize].literals.iter().position(|l| *l == name)?;
        Some(ModelicaValue::Scalar(self.instance.exprs.num(k as f64 + 1.0), ScalarType::Enumeration(i)))
    }

    fn unknown_in_class(&mut self, found: &LookupResult<'a>, part: &ReferencePart) {
        let (class, mut names) = match found {
            LookupResult::Class(c) => {
                let t = self.instance.names().template(c.class, c.parent);
                let literals = match t.builtin {
                    Some(BuiltinType::Enumeration(i)) => self.instance.enumerations[i as usize].literals.clone(),
                    _ => Vec::new(),
                };
                let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).chain(literals).collect();
                (self.instance.library.full_name(c.class), names)
            }
            LookupResult::Builtin(BuiltinType::Enumeration(i)) => {
                let e = &self.instance.enumerations[*i as usize];
                (e.name.clone(), e.literals.clone())
            }
            _ => ("this type".into(), Vec::new()),
        };
        if let LookupResult::Class(c) = found {
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
    pub(in crate::instance) fn selection_value(&mut self, at: &NodeSelection, span: Span) -> Option<ModelicaValue> {
        let values: Option<Vec<ModelicaValue>> = at.nodes.iter().map(|&n| self.node_value(n, span)).collect();
        let mut values = values?;
        if at.dims.is_empty() {
            return values.pop();
        }
        Some(ModelicaValue::array(at.dims.clone(), values))
    }

    /// The value of a component: a variable, or a record.
    pub fn node_value(&mut self, node: NodeId, span: Span) -> Option<ModelicaValue> {
        match self.instance.node(node) {
            InstanceNode::Var(i) => self.variable_value(*i, span),
            InstanceNode::Array { .. } => {
                let at = self.selection(node);
                self.selection_value(&at, span)
            }
            InstanceNode::Object(scope) => self.record_value(*scope, span),
        }
    }

    fn record_value(&mut self, scope: ScopeId, span: Span) -> Option<ModelicaValue> {
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
            if matches!(element.kind, TemplateElementKind::Component(_))
                && let Some(node) = self.instance.builder().component(scope, i)
            {
                fields.push((element.name, self.node_value(node, span)?));
            }
        }
        let class = self.instance.operators().operator_class_of(&template);
        Some(ModelicaValue::Record(Rc::new(crate::instance::value::RecordValue { fields, class })))
    }

    /// The value of a scalar variable: itself, or its number where values count.
    fn variable_value(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
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
        Some(ModelicaValue::Scalar(self.instance.exprs.var(id), ty))
    }
}

/// Whether a reference names a variable of a component that is no value, of which an algorithm section assigns other ones.
fn lies_beside(mut value: &ModelicaValue, r: &ComponentReference) -> bool {
    for part in &r.parts[1..] {
        value = value.elements().first().unwrap_or(value);
        let ModelicaValue::Record(record) = value else { return false };
        match record.fields.iter().find(|(name, _)| *name == part.name.name) {
            Some((_, field)) => value = field,
            None => return true,
        }
    }
    false
}

pub(in crate::instance) enum ReferenceTarget<'a> {
    Nodes(NodeSelection),
    Class(LookupResult<'a>),
    Failed,
}
