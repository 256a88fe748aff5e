//! The constructors of expressions, which simplify.
//!
//! They do these things and nothing else: fold numbers if the result is finite (`1/0` stays as written, so that the run
//! can name it), drop neutral elements, cancel `x - x` and double negations, move signs outwards, and choose the branch
//! of an `if` with a known condition.
//! A product with the number 0, and a quotient of the number 0, are 0 whatever the other operand will be: a structural
//! zero. The sign of a zero is not kept.
//! Nothing is reassociated, so that results round as written. Of two commutative spellings the first one is shared.

use super::math;
use super::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction};

/// Constructors of nodes. Each gives the id of a node with the value described, which may be simpler than asked for.
impl Exprs {
    /// `-a`. The sign of a difference, or of a product with a number, is absorbed.
    pub fn neg(&mut self, a: ExprId) -> ExprId {
        match self.node(a) {
            ExprNode::Num(bits) => self.num(-f64::from_bits(bits)),
            ExprNode::Unary(UnaryFunction::Neg, inner) => inner,
            ExprNode::Binary(BinaryFunction::Sub, x, y) => self.sub(y, x),
            // The number in front takes the sign, which saves an operation.
            ExprNode::Binary(op @ (BinaryFunction::Mul | BinaryFunction::Div), x, y) => match self.as_num(x) {
                Some(c) => {
                    let minus = self.num(-c);
                    self.binary(op, minus, y)
                }
                None => self.intern(ExprNode::Unary(UnaryFunction::Neg, a)),
            },
            _ => self.intern(ExprNode::Unary(UnaryFunction::Neg, a)),
        }
    }

    /// `not a`.
    #[inline]
    pub fn not(&mut self, a: ExprId) -> ExprId {
        match self.node(a) {
            ExprNode::Num(bits) => self.boolean(f64::from_bits(bits) == 0.0),
            ExprNode::Unary(UnaryFunction::Not, inner) if self.is_truth(inner) => inner,
            _ => self.intern(ExprNode::Unary(UnaryFunction::Not, a)),
        }
    }

    /// True if the value can only be 0 or 1, so that a double `not` changes nothing.
    fn is_truth(&self, e: ExprId) -> bool {
        match self.node(e) {
            ExprNode::Rel(..)
            | ExprNode::EventRel(..)
            | ExprNode::Sample(..)
            | ExprNode::Initial
            | ExprNode::Terminal => true,
            ExprNode::Unary(op, _) => op == UnaryFunction::Not,
            ExprNode::Binary(op, ..) => matches!(op, BinaryFunction::And | BinaryFunction::Or),
            // A variable under `not` is Boolean: the type check of the model has made sure of that.
            ExprNode::Var(_) | ExprNode::Pre(_) => true,
            _ => e == Self::ZERO || e == Self::ONE,
        }
    }

    /// `a + b`. Adding a negative becomes a subtraction.
    pub fn add(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == Self::ZERO {
            return b;
        }
        if b == Self::ZERO {
            return a;
        }
        if let Some(folded) = self.fold(BinaryFunction::Add, a, b) {
            return folded;
        }
        if let Some(positive) = self.negative_of(b) {
            return self.sub(a, positive);
        }
        match self.node(a) {
            ExprNode::Unary(UnaryFunction::Neg, x) => self.sub(b, x),
            _ => self.commutative(BinaryFunction::Add, a, b),
        }
    }

    /// `a - b`. Subtracting a negative becomes an addition.
    /// `x - x` is 0.
    pub fn sub(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if b == Self::ZERO {
            return a;
        }
        // Also where `a` will be infinite or NaN: a structural zero.
        if a == b {
            return Self::ZERO;
        }
        if a == Self::ZERO {
            return self.neg(b);
        }
        if let Some(folded) = self.fold(BinaryFunction::Sub, a, b) {
            return folded;
        }
        if let Some(positive) = self.negative_of(b) {
            return self.add(a, positive);
        }
        self.intern(ExprNode::Binary(BinaryFunction::Sub, a, b))
    }

    /// `a*b`. Signs of the factors move to the front.
    /// A factor 0 makes the product 0, whatever the other factor is.
    pub fn mul(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == Self::ZERO || b == Self::ZERO {
            return Self::ZERO;
        }
        if a == Self::ONE {
            return b;
        }
        if b == Self::ONE {
            return a;
        }
        if let Some(folded) = self.fold(BinaryFunction::Mul, a, b) {
            return folded;
        }
        if self.as_num(a) == Some(-1.0) {
            return self.neg(b);
        }
        if self.as_num(b) == Some(-1.0) {
            return self.neg(a);
        }
        match (self.node(a), self.node(b)) {
            (ExprNode::Unary(UnaryFunction::Neg, x), ExprNode::Unary(UnaryFunction::Neg, y)) => self.mul(x, y),
            (ExprNode::Unary(UnaryFunction::Neg, x), _) => self.negated(BinaryFunction::Mul, x, b),
            (_, ExprNode::Unary(UnaryFunction::Neg, y)) => self.negated(BinaryFunction::Mul, a, y),
            _ => self.commutative(BinaryFunction::Mul, a, b),
        }
    }

    /// `a/b`. Signs of both operands move to the front.
    /// A numerator 0 makes the quotient 0, unless the denominator is the number 0.
    pub fn div(&mut self, a: ExprId, b: ExprId) -> ExprId {
        // `0/0` is not simplified, so that the run reports it.
        if b == Self::ONE || (a == Self::ZERO && b != Self::ZERO) {
            return a;
        }
        if let Some(folded) = self.fold(BinaryFunction::Div, a, b) {
            return folded;
        }
        if self.as_num(b) == Some(-1.0) {
            return self.neg(a);
        }
        match (self.node(a), self.node(b)) {
            (ExprNode::Unary(UnaryFunction::Neg, x), ExprNode::Unary(UnaryFunction::Neg, y)) => self.div(x, y),
            (ExprNode::Unary(UnaryFunction::Neg, x), _) => self.negated(BinaryFunction::Div, x, b),
            (_, ExprNode::Unary(UnaryFunction::Neg, y)) => self.negated(BinaryFunction::Div, a, y),
            _ => self.intern(ExprNode::Binary(BinaryFunction::Div, a, b)),
        }
    }

    /// `a^b`. The exponents 0 and 1, and the base 1, are simplified.
    /// Powers with small integer exponents are computed as products.
    pub fn pow(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if b == Self::ZERO || a == Self::ONE {
            return Self::ONE;
        }
        if b == Self::ONE {
            return a;
        }
        self.folded(BinaryFunction::Pow, a, b)
    }

    /// The smaller of two values.
    /// Two numbers give a number.
    #[inline]
    pub fn min(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == b { a } else { self.folded(BinaryFunction::Min, a, b) }
    }

    /// The larger of two values.
    /// Two numbers give a number.
    #[inline]
    pub fn max(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == b { a } else { self.folded(BinaryFunction::Max, a, b) }
    }

    /// The angle of the point `(x, y)`, in rad, as in `math::atan2`.
    #[inline]
    pub fn atan2(&mut self, y: ExprId, x: ExprId) -> ExprId {
        self.folded(BinaryFunction::Atan2, y, x)
    }

    /// `a and b`.
    /// Known operands are dropped or decide the result.
    pub fn and(&mut self, a: ExprId, b: ExprId) -> ExprId {
        match (self.as_num(a), self.as_num(b)) {
            (Some(0.0), _) | (_, Some(0.0)) => Self::ZERO,
            // Any number but 0 is true.
            (Some(_), _) => b,
            (_, Some(_)) => a,
            _ if a == b => a,
            _ => self.commutative(BinaryFunction::And, a, b),
        }
    }

    /// `a or b`.
    pub fn or(&mut self, a: ExprId, b: ExprId) -> ExprId {
        match (self.as_num(a), self.as_num(b)) {
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            (Some(_), _) | (_, Some(_)) => Self::ONE,
            _ if a == b => a,
            _ => self.commutative(BinaryFunction::Or, a, b),
        }
    }

    /// The implication: `b` wherever `a` holds, that is `not a or b`.
    #[inline]
    pub fn implies(&mut self, a: ExprId, b: ExprId) -> ExprId {
        let not = self.not(a);
        self.or(not, b)
    }

    /// A function of two arguments by its name, simplified.
    /// Rewriting passes use it to rebuild nodes.
    pub fn binary(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> ExprId {
        match op {
            BinaryFunction::Add => self.add(a, b),
            BinaryFunction::Sub => self.sub(a, b),
            BinaryFunction::Mul => self.mul(a, b),
            BinaryFunction::Div => self.div(a, b),
            BinaryFunction::Pow => self.pow(a, b),
            BinaryFunction::Atan2 => self.atan2(a, b),
            BinaryFunction::Min => self.min(a, b),
            BinaryFunction::Max => self.max(a, b),
            BinaryFunction::And => self.and(a, b),
            BinaryFunction::Or => self.or(a, b),
        }
    }

    /// A function of one argument by its name, simplified.
    /// Rewriting passes use it to rebuild nodes.
    pub fn unary(&mut self, op: UnaryFunction, a: ExprId) -> ExprId {
        match op {
            UnaryFunction::Neg => return self.neg(a),
            UnaryFunction::Not => return self.not(a),
            _ => {}
        }
        if let Some(x) = self.as_num(a) {
            let value = math::unary(op, x);
            // `sqrt(-1)` and the like stay as written, so that the run can name them.
            if value.is_finite() {
                return self.num(value);
            }
        }
        // The absolute value of what has no sign.
        match (op, self.node(a)) {
            (UnaryFunction::Abs, ExprNode::Unary(UnaryFunction::Neg, x)) => self.unary(UnaryFunction::Abs, x),
            (UnaryFunction::Abs, ExprNode::Unary(UnaryFunction::Abs | UnaryFunction::Sqrt | UnaryFunction::Exp, _)) => {
                a
            }
            _ => self.intern(ExprNode::Unary(op, a)),
        }
    }

    /// The absolute value of `a`.
    #[inline]
    pub fn abs(&mut self, a: ExprId) -> ExprId {
        self.unary(UnaryFunction::Abs, a)
    }

    /// The square root of `a`.
    #[inline]
    pub fn sqrt(&mut self, a: ExprId) -> ExprId {
        self.unary(UnaryFunction::Sqrt, a)
    }

    /// The largest whole number not above `a`. It makes no event.
    #[inline]
    pub fn floor(&mut self, a: ExprId) -> ExprId {
        self.unary(UnaryFunction::Floor, a)
    }

    /// The largest whole number not above `a`. A change of it is an event.
    #[inline]
    pub fn event_floor(&mut self, a: ExprId) -> ExprId {
        if self.as_num(a).is_some() { self.floor(a) } else { self.intern(ExprNode::EventFloor(a)) }
    }

    /// Known relations become numbers.
    /// A relation that makes no event.
    #[inline]
    pub fn rel(&mut self, rel: RelationalOp, a: ExprId, b: ExprId) -> ExprId {
        self.known_rel(rel, a, b).unwrap_or_else(|| self.intern(ExprNode::Rel(rel, a, b)))
    }

    /// Known relations become numbers, which never change.
    /// A relation whose change is an event.
    #[inline]
    pub fn event_rel(&mut self, rel: RelationalOp, a: ExprId, b: ExprId) -> ExprId {
        self.known_rel(rel, a, b).unwrap_or_else(|| self.intern(ExprNode::EventRel(rel, a, b)))
    }

    /// The value of a relation between equal operands or numbers. `None` if it is not known.
    /// Both kinds of relations use it.
    fn known_rel(&mut self, rel: RelationalOp, a: ExprId, b: ExprId) -> Option<ExprId> {
        // An operand that becomes NaN would make the relation false; this is ignored.
        if a == b {
            return Some(self.boolean(matches!(rel, RelationalOp::Le | RelationalOp::Ge | RelationalOp::Eq)));
        }
        let (x, y) = (self.as_num(a)?, self.as_num(b)?);
        Some(self.boolean(math::holds(rel, x, y)))
    }

    /// `if c then a else b`. A negated condition exchanges the branches.
    pub fn if_(&mut self, c: ExprId, a: ExprId, b: ExprId) -> ExprId {
        if let Some(known) = self.as_num(c) {
            return if known == 0.0 { b } else { a };
        }
        if a == b {
            return a;
        }
        match self.node(c) {
            ExprNode::Unary(UnaryFunction::Not, inner) => self.if_(inner, b, a),
            _ => self.intern(ExprNode::If(c, a, b)),
        }
    }

    /// `homotopy(actual, simplified)`.
    #[inline]
    pub fn homotopy(&mut self, actual: ExprId, simplified: ExprId) -> ExprId {
        if actual == simplified { actual } else { self.intern(ExprNode::Homotopy(actual, simplified)) }
    }

    /// `sample(start, interval)`: true at `start + k*interval`, in s.
    /// Both operands are parameter expressions.
    #[inline]
    pub fn sample(&mut self, start: ExprId, interval: ExprId) -> ExprId {
        self.intern(ExprNode::Sample(start, interval))
    }

    /// `delay(a, time)`. A number is its own delayed value.
    /// The time is in s.
    #[inline]
    pub fn delay(&mut self, a: ExprId, time: ExprId) -> ExprId {
        match self.node(a) {
            ExprNode::Num(_) => a,
            _ => self.intern(ExprNode::Delay(a, time)),
        }
    }

    /// The square of `a`, as a power.
    /// Powers with the exponent 2 are computed as products.
    #[inline]
    pub fn square(&mut self, a: ExprId) -> ExprId {
        let two = self.num(2.0);
        self.pow(a, two)
    }

    /// The sum of all terms from left to right. 0 if there are none.
    #[inline]
    pub fn sum(&mut self, terms: &[ExprId]) -> ExprId {
        terms.iter().fold(Self::ZERO, |sum, &term| self.add(sum, term))
    }

    /// The expression `x` if `e` is `-x`, or the positive number if `e` is a negative one. `None` for anything else.
    fn negative_of(&mut self, e: ExprId) -> Option<ExprId> {
        match self.node(e) {
            ExprNode::Unary(UnaryFunction::Neg, x) => Some(x),
            ExprNode::Num(bits) if f64::from_bits(bits) < 0.0 => Some(self.num(-f64::from_bits(bits))),
            _ => None,
        }
    }

    /// The negative of `op(a, b)`.
    /// It moves a sign out of a product or quotient.
    fn negated(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> ExprId {
        let positive = self.binary(op, a, b);
        self.neg(positive)
    }

    /// The value of `op(a, b)`. `None` unless both are numbers and the result is finite.
    fn fold(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> Option<ExprId> {
        let value = math::binary(op, self.as_num(a)?, self.as_num(b)?);
        value.is_finite().then(|| self.num(value))
    }

    /// `op(a, b)`, as a number if possible.
    /// It is for functions without further simplification.
    fn folded(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> ExprId {
        self.fold(op, a, b).unwrap_or_else(|| self.intern(ExprNode::Binary(op, a, b)))
    }

    /// `a op b`, or the node of `b op a` if that is in the pool already.
    fn commutative(&mut self, op: BinaryFunction, a: ExprId, b: ExprId) -> ExprId {
        self.find(&ExprNode::Binary(op, b, a)).unwrap_or_else(|| self.intern(ExprNode::Binary(op, a, b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VarId;

    fn pool() -> (Exprs, ExprId, ExprId) {
        let mut pool = Exprs::default();
        let (x, y) = (pool.var(VarId(0)), pool.var(VarId(1)));
        (pool, x, y)
    }

    #[test]
    fn numbers_fold_only_to_finite_ones() {
        let (mut p, ..) = pool();
        let (two, three) = (p.num(2.0), p.num(3.0));
        let six = p.mul(two, three);
        assert_eq!(p.as_num(six), Some(6.0));
        let infinite = p.div(two, Exprs::ZERO);
        assert_eq!(p.node(infinite), ExprNode::Binary(BinaryFunction::Div, two, Exprs::ZERO));
        let minus = p.num(-2.0);
        let root = p.sqrt(minus);
        assert_eq!(p.node(root), ExprNode::Unary(UnaryFunction::Sqrt, minus));
        let nothing = p.div(Exprs::ZERO, Exprs::ZERO);
        assert_eq!(p.as_num(nothing), None);
    }

    #[test]
    fn neutral_elements_vanish() {
        let (mut p, x, y) = pool();
        assert_eq!(p.add(x, Exprs::ZERO), x);
        assert_eq!(p.mul(Exprs::ONE, x), x);
        assert_eq!(p.mul(Exprs::ZERO, x), Exprs::ZERO);
        assert_eq!(p.sub(x, x), Exprs::ZERO);
        assert_eq!(p.div(x, Exprs::ONE), x);
        assert_eq!(p.pow(x, Exprs::ONE), x);
        let (a, b) = (p.add(x, y), p.add(y, x));
        assert_eq!(a, b);
    }

    #[test]
    fn signs_move_outwards() {
        let (mut p, x, y) = pool();
        let minus_y = p.neg(y);
        assert_eq!(p.neg(minus_y), y);
        let difference = p.sub(x, y);
        assert_eq!(p.add(x, minus_y), difference);
        assert_eq!(p.add(minus_y, x), difference);
        let turned = p.sub(y, x);
        assert_eq!(p.neg(difference), turned);
        let product = p.mul(x, y);
        let minus_product = p.neg(product);
        assert_eq!(p.mul(x, minus_y), minus_product);
        let quotient = p.div(x, y);
        let minus_x = p.neg(x);
        assert_eq!(p.div(minus_x, minus_y), quotient);
    }

    #[test]
    fn truth_values_fold() {
        let (mut p, x, y) = pool();
        let c = p.rel(RelationalOp::Lt, x, y);
        assert_eq!(p.and(c, Exprs::ONE), c);
        assert_eq!(p.and(Exprs::ZERO, c), Exprs::ZERO);
        assert_eq!(p.or(c, Exprs::ONE), Exprs::ONE);
        let no = p.not(c);
        assert_eq!(p.not(no), c);
        let (left, right) = (p.if_(no, x, y), p.if_(c, y, x));
        assert_eq!(left, right);
        assert_eq!(p.if_(Exprs::ONE, x, y), x);
        assert_eq!(p.event_rel(RelationalOp::Le, x, x), Exprs::ONE);
    }
}
