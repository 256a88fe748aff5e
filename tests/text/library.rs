//! Every class of `components/` and `models/` that can run passes all checks without a word.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::disk;

use bramah::Request;
use bramah::internals::compile::{flatten, flatten_text};
use bramah::internals::diag::render::{DiagnosticFormat, render};
use bramah::internals::resolve::{Library, SyntaxArena, nested_classes};
use bramah::internals::syntax::ast::ClassKind;
use bramah::world::World;
use disk::Disk;
use std::path::{Path, PathBuf};

fn mo_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for (name, is_folder) in Disk.list(folder).expect("the folder is there") {
        let path = folder.join(&name);
        if is_folder {
            mo_files(&path, out);
        } else if name.ends_with(".mo") {
            out.push(path);
        }
    }
}

/// The dotted name of a file below one of the roots.
fn dotted(root: &Path, file: &Path) -> String {
    let rest = file.strip_prefix(root).expect("below the root").with_extension("");
    rest.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join(".")
}

/// What the whole front half and the structure say about a class; empty if nothing.
fn remarks(request: &Request) -> String {
    let outcome = flatten(&Disk, request);
    let mut diagnostics = outcome.diagnostics;
    if let Some(value) = &outcome.value {
        diagnostics.extend(bramah::internals::unit_check::check(&value.flat));
        bramah::internals::structure::analyze(&value.flat, &Default::default()).sink(&mut diagnostics);
    }
    render(&outcome.sources, &diagnostics, DiagnosticFormat::Short, 200, false)
}

#[test]
fn every_model_and_example_is_silent() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut bad = Vec::new();
    let mut tried = 0;
    for folder in ["components", "models"] {
        let mut files = Vec::new();
        mo_files(&root.join(folder), &mut files);
        for file in files {
            let name = dotted(&root.join(folder), &file);
            let text = Disk.read(&file).expect("a text");
            if !text.contains("experiment(") || text.contains("partial model") {
                continue;
            }
            let single = folder == "models" && !name.contains('.') || name.starts_with("stiff.");
            let request = Request {
                source: if single { file } else { PathBuf::from(&name) },
                model: None,
                overrides: vec![],
                libraries: vec![],
                beside: vec![],
                ..Request::default()
            };
            tried += 1;
            let said = remarks(&request);
            // A model in a file of its own hides the shipped one, and one example declares no oil on purpose.
            let said: Vec<&str> = said.lines().filter(|l| !l.contains("[N026]") && !l.contains("[N025]")).collect();
            if !said.is_empty() {
                bad.push(format!("{name}\n{}", said.join("\n")));
            }
        }
    }
    assert!(tried > 150, "only {tried} classes were found");
    assert!(bad.is_empty(), "{}", bad.join("\n\n"));
}

/// The nominal models of the blind bench that stand beside its generator.
#[test]
fn nominal_models_of_the_blind_bench_are_silent() {
    let mut files = Vec::new();
    mo_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/blind/nominal"), &mut files);
    assert!(!files.is_empty());
    for file in files {
        let model = file.file_stem().map(|s| s.to_string_lossy().into_owned());
        let request = Request { source: file, model, ..Request::default() };
        assert_eq!(remarks(&request), "");
    }
}

/// One class a file, and the folder's order lists every file.
#[test]
fn every_file_is_listed_and_holds_the_class_of_its_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("components");
    let mut files = Vec::new();
    mo_files(&root, &mut files);
    for file in files {
        let stem = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let folder = file.parent().expect("a folder");
        if stem == "package" || folder == root {
            continue;
        }
        let order = Disk.read(&folder.join("package.order")).unwrap_or_default();
        assert!(order.lines().any(|l| l == stem), "{stem} is missing in {}", folder.display());
        let text = Disk.read(&file).expect("a text");
        assert!(text.contains(&format!("end {stem};")) || text.contains(&format!("{stem} = ")), "{}", file.display());
    }
}

/// Every component says what it computes: its header holds equations, limits and source where there are any.
#[test]
fn every_component_has_a_header() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("components");
    let mut files = Vec::new();
    mo_files(&root, &mut files);
    let apart = ["Modelica", "Interfaces", "Effects", "Bases", "Examples"];
    let mut bare = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&root).expect("below the root");
        let package = file.ends_with("package.mo");
        if package || inside.iter().any(|part| apart.iter().any(|a| part == *a)) {
            continue;
        }
        if !Disk.read(&file).expect("a text").contains("Documentation(") {
            bare.push(inside.display().to_string());
        }
    }
    assert!(bare.is_empty(), "without a header: {}", bare.join(", "));
}

/// What a reader of the library may expect of every component: a description and, of its parameters, units or bounds.
#[test]
fn classes_are_described() {
    let trees = SyntaxArena::new();
    let shipped = bramah::internals::shipped::ShippedWorld;
    let roots = bramah::internals::shipped::ShippedWorld::roots().map(|r| (&shipped as &dyn World, r)).to_vec();
    let mut library = Library::new(&trees, roots);
    let mut silent = Vec::new();
    for package in
        ["Interfaces", "Smooth", "Oil", "Hydraulic", "Pneumatic", "Mechanical", "Electrical", "Thermal", "Signal"]
    {
        let mut open = vec![library.find(package).expect("it ships")];
        while let Some(id) = open.pop() {
            let class = library.class(id);
            if class.description.is_none() {
                silent.push(library.full_name(id));
            }
            if class.kind == ClassKind::Package {
                let mut names: Vec<_> = nested_classes(class).map(|c| c.name.name).collect();
                names.extend(library.folder_members(id));
                open.extend(names.into_iter().filter_map(|n| library.child(id, n)).collect::<Vec<_>>());
            }
        }
    }
    assert!(silent.is_empty(), "without a description: {}", silent.join(", "));
}

#[test]
fn a_call_with_several_outputs_counts_as_its_first_in_an_expression() {
    let text = "
        model M
          function f
            input Real u;
            output Real a;
            output Real b;
          algorithm
            a := 2*u;
            b := 3*u;
          end f;
          Real x;
        equation
          x = 1 + f(time)*f(2);
        end M;";
    let outcome = flatten_text(text, None);
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
}

#[test]
fn an_input_may_be_declared_by_its_connector() {
    let text = "
        model M
          connector RealInput = input Real;
          RealInput u;
          Real y;
        equation
          y = 2*u;
        end M;";
    let flat = flatten_text(text, None).value.expect("it is right").flat;
    assert!(flat.variables.iter().any(|v| v.name == "u" && v.input));
}

#[test]
fn a_variable_that_a_when_assigns_has_a_left_limit_without_being_declared_discrete() {
    let text = "
        model M
          Real y(start = 0, fixed = true);
        equation
          when sample(0, 0.1) then
            y = 0.5*pre(y) + 1;
          end when;
        end M;";
    let flat = flatten_text(text, None).value.expect("it is right").flat;
    let dae = bramah::internals::structure::analyze(&flat, &Default::default());
    assert!(dae.diagnostics.is_empty(), "{:?}", dae.diagnostics);
    let written = flat.text();
    assert!(written.contains("pre(y)"), "{written}");
}
