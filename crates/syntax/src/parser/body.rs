//! The body of a long class: its sections, their items, and the `end` that closes it.
//! `class::class_definition` calls [`long_class`] after the name of the class.
//!
//! Elements go to one list, equations to one list for each kind of section, and algorithms keep their sections,
//! because the order of statements counts only within a section (Modelica 3.6, section 11.1).
//! Items in the wrong section are reported and still become part of the tree.

use super::{
    OpenBlock, OpenBlockKind, ParseResult, Parser, element, equation, expr, is_class_keyword, modification, statement,
};
use crate::ast::{Class, ClassBody, ClassKind, ElementPrefixes, Ident, LongBody, Modification};
use crate::diag::{Code, Diagnostic, Span};
use crate::token::TokenKind;

/// The kind of section that the cursor is in.
/// Each section keyword changes it; `public` and `protected` return to elements.
#[derive(Clone, Copy, PartialEq)]
enum SectionKind {
    /// `public`, `protected`, or the part before the first section keyword.
    Elements,
    /// `equation` or `initial equation`.
    Equations { initial: bool },
    /// `algorithm` or `initial algorithm`.
    Algorithm { initial: bool },
}

/// A long class while its body is parsed.
/// [`long_class`] turns it into a [`Class`] at the end.
struct LongBodyBuilder {
    /// What has been parsed so far.
    out: LongBody,
    /// The section that the next item belongs to.
    section: SectionKind,
    /// True in a `protected` section.
    protected: bool,
    /// Set by a declaration in an equation or algorithm section, so that such declarations are reported once a section.
    misplaced: bool,
    /// The annotations of the class; those after the first are appended to it.
    annotation: Option<Modification>,
    /// Where the annotation stands. `None` before there is one, and again after a message that it is not last.
    annotated: Option<Span>,
}

/// Parses a long class from its description on, `end` and name included.
/// `start` is where the class began; `class_extends` is as in [`LongBody`].
/// An unclosed or wrongly closed class still gives a tree.
/// Production: `long-class-specifier = IDENT description-string composition "end" IDENT`, from the description on.
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
        // A token that no item consumes must be skipped here, or the loop would not end.
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

/// True at an `end` that closes a class; false at a stray `end if` or the like, which is reported as an item.
fn at_class_end(p: &Parser<'_>) -> bool {
    use TokenKind::{For, If, When, While};
    let is_block = matches!(p.peek_kind(1), If | For | When | While);
    p.at(TokenKind::End) && p.is_closing_end() && !is_block
}

/// The `end Name` of a class, with messages about what stands there instead.
/// `open` is the class, whose place the messages show; `name` is the name that must follow.
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
        // The name belongs to an enclosing class: that `end` stays for it, and this class is the unclosed one.
        return p.unclosed(open);
    } else {
        p.wrong_end(open);
    }
    p.bump();
    p.bump();
}

/// A section keyword, an annotation, or an item with its semicolon.
/// A keyword after a class annotation, or any item, makes the annotation misplaced.
fn section_or_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    check_annotation_is_last(p, body);
    let before = body.section;
    let result = section_keyword_or_item(p, body);
    // A new section may be blamed again for its first misplaced declaration.
    body.misplaced &= body.section == before;
    result
}

/// The same, without the checks of what came before.
/// An item of another section is reported by [`item`].
fn section_keyword_or_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    match p.kind() {
        // `public` and `protected` also end an equation or algorithm section.
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

/// Begins the section whose keyword is at the cursor.
/// `initial` is true after the keyword `initial`.
fn enter_section(p: &mut Parser<'_>, body: &mut LongBodyBuilder, initial: bool) {
    if p.at(TokenKind::Equation) {
        body.section = SectionKind::Equations { initial };
    } else {
        body.section = SectionKind::Algorithm { initial };
        let sections = if initial { &mut body.out.initial_algorithms } else { &mut body.out.algorithms };
        // Each `algorithm` keyword begins a section of its own; equation sections are joined.
        sections.push(Vec::new());
    }
    p.bump();
}

/// An element, or all equations or statements up to the next section or stray word.
/// Sections are parsed as lists, so that one call usually takes all equations or statements of a section.
///
/// # Errors
/// The item could not be parsed; the caller recovers to the next one.
fn item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    if stray_word(p) || p.stray_semicolon() {
        return Ok(());
    }
    // Reported, then read as a declaration: its names are used elsewhere and would seem unknown.
    if body.section != SectionKind::Elements && begins_declaration(p) {
        blame_declaration(p, body);
        return element_item(p, body);
    }
    // An equation among the declarations: the section keyword was forgotten, and is assumed from here on.
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
                // A forgotten `algorithm` keyword has begun no section yet.
                None => sections.push(statements),
            }
        }
    }
    Ok(())
}

/// A declaration, import, `extends` or nested class, with its semicolon.
/// It is added to the list of elements with the visibility of the current section.
fn element_item(p: &mut Parser<'_>, body: &mut LongBodyBuilder) -> ParseResult<()> {
    element::element(p, body.protected, &mut body.out.elements)?;
    p.semicolon()
}

/// Reports a declaration in an equation or algorithm section, once for each section.
/// Later declarations of the same section are accepted silently.
fn blame_declaration(p: &mut Parser<'_>, body: &mut LongBodyBuilder) {
    if !std::mem::replace(&mut body.misplaced, true) {
        let rule = "a declaration stands before the first `equation` or `algorithm`, or after `public` or `protected`";
        p.slip(rule, "a declaration in an equation section", "move it up, or write `public` before it");
    }
}

/// Reports and skips a word such as `end if` or `else` that belongs to no open block. False if there is none.
/// The word is skipped, because no item can begin with it.
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

/// Reports and skips an `end` that closes nothing, with its word and semicolon.
/// An `end` that no class or block waits for is left over after an earlier mistake, or is one too many.
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

/// Reports `word`, which belongs to a `block` that is not open.
/// The error counts as one about an `end`, of which each class has one only.
fn blame_stray(p: &mut Parser<'_>, word: &str, block: &str) {
    let help = format!("leave out `{word}`, or look for an `end` too many above");
    let diagnostic = Diagnostic::new(Code::Syntax, format!("`{word}` without `{block}`"))
        .at(p.span(), "nothing of the kind is open here")
        .help(help);
    p.report_end(diagnostic);
}

/// True at a token that begins a declaration and cannot begin an equation or statement.
/// Components without a prefix, such as `Real x`, are not recognised.
fn begins_declaration(p: &Parser<'_>) -> bool {
    use TokenKind as T;
    matches!(p.kind(), T::Import | T::Extends | T::Parameter | T::Constant)
        || is_class_keyword(p.kind()) && p.starts_class()
}

/// Recognises an equation or statement among the declarations, and reports the missing section keyword.
/// Gives the section meant; `None` at a declaration.
/// For example `x = 1` or `connect(a, b)` before the keyword `equation`.
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

/// An annotation of the class, with its semicolon. Several annotations are merged.
/// The span of the first keyword is kept until something follows it.
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

/// Reports an annotation that something follows: the grammar has it at the end of a class.
fn check_annotation_is_last(p: &mut Parser<'_>, body: &mut LongBodyBuilder) {
    // Taken out, so that the message comes once.
    if let Some(span) = body.annotated.take() {
        let diagnostic = Diagnostic::new(Code::Syntax, "the annotation of a class stands at its end")
            .at(span, "something follows this annotation")
            .help("move it directly before `end`");
        p.report(diagnostic);
    }
}

/// The external function interface, `external "C" y = f(x) annotation(...);` (Modelica 3.6, section 12.9).
/// The text between keyword and semicolon is kept as written; the crate `model` reads the call from it.
/// Language name, call and annotation are all optional.
fn external(p: &mut Parser<'_>, out: &mut LongBody) -> ParseResult<()> {
    let start = p.span();
    p.bump();
    let inner = p.token().start;
    if p.at(TokenKind::String) {
        p.bump();
    }
    if !matches!(p.kind(), TokenKind::Semicolon | TokenKind::Annotation) {
        // Parsed only for its errors: the tree holds the text.
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
