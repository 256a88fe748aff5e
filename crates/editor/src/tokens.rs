//! Semantic tokens: the meaning of each name, by which an editor colours it.
//!
//! The names of a file come from `occurrences`. They leave in the protocol's form, each relative to the token before
//! it.

use super::DocumentView;
use super::occurrences::{self, NameOccurrence};
use bramah_model::resolve::Library;
use bramah_model::resolve::names::NameTarget;
use bramah_syntax::ast::{ClassKind, VariabilityPrefix};
use lsp_types::{SemanticToken, SemanticTokenModifier, SemanticTokenType};

/// The token types, in the order of their numbers. The server announces this list.
pub const TYPES: [SemanticTokenType; 8] = [
    SemanticTokenType::NAMESPACE,
    SemanticTokenType::CLASS,
    SemanticTokenType::TYPE,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::ENUM_MEMBER,
];

/// The token modifiers, in the order of their bits.
pub const MODIFIERS: [SemanticTokenModifier; 2] = [SemanticTokenModifier::DECLARATION, SemanticTokenModifier::READONLY];

/// All names of a file with their meaning. Names that cannot be resolved are left out.
///
/// Keywords, numbers and comments are left to the editor's own grammar.
///
/// Positions and lengths are in UTF-16 units.
pub fn tokens(view: &mut DocumentView<'_, '_>) -> Vec<SemanticToken> {
    let file = view.file;
    // Classes of a package may come from several files.
    let own = |ident: &bramah_syntax::ast::Ident| ident.span.file == file;
    let mut found: Vec<NameOccurrence<'_>> =
        view.classes.clone().into_iter().flat_map(|id| occurrences::of_class(view.library, id, &own)).collect();
    // The protocol demands the order of the text and each token once.
    found.sort_by_key(|o| o.ident.span.start);
    found.dedup_by_key(|o| o.ident.span.start);
    let mut before = lsp_types::Position::new(0, 0);
    let mut out = Vec::new();
    for occurrence in found {
        let Some((token_type, readonly)) = occurrence.target.and_then(|t| kind(view.library, t)) else { continue };
        let range = view.range(occurrence.ident.span);
        let delta_line = range.start.line - before.line;
        let start = range.start.character;
        out.push(SemanticToken {
            delta_line,
            // On the same line the column is relative to the last token, on a new line it is absolute.
            delta_start: if delta_line == 0 { start - before.character } else { start },
            length: range.end.character.saturating_sub(start),
            token_type,
            // The order of the bits is that of `MODIFIERS`.
            token_modifiers_bitset: u32::from(occurrence.declares) | (u32::from(readonly) << 1),
        });
        before = range.start;
    }
    out
}

/// The index in [`TYPES`] for a target, and whether it is constant.
///
/// `None` would leave the name without a colour; at present each kind of target has one.
fn kind(library: &Library<'_>, target: NameTarget<'_>) -> Option<(u32, bool)> {
    Some(match target {
        NameTarget::Class(id) => match library.class(id).kind {
            ClassKind::Package => (0, false),
            ClassKind::Type => (2, false),
            ClassKind::Function { .. } | ClassKind::Operator => (3, false),
            _ => (1, false),
        },
        NameTarget::Component(member) => match member.component.prefix.variability {
            Some(VariabilityPrefix::Constant) => (4, true),
            Some(VariabilityPrefix::Parameter) => (4, false),
            // A single type name is mostly a built-in type, so this is a variable and not a component.
            _ if member.component.class.parts.len() == 1 => (5, false),
            _ => (6, false),
        },
        NameTarget::Literal(..) => (7, true),
        NameTarget::Iterator(_) => (5, false),
    })
}
