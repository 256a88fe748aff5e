//! The outline of a file, and what can be folded.

use super::lines::LineIndex;
use super::{DocumentView, words};
use bramah_syntax::ast::{Class, ClassBody, ClassKind, ElementKind, VariabilityPrefix};
use bramah_syntax::diag::FileId;
use bramah_syntax::format::BlockNesting;
use bramah_syntax::lexer::lex;
use bramah_syntax::token::TokenKind;
use lsp_types::{DocumentSymbol, FoldingRange, SymbolKind};

/// Classes and components of a file, inside each other.
pub fn symbols(view: &DocumentView<'_, '_>) -> Vec<DocumentSymbol> {
    let own = view.classes.iter().map(|&id| view.library.class(id)).filter(|class| class.span.file == view.file);
    own.map(|class| symbol(view, class)).collect()
}

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

fn element(view: &DocumentView<'_, '_>, kind: &ElementKind, span: bramah_syntax::diag::Span) -> Option<DocumentSymbol> {
    match kind {
        ElementKind::Class(class) => Some(symbol(view, class)),
        ElementKind::Component(component) => {
            let kind = match component.prefix.variability {
                Some(VariabilityPrefix::Constant) => SymbolKind::CONSTANT,
                Some(VariabilityPrefix::Parameter) => SymbolKind::PROPERTY,
                _ if component.class.parts.len() == 1 => SymbolKind::VARIABLE,
                _ => SymbolKind::OBJECT,
            };
            let detail = words::declaration(view.library, component);
            Some(made(view, component.name, span.to(component.name.span), kind, Some(&detail), Vec::new()))
        }
        ElementKind::Import(_) | ElementKind::Extends(_) => None,
    }
}

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

/// Classes, blocks and brackets of several lines.
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
    let mut statement = 0;
    for (i, token) in tokens.iter().enumerate().take_while(|(_, t)| t.kind != TokenKind::Eof) {
        if blocks.is_between() {
            statement = token.start;
        }
        let before = blocks.depth;
        blocks.pass(&tokens, i);
        match token.kind {
            TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace => brackets.push(token.start),
            TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace => {
                brackets.pop().into_iter().for_each(|start| add(start, token.start));
            }
            _ if blocks.depth > before => levels.push(statement),
            _ if blocks.depth < before => levels.pop().into_iter().for_each(|start| add(start, token.start)),
            _ => {}
        }
    }
    found
}
