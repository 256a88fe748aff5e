//! Model exchange: a compiled model whose integrator is the caller's.

use super::{InputPort, Probe, Simulation};
use bramah_solve::driver::exchange::{self, ExchangeEventResult};
use bramah_syntax::diag::{Code, Diagnostic, Error};

/// A model that gives derivatives and takes states, from [`Simulation::exchange`].
///
/// ```
/// # fn main() -> Result<(), bramah::Error> {
/// let text = "model Decay Real x(start = 1, fixed = true); equation der(x) = -x; end Decay;";
/// let decay = bramah::Simulation::from_text(text)?;
/// let mut model = decay.exchange()?;
/// // explicit Euler
/// for k in 1..=1000 {
///     let x = model.states()[0] + 1e-3 * model.derivatives()?[0];
///     model.set_time(1e-3 * f64::from(k));
///     model.set_states(&[x]);
/// }
/// assert!((model.states()[0] - f64::exp(-1.0)).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
pub struct Exchange<'a> {
    simulation: &'a Simulation,
    inner: exchange::ExchangeDriver<'a>,
}

impl<'a> Exchange<'a> {
    pub(super) fn new(simulation: &'a Simulation) -> Result<Self, Error> {
        // The caller integrates the states of the model, not quantities that are conserved in their place.
        let system = simulation.system_of_states();
        // Some models cannot leave the integration to others; the reason comes from the solver.
        if let Some(why) = exchange::refuses(system) {
            let d = Diagnostic::new(Code::Unsupported, format!("the model cannot be integrated by others: {why}"));
            return Err(simulation.errors(vec![d]));
        }
        let inner = exchange::ExchangeDriver::new(system, simulation.run_settings(), simulation.given_inputs());
        Ok(Exchange { simulation, inner: inner.map_err(|stop| simulation.errors(stop.diagnostics))? })
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

    /// Where time stands, in seconds.
    pub fn time(&self) -> f64 {
        self.inner.time()
    }

    /// Says where time stands, in seconds.
    pub fn set_time(&mut self, time: f64) {
        self.inner.set_time(time);
    }

    /// Sets an input, in its unit.
    pub fn set(&mut self, input: InputPort, value: f64) {
        self.inner.set(input.0, value);
    }

    /// Sets the states, as many as [`Exchange::states`] gives, in its order.
    pub fn set_states(&mut self, x: &[f64]) {
        self.inner.set_states(x);
    }

    /// The states.
    pub fn states(&self) -> Vec<f64> {
        self.inner.states()
    }

    /// Their usual sizes.
    pub fn nominals(&self) -> Vec<f64> {
        self.inner.nominals()
    }

    /// Their derivatives.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn derivatives(&mut self) -> Result<Vec<f64>, Error> {
        self.inner.derivatives().map_err(|stop| self.simulation.errors(stop.diagnostics))
    }

    /// The functions whose change of sign is an event, never zero behind one.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn indicators(&mut self) -> Result<&[f64], Error> {
        self.inner.indicators().map_err(|stop| self.simulation.errors(stop.diagnostics))
    }

    /// How many there are.
    pub fn indicator_count(&self) -> usize {
        self.inner.indicator_count()
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn get(&mut self, probe: Probe) -> Result<f64, Error> {
        self.inner.value(probe.0).map_err(|stop| self.simulation.errors(stop.diagnostics))
    }

    /// Does what is due: where indicators have changed their sign since the last event, where a known time is reached,
    /// and where inputs have changed.
    ///
    /// # Errors
    /// As a run that ends there.
    pub fn event(&mut self) -> Result<ExchangeEventResult, Error> {
        self.inner.event().map_err(|stop| self.simulation.errors(stop.diagnostics))
    }

    /// Warnings since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        self.inner.warnings()
    }
}
