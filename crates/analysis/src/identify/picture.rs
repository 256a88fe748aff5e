//! Figures of an identification for `--plot`: signals, autocorrelations, confidence ellipses and profiles.
//!
//! A [`ParameterFit`] and its profiles enter; a [`Figure`] leaves, which `crates/plot` draws.

use super::chance::{pair_size, student};
use super::{IdentificationProblem, ParameterFit, ProfileLikelihood};
use bramah_plot::{Figure, FigurePanel, PlotBand, PlotSeries};

/// Largest number of parameter pairs drawn, those with the strongest correlations.
const PAIRS: usize = 6;
/// Points of an ellipse.
const POINTS: u32 = 72;

impl ParameterFit {
    /// The edge of the joint 95 % confidence region of the parameters `i` and `j`, in their units.
    ///
    /// It is an ellipse in z, so on a logarithmic scale it is bent. `None` where the data carry no information about
    /// one of them.
    pub fn ellipse(&self, problem: &IdentificationProblem<'_>, i: usize, j: usize) -> Option<(Vec<f64>, Vec<f64>)> {
        let (a, b) = (self.spread[i].sqrt(), self.spread[j].sqrt());
        let r = self.correlation[(i, j)].clamp(-1.0, 1.0);
        if !(a * b).is_finite() || a * b <= 0.0 {
            return None;
        }
        // The Cholesky factor of the correlation matrix maps the unit circle to the ellipse.
        let rest = (1.0 - r * r).sqrt();
        // The smaller degrees of freedom give the larger, cautious region.
        let size = pair_size(self.degrees[i].min(self.degrees[j]));
        let at = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(POINTS)).sin_cos();
            (size * a * cos, size * b * (r * cos + rest * sin))
        };
        let value = |j: usize, move_by: f64| problem.free[j].value(self.z[j] + move_by);
        Some((0..=POINTS).map(at).map(|(x, y)| (value(i, x), value(j, y))).unzip())
    }
}

/// The figure with all panels: signals, autocorrelations, ellipses, profiles.
pub fn picture(problem: &IdentificationProblem<'_>, fit: &ParameterFit, profiles: &[ProfileLikelihood]) -> Figure {
    let mut panels: Vec<FigurePanel> = fit.trajectories.iter().map(trajectory).collect();
    panels.extend(fit.residuals.iter().map(autocorrelation));
    panels.extend(pairs(fit).into_iter().filter_map(|(i, j)| pair(problem, fit, i, j)));
    panels.extend(profiles.iter().map(|p| profile(problem, fit, p)));
    Figure { title: format!("Parameters of {}", problem.model.dae.class), panels, shared_x: false }
}

/// Name and unit of an axis.
fn label(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} in {unit}") }
}

/// The panel of a measured and a modelled signal over time.
fn trajectory(trajectory: &super::SignalTrajectory) -> FigurePanel {
    // Dashes let the measured line show through where the model coincides with it.
    let line = |name: &str, y: Vec<f64>, colour: usize, dashed: bool| PlotSeries {
        name: format!("{} {name}", trajectory.name),
        x: trajectory.times.clone(),
        y,
        colour,
        dashed,
        ..PlotSeries::default()
    };
    let model = trajectory.measured.iter().zip(&trajectory.errors).map(|(m, e)| m + e).collect();
    FigurePanel {
        x_label: "time in s".to_owned(),
        y_label: label(&trajectory.name, &trajectory.unit),
        series: vec![line("measured", trajectory.measured.clone(), 6, false), line("of the model", model, 0, true)],
        ..FigurePanel::default()
    }
}

/// The panel of an autocorrelation over its lags, with the 95 % band of white residuals.
fn autocorrelation(test: &super::ResidualTest) -> FigurePanel {
    let count = test.autocorrelation.len() as f64;
    let mut stems = PlotSeries { name: format!("errors of {}", test.name), ..PlotSeries::default() };
    for (lag, r) in (1..).map(f64::from).zip(&test.autocorrelation) {
        // NaN interrupts the line, so each lag is a vertical stroke of its own.
        stems.x.extend([lag, lag, f64::NAN]);
        stems.y.extend([0.0, *r, f64::NAN]);
    }
    let edge = test.bound();
    FigurePanel {
        x_label: "lag in samples".to_owned(),
        y_label: "autocorrelation".to_owned(),
        series: vec![stems],
        bands: vec![PlotBand { x: vec![0.0, count + 1.0], low: vec![-edge; 2], high: vec![edge; 2], colour: 6 }],
        ..FigurePanel::default()
    }
}

/// The pairs of parameters to draw, strongest correlation first.
fn pairs(fit: &ParameterFit) -> Vec<(usize, usize)> {
    let p = fit.values.len();
    let mut all: Vec<(usize, usize)> = (0..p).flat_map(|i| (i + 1..p).map(move |j| (i, j))).collect();
    all.sort_by(|a, b| fit.correlation[*b].abs().total_cmp(&fit.correlation[*a].abs()).then(a.cmp(b)));
    all.truncate(PAIRS);
    all
}

/// The panel of one confidence ellipse with the estimate in it.
fn pair(problem: &IdentificationProblem<'_>, fit: &ParameterFit, i: usize, j: usize) -> Option<FigurePanel> {
    let (x, y) = fit.ellipse(problem, i, j)?;
    let centre = PlotSeries {
        name: "estimate".to_owned(),
        x: vec![fit.values[i]],
        y: vec![fit.values[j]],
        crosses: true,
        colour: 1,
        ..PlotSeries::default()
    };
    Some(FigurePanel {
        x_label: label(&problem.free[i].name, &problem.free[i].unit),
        y_label: label(&problem.free[j].name, &problem.free[j].unit),
        series: vec![PlotSeries { name: "95 % together".to_owned(), x, y, ..PlotSeries::default() }, centre],
        ..FigurePanel::default()
    })
}

/// The panel of one profile, with the parabola of the standard deviation and the 95 % level.
fn profile(problem: &IdentificationProblem<'_>, fit: &ParameterFit, profile: &ProfileLikelihood) -> FigurePanel {
    let free = &problem.free[profile.parameter];
    let (x, y): (Vec<f64>, Vec<f64>) = profile.points.iter().copied().unzip();
    let ends = [x[0], x[x.len() - 1]];
    let deviation = fit.deviations[profile.parameter];
    let level = student(fit.degrees[profile.parameter]).powi(2);
    let quadratic = x.iter().map(|v| ((v - fit.values[profile.parameter]) / deviation).powi(2)).collect();
    FigurePanel {
        x_label: label(&free.name, &free.unit),
        y_label: "rise".to_owned(),
        series: vec![
            PlotSeries { name: "profile".to_owned(), x: x.clone(), y: y.clone(), ..PlotSeries::default() },
            PlotSeries { name: "searched anew".to_owned(), x: x.clone(), y, crosses: true, ..PlotSeries::default() },
            PlotSeries {
                name: "by the deviation".to_owned(),
                x,
                y: quadratic,
                colour: 6,
                dashed: true,
                ..PlotSeries::default()
            },
            PlotSeries {
                name: "95 %".to_owned(),
                x: ends.to_vec(),
                y: vec![level; 2],
                colour: 1,
                ..PlotSeries::default()
            },
        ],
        ..FigurePanel::default()
    }
}
