//! Corrections that a message proposes.

use super::lines;
use bramah_syntax::diag::{Diagnostic, Sources};
use lsp_types::TextEdit;

/// A correction of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct QuickFix {
    /// What it does.
    pub title: String,
    /// What changes in the file of the message.
    pub edit: TextEdit,
}

/// The correction that a message proposes, in the file in which its primary place is.
pub fn correction(sources: &Sources, diagnostic: &Diagnostic) -> Option<QuickFix> {
    let fix = diagnostic.fix.as_ref()?;
    let text = &sources.get(fix.span.file).text;
    let range = lines::range(text, fix.span);
    let title = match (sources.text(fix.span), fix.text.as_str()) {
        ("", new) => format!("Insert `{}`", new.trim()),
        (old, "") => format!("Remove `{}`", old.trim()),
        (old, new) => format!("Replace `{old}` by `{new}`"),
    };
    Some(QuickFix { title, edit: TextEdit { range, new_text: fix.text.clone() } })
}
