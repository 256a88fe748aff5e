//! Topology of the nominal model: components, ports with their units, nodes, inputs and parameters.
//!
//! Enters: the request of the nominal model. Leaves: a [`CircuitTopology`], which `hypotheses` searches for places.
//! It is read from the instance tree, the connections and the flat equations of the compiler.
//!
//! From the equations it derives what an effect must know of a node:
//! - `fixed`, `driven`: the potential is given, so a flow drawn there changes nothing but the reaction.
//! - `has_rate`, `has_acceleration`: an effect that needs a derivative adds no state.
//! - `rigid`, `geared`: nodes at which an effect would explain the same.

use crate::policy;
use bramah_expr::eval::EvaluationCache;
use bramah_expr::units::MeasurementUnit;
use bramah_expr::{ExprId, ExprNode as Term, Exprs, VarId};
use bramah_model::compile::{CompileOutcome, Request, inspect};
use bramah_model::flat::{ExperimentAnnotation, FlatModel, ScalarType, Variability};
use bramah_model::instance::{ElementState, Instance, InstanceNode, ScopeId};
use bramah_model::network::Network;
use bramah_syntax::ast::ClassKind;
use bramah_syntax::world::World;
use std::collections::{BTreeMap, BTreeSet};

mod links;
pub use links::SignalLink;

/// A variable with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedQuantity {
    /// Its name inside the connector or component.
    pub name: String,
    /// Its unit as written.
    pub unit: String,
}

/// A physical port: a connector with one potential and one flow.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicalPort {
    /// Full name, such as `pump.port_a`.
    pub name: String,
    /// Full name of its connector class.
    pub class: String,
    /// Its component: index into [`CircuitTopology::components`].
    pub component: usize,
    /// The variable that is equal at connected ports.
    pub potential: NamedQuantity,
    /// The variable whose sum over connected ports is zero.
    pub through: NamedQuantity,
    /// Its node: index into [`CircuitTopology::nodes`].
    pub node: usize,
}

/// A node: a set of connected ports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeSet {
    /// Its ports in the order of declaration.
    pub ports: Vec<usize>,
    /// Its potential, or the rate of it, is given by parameters, time and inputs: a reservoir, a frame, a driven belt.
    pub fixed: bool,
    /// Its potential is given by an input. What acts on it changes only the reaction, which a sensor may measure.
    pub driven: bool,
    /// The model contains the time derivative of its potential.
    pub has_rate: bool,
    /// The model contains the second time derivative of its potential.
    pub has_acceleration: bool,
    /// First of the nodes that are rigidly one with it, as the flanges of a mass. What acts on one could act on the
    /// other.
    pub rigid: usize,
    /// First of the nodes whose potentials are bound to its own whatever flows, as the sides of a gear. What acts on
    /// one could act on the other with another size.
    pub geared: usize,
}

/// A component; entry 0 is the model itself.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkComponent {
    /// Full name; empty for the model itself.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// Its ports in the order of declaration.
    pub ports: Vec<usize>,
    /// Its Real parameters with their units.
    pub parameters: Vec<NamedQuantity>,
    /// Those of them that multiply one variable in one equation, as conductances and dampings do.
    pub factors: Vec<NamedQuantity>,
}

/// An input of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelInput {
    /// Its name, with indices.
    pub name: String,
    /// Its type.
    pub ty: ScalarType,
    /// Its unit as written; empty if none.
    pub unit: String,
    /// Its start value, or the value it keeps if nothing is given; `None` if the model states none.
    pub start: Option<f64>,
    /// Its `nominal`; `None` if the model states none.
    pub nominal: Option<f64>,
}

/// Topology of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CircuitTopology {
    /// Full name of the class.
    pub class: String,
    /// The model's `experiment` annotation.
    pub experiment: ExperimentAnnotation,
    /// Components, parents before children.
    pub components: Vec<NetworkComponent>,
    /// Physical ports in the order of declaration.
    pub ports: Vec<PhysicalPort>,
    /// Nodes, in the order of their first port.
    pub nodes: Vec<NodeSet>,
    /// Single connections: two port indices and the index of the component in which the `connect` stands.
    pub connections: Vec<(usize, usize, usize)>,
    /// Inputs of the model.
    pub inputs: Vec<ModelInput>,
    /// Signals that its components receive.
    pub links: Vec<SignalLink>,
    /// Units of all Real variables and parameters, by name.
    pub units: BTreeMap<String, String>,
}

/// Reads the topology of a model. The outcome has the diagnostics of the compiler.
pub fn circuit(world: &dyn World, request: &Request) -> CompileOutcome<CircuitTopology> {
    let CompileOutcome { sources, diagnostics, value } = inspect(world, request, |instance, network, flat| {
        let circuit = TopologyReader::default().read(instance, network, &flat);
        let placed = links::placed(&circuit, instance, network, &flat);
        (circuit, placed)
    });
    let value = value.map(|(circuit, placed)| CircuitTopology { links: links::read(placed, &sources), ..circuit });
    CompileOutcome { sources, diagnostics, value }
}

/// Reader of a topology, with the numbers given to scopes of the instance tree.
#[derive(Default)]
struct TopologyReader {
    /// Topology as far as it is known.
    circuit: CircuitTopology,
    /// Component index by scope.
    component_of: BTreeMap<u32, usize>,
    /// Port index by scope.
    port_of: BTreeMap<u32, usize>,
}

impl TopologyReader {
    /// Reads the complete topology.
    fn read(mut self, instance: &mut Instance<'_, '_>, network: &Network, flat: &FlatModel) -> CircuitTopology {
        self.circuit.class.clone_from(&flat.class);
        self.circuit.experiment = flat.experiment;
        self.components(instance);
        self.nodes(instance, network);
        let potential = |port: &PhysicalPort| format!("{}.{}", port.name, port.potential.name);
        let potentials: Vec<String> = self.circuit.ports.iter().map(potential).collect();
        let rates = VariableRelations::of(flat, &potentials);
        for node in &mut self.circuit.nodes {
            rates.of_node(&potentials, node);
        }
        // rigid nodes first: geared ones include them
        self.rigid(&rates);
        self.geared(&rates);
        self.factors(flat);
        self.circuit.inputs = inputs(flat);
        let real = flat.variables.iter().filter(|v| v.ty == ScalarType::Real);
        self.circuit.units = real.map(|v| (v.name.clone(), v.unit.as_deref().unwrap_or("").to_string())).collect();
        self.circuit
    }

    /// Collects components and their ports. Records and packages are left out.
    fn components(&mut self, instance: &mut Instance<'_, '_>) {
        for scope in bramah_model::network::component_scopes(instance) {
            let template = instance.scope(scope).template.clone();
            let name = instance.scope(scope).name.clone();
            let class = instance.library.full_name(template.class);
            match template.kind {
                ClassKind::Connector { .. } => self.port(instance, scope, name, class),
                ClassKind::Model | ClassKind::Block | ClassKind::Class => {
                    self.component_of.insert(scope.0, self.circuit.components.len());
                    let parameters = parameters(instance, scope);
                    self.circuit.components.push(NetworkComponent {
                        name,
                        class,
                        ports: Vec::new(),
                        parameters,
                        factors: Vec::new(),
                    });
                }
                _ => {}
            }
        }
    }

    /// Adds a connector as a port, if it has exactly one potential and one flow.
    fn port(&mut self, instance: &mut Instance<'_, '_>, scope: ScopeId, name: String, class: String) {
        let Some(component) = instance.scope(scope).owner.and_then(|o| self.component_of.get(&o.0)).copied() else {
            return;
        };
        let variables = own_variables(instance, scope);
        let real = |i: &u32| {
            let v = &instance.variables[*i as usize];
            // stream variables and signals of a connector are neither potential nor flow
            let counts = v.ty == ScalarType::Real && v.variability == Variability::Continuous;
            counts && v.causality.is_none() && !v.stream
        };
        let (flows, potentials): (Vec<u32>, Vec<u32>) =
            variables.into_iter().filter(real).partition(|i| instance.variables[*i as usize].flow);
        let ([through], [potential]) = (&flows[..], &potentials[..]) else { return };
        let port = PhysicalPort {
            component,
            potential: quantity(instance, *potential),
            through: quantity(instance, *through),
            node: 0,
            name,
            class,
        };
        let number = self.circuit.ports.len();
        self.circuit.components[component].ports.push(number);
        self.port_of.insert(scope.0, number);
        self.circuit.ports.push(port);
    }

    /// Unites nodes that are rigidly one: a component keeps their potentials equal and only adds up what flows in.
    fn rigid(&mut self, rates: &VariableRelations<'_>) {
        let CircuitTopology { components, ports, nodes, .. } = &mut self.circuit;
        (0..nodes.len()).for_each(|i| nodes[i].rigid = i);
        // the flows must occur in one equation only, the same for both, so that only their sum counts
        let law =
            |p: &PhysicalPort| rates.only_law(&format!("{}.{}", p.name, p.through.name), &components[p.component].name);
        for c in components.iter() {
            for (i, &a) in c.ports.iter().enumerate() {
                for &b in &c.ports[i + 1..] {
                    let (x, y) = (&ports[a], &ports[b]);
                    let potential = |p: &PhysicalPort| rates.root_of(&format!("{}.{}", p.name, p.potential.name));
                    let equal = potential(x).is_some() && potential(x) == potential(y);
                    if equal && law(x).is_some() && law(x) == law(y) {
                        let (from, to) = (nodes[x.node].rigid, nodes[y.node].rigid);
                        let first = from.min(to);
                        nodes.iter_mut().filter(|n| n.rigid == from || n.rigid == to).for_each(|n| n.rigid = first);
                    }
                }
            }
        }
    }

    /// Unites nodes whose potentials are bound to each other.
    fn geared(&mut self, rates: &VariableRelations<'_>) {
        let CircuitTopology { ports, nodes, .. } = &mut self.circuit;
        (0..nodes.len()).for_each(|i| nodes[i].geared = nodes[i].rigid);
        let root = |p: &PhysicalPort| rates.root_of(&format!("{}.{}", p.name, p.potential.name));
        for pair in &rates.geared {
            let bound: BTreeSet<usize> = ports
                .iter()
                .filter(|p| root(p).is_some_and(|r| pair.contains(&r)))
                .map(|p| nodes[p.node].geared)
                .collect();
            let Some(&first) = bound.first() else { continue };
            nodes.iter_mut().filter(|n| bound.contains(&n.geared)).for_each(|n| n.geared = first);
        }
    }

    /// Finds the parameters that multiply a single variable. Parameters without a unit are left out.
    fn factors(&mut self, flat: &FlatModel) {
        let linear = linear_factors(flat);
        for c in &mut self.circuit.components {
            let full = |q: &&NamedQuantity| linear.contains(format!("{}.{}", c.name, q.name).as_str());
            c.factors = c.parameters.iter().filter(|q| !q.unit.is_empty()).filter(full).cloned().collect();
        }
    }

    /// Makes nodes of connected ports by union-find.
    fn nodes(&mut self, instance: &Instance<'_, '_>, network: &Network) {
        let mut root: Vec<usize> = (0..self.circuit.ports.len()).collect();
        let find = |root: &[usize], mut i: usize| {
            while root[i] != i {
                i = root[i];
            }
            i
        };
        for c in &network.connections {
            let port = |n| match instance.node(n) {
                InstanceNode::Object(s) => self.port_of.get(&s.0).copied(),
                _ => None,
            };
            let (Some(a), Some(b)) = (port(c.a), port(c.b)) else { continue };
            let within = self.component_of.get(&c.scope.0).copied().unwrap_or(0);
            self.circuit.connections.push((a, b, within));
            let (a, b) = (find(&root, a), find(&root, b));
            // the smaller index stays the root, so that nodes come in the order of declaration
            root[a.max(b)] = a.min(b);
        }
        let mut number: BTreeMap<usize, usize> = BTreeMap::new();
        for i in 0..root.len() {
            let first = find(&root, i);
            let node = *number.entry(first).or_insert_with(|| {
                self.circuit.nodes.push(NodeSet::default());
                self.circuit.nodes.len() - 1
            });
            self.circuit.nodes[node].ports.push(i);
            self.circuit.ports[i].node = node;
        }
    }
}

/// Indices of the scalar variables that belong to a scope itself, not to its components.
fn own_variables(instance: &Instance<'_, '_>, scope: ScopeId) -> Vec<u32> {
    let elements = instance.scope(scope).elements.iter();
    let nodes = elements.filter_map(|e| if let ElementState::Node(n) = e { Some(*n) } else { None });
    nodes.filter_map(|n| if let InstanceNode::Var(i) = instance.node(n) { Some(*i) } else { None }).collect()
}

/// A variable with its unit, by its last name.
fn quantity(instance: &mut Instance<'_, '_>, variable: u32) -> NamedQuantity {
    let full = &instance.variables[variable as usize].name;
    let name = full.rsplit('.').next().unwrap_or(full).to_string();
    NamedQuantity { name, unit: instance.parameters().text_attribute(variable, "unit").unwrap_or_default() }
}

/// Visible Real parameters of a component.
fn parameters(instance: &mut Instance<'_, '_>, scope: ScopeId) -> Vec<NamedQuantity> {
    let mut all = own_variables(instance, scope);
    all.retain(|i| {
        let v = &instance.variables[*i as usize];
        v.ty == ScalarType::Real && !v.hidden && v.variability == Variability::Parameter
    });
    all.into_iter().map(|i| quantity(instance, i)).collect()
}

/// Inputs of the flat model.
fn inputs(flat: &FlatModel) -> Vec<ModelInput> {
    let number = |e: Option<ExprId>| e.and_then(|e| flat.exprs.as_num(e));
    let inputs = flat.variables.iter().filter(|v| v.input);
    inputs
        .map(|v| ModelInput {
            name: v.name.clone(),
            ty: v.ty,
            unit: v.unit.as_deref().unwrap_or("").to_string(),
            start: number(v.binding).or(number(v.start)),
            nominal: number(v.nominal),
        })
        .collect()
}

/// Relations between the variables of the flat model: which are equal, which have derivatives, which are given.
/// Variables stand for all that are equal to them, by the root of a union-find.
struct VariableRelations<'a> {
    /// The flat model.
    flat: &'a FlatModel,
    /// Union-find over variables that an equation sets equal.
    root: Vec<u32>,
    /// Roots whose derivative occurs in the model.
    differentiated: BTreeSet<u32>,
    /// Roots whose second derivative occurs in the model.
    accelerated: BTreeSet<u32>,
    /// Roots whose derivative is given by parameters, time and inputs.
    steady: BTreeSet<u32>,
    /// Roots that are given by parameters, time and inputs.
    fixed: BTreeSet<u32>,
    /// Fixed and steady roots in which an input has a part.
    driven: BTreeSet<u32>,
    /// Pairs of potentials that one equation binds to each other.
    geared: Vec<BTreeSet<u32>>,
    /// Index of each variable by name.
    index: BTreeMap<&'a str, u32>,
}

impl<'a> VariableRelations<'a> {
    /// Derives all relations; `potentials` are the full names of the ports' potentials.
    /// Equal variables are united first, so that every relation holds for all of them.
    fn of(flat: &'a FlatModel, potentials: &[String]) -> Self {
        let count = u32::try_from(flat.variables.len()).expect("fewer than 2^32 variables");
        let index = (0u32..).zip(&flat.variables).map(|(i, v)| (v.name.as_str(), i)).collect();
        let root = (0..count).collect();
        let none = BTreeSet::new;
        let (differentiated, accelerated, steady, fixed, driven) = (none(), none(), none(), none(), none());
        let geared = Vec::new();
        let mut rates =
            VariableRelations { flat, root, differentiated, accelerated, steady, fixed, driven, geared, index };
        rates.unite();
        for e in &flat.equations {
            for side in [e.lhs, e.rhs] {
                for v in flat.exprs.derivatives(side) {
                    let root = rates.find(v.0);
                    rates.differentiated.insert(root);
                }
            }
            for (one, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
                if let (Some(v), true) = (rates.variable(one), rates.constant(other)) {
                    let root = rates.find(v);
                    rates.fixed.insert(root);
                    if rates.by_input(other) {
                        rates.driven.insert(root);
                    }
                }
            }
        }
        // needs all first derivatives and given variables
        rates.accelerations();
        let potentials = potentials.iter().filter_map(|name| rates.root_of(name)).collect();
        rates.geared = flat.equations.iter().filter_map(|e| rates.bound(e, &potentials)).collect();
        // behind an ideal gear the other side has the same derivatives
        rates.differentiated = with_geared(rates.differentiated.clone(), &rates.geared);
        rates.accelerated = with_geared(rates.accelerated.clone(), &rates.geared);
        rates
    }

    /// The two potentials that an equation without other variables binds to each other, as an ideal gear does.
    fn bound(&self, e: &bramah_model::flat::FlatEquation, potentials: &BTreeSet<u32>) -> Option<BTreeSet<u32>> {
        let leaves = self.flat.exprs.dependencies(&[e.lhs, e.rhs]);
        let moving = |v: &&VarId| self.flat.variables[v.index()].variability > Variability::Parameter;
        let roots: BTreeSet<u32> = leaves.vars.iter().filter(moving).map(|v| self.find(v.0)).collect();
        let binds = leaves.ders.is_empty() && leaves.pres.is_empty() && roots.len() == 2;
        (binds && roots.is_subset(potentials)).then_some(roots)
    }

    /// Unites variables that an equation `a = b` sets equal.
    fn unite(&mut self) {
        for e in &self.flat.equations {
            let (Some(a), Some(b)) = (self.variable(e.lhs), self.variable(e.rhs)) else { continue };
            let (a, b) = (self.find(a), self.find(b));
            self.root[a.max(b) as usize] = a.min(b);
        }
    }

    /// Finds variables whose derivative is itself differentiated, or given.
    /// A speed that is given makes its angle steady; a speed that is differentiated makes its angle accelerated.
    fn accelerations(&mut self) {
        for e in &self.flat.equations {
            for (one, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
                let Term::Der(x) = self.flat.exprs.node(other) else { continue };
                let root = self.find(x.0);
                let rate = self.variable(one).map(|v| self.find(v));
                if rate.is_some_and(|r| self.differentiated.contains(&r)) {
                    self.accelerated.insert(root);
                }
                if rate.is_some_and(|r| self.fixed.contains(&r)) || self.constant(one) {
                    self.steady.insert(root);
                    if rate.is_some_and(|r| self.driven.contains(&r)) || self.by_input(one) {
                        self.driven.insert(root);
                    }
                }
            }
        }
    }

    /// The continuous variable that an expression consists of.
    fn variable(&self, e: ExprId) -> Option<u32> {
        match self.flat.exprs.node(e) {
            Term::Var(VarId(v)) if self.flat.variables[v as usize].variability == Variability::Continuous => Some(v),
            _ => None,
        }
    }

    /// Whether an expression is given from outside: by parameters, time and inputs.
    fn constant(&self, e: ExprId) -> bool {
        let leaves = self.flat.exprs.dependencies(&[e]);
        let given = |v: &VarId| {
            let v = &self.flat.variables[v.index()];
            v.input || v.variability <= Variability::Parameter
        };
        leaves.ders.is_empty() && leaves.pres.is_empty() && leaves.vars.iter().all(given)
    }

    /// Whether an expression contains an input.
    fn by_input(&self, e: ExprId) -> bool {
        self.flat.exprs.dependencies(&[e]).vars.iter().any(|v| self.flat.variables[v.index()].input)
    }

    /// The root of a variable.
    fn find(&self, mut i: u32) -> u32 {
        while self.root[i as usize] != i {
            i = self.root[i as usize];
        }
        i
    }

    /// The root of a variable by name.
    fn root_of(&self, name: &str) -> Option<u32> {
        self.index.get(name).map(|&i| self.find(i))
    }

    /// Index of the equation of a component in which a flow occurs; `None` if there are none or several.
    fn only_law(&self, through: &str, component: &str) -> Option<usize> {
        let variable = VarId(*self.index.get(through)?);
        let instance = self.flat.instances.iter().position(|i| i.name == component)?;
        let mut all = (0..).zip(&self.flat.equations).filter(|(_, e)| e.origin.instance as usize == instance);
        let holds = |e: &bramah_model::flat::FlatEquation| {
            self.flat.exprs.dependencies(&[e.lhs, e.rhs]).vars.contains(&variable)
        };
        let first = all.by_ref().find(|(_, e)| holds(e))?.0;
        all.all(|(_, e)| !holds(e)).then_some(first)
    }

    /// Fills in what is known of a node from the potentials of its ports.
    /// `potentials`: full name of the potential of every port of the model.
    fn of_node(&self, potentials: &[String], node: &mut NodeSet) {
        for name in node.ports.clone().into_iter().map(|p| &potentials[p]) {
            let Some(&i) = self.index.get(name.as_str()) else { continue };
            let root = self.find(i);
            node.fixed |= self.fixed.contains(&root) || self.steady.contains(&root);
            node.driven |= self.driven.contains(&root);
            node.has_rate |= self.differentiated.contains(&root);
            node.has_acceleration |= self.accelerated.contains(&root);
        }
    }
}

/// Roots with a derivative, and all that are bound to them, until nothing is added.
fn with_geared(mut known: BTreeSet<u32>, geared: &[BTreeSet<u32>]) -> BTreeSet<u32> {
    loop {
        let before = known.len();
        for pair in geared {
            if !pair.is_disjoint(&known) {
                known.extend(pair);
            }
        }
        if known.len() == before {
            return known;
        }
    }
}

/// Names of parameters that occur only as the factor of one variable: `q = G*dp`.
fn linear_factors(flat: &FlatModel) -> BTreeSet<&str> {
    let mut exprs = flat.exprs.clone();
    let known = known(flat);
    let mut met: BTreeMap<u32, bool> = BTreeMap::new();
    for e in &flat.equations {
        let leaves = flat.exprs.dependencies(&[e.lhs, e.rhs]);
        let parameter = |v: &&VarId| flat.variables[v.index()].variability == Variability::Parameter;
        for &p in leaves.vars.iter().filter(parameter) {
            let linear = [e.lhs, e.rhs].into_iter().any(|side| multiplies_one(&known, &mut exprs, side, p));
            // a parameter that is a factor in one equation and something else in another is none
            met.entry(p.0).and_modify(|l| *l &= linear).or_insert(linear);
        }
    }
    let linear = met.into_iter().filter(|(_, linear)| *linear);
    linear.map(|(v, _)| flat.variables[v as usize].name.as_str()).collect()
}

/// Whether the derivative of a side by a parameter is one variable, its negative, or a difference of two.
/// It is evaluated instead of compared as an expression, because it may be hidden behind branches that parameters
/// choose. `known`: values of parameters and of what follows from them.
fn multiplies_one(known: &BTreeMap<VarId, f64>, exprs: &mut Exprs, side: ExprId, parameter: VarId) -> bool {
    let leaf = exprs.var(parameter);
    if !exprs.contains(side, leaf) {
        return false;
    }
    let slope = exprs.differentiate(side, leaf);
    let leaves = exprs.dependencies(&[slope]);
    let moving = |v: &&VarId| !known.contains_key(v);
    let moving: Vec<VarId> = leaves.vars.iter().filter(moving).copied().collect();
    if !leaves.ders.is_empty() || moving.is_empty() || moving.len() > 8 {
        return false;
    }
    // unequal values of the variables, so that products of two do not look like one
    let at = |shift: f64, bumped: Option<VarId>| {
        let mut values = |v: VarId| {
            let place = moving.iter().position(|m| *m == v).map_or(0.0, |i| (i + 1) as f64);
            shift * (1.0 + policy::PROBE_SPREAD * place) + if bumped == Some(v) { 1.0 } else { 0.0 }
        };
        value_at(known, exprs, slope, &mut values)
    };
    let slopes = moving.iter().map(|&v| policy::PROBE_POINTS.map(|x| at(x, Some(v)) - at(x, None)));
    let mut count = 0;
    for [a, b] in slopes {
        // slopes must be the same at both points and 0 or 1 in size
        if (a - b).abs() > policy::SAME_SLOPE
            || !(a.abs() < policy::SAME_SLOPE || (a.abs() - 1.0).abs() < policy::SAME_SLOPE)
        {
            return false;
        }
        count += usize::from(a != 0.0);
    }
    matches!(count, 1 | 2)
}

/// Values of parameters, and of variables that an equation gives by known values alone.
/// Branches that parameters choose are evaluated, so that what is switched off does not count.
fn known(flat: &FlatModel) -> BTreeMap<VarId, f64> {
    let mut open: Vec<(VarId, ExprId)> = Vec::new();
    for (i, v) in (0u32..).zip(&flat.variables) {
        if v.variability <= Variability::Parameter {
            open.push((VarId(i), v.binding.or(v.start).unwrap_or(Exprs::ZERO)));
        }
    }
    for e in &flat.equations {
        for (one, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
            if let Term::Var(v) = flat.exprs.node(one) {
                open.push((v, other));
            }
        }
    }
    let mut known = BTreeMap::new();
    // each pass may make further values computable
    loop {
        let before = known.len();
        open.retain(|(v, e)| {
            let value = if known.contains_key(v) { None } else { steady_value(&known, &flat.exprs, *e) };
            if let Some(value) = value {
                known.insert(*v, value);
            }
            value.is_none() && !known.contains_key(v)
        });
        if known.len() == before {
            return known;
        }
    }
}

/// Value of an expression; `None` if it needs more than what is known.
fn steady_value(known: &BTreeMap<VarId, f64>, exprs: &Exprs, e: ExprId) -> Option<f64> {
    let mut enough = true;
    let value = EvaluationCache::default().value(exprs, e, &mut |leaf| match leaf {
        Term::Var(v) if known.contains_key(&v) => known[&v],
        _ => {
            enough = false;
            0.0
        }
    });
    enough.then_some(value)
}

/// Value of an expression with known values, and other variables from `moving`.
fn value_at(known: &BTreeMap<VarId, f64>, exprs: &Exprs, e: ExprId, moving: &mut dyn FnMut(VarId) -> f64) -> f64 {
    EvaluationCache::default().value(exprs, e, &mut |leaf| match leaf {
        Term::Var(v) => known.get(&v).copied().unwrap_or_else(|| moving(v)),
        _ => 0.0,
    })
}

impl CircuitTopology {
    /// The signal inside the model with this name.
    pub fn link(&self, name: &str) -> Option<&SignalLink> {
        self.links.iter().find(|l| l.signal.name == name)
    }

    /// Number shared by all nodes that are rigidly one with that of a port.
    pub fn rigid(&self, port: usize) -> usize {
        self.nodes[self.ports[port].node].rigid
    }

    /// Number shared by all nodes whose potentials are bound to that of a port.
    pub fn geared(&self, port: usize) -> usize {
        self.nodes[self.ports[port].node].geared
    }

    /// All ports of the nodes that are rigidly one with that of a port, in the order of declaration.
    pub fn same_place(&self, port: usize) -> Vec<usize> {
        let rigid = self.rigid(port);
        (0..self.ports.len()).filter(|&p| self.rigid(p) == rigid).collect()
    }
}

/// Whether two units measure the same quantity; scales may differ, angles count as a dimension.
pub fn same_kind(a: &str, b: &str) -> bool {
    match (MeasurementUnit::parse(a), MeasurementUnit::parse(b)) {
        (Ok(x), Ok(y)) => x.dimension == y.dimension && x.angle == y.angle && a.is_empty() == b.is_empty(),
        _ => false,
    }
}
