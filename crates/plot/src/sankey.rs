//! Streams between things drawn with widths in proportion.

use super::figure::colour;
use super::svg::{begin, escape};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A stream from one thing to another.
#[derive(Clone, Debug, PartialEq)]
pub struct SankeyFlow {
    /// Where it comes from.
    pub from: String,
    /// Where it goes.
    pub to: String,
    /// Its size, positive.
    pub size: f64,
}

const WIDTH: f64 = 1000.0;
const BAR: f64 = 14.0;
const GAP: f64 = 40.0;
const HEIGHT: f64 = 420.0;
const TOP: f64 = 50.0;
const EDGE: f64 = 20.0;
/// Room right of the last bar for its name.
const NAME: f64 = 150.0;
/// The bend of a stream that goes back, beyond half of its width.
const BEND: f64 = 6.0;

struct SankeyNode<'a> {
    name: &'a str,
    column: usize,
    size: f64,
    top: f64,
    given: f64,
    taken: f64,
}

/// The streams as SVG, from left to right; those that close a circle go back below. `words` says a size with its unit.
pub fn svg(title: &str, flows: &[SankeyFlow], words: impl Fn(f64) -> String) -> String {
    let back = returning(flows);
    let mut blocks = blocks(flows, &back);
    let scale = place(&mut blocks, flows, &back);
    let width = |flow: &SankeyFlow| (flow.size * scale).max(0.5);
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
            // an area, for a thick line along a steep curve overlaps itself
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

/// Which streams close a circle: the large ones go forward first, and one goes back where its end already leads to its
/// beginning.
fn returning(flows: &[SankeyFlow]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..flows.len()).collect();
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

/// Each thing with the column it stands in: one behind everything that feeds it.
fn blocks<'a>(flows: &'a [SankeyFlow], back: &[bool]) -> Vec<SankeyNode<'a>> {
    let mut sums: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for flow in flows {
        sums.entry(&flow.from).or_default().0 += flow.size;
        sums.entry(&flow.to).or_default().1 += flow.size;
    }
    let mut columns: BTreeMap<&str, usize> = sums.keys().map(|n| (*n, 0)).collect();
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

/// Stacks the things of each column, each near what feeds it; returns the height of one unit of size.
fn place(blocks: &mut [SankeyNode<'_>], flows: &[SankeyFlow], back: &[bool]) -> f64 {
    let columns = blocks.iter().map(|b| b.column + 1).max().unwrap_or(0);
    let total = |column: usize| blocks.iter().filter(|b| b.column == column).map(|b| b.size).sum::<f64>();
    let largest = (0..columns).map(total).fold(0.0, f64::max);
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

/// The streams with the heights of their ends: those at one bar in the order of their other ends, so that they do not
/// cross there, and those that go back lowest.
fn ends(flows: &[SankeyFlow], back: &[bool], blocks: &mut [SankeyNode<'_>], scale: f64) -> Vec<(usize, f64, f64)> {
    let mut all: Vec<(usize, f64, f64)> = (0..flows.len()).map(|k| (k, 0.0, 0.0)).collect();
    let find = |blocks: &[SankeyNode<'_>], name: &str| {
        blocks.iter().position(|b| b.name == name).expect("every end has a block")
    };
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
