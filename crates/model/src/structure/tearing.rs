//! Tearing of algebraic loops: which unknowns to guess so that the others follow one by one.
//!
//! Greedy after Cellier: as long as an equation has one open unknown that it can safely be solved for, it determines
//! that unknown; when none has, the unknown that opens most equations is guessed. An equation whose unknowns are all
//! known becomes a residual. Long chains are cut by further guesses: following a ladder from one end to the other
//! multiplies errors at every rung.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// No unknown follows from guesses through more equations than this.
const LONGEST_CHAIN: u32 = 20;

/// A loop: as many rows as columns, numbered from 0.
#[derive(Clone, Debug, Default)]
pub(super) struct LoopGraph {
    /// For each row its columns, and whether the row can safely be solved for them.
    pub rows: Vec<Vec<(u32, bool)>>,
    /// For each column how gladly it is guessed; larger is better. Only decides between equals.
    pub liking: Vec<u32>,
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct TearingResult {
    /// Columns to guess.
    pub tearing: Vec<u32>,
    /// Rows with the columns they are solved for, in order.
    pub inner: Vec<(u32, u32)>,
    /// Rows that remain, as many as guessed columns, ascending.
    pub residuals: Vec<u32>,
}

/// Tears a loop.
pub(super) fn tear(graph: &LoopGraph) -> TearingResult {
    let mut state = TearingState::new(graph);
    state.causalize();
    while state.open_columns > 0 {
        let column = state.best_guess();
        state.torn.tearing.push(column);
        state.know(column);
        state.causalize();
    }
    state.torn.residuals = (0..graph.rows.len() as u32).filter(|&r| !state.used[r as usize]).collect();
    state.torn
}

struct TearingState<'a> {
    graph: &'a LoopGraph,
    /// Rows of each column.
    rows_of: Vec<Vec<u32>>,
    /// Open columns of each row.
    open: Vec<u32>,
    used: Vec<bool>,
    /// Columns that some row can safely be solved for.
    solvable: Vec<bool>,
    known: Vec<bool>,
    /// How many equations lie between a known column and guesses.
    depth: Vec<u32>,
    open_columns: usize,
    /// Rows with one open column.
    ready: Vec<u32>,
    /// Columns by score, possibly outdated.
    heap: BinaryHeap<(u64, Reverse<u32>)>,
    torn: TearingResult,
}

impl<'a> TearingState<'a> {
    fn new(graph: &'a LoopGraph) -> Self {
        let mut rows_of = vec![Vec::new(); graph.liking.len()];
        let mut solvable = vec![false; graph.liking.len()];
        for (row, columns) in graph.rows.iter().enumerate() {
            for &(c, safe) in columns {
                solvable[c as usize] |= safe;
                rows_of[c as usize].push(row as u32);
            }
        }
        let open: Vec<u32> = graph.rows.iter().map(|columns| columns.len() as u32).collect();
        let ready = (0..open.len() as u32).rev().filter(|&r| open[r as usize] == 1).collect();
        let mut made = TearingState {
            graph,
            rows_of,
            open,
            used: vec![false; graph.rows.len()],
            solvable,
            known: vec![false; graph.liking.len()],
            depth: vec![0; graph.liking.len()],
            open_columns: graph.liking.len(),
            ready,
            heap: BinaryHeap::new(),
            torn: TearingResult::default(),
        };
        for c in 0..graph.liking.len() as u32 {
            made.heap.push((made.score(c), Reverse(c)));
        }
        made
    }

    /// Solves rows with one open column until none is left that allows it.
    fn causalize(&mut self) {
        while let Some(row) = self.ready.pop() {
            let columns = &self.graph.rows[row as usize];
            let open = columns.iter().find(|(c, _)| !self.known[*c as usize]);
            let (Some(&(column, true)), false) = (open, self.used[row as usize]) else { continue };
            let depth = columns.iter().map(|e| self.depth[e.0 as usize]).max().unwrap_or(0) + 1;
            if depth > LONGEST_CHAIN {
                self.torn.tearing.push(column);
            } else {
                self.used[row as usize] = true;
                self.depth[column as usize] = depth;
                self.torn.inner.push((row, column));
            }
            self.know(column);
        }
    }

    fn know(&mut self, column: u32) {
        self.known[column as usize] = true;
        self.open_columns -= 1;
        let mut touched = Vec::new();
        for &row in &self.rows_of[column as usize] {
            self.open[row as usize] -= 1;
            if self.used[row as usize] {
                continue;
            }
            if self.open[row as usize] == 1 {
                self.ready.push(row);
            }
            if self.open[row as usize] <= 2 {
                touched.extend(self.graph.rows[row as usize].iter().map(|e| e.0).filter(|&c| !self.known[c as usize]));
            }
        }
        for c in touched {
            self.heap.push((self.score(c), Reverse(c)));
        }
    }

    /// An unknown that no row can safely be solved for must be guessed. Else rows that would become solvable at once
    /// count most, then all open rows, then what the caller likes.
    fn score(&self, column: u32) -> u64 {
        let (mut opened, mut uses) = (0_u64, 0_u64);
        let must = u64::from(!self.solvable[column as usize]);
        for &row in &self.rows_of[column as usize] {
            if self.used[row as usize] {
                continue;
            }
            uses += 1;
            if self.open[row as usize] == 2 {
                let other = |e: &&(u32, bool)| e.0 != column && !self.known[e.0 as usize];
                opened += u64::from(self.graph.rows[row as usize].iter().find(other).is_some_and(|e| e.1));
            }
        }
        (must << 60)
            | (opened.min(0xffff) << 40)
            | (uses.min(0xffff) << 20)
            | u64::from(self.graph.liking[column as usize].min(0xf_ffff))
    }

    /// The open column with the best score.
    fn best_guess(&mut self) -> u32 {
        loop {
            let (score, Reverse(column)) = self.heap.pop().expect("every open column is in the heap");
            if self.known[column as usize] {
                continue;
            }
            let now = self.score(column);
            if now == score {
                return column;
            }
            self.heap.push((now, Reverse(column)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn graph(rows: &[&[(u32, bool)]]) -> LoopGraph {
        LoopGraph { rows: rows.iter().map(|r| r.to_vec()).collect(), liking: vec![0; rows.len()] }
    }

    #[test]
    fn a_ring_needs_one_guess() {
        let ring = graph(&[
            &[(0, true), (1, true)],
            &[(1, true), (2, true)],
            &[(2, true), (3, true)],
            &[(3, true), (0, true)],
        ]);
        let torn = tear(&ring);
        assert_eq!((torn.tearing.len(), torn.inner.len(), torn.residuals.len()), (1, 3, 1));
    }

    #[test]
    fn unsafe_entries_are_not_solved() {
        let torn = tear(&graph(&[&[(0, false), (1, false)], &[(0, false), (1, false)]]));
        assert_eq!((torn.tearing, torn.inner, torn.residuals), (vec![0, 1], vec![], vec![0, 1]));
    }

    #[test]
    fn long_chains_are_cut() {
        let n = 200_u32;
        let mut rows: Vec<Vec<(u32, bool)>> = (1..n).map(|i| vec![(i - 1, true), (i, true)]).collect();
        rows.push(vec![(0, true), (n - 1, true)]);
        let torn = tear(&LoopGraph { rows, liking: vec![0; n as usize] });
        assert_eq!((torn.tearing.len(), torn.residuals.len()), (10, 10));
    }

    proptest! {
        #[test]
        fn inner_rows_follow_from_what_is_known(
            n in 1..9_usize,
            entries in prop::collection::btree_map((0..9_u32, 0..9_u32), any::<bool>(), 0..50),
        ) {
            let mut rows = vec![Vec::new(); n];
            for ((r, c), safe) in entries {
                if (r as usize) < n && (c as usize) < n {
                    rows[r as usize].push((c, safe));
                }
            }
            let graph = LoopGraph { rows, liking: vec![0; n] };
            let torn = tear(&graph);
            prop_assert_eq!(torn.tearing.len(), torn.residuals.len());
            prop_assert_eq!(torn.tearing.len() + torn.inner.len(), n);
            let mut known: Vec<u32> = torn.tearing.clone();
            for &(row, column) in &torn.inner {
                for &(c, safe) in &graph.rows[row as usize] {
                    prop_assert!(c == column && safe || known.contains(&c));
                }
                known.push(column);
            }
        }
    }
}
