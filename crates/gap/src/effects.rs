//! The library of effects, read from the shipped package `Effects` and from a folder of the study.
//!
//! Enters: a `World` and the user's folder. Leaves: an [`EffectCatalogue`] of [`EffectModel`]s for `hypotheses`.
//!
//! An effect is a Modelica class that extends an interface of `Effects.Interfaces` and has a vendor annotation
//! `__bramah(family = ..., coefficients = ...)`. The classes are flattened once, all in one model, to read units,
//! bounds, nominal values and derivatives. An effect vanishes exactly at the off values of its coefficients, so that
//! the model with it contains the model without it.

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

/// How an effect is attached to the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AttachmentKind {
    /// To one node.
    Shunt,
    /// Between two ports of a component.
    Bridge,
    /// From a node to one of given potential.
    Drain,
    /// Into a connection.
    Series,
    /// Between a variable and its recording.
    Sensor,
    /// Between an input and the model.
    Command,
    /// To a parameter; no effect model belongs to it.
    Drift,
}

/// How an effect attaches, from the annotation of the interface that it extends.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectInterface {
    /// Kind of attachment.
    pub attach: AttachmentKind,
    /// Potentials that it reads, of the ports to which it is attached.
    pub potential: Vec<NamedQuantity>,
    /// Flow that it gives, or that a Series element reads; `None` for signals.
    pub through: Option<NamedQuantity>,
    /// Difference of potential that a Series element gives; `None` for others.
    pub drop: Option<NamedQuantity>,
    /// Potentials of further ports of the same component that it reads.
    pub sense: Vec<NamedQuantity>,
    /// Those further ports may be any of the network.
    pub anywhere: bool,
    /// Variable of the effect that is a temperature in kelvin; `None` if it reads none.
    pub temperature: Option<String>,
}

/// A parameter in which the effect is linear near its off value.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectCoefficient {
    /// Its name in the effect model.
    pub name: String,
    /// Its unit; empty means that of the signal, or none.
    pub unit: String,
    /// Value at which the effect vanishes exactly.
    pub off: f64,
    /// Lower bound; `None` if unbounded.
    pub min: Option<f64>,
    /// Upper bound; `None` if unbounded.
    pub max: Option<f64>,
    /// Typical size; for `relative` coefficients in full scales of the signal.
    pub nominal: f64,
    /// It counts in the unit of the signal.
    pub relative: bool,
    /// It is a part of what its nodes have of it already, and bounded by that.
    pub part: bool,
    /// Index of the recording in which it acts, for coefficients that each recording has of its own (a phase that
    /// follows no variable); `None` for others.
    pub recording: Option<usize>,
}

impl EffectCoefficient {
    /// Its name among the coefficients of a hypothesis.
    pub fn label(&self) -> String {
        self.recording.map_or_else(|| self.name.clone(), |k| format!("{}_{}", self.name, k + 1))
    }

    /// Its value for the complete effect, if it is a share of one; `None` otherwise.
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
    /// Values to start from; for `relative` shapes in full scales of the signal.
    pub grid: Vec<f64>,
    /// Least value that the effect allows; `None` if unbounded.
    pub min: Option<f64>,
    /// Greatest value that the effect allows; `None` if unbounded.
    pub max: Option<f64>,
    /// Greatest value that occurs where a corner is: a corner as wide rounds all of the law.
    pub occurs: Option<f64>,
    /// It counts in the unit of the signal.
    pub relative: bool,
    /// What its values are compared with; the recordings replace its grid accordingly.
    pub role: ShapeRole,
}

/// What the values of a shape are compared with. The annotations of an effect list the parameters of each role.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShapeRole {
    /// Nothing that recordings show: its unit says whether it is a time, a speed, a distance or the width of a corner.
    #[default]
    Plain,
    /// `threshold`: the potential of the site, or the difference of its two. Values outside of what occurs have no
    /// effect.
    Threshold,
    /// `level`: the first potential alone, also between two nodes. Values outside of what occurs have no effect.
    Level,
    /// `limit`: the size of the signal, beyond which the effect acts. Values outside of what occurs have no effect.
    Limit,
    /// `line`: a frequency, Hz, at which the recordings have a spectral line that the nominal model lacks.
    SpectralLine,
    /// `order`: a number of periods per turn or stroke. The same effect may be accepted again with another one.
    Order,
}

impl ShapeRole {
    /// The roles by the keys of their annotations.
    const KEYS: [(&str, ShapeRole); 5] = [
        ("threshold", ShapeRole::Threshold),
        ("level", ShapeRole::Level),
        ("limit", ShapeRole::Limit),
        ("line", ShapeRole::SpectralLine),
        ("order", ShapeRole::Order),
    ];

    /// The role that the annotations give a parameter.
    ///
    /// # Errors
    /// They give it two.
    fn of(parameter: &str, own: &Modification) -> Result<ShapeRole, String> {
        let listed = |key: &str| texts(own, key).iter().any(|name| name == parameter);
        let mut roles = ShapeRole::KEYS.iter().filter(|(key, _)| listed(key));
        match (roles.next(), roles.next()) {
            (Some((first, _)), Some((second, _))) => {
                Err(format!("`{parameter}` is both a `{first}` and a `{second}`; a shape has one role"))
            }
            (role, _) => Ok(role.map_or(ShapeRole::Plain, |(_, role)| *role)),
        }
    }
}

/// Two parameters that take the range of a potential, or of what flows through a Series element.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeParameters {
    /// Potential or through variable, by its name in the effect.
    pub of: String,
    /// The range is that of the potential's rate.
    pub rate: bool,
    /// Parameter for the least value.
    pub least: String,
    /// Parameter for the greatest value.
    pub most: String,
}

/// One effect of the library.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectModel {
    /// Full name of its class.
    pub class: String,
    /// Its family.
    pub family: String,
    /// Its number in the list of effects; empty if it has none.
    pub id: String,
    /// What it does, in words: the description of its class.
    pub description: String,
    /// How it attaches.
    pub interface: EffectInterface,
    /// Linear parameters; at least one.
    pub coefficients: Vec<EffectCoefficient>,
    /// Nonlinear parameters.
    pub shapes: Vec<ShapeParameter>,
    /// Parameters that take the value of a parameter of the component with the same unit.
    pub base: Vec<NamedQuantity>,
    /// Parameters that take the range of a variable; `None` if there are none.
    pub range: Option<RangeParameters>,
    /// Parameter for the ambient pressure, which is 0 where the model counts pressures from there; `None` if there is
    /// none.
    pub surroundings: Option<String>,
    /// Effects of one group are also tried together, with one set of coefficients.
    pub group: Option<String>,
    /// The law of which it is a form. Only one form of a law is accepted at a place.
    pub law: Option<String>,
    /// A Bridge only between nodes of which neither is given; another effect of the family covers those.
    pub free_ends: bool,
    /// A Bridge that is tried in both directions.
    pub directed: bool,
    /// An effect on a command that may also act on a measured input.
    pub measured: bool,
    /// It is not tried where an effect of its family fits with this kind of attachment.
    pub without: Option<AttachmentKind>,
    /// Number of states of its own.
    pub states: usize,
    /// It reads the time derivative of a potential.
    pub needs_rate: bool,
    /// It reads the second time derivative of a potential.
    pub needs_acceleration: bool,
}

/// Family of sources without a form. They are no hypotheses: `capacity` uses those at nodes as test flows.
const DISTURBANCE: &str = "disturbance";
/// Family of shapes. They compete with effects; where a shape wins, no known effect explains the gap.
const SHAPE: &str = "shape";

impl EffectModel {
    /// Whether it is a shape without a physical name.
    pub fn is_shape(&self) -> bool {
        self.family == SHAPE
    }
}

/// All effects, in the order of their packages: what is common on machines comes first.
#[derive(Clone, Debug)]
pub struct EffectCatalogue {
    /// Effects and shapes.
    pub effects: Vec<Arc<EffectModel>>,
    /// Shipped disturbance sources, one for each kind of place.
    pub disturbances: Vec<Arc<EffectModel>>,
}

/// Reads the shipped effects and those of a folder. Effects that cannot be used are left out with a diagnostic.
pub fn catalogue(world: &dyn World, folder: Option<&Path>) -> CompileOutcome<EffectCatalogue> {
    let CompileOutcome { sources, diagnostics, value } = everything(world, folder);
    let parted = |all: Vec<Arc<EffectModel>>| {
        let (mut disturbances, effects): (Vec<_>, Vec<_>) = all.into_iter().partition(|e| e.family == DISTURBANCE);
        disturbances.retain(|d| d.class.starts_with("Effects."));
        EffectCatalogue { effects, disturbances }
    };
    CompileOutcome { sources, diagnostics, value: value.map(parted) }
}

/// Reads all effects, disturbances included.
fn everything(world: &dyn World, folder: Option<&Path>) -> CompileOutcome<Vec<Arc<EffectModel>>> {
    let mut reader = CatalogueReader::default();
    reader.folder(&ShippedWorld, Path::new("components/Effects"), "Effects");
    if let Some(folder) = folder {
        // the shipped effects come first, so that they keep their order among the hypotheses
        let package = world.read(&folder.join("package.mo")).is_ok();
        // a folder with `package.mo` is a package of its own name, any other one a loose set of classes
        let prefix = folder.file_name().filter(|_| package).map(|n| n.to_string_lossy().into_owned());
        reader.folder(world, folder, prefix.as_deref().unwrap_or(""));
    }
    reader.finish(world, folder)
}

/// A class found in the folders.
struct EffectClass {
    /// Full name.
    class: String,
    /// Its description string.
    description: String,
    /// It is partial, so that it is an interface or base only.
    partial: bool,
    /// Names of its base classes as written.
    extends: Vec<String>,
    /// Content of its vendor annotation.
    annotation: Modification,
}

/// Reader of the folders.
#[derive(Default)]
struct CatalogueReader {
    /// Classes by full name.
    classes: BTreeMap<String, EffectClass>,
    /// Full names in the order of reading.
    order: Vec<String>,
    /// Effects that cannot be used.
    diagnostics: Vec<Diagnostic>,
}

impl CatalogueReader {
    /// Reads a folder and its subfolders. `prefix`: full name of the package around.
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

    /// Adds a class and the classes inside it. `package`: it stands in a `package.mo`, whose name is that of the
    /// folder.
    fn class(&mut self, class: &ast::Class, prefix: &str, package: bool) {
        let ClassBody::Long(body) = &class.body else { return };
        let full = if package { prefix.to_string() } else { joined(prefix, class.name.name.as_str()) };
        for e in &body.elements {
            // effects may be nested in a class that is itself a package
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

    /// The interface that a class is or extends, directly or through bases: the class with an `attach` annotation.
    fn interface<'a>(&'a self, class: &'a EffectClass) -> Option<&'a EffectClass> {
        if argument(&class.annotation, "attach").is_some() {
            return Some(class);
        }
        class.extends.iter().find_map(|base| self.interface(self.resolve(&class.class, base)?))
    }

    /// The class that `name` means inside class `from`: looked up in the packages around, from inside out.
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

    /// Flattens the effects and reads their attributes.
    fn finish(mut self, world: &dyn World, folder: Option<&Path>) -> CompileOutcome<Vec<Arc<EffectModel>>> {
        // abstract classes and helper models have no family and are no effects
        let wanted: Vec<(&EffectClass, &EffectClass)> = self
            .order
            .iter()
            .filter_map(|name| self.classes.get(name))
            .filter(|f| !f.partial && argument(&f.annotation, "family").is_some())
            .filter_map(|f| Some((f, self.interface(f)?)))
            .collect();
        let names: Vec<&str> = wanted.iter().map(|(f, _)| f.class.as_str()).collect();
        let CompileOutcome { sources, diagnostics, value } = flatten_all(world, folder, &names);
        // one compilation of all effects instead of one for each
        let Some(flat) = value else { return CompileOutcome { sources, diagnostics, value: None } };
        let read = EffectAttributes::of(&flat);
        let mut effects = Vec::new();
        let mut bad = Vec::new();
        for (number, (found, interface)) in wanted.iter().enumerate() {
            match effect(found, interface, &read, number) {
                Ok(e) => effects.push(Arc::new(e)),
                // one unusable effect of the user must not prevent the diagnosis
                Err(why) => bad.push(unusable(&found.class, &why)),
            }
        }
        self.diagnostics.extend(bad);
        CompileOutcome { sources, diagnostics: self.diagnostics, value: Some(effects) }
    }
}

/// Entries of a folder and whether each is a folder, in the order of `package.order`.
/// Entries not listed there come last, by name.
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

/// Diagnostic for an effect that cannot be used.
fn unusable(class: &str, why: &str) -> Diagnostic {
    Diagnostic::new(Code::BadModel, format!("`{class}` cannot be used as an effect: {why}"))
        .help("an effect extends one of `Effects.Interfaces` and carries `annotation(__bramah(family = \"...\", coefficients = {\"...\"}))`")
}

/// Flattens one model that holds every effect once, named `e0`, `e1`, ...
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

/// Makes the classes of the user's folder known to a request.
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
    /// The flat catalogue.
    flat: &'a FlatModel,
    /// Variables by name.
    index: BTreeMap<&'a str, &'a FlatVariable>,
    /// Names of variables whose derivative occurs.
    differentiated: BTreeSet<String>,
    /// Variables that are defined as the derivative of another.
    rate_of: BTreeMap<String, String>,
}

impl<'a> EffectAttributes<'a> {
    /// Reads the equations of the flat catalogue.
    fn of(flat: &'a FlatModel) -> Self {
        let name = |v: bramah_expr::VarId| flat.variables[v.index()].name.clone();
        let mut differentiated = BTreeSet::new();
        let mut rate_of = BTreeMap::new();
        for e in &flat.equations {
            for side in [e.lhs, e.rhs] {
                // derivatives in any position count, `rate_of` only in `v = der(x)`
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

    /// A variable of the effect of this number.
    ///
    /// # Errors
    /// The effect has no such variable.
    fn variable(&self, number: usize, name: &str) -> Result<&'a FlatVariable, String> {
        self.index.get(format!("e{number}.{name}").as_str()).copied().ok_or_else(|| format!("it has no `{name}`"))
    }

    /// A variable of an effect with its unit.
    fn quantity(&self, number: usize, name: &str) -> Result<NamedQuantity, String> {
        let unit = self.variable(number, name)?.unit.as_deref().unwrap_or("").to_string();
        Ok(NamedQuantity { name: name.to_string(), unit })
    }

    /// Value of an expression that is a number.
    fn number(&self, e: Option<ExprId>) -> Option<f64> {
        e.and_then(|e| self.flat.exprs.as_num(e))
    }
}

/// Reads one effect from its class, its interface and the flat catalogue.
///
/// # Errors
/// What is wrong with its annotation.
fn effect(
    found: &EffectClass,
    interface: &EffectClass,
    read: &EffectAttributes<'_>,
    number: usize,
) -> Result<EffectModel, String> {
    let own = &found.annotation;
    let interface = interface_of(&interface.annotation, own, read, number)?;
    let relative: BTreeSet<String> = texts(own, "relative").into_iter().collect();
    // flags of the annotation are texts: present means true
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

/// Reads the annotation `range`: a variable and two parameters.
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

/// Finds which derivatives of potentials an effect uses, and counts its own states.
fn rates(effect: &mut EffectModel, read: &EffectAttributes<'_>, number: usize) {
    let prefix = format!("e{number}.");
    let potentials: BTreeSet<String> = effect
        .interface
        .potential
        .iter()
        .chain(&effect.interface.sense)
        .map(|q| format!("{prefix}{}", q.name))
        .collect();
    // a derivative of anything but a potential is a state of the effect
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

/// The interface that a class is or extends, directly or through bases: the class with an `attach` annotation.
/// `None` for a class that extends no interface, which is then no effect.
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

/// Kind of attachment by its name.
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

/// Reads the annotation `coefficients`, a list of parameter names. Bounds, unit and typical size are those of the
/// parameters; the off value is their binding.
///
/// # Errors
/// The list is empty, or a parameter is missing or has no `nominal`.
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
        // without a typical size there is no scale for the fit
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

/// Reads the annotation `shapes(name = {values}, ...)`. Bounds and unit are those of the parameters; the keys of
/// [`ShapeRole`] are lists of names.
///
/// # Errors
/// A grid is no list of numbers, a parameter is missing, or it has two roles.
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
        let role = ShapeRole::of(&name, own)?;
        let relative = relative.contains(&name);
        let unit = unit.to_string();
        Ok(ShapeParameter { unit, grid, min, max, occurs: None, relative, role, name })
    };
    list.arguments.iter().map(one).collect()
}

/// Content of `__bramah(...)`.
fn vendor(annotation: Option<&Modification>) -> Option<&Modification> {
    match &argument(annotation?, "__bramah")?.kind {
        ModificationArgumentKind::Modify { modification, .. } => modification.as_ref(),
        _ => None,
    }
}

/// Argument of a modification by name.
fn argument<'a>(modification: &'a Modification, name: &str) -> Option<&'a ModificationArgument> {
    modification.arguments.iter().find(|a| match &a.kind {
        ModificationArgumentKind::Modify { path, .. } => path.parts.len() == 1 && path.parts[0].name == name,
        _ => false,
    })
}

/// Value of an argument.
fn value<'a>(modification: &'a Modification, name: &str) -> Option<&'a Expr> {
    match &argument(modification, name)?.kind {
        ModificationArgumentKind::Modify { modification: Some(m), .. } => m.value.as_ref(),
        _ => None,
    }
}

/// Text of an argument.
fn text(modification: &Modification, name: &str) -> Option<String> {
    match &value(modification, name)?.kind {
        ExprKind::String(s) => Some(s.to_string()),
        _ => None,
    }
}

/// Texts of an argument that is a list; empty if it is none.
fn texts(modification: &Modification, name: &str) -> Vec<String> {
    let Some(ExprKind::Array(items)) = value(modification, name).map(|v| &v.kind) else { return Vec::new() };
    let string = |e: &Expr| if let ExprKind::String(s) = &e.kind { Some(s.to_string()) } else { None };
    items.iter().filter_map(string).collect()
}

/// Full name of a class in a package.
fn joined(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_string() } else { format!("{prefix}.{name}") }
}
