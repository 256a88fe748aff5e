//! A model as x' = f(x, theta, u), y = g(x, theta, u) at one point: values, and exact derivatives by the system's own
//! Jacobian. Algebraic unknowns are eliminated by the implicit function theorem.

use super::lift::{Lifted, Raised};
use crate::diag::{Code, Diagnostic};
use crate::expr::VarId;
use crate::lower::{Options, RowKind, System, lower_explicit};
use crate::solve::Point;
use crate::structure::{self, StateChoice};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// What is evaluated: n states x, m parameters theta, k inputs u, p outputs y.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The lifted system; shared by all threads.
    pub system: Arc<System>,
    /// Columns of the system that are states of the model, and their variables.
    states: Vec<(usize, VarId)>,
    /// Parameters, then inputs.
    raised: Vec<Place>,
    /// How many of `raised` are parameters.
    parameters: usize,
    /// Columns whose derivatives are the outputs.
    outputs: Vec<usize>,
    /// Unknowns that are not explicit: algebraic columns (false) and columns whose derivative is torn (true).
    implicit: Vec<(usize, bool)>,
    /// Per row, which implicit unknown it belongs to.
    implicit_row: Vec<Option<usize>>,
    /// Independent quantities (states, then parameters and inputs) that implicit equations read, and for each
    /// independent quantity its place among them.
    reached: Vec<usize>,
    reached_place: Vec<usize>,
    /// Rows `der(x) - value`.
    explicit: Vec<usize>,
    /// Per row, what it computes.
    targets: Vec<Target>,
    /// What each entry of the system's Jacobian means.
    roles: Vec<Role>,
    /// There are discrete variables: values need the event blocks.
    discrete: bool,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    column: usize,
    negated: bool,
    start: VarId,
}

/// Where a column stands among the independent and implicit quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    State(usize),
    Raised(usize),
    Implicit(usize),
    Nothing,
}

/// Why there is no value.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LocalError {
    /// The equations have no solution there.
    #[error("{}", .0.message)]
    NoSolution(Box<Diagnostic>),
    /// A value or derivative is not finite.
    #[error("a value is not finite")]
    NonFinite,
    /// The algebraic part does not determine its unknowns.
    #[error("the equations are singular")]
    Singular,
}

impl From<Box<Diagnostic>> for LocalError {
    fn from(d: Box<Diagnostic>) -> Self {
        LocalError::NoSolution(d)
    }
}

impl Plan {
    /// Analyses and lowers a lifted model.
    ///
    /// # Errors
    /// The diagnostics of the structural analysis.
    pub fn new(lifted: &Lifted) -> Result<Plan, Vec<Diagnostic>> {
        let checked = structure::analyze(&lifted.flat, &StateChoice::default());
        let Some(dae) = checked.value else { return Err(checked.diagnostics) };
        if let Some(delay) = dae.delays.first() {
            return Err(vec![delayed(&dae, delay)]);
        }
        let system = Arc::new(lower_explicit(Arc::new(dae), &Options::default()));
        let place = |r: &Raised| place(&system, r).ok_or_else(|| vec![bound(&system, r.start)]);
        let raised = lifted.parameters.iter().chain(&lifted.inputs).map(place).collect::<Result<_, _>>()?;
        let output = |v: &VarId| column(&system, *v).ok_or_else(|| vec![bound(&system, *v)]);
        let outputs = lifted.outputs.iter().map(|v| Ok(output(v)?.0)).collect::<Result<_, Vec<Diagnostic>>>()?;
        Ok(Plan::of(system.clone(), lifted, raised, outputs))
    }

    fn of(system: Arc<System>, lifted: &Lifted, raised: Vec<Place>, outputs: Vec<usize>) -> Plan {
        let mut roles = vec![Role::Nothing; system.columns.len()];
        raised.iter().enumerate().for_each(|(i, p)| roles[p.column] = Role::Raised(i));
        let mut states = Vec::new();
        let mut implicit = Vec::new();
        for (j, c) in system.columns.iter().enumerate() {
            if c.state && roles[j] == Role::Nothing && !outputs.contains(&j) {
                roles[j] = Role::State(states.len());
                states.push((j, c.variable));
            }
            if system.rows[j].kind != RowKind::Derivative {
                if !c.state {
                    roles[j] = Role::Implicit(implicit.len());
                }
                implicit.push((j, c.state));
            }
        }
        let discrete = !system.dae.discrete.is_empty();
        let parameters = lifted.parameters.len();
        let mut implicit_row = vec![None; system.columns.len()];
        implicit.iter().enumerate().for_each(|(i, &(row, _))| implicit_row[row] = Some(i));
        let target = |row: usize| match roles[row] {
            _ if system.rows[row].kind != RowKind::Derivative => Target::Other,
            Role::State(i) => Target::Rate(i),
            _ => outputs.iter().position(|&o| o == row).map_or(Target::Other, Target::Output),
        };
        let targets = (0..system.columns.len()).map(target).collect();
        let is_explicit = |j: &usize| system.rows[*j].kind == RowKind::Derivative;
        let explicit = (0..system.rows.len()).filter(is_explicit).collect();
        let count = states.len();
        let reads = |column: usize| {
            let rows = &system.pattern.rowidx[system.pattern.colptr[column]..system.pattern.colptr[column + 1]];
            rows.iter().any(|&row| implicit_row[row].is_some())
        };
        let independent = |(column, role): (usize, &Role)| match role {
            Role::State(j) if reads(column) => Some(*j),
            Role::Raised(j) if reads(column) => Some(count + j),
            _ => None,
        };
        let reached: Vec<usize> = roles.iter().enumerate().filter_map(independent).collect();
        let mut reached_place = vec![usize::MAX; count + raised.len()];
        reached.iter().enumerate().for_each(|(place, &j)| reached_place[j] = place);
        Plan {
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
                (Target::Rate(i), Role::State(j)) => Some((i, j)),
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

fn place(system: &System, raised: &Raised) -> Option<Place> {
    let (column, negated) = column(system, raised.state)?;
    Some(Place { column, negated, start: raised.start })
}

/// What is delayed is a state of its own at every moment of the delay: no finite number of states says it.
fn delayed(dae: &structure::Dae, delay: &structure::Delay) -> Diagnostic {
    let name = &dae.variables[delay.variable.index()].name;
    let text = format!("`{name}` has no finite number of states");
    let d = Diagnostic::new(Code::Unsupported, text).at(delay.origin.span, "the model is to be made linear");
    d.help("put `Signal.PadeDelay` in its place, which has as many states as its order")
}

/// A constraint lets states vary by themselves only together with a parameter.
fn bound(system: &System, v: VarId) -> Diagnostic {
    let name = &system.dae.variables[v.index()].name;
    let name = name.split(" (").next().unwrap_or(name);
    Diagnostic::new(Code::IndexReduction, format!("`{name}` cannot vary by itself: a constraint binds it to states"))
        .help("keep it as it is, or join the parts by something elastic")
}

/// The column of a state that may be an alias of another; `None` where a constraint took it from the states.
fn column(system: &System, v: VarId) -> Option<(usize, bool)> {
    let alias = system.dae.aliases.iter().find(|a| a.variable == v);
    let (target, negated) = alias.map_or((v, false), |a| (a.target, a.negated));
    let found = system.columns.iter().position(|c| c.state && c.variable == target);
    Some((found?, negated))
}

/// Derivatives at a point. Columns of `b` and `d`: parameters, then inputs.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// d x' / d x, n by n.
    pub a: DMatrix<f64>,
    /// d x' / d (theta, u), n by m + k.
    pub b: DMatrix<f64>,
    /// d y / d x, p by n.
    pub c: DMatrix<f64>,
    /// d y / d (theta, u), p by m + k.
    pub d: DMatrix<f64>,
}

impl Linearization {
    /// An entry by its row (rates, then outputs) and column (states, then parameters and inputs).
    fn get(&self, row: usize, column: usize) -> f64 {
        let n = self.a.nrows();
        match (row < n, column < n) {
            (true, true) => self.a[(row, column)],
            (true, false) => self.b[(row, column - n)],
            (false, true) => self.c[(row - n, column)],
            (false, false) => self.d[(row - n, column - n)],
        }
    }

    fn set(&mut self, row: usize, column: usize, value: f64) {
        let n = self.a.nrows();
        match (row < n, column < n) {
            (true, true) => self.a[(row, column)] = value,
            (true, false) => self.b[(row, column - n)] = value,
            (false, true) => self.c[(row - n, column)] = value,
            (false, false) => self.d[(row - n, column - n)] = value,
        }
    }
}

/// A model that is evaluated point by point; one for each thread.
#[derive(Debug)]
pub struct Local {
    plan: Arc<Plan>,
    point: Point,
    y: Vec<f64>,
    yp: Vec<f64>,
    residual: Vec<f64>,
    entries: Vec<f64>,
    torn_entries: Vec<f64>,
    /// Implicit unknowns of the last solution.
    implicit: Vec<f64>,
    /// Some rate or output reads the rate of another state (`f = d*der(s)`).
    reads_rates: bool,
    /// Entries of `linear` (row, column) that went through implicit unknowns.
    through_unknowns: Vec<(usize, usize)>,
    /// x' at the last point.
    pub rates: Vec<f64>,
    /// y at the last point.
    pub outputs: Vec<f64>,
    /// Derivatives at the last point.
    pub linear: Linearization,
}

impl Local {
    /// At the start of the model, with these parameters and inputs.
    ///
    /// # Errors
    /// When the initial system has no solution.
    pub fn start(plan: Arc<Plan>, time: f64, theta: &[f64], u: &[f64]) -> Result<Self, LocalError> {
        let given = plan.raised.iter().zip(theta.iter().chain(u)).map(|(p, v)| (p.start, *v)).collect();
        let point = Point::start(plan.system.clone(), time, given)?;
        let (n, p, r) = (plan.states.len(), plan.outputs.len(), plan.raised.len());
        let columns = plan.system.columns.len();
        let entries = plan.system.pattern.nnz();
        let linear = Linearization {
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, r),
            c: DMatrix::zeros(p, n),
            d: DMatrix::zeros(p, r),
        };
        let mut local = Local {
            point,
            y: vec![0.0; columns],
            yp: vec![0.0; columns],
            residual: vec![0.0; columns],
            entries: vec![0.0; entries],
            torn_entries: vec![0.0; entries],
            implicit: vec![0.0; plan.implicit.len()],
            reads_rates: false,
            through_unknowns: Vec::new(),
            rates: vec![0.0; n],
            outputs: vec![0.0; p],
            linear,
            plan,
        };
        local.reads_rates = local.looks_for_read_rates(time);
        Ok(local)
    }

    /// Whether explicit rows change with the rates put into them; there is no value at the start where this cannot be told.
    fn looks_for_read_rates(&mut self, time: f64) -> bool {
        let Local { plan, point, y, yp, residual, .. } = self;
        let system = &plan.system;
        for (j, c) in system.columns.iter().enumerate() {
            y[j] = point.values[system.layout.var(c.variable)];
            yp[j] = 0.0;
        }
        let mut rates = |probe: f64| {
            let tried: Vec<f64> = (0..yp.len()).map(|j| probe * (1.0 + 0.37 * j as f64)).collect();
            plan.explicit.iter().for_each(|&j| yp[j] = tried[j]);
            let known = system.residual(time, y, yp, &mut point.values, residual).is_ok();
            known.then(|| plan.explicit.iter().map(|&j| tried[j] - residual[j]).collect::<Vec<f64>>())
        };
        let (Some(without), Some(with)) = (rates(0.0), rates(1.0)) else { return true };
        without.iter().zip(&with).any(|(a, b)| (a - b).abs() > PROBED * (1.0 + a.abs()))
    }

    /// What is evaluated.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// Takes over a state of the model itself, as a run left it: discrete values too. Evaluate afterwards.
    pub fn adopt(&mut self, state: &crate::solve::State) {
        state.restore(&self.plan.system, &mut self.point.values);
    }

    /// The states at the last point.
    pub fn state(&self) -> Vec<f64> {
        let layout = &self.plan.system.layout;
        self.plan.states.iter().map(|&(_, v)| self.point.values[layout.var(v)]).collect()
    }

    /// The usual size of each state, positive.
    pub fn nominals(&self) -> Vec<f64> {
        self.plan.states.iter().map(|&(_, v)| self.point.nominal(v)).collect()
    }

    /// The value of any variable at the last point.
    pub fn value(&self, v: VarId) -> f64 {
        self.point.values[self.plan.system.layout.var(v)]
    }

    /// Values of x' and y.
    ///
    /// # Errors
    /// [`LocalError`]; the values are then meaningless.
    pub fn evaluate(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let result = self.values(time, x, theta, u);
        self.remember(result.is_ok());
        result
    }

    fn values(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let Local { plan, point, y, yp, residual, entries, torn_entries, reads_rates, .. } = self;
        let system = &plan.system;
        for (&(column, _), &value) in plan.states.iter().zip(x) {
            y[column] = value;
        }
        for (place, &value) in plan.raised.iter().zip(theta.iter().chain(u)) {
            y[place.column] = if place.negated { -value } else { value };
        }
        if plan.discrete || !plan.newton(time, y, yp, residual, entries, torn_entries, &mut point.values)? {
            for (j, c) in system.columns.iter().enumerate().filter(|(_, c)| c.state) {
                point.values[system.layout.var(c.variable)] = y[j];
            }
            point.settle(time)?;
            for (j, c) in system.columns.iter().enumerate() {
                y[j] = point.values[system.layout.var(c.variable)];
                yp[j] = if c.state { point.values[system.layout.der(c.variable).expect("a state")] } else { 0.0 };
            }
        }
        if *reads_rates && !plan.discrete {
            plan.settle_rates(time, y, yp, residual, &mut point.values)?;
        }
        for (rate, &(column, _)) in self.rates.iter_mut().zip(&plan.states) {
            *rate = yp[column];
        }
        for (output, &column) in self.outputs.iter_mut().zip(&plan.outputs) {
            *output = yp[column];
        }
        let finite = self.rates.iter().chain(&self.outputs).all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(LocalError::NonFinite) }
    }

    /// Remembers the implicit unknowns where there is a solution; where there is none, the next search begins there.
    fn remember(&mut self, found: bool) {
        for (kept, &(column, torn)) in self.implicit.iter_mut().zip(&self.plan.implicit) {
            let unknown = if torn { &mut self.yp[column] } else { &mut self.y[column] };
            if found {
                *kept = *unknown;
            } else {
                *unknown = *kept;
            }
        }
    }

    /// Values and derivatives.
    ///
    /// # Errors
    /// [`LocalError`]; values and derivatives are then meaningless.
    pub fn linearize(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        self.evaluate(time, x, theta, u)?;
        let Local { plan, point, y, yp, entries, torn_entries, .. } = self;
        let system = &plan.system;
        system.jacobian(time, 0.0, y, yp, &mut point.values, entries).map_err(|_| LocalError::NonFinite)?;
        let torn = plan.implicit.iter().any(|i| i.1);
        if torn || self.reads_rates {
            system.jacobian(time, 1.0, y, yp, &mut point.values, torn_entries).map_err(|_| LocalError::NonFinite)?;
        }
        self.scatter();
        if !self.plan.implicit.is_empty() {
            self.eliminate(torn)?;
        }
        if self.reads_rates { self.through_rates() } else { Ok(()) }
    }

    /// Adds what goes through the rates that others read: r = g(x, r) has d r/d x = (1 - d g/d r)^-1 d g/d x.
    fn through_rates(&mut self) -> Result<(), LocalError> {
        let Local { plan, entries, torn_entries, linear, through_unknowns, .. } = self;
        let (n, p) = (plan.states.len(), plan.outputs.len());
        let mut read = DMatrix::zeros(n + p, n);
        let pattern = &plan.system.pattern;
        for (column, role) in plan.roles.iter().enumerate() {
            let Role::State(j) = *role else { continue };
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                match plan.targets[pattern.rowidx[k]] {
                    Target::Rate(i) if i != j => read[(i, j)] = entries[k] - torn_entries[k],
                    Target::Output(i) => read[(n + i, j)] = entries[k] - torn_entries[k],
                    _ => {}
                }
            }
        }
        let own = DMatrix::identity(n, n) - read.rows(0, n);
        let own = own.lu();
        linear.a = own.solve(&linear.a).ok_or(LocalError::Singular)?;
        linear.b = own.solve(&linear.b).ok_or(LocalError::Singular)?;
        linear.c += read.rows(n, p) * &linear.a;
        linear.d += read.rows(n, p) * &linear.b;
        // the next point begins with nothing of this one
        let width = n + linear.b.ncols();
        through_unknowns.clear();
        through_unknowns.extend((0..n + p).flat_map(|row| (0..width).map(move |column| (row, column))));
        Ok(())
    }

    /// The explicit part: minus the entries of rows `der(x) - value`. What is not among them is 0 already, but for what
    /// went through implicit unknowns the last time.
    fn scatter(&mut self) {
        let Local { plan, entries, linear, through_unknowns, .. } = self;
        through_unknowns.drain(..).for_each(|(row, column)| linear.set(row, column, 0.0));
        let pattern = &plan.system.pattern;
        let n = plan.states.len();
        for (column, role) in plan.roles.iter().enumerate() {
            let (column_at, sign) = match *role {
                Role::State(j) => (j, -1.0),
                Role::Raised(j) if plan.raised[j].negated => (n + j, 1.0),
                Role::Raised(j) => (n + j, -1.0),
                _ => continue,
            };
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                match plan.targets[pattern.rowidx[k]] {
                    Target::Rate(i) => linear.set(i, column_at, sign * entries[k]),
                    Target::Output(i) => linear.set(n + i, column_at, sign * entries[k]),
                    Target::Other => {}
                }
            }
        }
    }

    /// Adds what goes through the implicit unknowns.
    fn eliminate(&mut self, torn: bool) -> Result<(), LocalError> {
        let Local { plan, entries, torn_entries, linear, through_unknowns, .. } = self;
        let (n, p, q) = (plan.states.len(), plan.outputs.len(), plan.implicit.len());
        let rows = &plan.implicit_row;
        let mut unknown = DMatrix::zeros(q, q);
        let mut known = DMatrix::zeros(q, plan.reached.len());
        // how rates and outputs depend on the unknowns
        let mut through = DMatrix::zeros(n + p, q);
        let pattern = &plan.system.pattern;
        let mut implicit_of = vec![None; plan.system.columns.len()];
        plan.implicit.iter().enumerate().filter(|(_, i)| i.1).for_each(|(i, &(c, _))| implicit_of[c] = Some(i));
        for column in 0..plan.roles.len() {
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                let row = pattern.rowidx[k];
                let value = entries[k];
                let target = match plan.targets[row] {
                    Target::Rate(i) => Some(i),
                    Target::Output(i) => Some(n + i),
                    Target::Other => None,
                };
                match (rows[row], plan.roles[column]) {
                    (Some(i), Role::State(j)) => known[(i, plan.reached_place[j])] = value,
                    (Some(i), Role::Raised(j)) => {
                        known[(i, plan.reached_place[n + j])] = if plan.raised[j].negated { -value } else { value };
                    }
                    (Some(i), Role::Implicit(j)) => unknown[(i, j)] = value,
                    (None, Role::Implicit(j)) => {
                        if let Some(t) = target {
                            through[(t, j)] = -value;
                        }
                    }
                    _ => {}
                }
                if torn && let Some(j) = implicit_of[column] {
                    let value = torn_entries[k] - entries[k];
                    match (rows[row], target) {
                        (Some(i), _) => unknown[(i, j)] += value,
                        // the rate of a state that is not torn, read by another row
                        (None, Some(t)) => through[(t, j)] -= value,
                        (None, None) => {}
                    }
                }
            }
        }
        let solution = unknown.lu().solve(&known).ok_or(LocalError::Singular)?;
        let mut finite = entries.iter().all(|v| v.is_finite());
        for t in (0..n + p).filter(|&t| through.row(t).iter().any(|v| *v != 0.0)) {
            for (place, &j) in plan.reached.iter().enumerate() {
                let sum: f64 = (0..q).map(|k| through[(t, k)] * solution[(k, place)]).sum();
                finite &= sum.is_finite();
                linear.set(t, j, linear.get(t, j) - sum);
                through_unknowns.push((t, j));
            }
        }
        for (i, &(column, torn)) in plan.implicit.iter().enumerate() {
            if torn && let Role::State(k) = plan.roles[column] {
                for (place, &j) in plan.reached.iter().enumerate() {
                    finite &= solution[(i, place)].is_finite();
                    linear.set(k, j, -solution[(i, place)]);
                    through_unknowns.push((k, j));
                }
            }
        }
        if finite { Ok(()) } else { Err(LocalError::NonFinite) }
    }

    /// x' as a vector.
    pub fn rate_vector(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.rates)
    }
}

/// Iterations of Newton's method on the implicit unknowns.
const NEWTON: usize = 12;
/// A rate that reads others changes by more than this part of it when they do.
const PROBED: f64 = 1e-9;
/// Residuals and corrections are rounding below this part of what they began with.
const CONVERGED: f64 = 1e-11;

impl Plan {
    /// Solves for the implicit unknowns from their last values, and for all rates; false where that does not converge.
    fn newton(
        &self,
        time: f64,
        y: &mut [f64],
        yp: &mut [f64],
        residual: &mut [f64],
        entries: &mut [f64],
        torn_entries: &mut [f64],
        values: &mut [f64],
    ) -> Result<bool, LocalError> {
        let system = &self.system;
        let mut first = 0.0;
        // a rate is what is left of its row at rate 0: from another rate, far larger, only its rounding would be left
        self.explicit.iter().for_each(|&j| yp[j] = 0.0);
        for iteration in 0..NEWTON {
            if system.residual(time, y, yp, values, residual).is_err() {
                return if self.implicit.is_empty() { Err(LocalError::NonFinite) } else { Ok(false) };
            }
            for &j in &self.explicit {
                yp[j] -= residual[j];
            }
            let size = self.implicit.iter().map(|i| residual[i.0].abs()).fold(0.0, f64::max);
            // residuals at the level of rounding: of the first ones, or of the unknowns' own contributions
            if self.implicit.is_empty() || size == 0.0 || iteration > 0 && size <= CONVERGED * first {
                return Ok(true);
            }
            if iteration == 0 {
                first = size;
            }
            let Ok(change) = self.correction(time, y, yp, residual, entries, torn_entries, values) else {
                return Ok(false);
            };
            let mut moved = 0.0_f64;
            for (&(column, torn), d) in self.implicit.iter().zip(change.iter()) {
                let unknown = if torn { &mut yp[column] } else { &mut y[column] };
                *unknown -= d;
                moved = moved.max(d.abs() / (unknown.abs() + f64::MIN_POSITIVE));
            }
            if moved < CONVERGED {
                // the residual can shrink no further: it is rounding
                if system.residual(time, y, yp, values, residual).is_err() {
                    return Ok(false);
                }
                for &j in &self.explicit {
                    yp[j] -= residual[j];
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Rates that read other rates, which follow from each other one after the other.
    fn settle_rates(
        &self,
        time: f64,
        y: &[f64],
        yp: &mut [f64],
        residual: &mut [f64],
        values: &mut [f64],
    ) -> Result<(), LocalError> {
        for _ in 0..self.explicit.len() {
            self.system.residual(time, y, yp, values, residual).map_err(|_| LocalError::NonFinite)?;
            let settled = self.explicit.iter().all(|&j| residual[j].abs() <= CONVERGED * yp[j].abs());
            self.explicit.iter().for_each(|&j| yp[j] -= residual[j]);
            if settled {
                break;
            }
        }
        Ok(())
    }

    fn correction(
        &self,
        time: f64,
        y: &[f64],
        yp: &[f64],
        residual: &[f64],
        entries: &mut [f64],
        torn_entries: &mut [f64],
        values: &mut [f64],
    ) -> Result<DVector<f64>, LocalError> {
        let system = &self.system;
        let torn = self.implicit.iter().any(|i| i.1);
        system.jacobian(time, 0.0, y, yp, values, entries).map_err(|_| LocalError::NonFinite)?;
        if torn {
            system.jacobian(time, 1.0, y, yp, values, torn_entries).map_err(|_| LocalError::NonFinite)?;
        }
        let q = self.implicit.len();
        let mut matrix = DMatrix::zeros(q, q);
        let pattern = &system.pattern;
        for (j, &(column, torn)) in self.implicit.iter().enumerate() {
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                if let Some(i) = self.implicit_row[pattern.rowidx[k]] {
                    matrix[(i, j)] = if torn { torn_entries[k] - entries[k] } else { entries[k] };
                }
            }
        }
        let right = DVector::from_fn(q, |i, _| residual[self.implicit[i].0]);
        matrix.lu().solve(&right).ok_or(LocalError::Singular)
    }
}

/// What a row computes.
#[derive(Clone, Copy, Debug)]
enum Target {
    Rate(usize),
    Output(usize),
    Other,
}

#[cfg(test)]
mod tests;
