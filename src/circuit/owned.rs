//! A run under way together with the simulation that it reads: for callers that keep it, as those of other languages do.

use super::{Simulation, Stepping};
use crate::diag::Error;
use crate::solve::State;

self_cell::self_cell!(
    struct Cell {
        owner: Simulation,
        #[not_covariant]
        dependent: Stepping,
    }
);

/// [`Stepping`] without a lifetime: it owns its simulation.
pub struct OwnedStepping {
    cell: Cell,
}

impl OwnedStepping {
    /// Begins from the initial values, or from a saved state.
    ///
    /// # Errors
    /// As [`Simulation::stepping`] and [`Simulation::stepping_from`].
    pub fn new(simulation: Simulation, from: Option<&State>) -> Result<Self, Error> {
        Ok(OwnedStepping { cell: Cell::try_new(simulation, |simulation| Stepping::new(simulation, from))? })
    }

    /// Acts on the run.
    pub fn with<T>(&mut self, act: impl FnOnce(&mut Stepping<'_>) -> T) -> T {
        self.cell.with_dependent_mut(|_, run| act(run))
    }
}
