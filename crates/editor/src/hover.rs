//! The text shown when the pointer rests on a name: declaration, unit, value in the circuit, documentation.

use super::hints::ParameterHints;
use super::navigate::occurrence_at;
use super::{DocumentView, words};
use bramah_model::resolve::names::NameTarget;
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};

/// The hover text of the name at a byte offset, as Markdown. `None`: there is no name, or it cannot be resolved.
///
/// The parts in order: declaration with unit, description, value in the model, documentation of a class.
///
/// `facts` has the parameter values of compiled models.
pub fn hover(view: &mut DocumentView<'_, '_>, offset: u32, facts: &ParameterHints) -> Option<Hover> {
    let occurrence = occurrence_at(view, offset)?;
    let target = occurrence.target?;
    let mut text = match target {
        NameTarget::Class(id) => code(&words::class_line(view.library, id)),
        NameTarget::Component(member) => {
            let mut line = words::declaration(view.library, member.component);
            if let Some(unit) = words::attribute(view.library, member, "unit") {
                line.push_str(&format!("  // in {unit}"));
            }
            code(&line)
        }
        NameTarget::Literal(id, literal) => code(&format!("{}.{}", view.library.full_name(id), literal.name.name)),
        NameTarget::Iterator(ident) => code(&format!("for {}", ident.name)),
    };
    if let Some(said) = words::description(view.library, target) {
        text.push_str(said);
        text.push('\n');
    }
    // The value depends on the model around the name, not on the class that declares it.
    let model = view.library.full_name(occurrence.scope);
    if let Some(value) = path_at(view, offset).and_then(|path| facts.value(&model, &path)) {
        text.push_str(&format!("\nHere `{value}`\n"));
    }
    if let NameTarget::Class(id) = target
        && let Some(html) = words::documentation(view.library, id)
    {
        text.push_str(&format!("\n{}\n", words::markdown(html)));
    }
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: text });
    Some(Hover { contents, range: Some(view.range(occurrence.ident.span)) })
}

/// A line as a Modelica code block.
fn code(line: &str) -> String {
    format!("```modelica\n{line}\n```\n")
}

/// The full name of the element at a byte offset, as in the flat model: `pump.V` for `V` in `pump(V = 1)`.
fn path_at(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<String> {
    super::complete::full_name_at(&view.text, offset)
}
