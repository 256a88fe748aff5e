//! What a class holds, inherited elements included: gathered once per class, shared by all its instances.

use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::modifiers::Modifier;
use crate::instance::{ClassRef, LookupContext, NameLookup};
use crate::resolve::ClassId;
use bramah_syntax::ast::{self, ClassBody, ElementKind, ModificationArgumentKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;

/// The elements of a class.
#[derive(Clone)]
pub struct Template<'a> {
    /// The class.
    pub class: ClassId,
    /// The class and everything it extends; 0 is the class itself.
    pub bases: Vec<BaseClass<'a>>,
    /// Elements in declaration order, inherited ones where the `extends` stands.
    pub elements: Vec<TemplateElement<'a>>,
    /// Elements by name.
    pub by_name: FxHashMap<Symbol, u32>,
    /// The built-in type this class is a kind of.
    pub builtin: Option<BuiltinType>,
    /// Attribute modifications along the chain of types, outermost first.
    pub builtin_args: Vec<ExtendsModification<'a>>,
    /// What is modified of a base class where it was found, with the index of that base, outermost first: a class element
    /// carries the modifiers of its `constrainedby` and of the component or package that holds it.
    pub base_args: Vec<(u32, Modifier<'a>)>,
    /// Array dimensions of a type such as `type Triple = Real[3]`, outermost last.
    pub dims: Vec<(&'a [ast::Subscript], u32)>,
    /// Prefixes of a short class (`connector In = input Real`).
    pub prefix: ast::TypePrefix,
    /// The class that says what is inside: itself, or the end of a chain of short classes.
    pub kind: ast::ClassKind,
    /// An `extends` could not be resolved, so names may be missing through no fault of the user.
    pub broken: bool,
}

/// A class that contributes elements, equations and a place to look up names.
#[derive(Clone)]
pub struct BaseClass<'a> {
    /// The class.
    pub class: ClassId,
    /// Its syntax.
    pub ast: &'a ast::Class,
    /// What lies around it. `None` when it stands inside the instance itself.
    pub parent: LookupContext,
    /// Names of elements that it knows, its own and inherited.
    pub names: FxHashSet<Symbol>,
    /// Its imports.
    pub imports: Vec<&'a ast::Import>,
    /// A short class: names in its modifiers mean what they mean around it.
    pub short: bool,
    /// `connect` equations removed by `break` (with texts of both sides).
    pub broken_connects: Vec<(&'a ast::Expr, &'a ast::Expr)>,
    /// Components removed by `break`; their connections go with them.
    pub broken_components: Vec<Symbol>,
}

impl Template<'_> {
    /// A class that holds nothing.
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

    /// Whether a class holds what a package holds: classes and constants. Other kinds than models are never used as one.
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
    /// A class before its elements are known.
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

/// One element.
#[derive(Clone)]
pub struct TemplateElement<'a> {
    /// Its name.
    pub name: Symbol,
    /// What it is.
    pub kind: TemplateElementKind<'a>,
    /// The base it is declared in.
    pub base: u32,
    /// Modifications by `extends` clauses, outermost first.
    pub modified: Vec<ExtendsModification<'a>>,
    /// In a protected section.
    pub protected: bool,
    /// Where it stands.
    pub span: Span,
}

/// A component or a class.
#[derive(Clone, Copy)]
pub enum TemplateElementKind<'a> {
    /// A component.
    Component(&'a ast::ComponentDeclaration),
    /// A class.
    Class(&'a ast::Class),
}

/// A modification written in one of the bases.
#[derive(Clone, Copy)]
pub struct ExtendsModification<'a> {
    /// What it is.
    pub what: ExtendsModificationKind<'a>,
    /// The base whose names it uses.
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

/// The longest chain of `extends`, and the most classes whose bases or constraints are being looked up inside each other.
pub(super) const DEEPEST: usize = 100;

/// The most bases that are gathered for one class, those found on the way to them included: a class of a large library
/// has some hundreds. What goes in circles many times over would take for ever before it is [`DEEPEST`].
const MOST_BASES: usize = 20_000;

impl<'a> NameLookup<'_, 'a, '_> {
    /// The template of a class at a place.
    pub fn template(&mut self, class: ClassId, parent: LookupContext) -> Rc<Template<'a>> {
        if let Some(t) = self.instance.classes.templates.get(&(class, parent)) {
            return t.clone();
        }
        let ast = self.instance.library.class(class);
        let mut t = Template::empty(class, ast.kind);
        if self.instance.classes.gathering.is_empty() {
            self.instance.classes.gathered = 0;
        }
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

    fn gathered_now(&self) -> Vec<ClassId> {
        self.instance.classes.gathering.iter().map(|&(class, _)| class).collect()
    }

    /// A class whose own lookup asks for further ones without end: those being looked up, innermost last.
    pub(super) fn endless_lookup(&mut self, what: &str, class: ClassId, around: &[ClassId]) {
        let mut circle: Vec<String> = Vec::new();
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

    /// Adds a class and what it extends to the template; returns the index of its base.
    fn gather(&mut self, t: &mut Template<'a>, class: ClassId, parent: LookupContext, chain: &mut Vec<ClassId>) -> u32 {
        let ast = self.instance.library.class(class);
        let base = u32::try_from(t.bases.len()).expect("fewer than 2^32 bases");
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
        // reported once, and then not tried to its end again
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

    fn gather_long(&mut self, t: &mut Template<'a>, base: u32, body: &'a ast::LongBody, chain: &mut Vec<ClassId>) {
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
        t.bases[base as usize].names.extend(names);
    }

    fn modify_inherited(
        &mut self,
        t: &mut Template<'a>,
        base: u32,
        inner: u32,
        arguments: &'a [ast::ModificationArgument],
    ) {
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
                None if t.broken => {}
                None => {
                    let class = self.instance.library.full_name(t.bases[inner as usize].class);
                    let names: Vec<Symbol> = t.elements.iter().map(|e| e.name).collect();
                    self.instance.unknown_modifier(target, &class, &names);
                }
            }
        }
    }

    /// The inherited class that `redeclare model extends M` takes the place of and extends (MLS 7.3.1): the declaration,
    /// or the redeclaration nearest to it, below the one that is given.
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

    /// Selective extension (Modelica 3.6, 7.4): `extends B(break x)` leaves out `x` and its connections.
    fn break_component(&mut self, t: &mut Template<'a>, inner: u32, name: ast::Ident) {
        match t.by_name.remove(&name.name) {
            Some(i) => {
                t.elements.remove(i as usize);
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

/// Whether a class connects two ports, written so.
fn connects(class: &ast::Class, pair: (&ast::Expr, &ast::Expr)) -> bool {
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

/// Whether two pairs of ports are written alike, subscripts included (MLS 7.4).
pub fn same_pair(a: (&ast::Expr, &ast::Expr), b: (&ast::Expr, &ast::Expr)) -> bool {
    let text = |pair: (&ast::Expr, &ast::Expr)| (pair.0.to_string(), pair.1.to_string());
    let (a, b) = (text(a), text(b));
    a == b || (a.0 == b.1 && a.1 == b.0)
}

/// Whether two declarations of one name say the same, as inheriting an element twice requires (MLS 5.6.1.2).
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

/// Whether two short classes are declared alike, as in `replaceable package Medium = Media.PartialMedium`.
fn same_short_class(a: &ast::Class, b: &ast::Class) -> bool {
    let (ClassBody::Short { base: x, .. }, ClassBody::Short { base: y, .. }) = (&a.body, &b.body) else { return false };
    let last = |p: &ast::Path| p.parts.last().map(|i| i.name);
    a.kind == b.kind && last(x) == last(y)
}

/// Whether a modifier of an element says what another one says already.
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
