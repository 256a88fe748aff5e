//! The rules of ARCHITECTURE.md that a text can show: who uses whom, who touches files, where `unsafe` stands.
#![allow(clippy::disallowed_methods, reason = "reads the project's own text")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What each part may use of the others, in the order of the stages: nothing uses what comes later. `cli` stands above all
/// and may use everything.
const MAY_USE: &[(&str, &[&str])] = &[
    ("diag", &[]),
    ("world", &[]),
    ("shipped", &["world"]),
    ("syntax", &["diag"]),
    ("resolve", &["diag", "syntax", "world"]),
    ("expr", &["diag", "syntax"]),
    ("types", &["expr"]),
    ("units", &["expr"]),
    ("external", &["expr", "units", "world"]),
    ("results", &["diag", "units"]),
    ("instance", &["diag", "expr", "external", "resolve", "results", "syntax", "types", "units"]),
    ("network", &["diag", "instance", "syntax", "types", "units"]),
    ("flat", &["diag", "expr", "instance", "network", "syntax", "types", "units"]),
    ("unit_check", &["diag", "expr", "flat", "units"]),
    ("structure", &["diag", "expr", "flat"]),
    ("lower", &["diag", "expr", "flat", "structure"]),
    ("solve", &["diag", "expr", "flat", "lower", "results", "structure"]),
    (
        "compile",
        &[
            "diag",
            "expr",
            "flat",
            "instance",
            "lower",
            "network",
            "resolve",
            "shipped",
            "structure",
            "syntax",
            "unit_check",
            "world",
        ],
    ),
    (
        "circuit",
        &["compile", "diag", "expr", "flat", "instance", "lower", "results", "solve", "structure", "units", "world"],
    ),
    ("plot", &["network", "results", "units"]),
    ("fmi", &["circuit", "compile", "instance", "plot", "results", "units", "world"]),
    ("experiment", &["diag", "results", "units"]),
    ("study", &["compile", "diag", "expr", "flat", "results", "solve", "units", "world"]),
    ("estimate", &[]),
    (
        "analysis",
        &[
            "circuit",
            "compile",
            "diag",
            "estimate",
            "experiment",
            "expr",
            "flat",
            "lower",
            "network",
            "plot",
            "results",
            "solve",
            "structure",
            "study",
            "units",
            "world",
        ],
    ),
    (
        "gap",
        &[
            "analysis",
            "compile",
            "diag",
            "estimate",
            "expr",
            "flat",
            "instance",
            "lower",
            "network",
            "plot",
            "results",
            "shipped",
            "solve",
            "structure",
            "study",
            "syntax",
            "units",
            "world",
        ],
    ),
    (
        "editor",
        &["compile", "diag", "expr", "lower", "resolve", "results", "shipped", "syntax", "types", "units", "world"],
    ),
];

/// The one file besides `cli` that reads a clock, for the statistics of a run.
const CLOCK: &str = "solve/driver.rs";

/// The files besides `cli` that touch the disk: the world of this machine, and folders for libraries to be loaded from.
const DISK: [&str; 3] = ["world/compiler.rs", "world/disk.rs", "world/folder.rs"];

/// The one file besides `cli` that runs another program.
const COMPILER: &str = "world/compiler.rs";

/// The files that talk to C and to machine code.
const UNSAFE: [&str; 7] = [
    "solve/ida.rs",
    "solve/ida/context.rs",
    "solve/ida/operations.rs",
    "solve/ida/sensitivity.rs",
    "lower/native.rs",
    "external/c/native.rs",
    "external/mockup/native.rs",
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Files below a folder, by their path from `src/`, without their tests and comments.
fn files() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![source()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("readable").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(source()).expect("below src").to_string_lossy().replace('\\', "/");
                if !name.contains("tests") {
                    found.insert(name, code(&std::fs::read_to_string(&path).expect("a text")));
                }
            }
        }
    }
    assert!(found.len() > 100, "{} files", found.len());
    found
}

/// Without comments, and without the tests at the end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap_or(text);
    text.lines().filter(|line| !line.trim_start().starts_with("//")).fold(String::new(), |out, line| out + line + "\n")
}

/// The part of the house that a file belongs to: `flat/mod.rs` to `flat`, `types.rs` to `types`.
fn part(file: &str) -> &str {
    file.split(['/', '.']).next().unwrap_or(file)
}

/// The names behind `crate::`, also those of a list in braces.
fn used(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for rest in text.split("crate::").skip(1) {
        let list = rest.strip_prefix('{').and_then(|r| r.split('}').next());
        let names = list.map_or_else(|| vec![rest], |l| l.split(',').collect());
        for name in names {
            let name = name.trim_start();
            let end = name.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(name.len());
            found.push(&name[..end]);
        }
    }
    found.retain(|name| !name.is_empty());
    found
}

#[test]
fn nothing_uses_a_later_stage() {
    for (i, (part, may_use)) in MAY_USE.iter().enumerate() {
        for used in *may_use {
            let at = MAY_USE.iter().position(|(p, _)| p == used);
            assert!(at.is_some_and(|at| at < i), "`{part}` uses `{used}`, which does not come before it");
        }
    }
}

#[test]
fn each_part_uses_only_what_lies_before_it() {
    let parts: Vec<&str> = MAY_USE.iter().map(|(name, _)| *name).chain(["cli"]).collect();
    let mut wrong = Vec::new();
    for (file, text) in files() {
        let own = part(&file);
        let Some((_, allowed)) = MAY_USE.iter().find(|(name, _)| *name == own) else { continue };
        for name in used(&text) {
            if name != own && parts.contains(&name) && !allowed.contains(&name) {
                wrong.push(format!("{file} uses {name}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_part_is_named_and_every_name_a_part() {
    let files = files();
    let mut found: Vec<&str> = files.keys().map(|f| part(f)).filter(|p| !["lib", "main", "cli"].contains(p)).collect();
    found.dedup();
    let mut named: Vec<&str> = MAY_USE.iter().map(|(name, _)| *name).collect();
    named.sort_unstable();
    assert_eq!(found, named);
    let text = std::fs::read_to_string(source().join("../ARCHITECTURE.md")).expect("it is there");
    for name in found.into_iter().chain(["cli"]) {
        assert!(text.contains(&format!("src/{name}")), "ARCHITECTURE.md does not name src/{name}");
    }
}

#[test]
fn files_clock_and_environment_belong_to_the_command() {
    let doors = ["std::fs", "std::env", "std::process", "Instant::now", "SystemTime", "File::open", "println!"];
    for (file, text) in files() {
        if part(&file) == "cli" || file == "main.rs" {
            continue;
        }
        // what the machine is, is no part of its environment
        let text = text.replace("std::env::consts", "");
        for door in doors {
            let allowed = match door {
                "Instant::now" => file == CLOCK,
                "std::fs" => DISK.contains(&file.as_str()),
                "std::process" => file == COMPILER,
                _ => false,
            };
            assert!(!text.contains(door) || allowed, "{file} uses {door}");
        }
    }
}

#[test]
fn unsafe_stands_where_c_and_machine_code_begin() {
    for (file, text) in files() {
        let has = text.contains("unsafe {") || text.contains("unsafe fn") || text.contains("unsafe impl");
        assert!(!has || UNSAFE.contains(&file.as_str()), "{file} holds unsafe code");
    }
}

#[test]
fn long_functions_and_files_stay_rare() {
    let files = files();
    let lines: Vec<usize> = files.values().map(|t| t.lines().count()).collect();
    let long = lines.iter().filter(|&&n| n > 600).count();
    assert!(long * 10 <= lines.len(), "{long} of {} files have more than 600 lines", lines.len());
}
