//! `bramah partition`

use std::path::PathBuf;

use clap::Args;

use super::linearize::{restless, state_at};
use super::messages::Messages;
use super::recorder::write_text;
use super::request::ModelArgs;
use super::{Ending, Failure, files, model, plot};
use crate::analysis::linear::{Choice, Chosen};
use crate::analysis::partition::{Zones, zones};
use crate::analysis::steady::{Unsteady, settle};
use crate::analysis::{Local, grid};
use crate::compile::Model;
use crate::diag::Code;
use crate::expr::VarId;
use crate::plot::Figure;
use crate::plot::figure::{Panel, Series};
use crate::results::{CsvWriter, Signal, number};
use crate::solve::State;

/// Where a pump delivers: dead, load and saturation zone of its flow over the speed, under loads
#[derive(Args, Debug)]
#[command(after_help = "\
For each load the operating point is followed over the speeds, and the flow over the speed is taken apart: the straight line of
the load zone, the speed at which it has no flow (the end of the dead zone, where the pump just covers its leakage), and the speed
at which it reaches the flow that is not exceeded (the begin of the saturation zone). Both directions, if the speeds have both signs.

Examples:
  bramah partition Press.mo --speed N=0:3000:61 --load p_load=20,100,210bar --flow pump.Q_A
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

/// A way that is too long at once is halved so often.
const HALVINGS: u32 = 5;

/// A quantity and the values it takes.
struct Axis {
    variable: VarId,
    signal: Signal,
    values: Vec<f64>,
}

/// Flow over speed at one load.
struct Curve {
    load: Option<f64>,
    points: Vec<(f64, f64)>,
}

pub(super) fn run(args: &PartitionArgs, messages: &mut Messages) -> Result<Ending, Failure> {
    args.output_file.as_deref().map_or(Ok(()), |path| files::ready_as(path, "a table", &["csv"]))?;
    args.plot.as_deref().map_or(Ok(()), plot::ready)?;
    let experiment = args.model.experiment(None, messages)?;
    let model = model::compile(&experiment, messages)?;
    let entries: Vec<&str> = [Some(args.speed.as_str()), args.load.as_deref()].into_iter().flatten().collect();
    let names: Vec<String> = entries.iter().map(|e| e.split('=').next().unwrap_or(e).trim().to_owned()).collect();
    let choice = Choice { inputs: names, outputs: vec![args.flow.clone()] };
    let chosen = Chosen::new(&model.flat, &choice, &[]).map_err(|diagnostics| Failure { diagnostics })?;
    let mut axes = entries.iter().map(|entry| axis(&model, entry)).collect::<Result<Vec<_>, _>>()?;
    axes[0].values.sort_by(f64::total_cmp);
    let flow = position(&model, &args.flow);
    let curves = curves(&model, &chosen, &axes)?;
    let flow = signal(&model, flow);
    if let Some(path) = &args.output_file {
        write_text(&path.display().to_string(), &table(&axes, &flow, &curves)?)?;
    }
    if let Some(path) = &args.plot {
        plot::write(&picture(&model, &axes, &flow, &curves), &[], path, messages)?;
    }
    say(&model, &axes, &flow, &curves)
}

/// Reads `NAME=VALUES`.
fn axis(model: &Model, entry: &str) -> Result<Axis, Failure> {
    let wrong = |why: String| Failure::new(Code::BadArgument, format!("`{entry}`: {why}"));
    let (name, text) = entry.split_once('=').ok_or_else(|| wrong("NAME=VALUES is expected".to_owned()))?;
    let variable = position(model, name.trim());
    let signal = signal(model, variable);
    let values = grid::values(text, &signal.unit).map_err(wrong)?;
    Ok(Axis { variable, signal, values })
}

/// A variable that the choice has found before.
fn position(model: &Model, name: &str) -> VarId {
    let i = model.flat.variables.iter().position(|v| v.name == name).unwrap_or(0);
    VarId(u32::try_from(i).expect("fewer than 2^32 variables"))
}

fn signal(model: &Model, v: VarId) -> Signal {
    let variable = &model.flat.variables[v.index()];
    Signal { unit: variable.unit.as_deref().unwrap_or("").to_owned(), ..Signal::new(&variable.name) }
}

/// Follows the operating point over the speeds, at each load from the slowest speed to either side.
fn curves(model: &Model, chosen: &Chosen, axes: &[Axis]) -> Result<Vec<Curve>, Failure> {
    let loads: Vec<Option<f64>> = match axes.get(1) {
        Some(load) => load.values.iter().copied().map(Some).collect(),
        None => vec![None],
    };
    let start = state_at(model, None)?.0;
    let mut local = chosen.at(&start).map_err(|why| restless(&why.into(), chosen))?;
    let mut first = Point { x: local.state(), given: start };
    let speeds = &axes[0].values;
    let slowest = (0..speeds.len()).min_by(|&a, &b| speeds[a].abs().total_cmp(&speeds[b].abs())).unwrap_or(0);
    let mut found = Vec::with_capacity(loads.len());
    for load in loads {
        let mut points = vec![(0.0, 0.0); speeds.len()];
        let mut go = |from: &Point, i: usize| {
            let values = axes.iter().zip([Some(speeds[i]), load]);
            let target: Vec<(VarId, f64)> = values.filter_map(|(axis, value)| Some((axis.variable, value?))).collect();
            let point = reach(chosen, &mut local, from, &target, HALVINGS)
                .map_err(|why| located(restless(&why, chosen), axes, speeds[i], load))?;
            points[i] = (speeds[i], local.outputs[0]);
            Ok::<Point, Failure>(point)
        };
        first = go(&first, slowest)?;
        (slowest + 1..speeds.len()).try_fold(first.clone(), |from, i| go(&from, i))?;
        (0..slowest).rev().try_fold(first.clone(), |from, i| go(&from, i))?;
        found.push(Curve { load, points });
    }
    Ok(found)
}

/// An operating point: its states, and a state of the model for what is given.
#[derive(Clone)]
struct Point {
    x: Vec<f64>,
    given: State,
}

/// The operating point at other values: at once, or over the middle of the way. Outputs are then those of this point.
fn reach(
    chosen: &Chosen,
    local: &mut Local,
    from: &Point,
    target: &[(VarId, f64)],
    halvings: u32,
) -> Result<Point, Unsteady> {
    let moved = |share: f64| {
        let mut given = from.given.clone();
        for &(v, value) in target {
            given.values[v.index()] += share * (value - given.values[v.index()]);
        }
        given
    };
    let given = moved(1.0);
    let (theta, u) = chosen.given(&given);
    let why = match settle(local, given.time, from.x.clone(), &theta, &u) {
        Ok(found) => return Ok(Point { x: found.x, given }),
        Err(why) if halvings > 0 => why,
        Err(why) => return Err(why),
    };
    let middle = moved(0.5);
    let middle: Vec<(VarId, f64)> = target.iter().map(|(v, _)| (*v, middle.values[v.index()])).collect();
    let half = reach(chosen, local, from, &middle, halvings - 1).map_err(|_| why)?;
    reach(chosen, local, &half, target, halvings - 1)
}

/// Says at which point a search failed.
fn located(mut failure: Failure, axes: &[Axis], speed: f64, load: Option<f64>) -> Failure {
    let places = axes.iter().zip([Some(speed), load]).filter_map(|(axis, value)| Some((axis, value?)));
    let place: Vec<String> = places.map(|(axis, value)| with_unit(&axis.signal, value)).collect();
    if let Some(d) = failure.diagnostics.first_mut() {
        d.notes.push(format!("at {}", place.join(", ")));
    }
    failure
}

fn with_unit(signal: &Signal, value: f64) -> String {
    format!("{} = {} {}", signal.name, number::rounded(value, 6), signal.unit).trim_end().to_owned()
}

/// Tells the zones; a load without one is an end of its own.
fn say(model: &Model, axes: &[Axis], flow: &Signal, curves: &[Curve]) -> Result<Ending, Failure> {
    let speed = &axes[0].signal;
    let mut out = format!("{}: zones of {} over {}\n", model.dae.class, flow.name, speed.name);
    let mut none = true;
    for curve in curves {
        if let (Some(axis), Some(load)) = (axes.get(1), curve.load) {
            out += &format!("{}\n", with_unit(&axis.signal, load));
        }
        for (zones, word) in zones(&curve.points).into_iter().zip(["forward", "backward"]) {
            let Some(zones) = zones else { continue };
            none = false;
            out += &format!("  {word:8}  {}\n", words(&zones, speed, flow));
        }
    }
    if none {
        return Err(Failure::new(
            Code::BadArgument,
            format!(
                "`{}` rises with `{}` nowhere over three speeds and more: there is no load zone",
                flow.name, speed.name
            ),
        ));
    }
    write_text("-", &out)?;
    Ok(Ending::Fine)
}

fn words(zones: &Zones, speed: &Signal, flow: &Signal) -> String {
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

/// The points, one row each.
fn table(axes: &[Axis], flow: &Signal, curves: &[Curve]) -> Result<String, Failure> {
    let mut signals: Vec<Signal> = axes.get(1).map(|a| a.signal.clone()).into_iter().collect();
    signals.push(axes[0].signal.clone());
    signals.push(flow.clone());
    let mut out = Vec::new();
    let io = |e: std::io::Error| Failure::new(Code::BadArgument, e.to_string());
    let mut writer = CsvWriter::new(&mut out, &signals).map_err(io)?;
    let rows = curves.iter().flat_map(|c| c.points.iter().map(|p| (c.load, *p)));
    for (i, (load, (speed, flow))) in rows.enumerate() {
        writer.row(i as f64, load.into_iter().chain([speed, flow])).map_err(io)?;
    }
    writer.finish().map_err(io)?;
    Ok(String::from_utf8_lossy(&out).replacen("time", "point", 1))
}

fn picture(model: &Model, axes: &[Axis], flow: &Signal, curves: &[Curve]) -> Figure {
    let label = |s: &Signal| if s.unit.is_empty() { s.name.clone() } else { format!("{} in {}", s.name, s.unit) };
    let series = curves.iter().enumerate().map(|(colour, curve)| Series {
        colour,
        name: axes.get(1).zip(curve.load).map_or_else(|| flow.name.clone(), |(a, load)| with_unit(&a.signal, load)),
        x: curve.points.iter().map(|p| p.0).collect(),
        y: curve.points.iter().map(|p| p.1).collect(),
        ..Series::default()
    });
    let panel =
        Panel { x_label: label(&axes[0].signal), y_label: label(flow), series: series.collect(), ..Panel::default() };
    Figure { title: format!("{}: flow over speed", model.dae.class), panels: vec![panel], shared_x: false }
}
