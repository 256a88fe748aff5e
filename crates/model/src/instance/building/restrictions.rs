//! Restrictions on what a class may contain and extend, by its kind (MLS 4.6, 7.1.3, 11).
//!
//! Each class is checked once, when its template is made. The checks read the syntax tree only.
//! Violations are collected first and then reported, so that each check stays a plain function.

use crate::instance::ComponentBuilder;
use crate::instance::lookup::BuiltinType;
use crate::resolve::ClassId;
use bramah_syntax::ast::{
    self, ClassBody, ClassKind, ElementKind, Expr, ExprKind, Import, Modification, ModificationArgument,
    ModificationArgumentKind, Statement, StatementKind, VariabilityPrefix,
};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

/// A rule that is violated.
struct RestrictionViolation {
    /// The message.
    what: String,
    /// The place in the text.
    at: Span,
    /// What the message says at that place.
    label: String,
    /// The section of the language specification.
    rule: &'static str,
}

/// A violation from its parts.
fn breach(what: impl Into<String>, at: Span, label: impl Into<String>, rule: &'static str) -> RestrictionViolation {
    RestrictionViolation { what: what.into(), at, label: label.into(), rule }
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Checks a class for what its kind does not allow. Each class is checked only once.
    ///
    /// Names, sections, elements, statements, imports and duplicate modifiers are checked, in this order.
    /// For a short class only its modifiers are.
    /// What modifiers and redeclarations add is checked elsewhere.
    pub(in crate::instance) fn check_class(&mut self, class: ClassId) {
        // Templates at several places belong to one class: its text is checked once.
        if !self.instance.classes.checked_classes.insert(class) {
            return;
        }
        let ast = self.instance.library.class(class);
        let mut found = Vec::new();
        names(ast, &mut found);
        match &ast.body {
            ClassBody::Long(body) => {
                sections(ast, body, &mut found);
                elements(ast, body, &mut found);
                body.algorithms
                    .iter()
                    .chain(&body.initial_algorithms)
                    .for_each(|s| statements(s, false, false, &mut found));
                imports(body, &mut found);
            }
            ClassBody::Short { modification: Some(m), .. } => duplicates(&m.arguments, &mut found),
            _ => {}
        }
        for b in found {
            self.refuse(b, Some(class));
        }
    }

    /// Reports a violation, unless one was reported at the same place. `class` is named in the message.
    /// The note of the message names the section of the language specification.
    fn refuse(&mut self, b: RestrictionViolation, class: Option<ClassId>) {
        if self
            .instance
            .diagnostics
            .iter()
            .any(|d| d.code == Code::Restricted && d.labels.first().is_some_and(|l| l.span == b.at))
        {
            return;
        }
        let mut d =
            Diagnostic::new(Code::Restricted, b.what).at(b.at, b.label).note(format!("Modelica 3.6, {}", b.rule));
        if let Some(class) = class {
            d = d.class(self.instance.library.full_name(class));
        }
        self.instance.report(d);
    }

    /// Checks that a class may extend a base class of another kind (MLS 7.1.3).
    /// The base must not be replaceable (MLS 7.1.4).
    /// `at` is the name in the `extends` clause.
    pub(in crate::instance) fn check_base(&mut self, class: ClassId, base: ClassId, at: Span) {
        let (derived, base_class) = (self.instance.library.class(class), self.instance.library.class(base));
        // A short class or a redeclaration may have a replaceable base: `redeclare model M = N`.
        if base_class.prefixes.replaceable
            && !base_class.prefixes.redeclare
            && !matches!(derived.body, ClassBody::Short { .. })
        {
            let what = format!("`{}` is replaceable and cannot be a base class", base_class.name.name);
            self.refuse(breach(what, at, "what it holds would not be known", "7.1.4"), Some(class));
        }
        let (of, from) = (derived.kind, base_class.kind);
        if !may_extend(of, from) {
            let what = format!("a {} cannot extend a {}", of.word(), from.word());
            let label = format!("`{}` is a {}", base_class.name.name, from.word());
            self.refuse(breach(what, at, label, "7.1.3"), Some(class));
        }
    }

    /// Checks that only types and connectors extend a predefined type (MLS 7.1.3).
    /// Every class may extend `ExternalObject`.
    pub(in crate::instance) fn check_builtin_base(&mut self, class: ClassId, base: BuiltinType, at: Span) {
        let kind = self.instance.library.class(class).kind;
        // `class` is the general kind and may be based on anything.
        let fine = matches!(kind, ClassKind::Type | ClassKind::Connector { .. } | ClassKind::Class)
            || base == BuiltinType::Object;
        if !fine {
            let name = crate::instance::errors::builtin_name(base);
            let what = format!("a {} cannot extend `{name}`", kind.word());
            self.refuse(breach(what, at, "a predefined type", "7.1.3"), Some(class));
        }
    }

    /// Reports a class with a body that extends an array type (MLS 4.5.2).
    pub(in crate::instance) fn check_array_base(&mut self, class: ClassId, at: Span) {
        let what = "a class of arrays cannot be extended by one with elements";
        self.refuse(breach(what, at, "this class is an array", "4.5.2"), Some(class));
    }

    /// Checks the prefixes of a component against the kind of its class (MLS 4.4.2, 9.1).
    ///
    /// A model or block takes no prefixes such as `flow` or `parameter`. A connector is no parameter or constant.
    /// An operator record with `flow` needs the operators `'+'` and `'0'`, because flows are added (MLS 9.3).
    /// Prefixes of predefined types are not restricted here.
    pub(in crate::instance) fn check_prefixes(
        &mut self,
        declared: &ast::ComponentDeclaration,
        template: &crate::instance::template::Template<'a>,
    ) {
        let p = declared.prefix;
        let at = declared.name.span;
        let name = declared.name.name;
        let words = prefix_word(p);
        match template.kind {
            ClassKind::Model | ClassKind::Block | ClassKind::Class if words.is_some() && template.builtin.is_none() => {
                let word = words.unwrap_or_default();
                let what = format!("`{name}` is a component of a {} and cannot be `{word}`", template.kind.word());
                self.refuse(breach(what, at, "such prefixes belong to types, records and connectors", "4.4.2"), None);
            }
            ClassKind::Connector { .. } if template.builtin.is_none() => {
                if let Some(word @ ("parameter" | "constant")) = words {
                    let what = format!("`{name}` is a connector and cannot be `{word}`");
                    self.refuse(breach(what, at, "a connector changes with what is connected", "9.1"), None);
                }
                self.check_nested_prefixes(declared, template);
            }
            ClassKind::Record { operator: true } if p.flow => {
                // The flows at a node are added, and the flow of an unconnected port is zero.
                let lacks = |o: &&&str| !template.by_name.contains_key(&Symbol::new(o));
                if let Some(operator) = ["'+'", "'0'"].iter().find(lacks) {
                    let what = format!("`{name}` is `flow`, and its class has no operator {operator}");
                    self.refuse(breach(what, at, "flows are added, and begin at zero", "9.3"), None);
                }
            }
            _ => {}
        }
    }

    /// Reports `flow`, or `input` and `output`, both at a connector and at one of its elements (MLS 4.4.2.2).
    /// Only the first such element is reported.
    /// `declared` is the component, `template` its class.
    fn check_nested_prefixes(
        &mut self,
        declared: &ast::ComponentDeclaration,
        template: &crate::instance::template::Template<'a>,
    ) {
        let p = declared.prefix;
        let causal = p.causality.or(template.prefix.causality).is_some();
        for element in &template.elements {
            let crate::instance::template::TemplateElementKind::Component(inner) = element.kind else { continue };
            let flow = p.flow && inner.prefix.flow;
            if flow || causal && inner.prefix.causality.is_some() {
                let word = if flow { "flow" } else { "input` or `output" };
                let what = format!("`{}` is `{word}` inside and outside", declared.name.name);
                let label = format!("`{}` of it has this prefix already", inner.name.name);
                self.refuse(breach(what, declared.name.span, label, "4.4.2.2"), None);
                return;
            }
        }
    }

    /// Checks that a public connector of a block is an input or output, or consists of these (MLS 4.6).
    ///
    /// Parameters and constants in the connector do not count.
    /// Connectors with a prefix of their own, and predefined types, are fine.
    /// A connector that is itself declared with a direction is fine.
    pub(in crate::instance) fn check_block_port(
        &mut self,
        declared: &ast::ComponentDeclaration,
        template: &crate::instance::template::Template<'a>,
    ) {
        let directed = |c: &ast::ComponentDeclaration| {
            c.prefix.causality.is_some()
                || matches!(c.prefix.variability, Some(VariabilityPrefix::Parameter | VariabilityPrefix::Constant))
        };
        let directed_itself = declared.prefix.causality.is_some() || template.prefix.causality.is_some();
        // The members of a bus get their directions from what is connected (MLS 9.1.3).
        if directed_itself || template.builtin.is_some() || template.is_expandable() {
            // Elements with a direction, parameters and constants are fine; the first other one makes the port an
            // error.
            return;
        }
        let open = template.elements.iter().find_map(|e| match e.kind {
            crate::instance::template::TemplateElementKind::Component(c) if is_open(c) && !directed(c) => {
                Some(c.name.name)
            }
            _ => None,
        });
        if let Some(open) = open {
            let what = format!("the connector `{}` of a block is neither input nor output", declared.name.name);
            let label = format!("`{open}` of it has no `input` or `output`");
            self.refuse(breach(what, declared.name.span, label, "4.6"), None);
        }
    }
}

/// Whether an element of a connector is a variable of a predefined type, written by its name.
/// Elements of other types are not checked.
fn is_open(c: &ast::ComponentDeclaration) -> bool {
    c.class.parts.len() == 1 && matches!(c.class.parts[0].name.as_str(), "Real" | "Integer" | "Boolean" | "String")
}

/// Whether a class of one kind may extend one of another kind: the table of MLS 7.1.3.
/// `class` may extend anything and be extended by anything.
/// A model may extend a block or record, a connector a record or type.
fn may_extend(derived: ClassKind, base: ClassKind) -> bool {
    use ClassKind::{Block, Class, Connector, Function, Model, Operator, Package, Record, Type};
    matches!(
        (derived, base),
        (Class, _)
            | (_, Class)
            | (Model, Model | Block | Record { .. })
            | (Block, Block | Record { .. })
            | (Record { .. }, Record { .. })
            | (Type, Type)
            | (Package, Package)
            | (Connector { .. }, Connector { .. } | Record { .. } | Type)
            | (Function { .. }, Function { .. })
            | (Operator, Operator | Package)
    )
}

/// The prefix of a component, for messages. The first of several, in the order of this list.
/// `None` if it has none of these prefixes.
fn prefix_word(p: ast::TypePrefix) -> Option<&'static str> {
    match (p.flow, p.stream, p.variability, p.causality) {
        (true, ..) => Some("flow"),
        (_, true, ..) => Some("stream"),
        (_, _, Some(VariabilityPrefix::Constant), _) => Some("constant"),
        (_, _, Some(VariabilityPrefix::Parameter), _) => Some("parameter"),
        (_, _, Some(VariabilityPrefix::Discrete), _) => Some("discrete"),
        (_, _, _, Some(ast::CausalityPrefix::Input)) => Some("input"),
        (_, _, _, Some(ast::CausalityPrefix::Output)) => Some("output"),
        _ => None,
    }
}

/// Names that are not free: predefined types cannot name classes or components (MLS 4.9), and attributes cannot be
/// literals of enumerations (MLS 4.9.5).
/// Components are checked only in classes with a body.
/// All violations are collected, not only the first one.
fn names(class: &ast::Class, found: &mut Vec<RestrictionViolation>) {
    let taken = |name: Symbol| matches!(name.as_str(), "Real" | "Integer" | "Boolean" | "String");
    if taken(class.name.name) {
        let what = format!("`{}` is a predefined type and cannot name a class", class.name.name);
        found.push(breach(what, class.name.span, "this name is taken", "4.9"));
    }
    if let ClassBody::Enumeration(Some(literals)) = &class.body {
        let attribute =
            |l: &&ast::EnumLiteral| matches!(l.name.name.as_str(), "quantity" | "min" | "max" | "start" | "fixed");
        for l in literals.iter().filter(attribute) {
            let what = format!("`{}` cannot be a literal: it is an attribute of every enumeration", l.name.name);
            found.push(breach(what, l.name.span, "this name is taken", "4.9.5.1"));
        }
    }
    let ClassBody::Long(body) = &class.body else { return };
    for e in &body.elements {
        if let ElementKind::Component(c) = &e.kind
            && taken(c.name.name)
        {
            let what = format!("`{}` is a predefined type and cannot name a component", c.name.name);
            found.push(breach(what, c.name.span, "this name is taken", "4.9"));
        }
    }
}

/// Sections that a kind of class does not have (MLS 4.6), and a second algorithm section of a function (MLS 12.2).
/// Records, connectors and packages have neither equations nor algorithms.
fn sections(class: &ast::Class, body: &ast::LongBody, found: &mut Vec<RestrictionViolation>) {
    let first_equation = body.equations.first().or(body.initial_equations.first()).map(|e| e.span);
    let algorithm = |sections: &[Vec<Statement>]| sections.first().and_then(|s| s.first()).map(|s| s.span);
    let first_statement = algorithm(&body.algorithms).or_else(|| algorithm(&body.initial_algorithms));
    match class.kind {
        ClassKind::Record { .. } | ClassKind::Connector { .. } | ClassKind::Package => {
            if let Some(at) = first_equation.or(first_statement) {
                let what = format!("a {} cannot have equations or algorithms", class.kind.word());
                found.push(breach(what, at, "not allowed here", "4.6"));
            }
        }
        ClassKind::Function { .. } if body.algorithms.len() > 1 => {
            let at = body.algorithms[1].first().map_or(class.name.span, |s| s.span);
            found.push(breach("a function has one algorithm section at most", at, "this is a second one", "12.2"));
        }
        _ => {}
    }
}

/// Elements that a kind of class does not have (MLS 4.6), and uses of `time` where it is not known (MLS 3.6.7).
/// Modifiers of the elements are checked for duplicates as well.
///
/// - An `operator` contains functions only (MLS 14).
/// - Records and connectors have no protected, `inner` or `outer` elements.
/// - `time` may not be used in functions, records, connectors and packages.
///
/// Only the first use of `time` in a function is reported.
fn elements(class: &ast::Class, body: &ast::LongBody, found: &mut Vec<RestrictionViolation>) {
    let kind = class.kind.word();
    let structure = matches!(class.kind, ClassKind::Record { .. } | ClassKind::Connector { .. });
    let timeless = structure || matches!(class.kind, ClassKind::Package);
    for e in &body.elements {
        let modification = match &e.kind {
            ElementKind::Component(c) => {
                if matches!(class.kind, ClassKind::Operator) {
                    found.push(breach("an operator holds functions only", c.name.span, "no function", "14"));
                }
                if structure && e.protected {
                    let what = format!("a {kind} cannot have protected elements");
                    found.push(breach(what, c.name.span, "protected", "4.6"));
                }
                if structure && (c.prefixes.inner || c.prefixes.outer) {
                    let what = format!("a {kind} cannot have `inner` or `outer` elements");
                    found.push(breach(what, c.name.span, "declared here", "4.6"));
                }
                c.modification.as_ref()
            }
            ElementKind::Extends(e) => e.modification.as_ref(),
            _ => None,
        };
        // Only values of declarations are searched for `time` here, not those of nested modifiers.
        let Some(m) = modification else { continue };
        duplicates(&m.arguments, found);
        if timeless && let Some(at) = m.value.as_ref().and_then(time_in) {
            found.push(breach(format!("`time` is not known in a {kind}"), at, "used here", "3.6.7"));
        }
    }
    if matches!(class.kind, ClassKind::Function { .. })
        && let Some(at) = body.algorithms.iter().flatten().find_map(time_in_statement)
    {
        found.push(breach("`time` is not known in a function", at, "give it as an input", "3.6.7"));
    }
}

/// The place where an expression reads `time`. `None` if it does not, or only in a form that is not searched.
/// Subscripts, ranges and comprehensions are not searched.
/// It stops at the first use.
fn time_in(e: &Expr) -> Option<Span> {
    let any = |all: &[&Expr]| all.iter().find_map(|e| time_in(e));
    match &e.kind {
        ExprKind::Reference(r) if r.parts.len() == 1 && r.parts[0].name.name == "time" => Some(e.span),
        ExprKind::Unary(_, a) => time_in(a),
        ExprKind::Binary(_, a, b) => any(&[a, b]),
        ExprKind::Call { args, named, .. } => {
            args.iter().find_map(time_in).or_else(|| named.iter().find_map(|(_, e)| time_in(e)))
        }
        ExprKind::If { branches, otherwise } => {
            branches.iter().find_map(|(c, v)| any(&[c, v])).or_else(|| time_in(otherwise))
        }
        ExprKind::Array(items) => items.iter().find_map(time_in),
        _ => None,
    }
}

/// The place where a statement reads `time`, in values, conditions or nested statements.
/// Targets of assignments and ranges of loops are not searched.
fn time_in_statement(s: &Statement) -> Option<Span> {
    let body = |list: &[Statement]| list.iter().find_map(time_in_statement);
    match &s.kind {
        StatementKind::Assign(_, value) => time_in(value),
        StatementKind::AssignTuple(_, call) | StatementKind::Call(call) => time_in(call),
        StatementKind::If { branches, otherwise } => {
            branches.iter().find_map(|(c, list)| time_in(c).or_else(|| body(list))).or_else(|| body(otherwise))
        }
        StatementKind::For { body: list, .. } => body(list),
        StatementKind::While(c, list) => time_in(c).or_else(|| body(list)),
        _ => None,
    }
}

/// Checks that `break` is inside a loop (MLS 11.2.6), and that no `when` is inside another one (MLS 11.2.7).
/// `in_loop` and `in_when` tell what is around the statements.
/// Nested statements are checked with the surroundings that they have there.
/// Each violation is reported at its own statement.
fn statements(list: &[Statement], in_loop: bool, in_when: bool, found: &mut Vec<RestrictionViolation>) {
    for s in list {
        match &s.kind {
            StatementKind::Break if !in_loop => {
                found.push(breach("`break` stands in no loop", s.span, "nothing to leave here", "11.2.6"));
            }
            StatementKind::If { branches, otherwise } => {
                branches.iter().for_each(|(_, body)| statements(body, in_loop, in_when, found));
                statements(otherwise, in_loop, in_when, found);
            }
            StatementKind::For { body, .. } | StatementKind::While(_, body) => statements(body, true, in_when, found),
            StatementKind::When(branches) => {
                if in_when {
                    found.push(breach("a `when` stands in another one", s.span, "inside", "11.2.7.1"));
                }
                branches.iter().for_each(|(_, body)| statements(body, in_loop, true, found));
            }
            _ => {}
        }
    }
}

/// Checks that no name is imported twice (MLS 13.2.1). Imports of lists and of complete packages are left out.
/// `import A = B.C;` has the name `A`, `import B.C;` the name `C`.
fn imports(body: &ast::LongBody, found: &mut Vec<RestrictionViolation>) {
    let mut known: Vec<Symbol> = Vec::new();
    for e in &body.elements {
        let ElementKind::Import(Import::Single { alias, path }) = &e.kind else { continue };
        let Some(name) = alias.as_ref().or(path.parts.last()) else { continue };
        if known.contains(&name.name) {
            let what = format!("`{}` is imported twice", name.name);
            found.push(breach(what, name.span, "imported again here", "13.2.1"));
        }
        known.push(name.name);
    }
}

/// Checks that a modification gives nothing two values (MLS 7.2): `a.b = 1` and `a(b = 2)` name the same.
/// Redeclarations and modifiers without a value do not count.
fn duplicates(arguments: &[ModificationArgument], found: &mut Vec<RestrictionViolation>) {
    let mut given: Vec<(String, Span)> = Vec::new();
    leaves(arguments, "", &mut given);
    for (k, (name, at)) in given.iter().enumerate() {
        if given[..k].iter().any(|(other, _)| other == name) {
            found.push(breach(format!("`{name}` is given a value twice"), *at, "given again here", "7.2"));
        }
    }
}

/// The full names of everything to which a list of arguments gives a value, with their places.
/// `around` is the name before them, with a dot at its end.
fn leaves(arguments: &[ModificationArgument], around: &str, given: &mut Vec<(String, Span)>) {
    for a in arguments {
        let ModificationArgumentKind::Modify { path, modification: Some(m), .. } = &a.kind else { continue };
        let name = format!("{around}{}", path.dotted());
        let Modification { arguments, value, .. } = m;
        if value.is_some() {
            given.push((name.clone(), a.span));
        }
        leaves(arguments, &format!("{name}."), given);
    }
}
