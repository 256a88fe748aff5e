//! `bramah completions`: prints a completion script for a shell, generated from the definitions of the arguments.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, CommandFailure, CommandStatus, files};

/// Print completions for a shell
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah completions bash > ~/.local/share/bash-completion/completions/bramah
  bramah completions zsh  > ~/.zfunc/_bramah
  bramah completions fish > ~/.config/fish/completions/bramah.fish")]
pub(super) struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// Prints the script to stdout.
pub(super) fn run(args: &CompletionsArgs) -> Result<CommandStatus, CommandFailure> {
    let mut bytes = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "bramah", &mut bytes);
    files::print(&String::from_utf8_lossy(&bytes))?;
    Ok(CommandStatus::Fine)
}
