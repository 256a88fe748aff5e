//! The catalogue of effects: read from the shipped models and from a folder of the study.

use super::circuit::NamedQuantity;
use bramah_expr::{ExprId, ExprNode};
use bramah_model::compile::{CompileOutcome, Request, flatten};
use bramah_model::flat::{FlatModel, FlatVariable};
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::ast::{
    self, ClassBody, ElementKind, Expr, ExprKind, Modification, ModificationArgument, ModificationArgumentKind,
};
use bramah_syntax::diag::{Code, Diagnostic, FileId};
use bramah_syntax::world::{MemoryWorld, Overlay, World};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where an effect goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AttachmentKind {
    /// To one node.
    Shunt,
    /// Across two ports of a component.
    Bridge,
    /// From a node to one of fixed potential.
    Drain,
    /// Into a connection.
    Series,
    /// Between a variable and its recording.
    Sensor,
    /// Between an input and the model.
    Command,
    /// Onto a parameter; no model belongs to it.
    Drift,
}

/// How an effect attaches, from the annotation of the interface it extends.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectInterface {
    /// Where it goes.
    pub attach: AttachmentKind,
    /// Potentials that it reads, of the ports it is attached to.
    pub potential: Vec<NamedQuantity>,
    /// The through variable that it gives (a Series element gets it); none for signals.
    pub through: Option<NamedQuantity>,
    /// The difference of potentials that a Series element gives.
    pub drop: Option<NamedQuantity>,
    /// Potentials of further ports of the same component.
    pub sense: Vec<NamedQuantity>,
    /// They may belong to any port of the network.
    pub anywhere: bool,
    /// A temperature that it reads, in kelvin.
    pub temperature: Option<String>,
}

/// A parameter in which the effect is linear near its off value.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectCoefficient {
    /// Its name in the effect model.
    pub name: String,
    /// Its unit; empty means that of the signal, or none.
    pub unit: String,
    /// Where the effect vanishes exactly.
    pub off: f64,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Typical size; for `relative` ones in full scales of the signal.
    pub nominal: f64,
    /// Counts in the unit of the signal, `nominal` in its full scales.
    pub relative: bool,
    /// At most what its nodes have of it already.
    pub part: bool,
    /// Each recording has one of its own, this the one of that number: a phase that follows no variable.
    pub recording: Option<usize>,
}

impl EffectCoefficient {
    /// Its name among those of a hypothesis.
    pub fn label(&self) -> String {
        self.recording.map_or_else(|| self.name.clone(), |k| format!("{}_{}", self.name, k + 1))
    }

    /// The value at which it stands for the whole effect, if it is a share of one.
    pub fn whole(&self) -> Option<f64> {
        self.max.filter(|m| m.is_finite() && *m <= 10.0 * self.nominal.abs())
    }
}

/// A parameter that enters nonlinearly.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeParameter {
    /// Its name in the effect model.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Values to try; for `relative` ones in full scales of the signal.
    pub grid: Vec<f64>,
    /// Least value that the effect allows.
    pub min: Option<f64>,
    /// Greatest value that the effect allows.
    pub max: Option<f64>,
    /// Greatest value that occurs where a corner is: one as wide rounds all of the law.
    pub occurs: Option<f64>,
    /// Counts in the unit of the signal, `grid` in its full scales.
    pub relative: bool,
    /// Compared with the potential of the site, or with the difference of its two: values beyond the range that occurs
    /// make no difference.
    pub threshold: bool,
    /// The same, compared with the first potential alone.
    pub level: bool,
    /// A size of the signal at a sensor or command beyond which the effect acts: values outside of the range that occurs
    /// make no difference.
    pub limit: bool,
    /// A frequency, Hz, of which the recordings have a line that the nominal model has not.
    pub line: bool,
    /// Periods a turn or a stroke: the same effect may come again with another one.
    pub order: bool,
}

/// Parameters that take the range of a potential, or of what flows through a Series element.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeParameters {
    /// The potential or through variable, by its name in the effect.
    pub of: String,
    /// It is the size of the potential's rate whose range is taken.
    pub rate: bool,
    /// Parameter for its least value.
    pub least: String,
    /// Parameter for its greatest value.
    pub most: String,
}

/// One effect model.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectModel {
    /// Full name of its class.
    pub class: String,
    /// Its family, of the closed list.
    pub family: String,
    /// Its number in the list of effects, empty if it has none.
    pub id: String,
    /// What it does, in words.
    pub description: String,
    /// Where it goes.
    pub interface: EffectInterface,
    /// Linear parameters.
    pub coefficients: Vec<EffectCoefficient>,
    /// Nonlinear parameters.
    pub shapes: Vec<ShapeParameter>,
    /// Parameters that take the value of the component's parameter of equal unit.
    pub base: Vec<NamedQuantity>,
    /// A potential that it reads, or its rate, with the two parameters that take the least and the greatest value that occurs.
    pub range: Option<RangeParameters>,
    /// A parameter that is the pressure of the surroundings: nothing where the model counts pressures from there.
    pub surroundings: Option<String>,
    /// Effects of one group are also tried together, with one set of coefficients.
    pub group: Option<String>,
    /// The law of which it is a form; of these one is at a place.
    pub law: Option<String>,
    /// A Bridge between nodes of which neither is fixed (another effect of the family covers the fixed ones).
    pub free_ends: bool,
    /// A Bridge that is tried in both directions.
    pub directed: bool,
    /// An effect on a command that also fits what a sensor shows.
    pub measured: bool,
    /// Not tried where an effect of this kind fits.
    pub without: Option<AttachmentKind>,
    /// States of its own; inside a connection the order of the system changes with them.
    pub states: usize,
    /// It reads the rate of a potential.
    pub needs_rate: bool,
    /// It reads the second derivative of a potential.
    pub needs_acceleration: bool,
}

/// The family of sources that have no form: not hypotheses, but what hypotheses are weighed against.
const DISTURBANCE: &str = "disturbance";
/// The family of shapes: they compete with the effects, and where one of them wins, nothing known explains the gap.
const SHAPE: &str = "shape";

impl EffectModel {
    /// Whether it only says what shape a gap has that no effect explains.
    pub fn is_shape(&self) -> bool {
        self.family == SHAPE
    }
}

/// What may be missing, in the order of the packages: what is usual on machines comes first.
#[derive(Clone, Debug)]
pub struct EffectCatalogue {
    /// Explanations.
    pub effects: Vec<Arc<EffectModel>>,
    /// The shipped sources without form, one for each kind of place.
    pub disturbances: Vec<Arc<EffectModel>>,
}

/// Reads the shipped effects and those of a folder.
pub fn catalogue(world: &dyn World, folder: Option<&Path>) -> CompileOutcome<EffectCatalogue> {
    let CompileOutcome { sources, diagnostics, value } = everything(world, folder);
    let parted = |all: Vec<Arc<EffectModel>>| {
        let (mut disturbances, effects): (Vec<_>, Vec<_>) = all.into_iter().partition(|e| e.family == DISTURBANCE);
        disturbances.retain(|d| d.class.starts_with("Effects."));
        EffectCatalogue { effects, disturbances }
    };
    CompileOutcome { sources, diagnostics, value: value.map(parted) }
}

fn everything(world: &dyn World, folder: Option<&Path>) -> CompileOutcome<Vec<Arc<EffectModel>>> {
    let mut reader = CatalogueReader::default();
    reader.folder(&ShippedWorld, Path::new("components/Effects"), "Effects");
    if let Some(folder) = folder {
        let package = world.read(&folder.join("package.mo")).is_ok();
        let prefix = folder.file_name().filter(|_| package).map(|n| n.to_string_lossy().into_owned());
        reader.folder(world, folder, prefix.as_deref().unwrap_or(""));
    }
    reader.finish(world, folder)
}

/// A class found in the folders, with its annotation.
struct EffectClass {
    class: String,
    description: String,
    partial: bool,
    extends: Vec<String>,
    annotation: Modification,
}

#[derive(Default)]
struct CatalogueReader {
    classes: BTreeMap<String, EffectClass>,
    /// Their names as they were read.
    order: Vec<String>,
    diagnostics: Vec<Diagnostic>,
}

impl CatalogueReader {
    fn folder(&mut self, world: &dyn World, path: &Path, prefix: &str) {
        for (name, is_folder) in in_order(world, path) {
            let inner = path.join(&name);
            if is_folder {
                self.folder(world, &inner, &joined(prefix, &name));
            } else if name.ends_with(".mo") {
                let Ok(text) = world.read(&inner) else { continue };
                let tree = bramah_syntax::parse(FileId(0), &text).tree;
                tree.classes.iter().for_each(|c| self.class(c, prefix, name == "package.mo"));
            }
        }
    }

    fn class(&mut self, class: &ast::Class, prefix: &str, package: bool) {
        let ClassBody::Long(body) = &class.body else { return };
        let full = if package { prefix.to_string() } else { joined(prefix, class.name.name.as_str()) };
        for e in &body.elements {
            if let ElementKind::Class(inner) = &e.kind {
                self.class(inner, &full, false);
            }
        }
        let extends = body.elements.iter().filter_map(|e| match &e.kind {
            ElementKind::Extends(x) => Some(x.base.dotted()),
            _ => None,
        });
        let own = vendor(class.annotation.as_ref()).cloned().unwrap_or_default();
        let found = EffectClass {
            class: full.clone(),
            description: class.description.as_deref().unwrap_or("").to_string(),
            partial: class.prefixes.partial,
            extends: extends.collect(),
            annotation: own,
        };
        self.order.push(full.clone());
        self.classes.insert(full, found);
    }

    /// The interface that a class extends, near or far.
    fn interface<'a>(&'a self, class: &'a EffectClass) -> Option<&'a EffectClass> {
        if argument(&class.annotation, "attach").is_some() {
            return Some(class);
        }
        class.extends.iter().find_map(|base| self.interface(self.resolve(&class.class, base)?))
    }

    fn resolve(&self, from: &str, name: &str) -> Option<&EffectClass> {
        let mut around = from;
        while let Some((outer, _)) = around.rsplit_once('.') {
            if let Some(found) = self.classes.get(&format!("{outer}.{name}")) {
                return Some(found);
            }
            around = outer;
        }
        self.classes.get(name)
    }

    fn finish(mut self, world: &dyn World, folder: Option<&Path>) -> CompileOutcome<Vec<Arc<EffectModel>>> {
        let wanted: Vec<(&EffectClass, &EffectClass)> = self
            .order
            .iter()
            .filter_map(|name| self.classes.get(name))
            .filter(|f| !f.partial && argument(&f.annotation, "family").is_some())
            .filter_map(|f| Some((f, self.interface(f)?)))
            .collect();
        let names: Vec<&str> = wanted.iter().map(|(f, _)| f.class.as_str()).collect();
        let CompileOutcome { sources, diagnostics, value } = flatten_all(world, folder, &names);
        let Some(flat) = value else { return CompileOutcome { sources, diagnostics, value: None } };
        let read = EffectAttributes::of(&flat);
        let mut effects = Vec::new();
        let mut bad = Vec::new();
        for (number, (found, interface)) in wanted.iter().enumerate() {
            match effect(found, interface, &read, number) {
                Ok(e) => effects.push(Arc::new(e)),
                Err(why) => bad.push(unusable(&found.class, &why)),
            }
        }
        self.diagnostics.extend(bad);
        CompileOutcome { sources, diagnostics: self.diagnostics, value: Some(effects) }
    }
}

/// What a folder holds, in the order of its package; what that does not name comes last.
fn in_order(world: &dyn World, path: &Path) -> Vec<(String, bool)> {
    let order = world.read(&path.join("package.order")).unwrap_or_default();
    let names: Vec<&str> = order.lines().map(str::trim).collect();
    let mut all = world.list(path).unwrap_or_default();
    let place = |file: &str| {
        let name = file.strip_suffix(".mo").unwrap_or(file);
        names.iter().position(|n| *n == name).unwrap_or(names.len())
    };
    all.sort_by_cached_key(|(file, _)| (place(file), file.clone()));
    all
}

fn unusable(class: &str, why: &str) -> Diagnostic {
    Diagnostic::new(Code::BadModel, format!("`{class}` cannot be used as an effect: {why}"))
        .help("an effect extends one of `Effects.Interfaces` and carries `annotation(__bramah(family = \"...\", coefficients = {\"...\"}))`")
}

/// One model that holds every effect once, named `e0`, `e1`, ...
fn flatten_all(world: &dyn World, folder: Option<&Path>, names: &[&str]) -> CompileOutcome<FlatModel> {
    let mut text = String::from("model Catalogue\n");
    for (i, name) in names.iter().enumerate() {
        text.push_str(&format!("  {name} e{i};\n"));
    }
    text.push_str("end Catalogue;\n");
    let source = PathBuf::from("(effects)/Catalogue.mo");
    let overlay = Overlay { base: world, files: MemoryWorld::single(&source, text) };
    let mut request = Request { source, model: Some("Catalogue".into()), varied: true, ..Request::default() };
    own_classes(world, folder, &mut request);
    let CompileOutcome { sources, diagnostics, value } = flatten(&overlay, &request);
    CompileOutcome { sources, diagnostics, value: value.map(|f| f.flat) }
}

/// Makes the classes of the user's folder known.
pub fn own_classes(world: &dyn World, folder: Option<&Path>, request: &mut Request) {
    let Some(folder) = folder else { return };
    if world.read(&folder.join("package.mo")).is_ok() {
        request.beside.push(folder.to_path_buf());
    } else {
        request.libraries.push(folder.to_path_buf());
    }
}

/// What the flat catalogue says about the variables and equations of each effect.
struct EffectAttributes<'a> {
    flat: &'a FlatModel,
    index: BTreeMap<&'a str, &'a FlatVariable>,
    /// Names of variables whose derivative occurs.
    differentiated: BTreeSet<String>,
    /// Variables that are the derivative of another.
    rate_of: BTreeMap<String, String>,
}

impl<'a> EffectAttributes<'a> {
    fn of(flat: &'a FlatModel) -> Self {
        let name = |v: bramah_expr::VarId| flat.variables[v.index()].name.clone();
        let mut differentiated = BTreeSet::new();
        let mut rate_of = BTreeMap::new();
        for e in &flat.equations {
            for side in [e.lhs, e.rhs] {
                differentiated.extend(flat.exprs.derivatives(side).into_iter().map(name));
            }
            for (one, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
                if let (ExprNode::Var(v), ExprNode::Der(x)) = (flat.exprs.node(one), flat.exprs.node(other)) {
                    rate_of.insert(name(v), name(x));
                }
            }
        }
        let index = flat.variables.iter().map(|v| (v.name.as_str(), v)).collect();
        EffectAttributes { flat, index, differentiated, rate_of }
    }

    fn variable(&self, number: usize, name: &str) -> Result<&'a FlatVariable, String> {
        self.index.get(format!("e{number}.{name}").as_str()).copied().ok_or_else(|| format!("it has no `{name}`"))
    }

    fn quantity(&self, number: usize, name: &str) -> Result<NamedQuantity, String> {
        let unit = self.variable(number, name)?.unit.as_deref().unwrap_or("").to_string();
        Ok(NamedQuantity { name: name.to_string(), unit })
    }

    fn number(&self, e: Option<ExprId>) -> Option<f64> {
        e.and_then(|e| self.flat.exprs.as_num(e))
    }
}

fn effect(
    found: &EffectClass,
    interface: &EffectClass,
    read: &EffectAttributes<'_>,
    number: usize,
) -> Result<EffectModel, String> {
    let own = &found.annotation;
    let interface = interface_of(&interface.annotation, own, read, number)?;
    let relative: BTreeSet<String> = texts(own, "relative").into_iter().collect();
    let mut effect = EffectModel {
        class: found.class.clone(),
        family: text(own, "family").unwrap_or_default(),
        id: text(own, "id").unwrap_or_default(),
        description: found.description.clone(),
        coefficients: coefficients(own, read, number, &relative)?,
        shapes: shapes(own, read, number, &relative)?,
        base: texts(own, "base").iter().map(|n| read.quantity(number, n)).collect::<Result<_, _>>()?,
        range: range(own, read, number)?,
        surroundings: text(own, "surroundings"),
        group: text(own, "group"),
        law: text(own, "law"),
        free_ends: text(own, "ends").as_deref() == Some("free"),
        directed: text(own, "directed").is_some(),
        measured: text(own, "measured").is_some(),
        without: text(own, "without").and_then(|t| attach(&t)),
        interface,
        states: 0,
        needs_rate: false,
        needs_acceleration: false,
    };
    rates(&mut effect, read, number);
    Ok(effect)
}

fn range(own: &Modification, read: &EffectAttributes<'_>, number: usize) -> Result<Option<RangeParameters>, String> {
    let mut names = texts(own, "range").into_iter();
    match (names.next(), names.next(), names.next(), names.next()) {
        (None, ..) => Ok(None),
        (Some(of), Some(least), Some(most), None) => {
            let prefix = format!("e{number}.");
            let potential = read.rate_of.get(&format!("{prefix}{of}")).and_then(|x| x.strip_prefix(&prefix));
            Ok(Some(RangeParameters {
                rate: potential.is_some(),
                of: potential.unwrap_or(&of).to_string(),
                least,
                most,
            }))
        }
        _ => Err("`range` is not a potential or its rate and the two parameters that take its range".into()),
    }
}

/// Finds out which derivatives an effect uses.
fn rates(effect: &mut EffectModel, read: &EffectAttributes<'_>, number: usize) {
    let prefix = format!("e{number}.");
    let potentials: BTreeSet<String> = effect
        .interface
        .potential
        .iter()
        .chain(&effect.interface.sense)
        .map(|q| format!("{prefix}{}", q.name))
        .collect();
    for name in read.differentiated.range(prefix.clone()..).take_while(|n| n.starts_with(&prefix)) {
        if potentials.contains(name) {
            effect.needs_rate = true;
        } else if read.rate_of.get(name).is_some_and(|x| potentials.contains(x)) {
            effect.needs_acceleration = true;
        } else {
            effect.states += 1;
        }
    }
}

fn interface_of(
    base: &Modification,
    own: &Modification,
    read: &EffectAttributes<'_>,
    number: usize,
) -> Result<EffectInterface, String> {
    let name = text(base, "attach").unwrap_or_default();
    let attach = attach(&name).ok_or_else(|| format!("`attach = \"{name}\"` is not known"))?;
    let all = |key: &str| texts(base, key).iter().map(|n| read.quantity(number, n)).collect::<Result<Vec<_>, _>>();
    Ok(EffectInterface {
        attach,
        potential: all("potential")?,
        through: text(base, "through").map(|n| read.quantity(number, &n)).transpose()?,
        drop: text(base, "drop").map(|n| read.quantity(number, &n)).transpose()?,
        sense: all("sense")?,
        anywhere: text(base, "anywhere").is_some(),
        temperature: text(own, "temperature").or_else(|| text(base, "temperature")),
    })
}

fn attach(name: &str) -> Option<AttachmentKind> {
    Some(match name {
        "Shunt" => AttachmentKind::Shunt,
        "Bridge" => AttachmentKind::Bridge,
        "Drain" => AttachmentKind::Drain,
        "Series" => AttachmentKind::Series,
        "Sensor" => AttachmentKind::Sensor,
        "Command" => AttachmentKind::Command,
        _ => return None,
    })
}

fn coefficients(
    own: &Modification,
    read: &EffectAttributes<'_>,
    number: usize,
    relative: &BTreeSet<String>,
) -> Result<Vec<EffectCoefficient>, String> {
    let names = texts(own, "coefficients");
    if names.is_empty() {
        return Err("it names no `coefficients`".into());
    }
    let one = |name: String| {
        let v = read.variable(number, &name)?;
        let off = read.number(v.binding).unwrap_or(0.0);
        let nominal = read.number(v.nominal).ok_or_else(|| format!("`{name}` has no `nominal`"))?;
        Ok(EffectCoefficient {
            unit: v.unit.as_deref().unwrap_or("").to_string(),
            off,
            min: read.number(v.min),
            max: read.number(v.max),
            nominal,
            relative: relative.contains(&name),
            part: texts(own, "part").contains(&name),
            recording: texts(own, "own").contains(&name).then_some(0),
            name,
        })
    };
    names.into_iter().map(one).collect()
}

fn shapes(
    own: &Modification,
    read: &EffectAttributes<'_>,
    number: usize,
    relative: &BTreeSet<String>,
) -> Result<Vec<ShapeParameter>, String> {
    let Some(ModificationArgumentKind::Modify { modification: Some(list), .. }) =
        argument(own, "shapes").map(|a| &a.kind)
    else {
        return Ok(Vec::new());
    };
    let one = |a: &ModificationArgument| {
        let ModificationArgumentKind::Modify { path, modification: Some(m), .. } = &a.kind else {
            return Err("`shapes` holds something other than `name = {values}`".to_string());
        };
        let name = path.dotted();
        let grid: Option<Vec<f64>> = match m.value.as_ref().map(|v| &v.kind) {
            Some(ExprKind::Array(items)) => items.iter().map(Expr::as_number).collect(),
            _ => None,
        };
        let grid =
            grid.filter(|g| !g.is_empty()).ok_or_else(|| format!("the grid of `{name}` is no list of numbers"))?;
        let variable = read.variable(number, &name)?;
        let (min, max) = (read.number(variable.min), read.number(variable.max));
        let unit = variable.unit.clone().unwrap_or_default();
        let listed = |key: &str| texts(own, key).contains(&name);
        let (threshold, level, limit) = (listed("threshold"), listed("level"), listed("limit"));
        let (line, order) = (listed("line"), listed("order"));
        let relative = relative.contains(&name);
        let unit = unit.to_string();
        Ok(ShapeParameter { unit, grid, min, max, occurs: None, relative, threshold, level, limit, line, order, name })
    };
    list.arguments.iter().map(one).collect()
}

/// What stands in `__bramah(...)`.
fn vendor(annotation: Option<&Modification>) -> Option<&Modification> {
    match &argument(annotation?, "__bramah")?.kind {
        ModificationArgumentKind::Modify { modification, .. } => modification.as_ref(),
        _ => None,
    }
}

fn argument<'a>(modification: &'a Modification, name: &str) -> Option<&'a ModificationArgument> {
    modification.arguments.iter().find(|a| match &a.kind {
        ModificationArgumentKind::Modify { path, .. } => path.parts.len() == 1 && path.parts[0].name == name,
        _ => false,
    })
}

fn value<'a>(modification: &'a Modification, name: &str) -> Option<&'a Expr> {
    match &argument(modification, name)?.kind {
        ModificationArgumentKind::Modify { modification: Some(m), .. } => m.value.as_ref(),
        _ => None,
    }
}

fn text(modification: &Modification, name: &str) -> Option<String> {
    match &value(modification, name)?.kind {
        ExprKind::String(s) => Some(s.to_string()),
        _ => None,
    }
}

fn texts(modification: &Modification, name: &str) -> Vec<String> {
    let Some(ExprKind::Array(items)) = value(modification, name).map(|v| &v.kind) else { return Vec::new() };
    let string = |e: &Expr| if let ExprKind::String(s) = &e.kind { Some(s.to_string()) } else { None };
    items.iter().filter_map(string).collect()
}

fn joined(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_string() } else { format!("{prefix}.{name}") }
}
