//! Texts about declarations for hover, completion and signatures: the line of a declaration, descriptions,
//! documentation.

use bramah_model::resolve::names::{self, MemberComponent, NameTarget};
use bramah_model::resolve::{ClassId, Library};
use bramah_syntax::ast::{
    CausalityPrefix, ClassKind, ComponentDeclaration, ElementPrefixes, ExprKind, Modification,
    ModificationArgumentKind, TypePrefix, VariabilityPrefix,
};

/// A string attribute of a component, such as `unit`. `None`: it is not declared, or not a string literal.
///
/// The attribute may be declared with the component or with its type.
pub(super) fn attribute<'a>(library: &mut Library<'a>, member: MemberComponent<'a>, name: &str) -> Option<String> {
    match &names::attribute(library, member, name)?.kind {
        ExprKind::String(text) => Some(text.to_string()),
        _ => None,
    }
}

/// The declaration of a component as one line, such as `parameter SI.Volume V = 1e-5`.
///
/// Modifiers in brackets are left out, and array sizes are shown as colons.
pub(super) fn declaration(library: &Library<'_>, component: &ComponentDeclaration) -> String {
    let mut out = prefixes(&component.prefixes, &component.prefix);
    out.push_str(&component.class.dotted());
    out.push(' ');
    out.push_str(component.name.name.as_str());
    if !component.subscripts.is_empty() {
        out.push_str(&format!("[{}]", vec![":"; component.subscripts.len()].join(", ")));
    }
    if let Some(value) = component.modification.as_ref().and_then(|m| m.value.as_ref()) {
        out.push_str(&format!(" = {}", library.sources.text(value.span)));
    }
    if let Some(condition) = &component.condition {
        out.push_str(&format!(" if {}", library.sources.text(condition.span)));
    }
    out
}

/// The prefixes in the order in which Modelica demands them, each followed by a blank.
///
/// They are empty for a component without prefixes.
fn prefixes(all: &ElementPrefixes, prefix: &TypePrefix) -> String {
    let words = [
        (all.final_, "final "),
        (all.inner, "inner "),
        (all.outer, "outer "),
        (all.replaceable, "replaceable "),
        (prefix.flow, "flow "),
        (prefix.stream, "stream "),
        (prefix.variability == Some(VariabilityPrefix::Constant), "constant "),
        (prefix.variability == Some(VariabilityPrefix::Parameter), "parameter "),
        (prefix.variability == Some(VariabilityPrefix::Discrete), "discrete "),
        (prefix.causality == Some(CausalityPrefix::Input), "input "),
        (prefix.causality == Some(CausalityPrefix::Output), "output "),
    ];
    words.iter().filter(|(is_there, _)| *is_there).map(|(_, word)| *word).collect()
}

/// The head of a class as one line, such as `model Hydraulic.Pump`.
pub(super) fn class_line(library: &Library<'_>, id: ClassId) -> String {
    let class = library.class(id);
    let partial = if class.prefixes.partial { "partial " } else { "" };
    format!("{partial}{} {}", class.kind.word(), library.full_name(id))
}

/// The description string of a declaration. `None`: it has none, or is a loop variable.
pub(super) fn description<'a>(library: &Library<'a>, target: NameTarget<'a>) -> Option<&'a str> {
    match target {
        NameTarget::Class(id) => library.class(id).description.as_deref(),
        NameTarget::Component(member) => member.component.description.as_deref(),
        NameTarget::Literal(_, literal) => literal.description.as_deref(),
        NameTarget::Iterator(_) => None,
    }
}

/// The HTML text of the annotation `Documentation(info = ...)` of a class. `None`: it has none.
///
/// It may contain any HTML; see `markdown`.
pub(super) fn documentation<'a>(library: &Library<'a>, id: ClassId) -> Option<&'a str> {
    let annotation = library.class(id).annotation.as_ref()?;
    let info = inner(inner(annotation, "Documentation")?, "info")?;
    match &info.value.as_ref()?.kind {
        ExprKind::String(text) => Some(text),
        _ => None,
    }
}

/// The modification of the element `name` among the arguments of another one.
///
/// `None`: there is no argument of this name, or it is a redeclaration.
fn inner<'m>(modification: &'m Modification, name: &str) -> Option<&'m Modification> {
    modification.arguments.iter().find_map(|a| match &a.kind {
        ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == name => Some(m),
        _ => None,
    })
}

/// Converts the HTML of a documentation to Markdown. Only paragraphs, lists, code, emphasis, headings and tables are
/// kept in rough form.
///
/// Unknown tags are dropped and their content is kept. Attributes are ignored, so links appear as their text.
pub(super) fn markdown(html: &str) -> String {
    let mut out = String::new();
    let mut rest = html;
    while let Some(at) = rest.find('<') {
        out.push_str(&entities(&rest[..at]));
        // Documentation that is being written may end inside a tag.
        let Some(end) = rest[at..].find('>') else { break };
        let tag = rest[at + 1..at + end].split_whitespace().next().unwrap_or("").to_lowercase();
        out.push_str(match tag.as_str() {
            "p" | "/p" | "br" | "br/" | "/ul" | "/ol" | "/table" | "/h4" | "/tr" => "\n\n",
            "li" => "\n- ",
            "code" | "/code" => "`",
            "em" | "/em" | "i" | "/i" => "*",
            "b" | "/b" | "strong" | "/strong" => "**",
            "h1" | "h2" | "h3" | "h4" => "\n\n### ",
            "td" | "th" => " ",
            _ => "",
        });
        rest = &rest[at + end + 1..];
    }
    out.push_str(&entities(rest));
    // Several empty lines become one, since tags and line breaks of the source both add some.
    let mut lines = Vec::new();
    for line in out.lines().map(str::trim) {
        if !(line.is_empty() && lines.last().is_none_or(|l: &&str| l.is_empty())) {
            lines.push(line);
        }
    }
    lines.join("\n").trim_end().to_owned()
}

/// Replaces the common HTML entities.
fn entities(text: &str) -> String {
    // `&amp;` comes last, so that `&amp;lt;` becomes `&lt;` and not `<`.
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&nbsp;", " ").replace("&amp;", "&")
}

/// Whether a class is a function, whose arguments are its inputs.
///
/// Operator functions count too.
pub(super) fn is_function(library: &Library<'_>, id: ClassId) -> bool {
    matches!(library.class(id).kind, ClassKind::Function { .. })
}
