//! Frequency responses of a linear model, Bode diagrams and pole maps.
//!
//! A [`StateSpace`] and its [`Pole`]s enter; complex matrices or [`Figure`]s leave, for `--bode` and `--poles`.

use super::{Pole, StateSpace};
use bramah_plot::{Figure, FigurePanel, PlotSeries};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::{PI, TAU};

/// The frequency response D + C (j omega - A)^-1 B at a frequency in Hz, p by m; `None` at an undamped pole.
pub fn response(model: &StateSpace, frequency: f64) -> Option<DMatrix<Complex<f64>>> {
    let n = model.states.len();
    let size = |i: usize| model.states[i].nominal;
    let complex = |v: f64| Complex::new(v, 0.0);
    // States are scaled by their nominal values, so that the matrix is well conditioned whatever their units.
    let mut inner = DMatrix::from_fn(n, n, |i, j| complex(-model.a[(i, j)] * size(j) / size(i)));
    (0..n).for_each(|i| inner[(i, i)] += Complex::new(0.0, TAU * frequency));
    let b = DMatrix::from_fn(n, model.inputs.len(), |i, j| complex(model.b[(i, j)] / size(i)));
    let c = DMatrix::from_fn(model.outputs.len(), n, |i, j| complex(model.c[(i, j)] * size(j)));
    let d = model.d.map(complex);
    if n == 0 {
        return Some(d);
    }
    Some(d + c * inner.lu().solve(&b)?)
}

/// Points of a Bode curve.
const POINTS: u32 = 400;
/// Largest number of decades drawn.
const DECADES: f64 = 6.0;

/// Frequencies in Hz that span all poles, a decade beyond them on both sides, at equal distances of their logarithms.
fn frequencies(poles: &[Pole]) -> Vec<f64> {
    // Poles at zero have no place on a logarithmic axis.
    let known = || poles.iter().map(|p| p.frequency).filter(|f| *f > 1e-6);
    let low = known().fold(f64::INFINITY, f64::min);
    let high = known().fold(0.0, f64::max);
    // Without a pole there is no scale; four decades around 1 Hz are drawn.
    let (low, high) = if high > 0.0 { (low / 10.0, high * 10.0) } else { (0.01, 100.0) };
    let low = low.max(high / 10f64.powf(DECADES));
    (0..POINTS).map(|k| low * (high / low).powf(f64::from(k) / f64::from(POINTS - 1))).collect()
}

/// The Bode diagram: magnitude in dB and phase in degrees, one curve for each pair of input and output.
pub fn bode(model: &StateSpace, poles: &[Pole]) -> Figure {
    let frequencies = frequencies(poles);
    let x: Vec<f64> = frequencies.iter().map(|f| f.log10()).collect();
    let responses: Vec<Option<DMatrix<Complex<f64>>>> = frequencies.iter().map(|&f| response(model, f)).collect();
    let (mut magnitudes, mut phases) = (Vec::new(), Vec::new());
    for (i, output) in model.outputs.iter().enumerate() {
        for (j, input) in model.inputs.iter().enumerate() {
            let values: Vec<Option<Complex<f64>>> = responses.iter().map(|r| r.as_ref().map(|r| r[(i, j)])).collect();
            let name = format!("{} / {}", output.name, input.name);
            let curve = |y: Vec<f64>| PlotSeries {
                name: name.clone(),
                x: x.clone(),
                y,
                colour: magnitudes.len(),
                ..PlotSeries::default()
            };
            let decibel = |v: &Option<Complex<f64>>| v.map_or(f64::NAN, |v| 20.0 * v.norm().log10());
            let magnitude = curve(values.iter().map(decibel).collect());
            phases.push(curve(unwrapped(&values)));
            magnitudes.push(magnitude);
        }
    }
    let panel = |y_label: &str, series| FigurePanel {
        x_label: "log10 of the frequency in Hz".to_owned(),
        y_label: y_label.to_owned(),
        series,
        ..FigurePanel::default()
    };
    Figure {
        title: format!("{} at {} s", model.class, bramah_results::number::rounded(model.time, 6)),
        panels: vec![panel("magnitude in dB", magnitudes), panel("phase in deg", phases)],
        shared_x: true,
    }
}

/// Phases in degrees, continuous over the frequency; NaN where the response has no value.
fn unwrapped(values: &[Option<Complex<f64>>]) -> Vec<f64> {
    let mut last: Option<f64> = None;
    let one = |v: &Option<Complex<f64>>| {
        let Some(v) = v.filter(|v| v.norm() > 0.0) else { return f64::NAN };
        let mut phase = v.arg();
        if let Some(last) = last {
            phase += TAU * ((last - phase) / TAU).round();
        }
        last = Some(phase);
        phase * 180.0 / PI
    };
    values.iter().map(one).collect()
}

/// Each further panel of the pole map is smaller by at least this factor.
const CLOSER: f64 = 8.0;
/// Largest number of panels of the pole map.
const PLANES: usize = 4;

/// The pole map. Further panels enlarge the poles that crowd around the origin in the panel before.
pub fn plane(model: &StateSpace, poles: &[Pole]) -> Figure {
    let sizes = || poles.iter().map(|p| p.re.hypot(p.im));
    let mut panels = Vec::new();
    let mut size = sizes().fold(0.0, f64::max);
    loop {
        let near: Vec<&Pole> = poles.iter().filter(|p| p.re.hypot(p.im) <= size).collect();
        panels.push(panel_of_poles(&near, if size > 0.0 { size } else { 1.0 }));
        let next = sizes().filter(|s| *s < size / CLOSER).fold(0.0, f64::max);
        if next == 0.0 || panels.len() == PLANES {
            break;
        }
        size = next;
    }
    Figure { title: format!("Poles of {}", model.class), panels, shared_x: false }
}

/// One panel: poles as crosses, conjugate pairs with both, and the imaginary axis over the height `size` in 1/s.
fn panel_of_poles(poles: &[&Pole], size: f64) -> FigurePanel {
    let mut crosses = PlotSeries { name: "poles".to_owned(), crosses: true, ..PlotSeries::default() };
    for pole in poles {
        crosses.x.push(pole.re);
        crosses.y.push(pole.im);
        if pole.im > 0.0 {
            crosses.x.push(pole.re);
            crosses.y.push(-pole.im);
        }
    }
    let axis = PlotSeries {
        name: "imaginary axis".to_owned(),
        x: vec![0.0, 0.0],
        y: vec![-size, size],
        colour: 6,
        dashed: true,
        ..PlotSeries::default()
    };
    FigurePanel {
        x_label: "real part in 1/s".to_owned(),
        y_label: "imaginary part in 1/s".to_owned(),
        series: vec![crosses, axis],
        ..FigurePanel::default()
    }
}
