//! The library of classes: reads files as names are asked for, and finds classes by their static names.
//!
//! Names that depend on an instance (inherited elements, redeclared classes) are the business of `instance`.

pub mod names;

use bramah_syntax::ast::{self, ClassBody, ElementKind};
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources};
use bramah_syntax::symbol::Symbol;
use bramah_syntax::world::World;
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use typed_arena::Arena;

/// Owner of all syntax trees of one compilation.
pub type SyntaxArena = Arena<ast::StoredDefinition>;

/// A class in a [`Library`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClassId(pub u32);

/// A folder that holds top-level packages, or the members of a package.
#[derive(Clone)]
struct PackageFolder<'a> {
    world: &'a dyn World,
    path: PathBuf,
}

struct ClassEntry<'a> {
    parent: Option<ClassId>,
    ast: &'a ast::Class,
    folder: Option<PackageFolder<'a>>,
    children: FxHashMap<Symbol, Option<ClassId>>,
    /// Direct bases by the text, once they have been asked for ([`names`]).
    bases: Option<Rc<[ClassId]>>,
}

/// In place of a file: only what the annotations of functions name.
pub const ANNOTATIONS: &str = "annotations";

/// All classes that can be named, loaded as far as they have been asked for.
pub struct Library<'a> {
    trees: &'a SyntaxArena,
    entries: Vec<ClassEntry<'a>>,
    top: FxHashMap<Symbol, Option<ClassId>>,
    /// Top-level classes of the user's own files, in order.
    pub own: Vec<ClassId>,
    roots: Vec<PackageFolder<'a>>,
    by_ast: FxHashMap<*const ast::Class, ClassId>,
    /// Where files that models name are looked for.
    data_folder: Option<PackageFolder<'a>>,
    /// C sources and libraries that may be called.
    externals: Vec<PathBuf>,
    data: FxHashMap<String, FileId>,
    /// All texts read so far.
    pub sources: Sources,
    /// What the parser and the search for files had to say.
    pub diagnostics: Vec<Diagnostic>,
}

impl<'a> Library<'a> {
    /// An empty library. `roots` are folders whose entries are top-level packages, in order of precedence.
    pub fn new(trees: &'a SyntaxArena, roots: Vec<(&'a dyn World, PathBuf)>) -> Self {
        Library {
            trees,
            entries: Vec::new(),
            top: FxHashMap::default(),
            own: Vec::new(),
            roots: roots.into_iter().map(|(world, path)| PackageFolder { world, path }).collect(),
            by_ast: FxHashMap::default(),
            data_folder: None,
            externals: Vec::new(),
            data: FxHashMap::default(),
            sources: Sources::default(),
            diagnostics: Vec::new(),
        }
    }

    /// The syntax of a class.
    pub fn class(&self, id: ClassId) -> &'a ast::Class {
        self.entries[id.0 as usize].ast
    }

    /// The class that textually contains this one.
    pub fn parent(&self, id: ClassId) -> Option<ClassId> {
        self.entries[id.0 as usize].parent
    }

    /// The full dotted name.
    pub fn full_name(&self, id: ClassId) -> String {
        let name = self.class(id).name.name.as_str();
        match self.parent(id) {
            Some(parent) => format!("{}.{name}", self.full_name(parent)),
            None => name.to_string(),
        }
    }

    /// The id of a class given by its syntax node, if it was entered.
    pub fn id_of(&self, class: &ast::Class) -> Option<ClassId> {
        self.by_ast.get(&std::ptr::from_ref(class)).copied()
    }

    /// Enters a class that stands inside another one (a nested or redeclared class).
    pub fn enter(&mut self, ast: &'a ast::Class, parent: Option<ClassId>) -> ClassId {
        self.enter_with(ast, parent, None)
    }

    fn enter_with(
        &mut self,
        ast: &'a ast::Class,
        parent: Option<ClassId>,
        folder: Option<PackageFolder<'a>>,
    ) -> ClassId {
        if let Some(id) = self.id_of(ast) {
            return id;
        }
        let id = ClassId(u32::try_from(self.entries.len()).expect("fewer than 2^32 classes"));
        self.entries.push(ClassEntry { parent, ast, folder, children: FxHashMap::default(), bases: None });
        self.by_ast.insert(std::ptr::from_ref(ast), id);
        id
    }

    /// Parses a text and enters its classes at the top; returns them.
    pub fn add_text(&mut self, path: &str, text: &str) -> Vec<ClassId> {
        let tree = self.parse(path, text);
        let mut ids = Vec::new();
        for class in &tree.classes {
            let id = self.enter(class, None);
            self.top.insert(class.name.name, Some(id));
            ids.push(id);
        }
        self.own.extend(&ids);
        ids
    }

    /// Loads the user's file or package folder and returns the classes it names.
    ///
    /// A file that belongs to a package (there is a `package.mo` beside it) brings the whole package with it.
    ///
    /// # Errors
    /// A diagnostic when the file cannot be read.
    pub fn add_path(&mut self, world: &'a dyn World, path: &Path) -> Result<Vec<ClassId>, Box<Diagnostic>> {
        if world.list(path).is_some() {
            return self.add_package(world, path).map(|id| vec![id]);
        }
        match path.parent().filter(|p| has_package(world, p)).map(Path::to_path_buf) {
            Some(folder) if path.file_name().is_some_and(|f| f == "package.mo") => {
                self.add_package(world, &folder).map(|id| vec![id])
            }
            Some(folder) => self.add_member(world, &folder, path),
            None => self.add_file(world, path),
        }
    }

    fn add_file(&mut self, world: &'a dyn World, path: &Path) -> Result<Vec<ClassId>, Box<Diagnostic>> {
        let text = world.read(path).map_err(|why| Box::new(unreadable(path, &why)))?;
        // Packages beside the file can be named without further ado.
        if let Some(parent) = path.parent() {
            self.roots.insert(0, PackageFolder { world, path: parent.to_path_buf() });
        }
        Ok(self.add_text(&path.display().to_string(), &text))
    }

    /// A file inside a package folder: the outermost package becomes top-level, the file's class is found inside.
    fn add_member(
        &mut self,
        world: &'a dyn World,
        package: &Path,
        file: &Path,
    ) -> Result<Vec<ClassId>, Box<Diagnostic>> {
        let mut outermost = package;
        let mut names = vec![file.file_stem().unwrap_or_default().to_string_lossy().into_owned()];
        while let Some(above) = outermost.parent().filter(|p| has_package(world, p)) {
            names.push(outermost.file_name().unwrap_or_default().to_string_lossy().into_owned());
            outermost = above;
        }
        let mut id = self.add_package(world, outermost)?;
        for name in names.iter().rev() {
            id = self
                .child(id, Symbol::new(name))
                .ok_or_else(|| Box::new(unreadable(file, &format!("the package has no class `{name}`"))))?;
        }
        Ok(vec![id])
    }

    fn add_package(&mut self, world: &'a dyn World, folder: &Path) -> Result<ClassId, Box<Diagnostic>> {
        if let Some(parent) = folder.parent() {
            self.roots.insert(0, PackageFolder { world, path: parent.to_path_buf() });
        }
        let file = folder.join("package.mo");
        let text = world.read(&file).map_err(|why| {
            Box::new(unreadable(&file, &why).help("a folder is a package when it holds a `package.mo`"))
        })?;
        let tree = self.parse(&file.display().to_string(), &text);
        let class = tree.classes.first().ok_or_else(|| Box::new(unreadable(&file, "it holds no class")))?;
        let id = self.enter_with(class, None, Some(PackageFolder { world, path: folder.to_path_buf() }));
        self.top.insert(class.name.name, Some(id));
        self.own.push(id);
        Ok(id)
    }

    fn parse(&mut self, path: &str, text: &str) -> &'a ast::StoredDefinition {
        let file: FileId = self.sources.add(path, text);
        let parsed = bramah_syntax::parse(file, text);
        self.diagnostics.extend(parsed.diagnostics);
        self.trees.alloc(parsed.tree)
    }

    /// A top-level class that has been asked for before.
    pub fn loaded(&self, name: Symbol) -> Option<ClassId> {
        *self.top.get(&name)?
    }

    /// A top-level class by name: the user's, then those of the roots in order.
    pub fn top(&mut self, name: Symbol) -> Option<ClassId> {
        if let Some(found) = self.top.get(&name) {
            return *found;
        }
        // Entered first, so that a cyclic search ends.
        self.top.insert(name, None);
        let found = (0..self.roots.len()).find_map(|i| {
            let folder = self.roots[i].clone();
            self.load_from(&folder, name, None)
        });
        self.top.insert(name, found);
        found
    }

    /// A class declared textually inside another one (not inherited), or stored in its folder.
    pub fn child(&mut self, class: ClassId, name: Symbol) -> Option<ClassId> {
        if let Some(found) = self.entries[class.0 as usize].children.get(&name) {
            return *found;
        }
        let found = self.find_child(class, name);
        self.entries[class.0 as usize].children.insert(name, found);
        found
    }

    fn find_child(&mut self, class: ClassId, name: Symbol) -> Option<ClassId> {
        let ast = self.class(class);
        if let Some(nested) = nested_classes(ast).find(|c| c.name.name == name) {
            return Some(self.enter(nested, Some(class)));
        }
        let folder = self.entries[class.0 as usize].folder.clone()?;
        self.load_from(&folder, name, Some(class))
    }

    /// Names of the classes stored in the folder of a package, sorted; empty for other classes.
    pub fn folder_members(&self, class: ClassId) -> Vec<Symbol> {
        self.entries[class.0 as usize].folder.as_ref().map_or_else(Vec::new, Self::names_in)
    }

    /// Names of the packages and models at the top of all folders.
    pub fn top_level(&self) -> Vec<Symbol> {
        self.roots.iter().flat_map(Self::names_in).collect()
    }

    fn names_in(folder: &PackageFolder<'a>) -> Vec<Symbol> {
        let mut names = Vec::new();
        for (name, is_folder) in folder.world.list(&folder.path).unwrap_or_default() {
            if is_folder && has_package(folder.world, &folder.path.join(&name)) {
                names.push(Symbol::new(&name));
            } else if let Some(stem) = name.strip_suffix(".mo").filter(|s| *s != "package") {
                names.push(Symbol::new(stem));
            }
        }
        names
    }

    fn load_from(&mut self, folder: &PackageFolder<'a>, name: Symbol, parent: Option<ClassId>) -> Option<ClassId> {
        let word = name.as_str().trim_matches('\'');
        if word.is_empty() || word.contains(['/', '\\', '\0']) || word.len() > 200 {
            return None;
        }
        let world = folder.world;
        let inner = folder.path.join(word);
        let file = inner.join("package.mo");
        if let Ok(text) = world.read(&file) {
            let tree = self.parse(&file.display().to_string(), &text);
            let class = tree.classes.first().filter(|c| c.name.name == name)?;
            return Some(self.enter_with(class, parent, Some(PackageFolder { world, path: inner })));
        }
        let file = folder.path.join(format!("{word}.mo"));
        let text = world.read(&file).ok()?;
        let tree = self.parse(&file.display().to_string(), &text);
        let class = tree.classes.iter().find(|c| c.name.name == name)?;
        Some(self.enter(class, parent))
    }

    /// Says where relative names of data files begin.
    pub fn set_data_folder(&mut self, world: &'a dyn World, path: PathBuf) {
        self.data_folder = Some(PackageFolder { world, path });
    }

    /// Allows calls of C code: of these sources and libraries, and of what annotations name.
    pub fn set_externals(&mut self, files: Vec<PathBuf>) {
        self.externals = files;
    }

    /// Whether C code may be called.
    pub fn calls_c(&self) -> bool {
        !self.externals.is_empty()
    }

    /// The library that the C compiler makes of a text with the code that may be called.
    ///
    /// # Errors
    /// Why there is none.
    #[cfg(feature = "fmi")]
    pub fn compile_c(
        &self,
        text: &str,
        utilities: &str,
        arguments: Vec<std::ffi::OsString>,
    ) -> Result<bramah_syntax::world::CompiledC, String> {
        let Some(folder) = &self.data_folder else { return Err("there are no files here".to_owned()) };
        let named = self.externals.iter().filter(|f| f.as_os_str() != ANNOTATIONS).map(|f| f.clone().into_os_string());
        let arguments: Vec<_> = named.chain(arguments).collect();
        folder.world.compile_c(text, utilities, &arguments)
    }

    /// The path of what `modelica://Package/...` names, where that package has a folder.
    pub fn resource(&mut self, address: &str) -> Option<PathBuf> {
        let (package, rest) = address.strip_prefix("modelica://")?.split_once('/')?;
        let id = self.find(package)?;
        Some(self.entries[id.0 as usize].folder.clone()?.path.join(rest))
    }

    /// A data file that a model names: `modelica://Package/...` below the folder of a package, an absolute path, or one
    /// that begins at the data folder or where the command runs.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn data(&mut self, name: &str) -> Result<FileId, String> {
        if let Some(&file) = self.data.get(name) {
            return Ok(file);
        }
        let (path, text) = self.read_data(name, |world, path| world.read(path))?;
        let file = self.sources.add(path.display().to_string(), text);
        self.data.insert(name.to_owned(), file);
        Ok(file)
    }

    /// The bytes of a file that a model names, as [`Library::data`].
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn bytes(&mut self, name: &str) -> Result<Vec<u8>, String> {
        self.read_data(name, |world, path| world.bytes(path)).map(|(_, bytes)| bytes)
    }

    /// Enters a class that was made of a file: the first of its text.
    pub fn generated(&mut self, path: &str, text: &str) -> Option<ClassId> {
        let class = self.parse(path, text).classes.first()?;
        Some(self.enter(class, None))
    }

    fn read_data<T>(
        &mut self,
        name: &str,
        read: impl Fn(&dyn World, &Path) -> Result<T, String>,
    ) -> Result<(PathBuf, T), String> {
        if let Some(address) = name.strip_prefix("modelica://") {
            let (package, rest) = address.split_once('/').unwrap_or((address, ""));
            let id = self.find(package).ok_or_else(|| format!("there is no package `{package}`"))?;
            let folder = self.entries[id.0 as usize].folder.clone();
            let folder = folder.ok_or_else(|| format!("the package `{package}` has no folder"))?;
            let path = folder.path.join(rest);
            return read(folder.world, &path).map(|text| (path, text));
        }
        let Some(folder) = &self.data_folder else { return Err("there are no files here".to_owned()) };
        let (beside, path) = (folder.path.join(name), PathBuf::from(name));
        let found = read(folder.world, &beside).map(|text| (beside.clone(), text));
        // The message speaks of the first place; a file that is there but unreadable must not be passed over in words.
        found.or_else(|why| read(folder.world, &path).map(|text| (path, text)).map_err(|_| why))
    }

    /// A class by its full dotted name.
    pub fn find(&mut self, dotted: &str) -> Option<ClassId> {
        let mut parts = dotted.split('.').map(Symbol::new);
        let mut id = self.top(parts.next()?)?;
        for part in parts {
            id = self.child(id, part)?;
        }
        Some(id)
    }
}

/// Classes declared in the body of a class.
pub fn nested_classes(class: &ast::Class) -> impl Iterator<Item = &ast::Class> {
    let elements = match &class.body {
        ClassBody::Long(body) => body.elements.as_slice(),
        _ => &[],
    };
    elements.iter().filter_map(|e| match &e.kind {
        ElementKind::Class(c) => Some(&**c),
        _ => None,
    })
}

fn has_package(world: &dyn World, folder: &Path) -> bool {
    world.list(folder).is_some_and(|entries| entries.iter().any(|(name, dir)| !dir && name == "package.mo"))
}

fn unreadable(path: &Path, why: &str) -> Diagnostic {
    Diagnostic::new(Code::FileAccess, format!("cannot read `{}`: {why}", path.display()))
}
