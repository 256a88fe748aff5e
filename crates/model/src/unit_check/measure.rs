//! What is known about the unit of an expression, and how operators combine it.
//!
//! The check must not warn where it is unsure. A number in a model may hide a quantity (`9.81*m` is a force, `x/1e-3`
//! has no dimension). So a number other than a small ratio makes a product unknown, and fits anywhere in a sum. `infer`
//! computes with [`UnitKnowledge`]; the parent module compares [`PartialUnit`]s.

use bramah_expr::print::number;
use bramah_expr::units::power_of;
use bramah_expr::units::{Dimension, MeasurementUnit};
use std::f64::consts::{PI, TAU};

/// A unit as far as it is known. `factor` and `offset` are as in [`MeasurementUnit`], NaN where they are not known.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartialUnit {
    /// The exponents of the SI base units.
    pub dimension: Dimension,
    /// The exponent of the radian, in sixtieths, so that roots have whole exponents.
    pub angle: i16,
    /// The size of the unit in coherent SI units.
    pub factor: f64,
    /// The zero point in coherent SI units, as 273.15 for degC.
    pub offset: f64,
}

/// What is known about the unit of an expression.
#[derive(Clone, Copy, Debug)]
pub(super) enum UnitKnowledge {
    /// Nothing.
    Unknown,
    /// A count, a truth value, a small ratio or the result of `sin` and the like. It fits anywhere and is 1 in
    /// products.
    Number,
    /// A number with a factor pi, which may convert angles. It fits anywhere and leaves only the dimension in products.
    Circle,
    /// Any other number, which may be a quantity. It fits anywhere and makes products unknown.
    Wild,
    /// A unit, at least its dimension.
    Known(PartialUnit),
}

/// How two units that should be the same differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnitDifference {
    /// In their dimension: no conversion is possible.
    Dimension,
    /// In factor or offset, with the same dimension.
    Factor,
}

impl PartialUnit {
    /// The unit of plain numbers.
    pub const NUMBER: PartialUnit = PartialUnit { dimension: Dimension::NONE, angle: 0, factor: 1.0, offset: 0.0 };
    /// The second.
    pub const SECOND: PartialUnit = PartialUnit { dimension: Dimension::TIME, ..PartialUnit::NUMBER };

    /// The unit that was read from a string.
    pub fn of(unit: &MeasurementUnit) -> Self {
        PartialUnit { dimension: unit.dimension, angle: unit.angle, factor: unit.factor(), offset: unit.offset }
    }

    /// The product of two units. Unknown if an exponent is too large.
    pub fn times(self, other: PartialUnit) -> UnitKnowledge {
        let dimension = self.dimension.times(other.dimension);
        let angle = self.angle.checked_add(other.angle);
        Self::made(dimension, angle, self.factor * other.factor)
    }

    /// The quotient of two units. Unknown if an exponent is too large.
    pub fn over(self, other: PartialUnit) -> UnitKnowledge {
        let dimension = self.dimension.over(other.dimension);
        let angle = self.angle.checked_sub(other.angle);
        Self::made(dimension, angle, self.factor / other.factor)
    }

    /// A power of a unit. Unknown where an exponent would be no fraction that can be represented.
    pub fn power(self, exponent: f64) -> UnitKnowledge {
        let angle = power_of(self.angle, exponent);
        Self::made(self.dimension.power(exponent), angle, self.factor.powf(exponent))
    }

    /// The same unit with an unknown zero point.
    pub fn shifted(self) -> PartialUnit {
        PartialUnit { offset: f64::NAN, ..self }
    }

    /// A unit from exponents that may not exist. Products and powers have no zero point.
    fn made(dimension: Option<Dimension>, angle: Option<i16>, factor: f64) -> UnitKnowledge {
        match (dimension, angle) {
            (Some(dimension), Some(angle)) => {
                UnitKnowledge::Known(PartialUnit { dimension, angle, factor, offset: 0.0 })
            }
            _ => UnitKnowledge::Unknown,
        }
    }

    /// How two units differ; `None` where they agree as far as both are known.
    pub fn difference(self, other: PartialUnit) -> Option<UnitDifference> {
        if self.dimension != other.dimension {
            return Some(UnitDifference::Dimension);
        }
        let ratio = self.factor / other.factor;
        // `1/min` may count revolutions: a factor 2 pi against a unit without angle is no difference.
        let counts = (self.angle == 0) != (other.angle == 0) && (same(ratio, TAU) || same(ratio * TAU, 1.0));
        let factor = !ratio.is_nan() && !same(ratio, 1.0) && !counts;
        // A comparison with NaN is false, so unknown offsets agree with any.
        let offset = (self.offset - other.offset).abs() > 1e-6;
        (factor || offset).then_some(UnitDifference::Factor)
    }

    /// Combines what is known of two units that are the same.
    fn merge(self, other: PartialUnit) -> PartialUnit {
        let known = |a: f64, b: f64| if a.is_nan() { b } else { a };
        PartialUnit { factor: known(self.factor, other.factor), offset: known(self.offset, other.offset), ..self }
    }
}

/// Whether two factors agree up to the digits with which units are written.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * b.abs()
}

impl UnitKnowledge {
    /// What a literal number may be.
    pub fn of_number(value: f64) -> UnitKnowledge {
        let turns = value / PI;
        if is_small_ratio(value, &[1.0, 2.0, 3.0, 4.0]) {
            UnitKnowledge::Number
        } else if is_small_ratio(turns, &[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 32.0, 64.0]) {
            UnitKnowledge::Circle
        } else {
            UnitKnowledge::Wild
        }
    }

    /// The unit, if it is one.
    pub fn known(self) -> Option<PartialUnit> {
        match self {
            UnitKnowledge::Known(quantity) => Some(quantity),
            _ => None,
        }
    }

    /// The unit that it contributes to a product; `None` where that is not known.
    fn as_factor(self) -> Option<PartialUnit> {
        match self {
            UnitKnowledge::Number => Some(PartialUnit::NUMBER),
            UnitKnowledge::Circle => Some(PartialUnit { factor: f64::NAN, ..PartialUnit::NUMBER }),
            UnitKnowledge::Known(quantity) => Some(quantity),
            UnitKnowledge::Unknown | UnitKnowledge::Wild => None,
        }
    }

    /// The unit of a product.
    pub fn times(self, other: UnitKnowledge) -> UnitKnowledge {
        self.product(other, PartialUnit::times)
    }

    /// The unit of a quotient.
    pub fn over(self, other: UnitKnowledge) -> UnitKnowledge {
        self.product(other, PartialUnit::over)
    }

    /// The unit of a product or quotient; `op` combines known units.
    fn product(self, other: UnitKnowledge, op: fn(PartialUnit, PartialUnit) -> UnitKnowledge) -> UnitKnowledge {
        use UnitKnowledge::{Circle, Known, Number, Unknown, Wild};
        match (self, other) {
            (Unknown, _) | (_, Unknown) | (Wild, Known(_)) | (Known(_), Wild) => Unknown,
            (Wild, _) | (_, Wild) => Wild,
            (Number, Number) => Number,
            (Number | Circle, Number | Circle) => Circle,
            // Twice a temperature in degC may be the first half of a mean.
            (Known(quantity), Number) if quantity.offset.is_nan() => self,
            (Number, Known(quantity)) if quantity.offset.is_nan() => {
                op(PartialUnit::NUMBER, quantity).with_free_offset()
            }
            _ => match (self.as_factor(), other.as_factor()) {
                (Some(a), Some(b)) => op(a, b),
                _ => Unknown,
            },
        }
    }

    /// The same with an unknown zero point, if it is a unit.
    fn with_free_offset(self) -> UnitKnowledge {
        self.known().map_or(self, |quantity| UnitKnowledge::Known(quantity.shifted()))
    }

    /// The unit of a power with this exponent.
    pub fn power(self, exponent: f64) -> UnitKnowledge {
        match self {
            UnitKnowledge::Known(quantity) => quantity.power(exponent),
            UnitKnowledge::Circle => UnitKnowledge::Wild,
            other => other,
        }
    }

    /// What is known of two sides that must be the same. A [`UnitKnowledge::Wild`] number leaves the zero point open.
    pub fn join(self, other: UnitKnowledge) -> UnitKnowledge {
        use UnitKnowledge::{Known, Number, Unknown, Wild};
        match (self, other) {
            (Known(a), Known(b)) => Known(a.merge(b)),
            (Known(a), Wild) | (Wild, Known(a)) => Known(a.shifted()),
            (Known(a), _) | (_, Known(a)) => Known(a),
            (Unknown, _) | (_, Unknown) => Unknown,
            (Number, Number) => Number,
            _ => Wild,
        }
    }

    /// The unit of a sum (`sign` 1) or difference (-1).
    ///
    /// The difference of two temperatures has no zero point. A temperature plus a difference is a temperature again;
    /// which of the two terms is the temperature is not known, so neither is the zero point of the sum.
    pub fn sum(self, other: UnitKnowledge, sign: f64) -> UnitKnowledge {
        let joined = self.join(other);
        let (UnitKnowledge::Known(a), UnitKnowledge::Known(b)) = (self, other) else { return joined };
        let offset = match (a.offset, b.offset) {
            (0.0, 0.0) => 0.0,
            (x, y) if x == y && sign < 0.0 => 0.0,
            _ => f64::NAN,
        };
        joined.known().map_or(joined, |q| UnitKnowledge::Known(PartialUnit { offset, ..q }))
    }
}

/// Whether a number is, but for its sign, `p/q` with `p` from 1 to 4 and `q` among the denominators.
fn is_small_ratio(value: f64, denominators: &[f64]) -> bool {
    denominators.iter().any(|q| {
        let p = value.abs() * q;
        (1.0..=4.0).contains(&p.round()) && (p - p.round()).abs() < 1e-12
    })
}

/// Prints as `Pa`, or as `0.01 1/s` for a unit that is not coherent.
impl std::fmt::Display for PartialUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.factor.is_nan() && !same(self.factor, 1.0) {
            write!(f, "{} ", number(self.factor, Some(6)))?;
        }
        match (self.angle, self.dimension.is_none()) {
            (0, _) => write!(f, "{}", self.dimension)?,
            // 60 is one radian; other angles are left out.
            (60, true) => write!(f, "rad")?,
            (60, false) if self.dimension.to_string().starts_with("1/") => {
                write!(f, "rad{}", &self.dimension.to_string()[1..])?;
            }
            _ => write!(f, "{}", self.dimension)?,
        }
        if self.offset > 0.0 { write!(f, " from {} K", number(self.offset, Some(6))) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_classed() {
        for x in [1.0, 2.0, -0.5, 0.25, 4.0, 1.0 / 3.0, 4.0 / 3.0] {
            assert!(matches!(UnitKnowledge::of_number(x), UnitKnowledge::Number), "{x}");
        }
        for x in [PI, TAU, PI / 4.0, 4.0 / 3.0 * PI] {
            assert!(matches!(UnitKnowledge::of_number(x), UnitKnowledge::Circle), "{x}");
        }
        for x in [0.0, 60.0, 1e5, 9.81, 3.6, 1e-3, 10.0] {
            assert!(matches!(UnitKnowledge::of_number(x), UnitKnowledge::Wild), "{x}");
        }
    }
}
