//! The background thread that compiles the models of a file and collects their diagnostics.
//!
//! The main thread sends a file with a snapshot of all open texts; results return through a channel. Jobs are done one
//! after the other. Each has a number, and a newer job for the same file makes the older one stop early.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::files::{OpenTexts, ShippedFileCache};
use super::texts;
use bramah_editor::hints::ParameterHints;
use bramah_editor::messages::{FileDiagnostic, of_models};
use bramah_model::compile::STACK;

/// The result of one check.
pub(super) struct CheckResult {
    /// The file that was checked.
    pub path: PathBuf,
    /// The texts that were compiled. The receiver compares them with the current ones.
    pub open: OpenTexts,
    /// Diagnostics, also of other files that the models use.
    pub messages: Vec<FileDiagnostic>,
    /// Values of parameters, of this file and those checked before.
    pub facts: ParameterHints,
}

/// The main thread's handle of the checker thread. The thread ends when this is dropped, because its channel closes.
pub(super) struct BackgroundChecker {
    /// Jobs to the thread.
    jobs: Sender<CheckJob>,
    /// Results from the thread.
    pub results: Receiver<CheckResult>,
    /// Shared with the thread, which looks here whether its job is still wanted.
    newest: NewestJobs,
}

/// One file to check.
struct CheckJob {
    /// The file.
    path: PathBuf,
    /// All open texts at the time of the job. They are shared with the main thread, so a job costs little memory.
    open: OpenTexts,
    /// Compared with the newest number of the file.
    number: u64,
}

/// The number of the newest job of each file. Jobs with an older number are given up.
///
/// The mutex is held only for one look-up. A poisoned lock is used on, as the numbers are always valid.
#[derive(Clone, Default)]
struct NewestJobs(Arc<Mutex<BTreeMap<PathBuf, u64>>>);

impl NewestJobs {
    /// Assigns the next number of a file, which makes all earlier jobs of this file obsolete.
    fn next(&self, path: &Path) -> u64 {
        let mut numbers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let number = numbers.entry(path.to_path_buf()).or_default();
        *number += 1;
        *number
    }

    /// Whether this is still the newest job of its file.
    fn is(&self, job: &CheckJob) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&job.path) == Some(&job.number)
    }
}

impl BackgroundChecker {
    /// Starts the thread. It panics when the system can start no thread.
    pub fn start(libraries: Vec<PathBuf>, cache: ShippedFileCache) -> BackgroundChecker {
        let (jobs, inbox) = unbounded::<CheckJob>();
        let (outbox, results) = unbounded();
        let newest = NewestJobs::default();
        let known = newest.clone();
        let work = move || {
            // Values accumulate over the files, so that hints of files checked earlier stay.
            let mut facts = ParameterHints::default();
            for job in inbox {
                // Called often during compilation to stop early.
                let wanted = || known.is(&job);
                let messages = look(&job, &libraries, &cache, &mut facts, &wanted);
                let checked =
                    CheckResult { path: job.path.clone(), open: job.open.clone(), messages, facts: facts.clone() };
                // The job may have become obsolete while it ran. A closed channel means that the server has ended.
                if wanted() && outbox.send(checked).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
        thread.expect("a thread can be started");
        BackgroundChecker { jobs, results, newest }
    }

    /// Asks for a check of a file. The result comes through `results`.
    pub fn ask(&self, path: PathBuf, open: OpenTexts) {
        let number = self.newest.next(&path);
        // The send fails when the thread has ended. The server still answers requests without diagnostics.
        let _ = self.jobs.send(CheckJob { path, open, number });
    }

    /// Makes pending checks of a file obsolete without a new one.
    pub fn forget(&self, path: &Path) {
        self.newest.next(path);
    }
}

/// Compiles the models of one file. A panic gives no diagnostics; the thread goes on with the next job.
fn look(
    job: &CheckJob,
    libraries: &[PathBuf],
    cache: &ShippedFileCache,
    facts: &mut ParameterHints,
    wanted: &dyn Fn() -> bool,
) -> Vec<FileDiagnostic> {
    // Jobs that became obsolete in the queue cost nothing.
    if !wanted() {
        return Vec::new();
    }
    let link = |path: &Path| cache.uri(path);
    let texts = texts(&job.open, libraries);
    let all = || of_models(&texts, &job.path, &link, facts, wanted);
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(all)).unwrap_or_default()
}
