//! The system that is solved once at the start: all equations, initial equations and fixed start values.
//!
//! Rows are matched in order of their weight: the equations of the model, initial equations, fixed starts of states,
//! other fixed starts, `v = pre(v)` of discrete variables that nothing else determines, and at last start values that
//! are chosen here to make the system determined.

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

/// The matched system and what was decided on the way.
pub(super) struct InitialSystem {
    pub system: EquationSystem,
    /// Variables whose start values were chosen.
    pub chosen: Vec<VarId>,
    /// Fixed starts that hold only if they are consistent: expressions that must vanish, with their equations.
    pub checks: Vec<(ExprId, u32)>,
    pub diagnostics: Vec<Diagnostic>,
}

/// What an initial equation says that determines nothing.
enum InitialRedundancy {
    /// The same as another.
    Said,
    /// What may follow from the equations of the model: checked at the start.
    Follows,
    /// Something else than another condition.
    Contradicts,
}

/// What the other systems have found out.
pub(super) struct InitializationContext<'a> {
    /// The event system: all equations with their unknowns.
    pub running: &'a EquationSystem,
    pub states: &'a [VarId],
    /// Differentiated variables that are not states: their fixed starts may be redundant.
    pub demoted: &'a [VarId],
}

/// Sets up and matches the initial system.
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

struct InitialAssembly {
    columns: Vec<Unknown>,
    places: UnknownColumns,
    discrete_columns: Vec<bool>,
    rows: Vec<SystemRow>,
    /// How many of them are the model's own equations, which come first.
    model_rows: u32,
    incidence: IncidenceMatrix,
    matching: Matching,
    augmenter: PathAugmenter,
    scanner: IncidenceScanner,
    /// Where `initial()` is 1 and `pre` of a variable that keeps its value is the variable.
    map: Vec<ExprId>,
    keeps: Vec<bool>,
    chosen: Vec<VarId>,
    checks: Vec<(ExprId, u32)>,
    diagnostics: Vec<Diagnostic>,
}

impl InitialAssembly {
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

    fn mapped(&self, equation: FlatEquation) -> FlatEquation {
        let image = |e: ExprId| self.map.get(e.index()).copied().unwrap_or(e);
        FlatEquation { lhs: image(equation.lhs), rhs: image(equation.rhs), origin: equation.origin }
    }

    /// Appends a row without matching it.
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

    fn augment(&mut self, row: u32) -> bool {
        self.augmenter.augment(&self.incidence, &mut self.matching, row, |_, _, _| true)
    }

    /// The equations of the model, matched as they are when the model runs wherever possible.
    fn model_rows(&mut self, draft: &DaeDraft, model: &InitializationContext) {
        let running = model.running;
        let mut open = Vec::new();
        for (i, row) in running.rows.iter().enumerate() {
            let partner = running.matching.column_of[i];
            if row.discrete && self.is_default(row, running.columns[partner as usize]) {
                continue;
            }
            let lone = row.discrete.then(|| vec![partner]);
            let made = self.push(draft, self.mapped(row.equation), row.index, lone);
            if self.incidence.solvable(made).contains(&partner) {
                self.matching.join(made, partner);
            } else {
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

    /// A discrete equation that says `v = pre(v)` at the start.
    fn is_default(&self, row: &SystemRow, unknown: Unknown) -> bool {
        matches!(unknown, Unknown::Var(v) if self.keeps[v.index()]) && row.discrete
    }

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

    /// `pre(v) = value` of a discrete unknown that gets a value of its own at the start says what was before: its start
    /// value, where that is known.
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
        // what reads the time is no start value, and nothing but the equation of `v` itself asks for it
        let time = draft.exprs.time();
        if !draft.exprs.contains(value, time) {
            draft.variables[v.index()].start = Some(value);
        }
        true
    }

    /// What an initial equation that determines nothing says beside those that determine the same.
    fn redundancy(&self, row: u32) -> InitialRedundancy {
        let own = self.rows[row as usize].equation;
        // one that has no unknowns may hold as well
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

    /// The discrete unknowns an initial equation can be solved for, if it is a discrete one.
    fn lone_columns(&self, draft: &DaeDraft, equation: &FlatEquation) -> Option<Vec<u32>> {
        let lone = [equation.lhs, equation.rhs].map(|e| discrete::lone_discrete(draft, e));
        let left_is_continuous = lone[0].is_none() && discrete::has_continuous(draft, equation.lhs);
        let found: Vec<u32> = lone.iter().flatten().filter_map(|&v| self.places.of(Unknown::Var(v))).collect();
        (!found.is_empty() && !left_is_continuous).then_some(found)
    }

    /// `x = start` for fixed continuous unknowns, states first.
    fn fixed_starts(&mut self, draft: &mut DaeDraft, model: &InitializationContext) {
        let is_state = |v: &VarId| model.states.binary_search(v).is_ok();
        let fixed = draft.with_role(SystemRole::Continuous).into_iter().filter(|v| draft.variables[v.index()].fixed);
        let (states, others): (Vec<VarId>, Vec<VarId>) = fixed.partition(is_state);
        for v in states.into_iter().chain(others) {
            let row = self.push_start(draft, v);
            if self.augment(row) {
                continue;
            }
            if model.demoted.binary_search(&v).is_ok() {
                self.check(draft, row);
            } else {
                self.report(draft, row);
            }
        }
    }

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

    /// `v = pre(v)` for discrete unknowns that no initial equation determines.
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

    /// Starts of states, best first, then of other unknowns, until everything is determined.
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

    /// Takes back chosen starts, in rows from `first` on, of what the other rows determine beyond their structure; how many.
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

    /// What the model says of its components holds for a variable that another one took the place of as state, too; but
    /// beside starts that are `fixed` it is a guess, for instance of where a loop of joints is to be found.
    fn check_said_starts(&mut self, draft: &mut DaeDraft, model: &InitializationContext) {
        for &v in model.demoted {
            let variable = &draft.variables[v.index()];
            if variable.fixed || !variable.start_is_said() || self.chosen.contains(&v) {
                continue;
            }
            let row = self.push_start(draft, v);
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

    fn is_fixed_start(&self, draft: &DaeDraft, row: u32) -> bool {
        let equation = self.rows[row as usize].equation;
        let fixed = |v: VarId| draft.variables[v.index()].fixed;
        equation.origin.kind == OriginKind::Start
            && matches!(draft.exprs.node(equation.lhs), ExprNode::Var(v) if fixed(v))
    }

    /// A row that determines nothing must hold all the same.
    fn check(&mut self, draft: &mut DaeDraft, row: u32) {
        let SystemRow { equation, index, .. } = self.rows[row as usize];
        let difference = draft.exprs.sub(equation.lhs, equation.rhs);
        self.checks.push((difference, index));
    }

    /// States, what was differentiated and what would rather be a state and has a start, before others: those with the more
    /// confident start, then those that would rather be states.
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

    /// The first contradiction is reported; later ones may follow from it.
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

    /// Keeps the matched rows.
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
        // what a component's class says of its start needs no words
        let unsaid: Vec<VarId> =
            self.chosen.iter().copied().filter(|v| !draft.variables[v.index()].confidence.is_of_component()).collect();
        if diagnostics.is_empty() && !unsaid.is_empty() {
            diagnostics.push(messages::chosen_starts(draft, &unsaid));
        }
        InitialSystem { system, chosen: self.chosen, checks: self.checks, diagnostics }
    }
}

/// Which discrete unknowns keep their value at the start, and the image of every expression there.
fn at_start(draft: &mut DaeDraft, running: &EquationSystem) -> (Vec<bool>, Vec<ExprId>) {
    let initial = draft.rewritten(|_, node| (node == ExprNode::Initial).then_some(Exprs::ONE));
    let mut keeps = vec![false; draft.variables.len()];
    for (row, &column) in running.rows.iter().zip(&running.matching.column_of) {
        if let (true, Unknown::Var(v)) = (row.discrete, running.columns[column as usize]) {
            let before = draft.exprs.pre(v);
            keeps[v.index()] = initial[row.equation.rhs.index()] == before && row.equation.lhs == draft.exprs.var(v);
        }
    }
    let before: FxHashMap<VarId, VarId> = draft.before_start.iter().copied().collect();
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
