//! The history that `delay` reads: the trajectory of every delayed expression, recorded during the run.
//!
//! For the equations a delayed value is an input. No step is longer than the shortest delay, so the trajectory is known
//! wherever a step leads. A jump of a delayed expression at an event becomes a jump of the input one delay later, which
//! is an event then. A kink becomes a time that no step passes. In a retarded equation each passage makes a kink
//! smoother by one derivative. Beyond the order of the integrator it needs no attention. Source: C. T. H. Baker,
//! C. A. H. Paul, D. R. Wille, Adv. Comput. Math. 3 (1995) 171.

use super::modes::same_time;
use crate::lower::ExecutableSystem;
use bramah_expr::ExprId;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Number of values in a piece: at its ends, and at the three extrema of a Chebyshev polynomial between.
///
/// With the length L of the piece, the interpolation error is at most L^5 / 61,000 times the fifth derivative. That is
/// below the error of a step of the integrator.
pub const POINTS: usize = 5;

/// Passages through a delay after which a kink is smoother than the integrator's order can see.
const PASSAGES: u32 = 5;

/// The trajectories over a part of a step.
#[derive(Clone, Debug, PartialEq)]
struct HistoryPiece {
    /// Begin in seconds.
    from: f64,
    /// End in seconds.
    to: f64,
    /// For each delay its values at the times of [`points`].
    values: Vec<[f64; POINTS]>,
}

/// A part of the history without jumps and kinks. It has at least one piece.
#[derive(Clone, Debug, PartialEq)]
struct HistoryStretch {
    /// Begin in seconds.
    since: f64,
    /// Its pieces, one behind the other.
    pieces: VecDeque<HistoryPiece>,
    /// How often the kink at its beginning has passed a delay.
    passages: u32,
    /// For each delay whether its expression jumps at the beginning.
    jumps: Vec<bool>,
}

/// Everything that a run has recorded for its delays. It is a part of its state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DelayHistory {
    /// The stretches in the order of time.
    stretches: VecDeque<HistoryStretch>,
}

/// One `delay` of the model.
#[derive(Clone, Debug)]
struct DelayTrack {
    /// The slot of the delayed value.
    slot: usize,
    /// The expression that is delayed.
    source: ExprId,
    /// The delay time in seconds.
    time: f64,
    /// The stretch that contains the delayed time.
    at: usize,
    /// The largest absolute value so far, by which jumps are judged.
    size: f64,
}

/// All delays of a run with their history.
#[derive(Clone, Debug, Default)]
pub struct DelayBuffers {
    /// The delays, in the order of `Dae::delays`.
    tracks: Vec<DelayTrack>,
    /// The recorded trajectories.
    past: DelayHistory,
    /// The longest delay time in seconds.
    longest: f64,
}

/// The times of the values of a piece between `from` and `to`.
pub fn points(from: f64, to: f64) -> [f64; POINTS] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut times = [1, 2, 3].map(|k| middle - half * (PI * f64::from(k) / 4.0).cos()).to_vec();
    times.insert(0, from);
    times.push(to);
    times.try_into().expect("five")
}

impl HistoryPiece {
    /// A piece of length 0: one value for all times.
    fn point(t: f64, values: &[f64]) -> HistoryPiece {
        HistoryPiece { from: t, to: t, values: values.iter().map(|&v| [v; POINTS]).collect() }
    }

    /// The polynomial through the values, in barycentric form. Outside the piece the value at its end.
    ///
    /// The weights of these points alternate in sign and are half at the ends.
    fn value(&self, delay: usize, t: f64) -> f64 {
        let values = &self.values[delay];
        if t <= self.from || t >= self.to {
            return if t >= self.to { values[POINTS - 1] } else { values[0] };
        }
        let (mut above, mut below) = (0.0, 0.0);
        for (k, (&at, &value)) in points(self.from, self.to).iter().zip(values).enumerate() {
            if t == at {
                return value;
            }
            let end = if k == 0 || k + 1 == POINTS { 0.5 } else { 1.0 };
            let weight = end * if k % 2 == 0 { 1.0 } else { -1.0 } / (t - at);
            above += weight * value;
            below += weight;
        }
        above / below
    }
}

impl HistoryStretch {
    /// The value of a delay at time `t`.
    fn value(&self, delay: usize, t: f64) -> f64 {
        let i = self.pieces.partition_point(|p| p.to < t).min(self.pieces.len() - 1);
        self.pieces[i].value(delay, t)
    }
}

impl DelayBuffers {
    /// The delays of a system whose parameters are known.
    ///
    /// `Err` where a delay time is not positive: index and time of that delay.
    pub fn new(system: &ExecutableSystem, values: &[f64], past: DelayHistory) -> Result<DelayBuffers, (usize, f64)> {
        let track = |(i, delay): (usize, &bramah_model::structure::DelayInput)| {
            let time = system.eval(delay.time, values);
            let slot = system.layout.var(delay.variable);
            let track = DelayTrack { slot, source: delay.source, time, at: 0, size: 0.0 };
            if time.is_finite() && time > 0.0 { Ok(track) } else { Err((i, time)) }
        };
        let tracks: Vec<DelayTrack> = system.dae.delays.iter().enumerate().map(track).collect::<Result<_, _>>()?;
        let longest = tracks.iter().map(|t| t.time).fold(0.0, f64::max);
        Ok(DelayBuffers { tracks, past, longest })
    }

    /// Whether the model has no delays.
    pub fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }

    /// The longest step for which all delayed values are recorded, in seconds: the shortest delay time.
    pub fn longest_step(&self) -> f64 {
        self.tracks.iter().map(|t| t.time).fold(f64::INFINITY, f64::min)
    }

    /// The recorded history.
    pub fn past(&self) -> &DelayHistory {
        &self.past
    }

    /// The end of the recorded history in seconds; `None` without delays.
    pub fn known_to(&self) -> Option<f64> {
        self.past.stretches.back().and_then(|s| s.pieces.back()).map(|p| p.to)
    }

    /// The delayed expressions, evaluated from the slots.
    pub fn sources(&self, system: &ExecutableSystem, values: &[f64]) -> Vec<f64> {
        self.tracks.iter().map(|track| system.eval(track.source, values)).collect()
    }

    /// At the start of a run, sets every delayed value to the present value of its expression.
    ///
    /// True when that changed a value.
    pub fn start(&mut self, system: &ExecutableSystem, t: f64, values: &mut [f64]) -> bool {
        let mut changed = false;
        let mut sources = Vec::new();
        for track in &mut self.tracks {
            // of other delays it reads earlier ones only
            let value = system.eval(track.source, values);
            changed |= values[track.slot] != value;
            values[track.slot] = value;
            track.size = value.abs();
            sources.push(value);
        }
        self.past.stretches.clear();
        if !self.tracks.is_empty() {
            self.open(t, &sources, 0, vec![false; sources.len()]);
        }
        changed
    }

    /// Starts a new stretch at `t`.
    fn open(&mut self, t: f64, values: &[f64], passages: u32, jumps: Vec<bool>) {
        let pieces = VecDeque::from([HistoryPiece::point(t, values)]);
        self.past.stretches.push_back(HistoryStretch { since: t, pieces, passages, jumps });
    }

    /// Appends a piece between two times; `rows` holds the values of all delays at [`points`].
    pub fn remember(&mut self, from: f64, to: f64, rows: &[Vec<f64>]) {
        let trajectory = |k: usize| std::array::from_fn(|i| rows[i][k]);
        let values: Vec<[f64; POINTS]> = (0..self.tracks.len()).map(trajectory).collect();
        for (track, values) in self.tracks.iter_mut().zip(&values) {
            track.size = values.iter().fold(track.size, |size, v| size.max(v.abs()));
        }
        if let Some(last) = self.past.stretches.back_mut() {
            last.pieces.push_back(HistoryPiece { from, to, values });
        }
        self.forget(to - self.longest);
    }

    /// Drops pieces that no delay reads any more.
    fn forget(&mut self, before: f64) {
        while let Some(first) = self.past.stretches.front_mut() {
            while first.pieces.len() > 1 && first.pieces[0].to < before {
                first.pieces.pop_front();
            }
            // a delay still reads the first stretch
            if self.tracks.iter().any(|t| t.at == 0) {
                return;
            }
            self.past.stretches.pop_front();
            self.tracks.iter_mut().for_each(|t| t.at -= 1);
        }
    }

    /// Records an event at `t` that took the delayed expressions from `before` to `after`.
    ///
    /// Jumps below the tolerance do not count as jumps.
    pub fn event(&mut self, t: f64, before: &[f64], after: &[f64], tolerance: f64) {
        let jumps = |((track, a), b): ((&DelayTrack, &f64), &f64)| (a - b).abs() > tolerance * track.size.max(b.abs());
        let jumps = self.tracks.iter().zip(before).zip(after).map(jumps).collect();
        self.open(t, after, 0, jumps);
    }

    /// Moves to time `t` and sets the values that hold just after it.
    pub fn seek(&mut self, t: f64, values: &mut [f64]) {
        let stretches = &self.past.stretches;
        for track in &mut self.tracks {
            let begun = |s: &HistoryStretch| s.since + track.time <= t || same_time(s.since + track.time, t);
            track.at = stretches.partition_point(begun).saturating_sub(1);
        }
        self.follow(t, values);
    }

    /// Sets the values at `t`, within the stretches where the delays are.
    pub fn follow(&self, t: f64, values: &mut [f64]) {
        for (k, track) in self.tracks.iter().enumerate() {
            values[track.slot] = self.past.stretches[track.at].value(k, t - track.time);
        }
    }

    /// The next time after `t` at which a delayed value jumps; infinite when there is none.
    pub fn next_jump(&self, t: f64) -> f64 {
        self.next(t, true)
    }

    /// The next time after `t` at which a delayed value has a kink; infinite when there is none.
    pub fn next_bend(&self, t: f64) -> f64 {
        self.next(t, false)
    }

    /// The next beginning of a stretch as seen through a delay, with or without a jump.
    fn next(&self, t: f64, jump: bool) -> f64 {
        let mut next = f64::INFINITY;
        for (k, track) in self.tracks.iter().enumerate() {
            let ahead = self.past.stretches.iter().skip(track.at + 1).filter(|s| s.jumps[k] == jump);
            let times = ahead.map(|s| s.since + track.time).filter(|&at| at > t && !same_time(at, t));
            next = times.fold(next, f64::min);
        }
        next
    }

    /// Records that a kink was passed at `t`: expressions that read it have a smoother kink there.
    pub fn pass(&mut self, t: f64, sources: &[f64]) {
        let passed = self.tracks.iter().filter_map(|track| {
            let here = |s: &&HistoryStretch| same_time(s.since + track.time, t);
            self.past.stretches.iter().find(here).map(|s| s.passages)
        });
        // after enough passages the kink is too smooth to matter
        let Some(passages) = passed.min().filter(|p| p + 1 < PASSAGES) else { return };
        self.open(t, sources, passages + 1, vec![false; self.tracks.len()]);
    }
}

impl DelayHistory {
    /// The history as a list of numbers, for checkpoints and saved states.
    pub fn numbers(&self) -> Vec<f64> {
        let mut out = Vec::new();
        for stretch in &self.stretches {
            let marks = stretch.jumps.iter().map(|&j| f64::from(u8::from(j)));
            let (pieces, delays) = (stretch.pieces.len() as f64, stretch.jumps.len() as f64);
            out.extend([pieces, stretch.since, f64::from(stretch.passages), delays]);
            out.extend(marks);
            for piece in &stretch.pieces {
                out.extend([piece.from, piece.to]);
                out.extend(piece.values.iter().flatten());
            }
        }
        out
    }

    /// The history from such a list; `None` where the list is damaged.
    pub fn from_numbers(numbers: &[f64]) -> Option<DelayHistory> {
        let mut rest = numbers.iter().copied();
        let mut record = DelayHistory::default();
        while let Some(count) = rest.next() {
            let (since, passages, delays) = (rest.next()?, rest.next()? as u32, rest.next()? as usize);
            let jumps = (0..delays).map(|_| rest.next().map(|j| j != 0.0)).collect::<Option<_>>()?;
            let mut piece = || {
                let (from, to) = (rest.next()?, rest.next()?);
                let mut trajectory = || {
                    let mut values = [0.0; POINTS];
                    values.iter_mut().try_for_each(|v| rest.next().map(|n| *v = n))?;
                    Some(values)
                };
                let values = (0..delays).map(|_| trajectory()).collect::<Option<_>>()?;
                Some(HistoryPiece { from, to, values })
            };
            let pieces: VecDeque<HistoryPiece> = (0..count as usize).map(|_| piece()).collect::<Option<_>>()?;
            (!pieces.is_empty()).then_some(())?;
            record.stretches.push_back(HistoryStretch { since, pieces, passages, jumps });
        }
        Some(record)
    }

    /// Whether nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.stretches.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_is_a_polynomial_of_fourth_degree() {
        let law = |t: f64| 1.0 - 2.0 * t + t.powi(4);
        let piece = HistoryPiece { from: 0.5, to: 2.0, values: vec![points(0.5, 2.0).map(law)] };
        for t in [0.5, 0.6, 1.25, 1.9, 2.0] {
            assert!((piece.value(0, t) - law(t)).abs() < 1e-13, "{t}");
        }
        assert_eq!((piece.value(0, 0.1), piece.value(0, 3.0)), (law(0.5), law(2.0)));
    }

    #[test]
    fn records_become_numbers_and_come_back() {
        let piece = HistoryPiece { from: 0.5, to: 2.0, values: vec![[1.0, 2.0, 3.0, 4.0, -0.0], [0.1; POINTS]] };
        let first = HistoryStretch {
            since: 0.25,
            pieces: VecDeque::from([piece.clone(), piece.clone()]),
            passages: 3,
            jumps: vec![true, false],
        };
        let second =
            HistoryStretch { since: 0.5, pieces: VecDeque::from([piece]), passages: 0, jumps: vec![false, false] };
        let record = DelayHistory { stretches: VecDeque::from([first, second]) };
        assert_eq!(DelayHistory::from_numbers(&record.numbers()), Some(record.clone()));
        assert_eq!(DelayHistory::from_numbers(&record.numbers()[..20]), None);
    }
}
