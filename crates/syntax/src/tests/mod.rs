//! Tests of the parser: texts that are Modelica, texts that are not, and random ones.

#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "reads models that lie beside the project")]

mod bad;
mod format;
mod fuzz;
mod good;
mod limits;

use super::{ParseOutput, parse};
use crate::diag::{Diagnostic, FileId, Sources};
use std::fmt::{Debug, Write};
use std::path::PathBuf;

/// The file of all test texts.
pub const FILE: FileId = FileId(0);

/// Reads a text.
pub fn read(text: &str) -> ParseOutput {
    parse(FILE, text)
}

/// The messages about a text, one line each: code, place, words there, message, then further places and help.
pub fn messages(text: &str) -> String {
    let mut sources = Sources::default();
    sources.add("text", text);
    read(text).diagnostics.iter().map(|diagnostic| message(&sources, diagnostic)).collect()
}

fn message(sources: &Sources, diagnostic: &Diagnostic) -> String {
    let mut out = format!("{} ", diagnostic.code);
    for (i, label) in diagnostic.labels.iter().enumerate() {
        let (line, column) = sources.line_column(FILE, label.span.start);
        let place = format!("{line}:{column} `{}`", sources.text(label.span));
        match i {
            0 => writeln!(out, "{place} {}", diagnostic.message),
            _ => writeln!(out, "     {place} {}", label.text),
        }
        .expect("writing to a string succeeds");
    }
    for help in &diagnostic.help {
        writeln!(out, "     help: {help}").expect("writing to a string succeeds");
    }
    out
}

/// A tree as text without its places, to compare two trees.
pub fn without_places(tree: &impl Debug) -> String {
    let debug = format!("{tree:?}");
    let mut pieces = debug.split("Span { ");
    let mut out = pieces.next().unwrap_or("").to_owned();
    for piece in pieces {
        out.push_str(piece.split_once('}').map_or(piece, |(_, rest)| rest));
    }
    out
}

/// All models of the neighbouring folder with reference material; empty where there is none.
pub fn shared_models() -> Vec<PathBuf> {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = ["../shared", "../../shared"].map(|up| here.join(up));
    let Some(root) = shared.iter().find(|root| root.is_dir()) else { return Vec::new() };
    let mut models = Vec::new();
    let mut folders = vec![root.join("conformance"), root.join("bench")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "mo") {
                models.push(path);
            }
        }
    }
    models.sort();
    models
}

#[test]
fn shared_models_are_read_and_printed() {
    let models = shared_models();
    if models.is_empty() {
        println!("skipped: no folder with reference models");
    }
    for path in models {
        let text = std::fs::read_to_string(&path).expect("the file was just listed");
        assert_eq!(messages(&text), "", "{}", path.display());
        good::check_round_trip(&text);
    }
}
