//! One step of a linear system: the matrix exponential and its integral.

use nalgebra::DMatrix;

/// Matrices up to this size are multiplied by plain loops.
const LARGE: usize = 32;
/// Taylor coefficients 1/(k + 1)! of phi; with arguments below [`SMALL`] the error is under 1e-8.
const COEFFICIENTS: [f64; 7] = [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
/// The largest norm at which the polynomial is used; larger ones are halved until they fit.
const SMALL: f64 = 0.3;
/// Halvings at most: beyond, the step is far longer than any time constant that matters.
const MOST_HALVINGS: i32 = 40;

/// `out = a b + beta out` for small square matrices, without the packing that pays for large ones only.
pub fn multiply(out: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>, beta: f64) {
    let n = a.nrows();
    if n > LARGE {
        out.gemm(1.0, a, b, beta);
        return;
    }
    let (a, b) = (a.as_slice(), b.as_slice());
    for (j, column) in out.as_mut_slice().chunks_exact_mut(n).enumerate() {
        if beta == 0.0 {
            column.fill(0.0);
        } else if beta != 1.0 {
            column.iter_mut().for_each(|v| *v *= beta);
        }
        for (k, from) in a.chunks_exact(n).enumerate() {
            let factor = b[j * n + k];
            if factor != 0.0 {
                column.iter_mut().zip(from).for_each(|(v, a)| *v += a * factor);
            }
        }
    }
}

/// Work space for matrices of one size.
#[derive(Clone, Debug)]
pub struct Exponential {
    small: DMatrix<f64>,
    next: DMatrix<f64>,
    high: DMatrix<f64>,
    /// exp(h A).
    pub transition: DMatrix<f64>,
    /// The integral of exp(s A) over s from 0 to h.
    pub integral: DMatrix<f64>,
}

impl Exponential {
    /// For n by n matrices.
    pub fn new(n: usize) -> Self {
        let zeros = || DMatrix::zeros(n, n);
        Exponential { small: zeros(), next: zeros(), high: zeros(), transition: zeros(), integral: zeros() }
    }

    /// Computes both from A by scaling and squaring (Higham, Functions of Matrices, 2008, ch. 10): the integral is
    /// h phi(h A) with phi(z) = (e^z - 1)/z, and phi(2 z) = (e^z + 1) phi(z)/2.
    pub fn compute(&mut self, a: &DMatrix<f64>, h: f64) {
        let n = a.nrows();
        let norm = h * (0..n).map(|j| a.column(j).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let halvings = if norm > SMALL { ((norm / SMALL).log2().ceil() as i32).min(MOST_HALVINGS) } else { 0 };
        let scale = h / 2.0_f64.powi(halvings);
        self.small.copy_from(a);
        self.small *= scale;
        // Horner: phi = 1 + z/2 (1 + z/3 (1 + ...))
        // phi = p(X) + X^3 q(X), both quadratic (Paterson and Stockmeyer): three products for degree six
        let c = |k: usize| COEFFICIENTS[k];
        multiply(&mut self.next, &self.small, &self.small, 0.0);
        multiply(&mut self.transition, &self.small, &self.next, 0.0);
        let (x, square, cube) = (&self.small, &self.next, &self.transition);
        self.high.copy_from(x);
        self.high.zip_apply(square, |h, s| *h = c(4) * *h + c(5) * s);
        self.high.zip_apply(cube, |h, q| *h += c(6) * q);
        self.integral.copy_from(x);
        self.integral.zip_apply(square, |h, s| *h = c(1) * *h + c(2) * s);
        for i in 0..n {
            self.high[(i, i)] += c(3);
            self.integral[(i, i)] += c(0);
        }
        multiply(&mut self.integral, &self.transition, &self.high, 1.0);
        self.transition.fill_with_identity();
        multiply(&mut self.transition, &self.small, &self.integral, 1.0);
        self.integral *= scale;
        for _ in 0..halvings {
            // integral over 2 s = (exp(s A) + 1) integral over s
            self.next.copy_from(&self.integral);
            multiply(&mut self.next, &self.transition, &self.integral, 1.0);
            std::mem::swap(&mut self.integral, &mut self.next);
            multiply(&mut self.next, &self.transition, &self.transition, 0.0);
            std::mem::swap(&mut self.transition, &mut self.next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillator_over_a_long_step() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -2.0]);
        let mut e = Exponential::new(2);
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
        let mut e = Exponential::new(2);
        e.compute(&a, 1e-3);
        assert!(e.transition.iter().all(|v| v.is_finite()));
        assert!((e.integral[(0, 0)] - 1e-9).abs() < 1e-15);
    }
}
