//! Files written whole or not at all under their final name.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::CommandFailure;
use bramah_syntax::diag::{Code, Diagnostic};
use bramah_syntax::world::{DiskWorld, World, reason};

/// A file that cannot be read or written.
pub(super) fn access(path: &Path, verb: &str, error: &io::Error) -> CommandFailure {
    Diagnostic::new(Code::FileAccess, format!("`{}` cannot be {verb}: {}", path.display(), reason(error))).into()
}

fn unwritable(path: &Path, error: &io::Error) -> CommandFailure {
    if error.kind() == io::ErrorKind::NotFound {
        let text = format!("`{}` cannot be written: there is no such folder", path.display());
        return CommandFailure::new(Code::FileAccess, text);
    }
    access(path, "written", error)
}

/// A file being written under a temporary name beside its final one.
///
/// Dropped before [`NewFile::finish`], it leaves nothing behind.
#[derive(Debug)]
pub(super) struct NewFile {
    out: Option<BufWriter<File>>,
    temporary: PathBuf,
    path: PathBuf,
    direct: bool,
    /// Stays under its temporary name when it is left unfinished.
    lasting: bool,
}

impl NewFile {
    /// Begins to write; fails at once where the folder is missing or not writable.
    pub fn create(path: &Path) -> Result<Self, CommandFailure> {
        if path.is_dir() {
            return Err(CommandFailure::new(
                Code::FileAccess,
                format!("`{}` cannot be written: it is a folder", path.display()),
            ));
        }
        // Devices and pipes such as /dev/stdout or /dev/null cannot be renamed to.
        let direct = path.exists() && !path.is_file();
        let temporary = if direct { path.to_owned() } else { beside(path) };
        let file = File::create(&temporary).map_err(|e| unwritable(path, &e))?;
        Ok(NewFile {
            out: Some(BufWriter::with_capacity(1 << 16, file)),
            temporary,
            path: path.to_owned(),
            direct,
            lasting: false,
        })
    }

    /// Begins to write, or goes on behind `written` bytes, under a name that lasts: `NAME.part`.
    pub fn lasting(path: &Path, written: Option<u64>) -> Result<Self, CommandFailure> {
        if path.exists() && !path.is_file() {
            let text = format!("`{}` cannot be written in parts: it is no plain file", path.display());
            return Err(CommandFailure::new(Code::FileAccess, text));
        }
        let temporary = part(path);
        let file = match written {
            None => File::create(&temporary).map_err(|e| unwritable(path, &e))?,
            Some(bytes) => cut(&temporary, bytes)?,
        };
        let out = Some(BufWriter::with_capacity(1 << 16, file));
        Ok(NewFile { out, temporary, path: path.to_owned(), direct: false, lasting: true })
    }

    /// Waits until the disk has everything that was handed to the system.
    pub fn sync(&self) -> Result<(), CommandFailure> {
        let synced = self.out.as_ref().map_or(Ok(()), |out| out.get_ref().sync_data());
        synced.map_err(|e| access(&self.temporary, "written", &e))
    }

    /// Everything is written: the file gets its name.
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

    /// A second handle for a writer that wants to own one; nothing may be written to both.
    pub fn handle(&self) -> io::Result<BufWriter<File>> {
        let file = self.out.as_ref().map(|out| out.get_ref().try_clone());
        file.unwrap_or_else(|| Err(io::ErrorKind::BrokenPipe.into())).map(|f| BufWriter::with_capacity(1 << 16, f))
    }

    /// Leaves what has been written as `NAME.part`, for someone who wants to rescue it.
    pub fn keep_part(mut self) -> Option<PathBuf> {
        drop(self.out.take());
        let kept = part(&self.path);
        (!self.direct && std::fs::rename(&self.temporary, &kept).is_ok()).then_some(kept)
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.as_mut().map_or(Ok(0), |out| out.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        drop(self.out.take());
        if !self.direct && !self.lasting {
            // After `finish` there is nothing to remove.
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

/// Opens a file behind its first bytes; what follows them is lost.
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

/// `out.csv` grows as `out.csv.part` until it is whole.
fn part(path: &Path) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(".part");
    PathBuf::from(name)
}

/// `out.csv` becomes `.out.csv.1234.part`, in the same folder so that renaming is one step.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.part", std::process::id()))
}

/// Writes a whole file.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), CommandFailure> {
    let mut file = NewFile::create(path)?;
    file.write_all(bytes).map_err(|e| access(path, "written", &e))?;
    file.finish()
}

/// What a file's name asks for: its ending in lower case, which must be one of those that `what` can be written as. The
/// first of them for stdout (`-`), devices, pipes and names without an ending.
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

/// Says before the work what would be found out only after it: a folder that is missing or cannot be written to. A `-`
/// is stdout, and a pipe is opened once only, for whoever reads takes its closing for the end.
pub(super) fn ready(path: &Path) -> Result<(), CommandFailure> {
    let pipe = path.exists() && !path.is_file() && !path.is_dir();
    if path == Path::new("-") || pipe { Ok(()) } else { NewFile::create(path).map(drop) }
}

/// Says before the work that a file cannot be written, by its name or its place: [`ending`] and [`ready`].
pub(super) fn ready_as(path: &Path, what: &str, known: &[&'static str]) -> Result<(), CommandFailure> {
    ending(path, what, known)?;
    ready(path)
}

/// All Modelica files below a folder, in the order of their names; folders whose name begins with a dot, links and those
/// that `skipped` names are left out.
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

/// Writes to stdout. A reader that has gone away (`| head`) is no mistake.
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
