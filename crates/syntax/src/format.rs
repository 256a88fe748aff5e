//! The one layout of a text: indentation, blanks, empty lines. Tokens, comments and the author's line breaks stay, so that
//! the text means what it meant.

use super::lexer::lex;
use super::token::{Token, TokenKind};
use crate::diag::{Diagnostic, FileId};

/// Blanks of a level.
const LEVEL: usize = 2;

/// A text in the one layout.
///
/// # Errors
/// What the parser says of a text that it cannot read.
pub fn format(file: FileId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let parsed = super::parse(file, text);
    if !parsed.diagnostics.is_empty() {
        return Err(parsed.diagnostics);
    }
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

/// Lines of texts from Windows end as they did.
fn with_line_ends(text: &str, file: FileId) -> Result<String, Vec<Diagnostic>> {
    Ok(format(file, &text.replace("\r\n", "\n"))?.replace('\n', "\r\n"))
}

struct SourceFormatter<'a> {
    text: &'a str,
    tokens: &'a [Token],
    out: String,
    blocks: BlockNesting,
}

/// What stands between two tokens.
enum TokenGap<'a> {
    /// So many line breaks.
    Lines(usize),
    /// A comment, from its first sign to its last.
    Comment(&'a str),
}

impl SourceFormatter<'_> {
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
        self.blocks.pass(self.tokens, i);
    }

    /// Comments and line breaks before token `next`.
    fn gaps(&mut self, start: usize, end: usize, next: usize) {
        for gap in gaps(&self.text[start..end]) {
            match gap {
                TokenGap::Lines(count) if !self.out.is_empty() => self.break_lines(count),
                TokenGap::Lines(_) => {}
                TokenGap::Comment(comment) => {
                    if self.at_line_start() {
                        let level = self.blocks.level_of_comment(&self.tokens[next..]);
                        self.indent(level);
                    } else if !self.out.ends_with(' ') {
                        self.out.push(' ');
                    }
                    self.out.push_str(comment.trim_end());
                    if comment.starts_with("/*") && !next_line(&self.text[start..end], comment) {
                        self.out.push(' ');
                    }
                }
            }
        }
    }

    fn at_line_start(&self) -> bool {
        self.out.is_empty() || self.out.ends_with('\n')
    }

    /// One line break, or two for an empty line between.
    fn break_lines(&mut self, count: usize) {
        let kept = self.out.trim_end_matches(' ').len();
        self.out.truncate(kept);
        let have = self.out.len() - self.out.trim_end_matches('\n').len();
        (have..count.min(2)).for_each(|_| self.out.push('\n'));
    }

    fn indent(&mut self, level: usize) {
        self.out.extend(std::iter::repeat_n(' ', LEVEL * level));
    }

    fn finish(&mut self) {
        let kept = self.out.trim_end().len();
        self.out.truncate(kept);
        if !self.out.is_empty() {
            self.out.push('\n');
        }
    }
}

/// Whether only blanks follow a comment on its line.
fn next_line(gap: &str, comment: &str) -> bool {
    let end = comment.as_ptr() as usize - gap.as_ptr() as usize + comment.len();
    gap[end..].trim_start_matches([' ', '\t', '\r']).starts_with('\n')
}

/// Takes the blanks between two tokens apart.
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

/// Where in the nesting of classes, sections and blocks a token stands.
#[derive(Default)]
pub struct BlockNesting {
    /// Levels around statements.
    pub depth: usize,
    /// The lines in which the open brackets of the present statement stand: those of one line indent once.
    brackets: Vec<u32>,
    line: u32,
    /// The next token begins a statement.
    between: bool,
    /// `if` expressions that wait for their `else`.
    open_ifs: usize,
    /// What the present statement opens, and where the brackets were when it began.
    opens: Option<BlockOpening>,
    started: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum BlockOpening {
    /// `model M "text"`: the class's level begins after its name, modification and description.
    Class { header: usize },
    /// `if ... then`, `for ... loop`: the level begins after that word.
    Block,
}

impl BlockNesting {
    /// The level of a token that begins a line.
    fn level_of(&self, rest: &[Token]) -> usize {
        let kind = rest[0].kind;
        if !self.is_between() {
            let closing = matches!(kind, TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace);
            let open = &self.brackets[..self.brackets.len() - usize::from(closing).min(self.brackets.len())];
            let lines = open.chunk_by(|a, b| a == b).count();
            return self.depth + if closing { lines } else { lines.max(1) };
        }
        self.depth - usize::from(self.closes_level(rest)).min(self.depth)
    }

    /// The level of a comment that begins a line, by what follows: one before `end` or `else` belongs to what stands above.
    fn level_of_comment(&self, rest: &[Token]) -> usize {
        if self.is_between() && self.closes_level(rest) && !is_section(rest) && rest[0].kind != TokenKind::External {
            return self.depth;
        }
        self.level_of(rest)
    }

    /// Whether the next token begins a statement.
    pub fn is_between(&self) -> bool {
        self.between || !self.started
    }

    fn closes_level(&self, rest: &[Token]) -> bool {
        use TokenKind as T;
        matches!(rest[0].kind, T::End | T::Else | T::Elseif | T::Elsewhen | T::External) || is_section(rest)
    }

    /// Goes past a token.
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
        if let Some(BlockOpening::Class { header }) = self.opens
            && i >= header
            && self.brackets.is_empty()
            && !continues_header(tokens[i + 1].kind)
        {
            self.depth += 1;
            self.next_statement();
        }
    }

    fn next_statement(&mut self) {
        (self.between, self.open_ifs, self.opens) = (true, 0, None);
    }

    /// At the first token of a statement.
    fn begin(&mut self, tokens: &[Token], i: usize) {
        self.between = false;
        match tokens[i].kind {
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
            kind if kind.is_element_prefix() => self.between = true,
            kind if kind.is_class_word() => self.begin_class(tokens, i),
            _ => {}
        }
    }

    /// `model M`, `operator record R`, `class extends M(...)`, but not `type T = Real`.
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

/// Whether a token after the name of a class still belongs to its header.
fn continues_header(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::String | TokenKind::Plus | TokenKind::LeftParen)
}

fn is_section(rest: &[Token]) -> bool {
    match rest[0].kind {
        TokenKind::Equation | TokenKind::Algorithm | TokenKind::Protected | TokenKind::Public => true,
        TokenKind::Initial => rest.get(1).is_some_and(|t| matches!(t.kind, TokenKind::Equation | TokenKind::Algorithm)),
        _ => false,
    }
}

/// Whether a blank stands between the token before and token `i`.
fn needs_blank(tokens: &[Token], i: usize, before: TokenKind) -> bool {
    use TokenKind as T;
    let kind = tokens[i].kind;
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

fn begins_operand(kind: TokenKind) -> bool {
    !matches!(kind, TokenKind::Semicolon | TokenKind::String | TokenKind::Annotation | TokenKind::Eof)
}

/// Whether a sign stands before an operand, with nothing on its left.
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

/// Whether a bracket after this token is that of a call or a modification.
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
