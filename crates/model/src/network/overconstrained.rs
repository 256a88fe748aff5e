//! The connection graph of overconstrained connectors (MLS 9.4.2).
//!
//! Its nodes are the overconstrained components, its edges `Connections.branch` (required) and `connect` (optional).
//! Enters: the statements of all components, one by one. Leaves: spanning trees with their roots. A connection that
//! would close a loop in the graph, or join two roots, is broken: it states by the function `equalityConstraint` that
//! both sides are equal, because as many equations as the type has components would be too many. `connect` calls
//! [`VirtualConnectionGraph::add`] and `span`.

use crate::instance::{Instance, LookupContext, NodeId, ScopeId};
use bramah_syntax::ast::{ComponentReference, Expr};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use petgraph::unionfind::UnionFind;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::VecDeque;

/// A connection of two overconstrained components.
#[derive(Clone, Copy, Debug)]
pub struct OverconstrainedLink {
    /// One side.
    pub a: NodeId,
    /// The other.
    pub b: NodeId,
    /// Its place.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// A node that may become a root: `Connections.potentialRoot(node, priority)`.
#[derive(Clone, Copy, Debug)]
struct PotentialRoot {
    /// The node.
    node: usize,
    /// Its priority; smaller is preferred. 0 if none is given.
    priority: f64,
}

/// The graph as the equations of a model state it. Nodes go by numbers.
#[derive(Default)]
pub(super) struct VirtualConnectionGraph {
    /// By number: the node.
    nodes: Vec<NodeId>,
    /// By node: its number.
    number: FxHashMap<NodeId, usize>,
    /// Edges that are never broken.
    branches: Vec<(usize, usize)>,
    /// Nodes stated to be roots, with their places.
    roots: Vec<(usize, Span)>,
    /// Nodes that may become roots.
    offers: Vec<PotentialRoot>,
    /// Connections, in order; these may be broken.
    pub links: Vec<OverconstrainedLink>,
}

/// The spanning trees of the graph, one for each connected part with its root.
pub(super) struct SpanningForest {
    /// For each link whether it is part of a spanning tree. The others are broken.
    pub kept: Vec<bool>,
    /// The root of each tree.
    pub roots: FxHashSet<NodeId>,
    /// First sides of branches that are nearer to the root than the second side, for `Connections.rooted`.
    pub rooted: FxHashSet<NodeId>,
}

/// Whether a call is a statement about the connection graph: `Connections.branch`, `root` or `potentialRoot`.
pub fn is_graph_statement(function: &ComponentReference) -> bool {
    let [package, what] = function.parts.as_slice() else { return false };
    package.name.name == "Connections" && matches!(what.name.name.as_str(), "branch" | "root" | "potentialRoot")
}

impl VirtualConnectionGraph {
    /// The number of a node. A new node gets the next number.
    fn number(&mut self, node: NodeId) -> usize {
        let next = self.nodes.len();
        let number = *self.number.entry(node).or_insert(next);
        if number == next {
            self.nodes.push(node);
        }
        number
    }

    /// Reads `Connections.branch`, `root` or `potentialRoot`. Reports calls with the wrong number of arguments.
    /// The code is E021. An argument that is no overconstrained component is reported by the instance.
    /// Arguments are names of overconstrained components.
    pub(super) fn add<'a>(
        &mut self,
        instance: &mut Instance<'a, '_>,
        function: &ComponentReference,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) {
        let what = function.parts[1].name.name.as_str();
        let named = match (what, args) {
            ("branch", [a, b]) => vec![a, b],
            ("root", [a]) | ("potentialRoot", [a] | [a, _]) => vec![a],
            _ => {
                let d = Diagnostic::new(Code::BadCall, format!("`Connections.{what}` with {} arguments", args.len()));
                instance.diagnostics.push(d.at(span, "").note("Modelica 3.6, 9.4"));
                return;
            }
        };
        let nodes: Option<Vec<NodeId>> =
            named.into_iter().map(|e| instance.builder().overconstrained_node(e, view)).collect();
        let Some(nodes) = nodes else { return };
        let numbers: Vec<usize> = nodes.into_iter().map(|n| self.number(n)).collect();
        match (what, numbers.as_slice()) {
            ("branch", &[a, b]) => self.branches.push((a, b)),
            ("root", &[a]) => self.roots.push((a, span)),
            (_, &[node]) => {
                // The priority must be a constant; `None` after a message drops the offer.
                let priority = match args.get(1) {
                    None => Some(0.0),
                    Some(e) => instance.evaluator().constant(e, view).and_then(|v| v.as_number(&instance.exprs)),
                };
                self.offers.extend(priority.map(|priority| PotentialRoot { node, priority }));
            }
            _ => {}
        }
    }

    /// Chooses the spanning trees and their roots. Returns the links with the decision about each.
    ///
    /// The order decides what is kept: branches first, then stated roots, then connections as far as they join two
    /// trees of which at most one has a root, then potential roots by priority for trees without a root (MLS 9.4.2).
    ///
    /// Two roots joined by branches are reported, and trees without a root (E105).
    pub(super) fn span(mut self, instance: &mut Instance<'_, '_>) -> (Vec<OverconstrainedLink>, SpanningForest) {
        let links = std::mem::take(&mut self.links);
        let ends: Vec<(usize, usize)> = links.iter().map(|l| (self.number(l.a), self.number(l.b))).collect();
        let mut trees = DisjointTrees::new(self.nodes.len());
        for &(a, b) in &self.branches {
            trees.join(a, b);
        }
        for &(node, span) in &self.roots {
            let tree = trees.of(node);
            if let Some(first) = trees.root[tree].replace(node).filter(|&f| f != node) {
                let [a, b] = [first, node].map(|n| instance.node_name(self.nodes[n]));
                let message = format!("`{a}` and `{b}` are roots, and branches join them");
                let d = Diagnostic::new(Code::BadConnect, message).at(span, "a second root");
                instance.diagnostics.push(d.note("Modelica 3.6, 9.4").help("leave one of the two"));
            }
        }
        let kept: Vec<bool> = ends.iter().map(|&(a, b)| trees.link(a, b)).collect();
        // Stable: of equal priorities the one stated first becomes the root.
        self.offers.sort_by(|a, b| a.priority.total_cmp(&b.priority));
        for offer in &self.offers {
            let tree = trees.of(offer.node);
            trees.root[tree].get_or_insert(offer.node);
        }
        let kept_ends = ends.iter().zip(&kept).filter(|(_, k)| **k).map(|(e, _)| *e);
        let edges: Vec<(usize, usize)> = self.branches.iter().copied().chain(kept_ends).collect();
        for node in 0..self.nodes.len() {
            let tree = trees.of(node);
            if trees.root[tree].is_none() {
                // After the message any node serves as the root, so that the rest of the model can be checked.
                self.no_root(instance, node, &links, &ends);
                trees.root[tree] = Some(node);
            }
        }
        let roots: Vec<usize> = (0..self.nodes.len()).filter(|&n| trees.is_root(n)).collect();
        let depth = depths(self.nodes.len(), &edges, &roots);
        let nearer = self.branches.iter().filter(|(a, b)| depth[*a] < depth[*b]);
        let rooted = nearer.map(|(a, _)| self.nodes[*a]).collect();
        let roots = roots.into_iter().map(|n| self.nodes[n]).collect();
        (links, SpanningForest { kept, roots, rooted })
    }

    /// Reports a tree in which nothing can be a root. `node` is one of its nodes.
    /// The help is to connect a component that fixes the reference.
    fn no_root(
        &self,
        instance: &mut Instance<'_, '_>,
        node: usize,
        links: &[OverconstrainedLink],
        ends: &[(usize, usize)],
    ) {
        let name = instance.node_name(self.nodes[node]);
        let message = format!("nothing that `{name}` is connected to can be a root");
        let mut d = Diagnostic::new(Code::BadConnect, message).note("Modelica 3.6, 9.4");
        if let Some(at) = ends.iter().position(|&(a, b)| a == node || b == node) {
            d = d.at(links[at].span, "joined here");
        }
        instance.diagnostics.push(d.help(
            "connect a component that fixes the reference, such as a ground or a world, or state `Connections.root`",
        ));
    }
}

/// Disjoint trees with their roots, as union-find.
struct DisjointTrees {
    /// The sets of nodes.
    sets: UnionFind<usize>,
    /// By the node that stands for a tree: the root of the tree, if it has one.
    root: Vec<Option<usize>>,
}

impl DisjointTrees {
    /// Each node a tree of its own, without a root.
    fn new(count: usize) -> Self {
        DisjointTrees { sets: UnionFind::new(count), root: vec![None; count] }
    }

    /// The node that stands for the tree of a node.
    fn of(&self, node: usize) -> usize {
        self.sets.find(node)
    }

    /// Whether a node is the root of its tree.
    fn is_root(&self, node: usize) -> bool {
        self.root[self.of(node)] == Some(node)
    }

    /// Joins two trees. The result keeps the root of the first, or else that of the second.
    fn join(&mut self, a: usize, b: usize) {
        // Read before the union, which changes the node that stands for the tree.
        let root = self.root[self.of(a)].or(self.root[self.of(b)]);
        self.sets.union(a, b);
        let tree = self.of(a);
        self.root[tree] = root;
    }

    /// Joins two trees unless they are one already or both have a root. False if not joined.
    fn link(&mut self, a: usize, b: usize) -> bool {
        let (x, y) = (self.of(a), self.of(b));
        let apart = x != y && !(self.root[x].is_some() && self.root[y].is_some());
        if apart {
            self.join(x, y);
        }
        apart
    }
}

/// By node: its distance from its root, found breadth first. `usize::MAX` for nodes that no root reaches.
/// All roots start at distance 0.
fn depths(count: usize, edges: &[(usize, usize)], roots: &[usize]) -> Vec<usize> {
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); count];
    for &(a, b) in edges {
        beside[a].push(b);
        beside[b].push(a);
    }
    let mut depth = vec![usize::MAX; count];
    let mut next: VecDeque<usize> = roots.iter().copied().collect();
    roots.iter().for_each(|&r| depth[r] = 0);
    while let Some(at) = next.pop_front() {
        for &n in &beside[at] {
            if depth[n] == usize::MAX {
                depth[n] = depth[at] + 1;
                next.push_back(n);
            }
        }
    }
    depth
}
