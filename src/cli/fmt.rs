//! `bramah fmt`: lays out Modelica files.
//!
//! Files, folders or stdin enter; the same files leave with indentation and blanks corrected. The layout itself is
//! `bramah_syntax::format`, which works on tokens and keeps comments and line breaks.
//!
//! With `--check` nothing is written. The names of files that would change are printed, and the exit code is 1 if there
//! are any.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;

use super::messages::MessageReporter;
use super::{CommandFailure, CommandStatus, files};
use bramah_syntax::diag::Code;
use bramah_syntax::format::format;
use bramah_syntax::world::DiskWorld;
use bramah_syntax::world::World;

/// Lay out Modelica files: indentation and blanks; comments and line breaks stay
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah fmt Press.mo
  bramah fmt Library --check            names the files that would change, for a build server
  bramah fmt - < Press.mo               from stdin to stdout, for an editor

Exit status: 0 fine, 1 a file has syntax errors, or would change with --check, 2 bad arguments or files.")]
pub(super) struct FmtArgs {
    /// Files, or folders whose `.mo` files are laid out; `-` reads stdin and writes stdout
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// Write nothing, name the files that would change
    #[arg(long)]
    check: bool,
}

/// Runs the subcommand over all paths.
///
/// Returns `Wrong` when a file would change with `--check`, or when one of several files has syntax errors. `Err`: the
/// only file has syntax errors, or a file cannot be read or written.
pub(super) fn run(args: &FmtArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let within = |path: &PathBuf| match path.is_dir() {
        true => files::modelica_below(path, &|_| false),
        false => vec![path.clone()],
    };
    let all: Vec<PathBuf> = args.paths.iter().flat_map(within).collect();
    let mut ending = CommandStatus::Fine;
    for path in &all {
        match one(path, args.check, messages) {
            Ok(CommandStatus::Fine) => {}
            Ok(CommandStatus::Wrong) => ending = CommandStatus::Wrong,
            // One file with syntax errors does not keep the others from being laid out. Problems of access end the
            // command.
            Err(failure) if all.len() > 1 && failure.exit_code(&messages.sources) == 1 => {
                messages.say(&failure.diagnostics);
                ending = CommandStatus::Wrong;
            }
            Err(failure) => return Err(failure),
        }
    }
    Ok(ending)
}

/// Lays out one file, or stdin for `-`.
///
/// Returns `Wrong` when it would change and `check` is set. `Err`: it has syntax errors, or cannot be read or written.
fn one(path: &Path, check: bool, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let stdin = path == Path::new("-");
    let text = if stdin { from_stdin()? } else { read(path)? };
    let file = messages.sources.add(path.display().to_string(), text.clone());
    let laid_out = format(file, &text).map_err(|diagnostics| CommandFailure { diagnostics })?;
    // From stdin the text is always printed, also when nothing changed: an editor replaces its text with the output.
    if stdin && !check {
        files::print(&laid_out)?;
        return Ok(CommandStatus::Fine);
    }
    // An unchanged file is not written, so that its time stamp stays.
    if laid_out == text {
        return Ok(CommandStatus::Fine);
    }
    if check {
        files::print(&format!("{}\n", path.display()))?;
        return Ok(CommandStatus::Wrong);
    }
    files::write(path, laid_out.as_bytes())?;
    messages.remark(&format!("laid out {}", path.display()));
    Ok(CommandStatus::Fine)
}

/// Reads a file. `Err`: it is missing, not readable or not UTF-8.
fn read(path: &Path) -> Result<String, CommandFailure> {
    let unreadable = |why| CommandFailure::new(Code::FileAccess, format!("`{}` cannot be read: {why}", path.display()));
    DiskWorld.read(path).map_err(unreadable)
}

/// Reads all of stdin. `Err`: it cannot be read or is not UTF-8.
fn from_stdin() -> Result<String, CommandFailure> {
    let mut text = String::new();
    let read = std::io::stdin().read_to_string(&mut text);
    read.map_err(|e| files::access(Path::new("-"), "read", &e))?;
    Ok(text)
}
