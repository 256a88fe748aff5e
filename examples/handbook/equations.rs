//! Equations and statements as blocks of typeset lines.

use super::math;
use bramah::internals::diag::Span;
use bramah::internals::plot::svg::escape;
use bramah::internals::syntax::ast::{Equation, EquationKind, Expr, ExprKind, ForIndex, Statement, StatementKind};

/// Longer equations are cut into lines of about so many characters.
const ROOM: usize = 84;

/// Writes equations; `connect` and `assert` are left to [`connections`] and [`conditions`].
pub fn equations(list: &[Equation]) -> String {
    list.iter().map(equation).collect()
}

/// The places of both sides of every connection, those in loops and branches too.
pub fn connections(list: &[Equation]) -> Vec<(Span, Span)> {
    let mut out = Vec::new();
    for e in list {
        match &e.kind {
            EquationKind::Connect(a, b) => out.push((a.span, b.span)),
            EquationKind::For { body, .. } => out.extend(connections(body)),
            EquationKind::If { branches, otherwise } => {
                branches.iter().for_each(|(_, body)| out.extend(connections(body)));
                out.extend(connections(otherwise));
            }
            _ => {}
        }
    }
    out
}

/// What is asserted: the condition typeset, and the message; those in loops and branches too.
pub fn conditions(list: &[Equation]) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for equation in list {
        match &equation.kind {
            EquationKind::Call(call) => {
                if let Some((condition, message)) = assertion(call) {
                    out.push((format!("<math>{}</math>", math::expression(condition)), message));
                }
            }
            EquationKind::For { body, .. } => out.extend(conditions(body)),
            EquationKind::If { branches, otherwise } => {
                branches.iter().for_each(|(_, body)| out.extend(conditions(body)));
                out.extend(conditions(otherwise));
            }
            _ => {}
        }
    }
    out
}

fn assertion(call: &Expr) -> Option<(&Expr, String)> {
    let ExprKind::Call { function, args, .. } = &call.kind else { return None };
    if function.parts[0].name.name != "assert" {
        return None;
    }
    let message = match args.get(1).map(|m| &m.kind) {
        Some(ExprKind::String(text)) => text.to_string(),
        _ => String::new(),
    };
    args.first().map(|condition| (condition, message))
}

fn equation(e: &Equation) -> String {
    match &e.kind {
        EquationKind::Equal(a, b) => relation(a, "=", b, e.description.as_deref()),
        EquationKind::Connect(..) => String::new(),
        EquationKind::If { branches, otherwise } => {
            let written: Vec<_> = branches.iter().map(|(c, body)| (c, equations(body))).collect();
            let otherwise = equations(otherwise);
            if otherwise.is_empty() && written.iter().all(|(_, body)| body.is_empty()) {
                return String::new();
            }
            alternatives(written.into_iter(), &otherwise, "if", "else if")
        }
        EquationKind::For { iterators, body } => repeated(iterators, &equations(body)),
        EquationKind::When(branches) => {
            alternatives(branches.iter().map(|(c, body)| (c, equations(body))), "", "when", "else when")
        }
        EquationKind::Call(call) if assertion(call).is_some() => String::new(),
        EquationKind::Call(call) => line(&math::expression(call), None),
    }
}

/// Writes statements of an algorithm.
pub fn statements(list: &[Statement]) -> String {
    list.iter().map(statement).collect()
}

fn statement(s: &Statement) -> String {
    match &s.kind {
        StatementKind::Assign(a, b) => relation(a, "≔", b, None),
        StatementKind::AssignTuple(items, b) => {
            let items = items.iter().map(|i| i.as_ref().map_or(String::new(), math::expression)).collect::<Vec<_>>();
            line(&format!("<mo>(</mo>{}<mo>)</mo><mo>≔</mo>{}", items.join("<mo>,</mo>"), math::expression(b)), None)
        }
        StatementKind::Call(call) => line(&math::expression(call), None),
        StatementKind::If { branches, otherwise } => {
            let branches = branches.iter().map(|(c, body)| (c, statements(body)));
            alternatives(branches, &statements(otherwise), "if", "else if")
        }
        StatementKind::For { iterators, body } => repeated(iterators, &statements(body)),
        StatementKind::While(c, body) => alternatives(std::iter::once((c, statements(body))), "", "while", ""),
        StatementKind::When(branches) => {
            alternatives(branches.iter().map(|(c, body)| (c, statements(body))), "", "when", "else when")
        }
        StatementKind::Break => word("break"),
        StatementKind::Return => word("return"),
    }
}

fn word(text: &str) -> String {
    format!("<div class=\"eq\"><span class=\"kw\">{text}</span></div>\n")
}

fn relation(a: &Expr, sign: &str, b: &Expr, description: Option<&str>) -> String {
    let left = math::expression(a);
    let lines = math::lines(b, ROOM.saturating_sub(math::width(a)).max(ROOM / 2));
    if lines.len() == 1 {
        return line(&format!("{left}<mo>{sign}</mo>{}", lines[0]), description);
    }
    let mut rows = String::new();
    for (i, content) in lines.iter().enumerate() {
        let head = if i == 0 { format!("{left}<mo>{sign}</mo>") } else { String::new() };
        rows.push_str(&format!(
            "<mtr><mtd class=\"l\">{head}</mtd><mtd class=\"r\"><mrow>{content}</mrow></mtd></mtr>"
        ));
    }
    line(&format!("<mtable class=\"lines\">{rows}</mtable>"), description)
}

fn line(content: &str, description: Option<&str>) -> String {
    let said = description.map_or(String::new(), |d| format!("<span class=\"said\">{}</span>", escape(d)));
    format!("<div class=\"eq\"><math displaystyle=\"true\"><mrow>{content}</mrow></math>{said}</div>\n")
}

fn alternatives<'a>(
    branches: impl Iterator<Item = (&'a Expr, String)>,
    otherwise: &str,
    first: &str,
    next: &str,
) -> String {
    let mut out = String::new();
    for (i, (condition, body)) in branches.enumerate() {
        let keyword = if i == 0 { first } else { next };
        let condition = math::expression(condition);
        out.push_str(&format!(
            "<div class=\"eq\"><span class=\"kw\">{keyword}</span> <math>{condition}</math></div><div class=\"in\">{body}</div>\n"
        ));
    }
    if !otherwise.is_empty() {
        out.push_str(&format!(
            "<div class=\"eq\"><span class=\"kw\">else</span></div><div class=\"in\">{otherwise}</div>\n"
        ));
    }
    out
}

fn repeated(iterators: &[ForIndex], body: &str) -> String {
    if body.is_empty() {
        return String::new();
    }
    let over = iterators.iter().map(math::iterator).collect::<Vec<_>>().join("<mo>,</mo>");
    format!(
        "<div class=\"eq\"><span class=\"kw\">for</span> <math><mrow>{over}</mrow></math></div><div class=\"in\">{body}</div>\n"
    )
}
