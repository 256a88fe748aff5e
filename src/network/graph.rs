//! The network as a graph of components, for pictures and for the diagnosis.

use super::Network;
use crate::instance::{Instance, Node, NodeId, ScopeId};
use petgraph::graph::{NodeIndex, UnGraph};
use std::collections::BTreeMap;

/// A component of the model's top level.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentBox {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: String,
    /// Names of its ports.
    pub ports: Vec<String>,
}

/// A connection between two components of the top level.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// The port of the first, relative to its component (empty for a port of the model itself).
    pub from: String,
    /// The port of the second.
    pub to: String,
    /// Full class name of the connector, which stands for the domain.
    pub connector: String,
}

/// Components as nodes, connections as edges.
pub type Graph = UnGraph<ComponentBox, Wire>;

impl Network {
    /// The graph of the model's top level.
    pub fn graph(&self, instance: &Instance<'_, '_>) -> Graph {
        let mut graph = Graph::default();
        let mut known: BTreeMap<String, NodeIndex> = BTreeMap::new();
        for c in self.connections.iter().filter(|c| c.scope == instance.root) {
            let (a, b) = (instance.node_name(c.a), instance.node_name(c.b));
            let connector = connector_class(instance, c.a);
            let (ca, pa) = split(&a);
            let (cb, pb) = split(&b);
            let na = node_of(&mut graph, &mut known, instance, ca, pa);
            let nb = node_of(&mut graph, &mut known, instance, cb, pb);
            graph.add_edge(na, nb, Wire { from: pa.into(), to: pb.into(), connector });
        }
        graph
    }
}

fn split(name: &str) -> (&str, &str) {
    name.split_once('.').unwrap_or((name, ""))
}

fn node_of(
    graph: &mut Graph,
    known: &mut BTreeMap<String, NodeIndex>,
    instance: &Instance<'_, '_>,
    component: &str,
    port: &str,
) -> NodeIndex {
    let index = *known.entry(component.to_string()).or_insert_with(|| {
        let class = class_of(instance, component);
        graph.add_node(ComponentBox { name: component.into(), class, ports: Vec::new() })
    });
    let ports = &mut graph[index].ports;
    if !ports.iter().any(|p| p == port) {
        ports.push(port.into());
    }
    index
}

fn class_of(instance: &Instance<'_, '_>, component: &str) -> String {
    let found = instance.scopes.iter().find(|s| s.component && s.name == component);
    found.map_or(String::new(), |s| instance.library.full_name(s.template.class))
}

fn connector_class(instance: &Instance<'_, '_>, node: NodeId) -> String {
    match instance.node(node) {
        Node::Object(ScopeId(i)) => instance.library.full_name(instance.scopes[*i as usize].template.class),
        _ => "signal".into(),
    }
}
