//! The classes of `components/` and `models/` by name, what they inherit, and who uses whom.

pub use bramah::internals::resolve::names::{MemberComponent, bases, body, lineage, named, resolve};
use bramah::internals::resolve::{ClassId, Library, names, nested_classes};
use bramah::internals::syntax::ast::{
    Class, ClassBody, ClassKind, ElementKind, Expr, ModificationArgument, ModificationArgumentKind, Path,
};
use bramah::internals::syntax::symbol::Symbol;
use std::collections::BTreeMap;

/// Packages of the handbook, in the order in which they are shown.
pub const PACKAGES: [&str; 17] = [
    "Hydraulic",
    "Oil",
    "Pneumatic",
    "Mechanical",
    "Electrical",
    "Thermal",
    "Signal",
    "Interfaces",
    "Smooth",
    "Effects",
    "Modelica",
    "ServoPump",
    "ClosedCircuit",
    "CoupledDrives",
    "Emps",
    "CascadedTanks",
    "GapAxis",
];

/// All classes with pages, and the examples that show them.
pub struct Catalogue {
    /// By full name.
    pub classes: BTreeMap<String, ClassId>,
    /// Members of each package, in the order of its folder.
    pub members: BTreeMap<String, Vec<String>>,
    /// For each class the examples that contain it, its own first.
    pub shown_in: BTreeMap<String, Vec<(String, String)>>,
    /// For each class those that extend it.
    pub extended_by: BTreeMap<String, Vec<String>>,
}

/// Values that `extends` clauses give to inherited components: by name, whether final.
pub type Given<'a> = BTreeMap<&'static str, (&'a Expr, bool)>;

/// Reads every class of the library.
pub fn catalogue(library: &mut Library<'_>) -> Catalogue {
    let mut catalogue = Catalogue {
        classes: BTreeMap::new(),
        members: BTreeMap::new(),
        shown_in: BTreeMap::new(),
        extended_by: BTreeMap::new(),
    };
    for package in PACKAGES {
        let id = library.find(package).expect("the package ships");
        enter(library, id, &mut catalogue);
    }
    for (name, id) in catalogue.classes.clone() {
        for base in bases(library, id) {
            catalogue.extended_by.entry(library.full_name(base)).or_default().push(name.clone());
        }
        if is_runnable(library.class(id)) {
            uses(library, id, &name, &mut catalogue);
        }
    }
    for (class, examples) in &mut catalogue.shown_in {
        let own = format!("{}Example", class.rsplit('.').next().unwrap_or_default());
        examples.sort_by_key(|(example, _)| {
            (!example.ends_with(&format!(".{own}")), !example.contains(".Examples."), example.clone())
        });
    }
    catalogue
}

fn enter(library: &mut Library<'_>, id: ClassId, catalogue: &mut Catalogue) {
    let name = library.full_name(id);
    catalogue.classes.insert(name.clone(), id);
    let class = library.class(id);
    if class.kind != ClassKind::Package {
        return;
    }
    let mut names: Vec<Symbol> = nested_classes(class).map(|c| c.name.name).collect();
    let nested = names.len();
    names.extend(library.folder_members(id));
    names[nested..].sort_by_key(|n| n.as_str().to_lowercase());
    for member in names {
        if let Some(child) = library.child(id, member) {
            catalogue.members.entry(name.clone()).or_default().push(library.full_name(child));
            enter(library, child, catalogue);
        }
    }
}

/// Notes for every class of a component of this example that the example shows it, under which name.
fn uses(library: &mut Library<'_>, id: ClassId, example: &str, catalogue: &mut Catalogue) {
    for member in members(library, id).0 {
        let at = member.component.name.name.as_str().to_owned();
        let mut found: Vec<ClassId> = resolve(library, member.owner, &member.component.class).into_iter().collect();
        for argument in member.component.modification.iter().flat_map(|m| &m.arguments) {
            found.extend(redeclared(argument).and_then(|path| resolve(library, id, path)));
        }
        for class in found {
            let shown = catalogue.shown_in.entry(library.full_name(class)).or_default();
            if shown.iter().all(|(e, _)| e != example) {
                shown.push((example.to_owned(), at.clone()));
            }
        }
    }
}

/// The class that a modifier puts in.
fn redeclared(argument: &ModificationArgument) -> Option<&Path> {
    match &argument.kind {
        ModificationArgumentKind::Component(c) => Some(&c.class),
        ModificationArgumentKind::Class(c) => match &c.body {
            ClassBody::Short { base, .. } => Some(base),
            _ => None,
        },
        _ => None,
    }
}

/// Whether the class carries an experiment.
pub fn is_runnable(class: &Class) -> bool {
    !class.prefixes.partial && annotation(class, &["experiment"]).is_some()
}

/// The modification of an annotation by path, such as `Documentation`, `info`.
pub fn annotation<'a>(class: &'a Class, path: &[&str]) -> Option<&'a bramah::internals::syntax::ast::Modification> {
    let mut at = class.annotation.as_ref()?;
    for name in path {
        at = at.arguments.iter().find_map(|a| match &a.kind {
            ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == *name => {
                Some(m)
            }
            _ => None,
        })?;
    }
    Some(at)
}

/// All components of a class, its own first, and the values that `extends` clauses give them.
pub fn members<'a>(library: &mut Library<'a>, id: ClassId) -> (Vec<MemberComponent<'a>>, Given<'a>) {
    let mut given = Given::new();
    for owner in lineage(library, id) {
        let Some(body) = body(library.class(owner)) else { continue };
        for element in &body.elements {
            if let ElementKind::Extends(x) = &element.kind {
                note_given(x.modification.iter().flat_map(|m| &m.arguments), &mut given);
            }
        }
    }
    (names::members(library, id), given)
}

fn note_given<'a>(arguments: impl Iterator<Item = &'a ModificationArgument>, given: &mut Given<'a>) {
    for argument in arguments {
        if let ModificationArgumentKind::Modify { path, modification: Some(m), .. } = &argument.kind
            && let (1, Some(value)) = (path.parts.len(), &m.value)
        {
            given.entry(path.parts[0].name.as_str()).or_insert((value, argument.final_));
        }
    }
}
