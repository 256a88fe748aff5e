//! How often Pantelides' algorithm will differentiate each equation and each variable, computed before it does.
//!
//! These are the offsets `c` of equations and `d` of variables of the signature matrix: the order of variable `j` in
//! equation `i` is at most `d_j - c_i`, and equal to it along a matching (J. Pryce, A simple structural analysis method
//! for DAEs, BIT 41, 2001). They are found by Pantelides' steps on orders alone; nothing is differentiated.

use super::super::incidence::{IncidenceMatrix, NONE};
use super::super::matching::{Matching, PathAugmenter};
use super::super::pantelides::IndexReduction;

/// The offsets. Rows and chains (a variable with its derivatives) are numbered as in [`IndexReduction`]; a chain has
/// the number of its lowest column.
pub(super) struct DerivativeOffsets {
    /// By row: how often it is differentiated.
    pub rows: Vec<u32>,
    /// By column: the order of the highest derivative of the chain that begins there.
    pub chains: Vec<u32>,
}

/// The chain of an unknown, and its order of differentiation in it.
pub(super) type ChainPosition = (u32, u32);

/// By column of the reduction: its chain and its order.
pub(super) fn places(reduction: &IndexReduction) -> Vec<ChainPosition> {
    let mut places = vec![(NONE, 0); reduction.columns.len()];
    let lowest = (0..places.len()).filter(|&c| reduction.columns[c].integral == NONE);
    for chain in lowest {
        let (mut column, mut order) = (chain as u32, 0);
        while column != NONE {
            places[column as usize] = (chain as u32, order);
            (column, order) = (reduction.columns[column as usize].derivative, order + 1);
        }
    }
    places
}

impl DerivativeOffsets {
    /// The offsets of a system. `None` where equations cannot be matched with one unknown each however often they are
    /// differentiated: the system is structurally singular because unknowns cancel.
    pub fn new(reduction: &IndexReduction, places: &[ChainPosition]) -> Option<Self> {
        let mut chains = vec![0; places.len()];
        for &(chain, order) in places {
            chains[chain as usize] = order.max(chains[chain as usize]);
        }
        let signature = SignatureMatrix::new(reduction, places);
        let mut found = DerivativeOffsets { rows: vec![0; reduction.equations.len()], chains };
        // A matching of the highest derivatives that occur is a start; `raise` extends it.
        let highest = reduction.first_matching();
        let mut matching = Matching::empty(found.rows.len(), places.len());
        for (row, &column) in highest.column_of.iter().enumerate().filter(|(_, c)| **c != NONE) {
            matching.join(row as u32, places[column as usize].0);
        }
        found.raise(&signature, &mut matching).then_some(found)
    }

    /// The number of states (degrees of freedom): the sum of the orders along the matching.
    pub fn degrees(&self) -> i64 {
        let sum = |orders: &[u32]| orders.iter().map(|&n| i64::from(n)).sum::<i64>();
        sum(&self.chains) - sum(&self.rows)
    }

    /// Raises orders until every row is matched with a chain in which its order is the highest. False where that never
    /// happens: the limit is that of [`IndexReduction::reduce`].
    fn raise(&mut self, signature: &SignatureMatrix, matching: &mut Matching) -> bool {
        let most = self.chains.len() as u32;
        let mut augmenter = PathAugmenter::default();
        for row in 0..self.rows.len() as u32 {
            while matching.column_of[row as usize] == NONE {
                let highest = |row: u32, position: usize, chain: u32| {
                    signature.order(row, position) + self.rows[row as usize] == self.chains[chain as usize]
                };
                if augmenter.augment(&signature.chains, matching, row, highest) {
                    break;
                }
                // As in Pantelides' algorithm: all rows that compete, and the chains they compete for, are
                // differentiated once.
                augmenter.rows_seen.iter().for_each(|&r| self.rows[r as usize] += 1);
                augmenter.columns_seen.iter().for_each(|&c| self.chains[c as usize] += 1);
                if self.rows[row as usize] > most {
                    return false;
                }
            }
        }
        true
    }
}

/// The signature matrix: the chains of each row with the highest order in which the row contains them.
struct SignatureMatrix {
    /// By row: its chains.
    chains: IncidenceMatrix,
    /// By row: where its orders begin in `orders`.
    starts: Vec<usize>,
    /// The orders of all entries, in the order of the entries of `chains`.
    orders: Vec<u32>,
}

impl SignatureMatrix {
    /// Reads the highest orders from the incidence matrix of the reduction.
    fn new(reduction: &IndexReduction, places: &[ChainPosition]) -> Self {
        let mut made = SignatureMatrix { chains: IncidenceMatrix::default(), starts: Vec::new(), orders: Vec::new() };
        let mut row_places = Vec::new();
        for row in 0..reduction.equations.len() as u32 {
            row_places.clear();
            row_places.extend(reduction.solvable(row).iter().map(|&c| places[c as usize]));
            // The highest order of each chain first, so that `dedup` keeps it.
            row_places.sort_unstable_by_key(|&(chain, order)| (chain, std::cmp::Reverse(order)));
            row_places.dedup_by_key(|place| place.0);
            let chains: Vec<u32> = row_places.iter().map(|place| place.0).collect();
            made.chains.push(&chains, &[]);
            made.starts.push(made.orders.len());
            made.orders.extend(row_places.iter().map(|place| place.1));
        }
        made
    }

    /// The order of the entry at a position of a row.
    fn order(&self, row: u32, position: usize) -> u32 {
        self.orders[self.starts[row as usize] + position]
    }
}
