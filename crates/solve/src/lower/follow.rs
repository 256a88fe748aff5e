//! The search for the state that belongs to a conserved quantity, along this state alone.
//!
//! `ExecutableSystem::residual` calls [`solve`] for each conserved quantity. The row could also be `quantity - value =
//! 0`. But where a void closes, the bulk modulus of oil changes by a factor of 100,000 within some hundred pascals. The
//! integrator's corrector, which assumes nearly linear equations within a step, then accepts a pressure that belongs to
//! another mass. The row `state - solution` is linear however the quantity bends, and has the unit of the state. Far
//! from the solution the search follows the logarithm of a positive quantity, because the mass of a liquid and that of
//! its voids both change exponentially.

/// The search ends when the correction is below this part of the way gone and of the last step ...
const CONTRACTED: f64 = 1e-3;
/// ... if the last two slopes differ by less than this factor. Otherwise the correction is a guess across a bend.
const STRAIGHT: f64 = 2.0;
/// The search also ends when the correction is below this part of the state.
const ROUND_OFF: f64 = 1e-13;
/// Evaluations of the quantity at most.
const MOST: u32 = 80;
/// A quantity whose logarithm changes by less than this is followed as it is. The mass of a gas is proportional to its
/// pressure, and needs no logarithm.
const NEAR_BY: f64 = 0.1;
/// A step without a bracket is at most this many times as long as the one before.
const GROWTH: f64 = 8.0;
/// Step of the difference quotient where no slope is known, relative to the state.
const DIFFERENCE: f64 = 1e-7;

/// The `x` at which `quantity(x)` is `wanted`. The quantity must be monotonic.
///
/// The search starts at `start`, where the quantity is `there`. `slope` is the derivative as far as it is known, and is
/// updated. `None` where a value is not finite or no solution is found.
pub fn solve(
    mut quantity: impl FnMut(f64) -> f64,
    wanted: f64,
    start: f64,
    there: f64,
    slope: &mut f64,
) -> Option<f64> {
    if wanted == there {
        return Some(start);
    }
    if *slope == 0.0 || !slope.is_finite() {
        let step = DIFFERENCE * (start.abs() + f64::MIN_POSITIVE.sqrt());
        *slope = (quantity(start + step) - there) / step;
    }
    if *slope == 0.0 || !slope.is_finite() || !(wanted - there).is_finite() {
        return None;
    }
    // a falling quantity is negated, so that `rise` sees a growing one
    let sign = slope.signum();
    let mut rising = slope.abs();
    let far = (wanted / there).ln().abs() > NEAR_BY;
    let found = if far && wanted > 0.0 && there > 0.0 {
        // the slope of the logarithm, and back after the search
        rising /= there;
        let found = rise(|x| sign * (quantity(x) / wanted).ln(), 0.0, start, sign * (there / wanted).ln(), &mut rising);
        rising *= wanted;
        found
    } else {
        rise(|x| sign * quantity(x), sign * wanted, start, sign * there, &mut rising)
    };
    *slope = sign * rising;
    found
}

/// The same for a growing quantity: secant steps within a bracket that narrows.
fn rise(mut quantity: impl FnMut(f64) -> f64, wanted: f64, start: f64, there: f64, slope: &mut f64) -> Option<f64> {
    let (mut x, mut missing) = (start, wanted - there);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut step = missing / *slope;
    let mut before = step.abs();
    for _ in 0..MOST {
        // every evaluation is a bound on one side
        if missing > 0.0 {
            low = x
        } else {
            high = x
        }
        let mut next = x + step;
        if !(next > low && next < high) {
            next = if low.is_finite() && high.is_finite() {
                0.5 * (low + high)
            } else {
                x + GROWTH * before.copysign(missing)
            };
        }
        if next == x {
            return Some(x);
        }
        let left = wanted - quantity(next);
        // outside the domain of the quantity: half the step
        if !left.is_finite() {
            step = 0.5 * (next - x);
            before = step.abs();
            continue;
        }
        let secant = (missing - left) / (next - x);
        let straight = secant < STRAIGHT * *slope && *slope < STRAIGHT * secant;
        // a slope of the wrong sign is rounding error
        if secant > 0.0 && secant.is_finite() {
            *slope = secant;
        }
        before = (next - x).abs();
        (x, missing) = (next, left);
        step = missing / *slope;
        let contracted = straight && step.abs() <= CONTRACTED * (x - start).abs().min(before);
        if missing == 0.0 || contracted || step.abs() <= ROUND_OFF * x.abs() {
            return Some(x + step);
        }
        let bracketed = low.is_finite() && high.is_finite();
        // slow from one side: halve
        if bracketed && step.abs() > 0.5 * before {
            step = 0.5 * (low + high) - x;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Oil with voids: the volume of a kilogram falls by the exponential law of `Oil.Compression.entrainedAir`.
    fn density(p: f64) -> f64 {
        let v_v = (f64::min(-p / 1e3, 0.0) + 10.0).exp() * (1.0 + f64::max(-p / 1e3, 0.0));
        860.0 / ((-(p - 1e5) / 1.5e9).exp() + 0.002 * (1e5 / f64::max(p, 2e3)).powf(1.0 / 1.2) + v_v)
    }

    proptest! {
        #[test]
        fn the_pressure_of_a_density_is_found_from_afar(from in 3.0..8.0_f64, to in 3.0..8.0_f64, wrong in -3.0..3.0_f64) {
            let (start, target) = (10.0_f64.powf(from), 10.0_f64.powf(to));
            let local = (density(start * 1.0001) - density(start)) / (start * 1e-4);
            let mut slope = local * 10.0_f64.powf(wrong);
            let mut calls = 0;
            let (mut found, mut before) = (start, f64::INFINITY);
            // the corrector asks again until nothing changes: each time a thousandth of the way is left
            while (found - before).abs() > 1e-13 * found && calls < 80 {
                let counted = |p: f64| { calls += 1; density(p) };
                before = found;
                found = solve(counted, density(target), found, density(found), &mut slope).expect("found");
            }
            prop_assert!((density(found) / density(target) - 1.0).abs() < 1e-12, "{found} for {target}");
            prop_assert!(calls < 80);
        }
    }

    #[test]
    fn a_good_slope_needs_one_evaluation() {
        let mut calls = 0;
        let mut slope = 2.0;
        let found = solve(
            |x| {
                calls += 1;
                2.0 * x + 1e-3 * x * x
            },
            2.002,
            0.999,
            1.999,
            &mut slope,
        );
        assert!(found.is_some_and(|x| (x - 1.0).abs() < 1e-2));
        assert!(calls <= 3);
    }

    #[test]
    fn what_has_no_solution_is_refused() {
        assert_eq!(solve(|_| 1.0, 2.0, 0.0, 1.0, &mut 0.0), None);
        assert_eq!(solve(|_| f64::NAN, 2.0, 0.0, 1.0, &mut 1.0), None);
    }
}
