//! One component of a sorted system as a [`BltBlock`]: explicit where that is safe, else a torn loop.
//!
//! Enters: the equations of a strongly connected component with their unknowns. Leaves: an assignment if there is one
//! equation whose coefficient cannot vanish, else an algebraic loop with tearing variables. `sorting` calls
//! [`BlockSolver`].

use super::draft::DaeDraft;
use super::parameters::SignAnalysis;
use super::tearing::{self, LoopGraph};
use super::{AlgebraicLoop, BltBlock, ExplicitAssignment, Unknown};
use crate::flat::FlatEquation;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};
use rustc_hash::FxHashMap;

/// How an equation can be solved for an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EquationSolvability {
    /// Symbolically, by `value`, for all values of the other quantities. `gentle` if the coefficient is plus or minus
    /// one, `switched` if it contains an `if`.
    Explicit { value: ExprId, gentle: bool, switched: bool },
    /// It is affine in the unknown, but the coefficient may vanish.
    Affine,
    /// It is not affine in the unknown.
    No,
}

/// Solves equations and remembers the outcome, since the three systems share most equations.
pub(super) struct BlockSolver<'a> {
    /// The system; new expressions go into its pool.
    pub draft: &'a mut DaeDraft,
    /// Tells which coefficients cannot vanish.
    pub known: &'a mut SignAnalysis,
    /// The outcomes, by both sides and the unknown.
    found: FxHashMap<(ExprId, ExprId, Unknown), EquationSolvability>,
}

/// An equation of a component.
#[derive(Clone, Debug)]
pub(super) struct BlockEquation {
    /// The equation.
    pub equation: FlatEquation,
    /// Its number in the draft.
    pub index: u32,
    /// Columns of the component that occur in it. The first `solvable` ones can be solved for in principle.
    pub columns: Vec<u32>,
    /// How many of `columns` the equation can be solved for.
    pub solvable: usize,
}

impl<'a> BlockSolver<'a> {
    /// A solver that has solved nothing yet.
    pub fn new(draft: &'a mut DaeDraft, known: &'a mut SignAnalysis) -> Self {
        BlockSolver { draft, known, found: FxHashMap::default() }
    }

    /// The block of one equation for one unknown: an assignment, or a loop with that unknown as its only tearing
    /// variable.
    /// It is an assignment only if the coefficient of the unknown cannot vanish, so that no division by 0 can happen in
    /// a run.
    /// It is an assignment only if the coefficient of the unknown cannot vanish, so that no division by 0 can happen in
    /// a run.
    pub fn single(&mut self, equation: &FlatEquation, index: u32, unknown: Unknown) -> BltBlock {
        match self.solve(equation, unknown) {
            EquationSolvability::Explicit { value, .. } => {
                BltBlock::Assign(ExplicitAssignment { unknown, value, equation: index })
            }
            other => {
                let residual = self.draft.exprs.sub(equation.lhs, equation.rhs);
                let (inner, residuals) = (Vec::new(), vec![(residual, index)]);
                BltBlock::Loop(AlgebraicLoop {
                    tearing: vec![unknown],
                    inner,
                    residuals,
                    linear: other == EquationSolvability::Affine,
                })
            }
        }
    }

    /// A discrete equation as an assignment: the unknown is one of its sides, the value is the other.
    pub fn discrete(&mut self, equation: &FlatEquation, index: u32, unknown: Unknown) -> ExplicitAssignment {
        let leaf = self.leaf(unknown);
        let value = if equation.lhs == leaf { equation.rhs } else { equation.lhs };
        ExplicitAssignment { unknown, value, equation: index }
    }

    /// The torn loop of several equations. `columns` are their unknowns, as many as members; `unknowns` has the unknown
    /// of every column of the system.
    ///
    /// In a nonlinear loop only equations with a coefficient of plus or minus one are solved. Newton's method finds the
    /// tearing variables to a tolerance, and a division by a small coefficient would multiply that error. For the same
    /// reason no equation of any loop is solved by a coefficient that switches, as those of ideal diodes do between 1
    /// and 1e-5: the pivots have to follow the modes.
    pub fn torn(&mut self, members: &[BlockEquation], columns: &[u32], unknowns: &[Unknown]) -> BltBlock {
        // Tearing numbers columns within the loop.
        let local: FxHashMap<u32, u32> = columns.iter().enumerate().map(|(i, &c)| (c, i as u32)).collect();
        let unknown = |c: u32| unknowns[columns[c as usize] as usize];
        // Decided for the whole loop, since it allows more entries to be solved.
        let linear = self.is_linear(members, columns, unknowns);
        let mut graph = LoopGraph::default();
        for member in members {
            let mut row = Vec::with_capacity(member.columns.len());
            for (at, c) in member.columns.iter().enumerate() {
                let c = local[c];
                let safe = at < member.solvable
                    && match self.solve(&member.equation, unknown(c)) {
                        EquationSolvability::Explicit { gentle, switched, .. } => linear && !switched || gentle,
                        _ => false,
                    };
                row.push((c, safe));
            }
            graph.rows.push(row);
        }
        // It decides only between columns of equal structural score.
        graph.liking = (0..columns.len() as u32).map(|c| self.liking(unknown(c))).collect();
        let torn = tearing::tear(&graph);
        let inner = torn.inner.iter().map(|&(row, c)| {
            let member = &members[row as usize];
            match self.solve(&member.equation, unknown(c)) {
                EquationSolvability::Explicit { value, .. } => {
                    ExplicitAssignment { unknown: unknown(c), value, equation: member.index }
                }
                _ => unreachable!("tearing solves safe entries only"),
            }
        });
        let inner = inner.collect();
        let residuals = torn.residuals.iter().map(|&row| {
            let member = &members[row as usize];
            (self.draft.exprs.sub(member.equation.lhs, member.equation.rhs), member.index)
        });
        let residuals = residuals.collect();
        BltBlock::Loop(AlgebraicLoop {
            tearing: torn.tearing.iter().map(|&c| unknown(c)).collect(),
            inner,
            residuals,
            linear,
        })
    }

    /// How suitable an unknown is as a tearing variable; larger is better. Derivatives cost the integrator nothing as
    /// iteration variables. A given start helps Newton's method. A variable that is not hidden counts a little more
    /// than a hidden one.
    fn liking(&self, unknown: Unknown) -> u32 {
        match unknown {
            Unknown::Der(_) => 4,
            Unknown::Var(v) => {
                let v = &self.draft.variables[v.index()];
                u32::from(v.start.is_some()) * 2 + u32::from(!v.hidden)
            }
        }
    }

    /// The expression that stands for an unknown.
    fn leaf(&mut self, unknown: Unknown) -> ExprId {
        match unknown {
            Unknown::Var(v) => self.draft.exprs.var(v),
            Unknown::Der(v) => self.draft.exprs.der(v),
        }
    }

    /// How an equation can be solved for an unknown.
    /// The outcome is kept for the next system that contains the equation.
    fn solve(&mut self, equation: &FlatEquation, unknown: Unknown) -> EquationSolvability {
        let key = (equation.lhs, equation.rhs, unknown);
        if let Some(&known) = self.found.get(&key) {
            return known;
        }
        let leaf = self.leaf(unknown);
        let pool = &mut self.draft.exprs;
        let solved = match pool.solve_for(equation.lhs, equation.rhs, leaf) {
            None => EquationSolvability::No,
            Some((value, coefficient)) if self.known.is_nonzero(pool, coefficient) => {
                // A division by such a coefficient amplifies no error.
                let gentle = pool.as_num(coefficient).is_some_and(|c| c.abs() == 1.0);
                let switched =
                    pool.reachable(&[coefficient], |_| true).iter().any(|&e| matches!(pool.node(e), ExprNode::If(..)));
                EquationSolvability::Explicit { value, gentle, switched }
            }
            Some(_) => EquationSolvability::Affine,
        };
        self.found.insert(key, solved);
        solved
    }

    /// Whether all members are affine in all unknowns of the loop together.
    /// The solver then needs one Newton step for the loop.
    fn is_linear(&self, members: &[BlockEquation], columns: &[u32], unknowns: &[Unknown]) -> bool {
        let set: rustc_hash::FxHashSet<Unknown> = columns.iter().map(|&c| unknowns[c as usize]).collect();
        let pool = &self.draft.exprs;
        members.iter().all(|m| {
            let sides = [m.equation.lhs, m.equation.rhs];
            is_affine(pool, sides, |node| match node {
                ExprNode::Var(v) => set.contains(&Unknown::Var(v)),
                ExprNode::Der(v) => set.contains(&Unknown::Der(v)),
                _ => false,
            })
        })
    }
}

/// Whether both expressions are affine in all leaves for which `is_unknown` is true, together. Products of two
/// unknowns, conditions that read one, and functions of one are not.
fn is_affine(pool: &Exprs, sides: [ExprId; 2], is_unknown: impl Fn(ExprNode) -> bool) -> bool {
    // `reachable` lists arguments before nodes, so one pass suffices.
    let mut holds: rustc_hash::FxHashSet<ExprId> = rustc_hash::FxHashSet::default();
    for e in pool.reachable(&sides, |_| true) {
        let node = pool.node(e);
        let depends = |a: ExprId| holds.contains(&a);
        let affected = pool.operands(e).as_slice().iter().any(|&a| depends(a));
        let fine = match node {
            ExprNode::Unary(op, _) => op == UnaryFunction::Neg,
            ExprNode::Binary(BinaryFunction::Add | BinaryFunction::Sub, ..) | ExprNode::Homotopy(..) => true,
            ExprNode::Binary(BinaryFunction::Mul, a, b) => !(depends(a) && depends(b)),
            ExprNode::Binary(BinaryFunction::Div, _, b) => !depends(b),
            ExprNode::If(c, ..) => !depends(c),
            _ => false,
        };
        if affected && !fine {
            return false;
        }
        if affected || is_unknown(node) {
            holds.insert(e);
        }
    }
    true
}
