//! Where a name is declared, where it is used, and what changes when it is renamed.

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

/// A range in a file. Relative paths ship with bramah.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileRange {
    /// The file.
    pub path: PathBuf,
    /// First line and unit, last line and unit.
    pub range: (u32, u32, u32, u32),
}

impl FileRange {
    fn of(library: &Library<'_>, span: Span) -> FileRange {
        let source = library.sources.get(span.file);
        let Range { start, end } = lines::range(&source.text, span);
        FileRange { path: PathBuf::from(&source.path), range: (start.line, start.character, end.line, end.character) }
    }

    /// As editors say it.
    pub fn lsp_range(&self) -> Range {
        let (a, b, c, d) = self.range;
        Range::new(lsp_types::Position::new(a, b), lsp_types::Position::new(c, d))
    }
}

/// The name at a byte.
pub fn occurrence_at<'a>(view: &mut DocumentView<'_, 'a>, offset: u32) -> Option<NameOccurrence<'a>> {
    let file = view.file;
    let at = |ident: &Ident| ident.span.file == file && ident.span.start <= offset && offset <= ident.span.end;
    let mut found: Vec<NameOccurrence<'a>> =
        view.classes.clone().into_iter().flat_map(|id| occurrences::of_class(view.library, id, &at)).collect();
    found.pop()
}

/// The identifier that declares something.
pub fn declared_at(library: &Library<'_>, target: NameTarget<'_>) -> Ident {
    match target {
        NameTarget::Class(id) => library.class(id).name,
        NameTarget::Component(member) => member.component.name,
        NameTarget::Literal(_, literal) => literal.name,
        NameTarget::Iterator(ident) => ident,
    }
}

/// Where the name at a byte is declared.
pub fn definition(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<FileRange> {
    let target = occurrence_at(view, offset)?.target?;
    Some(FileRange::of(view.library, declared_at(view.library, target).span))
}

/// Where the type of the component at a byte is declared.
pub fn type_definition(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<FileRange> {
    let target = occurrence_at(view, offset)?.target?;
    let class = names::inside(view.library, target)?;
    Some(FileRange::of(view.library, view.library.class(class).name.span))
}

/// A declaration found again in another look at the texts, and its word.
pub struct DeclarationSite {
    /// Where it is declared.
    pub place: FileRange,
    /// The same as a byte of the file.
    start: u32,
    /// The word.
    pub name: String,
    /// Whether the class has a file of its own name.
    pub own_file: bool,
    /// Whether it is the variable of a loop, known in one file only.
    pub local: bool,
}

/// What is declared under the name at a byte.
pub fn declared(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<DeclarationSite> {
    let target = occurrence_at(view, offset)?.target?;
    let ident = declared_at(view.library, target);
    let place = FileRange::of(view.library, ident.span);
    let name = ident.name.as_str().to_owned();
    let own_file = matches!(target, NameTarget::Class(id) if has_own_file(view.library, id, &place.path));
    let local = matches!(target, NameTarget::Iterator(_));
    Some(DeclarationSite { place, start: ident.span.start, name, own_file, local })
}

/// Whether a class stands in no other one of its file, and the file, or the folder of a package, has its name.
fn has_own_file(library: &Library<'_>, id: ClassId, path: &Path) -> bool {
    let file = library.class(id).span.file;
    let outermost = library.parent(id).is_none_or(|around| library.class(around).span.file != file);
    let folder = path.file_name().is_some_and(|f| f == "package.mo");
    let named = if folder { path.parent().and_then(Path::file_name) } else { path.file_stem() };
    outermost && named.is_some_and(|n| n == library.class(id).name.name.as_str())
}

/// The class in which the name at a byte is declared, where it has an element of another name already.
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

/// All uses of a declaration in some files of the user, and the declaration itself where it is in one of them.
pub fn references(texts: &EditorWorkspace<'_>, files: &[PathBuf], wanted: &DeclarationSite) -> Vec<FileRange> {
    let mut found = BTreeSet::new();
    texts.with_library(|library, texts| {
        for id in all_classes(library, texts, files, &wanted.name) {
            let named = |ident: &Ident| ident.name == wanted.name.as_str();
            let mut all = occurrences::of_within(library, id, &named);
            all.extend(occurrences::of_class(library, id, &named));
            for occurrence in all {
                let Some(target) = occurrence.target else { continue };
                let declared = declared_at(library, target);
                let path = &library.sources.get(declared.span.file).path;
                if declared.span.start == wanted.start && Path::new(path) == wanted.place.path {
                    found.insert(FileRange::of(library, occurrence.ident.span));
                }
            }
        }
    });
    found.into_iter().filter(|p| !is_shipped(&p.path)).collect()
}

/// The classes of the files in which a word occurs; packages as wholes, so that every file is entered once.
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

/// A package, and the classes in its folder, each of which is a file.
fn stored_apart(library: &mut Library<'_>, id: ClassId, word: &str, found: &mut Vec<ClassId>) {
    let file = library.class(id).span.file;
    if library.sources.get(file).text.contains(word) {
        found.push(id);
    }
    for name in library.folder_members(id) {
        if let Some(child) = library.child(id, name).filter(|c| library.class(*c).span.file != file) {
            stored_apart(library, child, word, found);
        }
    }
}

/// The outermost package around a file.
fn outermost(world: &dyn World, path: &Path) -> Option<PathBuf> {
    let mut found = None;
    let mut folder = path.parent();
    while let Some(at) = folder.filter(|f| world.read(&f.join("package.mo")).is_ok()) {
        found = Some(at.to_path_buf());
        folder = at.parent();
    }
    found
}

/// Whether a text can be the name of a component or class.
pub fn is_name(text: &str) -> bool {
    let file = bramah_syntax::diag::FileId(0);
    bramah_syntax::parse_path(file, text).is_some_and(|path| path.parts.len() == 1 && !path.global)
}
