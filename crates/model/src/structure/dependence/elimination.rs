//! Gaussian elimination of a sparse matrix of numbers: which rows are linear combinations of others.
//!
//! Enters: rows with numeric entries. Leaves: the combinations of rows that vanish. The parent module calls
//! [`vanishing`] and [`following`].

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// A difference below this part of the numbers it comes from is rounding. Coefficients such as `cos(2*pi/3)` or `2/3`
/// are right to sixteen digits, their products to a few less, and no two values that an engineer means to differ agree
/// in ten.
pub(super) const CANCELLED: f64 = 1e-10;

/// A pivot is at least this part of the largest entry of its column (threshold pivoting): small enough to leave a
/// choice of sparse rows, large enough to bound the growth of errors.
const LARGE: f64 = 0.1;

/// A row: columns in ascending order, with their values.
pub(super) type EliminationRow = Vec<(u32, f64)>;

/// Rows in ascending order that add up to 0 with these factors. All but one of them are independent.
pub(super) type RowCombination = Vec<(usize, f64)>;

/// The combinations of rows that vanish: as many as the number of rows exceeds the rank.
/// `columns` is the number of columns; rows may be empty.
pub(super) fn vanishing(rows: &[EliminationRow], columns: usize) -> Vec<RowCombination> {
    let mut elimination = NumericElimination::new(rows, columns);
    while let Some((row, column)) = elimination.next_pivot() {
        elimination.eliminate(row, column);
    }
    let empty = (0..rows.len()).filter(|&row| elimination.active[row]);
    empty.map(|row| elimination.combination(row)).collect()
}

/// The last row of each combination that vanishes. Ascending, each once: one row may be the last of several.
pub(super) fn following(rows: &[EliminationRow], columns: usize) -> Vec<usize> {
    let last = |combination: RowCombination| combination.last().map(|term| term.0);
    let mut found: Vec<usize> = vanishing(rows, columns).into_iter().filter_map(last).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// The state of the elimination. It eliminates the column that the fewest rows contain (after H. M. Markowitz): a
/// column in a single row removes that row without any work, so that in most models little is left to do.
struct NumericElimination {
    /// By row: what is left of it, scaled to a largest entry of 1.
    rows: Vec<EliminationRow>,
    /// By row: the largest entry before scaling.
    scale: Vec<f64>,
    /// By row: whether it has not been a pivot yet.
    active: Vec<bool>,
    /// By column: rows that contain it, and some that do not any more.
    users: Vec<Vec<u32>>,
    /// By column: how many active rows contain it.
    count: Vec<usize>,
    /// Columns by count. Outdated entries stay and are skipped.
    queue: BinaryHeap<Reverse<(usize, u32)>>,
    /// By row: pivot rows with the factors by which they were subtracted from it, in order.
    subtracted: Vec<Vec<(u32, f64)>>,
    /// By row: its number among the pivots, or `usize::MAX`.
    rank: Vec<usize>,
    /// Pivot rows in the order in which they were chosen.
    pivots: Vec<u32>,
}

impl NumericElimination {
    /// Scales the rows and counts the users of each column.
    fn new(rows: &[EliminationRow], columns: usize) -> Self {
        let largest = |row: &EliminationRow| row.iter().fold(0.0, |m: f64, e| m.max(e.1.abs()));
        let scale: Vec<f64> = rows.iter().map(|row| if row.is_empty() { 1.0 } else { largest(row) }).collect();
        let scaled = |(row, scale): (&EliminationRow, &f64)| -> EliminationRow {
            row.iter().map(|&(c, v)| (c, v / scale)).collect()
        };
        let mut users: Vec<Vec<u32>> = vec![Vec::new(); columns];
        for (r, row) in (0..).zip(rows) {
            row.iter().for_each(|&(c, _)| users[c as usize].push(r));
        }
        let count: Vec<usize> = users.iter().map(Vec::len).collect();
        NumericElimination {
            rows: rows.iter().zip(&scale).map(scaled).collect(),
            scale,
            active: vec![true; rows.len()],
            queue: (0..).zip(&count).filter(|(_, n)| **n > 0).map(|(c, &n)| Reverse((n, c))).collect(),
            users,
            count,
            subtracted: vec![Vec::new(); rows.len()],
            rank: vec![usize::MAX; rows.len()],
            pivots: Vec::new(),
        }
    }

    /// The entry of a row in a column; `None` where there is none. Binary search.
    fn value(&self, row: u32, column: u32) -> Option<f64> {
        let row = &self.rows[row as usize];
        row.binary_search_by_key(&column, |entry| entry.0).ok().map(|at| row[at].1)
    }

    /// The next pivot: among the rows with a large entry in the column that the fewest rows contain, the shortest.
    /// `None` when all remaining rows are empty.
    fn next_pivot(&mut self) -> Option<(u32, u32)> {
        while let Some(Reverse((count, column))) = self.queue.pop() {
            // The count has changed since the entry was queued; there is a newer entry.
            if count != self.count[column as usize] || count == 0 {
                continue;
            }
            let mut users = std::mem::take(&mut self.users[column as usize]);
            // The list may contain rows twice, and rows in which the column has cancelled since.
            users.sort_unstable();
            users.dedup();
            users.retain(|&row| self.active[row as usize] && self.value(row, column).is_some());
            let size = |row: u32| self.value(row, column).map_or(0.0, f64::abs);
            let largest = users.iter().fold(0.0, |m: f64, &row| m.max(size(row)));
            let large = users.iter().copied().filter(|&row| size(row) >= LARGE * largest);
            let pivot = large.min_by_key(|&row| self.rows[row as usize].len());
            self.users[column as usize] = users;
            if let Some(row) = pivot {
                return Some((row, column));
            }
        }
        None
    }

    /// Eliminates the column of the pivot from all other rows and makes the pivot row inactive.
    fn eliminate(&mut self, pivot: u32, column: u32) {
        self.active[pivot as usize] = false;
        self.rank[pivot as usize] = self.pivots.len();
        self.pivots.push(pivot);
        let of_pivot = self.rows[pivot as usize].clone();
        // `next_pivot` returns existing entries only.
        let Some(divisor) = self.value(pivot, column) else { return };
        for row in std::mem::take(&mut self.users[column as usize]) {
            if let Some(value) = self.value(row, column).filter(|_| row != pivot) {
                let factor = value / divisor;
                self.subtracted[row as usize].push((pivot, factor));
                self.subtract(row, &of_pivot, factor, column);
            }
        }
        for &(c, _) in &of_pivot {
            self.count_down(c);
        }
    }

    /// Notes that one row less contains a column.
    fn count_down(&mut self, column: u32) {
        self.count[column as usize] -= 1;
        self.queue.push(Reverse((self.count[column as usize], column)));
    }

    /// Subtracts a multiple of a pivot from a row: a merge of two sorted lists. Entries that cancel up to rounding are
    /// removed, and that of the eliminated column always.
    fn subtract(&mut self, row: u32, pivot: &EliminationRow, factor: f64, column: u32) {
        let old = std::mem::take(&mut self.rows[row as usize]);
        let mut made = EliminationRow::with_capacity(old.len() + pivot.len());
        let (mut a, mut b) = (old.iter().peekable(), pivot.iter().peekable());
        loop {
            match (a.peek(), b.peek()) {
                (None, None) => break,
                (Some(&&entry), other) if other.is_none_or(|o| entry.0 < o.0) => {
                    made.push(entry);
                    a.next();
                }
                (Some(&&(c, x)), Some(&&(d, y))) if c == d => {
                    let (y, size) = (factor * y, x.abs() + (factor * y).abs());
                    if c != column && (x - y).abs() > CANCELLED * size {
                        made.push((c, x - y));
                    } else {
                        self.count_down(c);
                    }
                    a.next();
                    b.next();
                }
                // Fill-in: the row did not contain this column before.
                (_, Some(&&(d, y))) => {
                    made.push((d, -factor * y));
                    self.users[d as usize].push(row);
                    self.count[d as usize] += 1;
                    self.queue.push(Reverse((self.count[d as usize], d)));
                    b.next();
                }
                (Some(_), None) => break,
            }
        }
        self.rows[row as usize] = made;
    }

    /// The combination of the given rows that an empty row stands for: what was subtracted is traced back to the rows
    /// as they were. The largest factor is 1 in size.
    /// It undoes the scaling of the rows.
    fn combination(&self, row: usize) -> RowCombination {
        let mut open: BTreeMap<usize, f64> = BTreeMap::new();
        let subtract = |open: &mut BTreeMap<usize, f64>, of: usize, by: f64| {
            for &(pivot, factor) in &self.subtracted[of] {
                *open.entry(self.rank[pivot as usize]).or_insert(0.0) -= by * factor;
            }
        };
        subtract(&mut open, row, 1.0);
        let mut found = vec![(row, self.scale[row].recip())];
        // Later pivots first: what is subtracted from a pivot row refers to earlier pivots only.
        while let Some((rank, factor)) = open.pop_last() {
            let pivot = self.pivots[rank] as usize;
            if factor.abs() > CANCELLED {
                found.push((pivot, factor / self.scale[pivot]));
            }
            subtract(&mut open, pivot, factor);
        }
        found.sort_unstable_by_key(|term| term.0);
        let largest = found.iter().fold(0.0, |m: f64, term| m.max(term.1.abs()));
        found.iter_mut().for_each(|term| term.1 /= largest);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_ring_of_differences_adds_up_to_nothing() {
        let ring: Vec<EliminationRow> =
            vec![vec![(0, 1.0), (1, -1.0)], vec![(1, 1.0), (2, -1.0)], vec![(0, -1.0), (2, 1.0)]];
        assert_eq!(vanishing(&ring, 3), [vec![(0, 1.0), (1, 1.0), (2, 1.0)]]);
        assert_eq!(vanishing(&ring[..2], 3), Vec::<RowCombination>::new());
    }

    #[test]
    fn a_row_without_columns_vanishes_by_itself() {
        assert_eq!(vanishing(&[EliminationRow::new()], 1), [vec![(0, 1.0)]]);
    }

    #[test]
    fn a_row_that_two_combinations_end_with_is_named_once() {
        let rows = [vec![(0, 1.0), (1, 1.0)], vec![(0, 1.0), (1, 2.0)], vec![(1, 1.0)], vec![(0, 1.0)]];
        let last: Vec<usize> = vanishing(&rows, 2).iter().map(|c| c[c.len() - 1].0).collect();
        assert_eq!(last, [3, 3]);
        assert_eq!(following(&rows, 2), [3]);
    }

    #[test]
    fn rounded_thirds_of_a_turn_cancel() {
        let third = 2.0 * std::f64::consts::PI / 3.0;
        let axis = |of: fn(f64) -> f64, by: f64| -> EliminationRow {
            (0..3).map(|k| (k, by * of(f64::from(k) * third))).collect()
        };
        // both axes, what they leave of three windings, and one winding
        let rows = vec![axis(f64::cos, 2.0 / 3.0), axis(|_| 1.0, 1.0 / 3.0), axis(f64::sin, 1.0), vec![(0, 1.0)]];
        let found = vanishing(&rows, 3);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].iter().map(|t| t.0).collect::<Vec<_>>(), [0, 1, 3], "{found:?}");
    }

    fn matrices() -> impl Strategy<Value = Vec<Vec<f64>>> {
        let entry = || prop_oneof![3 => Just(0.0), 2 => (-3_i32..4).prop_map(f64::from)];
        (1_usize..9, 1_usize..7)
            .prop_flat_map(move |(rows, columns)| prop::collection::vec(prop::collection::vec(entry(), columns), rows))
    }

    proptest! {
        #[test]
        fn as_many_rows_vanish_as_the_rank_says(dense in matrices()) {
            let columns = dense[0].len();
            let sparse: Vec<EliminationRow> = dense.iter().map(|row| {
                row.iter().enumerate().filter(|(_, v)| **v != 0.0).map(|(c, v)| (c as u32, *v)).collect()
            }).collect();
            let found = vanishing(&sparse, columns);
            let matrix = faer::Mat::from_fn(dense.len(), columns, |i, j| dense[i][j]);
            let singular = matrix.singular_values().expect("finite");
            let rank = singular.iter().filter(|s| **s > 1e-9).count();
            prop_assert_eq!(found.len(), dense.len() - rank);
            for combination in found {
                for c in 0..columns {
                    let sum: f64 = combination.iter().map(|&(r, factor)| factor * dense[r][c]).sum();
                    prop_assert!(sum.abs() < 1e-9);
                }
            }
        }
    }
}
