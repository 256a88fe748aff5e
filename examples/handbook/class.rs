//! The page of a class: box, words, ports, parameters, equations, an example with its picture, the source.

use super::facts::{self, Facts};
use super::library::{self, Catalogue, Given, MemberComponent};
use super::run::{self, Runs};
use super::shell::{Page, code, up};
use super::tables;
use super::{equations, icon};
use bramah::internals::plot::network::symbols::symbol;
use bramah::internals::plot::svg::escape;
use bramah::internals::resolve::{ClassId, Library};
use bramah::internals::syntax::ast::{CausalityPrefix, Class, ClassBody, ClassKind, ExprKind, VariabilityPrefix};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What pages are made from.
pub struct Press<'l, 'a> {
    /// The classes.
    pub library: &'l mut Library<'a>,
    /// What there is.
    pub catalogue: &'l Catalogue,
    /// Runs of examples.
    pub runs: &'l mut Runs,
    /// Pictures made on the way, by path.
    pub pictures: BTreeMap<String, Vec<u8>>,
}

/// Where the page of a class stands.
pub fn path(name: &str) -> String {
    format!("reference/{name}.html")
}

impl<'a> Press<'_, 'a> {
    /// A link to the page of a class, where it has one.
    pub fn link(&mut self, id: ClassId, text: &str) -> String {
        let full = self.library.full_name(id);
        let text = escape(text);
        if self.catalogue.classes.contains_key(&full) { format!("<a href=\"{full}.html\">{text}</a>") } else { text }
    }

    /// The page of a class.
    pub fn page(&mut self, name: &str, id: ClassId) -> Page {
        let class = self.library.class(id);
        let content = if class.kind == ClassKind::Package { self.package(name, id) } else { self.class(name, id) };
        Page { path: path(name), title: name.to_owned(), content, nav: self.nav(name) }
    }

    /// The siblings of a class, and the way up.
    fn nav(&mut self, name: &str) -> String {
        let is_package = self.catalogue.members.contains_key(name);
        let package = if is_package { name } else { name.rsplit_once('.').map_or("", |(p, _)| p) };
        let mut out = String::new();
        if let Some((above, _)) = package.rsplit_once('.') {
            let _ = write!(out, "<h2>In</h2><ul><li><a href=\"{above}.html\">{above}</a></li></ul>");
        } else {
            let _ = write!(out, "<h2>Packages</h2><ul>");
            for p in library::PACKAGES.iter().filter(|p| **p != package || package.is_empty()) {
                let _ = write!(out, "<li><a href=\"{p}.html\">{p}</a></li>");
            }
            out.push_str("</ul>");
        }
        let _ = write!(out, "<h2><a href=\"{package}.html\">{package}</a></h2><ul>");
        for member in self.catalogue.members.get(package).into_iter().flatten() {
            let short = member.rsplit('.').next().unwrap_or(member);
            let here = if member == name { " class=\"here\"" } else { "" };
            let _ = write!(out, "<li><a{here} href=\"{member}.html\">{short}</a></li>");
        }
        out.push_str("</ul>");
        out
    }

    fn package(&mut self, name: &str, id: ClassId) -> String {
        let mut out = self.head(name, id);
        out.push_str(&self.words(id));
        out.push_str("<ul class=\"cards\">");
        for member in self.catalogue.members.get(name).cloned().unwrap_or_default() {
            let class = self.library.class(self.catalogue.classes[&member]);
            let short = member.rsplit('.').next().unwrap_or(&member);
            let said = escape(class.description.as_deref().unwrap_or_default());
            let _ = write!(out, "<li><a href=\"{member}.html\">{short}</a><span>{said}</span></li>");
        }
        out.push_str("</ul>");
        out
    }

    fn head(&mut self, name: &str, id: ClassId) -> String {
        let class = self.library.class(id);
        let mut way = Vec::new();
        for (i, _) in name.match_indices('.') {
            let above = &name[..i];
            way.push(format!("<a href=\"{above}.html\">{}</a>", above.rsplit('.').next().unwrap_or(above)));
        }
        let short = name.rsplit('.').next().unwrap_or(name);
        let said =
            class.description.as_deref().map_or(String::new(), |d| format!("<p class=\"lead\">{}</p>", escape(d)));
        format!(
            "<p class=\"path\">{}</p><h1>{short}<span class=\"badge\">{}</span></h1>{said}",
            way.join(" · "),
            kind(class)
        )
    }

    /// The documentation of a class: its HTML with names of classes linked.
    fn words(&mut self, id: ClassId) -> String {
        let Some(info) = documentation(self.library.class(id)) else { return String::new() };
        let parts = facts::split(&info);
        let mut out = self.linked(id, &parts.words);
        let rows = [("Limits", &parts.limits), ("Sources", &parts.sources)];
        if rows.iter().any(|(_, t)| !t.is_empty()) {
            out.push_str("<dl class=\"facts\">");
            for (label, text) in rows.iter().filter(|(_, t)| !t.is_empty()) {
                let _ = write!(out, "<dt>{label}</dt><dd>{}</dd>", self.linked(id, text));
            }
            out.push_str("</dl>");
        }
        out
    }

    /// Names in `<code>` that mean a class here become links.
    fn linked(&mut self, id: ClassId, html: &str) -> String {
        let mut out = String::new();
        let mut rest = html;
        while let Some((before, after)) = rest.split_once("<code>") {
            let Some((code, tail)) = after.split_once("</code>") else { break };
            out.push_str(before);
            let found =
                facts::class_words(code).and_then(|parts| library::named(self.library, Some(id), &parts, false));
            match found.filter(|f| *f != id) {
                Some(class) => {
                    let link = self.link(class, code);
                    let _ = write!(out, "<code>{link}</code>");
                }
                None => {
                    let _ = write!(out, "<code>{code}</code>");
                }
            }
            rest = tail;
        }
        out.push_str(rest);
        out
    }

    fn class(&mut self, name: &str, id: ClassId) -> String {
        let (members, given) = library::members(self.library, id);
        let mut out = self.head(name, id);
        let words = self.words(id);
        let lineage = self.lineage(id);
        let symbol = symbol(std::iter::once(name).chain(lineage.iter().map(String::as_str)));
        let picture = icon::draw(name.rsplit('.').next().unwrap_or(name), symbol, &self.ports(&members));
        let _ = write!(out, "<div class=\"top\"><div>{words}{}</div>{picture}</div>", self.kin(name, id));
        out.push_str(&self.declared(id, &members, &given));
        out.push_str(&self.laws(id));
        out.push_str(&self.example(name, id));
        out.push_str(&self.source(id));
        out
    }

    /// Full names of the classes that a class extends, those next to it first.
    fn lineage(&mut self, id: ClassId) -> Vec<String> {
        let mut found = Vec::new();
        let mut next = vec![id];
        while let Some(class) = next.pop() {
            for base in library::bases(self.library, class) {
                found.push(self.library.full_name(base));
                next.push(base);
            }
        }
        found
    }

    /// What the class extends and who extends it.
    fn kin(&mut self, name: &str, id: ClassId) -> String {
        let bases = library::bases(self.library, id);
        let bases: Vec<String> = bases
            .into_iter()
            .map(|b| {
                let full = self.library.full_name(b);
                self.link(b, &full)
            })
            .collect();
        let heirs: Vec<String> = self
            .catalogue
            .extended_by
            .get(name)
            .into_iter()
            .flatten()
            .filter(|heir| !heir.contains(".Examples."))
            .map(|heir| format!("<a href=\"{heir}.html\">{heir}</a>"))
            .collect();
        let mut out = String::new();
        for (label, list) in [("Extends", bases), ("Extended by", heirs)] {
            if !list.is_empty() {
                let _ = write!(out, "<dt>{label}</dt><dd>{}</dd>", list.join(", "));
            }
        }
        if out.is_empty() { out } else { format!("<dl class=\"facts\">{out}</dl>") }
    }

    fn ports(&mut self, members: &[MemberComponent<'a>]) -> Vec<icon::Port> {
        let mut out = Vec::new();
        for member in members.iter().filter(|m| !m.protected) {
            if let Some(connector) = self.connector(member) {
                out.push(icon::Port {
                    name: member.component.name.name.as_str().to_owned(),
                    connector: connector.rsplit('.').next().unwrap_or_default().to_owned(),
                    conditional: member.component.condition.is_some(),
                });
            }
        }
        out
    }

    /// The full name of a component's class when that is a connector.
    pub fn connector(&mut self, member: &MemberComponent<'a>) -> Option<String> {
        let id = library::resolve(self.library, member.owner, &member.component.class)?;
        let is = matches!(self.library.class(id).kind, ClassKind::Connector { .. });
        is.then(|| self.library.full_name(id))
    }

    fn declared(&mut self, id: ClassId, members: &[MemberComponent<'a>], given: &Given<'a>) -> String {
        let mut groups: [Vec<&MemberComponent<'a>>; 4] = Default::default();
        for member in members.iter().filter(|m| !m.protected) {
            let c = member.component;
            let plain_input = c.prefix.causality == Some(CausalityPrefix::Input);
            let at = match c.prefix.variability {
                Some(VariabilityPrefix::Parameter | VariabilityPrefix::Constant) => 1,
                _ if self.connector(member).is_some() || plain_input => 0,
                _ if c.prefix.causality == Some(CausalityPrefix::Output) => 0,
                _ if c.prefixes.replaceable || facts::is_part(self.library, member) => 2,
                _ => 3,
            };
            groups[at].push(member);
        }
        let [ports, parameters, parts, variables] = groups;
        let function = matches!(self.library.class(id).kind, ClassKind::Function { .. });
        let mut out = if function { tables::arguments(self, ports) } else { tables::ports(self, &ports) };
        out.push_str(&tables::parameters(self, id, &parameters, given));
        out.push_str(&tables::parts(self, &parts));
        out.push_str(&tables::variables(self, &variables));
        out
    }

    /// Equations or statements of the class and of what it inherits.
    fn laws(&mut self, id: ClassId) -> String {
        let mut out = String::new();
        for owner in library::lineage(self.library, id) {
            let class = self.library.class(owner);
            let Some(body) = library::body(class) else { continue };
            let mut text = equations::equations(&body.equations);
            body.algorithms.iter().for_each(|a| text.push_str(&equations::statements(a)));
            let mut start = equations::equations(&body.initial_equations);
            body.initial_algorithms.iter().for_each(|a| start.push_str(&equations::statements(a)));
            if !start.is_empty() {
                let _ = write!(text, "<h3>At the start</h3>{start}");
            }
            let joined = self.joined(body);
            let musts = musts(body);
            if text.is_empty() && joined.is_empty() && musts.is_empty() {
                continue;
            }
            if owner != id {
                let full = self.library.full_name(owner);
                let _ = write!(out, "<h3>From {}</h3>", self.link(owner, &full));
            }
            let _ = write!(out, "<div class=\"eqs\">{text}</div>{joined}{musts}");
        }
        let title =
            if matches!(self.library.class(id).kind, ClassKind::Function { .. }) { "Algorithm" } else { "Equations" };
        if out.is_empty() { out } else { format!("<h2>{title}</h2>{out}") }
    }

    fn joined(&mut self, body: &bramah::internals::syntax::ast::LongBody) -> String {
        let sources = &self.library.sources;
        let rows: Vec<String> = equations::connections(&body.equations)
            .into_iter()
            .map(|(a, b)| {
                format!("<code>{}</code> — <code>{}</code>", escape(sources.text(a)), escape(sources.text(b)))
            })
            .collect();
        if rows.is_empty() {
            return String::new();
        }
        let word = if rows.len() == 1 { "connection" } else { "connections" };
        format!("<details><summary>{} {word}</summary><p>{}</p></details>", rows.len(), rows.join("<br>"))
    }

    /// The example with the picture of what the class does in it.
    fn example(&mut self, name: &str, id: ClassId) -> String {
        let runnable = library::is_runnable(self.library.class(id));
        let shown = if runnable {
            Some((name.to_owned(), String::new()))
        } else {
            self.catalogue.shown_in.get(name).and_then(|list| list.first()).cloned()
        };
        let Some((example, at)) = shown else { return String::new() };
        let mut out = String::from("<h2>Example</h2>");
        if !runnable {
            let _ = write!(out, "<p><a href=\"{example}.html\">{example}</a>, here <code>{at}</code></p>");
            let text = self.text(self.catalogue.classes[&example]);
            out.push_str(&code(&text));
        }
        out.push_str(&code(&format!("bramah simulate {example} -o out.csv")));
        let drawn = self.runs.of(&example).and_then(|t| if runnable { run::overview(t) } else { run::picture(t, &at) });
        if let Some(svg) = drawn {
            let file = format!("pictures/{name}.svg");
            let said = if runnable { format!("What {name} does") } else { format!("What {at} does in {example}") };
            let _ =
                write!(out, "<figure><img src=\"{}{file}\" alt=\"{said}\" loading=\"lazy\"></figure>", up(&path(name)));
            self.pictures.insert(file, svg.into_bytes());
        }
        out
    }

    /// The text of a class without its documentation, which stands on the page already.
    fn text(&self, id: ClassId) -> String {
        let class = self.library.class(id);
        self.library.sources.text(class.span).to_owned()
    }

    fn source(&mut self, id: ClassId) -> String {
        let text = self.text(id);
        format!("<h2>Source</h2><details><summary>Modelica</summary>{}</details>", code(&text))
    }
}

fn musts(body: &bramah::internals::syntax::ast::LongBody) -> String {
    let list = equations::conditions(&body.equations);
    if list.is_empty() {
        return String::new();
    }
    let rows: String = list.iter().map(|(c, m)| format!("<tr><td>{c}</td><td>{}</td></tr>", escape(m))).collect();
    format!("<div class=\"wide\"><table><tr><th>must hold</th><th>else</th></tr>{rows}</table></div>")
}

/// The documentation of a class as written.
pub fn documentation(class: &Class) -> Option<String> {
    match &library::annotation(class, &["Documentation", "info"])?.value.as_ref()?.kind {
        ExprKind::String(text) => Some(text.to_string()),
        _ => None,
    }
}

fn kind(class: &Class) -> String {
    let word = match (&class.kind, &class.body) {
        (_, ClassBody::Enumeration(_)) => "enumeration",
        (ClassKind::Class, _) => "class",
        (ClassKind::Model, _) => "model",
        (ClassKind::Block, _) => "block",
        (ClassKind::Record { .. }, _) => "record",
        (ClassKind::Connector { .. }, _) => "connector",
        (ClassKind::Type, _) => "type",
        (ClassKind::Package, _) => "package",
        (ClassKind::Function { .. }, _) => "function",
        (ClassKind::Operator, _) => "operator",
    };
    if class.prefixes.partial { format!("partial {word}") } else { word.to_owned() }
}

/// Attributes of a declaration that tables show.
pub fn facts_of<'a>(press: &mut Press<'_, 'a>, member: &MemberComponent<'a>) -> Facts {
    facts::of(press.library, member)
}
