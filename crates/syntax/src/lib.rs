//! Modelica texts to syntax trees, and back.
//!
//! Texts enter, trees ([`ast`]) and diagnostics ([`diag`]) leave. Parsing never fails: errors come beside the tree,
//! several per file. The crate knows the grammar of Modelica 3.6 and no semantics.
//! It also holds what every later crate needs: messages and their places, and the access to files ([`world`]).

pub mod diag;
pub mod world;

pub mod ast;
pub mod format;
pub mod lexer;
mod parser;
mod print;
pub mod symbol;
pub mod token;

use crate::diag::{Code, Diagnostic, FileId, Span, StageResult};
use parser::{Parser, class, expr};

/// The result of parsing a file.
#[derive(Clone, Debug)]
pub struct ParseOutput {
    /// The classes of the file. What could not be parsed is left out.
    pub tree: ast::StoredDefinition,
    /// Errors in the order of their places (E001 to E005). If there are none, the tree holds the complete text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses a file.
///
/// Brackets, blocks and classes may nest 200 levels deep, and an expression may be 500 operators high (E004), so that
/// the tree can be walked by recursion. Time is linear in the length of the text.
pub fn parse(file: FileId, text: &str) -> ParseOutput {
    if let Some(diagnostic) = not_text(file, text) {
        return ParseOutput { tree: ast::StoredDefinition::default(), diagnostics: vec![diagnostic] };
    }
    let mut parser = Parser::new(file, text);
    let tree = class::stored_definition(&mut parser);
    ParseOutput { tree, diagnostics: parser.into_diagnostics() }
}

/// Parses a text that is one expression, such as a value given on the command line.
/// The result has no value if there is any error.
pub fn parse_expression(file: FileId, text: &str) -> StageResult<ast::Expr> {
    if let Some(diagnostic) = not_text(file, text) {
        return StageResult::failed(vec![diagnostic]);
    }
    let mut parser = Parser::new(file, text);
    let expr = expr::whole_expression(&mut parser);
    let diagnostics = parser.into_diagnostics();
    if diagnostics.is_empty() { StageResult { value: expr, diagnostics } } else { StageResult::failed(diagnostics) }
}

/// Parses a text that is one dotted name, such as `Modelica.Constants.pi`. `None` if the text is anything else.
pub fn parse_path(file: FileId, text: &str) -> Option<ast::Path> {
    not_text(file, text).is_none().then(|| parser::whole_path(file, text)).flatten()
}

/// Parses a text that is one component reference, such as `tank[2].port.p`. `None` if the text is anything else.
pub fn parse_reference(file: FileId, text: &str) -> Option<ast::ComponentReference> {
    not_text(file, text).is_none().then(|| parser::whole_reference(file, text)).flatten()
}

/// A diagnostic for what cannot be a Modelica text: control characters, or more bytes than spans can count.
/// `None` if the text may be parsed.
fn not_text(file: FileId, text: &str) -> Option<Diagnostic> {
    if u32::try_from(text.len()).is_err() {
        let whole = Span { file, start: 0, end: 0 };
        return Some(Diagnostic::new(Code::NotText, "the file is larger than 4 GiB").at(whole, ""));
    }
    // Tab, line breaks, vertical tab and form feed are allowed.
    let at = text.bytes().position(|b| b < 0x20 && !(0x09..=0x0d).contains(&b) || b == 0x7f)?;
    let place = Span { file, start: at as u32, end: at as u32 + 1 };
    let message = format!("the file is not text: it has a control character (byte {:#04x})", text.as_bytes()[at]);
    Some(Diagnostic::new(Code::NotText, message).at(place, "here").help("is this a Modelica file?"))
}

#[cfg(test)]
mod tests;
