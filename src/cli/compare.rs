//! `bramah compare`: compares a result with a reference, signal by signal.
//!
//! Two files enter. A table or JSON on stdout and an optional picture leave. Around each reference signal lies a tube
//! of the given height and width; a signal of the result passes when it stays inside.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::messages::MessageReporter;
use super::plot::stem;
use super::{CommandFailure, CommandStatus, data, files, plot};
use bramah_analysis::experiment::seconds;
use bramah_plot::select::shown_values;
use bramah_plot::{Figure, FigurePanel, PlotBand, PlotSeries};
use bramah_results::compare::{SignalComparison, TrajectoryComparison, TubeTolerance, compare, tube};
use bramah_results::{GlobPatterns, Kind, Trajectory, glob, number};
use bramah_syntax::diag::{Code, Diagnostic, nearest};

/// Put a result beside a reference, signal by signal
#[derive(Args, Debug)]
#[command(after_help = "\
The first file is the reference: around each of its signals lies a tube, and the second file's signal has to stay in it.
The tube reaches --tolerance times the signal's range up and down, and --time-tolerance to both sides.

Examples:
  bramah compare bench.csv press.csv --map 'line.p=p_bench' --tolerance 0.02
  bramah compare old.csv new.csv --variables 'pump.*' --format json
  bramah compare bench.csv press.csv --time-column t_s,time --map 'line.p=p_bench'
  bramah compare old.csv new.csv -o difference.svg --start-time '50 ms'

Exit status: 0 all signals within tolerance, 1 a violation, 2 the files cannot be compared.")]
pub(super) struct CompareArgs {
    #[arg(value_name = "A", help = format!("The reference: {}", bramah_results::formats::names()))]
    reference: PathBuf,
    #[arg(value_name = "B", help = format!("The result: {}", bramah_results::formats::names()))]
    result: PathBuf,
    /// Signals to compare [default: those in both files]; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    variables: Vec<String>,
    /// Pairs of different name: signal of B = column of A, with its unit if it is another; may be repeated
    #[arg(long, value_name = "B=A[UNIT],...")]
    map: Vec<String>,
    /// Height of the tube as a fraction of a signal's range
    #[arg(long, visible_alias = "relative-tolerance", default_value_t = 0.002, value_name = "FRACTION", value_parser = positive)]
    tolerance: f64,
    /// Height of the tube in the signal's unit, added to the relative one
    #[arg(long, default_value_t = 0.0, value_name = "VALUE", value_parser = positive)]
    absolute_tolerance: f64,
    /// Width of the tube in seconds [default: the relative tolerance of A's duration]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time_tolerance: Option<f64>,
    /// Compare from this time on: seconds, or a time with a unit
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    start_time: Option<f64>,
    /// Compare up to this time: seconds, or a time with a unit
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    stop_time: Option<f64>,
    /// The time column of CSV and Parquet files: one name for both, or one for each [default: `time`, or the first]
    #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',', num_args = 1)]
    time_column: Vec<String>,
    /// Unit of signals in a file without units, for both files; may be repeated
    #[arg(long, value_name = "GLOB=UNIT")]
    unit: Vec<String>,
    /// How the numbers are written to stdout
    #[arg(long, value_enum, default_value_t = TableFormat::Table)]
    format: TableFormat,
    /// A picture: .svg, .png or .html
    #[arg(short = 'o', long = "output-file", visible_aliases = ["output", "plot"], value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TableFormat {
    /// For people
    Table,
    /// For programs
    Json,
}

/// Parses an argument that must not be negative. `Err` is the text that clap shows.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v >= 0.0 && v.is_finite() => Ok(v),
        _ => Err("a number that is not negative is expected".to_owned()),
    }
}

/// Runs the subcommand. Returns `Wrong` (exit code 1) when a signal leaves its tube.
///
/// The steps in order: read both files, apply the units, cut to the time window, pair the signals, compare, print,
/// draw.
///
/// `Err`: a file cannot be read, an option is wrong, or the files have no signal in common.
pub(super) fn run(args: &CompareArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let times = match args.time_column.as_slice() {
        [] => [None, None],
        [both] => [Some(both.as_str()); 2],
        [a, b] => [Some(a.as_str()), Some(b.as_str())],
        more => {
            let text = format!("`--time-column` names {} columns, and there are two files", more.len());
            return Err(CommandFailure::new(Code::BadArgument, text));
        }
    };
    let mut reference = data::result(&args.reference, times[0], messages)?;
    let mut result = data::result(&args.result, times[1], messages)?;
    name_units(&mut reference, &args.unit)?;
    name_units(&mut result, &args.unit)?;
    // Both files are cut to the window, so that ranges and tubes refer to it alone.
    let window = args.start_time.unwrap_or(f64::NEG_INFINITY)..=args.stop_time.unwrap_or(f64::INFINITY);
    reference.keep(window.clone());
    result.keep(window);
    let pairs = pairs(args, &mut reference, &result)?;
    // After the pairs: only signals that are compared matter.
    warn_of_units(&reference, &result, &pairs, messages);
    let tolerance =
        TubeTolerance { relative: args.tolerance, absolute: args.absolute_tolerance, time: args.time_tolerance };
    let comparison = compare(&reference, &result, &pairs, tolerance);
    let text = match args.format {
        TableFormat::Table => table(&comparison),
        TableFormat::Json => {
            let text = serde_json::to_string_pretty(&comparison).expect("numbers and texts always serialize");
            format!("{text}\n")
        }
    };
    files::print(&text)?;
    if let Some(path) = &args.output {
        let names = (stem(&args.reference), stem(&args.result));
        let figure = picture(&comparison, &reference, &result, &pairs, &names);
        let facts = [("reference".to_owned(), names.0.clone()), ("result".to_owned(), names.1.clone())];
        plot::write(&figure, &facts, path, messages)?;
    }
    Ok(if comparison.within { CommandStatus::Fine } else { CommandStatus::Wrong })
}

/// Applies `--unit` to signals without a unit. A unit in the file takes precedence.
fn name_units(trajectory: &mut Trajectory, assignments: &[String]) -> Result<(), CommandFailure> {
    let own: Vec<String> = trajectory.signals.iter().map(|s| s.unit.clone()).collect();
    data::apply_units(trajectory, assignments)?;
    for (signal, own) in trajectory.signals.iter_mut().zip(own).filter(|(_, own)| !own.is_empty()) {
        signal.unit = own;
    }
    Ok(())
}

/// Warns when only one signal of a pair has a unit. The numbers are then compared without conversion.
///
/// Signals that are not Real have no unit and give no warning.
fn warn_of_units(reference: &Trajectory, result: &Trajectory, pairs: &[(usize, usize)], messages: &MessageReporter) {
    for (a, b) in pairs.iter().map(|&(a, b)| (&reference.signals[a], &result.signals[b])) {
        if a.kind == Kind::Real && a.unit.is_empty() != b.unit.is_empty() {
            let unit = if a.unit.is_empty() { &b.unit } else { &a.unit };
            let (with, without) = if a.unit.is_empty() { (b, a) } else { (a, b) };
            messages.remark(&format!(
                "`{}` is in `{unit}`, the unit of `{}` is not known: the numbers are compared as they stand (--unit {}=UNIT)",
                with.name, without.name, without.name
            ));
        }
    }
}

/// Indices of the signals to compare, in the reference and in the result.
///
/// The pairs of `--map` come first, then signals of equal name. Units given in `--map` are stored in the reference, and
/// its values are converted to the units of the result. `Err`: a signal is missing, or there is no pair.
fn pairs(
    args: &CompareArgs,
    reference: &mut Trajectory,
    result: &Trajectory,
) -> Result<Vec<(usize, usize)>, CommandFailure> {
    let mut pairs = Vec::new();
    for entry in args.map.iter().flat_map(|m| glob::split_list(m)) {
        pairs.push(mapped(&entry, args, reference, result)?);
    }
    let globs = GlobPatterns::new(&args.variables);
    // With `--map` alone, only the mapped pairs are compared.
    if args.map.is_empty() || !globs.is_empty() {
        for (a, signal) in reference.signals.iter().enumerate() {
            let wanted = globs.is_empty() || globs.matches(&signal.name);
            match result.index(&signal.name) {
                Some(b) if wanted && !pairs.contains(&(a, b)) => pairs.push((a, b)),
                None if wanted && !globs.is_empty() => return Err(missing(&signal.name, &args.result, result)),
                _ => {}
            }
        }
    }
    if pairs.is_empty() {
        let text = format!("`{}` and `{}` have no signal in common", args.reference.display(), args.result.display());
        return Err(Diagnostic::new(Code::BadMap, text).help("name the pairs with --map 'B=A,...'").into());
    }
    for &(a, b) in &pairs {
        harmonise(reference, a, &result.signals[b].unit);
    }
    Ok(pairs)
}

/// One entry of `--map`, `B=A` or `B=A[UNIT]`. Stores the unit in the reference.
///
/// Returns the indices in the reference and in the result. `Err`: a signal does not exist, or the unit is invalid.
fn mapped(
    entry: &str,
    args: &CompareArgs,
    reference: &mut Trajectory,
    result: &Trajectory,
) -> Result<(usize, usize), CommandFailure> {
    let Some((ours, theirs)) = entry.split_once('=') else {
        return Err(CommandFailure::new(
            Code::BadMap,
            format!("`--map {entry}`: `B=A` is expected, a signal of each file"),
        ));
    };
    let b = result.index(ours.trim()).ok_or_else(|| missing(ours.trim(), &args.result, result))?;
    let theirs = theirs.trim();
    // A column whose name itself ends in brackets is taken as it stands.
    if let Some(a) = reference.index(theirs) {
        return Ok((a, b));
    }
    let with_unit = theirs.strip_suffix(']').and_then(|t| t.rsplit_once('['));
    let Some((name, unit)) = with_unit else { return Err(missing(theirs, &args.reference, reference)) };
    let a = reference.index(name.trim()).ok_or_else(|| missing(name.trim(), &args.reference, reference))?;
    bramah_expr::units::MeasurementUnit::parse(unit)
        .map_err(|e| CommandFailure::new(Code::BadMap, format!("`--map {entry}`: {e}")))?;
    reference.signals[a].unit = unit.trim().to_owned();
    Ok((a, b))
}

/// Converts a column of the reference to `unit`. Nothing happens when a unit is unknown or the units are of different
/// kinds.
///
/// `index` is the column. Values and unit change together.
fn harmonise(trajectory: &mut Trajectory, index: usize, unit: &str) {
    let signal = &mut trajectory.signals[index];
    if unit.is_empty() || signal.unit.is_empty() || signal.unit == unit {
        return;
    }
    let previous = std::mem::replace(&mut signal.display_unit, unit.to_owned());
    // The conversion for pictures is used; the display unit serves as its target and is restored below.
    let values = shown_values(signal, &trajectory.columns[index]);
    // Unchanged values mean that no conversion was possible, so the unit must stay too.
    if values != trajectory.columns[index] {
        trajectory.columns[index] = values;
        signal.unit = unit.to_owned();
    }
    signal.display_unit = previous;
}

/// The failure for a signal that a file does not have, with a similar name when there is one.
///
/// `path` is the file that lacks it.
fn missing(name: &str, path: &std::path::Path, trajectory: &Trajectory) -> CommandFailure {
    let diagnostic = Diagnostic::new(Code::BadMap, format!("`{}` has no signal `{name}`", path.display()));
    match nearest(name, trajectory.signals.iter().map(|s| s.name.as_str())) {
        Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
        None => diagnostic,
    }
    .into()
}

/// The comparison as an aligned text table.
///
/// Widths are counted in characters, not bytes, since units may contain other letters.
fn table(comparison: &TrajectoryComparison) -> String {
    let head = ["signal", "unit", "rmse", "normalised", "maximum", "at s", "delay s", "outside", "verdict"];
    let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
    rows.extend(comparison.signals.iter().map(row));
    let widths: Vec<usize> =
        (0..head.len()).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    let mut out = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| {
            // Names, units and verdicts are aligned left, numbers right.
            let left = i < 2 || i + 1 == head.len();
            if left { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        out.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        out.push('\n');
    }
    out
}

/// The cells of one signal, in the order of the head. Missing numbers are `-`.
///
/// A signal that could not be compared shows the reason as its verdict.
fn row(s: &SignalComparison) -> Vec<String> {
    let shown = |v: Option<f64>| v.map_or("-".to_owned(), |v| number::rounded(v, 4));
    let name = match &s.other {
        Some(other) => format!("{} = {other}", s.name),
        None => s.name.clone(),
    };
    let verdict = match (&s.reason, s.within) {
        (Some(reason), _) => reason.clone(),
        (None, true) => "ok".to_owned(),
        (None, false) => format!("outside from {} s", shown(s.first_violation)),
    };
    let percent = s.normalised.map_or("-".to_owned(), |v| format!("{} %", number::rounded(100.0 * v, 3)));
    let outside = format!("{}/{}", s.violations, s.points);
    vec![
        name,
        s.unit.clone(),
        shown(s.rmse),
        percent,
        shown(s.maximum),
        shown(s.maximum_at),
        shown(s.delay),
        outside,
        verdict,
    ]
}

/// A figure with one panel for each signal: the reference with its tube, and the result dashed.
///
/// `pairs` are the indices of the compared signals, `names` the labels of reference and result.
fn picture(
    comparison: &TrajectoryComparison,
    reference: &Trajectory,
    result: &Trajectory,
    pairs: &[(usize, usize)],
    names: &(String, String),
) -> Figure {
    let panels = comparison.signals.iter().zip(pairs).map(|(s, &(a, b))| {
        let curve = |t: &Trajectory, i: usize, name: &str, second: bool| PlotSeries {
            name: format!("{} ({name})", t.signals[i].name),
            x: t.times.clone(),
            y: t.columns[i].clone(),
            held: t.signals[i].kind.is_discrete(),
            colour: usize::from(second),
            dashed: second,
            crosses: false,
        };
        let (x, low, high) = tube(reference, a, s.tolerance, s.time_tolerance);
        let unit = if s.unit.is_empty() { String::new() } else { format!(" in {}", s.unit) };
        FigurePanel {
            x_label: "time in s".to_owned(),
            y_label: format!("{}{unit}", s.name),
            words: Vec::new(),
            series: vec![curve(reference, a, &names.0, false), curve(result, b, &names.1, true)],
            bands: vec![PlotBand { x, low, high, colour: 0 }],
        }
    });
    Figure { title: format!("{} and {}", names.0, names.1), panels: panels.collect(), shared_x: true }
}
