//! Messages of all stages put together: sorted, each said once, and shortened for the texts of libraries.
//!
//! `compile::with_class` calls most of these functions on the list of all diagnostics; callers of the pipeline sort the
//! list with [`sort_messages`] before they print it. Only [`other_versions`] makes new diagnostics.

use super::Request;
use crate::resolve::Library;
use bramah_syntax::ast;
use bramah_syntax::diag::{Code, Diagnostic, Sources, Span};
use std::path::Path;

/// Sorts messages by file and place; messages without a place come first. Stable, so messages of one place keep their
/// order.
pub fn sort_messages(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|d| d.labels.first().map(|l| (l.span.file, l.span.start)));
}

/// Drops repeated messages: those with the same code and the same places.
///
/// One mistake in a class shows in each of its instances, and one message is enough. Two open ports of one component
/// differ in the second place, so both stay.
/// Messages without a place all stay.
pub(super) fn once(diagnostics: &mut Vec<Diagnostic>) {
    let mut seen = rustc_hash::FxHashSet::default();
    diagnostics.retain(|d| {
        // The instance is no part of the key: all instances of a class share the places.
        let places: Vec<Span> = d.labels.iter().map(|l| l.span).collect();
        places.is_empty() || seen.insert((d.code, places))
    });
}

/// Keeps the first message about each missing class, with a note that counts the others. A missing class is reported
/// wherever it is named.
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

/// Keeps the messages for which `keep` is true, given their positions in the list.
fn retain_indexed(diagnostics: &mut Vec<Diagnostic>, keep: impl Fn(usize, &Diagnostic) -> bool) {
    let mut next = 0..;
    diagnostics.retain(|d| next.next().is_some_and(|i| keep(i, d)));
}

/// Shortens what is said about the texts of libraries. Warnings there are for those who write them, so they are
/// dropped. Of several errors the first one stays, with a note that counts the others: these are in classes that are
/// not the user's, or follow from the first one.
///
/// A text belongs to a library if its file is in one of the folders of `Request::libraries`; shipped classes are not
/// meant.
pub(super) fn of_libraries(diagnostics: &mut Vec<Diagnostic>, sources: &Sources, request: &Request) {
    let of_library = |span: Span| {
        let file = Path::new(sources.get(span.file).path.as_str());
        request.libraries.iter().any(|folder| file.starts_with(folder))
    };
    let foreign = |d: &Diagnostic| d.labels.first().is_some_and(|l| of_library(l.span));
    // A warning with a place in the user's text as well concerns the user.
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

/// Messages about libraries of other versions than the user's classes use, as in `uses(Modelica(version = "3.2.3"))`,
/// unless the library says that nothing has to be converted from that version (MLS 18.8).
/// The code is W028.
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

/// The arguments inside each `name(...)` of an annotation.
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

/// The texts of each `name = "..."` in an annotation.
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
