//! `bramah partition`: finds the dead, load and saturation zones of a pump's flow over its speed.
//!
//! A model, the values of a speed and optionally of a load enter. The zones as text, a table of points and a picture
//! leave.
//!
//! For each load the steady state is followed from speed to speed. `bramah_analysis::partition` computes the points and
//! fits the zones.

use std::path::PathBuf;

use clap::Args;

use super::axes::AxisOption;
use super::linearize::state_at;
use super::messages::MessageReporter;
use super::recorder::{write_points, write_text};
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, files, model, plot};
use bramah_analysis::linear::{InputOutputSelection, LinearizationSetup, outputs};
use bramah_analysis::partition::{FlowCharacteristic, curve, zones};
use bramah_analysis::steady::{OperatingPoint, SteadyStateError};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_plot::Figure;
use bramah_plot::figure::{FigurePanel, PlotSeries};
use bramah_results::{Signal, number};
use bramah_solve::signals;
use bramah_syntax::diag::Code;

/// Where a pump delivers: dead, load and saturation zone of its flow over the speed, under loads
#[derive(Args, Debug)]
#[command(after_help = "\
For each load the operating point is followed over the speeds, and the flow over the speed is taken apart: the straight line of
the load zone, the speed at which it has no flow (the end of the dead zone, where the pump just covers its leakage), and the speed
at which it reaches the flow that is not exceeded (the beginning of the saturation zone). Both directions, if the speeds have both signs.

Examples:
  bramah partition Press.mo --set speed.height=0 --speed speed.offset=0:300:61 --load load.A=1,2mm2 --flow load.q
  bramah partition ServoPump.FlowZones --set command.height=0 --speed command.offset=-3600:3600:145 \\
      --load p_load=2,10,21MPa --flow Q --plot zones.svg

Exit status: 0 fine; 1 the model is wrong, has no steady state somewhere, or no load zone; 2 bad arguments or files.")]
pub(super) struct PartitionArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// The speed: an input or parameter and its values, in its unit or with one: `N=-3000:3000:121` (from, to, count)
    #[arg(long, value_name = "NAME=VALUES", allow_hyphen_values = true)]
    speed: String,
    /// The load: an input or parameter and its values [default: as the model has it]
    #[arg(long, value_name = "NAME=VALUES", allow_hyphen_values = true)]
    load: Option<String>,
    /// The flow: any variable, positive where the speed is
    #[arg(long, value_name = "NAME")]
    flow: String,
    /// Where to write the points as CSV
    #[arg(short, long, value_name = "CSV")]
    output_file: Option<PathBuf>,
    /// A picture of flow over speed: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// A speed or load: a variable and the values that it takes.
struct PartitionAxis {
    /// The input or parameter.
    variable: VarId,
    /// Its name and unit.
    signal: Signal,
    /// Values in its unit.
    values: Vec<f64>,
}

/// The flow over the speed at one load.
struct FlowCurve {
    /// The load in its unit; `None` when no load is varied.
    load: Option<f64>,
    /// Speed and flow of each point.
    points: Vec<(f64, f64)>,
}

/// Runs the subcommand. `Err`: the model is wrong, a steady state is not found, or there is no load zone.
pub(super) fn run(args: &PartitionArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    args.output_file.as_deref().map_or(Ok(()), |path| files::ready_as(path, "a table", &["csv"]))?;
    args.plot.as_deref().map_or(Ok(()), plot::ready)?;
    let experiment = args.model.experiment(None, messages)?;
    let model = model::compile(&experiment, messages)?;
    let entries = [Some(("--speed", &args.speed)), args.load.as_ref().map(|load| ("--load", load))];
    let entries = entries.into_iter().flatten().map(|(option, text)| AxisOption::parse(option, text));
    let entries: Vec<AxisOption<'_>> = entries.collect::<Result<_, _>>()?;
    let inputs = entries.iter().map(|entry| entry.name.to_owned()).collect();
    // Both quantities must be inputs of the linearization, which the search for a steady state uses.
    let choice = InputOutputSelection { inputs, outputs: vec![args.flow.clone()] };
    let chosen =
        LinearizationSetup::new(&model.flat, &choice, &[]).map_err(|diagnostics| CommandFailure { diagnostics })?;
    let axes = entries.iter().zip(chosen.asked()).map(|(entry, variable)| axis(&model, entry, variable));
    let mut axes: Vec<PartitionAxis> = axes.collect::<Result<_, _>>()?;
    // The steady state is followed from speed to speed, so they must be in order and occur once.
    axes[0].values.sort_by(f64::total_cmp);
    axes[0].values.dedup();
    let flow = outputs(&model.flat, &choice.outputs)?;
    let flow = signals(&model.dae, &flow).remove(0);
    let curves = curves(&model, &chosen, &axes)?;
    if let Some(path) = &args.output_file {
        // The load is the outer loop of the table, so it comes before the speed.
        let columns: Vec<Signal> = axes.iter().rev().map(|axis| &axis.signal).chain([&flow]).cloned().collect();
        let rows = curves.iter().flat_map(|c| c.points.iter().map(|p| c.load.into_iter().chain([p.0, p.1]).collect()));
        write_points(path, &columns, rows)?;
    }
    if let Some(path) = &args.plot {
        plot::write(&picture(&model, &axes, &flow, &curves), &[], path, messages)?;
    }
    say(&model, &axes, &flow, &curves)
}

/// The variable with its values converted to its unit.
fn axis(model: &CompiledModel, entry: &AxisOption<'_>, variable: VarId) -> Result<PartitionAxis, CommandFailure> {
    let signal = signals(&model.dae, &[variable]).remove(0);
    Ok(PartitionAxis { variable, values: entry.values(&signal.unit)?, signal })
}

/// Computes the curve at each load.
///
/// Each curve starts from the first point of the curve before it, which is a good initial guess. `Err` names the speed
/// and load where no steady state was found.
fn curves(
    model: &CompiledModel,
    chosen: &LinearizationSetup,
    axes: &[PartitionAxis],
) -> Result<Vec<FlowCurve>, CommandFailure> {
    // Without `--load` there is one curve at the load of the model.
    let loads: Vec<Option<f64>> = match axes.get(1) {
        Some(load) => load.values.iter().copied().map(Some).collect(),
        None => vec![None],
    };
    let given = state_at(model, None)?.0;
    let mut local = chosen.at(&given).map_err(|why| SteadyStateError::from(why).said(chosen))?;
    let mut from = OperatingPoint { x: local.state(), given };
    let mut found = Vec::with_capacity(loads.len());
    for load in loads {
        let speeds = (axes[0].variable, &axes[0].values[..]);
        let at = axes.get(1).zip(load).map(|(axis, value)| (axis.variable, value));
        let curve = curve(chosen, &mut local, &from, speeds, at);
        let (first, points) =
            curve.map_err(|missed| located(missed.why.said(chosen).into(), axes, missed.speed, load))?;
        from = first;
        found.push(FlowCurve { load, points });
    }
    Ok(found)
}

/// Adds the speed and load at which a search failed to the failure.
fn located(mut failure: CommandFailure, axes: &[PartitionAxis], speed: f64, load: Option<f64>) -> CommandFailure {
    let places = axes.iter().zip([Some(speed), load]).filter_map(|(axis, value)| Some((axis, value?)));
    let place: Vec<String> = places.map(|(axis, value)| with_unit(&axis.signal, value)).collect();
    if let Some(d) = failure.diagnostics.first_mut() {
        d.notes.push(format!("at {}", place.join(", ")));
    }
    failure
}

/// `name = value unit` with six significant digits.
fn with_unit(signal: &Signal, value: f64) -> String {
    format!("{} = {} {}", signal.name, number::rounded(value, 6), signal.unit).trim_end().to_owned()
}

/// Prints the zones of each curve.
///
/// A curve has zones for positive speeds, negative ones or both.
///
/// `Err`: no curve has a load zone, in any direction.
fn say(
    model: &CompiledModel,
    axes: &[PartitionAxis],
    flow: &Signal,
    curves: &[FlowCurve],
) -> Result<CommandStatus, CommandFailure> {
    let speed = &axes[0].signal;
    let mut out = format!("{}: zones of {} over {}\n", model.dae.class, flow.name, speed.name);
    let mut none = true;
    for curve in curves {
        if let (Some(axis), Some(load)) = (axes.get(1), curve.load) {
            out += &format!("{}\n", with_unit(&axis.signal, load));
        }
        // The two results are for positive and negative speeds.
        for (zones, word) in zones(&curve.points).into_iter().zip(["forward", "backward"]) {
            let Some(zones) = zones else { continue };
            none = false;
            out += &format!("  {word:8}  {}\n", words(&zones, speed, flow));
        }
    }
    if none {
        return Err(CommandFailure::new(
            Code::BadArgument,
            format!(
                "`{}` rises with `{}` nowhere over three speeds and more: there is no load zone",
                flow.name, speed.name
            ),
        ));
    }
    write_text("-", &out)?;
    Ok(CommandStatus::Fine)
}

/// The zones of one direction as a line of text.
///
/// Units follow the numbers where the quantities have one.
fn words(zones: &FlowCharacteristic, speed: &Signal, flow: &Signal) -> String {
    let n = |value: f64| number::rounded(value, 5);
    let saturation = match zones.saturation {
        Some(at) => format!("saturation zone from {} {}", n(at), speed.unit),
        None => "no saturation up to the last speed".to_owned(),
    };
    let unit = match speed.unit.as_str() {
        "" => format!("{} per 1", flow.unit),
        unit => format!("({})/({unit})", flow.unit),
    };
    let line = format!("{} {unit} in the load zone (R2 {})", n(zones.slope), number::rounded(zones.straight, 6));
    format!("dead zone to {} {}, {line}, {saturation}", n(zones.dead), speed.unit)
        .replace(" ,", ",")
        .trim_end()
        .to_owned()
}

/// A picture with one curve for each load.
///
/// The legend names the loads.
fn picture(model: &CompiledModel, axes: &[PartitionAxis], flow: &Signal, curves: &[FlowCurve]) -> Figure {
    let label = |s: &Signal| if s.unit.is_empty() { s.name.clone() } else { format!("{} in {}", s.name, s.unit) };
    let series = curves.iter().enumerate().map(|(colour, curve)| PlotSeries {
        colour,
        name: axes.get(1).zip(curve.load).map_or_else(|| flow.name.clone(), |(a, load)| with_unit(&a.signal, load)),
        x: curve.points.iter().map(|p| p.0).collect(),
        y: curve.points.iter().map(|p| p.1).collect(),
        ..PlotSeries::default()
    });
    let panel = FigurePanel {
        x_label: label(&axes[0].signal),
        y_label: label(flow),
        series: series.collect(),
        ..FigurePanel::default()
    };
    Figure { title: format!("{}: flow over speed", model.dae.class), panels: vec![panel], shared_x: false }
}
