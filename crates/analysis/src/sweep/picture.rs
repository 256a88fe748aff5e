//! Pictures of a sweep: a scatter matrix, and one panel for each pair of parameter and result.
//!
//! A [`SweepTable`] with its parameters in the first columns enters; figures for `crates/plot` leave.

use super::SweepTable;
use bramah_plot::matrix::ScatterMatrix;
use bramah_plot::{Figure, FigurePanel, PlotSeries};

/// Largest number of panels.
const PANELS: usize = 12;
/// Largest number of columns in the matrix.
const COLUMNS: usize = 8;

/// Parameters and results against each other. The first result colours the dots, so a cell of two parameters is a map
/// of it. Columns beyond the limit are left out.
pub fn matrix(table: &SweepTable, parameters: usize, title: &str) -> ScatterMatrix {
    let results = (table.columns.len() - parameters).min(COLUMNS / 2);
    let shown = (0..parameters.min(COLUMNS - results)).chain(parameters..parameters + results);
    let (names, columns): (Vec<String>, Vec<Vec<f64>>) =
        shown.map(|k| (table.columns[k].clone(), table.column(k))).unzip();
    let shade = (results > 0).then(|| columns.len() - results);
    ScatterMatrix { title: title.to_owned(), names, columns, shade }
}

/// One panel for each parameter and result, with a cross for each run.
pub fn scatter(table: &SweepTable, parameters: usize, title: &str) -> Figure {
    let results = parameters..table.columns.len();
    let pairs = results.flat_map(|r| (0..parameters).map(move |p| (p, r))).take(PANELS);
    let panels = pairs.map(|(p, r)| {
        let series = crosses(&table.column(p), &table.column(r), &table.columns[r]);
        FigurePanel {
            x_label: table.columns[p].clone(),
            y_label: table.columns[r].clone(),
            series: vec![series],
            ..FigurePanel::default()
        }
    });
    Figure { title: title.to_owned(), panels: panels.collect(), shared_x: false }
}

/// Points as small crosses; NaN is left out.
fn crosses(x: &[f64], y: &[f64], name: &str) -> PlotSeries {
    let arm = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
        if range > 0.0 { 0.004 * range } else { 1e-9 }
    };
    let (wide, high) = (arm(x), arm(y));
    let mut series = PlotSeries { name: name.to_owned(), ..PlotSeries::default() };
    for (&x, &y) in x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite()) {
        // NaN interrupts the line between the two strokes.
        series.x.extend([x - wide, x + wide, f64::NAN, x, x, f64::NAN]);
        series.y.extend([y, y, f64::NAN, y - high, y + high, f64::NAN]);
    }
    series
}
