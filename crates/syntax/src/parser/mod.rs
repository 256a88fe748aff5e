//! The cursor over the tokens, and how the parser goes on after an error.
//!
//! A function that cannot go on has reported an error and returns [`ParseAbort`]; lists of elements, equations, statements
//! and arguments catch it, skip to where the next item may begin, and go on.

mod body;
pub(super) mod class;
mod element;
mod equation;
pub(super) mod expr;
mod modification;
mod operator;
mod report;
mod statement;

use super::ast::{ComponentReference, Ident, Path};
use super::lexer::{TokenStream, lex};
use super::symbol::Symbol;
use super::token::{Token, TokenKind};
use crate::diag::{Code, Diagnostic, FileId, Span};
use operator::{ParserOperand, PendingOperator};

/// Deepest nesting of brackets, blocks and classes.
const MAX_DEPTH: u32 = 200;

/// Highest tree of one expression, so that whoever walks it by recursion needs little stack.
const MAX_HEIGHT: u32 = 500;

/// An error was reported; the item at hand is given up.
#[derive(Debug)]
pub(super) struct ParseAbort;

/// A piece of the tree, or given up.
pub(super) type ParseResult<T> = Result<T, ParseAbort>;

/// What waits for its `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum OpenBlockKind {
    Class(Symbol),
    If,
    For,
    While,
    When,
}

/// An open block or class, for messages about the one that is not closed.
#[derive(Clone, Copy, Debug)]
struct OpenBlock {
    kind: OpenBlockKind,
    span: Span,
    /// The place of an `else if` in it, a likely slip for `elseif`.
    else_if: Option<Span>,
}

/// The state of a parse.
pub(super) struct Parser<'a> {
    text: &'a str,
    file: FileId,
    tokens: Vec<Token>,
    /// Index of the current token.
    at: usize,
    diagnostics: Vec<Diagnostic>,
    /// Index of the token of the last error: a token is blamed once.
    blamed: Option<usize>,
    /// Set after a guessed semicolon until the next one: what lies between may be the rest of the item before.
    guessed: bool,
    /// True when the end of the text means nothing (see [`TokenStream::truncated`]).
    truncated: bool,
    /// Set when an `end` was missing or wrong in the class at hand: others that do not fit follow from it.
    misnested: bool,
    /// Set by the nesting limit: the rest is not read.
    halted: bool,
    depth: u32,
    /// Height of the last expression parsed.
    height: u32,
    /// How many subscripts we are in, where `end` is a value.
    subscripts: u32,
    open: Vec<OpenBlock>,
    /// Operators and operands of the expressions at hand.
    pending: Vec<PendingOperator>,
    operands: Vec<ParserOperand>,
}

impl<'a> Parser<'a> {
    /// A parser at the first token of a text of less than 4 GiB.
    pub fn new(file: FileId, text: &'a str) -> Self {
        let TokenStream { tokens, diagnostics, truncated } = lex(file, text);
        Parser {
            text,
            file,
            tokens,
            at: 0,
            diagnostics,
            blamed: None,
            guessed: false,
            truncated,
            misnested: false,
            halted: false,
            depth: 0,
            height: 0,
            subscripts: 0,
            open: Vec::new(),
            pending: Vec::new(),
            operands: Vec::new(),
        }
    }

    /// All errors in the order of their places.
    pub fn into_diagnostics(mut self) -> Vec<Diagnostic> {
        self.diagnostics.sort_by_key(|d| d.labels.first().map(|label| label.span.start));
        self.diagnostics
    }

    // The cursor.

    fn token(&self) -> Token {
        self.tokens[self.at]
    }

    fn kind(&self) -> TokenKind {
        self.tokens[self.at].kind
    }

    fn peek(&self, ahead: usize) -> Token {
        self.tokens[(self.at + ahead).min(self.tokens.len() - 1)]
    }

    fn peek_kind(&self, ahead: usize) -> TokenKind {
        self.peek(ahead).kind
    }

    fn bump(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    fn at(&self, kind: TokenKind) -> bool {
        self.kind() == kind
    }

    fn eat(&mut self, kind: TokenKind) -> bool {
        let found = self.at(kind);
        if found {
            self.bump();
        }
        found
    }

    fn expect(&mut self, kind: TokenKind) -> ParseResult<Span> {
        let span = self.span();
        if self.eat(kind) {
            return Ok(span);
        }
        Err(self.unexpected(&format!("`{}`", kind.spelling().unwrap_or("a name"))))
    }

    // Places and words.

    fn span_of(&self, token: Token) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    fn span(&self) -> Span {
        self.span_of(self.token())
    }

    fn previous(&self) -> Token {
        self.tokens[self.at.saturating_sub(1)]
    }

    /// From a place to the end of the token before the current one.
    fn since(&self, start: Span) -> Span {
        Span { end: self.previous().end.max(start.end), ..start }
    }

    fn word(&self, token: Token) -> &'a str {
        &self.text[token.start as usize..token.end as usize]
    }

    fn is_on_new_line(&self) -> bool {
        let gap = self.previous().end as usize..self.token().start as usize;
        self.text.get(gap).is_none_or(|gap| gap.contains('\n'))
    }

    /// True when nothing stands between a token and the one before it.
    fn is_adjacent(&self, ahead: usize) -> bool {
        self.at + ahead > 0 && self.tokens[self.at + ahead - 1].end == self.peek(ahead).start
    }

    // Names.

    fn ident_of(&self, token: Token) -> Ident {
        Ident { name: Symbol::new(self.word(token)), span: self.span_of(token) }
    }

    /// A name; `what` says in a message whose.
    fn ident(&mut self, what: &str) -> ParseResult<Ident> {
        let token = self.token();
        if token.kind != TokenKind::Ident && !self.keyword_as_name(what) {
            return Err(self.unexpected(what));
        }
        self.bump();
        Ok(self.ident_of(token))
    }

    /// `[.] a.b.c`.
    fn path(&mut self, what: &str) -> ParseResult<Path> {
        let start = self.span();
        let global = self.eat(TokenKind::Dot);
        let mut parts = vec![self.ident(what)?];
        while self.at(TokenKind::Dot) && matches!(self.peek_kind(1), TokenKind::Ident) {
            self.bump();
            parts.push(self.ident("a name")?);
        }
        Ok(Path { global, parts, span: self.since(start) })
    }

    // Nesting.

    /// Runs a part one level deeper, unless that is too deep.
    fn nested<T>(&mut self, part: impl FnOnce(&mut Self) -> ParseResult<T>) -> ParseResult<T> {
        if self.depth >= MAX_DEPTH {
            return Err(self.too_deep(&format!("the text is nested more than {MAX_DEPTH} levels deep")));
        }
        self.depth += 1;
        let result = part(self);
        self.depth -= 1;
        result
    }

    fn too_deep(&mut self, message: &str) -> ParseAbort {
        let diagnostic = Diagnostic::new(Code::TooDeep, message).at(self.span(), "the limit is reached here");
        self.blamed = None;
        self.report(diagnostic);
        self.halted = true;
        self.at = self.tokens.len() - 1;
        ParseAbort
    }

    // Going on after an error.

    /// The keywords that begin or end a section, a class or a declaration, and so never stand inside an equation.
    fn is_boundary(&self) -> bool {
        match self.kind() {
            TokenKind::End => self.is_closing_end(),
            TokenKind::Initial => matches!(self.peek_kind(1), TokenKind::Equation | TokenKind::Algorithm),
            TokenKind::Eof
            | TokenKind::Public
            | TokenKind::Protected
            | TokenKind::Equation
            | TokenKind::Algorithm
            | TokenKind::Import
            | TokenKind::Extends
            | TokenKind::Parameter
            | TokenKind::Constant => true,
            kind => is_class_keyword(kind) && self.starts_class() && !self.is_redeclared(),
        }
    }

    /// After a word that may stand before a class inside a modification.
    fn is_redeclared(&self) -> bool {
        matches!(self.previous().kind, TokenKind::Redeclare | TokenKind::Replaceable)
    }

    /// `end` that closes something, not the last index of an array.
    fn is_closing_end(&self) -> bool {
        use TokenKind::{Eof, For, Ident, If, Semicolon, When, While};
        match self.peek_kind(1) {
            If | For | When | While | Eof => true,
            Semicolon => self.is_on_new_line(),
            Ident => matches!(self.peek_kind(2), Semicolon | Eof) || self.is_open_class(self.word(self.peek(1))),
            _ => false,
        }
    }

    fn is_open_class(&self, name: &str) -> bool {
        self.open.iter().any(|open| matches!(open.kind, OpenBlockKind::Class(class) if class.as_str() == name))
    }

    /// A class keyword with what follows it in a class; `function` may also stand in an argument, `pure` in a call.
    fn starts_class(&self) -> bool {
        match self.kind() {
            TokenKind::Pure | TokenKind::Impure => self.peek_kind(1) != TokenKind::LeftParen,
            TokenKind::Function => {
                self.peek_kind(1) == TokenKind::Extends
                    || self.peek_kind(1) == TokenKind::Ident
                        && !matches!(self.peek_kind(2), TokenKind::LeftParen | TokenKind::Dot)
            }
            kind => is_class_keyword(kind),
        }
    }

    /// Skips to one past the next semicolon, or to what begins or ends a section or class.
    fn recover(&mut self) {
        let mut brackets = 0u32;
        self.guessed = false;
        if self.at_foreign_comment() {
            return self.skip_line();
        }
        while !self.is_boundary() {
            match self.kind() {
                TokenKind::LeftBracket => brackets += 1,
                TokenKind::RightBracket => brackets = brackets.saturating_sub(1),
                TokenKind::Semicolon if brackets == 0 => return self.bump(),
                _ => {}
            }
            self.bump();
        }
    }

    /// A comment of another language, which ends with its line.
    fn at_foreign_comment(&self) -> bool {
        self.at(TokenKind::Unknown) && matches!(self.word(self.token()), "#" | "%")
    }

    fn skip_line(&mut self) {
        self.bump();
        while !self.is_on_new_line() && !self.at(TokenKind::Eof) {
            self.bump();
        }
    }

    /// Parses items up to `end`, the next section or the like; one that fails is skipped.
    fn list<T>(&mut self, item: fn(&mut Self) -> ParseResult<T>) -> Vec<T> {
        let mut items = Vec::new();
        while !self.is_list_end() {
            let before = self.at;
            if self.stray_semicolon() {
                continue;
            }
            match item(self) {
                Ok(found) => {
                    items.push(found);
                    if self.semicolon().is_err() {
                        self.recover();
                    }
                }
                Err(ParseAbort) => self.recover(),
            }
            if self.at == before {
                self.bump();
            }
        }
        items
    }

    fn is_list_end(&self) -> bool {
        use TokenKind::{Annotation, Else, Elseif, Elsewhen, External};
        matches!(self.kind(), Else | Elseif | Elsewhen | External | Annotation)
            || self.is_boundary()
            || self.misspelt_block_word().is_some()
    }

    /// The semicolon after an element, equation or statement.
    fn semicolon(&mut self) -> ParseResult<()> {
        if self.eat(TokenKind::Semicolon) {
            self.guessed = false;
            return Ok(());
        }
        if self.previous().kind == TokenKind::Semicolon {
            // The item itself lacked its end, which was reported.
            return Ok(());
        }
        if !self.is_on_new_line() && !self.is_list_end() {
            return Err(self.unexpected_after_item());
        }
        self.missing_semicolon();
        Ok(())
    }
}

/// The keywords that begin a class.
fn is_class_keyword(kind: TokenKind) -> bool {
    use TokenKind as T;
    matches!(
        kind,
        T::Class
            | T::Model
            | T::Block
            | T::Record
            | T::Connector
            | T::Type
            | T::Package
            | T::Function
            | T::Operator
            | T::Partial
            | T::Encapsulated
            | T::Expandable
            | T::Pure
            | T::Impure
    )
}

/// The whole of a dotted name such as `a.b.c`, or nothing if the text is anything else.
pub(super) fn whole_path(file: FileId, text: &str) -> Option<Path> {
    let mut parser = Parser::new(file, text);
    let path = parser.path("a name").ok()?;
    (parser.at(TokenKind::Eof) && parser.diagnostics.is_empty()).then_some(path)
}

/// The whole of a reference such as `a.b[2].c`, or nothing if the text is anything else.
pub(super) fn whole_reference(file: FileId, text: &str) -> Option<ComponentReference> {
    let mut parser = Parser::new(file, text);
    let reference = expr::reference(&mut parser, "a name").ok()?;
    (parser.at(TokenKind::Eof) && parser.diagnostics.is_empty()).then_some(reference)
}
