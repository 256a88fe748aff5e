//! What a class may hold and extend by its kind, and what may stand where in it (MLS 4.6, 7.1.3, 11): read off the text of
//! each class once, when it is first used.

use crate::instance::ComponentBuilder;
use crate::instance::lookup::BuiltinType;
use crate::resolve::ClassId;
use bramah_syntax::ast::{
    self, ClassBody, ClassKind, ElementKind, Expr, ExprKind, Import, Modification, ModificationArgument,
    ModificationArgumentKind, Statement, StatementKind, VariabilityPrefix,
};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

/// A rule that does not hold: what, where, why, and its place in the language specification.
struct RestrictionViolation {
    what: String,
    at: Span,
    label: String,
    rule: &'static str,
}

fn breach(what: impl Into<String>, at: Span, label: impl Into<String>, rule: &'static str) -> RestrictionViolation {
    RestrictionViolation { what: what.into(), at, label: label.into(), rule }
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Refuses what the kind of a class does not allow in it.
    pub(in crate::instance) fn check_class(&mut self, class: ClassId) {
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

    /// A class of one kind may extend only some others (MLS 7.1.3).
    pub(in crate::instance) fn check_base(&mut self, class: ClassId, base: ClassId, at: Span) {
        let (derived, base_class) = (self.instance.library.class(class), self.instance.library.class(base));
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

    /// Only types and connectors extend a predefined type.
    pub(in crate::instance) fn check_builtin_base(&mut self, class: ClassId, base: BuiltinType, at: Span) {
        let kind = self.instance.library.class(class).kind;
        let fine = matches!(kind, ClassKind::Type | ClassKind::Connector { .. } | ClassKind::Class)
            || base == BuiltinType::Object;
        if !fine {
            let name = crate::instance::errors::builtin_name(base);
            let what = format!("a {} cannot extend `{name}`", kind.word());
            self.refuse(breach(what, at, "a predefined type", "7.1.3"), Some(class));
        }
    }

    /// A class with more than the base of an array of components in it.
    pub(in crate::instance) fn check_array_base(&mut self, class: ClassId, at: Span) {
        let what = "a class of arrays cannot be extended by one with elements";
        self.refuse(breach(what, at, "this class is an array", "4.5.2"), Some(class));
    }

    /// Prefixes of a component whose class is a model or block, or of a connector (MLS 4.4.2, 4.4.4).
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
                // flows of a node are summed up, and an open one is zero
                let lacks = |o: &&&str| !template.by_name.contains_key(&Symbol::new(o));
                if let Some(operator) = ["'+'", "'0'"].iter().find(lacks) {
                    let what = format!("`{name}` is `flow`, and its class has no operator {operator}");
                    self.refuse(breach(what, at, "flows are added, and begin at zero", "9.3"), None);
                }
            }
            _ => {}
        }
    }

    /// `flow`, `input` and `output` of a structure may not meet the same inside it (MLS 4.4.2.2).
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

    /// A block has inputs and outputs only (MLS 4.6).
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
        // what joins a bus gives its members their directions (MLS 9.1.3)
        if directed_itself || template.builtin.is_some() || template.is_expandable() {
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

/// Whether a member of a connector is a plain variable.
fn is_open(c: &ast::ComponentDeclaration) -> bool {
    c.class.parts.len() == 1 && matches!(c.class.parts[0].name.as_str(), "Real" | "Integer" | "Boolean" | "String")
}

/// The table of MLS 7.1.3, in which a `class` is free to be anything.
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

/// Names of predefined types are taken (MLS 4.9), those of attributes are no literals (MLS 4.9.5).
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

/// Sections that a kind of class does not have (MLS 4.6).
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

/// Elements that a kind of class does not have (MLS 4.6), and `time` where nothing runs.
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

/// Where an expression reads `time`.
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

/// `break` leaves a loop (MLS 11.2.6), and a `when` stands in no other (MLS 11.2.7).
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

/// One name is imported once (MLS 13.2.1).
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

/// No two arguments of a modification give the same thing a value (MLS 7.2).
fn duplicates(arguments: &[ModificationArgument], found: &mut Vec<RestrictionViolation>) {
    let mut given: Vec<(String, Span)> = Vec::new();
    leaves(arguments, "", &mut given);
    for (k, (name, at)) in given.iter().enumerate() {
        if given[..k].iter().any(|(other, _)| other == name) {
            found.push(breach(format!("`{name}` is given a value twice"), *at, "given again here", "7.2"));
        }
    }
}

/// The full names of all that an argument list gives values.
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
