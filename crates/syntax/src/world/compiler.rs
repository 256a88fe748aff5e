//! The C compiler of this machine, for C code of a user who has allowed it to run.
//! `DiskWorld::compile_c` calls [`compile`]. It runs `cc` in a temporary folder; the library is deleted after use.

#![allow(clippy::disallowed_methods, reason = "what a World is for")]

use super::disk::reason;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;

/// The number of lines of the compiler's messages that are passed on.
const MOST_LINES: usize = 10;

/// A shared library made from C code. Its folder is deleted when this is dropped.
#[derive(Debug)]
pub struct CompiledC {
    /// The path of the library.
    pub path: PathBuf,
    /// The command line that made it, for messages.
    pub command: String,
    /// Kept only to delete the folder at the end.
    _folder: tempfile::TempDir,
}

/// Compiles a C text to a shared library.
///
/// `utilities` becomes the file `ModelicaUtilities.h` beside it. `arguments` are further sources, libraries and flags.
///
/// # Errors
/// The first lines of the compiler's messages, or that there is no compiler.
pub fn compile(text: &str, utilities: &str, arguments: &[OsString]) -> Result<CompiledC, String> {
    let folder = tempfile::tempdir().map_err(|e| reason(&e))?;
    let (source, path) = (folder.path().join("wrapper.c"), folder.path().join("wrapper.so"));
    std::fs::write(&source, text).map_err(|e| reason(&e))?;
    std::fs::write(folder.path().join("ModelicaUtilities.h"), utilities).map_err(|e| reason(&e))?;
    let mut cc = Command::new("cc");
    cc.args(["-O2", "-shared", "-fPIC", "-o"]).arg(&path).arg("-I").arg(folder.path());
    // Sources and libraries come after the wrapper, since linkers resolve names from left to right.
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
