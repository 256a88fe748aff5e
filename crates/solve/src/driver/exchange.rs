//! A model that the caller integrates, as FMI model exchange does.
//!
//! The caller sets time, states and inputs of an [`ExchangeDriver`] and reads derivatives and event indicators. Between
//! events the modes stay as they are. At an event the caller calls [`ExchangeDriver::event`], which runs the same event
//! iteration as any other run. Algebraic unknowns are solved at every evaluation.

use super::{Driver, EarlyStop, EventCause, prepare, stop_at_start};
use crate::algebraic::AlgebraicSolver;
use crate::ida::DaeEquations;
use crate::lower::{ExecutableSystem, ValueLayout};
use crate::model::IntegrationModel;
use crate::modes::{RootFunctions, same_time};
use crate::report;
use crate::settings::End;
use crate::{RecordedInput, Settings};
use bramah_syntax::diag::{Code, Diagnostic};

/// What the caller must know after an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExchangeEventResult {
    /// Whether states have new values, set by `reinit`.
    pub states_changed: bool,
    /// The next event of known time in seconds; `None` when there is none.
    pub next: Option<f64>,
    /// The message of `terminate`; `None` when the model did not end the run.
    pub terminated: Option<String>,
}

/// A model at a time, with the discrete state of the last event.
pub struct ExchangeDriver<'a> {
    /// Events, modes and clocks; it has no integrator.
    driver: Driver<'a, 'a>,
    /// The equations and the slots of all values.
    model: IntegrationModel<'a>,
    /// Solves derivatives and algebraic unknowns from states.
    solver: AlgebraicSolver,
    /// Unknowns, one per column of the system. The states among them are set by the caller.
    y: Vec<f64>,
    /// Derivatives, one per column.
    yp: Vec<f64>,
    /// Event indicators as the last event has left them.
    sides: Vec<f64>,
    /// Event indicators at the present time.
    now: Vec<f64>,
    /// Whether derivatives, algebraic unknowns and slots agree with time, states and inputs.
    fits: bool,
    /// Time, unknowns and derivatives of the last solution, as a start for the next one.
    known: (f64, Vec<f64>, Vec<f64>),
}

/// Why a system cannot be integrated by the caller; `None` where it can.
pub fn refuses(system: &ExecutableSystem) -> Option<&'static str> {
    let dae = &system.dae;
    match () {
        () if !dae.delays.is_empty() => Some("a `delay` needs the steps of the integrator"),
        () if !dae.selections.is_empty() => Some("its states change during a run"),
        () if dae.inputs.iter().any(|v| system.layout.der(*v).is_some()) => Some("an input is differentiated"),
        () => None,
    }
}

/// Number of event indicators of a system.
pub fn indicators(system: &ExecutableSystem) -> usize {
    RootFunctions::new(system).len()
}

impl<'a> ExchangeDriver<'a> {
    /// Initializes the model and runs the event iteration at the start.
    ///
    /// # Errors
    /// Initialization or the first event iteration failed.
    pub fn new(
        system: &'a ExecutableSystem,
        settings: &'a Settings,
        inputs: &[RecordedInput],
    ) -> Result<Self, EarlyStop> {
        let (mut driver, mut model, solved) = prepare(system, settings, inputs, None, None, None);
        solved.map_err(|d| stop_at_start(d).with_troubles(system))?;
        driver.begin(&mut model, false)?;
        let n = system.columns.len();
        let solver = AlgebraicSolver::with_rates(system, driver.restart.nominal(), settings.tolerance);
        let roots = model.roots.len();
        let (sides, now) = (vec![0.0; roots], vec![0.0; roots]);
        let (y, yp, known) = (vec![0.0; n], vec![0.0; n], (0.0, Vec::new(), Vec::new()));
        let mut exchange = ExchangeDriver { driver, model, solver, y, yp, sides, now, fits: false, known };
        exchange.settle();
        Ok(exchange)
    }

    /// The system of this model.
    fn system(&self) -> &'a ExecutableSystem {
        self.driver.system
    }

    /// Copies unknowns and event indicators from the values that an event has left.
    fn settle(&mut self) {
        let system = self.system();
        // the buffers of the restart have one entry even without unknowns
        let n = system.columns.len();
        self.driver.restart.gather(system, &mut self.model.values);
        self.y.copy_from_slice(&self.driver.restart.y()[..n]);
        self.yp.copy_from_slice(&self.driver.restart.yp()[..n]);
        self.model.crossings(self.driver.t, &self.y, &self.yp, &mut self.sides);
        self.remember();
        self.fits = false;
    }

    /// Present time in seconds.
    pub fn time(&self) -> f64 {
        self.driver.t
    }

    /// Sets the present time in seconds. Derivatives are solved again at the next reading.
    pub fn set_time(&mut self, t: f64) {
        self.driver.t = t;
        self.fits = false;
    }

    /// Columns of the states, ascending.
    fn columns(&self) -> impl Iterator<Item = usize> + use<'a> {
        self.system().columns.iter().enumerate().filter(|(_, c)| c.is_state()).map(|(j, _)| j)
    }

    /// Sets the states, in the order of [`ExchangeDriver::states`].
    pub fn set_states(&mut self, x: &[f64]) {
        for (j, value) in self.columns().zip(x) {
            self.y[j] = *value;
        }
        self.fits = false;
    }

    /// Values of the states, in the order of their columns.
    pub fn states(&self) -> Vec<f64> {
        self.columns().map(|j| self.y[j]).collect()
    }

    /// Nominal values of the states, in the same order.
    pub fn nominals(&self) -> Vec<f64> {
        self.columns().map(|j| self.driver.restart.nominal()[j]).collect()
    }

    /// Sets an input by its slot. A recording bound to this input is no longer played back.
    pub fn set(&mut self, slot: usize, value: f64) {
        self.model.playback.release(slot);
        self.model.values[slot] = value;
        self.fits = false;
    }

    /// Solves for derivatives and algebraic unknowns, unless they fit already.
    fn fit(&mut self) -> Result<(), EarlyStop> {
        if self.fits {
            return Ok(());
        }
        let t = self.driver.t;
        self.model.values[ValueLayout::TIME] = t;
        // in this order: from the present values, then in small steps from the last solution
        if self.y.is_empty() || self.solve(t, self.y.clone()) || self.approach(t) {
            self.remember();
        // the integrator may have stepped over an event, where the old modes admit no solution
        } else if !self.across(t) {
            return Err(self.unsolved());
        }
        self.model.observe(t, &self.y, &self.yp);
        self.fits = true;
        Ok(())
    }

    /// Solves from the unknowns `y` and the present derivatives; false when there is no solution.
    fn solve(&mut self, t: f64, y: Vec<f64>) -> bool {
        let Some((y, yp)) = self.solver.solved(&mut self.model, t, &y, &self.yp) else { return false };
        let (y, yp) = (y.to_vec(), yp.to_vec());
        (self.y, self.yp) = (y, yp);
        true
    }

    /// Stores the present point as the last one with a solution.
    fn remember(&mut self) {
        self.known.0 = self.driver.t;
        self.known.1.clone_from(&self.y);
        self.known.2.clone_from(&self.yp);
    }

    /// Moves time and states in equal parts from the last solution to the wanted point; false when a part fails.
    fn approach(&mut self, t: f64) -> bool {
        let (wanted, (from, y, yp)) = (self.y.clone(), self.known.clone());
        let columns: Vec<usize> = self.columns().collect();
        // a fine subdivision only when the coarse one fails: each part costs a solution
        for parts in [4_u32, 32] {
            (self.y, self.yp) = (y.clone(), yp.clone());
            let arrives = (1..=parts).all(|k| {
                let share = f64::from(k) / f64::from(parts);
                let mut next = self.y.clone();
                columns.iter().for_each(|&j| next[j] = y[j] + share * (wanted[j] - y[j]));
                self.solve(from + share * (t - from), next)
            });
            if arrives {
                return true;
            }
        }
        // the wanted states stay for `across` and for the message
        (self.y, self.yp) = (wanted, yp);
        false
    }

    /// Solves with the modes that would hold after the event, where the present modes admit no solution.
    ///
    /// The caller's integrator has then stepped past an event, and the indicators at these values show it. The stored
    /// modes do not change. False when the event iteration fails.
    fn across(&mut self, t: f64) -> bool {
        let system = self.system();
        let Driver { events, scales, modes, restart, .. } = &mut self.driver;
        // a copy: discrete variables must not change before the caller handles the event
        let mut values = self.model.values.clone();
        values[ValueLayout::TIME] = t;
        for (c, y) in system.columns.iter().zip(&self.y).filter(|(c, _)| c.is_state()) {
            values[system.layout.var(c.variable)] = *y;
        }
        if events.iterate(system, scales, modes, &mut values).is_err() {
            return false;
        }
        restart.gather(system, &mut values);
        for (j, c) in system.columns.iter().enumerate() {
            // a state may have been set by `reinit`: here it is what the caller says
            self.y[j] = if c.is_state() { self.y[j] } else { restart.y()[j] };
            self.yp[j] = restart.yp()[j];
        }
        true
    }

    /// The error for a point without solution; it names the operation that is not finite, if there is one.
    fn unsolved(&mut self) -> EarlyStop {
        let (system, t) = (self.system(), self.driver.t);
        self.model.observe(t, &self.y, &self.yp);
        let diagnostic = match report::find_trap(system, &self.model.values) {
            Some(trap) => report::non_finite(system, t, Some(trap)),
            None => {
                let text = format!("the equations have no solution at time {} s", report::number(t));
                Diagnostic::new(Code::StepTooSmall, text).help("a shorter step of the integrator may help")
            }
        };
        EarlyStop::new(End::StepTooSmall, diagnostic).with_troubles(system)
    }

    /// Derivatives of the states with respect to time, in the order of [`ExchangeDriver::states`].
    ///
    /// # Errors
    /// The equations have no solution at this point.
    pub fn derivatives(&mut self) -> Result<Vec<f64>, EarlyStop> {
        self.fit()?;
        Ok(self.columns().map(|j| self.yp[j]).collect())
    }

    /// The functions whose changes of sign are events.
    ///
    /// # Errors
    /// The equations have no solution at this point.
    pub fn indicators(&mut self) -> Result<&[f64], EarlyStop> {
        self.fit()?;
        self.model.crossings(self.driver.t, &self.y, &self.yp, &mut self.now);
        Ok(&self.now)
    }

    /// Number of event indicators.
    pub fn indicator_count(&self) -> usize {
        self.sides.len()
    }

    /// The value in a slot.
    ///
    /// # Errors
    /// The equations have no solution at this point.
    pub fn value(&mut self, slot: usize) -> Result<f64, EarlyStop> {
        self.fit()?;
        Ok(self.model.values[slot])
    }

    /// Handles the events that are due: sign changes since the last event, known times reached, and changed inputs.
    ///
    /// # Errors
    /// The event iteration failed, or an assertion does not hold.
    pub fn event(&mut self) -> Result<ExchangeEventResult, EarlyStop> {
        self.indicators()?;
        let t = self.driver.t;
        // a function at exactly zero counts as negative, before and now
        let crossed = |(before, now): (&f64, &f64)| match (*before > 0.0, *now > 0.0) {
            (false, true) => 1,
            (true, false) => -1,
            _ => 0,
        };
        self.driver.roots = self.sides.iter().zip(&self.now).map(crossed).collect();
        let root = self.driver.roots.iter().any(|d| *d != 0);
        let cause = if root { EventCause::Root } else { EventCause::Time };
        self.driver.statistics.events += 1;
        let padded = padded(&self.y);
        // conserved quantities are compared with the values before the event
        self.driver.restart.before(self.driver.system, &mut self.model.values, &padded);
        if root {
            self.driver.prepare_event(&mut self.model, EventCause::Root);
        }
        // a sample may be due at the same time as a root
        let due = self.next();
        if due <= t || same_time(due, t) {
            self.driver.prepare_event(&mut self.model, EventCause::Time);
        }
        let outcome = self.driver.iterate(&mut self.model, cause)?;
        self.settle();
        let terminated = match self.driver.judge(&mut self.model, &outcome) {
            Ok(()) => None,
            Err(EarlyStop { end: End::Terminated(message), .. }) => Some(message),
            Err(stop) => return Err(stop.with_troubles(self.system())),
        };
        let next = self.next();
        Ok(ExchangeEventResult {
            states_changed: outcome.reinitialised,
            next: next.is_finite().then_some(next),
            terminated,
        })
    }

    /// The next sample or crossing of time in seconds; infinite when there is none.
    fn next(&self) -> f64 {
        self.driver.clocks.next().min(self.driver.next_crossing)
    }

    /// Removes and returns the warnings recorded since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        self.driver.warnings()
    }
}

/// `y`, or one zero where it is empty: the buffers of a restart are never empty.
fn padded(y: &[f64]) -> Vec<f64> {
    if y.is_empty() { vec![0.0] } else { y.to_vec() }
}
