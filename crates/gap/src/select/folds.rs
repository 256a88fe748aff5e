//! Cross-validation of a fit: residuals of data that took no part in it.
//!
//! The parameters for each fold are a Gauss-Newton step away from the fit to all data, so that a fold costs a few
//! simulations instead of a fit. The normal equations without the fold follow from the sums that the fit keeps by
//! piece. Enters: a [`ModelFit`]. Leaves: [`LeftOutErrors`] per scheme, which every comparison of models uses. Method:
//! `docs/gap_method.md`, "Left-out data".

use super::super::data::RecordingData;
use super::super::estimate::ModelFit;
use super::super::estimate::candidate::{RecordingResiduals, piece};
use crate::policy::{BLOCKS, DAMPINGS, PIECES, SETTLED, WHOLE_RECORDINGS};
use std::ops::Range;

/// Left-out errors of a model with their mean squares by block.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutErrors {
    /// Mean square per block and signal, SI squared; infinite where the simulation stopped before.
    pub squares: Vec<Vec<f64>>,
    /// Number of samples per block and signal.
    pub samples: Vec<Vec<f64>>,
    /// The errors themselves, per recording, SI.
    pub errors: Vec<RecordingResiduals>,
    /// Per fold the damping of the step that left it out; `None` where the fit to all data stands. Empty without folds.
    pub dampings: Vec<Option<f64>>,
}

impl LeftOutErrors {
    /// Mean square of a signal over all blocks; 0 without samples.
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

    /// Mean squares of errors over blocks of about equal length. There are no folds.
    pub fn of(errors: Vec<RecordingResiduals>) -> Self {
        let lengths: Vec<usize> = errors.iter().map(|e| e.first().map_or(0, Vec::len)).collect();
        let mut left =
            LeftOutErrors { squares: Vec::new(), samples: Vec::new(), errors: Vec::new(), dampings: Vec::new() };
        for (e, blocks) in errors.iter().zip(blocks(&lengths)) {
            for range in blocks {
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
        left.errors = errors;
        left
    }
}

/// Ranges of samples of the blocks, per recording: about [`BLOCKS`] in all, at least two in a recording.
/// `lengths`: samples of each recording.
pub fn blocks(lengths: &[usize]) -> impl Iterator<Item = impl Iterator<Item = Range<usize>>> {
    // blocks are equally long over all recordings, so that each counts alike
    let long = (lengths.iter().sum::<usize>() / BLOCKS).max(1);
    lengths.iter().map(move |&length| {
        let blocks = ((length as f64 / long as f64).round() as usize).max(2);
        (0..blocks).map(move |b| b * length / blocks..(b + 1) * length / blocks)
    })
}

/// A scheme of leaving data out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldScheme {
    /// One piece of each recording at a time, so that every operating point stays represented.
    Pieces,
    /// One complete recording at a time.
    Recordings,
}

impl FoldScheme {
    /// The fold of a piece of a recording. Folds are shifted from recording to recording, so that none is of one time
    /// only.
    pub fn fold(self, recording: usize, piece: usize) -> usize {
        match self {
            FoldScheme::Pieces => (piece + recording) % PIECES,
            FoldScheme::Recordings => recording,
        }
    }

    /// Number of folds for so many recordings.
    pub fn folds(self, recordings: usize) -> usize {
        match self {
            FoldScheme::Pieces => PIECES,
            FoldScheme::Recordings => recordings,
        }
    }
}

/// Schemes for so many recordings: complete recordings only if there are at least [`WHOLE_RECORDINGS`].
pub fn schemes(recordings: usize) -> Vec<FoldScheme> {
    let whole = (recordings >= WHOLE_RECORDINGS).then_some(FoldScheme::Recordings);
    [FoldScheme::Pieces].into_iter().chain(whole).collect()
}

/// Left-out errors of a fit by every scheme.
pub fn left_out(fit: &ModelFit, train: &[RecordingData]) -> Vec<LeftOutErrors> {
    schemes(train.len()).into_iter().map(|scheme| by_scheme(fit, train, scheme)).collect()
}

/// Left-out errors of a fit by one scheme.
fn by_scheme(fit: &ModelFit, train: &[RecordingData], scheme: FoldScheme) -> LeftOutErrors {
    let folds = scheme.folds(train.len());
    // A run without sensitivities takes other steps than one with them, so only runs of one kind are compared.
    let Some(complete) = fit.candidate.all_errors(&fit.x, train) else {
        return LeftOutErrors { dampings: vec![None; folds], ..LeftOutErrors::of(infinite(&fit.evaluated.errors)) };
    };
    let mut all = complete.clone();
    let mut dampings = Vec::new();
    for k in 0..folds {
        let fold = CrossValidationFold { fit, complete: &complete, train, scheme, k };
        let (found, damping) = fold.found();
        dampings.push(damping);
        for (number, own) in all.iter_mut().enumerate() {
            let samples = own.first().map_or(0, Vec::len);
            for (i, signal) in own.iter_mut().enumerate() {
                for (s, e) in
                    signal.iter_mut().enumerate().filter(|(s, e)| fold.out(number, *s, samples) && !e.is_nan())
                {
                    *e = found[number][i][s];
                }
            }
        }
    }
    LeftOutErrors { dampings, ..LeftOutErrors::of(all) }
}

/// Errors of a model whose simulation stops early: infinite at every measured sample.
fn infinite(errors: &[RecordingResiduals]) -> Vec<RecordingResiduals> {
    let one = |e: &f64| if e.is_nan() { f64::NAN } else { f64::INFINITY };
    let of_recording = |e: &RecordingResiduals| e.iter().map(|signal| signal.iter().map(one).collect()).collect();
    errors.iter().map(of_recording).collect()
}

/// One fold that is left out of a fit.
struct CrossValidationFold<'a> {
    /// The fit to all data.
    fit: &'a ModelFit,
    /// Errors of the fit to all data, per recording.
    complete: &'a [RecordingResiduals],
    /// The train recordings.
    train: &'a [RecordingData],
    /// How data are left out.
    scheme: FoldScheme,
    /// Number of the fold.
    k: usize,
}

impl CrossValidationFold<'_> {
    /// Whether a sample of a recording is left out.
    fn out(&self, number: usize, sample: usize, samples: usize) -> bool {
        self.scheme.fold(number, piece(sample, samples)) == self.k
    }

    /// Errors of all recordings with parameters fitted without the fold, and the damping of the step to them.
    ///
    /// Gauss-Newton steps are tried with more and more damping, until the kept data cost as little as the linear model
    /// promises. Of the steps tried, the one at which the kept data cost least counts. A step onto a plateau costs
    /// little, but more than a shorter one; a step that bounds cut off may even promise a loss, and is damped too. The
    /// damping is `None` where the fit to all data stands.
    fn found(&self) -> (Vec<RecordingResiduals>, Option<f64>) {
        let ModelFit { candidate, x: from, .. } = self.fit;
        let system = self.fit.system(|recording, piece| self.scheme.fold(recording, piece) != self.k);
        let before = self.kept(self.complete) + candidate.prior(from);
        // the fit to all data has used the fold, so it counts only if every step costs more than it
        let (mut least, mut found) = (before + SETTLED, (self.complete.to_vec(), None));
        for damping in DAMPINGS {
            let x = system.step(&candidate.coordinates, from, damping);
            let Some(errors) = candidate.all_errors(&x, self.train) else { continue };
            let cost = self.kept(&errors) + candidate.prior(&x);
            if cost < least {
                (least, found) = (cost, (errors, Some(damping)));
            }
            let promised = system.promised(from, &x);
            // the damping ends where the step keeps the promise of the linear model
            if promised >= -SETTLED && cost <= before - promised + SETTLED {
                break;
            }
        }
        found
    }

    /// Weighted squares of the data that are not left out.
    fn kept(&self, errors: &[RecordingResiduals]) -> f64 {
        let mut sum = 0.0;
        for (number, own) in errors.iter().enumerate() {
            let samples = own.first().map_or(0, Vec::len);
            for (i, signal) in own.iter().enumerate() {
                let kept = signal.iter().enumerate().filter(|(s, v)| v.is_finite() && !self.out(number, *s, samples));
                sum += self.fit.weights.weight(i) * kept.map(|(_, v)| v * v).sum::<f64>();
            }
        }
        sum
    }
}
