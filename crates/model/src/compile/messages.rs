//! Messages of all stages put together: in order, each said once, and what concerns the texts of libraries.

use super::Request;
use crate::resolve::Library;
use bramah_syntax::ast;
use bramah_syntax::diag::{Code, Diagnostic, Sources, Span};
use std::path::Path;

/// Errors first shown where they stand: by file and place, messages without a place first.
pub fn sort_messages(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|d| d.labels.first().map(|l| (l.span.file, l.span.start)));
}

/// One mistake in a class shows in each of its instances: one message is enough where all places are the same. Two open
/// ports of one component differ in the second place.
pub(super) fn once(diagnostics: &mut Vec<Diagnostic>) {
    let mut seen = rustc_hash::FxHashSet::default();
    diagnostics.retain(|d| {
        let places: Vec<Span> = d.labels.iter().map(|l| l.span).collect();
        places.is_empty() || seen.insert((d.code, places))
    });
}

/// A class that is not there is named wherever it is asked for: the first place stands for all.
pub(super) fn missing_once(diagnostics: &mut Vec<Diagnostic>) {
    let mut first: Vec<(usize, usize)> = Vec::new();
    for (i, d) in diagnostics.iter().enumerate().filter(|(_, d)| d.code == Code::UnknownClass) {
        match first.iter_mut().find(|(f, _)| diagnostics[*f].message == d.message) {
            Some((_, more)) => *more += 1,
            None => first.push((i, 0)),
        }
    }
    for &(i, more) in first.iter().filter(|(_, more)| *more > 0) {
        let places = if more == 1 { "place" } else { "places" };
        diagnostics[i].notes.push(format!("the same at {more} more {places}"));
    }
    retain_indexed(diagnostics, |i, d| d.code != Code::UnknownClass || first.iter().any(|(f, _)| *f == i));
}

/// Keeps what passes a test of its place in the list.
fn retain_indexed(diagnostics: &mut Vec<Diagnostic>, keep: impl Fn(usize, &Diagnostic) -> bool) {
    let mut next = 0..;
    diagnostics.retain(|d| next.next().is_some_and(|i| keep(i, d)));
}

/// What is said of the texts of libraries: warnings there are for those who write them, and of several errors the first one
/// stands for all, for the others are elsewhere in a class that is not the user's or follow from it.
pub(super) fn of_libraries(diagnostics: &mut Vec<Diagnostic>, sources: &Sources, request: &Request) {
    let of_library = |span: Span| {
        let file = Path::new(sources.get(span.file).path.as_str());
        request.libraries.iter().any(|folder| file.starts_with(folder))
    };
    let foreign = |d: &Diagnostic| d.labels.first().is_some_and(|l| of_library(l.span));
    // a place in the user's text as well makes a warning the user's
    diagnostics.retain(|d| d.is_error() || d.labels.is_empty() || !d.labels.iter().all(|l| of_library(l.span)));
    let mut errors = diagnostics.iter().enumerate().filter(|(_, d)| d.is_error() && foreign(d)).map(|(i, _)| i);
    let (Some(first), rest) = (errors.next(), errors.count()) else { return };
    if rest == 0 {
        return;
    }
    let plural = if rest == 1 { "error" } else { "errors" };
    diagnostics[first].notes.push(format!("{rest} more {plural} in the texts of libraries"));
    retain_indexed(diagnostics, |i, d| i <= first || !(d.is_error() && foreign(d)));
}

/// Libraries of other versions than the user's classes say they use, `uses(Modelica(version = "3.2.3"))`, unless the library
/// says that nothing has to be converted (MLS 18.8).
pub(super) fn other_versions(library: &mut Library<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for id in library.own.clone() {
        let class = library.class(id);
        for used in class.annotation.iter().flat_map(|a| inner(&a.arguments, "uses")) {
            let ast::ModificationArgumentKind::Modify { path, modification: Some(m), .. } = &used.kind else {
                continue;
            };
            let Some(wanted) = texts(m.arguments.iter(), "version").next() else { continue };
            let name = path.parts[0].name;
            let Some(annotation) = library.loaded(name).and_then(|c| library.class(c).annotation.as_ref()) else {
                continue;
            };
            let Some(have) = texts(annotation.arguments.iter(), "version").next() else { continue };
            let mut free = texts(inner(&annotation.arguments, "conversion"), "noneFromVersion");
            if have == wanted || free.any(|v| v == wanted) {
                continue;
            }
            let text = format!("`{}` uses `{name}` {wanted}, and {have} is loaded", class.name.name);
            let d = Diagnostic::new(Code::OtherVersion, text).at(used.span, format!("written for {wanted}"));
            found.push(d.help(format!("give the folder of `{name}` {wanted} with `--library`, or convert the model")));
        }
    }
    found
}

/// The arguments inside `name(...)` of an annotation.
fn inner<'a>(
    arguments: &'a [ast::ModificationArgument],
    name: &'static str,
) -> impl Iterator<Item = &'a ast::ModificationArgument> {
    arguments
        .iter()
        .filter_map(move |a| match &a.kind {
            ast::ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == name => {
                Some(&m.arguments)
            }
            _ => None,
        })
        .flatten()
}

/// The texts of `name = "..."` in an annotation.
fn texts<'a>(
    arguments: impl Iterator<Item = &'a ast::ModificationArgument>,
    name: &'static str,
) -> impl Iterator<Item = &'a str> {
    arguments.filter_map(move |a| match &a.kind {
        ast::ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == name => {
            match &m.value.as_ref()?.kind {
                ast::ExprKind::String(text) => Some(&**text),
                _ => None,
            }
        }
        _ => None,
    })
}
