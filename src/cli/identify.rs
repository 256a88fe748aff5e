//! `bramah identify`: estimates parameters of a model from recordings of a test rig.
//!
//! A study file and its recordings enter. A JSON report, a summary on stderr and an optional picture leave.
//! `bramah_analysis::identify` does the estimation. This module orders its steps: what can be estimated at all, the
//! fit, held recordings, profiles.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::messages::MessageReporter;
use super::recorder::write_text;
use super::study::{StudySession, open};
use super::{CommandFailure, CommandStatus, files, plot};
use bramah_analysis::identify::{
    Identification, IdentificationProblem, IdentificationReport, IdentifyMethod, ParameterFit, ProfileLikelihood,
    doubts, fit_words, picture, profile_words, separation_words,
};
use bramah_analysis::study::RecordingRole;
use bramah_results::GlobPatterns;
use bramah_syntax::diag::{Code, Diagnostic};

/// Find parameters from recordings of a test rig
#[derive(Args, Debug)]
#[command(after_help = "\
The report begins with what the data can show at all: parameters without influence, and groups that cannot be separated.
Estimates carry one standard deviation, corrected for errors that resemble their neighbours. Recordings of role `held`
are read last and judge the result.

Examples:
  bramah identify identify.toml --data bench/ --output result.json
  bramah identify identify.toml --method output     runs against signals, not the inverse model

Exit status: 0 found; 1 the model is wrong, cannot follow the recordings, or the search did not converge;
2 a study, file or column that cannot be used.")]
pub(super) struct IdentifyArgs {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// The folder of the recordings [default: that of the study]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// The result as JSON, `-` for stdout
    #[arg(short, long, visible_alias = "output-file", default_value = "-", value_name = "FILE")]
    output: String,
    /// How far each parameter can be moved while the others are searched for anew: the 95 % interval by the profile
    /// likelihood; all parameters, or those that match
    #[arg(long, value_name = "GLOB,...", num_args = 0..=1, require_equals = true, default_missing_value = "*")]
    profile: Option<String>,
    /// Search from so many places, the values of the model first, and keep the best end
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Draws the places of `--starts`
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Signals, autocorrelation of the errors, confidence ellipses and profiles: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// `inverse`: the force that the measured motion needs; `output`: runs from the inputs alone
    #[arg(long, value_enum, default_value_t = MethodArg::Auto)]
    method: MethodArg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodArg {
    /// The inverse model where forces or torques are measured, else runs
    Auto,
    /// Runs from the inputs alone against the signals
    Output,
    /// Measured motion in, force out
    Inverse,
}

// Kept apart from the library's type, so that the library does not depend on clap.
impl MethodArg {
    /// The method of the library for this argument.
    fn method(self) -> IdentifyMethod {
        match self {
            MethodArg::Auto => IdentifyMethod::Auto,
            MethodArg::Output => IdentifyMethod::Output,
            MethodArg::Inverse => IdentifyMethod::Inverse,
        }
    }
}

/// Runs the subcommand. Returns `Wrong` (exit code 1) when the search did not converge.
///
/// `Err`: the study or its recordings cannot be used, or the model cannot follow the recordings.
pub(super) fn run(args: &IdentifyArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    // The fit may take long, so a wrong output name is reported before it.
    files::ready_as(Path::new(&args.output), "a report", &["json"])?;
    args.plot.as_deref().map_or(Ok(()), plot::ready)?;
    let mut opened = open(&args.study, args.data.as_deref(), messages)?;
    // Held recordings are read only after the fit, which must not depend on them.
    let train = opened.load(RecordingRole::Train, messages)?;
    let model = opened.model.clone();
    let bound = opened.bound.clone();
    let problem = IdentificationProblem::new(&model, &bound, &train).map_err(|d| opened.failure(d, messages))?;
    let fail = |d, opened: &StudySession, messages: &mut MessageReporter| opened.failure(vec![d], messages);
    // A pattern without a match is reported before the fit.
    let profiled = profiled(args, &problem).map_err(|d| fail(d, &opened, messages))?;
    let found = Identification::new(&problem, &train, args.method.method()).map_err(|d| fail(d, &opened, messages))?;
    // The separability is printed before the fit: it explains a fit that fails.
    messages.say(&found.suspicions);
    messages.remark(separation_words(&problem, &found).trim_end());
    let fit = found.fit_from(args.starts.into(), args.seed).map_err(|d| fail(d, &opened, messages))?;
    let held = if bound.has(RecordingRole::Held) { opened.load(RecordingRole::Held, messages)? } else { Vec::new() };
    let held = if held.is_empty() {
        Vec::new()
    } else {
        found.judge_held(&fit, &held).map_err(|d| fail(d, &opened, messages))?
    };
    messages.say(&doubts(&problem, &fit, &held));
    messages.remark(fit_words(&problem, &fit, &held).trim_end());
    let profiles: Result<Vec<ProfileLikelihood>, Diagnostic> =
        profiled.into_iter().map(|j| found.profile(&fit, j)).collect();
    let profiles = profiles.map_err(|d| fail(d, &opened, messages))?;
    if !profiles.is_empty() {
        messages.remark(profile_words(&problem, &profiles).trim_end());
    }
    if let Some(path) = &args.plot {
        plot::write(&picture(&problem, &fit, &profiles), &facts(&problem, &fit), path, messages)?;
    }
    let report = IdentificationReport::new(&problem, &found, &fit, &held, &profiles);
    // The report is written last, because it includes the profiles.
    let text = serde_json::to_string_pretty(&report).expect("numbers and texts always serialize");
    write_text(&args.output, &format!("{text}\n"))?;
    Ok(if fit.converged { CommandStatus::Fine } else { CommandStatus::Wrong })
}

/// Indices of the parameters that `--profile` asks for; empty when the option is missing.
///
/// `Err`: the pattern matches no parameter of the study.
fn profiled(args: &IdentifyArgs, problem: &IdentificationProblem<'_>) -> Result<Vec<usize>, Diagnostic> {
    let Some(asked) = &args.profile else { return Ok(Vec::new()) };
    let globs = GlobPatterns::new(std::slice::from_ref(asked));
    let chosen: Vec<usize> = (0..problem.free.len()).filter(|&j| globs.matches(&problem.free[j].name)).collect();
    if chosen.is_empty() {
        let d = Diagnostic::new(Code::BadArgument, format!("no parameter of the study fits `--profile={asked}`"));
        return Err(d);
    }
    Ok(chosen)
}

/// Name and value pairs for the table below the picture in an HTML page, made from the lines of the summary.
fn facts(problem: &IdentificationProblem<'_>, fit: &ParameterFit) -> Vec<(String, String)> {
    let words = fit_words(problem, fit, &[]);
    words.lines().filter_map(|l| l.trim().split_once([' ', ':'])).map(|(a, b)| (a.into(), b.trim().into())).collect()
}
