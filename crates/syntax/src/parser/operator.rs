//! Operands joined by operators, parsed by operator precedence with explicit stacks (shunting-yard).
//! The precedences are those of Modelica 3.6, section 3.2.
//!
//! Operators and operands wait on stacks of the parser instead of the call stack, which deep brackets would exhaust.
//! Nested expressions share the stacks; each works above the height at which it began.

use super::report::shortened;
use super::{MAX_HEIGHT, ParseAbort, ParseResult, Parser, expr};
use crate::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use crate::diag::Span;
use crate::token::TokenKind;

// Precedence, weakest first. Relations and powers are not associative; a sign applies to the first term of a sum.
const OR: u8 = 1;
const AND: u8 = 2;
const NOT: u8 = 3;
const RELATION: u8 = 4;
const SUM: u8 = 5;
const PRODUCT: u8 = 6;
const POWER: u8 = 7;

/// An operator whose right operand is not complete yet.
#[derive(Clone, Copy)]
pub(super) enum PendingOperator {
    /// A sign or `not` before its operand.
    Prefix {
        /// Which operator it is.
        op: UnaryOp,
        /// Its place.
        sign: Span,
        /// The operator directly before, if the grammar does not allow this prefix to follow it: the `*` of `a * -b`.
        after: Option<Span>,
    },
    /// An operator between two operands, with its precedence.
    Infix(BinaryOp, u8),
}

/// An operand, and the height of its tree in operators and nested expressions.
pub(super) type ParserOperand = (Expr, u32);

/// Parses operands joined by operators, up to the first token that is no operator.
pub(super) fn operators(p: &mut Parser<'_>) -> ParseResult<Expr> {
    // An abandoned expression must leave the stacks as it found them: the enclosing one uses them too.
    let (pending, operands) = (p.pending.len(), p.operands.len());
    let result = operators_above(p, pending);
    if result.is_err() {
        p.pending.truncate(pending);
        p.operands.truncate(operands);
    }
    result
}

/// The loop of the algorithm: prefixes, an operand, and an operator, until none follows.
/// `base` is the height of the operator stack below which other expressions wait.
///
/// # Errors
/// An operand cannot be parsed, or the tree becomes too high.
fn operators_above(p: &mut Parser<'_>, base: usize) -> ParseResult<Expr> {
    loop {
        prefixes_of_operand(p, base);
        let operand = expr::primary(p)?;
        p.operands.push((operand, p.height));
        // What waits and binds at least as strongly is complete before the new operator is pushed.
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

/// Pushes the signs and `not` before an operand.
/// Several may stand in a row before one operand, such as `not -a`.
fn prefixes_of_operand(p: &mut Parser<'_>, base: usize) {
    while let Some(op) = prefix(p.kind()) {
        if p.at(TokenKind::Bang) {
            p.slip("expected `not`, found `!`", "not a Modelica operator", "write `not`");
        }
        // In the grammar a sign stands at the level of sums and `not` at that of logical factors.
        let limit = if op == UnaryOp::Not { NOT } else { SUM };
        // The message needs the operand too, so that it is only noted here and reported when the operand is complete.
        let least = p.pending[base..].last().map_or(OR, PendingOperator::least);
        let after = (least > limit).then(|| p.span_of(p.previous()));
        p.pending.push(PendingOperator::Prefix { op, sign: p.span(), after });
        p.bump();
    }
}

/// Completes the waiting operators, down to `base`, whose precedence is at least `strength`.
/// With `strength` 0 all are completed.
/// The top of the stack is completed first, which makes operators of equal precedence associate to the left.
fn reduce(p: &mut Parser<'_>, base: usize, strength: u8) -> ParseResult<()> {
    while p.pending.len() > base
        && let Some(&top) = p.pending.last()
        && top.strength() >= strength
    {
        p.pending.pop();
        match top {
            PendingOperator::Prefix { op, sign, after } => complete_prefix(p, op, sign, after)?,
            PendingOperator::Infix(op, own) => {
                // `a < b < c` and `a^b^c` have no meaning in the grammar; they are reported and parsed from the left.
                if own == strength && matches!(own, RELATION | POWER) {
                    blame_chain(p);
                }
                complete_infix(p, op)?;
            }
        }
    }
    Ok(())
}

/// Takes an operand from the stack and puts it back with the prefix applied.
/// `after` is as in [`PendingOperator::Prefix`]; if it is there, the error is reported now that the operand is known.
fn complete_prefix(p: &mut Parser<'_>, op: UnaryOp, sign: Span, after: Option<Span>) -> ParseResult<()> {
    let (operand, height) = p.operands.pop().ok_or(ParseAbort)?;
    if let Some(after) = after {
        blame_prefix(p, after, sign, operand.span);
    }
    let span = sign.to(operand.span);
    push_operand(p, ExprKind::Unary(op, Box::new(operand)), span, height)
}

/// Takes two operands from the stack and puts them back joined.
/// The right operand is on top of the stack.
fn complete_infix(p: &mut Parser<'_>, op: BinaryOp) -> ParseResult<()> {
    let (right, right_height) = p.operands.pop().ok_or(ParseAbort)?;
    let (left, left_height) = p.operands.pop().ok_or(ParseAbort)?;
    let span = left.span.to(right.span);
    let kind = ExprKind::Binary(op, Box::new(left), Box::new(right));
    push_operand(p, kind, span, left_height.max(right_height))
}

/// Pushes an operator's result. `height` is that of its highest operand.
///
/// # Errors
/// Reports E004 if the tree is higher than [`MAX_HEIGHT`].
fn push_operand(p: &mut Parser<'_>, kind: ExprKind, span: Span, height: u32) -> ParseResult<()> {
    if height >= MAX_HEIGHT {
        return Err(p.too_deep(&format!("an expression with more than {MAX_HEIGHT} operators in a row")));
    }
    p.operands.push((Expr { kind, span }, height + 1));
    Ok(())
}

// Slips.

/// Reports an operator of another language, which is then parsed as its Modelica equivalent.
/// The four of them are `&&`, `||`, `!=` and `**`.
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

/// Reports a second relation or power in a row; the cursor is on the operator that comes second.
/// The expression is still built, so that parsing continues.
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

/// Reports a sign or `not` directly after an operator that binds more strongly, as in `a * -b`.
/// The help shows the operand in brackets, shortened to one line.
fn blame_prefix(p: &mut Parser<'_>, before: Span, sign: Span, operand: Span) {
    let words = |from: Span, to: Span| p.text.get(from.start as usize..to.end as usize).unwrap_or("");
    let (before, sign_word) = (words(before, before), words(sign, sign));
    let message = format!("`{sign_word}` directly after `{before}` needs brackets");
    let help = format!("write `{before} ({})`", shortened(words(sign, operand)));
    p.slip_at(sign, message, "brackets are needed here", help);
}

/// Precedences of an operator that waits.
impl PendingOperator {
    /// The precedence of the operator. An operator that comes must bind more strongly to take the operand from it.
    fn strength(&self) -> u8 {
        match self {
            PendingOperator::Prefix { op: UnaryOp::Not, .. } => NOT,
            PendingOperator::Prefix { .. } => SUM,
            PendingOperator::Infix(_, strength) => *strength,
        }
    }

    /// The least precedence of a prefix operator that may directly follow this one.
    fn least(&self) -> u8 {
        match self {
            PendingOperator::Prefix { op: UnaryOp::Not, .. } => RELATION,
            PendingOperator::Prefix { .. } => PRODUCT,
            PendingOperator::Infix(_, strength) => strength + 1,
        }
    }
}

/// The prefix operator that a token is. `!` counts as `not`; the caller reports it.
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

/// The infix operator that a token is, with its precedence.
/// Operators of other languages are included; [`check_foreign`] reports them.
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
