//! What is said to the user on stderr, in the format asked for.

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

/// The texts read so far, and the way to talk about them.
#[derive(Debug)]
pub(super) struct MessageReporter {
    /// Texts that diagnostics point into.
    pub sources: Sources,
    format: DiagnosticFormat,
    colour: bool,
    width: usize,
    silent: bool,
}

impl MessageReporter {
    /// Colour on a terminal only, and not with `NO_COLOR`.
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

    /// Says nothing: for a stage that is run a second time.
    pub fn silent() -> Self {
        MessageReporter { silent: true, ..MessageReporter::new(MessageFormat::Human) }
    }

    /// Does something of which only what stops it is said: a stage that is run a second time.
    ///
    /// # Errors
    /// Those of `act`, whose texts are then known here.
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

    /// Writes diagnostics, errors last so that they stand where the eye is.
    pub fn say(&self, diagnostics: &[Diagnostic]) {
        let mut ordered: Vec<Diagnostic> = diagnostics.to_vec();
        ordered.sort_by_key(|d| d.severity == Severity::Error);
        self.write(&render(&self.sources, &ordered, self.format, self.width, self.colour));
    }

    /// The value of a stage, whose remarks and warnings are said.
    ///
    /// # Errors
    /// Its diagnostics, when there are errors among them or no value.
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

    /// A remark for people; scripts that asked for JSON or short messages are not bothered.
    pub fn remark(&self, text: &str) {
        if self.format == DiagnosticFormat::Human {
            self.write(&format!("{text}\n"));
        }
    }

    fn write(&self, text: &str) {
        if self.silent {
            return;
        }
        // Nobody is left to be told when stderr is closed.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}
