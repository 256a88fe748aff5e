//! The arithmetic of all nodes, on numbers. Interpreters and native code share it, so that both agree to the bit.
//!
//! Boolean values are 0 and 1; any number but 0 counts as true. Functions that are more than one machine instruction
//! are
//! `extern "C"`, so that native code can call them.

use super::{BinaryFunction, RelationalOp, UnaryFunction};

/// How a power with a given exponent is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerMethod {
    /// An integer exponent up to [`LARGEST_WHOLE_POWER`] in magnitude: square and multiply, from the lowest bit. For a
    /// negative exponent the result is `1/x^n`, with one division at the end.
    Whole(i32),
    /// Exponent 0.5, as `sqrt(x)`.
    Sqrt,
    /// Exponent 0.25, as `sqrt(sqrt(x))`.
    FourthRoot,
    /// Any other exponent, by the mathematical library of the system.
    General,
}

/// The largest exponent whose powers are computed as products.
pub const LARGEST_WHOLE_POWER: i32 = 16;

impl PowerMethod {
    /// The method for an exponent. Native code that knows the exponent may write the same operations in line.
    /// Both ways give the same bits.
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

/// `x^n` by repeated squaring, from the lowest bit of the exponent on.
/// The order of the products determines the rounding, so native code must keep it.
fn whole_power(x: f64, n: i32) -> f64 {
    let mut left = n.unsigned_abs();
    let mut square = x;
    let mut product: Option<f64> = None;
    while left > 0 {
        if left & 1 == 1 {
            product = Some(product.map_or(square, |p| p * square));
        }
        left >>= 1;
        // A last square would not be used, and might overflow.
        if left > 0 {
            square *= square;
        }
    }
    let value = product.unwrap_or(1.0);
    if n < 0 { 1.0 / value } else { value }
}

/// `x^y`, by the method of [`PowerMethod::of`].
pub extern "C" fn pow(x: f64, y: f64) -> f64 {
    match PowerMethod::of(y) {
        PowerMethod::Whole(n) => whole_power(x, n),
        PowerMethod::Sqrt => x.sqrt(),
        PowerMethod::FourthRoot => x.sqrt().sqrt(),
        PowerMethod::General => x.powf(y),
    }
}

/// `e^x`.
pub extern "C" fn exp(x: f64) -> f64 {
    x.exp()
}

/// The natural logarithm.
pub extern "C" fn log(x: f64) -> f64 {
    x.ln()
}

/// The logarithm to base 10.
pub extern "C" fn log10(x: f64) -> f64 {
    x.log10()
}

/// The sine of an angle in rad.
pub extern "C" fn sin(x: f64) -> f64 {
    x.sin()
}

/// The cosine of an angle in rad.
pub extern "C" fn cos(x: f64) -> f64 {
    x.cos()
}

/// The tangent of an angle in rad.
pub extern "C" fn tan(x: f64) -> f64 {
    x.tan()
}

/// The inverse sine in rad.
pub extern "C" fn asin(x: f64) -> f64 {
    x.asin()
}

/// The inverse cosine in rad.
pub extern "C" fn acos(x: f64) -> f64 {
    x.acos()
}

/// The inverse tangent in rad.
pub extern "C" fn atan(x: f64) -> f64 {
    x.atan()
}

/// The hyperbolic sine.
pub extern "C" fn sinh(x: f64) -> f64 {
    x.sinh()
}

/// The hyperbolic cosine.
pub extern "C" fn cosh(x: f64) -> f64 {
    x.cosh()
}

/// The hyperbolic tangent.
pub extern "C" fn tanh(x: f64) -> f64 {
    x.tanh()
}

/// The angle of the point `(x, y)` in rad, above -pi and up to pi.
/// The sign of a zero is ignored, because simplification does not keep it either.
pub extern "C" fn atan2(y: f64, x: f64) -> f64 {
    // Adding 0 makes 0 of -0.
    (y + 0.0).atan2(x + 0.0)
}

/// The sign: -1, 0 or 1. NaN stays NaN.
pub extern "C" fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        // Makes 0 of -0, and keeps NaN.
        x + 0.0
    }
}

/// The largest whole number not above `x`.
pub extern "C" fn floor(x: f64) -> f64 {
    x.floor()
}

/// The first value if it is not above the second, else the second. NaN if either is NaN.
pub extern "C" fn min(a: f64, b: f64) -> f64 {
    // With NaN on either side a comparison is false; NaN must come out on both sides.
    if a <= b || a.is_nan() { a } else { b }
}

/// The first value if it is not below the second, else the second. NaN if either is NaN.
pub extern "C" fn max(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// A Boolean value as 1 or 0.
pub fn truth(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// The value of an operator or function of one argument.
/// `not` gives 0 or 1.
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

/// The value of an operator or function of two arguments.
/// Boolean operators give 0 or 1.
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

/// True if a relation holds. With NaN only `<>` does.
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
