//! Whiteness of residuals, signal by signal: their power relative to the sensor's noise, the correlation of neighbours,
//! and their spectrum. A complete model leaves white noise of unit power.
//!
//! Enters: residuals, recordings and noise. Leaves: a [`Whiteness`] per signal. Called by `report`.

use super::data::RecordingData;
use super::estimate::candidate::RecordingResiduals;
use super::lines::goertzel;
use std::f64::consts::PI;

/// Most samples in a stretch of which one spectrum is made.
const STRETCH: usize = 256;
/// Fewest samples of which a spectrum is made.
const FEWEST: usize = 32;
/// Relative difference up to which sampling steps are the same.
const SAME_STEP: f64 = 0.01;

/// Residuals of one signal, in standard deviations of its noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Whiteness {
    /// Mean square; 1 if they are as large as the noise.
    pub power: f64,
    /// Correlation of a sample with the next one.
    pub neighbours: f64,
    /// Absolute correlation that white noise of as many samples stays below in 95 % of cases.
    pub limit: f64,
    /// Frequencies in Hz; empty if the recordings are too short.
    pub frequencies: Vec<f64>,
    /// Power density at these frequencies, relative to white noise of unit power.
    pub density: Vec<f64>,
}

/// Whiteness of all signals from the residuals of a model and the noise of the sensors, SI.
pub fn whiteness(errors: &[RecordingResiduals], recordings: &[RecordingData], noise: &[f64]) -> Vec<Whiteness> {
    let steps: Vec<f64> = recordings.iter().map(|r| r.duration() / (r.len().max(2) - 1) as f64).collect();
    let one = |(signal, noise): (usize, &f64)| {
        // a missing sample counts as 0, so that neighbours stay neighbours
        let known = |e: &f64| if e.is_finite() { e / noise } else { 0.0 };
        let series: Vec<Vec<f64>> = errors.iter().map(|e| e[signal].iter().map(known).collect()).collect();
        of(&series, &steps)
    };
    noise.iter().enumerate().map(one).collect()
}

/// Whiteness of one signal; `steps`: sampling step of each series, s. A value of exactly 0 stands for a missing sample.
fn of(series: &[Vec<f64>], steps: &[f64]) -> Whiteness {
    let count = series.iter().flatten().filter(|v| **v != 0.0).count().max(1) as f64;
    let square: f64 = series.iter().flatten().map(|v| v * v).sum();
    let product: f64 = series.iter().flat_map(|s| s.windows(2)).map(|w| w[0] * w[1]).sum();
    let neighbours = if square > 0.0 { product / square } else { 0.0 };
    let (frequencies, density) = spectrum(series, steps);
    Whiteness { power: square / count, neighbours, limit: 1.96 / count.sqrt(), frequencies, density }
}

/// Frequencies and power density: mean spectrum of stretches that overlap by half, each in a Hann window (Welch, IEEE
/// Transactions on Audio and Electroacoustics 15, 1967). Recordings with another step than the first are left out.
fn spectrum(series: &[Vec<f64>], steps: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let Some(&step) = steps.first().filter(|s| **s > 0.0) else { return Default::default() };
    let alike = |(s, own): (&Vec<f64>, &f64)| ((own / step - 1.0).abs() < SAME_STEP).then(|| s.clone());
    let series: Vec<Vec<f64>> = series.iter().zip(steps).filter_map(alike).collect();
    let length = series.iter().map(Vec::len).max().unwrap_or(0).min(STRETCH);
    if length < FEWEST {
        return Default::default();
    }
    let window: Vec<f64> =
        (0..length).map(|k| 0.5 - 0.5 * (2.0 * PI * (k as f64 + 0.5) / length as f64).cos()).collect();
    // the power of the window, so that white noise keeps its power
    let size: f64 = window.iter().map(|w| w * w).sum();
    let mut density = vec![0.0; length / 2];
    let mut stretches = 0;
    for s in &series {
        for start in (0..(s.len() + 1).saturating_sub(length)).step_by(length / 2) {
            let windowed: Vec<f64> = s[start..start + length].iter().zip(&window).map(|(v, w)| v * w).collect();
            for (k, density) in density.iter_mut().enumerate() {
                *density += goertzel(&windowed, 2.0 * PI * (k + 1) as f64 / length as f64) / size;
            }
            stretches += 1;
        }
    }
    density.iter_mut().for_each(|d| *d /= f64::from(stretches.max(1)));
    ((0..length / 2).map(|k| (k + 1) as f64 / (length as f64 * step)).collect(), density)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_stands_at_its_frequency() {
        // an eighth of the sampling rate of 1 kHz
        let sine: Vec<f64> = (0..4096).map(|k| (PI / 4.0 * f64::from(k) + 0.3).sin()).collect();
        let found = of(&[sine], &[1e-3]);
        assert!((found.power - 0.5).abs() < 1e-3, "{}", found.power);
        assert!((found.neighbours - (PI / 4.0).cos()).abs() < 1e-3, "{}", found.neighbours);
        let greatest = (0..found.density.len()).max_by(|a, b| found.density[*a].total_cmp(&found.density[*b])).unwrap();
        assert!((found.frequencies[greatest] - 125.0).abs() < 1e-9, "{}", found.frequencies[greatest]);
        // all its power, spread over the frequencies up to half the sampling rate
        let mean = found.density.iter().sum::<f64>() / found.density.len() as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }

    #[test]
    fn what_is_too_short_or_still_has_no_spectrum() {
        assert!(of(&[vec![1.0; 8]], &[1e-3]).frequencies.is_empty());
        assert_eq!(of(&[vec![0.0; 8]], &[1e-3]).power, 0.0);
        assert!(of(&[], &[]).density.is_empty());
    }
}
