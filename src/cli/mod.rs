//! The `bramah` command: the only layer of the program that uses the disk, the clock, the environment and the terminal.
//!
//! Command-line arguments enter; files, text on stdout and an exit code leave. `src/main.rs` calls [`main`]. Each
//! subcommand has one module with an `Args` struct for clap and a function `run`. The work itself is done by the
//! library crates below.
//!
//! stdout carries data only, so that it can be piped. Messages and progress go to stderr.
//!
//! Exit codes: 0 success; 1 the model is wrong, a run stopped early or a comparison failed; 2 bad arguments or files;
//! 101 a panic; 130 a second Ctrl-C.

#![allow(rustdoc::broken_intra_doc_links, reason = "help texts show brackets as a user types them")]
#![allow(clippy::disallowed_methods, clippy::print_stderr, reason = "the one place that may")]

mod axes;
mod check;
mod checkpoint;
mod columns;
mod compare;
mod completions;
mod data;
mod describe;
mod explain;
mod export;
mod files;
mod fmt;
mod gap;
mod identify;
mod inputs;
mod interrupt;
mod linearize;
mod lsp;
mod messages;
mod model;
mod new;
mod partition;
mod plot;
mod progress;
mod recorder;
mod request;
mod sensitivity;
mod serve;
mod simulate;
mod statistics;
mod steady;
mod study;
mod sweep;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use bramah_model::instance::GIVEN;
use bramah_syntax::diag::{Code, Diagnostic, Sources};
use messages::{MessageFormat, MessageReporter};

/// Acausal simulator for electro-hydraulic machines: circuits in a strict subset of Modelica, solved by SUNDIALS IDA.
#[derive(Parser, Debug)]
#[command(name = "bramah", version, max_term_width = 100, after_help = EXAMPLES)]
// The comments on this type and its fields are the help texts that clap prints.
struct Cli {
    /// How messages are written to stderr
    #[arg(long, global = true, value_enum, default_value_t, value_name = "FORMAT")]
    message_format: MessageFormat,
    #[command(subcommand)]
    command: CliCommand,
}

/// Text below the options in the output of `bramah --help`.
const EXAMPLES: &str = "\
Examples:
  bramah new press                              a circuit and an experiment to start from
  bramah check press/Press.mo                   is it complete? no run
  bramah simulate press/Press.mo -o press.csv   run it
  bramah plot press.csv -o press.svg            see it
  bramah compare bench.csv press.csv            put it beside a measurement
  bramah explain E103                           what a message means

Exit status: 0 fine; 1 the model is wrong, the run did not reach its end, or a comparison failed;
2 bad arguments or files; 101 a bug of bramah.";

#[derive(Subcommand, Debug)]
enum CliCommand {
    New(new::NewArgs),
    Check(check::CheckArgs),
    Simulate(simulate::SimulateArgs),
    Plot(plot::PlotArgs),
    Sweep(sweep::SweepArgs),
    Compare(compare::CompareArgs),
    Identify(identify::IdentifyArgs),
    Gap(gap::GapArgs),
    Steady(steady::SteadyArgs),
    Partition(partition::PartitionArgs),
    Linearize(linearize::LinearizeArgs),
    Sensitivity(sensitivity::SensitivityArgs),
    Export(export::ExportArgs),
    Fmt(fmt::FmtArgs),
    Lsp(lsp::LspArgs),
    Serve(serve::ServeArgs),
    Explain(explain::ExplainArgs),
    Completions(completions::CompletionsArgs),
}

/// The outcome of a subcommand that did its work and printed its own messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CommandStatus {
    /// Exit code 0.
    Fine,
    /// Exit code 1: the model is wrong, the run stopped early, or a comparison found a violation.
    Wrong,
}

/// The error of a subcommand that could not do its work.
///
/// `main` prints the diagnostics and turns the first error among them into the exit code.
#[derive(Debug)]
struct CommandFailure {
    /// The messages to print. Labels refer to the texts in `MessageReporter::sources`.
    diagnostics: Vec<Diagnostic>,
}

impl CommandFailure {
    /// A failure with one diagnostic that has no place in a text.
    fn new(code: Code, message: impl Into<String>) -> Self {
        Diagnostic::new(code, message).into()
    }

    /// The exit code of this failure: 2 for wrong data, arguments and files, 1 for a wrong model.
    ///
    /// An error inside a value of `--set` also gives 2, because the user typed it on the command line.
    fn exit_code(&self, sources: &Sources) -> u8 {
        // Values of `--set` are parsed as a source with this reserved path, so a label in it marks a wrong argument.
        let given = |d: &Diagnostic| d.labels.first().is_some_and(|l| sources.get(l.span.file).path == GIVEN);
        // Warnings may stand before the error that stopped the command; they do not decide the exit code.
        let first = self.diagnostics.iter().find(|d| d.is_error());
        first.map_or(2, |d| if given(d) { 2 } else { exit_code(d.code) })
    }
}

impl From<Diagnostic> for CommandFailure {
    fn from(diagnostic: Diagnostic) -> Self {
        CommandFailure { diagnostics: vec![diagnostic] }
    }
}

/// The exit code that an error of this code leads to.
fn exit_code(code: Code) -> u8 {
    // Both codes belong to the model's number range, but the cause is a name or value on the command line.
    let outside = matches!(code, Code::BadModel | Code::BadSet);
    // E6xx codes are about data files, experiments and studies, E9xx codes about arguments and files.
    if outside || code.id()[1..].starts_with(['6', '9']) { 2 } else { 1 }
}

/// Runs the command with the arguments of this process and returns its exit code.
pub fn main() -> ExitCode {
    // The hook comes first, so that a panic while arguments are parsed is also reported as a bug.
    std::panic::set_hook(Box::new(report_panic));
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version also arrive here as an error, and `print` sends them to stdout. A failed write (closed
            // pipe) is not reported.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let mut messages = MessageReporter::new(cli.message_format);
    match dispatch(cli.command, &mut messages) {
        Ok(CommandStatus::Fine) => ExitCode::SUCCESS,
        Ok(CommandStatus::Wrong) => ExitCode::from(1),
        // Only failures are printed here. A subcommand that returns a status has printed its messages itself.
        Err(failure) => {
            messages.say(&failure.diagnostics);
            ExitCode::from(failure.exit_code(&messages.sources))
        }
    }
}

/// Calls the `run` function of the chosen subcommand.
///
/// The status or failure of the subcommand is passed on unchanged.
fn dispatch(command: CliCommand, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    match command {
        CliCommand::New(args) => new::run(&args, messages),
        CliCommand::Check(args) => check::run(&args, messages),
        CliCommand::Simulate(args) => simulate::run(&args, messages),
        CliCommand::Plot(args) => plot::run(&args, messages),
        CliCommand::Sweep(args) => sweep::run(&args, messages),
        CliCommand::Compare(args) => compare::run(&args, messages),
        CliCommand::Identify(args) => identify::run(&args, messages),
        CliCommand::Gap(args) => gap::run(&args, messages),
        CliCommand::Steady(args) => steady::run(&args, messages),
        CliCommand::Partition(args) => partition::run(&args, messages),
        CliCommand::Linearize(args) => linearize::run(&args, messages),
        CliCommand::Sensitivity(args) => sensitivity::run(&args, messages),
        CliCommand::Export(args) => export::run(&args, messages),
        CliCommand::Fmt(args) => fmt::run(&args, messages),
        // `lsp` and `serve` talk to an editor or a browser, `explain` and `completions` only print. None needs the
        // reporter.
        CliCommand::Lsp(args) => lsp::run(&args),
        CliCommand::Serve(args) => serve::run(&args),
        CliCommand::Explain(args) => explain::run(&args),
        CliCommand::Completions(args) => completions::run(&args),
    }
}

/// The panic hook: prints a request to report the bug instead of Rust's default text.
///
/// The text tells users that the fault is not in their model. It runs on the thread that panics.
fn report_panic(info: &std::panic::PanicHookInfo<'_>) {
    let payload = info.payload();
    // `panic!` with a literal carries `&str`, with format arguments `String`.
    let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
    let place = info.location().map(|l| format!(" ({}:{})", l.file(), l.line())).unwrap_or_default();
    eprintln!(
        "error: this is a bug of bramah, not of your model: {}{place}\nhelp: please report it with the command and \
         the files that led to it",
        text.unwrap_or("unknown panic")
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn exit_codes() {
        assert_eq!(exit_code(Code::OpenPort), 1);
        assert_eq!(exit_code(Code::StepTooSmall), 1);
        assert_eq!(exit_code(Code::BadData), 2);
        assert_eq!(exit_code(Code::FileAccess), 2);
        assert_eq!(exit_code(Code::BadModel), 2);
    }
}
