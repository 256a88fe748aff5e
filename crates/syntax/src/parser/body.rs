//! The sections of a long class, and its end.

use super::{Open, OpenKind, Parse, Parser, is_class_keyword};
use crate::ast::{Class, ClassBody, ClassKind, Ident, LongBody, Modification, Prefixes};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

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
    /// Set by a declaration in an equation section, for which the section is blamed once.
    misplaced: bool,
    annotation: Option<Modification>,
    /// Where the annotation stands, until something after it is blamed.
    annotated: Option<Span>,
}

impl Parser<'_> {
    /// From the description of a long class on.
    pub(super) fn long_class(
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
        let mut body = Body {
            out,
            section: Section::Elements,
            protected: false,
            misplaced: false,
            annotation: None,
            annotated: None,
        };
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
        let is_block = matches!(self.peek_kind(1), If | For | When | While);
        self.at(TokenKind::End) && self.is_closing_end() && !is_block
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
        if self.word(found) == name.name.as_str() {
            self.misnested = false;
        } else if self.is_open_class(self.word(found)) {
            return self.unclosed(open);
        } else {
            self.wrong_end(open);
        }
        self.bump();
        self.bump();
    }

    /// A section keyword, or one element, equation or statement with its semicolon.
    fn section_or_item(&mut self, body: &mut Body) -> Parse<()> {
        self.check_annotation_is_last(body);
        let before = body.section;
        let result = self.section_keyword_or_item(body);
        body.misplaced &= body.section == before;
        result
    }

    fn section_keyword_or_item(&mut self, body: &mut Body) -> Parse<()> {
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
            self.blame_declaration(body);
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

    fn blame_declaration(&mut self, body: &mut Body) {
        if !std::mem::replace(&mut body.misplaced, true) {
            let rule =
                "a declaration stands before the first `equation` or `algorithm`, or after `public` or `protected`";
            self.slip(rule, "a declaration in an equation section", "move it up, or write `public` before it");
        }
    }

    /// Reports and passes over `end if`, `else` and the like where nothing of the kind is open.
    fn stray_word(&mut self) -> bool {
        use TokenKind as T;
        let block = match self.kind() {
            T::End => return self.stray_end(),
            T::Else | T::Elseif | T::Then => "if",
            T::Elsewhen => "when",
            T::Loop => "for` or `while",
            _ => return false,
        };
        self.blame_stray(self.word(self.token()), block);
        self.bump();
        true
    }

    fn stray_end(&mut self) -> bool {
        if self.is_closing_end() {
            let block = self.word(self.peek(1));
            self.blame_stray(&format!("end {block}"), block);
            self.bump();
        } else {
            let help = "a class ends with its name, a block with its first word: `end A`, `end if`";
            self.slip("an `end` that closes nothing", "closes nothing", help);
        }
        self.bump();
        self.eat(TokenKind::Semicolon);
        true
    }

    fn blame_stray(&mut self, word: &str, block: &str) {
        let help = format!("leave out `{word}`, or look for an `end` too many above");
        let diagnostic = Diagnostic::new(Code::Syntax, format!("`{word}` without `{block}`"))
            .at(self.span(), "nothing of the kind is open here")
            .help(help);
        self.report_end(diagnostic);
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
