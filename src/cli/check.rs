//! `bramah check`: compiles a circuit without running it, and optionally writes what a stage makes of it.
//!
//! A model enters. A one-line summary or diagnostics leave; with `--emit` also the network, the flat model or the
//! sorted equations. With `--all`, every runnable model of a package is checked and gets one row.

use clap::{Args, ValueEnum};

use super::messages::MessageReporter;
use super::recorder::write_text;
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, model};
use bramah_analysis::experiment::ExperimentSpecification;
use bramah_model::flat::FlatModel;
use bramah_model::network::ComponentGraph;
use bramah_model::structure::{BltBlock, Dae};
use bramah_plot::{network, png};
use bramah_syntax::diag::Code;

/// Check a circuit without running it: ports, balance, units, structure
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah check Press.mo
  bramah check Press.mo --set load.A='3 mm2' --deny-warnings
  bramah check Press.mo --emit svg -o press.svg       the network as a picture, also .png
  bramah check Press.mo --emit blt                    the sorted equations
  bramah check Library --all                          every model that can run, a row each

Exit status: 0 the model is complete, 1 it is wrong, 2 bad arguments or files.")]
pub(super) struct CheckArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// Check every model of a package that can run: those with an `experiment`, or all; one row each
    #[arg(long, conflicts_with_all = ["emit", "output_file"])]
    all: bool,
    /// Also write what a stage makes of the model
    #[arg(long, value_enum, value_name = "STAGE")]
    emit: Option<EmitFormat>,
    /// Where to write it [default: stdout]
    #[arg(short, long, value_name = "FILE", requires = "emit")]
    output_file: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EmitFormat {
    /// Components and connections
    Network,
    /// Components and connections as a picture
    Svg,
    /// Scalar variables and equations
    Flat,
    /// States, parameters and the sorted systems at the start, at events and between them
    Dae,
    /// The sorted equations: what is computed from what
    Blt,
}

/// Runs the subcommand. `Err` with a model error gives exit code 1.
///
/// With `--emit` the stage is written before the model is checked completely, for the stages before sorting.
pub(super) fn run(args: &CheckArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    // Checked before the model is compiled.
    if let Some(file) = &args.output_file {
        super::files::ending(std::path::Path::new(file), "this", endings(args.emit))?;
    }
    let experiment = args.model.experiment(None, messages)?;
    if args.all {
        return check_all(&experiment, messages);
    }
    // Early stages are written even when later ones fail, so that the user can look at an incomplete model. Their
    // messages are printed by `sort` below, which runs the same stages again.
    match args.emit {
        Some(EmitFormat::Network) => {
            write(args, &network_list(&messages.quietly(|quiet| model::graph(&experiment, quiet))?.1))?
        }
        Some(EmitFormat::Svg) => write_picture(args, &messages.quietly(|quiet| model::graph(&experiment, quiet))?)?,
        Some(EmitFormat::Flat) => {
            write(args, &messages.quietly(|quiet| model::flatten(&experiment, quiet))?.flat.text())?
        }
        Some(EmitFormat::Dae | EmitFormat::Blt) | None => {}
    }
    let (flat, _, dae) = model::sort(&experiment, messages)?;
    match args.emit {
        Some(EmitFormat::Dae) => write(args, &dae.dae_text())?,
        Some(EmitFormat::Blt) => write(args, &dae.blt_text())?,
        _ => {}
    }
    messages.remark(&summary(&flat, &dae));
    Ok(CommandStatus::Fine)
}

/// Checks all runnable models. Prints one row for each to stdout: `ok` with its size, or the code and text of the first
/// error.
///
/// Returns `Wrong` when any of them fails.
fn check_all(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<CommandStatus, CommandFailure> {
    let names = model::runnable(experiment)?;
    let width = names.iter().map(String::len).max().unwrap_or(0);
    let mut wrong = 0;
    for name in &names {
        let one = ExperimentSpecification { model: Some(name.clone()), ..experiment.clone() };
        // Details of each model would bury the rows; the user can check one model alone.
        let row = match model::sort(&one, &mut MessageReporter::silent()) {
            Ok((flat, _, dae)) => {
                let (equations, states) = (flat.equations.len(), dae.states.len());
                format!("ok     {}, {}", count(equations, "equation"), count(states, "state"))
            }
            Err(failure) => {
                wrong += 1;
                // Warnings may stand before the error.
                let first = failure.diagnostics.iter().find(|d| d.is_error()).or(failure.diagnostics.first());
                first.map_or_else(|| "failed".into(), |d| format!("{}   {}", d.code, d.message))
            }
        };
        write_text("-", &format!("{name:width$}  {row}\n"))?;
    }
    messages.remark(&format!("{} of {} models are fine", names.len() - wrong, names.len()));
    Ok(if wrong == 0 { CommandStatus::Fine } else { CommandStatus::Wrong })
}

/// `1 state`, `2 states`.
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// Writes a text to the file of `--output-file`, or to stdout.
fn write(args: &CheckArgs, text: &str) -> Result<(), CommandFailure> {
    write_text(args.output_file.as_deref().unwrap_or("-"), text)
}

/// Writes the network as SVG, or as PNG when the file's name ends in `.png`.
fn write_picture(args: &CheckArgs, (class, graph): &(String, ComponentGraph)) -> Result<(), CommandFailure> {
    let text = network::write(graph, class);
    match &args.output_file {
        Some(file) if file.to_lowercase().ends_with(".png") => {
            let pixels = png::write(&text).map_err(|e| CommandFailure::new(Code::BadArgument, e))?;
            super::files::write(std::path::Path::new(file), &pixels)
        }
        _ => write(args, &text),
    }
}

/// The endings that a file for this stage may have.
fn endings(emit: Option<EmitFormat>) -> &'static [&'static str] {
    match emit {
        Some(EmitFormat::Svg) => &["svg", "png"],
        Some(EmitFormat::Flat) => &["txt", "mo"],
        Some(EmitFormat::Network | EmitFormat::Dae | EmitFormat::Blt) | None => &["txt"],
    }
}

/// The network as text: one line for each component, then one for each connection.
///
/// A connection is written as in Modelica, followed by the class of its connector.
fn network_list(graph: &ComponentGraph) -> String {
    let mut out = String::new();
    for component in graph.node_weights() {
        out.push_str(&format!("{} {}\n", component.class, component.name));
    }
    for edge in graph.edge_indices() {
        let Some((a, b)) = graph.edge_endpoints(edge) else { continue };
        // The model's own ports belong to a component without name; a component that is its own port has no port name.
        let end = |n: petgraph::graph::NodeIndex, port: &str| match (graph[n].name.as_str(), port) {
            ("", port) => port.to_owned(),
            (name, "") => name.to_owned(),
            (name, port) => format!("{name}.{port}"),
        };
        let wire = &graph[edge];
        out.push_str(&format!("connect({}, {}) {}\n", end(a, &wire.from), end(b, &wire.to), wire.connector));
    }
    out
}

/// The summary line, such as `ok: Press, 120 equations, 3 states (line.p, ...), largest loop 4 (torn to 1)`.
fn summary(flat: &FlatModel, dae: &Dae) -> String {
    // Four names show which kind of states there are without filling the terminal.
    let names: Vec<&str> = dae.states.iter().take(4).map(|v| dae.variables[v.index()].name.as_str()).collect();
    let more = if dae.states.len() > 4 { ", ..." } else { "" };
    let states = match dae.states.len() {
        0 => "no states".to_owned(),
        1 => format!("1 state ({})", names.join(", ")),
        n => format!("{n} states ({}{more})", names.join(", ")),
    };
    let equations = flat.equations.len();
    let largest = dae.continuous.iter().filter_map(|b| match b {
        // Size of the loop before and after tearing.
        BltBlock::Loop(l) => Some((l.inner.len() + l.residuals.len(), l.tearing.len())),
        _ => None,
    });
    let largest = match largest.max() {
        None => "no algebraic loops".to_owned(),
        Some((size, torn)) => format!("largest loop {size} (torn to {torn})"),
    };
    format!("ok: {}, {equations} equations, {states}, {largest}", dae.class)
}
