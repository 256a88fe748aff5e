//! Temporary folders for files that must lie on the disk to be used, such as shared libraries.
//! The folder is deleted when its last owner drops it.

#![allow(clippy::disallowed_methods, reason = "a folder of its own")]

use super::disk::reason;
use std::path::Path;

/// A temporary folder of this machine, deleted when dropped.
#[derive(Debug)]
pub struct TemporaryFolder(tempfile::TempDir);

impl TemporaryFolder {
    /// Makes an empty folder.
    ///
    /// # Errors
    /// The cause, if the disk does not allow it.
    pub fn new() -> Result<Self, String> {
        tempfile::Builder::new().prefix("bramah").tempdir().map(TemporaryFolder).map_err(|e| reason(&e))
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file at the path `inside` the folder. Folders on the way are made.
    ///
    /// # Errors
    /// The cause, if the disk does not allow it.
    pub fn write(&self, inside: &Path, bytes: &[u8]) -> Result<(), String> {
        let path = self.0.path().join(inside);
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, bytes));
        written.map_err(|e| reason(&e))
    }
}
