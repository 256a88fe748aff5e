//! Addresses of files, and the texts of those that are open.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use lsp_types::Uri;

use bramah_editor::is_shipped;
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::world::DiskWorld;
use bramah_syntax::world::World;

/// Texts that are open, over the disk. Cheap to copy.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenTexts {
    texts: Arc<BTreeMap<PathBuf, Arc<str>>>,
}

impl OpenTexts {
    pub fn set(&mut self, path: PathBuf, text: &str) {
        Arc::make_mut(&mut self.texts).insert(path, text.into());
    }

    pub fn close(&mut self, path: &Path) {
        Arc::make_mut(&mut self.texts).remove(path);
    }

    pub fn get(&self, path: &Path) -> Option<&str> {
        self.texts.get(path).map(|t| &**t)
    }

    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.texts.keys()
    }
}

impl World for OpenTexts {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.get(path).map_or_else(|| DiskWorld.read(path), |text| Ok(text.to_owned()))
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        DiskWorld.list(path)
    }
}

/// Where files that ship are laid for editors to show them.
#[derive(Clone, Debug)]
pub(super) struct ShippedFileCache(PathBuf);

impl ShippedFileCache {
    /// Below the user's folder for caches, by version.
    pub fn new() -> ShippedFileCache {
        let variable = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
        let caches = variable("XDG_CACHE_HOME").or_else(|| variable("HOME").map(|h| h.join(".cache")));
        ShippedFileCache(caches.unwrap_or_else(std::env::temp_dir).join("bramah").join(env!("CARGO_PKG_VERSION")))
    }

    /// The address of a file; one that ships is written to the cache first.
    pub fn uri(&self, path: &Path) -> Option<Uri> {
        if !is_shipped(path) {
            return to_uri(path);
        }
        let text = ShippedWorld.read(path).ok()?;
        let file = self.0.join(path);
        if std::fs::read_to_string(&file).ok().as_ref() != Some(&text) {
            std::fs::create_dir_all(file.parent()?).ok()?;
            std::fs::write(&file, text).ok()?;
        }
        to_uri(&file)
    }

    /// The path behind an address; that of a file in the cache is the one by which it ships.
    pub fn path(&self, uri: &Uri) -> Option<PathBuf> {
        let path = to_path(uri)?;
        Some(path.strip_prefix(&self.0).map(Path::to_path_buf).unwrap_or(path))
    }
}

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

fn to_path(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_str().strip_prefix("file://")?;
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
