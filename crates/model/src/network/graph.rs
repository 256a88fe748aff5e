//! The network as a graph of components, for pictures and for the diagnosis.
//!
//! Only connections of the model's top level are in it; what components contain is not shown.

use super::Network;
use crate::instance::{Instance, InstanceNode, NodeId, ScopeId};
use petgraph::graph::{NodeIndex, UnGraph};
use std::collections::BTreeMap;

/// A node of the graph: a component of the model's top level, or a port of the model itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentBox {
    /// Its name.
    pub name: String,
    /// The full name of its class; empty where it has none of its own, as a signal of the model.
    pub class: String,
    /// The classes that it extends, nearest first.
    /// The own class is not among them.
    pub bases: Vec<String>,
    /// The names of its connected ports, in the order of the connections.
    pub ports: Vec<String>,
}

/// An edge of the graph: a connection between two components of the top level.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentEdge {
    /// The port of the first, relative to its component (empty for a port of the model itself).
    pub from: String,
    /// The port of the second.
    pub to: String,
    /// Full class name of the connector, which shows the domain; `signal` for single variables.
    pub connector: String,
}

/// Components as nodes, connections as edges.
pub type ComponentGraph = UnGraph<ComponentBox, ComponentEdge>;

impl Network {
    /// The graph of the model's top level. Nodes and edges come in the order of the connections; components without a
    /// connection are not in it.
    /// `plot` draws it, and the diagnosis looks for places in it.
    pub fn graph(&self, instance: &Instance<'_, '_>) -> ComponentGraph {
        let mut graph = ComponentGraph::default();
        let mut known: BTreeMap<String, NodeIndex> = BTreeMap::new();
        let classes = component_classes(instance);
        // Connections inside components belong to the pictures of these.
        for c in self.connections.iter().filter(|c| c.scope == instance.root) {
            let (a, b) = (instance.node_name(c.a), instance.node_name(c.b));
            let connector = connector_class(instance, c.a);
            let (ca, pa) = split(&a);
            let (cb, pb) = split(&b);
            let na = node_of(&mut graph, &mut known, &classes, ca, pa);
            let nb = node_of(&mut graph, &mut known, &classes, cb, pb);
            graph.add_edge(na, nb, ComponentEdge { from: pa.into(), to: pb.into(), connector });
        }
        graph
    }
}

/// A name as its component and the rest, which is empty for a port of the model itself.
fn split(name: &str) -> (&str, &str) {
    name.split_once('.').unwrap_or((name, ""))
}

/// The node of a component, with `port` among its ports. Adds the node if it is new.
fn node_of(
    graph: &mut ComponentGraph,
    known: &mut BTreeMap<String, NodeIndex>,
    classes: &BTreeMap<&str, Vec<String>>,
    component: &str,
    port: &str,
) -> NodeIndex {
    let index = *known.entry(component.to_string()).or_insert_with(|| {
        let mut bases = classes.get(component).cloned().unwrap_or_default();
        let class = if bases.is_empty() { String::new() } else { bases.remove(0) };
        graph.add_node(ComponentBox { name: component.into(), class, bases, ports: Vec::new() })
    });
    let ports = &mut graph[index].ports;
    // A port with several connections is listed once.
    if !ports.iter().any(|p| p == port) {
        ports.push(port.into());
    }
    index
}

/// By name of each component of the top level: its class, then those that it extends.
fn component_classes<'i>(instance: &'i Instance<'_, '_>) -> BTreeMap<&'i str, Vec<String>> {
    let top = instance.scopes.iter().filter(|s| s.component && !s.name.contains('.'));
    let names = |s: &crate::instance::Scope<'_>| {
        s.template.bases.iter().map(|base| instance.library.full_name(base.class)).collect()
    };
    top.map(|s| (s.name.as_str(), names(s))).collect()
}

/// The class of a port, or `signal` for a variable.
fn connector_class(instance: &Instance<'_, '_>, node: NodeId) -> String {
    match instance.node(node) {
        InstanceNode::Object(ScopeId(i)) => instance.library.full_name(instance.scopes[*i as usize].template.class),
        _ => "signal".into(),
    }
}
