//! Diagnostics as text: for people, with the lines concerned; one line each, for editors and tests; and as JSON.
//! The command, the editor and [`super::Error`] call these functions. Long lists are cut for people, never in JSON.

use std::fmt::Write as _;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use serde::Serialize;

use super::{Diagnostic, FileId, Label, Severity, Sources, Span};

/// The largest number of places, notes, helps or list lines shown to people for one message.
const LONGEST_LIST: usize = 10;

/// The form in which diagnostics are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiagnosticFormat {
    /// For people: with the lines concerned, several lines each.
    #[default]
    Human,
    /// For tools: one line each, `file:line:col: error[E103]: text`.
    Short,
    /// For programs: one JSON object a line.
    Json,
}

/// Writes diagnostics in the given format, in their order. Each ends with a line break.
///
/// `width` (characters a line) and `colour` (terminal escapes) apply to [`DiagnosticFormat::Human`] only.
pub fn render(
    sources: &Sources,
    diagnostics: &[Diagnostic],
    format: DiagnosticFormat,
    width: usize,
    colour: bool,
) -> String {
    let mut out = String::new();
    for diagnostic in diagnostics {
        match format {
            DiagnosticFormat::Human => {
                out.push_str(&human(sources, diagnostic, width, colour));
                out.push_str("\n\n");
            }
            DiagnosticFormat::Short => {
                out.push_str(&short(sources, diagnostic));
                out.push('\n');
            }
            DiagnosticFormat::Json => {
                out.push_str(&json(sources, diagnostic));
                out.push('\n');
            }
        }
    }
    out
}

/// The width of [`full`] in characters.
const WIDTH: usize = 100;

/// The messages as the command prints them, without colour.
pub fn full(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    render(sources, diagnostics, DiagnosticFormat::Human, WIDTH, false).trim_end().to_owned()
}

/// One line for each diagnostic, without colour. Tests and editors read it.
pub fn short_list(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    render(sources, diagnostics, DiagnosticFormat::Short, usize::MAX, false)
}

/// A summary such as `2 errors, 1 warning`. `None` if there are neither errors nor warnings.
pub fn count(diagnostics: &[Diagnostic]) -> Option<String> {
    let number = |s: Severity| diagnostics.iter().filter(|d| d.severity == s).count();
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let parts: Vec<String> = [(number(Severity::Error), "error"), (number(Severity::Warning), "warning")]
        .iter()
        .filter(|(n, _)| *n > 0)
        .map(|(n, word)| plural(*n, word))
        .collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// The severity as a word.
fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// The text with control characters made visible, except for line breaks.
/// Messages may quote names from damaged files, and such characters could change the terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// One line: place, severity, code, message. Without a label there is no place.
/// The form is that of compilers, which editors recognise: `file:line:column: error[E103]: message`.
fn short(sources: &Sources, d: &Diagnostic) -> String {
    let mut line = String::new();
    if let Some(label) = d.labels.first() {
        // Editors expect lines and columns from 1.
        let (row, column) = sources.line_column(label.span.file, label.span.start);
        let _ = write!(line, "{}:{row}:{column}: ", sources.get(label.span.file).path);
    }
    // The format has one line for each message.
    let message = printable(&d.message).replace('\n', " ");
    let _ = write!(line, "{}[{}]: {message}", severity_name(d.severity), d.code);
    line
}

/// A diagnostic in JSON. The fields are those of [`Diagnostic`]; names are part of the interface to tools.
#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    code: &'a str,
    severity: &'a str,
    message: &'a str,
    labels: Vec<JsonLabel<'a>>,
    instance: Option<&'a str>,
    class: Option<&'a str>,
    notes: &'a [String],
    help: &'a [String],
}

/// A label in JSON. Lines and columns count from 1.
#[derive(Serialize)]
struct JsonLabel<'a> {
    file: &'a str,
    line: usize,
    /// The line and column one past the last character.
    column: usize,
    end: JsonPlace,
    text: &'a str,
}

/// A place in JSON, counted from 1.
#[derive(Serialize)]
struct JsonPlace {
    line: usize,
    column: usize,
}

/// One JSON object on one line.
/// The form is stable: tools depend on it.
fn json(sources: &Sources, d: &Diagnostic) -> String {
    let object = JsonDiagnostic {
        code: d.code.id(),
        severity: severity_name(d.severity),
        message: &d.message,
        labels: d.labels.iter().map(|label| json_label(sources, label)).collect(),
        instance: d.instance.as_deref(),
        class: d.class.as_deref(),
        notes: &d.notes,
        help: &d.help,
    };
    serde_json::to_string(&object).expect("strings and numbers always serialize")
}

/// The label with its places as lines and columns.
fn json_label<'a>(sources: &'a Sources, label: &'a Label) -> JsonLabel<'a> {
    let (line, column) = sources.line_column(label.span.file, label.span.start);
    let (end_line, end_column) = sources.line_column(label.span.file, label.span.end);
    JsonLabel {
        file: &sources.get(label.span.file).path,
        line,
        column,
        end: JsonPlace { line: end_line, column: end_column },
        text: &label.text,
    }
}

/// The message with the lines concerned, as the crate `annotate_snippets` lays it out.
/// `width` is limited to 40 up to 10 000 characters.
fn human(sources: &Sources, d: &Diagnostic, width: usize, colour: bool) -> String {
    let level = match d.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = level.primary_title(printable(&d.message)).id(d.code.id()).elements(snippets(sources, &d.labels));
    for note in notes(d) {
        group = group.element(Level::NOTE.message(note));
    }
    for help in capped(&d.help) {
        group = group.element(Level::HELP.message(shortened(&help)));
    }
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let report: &[Group<'_>] = &[group];
    // ASCII decoration, because not every terminal and log shows line-drawing characters.
    let text = renderer.decor_style(DecorStyle::Ascii).term_width(width.clamp(40, 10_000)).render(report);
    if d.labels.is_empty() { without_margin(&text, colour) } else { text }
}

/// Removes margin lines from a message without a source text, where they have no meaning.
/// A coloured text is left as it is, because its escapes hide such lines.
fn without_margin(text: &str, colour: bool) -> String {
    if colour {
        return text.to_owned();
    }
    text.lines().filter(|line| line.trim() != "|").collect::<Vec<_>>().join("\n")
}

/// The notes of a message, and further ones: how many places are not shown, and which component is concerned.
/// The component is named with its class, if that is known.
fn notes(d: &Diagnostic) -> Vec<String> {
    let mut notes: Vec<String> = capped(&d.notes).iter().map(|n| shortened(n)).collect();
    let hidden = d.labels.len().saturating_sub(LONGEST_LIST);
    if hidden > 0 {
        notes.push(format!("and {hidden} more places (`--message-format json` lists all)"));
    }
    // A message that names the component already needs no note about it.
    if let Some(instance) = d.instance.as_deref().filter(|i| !i.is_empty() && !d.message.contains(i)) {
        let class = d.class.as_deref().map(|c| format!(" of class `{c}`")).unwrap_or_default();
        notes.push(printable(&format!("in component `{instance}`{class}")));
    }
    notes
}

/// The first entries of a list, and a line that says how many are left out.
fn capped(list: &[String]) -> Vec<String> {
    let mut shown: Vec<String> = list.iter().take(LONGEST_LIST).cloned().collect();
    if list.len() > LONGEST_LIST {
        shown.push(format!("and {} more (`--message-format json` lists all)", list.len() - LONGEST_LIST));
    }
    shown
}

/// A text cut to its first lines: a headline and up to [`LONGEST_LIST`] lines of a list.
fn shortened(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let text = printable(text);
    if lines.len() <= LONGEST_LIST + 2 {
        return text;
    }
    let mut shown = printable(&lines[..=LONGEST_LIST].join("\n"));
    let _ = write!(shown, "\n  and {} more (`--message-format json` lists all)", lines.len() - LONGEST_LIST - 1);
    shown
}

/// One snippet for each file with labels, the file of the primary label first.
fn snippets<'a>(sources: &'a Sources, labels: &'a [Label]) -> Vec<Snippet<'a, Annotation<'a>>> {
    let shown = &labels[..labels.len().min(LONGEST_LIST)];
    let mut files: Vec<FileId> = Vec::new();
    for label in shown {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    let primary = labels.first().map(|l| l.span.file);
    files.into_iter().map(|file| snippet(sources, file, shown, primary == Some(file))).collect()
}

/// The lines of one file that carry labels. The text is cut to these lines, so that long files cost no time.
/// With `primary`, the first label of the file is the primary one.
fn snippet<'a>(sources: &'a Sources, file: FileId, labels: &'a [Label], primary: bool) -> Snippet<'a, Annotation<'a>> {
    let text = sources.get(file).text.as_str();
    let own: Vec<&Label> = labels.iter().filter(|l| l.span.file == file).collect();
    let spans: Vec<(usize, usize)> = own.iter().map(|l| clamped(text, l.span)).collect();
    let low = spans.iter().map(|s| s.0).min().unwrap_or(0);
    let high = spans.iter().map(|s| s.1).max().unwrap_or(0);
    let from = text[..low].rfind('\n').map_or(0, |i| i + 1);
    let to = text[high..].find('\n').map_or(text.len(), |i| high + i);
    let line = text[..from].bytes().filter(|&b| b == b'\n').count() + 1;
    let mut first = primary;
    let annotations = own.iter().zip(&spans).map(move |(label, &(start, end))| {
        let kind = if std::mem::take(&mut first) { AnnotationKind::Primary } else { AnnotationKind::Context };
        let said = (!label.text.is_empty()).then(|| printable(&label.text));
        kind.span(start - from..end - from).label(said)
    });
    Snippet::source(&text[from..to]).line_start(line).path(sources.get(file).path.as_str()).annotations(annotations)
}

/// The bytes of the text that a span marks, moved to character boundaries and inside the text.
/// Of a span over several lines only the first line is marked.
fn clamped(text: &str, span: Span) -> (usize, usize) {
    let boundary = |mut at: usize| {
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = boundary((span.start as usize).min(text.len()));
    let end = boundary((span.end as usize).clamp(start, text.len()));
    let line_end = text[start..end].find('\n').map_or(end, |i| start + i);
    (start, boundary(line_end))
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
