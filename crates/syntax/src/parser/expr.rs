//! Expressions by recursive descent, but for what stands between operators.

use super::{ParseResult, Parser, operator};
use crate::ast::{ComponentReference, Expr, ExprKind, ForIndex, Ident, Path, ReferencePart, Subscript};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

/// Positional and named arguments of a call.
type ArgumentLists = (Vec<Expr>, Vec<(Ident, Expr)>);

/// An expression that is the whole text.
pub fn whole_expression(p: &mut Parser<'_>) -> Option<Expr> {
    let expr = expression(p).ok()?;
    if !p.at(TokenKind::Eof) {
        p.unexpected("an operator or the end");
    }
    Some(expr)
}

/// Any expression, if-expressions and ranges included.
pub(super) fn expression(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let outer = std::mem::take(&mut p.height);
    let result = p.nested(|p| match p.kind() {
        TokenKind::If => if_expression(p),
        _ => range_or_value(p),
    });
    p.height = outer.max(p.height + 1);
    result
}

/// An expression that does not begin with `if`, as on the left of an equation.
pub(super) fn simple_expression(p: &mut Parser<'_>) -> ParseResult<Expr> {
    p.nested(range_or_value)
}

fn range_or_value(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let from = operator::operators(p)?;
    if !p.eat(TokenKind::Colon) {
        return Ok(from);
    }
    let second = operator::operators(p)?;
    let (step, to) =
        if p.eat(TokenKind::Colon) { (Some(Box::new(second)), operator::operators(p)?) } else { (None, second) };
    let span = from.span.to(to.span);
    Ok(Expr { kind: ExprKind::Range { from: Box::new(from), step, to: Box::new(to) }, span })
}

fn if_expression(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let start = p.span();
    let mut branches = Vec::new();
    p.bump();
    loop {
        let condition = expression(p)?;
        expect_then(p)?;
        branches.push((condition, expression(p)?));
        if !p.eat(TokenKind::Elseif) {
            break;
        }
    }
    if !p.eat(TokenKind::Else) {
        let help = "an `if` that gives a value needs an `else` with the other value";
        return Err(p.unexpected_with("`else`", Some(help)));
    }
    let otherwise = Box::new(expression(p)?);
    Ok(Expr { kind: ExprKind::If { branches, otherwise }, span: p.since(start) })
}

fn expect_then(p: &mut Parser<'_>) -> ParseResult<()> {
    if p.eat(TokenKind::Then) {
        return Ok(());
    }
    let help = p.at(TokenKind::Equal).then_some("equality is tested with `==`");
    Err(p.unexpected_with("`then`", help))
}

// Operands of operators.

pub(super) fn primary(p: &mut Parser<'_>) -> ParseResult<Expr> {
    p.height = 0;
    let span = p.span();
    let kind = match p.kind() {
        TokenKind::Ident | TokenKind::Dot => return reference_or_call(p),
        TokenKind::Integer | TokenKind::Real => number(p),
        TokenKind::String => ExprKind::String(string_value(p)),
        TokenKind::True => ExprKind::Boolean(true),
        TokenKind::False => ExprKind::Boolean(false),
        TokenKind::LeftParen => return bracketed(p),
        TokenKind::LeftBrace => return array(p),
        TokenKind::LeftBracket => return matrix(p),
        TokenKind::End if p.subscripts > 0 => ExprKind::End,
        TokenKind::Der | TokenKind::Initial | TokenKind::Pure => return keyword_call(p),
        TokenKind::If => {
            p.slip("an `if` inside an expression needs brackets", "here", "write `(if ... then ... else ...)`");
            return expression(p);
        }
        _ => return Err(p.unexpected("an expression")),
    };
    p.bump();
    if matches!(kind, ExprKind::String(_)) {
        p.skip_rest_of_string();
    }
    Ok(Expr { kind, span })
}

fn number(p: &mut Parser<'_>) -> ExprKind {
    let word = p.word(p.token());
    if p.at(TokenKind::Integer)
        && let Ok(value) = word.parse()
    {
        return ExprKind::Integer(value);
    }
    let value: f64 = word.parse().unwrap_or(f64::INFINITY);
    if value.is_infinite() {
        let message = format!("{} is too large", p.describe(p.token()));
        p.slip(message, "too large", "the largest number is about 1.8e308");
    }
    ExprKind::Real(value)
}

/// The value of the string at the cursor, which stays.
pub(super) fn string_value(p: &mut Parser<'_>) -> Box<str> {
    let token = p.token();
    let word = p.word(token);
    let inner = word.strip_prefix('"').unwrap_or(word);
    let inner = inner.strip_suffix('"').unwrap_or(inner);
    if inner.contains('\\') { unescaped(p, inner, token.start + 1) } else { inner.into() }
}

/// Resolves the escapes of a string that begins at a byte of the text.
fn unescaped(p: &mut Parser<'_>, inner: &str, start: u32) -> Box<str> {
    let mut value = String::with_capacity(inner.len());
    let mut characters = inner.char_indices();
    while let Some((i, c)) = characters.next() {
        if c != '\\' {
            value.push(c);
            continue;
        }
        let escaped = characters.next().map_or('\\', |(_, c)| c);
        value.push(escape_value(escaped).unwrap_or_else(|| {
            unknown_escape(p, escaped, start + i as u32);
            escaped
        }));
    }
    value.into()
}

fn unknown_escape(p: &mut Parser<'_>, escaped: char, start: u32) {
    let span = Span { file: p.file, start, end: start + 1 + escaped.len_utf8() as u32 };
    let diagnostic = Diagnostic::new(Code::Syntax, format!("`\\{escaped}` means nothing in a string"))
        .at(span, "unknown escape")
        .help("a backslash itself is written `\\\\`");
    p.report(diagnostic);
}

/// `(a)`, `(a)[i]` or a list of outputs.
fn bracketed(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let start = p.span();
    let mut items = output_list(p)?;
    let span = p.since(start);
    if items.len() != 1 {
        return Ok(Expr { kind: ExprKind::Tuple(items), span });
    }
    let Some(Some(inner)) = items.pop() else {
        return Err(p.unexpected("an expression"));
    };
    let inner = Expr { span, ..inner };
    if !p.at(TokenKind::LeftBracket) {
        return Ok(inner);
    }
    let indices = subscripts(p)?;
    Ok(Expr { kind: ExprKind::Index(Box::new(inner), indices), span: p.since(start) })
}

/// `(a, , c)`; `()` gives no item.
pub(super) fn output_list(p: &mut Parser<'_>) -> ParseResult<Vec<Option<Expr>>> {
    let opened = p.span();
    p.bump();
    let mut items = Vec::new();
    if p.eat(TokenKind::RightParen) {
        return Ok(items);
    }
    loop {
        let empty = matches!(p.kind(), TokenKind::Comma | TokenKind::RightParen);
        items.push(if empty { None } else { Some(expression(p)?) });
        if !p.eat(TokenKind::Comma) {
            break;
        }
    }
    p.close(TokenKind::RightParen, opened, "an operator or `)`")?;
    Ok(items)
}

/// `{a, b}` or `{a for i in 1:n}`.
fn array(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let opened = p.span();
    p.bump();
    if p.at(TokenKind::RightBrace) {
        let help = "an array without elements is written `fill(0.0, 0)`";
        return Err(p.unexpected_with("an expression", Some(help)));
    }
    let mut items = vec![expression(p)?];
    let kind = if p.at(TokenKind::For) {
        let body = Box::new(items.swap_remove(0));
        ExprKind::Comprehension { function: None, body, iterators: comprehension_iterators(p)? }
    } else {
        while p.eat(TokenKind::Comma) {
            items.push(expression(p)?);
        }
        ExprKind::Array(items)
    };
    p.close(TokenKind::RightBrace, opened, "`,` or `}`")?;
    Ok(Expr { kind, span: p.since(opened) })
}

/// `[a, b; c, d]`.
fn matrix(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let opened = p.span();
    p.bump();
    let mut rows = Vec::new();
    loop {
        rows.push(expressions(p)?);
        if !p.eat(TokenKind::Semicolon) {
            break;
        }
        if p.is_boundary() || looks_like_equation(p) {
            break;
        }
    }
    p.close(TokenKind::RightBracket, opened, "`,`, `;` or `]`")?;
    Ok(Expr { kind: ExprKind::Matrix(rows), span: p.since(opened) })
}

/// A line that begins like an equation: the matrix before it is not closed.
pub(super) fn looks_like_equation(p: &Parser<'_>) -> bool {
    use TokenKind::{Assign, Connect, Equal, For, Ident, If, When};
    let begins = match p.kind() {
        Ident => matches!(p.peek_kind(1), Equal | Assign),
        kind => matches!(kind, Connect | For | If | When),
    };
    begins && p.is_on_new_line()
}

/// Expressions separated by commas, at least one.
pub(super) fn expressions(p: &mut Parser<'_>) -> ParseResult<Vec<Expr>> {
    let mut items = vec![expression(p)?];
    while p.eat(TokenKind::Comma) {
        items.push(expression(p)?);
    }
    Ok(items)
}

// References and calls.

fn reference_or_call(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let reference = reference(p, "an expression")?;
    if p.at(TokenKind::LeftParen) {
        return call(p, reference);
    }
    let span = reference.span;
    Ok(Expr { kind: ExprKind::Reference(reference), span })
}

/// `der(...)`, `initial()`, `pure(...)`.
fn keyword_call(p: &mut Parser<'_>) -> ParseResult<Expr> {
    if p.peek_kind(1) != TokenKind::LeftParen {
        return Err(p.unexpected("an expression"));
    }
    let name = p.ident_of(p.token());
    p.bump();
    let parts = vec![ReferencePart { name, subscripts: Vec::new() }];
    call(p, ComponentReference { global: false, parts, span: name.span })
}

/// `[.] a[i].b`.
pub(super) fn reference(p: &mut Parser<'_>, what: &str) -> ParseResult<ComponentReference> {
    let start = p.span();
    let global = p.eat(TokenKind::Dot);
    let mut parts = vec![reference_part(p, what)?];
    while p.eat(TokenKind::Dot) {
        parts.push(reference_part(p, "a name after `.`")?);
    }
    Ok(ComponentReference { global, parts, span: p.since(start) })
}

fn reference_part(p: &mut Parser<'_>, what: &str) -> ParseResult<ReferencePart> {
    let name = p.ident(what)?;
    let subscripts = if p.at(TokenKind::LeftBracket) { subscripts(p)? } else { Vec::new() };
    Ok(ReferencePart { name, subscripts })
}

/// `[i, :, 1:end]`.
pub(super) fn subscripts(p: &mut Parser<'_>) -> ParseResult<Vec<Subscript>> {
    p.subscripts += 1;
    let result = subscript_list(p);
    p.subscripts -= 1;
    result
}

fn subscript_list(p: &mut Parser<'_>) -> ParseResult<Vec<Subscript>> {
    let opened = p.span();
    p.bump();
    let mut items = Vec::new();
    loop {
        let span = p.span();
        let all = p.eat(TokenKind::Colon);
        items.push(if all { Subscript::All(span) } else { Subscript::Expr(expression(p)?) });
        if !p.eat(TokenKind::Comma) {
            break;
        }
    }
    p.close(TokenKind::RightBracket, opened, "`,` or `]`")?;
    Ok(items)
}

/// The call of a function whose opening bracket is at the cursor.
fn call(p: &mut Parser<'_>, function: ComponentReference) -> ParseResult<Expr> {
    let (start, opened) = (function.span, p.span());
    p.bump();
    let (mut args, named) = arguments(p)?;
    let kind = if p.at(TokenKind::For) && args.len() == 1 && named.is_empty() {
        let body = Box::new(args.swap_remove(0));
        let iterators = comprehension_iterators(p)?;
        ExprKind::Comprehension { function: Some(function), body, iterators }
    } else {
        ExprKind::Call { function, args, named }
    };
    p.close(TokenKind::RightParen, opened, "`,` or `)`")?;
    Ok(Expr { kind, span: p.since(start) })
}

fn arguments(p: &mut Parser<'_>) -> ParseResult<ArgumentLists> {
    let (mut args, mut named) = (Vec::new(), Vec::new());
    if p.at(TokenKind::RightParen) {
        return Ok((args, named));
    }
    loop {
        if at_named(p) {
            named.push(named_argument(p)?);
        } else {
            if !named.is_empty() {
                let help = "arguments without a name come first";
                p.slip("expected a named argument such as `a = 1`", "argument without a name", help);
            }
            args.push(argument(p)?);
        }
        if !p.eat(TokenKind::Comma) {
            return Ok((args, named));
        }
    }
}

fn at_named(p: &Parser<'_>) -> bool {
    p.at(TokenKind::Ident) && p.peek_kind(1) == TokenKind::Equal
}

fn named_argument(p: &mut Parser<'_>) -> ParseResult<(Ident, Expr)> {
    let name = p.ident("the name of an argument")?;
    p.expect(TokenKind::Equal)?;
    Ok((name, argument(p)?))
}

fn argument(p: &mut Parser<'_>) -> ParseResult<Expr> {
    if p.at(TokenKind::Function) { p.nested(partial_application) } else { expression(p) }
}

/// `function f(a = 1)`.
fn partial_application(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let start = p.span();
    p.bump();
    let function: Path = p.path("the name of a function")?;
    let opened = p.expect(TokenKind::LeftParen)?;
    let mut named = Vec::new();
    if !p.at(TokenKind::RightParen) {
        named.push(named_argument(p)?);
        while p.eat(TokenKind::Comma) {
            named.push(named_argument(p)?);
        }
    }
    p.close(TokenKind::RightParen, opened, "`,` or `)`")?;
    Ok(Expr { kind: ExprKind::PartialApplication { function, named }, span: p.since(start) })
}

fn comprehension_iterators(p: &mut Parser<'_>) -> ParseResult<Vec<ForIndex>> {
    p.bump();
    iterators(p)
}

/// `i in 1:n, j`.
pub(super) fn iterators(p: &mut Parser<'_>) -> ParseResult<Vec<ForIndex>> {
    let mut iterators = Vec::new();
    loop {
        let name = p.ident("the name of a loop variable")?;
        if p.at(TokenKind::Equal) {
            p.slip("expected `in`, found `=`", "expected `in`", format!("write `{} in ...`", name.name));
        }
        let has_range = p.eat(TokenKind::In) || p.eat(TokenKind::Equal);
        let range = if has_range { Some(expression(p)?) } else { None };
        iterators.push(ForIndex { name, range });
        if !p.eat(TokenKind::Comma) {
            return Ok(iterators);
        }
    }
}

/// The character that a backslash and a letter stand for.
fn escape_value(escaped: char) -> Option<char> {
    Some(match escaped {
        '\'' | '"' | '?' | '\\' => escaped,
        'a' => '\u{7}',
        'b' => '\u{8}',
        'f' => '\u{c}',
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        'v' => '\u{b}',
        _ => return None,
    })
}
