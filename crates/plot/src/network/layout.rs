//! Decides where the boxes of a network are placed.
//!
//! A [`ComponentGraph`] enters, a [`DiagramLayout`] leaves. Components are put into columns by their distance from one
//! end of the network, so a connection joins equal or neighbouring columns. Within a column they are ordered by the
//! mean place of their neighbours, which avoids most crossings. Long networks turn back and continue in the next row.
//!
//! Parts that are not connected are placed one below the other.

use std::collections::VecDeque;

use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;

use super::symbols::symbol;
use bramah_model::network::ComponentGraph;

/// Columns in a row before the network turns.
const COLUMNS: usize = 8;
/// Horizontal space between columns, for the connections.
const GAP_X: f64 = 90.0;
/// Vertical space between boxes of a column.
const GAP_Y: f64 = 22.0;
/// Space around the drawing.
const MARGIN: f64 = 20.0;
/// Height of the lines with name and class in a box.
const HEAD: f64 = 38.0;
/// Height of a port in a box.
const PORT: f64 = 16.0;
/// Side of a symbol in a box.
pub(super) const SYMBOL: f64 = 40.0;

/// The side of a box on which a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BoxSide {
    /// Connections leave to the left.
    Left,
    /// Connections leave to the right.
    Right,
}

/// A place where a connection ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct WireEnd {
    /// Horizontal coordinate.
    pub x: f64,
    /// Vertical coordinate.
    pub y: f64,
    /// The side of the box, in whose direction the connection leaves.
    pub side: BoxSide,
}

/// The box of a component.
#[derive(Clone, Debug, Default)]
pub(super) struct LayoutBox {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width of the box.
    pub width: f64,
    /// Height of the box.
    pub height: f64,
    /// Symbol between the ports; `None` for classes without one.
    pub symbol: Option<&'static str>,
    /// Ports on the left, from top to bottom.
    left: Vec<String>,
    /// Ports on the right, from top to bottom.
    right: Vec<String>,
}

impl LayoutBox {
    /// The upper left corner of the symbol, which is centred below name and class.
    pub fn symbol_place(&self) -> (f64, f64) {
        let room = self.height - HEAD - 4.0;
        (self.x + (self.width - SYMBOL) / 2.0, self.y + HEAD + (room - SYMBOL) / 2.0)
    }
}

/// The boxes of a network, by the index of their node, and the size of the drawing.
#[derive(Clone, Debug, Default)]
pub(super) struct DiagramLayout {
    /// Boxes by node.
    pub boxes: Vec<LayoutBox>,
    /// Width of the drawing.
    pub width: f64,
    /// Height of the drawing.
    pub height: f64,
}

impl DiagramLayout {
    /// Places all boxes of a network.
    ///
    /// Each connected part is laid out alone, from top to bottom.
    pub fn new(graph: &ComponentGraph) -> Self {
        let neighbours = neighbours(graph);
        let mut layout =
            DiagramLayout { boxes: vec![LayoutBox::default(); graph.node_count()], ..DiagramLayout::default() };
        for node in graph.node_indices() {
            let component = &graph[node];
            let classes = std::iter::once(&component.class).chain(&component.bases).map(String::as_str);
            let symbol = symbol(classes);
            layout.boxes[node.index()] =
                LayoutBox { width: box_width(component, symbol.is_some()), symbol, ..LayoutBox::default() };
        }
        let mut top = MARGIN;
        for part in parts(&neighbours) {
            let columns = ordered(columns(&part, &neighbours), &neighbours);
            // Sides of ports depend on the horizontal places, heights on the sides, and vertical places on the heights;
            // hence this order.
            for (r, row) in columns.chunks(COLUMNS).enumerate() {
                layout.place_x(row, r % 2 == 1);
            }
            layout.choose_sides(graph, &part);
            for row in columns.chunks(COLUMNS) {
                top = layout.place_y(row, top, &neighbours);
            }
        }
        layout.width = layout.boxes.iter().map(|b| b.x + b.width).fold(0.0, f64::max) + MARGIN;
        layout.height = top.max(2.0 * MARGIN);
        layout
    }

    /// The place of a port for a connection to the box `other`. A port with connections on both sides is drawn on both.
    ///
    /// The side that faces the other box is preferred. A port that is not drawn gives the corner of the box.
    pub fn end(&self, node: usize, port: &str, other: usize) -> WireEnd {
        let wished = self.side_towards(node, other);
        let places = self.places(node, port);
        let found = places.iter().find(|p| p.side == wished).or(places.first());
        let b = &self.boxes[node];
        found.copied().unwrap_or(WireEnd { x: b.x, y: b.y, side: BoxSide::Left })
    }

    /// All places where a port is drawn: one, or one on each side.
    pub fn places(&self, node: usize, port: &str) -> Vec<WireEnd> {
        let b = &self.boxes[node];
        let y = |i: usize| b.y + HEAD + PORT * (i as f64 + 0.5);
        let left = b.left.iter().position(|p| p == port).map(|i| WireEnd { x: b.x, y: y(i), side: BoxSide::Left });
        let right = b.right.iter().position(|p| p == port);
        let right = right.map(|i| WireEnd { x: b.x + b.width, y: y(i), side: BoxSide::Right });
        left.into_iter().chain(right).collect()
    }

    /// The side of a box that faces another one. Boxes in the same column are connected on their right.
    fn side_towards(&self, node: usize, other: usize) -> BoxSide {
        let middle = |b: &LayoutBox| b.x + b.width / 2.0;
        let away = middle(&self.boxes[other]) - middle(&self.boxes[node]);
        if away < -1.0 { BoxSide::Left } else { BoxSide::Right }
    }

    /// Places the boxes of a row horizontally: from left to right, or from right to left after a turn.
    fn place_x(&mut self, row: &[Vec<usize>], turned: bool) {
        let width = |column: &[usize], boxes: &[LayoutBox]| column.iter().map(|&n| boxes[n].width).fold(0.0, f64::max);
        let widths: Vec<f64> = row.iter().map(|c| width(c, &self.boxes)).collect();
        // A turned row begins at the right edge of a full row, below the end of the row before.
        let full = COLUMNS as f64 * 150.0 + (COLUMNS - 1) as f64 * GAP_X;
        let total = widths.iter().sum::<f64>() + GAP_X * (widths.len() - 1) as f64;
        let mut x = if turned { MARGIN + full.max(total) } else { MARGIN };
        for (column, width) in row.iter().zip(&widths) {
            if turned {
                x -= width;
            }
            for &node in column {
                // Boxes are centred in their column.
                self.boxes[node].x = x + (width - self.boxes[node].width) / 2.0;
            }
            x += if turned { -GAP_X } else { width + GAP_X };
        }
    }

    /// Chooses the sides of all ports by the directions of their connections, then the heights of the boxes.
    ///
    /// Requires the horizontal places of all boxes in the part.
    fn choose_sides(&mut self, graph: &ComponentGraph, part: &[usize]) {
        for &node in part {
            let index = NodeIndex::new(node);
            for port in &graph[index].ports {
                let others = graph.edges(index).filter_map(|edge| other_end(graph, edge.id(), index, port));
                let sides: Vec<BoxSide> = others.map(|other| self.side_towards(node, other.index())).collect();
                let b = &mut self.boxes[node];
                if sides.contains(&BoxSide::Left) {
                    b.left.push(port.clone());
                }
                // A port without any connection is drawn too, so that an open port can be seen.
                if sides.contains(&BoxSide::Right) || sides.is_empty() {
                    b.right.push(port.clone());
                }
            }
            let b = &mut self.boxes[node];
            let ports = PORT * b.left.len().max(b.right.len()).max(1) as f64;
            b.height = HEAD + ports.max(if b.symbol.is_some() { SYMBOL } else { 0.0 }) + 4.0;
        }
    }

    /// Places the boxes of a row vertically: centred at first, then moved towards their neighbours. Returns where the
    /// next row begins.
    ///
    /// `top` is the upper edge of the row. The tallest column decides the height of the row.
    fn place_y(&mut self, row: &[Vec<usize>], top: f64, neighbours: &[Vec<usize>]) -> f64 {
        let height = |layout: &DiagramLayout, column: &[usize]| -> f64 {
            column.iter().map(|&n| layout.boxes[n].height + GAP_Y).sum::<f64>() - GAP_Y
        };
        let tallest = row.iter().map(|c| height(self, c)).fold(0.0, f64::max);
        for column in row {
            let mut y = top + (tallest - height(self, column)) / 2.0;
            for &node in column {
                self.boxes[node].y = y;
                y += self.boxes[node].height + GAP_Y;
            }
        }
        let members: Vec<usize> = row.iter().flatten().copied().collect();
        // Each move changes the means of the neighbours, hence several rounds.
        for _ in 0..3 {
            for column in row {
                self.settle(column, (top, top + tallest), &members, neighbours);
            }
        }
        top + tallest + 2.0 * GAP_Y
    }

    /// Moves each box of a column towards the mean of its neighbours in the row. The order and the gaps stay.
    ///
    /// No box leaves the range from `top` to `bottom`, as each one keeps room for those below it.
    fn settle(&mut self, column: &[usize], (top, bottom): (f64, f64), members: &[usize], neighbours: &[Vec<usize>]) {
        let middle = |b: &LayoutBox| b.y + b.height / 2.0;
        let mut y = top;
        let mut room: f64 = column.iter().map(|&n| self.boxes[n].height + GAP_Y).sum();
        for &node in column {
            let near: Vec<f64> =
                neighbours[node].iter().filter(|n| members.contains(n)).map(|&n| middle(&self.boxes[n])).collect();
            let b = &self.boxes[node];
            let wish =
                if near.is_empty() { b.y } else { near.iter().sum::<f64>() / near.len() as f64 - b.height / 2.0 };
            // This box and those below it need that much room.
            let latest = bottom + GAP_Y - room;
            let place = wish.clamp(y, latest.max(y));
            room -= b.height + GAP_Y;
            y = place + b.height + GAP_Y;
            self.boxes[node].y = place;
        }
    }
}

/// The node at the other end of a connection that leaves `node` at `port`. `None`: it does not.
fn other_end(graph: &ComponentGraph, edge: EdgeIndex, node: NodeIndex, port: &str) -> Option<NodeIndex> {
    let (a, b) = graph.edge_endpoints(edge)?;
    let wire = &graph[edge];
    if a == node && wire.from == port {
        Some(b)
    } else if b == node && wire.to == port {
        Some(a)
    } else {
        None
    }
}

/// The width of a box: enough for name, class, the names of two ports side by side and the symbol.
fn box_width(component: &bramah_model::network::ComponentBox, symbol: bool) -> f64 {
    let chars = |s: &str| s.chars().count() as f64;
    let class = component.class.rsplit('.').next().unwrap_or("");
    let port = component.ports.iter().map(|p| chars(p)).fold(0.0, f64::max);
    let between = if symbol { SYMBOL + 8.0 } else { 12.0 };
    (7.2 * chars(&component.name)).max(6.0 * chars(class)).max(2.0 * 5.6 * port + between).max(70.0) + 18.0
}

/// The neighbours of each node, without itself, in ascending order.
fn neighbours(graph: &ComponentGraph) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new(); graph.node_count()];
    for edge in graph.edge_references() {
        let (a, b) = (edge.source().index(), edge.target().index());
        if a != b {
            all[a].push(b);
            all[b].push(a);
        }
    }
    for list in &mut all {
        list.sort_unstable();
        list.dedup();
    }
    all
}

/// The connected parts of the network, each as a list of its nodes.
fn parts(neighbours: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; neighbours.len()];
    let mut parts = Vec::new();
    for start in 0..neighbours.len() {
        if !seen[start] {
            let mut part: Vec<usize> = distances(start, neighbours).into_iter().map(|(n, _)| n).collect();
            part.iter().for_each(|&n| seen[n] = true);
            part.sort_unstable();
            parts.push(part);
        }
    }
    parts
}

/// All nodes that can be reached, with their distance from `start`, nearest first (breadth-first search).
fn distances(start: usize, neighbours: &[Vec<usize>]) -> Vec<(usize, usize)> {
    let mut seen = vec![false; neighbours.len()];
    seen[start] = true;
    let mut queue = VecDeque::from([(start, 0)]);
    let mut out = Vec::new();
    while let Some((node, distance)) = queue.pop_front() {
        out.push((node, distance));
        for &next in &neighbours[node] {
            if !std::mem::replace(&mut seen[next], true) {
                queue.push_back((next, distance + 1));
            }
        }
    }
    out
}

/// The columns of a part: nodes of equal distance from one of its ends. Of the two ends, the component declared first
/// is taken.
///
/// Two searches from node to farthest node find the ends, as for the diameter of a tree.
fn columns(part: &[usize], neighbours: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let farthest = |from: usize| {
        let all = distances(from, neighbours);
        let most = all.iter().map(|d| d.1).max().unwrap_or(0);
        all.iter().filter(|d| d.1 == most).map(|d| d.0).min().unwrap_or(from)
    };
    // The node farthest from any node is an end of the network; the one farthest from it is the other end.
    let end = farthest(part[0]);
    let start = end.min(farthest(end));
    let mut columns: Vec<Vec<usize>> = Vec::new();
    for (node, distance) in distances(start, neighbours) {
        if columns.len() <= distance {
            columns.push(Vec::new());
        }
        columns[distance].push(node);
    }
    columns
}

/// Orders the nodes of each column by the mean rank of their neighbours, in eight sweeps to and fro.
///
/// This is the barycentre method for layered graphs.
fn ordered(mut columns: Vec<Vec<usize>>, neighbours: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut rank = vec![0.0; neighbours.len()];
    let number = |column: &[usize], rank: &mut Vec<f64>| {
        for (i, &node) in column.iter().enumerate() {
            // Ranks go from 0 to 1 in each column, so that columns of different length compare.
            rank[node] = (i as f64 + 0.5) / column.len() as f64;
        }
    };
    columns.iter().for_each(|c| number(c, &mut rank));
    for round in 0..8 {
        let order: Vec<usize> =
            if round % 2 == 0 { (0..columns.len()).collect() } else { (0..columns.len()).rev().collect() };
        for i in order {
            let wish = |node: usize| {
                let near = &neighbours[node];
                let sum: f64 = near.iter().map(|&n| rank[n]).sum();
                if near.is_empty() { rank[node] } else { sum / near.len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = columns[i].iter().map(|&n| (wish(n), n)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            columns[i] = keyed.into_iter().map(|(_, n)| n).collect();
            number(&columns[i], &mut rank);
        }
    }
    columns
}
