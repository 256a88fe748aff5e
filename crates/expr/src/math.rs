//! The arithmetic of every node, shared by the interpreters and by native code so that both agree to the bit.
//!
//! Truth values are 0 and 1; anything but 0 counts as true. The functions of one and two arguments that are more than
//! one machine instruction exist as `extern "C"` functions, to be called from native code.

use super::{BinaryFunction, RelationalOp, UnaryFunction};

/// How a power with a given exponent is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerMethod {
    /// Whole exponents of magnitude up to [`LARGEST_WHOLE_POWER`]: square and multiply from the lowest bit, and one
    /// division `1/x^n` at the end when the exponent is negative.
    Whole(i32),
    /// Exponent 0.5: `sqrt(x)`.
    Sqrt,
    /// Exponent 0.25: `sqrt(sqrt(x))`.
    FourthRoot,
    /// The general function of the system's mathematical library.
    General,
}

/// Powers up to this one are products.
pub const LARGEST_WHOLE_POWER: i32 = 16;

impl PowerMethod {
    /// The way for this exponent. Native code that knows the exponent may write the same operations in line.
    pub fn of(exponent: f64) -> PowerMethod {
        if exponent == 0.5 {
            PowerMethod::Sqrt
        } else if exponent == 0.25 {
            PowerMethod::FourthRoot
        } else if exponent.fract() == 0.0 && exponent.abs() <= f64::from(LARGEST_WHOLE_POWER) {
            #[allow(clippy::cast_possible_truncation, reason = "a whole number between -16 and 16")]
            PowerMethod::Whole(exponent as i32)
        } else {
            PowerMethod::General
        }
    }
}

/// `x^n` by squaring, from the lowest bit of the exponent; the order of the products is part of the result.
fn whole_power(x: f64, n: i32) -> f64 {
    let mut left = n.unsigned_abs();
    let mut square = x;
    let mut product: Option<f64> = None;
    while left > 0 {
        if left & 1 == 1 {
            product = Some(product.map_or(square, |p| p * square));
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    let value = product.unwrap_or(1.0);
    if n < 0 { 1.0 / value } else { value }
}

/// `x^y`, by the way that [`PowerMethod::of`] names.
pub extern "C" fn pow(x: f64, y: f64) -> f64 {
    match PowerMethod::of(y) {
        PowerMethod::Whole(n) => whole_power(x, n),
        PowerMethod::Sqrt => x.sqrt(),
        PowerMethod::FourthRoot => x.sqrt().sqrt(),
        PowerMethod::General => x.powf(y),
    }
}

/// `e^x`
pub extern "C" fn exp(x: f64) -> f64 {
    x.exp()
}

/// Natural logarithm.
pub extern "C" fn log(x: f64) -> f64 {
    x.ln()
}

/// Logarithm to base 10.
pub extern "C" fn log10(x: f64) -> f64 {
    x.log10()
}

/// Sine.
pub extern "C" fn sin(x: f64) -> f64 {
    x.sin()
}

/// Cosine.
pub extern "C" fn cos(x: f64) -> f64 {
    x.cos()
}

/// Tangent.
pub extern "C" fn tan(x: f64) -> f64 {
    x.tan()
}

/// Inverse sine.
pub extern "C" fn asin(x: f64) -> f64 {
    x.asin()
}

/// Inverse cosine.
pub extern "C" fn acos(x: f64) -> f64 {
    x.acos()
}

/// Inverse tangent.
pub extern "C" fn atan(x: f64) -> f64 {
    x.atan()
}

/// Hyperbolic sine.
pub extern "C" fn sinh(x: f64) -> f64 {
    x.sinh()
}

/// Hyperbolic cosine.
pub extern "C" fn cosh(x: f64) -> f64 {
    x.cosh()
}

/// Hyperbolic tangent.
pub extern "C" fn tanh(x: f64) -> f64 {
    x.tanh()
}

/// The angle of the point `(x, y)`, above -pi and up to pi. Simplification does not keep the sign of a zero, so it has
/// none here.
pub extern "C" fn atan2(y: f64, x: f64) -> f64 {
    // -0 + 0 is 0
    (y + 0.0).atan2(x + 0.0)
}

/// -1, 0 or 1; NaN stays NaN.
pub extern "C" fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x + 0.0
    }
}

/// Largest whole number not above `x`.
pub extern "C" fn floor(x: f64) -> f64 {
    x.floor()
}

/// The first when it is not above the second, else the second.
pub extern "C" fn min(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

/// The first when it is not below the second, else the second.
pub extern "C" fn max(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// 1 or 0.
pub fn truth(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// The value of a function of one argument.
pub fn unary(op: UnaryFunction, x: f64) -> f64 {
    match op {
        UnaryFunction::Neg => -x,
        UnaryFunction::Not => truth(x == 0.0),
        UnaryFunction::Abs => x.abs(),
        UnaryFunction::Sign => sign(x),
        UnaryFunction::Sqrt => x.sqrt(),
        UnaryFunction::Exp => exp(x),
        UnaryFunction::Log => log(x),
        UnaryFunction::Log10 => log10(x),
        UnaryFunction::Sin => sin(x),
        UnaryFunction::Cos => cos(x),
        UnaryFunction::Tan => tan(x),
        UnaryFunction::Asin => asin(x),
        UnaryFunction::Acos => acos(x),
        UnaryFunction::Atan => atan(x),
        UnaryFunction::Sinh => sinh(x),
        UnaryFunction::Cosh => cosh(x),
        UnaryFunction::Tanh => tanh(x),
        UnaryFunction::Floor => floor(x),
    }
}

/// The value of a function of two arguments.
pub fn binary(op: BinaryFunction, a: f64, b: f64) -> f64 {
    match op {
        BinaryFunction::Add => a + b,
        BinaryFunction::Sub => a - b,
        BinaryFunction::Mul => a * b,
        BinaryFunction::Div => a / b,
        BinaryFunction::Pow => pow(a, b),
        BinaryFunction::Atan2 => atan2(a, b),
        BinaryFunction::Min => min(a, b),
        BinaryFunction::Max => max(a, b),
        BinaryFunction::And => truth(a != 0.0 && b != 0.0),
        BinaryFunction::Or => truth(a != 0.0 || b != 0.0),
    }
}

/// Whether a relation holds.
pub fn holds(rel: RelationalOp, a: f64, b: f64) -> bool {
    match rel {
        RelationalOp::Lt => a < b,
        RelationalOp::Le => a <= b,
        RelationalOp::Gt => a > b,
        RelationalOp::Ge => a >= b,
        RelationalOp::Eq => a == b,
        RelationalOp::Ne => a != b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_do_not_know_the_sign_of_a_zero() {
        use std::f64::consts::PI;
        for zero in [0.0, -0.0] {
            assert_eq!((atan2(zero, -1.0), atan2(zero, 1.0), atan2(zero, -0.0)), (PI, 0.0, 0.0));
            assert_eq!((atan2(2.0, zero), atan2(-2.0, zero)), (0.5 * PI, -0.5 * PI));
        }
    }

    #[test]
    fn whole_powers_are_products() {
        assert_eq!(pow(3.0, 2.0), 9.0);
        assert_eq!(pow(-2.0, 3.0), -8.0);
        assert_eq!(pow(2.0, -3.0), 0.125);
        assert_eq!(pow(0.0, 0.0), 1.0);
        assert_eq!(pow(2.0, 16.0), 65536.0);
        assert_eq!(pow(1.1, 5.0), 1.1 * ((1.1 * 1.1) * (1.1 * 1.1)));
    }

    #[test]
    fn roots_are_roots() {
        assert_eq!(pow(2.0, 0.5), 2f64.sqrt());
        assert_eq!(pow(16.0, 0.25), 2.0);
        assert!(pow(-1.0, 0.3).is_nan());
    }

    #[test]
    fn nothing_hides_a_nan() {
        assert!(min(f64::NAN, 1.0).is_nan() && min(1.0, f64::NAN).is_nan());
        assert!(max(f64::NAN, 1.0).is_nan() && max(1.0, f64::NAN).is_nan());
        assert!(sign(f64::NAN).is_nan());
    }
}
