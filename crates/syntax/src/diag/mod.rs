//! The one diagnostic type, and the places in source texts it points to.
//!
//! Every stage returns [`StageResult`]: what it could make of its input, and what it has to say about it.
//! Rendering (human, short, JSON) lives in [`render`]; the list of codes in [`codes`].

pub mod codes;
mod error;
mod nearest;
pub mod render;

pub use codes::{Code, Severity};
pub use error::Error;
pub use nearest::nearest;

/// Index of a text in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A stretch of bytes in one source text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
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

/// One text the user wrote, or one that ships with bramah.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// The path as the user knows it.
    pub path: String,
    /// The whole text.
    pub text: String,
}

/// All texts of one run, in the order in which they were read.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceText>,
}

impl Sources {
    /// All texts in the order in which they were read.
    pub fn iter(&self) -> impl Iterator<Item = &SourceText> {
        self.files.iter()
    }

    /// Adds a text and returns its index.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<String>) -> FileId {
        self.files.push(SourceText { path: path.into(), text: text.into() });
        FileId(u32::try_from(self.files.len() - 1).expect("fewer than 2^32 files"))
    }

    /// The text behind an index.
    pub fn get(&self, file: FileId) -> &SourceText {
        &self.files[file.0 as usize]
    }

    /// The words a span covers.
    pub fn text(&self, span: Span) -> &str {
        self.get(span.file).text.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// Line and column, both counted from 1, columns in characters.
    pub fn line_column(&self, file: FileId, offset: u32) -> (usize, usize) {
        let text = &self.get(file).text;
        let mut at = (offset as usize).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &text[..at];
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

/// A place in a text with what is to be said there.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What is said there; may be empty.
    pub text: String,
}

/// Something the user should know.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Which kind of thing; carries stage, number and default severity.
    pub code: Code,
    /// Error, warning or note.
    pub severity: Severity,
    /// One line, names in backticks as the user wrote them.
    pub message: String,
    /// Places; the first is the primary one.
    pub labels: Vec<Label>,
    /// The component instance concerned, by its full name.
    pub instance: Option<String>,
    /// The class concerned.
    pub class: Option<String>,
    /// Facts that explain the message, possibly tables of several lines.
    pub notes: Vec<String>,
    /// What to do about it.
    pub help: Vec<String>,
    /// A change of the text that would do it, for editors.
    pub fix: Option<TextReplacement>,
}

/// A change of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextReplacement {
    /// What is replaced; empty where something is inserted.
    pub span: Span,
    /// What stands there afterwards.
    pub text: String,
}

impl Diagnostic {
    /// A diagnostic of the code's own severity, without places yet.
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

    /// Proposes the name that was probably meant in place of the one at the primary place.
    #[must_use]
    pub fn meant(self, near: &str) -> Self {
        let primary = self.labels.first().map(|l| l.span);
        let made = self.help(format!("did you mean `{near}`?"));
        match primary {
            Some(span) => made.fix(span, near),
            None => made,
        }
    }

    /// Proposes a change of the text.
    #[must_use]
    pub fn fix(mut self, span: Span, text: impl Into<String>) -> Self {
        self.fix = Some(TextReplacement { span, text: text.into() });
        self
    }

    /// The same with the advice of its code, where nothing better was said.
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

/// What a stage made of its input, and what it says about it.
///
/// `value` is `None` only when there is an error among the diagnostics.
#[derive(Clone, Debug)]
pub struct StageResult<T> {
    /// The result, if one could be made.
    pub value: Option<T>,
    /// Errors, warnings and notes, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
}

impl<T> StageResult<T> {
    /// A result with remarks.
    pub fn new(value: T, diagnostics: Vec<Diagnostic>) -> Self {
        StageResult { value: Some(value), diagnostics }
    }

    /// No result.
    pub fn failed(diagnostics: Vec<Diagnostic>) -> Self {
        StageResult { value: None, diagnostics }
    }

    /// Appends the diagnostics to `sink` and hands out the value, or nothing if there was an error.
    pub fn sink(self, sink: &mut Vec<Diagnostic>) -> Option<T> {
        let failed = self.diagnostics.iter().any(Diagnostic::is_error);
        sink.extend(self.diagnostics);
        if failed { None } else { self.value }
    }
}
