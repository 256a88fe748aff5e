//! One step of a linear system `x' = A x`: the matrix exponential and its first two integrals, with fast small
//! products.
//!
//! Called by `simulation` for every step, and by `candidate` for sums of products. Scaling and squaring after Higham,
//! Functions of Matrices, 2008, ch. 10, of a balanced matrix. Results are reused while matrix and step hardly change.

use nalgebra::{DMatrix, DVector};

/// Products with at most so many terms per sum use plain loops instead of a packed `gemm`.
const LARGE: usize = 64;
/// Taylor coefficients 1/(k + 1)! of phi(z) = (e^z - 1)/z. Below a norm of [`SMALL`] the error is under 1e-8.
const COEFFICIENTS: [f64; 7] = [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
/// Largest norm at which the polynomial is used; larger matrices are halved until they fit.
const SMALL: f64 = 0.3;
/// Relative difference up to which two steps count as equally long.
const SAME_LENGTH: f64 = 1e-9;
/// Change of matrix times step up to which the exponential of the last matrix is reused. The error that this leaves in
/// the change of a step is less than a sensor shows of it.
const SAME_SYSTEM: f64 = 3e-4;
/// Most halvings. Beyond, the step is far longer than any time constant that matters.
const MOST_HALVINGS: i32 = 40;

/// Whether two steps count as equally long. Time stamps are rounded, so equal steps differ slightly.
pub fn as_long(h: f64, other: f64) -> bool {
    (h - other).abs() <= SAME_LENGTH * h
}

/// `out = a b + beta out`. Small matrices avoid the packing that only pays for large ones.
pub fn multiply(out: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>, beta: f64) {
    if a.ncols() > LARGE {
        out.gemm(1.0, a, b, beta);
    } else {
        product(out.as_mut_slice(), a, b.as_slice(), beta);
    }
}

/// `out = a x + beta out`.
pub fn apply(out: &mut DVector<f64>, a: &DMatrix<f64>, x: &DVector<f64>, beta: f64) {
    product(out.as_mut_slice(), a, x.as_slice(), beta);
}

/// `out = a b + beta out` on column-major slices.
fn product(out: &mut [f64], a: &DMatrix<f64>, b: &[f64], beta: f64) {
    let (rows, inner) = a.shape();
    // not multiplied by zero: `out` may hold NaN
    if beta == 0.0 {
        out.fill(0.0);
    } else if beta != 1.0 {
        out.iter_mut().for_each(|v| *v *= beta);
    }
    dispatch(MatrixProduct { out, a: a.as_slice(), b, rows, inner, used: rows });
}

/// Runs a product with the widest instruction set of this processor. Empty matrices are left out.
fn dispatch(product: MatrixProduct) {
    if product.rows > 0 && product.inner > 0 {
        pulp::Arch::new().dispatch(product);
    }
}

/// `out += a b` in the first `used` rows. The body is compiled for every instruction set and chosen at run time.
struct MatrixProduct<'a> {
    /// Column-major, `rows` rows.
    out: &'a mut [f64],
    /// Column-major, `rows` by `inner`.
    a: &'a [f64],
    /// Column-major, `inner` rows.
    b: &'a [f64],
    /// Rows of `out` and `a`.
    rows: usize,
    /// Columns of `a`, rows of `b`.
    inner: usize,
    /// Rows that are computed.
    used: usize,
}

// A trait implementation instead of a closure: only its body is compiled with the wide registers enabled.
impl pulp::WithSimd for MatrixProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        add_product(self);
    }
}

/// `out += factor x y'`, column by column.
pub fn add_outer(out: &mut DMatrix<f64>, factor: f64, x: &[f64], y: &[f64]) {
    if !x.is_empty() {
        pulp::Arch::new().dispatch(OuterProduct { out: out.as_mut_slice(), factor, x, y });
    }
}

/// `out += factor x y'` for the dispatch by instruction set.
struct OuterProduct<'a> {
    /// Column-major, as many rows as `x` has values.
    out: &'a mut [f64],
    /// Factor of the product.
    factor: f64,
    /// Left vector: the rows of `out`.
    x: &'a [f64],
    /// Right vector: the columns of `out`.
    y: &'a [f64],
}

impl pulp::WithSimd for OuterProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        // the factor goes into one scalar per column, so that the inner loop is one multiplication and addition
        for (column, y) in self.out.chunks_exact_mut(self.x.len()).zip(self.y) {
            let factor = self.factor * y;
            column.iter_mut().zip(self.x).for_each(|(v, x)| *v += factor * x);
        }
    }
}

/// `out += a b` in bands of eight rows and one band of what remains, whose sums stay in registers.
#[inline(always)]
fn add_product(product: MatrixProduct) {
    let MatrixProduct { out, a, b, rows, inner, used } = product;
    for (to, factors) in out.chunks_exact_mut(rows).zip(b.chunks_exact(inner)) {
        let mut row = 0;
        while row + 8 <= used {
            add_band::<8>(to, a, factors, rows, row);
            row += 8;
        }
        // the size of the last band must be a constant too, so that its loop is unrolled
        match used - row {
            0 => {}
            1 => add_band::<1>(to, a, factors, rows, row),
            2 => add_band::<2>(to, a, factors, rows, row),
            3 => add_band::<3>(to, a, factors, rows, row),
            4 => add_band::<4>(to, a, factors, rows, row),
            5 => add_band::<5>(to, a, factors, rows, row),
            6 => add_band::<6>(to, a, factors, rows, row),
            _ => add_band::<7>(to, a, factors, rows, row),
        }
    }
}

/// One column of `out += a b` for `N` rows from `row`.
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

/// The exponential of the last matrix with its integrals, and work space. All matrices are square, states by states.
#[derive(Clone, Debug)]
pub struct MatrixExponential {
    /// Scaled and balanced matrix `h A / 2^k`.
    small: DMatrix<f64>,
    /// Work space.
    next: DMatrix<f64>,
    /// Work space of the polynomial.
    high: DMatrix<f64>,
    /// Units of the states in which they drive each other about as strongly as they are driven; powers of two.
    balance: Vec<f64>,
    /// Matrix that the results belong to.
    pub known: DMatrix<f64>,
    /// Step that the results belong to, s; 0 before the first one.
    length: f64,
    /// exp(h A).
    pub transition: DMatrix<f64>,
    /// Integral of exp(s A) over s from 0 to h.
    pub integral: DMatrix<f64>,
    /// Integral of the integral: times the growth of a rate it gives what that adds over the step.
    pub twice: DMatrix<f64>,
}

impl MatrixExponential {
    /// For a number of states.
    pub fn new(states: usize) -> Self {
        let zeros = || DMatrix::zeros(states, states);
        MatrixExponential {
            small: zeros(),
            next: zeros(),
            high: zeros(),
            balance: vec![1.0; states],
            known: zeros(),
            length: 0.0,
            transition: zeros(),
            integral: zeros(),
            twice: zeros(),
        }
    }

    /// Computes transition and integrals of `a` over the step `h` in s, or keeps those of the last call.
    pub fn compute(&mut self, a: &DMatrix<f64>, h: f64) {
        if !self.is_known(a, h) {
            self.balanced(a);
            self.scale_and_square(a, h);
            self.known.copy_from(a);
            self.length = h;
        }
    }

    /// Whether the last results may be reused: an equally long step, and columns that changed little in balanced units.
    fn is_known(&self, a: &DMatrix<f64>, h: f64) -> bool {
        let units = &self.balance;
        let moved = |j: usize| {
            let entry = |i: usize| (a[(i, j)] - self.known[(i, j)]).abs() * (units[j] / units[i]);
            h * (0..units.len()).map(entry).sum::<f64>()
        };
        as_long(h, self.length) && (0..units.len()).all(|j| moved(j) <= SAME_SYSTEM)
    }

    /// Improves the balance by one sweep over the states (Parlett, Reinsch, Numerische Mathematik 13, 1969).
    /// What comes from a state and what goes to it should be equal, since the norm is least then. Powers of two avoid
    /// rounding.
    fn balanced(&mut self, a: &DMatrix<f64>) {
        let n = self.balance.len();
        // one sweep per call is enough, because the balance of the last matrix is the start
        for i in 0..n {
            let (mut to, mut from) = (0.0, 0.0);
            for j in (0..n).filter(|j| *j != i) {
                let ratio = self.balance[j] / self.balance[i];
                to += a[(i, j)].abs() * ratio;
                from += a[(j, i)].abs() / ratio;
            }
            let wanted = (to / from).sqrt();
            if wanted.is_normal() && !(0.5..=2.0).contains(&wanted) {
                self.balance[i] *= wanted.log2().round().exp2();
            }
        }
    }

    /// Scaling and squaring (Higham, Functions of Matrices, 2008, ch. 10).
    /// The integral is h phi(h A) with phi(z) = (e^z - 1)/z, and phi(2 z) = (e^z + 1) phi(z)/2.
    /// The integral of the integral is h^2 phi_2(h A) with phi_2(z) = (phi(z) - 1)/z.
    fn scale_and_square(&mut self, a: &DMatrix<f64>, h: f64) {
        let MatrixExponential { small, next, high, balance: units, transition, integral, twice, .. } = self;
        let n = small.nrows();
        (0..n).for_each(|j| (0..n).for_each(|i| small[(i, j)] = a[(i, j)] * (units[j] / units[i])));
        let norm = h * small.column_iter().map(|c| c.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let halvings = if norm > SMALL { ((norm / SMALL).log2().ceil() as i32).min(MOST_HALVINGS) } else { 0 };
        let scale = h / 2.0_f64.powi(halvings);
        *small *= scale;
        multiply(next, small, small, 0.0);
        multiply(transition, small, next, 0.0);
        let powers = MatrixPowers { x: small, square: next, cube: transition };
        // at this point `integral` is phi and `twice` is phi_2 of the scaled matrix, without their factors of time
        powers.series(integral, high, &COEFFICIENTS[..7]);
        powers.series(twice, high, &COEFFICIENTS[1..]);
        *twice *= scale * scale;
        // e^z = 1 + z phi(z) takes one product more instead of a polynomial of its own
        transition.fill_with_identity();
        multiply(transition, small, integral, 1.0);
        *integral *= scale;
        let mut length = scale;
        for _ in 0..halvings {
            // the double integral over 2 s = (exp(s A) + 1) that over s + s times the integral over s
            next.copy_from(twice);
            multiply(next, transition, twice, 1.0);
            next.zip_apply(integral, |n, a| *n += length * a);
            std::mem::swap(twice, next);
            length *= 2.0;
            // this update needs the transition over s, so the transition is squared last
            next.copy_from(integral);
            multiply(next, transition, integral, 1.0);
            std::mem::swap(integral, next);
            multiply(next, transition, transition, 0.0);
            std::mem::swap(transition, next);
        }
        // back from balanced units
        for matrix in [transition, integral, twice] {
            (0..n).for_each(|j| (0..n).for_each(|i| matrix[(i, j)] *= units[i] / units[j]));
        }
    }
}

/// The first three powers of a matrix.
struct MatrixPowers<'a> {
    /// The matrix X.
    x: &'a DMatrix<f64>,
    /// X squared.
    square: &'a DMatrix<f64>,
    /// X to the third power.
    cube: &'a DMatrix<f64>,
}

impl MatrixPowers<'_> {
    /// c0 + c1 X + ... up to degree six, as p(X) + X^3 q(X) with quadratic p and q (Paterson, Stockmeyer, 1973): one
    /// product. `q` is work space.
    fn series(&self, out: &mut DMatrix<f64>, q: &mut DMatrix<f64>, c: &[f64]) {
        let sixth = c.get(6).copied().unwrap_or(0.0);
        q.copy_from(self.x);
        q.zip_apply(self.square, |q, s| *q = c[4] * *q + c[5] * s);
        if sixth != 0.0 {
            q.zip_apply(self.cube, |q, s| *q += sixth * s);
        }
        out.copy_from(self.x);
        out.zip_apply(self.square, |p, s| *p = c[1] * *p + c[2] * s);
        for i in 0..out.nrows() {
            q[(i, i)] += c[3];
            out[(i, i)] += c[0];
        }
        multiply(out, self.cube, q, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillator_over_a_long_step() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let mut e = MatrixExponential::new(2);
        let h = 3.0_f64;
        e.compute(&a, h);
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
        let mut e = MatrixExponential::new(2);
        e.compute(&a, 1e-3);
        assert!(e.transition.iter().all(|v| v.is_finite()));
        assert!((e.integral[(0, 0)] - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn a_ramp_drives_slow_and_fast_lags() {
        // x' = -x/T + r t has x = r T (t - T (1 - exp(-t/T)))
        let h = 0.5_f64;
        for lag in [1e-4, 0.01, 0.5, 30.0] {
            let mut e = MatrixExponential::new(1);
            e.compute(&DMatrix::from_element(1, 1, -1.0 / lag), h);
            let exact = 2.0 * lag * (h + lag * (-h / lag).exp_m1());
            let ramped = 2.0 * e.twice[(0, 0)];
            assert!((ramped - exact).abs() < 1e-6 * exact, "{lag}: {ramped} {exact}");
        }
    }

    /// The states in units a million apart: balanced, the norm is what it was, and so is the exponential.
    #[test]
    fn units_make_no_difference() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let scaled = DMatrix::from_fn(2, 2, |i, j| a[(i, j)] * 1e6_f64.powi(j as i32 - i as i32));
        let (mut own, mut other) = (MatrixExponential::new(2), MatrixExponential::new(2));
        // the balance goes on from step to step
        (0..4).for_each(|i| other.compute(&scaled, 0.3 + 0.01 * f64::from(i)));
        own.compute(&a, 0.33);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let back = 1e6_f64.powi(i as i32 - j as i32);
            assert!((own.transition[(i, j)] - back * other.transition[(i, j)]).abs() < 1e-7, "{i} {j}");
            assert!((own.integral[(i, j)] - back * other.integral[(i, j)]).abs() < 1e-7, "{i} {j}");
        }
        assert!(other.balance[0] / other.balance[1] > 1e4, "{:?}", other.balance);
    }

    #[test]
    fn a_system_is_taken_over_while_it_hardly_moves() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let (mut e, mut fresh) = (MatrixExponential::new(2), MatrixExponential::new(2));
        e.compute(&a, 1e-3);
        let first = e.transition.clone();
        e.compute(&(&a * 1.001), 1e-3);
        assert_eq!(e.transition, first);
        // small steps away from it add up
        e.compute(&(&a * 1.1), 1e-3);
        fresh.compute(&(&a * 1.1), 1e-3);
        assert_eq!(e.transition, fresh.transition);
        e.compute(&(&a * 1.1), 2e-3);
        assert!((&e.transition - &fresh.transition).amax() > 1e-2);
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
            let x = DVector::from_fn(inner, |i, _| i as f64 - 1.5);
            let mut out = DVector::from_element(rows, 1.0);
            apply(&mut out, &a, &x, 2.0);
            assert!((&out - (&a * &x).add_scalar(2.0)).amax() < 1e-12);
            let mut outer = a.clone();
            add_outer(&mut outer, 3.0, out.as_slice(), x.as_slice());
            assert!((outer - (&a + 3.0 * &out * x.transpose())).amax() < 1e-12 * out.amax() * x.amax());
        }
    }
}
