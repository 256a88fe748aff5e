//! What is said to the user on stderr, in the format asked for.

use std::io::{IsTerminal, Write};

use super::Failure;
use bramah_syntax::diag::render::{Format, render};
use bramah_syntax::diag::{Checked, Diagnostic, Severity, Sources};

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
pub(super) struct Messages {
    /// Texts that diagnostics point into.
    pub sources: Sources,
    format: Format,
    colour: bool,
    width: usize,
    silent: bool,
}

impl Messages {
    /// Colour on a terminal only, and not with `NO_COLOR`.
    pub fn new(format: MessageFormat) -> Self {
        let format = match format {
            MessageFormat::Human => Format::Human,
            MessageFormat::Short => Format::Short,
            MessageFormat::Json => Format::Json,
        };
        let terminal = std::io::stderr().is_terminal();
        let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let width = terminal_size::terminal_size_of(std::io::stderr()).map_or(100, |(w, _)| usize::from(w.0));
        Messages { sources: Sources::default(), format, colour: terminal && !plain, width, silent: false }
    }

    /// Says nothing: for a stage that is run a second time.
    pub fn silent() -> Self {
        Messages { silent: true, ..Messages::new(MessageFormat::Human) }
    }

    /// Does something of which only what stops it is said: a stage that is run a second time.
    ///
    /// # Errors
    /// Those of `act`, whose texts are then known here.
    pub fn quietly<T>(&mut self, act: impl FnOnce(&mut Messages) -> Result<T, Failure>) -> Result<T, Failure> {
        let mut silent = Messages::silent();
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
    pub fn value<T>(&self, checked: Checked<T>) -> Result<T, Failure> {
        let failed = checked.diagnostics.iter().any(Diagnostic::is_error);
        match checked.value {
            Some(value) if !failed => {
                self.say(&checked.diagnostics);
                Ok(value)
            }
            _ => Err(Failure { diagnostics: checked.diagnostics }),
        }
    }

    /// A remark for people; scripts that asked for JSON or short messages are not bothered.
    pub fn remark(&self, text: &str) {
        if self.format == Format::Human {
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
