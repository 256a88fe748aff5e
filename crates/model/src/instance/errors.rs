//! Messages of this stage.

use super::lookup::BuiltinType;
use super::{Instance, LookupContext, ScopeId};
use crate::resolve::{ClassId, nested_classes};
use bramah_syntax::ast;
use bramah_syntax::diag::{Code, Diagnostic, Label, Span};
use bramah_syntax::symbol::Symbol;

pub use bramah_syntax::diag::nearest;

/// A name cut to a length that fits in a message.
pub fn short(name: &str) -> String {
    if name.chars().count() <= 80 {
        return name.to_string();
    }
    let head: String = name.chars().take(60).collect();
    format!("{head}... ({} bytes)", name.len())
}

impl<'a> Instance<'a, '_> {
    /// Errors since a mark that stand in other files than the model, as in a library, get the component of the model that
    /// they come from.
    pub fn point_at(&mut self, mark: usize, component: &str, span: Span) {
        for d in self.diagnostics[mark..].iter_mut().filter(|d| d.is_error() && !d.labels.is_empty()) {
            if d.labels.iter().all(|l| l.span.file != span.file) {
                d.labels.push(Label { span, text: format!("in the component `{component}` of your model") });
                d.instance.get_or_insert_with(|| component.to_owned());
            }
        }
    }

    /// The component of the model itself that an instance is or belongs to.
    pub fn outermost(&self, mut scope: ScopeId) -> Option<ScopeId> {
        while let Some(owner) = self.scope(scope).owner {
            if owner == self.root {
                return Some(scope);
            }
            scope = owner;
        }
        None
    }

    pub(super) fn unsupported(&mut self, span: Span, what: &str) {
        self.report(
            Diagnostic::new(Code::Unsupported, format!("{what} is not supported"))
                .at(span, "valid Modelica that bramah cannot use yet"),
        );
    }

    /// A built-in function left out, with what to write instead.
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

    pub(super) fn unknown_class(&mut self, path: &ast::Path, class: ClassId) {
        let inside = self.library.full_name(class);
        self.report(
            Diagnostic::new(Code::UnknownClass, format!("`{}` is not a class", short(&path.dotted())))
                .at(path.span, "a class is needed here")
                .class(inside),
        );
    }

    pub(super) fn unknown_base(&mut self, path: &ast::Path, class: ClassId, parent: LookupContext) {
        let part = self.names().lookup_path(parent, path).err().unwrap_or(0);
        if part == 0 && self.broken_import(parent, path.parts[0].name).is_some() {
            self.unknown_class_at(parent, path, part);
            return;
        }
        let mut names = self.class_names_around(class);
        names.extend(self.class_names_at(parent));
        self.unknown_class_message(path, part, &names);
    }

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
                Ok(super::lookup::LookupResult::Class(c)) => {
                    let nested = nested_classes(self.library.class(c.class)).map(|n| n.name.name);
                    nested.chain(self.library.folder_members(c.class)).collect()
                }
                _ => Vec::new(),
            }
        };
        self.unknown_class_message(path, part, &names);
    }

    /// The import that should have brought a name, where its own path leads nowhere.
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

    /// Names of classes visible from a class, for suggestions.
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

    fn class_names_at(&mut self, view: LookupContext) -> Vec<Symbol> {
        let template = self.scope(view.scope).template.clone();
        match template.bases.get(view.base as usize) {
            Some(base) => self.class_names_around(base.class),
            None => Vec::new(),
        }
    }

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

    /// `break connect(a, b)` of a connection that the class has not.
    pub(super) fn unknown_connection(&mut self, a: &ast::Expr, b: &ast::Expr, class: &str) {
        self.report(
            Diagnostic::new(Code::UnknownModifier, format!("`{class}` has no `connect({a}, {b})` to leave out"))
                .at(a.span, "not a connection of this class")
                .class(class)
                .help("write both ports as they stand there, in either order"),
        );
    }

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

    pub(in crate::instance) fn fail<T>(&mut self, code: Code, message: &str, span: Span) -> Option<T> {
        self.report(Diagnostic::new(code, message).at(span, ""));
        None
    }
}

/// The Modelica name of a built-in type.
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

/// "it has `a`, `b`, `c` and 4 more".
pub fn list_names(intro: &str, names: &[Symbol]) -> String {
    let shown: Vec<String> = names.iter().take(10).map(|n| format!("`{n}`")).collect();
    match names.len() {
        0 => format!("{intro} no elements"),
        n if n > 10 => format!("{intro} {} and {} more", shown.join(", "), n - 10),
        _ => format!("{intro} {}", shown.join(", ")),
    }
}
