//! Navigation: where a name is declared, where it is used, and whether it can be renamed.
//!
//! A view and a byte offset enter; ranges in files leave. [`references`] searches many files for one declaration; for
//! that it opens a new library, in which the declaration is recognised by its file and offset.

use super::occurrences::{self, NameOccurrence};
use super::{DocumentView, EditorWorkspace, is_shipped, lines};
use bramah_model::resolve::names::{self, NameTarget};
use bramah_model::resolve::{ClassId, Library};
use bramah_syntax::ast::Ident;
use bramah_syntax::diag::Span;
use bramah_syntax::symbol::Symbol;
use bramah_syntax::world::World;
use lsp_types::Range;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A range in a file. Relative paths are files that ship with bramah.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileRange {
    /// Path of the file.
    pub path: PathBuf,
    /// Start line and column, end line and column, in units of the protocol.
    pub range: (u32, u32, u32, u32),
}

impl FileRange {
    /// The range of a span of the library.
    fn of(library: &Library<'_>, span: Span) -> FileRange {
        let source = library.sources.get(span.file);
        let Range { start, end } = lines::range(&source.text, span);
        FileRange { path: PathBuf::from(&source.path), range: (start.line, start.character, end.line, end.character) }
    }

    /// The range in the form of the protocol.
    pub fn lsp_range(&self) -> Range {
        let (a, b, c, d) = self.range;
        Range::new(lsp_types::Position::new(a, b), lsp_types::Position::new(c, d))
    }
}

/// The name at a byte offset, its end included. `None`: there is no name.
pub fn occurrence_at<'a>(view: &mut DocumentView<'_, 'a>, offset: u32) -> Option<NameOccurrence<'a>> {
    let file = view.file;
    let at = |ident: &Ident| ident.span.file == file && ident.span.start <= offset && offset <= ident.span.end;
    let mut found: Vec<NameOccurrence<'a>> =
        view.classes.clone().into_iter().flat_map(|id| occurrences::of_class(view.library, id, &at)).collect();
    // A name may be found more than once; the last one is taken.
    found.pop()
}

/// The identifier in the declaration of a target.
pub fn declared_at(library: &Library<'_>, target: NameTarget<'_>) -> Ident {
    match target {
        NameTarget::Class(id) => library.class(id).name,
        NameTarget::Component(member) => member.component.name,
        NameTarget::Literal(_, literal) => literal.name,
        NameTarget::Iterator(ident) => ident,
    }
}

/// Where the name at a byte offset is declared. `None`: there is no name, or it cannot be resolved.
///
/// The place may be in another file, also in one that ships.
pub fn definition(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<FileRange> {
    let target = occurrence_at(view, offset)?.target?;
    Some(FileRange::of(view.library, declared_at(view.library, target).span))
}

/// Where the type of the component at a byte offset is declared. `None` as for [`definition`].
pub fn type_definition(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<FileRange> {
    let target = occurrence_at(view, offset)?.target?;
    let class = names::inside(view.library, target)?;
    Some(FileRange::of(view.library, view.library.class(class).name.span))
}

/// A declaration in a form that outlives the library it was found in.
pub struct DeclarationSite {
    /// Range of the declaring identifier.
    pub place: FileRange,
    /// Byte offset of the identifier in its file.
    start: u32,
    /// The identifier.
    pub name: String,
    /// The class is alone in a file, or package folder, of its own name.
    pub own_file: bool,
    /// It is a loop variable, which is known in one file only.
    pub local: bool,
}

/// The declaration of the name at a byte offset. `None`: there is no name, or it cannot be resolved.
///
/// The result is used after the view is gone, by `references` and by renaming.
pub fn declared(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<DeclarationSite> {
    let target = occurrence_at(view, offset)?.target?;
    let ident = declared_at(view.library, target);
    let place = FileRange::of(view.library, ident.span);
    let name = ident.name.as_str().to_owned();
    let own_file = matches!(target, NameTarget::Class(id) if has_own_file(view.library, id, &place.path));
    let local = matches!(target, NameTarget::Iterator(_));
    Some(DeclarationSite { place, start: ident.span.start, name, own_file, local })
}

/// Whether a class is the outermost one of its file, and the file (or the folder, for a package) has its name.
///
/// Such a file must be renamed together with the class.
fn has_own_file(library: &Library<'_>, id: ClassId, path: &Path) -> bool {
    let file = library.class(id).span.file;
    let outermost = library.parent(id).is_none_or(|around| library.class(around).span.file != file);
    let folder = path.file_name().is_some_and(|f| f == "package.mo");
    let named = if folder { path.parent().and_then(Path::file_name) } else { path.file_stem() };
    outermost && named.is_some_and(|n| n == library.class(id).name.name.as_str())
}

/// The full name of the class in which the name at a byte offset is declared, when that class already has an element
/// called `name`.
///
/// `None`: the new name is free, or it belongs to a loop variable.
pub fn class_with(view: &mut DocumentView<'_, '_>, offset: u32, name: &str) -> Option<String> {
    let owner = match occurrence_at(view, offset)?.target? {
        NameTarget::Class(id) => view.library.parent(id)?,
        NameTarget::Component(member) => member.owner,
        NameTarget::Literal(id, _) => id,
        NameTarget::Iterator(_) => return None,
    };
    names::element(view.library, owner, Symbol::new(name))?;
    Some(view.library.full_name(owner))
}

/// All uses of a declaration in files of the user, in the order of files and places. The declaration itself is included
/// when it is in one of the files.
///
/// `files` are absolute paths. Uses in files that ship are left out, as the user cannot change them.
pub fn references(texts: &EditorWorkspace<'_>, files: &[PathBuf], wanted: &DeclarationSite) -> Vec<FileRange> {
    let mut found = BTreeSet::new();
    texts.with_library(|library, texts| {
        for id in all_classes(library, texts, files, &wanted.name) {
            let named = |ident: &Ident| ident.name == wanted.name.as_str();
            // Names after `within` are not part of any class.
            let mut all = occurrences::of_within(library, id, &named);
            all.extend(occurrences::of_class(library, id, &named));
            for occurrence in all {
                let Some(target) = occurrence.target else { continue };
                let declared = declared_at(library, target);
                let path = &library.sources.get(declared.span.file).path;
                // The target is compared by file and offset, as its class has another number in this library.
                if declared.span.start == wanted.start && Path::new(path) == wanted.place.path {
                    found.insert(FileRange::of(library, occurrence.ident.span));
                }
            }
        }
    });
    found.into_iter().filter(|p| !is_shipped(&p.path)).collect()
}

/// The outermost classes of the files whose text contains `word`. A package is entered once as a whole.
///
/// The search for the word avoids parsing most files.
fn all_classes<'a>(
    library: &mut Library<'a>,
    texts: &EditorWorkspace<'a>,
    files: &[PathBuf],
    word: &str,
) -> Vec<ClassId> {
    let mut found = Vec::new();
    let mut packages = BTreeSet::new();
    for path in files {
        match outermost(texts.world, path) {
            Some(folder) => _ = packages.insert(folder),
            None => {
                if texts.world.read(path).is_ok_and(|text| text.contains(word)) {
                    found.extend(library.add_path(texts.world, path).unwrap_or_default());
                }
            }
        }
    }
    for folder in packages {
        let top = library.add_path(texts.world, &folder).unwrap_or_default();
        top.into_iter().for_each(|id| stored_apart(library, id, word, &mut found));
    }
    found
}

/// Adds a package and the classes stored as files in its folder, as far as their files contain `word`.
fn stored_apart(library: &mut Library<'_>, id: ClassId, word: &str, found: &mut Vec<ClassId>) {
    let file = library.class(id).span.file;
    if library.sources.get(file).text.contains(word) {
        found.push(id);
    }
    for name in library.folder_members(id) {
        // Classes in the same file are part of the package's own tree.
        if let Some(child) = library.child(id, name).filter(|c| library.class(*c).span.file != file) {
            stored_apart(library, child, word, found);
        }
    }
}

/// The folder of the outermost package around a file. `None`: its folder is not a package.
fn outermost(world: &dyn World, path: &Path) -> Option<PathBuf> {
    let mut found = None;
    let mut folder = path.parent();
    while let Some(at) = folder.filter(|f| world.read(&f.join("package.mo")).is_ok()) {
        found = Some(at.to_path_buf());
        folder = at.parent();
    }
    found
}

/// Whether a text is a valid name for a component or class: one identifier that is not a keyword.
pub fn is_name(text: &str) -> bool {
    let file = bramah_syntax::diag::FileId(0);
    bramah_syntax::parse_path(file, text).is_some_and(|path| path.parts.len() == 1 && !path.global)
}
