//! Text to syntax tree. Never fails: errors come beside the tree, several per file.

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

/// What could be made of a text.
#[derive(Clone, Debug)]
pub struct ParseOutput {
    /// The classes; what could not be read is left out.
    pub tree: ast::StoredDefinition,
    /// Errors in the order of their places (E001 to E005); none means that the tree is the whole text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads a whole file.
///
/// The nesting of brackets, blocks and classes is limited to 200, the height of an expression to 500 (E004), so the
/// tree may be walked by recursion. Time is linear in the length of the text.
pub fn parse(file: FileId, text: &str) -> ParseOutput {
    if let Some(diagnostic) = not_text(file, text) {
        return ParseOutput { tree: ast::StoredDefinition::default(), diagnostics: vec![diagnostic] };
    }
    let mut parser = Parser::new(file, text);
    let tree = class::stored_definition(&mut parser);
    ParseOutput { tree, diagnostics: parser.into_diagnostics() }
}

/// Reads a text that is one expression, such as a value given on the command line.
pub fn parse_expression(file: FileId, text: &str) -> StageResult<ast::Expr> {
    if let Some(diagnostic) = not_text(file, text) {
        return StageResult::failed(vec![diagnostic]);
    }
    let mut parser = Parser::new(file, text);
    let expr = expr::whole_expression(&mut parser);
    let diagnostics = parser.into_diagnostics();
    if diagnostics.is_empty() { StageResult { value: expr, diagnostics } } else { StageResult::failed(diagnostics) }
}

/// Reads a text that is one dotted name, such as `Modelica.Constants.pi`; anything else gives nothing.
pub fn parse_path(file: FileId, text: &str) -> Option<ast::Path> {
    not_text(file, text).is_none().then(|| parser::whole_path(file, text)).flatten()
}

/// Reads a text that is one reference, such as `tank[2].port.p`; anything else gives nothing.
pub fn parse_reference(file: FileId, text: &str) -> Option<ast::ComponentReference> {
    not_text(file, text).is_none().then(|| parser::whole_reference(file, text)).flatten()
}

/// Complains about control characters, and about more text than places can count.
fn not_text(file: FileId, text: &str) -> Option<Diagnostic> {
    if u32::try_from(text.len()).is_err() {
        let whole = Span { file, start: 0, end: 0 };
        return Some(Diagnostic::new(Code::NotText, "the file is larger than 4 GiB").at(whole, ""));
    }
    let at = text.bytes().position(|b| b < 0x20 && !(0x09..=0x0d).contains(&b) || b == 0x7f)?;
    let place = Span { file, start: at as u32, end: at as u32 + 1 };
    let message = format!("the file is not text: it has a control character (byte {:#04x})", text.as_bytes()[at]);
    Some(Diagnostic::new(Code::NotText, message).at(place, "here").help("is this a Modelica file?"))
}

#[cfg(test)]
mod tests;
