//! The pipeline: from a request to a flat model or sorted equations. Every command and test goes this way.
//!
//! Enters: a [`Request`] and a `World` to read files from. Leaves: a [`CompileOutcome`] with the texts, the messages of
//! all stages and the value. The stages are, in order: `resolve`, `instance`, `network`, `flat`, `unit_check`,
//! `structure`. A stage with errors ends the pipeline, so that its consequences are not reported. [`flatten`] goes up
//! to the flat model, [`sort`] up to the sorted equations.

mod deep;
mod messages;

pub use deep::{STACK, deep};
pub use messages::sort_messages;

use crate::flat::{self, FlatModel};
use crate::instance::{self, Instance, ModelRequest, Override};
use crate::network::{self, ComponentGraph, Network};
use crate::resolve::{ClassId, Library, SyntaxArena, nested_classes};
use crate::shipped::ShippedWorld;
use crate::structure::{self, Dae, StateChoice};
use crate::unit_check;
use bramah_syntax::ast::{self, ClassBody, ClassKind};
use bramah_syntax::diag::{Code, Diagnostic, Sources, StageResult};
use bramah_syntax::world::World;
use std::path::{Path, PathBuf};

/// What to compile, and where to find what it needs.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// A file, a folder that is a package, or the dotted name of a class that ships with bramah.
    pub source: PathBuf,
    /// The class to run; may be left out where only one can run.
    pub model: Option<String>,
    /// Values given from outside, in place of those in the text.
    pub overrides: Vec<Override>,
    /// Folders that contain further packages, in order of precedence.
    pub libraries: Vec<PathBuf>,
    /// Further files and packages whose classes `source` may name.
    pub beside: Vec<PathBuf>,
    /// Where relative names of data files begin, if not at the folder of `source`.
    pub data_folder: Option<PathBuf>,
    /// C sources and shared libraries that external functions may call. The entry `annotations` allows what the
    /// annotations of the functions name, and nothing else. Without any entry, C code of a model is refused. The code
    /// runs unguarded.
    pub externals: Vec<PathBuf>,
    /// Parameters will take other values in the same model, so one that is 0 removes no derivative from the equations.
    pub varied: bool,
}

/// The result of a [`Request`].
#[derive(Debug)]
pub struct CompileOutcome<T> {
    /// All texts that were read; the places of messages refer to them.
    pub sources: Sources,
    /// Errors, warnings and notes.
    pub diagnostics: Vec<Diagnostic>,
    /// The result; `None` where there were errors.
    pub value: Option<T>,
}

/// A model after the front half of the pipeline.
#[derive(Clone, Debug)]
pub struct FrontEndResult {
    /// Scalar variables and equations.
    pub flat: FlatModel,
    /// Components and connections of the top level.
    pub graph: ComponentGraph,
}

/// Compiles up to the sorted equations. Returns the flat model, the graph of its components and the sorted system.
/// Unit warnings come before the messages of the structural analysis.
pub fn sort(world: &dyn World, request: &Request) -> CompileOutcome<(FlatModel, ComponentGraph, Dae)> {
    let CompileOutcome { sources, mut diagnostics, value } = flatten(world, request);
    let value = value.and_then(|f| {
        diagnostics.extend(unit_check::check(&f.flat));
        // Again after the unit check: its warnings about texts of libraries are filtered like all others.
        messages::of_libraries(&mut diagnostics, &sources, request);
        let dae = analyze(&f.flat).sink(&mut diagnostics);
        Some((f.flat, f.graph, dae?))
    });
    CompileOutcome { sources, diagnostics, value }
}

/// Sorts the equations of a flat model. Where they do not determine the unknowns, the diagnostics say why.
/// It uses the default choice of states.
pub fn analyze(flat: &FlatModel) -> StageResult<Dae> {
    let mut checked = structure::analyze(flat, &StateChoice::default());
    if checked.diagnostics.iter().any(is_structural) {
        checked.diagnostics = explained(flat, checked.diagnostics);
    }
    checked
}

/// Whether a diagnostic says that the equations do not determine the unknowns (E301, E302, E303).
fn is_structural(d: &Diagnostic) -> bool {
    matches!(d.code, Code::Singular | Code::NoReference | Code::Overdetermined)
}

/// The messages of the first level at which something is wrong: a cause in one component is reported instead of its
/// consequences. `found` itself where no such cause shows.
/// The structural analysis is repeated on changed models to see whether an open port is to blame.
fn explained(flat: &FlatModel, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let solvable = |changed: &FlatModel| structure::analyze(changed, &StateChoice::default()).value.is_some();
    let causes = flat::explain(flat, &solvable);
    if causes.is_empty() { found } else { causes }
}

/// Compiles up to the flat model.
pub fn flatten(world: &dyn World, request: &Request) -> CompileOutcome<FrontEndResult> {
    inspect(world, request, |instance, network, flat| FrontEndResult { flat, graph: network.graph(instance) })
}

/// Compiles up to the flat model and calls `look` with it, with the component tree and with the connections that it was
/// made from. `look` is not called where there are errors.
/// The tree and the connections are borrowed: they do not outlive the call.
pub fn inspect<T>(
    world: &dyn World,
    request: &Request,
    look: impl FnOnce(&mut Instance<'_, '_>, &Network, FlatModel) -> T,
) -> CompileOutcome<T> {
    with_class(world, request, |library, class, diagnostics| {
        with_network(library, class, request, diagnostics, |instance, network, diagnostics| {
            let flat = flat::flatten(instance, network).sink(diagnostics)?;
            Some(look(instance, network, flat))
        })
    })
}

/// The full name of a model with its components and connections, also where ports are open or equations do not fit
/// together: nothing is flattened.
pub fn graph(world: &dyn World, request: &Request) -> CompileOutcome<(String, ComponentGraph)> {
    with_class(world, request, |library, class, diagnostics| {
        let name = library.full_name(class);
        with_network(library, class, request, diagnostics, |instance, network, _| Some((name, network.graph(instance))))
    })
}

/// Finds the class of a request, calls `act` with it, and puts the messages of all stages together. The value is `None`
/// if any message is an error.
///
/// Class trees live as long as this function, which is why callers act inside it.
fn with_class<T>(
    world: &dyn World,
    request: &Request,
    act: impl FnOnce(&mut Library<'_>, ClassId, &mut Vec<Diagnostic>) -> Option<T>,
) -> CompileOutcome<T> {
    let trees = SyntaxArena::new();
    let shipped = ShippedWorld;
    let mut library = Library::new(&trees, roots(world, &shipped, request));
    library.set_data_folder(world, request.data_folder(world));
    library.set_externals(request.externals.clone());
    let mut diagnostics = Vec::new();
    let value = find_model(world, &mut library, request)
        .map_err(|d| diagnostics.push(*d))
        .ok()
        // With errors in the texts, the stages would report their consequences.
        .filter(|_| !library.diagnostics.iter().any(Diagnostic::is_error))
        .and_then(|class| act(&mut library, class, &mut diagnostics));
    let mut all = std::mem::take(&mut library.diagnostics);
    if all.iter().any(Diagnostic::is_error) {
        // A class may be missing because its text could not be read.
        diagnostics.retain(|d| d.code != Code::BadModel);
    }
    all.extend(diagnostics);
    // In this order: repeated messages first, then the notes that count what was left out.
    messages::once(&mut all);
    all.extend(messages::other_versions(&mut library));
    messages::missing_once(&mut all);
    messages::of_libraries(&mut all, &library.sources, request);
    let all: Vec<Diagnostic> = all.into_iter().map(|d| if d.is_error() { d.advised() } else { d }).collect();
    let failed = all.iter().any(Diagnostic::is_error);
    CompileOutcome { sources: std::mem::take(&mut library.sources), diagnostics: all, value: value.filter(|_| !failed) }
}

/// Folders with packages, in order of precedence: those of the request, then what ships with bramah.
/// A package of the user's folders hides one that ships with bramah.
fn roots<'a>(world: &'a dyn World, shipped: &'a ShippedWorld, request: &Request) -> Vec<(&'a dyn World, PathBuf)> {
    let own = request.libraries.iter().map(|l| (world, l.clone()));
    own.chain(ShippedWorld::roots().map(|r| (shipped as &dyn World, r))).collect()
}

impl Request {
    /// Where relative names of data files begin: the folder that the request names, or else that of the model's file.
    pub fn data_folder(&self, world: &dyn World) -> PathBuf {
        let source = self.source.as_path();
        let own = || if world.list(source).is_some() { Some(source) } else { source.parent() };
        self.data_folder.as_deref().or_else(own).unwrap_or(Path::new("")).to_path_buf()
    }
}

/// Builds the instance of a class and its network, and calls `act` with them. `None` where they have errors, whose
/// messages go to `diagnostics`.
fn with_network<T>(
    library: &mut Library<'_>,
    class: ClassId,
    request: &Request,
    diagnostics: &mut Vec<Diagnostic>,
    act: impl FnOnce(&mut Instance<'_, '_>, &Network, &mut Vec<Diagnostic>) -> Option<T>,
) -> Option<T> {
    let wanted = ModelRequest { class, overrides: request.overrides.clone() };
    let mut instance = instance::instantiate(library, &wanted);
    instance.varied = request.varied;
    let network = network::network(&mut instance);
    if instance.diagnostics.iter().any(Diagnostic::is_error) {
        diagnostics.append(&mut instance.diagnostics);
        return None;
    }
    act(&mut instance, &network, diagnostics)
}

/// The class that a request means. Reads the files that it names. `Err` where there is none, or several.
///
/// The source is a path, or the dotted name of a shipped class if there is no such file.
fn find_model<'a>(
    world: &'a dyn World,
    library: &mut Library<'a>,
    request: &Request,
) -> Result<ClassId, Box<Diagnostic>> {
    let source = &request.source;
    let exists = world.list(source).is_some() || world.read(source).is_ok();
    let text = source.to_string_lossy();
    // An existing file goes before a shipped class of the same name.
    if !exists && is_dotted(&text) {
        let full = request.model.as_deref().filter(|m| m.contains('.') || *m == text).unwrap_or(&text);
        return library.find(full).ok_or_else(|| Box::new(no_such_shipped(&text)));
    }
    for path in &request.beside {
        library.add_path(world, path)?;
    }
    let given = library.add_path(world, source)?;
    note_shadowed(library);
    match &request.model {
        Some(name) => named_model(library, &given, name),
        None => only_model(library, source, &given),
    }
}

/// Whether a text has the form of a dotted class name and not of a Modelica file.
fn is_dotted(text: &str) -> bool {
    !text.is_empty()
        && !text.ends_with(".mo")
        && text.split('.').all(|p| p.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_'))
        && text.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.')
}

/// The error for a source that is neither a file nor a shipped class.
fn no_such_shipped(name: &str) -> Diagnostic {
    Diagnostic::new(Code::FileAccess, format!("there is no file, folder or shipped class `{name}`")).help(
        "give the path of a `.mo` file or package folder, or the dotted name of a class such as `ServoPump.DeadZone`",
    )
}

/// Adds a message for each top-level class of the user that hides a shipped one of the same name.
/// The code is N026, a note.
fn note_shadowed(library: &mut Library<'_>) {
    for id in library.own.clone() {
        let ident = library.class(id).name;
        let (name, file) = (ident.name.as_str(), format!("{}.mo", ident.name));
        let hidden = ShippedWorld::roots()
            .iter()
            .any(|r| ShippedWorld.list(r).is_some_and(|entries| entries.iter().any(|(e, _)| *e == name || *e == file)));
        if hidden {
            library.diagnostics.push(
                Diagnostic::new(Code::Shadowed, format!("your `{name}` hides the one that ships with bramah"))
                    .at(ident.span, "this one is used"),
            );
        }
    }
}

/// The class of a name: a full name, or one relative to a class of the source. `Err` suggests the nearest name.
/// The code is E022.
fn named_model(library: &mut Library<'_>, given: &[ClassId], name: &str) -> Result<ClassId, Box<Diagnostic>> {
    if let Some(id) = library.find(name) {
        return Ok(id);
    }
    // The user may leave out the name of the package that the file contains.
    for &id in given {
        let full = format!("{}.{name}", library.full_name(id));
        if let Some(found) = library.find(&full) {
            return Ok(found);
        }
    }
    let mut runnable = Vec::new();
    given.iter().for_each(|&id| collect_runnable(library, id, &mut runnable));
    let names: Vec<String> = runnable.iter().map(|&id| library.full_name(id)).collect();
    let mut d = Diagnostic::new(Code::BadModel, format!("there is no class `{name}`"));
    if let Some(near) = bramah_syntax::diag::nearest(name, names.iter().map(String::as_str)) {
        d = d.help(format!("did you mean `{near}`?"));
    } else if !names.is_empty() {
        d = d.help(listed("the file has", &names));
    }
    Err(Box::new(d))
}

/// Up to ten names after an introduction.
fn listed(intro: &str, names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(10).map(|n| format!("`{n}`")).collect();
    let more = if names.len() > 10 { format!(" and {} more", names.len() - 10) } else { String::new() };
    format!("{intro} {}{more}", shown.join(", "))
}

/// A model that can run, as lists show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunnableModel {
    /// Its full name.
    pub class: String,
    /// Its description string, or empty.
    pub description: String,
    /// Whether it has an `experiment` annotation.
    pub experiment: bool,
}

/// The models of a request's source that can run: those with an `experiment` annotation, or all where none has one. If
/// the request names a class, only that class and what is in it.
///
/// # Errors
/// The source cannot be read, or there is no such class.
pub fn runnable(world: &dyn World, request: &Request) -> Result<Vec<RunnableModel>, Vec<Diagnostic>> {
    let trees = SyntaxArena::new();
    let shipped = ShippedWorld;
    let mut library = Library::new(&trees, roots(world, &shipped, request));
    let given = match &request.model {
        Some(_) => find_model(world, &mut library, request).map(|id| vec![id]),
        None => library.add_path(world, &request.source),
    };
    let given = given.map_err(|d| vec![*d])?;
    let mut all = Vec::new();
    given.iter().for_each(|&id| collect_runnable(&mut library, id, &mut all));
    let with_experiment: Vec<ClassId> = all.iter().copied().filter(|&id| has_experiment(library.class(id))).collect();
    let chosen = if with_experiment.is_empty() { all } else { with_experiment };
    let described = |id| RunnableModel {
        class: library.full_name(id),
        description: library.class(id).description.as_deref().unwrap_or("").to_owned(),
        experiment: has_experiment(library.class(id)),
    };
    Ok(chosen.into_iter().map(described).collect())
}

/// The model of a request without a name: the only class with an `experiment`, or the only class that can run. `Err`
/// lists the candidates.
/// The code is E022.
fn only_model(library: &mut Library<'_>, source: &Path, given: &[ClassId]) -> Result<ClassId, Box<Diagnostic>> {
    let mut runnable = Vec::new();
    given.iter().for_each(|&id| collect_runnable(library, id, &mut runnable));
    let with_experiment: Vec<ClassId> =
        runnable.iter().copied().filter(|&id| has_experiment(library.class(id))).collect();
    for candidates in [&with_experiment, &runnable] {
        if let [only] = candidates[..] {
            return Ok(only);
        }
    }
    if let [only] = given
        && runnable.contains(only)
        && with_experiment.is_empty()
    {
        return Ok(*only);
    }
    let names: Vec<String> = runnable.iter().map(|&id| library.full_name(id)).collect();
    let d = if names.is_empty() {
        Diagnostic::new(Code::BadModel, format!("there is no model to run in `{}`", source.display()))
            .help("a model is a `model` or `block` that is not `partial`")
    } else {
        Diagnostic::new(Code::BadModel, "several models could be run")
            .help(format!("name one with `--model`: {}", listed("there are", &names)))
    };
    Err(Box::new(d))
}

/// Appends the models of a class and its nested packages that can run: models and blocks that are not partial.
/// Nested packages are searched, nested models of models are not.
fn collect_runnable(library: &mut Library<'_>, id: ClassId, out: &mut Vec<ClassId>) {
    let class = library.class(id);
    if matches!(class.kind, ClassKind::Model | ClassKind::Block | ClassKind::Class) && !class.prefixes.partial {
        out.push(id);
    }
    if class.kind == ClassKind::Package {
        let mut names: Vec<_> = nested_classes(class).map(|c| c.name.name).collect();
        // Classes in files of their own are not part of the text of the package.
        names.extend(library.folder_members(id));
        for name in names {
            if let Some(child) = library.child(id, name) {
                collect_runnable(library, child, out);
            }
        }
    }
}

/// Whether a class has an `experiment` annotation of its own.
fn has_experiment(class: &ast::Class) -> bool {
    if !matches!(class.body, ClassBody::Long(_) | ClassBody::Short { .. }) {
        return false;
    }
    let arguments = class.annotation.iter().flat_map(|a| &a.arguments);
    arguments.into_iter().any(
        |a| matches!(&a.kind, ast::ModificationArgumentKind::Modify { path, .. } if path.parts[0].name == "experiment"),
    )
}

/// Compiles one text held in memory up to the flat model; for tests and examples.
pub fn flatten_text(text: &str, model: Option<&str>) -> CompileOutcome<FrontEndResult> {
    let world = bramah_syntax::world::MemoryWorld::single("model.mo", text);
    let request = Request { source: Path::new("model.mo").into(), model: model.map(Into::into), ..Request::default() };
    flatten(&world, &request)
}
