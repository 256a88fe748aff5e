//! Draws maps: quantities over two others as contour lines, as efficiencies are drawn over speed and pressure.
//!
//! Several runs enter. Each is a row of the map: one variable grows along the run (horizontal axis), another keeps its
//! value (vertical axis). `map` interpolates them to a grid, `write` draws it as SVG. `bramah plot --x --y` uses
//! both.

use super::select::{LabelledTrajectory, axis_label, shown_values};
use super::svg::{begin, escape};
use super::ticks::{AxisTicks, ticks};
use bramah_results::{GlobPatterns, Signal, Trajectory};
use std::fmt::Write as _;

/// Points of the grid along the horizontal axis.
const COLUMNS: usize = 41;
/// A quantity counts as constant along a run when its range is below this share of its size.
const CONSTANT: f64 = 1e-3;

/// Quantities on a grid, ready to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContourMap {
    /// Text above the picture; may be empty.
    pub title: String,
    /// Label of the horizontal axes, with unit.
    pub x_label: String,
    /// Label of the vertical axes, with unit.
    pub y_label: String,
    /// Horizontal coordinates of the grid, ascending.
    pub x: Vec<f64>,
    /// Vertical coordinates of the grid, ascending.
    pub y: Vec<f64>,
    /// Label and values of each quantity. Values are given row by row from the lowest; NaN leaves a hole.
    pub panels: Vec<(String, Vec<Vec<f64>>)>,
}

/// Makes a map from runs. Each run is a row at the value of `y`, and goes from left to right with `x`.
///
/// `variables` are the quantities to draw; each becomes a panel. All values are in display units.
///
/// Two runs at the same value of `y` count once.
///
/// # Errors
/// A sentence, when a variable is missing, `y` changes along a run, `x` does not grow, or fewer than two rows remain.
pub fn map(
    runs: &[LabelledTrajectory<'_>],
    variables: &GlobPatterns,
    x: &str,
    y: &str,
    title: &str,
) -> Result<ContourMap, String> {
    let mut rows = Vec::new();
    for run in runs {
        rows.push((level(run, y)?, run));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by(|a, b| a.0 == b.0);
    if rows.len() < 2 {
        return Err(format!("a map needs results with two or more values of `{y}`"));
    }
    let first = runs[0].trajectory;
    let mut places = Vec::new();
    for (_, run) in &rows {
        places.push(growing(run, x)?);
    }
    // The grid covers only what all runs have in common, since values are not extrapolated.
    let low = places.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    let high = places.iter().map(|p| p[p.len() - 1]).fold(f64::INFINITY, f64::min);
    let grid: Vec<f64> = (0..COLUMNS).map(|i| low + (high - low) * i as f64 / (COLUMNS - 1) as f64).collect();
    let mut panels = Vec::new();
    for signal in first.signals.iter().filter(|s| variables.matches(&s.name) && s.name != x && s.name != y) {
        let mut values = Vec::new();
        for ((_, run), places) in rows.iter().zip(&places) {
            let (_, column) = shown(run.trajectory, &signal.name)?;
            values.push(grid.iter().map(|&g| between(places, &column, g)).collect());
        }
        panels.push((axis_label(&signal.name, signal), values));
    }
    if panels.is_empty() {
        return Err("no variable matches".to_owned());
    }
    Ok(ContourMap {
        title: title.to_owned(),
        x_label: axis_label(x, shown(first, x)?.0),
        y_label: axis_label(y, shown(first, y)?.0),
        x: grid,
        y: rows.iter().map(|r| r.0).collect(),
        panels,
    })
}

/// A signal and its values in the display unit. `Err`: there is none of this name.
fn shown<'a>(trajectory: &'a Trajectory, name: &str) -> Result<(&'a Signal, Vec<f64>), String> {
    let index = trajectory.index(name).ok_or_else(|| format!("there is no variable `{name}`"))?;
    let signal = &trajectory.signals[index];
    Ok((signal, shown_values(signal, &trajectory.columns[index])))
}

/// The value that a variable keeps along a run. `Err`: it changes.
fn level(run: &LabelledTrajectory<'_>, name: &str) -> Result<f64, String> {
    let (_, column) = shown(run.trajectory, name)?;
    let (low, high) = column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if high - low <= CONSTANT * high.abs().max(low.abs()) {
        Ok((low + high) / 2.0)
    } else {
        Err(format!("`{name}` changes along {}, and each result is one row of the map", run.label))
    }
}

/// The values of a variable that grows along a run. `Err`: it falls somewhere or does not grow at all.
fn growing(run: &LabelledTrajectory<'_>, name: &str) -> Result<Vec<f64>, String> {
    let (_, column) = shown(run.trajectory, name)?;
    if column.len() >= 2 && column.windows(2).all(|w| w[1] >= w[0]) && column[0] < column[column.len() - 1] {
        Ok(column)
    } else {
        Err(format!("`{name}` does not grow along {}", run.label))
    }
}

/// Linear interpolation of values at a place.
///
/// `places` are ascending and at least two.
fn between(places: &[f64], values: &[f64], at: f64) -> f64 {
    // The interval around the place; places outside use the first or last one.
    let i = places.partition_point(|p| *p < at).clamp(1, places.len() - 1);
    // Two equal places are a jump; the value after it is taken.
    let share = if places[i] > places[i - 1] { (at - places[i - 1]) / (places[i] - places[i - 1]) } else { 1.0 };
    values[i - 1] + share.clamp(0.0, 1.0) * (values[i] - values[i - 1])
}

/// Width of the picture.
const WIDTH: f64 = 900.0;
/// Space to the left of the axes.
const LEFT: f64 = 62.0;
/// Space below the axes.
const BELOW: f64 = 52.0;
/// Space above the axes, for the name of the quantity.
const ABOVE: f64 = 30.0;

/// A corner of the grid: horizontal and vertical place in the picture, and value.
type GridCorner = (f64, f64, f64);

/// One quantity with its place in the picture.
struct ContourMapFrame<'a> {
    /// The map with its axes.
    map: &'a ContourMap,
    /// Values by row and column.
    values: &'a [Vec<f64>],
    /// Left edge.
    left: f64,
    /// Upper edge.
    top: f64,
    /// Width of the axes.
    width: f64,
    /// Height of the axes.
    height: f64,
}

impl ContourMapFrame<'_> {
    /// The corner of the grid at a column and row.
    fn corner(&self, column: usize, row: usize) -> GridCorner {
        let span = |v: &[f64], at: f64| (at - v[0]) / (v[v.len() - 1] - v[0]);
        let x = self.left + span(&self.map.x, self.map.x[column]) * self.width;
        let y = self.top + (1.0 - span(&self.map.y, self.map.y[row])) * self.height;
        (x, y, self.values[row][column])
    }

    /// Whether a number centred at this place stays inside the axes.
    ///
    /// The margins are half the size of a usual number.
    fn has_room(&self, (x, y): (f64, f64)) -> bool {
        let inside = |at: f64, low: f64, wide: f64, margin: f64| at > low + margin && at < low + wide - margin;
        inside(x, self.left, self.width, 18.0) && inside(y, self.top, self.height, 9.0)
    }

    /// The four corners of a cell in order around it.
    fn cell(&self, column: usize, row: usize) -> [GridCorner; 4] {
        [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| self.corner(column + i, row + j))
    }

    /// All cells as two triangles each. Triangles with holes are left out.
    ///
    /// In a triangle the interpolation is linear, so a contour line is straight and unique.
    fn triangles(&self) -> Vec<[GridCorner; 3]> {
        let (rows, columns) = (self.map.y.len() - 1, self.map.x.len() - 1);
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let halves = cells.flat_map(|(column, row)| {
            let [a, b, c, d] = self.cell(column, row);
            [[a, b, c], [a, c, d]]
        });
        halves.filter(|t| t.iter().all(|c| c.2.is_finite())).collect()
    }
}

/// Draws a map, 900 wide, with two quantities in a row.
pub fn write(map: &ContourMap) -> String {
    let columns = map.panels.len().min(2);
    let rows = map.panels.len().div_ceil(2);
    let wide = WIDTH / columns.max(1) as f64;
    let height = if columns == 1 { 440.0 } else { 330.0 };
    let top = if map.title.is_empty() { 0.0 } else { 36.0 };
    let title = if map.title.is_empty() { "Map" } else { &map.title };
    let mut out = begin(WIDTH, top + height * rows as f64, 13, title);
    if !map.title.is_empty() {
        let x = WIDTH / 2.0;
        let _ =
            writeln!(out, "<text x=\"{x}\" y=\"25\" font-size=\"16\" text-anchor=\"middle\">{}</text>", escape(title));
    }
    for (k, (name, values)) in map.panels.iter().enumerate() {
        let frame = ContourMapFrame {
            map,
            values,
            left: LEFT + wide * (k % 2) as f64,
            top: top + ABOVE + height * (k / 2) as f64,
            width: wide - LEFT - 20.0,
            height: height - ABOVE - BELOW,
        };
        panel(&mut out, &frame, name);
    }
    out.push_str("</svg>\n");
    out
}

/// Draws one quantity: areas, lines with numbers, axes.
///
/// The levels are round numbers between the lowest and the highest value.
fn panel(out: &mut String, frame: &ContourMapFrame<'_>, name: &str) {
    let triangles = frame.triangles();
    let finite = || triangles.iter().flatten().map(|c| c.2);
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let levels = ticks(low, high, 10);
    bands(out, frame, &levels);
    lines(out, frame, &triangles, &levels);
    axes(out, frame, name);
}

/// Draws the areas between neighbouring levels, from light to dark.
///
/// The lowest band reaches down and the highest one up without limit.
fn bands(out: &mut String, frame: &ContourMapFrame<'_>, levels: &AxisTicks) {
    let edges: Vec<f64> = levels.marks.iter().map(|m| m.0).collect();
    for k in 0..=edges.len() {
        let low = if k == 0 { f64::NEG_INFINITY } else { edges[k - 1] };
        let high = edges.get(k).copied().unwrap_or(f64::INFINITY);
        let mut path = String::new();
        for row in 0..frame.map.y.len() - 1 {
            band_of_row(&mut path, frame, row, (low, high));
        }
        if !path.is_empty() {
            let fill = shade(k as f64 / edges.len().max(1) as f64);
            // The thin outline closes the gaps that viewers leave between areas.
            let _ = writeln!(out, "<path d=\"{path}\" fill=\"{fill}\" stroke=\"{fill}\" stroke-width=\"0.6\"/>");
        }
    }
}

/// Adds a row of a band. Neighbouring cells that are completely inside are joined to one rectangle, which keeps the
/// file small.
fn band_of_row(path: &mut String, frame: &ContourMapFrame<'_>, row: usize, (low, high): (f64, f64)) {
    let mut whole: Option<[GridCorner; 4]> = None;
    for column in 0..frame.map.x.len() - 1 {
        let cell = frame.cell(column, row);
        if cell.iter().all(|c| c.2 >= low && c.2 <= high) {
            whole = Some(whole.map_or(cell, |[a, .., d]| [a, cell[1], cell[2], d]));
            continue;
        }
        // The rectangle ends before a cell that is not completely inside.
        polygon(path, whole.take().as_ref().map_or(&[], |w| w.as_slice()));
        let [a, b, c, d] = cell;
        for half in [[a, b, c], [a, c, d]] {
            if half.iter().all(|c| c.2.is_finite()) {
                // Cut off what is below the band, then what is above it.
                polygon(path, &clipped(&clipped(&half, |v| v - low), |v| high - v));
            }
        }
    }
    polygon(path, whole.as_ref().map_or(&[], |w| w.as_slice()));
}

/// Adds a closed polygon to a path; nothing for an empty list.
fn polygon(path: &mut String, corners: &[GridCorner]) {
    for (i, corner) in corners.iter().enumerate() {
        let _ = write!(path, "{}{:.1} {:.1}", if i == 0 { "M" } else { "L" }, corner.0, corner.1);
    }
    if !corners.is_empty() {
        path.push('Z');
    }
}

/// The colour of a band: from nearly white to a blue on which dark lines are still visible.
fn shade(share: f64) -> String {
    let mix = |from: f64, to: f64| (from + share.clamp(0.0, 1.0) * (to - from)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(247.0, 112.0), mix(249.0, 168.0), mix(251.0, 208.0))
}

/// The part of a polygon where `inside` of the value is not negative.
///
/// This is one step of Sutherland and Hodgman's algorithm. The values of new corners are interpolated.
fn clipped(polygon: &[GridCorner], inside: impl Fn(f64) -> f64) -> Vec<GridCorner> {
    let mut out = Vec::new();
    for (i, &b) in polygon.iter().enumerate() {
        let a = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (da, db) = (inside(a.2), inside(b.2));
        // An edge that changes sides is cut where the function is zero.
        if (da >= 0.0) != (db >= 0.0) {
            let s = da / (da - db);
            out.push((a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1), a.2 + s * (b.2 - a.2)));
        }
        if db >= 0.0 {
            out.push(b);
        }
    }
    out
}

/// Draws the contour lines. Each has its number near the diagonal of the map, away from other numbers.
///
/// The segments of a level are drawn as one path, one segment for each triangle.
fn lines(out: &mut String, frame: &ContourMapFrame<'_>, triangles: &[[GridCorner; 3]], levels: &AxisTicks) {
    let mut texts: Vec<(f64, f64)> = Vec::new();
    let mut numbers = String::new();
    for (level, text) in &levels.marks {
        let segments: Vec<[f64; 4]> = triangles.iter().filter_map(|t| crossing(t, *level)).collect();
        if segments.is_empty() {
            continue;
        }
        let path: String =
            segments.iter().map(|s| format!("M{:.1} {:.1}L{:.1} {:.1}", s[0], s[1], s[2], s[3])).collect();
        let _ = writeln!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"#33414d\" stroke-width=\"1\"/>");
        let middle = |s: &[f64; 4]| ((s[0] + s[2]) / 2.0, (s[1] + s[3]) / 2.0);
        let from_diagonal =
            |p: (f64, f64)| ((p.0 - frame.left) / frame.width - (frame.top + frame.height - p.1) / frame.height).abs();
        let free = |p: &(f64, f64)| texts.iter().all(|t| (t.0 - p.0).abs() > 34.0 || (t.1 - p.1).abs() > 15.0);
        // Numbers must overlap neither each other nor the frame. A line without room gets none.
        let candidates = segments.iter().map(middle).filter(|p| frame.has_room(*p) && free(p));
        if let Some(p) = candidates.min_by(|a, b| from_diagonal(*a).total_cmp(&from_diagonal(*b))) {
            texts.push(p);
            let _ = writeln!(
                numbers,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11.5\" text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\">{text}</text>",
                p.0,
                p.1 + 4.0
            );
        }
    }
    // All numbers come after all lines, so that no line crosses them.
    out.push_str(&numbers);
}

/// The segment in which a level crosses a triangle. `None`: it does not.
///
/// The result has the two end points as x, y, x, y.
fn crossing(triangle: &[GridCorner; 3], level: f64) -> Option<[f64; 4]> {
    let mut points = Vec::new();
    for i in 0..3 {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        if (a.2 >= level) != (b.2 >= level) {
            let s = (level - a.2) / (b.2 - a.2);
            points.push((a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1)));
        }
    }
    match points[..] {
        [p, q] => Some([p.0, p.1, q.0, q.1]),
        _ => None,
    }
}

/// Draws frame, name, ticks and labels of a quantity.
fn axes(out: &mut String, frame: &ContourMapFrame<'_>, name: &str) {
    let ContourMapFrame { left, top, width, height, map, .. } = frame;
    let (right, bottom) = (left + width, top + height);
    let _ = writeln!(
        out,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" stroke=\"#444444\"/>\n\
         <text x=\"{left:.1}\" y=\"{:.1}\" font-weight=\"600\">{}</text>",
        top - 9.0,
        escape(name)
    );
    let ends = |v: &[f64]| (v[0], v[v.len() - 1]);
    let ((x0, x1), (y0, y1)) = (ends(&map.x), ends(&map.y));
    let (across, upwards) = (ticks(x0, x1, 6), ticks(y0, y1, 6));
    for (place, text) in &across.marks {
        let x = left + (place - x0) / (x1 - x0) * width;
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {bottom:.1}v4\" stroke=\"#444444\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
            bottom + 18.0
        );
    }
    for (place, text) in &upwards.marks {
        let y = bottom - (place - y0) / (y1 - y0) * height;
        let _ = writeln!(
            out,
            "<path d=\"M{left:.1} {y:.1}h-4\" stroke=\"#444444\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            left - 8.0,
            y + 4.0
        );
    }
    let (middle, below) = ((left + right) / 2.0, bottom + 38.0);
    let (aside, half) = (left - 44.0, (top + bottom) / 2.0);
    let _ = writeln!(
        out,
        "<text x=\"{middle:.1}\" y=\"{below:.1}\" text-anchor=\"middle\">{}</text>\n\
         <text x=\"{aside:.1}\" y=\"{half:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 {aside:.1} {half:.1})\">{}</text>",
        escape(&with_power(&map.x_label, across.power)),
        escape(&with_power(&map.y_label, upwards.power)),
    );
}

/// Adds a power of ten to a label.
fn with_power(label: &str, power: i32) -> String {
    if power == 0 { label.to_owned() } else { format!("{label} (1e{power})") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(y: f64) -> Trajectory {
        let mut t = Trajectory::new(vec![Signal::new("x"), Signal::new("y"), Signal::new("z")]);
        (0..11).for_each(|i| t.push(f64::from(i), &[f64::from(i), y, f64::from(i) + y]));
        t
    }

    fn runs(rows: &[Trajectory]) -> Vec<LabelledTrajectory<'_>> {
        rows.iter().map(|trajectory| LabelledTrajectory { label: "a", trajectory }).collect()
    }

    #[test]
    fn rows_are_sorted_and_interpolated() {
        let rows = [row(4.0), row(0.0), row(2.0)];
        let map = map(&runs(&rows), &GlobPatterns::new(&["z"]), "x", "y", "").unwrap();
        assert_eq!(map.y, [0.0, 2.0, 4.0]);
        let (name, values) = &map.panels[0];
        assert_eq!((name.as_str(), map.panels.len()), ("z", 1));
        for (j, y) in map.y.iter().enumerate() {
            for (i, x) in map.x.iter().enumerate() {
                assert!((values[j][i] - x - y).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_no_map_is_told() {
        let rows = [row(0.0), row(2.0)];
        let said = |x: &str, y: &str| map(&runs(&rows), &GlobPatterns::new(&["z"]), x, y, "").unwrap_err();
        assert_eq!(said("x", "z"), "`z` changes along a, and each result is one row of the map");
        assert_eq!(said("y", "y"), "`y` does not grow along a");
        assert_eq!(said("x", "w"), "there is no variable `w`");
        let one = map(&runs(&rows[..1]), &GlobPatterns::new(&["z"]), "x", "y", "").unwrap_err();
        assert_eq!(one, "a map needs results with two or more values of `y`");
    }

    #[test]
    fn a_level_passes_where_the_value_is() {
        let triangle = [(0.0, 0.0, 0.0), (10.0, 0.0, 1.0), (0.0, 10.0, 1.0)];
        assert_eq!(crossing(&triangle, 0.5), Some([5.0, 0.0, 0.0, 5.0]));
        assert_eq!(crossing(&triangle, 2.0), None);
        let area = |p: &[GridCorner]| {
            let cross = |i: usize| p[i].0 * p[(i + 1) % p.len()].1 - p[(i + 1) % p.len()].0 * p[i].1;
            (0..p.len()).map(cross).sum::<f64>().abs() / 2.0
        };
        let (below, above) = (clipped(&triangle, |v| 0.5 - v), clipped(&triangle, |v| v - 0.5));
        assert!((area(&below) - 12.5).abs() < 1e-12 && (area(&above) - 37.5).abs() < 1e-12);
    }

    #[test]
    fn a_picture_has_lines_and_numbers() {
        let rows = [row(0.0), row(2.0), row(4.0)];
        let picture = write(&map(&runs(&rows), &GlobPatterns::new(&["z"]), "x", "y", "A plane").unwrap());
        assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n"));
        assert!(picture.contains("A plane") && picture.contains(">8</text>"));
        assert!(!picture.contains("NaN") && !picture.contains("inf"));
    }
}
