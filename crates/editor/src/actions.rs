//! Quick fixes: the corrections that diagnostics propose.

use super::lines;
use bramah_syntax::diag::{Diagnostic, Sources};
use lsp_types::TextEdit;

/// A correction of a text that the user can accept.
#[derive(Clone, Debug, PartialEq)]
pub struct QuickFix {
    /// Title in the editor's menu.
    pub title: String,
    /// The change of the file.
    pub edit: TextEdit,
}

/// The correction that a diagnostic proposes. `None`: it proposes none.
pub fn correction(sources: &Sources, diagnostic: &Diagnostic) -> Option<QuickFix> {
    let fix = diagnostic.fix.as_ref()?;
    let text = &sources.get(fix.span.file).text;
    let range = lines::range(text, fix.span);
    // An empty old text is an insertion, an empty new one a removal.
    let title = match (sources.text(fix.span), fix.text.as_str()) {
        ("", new) => format!("Insert `{}`", new.trim()),
        (old, "") => format!("Remove `{}`", old.trim()),
        (old, new) => format!("Replace `{old}` by `{new}`"),
    };
    Some(QuickFix { title, edit: TextEdit { range, new_text: fix.text.clone() } })
}
