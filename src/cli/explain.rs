//! `bramah explain`: prints the page of a message's code, or the description of a library class.
//!
//! The pages of `docs/errors` are embedded in the binary.

use clap::Args;
use include_dir::{Dir, include_dir};

use super::describe::{describe, resembling};
use super::{CommandFailure, CommandStatus, files};
use bramah_syntax::diag::{Code, Diagnostic, nearest};

/// One page for each code: cause, smallest example, remedy.
static PAGES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/docs/errors");

/// Show the page behind a message's code, or what a class of the library offers
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah explain E103
  bramah explain Hydraulic            the classes of a package
  bramah explain Hydraulic.Cylinder   its ports and parameters
  bramah explain                      lists all codes")]
pub(super) struct ExplainArgs {
    /// The code, such as E103, or the class, such as Hydraulic.Cylinder
    #[arg(value_name = "CODE OR CLASS")]
    code: Option<String>,
}

/// Prints the page, or the list of all codes when nothing is named.
pub(super) fn run(args: &ExplainArgs) -> Result<CommandStatus, CommandFailure> {
    let text = match &args.code {
        None => list(),
        Some(asked) => page(asked)?,
    };
    files::print(&text)?;
    Ok(CommandStatus::Fine)
}

/// All codes with their titles, a line each.
fn list() -> String {
    Code::ALL.iter().map(|code| format!("{}  {}\n", code.id(), code.title())).collect()
}

/// The page of a code, or the description of a class. `Err`: neither exists.
fn page(asked: &str) -> Result<String, CommandFailure> {
    let wanted = asked.trim().to_uppercase();
    let Some(code) = Code::ALL.iter().find(|c| c.id() == wanted) else {
        return describe(asked.trim()).ok_or_else(|| unknown(asked, &wanted));
    };
    let file = PAGES.get_file(format!("{}.md", code.id())).and_then(include_dir::File::contents_utf8);
    // A code without a page of its own still has a title.
    Ok(match file {
        Some(text) => text.to_owned(),
        None => format!("# {}: {}\n", code.id(), code.title()),
    })
}

/// The failure for an unknown code or class, with the nearest match.
fn unknown(asked: &str, wanted: &str) -> CommandFailure {
    // `E230` for `W230` is a likely mistake: the letter is wrong, the number right.
    let same_number = |c: &&Code| wanted.len() == 4 && c.id()[1..] == wanted[1..];
    let near = Code::ALL.iter().find(same_number).map(|c| c.id());
    let near = near.or_else(|| nearest(wanted, Code::ALL.iter().map(|c| c.id())));
    // No code has more than four characters, so a longer word was meant as a class.
    if near.is_none() && wanted.len() > 4 {
        let text = format!("there is neither a message nor a class of the library called `{asked}`");
        return Diagnostic::new(Code::BadArgument, text).help(format!("see {}", resembling(asked))).into();
    }
    let diagnostic = Diagnostic::new(Code::BadArgument, format!("there is no message with the code `{asked}`"));
    match near {
        Some(code) => diagnostic.help(format!("did you mean `{code}`? `bramah explain` lists all codes")),
        None => diagnostic.help("`bramah explain` lists all codes"),
    }
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_text() {
        for code in Code::ALL {
            assert!(page(&code.id().to_lowercase()).unwrap().contains(code.id()));
        }
    }

    #[test]
    fn unknown_codes() {
        let helped = |c: &str| page(c).unwrap_err().diagnostics[0].help[0].clone();
        assert!(helped("E230").contains("W230"));
        assert!(helped("xyz").contains("lists all"));
        assert!(page("é103").is_err());
    }
}
