//! Statements of algorithm sections and functions. The blocks are those of `equation`, with statements in them.
//! `body` and the blocks call [`statement`]. Productions: Modelica 3.6, appendix A.2.6; meaning: section 11.2.

use super::{ParseResult, Parser, equation, expr, modification};
use crate::ast::{BinaryOp, Expr, ExprKind, Statement, StatementKind};
use crate::token::TokenKind;

/// One statement, without its semicolon.
pub(super) fn statement(p: &mut Parser<'_>) -> ParseResult<Statement> {
    let start = p.span();
    let kind = p.nested(statement_kind)?;
    let span = p.since(start);
    // Its description and annotation are parsed for their errors; the tree has no place for them.
    modification::comment(p)?;
    Ok(Statement { kind, span })
}

/// The statement that the current keyword begins, or an assignment or call.
/// The blocks contain statements again.
fn statement_kind(p: &mut Parser<'_>) -> ParseResult<StatementKind> {
    Ok(match p.kind() {
        TokenKind::If => {
            let (branches, otherwise) = equation::if_block(p, statement)?;
            StatementKind::If { branches, otherwise }
        }
        TokenKind::For => {
            let (iterators, body) = equation::for_block(p, statement)?;
            StatementKind::For { iterators, body }
        }
        TokenKind::While => {
            let (condition, body) = equation::while_block(p, statement)?;
            StatementKind::While(condition, body)
        }
        TokenKind::When => StatementKind::When(equation::when_block(p, statement)?),
        TokenKind::Break => {
            p.bump();
            StatementKind::Break
        }
        TokenKind::Return => {
            p.bump();
            StatementKind::Return
        }
        TokenKind::LeftParen => assign_tuple(p)?,
        TokenKind::Connect => {
            let help = "`connect` stands in an `equation` section";
            return Err(p.unexpected_with("a statement", Some(help)));
        }
        _ => assign_or_call(p)?,
    })
}

/// An assignment of several outputs: `(a, , c) := f(x)`. An empty place drops that output.
/// Production: `"(" output-expression-list ")" ":=" component-reference function-call-args`.
fn assign_tuple(p: &mut Parser<'_>) -> ParseResult<StatementKind> {
    let targets = expr::output_list(p)?;
    assignment_sign(p)?;
    let value = expr::expression(p)?;
    // Only a call has several outputs. The statement is kept, and the error is at the value.
    if !matches!(value.kind, ExprKind::Call { .. }) {
        let help = "a list of variables takes the outputs of a function: `(a, b) := f(x)`";
        p.slip_at(value.span, "expected the call of a function", "not a call", help);
    }
    Ok(StatementKind::AssignTuple(targets, value))
}

/// An assignment `a := b`, or a call `f(x)` whose outputs are not used.
/// Production: `component-reference ( ":=" expression | function-call-args )`.
fn assign_or_call(p: &mut Parser<'_>) -> ParseResult<StatementKind> {
    let left = expr::simple_expression(p)?;
    match left.kind {
        ExprKind::Call { .. } if !at_assignment_sign(p) => return Ok(StatementKind::Call(left)),
        // `a == b` has become one expression; if no bracket encloses it, an assignment was meant.
        ExprKind::Binary(BinaryOp::Eq, a, b) if left.span.start == a.span.start => {
            let help = "`==` compares; an assignment has `:=`";
            equation::blame_comparison(p, a.span, b.span, ":=", help);
            return Ok(StatementKind::Assign(*a, *b));
        }
        _ => {}
    }
    check_target(p, &left)?;
    assignment_sign(p)?;
    Ok(StatementKind::Assign(left, expr::expression(p)?))
}

/// Checks that the left side of an assignment is a component reference.
///
/// # Errors
/// Reports an arrow, an expression as target, or a missing `:=`, whichever the text shows.
/// `left` has been parsed as an expression, because a call may stand in its place.
fn check_target(p: &mut Parser<'_>, left: &Expr) -> ParseResult<()> {
    if matches!(left.kind, ExprKind::Reference(_)) {
        return Ok(());
    }
    if let Some(arrow) = equation::arrow(p, left) {
        return Err(equation::blame_arrow(p, arrow, ":=", "an assignment has `:=`"));
    }
    if at_assignment_sign(p) {
        let help = "an assignment has a single variable on its left";
        return Err(p.slip_at(left.span, "expected a variable before the sign of assignment", "not a variable", help));
    }
    Err(p.unexpected_in_item("`:=`", None))
}

/// True at `:=`, or at `=`, which is reported later.
/// A call before such a sign is an invalid target of an assignment.
fn at_assignment_sign(p: &Parser<'_>) -> bool {
    matches!(p.kind(), TokenKind::Assign | TokenKind::Equal)
}

/// The sign `:=`. `=` is reported and accepted.
///
/// # Errors
/// Reports any other token.
fn assignment_sign(p: &mut Parser<'_>) -> ParseResult<()> {
    if p.eat(TokenKind::Assign) {
        return Ok(());
    }
    if p.at(TokenKind::Equal) {
        let help = "`=` is for equation sections; an assignment has `:=`";
        p.slip("expected `:=`, found `=`", "expected `:=`", help);
        p.bump();
        return Ok(());
    }
    Err(p.unexpected_in_item("`:=`", None))
}
