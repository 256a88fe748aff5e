//! Block lower triangular form: strongly connected components in the order in which they can be solved.
//!
//! The nodes are matched equations; an edge leads from an equation to the equation that determines one of its unknowns.
//! A component of one node is an explicit equation, one of several nodes is an algebraic loop. The algorithm is that of
//! R. Tarjan, Depth-first search and linear graph algorithms, SIAM J. Comput. 1, 1972. `sorting` calls it for
//! equations, `parameters` for bindings.

use super::incidence::NONE;

/// Finds all strongly connected components, without recursion, in time linear in nodes and edges.
///
/// `successors` appends to its second argument the nodes that a node depends on. It is called once for each node.
/// Components come out with dependencies first, their members in ascending order.
pub(super) fn components(nodes: usize, mut successors: impl FnMut(u32, &mut Vec<u32>)) -> StrongComponents {
    let mut search = TarjanSearch {
        index: vec![NONE; nodes],
        low: vec![0; nodes],
        on_stack: vec![false; nodes],
        stack: Vec::new(),
        frames: Vec::new(),
        edges: Vec::new(),
        count: 0,
        found: StrongComponents { starts: vec![0], members: Vec::with_capacity(nodes) },
    };
    // Every node is searched from once, so disconnected parts are found too.
    for node in 0..nodes as u32 {
        if search.index[node as usize] == NONE {
            search.from(node, &mut successors);
        }
    }
    search.found
}

/// Strongly connected components in an order in which each depends on earlier ones only.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StrongComponents {
    /// Where each component begins in `members`, and one more entry for the end.
    starts: Vec<u32>,
    /// The nodes of all components, one component after the other.
    members: Vec<u32>,
}

impl StrongComponents {
    /// The number of components.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The nodes of a component, ascending.
    pub fn get(&self, component: usize) -> &[u32] {
        &self.members[self.starts[component] as usize..self.starts[component + 1] as usize]
    }

    /// The components for which `keep` is true, in the same order.
    pub fn filtered(&self, keep: impl Fn(&[u32]) -> bool) -> StrongComponents {
        let mut kept = StrongComponents { starts: vec![0], members: Vec::with_capacity(self.members.len()) };
        for members in self.iter().filter(|members| keep(members)) {
            kept.members.extend_from_slice(members);
            kept.starts.push(kept.members.len() as u32);
        }
        kept
    }

    /// All components, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|c| self.get(c))
    }
}

/// A node on the path of the depth-first search. Frames replace the call stack of the recursive formulation.
struct TarjanFrame {
    /// The node.
    node: u32,
    /// Where its edges begin in [`TarjanSearch::edges`].
    first: u32,
    /// The edge to follow next. The edges of the last frame end at the end of the list.
    next: u32,
}

/// The state of the search. Vectors without another note are indexed by node.
struct TarjanSearch {
    /// The number of the node in the order of discovery, or [`NONE`] before it is discovered.
    index: Vec<u32>,
    /// The lowest discovery number that the node is known to reach within its component (Tarjan's lowlink).
    low: Vec<u32>,
    /// Whether the node is on `stack`: discovered, but its component is not complete.
    on_stack: Vec<bool>,
    /// Discovered nodes whose component is not complete, in order of discovery.
    stack: Vec<u32>,
    /// The path from the root to the node being searched.
    frames: Vec<TarjanFrame>,
    /// The edges of all nodes on the path, one stretch for each frame.
    edges: Vec<u32>,
    /// How many nodes have been discovered.
    count: u32,
    /// The components completed so far.
    found: StrongComponents,
}

impl TarjanSearch {
    /// Searches everything that is reachable from a root.
    fn from(&mut self, root: u32, successors: &mut impl FnMut(u32, &mut Vec<u32>)) {
        self.enter(root, successors);
        while let Some(frame) = self.frames.last_mut() {
            if (frame.next as usize) == self.edges.len() {
                self.leave();
                continue;
            }
            let (node, target) = (frame.node, self.edges[frame.next as usize]);
            frame.next += 1;
            if self.index[target as usize] == NONE {
                self.enter(target, successors);
            // An edge to a complete component is no way back; only nodes on the stack can share the component.
            } else if self.on_stack[target as usize] {
                self.low[node as usize] = self.low[node as usize].min(self.index[target as usize]);
            }
        }
    }

    /// Discovers a node: numbers it, puts it on the stack and lists its edges.
    fn enter(&mut self, node: u32, successors: &mut impl FnMut(u32, &mut Vec<u32>)) {
        self.index[node as usize] = self.count;
        self.low[node as usize] = self.count;
        self.count += 1;
        self.stack.push(node);
        self.on_stack[node as usize] = true;
        let first = self.edges.len() as u32;
        successors(node, &mut self.edges);
        self.frames.push(TarjanFrame { node, first, next: first });
    }

    /// Finishes the last node of the path and passes its lowlink to its parent.
    fn leave(&mut self) {
        let frame = self.frames.pop().expect("called with a frame");
        // The edges of the node are the last stretch of the list.
        self.edges.truncate(frame.first as usize);
        let low = self.low[frame.node as usize];
        if let Some(parent) = self.frames.last() {
            let parent = parent.node as usize;
            self.low[parent] = self.low[parent].min(low);
        }
        // The node reaches nothing discovered earlier, so it is the root of its component.
        if low == self.index[frame.node as usize] {
            self.close(frame.node);
        }
    }

    /// Moves the nodes from `root` to the top of the stack into a new component.
    fn close(&mut self, root: u32) {
        let first = self.found.members.len();
        while let Some(node) = self.stack.pop() {
            self.on_stack[node as usize] = false;
            self.found.members.push(node);
            if node == root {
                break;
            }
        }
        self.found.members[first..].sort_unstable();
        self.found.starts.push(self.found.members.len() as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn order_and_components_agree_with_petgraph(
            edges in prop::collection::vec((0..12_u32, 0..12_u32), 0..40),
        ) {
            let found = components(12, |node, out| {
                out.extend(edges.iter().filter(|e| e.0 == node).map(|e| e.1));
            });
            let mut position = [0; 12];
            for (i, members) in found.iter().enumerate() {
                for &m in members {
                    position[m as usize] = i;
                }
            }
            // Lower triangular: nothing depends on what comes later.
            for &(from, to) in &edges {
                prop_assert!(position[to as usize] <= position[from as usize]);
            }
            let mut graph = petgraph::graph::DiGraph::<(), ()>::new();
            let nodes: Vec<_> = (0..12).map(|_| graph.add_node(())).collect();
            for &(from, to) in &edges {
                graph.add_edge(nodes[from as usize], nodes[to as usize], ());
            }
            prop_assert_eq!(petgraph::algo::tarjan_scc(&graph).len(), found.len());
        }
    }

    #[test]
    fn deep_chains_need_no_stack() {
        let n = 200_000;
        let found = components(n, |node, out| {
            if (node as usize) + 1 < n {
                out.push(node + 1);
            }
        });
        assert_eq!(found.len(), n);
        assert_eq!(found.get(0), [n as u32 - 1]);
    }
}
