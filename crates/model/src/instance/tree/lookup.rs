//! What names mean: from the innermost place outwards, through inherited elements, imports and enclosing classes (MLS
//! 5.3).
//!
//! A name and a [`LookupContext`] go in, a [`LookupResult`] comes out: a component, a class or a predefined type.
//! [`NameLookup::reached`] stands here too: it collects the modifiers that reach one element.
//! Lookup builds what it needs on demand: templates of classes, scopes of packages.

use crate::instance::modifiers::{ElementModifiers, Modifier, ModifierKind};
use crate::instance::template::{
    BaseClass, DEEPEST, ExtendsModification, ExtendsModificationKind, Template, TemplateElement, TemplateElementKind,
};
use crate::instance::{
    ClassRef, ElementState, EnumerationDefinition, InheritedPrefixes, LookupContext, NameLookup, NodeId, ROOT, Scope,
    ScopeId,
};
use crate::resolve::ClassId;
use bramah_syntax::ast::{self, ClassBody, Import};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// The predefined types, which need no declaration (MLS 4.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica names")]
pub enum BuiltinType {
    Real,
    Integer,
    Boolean,
    String,
    /// `ExternalObject` (MLS 12.9.7).
    Object,
    /// Index into `Instance::enumerations`.
    Enumeration(u32),
}

/// What a name means.
#[derive(Clone)]
pub enum LookupResult<'a> {
    /// A component: the scope that holds it, and its index in the template. It may not be built yet.
    Component(ScopeId, u32),
    /// A class, with redeclarations applied.
    Class(ClassRef<'a>),
    /// A predefined type.
    Builtin(BuiltinType),
}

/// Number of the predefined enumeration `StateSelect` (MLS 4.9.7).
pub const STATE_SELECT: u32 = 0;
/// Number of the predefined enumeration `AssertionLevel`.
pub const ASSERTION_LEVEL: u32 = 1;

/// The predefined enumerations. Their positions are the constants above.
/// They exist in every instance, before any class is looked up.
pub fn predefined_enumerations() -> Vec<EnumerationDefinition> {
    let make = |name: &str, literals: &[&str]| EnumerationDefinition {
        name: name.into(),
        literals: literals.iter().map(|l| Symbol::new(l)).collect(),
    };
    vec![
        make("StateSelect", &["never", "avoid", "default", "prefer", "always"]),
        make("AssertionLevel", &["warning", "error"]),
    ]
}

/// The predefined type of a name; `None` for any other name.
/// `StateSelect` and `AssertionLevel` are predefined enumerations, so they need no declaration either.
fn builtin(name: Symbol) -> Option<BuiltinType> {
    Some(match name.as_str() {
        "Real" => BuiltinType::Real,
        "Integer" => BuiltinType::Integer,
        "Boolean" => BuiltinType::Boolean,
        "String" => BuiltinType::String,
        "ExternalObject" => BuiltinType::Object,
        "StateSelect" => BuiltinType::Enumeration(STATE_SELECT),
        "AssertionLevel" => BuiltinType::Enumeration(ASSERTION_LEVEL),
        _ => return None,
    })
}

impl<'a> NameLookup<'_, 'a, '_> {
    /// What a simple name means at a place. `None` if it means nothing; no message is reported.
    pub fn lookup(&mut self, view: LookupContext, name: Symbol) -> Option<LookupResult<'a>> {
        self.lookup_nested(view, name).or_else(|| self.lookup_top(name))
    }

    /// What a name means below the top level: in the class at `view`, its imports, and the classes around it.
    ///
    /// The search goes outwards from `view`, class by class:
    /// 1. elements that the class declares or inherits,
    /// 2. classes that the library knows in it,
    /// 3. its imports.
    ///
    /// `None` if the search reaches the top level or an `encapsulated` class without a result.
    pub(in crate::instance) fn lookup_nested(
        &mut self,
        mut view: LookupContext,
        name: Symbol,
    ) -> Option<LookupResult<'a>> {
        while view != ROOT {
            let template = self.instance.scope(view.scope).template.clone();
            let base = &template.bases[view.base as usize];
            // A short class has no names of its own: `model A = B(x = y)` looks up `y` around `A`.
            if !base.short {
                // The order of MLS 5.3.1: declared and inherited elements first, imports second.
                if base.names.contains(&name)
                    && let Some(&i) = template.by_name.get(&name)
                {
                    return Some(self.found(view.scope, &template, i));
                }
                // Classes that are in the library but not in the template, such as those in files of their own.
                if let Some(class) = self.instance.library.child(base.class, name) {
                    return Some(LookupResult::Class(ClassRef { class, parent: view, args: Rc::from([]) }));
                }
                if let Some(found) = self.imported(base, name) {
                    return Some(found);
                }
            }
            // `encapsulated` stops the search: only predefined types and top-level classes remain (MLS 5.3.1).
            view = if base.ast.prefixes.encapsulated { ROOT } else { base.parent };
        }
        None
    }

    /// What a name means at the top level: a predefined type or a top-level class of the library.
    /// Predefined types come before classes of the library: their names cannot be used otherwise (MLS 4.9).
    fn lookup_top(&mut self, name: Symbol) -> Option<LookupResult<'a>> {
        if let Some(b) = builtin(name) {
            return Some(LookupResult::Builtin(b));
        }
        self.instance
            .library
            .top(name)
            .map(|class| LookupResult::Class(ClassRef { class, parent: ROOT, args: Rc::from([]) }))
    }

    /// What a name means through the imports of a class (MLS 13.2.1).
    /// The forms are `import A.B;`, `import D = A.B;`, `import A.{B, C};` and `import A.*;`.
    ///
    /// The imports are tried in the order of the text. An import that leads nowhere is skipped, and is reported only
    /// when the name is not found at all.
    fn imported(&mut self, base: &BaseClass<'a>, name: Symbol) -> Option<LookupResult<'a>> {
        for import in &base.imports {
            let found = match import {
                Import::Single { alias, path } => {
                    let known = alias.as_ref().or(path.parts.last()).map(|i| i.name);
                    if known == Some(name) { self.lookup_full(&path.parts, None) } else { None }
                }
                Import::Some(path, names) if names.iter().any(|n| n.name == name) => {
                    self.lookup_full(&path.parts, Some(name))
                }
                Import::Some(..) => None,
                Import::All(path) => self.lookup_full(&path.parts, Some(name)),
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// What the full name `parts` means, or the member `last` of it. Imports begin at the top level (MLS 13.2.1).
    ///
    /// Members on the way are checked: protected ones are reported. `None` if a part is unknown, without a message.
    fn lookup_full(&mut self, parts: &[ast::Ident], last: Option<Symbol>) -> Option<LookupResult<'a>> {
        let mut found = self.lookup_top(parts[0].name)?;
        for part in &parts[1..] {
            let inside = self.member(&found, part.name)?;
            self.check_member(&found, &inside, *part);
            found = inside;
        }
        match last {
            Some(name) => self.member(&found, name),
            None => Some(found),
        }
    }

    /// The meaning of an element: a component as such, a class with redeclarations applied.
    fn found(&mut self, scope: ScopeId, template: &Template<'a>, index: u32) -> LookupResult<'a> {
        match template.elements[index as usize].kind {
            TemplateElementKind::Component(_) => LookupResult::Component(scope, index),
            TemplateElementKind::Class(_) => LookupResult::Class(self.class_element(scope, index)),
        }
    }

    /// A class element of an instance, with redeclarations applied and checked.
    ///
    /// If a redeclaration does not fit, a message is reported and the declared class is returned.
    ///
    /// The outermost redeclaration decides which class it is and where its names are looked up.
    /// Its modifiers are those of the element, followed by those of `constrainedby` or of the declaration (MLS 7.3.2).
    /// The result is stored in the state of the element.
    fn class_element(&mut self, scope: ScopeId, index: u32) -> ClassRef<'a> {
        if let ElementState::Class(found) = &self.instance.scope(scope).elements[index as usize] {
            return found.clone();
        }
        let reached = self.reached(scope, index);
        let template = self.instance.scope(scope).template.clone();
        let element = &template.elements[index as usize];
        let TemplateElementKind::Class(declared) = element.kind else { unreachable!("the caller found a class") };
        let own = LookupContext { scope, base: element.base };
        let (ast, parent, redeclared) = match reached.redeclare {
            Some((ModifierKind::Class(c), view, ..)) => (c, view, true),
            _ => (declared, own, false),
        };
        let textual = template.bases[element.base as usize].class;
        let class = self.instance.library.enter(ast, Some(textual));
        let mut args = reached.args;
        // These come last, because they are further in than everything that reached the element from outside.
        if let Some(m) = constraining(declared, redeclared) {
            let none: Rc<[_]> = Rc::from([]);
            let given = m.arguments.iter().filter_map(|a| Modifier::new(a, own, &none, false));
            args.extend(given.map(|a| Modifier { default: redeclared, ..a }));
        }
        let mut found = ClassRef { class, parent, args: args.into() };
        // Entered before the checks, because these may look up the same element again.
        self.instance.scope_mut(scope).elements[index as usize] = ElementState::Class(found.clone());
        self.check_class_chain(declared, own, textual, &reached.redeclarations);
        if redeclared && !self.fits_declared(declared, own, textual, ast.name.span, &found) {
            // The rest of the text was written for the declared class: using it avoids messages that only follow from
            // this one.
            let class = self.instance.library.enter(declared, Some(textual));
            found = ClassRef { class, parent: own, args: Rc::from([]) };
            self.instance.scope_mut(scope).elements[index as usize] = ElementState::Class(found.clone());
        }
        found
    }

    /// Checks each redeclaration of a class against the constraining classes of the declarations that it passed (MLS
    /// 7.3).
    ///
    /// `all` lists the redeclarations, outermost first; `own` and `textual` are the surroundings of `declared`.
    ///
    /// ```text
    /// replaceable model M = A constrainedby Base;      // the declaration, innermost
    /// redeclare replaceable model M = B constrainedby B2;   // must fit Base
    /// redeclare model M = C;                           // must fit B2 and Base
    /// ```
    ///
    /// The check ends with the first step that does not fit.
    fn check_class_chain(
        &mut self,
        declared: &'a ast::Class,
        own: LookupContext,
        textual: ClassId,
        all: &[(ModifierKind<'a>, LookupContext)],
    ) {
        let steps = all.iter().filter_map(|(kind, view)| match kind {
            ModifierKind::Class(c) => Some((*c, *view)),
            _ => None,
        });
        // The declaration itself is the innermost step.
        let steps: Vec<(&'a ast::Class, LookupContext)> = steps.chain([(declared, own)]).collect();
        let outermost = self.class_of(steps[0].0, steps[0].1, textual);
        for &(step, view) in &steps {
            let Some(constraint) = &step.constraint else { continue };
            let Ok(promised) = self.lookup_path(view, &constraint.path) else { continue };
            let itself = self.class_of(step, view, textual);
            // Both the class of the step and the class finally used must fit the constraint of the step.
            if !self.instance.builder().check_subtype(&promised, &itself, step.name.span, constraint.path.span)
                || !self.instance.builder().check_subtype(
                    &promised,
                    &outermost,
                    steps[0].0.name.span,
                    constraint.path.span,
                )
            {
                return;
            }
        }
    }

    /// A class definition as a lookup result without modifiers. `textual` is the class in which it is written.
    fn class_of(&mut self, ast: &'a ast::Class, parent: LookupContext, textual: ClassId) -> LookupResult<'a> {
        let class = self.instance.library.enter(ast, Some(textual));
        LookupResult::Class(ClassRef { class, parent, args: Rc::from([]) })
    }

    /// Whether a redeclared class has everything that the constraining class of the declaration has (MLS 6.4, 7.3.2).
    ///
    /// Without `constrainedby`, the declared class is the constraint. Returns true if the constraint is not found.
    ///
    /// `at` is the place of the redeclaration for the message, `found` the class that it names.
    /// Looking up constraints may nest; too deep a nest is reported as endless.
    /// If the constraint is the class itself, its own elements are what the replacement must have.
    fn fits_declared(
        &mut self,
        declared: &'a ast::Class,
        own: LookupContext,
        textual: ClassId,
        at: Span,
        found: &ClassRef<'a>,
    ) -> bool {
        let path = match (&declared.constraint, &declared.body) {
            (Some(c), _) => Some(&c.path),
            (None, ClassBody::Short { base, .. }) => Some(base),
            _ => None,
        };
        let class = self.instance.library.enter(declared, Some(textual));
        if self.instance.classes.constrained.len() >= DEEPEST {
            self.endless_lookup("constraining", class, &self.instance.classes.constrained.clone());
            return true;
        }
        // Looking up the constraint may meet other redeclared classes, whose constraints must be looked up first.
        self.instance.classes.constrained.push(class);
        let (constraint, place) = match path {
            Some(path) => (self.lookup_path(own, path).ok(), path.span),
            None => {
                (Some(LookupResult::Class(ClassRef { class, parent: own, args: Rc::from([]) })), declared.name.span)
            }
        };
        self.instance.classes.constrained.pop();
        constraint
            .is_none_or(|c| self.instance.builder().check_subtype(&c, &LookupResult::Class(found.clone()), at, place))
    }

    /// Reports a dotted name that reaches what it may not (MLS 4.1, 5.3.2).
    ///
    /// A protected element is not reachable. In a class that is no package only `encapsulated` classes are.
    ///
    /// `around` is what was found for the name before the dot, `inside` what was found for `part`.
    /// Nothing is checked while the bases of `around` are looked up.
    /// The message is reported at `part`, once for each place in the text.
    pub(in crate::instance) fn check_member(
        &mut self,
        around: &LookupResult<'a>,
        inside: &LookupResult<'a>,
        part: ast::Ident,
    ) {
        let LookupResult::Class(class) = around else { return };
        // The bases of this class are not known yet, so neither are all of its elements.
        if self.instance.classes.gathering.iter().any(|(c, _)| *c == class.class) {
            return;
        }
        let template = self.template(class.class, class.parent);
        let element = template.by_name.get(&part.name).map(|&i| &template.elements[i as usize]);
        let name = self.instance.library.full_name(class.class);
        let (message, label, help) = if element.is_some_and(|e| e.protected) {
            let message = format!("`{}` of `{name}` is protected", part.name);
            (
                message,
                "cannot be reached from outside",
                "declare it above `protected`, or use it in a class that extends this one",
            )
        } else if let (LookupResult::Class(c), false) = (inside, template.is_package()) {
            if self.instance.library.class(c.class).prefixes.encapsulated {
                return;
            }
            let message = format!("`{}` stands in `{name}`, which is no package", part.name);
            (
                message,
                "this class may depend on components around it",
                "declare it `encapsulated`, or move it into a package",
            )
        } else {
            return;
        };
        // The same name may be looked up many times; one message is enough.
        if self.instance.diagnostics.iter().any(|d| d.labels.first().is_some_and(|l| l.span == part.span)) {
            return;
        }
        let d = Diagnostic::new(Code::UnknownName, message).at(part.span, label).class(name);
        self.instance.report(d.help(help).note("Modelica 3.6, 4.1 and 5.3.2"));
    }

    /// A member of a class that was found: a class in a package, a constant, an inherited class.
    /// `None` if there is no such member, or `found` is no class.
    ///
    /// The class is treated as a package: its scope is created if there is none.
    /// While its own bases are looked up, only what is written in it can be found, as in `package P extends
    /// P.Icons.Package`.
    pub fn member(&mut self, found: &LookupResult<'a>, name: Symbol) -> Option<LookupResult<'a>> {
        let LookupResult::Class(class) = found else { return None };
        let scope = if self.instance.classes.gathering.contains(&(class.class, class.parent)) {
            // `package P extends P.Icons.Package`: what P inherits is not known yet, what is written in it is.
            self.bare_scope(class.class, class.parent)
        } else {
            self.package(class)
        };
        let template = self.instance.scope(scope).template.clone();
        if let Some(&i) = template.by_name.get(&name) {
            return Some(self.found(scope, &template, i));
        }
        // A class of the library that no template lists, in the class itself or in one of its bases.
        for (base, view) in template.bases.iter().zip(0u32..) {
            if let Some(child) = self.instance.library.child(base.class, name) {
                let parent = LookupContext { scope, base: view };
                return Some(LookupResult::Class(ClassRef { class: child, parent, args: Rc::from([]) }));
            }
        }
        None
    }

    /// What a dotted name means. No message is reported for an unknown part.
    ///
    /// # Errors
    /// The index of the first part that means nothing: 1 for `A.B.C` if `A` has no `B`.
    pub fn lookup_path(&mut self, view: LookupContext, path: &ast::Path) -> Result<LookupResult<'a>, usize> {
        let first = path.parts[0].name;
        let start = if path.global { self.lookup_top(first) } else { self.lookup(view, first) };
        let mut found = start.ok_or(0usize)?;
        for (i, part) in path.parts.iter().enumerate().skip(1) {
            let inside = self.member(&found, part.name).ok_or(i)?;
            self.check_member(&found, &inside, *part);
            found = inside;
        }
        Ok(found)
    }

    /// The class or predefined type at a path. `None` after a message: unknown, or a component.
    /// The result may be a predefined type. Callers that need a class with elements check that themselves.
    ///
    /// ```text
    /// C c;    // C is looked up here, with a message if it is unknown
    /// ```
    pub fn class_at(&mut self, view: LookupContext, path: &'a ast::Path) -> Option<LookupResult<'a>> {
        match self.lookup_path(view, path) {
            Ok(LookupResult::Component(..)) => {
                let name = path.dotted();
                self.instance.report(
                    Diagnostic::new(Code::WrongClassKind, format!("`{name}` is a component, not a class"))
                        .at(path.span, "a class is needed here"),
                );
                None
            }
            Ok(found) => Some(found),
            Err(part) => {
                self.instance.unknown_class_at(view, path, part);
                None
            }
        }
    }

    /// The class named in an `extends` clause or a short class definition. `None` if it is unknown, without a message.
    ///
    /// It is looked up in and around the class, but not in what the class inherits (MLS 5.6.1).
    pub(in crate::instance) fn find_base(
        &mut self,
        class: ClassId,
        parent: LookupContext,
        path: &ast::Path,
    ) -> Option<LookupResult<'a>> {
        let own = !path.global && matches!(self.instance.library.class(class).body, ClassBody::Long(_));
        if own {
            let bare = self.bare_scope(class, parent);
            return self.lookup_path(LookupContext { scope: bare, base: 0 }, path).ok();
        }
        self.lookup_path(parent, path).ok()
    }

    /// A scope that holds only the classes and imports written in a class itself, without components and bases.
    ///
    /// The bases of a class are looked up in it. That avoids the question which names the bases themselves contribute.
    /// Redeclared classes are left out, because they need the inherited class.
    /// The scope is made once for each class and place, and its elements never become components.
    /// Components are left out as well: a base class is never found through a component.
    fn bare_scope(&mut self, class: ClassId, parent: LookupContext) -> ScopeId {
        if let Some(&scope) = self.instance.classes.uninherited.get(&(class, parent)) {
            return scope;
        }
        let ast = self.instance.library.class(class);
        let mut base = BaseClass::of(class, ast, parent);
        let mut elements = Vec::new();
        let written = if let ClassBody::Long(body) = &ast.body { body.elements.as_slice() } else { &[] };
        for e in written {
            match &e.kind {
                ast::ElementKind::Import(i) => base.imports.push(i),
                ast::ElementKind::Class(c) if !c.prefixes.redeclare => {
                    self.instance.library.enter(c, Some(class));
                    base.names.insert(c.name.name);
                    elements.push(TemplateElement {
                        name: c.name.name,
                        kind: TemplateElementKind::Class(c),
                        base: 0,
                        modified: Vec::new(),
                        protected: e.protected,
                        span: e.span,
                    });
                }
                _ => {}
            }
        }
        let by_name: FxHashMap<_, _> = elements.iter().map(|e| e.name).zip(0u32..).collect();
        let template = Template { bases: vec![base], elements, by_name, ..Template::empty(class, ast.kind) };
        let name = self.instance.library.full_name(class);
        let scope = self.new_scope(Rc::new(template), name, Rc::from([]), None, ast.name.span);
        self.instance.classes.uninherited.insert((class, parent), scope);
        scope
    }

    /// Creates a scope whose elements are not built yet and returns its id.
    ///
    /// `owner` is the instance that the new one is a component of; `None` for packages and functions.
    /// `span` is the declaration for messages. The caller sets binding, prefixes and `component` if they apply.
    /// Elements start as unknown. They are built when somebody asks for them.
    pub(in crate::instance) fn new_scope(
        &mut self,
        template: Rc<Template<'a>>,
        name: String,
        args: Rc<[Modifier<'a>]>,
        owner: Option<ScopeId>,
        span: Span,
    ) -> ScopeId {
        let elements = vec![ElementState::Unknown; template.elements.len()];
        let prefix = InheritedPrefixes::default();
        self.instance.scopes.push(Scope {
            template,
            name,
            args,
            binding: None,
            owner,
            elements,
            prefix,
            span,
            component: false,
        });
        ScopeId(u32::try_from(self.instance.scopes.len() - 1).expect("fewer than 2^32 instances"))
    }

    /// The scope of a package, or of a class used as one. It is created at the first request.
    ///
    /// Packages exist once for each class, place and list of modifiers.
    /// So a constant of a package is evaluated once, and two references to the package see the same instance.
    /// Modifiers come from redeclarations, as in `redeclare package Medium = Oil(T0 = 300)`.
    pub fn package(&mut self, class: &ClassRef<'a>) -> ScopeId {
        let key = (class.class, class.parent);
        if class.args.is_empty() {
            if let Some(&scope) = self.instance.classes.packages.get(&key) {
                return scope;
            }
        } else if let Some(&(_, scope)) = self
            .instance
            .classes
            .modified_packages
            .iter()
            // Modifiers are compared by address: equal ones from two places give two scopes, which is correct but not
            // shared.
            .find(|(c, _)| (c.class, c.parent) == key && Rc::ptr_eq(&c.args, &class.args))
        {
            return scope;
        }
        let template = self.template(class.class, class.parent);
        let name = self.instance.library.full_name(class.class);
        let span = self.instance.library.class(class.class).name.span;
        let scope = self.new_scope(template, name, class.args.clone(), None, span);
        if class.args.is_empty() {
            self.instance.classes.packages.insert(key, scope);
        } else {
            self.instance.classes.modified_packages.push((class.clone(), scope));
        }
        scope
    }

    /// The number of the enumeration type that a class defines. `enumeration(:)` has no literals.
    /// The number is an index into `Instance::enumerations`, and part of the scalar type of its values.
    pub(in crate::instance) fn enumeration(&mut self, class: ClassId) -> u32 {
        if let Some(&i) = self.instance.classes.enumerations.get(&class) {
            return i;
        }
        let literals = match &self.instance.library.class(class).body {
            ClassBody::Enumeration(Some(literals)) => literals.iter().map(|l| l.name.name).collect(),
            _ => Vec::new(),
        };
        let name = self.instance.library.full_name(class);
        self.instance.enumerations.push(EnumerationDefinition { name, literals });
        let i = u32::try_from(self.instance.enumerations.len() - 1).expect("fewer than 2^32 types");
        self.instance.classes.enumerations.insert(class, i);
        i
    }

    /// All modifiers that reach an element, and its value.
    ///
    /// They come from the instance's modifiers, then from `extends` clauses outermost first, then from the declaration.
    /// The outermost value wins (MLS 7.2.4). A modifier outside of a `final` one is an error (MLS 7.2.6).
    ///
    /// In this order, outermost first:
    /// 1. modifiers that the instance has got, except defaults;
    /// 2. redeclarations that a short class itself states;
    /// 3. defaults, which belong to the declaration of a redeclared class;
    /// 4. modifiers of `extends` clauses, and those that base classes had where they were found;
    /// 5. the modifiers of `constrainedby` and of the declaration itself.
    ///
    /// The value of a record instance counts as a value of each field: after step 1 for fields that are not constant.
    pub fn reached(&mut self, scope: ScopeId, index: u32) -> ElementModifiers<'a> {
        let s = self.instance.scope(scope);
        let template = s.template.clone();
        let element = &template.elements[index as usize];
        let mut reached = ElementModifiers::default();
        let args = s.args.clone();
        let binding = s.binding.clone();
        // Where the first modifier of the element itself stands, to be named by the message about `final`.
        let mut outer: Option<Span> = None;
        let (defaults, given): (Vec<_>, Vec<_>) =
            args.iter().filter(|a| a.target() == element.name).partition(|a| a.default);
        for arg in given {
            if arg.ends_here() {
                self.check_final(arg.final_, outer, arg.span, element.name);
                outer = outer.or(Some(arg.span));
            }
            reached.take(arg);
        }
        // `R r = expr` gives `r.x` the part `expr.x`, unless a modifier gives `r.x` its own value.
        let of_record = binding.filter(|_| matches!(element.kind, TemplateElementKind::Component(_))).map(|b| {
            let access =
                b.access.iter().copied().chain([crate::instance::modifiers::AccessStep::Field(element.name)]).collect();
            crate::instance::modifiers::Binding { access, ..b }
        });
        // constants come with the class, not with a value of it (MLS 12.6)
        let constant = matches!(element.kind, TemplateElementKind::Component(c) if c.prefix.variability == Some(ast::VariabilityPrefix::Constant));
        if !constant && reached.binding.is_none() {
            reached.binding = of_record.clone();
        }
        // Modifiers by `extends` clauses apply to the complete class and carry no array index.
        let none: Rc<[_]> = Rc::from([]);
        // `model A = B(redeclare ...)`: what the short class says itself is further out than all defaults.
        let redeclaration = |s: &&ExtendsModification<'a>| s.base == 0 && template.bases[0].short;
        let (own, inherited): (Vec<_>, Vec<_>) = element.modified.iter().partition(redeclaration);
        let as_arg = |s: &ExtendsModification<'a>| source_arg(s, LookupContext { scope, base: s.base }, &none);
        let own: Vec<Modifier<'a>> = own.into_iter().filter_map(as_arg).collect();
        let defaults = defaults.into_iter().cloned().collect();
        // what is modified of a base class where it was found comes before what that class says itself
        let mut of_bases = template.base_args.iter().filter(|(_, arg)| arg.target() == element.name).peekable();
        let mut below = Vec::with_capacity(inherited.len());
        for source in inherited {
            while let Some((_, arg)) = of_bases.next_if(|(base, _)| *base <= source.base) {
                below.push(arg.clone());
            }
            below.extend(as_arg(source));
        }
        below.extend(of_bases.map(|(_, arg)| arg.clone()));
        for arg in [own, defaults, below].iter().flatten() {
            self.check_final(arg.final_, outer, arg.span, element.name);
            reached.take(arg);
            outer = outer.or(Some(arg.span));
        }
        if let TemplateElementKind::Component(c) = element.kind {
            self.check_final(c.prefixes.final_, outer, c.name.span, element.name);
            let redeclared = matches!(reached.redeclare, Some((ModifierKind::Component(_), ..)));
            // The modifiers of `constrainedby` hold for every class in place of the declared one (MLS 7.3.2).
            let constraint = c.constraint.as_ref().and_then(|k| k.modification.as_ref());
            let view = LookupContext { scope, base: element.base };
            if let Some(m) = constraint {
                reached.modification(m, view, &none, false, false, element.span);
            }
            // A redeclaration drops the declaration's own modifiers if `constrainedby` says what is to stay.
            if let Some(m) = c.modification.as_ref().filter(|_| !(redeclared && c.constraint.is_some())) {
                reached.modification(m, view, &none, false, c.prefixes.final_, element.span);
            }
        }
        // A record value counts more than the field's own declaration, except for constants, which come to it only
        // here.
        if reached.binding.is_none() && !reached.no_binding {
            reached.binding = of_record;
        }
        reached
    }

    /// Reports an element that is modified at `outer` although a `final` modifier further in forbids it (MLS 7.2.6).
    /// `outer` is `None` if nothing further out modifies the element; then there is nothing to report.
    pub(in crate::instance) fn check_final(&mut self, final_: bool, outer: Option<Span>, span: Span, name: Symbol) {
        if let (true, Some(outer)) = (final_, outer) {
            self.instance.report(
                Diagnostic::new(Code::FinalModified, format!("`{name}` is final and cannot be modified"))
                    .at(outer, "modified here")
                    .at(span, "declared `final` here")
                    .help("remove the modifier, or the `final`"),
            );
        }
    }

    /// The component that an `outer` element refers to: the nearest `inner` one of that name further out (MLS 5.4).
    /// If there is none, it is one that was created at the top level. `None` if that does not exist either.
    ///
    /// The search begins at the owner of `scope`, so an element that is both `inner` and `outer` does not find itself.
    /// Building the `inner` component on demand may report messages.
    pub(in crate::instance) fn inner_of(&mut self, scope: ScopeId, name: Symbol) -> Option<NodeId> {
        let mut at = self.instance.scope(scope).owner;
        while let Some(owner) = at {
            let template = self.instance.scope(owner).template.clone();
            if let Some(&i) = template.by_name.get(&name)
                && matches!(template.elements[i as usize].kind, TemplateElementKind::Component(c) if c.prefixes.inner)
            {
                return self.instance.builder().component(owner, i);
            }
            at = self.instance.scope(owner).owner;
        }
        self.instance.building.inner.get(&(self.instance.root, name)).copied()
    }
}

/// The modifiers that hold for every class in place of a declared one (MLS 7.3.2).
/// These are the modifiers of `constrainedby`. A redeclared short class without one passes on its own modifiers.
fn constraining(declared: &ast::Class, redeclared: bool) -> Option<&ast::Modification> {
    match (&declared.constraint, &declared.body) {
        (Some(c), _) => c.modification.as_ref(),
        (None, ClassBody::Short { modification, .. }) if redeclared => modification.as_ref(),
        _ => None,
    }
}

/// A modifier from an `extends` clause, in the form in which modifiers from outside come.
/// `None` for `break`, which was applied while the elements were gathered.
/// `view` is the base in which the clause stands.
fn source_arg<'a>(
    source: &ExtendsModification<'a>,
    view: LookupContext,
    none: &Rc<[crate::instance::modifiers::AccessStep]>,
) -> Option<Modifier<'a>> {
    let made =
        |kind, span| Modifier { kind, view, access: none.clone(), each: false, final_: false, default: false, span };
    match source.what {
        ExtendsModificationKind::Argument(a) => Modifier::new(a, view, none, false),
        ExtendsModificationKind::Component(c) => Some(made(ModifierKind::Component(c), c.name.span)),
        ExtendsModificationKind::Class(c) => Some(made(ModifierKind::Class(c), c.name.span)),
    }
}
