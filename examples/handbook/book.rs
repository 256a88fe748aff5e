//! The chapters: Markdown files of `docs`, their circuits run and drawn.

use super::run;
use super::shell::{Page, code, up};
use bramah::Simulation;
use bramah::internals::diag::render::{DiagnosticFormat, render};
use bramah::internals::plot::svg::escape;
use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};
use std::collections::BTreeMap;
use std::path::Path;

/// Parts of the book with their chapters: files below `docs`, without `.md`.
pub const PARTS: [(&str, &[&str]); 4] = [
    (
        "Circuits",
        &[
            "first_circuit",
            "first_hour",
            "editor",
            "serve",
            "oil_and_volumes",
            "drives",
            "friction_and_events",
            "initialization",
            "long_runs",
            "libraries",
            "validation/libraries",
        ],
    ),
    (
        "Model and test rig",
        &[
            "study",
            "identify",
            "gap",
            "gap_method",
            "validation/gap",
            "sensitivity",
            "sweep",
            "linearize",
            "python",
            "fmi",
        ],
    ),
    ("The two papers", &["papers/servo_pump", "papers/closed_circuit"]),
    ("Solver and messages", &["bench", "errors/README"]),
];

/// A chapter: where its page stands, its title, its text.
pub struct Chapter {
    /// Below `docs`, without ending.
    pub name: String,
    /// Its first heading.
    pub title: String,
    text: String,
}

/// Reads the chapters.
///
/// # Errors
/// The file that cannot be read, or has no title.
pub fn chapters(docs: &Path) -> Result<Vec<Chapter>, String> {
    let mut out = Vec::new();
    let mut names: Vec<String> = PARTS.iter().flat_map(|(_, names)| names.iter().map(|n| (*n).to_owned())).collect();
    let codes = codes(&docs.join("errors"))?;
    names.extend(codes.iter().map(|code| format!("errors/{code}")));
    for name in names {
        let file = docs.join(format!("{name}.md"));
        let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        let title =
            text.lines().find_map(|l| l.strip_prefix("# ")).ok_or(format!("{name}.md has no title"))?.to_owned();
        out.push(Chapter { name, title, text });
    }
    let titles: Vec<String> = out.iter().filter(|c| is_code(&c.name)).map(|c| listed(&c.name, &c.title)).collect();
    if let Some(list) = out.iter_mut().find(|c| c.name == "errors/README") {
        list.text.push_str(&format!("\n{}\n", titles.join("\n")));
    }
    Ok(out)
}

/// Codes of messages that have a page.
fn codes(folder: &Path) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let names = entries.filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().strip_suffix(".md")?.to_owned()));
    let mut codes: Vec<String> = names.filter(|n| n != "README").collect();
    codes.sort();
    Ok(codes)
}

fn is_code(name: &str) -> bool {
    name.starts_with("errors/") && name != "errors/README"
}

fn listed(name: &str, title: &str) -> String {
    format!("- [{title}]({}.md)", name.trim_start_matches("errors/"))
}

/// Where the page of a chapter stands.
pub fn path(name: &str) -> String {
    format!("book/{name}.html")
}

/// The list of chapters, seen from a page.
pub fn contents(chapters: &[Chapter], from: &str, heading: &str) -> String {
    let up = up(from);
    let mut out = String::new();
    for (part, names) in PARTS {
        out.push_str(&format!("<{heading}>{part}</{heading}><ul>"));
        for chapter in chapters.iter().filter(|c| names.contains(&c.name.as_str())) {
            let target = path(&chapter.name);
            let here = if target == from { " class=\"here\"" } else { "" };
            out.push_str(&format!("<li><a{here} href=\"{up}{target}\">{}</a></li>", escape(&chapter.title)));
        }
        out.push_str("</ul>");
    }
    out
}

/// The page of a chapter, with pictures of its circuits put into `pictures`.
///
/// # Errors
/// A circuit that does not do what the chapter says.
pub fn page(
    chapter: &Chapter,
    all: &[Chapter],
    classes: &dyn Fn(&str) -> bool,
    pictures: &mut BTreeMap<String, Vec<u8>>,
) -> Result<Page, String> {
    let path = path(&chapter.name);
    let mut events = Vec::new();
    let mut fence: Option<(String, String)> = None;
    let mut shown = 0;
    let options = Options::ENABLE_TABLES | Options::ENABLE_HEADING_ATTRIBUTES;
    for event in Parser::new_ext(&chapter.text, options) {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                fence = Some((info.to_string(), String::new()))
            }
            Event::Text(text) if fence.is_some() => {
                fence.as_mut().expect("it is some").1.push_str(&text);
            }
            Event::End(TagEnd::CodeBlock) if fence.is_some() => {
                let (info, text) = fence.take().expect("it is some");
                events.push(Event::Html(code(&text).into()));
                shown += 1;
                let file = format!("pictures/book_{}_{shown}.svg", chapter.name.replace('/', "_"));
                // Pages of messages show what is wrong; other tests run their examples.
                let info = if is_code(&chapter.name) { String::new() } else { info };
                let result = circuit(&info, &text, &file, &path, pictures);
                let result = result.map_err(|why| format!("docs/{}.md, block {shown}: {why}", chapter.name))?;
                events.push(Event::Html(result.into()));
            }
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                events.push(Event::Start(Tag::Link { link_type, dest_url: target(&dest_url), title, id }));
            }
            Event::Start(Tag::Table(_)) => {
                events.push(Event::Html("<div class=\"wide\">".into()));
                events.push(event);
            }
            Event::End(TagEnd::Table) => {
                events.push(event);
                events.push(Event::Html("</div>".into()));
            }
            Event::Code(name) if classes(&name) => {
                let link = format!("<code><a href=\"{}reference/{name}.html\">{name}</a></code>", up(&path));
                events.push(Event::InlineHtml(link.into()));
            }
            event => events.push(event),
        }
    }
    let mut content = String::new();
    html::push_html(&mut content, anchored(events).into_iter());
    Ok(Page { title: chapter.title.clone(), nav: contents(all, &path, "h2"), content, path })
}

/// Links between chapters lead to their pages.
fn target(link: &str) -> CowStr<'static> {
    match link.split_once(".md") {
        Some((file, rest)) if !link.contains("://") => format!("{file}.html{rest}").into(),
        _ => link.to_owned().into(),
    }
}

/// Gives headings the names that links within Markdown use.
fn anchored(events: Vec<Event<'_>>) -> Vec<Event<'_>> {
    let mut out: Vec<Event<'_>> = Vec::new();
    let mut heading: Option<usize> = None;
    let mut words = String::new();
    for event in events {
        match &event {
            Event::Start(Tag::Heading { level, .. }) if *level != HeadingLevel::H1 => {
                heading = Some(out.len());
                words.clear();
            }
            Event::Text(t) | Event::Code(t) if heading.is_some() => words.push_str(t),
            Event::End(TagEnd::Heading(_)) => {
                if let Some(Event::Start(Tag::Heading { id, .. })) = heading.take().and_then(|i| out.get_mut(i)) {
                    *id = Some(slug(&words).into());
                }
            }
            _ => {}
        }
        out.push(event);
    }
    out
}

fn slug(words: &str) -> String {
    let kept = words.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-');
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// What a block of Modelica asks for after its language: `plot=a,b`, `x=c`, or `says=E103`.
///
/// A block with an experiment is run in any case.
fn circuit(
    info: &str,
    text: &str,
    file: &str,
    page: &str,
    pictures: &mut BTreeMap<String, Vec<u8>>,
) -> Result<String, String> {
    let mut words = info.split_whitespace();
    if words.next() != Some("modelica") {
        return Ok(String::new());
    }
    let options: BTreeMap<&str, &str> = words.filter_map(|w| w.split_once('=')).collect();
    if let Some(wanted) = options.get("says") {
        return said(text, wanted).map(|words| code(&words));
    }
    if let Some(variables) = options.get("plot") {
        let variables: Vec<&str> = variables.split(',').collect();
        pictures.insert(file.to_owned(), run::circuit(text, &variables, options.get("x").copied())?.into_bytes());
        let name = variables.join(", ");
        return Ok(format!("<figure><img src=\"{}{file}\" alt=\"{name}\" loading=\"lazy\"></figure>", up(page)));
    }
    if text.contains("experiment(") {
        Simulation::from_text(text).and_then(|s| s.run()).map_err(|e| e.to_string())?;
    }
    Ok(String::new())
}

/// What bramah says about a circuit that is wrong.
fn said(text: &str, code: &str) -> Result<String, String> {
    let outcome = Simulation::from_text(text).and_then(|s| s.run());
    let Err(error) = outcome else { return Err(format!("it runs, and should say {code}")) };
    let words = render(&error.sources, &error.diagnostics, DiagnosticFormat::Human, 100, false);
    if words.contains(code) { Ok(words) } else { Err(format!("it should say {code}, and says\n{words}")) }
}
