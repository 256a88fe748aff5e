//! Hypotheses: every effect of the library at every place of the network where its ports and units fit.
//!
//! Enters: the places of the model ([`CircuitTopology`]), the effects, the signals and the uncertain parameters.
//! Leaves: a list of [`Hypothesis`], in the order of the library. Called by `study`.
//!
//! An effect is first put at every port or pair of ports that fits. Attachments at rigidly connected nodes and parallel
//! bridges are the same and become one. Each of the rest is a hypothesis of its own. The effect at all instances of a
//! class is one more hypothesis, with shared coefficients.

use super::circuit::{CircuitTopology, NamedQuantity, PhysicalPort, same_kind};
use super::effects::{AttachmentKind, EffectCoefficient, EffectModel, ShapeParameter, ShapeRole};
use bramah_analysis::study::EffectChoice;
use bramah_model::flat::ScalarType;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Orders (periods a turn) that differ by less than this are the same.
const SAME_ORDER: f64 = 0.5;

/// A signal of the study: what one sensor recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSignal {
    /// Its name in study and verdict.
    pub name: String,
    /// The variable of the model that it measures.
    pub variable: String,
    /// Its full scale in SI units, which sets typical sizes of sensor effects.
    pub scale: f64,
}

/// A parameter that may be out of its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainParameter {
    /// Full name in the nominal model.
    pub name: String,
    /// Value of the nominal model, SI.
    pub nominal: f64,
    /// Tolerance as one standard deviation, SI.
    pub sigma: f64,
}

/// Kind of quantity that is missing at a place.
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
    /// The word that the verdict uses.
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

    /// The kind that belongs to the unit of a through variable; `Signal` for units of no known kind.
    /// Scales do not matter: l/min is a flow like m3/s.
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
    /// Its name: a port, two ports `a|b`, a connection `a->b`, a signal or a parameter.
    pub place: String,
    /// All names of the same place: ports of the node, or parallel bridges.
    pub node: Vec<String>,
    /// Kind of quantity that is missing there.
    pub kind: MissingQuantity,
}

/// Where an effect is tied to the model. Numbers are indices of [`CircuitTopology::ports`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AttachmentSite {
    /// A node, by one of its ports. The effect draws a flow from it.
    Node(usize),
    /// From the first port to the second. What the effect takes from the first it gives to the second.
    Across(usize, usize),
    /// Into a connection: between the port and the rest of its node. The effect gives a difference of potential.
    Into(usize),
    /// A signal of the study, by name. The effect lies between the variable and its recording.
    Sensor(String),
    /// An input or a signal inside the model, by name. The effect lies between it and the model.
    Command(String),
    /// A parameter, by full name, that leaves its tolerance.
    Parameter(String),
}

impl AttachmentSite {
    /// Whether two effects act at the same place, whatever their direction.
    pub fn is_at(&self, other: &AttachmentSite) -> bool {
        match (self, other) {
            (AttachmentSite::Across(a, b), AttachmentSite::Across(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
            _ => self == other,
        }
    }

    /// Ports of the nodes on which it acts and whose potential is not given; empty for signals and parameters.
    pub fn free_ports(&self, circuit: &CircuitTopology) -> Vec<usize> {
        let ports = match self {
            AttachmentSite::Node(p) | AttachmentSite::Into(p) => vec![*p],
            AttachmentSite::Across(a, b) => vec![*a, *b],
            AttachmentSite::Sensor(_) | AttachmentSite::Command(_) | AttachmentSite::Parameter(_) => Vec::new(),
        };
        ports.into_iter().filter(|p| !circuit.nodes[circuit.ports[*p].node].fixed).collect()
    }

    /// Whether two effects act on one node, or on nodes whose potentials are bound to each other.
    /// Nodes of given potential, such as a reservoir, do not count.
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
    /// Where it acts.
    pub site: AttachmentSite,
    /// Ports whose potentials it reads in addition, in the order of the effect's `sense`.
    pub sense: Vec<usize>,
    /// Parameters of the effect that take the value of a parameter of the model (full name) or a number.
    pub base: Vec<(String, String)>,
    /// Input that is the temperature, and the offset that converts it to kelvin; `None` for effects that read none.
    pub temperature: Option<(String, f64)>,
    /// The place in words.
    pub place: NetworkLocation,
}

/// Which places share one set of coefficients.
#[derive(Clone, Debug, PartialEq)]
pub enum CoefficientSharing {
    /// One place has its own.
    Single,
    /// All instances of a class share them.
    Class(String),
    /// All places where the effect fits share them.
    All,
}

/// One possible explanation of the gap: an effect at one or several places, or a parameter out of its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Class of the effect (of the first one in a group); `Drift` for a parameter.
    pub effect: String,
    /// Family of the effect; `parameter` for a parameter.
    pub family: String,
    /// Places where it acts; at least one.
    pub attachments: Vec<EffectAttachment>,
    /// One place, or several with the same coefficients.
    pub sharing: CoefficientSharing,
    /// Parameters in which it is linear, with typical sizes in SI units.
    pub coefficients: Vec<EffectCoefficient>,
    /// Nonlinear parameters, with grids in SI units.
    pub shapes: Vec<ShapeParameter>,
    /// It changes the order of the model, so that it cannot be linearised at its off value together with others.
    /// It needs a rate that the model lacks, or stands inside a connection. States of its own beside the model do not
    /// count.
    pub changes_order: bool,
    /// Usual size of the signal that passes through it, SI, which is also the size of its states; `None` at a node.
    pub passes: Option<f64>,
}

impl Hypothesis {
    /// Its places in words.
    pub fn places(&self) -> Vec<&NetworkLocation> {
        self.attachments.iter().map(|a| &a.place).collect()
    }

    /// Whether it is a shape without a physical name.
    pub fn is_shape(&self) -> bool {
        self.attachments[0].effect.as_ref().is_some_and(|e| e.is_shape())
    }

    /// Whether it is an error of the recording, not of the model.
    pub fn is_recording_error(&self) -> bool {
        self.family == super::mistakes::FAMILY
    }

    /// Name of the law of which it is a form. Only one form of a law is accepted at a place.
    pub fn law(&self) -> &str {
        let effect = self.attachments[0].effect.as_ref();
        effect.and_then(|e| e.law.as_deref()).unwrap_or(&self.effect)
    }

    /// Whether it is the same with two lists of values. An effect with an order may be accepted again with another
    /// order.
    pub fn same(&self, values: &[f64], by: &[f64]) -> bool {
        let order = self.shapes.iter().position(|s| s.role == ShapeRole::Order).map(|k| self.coefficients.len() + k);
        order.is_none_or(|k| (values[k] - by[k]).abs() < SAME_ORDER)
    }

    /// All combinations of the grid values of its shapes, the first shape varying slowest; one empty combination
    /// without shapes.
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

/// All hypotheses: every effect at every place, alone and with shared coefficients, and every uncertain parameter.
///
/// The order is that of the effects, then of the places in the order of declaration, single places before shared ones.
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
        // parallel bridges and ports of one node are the same place
        let single = merged(circuit, &candidates);
        if let Some(group) = &effect.group {
            groups.entry(group).or_default().extend(single.iter().cloned());
        }
        all.extend(single.iter().map(|a| hypothesis(circuit, vec![a.clone()], CoefficientSharing::Single, signals)));
        // a shape with shared coefficients would have no meaning: its form belongs to one place
        let shared = if effect.is_shape() { Vec::new() } else { shared(circuit, effect, &candidates, &single) };
        all.extend(shared.into_iter().map(|(a, s)| hypothesis(circuit, a, s, signals)));
    }
    // a group needs at least two different effects
    let groups = groups.into_values().filter(|g| g.iter().any(|a| a.effect != g[0].effect));
    all.extend(groups.map(|g| hypothesis(circuit, g, CoefficientSharing::All, signals)));
    all.extend(free.iter().map(drift));
    all
}

/// Removes what the study does not allow. It names effects by class or family, and places as the verdict does.
/// With a list of places, a hypothesis stays only if all its places are in the list.
pub fn narrow(all: &mut Vec<Hypothesis>, choice: &EffectChoice) {
    let named = |list: &[String], h: &Hypothesis| list.iter().any(|n| *n == h.effect || *n == h.family);
    let allowed = |p: &NetworkLocation| choice.places.iter().any(|n| p.node.contains(n) || *n == p.place);
    all.retain(|h| {
        let included = choice.include.is_empty() || named(&choice.include, h);
        let placed = choice.places.is_empty() || h.attachments.iter().all(|a| allowed(&a.place));
        included && placed && !named(&choice.exclude, h)
    });
}

/// Removes effects that only a command can have, at inputs that are measured and at signals that follow from these
/// alone. A measured input has no dead zone, limit or lag of its own; effects marked `measured` stay.
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

/// An attachment before identical ones are merged.
struct AttachmentCandidate {
    /// Component at whose ports it was found; 0 (the model itself) for effects between any two places.
    component: usize,
    /// Key of what is alike in other instances of the component's class.
    alike: String,
    /// The attachment.
    attachment: EffectAttachment,
}

/// All attachments of one effect, in the order of declaration; several may be the same place.
fn candidates(
    circuit: &CircuitTopology,
    effect: &Arc<EffectModel>,
    all: &[Arc<EffectModel>],
    signals: &[SensorSignal],
) -> Vec<AttachmentCandidate> {
    // some effects only stand in where another form of their family fits nowhere
    if effect.without.is_some_and(|a| fits_somewhere(circuit, effect, a, all)) {
        return Vec::new();
    }
    match effect.interface.attach {
        AttachmentKind::Sensor => {
            signals.iter().map(|s| signal(effect, AttachmentSite::Sensor(s.name.clone()), &s.name)).collect()
        }
        // a link is a signal inside the model that acts like a command
        AttachmentKind::Command => {
            // a recorded temperature is a measurement, not a command
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

/// Whether another effect of the family fits with this kind of attachment.
fn fits_somewhere(
    circuit: &CircuitTopology,
    effect: &EffectModel,
    attach: AttachmentKind,
    all: &[Arc<EffectModel>],
) -> bool {
    let others = all.iter().filter(|e| e.family == effect.family && e.interface.attach == attach);
    others.into_iter().any(|e| (0..circuit.components.len()).any(|c| !at_component(circuit, e, c).is_empty()))
}

/// An attachment to a signal, a command or a sensor. It belongs to no component.
fn signal(effect: &Arc<EffectModel>, site: AttachmentSite, name: &str) -> AttachmentCandidate {
    let kind =
        if matches!(site, AttachmentSite::Sensor(_)) { MissingQuantity::Sensor } else { MissingQuantity::Signal };
    let place = NetworkLocation { place: name.into(), node: vec![name.into()], kind };
    let attachment =
        EffectAttachment { effect: Some(effect.clone()), site, sense: vec![], base: vec![], temperature: None, place };
    AttachmentCandidate { component: 0, alike: String::new(), attachment }
}

/// Attachments of an effect at the ports of one component, by the kind of its interface.
fn at_component(circuit: &CircuitTopology, effect: &Arc<EffectModel>, component: usize) -> Vec<AttachmentCandidate> {
    let fitting: Vec<usize> =
        circuit.components[component].ports.iter().copied().filter(|&p| fits(effect, &circuit.ports[p])).collect();
    let free = |p: &usize| !circuit.nodes[circuit.ports[*p].node].fixed;
    let driven = |p: &usize| circuit.nodes[circuit.ports[*p].node].driven;
    let sites: Vec<(AttachmentSite, Vec<usize>)> = match effect.interface.attach {
        // at a node of given potential nothing changes, except the reaction where the motion is imposed by an input
        AttachmentKind::Shunt => fitting
            .iter()
            .copied()
            .filter(|p| free(p) || driven(p))
            .map(|p| (AttachmentSite::Node(p), vec![p]))
            .collect(),
        AttachmentKind::Bridge => pairs(circuit, effect, &fitting),
        // one hypothesis for each node of given potential that the flow may go to
        AttachmentKind::Drain => {
            let low: Vec<usize> = reservoirs(circuit, effect);
            let one = |p: usize| low.iter().map(move |&l| (AttachmentSite::Across(p, l), vec![p])).collect::<Vec<_>>();
            fitting.iter().copied().filter(|p| free(p)).flat_map(one).collect()
        }
        // only a connection that can be cut can take an element
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

/// Attachments of a bridge that needs no component between its ends (as for heat): any two places.
fn without_component(circuit: &CircuitTopology, effect: &Arc<EffectModel>) -> Vec<AttachmentCandidate> {
    let interface = &effect.interface;
    if interface.attach != AttachmentKind::Bridge || !interface.anywhere || !interface.sense.is_empty() {
        return Vec::new();
    }
    let mut places = BTreeSet::new();
    // one port for all rigidly connected nodes
    let first = |p: &usize| fits(effect, &circuit.ports[*p]) && places.insert(circuit.rigid(*p));
    let ports: Vec<usize> = (0..circuit.ports.len()).filter(first).collect();
    let all = pairs(circuit, effect, &ports).into_iter();
    all.flat_map(|(site, used)| at_site(circuit, effect, 0, &site, &used)).collect()
}

/// Whether a port has the units of the effect's through variable and potential. A Series element has a drop instead of
/// a potential. Scales may differ, since `augment` converts units.
fn fits(effect: &EffectModel, port: &PhysicalPort) -> bool {
    let i = &effect.interface;
    let through = i.through.as_ref().is_some_and(|t| same_kind(&t.unit, &port.through.unit));
    let potential = i.potential.first().or(i.drop.as_ref());
    through && potential.is_some_and(|p| same_kind(&p.unit, &port.potential.unit))
}

/// Whether all connections of a port stand at the top level of the model, where they can be cut.
/// Ports of arrays are left out.
fn joined(circuit: &CircuitTopology, port: usize) -> bool {
    let mut touching = circuit.connections.iter().filter(|(a, b, _)| *a == port || *b == port).peekable();
    let plain = !circuit.ports[port].name.contains('[');
    plain && touching.peek().is_some() && touching.all(|(.., within)| *within == 0)
}

/// Pairs of ports at different nodes, with their sites. Directed effects get both directions.
/// A pair of two given potentials is left out; an effect with free ends also needs both nodes free.
fn pairs(circuit: &CircuitTopology, effect: &EffectModel, ports: &[usize]) -> Vec<(AttachmentSite, Vec<usize>)> {
    let mut sites = Vec::new();
    for (i, &a) in ports.iter().enumerate() {
        for &b in &ports[i + 1..] {
            let (x, y) = (circuit.rigid(a), circuit.rigid(b));
            let fixed = [x, y].into_iter().filter(|n| circuit.nodes[*n].fixed).count();
            // between the sides of an ideal gear nothing can act that could not act at one of them
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

/// First ports of the nodes of given potential whose units fit.
fn reservoirs(circuit: &CircuitTopology, effect: &EffectModel) -> Vec<usize> {
    let fixed = circuit.nodes.iter().filter(|n| n.fixed).map(|n| n.ports[0]);
    fixed.filter(|&p| fits(effect, &circuit.ports[p])).collect()
}

/// Attachments of an effect at a site, one for each choice of the further ports that it reads.
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

/// Choices of further ports, one port per sensed potential: of the same component, or of the network for effects that
/// may read anywhere. Empty if a potential is not found.
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

/// First ports of all places with a free potential of this unit, as one-element choices.
fn moving(circuit: &CircuitTopology, q: &NamedQuantity) -> Vec<Vec<usize>> {
    let mut places = BTreeSet::new();
    let first = |p: &usize| {
        let port = &circuit.ports[*p];
        let free = !circuit.nodes[port.node].fixed && same_kind(&port.potential.unit, &q.unit);
        free && places.insert(circuit.rigid(*p))
    };
    (0..circuit.ports.len()).filter(first).map(|p| vec![p]).collect()
}

/// A candidate with each choice of base parameters and of a temperature; empty if there is nothing to choose from.
/// An effect without these needs no choice and stays as it is.
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

/// A candidate with each parameter of its component that fits one base parameter.
/// Only parameters that multiply a single variable fit, as the conductance of a throttle does.
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

/// A candidate with each input that is a temperature, with the offset of its unit.
/// An input in degrees Celsius is converted to kelvin by it.
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

/// The place of a site as the verdict names it.
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
            // the connection is named by the first other port of the node
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

/// Key by which two attachments of one effect are the same: site, sensed nodes, base parameters, temperature.
type AttachmentIdentity = (AttachmentSite, Vec<usize>, Vec<(String, String)>, Option<String>);

/// The key of an attachment. Ports count by their node, and undirected bridges by both nodes in order.
fn identity(circuit: &CircuitTopology, a: &EffectAttachment) -> AttachmentIdentity {
    // where the motion is imposed, a sensor tells the nodes on its two sides apart
    let node = |p: &usize| match circuit.ports[*p].node {
        own if circuit.nodes[own].driven => own,
        _ => circuit.rigid(*p),
    };
    let site = match &a.site {
        AttachmentSite::Node(p) => AttachmentSite::Node(node(p)),
        AttachmentSite::Across(x, y) if directed(a) => AttachmentSite::Across(node(x), node(y)),
        AttachmentSite::Across(x, y) => AttachmentSite::Across(node(x).min(node(y)), node(x).max(node(y))),
        // in a node of two ports, both ends of the connection are the same place
        AttachmentSite::Into(p) => {
            let ports = &circuit.nodes[circuit.ports[*p].node].ports;
            AttachmentSite::Into(if ports.len() == 2 { ports[0] } else { *p })
        }
        other => other.clone(),
    };
    let sense = a.sense.iter().map(node).collect();
    (site, sense, a.base.clone(), a.temperature.as_ref().map(|t| t.0.clone()))
}

/// Whether the direction of the effect matters.
fn directed(a: &EffectAttachment) -> bool {
    a.effect.as_ref().is_some_and(|e| e.directed)
}

/// Attachments without repetitions, in the order of the first ones. The names of parallel bridges are added to the
/// first.
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

/// Groups of attachments with shared coefficients: all instances of a class, and all places of a fluid.
/// Only groups of two or more places are listed, each once.
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
    // groups of one place, and groups that exist already, add nothing
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
    // effects on volume flow at nodes are also offered with one set of coefficients for the complete fluid
    let fluid = effect.interface.through.as_ref().is_some_and(|t| same_kind(&t.unit, "m3/s"));
    if fluid && matches!(effect.interface.attach, AttachmentKind::Shunt | AttachmentKind::Drain) {
        add(single.to_vec(), CoefficientSharing::All);
    }
    groups
}

/// A hypothesis of an effect at these places, with sizes and grids in SI units.
/// The range of a signal or input sets the sizes of relative coefficients.
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
    // relative sizes count in full scales of the signal
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

/// Whether an attachment changes the order of the model.
/// It does if it needs a rate or acceleration of a free potential that the model does not have. An element in a
/// connection does if it has states, or if the potential there is differentiated or given.
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
    // the rate of a potential that the model does not differentiate makes a new state
    let lacks = |p: &usize| {
        let node = &circuit.nodes[circuit.ports[*p].node];
        let rate = effect.needs_rate && !node.has_rate;
        let acceleration = effect.needs_acceleration && !node.has_acceleration;
        !node.fixed && (rate || acceleration)
    };
    ports.iter().any(lacks)
}

/// The hypothesis that a parameter is out of its tolerance. Its off value is the data sheet, its typical size the
/// tolerance.
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
