//! What takes time: runs, comparisons, diagnoses. Each has a thread; the page asks how far it is.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::http::{HttpRefusal, HttpRequest, HttpResponse};
use bramah_model::compile::STACK;

/// So many jobs may run at the same time: a page with a slider begins one after the other.
const RUNNING: usize = 8;
/// So many that have ended are kept: pages that are still shown.
const KEPT: usize = 40;

/// All jobs.
#[derive(Default)]
pub(super) struct ServerJobs {
    all: Mutex<BTreeMap<u64, Arc<ServerJob>>>,
    next: AtomicU64,
}

/// A job.
pub(super) struct ServerJob {
    id: u64,
    stop: AtomicBool,
    begun: Instant,
    now: Mutex<JobProgress>,
}

#[derive(Clone, Default)]
struct JobProgress {
    stage: String,
    share: Option<f64>,
    ended: Option<JobEnd>,
}

#[derive(Clone)]
struct JobEnd {
    seconds: f64,
    result: Result<JobOutput, String>,
}

/// What a job made.
#[derive(Clone, Default)]
pub(super) struct JobOutput {
    /// What there is to say: warnings, a summary.
    pub messages: String,
    /// A complete HTML page.
    pub page: String,
    /// Files to be downloaded.
    pub files: Vec<DownloadFile>,
}

/// A file to be downloaded.
#[derive(Clone, Serialize)]
pub(super) struct DownloadFile {
    /// Without folder.
    pub name: &'static str,
    /// What it holds.
    pub text: String,
}

#[derive(Serialize)]
struct JobStatus<'a> {
    id: u64,
    state: &'static str,
    stage: &'a str,
    share: Option<f64>,
    seconds: f64,
    messages: &'a str,
    page: &'a str,
    files: &'a [DownloadFile],
}

#[derive(Deserialize)]
struct JobNumber {
    id: u64,
}

impl ServerJob {
    /// Set when the job should end.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// True when the job should end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Says how far it is.
    pub fn at(&self, stage: impl Into<String>, share: Option<f64>) {
        let mut now = self.now();
        now.stage = stage.into();
        now.share = share;
    }

    /// Seconds since it began.
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn now(&self) -> MutexGuard<'_, JobProgress> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self, result: Result<JobOutput, String>) {
        let seconds = self.seconds();
        self.now().ended = Some(JobEnd { seconds, result });
    }

    fn seen(&self) -> HttpResponse {
        let now = self.now().clone();
        let seconds = now.ended.as_ref().map_or_else(|| self.seconds(), |e| e.seconds);
        let seen = |state, messages, page, files| JobStatus {
            id: self.id,
            state,
            stage: &now.stage,
            share: now.share,
            seconds,
            messages,
            page,
            files,
        };
        HttpResponse::json(&match now.ended.as_ref().map(|e| &e.result) {
            None => seen("running", "", "", &[]),
            Some(Ok(made)) => seen("done", made.messages.as_str(), made.page.as_str(), made.files.as_slice()),
            Some(Err(why)) => seen(if self.stopped() { "stopped" } else { "failed" }, why.as_str(), "", &[]),
        })
    }
}

impl ServerJobs {
    /// Begins a job; its number is the answer.
    pub fn start(
        &self,
        work: impl FnOnce(&ServerJob) -> Result<JobOutput, String> + Send + 'static,
    ) -> Result<HttpResponse, HttpRefusal> {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let job = Arc::new(ServerJob { id, stop: AtomicBool::default(), begun: Instant::now(), now: Mutex::default() });
        let mut all = self.all();
        let ended: Vec<u64> = all.iter().filter(|(_, j)| j.now().ended.is_some()).map(|(id, _)| *id).collect();
        if all.len() - ended.len() >= RUNNING {
            return Err(HttpRefusal::new(429, format!("{RUNNING} runs are on their way; stop one, or wait")));
        }
        ended.iter().take(ended.len().saturating_sub(KEPT)).for_each(|id| drop(all.remove(id)));
        all.insert(id, job.clone());
        drop(all);
        let act = move || {
            let result = catch_unwind(AssertUnwindSafe(|| work(&job)));
            job.end(result.unwrap_or_else(|_| Err("this is a bug of bramah; its terminal says more".to_owned())));
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(act);
        thread.map_err(|why| HttpRefusal::new(503, format!("no thread can be started: {why}")))?;
        Ok(HttpResponse::json(&serde_json::json!({ "job": id })))
    }

    /// How far a job is, and what it made.
    pub fn seen(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        Ok(self.of_query(ask)?.seen())
    }

    /// The page that a job made.
    pub fn page(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        match &self.of_query(ask)?.now().ended {
            Some(JobEnd { result: Ok(made), .. }) => Ok(HttpResponse::report(made.page.clone())),
            _ => Err(HttpRefusal::new(404, "this job has no page")),
        }
    }

    /// Ends a job soon.
    pub fn stop(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let JobNumber { id } = ask.json()?;
        self.of(id)?.stop.store(true, Ordering::Relaxed);
        Ok(HttpResponse::json(&serde_json::json!({})))
    }

    fn of_query(&self, ask: &HttpRequest) -> Result<Arc<ServerJob>, HttpRefusal> {
        let id = ask.value("id").parse().map_err(|_| HttpRefusal::new(400, "`id` is the number of a job"))?;
        self.of(id)
    }

    fn of(&self, id: u64) -> Result<Arc<ServerJob>, HttpRefusal> {
        self.all().get(&id).cloned().ok_or_else(|| HttpRefusal::new(404, format!("there is no job {id} any more")))
    }

    fn all(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<ServerJob>>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
