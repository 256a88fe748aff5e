//! Facts about declarations and texts: units and bounds, and what a documentation says of limits and sources.

use super::library::{self, MemberComponent};
use bramah::internals::resolve::Library;
use bramah::internals::syntax::ast::{
    ClassBody, ClassKind, ExprKind, Modification, ModificationArgument, ModificationArgumentKind,
};
use bramah::internals::syntax::symbol::Symbol;

/// Attributes of a declared quantity, as written; empty where there are none.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Such as `Pa`.
    pub unit: String,
    /// Lower bound.
    pub min: String,
    /// Upper bound.
    pub max: String,
    /// Unit for people.
    pub display_unit: String,
}

/// Attributes of a component: its own, then those of its type and what that is made from.
pub fn of(library: &mut Library<'_>, member: &MemberComponent<'_>) -> Facts {
    let mut facts = Facts::default();
    take(library, member.component.modification.as_ref(), &mut facts);
    let mut class = library::resolve(library, member.owner, &member.component.class);
    for _ in 0..8 {
        let Some(id) = class else { break };
        let ClassBody::Short { base, modification, .. } = &library.class(id).body else { break };
        take(library, modification.as_ref(), &mut facts);
        class = library::resolve(library, id, base).filter(|b| *b != id);
    }
    facts
}

fn take(library: &Library<'_>, modification: Option<&Modification>, facts: &mut Facts) {
    for argument in modification.iter().flat_map(|m| &m.arguments) {
        let Some((name, text)) = attribute(library, argument) else { continue };
        let slot = match name.as_str() {
            "unit" => &mut facts.unit,
            "min" => &mut facts.min,
            "max" => &mut facts.max,
            "displayUnit" => &mut facts.display_unit,
            _ => continue,
        };
        if slot.is_empty() {
            *slot = text;
        }
    }
}

fn attribute(library: &Library<'_>, argument: &ModificationArgument) -> Option<(Symbol, String)> {
    let ModificationArgumentKind::Modify { path, modification: Some(m), .. } = &argument.kind else { return None };
    let value = m.value.as_ref()?;
    let text = match &value.kind {
        ExprKind::String(text) => text.to_string(),
        _ => library.sources.text(value.span).to_owned(),
    };
    Some((path.parts[0].name, text))
}

/// Whether a component is a part with equations of its own, not a quantity.
pub fn is_part(library: &mut Library<'_>, member: &MemberComponent<'_>) -> bool {
    let id = library::resolve(library, member.owner, &member.component.class);
    id.is_some_and(|id| matches!(library.class(id).kind, ClassKind::Model | ClassKind::Block | ClassKind::Class))
}

/// What a documentation says, with limits and sources apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    /// All else, HTML.
    pub words: String,
    /// Sentences that begin with `Valid`.
    pub limits: String,
    /// What follows `Source:` or `Sources:`.
    pub sources: String,
}

/// Takes limits and sources out of the paragraphs of a documentation.
pub fn split(info: &str) -> Parts {
    let mut parts = Parts::default();
    let text = info.trim().trim_start_matches("<html>").trim_end_matches("</html>");
    let mut rest = text;
    while let Some(start) = rest.find("<p>") {
        let (before, from) = rest.split_at(start);
        parts.words.push_str(before);
        let Some(end) = from.find("</p>") else {
            rest = from;
            break;
        };
        paragraph(&from[3..end], &mut parts);
        rest = &from[end + 4..];
    }
    parts.words.push_str(rest);
    parts
}

fn paragraph(text: &str, parts: &mut Parts) {
    let mut words = text.trim().to_owned();
    if let Some(at) = begins(&words, "Valid ") {
        let end = sentence_end(&words[at..]) + at;
        let found = words[at..end].trim().to_owned();
        append(&mut parts.limits, &found);
        words.replace_range(at..end, "");
    }
    let sources = ["Sources: ", "Source: "].iter().find_map(|s| begins(&words, s).map(|i| (i, i + s.len())));
    if let Some((at, after)) = sources {
        let found = words[after..].trim().to_owned();
        append(&mut parts.sources, &found);
        words.truncate(at);
    }
    let words = words.trim();
    if !words.is_empty() {
        parts.words.push_str(&format!("<p>{words}</p>\n"));
    }
}

/// Where a sentence begins with a word.
fn begins(text: &str, word: &str) -> Option<usize> {
    text.match_indices(word).map(|(i, _)| i).find(|&i| {
        let before = text[..i].trim_end();
        before.is_empty() || before.ends_with('.') || before.ends_with('>') || before.ends_with(';')
    })
}

/// The end of the first sentence: a full stop before a space and a capital, or the end.
fn sentence_end(text: &str) -> usize {
    let capital = |i: usize| text[i + 2..].chars().next().is_some_and(|c| c.is_uppercase() || c == '<');
    text.match_indices(". ").map(|(i, _)| i).find(|&i| capital(i)).map_or(text.len(), |i| i + 1)
}

fn append(to: &mut String, text: &str) {
    if !to.is_empty() {
        to.push(' ');
    }
    to.push_str(text);
}

/// The parts of a dotted name that begins with a capital letter or has several parts.
pub fn class_words(code: &str) -> Option<Vec<Symbol>> {
    let word = |w: &str| {
        !w.is_empty() && w.chars().all(|c| c.is_alphanumeric() || c == '_') && !w.starts_with(char::is_numeric)
    };
    let parts: Vec<&str> = code.split('.').collect();
    let named = code.len() > 2 && parts.iter().all(|p| word(p));
    named.then(|| parts.into_iter().map(Symbol::new).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_and_sources_stand_apart() {
        let info = "<html><p>It flows. Valid to 5 MPa. More. Source: A. Author, 2001.</p></html>";
        let want = Parts {
            words: "<p>It flows.  More.</p>\n".into(),
            limits: "Valid to 5 MPa.".into(),
            sources: "A. Author, 2001.".into(),
        };
        assert_eq!(split(info), want);
    }

    #[test]
    fn lists_stay() {
        let info = "<html>\n<p>One:</p>\n<ul><li>a</li></ul></html>";
        assert!(split(info).words.contains("<ul><li>a</li></ul>"));
    }
}
