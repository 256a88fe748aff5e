//! Bounds of functions over a stretch of time: of the value and of the slope. All are widened by more than their rounding.

use bramah_expr::{Binary, Rel, Unary, math};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rounding of one operation, with room for functions of the C library.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// All numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub lo: f64,
    pub hi: f64,
}

impl Span {
    /// Nothing is known.
    pub const ALL: Span = Span { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    pub const ZERO: Span = Span::exactly(0.0);

    pub const fn exactly(x: f64) -> Span {
        Span { lo: x, hi: x }
    }

    /// Between two computed ends.
    pub fn new(lo: f64, hi: f64) -> Span {
        let (lo, hi) = (lo - ROUNDING * lo.abs(), hi + ROUNDING * hi.abs());
        // neither is known where infinities meet
        if lo <= hi { Span { lo, hi } } else { Span::ALL }
    }

    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    pub fn holds_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    pub fn hull(self, other: Span) -> Span {
        Span { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    fn neg(self) -> Span {
        Span { lo: -self.hi, hi: -self.lo }
    }

    fn add(self, other: Span) -> Span {
        Span::new(self.lo + other.lo, self.hi + other.hi)
    }

    pub fn sub(self, other: Span) -> Span {
        self.add(other.neg())
    }

    pub fn mul(self, other: Span) -> Span {
        // nothing times an unknown number is nothing
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let [a, b, c, d] = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)]
            .map(|(a, b)| product(a, b));
        Span::new(a.min(b).min(c).min(d), a.max(b).max(c).max(d))
    }

    fn div(self, other: Span) -> Span {
        if other.holds_zero() { Span::ALL } else { self.mul(Span::new(1.0 / other.hi, 1.0 / other.lo)) }
    }

    /// By a function that grows.
    fn growing(self, f: impl Fn(f64) -> f64) -> Span {
        let (lo, hi) = (f(self.lo), f(self.hi));
        Span::new(if lo.is_nan() { f64::NEG_INFINITY } else { lo }, if hi.is_nan() { f64::INFINITY } else { hi })
    }

    fn abs(self) -> Span {
        match self {
            Span { lo, .. } if lo >= 0.0 => self,
            Span { hi, .. } if hi <= 0.0 => self.neg(),
            Span { lo, hi } => Span { lo: 0.0, hi: hi.max(-lo) },
        }
    }

    fn sin(self) -> Span {
        let width = self.hi - self.lo;
        if width.is_nan() || width >= TAU {
            return Span { lo: -1.0, hi: 1.0 };
        }
        let (a, b) = (self.lo.sin(), self.hi.sin());
        let within = Span::new(a.min(b), a.max(b));
        let hi = if self.meets(FRAC_PI_2) { 1.0 } else { within.hi.min(1.0) };
        let lo = if self.meets(-FRAC_PI_2) { -1.0 } else { within.lo.max(-1.0) };
        Span { lo, hi }
    }

    fn cos(self) -> Span {
        self.add(Span::exactly(FRAC_PI_2)).sin()
    }

    /// Whether an angle or the same some turns on may lie within.
    fn meets(self, angle: f64) -> bool {
        let (from, to) = ((self.lo - angle) / TAU, (self.hi - angle) / TAU);
        let unsure = ROUNDING * (1.0 + from.abs().max(to.abs()));
        (from - unsure).ceil() <= to + unsure
    }

    /// To a constant power.
    fn power(self, n: f64) -> Span {
        if n == 0.0 {
            return Span::exactly(1.0);
        }
        if n < 0.0 {
            return Span::exactly(1.0).div(self.power(-n));
        }
        let whole = n.fract() == 0.0;
        if whole && n % 2.0 == 0.0 {
            self.abs().growing(|x| x.powf(n))
        } else if whole || self.lo >= 0.0 {
            self.growing(|x| x.powf(n))
        } else {
            Span::ALL
        }
    }
}

/// A function of time over a stretch: its values, and its slopes where it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub value: Span,
    /// All numbers where the function may jump.
    pub slope: Span,
}

impl Bounds {
    pub const UNKNOWN: Bounds = Bounds { value: Span::ALL, slope: Span::ALL };

    pub const fn constant(x: f64) -> Bounds {
        Bounds { value: if x.is_nan() { Span::ALL } else { Span::exactly(x) }, slope: Span::ZERO }
    }

    /// Steps from one value to another.
    fn steps(value: Span) -> Bounds {
        Bounds { value, slope: if value.is_point() { Span::ZERO } else { Span::ALL } }
    }

    pub fn unary(op: Unary, a: Bounds) -> Bounds {
        let one = Span::exactly(1.0);
        let (x, by) = (a.value, a.slope);
        let smooth = |value: Span, slope: Span| Bounds { value, slope: slope.mul(by) };
        match op {
            Unary::Neg => Bounds { value: x.neg(), slope: by.neg() },
            Unary::Abs => smooth(x.abs(), a.sign()),
            Unary::Not => Bounds::truth(!x.holds_zero(), x == Span::ZERO).not(),
            Unary::Sign => Bounds::steps(a.sign()),
            Unary::Floor => Bounds::steps(Span { lo: x.lo.floor(), hi: x.hi.floor() }),
            Unary::Sqrt => {
                let root = x.growing(f64::sqrt);
                smooth(root, Span::exactly(0.5).div(root))
            }
            Unary::Exp => {
                let value = x.growing(f64::exp);
                smooth(value, value)
            }
            Unary::Log => smooth(x.growing(f64::ln), one.div(x)),
            Unary::Log10 => smooth(x.growing(f64::log10), Span::exactly(std::f64::consts::LOG10_E).div(x)),
            Unary::Sin => smooth(x.sin(), x.cos()),
            Unary::Cos => smooth(x.cos(), x.sin().neg()),
            Unary::Tan => {
                let cos = x.cos();
                if cos.holds_zero() {
                    return Bounds::UNKNOWN;
                }
                smooth(x.growing(f64::tan), one.div(cos.mul(cos)))
            }
            Unary::Asin | Unary::Acos => {
                let slope = one.div(one.sub(x.power(2.0)).growing(f64::sqrt));
                if op == Unary::Asin {
                    smooth(x.growing(f64::asin), slope)
                } else {
                    smooth(x.growing(|x| -x.acos()).neg(), slope.neg())
                }
            }
            Unary::Atan => smooth(x.growing(f64::atan), one.div(one.add(x.power(2.0)))),
            Unary::Sinh => smooth(x.growing(f64::sinh), x.abs().growing(f64::cosh)),
            Unary::Cosh => smooth(x.abs().growing(f64::cosh), x.growing(f64::sinh)),
            Unary::Tanh => {
                let value = x.growing(f64::tanh);
                smooth(value, one.sub(value.power(2.0)))
            }
        }
    }

    pub fn binary(op: Binary, a: Bounds, b: Bounds) -> Bounds {
        let (x, y) = (a.value, b.value);
        match op {
            Binary::Add => Bounds { value: x.add(y), slope: a.slope.add(b.slope) },
            Binary::Sub => Bounds { value: x.sub(y), slope: a.slope.sub(b.slope) },
            Binary::Mul => Bounds { value: x.mul(y), slope: a.slope.mul(y).add(x.mul(b.slope)) },
            Binary::Div => {
                let value = x.div(y);
                Bounds { value, slope: a.slope.sub(value.mul(b.slope)).div(y) }
            }
            Binary::Pow if y.is_point() && b.slope == Span::ZERO => {
                let slope = Span::exactly(y.lo).mul(x.power(y.lo - 1.0)).mul(a.slope);
                Bounds { value: x.power(y.lo), slope }
            }
            Binary::Pow if x.lo > 0.0 => {
                Bounds::unary(Unary::Exp, Bounds::binary(Binary::Mul, b, Bounds::unary(Unary::Log, a)))
            }
            Binary::Pow => Bounds::UNKNOWN,
            Binary::Atan2 => Bounds { value: Span::new(-2.0 * FRAC_PI_2, 2.0 * FRAC_PI_2), slope: Span::ALL },
            Binary::Min => Bounds::unary(Unary::Neg, a.neg().max(b.neg())),
            Binary::Max => a.max(b),
            Binary::And => Bounds::truth(!x.holds_zero() && !y.holds_zero(), x == Span::ZERO || y == Span::ZERO),
            Binary::Or => Bounds::truth(!x.holds_zero() || !y.holds_zero(), x == Span::ZERO && y == Span::ZERO),
        }
    }

    /// A value by itself, which is no product of two that vary each on its own.
    pub fn square(a: Bounds) -> Bounds {
        let slope = Span::exactly(2.0).mul(a.value).mul(a.slope);
        Bounds { value: a.value.power(2.0), slope }
    }

    /// A relation as it stands.
    pub fn relation(rel: Rel, a: Bounds, b: Bounds) -> Bounds {
        let (x, y) = (a.value, b.value);
        let (below, above) = (x.hi < y.lo, x.lo > y.hi);
        let equal = x.is_point() && x == y;
        match rel {
            Rel::Lt => Bounds::truth(below, above || equal),
            Rel::Le => Bounds::truth(below || equal, above),
            Rel::Gt => Bounds::truth(above, below || equal),
            Rel::Ge => Bounds::truth(above || equal, below),
            Rel::Eq => Bounds::truth(equal, below || above),
            Rel::Ne => Bounds::truth(below || above, equal),
        }
    }

    /// One value or the other.
    pub fn choice(condition: Bounds, a: Bounds, b: Bounds) -> Bounds {
        match condition.value {
            Span::ZERO => b,
            c if !c.holds_zero() => a,
            _ => Bounds { value: a.value.hull(b.value), slope: Span::ALL },
        }
    }

    fn truth(always: bool, never: bool) -> Bounds {
        Bounds::steps(Span { lo: math::truth(always), hi: math::truth(!never) })
    }

    fn not(self) -> Bounds {
        Bounds { value: Span { lo: 1.0 - self.value.hi, hi: 1.0 - self.value.lo }, slope: self.slope }
    }

    fn neg(self) -> Bounds {
        Bounds { value: self.value.neg(), slope: self.slope.neg() }
    }

    fn sign(self) -> Span {
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        Span { lo: sign(self.value.lo), hi: sign(self.value.hi) }
    }

    fn max(self, other: Bounds) -> Bounds {
        let (x, y) = (self.value, other.value);
        match () {
            () if x.lo >= y.hi => self,
            () if y.lo >= x.hi => other,
            () => {
                Bounds { value: Span { lo: x.lo.max(y.lo), hi: x.hi.max(y.hi) }, slope: self.slope.hull(other.slope) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_reach_one_only_where_they_do() {
        assert_eq!(Span { lo: 1.5, hi: 1.6 }.sin().hi, 1.0);
        assert!(Span { lo: 1.6, hi: 2.0 }.sin().hi < 1.0);
        assert_eq!(Span { lo: 1.5 + 1e3 * TAU, hi: 1.6 + 1e3 * TAU }.sin().hi, 1.0);
        assert_eq!(Span { lo: 4.7, hi: 4.8 }.sin().lo, -1.0);
    }

    #[test]
    fn bounds_hold_what_the_functions_give() {
        for (op, from) in Unary::ALL.iter().flat_map(|op| (-30..30).map(move |k| (*op, 0.11 * f64::from(k)))) {
            let x = Bounds { value: Span { lo: from, hi: from + 0.3 }, slope: Span::exactly(1.0) };
            let found = Bounds::unary(op, x);
            for k in 0..30 {
                let at = |t: f64| math::unary(op, t);
                let t = from + 0.3 * f64::from(k) / 30.0;
                let slope = (at(t + 0.01) - at(t)) / 0.01;
                let fits = |span: Span, x: f64| x.is_nan() || span.lo - 1e-9 <= x && x <= span.hi + 1e-9;
                assert!(fits(found.value, at(t)), "{op:?} at {t}: {found:?}");
                assert!(fits(found.slope, slope), "{op:?} rises by {slope} at {t}: {found:?}");
            }
        }
    }
}
