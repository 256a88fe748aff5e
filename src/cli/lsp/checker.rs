//! The thread that compiles: one file after another, for each the newest text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::files::{OpenTexts, ShippedFileCache};
use super::texts;
use bramah_editor::hints::ParameterHints;
use bramah_editor::messages::{FileDiagnostic, of_models};
use bramah_model::compile::STACK;

/// What was found about a file.
pub(super) struct CheckResult {
    pub path: PathBuf,
    /// The texts that it is about.
    pub open: OpenTexts,
    pub messages: Vec<FileDiagnostic>,
    /// Values of parameters, of this file and of those before.
    pub facts: ParameterHints,
}

/// The other end of the thread, which ends when this is dropped.
pub(super) struct BackgroundChecker {
    jobs: Sender<CheckJob>,
    pub results: Receiver<CheckResult>,
    newest: NewestJobs,
}

struct CheckJob {
    path: PathBuf,
    open: OpenTexts,
    number: u64,
}

/// The number of the last job of each file: older ones are given up.
#[derive(Clone, Default)]
struct NewestJobs(Arc<Mutex<BTreeMap<PathBuf, u64>>>);

impl NewestJobs {
    fn next(&self, path: &Path) -> u64 {
        let mut numbers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let number = numbers.entry(path.to_path_buf()).or_default();
        *number += 1;
        *number
    }

    fn is(&self, job: &CheckJob) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&job.path) == Some(&job.number)
    }
}

impl BackgroundChecker {
    pub fn start(libraries: Vec<PathBuf>, cache: ShippedFileCache) -> BackgroundChecker {
        let (jobs, inbox) = unbounded::<CheckJob>();
        let (outbox, results) = unbounded();
        let newest = NewestJobs::default();
        let known = newest.clone();
        let work = move || {
            let mut facts = ParameterHints::default();
            for job in inbox {
                let wanted = || known.is(&job);
                let messages = look(&job, &libraries, &cache, &mut facts, &wanted);
                let checked =
                    CheckResult { path: job.path.clone(), open: job.open.clone(), messages, facts: facts.clone() };
                if wanted() && outbox.send(checked).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
        thread.expect("a thread can be started");
        BackgroundChecker { jobs, results, newest }
    }

    /// Asks for a file; what is known about it comes through `results`.
    pub fn ask(&self, path: PathBuf, open: OpenTexts) {
        let number = self.newest.next(&path);
        // without the thread there are no messages, which is no reason to end
        let _ = self.jobs.send(CheckJob { path, open, number });
    }

    /// Gives up what was asked for a file.
    pub fn forget(&self, path: &Path) {
        self.newest.next(path);
    }
}

/// A bug must not end the thread: the next edit gets another chance.
fn look(
    job: &CheckJob,
    libraries: &[PathBuf],
    cache: &ShippedFileCache,
    facts: &mut ParameterHints,
    wanted: &dyn Fn() -> bool,
) -> Vec<FileDiagnostic> {
    if !wanted() {
        return Vec::new();
    }
    let link = |path: &Path| cache.uri(path);
    let texts = texts(&job.open, libraries);
    let all = || of_models(&texts, &job.path, &link, facts, wanted);
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(all)).unwrap_or_default()
}
