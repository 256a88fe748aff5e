//! One step of a linear system: the matrix exponential and its integral.

use nalgebra::{DMatrix, DVector};

/// Products with up to so many terms a sum are done by plain loops.
const LARGE: usize = 64;
/// Taylor coefficients 1/(k + 1)! of phi; with arguments below [`SMALL`] the error is under 1e-8.
const COEFFICIENTS: [f64; 7] = [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
/// The largest norm at which the polynomial is used; larger ones are halved until they fit.
const SMALL: f64 = 0.3;
/// A step within so much of the last one's length is as long, and a system whose matrix times the step is so near to the
/// last one's has its exponential: what that leaves of a step's change is less than a sensor shows of it.
const SAME_LENGTH: f64 = 1e-9;
const SAME_SYSTEM: f64 = 3e-4;
/// Halvings at most: beyond, the step is far longer than any time constant that matters.
const MOST_HALVINGS: i32 = 40;

/// Whether a step is as long as another one: time stamps are rounded.
pub fn as_long(h: f64, other: f64) -> bool {
    (h - other).abs() <= SAME_LENGTH * h
}

/// `out = a b + beta out` without the packing that pays for large matrices only.
pub fn multiply(out: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>, beta: f64) {
    if a.ncols() > LARGE {
        out.gemm(1.0, a, b, beta);
    } else {
        product(out.as_mut_slice(), a, b.as_slice(), beta);
    }
}

/// `out = m a` with a transition: behind the coupled states, a row holds its diagonal only.
pub fn advance(out: &mut DMatrix<f64>, m: &DMatrix<f64>, coupled: usize, a: &DMatrix<f64>) {
    if m.ncols() > LARGE {
        return out.gemm(1.0, m, a, 0.0);
    }
    let rows = m.nrows();
    // a model without states has nothing to advance
    if rows == 0 {
        return;
    }
    for (to, from) in out.as_mut_slice().chunks_exact_mut(rows).zip(a.as_slice().chunks_exact(rows)) {
        to[..coupled].fill(0.0);
        (coupled..rows).for_each(|i| to[i] = m[(i, i)] * from[i]);
    }
    dispatch(Product { out: out.as_mut_slice(), a: m.as_slice(), b: a.as_slice(), rows, inner: rows, used: coupled });
}

/// `out = a m' + beta out` with the transposed transition, likewise.
pub fn advance_across(out: &mut DMatrix<f64>, a: &DMatrix<f64>, transposed: &DMatrix<f64>, coupled: usize, beta: f64) {
    if transposed.ncols() > LARGE {
        return out.gemm(1.0, a, transposed, beta);
    }
    let (rows, inner) = a.shape();
    let (some, others) = out.as_mut_slice().split_at_mut(coupled * rows);
    product(some, a, &transposed.as_slice()[..coupled * inner], beta);
    for (i, to) in others.chunks_exact_mut(rows.max(1)).enumerate() {
        let (j, m) = (coupled + i, transposed[(coupled + i, coupled + i)]);
        to.iter_mut().zip(a.column(j).iter()).for_each(|(to, a)| *to = m * a + beta * *to);
    }
}

/// `out = a x + beta out`.
pub fn apply(out: &mut DVector<f64>, a: &DMatrix<f64>, x: &DVector<f64>, beta: f64) {
    product(out.as_mut_slice(), a, x.as_slice(), beta);
}

fn product(out: &mut [f64], a: &DMatrix<f64>, b: &[f64], beta: f64) {
    let (rows, inner) = a.shape();
    if beta == 0.0 {
        out.fill(0.0);
    } else if beta != 1.0 {
        out.iter_mut().for_each(|v| *v *= beta);
    }
    dispatch(Product { out, a: a.as_slice(), b, rows, inner, used: rows });
}

fn dispatch(product: Product) {
    if product.rows > 0 && product.inner > 0 {
        pulp::Arch::new().dispatch(product);
    }
}

/// `out += a b` in the first rows, compiled once for every instruction set; the best one is chosen where it runs.
struct Product<'a> {
    out: &'a mut [f64],
    a: &'a [f64],
    b: &'a [f64],
    rows: usize,
    inner: usize,
    used: usize,
}

// what is no closure is compiled into the function that may use the wide registers
impl pulp::WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        add_product(self);
    }
}

/// `out += factor x y'`.
pub fn add_outer(out: &mut DMatrix<f64>, factor: f64, x: &[f64], y: &[f64]) {
    if !x.is_empty() {
        pulp::Arch::new().dispatch(Outer { out: out.as_mut_slice(), factor, x, y });
    }
}

/// `out += factor x y'`, likewise.
struct Outer<'a> {
    out: &'a mut [f64],
    factor: f64,
    x: &'a [f64],
    y: &'a [f64],
}

impl pulp::WithSimd for Outer<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (column, y) in self.out.chunks_exact_mut(self.x.len()).zip(self.y) {
            let factor = self.factor * y;
            column.iter_mut().zip(self.x).for_each(|(v, x)| *v += factor * x);
        }
    }
}

/// `out += a b` in bands of eight rows and one of what remains, whose sums stay in registers.
#[inline(always)]
fn add_product(product: Product) {
    let Product { out, a, b, rows, inner, used } = product;
    for (to, factors) in out.chunks_exact_mut(rows).zip(b.chunks_exact(inner)) {
        let mut row = 0;
        while row + 8 <= used {
            add_band::<8>(to, a, factors, rows, row);
            row += 8;
        }
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
    /// Units of the coupled states in which they drive each other about as strongly as they are driven.
    balance: Vec<f64>,
    /// Matrix of the coupled states and step that `power` and `area` belong to; no step yet where it is 0.
    known: DMatrix<f64>,
    length: f64,
    /// exp(h A).
    pub transition: DMatrix<f64>,
    /// The integral of exp(s A) over s from 0 to h.
    pub integral: DMatrix<f64>,
    /// What a rate that grows steadily adds over the step, of the coupled states.
    pub ramped: DVector<f64>,
    /// The integral of the integral, where it was asked for: times how fast a rate grows, what that adds over the step.
    pub twice: Option<DMatrix<f64>>,
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
            balance: vec![1.0; coupled],
            known: zeros(),
            length: 0.0,
            ramped: DVector::zeros(coupled),
            transition: whole(),
            integral: whole(),
            twice: None,
        }
    }

    /// For states that all may be coupled, under rates that grow now in one way and now in another.
    pub fn with_ramps(states: usize) -> Self {
        Exponential { twice: Some(DMatrix::zeros(states, states)), ..Exponential::new(states, 0) }
    }

    /// Computes transition and integral from A, and what a rate that grows by `ramp` in a second adds. A source counts
    /// with its mean over the step, an error of the order of (h/tau)(h A)/12 of what it does to the states.
    pub fn compute(&mut self, a: &DMatrix<f64>, h: f64, ramp: Option<&DVector<f64>>) {
        let n = self.small.nrows();
        let ramp = ramp.filter(|r| r.iter().any(|v| *v != 0.0));
        if ramp.is_some() || !self.is_known(a, h) {
            self.balanced(a);
            self.coupled(a, h, ramp);
            self.known.copy_from(&a.view((0, 0), (n, n)));
            self.length = h;
        } else {
            self.ramped.fill(0.0);
        }
        self.transition.view_mut((0, 0), (n, n)).copy_from(&self.power);
        self.integral.view_mut((0, 0), (n, n)).copy_from(&self.area);
        for j in n..a.nrows() {
            let rate = -a[(j, j)];
            let decayed = -(-rate * h).exp_m1();
            let mean = decayed / (rate * h);
            product(self.moved.as_mut_slice(), &self.area, &a.column(j).as_slice()[..n], 0.0);
            for i in 0..n {
                self.transition[(i, j)] = self.moved[i] * mean;
                self.integral[(i, j)] = self.moved[i] * (1.0 - mean) / rate;
            }
            self.transition[(j, j)] = 1.0 - decayed;
            self.integral[(j, j)] = decayed / rate;
        }
    }

    /// Whether the exponential of the coupled states is that of the last step.
    fn is_known(&self, a: &DMatrix<f64>, h: f64) -> bool {
        let units = &self.balance;
        let moved = |j: usize| {
            let entry = |i: usize| (a[(i, j)] - self.known[(i, j)]).abs() * (units[j] / units[i]);
            h * (0..units.len()).map(entry).sum::<f64>()
        };
        as_long(h, self.length) && (0..units.len()).all(|j| moved(j) <= SAME_SYSTEM)
    }

    /// Goes on with the balance: what comes from a state and what goes to it are to be about as much, for then the norm is
    /// least (Parlett, Reinsch, Numerische Mathematik 13, 1969). Powers of two: nothing is rounded.
    fn balanced(&mut self, a: &DMatrix<f64>) {
        let n = self.balance.len();
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

    /// Scaling and squaring (Higham, Functions of Matrices, 2008, ch. 10): the integral is h phi(h A) with
    /// phi(z) = (e^z - 1)/z, and phi(2 z) = (e^z + 1) phi(z)/2.
    fn coupled(&mut self, a: &DMatrix<f64>, h: f64, ramp: Option<&DVector<f64>>) {
        let Exponential { small, next, high, power, area, moved, ramped, balance: units, twice, .. } = self;
        let n = small.nrows();
        (0..n).for_each(|j| (0..n).for_each(|i| small[(i, j)] = a[(i, j)] * (units[j] / units[i])));
        let norm = h * small.column_iter().map(|c| c.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let halvings = if norm > SMALL { ((norm / SMALL).log2().ceil() as i32).min(MOST_HALVINGS) } else { 0 };
        let scale = h / 2.0_f64.powi(halvings);
        *small *= scale;
        let ramp = ramp.map(|r| DVector::from_fn(n, |i, _| r[i] / units[i]));
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
        if let Some(twice) = twice {
            // likewise: phi_2 = (c1 + c2 X + c3 X^2) + X^3 (c4 + c5 X + c6 X^2)
            high.copy_from(x);
            high.zip_apply(square, |h, s| *h = c(5) * *h + c(6) * s);
            twice.copy_from(x);
            twice.zip_apply(square, |h, s| *h = c(2) * *h + c(3) * s);
            for i in 0..n {
                high[(i, i)] += c(4);
                twice[(i, i)] += c(1);
            }
            multiply(twice, power, high, 1.0);
            *twice *= scale * scale;
        }
        power.fill_with_identity();
        multiply(power, small, area, 1.0);
        *area *= scale;
        ramped.fill(0.0);
        if let Some(ramp) = &ramp {
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
            if let Some(ramp) = &ramp {
                // the double integral over 2 s = (exp(s A) + 1) that over s + s times the integral over s
                moved.copy_from(ramped);
                moved.gemv(1.0, power, ramped, 1.0);
                moved.gemv(length, area, ramp, 1.0);
                std::mem::swap(moved, ramped);
            }
            if let Some(twice) = twice {
                next.copy_from(twice);
                multiply(next, power, twice, 1.0);
                next.zip_apply(area, |n, a| *n += length * a);
                std::mem::swap(twice, next);
            }
            length *= 2.0;
            // integral over 2 s = (exp(s A) + 1) integral over s
            next.copy_from(area);
            multiply(next, power, area, 1.0);
            std::mem::swap(area, next);
            multiply(next, power, power, 0.0);
            std::mem::swap(power, next);
        }
        for j in 0..n {
            for i in 0..n {
                let unit = units[i] / units[j];
                power[(i, j)] *= unit;
                area[(i, j)] *= unit;
                if let Some(twice) = twice {
                    twice[(i, j)] *= unit;
                }
            }
            ramped[j] *= units[j];
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
            let mut any = Exponential::with_ramps(1);
            any.compute(&DMatrix::from_element(1, 1, -1.0 / lag), h, None);
            let ramped = 2.0 * any.twice.unwrap()[(0, 0)];
            assert!((ramped - exact).abs() < 1e-6 * exact, "{lag}: {ramped} {exact}");
        }
    }

    /// The states in units a million apart: balanced, the norm is what it was, and so is the exponential.
    #[test]
    fn units_make_no_difference() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let scaled = DMatrix::from_fn(2, 2, |i, j| a[(i, j)] * 1e6_f64.powi(j as i32 - i as i32));
        let (mut own, mut other) = (Exponential::new(2, 0), Exponential::new(2, 0));
        // the balance goes on from step to step
        (0..4).for_each(|i| other.compute(&scaled, 0.3 + 0.01 * f64::from(i), None));
        own.compute(&a, 0.33, None);
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
        let (mut e, mut fresh) = (Exponential::new(2, 0), Exponential::new(2, 0));
        e.compute(&a, 1e-3, None);
        let first = e.transition.clone();
        e.compute(&(&a * 1.001), 1e-3, None);
        assert_eq!(e.transition, first);
        // small steps away from it add up
        e.compute(&(&a * 1.1), 1e-3, None);
        fresh.compute(&(&a * 1.1), 1e-3, None);
        assert_eq!(e.transition, fresh.transition);
        e.compute(&(&a * 1.1), 2e-3, None);
        assert!((&e.transition - &fresh.transition).amax() > 1e-2);
    }

    #[test]
    fn transitions_know_that_sources_only_decay() {
        for (coupled, sources) in [(0, 2), (3, 0), (7, 6), (9, 2), (60, 10)] {
            let n = coupled + sources;
            let m = DMatrix::from_fn(n, n, |i, j| match i < coupled || i == j {
                true => (i * 7 + j * 3) as f64 % 5.0 - 1.9,
                false => 0.0,
            });
            let a = DMatrix::from_fn(n, n, |i, j| (i * 11 + j * 2) as f64 % 7.0 - 3.0);
            let rows = a.rows(0, n.min(4)).into_owned();
            let mut out = DMatrix::from_element(n, n, f64::NAN);
            advance(&mut out, &m, coupled, &a);
            assert!((&out - &m * &a).amax() < 1e-11, "{coupled} {sources}");
            let mut out = DMatrix::from_element(rows.nrows(), n, 1.0);
            advance_across(&mut out, &rows, &m.transpose(), coupled, 2.0);
            assert!((out - (&rows * m.transpose()).add_scalar(2.0)).amax() < 1e-11, "{coupled} {sources}");
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
