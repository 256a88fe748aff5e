//! Statements of algorithm sections.

use super::{Parse, Parser};
use crate::ast::{BinaryOp, Expr, ExprKind, Statement, StatementKind};
use crate::token::TokenKind;

impl Parser<'_> {
    /// One statement, without its semicolon.
    pub(super) fn statement(&mut self) -> Parse<Statement> {
        let start = self.span();
        let kind = self.nested(Self::statement_kind)?;
        let span = self.since(start);
        self.comment()?;
        Ok(Statement { kind, span })
    }

    fn statement_kind(&mut self) -> Parse<StatementKind> {
        Ok(match self.kind() {
            TokenKind::If => {
                let (branches, otherwise) = self.if_block(Self::statement)?;
                StatementKind::If { branches, otherwise }
            }
            TokenKind::For => {
                let (iterators, body) = self.for_block(Self::statement)?;
                StatementKind::For { iterators, body }
            }
            TokenKind::While => {
                let (condition, body) = self.while_block(Self::statement)?;
                StatementKind::While(condition, body)
            }
            TokenKind::When => StatementKind::When(self.when_block(Self::statement)?),
            TokenKind::Break => {
                self.bump();
                StatementKind::Break
            }
            TokenKind::Return => {
                self.bump();
                StatementKind::Return
            }
            TokenKind::LeftParen => self.assign_tuple()?,
            TokenKind::Connect => {
                let help = "`connect` stands in an `equation` section";
                return Err(self.unexpected_with("a statement", Some(help)));
            }
            _ => self.assign_or_call()?,
        })
    }

    /// `(a, , c) := f(x)`.
    fn assign_tuple(&mut self) -> Parse<StatementKind> {
        let targets = self.output_list()?;
        self.assignment_sign()?;
        let value = self.expression()?;
        if !matches!(value.kind, ExprKind::Call { .. }) {
            let help = "a list of variables takes the outputs of a function: `(a, b) := f(x)`";
            self.slip_at(value.span, "expected the call of a function", "not a call", help);
        }
        Ok(StatementKind::AssignTuple(targets, value))
    }

    /// `a := b` or `f(x)`.
    fn assign_or_call(&mut self) -> Parse<StatementKind> {
        let left = self.simple_expression()?;
        match left.kind {
            ExprKind::Call { .. } if !self.at_assignment_sign() => return Ok(StatementKind::Call(left)),
            ExprKind::Binary(BinaryOp::Eq, a, b) if left.span.start == a.span.start => {
                let help = "`==` compares; an assignment has `:=`";
                self.blame_comparison(a.span, b.span, ":=", help);
                return Ok(StatementKind::Assign(*a, *b));
            }
            _ => {}
        }
        self.check_target(&left)?;
        self.assignment_sign()?;
        Ok(StatementKind::Assign(left, self.expression()?))
    }

    fn check_target(&mut self, left: &Expr) -> Parse<()> {
        if matches!(left.kind, ExprKind::Reference(_)) {
            return Ok(());
        }
        if let Some(arrow) = self.arrow(left) {
            return Err(self.blame_arrow(arrow, ":=", "an assignment has `:=`"));
        }
        if self.at_assignment_sign() {
            let help = "an assignment has a single variable on its left";
            return Err(self.slip_at(
                left.span,
                "expected a variable before the sign of assignment",
                "not a variable",
                help,
            ));
        }
        Err(self.unexpected_in_item("`:=`", None))
    }

    fn at_assignment_sign(&self) -> bool {
        matches!(self.kind(), TokenKind::Assign | TokenKind::Equal)
    }

    fn assignment_sign(&mut self) -> Parse<()> {
        if self.eat(TokenKind::Assign) {
            return Ok(());
        }
        if self.at(TokenKind::Equal) {
            let help = "`=` is for equation sections; an assignment has `:=`";
            self.slip("expected `:=`, found `=`", "expected `:=`", help);
            self.bump();
            return Ok(());
        }
        Err(self.unexpected_in_item("`:=`", None))
    }
}
