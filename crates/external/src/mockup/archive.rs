//! The file of an FMU: a ZIP archive with `modelDescription.xml`, libraries for several platforms, and resources.
//! Bytes enter; the description as text, and a temporary folder with the library and resources, leave.
//!
//! Archives may be hostile. The size of what is unpacked is bounded, and no path may lead out of the folder.

use super::FmuError;
use super::description::FmuStandard;
use bramah_syntax::world::TemporaryFolder;
use std::borrow::Cow;
use std::io::{Cursor, Read};
use std::path::PathBuf;

/// The largest size of the description in bytes.
const MOST_TEXT: u64 = 256 << 20;
/// The largest total size of unpacked files in bytes.
const MOST_BYTES: u64 = 4 << 30;
/// The largest number of files in an archive.
const MOST_FILES: usize = 100_000;

/// An archive in memory, whose directory has been read.
pub struct FmuArchive<'a> {
    /// The reader.
    zip: zip::ZipArchive<Cursor<&'a [u8]>>,
}

/// The files of a unit that a run needs, on the disk.
#[derive(Debug)]
pub struct FmuFiles {
    /// The folder, which is deleted when the last user drops this.
    pub folder: TemporaryFolder,
    /// The path of the library.
    pub library: PathBuf,
    /// The folder of resources. `None` if the unit has none.
    pub resources: Option<PathBuf>,
}

impl<'a> FmuArchive<'a> {
    /// Reads the directory of an archive.
    ///
    /// # Errors
    /// It is no ZIP archive, or holds too many files.
    pub fn open(bytes: &'a [u8]) -> Result<Self, FmuError> {
        let zip = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|why| format!("it is no ZIP archive: {why}"))?;
        if zip.len() > MOST_FILES {
            return Err(format!("it holds {} files, more than {MOST_FILES}", zip.len()).into());
        }
        Ok(FmuArchive { zip })
    }

    /// The text of `modelDescription.xml`.
    ///
    /// # Errors
    /// It is missing, damaged, too long, or not UTF-8.
    pub fn description(&mut self) -> Result<String, FmuError> {
        let file = self.zip.by_name("modelDescription.xml");
        let file = file.map_err(|why| format!("its `modelDescription.xml` cannot be read: {why}"))?;
        let mut text = String::new();
        // One byte more than allowed shows that the text is too long; the size in the directory may be wrong.
        let read = file.take(MOST_TEXT + 1).read_to_string(&mut text);
        read.map_err(|why| format!("its `modelDescription.xml` cannot be read: {why}"))?;
        if text.len() as u64 > MOST_TEXT {
            return Err(format!("its `modelDescription.xml` has more than {} MB", MOST_TEXT >> 20).into());
        }
        Ok(text)
    }

    /// The folder inside the archive with the library for this machine, and the library's name.
    ///
    /// # Errors
    /// There is no such library.
    pub fn library(&self, version: FmuStandard, identifier: &str) -> Result<[String; 2], FmuError> {
        let names: Vec<String> = self.zip.file_names().filter_map(Result::ok).map(Cow::into_owned).collect();
        let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
        let folder = |platform: &str| format!("binaries/{platform}/");
        let has = |folder: &String| names.contains(&format!("{folder}{file}"));
        match platforms(version).into_iter().map(folder).find(has) {
            Some(folder) => Ok([folder, file]),
            None => Err(no_library(version, &file, &names)),
        }
    }

    /// Unpacks the library for this machine with the files beside it, and the resources.
    ///
    /// # Errors
    /// There is no library for this machine, a path leads out of the archive, it is too large, or the disk refuses it.
    pub fn unpack(&mut self, version: FmuStandard, identifier: &str) -> Result<FmuFiles, FmuError> {
        let [beside, library] = self.library(version, identifier)?;
        // Other files, such as sources and libraries of other platforms, stay packed.
        let wanted = [&*beside, "resources/"];
        let folder = TemporaryFolder::new().map_err(|why| format!("it cannot be unpacked: {why}"))?;
        let (mut left, mut resources) = (MOST_BYTES, None);
        for i in 0..self.zip.len() {
            let file = self.zip.by_index(i).map_err(|why| format!("it is damaged: {why}"))?;
            let name = file.name().map_err(|why| format!("it is damaged: {why}"))?.into_owned();
            if !wanted.iter().any(|w| name.starts_with(*w)) || file.is_dir() {
                continue;
            }
            let Some(inside) = file.enclosed_name() else {
                return Err(format!("its file `{name}` leads out of the archive").into());
            };
            let mut bytes = Vec::new();
            file.take(left + 1)
                .read_to_end(&mut bytes)
                .map_err(|why| format!("its file `{name}` is damaged: {why}"))?;
            left = left
                .checked_sub(bytes.len() as u64)
                .ok_or_else(|| format!("it unpacks to more than {} GB", MOST_BYTES >> 30))?;
            folder.write(&inside, &bytes).map_err(|why| format!("it cannot be unpacked: {why}"))?;
            if name.starts_with("resources/") {
                resources = Some(folder.path().join("resources"));
            }
        }
        let library = folder.path().join(beside).join(library);
        Ok(FmuFiles { folder, library, resources })
    }
}

/// The folders below `binaries` for this machine, the preferred one first. Empty on a machine that is not supported.
fn platforms(version: FmuStandard) -> Vec<&'static str> {
    let (two, three) = match (std::env::consts::OS, std::env::consts::ARCH) {
        ("linux", "x86_64") => ("linux64", "x86_64-linux"),
        ("linux", "aarch64") => ("aarch64-linux", "aarch64-linux"),
        ("macos", "x86_64") => ("darwin64", "x86_64-darwin"),
        ("macos", "aarch64") => ("darwin64", "aarch64-darwin"),
        ("windows", "x86_64") => ("win64", "x86_64-windows"),
        _ => return Vec::new(),
    };
    match version {
        // Newer tools write the platform names of FMI 3.0 into units of FMI 2.0 too.
        FmuStandard::Two => vec![two, three],
        FmuStandard::Three => vec![three],
    }
}

/// The message that there is no library for this machine. It lists the platforms that the archive has.
fn no_library(version: FmuStandard, file: &str, names: &[String]) -> FmuError {
    let mut has: Vec<&str> =
        names.iter().filter_map(|n| n.strip_prefix("binaries/")?.split_once('/')).map(|(p, _)| p).collect();
    has.sort_unstable();
    has.dedup();
    let has = match has.as_slice() {
        [] if names.iter().any(|n| n.starts_with("sources/")) => "it holds sources only".to_owned(),
        [] => "it holds none".to_owned(),
        list => format!("it holds libraries for {}", list.join(", ")),
    };
    let here = platforms(version).first().copied().unwrap_or("this machine");
    format!("it has no library `{file}` for {here}; {has}").into()
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "looks at what was unpacked")]
mod tests {
    use super::*;
    use std::io::Write;

    /// An archive of these files.
    fn packed(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in files {
            zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    }

    fn here() -> String {
        format!("binaries/{}/m{}", platforms(FmuStandard::Three)[0], std::env::consts::DLL_SUFFIX)
    }

    #[test]
    fn what_is_needed_is_unpacked() {
        let bytes = packed(&[(&here(), b"code"), ("resources/a/b.txt", b"x"), ("sources/m.c", b"")]);
        let unpacked = FmuArchive::open(&bytes).unwrap().unpack(FmuStandard::Three, "m").unwrap();
        assert!(unpacked.library.is_file() && unpacked.resources.as_ref().unwrap().join("a/b.txt").is_file());
        assert!(!unpacked.folder.path().join("sources").exists());
        let folder = unpacked.folder.path().to_owned();
        drop(unpacked);
        assert!(!folder.exists());
    }

    #[test]
    fn damaged_and_hostile_archives_say_why() {
        let says = |bytes: &[u8]| match FmuArchive::open(bytes) {
            Err(why) => why.to_string(),
            Ok(mut archive) => archive.unpack(FmuStandard::Three, "m").unwrap_err().to_string(),
        };
        assert!(says(b"PK no archive").contains("no ZIP archive"));
        assert!(says(&packed(&[("sources/m.c", b"")])).contains("sources only"));
        assert!(says(&packed(&[("binaries/x/m", b"")])).contains("libraries for x"));
        let out = format!("{}/../../../../m", here().rsplit_once('/').unwrap().0);
        assert!(says(&packed(&[(&here(), b""), (&out, b"")])).contains("leads out"));
        let mut cut = packed(&[(&here(), &[7; 5000])]);
        let at = cut.windows(4).position(|w| w == [7; 4]).unwrap_or(60);
        cut[at] ^= 0xff;
        let said = says(&cut);
        assert!(said.contains("damaged") || said.contains("archive"), "{said}");
        let mut empty = FmuArchive::open(&cut).unwrap();
        assert!(empty.description().unwrap_err().to_string().contains("modelDescription.xml"));
    }
}
