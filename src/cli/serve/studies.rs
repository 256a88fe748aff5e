//! Answers about studies: uploads of recordings, reading and saving a study, comparison and diagnosis.
//!
//! The page edits a study as text and as a form. The text (TOML) enters with each request; the parsed form, or the
//! number of a job, leaves. Recordings come from the folder or from uploads, which are kept in memory until the study
//! is saved.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::super::files;
use super::folder::{ServerFolder, unusable};
use super::http::{HttpRefusal, HttpRequest, HttpResponse};
use super::jobs::{DownloadFile, JobOutput, ServerJob, ServerJobs};
use bramah_analysis::study::{Amount, RecordingRole, Study, parse};
use bramah_gap::study::{DiagnosisStudy, StudyError, question};
use bramah_gap::{Budget, DiagnoseOptions, Diagnosis};
use bramah_plot::html;
use bramah_results::recording::column_names;
use bramah_results::{ReadStrictness, read_csv};
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Code, Diagnostic, Sources};
use bramah_syntax::world::{DiskWorld, MemoryWorld, Overlay};

/// The file name that messages show for the study text of the page.
const STUDY: &str = "study.toml";

/// Uploaded recordings that are not in the folder. They are lost when the server ends, unless the study is saved.
#[derive(Default)]
pub(super) struct UploadStore {
    /// Texts by file name.
    files: Mutex<BTreeMap<String, String>>,
}

/// Summary of a recording: the JSON answer to an upload.
#[derive(Serialize)]
struct RecordingColumns {
    /// File name.
    name: String,
    /// Number of rows.
    rows: usize,
    /// Name of the time column.
    time: String,
    /// Time of the first row in seconds.
    start: f64,
    /// Time of the last row in seconds.
    end: f64,
    /// All columns but the time.
    columns: Vec<RecordingColumn>,
}

/// A column of a recording.
#[derive(Serialize)]
struct RecordingColumn {
    /// Name without the unit.
    name: String,
    /// Unit as the file states it; empty when it does not.
    unit: String,
}

impl UploadStore {
    /// Stores an uploaded CSV file and answers with its columns. `Err`: the name is no plain file name, or the text
    /// cannot be read.
    pub fn take(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let name = ask.value("name").to_owned();
        // The name is joined to a folder later, so it must not contain one.
        if name.is_empty() || name.contains(['/', '\\']) || !name.to_lowercase().ends_with(".csv") {
            return Err(unusable(&name, "is no name of a recording: it ends in `.csv` and names no folder").into());
        }
        let text = ask.text();
        // Read before it is stored, so that only usable recordings are kept.
        let columns = columns(&name, &text)?;
        self.files().insert(name, text);
        Ok(HttpResponse::json(&columns))
    }

    /// The columns of a recording. An upload takes precedence over a file of the same name in the folder.
    pub fn columns(&self, folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let name = ask.value("name");
        // The lock is released at the end of this statement, before the disk is read.
        let uploaded = self.files().get(name).cloned();
        let text = match uploaded {
            Some(text) => text,
            None => folder.text(name)?,
        };
        Ok(HttpResponse::json(&columns(name, &text)?))
    }

    /// Locks the uploads. A poisoned lock is used on.
    fn files(&self) -> MutexGuard<'_, BTreeMap<String, String>> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads a CSV text and describes its columns. `Err` (422) has the diagnostics of the reader.
fn columns(name: &str, text: &str) -> Result<RecordingColumns, HttpRefusal> {
    let mut sources = Sources::default();
    let file = sources.add(name.to_owned(), text.to_owned());
    let read = read_csv(&sources, file, None, ReadStrictness::Result);
    let Some(found) = read.value else { return Err(HttpRefusal::of(&read.diagnostics, &sources)) };
    // The reader leaves the time column out of the signals.
    let is_time = |n: &String| found.index(n).is_none();
    Ok(RecordingColumns {
        name: name.to_owned(),
        rows: found.times.len(),
        time: column_names(text).into_iter().find(is_time).unwrap_or_default(),
        start: found.times.first().copied().unwrap_or(0.0),
        end: found.times.last().copied().unwrap_or(0.0),
        columns: found.signals.into_iter().map(|s| RecordingColumn { name: s.name, unit: s.unit }).collect(),
    })
}

/// The text of a study file, and the folder to which its paths are relative.
pub(super) fn text(folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let file = ask.value("file");
    let text = folder.text(file)?;
    let within = Path::new(file).parent().unwrap_or(Path::new("")).display().to_string();
    Ok(HttpResponse::json(&serde_json::json!({ "text": text, "folder": within })))
}

/// The JSON body of requests about a study.
#[derive(Deserialize)]
struct StudyText {
    /// The study as TOML text.
    text: String,
    /// Folder to which the paths of the study are relative.
    #[serde(default)]
    folder: String,
}

/// A study in the form that the page edits. Optional values are texts, empty when they are missing.
#[derive(Serialize)]
struct StudyForm {
    /// File or package of the model, relative to the study.
    model: String,
    /// Class of the model; empty for the one that can run.
    class: String,
    /// Inputs that columns drive.
    inputs: Vec<InputForm>,
    /// Recorded signals.
    signals: Vec<SignalForm>,
    /// Recordings.
    recordings: Vec<RecordingForm>,
    /// Parameters with what is known about them.
    parameters: Vec<ParameterForm>,
    /// Which effects the diagnosis considers.
    effects: EffectsForm,
}

/// An input that a column drives.
#[derive(Serialize)]
struct InputForm {
    /// Name of the model's input.
    name: String,
    /// Name of the column.
    column: String,
    /// Unit of the column; empty when the study does not state it.
    unit: String,
    /// Samples are held until the next one; otherwise joined by straight lines.
    hold: bool,
    /// `measured` or `command`.
    kind: &'static str,
}

/// A recorded signal with the variable it belongs to.
#[derive(Serialize)]
struct SignalForm {
    /// Name of the signal in the study.
    name: String,
    /// Variable of the model.
    variable: String,
    /// Name of the column.
    column: String,
    /// Unit of the column; empty when the study does not state it.
    unit: String,
    /// 1 or -1: the column may have the opposite sign.
    sign: f64,
    /// Range of the sensor.
    full_scale: String,
    /// One standard deviation of the sensor, absolute or relative to its range.
    accuracy: String,
}

/// A recording of the study.
#[derive(Serialize)]
struct RecordingForm {
    /// File name as the study writes it.
    file: String,
    /// `train` or `held`.
    role: &'static str,
    /// Name of the time column; empty for the usual one.
    time: String,
    /// First and last time used, in seconds; `None` for all.
    window: Option<(f64, f64)>,
    /// The file may be missing.
    optional: bool,
    /// Number of pieces for multiple shooting; 1 when the recording is not cut.
    pieces: usize,
}

/// A parameter of the study.
#[derive(Serialize)]
struct ParameterForm {
    /// Full name in the model.
    name: String,
    /// `exact` for a value that is taken as known, else empty.
    entry: &'static str,
    /// One standard deviation of the data sheet, relative or absolute.
    sigma: String,
    /// Lower limit.
    min: String,
    /// Upper limit.
    max: String,
}

/// Which effects the diagnosis considers, and where.
#[derive(Serialize)]
struct EffectsForm {
    /// Effects to consider; empty for all.
    include: Vec<String>,
    /// Effects to leave out.
    exclude: Vec<String>,
    /// Places to consider; empty for all.
    places: Vec<String>,
    /// Folder with effects of the user; empty for none.
    folder: String,
}

impl StudyForm {
    /// Converts a parsed study.
    fn of(study: Study) -> Self {
        let amount = |a: Option<Amount>| a.map_or_else(String::new, |a| a.to_string());
        let role = |role| if role == RecordingRole::Train { "train" } else { "held" };
        let kind = |measured| if measured { "measured" } else { "command" };
        StudyForm {
            model: study.model.unwrap_or_default(),
            class: study.class.unwrap_or_default(),
            inputs: study
                .inputs
                .into_iter()
                .map(|i| InputForm {
                    name: i.name,
                    column: i.column,
                    unit: i.unit.unwrap_or_default(),
                    hold: i.hold,
                    kind: kind(i.measured),
                })
                .collect(),
            signals: study
                .signals
                .into_iter()
                .map(|s| SignalForm {
                    name: s.name,
                    variable: s.variable,
                    column: s.column,
                    unit: s.unit.unwrap_or_default(),
                    sign: s.sign,
                    full_scale: amount(s.full_scale),
                    accuracy: amount(s.accuracy),
                })
                .collect(),
            recordings: study
                .recordings
                .into_iter()
                .map(|r| RecordingForm {
                    file: r.file,
                    role: role(r.role),
                    time: r.time.unwrap_or_default(),
                    window: r.window,
                    optional: r.optional,
                    pieces: r.pieces,
                })
                .collect(),
            parameters: study
                .parameters
                .into_iter()
                .map(|p| ParameterForm {
                    name: p.name,
                    entry: if p.exact { "exact" } else { "" },
                    sigma: amount(p.sigma),
                    min: amount(p.min),
                    max: amount(p.max),
                })
                .collect(),
            effects: EffectsForm {
                include: study.effects.include,
                exclude: study.effects.exclude,
                places: study.effects.places,
                folder: study.effects.folder.unwrap_or_default(),
            },
        }
    }
}

/// Parses the study text of the page and answers with its form. `Err` (422) has the diagnostics.
pub(super) fn read(folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let given: StudyText = ask.json()?;
    let mut sources = Sources::default();
    Ok(HttpResponse::json(&StudyForm::of(parsed(folder, &given, &mut sources)?)))
}

/// Parses a study text. `Err`: its folder is outside the served one (403), or it has errors (422).
fn parsed(folder: &ServerFolder, given: &StudyText, sources: &mut Sources) -> Result<Study, HttpRefusal> {
    folder.inside(&given.folder)?;
    let file = sources.add(Path::new(&given.folder).join(STUDY).display().to_string(), given.text.clone());
    let checked = parse(sources, file);
    checked.value.ok_or_else(|| HttpRefusal::of(&checked.diagnostics, sources))
}

/// Starts a job that simulates along the recordings and draws model and recordings together.
///
/// The result is a page with one panel for each signal. Nothing is fitted but the initial state.
pub(super) fn compare(
    folder: &ServerFolder,
    ask: &HttpRequest,
    uploads: &UploadStore,
    jobs: &ServerJobs,
) -> Result<HttpResponse, HttpRefusal> {
    begin(folder, ask, uploads, jobs, |question, sources, job| {
        job.at("simulating along the recordings", None);
        let warnings = full(sources, &question.diagnostics);
        let figure = question.compared().map_err(|d| full(sources, &d))?;
        Ok(JobOutput { messages: warnings, page: html::write(&figure, &[]), files: Vec::new() })
    })
}

/// Starts a job that diagnoses where model and recordings differ. The result has a report and files for download.
///
/// The search has its usual budget of time. The user can stop the job earlier.
pub(super) fn diagnose(
    folder: &ServerFolder,
    ask: &HttpRequest,
    uploads: &UploadStore,
    jobs: &ServerJobs,
) -> Result<HttpResponse, HttpRefusal> {
    begin(folder, ask, uploads, jobs, |question, sources, job| {
        let held = question.held(None, sources).map_err(|d| full(sources, &d))?;
        let mut progress = |stage: bramah_gap::Stage| {
            // The diagnosis calls this at each stage, and ends when it returns `Break`.
            job.at(stage.to_string(), None);
            if job.stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        // The clock is passed in because the crates below the command do not read it.
        let gone = || Duration::from_secs_f64(job.seconds());
        let budget = Some(Budget { time: None, gone: &gone });
        let options = DiagnoseOptions { budget, ..DiagnoseOptions::default() };
        let mut diagnosis = Diagnosis::new(question, held, options, &mut progress).map_err(|d| full(sources, &d))?;
        diagnosis.took(job.seconds());
        let report = diagnosis.report();
        let verdict = serde_json::to_string_pretty(diagnosis.verdict()).expect("numbers and texts always serialize");
        let mut files = vec![
            DownloadFile { name: "verdict.json", text: verdict },
            DownloadFile { name: "report.html", text: report.clone() },
        ];
        let fixed = diagnosis.corrected();
        // The file is left out when the corrected model cannot be written; its diagnostics are shown instead.
        files.extend(fixed.value.map(|text| DownloadFile { name: "fixed.mo", text }));
        let warnings = [diagnosis.diagnostics(), &fixed.diagnostics].concat();
        let messages = format!("{}\n\n{}", full(sources, &warnings), diagnosis.words());
        Ok(JobOutput { messages: messages.trim().to_owned(), page: report, files })
    })
}

/// Starts a job on the question that a study asks.
///
/// Uploaded recordings shadow files of the study's folder. `work` runs in the job. `Err`: the study cannot be parsed or
/// names files outside the served folder.
fn begin(
    folder: &ServerFolder,
    ask: &HttpRequest,
    uploads: &UploadStore,
    jobs: &ServerJobs,
    work: impl FnOnce(DiagnosisStudy<'_>, &mut Sources, &ServerJob) -> Result<JobOutput, String> + Send + 'static,
) -> Result<HttpResponse, HttpRefusal> {
    let given: StudyText = ask.json()?;
    let mut sources = Sources::default();
    let study = parsed(folder, &given, &mut sources)?;
    // Before the job starts: the job reads files through the disk without further checks.
    stays_inside(folder, &study)?;
    let mut files = MemoryWorld::default();
    // Copied, so that later uploads do not change a running job and its lock is free.
    for (name, text) in uploads.files().iter() {
        files.add(study.folder.join(name), text.clone());
    }
    jobs.start(move |job| {
        job.at("reading", None);
        let world = Overlay { base: &DiskWorld, files };
        match question(&world, &study, None, &mut sources) {
            Ok(question) => work(question, &mut sources, job),
            // Errors of the model point into the model's texts, others into the study.
            Err(StudyError { diagnostics, sources: of_model, .. }) => {
                Err(full(of_model.as_ref().unwrap_or(&sources), &diagnostics))
            }
        }
    })
}

/// Checks that all files that a study names are inside the served folder. `Err` is a 403.
fn stays_inside(folder: &ServerFolder, study: &Study) -> Result<(), HttpRefusal> {
    let files = study.recordings.iter().map(|r| &r.file).chain(&study.model).chain(&study.effects.folder);
    for file in files {
        folder.inside(&lexical(&study.folder.join(file)))?;
    }
    Ok(())
}

/// Resolves `..` in the text of a path: `rig/../press` becomes `press`.
///
/// A study may name files next to its folder, but `guard::inside` refuses any `..`. Leading ones are kept and refused
/// there.
fn lexical(path: &Path) -> String {
    let mut kept: Vec<std::path::Component<'_>> = Vec::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir
                if kept.last().is_some_and(|l| matches!(l, std::path::Component::Normal(_))) =>
            {
                kept.pop();
            }
            other => kept.push(other),
        }
    }
    kept.iter().collect::<std::path::PathBuf>().display().to_string()
}

/// The JSON body of `/api/study/save`.
#[derive(Deserialize)]
struct SaveRequest {
    /// Path of the study file, relative to the served folder.
    file: String,
    /// The study as TOML text.
    text: String,
    /// Overwrite files that have other content.
    #[serde(default)]
    replace: bool,
}

/// Writes a study and the uploaded recordings that it names into the folder.
///
/// `Err`: the name does not end in `.toml`, the study has errors, or (409) a file exists with other content and
/// `replace` is not set.
pub(super) fn save(
    folder: &ServerFolder,
    ask: &HttpRequest,
    uploads: &UploadStore,
) -> Result<HttpResponse, HttpRefusal> {
    let SaveRequest { file, text, replace } = ask.json()?;
    if !file.to_lowercase().ends_with(".toml") {
        return Err(unusable(&file, "is no name of a study: it ends in `.toml`").into());
    }
    let within = Path::new(&file).parent().unwrap_or(Path::new(""));
    let given = StudyText { text, folder: within.display().to_string() };
    // Parsed before anything is written: the names of the recordings are needed, and a broken study is not saved.
    let study = parsed(folder, &given, &mut Sources::default())?;
    let mut written = vec![(file.clone(), given.text.clone())];
    for recording in &study.recordings {
        let name = within.join(&recording.file).display().to_string();
        written.extend(uploads.files().get(&recording.file).map(|text| (name, text.clone())));
    }
    // All files are checked before the first one is written, so that a refusal leaves the folder unchanged.
    if !replace {
        for (name, text) in &written {
            if std::fs::read(folder.inside(name)?).is_ok_and(|there| there != text.as_bytes()) {
                let d = Diagnostic::new(Code::FileAccess, format!("`{name}` is there already, with other content"));
                return Err(HttpRefusal { status: 409, messages: full(&Sources::default(), &[d]) });
            }
        }
    }
    for (name, text) in &written {
        files::write(&folder.inside(name)?, text.as_bytes())?;
    }
    let names: Vec<&String> = written.iter().map(|w| &w.0).collect();
    Ok(HttpResponse::json(&serde_json::json!({ "written": names })))
}
