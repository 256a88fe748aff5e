//! The messages of the parser: what was expected, what was found, and the slip it probably is.

use super::{OpenBlock, OpenBlockKind, ParseAbort, ParseResult, Parser, expr};
use crate::diag::{Code, Diagnostic, Span, nearest};
use crate::token::{Token, TokenKind};

/// No more errors than this are reported for one file.
const MAX_ERRORS: usize = 100;

/// The keywords that begin most files.
const CLASS_WORDS: &[&str] =
    &["model", "package", "block", "connector", "record", "function", "type", "class", "within", "partial"];

/// The longest word quoted in a message, in characters.
const MAX_QUOTED: usize = 40;

impl Parser<'_> {
    /// Keeps an error at the current token, unless it follows from one already reported.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        let follows = self.blamed == Some(self.at)
            || self.halted
            || (self.truncated && self.at(TokenKind::Eof))
            || self.diagnostics.len() >= MAX_ERRORS;
        self.blamed = Some(self.at);
        if !follows {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Keeps an error about an `end`, unless another one in the same class came before.
    pub(super) fn report_end(&mut self, diagnostic: Diagnostic) {
        if !self.misnested {
            self.report(diagnostic);
        }
        self.misnested = true;
    }

    /// Reports a slip at the current token, after which the parser knows how to go on.
    pub(super) fn slip(&mut self, message: impl Into<String>, label: &str, help: impl Into<String>) {
        self.slip_at(self.span(), message, label, help);
    }

    /// The same at another place.
    pub(super) fn slip_at(
        &mut self,
        place: Span,
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> ParseAbort {
        let diagnostic = Diagnostic::new(Code::Syntax, message).at(place, label).help(help);
        self.report(diagnostic);
        ParseAbort
    }

    /// Reports "expected this, found the current token".
    pub(super) fn unexpected(&mut self, expected: &str) -> ParseAbort {
        self.unexpected_with(expected, None)
    }

    /// The same with advice, unless the token itself explains what is wrong.
    pub(super) fn unexpected_with(&mut self, expected: &str, help: Option<&str>) -> ParseAbort {
        let mut diagnostic = self.expected_found(expected);
        let own = self.advice_on_token();
        if let Some(help) = own.or(help.map(str::to_owned)) {
            diagnostic = diagnostic.help(help);
        }
        self.report(diagnostic);
        ParseAbort
    }

    /// The same, unless a semicolon was just guessed: then an operator was missing in truth.
    pub(super) fn unexpected_in_item(&mut self, expected: &str, help: Option<&str>) -> ParseAbort {
        if self.guessed { ParseAbort } else { self.unexpected_with(expected, help) }
    }

    fn expected_found(&self, expected: &str) -> Diagnostic {
        let found = self.describe(self.token());
        let message = match self.kind() {
            TokenKind::Unknown => format!("expected {expected}, found {found}, which Modelica does not use"),
            _ => format!("expected {expected}, found {found}"),
        };
        Diagnostic::new(Code::Syntax, message).at(self.span(), format!("expected {expected}"))
    }

    /// A token in the user's words.
    pub(super) fn describe(&self, token: Token) -> String {
        let word = shortened(self.word(token));
        match token.kind {
            TokenKind::Eof => "the end of the file".to_owned(),
            TokenKind::Integer | TokenKind::Real => format!("the number {word}"),
            TokenKind::String => format!("the string {word}"),
            TokenKind::Unknown => format!("the character `{word}`"),
            kind if kind.is_keyword() => format!("the keyword `{word}`"),
            _ => format!("`{word}`"),
        }
    }

    fn advice_on_token(&self) -> Option<String> {
        let token = self.token();
        let previous = self.previous().kind;
        let advice = match token.kind {
            TokenKind::Unknown => return advice_on_character(self.word(token)),
            TokenKind::Ident if is_number(previous) && !self.is_on_new_line() => {
                "a product is written with `*`; a value stands in the SI unit of its variable, without the unit behind it: 200 bar are `200e5`"
            }
            TokenKind::Equal if self.blames_comparison() => "equality is tested with `==`",
            TokenKind::StarStar => "a power is written `a^b`",
            _ => return None,
        };
        Some(advice.to_owned())
    }

    /// A single `=` where a condition goes on.
    fn blames_comparison(&self) -> bool {
        matches!(
            self.open.last().map(|open| open.kind),
            Some(OpenBlockKind::If | OpenBlockKind::When | OpenBlockKind::While)
        ) && !self.is_on_new_line()
    }

    /// Whether a keyword stands where a name should, as if it were one; then it is reported and taken for the name.
    pub(super) fn keyword_as_name(&mut self, what: &str) -> bool {
        use TokenKind as T;
        let follows = self.peek_kind(1);
        let like_name = matches!(follows, T::Semicolon | T::Equal | T::LeftParen | T::LeftBracket | T::Comma)
            || (follows == T::String && !self.is_on_new_line());
        let statement = matches!(self.kind(), T::If | T::When | T::While | T::For | T::Annotation | T::Connect);
        if !self.kind().is_keyword() || !like_name || statement || self.is_on_new_line() {
            return false;
        }
        let word = self.word(self.token());
        let help = format!("choose another name, such as `{word}_`; keywords cannot be names");
        let message = format!("expected {what}, found the keyword `{word}`");
        self.slip(message, "a keyword cannot be a name", help);
        true
    }

    /// Reports and passes over a semicolon where an item could begin.
    pub(super) fn stray_semicolon(&mut self) -> bool {
        let is_stray = self.at(TokenKind::Semicolon);
        if is_stray {
            self.slip("a `;` with nothing before it", "one `;` too many", "leave it out");
            self.bump();
        }
        is_stray
    }

    /// Reports a quotation mark in the middle of a string, whose rest is read as words and further strings.
    pub(super) fn skip_rest_of_string(&mut self) {
        while self.previous().kind == TokenKind::String && self.is_adjacent(0) && self.is_word() {
            let help = "a quotation mark inside a string is written `\\\"`";
            let end = self.previous().end;
            let place = Span { file: self.file, start: end - 1, end };
            self.slip_at(place, "the string ends in the middle of its text", "it ends here", help);
            while !self.at(TokenKind::String) && !self.at(TokenKind::Eof) && !self.is_on_new_line() {
                self.bump();
            }
            if !self.eat(TokenKind::String) {
                return;
            }
        }
    }

    fn is_word(&self) -> bool {
        matches!(self.kind(), TokenKind::Ident | TokenKind::Integer | TokenKind::Real) || self.kind().is_keyword()
    }

    /// Reports something at the top of a file that is no class, perhaps for a misspelt keyword.
    pub(super) fn no_class(&mut self) -> ParseAbort {
        if self.at(TokenKind::End) && !self.diagnostics.is_empty() {
            return ParseAbort;
        }
        let near = nearest(self.word(self.token()), CLASS_WORDS.iter().copied());
        let help = near.map(|keyword| format!("did you mean `{keyword}`?"));
        self.unexpected_with("a class such as `model` or `package`", help.as_deref())
    }

    /// What stands after a complete element, equation or statement on the same line.
    pub(super) fn unexpected_after_item(&mut self) -> ParseAbort {
        use TokenKind as T;
        let expected = match self.previous().kind {
            T::String => "`;`",
            T::Ident | T::Integer | T::Real | T::RightParen | T::RightBracket | T::RightBrace => "an operator or `;`",
            _ => "`;`",
        };
        self.unexpected(expected)
    }

    /// Reports a semicolon missing at the end of the previous token, and goes on as if it stood there.
    pub(super) fn missing_semicolon(&mut self) {
        let end = self.previous().end;
        let place = Span { file: self.file, start: end, end };
        let after = self.describe(self.previous());
        let message = format!("expected `;` after {after}, found {}", self.describe(self.token()));
        let diagnostic = Diagnostic::new(Code::Syntax, message)
            .at(place, "`;` is missing here")
            .help("write `;` here")
            .fix(place, ";");
        self.report(diagnostic);
        self.guessed = true;
    }

    /// The closing bracket of what was opened at a place.
    pub(super) fn close(&mut self, bracket: TokenKind, opened: Span, expected: &str) -> ParseResult<Span> {
        let span = self.span();
        if self.eat(bracket) {
            return Ok(span);
        }
        if !self.ends_brackets() {
            return Err(self.unexpected(expected));
        }
        let opening = self.text.get(opened.start as usize..opened.end as usize).unwrap_or("");
        let closing = bracket.spelling().unwrap_or("");
        let found = self.describe(self.token());
        let message = format!("`{opening}` is not closed: expected `{closing}`, found {found}");
        let diagnostic = Diagnostic::new(Code::UnterminatedText, message)
            .at(opened, "opened here")
            .at(span, format!("expected {expected} before this"));
        self.report(diagnostic);
        Err(ParseAbort)
    }

    /// Whether a token can only stand outside the brackets we are in.
    fn ends_brackets(&self) -> bool {
        use TokenKind as T;
        let closing = matches!(self.kind(), T::Semicolon | T::RightParen | T::RightBracket | T::RightBrace);
        closing || self.is_boundary() || expr::looks_like_equation(self) || matches!(self.kind(), T::Then | T::Loop)
    }

    /// Reports a class or block whose `end` is missing at the current token.
    pub(super) fn unclosed(&mut self, open: OpenBlock) {
        let (what, closing) = open.words();
        let found = self.found_at_end();
        let message = format!("{what} is not closed: expected `{closing}`, found {found}");
        let mut diagnostic = Diagnostic::new(Code::UnterminatedText, message)
            .at(open.span, "opened here")
            .at(self.span(), format!("expected `{closing}` before this"));
        if let Some(span) = open.else_if {
            diagnostic = diagnostic
                .at(span, "this opens a second `if`")
                .help("a further branch of the same `if` is written `elseif`, one word");
        }
        self.report_end(diagnostic);
    }

    /// The current token, with the word after it if it is `end`.
    fn found_at_end(&self) -> String {
        let next = self.peek(1);
        match self.kind() {
            TokenKind::End if next.kind == TokenKind::Ident || next.kind.is_keyword() => {
                format!("`end {}`", shortened(self.word(next)))
            }
            _ => self.describe(self.token()),
        }
    }

    /// Reports an `end` whose name or word does not belong to what it closes; the cursor is on `end`.
    pub(super) fn wrong_end(&mut self, open: OpenBlock) {
        let (what, closing) = open.words();
        let found = self.found_at_end();
        let place = match self.peek_kind(1) {
            TokenKind::Semicolon | TokenKind::Eof => self.span(),
            _ => self.span_of(self.peek(1)),
        };
        let diagnostic = Diagnostic::new(Code::WrongEnd, format!("expected `{closing}`, found {found}"))
            .at(place, format!("{what} ends here"))
            .at(open.span, "it begins here")
            .help(format!("write `{closing}`"));
        let word = closing.strip_prefix("end ").filter(|_| place != self.span());
        self.report_end(match word {
            Some(word) => diagnostic.fix(place, word),
            None => diagnostic,
        });
    }

    /// A word of other languages at the beginning of an item, with the Modelica word meant.
    pub(super) fn misspelt_block_word(&self) -> Option<(TokenKind, &'static str)> {
        if !self.at(TokenKind::Ident) {
            return None;
        }
        let top = self.open.last()?.kind;
        let follows = self.peek_kind(1);
        let closes = follows == TokenKind::Semicolon;
        let goes_on = !matches!(follows, TokenKind::Equal | TokenKind::Assign | TokenKind::Dot | TokenKind::Semicolon);
        match (self.word(self.token()), top) {
            ("elif" | "elsif", OpenBlockKind::If) if goes_on => Some((TokenKind::Elseif, "elseif")),
            ("endif", OpenBlockKind::If) if closes => Some((TokenKind::End, "end if")),
            ("endfor", OpenBlockKind::For) if closes => Some((TokenKind::End, "end for")),
            ("endwhile", OpenBlockKind::While) if closes => Some((TokenKind::End, "end while")),
            ("endwhen", OpenBlockKind::When) if closes => Some((TokenKind::End, "end when")),
            _ => None,
        }
    }

    /// Whether a misspelt word stands here that means `kind`.
    pub(super) fn at_misspelt(&self, kind: TokenKind) -> bool {
        self.misspelt_block_word().is_some_and(|(meant, _)| meant == kind)
    }

    /// Reports and passes over a word that [`Self::misspelt_block_word`] found, if it means `kind`.
    pub(super) fn eat_misspelt(&mut self, kind: TokenKind) -> bool {
        let Some((_, right)) = self.misspelt_block_word().filter(|(meant, _)| *meant == kind) else {
            return false;
        };
        let word = self.word(self.token());
        self.slip(format!("expected `{right}`, found `{word}`"), "not a Modelica word", format!("write `{right}`"));
        self.bump();
        true
    }
}

impl OpenBlock {
    /// What it is called, and how it is closed.
    fn words(&self) -> (String, String) {
        let block = |word: &str| (format!("this `{word}`"), format!("end {word}"));
        match self.kind {
            OpenBlockKind::Class(name) => {
                let name = shortened(name.as_str());
                (format!("class `{name}`"), format!("end {name}"))
            }
            OpenBlockKind::If => block("if"),
            OpenBlockKind::For => block("for"),
            OpenBlockKind::While => block("while"),
            OpenBlockKind::When => block("when"),
        }
    }
}

fn is_number(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Integer | TokenKind::Real)
}

/// A word short enough for a message of one line.
pub(super) fn shortened(word: &str) -> String {
    let line = word.lines().next().unwrap_or("");
    let mut short: String = line.chars().take(MAX_QUOTED).collect();
    if short.len() < word.len() {
        short.push_str("...");
    }
    short
}

fn advice_on_character(word: &str) -> Option<String> {
    let advice = match word {
        "#" => "a comment begins with `//`",
        "%" => "a remainder is written `mod(a, b)`, a comment begins with `//`",
        "&" => "the logical operator is `and`",
        "|" => "the logical operator is `or`",
        "\u{2212}" | "\u{2013}" | "\u{2014}" => "write the minus of the keyboard, `-`",
        "\u{d7}" | "\u{b7}" | "\u{22c5}" => "write `*`",
        "\u{f7}" => "write `/`",
        "\u{2264}" => "write `<=`",
        "\u{2265}" => "write `>=`",
        "\u{2260}" => "write `<>`",
        "\u{201c}" | "\u{201d}" | "\u{201e}" => "write straight quotation marks, `\"`",
        "\u{b2}" => "a square is written `x^2`",
        "\u{b3}" => "a cube is written `x^3`",
        "\u{a0}" => "this is a no-break space; write an ordinary one",
        _ if word.chars().all(char::is_alphabetic) => "names consist of the letters A to Z and a to z, digits and `_`",
        _ => return None,
    };
    Some(advice.to_owned())
}
