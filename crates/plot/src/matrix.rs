//! Draws a scatter matrix: every column of a table over every other one, with histograms on the diagonal.
//!
//! A [`ScatterMatrix`] enters, an SVG text leaves; `bramah sweep --plot` draws the runs of a sweep with it. Only the
//! lower half is drawn, since the upper one shows the same pairs.

use super::figure::colour;
use super::svg::{begin, escape};
use super::ticks::{AxisTicks, ticks};
use bramah_results::number;
use std::fmt::Write as _;

/// The table to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterMatrix {
    /// Text above the picture; may be empty.
    pub title: String,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Values by column, all columns of equal length. A cell leaves out rows with NaN.
    pub columns: Vec<Vec<f64>>,
    /// The column that colours the dots from blue (lowest) to red (highest). `None`: all are blue.
    pub shade: Option<usize>,
}

/// Width of the picture.
const WIDTH: f64 = 900.0;
/// Space at the left and the bottom, for numbers.
const MARGIN: f64 = 64.0;
/// Space between cells.
const GAP: f64 = 8.0;
/// Bars of a histogram.
const BARS: usize = 16;
/// Dots in a cell at most. Of more rows only every second, third and so on is drawn.
const DOTS: usize = 2000;

/// A cell with its place and the ranges of its axes.
struct ScatterCell {
    /// Left edge.
    left: f64,
    /// Upper edge.
    top: f64,
    /// Side of the square.
    side: f64,
    /// Lowest and highest value of the horizontal axis.
    x: (f64, f64),
    /// Lowest and highest value of the vertical axis.
    y: (f64, f64),
}

impl ScatterCell {
    /// The horizontal place of a value.
    fn px(&self, x: f64) -> f64 {
        self.left + (x - self.x.0) / (self.x.1 - self.x.0) * self.side
    }

    /// The vertical place of a value. SVG counts downwards.
    fn py(&self, y: f64) -> f64 {
        self.top + self.side - (y - self.y.0) / (self.y.1 - self.y.0) * self.side
    }
}

/// Draws the lower half of the matrix, 900 wide and about as high.
pub fn write(matrix: &ScatterMatrix) -> String {
    let n = matrix.names.len().max(1);
    let top = if matrix.title.is_empty() { 12.0 } else { 44.0 };
    let side = (WIDTH - MARGIN - 12.0 - GAP * (n - 1) as f64) / n as f64;
    let height = top + (side + GAP) * n as f64 + MARGIN * 0.7;
    let ranges: Vec<(f64, f64)> = matrix.columns.iter().map(|c| range(c)).collect();
    let title = if matrix.title.is_empty() { "Scatter matrix" } else { &matrix.title };
    let mut out = begin(WIDTH, height.round(), 12, title);
    if !matrix.title.is_empty() {
        let x = WIDTH / 2.0;
        let _ =
            writeln!(out, "<text x=\"{x}\" y=\"27\" font-size=\"16\" text-anchor=\"middle\">{}</text>", escape(title));
    }
    for row in 0..matrix.names.len() {
        for column in 0..=row {
            let place = |k: usize| (side + GAP) * k as f64;
            let cell = ScatterCell {
                left: MARGIN + place(column),
                top: top + place(row),
                side,
                x: ranges[column],
                y: ranges[row],
            };
            if row == column {
                spread(&mut out, matrix, row, &cell)
            } else {
                dots(&mut out, matrix, row, column, &cell)
            }
            frame(&mut out, &cell, (column == 0 && row > 0, row + 1 == n));
        }
    }
    out.push_str("</svg>\n");
    out
}

/// The lowest and the highest finite value. Without any, the first is larger than the second.
fn extremes(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().copied().filter(|v| v.abs() < 1e300);
    (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
}

/// The range of the finite values with a margin. It is never empty.
fn range(values: &[f64]) -> (f64, f64) {
    let (low, high) = extremes(values);
    if low > high {
        return (0.0, 1.0);
    }
    let margin =
        if high - low > 1e-9 * high.abs().max(low.abs()) { 0.06 * (high - low) } else { 0.1 * high.abs().max(1.0) };
    (low - margin, high + margin)
}

/// Draws the histogram of a column and its name.
///
/// The range of the cell is divided into bars of equal width.
fn spread(out: &mut String, matrix: &ScatterMatrix, column: usize, cell: &ScatterCell) {
    let mut counts = [0u32; BARS];
    let wide = cell.x.1 - cell.x.0;
    for v in matrix.columns[column].iter().filter(|v| v.is_finite()) {
        let bar = ((v - cell.x.0) / wide * BARS as f64) as usize;
        // The largest value may fall behind the last bar by rounding.
        counts[bar.min(BARS - 1)] += 1;
    }
    let most = f64::from(counts.iter().copied().max().unwrap_or(0).max(1));
    let step = cell.side / BARS as f64;
    for (k, count) in counts.iter().enumerate().filter(|(_, c)| **c > 0) {
        // The space above the highest bar is for the name.
        let high = 0.78 * cell.side * f64::from(*count) / most;
        let (x, y) = (cell.left + k as f64 * step, cell.top + cell.side - high);
        let fill = colour(5);
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{high:.1}\" fill=\"{fill}\" fill-opacity=\"0.5\"/>",
            step - 1.0
        );
    }
    let (x, y) = (cell.left + cell.side / 2.0, cell.top + 16.0);
    let name = escape(&matrix.names[column]);
    let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-weight=\"bold\">{name}</text>");
}

/// Draws the dots of one column over another.
///
/// Rows with a value that is not finite are left out.
fn dots(out: &mut String, matrix: &ScatterMatrix, row: usize, column: usize, cell: &ScatterCell) {
    let (xs, ys) = (&matrix.columns[column], &matrix.columns[row]);
    let shades = matrix.shade.map(|k| &matrix.columns[k]);
    let (low, high) = shades.map_or((0.0, 1.0), |s| extremes(s));
    // Every n-th row, so that the dots are spread over the entire table.
    let stride = xs.len().div_ceil(DOTS).max(1);
    for k in (0..xs.len()).step_by(stride).filter(|&k| xs[k].is_finite() && ys[k].is_finite()) {
        let part = shades.map_or(0.0, |s| if high > low { ((s[k] - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 });
        let (x, y, fill) = (cell.px(xs[k]), cell.py(ys[k]), between(part));
        let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" fill=\"{fill}\" fill-opacity=\"0.7\"/>");
    }
}

/// A colour from blue over grey to red for a share from 0 to 1; grey for NaN.
fn between(part: f64) -> String {
    const ENDS: [[f64; 3]; 3] = [[0.0, 114.0, 178.0], [170.0, 170.0, 170.0], [213.0, 94.0, 0.0]];
    let part = if part.is_nan() { 0.5 } else { part };
    let (from, to, share) =
        if part < 0.5 { (ENDS[0], ENDS[1], 2.0 * part) } else { (ENDS[1], ENDS[2], 2.0 * part - 1.0) };
    let mix = |i: usize| (from[i] + share * (to[i] - from[i])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// As many ticks as there is room for, but at least two where possible: one number does not show the scale.
fn readable(range: (f64, f64), side: f64) -> AxisTicks {
    let least = ((side / 55.0) as usize).max(2);
    let found = |count: usize| ticks(range.0, range.1, count);
    (least..least + 4).map(found).find(|t| t.marks.len() > 1).unwrap_or_else(|| found(least))
}

/// Width of a digit at the font size of the numbers.
const DIGIT: f64 = 7.0;

/// The middle of a text of length 2 `half`, moved so that it stays inside its cell.
fn inside(middle: f64, half: f64, (begin, side): (f64, f64)) -> f64 {
    let half = half.min(side / 2.0);
    middle.clamp(begin + half, begin + side - half)
}

/// Draws the edge of a cell, and the numbers at the left and the bottom of the matrix.
///
/// `left` and `bottom` say at which edges the cell has numbers. The power of ten of an axis is written separately.
fn frame(out: &mut String, cell: &ScatterCell, (left, bottom): (bool, bool)) {
    let (l, t, s) = (cell.left, cell.top, cell.side);
    let _ = writeln!(
        out,
        "<rect x=\"{l:.1}\" y=\"{t:.1}\" width=\"{s:.1}\" height=\"{s:.1}\" fill=\"none\" stroke=\"#777777\"/>"
    );
    if left {
        for (place, text) in readable(cell.y, s).marks {
            let y = inside(cell.py(place), 6.0, (t, s)) + 4.0;
            let _ =
                writeln!(out, "<text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>", l - 6.0, escape(&text));
        }
    }
    if bottom {
        for (place, text) in readable(cell.x, s).marks {
            let (x, y) = (inside(cell.px(place), DIGIT * text.len() as f64 / 2.0, (l, s)), t + s + 16.0);
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>", escape(&text));
        }
    }
    // The power of ten of the left axis is inside the cell, because there is a number beside it.
    for (show, range, x, y, anchor) in
        [(left, cell.y, l + 4.0, t + 13.0, "start"), (bottom, cell.x, l + s, t + s + 32.0, "end")]
    {
        let power = readable(range, s).power;
        if show && power != 0 {
            let text = format!("1e{}", number::rounded(f64::from(power), 3));
            let _ = writeln!(
                out,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"#777777\">{text}</text>"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_below_the_diagonal_and_failed_runs_left_out() {
        let matrix = ScatterMatrix {
            title: "4 runs".into(),
            names: vec!["pump.D".into(), "p<set>".into(), "peak".into()],
            columns: vec![vec![1.0, 2.0, 3.0, 4.0], vec![5e6, 6e6, 7e6, 8e6], vec![0.1, 0.4, f64::NAN, 0.2]],
            shade: Some(2),
        };
        let text = write(&matrix);
        // one pair of parameters with four dots, two pairs with the result that failed once
        assert_eq!(text.matches("<circle").count(), 4 + 3 + 3);
        assert!(text.contains("p&lt;set&gt;") && text.contains("1e6") && !text.contains("NaN"), "{text}");
        assert!(text.contains("#d55e00") && text.contains("#0072b2"), "the largest is red, the least blue");
    }

    /// Numbers at the left and at the bottom of cells, many of them small: each axis has two at least.
    #[test]
    fn each_axis_has_two_numbers_at_least() {
        for side in [80.0, 96.0, 150.0, 400.0] {
            for (low, high) in
                [(0.0, 1.0), (0.05, 1.95), (1.0, 4.0), (5e6, 8e6), (-3e-7, 9e-7), (0.91, 1.09), (98.0, 103.0)]
            {
                let ticks = readable(range(&[low, high]), side);
                assert!((2..=8).contains(&ticks.marks.len()), "{low} {high} {side}: {ticks:?}");
                let length: usize = ticks.marks.iter().map(|m| m.1.len()).sum();
                assert!(side > 140.0 || length <= 14, "{low} {high} {side}: {ticks:?}");
            }
        }
        assert_eq!([5.0, 50.0, 99.0].map(|x| inside(x, 12.0, (0.0, 100.0))), [12.0, 50.0, 88.0]);
    }

    #[test]
    fn empty_and_constant_columns_are_drawn() {
        for column in [vec![], vec![2.0; 3], vec![f64::NAN; 2], vec![f64::INFINITY, 0.0]] {
            let matrix = ScatterMatrix {
                names: vec!["a".into(), "b".into()],
                columns: vec![column.clone(), column],
                ..ScatterMatrix::default()
            };
            let text = write(&matrix);
            assert!(text.starts_with("<svg") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
        assert!(write(&ScatterMatrix::default()).contains("</svg>"));
    }
}
