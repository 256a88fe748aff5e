//! Diagnostics, and the places in source texts that they point to.
//!
//! Every stage of the compiler returns a [`StageResult`]: what it could make of its input, and its diagnostics.
//! A [`Diagnostic`] is built by chained methods: `Diagnostic::new(code, message).at(span, label).help(text)`.
//! [`render`] writes diagnostics for people, for tools, and as JSON. [`codes`] has the list of codes.

pub mod codes;
mod error;
mod nearest;
pub mod render;

pub use codes::{Code, Severity};
pub use error::Error;
pub use nearest::nearest;

/// The index of a text in [`Sources`]. It is meaningful only together with the `Sources` that it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A range of bytes in one source text. Spans compare by file, then by place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The text that the bytes are counted in.
    pub file: FileId,
    /// The first byte, counted from 0.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The smallest span that covers both; `other` must lie in the same file.
    #[must_use]
    pub fn to(self, other: Span) -> Span {
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One source text: a file of the user, or one that ships with bramah.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// The path as the user knows it.
    pub path: String,
    /// The complete text.
    pub text: String,
}

/// All texts of one run, in the order in which they were read. Spans refer to them by [`FileId`].
#[derive(Clone, Debug, Default)]
/// The texts; a `FileId` is an index here.
pub struct Sources {
    files: Vec<SourceText>,
}

impl Sources {
    /// All texts in the order in which they were read.
    pub fn iter(&self) -> impl Iterator<Item = &SourceText> {
        self.files.iter()
    }

    /// Adds a text and gives its index.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<String>) -> FileId {
        self.files.push(SourceText { path: path.into(), text: text.into() });
        FileId(u32::try_from(self.files.len() - 1).expect("fewer than 2^32 files"))
    }

    /// Adds a text from its bytes. Those that are not UTF-8 are replaced: remarks and units of old programs often contain
    /// such, and do no harm.
    pub fn add_bytes(&mut self, path: String, bytes: Vec<u8>) -> FileId {
        let text = String::from_utf8(bytes).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned());
        self.add(path, text)
    }

    /// The text of an index.
    pub fn get(&self, file: FileId) -> &SourceText {
        &self.files[file.0 as usize]
    }

    /// The text that a span covers. Empty if the span does not fit the text.
    pub fn text(&self, span: Span) -> &str {
        self.get(span.file).text.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// The line and column of a byte, both counted from 1. Columns count characters, not bytes.
    /// An offset past the end of the text means the end.
    pub fn line_column(&self, file: FileId, offset: u32) -> (usize, usize) {
        let text = &self.get(file).text;
        let mut at = (offset as usize).min(text.len());
        // A place inside a character of several bytes counts as the beginning of that character.
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &text[..at];
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

/// A place in a text, with a short remark about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// The remark. It may be empty, which only marks the place.
    pub text: String,
}

/// A message for the user: an error, a warning or a note.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// The kind of message, with its number and default severity.
    pub code: Code,
    /// Error, warning or note.
    pub severity: Severity,
    /// One line, names in backticks as the user wrote them.
    pub message: String,
    /// The places concerned. The first is the primary one, which editors jump to.
    pub labels: Vec<Label>,
    /// The full name of the component instance concerned.
    pub instance: Option<String>,
    /// The name of the class concerned.
    pub class: Option<String>,
    /// Facts that explain the message, possibly tables of several lines.
    pub notes: Vec<String>,
    /// Advice, one entry for each alternative.
    pub help: Vec<String>,
    /// A change of the text that would solve the problem. Editors offer it.
    pub fix: Option<TextReplacement>,
}

/// A change of a text: some bytes are replaced by others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextReplacement {
    /// The bytes to be replaced. An empty span inserts.
    pub span: Span,
    /// The new text.
    pub text: String,
}

impl Diagnostic {
    /// A diagnostic with the default severity of its code, and without places.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Diagnostic {
            code,
            severity: code.severity(),
            message: message.into(),
            labels: Vec::new(),
            instance: None,
            class: None,
            notes: Vec::new(),
            help: Vec::new(),
            fix: None,
        }
    }

    /// Adds a place; the first one added is the primary one.
    #[must_use]
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Adds an explaining fact.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    /// Adds advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Proposes `near` as the name that was probably meant, as help and as a fix at the primary place.
    #[must_use]
    pub fn meant(self, near: &str) -> Self {
        let primary = self.labels.first().map(|l| l.span);
        let made = self.help(format!("did you mean `{near}`?"));
        match primary {
            Some(span) => made.fix(span, near),
            None => made,
        }
    }

    /// Proposes a change of the text, which replaces a fix proposed before.
    #[must_use]
    pub fn fix(mut self, span: Span, text: impl Into<String>) -> Self {
        self.fix = Some(TextReplacement { span, text: text.into() });
        self
    }

    /// Adds the general advice of the code if there is no help yet.
    #[must_use]
    pub fn advised(mut self) -> Self {
        if self.help.is_empty() {
            self.help.extend(self.code.advice().map(String::from));
        }
        self
    }

    /// Names the component instance concerned.
    #[must_use]
    pub fn instance(mut self, name: impl Into<String>) -> Self {
        self.instance = Some(name.into());
        self
    }

    /// Names the class concerned.
    #[must_use]
    pub fn class(mut self, name: impl Into<String>) -> Self {
        self.class = Some(name.into());
        self
    }

    /// True for errors.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// The result of a stage, with its diagnostics.
///
/// `value` is `None` only if there is an error among the diagnostics; a value may come with errors too.
#[derive(Clone, Debug)]
pub struct StageResult<T> {
    /// The result, if one could be made.
    pub value: Option<T>,
    /// Errors, warnings and notes, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
}

impl<T> StageResult<T> {
    /// A result, with warnings and notes or with errors that did not prevent it.
    pub fn new(value: T, diagnostics: Vec<Diagnostic>) -> Self {
        StageResult { value: Some(value), diagnostics }
    }

    /// No result; `diagnostics` must contain an error.
    pub fn failed(diagnostics: Vec<Diagnostic>) -> Self {
        StageResult { value: None, diagnostics }
    }

    /// Appends the diagnostics to `sink` and hands out the value.
    /// `None` if there was an error, even if there is a value.
    pub fn sink(self, sink: &mut Vec<Diagnostic>) -> Option<T> {
        let failed = self.diagnostics.iter().any(Diagnostic::is_error);
        sink.extend(self.diagnostics);
        if failed { None } else { self.value }
    }
}
