//! Equations, and the blocks `if`, `for`, `while` and `when` that equations and statements share.
//! Each block function takes the parser of its items, [`equation`] or `statement`.
//!
//! A block always gives a tree: errors in its header do not keep the body from being read, and an `end` that is
//! missing or wrong is reported by [`close_block`]. Productions: Modelica 3.6, appendix A.2.6.

use super::{OpenBlock, OpenBlockKind, ParseAbort, ParseResult, Parser, expr, modification};
use crate::ast::{BinaryOp, Equation, EquationKind, Expr, ExprKind, ForIndex};
use crate::diag::Span;
use crate::token::TokenKind;

/// The branches of a block in order: each condition with the items that it guards.
pub(super) type ConditionalBranches<T> = Vec<(Expr, Vec<T>)>;

/// One equation with its description, without its semicolon. The span covers the equation alone.
/// Production: `some-equation`, with its description.
pub(super) fn equation(p: &mut Parser<'_>) -> ParseResult<Equation> {
    let start = p.span();
    let kind = p.nested(|p| match p.kind() {
        TokenKind::If => if_equation(p),
        TokenKind::For => for_equation(p),
        TokenKind::When => Ok(EquationKind::When(when_block(p, equation)?)),
        TokenKind::Connect => modification::connect_arguments(p).map(|(a, b)| EquationKind::Connect(a, b)),
        _ => plain_equation(p),
    })?;
    let span = p.since(start);
    let (description, _) = modification::comment(p)?;
    Ok(Equation { kind, description, span })
}

/// An if-equation. It may have no `else`.
/// All branches hold equations; how many each must have is a rule of the crate `model`.
fn if_equation(p: &mut Parser<'_>) -> ParseResult<EquationKind> {
    let (branches, otherwise) = if_block(p, equation)?;
    Ok(EquationKind::If { branches, otherwise })
}

/// A for-equation.
/// The iterators may be several, which stand for nested loops.
fn for_equation(p: &mut Parser<'_>) -> ParseResult<EquationKind> {
    let (iterators, body) = for_block(p, equation)?;
    Ok(EquationKind::For { iterators, body })
}

/// `a = b`, or a call such as `assert(...)`.
/// `:=` is reported and read as `=`.
/// Both sides are expressions; neither is assigned.
///
/// # Errors
/// A side cannot be parsed, or no sign stands between them.
fn plain_equation(p: &mut Parser<'_>) -> ParseResult<EquationKind> {
    let left = expr::simple_expression(p)?;
    match p.kind() {
        TokenKind::Equal => p.bump(),
        TokenKind::Assign => {
            let help = "`:=` is for algorithm sections; an equation has `=`";
            p.slip("expected `=`, found `:=`", "expected `=`", help);
            p.bump();
        }
        _ => return equation_without_sign(p, left),
    }
    Ok(EquationKind::Equal(left, expr::expression(p)?))
}

/// An equation in which no `=` follows the left side: a call, or a mistake.
///
/// # Errors
/// Reports the missing `=`, unless the text shows which sign was meant.
fn equation_without_sign(p: &mut Parser<'_>, left: Expr) -> ParseResult<EquationKind> {
    match left.kind {
        ExprKind::Call { .. } => Ok(EquationKind::Call(left)),
        // `==` has joined both sides to one expression; without brackets it was meant as the sign of the equation.
        ExprKind::Binary(BinaryOp::Eq, a, b) if !is_bracketed(left.span, a.span) => {
            blame_comparison(p, a.span, b.span, "=", "`==` compares; an equation has a single `=`");
            Ok(EquationKind::Equal(*a, *b))
        }
        _ => {
            if let Some(arrow) = arrow(p, &left) {
                return Err(blame_arrow(p, arrow, "=", "an equation has `=`"));
            }
            Err(p.unexpected_in_item("`=`", advice_on_equation(p, &left)))
        }
    }
}

/// True if an expression begins before its first operand, which means that brackets enclose it.
/// `whole` is the span of the expression, `first` that of its first operand.
fn is_bracketed(whole: Span, first: Span) -> bool {
    whole.start < first.start
}

/// Reports `==` between two operands where `due` (`=` or `:=`) should stand.
/// `left` and `right` are the places of the operands; the sign is looked for between them.
/// The comparison is then taken for the equation or assignment that was meant.
pub(super) fn blame_comparison(p: &mut Parser<'_>, left: Span, right: Span, due: &str, help: &str) {
    let gap = p.text.get(left.end as usize..right.start as usize).unwrap_or("");
    let offset = gap.find("==").unwrap_or(0) as u32;
    let place = Span { start: left.end + offset, end: left.end + offset + 2, ..left };
    let message = format!("expected `{due}`, found `==`");
    p.slip_at(place, message, &format!("expected `{due}`"), help);
}

/// Advice where a declaration such as `Real x` stands in an equation section.
fn advice_on_equation(p: &Parser<'_>, left: &Expr) -> Option<&'static str> {
    let is_declaration = p.at(TokenKind::Ident) && matches!(left.kind, ExprKind::Reference(_));
    is_declaration.then_some("declarations stand before the keyword `equation`")
}

/// Recognises an assignment arrow, `x <- y`, which parses as a comparison with `-y`. Gives the place of `<-`.
/// `None` if the expression is no such comparison, or blanks separate `<` from `-`.
pub(super) fn arrow(p: &Parser<'_>, expr: &Expr) -> Option<Span> {
    let ExprKind::Binary(BinaryOp::Lt, left, right) = &expr.kind else { return None };
    let gap = p.text.get(left.span.end as usize..right.span.end as usize)?;
    let sign = gap.trim_start();
    let start = left.span.end + (gap.len() - sign.len()) as u32;
    sign.starts_with("<-").then_some(Span { start, end: start + 2, ..left.span })
}

/// Reports an assignment arrow. `due` is the sign to be written, `rule` says in which section it stands.
/// The result is to be returned: both sides have been read as one expression, and the item is given up.
pub(super) fn blame_arrow(p: &mut Parser<'_>, arrow: Span, due: &str, rule: &str) -> ParseAbort {
    let help = format!("`<-` is read as \"less than minus\"; {rule}");
    p.slip_at(arrow, format!("expected `{due}`, found `<-`"), &format!("expected `{due}`"), help)
}

// Blocks. The cursor is on the first keyword of the block.

/// An if-block: `if ... then ... elseif ... else ... end if`.
/// Gives the conditional branches and the items after `else`.
/// `item` parses one equation or statement without its semicolon.
pub(super) fn if_block<T>(
    p: &mut Parser<'_>,
    item: fn(&mut Parser<'_>) -> ParseResult<T>,
) -> ParseResult<(ConditionalBranches<T>, Vec<T>)> {
    open_block(p, OpenBlockKind::If);
    let mut branches = vec![branch(p, item)];
    while p.at(TokenKind::Elseif) || p.at_misspelt(TokenKind::Elseif) {
        check_elseif(p);
        branches.push(branch(p, item));
    }
    let mut otherwise = Vec::new();
    let mut seen_else = false;
    // Branches after `else` are errors, yet are read as branches, so that their items are checked.
    while matches!(p.kind(), TokenKind::Else | TokenKind::Elseif) {
        check_second_else(p, seen_else);
        seen_else = true;
        if p.at(TokenKind::Elseif) {
            branches.push(branch(p, item));
            continue;
        }
        p.bump();
        note_else_if(p);
        otherwise.extend(p.list(item));
    }
    close_block(p, TokenKind::If);
    Ok((branches, otherwise))
}

/// Reports a misspelt `elseif`, such as `elif`.
/// The cursor stays on the word, which the caller reads as `elseif`.
fn check_elseif(p: &mut Parser<'_>) {
    if !p.at(TokenKind::Elseif) {
        let word = p.word(p.token());
        p.slip(format!("expected `elseif`, found `{word}`"), "not a Modelica word", "write `elseif`");
    }
}

/// Reports a branch after `else`.
/// `seen_else` is true if the block had an `else` before.
fn check_second_else(p: &mut Parser<'_>, seen_else: bool) {
    if seen_else {
        let word = p.word(p.token());
        let message = format!("`{word}` after `else`: expected `end if`");
        p.slip(message, "`else` is the last branch", "write this branch before `else`, or `end if` above it");
    }
}

/// Records an `else if` on one line in the open block.
/// It opens a second `if`, and if an `end if` is missing later, the message names this place.
fn note_else_if(p: &mut Parser<'_>) {
    if p.at(TokenKind::If) && !p.is_on_new_line() {
        let span = p.span();
        if let Some(open) = p.open.last_mut() {
            open.else_if = Some(span);
        }
    }
}

/// A when-block: `when ... then ... elsewhen ... end when`.
/// `item` parses one equation or statement without its semicolon.
pub(super) fn when_block<T>(
    p: &mut Parser<'_>,
    item: fn(&mut Parser<'_>) -> ParseResult<T>,
) -> ParseResult<ConditionalBranches<T>> {
    open_block(p, OpenBlockKind::When);
    let mut branches = vec![branch(p, item)];
    while p.at(TokenKind::Elsewhen) {
        branches.push(branch(p, item));
    }
    close_block(p, TokenKind::When);
    Ok(branches)
}

/// A for-loop: `for i in 1:n loop ... end for`. After errors in its header it has no iterators.
/// Gives the iterators, outermost first, and the items of the loop.
pub(super) fn for_block<T>(
    p: &mut Parser<'_>,
    item: fn(&mut Parser<'_>) -> ParseResult<T>,
) -> ParseResult<(Vec<ForIndex>, Vec<T>)> {
    open_block(p, OpenBlockKind::For);
    p.bump();
    let iterators = expr::iterators(p);
    header_end(p, iterators.is_ok(), TokenKind::Loop);
    let body = p.list(item);
    close_block(p, TokenKind::For);
    Ok((iterators.unwrap_or_default(), body))
}

/// A while-loop: `while c loop ... end while`.
/// Only statements have it. Gives the condition and the items of the loop.
pub(super) fn while_block<T>(
    p: &mut Parser<'_>,
    item: fn(&mut Parser<'_>) -> ParseResult<T>,
) -> ParseResult<(Expr, Vec<T>)> {
    open_block(p, OpenBlockKind::While);
    p.bump();
    let condition = condition(p, TokenKind::Loop);
    let body = p.list(item);
    close_block(p, TokenKind::While);
    Ok((condition, body))
}

/// One branch from its keyword on: condition, `then`, and the items up to the next branch or `end`.
/// The keyword, such as `if` or `elsewhen`, is at the cursor and is not checked.
fn branch<T>(p: &mut Parser<'_>, item: fn(&mut Parser<'_>) -> ParseResult<T>) -> (Expr, Vec<T>) {
    p.bump();
    let condition = condition(p, TokenKind::Then);
    (condition, p.list(item))
}

/// A condition and the keyword after it.
/// A condition that cannot be parsed becomes `ExprKind::Error`, so that the body is read nevertheless.
/// `keyword` is `then` or `loop`.
fn condition(p: &mut Parser<'_>, keyword: TokenKind) -> Expr {
    let span = p.span();
    let condition = expr::expression(p);
    header_end(p, condition.is_ok(), keyword);
    condition.unwrap_or(Expr { kind: ExprKind::Error, span })
}

/// The keyword that ends the header of a block, `then` or `loop`.
/// If it is not at the cursor, this is reported (unless the header had an error: `is_fine` is false) and it is
/// searched.
fn header_end(p: &mut Parser<'_>, is_fine: bool, keyword: TokenKind) {
    if p.eat(keyword) {
        return;
    }
    if is_fine {
        let help = p.at(TokenKind::Equal).then_some("equality is tested with `==`");
        let expected = format!("`{}`", keyword.spelling().unwrap_or("then"));
        p.unexpected_with(&expected, help);
    }
    skip_header(p, keyword);
}

/// Skips the rest of a header that was not understood: to one past `keyword`, or else to the end of the line.
/// The parser then continues with the body of the block.
fn skip_header(p: &mut Parser<'_>, keyword: TokenKind) {
    // The header reaches to the first semicolon at most; beyond it a keyword belongs to another block.
    let in_header = p.tokens[p.at..].iter().take_while(|token| token.kind != TokenKind::Semicolon);
    let length = in_header.take(MAX_HEADER).position(|token| token.kind == keyword);
    if let Some(length) = length {
        p.at += length;
        return p.bump();
    }
    while !p.is_on_new_line() && !p.is_list_end() {
        if p.eat(TokenKind::Semicolon) {
            return;
        }
        p.bump();
    }
}

// Ends of blocks.

/// Records the block at the cursor as open.
/// [`close_block`] removes it from the stack.
fn open_block(p: &mut Parser<'_>, kind: OpenBlockKind) {
    p.open.push(OpenBlock { kind, span: p.span(), else_if: None });
}

/// The `end` of the innermost block, such as `end if`. `keyword` is the word that must follow `end`.
/// A missing `end`, and one with another word, are reported.
fn close_block(p: &mut Parser<'_>, keyword: TokenKind) {
    let misspelt = p.eat_misspelt(TokenKind::End);
    let Some(open) = p.open.pop() else { return };
    // A misspelt word such as `endif` was reported and closes the block.
    if misspelt {
        return;
    }
    if !p.at(TokenKind::End) {
        return p.unclosed(open);
    }
    let found = p.peek_kind(1);
    // An `end` that fits a block or class further out stays for that one.
    if found == keyword {
        p.bump();
    } else if closes_something_else(p, found) {
        return p.unclosed(open);
    } else {
        p.wrong_end(open);
        if found != TokenKind::Semicolon {
            p.bump();
        }
    }
    p.bump();
}

/// True if `end` with this word closes another open block, or a class.
/// A name after `end` always closes something else, a class.
fn closes_something_else(p: &Parser<'_>, word: TokenKind) -> bool {
    let is_open = |kind| p.open.iter().any(|open| open.kind == kind);
    match word {
        TokenKind::If => is_open(OpenBlockKind::If),
        TokenKind::For => is_open(OpenBlockKind::For),
        TokenKind::While => is_open(OpenBlockKind::While),
        TokenKind::When => is_open(OpenBlockKind::When),
        TokenKind::Semicolon => false,
        _ => true,
    }
}

/// The number of tokens in which a header is searched for its `then` or `loop`. It bounds the time on damaged texts.
const MAX_HEADER: usize = 1000;
