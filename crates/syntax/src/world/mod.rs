//! The only access to files: all stages below the command read files through a [`World`].
//! Tests and the browser hold their texts in memory, and an editor lays unsaved texts over the disk.

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

/// A source of texts: [`DiskWorld`] reads the disk, [`MemoryWorld`] holds texts, [`Overlay`] combines them.
/// Classes that ship with bramah are packed into the binary and need no world.
pub trait World: Sync {
    /// The text of a file, which must be UTF-8.
    ///
    /// # Errors
    /// A sentence with the cause (missing, not UTF-8, no permission).
    fn read(&self, path: &Path) -> Result<String, String>;

    /// The bytes of a file, which need not be text. By default those of its text.
    ///
    /// # Errors
    /// A sentence with the cause.
    fn bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        self.read(path).map(String::into_bytes)
    }

    /// Compiles a C text to a shared library. `utilities` is the content of the file `ModelicaUtilities.h`.
    /// The arguments are further C sources, libraries and flags.
    ///
    /// # Errors
    /// The messages of the compiler. By default that nothing is compiled here.
    #[cfg(feature = "fmi")]
    fn compile_c(&self, _text: &str, _utilities: &str, _arguments: &[std::ffi::OsString]) -> Result<CompiledC, String> {
        Err("nothing is compiled here".to_owned())
    }

    /// The entries of a folder, sorted by name, each with whether it is a folder itself. `None` if it is no folder.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>>;
}

/// A world of texts in memory. Folders exist as far as paths of files pass through them.
#[derive(Clone, Debug, Default)]
pub struct MemoryWorld {
    /// The text of each path.
    files: std::collections::BTreeMap<PathBuf, String>,
}

impl MemoryWorld {
    /// A world with one file.
    pub fn single(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        let mut world = MemoryWorld::default();
        world.add(path, text);
        world
    }

    /// Adds a file, or replaces its text.
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
            // The path is a file itself, and no folder.
            let Some(first) = parts.next() else { continue };
            // What follows the first part makes that part a folder.
            let folder = parts.next().is_some();
            entries.insert(first.as_os_str().to_string_lossy().into_owned(), folder);
        }
        (!entries.is_empty()).then(|| entries.into_iter().collect())
    }
}

/// A world with some files laid over another one: an editor's unsaved texts over the disk.
pub struct Overlay<'a> {
    /// The world that is asked for files not in `files`.
    pub base: &'a dyn World,
    /// The files that hide those of `base`.
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
                // An entry in both is taken from above.
                let all: std::collections::BTreeMap<_, _> = below.into_iter().chain(above).collect();
                Some(all.into_iter().collect())
            }
            (above, below) => above.or(below),
        }
    }
}
