//! Expressions by recursive descent, but for what stands between operators.

use super::{Parse, Parser};
use crate::ast::{Expr, ExprKind, Ident, Iterator, Path, Reference, ReferencePart, Subscript};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

/// Positional and named arguments of a call.
type Arguments = (Vec<Expr>, Vec<(Ident, Expr)>);

impl Parser<'_> {
    /// An expression that is the whole text.
    pub fn whole_expression(&mut self) -> Option<Expr> {
        let expr = self.expression().ok()?;
        if !self.at(TokenKind::Eof) {
            self.unexpected("an operator or the end");
        }
        Some(expr)
    }

    /// Any expression, if-expressions and ranges included.
    pub(super) fn expression(&mut self) -> Parse<Expr> {
        let outer = std::mem::take(&mut self.height);
        let result = self.nested(|p| match p.kind() {
            TokenKind::If => p.if_expression(),
            _ => p.range_or_value(),
        });
        self.height = outer.max(self.height + 1);
        result
    }

    /// An expression that does not begin with `if`, as on the left of an equation.
    pub(super) fn simple_expression(&mut self) -> Parse<Expr> {
        self.nested(Self::range_or_value)
    }

    fn range_or_value(&mut self) -> Parse<Expr> {
        let from = self.operators()?;
        if !self.eat(TokenKind::Colon) {
            return Ok(from);
        }
        let second = self.operators()?;
        let (step, to) =
            if self.eat(TokenKind::Colon) { (Some(Box::new(second)), self.operators()?) } else { (None, second) };
        let span = from.span.to(to.span);
        Ok(Expr { kind: ExprKind::Range { from: Box::new(from), step, to: Box::new(to) }, span })
    }

    fn if_expression(&mut self) -> Parse<Expr> {
        let start = self.span();
        let mut branches = Vec::new();
        self.bump();
        loop {
            let condition = self.expression()?;
            self.expect_then()?;
            branches.push((condition, self.expression()?));
            if !self.eat(TokenKind::Elseif) {
                break;
            }
        }
        if !self.eat(TokenKind::Else) {
            let help = "an `if` that gives a value needs an `else` with the other value";
            return Err(self.unexpected_with("`else`", Some(help)));
        }
        let otherwise = Box::new(self.expression()?);
        Ok(Expr { kind: ExprKind::If { branches, otherwise }, span: self.since(start) })
    }

    fn expect_then(&mut self) -> Parse<()> {
        if self.eat(TokenKind::Then) {
            return Ok(());
        }
        let help = self.at(TokenKind::Equal).then_some("equality is tested with `==`");
        Err(self.unexpected_with("`then`", help))
    }

    // Operands of operators.

    pub(super) fn primary(&mut self) -> Parse<Expr> {
        self.height = 0;
        let span = self.span();
        let kind = match self.kind() {
            TokenKind::Ident | TokenKind::Dot => return self.reference_or_call(),
            TokenKind::Integer | TokenKind::Real => self.number(),
            TokenKind::String => ExprKind::String(self.string_value()),
            TokenKind::True => ExprKind::Boolean(true),
            TokenKind::False => ExprKind::Boolean(false),
            TokenKind::LeftParen => return self.bracketed(),
            TokenKind::LeftBrace => return self.array(),
            TokenKind::LeftBracket => return self.matrix(),
            TokenKind::End if self.subscripts > 0 => ExprKind::End,
            TokenKind::Der | TokenKind::Initial | TokenKind::Pure => return self.keyword_call(),
            TokenKind::If => {
                self.slip("an `if` inside an expression needs brackets", "here", "write `(if ... then ... else ...)`");
                return self.expression();
            }
            _ => return Err(self.unexpected("an expression")),
        };
        self.bump();
        if matches!(kind, ExprKind::String(_)) {
            self.skip_rest_of_string();
        }
        Ok(Expr { kind, span })
    }

    fn number(&mut self) -> ExprKind {
        let word = self.word(self.token());
        if self.at(TokenKind::Integer)
            && let Ok(value) = word.parse()
        {
            return ExprKind::Integer(value);
        }
        let value: f64 = word.parse().unwrap_or(f64::INFINITY);
        if value.is_infinite() {
            let message = format!("{} is too large", self.describe(self.token()));
            self.slip(message, "too large", "the largest number is about 1.8e308");
        }
        ExprKind::Real(value)
    }

    /// The value of the string at the cursor, which stays.
    pub(super) fn string_value(&mut self) -> Box<str> {
        let token = self.token();
        let word = self.word(token);
        let inner = word.strip_prefix('"').unwrap_or(word);
        let inner = inner.strip_suffix('"').unwrap_or(inner);
        if inner.contains('\\') { self.unescaped(inner, token.start + 1) } else { inner.into() }
    }

    /// Resolves the escapes of a string that begins at a byte of the text.
    fn unescaped(&mut self, inner: &str, start: u32) -> Box<str> {
        let mut value = String::with_capacity(inner.len());
        let mut characters = inner.char_indices();
        while let Some((i, c)) = characters.next() {
            if c != '\\' {
                value.push(c);
                continue;
            }
            let escaped = characters.next().map_or('\\', |(_, c)| c);
            value.push(escape_value(escaped).unwrap_or_else(|| {
                self.unknown_escape(escaped, start + i as u32);
                escaped
            }));
        }
        value.into()
    }

    fn unknown_escape(&mut self, escaped: char, start: u32) {
        let span = Span { file: self.file, start, end: start + 1 + escaped.len_utf8() as u32 };
        let diagnostic = Diagnostic::new(Code::Syntax, format!("`\\{escaped}` means nothing in a string"))
            .at(span, "unknown escape")
            .help("a backslash itself is written `\\\\`");
        self.report(diagnostic);
    }

    /// `(a)`, `(a)[i]` or a list of outputs.
    fn bracketed(&mut self) -> Parse<Expr> {
        let start = self.span();
        let mut items = self.output_list()?;
        let span = self.since(start);
        if items.len() != 1 {
            return Ok(Expr { kind: ExprKind::Tuple(items), span });
        }
        let Some(Some(inner)) = items.pop() else {
            return Err(self.unexpected("an expression"));
        };
        let inner = Expr { span, ..inner };
        if !self.at(TokenKind::LeftBracket) {
            return Ok(inner);
        }
        let indices = self.subscripts()?;
        Ok(Expr { kind: ExprKind::Index(Box::new(inner), indices), span: self.since(start) })
    }

    /// `(a, , c)`; `()` gives no item.
    pub(super) fn output_list(&mut self) -> Parse<Vec<Option<Expr>>> {
        let opened = self.span();
        self.bump();
        let mut items = Vec::new();
        if self.eat(TokenKind::RightParen) {
            return Ok(items);
        }
        loop {
            let empty = matches!(self.kind(), TokenKind::Comma | TokenKind::RightParen);
            items.push(if empty { None } else { Some(self.expression()?) });
            if !self.eat(TokenKind::Comma) {
                break;
            }
        }
        self.close(TokenKind::RightParen, opened, "an operator or `)`")?;
        Ok(items)
    }

    /// `{a, b}` or `{a for i in 1:n}`.
    fn array(&mut self) -> Parse<Expr> {
        let opened = self.span();
        self.bump();
        if self.at(TokenKind::RightBrace) {
            let help = "an array without elements is written `fill(0.0, 0)`";
            return Err(self.unexpected_with("an expression", Some(help)));
        }
        let mut items = vec![self.expression()?];
        let kind = if self.at(TokenKind::For) {
            let body = Box::new(items.swap_remove(0));
            ExprKind::Comprehension { function: None, body, iterators: self.comprehension_iterators()? }
        } else {
            while self.eat(TokenKind::Comma) {
                items.push(self.expression()?);
            }
            ExprKind::Array(items)
        };
        self.close(TokenKind::RightBrace, opened, "`,` or `}`")?;
        Ok(Expr { kind, span: self.since(opened) })
    }

    /// `[a, b; c, d]`.
    fn matrix(&mut self) -> Parse<Expr> {
        let opened = self.span();
        self.bump();
        let mut rows = Vec::new();
        loop {
            rows.push(self.expressions()?);
            if !self.eat(TokenKind::Semicolon) {
                break;
            }
            if self.is_boundary() || self.looks_like_equation() {
                break;
            }
        }
        self.close(TokenKind::RightBracket, opened, "`,`, `;` or `]`")?;
        Ok(Expr { kind: ExprKind::Matrix(rows), span: self.since(opened) })
    }

    /// A line that begins like an equation: the matrix before it is not closed.
    pub(super) fn looks_like_equation(&self) -> bool {
        use TokenKind::{Assign, Connect, Equal, For, Ident, If, When};
        let begins = match self.kind() {
            Ident => matches!(self.peek_kind(1), Equal | Assign),
            kind => matches!(kind, Connect | For | If | When),
        };
        begins && self.is_on_new_line()
    }

    /// Expressions separated by commas, at least one.
    pub(super) fn expressions(&mut self) -> Parse<Vec<Expr>> {
        let mut items = vec![self.expression()?];
        while self.eat(TokenKind::Comma) {
            items.push(self.expression()?);
        }
        Ok(items)
    }

    // References and calls.

    fn reference_or_call(&mut self) -> Parse<Expr> {
        let reference = self.reference("an expression")?;
        if self.at(TokenKind::LeftParen) {
            return self.call(reference);
        }
        let span = reference.span;
        Ok(Expr { kind: ExprKind::Reference(reference), span })
    }

    /// `der(...)`, `initial()`, `pure(...)`.
    fn keyword_call(&mut self) -> Parse<Expr> {
        if self.peek_kind(1) != TokenKind::LeftParen {
            return Err(self.unexpected("an expression"));
        }
        let name = self.ident_of(self.token());
        self.bump();
        let parts = vec![ReferencePart { name, subscripts: Vec::new() }];
        self.call(Reference { global: false, parts, span: name.span })
    }

    /// `[.] a[i].b`.
    pub(super) fn reference(&mut self, what: &str) -> Parse<Reference> {
        let start = self.span();
        let global = self.eat(TokenKind::Dot);
        let mut parts = vec![self.reference_part(what)?];
        while self.eat(TokenKind::Dot) {
            parts.push(self.reference_part("a name after `.`")?);
        }
        Ok(Reference { global, parts, span: self.since(start) })
    }

    fn reference_part(&mut self, what: &str) -> Parse<ReferencePart> {
        let name = self.ident(what)?;
        let subscripts = if self.at(TokenKind::LeftBracket) { self.subscripts()? } else { Vec::new() };
        Ok(ReferencePart { name, subscripts })
    }

    /// `[i, :, 1:end]`.
    pub(super) fn subscripts(&mut self) -> Parse<Vec<Subscript>> {
        self.subscripts += 1;
        let result = self.subscript_list();
        self.subscripts -= 1;
        result
    }

    fn subscript_list(&mut self) -> Parse<Vec<Subscript>> {
        let opened = self.span();
        self.bump();
        let mut items = Vec::new();
        loop {
            let span = self.span();
            let all = self.eat(TokenKind::Colon);
            items.push(if all { Subscript::All(span) } else { Subscript::Expr(self.expression()?) });
            if !self.eat(TokenKind::Comma) {
                break;
            }
        }
        self.close(TokenKind::RightBracket, opened, "`,` or `]`")?;
        Ok(items)
    }

    /// The call of a function whose opening bracket is at the cursor.
    fn call(&mut self, function: Reference) -> Parse<Expr> {
        let (start, opened) = (function.span, self.span());
        self.bump();
        let (mut args, named) = self.arguments()?;
        let kind = if self.at(TokenKind::For) && args.len() == 1 && named.is_empty() {
            let body = Box::new(args.swap_remove(0));
            let iterators = self.comprehension_iterators()?;
            ExprKind::Comprehension { function: Some(function), body, iterators }
        } else {
            ExprKind::Call { function, args, named }
        };
        self.close(TokenKind::RightParen, opened, "`,` or `)`")?;
        Ok(Expr { kind, span: self.since(start) })
    }

    fn arguments(&mut self) -> Parse<Arguments> {
        let (mut args, mut named) = (Vec::new(), Vec::new());
        if self.at(TokenKind::RightParen) {
            return Ok((args, named));
        }
        loop {
            if self.at_named() {
                named.push(self.named_argument()?);
            } else {
                if !named.is_empty() {
                    let help = "arguments without a name come first";
                    self.slip("expected a named argument such as `a = 1`", "argument without a name", help);
                }
                args.push(self.argument()?);
            }
            if !self.eat(TokenKind::Comma) {
                return Ok((args, named));
            }
        }
    }

    fn at_named(&self) -> bool {
        self.at(TokenKind::Ident) && self.peek_kind(1) == TokenKind::Equal
    }

    fn named_argument(&mut self) -> Parse<(Ident, Expr)> {
        let name = self.ident("the name of an argument")?;
        self.expect(TokenKind::Equal)?;
        Ok((name, self.argument()?))
    }

    fn argument(&mut self) -> Parse<Expr> {
        if self.at(TokenKind::Function) { self.nested(Self::partial_application) } else { self.expression() }
    }

    /// `function f(a = 1)`.
    fn partial_application(&mut self) -> Parse<Expr> {
        let start = self.span();
        self.bump();
        let function: Path = self.path("the name of a function")?;
        let opened = self.expect(TokenKind::LeftParen)?;
        let mut named = Vec::new();
        if !self.at(TokenKind::RightParen) {
            named.push(self.named_argument()?);
            while self.eat(TokenKind::Comma) {
                named.push(self.named_argument()?);
            }
        }
        self.close(TokenKind::RightParen, opened, "`,` or `)`")?;
        Ok(Expr { kind: ExprKind::PartialApplication { function, named }, span: self.since(start) })
    }

    fn comprehension_iterators(&mut self) -> Parse<Vec<Iterator>> {
        self.bump();
        self.iterators()
    }

    /// `i in 1:n, j`.
    pub(super) fn iterators(&mut self) -> Parse<Vec<Iterator>> {
        let mut iterators = Vec::new();
        loop {
            let name = self.ident("the name of a loop variable")?;
            if self.at(TokenKind::Equal) {
                self.slip("expected `in`, found `=`", "expected `in`", format!("write `{} in ...`", name.name));
            }
            let has_range = self.eat(TokenKind::In) || self.eat(TokenKind::Equal);
            let range = if has_range { Some(self.expression()?) } else { None };
            iterators.push(Iterator { name, range });
            if !self.eat(TokenKind::Comma) {
                return Ok(iterators);
            }
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
