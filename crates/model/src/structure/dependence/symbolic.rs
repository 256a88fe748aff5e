//! The factors by which rows add up to 0 whatever the expressions in them are worth.
//!
//! This is Gaussian elimination with sums of products in the place of numbers. Nothing is divided by a sum of several
//! terms; the row is multiplied by it instead (the idea of E. H. Bareiss, Sylvester's identity and multistep
//! integer-preserving Gaussian elimination, Math. Comp. 22, 1968). `combination` calls [`factors`] for the few rows
//! that the numeric elimination found to be dependent.

use super::elimination::CANCELLED;
use super::linear::Monomial;

/// The most rows for which the elimination is tried.
const MOST_ROWS: usize = 100;
/// The most terms of a sum. Longer sums would make an equation that costs more than it gains.
const MOST_TERMS: usize = 50;

/// A sum of unlike factors. It is 0 without any.
pub(super) type MonomialSum = Vec<Monomial>;

/// The factor of each row in the combination that vanishes.
///
/// Each row lists chains with factors; all rows but one must be independent. `None` where the rows depend on each other
/// only by the values of expressions, or where limits are exceeded.
pub(super) fn factors(rows: &[Vec<(u32, &Monomial)>]) -> Option<Vec<MonomialSum>> {
    if rows.len() > MOST_ROWS {
        return None;
    }
    let mut elimination = SymbolicElimination::new(rows);
    while let Some((row, column)) = elimination.next_pivot() {
        elimination.eliminate(row, column)?;
    }
    let parts = elimination.open.pop()?.parts;
    // Exactly one row must be left empty, and every given row must take part in it.
    let complete = elimination.open.is_empty() && parts.iter().all(|part| !part.is_empty());
    complete.then(|| with_most_numbers(parts))
}

/// The state of the elimination.
struct SymbolicElimination {
    /// Rows that have not been a pivot.
    open: Vec<SymbolicRow>,
    /// The number of columns.
    width: usize,
}

/// A row with the record of what it consists of.
struct SymbolicRow {
    /// By column: its entry.
    entries: Vec<MonomialSum>,
    /// By given row: the factor with which it is contained in this one.
    parts: Vec<MonomialSum>,
}

impl SymbolicElimination {
    /// Numbers the chains that occur as columns and fills the entries.
    fn new(rows: &[Vec<(u32, &Monomial)>]) -> Self {
        let mut chains: Vec<u32> = rows.iter().flatten().map(|entry| entry.0).collect();
        chains.sort_unstable();
        chains.dedup();
        // Each row starts as itself: factor 1 for its own number.
        let row = |(r, given): (usize, &Vec<(u32, &Monomial)>)| {
            let mut row = SymbolicRow {
                entries: vec![MonomialSum::new(); chains.len()],
                parts: vec![MonomialSum::new(); rows.len()],
            };
            row.parts[r].push(Monomial::ONE);
            for (column, chain) in chains.iter().enumerate() {
                let of_chain = given.iter().filter(|entry| entry.0 == *chain);
                of_chain.for_each(|(_, factor)| add(&mut row.entries[column], (*factor).clone()));
            }
            row
        };
        SymbolicElimination { open: rows.iter().enumerate().map(row).collect(), width: chains.len() }
    }

    /// The pivot of least cost, as row and column. A number is preferred to a product, a product to a sum; among these
    /// the pivot that fills the fewest entries. `None` when all rows are empty.
    fn next_pivot(&self) -> Option<(usize, usize)> {
        let users = |column: usize| self.open.iter().filter(|row| !row.entries[column].is_empty()).count();
        let others: Vec<usize> = (0..self.width).map(|column| users(column).saturating_sub(1)).collect();
        let cost = |row: &SymbolicRow, column: usize| {
            let entry = &row.entries[column];
            let length = row.entries.iter().filter(|entry| !entry.is_empty()).count() - 1;
            (entry.len(), !entry.iter().all(Monomial::is_number), length * others[column])
        };
        let open = self.open.iter().enumerate();
        let candidates = open.flat_map(|(r, row)| {
            let filled = (0..self.width).filter(|&column| !row.entries[column].is_empty());
            filled.map(move |column| (cost(row, column), r, column))
        });
        candidates.min().map(|(_, row, column)| (row, column))
    }

    /// Eliminates a column from the other rows with the row `row`, which is removed. `None` where sums become too long.
    fn eliminate(&mut self, row: usize, column: usize) -> Option<()> {
        let pivot = self.open.remove(row);
        for row in &mut self.open {
            let entry = std::mem::take(&mut row.entries[column]);
            if entry.is_empty() {
                continue;
            }
            // A single term divides; a sum of several terms multiplies the row instead.
            let (by, times) = match pivot.entries[column].as_slice() {
                [single] => (product(&entry, &[Monomial::ONE.times(single, -1)]), None),
                several => (entry, Some(several.to_vec())),
            };
            let by: MonomialSum = by.into_iter().map(Monomial::negative).collect();
            let others =
                pivot.entries.iter().enumerate().map(|(c, part)| if c == column { &[] } else { part.as_slice() });
            let pairs = row.entries.iter_mut().zip(others);
            let parts = row.parts.iter_mut().zip(pivot.parts.iter().map(Vec::as_slice));
            for (to, part) in pairs.chain(parts) {
                if let Some(times) = &times {
                    *to = product(to, times);
                }
                product(part, &by).into_iter().for_each(|factor| add(to, factor));
                if to.len() > MOST_TERMS {
                    return None;
                }
            }
        }
        Some(())
    }
}

/// The product of two sums.
/// Like terms are added up, and terms that cancel are removed.
fn product(a: &[Monomial], b: &[Monomial]) -> MonomialSum {
    let mut made = MonomialSum::new();
    for left in a {
        b.iter().for_each(|right| add(&mut made, left.clone().times(right, 1)));
    }
    made
}

/// Adds a term to the like one, if there is one. Terms that cancel are removed.
fn add(to: &mut MonomialSum, factor: Monomial) {
    let Some(at) = to.iter().position(|term| term.is_like(&factor)) else { return to.push(factor) };
    match sum(&to[at], &factor) {
        Some(sum) => to[at] = sum,
        None => drop(to.swap_remove(at)),
    }
}

/// The sum of two like factors; `None` where they cancel up to rounding.
pub(super) fn sum(a: &Monomial, b: &Monomial) -> Option<Monomial> {
    let number = a.number + b.number;
    let cancels = number.abs() <= CANCELLED * (a.number.abs() + b.number.abs());
    (!cancels).then(|| a.clone().with_number(number))
}

/// The same factors up to a common one, chosen so that as many as possible are numbers.
fn with_most_numbers(sums: Vec<MonomialSum>) -> Vec<MonomialSum> {
    let single = || sums.iter().filter_map(|sum| if let [factor] = sum.as_slice() { Some(factor) } else { None });
    let like = |f: &Monomial| single().filter(|other| other.is_like(f)).count();
    let Some(common) = single().max_by_key(|f| like(f)).cloned() else { return sums };
    let divided = |sum: MonomialSum| sum.into_iter().map(|f| f.times(&common, -1)).collect();
    sums.into_iter().map(divided).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_expr::ExprId;

    /// Laurent polynomials of a few symbols, by the symbols' exponents.
    fn symbol(id: u32, exponent: i32) -> Monomial {
        Monomial::ONE.times(&Monomial::of(ExprId(id)), exponent)
    }

    #[test]
    fn conductances_at_a_node_add_up_to_a_sum() {
        // Currents i, j, k through a, b, c from a node x: x = a*i, x = b*j, x = -c*k, i + j = k, and i + j is the
        // inflow.
        let (a, b, c) = (symbol(1, 1), symbol(2, 1), symbol(3, 1));
        let (minus, one) = (Monomial::ONE.negative(), Monomial::ONE);
        let rows = [
            vec![(0, &one), (1, &a)],
            vec![(0, &one), (2, &b)],
            vec![(0, &minus), (3, &c)],
            vec![(1, &one), (2, &one), (3, &minus)],
            vec![(1, &one), (2, &one)],
        ];
        let found = factors(&rows).expect("they depend on each other");
        for chain in 0..4 {
            let mut left = MonomialSum::new();
            for (row, factor) in rows.iter().zip(&found) {
                for (_, entry) in row.iter().filter(|entry| entry.0 == chain) {
                    product(factor, std::slice::from_ref(*entry)).into_iter().for_each(|term| add(&mut left, term));
                }
            }
            assert!(left.is_empty(), "{chain}: {left:?}");
        }
        assert!(found.iter().any(|sum| sum.len() > 1), "{found:?}");
    }

    #[test]
    fn rows_that_depend_by_value_only_are_left() {
        let (a, b) = (symbol(1, 1), symbol(2, 1));
        assert!(factors(&[vec![(0, &a)], vec![(0, &b)]]).is_some());
        assert!(factors(&[vec![(0, &a), (1, &b)], vec![(0, &b), (1, &a)]]).is_none());
    }
}
