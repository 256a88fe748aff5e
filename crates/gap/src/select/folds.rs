//! Left-out data: each piece of the train recordings, and each recording, is simulated with parameters that it had no
//! part in. These are one Gauss-Newton step away from the fit to all data.

use super::super::data::RecordingData;
use super::super::estimate::ModelFit;
use super::super::estimate::candidate::{RecordingResiduals, piece};
use super::super::policy::{BLOCKS, DAMPINGS, PIECES, SETTLED, WHOLE_RECORDINGS};
use std::ops::Range;

/// Left-out errors, and their mean squares.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutErrors {
    /// Per block and signal the mean square; infinite where the simulation did not get there.
    pub squares: Vec<Vec<f64>>,
    /// Per block and signal the number of samples.
    pub samples: Vec<Vec<f64>>,
    /// The errors themselves, by recording.
    pub errors: Vec<RecordingResiduals>,
    /// Per fold how much the step that left it out was damped; nothing where the fit to all data stands. Empty where there are
    /// no folds.
    pub dampings: Vec<Option<f64>>,
}

impl LeftOutErrors {
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

/// Blocks of about equal length in each of some recordings, given by their samples.
pub fn blocks(lengths: &[usize]) -> impl Iterator<Item = impl Iterator<Item = Range<usize>>> {
    let long = (lengths.iter().sum::<usize>() / BLOCKS).max(1);
    lengths.iter().map(move |&length| {
        let blocks = ((length as f64 / long as f64).round() as usize).max(2);
        (0..blocks).map(move |b| b * length / blocks..(b + 1) * length / blocks)
    })
}

/// A way of leaving out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldScheme {
    /// Pieces, so that every operating point stays represented.
    Pieces,
    /// Whole recordings.
    Recordings,
}

impl FoldScheme {
    /// The fold of a piece of a recording: pieces go through the recordings, so that no fold is of one time only.
    pub fn fold(self, recording: usize, piece: usize) -> usize {
        match self {
            FoldScheme::Pieces => (piece + recording) % PIECES,
            FoldScheme::Recordings => recording,
        }
    }

    /// How many folds there are of so many recordings.
    pub fn folds(self, recordings: usize) -> usize {
        match self {
            FoldScheme::Pieces => PIECES,
            FoldScheme::Recordings => recordings,
        }
    }
}

/// The ways of leaving out of so many recordings: as a whole only where there are enough of them.
pub fn schemes(recordings: usize) -> Vec<FoldScheme> {
    let whole = (recordings >= WHOLE_RECORDINGS).then_some(FoldScheme::Recordings);
    [FoldScheme::Pieces].into_iter().chain(whole).collect()
}

/// What a fit leaves of left-out data, by every scheme.
pub fn left_out(fit: &ModelFit, train: &[RecordingData]) -> Vec<LeftOutErrors> {
    schemes(train.len()).into_iter().map(|scheme| by_scheme(fit, train, scheme)).collect()
}

fn by_scheme(fit: &ModelFit, train: &[RecordingData], scheme: FoldScheme) -> LeftOutErrors {
    let folds = scheme.folds(train.len());
    // a run without slopes takes other steps than one with them: only runs of one kind are compared
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

/// Where no simulation gets there.
fn infinite(errors: &[RecordingResiduals]) -> Vec<RecordingResiduals> {
    let one = |e: &f64| if e.is_nan() { f64::NAN } else { f64::INFINITY };
    let of_recording = |e: &RecordingResiduals| e.iter().map(|signal| signal.iter().map(one).collect()).collect();
    errors.iter().map(of_recording).collect()
}

/// One fold that is left out of a fit.
struct CrossValidationFold<'a> {
    fit: &'a ModelFit,
    /// What the fit to all data leaves.
    complete: &'a [RecordingResiduals],
    train: &'a [RecordingData],
    scheme: FoldScheme,
    k: usize,
}

impl CrossValidationFold<'_> {
    /// Whether a sample of a recording is left out.
    fn out(&self, number: usize, sample: usize, samples: usize) -> bool {
        self.scheme.fold(number, piece(sample, samples)) == self.k
    }

    /// Errors of all recordings with parameters that were fitted without the fold: where the kept data cost least, of the
    /// Gauss-Newton steps from the fit to all data, more and more damped until the kept data cost as little as the linear
    /// model promised. A step that leads onto a plateau costs little, but more than a shorter one; one that is cut off at bounds
    /// may promise that they cost more. Beside them the damping; nothing where the fit to all data stands.
    fn found(&self) -> (Vec<RecordingResiduals>, Option<f64>) {
        let ModelFit { candidate, x: from, .. } = self.fit;
        let system = self.fit.system(|recording, piece| self.scheme.fold(recording, piece) != self.k);
        let before = self.kept(self.complete) + candidate.prior(from);
        // the fit to all data has seen the fold: it stands only where every step costs more
        let (mut least, mut found) = (before + SETTLED, (self.complete.to_vec(), None));
        for damping in DAMPINGS {
            let x = system.step(&candidate.coordinates, from, damping);
            let Some(errors) = candidate.all_errors(&x, self.train) else { continue };
            let cost = self.kept(&errors) + candidate.prior(&x);
            if cost < least {
                (least, found) = (cost, (errors, Some(damping)));
            }
            let promised = system.promised(from, &x);
            if promised >= -SETTLED && cost <= before - promised + SETTLED {
                break;
            }
        }
        found
    }

    /// Weighed squares of what is not left out.
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
