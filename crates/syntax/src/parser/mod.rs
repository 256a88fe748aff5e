//! The parser: tokens of a text in, syntax tree and diagnostics out.
//! This file holds the state of a parse, the cursor over the tokens, and error recovery.
//! The submodules have one function for each production of the grammar (Modelica 3.6, appendix A).
//!
//! A function that cannot go on has reported an error and returns [`ParseAbort`]. Lists of elements, equations and
//! statements catch it, skip to where the next item may begin (panic-mode recovery), and continue.
//! [`crate::parse`] and its relatives are the only callers.

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

/// The bound protects the call stack: each level is a recursion of the parser, and later of everyone who walks the
/// tree.
/// Deepest nesting of brackets, blocks and classes.
const MAX_DEPTH: u32 = 200;

/// Highest tree of one expression, so that whoever walks it by recursion needs little stack.
const MAX_HEIGHT: u32 = 500;

/// The mark of an item that could not be parsed.
/// Whoever returns it has already reported an error, so a caller only decides where to continue.
#[derive(Debug)]
pub(super) struct ParseAbort;

/// A node of the syntax tree, or [`ParseAbort`] after a reported error.
pub(super) type ParseResult<T> = Result<T, ParseAbort>;

/// The construct that an `end` must close.
#[derive(Clone, Copy, Debug, PartialEq)]
enum OpenBlockKind {
    /// A long class, with its name.
    Class(Symbol),
    /// `if` as an equation or statement.
    If,
    /// `for` loop.
    For,
    /// `while` loop.
    While,
    /// `when` clause.
    When,
}

/// A block or class whose `end` has not been read yet.
/// The parser keeps these on a stack, so that a message can point to the one that is not closed.
#[derive(Clone, Copy, Debug)]
struct OpenBlock {
    /// What is open.
    kind: OpenBlockKind,
    /// The name of a class, or the first keyword of a block.
    span: Span,
    /// The place of an `else if` in it, a likely slip for `elseif`.
    else_if: Option<Span>,
}

/// The state of a parse: the tokens, the cursor, the errors so far and the stacks of open constructs.
pub(super) struct Parser<'a> {
    /// The source text.
    text: &'a str,
    /// The index of the text, which every span carries.
    file: FileId,
    /// All tokens in order; the last is `Eof`.
    tokens: Vec<Token>,
    /// Index of the current token.
    at: usize,
    /// Errors in the order in which they were found.
    diagnostics: Vec<Diagnostic>,
    /// Index of the token of the last error. A second error at the same token is not reported.
    blamed: Option<usize>,
    /// True from a guessed semicolon to the next one that was read.
    /// Errors in between are not reported as missing signs: the guess may have cut one item in two.
    guessed: bool,
    /// True when the end of the text means nothing (see [`TokenStream::truncated`]).
    truncated: bool,
    /// True after a missing or wrong `end` in the current class.
    /// Further `end` errors of this class follow from the first one and are not reported.
    misnested: bool,
    /// True after a limit of nesting or height was reached: the cursor is at the end and no more errors are reported.
    halted: bool,
    /// How many calls of [`Parser::nested`] are active.
    depth: u32,
    /// Height of the last expression parsed.
    height: u32,
    /// How many subscripts enclose the cursor. Inside one, `end` is the last index of a dimension.
    subscripts: u32,
    /// The open blocks and classes, innermost last.
    open: Vec<OpenBlock>,
    /// Operators that wait for their right operand, of all expressions under way (see `operator`).
    pending: Vec<PendingOperator>,
    /// Operands that wait for their operator, each with the height of its tree.
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

    /// Hands out the errors, sorted by where they begin in the text.
    /// The lexer's errors come first in the list, which is why sorting is needed.
    pub fn into_diagnostics(mut self) -> Vec<Diagnostic> {
        self.diagnostics.sort_by_key(|d| d.labels.first().map(|label| label.span.start));
        self.diagnostics
    }

    // The cursor.

    /// The current token.
    fn token(&self) -> Token {
        self.tokens[self.at]
    }

    /// The kind of the current token.
    fn kind(&self) -> TokenKind {
        self.tokens[self.at].kind
    }

    /// The token `ahead` places after the current one; `Eof` past the end.
    fn peek(&self, ahead: usize) -> Token {
        self.tokens[(self.at + ahead).min(self.tokens.len() - 1)]
    }

    /// The kind of the token `ahead` places after the current one.
    fn peek_kind(&self, ahead: usize) -> TokenKind {
        self.peek(ahead).kind
    }

    /// Moves to the next token. The cursor stays on `Eof`, so that a parse always has a current token.
    fn bump(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    /// True if the current token has this kind.
    fn at(&self, kind: TokenKind) -> bool {
        self.kind() == kind
    }

    /// Moves past the current token if it has this kind. False if it has another one.
    fn eat(&mut self, kind: TokenKind) -> bool {
        let found = self.at(kind);
        if found {
            self.bump();
        }
        found
    }

    /// Moves past a token of this kind and gives its place.
    ///
    /// # Errors
    /// Reports "expected this, found that" and leaves the cursor where it is.
    fn expect(&mut self, kind: TokenKind) -> ParseResult<Span> {
        let span = self.span();
        if self.eat(kind) {
            return Ok(span);
        }
        Err(self.unexpected(&format!("`{}`", kind.spelling().unwrap_or("a name"))))
    }

    // Places and words.

    /// The place of a token.
    fn span_of(&self, token: Token) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    /// The place of the current token.
    fn span(&self) -> Span {
        self.span_of(self.token())
    }

    /// The token before the current one; at the start of the text the current one.
    fn previous(&self) -> Token {
        self.tokens[self.at.saturating_sub(1)]
    }

    /// The span from a place to the end of the token before the current one: what was parsed since `start`.
    fn since(&self, start: Span) -> Span {
        // Nothing may have been read since `start`; then the span is `start` itself.
        Span { end: self.previous().end.max(start.end), ..start }
    }

    /// The text of a token.
    fn word(&self, token: Token) -> &'a str {
        &self.text[token.start as usize..token.end as usize]
    }

    /// True if a line break stands between the previous token and the current one.
    fn is_on_new_line(&self) -> bool {
        let gap = self.previous().end as usize..self.token().start as usize;
        // Without a gap that can be sliced (at the start of the text) the token counts as the first of its line.
        self.text.get(gap).is_none_or(|gap| gap.contains('\n'))
    }

    /// True when nothing stands between a token and the one before it.
    fn is_adjacent(&self, ahead: usize) -> bool {
        self.at + ahead > 0 && self.tokens[self.at + ahead - 1].end == self.peek(ahead).start
    }

    // Names.

    /// The token as a name; its kind is not checked.
    fn ident_of(&self, token: Token) -> Ident {
        Ident { name: Symbol::new(self.word(token)), span: self.span_of(token) }
    }

    /// An identifier.
    /// `what` says in the message what kind of name is expected.
    ///
    /// # Errors
    /// Reports a token that is neither a name nor a keyword used like one; the latter is reported and accepted.
    fn ident(&mut self, what: &str) -> ParseResult<Ident> {
        let token = self.token();
        if token.kind != TokenKind::Ident && !self.keyword_as_name(what) {
            return Err(self.unexpected(what));
        }
        self.bump();
        Ok(self.ident_of(token))
    }

    /// A dotted name, `[.] a.b.c`; `what` describes it in the message.
    fn path(&mut self, what: &str) -> ParseResult<Path> {
        let start = self.span();
        let global = self.eat(TokenKind::Dot);
        let mut parts = vec![self.ident(what)?];
        // A dot without a name after it stays: `import A.*` and `import A.{b, c}` continue there.
        while self.at(TokenKind::Dot) && matches!(self.peek_kind(1), TokenKind::Ident) {
            self.bump();
            parts.push(self.ident("a name")?);
        }
        Ok(Path { global, parts, span: self.since(start) })
    }

    // Nesting.

    /// Runs `part` one level deeper.
    ///
    /// # Errors
    /// Reports E004 if this is more than [`MAX_DEPTH`] levels deep; then `part` does not run.
    fn nested<T>(&mut self, part: impl FnOnce(&mut Self) -> ParseResult<T>) -> ParseResult<T> {
        if self.depth >= MAX_DEPTH {
            return Err(self.too_deep(&format!("the text is nested more than {MAX_DEPTH} levels deep")));
        }
        self.depth += 1;
        let result = part(self);
        self.depth -= 1;
        result
    }

    /// Reports a limit that was reached and moves the cursor to the end of the text, so that parsing stops.
    fn too_deep(&mut self, message: &str) -> ParseAbort {
        let diagnostic = Diagnostic::new(Code::TooDeep, message).at(self.span(), "the limit is reached here");
        // The message must appear even if this token was blamed before: it explains why the rest is not read.
        self.blamed = None;
        self.report(diagnostic);
        self.halted = true;
        self.at = self.tokens.len() - 1;
        ParseAbort
    }

    // Going on after an error.

    /// True at a token that begins or ends a section, a class or a declaration, and so never stands inside an equation.
    /// Error recovery stops there.
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

    /// True after a prefix that may stand before a class inside a modification: `redeclare model M = N`.
    /// The class keyword is then no boundary.
    fn is_redeclared(&self) -> bool {
        matches!(self.previous().kind, TokenKind::Redeclare | TokenKind::Replaceable)
    }

    /// True if the `end` at the cursor closes a block or class; false if it is the last index of an array.
    fn is_closing_end(&self) -> bool {
        use TokenKind::{Eof, For, Ident, If, Semicolon, When, While};
        match self.peek_kind(1) {
            If | For | When | While | Eof => true,
            // `x[end];` is cut off by its bracket; a bare `end;` counts as a wrong end if it begins a line.
            Semicolon => self.is_on_new_line(),
            // `end Name` closes a class if a semicolon follows, or if a class of this name is open.
            Ident => matches!(self.peek_kind(2), Semicolon | Eof) || self.is_open_class(self.word(self.peek(1))),
            _ => false,
        }
    }

    /// True if a class of this name is open.
    fn is_open_class(&self, name: &str) -> bool {
        self.open.iter().any(|open| matches!(open.kind, OpenBlockKind::Class(class) if class.as_str() == name))
    }

    /// True at a class keyword that really begins a class definition.
    /// `function` may also begin a function argument (`f(function g(a = 1))`), and `pure` a call (`pure(f(x))`).
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

    /// Error recovery: skips to one past the next semicolon, or to a token that begins or ends a section or class.
    /// Semicolons inside `[...]` separate rows of a matrix and do not count.
    fn recover(&mut self) {
        let mut brackets = 0u32;
        self.guessed = false;
        // A comment of another language ends with its line; skipping to a semicolon would also drop the next item.
        if self.at_foreign_comment() {
            return self.skip_line();
        }
        while !self.is_boundary() {
            match self.kind() {
                // Only square brackets are counted: no semicolon may stand in the other kinds.
                TokenKind::LeftBracket => brackets += 1,
                TokenKind::RightBracket => brackets = brackets.saturating_sub(1),
                TokenKind::Semicolon if brackets == 0 => return self.bump(),
                _ => {}
            }
            self.bump();
        }
    }

    /// True at `#` or `%`, which begin a comment in Python and MATLAB.
    fn at_foreign_comment(&self) -> bool {
        self.at(TokenKind::Unknown) && matches!(self.word(self.token()), "#" | "%")
    }

    /// Moves to the first token of the next line.
    fn skip_line(&mut self) {
        self.bump();
        while !self.is_on_new_line() && !self.at(TokenKind::Eof) {
            self.bump();
        }
    }

    /// Parses items with their semicolons up to the `end`, branch or section that follows them.
    /// Items that fail are reported, skipped and left out of the list.
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
            // Every round must consume a token, or a list that meets an unusable token would never end.
            if self.at == before {
                self.bump();
            }
        }
        items
    }

    /// True at a token that ends a list of equations or statements.
    /// Misspelt block words such as `endif` end it too, so that the block can report them.
    fn is_list_end(&self) -> bool {
        use TokenKind::{Annotation, Else, Elseif, Elsewhen, External};
        matches!(self.kind(), Else | Elseif | Elsewhen | External | Annotation)
            || self.is_boundary()
            || self.misspelt_block_word().is_some()
    }

    /// The semicolon after an element, equation or statement.
    /// A semicolon missing at a line break or before the end of the list is reported and assumed.
    ///
    /// # Errors
    /// Reports text that follows a complete item on the same line; the caller then skips it.
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

/// True for the keywords that begin a class definition, prefixes such as `partial` included.
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

/// Parses a text that is one dotted name, such as `a.b.c`. `None` if the text is anything else.
pub(super) fn whole_path(file: FileId, text: &str) -> Option<Path> {
    let mut parser = Parser::new(file, text);
    let path = parser.path("a name").ok()?;
    (parser.at(TokenKind::Eof) && parser.diagnostics.is_empty()).then_some(path)
}

/// Parses a text that is one component reference, such as `a.b[2].c`. `None` if the text is anything else.
pub(super) fn whole_reference(file: FileId, text: &str) -> Option<ComponentReference> {
    let mut parser = Parser::new(file, text);
    let reference = expr::reference(&mut parser, "a name").ok()?;
    (parser.at(TokenKind::Eof) && parser.diagnostics.is_empty()).then_some(reference)
}
