//! `bramah steady`: finds operating points where nothing changes, and the power balance there.
//!
//! A model enters. A table of points on stdout or as CSV, the power into each component and a Sankey diagram leave.
//!
//! With `--over` the point is followed over the values of an input or parameter, each search starting from the point
//! before. With `--transient` the mean power over an entire run is balanced instead.

use std::path::{Path, PathBuf};

use clap::Args;

use super::axes::AxisOption;
use super::linearize::{run_to, state_at};
use super::messages::MessageReporter;
use super::recorder::write_points;
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, columns, files, interrupt, model};
use bramah_analysis::balance::{self, PowerBalance};
use bramah_analysis::experiment::seconds;
use bramah_analysis::linear::{InputOutputSelection, LinearizationSetup};
use bramah_analysis::steady::{rest, run_from};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_plot::{png, sankey};
use bramah_results::{Signal, Trajectory, number};
use bramah_solve::{Settings, State, signals};
use bramah_syntax::diag::Code;

/// Operating points: where nothing changes any more, and where the power goes there
#[derive(Args, Debug)]
#[command(after_help = "\
With --over the operating point is followed from value to value of an input or parameter, each from the one before: the
way to points that cannot be reached from the start at once. Power balances count what flows into each top-level component
through its ports: positive is lost (or stored), negative comes from a source.

Examples:
  bramah steady Press.mo --from 1 --variables 'pump.*,relief.q'
  bramah steady ClosedCircuit.Reduced --over u=0:8:17 -o points.csv
  bramah steady Press.mo --from 1 --balance --sankey power.svg
  bramah steady Press.mo --transient --balance         mean powers over the entire run instead

Exit status: 0 fine; 1 the model is wrong or has no steady state there (points found are written); 2 bad arguments or
files.")]
pub(super) struct SteadyArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// Begin the search at this time of a run [default: the start]
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Follow the point over values of an input or parameter, in its unit or with one: `u=0:8:17`
    #[arg(long, value_name = "NAME=VALUES", conflicts_with = "transient")]
    over: Option<String>,
    /// Variables to show, such as 'pump.*' [default: states and top-level outputs]; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    variables: Vec<String>,
    /// Where to write the points as CSV, `-` for stdout [default: a table on stdout]
    #[arg(short, long, value_name = "CSV")]
    output_file: Option<PathBuf>,
    /// Show the power into each component
    #[arg(long)]
    balance: bool,
    /// A picture of the power from component to component: .svg or .png
    #[arg(long, value_name = "FILE")]
    sankey: Option<PathBuf>,
    /// Power over the entire run instead of at a steady state
    #[arg(long)]
    transient: bool,
}

/// Runs the subcommand. `Err`: the model is wrong or has no steady state; points found before that are written.
///
/// The steps in order: check the outputs, compile, find the points one after the other, print them, compute the power
/// balance at the last point.
pub(super) fn run(args: &SteadyArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    // The Sankey diagram has no HTML page, so the usual check of pictures does not apply.
    if let Some(path) = &args.sankey {
        let of_picture = ["svg", "png"].iter().any(|e| path.extension().is_some_and(|x| x.eq_ignore_ascii_case(e)));
        if !of_picture {
            return Err(no_picture(path));
        }
        files::ready(path)?;
    }
    args.output_file.as_deref().map_or(Ok(()), |path| files::ready_as(path, "a table", &["csv"]))?;
    let experiment = args.model.experiment(None, messages)?;
    let model = model::compile(&experiment, messages)?;
    if args.transient {
        let ports = balance::ports(&model.flat);
        let settings = Settings { wanted: balance::wanted(&ports), ..Settings::from_experiment(&model.dae.experiment) };
        let (_, rows) = run_to(&model, &settings)?;
        power(args, &model, &ports, &rows, messages)?;
        return Ok(CommandStatus::Fine);
    }
    let (over, values) = over(args, &model)?;
    let chosen =
        LinearizationSetup::new(&model.flat, &InputOutputSelection { inputs: over.clone(), outputs: Vec::new() }, &[]);
    let chosen = chosen.map_err(|diagnostics| CommandFailure { diagnostics })?;
    let wanted = wanted(args, &model, &chosen)?;
    let mut table = Trajectory::new(signals(&model.dae, &wanted));
    let moved = chosen.asked();
    let mut state = state_at(&model, args.from)?.0;
    let mut failed = None;
    // Without `--over` there is one value, which is not assigned to anything.
    for &value in &values {
        if let Some(&v) = moved.first().filter(|_| !over.is_empty()) {
            state.values[v.index()] = value;
        }
        match rest(&model, &chosen, &state, interrupt::flag()) {
            Ok(found) => {
                state = found;
                let (rows, after) = settled(&model, &chosen, &state, &wanted)?;
                // The value stands in the place of the time. The table is written with its name or as blocks.
                table.push(value, &rows);
                state = after;
            }
            Err(why) => {
                failed = Some(why);
                break;
            }
        }
    }
    // The points found so far are useful even when a later one fails.
    tell(args, &over, &table)?;
    if let Some(why) = failed {
        let mut d = why.said(&chosen);
        if !over.is_empty() {
            let value = values.get(table.len()).copied().unwrap_or(f64::NAN);
            d.notes.push(format!("at {} = {}", over[0], number::rounded(value, 6)));
        }
        return Err(d.into());
    }
    if args.balance || args.sankey.is_some() {
        let ports = balance::ports(&model.flat);
        let rows = moment(&model, &chosen, &state, &balance::wanted(&ports))?.0;
        power(args, &model, &ports, &rows, messages)?;
    }
    Ok(CommandStatus::Fine)
}

/// The quantity that `--over` names and its values. Without the option: no name, and one value that is not used.
///
/// `Err`: the entry is not of the form `NAME=VALUES`, or the values do not fit the unit.
fn over(args: &SteadyArgs, model: &CompiledModel) -> Result<(Vec<String>, Vec<f64>), CommandFailure> {
    let Some(entry) = &args.over else { return Ok((Vec::new(), vec![0.0])) };
    let entry = AxisOption::parse("--over", entry)?;
    let variable = model.flat.variables.iter().find(|v| v.name == entry.name);
    let values = entry.values(variable.and_then(|v| v.unit.as_deref()).unwrap_or(""))?;
    Ok((vec![entry.name.to_owned()], values))
}

/// The variables to show: those that `--variables` chooses, else states and top-level outputs.
///
/// Each variable appears once, in the order of declaration.
fn wanted(args: &SteadyArgs, model: &CompiledModel, chosen: &LinearizationSetup) -> Result<Vec<VarId>, CommandFailure> {
    if !args.variables.is_empty() {
        return columns::choose(&model.dae, &args.variables, &super::recorder::ResultTarget::stdout());
    }
    let outputs = (0..).map(VarId).zip(&model.flat.variables).filter(|(_, v)| v.output).map(|(v, _)| v);
    let states = chosen.plan.state_variables().filter(|v| v.index() < model.flat.variables.len());
    let mut all: Vec<VarId> = states.chain(outputs).collect();
    all.sort();
    all.dedup();
    Ok(all)
}

/// Length in seconds of the short run that shows the other variables and the speed of positions at a steady state.
const MOMENT: f64 = 1e-3;

/// Runs the model for [`MOMENT`] from a steady state and returns the rows and the last state.
///
/// `wanted` are the columns of the rows. `Err` has the diagnostics of a run that failed.
fn moment(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    state: &State,
    wanted: &[VarId],
) -> Result<(Trajectory, State), CommandFailure> {
    let ran = run_from(model, chosen, state, MOMENT, wanted, interrupt::flag());
    ran.map_err(|diagnostics| CommandFailure { diagnostics })
}

/// The values of `wanted` at a steady state, and the complete state to start the next search from.
fn settled(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    state: &State,
    wanted: &[VarId],
) -> Result<(Vec<f64>, State), CommandFailure> {
    let (rows, mut after) = moment(model, chosen, state, wanted)?;
    // The next search must begin at the same time, not a moment later.
    after.time = state.time;
    Ok((rows.columns.iter().map(|c| c[0]).collect(), after))
}

/// Prints the points, or writes them to the file of `--output-file`.
///
/// `over` is the name of the quantity that was varied, if there is one. Its values stand in the time column of `table`.
fn tell(args: &SteadyArgs, over: &[String], table: &Trajectory) -> Result<(), CommandFailure> {
    if let Some(path) = &args.output_file {
        let mut all: Vec<Signal> = over.iter().map(Signal::new).collect();
        all.extend(table.signals.iter().cloned());
        let row = |i: usize| over.iter().map(|_| table.times[i]).chain(table.columns.iter().map(|c| c[i])).collect();
        return write_points(path, &all, (0..table.len()).map(row));
    }
    let mut out = String::new();
    for (i, value) in table.times.iter().enumerate() {
        if let Some(name) = over.first() {
            out += &format!("{name} = {}\n", number::rounded(*value, 6));
        }
        for (signal, column) in table.signals.iter().zip(&table.columns) {
            out += &format!("  {} = {} {}\n", signal.name, number::rounded(column[i], 7), signal.unit);
        }
    }
    files::print(&out)
}

/// Prints the power balance and writes its Sankey diagram.
///
/// `rows` must contain the variables that the balance needs, over the time for which powers are averaged.
fn power(
    args: &SteadyArgs,
    model: &CompiledModel,
    ports: &[balance::PowerPort],
    rows: &Trajectory,
    messages: &MessageReporter,
) -> Result<(), CommandFailure> {
    let powers = balance::powers(ports, rows);
    let budgets = balance::budgets(ports, &powers, &model.graph);
    files::print(&balance_words(&budgets))?;
    let Some(path) = &args.sankey else { return Ok(()) };
    let mut streams = balance::streams(ports, &powers, &model.graph);
    // At a steady state nothing is stored, so all remaining power is lost.
    streams.extend(balance::left(&budgets, if args.transient { "lost or stored" } else { "power lost" }));
    let most = streams.iter().map(|s| s.power).fold(0.0, f64::max);
    let flows: Vec<sankey::SankeyFlow> = streams
        .into_iter()
        // Streams below a ten-thousandth of the largest would be hairlines in the picture.
        .filter(|s| s.power > 1e-4 * most)
        .map(|s| sankey::SankeyFlow { from: s.from, to: s.to, size: s.power })
        .collect();
    draw(&sankey::svg(&format!("{}: power", model.dae.class), &flows, watts), path, messages)
}

/// Writes the picture as SVG or PNG, by its name.
///
/// `Err`: another ending, or the file cannot be written.
fn draw(svg: &str, path: &Path, messages: &MessageReporter) -> Result<(), CommandFailure> {
    match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("svg") => files::write(path, svg.as_bytes())?,
        Some("png") => {
            let bytes = png::write(svg).map_err(|e| CommandFailure::new(Code::BadArgument, e))?;
            files::write(path, &bytes)?;
        }
        _ => return Err(no_picture(path)),
    }
    messages.remark(&format!("wrote {}", path.display()));
    Ok(())
}

/// The failure for a picture of another format.
fn no_picture(path: &Path) -> CommandFailure {
    let text = format!("this picture is written as .svg or .png, not as `{}`", path.display());
    CommandFailure::new(Code::BadArgument, text)
}

/// A power as text: W below 10 kW, else kW.
///
/// The value is rounded to four digits.
fn watts(power: f64) -> String {
    if power.abs() >= 1e4 {
        format!("{} kW", number::rounded(power / 1e3, 4))
    } else {
        format!("{} W", number::rounded(power, 4))
    }
}

/// The power into each component as text, then the sum of the sources and what remains.
///
/// The sum of all components shows how well the balance closes. It should be near zero.
fn balance_words(budgets: &[PowerBalance]) -> String {
    let mut out = String::from("power into components, positive is lost or stored\n");
    let most = budgets.iter().map(|b| b.net.abs()).fold(0.0, f64::max);
    let width = budgets.iter().map(|b| b.component.len()).max().unwrap_or(0);
    // Components that exchange no power would only lengthen the list.
    for b in budgets.iter().filter(|b| b.ports.iter().any(|p| p.1.abs() > 1e-9 * most)) {
        let ports: Vec<String> = b.ports.iter().map(|(n, p)| format!("{n} {}", watts(*p))).collect();
        out += &format!("  {:width$}  {:>12}   ({})\n", b.component, watts(b.net), ports.join(", "));
    }
    let sources: f64 = budgets.iter().map(|b| b.net.min(0.0)).sum();
    let rest: f64 = budgets.iter().map(|b| b.net).sum();
    out += &format!("  sources give {}, the balance closes to {}\n", watts(-sources), watts(rest));
    out
}
