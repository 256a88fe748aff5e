//! A run that Python advances step by step, setting inputs and reading variables in between (co-simulation).

use crate::errors::raised;
use crate::run::Saved;
use bramah::{Error, InputPort, OwnedStepping, Probe, Simulation, State};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The run, with the handles of inputs and variables that were used before.
struct Inner {
    /// The run, which owns its simulation.
    run: OwnedStepping,
    /// The handle of each input by its name.
    inputs: HashMap<String, InputPort>,
    /// The handle of each variable by its name.
    probes: HashMap<String, Probe>,
}

/// A run that is taken from step to step.
#[pyclass(frozen, module = "bramah._bramah", name = "Stepper")]
pub struct Core {
    /// A mutex, because Python may call from several threads.
    inner: Mutex<Inner>,
}

impl Core {
    /// Begins a run, from a saved state or from the initial values.
    pub fn begin(py: Python<'_>, simulation: Simulation, from: Option<State>) -> PyResult<Self> {
        let run = py.detach(|| OwnedStepping::new(simulation, from.as_ref())).map_err(|e| raised(py, &e))?;
        Ok(Core { inner: Mutex::new(Inner { run, inputs: HashMap::new(), probes: HashMap::new() }) })
    }

    /// Locks the run. A panic in another thread has left it as it was before its step, so a poisoned lock is taken.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// The handle of an input, which is looked up by name once.
    fn input(&mut self, name: &str) -> Result<InputPort, Error> {
        if let Some(port) = self.inputs.get(name) {
            return Ok(*port);
        }
        let port = self.run.with(|run| run.input(name))?;
        self.inputs.insert(name.to_owned(), port);
        Ok(port)
    }

    /// The handle of a variable, which is looked up by name once.
    fn probe(&mut self, name: &str) -> Result<Probe, Error> {
        if let Some(probe) = self.probes.get(name) {
            return Ok(*probe);
        }
        let probe = self.run.with(|run| run.probe(name))?;
        self.probes.insert(name.to_owned(), probe);
        Ok(probe)
    }
}

#[pymethods]
impl Core {
    /// Seconds.
    #[getter]
    fn time(&self) -> f64 {
        self.inner().run.with(|run| run.time())
    }

    /// Sets inputs, goes on by so many seconds.
    fn step(&self, py: Python<'_>, seconds: f64, inputs: Vec<(String, f64)>) -> PyResult<()> {
        // Without the GIL: a step may take long.
        let stepped = py.detach(|| {
            let mut inner = self.inner();
            // All inputs are set before the step, so that they change at one time.
            for (name, value) in &inputs {
                let port = inner.input(name)?;
                inner.run.with(|run| run.set(port, *value));
            }
            inner.run.with(|run| run.step(seconds))
        });
        stepped.map_err(|e| raised(py, &e))
    }

    /// The value of a variable where the run stands.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        let mut inner = self.inner();
        let probe = inner.probe(name).map_err(|e| raised(py, &e))?;
        Ok(inner.run.with(|run| run.get(probe)))
    }

    /// Everything needed to go on from here.
    fn state(&self) -> Saved {
        Saved { state: self.inner().run.with(|run| run.state()) }
    }

    /// What the model said when it ended the run, or nothing.
    fn terminated(&self) -> Option<String> {
        self.inner().run.with(|run| run.terminated().map(str::to_owned))
    }
}
