//! Modifications such as `(start = 1, redeclare model M = N) = 3`, annotations and descriptions.
//! Declarations, `extends` clauses, short classes and constraints call these functions.
//! Productions: Modelica 3.6, appendix A.2.5; the rules for merging modifiers (section 7.2) are left to `model`.

use super::{ParseResult, Parser, class, element, expr, is_class_keyword};
use crate::ast::{
    Class, ClassBody, ComponentDeclaration, ConstrainingClause, ElementPrefixes, Expr, ExprKind, Modification,
    ModificationArgument, ModificationArgumentKind,
};
use crate::token::TokenKind;

/// The construct that a modification belongs to, which decides what it may hold.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum ModificationContext {
    /// After `extends B`, where `break` removes inherited elements (Modelica 3.6, section 7.4).
    Extends,
    /// Everywhere else.
    Elsewhere,
}

/// A modification of a component: `(...) = value`, `= value` or `:= value`.
/// `None` if there is neither a bracket nor a value. `==` is reported and read as `=`.
/// Production: `modification = class-modification [ "=" modification-expression ] | "=" modification-expression`.
pub(super) fn modification(p: &mut Parser<'_>) -> ParseResult<Option<Modification>> {
    let with_arguments = p.at(TokenKind::LeftParen);
    let arguments = if with_arguments { class_modification(p, ModificationContext::Elsewhere)? } else { Vec::new() };
    let has_value = match p.kind() {
        TokenKind::Equal | TokenKind::Assign => true,
        TokenKind::EqualEqual => {
            p.slip("expected `=`, found `==`", "expected `=`", "a value is given with a single `=`");
            true
        }
        _ => false,
    };
    if !has_value {
        return Ok(with_arguments.then(|| Modification { arguments, ..Modification::default() }));
    }
    p.bump();
    // `= break` removes a binding that the component would inherit.
    if p.eat(TokenKind::Break) {
        return Ok(Some(Modification { arguments, value: None, break_value: true }));
    }
    Ok(Some(Modification { arguments, value: Some(expr::expression(p)?), break_value: false }))
}

/// The arguments in brackets of a modification; the cursor is on `(`.
///
/// # Errors
/// The first argument that cannot be parsed ends the list.
/// Production: `class-modification = "(" [ argument-list ] ")"`.
pub(super) fn class_modification(
    p: &mut Parser<'_>,
    place: ModificationContext,
) -> ParseResult<Vec<ModificationArgument>> {
    let opened = p.span();
    p.bump();
    let mut arguments = Vec::new();
    if !p.at(TokenKind::RightParen) {
        arguments.push(argument_of_modification(p, place)?);
        while p.eat(TokenKind::Comma) {
            arguments.push(argument_of_modification(p, place)?);
        }
    }
    p.close(TokenKind::RightParen, opened, "`,` or `)`")?;
    Ok(arguments)
}

/// One argument of a modification, at its own nesting depth.
/// Nested modifications therefore reach the limit of nesting earlier than other constructs.
fn argument_of_modification(p: &mut Parser<'_>, place: ModificationContext) -> ParseResult<ModificationArgument> {
    // Counts twice, as it takes more stack than other nesting.
    p.nested(|p| p.nested(|p| bare_argument(p, place)))
}

/// One argument: `break ...`, a redeclaration, or the modification of an element.
/// Production: `argument = element-modification-or-replaceable | element-redeclaration`.
fn bare_argument(p: &mut Parser<'_>, place: ModificationContext) -> ParseResult<ModificationArgument> {
    let start = p.span();
    if p.at(TokenKind::Break) {
        let kind = break_argument(p, place)?;
        return Ok(ModificationArgument { each: false, final_: false, kind, span: p.since(start) });
    }
    let mut redeclare = p.eat(TokenKind::Redeclare);
    let each = p.eat(TokenKind::Each);
    let final_ = p.eat(TokenKind::Final);
    // Read in the wrong order as well; `late_redeclare` has reported it.
    redeclare |= late_redeclare(p);
    let replaceable = p.eat(TokenKind::Replaceable);
    let kind = if redeclare || replaceable {
        redeclaration(p, ElementPrefixes { redeclare, replaceable, ..ElementPrefixes::default() })?
    } else {
        element_modification(p)?
    };
    Ok(ModificationArgument { each, final_, kind, span: p.since(start) })
}

/// Reports `redeclare` after `each` or `final`. True if it stands there; it is then read like one in its place.
/// The word is consumed, and the redeclaration is read as if the order were right.
fn late_redeclare(p: &mut Parser<'_>) -> bool {
    let is_late = p.at(TokenKind::Redeclare);
    if is_late {
        let before = p.word(p.previous());
        let message = format!("`redeclare` stands before `{before}`");
        p.slip(message, "in the wrong order", format!("write `redeclare {before}`"));
        p.bump();
    }
    is_late
}

/// `break name` or `break connect(a, b)`, which removes an element or a connection from a base class.
///
/// # Errors
/// Reports `break` outside an `extends` clause.
fn break_argument(p: &mut Parser<'_>, place: ModificationContext) -> ParseResult<ModificationArgumentKind> {
    if place == ModificationContext::Elsewhere {
        let help = "`break` takes an inherited element out: `extends B(break c)`";
        return Err(p.unexpected_with("a modifier", Some(help)));
    }
    p.bump();
    if !p.at(TokenKind::Connect) {
        return Ok(ModificationArgumentKind::BreakComponent(p.ident("a name or `connect`")?));
    }
    let (a, b) = connect_arguments(p)?;
    Ok(ModificationArgumentKind::BreakConnect(Box::new(a), Box::new(b)))
}

/// The two connectors of `connect(a, b)`; the cursor is on `connect`.
/// Production: `"(" component-reference "," component-reference ")"`.
pub(super) fn connect_arguments(p: &mut Parser<'_>) -> ParseResult<(Expr, Expr)> {
    p.bump();
    let opened = p.expect(TokenKind::LeftParen)?;
    let a = connector(p)?;
    p.expect(TokenKind::Comma)?;
    let b = connector(p)?;
    p.close(TokenKind::RightParen, opened, "`)`")?;
    Ok((a, b))
}

/// One argument of `connect`, which must be a component reference.
/// Whether it names a connector is checked by the crate `model`.
fn connector(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let reference = expr::reference(p, "the name of a connector")?;
    let span = reference.span;
    Ok(Expr { kind: ExprKind::Reference(reference), span })
}

/// `a.b(...) = value "text"`.
///
/// # Errors
/// Reports a subscripted name, which the grammar does not allow here, and a name without anything to change.
/// Production: `element-modification = name [ modification ] description-string`.
fn element_modification(p: &mut Parser<'_>) -> ParseResult<ModificationArgumentKind> {
    let path = p.path("the name of an attribute or element")?;
    if p.at(TokenKind::LeftBracket) {
        let help = "a modifier holds for the whole array: give all values at once, as in `x(start = {1, 2})`";
        return Err(p.unexpected_with("`=` or `(`", Some(help)));
    }
    let modification = modification(p)?;
    // A name with nothing to change is accepted where the argument ends, as `(fixed)` or `(x "text")`.
    let ends = matches!(p.kind(), TokenKind::String | TokenKind::Comma | TokenKind::RightParen);
    if modification.is_none() && !ends {
        return Err(p.unexpected("`=` or `(`"));
    }
    Ok(ModificationArgumentKind::Modify { path, modification, description: description(p) })
}

/// What follows `redeclare` or `replaceable` in a modification: a class or a component.
/// `prefixes` are the words that were read, which the result gets.
fn redeclaration(p: &mut Parser<'_>, prefixes: ElementPrefixes) -> ParseResult<ModificationArgumentKind> {
    if is_class_keyword(p.kind()) {
        return Ok(ModificationArgumentKind::Class(redeclared_class(p, prefixes)?));
    }
    Ok(ModificationArgumentKind::Component(redeclared_component(p, prefixes)?))
}

/// A redeclared class. The grammar allows the short form only; a long one is reported and kept.
/// `prefixes` has `redeclare` and `replaceable` as they were written.
fn redeclared_class(p: &mut Parser<'_>, prefixes: ElementPrefixes) -> ParseResult<Box<Class>> {
    let start = p.token();
    let mut class = class::class(p, prefixes)?;
    if matches!(class.body, ClassBody::Long(_)) {
        let message = "a class is redeclared in a modification in the short form only";
        let help =
            format!("write the class elsewhere and `redeclare {} {} = ...` here", p.word(start), class.name.name);
        p.slip(message, "after this class", help);
    }
    if prefixes.replaceable {
        class.constraint = constraint(p)?;
    }
    Ok(class)
}

/// A redeclared component. It has no condition, and a constraint only if it is replaceable.
/// Production: `component-clause1`: exactly one component.
fn redeclared_component(p: &mut Parser<'_>, prefixes: ElementPrefixes) -> ParseResult<Box<ComponentDeclaration>> {
    let prefix = element::type_prefix(p);
    let class = p.path("a type")?;
    let of_type = element::optional_subscripts(p)?;
    let name = p.ident("the name of the component")?;
    // Dimensions of the name come before those of the type, as in declarations.
    let mut subscripts = element::optional_subscripts(p)?;
    subscripts.extend(of_type);
    let modification = modification(p)?;
    let (description, annotation) = comment(p)?;
    let constraint = if prefixes.replaceable { constraint(p)? } else { None };
    let condition = None;
    Ok(Box::new(ComponentDeclaration {
        name,
        prefixes,
        prefix,
        class,
        subscripts,
        modification,
        condition,
        constraint,
        description,
        annotation,
    }))
}

/// The constraint of a replaceable element, `constrainedby T(...)`. `None` if there is none.
/// Production: `constraining-clause = "constrainedby" type-specifier [ class-modification ]`.
pub(super) fn constraint(p: &mut Parser<'_>) -> ParseResult<Option<ConstrainingClause>> {
    if !p.eat(TokenKind::Constrainedby) {
        return Ok(None);
    }
    let path = p.path("a type")?;
    Ok(Some(ConstrainingClause { path, modification: optional_class_modification(p, ModificationContext::Elsewhere)? }))
}

/// The arguments in brackets where no value may follow. `None` without a bracket.
/// Used for base classes, constraints and annotations, which have no value of their own.
pub(super) fn optional_class_modification(
    p: &mut Parser<'_>,
    place: ModificationContext,
) -> ParseResult<Option<Modification>> {
    if !p.at(TokenKind::LeftParen) {
        return Ok(None);
    }
    let arguments = class_modification(p, place)?;
    Ok(Some(Modification { arguments, ..Modification::default() }))
}

/// A description string: string literals joined by `+`, as one text. `None` if there is none.
/// Production: `description-string = [ STRING { "+" STRING } ]`.
pub(super) fn description(p: &mut Parser<'_>) -> Option<Box<str>> {
    if !p.at(TokenKind::String) {
        return None;
    }
    let mut text = expr::string_value(p);
    p.bump();
    while p.at(TokenKind::Plus) && p.peek_kind(1) == TokenKind::String {
        p.bump();
        text = [text, expr::string_value(p)].concat().into();
        p.bump();
    }
    p.skip_rest_of_string();
    Some(text)
}

/// `annotation(...)`. `None` if there is none.
///
/// # Errors
/// Reports the keyword without a bracket after it.
/// Production: `annotation-clause = "annotation" class-modification`.
pub(super) fn annotation(p: &mut Parser<'_>) -> ParseResult<Option<Modification>> {
    if !p.eat(TokenKind::Annotation) {
        return Ok(None);
    }
    if !p.at(TokenKind::LeftParen) {
        return Err(p.unexpected("`(`"));
    }
    optional_class_modification(p, ModificationContext::Elsewhere)
}

/// The production `comment`: a description and an annotation, each optional.
/// Modelica calls it a description; it has no relation to comments of the lexer.
pub(super) fn comment(p: &mut Parser<'_>) -> ParseResult<(Option<Box<str>>, Option<Modification>)> {
    Ok((description(p), annotation(p)?))
}
