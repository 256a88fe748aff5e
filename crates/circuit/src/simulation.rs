//! A compiled model with the settings of a run.

use super::callback::{CallbackStatus, RowCallback};
use super::exchange::Exchange;
use super::stepping::Stepping;
use crate::compiled::{CompiledModel, compile};
use bramah_expr::VarId;
use bramah_model::compile::{Request, deep};
use bramah_model::flat::Variability;
use bramah_model::structure::StateChoice;
use bramah_model::structure::parameters::out_of_range;
use bramah_results::{Signal, Trajectory};
use bramah_solve::lower::{self, ExecutableSystem};
use bramah_solve::{
    self as solve, Control, End, Interpolation, Progress, RecordedInput, RowSink, RunResult, Settings, State,
    Statistics,
};
use bramah_syntax::diag::{Code, Diagnostic, Error, Sources};
use bramah_syntax::world::{DiskWorld, MemoryWorld, World};
use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

/// What a run gave.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The recorded variables over time.
    pub trajectory: Trajectory,
    /// How the run ended: at its stop time, or by `terminate`.
    pub end: End,
    /// Where it ended; [`Simulation::run_from`] goes on from there.
    pub state: State,
    /// The work done.
    pub statistics: Statistics,
    /// Warnings; of [`Simulation::run_kept`] also why the run did not reach its end.
    pub diagnostics: Vec<Diagnostic>,
}

impl Outcome {
    fn new(run: RunResult, trajectory: Trajectory) -> Self {
        let RunResult { end, diagnostics, statistics, state, .. } = run;
        Outcome { trajectory, end, state, statistics, diagnostics }
    }
}

/// A compiled model and the settings of its next run. Clones share the compiled code; runs of several clones may go in
/// parallel.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The compiled model. Clones share it.
    model: CompiledModel,
    /// The texts that diagnostics refer to.
    sources: Arc<Sources>,
    /// The settings of the run.
    settings: Settings,
    /// The inputs that were given, one entry for each.
    inputs: Vec<RecordedInput>,
    /// For callers who integrate the states themselves: without conserved quantities among the unknowns.
    of_states: Arc<OnceLock<ExecutableSystem>>,
    /// Remarks and warnings of the compilation.
    pub diagnostics: Vec<Diagnostic>,
}

impl Simulation {
    /// Compiles what a request names; files are read through `world`.
    ///
    /// # Errors
    /// The diagnostics of the first stage that finds something wrong.
    pub fn compile(world: &dyn World, request: &Request) -> Result<Self, Error> {
        // On a stack of its own size: names and expressions of a model may nest deeply.
        let outcome = deep(|| compile(world, request, &lower::LoweringOptions::default()));
        let sources = Arc::new(outcome.sources);
        match outcome.value {
            Some(model) => {
                let mut settings = Settings::from_experiment(&model.flat.experiment);
                settings.wanted = visible(&model);
                Ok(Simulation {
                    model,
                    sources,
                    settings,
                    inputs: Vec::new(),
                    of_states: Arc::default(),
                    diagnostics: outcome.diagnostics,
                })
            }
            None => Err(Error { diagnostics: outcome.diagnostics, sources }),
        }
    }

    /// Compiles the model of a file, or of a folder that is a package, where only one can run.
    ///
    /// # Errors
    /// As [`Simulation::compile`].
    pub fn from_file(path: impl Into<std::path::PathBuf>) -> Result<Self, Error> {
        Self::compile(&DiskWorld, &Request { source: path.into(), ..Request::default() })
    }

    /// Compiles the last model of a text; classes that ship with bramah are there by name.
    ///
    /// # Errors
    /// As [`Simulation::compile`].
    pub fn from_text(text: &str) -> Result<Self, Error> {
        let world = MemoryWorld::single("model.mo", text);
        Self::compile(&world, &Request { source: "model.mo".into(), ..Request::default() })
    }

    /// Compiles a model that ships with bramah, such as `ServoPump.DeadZone`.
    ///
    /// # Errors
    /// As [`Simulation::compile`].
    pub fn shipped(class: &str) -> Result<Self, Error> {
        Self::compile(&MemoryWorld::default(), &Request { source: class.into(), ..Request::default() })
    }

    /// The compiled model.
    pub fn model(&self) -> &CompiledModel {
        &self.model
    }

    /// The texts that places in diagnostics point into.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The settings of the next run.
    pub fn settings(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// Sets the time at which the run ends, in seconds, with 500 output intervals.
    pub fn stop_time(&mut self, seconds: f64) -> &mut Self {
        self.settings.stop_time = seconds;
        // The same number of intervals as without a stop time: 500.
        self.settings.interval = (seconds - self.settings.start_time) / 500.0;
        self
    }

    /// Changes a parameter without compiling again; the value is in the parameter's unit.
    ///
    /// # Errors
    /// `E023` if there is no such parameter, or if the structure of the model depends on it.
    /// `E215` if the value is no number, or outside `min` and `max`.
    pub fn set(&mut self, name: &str, value: f64) -> Result<&mut Self, Error> {
        let v = self.variable(name)?;
        let variable = &self.model.dae.variables[v.index()];
        match variable.variability {
            Variability::Parameter if variable.settable => {}
            Variability::Parameter => {
                let why = if variable.hidden { "protected" } else { "final" };
                let d = Diagnostic::new(Code::BadSet, format!("`{name}` is {why}, so it keeps its own value"));
                return Err(self.error(d));
            }
            Variability::Constant => {
                // Its value has determined the number of equations, or was folded into them.
                let d = Diagnostic::new(Code::BadSet, format!("the structure of the model depends on `{name}`"));
                return Err(self.error(d.help("give its value when the model is compiled")));
            }
            _ => {
                let d = Diagnostic::new(Code::BadSet, format!("`{name}` is not a parameter"));
                return Err(self.error(d.help("only parameters keep a given value during a run")));
            }
        }
        self.check_range(name, v, value)?;
        // A value that was set before is replaced.
        self.settings.parameters.retain(|(p, _)| *p != v);
        self.settings.parameters.push((v, value));
        Ok(self)
    }

    /// Limits that depend on other parameters are those of their present values.
    fn check_range(&self, name: &str, v: VarId, value: f64) -> Result<(), Error> {
        // NaN passes no comparison, so that the limits would accept it.
        if value.is_nan() {
            return Err(self.error(Diagnostic::new(Code::OutOfRange, format!("the value of `{name}` is not a number"))));
        }
        let (system, values) = (&self.model.system, self.parameter_values());
        let variable = &self.model.dae.variables[v.index()];
        let outside = out_of_range(variable, value, system.min(v, &values), system.max(v, &values));
        outside.map_or(Ok(()), |d| Err(self.error(d.help("give a value between `min` and `max`"))))
    }

    /// Values of parameters and constants in the next run, in the order of the layout.
    #[doc(hidden)]
    pub fn parameter_values(&self) -> Vec<f64> {
        let system = &self.model.system;
        let mut values = system.layout.values();
        let mut given = vec![false; self.model.dae.variables.len()];
        // Parameters that were set keep their values; those that depend on them are computed anew.
        for &(p, value) in &self.settings.parameters {
            values[system.layout.var(p)] = value;
            given[p.index()] = true;
        }
        system.evaluate_parameters(&mut values, &given);
        values
    }

    /// The value that a parameter or constant will have in the next run, in its unit; those that follow others follow
    /// values given by [`Simulation::set`], those found at the start stand at their guess. Booleans are 0 or 1,
    /// enumerations the number of their literal.
    ///
    /// # Errors
    /// `E023` when there is no such parameter.
    pub fn get(&self, name: &str) -> Result<f64, Error> {
        let v = self.variable(name)?;
        // Parameters and constants have one value; anything else changes during a run.
        if self.model.dae.variables[v.index()].variability > Variability::Parameter {
            let d = Diagnostic::new(Code::BadSet, format!("`{name}` is not a parameter"));
            return Err(self.error(d.help("its values are in the trajectory of a run")));
        }
        Ok(self.parameter_values()[self.model.system.layout.var(v)])
    }

    /// Gives a top-level input its trajectory: samples held, or joined by straight lines.
    ///
    /// # Errors
    /// `E903` when there is no such input, or when times do not grow or do not fit the values.
    pub fn input(
        &mut self,
        name: &str,
        times: &[f64],
        values: &[f64],
        between: Interpolation,
    ) -> Result<&mut Self, Error> {
        let variable = self.variable(name)?;
        let bad = |why: String| Diagnostic::new(Code::BadMap, why);
        if !self.model.dae.inputs.contains(&variable) {
            return Err(self.not_an_input(name));
        }
        // Equal times would be a jump, whose side is not defined for an input between samples.
        if times.len() != values.len() || times.is_empty() || times.windows(2).any(|w| w[1] <= w[0]) {
            return Err(self.error(bad(format!("the samples for `{name}` need growing times, one for each value"))));
        }
        // An input that was given before is replaced.
        self.inputs.retain(|i| i.variable != variable);
        let (times, values) = (Arc::from(times), Arc::from(values));
        self.inputs.push(RecordedInput { variable, times, values, interpolation: between });
        Ok(self)
    }

    /// Chooses what to record, in this order, instead of all visible variables.
    ///
    /// # Errors
    /// `E023` when there is no such variable.
    pub fn record(&mut self, names: &[&str]) -> Result<&mut Self, Error> {
        self.settings.wanted = names.iter().map(|name| self.variable(name)).collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// What a row holds: names, units and kinds of its values, in order.
    pub fn columns(&self) -> Vec<Signal> {
        solve::signals(&self.model.dae, &self.settings.wanted)
    }

    /// Runs from the initial values.
    ///
    /// # Errors
    /// `E106` when an input has no value; the diagnostics of a run that did not reach its end.
    pub fn run(&self) -> Result<Outcome, Error> {
        self.run_with(None, &mut Control::default())
    }

    /// Goes on from a saved state to the stop time.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn run_from(&self, state: &State) -> Result<Outcome, Error> {
        self.run_with(Some(state), &mut Control::default())
    }

    /// Runs under control: with a way to stop it and to watch its progress.
    ///
    /// # Errors
    /// As [`Simulation::run`]; `E507` when it was stopped, `E508` when the callback panicked.
    pub fn run_with(&self, from: Option<&State>, control: &mut Control<'_>) -> Result<Outcome, Error> {
        let mut trajectory = Trajectory::new(self.columns());
        self.may_run(from)?;
        let run = self.run_into(from, control, &mut trajectory)?;
        if !run.end.is_success() {
            return Err(self.errors(run.diagnostics));
        }
        Ok(Outcome::new(run, trajectory))
    }

    /// The same, and keeps what is there however the run ends: [`Outcome::end`] and [`Outcome::diagnostics`] say how.
    ///
    /// # Errors
    /// `E508` when the callback panicked.
    pub fn run_kept(&self, from: Option<&State>, control: &mut Control<'_>) -> Result<Outcome, Error> {
        self.may_run(from)?;
        let mut trajectory = Trajectory::new(self.columns());
        let run = self.run_into(from, control, &mut trajectory)?;
        Ok(Outcome::new(run, trajectory))
    }

    /// Runs, and hands each row to a function as it comes: the time in seconds and the values of
    /// [`Simulation::columns`]. Nothing is kept, so that memory does not grow with the run. `Break` ends the run, which
    /// then counts as fine; [`Outcome::state`] is where it stood.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// # fn main() -> Result<(), bramah::Error> {
    /// let mut fall = bramah::Simulation::from_text(
    ///     "model Fall Real h(start = 20, fixed = true); Real v(start = 0, fixed = true);
    ///      equation der(h) = v; der(v) = -9.81; end Fall;",
    /// )?;
    /// let end = fall.record(&["h"])?.stop_time(10.0).run_rows(None, |_, row| {
    ///     if row[0] < 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    /// })?;
    /// assert!((end.state.time - (40.0_f64 / 9.81).sqrt()).abs() < 0.05);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::run`]; `E508` when the function panicked, which leaves the simulation as it was.
    pub fn run_rows(
        &self,
        from: Option<&State>,
        mut on_row: impl FnMut(f64, &[f64]) -> ControlFlow<()> + Send,
    ) -> Result<Outcome, Error> {
        let mut rows = RowCallback { on_row: &mut on_row, conduct: CallbackStatus::default() };
        self.may_run(from)?;
        let run = self.run_into(from, &mut Control::default(), &mut rows)?;
        if let Some(complaint) = rows.conduct.complaint(run.time) {
            return Err(self.error(complaint));
        }
        // A stop that the callback requested is a regular end.
        if !(run.end.is_success() || run.end == End::Interrupted && rows.conduct.stopped) {
            return Err(self.errors(run.diagnostics));
        }
        Ok(Outcome::new(run, Trajectory::new(Vec::new())))
    }

    /// A run to be taken from step to step from outside, from the initial values.
    ///
    /// # Errors
    /// When there are no consistent initial values.
    pub fn stepping(&self) -> Result<Stepping<'_>, Error> {
        Stepping::new(self, None)
    }

    /// The same from a saved state.
    ///
    /// # Errors
    /// When the state does not fit the model.
    pub fn stepping_from(&self, state: &State) -> Result<Stepping<'_>, Error> {
        Stepping::new(self, Some(state))
    }

    /// The model for a caller that integrates it, from the initial values.
    ///
    /// # Errors
    /// `E017` where the model needs its own integrator; when there are no consistent initial values.
    pub fn exchange(&self) -> Result<Exchange<'_>, Error> {
        Exchange::new(self)
    }

    /// The model with nothing but its states to integrate.
    pub(super) fn system_of_states(&self) -> &ExecutableSystem {
        let system = &self.model.system;
        // The system of the model then integrates nothing but its states.
        if system.integrals.is_empty() {
            return system;
        }
        let options = lower::LoweringOptions { conserve: false, ..lower::LoweringOptions::default() };
        self.of_states.get_or_init(|| lower::lower(system.dae.clone(), &options))
    }

    /// Why the model cannot be integrated by others; `None` where it can.
    pub fn keeps_its_integrator(&self) -> Option<&'static str> {
        solve::driver::exchange::refuses(&self.model.system)
    }

    /// The continuous states, in the order of [`Exchange::states`].
    pub fn states(&self) -> Vec<Signal> {
        let columns = self.model.system.columns.iter().filter(|c| c.is_state());
        solve::signals(&self.model.dae, &columns.map(|c| c.variable).collect::<Vec<_>>())
    }

    /// How many functions watch for events, see [`Exchange::indicators`].
    pub fn indicators(&self) -> usize {
        solve::driver::exchange::indicators(&self.model.system)
    }

    /// Every input has a value: one given, its own, or that of the state from which the run goes on.
    fn may_run(&self, from: Option<&State>) -> Result<(), Error> {
        // A state contains the values of all inputs.
        if from.is_some() {
            return Ok(());
        }
        let help = |_: &str| vec!["give it values over time, or a start value in the model".to_owned()];
        let diagnostics = solve::missing_inputs(&self.model.dae, &self.inputs, help);
        if diagnostics.is_empty() { Ok(()) } else { Err(self.errors(diagnostics)) }
    }

    /// Runs from the start or from a state, with rows into a sink. Internal: [`Simulation::run`] is the way in.
    ///
    /// # Errors
    /// A callback that panicked.
    #[doc(hidden)]
    pub fn run_into(
        &self,
        from: Option<&State>,
        control: &mut Control<'_>,
        sink: &mut dyn RowSink,
    ) -> Result<RunResult, Error> {
        let mut conduct = CallbackStatus::default();
        // If the chosen states become singular during the run, the model is analysed again with other states.
        let mut reselect = |choice: &StateChoice| self.model.with_states(choice);
        let mut watched = control.progress.as_mut().map(|report| {
            let conduct = &mut conduct;
            move |now: &Progress| conduct.call(|| report(now))
        });
        let progress = watched.as_mut().map(|report| report as &mut (dyn FnMut(&Progress) -> bool + Send));
        let mut control = Control { interrupt: control.interrupt, progress, reselect: Some(&mut reselect) };
        let run = solve::simulate(&self.model.system, &self.settings, &self.inputs, from, sink, &mut control);
        // The error of a callback takes precedence over the end that it has caused.
        match conduct.complaint(run.time) {
            Some(complaint) => Err(self.error(complaint)),
            None => Ok(run),
        }
    }

    /// The settings of the next run.
    #[doc(hidden)]
    pub fn run_settings(&self) -> &Settings {
        &self.settings
    }

    /// The inputs that have values over time.
    #[doc(hidden)]
    pub fn given_inputs(&self) -> &[RecordedInput] {
        &self.inputs
    }

    pub(super) fn not_an_input(&self, name: &str) -> Error {
        self.error(Diagnostic::new(Code::BadMap, format!("`{name}` is not an input of the model")))
    }

    /// Messages with the texts they point into.
    #[doc(hidden)]
    pub fn errors(&self, diagnostics: Vec<Diagnostic>) -> Error {
        Error { diagnostics, sources: self.sources.clone() }
    }

    /// The variable of a name.
    ///
    /// # Errors
    /// `E023`, with the nearest name.
    #[doc(hidden)]
    pub fn variable(&self, name: &str) -> Result<VarId, Error> {
        let variables = &self.model.flat.variables;
        if let Some(i) = variables.iter().position(|v| v.name == name) {
            return Ok(VarId(u32::try_from(i).expect("fewer than 2^32 variables")));
        }
        let mut d = Diagnostic::new(Code::BadSet, format!("the model has no variable `{name}`"));
        if let Some(near) = bramah_syntax::diag::nearest(name, variables.iter().map(|v| v.name.as_str())) {
            d = d.help(format!("did you mean `{near}`?"));
        }
        Err(self.error(d))
    }

    fn error(&self, diagnostic: Diagnostic) -> Error {
        self.errors(vec![diagnostic])
    }
}

/// Variables that results show.
fn visible(model: &CompiledModel) -> Vec<VarId> {
    let all = (0u32..).zip(&model.flat.variables).map(|(i, _)| VarId(i));
    all.filter(|v| model.dae.is_shown(*v)).collect()
}
