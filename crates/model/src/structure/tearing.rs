//! Tearing of algebraic loops: which unknowns to guess so that the others follow one by one.
//!
//! Enters: a loop as a bipartite graph. Leaves: tearing variables, explicit equations in order, and residuals.
//! `solve_block` calls [`tear`]. A minimal set of tearing variables is NP-hard to find, so this is a greedy heuristic
//! after F. E. Cellier and E. Kofman (Continuous System Simulation, 2006): as long as an equation has one open unknown
//! that it can safely be solved for, it determines that unknown; when none has, the unknown that opens most equations
//! is guessed. An equation whose unknowns are all known becomes a residual.
//!
//! Long chains are cut by further guesses: to follow a ladder from one end to the other would multiply errors at every
//! rung.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The longest chain of equations through which an unknown may follow from guesses.
const LONGEST_CHAIN: u32 = 20;

/// A loop: as many rows (equations) as columns (unknowns), both numbered from 0.
#[derive(Clone, Debug, Default)]
pub(super) struct LoopGraph {
    /// By row: its columns, each with whether the row can safely be solved for it.
    pub rows: Vec<Vec<(u32, bool)>>,
    /// By column: how suitable it is as a tearing variable; larger is better. It only decides between equals.
    pub liking: Vec<u32>,
}

/// The outcome of tearing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct TearingResult {
    /// Tearing variables, in the order in which they were chosen.
    pub tearing: Vec<u32>,
    /// Rows with the columns they are solved for, in an order in which each row reads only known columns.
    pub inner: Vec<(u32, u32)>,
    /// Rows that remain, as many as tearing variables, ascending.
    pub residuals: Vec<u32>,
}

/// Tears a loop.
pub(super) fn tear(graph: &LoopGraph) -> TearingResult {
    let mut state = TearingState::new(graph);
    // Before the first guess: rows of one column need none.
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

/// The state of the greedy search.
struct TearingState<'a> {
    /// The loop.
    graph: &'a LoopGraph,
    /// By column: its rows.
    rows_of: Vec<Vec<u32>>,
    /// By row: how many of its columns are not known.
    open: Vec<u32>,
    /// By row: whether it determines a column.
    used: Vec<bool>,
    /// By column: whether some row can safely be solved for it.
    solvable: Vec<bool>,
    /// By column: whether it is guessed or determined.
    known: Vec<bool>,
    /// By column: how many equations lie between it and the guesses.
    depth: Vec<u32>,
    /// How many columns are not known.
    open_columns: usize,
    /// Rows with one open column. Some may have none by now.
    ready: Vec<u32>,
    /// Columns by score. Entries may be outdated; `best_guess` checks them.
    heap: BinaryHeap<(u64, Reverse<u32>)>,
    /// The result so far.
    torn: TearingResult,
}

impl<'a> TearingState<'a> {
    /// Nothing known yet; all columns in the heap.
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
    /// Each row is used once at most.
    fn causalize(&mut self) {
        while let Some(row) = self.ready.pop() {
            let columns = &self.graph.rows[row as usize];
            let open = columns.iter().find(|(c, _)| !self.known[*c as usize]);
            let (Some(&(column, true)), false) = (open, self.used[row as usize]) else { continue };
            let depth = columns.iter().map(|e| self.depth[e.0 as usize]).max().unwrap_or(0) + 1;
            // The column is guessed although its row determines it; the row becomes a residual.
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

    /// Marks a column as known and updates the rows that contain it.
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
            // The score of a column depends on rows with two open columns, so the neighbours of such rows are scored
            // anew.
            if self.open[row as usize] <= 2 {
                touched.extend(self.graph.rows[row as usize].iter().map(|e| e.0).filter(|&c| !self.known[c as usize]));
            }
        }
        for c in touched {
            self.heap.push((self.score(c), Reverse(c)));
        }
    }

    /// The score of a column as the next guess; larger is better. From the highest bits down: no row can safely be
    /// solved for it, so it must be guessed; rows that would become solvable at once; rows not used yet; the caller's
    /// liking.
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

    /// The open column with the best score. An outdated entry is put back with its present score.
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
