//! A run under way together with the simulation that it reads, for callers that keep it, such as other languages.

use super::{Exchange, Simulation, Stepping};
use bramah_solve::State;
use bramah_syntax::diag::Error;

self_cell::self_cell!(
    struct SteppingCell {
        owner: Simulation,
        // The run borrows the simulation for its own lifetime, which must not be shortened.
        #[not_covariant]
        dependent: Stepping,
    }
);

/// [`Stepping`] without a lifetime: it owns its simulation.
pub struct OwnedStepping {
    cell: SteppingCell,
}

impl OwnedStepping {
    /// Begins from the initial values, or from a saved state.
    ///
    /// # Errors
    /// As [`Simulation::stepping`] and [`Simulation::stepping_from`].
    pub fn new(simulation: Simulation, from: Option<&State>) -> Result<Self, Error> {
        Ok(OwnedStepping { cell: SteppingCell::try_new(simulation, |simulation| Stepping::new(simulation, from))? })
    }

    /// Acts on the run.
    pub fn with<T>(&mut self, act: impl FnOnce(&mut Stepping<'_>) -> T) -> T {
        self.cell.with_dependent_mut(|_, run| act(run))
    }
}

self_cell::self_cell!(
    struct ExchangeCell {
        owner: Simulation,
        // As for `SteppingCell`.
        #[not_covariant]
        dependent: Exchange,
    }
);

/// [`Exchange`] without a lifetime: it owns its simulation.
pub struct OwnedExchange {
    cell: ExchangeCell,
}

impl OwnedExchange {
    /// At the initial values.
    ///
    /// # Errors
    /// As [`Simulation::exchange`].
    pub fn new(simulation: Simulation) -> Result<Self, Error> {
        Ok(OwnedExchange { cell: ExchangeCell::try_new(simulation, |simulation| Exchange::new(simulation))? })
    }

    /// Acts on the model.
    pub fn with<T>(&mut self, act: impl FnOnce(&mut Exchange<'_>) -> T) -> T {
        self.cell.with_dependent_mut(|_, exchange| act(exchange))
    }
}
