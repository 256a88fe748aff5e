//! From `connect` equations to connection sets (MLS 9.2).
//!
//! Enters: the equation sections of all components. Leaves: the sets of a [`Network`]. [`ConnectionCollector::collect`]
//! walks the components, resolves both sides of each `connect`, checks that they fit (MLS 9.3), and joins their
//! variables, element by element, in union-find structures for potentials, flows and streams.

use super::overconstrained::{OverconstrainedLink, VirtualConnectionGraph, is_graph_statement};
use super::{Connection, FlowSet, Network, PotentialSet, SignalPair, StreamSet};
use crate::instance::deduce::LoopBody;
use crate::instance::lookup::LookupResult;
use crate::instance::references::NodeSelection;
use crate::instance::template::{BaseClass, TemplateElementKind, same_pair};
use crate::instance::{Instance, InstanceNode, LookupContext, NodeId, ScopeId, StreamMember};
use bramah_expr::types::{ScalarType, Variability};
use bramah_syntax::ast::{self, ClassBody, ClassKind, Equation, EquationKind, Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::{FxHashMap, FxHashSet};

/// Union-find over variables. A key is a variable and whether it is seen as an outside connector; keys get numbers in
/// the order in which they come.
///
/// The structure keeps insertion order, so that the network is the same for the same text.
#[derive(Default)]
struct ConnectionSets {
    /// By key: its number.
    index: FxHashMap<(u32, bool), usize>,
    /// By number: the key, with the first `connect` that joined it and the instance in which that stands.
    keys: Vec<((u32, bool), Span, ScopeId)>,
    /// By number: a number nearer to the root of its set.
    parent: Vec<usize>,
}

impl ConnectionSets {
    /// The number of a key. A new key gets the next number and a set of its own.
    fn key(&mut self, key: (u32, bool), span: Span, scope: ScopeId) -> usize {
        *self.index.entry(key).or_insert_with(|| {
            self.keys.push((key, span, scope));
            self.parent.push(self.parent.len());
            self.parent.len() - 1
        })
    }

    /// The number that stands for the set of a number. Halves the path on the way.
    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Joins two sets.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number stays the root, so that sets come out in the order of their first member.
        self.parent[a.max(b)] = a.min(b);
    }

    /// All sets, in the order of their first members, which come in the order of their numbers.
    fn groups(mut self) -> Vec<Vec<((u32, bool), Span, ScopeId)>> {
        let mut place: FxHashMap<usize, usize> = FxHashMap::default();
        let mut groups: Vec<Vec<_>> = Vec::new();
        for i in 0..self.keys.len() {
            let root = self.root(i);
            let at = *place.entry(root).or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
            groups[at].push(self.keys[i]);
        }
        groups
    }
}

/// One side of a `connect`.
/// A single port is an array without dimensions.
struct ConnectionEnd {
    /// The ports that it names, with the sizes of the array if it is one.
    selection: NodeSelection,
    /// Whether it is an outside connector: a connector of the component in which the `connect` stands (MLS 9.1.2).
    outside: bool,
}

/// Collects connections while the components are walked.
/// Sets are built in the order in which connections are met.
#[derive(Default)]
pub(super) struct ConnectionCollector {
    /// The result so far.
    network: Network,
    /// Sets of potentials. They make no difference between inside and outside.
    potentials: ConnectionSets,
    /// Sets of flows, with inside and outside apart.
    flows: ConnectionSets,
    /// Sets of stream variables, with inside and outside apart.
    streams: ConnectionSets,
    /// The connection graph of overconstrained components.
    forest: VirtualConnectionGraph,
}

impl ConnectionCollector {
    /// Walks all components and returns the network.
    pub(super) fn collect(mut self, instance: &mut Instance<'_, '_>) -> Network {
        for scope in component_scopes(instance) {
            self.scope(instance, scope);
        }
        // After all components: the spanning trees depend on the whole graph.
        self.overconstrained(instance);
        // A flow that occurs only as an outside connector is still open from outside.
        let inside: std::collections::BTreeSet<u32> =
            self.flows.keys.iter().filter(|(k, ..)| !k.1).map(|(k, ..)| k.0).collect();
        let joined: FxHashSet<u32> = self.potentials.keys.iter().chain(&self.flows.keys).map(|(k, ..)| k.0).collect();
        self.network.unused = (0u32..)
            .zip(&instance.variables)
            // Variables that are not in the flat model have no number.
            .filter(|(i, v)| {
                !joined.contains(i) && v.id.0 != u32::MAX && instance.scope(v.scope).template.is_expandable()
            })
            .filter(|(_, v)| v.variability > Variability::Parameter && v.binding.is_none())
            .map(|(i, _)| i)
            .collect();
        self.network.potentials = self
            .potentials
            .groups()
            .into_iter()
            .map(|g| PotentialSet { scope: g[0].2, members: g.into_iter().map(|(k, span, _)| (k.0, span)).collect() })
            .collect();
        self.network.flows = self
            .flows
            .groups()
            .into_iter()
            .map(|g| FlowSet { span: g[0].1, scope: g[0].2, members: g.into_iter().map(|(k, ..)| k).collect() })
            .collect();
        for group in self.streams.groups() {
            let (span, scope) = (group[0].1, group[0].2);
            let member = |((variable, outside), ..): ((u32, bool), Span, ScopeId)| {
                Some(StreamMember { variable, flow: instance.stream_flow(variable)?, outside })
            };
            let members = group.into_iter().filter_map(member).collect();
            self.network.streams.push(StreamSet { members, span, scope });
        }
        let all = 0..u32::try_from(instance.variables.len()).expect("limited sizes");
        self.network.open = all
            .filter(|i| {
                let v = &instance.variables[*i as usize];
                v.flow && v.id.0 != u32::MAX && !inside.contains(i)
            })
            .collect();
        self.network
    }

    /// Joins overconstrained components along the spanning trees of their graph. The other connections become
    /// constraints.
    ///
    /// The chosen roots go to the instance, where `Connections.isRoot` and `Connections.rooted` read them.
    fn overconstrained(&mut self, instance: &mut Instance<'_, '_>) {
        let (links, spanned) = std::mem::take(&mut self.forest).span(instance);
        for (link, kept) in links.into_iter().zip(spanned.kept) {
            if kept {
                let at = ConnectSite { span: link.span, scope: link.scope, a: link.span, b: link.span };
                self.join_alike(instance, (link.a, false), (link.b, false), &at);
            } else {
                self.network.constrained.push(link);
            }
        }
        (instance.overconstrained.roots, instance.overconstrained.rooted) = (spanned.roots, spanned.rooted);
    }

    /// Reads the equation sections of one component, with those of its base classes.
    /// The names in a base class are looked up there.
    fn scope<'a>(&mut self, instance: &mut Instance<'a, '_>, scope: ScopeId) {
        let template = instance.scope(scope).template.clone();
        for (base, i) in template.bases.iter().zip(0u32..) {
            let ClassBody::Long(body) = &base.ast.body else { continue };
            let view = LookupContext { scope, base: i };
            self.equations(instance, &body.equations, view, base);
        }
    }

    /// Reads the connections in a list of equations. `for` loops are unrolled, `if` branches selected.
    /// Connections that a `break` modifier removes are skipped.
    fn equations<'a>(
        &mut self,
        instance: &mut Instance<'a, '_>,
        equations: &'a [Equation],
        view: LookupContext,
        base: &BaseClass<'_>,
    ) {
        for e in equations {
            match &e.kind {
                EquationKind::Connect(a, b) if !is_broken(base, a, b) => {
                    self.connect(instance, a, b, view, e.span);
                }
                EquationKind::Call(call) => {
                    if let ExprKind::Call { function, args, .. } = &call.kind
                        && is_graph_statement(function)
                    {
                        self.forest.add(instance, function, args, view, e.span);
                    }
                }
                // Loops without connections are not unrolled here; that is left to `flat`.
                EquationKind::For { iterators, body } if concerns_network(body) => {
                    instance.statements().for_each(iterators, LoopBody::Equations(body), view, &mut |instance| {
                        self.equations(instance, body, view, base);
                    });
                }
                // The condition of connections must be a parameter expression (MLS 8.3.3), so a branch can be selected
                // now.
                EquationKind::If { branches, otherwise } => {
                    let connects = branches.iter().any(|(_, b)| concerns_network(b)) || concerns_network(otherwise);
                    if connects && let Some(body) = choose(instance, branches, otherwise, view) {
                        self.equations(instance, body, view, base);
                    }
                }
                _ => {}
            }
        }
    }

    /// Reads one `connect`. Both sides must be ports, different ones, and arrays of the same size.
    ///
    /// Both sides may be arrays of ports; they are joined element by element. Errors: a side that is no port, both
    /// sides the same port, different sizes (E105).
    fn connect<'a>(
        &mut self,
        instance: &mut Instance<'a, '_>,
        a: &'a Expr,
        b: &'a Expr,
        view: LookupContext,
        span: Span,
    ) {
        let (x, y) = (end(instance, a, view), end(instance, b, view));
        // An absent conditional component takes its connections away (MLS 4.4.5); errors have been reported.
        let (Some(Some(x)), Some(Some(y))) = (x, y) else { return };
        if !all_ports(instance, &x, a.span) || !all_ports(instance, &y, b.span) {
            return;
        }
        // A port joined to itself would give the equation `p = p`.
        if x.selection.nodes == y.selection.nodes {
            let name = instance.node_name(x.selection.nodes[0]);
            instance.diagnostics.push(
                Diagnostic::new(Code::BadConnect, format!("`{name}` is connected to itself"))
                    .at(span, "both sides are the same port")
                    .help("name the port of another component, or remove the line"),
            );
            return;
        }
        if x.selection.dims != y.selection.dims {
            let text = crate::instance::value::size_text;
            instance.diagnostics.push(
                Diagnostic::new(Code::BadConnect, "arrays of ports of different size cannot be joined")
                    .at(span, format!("sizes {} and {}", text(&x.selection.dims), text(&y.selection.dims)))
                    .help("connect slices of equal size, or single elements in a `for`"),
            );
            return;
        }
        for (&m, &n) in x.selection.nodes.iter().zip(y.selection.nodes.iter()) {
            let place = ConnectSite { span, scope: view.scope, a: a.span, b: b.span };
            self.join(instance, (m, x.outside), (n, y.outside), &place);
            for port in [m, n] {
                // For `cardinality`, which counts the connections of a port.
                *instance.connected.entry(port).or_default() += 1;
            }
            self.network.connections.push(Connection { a: m, b: n, span, scope: view.scope });
        }
    }

    /// Joins two nodes. A connection of overconstrained components is put aside until the spanning trees are known.
    /// `true` beside a node marks an outside connector.
    fn join(&mut self, instance: &mut Instance<'_, '_>, a: (NodeId, bool), b: (NodeId, bool), at: &ConnectSite) {
        if instance.builder().is_overconstrained(a.0) && instance.builder().is_overconstrained(b.0) {
            self.forest.links.push(OverconstrainedLink { a: a.0, b: b.0, span: at.span, scope: at.scope });
            return;
        }
        self.join_alike(instance, a, b, at);
    }

    /// Joins two nodes of the same kind: variables, arrays element by element, or connectors and records member by
    /// member.
    /// Different kinds are reported (E104).
    fn join_alike(&mut self, instance: &mut Instance<'_, '_>, a: (NodeId, bool), b: (NodeId, bool), at: &ConnectSite) {
        match (instance.node(a.0).clone(), instance.node(b.0).clone()) {
            (InstanceNode::Var(x), InstanceNode::Var(y)) => self.join_variables(instance, (x, a.1), (y, b.1), at),
            (InstanceNode::Array { dims: da, elements: x, .. }, InstanceNode::Array { dims: db, elements: y, .. })
                if da == db =>
            {
                for (&x, &y) in x.iter().zip(y.iter()) {
                    self.join(instance, (x, a.1), (y, b.1), at);
                }
            }
            (InstanceNode::Object(x), InstanceNode::Object(y)) => self.join_objects(instance, (x, a.1), (y, b.1), at),
            _ => mismatch(instance, a.0, b.0, at),
        }
    }

    /// Joins two connectors or records, which must have members of the same names (MLS 9.3).
    ///
    /// Members are matched by name, so that their order does not matter. Different members are reported as E104 between
    /// connectors, else as E105.
    fn join_objects(
        &mut self,
        instance: &mut Instance<'_, '_>,
        a: (ScopeId, bool),
        b: (ScopeId, bool),
        at: &ConnectSite,
    ) {
        let (ta, tb) = (instance.scope(a.0).template.clone(), instance.scope(b.0).template.clone());
        let fits =
            ta.elements.len() == tb.elements.len() && ta.elements.iter().all(|e| tb.by_name.contains_key(&e.name));
        let connectors =
            [&ta, &tb].iter().all(|t| matches!(t.kind, ClassKind::Connector { .. } | ClassKind::Record { .. }));
        if !fits || !connectors {
            let (na, nb) = (instance.scope(a.0).name.clone(), instance.scope(b.0).name.clone());
            let (ca, cb) = (instance.library.full_name(ta.class), instance.library.full_name(tb.class));
            // Two connectors that do not fit are of different domains; else one side is no connector at all.
            let code = if connectors { Code::DomainMismatch } else { Code::BadConnect };
            let names = |t: &crate::instance::template::Template<'_>| {
                t.elements.iter().map(|e| format!("`{}`", e.name)).collect::<Vec<_>>().join(", ")
            };
            instance.diagnostics.push(
                Diagnostic::new(code, format!("`{na}` and `{nb}` are of different kinds and cannot be joined"))
                    .at(at.a, format!("a `{ca}` with {}", names(&ta)))
                    .at(at.b, format!("a `{cb}` with {}", names(&tb)))
                    .help("connect ports of the same kind, or put a component between them that changes one into the other"),
            );
            return;
        }
        for (e, i) in ta.elements.iter().zip(0u32..) {
            // Classes inside a connector take no part.
            if !matches!(e.kind, TemplateElementKind::Component(_)) {
                continue;
            }
            let (x, y) = (instance.builder().component(a.0, i), instance.builder().component(b.0, tb.by_name[&e.name]));
            if let (Some(x), Some(y)) = (x, y) {
                self.join(instance, (x, a.1), (y, b.1), at);
            }
        }
    }

    /// Joins two scalar variables. Both must be flows or none, and of one type and dimension. Parameters are compared
    /// instead of joined.
    ///
    /// A pair with an input or output is also recorded as a signal pair, from which `flat` finds signals with two
    /// sources.
    fn join_variables(&mut self, instance: &mut Instance<'_, '_>, a: (u32, bool), b: (u32, bool), at: &ConnectSite) {
        let (x, y) = (&instance.variables[a.0 as usize], &instance.variables[b.0 as usize]);
        if x.flow != y.flow || x.ty != y.ty {
            let (nx, ny) = (x.name.clone(), y.name.clone());
            instance.diagnostics.push(
                Diagnostic::new(Code::BadConnect, format!("`{nx}` and `{ny}` cannot be joined")).at(
                    at.span,
                    if x.flow == y.flow { "they are of different types" } else { "only one of them is a flow" },
                ),
            );
            return;
        }
        if different_units(instance, a.0, b.0, at) {
            return;
        }
        let (x, y) = (&instance.variables[a.0 as usize], &instance.variables[b.0 as usize]);
        if x.variability.min(y.variability) <= Variability::Parameter {
            same_parameters(instance, a.0, b.0, at);
            return;
        }
        let flow = x.flow;
        if x.causality.is_some() || y.causality.is_some() {
            self.network.signals.push(SignalPair { a: a.0, b: b.0, span: at.span, scope: at.scope });
        }
        let stream = x.stream;
        let sets = match (flow, stream) {
            (true, _) => &mut self.flows,
            (_, true) => &mut self.streams,
            _ => &mut self.potentials,
        };
        // Potentials of inside and outside connectors are equal alike; for flows and streams the side decides the sign.
        let side = |s: (u32, bool)| if flow || stream { s } else { (s.0, false) };
        let i = sets.key(side(a), at.span, at.scope);
        let j = sets.key(side(b), at.span, at.scope);
        sets.join(i, j);
    }
}

/// Checks that constants and parameters of joined connectors are of one variability and have one value (MLS 9.3).
/// Values that are not known yet are not compared. Values that agree to nine digits count as equal. The code is E105.
fn same_parameters(instance: &mut Instance<'_, '_>, a: u32, b: u32, at: &ConnectSite) {
    let of = |i: u32| &instance.variables[i as usize];
    let (kinds, names) = ([a, b].map(|i| of(i).variability), [a, b].map(|i| of(i).name.clone()));
    let message = if kinds[0] == kinds[1] {
        let values = [a, b].map(|i| instance.peek(i));
        let [Some(x), Some(y)] = values else { return };
        if (x - y).abs() <= 1e-9 * x.abs().max(y.abs()) {
            return;
        }
        format!("`{}` is {x} and `{}` is {y}, and joined ports need one value", names[0], names[1])
    } else {
        format!("`{}` and `{}` cannot be joined: one of them changes where the other one does not", names[0], names[1])
    };
    let d = Diagnostic::new(Code::BadConnect, message).at(at.span, "joined here").note("Modelica 3.6, 9.3");
    instance.diagnostics.push(d.help("give both ports the same value"));
}

/// The place of a `connect`, for messages.
struct ConnectSite {
    /// The whole equation.
    span: Span,
    /// The instance in which it stands.
    scope: ScopeId,
    /// Its first argument.
    a: Span,
    /// Its second argument.
    b: Span,
}

/// The scopes of component instances, parents before children, in declaration order. The first one is the model.
pub fn component_scopes(instance: &Instance<'_, '_>) -> Vec<ScopeId> {
    let all = (0u32..).zip(&instance.scopes).filter(|(_, s)| s.component);
    all.map(|(i, _)| ScopeId(i)).collect()
}

/// Whether a list of equations contains `connect` or a statement about the connection graph, at any depth.
/// It saves evaluating loops and conditions for nothing.
fn concerns_network(equations: &[Equation]) -> bool {
    equations.iter().any(|e| match &e.kind {
        EquationKind::Connect(..) => true,
        EquationKind::Call(call) => {
            matches!(&call.kind, ExprKind::Call { function, .. } if is_graph_statement(function))
        }
        EquationKind::For { body, .. } => concerns_network(body),
        EquationKind::If { branches, otherwise } => {
            branches.iter().any(|(_, b)| concerns_network(b)) || concerns_network(otherwise)
        }
        _ => false,
    })
}

/// The branch of an `if` equation that holds. `None`, after a message, where a condition is not known.
/// It is the `else` part, which may be empty, where no condition holds.
fn choose<'a>(
    instance: &mut Instance<'a, '_>,
    branches: &'a [(Expr, Vec<Equation>)],
    otherwise: &'a [Equation],
    view: LookupContext,
) -> Option<&'a [Equation]> {
    for (condition, body) in branches {
        if instance.evaluator().constant_boolean(condition, view)? {
            return Some(body);
        }
    }
    Some(otherwise)
}

/// The ports that a side of `connect` names. `None` after a message, `Some(None)` if a conditional component is absent.
/// A side must be a name; any other expression is reported.
fn end<'a>(instance: &mut Instance<'a, '_>, e: &'a Expr, view: LookupContext) -> Option<Option<ConnectionEnd>> {
    let ExprKind::Reference(r) = &e.kind else {
        instance.diagnostics.push(
            Diagnostic::new(Code::BadConnect, "only ports can be connected")
                .at(e.span, "this is not the name of a port")
                .help("write `connect(a.port, b.port)`; for other relations write an equation"),
        );
        return None;
    };
    let Some(LookupResult::Component(scope, index)) = instance.names().lookup(view, r.parts[0].name.name) else {
        // The general evaluation reports what is wrong with the name.
        instance.evaluator().eval(e, view);
        if !instance.diagnostics.iter().any(Diagnostic::is_error) {
            instance
                .diagnostics
                .push(Diagnostic::new(Code::BadConnect, "only ports can be connected").at(e.span, "this is no port"));
        }
        return None;
    };
    let outside = is_connector(instance, scope, index, view);
    let Some(selection) = instance.evaluator().port_selection(r, scope, index, view)? else { return Some(None) };
    Some(Some(ConnectionEnd { selection, outside }))
}

/// Whether all nodes of an end are ports. Reports the first that is none.
/// For a component the help lists its ports.
fn all_ports(instance: &mut Instance<'_, '_>, end: &ConnectionEnd, span: Span) -> bool {
    let Some(&node) = end.selection.nodes.iter().find(|&&n| !is_port(instance, n)) else { return true };
    let name = instance.node_name(node);
    let mut d = Diagnostic::new(Code::BadConnect, "only ports can be connected");
    d = match instance.node(node) {
        InstanceNode::Object(scope) => {
            let template = instance.scope(*scope).template.clone();
            let class = instance.library.full_name(template.class);
            let ports = port_names(instance, *scope);
            let d = d.at(span, format!("`{name}` is a component of class `{class}`"));
            match ports.first() {
                Some(first) => d
                    .help(format!("name one of its ports: {}", ports.join(", ")))
                    .note(format!("for instance `connect({name}.{}, ...)`", first.trim_matches('`'))),
                None => d.help("it has no ports"),
            }
        }
        _ => d.at(span, format!("`{name}` is a variable")).help("write an equation instead of `connect`"),
    };
    instance.diagnostics.push(d);
    false
}

/// The public ports of a component, in backticks.
/// They are listed in the order of declaration.
fn port_names(instance: &mut Instance<'_, '_>, scope: ScopeId) -> Vec<String> {
    let template = instance.scope(scope).template.clone();
    let mut names = Vec::new();
    for (i, e) in (0u32..).zip(&template.elements) {
        let public = matches!(e.kind, TemplateElementKind::Component(_)) && !e.protected;
        if let Some(node) = public.then(|| instance.builder().component(scope, i)).flatten()
            && is_port(instance, node)
        {
            names.push(format!("`{}`", e.name));
        }
    }
    names
}

/// Whether a node may stand in a `connect`: a connector or record, an array of such, or a variable that is part of one,
/// an input or output, or of a connector type.
/// An empty array counts as one of ports.
fn is_port(instance: &mut Instance<'_, '_>, node: NodeId) -> bool {
    match instance.node(node).clone() {
        InstanceNode::Object(s) => {
            let record = matches!(instance.scope(s).template.kind, ClassKind::Record { .. });
            record || matches!(instance.scope(s).template.kind, ClassKind::Connector { .. })
        }
        InstanceNode::Array { elements, .. } => elements.first().is_none_or(|&e| is_port(instance, e)),
        InstanceNode::Var(i) => {
            let v = &instance.variables[i as usize];
            let (scope, name) = (v.scope, v.name.clone());
            let around = &instance.scope(scope).template.kind;
            let inside = matches!(around, ClassKind::Connector { .. } | ClassKind::Record { .. });
            inside || v.causality.is_some() || declared_as_connector(instance, scope, &name)
        }
    }
}

/// Whether the type of a variable is a connector such as `connector Signal = Real`. `name` is its full name, `scope`
/// the component that declares it.
fn declared_as_connector(instance: &mut Instance<'_, '_>, scope: ScopeId, name: &str) -> bool {
    let last = name.rsplit('.').next().unwrap_or(name);
    let last = Symbol::new(last.split('[').next().unwrap_or(last));
    let template = instance.scope(scope).template.clone();
    let Some(&index) = template.by_name.get(&last) else { return false };
    let element = &template.elements[index as usize];
    let TemplateElementKind::Component(c) = element.kind else { return false };
    match instance.names().lookup_path(LookupContext { scope, base: element.base }, &c.class) {
        Ok(LookupResult::Class(class)) => {
            let t = instance.names().template(class.class, class.parent);
            matches!(t.kind, ClassKind::Connector { .. })
                || matches!(instance.library.class(class.class).kind, ClassKind::Connector { .. })
        }
        _ => false,
    }
}

/// Whether an element of a component is a connector itself, so that connections in the component see it from inside: it
/// is an outside connector there. Elements of other scopes are not.
fn is_connector(instance: &mut Instance<'_, '_>, scope: ScopeId, index: u32, view: LookupContext) -> bool {
    if scope != view.scope {
        return false;
    }
    let template = instance.scope(scope).template.clone();
    let element = &template.elements[index as usize];
    let TemplateElementKind::Component(c) = element.kind else { return false };
    // An `outer` element belongs to the component that declares the `inner` one.
    if c.prefixes.outer {
        return false;
    }
    match instance.names().lookup_path(LookupContext { scope, base: element.base }, &c.class) {
        Ok(LookupResult::Class(class)) => {
            let t = instance.names().template(class.class, class.parent);
            matches!(t.kind, ClassKind::Connector { .. })
        }
        _ => c.prefix.causality.is_some(),
    }
}

/// Reports two nodes of different kinds.
/// The code is E104.
fn mismatch(instance: &mut Instance<'_, '_>, a: NodeId, b: NodeId, at: &ConnectSite) {
    let (x, y) = (instance.node_name(a), instance.node_name(b));
    instance.diagnostics.push(
        Diagnostic::new(Code::DomainMismatch, format!("`{x}` and `{y}` are of different kinds and cannot be joined"))
            .at(at.a, what_it_is(instance, a))
            .at(at.b, what_it_is(instance, b))
            .help("connect ports of the same kind, or put a component between them that changes one into the other"),
    );
}

/// What a node is, for messages.
/// Examples are "an input signal" and "a `Hydraulic.Port`".
fn what_it_is(instance: &Instance<'_, '_>, node: NodeId) -> String {
    match instance.node(node) {
        InstanceNode::Var(i) => match instance.variables[*i as usize].causality {
            Some(ast::CausalityPrefix::Input) => "an input signal".into(),
            Some(ast::CausalityPrefix::Output) => "an output signal".into(),
            None => "a variable".into(),
        },
        InstanceNode::Object(scope) => {
            format!("a `{}`", instance.library.full_name(instance.scope(*scope).template.class))
        }
        InstanceNode::Array { dims, .. } => format!("an array of size {}", crate::instance::value::size_text(dims)),
    }
}

/// Whether the units of two variables have different dimensions; ports with such variables belong to different domains.
/// Reports it. Missing and unreadable units fit anywhere.
/// The code is E104; the help is a component that changes one quantity into the other.
fn different_units(instance: &mut Instance<'_, '_>, a: u32, b: u32, at: &ConnectSite) -> bool {
    if instance.variables[a as usize].ty != ScalarType::Real {
        return false;
    }
    let units = [a, b].map(|i| instance.parameters().text_attribute(i, "unit").filter(|u| !u.is_empty()));
    let [Some(ua), Some(ub)] = units else { return false };
    if ua == ub {
        return false;
    }
    let (Ok(x), Ok(y)) =
        (bramah_expr::units::MeasurementUnit::parse(&ua), bramah_expr::units::MeasurementUnit::parse(&ub))
    else {
        return false;
    };
    if x.dimension == y.dimension {
        return false;
    }
    let names = [a, b].map(|i| instance.variables[i as usize].name.clone());
    instance.diagnostics.push(
        Diagnostic::new(
            Code::DomainMismatch,
            format!("`{}` in `{ua}` and `{}` in `{ub}` cannot be joined", names[0], names[1]),
        )
        .at(at.a, format!("`{ua}`"))
        .at(at.b, format!("`{ub}`"))
        .help("put the component between them that turns the one into the other, such as a pump, a cylinder or a gear"),
    );
    true
}

/// Whether a `break` modifier of the class that extends this one takes the connection away: by itself, or with one of
/// its components (MLS 7.4).
/// The two sides may be given in either order.
fn is_broken(base: &BaseClass<'_>, a: &Expr, b: &Expr) -> bool {
    let names = |e: &Expr| match &e.kind {
        ExprKind::Reference(r) => r.parts.first().is_some_and(|p| base.broken_components.contains(&p.name.name)),
        _ => false,
    };
    names(a) || names(b) || base.broken_connects.iter().any(|(x, y)| same_pair((a, b), (x, y)))
}
