//! Jobs of the server: simulations, comparisons and diagnoses that take longer than a request may.
//!
//! `circuits` and `studies` start a job with a closure; the page polls `/api/job` for its state and fetches the result.
//! Each job runs on its own thread with a deep stack.
//!
//! Locks: `ServerJobs::all` guards the table of jobs, `ServerJob::now` the state of one job. A thread may take the
//! second while it holds the first, never the other way round. Neither is held while a job works.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::http::{HttpRefusal, HttpRequest, HttpResponse};
use bramah_model::compile::STACK;

/// Jobs that may run at the same time. A slider on the page starts one after the other, faster than they end.
const RUNNING: usize = 8;
/// Finished jobs that are kept for pages that still show them. The oldest are dropped first.
const KEPT: usize = 40;

/// All running jobs and the last finished ones.
#[derive(Default)]
pub(super) struct ServerJobs {
    /// Jobs by number. Numbers grow with time.
    all: Mutex<BTreeMap<u64, Arc<ServerJob>>>,
    /// The number of the next job.
    next: AtomicU64,
}

/// One job, shared by its thread and the worker threads that report on it.
pub(super) struct ServerJob {
    /// Number in requests.
    id: u64,
    /// Set when the user stops the job. The work polls it.
    stop: AtomicBool,
    /// When the job started.
    begun: Instant,
    /// State for the page.
    now: Mutex<JobProgress>,
}

/// How far a job is.
#[derive(Clone, Default)]
struct JobProgress {
    /// What it does now, in words.
    stage: String,
    /// Share of the work done, 0 to 1; `None` when it is not known.
    share: Option<f64>,
    /// The result; `None` while the job runs.
    ended: Option<JobEnd>,
}

/// How a job ended.
#[derive(Clone)]
struct JobEnd {
    /// Duration of the job.
    seconds: f64,
    /// The output, or the message why there is none.
    result: Result<JobOutput, String>,
}

/// The result of a job.
#[derive(Clone, Default)]
pub(super) struct JobOutput {
    /// Warnings and a summary, as text.
    pub messages: String,
    /// A complete HTML page with the result.
    pub page: String,
    /// Files offered for download.
    pub files: Vec<DownloadFile>,
}

/// A file offered for download.
#[derive(Clone, Serialize)]
pub(super) struct DownloadFile {
    /// File name without a folder.
    pub name: &'static str,
    /// Content of the file.
    pub text: String,
}

/// The JSON answer of `/api/job`.
#[derive(Serialize)]
// Borrows from a copy of the state, so that nothing is copied twice.
struct JobStatus<'a> {
    /// Number of the job.
    id: u64,
    /// `running`, `done`, `stopped` or `failed`.
    state: &'static str,
    /// What the job does now, in words.
    stage: &'a str,
    /// Share of the work done, 0 to 1; null when it is not known.
    share: Option<f64>,
    /// Since the start, or the total when the job has ended.
    seconds: f64,
    /// Warnings and a summary, or why the job failed.
    messages: &'a str,
    /// The result as an HTML page; empty until the job has ended well.
    page: &'a str,
    /// Files offered for download.
    files: &'a [DownloadFile],
}

/// The JSON body of a request to stop a job.
#[derive(Deserialize)]
struct JobNumber {
    /// Number of the job.
    id: u64,
}

impl ServerJob {
    /// The flag that is set when the job should end, for solvers that poll a flag.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Whether the job should end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Sets what the job does now and how far it is (0 to 1).
    pub fn at(&self, stage: impl Into<String>, share: Option<f64>) {
        let mut now = self.now();
        now.stage = stage.into();
        now.share = share;
    }

    /// Seconds since the start of the job.
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Locks the state. A poisoned lock is used on, because the state is complete after each assignment.
    fn now(&self) -> MutexGuard<'_, JobProgress> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores the result and the duration.
    fn end(&self, result: Result<JobOutput, String>) {
        let seconds = self.seconds();
        self.now().ended = Some(JobEnd { seconds, result });
    }

    /// The state of the job as JSON.
    fn seen(&self) -> HttpResponse {
        // Copied, so that the lock is not held while the answer is written.
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
            // A stopped run ends with an error too. The page must not show it as a failure.
            Some(Err(why)) => seen(if self.stopped() { "stopped" } else { "failed" }, why.as_str(), "", &[]),
        })
    }
}

impl ServerJobs {
    /// Starts a job on a new thread and answers with its number.
    ///
    /// `Err`: 429 when too many jobs run, 503 when no thread can be started.
    pub fn start(
        &self,
        work: impl FnOnce(&ServerJob) -> Result<JobOutput, String> + Send + 'static,
    ) -> Result<HttpResponse, HttpRefusal> {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let job = Arc::new(ServerJob { id, stop: AtomicBool::default(), begun: Instant::now(), now: Mutex::default() });
        // Held over the count and the insertion, so that two requests cannot both take the last place.
        let mut all = self.all();
        let ended: Vec<u64> = all.iter().filter(|(_, j)| j.now().ended.is_some()).map(|(id, _)| *id).collect();
        if all.len() - ended.len() >= RUNNING {
            return Err(HttpRefusal::new(429, format!("{RUNNING} runs are on their way; stop one, or wait")));
        }
        // The table is sorted by number, so the first ones are the oldest.
        ended.iter().take(ended.len().saturating_sub(KEPT)).for_each(|id| drop(all.remove(id)));
        all.insert(id, job.clone());
        drop(all);
        let act = move || {
            // A panic in a job ends only this job.
            let result = catch_unwind(AssertUnwindSafe(|| work(&job)));
            job.end(result.unwrap_or_else(|_| Err("this is a bug of bramah; its terminal says more".to_owned())));
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(act);
        thread.map_err(|why| HttpRefusal::new(503, format!("no thread can be started: {why}")))?;
        Ok(HttpResponse::json(&serde_json::json!({ "job": id })))
    }

    /// The state of the job that the query names, with its result.
    pub fn seen(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        Ok(self.of_query(ask)?.seen())
    }

    /// The HTML page that a job made. `Err` (404): it has none, or not yet.
    pub fn page(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        match &self.of_query(ask)?.now().ended {
            Some(JobEnd { result: Ok(made), .. }) => Ok(HttpResponse::report(made.page.clone())),
            _ => Err(HttpRefusal::new(404, "this job has no page")),
        }
    }

    /// Asks a job to end. The answer does not wait for the end.
    pub fn stop(&self, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
        let JobNumber { id } = ask.json()?;
        self.of(id)?.stop.store(true, Ordering::Relaxed);
        Ok(HttpResponse::json(&serde_json::json!({})))
    }

    /// The job whose number is in the query. `Err`: 400 for no number, 404 for an unknown job.
    fn of_query(&self, ask: &HttpRequest) -> Result<Arc<ServerJob>, HttpRefusal> {
        let id = ask.value("id").parse().map_err(|_| HttpRefusal::new(400, "`id` is the number of a job"))?;
        self.of(id)
    }

    /// The job with a number. `Err` (404): it never existed or was dropped.
    fn of(&self, id: u64) -> Result<Arc<ServerJob>, HttpRefusal> {
        self.all().get(&id).cloned().ok_or_else(|| HttpRefusal::new(404, format!("there is no job {id} any more")))
    }

    /// Locks the table of jobs. A poisoned lock is used on, as no operation leaves it half changed.
    fn all(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<ServerJob>>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
