//! The delay of one signal against another: the time shift at which they correlate best.
//! `compare` reports it. Two curves enter; a shift and a correlation leave.

use super::tube::interpolate;

/// The number of samples at which the signals are compared.
const SAMPLES: usize = 1024;
/// The largest shift that is tried, as a fraction of the common time.
const LARGEST: f64 = 0.2;
/// The number of coarse shifts to each side.
const COARSE: i32 = 204;
/// The gain in correlation that a shift needs. It excludes equal shifts of periodic signals, of which the smallest is
/// taken.
const GAIN: f64 = 1e-9;

/// The shift in s by which `b` comes later than `a`, where Pearson's correlation is best, and that correlation.
/// Curves are pairs of times and values.
///
/// `None` for constant signals, and for curves without common time.
pub(super) fn delay(a: (&[f64], &[f64]), b: (&[f64], &[f64])) -> Option<(f64, f64)> {
    let from = a.0.first()?.max(*b.0.first()?);
    let to = a.0.last()?.min(*b.0.last()?);
    let length = to - from;
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let score = |shift: f64| correlation(a, b, from, length, shift);
    let step = LARGEST * length / f64::from(COARSE);
    let mut best = (0.0, score(0.0)?);
    // Small shifts come first, so that a larger one must really be better.
    for k in 1..=COARSE {
        for shift in [f64::from(k) * step, -f64::from(k) * step] {
            best = better(best, shift, score(shift));
        }
    }
    let mut fine = step;
    // Five refinements around the best shift, each five times finer, end at 1/3125 of the coarse step.
    for _ in 0..5 {
        let centre = best.0;
        fine /= 5.0;
        for k in 1..=5 {
            for shift in [centre + f64::from(k) * fine, centre - f64::from(k) * fine] {
                best = better(best, shift, score(shift));
            }
        }
    }
    Some(best)
}

/// The better of two shifts. A shift without a correlation is not.
fn better(best: (f64, f64), shift: f64, score: Option<f64>) -> (f64, f64) {
    match score {
        Some(score) if score > best.1 + GAIN => (shift, score),
        _ => best,
    }
}

/// Pearson's correlation of `a(t)` and `b(t + shift)`, over the times where both exist. `None` if one of them is
/// constant.
fn correlation(a: (&[f64], &[f64]), b: (&[f64], &[f64]), from: f64, length: f64, shift: f64) -> Option<f64> {
    let start = from + (-shift).max(0.0);
    let step = (length - shift.abs()) / (SAMPLES - 1) as f64;
    let (mut n, mut sa, mut sb, mut saa, mut sbb, mut sab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    // Differences from the first value, because sums of squares of large equal values would cancel.
    let (a0, b0) = (a.1[0], b.1[0]);
    for k in 0..SAMPLES {
        let time = start + k as f64 * step;
        let pair = interpolate(a.0, a.1, false, time).zip(interpolate(b.0, b.1, false, time + shift));
        let Some((va, vb)) = pair else { continue };
        let (va, vb) = (va - a0, vb - b0);
        n += 1.0;
        sa += va;
        sb += vb;
        saa += va * va;
        sbb += vb * vb;
        sab += va * vb;
    }
    let (caa, cbb, cab) = (saa - sa * sa / n, sbb - sb * sb / n, sab - sa * sb / n);
    let scale = (caa * cbb).sqrt();
    // Rounding alone gives about this variance; a signal with less counts as constant.
    let varied = caa > 1e-24 * saa.max(f64::MIN_POSITIVE) && cbb > 1e-24 * sbb.max(f64::MIN_POSITIVE);
    (varied && scale > 0.0 && scale.is_finite()).then(|| cab / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..=5000).map(|i| f64::from(i) * 1e-3).collect();
        let values = times.iter().map(|&t| f(t)).collect();
        (times, values)
    }

    #[test]
    fn finds_a_delay_below_the_sampling_interval() {
        let pulse = |t: f64| (-(t - 2.0).powi(2) / 0.08).exp();
        let (a, b) = (curve(pulse), curve(|t| 3.0 + 2.0 * pulse(t - 0.0237)));
        let (shift, score) = delay((&a.0, &a.1), (&b.0, &b.1)).unwrap();
        approx::assert_abs_diff_eq!(shift, 0.0237, epsilon = 2e-4);
        assert!(score > 0.999_99);
        let (shift, _) = delay((&b.0, &b.1), (&a.0, &a.1)).unwrap();
        approx::assert_abs_diff_eq!(shift, -0.0237, epsilon = 2e-4);
    }

    #[test]
    fn equal_signals_have_none_and_constants_cannot_say() {
        let a = curve(f64::sin);
        assert_eq!(delay((&a.0, &a.1), (&a.0, &a.1)).unwrap().0, 0.0);
        let constant = curve(|_| 5.0);
        assert_eq!(delay((&a.0, &a.1), (&constant.0, &constant.1)), None);
        assert_eq!(delay((&a.0, &a.1), (&[], &[])), None);
    }
}
