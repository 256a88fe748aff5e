//! Streams between things drawn with widths in proportion.

use super::figure::colour;
use super::svg::escape;
use std::collections::BTreeMap;
use std::fmt::Write;

/// A stream from one thing to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Where it comes from.
    pub from: String,
    /// Where it goes.
    pub to: String,
    /// Its size, positive.
    pub size: f64,
    /// What is written on it.
    pub label: String,
}

const WIDTH: f64 = 1000.0;
const BAR: f64 = 14.0;
const GAP: f64 = 24.0;
const HEIGHT: f64 = 420.0;
const TOP: f64 = 50.0;

struct Block {
    column: usize,
    size: f64,
    top: f64,
    given: f64,
    taken: f64,
}

/// The streams as SVG, from left to right.
pub fn svg(title: &str, flows: &[Flow]) -> String {
    let mut blocks = blocks(flows);
    let scale = place(&mut blocks);
    let columns = blocks.values().map(|b| b.column).max().unwrap_or(0);
    let lowest = blocks.values().map(|b| b.top + b.size * scale).fold(TOP, f64::max) + 40.0;
    let left = |column: usize| 20.0 + (WIDTH - 190.0) * column as f64 / columns.max(1) as f64;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{lowest:.0}\" \
         viewBox=\"0 0 {WIDTH} {lowest:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"20\" y=\"26\" font-size=\"16\">{}</text>\n",
        escape(title)
    );
    let names: Vec<String> = blocks.keys().cloned().collect();
    for flow in flows {
        let width = (flow.size * scale).max(0.5);
        let Some(from) = blocks.get_mut(&flow.from) else { continue };
        let (x0, y0) = (left(from.column) + BAR, from.top + from.given + width / 2.0);
        from.given += width;
        let Some(to) = blocks.get_mut(&flow.to) else { continue };
        let (x1, y1) = (left(to.column), to.top + to.taken + width / 2.0);
        to.taken += width;
        let middle = (x0 + x1) / 2.0;
        let paint = colour(names.iter().position(|n| *n == flow.from).unwrap_or(0));
        let _ = writeln!(
            out,
            "<path d=\"M{x0:.1},{y0:.1} C{middle:.1},{y0:.1} {middle:.1},{y1:.1} {x1:.1},{y1:.1}\" fill=\"none\" \
             stroke=\"{paint}\" stroke-opacity=\"0.35\" stroke-width=\"{width:.2}\"><title>{} to {}: {}</title></path>",
            escape(&flow.from),
            escape(&flow.to),
            escape(&flow.label)
        );
    }
    for (k, (name, block)) in blocks.iter().enumerate() {
        let (x, y, height) = (left(block.column), block.top, (block.size * scale).max(1.0));
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{BAR}\" height=\"{height:.1}\" fill=\"{}\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            colour(k),
            x + BAR + 4.0,
            y + height / 2.0 + 4.0,
            escape(name)
        );
    }
    out + "</svg>\n"
}

/// Each thing with the column it stands in: one behind everything that feeds it, as far as there are no circles.
fn blocks(flows: &[Flow]) -> BTreeMap<String, Block> {
    let mut blocks: BTreeMap<String, Block> = BTreeMap::new();
    let mut sums: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for flow in flows {
        sums.entry(&flow.from).or_default().0 += flow.size;
        sums.entry(&flow.to).or_default().1 += flow.size;
    }
    for (name, (given, taken)) in sums {
        let size = given.max(taken);
        blocks.insert(name.to_owned(), Block { column: 0, size, top: 0.0, given: 0.0, taken: 0.0 });
    }
    for _ in 0..blocks.len().min(12) {
        for flow in flows {
            let before = blocks.get(&flow.from).map_or(0, |b| b.column);
            if let Some(to) = blocks.get_mut(&flow.to) {
                to.column = to.column.max((before + 1).min(12));
            }
        }
    }
    let mut used: Vec<usize> = blocks.values().map(|b| b.column).collect();
    used.sort_unstable();
    used.dedup();
    blocks.values_mut().for_each(|b| b.column = used.iter().position(|c| *c == b.column).unwrap_or(0));
    blocks
}

/// Stacks the things of each column; returns the height of one unit of size.
fn place(blocks: &mut BTreeMap<String, Block>) -> f64 {
    let mut totals: BTreeMap<usize, f64> = BTreeMap::new();
    blocks.values().for_each(|b| *totals.entry(b.column).or_default() += b.size);
    let largest = totals.values().copied().fold(0.0, f64::max);
    let scale = if largest > 0.0 { HEIGHT / largest } else { 1.0 };
    let mut next: BTreeMap<usize, f64> = BTreeMap::new();
    for block in blocks.values_mut() {
        let top = next.entry(block.column).or_insert(TOP);
        block.top = *top;
        *top += block.size * scale + GAP;
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_drawn_from_left_to_right_and_circles_end() {
        let flow = |from: &str, to: &str, size: f64| Flow {
            from: from.into(),
            to: to.into(),
            size,
            label: format!("{size} W"),
        };
        let picture =
            svg("a < b", &[flow("pump", "valve", 3.0), flow("valve", "tank", 2.0), flow("tank", "pump", 1.0)]);
        assert_eq!((picture.matches("<path").count(), picture.matches("<rect").count()), (3, 4));
        assert!(picture.contains("a &lt; b") && picture.contains("pump to valve: 3 W"));
        assert!(svg("", &[]).ends_with("</svg>\n"));
    }
}
