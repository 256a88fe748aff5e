//! Parses the text of a study into a [`Study`].
//!
//! Each section of the file has a function of `StudyTable`; defaults of missing keys are set there. Names, columns and
//! model are not checked here but in `bind` and `load`.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::reader::{StudyEntry, StudyReader, StudyValue, number};
use super::{Amount, EffectChoice, InputColumn, ParameterEntry, RecordingFile, RecordingRole, SignalColumn, Study};
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources, Span, StageResult};

/// Keys at the top of the file.
const KEYS: &[&str] = &["version", "model", "class", "inputs", "signals", "recordings", "parameters", "effects"];
/// Keys of an entry of `[inputs]`. In this and the following lists one key is the default branch of its reader.
const INPUT_KEYS: &[&str] = &["column", "unit", "hold", "kind"];
/// Keys of an entry of `[signals]`.
const SIGNAL_KEYS: &[&str] = &["variable", "column", "unit", "sign", "full_scale", "accuracy"];
/// Keys of an entry of `[[recordings]]`.
const RECORDING_KEYS: &[&str] = &["file", "role", "time", "window", "optional", "pieces"];
/// Keys of an entry of `[parameters]`.
const PARAMETER_KEYS: &[&str] = &["sigma", "min", "max"];
/// Keys of `[effects]`.
const EFFECT_KEYS: &[&str] = &["include", "exclude", "places", "folder"];

/// Parses a study that was added to `sources`. Paths in it stay as written.
///
/// # Errors
/// [`Code::BadStudy`]: text that is not TOML, unknown keys, values of the wrong type, no signals or recordings.
pub fn parse(sources: &Sources, file: FileId) -> StageResult<Study> {
    let source = sources.get(file);
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    let mut table =
        StudyTable { reader: StudyReader::new(file), study: empty(Path::new(&source.path)), versioned: false };
    for error in errors {
        let message = format!("the text is not TOML: {}", error.message().lines().next().unwrap_or("unreadable"));
        table.reader.report(&error.span().unwrap_or(0..0), message, "here");
    }
    // Entries of a text with syntax errors would only give follow-up messages.
    if table.reader.diagnostics.is_empty() {
        for (key, value) in document.get_ref() {
            table.entry(key.get_ref(), &key.span(), value);
        }
    }
    // An entry that could not be read may be the one that seems to be missing.
    if table.reader.diagnostics.is_empty() {
        table.check_whole();
    }
    let StudyTable { reader, study, .. } = table;
    if reader.diagnostics.is_empty() {
        StageResult::new(study, Vec::new())
    } else {
        StageResult::failed(reader.diagnostics)
    }
}

/// A study without entries, in the folder of its file.
fn empty(path: &Path) -> Study {
    Study {
        folder: path.parent().unwrap_or(Path::new("")).to_owned(),
        model: None,
        class: None,
        inputs: Vec::new(),
        signals: Vec::new(),
        recordings: Vec::new(),
        parameters: Vec::new(),
        effects: EffectChoice::default(),
    }
}

/// A study while its file is read.
struct StudyTable {
    /// Collects the mistakes.
    reader: StudyReader,
    /// The entries read so far.
    study: Study,
    /// Whether the key `version` was there.
    versioned: bool,
}

impl StudyTable {
    /// Reads one key at the top.
    fn entry(&mut self, key: &str, place: &std::ops::Range<usize>, value: &StudyValue<'_>) {
        match key {
            "version" => self.version(value),
            "model" => self.study.model = self.reader.text(key, value),
            "class" => self.study.class = self.reader.text(key, value),
            "inputs" => self.inputs(value),
            "signals" => self.signals(value),
            "recordings" => self.recordings(value),
            "parameters" => self.parameters(value),
            "effects" => self.effects(value),
            _ => self.reader.unknown(key, place, KEYS),
        }
    }

    /// Checks the format version, which is 1.
    fn version(&mut self, value: &StudyValue<'_>) {
        self.versioned = true;
        if number(value.get_ref()) != Some(1.0) {
            self.reader.report(&value.span(), "the version of a study is 1", "this one is not known");
        }
    }

    /// Reports what a study must have and this one lacks.
    fn check_whole(&mut self) {
        let mut lacks = |what: &str, help: &str| {
            let place = self.reader.span(&(0..0));
            self.reader.add(Diagnostic::new(Code::BadStudy, what).at(place, "in this study").help(help));
        };
        if !self.versioned {
            lacks("the study does not say its version", "begin with `version = 1`");
        }
        if self.study.model.is_none() && self.study.class.is_none() {
            lacks("the study names no model", "add `model = \"Axis.mo\"`, or the `class` of a model that ships");
        }
        if self.study.signals.is_empty() {
            lacks("the study has no signals", "add what was measured below `[signals]`");
        }
        if self.study.recordings.is_empty() {
            lacks("the study has no recordings", "add the files below `[[recordings]]`");
        }
    }

    /// Reads `[inputs]`.
    fn inputs(&mut self, value: &StudyValue<'_>) {
        for StudyEntry { name, span, value } in self.reader.named("inputs", value) {
            let mut input = InputColumn { column: name.clone(), name, unit: None, hold: true, measured: false, span };
            self.fields(&input.name.clone(), value, INPUT_KEYS, |reader, key, value| match key {
                "column" => input.column = reader.text(key, value).unwrap_or_default(),
                "unit" => input.unit = unit(reader, key, value),
                "kind" => input.measured = is_measured(reader, key, value),
                _ => input.hold = reader.truth(key, value).unwrap_or(true),
            });
            self.study.inputs.push(input);
        }
    }

    /// Reads `[signals]`.
    fn signals(&mut self, value: &StudyValue<'_>) {
        for StudyEntry { name, span, value } in self.reader.named("signals", value) {
            let mut signal = SignalColumn {
                variable: name.clone(),
                column: name.clone(),
                name,
                unit: None,
                sign: 1.0,
                full_scale: None,
                accuracy: None,
                span,
            };
            self.fields(&signal.name.clone(), value, SIGNAL_KEYS, |reader, key, value| match key {
                "variable" => signal.variable = reader.text(key, value).unwrap_or_default(),
                "column" => signal.column = reader.text(key, value).unwrap_or_default(),
                "unit" => signal.unit = unit(reader, key, value),
                "sign" => signal.sign = sign(reader, key, value),
                "full_scale" => signal.full_scale = positive(reader, key, value),
                _ => signal.accuracy = positive(reader, key, value),
            });
            self.study.signals.push(signal);
        }
    }

    /// Reads `[[recordings]]`.
    fn recordings(&mut self, value: &StudyValue<'_>) {
        let DeValue::Array(items) = value.get_ref() else {
            self.reader.wrong_kind("recordings", value, "a list of tables: `[[recordings]]`");
            return;
        };
        for item in items {
            self.recording(item);
        }
    }

    /// Reads one table of `[[recordings]]`.
    fn recording(&mut self, item: &StudyValue<'_>) {
        let mut recording = RecordingFile {
            file: String::new(),
            role: RecordingRole::Train,
            time: None,
            window: None,
            optional: false,
            pieces: 1,
            span: self.reader.span(&item.span()),
        };
        self.fields("recordings", item, RECORDING_KEYS, |reader, key, value| match key {
            "file" => {
                recording.file = reader.text(key, value).unwrap_or_default();
                recording.span = reader.span(&value.span());
            }
            "role" => recording.role = role(reader, key, value),
            "time" => recording.time = reader.text(key, value),
            "window" => recording.window = window(reader, key, value),
            "pieces" => recording.pieces = pieces(reader, key, value),
            _ => recording.optional = reader.truth(key, value).unwrap_or(false),
        });
        // An item that is no table was reported by `fields` already.
        if recording.file.is_empty() && item.get_ref().is_table() {
            self.reader.report(&item.span(), "a recording without `file`", "this one");
        }
        if recording.pieces > 1 && recording.role == RecordingRole::Held {
            self.reader.report(&item.span(), "a held recording is judged by one run: it has no `pieces`", "this one");
        }
        self.study.recordings.push(recording);
    }

    /// Reads `[parameters]`.
    fn parameters(&mut self, value: &StudyValue<'_>) {
        for StudyEntry { name, span, value } in self.reader.named("parameters", value) {
            let mut entry = ParameterEntry { name, exact: false, sigma: None, min: None, max: None, span };
            if value.get_ref().as_str() == Some("exact") {
                entry.exact = true;
            } else if value.get_ref().is_table() {
                self.fields("parameters", value, PARAMETER_KEYS, |reader, key, value| match key {
                    "sigma" => entry.sigma = positive(reader, key, value),
                    "min" => entry.min = bound(reader, key, value),
                    _ => entry.max = bound(reader, key, value),
                });
            } else {
                let message = format!("`{}` is `\"exact\"` or a table", entry.name);
                let found = value.get_ref().type_str();
                let d = Diagnostic::new(Code::BadStudy, message)
                    .at(self.reader.span(&value.span()), format!("this is a value of type {found}"))
                    .help("write `{ sigma = \"3 %\" }`, `{ min = 0.0, max = 1.0 }` or `\"exact\"`");
                self.reader.add(d);
            }
            self.study.parameters.push(entry);
        }
    }

    /// Reads `[effects]`.
    fn effects(&mut self, value: &StudyValue<'_>) {
        let mut effects = EffectChoice::default();
        self.fields("effects", value, EFFECT_KEYS, |reader, key, value| match key {
            "include" => effects.include = reader.list(key, value),
            "exclude" => effects.exclude = reader.list(key, value),
            "places" => effects.places = reader.list(key, value),
            _ => effects.folder = reader.text(key, value),
        });
        self.study.effects = effects;
    }

    /// Passes each entry with a known key to `take`, and reports the others. `name` is that of the table, for messages.
    fn fields(
        &mut self,
        name: &str,
        value: &StudyValue<'_>,
        known: &[&str],
        mut take: impl FnMut(&mut StudyReader, &str, &StudyValue<'_>),
    ) {
        let Some(table) = self.reader.table(name, value) else { return };
        for (key, value) in table {
            if known.contains(&key.get_ref().as_ref()) {
                take(&mut self.reader, key.get_ref(), value);
            } else {
                self.reader.unknown(key.get_ref(), &key.span(), known);
            }
        }
    }
}

/// A unit string, checked for its syntax.
fn unit(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> Option<String> {
    let text = reader.text(key, value)?;
    match bramah_expr::units::MeasurementUnit::parse(&text) {
        Ok(_) => Some(text),
        Err(why) => {
            reader.report(&value.span(), why.to_string(), "this unit");
            None
        }
    }
}

/// 1 or -1.
fn sign(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> f64 {
    match number(value.get_ref()) {
        Some(x) if x.abs() == 1.0 => x,
        _ => {
            reader.wrong_kind(key, value, "1 or -1");
            1.0
        }
    }
}

/// The key `kind` of an input: true for `"measured"`.
fn is_measured(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> bool {
    match value.get_ref().as_str() {
        Some("command") => false,
        Some("measured") => true,
        _ => {
            reader.report(&value.span(), format!("`{key}` is `\"command\"` or `\"measured\"`"), "this is neither");
            false
        }
    }
}

/// The key `role` of a recording.
fn role(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> RecordingRole {
    match value.get_ref().as_str() {
        Some("train") => RecordingRole::Train,
        Some("held") => RecordingRole::Held,
        _ => {
            reader.report(&value.span(), format!("`{key}` is `\"train\"` or `\"held\"`"), "this is neither");
            RecordingRole::Train
        }
    }
}

/// The key `window` of a recording: two ascending times in seconds.
fn window(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> Option<(f64, f64)> {
    let ends: Option<Vec<f64>> =
        value.get_ref().as_array().and_then(|a| a.iter().map(|v| number(v.get_ref())).collect());
    match ends.as_deref() {
        Some(&[from, to]) if from < to => Some((from, to)),
        _ => {
            reader.wrong_kind(key, value, "two growing times in seconds: `[0.0, 4.0]`");
            None
        }
    }
}

/// The key `pieces` of a recording, from 1 to 1000.
fn pieces(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> usize {
    match number(value.get_ref()) {
        Some(x) if (1.0..=1000.0).contains(&x) && x.fract() == 0.0 => x as usize,
        _ => {
            reader.wrong_kind(key, value, "a whole number from 1 to 1000");
            1
        }
    }
}

/// An amount, written as a text or as a plain number.
fn amount(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> Option<Amount> {
    if let Some(text) = value.get_ref().as_str() {
        return Amount::parse(text).map_err(|why| reader.report(&value.span(), why, format!("value of `{key}`"))).ok();
    }
    reader.number(key, value).map(|x| Amount::Value(x, None))
}

/// An amount above zero.
fn positive(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> Option<Amount> {
    let amount = amount(reader, key, value)?;
    if amount.number() > 0.0 {
        return Some(amount);
    }
    reader.report(&value.span(), format!("`{key}` must be positive"), "this is not");
    None
}

/// A bound of a parameter: an amount that is no percentage.
fn bound(reader: &mut StudyReader, key: &str, value: &StudyValue<'_>) -> Option<Amount> {
    let amount = amount(reader, key, value)?;
    if matches!(amount, Amount::Part(_)) {
        reader.report(&value.span(), format!("`{key}` is a value, not a part"), "a percentage");
        return None;
    }
    Some(amount)
}

/// A place in the text of a study, for messages of later stages.
pub(super) fn at(span: Span, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
    Diagnostic::new(Code::BadStudy, message).at(span, label)
}
