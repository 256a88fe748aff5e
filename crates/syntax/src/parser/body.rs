//! The sections of a long class, and its end.

use super::{
    OpenBlock, OpenBlockKind, ParseResult, Parser, element, equation, expr, is_class_keyword, modification, statement,
};
use crate::ast::{Class, ClassBody, ClassKind, ElementPrefixes, Ident, LongBody, Modification};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

/// Which kind of section of a class we are in.
#[derive(Clone, Copy, PartialEq)]
enum SectionKind {
    Elements,
    Equations { initial: bool },
    Algorithm { initial: bool },
}

/// A long class while its body is read.
struct LongBodyBuilder {
    out: LongBody,
    section: SectionKind,
    protected: bool,
    /// Set by a declaration in an equation section, for which the section is blamed once.
    misplaced: bool,
    annotation: Option<Modification>,
    /// Where the annotation stands, until something after it is blamed.
    annotated: Option<Span>,
}

/// From the description of a long class on.
pub(super) fn long_class(
    p: &mut Parser<'_>,
    start: Span,
    kind: ClassKind,
    prefixes: ElementPrefixes,
    name: Ident,
    class_extends: Option<Option<Modification>>,
) -> ParseResult<Box<Class>> {
    let description = modification::description(p);
    let open = OpenBlock { kind: OpenBlockKind::Class(name.name), span: name.span, else_if: None };
    let out = LongBody { class_extends, ..LongBody::default() };
    let mut body = LongBodyBuilder {
        out,
        section: SectionKind::Elements,
        protected: false,
        misplaced: false,
        annotation: None,
        annotated: None,
    };
    p.open.push(open);
    while !p.at(TokenKind::Eof) && !at_class_end(p) {
        let before = p.at;
        if section_or_item(p, &mut body).is_err() {
            p.recover();
        }
        if p.at == before {
            p.bump();
        }
    }
    p.open.pop();
    class_end(p, open, name);
    let span = p.since(start);
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
fn at_class_end(p: &Parser<'_>) -> bool {
    use TokenKind::{For, If, When, While};
    let is_block = matches!(p.peek_kind(1), If | For | When | While);
    p.at(TokenKind::End) && p.is_closing_end() && !is_block
}

fn class_end(p: &mut Parser<'_>, open: OpenBlock, name: Ident) {
    let found = p.peek(1);
    if p.at(TokenKind::Eof) {
        return p.unclosed(open);
    }
    if found.kind != TokenKind::Ident {
        p.wrong_end(open);
        return p.bump();
    }
    if p.word(found) == name.name.as_str() {
        p.misnested = false;
    } else if p.is_open_class(p.word(found)) {
        return p.unclosed(open);
    } else {
        p.wrong_end(open);
    }
    p.bump();
    p.bump();
}

/// A section keyword, or one element, equation or statement with its semicolon.
fn section_or_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    check_annotation_is_last(p, body);
    let before = body.section;
    let result = section_keyword_or_item(p, body);
    body.misplaced &= body.section == before;
    result
}

fn section_keyword_or_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    match p.kind() {
        TokenKind::Public | TokenKind::Protected => {
            body.protected = p.at(TokenKind::Protected);
            body.section = SectionKind::Elements;
            p.bump();
        }
        TokenKind::Initial if matches!(p.peek_kind(1), TokenKind::Equation | TokenKind::Algorithm) => {
            p.bump();
            enter_section(p, body, true);
        }
        TokenKind::Equation | TokenKind::Algorithm => enter_section(p, body, false),
        TokenKind::External => return external(p, &mut body.out),
        TokenKind::Annotation => return class_annotation(p, body),
        _ => return item(p, body),
    }
    Ok(())
}

fn enter_section(p: &mut Parser<'_>, body: &mut LongBodyBuilder, initial: bool) {
    if p.at(TokenKind::Equation) {
        body.section = SectionKind::Equations { initial };
    } else {
        body.section = SectionKind::Algorithm { initial };
        let sections = if initial { &mut body.out.initial_algorithms } else { &mut body.out.algorithms };
        sections.push(Vec::new());
    }
    p.bump();
}

fn item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    if stray_word(p) || p.stray_semicolon() {
        return Ok(());
    }
    if body.section != SectionKind::Elements && begins_declaration(p) {
        blame_declaration(p, body);
        return element_item(p, body);
    }
    if body.section == SectionKind::Elements {
        body.section = forgotten_section(p).unwrap_or(SectionKind::Elements);
    }
    match body.section {
        SectionKind::Elements => element_item(p, body)?,
        SectionKind::Equations { initial } => {
            let equations = p.list(equation::equation);
            let all = if initial { &mut body.out.initial_equations } else { &mut body.out.equations };
            all.extend(equations);
        }
        SectionKind::Algorithm { initial } => {
            let statements = p.list(statement::statement);
            let sections = if initial { &mut body.out.initial_algorithms } else { &mut body.out.algorithms };
            match sections.last_mut() {
                Some(last) => last.extend(statements),
                None => sections.push(statements),
            }
        }
    }
    Ok(())
}

fn element_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    element::element(p, body.protected, &mut body.out.elements)?;
    p.semicolon()
}

fn blame_declaration(p: &mut Parser<'_>, body: &mut LongBodyBuilder) {
    if !std::mem::replace(&mut body.misplaced, true) {
        let rule = "a declaration stands before the first `equation` or `algorithm`, or after `public` or `protected`";
        p.slip(rule, "a declaration in an equation section", "move it up, or write `public` before it");
    }
}

/// Reports and passes over `end if`, `else` and the like where nothing of the kind is open.
fn stray_word(p: &mut Parser<'_>) -> bool {
    use TokenKind as T;
    let block = match p.kind() {
        T::End => return stray_end(p),
        T::Else | T::Elseif | T::Then => "if",
        T::Elsewhen => "when",
        T::Loop => "for` or `while",
        _ => return false,
    };
    blame_stray(p, p.word(p.token()), block);
    p.bump();
    true
}

fn stray_end(p: &mut Parser<'_>) -> bool {
    if p.is_closing_end() {
        let block = p.word(p.peek(1));
        blame_stray(p, &format!("end {block}"), block);
        p.bump();
    } else {
        let help = "a class ends with its name, a block with its first word: `end A`, `end if`";
        p.slip("an `end` that closes nothing", "closes nothing", help);
    }
    p.bump();
    p.eat(TokenKind::Semicolon);
    true
}

fn blame_stray(p: &mut Parser<'_>, word: &str, block: &str) {
    let help = format!("leave out `{word}`, or look for an `end` too many above");
    let diagnostic = Diagnostic::new(Code::Syntax, format!("`{word}` without `{block}`"))
        .at(p.span(), "nothing of the kind is open here")
        .help(help);
    p.report_end(diagnostic);
}

fn begins_declaration(p: &Parser<'_>) -> bool {
    use TokenKind as T;
    matches!(p.kind(), T::Import | T::Extends | T::Parameter | T::Constant)
        || is_class_keyword(p.kind()) && p.starts_class()
}

/// Reports an equation or statement among the declarations; gives the section that was meant.
fn forgotten_section(p: &mut Parser<'_>) -> Option<SectionKind> {
    use TokenKind as T;
    let follows = p.peek_kind(1);
    let (section, keyword) = match p.kind() {
        T::Connect | T::If | T::For | T::When => (SectionKind::Equations { initial: false }, "equation"),
        T::Der if follows == T::LeftParen => (SectionKind::Equations { initial: false }, "equation"),
        T::Ident if follows == T::Equal || follows == T::LeftParen => {
            (SectionKind::Equations { initial: false }, "equation")
        }
        T::While => (SectionKind::Algorithm { initial: false }, "algorithm"),
        T::Ident if follows == T::Assign => (SectionKind::Algorithm { initial: false }, "algorithm"),
        _ => return None,
    };
    let found = p.describe(p.token());
    let message = format!("expected a declaration or `{keyword}`, found {found}");
    p.slip(message, &format!("`{keyword}` is missing before this"), format!("write `{keyword}` before it"));
    Some(section)
}

fn class_annotation(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    let span = p.span();
    if let Some(annotation) = modification::annotation(p)? {
        match &mut body.annotation {
            Some(first) => first.arguments.extend(annotation.arguments),
            None => body.annotation = Some(annotation),
        }
    }
    body.annotated = Some(span);
    p.semicolon()
}

fn check_annotation_is_last(p: &mut Parser<'_>, body: &mut LongBodyBuilder) {
    if let Some(span) = body.annotated.take() {
        let diagnostic = Diagnostic::new(Code::Syntax, "the annotation of a class stands at its end")
            .at(span, "something follows this annotation")
            .help("move it directly before `end`");
        p.report(diagnostic);
    }
}

/// `external "C" y = f(x) annotation(...);`
fn external(p: &mut Parser<'_>, out: &mut LongBody) -> ParseResult<()> {
    let start = p.span();
    p.bump();
    let inner = p.token().start;
    if p.at(TokenKind::String) {
        p.bump();
    }
    if !matches!(p.kind(), TokenKind::Semicolon | TokenKind::Annotation) {
        let call = expr::simple_expression(p)?;
        if p.eat(TokenKind::Equal) {
            expr::simple_expression(p)?;
        }
        drop(call);
    }
    modification::annotation(p)?;
    let end = p.previous().end.max(inner);
    out.external = Some(p.since(start));
    out.external_text = p.text.get(inner as usize..end as usize).map(Into::into);
    p.semicolon()
}
