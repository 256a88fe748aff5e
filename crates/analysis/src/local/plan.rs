//! What of a lifted system is a state, a parameter, an input, an output, and which unknowns follow from implicit
//! equations.

use crate::lift::{AugmentedState, StateAugmentedModel};
use bramah_expr::VarId;
use bramah_model::structure::{self, StateChoice};
use bramah_solve::lower::{ExecutableSystem, LoweringOptions, ResidualRowKind, lower_explicit};
use bramah_syntax::diag::{Code, Diagnostic};
use std::sync::Arc;

/// What is evaluated: n states x, m parameters theta, k inputs u, p outputs y.
#[derive(Clone, Debug)]
pub struct EvaluationPlan {
    /// The lifted system; shared by all threads.
    pub system: Arc<ExecutableSystem>,
    /// Columns of the system that are states of the model, and their variables.
    pub(super) states: Vec<(usize, VarId)>,
    /// Parameters, then inputs.
    pub(super) raised: Vec<AugmentedColumn>,
    /// How many of `raised` are parameters.
    pub(super) parameters: usize,
    /// Columns whose derivatives are the outputs.
    pub(super) outputs: Vec<usize>,
    /// Unknowns that are not explicit: algebraic columns (false) and columns whose derivative is torn (true).
    pub(super) implicit: Vec<(usize, bool)>,
    /// Per row, which implicit unknown it belongs to.
    pub(super) implicit_row: Vec<Option<usize>>,
    /// Independent quantities (states, then parameters and inputs) that implicit equations read, and for each
    /// independent quantity its place among them.
    pub(super) reached: Vec<usize>,
    pub(super) reached_place: Vec<usize>,
    /// Rows `der(x) - value`.
    pub(super) explicit: Vec<usize>,
    /// Per row, what it computes.
    pub(super) targets: Vec<LocalRowTarget>,
    /// What each entry of the system's Jacobian means.
    pub(super) roles: Vec<LocalColumnRole>,
    /// There are discrete variables: values need the event blocks.
    pub(super) discrete: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct AugmentedColumn {
    pub(super) column: usize,
    pub(super) negated: bool,
    pub(super) start: VarId,
}

/// Where a column stands among the independent and implicit quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LocalColumnRole {
    State(usize),
    Raised(usize),
    Implicit(usize),
    Nothing,
}

/// What a row computes.
#[derive(Clone, Copy, Debug)]
pub(super) enum LocalRowTarget {
    Rate(usize),
    Output(usize),
    Other,
}

impl EvaluationPlan {
    /// Analyses and lowers a lifted model.
    ///
    /// # Errors
    /// The diagnostics of the structural analysis.
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

    /// How many unknowns follow from implicit equations.
    pub fn implicit(&self) -> usize {
        self.implicit.len()
    }

    /// Names of the unknowns of implicit equations.
    pub fn implicit_names(&self) -> Vec<String> {
        let name = |&(column, torn): &(usize, bool)| {
            let variable = &self.system.dae.variables[self.system.columns[column].variable.index()].name;
            if torn { format!("der({variable})") } else { variable.clone() }
        };
        self.implicit.iter().map(name).collect()
    }

    /// How many states.
    pub fn states(&self) -> usize {
        self.states.len()
    }

    /// The states' variables.
    pub fn state_variables(&self) -> impl Iterator<Item = VarId> {
        self.states.iter().map(|s| s.1)
    }

    /// Unit of a state, as written.
    pub fn state_unit(&self, state: usize) -> Option<&str> {
        self.system.dae.variables[self.states[state].1.index()].unit.as_deref()
    }

    /// Whether the model says that a state begins at its start value.
    pub fn state_is_fixed(&self, state: usize) -> bool {
        self.system.dae.variables[self.states[state].1.index()].fixed
    }

    /// Pairs of states of which the first one's rate reads the second one directly.
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

    /// How many parameters.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// How many inputs.
    pub fn inputs(&self) -> usize {
        self.raised.len() - self.parameters
    }

    /// How many outputs.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The values of the chosen parameters as the model gives them, SI.
    pub fn parameter_values(&self) -> Vec<f64> {
        let mut values = self.system.layout.values();
        self.system.evaluate_parameters(&mut values, &[]);
        self.raised[..self.parameters].iter().map(|p| values[self.system.layout.var(p.start)]).collect()
    }
}

fn place(system: &ExecutableSystem, raised: &AugmentedState) -> Option<AugmentedColumn> {
    let (column, negated) = column(system, raised.state)?;
    Some(AugmentedColumn { column, negated, start: raised.start })
}

/// What is delayed is a state of its own at every moment of the delay: no finite number of states says it.
fn delayed(dae: &structure::Dae, delay: &structure::DelayInput) -> Diagnostic {
    let name = &dae.variables[delay.variable.index()].name;
    let text = format!("`{name}` has no finite number of states");
    let d = Diagnostic::new(Code::Unsupported, text).at(delay.origin.span, "the model is to be made linear");
    d.help("put `Signal.PadeDelay` in its place, which has as many states as its order")
}

/// A constraint lets states vary by themselves only together with a parameter.
fn bound(system: &ExecutableSystem, v: VarId) -> Diagnostic {
    let name = &system.dae.variables[v.index()].name;
    let name = name.split(" (").next().unwrap_or(name);
    Diagnostic::new(Code::IndexReduction, format!("`{name}` cannot vary by itself: a constraint binds it to states"))
        .help("keep it as it is, or join the parts by something elastic")
}

/// The column of a state that may be an alias of another; `None` where a constraint took it from the states.
fn column(system: &ExecutableSystem, v: VarId) -> Option<(usize, bool)> {
    let alias = system.dae.aliases.iter().find(|a| a.variable == v);
    let (target, negated) = alias.map_or((v, false), |a| (a.target, a.negated));
    let found = system.columns.iter().position(|c| c.is_state() && c.variable == target);
    Some((found?, negated))
}
