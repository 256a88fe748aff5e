//! The rules of differentiation, written once for expressions and for the terms of functions.
//!
//! A derivative of `None` is a structural zero. At a kink (`abs`, `min`, `max`) the derivative is the one of a
//! neighbouring side, never a mean; `sign`, `floor`, relations and truth values have the derivative 0.

use super::{BinaryFunction, RelationalOp, UnaryFunction};

/// What the rules need of an expression type.
pub(super) trait ExprAlgebra {
    /// An expression.
    type E: Clone;
    fn num(&mut self, value: f64) -> Self::E;
    fn unary(&mut self, op: UnaryFunction, a: Self::E) -> Self::E;
    fn binary(&mut self, op: BinaryFunction, a: Self::E, b: Self::E) -> Self::E;
    fn rel(&mut self, rel: RelationalOp, a: Self::E, b: Self::E) -> Self::E;
    fn if_(&mut self, c: Self::E, a: Self::E, b: Self::E) -> Self::E;

    fn add(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Add, a, b)
    }
    fn sub(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Sub, a, b)
    }
    fn mul(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Mul, a, b)
    }
    fn div(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(BinaryFunction::Div, a, b)
    }
    fn neg(&mut self, a: Self::E) -> Self::E {
        self.unary(UnaryFunction::Neg, a)
    }
    /// `1 + sign*a^2`
    fn one_and_square(&mut self, sign: BinaryFunction, a: Self::E) -> Self::E {
        let two = self.num(2.0);
        let square = self.binary(BinaryFunction::Pow, a, two);
        let one = self.num(1.0);
        self.binary(sign, one, square)
    }
}

/// The derivative of `y = op(x)`, given that of `x`.
pub(super) fn unary<A: ExprAlgebra>(k: &mut A, op: UnaryFunction, x: &A::E, y: &A::E, dx: A::E) -> Option<A::E> {
    let x = x.clone();
    let y = y.clone();
    Some(match op {
        UnaryFunction::Neg => k.neg(dx),
        UnaryFunction::Not | UnaryFunction::Sign | UnaryFunction::Floor => return None,
        UnaryFunction::Abs => {
            let zero = k.num(0.0);
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
        UnaryFunction::Exp => k.mul(y, dx),
        UnaryFunction::Log => k.div(dx, x),
        UnaryFunction::Log10 => {
            let ten = k.num(std::f64::consts::LN_10);
            let below = k.mul(ten, x);
            k.div(dx, below)
        }
        UnaryFunction::Sin => {
            let slope = k.unary(UnaryFunction::Cos, x);
            k.mul(slope, dx)
        }
        UnaryFunction::Cos => {
            let slope = k.unary(UnaryFunction::Sin, x);
            let product = k.mul(slope, dx);
            k.neg(product)
        }
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
        UnaryFunction::Tanh => {
            let slope = k.one_and_square(BinaryFunction::Sub, y);
            k.mul(slope, dx)
        }
    })
}

/// `dx / sqrt(1 - x^2)`
fn arc<A: ExprAlgebra>(k: &mut A, x: A::E, dx: A::E) -> A::E {
    let inside = k.one_and_square(BinaryFunction::Sub, x);
    let below = k.unary(UnaryFunction::Sqrt, inside);
    k.div(dx, below)
}

/// The derivative of `y = op(a, b)`, given those of `a` and `b`.
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
        BinaryFunction::And | BinaryFunction::Or => None,
    }
}

/// The sum of two derivatives.
pub(super) fn sum<A: ExprAlgebra>(k: &mut A, a: Option<A::E>, b: Option<A::E>) -> Option<A::E> {
    match (a, b) {
        (Some(a), Some(b)) => Some(k.add(a, b)),
        (a, b) => a.or(b),
    }
}

/// `(da - y db) / b` for `y = a/b`.
fn quotient<A: ExprAlgebra>(k: &mut A, b: &A::E, y: &A::E, da: Option<A::E>, db: Option<A::E>) -> A::E {
    let carried = db.map(|db| {
        let product = k.mul(y.clone(), db);
        k.neg(product)
    });
    let above = sum(k, da, carried).unwrap_or_else(|| k.num(0.0));
    k.div(above, b.clone())
}

/// `b a^(b-1) da`; finite at `a = 0` for every number `b >= 1`.
fn power_by_base<A: ExprAlgebra>(k: &mut A, a: &A::E, b: &A::E, da: A::E) -> A::E {
    let one = k.num(1.0);
    let less = k.sub(b.clone(), one);
    let power = k.binary(BinaryFunction::Pow, a.clone(), less);
    let slope = k.mul(b.clone(), power);
    k.mul(slope, da)
}

/// `a^b log(a) db`, and 0 at `a = 0`, its limit for positive exponents.
fn power_by_exponent<A: ExprAlgebra>(k: &mut A, a: &A::E, y: &A::E, db: A::E) -> A::E {
    let logarithm = k.unary(UnaryFunction::Log, a.clone());
    let slope = k.mul(y.clone(), logarithm);
    let zero = k.num(0.0);
    let vanishes = k.rel(RelationalOp::Eq, a.clone(), zero.clone());
    let safe = k.if_(vanishes, zero, slope);
    k.mul(safe, db)
}

/// `(x dy - y dx) / (x^2 + y^2)`
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

/// The derivative of the side that is taken: the first when `a rel b`.
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

/// `if c then da else db`, when either depends.
pub(super) fn branch<A: ExprAlgebra>(k: &mut A, c: A::E, da: Option<A::E>, db: Option<A::E>) -> Option<A::E> {
    if da.is_none() && db.is_none() {
        return None;
    }
    let da = da.unwrap_or_else(|| k.num(0.0));
    let db = db.unwrap_or_else(|| k.num(0.0));
    Some(k.if_(c, da, db))
}
