//! Parses the TOML text of an experiment file into an [`ExperimentSpecification`].
//!
//! All mistakes become diagnostics at their places in the text. The command puts its own flags over the result.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{ExperimentSpecification, InputHold, InputMap, duration, event_rows, seconds, tolerance};
use bramah_results::glob;
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources, Span, StageResult, nearest};

/// The keys at the top, in the order in which `bramah new` writes them.
const KEYS: &[&str] = &[
    "file",
    "model",
    "set",
    "start-time",
    "stop-time",
    "output-interval",
    "event-rows",
    "csv-units",
    "relative-tolerance",
    "variables",
    "output-file",
    "plot",
    "input",
    "time-column",
    "map",
    "interpolation",
    "library",
    "external",
    "statistics",
    "deny-warnings",
    "sweep",
];

/// A TOML value with its place in the text.
pub(super) type ExperimentValue<'a> = Spanned<DeValue<'a>>;

/// Parses an experiment file that was added to `sources`. Paths in it stay as written.
///
/// # Errors
/// [`Code::BadExperiment`]: text that is not TOML, unknown keys, values of the wrong type.
pub fn parse(sources: &Sources, file: FileId) -> StageResult<ExperimentSpecification> {
    let text = &sources.get(file).text;
    let (document, errors) = DeTable::parse_recoverable(text);
    let mut reader = ExperimentReader { file, experiment: ExperimentSpecification::default(), diagnostics: Vec::new() };
    for error in errors {
        let place = error.span().unwrap_or(0..0);
        let message = format!("the text is not TOML: {}", error.message().lines().next().unwrap_or("unreadable"));
        reader.report(&place, message, "here");
    }
    if reader.diagnostics.is_empty() {
        for (key, value) in document.get_ref() {
            reader.entry(key.get_ref(), &key.span(), value);
        }
    }
    if reader.diagnostics.is_empty() {
        StageResult::new(reader.experiment, Vec::new())
    } else {
        StageResult::failed(reader.diagnostics)
    }
}

/// Reads values and collects diagnostics.
pub(super) struct ExperimentReader {
    file: FileId,
    experiment: ExperimentSpecification,
    diagnostics: Vec<Diagnostic>,
}

impl ExperimentReader {
    /// A diagnostic at a byte range of the text.
    fn diagnostic(&self, place: &Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        let span = Span { file: self.file, start: byte(place.start), end: byte(place.end) };
        Diagnostic::new(Code::BadExperiment, message).at(span, label)
    }

    /// Adds a mistake at a place.
    pub(super) fn report(&mut self, place: &Range<usize>, message: impl Into<String>, label: impl Into<String>) {
        let diagnostic = self.diagnostic(place, message, label);
        self.diagnostics.push(diagnostic);
    }

    /// Reports a value of another type than expected.
    pub(super) fn wrong_kind(&mut self, key: &str, value: &ExperimentValue<'_>, expected: &str) {
        let found = value.get_ref().type_str();
        self.report(&value.span(), format!("`{key}` is {expected}"), format!("this is a value of type {found}"));
    }

    /// Reads one key at the top.
    fn entry(&mut self, key: &str, place: &Range<usize>, value: &ExperimentValue<'_>) {
        match key {
            "file" => self.experiment.file = self.text(key, value),
            "model" => self.experiment.model = self.text(key, value),
            "set" => self.set("", value),
            "start-time" => self.experiment.start_time = self.number(key, value, seconds),
            "stop-time" => self.experiment.stop_time = self.number(key, value, seconds),
            "output-interval" => self.experiment.output_interval = self.number(key, value, duration),
            "event-rows" => self.experiment.event_rows = self.number(key, value, event_rows),
            "csv-units" => self.experiment.csv_units = self.number(key, value, |text| text.parse()),
            "relative-tolerance" => self.experiment.relative_tolerance = self.number(key, value, tolerance),
            "variables" => self.experiment.variables = self.list(key, value),
            "output-file" => self.experiment.output_file = self.text(key, value),
            "plot" => self.experiment.plot = self.text(key, value),
            "input" => self.experiment.input = self.text(key, value),
            "time-column" => self.experiment.time_column = self.text(key, value),
            "map" => self.map(value),
            "interpolation" => self.experiment.interpolation = self.hold(key, value),
            "library" => self.experiment.library = self.list(key, value),
            "external" => self.experiment.external = self.list(key, value),
            "statistics" => self.experiment.statistics = self.text(key, value),
            "deny-warnings" => match value.get_ref().as_bool() {
                Some(deny) => self.experiment.deny_warnings = Some(deny),
                None => self.wrong_kind(key, value, "true or false"),
            },
            "sweep" => self.experiment.sweep = super::sweep::sweep(self, value),
            _ => self.unknown(key, place, KEYS),
        }
    }

    /// Reports an unknown key, with the most similar known one, else with all of them.
    pub(super) fn unknown(&mut self, key: &str, place: &Range<usize>, known: &[&str]) {
        let mut diagnostic = self.diagnostic(place, format!("there is no key `{key}`"), "unknown key");
        // A key with underscores is most likely the same one with dashes.
        let with_dashes = key.replace('_', "-");
        let same = known.iter().copied().find(|k| *k == with_dashes);
        diagnostic = match same.or_else(|| nearest(key, known.iter().copied())) {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => {
                let list: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
                diagnostic.help(format!("known keys: {}", list.join(", ")))
            }
        };
        self.diagnostics.push(diagnostic);
    }

    /// A string.
    pub(super) fn text(&mut self, key: &str, value: &ExperimentValue<'_>) -> Option<String> {
        let text = value.get_ref().as_str().map(str::to_owned);
        if text.is_none() {
            self.wrong_kind(key, value, "a text in quotes");
        }
        text
    }

    /// A number, or a string that `read` parses.
    fn number<T>(&mut self, key: &str, value: &ExperimentValue<'_>, read: fn(&str) -> Result<T, String>) -> Option<T> {
        let text = match value.get_ref() {
            DeValue::Integer(_) | DeValue::Float(_) | DeValue::String(_) => scalar(value.get_ref())?,
            _ => {
                self.wrong_kind(key, value, "a number");
                return None;
            }
        };
        read(&text).map_err(|e| self.report(&value.span(), e, format!("value of `{key}`"))).ok()
    }

    /// A list of strings, or one string with commas.
    fn list(&mut self, key: &str, value: &ExperimentValue<'_>) -> Vec<String> {
        match value.get_ref() {
            DeValue::String(text) => glob::split_list(text),
            DeValue::Array(items) => items.iter().filter_map(|item| self.text(key, item)).collect(),
            _ => {
                self.wrong_kind(key, value, "a list of texts");
                Vec::new()
            }
        }
    }

    /// Reads `[set]`. Dotted keys arrive as tables inside tables; `prefix` is the name so far.
    fn set(&mut self, prefix: &str, value: &ExperimentValue<'_>) {
        let DeValue::Table(table) = value.get_ref() else {
            self.wrong_kind("set", value, "a table of parameters and values");
            return;
        };
        for (key, value) in table {
            let name =
                if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
            match value.get_ref() {
                DeValue::Table(_) => self.set(&name, value),
                other => match scalar(other) {
                    Some(text) => self.experiment.set.push((name, text)),
                    None => self.wrong_kind(&name, value, "a number, a text, true, false or a list of these"),
                },
            }
        }
    }

    /// Reads `map`: a table, or one string as on the command line.
    fn map(&mut self, value: &ExperimentValue<'_>) {
        match value.get_ref() {
            DeValue::String(text) => {
                for entry in glob::split_list(text) {
                    self.mapped(InputMap::parse(&entry), value);
                }
            }
            DeValue::Table(table) => {
                for (key, value) in table {
                    self.map_entry(key.get_ref(), value);
                }
            }
            _ => self.wrong_kind("map", value, "a table of inputs and columns"),
        }
    }

    /// Adds an entry of `map`, or reports why it cannot be parsed.
    fn mapped(&mut self, entry: Result<InputMap, String>, value: &ExperimentValue<'_>) {
        match entry {
            Ok(entry) => self.experiment.map.push(entry),
            Err(why) => self.report(&value.span(), why, "this entry"),
        }
    }

    /// `F = "tau_N[N]"`, or `F = { column = "tau_N", unit = "N", interpolation = "linear" }`.
    fn map_entry(&mut self, input: &str, value: &ExperimentValue<'_>) {
        match value.get_ref() {
            DeValue::String(text) => self.mapped(InputMap::of(input, text), value),
            DeValue::Table(table) if table.iter().any(|(k, _)| is_map_key(k.get_ref())) => {
                let mut entry = InputMap { input: input.to_owned(), column: input.to_owned(), unit: None, hold: None };
                for (key, value) in table {
                    let name = key.get_ref().as_ref();
                    match name {
                        "column" => entry.column = self.text(name, value).unwrap_or_default(),
                        "unit" => entry.unit = self.text(name, value),
                        "interpolation" => entry.hold = self.hold(name, value),
                        _ => self.unknown(name, &key.span(), MAP_KEYS),
                    }
                }
                self.mapped(Ok(entry), value);
            }
            DeValue::Table(table) => {
                for (key, value) in table {
                    self.map_entry(&format!("{input}.{}", key.get_ref()), value);
                }
            }
            _ => self.wrong_kind(input, value, "the name of a column"),
        }
    }

    /// An interpolation: `held` or `linear`.
    fn hold(&mut self, key: &str, value: &ExperimentValue<'_>) -> Option<InputHold> {
        let hold = value.get_ref().as_str().and_then(InputHold::parse);
        if hold.is_none() {
            self.wrong_kind(key, value, "`held` or `linear`");
        }
        hold
    }
}

/// Keys of an entry of `[map]`.
const MAP_KEYS: &[&str] = &["column", "unit", "interpolation"];

/// Whether a table with this key is an entry of `[map]`, and no part of a dotted name.
fn is_map_key(key: &str) -> bool {
    MAP_KEYS.contains(&key)
}

/// A value in the syntax of Modelica; `None` for tables and dates.
pub(super) fn scalar(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i.to_string()),
        DeValue::Float(x) => Some(x.as_str().trim_start_matches('+').to_owned()),
        DeValue::Boolean(b) => Some(b.to_string()),
        DeValue::Array(items) => {
            let items: Option<Vec<String>> = items.iter().map(|i| scalar(i.get_ref())).collect();
            Some(format!("{{{}}}", items?.join(", ")))
        }
        DeValue::Datetime(_) | DeValue::Table(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_syntax::diag::render::{DiagnosticFormat, render, short_list};

    fn read(text: &str) -> (Option<ExperimentSpecification>, String) {
        let mut sources = Sources::default();
        let file = sources.add("press.toml", text);
        let checked = parse(&sources, file);
        let said = short_list(&sources, &checked.diagnostics);
        (checked.value, said)
    }

    #[test]
    fn everything_can_be_said() {
        let text = r#"
file = "Press.mo"
model = "Press"
start-time = 0
stop-time = "2 s"
output-interval = "1 ms"
relative-tolerance = 1e-7
variables = ["cyl.*", "A[1,2]"]
output-file = "press.csv"
plot = "press.html"
input = "bench.csv"
time-column = "t_s"
interpolation = "linear"
library = ["lib"]
external = ["valve.c"]
statistics = "stats.json"
deny-warnings = true
[set]
pump.D = "0.8 ml"
"v[3].p" = 1_000
N = 0x10
on = true
table = [[0, 1.5], [1, 2]]
[map]
F = "tau_N[N]"
pulse = { column = "pulse_V", unit = "V", interpolation = "held" }
"#;
        let (experiment, said) = read(text);
        assert_eq!(said, "");
        insta::assert_debug_snapshot!(experiment.unwrap());
    }

    #[test]
    fn mistakes_are_shown_at_their_place() {
        let texts = [
            "stop-tiem = 2\n",
            "stop_time = 2\n",
            "stop-time = \"2 m\"\n",
            "stop-time = true\n",
            "output-interval = 0\n",
            "relative-tolerance = 2\n",
            "variables = 3\n",
            "set = 3\n",
            "[set]\nd = 1979-05-27\n",
            "[map]\nF = 3\n",
            "[map]\nF = { colum = \"x\", unit = \"N\" }\n",
            "map = \"F\"\n",
            "interpolation = \"cubic\"\n",
            "file = \"a\nmodel = 3\n",
            "x = \n",
            "zzzzzz = 1\n",
        ];
        insta::assert_snapshot!(texts.map(|t| read(t).1).join(""));
    }

    #[test]
    fn a_message_for_people() {
        let mut sources = Sources::default();
        let file = sources.add("press.toml", "model = \"Press\"\nstop-tiem = 2\n");
        let text = render(&sources, &parse(&sources, file).diagnostics, DiagnosticFormat::Human, 100, false);
        insta::assert_snapshot!(text, @r"
        error[E602]: there is no key `stop-tiem`
         --> press.toml:2:1
          |
        2 | stop-tiem = 2
          | ^^^^^^^^^ unknown key
          |
          = help: did you mean `stop-time`?
        ");
    }

    proptest::proptest! {
        #[test]
        fn never_panics(text in "(?s)(set|map|stop-time|variables| |=|\\[|\\]|\\{|\\}|\"|\\.|1|a|\n|,){0,30}") {
            read(&text);
        }
    }
}
