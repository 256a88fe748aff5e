//! The network writes the hypotheses: every effect at every place where its ports and units fit.

use super::circuit::{Circuit, Port, Quantity, same_kind};
use super::effects::{Attach, Coefficient, Effect, Shape};
use bramah_analysis::study::EffectChoice;
use bramah_model::flat::Type;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Orders nearer than this are the same.
const SAME_ORDER: f64 = 0.5;

/// A signal of the study: what a sensor recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Its name in study and verdict.
    pub name: String,
    /// The model's variable.
    pub variable: String,
    /// Its full scale in SI units, for typical sizes of sensor effects.
    pub scale: f64,
}

/// A parameter that may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
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
pub enum Kind {
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

impl Kind {
    /// The word of the verdict.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Force => "force",
            Kind::Torque => "torque",
            Kind::Flow => "flow",
            Kind::Current => "current",
            Kind::Voltage => "voltage",
            Kind::Heat => "heat",
            Kind::Signal => "signal",
            Kind::Sensor => "sensor",
            Kind::Parameter => "parameter",
        }
    }

    /// By the unit of a through variable.
    fn of(unit: &str) -> Kind {
        let flows = [("m3/s", Kind::Flow), ("kg/s", Kind::Flow), ("A", Kind::Current), ("W", Kind::Heat)];
        let known = [("N", Kind::Force), ("N.m", Kind::Torque)].into_iter().chain(flows);
        known.into_iter().find(|(u, _)| same_kind(u, unit)).map_or(Kind::Signal, |(_, k)| k)
    }
}

/// A place of the network as the verdict names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Its name.
    pub place: String,
    /// Everything that is the same place: ports of the node, parallel bridges.
    pub node: Vec<String>,
    /// What is missing there.
    pub kind: Kind,
}

/// Where an effect is tied to the model; numbers are those of [`Circuit::ports`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Site {
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

impl Site {
    /// Whether two effects act at one place; which way they point does not count.
    pub fn is_at(&self, other: &Site) -> bool {
        match (self, other) {
            (Site::Across(a, b), Site::Across(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
            _ => self == other,
        }
    }

    /// Ports of the nodes on which it acts and whose potential is not given.
    pub fn free_ports(&self, circuit: &Circuit) -> Vec<usize> {
        let ports = match self {
            Site::Node(p) | Site::Into(p) => vec![*p],
            Site::Across(a, b) => vec![*a, *b],
            Site::Sensor(_) | Site::Command(_) | Site::Parameter(_) => Vec::new(),
        };
        ports.into_iter().filter(|p| !circuit.nodes[circuit.ports[*p].node].fixed).collect()
    }

    /// Whether two effects act on one node, or on two that are bound to each other.
    pub fn meets(&self, other: &Site, circuit: &Circuit) -> bool {
        let nodes = |site: &Site| site.free_ports(circuit).into_iter().map(|p| circuit.geared(p)).collect::<Vec<_>>();
        let own = nodes(self);
        nodes(other).iter().any(|n| own.contains(n))
    }
}

/// One effect at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// The effect; `None` for a parameter.
    pub effect: Option<Arc<Effect>>,
    /// Where.
    pub site: Site,
    /// Ports whose potentials are read beside.
    pub sense: Vec<usize>,
    /// Parameters of the effect that take the value of a parameter of the model, by full name, or a number.
    pub base: Vec<(String, String)>,
    /// The input that is the temperature, with the offset that makes kelvins of it.
    pub temperature: Option<(String, f64)>,
    /// The place in words.
    pub place: Place,
}

/// How far one set of coefficients reaches.
#[derive(Clone, Debug, PartialEq)]
pub enum Sharing {
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
    pub attachments: Vec<Attachment>,
    /// One place or several with the same coefficients.
    pub sharing: Sharing,
    /// Linear parameters, typical sizes in SI units.
    pub coefficients: Vec<Coefficient>,
    /// Nonlinear parameters, grids in SI units.
    pub shapes: Vec<Shape>,
    /// The order of the model changes with it (it needs a rate that the model does not have, or stands inside a connection),
    /// so that it cannot be linearised at its off value together with the others. States of its own beside are none.
    pub changes_order: bool,
    /// Usual size of the signal that passes through it, SI; its own states are of that size. Nothing at a node.
    pub passes: Option<f64>,
}

impl Hypothesis {
    /// The places in words.
    pub fn places(&self) -> Vec<&Place> {
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
pub fn hypotheses(circuit: &Circuit, effects: &[Arc<Effect>], signals: &[Signal], free: &[Free]) -> Vec<Hypothesis> {
    let mut all = Vec::new();
    let mut groups: BTreeMap<&str, Vec<Attachment>> = BTreeMap::new();
    for effect in effects {
        let candidates = candidates(circuit, effect, effects, signals);
        let single = merged(circuit, &candidates);
        if let Some(group) = &effect.group {
            groups.entry(group).or_default().extend(single.iter().cloned());
        }
        all.extend(single.iter().map(|a| hypothesis(circuit, vec![a.clone()], Sharing::Single, signals)));
        // one shape at several places is no shape
        let shared = if effect.is_shape() { Vec::new() } else { shared(circuit, effect, &candidates, &single) };
        all.extend(shared.into_iter().map(|(a, s)| hypothesis(circuit, a, s, signals)));
    }
    let groups = groups.into_values().filter(|g| g.iter().any(|a| a.effect != g[0].effect));
    all.extend(groups.map(|g| hypothesis(circuit, g, Sharing::All, signals)));
    all.extend(free.iter().map(drift));
    all
}

/// Leaves only what the study allows. Effects are named by class or family, places as the verdict names them.
pub fn narrow(all: &mut Vec<Hypothesis>, choice: &EffectChoice) {
    let named = |list: &[String], h: &Hypothesis| list.iter().any(|n| *n == h.effect || *n == h.family);
    let allowed = |p: &Place| choice.places.iter().any(|n| p.node.contains(n) || *n == p.place);
    all.retain(|h| {
        let included = choice.include.is_empty() || named(&choice.include, h);
        let placed = choice.places.is_empty() || h.attachments.iter().all(|a| allowed(&a.place));
        included && placed && !named(&choice.exclude, h)
    });
}

/// Leaves out what only a command suffers at inputs that a sensor shows, and at what follows from them alone.
pub fn without_commands(all: &mut Vec<Hypothesis>, circuit: &Circuit, measured: &[&str]) {
    let shown = |name: &String| {
        let is_measured = |n: &String| measured.contains(&n.as_str());
        is_measured(name)
            || circuit.link(name).is_some_and(|l| !l.inputs.is_empty() && l.inputs.iter().all(is_measured))
    };
    let fits = |a: &Attachment| match (&a.site, &a.effect) {
        (Site::Command(name), Some(effect)) => effect.measured || !shown(name),
        _ => true,
    };
    all.retain(|h| h.attachments.iter().all(fits));
}

/// An attachment before identical ones are merged, with its component and what is alike in other instances.
struct Candidate {
    component: usize,
    alike: String,
    attachment: Attachment,
}

fn candidates(circuit: &Circuit, effect: &Arc<Effect>, all: &[Arc<Effect>], signals: &[Signal]) -> Vec<Candidate> {
    if effect.without.is_some_and(|a| fits_somewhere(circuit, effect, a, all)) {
        return Vec::new();
    }
    match effect.interface.attach {
        Attach::Sensor => signals.iter().map(|s| signal(effect, Site::Sensor(s.name.clone()), &s.name)).collect(),
        Attach::Command => {
            // A recorded temperature is no command.
            let all = circuit.inputs.iter().chain(circuit.links.iter().map(|l| &l.signal));
            let real = all.filter(|i| i.ty == Type::Real && !same_kind(&i.unit, "K"));
            real.map(|i| signal(effect, Site::Command(i.name.clone()), &i.name)).collect()
        }
        Attach::Drift => Vec::new(),
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
fn fits_somewhere(circuit: &Circuit, effect: &Effect, attach: Attach, all: &[Arc<Effect>]) -> bool {
    let others = all.iter().filter(|e| e.family == effect.family && e.interface.attach == attach);
    others.into_iter().any(|e| (0..circuit.components.len()).any(|c| !at_component(circuit, e, c).is_empty()))
}

fn signal(effect: &Arc<Effect>, site: Site, name: &str) -> Candidate {
    let kind = if matches!(site, Site::Sensor(_)) { Kind::Sensor } else { Kind::Signal };
    let place = Place { place: name.into(), node: vec![name.into()], kind };
    let attachment =
        Attachment { effect: Some(effect.clone()), site, sense: vec![], base: vec![], temperature: None, place };
    Candidate { component: 0, alike: String::new(), attachment }
}

/// Sites of an effect at the ports of one component.
fn at_component(circuit: &Circuit, effect: &Arc<Effect>, component: usize) -> Vec<Candidate> {
    let fitting: Vec<usize> =
        circuit.components[component].ports.iter().copied().filter(|&p| fits(effect, &circuit.ports[p])).collect();
    let free = |p: &usize| !circuit.nodes[circuit.ports[*p].node].fixed;
    let driven = |p: &usize| circuit.nodes[circuit.ports[*p].node].driven;
    let sites: Vec<(Site, Vec<usize>)> = match effect.interface.attach {
        // where a motion is imposed, what acts changes the reaction
        Attach::Shunt => {
            fitting.iter().copied().filter(|p| free(p) || driven(p)).map(|p| (Site::Node(p), vec![p])).collect()
        }
        Attach::Bridge => pairs(circuit, effect, &fitting),
        Attach::Drain => {
            let low: Vec<usize> = reservoirs(circuit, effect);
            let one = |p: usize| low.iter().map(move |&l| (Site::Across(p, l), vec![p])).collect::<Vec<_>>();
            fitting.iter().copied().filter(|p| free(p)).flat_map(one).collect()
        }
        Attach::Series => {
            fitting.iter().copied().filter(|&p| joined(circuit, p)).map(|p| (Site::Into(p), vec![p])).collect()
        }
        _ => Vec::new(),
    };
    sites.into_iter().flat_map(|(site, used)| at_site(circuit, effect, component, &site, &used)).collect()
}

/// Sites of a bridge that needs no component between its ends, as heat does not: any two places.
fn without_component(circuit: &Circuit, effect: &Arc<Effect>) -> Vec<Candidate> {
    let interface = &effect.interface;
    if interface.attach != Attach::Bridge || !interface.anywhere || !interface.sense.is_empty() {
        return Vec::new();
    }
    let mut places = BTreeSet::new();
    let first = |p: &usize| fits(effect, &circuit.ports[*p]) && places.insert(circuit.rigid(*p));
    let ports: Vec<usize> = (0..circuit.ports.len()).filter(first).collect();
    let all = pairs(circuit, effect, &ports).into_iter();
    all.flat_map(|(site, used)| at_site(circuit, effect, 0, &site, &used)).collect()
}

fn fits(effect: &Effect, port: &Port) -> bool {
    let i = &effect.interface;
    let through = i.through.as_ref().is_some_and(|t| same_kind(&t.unit, &port.through.unit));
    let potential = i.potential.first().or(i.drop.as_ref());
    through && potential.is_some_and(|p| same_kind(&p.unit, &port.potential.unit))
}

/// Whether a port is tied to others by connections of the model's own top level, which can be cut.
fn joined(circuit: &Circuit, port: usize) -> bool {
    let mut touching = circuit.connections.iter().filter(|(a, b, _)| *a == port || *b == port).peekable();
    let plain = !circuit.ports[port].name.contains('[');
    plain && touching.peek().is_some() && touching.all(|(.., within)| *within == 0)
}

/// Pairs of ports of a component at different nodes.
fn pairs(circuit: &Circuit, effect: &Effect, ports: &[usize]) -> Vec<(Site, Vec<usize>)> {
    let mut sites = Vec::new();
    for (i, &a) in ports.iter().enumerate() {
        for &b in &ports[i + 1..] {
            let (x, y) = (circuit.rigid(a), circuit.rigid(b));
            let fixed = [x, y].into_iter().filter(|n| circuit.nodes[*n].fixed).count();
            // between the sides of a gear acts nothing that could not act at one of them
            let bound = circuit.geared(a) == circuit.geared(b);
            if !bound && fixed < if effect.free_ends { 1 } else { 2 } {
                sites.push((Site::Across(a, b), vec![a, b]));
                if effect.directed {
                    sites.push((Site::Across(b, a), vec![b, a]));
                }
            }
        }
    }
    sites
}

/// First ports of the nodes of constant potential that fit.
fn reservoirs(circuit: &Circuit, effect: &Effect) -> Vec<usize> {
    let fixed = circuit.nodes.iter().filter(|n| n.fixed).map(|n| n.ports[0]);
    fixed.filter(|&p| fits(effect, &circuit.ports[p])).collect()
}

/// An effect at a site, once for each choice of what it reads beside.
fn at_site(circuit: &Circuit, effect: &Arc<Effect>, component: usize, site: &Site, used: &[usize]) -> Vec<Candidate> {
    let local = |p: &usize| circuit.ports[*p].name.rsplit('.').next().unwrap_or("").to_string();
    let alike = used.iter().map(local).collect::<Vec<_>>().join("|");
    let with = |sense: Vec<usize>| {
        let place = place_of(circuit, effect, site);
        let (base, temperature) = (Vec::new(), None);
        let attachment =
            Attachment { effect: Some(effect.clone()), site: site.clone(), sense, base, temperature, place };
        Candidate { component, alike: alike.clone(), attachment }
    };
    sensed(circuit, effect, component, used).into_iter().map(with).collect()
}

/// Further ports, one for each sensed potential: of the component, or any other for effects that reach so far.
fn sensed(circuit: &Circuit, effect: &Effect, component: usize, used: &[usize]) -> Vec<Vec<usize>> {
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
fn moving(circuit: &Circuit, q: &Quantity) -> Vec<Vec<usize>> {
    let mut places = BTreeSet::new();
    let first = |p: &usize| {
        let port = &circuit.ports[*p];
        let free = !circuit.nodes[port.node].fixed && same_kind(&port.potential.unit, &q.unit);
        free && places.insert(circuit.rigid(*p))
    };
    (0..circuit.ports.len()).filter(first).map(|p| vec![p]).collect()
}

/// A candidate with each choice of base parameters and of a temperature; none where there is nothing to choose.
fn completed(circuit: &Circuit, effect: &Effect, candidate: Candidate) -> Vec<Candidate> {
    let mut all = vec![candidate];
    for q in &effect.base {
        all = all.into_iter().flat_map(|c| based(circuit, q, c)).collect();
    }
    if effect.interface.temperature.is_some() {
        all = all.into_iter().flat_map(|c| warmed(circuit, c)).collect();
    }
    all
}

fn based(circuit: &Circuit, wanted: &Quantity, c: Candidate) -> Vec<Candidate> {
    let component = &circuit.components[c.component];
    let fitting = component.factors.iter().filter(|q| same_kind(&q.unit, &wanted.unit));
    let with = |q: &Quantity| {
        let full = if component.name.is_empty() { q.name.clone() } else { format!("{}.{}", component.name, q.name) };
        let mut attachment = c.attachment.clone();
        attachment.base.push((wanted.name.clone(), full));
        Candidate { component: c.component, alike: format!("{}/{}", c.alike, q.name), attachment }
    };
    fitting.map(with).collect()
}

fn warmed(circuit: &Circuit, c: Candidate) -> Vec<Candidate> {
    let temperatures = circuit.inputs.iter().filter(|i| i.ty == Type::Real && same_kind(&i.unit, "K"));
    let with = |i: &super::circuit::ModelInput| {
        let offset = bramah_expr::units::Unit::parse(&i.unit).map_or(0.0, |u| u.offset);
        let mut attachment = c.attachment.clone();
        attachment.temperature = Some((i.name.clone(), offset));
        Candidate { component: c.component, alike: c.alike.clone(), attachment }
    };
    temperatures.map(with).collect()
}

/// The place as the verdict names it.
fn place_of(circuit: &Circuit, effect: &Effect, site: &Site) -> Place {
    let name = |p: usize| circuit.ports[p].name.clone();
    let node = |p: usize| {
        let names: Vec<String> = circuit.same_place(p).into_iter().map(name).collect();
        (names[0].clone(), names, p)
    };
    let (place, ports, first) = match site {
        Site::Node(p) => node(*p),
        Site::Across(a, _) if effect.interface.attach == Attach::Drain => node(*a),
        Site::Across(a, b) => {
            let place = format!("{}|{}", name(*a), name(*b));
            (place.clone(), vec![place], *a)
        }
        Site::Into(p) => {
            let ports = &circuit.nodes[circuit.ports[*p].node].ports;
            let rest = ports.iter().copied().find(|i| i != p).unwrap_or(*p);
            let place = format!("{}->{}", name(rest), name(*p));
            (place.clone(), vec![place], *p)
        }
        Site::Sensor(n) | Site::Command(n) | Site::Parameter(n) => {
            return Place { place: n.clone(), node: vec![n.clone()], kind: Kind::Signal };
        }
    };
    Place { place, node: ports, kind: Kind::of(&circuit.ports[first].through.unit) }
}

/// What makes two attachments of one effect the same.
type Identity = (Site, Vec<usize>, Vec<(String, String)>, Option<String>);

fn identity(circuit: &Circuit, a: &Attachment) -> Identity {
    // at an imposed motion, either side of a sensor is another place
    let node = |p: &usize| match circuit.ports[*p].node {
        own if circuit.nodes[own].driven => own,
        _ => circuit.rigid(*p),
    };
    let site = match &a.site {
        Site::Node(p) => Site::Node(node(p)),
        Site::Across(x, y) if directed(a) => Site::Across(node(x), node(y)),
        Site::Across(x, y) => Site::Across(node(x).min(node(y)), node(x).max(node(y))),
        Site::Into(p) => {
            let ports = &circuit.nodes[circuit.ports[*p].node].ports;
            Site::Into(if ports.len() == 2 { ports[0] } else { *p })
        }
        other => other.clone(),
    };
    let sense = a.sense.iter().map(node).collect();
    (site, sense, a.base.clone(), a.temperature.as_ref().map(|t| t.0.clone()))
}

fn directed(a: &Attachment) -> bool {
    a.effect.as_ref().is_some_and(|e| e.directed)
}

/// One attachment for all that are the same; parallel bridges are listed in its place.
fn merged(circuit: &Circuit, candidates: &[Candidate]) -> Vec<Attachment> {
    let mut number: BTreeMap<Identity, usize> = BTreeMap::new();
    let mut all: Vec<Attachment> = Vec::new();
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
    circuit: &Circuit,
    effect: &Effect,
    candidates: &[Candidate],
    single: &[Attachment],
) -> Vec<(Vec<Attachment>, Sharing)> {
    let mut groups: Vec<(Vec<Attachment>, Sharing)> = Vec::new();
    let mut seen: BTreeSet<BTreeSet<Identity>> = BTreeSet::new();
    let mut classes: Vec<(&str, &str)> = Vec::new();
    for c in candidates.iter().filter(|c| c.component > 0) {
        let key = (circuit.components[c.component].class.as_str(), c.alike.as_str());
        if !classes.contains(&key) {
            classes.push(key);
        }
    }
    let mut add = |members: Vec<Attachment>, sharing: Sharing| {
        let identities: BTreeSet<Identity> = members.iter().map(|a| identity(circuit, a)).collect();
        if identities.len() > 1 && seen.insert(identities) {
            groups.push((members, sharing));
        }
    };
    for (class, alike) in classes {
        let of_class =
            |c: &&Candidate| c.component > 0 && circuit.components[c.component].class == class && c.alike == alike;
        let ids: BTreeSet<Identity> =
            candidates.iter().filter(of_class).map(|c| identity(circuit, &c.attachment)).collect();
        let members = single.iter().filter(|a| ids.contains(&identity(circuit, a))).cloned().collect();
        add(members, Sharing::Class(class.to_string()));
    }
    let fluid = effect.interface.through.as_ref().is_some_and(|t| same_kind(&t.unit, "m3/s"));
    if fluid && matches!(effect.interface.attach, Attach::Shunt | Attach::Drain) {
        add(single.to_vec(), Sharing::All);
    }
    groups
}

fn hypothesis(circuit: &Circuit, attachments: Vec<Attachment>, sharing: Sharing, signals: &[Signal]) -> Hypothesis {
    let effect = attachments[0].effect.clone().expect("an effect at each place");
    let passes = match &attachments[0].site {
        Site::Sensor(s) => Some(signals.iter().find(|x| x.name == *s).map_or(1.0, |x| x.scale)),
        Site::Command(i) => Some(circuit.inputs.iter().find(|x| x.name == *i).and_then(|x| x.nominal).unwrap_or(1.0)),
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

fn changes_order(circuit: &Circuit, a: &Attachment) -> bool {
    let Some(effect) = &a.effect else { return false };
    let mut ports = a.sense.clone();
    match a.site {
        Site::Node(p) => ports.push(p),
        Site::Across(x, y) => ports.extend([x, y]),
        Site::Into(p) => {
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

fn drift(free: &Free) -> Hypothesis {
    let place = Place { place: free.name.clone(), node: vec![free.name.clone()], kind: Kind::Parameter };
    let site = Site::Parameter(free.name.clone());
    let attachment = Attachment { effect: None, site, sense: vec![], base: vec![], temperature: None, place };
    let coefficient = Coefficient {
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
        sharing: Sharing::Single,
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
        let quantity = || Quantity { name: String::new(), unit: String::new() };
        let port = |node| Port {
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
        let circuit = Circuit { ports: vec![port(0), port(1), port(2), port(0), port(3)], nodes, ..Circuit::default() };
        let meet = |a: Site, b: Site| a.meets(&b, &circuit) && b.meets(&a, &circuit);
        assert!(meet(Site::Node(0), Site::Across(3, 2)), "air and the leak of the same chamber");
        assert!(meet(Site::Across(0, 1), Site::Into(3)));
        assert!(!meet(Site::Across(0, 2), Site::Across(1, 2)), "both end in the tank");
        assert!(!meet(Site::Node(0), Site::Node(1)));
        assert!(meet(Site::Node(1), Site::Node(4)));
        assert!(!meet(Site::Sensor("p".into()), Site::Sensor("p".into())), "which `is_at` tells");
    }
}
