//! Draws the network of a model: components as boxes with ports and symbols, connections coloured by their connector.
//!
//! A [`ComponentGraph`] enters, an SVG text leaves. `layout` decides where boxes are, `symbols` has the symbols, this
//! module draws. Marks colour ports and components, for example where a diagnosis suspects an effect.

mod layout;
pub mod symbols;

use std::fmt::Write as _;

use indexmap::IndexSet;
use petgraph::visit::EdgeRef;

use super::figure::colour;
use super::svg::{begin, escape};
use bramah_model::network::{ComponentBox, ComponentGraph};
use layout::{BoxSide, DiagramLayout};

/// Red, green and blue of the hottest mark.
const HOT: [f64; 3] = [213.0, 94.0, 0.0];

/// A mark at a port or component, drawn as a colour between white and `HOT`.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMark {
    /// Full name of a port, or of anything inside a component.
    pub name: String,
    /// Heat from 0 (nothing) to 1.
    pub heat: f64,
    /// Text that appears under the pointer.
    pub note: String,
}

/// Draws the components and connections of the top level of a model.
///
/// `title` stands above the drawing.
pub fn write(graph: &ComponentGraph, title: &str) -> String {
    write_marked(graph, title, &[])
}

/// As `write`, with marks.
///
/// The note of a mark appears under the pointer.
///
/// A mark of a port at the top level gives a coloured dot, and its connections are coloured when both ends are marked.
/// A mark deeper inside tints its component.
pub fn write_marked(graph: &ComponentGraph, title: &str, marks: &[HeatMark]) -> String {
    let layout = DiagramLayout::new(graph);
    let connectors: IndexSet<&str> = graph.edge_weights().map(|w| w.connector.as_str()).collect();
    // Four entries in a line.
    let legend = 24.0 * connectors.len().div_ceil(4) as f64;
    // A small network still needs room for its title and legend.
    let (width, height) = (layout.width.max(420.0), layout.height + 56.0 + legend);
    let mut out = begin(width.round(), height.round(), 13, title);
    let _ = write!(
        out,
        "<text x=\"20\" y=\"28\" font-size=\"16\">{}</text>\n<g transform=\"translate(0 44)\">\n",
        escape(title)
    );
    // Coloured connections are wide and drawn first, so that the lines lie on top of them.
    for edge in graph.edge_references().filter(|_| !marks.is_empty()) {
        let wire = edge.weight();
        let ends = [(edge.source(), &wire.from), (edge.target(), &wire.to)];
        // Both ends must be marked. The cooler one decides the colour.
        let heats = ends.map(|(n, port)| hottest(marks, &graph[n], port).map_or(0.0, |m| m.heat));
        if heats[0].min(heats[1]) > 0.0 {
            let stroke = (warm(heats[0].min(heats[1])), 9.0);
            draw_wire(&mut out, &layout, ends.map(|(n, port)| (n.index(), port.as_str())), (&stroke.0, stroke.1));
        }
    }
    for edge in graph.edge_references() {
        let wire = edge.weight();
        let index = connectors.get_index_of(wire.connector.as_str()).unwrap_or(0);
        let ends = [(edge.source(), &wire.from), (edge.target(), &wire.to)];
        draw_wire(&mut out, &layout, ends.map(|(n, port)| (n.index(), port.as_str())), (colour(index), 1.8));
    }
    // Boxes hide the ends of the lines beneath them.
    for node in graph.node_indices() {
        draw_box(&mut out, &layout, node.index(), graph, marks);
    }
    for (i, connector) in connectors.iter().enumerate() {
        let (x, y) = (20.0 + 240.0 * (i % 4) as f64, layout.height + 14.0 + 24.0 * (i / 4) as f64);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.0} {:.0}h28\" stroke=\"{}\" stroke-width=\"2.5\"/><text x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
            y - 4.5,
            colour(i),
            x + 36.0,
            escape(short(connector))
        );
    }
    out.push_str("</g>\n</svg>\n");
    out
}

/// The last part of a class name: `HydraulicPort` of `Interfaces.HydraulicPort`.
fn short(class: &str) -> &str {
    class.rsplit('.').next().unwrap_or(class)
}

/// Draws a connection as a curve between two ports.
///
/// `ends` are the node and port of each end. Colour and width of the line follow.
fn draw_wire(out: &mut String, layout: &DiagramLayout, ends: [(usize, &str); 2], (stroke, width): (&str, f64)) {
    let [(first, _), (second, _)] = ends;
    let a = layout.end(first, ends[0].1, second);
    let b = layout.end(second, ends[1].1, first);
    // The curve leaves each port horizontally; the reach grows with the distance.
    let reach = |p: &layout::WireEnd| {
        let distance = ((a.x - b.x).abs() * 0.45).clamp(28.0, 120.0) + 0.06 * (a.y - b.y).abs().min(300.0);
        if p.side == BoxSide::Left { p.x - distance } else { p.x + distance }
    };
    let _ = writeln!(
        out,
        "<path d=\"M{:.1} {:.1}C{:.1} {:.1} {:.1} {:.1} {:.1} {:.1}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>",
        a.x,
        a.y,
        reach(&a),
        a.y,
        reach(&b),
        b.y,
        b.x,
        b.y
    );
}

/// The hottest mark of a port. With an empty `port`, the hottest mark of anything inside the component that is no port.
///
/// A mark belongs to the component whose name its own name begins with. `None`: there is no mark.
fn hottest<'a>(marks: &'a [HeatMark], component: &ComponentBox, port: &str) -> Option<&'a HeatMark> {
    let at = |m: &&HeatMark| {
        let (name, rest) = m.name.split_once('.').unwrap_or((&m.name, ""));
        let own = name == component.name;
        if port.is_empty() { own && !component.ports.iter().any(|p| p == rest) } else { own && rest == port }
    };
    marks.iter().filter(at).max_by(|a, b| a.heat.total_cmp(&b.heat))
}

/// The colour of a heat: from nearly white to `HOT`.
///
/// Even the smallest heat differs visibly from white.
fn warm(heat: f64) -> String {
    let part = 0.15 + 0.85 * heat.clamp(0.0, 1.0);
    let [r, g, b] = HOT.map(|c| (255.0 + part * (c - 255.0)).round());
    format!("#{:02x}{:02x}{:02x}", r as u8, g as u8, b as u8)
}

/// Draws the box of a component with name, class, symbol and ports.
///
/// Name and class are also the title of the box, which viewers show under the pointer.
fn draw_box(out: &mut String, layout: &DiagramLayout, node: usize, graph: &ComponentGraph, marks: &[HeatMark]) {
    let component = &graph[petgraph::graph::NodeIndex::new(node)];
    let place = &layout.boxes[node];
    let middle = place.x + place.width / 2.0;
    // The ports of the model itself belong to a component without name.
    let (name, class) = if component.name.is_empty() { ("(model)", "") } else { (&*component.name, &*component.class) };
    let mark = hottest(marks, component, "");
    // Half the heat, so that the text on the box stays readable.
    let fill = mark.map_or_else(|| "#f7f7f7".to_string(), |m| warm(0.5 * m.heat));
    let note = mark.map_or_else(String::new, |m| format!(", {}", escape(&m.note)));
    let _ = writeln!(
        out,
        "<g><title>{} {}{note}</title><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"5\" fill=\"{fill}\" stroke=\"#555555\"/>\n\
         <text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
         <text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"10.5\" fill=\"#666666\">{}</text>",
        escape(class),
        escape(name),
        place.x,
        place.y,
        place.width,
        place.height,
        place.y + 17.0,
        escape(name),
        place.y + 31.0,
        escape(short(class))
    );
    if let Some(symbol) = place.symbol {
        let (x, y) = place.symbol_place();
        let scale = layout::SYMBOL / symbols::FIELD;
        let _ =
            writeln!(out, "<g transform=\"translate({x:.1} {y:.1}) scale({scale:.4})\" color=\"#1f3a4d\">{symbol}</g>");
    }
    // A port may be drawn on both sides of its box.
    let places = component.ports.iter().flat_map(|port| layout.places(node, port).into_iter().map(move |p| (port, p)));
    for (port, p) in places {
        let (x, anchor) = if p.side == BoxSide::Left { (p.x + 7.0, "start") } else { (p.x - 7.0, "end") };
        let mark = hottest(marks, component, port).filter(|_| !port.is_empty());
        let radius = mark.map_or(3.2, |m| 3.2 + 4.0 * m.heat);
        let fill = mark.map_or_else(|| "#ffffff".to_string(), |m| warm(m.heat));
        let note = mark.map_or_else(String::new, |m| format!("<title>{}</title>", escape(&m.note)));
        let note = if note.is_empty() { "/>".to_string() } else { format!(">{note}</circle>") };
        let _ = writeln!(
            out,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"#555555\"{note}\
             <text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"10\" fill=\"#444444\" text-anchor=\"{anchor}\">{}</text>",
            p.x,
            p.y,
            p.y + 3.5,
            escape(port)
        );
    }
    out.push_str("</g>\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_model::network::ComponentEdge;

    fn graph(names: &[&str], wires: &[(usize, &str, usize, &str)]) -> ComponentGraph {
        let mut graph = ComponentGraph::default();
        let nodes: Vec<_> = names
            .iter()
            .map(|n| {
                graph.add_node(ComponentBox {
                    name: (*n).into(),
                    class: format!("Lib.{n}"),
                    bases: vec![],
                    ports: vec![],
                })
            })
            .collect();
        for &(a, from, b, to) in wires {
            for (node, port) in [(a, from), (b, to)] {
                let ports = &mut graph[nodes[node]].ports;
                if !ports.iter().any(|p| p == port) {
                    ports.push(port.into());
                }
            }
            let wire = ComponentEdge { from: from.into(), to: to.into(), connector: "Lib.Port".into() };
            graph.add_edge(nodes[a], nodes[b], wire);
        }
        graph
    }

    /// No two boxes may cover each other.
    fn assert_apart(layout: &DiagramLayout) {
        for (i, a) in layout.boxes.iter().enumerate() {
            for b in &layout.boxes[..i] {
                let apart =
                    a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
                assert!(apart, "{a:?} {b:?}");
            }
            assert!(a.x >= 0.0 && a.y >= 0.0 && a.x + a.width <= layout.width && a.y + a.height <= layout.height);
        }
    }

    #[test]
    fn a_small_circuit() {
        let g = graph(&["tank", "pump", "line"], &[(0, "port", 1, "b"), (1, "a", 2, "port")]);
        insta::assert_snapshot!(write(&g, "Press & more"));
    }

    #[test]
    fn marks_are_coloured() {
        let g = graph(&["tank", "pump"], &[(0, "port", 1, "b")]);
        let mark = |name: &str, heat| HeatMark { name: name.into(), heat, note: format!("at <{name}>") };
        let drawn = write_marked(&g, "", &[mark("tank.port", 1.0), mark("pump.b", 1.0), mark("pump.gap.x", 0.5)]);
        assert_eq!(drawn.matches(&warm(1.0)).count(), 3, "two ports and the connection: {drawn}");
        assert!(drawn.contains(&warm(0.25)) && drawn.contains("<title>at &lt;tank.port&gt;</title>"));
    }

    #[test]
    fn boxes_stand_apart() {
        let names: Vec<String> = (0..50).map(|i| format!("component_{i}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let chain: Vec<_> = (0..49).map(|i| (i, "b", i + 1, "a")).collect();
        let star: Vec<_> = (1..50).map(|i| (0, "port", i, "a")).collect();
        let mesh: Vec<_> = (0..49).flat_map(|i| [(i, "b", i + 1, "a"), (i, "c", (i * 7) % 50, "d")]).collect();
        let parts: Vec<_> = (0..25).map(|i| (2 * i, "b", 2 * i + 1, "a")).collect();
        for wires in [&chain, &star, &mesh, &parts, &vec![]] {
            assert_apart(&DiagramLayout::new(&graph(&names, wires)));
        }
        assert_apart(&DiagramLayout::new(&graph(&[], &[])));
    }
}
