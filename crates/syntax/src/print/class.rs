//! The text of files, classes, components and modifications, as methods of [`SyntaxPrinter`].
//! Prefixes are written in the order that the grammar requires, whatever order the source had.

use super::SyntaxPrinter;
use crate::ast::{
    CausalityPrefix, Class, ClassBody, ClassKind, ComponentDeclaration, ConstrainingClause, Element, ElementKind,
    ElementPrefixes, EnumLiteral, ExtendsClause, Import, LongBody, Modification, ModificationArgument,
    ModificationArgumentKind, StoredDefinition, TypePrefix, VariabilityPrefix,
};

/// Writers of files, classes and their parts. Each leaves the cursor where the next token may follow.
impl SyntaxPrinter {
    /// A file: its `within` clause and its classes, each ended by a semicolon.
    pub(super) fn file(&mut self, file: &StoredDefinition) {
        if let Some(within) = &file.within {
            self.word("within ");
            self.path(within);
            self.end(";");
        }
        for class in &file.classes {
            self.class(class);
            self.end(";");
        }
    }

    /// A class without its semicolon, in the form of its body: long, short, enumeration or derivative.
    /// Its own prefixes are written; those of an argument of a modification are not among them.
    pub(super) fn class(&mut self, class: &Class) {
        self.prefixes(&class.prefixes);
        self.prefix(class.prefixes.encapsulated, "encapsulated");
        self.prefix(class.prefixes.partial, "partial");
        self.word(keywords(class.kind));
        self.word(" ");
        match &class.body {
            ClassBody::Long(body) => self.long_class(class, body),
            ClassBody::Short { prefix, base, subscripts, modification } => {
                self.short_head(class);
                self.type_prefix(prefix);
                self.path(base);
                self.subscripts(subscripts);
                self.optional_modification(modification.as_ref());
                self.comment(class);
            }
            ClassBody::Enumeration(literals) => {
                self.short_head(class);
                self.enumeration(literals.as_deref());
                self.comment(class);
            }
            ClassBody::Derivative { function, by } => {
                self.short_head(class);
                self.word("der(");
                self.path(function);
                for name in by {
                    self.word(", ");
                    self.ident(name);
                }
                self.word(")");
                self.comment(class);
            }
        }
        self.constraint(class.constraint.as_ref());
    }

    /// The name and the sign of a short class: `A = `.
    fn short_head(&mut self, class: &Class) {
        self.ident(&class.name);
        self.word(" = ");
    }

    /// The description and annotation after a short class.
    fn comment(&mut self, class: &Class) {
        self.description(class.description.as_deref());
        self.annotation(class.annotation.as_ref());
    }

    /// `enumeration(...)`. `None` stands for the open enumeration `enumeration(:)`.
    fn enumeration(&mut self, literals: Option<&[EnumLiteral]>) {
        self.word("enumeration(");
        match literals {
            None => self.word(":"),
            Some(literals) => self.separated(literals, ", ", |p, literal| {
                p.ident(&literal.name);
                p.description(literal.description.as_deref());
            }),
        }
        self.word(")");
    }

    /// The name, description, body and `end` of a long class.
    /// The header ends its line, the parts are indented, and `end` stands at the depth of the class.
    fn long_class(&mut self, class: &Class, body: &LongBody) {
        if let Some(modification) = &body.class_extends {
            self.word("extends ");
            self.ident(&class.name);
            self.optional_modification(modification.as_ref());
        } else {
            self.ident(&class.name);
        }
        self.description(class.description.as_deref());
        self.word("\n");
        self.elements(&body.elements);
        self.sections(body);
        // The text of an external declaration is kept as written, its annotation included.
        if let Some(external) = &body.external_text {
            self.depth += 1;
            self.line(&format!("external {external};"));
            self.depth -= 1;
        }
        // The annotation of a class stands directly before its `end`.
        if let Some(annotation) = &class.annotation {
            self.depth += 1;
            self.begin();
            self.word("annotation");
            self.argument_list(&annotation.arguments);
            self.end(";");
            self.depth -= 1;
        }
        self.begin();
        self.word("end ");
        self.ident(&class.name);
    }

    /// The elements in order, with `public` or `protected` wherever the visibility changes.
    /// Without `protected` elements no keyword is written.
    fn elements(&mut self, elements: &[Element]) {
        let mut protected = false;
        // The keyword is written only where the visibility changes.
        for element in elements {
            if element.protected != protected {
                protected = element.protected;
                self.line(if protected { "protected" } else { "public" });
            }
            self.lines(std::slice::from_ref(element), Self::element);
        }
    }

    /// The equation and algorithm sections. Equations of one kind are one section; algorithms keep their sections.
    /// Equations come before algorithms, and initial sections before the others of their kind.
    fn sections(&mut self, body: &LongBody) {
        for (keyword, equations) in [("initial equation", &body.initial_equations), ("equation", &body.equations)] {
            if !equations.is_empty() {
                self.line(keyword);
                self.lines(equations, Self::equation);
            }
        }
        for (keyword, sections) in [("initial algorithm", &body.initial_algorithms), ("algorithm", &body.algorithms)] {
            for statements in sections {
                self.line(keyword);
                self.lines(statements, Self::statement);
            }
        }
    }

    /// One element, without its semicolon.
    fn element(&mut self, element: &Element) {
        match &element.kind {
            ElementKind::Import(import) => self.import(import),
            ElementKind::Extends(extends) => self.extends(extends),
            ElementKind::Class(class) => self.class(class),
            ElementKind::Component(component) => self.component(component),
        }
    }

    /// An `import` clause.
    fn import(&mut self, import: &Import) {
        self.word("import ");
        match import {
            Import::Single { alias, path } => {
                if let Some(alias) = alias {
                    self.ident(alias);
                    self.word(" = ");
                }
                self.path(path);
            }
            Import::All(path) => {
                self.path(path);
                self.word(".*");
            }
            Import::Some(path, names) => {
                self.path(path);
                self.word(".{");
                self.separated(names, ", ", Self::ident);
                self.word("}");
            }
        }
    }

    /// An `extends` clause.
    fn extends(&mut self, extends: &ExtendsClause) {
        self.word("extends ");
        self.path(&extends.base);
        self.optional_modification(extends.modification.as_ref());
    }

    /// The prefixes that classes and components share, each followed by a blank.
    fn prefixes(&mut self, prefixes: &ElementPrefixes) {
        self.prefix(prefixes.redeclare, "redeclare");
        self.prefix(prefixes.final_, "final");
        self.prefix(prefixes.inner, "inner");
        self.prefix(prefixes.outer, "outer");
        self.prefix(prefixes.replaceable, "replaceable");
    }

    /// `flow`, variability and causality, each followed by a blank.
    /// The order is that of the grammar.
    fn type_prefix(&mut self, prefix: &TypePrefix) {
        self.prefix(prefix.flow, "flow");
        self.prefix(prefix.stream, "stream");
        match prefix.variability {
            Some(VariabilityPrefix::Constant) => self.word("constant "),
            Some(VariabilityPrefix::Parameter) => self.word("parameter "),
            Some(VariabilityPrefix::Discrete) => self.word("discrete "),
            None => {}
        }
        match prefix.causality {
            Some(CausalityPrefix::Input) => self.word("input "),
            Some(CausalityPrefix::Output) => self.word("output "),
            None => {}
        }
    }

    /// A component declaration without its semicolon.
    /// The dimensions stand behind the name, those of the type included.
    pub(super) fn component(&mut self, component: &ComponentDeclaration) {
        self.prefixes(&component.prefixes);
        self.declaration(component);
    }

    /// A component declaration without its element prefixes.
    fn declaration(&mut self, component: &ComponentDeclaration) {
        self.type_prefix(&component.prefix);
        self.path(&component.class);
        self.word(" ");
        self.ident(&component.name);
        self.subscripts(&component.subscripts);
        self.optional_modification(component.modification.as_ref());
        if let Some(condition) = &component.condition {
            self.word(" if ");
            self.expression(condition);
        }
        self.description(component.description.as_deref());
        self.annotation(component.annotation.as_ref());
        self.constraint(component.constraint.as_ref());
    }

    /// The `constrainedby` clause, if there is one.
    fn constraint(&mut self, constraint: Option<&ConstrainingClause>) {
        if let Some(constraint) = constraint {
            self.word(" constrainedby ");
            self.path(&constraint.path);
            self.optional_modification(constraint.modification.as_ref());
        }
    }

    /// A blank and the description in quotation marks. Nothing for `None`.
    pub(super) fn description(&mut self, description: Option<&str>) {
        if let Some(text) = description {
            self.word(" ");
            self.string(text);
        }
    }

    /// A blank and the annotation. Nothing for `None`.
    fn annotation(&mut self, annotation: Option<&Modification>) {
        if let Some(annotation) = annotation {
            self.word(" annotation");
            self.argument_list(&annotation.arguments);
        }
    }

    /// The modification. Nothing for `None`.
    fn optional_modification(&mut self, modification: Option<&Modification>) {
        if let Some(modification) = modification {
            self.modification(modification);
        }
    }

    /// A modification: arguments in brackets, then ` = value`.
    /// A modification that only has a value gets no brackets.
    pub(super) fn modification(&mut self, modification: &Modification) {
        // `break` counts as a value.
        let has_value = modification.value.is_some() || modification.break_value;
        // Without arguments and value the brackets alone show that there is a modification.
        if !modification.arguments.is_empty() || !has_value {
            self.argument_list(&modification.arguments);
        }
        if let Some(value) = &modification.value {
            self.word(" = ");
            self.expression(value);
        } else if modification.break_value {
            self.word(" = break");
        }
    }

    /// The arguments of a modification in brackets.
    fn argument_list(&mut self, arguments: &[ModificationArgument]) {
        self.word("(");
        self.separated(arguments, ", ", Self::argument);
        self.word(")");
    }

    /// One argument of a modification.
    /// Prefixes come first, in the order of [`Self::argument_prefixes`].
    pub(super) fn argument(&mut self, argument: &ModificationArgument) {
        match &argument.kind {
            ModificationArgumentKind::Modify { path, modification, description } => {
                self.argument_prefixes(argument, &ElementPrefixes::default());
                self.path(path);
                self.optional_modification(modification.as_ref());
                self.description(description.as_deref());
            }
            ModificationArgumentKind::Component(component) => {
                self.argument_prefixes(argument, &component.prefixes);
                self.declaration(component);
            }
            ModificationArgumentKind::Class(class) => {
                self.argument_prefixes(argument, &class.prefixes);
                // These prefixes are written before `each` and `final` already.
                let prefixes =
                    ElementPrefixes { redeclare: false, replaceable: false, final_: false, ..class.prefixes };
                self.class(&Class { prefixes, ..Class::clone(class) });
            }
            ModificationArgumentKind::BreakComponent(name) => {
                self.word("break ");
                self.ident(name);
            }
            ModificationArgumentKind::BreakConnect(a, b) => {
                self.word("break connect(");
                self.expression(a);
                self.word(", ");
                self.expression(b);
                self.word(")");
            }
        }
    }

    /// The prefixes of an argument, in the order of the grammar: `redeclare each final replaceable`.
    /// `prefixes` are those of the redeclared element.
    fn argument_prefixes(&mut self, argument: &ModificationArgument, prefixes: &ElementPrefixes) {
        self.prefix(prefixes.redeclare, "redeclare");
        self.prefix(argument.each, "each");
        self.prefix(argument.final_, "final");
        self.prefix(prefixes.replaceable, "replaceable");
    }
}

/// The keywords of a kind of class, with the purity of functions.
fn keywords(kind: ClassKind) -> &'static str {
    match kind {
        ClassKind::Function { operator, purity } => match (purity, operator) {
            (None, false) => "function",
            (None, true) => "operator function",
            (Some(true), false) => "pure function",
            (Some(true), true) => "pure operator function",
            (Some(false), false) => "impure function",
            (Some(false), true) => "impure operator function",
        },
        other => other.word(),
    }
}
