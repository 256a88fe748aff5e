//! Block lower triangular form: strongly connected components in the order in which they can be solved.

use super::incidence::NONE;

/// Tarjan's algorithm without recursion. Components come out dependencies first, members in order of their numbers.
///
/// `successors` appends to its second argument the nodes that a node depends on.
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
    for node in 0..nodes as u32 {
        if search.index[node as usize] == NONE {
            search.from(node, &mut successors);
        }
    }
    search.found
}

/// Strongly connected components, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StrongComponents {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl StrongComponents {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The nodes of one, ascending.
    pub fn get(&self, component: usize) -> &[u32] {
        &self.members[self.starts[component] as usize..self.starts[component + 1] as usize]
    }

    /// Those for which `keep` says true, in order.
    pub fn filtered(&self, keep: impl Fn(&[u32]) -> bool) -> StrongComponents {
        let mut kept = StrongComponents { starts: vec![0], members: Vec::with_capacity(self.members.len()) };
        for members in self.iter().filter(|members| keep(members)) {
            kept.members.extend_from_slice(members);
            kept.starts.push(kept.members.len() as u32);
        }
        kept
    }

    /// All, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|c| self.get(c))
    }
}

/// A node being searched: its edges are a stretch of `TarjanSearch::edges`.
struct TarjanFrame {
    node: u32,
    first: u32,
    next: u32,
}

struct TarjanSearch {
    index: Vec<u32>,
    low: Vec<u32>,
    on_stack: Vec<bool>,
    stack: Vec<u32>,
    frames: Vec<TarjanFrame>,
    edges: Vec<u32>,
    count: u32,
    found: StrongComponents,
}

impl TarjanSearch {
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
            } else if self.on_stack[target as usize] {
                self.low[node as usize] = self.low[node as usize].min(self.index[target as usize]);
            }
        }
    }

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

    fn leave(&mut self) {
        let frame = self.frames.pop().expect("called with a frame");
        self.edges.truncate(frame.first as usize);
        let low = self.low[frame.node as usize];
        if let Some(parent) = self.frames.last() {
            let parent = parent.node as usize;
            self.low[parent] = self.low[parent].min(low);
        }
        if low == self.index[frame.node as usize] {
            self.close(frame.node);
        }
    }

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
