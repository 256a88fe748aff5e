//! The meaning of names by the text alone, with inheritance and imports.
//!
//! Pages, descriptions and editors use it, which look at classes without an instance.
//! A redeclared class counts as it is declared. Modifiers are not applied; see `instance` for that.

use super::{ClassId, Library, nested_classes};
use bramah_syntax::ast::{
    Class, ClassBody, ClassKind, ComponentDeclaration, ElementKind, EnumLiteral, Expr, Ident, Import, LongBody,
    Modification, ModificationArgumentKind, Path,
};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// What a name stands for.
#[derive(Clone, Copy, Debug)]
pub enum NameTarget<'a> {
    /// A class.
    Class(ClassId),
    /// A component.
    Component(MemberComponent<'a>),
    /// A literal of an enumeration: the class and the literal.
    Literal(ClassId, &'a EnumLiteral),
    /// The variable of a `for` loop.
    Iterator(Ident),
}

/// A component with the class that declares it.
#[derive(Clone, Copy, Debug)]
pub struct MemberComponent<'a> {
    /// The class that declares it: the class itself or one of its bases.
    pub owner: ClassId,
    /// Its declaration.
    pub component: &'a ComponentDeclaration,
    /// Declared in a protected section.
    pub protected: bool,
}

/// The body of a class. `None` for short classes, enumerations and the like.
pub fn body(class: &Class) -> Option<&LongBody> {
    match &class.body {
        ClassBody::Long(body) => Some(body),
        _ => None,
    }
}

/// The direct bases of a class, in the order of the text. Bases that are not found are left out.
pub fn bases(library: &mut Library<'_>, id: ClassId) -> Vec<ClassId> {
    known_bases(library, id).to_vec()
}

/// Like [`bases`], from the table if they were looked for before.
/// While they are looked for, the class has none. That ends the search for classes that need each other.
/// Short classes have one base, other classes one for each `extends` clause.
fn known_bases(library: &mut Library<'_>, id: ClassId) -> Rc<[ClassId]> {
    if let Some(known) = &library.entries[id.0 as usize].bases {
        return known.clone();
    }
    library.entries[id.0 as usize].bases = Some(Rc::from([]));
    let class = library.class(id);
    let paths: Vec<&Path> = match &class.body {
        ClassBody::Short { base, .. } => vec![base],
        ClassBody::Long(body) => body.elements.iter().filter_map(|e| base(&e.kind)).collect(),
        _ => Vec::new(),
    };
    // Bases that are not found are left out; the instance reports them.
    let found: Rc<[ClassId]> = paths.into_iter().filter_map(|p| resolve_outside(library, id, p)).collect();
    library.entries[id.0 as usize].bases = Some(found.clone());
    found
}

/// A class and everything that it inherits from, nearest first, each once.
/// The order is breadth first, so that direct bases come before their own bases.
pub fn lineage(library: &mut Library<'_>, id: ClassId) -> Vec<ClassId> {
    let mut found = vec![id];
    let mut next = 0;
    while next < found.len() {
        for &base in &*known_bases(library, found[next]) {
            if !found.contains(&base) {
                found.push(base);
            }
        }
        next += 1;
    }
    found
}

/// The components of a class: its own first, then inherited ones.
/// A component that is inherited twice appears twice.
pub fn members<'a>(library: &mut Library<'a>, id: ClassId) -> Vec<MemberComponent<'a>> {
    let mut found = Vec::new();
    for owner in lineage(library, id) {
        let Some(body) = body(library.class(owner)) else { continue };
        found.extend(body.elements.iter().filter_map(|e| match &e.kind {
            ElementKind::Component(component) => Some(MemberComponent { owner, component, protected: e.protected }),
            _ => None,
        }));
    }
    found
}

/// The classes in a class: its own first, then inherited ones. For a package also those in its folder.
pub fn classes(library: &mut Library<'_>, id: ClassId) -> Vec<ClassId> {
    let mut found = Vec::new();
    for owner in lineage(library, id) {
        let mut names: Vec<Symbol> = nested_classes(library.class(owner)).map(|c| c.name.name).collect();
        names.extend(library.folder_members(owner));
        found.extend(names.into_iter().filter_map(|name| library.child(owner, name)));
    }
    // A class may be in the text and in the folder: such neighbours are one entry.
    found.dedup();
    found
}

/// The class that a path means inside of a class. `None` if it means none.
pub fn resolve(library: &mut Library<'_>, from: ClassId, path: &Path) -> Option<ClassId> {
    named(library, Some(from), &words(path), path.global)
}

/// The class of a component. `None` for predefined types.
pub fn type_of(library: &mut Library<'_>, member: MemberComponent<'_>) -> Option<ClassId> {
    resolve(library, member.owner, &member.component.class)
}

/// The value that a component or its type gives to an attribute such as `unit`. `None` if neither does.
/// Only modifiers written as `unit = ...` in the declaration or in short classes count.
pub fn attribute<'a>(library: &mut Library<'a>, member: MemberComponent<'a>, name: &str) -> Option<&'a Expr> {
    if let Some(value) = given(member.component.modification.as_ref(), name) {
        return Some(value);
    }
    let class = type_of(library, member)?;
    lineage(library, class).into_iter().find_map(|class| match &library.class(class).body {
        ClassBody::Short { modification, .. } => given(modification.as_ref(), name),
        _ => None,
    })
}

/// The value that a modification gives to an attribute.
/// Only a modifier whose path is the attribute itself counts.
fn given<'a>(modification: Option<&'a Modification>, name: &str) -> Option<&'a Expr> {
    modification?.arguments.iter().find_map(|argument| match &argument.kind {
        ModificationArgumentKind::Modify { path, modification: Some(m), .. }
            if path.parts.len() == 1 && path.parts[0].name == name =>
        {
            m.value.as_ref()
        }
        _ => None,
    })
}

/// What a word means inside of a class. `None` if it means nothing.
///
/// The order is that of MLS 5.3.1: elements and inherited elements, imports, then the same in the enclosing classes.
pub fn lookup<'a>(library: &mut Library<'a>, from: ClassId, name: Symbol) -> Option<NameTarget<'a>> {
    let mut scope = Some(from);
    while let Some(id) = scope {
        if let Some(found) = element(library, id, name) {
            return Some(found);
        }
        if let Some(found) = imported(library, id, name) {
            return Some(NameTarget::Class(found));
        }
        scope = library.parent(id);
    }
    library.top(name).map(NameTarget::Class)
}

/// What a word means as an element of a class, its own or an inherited one: literal, component or class.
/// The class itself is searched first, then its bases, nearest first.
/// `None` if no class in the line of inheritance has it.
pub fn element<'a>(library: &mut Library<'a>, class: ClassId, name: Symbol) -> Option<NameTarget<'a>> {
    for owner in lineage(library, class) {
        let ast = library.class(owner);
        // Literals are no elements of the syntax tree, so they are searched first.
        if let ClassBody::Enumeration(Some(literals)) = &ast.body
            && let Some(literal) = literals.iter().find(|l| l.name.name == name)
        {
            return Some(NameTarget::Literal(owner, literal));
        }
        let component = body(ast).into_iter().flat_map(|b| &b.elements).find_map(|e| match &e.kind {
            ElementKind::Component(component) if component.name.name == name => {
                Some(MemberComponent { owner, component, protected: e.protected })
            }
            _ => None,
        });
        if let Some(member) = component {
            return Some(NameTarget::Component(member));
        }
        if let Some(child) = library.child(owner, name) {
            return Some(NameTarget::Class(child));
        }
    }
    None
}

/// The class in which elements of something are looked up: a class itself, or that of a component.
/// `None` for literals, loop variables, and components of predefined types.
pub fn inside(library: &mut Library<'_>, target: NameTarget<'_>) -> Option<ClassId> {
    match target {
        NameTarget::Class(id) => Some(id),
        NameTarget::Component(member) => type_of(library, member),
        NameTarget::Literal(..) | NameTarget::Iterator(_) => None,
    }
}

/// The parts of a path.
fn words(path: &Path) -> Vec<Symbol> {
    path.parts.iter().map(|p| p.name).collect()
}

/// The path in an `extends` clause. `None` for other elements.
fn base(kind: &ElementKind) -> Option<&Path> {
    match kind {
        ElementKind::Extends(x) => Some(&x.base),
        _ => None,
    }
}

/// Like [`resolve`], for the bases of a class: inherited names do not count (MLS 5.6.1).
/// Classes written in the class itself are found, and so are its imports.
fn resolve_outside(library: &mut Library<'_>, class: ClassId, path: &Path) -> Option<ClassId> {
    let parts = words(path);
    if !path.global {
        // A class cannot be its own base: `model A extends A` means another `A` further out.
        let own = library.child(class, parts[0]).filter(|f| *f != class);
        if let Some(found) = own.or_else(|| imported(library, class, parts[0])) {
            return descend(library, found, &parts[1..]);
        }
    }
    let parent = library.parent(class);
    named(library, parent, &parts, path.global)
}

/// The class that dotted words mean inside of `from`, or at the top level without it.
/// `global` is true for a path with a leading dot, which begins at the top level.
pub fn named(library: &mut Library<'_>, from: Option<ClassId>, parts: &[Symbol], global: bool) -> Option<ClassId> {
    let (first, rest) = parts.split_first()?;
    let mut scope = from.filter(|_| !global);
    while let Some(id) = scope {
        // What the class itself has comes before its imports (MLS 5.3.1).
        if let Some(found) = member(library, id, *first).or_else(|| imported(library, id, *first)) {
            return descend(library, found, rest);
        }
        scope = library.parent(id);
    }
    let top = library.top(*first)?;
    descend(library, top, rest)
}

/// A class in a class, its own or an inherited one.
fn member(library: &mut Library<'_>, id: ClassId, name: Symbol) -> Option<ClassId> {
    lineage(library, id).into_iter().find_map(|class| library.child(class, name))
}

/// The class that a name means through the imports of a class. `None` if no import declares it or its path is wrong.
/// Imported paths begin at the top level (MLS 13.2.1).
/// An import of all names of a package is tried with the name itself.
fn imported(library: &mut Library<'_>, id: ClassId, name: Symbol) -> Option<ClassId> {
    let body = body(library.class(id))?;
    for element in &body.elements {
        let ElementKind::Import(import) = &element.kind else { continue };
        let (path, last) = match import {
            Import::Single { alias, path } => {
                let last = path.parts.last().expect("a path has parts").name;
                (path, (alias.map_or(last, |a| a.name) == name).then_some(None))
            }
            Import::All(path) => (path, Some(Some(name))),
            Import::Some(path, names) => (path, names.iter().any(|n| n.name == name).then_some(Some(name))),
        };
        let Some(last) = last else { continue };
        let parts: Vec<Symbol> = words(path).into_iter().chain(last).collect();
        let found = named(library, None, &parts, true);
        if found.is_some() {
            return found;
        }
    }
    None
}

/// Follows words from a class inwards. Imports of a class do not count from outside (MLS 13.2.1).
fn descend(library: &mut Library<'_>, id: ClassId, parts: &[Symbol]) -> Option<ClassId> {
    parts.iter().try_fold(id, |id, part| member(library, id, *part))
}

/// Whether a class is a connector, or extends one.
pub fn is_connector(library: &mut Library<'_>, id: ClassId) -> bool {
    lineage(library, id).into_iter().any(|c| matches!(library.class(c).kind, ClassKind::Connector { .. }))
}
