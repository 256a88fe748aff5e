//! A model whose integrator is the caller's: time, states and inputs come from outside, derivatives and the functions that
//! watch for events go there. Between events the modes are held; what an event does is what it does in any run.

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

/// What came of an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExchangeEventResult {
    /// States have new values.
    pub states_changed: bool,
    /// The next event of known time (s).
    pub next: Option<f64>,
    /// The message of `terminate`.
    pub terminated: Option<String>,
}

/// A model under way.
pub struct ExchangeDriver<'a> {
    driver: Driver<'a, 'a>,
    model: IntegrationModel<'a>,
    solver: AlgebraicSolver,
    y: Vec<f64>,
    yp: Vec<f64>,
    /// The functions that watch for events, behind the last one.
    sides: Vec<f64>,
    /// The same now.
    now: Vec<f64>,
    /// Derivatives, algebraic unknowns and variables fit to time, states and inputs.
    fits: bool,
    /// Time, unknowns and derivatives where they fitted last.
    known: (f64, Vec<f64>, Vec<f64>),
}

/// Why a system cannot be integrated by others; `None` where it can.
pub fn refuses(system: &ExecutableSystem) -> Option<&'static str> {
    let dae = &system.dae;
    match () {
        () if !dae.delays.is_empty() => Some("a `delay` needs the steps of the integrator"),
        () if !dae.selections.is_empty() => Some("its states change during a run"),
        () if dae.inputs.iter().any(|v| system.layout.der(*v).is_some()) => Some("an input is differentiated"),
        () => None,
    }
}

/// How many functions watch for events of a system.
pub fn indicators(system: &ExecutableSystem) -> usize {
    RootFunctions::new(system).len()
}

impl<'a> ExchangeDriver<'a> {
    /// At the start, with the event iteration done.
    ///
    /// # Errors
    /// As a run that ends there.
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

    fn system(&self) -> &'a ExecutableSystem {
        self.driver.system
    }

    /// Unknowns and sides from the values that an event has left.
    fn settle(&mut self) {
        let system = self.system();
        let n = system.columns.len();
        self.driver.restart.gather(system, &mut self.model.values);
        self.y.copy_from_slice(&self.driver.restart.y()[..n]);
        self.yp.copy_from_slice(&self.driver.restart.yp()[..n]);
        self.model.crossings(self.driver.t, &self.y, &self.yp, &mut self.sides);
        self.remember();
        self.fits = false;
    }

    /// Where time stands (s).
    pub fn time(&self) -> f64 {
        self.driver.t
    }

    /// Says where time stands.
    pub fn set_time(&mut self, t: f64) {
        self.driver.t = t;
        self.fits = false;
    }

    /// The columns of the states.
    fn columns(&self) -> impl Iterator<Item = usize> + use<'a> {
        self.system().columns.iter().enumerate().filter(|(_, c)| c.is_state()).map(|(j, _)| j)
    }

    /// Sets the states; as many as there are.
    pub fn set_states(&mut self, x: &[f64]) {
        for (j, value) in self.columns().zip(x) {
            self.y[j] = *value;
        }
        self.fits = false;
    }

    /// The states.
    pub fn states(&self) -> Vec<f64> {
        self.columns().map(|j| self.y[j]).collect()
    }

    /// Their usual sizes.
    pub fn nominals(&self) -> Vec<f64> {
        self.columns().map(|j| self.driver.restart.nominal()[j]).collect()
    }

    /// Sets an input by its slot.
    pub fn set(&mut self, slot: usize, value: f64) {
        self.model.playback.release(slot);
        self.model.values[slot] = value;
        self.fits = false;
    }

    /// Solves for derivatives and algebraic unknowns.
    fn fit(&mut self) -> Result<(), EarlyStop> {
        if self.fits {
            return Ok(());
        }
        let t = self.driver.t;
        self.model.values[ValueLayout::TIME] = t;
        if self.y.is_empty() || self.solve(t, self.y.clone()) || self.approach(t) {
            self.remember();
        } else if !self.across(t) {
            return Err(self.unsolved());
        }
        self.model.observe(t, &self.y, &self.yp);
        self.fits = true;
        Ok(())
    }

    /// Solves from these unknowns and the derivatives at hand.
    fn solve(&mut self, t: f64, y: Vec<f64>) -> bool {
        let Some((y, yp)) = self.solver.solved(&mut self.model, t, &y, &self.yp) else { return false };
        let (y, yp) = (y.to_vec(), yp.to_vec());
        (self.y, self.yp) = (y, yp);
        true
    }

    /// Notes where there was a solution last.
    fn remember(&mut self) {
        self.known.0 = self.driver.t;
        self.known.1.clone_from(&self.y);
        self.known.2.clone_from(&self.yp);
    }

    /// Goes to the states in parts from where there was a solution last.
    fn approach(&mut self, t: f64) -> bool {
        let (wanted, (from, y, yp)) = (self.y.clone(), self.known.clone());
        let columns: Vec<usize> = self.columns().collect();
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
        (self.y, self.yp) = (wanted, yp);
        false
    }

    /// Where there is no solution with the modes that hold: what would hold behind the event, as the functions that watch for
    /// it then show. The modes stay.
    fn across(&mut self, t: f64) -> bool {
        let system = self.system();
        let Driver { events, scales, modes, restart, .. } = &mut self.driver;
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

    /// The derivatives of the states.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn derivatives(&mut self) -> Result<Vec<f64>, EarlyStop> {
        self.fit()?;
        Ok(self.columns().map(|j| self.yp[j]).collect())
    }

    /// The functions whose change of sign is an event.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn indicators(&mut self) -> Result<&[f64], EarlyStop> {
        self.fit()?;
        self.model.crossings(self.driver.t, &self.y, &self.yp, &mut self.now);
        Ok(&self.now)
    }

    /// How many there are.
    pub fn indicator_count(&self) -> usize {
        self.sides.len()
    }

    /// The value in a slot.
    ///
    /// # Errors
    /// The equations have no solution there.
    pub fn value(&mut self, slot: usize) -> Result<f64, EarlyStop> {
        self.fit()?;
        Ok(self.model.values[slot])
    }

    /// Does what is due: where functions have changed their sign since the last event, where a known time is reached, and
    /// where inputs have changed.
    ///
    /// # Errors
    /// As a run that ends there.
    pub fn event(&mut self) -> Result<ExchangeEventResult, EarlyStop> {
        self.indicators()?;
        let t = self.driver.t;
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
        self.driver.restart.before(self.driver.system, &mut self.model.values, &padded);
        if root {
            self.driver.prepare_event(&mut self.model, EventCause::Root);
        }
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

    fn next(&self) -> f64 {
        self.driver.clocks.next().min(self.driver.next_crossing)
    }

    /// Warnings since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        self.driver.warnings()
    }
}

/// At least one number, as the buffers of a restart have.
fn padded(y: &[f64]) -> Vec<f64> {
    if y.is_empty() { vec![0.0] } else { y.to_vec() }
}
