//! How large the gap is: simulation from the inputs alone, signal by signal, in parts of the full scale.

use super::data::Recording;
use super::estimate::simulation::Course;
use super::filter::{self, Setting, Tape};
use super::problem::Problem;
use crate::analysis::local::Local;
use rayon::prelude::*;

/// Residuals of one recording behind the window: samples by signals; NaN where nothing was measured.
#[derive(Clone, Debug)]
pub struct Residuals {
    /// Index of the first sample scored.
    pub from: usize,
    /// Simulated signals from there on.
    pub simulated: Vec<Vec<f64>>,
}

impl Residuals {
    /// Measured minus simulated signal at the k-th sample scored; NaN where nothing was measured.
    pub fn error(&self, recording: &Recording, signal: usize, k: usize) -> f64 {
        recording.signals[signal][self.from + k] - self.simulated[signal][k]
    }
}

/// The gap of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gap {
    /// RMS over the signals.
    pub total: f64,
    /// Per signal.
    pub signals: Vec<f64>,
    /// Standard error of the total, from blocks of the recordings.
    pub error: f64,
}

/// A gap of so many times the sensors' noise is one, located or not.
const PLAIN: f64 = 4.0;

impl Gap {
    /// Whether it is so much more than noise that something is missing, be it a better value of a parameter.
    pub fn is_plain(&self, noise: &[f64], full_scale: &[f64]) -> bool {
        let parts: Vec<f64> = noise.iter().zip(full_scale).map(|(n, f)| n / f).collect();
        self.total > PLAIN * rms(&parts)
    }

    /// RMS over the signals of what this gap is more than another: what nothing closes (disturbances that make a signal
    /// drift) does not count.
    pub fn beyond(&self, other: &Gap) -> f64 {
        let more: Vec<f64> =
            self.signals.iter().zip(&other.signals).map(|(a, b)| (a * a - b * b).max(0.0).sqrt()).collect();
        rms(&more)
    }
}

/// Simulates a recording from its inputs; the state at the end of the window comes from the window's samples.
/// `None` when the simulation does not reach the end.
pub fn simulate(setting: &Setting, recording: &Recording) -> Option<Residuals> {
    let from = recording.settled();
    let mut quiet = setting.alone();
    quiet.sources.clear();
    let pass = filter::run(&quiet, recording, 0, from + 1, Tape::Nothing).ok()?;
    let simulated = open_loop(&quiet, recording, from, pass.last)?;
    Some(Residuals { from, simulated })
}

/// Simulates a recording from the model's own start.
pub fn from_start(setting: &Setting, recording: &Recording) -> Option<Vec<Vec<f64>>> {
    let mut u = vec![0.0; recording.inputs.len()];
    recording.input(0, &mut u);
    let local = Local::start(setting.plan.clone(), recording.times[0], &setting.theta, &u).ok()?;
    open_loop(setting, recording, 0, local.state())
}

/// Signals from the inputs, from the state at sample `from`.
fn open_loop(setting: &Setting, recording: &Recording, from: usize, state: Vec<f64>) -> Option<Vec<Vec<f64>>> {
    let mut u = vec![0.0; recording.inputs.len()];
    recording.input(from, &mut u);
    let (theta, sizes) = (&setting.theta, &setting.sizes);
    let mut local = Local::start(setting.plan.clone(), recording.times[0], theta, &u).ok()?;
    let mut simulated = vec![Vec::with_capacity(recording.len() - from); setting.noise.len()];
    let mut course = Course { local: &mut local, theta, sizes, state, slopes: None };
    course.run(recording, from..recording.len(), |_, local, _| {
        simulated.iter_mut().zip(&local.outputs).for_each(|(s, y)| s.push(*y));
    })?;
    Some(simulated)
}

/// Simulates all recordings.
pub fn simulate_all(setting: &Setting, recordings: &[Recording]) -> Vec<Option<Residuals>> {
    recordings.par_iter().enumerate().map(|(i, r)| simulate(&setting.of_recording(i), r)).collect()
}

/// The gap by its definition: per signal sqrt(max(0, mean square - noise variance)) over full scale. A run that does not
/// reach its end counts with a gap of one full scale.
pub fn gap(runs: &[Option<Residuals>], recordings: &[Recording], noise: &[f64], full_scale: &[f64]) -> Gap {
    let signals: Vec<f64> =
        (0..noise.len()).map(|i| signal_gap(runs, recordings, i, noise[i], full_scale[i])).collect();
    let total = rms(&signals);
    Gap { error: standard_error(runs, recordings, full_scale, total), total, signals }
}

/// The gap of a model on these recordings.
pub fn gap_of(problem: &Problem<'_>, setting: &Setting, recordings: &[Recording], noise: &[f64]) -> Gap {
    gap(&simulate_all(setting, recordings), recordings, noise, &problem.full_scale)
}

/// Standard error of the total from the spread of the mean squares of blocks.
fn standard_error(runs: &[Option<Residuals>], recordings: &[Recording], full_scale: &[f64], total: f64) -> f64 {
    let mut blocks = Vec::new();
    for (run, recording) in runs.iter().zip(recordings) {
        let Some(run) = run else { continue };
        let length = (recording.len() - run.from).div_ceil(filter::BLOCKS).max(1);
        for start in (0..recording.len() - run.from).step_by(length) {
            let end = (start + length).min(recording.len() - run.from);
            let square = |i: usize| {
                let pairs = (start..end).map(|k| run.error(recording, i, k) / full_scale[i]);
                let known: Vec<f64> = pairs.filter(|e| e.is_finite()).map(|e| e * e).collect();
                known.iter().sum::<f64>() / known.len().max(1) as f64
            };
            blocks.push((0..full_scale.len()).map(square).sum::<f64>() / full_scale.len().max(1) as f64);
        }
    }
    let n = blocks.len() as f64;
    if n < 2.0 || total <= 0.0 {
        return 0.0;
    }
    let mean = blocks.iter().sum::<f64>() / n;
    let variance = blocks.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (variance / n).sqrt() / (2.0 * total)
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

fn signal_gap(runs: &[Option<Residuals>], recordings: &[Recording], i: usize, noise: f64, full_scale: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (run, recording) in runs.iter().zip(recordings) {
        let Some(run) = run else {
            let samples = recording.signals[i].iter().filter(|v| v.is_finite()).count() as f64;
            sum += samples * full_scale * full_scale;
            count += samples;
            continue;
        };
        for (y, simulated) in recording.signals[i][run.from..].iter().zip(&run.simulated[i]).skip(1) {
            if y.is_finite() {
                sum += (y - simulated).powi(2);
                count += 1.0;
            }
        }
    }
    if count == 0.0 || full_scale <= 0.0 { 0.0 } else { (sum / count - noise * noise).max(0.0).sqrt() / full_scale }
}
