//! Studies: recordings, the text that ties them to a circuit, comparison and diagnosis.

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

/// The name under which messages show the text of the page.
const STUDY: &str = "study.toml";

/// Recordings that were uploaded and are not in the folder.
#[derive(Default)]
pub(super) struct UploadStore {
    files: Mutex<BTreeMap<String, String>>,
}

#[derive(Serialize)]
struct RecordingColumns {
    name: String,
    rows: usize,
    time: String,
    start: f64,
    end: f64,
    columns: Vec<RecordingColumn>,
}

#[derive(Serialize)]
struct RecordingColumn {
    name: String,
    unit: String,
}

impl UploadStore {
    /// Takes a recording.
    pub fn take(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let name = ask.value("name").to_owned();
        if name.is_empty() || name.contains(['/', '\\']) || !name.to_lowercase().ends_with(".csv") {
            return Err(unusable(&name, "is no name of a recording: it ends in `.csv` and names no folder").into());
        }
        let text = ask.text();
        let columns = columns(&name, &text)?;
        self.files().insert(name, text);
        Ok(HttpResponse::json(&columns))
    }

    /// The columns of a recording, uploaded or in the folder.
    pub fn columns(&self, folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let name = ask.value("name");
        let uploaded = self.files().get(name).cloned();
        let text = match uploaded {
            Some(text) => text,
            None => folder.text(name)?,
        };
        Ok(HttpResponse::json(&columns(name, &text)?))
    }

    fn files(&self) -> MutexGuard<'_, BTreeMap<String, String>> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn columns(name: &str, text: &str) -> Result<RecordingColumns, HttpRefusal> {
    let mut sources = Sources::default();
    let file = sources.add(name.to_owned(), text.to_owned());
    let read = read_csv(&sources, file, None, ReadStrictness::Result);
    let Some(found) = read.value else { return Err(HttpRefusal::of(&read.diagnostics, &sources)) };
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

/// The text of a study in the folder, and the folder that its paths begin in.
pub(super) fn text(folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let file = ask.value("file");
    let text = folder.text(file)?;
    let within = Path::new(file).parent().unwrap_or(Path::new("")).display().to_string();
    Ok(HttpResponse::json(&serde_json::json!({ "text": text, "folder": within })))
}

#[derive(Deserialize)]
struct StudyText {
    text: String,
    #[serde(default)]
    folder: String,
}

/// A study as the page's form has it.
#[derive(Serialize)]
struct StudyForm {
    model: String,
    class: String,
    inputs: Vec<InputForm>,
    signals: Vec<SignalForm>,
    recordings: Vec<RecordingForm>,
    parameters: Vec<ParameterForm>,
    effects: EffectsForm,
}

#[derive(Serialize)]
struct InputForm {
    name: String,
    column: String,
    unit: String,
    hold: bool,
    kind: &'static str,
}

#[derive(Serialize)]
struct SignalForm {
    name: String,
    variable: String,
    column: String,
    unit: String,
    sign: f64,
    full_scale: String,
    accuracy: String,
}

#[derive(Serialize)]
struct RecordingForm {
    file: String,
    role: &'static str,
    time: String,
    window: Option<(f64, f64)>,
    optional: bool,
    pieces: usize,
}

#[derive(Serialize)]
struct ParameterForm {
    name: String,
    entry: &'static str,
    sigma: String,
    min: String,
    max: String,
}

#[derive(Serialize)]
struct EffectsForm {
    include: Vec<String>,
    exclude: Vec<String>,
    places: Vec<String>,
    folder: String,
}

impl StudyForm {
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

/// Reads the text of a study into the page's form.
pub(super) fn read(folder: &ServerFolder, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let given: StudyText = ask.json()?;
    let mut sources = Sources::default();
    Ok(HttpResponse::json(&StudyForm::of(parsed(folder, &given, &mut sources)?)))
}

fn parsed(folder: &ServerFolder, given: &StudyText, sources: &mut Sources) -> Result<Study, HttpRefusal> {
    folder.inside(&given.folder)?;
    let file = sources.add(Path::new(&given.folder).join(STUDY).display().to_string(), given.text.clone());
    let checked = parse(sources, file);
    checked.value.ok_or_else(|| HttpRefusal::of(&checked.diagnostics, sources))
}

/// Puts model and recordings side by side.
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

/// Diagnoses the gap.
pub(super) fn diagnose(
    folder: &ServerFolder,
    ask: &HttpRequest,
    uploads: &UploadStore,
    jobs: &ServerJobs,
) -> Result<HttpResponse, HttpRefusal> {
    begin(folder, ask, uploads, jobs, |question, sources, job| {
        let held = question.held(None, sources).map_err(|d| full(sources, &d))?;
        let mut progress = |stage: bramah_gap::Stage| {
            job.at(stage.to_string(), None);
            if job.stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
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
        files.extend(fixed.value.map(|text| DownloadFile { name: "fixed.mo", text }));
        let warnings = [diagnosis.diagnostics(), &fixed.diagnostics].concat();
        let messages = format!("{}\n\n{}", full(sources, &warnings), diagnosis.words());
        Ok(JobOutput { messages: messages.trim().to_owned(), page: report, files })
    })
}

/// Begins a job on the question that a study asks, with uploaded recordings laid over the folder of the study.
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
    stays_inside(folder, &study)?;
    let mut files = MemoryWorld::default();
    for (name, text) in uploads.files().iter() {
        files.add(study.folder.join(name), text.clone());
    }
    jobs.start(move |job| {
        job.at("reading", None);
        let world = Overlay { base: &DiskWorld, files };
        match question(&world, &study, None, &mut sources) {
            Ok(question) => work(question, &mut sources, job),
            Err(StudyError { diagnostics, sources: of_model, .. }) => {
                Err(full(of_model.as_ref().unwrap_or(&sources), &diagnostics))
            }
        }
    })
}

/// Files that a study names lie in the folder that is served.
fn stays_inside(folder: &ServerFolder, study: &Study) -> Result<(), HttpRefusal> {
    let files = study.recordings.iter().map(|r| &r.file).chain(&study.model).chain(&study.effects.folder);
    for file in files {
        folder.inside(&lexical(&study.folder.join(file)))?;
    }
    Ok(())
}

/// `rig/../press` as `press`: a study may name what lies beside its folder.
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

#[derive(Deserialize)]
struct SaveRequest {
    file: String,
    text: String,
    #[serde(default)]
    replace: bool,
}

/// Writes a study and the uploaded recordings that it names.
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
    let study = parsed(folder, &given, &mut Sources::default())?;
    let mut written = vec![(file.clone(), given.text.clone())];
    for recording in &study.recordings {
        let name = within.join(&recording.file).display().to_string();
        written.extend(uploads.files().get(&recording.file).map(|text| (name, text.clone())));
    }
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
