//! A run that is taken from step to step.

use crate::errors::raised;
use crate::run::Saved;
use bramah::{Error, InputPort, Probe, Simulation, State, Stepping};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

struct Begun<'a>(Result<Stepping<'a>, Error>);

self_cell::self_cell!(
    /// A stepping run with the simulation that it reads.
    struct Cell {
        owner: Simulation,
        #[not_covariant]
        dependent: Begun,
    }
);

/// The run, with inputs and variables looked up once.
struct Inner {
    cell: Cell,
    inputs: HashMap<String, InputPort>,
    probes: HashMap<String, Probe>,
}

/// A run that is taken from step to step.
#[pyclass(frozen, module = "bramah._bramah", name = "Stepper")]
pub struct Core {
    inner: Mutex<Inner>,
}

impl Core {
    pub fn begin(py: Python<'_>, simulation: Simulation, from: Option<State>) -> PyResult<Self> {
        let mut cell = py.detach(|| {
            Cell::new(simulation, |s| Begun(from.as_ref().map_or_else(|| s.stepping(), |state| s.stepping_from(state))))
        });
        let failed = cell.with_dependent_mut(|_, run| run.0.as_ref().err().cloned());
        match failed {
            Some(error) => Err(raised(py, &error)),
            None => Ok(Core { inner: Mutex::new(Inner { cell, inputs: HashMap::new(), probes: HashMap::new() }) }),
        }
    }

    /// A thread that panicked has left the run as it was before its step.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn act<T>(&mut self, act: impl FnOnce(&mut Stepping<'_>) -> Result<T, Error>) -> Result<T, Error> {
        self.cell.with_dependent_mut(|_, run| match &mut run.0 {
            Ok(run) => act(run),
            Err(error) => Err(error.clone()),
        })
    }

    fn input(&mut self, name: &str) -> Result<InputPort, Error> {
        if let Some(port) = self.inputs.get(name) {
            return Ok(*port);
        }
        let port = self.act(|run| run.input(name))?;
        self.inputs.insert(name.to_owned(), port);
        Ok(port)
    }

    fn probe(&mut self, name: &str) -> Result<Probe, Error> {
        if let Some(probe) = self.probes.get(name) {
            return Ok(*probe);
        }
        let probe = self.act(|run| run.probe(name))?;
        self.probes.insert(name.to_owned(), probe);
        Ok(probe)
    }
}

#[pymethods]
impl Core {
    /// Seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.inner().act(|run| Ok(run.time())).map_err(|e| raised(py, &e))
    }

    /// Sets inputs, goes on by so many seconds.
    fn step(&self, py: Python<'_>, seconds: f64, inputs: Vec<(String, f64)>) -> PyResult<()> {
        let stepped = py.detach(|| {
            let mut inner = self.inner();
            for (name, value) in &inputs {
                let port = inner.input(name)?;
                inner.act(|run| {
                    run.set(port, *value);
                    Ok(())
                })?;
            }
            inner.act(|run| run.step(seconds))
        });
        stepped.map_err(|e| raised(py, &e))
    }

    /// The value of a variable where the run stands.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        let mut inner = self.inner();
        let probe = inner.probe(name).map_err(|e| raised(py, &e))?;
        inner.act(|run| Ok(run.get(probe))).map_err(|e| raised(py, &e))
    }

    /// Everything needed to go on from here.
    fn state(&self, py: Python<'_>) -> PyResult<Saved> {
        let state = self.inner().act(|run| Ok(run.state())).map_err(|e| raised(py, &e))?;
        Ok(Saved { state })
    }

    /// What the model said when it ended the run, or nothing.
    fn terminated(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.inner().act(|run| Ok(run.terminated().map(str::to_owned))).map_err(|e| raised(py, &e))
    }
}
