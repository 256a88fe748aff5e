//! Modifications: `(start = 1, redeclare model M = N) = 3`, annotations and descriptions.

use super::{Parse, Parser, is_class_keyword};
use crate::ast::{
    Argument, ArgumentKind, Class, ClassBody, Component, Constraint, Expr, ExprKind, Modification, Prefixes,
};
use crate::token::TokenKind;

/// Where a modification stands decides what it may hold.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// After `extends B`, where `break` takes elements out.
    Extends,
    /// Everywhere else.
    Elsewhere,
}

impl Parser<'_> {
    /// `(...) = value`, `= value` or `:= value`, if there.
    pub(super) fn modification(&mut self) -> Parse<Option<Modification>> {
        let with_arguments = self.at(TokenKind::LeftParen);
        let arguments = if with_arguments { self.class_modification(Place::Elsewhere)? } else { Vec::new() };
        let has_value = match self.kind() {
            TokenKind::Equal | TokenKind::Assign => true,
            TokenKind::EqualEqual => {
                self.slip("expected `=`, found `==`", "expected `=`", "a value is given with a single `=`");
                true
            }
            _ => false,
        };
        if !has_value {
            return Ok(with_arguments.then(|| Modification { arguments, ..Modification::default() }));
        }
        self.bump();
        if self.eat(TokenKind::Break) {
            return Ok(Some(Modification { arguments, value: None, break_value: true }));
        }
        Ok(Some(Modification { arguments, value: Some(self.expression()?), break_value: false }))
    }

    /// `(argument, ...)`; an argument that fails is left out.
    pub(super) fn class_modification(&mut self, place: Place) -> Parse<Vec<Argument>> {
        let opened = self.span();
        self.bump();
        let mut arguments = Vec::new();
        if !self.at(TokenKind::RightParen) {
            arguments.push(self.argument_of_modification(place)?);
            while self.eat(TokenKind::Comma) {
                arguments.push(self.argument_of_modification(place)?);
            }
        }
        self.close(TokenKind::RightParen, opened, "`,` or `)`")?;
        Ok(arguments)
    }

    fn argument_of_modification(&mut self, place: Place) -> Parse<Argument> {
        // Counts twice, as it takes more stack than other nesting.
        self.nested(|p| p.nested(|p| p.bare_argument(place)))
    }

    fn bare_argument(&mut self, place: Place) -> Parse<Argument> {
        let start = self.span();
        if self.at(TokenKind::Break) {
            let kind = self.break_argument(place)?;
            return Ok(Argument { each: false, final_: false, kind, span: self.since(start) });
        }
        let mut redeclare = self.eat(TokenKind::Redeclare);
        let each = self.eat(TokenKind::Each);
        let final_ = self.eat(TokenKind::Final);
        redeclare |= self.late_redeclare();
        let replaceable = self.eat(TokenKind::Replaceable);
        let kind = if redeclare || replaceable {
            self.redeclaration(Prefixes { redeclare, replaceable, ..Prefixes::default() })?
        } else {
            self.element_modification()?
        };
        Ok(Argument { each, final_, kind, span: self.since(start) })
    }

    /// Reports `each redeclare`, where `redeclare` comes too late.
    fn late_redeclare(&mut self) -> bool {
        let is_late = self.at(TokenKind::Redeclare);
        if is_late {
            let before = self.word(self.previous());
            let message = format!("`redeclare` stands before `{before}`");
            self.slip(message, "in the wrong order", format!("write `redeclare {before}`"));
            self.bump();
        }
        is_late
    }

    /// `break name` or `break connect(a, b)`.
    fn break_argument(&mut self, place: Place) -> Parse<ArgumentKind> {
        if place == Place::Elsewhere {
            let help = "`break` takes an inherited element out: `extends B(break c)`";
            return Err(self.unexpected_with("a modifier", Some(help)));
        }
        self.bump();
        if !self.at(TokenKind::Connect) {
            return Ok(ArgumentKind::BreakComponent(self.ident("a name or `connect`")?));
        }
        let (a, b) = self.connect_arguments()?;
        Ok(ArgumentKind::BreakConnect(Box::new(a), Box::new(b)))
    }

    /// `(a, b)` after `connect`, which is at the cursor.
    pub(super) fn connect_arguments(&mut self) -> Parse<(Expr, Expr)> {
        self.bump();
        let opened = self.expect(TokenKind::LeftParen)?;
        let a = self.connector()?;
        self.expect(TokenKind::Comma)?;
        let b = self.connector()?;
        self.close(TokenKind::RightParen, opened, "`)`")?;
        Ok((a, b))
    }

    fn connector(&mut self) -> Parse<Expr> {
        let reference = self.reference("the name of a connector")?;
        let span = reference.span;
        Ok(Expr { kind: ExprKind::Reference(reference), span })
    }

    fn element_modification(&mut self) -> Parse<ArgumentKind> {
        let path = self.path("the name of an attribute or element")?;
        if self.at(TokenKind::LeftBracket) {
            let help = "a modifier holds for the whole array: give all values at once, as in `x(start = {1, 2})`";
            return Err(self.unexpected_with("`=` or `(`", Some(help)));
        }
        let modification = self.modification()?;
        let ends = matches!(self.kind(), TokenKind::String | TokenKind::Comma | TokenKind::RightParen);
        if modification.is_none() && !ends {
            return Err(self.unexpected("`=` or `(`"));
        }
        Ok(ArgumentKind::Modify { path, modification, description: self.description() })
    }

    /// What stands after `redeclare` or `replaceable` in a modification.
    fn redeclaration(&mut self, prefixes: Prefixes) -> Parse<ArgumentKind> {
        if is_class_keyword(self.kind()) {
            return Ok(ArgumentKind::Class(self.redeclared_class(prefixes)?));
        }
        Ok(ArgumentKind::Component(self.redeclared_component(prefixes)?))
    }

    fn redeclared_class(&mut self, prefixes: Prefixes) -> Parse<Box<Class>> {
        let start = self.token();
        let mut class = self.class(prefixes)?;
        if matches!(class.body, ClassBody::Long(_)) {
            let message = "a class is redeclared in a modification in the short form only";
            let help = format!(
                "write the class elsewhere and `redeclare {} {} = ...` here",
                self.word(start),
                class.name.name
            );
            self.slip(message, "after this class", help);
        }
        if prefixes.replaceable {
            class.constraint = self.constraint()?;
        }
        Ok(class)
    }

    fn redeclared_component(&mut self, prefixes: Prefixes) -> Parse<Box<Component>> {
        let prefix = self.type_prefix();
        let class = self.path("a type")?;
        let of_type = self.optional_subscripts()?;
        let name = self.ident("the name of the component")?;
        let mut subscripts = self.optional_subscripts()?;
        subscripts.extend(of_type);
        let modification = self.modification()?;
        let (description, annotation) = self.comment()?;
        let constraint = if prefixes.replaceable { self.constraint()? } else { None };
        let condition = None;
        Ok(Box::new(Component {
            name,
            prefixes,
            prefix,
            class,
            subscripts,
            modification,
            condition,
            constraint,
            description,
            annotation,
        }))
    }

    /// `constrainedby T(...)`, if there.
    pub(super) fn constraint(&mut self) -> Parse<Option<Constraint>> {
        if !self.eat(TokenKind::Constrainedby) {
            return Ok(None);
        }
        let path = self.path("a type")?;
        Ok(Some(Constraint { path, modification: self.optional_class_modification(Place::Elsewhere)? }))
    }

    /// `(...)` without a value, if there.
    pub(super) fn optional_class_modification(&mut self, place: Place) -> Parse<Option<Modification>> {
        if !self.at(TokenKind::LeftParen) {
            return Ok(None);
        }
        let arguments = self.class_modification(place)?;
        Ok(Some(Modification { arguments, ..Modification::default() }))
    }

    /// `"text" + "text"`, if there.
    pub(super) fn description(&mut self) -> Option<Box<str>> {
        if !self.at(TokenKind::String) {
            return None;
        }
        let mut text = self.string_value();
        self.bump();
        while self.at(TokenKind::Plus) && self.peek_kind(1) == TokenKind::String {
            self.bump();
            text = [text, self.string_value()].concat().into();
            self.bump();
        }
        self.skip_rest_of_string();
        Some(text)
    }

    /// `annotation(...)`, if there.
    pub(super) fn annotation(&mut self) -> Parse<Option<Modification>> {
        if !self.eat(TokenKind::Annotation) {
            return Ok(None);
        }
        if !self.at(TokenKind::LeftParen) {
            return Err(self.unexpected("`(`"));
        }
        self.optional_class_modification(Place::Elsewhere)
    }

    /// A description and an annotation, if there.
    pub(super) fn comment(&mut self) -> Parse<(Option<Box<str>>, Option<Modification>)> {
        Ok((self.description(), self.annotation()?))
    }
}
