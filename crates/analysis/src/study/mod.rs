//! Studies: a model, recordings of its bench and what is known about its parameters, as TOML.
//!
//! `identify` and `gap` read the same file. [`parse`] makes a [`Study`] of a text; [`Study::bind`] ties its names to
//! the variables of a compiled model; [`BoundStudy::load`] reads the recordings of one role, so that held ones may be
//! read last. The reference of the file is `docs/study.md`.

mod amount;
mod bind;
mod load;
mod reader;
mod table;

pub use amount::Amount;
pub use bind::{BoundInput, BoundParameter, BoundSignal, BoundStudy, DataSheetTolerance};
pub use load::{Recording, full_scales};
pub use table::parse;

use bramah_syntax::diag::{Code, Diagnostic, Sources, Span, StageResult};
use bramah_syntax::world::World;
use std::path::{Path, PathBuf};

/// A study file.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The folder of the study file: relative paths begin here.
    pub folder: PathBuf,
    /// A `.mo` file or a folder that is a package, as written; `None` for a class that ships with bramah.
    pub model: Option<String>,
    /// The class to run, by its dotted name.
    pub class: Option<String>,
    /// The model's inputs and the columns that drive them.
    pub inputs: Vec<InputColumn>,
    /// What was measured.
    pub signals: Vec<SignalColumn>,
    /// The recordings, in the order of the file.
    pub recordings: Vec<RecordingFile>,
    /// What is known about parameters.
    pub parameters: Vec<ParameterEntry>,
    /// What the diagnosis may propose.
    pub effects: EffectChoice,
}

/// An entry of `[inputs]`.
#[derive(Clone, Debug, PartialEq)]
pub struct InputColumn {
    /// The model's input.
    pub name: String,
    /// The column of the recordings; the input's name where the study does not say.
    pub column: String,
    /// The column's unit, where the study says it.
    pub unit: Option<String>,
    /// Each sample holds until the next; else straight lines join them.
    pub hold: bool,
    /// A sensor shows it: it is no command that may be limited or come late inside the machine.
    pub measured: bool,
    /// Where the entry stands.
    pub span: Span,
}

/// An entry of `[signals]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalColumn {
    /// The name that reports use.
    pub name: String,
    /// The model's variable; the signal's name where the study does not say.
    pub variable: String,
    /// The column of the recordings; the signal's name where the study does not say.
    pub column: String,
    /// The column's unit, where the study says it.
    pub unit: Option<String>,
    /// 1 or -1: the column times this is the variable.
    pub sign: f64,
    /// The sensor's range.
    pub full_scale: Option<Amount>,
    /// One standard deviation: absolute, or as part of the full scale.
    pub accuracy: Option<Amount>,
    /// Where the entry stands.
    pub span: Span,
}

/// What a recording is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingRole {
    /// Selection and fitting.
    Train,
    /// Judging the result; never used before.
    Held,
}

/// An entry of `[[recordings]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingFile {
    /// The file as written.
    pub file: String,
    /// What it is for.
    pub role: RecordingRole,
    /// The time column, where the study says it.
    pub time: Option<String>,
    /// First and last time to use, in seconds of the recording.
    pub window: Option<(f64, f64)>,
    /// It is left out where it does not exist.
    pub optional: bool,
    /// Into how many pieces that follow each other `identify` cuts it; 1 for none.
    pub pieces: usize,
    /// Where the file's name stands.
    pub span: Span,
}

/// An entry of `[parameters]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterEntry {
    /// The parameter's dotted name.
    pub name: String,
    /// True for `"exact"`: it is never moved.
    pub exact: bool,
    /// One standard deviation of the data sheet: relative, or absolute.
    pub sigma: Option<Amount>,
    /// Lower bound.
    pub min: Option<Amount>,
    /// Upper bound.
    pub max: Option<Amount>,
    /// Where the entry stands.
    pub span: Span,
}

/// The section `[effects]`; empty lists choose everything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectChoice {
    /// Only these effects or families.
    pub include: Vec<String>,
    /// Not these effects or families.
    pub exclude: Vec<String>,
    /// Only at these places.
    pub places: Vec<String>,
    /// A folder with further effects, relative to the study.
    pub folder: Option<String>,
}

impl Study {
    /// Reads a study file through `world` and adds its text to `sources`.
    ///
    /// # Errors
    /// [`Code::FileAccess`] where it cannot be read, else as [`parse`].
    pub fn read(world: &dyn World, path: &Path, sources: &mut Sources) -> StageResult<Study> {
        match world.read(path) {
            Ok(text) => {
                let file = sources.add(path.display().to_string(), text);
                parse(sources, file)
            }
            Err(why) => {
                let text = format!("`{}` cannot be read: {why}", path.display());
                StageResult::failed(vec![Diagnostic::new(Code::FileAccess, text)])
            }
        }
    }

    /// What to compile: the model file beside the study, or the class that ships with bramah.
    pub fn request(&self) -> bramah_model::compile::Request {
        let class = self.class.clone();
        let source = match &self.model {
            Some(model) => self.folder.join(model),
            None => PathBuf::from(class.clone().unwrap_or_default()),
        };
        bramah_model::compile::Request {
            source,
            model: class,
            varied: true,
            ..bramah_model::compile::Request::default()
        }
    }

    /// The recordings of one role.
    pub fn of_role(&self, role: RecordingRole) -> impl Iterator<Item = &RecordingFile> {
        self.recordings.iter().filter(move |r| r.role == role)
    }
}

#[cfg(test)]
mod tests;
