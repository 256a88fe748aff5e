//! Which explicit variables IDA sees.
//!
//! Explicit assignments are no unknowns of IDA. Those with one user take their user's shape (inlined), the others are
//! computed once per evaluation into their slot (local). In large systems a variable that many rows use and that
//! depends on many columns is kept as an algebraic unknown: eliminating it would fill the Jacobian with
//! rows x columns entries in place of rows + columns + 1.
//!
//! A conserved quantity is an unknown beside the states: its row is its rate, and the row of the state that follows from
//! it says what the quantity is by the states.

use super::layout::{ValueLayout, ValueSlot, slot};
use super::{ColumnRole, ResidualRow, ResidualRowKind, UnknownColumn};
use bramah_expr::visit::NodeTraversal;
use bramah_expr::{ExprId, VarId};
use bramah_model::flat::ScalarType;
use bramah_model::structure::{BltBlock, ConservedQuantity, Dae, ExplicitAssignment, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// Systems with at most this many unknowns keep no explicit variable.
const SMALL: usize = 60;

/// An inlined definition grows its user to at most this many nodes.
const INLINED_SIZE: usize = 400;

/// What becomes of an explicit assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssignmentFate {
    /// No row needs it; only outputs do.
    Unused,
    /// Its definition stands in its user's.
    Inlined,
    /// Computed into its slot.
    Local,
    /// An unknown of IDA, with a row of its own.
    Kept,
}

/// The continuous system as IDA is to see it.
#[derive(Clone, Debug, Default)]
pub struct ContinuousPlan {
    /// All explicit assignments, in order.
    pub explicit: Vec<ExplicitAssignment>,
    /// Per explicit assignment.
    pub fates: Vec<AssignmentFate>,
    /// The definitions that stand in for their variables, by slot.
    pub inline: FxHashMap<ValueSlot, ExprId>,
    /// The unknowns of IDA.
    pub columns: Vec<UnknownColumn>,
    /// One row per column.
    pub rows: Vec<ResidualRow>,
    /// Per row, the explicit assignment it belongs to; `None` for the residual of a loop.
    pub row_explicit: Vec<Option<usize>>,
    /// Per explicit assignment, how many needed ones and residuals read it.
    pub users: Vec<u32>,
    /// States whose derivative is a tearing variable: column and slot of the derivative.
    pub torn: Vec<(usize, ValueSlot)>,
    /// The quantities that are integrated, with their columns and those of the states that follow.
    pub integrals: Vec<(ConservedQuantity, usize, usize)>,
}

/// Sorts explicit assignments of `dae.continuous` into their fates, and gives every unknown its row. With `keep`, some
/// explicit variables of large systems become unknowns; with `conserve`, conserved quantities do.
pub fn plan(dae: &Dae, layout: &ValueLayout, keep: bool, conserve: bool) -> ContinuousPlan {
    let mut planner = ContinuousPlanner::new(dae, layout);
    planner.collect(&dae.continuous);
    if conserve {
        planner.choose_conserved();
    }
    planner.find_leaves();
    planner.find_needed();
    planner.choose_inlined();
    planner.number_columns();
    if keep {
        planner.choose_kept();
    }
    planner.finish()
}

const NOBODY: u32 = u32::MAX;

/// What a row is made of that is no explicit assignment.
#[derive(Clone, Copy)]
enum RowOrigin {
    /// The residual of a loop, with its equation and its unknown; whether that is the only one of its loop.
    Residual(ExprId, u32, Unknown, bool),
    /// The rate of a conserved quantity.
    Rate(ConservedQuantity),
    /// The quantity itself.
    Quantity(ConservedQuantity),
}

impl RowOrigin {
    fn value(&self) -> ExprId {
        match self {
            RowOrigin::Residual(value, ..) => *value,
            RowOrigin::Rate(c) => c.rate,
            RowOrigin::Quantity(c) => c.quantity,
        }
    }
}

struct ContinuousPlanner<'a> {
    dae: &'a Dae,
    layout: &'a ValueLayout,
    explicit: Vec<ExplicitAssignment>,
    roots: Vec<RowOrigin>,
    /// Per slot, the explicit assignment that computes it.
    producer: Vec<u32>,
    /// Per explicit assignment, then per residual, the explicit assignments it reads.
    reads: Vec<Vec<u32>>,
    /// Per explicit assignment, then per residual, other slots it reads.
    leaves: Vec<Vec<ValueSlot>>,
    needed: Vec<bool>,
    users: Vec<u32>,
    fates: Vec<AssignmentFate>,
    columns: Vec<UnknownColumn>,
    /// Per slot, the column whose value or derivative it holds.
    seed: FxHashMap<ValueSlot, u32>,
    torn: Vec<(usize, ValueSlot)>,
    /// States that follow from a quantity and whose derivatives no explicit assignment gives.
    followers_torn: Vec<VarId>,
    integrals: Vec<(ConservedQuantity, usize, usize)>,
}

impl<'a> ContinuousPlanner<'a> {
    fn new(dae: &'a Dae, layout: &'a ValueLayout) -> Self {
        ContinuousPlanner {
            dae,
            layout,
            explicit: Vec::new(),
            roots: Vec::new(),
            producer: vec![NOBODY; layout.len()],
            reads: Vec::new(),
            leaves: Vec::new(),
            needed: Vec::new(),
            users: Vec::new(),
            fates: Vec::new(),
            columns: Vec::new(),
            seed: FxHashMap::default(),
            torn: Vec::new(),
            followers_torn: Vec::new(),
            integrals: Vec::new(),
        }
    }

    fn collect(&mut self, blocks: &[BltBlock]) {
        for block in blocks {
            match block {
                BltBlock::Assign(assign) => self.add_explicit(*assign),
                BltBlock::Loop(l) => {
                    l.inner.iter().for_each(|&assign| self.add_explicit(assign));
                    let (residuals, lone) = (l.residuals.iter().zip(&l.tearing), l.tearing.len() == 1);
                    let root = |(&(e, equation), &unknown): (&(ExprId, u32), &Unknown)| {
                        RowOrigin::Residual(e, equation, unknown, lone)
                    };
                    self.roots.extend(residuals.map(root));
                }
                BltBlock::Mixed(mixed) => self.collect(&mixed.continuous),
            }
        }
    }

    fn add_explicit(&mut self, assign: ExplicitAssignment) {
        self.producer[self.layout.unknown(assign.unknown)] = slot(self.explicit.len());
        self.explicit.push(assign);
    }

    /// Takes the conserved quantities whose rates do not hang on how fast their own states move, and takes the residuals
    /// that give these derivatives out.
    fn choose_conserved(&mut self) {
        let lone = |root: &RowOrigin| match root {
            RowOrigin::Residual(_, _, Unknown::Der(x), true) => Some(*x),
            _ => None,
        };
        let torn: FxHashSet<VarId> = self.roots.iter().filter_map(lone).collect();
        let mut taken: FxHashSet<VarId> = FxHashSet::default();
        for &c in &self.dae.conserved {
            let der = self.layout.unknown(Unknown::Der(c.state));
            let is_torn = torn.contains(&c.state);
            let known = self.reached(c.quantity);
            if !(is_torn || self.producer[der] != NOBODY)
                || self.reached(c.rate).contains(&slot(der))
                || !known.contains(&slot(self.layout.var(c.state)))
            {
                continue;
            }
            if is_torn {
                taken.insert(c.state);
                self.followers_torn.push(c.state);
            }
            self.roots.extend([RowOrigin::Rate(c), RowOrigin::Quantity(c)]);
        }
        self.roots.retain(|root| lone(root).is_none_or(|x| !taken.contains(&x)));
    }

    /// The slots on which an expression depends, through explicit assignments too.
    fn reached(&self, e: ExprId) -> FxHashSet<ValueSlot> {
        let mut seen: FxHashSet<ValueSlot> = FxHashSet::default();
        let mut open = vec![e];
        let mut walk = NodeTraversal::default();
        while let Some(e) = open.pop() {
            walk.each(&self.dae.exprs, &[e], |_, node| {
                if let Some(slot) = self.layout.leaf(node)
                    && seen.insert(slot)
                    && self.producer[slot as usize] != NOBODY
                {
                    open.push(self.explicit[self.producer[slot as usize] as usize].value);
                }
                true
            });
        }
        seen
    }

    fn find_leaves(&mut self) {
        let mut walk = NodeTraversal::default();
        let values = self.explicit.iter().map(|assign| assign.value);
        for e in values.chain(self.roots.iter().map(RowOrigin::value)) {
            let (mut reads, mut leaves) = (Vec::new(), Vec::new());
            walk.each(&self.dae.exprs, &[e], |_, node| {
                if let Some(slot) = self.layout.leaf(node) {
                    match self.producer[slot as usize] {
                        NOBODY => leaves.push(slot),
                        producer => reads.push(producer),
                    }
                }
                true
            });
            self.reads.push(reads);
            self.leaves.push(leaves);
        }
    }

    fn is_derivative(&self, i: usize) -> bool {
        matches!(self.explicit[i].unknown, Unknown::Der(_))
    }

    /// Marks what rows need, and counts users among what is needed.
    fn find_needed(&mut self) {
        let explicit = self.explicit.len();
        self.needed = (0..self.reads.len()).map(|i| i >= explicit || self.is_derivative(i)).collect();
        self.users = vec![0; explicit];
        for i in (0..self.reads.len()).rev() {
            if self.needed[i] {
                for &read in &self.reads[i] {
                    self.needed[read as usize] = true;
                    self.users[read as usize] += 1;
                }
            }
        }
    }

    fn choose_inlined(&mut self) {
        let mut size = vec![0usize; self.explicit.len()];
        for i in 0..self.explicit.len() {
            let value = self.explicit[i].value;
            let inlined = self.reads[i].iter().filter(|&&r| self.fates[r as usize] == AssignmentFate::Inlined);
            size[i] = self.dae.exprs.node_count(value) + inlined.map(|&r| size[r as usize]).sum::<usize>();
            let fate = if !self.needed[i] {
                AssignmentFate::Unused
            } else if !self.is_derivative(i) && (self.users[i] == 1 && size[i] <= INLINED_SIZE || size[i] == 1) {
                AssignmentFate::Inlined
            } else {
                AssignmentFate::Local
            };
            self.fates.push(fate);
        }
    }

    /// States, then tearing variables.
    fn number_columns(&mut self) {
        for &x in &self.dae.states {
            self.add_column(x, ColumnRole::State);
        }
        for k in 0..self.roots.len() {
            match self.roots[k] {
                RowOrigin::Residual(_, _, Unknown::Var(v), _) => self.add_column(v, ColumnRole::Algebraic),
                RowOrigin::Residual(_, _, Unknown::Der(x), _) => self.add_torn(x),
                RowOrigin::Rate(c) => {
                    let state = self.seed[&slot(self.layout.var(c.state))] as usize;
                    self.columns[state].role = ColumnRole::Following;
                    self.integrals.push((c, self.columns.len(), state));
                    self.add_column(c.variable, ColumnRole::Quantity);
                }
                RowOrigin::Quantity(_) => {}
            }
        }
        for x in std::mem::take(&mut self.followers_torn) {
            self.add_torn(x);
        }
    }

    /// The derivative of a state is read from what the integrator has.
    fn add_torn(&mut self, x: VarId) {
        let column = self.seed[&slot(self.layout.var(x))];
        let der = slot(self.layout.unknown(Unknown::Der(x)));
        self.seed.insert(der, column);
        self.torn.push((column as usize, der));
    }

    fn add_column(&mut self, variable: VarId, role: ColumnRole) {
        self.seed.insert(slot(self.layout.var(variable)), slot(self.columns.len()));
        self.columns.push(UnknownColumn { variable, role });
    }

    /// The Markowitz count decides: rows x columns against rows + columns + 1.
    fn choose_kept(&mut self) {
        if self.columns.len() <= SMALL {
            return;
        }
        // what a quantity is by its state must be seen along the state
        let in_quantity = self.in_quantities();
        let mut spans: Vec<Vec<u32>> = Vec::with_capacity(self.explicit.len());
        for i in 0..self.explicit.len() {
            let mut span = if self.needed[i] { self.span(i, &spans) } else { Vec::new() };
            let (rows, columns) = (self.users[i] as usize, span.len());
            if self.fates[i] == AssignmentFate::Local
                && self.can_be_kept(i)
                && !in_quantity[i]
                && rows * columns > rows + columns + 1
            {
                let Unknown::Var(v) = self.explicit[i].unknown else { unreachable!("derivatives are not kept") };
                self.fates[i] = AssignmentFate::Kept;
                span = vec![slot(self.columns.len())];
                self.add_column(v, ColumnRole::Algebraic);
            }
            spans.push(span);
        }
    }

    /// The explicit assignments behind conserved quantities.
    fn in_quantities(&self) -> Vec<bool> {
        let explicit = self.explicit.len();
        let quantities = (0..self.roots.len()).filter(|&k| matches!(self.roots[k], RowOrigin::Quantity(_)));
        let mut found = vec![false; explicit];
        quantities.flat_map(|k| &self.reads[explicit + k]).for_each(|&i| found[i as usize] = true);
        for i in (0..explicit).rev() {
            if found[i] {
                self.reads[i].iter().for_each(|&read| found[read as usize] = true);
            }
        }
        found
    }

    fn can_be_kept(&self, i: usize) -> bool {
        match self.explicit[i].unknown {
            Unknown::Var(v) => self.dae.variables[v.index()].ty == ScalarType::Real,
            Unknown::Der(_) => false,
        }
    }

    /// The columns an explicit assignment depends on, sorted.
    fn span(&self, i: usize, spans: &[Vec<u32>]) -> Vec<u32> {
        let mut span: Vec<u32> = self.leaves[i].iter().filter_map(|leaf| self.seed.get(leaf).copied()).collect();
        for &read in &self.reads[i] {
            span.extend_from_slice(&spans[read as usize]);
        }
        span.sort_unstable();
        span.dedup();
        span
    }

    fn finish(self) -> ContinuousPlan {
        let mut rows: Vec<Option<(ResidualRow, Option<usize>)>> = vec![None; self.columns.len()];
        let mut inline = FxHashMap::default();
        for (i, (assign, &fate)) in self.explicit.iter().zip(&self.fates).enumerate() {
            let &ExplicitAssignment { unknown, value, equation } = assign;
            if fate == AssignmentFate::Inlined {
                inline.insert(slot(self.layout.unknown(unknown)), value);
            }
            let kind = match (unknown, fate) {
                (Unknown::Der(x), _) if self.follows(x) => continue,
                (Unknown::Der(_), _) => ResidualRowKind::Derivative,
                (_, AssignmentFate::Kept) => ResidualRowKind::Explicit,
                _ => continue,
            };
            if let Some(column) = self.column(unknown) {
                rows[column] = Some((ResidualRow { equation, kind, value }, Some(i)));
            }
        }
        for root in &self.roots {
            let value = root.value();
            let (column, equation, kind) = match *root {
                RowOrigin::Residual(_, equation, unknown, _) => {
                    (self.column(unknown).expect("tearing unknowns have columns"), equation, ResidualRowKind::Residual)
                }
                RowOrigin::Rate(c) => (self.place(c.variable), c.equation, ResidualRowKind::Derivative),
                RowOrigin::Quantity(c) => {
                    (self.place(c.state), c.equation, ResidualRowKind::Follows(self.place(c.variable)))
                }
            };
            rows[column] = Some((ResidualRow { equation, kind, value }, None));
        }
        let rows = rows.into_iter().map(|row| row.expect("the DAE determines every state and tearing unknown"));
        let (rows, row_explicit) = rows.unzip();
        ContinuousPlan {
            rows,
            row_explicit,
            inline,
            explicit: self.explicit,
            fates: self.fates,
            users: self.users,
            columns: self.columns,
            torn: self.torn,
            integrals: self.integrals,
        }
    }

    fn place(&self, v: VarId) -> usize {
        self.seed[&slot(self.layout.var(v))] as usize
    }

    fn follows(&self, x: VarId) -> bool {
        self.columns[self.place(x)].role == ColumnRole::Following
    }

    /// The column of a variable or of a state's derivative.
    fn column(&self, unknown: Unknown) -> Option<usize> {
        let (Unknown::Var(v) | Unknown::Der(v)) = unknown;
        self.seed.get(&slot(self.layout.var(v))).map(|&column| column as usize)
    }
}
