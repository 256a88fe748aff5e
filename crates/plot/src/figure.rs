//! The content of a picture of curves, independent of its size and format: panels with series and bands.
//!
//! `select` and the analyses of other crates build a [`Figure`]; `svg` and `html` draw it.

/// A picture of panels, one below the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Text above the picture; may be empty.
    pub title: String,
    /// The panels from top to bottom.
    pub panels: Vec<FigurePanel>,
    /// All panels have the same horizontal axis. It is labelled once, and the page zooms all panels together.
    pub shared_x: bool,
}

/// One pair of axes with its curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigurePanel {
    /// Label of the horizontal axis, with unit.
    pub x_label: String,
    /// Label of the vertical axis, with unit.
    pub y_label: String,
    /// Words for the values 0, 1, 2 ... of the vertical axis, instead of numbers.
    pub words: Vec<String>,
    /// The curves, in the order of the legend.
    pub series: Vec<PlotSeries>,
    /// Areas drawn behind the curves.
    pub bands: Vec<PlotBand>,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotSeries {
    /// Name in the legend.
    pub name: String,
    /// Horizontal coordinates, as many as vertical ones.
    pub x: Vec<f64>,
    /// Vertical coordinates. NaN interrupts the curve.
    pub y: Vec<f64>,
    /// Each value holds until the next point, so the curve is a staircase.
    pub held: bool,
    /// Index of the colour in [`PALETTE`].
    pub colour: usize,
    /// Drawn with dashes: the second of two compared curves.
    pub dashed: bool,
    /// A cross at each point instead of a line through them.
    pub crosses: bool,
}

/// An area between two curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotBand {
    /// Horizontal coordinates, ascending.
    pub x: Vec<f64>,
    /// Lower edge at each of them.
    pub low: Vec<f64>,
    /// Upper edge at each of them.
    pub high: Vec<f64>,
    /// Index of the colour in [`PALETTE`].
    pub colour: usize,
}

/// Colours that people with colour blindness can distinguish, dark enough on white (after Okabe and Ito).
pub const PALETTE: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#b8478f", "#c08000", "#4aa3df", "#444444"];

/// The colour with an index. Beyond the palette the colours repeat.
pub fn colour(index: usize) -> &'static str {
    PALETTE[index % PALETTE.len()]
}

impl FigurePanel {
    /// The smallest rectangle around all finite points: left, right, bottom, top. `None`: there is no finite point.
    pub fn bounds(&self) -> Option<(f64, f64, f64, f64)> {
        let curves = self.series.iter().map(|s| (&s.x, &s.y));
        let edges = self.bands.iter().flat_map(|b| [(&b.x, &b.low), (&b.x, &b.high)]);
        let mut out: Option<(f64, f64, f64, f64)> = None;
        for (xs, ys) in curves.chain(edges) {
            // A single infinite value would make the axis useless.
            for (&x, &y) in xs.iter().zip(ys).filter(|(x, y)| x.is_finite() && y.is_finite()) {
                let (l, r, b, t) = out.unwrap_or((x, x, y, y));
                out = Some((l.min(x), r.max(x), b.min(y), t.max(y)));
            }
        }
        out
    }
}
