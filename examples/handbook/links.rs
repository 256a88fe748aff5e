//! Every link between the pages must lead somewhere, and none may lead out unasked.

use std::collections::{BTreeMap, BTreeSet};

/// All links of pages that lead nowhere: page, link and why.
pub fn dead(files: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let anchors: BTreeMap<&str, BTreeSet<&str>> =
        files.iter().filter_map(|(path, bytes)| text(path, bytes).map(|t| (path.as_str(), ids(t)))).collect();
    let mut out = Vec::new();
    for (path, bytes) in files {
        let Some(html) = text(path, bytes) else { continue };
        for link in attributes(html, &["href=\"", "src=\""]) {
            if let Some(why) = wrong(path, link, files, &anchors) {
                out.push(format!("{path}: {link}: {why}"));
            }
        }
    }
    out
}

fn text<'a>(path: &str, bytes: &'a [u8]) -> Option<&'a str> {
    if path.ends_with(".html") { std::str::from_utf8(bytes).ok() } else { None }
}

fn wrong(
    page: &str,
    link: &str,
    files: &BTreeMap<String, Vec<u8>>,
    anchors: &BTreeMap<&str, BTreeSet<&str>>,
) -> Option<&'static str> {
    if link.starts_with("https://") || link.starts_with("http://") || link.starts_with("data:") {
        return None;
    }
    let (file, anchor) = link.split_once('#').map_or((link, None), |(f, a)| (f, Some(a)));
    let target = if file.is_empty() { page.to_owned() } else { joined(page, file) };
    if !files.contains_key(&target) {
        return Some("there is no such file");
    }
    let known = |a: &str| anchors.get(target.as_str()).is_some_and(|ids| ids.contains(a));
    anchor.filter(|a| !known(a)).map(|_| "there is no such place on the page")
}

/// The target of a relative link.
fn joined(page: &str, link: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            ".." => {
                parts.pop();
            }
            "." => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}

fn ids(html: &str) -> BTreeSet<&str> {
    attributes(html, &["id=\""]).into_iter().collect()
}

fn attributes<'a>(html: &'a str, starts: &[&str]) -> Vec<&'a str> {
    let mut out = Vec::new();
    for start in starts {
        let mut rest = html;
        while let Some(i) = rest.find(start) {
            let apart = rest[..i].ends_with(char::is_whitespace);
            rest = &rest[i + start.len()..];
            if let Some(end) = rest.find('"').filter(|_| apart) {
                out.push(&rest[..end]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_links_are_found() {
        let page = |html: &str| html.as_bytes().to_vec();
        let files = BTreeMap::from([
            (
                "a.html".to_owned(),
                page("<a href=\"b/c.html#x\">1</a> <a href=\"b/c.html#y\">2</a> <img src=\"no.svg\">"),
            ),
            (
                "b/c.html".to_owned(),
                page("<p id=\"x\"><a href=\"../a.html\">3</a> <a href=\"https://example.org\">4</a>"),
            ),
        ]);
        assert_eq!(
            dead(&files),
            ["a.html: b/c.html#y: there is no such place on the page", "a.html: no.svg: there is no such file"]
        );
    }
}
