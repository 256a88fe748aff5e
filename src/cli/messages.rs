//! Prints messages to stderr in the format that `--message-format` asks for.
//!
//! Diagnostics of all stages enter; text or JSON lines leave. Every subcommand gets the one [`MessageReporter`] that
//! `main` makes. The reporter also holds the source texts into which the labels of diagnostics point.

use std::io::{IsTerminal, Write};

use super::CommandFailure;
use bramah_syntax::diag::render::{DiagnosticFormat, render};
use bramah_syntax::diag::{Diagnostic, Severity, Sources, StageResult};

/// `--message-format`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum MessageFormat {
    /// With the text concerned
    #[default]
    Human,
    /// file:line:col: error[E103]: text
    Short,
    /// One JSON object a line
    Json,
}

/// Prints diagnostics and remarks, and holds the texts that they refer to.
#[derive(Debug)]
pub(super) struct MessageReporter {
    /// The texts that diagnostics point into.
    pub sources: Sources,
    /// The format of diagnostics.
    format: DiagnosticFormat,
    /// Use terminal colours.
    colour: bool,
    /// Columns of the terminal; 100 when stderr is not a terminal.
    width: usize,
    /// Print nothing at all.
    silent: bool,
}

impl MessageReporter {
    /// A reporter for stderr. It uses colours only on a terminal, and not when the variable `NO_COLOR` has a value.
    pub fn new(format: MessageFormat) -> Self {
        let format = match format {
            MessageFormat::Human => DiagnosticFormat::Human,
            MessageFormat::Short => DiagnosticFormat::Short,
            MessageFormat::Json => DiagnosticFormat::Json,
        };
        let terminal = std::io::stderr().is_terminal();
        let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let width = terminal_size::terminal_size_of(std::io::stderr()).map_or(100, |(w, _)| usize::from(w.0));
        MessageReporter { sources: Sources::default(), format, colour: terminal && !plain, width, silent: false }
    }

    /// A reporter that prints nothing, for a stage whose messages are printed by another run of it.
    pub fn silent() -> Self {
        MessageReporter { silent: true, ..MessageReporter::new(MessageFormat::Human) }
    }

    /// Runs `act` without printing its messages, because the same stage runs again later and prints them.
    ///
    /// # Errors
    /// The failure of `act`. The reporter then takes over the texts that the failure points into.
    pub fn quietly<T>(
        &mut self,
        act: impl FnOnce(&mut MessageReporter) -> Result<T, CommandFailure>,
    ) -> Result<T, CommandFailure> {
        let mut silent = MessageReporter::silent();
        let result = act(&mut silent);
        if result.is_err() {
            self.sources = silent.sources;
        }
        result
    }

    /// Prints diagnostics. Errors come last, next to the prompt.
    pub fn say(&self, diagnostics: &[Diagnostic]) {
        let mut ordered: Vec<Diagnostic> = diagnostics.to_vec();
        // The sort is stable: within errors and within the rest the order of the stages stays.
        ordered.sort_by_key(|d| d.severity == Severity::Error);
        self.write(&render(&self.sources, &ordered, self.format, self.width, self.colour));
    }

    /// The value of a stage; its remarks and warnings are printed.
    ///
    /// # Errors
    /// All diagnostics, when there is an error among them or no value. They are not printed here.
    pub fn value<T>(&self, checked: StageResult<T>) -> Result<T, CommandFailure> {
        let failed = checked.diagnostics.iter().any(Diagnostic::is_error);
        match checked.value {
            Some(value) if !failed => {
                self.say(&checked.diagnostics);
                Ok(value)
            }
            _ => Err(CommandFailure { diagnostics: checked.diagnostics }),
        }
    }

    /// Prints a remark for people. JSON and short formats leave it out, because scripts read them.
    pub fn remark(&self, text: &str) {
        if self.format == DiagnosticFormat::Human {
            self.write(&format!("{text}\n"));
        }
    }

    /// Writes to stderr, unless this reporter is silent.
    fn write(&self, text: &str) {
        if self.silent {
            return;
        }
        // A closed stderr leaves no way to report the failure.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}
