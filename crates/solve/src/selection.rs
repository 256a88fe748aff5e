//! Dynamic state selection: whether the chosen states are still good, and which ones are better.
//!
//! Index reduction makes some candidates dummies, which the constraints determine. The constraints must stay solvable
//! for them. The driver calls [`better_choice`] at its pauses. Source: S. E. Mattsson, G. Soderlind, SIAM J. Sci.
//! Comput. 14 (1993) 677 (dummy derivatives).

use super::newton::VariableScales;
use crate::lower::ExecutableSystem;
use bramah_expr::VarId;
use bramah_model::structure::{StateChoice, StateSelection};

/// The present dummies are given up when their smallest pivot is below this part of the best choice's.
const WEAK: f64 = 0.2;

/// The states to prefer from now on; `None` while the present ones are good enough.
pub fn better_choice(system: &ExecutableSystem, scales: &VariableScales, values: &[f64]) -> Option<StateChoice> {
    let mut preferred = Vec::new();
    let mut changed = false;
    for selection in &system.dae.selections {
        let matrix = scaled_rows(system, scales, selection, values)?;
        let present: Vec<usize> =
            selection.dummies.iter().filter_map(|d| selection.candidates.iter().position(|c| c == d)).collect();
        let (best, best_pivot) = eliminate(matrix.clone(), &(0..selection.candidates.len()).collect::<Vec<_>>());
        let (_, pivot) = eliminate(matrix, &present);
        // a group that is still good keeps its dummies, although another group changes
        let dummies = if pivot < WEAK * best_pivot { &best } else { &present };
        changed |= pivot < WEAK * best_pivot;
        let states = (0..selection.candidates.len()).filter(|i| !dummies.contains(i));
        preferred.extend(states.map(|i| selection.candidates[i]));
    }
    (changed && !preferred.is_empty()).then_some(StateChoice { preferred })
}

/// The constraint matrix of a group, one row per constraint, with columns in units of the candidates' nominal values.
///
/// `None` when an entry is not finite.
fn scaled_rows(
    system: &ExecutableSystem,
    scales: &VariableScales,
    selection: &StateSelection,
    values: &[f64],
) -> Option<Vec<Vec<f64>>> {
    let nominal = |v: &VarId| scales.nominal[v.index()];
    let rows: Vec<Vec<f64>> = selection
        .rows
        .iter()
        .map(|row| row.iter().zip(&selection.candidates).map(|(e, v)| system.eval(*e, values) * nominal(v)).collect())
        .collect();
    rows.iter().flatten().all(|v| v.is_finite()).then_some(rows)
}

/// Gaussian elimination with the largest pivot among the allowed columns.
///
/// Returns the columns used, and the smallest pivot relative to the largest entry of its row (0 when there is none).
fn eliminate(mut rows: Vec<Vec<f64>>, allowed: &[usize]) -> (Vec<usize>, f64) {
    for row in &mut rows {
        let largest = row.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if largest > 0.0 {
            row.iter_mut().for_each(|v| *v /= largest);
        }
    }
    let mut used = Vec::new();
    let mut smallest = f64::INFINITY;
    for k in 0..rows.len() {
        let mut best = (0.0, k, usize::MAX);
        for (i, row) in rows.iter().enumerate().skip(k) {
            for &j in allowed.iter().filter(|j| !used.contains(*j)) {
                if row[j].abs() > best.0 {
                    best = (row[j].abs(), i, j);
                }
            }
        }
        let (pivot, i, j) = best;
        if j == usize::MAX {
            return (used, 0.0);
        }
        smallest = smallest.min(pivot);
        used.push(j);
        rows.swap(k, i);
        let (upper, lower) = rows.split_at_mut(k + 1);
        for row in lower {
            let factor = row[j] / upper[k][j];
            for (v, p) in row.iter_mut().zip(&upper[k]) {
                *v -= factor * p;
            }
        }
    }
    (used, smallest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_entry_is_the_better_dummy() {
        // pendulum: 2 x dx + 2 y dy = 0 with x = 0.1, y = -0.99
        let rows = vec![vec![0.2, -1.98]];
        assert_eq!(eliminate(rows.clone(), &[0, 1]), (vec![1], 1.0));
        let (used, pivot) = eliminate(rows, &[0]);
        assert_eq!(used, [0]);
        assert!(pivot < 0.11);
    }

    #[test]
    fn dependent_columns_have_no_pivot() {
        let rows = vec![vec![1.0, 2.0, 0.0], vec![2.0, 4.0, 1.0]];
        assert_eq!(eliminate(rows.clone(), &[0, 1]).1, 0.0);
        assert!(eliminate(rows, &[1, 2]).1 > 0.1);
    }
}
