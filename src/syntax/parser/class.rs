//! Files and classes: the heads of all kinds of classes, and the sections of a long one.

use super::modification::Place;
use super::{Open, OpenKind, Parse, Parser, Stop, is_class_keyword};
use crate::diag::{Code, Diagnostic, Span};
use crate::syntax::ast::{
    Class, ClassBody, ClassKind, EnumLiteral, Ident, LongBody, Modification, Path, Prefixes, StoredDefinition,
};
use crate::syntax::token::TokenKind;

/// Which kind of section of a class we are in.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    Elements,
    Equations { initial: bool },
    Algorithm { initial: bool },
}

/// A long class while its body is read.
struct Body {
    out: LongBody,
    section: Section,
    protected: bool,
    annotation: Option<Modification>,
    /// Where the annotation stands, until something after it is blamed.
    annotated: Option<Span>,
}

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

    /// The name of a class, which is missing when the next line begins with two names.
    fn class_name(&mut self, keyword: &str) -> Parse<Ident> {
        let what = format!("the name of the {keyword}");
        let is_missing = self.is_on_new_line() && self.at(TokenKind::Ident) && self.peek_kind(1) == TokenKind::Ident;
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

    // The long form.

    fn long_class(
        &mut self,
        start: Span,
        kind: ClassKind,
        prefixes: Prefixes,
        name: Ident,
        class_extends: Option<Option<Modification>>,
    ) -> Parse<Box<Class>> {
        let description = self.description();
        let open = Open { kind: OpenKind::Class(name.name), span: name.span, else_if: None };
        let out = LongBody { class_extends, ..LongBody::default() };
        let mut body = Body { out, section: Section::Elements, protected: false, annotation: None, annotated: None };
        self.open.push(open);
        while !self.at(TokenKind::Eof) && !self.at_class_end() {
            let before = self.at;
            if self.section_or_item(&mut body).is_err() {
                self.recover();
            }
            if self.at == before {
                self.bump();
            }
        }
        self.open.pop();
        self.class_end(open, name);
        let span = self.since(start);
        let annotation = body.annotation;
        Ok(Box::new(Class {
            name,
            kind,
            prefixes,
            constraint: None,
            body: ClassBody::Long(body.out),
            description,
            annotation,
            span,
        }))
    }

    /// At an `end` that is not a stray `end if` or the like.
    fn at_class_end(&self) -> bool {
        use TokenKind::{For, If, When, While};
        self.at(TokenKind::End) && !matches!(self.peek_kind(1), If | For | When | While)
    }

    fn class_end(&mut self, open: Open, name: Ident) {
        let found = self.peek(1);
        if self.at(TokenKind::Eof) {
            return self.unclosed(open);
        }
        if found.kind != TokenKind::Ident {
            self.wrong_end(open);
            return self.bump();
        }
        if self.word(found) != name.name.as_str() {
            let outer = self.ident_of(found).name;
            if self.open.iter().any(|open| open.kind == OpenKind::Class(outer)) {
                return self.unclosed(open);
            }
            self.wrong_end(open);
        }
        self.bump();
        self.bump();
    }

    /// A section keyword, or one element, equation or statement with its semicolon.
    fn section_or_item(&mut self, body: &mut Body) -> Parse<()> {
        self.check_annotation_is_last(body);
        match self.kind() {
            TokenKind::Public | TokenKind::Protected => {
                body.protected = self.at(TokenKind::Protected);
                body.section = Section::Elements;
                self.bump();
            }
            TokenKind::Initial if matches!(self.peek_kind(1), TokenKind::Equation | TokenKind::Algorithm) => {
                self.bump();
                self.enter_section(body, true);
            }
            TokenKind::Equation | TokenKind::Algorithm => self.enter_section(body, false),
            TokenKind::External => return self.external(&mut body.out),
            TokenKind::Annotation => return self.class_annotation(body),
            _ => return self.item(body),
        }
        Ok(())
    }

    fn enter_section(&mut self, body: &mut Body, initial: bool) {
        if self.at(TokenKind::Equation) {
            body.section = Section::Equations { initial };
        } else {
            body.section = Section::Algorithm { initial };
            let sections = if initial { &mut body.out.initial_algorithms } else { &mut body.out.algorithms };
            sections.push(Vec::new());
        }
        self.bump();
    }

    fn item(&mut self, body: &mut Body) -> Parse<()> {
        if self.stray_word() || self.stray_semicolon() {
            return Ok(());
        }
        if body.section != Section::Elements && self.begins_declaration() {
            self.slip(
                "a declaration stands before the first `equation` or `algorithm`, or after `public` or `protected`",
                "a declaration in an equation section",
                "move it up, or write `public` before it",
            );
            return self.element_item(body);
        }
        if body.section == Section::Elements {
            body.section = self.forgotten_section().unwrap_or(Section::Elements);
        }
        match body.section {
            Section::Elements => self.element_item(body)?,
            Section::Equations { initial } => {
                let equations = self.list(Self::equation);
                let all = if initial { &mut body.out.initial_equations } else { &mut body.out.equations };
                all.extend(equations);
            }
            Section::Algorithm { initial } => {
                let statements = self.list(Self::statement);
                let sections = if initial { &mut body.out.initial_algorithms } else { &mut body.out.algorithms };
                match sections.last_mut() {
                    Some(last) => last.extend(statements),
                    None => sections.push(statements),
                }
            }
        }
        Ok(())
    }

    fn element_item(&mut self, body: &mut Body) -> Parse<()> {
        self.element(body.protected, &mut body.out.elements)?;
        self.semicolon()
    }

    /// Reports and passes over `end if`, `else` and the like where nothing of the kind is open.
    fn stray_word(&mut self) -> bool {
        use TokenKind as T;
        let block = match self.kind() {
            T::End => self.word(self.peek(1)),
            T::Else | T::Elseif | T::Then => "if",
            T::Elsewhen => "when",
            T::Loop => "for` or `while",
            _ => return false,
        };
        let is_end = self.at(T::End);
        let word = self.word(self.token());
        let word = if is_end { format!("{word} {block}") } else { word.to_owned() };
        self.slip(
            format!("`{word}` without `{block}`"),
            "nothing of the kind is open here",
            format!("leave out `{word}`, or look for an `end {block}` too many above"),
        );
        self.bump();
        if is_end {
            self.bump();
            self.eat(T::Semicolon);
        }
        true
    }

    fn begins_declaration(&self) -> bool {
        use TokenKind as T;
        matches!(self.kind(), T::Import | T::Extends | T::Parameter | T::Constant)
            || is_class_keyword(self.kind()) && self.starts_class()
    }

    /// Reports an equation or statement among the declarations; gives the section that was meant.
    fn forgotten_section(&mut self) -> Option<Section> {
        use TokenKind as T;
        let follows = self.peek_kind(1);
        let (section, keyword) = match self.kind() {
            T::Connect | T::If | T::For | T::When => (Section::Equations { initial: false }, "equation"),
            T::Der if follows == T::LeftParen => (Section::Equations { initial: false }, "equation"),
            T::Ident if follows == T::Equal || follows == T::LeftParen => {
                (Section::Equations { initial: false }, "equation")
            }
            T::While => (Section::Algorithm { initial: false }, "algorithm"),
            T::Ident if follows == T::Assign => (Section::Algorithm { initial: false }, "algorithm"),
            _ => return None,
        };
        let found = self.describe(self.token());
        let message = format!("expected a declaration or `{keyword}`, found {found}");
        self.slip(message, &format!("`{keyword}` is missing before this"), format!("write `{keyword}` before it"));
        Some(section)
    }

    fn class_annotation(&mut self, body: &mut Body) -> Parse<()> {
        let span = self.span();
        if let Some(annotation) = self.annotation()? {
            match &mut body.annotation {
                Some(first) => first.arguments.extend(annotation.arguments),
                None => body.annotation = Some(annotation),
            }
        }
        body.annotated = Some(span);
        self.semicolon()
    }

    fn check_annotation_is_last(&mut self, body: &mut Body) {
        if let Some(span) = body.annotated.take() {
            let diagnostic = Diagnostic::new(Code::Syntax, "the annotation of a class stands at its end")
                .at(span, "something follows this annotation")
                .help("move it directly before `end`");
            self.report(diagnostic);
        }
    }

    /// `external "C" y = f(x) annotation(...);`
    fn external(&mut self, out: &mut LongBody) -> Parse<()> {
        let start = self.span();
        self.bump();
        let inner = self.token().start;
        if self.at(TokenKind::String) {
            self.bump();
        }
        if !matches!(self.kind(), TokenKind::Semicolon | TokenKind::Annotation) {
            let call = self.simple_expression()?;
            if self.eat(TokenKind::Equal) {
                self.simple_expression()?;
            }
            drop(call);
        }
        self.annotation()?;
        let end = self.previous().end.max(inner);
        out.external = Some(self.since(start));
        out.external_text = self.text.get(inner as usize..end as usize).map(Into::into);
        self.semicolon()
    }
}
