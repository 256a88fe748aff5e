//! A compiled model as an object of Python. Texts or paths enter, a model leaves, whose methods run and analyse it.
//! Values that are given with a call make a changed copy, so that a model never changes.

use crate::errors::raised;
use crate::run::{Plan, Run, Saved};
use crate::stepper;
use crate::threads::pooled;
use bramah::internals::diag::render::full;
use bramah::internals::plot::network;
use bramah::internals::units::{MeasurementUnit, quantity};
use bramah::world::{DiskWorld, MemoryWorld, Overlay};
use bramah::{Analyze, Diagnostic, Error, Kind, Override, Request, Signal, Simulation};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, OnceLock};

/// The path by which messages show a text without a file.
const TEXT: &str = "model.mo";

/// A compiled model, with the values that were set.
#[pyclass(frozen, module = "bramah._bramah", name = "Model")]
#[derive(Clone)]
pub struct Core {
    /// The compiled model with its values.
    pub simulation: Simulation,
    /// The parameters that can be set. They are looked up once, and shared by models that differ in values only.
    settable: Arc<OnceLock<Vec<bramah::Parameter>>>,
    /// The text, if the model was compiled from one.
    text: Option<String>,
    /// The request from which the model can be compiled again.
    request: Request,
}

/// A value from Python: a number in the parameter's unit, or a text with a unit of its own or another expression.
#[derive(FromPyObject, Clone)]
pub enum Value {
    /// `True` or `False`. It comes first, because Python converts Booleans to numbers.
    Flag(bool),
    /// A number in the unit of the parameter.
    Number(f64),
    /// An expression or a number with a unit, as a modifier would have it.
    Text(String),
}

impl Value {
    /// The text that the compiler takes, as after the command's option `--set`.
    fn text(&self) -> String {
        match self {
            Value::Flag(flag) => flag.to_string(),
            Value::Number(number) => bramah::results::number::text(*number),
            Value::Text(text) => text.clone(),
        }
    }
}

/// A variable for Python: name, unit, display unit, description, kind, and the literals of an enumeration.
pub type Quantity = (String, String, String, String, &'static str, Vec<String>);
/// The parts from which a model is compiled: text, source, class, libraries, and values by name.
type Recipe = (Option<String>, String, Option<String>, Vec<String>, Vec<(String, String)>);
/// A parameter: quantity, value, smallest and largest value, whether it is structural, whether it is of the model
/// itself.
type Parameter = (Quantity, f64, Option<f64>, Option<f64>, bool, bool);

/// The description of a signal for Python.
pub fn quantity_of(signal: Signal) -> Quantity {
    let (kind, literals) = match signal.kind {
        Kind::Real => ("Real", Vec::new()),
        Kind::Integer => ("Integer", Vec::new()),
        Kind::Boolean => ("Boolean", Vec::new()),
        Kind::Enumeration(literals) => ("enumeration", literals),
    };
    (signal.name, signal.unit, signal.display_unit, signal.description, kind, literals)
}

/// Compiles a model. A text is laid over the files of the disk, so that it can use them.
fn compiled(text: Option<&String>, request: &Request) -> Result<Simulation, Error> {
    match text {
        Some(text) => {
            let world = Overlay { base: &DiskWorld, files: MemoryWorld::single(TEXT, text.clone()) };
            Simulation::compile(&world, request)
        }
        None => Simulation::compile(&DiskWorld, request),
    }
}

impl Core {
    /// Compiles a model.
    fn new(text: Option<String>, request: Request) -> Result<Self, Error> {
        let simulation = compiled(text.as_ref(), &request)?;
        Ok(Core { simulation, settable: Arc::default(), text, request })
    }

    /// A copy with other values. It is compiled again only if that is necessary.
    fn with(&self, values: &[(String, Value)]) -> Result<Self, Error> {
        let mut changed = self.clone();
        let parameters = self.settable.get_or_init(|| self.simulation.parameters());
        let mut again = false;
        for (name, value) in values {
            let parameter = parameters.iter().find(|p| p.signal.name == *name);
            let number = parameter.filter(|p| !p.structural).and_then(|p| number(value, &p.signal));
            // The first value that needs the compiler makes it necessary for all; those already set do no harm.
            match number {
                Some(number) => drop(changed.simulation.set(name, number)?),
                None => again = true,
            }
        }
        // The request must make this model again, for pickling and for values that need the compiler.
        let overrides = &mut changed.request.overrides;
        overrides.retain(|o| !values.iter().any(|(name, _)| *name == o.name));
        overrides.extend(values.iter().map(|(n, v)| Override { name: n.clone(), value: v.text() }));
        if again {
            // Names of arrays, texts, structural parameters and inputs go through the compiler, as with `--set`.
            return Core::new(self.text.clone(), changed.request);
        }
        Ok(changed)
    }

    /// A copy with values and settings of a run.
    fn ready(&self, values: &[(String, Value)], plan: &Plan) -> Result<Simulation, Error> {
        let mut simulation = self.with(values)?.simulation;
        plan.apply(&mut simulation)?;
        Ok(simulation)
    }

    /// Diagnostics as the command prints them.
    fn messages_of(&self, diagnostics: &[Diagnostic]) -> String {
        full(self.simulation.sources(), diagnostics)
    }
}

/// The number in the unit of a quantity. `None` if the value needs the compiler, which also reports what is wrong with
/// it.
fn number(value: &Value, signal: &Signal) -> Option<f64> {
    match value {
        Value::Flag(flag) => (signal.kind == Kind::Boolean).then(|| f64::from(u8::from(*flag))),
        Value::Number(number) => (signal.kind == Kind::Real).then_some(*number),
        Value::Text(text) => {
            let (number, unit) = quantity(text).ok()?;
            let Some(unit) = unit else { return (signal.kind == Kind::Real).then_some(number) };
            if unit.offset != 0.0 {
                // A temperature or a temperature difference: only the compiler knows which of them the parameter is.
                return None;
            }
            unit.convert(number, &MeasurementUnit::parse(&signal.unit).ok()?)
        }
    }
}

#[pymethods]
impl Core {
    /// Compiles a text, a file, a package folder, or a class that ships with bramah.
    #[new]
    #[pyo3(signature = (text, source, model, libraries, overrides))]
    fn compile(
        py: Python<'_>,
        text: Option<String>,
        source: String,
        model: Option<String>,
        libraries: Vec<String>,
        overrides: Vec<(String, String)>,
    ) -> PyResult<Self> {
        // A text has a path of its own, whatever the caller names.
        let source = if text.is_some() { TEXT.into() } else { source.into() };
        let overrides = overrides.into_iter().map(|(name, value)| Override { name, value }).collect();
        let libraries = libraries.into_iter().map(Into::into).collect();
        let request = Request { source, model, overrides, libraries, ..Request::default() };
        py.detach(|| Core::new(text, request)).map_err(|e| raised(py, &e))
    }

    /// What makes the same model again, for pickling.
    fn recipe(&self) -> Recipe {
        let r = &self.request;
        let path = |p: &std::path::PathBuf| p.display().to_string();
        let set = r.overrides.iter().map(|o| (o.name.clone(), o.value.clone())).collect();
        (self.text.clone(), path(&r.source), r.model.clone(), r.libraries.iter().map(path).collect(), set)
    }

    /// The full name of the class.
    #[getter]
    fn class_name(&self) -> String {
        self.simulation.model().flat.class.clone()
    }

    /// Warnings and notes of the compilation.
    #[getter]
    fn messages(&self) -> String {
        self.messages_of(&self.simulation.diagnostics)
    }

    /// Start time, stop time, output interval (seconds), relative tolerance.
    #[getter]
    fn experiment(&self) -> (f64, f64, f64, f64) {
        let mut simulation = self.simulation.clone();
        let s = simulation.settings();
        (s.start_time, s.stop_time, s.interval, s.tolerance)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let all = self.simulation.parameters().into_iter();
        all.map(|p| (quantity_of(p.signal), p.value, p.min, p.max, p.structural, p.root)).collect()
    }

    fn inputs(&self) -> Vec<Quantity> {
        self.simulation.inputs().into_iter().map(quantity_of).collect()
    }

    fn variables(&self) -> Vec<Quantity> {
        self.simulation.variables().into_iter().map(quantity_of).collect()
    }

    /// The network as SVG.
    fn network(&self) -> String {
        network::write(&self.simulation.model().graph, &self.class_name())
    }

    /// The same model with other values.
    fn with_values(&self, py: Python<'_>, values: Vec<(String, Value)>) -> PyResult<Self> {
        py.detach(|| self.with(&values)).map_err(|e| raised(py, &e))
    }

    /// Runs.
    #[pyo3(signature = (values, plan, from_state, progress))]
    fn run(
        &self,
        py: Python<'_>,
        values: Vec<(String, Value)>,
        plan: Plan,
        from_state: Option<&Saved>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Run> {
        let ready = py.detach(|| self.ready(&values, &plan)).map_err(|e| raised(py, &e))?;
        Run::of(py, &ready, from_state.map(|s| &s.state), progress)
    }

    /// The linear model at a time, or at the steady state from there.
    #[pyo3(signature = (values, at, steady, inputs, outputs))]
    fn linearize<'py>(
        &self,
        py: Python<'py>,
        values: Vec<(String, Value)>,
        at: Option<f64>,
        steady: bool,
        inputs: Vec<String>,
        outputs: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = py.detach(|| {
            let simulation = self.with(&values)?.simulation;
            let state = simulation.state_at(at)?;
            let state = if steady { simulation.steady(&state)? } else { state };
            let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
            let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
            simulation.linearize(&state, &inputs, &outputs)
        });
        let found = found.map_err(|e| raised(py, &e))?;
        let dict = PyDict::new(py);
        for (name, matrix) in [("A", &found.a), ("B", &found.b), ("C", &found.c), ("D", &found.d)] {
            let rows: Vec<f64> = matrix.row_iter().flat_map(|r| r.iter().copied().collect::<Vec<_>>()).collect();
            let array = PyArray1::from_vec(py, rows).reshape([matrix.nrows(), matrix.ncols()])?;
            dict.set_item::<_, Bound<'_, PyArray2<f64>>>(name, array)?;
        }
        for (name, list) in [("states", &found.states), ("inputs", &found.inputs), ("outputs", &found.outputs)] {
            let all: Vec<(String, String, f64)> =
                list.iter().map(|q| (q.name.clone(), q.unit.clone(), q.value)).collect();
            dict.set_item(name, all)?;
        }
        let poles: Vec<(f64, f64)> = bramah::linear::poles(&found).into_iter().map(|p| (p.re, p.im)).collect();
        dict.set_item("poles", poles)?;
        dict.set_item("time", found.time)?;
        Ok(dict)
    }

    /// Values at the steady state reached from a time of a run.
    #[pyo3(signature = (values, at))]
    fn steady(&self, py: Python<'_>, values: Vec<(String, Value)>, at: Option<f64>) -> PyResult<Vec<(String, f64)>> {
        let found = py.detach(|| {
            let simulation = self.with(&values)?.simulation;
            let state = simulation.steady(&simulation.state_at(at)?)?;
            // The state has only what the search changed. A very short run computes everything that follows from it.
            let mut after = simulation.clone();
            after.settings().stop_time = state.time + MOMENT;
            after.settings().interval = MOMENT;
            let rows = after.run_from(&state)?.trajectory;
            Ok(rows.signals.iter().zip(&rows.columns).map(|(s, c)| (s.name.clone(), c[0])).collect())
        });
        found.map_err(|e: Error| raised(py, &e))
    }

    /// How what is recorded moves with parameters.
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        values: Vec<(String, Value)>,
        plan: Plan,
        parameters: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = py.detach(|| {
            let names: Vec<&str> = parameters.iter().map(String::as_str).collect();
            let simulation = self.ready(&values, &plan)?;
            pooled(|| simulation.sensitivity(&names))
        });
        let found = found.map_err(|e| raised(py, &e))?;
        let dict = PyDict::new(py);
        dict.set_item("time", PyArray1::from_slice(py, &found.plain.times))?;
        for ((name, size), columns) in found.parameters.iter().zip(found.columns) {
            let of = PyDict::new(py);
            // Columns are scaled by the parameter's size, and Python gets derivatives by the parameter itself.
            for (signal, column) in found.plain.signals.iter().zip(columns) {
                let by_unit: Vec<f64> = column.iter().map(|v| v / size).collect();
                of.set_item(&signal.name, PyArray1::from_vec(py, by_unit))?;
            }
            dict.set_item(name, of)?;
        }
        Ok(dict)
    }

    /// A run to be taken from step to step.
    #[pyo3(signature = (values, from_state))]
    fn stepper(
        &self,
        py: Python<'_>,
        values: Vec<(String, Value)>,
        from_state: Option<&Saved>,
    ) -> PyResult<stepper::Core> {
        let simulation = py.detach(|| self.with(&values)).map_err(|e| raised(py, &e))?.simulation;
        stepper::Core::begin(py, simulation, from_state.map(|s| s.state.clone()))
    }
}

/// The duration of the run that computes the values at a steady state (s).
const MOMENT: f64 = 1e-6;
