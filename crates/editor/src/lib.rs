//! What an editor asks about texts: meaning of names, completions, outlines, colours, messages and their corrections.
//!
//! Everything is a function of the texts: the server (`cli/lsp`) holds those that are open and hands them in as a [`World`].

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

/// What one look at texts needs.
pub struct EditorWorkspace<'w> {
    /// The files, with those open in the editor laid over them.
    pub world: &'w dyn World,
    /// Folders with further packages.
    pub libraries: &'w [PathBuf],
}

/// A file in the library around it.
pub struct DocumentView<'l, 'a> {
    /// All classes that can be named.
    pub library: &'l mut Library<'a>,
    /// The classes that stand in the file, without those inside them.
    pub classes: Vec<ClassId>,
    /// The file's place among the texts read.
    pub file: FileId,
    /// The text.
    pub text: String,
    lines: lines::LineIndex,
}

impl EditorWorkspace<'_> {
    /// Looks at a file of the user, or one that ships (a relative path). `None` where it cannot be read.
    pub fn look<T>(&self, path: &Path, act: impl FnOnce(DocumentView<'_, '_>) -> T) -> Option<T> {
        self.with_library(|library, texts| {
            let text = texts.read(path)?;
            let added = if is_shipped(path) {
                library.find(&dotted(path)).map(|id| vec![id])
            } else {
                library.add_path(texts.world, path).ok()
            };
            let shown = path.display().to_string();
            let classes = match added.filter(|all| !all.is_empty()) {
                Some(classes) => classes,
                // a file whose class is not that of its name, or that cannot be read to its end
                None => library.add_text(&shown, &text),
            };
            let found = library.sources.iter().position(|s| s.path == shown);
            let file = FileId(u32::try_from(found?).ok()?);
            let lines = lines::LineIndex::new(&text);
            Some(act(DocumentView { library, classes, file, text, lines }))
        })
    }

    /// A library with the folders of the user and what ships.
    fn with_library<T>(&self, act: impl for<'a> FnOnce(&mut Library<'a>, &EditorWorkspace<'a>) -> T) -> T {
        let (trees, shipped) = (SyntaxArena::new(), ShippedWorld);
        let own = self.libraries.iter().map(|l| (self.world, l.clone()));
        let roots = own.chain(ShippedWorld::roots().map(|r| (&shipped as &dyn World, r))).collect();
        act(&mut Library::new(&trees, roots), self)
    }

    /// The text of a file of the user, or of one that ships.
    pub fn read(&self, path: &Path) -> Option<String> {
        if is_shipped(path) { ShippedWorld.read(path).ok() } else { self.world.read(path).ok() }
    }
}

impl DocumentView<'_, '_> {
    /// Where a byte stands.
    pub fn position(&self, offset: u32) -> lsp_types::Position {
        self.lines.position(&self.text, offset)
    }

    /// The range of a span of the file.
    pub fn range(&self, span: Span) -> lsp_types::Range {
        self.lines.range(&self.text, span)
    }

    /// The innermost class around a byte; the first one of the file where it stands in none.
    pub fn class_at(&mut self, offset: u32) -> Option<ClassId> {
        let own = self.classes.clone().into_iter();
        let mut at = own.rev().find(|&id| self.holds(id, offset)).or(self.classes.first().copied())?;
        loop {
            let inner = nested_classes(self.library.class(at)).find(|c| c.span.start <= offset && offset <= c.span.end);
            match inner {
                Some(class) => at = self.library.enter(class, Some(at)),
                None => return Some(at),
            }
        }
    }

    fn holds(&self, id: ClassId, offset: u32) -> bool {
        let span = self.library.class(id).span;
        span.file == self.file && span.start <= offset && offset <= span.end
    }
}

/// Files that ship have relative paths; those of the user are absolute.
pub fn is_shipped(path: &Path) -> bool {
    path.is_relative()
}

/// The full name of the class in a file that ships.
fn dotted(path: &Path) -> String {
    let below =
        ShippedWorld::roots().into_iter().rev().find_map(|root| path.strip_prefix(root).ok().map(Path::to_path_buf));
    let below = below.unwrap_or_else(|| path.to_path_buf()).with_extension("");
    let parts = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned());
    parts.filter(|p| p != "package").collect::<Vec<_>>().join(".")
}
