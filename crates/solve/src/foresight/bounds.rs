//! Interval arithmetic: bounds of a function and of its slope over a stretch of time.
//!
//! All bounds are widened by more than their rounding, so that they always contain the exact values. `tape` combines
//! them operation by operation. Source: R. E. Moore, Interval Analysis (1966).

use bramah_expr::{BinaryFunction, RelationalOp, UnaryFunction, math};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Relative widening of each operation; it covers the error of functions of the C library.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// All numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealInterval {
    /// Lower bound; may be minus infinity.
    pub lo: f64,
    /// Upper bound; may be infinity.
    pub hi: f64,
}

impl RealInterval {
    /// All numbers: nothing is known.
    pub const ALL: RealInterval = RealInterval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// The number 0.
    pub const ZERO: RealInterval = RealInterval::exactly(0.0);

    /// One number.
    pub const fn exactly(x: f64) -> RealInterval {
        RealInterval { lo: x, hi: x }
    }

    /// The interval between two computed bounds, widened by their rounding.
    pub fn new(lo: f64, hi: f64) -> RealInterval {
        let (lo, hi) = (lo - ROUNDING * lo.abs(), hi + ROUNDING * hi.abs());
        // neither is known where infinities meet
        if lo <= hi { RealInterval { lo, hi } } else { RealInterval::ALL }
    }

    /// Whether it contains one number only.
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Whether it contains 0.
    pub fn holds_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    /// The smallest interval that contains both.
    pub fn hull(self, other: RealInterval) -> RealInterval {
        RealInterval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// All values of `-x`.
    fn neg(self) -> RealInterval {
        RealInterval { lo: -self.hi, hi: -self.lo }
    }

    /// All values of `x + y`.
    fn add(self, other: RealInterval) -> RealInterval {
        RealInterval::new(self.lo + other.lo, self.hi + other.hi)
    }

    /// All values of `x - y`.
    pub fn sub(self, other: RealInterval) -> RealInterval {
        self.add(other.neg())
    }

    /// All values of `x y`.
    pub fn mul(self, other: RealInterval) -> RealInterval {
        // nothing times an unknown number is nothing
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let [a, b, c, d] = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)]
            .map(|(a, b)| product(a, b));
        RealInterval::new(a.min(b).min(c).min(d), a.max(b).max(c).max(d))
    }

    /// All values of `x / y`; nothing is known where `y` may be 0.
    fn div(self, other: RealInterval) -> RealInterval {
        if other.holds_zero() { RealInterval::ALL } else { self.mul(RealInterval::new(1.0 / other.hi, 1.0 / other.lo)) }
    }

    /// All values of a function that grows. Outside its domain nothing is known.
    fn growing(self, f: impl Fn(f64) -> f64) -> RealInterval {
        let (lo, hi) = (f(self.lo), f(self.hi));
        RealInterval::new(
            if lo.is_nan() { f64::NEG_INFINITY } else { lo },
            if hi.is_nan() { f64::INFINITY } else { hi },
        )
    }

    /// All values of `|x|`.
    fn abs(self) -> RealInterval {
        match self {
            RealInterval { lo, .. } if lo >= 0.0 => self,
            RealInterval { hi, .. } if hi <= 0.0 => self.neg(),
            RealInterval { lo, hi } => RealInterval { lo: 0.0, hi: hi.max(-lo) },
        }
    }

    /// All values of the sine.
    fn sin(self) -> RealInterval {
        let width = self.hi - self.lo;
        // a whole period contains all values
        if width.is_nan() || width >= TAU {
            return RealInterval { lo: -1.0, hi: 1.0 };
        }
        let (a, b) = (self.lo.sin(), self.hi.sin());
        let within = RealInterval::new(a.min(b), a.max(b));
        let hi = if self.meets(FRAC_PI_2) { 1.0 } else { within.hi.min(1.0) };
        let lo = if self.meets(-FRAC_PI_2) { -1.0 } else { within.lo.max(-1.0) };
        RealInterval { lo, hi }
    }

    /// All values of the cosine.
    fn cos(self) -> RealInterval {
        self.add(RealInterval::exactly(FRAC_PI_2)).sin()
    }

    /// Whether an angle, or the same angle some turns away, may lie in the interval.
    fn meets(self, angle: f64) -> bool {
        let (from, to) = ((self.lo - angle) / TAU, (self.hi - angle) / TAU);
        let unsure = ROUNDING * (1.0 + from.abs().max(to.abs()));
        (from - unsure).ceil() <= to + unsure
    }

    /// All values of a constant power.
    fn power(self, n: f64) -> RealInterval {
        if n == 0.0 {
            return RealInterval::exactly(1.0);
        }
        if n < 0.0 {
            return RealInterval::exactly(1.0).div(self.power(-n));
        }
        let whole = n.fract() == 0.0;
        // even powers are not monotonic around 0, odd ones are
        if whole && n % 2.0 == 0.0 {
            self.abs().growing(|x| x.powf(n))
        } else if whole || self.lo >= 0.0 {
            self.growing(|x| x.powf(n))
        } else {
            RealInterval::ALL
        }
    }
}

/// Bounds of a function of time over a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalEnclosure {
    /// All values of the function.
    pub value: RealInterval,
    /// All slopes; all numbers where the function may jump.
    pub slope: RealInterval,
}

impl IntervalEnclosure {
    /// Nothing is known of the function.
    pub const UNKNOWN: IntervalEnclosure = IntervalEnclosure { value: RealInterval::ALL, slope: RealInterval::ALL };

    /// A constant function.
    pub const fn constant(x: f64) -> IntervalEnclosure {
        IntervalEnclosure {
            value: if x.is_nan() { RealInterval::ALL } else { RealInterval::exactly(x) },
            slope: RealInterval::ZERO,
        }
    }

    /// A function that changes in steps: slope 0 where it is constant, unknown otherwise.
    fn steps(value: RealInterval) -> IntervalEnclosure {
        IntervalEnclosure { value, slope: if value.is_point() { RealInterval::ZERO } else { RealInterval::ALL } }
    }

    /// Bounds of a function of one argument, with its slope by the chain rule.
    pub fn unary(op: UnaryFunction, a: IntervalEnclosure) -> IntervalEnclosure {
        let one = RealInterval::exactly(1.0);
        let (x, by) = (a.value, a.slope);
        let smooth = |value: RealInterval, slope: RealInterval| IntervalEnclosure { value, slope: slope.mul(by) };
        match op {
            UnaryFunction::Neg => IntervalEnclosure { value: x.neg(), slope: by.neg() },
            UnaryFunction::Abs => smooth(x.abs(), a.sign()),
            UnaryFunction::Not => IntervalEnclosure::truth(!x.holds_zero(), x == RealInterval::ZERO).not(),
            UnaryFunction::Sign => IntervalEnclosure::steps(a.sign()),
            UnaryFunction::Floor => IntervalEnclosure::steps(RealInterval { lo: x.lo.floor(), hi: x.hi.floor() }),
            UnaryFunction::Sqrt => {
                let root = x.growing(f64::sqrt);
                smooth(root, RealInterval::exactly(0.5).div(root))
            }
            UnaryFunction::Exp => {
                let value = x.growing(f64::exp);
                smooth(value, value)
            }
            UnaryFunction::Log => smooth(x.growing(f64::ln), one.div(x)),
            UnaryFunction::Log10 => {
                smooth(x.growing(f64::log10), RealInterval::exactly(std::f64::consts::LOG10_E).div(x))
            }
            UnaryFunction::Sin => smooth(x.sin(), x.cos()),
            UnaryFunction::Cos => smooth(x.cos(), x.sin().neg()),
            UnaryFunction::Tan => {
                let cos = x.cos();
                if cos.holds_zero() {
                    return IntervalEnclosure::UNKNOWN;
                }
                smooth(x.growing(f64::tan), one.div(cos.mul(cos)))
            }
            UnaryFunction::Asin | UnaryFunction::Acos => {
                let slope = one.div(one.sub(x.power(2.0)).growing(f64::sqrt));
                if op == UnaryFunction::Asin {
                    smooth(x.growing(f64::asin), slope)
                } else {
                    smooth(x.growing(|x| -x.acos()).neg(), slope.neg())
                }
            }
            UnaryFunction::Atan => smooth(x.growing(f64::atan), one.div(one.add(x.power(2.0)))),
            UnaryFunction::Sinh => smooth(x.growing(f64::sinh), x.abs().growing(f64::cosh)),
            UnaryFunction::Cosh => smooth(x.abs().growing(f64::cosh), x.growing(f64::sinh)),
            UnaryFunction::Tanh => {
                let value = x.growing(f64::tanh);
                smooth(value, one.sub(value.power(2.0)))
            }
        }
    }

    /// Bounds of a function of two arguments, with the slope by the rules of differentiation.
    pub fn binary(op: BinaryFunction, a: IntervalEnclosure, b: IntervalEnclosure) -> IntervalEnclosure {
        let (x, y) = (a.value, b.value);
        match op {
            BinaryFunction::Add => IntervalEnclosure { value: x.add(y), slope: a.slope.add(b.slope) },
            BinaryFunction::Sub => IntervalEnclosure { value: x.sub(y), slope: a.slope.sub(b.slope) },
            BinaryFunction::Mul => IntervalEnclosure { value: x.mul(y), slope: a.slope.mul(y).add(x.mul(b.slope)) },
            BinaryFunction::Div => {
                let value = x.div(y);
                IntervalEnclosure { value, slope: a.slope.sub(value.mul(b.slope)).div(y) }
            }
            BinaryFunction::Pow if y.is_point() && b.slope == RealInterval::ZERO => {
                let slope = RealInterval::exactly(y.lo).mul(x.power(y.lo - 1.0)).mul(a.slope);
                IntervalEnclosure { value: x.power(y.lo), slope }
            }
            BinaryFunction::Pow if x.lo > 0.0 => IntervalEnclosure::unary(
                UnaryFunction::Exp,
                IntervalEnclosure::binary(BinaryFunction::Mul, b, IntervalEnclosure::unary(UnaryFunction::Log, a)),
            ),
            BinaryFunction::Pow => IntervalEnclosure::UNKNOWN,
            BinaryFunction::Atan2 => IntervalEnclosure {
                value: RealInterval::new(-2.0 * FRAC_PI_2, 2.0 * FRAC_PI_2),
                slope: RealInterval::ALL,
            },
            BinaryFunction::Min => IntervalEnclosure::unary(UnaryFunction::Neg, a.neg().max(b.neg())),
            BinaryFunction::Max => a.max(b),
            BinaryFunction::And => IntervalEnclosure::truth(
                !x.holds_zero() && !y.holds_zero(),
                x == RealInterval::ZERO || y == RealInterval::ZERO,
            ),
            BinaryFunction::Or => IntervalEnclosure::truth(
                !x.holds_zero() || !y.holds_zero(),
                x == RealInterval::ZERO && y == RealInterval::ZERO,
            ),
        }
    }

    /// Bounds of the square of a value. A product would treat the two factors as independent.
    pub fn square(a: IntervalEnclosure) -> IntervalEnclosure {
        let slope = RealInterval::exactly(2.0).mul(a.value).mul(a.slope);
        IntervalEnclosure { value: a.value.power(2.0), slope }
    }

    /// Bounds of a relation: 1, 0, or both where the intervals overlap.
    pub fn relation(rel: RelationalOp, a: IntervalEnclosure, b: IntervalEnclosure) -> IntervalEnclosure {
        let (x, y) = (a.value, b.value);
        let (below, above) = (x.hi < y.lo, x.lo > y.hi);
        let equal = x.is_point() && x == y;
        match rel {
            RelationalOp::Lt => IntervalEnclosure::truth(below, above || equal),
            RelationalOp::Le => IntervalEnclosure::truth(below || equal, above),
            RelationalOp::Gt => IntervalEnclosure::truth(above, below || equal),
            RelationalOp::Ge => IntervalEnclosure::truth(above || equal, below),
            RelationalOp::Eq => IntervalEnclosure::truth(equal, below || above),
            RelationalOp::Ne => IntervalEnclosure::truth(below || above, equal),
        }
    }

    /// Bounds of `if condition then a else b`.
    pub fn choice(condition: IntervalEnclosure, a: IntervalEnclosure, b: IntervalEnclosure) -> IntervalEnclosure {
        match condition.value {
            RealInterval::ZERO => b,
            c if !c.holds_zero() => a,
            _ => IntervalEnclosure { value: a.value.hull(b.value), slope: RealInterval::ALL },
        }
    }

    /// Bounds of a truth value that is always true, never true, or unknown.
    fn truth(always: bool, never: bool) -> IntervalEnclosure {
        IntervalEnclosure::steps(RealInterval { lo: math::truth(always), hi: math::truth(!never) })
    }

    /// Bounds of the negated truth value.
    fn not(self) -> IntervalEnclosure {
        IntervalEnclosure {
            value: RealInterval { lo: 1.0 - self.value.hi, hi: 1.0 - self.value.lo },
            slope: self.slope,
        }
    }

    /// Bounds of the negative.
    fn neg(self) -> IntervalEnclosure {
        IntervalEnclosure { value: self.value.neg(), slope: self.slope.neg() }
    }

    /// Bounds of the sign.
    fn sign(self) -> RealInterval {
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        RealInterval { lo: sign(self.value.lo), hi: sign(self.value.hi) }
    }

    /// Bounds of the larger of two values.
    fn max(self, other: IntervalEnclosure) -> IntervalEnclosure {
        let (x, y) = (self.value, other.value);
        match () {
            () if x.lo >= y.hi => self,
            () if y.lo >= x.hi => other,
            () => IntervalEnclosure {
                value: RealInterval { lo: x.lo.max(y.lo), hi: x.hi.max(y.hi) },
                slope: self.slope.hull(other.slope),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_reach_one_only_where_they_do() {
        assert_eq!(RealInterval { lo: 1.5, hi: 1.6 }.sin().hi, 1.0);
        assert!(RealInterval { lo: 1.6, hi: 2.0 }.sin().hi < 1.0);
        assert_eq!(RealInterval { lo: 1.5 + 1e3 * TAU, hi: 1.6 + 1e3 * TAU }.sin().hi, 1.0);
        assert_eq!(RealInterval { lo: 4.7, hi: 4.8 }.sin().lo, -1.0);
    }

    #[test]
    fn bounds_hold_what_the_functions_give() {
        for (op, from) in UnaryFunction::ALL.iter().flat_map(|op| (-30..30).map(move |k| (*op, 0.11 * f64::from(k)))) {
            let x = IntervalEnclosure {
                value: RealInterval { lo: from, hi: from + 0.3 },
                slope: RealInterval::exactly(1.0),
            };
            let found = IntervalEnclosure::unary(op, x);
            for k in 0..30 {
                let at = |t: f64| math::unary(op, t);
                let t = from + 0.3 * f64::from(k) / 30.0;
                let slope = (at(t + 0.01) - at(t)) / 0.01;
                let fits = |span: RealInterval, x: f64| x.is_nan() || span.lo - 1e-9 <= x && x <= span.hi + 1e-9;
                assert!(fits(found.value, at(t)), "{op:?} at {t}: {found:?}");
                assert!(fits(found.slope, slope), "{op:?} rises by {slope} at {t}: {found:?}");
            }
        }
    }
}
