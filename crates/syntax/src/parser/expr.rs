//! Expressions by recursive descent: if-expressions, ranges, operands, references, calls, subscripts.
//! What stands between operators is left to [`operator`], which calls [`primary`] for each operand.
//!
//! The functions follow the productions `expression`, `simple-expression`, `primary`, `component-reference` and
//! `function-call-args` of Modelica 3.6, appendix A.2.7.

use super::{ParseResult, Parser, operator};
use crate::ast::{ComponentReference, Expr, ExprKind, ForIndex, Ident, Path, ReferencePart, Subscript};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

/// Positional arguments, then named arguments, each in the order of the text.
type ArgumentLists = (Vec<Expr>, Vec<(Ident, Expr)>);

/// Parses a text that is one expression and nothing else.
/// `None` if no expression could be parsed; errors are in the parser.
pub fn whole_expression(p: &mut Parser<'_>) -> Option<Expr> {
    let expr = expression(p).ok()?;
    if !p.at(TokenKind::Eof) {
        p.unexpected("an operator or the end");
    }
    Some(expr)
}

/// The production `expression`: an if-expression, a range, or operands joined by operators.
/// Production: `expression = simple-expression | "if" expression "then" expression { "elseif" .. } "else" expression`.
/// On return the parser's `height` covers the expression and everything that the caller parsed before.
pub(super) fn expression(p: &mut Parser<'_>) -> ParseResult<Expr> {
    // The height of what the caller has parsed so far must survive the inner expression, which starts from zero.
    let outer = std::mem::take(&mut p.height);
    let result = p.nested(|p| match p.kind() {
        TokenKind::If => if_expression(p),
        _ => range_or_value(p),
    });
    p.height = outer.max(p.height + 1);
    result
}

/// The production `simple-expression`: any expression that does not begin with `if`.
/// The left side of an equation must be one, because `if` begins an if-equation there.
/// Production: `simple-expression = logical-expression [ ":" logical-expression [ ":" logical-expression ] ]`.
pub(super) fn simple_expression(p: &mut Parser<'_>) -> ParseResult<Expr> {
    p.nested(range_or_value)
}

/// `a`, `a:b` or `a:step:b`.
/// The span reaches from the first to the last operand. A range cannot be an operand without brackets.
fn range_or_value(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let from = operator::operators(p)?;
    if !p.eat(TokenKind::Colon) {
        return Ok(from);
    }
    // Only after a second colon is it known whether the second value is the step or the end.
    let second = operator::operators(p)?;
    let (step, to) =
        if p.eat(TokenKind::Colon) { (Some(Box::new(second)), operator::operators(p)?) } else { (None, second) };
    let span = from.span.to(to.span);
    Ok(Expr { kind: ExprKind::Range { from: Box::new(from), step, to: Box::new(to) }, span })
}

/// `if c then a elseif d then b else e`. The `else` is required, because the expression must have a value.
/// The cursor is on `if`, and afterwards one past the last operand of the `else` branch.
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

/// The `then` of an if-expression, with advice where `=` was written in a condition.
///
/// # Errors
/// Another token stands there.
fn expect_then(p: &mut Parser<'_>) -> ParseResult<()> {
    if p.eat(TokenKind::Then) {
        return Ok(());
    }
    let help = p.at(TokenKind::Equal).then_some("equality is tested with `==`");
    Err(p.unexpected_with("`then`", help))
}

// Operands of operators.

/// The production `primary`: one operand, which is a literal, reference, call, array, matrix or bracketed expression.
/// Sets the parser's `height` to that of the operand.
///
/// # Errors
/// Reports a token that cannot begin an operand.
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
        // Outside a subscript `end` closes something and is no operand.
        TokenKind::End if p.subscripts > 0 => ExprKind::End,
        TokenKind::Der | TokenKind::Initial | TokenKind::Pure => return keyword_call(p),
        TokenKind::If => {
            // The grammar allows `if` here only in brackets; the expression is read nevertheless to find further
            // errors.
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

/// The number at the cursor, which stays there.
/// An integer beyond 64 bits becomes a Real; a Real that overflows is reported and becomes infinite.
/// Integers without point and exponent are exact up to 64 bits; Modelica leaves the range of Integer to the tool.
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

/// The value of the string at the cursor, without quotation marks and with escapes resolved. The cursor stays.
/// The lexer guarantees that the token ends at its closing quotation mark, or where it guessed the end.
pub(super) fn string_value(p: &mut Parser<'_>) -> Box<str> {
    let token = p.token();
    let word = p.word(token);
    // A string that is not closed has no final mark; the lexer has reported it.
    let inner = word.strip_prefix('"').unwrap_or(word);
    let inner = inner.strip_suffix('"').unwrap_or(inner);
    if inner.contains('\\') { unescaped(p, inner, token.start + 1) } else { inner.into() }
}

/// Resolves the escapes of a string without quotation marks.
/// `start` is the byte of the text at which `inner` begins; messages about unknown escapes need it.
/// An unknown escape is reported and stands for the character itself.
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

/// Reports an escape that the language does not define. `start` is the byte of the backslash.
fn unknown_escape(p: &mut Parser<'_>, escaped: char, start: u32) {
    let span = Span { file: p.file, start, end: start + 1 + escaped.len_utf8() as u32 };
    let diagnostic = Diagnostic::new(Code::Syntax, format!("`\\{escaped}` means nothing in a string"))
        .at(span, "unknown escape")
        .help("a backslash itself is written `\\\\`");
    p.report(diagnostic);
}

/// An opening bracket in an expression: `(a)`, an indexed `(a)[i]`, or a list of outputs `(a, , c)`.
/// One expression in brackets is that expression; none or several, or a missing one, are a tuple.
///
/// # Errors
/// Reports a bracket that is not closed.
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
    // The brackets are not in the tree, but the span keeps them: messages quote the operand with its brackets.
    let inner = Expr { span, ..inner };
    if !p.at(TokenKind::LeftBracket) {
        return Ok(inner);
    }
    let indices = subscripts(p)?;
    Ok(Expr { kind: ExprKind::Index(Box::new(inner), indices), span: p.since(start) })
}

/// Expressions in brackets of which each may be missing: `(a, , c)`. `()` gives an empty list.
/// The cursor is on the opening bracket. Assignments of several outputs use this too, as their left side.
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

/// `{a, b}` or the array comprehension `{a for i in 1:n}`. An empty array is an error (Modelica has no such literal).
/// Production: `"{" array-arguments "}"`.
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

/// A matrix, `[a, b; c, d]`: rows separated by semicolons, columns by commas.
/// Production: `"[" expression-list { ";" expression-list } "]"`.
/// Elements may be arrays, so that rows of different length are left to the crate `model`.
fn matrix(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let opened = p.span();
    p.bump();
    let mut rows = Vec::new();
    loop {
        rows.push(expressions(p)?);
        if !p.eat(TokenKind::Semicolon) {
            break;
        }
        // A missing `]` would otherwise take the next equations for further rows.
        if p.is_boundary() || looks_like_equation(p) {
            break;
        }
    }
    p.close(TokenKind::RightBracket, opened, "`,`, `;` or `]`")?;
    Ok(Expr { kind: ExprKind::Matrix(rows), span: p.since(opened) })
}

/// True at a line that begins like an equation, where an expression should stand.
/// The bracket before it is then taken to be unclosed.
/// Only tokens that cannot continue an expression on a new line count.
pub(super) fn looks_like_equation(p: &Parser<'_>) -> bool {
    use TokenKind::{Assign, Connect, Equal, For, Ident, If, When};
    let begins = match p.kind() {
        Ident => matches!(p.peek_kind(1), Equal | Assign),
        kind => matches!(kind, Connect | For | If | When),
    };
    begins && p.is_on_new_line()
}

/// One or more expressions separated by commas.
pub(super) fn expressions(p: &mut Parser<'_>) -> ParseResult<Vec<Expr>> {
    let mut items = vec![expression(p)?];
    while p.eat(TokenKind::Comma) {
        items.push(expression(p)?);
    }
    Ok(items)
}

// References and calls.

/// A reference such as `a[i].b`, or a call if `(` follows it.
/// Names of functions and of components look alike until the bracket.
fn reference_or_call(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let reference = reference(p, "an expression")?;
    if p.at(TokenKind::LeftParen) {
        return call(p, reference);
    }
    let span = reference.span;
    Ok(Expr { kind: ExprKind::Reference(reference), span })
}

/// A call whose function name is a keyword: `der(...)`, `initial()`, `pure(...)`.
/// These words are reserved, so that they cannot be parsed as names. The cursor is on the word.
///
/// # Errors
/// Reports the word if no bracket follows.
fn keyword_call(p: &mut Parser<'_>) -> ParseResult<Expr> {
    if p.peek_kind(1) != TokenKind::LeftParen {
        return Err(p.unexpected("an expression"));
    }
    let name = p.ident_of(p.token());
    p.bump();
    let parts = vec![ReferencePart { name, subscripts: Vec::new() }];
    call(p, ComponentReference { global: false, parts, span: name.span })
}

/// The production `component-reference`: `[.] a[i].b`. `what` describes it in the message.
/// Production: `component-reference = [ "." ] IDENT [ array-subscripts ] { "." IDENT [ array-subscripts ] }`.
pub(super) fn reference(p: &mut Parser<'_>, what: &str) -> ParseResult<ComponentReference> {
    let start = p.span();
    let global = p.eat(TokenKind::Dot);
    let mut parts = vec![reference_part(p, what)?];
    while p.eat(TokenKind::Dot) {
        parts.push(reference_part(p, "a name after `.`")?);
    }
    Ok(ComponentReference { global, parts, span: p.since(start) })
}

/// A name with optional subscripts.
/// `what` describes the name in the message that it is missing.
fn reference_part(p: &mut Parser<'_>, what: &str) -> ParseResult<ReferencePart> {
    let name = p.ident(what)?;
    let subscripts = if p.at(TokenKind::LeftBracket) { subscripts(p)? } else { Vec::new() };
    Ok(ReferencePart { name, subscripts })
}

/// Subscripts in square brackets: `[i, :, 1:end]`. Inside, `end` is an operand.
/// Production: `array-subscripts = "[" subscript { "," subscript } "]"`, where a subscript is `:` or an expression.
pub(super) fn subscripts(p: &mut Parser<'_>) -> ParseResult<Vec<Subscript>> {
    p.subscripts += 1;
    let result = subscript_list(p);
    p.subscripts -= 1;
    result
}

/// The list of subscripts from `[` to `]`.
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

/// The arguments of a call, whose opening bracket is at the cursor, or a reduction such as `sum(x for x in v)`.
/// `function` is the reference before it; the span of the call includes both.
fn call(p: &mut Parser<'_>, function: ComponentReference) -> ParseResult<Expr> {
    let (start, opened) = (function.span, p.span());
    p.bump();
    let (mut args, named) = arguments(p)?;
    // `for` after a single positional argument makes a reduction (Modelica 3.6, section 10.3.4).
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

/// The arguments of a call up to the closing bracket, which stays.
/// A positional argument after a named one is reported and kept.
/// Production: `function-arguments`, without iterators.
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

/// True at `name =`, which begins a named argument.
/// An `==` after the name is a comparison, which is a positional argument.
fn at_named(p: &Parser<'_>) -> bool {
    p.at(TokenKind::Ident) && p.peek_kind(1) == TokenKind::Equal
}

/// `name = value`.
/// The cursor is on the name.
fn named_argument(p: &mut Parser<'_>) -> ParseResult<(Ident, Expr)> {
    let name = p.ident("the name of an argument")?;
    p.expect(TokenKind::Equal)?;
    Ok((name, argument(p)?))
}

/// The value of an argument: an expression, or a function with some of its inputs given.
/// Production: `function-argument = function-partial-application | expression`.
fn argument(p: &mut Parser<'_>) -> ParseResult<Expr> {
    if p.at(TokenKind::Function) { p.nested(partial_application) } else { expression(p) }
}

/// A function as an argument, with some inputs given: `function f(a = 1)` (Modelica 3.6, section 12.4.2.1).
/// The call that takes the result supplies the remaining inputs. All arguments in the brackets are named.
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

/// The iterators after `for` in a reduction or array comprehension; the cursor is on `for`.
fn comprehension_iterators(p: &mut Parser<'_>) -> ParseResult<Vec<ForIndex>> {
    p.bump();
    iterators(p)
}

/// Iterators of a loop or comprehension, outermost first: `i in 1:n, j`.
/// An iterator without `in` has no range; it is deduced from how the name indexes arrays.
/// Production: `for-indices = for-index { "," for-index }`, with `for-index = IDENT [ "in" expression ]`.
/// `=` is reported and read as `in`.
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

/// The character that an escape sequence stands for. `None` if the language does not define it.
/// Modelica has the escapes of C, except for octal and hexadecimal ones (section 2.4.4).
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
