//! Which explicit variables IDA sees as unknowns.
//!
//! Explicit assignments are no unknowns of IDA. Those with one user are inserted into that user's kernel (inlined); the
//! others are computed once per evaluation into their slot (local). In large systems a variable that many rows use and
//! that depends on many columns is kept as an algebraic unknown. Eliminating it would fill the Jacobian with
//! rows x columns entries in place of rows + columns + 1 (the count of H. Markowitz, Management Science 3 (1957) 255).
//!
//! A conserved quantity is an unknown beside the states. Its row is its rate. The row of the state that follows from it
//! requires that the quantity by the states equals the integrated one.

use super::layout::{ValueLayout, ValueSlot, slot};
use super::{ColumnRole, ResidualRow, ResidualRowKind, UnknownColumn};
use bramah_expr::visit::NodeTraversal;
use bramah_expr::{ExprId, VarId};
use bramah_model::flat::ScalarType;
use bramah_model::structure::{BltBlock, ConservedQuantity, Dae, ExplicitAssignment, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// Systems with at most this many unknowns keep no explicit variable.
const SMALL: usize = 60;

/// Inlining stops when a definition would grow beyond this many nodes.
const INLINED_SIZE: usize = 400;

/// What becomes of an explicit assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssignmentFate {
    /// No row needs it; only outputs do.
    Unused,
    /// Its definition is part of its user's kernel.
    Inlined,
    /// It is computed into its slot at every evaluation.
    Local,
    /// It is an unknown of IDA, with a row of its own.
    Kept,
}

/// The continuous system as IDA sees it.
#[derive(Clone, Debug, Default)]
pub struct ContinuousPlan {
    /// All explicit assignments, in order.
    pub explicit: Vec<ExplicitAssignment>,
    /// The fate of each explicit assignment.
    pub fates: Vec<AssignmentFate>,
    /// The definitions that replace their variables, by slot.
    pub inline: FxHashMap<ValueSlot, ExprId>,
    /// The unknowns of IDA.
    pub columns: Vec<UnknownColumn>,
    /// The rows, one per column.
    pub rows: Vec<ResidualRow>,
    /// For each row the explicit assignment it belongs to; `None` for residuals of loops and rows of quantities.
    pub row_explicit: Vec<Option<usize>>,
    /// For each explicit assignment the number of needed assignments and residuals that read it.
    pub users: Vec<u32>,
    /// States whose derivative is a tearing variable: column, and slot of the derivative.
    pub torn: Vec<(usize, ValueSlot)>,
    /// The integrated quantities, with their columns and those of the following states.
    pub integrals: Vec<(ConservedQuantity, usize, usize)>,
}

/// Decides the fate of all explicit assignments of `dae.continuous`, and gives every unknown its row.
///
/// With `keep`, some explicit variables of large systems become unknowns. With `conserve`, conserved quantities do.
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

/// No explicit assignment.
const NOBODY: u32 = u32::MAX;

/// What a row is made of, if not of an explicit assignment.
#[derive(Clone, Copy)]
enum RowOrigin {
    /// The residual of a loop: expression, equation, its unknown, and whether that is the only unknown of its loop.
    Residual(ExprId, u32, Unknown, bool),
    /// The rate of a conserved quantity.
    Rate(ConservedQuantity),
    /// The conserved quantity itself, for the row of its state.
    Quantity(ConservedQuantity),
}

impl RowOrigin {
    /// The expression of the row.
    fn value(&self) -> ExprId {
        match self {
            RowOrigin::Residual(value, ..) => *value,
            RowOrigin::Rate(c) => c.rate,
            RowOrigin::Quantity(c) => c.quantity,
        }
    }
}

/// Collects the plan step by step, in the order of the calls in [`plan`].
struct ContinuousPlanner<'a> {
    /// The sorted model.
    dae: &'a Dae,
    /// The slots of the model.
    layout: &'a ValueLayout,
    /// All explicit assignments, in order.
    explicit: Vec<ExplicitAssignment>,
    /// All rows that are no explicit assignments.
    roots: Vec<RowOrigin>,
    /// For each slot the explicit assignment that computes it, or `NOBODY`.
    producer: Vec<u32>,
    /// For each explicit assignment, then for each root, the explicit assignments it reads.
    reads: Vec<Vec<u32>>,
    /// For each explicit assignment, then for each root, the other slots it reads.
    leaves: Vec<Vec<ValueSlot>>,
    /// For each explicit assignment and root, whether a row needs it.
    needed: Vec<bool>,
    /// For each explicit assignment the number of needed users.
    users: Vec<u32>,
    /// The fate of each explicit assignment.
    fates: Vec<AssignmentFate>,
    /// The unknowns so far.
    columns: Vec<UnknownColumn>,
    /// For each slot the column whose value or derivative it holds.
    seed: FxHashMap<ValueSlot, u32>,
    /// Columns whose derivative is a tearing variable, with its slot.
    torn: Vec<(usize, ValueSlot)>,
    /// Following states whose derivatives no explicit assignment gives.
    followers_torn: Vec<VarId>,
    /// The integrated quantities, with their columns and those of the following states.
    integrals: Vec<(ConservedQuantity, usize, usize)>,
}

impl<'a> ContinuousPlanner<'a> {
    /// An empty plan.
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

    /// Collects explicit assignments and residuals from the sorted blocks.
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

    /// Adds an explicit assignment.
    fn add_explicit(&mut self, assign: ExplicitAssignment) {
        self.producer[self.layout.unknown(assign.unknown)] = slot(self.explicit.len());
        self.explicit.push(assign);
    }

    /// Chooses the conserved quantities to integrate, and removes the residuals that gave their states' derivatives.
    ///
    /// A quantity is chosen when its rate does not depend on the derivative of its own state, and when the quantity
    /// itself depends on that state.
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

    /// All slots that an expression depends on, directly or through explicit assignments.
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

    /// Finds for each definition which explicit assignments and which other slots it reads.
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

    /// Whether an explicit assignment computes a derivative.
    fn is_derivative(&self, i: usize) -> bool {
        matches!(self.explicit[i].unknown, Unknown::Der(_))
    }

    /// Marks what rows need, and counts users among what is needed.
    ///
    /// Rows are the roots and all explicit derivatives.
    fn find_needed(&mut self) {
        let explicit = self.explicit.len();
        self.needed = (0..self.reads.len()).map(|i| i >= explicit || self.is_derivative(i)).collect();
        self.users = vec![0; explicit];
        // definitions read earlier ones only, so one pass backwards suffices
        for i in (0..self.reads.len()).rev() {
            if self.needed[i] {
                for &read in &self.reads[i] {
                    self.needed[read as usize] = true;
                    self.users[read as usize] += 1;
                }
            }
        }
    }

    /// Chooses between unused, inlined and local.
    ///
    /// A definition is inlined when it has one user and is not too large, or when it is a single node. Derivatives stay
    /// local, because they are rows.
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

    /// Numbers the unknowns: states, then tearing variables and quantities in the order of the roots.
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

    /// The derivative of this state is read from the integrator's y'.
    fn add_torn(&mut self, x: VarId) {
        let column = self.seed[&slot(self.layout.var(x))];
        let der = slot(self.layout.unknown(Unknown::Der(x)));
        self.seed.insert(der, column);
        self.torn.push((column as usize, der));
    }

    /// Adds an unknown.
    fn add_column(&mut self, variable: VarId, role: ColumnRole) {
        self.seed.insert(slot(self.layout.var(variable)), slot(self.columns.len()));
        self.columns.push(UnknownColumn { variable, role });
    }

    /// Keeps a variable as an unknown where that saves entries: rows x columns > rows + columns + 1.
    fn choose_kept(&mut self) {
        if self.columns.len() <= SMALL {
            return;
        }
        // the search for a following state varies its quantity along the state, which a kept unknown would hide
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
                // users of a kept variable depend on its column alone
                span = vec![slot(self.columns.len())];
                self.add_column(v, ColumnRole::Algebraic);
            }
            spans.push(span);
        }
    }

    /// For each explicit assignment whether a conserved quantity depends on it.
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

    /// Whether a variable can be an unknown of IDA: only variables of type Real.
    fn can_be_kept(&self, i: usize) -> bool {
        match self.explicit[i].unknown {
            Unknown::Var(v) => self.dae.variables[v.index()].ty == ScalarType::Real,
            Unknown::Der(_) => false,
        }
    }

    /// The columns that an explicit assignment depends on, sorted.
    fn span(&self, i: usize, spans: &[Vec<u32>]) -> Vec<u32> {
        let mut span: Vec<u32> = self.leaves[i].iter().filter_map(|leaf| self.seed.get(leaf).copied()).collect();
        for &read in &self.reads[i] {
            span.extend_from_slice(&spans[read as usize]);
        }
        span.sort_unstable();
        span.dedup();
        span
    }

    /// Gives every column its row and returns the plan.
    ///
    /// Panics where a column has no row, which would be an error of the sorting.
    fn finish(self) -> ContinuousPlan {
        let mut rows: Vec<Option<(ResidualRow, Option<usize>)>> = vec![None; self.columns.len()];
        let mut inline = FxHashMap::default();
        for (i, (assign, &fate)) in self.explicit.iter().zip(&self.fates).enumerate() {
            let &ExplicitAssignment { unknown, value, equation } = assign;
            if fate == AssignmentFate::Inlined {
                inline.insert(slot(self.layout.unknown(unknown)), value);
            }
            let kind = match (unknown, fate) {
                // the row of a following state is that of its quantity
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

    /// The column of a variable that is an unknown.
    fn place(&self, v: VarId) -> usize {
        self.seed[&slot(self.layout.var(v))] as usize
    }

    /// Whether a state follows from a conserved quantity.
    fn follows(&self, x: VarId) -> bool {
        self.columns[self.place(x)].role == ColumnRole::Following
    }

    /// The column of a variable or of a state's derivative; `None` where it is no unknown.
    fn column(&self, unknown: Unknown) -> Option<usize> {
        let (Unknown::Var(v) | Unknown::Der(v)) = unknown;
        self.seed.get(&slot(self.layout.var(v))).map(|&column| column as usize)
    }
}
