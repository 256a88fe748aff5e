//! Evidence of left-out data that something is missing, as a likelihood ratio whose number of independent samples belongs
//! to the pair of models: what one leaves beyond the other is a trace, and the rest beside it is noise of some colour.
//!
//! `E = L/T`, with `L = sum_j N_j/2 ln(a_j^2/c_j^2)` over the signals and T the variance of the product of trace and rest
//! over that of white noise (Bartlett, J. Roy. Stat. Soc. B 8, 1946; for one signal `1 + 2 sum rho_x rho_d`), by spectra
//! and by blocks, whichever is larger. To second order the expected value of exp(E) is then 1 where nothing is missing.
//! Both models first get a step of all their parameters with the weights that the comparison itself has: what stays on its
//! data sheet by the weight of coloured errors, not by truth, would count as an effect.

use super::super::data::RecordingData;
use super::super::estimate::candidate::{RecordingResiduals, piece};
use super::super::estimate::{ModelFit, NormalEquations, SignalWeights};
use super::super::policy::LEAST;
use super::compare::SensorAccuracy;
use super::folds::{self, FoldScheme};
use super::weighed::CrossValidatedFit;
use nalgebra::DVector;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// Errors beyond so many full scales are no larger: there the simulation has left the machine.
const FAR: f64 = 1e3;
/// Bins of a spectrum over which it is averaged on each side: so many and a part of the frequency.
const SMOOTHED: usize = 2;
const SMOOTHED_PART: usize = 10;
/// Passes of the refit: the first weights still contain what parameters explain.
const PASSES: usize = 2;

/// Two models side by side, in parts of full scale.
struct ModelPair<'a> {
    without: &'a [RecordingResiduals],
    with: &'a [RecordingResiduals],
    floor: &'a [f64],
}

/// What a pair comes to.
#[derive(Clone, Debug, PartialEq)]
struct ModelComparison {
    /// Log likelihood ratio were all samples independent.
    likelihood: f64,
    /// How many samples in a row say the same of the trace.
    time: f64,
    /// Per signal the mean square that the second model leaves, the floor included.
    square: Vec<f64>,
}

impl ModelComparison {
    fn nats(&self) -> f64 {
        self.likelihood / self.time
    }

    /// How much a squared error of each signal counts, in its unit.
    fn weights(&self, full_scale: &[f64]) -> SignalWeights {
        let square: Vec<f64> = self.square.iter().zip(full_scale).map(|(s, scale)| s * scale * scale).collect();
        SignalWeights { tau: vec![self.time.max(1.0); square.len()], square }
    }
}

/// Errors in parts of full scale.
fn scaled(errors: &[RecordingResiduals], sensors: &SensorAccuracy) -> Vec<RecordingResiduals> {
    let signal = |(e, scale): (&Vec<f64>, &f64)| {
        let one = |v: &f64| if v.is_nan() { f64::NAN } else { (v / scale).clamp(-FAR, FAR) };
        e.iter().map(one).collect::<Vec<f64>>()
    };
    errors.iter().map(|e| e.iter().zip(&sensors.full_scale).map(signal).collect()).collect()
}

/// Mean square below which nothing is seen, in parts of full scale: that of the noise, and rounding.
fn floor(sensors: &SensorAccuracy) -> Vec<f64> {
    let one = |(noise, scale): (&f64, &f64)| (noise / scale).powi(2) + LEAST.powi(2);
    sensors.noise.iter().zip(&sensors.full_scale).map(one).collect()
}

impl ModelPair<'_> {
    fn mean_square(errors: &[RecordingResiduals], signal: usize) -> (f64, f64) {
        let known = || errors.iter().flat_map(|e| &e[signal]).filter(|v| !v.is_nan());
        let count = known().count() as f64;
        (known().map(|v| v * v).sum::<f64>() / count.max(1.0), count)
    }

    fn compared(&self) -> ModelComparison {
        let mut likelihood = 0.0;
        let mut square = Vec::new();
        for (j, floor) in self.floor.iter().enumerate() {
            let (a, count) = Self::mean_square(self.without, j);
            let (c, _) = Self::mean_square(self.with, j);
            likelihood += 0.5 * count * ((a + floor) / (c + floor)).ln();
            square.push(c + floor);
        }
        let least = self.floor.iter().zip(&square).map(|(f, s)| f / s).fold(1.0, f64::min);
        let time = self.time(&square).max(least);
        ModelComparison { likelihood, time, square }
    }

    /// Trace and rest of each recording, per signal in deviations of the rest; nothing where a sample has no value.
    fn traces(&self, square: &[f64]) -> Vec<(RecordingResiduals, RecordingResiduals)> {
        let one = |(a, c): (&RecordingResiduals, &RecordingResiduals)| {
            let mut both = (Vec::new(), Vec::new());
            for ((a, c), s) in a.iter().zip(c).zip(square) {
                let known = |v: f64| if v.is_finite() { v / s.sqrt() } else { 0.0 };
                both.0.push(a.iter().zip(c).map(|(a, c)| known(a - c)).collect());
                both.1.push(a.iter().zip(c).map(|(a, c)| known(c + 0.0 * a)).collect());
            }
            both
        };
        self.without.iter().zip(self.with).map(one).collect()
    }

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
            by_blocks += blocks.map(of).map(|sum| sum * sum).sum::<f64>();
        }
        if all > 0.0 { f64::max(spectral, by_blocks) / all } else { 1.0 }
    }
}

/// `sum_k d_k' G(k - l) d_l` of one recording, G the covariance of x over lags and signals: by the spectra of both, that of x
/// averaged over neighbouring frequencies.
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
            let mut cumulated = vec![Complex64::default(); bins + 1];
            (0..bins).for_each(|k| cumulated[k + 1] = cumulated[k] + rests[a][k] * rests[b][k].conj());
            let twice = if a == b { 1.0 } else { 2.0 };
            for k in 0..bins {
                let half = SMOOTHED + k / SMOOTHED_PART;
                let (from, to) = (k.saturating_sub(half), (k + half + 1).min(bins));
                let mean = (cumulated[to] - cumulated[from]) / (to - from) as f64;
                // the halves of a spectrum are mirrored, but for its first value
                let both = if k == 0 { 1.0 } else { 2.0 };
                sum += both * twice * (traces[a][k].conj() * mean * traces[b][k]).re;
            }
        }
    }
    sum / (n as f64).powi(2)
}

/// Evidence for the second of two models whose errors on data that took no part are these, nats.
pub fn evidence(without: &[RecordingResiduals], with: &[RecordingResiduals], sensors: &SensorAccuracy) -> f64 {
    let floor = floor(sensors);
    let (without, with) = (scaled(without, sensors), scaled(with, sensors));
    ModelPair { without: &without, with: &with, floor: &floor }.compared().nats()
}

/// A model with what is needed to move its parameters a little.
pub struct AdjustableModel<'a> {
    model: &'a CrossValidatedFit,
    /// Per recording the slopes of all errors that were left out: samples by signals by coordinates.
    slopes: Vec<Vec<f32>>,
    /// Left-out errors by scheme.
    left: Vec<Vec<RecordingResiduals>>,
}

impl<'a> AdjustableModel<'a> {
    /// Runs the model once. `None` where it does not reach the end.
    pub fn new(model: &'a CrossValidatedFit, train: &[RecordingData], sensors: &SensorAccuracy) -> Option<Self> {
        let ModelFit { candidate, x, .. } = &model.fit;
        let slopes: Option<Vec<Vec<f32>>> = train.iter().enumerate().map(|(k, r)| candidate.slopes(x, r, k)).collect();
        let left = model.left.iter().map(|l| scaled(&l.errors, sensors)).collect();
        Some(AdjustableModel { model, slopes: slopes?, left })
    }

    /// Where a step leads from the fit when each signal counts so much, and when it counts as in the fit: the difference, for
    /// the data without a fold or, where there is none, for all. The step is damped as much as it must be to lead where the
    /// linear model says; where none does, the fit stays.
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

    /// Left-out errors with these weights, and the prior there, nats.
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
        // the step for all data is damped as the most damped fold is
        let most = dampings.iter().copied().reduce(|a, b| Some(a?.max(b?))).flatten();
        let all = self.change(scheme, None, most, weights);
        let x: Vec<f64> = x.iter().zip(all.iter()).map(|(x, c)| x + c).collect();
        (left, 0.5 * candidate.prior(&x))
    }
}

/// Evidence of left-out train data and of the prior for the second model, nats: the largest by any scheme.
pub fn refitted(without: &AdjustableModel<'_>, with: &AdjustableModel<'_>, sensors: &SensorAccuracy) -> f64 {
    let floor = floor(sensors);
    let one = |(at, scheme): (usize, FoldScheme)| {
        let mut compared = ModelPair { without: &without.left[at], with: &with.left[at], floor: &floor }.compared();
        let mut saved = without.model.fit.prior() - with.model.fit.prior();
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
