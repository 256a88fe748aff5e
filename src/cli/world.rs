//! The disk as a [`World`].

use std::path::Path;

use crate::world::World;

/// Reads files and folders of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskWorld;

impl World for DiskWorld {
    fn read(&self, path: &Path) -> Result<String, String> {
        let bytes = std::fs::read(path).map_err(|e| super::files::reason(&e))?;
        String::from_utf8(bytes).map_err(|e| {
            let valid = e.utf8_error().valid_up_to();
            let line = 1 + e.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count();
            format!("line {line} holds bytes that are no text in UTF-8; save the file in that encoding")
        })
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let mut entries: Vec<(String, bool)> = std::fs::read_dir(path)
            .ok()?
            .filter_map(Result::ok)
            .map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().is_dir()))
            .collect();
        entries.sort();
        Some(entries)
    }
}
