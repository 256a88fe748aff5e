//! The only door to files: stages below `cli` see the outside through a [`World`].

#[cfg(feature = "fmi")]
mod compiler;
mod disk;
#[cfg(feature = "fmi")]
mod folder;

#[cfg(feature = "fmi")]
pub use compiler::CompiledC;
pub use disk::DiskWorld;
pub use disk::reason;
#[cfg(feature = "fmi")]
pub use folder::TemporaryFolder;

use std::path::{Path, PathBuf};

/// Where texts come from: [`DiskWorld`] reads the disk, [`MemoryWorld`] holds texts. Classes that ship with bramah are
/// packed into the binary and need no world.
pub trait World: Sync {
    /// The text of a file.
    ///
    /// # Errors
    /// A sentence saying why it cannot be read (missing, not UTF-8, no permission).
    fn read(&self, path: &Path) -> Result<String, String>;

    /// The bytes of a file that is no text.
    ///
    /// # Errors
    /// A sentence saying why they cannot be read.
    fn bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        self.read(path).map(String::into_bytes)
    }

    /// The shared library that the C compiler makes of a text, the file named `ModelicaUtilities.h` and further arguments:
    /// C sources, libraries, flags.
    ///
    /// # Errors
    /// What the compiler says, or that nothing is compiled here.
    #[cfg(feature = "fmi")]
    fn compile_c(&self, _text: &str, _utilities: &str, _arguments: &[std::ffi::OsString]) -> Result<CompiledC, String> {
        Err("nothing is compiled here".to_owned())
    }

    /// Names of the entries of a folder with whether each is a folder, sorted; `None` if it is no folder.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>>;
}

/// Files held in memory.
#[derive(Clone, Debug, Default)]
pub struct MemoryWorld {
    files: std::collections::BTreeMap<PathBuf, String>,
}

impl MemoryWorld {
    /// A world with one file.
    pub fn single(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        let mut world = MemoryWorld::default();
        world.add(path, text);
        world
    }

    /// Adds a file.
    pub fn add(&mut self, path: impl Into<PathBuf>, text: impl Into<String>) {
        self.files.insert(path.into(), text.into());
    }
}

impl World for MemoryWorld {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.files.get(path).cloned().ok_or_else(|| format!("there is no file `{}`", path.display()))
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let mut entries = std::collections::BTreeMap::new();
        for file in self.files.keys() {
            let Ok(rest) = file.strip_prefix(path) else { continue };
            let mut parts = rest.components();
            let Some(first) = parts.next() else { continue };
            let folder = parts.next().is_some();
            entries.insert(first.as_os_str().to_string_lossy().into_owned(), folder);
        }
        (!entries.is_empty()).then(|| entries.into_iter().collect())
    }
}

/// A world with some files laid over it.
pub struct Overlay<'a> {
    /// What lies below.
    pub base: &'a dyn World,
    /// Files that are seen first.
    pub files: MemoryWorld,
}

impl World for Overlay<'_> {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.files.read(path).or_else(|_| self.base.read(path))
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        self.files.bytes(path).or_else(|_| self.base.bytes(path))
    }

    #[cfg(feature = "fmi")]
    fn compile_c(&self, text: &str, utilities: &str, arguments: &[std::ffi::OsString]) -> Result<CompiledC, String> {
        self.base.compile_c(text, utilities, arguments)
    }

    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        match (self.files.list(path), self.base.list(path)) {
            (Some(above), Some(below)) => {
                let all: std::collections::BTreeMap<_, _> = below.into_iter().chain(above).collect();
                Some(all.into_iter().collect())
            }
            (above, below) => above.or(below),
        }
    }
}
