//! `bramah plot`: draws results as SVG, PNG or an interactive HTML page.
//!
//! Result files enter, one picture leaves. `bramah_plot` chooses the panels and draws them. Other subcommands use
//! `write`, [`ready`] and [`write_picture`] for their own pictures.

use std::path::{Path, PathBuf};

use clap::Args;

use super::messages::MessageReporter;
use super::{CommandFailure, CommandStatus, data, files};
use bramah_plot::map::{self, map};
use bramah_plot::select::{FigureOptions, LabelledTrajectory, UnitSystem, figure};
use bramah_plot::{Figure, html, png, svg};
use bramah_results::{GlobPatterns, Trajectory};
use bramah_syntax::diag::{Code, Diagnostic};

/// Draw results: SVG, PNG, or a page with zoom and hover
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah plot press.csv -o press.svg
  bramah plot press.mat --variables 'pump.*,line.p' -o press.png
  bramah plot run1.csv run2.csv -o report.html       the same variables of both, together
  bramah plot press.csv --panel line.p --panel pump.Q_A,relief.q     panels composed by hand
  bramah plot press.csv --x line.p --variables relief.q    flow over pressure
  bramah plot p*.csv --x N --y dp --variables eta    a map: each file is a row, at its value of dp
  bramah plot press.csv --unit '*.p=Pa:bar'          units for a file that carries none")]
pub(super) struct PlotArgs {
    #[arg(required = true, value_name = "RESULT", help = format!("Result files: {}", bramah_results::formats::names()))]
    results: Vec<PathBuf>,
    /// Variables to draw, such as 'pump.*,line.p'; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    variables: Vec<String>,
    /// A panel with these variables, in this order, instead of panels by unit; may be repeated
    #[arg(long, value_name = "GLOB,...", conflicts_with_all = ["variables", "y"])]
    panel: Vec<String>,
    /// Where to write: .svg, .png or .html; `-` writes SVG to stdout [default: RESULT.svg]
    #[arg(short = 'o', long = "output-file", visible_alias = "output", value_name = "FILE")]
    output: Option<PathBuf>,
    /// The variable on the horizontal axis instead of time
    #[arg(long, value_name = "NAME")]
    x: Option<String>,
    /// The variable on the vertical axis of a map with lines of equal value: each result is a row of it
    #[arg(long, value_name = "NAME", requires = "x")]
    y: Option<String>,
    /// Text above the picture
    #[arg(long, default_value = "")]
    title: String,
    /// The time column of CSV files [default: `time`, or the first]
    #[arg(long, value_name = "NAME")]
    time_column: Option<String>,
    /// Unit, and unit shown, of variables in a file without units; may be repeated
    #[arg(long, value_name = "GLOB=UNIT[:SHOWN]")]
    unit: Vec<String>,
    /// Units of variables that name none for people: `engineering` shows bar, l/min, rev/min, mm and degC
    #[arg(long, value_name = "given|engineering", value_parser = unit_system, default_value = "given")]
    unit_system: UnitSystem,
}

/// Parses `--unit-system`. `Err` is the text that clap shows.
fn unit_system(text: &str) -> Result<UnitSystem, String> {
    match text {
        "given" => Ok(UnitSystem::AsGiven),
        "engineering" => Ok(UnitSystem::Engineering),
        _ => Err("write `given` or `engineering`".to_owned()),
    }
}

/// Runs the subcommand. `Err`: a file cannot be read, or nothing matches what is to be drawn.
pub(super) fn run(args: &PlotArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let mut trajectories = Vec::new();
    for path in &args.results {
        let mut trajectory = data::result(path, args.time_column.as_deref(), messages)?;
        // Units of the user come before the unit system, which only converts known units.
        data::apply_units(&mut trajectory, &args.unit)?;
        args.unit_system.apply(&mut trajectory);
        trajectories.push(trajectory);
    }
    let labels: Vec<String> = args.results.iter().map(|p| stem(p)).collect();
    let choice = FigureOptions {
        variables: GlobPatterns::new(&args.variables),
        panels: args.panel.iter().map(|list| GlobPatterns::new(&[list])).collect(),
        x: args.x.clone(),
        title: args.title.clone(),
    };
    let runs: Vec<LabelledTrajectory<'_>> =
        labels.iter().zip(&trajectories).map(|(label, trajectory)| LabelledTrajectory { label, trajectory }).collect();
    let output = args.output.clone().unwrap_or_else(|| args.results[0].with_extension("svg"));
    // With both axes given, the results are rows of a map and not curves.
    if let (Some(x), Some(y)) = (&args.x, &args.y) {
        let drawn = map(&runs, &GlobPatterns::new(&args.variables), x, y, &args.title);
        let drawn = drawn.map_err(|e| not_found(&e, args, &trajectories))?;
        write_map(&map::write(&drawn), &output, messages)?;
        return Ok(CommandStatus::Fine);
    }
    let selected = figure(&runs, &choice).map_err(|e| not_found(&e, args, &trajectories))?;
    if selected.left_out > 0 {
        messages.remark(&format!("{} more variables are not drawn; choose with --variables", selected.left_out));
    }
    let facts = [("files".to_owned(), labels.join(", "))];
    write(&selected.figure, &facts, &output, messages)?;
    Ok(CommandStatus::Fine)
}

/// Writes a figure in the format that the file's name asks for. `facts` are listed below the picture of a page.
///
/// `Err`: the ending is not one of a picture, or the file cannot be written.
pub(super) fn write(
    figure: &Figure,
    facts: &[(String, String)],
    path: &Path,
    messages: &MessageReporter,
) -> Result<(), CommandFailure> {
    let bytes = match PictureFormat::of(path)? {
        PictureFormat::Page => html::write(figure, facts).into_bytes(),
        format => drawn(svg::write(figure), format)?,
    };
    deliver(path, &bytes, messages)
}

/// Checks before long work that a picture of this name can be written.
pub(super) fn ready(path: &Path) -> Result<(), CommandFailure> {
    PictureFormat::of(path).and_then(|_| files::ready(path))
}

/// The formats of pictures.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PictureFormat {
    /// A vector picture.
    Svg,
    /// Pixels.
    Png,
    /// An HTML page with zoom and hover.
    Page,
}

impl PictureFormat {
    /// The format for a file's name; SVG for stdout (`-`). `Err`: another ending.
    fn of(path: &Path) -> Result<PictureFormat, CommandFailure> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            _ if path == Path::new("-") => Ok(PictureFormat::Svg),
            "svg" => Ok(PictureFormat::Svg),
            "png" => Ok(PictureFormat::Png),
            "html" | "htm" => Ok(PictureFormat::Page),
            _ => {
                let text = format!("a picture is written as .svg, .png or .html, not as `{}`", path.display());
                Err(CommandFailure::new(Code::BadArgument, text))
            }
        }
    }
}

/// Encodes an SVG picture in a format. `Err`: it cannot be drawn as pixels.
fn drawn(picture: String, format: PictureFormat) -> Result<Vec<u8>, CommandFailure> {
    match format {
        PictureFormat::Png => png::write(&picture).map_err(|e| CommandFailure::new(Code::BadArgument, e)),
        PictureFormat::Svg | PictureFormat::Page => Ok(picture.into_bytes()),
    }
}

/// Writes the bytes to a file, or to stdout for `-`. Only a file is announced, since stdout carries the data.
fn deliver(path: &Path, bytes: &[u8], messages: &MessageReporter) -> Result<(), CommandFailure> {
    if path == Path::new("-") {
        return files::print(&String::from_utf8_lossy(bytes));
    }
    files::write(path, bytes)?;
    messages.remark(&format!("wrote {}", path.display()));
    Ok(())
}

/// Writes a picture that is drawn already. A page shows it, and the curves of `figure` below.
pub(super) fn write_picture(
    picture: &str,
    figure: &Figure,
    path: &Path,
    messages: &MessageReporter,
) -> Result<(), CommandFailure> {
    let bytes = match PictureFormat::of(path)? {
        PictureFormat::Page => html::write_around(figure, &[], picture).into_bytes(),
        format => drawn(picture.to_owned(), format)?,
    };
    deliver(path, &bytes, messages)
}

/// Writes a map as SVG or PNG. `Err`: an HTML page is asked for, which maps do not have.
fn write_map(picture: &str, path: &Path, messages: &MessageReporter) -> Result<(), CommandFailure> {
    if PictureFormat::of(path)? == PictureFormat::Page {
        return Err(CommandFailure::new(Code::BadArgument, "a map is written as .svg or .png"));
    }
    write_picture(picture, &Figure::default(), path, messages)
}

/// The file name without folder and extension; used as the label of a result.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The failure when nothing can be drawn, with similar names and a list of the first variables.
///
/// `why` is the message of the drawing function.
fn not_found(why: &str, args: &PlotArgs, trajectories: &[Trajectory]) -> CommandFailure {
    let names = || trajectories.iter().flat_map(|t| t.signals.iter().map(|s| s.name.as_str()));
    let mut diagnostic = Diagnostic::new(Code::BadArgument, why);
    let asked = GlobPatterns::new(&[args.variables.as_slice(), args.panel.as_slice()].concat());
    // Every name that the user wrote and that no file has gets its own suggestion.
    let wanted = args.x.as_deref().into_iter().chain(args.y.as_deref()).chain(asked.unused(names()));
    for name in wanted.filter(|n| !names().any(|k| k == *n)) {
        if let Some(near) = bramah_syntax::diag::nearest(name, names()) {
            diagnostic = diagnostic.help(format!("`{name}`: did you mean `{near}`?"));
        }
    }
    let shown: Vec<String> = names().take(10).map(|n| format!("`{n}`")).collect();
    diagnostic.note(format!("there are {} variables: {} ...", names().count(), shown.join(", "))).into()
}
