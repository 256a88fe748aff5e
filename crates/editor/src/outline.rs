//! The outline of a file, and the ranges that can be folded.
//!
//! The outline is made from the syntax tree. Folding is made from the tokens alone, so that it still works in a text
//! with syntax errors.

use super::lines::LineIndex;
use super::{DocumentView, words};
use bramah_syntax::ast::{Class, ClassBody, ClassKind, ElementKind, VariabilityPrefix};
use bramah_syntax::diag::FileId;
use bramah_syntax::format::BlockNesting;
use bramah_syntax::lexer::lex;
use bramah_syntax::token::TokenKind;
use lsp_types::{DocumentSymbol, FoldingRange, SymbolKind};

/// The classes and components of a file as a tree. Classes that the library loaded from other files are left out.
///
/// Components inside a class are its children. The kind of an entry decides the icon in the editor.
pub fn symbols(view: &DocumentView<'_, '_>) -> Vec<DocumentSymbol> {
    let own = view.classes.iter().map(|&id| view.library.class(id)).filter(|class| class.span.file == view.file);
    own.map(|class| symbol(view, class)).collect()
}

/// The outline entry of a class with its elements.
///
/// Only classes with a body of their own have children.
fn symbol(view: &DocumentView<'_, '_>, class: &Class) -> DocumentSymbol {
    let children = match &class.body {
        ClassBody::Long(body) => body.elements.iter().filter_map(|e| element(view, &e.kind, e.span)).collect(),
        _ => Vec::new(),
    };
    let kind = match class.kind {
        ClassKind::Package => SymbolKind::PACKAGE,
        ClassKind::Function { .. } => SymbolKind::FUNCTION,
        ClassKind::Connector { .. } => SymbolKind::INTERFACE,
        ClassKind::Record { .. } => SymbolKind::STRUCT,
        ClassKind::Type => SymbolKind::TYPE_PARAMETER,
        ClassKind::Operator => SymbolKind::OPERATOR,
        ClassKind::Class | ClassKind::Model | ClassKind::Block => SymbolKind::CLASS,
    };
    made(view, class.name, class.span, kind, class.description.as_deref(), children)
}

/// The outline entry of an element. `None` for imports and extends clauses, which declare no name.
///
/// Parameters and constants have kinds of their own. The declaration is shown beside the name.
fn element(view: &DocumentView<'_, '_>, kind: &ElementKind, span: bramah_syntax::diag::Span) -> Option<DocumentSymbol> {
    match kind {
        ElementKind::Class(class) => Some(symbol(view, class)),
        ElementKind::Component(component) => {
            let kind = match component.prefix.variability {
                Some(VariabilityPrefix::Constant) => SymbolKind::CONSTANT,
                Some(VariabilityPrefix::Parameter) => SymbolKind::PROPERTY,
                // Types with a single name are mostly built-in, such as `Real`.
                _ if component.class.parts.len() == 1 => SymbolKind::VARIABLE,
                _ => SymbolKind::OBJECT,
            };
            let detail = words::declaration(view.library, component);
            Some(made(view, component.name, span.to(component.name.span), kind, Some(&detail), Vec::new()))
        }
        ElementKind::Import(_) | ElementKind::Extends(_) => None,
    }
}

/// An outline entry. `span` covers the declaration, the span of `name` is what the editor selects.
///
/// `detail` is shown beside the name.
#[allow(deprecated, reason = "the protocol's struct has a field of that kind")]
fn made(
    view: &DocumentView<'_, '_>,
    name: bramah_syntax::ast::Ident,
    span: bramah_syntax::diag::Span,
    kind: SymbolKind,
    detail: Option<&str>,
    children: Vec<DocumentSymbol>,
) -> DocumentSymbol {
    DocumentSymbol {
        name: name.name.as_str().to_owned(),
        detail: detail.map(str::to_owned),
        kind,
        tags: None,
        deprecated: None,
        range: view.range(span),
        selection_range: view.range(name.span),
        children: (!children.is_empty()).then_some(children),
    }
}

/// The ranges of classes, blocks and brackets that span several lines.
///
/// A range covers complete lines. Ranges within one line are left out, as there is nothing to fold.
pub fn folds(text: &str) -> Vec<FoldingRange> {
    let lines = LineIndex::new(text);
    let mut found = Vec::new();
    let mut add = |start: u32, end: u32| {
        let (start_line, end_line) = (lines.position(text, start).line, lines.position(text, end).line);
        if end_line > start_line {
            found.push(FoldingRange { start_line, end_line, ..FoldingRange::default() });
        }
    };
    let tokens = lex(FileId(0), text).tokens;
    let mut blocks = BlockNesting::default();
    let (mut brackets, mut levels) = (Vec::new(), Vec::new());
    // A fold begins where the statement that opens the block begins, not at the keyword.
    let mut statement = 0;
    for (i, token) in tokens.iter().enumerate().take_while(|(_, t)| t.kind != TokenKind::Eof) {
        // Between statements the next token begins a new one.
        if blocks.is_between() {
            statement = token.start;
        }
        // The depth tells below whether this token opened or closed a block.
        let before = blocks.depth;
        blocks.pass(&tokens, i);
        match token.kind {
            TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace => brackets.push(token.start),
            TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace => {
                // A bracket without a partner is ignored, as the text may be incomplete.
                brackets.pop().into_iter().for_each(|start| add(start, token.start));
            }
            _ if blocks.depth > before => levels.push(statement),
            _ if blocks.depth < before => levels.pop().into_iter().for_each(|start| add(start, token.start)),
            _ => {}
        }
    }
    found
}
