//! Elements of a class: imports, `extends` clauses, nested classes and components.
//! `body` calls [`element`] for each one. Productions: Modelica 3.6, appendix A.2.3 and A.2.4.
//!
//! Prefixes in the wrong order are reported and accepted, so that the declaration itself is in the tree.

use super::modification::ModificationContext;
use super::{ParseResult, Parser, class, expr, is_class_keyword, modification};
use crate::ast::{
    CausalityPrefix, ComponentDeclaration, ConstrainingClause, Element, ElementKind, ElementPrefixes, ExtendsClause,
    Ident, Import, Modification, Path, Subscript, TypePrefix, VariabilityPrefix,
};
use crate::diag::Span;
use crate::token::TokenKind;

/// What all components of one component clause share: `parameter Real[3] a, b = 1` has two components.
/// Each component gets copies of these parts, so that the tree needs no node for clauses.
struct ComponentClause {
    /// Where the clause begins.
    start: Span,
    /// `final`, `inner`, `replaceable` and so on.
    prefixes: ElementPrefixes,
    /// `flow`, `parameter`, `input` and so on.
    prefix: TypePrefix,
    /// The type.
    class: Path,
    /// Dimensions after the type name.
    subscripts: Vec<Subscript>,
}

/// Parses one element without its semicolon and appends it to `elements`.
/// A component clause gives one element for each component. `protected` is the visibility of the section.
/// Production: `element`. The semicolon after it is left to the caller.
pub(super) fn element(p: &mut Parser<'_>, protected: bool, elements: &mut Vec<Element>) -> ParseResult<()> {
    let start = p.span();
    let kind = match p.kind() {
        TokenKind::Import => ElementKind::Import(import(p)?),
        TokenKind::Extends => ElementKind::Extends(extends(p)?),
        _ => {
            // Classes and components share these prefixes; only what follows them shows which it is.
            let prefixes = prefixes(p);
            if !is_class_keyword(p.kind()) {
                return component_clause(p, start, prefixes, protected, elements);
            }
            ElementKind::Class(class::replaceable_class(p, start, prefixes)?)
        }
    };
    elements.push(Element { protected, kind, span: p.since(start) });
    Ok(())
}

// Imports and extends.

/// An `import` clause. Its comment is parsed and dropped.
/// Production: `import-clause = "import" ( IDENT "=" name | name [ ".*" | "." "{" import-list "}" ] ) description`.
fn import(p: &mut Parser<'_>) -> ParseResult<Import> {
    p.bump();
    if p.at(TokenKind::Ident) && p.peek_kind(1) == TokenKind::Equal {
        let alias = Some(p.ident("a name")?);
        p.bump();
        let import = Import::Single { alias, path: p.path("the name of a class")? };
        modification::comment(p)?;
        return Ok(import);
    }
    let path = p.path("the name of a class or package")?;
    let import = match p.kind() {
        // The lexer reads `.*` as one operator, except where blanks stand between its signs.
        TokenKind::DotStar => {
            p.bump();
            Import::All(path)
        }
        TokenKind::Dot if p.peek_kind(1) == TokenKind::Star => {
            p.bump();
            p.bump();
            Import::All(path)
        }
        TokenKind::Dot if p.peek_kind(1) == TokenKind::LeftBrace => {
            p.bump();
            Import::Some(path, import_list(p)?)
        }
        TokenKind::Dot => {
            p.bump();
            return Err(p.unexpected("a name, `*` or `{`"));
        }
        _ => Import::Single { alias: None, path },
    };
    modification::comment(p)?;
    Ok(import)
}

/// The names in braces of `import A.{b, c}`.
/// The cursor is on the opening brace.
fn import_list(p: &mut Parser<'_>) -> ParseResult<Vec<Ident>> {
    let opened = p.span();
    p.bump();
    let mut names = vec![p.ident("a name")?];
    while p.eat(TokenKind::Comma) {
        names.push(p.ident("a name")?);
    }
    p.close(TokenKind::RightBrace, opened, "`,` or `}`")?;
    Ok(names)
}

/// An `extends` clause. Its annotation is parsed and dropped.
/// Production: `extends-clause = "extends" type-specifier [ class-or-inheritance-modification ] [ annotation-clause ]`.
fn extends(p: &mut Parser<'_>) -> ParseResult<ExtendsClause> {
    p.bump();
    let base = p.path("the name of a class")?;
    let modification = modification::optional_class_modification(p, ModificationContext::Extends)?;
    modification::annotation(p)?;
    Ok(ExtendsClause { base, modification })
}

// Prefixes.

/// The prefixes `redeclare final inner outer replaceable`, which the grammar has in this order.
/// Flags of prefixes that are not written stay false.
fn prefixes(p: &mut Parser<'_>) -> ElementPrefixes {
    let mut prefixes = ElementPrefixes::default();
    // Ranks give the order; equal ranks exclude each other.
    let mut last = 0;
    loop {
        let (rank, flag) = match p.kind() {
            TokenKind::Redeclare => (1, &mut prefixes.redeclare),
            TokenKind::Final => (2, &mut prefixes.final_),
            TokenKind::Inner => (3, &mut prefixes.inner),
            TokenKind::Outer => (4, &mut prefixes.outer),
            TokenKind::Replaceable => (5, &mut prefixes.replaceable),
            _ => return prefixes,
        };
        *flag = true;
        check_order(p, rank, last);
        last = rank;
        p.bump();
    }
}

/// The type prefixes: `flow` or `stream`, then variability, then causality. The grammar has them in this order.
/// Production: `type-prefix`. Of several prefixes of one rank the last one counts.
pub(super) fn type_prefix(p: &mut Parser<'_>) -> TypePrefix {
    let mut prefix = TypePrefix::default();
    let mut last = 0;
    loop {
        let rank = match p.kind() {
            TokenKind::Flow | TokenKind::Stream => 1,
            TokenKind::Discrete | TokenKind::Parameter | TokenKind::Constant => 2,
            TokenKind::Input | TokenKind::Output => 3,
            _ => return prefix,
        };
        set_prefix(&mut prefix, p.kind());
        check_order(p, rank, last);
        last = rank;
        p.bump();
    }
}

/// Reports a prefix whose rank is not above that of the one before it.
/// `rank` belongs to the prefix at the cursor, `last` to the one before it. The first prefix has `last` 0.
fn check_order(p: &mut Parser<'_>, rank: u8, last: u8) {
    if rank > last {
        return;
    }
    let (word, before) = (p.word(p.token()), p.word(p.previous()));
    if rank == last {
        let message = format!("`{word}` cannot follow `{before}`");
        p.slip(message, "only one of them", format!("leave out `{word}` or `{before}`"));
    } else {
        let message = format!("`{word}` stands before `{before}`");
        p.slip(message, "in the wrong order", format!("write `{word} {before}`"));
    }
}

// Components.

/// The components of one clause, appended to `elements`; the cursor is behind the prefixes.
/// The first element's span begins with the clause, those of the others with their names.
/// Production: `component-clause = type-prefix type-specifier [ array-subscripts ] component-list`.
fn component_clause(
    p: &mut Parser<'_>,
    start: Span,
    prefixes: ElementPrefixes,
    protected: bool,
    elements: &mut Vec<Element>,
) -> ParseResult<()> {
    let prefix = type_prefix(p);
    check_late_prefix(p);
    let class = p.path("a type or a keyword such as `parameter`, `model`, `equation`")?;
    let subscripts = optional_subscripts(p)?;
    let clause = ComponentClause { start, prefixes, prefix, class, subscripts };
    let first = elements.len();
    loop {
        let start = if elements.len() == first { clause.start } else { p.span() };
        let component = component(p, &clause)?;
        let kind = ElementKind::Component(Box::new(component));
        elements.push(Element { protected, kind, span: p.since(start) });
        if !p.eat(TokenKind::Comma) {
            break;
        }
    }
    // The constraint of a replaceable component stands behind all of them, and may bring a description.
    if let Some(constraint) = modification::constraint(p)? {
        let (description, annotation) = modification::comment(p)?;
        constrain(&mut elements[first..], &constraint, description.as_deref(), annotation.as_ref());
    }
    Ok(())
}

/// Reports prefixes after the type prefixes, as in `parameter final Real`, and skips them.
/// They are not applied: the message asks for the right order.
fn check_late_prefix(p: &mut Parser<'_>) {
    use TokenKind::{Final, Inner, Outer, Redeclare, Replaceable};
    while matches!(p.kind(), Final | Inner | Outer | Redeclare | Replaceable) {
        let (word, before) = (p.word(p.token()), p.word(p.previous()));
        let message = format!("`{word}` stands before `{before}`");
        p.slip(message, "in the wrong order", format!("write `{word} {before}`"));
        p.bump();
    }
}

/// One component of a clause: name, dimensions, modification, condition and comment.
/// Production: `component-declaration = declaration [ "if" expression ] description`.
fn component(p: &mut Parser<'_>, clause: &ComponentClause) -> ParseResult<ComponentDeclaration> {
    let name = component_name(p)?;
    let mut subscripts = optional_subscripts(p)?;
    // `Real[3] x[2]` has dimensions `[2, 3]`: those of the name come first (Modelica 3.6, section 10.1).
    subscripts.extend(clause.subscripts.iter().cloned());
    let modification = modification::modification(p)?;
    let condition = if p.eat(TokenKind::If) { Some(expr::expression(p)?) } else { None };
    let (description, annotation) = modification::comment(p)?;
    Ok(ComponentDeclaration {
        name,
        prefixes: clause.prefixes,
        prefix: clause.prefix,
        class: clause.class.clone(),
        subscripts,
        modification,
        condition,
        constraint: None,
        description,
        annotation,
    })
}

/// The name of a component.
///
/// # Errors
/// A sign of an equation in its place gets advice: the keyword `equation` is then probably missing.
/// The message differs if the text looks like an equation without its section keyword.
fn component_name(p: &mut Parser<'_>) -> ParseResult<Ident> {
    if matches!(p.kind(), TokenKind::Equal | TokenKind::LeftParen | TokenKind::Dot) {
        let help = "equations stand after the keyword `equation`";
        return Err(p.unexpected_in_item("the name of a component", Some(help)));
    }
    if p.at(TokenKind::Semicolon) {
        return Err(p.unexpected_in_item("the name of a component", None));
    }
    p.ident("the name of a component")
}

/// Dimensions in square brackets such as `[3, :]`. Empty if there are none.
/// The cursor need not be on a bracket.
pub(super) fn optional_subscripts(p: &mut Parser<'_>) -> ParseResult<Vec<Subscript>> {
    if p.at(TokenKind::LeftBracket) { expr::subscripts(p) } else { Ok(Vec::new()) }
}

/// Sets the flag or value of a type prefix that a keyword stands for.
fn set_prefix(prefix: &mut TypePrefix, kind: TokenKind) {
    match kind {
        TokenKind::Flow => prefix.flow = true,
        TokenKind::Stream => prefix.stream = true,
        TokenKind::Discrete => prefix.variability = Some(VariabilityPrefix::Discrete),
        TokenKind::Parameter => prefix.variability = Some(VariabilityPrefix::Parameter),
        TokenKind::Constant => prefix.variability = Some(VariabilityPrefix::Constant),
        TokenKind::Input => prefix.causality = Some(CausalityPrefix::Input),
        TokenKind::Output => prefix.causality = Some(CausalityPrefix::Output),
        _ => {}
    }
}

/// Gives all components of a clause the constraint.
/// The description and annotation after it go to components without their own.
/// The constraint is cloned for each component, as the tree has no node for clauses.
fn constrain(
    elements: &mut [Element],
    constraint: &ConstrainingClause,
    description: Option<&str>,
    annotation: Option<&Modification>,
) {
    for element in elements {
        if let ElementKind::Component(component) = &mut element.kind {
            component.constraint = Some(constraint.clone());
            if component.description.is_none() {
                component.description = description.map(Into::into);
            }
            if component.annotation.is_none() {
                component.annotation = annotation.cloned();
            }
        }
    }
}
