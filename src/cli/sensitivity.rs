//! `bramah sensitivity`: computes how the trajectories of variables change with parameters.
//!
//! A model enters. A ranking on stdout, a CSV table of trajectories and a picture leave.
//!
//! `bramah_analysis::sensitivity` computes exact derivatives in one run, and falls back to central differences of runs
//! where they do not exist. All numbers are for a relative change of a parameter.

use std::path::PathBuf;

use clap::Args;

use super::messages::MessageReporter;
use super::recorder::{ResultTarget, write_text};
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, columns, files, interrupt, model, plot};
use bramah_analysis::experiment::seconds;
use bramah_analysis::sensitivity::{Sensitivity, SensitivityParameter, TOLERANCE, sensitivity};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::flat::{ScalarType, Variability};
use bramah_plot::{Figure, FigurePanel, PlotSeries};
use bramah_results::{CsvWriter, GlobPatterns, Signal, number};
use bramah_solve::Settings;
use bramah_syntax::diag::{Code, Diagnostic};

/// How trajectories of variables move with parameters
#[derive(Args, Debug)]
#[command(after_help = "\
Each number belongs to a relative change: the variable's change over the parameter's, times the parameter's own size. The
ranking on stdout shows by how many per cent of its range a variable moves (root mean square) when a parameter moves by
1 %. Exact derivatives in one run, across events too; where they do not hold central differences of runs, which is then said.

Examples:
  bramah sensitivity Press.mo --variables line.p,pump.Q_A
  bramah sensitivity Press.mo --parameters 'pump.*' --variables line.p --plot line.svg -o line.csv

Exit status: 0 fine; 1 the model is wrong or a run failed; 2 bad arguments or files.")]
pub(super) struct SensitivityArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// Parameters, such as 'pump.*' [default: all that no other parameter decides]; may be repeated
    #[arg(short, long, value_name = "GLOB,...")]
    parameters: Vec<String>,
    /// Variables, such as 'pump.*' [default: top-level outputs, else states]; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    variables: Vec<String>,
    /// Seconds, or a time with a unit
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    stop_time: Option<f64>,
    /// Where to write the trajectories, one column a variable and parameter: CSV, `-` for stdout
    #[arg(short, long, value_name = "CSV")]
    output_file: Option<PathBuf>,
    /// A picture of the strongest: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Curves in a panel of the picture.
const SHOWN: usize = 6;
/// Lines of the ranking.
const RANKED: usize = 20;

/// Runs the subcommand. `Err`: the model is wrong, a run failed, or an option names nothing.
///
/// Outputs are checked before the run, which may take long.
pub(super) fn run(args: &SensitivityArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    args.output_file.as_deref().map_or(Ok(()), |path| files::ready_as(path, "a table", &["csv"]))?;
    args.plot.as_deref().map_or(Ok(()), plot::ready)?;
    let experiment = args.model.experiment(None, messages)?;
    let model = model::compile(&experiment, messages)?;
    let wanted = variables(args, &model)?;
    let moved = parameters(args, &model)?;
    let mut settings = Settings { wanted, ..Settings::from_experiment(&model.dae.experiment) };
    if let Some(stop) = args.stop_time {
        if stop <= settings.start_time {
            let text = format!("the stop time {stop} s does not lie behind the start time {} s", settings.start_time);
            return Err(CommandFailure::new(Code::BadArgument, text));
        }
        settings.stop_time = stop;
        // The interval of the annotation belongs to its own stop time.
        settings.interval = (stop - settings.start_time) / 500.0;
    }
    // Derivatives need a tighter tolerance than trajectories.
    settings.tolerance = settings.tolerance.min(TOLERANCE);
    let found = sensitivity(&model, &settings, &moved, interrupt::flag())
        .map_err(|why| CommandFailure::new(Code::StepTooSmall, format!("a run failed: {why}")))?;
    let by_runs = differences(&found);
    if !by_runs.is_empty() {
        messages.remark(by_runs.trim_end());
    }
    // Either the table or the ranking: both on stdout could not be read by a program.
    match &args.output_file {
        Some(path) => write_text(&path.display().to_string(), &csv(&found)?)?,
        None => files::print(&words(&found))?,
    }
    if let Some(path) = &args.plot {
        plot::write(&picture(&found, &model.dae.class), &[], path, messages)?;
    }
    Ok(CommandStatus::Fine)
}

/// The variables to differentiate: those that `--variables` chooses, else the top-level Real outputs, else the states.
fn variables(args: &SensitivityArgs, model: &CompiledModel) -> Result<Vec<VarId>, CommandFailure> {
    if !args.variables.is_empty() {
        return columns::choose(&model.dae, &args.variables, &ResultTarget::stdout());
    }
    let all = || (0..).map(VarId).zip(&model.flat.variables);
    let outputs: Vec<VarId> = all().filter(|(_, v)| v.output && v.ty == ScalarType::Real).map(|(v, _)| v).collect();
    // Sorting may add states that the flat model does not have; they have no name that the user knows.
    let states = || model.dae.states.iter().copied().filter(|v| v.index() < model.flat.variables.len());
    Ok(if outputs.is_empty() { states().collect() } else { outputs })
}

/// The parameters to vary. Without patterns these are visible Real parameters that no other parameter decides.
///
/// The values that they have in the model are evaluated first, as they determine the size of a relative change.
///
/// `Err`: no parameter is left. Constants that the structure depends on cannot vary in a run.
fn parameters(args: &SensitivityArgs, model: &CompiledModel) -> Result<Vec<SensitivityParameter>, CommandFailure> {
    let mut values = model.system.layout.values();
    model.system.evaluate_parameters(&mut values, &[]);
    let globs = GlobPatterns::new(&args.parameters);
    let flat = &model.flat;
    let fits = |v: VarId| {
        let variable = &flat.variables[v.index()];
        let real = variable.variability == Variability::Parameter && variable.ty == ScalarType::Real;
        // A pattern may also choose a hidden or dependent parameter.
        let named = if globs.is_empty() { !variable.hidden && flat.is_root(v) } else { globs.matches(&variable.name) };
        real && named
    };
    let all = (0..u32::try_from(flat.variables.len()).expect("fewer than 2^32 variables")).map(VarId);
    let moved: Vec<SensitivityParameter> = all
        .filter(|v| fits(*v))
        .map(|v| SensitivityParameter::of(model, v, &values))
        // Infinite or huge values (a limit that is switched off) have no meaningful relative change.
        .filter(|m| m.size.is_finite() && m.size < 1e30)
        .collect();
    if moved.is_empty() {
        let d = Diagnostic::new(Code::BadArgument, "there is no such parameter that can move during runs");
        return Err(d.help("`bramah check FILE --emit flat` lists all parameters").into());
    }
    Ok(moved)
}

/// The ranking as text: a line for each of the strongest parameters.
///
/// Each line has a column for each variable: per cent of its range for 1 % of the parameter.
fn words(found: &Sensitivity) -> String {
    let names: Vec<&str> = found.plain.signals.iter().map(|s| s.name.as_str()).collect();
    let mut out = format!("per cent of the range for 1 % of the parameter: {}\n", names.join(", "));
    let width = found.parameters.iter().map(|p| p.0.len()).max().unwrap_or(0);
    let order = found.ranking();
    for &p in order.iter().take(RANKED) {
        let weights: Vec<String> =
            (0..names.len()).map(|v| format!("{:>9}", number::rounded(found.weight(p, v), 3))).collect();
        out += &format!("  {:width$} {}{}\n", found.parameters[p].0, weights.join(" "), mark(found, p));
    }
    if order.len() > RANKED {
        out += &format!("  and {} weaker ones\n", order.len() - RANKED);
    }
    out
}

/// The text behind the name of a parameter whose derivatives are differences of runs; else empty.
fn mark(found: &Sensitivity, parameter: usize) -> &'static str {
    if found.differences[parameter].is_some() { " (differences)" } else { "" }
}

/// Lists the parameters whose derivatives are differences of runs, grouped by the reason. Empty when there are none.
fn differences(found: &Sensitivity) -> String {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for ((name, _), why) in found.parameters.iter().zip(&found.differences) {
        let Some(why) = why.as_deref() else { continue };
        match reasons.iter_mut().find(|r| r.0 == why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    let all = found.parameters.len();
    let line = |(why, names): (&str, Vec<&str>)| {
        let which = if names.len() == all { String::new() } else { format!(", {}", names.join(", ")) };
        format!("by differences of runs{which}: {why}\n")
    };
    reasons.into_iter().map(line).collect()
}

/// The trajectories as CSV: a column for each parameter and variable. `Err`: the text cannot be written.
///
/// The headers have the form `d variable / d ln parameter`.
fn csv(found: &Sensitivity) -> Result<String, CommandFailure> {
    let mut out = Vec::new();
    let pairs: Vec<(usize, usize)> =
        (0..found.parameters.len()).flat_map(|p| (0..found.plain.signals.len()).map(move |v| (p, v))).collect();
    let name = |&(p, v): &(usize, usize)| {
        let (variable, parameter) = (&found.plain.signals[v].name, &found.parameters[p].0);
        Signal::new(format!("d {variable} / d ln {parameter}{}", mark(found, p)))
    };
    let signals: Vec<Signal> = pairs.iter().map(name).collect();
    let io = |e: std::io::Error| CommandFailure::new(Code::FileAccess, e.to_string());
    let mut writer = CsvWriter::new(&mut out, &signals).map_err(io)?;
    for (row, &time) in found.plain.times.iter().enumerate() {
        writer.row(time, pairs.iter().map(|&(p, v)| found.columns[p][v][row])).map_err(io)?;
    }
    writer.finish().map_err(io)?;
    Ok(String::from_utf8_lossy(&out).into_owned())
}

/// A figure with one panel for each variable, showing the parameters with the strongest influence on it.
fn picture(found: &Sensitivity, class: &str) -> Figure {
    let panels = (0..found.plain.signals.len()).map(|v| {
        let mut order: Vec<usize> = (0..found.parameters.len()).collect();
        order.sort_by(|&a, &b| found.weight(b, v).total_cmp(&found.weight(a, v)));
        let curves = order.iter().take(SHOWN).enumerate().map(|(colour, &p)| PlotSeries {
            name: format!("{}{}", found.parameters[p].0, mark(found, p)),
            x: found.plain.times.clone(),
            y: found.columns[p][v].clone(),
            colour,
            ..PlotSeries::default()
        });
        let signal = &found.plain.signals[v];
        let unit = if signal.unit.is_empty() { String::new() } else { format!(" in {}", signal.unit) };
        FigurePanel {
            x_label: "time in s".to_owned(),
            y_label: format!("{}{unit}", signal.name),
            series: curves.collect(),
            ..FigurePanel::default()
        }
    });
    Figure {
        title: format!("{class}: change for a relative change of a parameter"),
        panels: panels.collect(),
        shared_x: true,
    }
}
