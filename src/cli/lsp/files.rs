//! File URIs of the editor, and the texts of open files.
//!
//! URIs enter and paths leave, and the reverse. [`OpenTexts`] is a `World` in which open texts replace those on the
//! disk. Files that ship exist only inside the binary, so [`ShippedFileCache`] writes them to disk for editors to open.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use lsp_types::Uri;

use bramah_editor::is_shipped;
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::world::DiskWorld;
use bramah_syntax::world::World;

/// The texts of open files, with the disk for all others. A clone shares the texts and is cheap.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenTexts {
    /// Texts by absolute path. Copied on the first change after a clone, so that a check sees a fixed state.
    texts: Arc<BTreeMap<PathBuf, Arc<str>>>,
}

impl OpenTexts {
    /// Stores the text of an open file.
    pub fn set(&mut self, path: PathBuf, text: &str) {
        Arc::make_mut(&mut self.texts).insert(path, text.into());
    }

    /// Forgets an open file; the disk holds its text from now on.
    pub fn close(&mut self, path: &Path) {
        Arc::make_mut(&mut self.texts).remove(path);
    }

    /// The text of an open file; `None` when it is not open.
    pub fn get(&self, path: &Path) -> Option<&str> {
        self.texts.get(path).map(|t| &**t)
    }

    /// Paths of all open files, sorted.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.texts.keys()
    }
}

impl World for OpenTexts {
    /// The text of an open file, else that on the disk.
    fn read(&self, path: &Path) -> Result<String, String> {
        self.get(path).map_or_else(|| DiskWorld.read(path), |text| Ok(text.to_owned()))
    }

    /// The entries of a folder on the disk.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        // Files that are open but not yet saved are not listed.
        DiskWorld.list(path)
    }
}

/// The folder into which files that ship are written, so that an editor can show them.
#[derive(Clone, Debug)]
pub(super) struct ShippedFileCache(PathBuf);

impl ShippedFileCache {
    /// `$XDG_CACHE_HOME`, else `~/.cache`, else the folder for temporary files; below it `bramah/VERSION`.
    pub fn new() -> ShippedFileCache {
        let variable = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
        let caches = variable("XDG_CACHE_HOME").or_else(|| variable("HOME").map(|h| h.join(".cache")));
        // Another version ships other texts, hence the version in the path.
        ShippedFileCache(caches.unwrap_or_else(std::env::temp_dir).join("bramah").join(env!("CARGO_PKG_VERSION")))
    }

    /// The URI of a file. A file that ships is written to the cache first. `None`: it cannot be written, or the path is
    /// not UTF-8.
    pub fn uri(&self, path: &Path) -> Option<Uri> {
        if !is_shipped(path) {
            return to_uri(path);
        }
        let text = ShippedWorld.read(path).ok()?;
        let file = self.0.join(path);
        // Rewritten only when it differs, for example after the user has edited it.
        if std::fs::read_to_string(&file).ok().as_ref() != Some(&text) {
            std::fs::create_dir_all(file.parent()?).ok()?;
            std::fs::write(&file, text).ok()?;
        }
        to_uri(&file)
    }

    /// The path of a URI. A file in the cache gives the relative path by which it ships. `None`: not a `file` URI.
    pub fn path(&self, uri: &Uri) -> Option<PathBuf> {
        let path = to_path(uri)?;
        Some(path.strip_prefix(&self.0).map(Path::to_path_buf).unwrap_or(path))
    }
}

/// A `file` URI of a path; other bytes than letters, digits and `/-_.~` are percent-encoded.
fn to_uri(path: &Path) -> Option<Uri> {
    let mut text = String::from("file://");
    for byte in path.to_str()?.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => text.push(byte as char),
            _ => text.push_str(&format!("%{byte:02X}")),
        }
    }
    Uri::from_str(&text).ok()
}

/// The path of a `file` URI, with percent-encoding removed. `None`: another scheme, or no UTF-8.
fn to_path(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_str().strip_prefix("file://")?;
    // Between `file://` and the first slash stands the name of the host, which is ignored.
    let start = rest.find('/')?;
    let mut bytes = Vec::new();
    let mut left = rest[start..].bytes();
    while let Some(byte) = left.next() {
        let value = match byte {
            b'%' => {
                let digits = [left.next()?, left.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            b'?' | b'#' => break,
            other => other,
        };
        bytes.push(value);
    }
    String::from_utf8(bytes).ok().map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::{to_path, to_uri};
    use std::path::Path;

    #[test]
    fn paths_survive_as_addresses() {
        for path in ["/a/b c.mo", "/ä/100%.mo", "/x#y?z/q.mo"] {
            let uri = to_uri(Path::new(path)).unwrap();
            assert_eq!(to_path(&uri).as_deref(), Some(Path::new(path)), "{}", uri.as_str());
        }
    }
}
