//! Maximum matchings of equations and unknowns.
//!
//! A matching assigns to each equation an unknown that it can be solved for, and no unknown twice. A perfect matching
//! exists exactly if the system is structurally regular.
//!
//! [`maximum`] is the algorithm of J. Hopcroft and R. Karp (SIAM J. Comput. 2, 1973) for a whole system.
//! [`PathAugmenter`] extends a matching by one row at a time, which index reduction and initialization need. Both
//! search without recursion, so that long chains of components need no deep stack.

use super::incidence::{IncidenceMatrix, NONE};

/// A matching. Each side knows its partner, or [`NONE`] if it has none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Matching {
    /// By row: its column.
    pub column_of: Vec<u32>,
    /// By column: its row.
    pub row_of: Vec<u32>,
}

impl Matching {
    /// A matching without pairs.
    pub fn empty(rows: usize, columns: usize) -> Self {
        Matching { column_of: vec![NONE; rows], row_of: vec![NONE; columns] }
    }

    /// Makes a row and a column partners. Does not detach former partners; the caller joins them anew along an
    /// augmenting path.
    pub fn join(&mut self, row: u32, column: u32) {
        self.column_of[row as usize] = column;
        self.row_of[column as usize] = row;
    }

    /// The number of pairs.
    #[cfg(test)]
    pub fn size(&self) -> usize {
        self.column_of.iter().filter(|&&c| c != NONE).count()
    }
}

/// A matching with as many pairs as possible, in `O(E sqrt(V))` for `E` entries and `V` rows and columns.
pub(super) fn maximum(incidence: &IncidenceMatrix, columns: usize) -> Matching {
    let mut matching = greedy(incidence, columns);
    let mut search = HopcroftKarpPhase::new(incidence.rows());
    while search.layers(incidence, &matching) {
        search.augment_all(incidence, &mut matching);
    }
    matching
}

/// A first matching: rows with few columns first, each with its first free column. It usually leaves few rows for the
/// search.
fn greedy(incidence: &IncidenceMatrix, columns: usize) -> Matching {
    let mut matching = Matching::empty(incidence.rows(), columns);
    let mut order: Vec<u32> = (0..incidence.rows() as u32).collect();
    // Stable, so that rows of equal length stay in order. Rows of four or more columns count as equally long.
    order.sort_by_key(|&r| incidence.solvable(r).len().min(4));
    for row in order {
        let free = incidence.solvable(row).iter().find(|&&c| matching.row_of[c as usize] == NONE);
        if let Some(&c) = free {
            matching.join(row, c);
        }
    }
    matching
}

/// One phase of the algorithm: breadth-first layers, then disjoint shortest augmenting paths.
struct HopcroftKarpPhase {
    /// By row: its distance from a free row, counted in rows, or [`NONE`].
    layer: Vec<u32>,
    /// By row: the position of the next column to try in this phase.
    next: Vec<u32>,
    /// Rows in breadth-first order.
    queue: Vec<u32>,
    /// Rows of the path being searched.
    path: Vec<u32>,
}

impl HopcroftKarpPhase {
    /// Work space for so many rows.
    fn new(rows: usize) -> Self {
        HopcroftKarpPhase { layer: vec![NONE; rows], next: vec![0; rows], queue: Vec::new(), path: Vec::new() }
    }

    /// Numbers the rows by their distance from a free row. False when no free column can be reached: then the matching
    /// is a maximum one.
    fn layers(&mut self, incidence: &IncidenceMatrix, matching: &Matching) -> bool {
        self.layer.fill(NONE);
        self.next.fill(0);
        self.queue.clear();
        // All free rows are sources of one breadth-first search.
        for (row, _) in matching.column_of.iter().enumerate().filter(|&(_, &c)| c == NONE) {
            self.layer[row] = 0;
            self.queue.push(row as u32);
        }
        let mut found = false;
        let mut head = 0;
        while head < self.queue.len() {
            let row = self.queue[head];
            head += 1;
            for &c in incidence.solvable(row) {
                let owner = matching.row_of[c as usize];
                if owner == NONE {
                    found = true;
                } else if self.layer[owner as usize] == NONE {
                    self.layer[owner as usize] = self.layer[row as usize] + 1;
                    self.queue.push(owner);
                }
            }
        }
        found
    }

    /// Augments along paths from all free rows.
    fn augment_all(&mut self, incidence: &IncidenceMatrix, matching: &mut Matching) {
        for row in 0..matching.column_of.len() as u32 {
            if matching.column_of[row as usize] == NONE {
                self.augment(incidence, matching, row);
            }
        }
    }

    /// Searches depth first along the layers from one free row, and augments if it reaches a free column. Each entry of
    /// a row is tried once in a phase.
    fn augment(&mut self, incidence: &IncidenceMatrix, matching: &mut Matching, start: u32) {
        self.path.clear();
        self.path.push(start);
        while let Some(&row) = self.path.last() {
            let position = self.next[row as usize] as usize;
            let Some(&c) = incidence.solvable(row).get(position) else {
                self.path.pop();
                continue;
            };
            self.next[row as usize] += 1;
            let owner = matching.row_of[c as usize];
            if owner == NONE {
                return self.flip(incidence, matching);
            }
            // Only along layers: paths of a phase are shortest ones.
            if self.layer[owner as usize] == self.layer[row as usize] + 1 {
                self.path.push(owner);
            }
        }
    }

    /// Gives every row of the path the column that it tried last.
    fn flip(&mut self, incidence: &IncidenceMatrix, matching: &mut Matching) {
        for &row in &self.path {
            let c = incidence.solvable(row)[self.next[row as usize] as usize - 1];
            matching.join(row, c);
        }
    }
}

/// Finds augmenting paths from single rows. It is work space that is reused from search to search.
#[derive(Clone, Debug, Default)]
pub(super) struct PathAugmenter {
    /// By row: the stamp of the last search that saw it.
    row_mark: Vec<u32>,
    /// By column: the stamp of the last search that saw it.
    column_mark: Vec<u32>,
    /// The stamp of the current search.
    stamp: u32,
    /// Rows of the path, each with the position of the next column to try.
    path: Vec<(u32, u32)>,
    /// Rows seen by the last search, in the order in which it met them.
    pub rows_seen: Vec<u32>,
    /// Columns seen by the last search, in the order in which it met them.
    pub columns_seen: Vec<u32>,
}

impl PathAugmenter {
    /// Matches `row`, moving other rows to other columns as needed. Entries (row, position in it, column) for which
    /// `usable` is false are ignored.
    ///
    /// False if there is no augmenting path. Then [`PathAugmenter::rows_seen`] holds the rows that share too few
    /// columns, `row` among them, and [`PathAugmenter::columns_seen`] these columns. Time is linear in the entries at
    /// worst.
    pub fn augment(
        &mut self,
        incidence: &IncidenceMatrix,
        matching: &mut Matching,
        row: u32,
        usable: impl Fn(u32, usize, u32) -> bool,
    ) -> bool {
        self.begin(incidence.rows(), matching.row_of.len());
        self.see_row(row);
        self.path.push((row, 0));
        while let Some(&(row, position)) = self.path.last() {
            if position == 0 {
                // Look for a free column before going deeper; most paths then are short.
                let mut entries = incidence.solvable(row).iter().enumerate();
                let free = entries.position(|(i, &c)| matching.row_of[c as usize] == NONE && usable(row, i, c));
                if let Some(at) = free {
                    self.path.last_mut().expect("just seen").1 = at as u32 + 1;
                    self.flip(incidence, matching);
                    return true;
                }
            }
            self.deepen(incidence, matching, row, position, &usable);
        }
        false
    }

    /// Tries the column at `position` of the last row of the path: extends the path to the row that owns the column, or
    /// goes back if the row has no more columns.
    fn deepen(
        &mut self,
        incidence: &IncidenceMatrix,
        matching: &Matching,
        row: u32,
        position: u32,
        usable: &impl Fn(u32, usize, u32) -> bool,
    ) {
        let Some(&c) = incidence.solvable(row).get(position as usize) else {
            self.path.pop();
            return;
        };
        self.path.last_mut().expect("the row being looked at").1 += 1;
        if self.column_mark[c as usize] == self.stamp || !usable(row, position as usize, c) {
            return;
        }
        self.column_mark[c as usize] = self.stamp;
        self.columns_seen.push(c);
        let owner = matching.row_of[c as usize];
        if owner != NONE && self.row_mark[owner as usize] != self.stamp {
            self.see_row(owner);
            self.path.push((owner, 0));
        }
    }

    /// Starts a search with a fresh stamp and room for so many rows and columns.
    fn begin(&mut self, rows: usize, columns: usize) {
        // After an overflow old marks could be taken for new ones.
        if self.stamp == u32::MAX {
            self.row_mark.clear();
            self.column_mark.clear();
            self.stamp = 0;
        }
        self.stamp += 1;
        self.row_mark.resize(rows, 0);
        self.column_mark.resize(columns, 0);
        self.path.clear();
        self.rows_seen.clear();
        self.columns_seen.clear();
    }

    /// Marks a row as seen.
    fn see_row(&mut self, row: u32) {
        self.row_mark[row as usize] = self.stamp;
        self.rows_seen.push(row);
    }

    /// Gives every row of the path the column that it tried last.
    fn flip(&mut self, incidence: &IncidenceMatrix, matching: &mut Matching) {
        for &(row, position) in &self.path {
            matching.join(row, incidence.solvable(row)[position as usize - 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The size of a maximum matching by trying everything.
    fn brute(rows: &[Vec<u32>], used: &mut Vec<bool>, row: usize) -> usize {
        if row == rows.len() {
            return 0;
        }
        let mut best = brute(rows, used, row + 1);
        for &c in &rows[row] {
            if !used[c as usize] {
                used[c as usize] = true;
                best = best.max(1 + brute(rows, used, row + 1));
                used[c as usize] = false;
            }
        }
        best
    }

    fn graph() -> impl Strategy<Value = Vec<Vec<u32>>> {
        prop::collection::vec(prop::collection::btree_set(0..6_u32, 0..4), 0..7)
            .prop_map(|rows| rows.into_iter().map(|r| r.into_iter().collect()).collect())
    }

    fn consistent(rows: &[Vec<u32>], m: &Matching) -> bool {
        (0..rows.len()).all(|r| {
            let c = m.column_of[r];
            c == NONE || (rows[r].contains(&c) && m.row_of[c as usize] == r as u32)
        })
    }

    proptest! {
        #[test]
        fn both_find_the_largest_matching(rows in graph()) {
            let incidence = IncidenceMatrix::of(&rows);
            let best = brute(&rows, &mut vec![false; 6], 0);
            let all = maximum(&incidence, 6);
            prop_assert!(consistent(&rows, &all));
            prop_assert_eq!(all.size(), best);
            let mut one_by_one = Matching::empty(rows.len(), 6);
            let mut augmenter = PathAugmenter::default();
            let found = (0..rows.len() as u32)
                .filter(|&r| augmenter.augment(&incidence, &mut one_by_one, r, |_, _, _| true))
                .count();
            prop_assert!(consistent(&rows, &one_by_one));
            prop_assert_eq!(found, best);
        }
    }

    #[test]
    fn a_failed_search_shows_the_rows_that_compete() {
        let incidence = IncidenceMatrix::of(&[vec![0], vec![1, 2], vec![0]]);
        let mut matching = maximum(&incidence, 3);
        let free = matching.column_of.iter().position(|&c| c == NONE).expect("one too many") as u32;
        let mut augmenter = PathAugmenter::default();
        assert!(!augmenter.augment(&incidence, &mut matching, free, |_, _, _| true));
        augmenter.rows_seen.sort_unstable();
        assert_eq!(augmenter.rows_seen, [0, 2]);
        assert_eq!(augmenter.columns_seen, [0]);
    }

    #[test]
    fn long_chains_need_no_stack() {
        let n = 100_000_u32;
        let rows: Vec<Vec<u32>> = (0..n).map(|r| if r == 0 { vec![0] } else { vec![r - 1, r] }).collect();
        let mut shuffled = rows.clone();
        shuffled.reverse();
        assert_eq!(maximum(&IncidenceMatrix::of(&shuffled), n as usize).size(), n as usize);
    }
}
