//! The folder that is served: lists its circuits, studies and recordings, and the models that ship with bramah.
//!
//! Names from requests enter; paths inside the folder, texts and compile requests leave. `serve` makes one
//! [`ServerFolder`] and all worker threads share it.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde::Serialize;

use super::super::model::source;
use super::super::{CommandFailure, files};
use super::guard;
use super::http::HttpRefusal;
use bramah_model::compile::{Request, runnable};
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Code, Sources};
use bramah_syntax::world::{DiskWorld, World};

/// Depth of folders that are searched, the served one included.
const DEPTH: usize = 5;
/// Number of files that are listed at most, so that a large folder does not block the page.
const MOST: usize = 2000;

/// The served folder.
pub(super) struct ServerFolder {
    /// Canonical path; `guard::inside` compares with it.
    root: PathBuf,
    /// Models that ship with bramah, collected at the first request.
    shipped: OnceLock<Vec<CircuitListing>>,
}

/// Everything that the page can open; the JSON answer of `/api/folder`.
// Sent as it stands, so the names of the fields are those of the JSON.
#[derive(Serialize)]
pub(super) struct FolderContents<'a> {
    /// Path of the folder, for display.
    folder: String,
    /// Version of bramah.
    version: &'static str,
    /// Runnable models in the folder.
    circuits: Vec<CircuitListing>,
    /// Runnable models that ship with bramah.
    shipped: &'a [CircuitListing],
    /// Relative paths of study files.
    studies: Vec<String>,
    /// Relative paths of CSV files.
    recordings: Vec<String>,
    /// Circuit files that cannot be read, with the reason.
    troubles: Vec<FileProblem>,
}

/// A model that can run.
#[derive(Serialize)]
struct CircuitListing {
    /// File or package in the folder; empty for a model that ships.
    source: String,
    /// Full name of the class.
    class: String,
    /// Description of the class; may be empty.
    description: String,
}

/// A circuit file that cannot be read.
#[derive(Serialize)]
struct FileProblem {
    /// Relative path of the file.
    source: String,
    /// Rendered diagnostics.
    messages: String,
}

impl ServerFolder {
    /// Opens a folder, or the folder of a file. It becomes the working directory of the process, so that paths in
    /// messages are relative to it.
    ///
    /// `Err`: it does not exist or cannot be entered.
    pub fn new(path: &Path) -> Result<Self, CommandFailure> {
        let root = path.canonicalize().map_err(|e| files::access(path, "read", &e))?;
        // A file, such as a circuit, stands for the folder it is in.
        let root = if root.is_file() { root.parent().unwrap_or(&root).to_owned() } else { root };
        std::env::set_current_dir(&root).map_err(|e| files::access(path, "opened", &e))?;
        Ok(ServerFolder { root, shipped: OnceLock::new() })
    }

    /// The canonical path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The path for a name relative to the folder. `Err` (403): it leads out of the folder.
    pub fn inside(&self, name: &str) -> Result<PathBuf, HttpRefusal> {
        guard::inside(&self.root, name)
    }

    /// The text of a file in the folder; bytes that are not UTF-8 are replaced. `Err`: 403 outside, 404 not readable.
    pub fn text(&self, name: &str) -> Result<String, HttpRefusal> {
        let path = self.inside(name)?;
        let bytes = std::fs::read(path);
        let bytes = bytes.map_err(|_| HttpRefusal::new(404, format!("`{name}` cannot be read in this folder")))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The compile request for a circuit that the page names.
    ///
    /// `named` is a file or package in the folder; when it is empty, `class` is a model that ships. An empty `class`
    /// means the class that can run. `Err` (403): the file is outside the folder.
    pub fn request(&self, named: &str, class: &str) -> Result<Request, HttpRefusal> {
        let model = (!class.is_empty()).then(|| class.to_owned());
        if named.is_empty() {
            return Ok(Request { source: class.into(), ..Request::default() });
        }
        // Only checked. The request keeps the relative path, which appears in messages.
        self.inside(named)?;
        Ok(Request { source: source(Path::new(named)), model, ..Request::default() })
    }

    /// Lists everything that the page can open. Each circuit file is parsed to find its runnable models.
    pub fn contents(&self) -> FolderContents<'_> {
        let mut found = FolderFiles::default();
        found.walk(Path::new(""), DEPTH);
        let (mut circuits, mut troubles) = (Vec::new(), Vec::new());
        for file in found.circuits {
            let request = Request { source: source(Path::new(&file)), ..Request::default() };
            match runnable(&DiskWorld, &request) {
                Ok(all) => circuits.extend(all.into_iter().map(|r| CircuitListing {
                    source: file.clone(),
                    class: r.class,
                    description: r.description,
                })),
                // One broken file must not hide the others.
                Err(why) => troubles.push(FileProblem { source: file, messages: full(&Sources::default(), &why) }),
            }
        }
        FolderContents {
            folder: self.root.display().to_string(),
            version: env!("CARGO_PKG_VERSION"),
            circuits,
            shipped: self.shipped.get_or_init(shipped),
            studies: found.studies,
            recordings: found.recordings,
            troubles,
        }
    }
}

/// Models that ship with bramah and have an `experiment` annotation: those of `models` first, then the library's
/// examples.
fn shipped() -> Vec<CircuitListing> {
    let mut all = Vec::new();
    let mut roots = ShippedWorld::roots();
    // The sort is stable, so each group keeps its order.
    roots.sort_by_key(|root| !root.starts_with("models"));
    for root in roots {
        for (name, _) in ShippedWorld.list(&root).unwrap_or_default() {
            let request = Request { source: root.join(name), ..Request::default() };
            all.extend(runnable(&ShippedWorld, &request).unwrap_or_default().into_iter().filter(|r| r.experiment));
        }
    }
    let listed = |r: bramah_model::compile::RunnableModel| CircuitListing {
        source: String::new(),
        class: r.class,
        description: r.description,
    };
    all.into_iter().map(listed).collect()
}

/// Files found in the folder, by purpose; relative paths.
#[derive(Default)]
struct FolderFiles {
    /// Circuit files and packages.
    circuits: Vec<String>,
    /// Study files.
    studies: Vec<String>,
    /// CSV files.
    recordings: Vec<String>,
}

impl FolderFiles {
    /// Adds the files below `folder`, down to `depth` levels of folders.
    ///
    /// A folder with a `package.mo` is one circuit, named by the folder. Its own `.mo` files and sub-packages are part
    /// of it.
    fn walk(&mut self, folder: &Path, depth: usize) {
        if depth == 0 {
            return;
        }
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = DiskWorld.list(here).unwrap_or_default();
        let package = entries.iter().any(|(name, folder)| name == "package.mo" && !folder);
        if package {
            self.circuits.push(here.display().to_string());
        }
        // The limit is on the total over all folders, so it is checked at each entry.
        for (name, is_folder) in entries {
            if self.circuits.len() + self.studies.len() + self.recordings.len() >= MOST {
                return;
            }
            let path = folder.join(&name);
            let shown = path.display().to_string();
            match path.extension().and_then(|e| e.to_str()) {
                // Hidden folders and build output hold no files of the user.
                _ if name.starts_with('.') || is_folder && name == "target" => {}
                _ if is_folder => {
                    // A sub-package belongs to the package above, which lists its models. Other folders in a package
                    // may hold studies.
                    let inner = package && path.join("package.mo").exists();
                    self.walk(&path, if inner { 0 } else { depth - 1 });
                }
                Some("mo") if !package => self.circuits.push(shown),
                Some("toml") if is_study(&path) => self.studies.push(shown),
                Some("csv") => self.recordings.push(shown),
                _ => {}
            }
        }
    }
}

/// Whether a TOML file is a study and not an experiment. The text is searched, so that a study with errors is listed
/// too.
fn is_study(path: &Path) -> bool {
    let text = DiskWorld.read(path).unwrap_or_default();
    text.contains("[[recordings]]") || text.lines().any(|line| line.trim_start().starts_with("[signals"))
}

/// The failure for a file name in a request that cannot be used.
pub(super) fn unusable(name: &str, why: &str) -> CommandFailure {
    CommandFailure::new(Code::FileAccess, format!("`{name}` {why}"))
}
