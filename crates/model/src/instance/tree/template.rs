//! The elements of a class, inherited ones included.
//!
//! [`NameLookup::template`] takes a class and its surroundings and returns a [`Template`].
//! It walks through the `extends` clauses, depth first, and notes with each element which base declares it and which
//! `extends` clauses modify it. No modifier is applied here; [`NameLookup::reached`] does that per instance.
//! A template exists once per class and place, and all instances share it.

use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::modifiers::Modifier;
use crate::instance::{ClassRef, LookupContext, NameLookup};
use crate::resolve::ClassId;
use bramah_syntax::ast::{self, ClassBody, ElementKind, ModificationArgumentKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;

/// The elements of a class together with the classes that it extends.
#[derive(Clone)]
pub struct Template<'a> {
    /// The class that was asked for.
    pub class: ClassId,
    /// The class and everything it extends, depth first in the order of the text; 0 is the class itself.
    pub bases: Vec<BaseClass<'a>>,
    /// Elements in declaration order. Inherited ones stand where the `extends` clause stands.
    pub elements: Vec<TemplateElement<'a>>,
    /// Indices into `elements`, by name.
    pub by_name: FxHashMap<Symbol, u32>,
    /// The predefined type that this class specializes, as `Real` for `type Length = Real(unit = "m")`.
    pub builtin: Option<BuiltinType>,
    /// Modifiers of attributes along the chain of types, outermost first.
    pub builtin_args: Vec<ExtendsModification<'a>>,
    /// Modifiers that a base class already had where it was found, outermost first, with the index of that base.
    /// They come from its `constrainedby` clause and from the component or package in which it was found.
    pub base_args: Vec<(u32, Modifier<'a>)>,
    /// Array dimensions of a type such as `type Triple = Real[3]`, with the base that declares them.
    /// If several types along the chain have dimensions, the class itself comes first.
    pub dims: Vec<(&'a [ast::Subscript], u32)>,
    /// Prefixes of a short class: `input` in `connector In = input Real`.
    pub prefix: ast::TypePrefix,
    /// The kind in the class definition as written: model, record, connector and so on.
    pub kind: ast::ClassKind,
    /// A base class was not found or the bases form a cycle. Names may be missing, so messages about them are left out.
    pub broken: bool,
}

/// A class that contributes elements and equations, and a place from which to look up names.
#[derive(Clone)]
pub struct BaseClass<'a> {
    /// The class.
    pub class: ClassId,
    /// Its syntax tree.
    pub ast: &'a ast::Class,
    /// The place that encloses it. Lookup continues there when the class does not know a name.
    pub parent: LookupContext,
    /// Names of the elements that it declares or inherits. Other elements of the instance are not visible from it.
    pub names: FxHashSet<Symbol>,
    /// Its `import` clauses, which are not inherited (MLS 13.2.1).
    pub imports: Vec<&'a ast::Import>,
    /// True for every class without a body of its own (`model A = B(x = y)`). `y` means what it means around `A`.
    pub short: bool,
    /// `connect` equations that `extends B(break connect(a, b))` removes: both arguments as written.
    pub broken_connects: Vec<(&'a ast::Expr, &'a ast::Expr)>,
    /// Components that `extends B(break x)` removes. Their `connect` equations are removed with them.
    pub broken_components: Vec<Symbol>,
}

impl Template<'_> {
    /// A template without elements and bases.
    /// It is the start of every template, and the complete one of scopes that hold nothing, such as the top level.
    /// `kind` is the kind that the class definition states.
    pub(in crate::instance) fn empty(class: ClassId, kind: ast::ClassKind) -> Self {
        Template {
            class,
            bases: Vec::new(),
            elements: Vec::new(),
            by_name: FxHashMap::default(),
            builtin: None,
            builtin_args: Vec::new(),
            base_args: Vec::new(),
            dims: Vec::new(),
            prefix: ast::TypePrefix::default(),
            kind,
            broken: false,
        }
    }

    /// Whether this is an expandable connector.
    pub fn is_expandable(&self) -> bool {
        matches!(self.kind, ast::ClassKind::Connector { expandable: true })
    }

    /// Whether a class holds only what a package may hold, classes and constants.
    /// It holds too for every class that is no model, block or `class`: these are not checked.
    /// A dotted name may reach a class inside such a class (MLS 5.3.2).
    pub(in crate::instance) fn is_package(&self) -> bool {
        let model = matches!(self.kind, ast::ClassKind::Model | ast::ClassKind::Block | ast::ClassKind::Class);
        let constant = |e: &TemplateElement<'_>| match e.kind {
            TemplateElementKind::Component(c) => c.prefix.variability == Some(ast::VariabilityPrefix::Constant),
            TemplateElementKind::Class(_) => true,
        };
        !model || self.builtin.is_some() || self.elements.iter().all(constant)
    }
}

impl<'a> BaseClass<'a> {
    /// A base whose elements and imports are not entered yet.
    ///
    /// Names, imports and removals by `break` are entered while the class is gathered.
    /// A class without a body of its own is marked `short`.
    pub(in crate::instance) fn of(class: ClassId, ast: &'a ast::Class, parent: LookupContext) -> Self {
        BaseClass {
            class,
            ast,
            parent,
            names: FxHashSet::default(),
            imports: Vec::new(),
            short: !matches!(ast.body, ClassBody::Long(_)),
            broken_connects: Vec::new(),
            broken_components: Vec::new(),
        }
    }
}

/// One element of a class.
#[derive(Clone)]
pub struct TemplateElement<'a> {
    /// The name it is declared with.
    pub name: Symbol,
    /// The declaration.
    pub kind: TemplateElementKind<'a>,
    /// The base that declares it: index into `Template::bases`.
    pub base: u32,
    /// Modifiers and redeclarations by classes that inherit it, outermost first.
    pub modified: Vec<ExtendsModification<'a>>,
    /// Declared in a protected section.
    pub protected: bool,
    /// The declaration in the text, for messages.
    pub span: Span,
}

/// The declaration of an element, as it was first declared; redeclarations are in `modified`.
#[derive(Clone, Copy)]
pub enum TemplateElementKind<'a> {
    /// A component.
    Component(&'a ast::ComponentDeclaration),
    /// A class.
    Class(&'a ast::Class),
}

/// A modifier that a class writes for an element that it inherits.
#[derive(Clone, Copy)]
pub struct ExtendsModification<'a> {
    /// Its form and its syntax.
    pub what: ExtendsModificationKind<'a>,
    /// The base in which it is written, whose names it uses.
    pub base: u32,
}

/// The forms in which a base modifies an inherited element.
#[derive(Clone, Copy)]
pub enum ExtendsModificationKind<'a> {
    /// An argument of `extends B(...)`.
    Argument(&'a ast::ModificationArgument),
    /// `redeclare T x;` as an element.
    Component(&'a ast::ComponentDeclaration),
    /// `redeclare model M = N;` as an element.
    Class(&'a ast::Class),
}

/// Limit of two depths: the length of a chain of `extends`, and how many classes are looked up inside each other.
pub(super) const DEEPEST: usize = 100;

/// The most bases gathered for one class, including those of the classes that must be found on the way.
/// A class of a large library has some hundreds. Cycles that branch would reach this number long before [`DEEPEST`]
/// ends them.
const MOST_BASES: usize = 20_000;

impl<'a> NameLookup<'_, 'a, '_> {
    /// The template of a class at a place. It is made at the first request and shared afterwards.
    ///
    /// Errors are reported, and the template is marked `broken` and may lack elements.
    ///
    /// `parent` is the place around the class. The same class at two places has two templates: its bases may be found
    /// in different packages there, if these have been redeclared.
    /// Looking up a base may need templates of other classes. Their number is limited, so that a cycle ends with a
    /// message.
    pub fn template(&mut self, class: ClassId, parent: LookupContext) -> Rc<Template<'a>> {
        if let Some(t) = self.instance.classes.templates.get(&(class, parent)) {
            return t.clone();
        }
        let ast = self.instance.library.class(class);
        let mut t = Template::empty(class, ast.kind);
        if self.instance.classes.gathering.is_empty() {
            self.instance.classes.gathered = 0;
        }
        // Base lookup may need the template of another class, so it can nest; too deep a nest has no end.
        if self.instance.classes.gathering.len() < DEEPEST {
            self.instance.classes.gathering.push((class, parent));
            self.gather(&mut t, class, parent, &mut Vec::new());
            self.instance.classes.gathering.pop();
        } else {
            self.endless_lookup("base", class, &self.gathered_now());
            t.broken = true;
            t.bases.push(BaseClass::of(class, ast, parent));
        }
        let t = Rc::new(t);
        self.instance.classes.templates.insert((class, parent), t.clone());
        t
    }

    /// The classes whose bases are being looked up, innermost last.
    fn gathered_now(&self) -> Vec<ClassId> {
        self.instance.classes.gathering.iter().map(|&(class, _)| class).collect()
    }

    /// Reports that looking up `class` requires further classes without end.
    /// `what` is "base" or "constraining"; `around` lists the classes being looked up, innermost last.
    ///
    /// ```text
    /// package A extends B.C; end A;
    /// package B extends A.D; end B;
    /// ```
    pub(super) fn endless_lookup(&mut self, what: &str, class: ClassId, around: &[ClassId]) {
        let mut circle: Vec<String> = Vec::new();
        // Only the innermost part up to the first repetition is shown: that is the cycle.
        for &c in around.iter().rev() {
            let name = self.instance.library.full_name(c);
            if circle.contains(&name) {
                break;
            }
            circle.push(name);
        }
        circle.reverse();
        let (span, name) = (self.instance.library.class(class).name.span, self.instance.library.full_name(class));
        self.instance.report(
            Diagnostic::new(Code::CyclicExtends, format!("the {what} classes of `{name}` need each other to be found"))
                .at(span, "found again while its own are being looked up")
                .class(name)
                .help(format!("these look for them inside each other: {}", circle.join(", "))),
        );
    }

    /// Adds a class and what it extends to the template, and returns the index of its base.
    ///
    /// `chain` holds the classes from the outermost one to the one that extends `class`, to find cycles.
    ///
    /// The class is entered first, then checked for what its kind may hold, then its elements and bases follow.
    /// - A class with a body: each element, import and `extends` clause in the order of the text.
    /// - A short class `type T = B[3](x = 1)`: its prefixes and dimensions, then `B` like a base.
    /// - An enumeration: its type is noted.
    /// - `function f = der(g, x)` is not supported.
    ///
    /// The result is the index of the entered class in `Template::bases`. It is returned even after a message.
    fn gather(&mut self, t: &mut Template<'a>, class: ClassId, parent: LookupContext, chain: &mut Vec<ClassId>) -> u32 {
        let ast = self.instance.library.class(class);
        let base = u32::try_from(t.bases.len()).expect("fewer than 2^32 bases");
        // The class is entered before its bases, so that it has a lower number than they have.
        t.bases.push(BaseClass::of(class, ast, parent));
        if chain.contains(&class) || chain.len() > DEEPEST {
            let name = self.instance.library.full_name(class);
            let from = chain.iter().position(|&c| c == class).unwrap_or(0);
            let circle: Vec<String> =
                chain[from..].iter().map(|&c| format!("`{}`", self.instance.library.full_name(c))).collect();
            let mut made = Diagnostic::new(Code::CyclicExtends, format!("`{name}` extends itself"))
                .at(ast.name.span, "this class is among its own bases")
                .class(name.clone())
                .help("remove one of the `extends` clauses of the cycle");
            if circle.len() > 1 {
                made = made.note(format!("{} extends `{name}` again", circle.join(" extends ")));
            }
            self.instance.report(made);
            t.broken = true;
            return base;
        }
        self.instance.builder().check_class(class);
        self.instance.classes.gathered += 1;
        // After the first report the limit is low: other classes of the same cycle would take as long again.
        let most = if self.instance.classes.tangled { DEEPEST } else { MOST_BASES };
        if self.instance.classes.gathered > most {
            if !self.instance.classes.tangled {
                self.endless_lookup("base", class, &self.gathered_now());
            }
            self.instance.classes.tangled = true;
            t.broken = true;
            return base;
        }
        chain.push(class);
        match &ast.body {
            ClassBody::Long(body) => self.gather_long(t, base, body, chain),
            ClassBody::Short { prefix, base: path, subscripts, modification } => {
                t.prefix = *prefix;
                if !subscripts.is_empty() {
                    t.dims.push((subscripts, base));
                }
                self.gather_extends(t, base, path, modification.as_ref(), chain);
            }
            ClassBody::Enumeration(_) => t.builtin = Some(BuiltinType::Enumeration(self.enumeration(class))),
            ClassBody::Derivative { .. } => self.instance.unsupported(ast.span, "a function defined by `der(...)`"),
        }
        chain.pop();
        base
    }

    /// Adds the elements of a class with a body (`class A ... end A`) in the order of the text.
    ///
    /// Nested classes get a number in the library, because modifiers and lookups refer to classes by number.
    /// A `redeclare` element does not add anything: it is attached to the inherited element of that name.
    /// `base` is the index of the class, to which its names and imports are added.
    fn gather_long(&mut self, t: &mut Template<'a>, base: u32, body: &'a ast::LongBody, chain: &mut Vec<ClassId>) {
        // `redeclare model extends M`: the replaced class is a base like that of an `extends` clause (MLS 7.3.1).
        if let Some(modification) = &body.class_extends {
            let (ast, parent) = (t.bases[base as usize].ast, t.bases[base as usize].parent);
            let arguments = modification.as_ref().map_or(&[][..], |m| m.arguments.as_slice());
            match self.replaced_class(ast, parent) {
                Some(found) => self.gather_base(t, base, &found, arguments, chain),
                None => t.broken = true,
            }
        }
        for element in &body.elements {
            match &element.kind {
                ElementKind::Import(import) => t.bases[base as usize].imports.push(import),
                ElementKind::Extends(e) => {
                    self.gather_extends(t, base, &e.base, e.modification.as_ref(), chain);
                }
                ElementKind::Component(c) => {
                    let redeclare = c.prefixes.redeclare;
                    self.add_element(t, base, element, c.name, TemplateElementKind::Component(c), redeclare);
                }
                ElementKind::Class(c) => {
                    self.instance.library.enter(c, Some(t.bases[base as usize].class));
                    // `model extends M` takes the place of the inherited class, with or without `redeclare`
                    let extends = matches!(&c.body, ClassBody::Long(body) if body.class_extends.is_some());
                    self.add_element(
                        t,
                        base,
                        element,
                        c.name,
                        TemplateElementKind::Class(c),
                        c.prefixes.redeclare || extends,
                    );
                }
            }
        }
    }

    /// Enters one declaration, or attaches it to the inherited element that it redeclares.
    ///
    /// An element may be inherited twice if both declarations agree (MLS 5.6.1.2). Every other repetition is an error.
    ///
    /// - A new name becomes an element. With `redeclare` this is an error, because there is nothing to redeclare.
    /// - A known name with `redeclare` becomes the outermost redeclaration of the inherited element. Its visibility
    ///   must be the same, and an earlier redeclaration must be `replaceable` (MLS 7.3).
    /// - A known name without `redeclare` must be declared alike, otherwise it is reported as a duplicate.
    ///
    /// `base` is the class in which the declaration stands. Public or protected is a property of the section, so it
    /// comes from `element`.
    fn add_element(
        &mut self,
        t: &mut Template<'a>,
        base: u32,
        element: &'a ast::Element,
        name: ast::Ident,
        kind: TemplateElementKind<'a>,
        redeclare: bool,
    ) {
        t.bases[base as usize].names.insert(name.name);
        if let Some(&i) = t.by_name.get(&name.name) {
            let old = &mut t.elements[i as usize];
            if redeclare && old.protected != element.protected && old.base != base {
                let class = self.instance.library.full_name(t.bases[base as usize].class);
                let now = if element.protected { "protected" } else { "public" };
                self.instance.report(
                    Diagnostic::new(Code::BadRedeclare, format!("`{}` is redeclared as a {now} element", name.name))
                        .at(name.span, "its visibility cannot change")
                        .class(class)
                        .note("Modelica 3.6, 7.3")
                        .help("redeclare it in a section of the same visibility"),
                );
                return;
            }
            // An earlier redeclaration without `replaceable` closes the element to the ones further out.
            let closed = t.elements[i as usize].modified.first().is_some_and(|s| match s.what {
                ExtendsModificationKind::Class(c) => s.base != base && !c.prefixes.replaceable,
                ExtendsModificationKind::Component(c) => s.base != base && !c.prefixes.replaceable,
                ExtendsModificationKind::Argument(_) => false,
            });
            if redeclare && closed {
                let class = self.instance.library.full_name(t.bases[base as usize].class);
                self.instance.report(
                    Diagnostic::new(Code::BadRedeclare, format!("`{}` is not replaceable any more", name.name))
                        .at(name.span, "redeclared again here")
                        .class(class)
                        .note("Modelica 3.6, 7.3")
                        .help("write `redeclare replaceable` at the inner one"),
                );
                return;
            }
            let old = &mut t.elements[i as usize];
            if redeclare {
                let what = match kind {
                    TemplateElementKind::Component(c) => ExtendsModificationKind::Component(c),
                    TemplateElementKind::Class(c) => ExtendsModificationKind::Class(c),
                };
                // This class is further out than all that modified the element so far, so its redeclaration comes
                // first.
                old.modified.insert(0, ExtendsModification { what, base });
            } else if old.base == base || !same_declaration(old.kind, kind) {
                self.duplicate(t, i, name);
            }
            return;
        }
        if redeclare {
            let class = self.instance.library.full_name(t.bases[base as usize].class);
            self.instance.report(
                Diagnostic::new(
                    Code::BadRedeclare,
                    format!("`{}` redeclares nothing that `{class}` inherits", name.name),
                )
                .at(name.span, "no inherited element of this name")
                .class(class)
                .help("remove `redeclare`, or correct the name"),
            );
        }
        t.by_name.insert(name.name, u32::try_from(t.elements.len()).expect("fewer than 2^32 elements"));
        t.elements.push(TemplateElement {
            name: name.name,
            kind,
            base,
            modified: Vec::new(),
            protected: element.protected,
            span: element.span,
        });
    }

    /// Reports that a class declares a name twice.
    ///
    /// `old` is the index of the element that is there already. Both places are shown in the message.
    fn duplicate(&mut self, t: &Template<'a>, old: u32, name: ast::Ident) {
        let class = self.instance.library.full_name(t.class);
        let first = match t.elements[old as usize].kind {
            TemplateElementKind::Component(c) => c.name.span,
            TemplateElementKind::Class(c) => c.name.span,
        };
        self.instance.report(
            Diagnostic::new(Code::Duplicate, format!("`{}` is declared twice in `{class}`", name.name))
                .at(name.span, "declared again here")
                .at(first, "first declared here")
                .class(class)
                .help("rename or remove one of the two"),
        );
    }

    /// Adds the class named in an `extends` clause or a short class definition, with its modifiers.
    /// `base` is the class in which the clause stands.
    ///
    /// For a predefined type, `type Length = Real(unit = "m")`, the modifiers are kept as attributes.
    /// For a class they are attached to the elements that they name.
    /// An unknown base is reported, and the template is marked `broken`, so that names from it are not reported too.
    /// `chain` holds the classes that are being gathered.
    /// A base that fits the kind of the class is required by MLS 7.1.3, which is checked here.
    fn gather_extends(
        &mut self,
        t: &mut Template<'a>,
        base: u32,
        path: &'a ast::Path,
        modification: Option<&'a ast::Modification>,
        chain: &mut Vec<ClassId>,
    ) {
        let (class, parent) = (t.bases[base as usize].class, t.bases[base as usize].parent);
        let arguments = modification.map_or(&[][..], |m| m.arguments.as_slice());
        match self.find_base(class, parent, path) {
            Some(LookupResult::Builtin(b)) => {
                if matches!(self.instance.library.class(class).body, ClassBody::Long(_)) {
                    self.instance.builder().check_builtin_base(class, b, path.span);
                }
                t.builtin = Some(b);
                let sources =
                    // Bases are entered from outside inwards, so appending keeps the order outermost first.
                    arguments.iter().map(|a| ExtendsModification { what: ExtendsModificationKind::Argument(a), base });
                t.builtin_args.extend(sources);
            }
            Some(LookupResult::Class(found)) => {
                let long = matches!(self.instance.library.class(class).body, ClassBody::Long(_));
                if long {
                    self.instance.builder().check_base(class, found.class, path.span);
                }
                let shaped = t.dims.len();
                self.gather_base(t, base, &found, arguments, chain);
                // Only a short class may add dimensions; `extends` of an array type is an error for a class with
                // elements.
                if long && t.dims.len() > shaped && t.builtin.is_none() {
                    self.instance.builder().check_array_base(class, path.span);
                }
            }
            Some(_) => self.instance.unknown_class(path, class),
            None => {
                t.broken = true;
                self.instance.unknown_base(path, class, parent);
            }
        }
    }

    /// Adds a base class that was found, and attaches `arguments` to the elements that it brings.
    ///
    /// Modifiers that the base has brought along from where it was found are kept in `base_args`.
    /// If the base turns out to be a predefined type, `arguments` become attributes and stand before those of the base.
    /// At the end the class knows all names that the base knows.
    fn gather_base(
        &mut self,
        t: &mut Template<'a>,
        base: u32,
        found: &ClassRef<'a>,
        arguments: &'a [ast::ModificationArgument],
        chain: &mut Vec<ClassId>,
    ) {
        let before = t.builtin_args.len();
        let inner = u32::try_from(t.bases.len()).expect("fewer than 2^32 bases");
        t.base_args.extend(found.args.iter().map(|arg| (inner, arg.clone())));
        self.gather(t, found.class, found.parent, chain);
        let names = t.bases[inner as usize].names.clone();
        // Outer attribute modifications come before those of the type chain.
        let outer = arguments.iter().map(|a| ExtendsModification { what: ExtendsModificationKind::Argument(a), base });
        if t.builtin.is_some() {
            let own: Vec<_> = outer.collect();
            t.builtin_args.splice(before..before, own);
        } else {
            self.modify_inherited(t, base, inner, arguments);
        }
        // Only now does the class itself know the names: they were not visible while its base was looked up.
        t.bases[base as usize].names.extend(names);
    }

    /// Attaches the modifiers of an `extends` clause to the inherited elements that they name.
    /// `inner` is the base that the clause names, `base` the class in which it stands.
    ///
    /// ```text
    /// extends B(x = 1, redeclare model M = N, break y, break connect(a, b));
    /// ```
    ///
    /// - Modifiers and redeclarations are put in front of those that are there, since they are further out.
    /// - `break` of a component or connection is applied at once (MLS 7.4).
    /// - A name that the base does not have is reported, unless a base is missing.
    /// - An element that comes through two equal `extends` clauses takes the modifier once (MLS 5.6.1.2).
    ///
    /// The modifiers of one clause keep their order among each other.
    fn modify_inherited(
        &mut self,
        t: &mut Template<'a>,
        base: u32,
        inner: u32,
        arguments: &'a [ast::ModificationArgument],
    ) {
        // How many modifiers of this clause each element has: they go in front of inner ones and keep their order.
        let mut at: FxHashMap<Symbol, usize> = FxHashMap::default();
        for argument in arguments {
            let target = match &argument.kind {
                ModificationArgumentKind::Modify { path, .. } => path.parts[0],
                ModificationArgumentKind::Component(c) => c.name,
                ModificationArgumentKind::Class(c) => c.name,
                ModificationArgumentKind::BreakComponent(name) => {
                    self.break_component(t, inner, *name);
                    continue;
                }
                ModificationArgumentKind::BreakConnect(a, b) => {
                    if !t.broken && !t.bases[inner as usize..].iter().any(|base| connects(base.ast, (a, b))) {
                        let class = self.instance.library.full_name(t.bases[inner as usize].class);
                        self.instance.unknown_connection(a, b, &class);
                    }
                    // The base does not know which of its own bases has the equation, so all below it get the entry.
                    for i in inner as usize..t.bases.len() {
                        t.bases[i].broken_connects.push((a, b));
                    }
                    continue;
                }
            };
            match t.by_name.get(&target.name).filter(|_| t.bases[inner as usize].names.contains(&target.name)) {
                Some(&i) => {
                    let place = at.entry(target.name).or_insert(0);
                    // an element inherited twice takes what the first of two equal `extends` says of it (MLS 5.6.1.2)
                    let element = &mut t.elements[i as usize];
                    let twice = element.base < inner
                        && element.modified.iter().any(
                            |s| matches!(s.what, ExtendsModificationKind::Argument(a) if says_the_same(a, argument)),
                        );
                    if twice {
                        continue;
                    }
                    let modified = &mut element.modified;
                    modified.insert(
                        *place,
                        ExtendsModification { what: ExtendsModificationKind::Argument(argument), base },
                    );
                    *place += 1;
                }
                // A base is missing: the name may belong to it, and the missing base has its own message.
                None if t.broken => {}
                None => {
                    let class = self.instance.library.full_name(t.bases[inner as usize].class);
                    let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).collect();
                    self.instance.unknown_modifier(target, &class, &names);
                }
            }
        }
    }

    /// The inherited class that `redeclare model extends M` replaces and extends (MLS 7.3.1).
    ///
    /// This is the next redeclaration further in than the class `ast`, or else the first declaration.
    /// `None` if the surroundings have no such element, which has its own message.
    ///
    /// ```text
    /// package P extends Q;
    ///   redeclare model extends M ... end M;   // extends the M of Q
    /// end P;
    /// ```
    ///
    /// While the bases of the surrounding package are looked up, its template is not known yet. The package is then
    /// looked up again from its text.
    fn replaced_class(&mut self, ast: &'a ast::Class, parent: LookupContext) -> Option<ClassRef<'a>> {
        let mut scope = parent.scope;
        let mut holder = self.instance.scope(scope).template.clone();
        if !holder.by_name.contains_key(&ast.name.name) {
            // seen from an `extends` clause beside it, before anything inherited is known
            let base = holder.bases.get(parent.base as usize)?;
            let around = ClassRef { class: base.class, parent: base.parent, args: Rc::from([]) };
            scope = self.package(&around);
            holder = self.instance.scope(scope).template.clone();
        }
        let element = &holder.elements[*holder.by_name.get(&ast.name.name)? as usize];
        let TemplateElementKind::Class(declared) = element.kind else { return None };
        let own =
            |s: &ExtendsModification<'a>| matches!(s.what, ExtendsModificationKind::Class(c) if std::ptr::eq(c, ast));
        // The entries after the own one are further in; the class extends the nearest of them.
        let below = element.modified.iter().position(own)? + 1;
        let redeclared = element.modified[below..].iter().find_map(|s| match s.what {
            ExtendsModificationKind::Class(c) => Some((c, s.base)),
            ExtendsModificationKind::Argument(a) => match &a.kind {
                ModificationArgumentKind::Class(c) => Some((&**c, s.base)),
                _ => None,
            },
            ExtendsModificationKind::Component(_) => None,
        });
        let (class, base) = redeclared.unwrap_or((declared, element.base));
        let class = self.instance.library.enter(class, Some(holder.bases[base as usize].class));
        Some(ClassRef { class, parent: LookupContext { scope, base }, args: Rc::from([]) })
    }

    /// Applies `extends B(break x)` (MLS 7.4): removes `x`, and notes that its connections are to be removed.
    ///
    /// The element must come from the base `inner`. A name that is not there is reported.
    /// Later elements move down by one, so the table of names is made again.
    fn break_component(&mut self, t: &mut Template<'a>, inner: u32, name: ast::Ident) {
        match t.by_name.remove(&name.name) {
            Some(i) => {
                t.elements.remove(i as usize);
                // Removal moves all later elements down by one.
                t.by_name = (0u32..).zip(&t.elements).map(|(i, e)| (e.name, i)).collect();
                for base in &mut t.bases[inner as usize..] {
                    base.names.remove(&name.name);
                    base.broken_components.push(name.name);
                }
            }
            None => {
                let class = self.instance.library.full_name(t.bases[inner as usize].class);
                let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).collect();
                self.instance.unknown_modifier(name, &class, &names);
            }
        }
    }
}

/// Whether the equations of a class contain this connection, also inside `if` and `for` equations.
/// The texts of both ports are compared, so `a[1 + 1]` and `a[2]` are different connections here.
/// Connections in the bases of the class are not searched; the caller goes through all bases.
fn connects(class: &ast::Class, pair: (&ast::Expr, &ast::Expr)) -> bool {
    /// Searches some equations and those nested in them. `when` equations contain no connections.
    fn among(equations: &[ast::Equation], pair: (&ast::Expr, &ast::Expr)) -> bool {
        equations.iter().any(|equation| match &equation.kind {
            ast::EquationKind::Connect(a, b) => same_pair((a, b), pair),
            ast::EquationKind::If { branches, otherwise } => {
                branches.iter().any(|(_, body)| among(body, pair)) || among(otherwise, pair)
            }
            ast::EquationKind::For { body, .. } => among(body, pair),
            _ => false,
        })
    }
    matches!(&class.body, ClassBody::Long(body) if among(&body.equations, pair))
}

/// Whether two connections are written alike, subscripts included, in either order of their ports (MLS 7.4).
pub fn same_pair(a: (&ast::Expr, &ast::Expr), b: (&ast::Expr, &ast::Expr)) -> bool {
    let text = |pair: (&ast::Expr, &ast::Expr)| (pair.0.to_string(), pair.1.to_string());
    let (a, b) = (text(a), text(b));
    a == b || (a.0 == b.1 && a.1 == b.0)
}

/// Whether two declarations of one name agree, as inheriting an element twice requires (MLS 5.6.1.2).
/// Only the last part of the class name, the prefixes and the number of dimensions are compared.
fn same_declaration(a: TemplateElementKind<'_>, b: TemplateElementKind<'_>) -> bool {
    match (a, b) {
        (TemplateElementKind::Component(a), TemplateElementKind::Component(b)) => {
            let last = |p: &ast::Path| p.parts.last().map(|i| i.name);
            last(&a.class) == last(&b.class) && a.prefix == b.prefix && a.subscripts.len() == b.subscripts.len()
        }
        (TemplateElementKind::Class(a), TemplateElementKind::Class(b)) => std::ptr::eq(a, b) || same_short_class(a, b),
        _ => false,
    }
}

/// Whether two short classes are declared alike: same kind, same last part of the class name.
fn same_short_class(a: &ast::Class, b: &ast::Class) -> bool {
    let (ClassBody::Short { base: x, .. }, ClassBody::Short { base: y, .. }) = (&a.body, &b.body) else { return false };
    let last = |p: &ast::Path| p.parts.last().map(|i| i.name);
    a.kind == b.kind && last(x) == last(y)
}

/// Whether two modifiers of an element are written alike, inner modifiers included.
/// Redeclarations never count as equal.
///
/// Path, value and nested modifiers must agree in text. Prefixes such as `each` and `final` are not compared.
fn says_the_same(a: &ast::ModificationArgument, b: &ast::ModificationArgument) -> bool {
    let (
        ModificationArgumentKind::Modify { path: p, modification: x, .. },
        ModificationArgumentKind::Modify { path: q, modification: y, .. },
    ) = (&a.kind, &b.kind)
    else {
        return false;
    };
    let value = |m: &Option<ast::Modification>| m.as_ref().and_then(|m| m.value.as_ref()).map(ToString::to_string);
    let inner = |m: &'_ Option<ast::Modification>| m.as_ref().map_or(0, |m| m.arguments.len());
    let pairs = |m: &Option<ast::Modification>, n: &Option<ast::Modification>| match (m, n) {
        (Some(m), Some(n)) => m.arguments.iter().zip(&n.arguments).all(|(a, b)| says_the_same(a, b)),
        _ => true,
    };
    p.dotted() == q.dotted() && value(x) == value(y) && inner(x) == inner(y) && pairs(x, y)
}
