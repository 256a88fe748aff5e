//! The covariance of a least-squares estimate whose errors are correlated in time.
//!
//! Jacobian and residual of a fit enter ([`LinearizedEstimate`]); an [`EstimateCovariance`] leaves. The errors of each
//! signal get an autoregressive (AR) model, and the covariance is the sandwich (J'J)^-1 J'SJ (J'J)^-1 with the
//! covariance S of these models.
//!
//! A fit absorbs slow errors into its parameters, so residuals are less correlated than errors. The models are
//! therefore found by restricted maximum likelihood, which uses only what no parameter can absorb. Sources: H. D.
//! Patterson, R. Thompson, Biometrika 58 (1971) 545; the order by G. Schwarz, Annals of Statistics 6 (1978) 461;
//! degrees of freedom by F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110.

use super::autoregression::{self, longer};
use super::quasi_newton::{bend, descend, slopes};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::ops::Range;

/// The residuals of one signal along one recording.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualSeries {
    /// Index of the recording.
    pub recording: usize,
    /// Index of the signal.
    pub signal: usize,
    /// Rows of the residual vector, in the order of time.
    pub rows: Range<usize>,
}

/// A weighted least-squares estimate of n unknowns.
#[derive(Clone, Copy, Debug)]
pub struct LinearizedEstimate<'a> {
    /// Derivatives of the residual, one column for each unknown. Rows of data come first, priors and conditions follow.
    pub jacobian: &'a DMatrix<f64>,
    /// The residual: (model minus measurement) over the standard deviation used as weight.
    pub residual: &'a DVector<f64>,
    /// The rows of data, by recording and signal.
    pub series: &'a [ResidualSeries],
}

impl LinearizedEstimate<'_> {
    /// Number of rows of data.
    fn data(&self) -> usize {
        self.series.iter().map(|s| s.rows.end).max().unwrap_or(0)
    }
}

/// The covariance of the unknowns of a fit.
pub struct EstimateCovariance<'a> {
    /// n by n, corrected for correlated errors; infinite where the data carry no information.
    pub covariance: DMatrix<f64>,
    /// n by n, for white errors as large as their weights say: (J'J)^-1.
    pub plain: DMatrix<f64>,
    /// The models of the errors; `None` where no data are left to find any.
    models: Option<NoiseModels<'a>>,
}

/// Models of the errors at their maximum of likelihood.
struct NoiseModels<'a> {
    /// The errors and sensitivities of all signals.
    colour: ColouredNoise<'a>,
    /// The models' parameters, signal after signal.
    at: Vec<f64>,
    /// The amount added to the diagonal of J'J.
    small: f64,
}

impl EstimateCovariance<'_> {
    /// For each unknown the degrees of freedom of its variance; infinite without models. For white errors it is about
    /// the number of samples.
    pub fn degrees(&self) -> Vec<f64> {
        let Some(NoiseModels { colour, at, small }) = &self.models else {
            return vec![f64::INFINITY; self.plain.nrows()];
        };
        let variances = |at: &[f64]| (&self.plain * colour.scores(at) * &self.plain).diagonal();
        colour.degrees(at, *small, variances)
    }
}

/// Highest order of a model.
const ORDER: usize = 12;
/// Smallest number of samples beyond those that the unknowns can fit exactly.
const LEFT_OVER: f64 = 0.5;
/// A variance of weighted errors up to this is rounding: the data are exact.
const NOTHING: f64 = 1e-12;
/// Largest partial autocorrelation of the first guess.
const NEARLY_ONE: f64 = 0.98;
/// Step of differences by the models' parameters, which are of the order of 1.
const STEP: f64 = 1e-3;

/// Computes the covariance of an estimate with correlated errors.
pub fn spread(estimate: LinearizedEstimate<'_>) -> EstimateCovariance<'_> {
    let (jacobian, unknowns) = (estimate.jacobian, estimate.jacobian.ncols());
    let mut information = jacobian.tr_mul(jacobian);
    // the rows of data alone: conditions between pieces weigh much more
    let data = estimate.data();
    let largest = jacobian.rows(0, data).column_iter().map(|c| c.norm_squared()).fold(f64::MIN_POSITIVE, f64::max);
    // Keeps the matrix invertible for unknowns without influence, which thus get a huge variance.
    let small = 1e-12 * largest;
    (0..unknowns).for_each(|j| information[(j, j)] += small);
    let nothing = || DMatrix::from_element(unknowns, unknowns, f64::INFINITY);
    let Some(plain) = information.cholesky().map(|c| c.inverse()) else {
        return EstimateCovariance { covariance: nothing(), plain: nothing(), models: None };
    };
    // The trace of the hat matrix: how many samples the unknowns alone can fit. Without more of them nothing is known
    // about the size of the errors.
    let met = jacobian.rows(0, data).row_iter().map(|row| (row * &plain).dot(&row)).sum::<f64>();
    if data as f64 - met < LEFT_OVER {
        return EstimateCovariance { covariance: nothing(), plain, models: None };
    }
    let colour = ColouredNoise::new(estimate);
    let at = colour.found(small);
    let mut covariance = &plain * colour.scores(&at) * &plain;
    widen(&mut covariance, &between_recordings(estimate, &plain));
    EstimateCovariance { covariance, plain, models: Some(NoiseModels { colour, at, small }) }
}

/// Variances of the unknowns from the contradictions between recordings, which no model within one recording sees.
///
/// It is the spread of the recordings' scores (K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986) 13); zero for a single
/// recording.
fn between_recordings(estimate: LinearizedEstimate<'_>, plain: &DMatrix<f64>) -> DVector<f64> {
    let mut scores: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
    for s in estimate.series {
        let (rows, errors) = (&s.rows, estimate.residual.rows(s.rows.start, s.rows.len()));
        let score = estimate.jacobian.rows(rows.start, rows.len()).tr_mul(&errors);
        *scores.entry(s.recording).or_insert_with(|| DVector::zeros(plain.nrows())) += score;
    }
    let mut variances = DVector::zeros(plain.nrows());
    if scores.len() < 2 {
        return variances;
    }
    let count = scores.len() as f64;
    let mean = scores.values().fold(DVector::zeros(plain.nrows()), |sum, s| sum + s) / count;
    for score in scores.values() {
        let moved = plain * (score - &mean);
        variances += moved.component_mul(&moved) * (count / (count - 1.0));
    }
    variances
}

/// Raises the variances of a covariance to at least `variances`; correlations stay the same.
fn widen(covariance: &mut DMatrix<f64>, variances: &DVector<f64>) {
    let factor = |i: usize| (variances[i] / covariance[(i, i)].max(f64::MIN_POSITIVE)).sqrt().max(1.0);
    let factors: Vec<f64> = (0..variances.len()).map(factor).collect();
    for (i, f) in factors.iter().enumerate().filter(|(_, f)| **f > 1.0) {
        covariance.row_mut(i).scale_mut(*f);
        covariance.column_mut(i).scale_mut(*f);
    }
}

/// The errors of all signals with their sensitivities.
struct ColouredNoise<'a> {
    /// The estimate that the errors belong to.
    estimate: LinearizedEstimate<'a>,
    /// One entry for each signal whose errors are not zero.
    signals: Vec<LaggedProducts>,
    /// X'X of the rows after the data, where X holds their sensitivities and residuals.
    known: DMatrix<f64>,
    /// J'J of these rows: their part of the spread of the scores.
    sure: DMatrix<f64>,
}

/// The errors of one signal, as sums of products of shifted rows. With these the cost of the likelihood does not depend
/// on the length of the recordings.
struct LaggedProducts {
    /// The rows of each recording.
    ranges: Vec<Range<usize>>,
    /// Order of the model.
    order: usize,
    /// First guess: partial autocorrelations as hyperbolic angles, then the logarithm of the prediction error's
    /// deviation.
    guess: Vec<f64>,
    /// The first `order` rows of each recording.
    heads: Vec<DMatrix<f64>>,
    /// For shifts i and k the sum over the later rows t of x(t-i) x(t-i-k)'.
    lagged: Vec<Vec<DMatrix<f64>>>,
    /// Number of rows of all recordings.
    rows: usize,
    /// Number of rows of the longest recording.
    longest: usize,
}

impl<'a> ColouredNoise<'a> {
    /// Sums up the rows of each signal.
    fn new(estimate: LinearizedEstimate<'a>) -> ColouredNoise<'a> {
        let (data, rows) = (estimate.data(), estimate.jacobian.nrows());
        let with_errors = beside(estimate, data..rows);
        let own = estimate.jacobian.rows(data, rows - data);
        let of = |k: usize| estimate.series.iter().filter(move |s| s.signal == k && !s.rows.is_empty());
        let count = estimate.series.iter().map(|s| s.signal + 1).max().unwrap_or(0);
        let signals = (0..count).filter_map(|k| LaggedProducts::new(of(k), estimate));
        ColouredNoise {
            signals: signals.collect(),
            known: with_errors.tr_mul(&with_errors),
            sure: own.tr_mul(&own),
            estimate,
        }
    }

    /// Each signal with its part of the models' parameters: `order` angles and a logarithm.
    fn each<'p>(&self, at: &'p [f64]) -> impl Iterator<Item = (&LaggedProducts, &'p [f64])> {
        let mut rest = at;
        self.signals.iter().map(move |s| {
            let (own, others) = rest.split_at(s.order + 1);
            rest = others;
            (s, own)
        })
    }

    /// The negative logarithm of the restricted likelihood, without its constant; infinite where a model is not
    /// stationary.
    fn badness(&self, at: &[f64], small: f64) -> f64 {
        let n = self.estimate.jacobian.ncols();
        let mut squares = self.known.clone();
        let mut size = 0.0;
        for (signal, at) in self.each(at) {
            let Some(filter) = WhiteningFilter::new(at, signal.longest) else { return f64::INFINITY };
            size += signal.squares(&filter, &mut squares);
        }
        let mut information = squares.view((0, 0), (n, n)).into_owned();
        (0..n).for_each(|j| information[(j, j)] += small);
        let Some(factor) = information.cholesky() else { return f64::INFINITY };
        let slope = squares.view((0, n), (n, 1)).into_owned();
        // The part of the whitened residual that the unknowns explain is removed; ln det of the information is the
        // restriction of the likelihood.
        let explained = factor.l().solve_lower_triangular(&slope).map_or(0.0, |v| v.norm_squared());
        let volume = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        0.5 * (size + squares[(n, n)] - explained + volume)
    }

    /// The parameters of maximum restricted likelihood.
    fn found(&self, small: f64) -> Vec<f64> {
        let guess: Vec<f64> = self.signals.iter().flat_map(|s| s.guess.iter().copied()).collect();
        descend(&mut |at| self.badness(at, small), &guess, STEP)
    }

    /// J'SJ: the covariance of the scores, with the covariance S of the models.
    fn scores(&self, at: &[f64]) -> DMatrix<f64> {
        let mut spread = self.sure.clone();
        for (signal, at) in self.each(at) {
            let Some(filter) = WhiteningFilter::new(at, signal.longest) else { continue };
            for range in &signal.ranges {
                let rows = filter.backwards(self.estimate.jacobian.rows(range.start, range.len()).into_owned());
                spread += rows.tr_mul(&rows);
            }
        }
        spread
    }

    /// Satterthwaite's degrees of freedom: twice the square of a variance over the variance of this variance.
    ///
    /// The latter comes from the uncertainty of the models, by the delta method on logarithms of variances.
    fn degrees(&self, at: &[f64], small: f64, mut variances: impl FnMut(&[f64]) -> DVector<f64>) -> Vec<f64> {
        let endless = vec![f64::INFINITY; self.estimate.jacobian.ncols()];
        let Some(curvature) = bend(&mut |at| self.badness(at, small), at, STEP).cholesky() else { return endless };
        let logarithms = slopes(&mut |at| variances(at).map(|v| v.max(f64::MIN_POSITIVE).ln()), at, STEP);
        let one = |row: nalgebra::RowDVector<f64>| {
            let spread = row.dot(&curvature.solve(&row.transpose()).transpose());
            (2.0 / spread).max(1.0)
        };
        logarithms.row_iter().map(|row| one(row.into_owned())).collect()
    }
}

/// Sensitivities and residual of some rows side by side, n + 1 columns.
fn beside(estimate: LinearizedEstimate<'_>, rows: Range<usize>) -> DMatrix<f64> {
    let n = estimate.jacobian.ncols();
    DMatrix::from_fn(rows.len(), n + 1, |t, j| {
        let row = rows.start + t;
        if j < n { estimate.jacobian[(row, j)] } else { estimate.residual[row] }
    })
}

impl LaggedProducts {
    /// Sums up the rows of one signal. `None` where it has no rows, or where its errors are zero.
    fn new<'s>(
        series: impl Iterator<Item = &'s ResidualSeries>,
        estimate: LinearizedEstimate<'_>,
    ) -> Option<LaggedProducts> {
        let ranges: Vec<Range<usize>> = series.map(|s| s.rows.clone()).collect();
        let rows: usize = ranges.iter().map(ExactSizeIterator::len).sum();
        let shortest = ranges.iter().map(ExactSizeIterator::len).min()?;
        let errors: Vec<&[f64]> = ranges.iter().map(|r| &estimate.residual.as_slice()[r.clone()]).collect();
        // An order above an eighth of the shortest recording could not be estimated.
        let guess = chosen(&errors, ORDER.min(shortest / 8))?;
        let order = guess.len() - 1;
        let columns = estimate.jacobian.ncols() + 1;
        let mut lagged: Vec<Vec<DMatrix<f64>>> =
            (0..=order).map(|i| vec![DMatrix::zeros(columns, columns); order + 1 - i]).collect();
        let mut heads = Vec::new();
        for range in &ranges {
            let x = beside(estimate, range.clone());
            let later = x.nrows() - order;
            for (i, row) in lagged.iter_mut().enumerate() {
                for (k, sum) in row.iter_mut().enumerate() {
                    let (near, far) = (x.rows(order - i, later), x.rows(order - i - k, later));
                    *sum += near.tr_mul(&far);
                }
            }
            heads.push(x.rows(0, order).into_owned());
        }
        let longest = ranges.iter().map(ExactSizeIterator::len).max()?;
        Some(LaggedProducts { ranges, order, guess, heads, lagged, rows, longest })
    }

    /// Adds X'X of the whitened rows to `squares`; returns the logarithm of the determinant of the errors' covariance.
    fn squares(&self, filter: &WhiteningFilter, squares: &mut DMatrix<f64>) -> f64 {
        let weight = |i: usize| if i == 0 { 1.0 } else { -filter.last()[i - 1] };
        let scale = filter.deviation.powi(-2);
        for (i, row) in self.lagged.iter().enumerate() {
            for (k, sum) in row.iter().enumerate() {
                let factor = scale * weight(i) * weight(i + k);
                *squares += factor * sum;
                if k > 0 {
                    *squares += factor * sum.transpose();
                }
            }
        }
        for head in &self.heads {
            let white = filter.forwards(head.clone());
            *squares += white.tr_mul(&white);
        }
        let first: f64 = filter.excess[..self.order].iter().map(|v| v.ln()).sum();
        2.0 * self.rows as f64 * filter.deviation.ln() + first * self.heads.len() as f64
    }
}

/// The model of least Schwarz criterion up to order `most`: its partial autocorrelations as hyperbolic angles, then the
/// logarithm of the deviation. `None` where all errors are zero.
fn chosen(errors: &[&[f64]], most: usize) -> Option<Vec<f64>> {
    let rows: usize = errors.iter().map(|e| e.len()).sum();
    let (power, orders) = autoregression::orders(errors, most, NEARLY_ONE);
    if power.is_nan() || power <= NOTHING {
        return None;
    }
    let criterion = |power: f64, order: usize| rows as f64 * power.ln() + order as f64 * (rows as f64).ln();
    let mut partial = Vec::new();
    let mut best = (criterion(power, 0), vec![0.5 * power.ln()]);
    for (before, o) in orders.iter().enumerate() {
        // Angles are unbounded, so the search for the maximum needs no bounds to stay stationary.
        partial.push(o.partial.atanh());
        let now = criterion(o.power, before + 1);
        if now < best.0 {
            best = (now, partial.iter().copied().chain([0.5 * o.power.ln()]).collect());
        }
    }
    Some(best.1)
}

/// The whitening filter of an autoregressive model.
struct WhiteningFilter {
    /// Standard deviation of the prediction error.
    deviation: f64,
    /// Coefficients of the predictions from 0, 1, 2, .. rows before.
    coefficients: Vec<Vec<f64>>,
    /// For each of the first rows the ratio of its prediction variance to that of later rows; the last entry is 1.
    excess: Vec<f64>,
}

impl WhiteningFilter {
    /// The filter of a model. `None` where its partial autocorrelations are so close to 1 that errors would be
    /// correlated for longer than the longest recording.
    fn new(at: &[f64], longest: usize) -> Option<WhiteningFilter> {
        let (deviation, angles) = at.split_last()?;
        let partial: Vec<f64> = angles.iter().map(|a| a.tanh()).collect();
        let limit = 1.0 - 1.0 / longest as f64;
        if partial.iter().any(|p| p.abs() > limit) || deviation.abs() > 300.0 {
            return None;
        }
        // Each order that is missing at the beginning enlarges the prediction variance by 1/(1 - p^2).
        let mut excess = vec![1.0];
        partial.iter().rev().for_each(|p| excess.push(excess[excess.len() - 1] / (1.0 - p * p)));
        excess.reverse();
        let mut coefficients = vec![Vec::new()];
        partial.iter().for_each(|p| coefficients.push(longer(&coefficients[coefficients.len() - 1], *p)));
        Some(WhiteningFilter { deviation: deviation.exp(), coefficients, excess })
    }

    /// The coefficients of the full order.
    fn last(&self) -> &[f64] {
        &self.coefficients[self.coefficients.len() - 1]
    }

    /// The whitened rows of a series that starts at its first row.
    fn forwards(&self, x: DMatrix<f64>) -> DMatrix<f64> {
        let mut white = x.clone();
        for t in 0..x.nrows() {
            let k = t.min(self.excess.len() - 1);
            for (i, a) in self.coefficients[k].iter().enumerate() {
                let explained = x.row(t - 1 - i) * *a;
                white.set_row(t, &(white.row(t) - explained));
            }
            let scaled = white.row(t) / (self.deviation * self.excess[k].sqrt());
            white.set_row(t, &scaled);
        }
        white
    }

    /// Rows Y with Y'Y = X'SX for the covariance S of the errors: the inverse of the transposed whitening.
    fn backwards(&self, x: DMatrix<f64>) -> DMatrix<f64> {
        let (rows, columns) = x.shape();
        let last = self.excess.len() - 1;
        let mut out = x;
        for j in 0..columns {
            let mut column = out.column_mut(j);
            for t in (0..rows).rev() {
                let k = t.min(last);
                let undone = column[t] * self.deviation * self.excess[k].sqrt();
                // This row contributes to the predictions from the rows before it.
                for (i, a) in self.coefficients[k].iter().enumerate() {
                    column[t - 1 - i] += a * column[t];
                }
                column[t] = undone;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backwards_undoes_the_transposed_forwards() {
        let filter = WhiteningFilter::new(&[0.9, -0.4, 0.3], 100).expect("a model");
        let eye = DMatrix::<f64>::identity(9, 9);
        let white = filter.forwards(eye.clone());
        let undone = filter.backwards(eye);
        assert!((white.transpose() * undone - DMatrix::identity(9, 9)).amax() < 1e-12);
    }

    /// A first-order model: variance sigma^2/(1 - phi^2), neighbours correlated by phi.
    #[test]
    fn covariance_of_a_first_order_model() {
        let phi = 0.8f64;
        let filter = WhiteningFilter::new(&[phi.atanh(), 2f64.ln()], 100).expect("a model");
        let rows = filter.backwards(DMatrix::identity(5, 5));
        let covariance = rows.tr_mul(&rows);
        for i in 0..5usize {
            for j in 0..5 {
                let exact = 4.0 / (1.0 - phi * phi) * phi.powi(i.abs_diff(j) as i32);
                assert!((covariance[(i, j)] - exact).abs() < 1e-12, "{covariance}");
            }
        }
    }

    #[test]
    fn orders_by_the_criterion() {
        let mut seed = 5u64;
        let mut roll = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let white: Vec<f64> = (0..500).map(|_| roll()).collect();
        assert_eq!(chosen(&[&white], 10).expect("errors").len(), 1);
        let mut second = vec![0.0, 0.0];
        white.iter().for_each(|w| second.push(1.2 * second[second.len() - 1] - 0.6 * second[second.len() - 2] + w));
        let model = chosen(&[&second], 10).expect("errors");
        // the last partial autocorrelation is the last coefficient
        assert!(model.len() == 3 && (model[1].tanh() + 0.6).abs() < 0.1, "{model:?}");
        assert!(chosen(&[&[0.0; 50]], 5).is_none());
    }
}
