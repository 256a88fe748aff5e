//! Classes that ship with bramah, packed into the binary.

use crate::world::World;
use include_dir::{Dir, DirEntry, include_dir};
use std::path::{Path, PathBuf};

static COMPONENTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/components");
static MODELS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/models");

/// The world of shipped files, under the paths `components` and `models`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shipped;

impl Shipped {
    /// Folders whose entries are top-level packages.
    pub fn roots() -> [PathBuf; 3] {
        ["components".into(), "models".into(), "models/stiff".into()]
    }
}

fn folder(path: &Path) -> Option<(&'static Dir<'static>, &Path)> {
    if let Ok(rest) = path.strip_prefix("components") {
        return Some((&COMPONENTS, rest));
    }
    path.strip_prefix("models").ok().map(|rest| (&MODELS, rest))
}

impl World for Shipped {
    fn read(&self, path: &Path) -> Result<String, String> {
        let missing = || format!("no file `{}` ships with bramah", path.display());
        let (dir, rest) = folder(path).ok_or_else(missing)?;
        let text = dir.get_file(rest).and_then(|f| f.contents_utf8()).ok_or_else(missing)?;
        Ok(text.to_string())
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let (dir, rest) = folder(path)?;
        let dir = if rest.as_os_str().is_empty() { dir } else { dir.get_dir(rest)? };
        let mut entries: Vec<(String, bool)> = dir
            .entries()
            .iter()
            .filter_map(|e| Some((e.path().file_name()?.to_str()?.to_string(), matches!(e, DirEntry::Dir(_)))))
            .collect();
        entries.sort();
        Some(entries)
    }
}
