//! What is drawn, before it is known where: panels with curves.

/// A picture: panels one below the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Stands above; may be empty.
    pub title: String,
    /// From top to bottom.
    pub panels: Vec<FigurePanel>,
    /// All panels show the same horizontal axis, which is labelled once and zoomed together.
    pub shared_x: bool,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigurePanel {
    /// Below the horizontal axis, with unit.
    pub x_label: String,
    /// Beside the vertical axis, with unit.
    pub y_label: String,
    /// Words for the values 0, 1, 2 ... of the vertical axis, instead of numbers.
    pub words: Vec<String>,
    /// Curves, in the order of the legend.
    pub series: Vec<PlotSeries>,
    /// Areas behind the curves.
    pub bands: Vec<PlotBand>,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotSeries {
    /// As in the legend.
    pub name: String,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Vertical values; NaN interrupts the curve.
    pub y: Vec<f64>,
    /// Drawn as a staircase.
    pub held: bool,
    /// Which colour of the palette.
    pub colour: usize,
    /// Drawn with dashes: the second of two compared curves.
    pub dashed: bool,
    /// A cross at each point instead of a line through them.
    pub crosses: bool,
}

/// An area between two curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotBand {
    /// Horizontal values, growing.
    pub x: Vec<f64>,
    /// Lower edge.
    pub low: Vec<f64>,
    /// Upper edge.
    pub high: Vec<f64>,
    /// Which colour of the palette.
    pub colour: usize,
}

/// Colours that people with colour-blindness tell apart, dark enough on white (after Okabe and Ito).
pub const PALETTE: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#b8478f", "#c08000", "#4aa3df", "#444444"];

/// The colour of a number; beyond the palette they repeat.
pub fn colour(index: usize) -> &'static str {
    PALETTE[index % PALETTE.len()]
}

impl FigurePanel {
    /// The smallest rectangle around all finite points: left, right, bottom, top.
    pub fn bounds(&self) -> Option<(f64, f64, f64, f64)> {
        let curves = self.series.iter().map(|s| (&s.x, &s.y));
        let edges = self.bands.iter().flat_map(|b| [(&b.x, &b.low), (&b.x, &b.high)]);
        let mut out: Option<(f64, f64, f64, f64)> = None;
        for (xs, ys) in curves.chain(edges) {
            for (&x, &y) in xs.iter().zip(ys).filter(|(x, y)| x.is_finite() && y.is_finite()) {
                let (l, r, b, t) = out.unwrap_or((x, x, y, y));
                out = Some((l.min(x), r.max(x), b.min(y), t.max(y)));
            }
        }
        out
    }
}
