//! Vector operations for IDA, in the widest registers that the processor has.
//!
//! `ida/operations` calls them for long vectors. Elements are computed by the same operations in the same order on
//! every processor. Sums run over a fixed number of lanes. So the bits of the results do not depend on the processor.

use pulp::Arch;

/// Length from which vectors use these operations. For shorter ones the choice of registers costs too much.
pub const LONG: usize = 64;
/// Number of elements that are combined before the next ones, so that they stay in the first-level cache.
const BLOCK: usize = 512;
/// Number of partial sums of a norm.
const LANES: usize = 8;

/// `z = a x`
pub fn scale(a: f64, x: &[f64], z: &mut [f64]) {
    if a == 1.0 {
        z.copy_from_slice(x);
    } else {
        Arch::new().dispatch(|| z.iter_mut().zip(x).for_each(|(z, x)| *z = a * x));
    }
}

/// `z = a z`
pub fn scale_in_place(a: f64, z: &mut [f64]) {
    if a != 1.0 {
        Arch::new().dispatch(|| z.iter_mut().for_each(|z| *z *= a));
    }
}

/// `z = a x + b y`
///
/// Where the factors are equal or opposite, the sum or difference is taken first.
pub fn sum(a: f64, x: &[f64], b: f64, y: &[f64], z: &mut [f64]) {
    Arch::new().dispatch(|| {
        let all = z.iter_mut().zip(x.iter().zip(y));
        if a == b {
            all.for_each(|(z, (x, y))| *z = a * (x + y));
        } else if a == -b {
            all.for_each(|(z, (x, y))| *z = a * (x - y));
        } else {
            all.for_each(|(z, (x, y))| *z = a * x + b * y);
        }
    });
}

/// `z = a x + b z`, with the same rule as [`sum`].
pub fn add(a: f64, x: &[f64], b: f64, z: &mut [f64]) {
    Arch::new().dispatch(|| {
        let all = z.iter_mut().zip(x);
        // what is added to z itself is multiplied first
        if b == 1.0 {
            all.for_each(|(z, x)| *z += a * x);
        } else if a == b {
            all.for_each(|(z, x)| *z = a * (x + *z));
        } else if a == -b {
            all.for_each(|(z, x)| *z = a * (x - *z));
        } else {
            all.for_each(|(z, x)| *z = a * x + b * *z);
        }
    });
}

/// `z = c_0 x_0 + c_1 x_1 + ...`, added in this order. Each vector is read once.
pub fn combine(c: &[f64], x: &[&[f64]], z: &mut [f64]) {
    Arch::new().dispatch(|| {
        for (k, z) in z.chunks_mut(BLOCK).enumerate() {
            let part = k * BLOCK..k * BLOCK + z.len();
            z.iter_mut().zip(&x[0][part.clone()]).for_each(|(z, x)| *z = c[0] * x);
            for (&c, x) in c.iter().zip(x).skip(1) {
                z.iter_mut().zip(&x[part.clone()]).for_each(|(z, x)| *z += c * x);
            }
        }
    });
}

/// `z = own z + c_0 x_0 + ...`, added in this order.
pub fn combine_onto(own: f64, c: &[f64], x: &[&[f64]], z: &mut [f64]) {
    Arch::new().dispatch(|| {
        for (k, z) in z.chunks_mut(BLOCK).enumerate() {
            let part = k * BLOCK..k * BLOCK + z.len();
            if own != 1.0 {
                z.iter_mut().for_each(|z| *z *= own);
            }
            for (&c, x) in c.iter().zip(x) {
                z.iter_mut().zip(&x[part.clone()]).for_each(|(z, x)| *z += c * x);
            }
        }
    });
}

/// The root of the mean square of `x w`, the norm of IDA's error test.
pub fn weighted_norm(x: &[f64], w: &[f64]) -> f64 {
    let squares = Arch::new().dispatch(|| {
        let mut sums = [0.0; LANES];
        let (blocks, weights) = (x.chunks_exact(LANES), w.chunks_exact(LANES));
        let rest = blocks.remainder().iter().zip(weights.remainder());
        for (x, w) in blocks.zip(weights) {
            for ((sum, x), w) in sums.iter_mut().zip(x).zip(w) {
                let one = x * w;
                *sum += one * one;
            }
        }
        // the lanes are added in a fixed order, then the elements that fill no lane
        rest.fold(sums.iter().sum::<f64>(), |sum, (x, w)| sum + (x * w) * (x * w))
    });
    (squares / x.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(seed: f64, n: usize) -> Vec<f64> {
        (0..n).map(|k| (seed * (k as f64 + 1.0)).sin()).collect()
    }

    #[test]
    fn combinations_have_the_bits_of_sums_one_after_the_other() {
        let n = 2 * BLOCK + 77;
        let x: Vec<Vec<f64>> = (1..=4).map(|k| vector(f64::from(k), n)).collect();
        let c = [1.0, 0.3, -1.7, 2.5];
        let mut wanted = x[0].clone();
        (1..4).for_each(|k| add(c[k], &x[k], 1.0, &mut wanted));
        let all: Vec<&[f64]> = x.iter().map(Vec::as_slice).collect();
        let mut z = vec![f64::NAN; n];
        combine(&c, &all, &mut z);
        assert_eq!(z, wanted);
        let mut z = x[0].clone();
        combine_onto(1.0, &c[1..], &all[1..], &mut z);
        assert_eq!(z, wanted);
    }

    #[test]
    fn sums_and_norms() {
        let (x, y) = (vector(1.0, 100), vector(2.0, 100));
        for (a, b) in [(1.0, 1.0), (2.0, 2.0), (2.0, -2.0), (0.3, 0.7), (1.0, -1.0)] {
            let mut z = vec![0.0; 100];
            sum(a, &x, b, &y, &mut z);
            let right = |k: usize| (z[k] - (a * x[k] + b * y[k])).abs() < 1e-15;
            assert!((0..100).all(right));
            let mut onto = y.clone();
            add(a, &x, b, &mut onto);
            assert!((0..100).all(|k| (onto[k] - z[k]).abs() < 1e-15));
        }
        let mut z = vec![0.0; 100];
        scale(3.0, &x, &mut z);
        let mut w = x.clone();
        scale_in_place(3.0, &mut w);
        assert_eq!(z, w);
        assert!((weighted_norm(&[2.0; 100], &[0.5; 100]) - 1.0).abs() < 1e-15);
    }
}
