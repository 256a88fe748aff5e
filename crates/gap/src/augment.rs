//! Writes the nominal model with effects attached, as Modelica text.
//!
//! Enters: the topology, attached hypotheses with values, and the signals. Leaves: an [`AugmentedModel`], which
//! `problem` compiles like any other model. The text is a model `Augmented` around an instance `plant` of the nominal
//! class. Inputs pass through the effects of commands before they reach the plant. Each signal of the study is a
//! variable of its name behind its sensor effects. Inside the plant every node that an effect touches gets one tap of
//! the node's own connector class.

use super::circuit::{CircuitTopology, ModelInput, SignalLink};
use super::effects::{EffectModel, own_classes};
use super::hypotheses::{AttachmentSite, EffectAttachment, Hypothesis, SensorSignal};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::units::MeasurementUnit;
use bramah_model::compile::{CompileOutcome, Request};
use bramah_model::flat::ScalarType;
use bramah_model::instance::Override;
use bramah_solve::lower;
use bramah_syntax::world::{MemoryWorld, Overlay, World};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Instance name of the nominal model inside the augmented one: `pump.w` becomes `plant.pump.w`.
pub const PLANT: &str = "plant";

/// Path under which the text is compiled.
pub(super) const SOURCE: &str = "(gap)/Augmented.mo";

/// Most terms in one sum: the parser limits the depth of expressions.
const LONGEST_SUM: usize = 100;

/// A hypothesis with an instance name and values.
#[derive(Clone, Debug)]
pub struct HypothesisInstance<'a> {
    /// Its name in the augmented model: a Modelica identifier of its own.
    pub name: String,
    /// What is attached. Hypotheses of family `parameter` add nothing: their parameter exists already.
    pub hypothesis: &'a Hypothesis,
    /// Values of coefficients and shapes by label. Coefficients not named are off, shapes take the first value of their
    /// grid.
    pub values: Vec<(String, f64)>,
}

/// The augmented model.
#[derive(Clone, Debug, PartialEq)]
pub struct AugmentedModel {
    /// Text of the model `Augmented`.
    pub text: String,
    /// Per attached hypothesis the names of its coefficients, then shapes, as parameters of the model; for a parameter
    /// out of tolerance the name of that parameter.
    pub parameters: Vec<Vec<String>>,
    /// Variable of each signal of the study, sensor effects included.
    pub signals: Vec<String>,
    /// Signals inside the nominal model whose statements the text replaces.
    pub replaced: Vec<SignalLink>,
}

/// Form in which the model is written.
#[derive(Clone, Debug)]
pub(super) struct AugmentationForm<'a> {
    /// Name of its class.
    pub class: &'a str,
    /// The nominal class is a copy from which cut connections are already removed, so that the text needs no `break`.
    pub cut: bool,
    /// Parameters of the nominal model with other values.
    pub drifts: &'a [(String, f64)],
    /// Text of the annotation before `end`.
    pub annotation: String,
}

/// Writes the nominal model with hypotheses attached. Coefficients and shapes become parameters of the text, so that
/// their values can change without compiling again.
pub fn augment(
    circuit: &CircuitTopology,
    attached: &[HypothesisInstance<'_>],
    signals: &[SensorSignal],
) -> AugmentedModel {
    written(
        circuit,
        attached,
        signals,
        AugmentationForm { class: "Augmented", cut: false, drifts: &[], annotation: String::new() },
    )
}

/// Writes it in a given form.
pub(super) fn written(
    circuit: &CircuitTopology,
    attached: &[HypothesisInstance<'_>],
    signals: &[SensorSignal],
    form: AugmentationForm<'_>,
) -> AugmentedModel {
    AugmentationWriter {
        circuit,
        form,
        plant: AugmentedClassBody::default(),
        around: AugmentedClassBody::default(),
        taps: BTreeMap::new(),
        drops: BTreeMap::new(),
        cut: BTreeSet::new(),
        classes: Vec::new(),
        replaced: Vec::new(),
    }
    .write(attached, signals)
}

/// Compiles an augmented model to a model that can be run.
/// Classes of the nominal model come from where `nominal` finds them; `folder` holds effects of the user's own.
pub fn compile(
    world: &dyn World,
    nominal: &Request,
    folder: Option<&Path>,
    augmented: &AugmentedModel,
    options: &lower::LoweringOptions,
) -> CompileOutcome<CompiledModel> {
    let (overlay, request) = request(world, nominal, folder, augmented, "Augmented");
    bramah_circuit::compiled::compile(&overlay, &request, options)
}

/// A world with the text in it and without the statements that it replaces, and the request for its class.
pub(super) fn request<'a>(
    world: &'a dyn World,
    nominal: &Request,
    folder: Option<&Path>,
    augmented: &AugmentedModel,
    class: &str,
) -> (Overlay<'a>, Request) {
    let source = PathBuf::from(SOURCE);
    let mut files = MemoryWorld::single(&source, &augmented.text);
    for link in &augmented.replaced {
        let Ok(mut text) = files.read(&link.file).or_else(|_| world.read(&link.file)) else { continue };
        let Range { start, end } = link.statement;
        // the semicolon behind the statement would stand alone; blanks keep every other statement at its position
        let Some(end) = text.get(end..).and_then(|rest| rest.find(';')).map(|i| end + i + 1) else { continue };
        let blank: String = text[start..end].bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }).collect();
        text.replace_range(start..end, &blank);
        files.add(&link.file, text);
    }
    let overlay = Overlay { base: world, files };
    // values that the study sets in the nominal model belong to the instance `plant`
    let inner = |o: &Override| Override { name: format!("{PLANT}.{}", o.name), value: o.value.clone() };
    let mut request = Request {
        source,
        model: Some(class.into()),
        overrides: nominal.overrides.iter().map(inner).collect(),
        libraries: nominal.libraries.clone(),
        beside: nominal.beside.clone(),
        data_folder: Some(nominal.data_folder(world)),
        externals: nominal.externals.clone(),
        varied: true,
    };
    if world.list(&nominal.source).is_some() || world.read(&nominal.source).is_ok() {
        request.beside.push(nominal.source.clone());
    }
    own_classes(world, folder, &mut request);
    (overlay, request)
}

/// Declarations and equations of one class, as text.
#[derive(Default)]
struct AugmentedClassBody {
    /// Lines before `equation`.
    declarations: String,
    /// Lines behind `equation`.
    equations: String,
}

/// Writer of an augmented model. Ports and nodes are numbers of the topology.
struct AugmentationWriter<'a> {
    /// Topology of the nominal model.
    circuit: &'a CircuitTopology,
    /// Form of the text.
    form: AugmentationForm<'a>,
    /// Body of the class around the nominal one, inside the instance `plant`.
    plant: AugmentedClassBody,
    /// Body of the augmented class itself.
    around: AugmentedClassBody,
    /// Per node with a tap the terms that are drawn from it.
    taps: BTreeMap<usize, Vec<String>>,
    /// Per cut port the differences of potential of its Series elements.
    drops: BTreeMap<usize, Vec<String>>,
    /// Ports that Series elements take out of their nodes.
    cut: BTreeSet<usize>,
    /// Connector classes that have a tap class, each with a port as an example.
    classes: Vec<(&'a str, usize)>,
    /// Signals whose statements are replaced.
    replaced: Vec<SignalLink>,
}

/// Instance name of a hypothesis at the i-th of its places.
pub(super) fn instance(name: &str, i: usize) -> String {
    format!("{name}_{}", i + 1)
}

impl<'a> AugmentationWriter<'a> {
    /// Writes the model: parameters, effects at nodes and in connections, then inputs, signals inside the model and
    /// sensors.
    fn write(mut self, attached: &[HypothesisInstance<'_>], signals: &[SensorSignal]) -> AugmentedModel {
        let parameters = attached.iter().map(|a| self.parameters(a)).collect();
        self.cut = cut(attached);
        // before any tap, so that a node is one again without its cut ports
        self.rejoin();
        for a in attached {
            for (i, at) in a.hypothesis.attachments.iter().enumerate() {
                match (&at.effect, &at.site) {
                    (Some(effect), AttachmentSite::Node(_) | AttachmentSite::Across(..)) => {
                        self.physical(a, i, at, effect)
                    }
                    (Some(effect), AttachmentSite::Into(port)) => self.series(a, i, at, effect, *port),
                    _ => {}
                }
            }
        }
        self.inputs(attached);
        self.links(attached);
        let signals = self.signals(attached, signals);
        // when all effects are known: sums of what falls and of what is drawn
        self.fall();
        self.draw();
        AugmentedModel { text: self.text(), parameters, signals, replaced: self.replaced }
    }

    /// Declares the coefficients and shapes of a hypothesis and returns their full names.
    /// A parameter out of tolerance exists already; only its name is returned.
    fn parameters(&mut self, a: &HypothesisInstance<'_>) -> Vec<String> {
        let h = a.hypothesis;
        if let AttachmentSite::Parameter(name) = &h.attachments[0].site {
            return vec![format!("{PLANT}.{name}")];
        }
        // parameters stand where their effect stands: inside the plant for nodes and for signals inside the model
        let inside = match &h.attachments[0].site {
            AttachmentSite::Command(name) => self.circuit.link(name).is_some(),
            site => matches!(site, AttachmentSite::Node(_) | AttachmentSite::Across(..) | AttachmentSite::Into(_)),
        };
        let body = if inside { &mut self.plant } else { &mut self.around };
        let given = |name: &str| a.values.iter().find(|(n, _)| n == name).map(|(_, v)| *v);
        let coefficients = h.coefficients.iter().map(|c| (c.label(), &c.unit, c.off));
        let shapes = h.shapes.iter().map(|s| (s.name.clone(), &s.unit, s.grid[0]));
        let mut names = Vec::new();
        for (name, unit, usual) in coefficients.chain(shapes) {
            let value = given(&name).unwrap_or(usual);
            let full = format!("{}_{name}", a.name);
            let _ = writeln!(body.declarations, "    parameter Real {full}{} = {value:e};", unit_of(unit));
            names.push(if inside { format!("{PLANT}.{full}") } else { full });
        }
        names
    }

    /// Name and declaration of an effect instance whose parameters are bound to those of the hypothesis.
    /// `base`: further parameters with the expressions that they take.
    fn declaration(
        a: &HypothesisInstance<'_>,
        i: usize,
        effect: &EffectModel,
        base: &[(String, String)],
    ) -> (String, String) {
        let instance = instance(&a.name, i);
        // a coefficient per recording is the sum of all, of which only one acts in each recording
        let of_all = |name: &str| {
            let own = a.hypothesis.coefficients.iter().filter(|c| c.name == name);
            own.map(|c| format!("{}_{}", a.name, c.label())).collect::<Vec<_>>().join(" + ")
        };
        let coefficients = effect.coefficients.iter().map(|c| format!("{} = {}", c.name, of_all(&c.name)));
        let shapes = effect.shapes.iter().map(|s| format!("{n} = {}_{n}", a.name, n = s.name));
        let bound: Vec<String> =
            coefficients.chain(shapes).chain(base.iter().map(|(n, from)| format!("{n} = {from}"))).collect();
        let text = format!("    .{} {instance}({});\n", effect.class, bound.join(", "));
        (instance, text)
    }

    /// Attaches an effect to one or two nodes: it reads their potentials and draws its through variable from them.
    fn physical(&mut self, a: &HypothesisInstance<'_>, i: usize, at: &EffectAttachment, effect: &EffectModel) {
        let (instance, declaration) = Self::declaration(a, i, effect, &at.base);
        self.plant.declarations.push_str(&declaration);
        let ports: &[usize] = match &at.site {
            AttachmentSite::Node(p) => &[*p],
            AttachmentSite::Across(x, y) => &[*x, *y],
            _ => &[],
        };
        let Some(through) = &effect.interface.through else { return };
        // what leaves the first node enters the second one
        let signs = ["", "-"];
        for ((port, potential), sign) in ports.iter().zip(&effect.interface.potential).zip(signs) {
            let tap = self.tap(*port);
            self.read(&instance, &potential.name, &tap, *port);
            let factor = factor(&self.circuit.ports[*port].through.unit);
            let share = format!("{sign}{instance}.{}{}", through.name, scaled("/", factor));
            self.taps.get_mut(&self.circuit.ports[*port].node).expect("just made").push(share);
        }
        for (port, potential) in at.sense.iter().zip(&effect.interface.sense) {
            let tap = self.tap(*port);
            self.read(&instance, &potential.name, &tap, *port);
        }
        self.warm(&instance, at, effect);
    }

    /// Gives an effect the temperature that it reads, in kelvin.
    fn warm(&mut self, instance: &str, at: &EffectAttachment, effect: &EffectModel) {
        if let (Some((input, offset)), Some(name)) = (&at.temperature, &effect.interface.temperature) {
            let _ = writeln!(self.plant.equations, "    {instance}.{name} = {input} + {offset:e};");
        }
    }

    /// Puts an effect between a cut port and the rest of its node; several effects there lie in series.
    /// The effect reads the flow through the port and gives a difference of potential.
    fn series(
        &mut self,
        a: &HypothesisInstance<'_>,
        i: usize,
        at: &EffectAttachment,
        effect: &EffectModel,
        port: usize,
    ) {
        let (Some(through), Some(drop)) = (&effect.interface.through, &effect.interface.drop) else { return };
        let (instance, declaration) = Self::declaration(a, i, effect, &at.base);
        self.plant.declarations.push_str(&declaration);
        self.open(port);
        let _ = writeln!(self.plant.equations, "    {instance}.{} = {};", through.name, through_of(port));
        self.warm(&instance, at, effect);
        self.drops.get_mut(&port).expect("just made").push(format!("{instance}.{}", drop.name));
    }

    /// Leads what flows through a cut port past the place of its Series elements. Does nothing the second time.
    /// The port gets a tap of its own (`far`), which draws the flow with the opposite sign of the node's tap.
    fn open(&mut self, port: usize) {
        if self.drops.contains_key(&port) {
            return;
        }
        self.drops.insert(port, Vec::new());
        let p = &self.circuit.ports[port];
        // the node gets a tap too, because it takes the flow of the cut port
        self.tap(port);
        let class = self.tap_class(port) + 1;
        let (far, through) = (far_of(port), through_of(port));
        let share = scaled("/", factor(&p.through.unit));
        let _ = write!(self.plant.declarations, "    GapTap_{class} {far};\n    Real {through};\n");
        let _ = write!(
            self.plant.equations,
            "    connect({far}.port, {});\n    {far}.drawn = -{through}{share};\n",
            p.name
        );
        self.taps.get_mut(&p.node).expect("just made").push(format!("{through}{share}"));
    }

    /// Writes the difference of potential where connections are cut: the sum of the drops of all elements there.
    fn fall(&mut self) {
        for (port, drops) in std::mem::take(&mut self.drops) {
            let v = &self.circuit.ports[port].potential;
            let (node, far) = (self.tap(port), far_of(port));
            let _ = writeln!(
                self.plant.equations,
                "    {node}.port.{v} - {far}.port.{v} = ({}){};",
                drops.join(" + "),
                scaled("/", factor(&v.unit)),
                v = v.name,
            );
        }
    }

    /// Connects what remains of a node when ports are taken out of it.
    fn rejoin(&mut self) {
        let cut_nodes: BTreeSet<usize> = self.cut.iter().map(|&p| self.circuit.ports[p].node).collect();
        for node in cut_nodes {
            let rest = self.circuit.nodes[node].ports.iter().copied().filter(|p| !self.cut.contains(p));
            // ports that no cut connection touches are still connected
            let touched = |p: &usize| self.broken().any(|(a, b)| a == *p || b == *p);
            let rest: Vec<&str> = rest.filter(touched).map(|p| self.circuit.ports[p].name.as_str()).collect();
            for pair in rest.windows(2) {
                let _ = writeln!(self.plant.equations, "    connect({}, {});", pair[0], pair[1]);
            }
        }
    }

    /// Connections that touch a cut port.
    fn broken(&self) -> impl Iterator<Item = (usize, usize)> {
        broken(self.circuit, &self.cut)
    }

    /// Gives an effect the potential of a port, in SI units. `tap`: name of the tap at the port's node.
    fn read(&mut self, instance: &str, potential: &str, tap: &str, port: usize) {
        // the port may use other units than SI, with an offset for temperatures
        let q = &self.circuit.ports[port].potential;
        let offset = MeasurementUnit::parse(&q.unit).map_or(0.0, |u| u.offset);
        let plus = if offset == 0.0 { String::new() } else { format!(" + {offset:e}") };
        let value = format!("{tap}.port.{}{}{plus}", q.name, scaled("*", factor(&q.unit)));
        let _ = writeln!(self.plant.equations, "    {instance}.{potential} = {value};");
    }

    /// Name of the tap at the node of a port; the tap is made at the first call.
    /// A tap is a component with one port of the node's connector class, and a flow `drawn`.
    fn tap(&mut self, port: usize) -> String {
        let circuit = self.circuit;
        let node = circuit.ports[port].node;
        let name = format!("gap_tap_{}", node + 1);
        if !self.taps.contains_key(&node) {
            // a port that stays in the node, as near to the top level as possible
            let first = nearest(circuit, node, &self.cut);
            let class = self.tap_class(first);
            let _ = writeln!(self.plant.declarations, "    GapTap_{} {name};", class + 1);
            let _ = writeln!(self.plant.equations, "    connect({name}.port, {});", circuit.ports[first].name);
            self.taps.insert(node, Vec::new());
        }
        name
    }

    /// Index of the tap class for the connector class of a port.
    fn tap_class(&mut self, port: usize) -> usize {
        let class = self.circuit.ports[port].class.as_str();
        self.classes.iter().position(|(c, _)| *c == class).unwrap_or_else(|| {
            self.classes.push((class, port));
            self.classes.len() - 1
        })
    }

    /// Writes the sum of all terms drawn from each node, in the units of the node's flow.
    fn draw(&mut self) {
        for (node, drawn) in &self.taps {
            let mut terms = vec![String::from("0")];
            // long sums are split into partial sums
            for (i, part) in drawn.chunks(LONGEST_SUM).enumerate() {
                let name = format!("gap_tap_{}_{}", node + 1, i + 1);
                let _ = writeln!(self.plant.declarations, "    Real {name};");
                let _ = writeln!(self.plant.equations, "    {name} = {};", sum(part));
                terms.push(name);
            }
            let sum = sum(&terms);
            let _ = writeln!(self.plant.equations, "    gap_tap_{}.drawn = {sum};", node + 1);
        }
    }

    /// Writes the inputs of the plant, each behind the effects on its command. The augmented model has the same inputs.
    fn inputs(&mut self, attached: &[HypothesisInstance<'_>]) {
        let mut arrays: Vec<&str> = Vec::new();
        for input in &self.circuit.inputs {
            let base = input.name.split('[').next().unwrap_or(&input.name);
            // an array is declared once, for its first element
            if !arrays.contains(&base) {
                arrays.push(base);
                self.around.declarations.push_str(&input_declaration(self.circuit, base, input));
            }
            let site = AttachmentSite::Command(input.name.clone());
            let last = chain(&mut self.around, attached, &site, input.name.clone());
            let _ = writeln!(self.around.equations, "  {PLANT}.{} = {last};", input.name);
        }
    }

    /// Writes the signals inside the plant on which effects act. Their original statements are listed for removal.
    fn links(&mut self, attached: &[HypothesisInstance<'_>]) {
        for link in &self.circuit.links {
            let name = &link.signal.name;
            let site = AttachmentSite::Command(name.clone());
            if !attached.iter().any(|a| a.hypothesis.attachments.iter().any(|at| at.site == site)) {
                continue;
            }
            let last = chain(&mut self.plant, attached, &site, link.value.clone());
            let _ = writeln!(self.plant.equations, "    {name} = {last};");
            self.replaced.push(link.clone());
        }
    }

    /// Writes the signals of the study behind the effects of their sensors and returns their names.
    fn signals(&mut self, attached: &[HypothesisInstance<'_>], signals: &[SensorSignal]) -> Vec<String> {
        let mut names = Vec::new();
        for (i, s) in signals.iter().enumerate() {
            let name = self.signal_name(&s.name);
            let unit = self.circuit.units.get(&s.variable).map_or(String::new(), |u| unit_of(u));
            let _ = writeln!(self.plant.declarations, "    Real gap_true_{}{unit};", i + 1);
            let _ = writeln!(self.plant.equations, "    gap_true_{} = {};", i + 1, s.variable);
            let (site, from) = (AttachmentSite::Sensor(s.name.clone()), format!("{PLANT}.gap_true_{}", i + 1));
            let last = chain(&mut self.around, attached, &site, from);
            let _ = writeln!(self.around.declarations, "  output Real {name}{unit};");
            let _ = writeln!(self.around.equations, "  {name} = {last};");
            names.push(name);
        }
        names
    }

    /// Identifier of a signal: its own name where that is free, quoted where it is no plain identifier.
    /// A name that the plant or an input has already gets a prefix.
    fn signal_name(&self, name: &str) -> String {
        let simple = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let taken = name == PLANT || self.circuit.inputs.iter().any(|i| i.name == name);
        match (simple, taken) {
            (true, false) => name.to_string(),
            (true, true) => format!("signal_{name}"),
            _ => format!("'{}'", name.replace(['\'', '\\'], "_")),
        }
    }

    /// The complete text.
    fn text(&self) -> String {
        let mut text = format!("model {}\n", self.form.class);
        for (i, (class, port)) in self.classes.iter().enumerate() {
            let through = &self.circuit.ports[*port].through.name;
            let _ = write!(
                text,
                "  model GapTap_{n} \"Draws from a node\"\n    .{class} port;\n    Real drawn;\n  equation\n    port.{through} = drawn;\n  end GapTap_{n};\n",
                n = i + 1
            );
        }
        let name = |p: usize| &self.circuit.ports[p].name;
        let broken: Vec<String> =
            self.broken().map(|(a, b)| format!("break connect({}, {})", name(a), name(b))).collect();
        // the class `Plant` extends the nominal class, so the cut connections must be excluded there
        let broken =
            if broken.is_empty() || self.form.cut { String::new() } else { format!("({})", broken.join(", ")) };
        let _ = writeln!(text, "  model Plant\n    extends .{}{broken};", self.circuit.class);
        let _ = write!(text, "{}  equation\n{}  end Plant;\n", self.plant.declarations, self.plant.equations);
        let drifts: Vec<String> = self.form.drifts.iter().map(|(n, v)| format!("{n} = {v:e}")).collect();
        let drifts = if drifts.is_empty() { String::new() } else { format!("({})", drifts.join(", ")) };
        let _ = writeln!(text, "  Plant {PLANT}{drifts};");
        let _ = write!(text, "{}equation\n{}", self.around.declarations, self.around.equations);
        let _ = writeln!(text, "{}end {};", self.form.annotation, self.form.class);
        text
    }
}

/// Puts all signal effects of a site in series behind the expression `from`; returns the output of the last one.
/// Without effects that is `from` itself.
fn chain(
    body: &mut AugmentedClassBody,
    attached: &[HypothesisInstance<'_>],
    site: &AttachmentSite,
    from: String,
) -> String {
    let mut last = from;
    for a in attached {
        for (i, at) in a.hypothesis.attachments.iter().enumerate().filter(|(_, at)| at.site == *site) {
            let Some(effect) = &at.effect else { continue };
            let (instance, declaration) = AugmentationWriter::declaration(a, i, effect, &at.base);
            body.declarations.push_str(&declaration);
            let _ = writeln!(body.equations, "    {instance}.u = {last};");
            last = format!("{instance}.y");
        }
    }
    last
}

/// Ports that Series elements take out of their nodes.
/// A set, since several elements may lie at one port.
pub(super) fn cut(attached: &[HypothesisInstance<'_>]) -> BTreeSet<usize> {
    let places = attached.iter().flat_map(|a| &a.hypothesis.attachments);
    places.filter_map(|at| if let AttachmentSite::Into(p) = at.site { Some(p) } else { None }).collect()
}

/// Connections that touch a cut port, as pairs of ports.
pub(super) fn broken(circuit: &CircuitTopology, cut: &BTreeSet<usize>) -> impl Iterator<Item = (usize, usize)> {
    let touches = |(a, b, _): &&(usize, usize, usize)| cut.contains(a) || cut.contains(b);
    circuit.connections.iter().filter(touches).map(|&(a, b, _)| (a, b))
}

/// A sum of terms, each with its sign.
fn sum(terms: &[String]) -> String {
    let mut text = String::new();
    for t in terms {
        match t.strip_prefix('-') {
            Some(rest) => text.push_str(&format!(" - {rest}")),
            None if text.is_empty() => text.push_str(t),
            None => text.push_str(&format!(" + {t}")),
        }
    }
    text.trim_start().to_string()
}

/// The port of a node that lies least deep in the hierarchy; a cut port only if there is no other.
fn nearest(circuit: &CircuitTopology, node: usize, cut: &BTreeSet<usize>) -> usize {
    let depth = |p: &usize| (cut.contains(p), circuit.ports[*p].name.matches('.').count());
    circuit.nodes[node].ports.iter().copied().min_by_key(depth).expect("a node has ports")
}

/// Unit modifier of a declaration; empty without a unit.
fn unit_of(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!("(unit = \"{unit}\")") }
}

/// Factor from a unit to its SI unit; 1 for unknown units.
fn factor(unit: &str) -> f64 {
    MeasurementUnit::parse(unit).map_or(1.0, |u| u.factor())
}

/// A factor with an operator in front; empty for 1.
fn scaled(operator: &str, factor: f64) -> String {
    if factor == 1.0 { String::new() } else { format!("{operator}{factor:e}") }
}

/// Name of the tap behind a cut port.
fn far_of(port: usize) -> String {
    format!("gap_far_{}", port + 1)
}

/// Name of the variable for the flow through a cut port.
fn through_of(port: usize) -> String {
    format!("gap_through_{}", port + 1)
}

/// Declaration of an input with its type, unit and start. An array is declared with all its elements.
/// `base`: name without indices; the sizes follow from the largest indices that occur.
fn input_declaration(circuit: &CircuitTopology, base: &str, input: &ModelInput) -> String {
    let ty = match input.ty {
        ScalarType::Integer => "Integer",
        ScalarType::Boolean => "Boolean",
        _ => "Real",
    };
    let mut sizes: Vec<usize> = Vec::new();
    for other in circuit.inputs.iter().filter(|i| i.name.split('[').next() == Some(base)) {
        let Some(indices) = other.name.strip_prefix(base).and_then(|r| r.strip_prefix('[')) else { continue };
        let indices = indices.trim_end_matches(']').split(',').filter_map(|i| i.trim().parse::<usize>().ok());
        for (k, n) in indices.enumerate() {
            if k < sizes.len() { sizes[k] = sizes[k].max(n) } else { sizes.push(n) }
        }
    }
    let each = if sizes.is_empty() { "" } else { "each " };
    let mut attributes = Vec::new();
    if !input.unit.is_empty() {
        attributes.push(format!("{each}unit = \"{}\"", input.unit));
    }
    if let Some(start) = input.start {
        let value = if input.ty == ScalarType::Boolean { (start != 0.0).to_string() } else { start.to_string() };
        attributes.push(format!("{each}start = {value}"));
    }
    if let Some(nominal) = input.nominal.filter(|_| input.ty == ScalarType::Real) {
        attributes.push(format!("{each}nominal = {nominal:e}"));
    }
    let list = if attributes.is_empty() { String::new() } else { format!("({})", attributes.join(", ")) };
    let sizes: Vec<String> = sizes.iter().map(usize::to_string).collect();
    let sizes = if sizes.is_empty() { String::new() } else { format!("[{}]", sizes.join(", ")) };
    format!("  input {ty} {base}{sizes}{list};\n")
}
