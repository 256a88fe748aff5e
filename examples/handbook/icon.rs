//! The box of a component with its ports, its name below: squares for physical ports, triangles for signals.

use bramah::internals::plot::network::symbols::FIELD;
use bramah::internals::plot::svg::escape;
use std::fmt::Write as _;

/// What a port carries, by its connector.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    Square(&'static str),
    Into(&'static str),
    Out(&'static str),
}

/// A port of a box.
pub struct Port {
    /// Its name.
    pub name: String,
    /// The last word of its connector's name.
    pub connector: String,
    /// Only there under a condition: drawn dashed.
    pub conditional: bool,
}

fn look(connector: &str) -> Look {
    match connector {
        "HydraulicPort" => Look::Square("#1769aa"),
        "RotationalFlange" => Look::Square("#6b7280"),
        "TranslationalFlange" => Look::Square("#4d7c0f"),
        "Pin" => Look::Square("#7c3aed"),
        "HeatPort" => Look::Square("#b91c1c"),
        "RealOutput" => Look::Out("#0f766e"),
        "IntegerOutput" => Look::Out("#b45309"),
        "BooleanOutput" => Look::Out("#a21caf"),
        "RealInput" => Look::Into("#0f766e"),
        "IntegerInput" => Look::Into("#b45309"),
        "BooleanInput" => Look::Into("#a21caf"),
        _ => Look::Square("#111827"),
    }
}

/// Inputs and first ports stand left, outputs and second ports right.
fn stands_right(port: &Port, others: &[Port]) -> bool {
    match look(&port.connector) {
        Look::Into(_) => false,
        Look::Out(_) => true,
        Look::Square(_) => {
            let name = port.name.as_str();
            let ends = |tails: &[&str]| tails.iter().any(|t| name.ends_with(t));
            let second = ends(&["_b", "_2", "_B", "_T", "_n"]) || ["n", "dc_n", "heatPort"].contains(&name);
            let alone = others.iter().filter(|o| matches!(look(&o.connector), Look::Square(_))).count() == 1;
            second || (port.connector.ends_with("Flange") && !ends(&["_a"]) && !alone)
        }
    }
}

const ROW: f64 = 24.0;
const WIDTH: f64 = 300.0;
const EDGE: f64 = 92.0;

/// Draws the box with the symbol of its class, if there is one; empty without ports.
pub fn draw(name: &str, symbol: Option<&str>, ports: &[Port]) -> String {
    if ports.is_empty() {
        return String::new();
    }
    let (right, left): (Vec<&Port>, Vec<&Port>) = ports.iter().partition(|p| stands_right(p, ports));
    let rows = left.len().max(right.len()).max(if symbol.is_some() { 3 } else { 2 }) as f64;
    let height = rows * ROW + 20.0;
    let mut out = format!(
        "<svg class=\"box\" viewBox=\"0 0 {WIDTH} {h}\" width=\"{WIDTH}\" height=\"{h}\" role=\"img\">\
         <title>{n} with its ports</title>\
         <rect x=\"{EDGE}\" y=\"4\" width=\"{w}\" height=\"{height}\" rx=\"3\" fill=\"#fbfbfa\" stroke=\"#9ca3af\"/>\
         <text x=\"{c}\" y=\"{m}\" text-anchor=\"middle\" class=\"name\">{n}</text>",
        h = height + 26.0,
        w = WIDTH - 2.0 * EDGE,
        c = WIDTH / 2.0,
        m = height + 20.0,
        n = escape(name),
    );
    if let Some(symbol) = symbol {
        let (x, y) = ((WIDTH - FIELD) / 2.0, 4.0 + (height - FIELD) / 2.0);
        let _ = write!(out, "<g transform=\"translate({x} {y})\" color=\"#1f3a4d\">{symbol}</g>");
    }
    for (side, list) in [(false, &left), (true, &right)] {
        let step = height / list.len().max(1) as f64;
        for (i, port) in list.iter().enumerate() {
            mark(&mut out, port, side, 4.0 + step * (i as f64 + 0.5));
        }
    }
    out.push_str("</svg>");
    out
}

fn mark(out: &mut String, port: &Port, right: bool, y: f64) {
    let x = if right { WIDTH - EDGE } else { EDGE };
    let dash = if port.conditional { " stroke-dasharray=\"2 2\"" } else { "" };
    let fill = |colour: &'static str| if port.conditional { "#ffffff" } else { colour };
    let (shape, colour) = match look(&port.connector) {
        Look::Square(c) => (format!("<rect x=\"{}\" y=\"{}\" width=\"10\" height=\"10\"", x - 5.0, y - 5.0), c),
        Look::Into(c) | Look::Out(c) => (format!("<path d=\"M{} {} l11 6 l-11 6 z\"", x - 5.0, y - 6.0), c),
    };
    let _ = write!(out, "{shape} fill=\"{}\" stroke=\"{colour}\"{dash}/>", fill(colour));
    let (at, anchor) = if right { (x + 11.0, "start") } else { (x - 11.0, "end") };
    let _ = write!(out, "<text x=\"{at}\" y=\"{}\" text-anchor=\"{anchor}\">{}</text>", y + 4.0, escape(&port.name));
}
