//! The diagnostics of a file: syntax errors at once, and those of all stages for each of its models.
//!
//! [`of_syntax`] only parses and answers between two keystrokes. [`of_models`] compiles each runnable model as `bramah
//! check` does and runs on the background thread. Both return diagnostics of the protocol, with quick fixes.

use super::actions::{QuickFix, correction};
use super::hints::ParameterHints;
use super::{EditorWorkspace, is_shipped, lines};
use bramah_circuit::compiled::compile;
use bramah_model::compile::{Request, runnable};
use bramah_model::resolve::{Library, names};
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::{Code, Diagnostic, FileId, Severity, Sources};
use lsp_types::{DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString, Range, Uri};
use std::path::{Path, PathBuf};

/// Models of one file that are compiled while it is edited. More would delay the answer too long.
const MOST_MODELS: usize = 12;

/// A diagnostic of a file, with the correction that it proposes.
#[derive(Clone, Debug)]
pub struct FileDiagnostic {
    /// The file that it is shown in.
    pub path: PathBuf,
    /// The diagnostic in the form of the protocol.
    pub diagnostic: lsp_types::Diagnostic,
    /// The change of the text that it proposes. `None`: it proposes none.
    pub correction: Option<QuickFix>,
}

/// The syntax errors of a text.
///
/// They have no related places.
pub fn of_syntax(path: &Path, text: &str) -> Vec<FileDiagnostic> {
    let mut sources = Sources::default();
    let file = sources.add(path.display().to_string(), text);
    let parsed = bramah_syntax::parse(file, text);
    parsed.diagnostics.iter().filter_map(|d| message(&sources, d, path, &no_link)).collect()
}

/// The diagnostics of all models in a file, of all stages.
///
/// `link` gives the URI of a file for related places. `facts` takes the parameter values of each compiled model.
/// `go_on` is asked before each model; when it returns false, the diagnostics found so far are returned.
pub fn of_models(
    texts: &EditorWorkspace<'_>,
    path: &Path,
    link: &dyn Fn(&Path) -> Option<Uri>,
    facts: &mut ParameterHints,
    go_on: &dyn Fn() -> bool,
) -> Vec<FileDiagnostic> {
    let request = Request { source: path.to_path_buf(), libraries: texts.libraries.to_vec(), ..Request::default() };
    let names = runnable(texts.world, &request).unwrap_or_default();
    let mut found: Vec<FileDiagnostic> = Vec::new();
    for name in names.into_iter().take(MOST_MODELS).map(|r| r.class) {
        if !go_on() {
            return found;
        }
        let one = Request { model: Some(name.clone()), ..request.clone() };
        // Machine code would only cost time here, as the model is not run.
        let outcome = compile(texts.world, &one, &LoweringOptions::INTERPRETED);
        if let Some(model) = &outcome.value {
            facts.learn(model);
        }
        // Whether the ports matter is looked up only when there is such a diagnostic.
        let unsure = outcome.diagnostics.iter().any(|d| hangs_on_use(d.code, ConnectorKind::Flows));
        let ports = if unsure { ports(texts, path, &name) } else { ConnectorKind::None };
        for diagnostic in outcome.diagnostics.iter().filter(|d| !hangs_on_use(d.code, ports)) {
            let Some(message) = message(&outcome.sources, diagnostic, path, link) else { continue };
            // Models of one file share components and so their diagnostics.
            let same = |m: &FileDiagnostic| m.path == message.path && m.diagnostic == message.diagnostic;
            // The user cannot change files that ship.
            if !is_shipped(&message.path) && !found.iter().any(same) {
                found.push(message);
            }
        }
    }
    found
}

/// The kind of connectors through which a class is used in others.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum ConnectorKind {
    /// The class has none: it is a complete model.
    None,
    /// Inputs and outputs.
    Signals,
    /// Connectors with flows.
    Flows,
}

/// The kind of connectors that a class has. Connectors with flows outrank signals.
///
/// `None` of the kinds is also returned when the file cannot be read or the class is not found.
fn ports(texts: &EditorWorkspace<'_>, path: &Path, name: &str) -> ConnectorKind {
    let found = texts.look(path, |view| {
        let id = view.library.find(name)?;
        let kind = |m: names::MemberComponent<'_>, library: &mut Library<'_>| {
            let class = names::type_of(library, m).filter(|c| names::is_connector(library, *c));
            class.map_or(ConnectorKind::None, |class| {
                let flows = names::members(library, class).iter().any(|m| m.component.prefix.flow);
                if flows { ConnectorKind::Flows } else { ConnectorKind::Signals }
            })
        };
        names::members(view.library, id).into_iter().map(|m| kind(m, view.library)).max()
    });
    found.flatten().unwrap_or(ConnectorKind::None)
}

/// Whether a diagnostic arises only because the ports of a component are open.
///
/// A component with ports is not complete by itself, so missing equations or start values are no mistakes there. Its
/// use in a circuit decides.
fn hangs_on_use(code: Code, ports: ConnectorKind) -> bool {
    let id = code.id();
    let structure = code == Code::OpenPort || id.starts_with("E3") || id.starts_with("E4");
    let start = matches!(code, Code::InitialUnder | Code::IndexReduction | Code::AutomaticInner | Code::NoInput);
    ports == ConnectorKind::Flows && structure || ports >= ConnectorKind::Signals && start
}

/// No URI, for diagnostics without related places.
fn no_link(_: &Path) -> Option<Uri> {
    None
}

/// Converts a diagnostic. `asked` is the file that was checked.
///
/// Notes and help texts are appended to the message, because editors show a single text. Labels other than the first
/// become related places.
fn message(
    sources: &Sources,
    d: &Diagnostic,
    asked: &Path,
    link: &dyn Fn(&Path) -> Option<Uri>,
) -> Option<FileDiagnostic> {
    // A diagnostic may point into several files. A place in the file that the user edits is preferred.
    let shown = asked.display().to_string();
    let primary = d.labels.iter().find(|l| sources.get(l.span.file).path == shown).or(d.labels.first());
    let (path, range) = match primary {
        Some(label) => {
            let source = sources.get(label.span.file);
            (PathBuf::from(&source.path), lines::range(&source.text, label.span))
        }
        // Without a place it is shown at the start of the file.
        None => (asked.to_path_buf(), Range::default()),
    };
    let mut text = d.message.clone();
    // The text of the label is often the message itself.
    if let Some(label) = primary.filter(|l| !l.text.is_empty() && !d.message.contains(&l.text)) {
        text.push_str(&format!("\n{}", label.text));
    }
    d.notes.iter().for_each(|n| text.push_str(&format!("\n{n}")));
    d.help.iter().for_each(|h| text.push_str(&format!("\nhelp: {h}")));
    let others = d.labels.iter().filter(|l| Some(l.span) != primary.map(|p| p.span));
    let related: Vec<DiagnosticRelatedInformation> = others
        .filter_map(|l| {
            related(sources, l.span.file, lines::range(&sources.get(l.span.file).text, l.span), &l.text, link)
        })
        .collect();
    Some(FileDiagnostic {
        // A fix in another file than the diagnostic cannot be offered as its quick fix.
        correction: correction(sources, d)
            .filter(|_| d.fix.as_ref().is_some_and(|f| sources.get(f.span.file).path == path.display().to_string())),
        path,
        diagnostic: lsp_types::Diagnostic {
            range,
            severity: Some(match d.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
                Severity::Note => DiagnosticSeverity::INFORMATION,
            }),
            code: Some(NumberOrString::String(d.code.id().to_owned())),
            source: Some("bramah".to_owned()),
            message: text,
            related_information: (!related.is_empty()).then_some(related),
            ..lsp_types::Diagnostic::default()
        },
    })
}

/// A further place of a diagnostic. `None`: its file has no URI.
///
/// Editors show these places below the diagnostic as links.
fn related(
    sources: &Sources,
    file: FileId,
    range: Range,
    text: &str,
    link: &dyn Fn(&Path) -> Option<Uri>,
) -> Option<DiagnosticRelatedInformation> {
    let uri = link(Path::new(&sources.get(file).path))?;
    Some(DiagnosticRelatedInformation { location: Location { uri, range }, message: text.to_owned() })
}
