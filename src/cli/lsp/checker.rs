//! The thread that compiles: one file after another, for each the newest text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::files::{Cache, Open};
use super::texts;
use bramah_editor::hints::Facts;
use bramah_editor::messages::{Message, of_models};
use bramah_model::compile::STACK;

/// What was found about a file.
pub(super) struct Checked {
    pub path: PathBuf,
    /// The texts that it is about.
    pub open: Open,
    pub messages: Vec<Message>,
    /// Values of parameters, of this file and of those before.
    pub facts: Facts,
}

/// The other end of the thread, which ends when this is dropped.
pub(super) struct Checker {
    jobs: Sender<Job>,
    pub results: Receiver<Checked>,
    newest: Newest,
}

struct Job {
    path: PathBuf,
    open: Open,
    number: u64,
}

/// The number of the last job of each file: older ones are given up.
#[derive(Clone, Default)]
struct Newest(Arc<Mutex<BTreeMap<PathBuf, u64>>>);

impl Newest {
    fn next(&self, path: &Path) -> u64 {
        let mut numbers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let number = numbers.entry(path.to_path_buf()).or_default();
        *number += 1;
        *number
    }

    fn is(&self, job: &Job) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&job.path) == Some(&job.number)
    }
}

impl Checker {
    pub fn start(libraries: Vec<PathBuf>, cache: Cache) -> Checker {
        let (jobs, inbox) = unbounded::<Job>();
        let (outbox, results) = unbounded();
        let newest = Newest::default();
        let known = newest.clone();
        let work = move || {
            let mut facts = Facts::default();
            for job in inbox {
                let wanted = || known.is(&job);
                let messages = look(&job, &libraries, &cache, &mut facts, &wanted);
                let checked =
                    Checked { path: job.path.clone(), open: job.open.clone(), messages, facts: facts.clone() };
                if wanted() && outbox.send(checked).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
        thread.expect("a thread can be started");
        Checker { jobs, results, newest }
    }

    /// Asks for a file; what is known about it comes through `results`.
    pub fn ask(&self, path: PathBuf, open: Open) {
        let number = self.newest.next(&path);
        // without the thread there are no messages, which is no reason to end
        let _ = self.jobs.send(Job { path, open, number });
    }

    /// Gives up what was asked for a file.
    pub fn forget(&self, path: &Path) {
        self.newest.next(path);
    }
}

/// A bug must not end the thread: the next edit gets another chance.
fn look(job: &Job, libraries: &[PathBuf], cache: &Cache, facts: &mut Facts, wanted: &dyn Fn() -> bool) -> Vec<Message> {
    if !wanted() {
        return Vec::new();
    }
    let link = |path: &Path| cache.uri(path);
    let texts = texts(&job.open, libraries);
    let all = || of_models(&texts, &job.path, &link, facts, wanted);
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(all)).unwrap_or_default()
}
