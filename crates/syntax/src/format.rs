//! The formatter: a text in, the same text in the standard layout out.
//! The command `bramah fmt` and the editor call [`format()`].
//!
//! Only indentation, blanks and empty lines change. Tokens, comments and the author's line breaks stay, so the meaning
//! stays. The layout follows from the tokens alone: [`BlockNesting`] counts levels without a syntax tree.

use super::lexer::lex;
use super::token::{Token, TokenKind};
use crate::diag::{Diagnostic, FileId};

/// Blanks of one level of indentation.
const LEVEL: usize = 2;

/// Lays out a text. The result ends with one line break.
///
/// # Errors
/// The errors of the parser: a text with errors is not changed.
pub fn format(file: FileId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let parsed = super::parse(file, text);
    if !parsed.diagnostics.is_empty() {
        return Err(parsed.diagnostics);
    }
    // If all lines end as on Windows, the text is laid out with plain line ends, which are replaced afterwards.
    let breaks = text.matches('\n').count();
    if breaks > 0 && text.matches("\r\n").count() == breaks {
        return with_line_ends(text, file);
    }
    let tokens = lex(file, text).tokens;
    let mut layout = SourceFormatter {
        text,
        tokens: &tokens,
        out: String::with_capacity(text.len()),
        blocks: BlockNesting::default(),
    };
    for i in 0..tokens.len() {
        layout.token(i);
    }
    layout.finish();
    Ok(layout.out)
}

/// Formats a text with line ends of Windows, which it keeps.
fn with_line_ends(text: &str, file: FileId) -> Result<String, Vec<Diagnostic>> {
    Ok(format(file, &text.replace("\r\n", "\n"))?.replace('\n', "\r\n"))
}

/// The layout under construction.
struct SourceFormatter<'a> {
    /// The text to be laid out.
    text: &'a str,
    /// Its tokens, `Eof` last.
    tokens: &'a [Token],
    /// The text written so far.
    out: String,
    /// The nesting at the current token.
    blocks: BlockNesting,
}

/// A piece of what stands between two tokens.
enum TokenGap<'a> {
    /// Blanks with so many line breaks; 0 for blanks within a line.
    Lines(usize),
    /// A comment from its first sign to its last, without the line break after it.
    Comment(&'a str),
}

impl SourceFormatter<'_> {
    /// Writes what stands before token `i`, then the token itself.
    fn token(&mut self, i: usize) {
        let token = self.tokens[i];
        let before = i.checked_sub(1).map(|p| self.tokens[p]);
        self.gaps(before.map_or(0, |t| t.end as usize), token.start as usize, i);
        if token.kind == TokenKind::Eof {
            return;
        }
        if self.at_line_start() {
            self.blocks.line += 1;
            let level = self.blocks.level_of(&self.tokens[i..]);
            self.indent(level);
        } else if before.is_some_and(|b| needs_blank(self.tokens, i, b.kind)) && !self.out.ends_with(' ') {
            self.out.push(' ');
        }
        self.out.push_str(&self.text[token.start as usize..token.end as usize]);
        // The nesting is updated after the token, whose own level has been used for its line.
        self.blocks.pass(self.tokens, i);
    }

    /// Writes the comments and line breaks between two tokens. `next` is the index of the second one.
    fn gaps(&mut self, start: usize, end: usize, next: usize) {
        for gap in gaps(&self.text[start..end]) {
            match gap {
                TokenGap::Lines(count) if !self.out.is_empty() => self.break_lines(count),
                // Empty lines at the beginning of the file are dropped.
                TokenGap::Lines(_) => {}
                TokenGap::Comment(comment) => {
                    if self.at_line_start() {
                        let level = self.blocks.level_of_comment(&self.tokens[next..]);
                        self.indent(level);
                    } else if !self.out.ends_with(' ') {
                        self.out.push(' ');
                    }
                    self.out.push_str(comment.trim_end());
                    // A comment in the middle of a line is followed by a blank; blanks before a line break would stay.
                    if comment.starts_with("/*") && !next_line(&self.text[start..end], comment) {
                        self.out.push(' ');
                    }
                }
            }
        }
    }

    /// True at the beginning of a line of the output.
    fn at_line_start(&self) -> bool {
        self.out.is_empty() || self.out.ends_with('\n')
    }

    /// Ends the line. With two or more breaks in the text an empty line follows, never more than one.
    fn break_lines(&mut self, count: usize) {
        let kept = self.out.trim_end_matches(' ').len();
        self.out.truncate(kept);
        let have = self.out.len() - self.out.trim_end_matches('\n').len();
        (have..count.min(2)).for_each(|_| self.out.push('\n'));
    }

    /// Writes the indentation of a level.
    fn indent(&mut self, level: usize) {
        self.out.extend(std::iter::repeat_n(' ', LEVEL * level));
    }

    /// Ends the output with exactly one line break, or leaves it empty.
    fn finish(&mut self) {
        let kept = self.out.trim_end().len();
        self.out.truncate(kept);
        if !self.out.is_empty() {
            self.out.push('\n');
        }
    }
}

/// True if only blanks follow a comment on its line.
/// `comment` must be a slice of `gap`.
fn next_line(gap: &str, comment: &str) -> bool {
    // Its position follows from the addresses: both are slices of one text.
    let end = comment.as_ptr() as usize - gap.as_ptr() as usize + comment.len();
    gap[end..].trim_start_matches([' ', '\t', '\r']).starts_with('\n')
}

/// Splits what stands between two tokens into comments and line breaks.
fn gaps(text: &str) -> Vec<TokenGap<'_>> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| !matches!(c, ' ' | '\t' | '\r' | '\x0b' | '\x0c' | '\u{feff}')) {
        rest = &rest[at..];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else {
            let blank = rest.find(|c: char| !c.is_whitespace()).unwrap_or(rest.len());
            if blank == 0 {
                break;
            }
            found.push(TokenGap::Lines(rest[..blank].matches('\n').count()));
            rest = &rest[blank..];
            continue;
        };
        found.push(TokenGap::Comment(&rest[..length]));
        rest = &rest[length..];
    }
    found
}

/// The nesting of classes, sections and blocks at a token, by which lines are indented.
/// The editor's outline uses it too.
#[derive(Default)]
pub struct BlockNesting {
    /// Levels of classes and blocks around the current statement.
    pub depth: usize,
    /// For each open bracket of the current statement the number of its line.
    /// Brackets opened on one line indent the lines after it once.
    brackets: Vec<u32>,
    /// The number of the current line, counted in the output.
    line: u32,
    /// True if the next token begins a statement.
    between: bool,
    /// `if` expressions of the current statement that wait for their `else`: their `then` opens no block.
    open_ifs: usize,
    /// What the current statement will open, if anything.
    opens: Option<BlockOpening>,
    /// False before the first token, which always begins a statement.
    started: bool,
}

/// The kind of level that a statement opens, which decides where the level begins.
#[derive(Clone, Copy, PartialEq)]
enum BlockOpening {
    /// A class such as `model M "text"`. Its level begins after its name, modification and description.
    /// `header` is the index of the token of its name.
    Class { header: usize },
    /// A block such as `if ... then` or `for ... loop`. Its level begins after that word.
    Block,
}

impl BlockNesting {
    /// The level of a line that begins with the first token of `rest`.
    fn level_of(&self, rest: &[Token]) -> usize {
        let kind = rest[0].kind;
        // Inside a statement: continuation lines are indented once, or once for each line that opened a bracket.
        if !self.is_between() {
            // A closing bracket stands at the level of the line that opened it.
            let closing = matches!(kind, TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace);
            let open = &self.brackets[..self.brackets.len() - usize::from(closing).min(self.brackets.len())];
            let lines = open.chunk_by(|a, b| a == b).count();
            return self.depth + if closing { lines } else { lines.max(1) };
        }
        self.depth - usize::from(self.closes_level(rest)).min(self.depth)
    }

    /// The level of a comment that begins a line, by the token that follows.
    /// A comment before `end` or `else` belongs to the items above and stands at their level.
    fn level_of_comment(&self, rest: &[Token]) -> usize {
        if self.is_between() && self.closes_level(rest) && !is_section(rest) && rest[0].kind != TokenKind::External {
            return self.depth;
        }
        self.level_of(rest)
    }

    /// True if the next token begins a statement.
    pub fn is_between(&self) -> bool {
        self.between || !self.started
    }

    /// True if the line stands one level further out than the statements before it: `end`, `else`, section keywords.
    fn closes_level(&self, rest: &[Token]) -> bool {
        use TokenKind as T;
        matches!(rest[0].kind, T::End | T::Else | T::Elseif | T::Elsewhen | T::External) || is_section(rest)
    }

    /// Updates the nesting by token `i`.
    pub fn pass(&mut self, tokens: &[Token], i: usize) {
        let (kind, begins) = (tokens[i].kind, self.is_between());
        self.started = true;
        if begins {
            self.begin(tokens, i);
        }
        match kind {
            TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace => self.brackets.push(self.line),
            TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace => _ = self.brackets.pop(),
            TokenKind::If if !begins => self.open_ifs += 1,
            TokenKind::Else if !begins => self.open_ifs = self.open_ifs.saturating_sub(1),
            TokenKind::Semicolon if self.brackets.is_empty() => self.next_statement(),
            TokenKind::Then | TokenKind::Loop
                if self.opens == Some(BlockOpening::Block) && self.open_ifs == 0 && self.brackets.is_empty() =>
            {
                self.depth += 1;
                self.next_statement();
            }
            _ => {}
        }
        // The header of a class has no closing word: it ends before the first token that cannot belong to it.
        if let Some(BlockOpening::Class { header }) = self.opens
            && i >= header
            && self.brackets.is_empty()
            && !continues_header(tokens[i + 1].kind)
        {
            self.depth += 1;
            self.next_statement();
        }
    }

    /// Ends the current statement.
    fn next_statement(&mut self) {
        (self.between, self.open_ifs, self.opens) = (true, 0, None);
    }

    /// Handles the first token of a statement.
    fn begin(&mut self, tokens: &[Token], i: usize) {
        self.between = false;
        match tokens[i].kind {
            // A section keyword stands alone; the statement begins after it.
            _ if is_section(&tokens[i..]) => self.between = true,
            TokenKind::End => self.depth = self.depth.saturating_sub(1),
            TokenKind::Else => self.between = true,
            TokenKind::Elseif | TokenKind::Elsewhen => {
                self.depth = self.depth.saturating_sub(1);
                self.opens = Some(BlockOpening::Block);
            }
            TokenKind::If | TokenKind::For | TokenKind::When | TokenKind::While => {
                self.opens = Some(BlockOpening::Block)
            }
            // Prefixes such as `partial` may be followed by the keyword of a class.
            kind if kind.is_element_prefix() => self.between = true,
            kind if kind.is_class_word() => self.begin_class(tokens, i),
            _ => {}
        }
    }

    /// The head of a class that has a body: `model M`, `operator record R`, `class extends M(...)`.
    /// A short class such as `type T = Real` opens no level.
    fn begin_class(&mut self, tokens: &[Token], i: usize) {
        let mut at = i + 1;
        while tokens[at].kind.is_class_word() || tokens[at].kind == TokenKind::Extends {
            at += 1;
        }
        let short = tokens.get(at + 1).is_some_and(|t| t.kind == TokenKind::Equal);
        if tokens[at].kind == TokenKind::Ident && !short {
            self.opens = Some(BlockOpening::Class { header: at });
        }
    }
}

/// True for a token after the name of a class that still belongs to its header: a description or a modification.
fn continues_header(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::String | TokenKind::Plus | TokenKind::LeftParen)
}

/// True at the keyword of a section: `equation`, `initial algorithm`, `protected` and so on.
fn is_section(rest: &[Token]) -> bool {
    match rest[0].kind {
        TokenKind::Equation | TokenKind::Algorithm | TokenKind::Protected | TokenKind::Public => true,
        TokenKind::Initial => rest.get(1).is_some_and(|t| matches!(t.kind, TokenKind::Equation | TokenKind::Algorithm)),
        _ => false,
    }
}

/// True if a blank stands between token `i` and the one before it, whose kind is `before`.
fn needs_blank(tokens: &[Token], i: usize, before: TokenKind) -> bool {
    use TokenKind as T;
    let kind = tokens[i].kind;
    // Blanks around `+` and `-` show the terms of a sum; products and powers have none. A unary sign touches its
    // operand.
    let before_is_sign = matches!(before, T::Plus | T::Minus | T::DotPlus | T::DotMinus);
    match (before, kind) {
        (_, T::Comma | T::Semicolon | T::RightParen | T::RightBracket | T::RightBrace) => false,
        (T::LeftParen | T::LeftBracket | T::LeftBrace | T::Dot, _) => false,
        (T::Comma | T::Semicolon, _) => true,
        (_, T::Dot) => !matches!(before, T::Ident | T::RightParen | T::RightBracket | T::RightBrace | T::End),
        // `import A.*;`
        (T::Ident, T::DotStar) if !tokens.get(i + 1).is_some_and(|t| begins_operand(t.kind)) => false,
        (_, T::Colon) | (T::Colon, _) => false,
        (_, T::Star | T::Slash | T::Caret) | (T::Star | T::Slash | T::Caret, _) => false,
        _ if before_is_sign => !is_unary(tokens, i - 1),
        (_, T::LeftParen) => !is_applied(before),
        (_, T::LeftBracket) => !matches!(before, T::Ident | T::RightParen | T::RightBracket | T::RightBrace | T::End),
        _ => true,
    }
}

/// True for a token that may begin an operand, so that a `.*` before it is an operator and not part of an import.
fn begins_operand(kind: TokenKind) -> bool {
    !matches!(kind, TokenKind::Semicolon | TokenKind::String | TokenKind::Annotation | TokenKind::Eof)
}

/// True if the sign at `i` has no operand on its left.
fn is_unary(tokens: &[Token], i: usize) -> bool {
    let Some(before) = i.checked_sub(1).map(|p| tokens[p].kind) else { return true };
    let operand = matches!(
        before,
        TokenKind::Ident
            | TokenKind::Integer
            | TokenKind::Real
            | TokenKind::String
            | TokenKind::RightParen
            | TokenKind::RightBracket
            | TokenKind::RightBrace
            | TokenKind::End
            | TokenKind::True
            | TokenKind::False
    );
    !operand
}

/// True if an opening bracket after this token belongs to a call or a modification, and touches it.
fn is_applied(before: TokenKind) -> bool {
    use TokenKind as T;
    matches!(
        before,
        T::Ident
            | T::RightBracket
            | T::RightParen
            | T::Der
            | T::Initial
            | T::Pure
            | T::Annotation
            | T::Connect
            | T::Enumeration
    )
}
