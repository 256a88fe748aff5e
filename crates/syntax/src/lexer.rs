//! The lexer: a text in, tokens out (Modelica 3.6, chapter 2).
//! The parser and `format` call [`lex`]; the editor colours texts by the same tokens.
//!
//! Comments and white space make no tokens; `format` finds them between the tokens. A character that cannot begin a
//! token becomes `Unknown` and is left to the parser. Strings, comments and quoted names that are not closed are
//! reported here, with a guess at where they should end.

use super::token::{Token, TokenKind, word_kind};
use crate::diag::{Code, Diagnostic, FileId, Span};

/// The number of errors after which the rest of the text is not read.
/// After a string that is not closed, its lines are read again as tokens; the limit bounds that work.
const MAX_UNCLOSED: usize = 20;

/// The tokens of a text with the errors found on the way. The last token is `Eof`.
pub struct TokenStream {
    /// The tokens in order, `Eof` last.
    pub tokens: Vec<Token>,
    /// Errors about what is not closed, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// True if something unclosed swallowed the rest of the text, or reading stopped after too many errors.
    /// The end of the file then says nothing about open classes and blocks.
    pub truncated: bool,
}

/// Splits a text into tokens. Places have 32 bits, so the text must be shorter than 4 GiB.
pub fn lex(file: FileId, text: &str) -> TokenStream {
    let mut lexer = Lexer { file, text, bytes: text.as_bytes(), at: 0, out: TokenStream::new(text.len()) };
    // Some editors begin a file with a byte order mark.
    if text.starts_with('\u{feff}') {
        lexer.at = '\u{feff}'.len_utf8();
    }
    while lexer.skip_blank() {
        lexer.token();
    }
    let end = lexer.bytes.len();
    lexer.push(TokenKind::Eof, end, end);
    lexer.out
}

impl TokenStream {
    /// An empty stream, with room for the tokens of a text of so many bytes.
    fn new(bytes: usize) -> TokenStream {
        // Model text has about one token in five bytes.
        TokenStream { tokens: Vec::with_capacity(bytes / 5 + 1), diagnostics: Vec::new(), truncated: false }
    }
}

/// The state of the lexer.
struct Lexer<'a> {
    /// The text's index, for spans.
    file: FileId,
    /// The text.
    text: &'a str,
    /// The bytes of the text: all signs of Modelica are ASCII.
    bytes: &'a [u8],
    /// The byte to be read next.
    at: usize,
    /// What was found so far.
    out: TokenStream,
}

impl Lexer<'_> {
    /// The byte `ahead` bytes after the current one; 0 past the end.
    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    /// The place of some bytes.
    fn span(&self, start: usize, end: usize) -> Span {
        Span { file: self.file, start: start as u32, end: end as u32 }
    }

    /// Appends a token and moves to its end.
    fn push(&mut self, kind: TokenKind, start: usize, end: usize) {
        self.out.tokens.push(Token { kind, start: start as u32, end: end as u32 });
        self.at = end;
    }

    /// Skips white space and comments. False at the end of the text.
    fn skip_blank(&mut self) -> bool {
        loop {
            match self.peek(0) {
                b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c => self.at += 1,
                b'/' if self.peek(1) == b'/' => self.skip_line(),
                b'/' if self.peek(1) == b'*' => self.skip_comment(),
                _ => return self.at < self.bytes.len(),
            }
        }
    }

    /// Skips a comment of one line. The line break stays.
    fn skip_line(&mut self) {
        self.at = self.find_from(self.at, b'\n').unwrap_or(self.bytes.len());
    }

    /// The position of the first such byte at or after `start`.
    fn find_from(&self, start: usize, byte: u8) -> Option<usize> {
        self.bytes[start..].iter().position(|&b| b == byte).map(|i| start + i)
    }

    /// Skips a comment between `/*` and `*/`. Such comments do not nest.
    fn skip_comment(&mut self) {
        let start = self.at;
        match self.text[start + 2..].find("*/") {
            Some(length) => self.at = start + 2 + length + 2,
            None => {
                let end = self.bytes.len();
                self.unclosed("the comment is not closed: expected `*/`, found the end of the file", start, start + 2);
                self.out.truncated = true;
                self.at = end;
            }
        }
    }

    /// Records an error at the mark that opens something.
    fn unclosed(&mut self, message: &str, start: usize, end: usize) {
        let label = "opened here";
        self.out.diagnostics.push(Diagnostic::new(Code::UnterminatedText, message).at(self.span(start, end), label));
    }

    /// Reads one token; the cursor is not on white space.
    fn token(&mut self) {
        match self.peek(0) {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => self.word(),
            b'0'..=b'9' => self.number(),
            // A number may begin with its point: `.5`.
            b'.' if self.peek(1).is_ascii_digit() => self.number(),
            b'"' => self.string(),
            b'\'' => self.quoted_name(),
            _ => self.sign(),
        }
    }

    /// Reads an identifier or keyword.
    fn word(&mut self) {
        let start = self.at;
        let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
        let length = self.bytes[start..].iter().position(|b| !is_word(b)).unwrap_or(self.bytes.len() - start);
        self.push(word_kind(&self.text[start..start + length]), start, start + length);
    }

    /// The position after the digits that begin at `at`; `at` itself if there are none.
    fn digits(&self, mut at: usize) -> usize {
        while self.bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    }

    /// Reads a number. It takes as many characters as it can, so `1.*x` is `1.` times `x`.
    fn number(&mut self) {
        let start = self.at;
        let mut kind = TokenKind::Integer;
        let mut end = self.digits(start);
        if self.bytes.get(end) == Some(&b'.') {
            kind = TokenKind::Real;
            end = self.digits(end + 1);
        }
        if let Some(b'e' | b'E') = self.bytes.get(end) {
            let sign = usize::from(matches!(self.bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = self.digits(end + 1 + sign);
            // `e` without digits after it is not an exponent but the beginning of a name.
            if exponent > end + 1 + sign {
                kind = TokenKind::Real;
                end = exponent;
            }
        }
        self.push(kind, start, end);
    }

    /// One past the closing `mark` of what was opened at `start`. `None` if the text ends before it.
    /// A backslash takes the next character with it.
    fn closing(&self, start: usize, mark: u8) -> Option<usize> {
        let mut at = start + 1;
        loop {
            match *self.bytes.get(at)? {
                b'\\' => at += 2,
                b if b == mark => return Some(at + 1),
                _ => at += 1,
            }
        }
    }

    /// Reads a string literal, which may contain line breaks.
    fn string(&mut self) {
        let start = self.at;
        match self.closing(start, b'"') {
            Some(end) if !self.ends_strangely(start, end) => self.push(TokenKind::String, start, end),
            Some(_) => {
                self.unclosed("the string is not closed on its line", start, start + 1);
                // The string is cut at the end of its first line, and reading goes on there.
                self.push(TokenKind::String, start, self.before_semicolon(start));
                self.give_up_if_hopeless();
            }
            None => {
                self.unclosed("the string is not closed: expected `\"`, found the end of the file", start, start + 1);
                self.push(TokenKind::String, start, self.bytes.len());
                self.out.truncated = true;
            }
        }
    }

    /// Stops reading after [`MAX_UNCLOSED`] errors, which bounds the time spent on reading lines twice.
    fn give_up_if_hopeless(&mut self) {
        if self.out.diagnostics.len() > MAX_UNCLOSED {
            self.at = self.bytes.len();
            self.out.truncated = true;
        }
    }

    /// True for a string over several lines whose closing mark touches a word.
    /// That mark was probably meant to open the next string, and this one is not closed on its line.
    ///
    /// Texts in HTML are exempt: there it is more likely a quotation mark without backslash.
    fn ends_strangely(&self, start: usize, end: usize) -> bool {
        let follows = self.bytes.get(end).is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80);
        follows
            && self.bytes[start..end].contains(&b'\n')
            && !self.bytes[start + 1..].starts_with(b"<html")
            && !self.bytes[start + 1..].starts_with(b"<HTML")
    }

    /// The end of the line without its final semicolon, which probably belongs to the declaration and not to the
    /// string.
    fn before_semicolon(&self, start: usize) -> usize {
        let line_end = self.find_from(start, b'\n').unwrap_or(self.bytes.len());
        let line = self.text[start..line_end].trim_ascii_end();
        start + line.strip_suffix(';').unwrap_or(line).len()
    }

    /// Reads a quoted identifier such as `'a b'`, which must close on its line.
    fn quoted_name(&mut self) {
        let start = self.at;
        match self.closing(start, b'\'') {
            Some(end) if !self.bytes[start..end].contains(&b'\n') => self.push(TokenKind::Ident, start, end),
            _ => {
                self.unclosed("the quoted name is not closed on its line: expected `'`", start, start + 1);
                self.push(TokenKind::Ident, start, self.before_semicolon(start));
                self.give_up_if_hopeless();
            }
        }
    }

    /// Reads an operator or punctuation mark; the longer one is preferred.
    fn sign(&mut self) {
        let start = self.at;
        let (kind, length) = self.two_characters().map_or_else(|| self.one_character(), |kind| (kind, 2));
        self.push(kind, start, start + length);
    }

    /// The token that the next two bytes form, operators of other languages included.
    /// The parser reports those and reads them as their Modelica equivalents.
    fn two_characters(&self) -> Option<TokenKind> {
        Some(match (self.peek(0), self.peek(1)) {
            (b':', b'=') => TokenKind::Assign,
            (b'=', b'=') => TokenKind::EqualEqual,
            (b'<', b'>') => TokenKind::NotEqual,
            (b'<', b'=') => TokenKind::LessEqual,
            (b'>', b'=') => TokenKind::GreaterEqual,
            (b'.', b'+') => TokenKind::DotPlus,
            (b'.', b'-') => TokenKind::DotMinus,
            (b'.', b'*') => TokenKind::DotStar,
            (b'.', b'/') => TokenKind::DotSlash,
            (b'.', b'^') => TokenKind::DotCaret,
            (b'&', b'&') => TokenKind::AndAnd,
            (b'|', b'|') => TokenKind::OrOr,
            (b'!', b'=') => TokenKind::BangEqual,
            (b'*', b'*') => TokenKind::StarStar,
            _ => return None,
        })
    }

    /// The token that the next character forms, with its length in bytes.
    fn one_character(&self) -> (TokenKind, usize) {
        let kind = match self.peek(0) {
            b'(' => TokenKind::LeftParen,
            b')' => TokenKind::RightParen,
            b'[' => TokenKind::LeftBracket,
            b']' => TokenKind::RightBracket,
            b'{' => TokenKind::LeftBrace,
            b'}' => TokenKind::RightBrace,
            b';' => TokenKind::Semicolon,
            b',' => TokenKind::Comma,
            b'.' => TokenKind::Dot,
            b':' => TokenKind::Colon,
            b'=' => TokenKind::Equal,
            b'<' => TokenKind::Less,
            b'>' => TokenKind::Greater,
            b'+' => TokenKind::Plus,
            b'-' => TokenKind::Minus,
            b'*' => TokenKind::Star,
            b'/' => TokenKind::Slash,
            b'^' => TokenKind::Caret,
            b'!' => TokenKind::Bang,
            _ => {
                // Any other character, possibly of several bytes in UTF-8.
                let length = self.text[self.at..].chars().next().map_or(1, char::len_utf8);
                return (TokenKind::Unknown, length);
            }
        };
        (kind, 1)
    }
}
