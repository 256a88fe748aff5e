//! A run that is taken from step to step.

use crate::errors::raised;
use crate::run::Saved;
use bramah::{Error, InputPort, OwnedStepping, Probe, Simulation, State};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The run, with inputs and variables looked up once.
struct Inner {
    run: OwnedStepping,
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
        let run = py.detach(|| OwnedStepping::new(simulation, from.as_ref())).map_err(|e| raised(py, &e))?;
        Ok(Core { inner: Mutex::new(Inner { run, inputs: HashMap::new(), probes: HashMap::new() }) })
    }

    /// A thread that panicked has left the run as it was before its step.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn input(&mut self, name: &str) -> Result<InputPort, Error> {
        if let Some(port) = self.inputs.get(name) {
            return Ok(*port);
        }
        let port = self.run.with(|run| run.input(name))?;
        self.inputs.insert(name.to_owned(), port);
        Ok(port)
    }

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
        let stepped = py.detach(|| {
            let mut inner = self.inner();
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
