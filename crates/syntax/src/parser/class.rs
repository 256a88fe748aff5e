//! Files, and the heads and short forms of classes.

use super::modification::Place;
use super::{Parse, Parser, Stop, is_class_keyword};
use crate::ast::{Class, ClassBody, ClassKind, EnumLiteral, Ident, Path, Prefixes, StoredDefinition};
use crate::diag::Span;
use crate::token::TokenKind;

impl Parser<'_> {
    // Files.

    /// A whole file.
    pub fn stored_definition(&mut self) -> StoredDefinition {
        let mut file = StoredDefinition { within: self.within().ok().flatten(), classes: Vec::new() };
        while !self.at(TokenKind::Eof) {
            let before = self.at;
            match self.top_level_class() {
                Ok(class) => file.classes.push(*class),
                Err(Stop) => self.recover_to_class(),
            }
            if self.at == before {
                self.bump();
            }
        }
        file
    }

    fn within(&mut self) -> Parse<Option<Path>> {
        if !self.eat(TokenKind::Within) {
            return Ok(None);
        }
        let path = if self.at(TokenKind::Semicolon) { None } else { Some(self.path("the name of a package")?) };
        if self.semicolon().is_err() {
            self.recover_to_class();
        }
        Ok(path)
    }

    fn top_level_class(&mut self) -> Parse<Box<Class>> {
        let start = self.span();
        let final_ = self.eat(TokenKind::Final);
        if !is_class_keyword(self.kind()) {
            return Err(self.no_class());
        }
        let mut class = self.class(Prefixes { final_, ..Prefixes::default() })?;
        class.span = class.span.to(start);
        if self.semicolon().is_err() {
            self.recover_to_class();
        }
        Ok(class)
    }

    /// Skips to the next class; what lies between has no place in a file.
    fn recover_to_class(&mut self) {
        self.guessed = false;
        while !(self.at(TokenKind::Eof) || is_class_keyword(self.kind()) && self.starts_class()) {
            self.bump();
        }
    }

    // Heads.

    /// A class from `encapsulated`, `partial` or its keyword on.
    pub(super) fn class(&mut self, prefixes: Prefixes) -> Parse<Box<Class>> {
        self.nested(|p| p.class_definition(prefixes))
    }

    /// A class with what may follow it when it is replaceable.
    pub(super) fn replaceable_class(&mut self, start: Span, prefixes: Prefixes) -> Parse<Box<Class>> {
        let mut class = self.class(prefixes)?;
        if self.at(TokenKind::Constrainedby) {
            class.constraint = self.constraint()?;
            let (description, annotation) = self.comment()?;
            class.description = class.description.or(description);
            class.annotation = class.annotation.or(annotation);
        }
        class.span = class.span.to(start);
        Ok(class)
    }

    fn class_definition(&mut self, mut prefixes: Prefixes) -> Parse<Box<Class>> {
        let start = self.span();
        prefixes.encapsulated = self.eat(TokenKind::Encapsulated);
        prefixes.partial = self.eat(TokenKind::Partial);
        let (kind, keyword) = self.class_kind()?;
        if self.eat(TokenKind::Extends) {
            let name = self.ident("the name of the inherited class")?;
            let modification = self.optional_class_modification(Place::Extends)?;
            return self.long_class(start, kind, prefixes, name, Some(modification));
        }
        let name = self.class_name(keyword)?;
        if self.eat(TokenKind::Equal) {
            return self.short_class(start, kind, prefixes, name);
        }
        self.long_class(start, kind, prefixes, name, None)
    }

    /// The name of a class, which is missing when the next line is the declaration of a component.
    fn class_name(&mut self, keyword: &str) -> Parse<Ident> {
        let what = format!("the name of the {keyword}");
        let declares = matches!(
            self.peek_kind(2),
            TokenKind::Semicolon
                | TokenKind::Comma
                | TokenKind::Equal
                | TokenKind::LeftParen
                | TokenKind::String
                | TokenKind::If
                | TokenKind::Annotation
        );
        let named_type = self.at(TokenKind::Ident) && self.peek_kind(1) == TokenKind::Ident;
        let is_missing = self.is_on_new_line() && named_type && declares;
        if is_missing { Err(self.unexpected(&what)) } else { self.ident(&what) }
    }

    /// The specialised class, with its main keyword.
    fn class_kind(&mut self) -> Parse<(ClassKind, &'static str)> {
        let purity = match self.kind() {
            TokenKind::Pure => Some(true),
            TokenKind::Impure => Some(false),
            _ => None,
        };
        if purity.is_some() {
            self.bump();
        }
        let expandable = self.eat(TokenKind::Expandable);
        let operator = self.eat(TokenKind::Operator);
        let keyword = self.kind();
        let kind = match keyword {
            TokenKind::Function => ClassKind::Function { operator, purity },
            _ if purity.is_some() => return Err(self.unexpected("`function`")),
            TokenKind::Connector => ClassKind::Connector { expandable },
            _ if expandable => return Err(self.unexpected("`connector`")),
            TokenKind::Record => ClassKind::Record { operator },
            _ if operator => return Ok((ClassKind::Operator, "operator")),
            TokenKind::Class => ClassKind::Class,
            TokenKind::Model => ClassKind::Model,
            TokenKind::Block => ClassKind::Block,
            TokenKind::Type => ClassKind::Type,
            TokenKind::Package => ClassKind::Package,
            _ => return Err(self.unexpected("the kind of a class, such as `model`")),
        };
        self.bump();
        Ok((kind, keyword.spelling().unwrap_or("class")))
    }

    // The short forms.

    fn short_class(&mut self, start: Span, kind: ClassKind, prefixes: Prefixes, name: Ident) -> Parse<Box<Class>> {
        let body = match self.kind() {
            TokenKind::Enumeration => self.enumeration()?,
            TokenKind::Der => self.derivative()?,
            _ => self.short_body()?,
        };
        let (description, annotation) = self.comment()?;
        let span = self.since(start);
        Ok(Box::new(Class { name, kind, prefixes, constraint: None, body, description, annotation, span }))
    }

    fn short_body(&mut self) -> Parse<ClassBody> {
        let prefix = self.type_prefix();
        let base = self.path("the name of a class")?;
        let subscripts = self.optional_subscripts()?;
        let modification = self.optional_class_modification(Place::Elsewhere)?;
        Ok(ClassBody::Short { prefix, base, subscripts, modification })
    }

    /// `enumeration(a, b "text")` or `enumeration(:)`.
    fn enumeration(&mut self) -> Parse<ClassBody> {
        self.bump();
        let opened = self.expect(TokenKind::LeftParen)?;
        let mut literals = Vec::new();
        let open_ended = self.eat(TokenKind::Colon);
        if !open_ended && !self.at(TokenKind::RightParen) {
            literals.push(self.literal()?);
            while self.eat(TokenKind::Comma) {
                literals.push(self.literal()?);
            }
        }
        self.close(TokenKind::RightParen, opened, "`,` or `)`")?;
        Ok(ClassBody::Enumeration((!open_ended).then_some(literals)))
    }

    fn literal(&mut self) -> Parse<EnumLiteral> {
        let name = self.ident("the name of a literal")?;
        let (description, _) = self.comment()?;
        Ok(EnumLiteral { name, description })
    }

    /// `der(f, x, y)`.
    fn derivative(&mut self) -> Parse<ClassBody> {
        self.bump();
        let opened = self.expect(TokenKind::LeftParen)?;
        let function = self.path("the name of a function")?;
        let mut by = Vec::new();
        while self.eat(TokenKind::Comma) {
            by.push(self.ident("the name of an input")?);
        }
        if by.is_empty() {
            return Err(self.unexpected("`,` and the name of an input"));
        }
        self.close(TokenKind::RightParen, opened, "`,` or `)`")?;
        Ok(ClassBody::Derivative { function, by })
    }
}
