//! Answers about circuits: what a circuit offers (parameters, inputs, variables, picture), and simulations as jobs.
//!
//! `serve` calls [`open`] for `/api/circuit` and [`run`] for `/api/run`. Values travel as text in the unit shown on the
//! page.

use serde::{Deserialize, Serialize};

use super::super::model::described;
use super::folder::ServerFolder;
use super::http::{HttpRefusal, HttpRequest, HttpResponse};
use super::jobs::{JobOutput, ServerJob, ServerJobs};
use bramah_analysis::experiment::seconds;
use bramah_circuit::Parameter;
use bramah_circuit::Simulation;
use bramah_model::compile::{Request, graph};
use bramah_model::instance::Override;
use bramah_plot::select::{FigureOptions, LabelledTrajectory, UnitSystem, figure, shown_unit, shown_values};
use bramah_plot::{html, network};
use bramah_results::{GlobPatterns, Kind, Signal, number};
use bramah_solve::{Control, Progress, missing_inputs};
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Code, Diagnostic, nearest};
use bramah_syntax::world::DiskWorld;

/// Significant digits of parameter values on the page. The shown text is also what the page sends back.
const DIGITS: usize = 9;

/// The JSON answer of `/api/circuit`.
#[derive(Serialize)]
struct CircuitDescription {
    /// File or package in the folder; empty for a model that ships.
    source: String,
    /// Full name of the class.
    class: String,
    /// Description of the class; may be empty.
    description: String,
    /// The network as SVG.
    picture: String,
    /// Rendered warnings of the compilation.
    messages: String,
    /// Start time of the run in seconds.
    start: f64,
    /// Stop time of the run in seconds.
    stop: f64,
    /// Parameters with their values.
    parameters: Vec<ParameterDescription>,
    /// Variables that can be drawn.
    variables: Vec<VariableDescription>,
    /// Top-level inputs, which need a value for a run.
    inputs: Vec<VariableDescription>,
}

/// A variable as the page shows it.
#[derive(Serialize)]
struct VariableDescription {
    /// Full name, such as `pump.V`.
    name: String,
    /// Unit of the values in the model.
    unit: String,
    /// Unit in which the page shows values.
    shown_unit: String,
    /// Description in the declaration; may be empty.
    description: String,
}

/// A parameter that the page can change.
#[derive(Serialize)]
struct ParameterDescription {
    /// Name, units and description. In the JSON they are fields of the parameter itself.
    #[serde(flatten)]
    named: VariableDescription,
    /// `real`, `integer`, `boolean` or `enumeration`.
    kind: &'static str,
    /// Names of an enumeration's literals; empty for other kinds.
    literals: Vec<String>,
    /// Value in the unit of the model.
    value: String,
    /// Value in the shown unit.
    shown: String,
    /// Lower limit in the shown unit; empty when there is none.
    min: String,
    /// Upper limit in the shown unit; empty when there is none.
    max: String,
    /// Changing it requires the model to be compiled again.
    structural: bool,
    /// No other parameter decides its value. A study that lists no parameters treats these as uncertain.
    root: bool,
}

/// Compiles a circuit and describes it as JSON.
///
/// The request names the circuit by `source` and `class`.
///
/// A circuit with errors gives status 422 with the messages, and its network when the components could be read.
pub(super) fn open(folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let request = folder.request(ask.value("source"), ask.value("class"))?;
    let simulation = match Simulation::compile(&DiskWorld, &request) {
        Ok(simulation) => simulation,
        Err(error) => {
            // The picture needs no equations, so the user can see an unfinished circuit.
            let drawn = graph(&DiskWorld, &request).value.map(|(class, graph)| network::write(&graph, &class));
            let wrong = serde_json::json!({ "messages": error.full(), "picture": drawn.unwrap_or_default() });
            return Ok(HttpResponse::json(&wrong).with_status(422));
        }
    };
    let (settings, class) = (simulation.run_settings(), simulation.model().flat.class.clone());
    Ok(HttpResponse::json(&CircuitDescription {
        source: ask.value("source").to_owned(),
        description: described(&request, &class),
        picture: network::write(&simulation.model().graph, &class),
        class,
        messages: full(simulation.sources(), &simulation.diagnostics),
        start: settings.start_time,
        stop: settings.stop_time,
        parameters: simulation.parameters().iter().map(offered).collect(),
        variables: simulation.variables().iter().map(named).collect(),
        inputs: simulation.inputs().iter().map(named).collect(),
    }))
}

/// Describes a variable for the page.
fn named(signal: &Signal) -> VariableDescription {
    VariableDescription {
        name: signal.name.clone(),
        unit: signal.unit.clone(),
        shown_unit: shown_unit(signal).to_owned(),
        description: signal.description.clone(),
    }
}

/// Describes a parameter for the page.
fn offered(parameter: &Parameter) -> ParameterDescription {
    let signal = &parameter.signal;
    let shown = |value: f64| match &signal.kind {
        Kind::Boolean => (value != 0.0).to_string(),
        // Literals are numbered from 1.
        Kind::Enumeration(literals) => literals.get(value as usize - 1).cloned().unwrap_or_default(),
        Kind::Real | Kind::Integer => number::rounded(shown_values(signal, &[value])[0], DIGITS),
    };
    // Unlimited parameters have infinite limits, which the page shows as empty fields.
    let limit = |limit: Option<f64>| limit.filter(|l| l.is_finite()).map_or_else(String::new, shown);
    let (kind, literals) = match &signal.kind {
        Kind::Real => ("real", Vec::new()),
        Kind::Integer => ("integer", Vec::new()),
        Kind::Boolean => ("boolean", Vec::new()),
        Kind::Enumeration(literals) => ("enumeration", literals.clone()),
    };
    ParameterDescription {
        named: named(signal),
        kind,
        literals,
        value: number::text(parameter.value),
        shown: shown(parameter.value),
        min: limit(parameter.min),
        max: limit(parameter.max),
        structural: parameter.structural,
        root: parameter.root,
    }
}

/// The JSON body of `/api/run`.
#[derive(Deserialize)]
struct SimulationRequest {
    // A missing field takes its default, so the page sends only what the user has set.
    /// File or package in the folder; empty for a model that ships.
    #[serde(default)]
    source: String,
    /// The class to run.
    class: String,
    /// Values of parameters as text, by name.
    #[serde(default)]
    set: std::collections::BTreeMap<String, String>,
    /// Stop time in seconds or with a unit; empty for that of the model.
    #[serde(default)]
    stop: String,
    /// Patterns of variables to draw; empty for the usual choice.
    #[serde(default)]
    variables: Vec<String>,
    /// `engineering` shows bar, l/min and the like; anything else the units of the model.
    #[serde(default)]
    units: String,
}

/// Starts a job that simulates a circuit. `Err`: the request cannot be read, or the stop time is no time.
pub(super) fn run(folder: &ServerFolder, ask: &HttpRequest, jobs: &ServerJobs) -> Result<HttpResponse, HttpRefusal> {
    let wanted: SimulationRequest = ask.json()?;
    // Checked before the job starts, so that the error is the answer to this request.
    let stop = match wanted.stop.trim() {
        "" => None,
        text => Some(seconds(text).map_err(|why| HttpRefusal::new(422, why))?),
    };
    let given = |(name, value): (&String, &String)| Override { name: name.clone(), value: value.clone() };
    let overrides = wanted.set.iter().map(given).collect();
    let request = Request { overrides, ..folder.request(&wanted.source, &wanted.class)? };
    jobs.start(move |job| simulated(&request, &wanted, stop, job))
}

/// The job: compiles, runs and draws. `Err` is the text that the page shows.
///
/// The number of variables that were not drawn and a summary of the run are appended to the messages.
fn simulated(
    request: &Request,
    wanted: &SimulationRequest,
    stop: Option<f64>,
    job: &ServerJob,
) -> Result<JobOutput, String> {
    job.at("compiling", None);
    let compiled = Simulation::compile(&DiskWorld, request);
    let mut simulation = compiled.map_err(|error| error.full())?;
    if let Some(stop) = stop {
        simulation.stop_time(stop);
    }
    let patterns = GlobPatterns::new(&wanted.variables);
    // Both checks precede the run, which may take long.
    all_given(&simulation)?;
    record(&mut simulation, &patterns)?;
    let (start, length) = (
        simulation.run_settings().start_time,
        simulation.run_settings().stop_time - simulation.run_settings().start_time,
    );
    // Always true: the job is stopped by the flag, not by the callback.
    let mut progress = |now: &Progress| {
        job.at("simulating", Some((now.time - start) / length));
        true
    };
    let mut control = Control { interrupt: Some(job.stop()), progress: Some(&mut progress), ..Control::default() };
    // The outcome is kept however the run ends, so that a failed run still shows its curves up to the failure.
    let mut outcome = simulation.run_kept(None, &mut control).map_err(|error| error.to_string())?;
    job.at("drawing", None);
    let messages = full(simulation.sources(), &outcome.diagnostics);
    let trajectory = &mut outcome.trajectory;
    let units = if wanted.units == "engineering" { UnitSystem::Engineering } else { UnitSystem::AsGiven };
    units.apply(trajectory);
    let label = simulation.model().flat.class.clone();
    let choice = FigureOptions { variables: patterns, title: label.clone(), ..FigureOptions::default() };
    let drawn = figure(&[LabelledTrajectory { label: &label, trajectory }], &choice);
    let drawn = drawn.map_err(|why| format!("{messages}\nnothing to draw: {why}").trim().to_owned())?;
    let left = match drawn.left_out {
        0 => String::new(),
        n => format!("{n} more variables are not drawn: name those to draw"),
    };
    let s = &outcome.statistics;
    let work = format!(
        "until {} s: {} steps, {} {}, {} s",
        number::text(outcome.state.time),
        s.steps,
        s.events,
        if s.events == 1 { "event" } else { "events" },
        number::rounded(s.solve_s, 3)
    );
    let messages = [messages, left, work].into_iter().filter(|m| !m.is_empty()).collect::<Vec<_>>().join("\n\n");
    let facts = wanted.set.iter().map(|(name, value)| (name.clone(), value.clone())).collect::<Vec<_>>();
    Ok(JobOutput { messages, page: html::write(&drawn.figure, &facts), files: Vec::new() })
}

/// Checks that every input has a constant value; the page has fields for them. `Err` names those without.
fn all_given(simulation: &Simulation) -> Result<(), String> {
    let help = |_: &str| vec!["give it a constant value below \"Inputs\", or recorded ones in a study".to_owned()];
    let missing = missing_inputs(&simulation.model().dae, &[], help);
    if missing.is_empty() { Ok(()) } else { Err(full(simulation.sources(), &missing)) }
}

/// Records the variables that match the patterns; without patterns the simulation's own choice.
///
/// `Err`: a pattern matches no variable.
fn record(simulation: &mut Simulation, patterns: &GlobPatterns) -> Result<(), String> {
    if patterns.is_empty() {
        return Ok(());
    }
    let all: Vec<String> = simulation.variables().into_iter().map(|s| s.name).collect();
    if let Some(pattern) = patterns.unused(all.iter().map(String::as_str)).first() {
        let d = Diagnostic::new(Code::BadArgument, format!("`{pattern}` matches no variable"));
        let d = match nearest(pattern, all.iter().map(String::as_str)) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help("`*` stands for any text: `cyl.*`"),
        };
        return Err(full(simulation.sources(), &[d]));
    }
    let chosen: Vec<&str> = all.iter().map(String::as_str).filter(|n| patterns.matches(n)).collect();
    simulation.record(&chosen).map(drop).map_err(|error| error.to_string())
}
