//! `bramah sweep`: runs one model many times with varied parameters and collects the results in a table.
//!
//! An experiment file with a section `[sweep]` enters; a CSV or Parquet table and an optional picture leave. With
//! `--merge`, tables of parts enter and one table leaves.
//!
//! Runs are distributed over all cores with rayon. A mutex guards the open file and the collected rows. Each finished
//! run appends a line at once, so that an interrupted sweep continues with the open runs.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::Ordering;

use clap::Args;
use rayon::prelude::*;

use super::files::{self, access};
use super::messages::MessageReporter;
use super::recorder::ResultTarget;
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus, columns, interrupt, model, plot};
use bramah_analysis::experiment::{ExperimentSpecification, ParameterSweep, SamplingMethod};
use bramah_analysis::sweep::{SweepPlan, SweepTable, fingerprint, indices, matrix, scatter};
use bramah_circuit::compiled::CompiledModel;
use bramah_model::flat;
use bramah_plot::matrix::write as draw;
use bramah_results::parquet::write_table;
use bramah_results::{CsvWriter, Trajectory, number};
use bramah_solve::{Settings, signals};
use bramah_syntax::diag::{Code, Diagnostic};

/// Many runs of one model, on all cores, into one table
#[derive(Args, Debug)]
#[command(after_help = "\
The experiment file says in [sweep] which parameters vary how, and which results are kept (docs/sweep.md). Each finished
run is a line of the table at once: after an interruption the same command goes on where it stopped. A run that fails is a
line with its reason.

Examples:
  bramah sweep press.toml -o press.csv --plot press.svg
  bramah sweep press.toml --part 3/10          one share, into press.3-of-10.csv
  bramah sweep --merge -o all.csv press.*-of-10.csv

Exit status: 0 all runs are in the table, failed ones among them; 1 the model is wrong, the sweep was interrupted, or
runs are missing in what was joined;
2 bad arguments or files.")]
pub(super) struct SweepArgs {
    /// The experiment file; with --merge the tables to join
    #[arg(required = true, value_name = "EXPERIMENT.toml")]
    files: Vec<String>,
    /// Value of a parameter for all runs; may be repeated
    #[arg(short, long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// The table: .csv, or .parquet beside the .csv in which runs are kept [default: the experiment's name with .csv]
    #[arg(short, long, value_name = "FILE")]
    output_file: Option<PathBuf>,
    /// A picture of the results over the parameters: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Also write the rows of each run into this folder, as run_N.csv
    #[arg(long, value_name = "DIR")]
    trajectories: Option<PathBuf>,
    /// Only the K-th of N shares of the runs
    #[arg(long, value_name = "K/N", value_parser = part)]
    part: Option<(usize, usize)>,
    /// Join tables of parts
    #[arg(long, conflicts_with_all = ["part", "trajectories", "set"])]
    merge: bool,
    /// Runs at the same time [default: as many as there are cores]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
}

/// Parses `--part K/N`. `Err` is the text that clap shows.
///
/// K counts from 1 and is at most N.
fn part(text: &str) -> Result<(usize, usize), String> {
    let both = text.split_once('/').and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
    both.filter(|&(k, n): &(usize, usize)| k >= 1 && k <= n)
        .ok_or_else(|| "K/N is expected, with 1 <= K <= N".to_owned())
}

/// Runs the subcommand.
///
/// Failed runs are rows with their reason and give no error. `Err`: the model or the experiment is wrong, a file cannot
/// be written, or the sweep was interrupted.
pub(super) fn run(args: &SweepArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    if let Some(path) = &args.output_file {
        files::ending(path, "a table of runs", &["csv", "parquet"])?;
    }
    if args.merge {
        return merge(args, messages);
    }
    let [file] = &args.files[..] else {
        return Err(CommandFailure::new(
            Code::BadArgument,
            "one experiment file is expected; several tables need --merge",
        ));
    };
    let model_args = ModelArgs {
        file: file.clone(),
        model: None,
        set: args.set.iter().map(|s| assignment(s)).collect::<Result<_, _>>()?,
        library: Vec::new(),
        external: Vec::new(),
        deny_warnings: false,
    };
    // Checked before the runs, which may take hours.
    args.plot.as_deref().map_or(Ok(()), plot::ready)?;
    let experiment = model_args.experiment(None, messages)?;
    let Some(sweep) = experiment.sweep.clone() else {
        let d = Diagnostic::new(Code::BadExperiment, format!("`{file}` has no section `[sweep]`"));
        return Err(d.help("say there which parameters vary; docs/sweep.md shows how").into());
    };
    let model = model::compile(&experiment, messages)?;
    let plan = SweepPlan::new(&model, &sweep).map_err(|diagnostics| CommandFailure { diagnostics })?;
    let settings = settings(args, &experiment, &model, &plan)?;
    let output = with_lines(&output(args, file));
    let table = execute(args, &model, &plan, &settings, &output, messages)?;
    report(args, &sweep, &plan, &table, &output, messages)
}

/// Parses `NAME=VALUE` of `--set`. `Err`: there is no `=`.
fn assignment(text: &str) -> Result<(String, String), CommandFailure> {
    let wrong = || CommandFailure::new(Code::BadArgument, format!("`--set {text}`: NAME=VALUE is expected"));
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

/// The file of the table. A part without a given name gets its numbers: `press.3-of-10.csv`.
fn output(args: &SweepArgs, file: &str) -> PathBuf {
    let whole = args.output_file.clone().unwrap_or_else(|| Path::new(file).with_extension("csv"));
    match args.part {
        Some((k, n)) if args.output_file.is_none() => whole.with_extension(format!("{k}-of-{n}.csv")),
        _ => whole,
    }
}

/// The settings of each run. `Err`: a pattern of the variables matches nothing.
///
/// Values of the experiment take precedence over the model's annotation.
fn settings(
    args: &SweepArgs,
    experiment: &ExperimentSpecification,
    model: &CompiledModel,
    plan: &SweepPlan,
) -> Result<Settings, CommandFailure> {
    let annotation = &model.dae.experiment;
    let mut settings = Settings::from_experiment(&flat::ExperimentAnnotation {
        start_time: experiment.start_time.or(annotation.start_time),
        stop_time: experiment.stop_time.or(annotation.stop_time),
        interval: experiment.output_interval.or(annotation.interval),
        tolerance: experiment.relative_tolerance.or(annotation.tolerance),
    });
    settings.wanted.clone_from(&plan.wanted);
    // Trajectories hold more variables than the results of the sweep need.
    if args.trajectories.is_some() {
        let target = ResultTarget::stdout();
        let more = columns::choose(&model.dae, &experiment.variables, &target)?;
        settings.wanted.extend(more.into_iter().filter(|v| !plan.wanted.contains(v)));
    }
    Ok(settings)
}

/// Whether the table is written as Parquet.
fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"))
}

/// The CSV file that takes a line for each finished run. For Parquet it is a CSV beside it, because Parquet cannot
/// grow.
fn with_lines(output: &Path) -> PathBuf {
    if is_parquet(output) { output.with_extension("csv") } else { output.to_owned() }
}

/// Writes the complete table as Parquet, when that is asked for.
///
/// Called when all runs are done, as Parquet is written at once.
fn write_parquet(args: &SweepArgs, table: &SweepTable) -> Result<(), CommandFailure> {
    let Some(path) = args.output_file.as_ref().filter(|path| is_parquet(path)) else { return Ok(()) };
    let mut bytes = Vec::new();
    write_table(&mut bytes, &table.typed()).map_err(|e| access(path, "written", &e))?;
    files::write(path, &bytes)
}

/// The table with the rows of an earlier, interrupted start of the same sweep.
///
/// `path` is the CSV file of the sweep.
///
/// A missing file gives the `empty` table. `Err`: the file is no such table, or belongs to another sweep.
fn resumed(path: &Path, empty: SweepTable) -> Result<SweepTable, CommandFailure> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(empty) };
    let other = |why: &str| {
        let d = Diagnostic::new(Code::FileAccess, format!("`{}` exists, and {why}", path.display()));
        CommandFailure::from(d.help("remove it, or choose another name with --output-file"))
    };
    let table = SweepTable::read(&text).map_err(|e| other(&e))?;
    let mut whole = empty;
    // `merge` compares the fingerprints, so rows of another sweep are refused.
    whole.merge(table).map_err(|e| other(&e))?;
    Ok(whole)
}

/// Performs the open runs and returns the complete table.
///
/// Runs that are in the table already are not repeated. A failed run counts as done; its row has the reason.
///
/// `Err`: the table cannot be written, belongs to another sweep, or the user pressed Ctrl-C.
fn execute(
    args: &SweepArgs,
    model: &CompiledModel,
    plan: &SweepPlan,
    settings: &Settings,
    output: &Path,
    messages: &MessageReporter,
) -> Result<SweepTable, CommandFailure> {
    let names: Vec<String> =
        plan.varied.iter().map(|v| v.name.clone()).chain(plan.results.iter().map(|r| r.0.clone())).collect();
    let mut words = names.clone();
    words.push(model.dae.class.clone());
    words.extend(plan.results.iter().map(|r| format!("{:?}", r.1)));
    // Everything that changes the results enters the fingerprint.
    words.push(format!("{} {} {}", settings.start_time, settings.stop_time, settings.tolerance));
    words.extend(args.set.iter().cloned());
    let empty = SweepTable::new(fingerprint(&words, &plan.samples), plan.samples.len(), names);
    let mut table = resumed(output, empty)?;
    let (k, n) = args.part.unwrap_or((1, 1));
    // A part takes every n-th run, so its runs are spread over all samples.
    let all: Vec<usize> = (1..=plan.samples.len()).filter(|run| (run - 1) % n == k - 1).collect();
    let open: Vec<usize> = all.iter().copied().filter(|run| !table.rows.contains_key(run)).collect();
    if open.len() < all.len() {
        messages.remark(&format!(
            "{} of {} runs are in {} already",
            all.len() - open.len(),
            all.len(),
            output.display()
        ));
    }
    if let Some(folder) = &args.trajectories {
        std::fs::create_dir_all(folder).map_err(|e| access(folder, "made", &e))?;
    }
    // Rewritten, because the last line may be incomplete after an interruption. A failure here also comes before the
    // runs.
    files::write(output, table.text().as_bytes())?;
    let appending = std::fs::OpenOptions::new().append(true).open(output).map_err(|e| access(output, "written", &e))?;
    let shared = Mutex::new((appending, Vec::new(), None));
    let work = || open.par_iter().for_each(|&run| one(args, model, plan, settings, run, &shared));
    match args.jobs {
        Some(jobs) => rayon::ThreadPoolBuilder::new()
            .num_threads(jobs.into())
            .build()
            .map_err(|e| CommandFailure::new(Code::BadArgument, e.to_string()))?
            .install(work),
        None => work(),
    }
    let (_, rows, failed) = shared.into_inner().expect("no run panics while it holds the table");
    table.rows.extend(rows);
    if let Some(error) = failed {
        return Err(access(output, "written", &error));
    }
    if interrupt::flag().load(Ordering::Relaxed) {
        let text = format!("interrupted after {} of {} runs", table.rows.len(), all.len());
        return Err(Diagnostic::new(Code::Interrupted, text).help("the same command goes on from here").into());
    }
    // Lines were appended as runs ended; the complete file has them in order.
    files::write(output, table.text().as_bytes())?;
    Ok(table)
}

/// The open table, the rows of this start, and the first error of writing; shared by all threads.
type SweepOutput = Mutex<(std::fs::File, Vec<(usize, (Vec<f64>, String))>, Option<std::io::Error>)>;

/// Performs one run and appends its line to the table. `run` counts from 1.
///
/// A failed run gives NaN for all results and its reason in the column `status`.
///
/// Called on a thread of rayon. The lock is taken only after the run, for writing the line.
fn one(
    args: &SweepArgs,
    model: &CompiledModel,
    plan: &SweepPlan,
    settings: &Settings,
    run: usize,
    shared: &SweepOutput,
) {
    let stop = interrupt::flag();
    if stop.load(Ordering::Relaxed) {
        return;
    }
    let outcome = plan.run(model, settings, run - 1, stop);
    // An interrupted run has no result and is repeated at the next start.
    if stop.load(Ordering::Relaxed) {
        return;
    }
    let (results, status) = match outcome {
        Ok((results, rows)) => {
            let written = args.trajectories.as_ref().map(|folder| trajectory(folder, run, model, settings, &rows));
            // A trajectory that cannot be written is noted in the column `status`; the results are kept.
            (results, written.and_then(Result::err).map_or_else(|| "ok".to_owned(), |e| e.to_string()))
        }
        Err(why) => (vec![f64::NAN; plan.results.len()], why),
    };
    let values: Vec<f64> = plan.samples[run - 1].iter().copied().chain(results).collect();
    let mut shared = shared.lock().expect("no run panics while it holds the table");
    if let Err(e) = shared.0.write_all(SweepTable::line(run, &values, &status).as_bytes()) {
        // Only the first error is kept; it is usually the cause of the others.
        shared.2.get_or_insert(e);
    }
    shared.1.push((run, (values, status)));
}

/// Writes the rows of one run to `run_N.csv`.
///
/// The columns are those of the settings: the results of the sweep and the variables of the experiment.
fn trajectory(
    folder: &Path,
    run: usize,
    model: &CompiledModel,
    settings: &Settings,
    rows: &Trajectory,
) -> std::io::Result<()> {
    let file = std::io::BufWriter::new(std::fs::File::create(folder.join(format!("run_{run}.csv")))?);
    let mut writer = CsvWriter::new(file, &signals(&model.dae, &settings.wanted))?;
    for (i, &time) in rows.times.iter().enumerate() {
        writer.row(time, rows.columns.iter().map(|c| c[i]))?;
    }
    writer.finish().map(|_| ())
}

/// Prints the summary, the Sobol indices where the plan has them, and draws the picture.
///
/// The exit code is 0 even when runs failed, because their rows say so.
fn report(
    args: &SweepArgs,
    sweep: &ParameterSweep,
    plan: &SweepPlan,
    table: &SweepTable,
    output: &Path,
    messages: &MessageReporter,
) -> Result<CommandStatus, CommandFailure> {
    write_parquet(args, table)?;
    let failed = table.rows.values().filter(|r| r.1 != "ok").count();
    let bad = if failed > 0 { format!(", {failed} failed (see the column `status`)") } else { String::new() };
    messages.remark(&format!("{} runs in {}{bad}", table.rows.len(), output.display()));
    // The indices need every run of the plan, so a part cannot compute them.
    if sweep.method == SamplingMethod::Sobol && table.rows.len() == table.runs {
        files::print(&sobol_words(sweep, plan, table))?;
    }
    if let Some(path) = &args.plot {
        let title = format!("{} runs", table.rows.len());
        let drawn = draw(&matrix(table, plan.varied.len(), &title));
        plot::write_picture(&drawn, &scatter(table, plan.varied.len(), &title), path, messages)?;
    }
    Ok(CommandStatus::Fine)
}

/// First-order and total Sobol indices of each result, with their confidence, as text.
///
/// A result that does not vary, or of which too few runs succeeded, has no indices.
fn sobol_words(sweep: &ParameterSweep, plan: &SweepPlan, table: &SweepTable) -> String {
    let d = plan.varied.len();
    let mut out = String::new();
    for (r, (name, _)) in plan.results.iter().enumerate() {
        out += &format!("{name}: share of the variance, alone and in all, with the 95 % confidence\n");
        match indices(&table.column(d + r), d, sweep.seed) {
            None => out += "  not known: it does not vary, or too few runs succeeded\n",
            Some(found) => {
                for (v, i) in plan.varied.iter().zip(found) {
                    let shown = |x: f64| number::rounded(x, 3);
                    let (first, total) = (shown(i.first), shown(i.total));
                    let (fc, tc) = (number::rounded(i.first_confidence, 2), number::rounded(i.total_confidence, 2));
                    out += &format!("  {}: {first} +- {fc}, {total} +- {tc}\n", v.name);
                }
            }
        }
    }
    out
}

/// Joins the tables of parts. Returns `Wrong` (exit code 1) when runs are missing.
///
/// The parts may be given in any order and may be incomplete.
///
/// `Err`: a table cannot be read, or the tables belong to different sweeps.
fn merge(args: &SweepArgs, messages: &MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let Some(output) = &args.output_file else {
        return Err(CommandFailure::new(Code::BadArgument, "--merge needs --output-file for the joined table"));
    };
    let mut whole: Option<SweepTable> = None;
    for file in &args.files {
        let path = Path::new(file);
        let text = std::fs::read_to_string(path).map_err(|e| access(path, "read", &e))?;
        let wrong = |e: String| CommandFailure::new(Code::BadData, format!("`{file}` cannot be joined: {e}"));
        let table = SweepTable::read(&text).map_err(wrong)?;
        match &mut whole {
            None => whole = Some(table),
            Some(whole) => whole.merge(table).map_err(wrong)?,
        }
    }
    let Some(whole) = whole else { return Ok(CommandStatus::Fine) };
    files::write(&with_lines(output), whole.text().as_bytes())?;
    write_parquet(args, &whole)?;
    let missing = whole.runs - whole.rows.len().min(whole.runs);
    messages.remark(&format!("{} runs in {}, {missing} missing", whole.rows.len(), output.display()));
    Ok(if missing == 0 { CommandStatus::Fine } else { CommandStatus::Wrong })
}
