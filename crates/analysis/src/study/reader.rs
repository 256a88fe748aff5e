//! Reads values of a TOML document and reports mistakes at their places.
//!
//! `table` walks the document and asks for texts, numbers and tables. Each function returns `None` and notes a
//! diagnostic where the value has another type.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use bramah_syntax::diag::{Code, Diagnostic, FileId, Span, nearest};

/// A TOML value with its place in the text.
pub(super) type StudyValue<'a> = Spanned<DeValue<'a>>;

/// Reads values and collects diagnostics.
pub(super) struct StudyReader {
    /// The text that places refer to.
    file: FileId,
    /// The mistakes found so far.
    pub diagnostics: Vec<Diagnostic>,
}

impl StudyReader {
    /// A reader for the text `file`.
    pub fn new(file: FileId) -> Self {
        StudyReader { file, diagnostics: Vec::new() }
    }

    /// The place of a byte range of the text.
    pub fn span(&self, place: &Range<usize>) -> Span {
        let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        Span { file: self.file, start: byte(place.start), end: byte(place.end) }
    }

    /// Adds a mistake at a place.
    pub fn report(&mut self, place: &Range<usize>, message: impl Into<String>, label: impl Into<String>) {
        self.add(Diagnostic::new(Code::BadStudy, message).at(self.span(place), label));
    }

    /// Adds a complete diagnostic.
    pub fn add(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports a value of another type than expected.
    pub fn wrong_kind(&mut self, key: &str, value: &StudyValue<'_>, expected: &str) {
        let found = value.get_ref().type_str();
        self.report(&value.span(), format!("`{key}` is {expected}"), format!("this is a value of type {found}"));
    }

    /// Reports an unknown key, with the most similar known one, else with all of them.
    pub fn unknown(&mut self, key: &str, place: &Range<usize>, known: &[&str]) {
        let diagnostic =
            Diagnostic::new(Code::BadStudy, format!("there is no key `{key}`")).at(self.span(place), "unknown key");
        // A key with dashes is most likely the same one with underscores.
        let with_bars = key.replace('-', "_");
        let same = known.iter().copied().find(|k| *k == with_bars);
        self.add(match same.or_else(|| nearest(key, known.iter().copied())) {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => {
                let list: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
                diagnostic.help(format!("known keys: {}", list.join(", ")))
            }
        });
    }

    /// A string.
    pub fn text(&mut self, key: &str, value: &StudyValue<'_>) -> Option<String> {
        let text = value.get_ref().as_str().map(str::to_owned);
        if text.is_none() {
            self.wrong_kind(key, value, "a text in quotes");
        }
        text
    }

    /// A Boolean.
    pub fn truth(&mut self, key: &str, value: &StudyValue<'_>) -> Option<bool> {
        let truth = value.get_ref().as_bool();
        if truth.is_none() {
            self.wrong_kind(key, value, "true or false");
        }
        truth
    }

    /// A finite number, written as an integer or a float.
    pub fn number(&mut self, key: &str, value: &StudyValue<'_>) -> Option<f64> {
        let number = number(value.get_ref()).filter(|x| x.is_finite());
        if number.is_none() {
            self.wrong_kind(key, value, "a number");
        }
        number
    }

    /// A list of strings; items of another type are reported and left out.
    pub fn list(&mut self, key: &str, value: &StudyValue<'_>) -> Vec<String> {
        let DeValue::Array(items) = value.get_ref() else {
            self.wrong_kind(key, value, "a list of texts");
            return Vec::new();
        };
        items.iter().filter_map(|item| self.text(key, item)).collect()
    }

    /// A table.
    pub fn table<'v, 'a>(&mut self, key: &str, value: &'v StudyValue<'a>) -> Option<&'v DeTable<'a>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.wrong_kind(key, value, "a table");
        }
        table
    }

    /// The entries of a table whose keys are dotted names.
    ///
    /// `a.b = 1` arrives as a table inside a table. A table that holds anything but tables is an entry itself.
    pub fn named<'v, 'a>(&mut self, key: &str, value: &'v StudyValue<'a>) -> Vec<StudyEntry<'v, 'a>> {
        let mut found = Vec::new();
        if let Some(table) = self.table(key, value) {
            self.collect("", table, &mut found);
        }
        found
    }

    /// Adds the entries of `table` below the dotted `prefix`.
    fn collect<'v, 'a>(&self, prefix: &str, table: &'v DeTable<'a>, found: &mut Vec<StudyEntry<'v, 'a>>) {
        for (key, value) in table {
            let name =
                if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
            match value.get_ref().as_table() {
                Some(inner) if !inner.is_empty() && inner.iter().all(|(_, v)| v.get_ref().is_table()) => {
                    self.collect(&name, inner, found);
                }
                _ => found.push(StudyEntry { name, span: self.span(&key.span()), value }),
            }
        }
    }
}

/// An entry with its dotted name.
pub(super) struct StudyEntry<'v, 'a> {
    /// The dotted name.
    pub name: String,
    /// The place of the name.
    pub span: Span,
    /// Its value.
    pub value: &'v StudyValue<'a>,
}

/// The number of a TOML integer or float; `None` for other types.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => None,
    }
}
