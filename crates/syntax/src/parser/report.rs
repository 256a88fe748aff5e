//! The messages of the parser: what was expected, what was found, and which mistake it probably is.
//! All functions that parse report through these methods.
//!
//! One mistake often makes several tokens unexpected. [`Parser::report`] therefore drops errors that follow from an
//! earlier one, and a mistake that is recognised (a "slip") is reported and parsed as what was meant.

use super::{OpenBlock, OpenBlockKind, ParseAbort, ParseResult, Parser, expr};
use crate::diag::{Code, Diagnostic, Span, nearest};
use crate::token::{Token, TokenKind};

/// The largest number of errors reported for one file. The rest is dropped.
const MAX_ERRORS: usize = 100;

/// The keywords that begin most files, as candidates for "did you mean".
const CLASS_WORDS: &[&str] =
    &["model", "package", "block", "connector", "record", "function", "type", "class", "within", "partial"];

/// The longest word quoted in a message, in characters.
const MAX_QUOTED: usize = 40;

impl Parser<'_> {
    /// Records an error at the current token, unless it follows from one already reported.
    /// It is dropped if the token was blamed before, a limit was reached, or there are [`MAX_ERRORS`] errors already.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        // At the end of a truncated text every construct looks unclosed; only the lexer's error is real.
        let follows = self.blamed == Some(self.at)
            || self.halted
            || (self.truncated && self.at(TokenKind::Eof))
            || self.diagnostics.len() >= MAX_ERRORS;
        // A dropped error also marks its token: the next one at the same token follows from it too.
        self.blamed = Some(self.at);
        if !follows {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Records an error about an `end`, unless the same class already had one.
    /// A wrong `end` shifts the nesting, so that further ones in the class say nothing new.
    pub(super) fn report_end(&mut self, diagnostic: Diagnostic) {
        if !self.misnested {
            self.report(diagnostic);
        }
        self.misnested = true;
    }

    /// Reports a recognised mistake at the current token; the parser continues as if the text were right.
    /// `message` is one line, `label` stands at the place, and `help` says what to write instead.
    pub(super) fn slip(&mut self, message: impl Into<String>, label: &str, help: impl Into<String>) {
        self.slip_at(self.span(), message, label, help);
    }

    /// The same at another place. The result serves callers that cannot continue.
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

    /// Reports "expected this, found the current token". `expected` comes with its own backticks.
    /// The result is to be returned by the caller, which cannot continue.
    pub(super) fn unexpected(&mut self, expected: &str) -> ParseAbort {
        self.unexpected_with(expected, None)
    }

    /// The same with advice. Advice about the token found takes precedence over `help`.
    /// `help` is a complete sentence without a final full stop.
    pub(super) fn unexpected_with(&mut self, expected: &str, help: Option<&str>) -> ParseAbort {
        let mut diagnostic = self.expected_found(expected);
        let own = self.advice_on_token();
        if let Some(help) = own.or(help.map(str::to_owned)) {
            diagnostic = diagnostic.help(help);
        }
        self.report(diagnostic);
        ParseAbort
    }

    /// The same inside an item that may be the rest of the one before it.
    /// After a guessed semicolon nothing is reported: what is missing is an operator, and the guess was the error.
    pub(super) fn unexpected_in_item(&mut self, expected: &str, help: Option<&str>) -> ParseAbort {
        if self.guessed { ParseAbort } else { self.unexpected_with(expected, help) }
    }

    /// The diagnostic "expected this, found the current token", without help.
    /// A character that Modelica does not use is named as such.
    fn expected_found(&self, expected: &str) -> Diagnostic {
        let found = self.describe(self.token());
        let message = match self.kind() {
            TokenKind::Unknown => format!("expected {expected}, found {found}, which Modelica does not use"),
            _ => format!("expected {expected}, found {found}"),
        };
        Diagnostic::new(Code::Syntax, message).at(self.span(), format!("expected {expected}"))
    }

    /// A token in the words of a message, such as "the keyword `end`".
    /// Long words are shortened, and the end of the text is called "the end of the file".
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

    /// Advice that follows from the current token alone. `None` if the token tells nothing.
    /// It explains characters of other languages, units behind numbers, and `=` in conditions.
    fn advice_on_token(&self) -> Option<String> {
        let token = self.token();
        let previous = self.previous().kind;
        let advice = match token.kind {
            TokenKind::Unknown => return advice_on_character(self.word(token)),
            // `200 bar`: a number followed by a name on the same line is nearly always a unit or a missing `*`.
            TokenKind::Ident if is_number(previous) && !self.is_on_new_line() => {
                "a product is written with `*`; a value stands in the SI unit of its variable, without the unit behind it: 200 bar are `200e5`"
            }
            TokenKind::Equal if self.blames_comparison() => "equality is tested with `==`",
            TokenKind::StarStar => "a power is written `a^b`",
            _ => return None,
        };
        Some(advice.to_owned())
    }

    /// True at an `=` in a block with a condition, where `==` was probably meant.
    /// On a new line the `=` belongs to another item, and the condition was not finished.
    fn blames_comparison(&self) -> bool {
        matches!(
            self.open.last().map(|open| open.kind),
            Some(OpenBlockKind::If | OpenBlockKind::When | OpenBlockKind::While)
        ) && !self.is_on_new_line()
    }

    /// Recognises a keyword used as a name, reports it, and returns true: the caller then takes it for the name.
    /// False if the keyword probably begins something, so that it must not be consumed.
    /// `what` says in the message what kind of name was expected.
    pub(super) fn keyword_as_name(&mut self, what: &str) -> bool {
        use TokenKind as T;
        // Only what can follow a name lets the keyword pass for one.
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

    /// Reports and skips a semicolon where an item could begin. False if there is none.
    /// The cursor is then behind it.
    pub(super) fn stray_semicolon(&mut self) -> bool {
        let is_stray = self.at(TokenKind::Semicolon);
        if is_stray {
            self.slip("a `;` with nothing before it", "one `;` too many", "leave it out");
            self.bump();
        }
        is_stray
    }

    /// Reports a quotation mark without backslash inside a string, and skips the rest of the string.
    /// The lexer ended the string at that mark; its rest became words and further strings.
    /// It is called after a string token; each round handles one such mark.
    pub(super) fn skip_rest_of_string(&mut self) {
        // Each further string that touches a word is another part of the same text.
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

    /// True at a name, number or keyword.
    fn is_word(&self) -> bool {
        matches!(self.kind(), TokenKind::Ident | TokenKind::Integer | TokenKind::Real) || self.kind().is_keyword()
    }

    /// Reports something at the top level of a file that is no class, with the class keyword it resembles.
    /// A stray `end` after an earlier error is not reported.
    pub(super) fn no_class(&mut self) -> ParseAbort {
        // A stray `end` after other errors is what an earlier mistake left over.
        if self.at(TokenKind::End) && !self.diagnostics.is_empty() {
            return ParseAbort;
        }
        let near = nearest(self.word(self.token()), CLASS_WORDS.iter().copied());
        let help = near.map(|keyword| format!("did you mean `{keyword}`?"));
        self.unexpected_with("a class such as `model` or `package`", help.as_deref())
    }

    /// Reports what follows a complete element, equation or statement on the same line.
    /// The previous token decides whether an operator could follow, which the message then offers.
    pub(super) fn unexpected_after_item(&mut self) -> ParseAbort {
        use TokenKind as T;
        let expected = match self.previous().kind {
            // After a description nothing but the semicolon may follow; after an operand an operator may.
            T::String => "`;`",
            T::Ident | T::Integer | T::Real | T::RightParen | T::RightBracket | T::RightBrace => "an operator or `;`",
            _ => "`;`",
        };
        self.unexpected(expected)
    }

    /// Reports a semicolon missing after the previous token; the parser continues as if it stood there.
    /// The diagnostic carries the fix that inserts it.
    /// The place is empty and lies directly behind the token, where editors insert.
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

    /// The closing bracket of what was opened at `opened`, with its place.
    /// `expected` lists what may stand here, for the message.
    ///
    /// # Errors
    /// Reports the bracket as unclosed if the current token cannot stand inside brackets, else the token as unexpected.
    /// `opened` is the place of the opening bracket, which the message shows too.
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

    /// True at a token that can only stand outside the current brackets.
    /// Such as `;`, another closing bracket, a section keyword, or `then`.
    fn ends_brackets(&self) -> bool {
        use TokenKind as T;
        let closing = matches!(self.kind(), T::Semicolon | T::RightParen | T::RightBracket | T::RightBrace);
        closing || self.is_boundary() || expr::looks_like_equation(self) || matches!(self.kind(), T::Then | T::Loop)
    }

    /// Reports a class or block whose `end` is missing before the current token.
    /// If it contains an `else if`, the message shows that place: it opened a second `if`.
    /// The current token is where the `end` should be.
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

    /// The current token for a message, together with the word after it if it is `end`.
    /// For example "`end Volume`".
    fn found_at_end(&self) -> String {
        let next = self.peek(1);
        match self.kind() {
            TokenKind::End if next.kind == TokenKind::Ident || next.kind.is_keyword() => {
                format!("`end {}`", shortened(self.word(next)))
            }
            _ => self.describe(self.token()),
        }
    }

    /// Reports an `end` whose name or keyword does not fit what it closes; the cursor is on `end`.
    /// For a name, the place is that of the name; for a bare `end;`, that of the `end`.
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
        // The fix replaces the word after `end`; a bare `end;` has no word to replace.
        let word = closing.strip_prefix("end ").filter(|_| place != self.span());
        self.report_end(match word {
            Some(word) => diagnostic.fix(place, word),
            None => diagnostic,
        });
    }

    /// Recognises a block word of another language at the beginning of an item, such as `elif` or `endif`.
    /// Gives the keyword meant and its spelling. `None` outside a block of that kind, where the word may be a name.
    /// The innermost open block decides, so that `endif` is only understood inside an `if`.
    pub(super) fn misspelt_block_word(&self) -> Option<(TokenKind, &'static str)> {
        if !self.at(TokenKind::Ident) {
            return None;
        }
        let top = self.open.last()?.kind;
        let follows = self.peek_kind(1);
        let closes = follows == TokenKind::Semicolon;
        // A variable may have such a name: `elif = 1` is an equation.
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

    /// True if a misspelt word stands here that means `kind`.
    pub(super) fn at_misspelt(&self, kind: TokenKind) -> bool {
        self.misspelt_block_word().is_some_and(|(meant, _)| meant == kind)
    }

    /// Reports and skips a misspelt word that means `kind`. False if there is none.
    /// The caller then continues as after the right word.
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
    /// The construct and its closing words for a message, such as "this `if`" and "end if".
    /// A class is called by its name, a block by its keyword.
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

/// True for number tokens.
fn is_number(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Integer | TokenKind::Real)
}

/// A word shortened to one line and [`MAX_QUOTED`] characters, with dots where something was cut.
/// Quoted text of several lines would break the layout of messages.
pub(super) fn shortened(word: &str) -> String {
    let line = word.lines().next().unwrap_or("");
    let mut short: String = line.chars().take(MAX_QUOTED).collect();
    if short.len() < word.len() {
        short.push_str("...");
    }
    short
}

/// Advice for a character outside Modelica's alphabet, such as typographic quotes or operators of other languages.
/// `None` if there is nothing better to say than that it is unknown.
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
