//! Runs and their results: settings from Python enter, arrays and texts leave.

use crate::errors::raised;
use crate::model::{Quantity, quantity_of};
use bramah::internals::diag::render::full;
use bramah::internals::plot::select::{FigureOptions, LabelledTrajectory as Drawn, UnitSystem, figure};
use bramah::internals::plot::{html, svg};
use bramah::results::{CsvWriter, GlobPatterns};
use bramah::{Control, End, Error, Interpolation, Outcome, Progress, Signal, Simulation, Sources, State, Trajectory};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// The number of progress calls of the solver between two checks for Ctrl-C. Each check takes the GIL.
const LOOK: u32 = 16;

/// The settings of a run, from a dictionary of Python. `None` keeps the setting of the model.
#[derive(FromPyObject)]
pub struct Plan {
    /// Start time (s).
    #[pyo3(item)]
    start: Option<f64>,
    /// Stop time (s).
    #[pyo3(item)]
    stop: Option<f64>,
    /// Output interval (s).
    #[pyo3(item)]
    interval: Option<f64>,
    /// Relative tolerance.
    #[pyo3(item)]
    tolerance: Option<f64>,
    /// True if rows before and after events are wanted.
    #[pyo3(item)]
    event_rows: Option<bool>,
    /// Patterns of the variables to be recorded. Empty for all that change.
    #[pyo3(item)]
    outputs: Vec<String>,
    /// Inputs: name, times (s), values, and whether a value is held until the next sample.
    #[pyo3(item)]
    inputs: Vec<(String, Vec<f64>, Vec<f64>, bool)>,
}

impl Plan {
    /// Sets the settings and inputs of a simulation.
    pub fn apply(&self, simulation: &mut Simulation) -> Result<(), Error> {
        let settings = simulation.settings();
        if let Some(start) = self.start {
            settings.start_time = start;
        }
        if let Some(stop) = self.stop {
            settings.stop_time = stop;
            // As the command does: 500 intervals, unless the interval is given too.
            settings.interval = (stop - settings.start_time) / 500.0;
        }
        if let Some(interval) = self.interval {
            settings.interval = interval;
        }
        if let Some(tolerance) = self.tolerance {
            settings.tolerance = tolerance;
        }
        if let Some(rows) = self.event_rows {
            settings.event_rows = rows;
        }
        for (name, times, values, held) in &self.inputs {
            let between = if *held { Interpolation::Held } else { Interpolation::Linear };
            simulation.input(name, times, values, between)?;
        }
        self.record(simulation)
    }

    /// Selects the variables to be recorded.
    /// Patterns select among those that change. A plain name may also be a parameter.
    fn record(&self, simulation: &mut Simulation) -> Result<(), Error> {
        if self.outputs.is_empty() {
            simulation.record_variables();
            return Ok(());
        }
        let all: Vec<String> = simulation.variables().into_iter().map(|s| s.name).collect();
        let mut chosen: Vec<&str> = Vec::new();
        for pattern in &self.outputs {
            let globs = GlobPatterns::new(&[pattern]);
            let before = chosen.len();
            chosen.extend(all.iter().map(String::as_str).filter(|n| globs.matches(n)));
            // No match: the name of a parameter, or a misspelt one, which `record` reports.
            if chosen.len() == before {
                chosen.push(pattern);
            }
        }
        // A variable that several patterns select is recorded once.
        let mut seen = std::collections::BTreeSet::new();
        chosen.retain(|name| seen.insert(*name));
        simulation.record(&chosen).map(drop)
    }
}

/// Where a run ended, to go on from.
#[pyclass(frozen, module = "bramah._bramah", name = "State")]
pub struct Saved {
    /// The state, with the values of all variables.
    pub state: State,
}

#[pymethods]
impl Saved {
    /// From what `parts` gave, for pickling.
    #[new]
    fn new(names: Vec<String>, bytes: Vec<u8>) -> PyResult<Self> {
        let state = State::from_bytes(names, &bytes);
        state.map(|state| Saved { state }).ok_or_else(|| PyValueError::new_err("these bytes are no state"))
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Vec<String>, Bound<'py, PyBytes>) {
        (self.state.names.clone(), PyBytes::new(py, &self.state.bytes()))
    }

    fn __repr__(&self) -> String {
        format!("<bramah.State at {} s, {} variables>", self.state.time, self.state.names.len())
    }

    /// Seconds.
    #[getter]
    fn time(&self) -> f64 {
        self.state.time
    }

    /// The value of every variable.
    fn values(&self) -> Vec<(String, f64)> {
        self.state.names.iter().cloned().zip(self.state.values.iter().copied()).collect()
    }
}

/// A result.
#[pyclass(frozen, module = "bramah._bramah", name = "Run")]
pub struct Run {
    /// The signals of the columns.
    signals: Vec<Signal>,
    /// The times of the rows (s).
    time: Py<PyArray1<f64>>,
    /// One array for each signal.
    columns: Vec<Py<PyArray1<f64>>>,
    /// How the run ended.
    end: End,
    /// The state at the end.
    state: State,
    /// The warnings of the run as text.
    messages: String,
    /// Counts and times of the work.
    statistics: bramah::Statistics,
}

impl Run {
    /// The result of a run. `sources` are the texts that its diagnostics refer to.
    pub fn new(py: Python<'_>, outcome: Outcome, sources: &Sources) -> Self {
        let Outcome { trajectory, end, state, statistics, diagnostics } = outcome;
        let messages = full(sources, &diagnostics);
        // The vectors become the arrays without being copied.
        let array = |v: Vec<f64>| PyArray1::from_vec(py, v).unbind();
        Run {
            signals: trajectory.signals,
            time: array(trajectory.times),
            columns: trajectory.columns.into_iter().map(array).collect(),
            end,
            state,
            messages,
            statistics,
        }
    }

    /// Executes a run without the GIL, which is taken now and then for Ctrl-C and to call `show` with the time.
    ///
    /// # Errors
    /// The run fails, or `show` raises an exception. After Ctrl-C the result has the rows so far.
    pub fn of(
        py: Python<'_>,
        simulation: &Simulation,
        from: Option<&State>,
        show: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (mut calls, mut stopped) = (0, None);
        let outcome = py.detach(|| {
            let mut progress = |now: &Progress| {
                calls += 1;
                if calls % LOOK != 0 {
                    return true;
                }
                let asked = Python::attach(|py| {
                    py.check_signals()?;
                    show.as_ref().map_or(Ok(()), |show| show.call1(py, (now.time,)).map(drop))
                });
                // `false` ends the run.
                asked.map_err(|error| stopped = Some(error)).is_ok()
            };
            let mut control = Control { progress: Some(&mut progress), ..Control::default() };
            simulation.run_kept(from, &mut control)
        });
        let outcome = outcome.map_err(|e| raised(py, &e))?;
        let is_interrupt = |e: &PyErr| e.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py);
        match stopped {
            // After Ctrl-C the rows so far are kept; `end` shows that the result is not complete.
            Some(error) if !is_interrupt(&error) => return Err(error),
            None if !outcome.end.is_success() => {
                let sources = std::sync::Arc::new(simulation.sources().clone());
                return Err(raised(py, &Error { diagnostics: outcome.diagnostics, sources }));
            }
            _ => {}
        }
        Ok(Run::new(py, outcome, simulation.sources()))
    }

    /// The result as a trajectory; the arrays are copied.
    fn trajectory(&self, py: Python<'_>) -> PyResult<Trajectory> {
        let mut trajectory = Trajectory::new(self.signals.clone());
        trajectory.times = self.time.bind(py).to_vec()?;
        trajectory.columns = self.columns.iter().map(|c| c.bind(py).to_vec()).collect::<Result<_, _>>()?;
        Ok(trajectory)
    }
}

#[pymethods]
impl Run {
    /// Times of the rows in seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.time.clone_ref(py)
    }

    /// Name, unit, unit for people, description, kind and literals of each column.
    fn signals(&self) -> Vec<Quantity> {
        self.signals.iter().cloned().map(quantity_of).collect()
    }

    /// The arrays of the columns, in the order of `signals`.
    fn columns(&self, py: Python<'_>) -> Vec<Py<PyArray1<f64>>> {
        self.columns.iter().map(|c| c.clone_ref(py)).collect()
    }

    /// `reached`, `terminated` or `interrupted`.
    #[getter]
    fn end(&self) -> &'static str {
        self.end.word()
    }

    /// What the model said when it ended the run, or nothing.
    #[getter]
    fn ending(&self) -> Option<String> {
        match &self.end {
            End::Terminated(message) => Some(message.clone()),
            _ => None,
        }
    }

    /// Warnings of the run.
    #[getter]
    fn messages(&self) -> &str {
        &self.messages
    }

    /// Where it ended.
    #[getter]
    fn state(&self) -> Saved {
        Saved { state: self.state.clone() }
    }

    /// The work done.
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (s, dict) = (&self.statistics, PyDict::new(py));
        dict.set_item("steps", s.steps)?;
        dict.set_item("events", s.events)?;
        dict.set_item("residual_evaluations", s.residual_evaluations)?;
        dict.set_item("jacobian_evaluations", s.jacobian_evaluations)?;
        dict.set_item("states", s.states)?;
        dict.set_item("unknowns", s.unknowns)?;
        dict.set_item("initialize_s", s.initialize_s)?;
        dict.set_item("solve_s", s.solve_s)?;
        Ok(dict)
    }

    /// A picture: `svg`, or `html` with zoom and hover.
    fn draw(
        &self,
        py: Python<'_>,
        variables: Vec<String>,
        engineering: bool,
        format: &str,
        title: String,
    ) -> PyResult<String> {
        let mut trajectory = self.trajectory(py)?;
        if engineering {
            UnitSystem::Engineering.apply(&mut trajectory);
        }
        let choice = FigureOptions { variables: GlobPatterns::new(&variables), title, ..FigureOptions::default() };
        let drawn = figure(&[Drawn { label: "", trajectory: &trajectory }], &choice).map_err(PyValueError::new_err)?;
        Ok(if format == "svg" { svg::write(&drawn.figure) } else { html::write(&drawn.figure, &[]) })
    }

    /// CSV with units in the head, or plain names.
    fn csv(&self, py: Python<'_>, units: bool) -> PyResult<String> {
        let io = |e: std::io::Error| PyOSError::new_err(e.to_string());
        let trajectory = self.trajectory(py)?;
        let mut signals = trajectory.signals.clone();
        // Here units are part of the names.
        if units {
            signals.iter_mut().filter(|s| !s.unit.is_empty()).for_each(|s| s.name = format!("{} [{}]", s.name, s.unit));
        }
        let mut bytes = Vec::new();
        let mut writer = CsvWriter::new(&mut bytes, &signals).map_err(io)?;
        for (row, &time) in trajectory.times.iter().enumerate() {
            writer.row(time, trajectory.columns.iter().map(|c| c[row])).map_err(io)?;
        }
        writer.finish().map_err(io)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
