//! Operands joined by operators, by their binding strength.
//!
//! Operators wait on a stack of the parser's own instead of the call stack, which deep brackets would exhaust.

use super::report::shortened;
use super::{MAX_HEIGHT, Parse, Parser, Stop};
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
pub(super) enum Pending {
    Prefix {
        op: UnaryOp,
        sign: Span,
        /// The operator directly before, if it binds too strongly for this one to follow.
        after: Option<Span>,
    },
    Infix(BinaryOp, u8),
}

/// An operand with the height of its tree.
pub(super) type Operand = (Expr, u32);

impl Parser<'_> {
    /// Operands and operators as far as they go.
    pub(super) fn operators(&mut self) -> Parse<Expr> {
        let (pending, operands) = (self.pending.len(), self.operands.len());
        let result = self.operators_above(pending);
        if result.is_err() {
            self.pending.truncate(pending);
            self.operands.truncate(operands);
        }
        result
    }

    fn operators_above(&mut self, base: usize) -> Parse<Expr> {
        loop {
            self.prefixes_of_operand(base);
            let operand = self.primary()?;
            self.operands.push((operand, self.height));
            let Some((op, strength)) = infix(self.kind()) else { break };
            self.check_foreign();
            self.reduce(base, strength)?;
            self.pending.push(Pending::Infix(op, strength));
            self.bump();
        }
        self.reduce(base, 0)?;
        let (expr, height) = self.operands.pop().ok_or(Stop)?;
        self.height = height;
        Ok(expr)
    }

    fn prefixes_of_operand(&mut self, base: usize) {
        while let Some(op) = prefix(self.kind()) {
            if self.at(TokenKind::Bang) {
                self.slip("expected `not`, found `!`", "not a Modelica operator", "write `not`");
            }
            let limit = if op == UnaryOp::Not { NOT } else { SUM };
            let least = self.pending[base..].last().map_or(OR, Pending::least);
            let after = (least > limit).then(|| self.span_of(self.previous()));
            self.pending.push(Pending::Prefix { op, sign: self.span(), after });
            self.bump();
        }
    }

    /// Completes the waiting operators that bind at least as strongly as the one that comes.
    fn reduce(&mut self, base: usize, strength: u8) -> Parse<()> {
        while self.pending.len() > base
            && let Some(&top) = self.pending.last()
            && top.strength() >= strength
        {
            self.pending.pop();
            match top {
                Pending::Prefix { op, sign, after } => self.complete_prefix(op, sign, after)?,
                Pending::Infix(op, own) => {
                    if own == strength && matches!(own, RELATION | POWER) {
                        self.blame_chain();
                    }
                    self.complete_infix(op)?;
                }
            }
        }
        Ok(())
    }

    fn complete_prefix(&mut self, op: UnaryOp, sign: Span, after: Option<Span>) -> Parse<()> {
        let (operand, height) = self.operands.pop().ok_or(Stop)?;
        if let Some(after) = after {
            self.blame_prefix(after, sign, operand.span);
        }
        let span = sign.to(operand.span);
        self.push_operand(ExprKind::Unary(op, Box::new(operand)), span, height)
    }

    fn complete_infix(&mut self, op: BinaryOp) -> Parse<()> {
        let (right, right_height) = self.operands.pop().ok_or(Stop)?;
        let (left, left_height) = self.operands.pop().ok_or(Stop)?;
        let span = left.span.to(right.span);
        let kind = ExprKind::Binary(op, Box::new(left), Box::new(right));
        self.push_operand(kind, span, left_height.max(right_height))
    }

    fn push_operand(&mut self, kind: ExprKind, span: Span, height: u32) -> Parse<()> {
        if height >= MAX_HEIGHT {
            return Err(self.too_deep(&format!("an expression with more than {MAX_HEIGHT} operators in a row")));
        }
        self.operands.push((Expr { kind, span }, height + 1));
        Ok(())
    }

    // Slips.

    /// Reports an operator of other languages.
    fn check_foreign(&mut self) {
        let right = match self.kind() {
            TokenKind::AndAnd => "and",
            TokenKind::OrOr => "or",
            TokenKind::BangEqual => "<>",
            TokenKind::StarStar => "^",
            _ => return,
        };
        let message = format!("expected `{right}`, found `{}`", self.word(self.token()));
        self.slip(message, "not a Modelica operator", format!("write `{right}`"));
    }

    /// Reports a second operator of a kind that does not chain.
    fn blame_chain(&mut self) {
        let word = self.word(self.token());
        if matches!(self.kind(), TokenKind::Caret | TokenKind::DotCaret | TokenKind::StarStar) {
            let help = "write `(a^b)^c` or `a^(b^c)`";
            self.slip(format!("a second `{word}` needs brackets"), "no order is defined here", help);
        } else {
            let help = "join two comparisons by `and`: `a < b and b < c`";
            self.slip(format!("a comparison cannot be compared by `{word}`"), "second comparison", help);
        }
    }

    /// Reports a sign or `not` directly after an operator that binds more strongly.
    fn blame_prefix(&mut self, before: Span, sign: Span, operand: Span) {
        let words = |from: Span, to: Span| self.text.get(from.start as usize..to.end as usize).unwrap_or("");
        let (before, sign_word) = (words(before, before), words(sign, sign));
        let message = format!("`{sign_word}` directly after `{before}` needs brackets");
        let help = format!("write `{before} ({})`", shortened(words(sign, operand)));
        self.slip_at(sign, message, "brackets are needed here", help);
    }
}

impl Pending {
    /// An operator that comes must bind more strongly to take the operand from this one.
    fn strength(&self) -> u8 {
        match self {
            Pending::Prefix { op: UnaryOp::Not, .. } => NOT,
            Pending::Prefix { .. } => SUM,
            Pending::Infix(_, strength) => *strength,
        }
    }

    /// The least strength of what may follow.
    fn least(&self) -> u8 {
        match self {
            Pending::Prefix { op: UnaryOp::Not, .. } => RELATION,
            Pending::Prefix { .. } => PRODUCT,
            Pending::Infix(_, strength) => strength + 1,
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
