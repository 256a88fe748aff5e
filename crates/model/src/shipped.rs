//! Classes that ship with bramah, packed into the binary.
//!
//! [`ShippedWorld`] is a read-only `World` of them; `compile` looks there after the user's own libraries.

use bramah_syntax::world::World;
use include_dir::{Dir, DirEntry, File, include_dir};
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The library of components.
static COMPONENTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/components");
/// Models that use the library.
static MODELS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/models");

/// The world of shipped files, under the paths `components` and `models`.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShippedWorld;

impl ShippedWorld {
    /// Folders whose entries are top-level packages.
    pub fn roots() -> [PathBuf; 3] {
        ["components".into(), "models".into(), "models/stiff".into()]
    }
}

/// The packed files of one folder, by path. A look-up in the packed folder itself would compare names one by one at
/// each level.
struct EmbeddedFiles {
    /// By path below the folder: a file.
    files: FxHashMap<&'static str, &'static File<'static>>,
    /// By path below the folder: a folder. The folder itself has the empty path.
    folders: FxHashMap<&'static str, &'static Dir<'static>>,
}

/// The components, then the models. Made when first used.
static PACKED: LazyLock<[EmbeddedFiles; 2]> =
    LazyLock::new(|| [EmbeddedFiles::new(&COMPONENTS), EmbeddedFiles::new(&MODELS)]);

impl EmbeddedFiles {
    /// Indexes a folder with everything in it.
    fn new(dir: &'static Dir<'static>) -> EmbeddedFiles {
        let mut all = EmbeddedFiles { files: FxHashMap::default(), folders: FxHashMap::default() };
        all.add(dir);
        all
    }

    /// Adds a folder and, recursively, what it contains.
    fn add(&mut self, dir: &'static Dir<'static>) {
        self.folders.extend(dir.path().to_str().map(|path| (path, dir)));
        self.files.extend(dir.files().filter_map(|file| Some((file.path().to_str()?, file))));
        dir.dirs().for_each(|inner| self.add(inner));
    }
}

/// The packed folder of a path, and the path below it. `None` for a path outside of `components` and `models`.
fn folder(path: &Path) -> Option<(&'static EmbeddedFiles, &str)> {
    let [components, models] = &*PACKED;
    if let Ok(rest) = path.strip_prefix("components") {
        return Some((components, rest.to_str()?));
    }
    path.strip_prefix("models").ok().and_then(|rest| Some((models, rest.to_str()?)))
}

impl World for ShippedWorld {
    /// The text of a shipped file. `Err` says that there is no such file.
    fn read(&self, path: &Path) -> Result<String, String> {
        let missing = || format!("no file `{}` ships with bramah", path.display());
        let (packed, rest) = folder(path).ok_or_else(missing)?;
        let text = packed.files.get(rest).and_then(|f| f.contents_utf8()).ok_or_else(missing)?;
        Ok(text.to_string())
    }

    /// The entries of a shipped folder, sorted by name, each with whether it is a folder. `None` where there is no such
    /// folder.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let (packed, rest) = folder(path)?;
        let dir = packed.folders.get(rest)?;
        let mut entries: Vec<(String, bool)> = dir
            .entries()
            .iter()
            .filter_map(|e| Some((e.path().file_name()?.to_str()?.to_string(), matches!(e, DirEntry::Dir(_)))))
            .collect();
        entries.sort();
        Some(entries)
    }
}
