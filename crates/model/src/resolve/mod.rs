//! The library of classes: finds classes by their full names and reads files on demand.
//!
//! A [`Library`] knows the folders of packages. A class is read and entered when somebody asks for its name.
//! Every class gets a [`ClassId`], which the rest of the compiler uses.
//! Only the text counts here: inherited elements and redeclarations depend on an instance, see `instance`.
//! [`names`] adds inheritance as far as the text alone determines it.

pub mod names;

use bramah_syntax::ast::{self, ClassBody, ElementKind};
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources};
use bramah_syntax::symbol::Symbol;
use bramah_syntax::world::World;
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use typed_arena::Arena;

/// The owner of all syntax trees of a compilation. Classes borrow from it.
pub type SyntaxArena = Arena<ast::StoredDefinition>;

/// The number of a class in a [`Library`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClassId(pub u32);

/// A folder that holds top-level packages, or the classes of a package.
#[derive(Clone)]
struct PackageFolder<'a> {
    /// Access to files.
    world: &'a dyn World,
    /// The path of the folder.
    path: PathBuf,
}

/// A class of the library.
struct ClassEntry<'a> {
    /// The class that encloses it in the text. `None` for top-level classes.
    parent: Option<ClassId>,
    /// Its syntax tree.
    ast: &'a ast::Class,
    /// The folder of a package that is stored as one; further classes are searched there.
    folder: Option<PackageFolder<'a>>,
    /// Classes in it that were asked for, with `None` for names that do not exist.
    children: FxHashMap<Symbol, Option<ClassId>>,
    /// Its direct bases by the text alone. `None` until [`names`] has looked for them.
    bases: Option<Rc<[ClassId]>>,
}

/// An entry in the list of allowed C files that allows what the annotations of functions name.
pub const ANNOTATIONS: &str = "annotations";

/// All classes that can be named, loaded as far as they have been asked for.
pub struct Library<'a> {
    /// The syntax trees.
    trees: &'a SyntaxArena,
    /// The classes, by their numbers.
    entries: Vec<ClassEntry<'a>>,
    /// Top-level classes that were asked for, with `None` for names that do not exist.
    top: FxHashMap<Symbol, Option<ClassId>>,
    /// Top-level classes of the user's own files, in the order in which they were added.
    pub own: Vec<ClassId>,
    /// Folders of top-level packages, in order of precedence.
    roots: Vec<PackageFolder<'a>>,
    /// Numbers of the classes that are entered, by the addresses of their syntax trees.
    by_ast: FxHashMap<*const ast::Class, ClassId>,
    /// The folder in which relative names of data files begin.
    data_folder: Option<PackageFolder<'a>>,
    /// C sources and libraries that may be called. Empty if C code is not allowed.
    externals: Vec<PathBuf>,
    /// Data files that were read, by the names under which models ask for them.
    data: FxHashMap<String, FileId>,
    /// The texts of all files read so far.
    pub sources: Sources,
    /// Messages of the parser.
    pub diagnostics: Vec<Diagnostic>,
}

impl<'a> Library<'a> {
    /// An empty library. `roots` are folders with top-level packages, in order of precedence.
    /// No file is read until a class is asked for.
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

    /// The syntax tree of a class.
    pub fn class(&self, id: ClassId) -> &'a ast::Class {
        self.entries[id.0 as usize].ast
    }

    /// The class that encloses this one in the text. `None` for top-level classes.
    pub fn parent(&self, id: ClassId) -> Option<ClassId> {
        self.entries[id.0 as usize].parent
    }

    /// The full dotted name, as `Modelica.Math.sin`.
    pub fn full_name(&self, id: ClassId) -> String {
        let name = self.class(id).name.name.as_str();
        match self.parent(id) {
            Some(parent) => format!("{}.{name}", self.full_name(parent)),
            None => name.to_string(),
        }
    }

    /// The number of the class with this syntax tree. `None` if it is not entered.
    pub fn id_of(&self, class: &ast::Class) -> Option<ClassId> {
        self.by_ast.get(&std::ptr::from_ref(class)).copied()
    }

    /// Enters a class inside of `parent`, such as a nested class or a redeclaration. Entering it again gives the same
    /// number.
    pub fn enter(&mut self, ast: &'a ast::Class, parent: Option<ClassId>) -> ClassId {
        self.enter_with(ast, parent, None)
    }

    /// Like [`Self::enter`], with the folder of a package.
    /// Syntax trees are never moved, so their address identifies a class.
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

    /// Parses a text and enters its classes at the top level, in order. They count as the user's own.
    /// Errors go to `diagnostics`.
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

    /// Loads the user's file or package folder and returns the classes that it names.
    ///
    /// A file of a package, with a `package.mo` beside it, brings the complete package with it.
    /// Its class is then the result.
    ///
    /// # Errors
    /// A diagnostic, if the file cannot be read or has no class of its name.
    pub fn add_path(&mut self, world: &'a dyn World, path: &Path) -> Result<Vec<ClassId>, Box<Diagnostic>> {
        // A path that can be listed is a folder.
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

    /// Loads a file that belongs to no package, and returns its classes.
    fn add_file(&mut self, world: &'a dyn World, path: &Path) -> Result<Vec<ClassId>, Box<Diagnostic>> {
        let text = world.read(path).map_err(|why| Box::new(unreadable(path, &why)))?;
        // Packages beside the file can be named in it.
        if let Some(parent) = path.parent() {
            self.roots.insert(0, PackageFolder { world, path: parent.to_path_buf() });
        }
        Ok(self.add_text(&path.display().to_string(), &text))
    }

    /// Loads a file inside of a package folder. The outermost package becomes a top-level class of the user.
    /// The result is the class of the file, which is looked up inside.
    ///
    /// `package` is the folder of the file. Enclosing folders with a `package.mo` belong to the package too.
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

    /// Loads the `package.mo` of a folder as a top-level package of the user. Its other classes are read on demand.
    /// The folder around it becomes the first place to search for other top-level packages.
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

    /// Parses a text and keeps its tree. Messages of the parser go to `diagnostics`.
    fn parse(&mut self, path: &str, text: &str) -> &'a ast::StoredDefinition {
        let file: FileId = self.sources.add(path, text);
        let parsed = bramah_syntax::parse(file, text);
        self.diagnostics.extend(parsed.diagnostics);
        // The arena keeps the tree at its address, which identifies classes.
        self.trees.alloc(parsed.tree)
    }

    /// A top-level class that was asked for before. Reads no files. `None` if it was not, or does not exist.
    pub fn loaded(&self, name: Symbol) -> Option<ClassId> {
        *self.top.get(&name)?
    }

    /// A top-level class by its name. The user's own classes come first, then the folders in order.
    /// `None` if there is none.
    pub fn top(&mut self, name: Symbol) -> Option<ClassId> {
        if let Some(found) = self.top.get(&name) {
            return *found;
        }
        // Entered first, so that a search that comes back to the same name ends.
        self.top.insert(name, None);
        let found = (0..self.roots.len()).find_map(|i| {
            let folder = self.roots[i].clone();
            self.load_from(&folder, name, None)
        });
        self.top.insert(name, found);
        found
    }

    /// A class that is written inside of another one, or stored in its folder. Inherited classes do not count.
    /// `None` if there is none; the answer is remembered.
    pub fn child(&mut self, class: ClassId, name: Symbol) -> Option<ClassId> {
        if let Some(found) = self.entries[class.0 as usize].children.get(&name) {
            return *found;
        }
        let found = self.find_child(class, name);
        self.entries[class.0 as usize].children.insert(name, found);
        found
    }

    /// Like [`Self::child`], without the table of earlier answers.
    fn find_child(&mut self, class: ClassId, name: Symbol) -> Option<ClassId> {
        let ast = self.class(class);
        if let Some(nested) = nested_classes(ast).find(|c| c.name.name == name) {
            return Some(self.enter(nested, Some(class)));
        }
        let folder = self.entries[class.0 as usize].folder.clone()?;
        self.load_from(&folder, name, Some(class))
    }

    /// The names of the classes in the folder of a package, sorted. Empty for classes without a folder.
    pub fn folder_members(&self, class: ClassId) -> Vec<Symbol> {
        self.entries[class.0 as usize].folder.as_ref().map_or_else(Vec::new, Self::names_in)
    }

    /// The names of the top-level packages and models in all folders.
    pub fn top_level(&self) -> Vec<Symbol> {
        self.roots.iter().flat_map(Self::names_in).collect()
    }

    /// The names of the packages and model files in a folder.
    /// Only names are read, no files. `package.mo` itself is left out.
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

    /// Reads a class from a folder: `Name/package.mo` or `Name.mo`. `None` if neither exists or holds the class.
    ///
    /// `parent` is the package, `None` at the top level. A class in a folder can hold further classes in files.
    /// The class in a file must have the name of the file, otherwise it is not found.
    fn load_from(&mut self, folder: &PackageFolder<'a>, name: Symbol, parent: Option<ClassId>) -> Option<ClassId> {
        // The name is part of a path, so everything that leads to another folder is refused.
        let word = name.as_str().trim_matches('\'');
        if word.is_empty() || word.contains(['/', '\\', '\0']) || word.len() > 200 {
            return None;
        }
        let world = folder.world;
        let inner = folder.path.join(word);
        let file = inner.join("package.mo");
        // A folder with a `package.mo` is preferred to a file of the same name.
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

    /// Sets the folder in which relative names of data files begin.
    pub fn set_data_folder(&mut self, world: &'a dyn World, path: PathBuf) {
        self.data_folder = Some(PackageFolder { world, path });
    }

    /// Allows calls of C code in these sources and libraries. [`ANNOTATIONS`] in the list allows what annotations name.
    pub fn set_externals(&mut self, files: Vec<PathBuf>) {
        self.externals = files;
    }

    /// Whether C code may be called at all.
    pub fn calls_c(&self) -> bool {
        !self.externals.is_empty()
    }

    /// Compiles a C text together with the code that may be called, to a shared library.
    ///
    /// `utilities` are C functions for external code, `arguments` those of the compiler that annotations ask for.
    ///
    /// # Errors
    /// The reason, as the message of the compiler.
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

    /// The path that `modelica://Package/...` names. `None` if the package does not exist or has no folder.
    pub fn resource(&mut self, address: &str) -> Option<PathBuf> {
        let (package, rest) = address.strip_prefix("modelica://")?.split_once('/')?;
        let id = self.find(package)?;
        Some(self.entries[id.0 as usize].folder.clone()?.path.join(rest))
    }

    /// A data file that a model names. It is read once.
    ///
    /// `modelica://Package/...` begins at the folder of a package. Other names are absolute, or begin at the data
    /// folder, or else at the folder in which the command runs.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn data(&mut self, name: &str) -> Result<FileId, String> {
        if let Some(&file) = self.data.get(name) {
            return Ok(file);
        }
        let (path, text) = self.read_data(name, |world, path| world.read(path))?;
        let file = self.sources.add(path.display().to_string(), text);
        self.data.insert(name.to_owned(), file);
        Ok(file)
    }

    /// The bytes of a file that a model names, found like that of [`Library::data`].
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn bytes(&mut self, name: &str) -> Result<Vec<u8>, String> {
        self.read_data(name, |world, path| world.bytes(path)).map(|(_, bytes)| bytes)
    }

    /// Parses a generated text and enters its first class. It cannot be found by its name.
    /// `None` if the text has no class.
    pub fn generated(&mut self, path: &str, text: &str) -> Option<ClassId> {
        let class = self.parse(path, text).classes.first()?;
        Some(self.enter(class, None))
    }

    /// Finds a file that a model names and reads it with `read`. The result has its path.
    ///
    /// Names with `modelica://` are looked up in the package only. Other names are tried below the data folder and then
    /// as they are.
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
        // If both places fail, the reason at the first one is returned: a file that exists but is unreadable is more
        // telling.
        found.or_else(|why| read(folder.world, &path).map(|text| (path, text)).map_err(|_| why))
    }

    /// A class by its full dotted name. `None` if there is none. Inherited classes are not found.
    pub fn find(&mut self, dotted: &str) -> Option<ClassId> {
        let mut parts = dotted.split('.').map(Symbol::new);
        let mut id = self.top(parts.next()?)?;
        for part in parts {
            id = self.child(id, part)?;
        }
        Some(id)
    }
}

/// The classes that are declared in the body of a class, in the order of the text.
/// Short classes and enumerations have none. Classes in files of their own are not among them.
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

/// Whether a folder holds a `package.mo`.
fn has_package(world: &dyn World, folder: &Path) -> bool {
    world.list(folder).is_some_and(|entries| entries.iter().any(|(name, dir)| !dir && name == "package.mo"))
}

/// The message for a file that cannot be read.
fn unreadable(path: &Path, why: &str) -> Diagnostic {
    Diagnostic::new(Code::FileAccess, format!("cannot read `{}`: {why}", path.display()))
}
