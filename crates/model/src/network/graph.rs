//! The network as a graph of components, for pictures and for the diagnosis.

use super::Network;
use crate::instance::{Instance, InstanceNode, NodeId, ScopeId};
use petgraph::graph::{NodeIndex, UnGraph};
use std::collections::BTreeMap;

/// A component of the model's top level.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentBox {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: String,
    /// The classes that it extends, nearest first.
    pub bases: Vec<String>,
    /// Names of its ports.
    pub ports: Vec<String>,
}

/// A connection between two components of the top level.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentEdge {
    /// The port of the first, relative to its component (empty for a port of the model itself).
    pub from: String,
    /// The port of the second.
    pub to: String,
    /// Full class name of the connector, which stands for the domain.
    pub connector: String,
}

/// Components as nodes, connections as edges.
pub type ComponentGraph = UnGraph<ComponentBox, ComponentEdge>;

impl Network {
    /// The graph of the model's top level.
    pub fn graph(&self, instance: &Instance<'_, '_>) -> ComponentGraph {
        let mut graph = ComponentGraph::default();
        let mut known: BTreeMap<String, NodeIndex> = BTreeMap::new();
        let classes = component_classes(instance);
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

fn split(name: &str) -> (&str, &str) {
    name.split_once('.').unwrap_or((name, ""))
}

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
    if !ports.iter().any(|p| p == port) {
        ports.push(port.into());
    }
    index
}

/// The class of each component of the top level and those that it extends, by the component's name.
fn component_classes<'i>(instance: &'i Instance<'_, '_>) -> BTreeMap<&'i str, Vec<String>> {
    let top = instance.scopes.iter().filter(|s| s.component && !s.name.contains('.'));
    let names = |s: &crate::instance::Scope<'_>| {
        s.template.bases.iter().map(|base| instance.library.full_name(base.class)).collect()
    };
    top.map(|s| (s.name.as_str(), names(s))).collect()
}

fn connector_class(instance: &Instance<'_, '_>, node: NodeId) -> String {
    match instance.node(node) {
        InstanceNode::Object(ScopeId(i)) => instance.library.full_name(instance.scopes[*i as usize].template.class),
        _ => "signal".into(),
    }
}
