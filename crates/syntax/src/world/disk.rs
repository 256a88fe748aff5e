//! The disk as a [`World`]. Below the command this module is the only one that reads files.

#![allow(clippy::disallowed_methods, reason = "what a World is for")]

use std::io;
use std::path::Path;

use super::World;

/// The files and folders of this machine.
/// It has no state, so that all uses see the same files.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskWorld;

impl World for DiskWorld {
    fn read(&self, path: &Path) -> Result<String, String> {
        let bytes = std::fs::read(path).map_err(|e| reason(&e))?;
        // The message names the line of the first invalid byte, which is usually a letter in Latin-1.
        String::from_utf8(bytes).map_err(|e| {
            let valid = e.utf8_error().valid_up_to();
            let line = 1 + e.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count();
            format!("line {line} holds bytes that are no text in UTF-8; save the file in that encoding")
        })
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        std::fs::read(path).map_err(|e| reason(&e))
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let mut entries: Vec<(String, bool)> = std::fs::read_dir(path)
            .ok()?
            .filter_map(Result::ok)
            .map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().is_dir()))
            .collect();
        // The order of a folder's entries depends on the file system; results must not.
        entries.sort();
        Some(entries)
    }

    #[cfg(feature = "fmi")]
    fn compile_c(
        &self,
        text: &str,
        utilities: &str,
        arguments: &[std::ffi::OsString],
    ) -> Result<super::CompiledC, String> {
        super::compiler::compile(text, utilities, arguments)
    }
}

/// The cause of a failed file operation in plain words, for the user.
pub fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "access is not permitted".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk can only be read".to_owned(),
        _ => error.to_string(),
    }
}
