//! Figures of the gap: root mean squares of measured minus simulated. No noise is subtracted.
//!
//! Enters: residuals of models on recordings. Leaves: the `gap` and `open` parts of the verdict. Called by
//! `verdict::conclude`.

use super::data::RecordingData;
use super::estimate::candidate::RecordingResiduals;
use super::hypotheses::SensorSignal;
use super::problem::DiagnosisProblem;
use super::verdict::{ModelGaps, OpenGap, OptionalNumber, RoleGaps, SignalGap};
use std::collections::BTreeMap;

/// A gap within so many standard deviations of the sensor's noise is closed: hardly any sample of a correct model lies
/// further off.
const CLOSED_NOISE: f64 = 3.0;
/// A gap within this part of the signal's range is closed: the class of a good sensor.
const CLOSED_RANGE: f64 = 2.5e-3;

/// Squared residuals of one model on some recordings.
pub struct GapFigures {
    /// Per recording and signal the sum of squares and the number of samples, SI; `None` where the simulation stops
    /// early.
    recordings: Vec<Option<Vec<(f64, f64)>>>,
}

impl GapFigures {
    /// From the residuals of a model, one entry per recording.
    pub fn of(errors: &[Option<RecordingResiduals>]) -> Self {
        let signal = |e: &Vec<f64>| {
            let known = e.iter().filter(|v| !v.is_nan());
            known.fold((0.0, 0.0), |(sum, n), e| (sum + e * e, n + 1.0))
        };
        GapFigures { recordings: errors.iter().map(|e| Some(e.as_ref()?.iter().map(signal).collect())).collect() }
    }

    /// RMS of a signal over all recordings, SI; `None` if a simulation stops early or nothing was measured.
    pub fn signal(&self, i: usize) -> OptionalNumber {
        let mut all = (0.0, 0.0);
        for r in &self.recordings {
            let (sum, n) = r.as_ref()?[i];
            all = (all.0 + sum, all.1 + n);
        }
        (all.1 > 0.0).then(|| (all.0 / all.1).sqrt())
    }

    /// RMS over the signals of their parts of full scale; signals without samples do not count.
    /// `None` if a simulation stops early or nothing was measured.
    pub fn total(&self, full_scale: &[f64]) -> OptionalNumber {
        if self.recordings.iter().any(Option::is_none) {
            return None;
        }
        let parts: Vec<f64> =
            full_scale.iter().enumerate().filter_map(|(i, f)| Some((self.signal(i)? / f).powi(2))).collect();
        (!parts.is_empty()).then(|| (parts.iter().sum::<f64>() / parts.len() as f64).sqrt())
    }

    /// Number of recordings in which a signal's RMS exceeds a bound, SI, or the simulation stops early.
    fn wider(&self, i: usize, bound: f64) -> usize {
        let wide = |r: &&Option<Vec<(f64, f64)>>| match r {
            Some(signals) => signals[i].1 > 0.0 && (signals[i].0 / signals[i].1).sqrt() > bound,
            None => true,
        };
        self.recordings.iter().filter(wide).count()
    }
}

/// Signals at which a model leaves an open gap, the largest part of the range first.
pub fn open(problem: &DiagnosisProblem<'_>, left: &GapFigures, recordings: &[RecordingData]) -> Vec<OpenGap> {
    let stops = left.recordings.iter().any(Option::is_none);
    let gap = |(i, signal): (usize, &SensorSignal)| {
        let (rms, range, shown) = (left.signal(i), range(recordings, i), &problem.shown[i]);
        let bound = (CLOSED_NOISE * problem.noise_floor[i]).max(CLOSED_RANGE * range);
        // a simulation that stops early leaves every signal open
        let wide = rms.map_or(stops, |rms| rms > bound);
        wide.then(|| OpenGap {
            signal: signal.name.clone(),
            rms: rms.map(|rms| shown.value(rms)),
            of_range: rms.map(|rms| rms / range),
            unit: shown.unit.clone(),
            recordings: (left.wider(i, bound), recordings.len()),
        })
    };
    let mut found: Vec<OpenGap> = problem.signals.iter().enumerate().filter_map(gap).collect();
    let share = |o: &OpenGap| o.of_range.unwrap_or(f64::INFINITY);
    found.sort_by(|a, b| share(b).total_cmp(&share(a)));
    found
}

/// Range of a signal over recordings, SI; its absolute value where it stands still. Never 0.
fn range(recordings: &[RecordingData], i: usize) -> f64 {
    let values = || recordings.iter().flat_map(|r| r.signals[i].iter().copied()).filter(|v| !v.is_nan());
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if high > low { high - low } else { high.abs().max(f64::MIN_POSITIVE) }
}

/// Figures of three models (nominal, within tolerances, with effects) on recordings of one role.
pub fn side(problem: &DiagnosisProblem<'_>, models: [&GapFigures; 3], recordings: &[RecordingData]) -> RoleGaps {
    let columns = |of: &dyn Fn(&GapFigures) -> OptionalNumber| {
        let [nominal, tolerances, effects] = models.map(of);
        ModelGaps { nominal, tolerances, effects }
    };
    let signal = |i: usize| {
        let (scale, range) = (problem.full_scale[i], range(recordings, i));
        let shown = &problem.shown[i];
        SignalGap {
            of_full_scale: columns(&|l| Some(l.signal(i)? / scale)),
            of_range: columns(&|l| Some(l.signal(i)? / range)),
            rms: columns(&|l| Some(shown.value(l.signal(i)?))),
            unit: shown.unit.clone(),
            range: shown.value(range),
            noise: shown.value(problem.noise_floor[i]),
        }
    };
    let signals = problem.signals.iter().enumerate().map(|(i, s)| (s.name.clone(), signal(i)));
    RoleGaps { total: columns(&|l| l.total(&problem.full_scale)), signals: signals.collect::<BTreeMap<_, _>>() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_subtracted_and_what_stops_early_has_no_figure() {
        let run = |errors: &[f64]| Some(vec![errors.to_vec()]);
        let left = GapFigures::of(&[run(&[3.0, f64::NAN, 3.0]), run(&[0.0, 0.0, 0.0])]);
        // two errors of 3 and three of 0
        assert!((left.signal(0).unwrap() - (18.0_f64 / 5.0).sqrt()).abs() < 1e-15);
        assert!((left.total(&[2.0]).unwrap() - (18.0_f64 / 5.0).sqrt() / 2.0).abs() < 1e-15);
        assert_eq!(left.wider(0, 1.0), 1);
        let stopped = GapFigures::of(&[run(&[3.0]), None]);
        assert_eq!((stopped.signal(0), stopped.total(&[1.0]), stopped.wider(0, 1.0)), (None, None, 2));
    }
}
