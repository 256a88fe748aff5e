//! The C compiler of this machine, for code of a user that he has allowed to be run.

#![allow(clippy::disallowed_methods, reason = "what a World is for")]

use super::disk::reason;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;

/// Lines of the compiler that are passed on.
const MOST_LINES: usize = 10;

/// A shared library, which is deleted when this is dropped.
#[derive(Debug)]
pub struct CompiledC {
    /// The library.
    pub path: PathBuf,
    /// What was run.
    pub command: String,
    _folder: tempfile::TempDir,
}

/// Runs `cc` on a text, with the file `ModelicaUtilities.h` beside it and further arguments.
///
/// # Errors
/// What the compiler says, or that there is none.
pub fn compile(text: &str, utilities: &str, arguments: &[OsString]) -> Result<CompiledC, String> {
    let folder = tempfile::tempdir().map_err(|e| reason(&e))?;
    let (source, path) = (folder.path().join("wrapper.c"), folder.path().join("wrapper.so"));
    std::fs::write(&source, text).map_err(|e| reason(&e))?;
    std::fs::write(folder.path().join("ModelicaUtilities.h"), utilities).map_err(|e| reason(&e))?;
    let mut cc = Command::new("cc");
    cc.args(["-O2", "-shared", "-fPIC", "-o"]).arg(&path).arg("-I").arg(folder.path());
    cc.arg(&source).args(arguments).arg("-lm");
    let words = |of: &OsStr| of.to_string_lossy().into_owned();
    let command: Vec<String> = std::iter::once(words(cc.get_program())).chain(cc.get_args().map(words)).collect();
    let done = cc.output().map_err(|e| format!("the C compiler `cc` does not run: {}", reason(&e)))?;
    if !done.status.success() {
        let said = String::from_utf8_lossy(&done.stderr);
        let lines: Vec<&str> = said.lines().take(MOST_LINES).collect();
        return Err(format!("the C compiler says:\n{}", lines.join("\n")));
    }
    Ok(CompiledC { path, command: command.join(" "), _folder: folder })
}
