//! `bramah gap`: diagnoses where a model and its recordings differ.
//!
//! A study file and its recordings enter. A verdict (JSON), and optionally the corrected model and a report, leave. The
//! crate `bramah_gap` does the diagnosis; this module reads the arguments, measures the time and writes the files.
//!
//! `--list` only lists the hypotheses, `--plan` evaluates planned recordings before they are measured. A verdict of any
//! kind gives exit code 0.

use clap::Args;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::messages::MessageReporter;
use super::recorder::write_text;
use super::{CommandFailure, CommandStatus, files};
use bramah_analysis::study::Study;
use bramah_gap::hypotheses::Hypothesis;
use bramah_gap::plan::plan;
use bramah_gap::select::search::Stage;
use bramah_gap::study::{StudyError, planned, proposed, question};
use bramah_gap::{Budget, DiagnoseOptions, Diagnosis};
use bramah_syntax::diag::{Code, Diagnostic, StageResult};
use bramah_syntax::world::DiskWorld;

/// Find where model and machine differ, and which missing effect explains it
#[derive(Args, Debug)]
#[command(after_help = "\
The verdict goes to stdout as JSON (or into the file given), the summary to stderr. Recordings of role `held` are not
used for fitting and ranking: they confirm what was found, and show how far the gap shrinks.

Examples:
  bramah gap study.toml --data bench/                       the diagnosis
  bramah gap study.toml --data bench/ -o verdict.json
  bramah gap study.toml --data bench/ --write-model fixed.mo --report report.html
  bramah gap study.toml --plan      before measuring: what the planned inputs would show, and what they could not distinguish
  bramah gap study.toml --explain-rejected 'Effects.SensorLag@p' --report lag.html    what a refused effect would do
  bramah gap study.toml --list      what the network of the study's model could lack, and where

Exit status: 0 whatever the verdict, 1 the nominal model is wrong, 2 a study, file or column that cannot be used.")]
pub(super) struct GapArgs {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// The folder of the recordings [default: that of the study]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// The verdict as JSON, `-` for stdout
    #[arg(short, long, visible_alias = "output-file", default_value = "-", value_name = "FILE")]
    output: String,
    /// The corrected model, class `Fixed`, with every class it needs in one Modelica file, `-` for stdout
    #[arg(long, value_name = "FILE")]
    write_model: Option<String>,
    /// What was found as one HTML page, `-` for stdout
    #[arg(long, value_name = "FILE")]
    report: Option<String>,
    /// How long the search may take: seconds, or a time with a unit [default: 60 s, and on a slow model as long as 500
    /// simulations of all recordings take]. Effects for which the time does not last are named
    #[arg(long, value_name = "TIME", value_parser = budget, conflicts_with_all = ["list", "plan"])]
    budget: Option<Duration>,
    /// Fit one effect at one place, as `weighed` and `--list` name them, and show it even where the diagnosis refuses it
    #[arg(long, value_name = "EFFECT@PLACE", conflicts_with_all = ["list", "plan"])]
    explain_rejected: Option<String>,
    /// List every effect at every place where it fits, and stop
    #[arg(long)]
    list: bool,
    /// Say what the planned experiment would show: train recordings need time and inputs only
    #[arg(long, conflicts_with_all = ["list", "write_model", "report"])]
    plan: bool,
}

/// Runs the subcommand in one of its three modes: list, plan or diagnosis.
///
/// `Err` gives exit code 1 when the nominal model is wrong, and 2 for the study, its files and columns.
pub(super) fn run(args: &GapArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let read = Study::read(&DiskWorld, &args.study, &mut messages.sources);
    let study = messages.value(read)?;
    if args.list {
        let (all, warnings) = proposed(&DiskWorld, &study).map_err(|why| unusable(why, messages))?;
        files::print(&listed(&messages.value(StageResult::new(all, warnings))?))?;
        // The list needs no recordings. Missing ones are reported because the diagnosis will need them.
        let folder = args.data.as_deref().unwrap_or(&study.folder);
        let there = |file: &str| folder.join(file).is_file();
        let missing = study.recordings.iter().filter(|r| !r.optional && !there(&r.file)).map(|r| r.file.as_str());
        let missing: Vec<&str> = missing.collect();
        if !missing.is_empty() {
            messages.remark(&format!("recordings of the study that are not there yet: {}", missing.join(", ")));
        }
        return Ok(CommandStatus::Fine);
    }
    let outputs = [
        (Some(&args.output), "a verdict", "json"),
        (args.write_model.as_ref(), "a model", "mo"),
        (args.report.as_ref(), "a report", "html"),
    ];
    // The diagnosis may take long, so a wrong output name is reported before it starts.
    for (path, what, known) in outputs.into_iter().filter_map(|(p, what, known)| Some((Path::new(p?), what, known))) {
        files::ready_as(path, what, &[known])?;
    }
    if args.plan { weigh_plan(args, &study, messages) } else { diagnose(args, &study, messages) }
}

/// Evaluates a planned experiment: what its recordings could show.
///
/// `Err`: the study cannot be used, or the model cannot be simulated with the planned inputs.
fn weigh_plan(args: &GapArgs, study: &Study, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let data = args.data.as_deref();
    let mut question =
        planned(&DiskWorld, study, data, &mut messages.sources).map_err(|why| unusable(why, messages))?;
    messages.say(&question.diagnostics);
    let stages = StageBar::new();
    let found = plan(&mut question.problem, &mut |stage| stages.say(stage));
    // The progress line is removed before anything else is printed.
    stages.clear();
    let Some(found) = found else {
        let text = "the nominal model has no values on the way through the planned recordings";
        let help = "try `bramah simulate` with these inputs";
        return Err(Diagnostic::new(Code::BadData, text.to_string()).help(help).into());
    };
    messages.remark(found.words().trim_end());
    let text = serde_json::to_string_pretty(&found).expect("numbers and texts always serialize");
    write_text(&args.output, &format!("{text}\n"))?;
    Ok(CommandStatus::Fine)
}

/// Runs the diagnosis and writes the verdict, the corrected model and the report.
///
/// `Err`: the study or its recordings cannot be used, or a file cannot be written.
fn diagnose(args: &GapArgs, study: &Study, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    // The budget counts from here, so it includes reading and compiling.
    let begun = std::time::Instant::now();
    let data = args.data.as_deref();
    let question = question(&DiskWorld, study, data, &mut messages.sources).map_err(|why| unusable(why, messages))?;
    messages.say(&question.diagnostics);
    // Held recordings are read apart, because fitting must not see them.
    let held = question.held(data, &mut messages.sources).map_err(|diagnostics| CommandFailure { diagnostics })?;
    if held.recordings.is_empty() {
        messages.remark("There are no held recordings: the gap is that on the recordings that were used.");
    }
    let stages = StageBar::new();
    let mut show = |stage: Stage| {
        stages.say(&stage.to_string());
        ControlFlow::Continue(())
    };
    // The clock is passed as a closure because crates below the command must not read it.
    let gone = || begun.elapsed();
    let budget = Budget { time: args.budget, gone: &gone };
    let options = DiagnoseOptions { data, budget: Some(budget), effect: args.explain_rejected.as_deref() };
    let diagnosis = Diagnosis::new(question, held, options, &mut show);
    stages.clear();
    let mut diagnosis = diagnosis.map_err(|diagnostics| CommandFailure { diagnostics })?;
    diagnosis.took(begun.elapsed().as_secs_f64());
    messages.remark(diagnosis.words().trim_end());
    let text = serde_json::to_string_pretty(diagnosis.verdict()).expect("numbers and texts always serialize");
    write_text(&args.output, &format!("{text}\n"))?;
    if let Some(file) = &args.write_model {
        write_text(file, &messages.value(diagnosis.corrected())?)?;
    }
    if let Some(file) = &args.report {
        write_text(file, &diagnosis.report())?;
    }
    Ok(CommandStatus::Fine)
}

/// Shows the current stage of a diagnosis as a line on the terminal.
struct StageBar {
    /// The line; `None` when stderr is not a terminal.
    bar: Option<indicatif::ProgressBar>,
}

impl StageBar {
    /// A spinner on stderr, if that is a terminal. The share of the work done is not known, so there is no bar.
    fn new() -> Self {
        let terminal = std::io::IsTerminal::is_terminal(&std::io::stderr());
        let bar = terminal.then(indicatif::ProgressBar::new_spinner);
        if let Some(bar) = &bar {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        StageBar { bar }
    }

    /// Shows a new stage.
    fn say(&self, stage: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(stage.to_string());
        }
    }

    /// Removes the line.
    fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// The failure for a study that cannot be used.
///
/// When the mistake is in the model, the model's texts replace the sources, so that labels point into them.
fn unusable(why: StudyError, messages: &mut MessageReporter) -> CommandFailure {
    if let Some(sources) = why.sources {
        messages.sources = sources;
    }
    CommandFailure { diagnostics: why.diagnostics }
}

/// The hypotheses as text: a line each with family, effect and places, then their number.
fn listed(all: &[Hypothesis]) -> String {
    let mut text = String::new();
    for h in all {
        let places: Vec<&str> = h.places().iter().map(|p| p.place.as_str()).collect();
        text.push_str(&format!("{:<24} {:<44} {}\n", h.family, h.effect, places.join(" + ")));
    }
    text.push_str(&format!("{} hypotheses\n", all.len()));
    text
}

/// Parses `--budget`: seconds or a time with a unit, greater than zero. `Err` is the text that clap shows.
fn budget(text: &str) -> Result<Duration, String> {
    let seconds = bramah_analysis::experiment::seconds(text)?;
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|t| !t.is_zero());
    time.ok_or_else(|| "the budget must be a time above zero".into())
}
