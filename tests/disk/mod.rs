//! The file system as a world: what the command reads through a door of its own, tests read here.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use bramah::world::World;
use std::path::Path;

/// Files as they are, folders in the order of their names.
pub struct Disk;

impl World for Disk {
    fn read(&self, path: &Path) -> Result<String, String> {
        std::fs::read_to_string(path).map_err(|e| e.to_string())
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let entries = std::fs::read_dir(path).ok()?.flatten();
        let mut names: Vec<(String, bool)> =
            entries.map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().is_dir())).collect();
        names.sort();
        Some(names)
    }
}
