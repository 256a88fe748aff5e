//! The structure of a lifted system: which of its columns are states, parameters, inputs and outputs, and which
//! unknowns follow from implicit equations.
//!
//! A [`StateAugmentedModel`] enters; an [`EvaluationPlan`] leaves, which evaluators in all threads share. Explicit rows
//! have the form `der(x) - value`; all others are implicit.

use crate::lift::{AugmentedState, StateAugmentedModel};
use bramah_expr::VarId;
use bramah_model::structure::{self, StateChoice};
use bramah_solve::lower::{ExecutableSystem, LoweringOptions, ResidualRowKind, lower_explicit};
use bramah_syntax::diag::{Code, Diagnostic};
use std::sync::Arc;

/// The equations of n states x, m parameters theta, k inputs u and p outputs y, ready for evaluation.
#[derive(Clone, Debug)]
pub struct EvaluationPlan {
    /// The lifted system, compiled.
    pub system: Arc<ExecutableSystem>,
    /// The column and the variable of each state of the model.
    pub(super) states: Vec<(usize, VarId)>,
    /// The columns of parameters, then of inputs.
    pub(super) raised: Vec<AugmentedColumn>,
    /// How many of `raised` are parameters.
    pub(super) parameters: usize,
    /// Columns whose derivatives are the outputs.
    pub(super) outputs: Vec<usize>,
    /// Implicit unknowns: algebraic columns (false), and columns whose rate is the unknown (true).
    pub(super) implicit: Vec<(usize, bool)>,
    /// For each row the implicit unknown that it determines; `None` for explicit rows.
    pub(super) implicit_row: Vec<Option<usize>>,
    /// Independent quantities (states, then parameters and inputs) that implicit equations read.
    pub(super) reached: Vec<usize>,
    /// For each independent quantity its place in `reached`; `usize::MAX` where it is not there.
    pub(super) reached_place: Vec<usize>,
    /// Explicit rows.
    pub(super) explicit: Vec<usize>,
    /// What each row computes.
    pub(super) targets: Vec<LocalRowTarget>,
    /// What each column is.
    pub(super) roles: Vec<LocalColumnRole>,
    /// Whether there are discrete variables, whose values need the equations at events.
    pub(super) discrete: bool,
}

/// A parameter or input that became a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct AugmentedColumn {
    /// Its column in the system.
    pub(super) column: usize,
    /// Whether the column is an alias with the opposite sign.
    pub(super) negated: bool,
    /// The parameter that holds its value at the start.
    pub(super) start: VarId,
}

/// What a column of the system is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LocalColumnRole {
    /// The state with this index.
    State(usize),
    /// The parameter or input with this index.
    Raised(usize),
    /// The algebraic unknown with this index.
    Implicit(usize),
    /// None of these, as the integral of an output.
    Nothing,
}

/// What a row of the system computes.
#[derive(Clone, Copy, Debug)]
pub(super) enum LocalRowTarget {
    /// The rate of the state with this index.
    Rate(usize),
    /// The output with this index.
    Output(usize),
    /// Neither, as an implicit equation.
    Other,
}

impl EvaluationPlan {
    /// Analyses and compiles a lifted model.
    ///
    /// # Errors
    /// The diagnostics of the structural analysis; [`Code::Unsupported`] for a delay; [`Code::IndexReduction`] where a
    /// constraint binds a lifted quantity to states.
    pub fn new(lifted: &StateAugmentedModel) -> Result<EvaluationPlan, Vec<Diagnostic>> {
        let checked = structure::analyze(&lifted.flat, &StateChoice::default());
        let Some(dae) = checked.value else { return Err(checked.diagnostics) };
        if let Some(delay) = dae.delays.first() {
            return Err(vec![delayed(&dae, delay)]);
        }
        let system = Arc::new(lower_explicit(Arc::new(dae), &LoweringOptions::default()));
        let place = |r: &AugmentedState| place(&system, r).ok_or_else(|| vec![bound(&system, r.start)]);
        let raised = lifted.parameters.iter().chain(&lifted.inputs).map(place).collect::<Result<_, _>>()?;
        let output = |v: &VarId| column(&system, *v).ok_or_else(|| vec![bound(&system, *v)]);
        let outputs = lifted.outputs.iter().map(|v| Ok(output(v)?.0)).collect::<Result<_, Vec<Diagnostic>>>()?;
        Ok(EvaluationPlan::of(system.clone(), lifted, raised, outputs))
    }

    /// Sorts columns and rows by what they are.
    fn of(
        system: Arc<ExecutableSystem>,
        lifted: &StateAugmentedModel,
        raised: Vec<AugmentedColumn>,
        outputs: Vec<usize>,
    ) -> EvaluationPlan {
        let mut roles = vec![LocalColumnRole::Nothing; system.columns.len()];
        raised.iter().enumerate().for_each(|(i, p)| roles[p.column] = LocalColumnRole::Raised(i));
        let mut states = Vec::new();
        let mut implicit = Vec::new();
        for (j, c) in system.columns.iter().enumerate() {
            if c.is_state() && roles[j] == LocalColumnRole::Nothing && !outputs.contains(&j) {
                roles[j] = LocalColumnRole::State(states.len());
                states.push((j, c.variable));
            }
            if system.rows[j].kind != ResidualRowKind::Derivative {
                if !c.is_state() {
                    roles[j] = LocalColumnRole::Implicit(implicit.len());
                }
                implicit.push((j, c.is_state()));
            }
        }
        let discrete = !system.dae.discrete.is_empty();
        let parameters = lifted.parameters.len();
        let mut implicit_row = vec![None; system.columns.len()];
        implicit.iter().enumerate().for_each(|(i, &(row, _))| implicit_row[row] = Some(i));
        let target = |row: usize| match roles[row] {
            _ if system.rows[row].kind != ResidualRowKind::Derivative => LocalRowTarget::Other,
            LocalColumnRole::State(i) => LocalRowTarget::Rate(i),
            _ => outputs.iter().position(|&o| o == row).map_or(LocalRowTarget::Other, LocalRowTarget::Output),
        };
        let targets = (0..system.columns.len()).map(target).collect();
        let is_explicit = |j: &usize| system.rows[*j].kind == ResidualRowKind::Derivative;
        let explicit = (0..system.rows.len()).filter(is_explicit).collect();
        let count = states.len();
        let reads = |column: usize| {
            let rows = &system.pattern.rowidx[system.pattern.colptr[column]..system.pattern.colptr[column + 1]];
            rows.iter().any(|&row| implicit_row[row].is_some())
        };
        let independent = |(column, role): (usize, &LocalColumnRole)| match role {
            LocalColumnRole::State(j) if reads(column) => Some(*j),
            LocalColumnRole::Raised(j) if reads(column) => Some(count + j),
            _ => None,
        };
        let reached: Vec<usize> = roles.iter().enumerate().filter_map(independent).collect();
        let mut reached_place = vec![usize::MAX; count + raised.len()];
        reached.iter().enumerate().for_each(|(place, &j)| reached_place[j] = place);
        EvaluationPlan {
            implicit_row,
            reached,
            reached_place,
            explicit,
            targets,
            system,
            states,
            raised,
            parameters,
            outputs,
            implicit,
            roles,
            discrete,
        }
    }

    /// Number of implicit unknowns.
    pub fn implicit(&self) -> usize {
        self.implicit.len()
    }

    /// Names of the implicit unknowns.
    pub fn implicit_names(&self) -> Vec<String> {
        let name = |&(column, torn): &(usize, bool)| {
            let variable = &self.system.dae.variables[self.system.columns[column].variable.index()].name;
            if torn { format!("der({variable})") } else { variable.clone() }
        };
        self.implicit.iter().map(name).collect()
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.states.len()
    }

    /// The variables of the states.
    pub fn state_variables(&self) -> impl Iterator<Item = VarId> {
        self.states.iter().map(|s| s.1)
    }

    /// Unit of a state, as written.
    pub fn state_unit(&self, state: usize) -> Option<&str> {
        self.system.dae.variables[self.states[state].1.index()].unit.as_deref()
    }

    /// Whether a state starts at its start value (`fixed = true`).
    pub fn state_is_fixed(&self, state: usize) -> bool {
        self.system.dae.variables[self.states[state].1.index()].fixed
    }

    /// Pairs (i, j) of states where the rate of i reads j directly.
    pub fn couplings(&self) -> impl Iterator<Item = (usize, usize)> {
        let pattern = &self.system.pattern;
        self.roles.iter().enumerate().flat_map(move |(column, role)| {
            let rows = &pattern.rowidx[pattern.colptr[column]..pattern.colptr[column + 1]];
            rows.iter().filter_map(move |&row| match (self.targets[row], *role) {
                (LocalRowTarget::Rate(i), LocalColumnRole::State(j)) => Some((i, j)),
                _ => None,
            })
        })
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.raised.len() - self.parameters
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The values of the parameters as the model gives them, in SI units.
    pub fn parameter_values(&self) -> Vec<f64> {
        let mut values = self.system.layout.values();
        self.system.evaluate_parameters(&mut values, &[]);
        self.raised[..self.parameters].iter().map(|p| values[self.system.layout.var(p.start)]).collect()
    }
}

/// The column of a lifted quantity; `None` where a constraint took it from the states.
fn place(system: &ExecutableSystem, raised: &AugmentedState) -> Option<AugmentedColumn> {
    let (column, negated) = column(system, raised.state)?;
    Some(AugmentedColumn { column, negated, start: raised.start })
}

/// The error for a delay, whose memory is no finite number of states.
fn delayed(dae: &structure::Dae, delay: &structure::DelayInput) -> Diagnostic {
    let name = &dae.variables[delay.variable.index()].name;
    let text = format!("`{name}` has no finite number of states");
    let d = Diagnostic::new(Code::Unsupported, text).at(delay.origin.span, "the model is to be made linear");
    d.help("put `Signal.PadeDelay` in its place, which has as many states as its order")
}

/// The error for a quantity that a constraint binds to states, so that it cannot vary alone.
fn bound(system: &ExecutableSystem, v: VarId) -> Diagnostic {
    let name = &system.dae.variables[v.index()].name;
    let name = name.split(" (").next().unwrap_or(name);
    Diagnostic::new(Code::IndexReduction, format!("`{name}` cannot vary by itself: a constraint binds it to states"))
        .help("keep it as it is, or join the parts by something elastic")
}

/// The column of a state, and whether it is an alias with the opposite sign. `None` where a constraint took it from the
/// states.
fn column(system: &ExecutableSystem, v: VarId) -> Option<(usize, bool)> {
    let alias = system.dae.aliases.iter().find(|a| a.variable == v);
    let (target, negated) = alias.map_or((v, false), |a| (a.target, a.negated));
    let found = system.columns.iter().position(|c| c.is_state() && c.variable == target);
    Some((found?, negated))
}
