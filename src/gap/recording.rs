//! Gross errors of recordings, found before anything is fitted: a sign, a factor, swapped columns, a stuck sensor.

use super::data::Recording;
use super::held;
use super::problem::Problem;

/// Correlation with the simulation above which a signal is taken for the one that is simulated.
const ALIKE: f64 = 0.9;
/// Factors beyond this are no sensor gain.
const FACTOR: f64 = 3.0;

/// What is wrong with a signal of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Gross {
    /// Index of the train recording.
    pub recording: usize,
    /// Index of the signal.
    pub signal: usize,
    /// The word of the verdict.
    pub error: &'static str,
    /// The factor, or the number of the other signal.
    pub value: f64,
}

/// Compares each signal with the nominal simulation.
pub fn gross_errors(problem: &Problem<'_>) -> Vec<Gross> {
    let Ok(model) = problem.assemble(&[], &[]) else { return Vec::new() };
    let setting = model.setting(&[], &problem.noise_floor, Vec::new());
    let mut found = Vec::new();
    for (number, recording) in problem.train.iter().enumerate() {
        found.extend(stuck(problem, recording, number));
        // from the model's own start: the recording's may be what is wrong
        let Some(simulated) = held::from_start(&setting, recording) else { continue };
        let gross = compare(recording, &simulated, number);
        found.extend(gross.into_iter().filter(|g| !is_start(recording, &simulated, g)));
    }
    // an error of the sensor is there in every recording, else it is something else
    let everywhere = |g: &Gross| {
        let same = found.iter().filter(|o| o.signal == g.signal && o.error == g.error);
        g.error == "stuck" || same.count() == problem.train.len()
    };
    found.iter().filter(|g| everywhere(g)).cloned().collect()
}

/// A signal whose last half never changes while it did before.
fn stuck(problem: &Problem<'_>, recording: &Recording, number: usize) -> Vec<Gross> {
    let mut found = Vec::new();
    for signal in 0..problem.signals.len() {
        let known: Vec<f64> = recording.signals[signal].iter().copied().filter(|v| v.is_finite()).collect();
        let Some(last) = known.last() else { continue };
        let still = known.iter().rev().take_while(|v| *v == last).count();
        let noisy = problem.noise_floor[signal] > 1e-6 * problem.full_scale[signal].abs();
        if still > 50 && 5 * still > known.len() && (noisy || 10 * still > 9 * known.len()) {
            found.push(Gross { recording: number, signal, error: "stuck", value: *last });
        }
    }
    found
}

/// Whether the second half shows the signal as it is simulated: then it was the model's start that made it look wrong.
fn is_start(recording: &Recording, simulated: &[Vec<f64>], gross: &Gross) -> bool {
    let half = recording.len() / 2..recording.len();
    let (measured, simulated) = (&recording.signals[gross.signal][half.clone()], &simulated[gross.signal][half]);
    let (correlation, slope) = relation(measured, simulated);
    correlation > ALIKE && is_gain(slope)
}

/// Whether a sensor may have this gain.
fn is_gain(slope: f64) -> bool {
    (1.0 / FACTOR..=FACTOR).contains(&slope)
}

fn compare(recording: &Recording, simulated: &[Vec<f64>], number: usize) -> Vec<Gross> {
    let count = simulated.len();
    let pair = |i: usize, j: usize| relation(&recording.signals[i], &simulated[j]);
    let mut found = Vec::new();
    for i in 0..count {
        let (correlation, slope) = pair(i, i);
        let error = if correlation < -ALIKE {
            Some(("sign", slope))
        } else if correlation > ALIKE && !is_gain(slope) {
            Some(("factor", slope))
        } else {
            None
        };
        if let Some((error, value)) = error {
            found.push(Gross { recording: number, signal: i, error, value });
        }
        for j in i + 1..count {
            let crossed = pair(i, j).0 > ALIKE && pair(j, i).0 > ALIKE;
            if crossed && pair(i, i).0 < 0.5 && pair(j, j).0 < 0.5 {
                found.retain(|g| g.signal != i && g.signal != j);
                found.push(Gross { recording: number, signal: i, error: "swap", value: j as f64 });
                found.push(Gross { recording: number, signal: j, error: "swap", value: i as f64 });
            }
        }
    }
    found
}

/// Correlation of deviations from the mean, and the slope of the measured over the simulated ones.
fn relation(measured: &[f64], simulated: &[f64]) -> (f64, f64) {
    let pairs: Vec<(f64, f64)> =
        measured.iter().zip(simulated).filter(|(m, s)| m.is_finite() && s.is_finite()).map(|(m, s)| (*m, *s)).collect();
    let n = pairs.len().max(1) as f64;
    let (mm, ms) = pairs.iter().fold((0.0, 0.0), |(a, b), (m, s)| (a + m / n, b + s / n));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (m, s) in pairs {
        xx += (s - ms) * (s - ms);
        xy += (s - ms) * (m - mm);
        yy += (m - mm) * (m - mm);
    }
    if xx <= 0.0 || yy <= 0.0 { (0.0, 1.0) } else { (xy / (xx * yy).sqrt(), xy / xx) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_that_dies_out_is_no_factor() {
        let times: Vec<f64> = (0..200).map(f64::from).collect();
        let wave: Vec<f64> = times.iter().map(|t| (t * 0.2).sin()).collect();
        let simulated = vec![wave.iter().zip(&times).map(|(w, t)| w + 40.0 * (-t * 0.1).exp()).collect::<Vec<f64>>()];
        let measured = |factor: f64| {
            let values: Vec<f64> = wave.iter().map(|w| factor * w).collect();
            Recording { times: times.clone().into(), inputs: vec![], linear: vec![], signals: vec![values.into()] }
        };
        let gross = |value| Gross { recording: 0, signal: 0, error: "factor", value };
        assert!(is_start(&measured(1.0), &simulated, &gross(0.1)));
        assert!(!is_start(&measured(10.0), &simulated, &gross(10.0)));
        assert!(!is_start(&measured(-1.0), &simulated, &gross(-1.0)));
    }

    #[test]
    fn relations_of_signals() {
        let x: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.1).collect();
        let y: Vec<f64> = x.iter().map(|v| 3.0 - 2.0 * v).collect();
        let (correlation, slope) = relation(&y, &x);
        assert!((correlation + 1.0).abs() < 1e-12 && (slope + 2.0).abs() < 1e-12);
    }
}
