//! The folder that is served: what lies in it, and what ships with bramah.

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

/// Folders deeper than this are not searched.
const DEPTH: usize = 5;
/// No more files than this are listed.
const MOST: usize = 2000;

/// The folder.
pub(super) struct ServerFolder {
    root: PathBuf,
    shipped: OnceLock<Vec<CircuitListing>>,
}

/// What is in it.
#[derive(Serialize)]
pub(super) struct FolderContents<'a> {
    folder: String,
    version: &'static str,
    circuits: Vec<CircuitListing>,
    shipped: &'a [CircuitListing],
    studies: Vec<String>,
    recordings: Vec<String>,
    troubles: Vec<FileProblem>,
}

#[derive(Serialize)]
struct CircuitListing {
    source: String,
    class: String,
    description: String,
}

#[derive(Serialize)]
struct FileProblem {
    source: String,
    messages: String,
}

impl ServerFolder {
    /// Paths in messages are relative to the folder, so the process works in it.
    pub fn new(path: &Path) -> Result<Self, CommandFailure> {
        let root = path.canonicalize().map_err(|e| files::access(path, "read", &e))?;
        // of a file, its folder
        let root = if root.is_file() { root.parent().unwrap_or(&root).to_owned() } else { root };
        std::env::set_current_dir(&root).map_err(|e| files::access(path, "opened", &e))?;
        Ok(ServerFolder { root, shipped: OnceLock::new() })
    }

    /// Its path.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// A path in it, from a name relative to it.
    pub fn inside(&self, name: &str) -> Result<PathBuf, HttpRefusal> {
        guard::inside(&self.root, name)
    }

    /// The text of a file in it.
    pub fn text(&self, name: &str) -> Result<String, HttpRefusal> {
        let path = self.inside(name)?;
        let bytes = std::fs::read(path);
        let bytes = bytes.map_err(|_| HttpRefusal::new(404, format!("`{name}` cannot be read in this folder")))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// What to compile for a circuit that the page names: a file or package in the folder, or a class that ships.
    pub fn request(&self, named: &str, class: &str) -> Result<Request, HttpRefusal> {
        let model = (!class.is_empty()).then(|| class.to_owned());
        if named.is_empty() {
            return Ok(Request { source: class.into(), ..Request::default() });
        }
        self.inside(named)?;
        Ok(Request { source: source(Path::new(named)), model, ..Request::default() })
    }

    /// Everything that the page can open.
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

/// Models that ship with bramah to be run: those of `models`, and the examples of the library.
fn shipped() -> Vec<CircuitListing> {
    let mut all = Vec::new();
    let mut roots = ShippedWorld::roots();
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

/// Files by what they are for.
#[derive(Default)]
struct FolderFiles {
    circuits: Vec<String>,
    studies: Vec<String>,
    recordings: Vec<String>,
}

impl FolderFiles {
    /// A folder with a `package.mo` is one circuit file with all in it; of studies and experiments, those that say
    /// `version` are studies.
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
        for (name, is_folder) in entries {
            if self.circuits.len() + self.studies.len() + self.recordings.len() >= MOST {
                return;
            }
            let path = folder.join(&name);
            let shown = path.display().to_string();
            match path.extension().and_then(|e| e.to_str()) {
                _ if name.starts_with('.') || is_folder && name == "target" => {}
                _ if is_folder => {
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

fn is_study(path: &Path) -> bool {
    let text = DiskWorld.read(path).unwrap_or_default();
    text.contains("[[recordings]]") || text.lines().any(|line| line.trim_start().starts_with("[signals"))
}

/// Says that a name cannot be used.
pub(super) fn unusable(name: &str, why: &str) -> CommandFailure {
    CommandFailure::new(Code::FileAccess, format!("`{name}` {why}"))
}
