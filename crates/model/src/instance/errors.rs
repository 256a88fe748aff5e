//! Messages that several parts of the instance report, and helpers to word them.
//!
//! Suggestions come from [`nearest`], which finds the most similar of the known names.

use super::lookup::BuiltinType;
use super::{Instance, LookupContext, ScopeId};
use crate::resolve::{ClassId, nested_classes};
use bramah_syntax::ast;
use bramah_syntax::diag::{Code, Diagnostic, Label, Span};
use bramah_syntax::symbol::Symbol;

pub use bramah_syntax::diag::nearest;

/// A name for a message, cut after 60 characters if it has more than 80.
pub fn short(name: &str) -> String {
    if name.chars().count() <= 80 {
        return name.to_string();
    }
    let head: String = name.chars().take(60).collect();
    format!("{head}... ({} bytes)", name.len())
}

impl<'a> Instance<'a, '_> {
    /// Adds the component of the model to errors reported since `mark` that lie in other files, as in a library.
    /// `mark` is the number of messages before the component was built, and `span` its declaration.
    pub fn point_at(&mut self, mark: usize, component: &str, span: Span) {
        for d in self.diagnostics[mark..].iter_mut().filter(|d| d.is_error() && !d.labels.is_empty()) {
            // Messages at the component itself need no second label.
            if d.labels.iter().all(|l| l.span.file != span.file) {
                d.labels.push(Label { span, text: format!("in the component `{component}` of your model") });
                d.instance.get_or_insert_with(|| component.to_owned());
            }
        }
    }

    /// The component at the top level of the model that an instance is or belongs to.
    /// `None` for the model itself, packages and functions.
    pub fn outermost(&self, mut scope: ScopeId) -> Option<ScopeId> {
        while let Some(owner) = self.scope(scope).owner {
            if owner == self.root {
                return Some(scope);
            }
            scope = owner;
        }
        None
    }

    /// Reports valid Modelica that is not supported. `what` begins the sentence: "a `delay` whose time changes".
    pub(super) fn unsupported(&mut self, span: Span, what: &str) {
        self.report(
            Diagnostic::new(Code::Unsupported, format!("{what} is not supported"))
                .at(span, "valid Modelica that bramah cannot use yet"),
        );
    }

    /// Reports a built-in function that is not supported, with advice what to write instead.
    /// `spatialDistribution` and the clocked operators get different advice.
    pub(super) fn unsupported_function(&mut self, span: Span, name: &str) {
        let advice = match name {
            "spatialDistribution" => "cut the line into a chain of volumes and resistances",
            _ => "use `when sample(start, interval) then`, with `pre` for the value before",
        };
        self.report(
            Diagnostic::new(Code::Unsupported, format!("`{name}()` is not supported"))
                .at(span, "valid Modelica that bramah cannot use yet")
                .help(advice),
        );
    }

    /// Reports a path that names something else where a class is needed. `class` is where it is used.
    pub(super) fn unknown_class(&mut self, path: &ast::Path, class: ClassId) {
        let inside = self.library.full_name(class);
        self.report(
            Diagnostic::new(Code::UnknownClass, format!("`{}` is not a class", short(&path.dotted())))
                .at(path.span, "a class is needed here")
                .class(inside),
        );
    }

    /// Reports a base class that is not found. `class` extends it, and `parent` is the place around `class`.
    /// If an import of the first part leads nowhere, that is reported instead.
    pub(super) fn unknown_base(&mut self, path: &ast::Path, class: ClassId, parent: LookupContext) {
        // Looked up again, to find which part of the path is unknown.
        let part = self.names().lookup_path(parent, path).err().unwrap_or(0);
        if part == 0 && self.broken_import(parent, path.parts[0].name).is_some() {
            self.unknown_class_at(parent, path, part);
            return;
        }
        let mut names = self.class_names_around(class);
        names.extend(self.class_names_at(parent));
        self.unknown_class_message(path, part, &names);
    }

    /// Reports a class that is not found, with the most similar name. `part` is the index of the unknown part.
    ///
    /// If the first part should have come from an import with a wrong path, the import is reported instead.
    /// The names to choose from are those visible at `view`, or those in the package before the unknown part.
    pub(super) fn unknown_class_at(&mut self, view: LookupContext, path: &ast::Path, part: usize) {
        if let Some(import) = self.broken_import(view, path.parts[0].name).filter(|_| part == 0) {
            let part = self.names().lookup_path(super::ROOT, &import).err().unwrap_or(0);
            self.unknown_class_at(super::ROOT, &import, part);
            return;
        }
        let names = if part == 0 {
            self.class_names_at(view)
        } else {
            let shorter = ast::Path { global: path.global, parts: path.parts[..part].to_vec(), span: path.span };
            match self.names().lookup_path(view, &shorter) {
                // Only a package has members to suggest.
                Ok(super::lookup::LookupResult::Class(c)) => {
                    let nested = nested_classes(self.library.class(c.class)).map(|n| n.name.name);
                    nested.chain(self.library.folder_members(c.class)).collect()
                }
                _ => Vec::new(),
            }
        };
        self.unknown_class_message(path, part, &names);
    }

    /// The path of the import that declares `name` around `view`, for a name that was not found.
    /// `None` if no import declares it. Only imports of single names count.
    /// The search goes outwards from `view`, as the lookup of the name did.
    fn broken_import(&mut self, mut view: LookupContext, name: Symbol) -> Option<ast::Path> {
        while view.scope != super::ROOT.scope {
            let template = self.scope(view.scope).template.clone();
            let base = template.bases.get(view.base as usize)?;
            for import in &base.imports {
                if let ast::Import::Single { alias, path } = import
                    && alias.as_ref().or(path.parts.last()).is_some_and(|i| i.name == name)
                {
                    return Some(path.clone());
                }
            }
            view = base.parent;
        }
        None
    }

    /// Reports an unknown class. `names` are the classes known at that place.
    ///
    /// A name that begins with `Modelica` gets a hint that most of that library is not built in.
    /// `part` is the index of the unknown name in the path.
    fn unknown_class_message(&mut self, path: &ast::Path, part: usize, names: &[Symbol]) {
        let name = path.parts[part].name.as_str();
        let whole = short(&path.dotted());
        let message = if part == 0 {
            format!("there is no class `{}`", short(name))
        } else {
            let before: Vec<_> = path.parts[..part].iter().map(|p| p.name.as_str()).collect();
            format!("`{}` has no class `{}`", short(&before.join(".")), short(name))
        };
        let mut d = Diagnostic::new(Code::UnknownClass, message).at(path.parts[part].span, "not found");
        if let Some(near) = nearest(name, names.iter().map(|n| n.as_str())) {
            d = d.meant(near);
        } else if part == 0 && name == "Modelica" || whole.starts_with("Modelica.") {
            d = d.help("only `Modelica.Units.SI`, `Modelica.Constants` and `Modelica.Math` are built in; give other libraries with `--library DIR`");
        } else {
            d = d.help("check the spelling, or name the folder that holds it with `--library DIR`");
        }
        self.report(d);
    }

    /// The classes that are visible from a class, for suggestions: in it, in what encloses it, and at the top level.
    /// The predefined types are among them.
    fn class_names_around(&mut self, class: ClassId) -> Vec<Symbol> {
        let mut names = Vec::new();
        let mut at = Some(class);
        while let Some(c) = at {
            names.extend(nested_classes(self.library.class(c)).map(|n| n.name.name));
            names.extend(self.library.folder_members(c));
            at = self.library.parent(c);
        }
        names.extend(["Real", "Integer", "Boolean", "String"].map(Symbol::new));
        let own: Vec<ClassId> = self.library.own.clone();
        names.extend(own.iter().map(|&o| self.library.class(o).name.name));
        names.extend(self.library.top_level());
        names
    }

    /// The classes that are visible from a place, for suggestions. Inherited ones are left out.
    fn class_names_at(&mut self, view: LookupContext) -> Vec<Symbol> {
        let template = self.scope(view.scope).template.clone();
        match template.bases.get(view.base as usize) {
            Some(base) => self.class_names_around(base.class),
            None => Vec::new(),
        }
    }

    /// Reports a modifier of an element that the class does not have. `known` are the names of its elements.
    /// `class` is the name of the class for the message.
    pub(super) fn unknown_modifier(&mut self, name: ast::Ident, class: &str, known: &[Symbol]) {
        let mut d = Diagnostic::new(
            Code::UnknownModifier,
            format!("`{class}` has no element `{}` to modify", short(name.name.as_str())),
        )
        .at(name.span, "not an element of this class")
        .class(class);
        d = match nearest(name.name.as_str(), known.iter().map(|n| n.as_str())) {
            Some(near) => d.meant(near),
            None => d.help(list_names("it has", known)),
        };
        self.report(d);
    }

    /// Reports `break connect(a, b)` of a connection that the class does not have (MLS 7.4).
    pub(super) fn unknown_connection(&mut self, a: &ast::Expr, b: &ast::Expr, class: &str) {
        self.report(
            Diagnostic::new(Code::UnknownModifier, format!("`{class}` has no `connect({a}, {b})` to leave out"))
                .at(a.span, "not a connection of this class")
                .class(class)
                .help("write both ports as they stand there, in either order"),
        );
    }

    /// Reports a modifier of an attribute that the predefined type does not have.
    /// The message lists the attributes that the type has, or the most similar one.
    pub(super) fn unknown_attribute(&mut self, name: Symbol, span: Span, builtin: BuiltinType) {
        let known = super::components::attributes_of(builtin);
        let ty = builtin_name(builtin);
        let mut d =
            Diagnostic::new(Code::UnknownModifier, format!("`{}` is not an attribute of `{ty}`", short(name.as_str())))
                .at(span, "not known here");
        if let Some(near) = nearest(name.as_str(), known.iter().copied()) {
            d = d.meant(near);
        } else {
            d = d.help(format!("attributes are: {}", known.join(", ")));
        }
        self.report(d);
    }

    /// Reports an error without a label, and returns `None` for the caller to pass on.
    pub(in crate::instance) fn fail<T>(&mut self, code: Code, message: &str, span: Span) -> Option<T> {
        self.report(Diagnostic::new(code, message).at(span, ""));
        None
    }
}

/// The name of a predefined type in Modelica.
/// Enumerations have no common name; their kind is given.
pub fn builtin_name(b: BuiltinType) -> &'static str {
    match b {
        BuiltinType::Real => "Real",
        BuiltinType::Integer => "Integer",
        BuiltinType::Boolean => "Boolean",
        BuiltinType::String => "String",
        BuiltinType::Object => "ExternalObject",
        BuiltinType::Enumeration(_) => "enumeration",
    }
}

/// A list of names for a message: "it has `a`, `b`, `c` and 4 more". At most ten are shown.
pub fn list_names(intro: &str, names: &[Symbol]) -> String {
    let shown: Vec<String> = names.iter().take(10).map(|n| format!("`{n}`")).collect();
    match names.len() {
        0 => format!("{intro} no elements"),
        n if n > 10 => format!("{intro} {} and {} more", shown.join(", "), n - 10),
        _ => format!("{intro} {}", shown.join(", ")),
    }
}
