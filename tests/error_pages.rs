//! The pages behind message codes: the first example of each causes the message, the second is healthy.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use bramah::diag::Code;
use bramah::world::MemoryWorld;
use bramah::{Request, sort};
use std::path::Path;

/// The codes reported for one text, with their messages.
fn reported(text: &str) -> Vec<(Code, String)> {
    let world = MemoryWorld::single("page.mo", text);
    let request = Request { source: Path::new("page.mo").into(), ..Request::default() };
    sort(&world, &request).diagnostics.into_iter().map(|d| (d.code, d.message)).collect()
}

/// The fenced Modelica texts of a page.
fn examples(page: &str) -> Vec<&str> {
    page.split("```modelica\n").skip(1).map(|rest| rest.split("```").next().unwrap_or("")).collect()
}

#[test]
fn examples_do_what_their_pages_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/errors");
    let mut wrong = Vec::new();
    for &code in Code::ALL {
        let Ok(page) = std::fs::read_to_string(folder.join(format!("{}.md", code.id()))) else { continue };
        let examples = examples(&page);
        if let Some(bad) = examples.first() {
            let found = reported(bad);
            if !found.iter().any(|f| f.0 == code) {
                wrong.push(format!("{code}: the first example gives {found:?}"));
            }
        }
        if let Some(good) = examples.get(1) {
            let found = reported(good);
            if !found.is_empty() {
                wrong.push(format!("{code}: the second example gives {found:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
