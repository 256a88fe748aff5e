//! Draws a figure of curves as SVG, and offers the common parts of all pictures ([`escape`], `begin`).
//!
//! A [`Figure`] enters, the text of an SVG file leaves. The panels share one left margin, so that their axes are
//! aligned. Coordinates are written with one decimal, which keeps files small.

use std::fmt::{Display, Write as _};

use super::decimate::{CurvePoints, decimate, staircase};
use super::figure::{Figure, FigurePanel, PlotSeries, colour};
use super::ticks::{AxisTicks, ticks};

/// Width of the picture.
const WIDTH: f64 = 900.0;
/// Space to the right of the axes.
const RIGHT: f64 = 24.0;
/// Font size.
const TEXT: f64 = 13.0;
/// Mean width of a character at this font size. The real width is not known, because the viewer chooses the font.
const CHARACTER: f64 = 6.6;
/// Height of a line of the legend.
const LINE: f64 = 20.0;

/// Position and ranges of a panel's axes in the picture.
struct PanelFrame {
    /// Left edge in the picture.
    left: f64,
    /// Upper edge in the picture.
    top: f64,
    /// Width of the axes.
    width: f64,
    /// Height of the axes.
    height: f64,
    /// Lowest and highest value of the horizontal axis.
    x: (f64, f64),
    /// Lowest and highest value of the vertical axis.
    y: (f64, f64),
}

impl PanelFrame {
    /// The horizontal place of a value in the picture.
    fn px(&self, x: f64) -> f64 {
        self.left + (x - self.x.0) / (self.x.1 - self.x.0) * self.width
    }

    /// The vertical place of a value. SVG counts downwards.
    fn py(&self, y: f64) -> f64 {
        self.top + self.height - (y - self.y.0) / (self.y.1 - self.y.0) * self.height
    }
}

/// Draws a figure. The picture is 900 wide, its height depends on the number of panels.
///
/// Panels are drawn first, because the total height follows from them. The title is put before them.
pub fn write(figure: &Figure) -> String {
    let plots: Vec<PanelAxes<'_>> = figure.panels.iter().map(|p| PanelAxes::new(p, figure)).collect();
    // The widest tick text of all panels decides, so that all axes begin at the same place.
    let left = plots.iter().map(PanelAxes::label_width).fold(0.0, f64::max) + 44.0;
    let mut body = String::new();
    let mut y = if figure.title.is_empty() { 10.0 } else { 40.0 };
    for (i, plot) in plots.iter().enumerate() {
        let last = i + 1 == plots.len();
        y = plot.draw(&mut body, i, y, left, last || !figure.shared_x);
    }
    let height = y + 8.0;
    let mut out = begin(WIDTH, height, TEXT, if figure.title.is_empty() { "Plot" } else { &figure.title });
    if !figure.title.is_empty() {
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"25\" font-size=\"16\" text-anchor=\"middle\">{}</text>",
            WIDTH / 2.0,
            escape(&figure.title)
        );
    }
    out.push_str(&body);
    out.push_str("</svg>\n");
    out
}

/// The beginning of every picture: size, font size, title for screen readers, white background.
///
/// `text` is the font size. The caller appends the content and the closing tag.
pub(super) fn begin(width: impl Display, height: impl Display, text: impl Display, title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" font-family=\"Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif\" font-size=\"{text}\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        escape(title)
    )
}

/// Escapes the characters that have a meaning in XML. Control characters are dropped, as XML forbids most of them.
///
/// The result may be used as text and as the value of an attribute.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// A panel with its ranges and ticks, ready to be placed.
struct PanelAxes<'a> {
    /// The content.
    panel: &'a FigurePanel,
    /// Range of the horizontal axis.
    x: (f64, f64),
    /// Range of the vertical axis.
    y: (f64, f64),
    /// Ticks of the horizontal axis.
    x_ticks: AxisTicks,
    /// Ticks of the vertical axis.
    y_ticks: AxisTicks,
    /// Height of the axes in the picture.
    height: f64,
}

impl<'a> PanelAxes<'a> {
    /// Chooses ranges, ticks and height of a panel.
    ///
    /// With a common horizontal axis, the range covers the curves of all panels.
    fn new(panel: &'a FigurePanel, figure: &Figure) -> Self {
        let own = panel.bounds().unwrap_or((0.0, 1.0, 0.0, 1.0));
        let shared = || figure.panels.iter().filter_map(FigurePanel::bounds).map(|b| (b.0, b.1));
        let x = if figure.shared_x {
            shared().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 1.0))
        } else {
            (own.0, own.1)
        };
        // Fewer panels get more height. Among several, a panel with words needs a line for each word.
        let height = match (figure.panels.len(), panel.words.is_empty()) {
            (1, _) => 400.0,
            (2, true) => 240.0,
            (_, true) => 180.0,
            (_, false) => 30.0 + 24.0 * panel.words.len() as f64,
        };
        // A curve over time may touch the frame at its ends. A curve over another quantity may turn there and gets a
        // margin.
        let phase = !figure.shared_x;
        let x = if phase { widened(x, 0.05) } else { widened(x, 0.0) };
        let y =
            if panel.words.is_empty() { widened((own.2, own.3), 0.06) } else { (-0.3, panel.words.len() as f64 - 0.7) };
        let y_ticks =
            if panel.words.is_empty() { ticks(y.0, y.1, (height / 45.0) as usize) } else { words(&panel.words) };
        PanelAxes { panel, x, y, x_ticks: ticks(x.0, x.1, 8), y_ticks, height }
    }

    /// Width of the longest tick text of the vertical axis.
    fn label_width(&self) -> f64 {
        let longest = self.y_ticks.marks.iter().map(|m| m.1.chars().count()).max().unwrap_or(0);
        longest as f64 * CHARACTER
    }

    /// Draws the panel at height `y`. Returns where the next panel begins.
    ///
    /// `index` makes the name of the clipping area unique. `left` is the left edge of the axes in all panels. The
    /// horizontal axis is labelled only when `with_x_label` is set.
    fn draw(&self, out: &mut String, index: usize, y: f64, left: f64, with_x_label: bool) -> f64 {
        let legend_height = self.legend(out, y, left);
        let frame = PanelFrame {
            left,
            top: y + legend_height,
            width: WIDTH - left - RIGHT,
            height: self.height,
            x: self.x,
            y: self.y,
        };
        self.axes(out, &frame, with_x_label);
        // Curves are clipped to the axes; the name must be unique in the picture.
        let _ = writeln!(
            out,
            "<clipPath id=\"c{index}\"><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g clip-path=\"url(#c{index})\" fill=\"none\" stroke-width=\"1.6\" stroke-linejoin=\"round\">",
            frame.left - 1.0,
            frame.top - 1.0,
            frame.width + 2.0,
            frame.height + 2.0
        );
        for band in &self.panel.bands {
            let up = band.x.iter().copied().zip(band.high.iter().copied());
            let down = band.x.iter().copied().zip(band.low.iter().copied());
            let columns = frame.width as usize;
            let mut points = decimate(up.collect(), columns);
            // There along the upper edge and back along the lower one.
            points.extend(decimate(down.collect(), columns).into_iter().rev());
            let fill = colour(band.colour);
            let _ = writeln!(
                out,
                "<path stroke=\"none\" fill=\"{fill}\" fill-opacity=\"0.15\" d=\"{}Z\"/>",
                path(&points, &frame)
            );
        }
        for series in &self.panel.series {
            curve(out, series, &frame);
        }
        out.push_str("</g>\n");
        frame.top + frame.height + if with_x_label { 52.0 } else { 14.0 }
    }

    /// Draws the legend above the axes and returns its height.
    ///
    /// Each entry is a sample of the line and a name. Widths of names are estimated from their number of characters.
    fn legend(&self, out: &mut String, y: f64, left: f64) -> f64 {
        let mut x = left;
        let mut line = y + 14.0;
        for series in &self.panel.series {
            let width = 34.0 + 16.0 + series.name.chars().count() as f64 * CHARACTER * 1.02;
            // A new line when the entry does not fit, unless the line is empty.
            if x + width > WIDTH - RIGHT && x > left {
                x = left;
                line += LINE;
            }
            let dash = if series.dashed { " stroke-dasharray=\"6 4\"" } else { "" };
            let sample =
                if series.crosses { cross(x + 13.0, line - 4.5) } else { format!("M{x:.1} {:.1}h26", line - 4.5) };
            let _ = writeln!(
                out,
                "<path d=\"{sample}\" stroke=\"{}\" stroke-width=\"2.4\"{dash}/><text x=\"{:.1}\" y=\"{line:.1}\">{}</text>",
                colour(series.colour),
                x + 34.0,
                escape(&series.name)
            );
            x += width;
        }
        line - y + 10.0
    }

    /// Draws grid, ticks, frame and labels.
    ///
    /// Without label of the horizontal axis the grid is drawn nevertheless, so that panels with a common axis can be
    /// compared.
    fn axes(&self, out: &mut String, frame: &PanelFrame, with_x_label: bool) {
        let (l, t, w, h) = (frame.left, frame.top, frame.width, frame.height);
        let bottom = t + h;
        let mut grid = String::new();
        for (place, text) in &self.x_ticks.marks {
            let x = frame.px(*place);
            let _ = write!(grid, "M{x:.1} {t:.1}V{bottom:.1}");
            if with_x_label {
                let _ =
                    writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>", bottom + 18.0);
            }
        }
        for (place, text) in &self.y_ticks.marks {
            let y = frame.py(*place);
            let _ = write!(grid, "M{l:.1} {y:.1}h{w:.1}");
            let _ = writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                l - 8.0,
                y + 4.5,
                escape(text)
            );
        }
        let _ = writeln!(
            out,
            "<path d=\"{grid}\" stroke=\"#e2e2e2\" fill=\"none\"/>\n\
             <rect x=\"{l:.1}\" y=\"{t:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" fill=\"none\" stroke=\"#777777\"/>"
        );
        let middle = t + h / 2.0;
        let label = with_power(&self.panel.y_label, self.y_ticks.power);
        let _ = writeln!(
            out,
            "<text transform=\"translate(18 {middle:.1}) rotate(-90)\" text-anchor=\"middle\"{}>{}</text>",
            smaller(&label, h),
            escape(&label)
        );
        if with_x_label {
            let _ = writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                l + w / 2.0,
                bottom + 38.0,
                escape(&with_power(&self.panel.x_label, self.x_ticks.power))
            );
        }
    }
}

/// Adds a power of ten to a label: `p in Pa` becomes `p in 1e6 Pa`.
///
/// A label without unit gets the power in brackets. With power 0 the label is unchanged.
fn with_power(label: &str, power: i32) -> String {
    if power == 0 {
        return label.to_owned();
    }
    match label.rsplit_once(" in ") {
        Some((name, unit)) => format!("{name} in 1e{power} {unit}"),
        None => format!("{label} (1e{power})"),
    }
}

/// Ticks with words at the values 0, 1, 2 and so on.
fn words(words: &[String]) -> AxisTicks {
    AxisTicks { marks: words.iter().enumerate().map(|(i, w)| (i as f64, w.clone())).collect(), power: 0 }
}

/// The range with a margin of this share on both sides. It is never empty.
///
/// A range without width is widened by a tenth of its value, or to -1 to 1 around zero.
fn widened(range: (f64, f64), part: f64) -> (f64, f64) {
    // The width of a larger range would overflow.
    let (low, high) = (range.0.max(-1e300), range.1.min(1e300));
    let width = high - low;
    let smallest = 1e-9 * low.abs().max(high.abs());
    if width <= smallest {
        let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
        return (low - half, high + half);
    }
    (low - part * width, high + part * width)
}

/// The attribute for a smaller font when a text does not fit into `room`; empty when it fits.
fn smaller(text: &str, room: f64) -> String {
    let length = text.chars().count() as f64 * CHARACTER;
    if length <= room { String::new() } else { format!(" font-size=\"{:.1}\"", (TEXT * room / length).max(6.0)) }
}

/// Half the size of a cross.
const ARM: f64 = 4.5;

/// Path data of a cross around a point.
fn cross(x: f64, y: f64) -> String {
    let size = 2.0 * ARM;
    format!("M{:.1} {:.1}l{size} {size}m-{size} 0l{size} -{size}", x - ARM, y - ARM)
}

/// Draws one curve, or the crosses of its points.
///
/// The name of the curve is its title, which viewers show under the pointer.
fn curve(out: &mut String, series: &PlotSeries, frame: &PanelFrame) {
    // Crosses are not reduced: each one is a point of its own.
    if series.crosses {
        let finite = series.x.iter().zip(&series.y).filter(|(x, y)| x.is_finite() && y.is_finite());
        let data: String = finite.map(|(&x, &y)| cross(frame.px(x), frame.py(y))).collect();
        let _ = writeln!(
            out,
            "<path stroke=\"{}\" d=\"{data}\"><title>{}</title></path>",
            colour(series.colour),
            escape(&series.name)
        );
        return;
    }
    let points: CurvePoints = if series.held {
        staircase(&series.x, &series.y)
    } else {
        series.x.iter().copied().zip(series.y.iter().copied()).collect()
    };
    let points = decimate(points, 2 * frame.width as usize);
    let dash = if series.dashed { " stroke-dasharray=\"6 4\"" } else { "" };
    let _ = writeln!(
        out,
        "<path stroke=\"{}\"{dash} d=\"{}\"><title>{}</title></path>",
        colour(series.colour),
        path(&points, frame),
        escape(&series.name)
    );
}

/// Path data through the points. A gap interrupts the line.
///
/// Points that are not finite are gaps.
fn path(points: &[(f64, f64)], frame: &PanelFrame) -> String {
    let mut data = String::new();
    let mut pen = 'M';
    for &(x, y) in points {
        if !x.is_finite() || !y.is_finite() {
            pen = 'M';
            continue;
        }
        // Viewers fail at huge coordinates; what lies that far outside is clipped anyway.
        let _ = write!(data, "{pen}{:.1} {:.1}", frame.px(x), frame.py(y).clamp(-1e5, 1e5));
        pen = 'L';
    }
    data
}

#[cfg(test)]
mod tests {
    use super::super::figure::{FigurePanel, PlotBand, PlotSeries};
    use super::*;

    /// Two panels, one of them with words.
    pub(crate) fn sample() -> Figure {
        let x: Vec<f64> = (0..=20).map(|i| f64::from(i) * 0.1).collect();
        let y: Vec<f64> = x.iter().map(|x| 150.0 + 60.0 * (3.0 * x).sin()).collect();
        let pressure = PlotSeries { name: "pump.b.p".into(), x: x.clone(), y: y.clone(), ..PlotSeries::default() };
        let band = PlotBand {
            x: x.clone(),
            low: y.iter().map(|v| v - 5.0).collect(),
            high: y.iter().map(|v| v + 5.0).collect(),
            colour: 0,
        };
        let mode = PlotSeries {
            name: "valve<mode>".into(),
            x: vec![0.0, 0.7, 2.0],
            y: vec![0.0, 1.0, 1.0],
            held: true,
            ..PlotSeries::default()
        };
        let first = FigurePanel {
            x_label: "time in s".into(),
            y_label: "pressure in bar".into(),
            series: vec![pressure],
            bands: vec![band],
            ..FigurePanel::default()
        };
        let second = FigurePanel {
            x_label: "time in s".into(),
            y_label: String::new(),
            words: vec!["closed".into(), "open".into()],
            series: vec![mode],
            ..FigurePanel::default()
        };
        Figure { title: "Relief & pump".into(), panels: vec![first, second], shared_x: true }
    }

    #[test]
    fn structure_of_a_picture() {
        insta::assert_snapshot!(write(&sample()));
    }

    #[test]
    fn empty_constant_and_infinite_curves_are_drawn() {
        for y in [vec![], vec![5.0; 3], vec![f64::NAN, f64::INFINITY, 1.0], vec![0.0, -1e308, 1e308]] {
            let x = (0..y.len()).map(|i| i as f64).collect();
            let series = vec![PlotSeries { name: "a".into(), x, y, ..PlotSeries::default() }];
            let figure = Figure {
                panels: vec![FigurePanel { series, ..FigurePanel::default() }],
                shared_x: true,
                ..Figure::default()
            };
            let text = write(&figure);
            assert!(text.starts_with("<svg") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}
