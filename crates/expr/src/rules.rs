//! The rules of differentiation, written once for expressions and for the terms of functions.
//!
//! A derivative of `None` is a structural zero. At a kink (`abs`, `min`, `max`) the derivative is the one of a
//! neighbouring side, never a mean; `sign`, `floor`, relations and truth values have the derivative 0.

use super::{Binary, Rel, Unary};

/// What the rules need of an expression type.
pub(super) trait Algebra {
    /// An expression.
    type E: Clone;
    fn num(&mut self, value: f64) -> Self::E;
    fn unary(&mut self, op: Unary, a: Self::E) -> Self::E;
    fn binary(&mut self, op: Binary, a: Self::E, b: Self::E) -> Self::E;
    fn rel(&mut self, rel: Rel, a: Self::E, b: Self::E) -> Self::E;
    fn if_(&mut self, c: Self::E, a: Self::E, b: Self::E) -> Self::E;

    fn add(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(Binary::Add, a, b)
    }
    fn sub(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(Binary::Sub, a, b)
    }
    fn mul(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(Binary::Mul, a, b)
    }
    fn div(&mut self, a: Self::E, b: Self::E) -> Self::E {
        self.binary(Binary::Div, a, b)
    }
    fn neg(&mut self, a: Self::E) -> Self::E {
        self.unary(Unary::Neg, a)
    }
    /// `1 + sign*a^2`
    fn one_and_square(&mut self, sign: Binary, a: Self::E) -> Self::E {
        let two = self.num(2.0);
        let square = self.binary(Binary::Pow, a, two);
        let one = self.num(1.0);
        self.binary(sign, one, square)
    }
}

/// The derivative of `y = op(x)`, given that of `x`.
pub(super) fn unary<A: Algebra>(k: &mut A, op: Unary, x: &A::E, y: &A::E, dx: A::E) -> Option<A::E> {
    let x = x.clone();
    let y = y.clone();
    Some(match op {
        Unary::Neg => k.neg(dx),
        Unary::Not | Unary::Sign | Unary::Floor => return None,
        Unary::Abs => {
            let zero = k.num(0.0);
            let below = k.rel(Rel::Lt, x, zero);
            let (minus, plus) = (k.num(-1.0), k.num(1.0));
            let slope = k.if_(below, minus, plus);
            k.mul(slope, dx)
        }
        Unary::Sqrt => {
            let two = k.num(2.0);
            let double = k.mul(two, y);
            k.div(dx, double)
        }
        Unary::Exp => k.mul(y, dx),
        Unary::Log => k.div(dx, x),
        Unary::Log10 => {
            let ten = k.num(std::f64::consts::LN_10);
            let below = k.mul(ten, x);
            k.div(dx, below)
        }
        Unary::Sin => {
            let slope = k.unary(Unary::Cos, x);
            k.mul(slope, dx)
        }
        Unary::Cos => {
            let slope = k.unary(Unary::Sin, x);
            let product = k.mul(slope, dx);
            k.neg(product)
        }
        Unary::Tan => {
            let slope = k.one_and_square(Binary::Add, y);
            k.mul(slope, dx)
        }
        Unary::Asin => arc(k, x, dx),
        Unary::Acos => {
            let rise = arc(k, x, dx);
            k.neg(rise)
        }
        Unary::Atan => {
            let below = k.one_and_square(Binary::Add, x);
            k.div(dx, below)
        }
        Unary::Sinh => {
            let slope = k.unary(Unary::Cosh, x);
            k.mul(slope, dx)
        }
        Unary::Cosh => {
            let slope = k.unary(Unary::Sinh, x);
            k.mul(slope, dx)
        }
        Unary::Tanh => {
            let slope = k.one_and_square(Binary::Sub, y);
            k.mul(slope, dx)
        }
    })
}

/// `dx / sqrt(1 - x^2)`
fn arc<A: Algebra>(k: &mut A, x: A::E, dx: A::E) -> A::E {
    let inside = k.one_and_square(Binary::Sub, x);
    let below = k.unary(Unary::Sqrt, inside);
    k.div(dx, below)
}

/// The derivative of `y = op(a, b)`, given those of `a` and `b`.
pub(super) fn binary<A: Algebra>(
    k: &mut A,
    op: Binary,
    (a, b, y): (&A::E, &A::E, &A::E),
    da: Option<A::E>,
    db: Option<A::E>,
) -> Option<A::E> {
    if da.is_none() && db.is_none() {
        return None;
    }
    match op {
        Binary::Add => sum(k, da, db),
        Binary::Sub => {
            let minus = db.map(|db| k.neg(db));
            sum(k, da, minus)
        }
        Binary::Mul => {
            let left = da.map(|da| k.mul(da, b.clone()));
            let right = db.map(|db| k.mul(a.clone(), db));
            sum(k, left, right)
        }
        Binary::Div => Some(quotient(k, b, y, da, db)),
        Binary::Pow => {
            let base = da.map(|da| power_by_base(k, a, b, da));
            let exponent = db.map(|db| power_by_exponent(k, a, y, db));
            sum(k, base, exponent)
        }
        Binary::Atan2 => Some(angle(k, a, b, da, db)),
        Binary::Min => Some(chosen(k, Rel::Le, a, b, da, db)),
        Binary::Max => Some(chosen(k, Rel::Ge, a, b, da, db)),
        Binary::And | Binary::Or => None,
    }
}

/// The sum of two derivatives.
pub(super) fn sum<A: Algebra>(k: &mut A, a: Option<A::E>, b: Option<A::E>) -> Option<A::E> {
    match (a, b) {
        (Some(a), Some(b)) => Some(k.add(a, b)),
        (a, b) => a.or(b),
    }
}

/// `(da - y db) / b` for `y = a/b`.
fn quotient<A: Algebra>(k: &mut A, b: &A::E, y: &A::E, da: Option<A::E>, db: Option<A::E>) -> A::E {
    let carried = db.map(|db| {
        let product = k.mul(y.clone(), db);
        k.neg(product)
    });
    let above = sum(k, da, carried).unwrap_or_else(|| k.num(0.0));
    k.div(above, b.clone())
}

/// `b a^(b-1) da`; finite at `a = 0` for every number `b >= 1`.
fn power_by_base<A: Algebra>(k: &mut A, a: &A::E, b: &A::E, da: A::E) -> A::E {
    let one = k.num(1.0);
    let less = k.sub(b.clone(), one);
    let power = k.binary(Binary::Pow, a.clone(), less);
    let slope = k.mul(b.clone(), power);
    k.mul(slope, da)
}

/// `a^b log(a) db`, and 0 at `a = 0`, its limit for positive exponents.
fn power_by_exponent<A: Algebra>(k: &mut A, a: &A::E, y: &A::E, db: A::E) -> A::E {
    let logarithm = k.unary(Unary::Log, a.clone());
    let slope = k.mul(y.clone(), logarithm);
    let zero = k.num(0.0);
    let vanishes = k.rel(Rel::Eq, a.clone(), zero.clone());
    let safe = k.if_(vanishes, zero, slope);
    k.mul(safe, db)
}

/// `(x dy - y dx) / (x^2 + y^2)`
fn angle<A: Algebra>(k: &mut A, y: &A::E, x: &A::E, dy: Option<A::E>, dx: Option<A::E>) -> A::E {
    let rise = dy.map(|dy| k.mul(x.clone(), dy));
    let fall = dx.map(|dx| {
        let product = k.mul(y.clone(), dx);
        k.neg(product)
    });
    let above = sum(k, rise, fall).unwrap_or_else(|| k.num(0.0));
    let two = k.num(2.0);
    let (xx, yy) = (k.binary(Binary::Pow, x.clone(), two.clone()), k.binary(Binary::Pow, y.clone(), two));
    let below = k.add(xx, yy);
    k.div(above, below)
}

/// The derivative of the side that is taken: the first when `a rel b`.
fn chosen<A: Algebra>(k: &mut A, rel: Rel, a: &A::E, b: &A::E, da: Option<A::E>, db: Option<A::E>) -> A::E {
    let first = k.rel(rel, a.clone(), b.clone());
    let da = da.unwrap_or_else(|| k.num(0.0));
    let db = db.unwrap_or_else(|| k.num(0.0));
    k.if_(first, da, db)
}

/// `if c then da else db`, when either depends.
pub(super) fn branch<A: Algebra>(k: &mut A, c: A::E, da: Option<A::E>, db: Option<A::E>) -> Option<A::E> {
    if da.is_none() && db.is_none() {
        return None;
    }
    let da = da.unwrap_or_else(|| k.num(0.0));
    let db = db.unwrap_or_else(|| k.num(0.0));
    Some(k.if_(c, da, db))
}
