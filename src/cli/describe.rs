//! Describes a class of the shipped library as text: ports, parameters, members of a package.
//!
//! A class name enters, a page of text leaves. `bramah explain` calls it. Only the syntax trees are read; nothing is
//! instantiated.

use bramah_model::resolve::names::{self, MemberComponent};
use bramah_model::resolve::{ClassId, Library, SyntaxArena};
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::ast::{ClassKind, VariabilityPrefix};
use bramah_syntax::world::World;
use std::fmt::Write;

/// The packages of the library that are searched and suggested.
const PACKAGES: [&str; 7] = ["Hydraulic", "Oil", "Pneumatic", "Mechanical", "Electrical", "Thermal", "Signal"];

/// The page about a shipped class. `None`: there is no class of this name.
pub(super) fn describe(name: &str) -> Option<String> {
    with_library(|library| {
        let id = library.find(name)?;
        let class = library.class(id);
        let mut page = format!("{name}: {}\n", class.description.as_deref().unwrap_or("(no description)"));
        match class.kind {
            ClassKind::Package => members(library, id, &mut page),
            _ => offers(library, id, &mut page),
        }
        Some(page)
    })
}

/// Names of classes that contain the last part of `name`, separated by commas; the packages when there are none.
pub(super) fn resembling(name: &str) -> String {
    with_library(|library| {
        let last = name.rsplit('.').next().unwrap_or_default().to_lowercase();
        let mut found = Vec::new();
        for package in PACKAGES {
            if let Some(id) = library.find(package) {
                search(library, id, &last, &mut found);
            }
        }
        if found.is_empty() { PACKAGES.map(str::to_owned).to_vec() } else { found }
    })
    .join(", ")
}

/// Calls `act` with a library of the shipped packages. Files are parsed as their classes are asked for.
fn with_library<T>(act: impl FnOnce(&mut Library<'_>) -> T) -> T {
    let (trees, shipped) = (SyntaxArena::new(), ShippedWorld);
    let roots = ShippedWorld::roots().map(|root| (&shipped as &dyn World, root)).into();
    act(&mut Library::new(&trees, roots))
}

/// Collects classes below `id` whose own name contains `word`.
///
/// The search descends into packages only.
fn search(library: &mut Library<'_>, id: ClassId, word: &str, found: &mut Vec<String>) {
    for child in children(library, id) {
        let name = library.full_name(child);
        let own = name.rsplit('.').next().unwrap_or_default().to_lowercase();
        // Words of one or two letters match nearly everything. Examples are models, not components to use.
        if !name.contains(".Examples") && word.len() > 2 && own.contains(word) {
            found.push(name);
        }
        search(library, child, word, found);
    }
}

/// The classes in a package, those of its own file first. Other classes count as having none.
fn children(library: &mut Library<'_>, id: ClassId) -> Vec<ClassId> {
    if library.class(id).kind == ClassKind::Package { names::classes(library, id) } else { Vec::new() }
}

/// Adds the members of a package to the page, a line each.
fn members(library: &mut Library<'_>, id: ClassId, page: &mut String) {
    let rows = children(library, id).into_iter().map(|child| {
        let class = library.class(child);
        [library.full_name(child), class.description.as_deref().unwrap_or_default().to_owned(), String::new()]
    });
    let rows: Vec<[String; 3]> = rows.collect();
    table(page, &rows);
    page.push_str("\n`bramah explain CLASS` shows ports and parameters of one of them.\n");
}

/// Adds public ports, parameters and replaceable parts to the page, inherited ones included.
///
/// Each group has a title and is left out when it is empty. A conditional port shows its condition.
fn offers(library: &mut Library<'_>, id: ClassId, page: &mut String) {
    let (mut ports, mut parameters, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    for member in names::members(library, id).into_iter().filter(|m| !m.protected) {
        let c = member.component;
        let said = c.description.as_deref().unwrap_or_default().to_owned();
        let class = c.class.dotted();
        if c.prefix.variability == Some(VariabilityPrefix::Parameter) {
            parameters.push([c.name.name.as_str().to_owned(), value(library, member), said]);
        // Connectors of the library lie in packages named `Interfaces`. This spares resolving each type.
        } else if class.contains("Interfaces.") {
            let when = c.condition.as_ref().map(|e| format!(" if {}", library.sources.text(e.span)));
            ports.push([c.name.name.as_str().to_owned(), class + &when.unwrap_or_default(), said]);
        } else if c.prefixes.replaceable {
            parts.push([c.name.name.as_str().to_owned(), class, said]);
        }
    }
    for (title, rows) in [("Ports", ports), ("Parameters", parameters), ("Parts that can be redeclared", parts)] {
        if !rows.is_empty() {
            let _ = write!(page, "\n{title}\n");
            table(page, &rows);
        }
    }
}

/// Type, default, unit and range of a parameter as far as they are declared: `Area = 1e-6 m2, 1e-12 to 10`.
fn value<'a>(library: &mut Library<'a>, member: MemberComponent<'a>) -> String {
    let c = member.component;
    let mut text = c.class.parts.last().map_or("", |p| p.name.as_str()).to_owned();
    let said = |library: &mut Library<'a>, name: &str| {
        let value = names::attribute(library, member, name)?;
        Some(library.sources.text(value.span).trim_matches('"').to_owned())
    };
    let (unit, min, max) = (said(library, "unit"), said(library, "min"), said(library, "max"));
    if let Some(e) = c.modification.as_ref().and_then(|m| m.value.as_ref()) {
        let _ = write!(text, " = {}", library.sources.text(e.span));
    }
    // The unit `1` marks a number without dimension and tells the reader nothing.
    let _ = write!(text, "{}", unit.filter(|u| u != "1").map_or(String::new(), |u| format!(" {u}")));
    match (min, max) {
        (Some(min), Some(max)) => text + &format!(", {min} to {max}"),
        (Some(min), None) => text + &format!(", at least {min}"),
        (None, Some(max)) => text + &format!(", at most {max}"),
        (None, None) => text,
    }
}

/// Adds rows as aligned columns.
///
/// Each row has name, type or value, and description.
fn table(page: &mut String, rows: &[[String; 3]]) {
    // A single long cell must not push the other columns off the terminal.
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0).min(40);
    let (first, second) = (width(0), width(1));
    for [name, what, said] in rows {
        let line = format!("  {name:first$}  {what:second$}  {said}");
        page.push_str(line.trim_end());
        page.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_shows_what_it_inherits() {
        let page = describe("Hydraulic.Pump").expect("it ships");
        for wanted in ["port_a", "u  ", "if useInput", "deadVolume", "k_p", "Real = 0.05"] {
            assert!(page.contains(wanted), "{wanted}:\n{page}");
        }
    }

    #[test]
    fn packages_list_their_members() {
        assert!(describe("Hydraulic").expect("it ships").contains("Hydraulic.CounterbalanceValve"));
        assert!(describe("Hydraulic.Spool").expect("it ships").contains("Hydraulic.Spool.SecondOrder"));
        assert_eq!(describe("Hydraulics.Pump"), None);
    }

    #[test]
    fn words_lead_to_classes() {
        assert!(resembling("counterbalance").contains("Hydraulic.CounterbalanceValve"));
        assert!(resembling("xyz").starts_with("Hydraulic, Oil"));
    }
}
