//! Writes a figure as one HTML page with zoom and hover.
//!
//! A [`Figure`] enters, the text of a complete page leaves. It needs no network and no other file: script, style and
//! data are inside. The page also contains the figure as SVG.

use std::fmt::Write as _;

use serde::Serialize;

use super::decimate::{CurvePoints, decimate, staircase};
use super::figure::{Figure, FigurePanel, colour};
use super::svg;
use bramah_results::number;

/// Curves are reduced to four points in each of this many parts. This limits how far zooming shows details.
const COLUMNS: usize = 5_000;
/// Significant digits of the vertical coordinates in the page.
const DIGITS: usize = 7;

/// The page with marks such as `{{title}}`.
const PAGE: &str = include_str!("page.html");
/// The script of the page.
const SCRIPT: &str = include_str!("page.js");

/// The description of a panel for the script; the numbers are stored apart.
#[derive(Serialize)]
struct PanelHead<'a> {
    /// Label of the horizontal axis.
    x: &'a str,
    /// Label of the vertical axis.
    y: &'a str,
    /// Texts for the values 0, 1, 2 and so on; empty for numbers.
    words: &'a [String],
    /// Names of the curves.
    names: Vec<&'a str>,
    /// Colours of the curves.
    colours: Vec<&'a str>,
    /// Which curves are dashed.
    dashed: Vec<bool>,
    /// Which curves are crosses.
    crosses: Vec<bool>,
}

/// Writes the page. `facts` are names and values listed below the picture, such as model and command.
pub fn write(figure: &Figure, facts: &[(String, String)]) -> String {
    write_around(figure, facts, "")
}

/// As `write`, with HTML between the title and the curves. `before` is inserted as it stands and must be escaped.
pub fn write_around(figure: &Figure, facts: &[(String, String)], before: &str) -> String {
    // An HTML page must have a title.
    let title = if figure.title.is_empty() { "bramah" } else { &figure.title };
    let mut rows = String::new();
    for (name, value) in facts {
        let _ = writeln!(rows, "<tr><th>{}</th><td>{}</td></tr>", svg::escape(name), svg::escape(value));
    }
    let parts = [
        ("{{title}}", svg::escape(title)),
        ("{{before}}", before.to_owned()),
        ("{{picture}}", svg::write(figure)),
        ("{{facts}}", rows),
        ("{{head}}", in_script(&head(figure))),
        ("{{curves}}", curves(figure)),
        ("{{script}}", SCRIPT.to_owned()),
    ];
    fill(PAGE, &parts)
}

/// Replaces the marks in a page from left to right. Inserted text is not searched for marks, since names may contain
/// them.
///
/// `parts` are the marks with their texts. A mark without text stays as it is.
fn fill(page: &str, parts: &[(&str, String)]) -> String {
    let mut out = String::new();
    let mut rest = page;
    while let Some(at) = rest.find("{{") {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        match parts.iter().find(|(mark, _)| rest.starts_with(mark)) {
            Some((mark, text)) => {
                out.push_str(text);
                rest = &rest[mark.len()..];
            }
            None => {
                // Two braces that are no mark belong to the page.
                out.push_str("{{");
                rest = &rest[2..];
            }
        }
    }
    out.push_str(rest);
    out
}

/// The description of all panels as JSON.
///
/// It is small; the coordinates follow in a list of their own.
fn head(figure: &Figure) -> String {
    let panel = |p: &'_ FigurePanel| -> serde_json::Value {
        serde_json::to_value(PanelHead {
            x: &p.x_label,
            y: &p.y_label,
            words: &p.words,
            names: p.series.iter().map(|s| s.name.as_str()).collect(),
            colours: p.series.iter().map(|s| colour(s.colour)).collect(),
            dashed: p.series.iter().map(|s| s.dashed).collect(),
            crosses: p.series.iter().map(|s| s.crosses).collect(),
        })
        .expect("texts always serialize")
    };
    let panels: Vec<serde_json::Value> = figure.panels.iter().map(panel).collect();
    serde_json::json!({ "shared": figure.shared_x, "panels": panels }).to_string()
}

/// JSON that is safe inside a script element: `</script>` in a name must not end it.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The coordinates as JSON: a list of panels, each a list of curves, each `x, y, x, y` and so on in one list. Gaps are
/// null.
fn curves(figure: &Figure) -> String {
    let mut out = String::from("[");
    for (i, panel) in figure.panels.iter().enumerate() {
        out.push_str(if i > 0 { ",\n[" } else { "[" });
        for (k, series) in panel.series.iter().enumerate() {
            let points: CurvePoints = if series.held {
                staircase(&series.x, &series.y)
            } else {
                series.x.iter().copied().zip(series.y.iter().copied()).collect()
            };
            // Crosses mark single points, which must all stay.
            let points = if series.crosses { points } else { decimate(points, COLUMNS) };
            out.push_str(if k > 0 { ",\n[" } else { "[" });
            for (n, (x, y)) in points.into_iter().enumerate() {
                let separator = if n > 0 { "," } else { "" };
                let _ = write!(out, "{separator}{},{}", json_number(x, 12), json_number(y, DIGITS));
            }
            out.push(']');
        }
        out.push(']');
    }
    out.push(']');
    out
}

/// A number with so many significant digits; `null` when it is not finite, because JSON has no NaN.
fn json_number(value: f64, digits: usize) -> String {
    if value.is_finite() { number::rounded(value, digits) } else { "null".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::figure::PlotSeries;
    use super::*;

    #[test]
    fn one_page_without_network() {
        let series = PlotSeries {
            name: "</script>{{facts}}".into(),
            x: vec![0.0, 1.0],
            y: vec![1e5, f64::NAN],
            ..PlotSeries::default()
        };
        let panels = vec![FigurePanel { series: vec![series], ..FigurePanel::default() }];
        let figure = Figure { title: "a < b".into(), panels, shared_x: true };
        let page = write(&figure, &[("model".into(), "A & B".into())]);
        assert!(page.contains("[[[0,100000,1,null]]]"), "{page}");
        assert!(page.contains("<td>A &amp; B</td>"));
        assert_eq!(page.matches("</script>").count(), 1);
        assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http"));
    }
}
