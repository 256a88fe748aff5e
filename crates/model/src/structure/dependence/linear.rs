//! Equations as sums: factors times unknowns and their derivatives, and a rest.
//!
//! [`LinearForm`] reads an equation, [`Monomial`] is a factor. The other files of `dependence` compute with them.

use super::super::draft::DaeDraft;
use super::super::parameters::SignAnalysis;
use super::offsets::ChainPosition;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};

/// A number times integer powers of expressions: of parameters, or of what changes, such as a density.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Monomial {
    /// The numeric part.
    pub number: f64,
    /// Expressions with their exponents, in ascending order of expressions. No exponent is 0.
    powers: Vec<(ExprId, i32)>,
}

impl Monomial {
    /// The factor 1.
    pub const ONE: Monomial = Monomial::number(1.0);

    /// A factor that is a number.
    pub const fn number(number: f64) -> Self {
        Monomial { number, powers: Vec::new() }
    }

    #[cfg(test)]
    pub fn of(e: ExprId) -> Self {
        Monomial { number: 1.0, powers: vec![(e, 1)] }
    }

    /// The factor with another numeric part.
    pub fn with_number(self, number: f64) -> Self {
        Monomial { number, ..self }
    }

    /// The factor with the opposite sign.
    pub fn negative(mut self) -> Self {
        self.number = -self.number;
        self
    }

    /// The product with another factor, or the quotient where `exponent` is -1.
    pub fn times(mut self, other: &Monomial, exponent: i32) -> Self {
        self.number *= other.number.powi(exponent);
        other.powers.iter().for_each(|&(e, power)| self.raise(e, power * exponent));
        self
    }

    /// The product with a power of an expression. A number goes into the numeric part.
    fn times_expression(mut self, pool: &Exprs, e: ExprId, exponent: i32) -> Self {
        match pool.as_num(e) {
            Some(number) => self.number *= number.powi(exponent),
            None => self.raise(e, exponent),
        }
        self
    }

    /// Adds to the exponent of an expression.
    /// An exponent that becomes 0 is removed.
    fn raise(&mut self, e: ExprId, exponent: i32) {
        match self.powers.binary_search_by_key(&e, |power| power.0) {
            Ok(at) => {
                self.powers[at].1 += exponent;
                if self.powers[at].1 == 0 {
                    self.powers.remove(at);
                }
            }
            Err(at) => self.powers.insert(at, (e, exponent)),
        }
    }

    /// Whether two factors differ by a number only.
    /// Like terms can be added.
    pub fn is_like(&self, other: &Monomial) -> bool {
        self.powers == other.powers
    }

    /// Whether it contains no expression.
    pub fn is_number(&self) -> bool {
        self.powers.is_empty()
    }

    /// The expressions that it contains.
    /// Powers are written as repeated products and quotients.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.powers.iter().map(|power| power.0)
    }

    /// Its value with the parameters as they are. An expression that changes gets a value of its own, different from
    /// that of any other expression, so that sums cancel only where the same expressions do.
    /// So a sum that vanishes here vanishes for all values of what changes, but for rounding.
    pub fn value(&self, draft: &DaeDraft, known: &mut SignAnalysis) -> f64 {
        self.powers.iter().fold(self.number, |product, &(e, exponent)| {
            // Multiples of the golden ratio modulo 1, which never repeat.
            let some = || 1.0 + (f64::from(e.0 + 1) * 0.618_033_988_749_894_9).fract();
            product * known.value(&draft.exprs, e).unwrap_or_else(some).powi(exponent)
        })
    }

    /// The factor as an expression of the pool.
    pub fn expression(&self, pool: &mut Exprs) -> ExprId {
        let number = pool.num(self.number);
        self.powers.iter().fold(number, |product, &(e, exponent)| {
            (0..exponent.abs()).fold(product, |product, _| match exponent > 0 {
                true => pool.mul(product, e),
                false => pool.div(product, e),
            })
        })
    }
}

/// The terms of `lhs - rhs` of an equation.
#[derive(Clone, Debug, Default)]
pub(super) struct LinearForm {
    /// Unknowns and their derivatives with their factors. A place may occur more than once.
    pub terms: Vec<(ChainPosition, Monomial)>,
    /// All other terms with their factors.
    pub rest: Vec<(ExprId, Monomial)>,
}

impl LinearForm {
    /// Splits an equation into terms. `place` gives the chain and order of a leaf that is an unknown; for other leaves
    /// it is `None`. A product counts as a term of an unknown if one of its sides is the unknown.
    pub fn new(
        draft: &DaeDraft,
        known: &mut SignAnalysis,
        [lhs, rhs]: [ExprId; 2],
        place: impl Fn(ExprNode) -> Option<ChainPosition>,
    ) -> Self {
        let pool = &draft.exprs;
        let mut is_number = |e: ExprId| pool.as_num(e).is_some() || known.value(pool, e).is_some();
        let is_unknown = |e: ExprId| match pool.node(e) {
            ExprNode::Unary(UnaryFunction::Neg, a) => place(pool.node(a)).is_some(),
            node => place(node).is_some(),
        };
        let mut found = LinearForm::default();
        let mut open = vec![(rhs, Monomial::ONE.negative()), (lhs, Monomial::ONE)];
        while let Some((e, factor)) = open.pop() {
            let node = pool.node(e);
            if e == Exprs::ZERO {
                continue;
            }
            if let Some(place) = place(node) {
                found.terms.push((place, factor));
                continue;
            }
            match node {
                ExprNode::Unary(UnaryFunction::Neg, a) => open.push((a, factor.negative())),
                ExprNode::Binary(BinaryFunction::Add, a, b) => open.extend([(b, factor.clone()), (a, factor)]),
                ExprNode::Binary(BinaryFunction::Sub, a, b) => {
                    open.extend([(b, factor.clone().negative()), (a, factor)])
                }
                ExprNode::Binary(BinaryFunction::Mul, a, b) => {
                    // numbers first; then what is multiplied with an unknown
                    let of = |other: ExprId, by: ExprId| (other, factor.clone().times_expression(pool, by, 1));
                    match (is_number(a), is_number(b), is_unknown(a), is_unknown(b)) {
                        (true, ..) => open.push(of(b, a)),
                        (_, true, ..) => open.push(of(a, b)),
                        // Exactly one side is an unknown: the other side is its factor.
                        (_, _, false, true) => open.push(of(b, a)),
                        (_, _, true, false) => open.push(of(a, b)),
                        _ => found.rest.push((e, factor)),
                    }
                }
                ExprNode::Binary(BinaryFunction::Div, a, b) if is_number(b) || is_unknown(a) && !is_unknown(b) => {
                    open.push((a, factor.times_expression(pool, b, -1)));
                }
                _ => found.rest.push((e, factor)),
            }
        }
        found
    }
}
