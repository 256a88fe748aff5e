//! The network writes the hypotheses: every effect at every place where its ports and units fit.

use super::circuit::{CircuitTopology, NamedQuantity, PhysicalPort, same_kind};
use super::effects::{AttachmentKind, EffectCoefficient, EffectModel, ShapeParameter};
use bramah_analysis::study::EffectChoice;
use bramah_model::flat::ScalarType;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Orders nearer than this are the same.
const SAME_ORDER: f64 = 0.5;

/// A signal of the study: what a sensor recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSignal {
    /// Its name in study and verdict.
    pub name: String,
    /// The model's variable.
    pub variable: String,
    /// Its full scale in SI units, for typical sizes of sensor effects.
    pub scale: f64,
}

/// A parameter that may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainParameter {
    /// Full name.
    pub name: String,
    /// Value of the nominal model.
    pub nominal: f64,
    /// Tolerance, one standard deviation in the parameter's unit.
    pub sigma: f64,
}

/// What is missing at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the words of the verdict")]
pub enum MissingQuantity {
    Force,
    Torque,
    Flow,
    Current,
    Voltage,
    Heat,
    Signal,
    Sensor,
    Parameter,
}

impl MissingQuantity {
    /// The word of the verdict.
    pub fn word(self) -> &'static str {
        match self {
            MissingQuantity::Force => "force",
            MissingQuantity::Torque => "torque",
            MissingQuantity::Flow => "flow",
            MissingQuantity::Current => "current",
            MissingQuantity::Voltage => "voltage",
            MissingQuantity::Heat => "heat",
            MissingQuantity::Signal => "signal",
            MissingQuantity::Sensor => "sensor",
            MissingQuantity::Parameter => "parameter",
        }
    }

    /// By the unit of a through variable.
    fn of(unit: &str) -> MissingQuantity {
        let flows = [
            ("m3/s", MissingQuantity::Flow),
            ("kg/s", MissingQuantity::Flow),
            ("A", MissingQuantity::Current),
            ("W", MissingQuantity::Heat),
        ];
        let known = [("N", MissingQuantity::Force), ("N.m", MissingQuantity::Torque)].into_iter().chain(flows);
        known.into_iter().find(|(u, _)| same_kind(u, unit)).map_or(MissingQuantity::Signal, |(_, k)| k)
    }
}

/// A place of the network as the verdict names it.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkLocation {
    /// Its name.
    pub place: String,
    /// Everything that is the same place: ports of the node, parallel bridges.
    pub node: Vec<String>,
    /// What is missing there.
    pub kind: MissingQuantity,
}

/// Where an effect is tied to the model; numbers are those of [`CircuitTopology::ports`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AttachmentSite {
    /// A node, by its first port.
    Node(usize),
    /// From a port to another.
    Across(usize, usize),
    /// Into a connection: from a port to the rest of its node.
    Into(usize),
    /// A signal of the study.
    Sensor(String),
    /// An input.
    Command(String),
    /// A parameter.
    Parameter(String),
}

impl AttachmentSite {
    /// Whether two effects act at one place; which way they point does not count.
    pub fn is_at(&self, other: &AttachmentSite) -> bool {
        match (self, other) {
            (AttachmentSite::Across(a, b), AttachmentSite::Across(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
            _ => self == other,
        }
    }

    /// Ports of the nodes on which it acts and whose potential is not given.
    pub fn free_ports(&self, circuit: &CircuitTopology) -> Vec<usize> {
        let ports = match self {
            AttachmentSite::Node(p) | AttachmentSite::Into(p) => vec![*p],
            AttachmentSite::Across(a, b) => vec![*a, *b],
            AttachmentSite::Sensor(_) | AttachmentSite::Command(_) | AttachmentSite::Parameter(_) => Vec::new(),
        };
        ports.into_iter().filter(|p| !circuit.nodes[circuit.ports[*p].node].fixed).collect()
    }

    /// Whether two effects act on one node, or on two that are bound to each other.
    pub fn meets(&self, other: &AttachmentSite, circuit: &CircuitTopology) -> bool {
        let nodes =
            |site: &AttachmentSite| site.free_ports(circuit).into_iter().map(|p| circuit.geared(p)).collect::<Vec<_>>();
        let own = nodes(self);
        nodes(other).iter().any(|n| own.contains(n))
    }
}

/// One effect at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectAttachment {
    /// The effect; `None` for a parameter.
    pub effect: Option<Arc<EffectModel>>,
    /// Where.
    pub site: AttachmentSite,
    /// Ports whose potentials are read beside.
    pub sense: Vec<usize>,
    /// Parameters of the effect that take the value of a parameter of the model, by full name, or a number.
    pub base: Vec<(String, String)>,
    /// The input that is the temperature, with the offset that makes kelvins of it.
    pub temperature: Option<(String, f64)>,
    /// The place in words.
    pub place: NetworkLocation,
}

/// How far one set of coefficients reaches.
#[derive(Clone, Debug, PartialEq)]
pub enum CoefficientSharing {
    /// One place.
    Single,
    /// All instances of a class.
    Class(String),
    /// All places where the effect fits.
    All,
}

/// One explanation that the network offers.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Class of the effect, of the first one in a group; `Drift` for a parameter.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Where it acts.
    pub attachments: Vec<EffectAttachment>,
    /// One place or several with the same coefficients.
    pub sharing: CoefficientSharing,
    /// Linear parameters, typical sizes in SI units.
    pub coefficients: Vec<EffectCoefficient>,
    /// Nonlinear parameters, grids in SI units.
    pub shapes: Vec<ShapeParameter>,
    /// The order of the model changes with it (it needs a rate that the model does not have, or stands inside a connection),
    /// so that it cannot be linearised at its off value together with the others. States of its own beside are none.
    pub changes_order: bool,
    /// Usual size of the signal that passes through it, SI; its own states are of that size. Nothing at a node.
    pub passes: Option<f64>,
}

impl Hypothesis {
    /// The places in words.
    pub fn places(&self) -> Vec<&NetworkLocation> {
        self.attachments.iter().map(|a| &a.place).collect()
    }

    /// Whether it only says what shape a gap has that no effect explains.
    pub fn is_shape(&self) -> bool {
        self.attachments[0].effect.as_ref().is_some_and(|e| e.is_shape())
    }

    /// Whether it is a mistake of the recording, not of the model.
    pub fn is_recording_error(&self) -> bool {
        self.family == super::mistakes::FAMILY
    }

    /// The law whose form it is: of the forms of one law, one is at a place.
    pub fn law(&self) -> &str {
        let effect = self.attachments[0].effect.as_ref();
        effect.and_then(|e| e.law.as_deref()).unwrap_or(&self.effect)
    }

    /// Whether it is the same with these values as with others: an effect of an order may come again with another one.
    pub fn same(&self, values: &[f64], by: &[f64]) -> bool {
        let order = self.shapes.iter().position(|s| s.order).map(|k| self.coefficients.len() + k);
        order.is_none_or(|k| (values[k] - by[k]).abs() < SAME_ORDER)
    }

    /// Combinations of the grids of all shapes, the first shape varying slowest; one empty one without shapes.
    pub fn variants(&self) -> Vec<Vec<(String, f64)>> {
        let mut all = vec![Vec::new()];
        for shape in &self.shapes {
            let longer = |v: Vec<(String, f64)>| {
                let with = move |x: &f64| v.iter().cloned().chain([(shape.name.clone(), *x)]).collect();
                shape.grid.iter().map(with).collect::<Vec<_>>()
            };
            all = all.into_iter().flat_map(longer).collect();
        }
        all
    }
}

/// Every effect at every place, each shared at all alike, and every free parameter.
///
/// The order is that of the effects, then of the places in declaration order, single places before shared ones.
pub fn hypotheses(
    circuit: &CircuitTopology,
    effects: &[Arc<EffectModel>],
    signals: &[SensorSignal],
    free: &[UncertainParameter],
) -> Vec<Hypothesis> {
    let mut all = Vec::new();
    let mut groups: BTreeMap<&str, Vec<EffectAttachment>> = BTreeMap::new();
    for effect in effects {
        let candidates = candidates(circuit, effect, effects, signals);
        let single = merged(circuit, &candidates);
        if let Some(group) = &effect.group {
            groups.entry(group).or_default().extend(single.iter().cloned());
        }
        all.extend(single.iter().map(|a| hypothesis(circuit, vec![a.clone()], CoefficientSharing::Single, signals)));
        // one shape at several places is no shape
        let shared = if effect.is_shape() { Vec::new() } else { shared(circuit, effect, &candidates, &single) };
        all.extend(shared.into_iter().map(|(a, s)| hypothesis(circuit, a, s, signals)));
    }
    let groups = groups.into_values().filter(|g| g.iter().any(|a| a.effect != g[0].effect));
    all.extend(groups.map(|g| hypothesis(circuit, g, CoefficientSharing::All, signals)));
    all.extend(free.iter().map(drift));
    all
}

/// Leaves only what the study allows. Effects are named by class or family, places as the verdict names them.
pub fn narrow(all: &mut Vec<Hypothesis>, choice: &EffectChoice) {
    let named = |list: &[String], h: &Hypothesis| list.iter().any(|n| *n == h.effect || *n == h.family);
    let allowed = |p: &NetworkLocation| choice.places.iter().any(|n| p.node.contains(n) || *n == p.place);
    all.retain(|h| {
        let included = choice.include.is_empty() || named(&choice.include, h);
        let placed = choice.places.is_empty() || h.attachments.iter().all(|a| allowed(&a.place));
        included && placed && !named(&choice.exclude, h)
    });
}

/// Leaves out what only a command suffers at inputs that a sensor shows, and at what follows from them alone.
pub fn without_commands(all: &mut Vec<Hypothesis>, circuit: &CircuitTopology, measured: &[&str]) {
    let shown = |name: &String| {
        let is_measured = |n: &String| measured.contains(&n.as_str());
        is_measured(name)
            || circuit.link(name).is_some_and(|l| !l.inputs.is_empty() && l.inputs.iter().all(is_measured))
    };
    let fits = |a: &EffectAttachment| match (&a.site, &a.effect) {
        (AttachmentSite::Command(name), Some(effect)) => effect.measured || !shown(name),
        _ => true,
    };
    all.retain(|h| h.attachments.iter().all(fits));
}

/// An attachment before identical ones are merged, with its component and what is alike in other instances.
struct AttachmentCandidate {
    component: usize,
    alike: String,
    attachment: EffectAttachment,
}

fn candidates(
    circuit: &CircuitTopology,
    effect: &Arc<EffectModel>,
    all: &[Arc<EffectModel>],
    signals: &[SensorSignal],
) -> Vec<AttachmentCandidate> {
    if effect.without.is_some_and(|a| fits_somewhere(circuit, effect, a, all)) {
        return Vec::new();
    }
    match effect.interface.attach {
        AttachmentKind::Sensor => {
            signals.iter().map(|s| signal(effect, AttachmentSite::Sensor(s.name.clone()), &s.name)).collect()
        }
        AttachmentKind::Command => {
            // A recorded temperature is no command.
            let all = circuit.inputs.iter().chain(circuit.links.iter().map(|l| &l.signal));
            let real = all.filter(|i| i.ty == ScalarType::Real && !same_kind(&i.unit, "K"));
            real.map(|i| signal(effect, AttachmentSite::Command(i.name.clone()), &i.name)).collect()
        }
        AttachmentKind::Drift => Vec::new(),
        _ => {
            let components = 0..circuit.components.len();
            components
                .flat_map(|c| at_component(circuit, effect, c))
                .chain(without_component(circuit, effect))
                .flat_map(|c| completed(circuit, effect, c))
                .collect()
        }
    }
}

/// Whether an effect of the family fits by another interface.
fn fits_somewhere(
    circuit: &CircuitTopology,
    effect: &EffectModel,
    attach: AttachmentKind,
    all: &[Arc<EffectModel>],
) -> bool {
    let others = all.iter().filter(|e| e.family == effect.family && e.interface.attach == attach);
    others.into_iter().any(|e| (0..circuit.components.len()).any(|c| !at_component(circuit, e, c).is_empty()))
}

fn signal(effect: &Arc<EffectModel>, site: AttachmentSite, name: &str) -> AttachmentCandidate {
    let kind =
        if matches!(site, AttachmentSite::Sensor(_)) { MissingQuantity::Sensor } else { MissingQuantity::Signal };
    let place = NetworkLocation { place: name.into(), node: vec![name.into()], kind };
    let attachment =
        EffectAttachment { effect: Some(effect.clone()), site, sense: vec![], base: vec![], temperature: None, place };
    AttachmentCandidate { component: 0, alike: String::new(), attachment }
}

/// Sites of an effect at the ports of one component.
fn at_component(circuit: &CircuitTopology, effect: &Arc<EffectModel>, component: usize) -> Vec<AttachmentCandidate> {
    let fitting: Vec<usize> =
        circuit.components[component].ports.iter().copied().filter(|&p| fits(effect, &circuit.ports[p])).collect();
    let free = |p: &usize| !circuit.nodes[circuit.ports[*p].node].fixed;
    let driven = |p: &usize| circuit.nodes[circuit.ports[*p].node].driven;
    let sites: Vec<(AttachmentSite, Vec<usize>)> = match effect.interface.attach {
        // where a motion is imposed, what acts changes the reaction
        AttachmentKind::Shunt => fitting
            .iter()
            .copied()
            .filter(|p| free(p) || driven(p))
            .map(|p| (AttachmentSite::Node(p), vec![p]))
            .collect(),
        AttachmentKind::Bridge => pairs(circuit, effect, &fitting),
        AttachmentKind::Drain => {
            let low: Vec<usize> = reservoirs(circuit, effect);
            let one = |p: usize| low.iter().map(move |&l| (AttachmentSite::Across(p, l), vec![p])).collect::<Vec<_>>();
            fitting.iter().copied().filter(|p| free(p)).flat_map(one).collect()
        }
        AttachmentKind::Series => fitting
            .iter()
            .copied()
            .filter(|&p| joined(circuit, p))
            .map(|p| (AttachmentSite::Into(p), vec![p]))
            .collect(),
        _ => Vec::new(),
    };
    sites.into_iter().flat_map(|(site, used)| at_site(circuit, effect, component, &site, &used)).collect()
}

/// Sites of a bridge that needs no component between its ends, as heat does not: any two places.
fn without_component(circuit: &CircuitTopology, effect: &Arc<EffectModel>) -> Vec<AttachmentCandidate> {
    let interface = &effect.interface;
    if interface.attach != AttachmentKind::Bridge || !interface.anywhere || !interface.sense.is_empty() {
        return Vec::new();
    }
    let mut places = BTreeSet::new();
    let first = |p: &usize| fits(effect, &circuit.ports[*p]) && places.insert(circuit.rigid(*p));
    let ports: Vec<usize> = (0..circuit.ports.len()).filter(first).collect();
    let all = pairs(circuit, effect, &ports).into_iter();
    all.flat_map(|(site, used)| at_site(circuit, effect, 0, &site, &used)).collect()
}

fn fits(effect: &EffectModel, port: &PhysicalPort) -> bool {
    let i = &effect.interface;
    let through = i.through.as_ref().is_some_and(|t| same_kind(&t.unit, &port.through.unit));
    let potential = i.potential.first().or(i.drop.as_ref());
    through && potential.is_some_and(|p| same_kind(&p.unit, &port.potential.unit))
}

/// Whether a port is tied to others by connections of the model's own top level, which can be cut.
fn joined(circuit: &CircuitTopology, port: usize) -> bool {
    let mut touching = circuit.connections.iter().filter(|(a, b, _)| *a == port || *b == port).peekable();
    let plain = !circuit.ports[port].name.contains('[');
    plain && touching.peek().is_some() && touching.all(|(.., within)| *within == 0)
}

/// Pairs of ports of a component at different nodes.
fn pairs(circuit: &CircuitTopology, effect: &EffectModel, ports: &[usize]) -> Vec<(AttachmentSite, Vec<usize>)> {
    let mut sites = Vec::new();
    for (i, &a) in ports.iter().enumerate() {
        for &b in &ports[i + 1..] {
            let (x, y) = (circuit.rigid(a), circuit.rigid(b));
            let fixed = [x, y].into_iter().filter(|n| circuit.nodes[*n].fixed).count();
            // between the sides of a gear acts nothing that could not act at one of them
            let bound = circuit.geared(a) == circuit.geared(b);
            if !bound && fixed < if effect.free_ends { 1 } else { 2 } {
                sites.push((AttachmentSite::Across(a, b), vec![a, b]));
                if effect.directed {
                    sites.push((AttachmentSite::Across(b, a), vec![b, a]));
                }
            }
        }
    }
    sites
}

/// First ports of the nodes of constant potential that fit.
fn reservoirs(circuit: &CircuitTopology, effect: &EffectModel) -> Vec<usize> {
    let fixed = circuit.nodes.iter().filter(|n| n.fixed).map(|n| n.ports[0]);
    fixed.filter(|&p| fits(effect, &circuit.ports[p])).collect()
}

/// An effect at a site, once for each choice of what it reads beside.
fn at_site(
    circuit: &CircuitTopology,
    effect: &Arc<EffectModel>,
    component: usize,
    site: &AttachmentSite,
    used: &[usize],
) -> Vec<AttachmentCandidate> {
    let local = |p: &usize| circuit.ports[*p].name.rsplit('.').next().unwrap_or("").to_string();
    let alike = used.iter().map(local).collect::<Vec<_>>().join("|");
    let with = |sense: Vec<usize>| {
        let place = place_of(circuit, effect, site);
        let (base, temperature) = (Vec::new(), None);
        let attachment =
            EffectAttachment { effect: Some(effect.clone()), site: site.clone(), sense, base, temperature, place };
        AttachmentCandidate { component, alike: alike.clone(), attachment }
    };
    sensed(circuit, effect, component, used).into_iter().map(with).collect()
}

/// Further ports, one for each sensed potential: of the component, or any other for effects that reach so far.
fn sensed(circuit: &CircuitTopology, effect: &EffectModel, component: usize, used: &[usize]) -> Vec<Vec<usize>> {
    if effect.interface.anywhere && !effect.interface.sense.is_empty() {
        return effect.interface.sense.first().map_or_else(Vec::new, |q| moving(circuit, q));
    }
    let mut taken: Vec<usize> = used.to_vec();
    let mut sense = Vec::new();
    for q in &effect.interface.sense {
        let ports = circuit.components[component].ports.iter();
        let mut fitting =
            ports.filter(|p| !taken.contains(p) && same_kind(&circuit.ports[**p].potential.unit, &q.unit));
        let Some(&port) = fitting.next() else { return Vec::new() };
        taken.push(port);
        sense.push(port);
    }
    vec![sense]
}

/// First ports of all places with such a potential that is not fixed.
fn moving(circuit: &CircuitTopology, q: &NamedQuantity) -> Vec<Vec<usize>> {
    let mut places = BTreeSet::new();
    let first = |p: &usize| {
        let port = &circuit.ports[*p];
        let free = !circuit.nodes[port.node].fixed && same_kind(&port.potential.unit, &q.unit);
        free && places.insert(circuit.rigid(*p))
    };
    (0..circuit.ports.len()).filter(first).map(|p| vec![p]).collect()
}

/// A candidate with each choice of base parameters and of a temperature; none where there is nothing to choose.
fn completed(
    circuit: &CircuitTopology,
    effect: &EffectModel,
    candidate: AttachmentCandidate,
) -> Vec<AttachmentCandidate> {
    let mut all = vec![candidate];
    for q in &effect.base {
        all = all.into_iter().flat_map(|c| based(circuit, q, c)).collect();
    }
    if effect.interface.temperature.is_some() {
        all = all.into_iter().flat_map(|c| warmed(circuit, c)).collect();
    }
    all
}

fn based(circuit: &CircuitTopology, wanted: &NamedQuantity, c: AttachmentCandidate) -> Vec<AttachmentCandidate> {
    let component = &circuit.components[c.component];
    let fitting = component.factors.iter().filter(|q| same_kind(&q.unit, &wanted.unit));
    let with = |q: &NamedQuantity| {
        let full = if component.name.is_empty() { q.name.clone() } else { format!("{}.{}", component.name, q.name) };
        let mut attachment = c.attachment.clone();
        attachment.base.push((wanted.name.clone(), full));
        AttachmentCandidate { component: c.component, alike: format!("{}/{}", c.alike, q.name), attachment }
    };
    fitting.map(with).collect()
}

fn warmed(circuit: &CircuitTopology, c: AttachmentCandidate) -> Vec<AttachmentCandidate> {
    let temperatures = circuit.inputs.iter().filter(|i| i.ty == ScalarType::Real && same_kind(&i.unit, "K"));
    let with = |i: &super::circuit::ModelInput| {
        let offset = bramah_expr::units::MeasurementUnit::parse(&i.unit).map_or(0.0, |u| u.offset);
        let mut attachment = c.attachment.clone();
        attachment.temperature = Some((i.name.clone(), offset));
        AttachmentCandidate { component: c.component, alike: c.alike.clone(), attachment }
    };
    temperatures.map(with).collect()
}

/// The place as the verdict names it.
fn place_of(circuit: &CircuitTopology, effect: &EffectModel, site: &AttachmentSite) -> NetworkLocation {
    let name = |p: usize| circuit.ports[p].name.clone();
    let node = |p: usize| {
        let names: Vec<String> = circuit.same_place(p).into_iter().map(name).collect();
        (names[0].clone(), names, p)
    };
    let (place, ports, first) = match site {
        AttachmentSite::Node(p) => node(*p),
        AttachmentSite::Across(a, _) if effect.interface.attach == AttachmentKind::Drain => node(*a),
        AttachmentSite::Across(a, b) => {
            let place = format!("{}|{}", name(*a), name(*b));
            (place.clone(), vec![place], *a)
        }
        AttachmentSite::Into(p) => {
            let ports = &circuit.nodes[circuit.ports[*p].node].ports;
            let rest = ports.iter().copied().find(|i| i != p).unwrap_or(*p);
            let place = format!("{}->{}", name(rest), name(*p));
            (place.clone(), vec![place], *p)
        }
        AttachmentSite::Sensor(n) | AttachmentSite::Command(n) | AttachmentSite::Parameter(n) => {
            return NetworkLocation { place: n.clone(), node: vec![n.clone()], kind: MissingQuantity::Signal };
        }
    };
    NetworkLocation { place, node: ports, kind: MissingQuantity::of(&circuit.ports[first].through.unit) }
}

/// What makes two attachments of one effect the same.
type AttachmentIdentity = (AttachmentSite, Vec<usize>, Vec<(String, String)>, Option<String>);

fn identity(circuit: &CircuitTopology, a: &EffectAttachment) -> AttachmentIdentity {
    // at an imposed motion, either side of a sensor is another place
    let node = |p: &usize| match circuit.ports[*p].node {
        own if circuit.nodes[own].driven => own,
        _ => circuit.rigid(*p),
    };
    let site = match &a.site {
        AttachmentSite::Node(p) => AttachmentSite::Node(node(p)),
        AttachmentSite::Across(x, y) if directed(a) => AttachmentSite::Across(node(x), node(y)),
        AttachmentSite::Across(x, y) => AttachmentSite::Across(node(x).min(node(y)), node(x).max(node(y))),
        AttachmentSite::Into(p) => {
            let ports = &circuit.nodes[circuit.ports[*p].node].ports;
            AttachmentSite::Into(if ports.len() == 2 { ports[0] } else { *p })
        }
        other => other.clone(),
    };
    let sense = a.sense.iter().map(node).collect();
    (site, sense, a.base.clone(), a.temperature.as_ref().map(|t| t.0.clone()))
}

fn directed(a: &EffectAttachment) -> bool {
    a.effect.as_ref().is_some_and(|e| e.directed)
}

/// One attachment for all that are the same; parallel bridges are listed in its place.
fn merged(circuit: &CircuitTopology, candidates: &[AttachmentCandidate]) -> Vec<EffectAttachment> {
    let mut number: BTreeMap<AttachmentIdentity, usize> = BTreeMap::new();
    let mut all: Vec<EffectAttachment> = Vec::new();
    for c in candidates {
        let key = identity(circuit, &c.attachment);
        match number.get(&key) {
            Some(&i) => {
                for name in &c.attachment.place.node {
                    if !all[i].place.node.contains(name) {
                        all[i].place.node.push(name.clone());
                    }
                }
            }
            None => {
                number.insert(key, all.len());
                all.push(c.attachment.clone());
            }
        }
    }
    all
}

/// The effect at all instances of a class, and at all places of a fluid.
fn shared(
    circuit: &CircuitTopology,
    effect: &EffectModel,
    candidates: &[AttachmentCandidate],
    single: &[EffectAttachment],
) -> Vec<(Vec<EffectAttachment>, CoefficientSharing)> {
    let mut groups: Vec<(Vec<EffectAttachment>, CoefficientSharing)> = Vec::new();
    let mut seen: BTreeSet<BTreeSet<AttachmentIdentity>> = BTreeSet::new();
    let mut classes: Vec<(&str, &str)> = Vec::new();
    for c in candidates.iter().filter(|c| c.component > 0) {
        let key = (circuit.components[c.component].class.as_str(), c.alike.as_str());
        if !classes.contains(&key) {
            classes.push(key);
        }
    }
    let mut add = |members: Vec<EffectAttachment>, sharing: CoefficientSharing| {
        let identities: BTreeSet<AttachmentIdentity> = members.iter().map(|a| identity(circuit, a)).collect();
        if identities.len() > 1 && seen.insert(identities) {
            groups.push((members, sharing));
        }
    };
    for (class, alike) in classes {
        let of_class = |c: &&AttachmentCandidate| {
            c.component > 0 && circuit.components[c.component].class == class && c.alike == alike
        };
        let ids: BTreeSet<AttachmentIdentity> =
            candidates.iter().filter(of_class).map(|c| identity(circuit, &c.attachment)).collect();
        let members = single.iter().filter(|a| ids.contains(&identity(circuit, a))).cloned().collect();
        add(members, CoefficientSharing::Class(class.to_string()));
    }
    let fluid = effect.interface.through.as_ref().is_some_and(|t| same_kind(&t.unit, "m3/s"));
    if fluid && matches!(effect.interface.attach, AttachmentKind::Shunt | AttachmentKind::Drain) {
        add(single.to_vec(), CoefficientSharing::All);
    }
    groups
}

fn hypothesis(
    circuit: &CircuitTopology,
    attachments: Vec<EffectAttachment>,
    sharing: CoefficientSharing,
    signals: &[SensorSignal],
) -> Hypothesis {
    let effect = attachments[0].effect.clone().expect("an effect at each place");
    let passes = match &attachments[0].site {
        AttachmentSite::Sensor(s) => Some(signals.iter().find(|x| x.name == *s).map_or(1.0, |x| x.scale)),
        AttachmentSite::Command(i) => {
            Some(circuit.inputs.iter().find(|x| x.name == *i).and_then(|x| x.nominal).unwrap_or(1.0))
        }
        _ => None,
    };
    let scale = passes.unwrap_or(1.0);
    let mut coefficients = effect.coefficients.clone();
    coefficients.iter_mut().filter(|c| c.relative).for_each(|c| c.nominal *= scale);
    let mut shapes = effect.shapes.clone();
    for s in shapes.iter_mut().filter(|s| s.relative) {
        s.grid.iter_mut().for_each(|x| *x *= scale);
    }
    let changes_order = attachments.iter().any(|a| changes_order(circuit, a));
    let (class, family) = (effect.class.clone(), effect.family.clone());
    Hypothesis { effect: class, family, attachments, sharing, coefficients, shapes, changes_order, passes }
}

fn changes_order(circuit: &CircuitTopology, a: &EffectAttachment) -> bool {
    let Some(effect) = &a.effect else { return false };
    let mut ports = a.sense.clone();
    match a.site {
        AttachmentSite::Node(p) => ports.push(p),
        AttachmentSite::Across(x, y) => ports.extend([x, y]),
        AttachmentSite::Into(p) => {
            let node = &circuit.nodes[circuit.ports[p].node];
            return effect.states > 0 || node.has_rate || node.fixed;
        }
        _ => {}
    }
    let lacks = |p: &usize| {
        let node = &circuit.nodes[circuit.ports[*p].node];
        let rate = effect.needs_rate && !node.has_rate;
        let acceleration = effect.needs_acceleration && !node.has_acceleration;
        !node.fixed && (rate || acceleration)
    };
    ports.iter().any(lacks)
}

fn drift(free: &UncertainParameter) -> Hypothesis {
    let place =
        NetworkLocation { place: free.name.clone(), node: vec![free.name.clone()], kind: MissingQuantity::Parameter };
    let site = AttachmentSite::Parameter(free.name.clone());
    let attachment = EffectAttachment { effect: None, site, sense: vec![], base: vec![], temperature: None, place };
    let coefficient = EffectCoefficient {
        recording: None,
        name: free.name.clone(),
        unit: String::new(),
        off: free.nominal,
        min: None,
        max: None,
        nominal: free.sigma,
        relative: false,
        part: false,
    };
    Hypothesis {
        effect: "Drift".into(),
        family: "parameter".into(),
        attachments: vec![attachment],
        sharing: CoefficientSharing::Single,
        coefficients: vec![coefficient],
        shapes: Vec::new(),
        changes_order: false,
        passes: None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::circuit::NodeSet;
    use super::*;

    #[test]
    fn effects_meet_at_nodes_but_not_at_a_reservoir() {
        let quantity = || NamedQuantity { name: String::new(), unit: String::new() };
        let port = |node| PhysicalPort {
            name: String::new(),
            class: String::new(),
            component: 0,
            potential: quantity(),
            through: quantity(),
            node,
        };
        // two chambers, the first with a second port, the tank, and a node that is rigidly one with the second chamber
        let node = |first, fixed| NodeSet { rigid: first, geared: first, fixed, ..NodeSet::default() };
        let nodes = vec![node(0, false), node(1, false), node(2, true), node(1, false)];
        let circuit = CircuitTopology {
            ports: vec![port(0), port(1), port(2), port(0), port(3)],
            nodes,
            ..CircuitTopology::default()
        };
        let meet = |a: AttachmentSite, b: AttachmentSite| a.meets(&b, &circuit) && b.meets(&a, &circuit);
        assert!(meet(AttachmentSite::Node(0), AttachmentSite::Across(3, 2)), "air and the leak of the same chamber");
        assert!(meet(AttachmentSite::Across(0, 1), AttachmentSite::Into(3)));
        assert!(!meet(AttachmentSite::Across(0, 2), AttachmentSite::Across(1, 2)), "both end in the tank");
        assert!(!meet(AttachmentSite::Node(0), AttachmentSite::Node(1)));
        assert!(meet(AttachmentSite::Node(1), AttachmentSite::Node(4)));
        assert!(!meet(AttachmentSite::Sensor("p".into()), AttachmentSite::Sensor("p".into())), "which `is_at` tells");
    }
}
