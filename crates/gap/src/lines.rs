//! Spectral lines: frequencies at which recordings differ from the nominal model and at which no input moves.
//!
//! A periodic disturbance that follows no variable of the model shows as such a line. Enters: the problem. Leaves:
//! frequencies in Hz, which `shapes` takes as the grid of periodic effects.

use super::problem::DiagnosisProblem;
use std::f64::consts::PI;

/// Most samples of each recording that are used.
const SAMPLES: usize = 4096;
/// Least number of periods that a recording must hold.
const PERIODS: f64 = 2.0;
/// Least number of samples in a period.
const PER_PERIOD: f64 = 5.0;
/// Neighbouring frequencies on each side with whose median the power at a frequency is compared.
const NEIGHBOURS: usize = 30;
/// Neighbours on each side that belong to the line itself, because the window spreads it.
const OWN: usize = 3;
/// Mean logarithm of power over the neighbours' median from which on a frequency counts as a line. Among thousands of
/// frequencies of one recording of noise the greatest is about 2.5.
const LINE: f64 = 3.0;
/// Most lines.
const MOST: usize = 3;
/// Halvings of the distance between two frequencies when a line is located.
const FINER: usize = 8;

/// Frequencies of the lines in Hz, the clearest first; empty if a simulation of the nominal model stops early.
/// A frequency at which an input has a line is left out.
pub fn lines(problem: &DiagnosisProblem<'_>) -> Vec<f64> {
    let Some(shown) = problem.observe(&problem.signals) else { return Vec::new() };
    let mut from = 0;
    let mut left: Vec<Vec<WindowedDifferences>> = vec![Vec::new(); problem.signals.len()];
    let mut moved: Vec<Vec<WindowedDifferences>> = vec![Vec::new(); problem.circuit.inputs.len()];
    for r in &problem.train {
        let n = r.len().min(SAMPLES);
        let step = r.duration() / (r.len() - 1).max(1) as f64;
        for (i, own) in left.iter_mut().enumerate() {
            let values = r.signals[i].iter().zip(&shown[i][from..]).take(n).map(|(y, s)| y - s).collect();
            own.push(WindowedDifferences::new(values, step));
        }
        moved.iter_mut().zip(&r.inputs).for_each(|(own, u)| own.push(WindowedDifferences::new(u[..n].to_vec(), step)));
        from += r.len();
    }
    let Some(frequencies) = frequencies(&left) else { return Vec::new() };
    let spectra: Vec<Vec<f64>> = left.iter().map(|all| heights(all, &frequencies)).collect();
    let inputs: Vec<Vec<f64>> = moved.iter().map(|all| heights(all, &frequencies)).collect();
    let mut taken: Vec<usize> = Vec::new();
    let mut found = Vec::new();
    while found.len() < MOST {
        let free = |k: usize| taken.iter().all(|t| t.abs_diff(k) > OWN);
        let best = (0..spectra.len())
            .flat_map(|i| (0..frequencies.len()).map(move |k| (i, k)))
            .filter(|&(_, k)| free(k))
            .max_by(|a, b| spectra[a.0][a.1].total_cmp(&spectra[b.0][b.1]));
        let Some((i, k)) = best.filter(|&(i, k)| spectra[i][k] > LINE) else { break };
        // also where an input moves: the next candidate must not be a neighbour of this one
        taken.push(k);
        let near = k.saturating_sub(OWN)..(k + OWN + 1).min(frequencies.len());
        // what an input does is a matter of the model, not of a disturbance
        if inputs.iter().all(|own| own[near.clone()].iter().all(|h| *h < LINE)) {
            found.push(placed(&left[i], frequencies[k], frequencies[1] - frequencies[0]));
        }
        // inputs with many lines would otherwise keep the loop running
        if taken.len() > 4 * MOST {
            break;
        }
    }
    found
}

/// Differences of neighbouring samples in a Hann window. Differences keep lines and remove drift.
#[derive(Clone)]
struct WindowedDifferences {
    /// Windowed differences; 0 where a sample is missing.
    values: Vec<f64>,
    /// Time between samples, s.
    step: f64,
}

impl WindowedDifferences {
    /// From samples at a constant step.
    fn new(samples: Vec<f64>, step: f64) -> WindowedDifferences {
        let n = samples.len().saturating_sub(1).max(1) as f64;
        let window = |k: usize| 0.5 - 0.5 * (2.0 * PI * (k as f64 + 0.5) / n).cos();
        let difference = |(k, w): (usize, &[f64])| {
            let d = (w[1] - w[0]) * window(k);
            if d.is_finite() { d } else { 0.0 }
        };
        WindowedDifferences { values: samples.windows(2).enumerate().map(difference).collect(), step }
    }

    /// Length of the series, s.
    fn duration(&self) -> f64 {
        self.values.len() as f64 * self.step
    }

    /// Power at a frequency in Hz.
    fn power(&self, frequency: f64) -> f64 {
        goertzel(&self.values, 2.0 * PI * frequency * self.step)
    }
}

/// Power at a frequency, given as the angle from sample to sample in rad (Goertzel, An algorithm for the evaluation of
/// finite trigonometric series, 1958).
pub fn goertzel(values: &[f64], turn: f64) -> f64 {
    let twice = 2.0 * turn.cos();
    let (mut one, mut two) = (0.0, 0.0);
    for v in values {
        (one, two) = (v + twice * one - two, one);
    }
    one * one + two * two - twice * one * two
}

/// Frequencies in Hz that all recordings can show, at the resolution of the longest one; `None` if there are too few.
/// The lowest one has [`PERIODS`] periods in the shortest recording, the highest [`PER_PERIOD`] samples a period.
fn frequencies(series: &[Vec<WindowedDifferences>]) -> Option<Vec<f64>> {
    let all = || series.iter().flatten();
    let longest = all().map(WindowedDifferences::duration).fold(0.0, f64::max);
    let shortest = all().map(WindowedDifferences::duration).fold(f64::INFINITY, f64::min);
    let slowest = all().map(|s| s.step).fold(0.0, f64::max);
    let (least, most) = (PERIODS / shortest, 1.0 / (PER_PERIOD * slowest));
    let count = ((most - least) * longest).floor();
    let enough = count.is_finite() && count > (2 * NEIGHBOURS) as f64;
    enough.then(|| (0..count as usize).map(|k| least + k as f64 / longest).collect())
}

/// Height of each frequency: mean over the recordings of the logarithm of its power over the median of its neighbours.
/// The median is that of the recording's own spectrum, so that coloured noise has no lines.
fn heights(series: &[WindowedDifferences], frequencies: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; frequencies.len()];
    for s in series {
        let powers: Vec<f64> = frequencies.iter().map(|&f| s.power(f)).collect();
        for (k, sum) in sum.iter_mut().enumerate() {
            let near = k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(powers.len());
            let mut others: Vec<f64> = near.filter(|n| n.abs_diff(k) > OWN).map(|n| powers[n]).collect();
            others.sort_by(f64::total_cmp);
            let median = others[others.len() / 2];
            // a median of zero means that nothing moves, so there is no line
            *sum += if median > 0.0 { (powers[k] / median).max(1e-3).ln() } else { 0.0 };
        }
    }
    sum.into_iter().map(|s| s / series.len().max(1) as f64).collect()
}

/// Frequency near one of the list at which the recordings together have most power, located by halving the distance.
fn placed(series: &[WindowedDifferences], frequency: f64, distance: f64) -> f64 {
    let size: Vec<f64> = series.iter().map(|s| s.power(frequency).max(f64::MIN_POSITIVE)).collect();
    // each recording counts relative to its own power, so that a loud one does not decide
    let power = |f: f64| series.iter().zip(&size).map(|(s, size)| s.power(f) / size).sum::<f64>();
    let (mut best, mut reach) = (frequency, distance);
    for _ in 0..FINER {
        reach *= 0.5;
        best = [best - reach, best, best + reach]
            .into_iter()
            .max_by(|a, b| power(*a).total_cmp(&power(*b)))
            .unwrap_or(best);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic noise of about unit size.
    fn noise(k: usize) -> f64 {
        let x = (k as f64 * 12.9898).sin() * 43758.5453;
        3.4 * (x - x.floor() - 0.5)
    }

    #[test]
    fn a_line_in_noise_stands_out_and_is_placed() {
        let make = |phase: f64, seed: usize| {
            let value = |k: usize| noise(k + seed) + 0.5 * (2.0 * PI * 7.313 * k as f64 * 1e-3 + phase).sin();
            WindowedDifferences::new((0..4000).map(value).collect(), 1e-3)
        };
        let series = vec![make(0.0, 0), make(2.0, 5000), make(4.0, 10000)];
        let frequencies = frequencies(std::slice::from_ref(&series)).expect("enough");
        let heights = heights(&series, &frequencies);
        let best = (0..heights.len()).max_by(|a, b| heights[*a].total_cmp(&heights[*b])).expect("some");
        assert!(heights[best] > LINE, "{}", heights[best]);
        let found = placed(&series, frequencies[best], frequencies[1] - frequencies[0]);
        assert!((found - 7.313).abs() < 0.03, "{found}");
    }

    #[test]
    fn noise_alone_has_no_line() {
        let make = |seed: usize| WindowedDifferences::new((0..4000).map(|k| noise(k + seed)).collect(), 1e-3);
        let series = vec![make(0), make(7000)];
        let frequencies = frequencies(std::slice::from_ref(&series)).expect("enough");
        assert!(heights(&series, &frequencies).iter().all(|h| *h < LINE));
    }
}
