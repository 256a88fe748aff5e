//! The pages behind the diagnostic codes: every code has one, and its examples do what it says.
//!
//! A page's first `modelica` block must get its code, and no error beside it; the second is its healthy look-alike.
#![allow(clippy::disallowed_methods, reason = "reads the pages")]

use crate::diagnose;

use bramah::internals::diag::{Code, Severity};
use std::fmt::Write;

/// Codes found in a run only.
const FOUND_IN_RUNS: [&str; 10] = ["E403", "E501", "E502", "E503", "E504", "W505", "E506", "E509", "W510", "W511"];

fn page(code: Code) -> String {
    let path = format!("{}/docs/errors/{}.md", env!("CARGO_MANIFEST_DIR"), code.id());
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The texts between "```modelica" and "```".
fn examples(page: &str) -> Vec<&str> {
    page.split("```modelica\n").skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

#[test]
fn every_code_has_a_page_and_every_page_a_code() {
    for &code in Code::ALL {
        let title = format!("# {}: {}\n", code.id(), code.title());
        assert!(page(code).starts_with(&title), "{}.md does not begin with `{title}`", code.id());
        assert!(page(code).contains("\n## What to do\n"), "{}.md gives no advice", code.id());
    }
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/errors")).expect("the folder is there");
    assert_eq!(folder.count(), Code::ALL.len() + 1, "a page for each code, and the README");
}

/// What is said about an example that should not be said; notes do not count unless wanted.
fn complaint(code: Code, text: &str, healthy: bool) -> Option<String> {
    let model = text.contains("model M\n").then_some("M");
    let report = diagnose::report(text, model, FOUND_IN_RUNS.contains(&code.id()));
    let mut said: Vec<_> = report.diagnostics.iter().filter(|d| d.severity > Severity::Note).collect();
    if healthy {
        said.extend(report.diagnostics.iter().filter(|d| d.code == code && !d.is_error()));
    } else if report.diagnostics.iter().any(|d| d.code == code) {
        said.retain(|d| d.code != code);
    } else {
        return Some(format!("{code} is not reported, but {:?}", said.iter().map(|d| &d.message).collect::<Vec<_>>()));
    }
    let texts: Vec<String> = said.iter().map(|d| format!("{}: {}", d.code, d.message)).collect();
    (!texts.is_empty()).then(|| format!("{code} {} gets {texts:?}", if healthy { "healthy" } else { "example" }))
}

#[test]
fn examples_do_what_their_page_says() {
    let mut out = String::new();
    for &code in Code::ALL {
        for (number, example) in examples(&page(code)).into_iter().enumerate() {
            if let Some(complaint) = complaint(code, example, number > 0) {
                let _ = writeln!(out, "{complaint}");
            }
        }
    }
    assert!(out.is_empty(), "{out}");
}
