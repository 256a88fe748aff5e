//! One step of a linear system: the matrix exponential and its integral.

use nalgebra::{DMatrix, DVector};

/// Products with up to so many terms a sum are done by plain loops.
const LARGE: usize = 64;
/// Taylor coefficients 1/(k + 1)! of phi; with arguments below [`SMALL`] the error is under 1e-8.
const COEFFICIENTS: [f64; 7] = [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
/// The largest norm at which the polynomial is used; larger ones are halved until they fit.
const SMALL: f64 = 0.3;
/// Halvings at most: beyond, the step is far longer than any time constant that matters.
const MOST_HALVINGS: i32 = 40;

/// `out = a b + beta out` without the packing that pays for large matrices only.
pub fn multiply(out: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>, beta: f64) {
    let (rows, inner) = a.shape();
    if inner > LARGE {
        out.gemm(1.0, a, b, beta);
        return;
    }
    let (out, a, b) = (out.as_mut_slice(), a.as_slice(), b.as_slice());
    if beta == 0.0 {
        out.fill(0.0);
    } else if beta != 1.0 {
        out.iter_mut().for_each(|v| *v *= beta);
    }
    if rows == 0 || inner == 0 {
        return;
    }
    // compiled once for every instruction set; the best one is chosen where it runs
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || add_product(out, a, b, rows, inner),
    );
}

/// `out += a b` in bands of eight rows, whose sums stay in registers.
#[inline(always)]
fn add_product(out: &mut [f64], a: &[f64], b: &[f64], rows: usize, inner: usize) {
    for (to, factors) in out.chunks_exact_mut(rows).zip(b.chunks_exact(inner)) {
        let mut row = 0;
        while row + 8 <= rows {
            add_band::<8>(to, a, factors, rows, row);
            row += 8;
        }
        if row + 4 <= rows {
            add_band::<4>(to, a, factors, rows, row);
            row += 4;
        }
        while row < rows {
            add_band::<1>(to, a, factors, rows, row);
            row += 1;
        }
    }
}

#[inline(always)]
fn add_band<const N: usize>(to: &mut [f64], a: &[f64], factors: &[f64], rows: usize, row: usize) {
    let mut sums = [0.0; N];
    for (column, &factor) in a.chunks_exact(rows).zip(factors) {
        let from = &column[row..row + N];
        for i in 0..N {
            sums[i] += from[i] * factor;
        }
    }
    to[row..row + N].iter_mut().zip(sums).for_each(|(v, sum)| *v += sum);
}

/// How fast x' changes because inputs do; their columns are the last ones of d x' / d (theta, u).
pub fn ramp(b: &DMatrix<f64>, slope: &[f64]) -> DVector<f64> {
    b.columns(b.ncols() - slope.len(), slope.len()) * DVector::from_column_slice(slope)
}

/// Work space for systems of one size: the first states are coupled as they like, the last ones (sources) only decay,
/// each by itself, and drive the first.
#[derive(Clone, Debug)]
pub struct Exponential {
    small: DMatrix<f64>,
    next: DMatrix<f64>,
    high: DMatrix<f64>,
    power: DMatrix<f64>,
    area: DMatrix<f64>,
    moved: DVector<f64>,
    /// exp(h A).
    pub transition: DMatrix<f64>,
    /// The integral of exp(s A) over s from 0 to h.
    pub integral: DMatrix<f64>,
    /// What a rate that grows steadily adds over the step, of the coupled states.
    pub ramped: DVector<f64>,
}

impl Exponential {
    /// For `coupled` states and `decaying` sources behind them.
    pub fn new(coupled: usize, decaying: usize) -> Self {
        let zeros = || DMatrix::zeros(coupled, coupled);
        let n = coupled + decaying;
        let whole = || DMatrix::zeros(n, n);
        Exponential {
            small: zeros(),
            next: zeros(),
            high: zeros(),
            power: zeros(),
            area: zeros(),
            moved: DVector::zeros(coupled),
            ramped: DVector::zeros(coupled),
            transition: whole(),
            integral: whole(),
        }
    }

    /// Computes transition and integral from A, and what a rate that grows by `ramp` in a second adds. A source counts
    /// with its mean over the step, an error of the order of (h/tau)(h A)/12 of what it does to the states.
    pub fn compute(&mut self, a: &DMatrix<f64>, h: f64, ramp: Option<&DVector<f64>>) {
        let n = self.small.nrows();
        self.coupled(a, h, ramp);
        self.transition.view_mut((0, 0), (n, n)).copy_from(&self.power);
        self.integral.view_mut((0, 0), (n, n)).copy_from(&self.area);
        for j in n..a.nrows() {
            let rate = -a[(j, j)];
            let decayed = -(-rate * h).exp_m1();
            let mean = decayed / (rate * h);
            for i in 0..n {
                let driven: f64 = (0..n).map(|k| self.area[(i, k)] * a[(k, j)]).sum();
                self.transition[(i, j)] = driven * mean;
                self.integral[(i, j)] = driven * (1.0 - mean) / rate;
            }
            self.transition[(j, j)] = 1.0 - decayed;
            self.integral[(j, j)] = decayed / rate;
        }
    }

    /// Scaling and squaring (Higham, Functions of Matrices, 2008, ch. 10): the integral is h phi(h A) with
    /// phi(z) = (e^z - 1)/z, and phi(2 z) = (e^z + 1) phi(z)/2.
    fn coupled(&mut self, a: &DMatrix<f64>, h: f64, ramp: Option<&DVector<f64>>) {
        let Exponential { small, next, high, power, area, moved, ramped, .. } = self;
        let n = small.nrows();
        let a = a.view((0, 0), (n, n));
        let norm = h * (0..n).map(|j| a.column(j).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let halvings = if norm > SMALL { ((norm / SMALL).log2().ceil() as i32).min(MOST_HALVINGS) } else { 0 };
        let scale = h / 2.0_f64.powi(halvings);
        small.copy_from(&a);
        *small *= scale;
        // phi = p(X) + X^3 q(X), both quadratic (Paterson and Stockmeyer): three products for degree six
        let c = |k: usize| COEFFICIENTS[k];
        multiply(next, small, small, 0.0);
        multiply(power, small, next, 0.0);
        let (x, square, cube) = (&*small, &*next, &*power);
        high.copy_from(x);
        high.zip_apply(square, |h, s| *h = c(4) * *h + c(5) * s);
        high.zip_apply(cube, |h, q| *h += c(6) * q);
        area.copy_from(x);
        area.zip_apply(square, |h, s| *h = c(1) * *h + c(2) * s);
        for i in 0..n {
            high[(i, i)] += c(3);
            area[(i, i)] += c(0);
        }
        multiply(area, power, high, 1.0);
        power.fill_with_identity();
        multiply(power, small, area, 1.0);
        *area *= scale;
        ramped.fill(0.0);
        if let Some(ramp) = ramp {
            // h^2 (1/2 + X/6 + X^2/24 + ...) ramp, by Horner's rule
            for c in COEFFICIENTS[1..].iter().rev() {
                moved.copy_from(ramp);
                moved.gemv(1.0, small, ramped, *c);
                std::mem::swap(moved, ramped);
            }
            *ramped *= scale * scale;
        }
        let mut length = scale;
        for _ in 0..halvings {
            if let Some(ramp) = ramp {
                // the double integral over 2 s = (exp(s A) + 1) that over s + s times the integral over s
                moved.copy_from(ramped);
                moved.gemv(1.0, power, ramped, 1.0);
                moved.gemv(length, area, ramp, 1.0);
                std::mem::swap(moved, ramped);
                length *= 2.0;
            }
            // integral over 2 s = (exp(s A) + 1) integral over s
            next.copy_from(area);
            multiply(next, power, area, 1.0);
            std::mem::swap(area, next);
            multiply(next, power, power, 0.0);
            std::mem::swap(power, next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillator_over_a_long_step() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let mut e = Exponential::new(2, 0);
        let h = 3.0_f64;
        e.compute(&a, h, None);
        let w = (100.0_f64 - 1.0).sqrt();
        let decay = (-h).exp();
        let exact = decay * ((w * h).cos() + (w * h).sin() / w);
        assert!((e.transition[(0, 0)] - exact).abs() < 1e-7);
        // A integral = exp - 1
        let left = &a * &e.integral;
        let right = &e.transition - DMatrix::<f64>::identity(2, 2);
        assert!((left - right).norm() < 1e-6);
    }

    #[test]
    fn a_very_stiff_matrix_stays_finite() {
        let a = DMatrix::from_row_slice(2, 2, &[-1e9, 1.0, 0.0, -1.0]);
        let mut e = Exponential::new(2, 0);
        e.compute(&a, 1e-3, None);
        assert!(e.transition.iter().all(|v| v.is_finite()));
        assert!((e.integral[(0, 0)] - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn a_decaying_source_drives_a_lag() {
        // x' = -x/T + g s, s' = -s/tau
        let (lag, tau, g, h) = (0.002, 0.025, 3.0, 1e-3);
        let a = DMatrix::from_row_slice(2, 2, &[-1.0 / lag, g, 0.0, -1.0 / tau]);
        let (mut whole, mut parts) = (Exponential::new(2, 0), Exponential::new(1, 1));
        whole.compute(&a, h, None);
        parts.compute(&a, h, None);
        let size = whole.transition[(0, 1)].abs();
        assert!((&whole.transition - &parts.transition).amax() < 2e-3 * size);
        let size = whole.integral[(0, 1)].abs();
        assert!((&whole.integral - &parts.integral).amax() < 0.1 * size);
    }

    #[test]
    fn a_ramp_drives_slow_and_fast_lags() {
        // x' = -x/T + r t has x = r T (t - T (1 - exp(-t/T)))
        let h = 0.5_f64;
        for lag in [1e-4, 0.01, 0.5, 30.0] {
            let mut e = Exponential::new(1, 0);
            e.compute(&DMatrix::from_element(1, 1, -1.0 / lag), h, Some(&DVector::from_element(1, 2.0)));
            let exact = 2.0 * lag * (h + lag * (-h / lag).exp_m1());
            assert!((e.ramped[0] - exact).abs() < 1e-6 * exact, "{lag}: {} {exact}", e.ramped[0]);
        }
    }

    #[test]
    fn products_of_all_sizes() {
        for (rows, inner, columns) in [(1, 1, 1), (3, 5, 2), (8, 8, 3), (13, 9, 17), (70, 70, 2)] {
            let a = DMatrix::from_fn(rows, inner, |i, j| (i * 7 + j * 3) as f64 % 5.0 - 2.0);
            let b = DMatrix::from_fn(inner, columns, |i, j| (i * 11 + j * 2) as f64 % 7.0 - 3.0);
            let mut out = DMatrix::from_element(rows, columns, 1.0);
            multiply(&mut out, &a, &b, 2.0);
            let exact = &a * &b + DMatrix::from_element(rows, columns, 2.0);
            assert!((out - exact).amax() < 1e-12);
        }
    }
}
