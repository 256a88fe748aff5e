//! Operands joined by operators, by their binding strength.
//!
//! Operators wait on a stack of the parser's own instead of the call stack, which deep brackets would exhaust.

use super::report::shortened;
use super::{MAX_HEIGHT, ParseAbort, ParseResult, Parser, expr};
use crate::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use crate::diag::Span;
use crate::token::TokenKind;

// Binding strength. Relations and powers do not chain; a sign stands only before a whole sum.
const OR: u8 = 1;
const AND: u8 = 2;
const NOT: u8 = 3;
const RELATION: u8 = 4;
const SUM: u8 = 5;
const PRODUCT: u8 = 6;
const POWER: u8 = 7;

/// An operator whose right operand is not complete.
#[derive(Clone, Copy)]
pub(super) enum PendingOperator {
    Prefix {
        op: UnaryOp,
        sign: Span,
        /// The operator directly before, if it binds too strongly for this one to follow.
        after: Option<Span>,
    },
    Infix(BinaryOp, u8),
}

/// An operand with the height of its tree.
pub(super) type ParserOperand = (Expr, u32);

/// Operands and operators as far as they go.
pub(super) fn operators(p: &mut Parser<'_>) -> ParseResult<Expr> {
    let (pending, operands) = (p.pending.len(), p.operands.len());
    let result = operators_above(p, pending);
    if result.is_err() {
        p.pending.truncate(pending);
        p.operands.truncate(operands);
    }
    result
}

fn operators_above(p: &mut Parser<'_>, base: usize) -> ParseResult<Expr> {
    loop {
        prefixes_of_operand(p, base);
        let operand = expr::primary(p)?;
        p.operands.push((operand, p.height));
        let Some((op, strength)) = infix(p.kind()) else { break };
        check_foreign(p);
        reduce(p, base, strength)?;
        p.pending.push(PendingOperator::Infix(op, strength));
        p.bump();
    }
    reduce(p, base, 0)?;
    let (expr, height) = p.operands.pop().ok_or(ParseAbort)?;
    p.height = height;
    Ok(expr)
}

fn prefixes_of_operand(p: &mut Parser<'_>, base: usize) {
    while let Some(op) = prefix(p.kind()) {
        if p.at(TokenKind::Bang) {
            p.slip("expected `not`, found `!`", "not a Modelica operator", "write `not`");
        }
        let limit = if op == UnaryOp::Not { NOT } else { SUM };
        let least = p.pending[base..].last().map_or(OR, PendingOperator::least);
        let after = (least > limit).then(|| p.span_of(p.previous()));
        p.pending.push(PendingOperator::Prefix { op, sign: p.span(), after });
        p.bump();
    }
}

/// Completes the waiting operators that bind at least as strongly as the one that comes.
fn reduce(p: &mut Parser<'_>, base: usize, strength: u8) -> ParseResult<()> {
    while p.pending.len() > base
        && let Some(&top) = p.pending.last()
        && top.strength() >= strength
    {
        p.pending.pop();
        match top {
            PendingOperator::Prefix { op, sign, after } => complete_prefix(p, op, sign, after)?,
            PendingOperator::Infix(op, own) => {
                if own == strength && matches!(own, RELATION | POWER) {
                    blame_chain(p);
                }
                complete_infix(p, op)?;
            }
        }
    }
    Ok(())
}

fn complete_prefix(p: &mut Parser<'_>, op: UnaryOp, sign: Span, after: Option<Span>) -> ParseResult<()> {
    let (operand, height) = p.operands.pop().ok_or(ParseAbort)?;
    if let Some(after) = after {
        blame_prefix(p, after, sign, operand.span);
    }
    let span = sign.to(operand.span);
    push_operand(p, ExprKind::Unary(op, Box::new(operand)), span, height)
}

fn complete_infix(p: &mut Parser<'_>, op: BinaryOp) -> ParseResult<()> {
    let (right, right_height) = p.operands.pop().ok_or(ParseAbort)?;
    let (left, left_height) = p.operands.pop().ok_or(ParseAbort)?;
    let span = left.span.to(right.span);
    let kind = ExprKind::Binary(op, Box::new(left), Box::new(right));
    push_operand(p, kind, span, left_height.max(right_height))
}

fn push_operand(p: &mut Parser<'_>, kind: ExprKind, span: Span, height: u32) -> ParseResult<()> {
    if height >= MAX_HEIGHT {
        return Err(p.too_deep(&format!("an expression with more than {MAX_HEIGHT} operators in a row")));
    }
    p.operands.push((Expr { kind, span }, height + 1));
    Ok(())
}

// Slips.

/// Reports an operator of other languages.
fn check_foreign(p: &mut Parser<'_>) {
    let right = match p.kind() {
        TokenKind::AndAnd => "and",
        TokenKind::OrOr => "or",
        TokenKind::BangEqual => "<>",
        TokenKind::StarStar => "^",
        _ => return,
    };
    let message = format!("expected `{right}`, found `{}`", p.word(p.token()));
    p.slip(message, "not a Modelica operator", format!("write `{right}`"));
}

/// Reports a second operator of a kind that does not chain.
fn blame_chain(p: &mut Parser<'_>) {
    let word = p.word(p.token());
    if matches!(p.kind(), TokenKind::Caret | TokenKind::DotCaret | TokenKind::StarStar) {
        let help = "write `(a^b)^c` or `a^(b^c)`";
        p.slip(format!("a second `{word}` needs brackets"), "no order is defined here", help);
    } else {
        let help = "join two comparisons by `and`: `a < b and b < c`";
        p.slip(format!("a comparison cannot be compared by `{word}`"), "second comparison", help);
    }
}

/// Reports a sign or `not` directly after an operator that binds more strongly.
fn blame_prefix(p: &mut Parser<'_>, before: Span, sign: Span, operand: Span) {
    let words = |from: Span, to: Span| p.text.get(from.start as usize..to.end as usize).unwrap_or("");
    let (before, sign_word) = (words(before, before), words(sign, sign));
    let message = format!("`{sign_word}` directly after `{before}` needs brackets");
    let help = format!("write `{before} ({})`", shortened(words(sign, operand)));
    p.slip_at(sign, message, "brackets are needed here", help);
}

impl PendingOperator {
    /// An operator that comes must bind more strongly to take the operand from this one.
    fn strength(&self) -> u8 {
        match self {
            PendingOperator::Prefix { op: UnaryOp::Not, .. } => NOT,
            PendingOperator::Prefix { .. } => SUM,
            PendingOperator::Infix(_, strength) => *strength,
        }
    }

    /// The least strength of what may follow.
    fn least(&self) -> u8 {
        match self {
            PendingOperator::Prefix { op: UnaryOp::Not, .. } => RELATION,
            PendingOperator::Prefix { .. } => PRODUCT,
            PendingOperator::Infix(_, strength) => strength + 1,
        }
    }
}

fn prefix(kind: TokenKind) -> Option<UnaryOp> {
    Some(match kind {
        TokenKind::Plus => UnaryOp::Plus,
        TokenKind::Minus => UnaryOp::Minus,
        TokenKind::DotPlus => UnaryOp::ElementPlus,
        TokenKind::DotMinus => UnaryOp::ElementMinus,
        TokenKind::Not | TokenKind::Bang => UnaryOp::Not,
        _ => return None,
    })
}

fn infix(kind: TokenKind) -> Option<(BinaryOp, u8)> {
    Some(match kind {
        TokenKind::Or | TokenKind::OrOr => (BinaryOp::Or, OR),
        TokenKind::And | TokenKind::AndAnd => (BinaryOp::And, AND),
        TokenKind::Less => (BinaryOp::Lt, RELATION),
        TokenKind::LessEqual => (BinaryOp::Le, RELATION),
        TokenKind::Greater => (BinaryOp::Gt, RELATION),
        TokenKind::GreaterEqual => (BinaryOp::Ge, RELATION),
        TokenKind::EqualEqual => (BinaryOp::Eq, RELATION),
        TokenKind::NotEqual | TokenKind::BangEqual => (BinaryOp::Ne, RELATION),
        TokenKind::Plus => (BinaryOp::Add, SUM),
        TokenKind::Minus => (BinaryOp::Sub, SUM),
        TokenKind::DotPlus => (BinaryOp::ElementAdd, SUM),
        TokenKind::DotMinus => (BinaryOp::ElementSub, SUM),
        TokenKind::Star => (BinaryOp::Mul, PRODUCT),
        TokenKind::Slash => (BinaryOp::Div, PRODUCT),
        TokenKind::DotStar => (BinaryOp::ElementMul, PRODUCT),
        TokenKind::DotSlash => (BinaryOp::ElementDiv, PRODUCT),
        TokenKind::Caret | TokenKind::StarStar => (BinaryOp::Pow, POWER),
        TokenKind::DotCaret => (BinaryOp::ElementPow, POWER),
        _ => return None,
    })
}
