//! The rules of differentiation, written once for expressions of the pool and for those over slots.
//! [`super::differentiate`] and [`super::tangent`] provide the algebra and call the rules for each node.
//!
//! A derivative of `None` is a structural zero. At a kink (`abs`, `min`, `max`) the derivative is that of one side,
//! never
//! a mean. `sign`, `floor`, relations and Boolean operators have derivative 0.

use super::{BinaryFunction, RelationalOp, UnaryFunction};

/// The operations that the rules need of a type of expressions.
pub(super) trait ExprAlgebra {
    /// An expression.
    type E: Clone;
    /// A number.
    fn num(&mut self, value: f64) -> Self::E;
    /// An operator or function of one argument.
    fn unary(&mut self, op: UnaryFunction, a: Self::E) -> Self::E;
    /// An operator or function of two arguments.
    fn binary(&mut self, op: BinaryFunction, a: Self::E, b: Self::E) -> Self::E;
    /// A relation without event.
    fn rel(&mut self, rel: RelationalOp, a: Self::E, b: Self::E) -> Self::E;
    /// `if c then a else b`.
    fn if_(&mut self, c: Self::E, a: Self::E, b: Self::E) -> Self::E;

    /// `a + b`.
    fn add(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Add, a, b)
    }
    /// `a - b`.
    fn sub(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Sub, a, b)
    }
    /// `a*b`.
    fn mul(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Mul, a, b)
    }
    /// `a/b`.
    fn div(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Div, a, b)
    }
    /// `-a`.
    fn neg(&mut self, a: Self::E) -> Self::E {
        self.unary(UnaryFunction::Neg, a)
    }
    /// `1 + a^2` or `1 - a^2`, by the operator `sign`.
    fn one_and_square(&mut self, sign: BinaryFunction, a: Self::E) -> Self::E {
        let two = self.num(2.0);
        let square = self.binary(BinaryFunction::Pow, a, two);
        let one = self.num(1.0);
        self.binary(sign, one, square)
    }
}

/// The derivative of `y = op(x)`, from that of `x`. `None` if it is 0.
/// Rules use `y` where they can, because its value is computed anyway.
/// `k` builds the expressions.
pub(super) fn unary<A: ExprAlgebra>(k: &mut A, op: UnaryFunction, x: &A::E, y: &A::E, dx: A::E) -> Option<A::E> {
    let x = x.clone();
    let y = y.clone();
    Some(match op {
        UnaryFunction::Neg => k.neg(dx),
        UnaryFunction::Not | UnaryFunction::Sign | UnaryFunction::Floor => return None,
        UnaryFunction::Abs => {
            let zero = k.num(0.0);
            // At 0 the slope is that of the right side.
            let below = k.rel(RelationalOp::Lt, x, zero);
            let (minus, plus) = (k.num(-1.0), k.num(1.0));
            let slope = k.if_(below, minus, plus);
            k.mul(slope, dx)
        }
        UnaryFunction::Sqrt => {
            let two = k.num(2.0);
            let double = k.mul(two, y);
            k.div(dx, double)
        }
        // The derivative of the exponential is its value, which is known.
        UnaryFunction::Exp => k.mul(y, dx),
        UnaryFunction::Log => k.div(dx, x),
        UnaryFunction::Log10 => {
            let ten = k.num(std::f64::consts::LN_10);
            let below = k.mul(ten, x);
            // d log10(x) = dx / (x log(10)).
            k.div(dx, below)
        }
        UnaryFunction::Sin => {
            let slope = k.unary(UnaryFunction::Cos, x);
            k.mul(slope, dx)
        }
        // d cos(x) = -sin(x) dx.
        UnaryFunction::Cos => {
            let slope = k.unary(UnaryFunction::Sin, x);
            let product = k.mul(slope, dx);
            k.neg(product)
        }
        // d tan(x) = (1 + tan(x)^2) dx, from the value of the node.
        UnaryFunction::Tan => {
            let slope = k.one_and_square(BinaryFunction::Add, y);
            k.mul(slope, dx)
        }
        UnaryFunction::Asin => arc(k, x, dx),
        UnaryFunction::Acos => {
            let rise = arc(k, x, dx);
            k.neg(rise)
        }
        UnaryFunction::Atan => {
            let below = k.one_and_square(BinaryFunction::Add, x);
            k.div(dx, below)
        }
        UnaryFunction::Sinh => {
            let slope = k.unary(UnaryFunction::Cosh, x);
            k.mul(slope, dx)
        }
        UnaryFunction::Cosh => {
            let slope = k.unary(UnaryFunction::Sinh, x);
            k.mul(slope, dx)
        }
        // d tanh(x) = (1 - tanh(x)^2) dx, from the value of the node.
        UnaryFunction::Tanh => {
            let slope = k.one_and_square(BinaryFunction::Sub, y);
            k.mul(slope, dx)
        }
    })
}

/// `dx / sqrt(1 - x^2)`, the derivative of the arc sine.
fn arc<A: ExprAlgebra>(k: &mut A, x: A::E, dx: A::E) -> A::E {
    let inside = k.one_and_square(BinaryFunction::Sub, x);
    let below = k.unary(UnaryFunction::Sqrt, inside);
    k.div(dx, below)
}

/// The derivative of `y = op(a, b)`, from those of `a` and `b`. `None` if it is 0.
/// Operands without a derivative contribute no term.
pub(super) fn binary<A: ExprAlgebra>(
    k: &mut A,
    op: BinaryFunction,
    (a, b, y): (&A::E, &A::E, &A::E),
    da: Option<A::E>,
    db: Option<A::E>,
) -> Option<A::E> {
    if da.is_none() && db.is_none() {
        return None;
    }
    match op {
        BinaryFunction::Add => sum(k, da, db),
        BinaryFunction::Sub => {
            let minus = db.map(|db| k.neg(db));
            sum(k, da, minus)
        }
        BinaryFunction::Mul => {
            let left = da.map(|da| k.mul(da, b.clone()));
            let right = db.map(|db| k.mul(a.clone(), db));
            sum(k, left, right)
        }
        BinaryFunction::Div => Some(quotient(k, b, y, da, db)),
        BinaryFunction::Pow => {
            let base = da.map(|da| power_by_base(k, a, b, da));
            let exponent = db.map(|db| power_by_exponent(k, a, y, db));
            sum(k, base, exponent)
        }
        BinaryFunction::Atan2 => Some(angle(k, a, b, da, db)),
        BinaryFunction::Min => Some(chosen(k, RelationalOp::Le, a, b, da, db)),
        BinaryFunction::Max => Some(chosen(k, RelationalOp::Ge, a, b, da, db)),
        // Their values are 0 or 1 and have no slope.
        BinaryFunction::And | BinaryFunction::Or => None,
    }
}

/// The sum of two derivatives, where `None` is 0.
/// `None` if both are 0.
pub(super) fn sum<A: ExprAlgebra>(k: &mut A, a: Option<A::E>, b: Option<A::E>) -> Option<A::E> {
    match (a, b) {
        (Some(a), Some(b)) => Some(k.add(a, b)),
        (a, b) => a.or(b),
    }
}

/// `(da - y*db) / b`, the derivative of `y = a/b`. Using `y` avoids `b^2`, which may overflow.
fn quotient<A: ExprAlgebra>(k: &mut A, b: &A::E, y: &A::E, da: Option<A::E>, db: Option<A::E>) -> A::E {
    let carried = db.map(|db| {
        let product = k.mul(y.clone(), db);
        k.neg(product)
    });
    let above = sum(k, da, carried).unwrap_or_else(|| k.num(0.0));
    k.div(above, b.clone())
}

/// `b*a^(b-1)*da`, the part of a power's derivative by its base. It is finite at `a = 0` for every constant `b >= 1`.
fn power_by_base<A: ExprAlgebra>(k: &mut A, a: &A::E, b: &A::E, da: A::E) -> A::E {
    let one = k.num(1.0);
    let less = k.sub(b.clone(), one);
    let power = k.binary(BinaryFunction::Pow, a.clone(), less);
    let slope = k.mul(b.clone(), power);
    k.mul(slope, da)
}

/// `a^b*log(a)*db`, the part of a power's derivative by its exponent.
/// At `a = 0` it is 0, the limit for positive exponents.
fn power_by_exponent<A: ExprAlgebra>(k: &mut A, a: &A::E, y: &A::E, db: A::E) -> A::E {
    let logarithm = k.unary(UnaryFunction::Log, a.clone());
    let slope = k.mul(y.clone(), logarithm);
    let zero = k.num(0.0);
    let vanishes = k.rel(RelationalOp::Eq, a.clone(), zero.clone());
    let safe = k.if_(vanishes, zero, slope);
    k.mul(safe, db)
}

/// `(x*dy - y*dx) / (x^2 + y^2)`, the derivative of `atan2(y, x)`.
/// The value itself is not needed.
fn angle<A: ExprAlgebra>(k: &mut A, y: &A::E, x: &A::E, dy: Option<A::E>, dx: Option<A::E>) -> A::E {
    let rise = dy.map(|dy| k.mul(x.clone(), dy));
    let fall = dx.map(|dx| {
        let product = k.mul(y.clone(), dx);
        k.neg(product)
    });
    let above = sum(k, rise, fall).unwrap_or_else(|| k.num(0.0));
    let two = k.num(2.0);
    let (xx, yy) =
        (k.binary(BinaryFunction::Pow, x.clone(), two.clone()), k.binary(BinaryFunction::Pow, y.clone(), two));
    let below = k.add(xx, yy);
    k.div(above, below)
}

/// The derivative of `min` or `max`: that of `a` if `a rel b`, else that of `b`.
/// A missing derivative counts as 0, because the other side may be taken.
fn chosen<A: ExprAlgebra>(
    k: &mut A,
    rel: RelationalOp,
    a: &A::E,
    b: &A::E,
    da: Option<A::E>,
    db: Option<A::E>,
) -> A::E {
    let first = k.rel(rel, a.clone(), b.clone());
    let da = da.unwrap_or_else(|| k.num(0.0));
    let db = db.unwrap_or_else(|| k.num(0.0));
    k.if_(first, da, db)
}

/// `if c then da else db`. `None` if both derivatives are 0.
/// A missing derivative on one side counts as 0. The condition is not differentiated.
pub(super) fn branch<A: ExprAlgebra>(k: &mut A, c: A::E, da: Option<A::E>, db: Option<A::E>) -> Option<A::E> {
    if da.is_none() && db.is_none() {
        return None;
    }
    let da = da.unwrap_or_else(|| k.num(0.0));
    let db = db.unwrap_or_else(|| k.num(0.0));
    Some(k.if_(c, da, db))
}
