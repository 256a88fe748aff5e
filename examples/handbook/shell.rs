//! The frame of every page: navigation, style, and nothing from the network.

use bramah::internals::plot::svg::escape;

/// A page before it is framed.
pub struct Page {
    /// Path below the output folder, with `/`.
    pub path: String,
    /// For the window and the top.
    pub title: String,
    /// What stands on it, HTML.
    pub content: String,
    /// Navigation of the section: HTML of a list.
    pub nav: String,
}

/// The way from a page to the output folder: `../` for each folder in between.
pub fn up(path: &str) -> String {
    "../".repeat(path.matches('/').count())
}

/// The whole page.
pub fn frame(page: &Page) -> String {
    let up = up(&page.path);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title} — bramah</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<link rel=\"stylesheet\" href=\"{up}style.css\">\n</head>\n<body>\n\
         <header><a class=\"mark\" href=\"{up}index.html\">bramah</a>\
         <a href=\"{up}index.html#book\">Book</a><a href=\"{up}index.html#reference\">Reference</a>\
         <a href=\"{up}all.html\">All classes</a></header>\n\
         <div class=\"page\">\n<nav>{nav}</nav>\n<main>\n{content}\n</main>\n</div>\n</body>\n</html>\n",
        title = escape(&page.title),
        nav = page.nav,
        content = page.content,
    )
}

/// Text of several lines as code.
pub fn code(text: &str) -> String {
    format!("<pre><code>{}</code></pre>", text.lines().map(escape).collect::<Vec<_>>().join("\n"))
}

/// The one style sheet.
pub const STYLE: &str = include_str!("style.css");
