//! Files, and the heads and short forms of classes (Modelica 3.6, appendix A.2.1 and A.2.2).
//! [`crate::parse`] calls [`stored_definition`]; elements and modifications call [`class`] for nested and redeclared
//! classes. The bodies of long classes are in `body`.

use super::modification::ModificationContext;
use super::{ParseAbort, ParseResult, Parser, body, element, is_class_keyword, modification};
use crate::ast::{Class, ClassBody, ClassKind, ElementPrefixes, EnumLiteral, Ident, Path, StoredDefinition};
use crate::diag::Span;
use crate::token::TokenKind;

// Files.

/// The production `stored-definition`: an optional `within` clause and the classes of the file.
/// Reads to the end of the text. Classes that cannot be parsed are left out.
/// Production: `stored-definition = [ "within" [ name ] ";" ] { [ "final" ] class-definition ";" }`.
pub fn stored_definition(p: &mut Parser<'_>) -> StoredDefinition {
    let mut file = StoredDefinition { within: within(p).ok().flatten(), classes: Vec::new() };
    while !p.at(TokenKind::Eof) {
        let before = p.at;
        match top_level_class(p) {
            Ok(class) => file.classes.push(*class),
            Err(ParseAbort) => recover_to_class(p),
        }
        // Recovery may stop at a class keyword that again gives no class: each round must consume a token.
        if p.at == before {
            p.bump();
        }
    }
    file
}

/// The `within` clause. `Ok(None)` without one, and for `within;`, which names the root.
/// A clause that cannot be parsed is skipped up to the first class.
fn within(p: &mut Parser<'_>) -> ParseResult<Option<Path>> {
    if !p.eat(TokenKind::Within) {
        return Ok(None);
    }
    let path = if p.at(TokenKind::Semicolon) { None } else { Some(p.path("the name of a package")?) };
    if p.semicolon().is_err() {
        recover_to_class(p);
    }
    Ok(path)
}

/// A class at the top level of a file, with its semicolon; `final` may stand before it.
///
/// # Errors
/// Another token than a class keyword stands there, or the class has no readable head.
fn top_level_class(p: &mut Parser<'_>) -> ParseResult<Box<Class>> {
    let start = p.span();
    let final_ = p.eat(TokenKind::Final);
    if !is_class_keyword(p.kind()) {
        return Err(p.no_class());
    }
    let mut class = class(p, ElementPrefixes { final_, ..ElementPrefixes::default() })?;
    class.span = class.span.to(start);
    if p.semicolon().is_err() {
        recover_to_class(p);
    }
    Ok(class)
}

/// Skips to the next class. Only classes may stand at the top level of a file.
/// A guessed semicolon before it has no effect on later errors.
fn recover_to_class(p: &mut Parser<'_>) {
    p.guessed = false;
    while !(p.at(TokenKind::Eof) || is_class_keyword(p.kind()) && p.starts_class()) {
        p.bump();
    }
}

// Heads.

/// A class definition from `encapsulated`, `partial` or its keyword on, one nesting level deeper.
/// `prefixes` are those that were read before.
/// Production: `class-definition = [ "encapsulated" ] class-prefixes class-specifier`.
pub(super) fn class(p: &mut Parser<'_>, prefixes: ElementPrefixes) -> ParseResult<Box<Class>> {
    p.nested(|p| class_definition(p, prefixes))
}

/// A class that is an element: a `constrainedby` clause with its own comment may follow.
/// `start` is the place of the first prefix.
/// Production: `( class-definition ) [ constraining-clause description ]` of an element.
pub(super) fn replaceable_class(p: &mut Parser<'_>, start: Span, prefixes: ElementPrefixes) -> ParseResult<Box<Class>> {
    let mut class = class(p, prefixes)?;
    if p.at(TokenKind::Constrainedby) {
        class.constraint = modification::constraint(p)?;
        let (description, annotation) = modification::comment(p)?;
        // The comment after the constraint holds where the class has none of its own.
        class.description = class.description.or(description);
        class.annotation = class.annotation.or(annotation);
    }
    class.span = class.span.to(start);
    Ok(class)
}

/// The head of a class, and its body in the form that follows: long, short, enumeration or derivative.
///
/// # Errors
/// The kind or the name is missing, or a short form cannot be parsed. Long classes always succeed.
fn class_definition(p: &mut Parser<'_>, mut prefixes: ElementPrefixes) -> ParseResult<Box<Class>> {
    let start = p.span();
    prefixes.encapsulated = p.eat(TokenKind::Encapsulated);
    prefixes.partial = p.eat(TokenKind::Partial);
    let (kind, keyword) = class_kind(p)?;
    // `model extends M(...)` changes an inherited class of the same name (Modelica 3.6, section 7.3.1).
    if p.eat(TokenKind::Extends) {
        let name = p.ident("the name of the inherited class")?;
        let modification = modification::optional_class_modification(p, ModificationContext::Extends)?;
        return body::long_class(p, start, kind, prefixes, name, Some(modification));
    }
    let name = class_name(p, keyword)?;
    if p.eat(TokenKind::Equal) {
        return short_class(p, start, kind, prefixes, name);
    }
    body::long_class(p, start, kind, prefixes, name, None)
}

/// The name of a class; `keyword` is named in the message if it is missing.
/// If the next line is a component declaration, its type must not be taken for the name.
/// The sign is a type and a name in a row, on a new line, followed by what may follow a component.
fn class_name(p: &mut Parser<'_>, keyword: &str) -> ParseResult<Ident> {
    let what = format!("the name of the {keyword}");
    let declares = matches!(
        p.peek_kind(2),
        TokenKind::Semicolon
            | TokenKind::Comma
            | TokenKind::Equal
            | TokenKind::LeftParen
            | TokenKind::String
            | TokenKind::If
            | TokenKind::Annotation
    );
    let named_type = p.at(TokenKind::Ident) && p.peek_kind(1) == TokenKind::Ident;
    let is_missing = p.is_on_new_line() && named_type && declares;
    if is_missing { Err(p.unexpected(&what)) } else { p.ident(&what) }
}

/// The kind of a class from its keywords, and the main keyword for messages.
///
/// # Errors
/// Reports keywords that do not go together, such as `expandable model`, and a missing kind.
fn class_kind(p: &mut Parser<'_>) -> ParseResult<(ClassKind, &'static str)> {
    let purity = match p.kind() {
        TokenKind::Pure => Some(true),
        TokenKind::Impure => Some(false),
        _ => None,
    };
    // `pure` and `impure` stand before functions only, `expandable` before connectors, `operator` before records,
    // functions, or alone.
    if purity.is_some() {
        p.bump();
    }
    let expandable = p.eat(TokenKind::Expandable);
    let operator = p.eat(TokenKind::Operator);
    let keyword = p.kind();
    let kind = match keyword {
        TokenKind::Function => ClassKind::Function { operator, purity },
        _ if purity.is_some() => return Err(p.unexpected("`function`")),
        TokenKind::Connector => ClassKind::Connector { expandable },
        _ if expandable => return Err(p.unexpected("`connector`")),
        TokenKind::Record => ClassKind::Record { operator },
        _ if operator => return Ok((ClassKind::Operator, "operator")),
        TokenKind::Class => ClassKind::Class,
        TokenKind::Model => ClassKind::Model,
        TokenKind::Block => ClassKind::Block,
        TokenKind::Type => ClassKind::Type,
        TokenKind::Package => ClassKind::Package,
        _ => return Err(p.unexpected("the kind of a class, such as `model`")),
    };
    p.bump();
    Ok((kind, keyword.spelling().unwrap_or("class")))
}

// The short forms.

/// A class of the form `type A = ...`; the cursor is behind the sign.
/// Production: `short-class-specifier`. The kind and name have been read.
fn short_class(
    p: &mut Parser<'_>,
    start: Span,
    kind: ClassKind,
    prefixes: ElementPrefixes,
    name: Ident,
) -> ParseResult<Box<Class>> {
    let body = match p.kind() {
        TokenKind::Enumeration => enumeration(p)?,
        TokenKind::Der => derivative(p)?,
        _ => short_body(p)?,
    };
    let (description, annotation) = modification::comment(p)?;
    let span = p.since(start);
    Ok(Box::new(Class { name, kind, prefixes, constraint: None, body, description, annotation, span }))
}

/// The base of a short class: `input Real[3](unit = "m")`.
/// Production: `base-prefix type-specifier [ array-subscripts ] [ class-modification ] description`.
fn short_body(p: &mut Parser<'_>) -> ParseResult<ClassBody> {
    let prefix = element::type_prefix(p);
    let base = p.path("the name of a class")?;
    let subscripts = element::optional_subscripts(p)?;
    let modification = modification::optional_class_modification(p, ModificationContext::Elsewhere)?;
    Ok(ClassBody::Short { prefix, base, subscripts, modification })
}

/// `enumeration(a, b "text")`, or `enumeration(:)` for an enumeration whose literals are left open.
/// Production: `"enumeration" "(" ( [ enum-list ] | ":" ) ")"`.
fn enumeration(p: &mut Parser<'_>) -> ParseResult<ClassBody> {
    p.bump();
    let opened = p.expect(TokenKind::LeftParen)?;
    let mut literals = Vec::new();
    let open_ended = p.eat(TokenKind::Colon);
    if !open_ended && !p.at(TokenKind::RightParen) {
        literals.push(literal(p)?);
        while p.eat(TokenKind::Comma) {
            literals.push(literal(p)?);
        }
    }
    p.close(TokenKind::RightParen, opened, "`,` or `)`")?;
    Ok(ClassBody::Enumeration((!open_ended).then_some(literals)))
}

/// A literal of an enumeration. Its annotation is parsed and dropped.
/// Production: `enumeration-literal = IDENT description`.
fn literal(p: &mut Parser<'_>) -> ParseResult<EnumLiteral> {
    let name = p.ident("the name of a literal")?;
    let (description, _) = modification::comment(p)?;
    Ok(EnumLiteral { name, description })
}

/// A partial derivative of a function: `der(f, x, y)` (Modelica 3.6, section 12.7.2). At least one input is required.
/// Production: `"der" "(" type-specifier "," IDENT { "," IDENT } ")"`.
fn derivative(p: &mut Parser<'_>) -> ParseResult<ClassBody> {
    p.bump();
    let opened = p.expect(TokenKind::LeftParen)?;
    let function = p.path("the name of a function")?;
    let mut by = Vec::new();
    while p.eat(TokenKind::Comma) {
        by.push(p.ident("the name of an input")?);
    }
    if by.is_empty() {
        return Err(p.unexpected("`,` and the name of an input"));
    }
    p.close(TokenKind::RightParen, opened, "`,` or `)`")?;
    Ok(ClassBody::Derivative { function, by })
}
