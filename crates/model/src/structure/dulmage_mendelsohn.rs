//! The over- and under-determined parts of a system: the coarse decomposition of A. L. Dulmage and N. S. Mendelsohn,
//! Coverings of bipartite graphs, Canad. J. Math. 10, 1958.
//!
//! Enters: an incidence matrix and a maximum matching. Leaves: the equations that compete for too few unknowns and the
//! unknowns that share too few equations. Both parts are the same for every maximum matching, so messages do not depend
//! on the order of declarations. `regularity`, `analysis` and `zeros` call [`decompose`].

use super::incidence::{IncidenceMatrix, NONE};
use super::matching::Matching;

/// A part of the decomposition: some equations with some unknowns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct DecompositionPart {
    /// Equations, ascending.
    pub rows: Vec<u32>,
    /// Unknowns, ascending.
    pub columns: Vec<u32>,
}

/// The coarse decomposition. Equations and unknowns in neither part are well determined.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct CoarseDecomposition {
    /// The overdetermined part: more equations than unknowns. Empty if all rows are matched.
    pub over: DecompositionPart,
    /// The underdetermined part: more unknowns than equations. Empty if all columns are matched.
    pub under: DecompositionPart,
}

/// Splits a system with a maximum matching, in time linear in the entries of the matrix.
pub(super) fn decompose(incidence: &IncidenceMatrix, matching: &Matching) -> CoarseDecomposition {
    CoarseDecomposition { over: over(incidence, matching), under: under(incidence, matching) }
}

/// Everything that alternating paths reach from unmatched rows: from a row to any of its columns, from a column to its
/// matched row. Only entries that a row can be solved for count.
fn over(incidence: &IncidenceMatrix, matching: &Matching) -> DecompositionPart {
    let mut row_seen = vec![false; matching.column_of.len()];
    let mut column_seen = vec![false; matching.row_of.len()];
    let mut stack: Vec<u32> = unmatched(&matching.column_of);
    for &row in &stack {
        row_seen[row as usize] = true;
    }
    while let Some(row) = stack.pop() {
        for &c in incidence.solvable(row) {
            column_seen[c as usize] = true;
            let owner = matching.row_of[c as usize];
            if owner != NONE && !std::mem::replace(&mut row_seen[owner as usize], true) {
                stack.push(owner);
            }
        }
    }
    DecompositionPart { rows: marked(&row_seen), columns: marked(&column_seen) }
}

/// Everything that alternating paths reach from unmatched columns: from a column to any of its rows, from a row to its
/// matched column.
fn under(incidence: &IncidenceMatrix, matching: &Matching) -> DecompositionPart {
    let mut row_seen = vec![false; matching.column_of.len()];
    let mut column_seen = vec![false; matching.row_of.len()];
    // The search goes from columns to rows, so it needs the matrix by columns.
    let (starts, rows) = incidence.transposed(matching.row_of.len());
    let mut stack: Vec<u32> = unmatched(&matching.row_of);
    for &c in &stack {
        column_seen[c as usize] = true;
    }
    while let Some(c) = stack.pop() {
        for &row in &rows[starts[c as usize] as usize..starts[c as usize + 1] as usize] {
            row_seen[row as usize] = true;
            let partner = matching.column_of[row as usize];
            if partner != NONE && !std::mem::replace(&mut column_seen[partner as usize], true) {
                stack.push(partner);
            }
        }
    }
    DecompositionPart { rows: marked(&row_seen), columns: marked(&column_seen) }
}

/// The numbers of rows or columns without a partner, ascending.
fn unmatched(partners: &[u32]) -> Vec<u32> {
    (0..partners.len() as u32).filter(|&i| partners[i as usize] == NONE).collect()
}

/// The numbers that are marked, ascending.
fn marked(seen: &[bool]) -> Vec<u32> {
    (0..seen.len() as u32).filter(|&i| seen[i as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::matching::maximum;
    use proptest::prelude::*;

    #[test]
    fn parts_of_a_small_system() {
        // Unknown 0 twice, unknowns 1 and 2 share one equation, unknown 3 is fine.
        let incidence = IncidenceMatrix::of(&[vec![0], vec![0], vec![1, 2], vec![0, 3]]);
        let found = decompose(&incidence, &maximum(&incidence, 4));
        assert_eq!(found.over, DecompositionPart { rows: vec![0, 1], columns: vec![0] });
        assert_eq!(found.under, DecompositionPart { rows: vec![2], columns: vec![1, 2] });
    }

    proptest! {
        #[test]
        fn relabelling_changes_nothing(
            rows in prop::collection::vec(prop::collection::btree_set(0..8_u32, 0..4), 1..9),
            seed in any::<u64>(),
        ) {
            let rows: Vec<Vec<u32>> = rows.into_iter().map(|r| r.into_iter().collect()).collect();
            let turn = (seed % 8) as u32;
            let mut order: Vec<usize> = (0..rows.len()).collect();
            order.rotate_left(seed as usize % rows.len());
            let relabelled: Vec<Vec<u32>> =
                order.iter().map(|&r| rows[r].iter().map(|c| (c + turn) % 8).collect()).collect();
            let parts = |rows: &[Vec<u32>]| {
                let incidence = IncidenceMatrix::of(rows);
                decompose(&incidence, &maximum(&incidence, 8))
            };
            let (here, there) = (parts(&rows), parts(&relabelled));
            let back = |part: &DecompositionPart| {
                let mut rows: Vec<u32> = part.rows.iter().map(|&r| order[r as usize] as u32).collect();
                let mut columns: Vec<u32> = part.columns.iter().map(|c| (c + 8 - turn) % 8).collect();
                rows.sort_unstable();
                columns.sort_unstable();
                DecompositionPart { rows, columns }
            };
            prop_assert_eq!(here, CoarseDecomposition { over: back(&there.over), under: back(&there.under) });
        }
    }
}
