//! From matched equations to blocks.
//!
//! Enters: an [`EquationSystem`] with a perfect matching. Leaves: its blocks in an order in which they can be solved.
//! First the continuous equations are sorted by themselves, with discrete unknowns as known quantities. Then these
//! blocks are sorted together with the discrete equations. `analysis` uses the first list between events and the second
//! one at events.

use super::blt::{self, StrongComponents};
use super::incidence::{IncidenceMatrix, NONE};
use super::matching::Matching;
use super::solve_block::{BlockEquation, BlockSolver};
use super::{BltBlock, ExplicitAssignment, MixedLoop, Unknown};
use crate::flat::FlatEquation;
use bramah_expr::ExprNode;

/// Equations with their unknowns, to be matched and sorted.
#[derive(Clone, Debug, Default)]
pub(super) struct EquationSystem {
    /// The unknowns.
    pub columns: Vec<Unknown>,
    /// The equations, as many as columns if the system is regular.
    pub rows: Vec<SystemRow>,
    /// The columns of each row.
    pub incidence: IncidenceMatrix,
    /// The partners of rows and columns.
    pub matching: Matching,
}

/// The inverse of a list of unknowns: the column of each.
#[derive(Clone, Debug, Default)]
pub(super) struct UnknownColumns {
    /// By variable: its column, or [`NONE`].
    of_var: Vec<u32>,
    /// By variable: the column of its derivative, or [`NONE`].
    of_der: Vec<u32>,
}

impl UnknownColumns {
    /// The columns of these unknowns, in a model of so many variables.
    pub fn new(unknowns: &[Unknown], variables: usize) -> Self {
        let mut made = UnknownColumns { of_var: vec![NONE; variables], of_der: vec![NONE; variables] };
        for (column, unknown) in (0..).zip(unknowns) {
            match unknown {
                Unknown::Var(v) => made.of_var[v.index()] = column,
                Unknown::Der(v) => made.of_der[v.index()] = column,
            }
        }
        made
    }

    /// The column of an unknown, or `None` if it has none.
    pub fn of(&self, unknown: Unknown) -> Option<u32> {
        let (places, v) = match unknown {
            Unknown::Var(v) => (&self.of_var, v),
            Unknown::Der(v) => (&self.of_der, v),
        };
        places.get(v.index()).copied().filter(|&c| c != NONE)
    }

    /// The column of the unknown that a node is; `None` for all other nodes.
    pub fn of_node(&self, node: ExprNode) -> Option<u32> {
        match node {
            ExprNode::Var(v) => self.of(Unknown::Var(v)),
            ExprNode::Der(v) => self.of(Unknown::Der(v)),
            _ => None,
        }
    }
}

/// A row of an [`EquationSystem`].
#[derive(Clone, Copy, Debug)]
pub(super) struct SystemRow {
    /// The equation as it reads in this system; at the start it may be an image of the one in the draft.
    pub equation: FlatEquation,
    /// Its number in `Dae::equations`.
    pub index: u32,
    /// Whether it determines a discrete unknown.
    pub discrete: bool,
}

impl EquationSystem {
    /// The blocks of the continuous rows, with discrete unknowns as known quantities. Returns the strongly connected
    /// components as lists of rows, and the block of each.
    /// Components are in the order in which they can be solved.
    pub fn continuous_blocks(&self, solver: &mut BlockSolver) -> (StrongComponents, Vec<BltBlock>) {
        // Discrete rows are nodes without edges here; they become components of their own, which are dropped.
        let found = blt::components(self.rows.len(), |row, out| {
            if !self.rows[row as usize].discrete {
                let owners = self.incidence.all(row).iter().map(|&c| self.matching.row_of[c as usize]);
                out.extend(owners.filter(|&o| o != NONE && o != row && !self.rows[o as usize].discrete));
            }
        });
        let kept = found.filtered(|members| !self.rows[members[0] as usize].discrete);
        // Shared by all blocks, with the block's number as the mark, so that it need not be cleared.
        let mut marks = vec![u32::MAX; self.columns.len()];
        let blocks = kept.iter().enumerate().map(|(i, rows)| self.block(solver, rows, i as u32, &mut marks)).collect();
        (kept, blocks)
    }

    /// The block of a component, given its rows. `number` is the number of the component; in `marks` the columns of the
    /// component carry it.
    /// A component of one row needs no tearing.
    fn block(&self, solver: &mut BlockSolver, rows: &[u32], number: u32, marks: &mut [u32]) -> BltBlock {
        let column = |row: u32| self.matching.column_of[row as usize];
        if let [row] = rows {
            let SystemRow { equation, index, .. } = &self.rows[*row as usize];
            return solver.single(equation, *index, self.columns[column(*row) as usize]);
        }
        let mut columns: Vec<u32> = rows.iter().map(|&row| column(row)).collect();
        // In the order of unknowns, so that tearing does not depend on the search order.
        columns.sort_unstable();
        for &c in &columns {
            marks[c as usize] = number;
        }
        let members: Vec<BlockEquation> = rows.iter().map(|&row| self.member(row, number, marks)).collect();
        solver.torn(&members, &columns, &self.columns)
    }

    /// A row of a component, with those of its columns that belong to the component.
    fn member(&self, row: u32, number: u32, marks: &[u32]) -> BlockEquation {
        let SystemRow { equation, index, .. } = self.rows[row as usize];
        let inside = |c: &&u32| marks[**c as usize] == number;
        let columns: Vec<u32> = self.incidence.all(row).iter().filter(inside).copied().collect();
        // Solvable columns come first in `all`, so their number is enough.
        let solvable = self.incidence.solvable(row).iter().filter(inside).count();
        BlockEquation { equation, index, columns, solvable }
    }

    /// The continuous blocks with the discrete equations in between. A loop through discrete equations becomes a
    /// [`MixedLoop`].
    ///
    /// `components` and `blocks` are the result of [`Self::continuous_blocks`]; the blocks are not made again.
    pub fn with_discrete(
        &self,
        solver: &mut BlockSolver,
        components: &StrongComponents,
        blocks: &[BltBlock],
    ) -> Vec<BltBlock> {
        let discrete: Vec<u32> = (0..self.rows.len() as u32).filter(|&r| self.rows[r as usize].discrete).collect();
        if discrete.is_empty() {
            return blocks.to_vec();
        }
        let count = components.len();
        // Nodes of this graph: one for each continuous block, then one for each discrete row.
        let mut node_of = vec![0_u32; self.rows.len()];
        for (i, rows) in components.iter().enumerate() {
            rows.iter().for_each(|&r| node_of[r as usize] = i as u32);
        }
        for (i, &r) in discrete.iter().enumerate() {
            node_of[r as usize] = (count + i) as u32;
        }
        let rows_of = |node: u32| match (node as usize).checked_sub(count) {
            Some(i) => &discrete[i..=i],
            None => components.get(node as usize),
        };
        let sorted = blt::components(count + discrete.len(), |node, out| {
            for &row in rows_of(node) {
                let owners = self.incidence.all(row).iter().map(|&c| self.matching.row_of[c as usize]);
                out.extend(owners.filter(|&o| o != NONE).map(|o| node_of[o as usize]).filter(|&n| n != node));
            }
        });
        let mut out = Vec::with_capacity(sorted.len());
        for nodes in sorted.iter() {
            // Nodes ascend: blocks in their order first, then discrete equations.
            let split = nodes.partition_point(|&n| (n as usize) < count);
            let rows: Vec<u32> = nodes[split..].iter().map(|&n| discrete[n as usize - count]).collect();
            let inside = &nodes[..split];
            match (inside, rows.as_slice()) {
                ([one], []) => out.push(blocks[*one as usize].clone()),
                _ => out.push(self.mixed(solver, inside.iter().map(|&n| blocks[n as usize].clone()).collect(), &rows)),
            }
        }
        out
    }

    /// The block of one component with discrete rows. A lone discrete equation that does not read its own unknown is an
    /// assignment.
    fn mixed(&self, solver: &mut BlockSolver, continuous: Vec<BltBlock>, rows: &[u32]) -> BltBlock {
        let assigns: Vec<ExplicitAssignment> =
            self.discrete_order(rows).into_iter().map(|row| self.discrete(solver, row)).collect();
        match assigns.as_slice() {
            [one] if continuous.is_empty() && !depends_on_itself(solver, one) => BltBlock::Assign(*one),
            _ => BltBlock::Mixed(MixedLoop { continuous, discrete: assigns }),
        }
    }

    /// A discrete row as an assignment to its partner.
    fn discrete(&self, solver: &mut BlockSolver, row: u32) -> ExplicitAssignment {
        let SystemRow { equation, index, .. } = &self.rows[row as usize];
        solver.discrete(equation, *index, self.columns[self.matching.column_of[row as usize] as usize])
    }

    /// Discrete rows in an order that follows their dependencies among each other as far as possible, so that the
    /// iteration of a mixed loop needs few passes.
    fn discrete_order(&self, rows: &[u32]) -> Vec<u32> {
        let position = |row: u32| rows.binary_search(&row).ok().map(|p| p as u32);
        let sorted = blt::components(rows.len(), |node, out| {
            let owners = self.incidence.all(rows[node as usize]).iter().map(|&c| self.matching.row_of[c as usize]);
            out.extend(owners.filter(|&o| o != NONE).filter_map(position).filter(|&p| p != node));
        });
        sorted.iter().flatten().map(|&p| rows[p as usize]).collect()
    }
}

/// Whether the value of an assignment reads its own unknown.
fn depends_on_itself(solver: &BlockSolver, assign: &ExplicitAssignment) -> bool {
    match assign.unknown {
        Unknown::Var(v) => solver.draft.exprs.variables(assign.value).contains(&v),
        Unknown::Der(_) => false,
    }
}
