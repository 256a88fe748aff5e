//! Draws a Sankey diagram: flows between nodes, with widths in proportion to their size.
//!
//! A list of [`SankeyFlow`] enters, an SVG text leaves; `bramah steady --sankey` draws powers with it. Nodes are placed
//! in columns from left to right. Flows that would close a circle are drawn back below the others.

use super::figure::colour;
use super::svg::{begin, escape};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A flow from one node to another.
#[derive(Clone, Debug, PartialEq)]
pub struct SankeyFlow {
    /// Name of the node that it leaves.
    pub from: String,
    /// Name of the node that it enters.
    pub to: String,
    /// Its size, greater than zero.
    pub size: f64,
}

/// Width of the picture.
const WIDTH: f64 = 1000.0;
/// Width of the bar of a node.
const BAR: f64 = 14.0;
/// Vertical space between bars, for their names.
const GAP: f64 = 40.0;
/// Total height of the bars in the fullest column.
const HEIGHT: f64 = 420.0;
/// Space above the bars, for the title.
const TOP: f64 = 50.0;
/// Space at the sides and at the bottom.
const EDGE: f64 = 20.0;
/// Space to the right of the last bar, for its name.
const NAME: f64 = 150.0;
/// Inner radius of the bend of a flow that goes back.
const BEND: f64 = 6.0;

/// A node with its place.
struct SankeyNode<'a> {
    /// Name of the node.
    name: &'a str,
    /// Column, counted from the left.
    column: usize,
    /// The larger of the sums of what enters and what leaves.
    size: f64,
    /// Upper edge of the bar.
    top: f64,
    /// Height of the bar that is used by leaving flows so far.
    given: f64,
    /// Height of the bar that is used by entering flows so far.
    taken: f64,
}

/// Draws the flows as SVG. `words` writes a size with its unit.
///
/// Bars show the nodes with name and size. A flow has the colour of the node that it leaves, and its size appears under
/// the pointer.
pub fn svg(title: &str, flows: &[SankeyFlow], words: impl Fn(f64) -> String) -> String {
    let back = returning(flows);
    let mut blocks = blocks(flows, &back);
    let scale = place(&mut blocks, flows, &back);
    // A thin flow stays visible.
    let width = |flow: &SankeyFlow| (flow.size * scale).max(0.5);
    // Flows that go back need room at both sides for their bends.
    let widest = flows.iter().zip(&back).filter(|(_, b)| **b).map(|(f, _)| width(f) + BEND).fold(0.0, f64::max);
    let columns = blocks.iter().map(|b| b.column).max().unwrap_or(0);
    let from = EDGE + widest;
    let room = WIDTH - from - widest.max(NAME) - BAR;
    let left = |column: usize| from + room * column as f64 / columns.max(1) as f64;
    let mut lowest = blocks.iter().map(|b| b.top + b.size * scale).fold(TOP, f64::max) + EDGE;
    let find = |blocks: &[SankeyNode<'_>], name: &str| {
        blocks.iter().position(|b| b.name == name).expect("every end has a block")
    };
    let mut streams = String::new();
    for (k, y0, y1) in ends(flows, &back, &mut blocks, scale) {
        let flow = &flows[k];
        let (w, half) = (width(flow), width(flow) / 2.0);
        let (giver, taker) = (find(&blocks, &flow.from), find(&blocks, &flow.to));
        let (x0, x1) = (left(blocks[giver].column) + BAR, left(blocks[taker].column));
        let paint = colour(giver);
        let shape = if back[k] {
            let r = half + BEND;
            // Each one runs below the one before.
            let bottom = lowest + half;
            lowest = bottom + half + BEND;
            format!(
                "fill=\"none\" stroke=\"{paint}\" stroke-opacity=\"0.35\" stroke-width=\"{w:.2}\" \
                 d=\"M{x0:.1},{y0:.1}a{r:.1} {r:.1} 0 0 1 {r:.1} {r:.1}V{:.1}a{r:.1} {r:.1} 0 0 1 -{r:.1} {r:.1}H{x1:.1}\
                 a{r:.1} {r:.1} 0 0 1 -{r:.1} -{r:.1}V{:.1}a{r:.1} {r:.1} 0 0 1 {r:.1} -{r:.1}\"",
                (bottom - r).max(y0 + r),
                y1 + r
            )
        } else {
            // Drawn as an area, because a thick line along a steep curve would overlap itself.
            let middle = (x0 + x1) / 2.0;
            let (a, b, c, d) = (y0 - half, y1 - half, y1 + half, y0 + half);
            format!(
                "fill=\"{paint}\" fill-opacity=\"0.35\" d=\"M{x0:.1},{a:.1}C{middle:.1},{a:.1} {middle:.1},{b:.1} \
                 {x1:.1},{b:.1}V{c:.1}C{middle:.1},{c:.1} {middle:.1},{d:.1} {x0:.1},{d:.1}Z\""
            )
        };
        let label = format!("{} to {}: {}", flow.from, flow.to, words(flow.size));
        let _ = writeln!(streams, "<path {shape}><title>{}</title></path>", escape(&label));
    }
    let mut out = begin(WIDTH, format!("{:.0}", lowest + EDGE), 12, title);
    let _ = writeln!(out, "<text x=\"{EDGE}\" y=\"26\" font-size=\"16\">{}</text>", escape(title));
    out += &streams;
    for (k, block) in blocks.iter().enumerate() {
        let (x, y, height) = (left(block.column), block.top, (block.size * scale).max(1.0));
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{BAR}\" height=\"{height:.1}\" fill=\"{}\"/>\n\
             <text x=\"{tx:.1}\" y=\"{ty:.1}\">{}<tspan x=\"{tx:.1}\" dy=\"14\">{}</tspan></text>",
            colour(k),
            escape(block.name),
            escape(&words(block.size)),
            tx = x + BAR + 4.0,
            ty = y + height / 2.0 - 2.0,
        );
    }
    out + "</svg>\n"
}

/// Which flows go back because they would close a circle.
///
/// Flows are added in the order of their size, the largest first. A flow goes back when its end already leads to its
/// beginning, so that large flows go forward.
fn returning(flows: &[SankeyFlow]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..flows.len()).collect();
    // Equal sizes are ordered by their index, so that the picture is always the same.
    order.sort_by(|&a, &b| flows[b].size.total_cmp(&flows[a].size).then(a.cmp(&b)));
    let mut forward: Vec<&SankeyFlow> = Vec::new();
    let mut back = vec![false; flows.len()];
    for k in order {
        let mut reached = BTreeSet::from([flows[k].to.as_str()]);
        let mut ready = vec![flows[k].to.as_str()];
        while let Some(at) = ready.pop() {
            ready.extend(forward.iter().filter(|f| f.from == at).map(|f| f.to.as_str()).filter(|n| reached.insert(n)));
        }
        back[k] = reached.contains(flows[k].from.as_str());
        if !back[k] {
            forward.push(&flows[k]);
        }
    }
    back
}

/// The nodes with their columns: each one column behind the last node that feeds it.
///
/// The size of a node is the larger of what enters and what leaves it. Nodes are sorted by column, then by size.
fn blocks<'a>(flows: &'a [SankeyFlow], back: &[bool]) -> Vec<SankeyNode<'a>> {
    let mut sums: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for flow in flows {
        sums.entry(&flow.from).or_default().0 += flow.size;
        sums.entry(&flow.to).or_default().1 += flow.size;
    }
    let mut columns: BTreeMap<&str, usize> = sums.keys().map(|n| (*n, 0)).collect();
    // The longest path has at most as many steps as there are nodes, and one round for each is enough.
    for _ in 0..sums.len() {
        for (flow, _) in flows.iter().zip(back).filter(|(_, back)| !**back) {
            let least = columns[flow.from.as_str()] + 1;
            let to = columns.get_mut(flow.to.as_str()).expect("every end has a column");
            *to = (*to).max(least);
        }
    }
    let block = |(name, (given, taken)): (&'a str, (f64, f64))| {
        let (column, size) = (columns[name], given.max(taken));
        SankeyNode { name, column, size, top: 0.0, given: 0.0, taken: 0.0 }
    };
    let mut all: Vec<SankeyNode<'a>> = sums.into_iter().map(block).collect();
    all.sort_by(|a, b| a.column.cmp(&b.column).then(b.size.total_cmp(&a.size)).then(a.name.cmp(b.name)));
    all
}

/// Stacks the nodes of each column, ordered by the heights of the nodes that feed them. Returns the height of a unit of
/// size.
///
/// Columns are placed from left to right, because the order of a column depends on the places of those before.
fn place(blocks: &mut [SankeyNode<'_>], flows: &[SankeyFlow], back: &[bool]) -> f64 {
    let columns = blocks.iter().map(|b| b.column + 1).max().unwrap_or(0);
    let total = |column: usize| blocks.iter().filter(|b| b.column == column).map(|b| b.size).sum::<f64>();
    let largest = (0..columns).map(total).fold(0.0, f64::max);
    // Without any flow the scale does not matter.
    let scale = if largest > 0.0 { HEIGHT / largest } else { 1.0 };
    for column in 0..columns {
        let height = |block: &SankeyNode<'_>| {
            let feeds = flows.iter().zip(back).filter(|(f, back)| !**back && f.to == block.name).map(|(f, _)| f);
            let middle =
                |name: &str| blocks.iter().find(|b| b.name == name).map_or(0.0, |b| b.top + b.size * scale / 2.0);
            let (sum, weight) = feeds.fold((0.0, 0.0), |(s, w), f| (s + f.size * middle(&f.from), w + f.size));
            if weight > 0.0 { sum / weight } else { 0.0 }
        };
        let mut order: Vec<(usize, f64)> =
            (0..blocks.len()).filter(|&k| blocks[k].column == column).map(|k| (k, height(&blocks[k]))).collect();
        order.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let mut top = TOP;
        for (k, _) in order {
            blocks[k].top = top;
            top += blocks[k].size * scale + GAP;
        }
    }
    scale
}

/// The flows with the heights of their two ends.
///
/// At each bar the flows are ordered by the height of their other ends, so that they do not cross there. Flows that go
/// back are lowest.
fn ends(flows: &[SankeyFlow], back: &[bool], blocks: &mut [SankeyNode<'_>], scale: f64) -> Vec<(usize, f64, f64)> {
    let mut all: Vec<(usize, f64, f64)> = (0..flows.len()).map(|k| (k, 0.0, 0.0)).collect();
    let find = |blocks: &[SankeyNode<'_>], name: &str| {
        blocks.iter().position(|b| b.name == name).expect("every end has a block")
    };
    // First the ends where flows leave their nodes, then those where they enter.
    for giving in [true, false] {
        let far = |k: usize| if giving { &flows[k].to } else { &flows[k].from };
        let key = |k: usize| (back[k], blocks[find(blocks, far(k))].top);
        let mut order: Vec<usize> = (0..flows.len()).collect();
        order.sort_by(|&a, &b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)).then(a.cmp(&b)));
        for k in order {
            let name = if giving { &flows[k].from } else { &flows[k].to };
            let at = find(blocks, name);
            let block = &mut blocks[at];
            let used = if giving { &mut block.given } else { &mut block.taken };
            let height = (flows[k].size * scale).max(0.5);
            let middle = block.top + *used + height / 2.0;
            *used += height;
            if giving { all[k].1 = middle } else { all[k].2 = middle }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(from: &str, to: &str, size: f64) -> SankeyFlow {
        SankeyFlow { from: from.into(), to: to.into(), size }
    }

    #[test]
    fn streams_are_drawn_from_left_to_right_and_circles_go_back_below() {
        let flows = [flow("tank", "pump", 1.0), flow("pump", "valve", 3.0), flow("valve", "tank", 2.0)];
        assert_eq!(returning(&flows), [true, false, false]);
        let picture = svg("a < b", &flows, |s| format!("{s} W"));
        assert_eq!((picture.matches("<path").count(), picture.matches("<rect").count()), (3, 4));
        assert_eq!(picture.matches("fill=\"none\"").count(), 1);
        assert!(picture.contains("a &lt; b") && picture.contains("pump to valve: 3 W"));
        assert!(svg("", &[], |s| s.to_string()).ends_with("</svg>\n"));
    }

    #[test]
    fn what_feeds_itself_goes_back() {
        assert_eq!(returning(&[flow("a", "a", 1.0)]), [true]);
    }
}
