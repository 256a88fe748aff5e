//! Recorded inputs: held between samples (each step is an event) or linear (each sample is a kink that steps respect).
//!
//! The caller gives [`RecordedInput`]s. [`InputPlayback`] writes their values into slots during a run, and names the
//! times at which the integrator must stop. It contains the delayed values too, which are inputs of the same kind.

use super::modes::same_time;
use super::past::DelayBuffers;
use crate::lower::ValueLayout;
use bramah_expr::VarId;
use bramah_model::structure::Dae;
use bramah_syntax::diag::{Code, Diagnostic};
use std::sync::Arc;

/// The value of an input between its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// The value of a sample holds until the next one.
    #[default]
    Held,
    /// Straight lines between samples.
    Linear,
}

/// A recorded input. Before its first sample it has the first value, after the last sample the last value.
#[derive(Clone, Debug)]
pub struct RecordedInput {
    /// The input variable.
    pub variable: VarId,
    /// Times of the samples in seconds, ascending; may be shared between inputs.
    ///
    /// Of several samples at one time, the first is the value just before that time, the last the value just after.
    pub times: Arc<[f64]>,
    /// Values in the unit of the variable, as many as times.
    pub values: Arc<[f64]>,
    /// How values between samples are found.
    pub interpolation: Interpolation,
}

/// E106 for each input of the model that has neither a recording nor a value of its own.
///
/// `help` gives the lines of help for an input of this name.
pub fn missing_inputs(dae: &Dae, inputs: &[RecordedInput], help: impl Fn(&str) -> Vec<String>) -> Vec<Diagnostic> {
    let said = |v: &VarId| {
        let variable = &dae.variables[v.index()];
        let has_value =
            variable.binding.is_some() || variable.start.is_some() || inputs.iter().any(|i| i.variable == *v);
        let d = || Diagnostic::new(Code::NoInput, format!("the input `{}` has no value", variable.name));
        (!has_value).then(|| {
            help(&variable.name).into_iter().fold(d().at(variable.origin.span, "declared here"), Diagnostic::help)
        })
    };
    dae.inputs.iter().filter_map(said).collect()
}

impl RecordedInput {
    /// An input that holds each sample until the next one.
    pub fn held(variable: VarId, times: impl Into<Arc<[f64]>>, values: impl Into<Arc<[f64]>>) -> Self {
        RecordedInput { variable, times: times.into(), values: values.into(), interpolation: Interpolation::Held }
    }

    /// An input that is linear between samples.
    pub fn linear(variable: VarId, times: impl Into<Arc<[f64]>>, values: impl Into<Arc<[f64]>>) -> Self {
        RecordedInput { variable, times: times.into(), values: values.into(), interpolation: Interpolation::Linear }
    }
}

/// All recorded inputs during a run.
#[derive(Clone, Debug, Default)]
pub struct InputPlayback {
    /// The inputs with at least one sample.
    tracks: Vec<InputTrack>,
    /// Whether one of them is linear; held ones need no update between events.
    any_linear: bool,
    /// Delayed values: inputs that the run itself records.
    pub delays: DelayBuffers,
}

/// One recorded input with its position.
#[derive(Clone, Debug)]
struct InputTrack {
    /// The samples.
    input: RecordedInput,
    /// The slot of the input.
    slot: usize,
    /// The slot of its derivative; `None` where the model does not use it.
    der: Option<usize>,
    /// Index of the last sample at or before the present time.
    at: usize,
}

impl InputPlayback {
    /// Prepares the playback. Inputs without samples are ignored.
    pub fn new(inputs: &[RecordedInput], layout: &ValueLayout) -> Self {
        let tracks: Vec<InputTrack> = inputs
            .iter()
            .filter(|i| !i.times.is_empty())
            .map(|input| InputTrack {
                input: input.clone(),
                slot: layout.var(input.variable),
                der: layout.der(input.variable),
                at: 0,
            })
            .collect();
        let any_linear = tracks.iter().any(|t| t.input.interpolation == Interpolation::Linear);
        InputPlayback { tracks, any_linear, delays: DelayBuffers::default() }
    }

    /// Moves to time `t`, which may lie anywhere, and sets the values that hold just after it.
    pub fn seek(&mut self, t: f64, values: &mut [f64]) {
        for track in &mut self.tracks {
            let times = &track.input.times;
            track.at = times.partition_point(|&s| s <= t || same_time(s, t)).saturating_sub(1);
        }
        self.set(t, values);
        self.delays.seek(t, values);
    }

    /// Stops the playback of the input with this slot, because the caller sets it from now on.
    pub fn release(&mut self, slot: usize) {
        self.tracks.retain(|track| track.slot != slot);
    }

    /// Sets all values at `t`, between the samples at the present position.
    pub fn set(&self, t: f64, values: &mut [f64]) {
        for track in &self.tracks {
            track.set(t, values);
        }
    }

    /// Sets the values of linear inputs and delays at `t`. Held inputs keep their values.
    pub fn follow(&self, t: f64, values: &mut [f64]) {
        self.delays.follow(t, values);
        if self.any_linear {
            for track in self.tracks.iter().filter(|t| t.input.interpolation == Interpolation::Linear) {
                track.set(t, values);
            }
        }
    }

    /// The next time after `t` at which an input or a delayed value jumps; infinite when there is none.
    pub fn next_jump(&self, t: f64) -> f64 {
        self.next(t, InputTrack::jumps).min(self.delays.next_jump(t))
    }

    /// The next time after `t` at which a linear input or a delayed value has a kink; infinite when there is none.
    pub fn next_kink(&self, t: f64) -> f64 {
        let linear = if self.any_linear { self.next(t, InputTrack::bends) } else { f64::INFINITY };
        linear.min(self.delays.next_bend(t))
    }

    /// The earliest next change of all inputs.
    fn next(&self, t: f64, changes: impl Fn(&InputTrack, usize) -> bool) -> f64 {
        self.tracks.iter().map(|track| track.next_change(t, &changes)).fold(f64::INFINITY, f64::min)
    }
}

impl InputTrack {
    /// Writes value and derivative at `t` into their slots.
    fn set(&self, t: f64, values: &mut [f64]) {
        let (times, samples) = (&self.input.times, &self.input.values);
        let (value, slope) = match self.input.interpolation {
            Interpolation::Held => (samples[self.at], 0.0),
            Interpolation::Linear => line(times, samples, self.at, t),
        };
        values[self.slot] = value;
        if let Some(der) = self.der {
            values[der] = slope;
        }
    }

    /// Whether the value jumps at sample `k`. A linear input jumps where two samples have the same time.
    fn jumps(&self, k: usize) -> bool {
        let (times, samples) = (&self.input.times, &self.input.values);
        match self.input.interpolation {
            Interpolation::Held => samples[k] != samples[self.at],
            Interpolation::Linear => same_time(times[k], times[k - 1]) && samples[k] != samples[k - 1],
        }
    }

    /// Whether the slope may change at a sample.
    fn bends(&self, _: usize) -> bool {
        self.input.interpolation == Interpolation::Linear
    }

    /// The time of the next sample after `t` at which something changes; infinite when there is none.
    fn next_change(&self, t: f64, changes: &impl Fn(&InputTrack, usize) -> bool) -> f64 {
        let times = &self.input.times;
        let next = (self.at + 1..times.len()).find(|&k| changes(self, k) && times[k] > t && !same_time(times[k], t));
        next.map_or(f64::INFINITY, |k| times[k])
    }
}

/// Value and slope of the line that starts at sample `at`. Constant before the first and after the last sample.
fn line(times: &[f64], samples: &[f64], at: usize, t: f64) -> (f64, f64) {
    if t < times[0] {
        return (samples[0], 0.0);
    }
    if at + 1 >= times.len() {
        return (samples[at], 0.0);
    }
    let slope = (samples[at + 1] - samples[at]) / (times[at + 1] - times[at]);
    (samples[at] + (t - times[at]) * slope, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_model::structure::Dae;

    fn playback(interpolation: Interpolation) -> (InputPlayback, Vec<f64>) {
        playback_of(interpolation, &[(1.0, 10.0), (2.0, 20.0), (3.0, 20.0), (5.0, 0.0)])
    }

    fn playback_of(interpolation: Interpolation, samples: &[(f64, f64)]) -> (InputPlayback, Vec<f64>) {
        let dae = Dae { variables: vec![crate::tests::variable("u")], ..Dae::default() };
        let layout = ValueLayout::new(&dae);
        let values = layout.values();
        let input = RecordedInput {
            variable: VarId(0),
            times: samples.iter().map(|s| s.0).collect(),
            values: samples.iter().map(|s| s.1).collect(),
            interpolation,
        };
        (InputPlayback::new(&[input], &layout), values)
    }

    fn at(playback: &mut InputPlayback, values: &mut [f64], t: f64) -> f64 {
        playback.seek(t, values);
        values[playback.tracks[0].slot]
    }

    #[test]
    fn held_values_jump_at_their_samples_and_skip_equal_ones() {
        let (mut p, mut values) = playback(Interpolation::Held);
        for (t, u) in [(0.0, 10.0), (1.0, 10.0), (1.999, 10.0), (2.0, 20.0), (4.9, 20.0), (5.0, 0.0), (9.0, 0.0)] {
            assert_eq!(at(&mut p, &mut values, t), u, "{t}");
        }
        p.seek(2.0, &mut values);
        assert_eq!(p.next_jump(2.0), 5.0);
        assert_eq!(p.next_kink(2.0), f64::INFINITY);
    }

    #[test]
    fn linear_values_bend_at_their_samples() {
        let (mut p, mut values) = playback(Interpolation::Linear);
        for (t, u) in [(0.0, 10.0), (1.5, 15.0), (2.5, 20.0), (4.0, 10.0), (7.0, 0.0)] {
            assert_eq!(at(&mut p, &mut values, t), u, "{t}");
        }
        p.seek(2.0, &mut values);
        assert_eq!(p.next_kink(2.0), 3.0);
        assert_eq!(p.next_jump(2.0), f64::INFINITY);
    }

    #[test]
    fn two_samples_at_one_time_are_a_jump() {
        let samples = [(0.0, 0.0), (2.0, 20.0), (2.0, 0.0), (4.0, 40.0), (4.0, 50.0)];
        for (interpolation, before, after, end) in
            [(Interpolation::Linear, 10.0, 20.0, 50.0), (Interpolation::Held, 0.0, 0.0, 50.0)]
        {
            let (mut p, mut values) = playback_of(interpolation, &samples);
            for (t, u) in [(1.0, before), (2.0, 0.0), (3.0, after), (4.0, end), (9.0, end)] {
                assert_eq!(at(&mut p, &mut values, t), u, "{interpolation:?} {t}");
            }
            p.seek(2.0, &mut values);
            assert_eq!(p.next_jump(2.0), 4.0);
        }
        let (mut p, mut values) = playback_of(Interpolation::Linear, &samples);
        p.seek(1.0, &mut values);
        p.set(2.0, &mut values);
        assert_eq!(values[p.tracks[0].slot], 20.0, "arrives at the first of the two");
    }
}
