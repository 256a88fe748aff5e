//! `outer` components: they stand for the `inner` component of the same name further out (MLS 5.4).
//!
//! The component builder asks here for each `outer` declaration and gets the node of the `inner` component.
//! If there is none, an `inner` component with default values is added to the model, with a message.

use crate::instance::building::components::ComponentPlan;
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::modifiers::ElementModifiers;
use crate::instance::template::TemplateElementKind;
use crate::instance::{ComponentBuilder, InheritedPrefixes, InstanceNode, LookupContext, NodeId, ScopeId};
use crate::resolve::ClassId;
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{self};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// The node for an `outer` declaration. `None` after a message.
    ///
    /// `view` is the place of the declaration. If no `inner` component is found, one is added at the top level, unless
    /// the class is partial or the model has a component that was probably meant.
    ///
    /// 1. The nearest `inner` component of this name further out, if it fits.
    /// 2. Otherwise an error, if the class has no default or a component was probably meant.
    /// 3. Otherwise a new component at the top level, with a message that shows the declaration to write.
    ///
    /// The added component has the name of the `outer` declaration and default values.
    pub(in crate::instance) fn outer_component(
        &mut self,
        scope: ScopeId,
        declared: &'a ast::ComponentDeclaration,
        view: LookupContext,
    ) -> Option<NodeId> {
        let name = declared.name.name;
        if let Some(node) = self.instance.names().inner_of(scope, name) {
            return self.fits_outer(node, declared, view).then_some(node);
        }
        let found = self.instance.names().class_at(view, &declared.class)?;
        let no_inner = |instance: String, help: String| {
            Diagnostic::new(Code::NoInner, format!("`outer {name}` finds no `inner {name}`"))
                .at(declared.name.span, "needs an `inner` component of this name further up")
                .instance(instance)
                .help(help)
        };
        let instance = self.instance.scope(scope).name.clone();
        // A variable such as `outer Real g` has no default that could be added.
        let LookupResult::Class(class) = &found else {
            let ty = declared.class.dotted();
            self.instance.report(no_inner(instance, format!("add `inner {ty} {name} = ...;` to the model")));
            return None;
        };
        let full = self.instance.library.full_name(class.class);
        if self.instance.library.class(class.class).prefixes.partial {
            let help = format!("add `inner SomeClass {name};` to the model, with a class that extends `{full}`");
            self.instance.report(no_inner(instance, help));
            return None;
        }
        // Before a component is added: with a default in the place of the one meant, results would be wrong silently.
        if let Some(meant) = self.meant_as_inner(scope, name, class.class) {
            if self.instance.diagnostics.iter().all(|d| d.message != meant.message) {
                self.instance.report(meant);
            }
            return None;
        }
        let made = Diagnostic::new(Code::AutomaticInner, format!("`inner {full} {name}` was added to the model"))
            .at(declared.name.span, format!("`outer {name}` has no `inner` above it"))
            .help(format!("write `inner {full} {name};` in the model to choose its parameters"));
        let first = self.first_element_of_model();
        self.instance.report(match first {
            Some(place) => made.fix(place, format!("inner {full} {name};\n  ")),
            None => made,
        });
        let root = self.instance.root;
        let plan = ComponentPlan {
            name: name.as_str().to_string(),
            scope: root,
            index: None,
            declared,
            prefix: InheritedPrefixes::default(),
            span: declared.name.span,
            depth: 0,
        };
        let node = self.build_shaped(&plan, &found, &[], ElementModifiers::default())?;
        // Entered, so that the other `outer` declarations of this name find it.
        self.instance.building.inner.insert((root, name), node);
        Some(node)
    }

    /// A message if a component further out was probably meant as the `inner` one. `None` if there is no such
    /// component.
    ///
    /// It has the class `wanted`, but it lacks the prefix `inner` or has another name.
    ///
    /// The search goes outwards from the instance that holds the `outer` declaration.
    /// Classes that extend the wanted class count as well.
    fn meant_as_inner(&mut self, scope: ScopeId, name: Symbol, wanted: ClassId) -> Option<Diagnostic> {
        let mut at = self.instance.scope(scope).owner;
        while let Some(owner) = at {
            let template = self.instance.scope(owner).template.clone();
            for element in &template.elements {
                let TemplateElementKind::Component(c) = element.kind else { continue };
                let view = LookupContext { scope: owner, base: element.base };
                let Ok(LookupResult::Class(class)) = self.instance.names().lookup_path(view, &c.class) else {
                    continue;
                };
                let template = self.instance.names().template(class.class, class.parent);
                if c.prefixes.outer || template.bases.iter().all(|b| b.class != wanted) {
                    continue;
                }
                let (own, ty) = (c.name.name, c.class.dotted());
                let (message, label) = if c.prefixes.inner {
                    let message = format!("no component takes `inner {own}`: they look for `inner {name}`");
                    (message, "has another name")
                } else {
                    (format!("no component takes `{own}`: `{own}` is not `inner`"), "without `inner` it is nobody's")
                };
                let made = Diagnostic::new(Code::NoInner, message).at(c.name.span, label);
                let made = made.note(format!("with a default `{name}` in its place nothing would use its parameters"));
                return Some(made.help(format!("write `inner {ty} {name}`")));
            }
            at = self.instance.scope(owner).owner;
        }
        None
    }

    /// The position before the first element of the model, for a suggestion to insert a declaration there.
    /// `None` if the model has no elements.
    fn first_element_of_model(&self) -> Option<Span> {
        let class = self.instance.library.class(self.instance.scope(self.instance.root).template.class);
        let first = crate::resolve::names::body(class)?.elements.first()?.span;
        Some(Span { end: first.start, ..first })
    }

    /// Reports a modifier or value of an `outer` element (MLS 5.4).
    /// Its values come from the `inner` component, so they can only be changed there.
    /// Only the first modifier is shown.
    pub(in crate::instance) fn check_outer_unmodified(
        &mut self,
        scope: ScopeId,
        declared: &'a ast::ComponentDeclaration,
    ) {
        let name = declared.name.name;
        let given = self.instance.scope(scope).args.iter().find(|a| a.target() == name).map(|a| a.span);
        let own = declared.modification.as_ref().and_then(|m| m.value.as_ref()).map(|e| e.span);
        let Some(at) = given.or(own) else { return };
        self.instance.report(
            Diagnostic::new(Code::UnknownModifier, format!("`outer {name}` cannot be modified"))
                .at(at, "modified here")
                .at(declared.name.span, "it means a component declared elsewhere")
                .note("Modelica 3.6, 5.4")
                .help(format!("modify `inner {name}`")),
        );
    }

    /// Whether an `inner` variable, or array, has the type and size of the `outer` declaration.
    ///
    /// Reports a message if not. It is the part of [`Self::fits_outer`] for variables.
    /// Components that are no variables pass, and so do types that are not found.
    /// Both places are shown in the message: where the `outer` and where the `inner` one is declared.
    pub(in crate::instance) fn fits_outer_shape(
        &mut self,
        node: NodeId,
        declared: &'a ast::ComponentDeclaration,
        view: LookupContext,
    ) -> bool {
        let Some(dims) = self.dimensions(None, &declared.subscripts, view, None, 0) else { return false };
        let dims: Vec<usize> = dims.iter().map(|d| d.size).collect();
        let (have, first) = match self.instance.node(node) {
            InstanceNode::Array { dims, elements, .. } => (dims.clone(), elements.first().copied()),
            _ => (Vec::new(), Some(node)),
        };
        // An empty array has no element to compare, and arrays of components are not compared here.
        let Some(InstanceNode::Var(i)) = first.map(|n| self.instance.node(n).clone()) else { return true };
        let found = self.instance.names().lookup_path(view, &declared.class).ok();
        let builtin = match &found {
            Some(LookupResult::Builtin(b)) => Some(*b),
            Some(LookupResult::Class(c)) => self.instance.names().template(c.class, c.parent).builtin,
            _ => None,
        };
        let data = &self.instance.variables[i as usize];
        let same_type = match builtin {
            Some(BuiltinType::Real) => data.ty == ScalarType::Real,
            Some(BuiltinType::Integer) => data.ty == ScalarType::Integer,
            Some(BuiltinType::Boolean) => data.ty == ScalarType::Boolean,
            Some(BuiltinType::Enumeration(e)) => data.ty == ScalarType::Enumeration(e),
            _ => true,
        };
        // A type with dimensions of its own adds these to the declared ones, so the sizes are not compared then.
        let shaped = matches!(&found, Some(LookupResult::Class(c)) if !self.instance.names().template(c.class, c.parent).dims.is_empty());
        if same_type && (shaped || have == dims) {
            return true;
        }
        let (name, text) = (declared.name.name, crate::instance::value::size_text);
        let what = if same_type {
            format!("`inner {name}` has size {}, and `outer {name}` {}", text(&have), text(&dims))
        } else {
            format!("`inner {name}` and `outer {name}` are of different types")
        };
        let at = self.instance.variables[i as usize].span;
        self.instance.report(
            Diagnostic::new(Code::NoInner, what)
                .at(declared.name.span, "needed here")
                .at(at, "declared here")
                .help("declare both alike, or give one another name"),
        );
        false
    }

    /// Whether an `inner` component has all public elements of the class of the `outer` declaration (MLS 5.4).
    ///
    /// Reports a message if not. The result is kept for each pair of component and declaration.
    /// Elements are compared by name only. Classes with missing bases pass.
    /// Protected elements do not count.
    pub(in crate::instance) fn fits_outer(
        &mut self,
        node: NodeId,
        declared: &'a ast::ComponentDeclaration,
        view: LookupContext,
    ) -> bool {
        let InstanceNode::Object(inner) = *self.instance.node(node) else {
            return self.fits_outer_shape(node, declared, view);
        };
        let key = (node, std::ptr::from_ref(declared));
        if let Some(&known) = self.instance.building.outer_fits.get(&key) {
            return known;
        }
        let mut fits = true;
        if let Ok(LookupResult::Class(want)) = self.instance.names().lookup_path(view, &declared.class) {
            let (want, have) =
                (self.instance.names().template(want.class, want.parent), self.instance.scope(inner).template.clone());
            let missing = want.elements.iter().find(|e| !e.protected && !have.by_name.contains_key(&e.name));
            if let Some(missing) = missing.filter(|_| !want.broken && !have.broken) {
                fits = false;
                let name = declared.name.name;
                let (want, have) =
                    (self.instance.library.full_name(want.class), self.instance.library.full_name(have.class));
                let message = format!("`inner {name}` is a `{have}`, but `outer {name}` needs a `{want}`");
                let at = self.instance.scope(inner).span;
                self.instance.report(
                    Diagnostic::new(Code::NoInner, message)
                        .at(at, format!("`{have}` has no `{}`", missing.name))
                        .at(declared.name.span, "needed here")
                        .help(format!("declare it with a class that extends `{want}`, or give it another name")),
                );
            }
        }
        self.instance.building.outer_fits.insert(key, fits);
        fits
    }
}
