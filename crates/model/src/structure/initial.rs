//! The initial system, solved once at the start: all equations, initial equations and fixed start values (MLS 8.6).
//!
//! Enters: the running system with its matching, the states, and the initial equations of the draft. Leaves: a matched
//! [`EquationSystem`] whose unknowns are those of the run, the states and the free parameters. `analysis` calls
//! [`assemble`] and then sorts the system.
//!
//! Rows are matched in the order of their weight, and a later row never displaces an earlier one: the equations of the
//! model, initial equations, fixed starts of states, other fixed starts, `v = pre(v)` of discrete variables that
//! nothing else determines, and at last start values that are chosen here to make the system determined. A row that
//! finds no partner is redundant, contradicting, or a condition that is checked after the system is solved.

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::incidence::{IncidenceMatrix, IncidenceScanner, NONE};
use super::matching::{Matching, PathAugmenter};
use super::parameters::{self, SignAnalysis};
use super::sorting::{EquationSystem, SystemRow, UnknownColumns};
use super::{Unknown, delays, dependence, discrete, messages};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, StateSelect, Variability};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::diag::Diagnostic;
use rustc_hash::FxHashMap;

/// The matched system and the decisions behind it.
pub(super) struct InitialSystem {
    /// The matched rows with their unknowns, ready to be sorted.
    pub system: EquationSystem,
    /// Variables whose start values were chosen although they are not `fixed`.
    pub chosen: Vec<VarId>,
    /// Residuals of conditions that determine nothing but must hold, each with its equation.
    pub checks: Vec<(ExprId, u32)>,
    /// The first contradiction, or else a note about chosen starts.
    pub diagnostics: Vec<Diagnostic>,
}

/// How an initial equation that determines nothing relates to the others.
enum InitialRedundancy {
    /// It repeats another initial equation or an equation of the model.
    Said,
    /// It may follow from the equations of the model, so its residual is checked at the start.
    Follows,
    /// It competes with another initial condition for the same unknowns.
    Contradicts,
}

/// What the earlier steps have found.
pub(super) struct InitializationContext<'a> {
    /// All equations of the run, discrete ones included, with their unknowns and matching.
    pub running: &'a EquationSystem,
    /// The states, ascending.
    pub states: &'a [VarId],
    /// Differentiated variables that are no states, ascending. Their fixed starts may be redundant.
    pub demoted: &'a [VarId],
}

/// Sets up and matches the initial system. Adds initial equations and starts to the equations of the draft.
pub(super) fn assemble(draft: &mut DaeDraft, known: &mut SignAnalysis, model: &InitializationContext) -> InitialSystem {
    let mut assembly = InitialAssembly::new(draft, model);
    assembly.model_rows(draft, model);
    assembly.initial_equations(draft);
    assembly.fixed_starts(draft, model);
    assembly.discrete_defaults(draft);
    assembly.choose_starts(draft, known, model);
    assembly.check_said_starts(draft, model);
    assembly.finish(draft)
}

/// The initial system while it grows.
struct InitialAssembly {
    /// The unknowns: those of the run, then states, then free parameters.
    columns: Vec<Unknown>,
    /// Where unknowns are among the columns.
    places: UnknownColumns,
    /// By column: whether it is a discrete unknown.
    discrete_columns: Vec<bool>,
    /// The rows so far, matched or not.
    rows: Vec<SystemRow>,
    /// How many of the rows are equations of the model; these come first.
    model_rows: u32,
    /// The columns of each row.
    incidence: IncidenceMatrix,
    /// The partners so far.
    matching: Matching,
    /// Searches for augmenting paths. After a failed search it holds the competing rows.
    augmenter: PathAugmenter,
    /// Work space for `incidence`.
    scanner: IncidenceScanner,
    /// By expression: its image at the start, where `initial()` is 1 and `pre` of a variable that keeps its value is
    /// the variable.
    map: Vec<ExprId>,
    /// By variable: whether it is a discrete unknown whose equation is `v = pre(v)` at the start.
    keeps: Vec<bool>,
    /// See [`InitialSystem::chosen`].
    chosen: Vec<VarId>,
    /// See [`InitialSystem::checks`].
    checks: Vec<(ExprId, u32)>,
    /// See [`InitialSystem::diagnostics`].
    diagnostics: Vec<Diagnostic>,
}

impl InitialAssembly {
    /// No rows yet; all columns unmatched.
    fn new(draft: &mut DaeDraft, model: &InitializationContext) -> Self {
        let mut columns: Vec<Unknown> = model.running.columns.clone();
        columns.extend(model.states.iter().map(|&v| Unknown::Var(v)));
        columns.extend(draft.with_role(SystemRole::FreeParameter).into_iter().map(Unknown::Var));
        let is_discrete = |u: &Unknown| matches!(u, Unknown::Var(v) if draft.role(*v) == SystemRole::Discrete);
        let discrete_columns: Vec<bool> = columns.iter().map(is_discrete).collect();
        let matching = Matching::empty(0, columns.len());
        let (keeps, map) = at_start(draft, model.running);
        let places = UnknownColumns::new(&columns, draft.variables.len());
        InitialAssembly {
            columns,
            places,
            discrete_columns,
            rows: Vec::new(),
            model_rows: 0,
            incidence: IncidenceMatrix::default(),
            matching,
            augmenter: PathAugmenter::default(),
            scanner: IncidenceScanner::default(),
            map,
            keeps,
            chosen: Vec::new(),
            checks: Vec::new(),
            diagnostics: Vec::new(),
        }
    }

    /// An equation as it reads at the start.
    fn mapped(&self, equation: FlatEquation) -> FlatEquation {
        let image = |e: ExprId| self.map.get(e.index()).copied().unwrap_or(e);
        FlatEquation { lhs: image(equation.lhs), rhs: image(equation.rhs), origin: equation.origin }
    }

    /// Appends a row without matching it, and returns its number. `index` is its equation in the draft. `lone` lists
    /// the columns of a discrete row; `None` makes it a continuous one.
    fn push(&mut self, draft: &DaeDraft, equation: FlatEquation, index: u32, lone: Option<Vec<u32>>) -> u32 {
        let places = &self.places;
        let column = |node: ExprNode| places.of_node(node);
        let sides = [equation.lhs, equation.rhs];
        let discrete = lone.is_some();
        match lone {
            Some(lone) => self.scanner.push_discrete(&draft.exprs, sides, &lone, column, &mut self.incidence),
            None => {
                let continuous = |c: u32| !self.discrete_columns[c as usize];
                self.scanner.push(&draft.exprs, sides, column, continuous, &mut self.incidence);
            }
        }
        self.rows.push(SystemRow { equation, index, discrete });
        self.matching.column_of.push(NONE);
        self.rows.len() as u32 - 1
    }

    /// Matches a row if an augmenting path exists. False if not.
    fn augment(&mut self, row: u32) -> bool {
        self.augmenter.augment(&self.incidence, &mut self.matching, row, |_, _, _| true)
    }

    /// Appends the equations of the model. They keep their partners of the running system where that is possible:
    /// states and free parameters then remain for the initial conditions.
    ///
    /// Rows without their former partner are matched at the end, along augmenting paths. A row that finds none
    /// contradicts the others.
    fn model_rows(&mut self, draft: &DaeDraft, model: &InitializationContext) {
        let running = model.running;
        let mut open = Vec::new();
        for (i, row) in running.rows.iter().enumerate() {
            let partner = running.matching.column_of[i];
            // `discrete_defaults` adds `v = pre(v)` at its own, lower weight.
            if row.discrete && self.is_default(row, running.columns[partner as usize]) {
                continue;
            }
            let lone = row.discrete.then(|| vec![partner]);
            let made = self.push(draft, self.mapped(row.equation), row.index, lone);
            if self.incidence.solvable(made).contains(&partner) {
                self.matching.join(made, partner);
            } else {
                // At the start the partner may be missing, for instance where `initial()` selects another branch.
                open.push(made);
            }
        }
        self.model_rows = self.rows.len() as u32;
        for row in open {
            if !self.augment(row) {
                self.report(draft, row);
            }
        }
    }

    /// Whether a row is a discrete equation that says `v = pre(v)` at the start.
    fn is_default(&self, row: &SystemRow, unknown: Unknown) -> bool {
        matches!(unknown, Unknown::Var(v) if self.keeps[v.index()]) && row.discrete
    }

    /// Appends the initial equations. One that determines nothing is dropped, checked or reported, as
    /// [`Self::redundancy`] says.
    fn initial_equations(&mut self, draft: &mut DaeDraft) {
        for equation in draft.initial_equations.clone() {
            if self.takes_left_limit(draft, &equation) {
                continue;
            }
            draft.equations.push(equation);
            let index = draft.equations.len() as u32 - 1;
            let equation = self.mapped(equation);
            let lone = self.lone_columns(draft, &equation);
            let row = self.push(draft, equation, index, lone);
            if self.augment(row) {
                continue;
            }
            match self.redundancy(row) {
                InitialRedundancy::Said => {}
                InitialRedundancy::Follows => self.check(draft, row),
                InitialRedundancy::Contradicts => self.report(draft, row),
            }
        }
        draft.kinds.resize(draft.equations.len(), EquationRole::Continuous);
    }

    /// Whether an initial equation states the value of a discrete unknown before the start: `pre(v) = value` where `v`
    /// gets a value of its own at the start. The value becomes the start value of `v`. False for other equations, which
    /// stay.
    fn takes_left_limit(&self, draft: &mut DaeDraft, equation: &FlatEquation) -> bool {
        let pre = |e: ExprId| match draft.exprs.node(e) {
            ExprNode::Pre(v) if !self.keeps[v.index()] => Some(v),
            _ => None,
        };
        let sides = pre(equation.lhs).map(|v| (v, equation.rhs));
        let Some((v, value)) = sides.or_else(|| pre(equation.rhs).map(|v| (v, equation.lhs))) else { return false };
        let known = draft
            .exprs
            .variables(value)
            .into_iter()
            .all(|u| draft.variables[u.index()].variability <= Variability::Parameter);
        if !known || !draft.exprs.derivatives(value).is_empty() {
            return false;
        }
        // A value that reads the time is no start value. It is dropped: only the equation of `v` itself could ask for
        // it.
        let time = draft.exprs.time();
        if !draft.exprs.contains(value, time) {
            draft.variables[v.index()].start = Some(value);
        }
        true
    }

    /// How a row that found no partner relates to the rows that compete with it. The last search of the augmenter must
    /// have been for this row.
    /// Repeated equations are recognised by their sides alone, which may be exchanged.
    fn redundancy(&self, row: u32) -> InitialRedundancy {
        let own = self.rows[row as usize].equation;
        // A row without unknowns sees only itself. It may hold as a matter of values, so it is checked.
        let mut follows = self.augmenter.rows_seen.iter().all(|&seen| seen == row);
        for &seen in self.augmenter.rows_seen.iter().filter(|&&seen| seen != row) {
            let other = self.rows[seen as usize].equation;
            let same = [(own.lhs, own.rhs), (own.rhs, own.lhs)].contains(&(other.lhs, other.rhs));
            if same {
                return InitialRedundancy::Said;
            }
            follows |= seen < self.model_rows;
        }
        if follows { InitialRedundancy::Follows } else { InitialRedundancy::Contradicts }
    }

    /// The columns that an initial equation can be solved for if it is a discrete one; `None` if it is continuous.
    fn lone_columns(&self, draft: &DaeDraft, equation: &FlatEquation) -> Option<Vec<u32>> {
        let lone = [equation.lhs, equation.rhs].map(|e| discrete::lone_discrete(draft, e));
        let left_is_continuous = lone[0].is_none() && discrete::has_continuous(draft, equation.lhs);
        let found: Vec<u32> = lone.iter().flatten().filter_map(|&v| self.places.of(Unknown::Var(v))).collect();
        (!found.is_empty() && !left_is_continuous).then_some(found)
    }

    /// Appends `x = start` for fixed continuous unknowns, states first.
    /// One that contradicts is checked for differentiated variables that are no states, and reported for others.
    fn fixed_starts(&mut self, draft: &mut DaeDraft, model: &InitializationContext) {
        let is_state = |v: &VarId| model.states.binary_search(v).is_ok();
        let fixed = draft.with_role(SystemRole::Continuous).into_iter().filter(|v| draft.variables[v.index()].fixed);
        let (states, others): (Vec<VarId>, Vec<VarId>) = fixed.partition(is_state);
        for v in states.into_iter().chain(others) {
            let row = self.push_start(draft, v);
            if self.augment(row) {
                continue;
            }
            // The constraint that demoted the variable may already determine it consistently.
            if model.demoted.binary_search(&v).is_ok() {
                self.check(draft, row);
            } else {
                self.report(draft, row);
            }
        }
    }

    /// Appends the row `v = start` without matching it. Without a start value it is the default of the type. Returns
    /// the number of the row.
    fn push_start(&mut self, draft: &mut DaeDraft, v: VarId) -> u32 {
        let variable = &draft.variables[v.index()];
        let origin = ElementOrigin { kind: OriginKind::Start, ..variable.origin };
        let (start, ty) = (variable.start, variable.ty);
        let rhs = match start {
            Some(e) => e,
            None => draft.exprs.num(parameters::default_start(ty)),
        };
        let lhs = draft.exprs.var(v);
        let equation = FlatEquation { lhs, rhs, origin };
        draft.add_equation(equation, EquationRole::Continuous);
        self.push(draft, equation, draft.equations.len() as u32 - 1, None)
    }

    /// Appends `v = pre(v)` for discrete unknowns whose equation says nothing else at the start. A contradiction is
    /// reported only if the start of the variable is `fixed`.
    /// Such a row is a definition and can be solved for `v` only.
    fn discrete_defaults(&mut self, draft: &mut DaeDraft) {
        for v in draft.with_role(SystemRole::Discrete) {
            if !self.keeps[v.index()] {
                continue;
            }
            let origin = ElementOrigin { kind: OriginKind::Start, ..draft.variables[v.index()].origin };
            let (lhs, rhs) = (draft.exprs.var(v), draft.exprs.pre(v));
            let equation = FlatEquation { lhs, rhs, origin };
            draft.add_equation(equation, EquationRole::Definition);
            let lone = Some(self.places.of(Unknown::Var(v)).into_iter().collect());
            let row = self.push(draft, equation, draft.equations.len() as u32 - 1, lone);
            if !self.augment(row) && draft.variables[v.index()].fixed {
                self.report(draft, row);
            }
        }
    }

    /// Fixes start values until everything is determined: those of states first, best candidates first, then those of
    /// other unknowns. Reports the unknowns that stay undetermined.
    ///
    /// Nothing is chosen where the fixed conditions are enough. Each start that finds a partner in the matching is
    /// recorded in `chosen`.
    fn choose_starts(&mut self, draft: &mut DaeDraft, known: &mut SignAnalysis, model: &InitializationContext) {
        let mut missing = self.matching.row_of.iter().filter(|&&r| r == NONE).count();
        if missing == 0 {
            return;
        }
        let first = self.rows.len();
        for v in self.start_candidates(draft, model) {
            let row = self.push_start(draft, v);
            if self.augment(row) {
                self.chosen.push(v);
                missing -= 1;
            }
            if missing == 0 {
                // A chosen start may follow from the others by the values of coefficients. It is taken back, and others
                // are tried.
                missing = self.give_up_what_follows(draft, known, first);
            }
            if missing == 0 {
                return;
            }
        }
        let open = (0..self.columns.len()).filter(|&c| self.matching.row_of[c] == NONE);
        let open: Vec<Unknown> = open.map(|c| self.columns[c]).collect();
        if !open.is_empty() && self.diagnostics.is_empty() {
            self.diagnostics.push(messages::initially_undetermined(draft, &open));
        }
    }

    /// Takes back chosen starts, in rows from `first` on, that follow linearly from the other rows although the
    /// structure does not show it. Returns how many.
    /// Only continuous rows take part, since discrete rows are assignments.
    fn give_up_what_follows(&mut self, draft: &DaeDraft, known: &mut SignAnalysis, first: usize) -> usize {
        let matched: Vec<usize> = (0..self.rows.len())
            .filter(|&row| self.matching.column_of[row] != NONE && !self.rows[row].discrete)
            .collect();
        let equations: Vec<FlatEquation> = matched.iter().map(|&row| self.rows[row].equation).collect();
        let follows = dependence::following(draft, known, &equations, |leaf| self.places.of_node(leaf));
        let chosen: Vec<usize> = follows.into_iter().map(|i| matched[i]).filter(|&row| row >= first).collect();
        for &row in &chosen {
            let column = std::mem::replace(&mut self.matching.column_of[row], NONE);
            self.matching.row_of[column as usize] = NONE;
            self.chosen.retain(|&v| draft.exprs.node(self.rows[row].equation.lhs) != ExprNode::Var(v));
        }
        chosen.len()
    }

    /// Adds checks for starts that the model states for its components, where another variable became the state. Beside
    /// starts that are `fixed` such a value is a guess, for instance of the branch on which a loop of joints is found;
    /// its equation is marked so.
    fn check_said_starts(&mut self, draft: &mut DaeDraft, model: &InitializationContext) {
        for &v in model.demoted {
            let variable = &draft.variables[v.index()];
            if variable.fixed || !variable.start_is_said() || self.chosen.contains(&v) {
                continue;
            }
            let row = self.push_start(draft, v);
            // The search also finds the rows that compete with this one.
            let determined = self.augment(row);
            if !determined
                && self.augmenter.rows_seen.iter().any(|&seen| seen != row && self.is_fixed_start(draft, seen))
            {
                let index = self.rows[row as usize].index;
                draft.equations[index as usize].origin.kind = OriginKind::Guess;
            }
            self.check(draft, row);
        }
    }

    /// Whether a row is the start of a variable with `fixed = true`.
    fn is_fixed_start(&self, draft: &DaeDraft, row: u32) -> bool {
        let equation = self.rows[row as usize].equation;
        let fixed = |v: VarId| draft.variables[v.index()].fixed;
        equation.origin.kind == OriginKind::Start
            && matches!(draft.exprs.node(equation.lhs), ExprNode::Var(v) if fixed(v))
    }

    /// Records that a row that determines nothing must hold all the same.
    fn check(&mut self, draft: &mut DaeDraft, row: u32) {
        let SystemRow { equation, index, .. } = self.rows[row as usize];
        let difference = draft.exprs.sub(equation.lhs, equation.rhs);
        self.checks.push((difference, index));
    }

    /// The unfixed variables in the order in which their starts are chosen.
    ///
    /// First states, other differentiated variables, and variables with a start that prefer to be states; among them
    /// those with the more confident start, then states, then those that rather want to be states. Then the other
    /// unknowns, at last free parameters.
    fn start_candidates(&self, draft: &DaeDraft, model: &InitializationContext) -> Vec<VarId> {
        let is_state = |v: &VarId| model.states.binary_search(v).is_ok();
        let is_differentiated = |v: &VarId| is_state(v) || model.demoted.binary_search(v).is_ok();
        let wish = |v: VarId| {
            let variable = &draft.variables[v.index()];
            (variable.state_select, variable.start.is_some())
        };
        let by_wish = |v: &VarId| (draft.variables[v.index()].confidence, !is_state(v), std::cmp::Reverse(wish(*v)));
        let (preferred, mut others): (Vec<VarId>, Vec<VarId>) =
            draft.with_role(SystemRole::Continuous).into_iter().filter(|v| !is_differentiated(v)).partition(|v| {
                let variable = &draft.variables[v.index()];
                variable.state_select >= StateSelect::Prefer && variable.start.is_some()
            });
        let mut found: Vec<VarId> = model.states.iter().chain(model.demoted).copied().chain(preferred).collect();
        found.sort_by_key(by_wish);
        others.sort_by_key(|&v| std::cmp::Reverse(wish(v)));
        found.extend(others);
        found.extend(draft.with_role(SystemRole::FreeParameter));
        found.retain(|&v| !draft.variables[v.index()].fixed);
        found
    }

    /// Reports a contradiction with all rows that compete. Only the first one is reported, because later ones may
    /// follow from it.
    fn report(&mut self, draft: &DaeDraft, row: u32) {
        if !self.diagnostics.is_empty() {
            return;
        }
        let mut rows = self.augmenter.rows_seen.clone();
        rows.sort_unstable();
        let equations: Vec<FlatEquation> = rows.iter().map(|&r| self.rows[r as usize].equation).collect();
        let diagnostic = messages::initially_contradicting(draft, &self.rows[row as usize].equation, &equations);
        self.diagnostics.push(diagnostic);
    }

    /// The system of matched rows, with the note about chosen starts.
    fn finish(self, draft: &DaeDraft) -> InitialSystem {
        let mut system = EquationSystem { columns: self.columns, ..EquationSystem::default() };
        system.matching = Matching::empty(0, system.columns.len());
        for (i, row) in self.rows.iter().enumerate() {
            let column = self.matching.column_of[i];
            if column == NONE {
                continue;
            }
            let solvable = self.incidence.solvable(i as u32);
            system.incidence.push(solvable, &self.incidence.all(i as u32)[solvable.len()..]);
            system.rows.push(*row);
            system.matching.column_of.push(NONE);
            system.matching.join(system.rows.len() as u32 - 1, column);
        }
        let mut diagnostics = self.diagnostics;
        // A start value that the class of a component gives is no surprise and needs no note.
        let unsaid: Vec<VarId> =
            self.chosen.iter().copied().filter(|v| !draft.variables[v.index()].confidence.is_of_component()).collect();
        if diagnostics.is_empty() && !unsaid.is_empty() {
            diagnostics.push(messages::chosen_starts(draft, &unsaid));
        }
        InitialSystem { system, chosen: self.chosen, checks: self.checks, diagnostics }
    }
}

/// By variable: whether it is a discrete unknown that keeps its value at the start. And by expression: its image there.
/// Delays are replaced by their sources: nothing has been recorded yet.
fn at_start(draft: &mut DaeDraft, running: &EquationSystem) -> (Vec<bool>, Vec<ExprId>) {
    // First only `initial()` is replaced: whether a variable keeps its value shows in its equation after that.
    let initial = draft.rewritten(|_, node| (node == ExprNode::Initial).then_some(Exprs::ONE));
    let mut keeps = vec![false; draft.variables.len()];
    for (row, &column) in running.rows.iter().zip(&running.matching.column_of) {
        if let (true, Unknown::Var(v)) = (row.discrete, running.columns[column as usize]) {
            let before = draft.exprs.pre(v);
            keeps[v.index()] = initial[row.equation.rhs.index()] == before && row.equation.lhs == draft.exprs.var(v);
        }
    }
    let before: FxHashMap<VarId, VarId> = draft.before_start.iter().copied().collect();
    // An initial equation determines `pre(v)`, so `v = pre(v)` is no default but a real equation.
    before.keys().for_each(|v| keeps[v.index()] = false);
    let keeping = keeps.clone();
    let mut map = draft.rewritten(|pool, node| match node {
        ExprNode::Initial => Some(Exprs::ONE),
        ExprNode::Pre(v) if before.contains_key(&v) => Some(pool.var(before[&v])),
        ExprNode::Pre(v) if keeping[v.index()] => Some(pool.var(v)),
        _ => None,
    });
    delays::undelayed(draft, &mut map);
    (keeps, map)
}
