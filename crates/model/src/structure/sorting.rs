//! From matched equations to blocks: components of the continuous part, then these with the discrete equations.

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
    pub columns: Vec<Unknown>,
    pub rows: Vec<SystemRow>,
    pub incidence: IncidenceMatrix,
    pub matching: Matching,
}

/// Where unknowns stand among the columns of a system.
#[derive(Clone, Debug, Default)]
pub(super) struct UnknownColumns {
    of_var: Vec<u32>,
    of_der: Vec<u32>,
}

impl UnknownColumns {
    /// The places of these unknowns, in a model of so many variables.
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

    /// The column of an unknown, if it has one.
    pub fn of(&self, unknown: Unknown) -> Option<u32> {
        let (places, v) = match unknown {
            Unknown::Var(v) => (&self.of_var, v),
            Unknown::Der(v) => (&self.of_der, v),
        };
        places.get(v.index()).copied().filter(|&c| c != NONE)
    }

    /// The column of the unknown that a node is.
    pub fn of_node(&self, node: ExprNode) -> Option<u32> {
        match node {
            ExprNode::Var(v) => self.of(Unknown::Var(v)),
            ExprNode::Der(v) => self.of(Unknown::Der(v)),
            _ => None,
        }
    }
}

/// An equation of a [`EquationSystem`].
#[derive(Clone, Copy, Debug)]
pub(super) struct SystemRow {
    pub equation: FlatEquation,
    /// Index into `Dae::equations`.
    pub index: u32,
    pub discrete: bool,
}

impl EquationSystem {
    /// The blocks of the continuous rows, discrete unknowns being known.
    pub fn continuous_blocks(&self, solver: &mut BlockSolver) -> (StrongComponents, Vec<BltBlock>) {
        let found = blt::components(self.rows.len(), |row, out| {
            if !self.rows[row as usize].discrete {
                let owners = self.incidence.all(row).iter().map(|&c| self.matching.row_of[c as usize]);
                out.extend(owners.filter(|&o| o != NONE && o != row && !self.rows[o as usize].discrete));
            }
        });
        let kept = found.filtered(|members| !self.rows[members[0] as usize].discrete);
        let mut marks = vec![u32::MAX; self.columns.len()];
        let blocks = kept.iter().enumerate().map(|(i, rows)| self.block(solver, rows, i as u32, &mut marks)).collect();
        (kept, blocks)
    }

    /// `marks` tells the columns of the component `number` from others.
    fn block(&self, solver: &mut BlockSolver, rows: &[u32], number: u32, marks: &mut [u32]) -> BltBlock {
        let column = |row: u32| self.matching.column_of[row as usize];
        if let [row] = rows {
            let SystemRow { equation, index, .. } = &self.rows[*row as usize];
            return solver.single(equation, *index, self.columns[column(*row) as usize]);
        }
        let mut columns: Vec<u32> = rows.iter().map(|&row| column(row)).collect();
        columns.sort_unstable();
        for &c in &columns {
            marks[c as usize] = number;
        }
        let members: Vec<BlockEquation> = rows.iter().map(|&row| self.member(row, number, marks)).collect();
        solver.torn(&members, &columns, &self.columns)
    }

    fn member(&self, row: u32, number: u32, marks: &[u32]) -> BlockEquation {
        let SystemRow { equation, index, .. } = self.rows[row as usize];
        let inside = |c: &&u32| marks[**c as usize] == number;
        let columns: Vec<u32> = self.incidence.all(row).iter().filter(inside).copied().collect();
        let solvable = self.incidence.solvable(row).iter().filter(inside).count();
        BlockEquation { equation, index, columns, solvable }
    }

    /// The continuous blocks with the discrete equations in between; a loop through discrete equations becomes a
    /// [`MixedLoop`].
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

    fn mixed(&self, solver: &mut BlockSolver, continuous: Vec<BltBlock>, rows: &[u32]) -> BltBlock {
        let assigns: Vec<ExplicitAssignment> =
            self.discrete_order(rows).into_iter().map(|row| self.discrete(solver, row)).collect();
        match assigns.as_slice() {
            [one] if continuous.is_empty() && !depends_on_itself(solver, one) => BltBlock::Assign(*one),
            _ => BltBlock::Mixed(MixedLoop { continuous, discrete: assigns }),
        }
    }

    fn discrete(&self, solver: &mut BlockSolver, row: u32) -> ExplicitAssignment {
        let SystemRow { equation, index, .. } = &self.rows[row as usize];
        solver.discrete(equation, *index, self.columns[self.matching.column_of[row as usize] as usize])
    }

    /// Discrete rows in an order that follows their dependencies among each other as far as possible.
    fn discrete_order(&self, rows: &[u32]) -> Vec<u32> {
        let position = |row: u32| rows.binary_search(&row).ok().map(|p| p as u32);
        let sorted = blt::components(rows.len(), |node, out| {
            let owners = self.incidence.all(rows[node as usize]).iter().map(|&c| self.matching.row_of[c as usize]);
            out.extend(owners.filter(|&o| o != NONE).filter_map(position).filter(|&p| p != node));
        });
        sorted.iter().flatten().map(|&p| rows[p as usize]).collect()
    }
}

fn depends_on_itself(solver: &BlockSolver, assign: &ExplicitAssignment) -> bool {
    match assign.unknown {
        Unknown::Var(v) => solver.draft.exprs.variables(assign.value).contains(&v),
        Unknown::Der(_) => false,
    }
}
