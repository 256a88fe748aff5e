//! `bramah simulate`: compiles a model, runs it once and writes its rows into a result file.
//!
//! An `ExperimentSpecification` made from the flags and the experiment file enters. A result file, an optional picture,
//! an optional statistics file and optional checkpoints leave.
//!
//! The solver pushes rows into a [`RecorderSink`], which hands them to a `ResultRecorder`. The sink also stores
//! checkpoints and stops the run when writing fails.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;

use super::checkpoint::{CheckpointFile, RunFingerprint, usual_distance};
use super::inputs::{InputRecording, check_cover, prepare};
use super::messages::MessageReporter;
use super::progress::SimulationBar;
use super::recorder::{ResultRecorder, ResultTarget, announcement, write_text};
use super::request::{ModelArgs, RunArgs};
use super::statistics::{StatisticsRecord, peak_memory};
use super::{CommandFailure, CommandStatus, columns, interrupt, model, plot};
use bramah_analysis::experiment::{ExperimentSpecification, duration};
use bramah_circuit::compiled::CompiledModel;
use bramah_model::flat;
use bramah_model::structure::StateChoice;
use bramah_plot::select::{FigureOptions, LabelledTrajectory as Drawn, figure};
use bramah_results::{CsvUnits, Signal, Trajectory, number};
use bramah_solve::{Checkpoint, Control, End, Progress, RowSink, RunResult, Settings, resume, signals, simulate};
use bramah_syntax::diag::{Code, Diagnostic, Sources};

/// Run a circuit
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah simulate Press.mo --stop-time 2 -o press.csv
  bramah simulate Press.mo --set relief.p_set='180 bar' --set pump.V='12 ml' --variables 'pump.*,line.p'
  bramah simulate press.toml --stop-time 5          an experiment file; flags go before what stands in it
  bramah simulate ServoPump.DeadZone --plot dead.png          a model that ships with bramah
  bramah simulate Line.mo --stop-time 1000 --checkpoint line.checkpoint       may be killed and repeated
  bramah simulate Axis.mo --input bench.csv --time-column t_s --map 'F=tau_N[N],u=u_V:linear'

Exit status: 0 the run reached its end; 1 the model is wrong or the run stopped early (what it had is written);
2 bad arguments or files.")]
pub(super) struct SimulateArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    run: RunArgs,
    /// Keep the last checkpoint here, and go on from it if the file is there; removed when the run is over.
    /// The integrator begins afresh at each checkpoint, so that a run that was killed and taken up again gives the
    /// same result, to the last bit, as one that was not
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<String>,
    /// Simulated time between two checkpoints [default: a twentieth of the run]
    #[arg(long, value_name = "TIME", value_parser = duration, requires = "checkpoint", allow_hyphen_values = true)]
    checkpoint_every: Option<f64>,
}

/// Runs the subcommand and writes the statistics file, also after a failure or a panic.
///
/// The statistics are written last, so that they contain the peak memory of the entire run.
///
/// `Err` means that the arguments, files or the model cannot be used, or that the result could not be written.
pub(super) fn run(args: &SimulateArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let experiment = args.model.experiment(Some(&args.run), messages)?;
    let mut record = StatisticsRecord::default();
    // The record is filled while the run goes on, so it has useful content even when `execute` panics.
    let work = AssertUnwindSafe(|| execute(args, &experiment, &mut record, messages));
    // A panic is caught so that the statistics are written. The hook has printed it already, and it continues below.
    let outcome = catch_unwind(work);
    record.peak_memory_bytes = peak_memory();
    let written = match &experiment.statistics {
        Some(path) => write_text(path, &record.to_json()),
        None => Ok(()),
    };
    // An error of the run takes precedence over an error of its statistics file.
    outcome.unwrap_or_else(|bug| resume_unwind(bug)).and_then(|ending| written.map(|()| ending))
}

/// Compiles, runs and writes the result; fills `record` on the way.
///
/// The steps in order: compile the model, read the recorded inputs, settle the settings, open the result file, solve,
/// finish the file, report, draw.
///
/// `Err`: the model or an input is wrong, or the result cannot be written. A run that stops early is not an `Err` but
/// gives `Wrong`.
fn execute(
    args: &SimulateArgs,
    experiment: &ExperimentSpecification,
    record: &mut StatisticsRecord,
    messages: &mut MessageReporter,
) -> Result<CommandStatus, CommandFailure> {
    let begun = Instant::now();
    let compiled = model::compile(experiment, messages);
    // The time is noted before `?`, so that the statistics of a model that fails to compile have it too.
    record.compile_s = Some(begun.elapsed().as_secs_f64());
    let model = compiled?;
    let dae = &model.dae;
    // The sources enter the fingerprint of the checkpoint. A copy is needed because `prepare` adds the recording to
    // them; the recording has its own part of the fingerprint.
    let sources = if args.checkpoint.is_some() { messages.sources.clone() } else { Sources::default() };
    let recorded = prepare(experiment, dae, messages)?;
    let mut settings = settings(experiment, &dae.experiment, &recorded)?;
    // A recording longer than the run is not an error, but the user may have forgotten `--stop-time`.
    if let Some(covered) = recorded.covered.filter(|c| experiment.stop_time.is_none() && c.stop > settings.stop_time) {
        messages.remark(&format!(
            "the run ends at {} s as the model says; the recording goes on to {} s (`--stop-time`)",
            number::text(settings.stop_time),
            number::text(covered.stop)
        ));
    }
    let target = ResultTarget::new(&output_name(experiment, &dae.class))?;
    // The solver hands only these columns to the sink, so the choice must precede the run.
    settings.wanted = columns::choose(dae, &experiment.variables, &target)?;
    let signals = signals(dae, &settings.wanted);
    let intervals = (settings.stop_time - settings.start_time) / settings.interval;
    if let Some(note) = announcement(&signals, intervals.max(1.0), &target) {
        messages.say(&[note]);
    }
    // The fingerprint includes the settings, so `checkpoint_every` must have its value before it is taken.
    let kept = match &args.checkpoint {
        Some(path) => {
            settings.checkpoint_every = args.checkpoint_every.unwrap_or_else(|| usual_distance(&settings));
            Some(CheckpointFile::new(path, RunFingerprint::new(&dae.class, &sources, &settings, &recorded.inputs)))
        }
        None => None,
    };
    let (rows, from) = RecorderSink::open(
        kept,
        &target,
        (signals, experiment.csv_units.unwrap_or_default()),
        experiment.plot.is_some(),
    )?;
    if let Some(from) = &from {
        messages.remark(&format!("going on from {} s", number::text(from.state.time)));
    }
    let (run, rows) = solve(&model, &settings, &recorded, from.as_ref(), rows);
    fill(record, &run);
    // A suspended run keeps its `.part` file and checkpoint; the same command continues from them.
    let recorder = match rows.close(&run) {
        RecorderEnding::Over(recorder) => *recorder,
        RecorderEnding::Suspended(left, name) => {
            left?;
            return Ok(suspended(&run, &name, messages));
        }
    };
    // The reader of stdout has closed the pipe (`| head`). This is not an error.
    if recorder.is_unread() {
        return Ok(CommandStatus::Fine);
    }
    // `finish` consumes the recorder, so the number of rows is read first. The report comes before `outcome?` because
    // the messages of the run explain a result that could not be written.
    let rows = recorder.rows();
    let outcome = recorder.finish();
    report(&run, rows, &target, messages);
    let trajectory = outcome?;
    if let Some(path) = &experiment.plot {
        draw(&trajectory, &dae.class, Path::new(path), messages)?;
    }
    Ok(if run.end.is_success() { CommandStatus::Fine } else { CommandStatus::Wrong })
}

/// The settings of the run.
///
/// A value comes from the first of these that has it: the flags or the experiment file, the model's `experiment`
/// annotation, the span of the recording. `Err`: the run would end before its start, or goes beyond its recording.
///
/// A stop time from the model's annotation is used even when the recording is longer. The user is then told about
/// `--stop-time`.
fn settings(
    experiment: &ExperimentSpecification,
    annotation: &flat::ExperimentAnnotation,
    recorded: &InputRecording,
) -> Result<Settings, CommandFailure> {
    let covered = recorded.covered;
    let said = flat::ExperimentAnnotation {
        start_time: experiment.start_time.or(annotation.start_time).or(covered.map(|c| c.start)),
        stop_time: experiment.stop_time.or(annotation.stop_time).or(covered.map(|c| c.stop)),
        interval: experiment.output_interval.or(annotation.interval),
        tolerance: experiment.relative_tolerance.or(annotation.tolerance),
    };
    let mut settings = Settings::from_experiment(&said);
    // `--event-rows 0` (or `none`) switches event rows off; otherwise the number limits them.
    if let Some(most) = experiment.event_rows {
        (settings.event_rows, settings.most_event_rows) = (most > 0, most);
    }
    if settings.stop_time < settings.start_time {
        let text = format!(
            "the stop time {} s lies before the start time {} s",
            number::text(settings.stop_time),
            number::text(settings.start_time)
        );
        return Err(CommandFailure::new(Code::BadArgument, text));
    }
    if let Some(covered) = covered {
        check_cover(covered, settings.start_time, settings.stop_time)?;
    }
    Ok(settings)
}

/// The name of the result file: the one asked for, else `CLASS.csv`.
fn output_name(experiment: &ExperimentSpecification, class: &str) -> String {
    experiment.output_file.clone().unwrap_or_else(|| format!("{class}.csv"))
}

/// Receives the rows and checkpoints of a run; stops the run when they cannot be written.
struct RecorderSink {
    /// Buffers the rows and writes them to the result file.
    recorder: ResultRecorder,
    /// The checkpoint file, and whether it holds a checkpoint. `None` for a run without `--checkpoint`.
    kept: Option<(CheckpointFile, bool)>,
}

/// What became of the rows when the solver returned.
enum RecorderEnding {
    /// The run is over. The recorder still has to be finished.
    Over(Box<ResultRecorder>),
    /// The run was interrupted and has a checkpoint to continue from. Holds whether the rows could be written, and the
    /// name of the checkpoint file.
    Suspended(Result<(), CommandFailure>, String),
}

impl RecorderSink {
    /// Opens the result file. Returns the sink, and the checkpoint from which the run continues, if there is one.
    ///
    /// `plot`: keep all rows in memory for a picture. `Err`: the file cannot be opened, the checkpoint belongs to
    /// another run, or a picture is asked for together with checkpoints.
    fn open(
        kept: Option<CheckpointFile>,
        target: &ResultTarget,
        (signals, units): (Vec<Signal>, CsvUnits),
        plot: bool,
    ) -> Result<(Self, Option<Checkpoint>), CommandFailure> {
        let Some(keeper) = kept else {
            let recorder = ResultRecorder::new(target.clone(), signals, units, plot)?;
            return Ok((RecorderSink { recorder, kept: None }, None));
        };
        // A continued run would have only the rows after the checkpoint in memory, and the picture would be incomplete.
        if plot {
            let diagnostic = Diagnostic::new(Code::BadArgument, "a run with checkpoints cannot be drawn at once");
            return Err(diagnostic.help("draw its result with `bramah plot` afterwards").into());
        }
        // The checkpoint says how many bytes of the result file are valid; the file is cut there.
        let (from, written) = keeper.load(target)?.unzip();
        let recorder = ResultRecorder::lasting(target.clone(), signals, units, written.as_ref())?;
        Ok((RecorderSink { recorder, kept: Some((keeper, from.is_some())) }, from))
    }

    /// Decides after the run whether it can be continued.
    ///
    /// Failures of writing stay inside the recorder and are reported when it is finished.
    ///
    /// The checkpoint file is removed unless the run was interrupted and has a checkpoint.
    fn close(self, run: &RunResult) -> RecorderEnding {
        let RecorderSink { mut recorder, kept } = self;
        match kept {
            // An interrupted run without any checkpoint cannot continue; its rows become an ordinary partial result.
            Some((keeper, true)) if run.end == End::Interrupted => {
                let name = keeper.name();
                RecorderEnding::Suspended(recorder.suspend(), name)
            }
            Some((keeper, _)) => {
                // The result is written in any case; the failure to remove the file is reported with it.
                if let Err(failure) = keeper.remove() {
                    recorder.failed(failure);
                }
                RecorderEnding::Over(Box::new(recorder))
            }
            None => RecorderEnding::Over(Box::new(recorder)),
        }
    }
}

impl RowSink for RecorderSink {
    /// Passes a row on; breaks the run when nothing can be written any more.
    ///
    /// A row is a time in seconds and one value for each column.
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        if self.recorder.row(time, values) { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Writes the rows to the disk, then the checkpoint that refers to them.
    ///
    /// A run without `--checkpoint` ignores the call.
    fn checkpoint(&mut self, at: &Checkpoint) -> ControlFlow<()> {
        let Some((keeper, exists)) = &mut self.kept else { return ControlFlow::Continue(()) };
        // The rows must be on the disk before the checkpoint claims that they are.
        let Some(written) = self.recorder.mark() else { return ControlFlow::Break(()) };
        match keeper.save(at, &written) {
            Ok(()) => {
                *exists = true;
                ControlFlow::Continue(())
            }
            Err(failure) => {
                // Without a checkpoint the run could not be continued as the user asked, so it stops here.
                self.recorder.failed(failure);
                ControlFlow::Break(())
            }
        }
    }

    /// Time spent on writing, which the solver subtracts from its own.
    fn writing(&self) -> Duration {
        self.recorder.writing()
    }
}

/// Runs the solver from the start or from a checkpoint, with a progress bar and Ctrl-C.
///
/// `from` is the checkpoint to continue from; `None` starts at the initial values. The solver calls the sink for each
/// row on this thread.
///
/// Returns the outcome and the sink with the rows.
fn solve(
    model: &CompiledModel,
    settings: &Settings,
    recorded: &InputRecording,
    from: Option<&Checkpoint>,
    mut rows: RecorderSink,
) -> (RunResult, RecorderSink) {
    let bar = SimulationBar::new(settings.start_time, settings.stop_time);
    let mut show = |progress: &Progress| {
        bar.show(progress.time, None, progress.events);
        true
    };
    // When the chosen states become singular, the model is sorted again with others.
    let mut reselect = |choice: &StateChoice| model.with_states(choice);
    let mut control =
        Control { interrupt: Some(interrupt::flag()), progress: Some(&mut show), reselect: Some(&mut reselect) };
    let (system, inputs) = (&model.system, &recorded.inputs);
    let run = match from {
        Some(from) => resume(system, settings, inputs, from, &mut rows, &mut control),
        None => simulate(system, settings, inputs, None, &mut rows, &mut control),
    };
    // The bar is cleared before messages are printed, so that they do not mix on the terminal.
    bar.clear();
    (run, rows)
}

/// Prints the messages of an interrupted run and adds how to continue it. The exit code is 1.
///
/// The result file stays under its temporary name until the run is complete.
fn suspended(run: &RunResult, checkpoint: &str, messages: &mut MessageReporter) -> CommandStatus {
    let mut diagnostics = run.diagnostics.clone();
    if let Some(error) = diagnostics.iter_mut().find(|d| d.is_error()) {
        error.help.push(format!("the same command goes on from the last checkpoint in `{checkpoint}`"));
    }
    messages.say(&diagnostics);
    CommandStatus::Wrong
}

/// Copies the solver's counts and times into the statistics record.
fn fill(record: &mut StatisticsRecord, run: &RunResult) {
    let s = &run.statistics;
    record.initialize_s = Some(s.initialize_s);
    record.solve_s = Some(s.solve_s);
    record.steps = Some(s.steps);
    record.residual_evaluations = Some(s.residual_evaluations);
    record.jacobian_evaluations = Some(s.jacobian_evaluations);
    record.factorizations = Some(s.factorizations);
    record.error_test_failures = Some(s.error_test_failures);
    record.events = Some(s.events);
    record.unknowns = Some(s.unknowns);
    record.states = Some(s.states);
    record.end = Some(run.end.word());
}

/// Prints the messages of a run that is over, and one summary line when it succeeded.
///
/// `rows` is the number of rows in the result. The summary has the time reached, the number of steps and events, and
/// the time that the solver took.
fn report(run: &RunResult, rows: usize, target: &ResultTarget, messages: &MessageReporter) {
    let mut diagnostics = run.diagnostics.clone();
    // Rows up to the failure are kept, so the error names the file that has them.
    if let Some(error) = diagnostics.iter_mut().find(|d| d.is_error()) {
        error.notes.push(format!(
            "the result up to {} s ({rows} rows) is in `{}`",
            number::text(run.time),
            target.name()
        ));
    }
    messages.say(&diagnostics);
    let s = &run.statistics;
    let events = if s.events == 1 { "event" } else { "events" };
    let work = format!("{} steps, {} {events}, {} s", s.steps, s.events, number::rounded(s.solve_s, 3));
    let line = match &run.end {
        End::Reached => format!("ok: reached {} s ({work}), {rows} rows in {}", number::text(run.time), target.name()),
        End::Terminated(why) => {
            format!("ok: terminated at {} s: {why} ({work}), {rows} rows in {}", number::text(run.time), target.name())
        }
        // Other ends have an error among the diagnostics, which is printed already.
        _ => return,
    };
    messages.remark(&line);
}

/// Writes the picture that `--plot` asks for. `Err`: there is nothing to draw, or the file cannot be written.
///
/// Without choice of the user only a limited number of variables is drawn; a remark says how many are left out.
fn draw(trajectory: &Trajectory, class: &str, path: &Path, messages: &MessageReporter) -> Result<(), CommandFailure> {
    let choice = FigureOptions { title: class.to_owned(), ..FigureOptions::default() };
    let selected = figure(&[Drawn { label: class, trajectory }], &choice)
        .map_err(|e| CommandFailure::from(Diagnostic::new(Code::BadArgument, format!("nothing to draw: {e}"))))?;
    if selected.left_out > 0 {
        messages.remark(&format!("{} more variables are not drawn; choose with --variables", selected.left_out));
    }
    plot::write(&selected.figure, &[("model".to_owned(), class.to_owned())], path, messages)
}
