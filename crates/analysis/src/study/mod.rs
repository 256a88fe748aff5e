//! Studies: a model, recordings of its test rig and what is known about its parameters, as a TOML file.
//!
//! `identify` and `crates/gap` read the same file. It passes three stages:
//! 1. [`parse`] makes a [`Study`] of a text; names and units are still texts.
//! 2. [`Study::bind`] resolves the names in a compiled model and converts amounts to its units: a [`BoundStudy`].
//! 3. [`BoundStudy::load`] reads the recordings of one role, so that held ones can be read after the fit.
//!
//! Mistakes become diagnostics (`E6xx`) at their places in the study. The reference of the file is `docs/study.md`.

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

/// The contents of a study file, before its names are resolved in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The folder of the study file; relative paths start here.
    pub folder: PathBuf,
    /// A `.mo` file or a package folder, as written; `None` for a class that ships with bramah.
    pub model: Option<String>,
    /// The dotted name of the class to run; `None` where the file has only one.
    pub class: Option<String>,
    /// The model's inputs and the columns that drive them.
    pub inputs: Vec<InputColumn>,
    /// The measured signals and their columns.
    pub signals: Vec<SignalColumn>,
    /// The recordings, in the order of the file.
    pub recordings: Vec<RecordingFile>,
    /// What is known about parameters.
    pub parameters: Vec<ParameterEntry>,
    /// Which effects the diagnosis (`gap`) may propose.
    pub effects: EffectChoice,
}

/// An entry of `[inputs]`: the column that drives an input.
#[derive(Clone, Debug, PartialEq)]
pub struct InputColumn {
    /// The name of the model's input.
    pub name: String,
    /// The column of the recordings; by default the input's name.
    pub column: String,
    /// The unit of the column; `None` where the study does not state it.
    pub unit: Option<String>,
    /// True: each sample holds until the next one. False: linear interpolation.
    pub hold: bool,
    /// True for `kind = "measured"`: the value comes from a sensor. False: a controller commands it, so that a dead
    /// zone, a limit or a lag inside the machine may act on it.
    pub measured: bool,
    /// Where the entry stands.
    pub span: Span,
}

/// An entry of `[signals]`: a measured variable of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalColumn {
    /// The name that reports use.
    pub name: String,
    /// The name of the model's variable; by default the signal's name.
    pub variable: String,
    /// The column of the recordings; by default the signal's name.
    pub column: String,
    /// The unit of the column; `None` where the study does not state it.
    pub unit: Option<String>,
    /// 1 or -1: the column times this is the variable.
    pub sign: f64,
    /// The sensor's range; `None` for peak to peak over the train recordings.
    pub full_scale: Option<Amount>,
    /// One standard deviation of the sensor, absolute or relative to the full scale; `None` for what the data show.
    pub accuracy: Option<Amount>,
    /// Where the entry stands.
    pub span: Span,
}

/// The role of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingRole {
    /// It is fitted to.
    Train,
    /// It validates the result and is never used before.
    Held,
}

/// An entry of `[[recordings]]`: a file with its role and window.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingFile {
    /// The file as written.
    pub file: String,
    /// Its role.
    pub role: RecordingRole,
    /// The time column; `None` for the usual names, else the first column.
    pub time: Option<String>,
    /// First and last time to use, in seconds of the recording; `None` for all.
    pub window: Option<(f64, f64)>,
    /// Whether it is skipped when the file does not exist.
    pub optional: bool,
    /// Number of pieces for multiple shooting; 1 where it is not cut.
    pub pieces: usize,
    /// Where the file's name stands.
    pub span: Span,
}

/// An entry of `[parameters]`: how well a parameter is known.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterEntry {
    /// The parameter's dotted name.
    pub name: String,
    /// True for `"exact"`: the parameter is never changed.
    pub exact: bool,
    /// One standard deviation of the data sheet, relative or absolute; `None` for bounds alone.
    pub sigma: Option<Amount>,
    /// Lower bound.
    pub min: Option<Amount>,
    /// Upper bound.
    pub max: Option<Amount>,
    /// Where the entry stands.
    pub span: Span,
}

/// The section `[effects]`. Empty lists do not restrict anything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectChoice {
    /// Only these effects or families.
    pub include: Vec<String>,
    /// Not these effects or families.
    pub exclude: Vec<String>,
    /// Only at these places.
    pub places: Vec<String>,
    /// A folder with further effects, relative to the study; `None` for the shipped ones alone.
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

    /// The compilation request: the model file beside the study, or the class that ships with bramah.
    pub fn request(&self) -> bramah_model::compile::Request {
        let class = self.class.clone();
        let source = match &self.model {
            Some(model) => self.folder.join(model),
            None => PathBuf::from(class.clone().unwrap_or_default()),
        };
        // Parameters take other values later, so one that is 0 now must not remove a derivative from the equations.
        bramah_model::compile::Request {
            source,
            model: class,
            varied: true,
            ..bramah_model::compile::Request::default()
        }
    }

    /// The recordings of one role, in the order of the file.
    pub fn of_role(&self, role: RecordingRole) -> impl Iterator<Item = &RecordingFile> {
        self.recordings.iter().filter(move |r| r.role == role)
    }
}

#[cfg(test)]
mod tests;
