//! The corrected model in one Modelica file: every class that it uses, and last the class `Fixed`.
//!
//! Enters: the fitted model and the request of the nominal one. Leaves: the text. The classes are those that the
//! compiler read. Connections that a Series element cuts are removed from the copy of the nominal class. `Modelica`
//! itself is left out, since every tool has it. Called by `diagnose`.

use super::augment::{AugmentationForm, HypothesisInstance, SOURCE, broken, cut, request, written};
use super::circuit::CircuitTopology;
use super::estimate::ModelFit;
use super::hypotheses::{AttachmentSite, SensorSignal};
use super::problem::DiagnosisProblem;
use bramah_model::compile::{Request, flatten};
use bramah_model::flat::ExperimentAnnotation;
use bramah_syntax::ast::{
    Class, ClassBody, Element, ElementKind, Equation, EquationKind, Expr, ExprKind, Modification,
    ModificationArgumentKind, StoredDefinition,
};
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources, StageResult};
use bramah_syntax::world::World;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Name of the corrected class.
pub const CLASS: &str = "Fixed";

/// Writes the file for given hypotheses. Hypotheses of family `parameter` set their parameter to their value.
///
/// # Errors
/// Those of the compiler, or a connection that must be cut and is not found.
pub fn fixed(
    world: &dyn World,
    nominal: &Request,
    folder: Option<&Path>,
    circuit: &CircuitTopology,
    attached: &[HypothesisInstance<'_>],
    signals: &[SensorSignal],
) -> StageResult<String> {
    write(world, nominal, folder, circuit, attached, signals, &drifts(attached))
}

/// Writes a fitted model: its effects and its tolerance parameters, both with fitted values. It starts as the nominal
/// model.
///
/// A parameter inside an array of components cannot be set by name in Modelica and keeps its nominal value; a comment
/// at the head of the file names it.
///
/// # Errors
/// As [`fixed`].
pub fn corrected(problem: &DiagnosisProblem<'_>, fit: &ModelFit) -> StageResult<String> {
    let theta = fit.candidate.theta(&fit.x);
    let causes = fit.causes();
    let attached: Vec<HypothesisInstance<'_>> =
        causes.iter().enumerate().map(|(i, c)| problem.attached(c, &format!("e{i}"))).collect();
    let mut values = drifts(&attached);
    let mut left = String::new();
    for (t, value) in problem.tolerances.iter().zip(&theta).filter(|(t, value)| **value != t.nominal) {
        // Modelica has no modifier for one element of an array of components
        if t.name.contains('[') {
            left.push_str(&format!("// not set, inside an array: {} = {value:e}\n", t.name));
        } else if !values.iter().any(|(n, _)| *n == t.name) {
            values.push((t.name.clone(), *value));
        }
    }
    let (request, folder) = (&problem.request, problem.folder.as_deref());
    let file = write(problem.world, request, folder, &problem.circuit, &attached, &problem.signals, &values);
    StageResult { value: file.value.map(|text| format!("{left}{text}")), diagnostics: file.diagnostics }
}

/// Writes the file with these values of parameters.
/// The model is compiled once to learn which files it uses; their classes are then copied into the text.
fn write(
    world: &dyn World,
    nominal: &Request,
    folder: Option<&Path>,
    circuit: &CircuitTopology,
    attached: &[HypothesisInstance<'_>],
    signals: &[SensorSignal],
    drifts: &[(String, f64)],
) -> StageResult<String> {
    let annotation = experiment(&circuit.experiment);
    let form = |cut| AugmentationForm { class: CLASS, cut, drifts, annotation: annotation.clone() };
    // flattened once with `break` clauses, to learn which classes the model uses
    let with_breaks = written(circuit, attached, signals, form(false));
    let (overlay, request) = request(world, nominal, folder, &with_breaks, CLASS);
    let outcome = flatten(&overlay, &request);
    if outcome.value.is_none() {
        return StageResult::failed(outcome.diagnostics);
    }
    let mut classes = PackageClasses::of(&outcome.sources);
    for (a, b) in broken(circuit, &cut(attached)) {
        let names = [&circuit.ports[a].name, &circuit.ports[b].name].map(String::as_str);
        if !classes.disconnect(&circuit.class, names) {
            let text =
                format!("the connection of `{}` and `{}` is not found where it could be cut", names[0], names[1]);
            return StageResult::failed(vec![Diagnostic::new(Code::BadModel, text)]);
        }
    }
    // the copied class has lost the connections, so the text needs no `break`
    let own = written(circuit, attached, signals, form(true));
    StageResult::new(format!("{}\n{}", StoredDefinition { within: None, classes: classes.top }, own.text), Vec::new())
}

/// Parameters that hypotheses set, with their values.
fn drifts(attached: &[HypothesisInstance<'_>]) -> Vec<(String, f64)> {
    let mut drifts = Vec::new();
    for a in attached {
        if let (AttachmentSite::Parameter(name), Some((_, value))) =
            (&a.hypothesis.attachments[0].site, a.values.first())
        {
            drifts.push((name.clone(), *value));
        }
    }
    drifts
}

/// The `experiment` annotation of the class.
fn experiment(e: &ExperimentAnnotation) -> String {
    let fields =
        [("StartTime", e.start_time), ("StopTime", e.stop_time), ("Interval", e.interval), ("Tolerance", e.tolerance)];
    let fields: Vec<String> = fields.iter().filter_map(|(n, v)| v.map(|v| format!("{n} = {v:e}"))).collect();
    format!("  annotation(experiment({}));\n", fields.join(", "))
}

/// The classes that were read, each inside its package.
struct PackageClasses {
    /// Classes and packages of the top level.
    top: Vec<Class>,
}

impl PackageClasses {
    /// Parses all files that the compiler read and nests their classes. Packages are recognised by their `package.mo`.
    fn of(sources: &Sources) -> Self {
        let packages: BTreeSet<&Path> = sources.iter().filter_map(|s| package_folder(&s.path)).collect();
        let mut files: Vec<(Vec<String>, bool, &str)> = Vec::new();
        // the augmented text itself is written anew at the end
        for s in sources.iter().filter(|s| s.path.ends_with(".mo") && s.path != SOURCE) {
            let is_package = package_folder(&s.path).is_some();
            files.push((around(Path::new(&s.path), &packages, is_package), is_package, &s.text));
        }
        // packages come before the classes inside them
        files.sort_by_key(|(around, is_package, _)| (around.len(), !is_package));
        let mut classes = PackageClasses { top: Vec::new() };
        for (around, _, text) in files {
            for mut class in bramah_syntax::parse(FileId(0), text).tree.classes {
                strip_experiment(&mut class);
                classes.insert(&around, class);
            }
        }
        classes.top.retain(|c| c.name.name != "Modelica");
        classes
    }

    /// Adds a class to the package with this path; to the top level if there is none.
    fn insert(&mut self, around: &[String], class: Class) {
        let Some(body) = self.find(around).map(|c| &mut c.body) else {
            // a class that two paths reach is added once
            if !self.top.iter().any(|c| c.name.name == class.name.name) {
                self.top.push(class);
            }
            return;
        };
        if let ClassBody::Long(body) = body {
            let span = class.span;
            body.elements.push(Element { protected: false, kind: ElementKind::Class(Box::new(class)), span });
        }
    }

    /// The class with this path.
    fn find(&mut self, path: &[String]) -> Option<&mut Class> {
        let (first, rest) = path.split_first()?;
        let mut class = self.top.iter_mut().find(|c| c.name.name == first.as_str())?;
        for name in rest {
            class = nested(class, name)?;
        }
        Some(class)
    }

    /// Removes a connection from a class or from one of its base classes; `true` if it was found.
    /// `ends`: names of the two ports, in either order.
    fn disconnect(&mut self, class: &str, ends: [&str; 2]) -> bool {
        let path: Vec<String> = class.split('.').map(String::from).collect();
        let Some(found) = self.find(&path) else { return false };
        let ClassBody::Long(body) = &mut found.body else { return false };
        let before = body.equations.len();
        body.equations.retain(|e| !connects(e, ends));
        if body.equations.len() < before {
            return true;
        }
        let bases: Vec<String> = body.elements.iter().filter_map(base).collect();
        // names of base classes are looked up in the packages around, from inside out
        bases.into_iter().any(|base| {
            let outer = (0..path.len()).rev().map(|n| [&path[..n], std::slice::from_ref(&base)].concat().join("."));
            outer.collect::<Vec<_>>().into_iter().any(|name| self.disconnect(&name, ends))
        })
    }
}

/// Folder of a `package.mo`; `None` for other files.
fn package_folder(path: &str) -> Option<&Path> {
    let path = Path::new(path);
    (path.file_name()? == "package.mo").then(|| path.parent()).flatten()
}

/// Names of the packages around the class of a file, from outside in. The class of a `package.mo` is the folder itself,
/// so its own folder does not count.
fn around(file: &Path, packages: &BTreeSet<&Path>, is_package: bool) -> Vec<String> {
    let mut folder: PathBuf = file.parent().unwrap_or(Path::new("")).to_path_buf();
    if is_package {
        folder = folder.parent().unwrap_or(Path::new("")).to_path_buf();
    }
    let mut names = Vec::new();
    while packages.contains(folder.as_path()) {
        names.push(folder.file_name().unwrap_or_default().to_string_lossy().into_owned());
        folder = folder.parent().unwrap_or(Path::new("")).to_path_buf();
    }
    names.reverse();
    names
}

/// A class inside another one.
fn nested<'a>(class: &'a mut Class, name: &str) -> Option<&'a mut Class> {
    let ClassBody::Long(body) = &mut class.body else { return None };
    body.elements.iter_mut().find_map(|e| match &mut e.kind {
        ElementKind::Class(c) if c.name.name == name => Some(&mut **c),
        _ => None,
    })
}

/// Name of the base class of an `extends` element.
fn base(element: &Element) -> Option<String> {
    match &element.kind {
        ElementKind::Extends(x) => Some(x.base.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(".")),
        _ => None,
    }
}

/// Whether an equation connects these two ends, in either order.
fn connects(equation: &Equation, ends: [&str; 2]) -> bool {
    let EquationKind::Connect(a, b) = &equation.kind else { return false };
    let found = [name(a), name(b)];
    found == ends || (found[0] == ends[1] && found[1] == ends[0])
}

/// Text of a reference; empty for other expressions.
fn name(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Reference(_) => e.to_string(),
        _ => String::new(),
    }
}

/// Removes `experiment` annotations of a class and of classes inside it: only `Fixed` is meant to be simulated.
fn strip_experiment(class: &mut Class) {
    if let Some(Modification { arguments, .. }) = &mut class.annotation {
        arguments.retain(
            |a| !matches!(&a.kind, ModificationArgumentKind::Modify { path, .. } if path.parts[0].name == "experiment"),
        );
        if arguments.is_empty() {
            class.annotation = None;
        }
    }
    if let ClassBody::Long(body) = &mut class.body {
        for e in &mut body.elements {
            if let ElementKind::Class(c) = &mut e.kind {
                strip_experiment(c);
            }
        }
    }
}
