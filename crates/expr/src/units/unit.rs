//! Unit strings in the notation of Modelica (3.6, chapter 19), and conversions between units.
//!
//! The grammar is `unit = factor {("." | "*") factor} {"/" factor}`. A factor is `1`, a unit in brackets, or a symbol
//! with
//! an optional exponent (`m2`, `s-1`, `m^2`). No product may follow a `/`: `J/kg.K` is refused, as in Modelica, because
//! it
//! can be read in two ways.

use super::dimension::{Dimension, WHOLE, power_of};
use super::symbols::{self, UnitSymbol};

/// A unit of measurement. A value x in it is `x*factor + offset` in coherent SI units.
///
/// The factor is stored as `num*10^decade/den`, so that 0.8 ml in m3 is the number nearest to 8e-7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementUnit {
    /// The dimension. That of an angle is 1.
    pub dimension: Dimension,
    /// The exponent of the angle in sixtieths, which [`Dimension`] ignores: 60 for `rad/s`, 0 for `1/s`.
    pub angle: i16,
    /// The numerator of the factor.
    num: f64,
    /// The denominator of the factor.
    den: f64,
    /// The power of ten of the factor.
    decade: i32,
    /// The SI value of the unit's zero (K). It is not 0 only for temperatures such as `degC`.
    pub offset: f64,
}

/// The reason why a text is no unit or quantity.
#[derive(Clone, Debug, PartialEq, Eq, Hash, thiserror::Error)]
pub enum UnitError {
    /// A symbol is not known.
    #[error("`{part}` in the unit `{unit}` is not known")]
    Unknown {
        /// The unknown symbol.
        part: String,
        /// The complete unit string.
        unit: String,
    },
    /// The text ends too early, or continues where it should end.
    #[error("the unit `{unit}` cannot be read from `{rest}` on")]
    Form {
        /// The first part that cannot be read.
        rest: String,
        /// The complete unit string.
        unit: String,
    },
    /// A product follows a quotient: `a/b.c`.
    #[error("the unit `{unit}` can be read in two ways: write `a/(b.c)`, or the product before the `/`")]
    Ambiguous {
        /// The complete unit string.
        unit: String,
    },
    /// The text before a unit is no number.
    #[error("`{text}` is not a number")]
    NotNumber {
        /// The text that should be a number.
        text: String,
    },
}

impl MeasurementUnit {
    /// The unit of a pure number.
    pub const ONE: MeasurementUnit =
        MeasurementUnit { dimension: Dimension::NONE, angle: 0, num: 1.0, den: 1.0, decade: 0, offset: 0.0 };

    /// Reads a unit string. The empty one is the unit of a pure number.
    ///
    /// # Errors
    /// The text is no unit.
    pub fn parse(text: &str) -> Result<MeasurementUnit, UnitError> {
        if text.trim().is_empty() {
            return Ok(MeasurementUnit::ONE);
        }
        let mut parser = UnitParser { unit: text.trim(), rest: text.trim() };
        let unit = parser.unit(0)?;
        if parser.rest.is_empty() { Ok(unit) } else { Err(parser.form()) }
    }

    /// The number of coherent SI units that the unit is, without its offset.
    pub fn factor(&self) -> f64 {
        ratio(1.0, self.num, self.den, self.decade)
    }

    /// The exponents of kg, m, s, A, K, mol, cd and rad. `None` if one is not an integer.
    pub fn exponents(&self) -> Option<[i16; 8]> {
        let [kg, m, s, a, k, mol, cd] = self.dimension.whole()?;
        let angle = (self.angle % WHOLE == 0).then_some(self.angle / WHOLE)?;
        Some([kg, m, s, a, k, mol, cd, angle])
    }

    /// A value in this unit, converted to coherent SI units.
    pub fn to_si(&self, value: f64) -> f64 {
        ratio(value, self.num, self.den, self.decade) + self.offset
    }

    /// A value in this unit, converted to another one. `None` if the dimensions differ; angles are not compared.
    /// Between decimal multiples of one unit, the result is the number nearest to the exact one.
    pub fn convert(&self, value: f64, to: &MeasurementUnit) -> Option<f64> {
        let from = self;
        if from.dimension != to.dimension {
            return None;
        }
        // Equal units keep the value to the bit.
        if from.offset == to.offset && from.factor() == to.factor() {
            return Some(value);
        }
        let (num, den) = (from.num * to.den, from.den * to.num);
        let scaled = ratio(value, num, den, from.decade - to.decade);
        let shift = from.offset - to.offset;
        // The shift between the zeros is in SI units and has to be converted too.
        Some(if shift == 0.0 { scaled } else { scaled + ratio(shift, to.den, to.num, -to.decade) })
    }

    /// The unit of a value, or of a difference of two values. A difference has no offset: 5 degC are then 5 K.
    #[must_use]
    pub fn meant(self, difference: bool) -> MeasurementUnit {
        MeasurementUnit { offset: if difference { 0.0 } else { self.offset }, ..self }
    }

    /// The unit of a symbol.
    fn of(symbol: UnitSymbol) -> MeasurementUnit {
        let UnitSymbol { dimension, angle, num, den, decade, offset } = symbol;
        MeasurementUnit { dimension, angle: 60 * angle, num, den, decade, offset }
    }

    /// The product. The offset is dropped: in `W/degC` a degree is a difference. `None` if an exponent overflows.
    fn times(self, other: MeasurementUnit) -> Option<MeasurementUnit> {
        Some(MeasurementUnit {
            dimension: self.dimension.times(other.dimension)?,
            angle: self.angle.checked_add(other.angle)?,
            num: self.num * other.num,
            den: self.den * other.den,
            decade: self.decade.checked_add(other.decade)?,
            offset: 0.0,
        })
    }

    /// A power. Fractional exponents occur in flow coefficients, such as `m3/(s.Pa0.5)`. `None` if an exponent
    /// overflows.
    fn power(self, exponent: f64) -> Option<MeasurementUnit> {
        // Keeps the offset, which every other power drops.
        if exponent == 1.0 {
            return Some(self);
        }
        // Exchanged instead of inverted, so that no rounding occurs.
        let (num, den) = if exponent < 0.0 { (self.den, self.num) } else { (self.num, self.den) };
        let decade = f64::from(self.decade) * exponent;
        // The fractional part of the power of ten goes into the number.
        let rest = 10f64.powf(decade.fract());
        let (num, den) = (num.powf(exponent.abs()) * rest, den.powf(exponent.abs()));
        if !num.is_finite() || !den.is_finite() || decade.abs() > f64::from(i16::MAX) {
            return None;
        }
        Some(MeasurementUnit {
            dimension: self.dimension.power(exponent)?,
            angle: power_of(self.angle, exponent)?,
            num,
            den,
            decade: decade.trunc() as i32,
            offset: 0.0,
        })
    }
}

/// `value*num*10^decade/den`, by one multiplication and one division where the power of ten is exact.
fn ratio(value: f64, num: f64, den: f64, decade: i32) -> f64 {
    // Powers of ten up to 1e22 are exact; 0.001 is not, so a negative power is a division.
    let power = 10f64.powi(decade.abs());
    if decade < 0 { value * num / (den * power) } else { value * (num * power) / den }
}

/// Reads a number with or without a unit: `5e5`, `210 bar`, `20degC`. The unit is `None` if there is none.
///
/// # Errors
/// The text does not begin with a number, or the rest is no unit.
pub fn quantity(text: &str) -> Result<(f64, Option<MeasurementUnit>), UnitError> {
    let text = text.trim();
    let (number, rest) = text.split_at(number_length(text));
    let value = number.parse().map_err(|_| UnitError::NotNumber { text: text.into() })?;
    let rest = rest.trim();
    let unit = if rest.is_empty() { None } else { Some(MeasurementUnit::parse(rest)?) };
    Ok((value, unit))
}

/// The number of bytes at the beginning that are a decimal number.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let power = end + 1 + sign(end + 1);
        // Without digits the `e` belongs to the unit.
        if digits(power) > 0 {
            end = power + digits(power);
        }
    }
    end
}

/// The largest nesting of brackets, which bounds the recursion.
const DEEPEST: u32 = 50;

/// The state of reading a unit string.
/// It reads from left to right without going back.
struct UnitParser<'a> {
    /// The complete string, for messages.
    unit: &'a str,
    /// The part that is still to be read.
    rest: &'a str,
}

impl UnitParser<'_> {
    /// The error that the string cannot be read at this place.
    fn form(&self) -> UnitError {
        let rest = if self.rest.is_empty() { "its end" } else { self.rest };
        UnitError::Form { rest: rest.into(), unit: self.unit.into() }
    }

    /// Skips blanks and a character, if it comes next. False if another one comes.
    /// Blanks after it are skipped too.
    fn eat(&mut self, wanted: char) -> bool {
        let found = self.rest.trim_start().strip_prefix(wanted);
        if let Some(rest) = found {
            self.rest = rest.trim_start();
        }
        found.is_some()
    }

    /// A unit: factors joined by products and quotients. `depth` is the nesting of brackets.
    /// A product after a quotient is an error, because its meaning is ambiguous.
    fn unit(&mut self, depth: u32) -> Result<MeasurementUnit, UnitError> {
        let mut product = self.factor(depth)?;
        let mut below = false;
        loop {
            let next = if self.eat('/') {
                below = true;
                self.factor(depth)?.power(-1.0)
            } else if self.eat('.') || self.eat('*') || self.eat('\u{b7}') {
                if below {
                    return Err(UnitError::Ambiguous { unit: self.unit.into() });
                }
                Some(self.factor(depth)?)
            } else {
                return Ok(product);
            };
            product = next.and_then(|next| product.times(next)).ok_or_else(|| self.form())?;
        }
    }

    /// A factor: a symbol or a unit in brackets, with an optional exponent.
    /// Brackets may nest [`DEEPEST`] levels deep.
    fn factor(&mut self, depth: u32) -> Result<MeasurementUnit, UnitError> {
        let base = if depth < DEEPEST && self.eat('(') {
            let inner = self.unit(depth + 1)?;
            if !self.eat(')') {
                return Err(self.form());
            }
            inner
        } else {
            self.symbol()?
        };
        // `1` takes no exponent, so that `10` is no unit.
        let exponent = if base == MeasurementUnit::ONE { 1.0 } else { self.exponent()? };
        base.power(exponent).ok_or_else(|| self.form())
    }

    /// A symbol, up to the first character that cannot belong to one.
    /// Letters, `%`, the degree sign and `_` may belong to a symbol; `1` is one on its own.
    fn symbol(&mut self) -> Result<MeasurementUnit, UnitError> {
        let letter = |c: char| c.is_alphabetic() || matches!(c, '%' | '\u{b0}' | '_');
        let end = self.rest.find(|c| !letter(c)).unwrap_or(self.rest.len());
        let (name, rest) = if self.rest.starts_with('1') { self.rest.split_at(1) } else { self.rest.split_at(end) };
        if name.is_empty() {
            return Err(self.form());
        }
        let symbol =
            symbols::lookup(name).ok_or_else(|| UnitError::Unknown { part: name.into(), unit: self.unit.into() })?;
        self.rest = rest;
        Ok(MeasurementUnit::of(symbol))
    }

    /// The exponent after a symbol or `^`, an integer or a half (`2`, `-1`, `0.5`). 1 if there is none.
    fn exponent(&mut self) -> Result<f64, UnitError> {
        // The superscripts for 2 and 3.
        for (symbol, exponent) in [('\u{b2}', 2.0), ('\u{b3}', 3.0)] {
            if let Some(rest) = self.rest.strip_prefix(symbol) {
                self.rest = rest;
                return Ok(exponent);
            }
        }
        let raised = self.eat('^');
        let bracket = raised && self.eat('(');
        let sign = usize::from(self.rest.starts_with(['+', '-']));
        let digits = self.rest[sign..].bytes().take_while(u8::is_ascii_digit).count();
        if digits == 0 {
            return if raised || sign > 0 { Err(self.form()) } else { Ok(1.0) };
        }
        let end = sign + digits;
        // A point is a product, unless a 5 follows, which begins no unit.
        let half =
            self.rest[end..].strip_prefix(".5").is_some_and(|after| !after.starts_with(|c: char| c.is_ascii_digit()));
        let end = if half { end + 2 } else { end };
        let exponent: f64 = self.rest[..end].parse().map_err(|_| self.form())?;
        self.rest = &self.rest[end..];
        if bracket && !self.eat(')') {
            return Err(self.form());
        }
        Ok(exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit, factor, coherent SI unit.
    const UNITS: &[(&str, f64, &str)] = &[
        ("1", 1.0, "1"),
        ("Pa", 1.0, "Pa"),
        ("bar", 1e5, "Pa"),
        ("mbar", 1e2, "Pa"),
        ("MPa", 1e6, "Pa"),
        ("N/m2", 1.0, "Pa"),
        ("N.m", 1.0, "J"),
        ("N*m", 1.0, "J"),
        ("J/(kg.K)", 1.0, "J/(kg.K)"),
        ("l", 1e-3, "m3"),
        ("l/min", 1.0 / 60000.0, "m3/s"),
        ("ml", 1e-6, "m3"),
        ("cm3", 1e-6, "m3"),
        ("mm2/s", 1e-6, "m2/s"),
        ("cSt", 1e-6, "m2/s"),
        ("cP", 1e-3, "Pa.s"),
        ("m3/(s.Pa0.5)", 1.0, "m^3.5/kg^0.5"),
        ("l/(min.bar0.5)", 5.270_462_766_947_298e-8, "m^3.5/kg^0.5"),
        ("m0.5/s", 1.0, "m^0.5/s"),
        ("m^2", 1.0, "m2"),
        ("m^(-2)", 1.0, "1/m2"),
        ("s-1", 1.0, "1/s"),
        ("Hz", 1.0, "1/s"),
        ("1/min", 1.0 / 60.0, "1/s"),
        ("rev/min", std::f64::consts::TAU / 60.0, "1/s"),
        ("r/min", std::f64::consts::TAU / 60.0, "1/s"),
        ("rpm", std::f64::consts::TAU / 60.0, "1/s"),
        ("cc", 1e-6, "m3"),
        ("lpm", 1.0 / 6e4, "m3/s"),
        ("gpm", 3_785_411_784.0 / 6e13, "m3/s"),
        ("kNm", 1e3, "J"),
        ("rad/s", 1.0, "1/s"),
        ("deg", std::f64::consts::PI / 180.0, "1"),
        ("%", 0.01, "1"),
        ("min", 60.0, "s"),
        ("h", 3600.0, "s"),
        ("d", 86400.0, "s"),
        ("t", 1000.0, "kg"),
        ("kg.cm2", 1e-4, "kg.m2"),
        ("kN", 1e3, "N"),
        ("daN", 10.0, "N"),
        ("kW", 1e3, "W"),
        ("mH", 1e-3, "H"),
        ("uF", 1e-6, "F"),
        ("\u{b5}m", 1e-6, "m"),
        ("kOhm", 1e3, "Ohm"),
        ("V.s/rad", 1.0, "Wb"),
        ("Wb", 1.0, "Wb"),
        ("T", 1.0, "T"),
        ("K", 1.0, "K"),
        ("1/K", 1.0, "1/K"),
        ("W/degC", 1.0, "W/K"),
        ("m/s/s", 1.0, "m/s2"),
        ("psi", 6894.757293168, "Pa"),
        ("kg/(m.s)", 1.0, "Pa.s"),
        ("N.s/m", 1.0, "kg/s"),
        ("(N.s)/(m)", 1.0, "kg/s"),
        ("kg/m\u{b3}", 1.0, "kg/m3"),
        ("kW.h", 3.6e6, "J"),
        ("V.s/m", 1.0, "kg.m/(s2.A)"),
        ("", 1.0, "1"),
        ("m3/(s.Pa)", 1.0, "m4.s/kg"),
    ];

    #[test]
    fn units_have_factor_and_dimension() {
        for &(text, factor, si) in UNITS {
            let unit = MeasurementUnit::parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!((unit.factor(), unit.dimension.to_string().as_str()), (factor, si), "{text}");
        }
    }

    #[test]
    fn errors_name_the_part() {
        let cases = [
            ("N/foo", "`foo` in the unit `N/foo` is not known"),
            ("kbars", "`kbars` in the unit `kbars` is not known"),
            ("J/kg.K", "the unit `J/kg.K` can be read in two ways: write `a/(b.c)`, or the product before the `/`"),
            ("m/", "the unit `m/` cannot be read from `its end` on"),
            ("(m", "the unit `(m` cannot be read from `its end` on"),
            ("m)", "the unit `m)` cannot be read from `)` on"),
            ("m2.7", "the unit `m2.7` cannot be read from `7` on"),
            ("10", "the unit `10` cannot be read from `0` on"),
            ("m999999", "the unit `m999999` cannot be read from `its end` on"),
        ];
        for (text, message) in cases {
            assert_eq!(MeasurementUnit::parse(text).map_err(|e| e.to_string()), Err(message.to_string()));
        }
        let deep = "(".repeat(100_000);
        assert!(MeasurementUnit::parse(&deep).is_err());
    }

    #[test]
    fn conversions_are_exact_where_they_can_be() {
        let cases = [
            (210.0, "bar", "Pa", 210e5),
            (0.8, "ml", "m3", 0.8e-6),
            (6.0, "l/min", "m3/s", 1e-4),
            (20.0, "degC", "K", 293.15),
            (293.15, "K", "degC", 20.0),
            (3.0, "m", "m", 3.0),
            (50.0, "%", "1", 0.5),
            (1500.0, "rev/min", "rev/s", 25.0),
            (46.0, "cSt", "m2/s", 46e-6),
        ];
        for (value, from, to, expected) in cases {
            let (from, to) =
                (MeasurementUnit::parse(from).expect("a unit"), MeasurementUnit::parse(to).expect("a unit"));
            let converted = from.convert(value, &to).expect("same dimension");
            approx::assert_relative_eq!(converted, expected, max_relative = 2e-15);
        }
        let fahrenheit = MeasurementUnit::parse("degF").expect("a unit");
        let celsius = MeasurementUnit::parse("degC").expect("a unit");
        approx::assert_relative_eq!(fahrenheit.convert(212.0, &celsius).expect("both"), 100.0, epsilon = 1e-10);
        assert_eq!(celsius.convert(1.0, &MeasurementUnit::ONE), None);
    }

    #[test]
    fn quantities() {
        let bar = MeasurementUnit::parse("bar").ok();
        let cases = [
            ("210 bar", 210.0, bar),
            ("210bar", 210.0, bar),
            ("5e5", 5e5, None),
            (" -1.5E-3 ", -1.5e-3, None),
            (".5", 0.5, None),
            ("2eV", 2.0, MeasurementUnit::parse("eV").ok()),
            ("50 %", 50.0, MeasurementUnit::parse("%").ok()),
        ];
        for (text, value, unit) in cases {
            assert_eq!(quantity(text), Ok((value, unit)), "{text}");
        }
        assert!(matches!(quantity("bar"), Err(UnitError::NotNumber { .. })));
        assert!(matches!(quantity("3 quux"), Err(UnitError::Unknown { .. })));
    }

    #[test]
    fn units_of_shipped_classes() {
        let units = [
            "A.s/rad",
            "J/(mol.K)",
            "kW.h",
            "m3/(kg.s2)",
            "rev/(min.s)",
            "W/(m2.K4)",
            "N.m.s/rad",
            "km/h",
            "g/cm3",
            "mPa.s",
            "kg/mol",
            "V.s/m",
            "N/A2",
            "1/mol",
        ];
        for text in units {
            assert!(MeasurementUnit::parse(text).is_ok(), "{text}");
        }
    }

    proptest::proptest! {
        #[test]
        fn nothing_panics(text in "[a-zA-Z0-9./()\u{b0}\u{b2}^ -]{0,20}") {
            let _ = MeasurementUnit::parse(&text);
            let _ = quantity(&text);
        }
    }
}
