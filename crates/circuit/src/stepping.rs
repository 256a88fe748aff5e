//! Co-simulation: a run that the caller takes from step to step, setting inputs and reading variables in between.

use super::simulation::Simulation;
use bramah_solve::driver::{self, Driver, EarlyStop};
use bramah_solve::{End, State, Statistics};
use bramah_syntax::diag::{Code, Diagnostic, Error};

/// An input of a run, looked up once. Of use only with the [`Simulation`] that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputPort(pub(super) usize);

/// A variable of a run, looked up once. Of use only with the [`Simulation`] that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe(pub(super) usize);

/// A run under way, from [`Simulation::stepping`].
///
/// Between two steps the integrator keeps its past: where inputs change little it goes on as if nothing had happened,
/// where they jump it starts afresh. Events inside a step are located as in any run.
///
/// ```
/// # fn main() -> Result<(), bramah::Error> {
/// let text = "model Lag input Real u; Real y(start = 0, fixed = true); equation der(y) = u - y; end Lag;";
/// let lag = bramah::Simulation::from_text(text)?;
/// let mut run = lag.stepping()?;
/// let (u, y) = (run.input("u")?, run.probe("y")?);
/// for _ in 0..1000 {
///     // a controller at 1 kHz: proportional, gain 9, set point 1
///     run.set(u, 9.0 * (1.0 - run.get(y)));
///     run.step(1e-3)?;
/// }
/// assert!((run.get(y) - 0.9).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
///
/// What was looked up in one model is not taken for a number or a name:
/// ```compile_fail
/// # fn main() -> Result<(), bramah::Error> {
/// let lag = bramah::Simulation::from_text("model Lag input Real u; equation end Lag;")?;
/// lag.stepping()?.set("u", 1.0);
/// # Ok(())
/// # }
/// ```
///
/// The model stays as it is while a run is under way:
/// ```compile_fail
/// # fn main() -> Result<(), bramah::Error> {
/// let mut lag = bramah::Simulation::from_text("model Lag parameter Real T = 1; equation end Lag;")?;
/// let mut run = lag.stepping()?;
/// lag.set("T", 2.0)?;
/// run.step(1e-3)?;
/// # Ok(())
/// # }
/// ```
pub struct Stepping<'a> {
    /// The compiled model and its settings.
    simulation: &'a Simulation,
    /// The run.
    driver: Driver<'a, 'a>,
    /// Inputs that were set since the last step: slot and new value.
    changes: Vec<(usize, f64)>,
    /// The message of the model, once it has ended the run.
    terminated: Option<String>,
}

impl Simulation {
    /// A top-level input of a run.
    pub(super) fn input_port(&self, name: &str) -> Result<InputPort, Error> {
        let model = self.model();
        let v = self.variable(name)?;
        if model.dae.inputs.contains(&v) {
            return Ok(InputPort(model.system.layout.var(v)));
        }
        Err(self.not_an_input(name))
    }

    /// A variable of a run.
    pub(super) fn probe_of(&self, name: &str) -> Result<Probe, Error> {
        Ok(Probe(self.model().system.layout.var(self.variable(name)?)))
    }

    /// The rate of a state of a run.
    ///
    /// # Errors
    /// `E023` when the model has no such variable, or its rate appears nowhere.
    pub fn rate_probe(&self, name: &str) -> Result<Probe, Error> {
        let v = self.variable(name)?;
        let found = self.model().system.layout.der(v).map(Probe);
        found.ok_or_else(|| self.errors(vec![Diagnostic::new(Code::BadSet, format!("`{name}` has no rate"))]))
    }
}

impl<'a> Stepping<'a> {
    pub(super) fn new(simulation: &'a Simulation, from: Option<&State>) -> Result<Self, Error> {
        let (system, settings) = (&simulation.model().system, simulation.run_settings());
        // Values are assigned by position, which is only right for a state of the same model.
        if let Some(state) = from.filter(|s| !s.fits(system)) {
            let text = format!("the state of another model cannot be taken: it has {} variables", state.names.len());
            return Err(simulation.errors(vec![Diagnostic::new(Code::BadArgument, text)]));
        }
        let driver = driver::start(system, settings, simulation.given_inputs(), from);
        let mut driver = driver.map_err(|stop| simulation.errors(stop.diagnostics))?;
        driver.observe();
        Ok(Stepping { simulation, driver, changes: Vec::new(), terminated: None })
    }

    /// Where the run stands, in seconds.
    pub fn time(&self) -> f64 {
        self.driver.time()
    }

    /// Looks up a top-level input.
    ///
    /// # Errors
    /// `E903` when the model has no such input.
    pub fn input(&self, name: &str) -> Result<InputPort, Error> {
        self.simulation.input_port(name)
    }

    /// Looks up a variable to read.
    ///
    /// # Errors
    /// `E023` when the model has no such variable.
    pub fn probe(&self, name: &str) -> Result<Probe, Error> {
        self.simulation.probe_of(name)
    }

    /// Sets an input, in its unit, from here on.
    pub fn set(&mut self, input: InputPort, value: f64) {
        // Of several values for one input the last one counts.
        self.changes.retain(|(slot, _)| *slot != input.0);
        self.changes.push((input.0, value));
    }

    /// The value of a variable where the run stands, in its unit.
    pub fn get(&self, probe: Probe) -> f64 {
        self.driver.value(probe.0)
    }

    /// Goes on by so many seconds.
    ///
    /// # Errors
    /// The diagnostics of a run that cannot go on. After `terminate` nothing moves, see [`Stepping::terminated`].
    pub fn step(&mut self, seconds: f64) -> Result<(), Error> {
        self.step_to(self.time() + seconds)
    }

    /// Goes on to this time, in seconds; an earlier one is an error.
    ///
    /// # Errors
    /// As [`Stepping::step`]; `E901` for a time that lies behind or is not finite.
    pub fn step_to(&mut self, time: f64) -> Result<(), Error> {
        // After `terminate` the time stands still and steps have no effect.
        if self.terminated.is_some() {
            return Ok(());
        }
        if !time.is_finite() || time < self.time() {
            let text = format!("a step from {} s to {time} s", self.time());
            return Err(self.simulation.errors(vec![Diagnostic::new(Code::BadArgument, text)]));
        }
        // Taken out for the call and put back, so that the list keeps its memory.
        let changes = std::mem::take(&mut self.changes);
        let moved = self.driver.advance(&changes, time);
        self.changes = changes;
        self.changes.clear();
        match moved {
            Ok(()) => Ok(()),
            // The model has ended the run itself, which is no error.
            Err(EarlyStop { end: End::Terminated(message), .. }) => {
                self.terminated = Some(message);
                Ok(())
            }
            Err(stop) => Err(self.simulation.errors(stop.diagnostics)),
        }
    }

    /// The message of `terminate`, once the model has called it.
    pub fn terminated(&self) -> Option<&str> {
        self.terminated.as_deref()
    }

    /// Everything needed to go on from here, with [`Simulation::run_from`] or [`Simulation::stepping_from`].
    pub fn state(&mut self) -> State {
        self.driver.state()
    }

    /// Work done so far; its seconds are zero, for only the caller knows what counts.
    pub fn statistics(&mut self) -> Statistics {
        self.driver.statistics()
    }

    /// Warnings since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        self.driver.warnings()
    }
}
