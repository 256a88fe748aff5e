//! Writes the handbook: a reference made from the files of the library, and the chapters of `docs`, as plain HTML.
//!
//! `cargo run --release --example handbook -- [OUT]`, or `./x docs`. The pages need no network and no server. Dead
//! links, examples that fail and circuits of the book that do not do what it says are errors.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it says what it wrote")]
#![allow(clippy::disallowed_methods, reason = "it writes pages")]

mod book;
mod class;
mod equations;
mod facts;
mod icon;
mod library;
mod links;
mod math;
mod run;
mod shell;
mod tables;

use bramah::internals::plot::svg::escape;
use bramah::internals::resolve::{Library, SyntaxArena};
use bramah::internals::shipped::ShippedWorld;
use bramah::world::World;
use library::{Catalogue, PACKAGES};
use shell::Page;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// All files of the handbook by path, and what went wrong on the way.
struct Handbook {
    files: BTreeMap<String, Vec<u8>>,
    failed: Vec<String>,
}

fn main() -> std::process::ExitCode {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out/handbook".to_owned()));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let made = make(root).and_then(|book| write(&out, &book.files).map(|()| book));
    match made {
        Ok(book) if book.failed.is_empty() => {
            println!("{} files, first page: {}", book.files.len(), out.join("index.html").display());
            std::process::ExitCode::SUCCESS
        }
        Ok(book) => {
            book.failed.iter().for_each(|f| eprintln!("error: {f}"));
            std::process::ExitCode::FAILURE
        }
        Err(why) => {
            eprintln!("error: {why}");
            std::process::ExitCode::FAILURE
        }
    }
}

fn write(out: &Path, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    if out.join("style.css").exists() {
        std::fs::remove_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    for (path, bytes) in files {
        let file = out.join(path);
        let folder = file.parent().expect("a file stands in a folder");
        let done = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&file, bytes));
        done.map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}

/// Makes all pages; every example is run on the way.
fn make(root: &Path) -> Result<Handbook, String> {
    let trees = SyntaxArena::new();
    let shipped = ShippedWorld;
    let roots = ShippedWorld::roots().map(|r| (&shipped as &dyn World, r)).to_vec();
    let mut library = Library::new(&trees, roots);
    let catalogue = library::catalogue(&mut library);
    let chapters = book::chapters(&root.join("docs"))?;
    let mut runs = run::Runs::default();
    let mut press =
        class::Press { library: &mut library, catalogue: &catalogue, runs: &mut runs, pictures: BTreeMap::new() };
    let mut pages: Vec<Page> = catalogue.classes.iter().map(|(name, id)| press.page(name, *id)).collect();
    let mut files = std::mem::take(&mut press.pictures);
    pages.push(index(&catalogue, &mut library, &chapters));
    pages.push(all_classes(&catalogue, &mut library));
    for chapter in &chapters {
        let known = |name: &str| name.contains('.') && catalogue.classes.contains_key(name);
        pages.push(book::page(chapter, &chapters, &known, &mut files)?);
    }
    files.insert("style.css".to_owned(), shell::STYLE.into());
    copy(&root.join("docs/pictures"), "book/pictures", &mut files)?;
    files.extend(pages.iter().map(|p| (p.path.clone(), shell::frame(p).into_bytes())));
    let mut failed = runs.failed;
    failed.extend(links::dead(&files));
    Ok(Handbook { files, failed })
}

fn copy(from: &Path, to: &str, files: &mut BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    for entry in std::fs::read_dir(from).map_err(|e| format!("{}: {e}", from.display()))? {
        let path = entry.map_err(|e| e.to_string())?.path();
        let name = format!("{to}/{}", path.file_name().expect("it has a name").to_string_lossy());
        if path.is_dir() {
            copy(&path, &name, files)?;
        } else {
            files.insert(name, std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?);
        }
    }
    Ok(())
}

/// The first page: the chapters, and the packages.
fn index(catalogue: &Catalogue, library: &mut Library<'_>, chapters: &[book::Chapter]) -> Page {
    let mut content = String::from(
        "<h1>Bramah</h1><p class=\"lead\">Electro-hydraulic machines from text files: the book, and the reference of the library, made from its files.</p><h2 id=\"book\">Book</h2><div class=\"cards\">",
    );
    for part in book::contents(chapters, "index.html", "h3").split("</ul>").filter(|p| !p.is_empty()) {
        content.push_str(&format!("<div>{part}</ul></div>"));
    }
    content.push_str("</div><h2 id=\"reference\">Reference</h2><ul class=\"cards\">");
    for package in PACKAGES {
        let class = library.class(catalogue.classes[package]);
        let said = escape(class.description.as_deref().unwrap_or_default());
        content.push_str(&format!("<li><a href=\"reference/{package}.html\">{package}</a><span>{said}</span></li>"));
    }
    content.push_str("</ul>");
    let nav = book::contents(chapters, "index.html", "h2");
    Page { path: "index.html".into(), title: "Handbook".into(), content, nav }
}

/// All classes in one list; a field narrows it where scripts are allowed.
fn all_classes(catalogue: &Catalogue, library: &mut Library<'_>) -> Page {
    let mut content = String::from(
        "<h1>All classes</h1><input id=\"filter\" type=\"search\" placeholder=\"narrow the list\" aria-label=\"narrow the list\"><table class=\"full\" id=\"list\">",
    );
    let shown =
        catalogue.classes.iter().filter(|(name, _)| !name.starts_with("Modelica.") && !name.contains(".Examples"));
    for (name, id) in shown {
        let said = escape(library.class(*id).description.as_deref().unwrap_or_default());
        content.push_str(&format!("<tr><td><a href=\"reference/{name}.html\">{name}</a></td><td>{said}</td></tr>\n"));
    }
    content.push_str(
        "</table><script>document.getElementById('filter').addEventListener('input', function () {\
         var words = this.value.toLowerCase().split(/\\s+/);\
         document.querySelectorAll('#list tr').forEach(function (row) {\
         var text = row.textContent.toLowerCase();\
         row.hidden = !words.every(function (w) { return text.includes(w); }); }); });</script>",
    );
    let mut nav = String::from("<h2>Packages</h2><ul>");
    PACKAGES.iter().for_each(|p| nav.push_str(&format!("<li><a href=\"reference/{p}.html\">{p}</a></li>")));
    nav.push_str("</ul>");
    Page { path: "all.html".into(), title: "All classes".into(), content, nav }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All examples run on the way.
    #[test]
    fn all_pages_are_made_without_dead_links_and_circuits_of_the_book_run() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let book = make(root).expect("it is made");
        assert!(book.failed.is_empty(), "{}", book.failed.join("\n"));
        assert!(book.files.len() > 400, "{} files", book.files.len());
        for (path, bytes) in book.files.iter().filter(|(p, _)| p.ends_with(".html")) {
            let text = std::str::from_utf8(bytes).expect("pages are text");
            let fetches = ["src=\"http", "<link rel=\"stylesheet\" href=\"http", "@import", "url("];
            assert!(fetches.iter().all(|f| !text.contains(f)), "{path} asks the network");
        }
    }

    #[test]
    fn every_file_of_docs_is_a_chapter() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        let chapters: Vec<&str> = book::PARTS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        for folder in ["", "papers/"] {
            for entry in std::fs::read_dir(docs.join(folder)).expect("it is there") {
                let name = entry.expect("readable").file_name().to_string_lossy().into_owned();
                if let Some(stem) = name.strip_suffix(".md") {
                    assert!(chapters.contains(&format!("{folder}{stem}").as_str()), "{folder}{name} is in no part");
                }
            }
        }
    }
}
