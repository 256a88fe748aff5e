//! Models with mistakes that authors make: `tests/bad/*.mo`, each with the messages it must get.
//!
//! Lines at the top of a file say what is expected; nothing more and nothing less may be said.
//! - `//! E011 at 5: "there is no"`: code, line, and a part of the message, its places' texts, notes or help;
//!   without `at` where no place in the file is named.
//! - `//! model NAME`: the class, where it is not `M`.
//! - `//! run`: the mistake shows in a run only.
#![allow(clippy::disallowed_methods, reason = "reads its cases")]

use crate::diagnose;

use bramah::Diagnostic;
use diagnose::Report;
use std::fmt::Write;

/// One expected message.
struct Expected {
    code: String,
    line: Option<usize>,
    text: String,
}

/// What the lines at the top of a file say.
struct Case {
    expected: Vec<Expected>,
    model: String,
    run: bool,
}

fn case(name: &str, text: &str) -> Case {
    let mut case = Case { expected: Vec::new(), model: "M".into(), run: false };
    for line in text.lines().map_while(|l| l.strip_prefix("//! ")) {
        match line.split_once(' ') {
            _ if line == "run" => case.run = true,
            Some(("model", model)) => case.model = model.into(),
            _ => case.expected.push(expected(line).unwrap_or_else(|| panic!("{name}: cannot read `{line}`"))),
        }
    }
    assert!(!case.expected.is_empty(), "{name}: nothing is expected");
    case
}

/// `E011 at 5: "text"`
fn expected(line: &str) -> Option<Expected> {
    let (head, text) = line.split_once(": ")?;
    let text = text.strip_prefix('"')?.strip_suffix('"')?.to_owned();
    let (code, line) = match head.split_once(" at ") {
        Some((code, line)) => (code, Some(line.parse().ok()?)),
        None => (head, None),
    };
    Some(Expected { code: code.into(), line, text })
}

fn fits(report: &Report, d: &Diagnostic, e: &Expected) -> bool {
    let said = std::iter::once(&d.message).chain(d.labels.iter().map(|l| &l.text)).chain(&d.notes).chain(&d.help);
    d.code.id() == e.code
        && e.line.is_none_or(|line| report.place(d) == Some(line))
        && said.into_iter().any(|s| s.contains(&e.text))
}

/// What differs from the expectation, as text; empty if nothing does.
fn complaint(text: &str, case: &Case) -> String {
    let report = diagnose::report(text, Some(&case.model), case.run);
    let mut left: Vec<&Diagnostic> = report.faults().collect();
    let mut out = String::new();
    for e in &case.expected {
        match left.iter().position(|d| fits(&report, d, e)) {
            Some(i) => drop(left.remove(i)),
            None => {
                let line = e.line.map(|l| format!(" at {l}")).unwrap_or_default();
                let _ = writeln!(out, "  missing: {}{line}: {:?}", e.code, e.text);
            }
        }
    }
    for d in left {
        let line = report.place(d).map(|l| format!(" at {l}")).unwrap_or_default();
        let _ = writeln!(out, "  besides: {}{line}: {}", d.code, d.message);
        for said in d.labels.iter().map(|l| &l.text).chain(&d.notes).chain(&d.help) {
            let _ = writeln!(out, "             {said}");
        }
    }
    out
}

#[test]
fn mistakes_get_their_messages() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("the folder is there").map(|e| e.expect("readable").path()).collect();
    paths.sort();
    assert!(paths.len() >= 80, "{} cases", paths.len());
    let mut wrong = 0;
    let mut out = String::new();
    for path in &paths {
        let name = path.file_stem().expect("files have names").to_string_lossy();
        let text = std::fs::read_to_string(path).expect("readable");
        let complaint = complaint(&text, &case(&name, &text));
        if !complaint.is_empty() {
            wrong += 1;
            let _ = writeln!(out, "{name}\n{complaint}");
        }
    }
    assert!(wrong == 0, "{wrong} of {} models get other messages:\n\n{out}", paths.len());
}
