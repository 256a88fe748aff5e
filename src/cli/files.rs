//! Reads, writes and checks files for all subcommands.
//!
//! A file is written under a temporary name in the same folder and renamed when it is complete. A reader therefore
//! never sees half a file, and a failed command leaves the old file untouched.
//!
//! The checks (`ending`, `ready`) run before long work, so that a wrong name is reported at once.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::CommandFailure;
use bramah_syntax::diag::{Code, Diagnostic};
use bramah_syntax::world::{DiskWorld, World, reason};

/// The failure for a file that cannot be opened, read or written. `verb` completes "cannot be ...".
pub(super) fn access(path: &Path, verb: &str, error: &io::Error) -> CommandFailure {
    Diagnostic::new(Code::FileAccess, format!("`{}` cannot be {verb}: {}", path.display(), reason(error))).into()
}

/// The failure for a file that cannot be created. A missing folder gets a message of its own.
fn unwritable(path: &Path, error: &io::Error) -> CommandFailure {
    // The system's error names the file, which would hide that its folder is what is missing.
    if error.kind() == io::ErrorKind::NotFound {
        let text = format!("`{}` cannot be written: there is no such folder", path.display());
        return CommandFailure::new(Code::FileAccess, text);
    }
    access(path, "written", error)
}

/// A file that is being written under a temporary name next to its final one.
///
/// When dropped before [`NewFile::finish`], it removes the temporary file, unless it is a lasting one.
#[derive(Debug)]
pub(super) struct NewFile {
    /// The buffered writer. `None` once the file is closed.
    out: Option<BufWriter<File>>,
    /// The name while writing; equal to `path` for devices and pipes.
    temporary: PathBuf,
    /// The final name.
    path: PathBuf,
    /// `path` is a device or pipe: it is written directly and never renamed or removed.
    direct: bool,
    /// The temporary file stays on the disk when the writing is not finished, so that a later run can continue it.
    lasting: bool,
}

impl NewFile {
    /// Opens the temporary file. `Err`: the path is a folder, or its folder is missing or not writable.
    pub fn create(path: &Path) -> Result<Self, CommandFailure> {
        if path.is_dir() {
            return Err(CommandFailure::new(
                Code::FileAccess,
                format!("`{}` cannot be written: it is a folder", path.display()),
            ));
        }
        // Devices and pipes such as /dev/stdout or /dev/null cannot be replaced by renaming.
        let direct = path.exists() && !path.is_file();
        let temporary = if direct { path.to_owned() } else { beside(path) };
        let file = File::create(&temporary).map_err(|e| unwritable(path, &e))?;
        Ok(NewFile {
            // 64 KiB.
            out: Some(BufWriter::with_capacity(1 << 16, file)),
            temporary,
            path: path.to_owned(),
            direct,
            lasting: false,
        })
    }

    /// Opens `NAME.part`, which stays on the disk if the process is killed.
    ///
    /// `written`: continue after this many bytes. `None`: begin a new file. `Err`: the target is a device, or the part
    /// cannot be opened or is too short.
    pub fn lasting(path: &Path, written: Option<u64>) -> Result<Self, CommandFailure> {
        if path.exists() && !path.is_file() {
            let text = format!("`{}` cannot be written in parts: it is no plain file", path.display());
            return Err(CommandFailure::new(Code::FileAccess, text));
        }
        let temporary = part(path);
        // What follows the bytes of the checkpoint belongs to steps that the continued run repeats.
        let file = match written {
            None => File::create(&temporary).map_err(|e| unwritable(path, &e))?,
            Some(bytes) => cut(&temporary, bytes)?,
        };
        let out = Some(BufWriter::with_capacity(1 << 16, file));
        Ok(NewFile { out, temporary, path: path.to_owned(), direct: false, lasting: true })
    }

    /// Waits until the disk has all data that was handed to the system.
    pub fn sync(&self) -> Result<(), CommandFailure> {
        // Data in the buffer of `out` is not included. The recorder writes through its own handle and flushes it first.
        let synced = self.out.as_ref().map_or(Ok(()), |out| out.get_ref().sync_data());
        synced.map_err(|e| access(&self.temporary, "written", &e))
    }

    /// Flushes the file and renames it to its final name, which replaces an older file.
    pub fn finish(mut self) -> Result<(), CommandFailure> {
        let failed = |e: io::Error| access(&self.path, "written", &e);
        if let Some(mut out) = self.out.take() {
            out.flush().map_err(failed)?;
        }
        if !self.direct {
            std::fs::rename(&self.temporary, &self.path).map_err(failed)?;
        }
        Ok(())
    }

    /// A second handle on the same open file, for a writer that must own one. Only one of the two may be written to.
    pub fn handle(&self) -> io::Result<BufWriter<File>> {
        let file = self.out.as_ref().map(|out| out.get_ref().try_clone());
        file.unwrap_or_else(|| Err(io::ErrorKind::BrokenPipe.into())).map(|f| BufWriter::with_capacity(1 << 16, f))
    }

    /// Renames the unfinished file to `NAME.part` and returns that path. `None` for devices, or when renaming fails.
    pub fn keep_part(mut self) -> Option<PathBuf> {
        drop(self.out.take());
        let kept = part(&self.path);
        (!self.direct && std::fs::rename(&self.temporary, &kept).is_ok()).then_some(kept)
    }
}

impl Write for NewFile {
    /// Writes into the buffer. A closed file takes nothing.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.as_mut().map_or(Ok(0), |out| out.write(bytes))
    }

    /// Hands the buffer to the system.
    fn flush(&mut self) -> io::Result<()> {
        self.out.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for NewFile {
    /// Removes the temporary file, unless it is a lasting one or a device.
    fn drop(&mut self) {
        // The file is closed before it is removed, which some systems demand.
        drop(self.out.take());
        if !self.direct && !self.lasting {
            // After `finish` the temporary name no longer exists, and this fails without consequence.
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

/// Opens a file for writing after its first `bytes` bytes and removes the rest.
///
/// `Err`: the file cannot be opened, or it is shorter.
fn cut(path: &Path, bytes: u64) -> Result<File, CommandFailure> {
    let failed = |e: io::Error| access(path, "written", &e);
    let mut file = File::options().write(true).open(path).map_err(|e| access(path, "continued", &e))?;
    let length = file.metadata().map_err(failed)?.len();
    if length < bytes {
        let text = format!("`{}` cannot be continued: it is shorter than its checkpoint says", path.display());
        return Err(CommandFailure::new(Code::FileAccess, text));
    }
    file.set_len(bytes).map_err(failed)?;
    file.seek(io::SeekFrom::End(0)).map_err(failed)?;
    Ok(file)
}

/// The lasting temporary name: `out.csv` becomes `out.csv.part`.
fn part(path: &Path) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(".part");
    PathBuf::from(name)
}

/// The hidden temporary name: `out.csv` becomes `.out.csv.PID.part`. It lies in the same folder, so that renaming is
/// atomic; the process id keeps concurrent commands apart.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.part", std::process::id()))
}

/// Writes a complete file, replacing an older one.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), CommandFailure> {
    let mut file = NewFile::create(path)?;
    file.write_all(bytes).map_err(|e| access(path, "written", &e))?;
    file.finish()
}

/// The format that the ending of a file's name asks for, in lower case.
///
/// Returns the first of `known` for stdout (`-`), devices, pipes and names without ending. `Err`: the ending is not one
/// of `known`; the message says how `what` can be written.
pub(super) fn ending(path: &Path, what: &str, known: &[&'static str]) -> Result<&'static str, CommandFailure> {
    let device = path.exists() && !path.is_file() && !path.is_dir();
    let Some(asked) = path.extension().filter(|_| !device) else { return Ok(known[0]) };
    let asked = asked.to_string_lossy().to_lowercase();
    known.iter().find(|k| **k == asked).copied().ok_or_else(|| {
        let all: Vec<String> = known.iter().map(|k| format!(".{k}")).collect();
        let (last, others) = all.split_last().expect("an output has a format");
        let list = if others.is_empty() { last.clone() } else { format!("{} or {last}", others.join(", ")) };
        let text = format!("{what} is written as {list}, not as `{}`", path.display());
        Diagnostic::new(Code::BadArgument, text).help(format!("give the file a name that ends in {list}")).into()
    })
}

/// Checks before long work that a file can be created in its folder; a temporary file is created and removed.
///
/// `-` is stdout and always passes. A pipe is not opened, because its reader would take the closing for the end of the
/// data.
pub(super) fn ready(path: &Path) -> Result<(), CommandFailure> {
    let pipe = path.exists() && !path.is_file() && !path.is_dir();
    if path == Path::new("-") || pipe { Ok(()) } else { NewFile::create(path).map(drop) }
}

/// Checks before long work both the name of an output ([`ending`]) and its place ([`ready`]).
pub(super) fn ready_as(path: &Path, what: &str, known: &[&'static str]) -> Result<(), CommandFailure> {
    ending(path, what, known)?;
    ready(path)
}

/// All Modelica files below a folder, in the order of their names.
///
/// Left out are folders whose name begins with a dot, folders that `skipped` accepts, and symbolic links to folders,
/// which could form a cycle.
pub(super) fn modelica_below(folder: &Path, skipped: &dyn Fn(&str) -> bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (name, is_folder) in DiskWorld.list(folder).unwrap_or_default() {
        let path = folder.join(&name);
        if is_folder && !name.starts_with('.') && !skipped(&name) && !path.is_symlink() {
            found.extend(modelica_below(&path, skipped));
        } else if !is_folder && name.ends_with(".mo") {
            found.push(path);
        }
    }
    found
}

/// Prints to stdout. A closed pipe (`| head`) is not an error.
pub(super) fn print(text: &str) -> Result<(), CommandFailure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(access(Path::new("stdout"), "written", &e)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        let mut file = NewFile::create(&path).unwrap();
        file.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(file);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        write(&path, b"whole").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_ending_says_what_a_file_holds() {
        let of = |name: &str| ending(Path::new(name), "a table", &["csv", "json"]);
        assert_eq!(of("a.JSON").unwrap(), "json");
        assert_eq!([of("-").unwrap(), of("table").unwrap(), of("a.b/table").unwrap()], ["csv"; 3]);
        let message = of("a.xlsx").unwrap_err().diagnostics.remove(0).message;
        assert_eq!(message, "a table is written as .csv or .json, not as `a.xlsx`");
    }

    #[test]
    fn folders_and_missing_folders_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let reported = |path: &Path| NewFile::create(path).unwrap_err().diagnostics.remove(0).message;
        assert!(reported(folder.path()).ends_with("it is a folder"));
        assert!(reported(&folder.path().join("no/out.csv")).ends_with("there is no such folder"));
        assert!(ready(&folder.path().join("no/out.csv")).is_err() && ready(&folder.path().join("out.csv")).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
