//! The arguments that name a model and its run, shared by several subcommands, and experiment files.
//!
//! clap fills [`ModelArgs`] and [`RunArgs`]. [`ModelArgs::experiment`] merges them with the experiment file (TOML), if
//! FILE is one, into an `ExperimentSpecification`. A flag takes precedence over the file.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CommandFailure;
use super::files::access;
use super::messages::MessageReporter;
use bramah_analysis::experiment::{
    self, ExperimentSpecification, InputHold, InputMap, duration, event_rows, seconds, tolerance,
};
use bramah_model::resolve::ANNOTATIONS;
use bramah_results::CsvUnits;
use bramah_results::glob::split_list;
use bramah_syntax::diag::{Code, Diagnostic};

/// What to compile: shared by `check` and `simulate`.
#[derive(Args, Debug)]
pub(super) struct ModelArgs {
    /// A .mo file, a folder that is a package, an experiment file (.toml), or a class that ships with bramah
    #[arg(value_name = "FILE")]
    pub file: String,
    /// The class to use [default: the one that can run]
    #[arg(short, long, value_name = "CLASS")]
    pub model: Option<String>,
    /// Value of a parameter, with or without unit: --set pump.V="0.8 ml"; may be repeated
    #[arg(short, long = "set", value_name = "NAME=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    pub set: Vec<(String, String)>,
    /// A folder with further packages; may be repeated. MODELICAPATH is searched after them
    #[arg(short = 'L', long, value_name = "DIR")]
    pub library: Vec<String>,
    /// A C source or a shared library that external functions may call; may be repeated. With `annotations`, only what
    /// the functions' own annotations name. Needs the C compiler `cc`; the code runs unguarded
    #[arg(long, value_name = "FILE")]
    pub external: Vec<String>,
    /// Warnings are errors
    #[arg(long)]
    pub deny_warnings: bool,
}

/// How to run it.
#[derive(Args, Debug)]
pub(super) struct RunArgs {
    /// Seconds, or a time with a unit
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    start_time: Option<f64>,
    /// Seconds, or a time with a unit
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    stop_time: Option<f64>,
    /// Time between two rows of the result
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    output_interval: Option<f64>,
    /// Rows at events (two each): `all`, `none`, or how many at most [default: 100000]
    #[arg(long, value_name = "NUMBER|all|none", value_parser = event_rows)]
    event_rows: Option<u64>,
    /// Units in a CSV: behind the names (`header`, as in `line.p [Pa]`), in a row below them (`row`), or `none` [default: none]
    #[arg(long, value_name = "none|header|row")]
    csv_units: Option<CsvUnits>,
    /// Relative tolerance; the absolute one is this times a variable's nominal value
    #[arg(long, value_name = "NUMBER", value_parser = tolerance)]
    relative_tolerance: Option<f64>,
    /// Variables to write, such as 'pump.*,v[1].p'; brackets are literal; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    variables: Vec<String>,
    #[arg(short, long, value_name = "FILE", help = format!(
        "The result: {}, by its ending, or `-` for CSV on stdout [default: CLASS.csv]",
        bramah_results::formats::names()
    ))]
    output_file: Option<String>,
    /// Also draw the result: .svg, .png or .html
    #[arg(long, value_name = "FILE")]
    plot: Option<String>,
    /// A recording that drives the model's inputs
    #[arg(short, long, value_name = "CSV")]
    input: Option<String>,
    /// The recording's time column [default: `time`, or the first]
    #[arg(long, value_name = "NAME")]
    time_column: Option<String>,
    /// Which column drives which input: 'F=tau_N[N],u=u:linear'; may be repeated [default: by equal name]
    #[arg(long, value_name = "INPUT=COLUMN[UNIT],...")]
    map: Vec<String>,
    /// Between samples, where --map does not say: `held` (each step is an event) or `linear` [default: held]
    #[arg(long, value_name = "held|linear", value_parser = hold)]
    interpolation: Option<InputHold>,
    /// Write what the run cost
    #[arg(long, value_name = "JSON")]
    statistics: Option<String>,
}

/// Parses `NAME=VALUE` of `--set`. `Err` is the text that clap shows.
fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("NAME=VALUE is expected".to_owned()),
    }
}

/// Parses `--interpolation`. `Err` is the text that clap shows.
fn hold(text: &str) -> Result<InputHold, String> {
    InputHold::parse(text).ok_or_else(|| "`held` or `linear` is expected".to_owned())
}

impl ModelArgs {
    /// The experiment: the values of the flags, then those of the experiment file where FILE is one.
    ///
    /// `run` has the flags of the run; `None` for subcommands without them. `Err`: the experiment file cannot be used
    /// or does not name a model, or `--map` has errors.
    pub fn experiment(
        &self,
        run: Option<&RunArgs>,
        messages: &mut MessageReporter,
    ) -> Result<ExperimentSpecification, CommandFailure> {
        let mut flags = run.map_or_else(|| Ok(ExperimentSpecification::default()), RunArgs::experiment)?;
        flags.model = self.model.clone();
        flags.set = self.set.clone();
        flags.library = self.library.clone();
        flags.external = self.external.clone();
        // A missing flag is `None`, not `false`, so that the file can switch it on.
        flags.deny_warnings = self.deny_warnings.then_some(true);
        if !is_experiment(&self.file) {
            flags.file = Some(self.file.clone());
            return Ok(flags);
        }
        let file = read_experiment(Path::new(&self.file), messages)?;
        if file.file.is_none() {
            let text = format!("`{}` does not say which `file` to use", self.file);
            return Err(Diagnostic::new(Code::BadExperiment, text).help("add `file = \"Circuit.mo\"`").into());
        }
        Ok(flags.over(file))
    }
}

impl RunArgs {
    /// The values of these flags alone. `Err`: an entry of `--map` has errors.
    fn experiment(&self) -> Result<ExperimentSpecification, CommandFailure> {
        // Commas inside brackets belong to an index and do not split the list.
        let entries = self.map.iter().flat_map(|m| split_list(m));
        let map: Result<Vec<InputMap>, String> = entries.map(|e| InputMap::parse(&e)).collect();
        Ok(ExperimentSpecification {
            start_time: self.start_time,
            stop_time: self.stop_time,
            output_interval: self.output_interval,
            event_rows: self.event_rows,
            csv_units: self.csv_units,
            relative_tolerance: self.relative_tolerance,
            variables: self.variables.clone(),
            output_file: self.output_file.clone(),
            plot: self.plot.clone(),
            input: self.input.clone(),
            time_column: self.time_column.clone(),
            map: map.map_err(|e| CommandFailure::new(Code::BadMap, format!("`--map`: {e}")))?,
            interpolation: self.interpolation,
            statistics: self.statistics.clone(),
            ..ExperimentSpecification::default()
        })
    }
}

/// Whether FILE is an experiment file, by its ending.
fn is_experiment(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Reads an experiment file. Its paths become relative to the working directory.
///
/// `Err`: it cannot be read, is not UTF-8, or has errors.
fn read_experiment(path: &Path, messages: &mut MessageReporter) -> Result<ExperimentSpecification, CommandFailure> {
    let bytes = std::fs::read(path).map_err(|e| access(path, "read", &e))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        CommandFailure::new(Code::BadExperiment, format!("`{}` is not a text in UTF-8", path.display()))
    })?;
    let file = messages.sources.add(path.display().to_string(), text);
    let checked = experiment::parse(&messages.sources, file);
    let mut experiment = checked.value.ok_or(CommandFailure { diagnostics: checked.diagnostics })?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let beside = |file: &mut String| *file = relative(&folder, file);
    // `file` may also be the name of a shipped class. It is taken as a path only when such a file exists.
    experiment.file.iter_mut().filter(|f| folder.join(&**f).exists()).for_each(beside);
    for file in [&mut experiment.output_file, &mut experiment.plot, &mut experiment.input, &mut experiment.statistics] {
        // `-` is stdout, not a file.
        file.iter_mut().filter(|f| *f != "-").for_each(beside);
    }
    experiment.library.iter_mut().for_each(beside);
    // The word `annotations` is a setting, not a file.
    experiment.external.iter_mut().filter(|f| *f != ANNOTATIONS).for_each(beside);
    Ok(experiment)
}

/// A path of the experiment file as seen from the working directory.
fn relative(folder: &Path, file: &str) -> String {
    folder.join(file).display().to_string()
}

/// The library folders of an experiment: those of `--library`, then those of the variable MODELICAPATH.
///
/// # Errors
/// A folder of `--library` does not exist.
pub(super) fn library_folders(experiment: &ExperimentSpecification) -> Result<Vec<PathBuf>, CommandFailure> {
    folders(&experiment.library)
}

/// The folders of `--library`, followed by those of the variable MODELICAPATH.
///
/// # Errors
/// A folder of `--library` does not exist. Missing folders of MODELICAPATH are ignored, because it may name folders of
/// other tools.
pub(super) fn folders(library: &[String]) -> Result<Vec<PathBuf>, CommandFailure> {
    let mut folders: Vec<PathBuf> = Vec::new();
    for folder in library {
        if !Path::new(folder).is_dir() {
            return Err(CommandFailure::new(
                Code::FileAccess,
                format!("`--library {folder}`: there is no such folder"),
            ));
        }
        folders.push(PathBuf::from(folder));
    }
    if let Some(path) = std::env::var_os("MODELICAPATH") {
        folders.extend(std::env::split_paths(&path).filter(|p| p.is_dir()));
    }
    Ok(folders)
}
