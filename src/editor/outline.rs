//! The outline of a file, and what can be folded.

use super::lines::Lines;
use super::{View, words};
use crate::diag::FileId;
use crate::syntax::ast::{Class, ClassBody, ClassKind, ElementKind, Variability};
use crate::syntax::lexer::lex;
use crate::syntax::token::TokenKind;
use lsp_types::{DocumentSymbol, FoldingRange, FoldingRangeKind, SymbolKind};

/// Classes and components of a file, inside each other.
pub fn symbols(view: &View<'_, '_>) -> Vec<DocumentSymbol> {
    let own = view.classes.iter().map(|&id| view.library.class(id)).filter(|class| class.span.file == view.file);
    own.map(|class| symbol(view, class)).collect()
}

fn symbol(view: &View<'_, '_>, class: &Class) -> DocumentSymbol {
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

fn element(view: &View<'_, '_>, kind: &ElementKind, span: crate::diag::Span) -> Option<DocumentSymbol> {
    match kind {
        ElementKind::Class(class) => Some(symbol(view, class)),
        ElementKind::Component(component) => {
            let kind = match component.prefix.variability {
                Some(Variability::Constant) => SymbolKind::CONSTANT,
                Some(Variability::Parameter) => SymbolKind::PROPERTY,
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
    view: &View<'_, '_>,
    name: crate::syntax::ast::Ident,
    span: crate::diag::Span,
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
        range: view.lines.range(span),
        selection_range: view.lines.range(name.span),
        children: (!children.is_empty()).then_some(children),
    }
}

/// Classes, blocks and brackets of several lines, and comments.
pub fn folds(text: &str) -> Vec<FoldingRange> {
    let mut found = Vec::new();
    let lines = Lines::new(text);
    let line = |offset: u32| lines.position(offset).line;
    let mut add = |start: u32, end: u32, kind: Option<FoldingRangeKind>| {
        let (start_line, end_line) = (line(start), line(end));
        if end_line > start_line {
            found.push(FoldingRange { start_line, end_line, kind, ..FoldingRange::default() });
        }
    };
    let mut open: Vec<u32> = Vec::new();
    let mut blocks: Vec<u32> = Vec::new();
    let tokens = lex(FileId(0), text).tokens;
    let mut between = true;
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace => open.push(token.start),
            TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace => {
                open.pop().into_iter().for_each(|start| add(start, token.start, None));
            }
            TokenKind::End if between => {
                blocks.pop().into_iter().for_each(|start| add(start, token.start, None));
            }
            TokenKind::If | TokenKind::For | TokenKind::When | TokenKind::While if between => blocks.push(token.start),
            kind if between && is_class(kind) && tokens.get(i + 2).is_some_and(|t| t.kind != TokenKind::Equal) => {
                blocks.push(token.start);
            }
            _ => {}
        }
        between = open.is_empty()
            && (matches!(token.kind, TokenKind::Semicolon | TokenKind::Then | TokenKind::Loop | TokenKind::Else)
                || matches!(token.kind, TokenKind::Equation | TokenKind::Algorithm | TokenKind::Protected)
                || between && (token.kind == TokenKind::Public || is_prefix(token.kind)));
        // the description of a class ends its header without a semicolon
        let header = i >= 1 && is_class(tokens[i - 1].kind) && token.kind == TokenKind::Ident;
        let described = i >= 2 && is_class(tokens[i - 2].kind) && token.kind == TokenKind::String;
        between |= (header && tokens.get(i + 1).is_some_and(|t| t.kind != TokenKind::String)) || described;
    }
    found
}

fn is_class(kind: TokenKind) -> bool {
    use TokenKind as T;
    matches!(
        kind,
        T::Class | T::Model | T::Block | T::Record | T::Connector | T::Type | T::Package | T::Function | T::Operator
    )
}

fn is_prefix(kind: TokenKind) -> bool {
    use TokenKind as T;
    matches!(
        kind,
        T::Final
            | T::Inner
            | T::Outer
            | T::Replaceable
            | T::Redeclare
            | T::Encapsulated
            | T::Partial
            | T::Pure
            | T::Impure
            | T::Expandable
            | T::Initial
    )
}
