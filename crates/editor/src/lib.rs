//! The questions that an editor asks about Modelica texts: names, completion, outline, colours, diagnostics and fixes.
//!
//! Texts and a position (a byte offset) enter; types of the Language Server Protocol leave. The server in `src/cli/lsp`
//! holds the open texts and passes them in as a [`World`].
//!
//! [`EditorWorkspace::look`] loads a file with the classes around it and calls a function with a [`DocumentView`].
//! Nothing is kept between two looks; each one parses the files that it needs.

pub mod actions;
pub mod complete;
pub mod hints;
pub mod hover;
pub mod lines;
pub mod messages;
pub mod navigate;
pub mod occurrences;
pub mod outline;
pub mod signature;
#[cfg(test)]
mod tests;
pub mod tokens;
mod words;

use bramah_model::resolve::{ClassId, Library, SyntaxArena, nested_classes};
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::diag::{FileId, Span};
use bramah_syntax::world::World;
use std::path::{Path, PathBuf};

/// Access to the texts for one question.
pub struct EditorWorkspace<'w> {
    /// The files. Texts that are open in the editor replace those on the disk.
    pub world: &'w dyn World,
    /// Folders with further packages, searched before what ships with bramah.
    pub libraries: &'w [PathBuf],
}

/// One file together with the library of classes that its names can refer to.
pub struct DocumentView<'l, 'a> {
    /// All classes that can be named. They are loaded when a name is looked up.
    pub library: &'l mut Library<'a>,
    /// The outermost classes of the file.
    pub classes: Vec<ClassId>,
    /// The number of the file among the texts of the library.
    pub file: FileId,
    /// The text of the file.
    pub text: String,
    /// The line starts of `text`, for conversions to positions.
    lines: lines::LineIndex,
}

impl EditorWorkspace<'_> {
    /// Loads a file and calls `act` with its view. A relative path is a file that ships with bramah.
    ///
    /// `None`: the file cannot be read.
    pub fn look<T>(&self, path: &Path, act: impl FnOnce(DocumentView<'_, '_>) -> T) -> Option<T> {
        self.with_library(|library, texts| {
            let text = texts.read(path)?;
            // A shipped class is found by its name, so that it is loaded in its package and its names resolve.
            let added = if is_shipped(path) {
                library.find(&dotted(path)).map(|id| vec![id])
            } else {
                library.add_path(texts.world, path).ok()
            };
            let shown = path.display().to_string();
            let classes = match added.filter(|all| !all.is_empty()) {
                Some(classes) => classes,
                // The file does not contain the class of its name, or has syntax errors. Its text is parsed alone.
                None => library.add_text(&shown, &text),
            };
            // The file may have been loaded together with its package, so its number is searched by the path.
            let found = library.sources.iter().position(|s| s.path == shown);
            let file = FileId(u32::try_from(found?).ok()?);
            let lines = lines::LineIndex::new(&text);
            Some(act(DocumentView { library, classes, file, text, lines }))
        })
    }

    /// Calls `act` with a new library over the user's folders and what ships with bramah.
    ///
    /// The library and its syntax trees live only during the call, so `act` returns what outlives them.
    fn with_library<T>(&self, act: impl for<'a> FnOnce(&mut Library<'a>, &EditorWorkspace<'a>) -> T) -> T {
        let (trees, shipped) = (SyntaxArena::new(), ShippedWorld);
        let own = self.libraries.iter().map(|l| (self.world, l.clone()));
        let roots = own.chain(ShippedWorld::roots().map(|r| (&shipped as &dyn World, r))).collect();
        act(&mut Library::new(&trees, roots), self)
    }

    /// The text of a file of the user, or of one that ships. `None`: it cannot be read.
    pub fn read(&self, path: &Path) -> Option<String> {
        if is_shipped(path) { ShippedWorld.read(path).ok() } else { self.world.read(path).ok() }
    }
}

impl DocumentView<'_, '_> {
    /// The position of a byte offset in the file.
    pub fn position(&self, offset: u32) -> lsp_types::Position {
        self.lines.position(&self.text, offset)
    }

    /// The range of a span of the file.
    pub fn range(&self, span: Span) -> lsp_types::Range {
        self.lines.range(&self.text, span)
    }

    /// The innermost class around a byte offset; the first class of the file when the offset is in none.
    ///
    /// `None`: the file has no class.
    pub fn class_at(&mut self, offset: u32) -> Option<ClassId> {
        let own = self.classes.clone().into_iter();
        // Of several classes that contain the offset, the last one is taken.
        let mut at = own.rev().find(|&id| self.holds(id, offset)).or(self.classes.first().copied())?;
        loop {
            let inner = nested_classes(self.library.class(at)).find(|c| c.span.start <= offset && offset <= c.span.end);
            match inner {
                Some(class) => at = self.library.enter(class, Some(at)),
                None => return Some(at),
            }
        }
    }

    /// Whether the span of a class contains a byte offset of this file.
    fn holds(&self, id: ClassId, offset: u32) -> bool {
        let span = self.library.class(id).span;
        span.file == self.file && span.start <= offset && offset <= span.end
    }
}

/// Whether a path belongs to a file that ships with bramah. Those have relative paths, files of the user absolute ones.
pub fn is_shipped(path: &Path) -> bool {
    path.is_relative()
}

/// The full name of the class in a file that ships: its path with dots, below one of the roots.
fn dotted(path: &Path) -> String {
    let below =
        ShippedWorld::roots().into_iter().rev().find_map(|root| path.strip_prefix(root).ok().map(Path::to_path_buf));
    let below = below.unwrap_or_else(|| path.to_path_buf()).with_extension("");
    let parts = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned());
    // `package.mo` holds the class of its folder.
    parts.filter(|p| p != "package").collect::<Vec<_>>().join(".")
}
