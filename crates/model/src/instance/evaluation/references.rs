//! Component references: from `a.b[i].c` to the components that they name, and to their values.
//!
//! A reference begins with a local, a component, a package or an enumeration; lookup decides.
//! [`NodeSelection`] is the state while the parts are followed: all components that the parts so far name.
//! If a subscript is known only during the run, evaluation goes on with values instead of components.

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

/// The components that the parts of a reference name so far.
///
/// `tank[2:3].port.p` names two components, with `dims` `[2]`. The sizes of all arrays on the way add up.
#[derive(Clone, Debug)]
pub struct NodeSelection {
    /// Sizes of all arrays passed through that no scalar subscript has removed.
    pub dims: Vec<usize>,
    /// How many of the sizes, counted from the last, belong to the component named last.
    /// Only these may still take subscripts. It is 0 after the subscripts.
    pub own: usize,
    /// The index types of these last dimensions: Integer, Boolean or an enumeration.
    pub by: Rc<[ScalarType]>,
    /// The components in row-major order.
    /// Shared, because a reference to one element of a long array starts with all of its elements.
    pub nodes: Rc<[NodeId]>,
}

impl<'a> Evaluator<'_, 'a, '_> {
    /// The value of a reference. `None` after a message.
    ///
    /// Locals come first: loop variables, and in functions inputs, outputs and protected variables.
    /// Then come `time` and what lookup finds.
    ///
    /// - A component goes on through its parts, see [`Self::select_value`].
    /// - A class leads to a constant, an enumeration literal, or a function as a value.
    pub(in crate::instance) fn reference(
        &mut self,
        r: &'a ComponentReference,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
        let first = &r.parts[0];
        if !r.global {
            if let Some(i) = self.instance.local(first.name.name)
                // An algorithm section holds the variables that it assigns as locals. Others of the same component are
                // not in it.
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

    /// The variable `time`. `None` after a message in the mode `constant`, because it changes during the run.
    fn time(&mut self, span: Span) -> Option<ModelicaValue> {
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "`time` is not known before the run", span);
        }
        Some(ModelicaValue::Scalar(self.instance.exprs.time(), ScalarType::Real))
    }

    /// Applies the subscripts of the first part, and then the other parts, to the value of a local.
    /// `x[2].re` selects an element and then a field. `None` after a message.
    ///
    /// Subscripts of the variable itself are checked against the index types of its declaration.
    /// Those of fields are not, because the type of a field is not at hand here.
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

    /// The index types of the dimensions with which a variable was declared: Boolean for `Real x[Boolean]`.
    ///
    /// It serves locals of functions and of algorithm sections, whose values do not carry index types.
    /// Empty if the name is no component.
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

    /// A field of a record. For an array of records, the array of the fields, with the dimensions of the field last.
    /// `None` after a message, if there is no such field.
    ///
    /// ```text
    /// Complex z[2];
    /// z.re            // the array {z[1].re, z[2].re}
    /// ```
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

    /// What the first part of a reference means. `None` after a message.
    ///
    /// `.A.b` starts at the top level, everything else at `view`.
    /// Variables of a component around the class may not be read, only constants (MLS 5.3.1).
    ///
    /// Unknown names are reported with a suggestion from the names visible at `view`.
    /// A function or a short class is seen from where it is written, see [`Self::is_variable_around`].
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

    /// Whether a component found around a class is a variable of an instance; only constants may be read from there
    /// (MLS 5.3.1).
    ///
    /// A function called through a component, as in `oil.density(p)`, may read variables of that component. Other
    /// functions do not find variables around them.
    fn is_variable_around(&self, mut view: LookupContext, scope: ScopeId, index: u32) -> bool {
        // The modifiers of a short class stand outside of it, so the place in question is the one around it.
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

    /// Reports an unknown name, with the most similar of `names` as a suggestion or else a list of them.
    /// `span` is the place of the name. Long names are shortened in the message.
    pub(in crate::instance) fn unknown_name(&mut self, name: Symbol, span: Span, names: &[Symbol]) {
        let mut d = Diagnostic::new(Code::UnknownName, format!("there is no `{}` here", short(name.as_str())))
            .at(span, "not found");
        d = match nearest(name.as_str(), names.iter().map(|n| n.as_str())) {
            Some(near) => d.meant(near),
            None => d.help(list_names("known here are", names)),
        };
        self.instance.report(d);
    }

    /// The names that can be used at a place: locals, and elements of the instance. They serve suggestions in messages.
    pub(in crate::instance) fn visible_names(&self, view: LookupContext) -> Vec<Symbol> {
        let frame = self.instance.eval.frame;
        let mut names: Vec<Symbol> = self.instance.eval.locals[frame..].iter().map(|(n, _)| *n).collect();
        names.extend(self.instance.scope(view.scope).template.elements.iter().map(|e| e.name));
        names
    }

    /// The node of an element, built if necessary. `None` after a message: absent, or needed to build itself.
    ///
    /// A component that is being built and asked for again needs its own size or condition; that is reported as a
    /// cycle.
    /// A conditional component that is absent is reported too: only `connect` may name it (MLS 4.4.5).
    fn element_node(&mut self, scope: ScopeId, index: u32, r: &ComponentReference) -> Option<NodeId> {
        let busy = matches!(self.instance.scope(scope).elements[index as usize], ElementState::Busy);
        if let Some(node) = self.instance.builder().component(scope, index) {
            return Some(node);
        }
        // If something failed before, the component may be missing for that reason, and a second message would mislead.
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

    /// The selection with which a reference begins: all elements of an array, or the one component.
    pub fn selection(&self, node: NodeId) -> NodeSelection {
        match self.instance.node(node) {
            InstanceNode::Array { dims, by, elements } => {
                NodeSelection { dims: dims.clone(), own: dims.len(), by: by.clone(), nodes: elements.clone() }
            }
            _ => NodeSelection { dims: Vec::new(), own: 0, by: Rc::from([]), nodes: Rc::from([node]) },
        }
    }

    /// Follows a reference from a component to a value. `part` is the index of the part that named the component.
    /// `None` after a message.
    ///
    /// For each part the component is looked up in all selected components, and then its subscripts are applied.
    /// A part that names a class inside a component ends the walk: the rest is looked up in that class.
    /// The value of a record array is an array of records.
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
                        // A class inside a component: a package constant or an enumeration literal is read through it.
                        let rest = ComponentReference { global: false, parts: r.parts[i..].to_vec(), span: r.span };
                        return self.class_tail(found, &rest, view);
                    }
                    ReferenceTarget::Failed => return None,
                }
            }
            if !p.subscripts.is_empty() {
                match self.subscript_selection(&at, p, view, r.span)? {
                    Ok(next) => at = next,
                    // The subscript is known only during the run: go on with values of all elements.
                    Err(()) => return self.dynamic_selection(&at, r, i, view),
                }
            }
        }
        self.selection_value(&at, r.span)
    }

    /// Follows a reference with values, beginning with the subscripts of part `part`.
    ///
    /// It is used for subscripts that change during the run. Protected elements and conditional components are not
    /// checked here, because the values of all elements exist already.
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

    /// Applies the subscripts of one part to a selection.
    ///
    /// `None` after a message. `Some(Err(()))` if a subscript is known only during the run.
    ///
    /// `p` is the part, whose name is used in messages, and `view` the place of its subscripts.
    /// Dimensions of the component without a subscript are kept: `a.b[1]` with a matrix `b` selects its first row.
    /// The caller goes on with values if a subscript is symbolic.
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
        // Subscripts belong to the component named last, whose dimensions are the last ones; all others are kept.
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

    /// Goes one part further: to a component or a class inside each of the selected components.
    ///
    /// The sizes of the component found are appended. They must be equal in all selected components.
    ///
    /// ```text
    /// tank[3]            // three components
    /// tank.port          // three ports, dims [3]
    /// tank.port.q[2]     // dims [3]: element 2 of q in each port
    /// ```
    ///
    /// Failures, each with a message: a variable has no elements, no such element, an absent component, different
    /// sizes.
    /// A protected element is reported, and the walk goes on.
    /// `at` is the selection so far, `p` the part to follow.
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
            // All elements of an array have the same class, so the class in the first one stands for all.
            if matches!(template.elements[i as usize].kind, TemplateElementKind::Class(_)) {
                let owner = LookupContext { scope, base: 0 };
                return match self.instance.names().lookup(owner, name) {
                    Some(found) => ReferenceTarget::Class(found),
                    None => ReferenceTarget::Failed,
                };
            }
            let child = match self.instance.builder().component(scope, i) {
                Some(c) => c,
                // As above: no second message if something failed before.
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

    /// Reports a reference from outside to a protected element (MLS 4.1).
    /// `scope` is the component whose class declares the element.
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

    /// Reports that a component has no element of this name, with a suggestion or a list of its public elements.
    /// `scope` is the component, whose class is named in the message.
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

    /// The value of a reference that begins with a class: a constant of a package, a literal of an enumeration.
    ///
    /// A reference to a function gives a function value, for arguments that are functions (MLS 12.4.2).
    /// `None` after a message.
    ///
    /// Parts are followed one after the other, and each member is checked for being reachable.
    /// As soon as a part is a component, that is a constant of a package, the rest goes on as for components.
    /// `r` is the reference, whose first part is `found`.
    /// A partial package is refused, since its constants may be replaced.
    fn class_value(
        &mut self,
        mut found: LookupResult<'a>,
        r: &'a ComponentReference,
        view: LookupContext,
    ) -> Option<ModelicaValue> {
        for (i, part) in r.parts.iter().enumerate().skip(1) {
            // Literals first: they are no elements of the class.
            if let Some(v) = self.literal(&found, part.name.name) {
                return Some(v);
            }
            let inside = self.instance.names().member(&found, part.name.name);
            if let Some(inside) = &inside {
                self.instance.names().check_member(&found, inside, part.name);
            }
            // Constants of partial packages may not be read, because a complete package may redeclare them.
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

    /// Follows the rest of a reference that reached a class inside of a component.
    /// `r` begins with the part that named the class. `None` if the rest names nothing with a value.
    ///
    /// ```text
    /// oil.Medium.density   // a constant of the package Medium inside the component oil
    /// ```
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
                    // Constants of a class are not in the flat model, so only their values can be used.
                    return self
                        .instance
                        .in_mode(|m| m.constant = true, |s| s.evaluator().selection_value(&at, r.span));
                }
                next => found = next,
            }
        }
        self.instance.fail(Code::WrongClassKind, "this is a class, and a value is needed here", r.span)
    }

    /// A literal of an enumeration, as `Color.red`. `None` if `found` is no enumeration or has no such literal.
    ///
    /// ```text
    /// type Color = enumeration(red, green);
    /// Color c = Color.green;    // the value 2 of the type Color
    /// ```
    fn literal(&mut self, found: &LookupResult<'a>, name: Symbol) -> Option<ModelicaValue> {
        let builtin = match found {
            LookupResult::Builtin(b) => *b,
            LookupResult::Class(c) => self.instance.names().template(c.class, c.parent).builtin?,
            LookupResult::Component(..) => return None,
        };
        let BuiltinType::Enumeration(i) = builtin else { return None };
        let k = self.instance.enumerations[i as usize].literals.iter().position(|l| *l == name)?;
        // Literals are numbered from 1 (MLS 4.9.5).
        Some(ModelicaValue::Scalar(self.instance.exprs.num(k as f64 + 1.0), ScalarType::Enumeration(i)))
    }

    /// Reports that a class has no member of this name, with a suggestion or a list of what it has.
    /// For an enumeration its literals are the names to choose from, for a package also classes in files of their own.
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
        // Classes in files of their own are not in the template until somebody loads them.
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

    /// The value of selected components: a single value, or an array with the sizes of the selection.
    pub(in crate::instance) fn selection_value(&mut self, at: &NodeSelection, span: Span) -> Option<ModelicaValue> {
        let values: Option<Vec<ModelicaValue>> = at.nodes.iter().map(|&n| self.node_value(n, span)).collect();
        let mut values = values?;
        if at.dims.is_empty() {
            return values.pop();
        }
        Some(ModelicaValue::array(at.dims.clone(), values))
    }

    /// The value of a component: a variable, an array, or a record. `None` after a message.
    /// `span` is where the value is needed.
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

    /// The value of a record or connector: its fields in declaration order, without absent components.
    /// Instances of other classes have no value; a message is reported and `None` returned.
    ///
    /// A value of an operator record carries the number of its class, so that operators find their functions.
    /// Building the elements on demand may report messages of these elements.
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

    /// The value of a scalar variable: the variable as a symbol, or its value.
    ///
    /// Values are used for Strings and external objects always, and for parameters in the mode `constant`.
    /// Reading other variables in that mode is an error. `None` after a message.
    ///
    /// - In the mode `constant`, and for variables outside of the model, parameters and constants give their value.
    /// - Other variables of the model give a symbol of the pool.
    /// - In the mode `constant` those are errors, because their value depends on the run.
    fn variable_value(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
        let data = &self.instance.variables[i as usize];
        // Constants of packages have no number in the flat model, so only their value can be used.
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
        // A variable without a number belongs to a class that is used as a package.
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

/// Whether a reference names a variable that lies beside those that an algorithm section assigns.
///
/// The section holds `value`: of a component that is no record, only the assigned parts. `a.y` is beside `a.x`.
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

/// Where one part of a reference leads.
pub(in crate::instance) enum ReferenceTarget<'a> {
    /// To components.
    Nodes(NodeSelection),
    /// To a class inside a component.
    Class(LookupResult<'a>),
    /// Nowhere; a message was reported.
    Failed,
}
