//! Files that must lie on the disk to be of use, as libraries do: in a folder that goes with its last user.

#![allow(clippy::disallowed_methods, reason = "a folder of its own")]

use super::disk::reason;
use std::path::Path;

/// A temporary folder of this machine.
#[derive(Debug)]
pub struct TemporaryFolder(tempfile::TempDir);

impl TemporaryFolder {
    /// An empty one.
    ///
    /// # Errors
    /// Why the disk does not take it.
    pub fn new() -> Result<Self, String> {
        tempfile::Builder::new().prefix("bramah").tempdir().map(TemporaryFolder).map_err(|e| reason(&e))
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file below it.
    ///
    /// # Errors
    /// Why the disk does not take it.
    pub fn write(&self, inside: &Path, bytes: &[u8]) -> Result<(), String> {
        let path = self.0.path().join(inside);
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, bytes));
        written.map_err(|e| reason(&e))
    }
}
