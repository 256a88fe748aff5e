//! Equations as sums: factors times unknowns and their derivatives, and a rest.

use super::super::draft::DaeDraft;
use super::super::parameters::SignAnalysis;
use super::offsets::ChainPosition;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};

/// A number times powers of expressions: of parameters, or of what changes, such as a density.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Monomial {
    pub number: f64,
    /// Ascending; no exponent is 0.
    powers: Vec<(ExprId, i32)>,
}

impl Monomial {
    pub const ONE: Monomial = Monomial::number(1.0);

    pub const fn number(number: f64) -> Self {
        Monomial { number, powers: Vec::new() }
    }

    #[cfg(test)]
    pub fn of(e: ExprId) -> Self {
        Monomial { number: 1.0, powers: vec![(e, 1)] }
    }

    pub fn with_number(self, number: f64) -> Self {
        Monomial { number, ..self }
    }

    pub fn negative(mut self) -> Self {
        self.number = -self.number;
        self
    }

    /// Times another one, or divided by it where `exponent` is -1.
    pub fn times(mut self, other: &Monomial, exponent: i32) -> Self {
        self.number *= other.number.powi(exponent);
        other.powers.iter().for_each(|&(e, power)| self.raise(e, power * exponent));
        self
    }

    fn times_expression(mut self, pool: &Exprs, e: ExprId, exponent: i32) -> Self {
        match pool.as_num(e) {
            Some(number) => self.number *= number.powi(exponent),
            None => self.raise(e, exponent),
        }
        self
    }

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

    /// Whether two of them differ by a number only.
    pub fn is_like(&self, other: &Monomial) -> bool {
        self.powers == other.powers
    }

    pub fn is_number(&self) -> bool {
        self.powers.is_empty()
    }

    /// The expressions that it is made of.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.powers.iter().map(|power| power.0)
    }

    /// With the parameters as they stand in the model. What changes has some value that nothing else has, so that sums
    /// cancel only where the same expressions do.
    pub fn value(&self, draft: &DaeDraft, known: &mut SignAnalysis) -> f64 {
        self.powers.iter().fold(self.number, |product, &(e, exponent)| {
            let some = || 1.0 + (f64::from(e.0 + 1) * 0.618_033_988_749_894_9).fract();
            product * known.value(&draft.exprs, e).unwrap_or_else(some).powi(exponent)
        })
    }

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

/// `lhs - rhs` of an equation.
#[derive(Clone, Debug, Default)]
pub(super) struct LinearForm {
    /// Unknowns and their derivatives with their factors; one may stand there more than once.
    pub terms: Vec<(ChainPosition, Monomial)>,
    /// All other terms.
    pub rest: Vec<(ExprId, Monomial)>,
}

impl LinearForm {
    /// `place` says which leaves are unknowns.
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
