//! `bramah linearize`: computes a linear model at an operating point, or a quasi-linear form over a grid of points.
//!
//! A model enters. Matrices (JSON, CSV, Matlab or Modelica), a summary and pictures of poles and frequency responses
//! leave.
//!
//! The operating point is the state of a run at a given time, or the steady state reached from there. [`state_at`] and
//! [`run_to`] are also used by `steady` and `partition`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::axes::AxisOption;
use super::messages::MessageReporter;
use super::recorder::write_text;
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, files, interrupt, model, plot};
use bramah_analysis::experiment::seconds;
use bramah_analysis::linear::{self, InputOutputSelection, LinearizationSetup, StateSpace};
use bramah_analysis::steady;
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::structure::StateChoice;
use bramah_plot::Figure;
use bramah_results::glob::split_list;
use bramah_results::{Trajectory, number};
use bramah_solve::{Control, Settings, State, signals, simulate};
use bramah_syntax::diag::{Code, Diagnostic};

/// A model near an operating point: A, B, C, D, poles and zeros; or its quasi-linear form over operating points
#[derive(Args, Debug)]
#[command(after_help = "\
Inputs are top-level inputs or parameters. With --schedule the model becomes x' = A(rho) x + B(rho) (u, 1) over a grid of
scheduling quantities, each a multiple of one state or input: exact where the model is affine in the rest, and said so.

Examples:
  bramah linearize Rig.mo --at 0.5 --inputs w_ref --outputs p --bode bode.svg
  bramah linearize Press.mo --steady -o press.json
  bramah linearize ClosedCircuit.Reduced --inputs f,u --schedule p,n_p,n_m,f --grid p=10:150:8bar --grid f=10,20,30

Exit status: 0 fine; 1 the model is wrong, or has no values or no steady state there; 2 bad arguments or files.")]
pub(super) struct LinearizeArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// The operating point: a time of the run, as `2`, `t=2` or `500 ms` [default: the start]
    #[arg(long, value_name = "TIME", value_parser = time, conflicts_with = "steady", allow_hyphen_values = true)]
    at: Option<f64>,
    /// The operating point: the steady state reached from the start
    #[arg(long)]
    steady: bool,
    /// Inputs: top-level inputs or parameters [default: all top-level inputs]; may be repeated
    #[arg(long, value_name = "NAME,...")]
    inputs: Vec<String>,
    /// Outputs: any variables [default: top-level outputs, else the states]; may be repeated
    #[arg(long, value_name = "NAME,...")]
    outputs: Vec<String>,
    /// Scheduling quantities of the quasi-linear form
    #[arg(long, value_name = "NAME,...")]
    schedule: Vec<String>,
    /// Values of a scheduling quantity, in its unit or with one: `p=1e6,2e6` or `n_p=200:1000:5` (from, to, count)
    #[arg(long, value_name = "NAME=VALUES")]
    grid: Vec<String>,
    /// Where to write: .json, .csv, .mat or .mo; `-` for JSON on stdout
    #[arg(short, long, value_name = "FILE")]
    output_file: Option<String>,
    /// A picture of the frequency responses: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    bode: Option<PathBuf>,
    /// A picture of the poles: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    poles: Option<PathBuf>,
}

/// Parses `--at`: a time in seconds or with a unit, also as `t=2`. `Err` is the text that clap shows.
fn time(text: &str) -> Result<f64, String> {
    let text = text.trim();
    seconds(text.strip_prefix("t=").or_else(|| text.strip_prefix("time=")).unwrap_or(text))
}

/// Runs the subcommand. `Err`: the model is wrong, or has no values or no steady state at the point.
pub(super) fn run(args: &LinearizeArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    fits(args)?;
    let experiment = args.model.experiment(None, messages)?;
    let model = model::compile(&experiment, messages)?;
    if args.schedule.is_empty() {
        return linear_model(args, &model, messages);
    }
    quasi_linear(args, &model, messages)
}

/// Checks the combination of the options and that all output files can be written, before the model is compiled.
///
/// `Err` explains which options exclude each other.
fn fits(args: &LinearizeArgs) -> Result<(), CommandFailure> {
    let wrong = |text: String, cause: &str, help: &str| {
        Err(CommandFailure::from(Diagnostic::new(Code::BadArgument, text).note(cause).help(help)))
    };
    if args.schedule.is_empty() {
        if let Some(grid) = args.grid.first() {
            return wrong(
                format!("`--grid {grid}` has no meaning without `--schedule`"),
                "a grid holds the values of a scheduling quantity of the quasi-linear form",
                "name the quantity: `--schedule NAME,...`",
            );
        }
    } else {
        let pictures = [("--bode", args.bode.is_some()), ("--poles", args.poles.is_some())];
        let others = pictures.into_iter().chain([("--outputs", !args.outputs.is_empty())]);
        if let Some((flag, _)) = others.into_iter().find(|o| o.1) {
            return wrong(
                format!("`{flag}` has no meaning with `--schedule`"),
                "the quasi-linear form has matrices for each point of its grid, and no outputs",
                "leave `--schedule` out for the linear model at one point",
            );
        }
    }
    let pictures = args.bode.iter().chain(&args.poles);
    pictures.map(PathBuf::as_path).try_for_each(plot::ready)?;
    let Some(path) = &args.output_file else { return Ok(()) };
    if args.schedule.is_empty() {
        linear_ending(path)?
    } else {
        quasi_linear_ending(path)?
    };
    files::ready(Path::new(path))
}

/// Splits repeatable options with comma-separated names into one list.
fn list(flags: &[String]) -> Vec<String> {
    flags.iter().flat_map(|f| split_list(f)).collect()
}

/// Linearizes at one point and writes the model, its summary and the pictures.
///
/// `Err`: the names of inputs or outputs are wrong, the point has no values, or a file cannot be written.
fn linear_model(
    args: &LinearizeArgs,
    model: &CompiledModel,
    messages: &MessageReporter,
) -> Result<CommandStatus, CommandFailure> {
    let choice = InputOutputSelection { inputs: list(&args.inputs), outputs: list(&args.outputs) };
    let chosen =
        LinearizationSetup::new(&model.flat, &choice, &[]).map_err(|diagnostics| CommandFailure { diagnostics })?;
    let state = operating_point(args, model, &chosen)?;
    let linear = linear::linearize(model, &chosen, &state).map_err(|e| no_values(&e.to_string()))?;
    let words = linear::words(&linear);
    // With an output file stdout stays free, as the file may be stdout itself (`-`).
    match &args.output_file {
        Some(path) => {
            write(&linear, path, messages)?;
            messages.remark(words.trim_end());
        }
        None => files::print(&words)?,
    }
    // Both pictures need the poles.
    let poles = linear::poles(&linear);
    let picture = |figure: &Figure, path: &Path| {
        plot::write(figure, &[("model".to_owned(), linear.class.clone())], path, messages)
    };
    if let Some(path) = &args.bode {
        if linear.inputs.is_empty() {
            let d = Diagnostic::new(
                Code::BadArgument,
                format!("`{}` has no input whose responses --bode could draw", linear.class),
            );
            return Err(d.help("name one: `--inputs NAME`, a top-level input or a parameter").into());
        }
        picture(&linear::bode(&linear, &poles), path)?;
    }
    if let Some(path) = &args.poles {
        picture(&linear::plane(&linear, &poles), path)?;
    }
    Ok(CommandStatus::Fine)
}

/// The format of a linear model for a file name. `Err`: an unknown ending.
fn linear_ending(path: &str) -> Result<&'static str, CommandFailure> {
    files::ending(Path::new(path), "a linear model", &["json", "csv", "mat", "mo"])
}

/// The format of a quasi-linear form for a file name. `Err`: an unknown ending.
fn quasi_linear_ending(path: &str) -> Result<&'static str, CommandFailure> {
    files::ending(Path::new(path), "a quasi-linear form", &["json", "csv", "mat", "mo"])
}

/// Writes a linear model in the format of the file's name.
///
/// JSON is the format of stdout.
fn write(linear: &StateSpace, path: &str, messages: &MessageReporter) -> Result<(), CommandFailure> {
    match linear_ending(path)? {
        "csv" => write_text(path, &linear::csv(linear))?,
        "mo" => write_text(path, &linear::modelica(linear, &plot::stem(Path::new(path))))?,
        "mat" => files::write(Path::new(path), &linear::mat(linear))?,
        _ => write_text(path, &pretty(&linear.json()))?,
    }
    if path != "-" {
        messages.remark(&format!("wrote {path}"));
    }
    Ok(())
}

/// JSON with indentation and a line break at its end.
fn pretty(value: &serde_json::Value) -> String {
    let text = serde_json::to_string_pretty(value).expect("numbers and texts always serialize");
    format!("{text}\n")
}

/// The state at the time that `--at` gives, or the steady state reached from it.
fn operating_point(
    args: &LinearizeArgs,
    model: &CompiledModel,
    chosen: &LinearizationSetup,
) -> Result<State, CommandFailure> {
    let state = state_at(model, args.at)?.0;
    if !args.steady {
        return Ok(state);
    }
    steady::rest(model, chosen, &state, interrupt::flag()).map_err(|why| why.said(chosen).into())
}

/// The failure when the model has no finite derivatives at the point.
fn no_values(why: &str) -> CommandFailure {
    CommandFailure::new(Code::NonFinite, format!("the model has no derivatives at this point: {why}"))
}

/// Runs the model up to a time in seconds and returns the state and the rows. `None`: only the initial state.
///
/// `Err`: the time lies before the start, or the run failed.
pub(super) fn state_at(model: &CompiledModel, time: Option<f64>) -> Result<(State, Trajectory), CommandFailure> {
    let mut settings = Settings::from_experiment(&model.dae.experiment);
    if let Some(time) = time.filter(|t| *t < settings.start_time) {
        let (time, start) = (number::rounded(time, 9), number::rounded(settings.start_time, 9));
        let d = Diagnostic::new(Code::BadArgument, format!("the run is not known at {time} s"));
        return Err(d.note(format!("it starts at {start} s")).help("name a time from the start on").into());
    }
    settings.stop_time = time.unwrap_or(settings.start_time);
    // The rows are only a by-product here; a coarse grid suffices.
    settings.interval = (settings.stop_time - settings.start_time) / 200.0;
    run_to(model, &settings)
}

/// Runs the model with these settings and returns its last state and its rows. `Err` has the diagnostics of a failed
/// run.
pub(super) fn run_to(model: &CompiledModel, settings: &Settings) -> Result<(State, Trajectory), CommandFailure> {
    let mut rows = Trajectory::new(signals(&model.dae, &settings.wanted));
    let mut reselect = |choice: &StateChoice| model.with_states(choice);
    let mut control =
        Control { interrupt: Some(interrupt::flag()), reselect: Some(&mut reselect), ..Control::default() };
    let run = simulate(&model.system, settings, &[], None, &mut rows, &mut control);
    if run.end.is_success() { Ok((run.state, rows)) } else { Err(CommandFailure { diagnostics: run.diagnostics }) }
}

/// Computes the quasi-linear form over the grid and writes it.
///
/// `Err`: the model has no such form with these quantities, or has no values at a point of the grid.
fn quasi_linear(
    args: &LinearizeArgs,
    model: &CompiledModel,
    messages: &MessageReporter,
) -> Result<CommandStatus, CommandFailure> {
    let rho = list(&args.schedule);
    let chosen = LinearizationSetup::scheduled(&model.flat, &list(&args.inputs), &rho)
        .map_err(|diagnostics| CommandFailure { diagnostics })?;
    let state = operating_point(args, model, &chosen)?;
    let ranges = ranges(model, &chosen, &state)?;
    let grid = grid(args, &chosen)?;
    let found = linear::schedule(&chosen, &state, &grid, &ranges)?;
    let words = found.words();
    let Some(path) = &args.output_file else {
        files::print(&words)?;
        return Ok(CommandStatus::Fine);
    };
    match quasi_linear_ending(path)? {
        "csv" => write_text(path, &found.csv())?,
        "mo" => write_text(path, &found.modelica(&plot::stem(Path::new(path))))?,
        "mat" => files::write(Path::new(path), &found.mat())?,
        _ => write_text(path, &pretty(&found.json()))?,
    }
    messages.remark(words.trim_end());
    Ok(CommandStatus::Fine)
}

/// Smallest and largest value of each state and input. The quasi-linear form is checked at random points between them.
///
/// The values are those of a run, widened by a tenth of their range. Quantities that do not move get a fifth of their
/// value on both sides.
fn ranges(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    state: &State,
) -> Result<Vec<(f64, f64)>, CommandFailure> {
    let mut settings = Settings::from_experiment(&model.dae.experiment);
    let all: Vec<VarId> = chosen.quantities().collect();
    // The quantities may include variables that only the linearization knows; the run has no columns for them.
    settings.wanted = all.iter().copied().filter(|v| v.index() < model.dae.variables.len()).collect();
    let (_, rows) = run_to(model, &settings)?;
    let range = |k: usize, v: VarId| {
        let column = rows.columns.get(k).map_or(&[] as &[f64], Vec::as_slice);
        let now = state.values[v.index()];
        let (low, high) = column.iter().fold((now, now), |(l, h), x| (l.min(*x), h.max(*x)));
        // A change below the tolerance of the run may be an error of the integration.
        let moves = high - low > settings.tolerance * high.abs().max(low.abs());
        let margin = if moves { 0.1 * (high - low) } else { 0.2 * now.abs() };
        (low - margin, high + margin)
    };
    Ok(all.iter().enumerate().map(|(k, &v)| range(k, v)).collect())
}

/// The values of each scheduling quantity, in its unit; `None` where the user gives no grid.
///
/// `Err`: an entry names no scheduling quantity, or one has two grids.
fn grid(args: &LinearizeArgs, chosen: &LinearizationSetup) -> Result<Vec<Option<Vec<f64>>>, CommandFailure> {
    let mut all: Vec<Option<Vec<f64>>> = vec![None; chosen.rho().len()];
    for text in &args.grid {
        let entry = AxisOption::parse("--grid", text)?;
        let k = chosen.rho().iter().position(|r| r.name == entry.name);
        let k = k.ok_or_else(|| entry.wrong("it is not a scheduling quantity"))?;
        if all[k].is_some() {
            let d = Diagnostic::new(Code::BadArgument, format!("`--grid {text}`: this quantity has a grid already"));
            return Err(d.help(format!("give all its values at once: `--grid {}=1,2,5`", entry.name)).into());
        }
        all[k] = Some(entry.values(&chosen.rho()[k].unit)?);
    }
    Ok(all)
}
