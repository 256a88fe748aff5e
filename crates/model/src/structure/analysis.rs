//! The steps of structural analysis in their order.
//!
//! [`analyze`] is the entry of `structure`. [`run`] does one pass over all steps; [`settled`] repeats it as long as
//! parameters of value 0 turn out to decide about the structure. Each step works on one [`DaeDraft`]; the order of
//! steps matters, and comments in [`run`] say why. All faults of a model are diagnostics: `Err` ends the analysis at
//! once, a diagnostic in the list lets it go on.

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::incidence::{IncidenceScanner, NONE};
use super::matching::{Matching, maximum};
use super::pantelides::IndexReduction;
use super::parameters::SignAnalysis;
use super::solve_block::BlockSolver;
use super::sorting::{EquationSystem, SystemRow, UnknownColumns};
use super::{
    Alias, BltBlock, ConservedQuantity, Dae, EventActionKind, ExplicitAssignment, StateChoice, StateSelection, Unknown,
    alias, assertions, cancelling, closed_groups, conserved, constants, delays, dependence, discrete,
    dummy_derivatives, duplicates, events, held, initial, messages, parameters, regularity, start_derivatives, zeros,
};
use crate::flat::{ElementOrigin, FlatEquation, FlatModel, OriginKind, StateSelect};
use bramah_expr::{ExprNode, VarId};
use bramah_syntax::diag::{Diagnostic, StageResult};

/// Sorts a flat model into a [`Dae`].
///
/// Errors: circles of parameters (E214), their ranges (E215) and assertions about them (E503), singular structure
/// (E301, E302, E303), constraints that cannot be differentiated (E304), start values that contradict each other
/// (E401). A note lists start values that were chosen. The result has no value if any diagnostic is an error.
pub fn analyze(flat: &FlatModel, choice: &StateChoice) -> StageResult<Dae> {
    let mut diagnostics = Vec::new();
    match settled(flat, choice, &mut diagnostics) {
        Ok(dae) if !diagnostics.iter().any(Diagnostic::is_error) => StageResult::new(dae, diagnostics),
        Ok(_) => StageResult::failed(diagnostics),
        Err(error) => {
            diagnostics.push(error);
            StageResult::failed(diagnostics)
        }
    }
}

/// Repeats the analysis until no further parameter of value 0 decides about the structure.
///
/// Each pass drops the products that the parameters found so far make 0. With `FlatModel::varied` there is one pass
/// only, because parameters must stay free to change. On failure of a later pass the result of the pass before stays.
/// The loop ends because the list of parameters only grows.
fn settled(flat: &FlatModel, choice: &StateChoice, diagnostics: &mut Vec<Diagnostic>) -> Result<Dae, Diagnostic> {
    let (mut last, mut decisive) = run(flat, choice, &[], diagnostics)?;
    let mut known = 0;
    while decisive.len() > known && !flat.varied {
        known = decisive.len();
        let mut said = Vec::new();
        // A singular reduced model is not reported; the result for the equations as written stays.
        let Ok((dae, further)) = run(flat, choice, &decisive, &mut said) else { break };
        if said.iter().any(Diagnostic::is_error) {
            break;
        }
        (last, *diagnostics) = (dae, said);
        decisive.extend(further);
        decisive.sort_unstable();
        decisive.dedup();
    }
    Ok(last)
}

/// One pass over all steps.
///
/// Products that are 0 by the parameters in `decisive` are dropped first. Returns, beside the result, the parameters
/// whose value 0 decides about the structure; the caller may repeat the pass with them. Diagnostics that do not end the
/// analysis go to `diagnostics`. `Err` is a fault that ends it.
///
/// The draft is made anew in each pass, so that nothing of an earlier pass remains in it.
fn run(
    flat: &FlatModel,
    choice: &StateChoice,
    decisive: &[VarId],
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(Dae, Vec<VarId>), Diagnostic> {
    let mut draft = DaeDraft::new(flat);
    let order = parameters::order(&mut draft)?;
    let values = parameters::values(&draft, &order);
    diagnostics.extend(parameters::check(&draft, &order, &values));
    // Before aliases: conditions and modes are variables and may be aliases of others.
    make_discrete_equations(&mut draft);
    prefer_reinitialized(&mut draft);
    let mut known = SignAnalysis::new(&draft, values.clone());
    // With a value out of range, an assertion that fails would be a consequence of it.
    if !diagnostics.iter().any(Diagnostic::is_error) {
        diagnostics.extend(assertions::check(&draft, &mut known));
    }
    zeros::take_out(&mut draft, &mut known, decisive);
    // Zeros first: without the product, `R*i = v1 - v2` is an alias equation.
    let aliases = alias::eliminate(&mut draft, &mut known, diagnostics);
    cancelling::replace(&mut draft, &mut known);
    // After alias elimination, which may replace the side that is a lone discrete variable.
    discrete::classify(&mut draft);
    discrete::absorb_initial_pres(&mut draft);
    refuse_input_derivatives(&draft)?;
    // Before index reduction, which needs a structurally regular system to terminate.
    regularity::check(&draft).map_err(|found| explain_singular(flat, &draft, &aliases, &found))?;
    if let Some(flows) = closed_groups::find(&draft, &aliases) {
        return Err(messages::closed_group(&draft, &aliases, &flows));
    }

    // Before the search for dependence, which treats factors that are known to be constant as numbers.
    constants::read(&mut draft);
    let mut reduction = dependence::expose(&mut draft, &mut known, !flat.varied)?;
    reduction.reduce(&mut draft)?;
    diagnostics.extend(held::find(&draft, &reduction, &aliases));
    let chosen = dummy_derivatives::select(&mut draft, &reduction, &values, choice);
    let states = settle_states(&mut draft, &mut reduction, &chosen.dummies);
    diagnostics.extend(reinit_of_no_state(&draft, &states.states));
    // Only now: index reduction needs `Der` and its link to recognise chains of derivatives.
    replace_linked_derivatives(&mut draft);
    let running = running_system(&draft, &reduction, &states)?;

    let mut blocks = SystemBlocks::sort_running(&mut draft, &mut known, &running, &states.states);
    // Before `initial::assemble` appends initial conditions to the equations, which are no balances.
    let mut conserved = conserved::find(&mut draft, &mut known, &states.states);
    let with_derivatives = start_derivatives::add(&mut draft, &running, &states.states)?;
    let at_start = with_derivatives.as_ref().unwrap_or(&running);
    let model = initial::InitializationContext { running: at_start, states: &states.states, demoted: &states.demoted };
    let start = initial::assemble(&mut draft, &mut known, &model);
    diagnostics.extend(start.diagnostics);
    // On the systems before tearing; a matching without the zero products shows whether the structure needs them.
    let further = zeros::decisive(&mut draft, &mut known, [&running, &start.system]);
    blocks.sort_initial(&mut draft, &mut known, &start.system);
    let stated = conserved.iter_mut().flat_map(|c| [&mut c.quantity, &mut c.rate]);
    // After sorting, on the continuous system only: see `duplicates`.
    duplicates::share(&mut draft.exprs, &mut blocks.continuous, stated);
    let StatePartition { states, demoted, .. } = states;
    let rest = AnalysisFindings { order, aliases, states, demoted, selections: chosen.selections, conserved };
    let mut dae = assemble(flat, draft, blocks, rest);
    dae.chosen_starts = start.chosen;
    dae.initial_checks.extend(start.checks);
    Ok((dae, further))
}

/// Turns `delay`, event-generating expressions and `when` clauses into variables, equations and actions.
/// The original nodes and clauses are gone afterwards.
fn make_discrete_equations(draft: &mut DaeDraft) {
    // `delay` first: its stand-in is an input, and relations that read it have to be watched.
    delays::extract(draft);
    events::extract(draft);
    discrete::translate_whens(draft);
}

/// The message for a singular system.
///
/// It is made from the equations as the user wrote them, before alias elimination, if these are singular too; else from
/// the reduced ones. For this the flat model is translated anew, without the steps between.
/// The aliases of the reduced system are needed to name its quantities.
fn explain_singular(
    flat: &FlatModel,
    reduced: &DaeDraft,
    aliases: &[Alias],
    found: &regularity::StructuralSingularity,
) -> Diagnostic {
    let mut whole = DaeDraft::new(flat);
    make_discrete_equations(&mut whole);
    discrete::classify(&mut whole);
    match regularity::check(&whole) {
        Err(found) => messages::singular(&whole, &[], &found),
        Ok(()) => messages::singular(reduced, aliases, found),
    }
}

/// Raises `stateSelect` of what `reinit` sets to `prefer`, since only a state can be set.
/// It runs before alias elimination, so that the wish passes to the representative.
fn prefer_reinitialized(draft: &mut DaeDraft) {
    for action in &draft.actions {
        if let EventActionKind::Reinit(v, _) = action.kind {
            let select = &mut draft.variables[v.index()].state_select;
            *select = (*select).max(StateSelect::Prefer);
        }
    }
}

/// An error where an equation contains the derivative of an input: the trajectory of an input is known by its values
/// only. Only the first such equation is reported.
fn refuse_input_derivatives(draft: &DaeDraft) -> Result<(), Diagnostic> {
    let mut walk = bramah_expr::visit::NodeTraversal::default();
    for equation in draft.equations.iter().chain(&draft.initial_equations) {
        let mut found = None;
        walk.each(&draft.exprs, &[equation.lhs, equation.rhs], |_, node| {
            if let ExprNode::Der(v) = node
                && draft.role(v) == SystemRole::Input
            {
                found = found.or(Some(v));
            }
            true
        });
        if let Some(v) = found {
            return Err(messages::not_differentiable(draft, equation, v));
        }
    }
    Ok(())
}

/// An error (E305) for each `reinit` of a variable that is not among the states. `states` is ascending.
fn reinit_of_no_state(draft: &DaeDraft, states: &[VarId]) -> Vec<Diagnostic> {
    let reinits = draft.actions.iter().filter_map(|action| match action.kind {
        EventActionKind::Reinit(v, _) if states.binary_search(&v).is_err() => {
            Some(messages::reinit_of_no_state(draft, v, action.origin))
        }
        _ => None,
    });
    reinits.collect()
}

/// The outcome of state selection.
/// A variable is in one of the two lists if its derivative occurs.
struct StatePartition {
    /// Ascending.
    states: Vec<VarId>,
    /// Differentiated, but not states; ascending.
    demoted: Vec<VarId>,
    /// By column of the index reduction: whether its variable is integrated, so that the continuous system takes it as
    /// known.
    is_state: Vec<bool>,
}

/// Makes every variable with a derivative that is no dummy a state, and every dummy derivative an algebraic variable.
/// `dummies` are columns of the reduction.
fn settle_states(draft: &mut DaeDraft, reduction: &mut IndexReduction, dummies: &[u32]) -> StatePartition {
    let mut is_dummy = vec![false; reduction.columns.len()];
    for &c in dummies {
        is_dummy[c as usize] = true;
        // A dummy derivative is an algebraic unknown and needs a variable of its own.
        reduction.materialize(draft, c);
    }
    let mut found =
        StatePartition { states: Vec::new(), demoted: Vec::new(), is_state: vec![false; reduction.columns.len()] };
    for c in 0..reduction.columns.len() {
        // Only columns that are variables and have a derivative column can be integrated.
        let (derivative, variable) = (reduction.columns[c].derivative, reduction.variable(c as u32));
        let (Some(v), true) = (variable, derivative != NONE) else { continue };
        if is_dummy[derivative as usize] {
            found.demoted.push(v);
        } else {
            found.is_state[c] = true;
            found.states.push(v);
        }
    }
    found.states.sort_unstable();
    found.demoted.sort_unstable();
    found
}

/// Replaces `Der(x)` by the variable that is the derivative of `x`. Afterwards `Der` stands only for derivatives of
/// states that are no variables themselves.
fn replace_linked_derivatives(draft: &mut DaeDraft) {
    let links = draft.derivative.clone();
    if links.iter().all(Option::is_none) {
        return;
    }
    let map = draft.rewritten(|pool, node| match node {
        ExprNode::Der(v) => links[v.index()].map(|w| w.expression(pool)),
        _ => None,
    });
    draft.map_expressions(&map);
}

/// The equations that hold during the run, matched with their unknowns.
///
/// Rows and columns come in the same order: continuous ones first, then discrete ones. States, inputs and parameters
/// are known and have no column. `Err` where no perfect matching exists.
fn running_system(
    draft: &DaeDraft,
    reduction: &IndexReduction,
    states: &StatePartition,
) -> Result<EquationSystem, Diagnostic> {
    let mut system = EquationSystem::default();
    let solved = reduction.columns.iter().zip(&states.is_state).filter(|(_, is_state)| !**is_state);
    system.columns.extend(solved.map(|(column, _)| column.unknown));
    let continuous_columns = system.columns.len() as u32;
    system.columns.extend(draft.with_role(SystemRole::Discrete).into_iter().map(Unknown::Var));
    let columns = UnknownColumns::new(&system.columns, draft.variables.len());
    let column = |node: ExprNode| columns.of_node(node);
    let mut scanner = IncidenceScanner::default();
    for continuous in [true, false] {
        for (i, (&equation, &kind)) in draft.equations.iter().zip(&draft.kinds).enumerate() {
            if (kind == EquationRole::Continuous) != continuous {
                continue;
            }
            let sides = [equation.lhs, equation.rhs];
            if continuous {
                scanner.push(&draft.exprs, sides, column, |c| c < continuous_columns, &mut system.incidence);
            } else {
                // A discrete equation is an assignment: it can be solved only for a variable that is one of its sides.
                let lone = discrete::lone_unknowns(draft, &equation, kind);
                let lone: Vec<u32> = lone.iter().filter_map(|&v| columns.of(Unknown::Var(v))).collect();
                scanner.push_discrete(&draft.exprs, sides, &lone, column, &mut system.incidence);
            }
            system.rows.push(SystemRow { equation, index: i as u32, discrete: !continuous });
        }
    }
    system.matching = maximum(&system.incidence, system.columns.len());
    check_matched(draft, &system)?;
    Ok(system)
}

/// An error where the matching is not perfect.
///
/// The regularity check has made sure that the counts fit, so what is left are constraints and derivatives that depend
/// on each other. The message names the overdetermined equations and the underdetermined unknowns.
fn check_matched(draft: &DaeDraft, system: &EquationSystem) -> Result<(), Diagnostic> {
    let Matching { column_of, row_of } = &system.matching;
    if column_of.iter().chain(row_of).all(|&p| p != NONE) {
        return Ok(());
    }
    let parts = super::dulmage_mendelsohn::decompose(&system.incidence, &system.matching);
    let equations: Vec<FlatEquation> = parts.over.rows.iter().map(|&r| system.rows[r as usize].equation).collect();
    let unknowns: Vec<Unknown> = parts.under.columns.iter().map(|&c| system.columns[c as usize]).collect();
    Err(messages::dependent_constraints(draft, &equations, &unknowns))
}

/// The three sorted systems, as lists of blocks.
/// All three end with the assignments in `derivatives`.
#[derive(Default)]
struct SystemBlocks {
    /// The system between events.
    continuous: Vec<BltBlock>,
    /// The system at events.
    event: Vec<BltBlock>,
    /// The system at the start.
    initial: Vec<BltBlock>,
    /// `der(x) := w` of states whose derivative is a variable.
    derivatives: Vec<BltBlock>,
}

impl SystemBlocks {
    /// Sorts the continuous and the event system. The continuous blocks are made once; the event system contains them
    /// with the discrete equations in between.
    fn sort_running(
        draft: &mut DaeDraft,
        known: &mut SignAnalysis,
        system: &EquationSystem,
        states: &[VarId],
    ) -> SystemBlocks {
        let mut made = SystemBlocks { derivatives: linked_derivatives(draft, states), ..SystemBlocks::default() };
        let mut solver = BlockSolver::new(draft, known);
        let (components, blocks) = system.continuous_blocks(&mut solver);
        made.event = system.with_discrete(&mut solver, &components, &blocks);
        made.continuous = blocks;
        // At the end: no equation reads `der(x)` any more, only the integrator does.
        made.event.extend_from_slice(&made.derivatives);
        made.continuous.extend_from_slice(&made.derivatives);
        made
    }

    /// Sorts the initial system. It has its own continuous blocks, since its rows and unknowns differ.
    fn sort_initial(&mut self, draft: &mut DaeDraft, known: &mut SignAnalysis, system: &EquationSystem) {
        let mut solver = BlockSolver::new(draft, known);
        let (components, blocks) = system.continuous_blocks(&mut solver);
        self.initial = system.with_discrete(&mut solver, &components, &blocks);
        self.initial.extend_from_slice(&self.derivatives);
    }
}

/// Assignments `der(x) := w` for states whose derivative is a variable `w`, with an equation for each for messages.
/// The blocks come in the order of the states.
fn linked_derivatives(draft: &mut DaeDraft, states: &[VarId]) -> Vec<BltBlock> {
    let mut blocks = Vec::new();
    for &x in states {
        let Some(w) = draft.derivative[x.index()] else { continue };
        let lhs = draft.exprs.der(x);
        let rhs = w.expression(&mut draft.exprs);
        let origin = ElementOrigin { kind: OriginKind::Made, ..draft.variables[w.variable.index()].origin };
        draft.add_equation(FlatEquation { lhs, rhs, origin }, EquationRole::Definition);
        let equation = draft.equations.len() as u32 - 1;
        blocks.push(BltBlock::Assign(ExplicitAssignment { unknown: Unknown::Der(x), value: rhs, equation }));
    }
    blocks
}

/// The parts of a `Dae` that the steps found beside the blocks.
struct AnalysisFindings {
    /// Parameters in order of evaluation.
    order: Vec<VarId>,
    /// Eliminated variables.
    aliases: Vec<Alias>,
    /// Integrated variables, ascending.
    states: Vec<VarId>,
    /// Differentiated variables that are no states, ascending.
    demoted: Vec<VarId>,
    /// Groups with a choice of states.
    selections: Vec<StateSelection>,
    /// Quantities that may replace states in the integration.
    conserved: Vec<ConservedQuantity>,
}

/// Puts the [`Dae`] together. Initial checks become residuals, each with an equation for messages.
///
/// `Dae::chosen_starts` and further initial checks are added by the caller.
fn assemble(flat: &FlatModel, mut draft: DaeDraft, blocks: SystemBlocks, rest: AnalysisFindings) -> Dae {
    let mut initial_checks = Vec::new();
    for equation in std::mem::take(&mut draft.initial_checks) {
        let residual = draft.exprs.sub(equation.lhs, equation.rhs);
        draft.add_equation(equation, EquationRole::Definition);
        initial_checks.push((residual, draft.equations.len() as u32 - 1));
    }
    Dae {
        class: flat.class.clone(),
        instances: flat.instances.clone(),
        enumerations: flat.enumerations.clone(),
        experiment: flat.experiment,
        parameters: rest.order,
        free_parameters: draft.with_role(SystemRole::FreeParameter),
        inputs: (0..flat.variables.len() as u32).map(VarId).filter(|v| flat.variables[v.index()].input).collect(),
        aliases: rest.aliases,
        states: rest.states,
        differentiated: rest.demoted,
        discrete: draft.with_role(SystemRole::Discrete),
        continuous: blocks.continuous,
        event: blocks.event,
        initial: blocks.initial,
        selections: rest.selections,
        conserved: rest.conserved,
        chosen_starts: Vec::new(),
        initial_checks,
        crossings: draft.crossings,
        samples: draft.samples,
        delays: draft.delays,
        actions: draft.actions,
        asserts: draft.asserts,
        exprs: draft.exprs,
        variables: draft.variables,
        equations: draft.equations,
    }
}
