//! Evidence of left-out data that something is missing, in nats.
//!
//! It is a log likelihood ratio with an effective number of independent samples that belongs to the pair of models.
//! `E = L/T`, with `L = sum_j N_j/2 ln(a_j^2/c_j^2)` over the signals j. `a_j^2` and `c_j^2` are the mean squares that
//! the models without and with the effect leave. `T` is the variance of the product of trace and rest over that of
//! white noise (Bartlett, J. Roy. Stat. Soc. B 8, 1946; for one signal `1 + 2 sum rho_x rho_d`). The trace is what one
//! model leaves beyond the other. `T` is computed by spectra and by blocks, and the larger one counts.
//! To second order the expected value of exp(E) is then 1 where nothing is missing.
//!
//! Both models first get a Gauss-Newton step of all parameters with the weights of this comparison. Otherwise a
//! parameter that stays at its data sheet only because coloured errors have little weight would count as an effect.
//! Called by `criteria` and `confirm`. Method: `docs/gap_method.md`, "Evidence".

use super::super::data::RecordingData;
use super::super::estimate::candidate::{RecordingResiduals, piece};
use super::super::estimate::{ModelFit, NormalEquations, SignalWeights};
use super::compare::SensorAccuracy;
use super::folds::{self, FoldScheme};
use super::weighed::CrossValidatedFit;
use crate::policy::LEAST;
use nalgebra::DVector;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// Errors are limited to this many full scales: beyond, the simulation has left the machine.
const FAR: f64 = 1e3;
/// Half width of the average over a spectrum, in bins: this constant plus one bin in [`SMOOTHED_PART`] of the
/// frequency.
const SMOOTHED: usize = 2;
/// Bins of frequency for each further bin of half width.
const SMOOTHED_PART: usize = 10;
/// Passes of the refit. The weights of the first pass still contain errors that parameters explain.
const PASSES: usize = 2;

/// Left-out errors of two models, in parts of full scale, per recording.
struct ModelPair<'a> {
    /// Errors without the effect.
    without: &'a [RecordingResiduals],
    /// Errors with the effect.
    with: &'a [RecordingResiduals],
    /// Per signal the mean square below which errors are noise or rounding.
    floor: &'a [f64],
}

/// Result of comparing a pair.
#[derive(Clone, Debug, PartialEq)]
struct ModelComparison {
    /// Log likelihood ratio if all samples were independent, nats.
    likelihood: f64,
    /// Factor `T` by which the samples are fewer than independent ones.
    time: f64,
    /// Per signal the mean square that the second model leaves, floor included, in squared parts of full scale.
    square: Vec<f64>,
}

impl ModelComparison {
    /// The evidence `E = L/T`.
    fn nats(&self) -> f64 {
        self.likelihood / self.time
    }

    /// Weights of the signals in this comparison, for errors in SI units.
    fn weights(&self, full_scale: &[f64]) -> SignalWeights {
        let square: Vec<f64> = self.square.iter().zip(full_scale).map(|(s, scale)| s * scale * scale).collect();
        SignalWeights { tau: vec![self.time.max(1.0); square.len()], square }
    }
}

/// Errors in parts of full scale, limited to [`FAR`].
fn scaled(errors: &[RecordingResiduals], sensors: &SensorAccuracy) -> Vec<RecordingResiduals> {
    let signal = |(e, scale): (&Vec<f64>, &f64)| {
        let one = |v: &f64| if v.is_nan() { f64::NAN } else { (v / scale).clamp(-FAR, FAR) };
        e.iter().map(one).collect::<Vec<f64>>()
    };
    errors.iter().map(|e| e.iter().zip(&sensors.full_scale).map(signal).collect()).collect()
}

/// Per signal the mean square below which nothing is seen, in squared parts of full scale: noise and rounding.
fn floor(sensors: &SensorAccuracy) -> Vec<f64> {
    let one = |(noise, scale): (&f64, &f64)| (noise / scale).powi(2) + LEAST.powi(2);
    sensors.noise.iter().zip(&sensors.full_scale).map(one).collect()
}

impl ModelPair<'_> {
    /// Mean square of a signal over all recordings, and the number of its samples. NaN counts as no sample.
    fn mean_square(errors: &[RecordingResiduals], signal: usize) -> (f64, f64) {
        let known = || errors.iter().flat_map(|e| &e[signal]).filter(|v| !v.is_nan());
        let count = known().count() as f64;
        (known().map(|v| v * v).sum::<f64>() / count.max(1.0), count)
    }

    /// Likelihood, `T` and mean squares of the pair.
    fn compared(&self) -> ModelComparison {
        let mut likelihood = 0.0;
        let mut square = Vec::new();
        for (j, floor) in self.floor.iter().enumerate() {
            let (a, count) = Self::mean_square(self.without, j);
            let (c, _) = Self::mean_square(self.with, j);
            likelihood += 0.5 * count * ((a + floor) / (c + floor)).ln();
            square.push(c + floor);
        }
        // the rest contains at least white noise of the floor's size, which bounds T from below
        let least = self.floor.iter().zip(&square).map(|(f, s)| f / s).fold(1.0, f64::min);
        let time = self.time(&square).max(least);
        ModelComparison { likelihood, time, square }
    }

    /// Trace and rest of each recording, per signal, in standard deviations of the rest; 0 where a sample has no value.
    fn traces(&self, square: &[f64]) -> Vec<(RecordingResiduals, RecordingResiduals)> {
        let one = |(a, c): (&RecordingResiduals, &RecordingResiduals)| {
            let mut both = (Vec::new(), Vec::new());
            for ((a, c), s) in a.iter().zip(c).zip(square) {
                let known = |v: f64| if v.is_finite() { v / s.sqrt() } else { 0.0 };
                both.0.push(a.iter().zip(c).map(|(a, c)| known(a - c)).collect());
                // adding zero times `a` makes the rest unknown where the trace is
                both.1.push(a.iter().zip(c).map(|(a, c)| known(c + 0.0 * a)).collect());
            }
            both
        };
        self.without.iter().zip(self.with).map(one).collect()
    }

    /// The factor `T`: variance of the product of trace and rest over that of white noise; 1 without a trace.
    fn time(&self, square: &[f64]) -> f64 {
        let (mut spectral, mut by_blocks, mut all) = (0.0, 0.0, 0.0);
        let mut planner = RealFftPlanner::new();
        let traces = self.traces(square);
        let lengths: Vec<usize> = traces.iter().map(|(d, _)| d.first().map_or(0, Vec::len)).collect();
        for ((d, x), blocks) in traces.iter().zip(folds::blocks(&lengths)) {
            let size: f64 = d.iter().flatten().map(|v| v * v).sum();
            if size == 0.0 {
                continue;
            }
            all += size;
            spectral += in_spectrum(&mut planner, d, x);
            let of = |range: std::ops::Range<usize>| {
                d.iter().zip(x).map(|(d, x)| range.clone().map(|k| d[k] * x[k]).sum::<f64>()).sum::<f64>()
            };
            // the square of a sum over a block contains all correlations within the block and between signals
            by_blocks += blocks.map(of).map(|sum| sum * sum).sum::<f64>();
        }
        // the larger estimate gives less evidence
        if all > 0.0 { f64::max(spectral, by_blocks) / all } else { 1.0 }
    }
}

/// `sum_k d_k' G(k - l) d_l` of one recording, with G the covariance of `x` over lags and signals.
/// It is computed from the spectra of both; that of `x` is averaged over neighbouring frequencies.
/// `d`: the trace, `x`: the rest, both per signal and sample.
fn in_spectrum(planner: &mut RealFftPlanner<f64>, d: &RecordingResiduals, x: &RecordingResiduals) -> f64 {
    let n = d.first().map_or(0, Vec::len);
    let transform = planner.plan_fft_forward(n);
    let mut spectrum = |signal: &Vec<f64>| {
        let (mut input, mut output) = (signal.clone(), transform.make_output_vec());
        transform.process(&mut input, &mut output).map(|()| output).unwrap_or_default()
    };
    let traces: Vec<Vec<Complex64>> = d.iter().map(&mut spectrum).collect();
    let rests: Vec<Vec<Complex64>> = x.iter().map(&mut spectrum).collect();
    let bins = traces.first().map_or(0, Vec::len);
    let mut sum = 0.0;
    for a in 0..traces.len() {
        for b in 0..=a {
            // with cumulated sums the average over neighbours is one difference
            let mut cumulated = vec![Complex64::default(); bins + 1];
            (0..bins).for_each(|k| cumulated[k + 1] = cumulated[k] + rests[a][k] * rests[b][k].conj());
            // cross spectra of two signals occur twice in the symmetric sum
            let twice = if a == b { 1.0 } else { 2.0 };
            for k in 0..bins {
                let half = SMOOTHED + k / SMOOTHED_PART;
                let (from, to) = (k.saturating_sub(half), (k + half + 1).min(bins));
                let mean = (cumulated[to] - cumulated[from]) / (to - from) as f64;
                // a real signal has a one-sided spectrum: all bins but the first stand for two frequencies
                let both = if k == 0 { 1.0 } else { 2.0 };
                sum += both * twice * (traces[a][k].conj() * mean * traces[b][k]).re;
            }
        }
    }
    sum / (n as f64).powi(2)
}

/// Evidence for the second of two models from their errors on data that took no part in fitting, nats.
/// Outer index recording, then signal, then sample; SI units.
pub fn evidence(without: &[RecordingResiduals], with: &[RecordingResiduals], sensors: &SensorAccuracy) -> f64 {
    let floor = floor(sensors);
    let (without, with) = (scaled(without, sensors), scaled(with, sensors));
    ModelPair { without: &without, with: &with, floor: &floor }.compared().nats()
}

/// A model with the sensitivities that are needed to move its parameters by a small step.
pub struct AdjustableModel<'a> {
    /// The model with its fit.
    model: &'a CrossValidatedFit,
    /// Per recording the sensitivities of the simulated signals: samples by signals by coordinates.
    slopes: Vec<Vec<f32>>,
    /// Left-out errors in parts of full scale: by scheme, then by recording.
    left: Vec<Vec<RecordingResiduals>>,
}

impl<'a> AdjustableModel<'a> {
    /// Computes the sensitivities by one run of each recording. `None` if a run stops early.
    pub fn new(model: &'a CrossValidatedFit, train: &[RecordingData], sensors: &SensorAccuracy) -> Option<Self> {
        let ModelFit { candidate, x, .. } = &model.fit;
        let slopes: Option<Vec<Vec<f32>>> = train.iter().enumerate().map(|(k, r)| candidate.slopes(x, r, k)).collect();
        let left = model.left.iter().map(|l| scaled(&l.errors, sensors)).collect();
        Some(AdjustableModel { model, slopes: slopes?, left })
    }

    /// The change of coordinates by weighting signals with `weights` instead of the weights of the fit.
    ///
    /// It is the difference of two Gauss-Newton steps on the data without the fold `without`, or on all data.
    /// The steps are damped like the step that left the fold out. `damping` is `None` where the fit to all data stood
    /// instead: then nothing changes.
    fn change(
        &self,
        scheme: FoldScheme,
        without: Option<usize>,
        damping: Option<f64>,
        weights: &SignalWeights,
    ) -> DVector<f64> {
        let ModelFit { candidate, x, evaluated, weights: own, .. } = &self.model.fit;
        let Some(damping) = damping else { return DVector::zeros(x.len()) };
        let step = |weights: &SignalWeights| {
            let kept = |number, piece| Some(scheme.fold(number, piece)) != without;
            let sum = evaluated.sums(x.len(), weights, kept);
            NormalEquations::of(sum, &candidate.coordinates, x).step(&candidate.coordinates, x, damping)
        };
        let (new, old) = (step(weights), step(own));
        DVector::from_fn(x.len(), |i, _| new[i] - old[i])
    }

    /// Left-out errors and prior (nats) after the step with these weights, to first order.
    fn moved(
        &self,
        scheme: FoldScheme,
        at: usize,
        weights: &SignalWeights,
        full_scale: &[f64],
    ) -> (Vec<RecordingResiduals>, f64) {
        let ModelFit { candidate, x, .. } = &self.model.fit;
        let dampings = &self.model.left[at].dampings;
        let fold = |(k, damping): (usize, &Option<f64>)| self.change(scheme, Some(k), *damping, weights);
        // each sample moves with the parameters of the fold that left it out
        let changes: Vec<DVector<f64>> = dampings.iter().enumerate().map(fold).collect();
        let mut left = self.left[at].clone();
        for (number, (errors, slopes)) in left.iter_mut().zip(&self.slopes).enumerate() {
            let (signals, samples) = (errors.len(), errors.first().map_or(0, Vec::len));
            for k in 0..samples {
                let change = &changes[scheme.fold(number, piece(k, samples))];
                for (j, signal) in errors.iter_mut().enumerate() {
                    let row = &slopes[(k * signals + j) * x.len()..][..x.len()];
                    let moved: f64 = row.iter().zip(change.iter()).map(|(s, c)| f64::from(*s) * c).sum();
                    signal[k] = (signal[k] - moved / full_scale[j]).clamp(-FAR, FAR);
                }
            }
        }
        // the step for all data is damped like the most damped fold; no step if a fold had none
        let most = dampings.iter().copied().reduce(|a, b| Some(a?.max(b?))).flatten();
        let all = self.change(scheme, None, most, weights);
        let x: Vec<f64> = x.iter().zip(all.iter()).map(|(x, c)| x + c).collect();
        (left, 0.5 * candidate.prior(&x))
    }
}

/// Evidence of left-out train data and of the prior for the second model, nats; of several schemes the largest.
pub fn refitted(without: &AdjustableModel<'_>, with: &AdjustableModel<'_>, sensors: &SensorAccuracy) -> f64 {
    let floor = floor(sensors);
    let one = |(at, scheme): (usize, FoldScheme)| {
        let mut compared = ModelPair { without: &without.left[at], with: &with.left[at], floor: &floor }.compared();
        let mut saved = without.model.fit.prior() - with.model.fit.prior();
        // weights follow from the comparison, and the comparison from errors moved with these weights
        for _ in 0..PASSES {
            let now = compared.weights(&sensors.full_scale);
            let (a, prior_a) = without.moved(scheme, at, &now, &sensors.full_scale);
            let (c, prior_c) = with.moved(scheme, at, &now, &sensors.full_scale);
            compared = ModelPair { without: &a, with: &c, floor: &floor }.compared();
            saved = prior_a - prior_c;
        }
        compared.nats() + saved
    };
    let schemes = folds::schemes(without.slopes.len());
    schemes.into_iter().enumerate().map(one).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::ALPHA;

    struct Random(u64);

    impl Random {
        fn normal(&mut self) -> f64 {
            let mut uniform = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }

        /// Noise of unit variance, each sample the part `kept` of the one before.
        fn coloured(&mut self, n: usize, kept: f64) -> Vec<f64> {
            let mut x = self.normal();
            let own = (1.0 - kept * kept).sqrt();
            let mut next = || {
                x = kept * x + own * self.normal();
                x
            };
            (0..n).map(|_| next()).collect()
        }
    }

    fn sensors(signals: usize) -> SensorAccuracy {
        SensorAccuracy { noise: vec![0.0; signals], full_scale: vec![1.0; signals] }
    }

    fn ripple(n: usize, size: f64, period: f64) -> Vec<f64> {
        (0..n).map(|k| size * (std::f64::consts::TAU * k as f64 / period).sin()).collect()
    }

    fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + b).collect()
    }

    /// White errors: one sample says as much as one sample.
    #[test]
    fn white_errors_are_independent() {
        let (n, mut random) = (4000, Random(5));
        let rest = random.coloured(n, 0.0);
        let trace = ripple(n, 0.2, 20.0);
        let found = evidence(&[vec![sum(&rest, &trace)]], &[vec![rest]], &sensors(1));
        let all = 0.5 * n as f64 * (1.0_f64 + 0.02).ln();
        assert!((found / all - 1.0).abs() < 0.35, "{found} of {all}");
    }

    /// A quick trace lies where slow noise is quiet: it counts for more; a slow one counts for less.
    #[test]
    fn the_colour_of_the_trace_counts() {
        let (n, mut random) = (4000, Random(7));
        let rest = random.coloured(n, 0.95);
        let with = |period: f64| {
            let trace = ripple(n, 0.15, period);
            evidence(&[vec![sum(&rest, &trace)]], &[vec![rest.clone()]], &sensors(1))
        };
        assert!(with(20.0) > 10.0 && with(1000.0) < 5.0, "{} {}", with(20.0), with(1000.0));
    }

    /// Four sensors that see the same disturbance say what one says.
    #[test]
    fn what_sensors_have_in_common_counts_once() {
        let (n, mut random) = (2000, Random(9));
        let rest = random.coloured(n, 0.0);
        let trace = ripple(n, 0.2, 50.0);
        let of = |signals: usize| {
            let all = |e: &[f64]| vec![vec![e.to_vec(); signals]];
            evidence(&all(&sum(&rest, &trace)), &all(&rest), &sensors(signals))
        };
        assert!((of(4) / of(1) - 1.0).abs() < 0.05, "{} {}", of(4), of(1));
    }

    /// Where nothing is missing, what a wrong effect adds is seldom taken for evidence, whatever the colour.
    #[test]
    fn a_false_effect_is_rarely_sure() {
        let mut random = Random(11);
        for kept in [0.0, 0.9, 0.99] {
            let draws = 400;
            let sure = (0..draws).filter(|_| {
                let rest = random.coloured(500, kept);
                let added: Vec<f64> = random.coloured(500, kept).iter().map(|v| 0.3 * v).collect();
                evidence(&[vec![rest.clone()]], &[vec![sum(&rest, &added)]], &sensors(1)) > (1.0 / ALPHA).ln()
            });
            let sure = sure.count();
            assert!(f64::from(u32::try_from(sure).expect("few")) <= 2.0 * ALPHA * f64::from(draws), "{sure} at {kept}");
        }
    }
}
