//! The rules of ARCHITECTURE.md that a text can show: who uses whom, who touches files, where `unsafe` stands.
#![allow(clippy::disallowed_methods, reason = "reads the project's own text")]

use std::collections::BTreeMap;
use std::path::Path;

/// The modules of each crate with several stages, in their order: none uses a later one. Between crates the compiler sees
/// to it.
const ORDER: &[(&str, &[&str])] = &[
    ("syntax", &["diag", "world"]),
    ("expr", &["types", "units"]),
    ("model", &["resolve", "shipped", "instance", "network", "flat", "unit_check", "structure", "compile"]),
    ("analysis", &["experiment", "study"]),
];

/// Modules that use nothing else of their crate.
const STAND_ALONE: [(&str, &str); 5] =
    [("syntax", "diag"), ("syntax", "world"), ("solve", "lower"), ("analysis", "estimate"), ("analysis", "experiment")];

/// The one file besides `cli` that reads a clock, for the statistics of a run.
const CLOCK: &str = "solve/driver.rs";

/// The files besides `cli` that touch the disk: the world of this machine, and folders for libraries to be loaded from.
const DISK: [&str; 3] = ["syntax/world/compiler.rs", "syntax/world/disk.rs", "syntax/world/folder.rs"];

/// The one file besides `cli` that runs another program.
const COMPILER: &str = "syntax/world/compiler.rs";

/// The files that talk to C and to machine code.
const UNSAFE: [&str; 7] = [
    "solve/ida.rs",
    "solve/ida/context.rs",
    "solve/ida/operations.rs",
    "solve/ida/sensitivity.rs",
    "solve/lower/native.rs",
    "external/c/native.rs",
    "external/mockup/native.rs",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The crates below the front, by their folders' names.
fn crates() -> Vec<String> {
    let folders = std::fs::read_dir(root().join("crates")).expect("readable").flatten();
    let mut found: Vec<String> = folders.map(|f| f.file_name().to_string_lossy().into_owned()).collect();
    found.sort();
    found
}

/// All files of the crates and the front without their tests and comments: `solve/lower/native.rs` for a file of a crate,
/// `cli/mod.rs` for one of the front.
fn files() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let below = crates().into_iter().map(|c| (root().join("crates").join(&c).join("src"), format!("{c}/")));
    for (source, prefix) in below.chain([(root().join("src"), String::new())]) {
        read(&source, &source, &prefix, &mut found);
    }
    assert!(found.len() > 100, "{} files", found.len());
    found
}

fn read(folder: &Path, source: &Path, prefix: &str, found: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).expect("readable").flatten() {
        let path = entry.path();
        let below = path.strip_prefix(source).expect("below src").to_string_lossy().replace('\\', "/");
        if path.is_dir() {
            read(&path, source, prefix, found);
        } else if path.extension().is_some_and(|e| e == "rs") && !below.contains("tests") {
            found.insert(format!("{prefix}{below}"), code(&std::fs::read_to_string(&path).expect("a text")));
        }
    }
}

/// Without comments, and without the tests at the end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap_or(text);
    text.lines().filter(|line| !line.trim_start().starts_with("//")).fold(String::new(), |out, line| out + line + "\n")
}

/// The module of a crate that a file belongs to: `model/flat/mod.rs` to `flat`.
fn module(file: &str) -> &str {
    file.split(['/', '.']).nth(1).unwrap_or(file)
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
fn nothing_uses_a_later_stage_of_its_crate() {
    let files = files();
    let mut wrong = Vec::new();
    for (crate_name, order) in ORDER {
        let place = |name: &str| order.iter().position(|m| *m == name);
        for module in *order {
            let there = |f: &&str| f.starts_with(&format!("{crate_name}/{module}"));
            assert!(files.keys().map(String::as_str).any(|f| there(&f)), "{crate_name} has no `{module}`");
        }
        for (file, text) in files.iter().filter(|(f, _)| f.starts_with(&format!("{crate_name}/"))) {
            let Some(own) = place(module(file)) else { continue };
            let later = used(text).into_iter().filter(|name| place(name).is_some_and(|at| at > own));
            wrong.extend(later.map(|name| format!("{file} uses {name}")));
        }
    }
    for (crate_name, module) in STAND_ALONE {
        let own = |file: &String| file.starts_with(&format!("{crate_name}/{module}"));
        assert!(files.keys().any(own), "{crate_name} has no `{module}`");
        for (file, text) in files.iter().filter(|(f, _)| own(f)) {
            wrong.extend(used(text).into_iter().filter(|n| *n != module).map(|n| format!("{file} uses {n}")));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_crate_is_on_the_map() {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("it is there");
    for name in crates() {
        assert!(text.contains(&format!("crates/{name}")), "ARCHITECTURE.md does not name crates/{name}");
    }
}

#[test]
fn files_clock_and_environment_belong_to_the_command() {
    let doors = ["std::fs", "std::env", "std::process", "Instant::now", "SystemTime", "File::open", "println!"];
    for (file, text) in files() {
        if file.starts_with("cli/") || file == "main.rs" {
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
