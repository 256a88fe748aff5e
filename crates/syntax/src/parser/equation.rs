//! Equations, and the blocks `if`, `for` and `when` that equations and statements share.

use super::{Open, OpenKind, Parse, Parser, Stop};
use crate::ast::{BinaryOp, Equation, EquationKind, Expr, ExprKind, Iterator};
use crate::diag::Span;
use crate::token::TokenKind;

/// Conditions with what they guard.
pub(super) type Branches<T> = Vec<(Expr, Vec<T>)>;

impl Parser<'_> {
    /// One equation, without its semicolon.
    pub(super) fn equation(&mut self) -> Parse<Equation> {
        let start = self.span();
        let kind = self.nested(|p| match p.kind() {
            TokenKind::If => p.if_equation(),
            TokenKind::For => p.for_equation(),
            TokenKind::When => Ok(EquationKind::When(p.when_block(Self::equation)?)),
            TokenKind::Connect => p.connect_arguments().map(|(a, b)| EquationKind::Connect(a, b)),
            _ => p.plain_equation(),
        })?;
        let span = self.since(start);
        let (description, _) = self.comment()?;
        Ok(Equation { kind, description, span })
    }

    fn if_equation(&mut self) -> Parse<EquationKind> {
        let (branches, otherwise) = self.if_block(Self::equation)?;
        Ok(EquationKind::If { branches, otherwise })
    }

    fn for_equation(&mut self) -> Parse<EquationKind> {
        let (iterators, body) = self.for_block(Self::equation)?;
        Ok(EquationKind::For { iterators, body })
    }

    /// `a = b` or a call.
    fn plain_equation(&mut self) -> Parse<EquationKind> {
        let left = self.simple_expression()?;
        match self.kind() {
            TokenKind::Equal => self.bump(),
            TokenKind::Assign => {
                let help = "`:=` is for algorithm sections; an equation has `=`";
                self.slip("expected `=`, found `:=`", "expected `=`", help);
                self.bump();
            }
            _ => return self.equation_without_sign(left),
        }
        Ok(EquationKind::Equal(left, self.expression()?))
    }

    fn equation_without_sign(&mut self, left: Expr) -> Parse<EquationKind> {
        match left.kind {
            ExprKind::Call { .. } => Ok(EquationKind::Call(left)),
            ExprKind::Binary(BinaryOp::Eq, a, b) if !self.is_bracketed(left.span, a.span) => {
                self.blame_comparison(a.span, b.span, "=", "`==` compares; an equation has a single `=`");
                Ok(EquationKind::Equal(*a, *b))
            }
            _ => {
                if let Some(arrow) = self.arrow(&left) {
                    return Err(self.blame_arrow(arrow, "=", "an equation has `=`"));
                }
                Err(self.unexpected_in_item("`=`", self.advice_on_equation(&left)))
            }
        }
    }

    /// Whether an expression begins before its first operand.
    fn is_bracketed(&self, whole: Span, first: Span) -> bool {
        whole.start < first.start
    }

    /// Reports `==` between two operands where a sign of assignment or equality is due.
    pub(super) fn blame_comparison(&mut self, left: Span, right: Span, due: &str, help: &str) {
        let gap = self.text.get(left.end as usize..right.start as usize).unwrap_or("");
        let offset = gap.find("==").unwrap_or(0) as u32;
        let place = Span { start: left.end + offset, end: left.end + offset + 2, ..left };
        let message = format!("expected `{due}`, found `==`");
        self.slip_at(place, message, &format!("expected `{due}`"), help);
    }

    fn advice_on_equation(&self, left: &Expr) -> Option<&'static str> {
        let is_declaration = self.at(TokenKind::Ident) && matches!(left.kind, ExprKind::Reference(_));
        is_declaration.then_some("declarations stand before the keyword `equation`")
    }

    /// Where `x <- y` was written, which is a comparison with `-y`.
    pub(super) fn arrow(&self, expr: &Expr) -> Option<Span> {
        let ExprKind::Binary(BinaryOp::Lt, left, right) = &expr.kind else { return None };
        let gap = self.text.get(left.span.end as usize..right.span.end as usize)?;
        let sign = gap.trim_start();
        let start = left.span.end + (gap.len() - sign.len()) as u32;
        sign.starts_with("<-").then_some(Span { start, end: start + 2, ..left.span })
    }

    pub(super) fn blame_arrow(&mut self, arrow: Span, due: &str, rule: &str) -> Stop {
        let help = format!("`<-` is read as \"less than minus\"; {rule}");
        self.slip_at(arrow, format!("expected `{due}`, found `<-`"), &format!("expected `{due}`"), help)
    }

    // Blocks. The cursor is on the first keyword.

    /// `if ... then ... elseif ... else ... end if`.
    pub(super) fn if_block<T>(&mut self, item: fn(&mut Self) -> Parse<T>) -> Parse<(Branches<T>, Vec<T>)> {
        self.open_block(OpenKind::If);
        let mut branches = vec![self.branch(item)];
        while self.at(TokenKind::Elseif) || self.at_misspelt(TokenKind::Elseif) {
            self.check_elseif();
            branches.push(self.branch(item));
        }
        let mut otherwise = Vec::new();
        let mut seen_else = false;
        while matches!(self.kind(), TokenKind::Else | TokenKind::Elseif) {
            self.check_second_else(seen_else);
            seen_else = true;
            if self.at(TokenKind::Elseif) {
                branches.push(self.branch(item));
                continue;
            }
            self.bump();
            self.note_else_if();
            otherwise.extend(self.list(item));
        }
        self.close_block(TokenKind::If);
        Ok((branches, otherwise))
    }

    fn check_elseif(&mut self) {
        if !self.at(TokenKind::Elseif) {
            let word = self.word(self.token());
            self.slip(format!("expected `elseif`, found `{word}`"), "not a Modelica word", "write `elseif`");
        }
    }

    fn check_second_else(&mut self, seen_else: bool) {
        if seen_else {
            let word = self.word(self.token());
            let message = format!("`{word}` after `else`: expected `end if`");
            self.slip(message, "`else` is the last branch", "write this branch before `else`, or `end if` above it");
        }
    }

    /// Remembers an `else if` on one line.
    fn note_else_if(&mut self) {
        if self.at(TokenKind::If) && !self.is_on_new_line() {
            let span = self.span();
            if let Some(open) = self.open.last_mut() {
                open.else_if = Some(span);
            }
        }
    }

    /// `when ... then ... elsewhen ... end when`.
    pub(super) fn when_block<T>(&mut self, item: fn(&mut Self) -> Parse<T>) -> Parse<Branches<T>> {
        self.open_block(OpenKind::When);
        let mut branches = vec![self.branch(item)];
        while self.at(TokenKind::Elsewhen) {
            branches.push(self.branch(item));
        }
        self.close_block(TokenKind::When);
        Ok(branches)
    }

    /// `for i in 1:n loop ... end for`.
    pub(super) fn for_block<T>(&mut self, item: fn(&mut Self) -> Parse<T>) -> Parse<(Vec<Iterator>, Vec<T>)> {
        self.open_block(OpenKind::For);
        self.bump();
        let iterators = self.iterators();
        self.header_end(iterators.is_ok(), TokenKind::Loop);
        let body = self.list(item);
        self.close_block(TokenKind::For);
        Ok((iterators.unwrap_or_default(), body))
    }

    /// `while c loop ... end while`.
    pub(super) fn while_block<T>(&mut self, item: fn(&mut Self) -> Parse<T>) -> Parse<(Expr, Vec<T>)> {
        self.open_block(OpenKind::While);
        self.bump();
        let condition = self.condition(TokenKind::Loop);
        let body = self.list(item);
        self.close_block(TokenKind::While);
        Ok((condition, body))
    }

    fn branch<T>(&mut self, item: fn(&mut Self) -> Parse<T>) -> (Expr, Vec<T>) {
        self.bump();
        let condition = self.condition(TokenKind::Then);
        (condition, self.list(item))
    }

    /// A condition and the keyword after it. Errors in it do not keep the body from being read.
    fn condition(&mut self, keyword: TokenKind) -> Expr {
        let span = self.span();
        let condition = self.expression();
        self.header_end(condition.is_ok(), keyword);
        condition.unwrap_or(Expr { kind: ExprKind::Error, span })
    }

    /// `then` or `loop`, which is looked for in the rest of the header if need be.
    fn header_end(&mut self, is_fine: bool, keyword: TokenKind) {
        if self.eat(keyword) {
            return;
        }
        if is_fine {
            let help = self.at(TokenKind::Equal).then_some("equality is tested with `==`");
            let expected = format!("`{}`", keyword.spelling().unwrap_or("then"));
            self.unexpected_with(&expected, help);
        }
        self.skip_header(keyword);
    }

    fn skip_header(&mut self, keyword: TokenKind) {
        let in_header = self.tokens[self.at..].iter().take_while(|token| token.kind != TokenKind::Semicolon);
        let length = in_header.take(MAX_HEADER).position(|token| token.kind == keyword);
        if let Some(length) = length {
            self.at += length;
            return self.bump();
        }
        while !self.is_on_new_line() && !self.is_list_end() {
            if self.eat(TokenKind::Semicolon) {
                return;
            }
            self.bump();
        }
    }

    // Ends of blocks.

    fn open_block(&mut self, kind: OpenKind) {
        self.open.push(Open { kind, span: self.span(), else_if: None });
    }

    /// `end if` and the like; reports what stands there instead.
    fn close_block(&mut self, keyword: TokenKind) {
        let misspelt = self.eat_misspelt(TokenKind::End);
        let Some(open) = self.open.pop() else { return };
        if misspelt {
            return;
        }
        if !self.at(TokenKind::End) {
            return self.unclosed(open);
        }
        let found = self.peek_kind(1);
        if found == keyword {
            self.bump();
        } else if self.closes_something_else(found) {
            return self.unclosed(open);
        } else {
            self.wrong_end(open);
            if found != TokenKind::Semicolon {
                self.bump();
            }
        }
        self.bump();
    }

    /// Whether `end` with this word closes a block or class further out.
    fn closes_something_else(&self, word: TokenKind) -> bool {
        let is_open = |kind| self.open.iter().any(|open| open.kind == kind);
        match word {
            TokenKind::If => is_open(OpenKind::If),
            TokenKind::For => is_open(OpenKind::For),
            TokenKind::While => is_open(OpenKind::While),
            TokenKind::When => is_open(OpenKind::When),
            TokenKind::Semicolon => false,
            _ => true,
        }
    }
}

/// How far a misread header is searched for its `then`, in tokens.
const MAX_HEADER: usize = 1000;
