//! Left-out data: each piece of the train recordings, and each recording, is simulated with parameters that it had no
//! part in. These are one Gauss-Newton step away from the fit to all data.

use super::super::data::Recording;
use super::super::estimate::Fit;
use super::super::estimate::candidate::{Errors, piece};
use super::super::policy::{BLOCKS, PIECES, WHOLE_RECORDINGS};

/// Mean squares of left-out errors.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Per block and signal the mean square; infinite where the simulation did not get there.
    pub squares: Vec<Vec<f64>>,
    /// Per block and signal the number of samples.
    pub samples: Vec<Vec<f64>>,
}

impl LeftOut {
    /// Mean square of a signal over all blocks.
    pub fn mean(&self, signal: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (squares, samples) in self.squares.iter().zip(&self.samples) {
            if samples[signal] > 0.0 {
                sum += squares[signal] * samples[signal];
                count += samples[signal];
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Errors of recordings, cut into blocks of about equal length.
    pub fn of(errors: &[Errors]) -> Self {
        let length = |e: &Errors| e.first().map_or(0, Vec::len);
        let all: usize = errors.iter().map(length).sum();
        let long = (all / BLOCKS).max(1);
        let mut left = LeftOut { squares: Vec::new(), samples: Vec::new() };
        for e in errors {
            let blocks = ((length(e) as f64 / long as f64).round() as usize).max(2);
            for b in 0..blocks {
                let range = b * length(e) / blocks..(b + 1) * length(e) / blocks;
                let one = |signal: &Vec<f64>| {
                    let known = || signal[range.clone()].iter().filter(|v| !v.is_nan());
                    let samples = known().count() as f64;
                    (known().map(|v| v * v).sum::<f64>() / samples.max(1.0), samples)
                };
                let (squares, samples) = e.iter().map(one).unzip();
                left.squares.push(squares);
                left.samples.push(samples);
            }
        }
        left
    }
}

/// The ways of leaving out: pieces, so that every operating point stays represented; and recordings where there are
/// enough of them.
pub fn schemes(train: &[Recording]) -> usize {
    1 + usize::from(train.len() >= WHOLE_RECORDINGS)
}

/// The fold of a piece of a recording by a scheme: pieces go through the recordings, so that no fold is of one time only.
fn fold(scheme: usize, recording: usize, piece: usize) -> usize {
    if scheme == 0 { (piece + recording) % PIECES } else { recording }
}

/// What a fit leaves of left-out data, by every scheme.
pub fn left_out(fit: &Fit, train: &[Recording]) -> Vec<LeftOut> {
    (0..schemes(train)).map(|scheme| LeftOut::of(&errors(fit, train, scheme))).collect()
}

fn errors(fit: &Fit, train: &[Recording], scheme: usize) -> Vec<Errors> {
    let mut all = fit.evaluated.errors.clone();
    let folds = if scheme == 0 { PIECES } else { train.len() };
    for k in 0..folds {
        let system = fit.system(|recording, piece| fold(scheme, recording, piece) != k);
        let x = system.step(&fit.candidate.coordinates, &fit.x, 0.0);
        for (number, (own, recording)) in all.iter_mut().zip(train).enumerate() {
            if scheme == 1 && number != k {
                continue;
            }
            let samples = own.first().map_or(0, Vec::len);
            let out = |s: usize| fold(scheme, number, piece(s, samples)) == k;
            let Some(last) = (0..samples).rev().find(|s| out(*s)) else { continue };
            let found = fit.candidate.errors_to(&x, recording, Some(number), recording.len() - samples + last + 1);
            for (i, signal) in own.iter_mut().enumerate() {
                for (s, e) in signal.iter_mut().enumerate().filter(|(s, e)| out(*s) && !e.is_nan()) {
                    *e = found.as_ref().map_or(f64::INFINITY, |f| f[i][s]);
                }
            }
        }
    }
    all
}
