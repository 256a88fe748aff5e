//! Completion: what may be written at a byte offset.
//!
//! A text that is being written does not parse. So the tokens before the offset are read instead of a syntax tree:
//! `CompletionContext` notes the begun word, the dotted names before it and the open brackets. Classes and elements
//! are then looked up in the library.
//!
//! `signature` and `hover` use the same context.

use super::{DocumentView, words};
use bramah_model::resolve::names::{self, MemberComponent, NameTarget};
use bramah_model::resolve::{ClassId, Library};
use bramah_syntax::ast::{ClassKind, VariabilityPrefix};
use bramah_syntax::diag::FileId;
use bramah_syntax::lexer::lex;
use bramah_syntax::symbol::Symbol;
use bramah_syntax::token::{Token, TokenKind};
use lsp_types::{CompletionItem, CompletionItemKind, Documentation, MarkupContent, MarkupKind};

/// Units that are offered in the strings of `unit` and `displayUnit`.
pub const UNITS: [&str; 40] = [
    "Pa", "bar", "MPa", "m3/s", "l/min", "m3", "l", "ml", "rad/s", "rev/min", "rad", "deg", "m", "mm", "um", "m/s",
    "mm/s", "m/s2", "N", "kN", "N.m", "kg", "kg.m2", "kg/m3", "s", "ms", "Hz", "W", "kW", "J", "K", "degC", "V", "A",
    "Ohm", "H", "F", "W/K", "J/K", "1",
];

/// Attributes of the built-in types with their descriptions.
const ATTRIBUTES: [(&str, &str); 9] = [
    ("start", "Value at the start"),
    ("fixed", "true: the start value holds at the start"),
    ("min", "Least value"),
    ("max", "Greatest value"),
    ("nominal", "Usual size, for tolerances"),
    ("unit", "Unit of the value"),
    ("displayUnit", "Unit in which it is shown"),
    ("quantity", "Kind of quantity"),
    ("stateSelect", "Whether it should be a state"),
];

/// Keywords that may begin an element.
const ELEMENT_WORDS: [&str; 18] = [
    "parameter",
    "constant",
    "input",
    "output",
    "inner",
    "outer",
    "extends",
    "import",
    "model",
    "function",
    "type",
    "replaceable",
    "final",
    "protected",
    "equation",
    "algorithm",
    "initial equation",
    "annotation",
];
/// Keywords that may begin an equation.
const EQUATION_WORDS: [&str; 11] =
    ["connect", "if", "for", "when", "elsewhen", "else", "end", "initial equation", "algorithm", "assert", "reinit"];
/// Keywords and functions in an expression.
///
/// Functions of the library are offered as classes instead.
const EXPRESSION_WORDS: [&str; 24] = [
    "der", "if", "then", "else", "and", "or", "not", "time", "true", "false", "pre", "initial", "noEvent", "smooth",
    "sqrt", "abs", "sign", "sin", "cos", "exp", "log", "min", "max", "sum",
];

/// What the tokens before a byte offset say about the place.
#[derive(Debug, Default)]
pub(super) struct CompletionContext {
    /// The part of a word between its start and the offset; empty when no word has been begun.
    pub prefix: String,
    /// The names before the word that are joined to it by dots: `a` and `b` in `a.b.`.
    pub chain: Vec<String>,
    /// The open brackets of the present statement, outermost first.
    pub calls: Vec<BracketContext>,
    /// Whether the offset is in code, a comment or a string.
    place: LexicalRegion,
    /// The section of the class.
    section: CompletionSection,
    /// The statement has nothing but prefixes before the word.
    begins: bool,
    /// The argument of the innermost bracket has nothing before the word.
    begins_argument: bool,
}

/// An open round bracket.
#[derive(Debug)]
pub(super) struct BracketContext {
    /// What it belongs to.
    head: BracketHead,
    /// Number of commas in it so far, which is the index of the present argument.
    pub commas: usize,
    /// The name before `=` in the present argument; `None` when there is no `=`.
    pub named: Option<String>,
}

/// What an open bracket belongs to. Paths are dotted names as lists.
#[derive(Clone, Debug, PartialEq)]
enum BracketHead {
    /// The modification of a declared component, `Type name(`: its type and its name.
    Element(Vec<String>, String),
    /// The modification of a class, `extends Path(` or `model M = Path(`.
    Type(Vec<String>),
    /// The modification of an element inside another modification, `name(`.
    Inner(Vec<String>),
    /// The arguments of a function, `f(`.
    Function(Vec<String>),
    /// The ends of a connection, `connect(`.
    Connect,
    /// An annotation or an expression in brackets.
    Other,
}

/// The lexical kind of the place.
#[derive(Debug, Default, PartialEq)]
enum LexicalRegion {
    /// Outside comments and strings.
    #[default]
    Code,
    /// Inside a comment.
    Comment,
    /// Inside a string. Holds the name before `=`, such as `unit`, if there is one.
    Text(Option<String>),
}

/// The section of a class, which decides the keywords that are offered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum CompletionSection {
    /// Declarations of components and classes.
    #[default]
    Elements,
    /// Equations or statements.
    Equations,
}

impl CompletionContext {
    /// Reads the tokens before a byte offset.
    ///
    /// The word under construction and the names joined to it by dots are taken off the end. What remains is read from
    /// the start of the text to find the section, the statement and its open brackets.
    pub fn at(text: &str, offset: u32) -> CompletionContext {
        // The text after the offset does not matter, but a string or word may reach over it.
        let all = lex(FileId(0), text).tokens;
        let before = all.partition_point(|t| t.start < offset && t.kind != TokenKind::Eof);
        let mut tokens = all[..before].to_vec();
        let mut context = CompletionContext::default();
        match tokens.last().copied() {
            // The offset is inside a complete string.
            Some(last) if last.kind == TokenKind::String && offset < last.end => {
                tokens.pop();
                context.place = LexicalRegion::Text(named_before(text, &tokens));
            }
            // The offset is in or at the end of a word.
            Some(last) if last.end >= offset && (last.kind == TokenKind::Ident || last.kind.is_keyword()) => {
                context.prefix = text[last.start as usize..offset as usize].to_owned();
                tokens.pop();
            }
            // Comments are no tokens, and neither is a string without its end. Both are found in the text after the
            // last token.
            last => {
                let gap = &text[last.map_or(0, |t| t.end as usize).min(offset as usize)..offset as usize];
                let line = gap.rsplit('\n').next().unwrap_or("");
                if line.contains("//") || gap.rfind("/*") > gap.rfind("*/") {
                    context.place = LexicalRegion::Comment;
                } else if gap.contains('"') {
                    context.place = LexicalRegion::Text(named_before(text, &tokens));
                }
            }
        }
        // The names before a dot are taken off, so that the rest reads like the start of a name.
        while tokens.last().is_some_and(|t| t.kind == TokenKind::Dot) {
            tokens.pop();
            let (parts, rest) = chain_before(text, &tokens);
            tokens.truncate(rest);
            context.chain = parts;
        }
        context.read(text, &tokens);
        context
    }

    /// Reads brackets, section and the beginning of the statement from the tokens before the word.
    ///
    /// `start` is the index of the first token of the present statement, `argument` that of the first token of the
    /// present argument. Both move forward while the tokens are read.
    fn read(&mut self, text: &str, tokens: &[Token]) {
        let mut depth = 0;
        let (mut start, mut argument) = (0, 0);
        for (i, token) in tokens.iter().enumerate() {
            match token.kind {
                // The head of a bracket is known only from the tokens of its statement before it.
                TokenKind::LeftParen => {
                    let head = head(text, &tokens[start..i], self.calls.last().map(|c| &c.head));
                    self.calls.push(BracketContext { head, commas: 0, named: None });
                    argument = i + 1;
                }
                TokenKind::LeftBracket | TokenKind::LeftBrace => depth += 1,
                TokenKind::RightBracket | TokenKind::RightBrace => depth -= 1,
                TokenKind::RightParen => _ = self.calls.pop(),
                // Commas inside square or curly brackets do not separate arguments.
                TokenKind::Comma if depth <= 0 => {
                    if let Some(call) = self.calls.last_mut() {
                        call.commas += 1;
                        call.named = None;
                        argument = i + 1;
                    }
                }
                TokenKind::Equal => {
                    if let Some(call) = self.calls.last_mut() {
                        call.named = named_before(text, &tokens[..=i]);
                    }
                }
                // A semicolon ends everything: a bracket that is still open was forgotten by the user.
                TokenKind::Semicolon if self.calls.is_empty() || depth <= 0 => {
                    (start, depth) = (i + 1, 0);
                    self.calls.clear();
                }
                TokenKind::Equation | TokenKind::Algorithm => {
                    self.section = CompletionSection::Equations;
                    start = i + 1;
                }
                // Statements may follow these words as they follow a semicolon.
                TokenKind::Then | TokenKind::Loop | TokenKind::Else if self.calls.is_empty() => start = i + 1,
                TokenKind::Protected | TokenKind::Public => {
                    self.section = CompletionSection::Elements;
                    start = i + 1;
                }
                // After the end of a nested class, elements of the outer one may follow.
                TokenKind::End if i == start && tokens.get(i + 1).is_some_and(|t| t.kind == TokenKind::Ident) => {
                    self.section = CompletionSection::Elements;
                }
                _ if i == start && token.kind.is_class_word() => self.section = CompletionSection::Elements,
                _ => {}
            }
        }
        // After `model Name` and its description an element begins, although there is no semicolon.
        let rest = &tokens[start..];
        let header = matches!(rest, [class, name] if class.kind.is_class_word() && name.kind == TokenKind::Ident)
            || matches!(rest, [class, name, said] if class.kind.is_class_word() && name.kind == TokenKind::Ident && said.kind == TokenKind::String);
        self.begins = header || rest.iter().all(|t| is_prefix(t.kind));
        self.begins_argument =
            tokens[argument.min(tokens.len())..].iter().all(|t| matches!(t.kind, TokenKind::Each | TokenKind::Final));
    }

    /// The class whose elements are named in the innermost of the first `n` open brackets.
    ///
    /// An example: in `Pump pump(leak(`, `n` = 1 gives the class of `pump` and `n` = 2 the class of its element `leak`.
    ///
    /// For a function these are its arguments. `None`: it cannot be resolved, or the bracket names no elements.
    pub fn class_of(&self, library: &mut Library<'_>, scope: ClassId, n: usize) -> Option<ClassId> {
        match &self.calls.get(n.checked_sub(1)?)?.head {
            BracketHead::Element(path, _) | BracketHead::Type(path) => named(library, scope, path),
            BracketHead::Function(path) => {
                let target = meant(library, scope, path)?;
                names::inside(library, target)
            }
            // The element belongs to the class of the bracket around it.
            BracketHead::Inner(path) => {
                let around = self.class_of(library, scope, n - 1)?;
                let target = along(library, around, path)?;
                names::inside(library, target)
            }
            BracketHead::Connect | BracketHead::Other => None,
        }
    }

    /// Whether the name of an element to modify is expected: a modification is open and its argument has just begun.
    ///
    /// After `=` a value is expected instead, and expressions are completed.
    fn names_elements(&self) -> bool {
        let modifies = |c: &BracketContext| {
            matches!(c.head, BracketHead::Element(..) | BracketHead::Type(_) | BracketHead::Inner(_))
        };
        self.calls.last().is_some_and(modifies) && self.begins_argument
    }
}

/// The full name of the element whose name begins before and ends at or after a byte offset, as in the flat model.
///
/// An example: at `V` in `Pump pump(leak(V = 1))` it is `pump.leak.V`. This is the name by which `ParameterHints`
/// stores values.
///
/// `None`: there is no name at the offset.
pub(super) fn full_name_at(text: &str, offset: u32) -> Option<String> {
    let rest = &text[offset as usize..];
    let end = offset as usize + rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    let context = CompletionContext::at(text, end as u32);
    let mut parts: Vec<String> = Vec::new();
    // In a modification the names of the brackets around belong to the full name.
    if context.names_elements() {
        for call in &context.calls {
            match &call.head {
                BracketHead::Element(_, name) => parts.push(name.clone()),
                BracketHead::Inner(path) => parts.extend(path.clone()),
                _ => {}
            }
        }
    }
    parts.extend(context.chain);
    parts.push(context.prefix);
    (!parts.iter().any(String::is_empty)).then(|| parts.join("."))
}

/// The completions at a byte offset. Empty in comments, and in strings other than those of units.
///
/// The order of the checks: strings and comments, arguments of modifications, names after a dot, and last everything in
/// scope with the keywords.
///
/// Arguments of a call are completed with the inputs of the function besides everything in scope.
pub fn complete(view: &mut DocumentView<'_, '_>, offset: u32) -> Vec<CompletionItem> {
    let context = CompletionContext::at(&view.text, offset);
    match &context.place {
        LexicalRegion::Comment => return Vec::new(),
        LexicalRegion::Text(Some(name)) if name == "unit" || name == "displayUnit" => {
            return UNITS.iter().map(|u| plain(u, CompletionItemKind::UNIT)).collect();
        }
        LexicalRegion::Text(_) => return Vec::new(),
        LexicalRegion::Code => {}
    }
    // A text without any class still gets keywords.
    let Some(scope) = view.class_at(offset) else { return words_for(&context) };
    if context.names_elements() {
        return arguments(view, &context, scope);
    }
    let connects = context.calls.last().is_some_and(|c| c.head == BracketHead::Connect);
    if !context.chain.is_empty() {
        return members(view, &context, scope, connects);
    }
    let mut found = in_scope(view, scope, connects);
    // Inputs of a function may be given by name.
    if let Some(function) = context.class_of(view.library, scope, context.calls.len())
        && context.begins_argument
    {
        found.extend(elements(view, function, |m| m.component.prefix.causality.is_some()));
    }
    found.extend(words_for(&context));
    found
}

/// Keywords that fit the place.
///
/// They depend on the section at the beginning of a statement, and are those of expressions elsewhere.
fn words_for(context: &CompletionContext) -> Vec<CompletionItem> {
    let words: &[&str] = match (context.begins, context.section) {
        (true, CompletionSection::Elements) => &ELEMENT_WORDS,
        (true, CompletionSection::Equations) => &EQUATION_WORDS,
        _ => &EXPRESSION_WORDS,
    };
    words.iter().map(|w| plain(w, CompletionItemKind::KEYWORD)).collect()
}

/// Elements that a modification may name: public ones that are not final. Built-in types get their attributes.
///
/// The dotted names before the word lead further inside: in `pump(leak.` the elements of `leak` are offered.
fn arguments(view: &mut DocumentView<'_, '_>, context: &CompletionContext, scope: ClassId) -> Vec<CompletionItem> {
    let class = context.class_of(view.library, scope, context.calls.len()).and_then(|class| {
        context.chain.iter().try_fold(class, |class, part| {
            let target = names::element(view.library, class, Symbol::new(part))?;
            names::inside(view.library, target)
        })
    });
    let mut found = match class {
        Some(class) => elements(view, class, |m| !m.protected && !m.component.prefixes.final_),
        None => Vec::new(),
    };
    // A class without elements is a built-in type, or cannot be resolved.
    if found.is_empty() {
        let items = ATTRIBUTES.iter().map(|(name, said)| CompletionItem {
            documentation: Some(Documentation::String((*said).to_owned())),
            ..plain(name, CompletionItemKind::PROPERTY)
        });
        found.extend(items);
    }
    found
}

/// Completions after a dot. Inside `connect(` only the ports of a component, if it has any.
///
/// After a component its public elements are offered. After a class these are its classes, constants and literals.
///
/// Empty when the names before the dot cannot be resolved.
fn members(
    view: &mut DocumentView<'_, '_>,
    context: &CompletionContext,
    scope: ClassId,
    connects: bool,
) -> Vec<CompletionItem> {
    let Some(target) = meant(view.library, scope, &context.chain) else { return Vec::new() };
    let Some(class) = names::inside(view.library, target) else { return Vec::new() };
    // From a class only other classes, constants and literals can be named.
    if matches!(target, NameTarget::Class(_)) {
        let mut found = classes(view, class);
        found.extend(elements(view, class, |m| m.component.prefix.variability == Some(VariabilityPrefix::Constant)));
        if let bramah_syntax::ast::ClassBody::Enumeration(Some(literals)) = &view.library.class(class).body {
            found.extend(literals.iter().map(|l| plain(l.name.name.as_str(), CompletionItemKind::ENUM_MEMBER)));
        }
        return found;
    }
    let ports: Vec<CompletionItem> =
        if connects { elements_that(view, class, |view, m| !m.protected && is_port(view, m)) } else { Vec::new() };
    if ports.is_empty() { elements(view, class, |m| !m.protected) } else { ports }
}

/// Names that need no dot: elements of the class, constants and classes of the enclosing ones, packages at the top.
///
/// The result is sorted by name.
///
/// Inside `connect(` only elements that are not of type Real.
fn in_scope(view: &mut DocumentView<'_, '_>, scope: ClassId, connects: bool) -> Vec<CompletionItem> {
    let mut found = elements(view, scope, |m| !connects || m.component.class.parts[0].name != "Real");
    if connects {
        return found;
    }
    let mut around = Some(scope);
    while let Some(class) = around {
        found.extend(classes(view, class));
        around = view.library.parent(class);
        if let Some(outer) = around {
            found
                .extend(elements(view, outer, |m| m.component.prefix.variability == Some(VariabilityPrefix::Constant)));
        }
    }
    let top = view.library.top_level();
    found.extend(top.iter().map(|name| plain(name.as_str(), CompletionItemKind::MODULE)));
    // An inner class hides one of the same name around it, and each name is offered once.
    found.sort_by(|a, b| a.label.cmp(&b.label));
    found.dedup_by(|a, b| a.label == b.label);
    found
}

/// Completions for the classes in a class.
///
/// Inherited classes are included.
fn classes(view: &mut DocumentView<'_, '_>, class: ClassId) -> Vec<CompletionItem> {
    let all = names::classes(view.library, class);
    all.into_iter().map(|id| class_item(view.library, id)).collect()
}

/// The completion for a class, with its description and documentation.
///
/// The documentation is converted to Markdown, which editors show beside the list.
fn class_item(library: &Library<'_>, id: ClassId) -> CompletionItem {
    let class = library.class(id);
    let kind = match class.kind {
        ClassKind::Package => CompletionItemKind::MODULE,
        ClassKind::Function { .. } | ClassKind::Operator => CompletionItemKind::FUNCTION,
        ClassKind::Type => CompletionItemKind::TYPE_PARAMETER,
        ClassKind::Connector { .. } => CompletionItemKind::INTERFACE,
        ClassKind::Record { .. } => CompletionItemKind::STRUCT,
        _ => CompletionItemKind::CLASS,
    };
    let documentation = words::documentation(library, id).map(|html| {
        let value = words::markdown(html);
        Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value })
    });
    CompletionItem {
        detail: class.description.as_deref().map(str::to_owned),
        documentation,
        ..plain(class.name.name.as_str(), kind)
    }
}

/// Completions for the elements of a class that `wanted` accepts, inherited ones included.
///
/// The view is not available inside `wanted`; see `elements_that`.
fn elements(
    view: &mut DocumentView<'_, '_>,
    class: ClassId,
    wanted: impl Fn(&MemberComponent<'_>) -> bool,
) -> Vec<CompletionItem> {
    elements_that(view, class, |_, m| wanted(m))
}

/// As `elements`, with access to the view for the decision.
fn elements_that(
    view: &mut DocumentView<'_, '_>,
    class: ClassId,
    wanted: impl Fn(&mut DocumentView<'_, '_>, &MemberComponent<'_>) -> bool,
) -> Vec<CompletionItem> {
    let all = names::members(view.library, class);
    let mut found: Vec<CompletionItem> = Vec::new();
    for member in all {
        if wanted(view, &member) {
            found.push(element_item(view.library, member));
        }
    }
    found
}

/// The completion for a component, with its declaration and unit. Parameters are sorted first.
///
/// The sorting text begins with 0 for parameters and with 1 for all others, so that parameters are listed first.
fn element_item<'a>(library: &mut Library<'a>, member: MemberComponent<'a>) -> CompletionItem {
    let component = member.component;
    let parameter = component.prefix.variability == Some(VariabilityPrefix::Parameter);
    let kind = match component.prefix.variability {
        Some(VariabilityPrefix::Parameter) => CompletionItemKind::PROPERTY,
        Some(VariabilityPrefix::Constant) => CompletionItemKind::CONSTANT,
        _ => CompletionItemKind::VARIABLE,
    };
    let unit = words::attribute(library, member, "unit").map(|u| format!(", in {u}")).unwrap_or_default();
    let said = component.description.as_deref().unwrap_or_default();
    CompletionItem {
        detail: Some(words::declaration(library, component)),
        documentation: Some(Documentation::String(format!("{said}{unit}"))),
        sort_text: Some(format!("{}{}", if parameter { 0 } else { 1 }, component.name.name)),
        ..plain(component.name.name.as_str(), kind)
    }
}

/// Whether the type of a component is a connector.
fn is_port(view: &mut DocumentView<'_, '_>, member: &MemberComponent<'_>) -> bool {
    names::type_of(view.library, *member).is_some_and(|class| names::is_connector(view.library, class))
}

/// A completion with a label and a kind only.
fn plain(label: &str, kind: CompletionItemKind) -> CompletionItem {
    CompletionItem { label: label.to_owned(), kind: Some(kind), ..CompletionItem::default() }
}

/// What a dotted name refers to, looked up from a class outwards. `None`: it cannot be resolved.
///
/// The first name is looked up in the class, its bases and the enclosing classes. Each further one is an element of
/// what was found before.
fn meant<'a>(library: &mut Library<'a>, scope: ClassId, path: &[String]) -> Option<NameTarget<'a>> {
    let (first, rest) = path.split_first()?;
    let target = names::lookup(library, scope, Symbol::new(first))?;
    if rest.is_empty() {
        return Some(target);
    }
    let class = names::inside(library, target)?;
    along(library, class, rest)
}

/// What a dotted name refers to among the elements of a class.
///
/// `None`: one of the names does not exist, or an element before the last one has no elements of its own.
fn along<'a>(library: &mut Library<'a>, mut class: ClassId, path: &[String]) -> Option<NameTarget<'a>> {
    let (last, before) = path.split_last()?;
    for part in before {
        let target = names::element(library, class, Symbol::new(part))?;
        class = names::inside(library, target)?;
    }
    names::element(library, class, Symbol::new(last))
}

/// The class with a dotted name, looked up from a class outwards.
///
/// `None`: there is no such class.
fn named(library: &mut Library<'_>, scope: ClassId, path: &[String]) -> Option<ClassId> {
    let parts: Vec<Symbol> = path.iter().map(|p| Symbol::new(p)).collect();
    names::named(library, Some(scope), &parts, false)
}

/// The name in `name =` at the end of the tokens; `None` when they end otherwise.
fn named_before(text: &str, tokens: &[Token]) -> Option<String> {
    match tokens {
        [.., name, equal] if equal.kind == TokenKind::Equal && name.kind == TokenKind::Ident => Some(word(text, name)),
        _ => None,
    }
}

/// The text of a token.
fn word(text: &str, token: &Token) -> String {
    text[token.start as usize..token.end as usize].to_owned()
}

/// The dotted name at the end of the tokens without its indices, and the number of tokens before it.
///
/// The tokens are read backwards. An empty list means that the tokens do not end in a name.
fn chain_before(text: &str, tokens: &[Token]) -> (Vec<String>, usize) {
    let mut parts = Vec::new();
    let mut at = tokens.len();
    loop {
        let mut next = at;
        // An index is skipped back to its opening bracket.
        if next > 0 && tokens[next - 1].kind == TokenKind::RightBracket {
            let mut depth = 0;
            while next > 0 {
                next -= 1;
                match tokens[next].kind {
                    TokenKind::RightBracket => depth += 1,
                    TokenKind::LeftBracket => depth -= 1,
                    _ => {}
                }
                if depth == 0 {
                    break;
                }
            }
        }
        if next == 0 || tokens[next - 1].kind != TokenKind::Ident {
            break;
        }
        parts.push(word(text, &tokens[next - 1]));
        at = next - 1;
        if at == 0 || tokens[at - 1].kind != TokenKind::Dot {
            break;
        }
        at -= 1;
    }
    parts.reverse();
    (parts, at)
}

/// What a bracket after these tokens of a statement belongs to. `around` is the head of the enclosing bracket.
///
/// The name before the bracket is read first. The token before that name then decides: a type makes it a declaration,
/// `extends` a base class, an enclosing modification an element. In all other cases it is a function.
fn head(text: &str, tokens: &[Token], around: Option<&BracketHead>) -> BracketHead {
    match tokens.last().map(|t| t.kind) {
        Some(TokenKind::Connect) => return BracketHead::Connect,
        Some(TokenKind::Annotation) => return BracketHead::Other,
        _ => {}
    }
    let (path, rest) = chain_before(text, tokens);
    if path.is_empty() {
        return BracketHead::Other;
    }
    let modifies = matches!(around, Some(BracketHead::Element(..) | BracketHead::Type(_) | BracketHead::Inner(_)));
    let before = &tokens[..rest];
    match before.last().map(|t| t.kind) {
        Some(TokenKind::Extends | TokenKind::Constrainedby) => BracketHead::Type(path),
        // Two names in a row are a type and a component: `Type name(`.
        Some(TokenKind::Ident | TokenKind::RightBracket) if path.len() == 1 => {
            BracketHead::Element(chain_before(text, before).0, path.into_iter().next().unwrap_or_default())
        }
        // `model M = Path(`.
        Some(TokenKind::Equal) if matches!(before, [.., class, _, _] if class.kind.is_class_word()) => {
            BracketHead::Type(path)
        }
        // Inside a modification a name before a bracket is modified further, not called.
        Some(TokenKind::LeftParen | TokenKind::Comma | TokenKind::Each | TokenKind::Final) if modifies => {
            BracketHead::Inner(path)
        }
        // A further component of the same declaration: `Type a(..), b(`. The type comes from the start of the
        // statement.
        Some(TokenKind::Comma) if around.is_none() => {
            let words = tokens.iter().skip_while(|t| t.kind != TokenKind::Ident);
            let first: Vec<Token> =
                words.take_while(|t| matches!(t.kind, TokenKind::Ident | TokenKind::Dot)).copied().collect();
            let (mut type_path, _) = chain_before(text, &first[..first.len().saturating_sub(1)]);
            if type_path.is_empty() {
                type_path = path.clone();
            }
            BracketHead::Element(type_path, path.into_iter().next().unwrap_or_default())
        }
        _ => BracketHead::Function(path),
    }
}

/// Whether a token is a prefix that may stand before an element's type.
///
/// While only such tokens stand before the word, the statement has not begun.
fn is_prefix(kind: TokenKind) -> bool {
    use TokenKind as T;
    let of_type = matches!(kind, T::Parameter | T::Constant | T::Discrete | T::Input | T::Output | T::Flow | T::Stream);
    of_type || kind.is_element_prefix()
}
