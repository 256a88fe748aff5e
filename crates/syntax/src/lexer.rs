//! Text to tokens. Comments and white space vanish; what cannot be a token becomes `Unknown` and is left to the parser.

use super::token::{Token, TokenKind, word_kind};
use crate::diag::{Code, Diagnostic, FileId, Span};

/// After so many unclosed strings the rest of the text is not read.
const MAX_UNCLOSED: usize = 20;

/// The tokens of a text, the last of which is `Eof`.
pub struct TokenStream {
    /// The tokens in order.
    pub tokens: Vec<Token>,
    /// Strings, comments and quoted names that are not closed.
    pub diagnostics: Vec<Diagnostic>,
    /// True when the rest of the text was swallowed by something not closed, so that its end means nothing.
    pub truncated: bool,
}

/// Splits a text of less than 4 GiB into tokens.
pub fn lex(file: FileId, text: &str) -> TokenStream {
    let mut lexer = Lexer { file, text, bytes: text.as_bytes(), at: 0, out: TokenStream::new(text.len()) };
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
    fn new(bytes: usize) -> TokenStream {
        // Model text has about one token in five bytes.
        TokenStream { tokens: Vec::with_capacity(bytes / 5 + 1), diagnostics: Vec::new(), truncated: false }
    }
}

struct Lexer<'a> {
    file: FileId,
    text: &'a str,
    bytes: &'a [u8],
    at: usize,
    out: TokenStream,
}

impl Lexer<'_> {
    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn span(&self, start: usize, end: usize) -> Span {
        Span { file: self.file, start: start as u32, end: end as u32 }
    }

    fn push(&mut self, kind: TokenKind, start: usize, end: usize) {
        self.out.tokens.push(Token { kind, start: start as u32, end: end as u32 });
        self.at = end;
    }

    /// Skips white space and comments; false at the end of the text.
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

    fn skip_line(&mut self) {
        self.at = self.find_from(self.at, b'\n').unwrap_or(self.bytes.len());
    }

    fn find_from(&self, start: usize, byte: u8) -> Option<usize> {
        self.bytes[start..].iter().position(|&b| b == byte).map(|i| start + i)
    }

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

    fn unclosed(&mut self, message: &str, start: usize, end: usize) {
        let label = "opened here";
        self.out.diagnostics.push(Diagnostic::new(Code::UnterminatedText, message).at(self.span(start, end), label));
    }

    fn token(&mut self) {
        match self.peek(0) {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => self.word(),
            b'0'..=b'9' => self.number(),
            b'.' if self.peek(1).is_ascii_digit() => self.number(),
            b'"' => self.string(),
            b'\'' => self.quoted_name(),
            _ => self.sign(),
        }
    }

    fn word(&mut self) {
        let start = self.at;
        let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
        let length = self.bytes[start..].iter().position(|b| !is_word(b)).unwrap_or(self.bytes.len() - start);
        self.push(word_kind(&self.text[start..start + length]), start, start + length);
    }

    fn digits(&self, mut at: usize) -> usize {
        while self.bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    }

    /// A number takes as many characters as it can, so `1.*x` is `1.` times `x`.
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
            if exponent > end + 1 + sign {
                kind = TokenKind::Real;
                end = exponent;
            }
        }
        self.push(kind, start, end);
    }

    /// One past the closing mark that ends what was opened at `start`, or `None`.
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

    fn string(&mut self) {
        let start = self.at;
        match self.closing(start, b'"') {
            Some(end) if !self.ends_strangely(start, end) => self.push(TokenKind::String, start, end),
            Some(_) => {
                self.unclosed("the string is not closed on its line", start, start + 1);
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

    /// Bounds the time spent on re-reading lines after strings that are not closed.
    fn give_up_if_hopeless(&mut self) {
        if self.out.diagnostics.len() > MAX_UNCLOSED {
            self.at = self.bytes.len();
            self.out.truncated = true;
        }
    }

    /// A string over several lines directly followed by a word: its closing mark opens the next string in truth.
    ///
    /// Texts in HTML are left alone: there it is more likely a quotation mark without backslash.
    fn ends_strangely(&self, start: usize, end: usize) -> bool {
        let follows = self.bytes.get(end).is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80);
        follows
            && self.bytes[start..end].contains(&b'\n')
            && !self.bytes[start + 1..].starts_with(b"<html")
            && !self.bytes[start + 1..].starts_with(b"<HTML")
    }

    /// The end of a line without its semicolon, which is likely none of what is not closed.
    fn before_semicolon(&self, start: usize) -> usize {
        let line_end = self.find_from(start, b'\n').unwrap_or(self.bytes.len());
        let line = self.text[start..line_end].trim_ascii_end();
        start + line.strip_suffix(';').unwrap_or(line).len()
    }

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

    fn sign(&mut self) {
        let start = self.at;
        let (kind, length) = self.two_characters().map_or_else(|| self.one_character(), |kind| (kind, 2));
        self.push(kind, start, start + length);
    }

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
                let length = self.text[self.at..].chars().next().map_or(1, char::len_utf8);
                return (TokenKind::Unknown, length);
            }
        };
        (kind, 1)
    }
}
