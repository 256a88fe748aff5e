//! Elements of a class: imports, `extends`, components.

use super::modification::Place;
use super::{Parse, Parser, is_class_keyword};
use crate::ast::{
    Causality, Component, Constraint, Element, ElementKind, Extends, Ident, Import, Modification, Path, Prefixes,
    Subscript, TypePrefix, Variability,
};
use crate::diag::Span;
use crate::token::TokenKind;

/// What all components of one clause share.
struct Clause {
    start: Span,
    prefixes: Prefixes,
    prefix: TypePrefix,
    class: Path,
    subscripts: Vec<Subscript>,
}

impl Parser<'_> {
    /// One element, without its semicolon; a clause with several components gives several.
    pub(super) fn element(&mut self, protected: bool, elements: &mut Vec<Element>) -> Parse<()> {
        let start = self.span();
        let kind = match self.kind() {
            TokenKind::Import => ElementKind::Import(self.import()?),
            TokenKind::Extends => ElementKind::Extends(self.extends()?),
            _ => {
                let prefixes = self.prefixes();
                if !is_class_keyword(self.kind()) {
                    return self.component_clause(start, prefixes, protected, elements);
                }
                ElementKind::Class(self.replaceable_class(start, prefixes)?)
            }
        };
        elements.push(Element { protected, kind, span: self.since(start) });
        Ok(())
    }

    // Imports and extends.

    fn import(&mut self) -> Parse<Import> {
        self.bump();
        if self.at(TokenKind::Ident) && self.peek_kind(1) == TokenKind::Equal {
            let alias = Some(self.ident("a name")?);
            self.bump();
            let import = Import::Single { alias, path: self.path("the name of a class")? };
            self.comment()?;
            return Ok(import);
        }
        let path = self.path("the name of a class or package")?;
        let import = match self.kind() {
            TokenKind::DotStar => {
                self.bump();
                Import::All(path)
            }
            TokenKind::Dot if self.peek_kind(1) == TokenKind::Star => {
                self.bump();
                self.bump();
                Import::All(path)
            }
            TokenKind::Dot if self.peek_kind(1) == TokenKind::LeftBrace => {
                self.bump();
                Import::Some(path, self.import_list()?)
            }
            TokenKind::Dot => {
                self.bump();
                return Err(self.unexpected("a name, `*` or `{`"));
            }
            _ => Import::Single { alias: None, path },
        };
        self.comment()?;
        Ok(import)
    }

    fn import_list(&mut self) -> Parse<Vec<Ident>> {
        let opened = self.span();
        self.bump();
        let mut names = vec![self.ident("a name")?];
        while self.eat(TokenKind::Comma) {
            names.push(self.ident("a name")?);
        }
        self.close(TokenKind::RightBrace, opened, "`,` or `}`")?;
        Ok(names)
    }

    fn extends(&mut self) -> Parse<Extends> {
        self.bump();
        let base = self.path("the name of a class")?;
        let modification = self.optional_class_modification(Place::Extends)?;
        self.annotation()?;
        Ok(Extends { base, modification })
    }

    // Prefixes.

    /// `redeclare final inner outer replaceable`, which have this order.
    fn prefixes(&mut self) -> Prefixes {
        let mut prefixes = Prefixes::default();
        let mut last = 0;
        loop {
            let (rank, flag) = match self.kind() {
                TokenKind::Redeclare => (1, &mut prefixes.redeclare),
                TokenKind::Final => (2, &mut prefixes.final_),
                TokenKind::Inner => (3, &mut prefixes.inner),
                TokenKind::Outer => (4, &mut prefixes.outer),
                TokenKind::Replaceable => (5, &mut prefixes.replaceable),
                _ => return prefixes,
            };
            *flag = true;
            self.check_order(rank, last);
            last = rank;
            self.bump();
        }
    }

    /// `flow parameter input` and the like, which have this order.
    pub(super) fn type_prefix(&mut self) -> TypePrefix {
        let mut prefix = TypePrefix::default();
        let mut last = 0;
        loop {
            let rank = match self.kind() {
                TokenKind::Flow | TokenKind::Stream => 1,
                TokenKind::Discrete | TokenKind::Parameter | TokenKind::Constant => 2,
                TokenKind::Input | TokenKind::Output => 3,
                _ => return prefix,
            };
            set_prefix(&mut prefix, self.kind());
            self.check_order(rank, last);
            last = rank;
            self.bump();
        }
    }

    fn check_order(&mut self, rank: u8, last: u8) {
        if rank > last {
            return;
        }
        let (word, before) = (self.word(self.token()), self.word(self.previous()));
        if rank == last {
            let message = format!("`{word}` cannot follow `{before}`");
            self.slip(message, "only one of them", format!("leave out `{word}` or `{before}`"));
        } else {
            let message = format!("`{word}` stands before `{before}`");
            self.slip(message, "in the wrong order", format!("write `{word} {before}`"));
        }
    }

    // Components.

    fn component_clause(
        &mut self,
        start: Span,
        prefixes: Prefixes,
        protected: bool,
        elements: &mut Vec<Element>,
    ) -> Parse<()> {
        let prefix = self.type_prefix();
        self.check_late_prefix();
        let class = self.path("a type or a keyword such as `parameter`, `model`, `equation`")?;
        let subscripts = self.optional_subscripts()?;
        let clause = Clause { start, prefixes, prefix, class, subscripts };
        let first = elements.len();
        loop {
            let start = if elements.len() == first { clause.start } else { self.span() };
            let component = self.component(&clause)?;
            let kind = ElementKind::Component(Box::new(component));
            elements.push(Element { protected, kind, span: self.since(start) });
            if !self.eat(TokenKind::Comma) {
                break;
            }
        }
        if let Some(constraint) = self.constraint()? {
            let (description, annotation) = self.comment()?;
            constrain(&mut elements[first..], &constraint, description.as_deref(), annotation.as_ref());
        }
        Ok(())
    }

    /// Reports `parameter final Real`, where `final` comes too late.
    fn check_late_prefix(&mut self) {
        use TokenKind::{Final, Inner, Outer, Redeclare, Replaceable};
        while matches!(self.kind(), Final | Inner | Outer | Redeclare | Replaceable) {
            let (word, before) = (self.word(self.token()), self.word(self.previous()));
            let message = format!("`{word}` stands before `{before}`");
            self.slip(message, "in the wrong order", format!("write `{word} {before}`"));
            self.bump();
        }
    }

    fn component(&mut self, clause: &Clause) -> Parse<Component> {
        let name = self.component_name()?;
        let mut subscripts = self.optional_subscripts()?;
        subscripts.extend(clause.subscripts.iter().cloned());
        let modification = self.modification()?;
        let condition = if self.eat(TokenKind::If) { Some(self.expression()?) } else { None };
        let (description, annotation) = self.comment()?;
        Ok(Component {
            name,
            prefixes: clause.prefixes,
            prefix: clause.prefix,
            class: clause.class.clone(),
            subscripts,
            modification,
            condition,
            constraint: None,
            description,
            annotation,
        })
    }

    fn component_name(&mut self) -> Parse<Ident> {
        if matches!(self.kind(), TokenKind::Equal | TokenKind::LeftParen | TokenKind::Dot) {
            let help = "equations stand after the keyword `equation`";
            return Err(self.unexpected_in_item("the name of a component", Some(help)));
        }
        if self.at(TokenKind::Semicolon) {
            return Err(self.unexpected_in_item("the name of a component", None));
        }
        self.ident("the name of a component")
    }

    /// `[3, :]`, if there.
    pub(super) fn optional_subscripts(&mut self) -> Parse<Vec<Subscript>> {
        if self.at(TokenKind::LeftBracket) { self.subscripts() } else { Ok(Vec::new()) }
    }
}

fn set_prefix(prefix: &mut TypePrefix, kind: TokenKind) {
    match kind {
        TokenKind::Flow => prefix.flow = true,
        TokenKind::Stream => prefix.stream = true,
        TokenKind::Discrete => prefix.variability = Some(Variability::Discrete),
        TokenKind::Parameter => prefix.variability = Some(Variability::Parameter),
        TokenKind::Constant => prefix.variability = Some(Variability::Constant),
        TokenKind::Input => prefix.causality = Some(Causality::Input),
        TokenKind::Output => prefix.causality = Some(Causality::Output),
        _ => {}
    }
}

/// Gives the components of a clause its constraint, and its description and annotation to those without one.
fn constrain(
    elements: &mut [Element],
    constraint: &Constraint,
    description: Option<&str>,
    annotation: Option<&Modification>,
) {
    for element in elements {
        if let ElementKind::Component(component) = &mut element.kind {
            component.constraint = Some(constraint.clone());
            if component.description.is_none() {
                component.description = description.map(Into::into);
            }
            if component.annotation.is_none() {
                component.annotation = annotation.cloned();
            }
        }
    }
}
