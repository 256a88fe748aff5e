//! Tables of ports, parameters, replaceable parts and variables.

use super::class::{Press, facts_of};
use super::library::{self, Given, MemberComponent};
use super::{facts, math};
use bramah::internals::plot::svg::escape;
use bramah::internals::resolve::ClassId;
use bramah::internals::syntax::ast::{CausalityPrefix, ComponentDeclaration, Subscript, VariabilityPrefix};
use std::fmt::Write as _;

/// The name of a component with its dimensions, as code.
fn name(press: &Press<'_, '_>, component: &ComponentDeclaration) -> String {
    let mut out = component.name.name.as_str().to_owned();
    if !component.subscripts.is_empty() {
        let dimension = |s: &Subscript| match s {
            Subscript::All(_) => ":".to_owned(),
            Subscript::Expr(e) => press.library.sources.text(e.span).to_owned(),
        };
        let all: Vec<String> = component.subscripts.iter().map(dimension).collect();
        let _ = write!(out, "[{}]", all.join(", "));
    }
    format!("<code>{}</code>", escape(&out))
}

fn said(component: &ComponentDeclaration) -> String {
    escape(component.description.as_deref().unwrap_or_default())
}

fn class_link(press: &mut Press<'_, '_>, member: &MemberComponent<'_>) -> String {
    let path = &member.component.class;
    let text = path.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(".");
    match library::resolve(press.library, member.owner, path) {
        Some(id) => {
            let full = press.library.full_name(id);
            let shown = if full.starts_with("Modelica.") { text } else { full };
            press.link(id, &shown)
        }
        None => escape(&text),
    }
}

fn condition(press: &Press<'_, '_>, component: &ComponentDeclaration) -> String {
    component.condition.as_ref().map_or(String::new(), |c| {
        format!(" <span class=\"said\">if <code>{}</code></span>", escape(press.library.sources.text(c.span)))
    })
}

/// Connectors, inputs and outputs.
pub fn ports<'a>(press: &mut Press<'_, 'a>, list: &[&MemberComponent<'a>]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let units: Vec<String> = list.iter().map(|m| facts_of(press, m).unit).collect();
    let any = units.iter().any(|u| !u.is_empty());
    let cell = |unit: &str| if any { format!("<td class=\"num\">{}</td>", escape(unit)) } else { String::new() };
    let mut rows = String::new();
    for (member, unit) in list.iter().zip(&units) {
        let c = member.component;
        let role = match c.prefix.causality {
            Some(CausalityPrefix::Input) => "input ",
            Some(CausalityPrefix::Output) => "output ",
            None => "",
        };
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{role}{}</td>{}<td>{}{}</td></tr>",
            name(press, c),
            class_link(press, member),
            cell(unit),
            said(c),
            condition(press, c),
        );
    }
    let unit = if any { "<th>unit</th>" } else { "" };
    format!(
        "<h2>Ports</h2><div class=\"wide\"><table class=\"full\"><tr><th>name</th><th>connector</th>{unit}<th>meaning</th></tr>{rows}</table></div>"
    )
}

/// Inputs and outputs of a function, in the order of a call: inherited ones come first.
pub fn arguments<'a>(press: &mut Press<'_, 'a>, mut list: Vec<&MemberComponent<'a>>) -> String {
    let mut owners: Vec<ClassId> = list.iter().map(|m| m.owner).collect();
    owners.dedup();
    let place = |m: &&MemberComponent<'_>| owners.iter().rposition(|o| *o == m.owner);
    list.sort_by_key(|m| (m.component.prefix.causality == Some(CausalityPrefix::Output), std::cmp::Reverse(place(m))));
    let mut rows = String::new();
    for member in list {
        let c = member.component;
        let facts = facts_of(press, member);
        let value = c.modification.as_ref().and_then(|m| m.value.as_ref());
        let value = value.map_or(String::new(), |v| default(press.library.sources.text(v.span)));
        let role = if c.prefix.causality == Some(CausalityPrefix::Output) { "result" } else { "argument" };
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td class=\"fixed\">{role}</td><td>{value}</td><td class=\"num\">{}</td><td class=\"num\">{}</td><td>{}</td></tr>",
            name(press, c),
            escape(&facts.unit),
            range(&facts),
            said(c),
        );
    }
    format!(
        "<h2>Arguments and results</h2><div class=\"wide\"><table class=\"full\"><tr><th>name</th><th></th><th>default</th><th>unit</th><th>range</th><th>meaning</th></tr>{rows}</table></div>"
    )
}

/// Parameters and constants, those of bases under the base's name.
pub fn parameters<'a>(
    press: &mut Press<'_, 'a>,
    class: ClassId,
    list: &[&MemberComponent<'a>],
    given: &Given<'a>,
) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut rows = String::new();
    let mut owner = class;
    for member in list {
        if member.owner != owner {
            owner = member.owner;
            let full = press.library.full_name(owner);
            let _ = writeln!(rows, "<tr class=\"group\"><td colspan=\"5\">from {}</td></tr>", press.link(owner, &full));
        }
        rows.push_str(&parameter(press, member, given));
    }
    format!(
        "<h2>Parameters</h2><div class=\"wide\"><table class=\"full\"><tr><th>name</th><th>default</th><th>unit</th><th>range</th><th>meaning</th></tr>{rows}</table></div>"
    )
}

fn parameter<'a>(press: &mut Press<'_, 'a>, member: &MemberComponent<'a>, given: &Given<'a>) -> String {
    let c = member.component;
    let facts = facts_of(press, member);
    let own = c.modification.as_ref().and_then(|m| m.value.as_ref());
    let (value, fixed) = match given.get(c.name.name.as_str()).filter(|_| own.is_some() || !member.protected) {
        Some((value, fixed)) => (Some(*value), *fixed),
        None => (own, c.prefix.variability == Some(VariabilityPrefix::Constant)),
    };
    let value = value.map_or(String::new(), |v| default(press.library.sources.text(v.span)));
    let fixed = if fixed { " <span class=\"fixed\">fixed</span>" } else { "" };
    let shown = match facts.display_unit.as_str() {
        "" => String::new(),
        unit if unit == facts.unit => String::new(),
        unit => format!(" <span class=\"fixed\">({})</span>", escape(unit)),
    };
    let type_note = if facts.unit.is_empty() { class_link(press, member) } else { escape(&facts.unit) };
    let type_note = if type_note == "Real" { String::new() } else { type_note };
    format!(
        "<tr><td>{}</td><td>{value}{fixed}</td><td class=\"num\">{type_note}{shown}</td><td class=\"num\">{}</td><td>{}{}</td></tr>\n",
        name(press, c),
        range(&facts),
        said(c),
        condition(press, c),
    )
}

fn default(text: &str) -> String {
    let class = if text.len() > 16 { " class=\"long\"" } else { "" };
    format!("<code{class}>{}</code>", escape(text))
}

fn range(facts: &facts::Facts) -> String {
    match (facts.min.as_str(), facts.max.as_str()) {
        ("", "") => String::new(),
        (low, "") => format!("≥ {}", escape(low)),
        ("", high) => format!("≤ {}", escape(high)),
        (low, high) => format!("{} … {}", escape(low), escape(high)),
    }
}

/// Parts with equations of their own; those that can be exchanged say by what.
pub fn parts<'a>(press: &mut Press<'_, 'a>, list: &[&MemberComponent<'a>]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut rows = String::new();
    for member in list {
        let c = member.component;
        let role = if c.prefixes.outer {
            "outer"
        } else if c.prefixes.inner {
            "inner"
        } else if c.prefixes.replaceable {
            "replaceable"
        } else {
            ""
        };
        let limit = c.constraint.as_ref().and_then(|k| library::resolve(press.library, member.owner, &k.path));
        let limit = limit.map_or(String::new(), |id| {
            let full = press.library.full_name(id);
            format!(" <span class=\"said\">any {}</span>", press.link(id, &full))
        });
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{}{limit}</td><td class=\"fixed\">{role}</td><td>{}{}</td></tr>",
            name(press, c),
            class_link(press, member),
            said(c),
            condition(press, c),
        );
    }
    format!(
        "<h2>Parts</h2><div class=\"wide\"><table class=\"full\"><tr><th>name</th><th>class</th><th></th><th>meaning</th></tr>{rows}</table></div>"
    )
}

/// Variables that results show.
pub fn variables<'a>(press: &mut Press<'_, 'a>, list: &[&MemberComponent<'a>]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut rows = String::new();
    for member in list {
        let c = member.component;
        let unit = facts_of(press, member).unit;
        let unit = if unit.is_empty() { class_link(press, member) } else { escape(&unit) };
        let unit = if unit == "Real" { String::new() } else { unit };
        let set = format!("<math>{}</math>", math::name(c.name.name.as_str()));
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{set}</td><td class=\"num\">{unit}</td><td>{}</td></tr>",
            name(press, c),
            said(c)
        );
    }
    format!(
        "<h2>Variables</h2><div class=\"wide\"><table class=\"full\"><tr><th>name</th><th>set as</th><th>unit</th><th>meaning</th></tr>{rows}</table></div>"
    )
}
