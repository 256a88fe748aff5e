//! Units as Modelica writes them: `m3/(s.Pa)`, `bar`, `l/min`, `degC`, `rev/min`.
//!
//! A unit is a dimension (powers of the seven base units) with a factor and an offset to the SI unit of that dimension.
//! Angles have no dimension: `rad` is 1, `deg` and `rev` are factors, so that `rev/min` and `rad/s` are the same
//! dimension in different units.

mod table;

/// Powers of m, kg, s, A, K, mol, cd.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dimension(pub [i8; 7]);

/// A unit: `SI value = value * factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What kind of quantity it measures.
    pub dimension: Dimension,
    /// How many SI units one of it is; positive.
    pub factor: f64,
    /// Zero but for temperatures with another zero (degC, degF).
    pub offset: f64,
}

impl Dimension {
    /// No dimension.
    pub const ONE: Dimension = Dimension([0; 7]);

    fn combine(self, other: Dimension, power: i32) -> Option<Dimension> {
        let mut out = [0; 7];
        for (o, (a, b)) in out.iter_mut().zip(self.0.iter().zip(other.0)) {
            *o = i8::try_from(i32::from(*a) + power * i32::from(b)).ok()?;
        }
        Some(Dimension(out))
    }
}

impl std::fmt::Display for Dimension {
    /// As a Modelica unit of SI base units, such as `kg/(m.s2)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const NAMES: [&str; 7] = ["m", "kg", "s", "A", "K", "mol", "cd"];
        let part = |sign: i8| -> Vec<String> {
            let with = NAMES.iter().zip(self.0).filter(|(_, p)| p.signum() == sign);
            with.map(|(n, p)| if p.abs() == 1 { (*n).to_owned() } else { format!("{n}{}", p.unsigned_abs()) }).collect()
        };
        let (over, under) = (part(1), part(-1));
        let top = if over.is_empty() { "1".to_owned() } else { over.join(".") };
        match under.len() {
            0 => f.write_str(&top),
            1 => write!(f, "{top}/{}", under[0]),
            _ => write!(f, "{top}/({})", under.join(".")),
        }
    }
}

impl Unit {
    /// The unit `1`.
    pub const ONE: Unit = Unit { dimension: Dimension::ONE, factor: 1.0, offset: 0.0 };

    /// Reads a unit; the empty text is the unit `1`.
    ///
    /// # Errors
    /// The part that is no unit.
    pub fn parse(text: &str) -> Result<Unit, UnknownUnit> {
        let trimmed = text.trim();
        if trimmed.is_empty() {
            return Ok(Unit::ONE);
        }
        let mut parser = Parser { rest: trimmed, depth: 0 };
        let unit = parser.product()?;
        if parser.rest.is_empty() { Ok(unit) } else { Err(parser.unknown()) }
    }

    /// A value in this unit as a value in `other`; `None` when they measure different kinds of quantity.
    pub fn convert(&self, value: f64, other: &Unit) -> Option<f64> {
        if self.dimension != other.dimension {
            return None;
        }
        if self == other {
            return Some(value);
        }
        Some((value * self.factor + (self.offset - other.offset)) / other.factor)
    }

    /// The same for a number that a person wrote: decimal factors move the decimal point and nothing else.
    pub fn convert_written(&self, value: f64, other: &Unit) -> Option<f64> {
        let plain = self.convert(value, other)?;
        let decimal = self.offset == 0.0 && other.offset == 0.0 && value.is_finite();
        let moved = decimal.then(|| shifted(value, self.factor / other.factor)).flatten();
        Some(moved.unwrap_or(plain))
    }

    fn times(self, other: Unit, power: i32) -> Option<Unit> {
        let factor = self.factor * other.factor.powi(power);
        let dimension = self.dimension.combine(other.dimension, power)?;
        (factor.is_finite() && factor > 0.0).then_some(Unit { dimension, factor, offset: 0.0 })
    }
}

/// Multiplies by a power of ten in decimal digits: `0.8 ml` becomes the number written `0.8e-6`, not its neighbour.
fn shifted(value: f64, factor: f64) -> Option<f64> {
    let power = factor.log10().round();
    if power.abs() > 30.0 || (factor / 10f64.powf(power) - 1.0).abs() > 1e-14 {
        return None;
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e')?;
    let exponent: i32 = exponent.parse().ok()?;
    format!("{digits}e{}", exponent + power as i32).parse().ok()
}

/// A text that is no unit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{part}` is no known unit")]
pub struct UnknownUnit {
    /// The part of the text that could not be read.
    pub part: String,
}

/// A number with an optional unit, as in `0.8 ml`, `5e5` or `-3 degC`.
///
/// # Errors
/// The unit that could not be read; a text without number gives its whole.
pub fn quantity(text: &str) -> Result<(f64, Option<Unit>), UnknownUnit> {
    let text = text.trim();
    let unknown = || UnknownUnit { part: text.to_owned() };
    let end = number_length(text);
    let value: f64 = text[..end].parse().map_err(|_| unknown())?;
    let rest = text[end..].trim();
    if rest.is_empty() { Ok((value, None)) } else { Ok((value, Some(Unit::parse(rest)?))) }
}

/// The length of the number a text begins with.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut at = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    at = digits(at);
    if bytes.get(at) == Some(&b'.') {
        at = digits(at + 1);
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let end = digits(at + 1 + sign);
        if end > at + 1 + sign {
            at = end;
        }
    }
    at
}

struct Parser<'a> {
    rest: &'a str,
    depth: u32,
}

impl Parser<'_> {
    fn unknown(&self) -> UnknownUnit {
        UnknownUnit { part: self.rest.chars().take(40).collect() }
    }

    fn eat(&mut self, symbols: &[char]) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(symbols) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    /// `a.b/c`; everything after a `/` up to the next `.` outside brackets is divided by.
    fn product(&mut self) -> Result<Unit, UnknownUnit> {
        let mut unit = self.power()?;
        loop {
            let sign = if self.eat(&['.', '*', '·']) {
                1
            } else if self.eat(&['/']) {
                -1
            } else {
                return Ok(unit);
            };
            let at = self.unknown();
            let factor = self.power()?;
            unit = unit.times(factor, sign).ok_or(at)?;
        }
    }

    fn power(&mut self) -> Result<Unit, UnknownUnit> {
        let at = self.unknown();
        let unit = self.operand()?;
        let power = self.exponent();
        if power == 1 { Ok(unit) } else { Unit::ONE.times(unit, power).ok_or(at) }
    }

    fn exponent(&mut self) -> i32 {
        if let Some((symbol, power)) = [('²', 2), ('³', 3)].into_iter().find(|(c, _)| self.rest.starts_with(*c)) {
            self.rest = &self.rest[symbol.len_utf8()..];
            return power;
        }
        let text = self.rest.strip_prefix('^').unwrap_or(self.rest);
        let sign = usize::from(text.starts_with(['-', '+']));
        let digits = text[sign..].bytes().take_while(u8::is_ascii_digit).count();
        match text[..sign + digits].parse::<i32>() {
            Ok(power) if digits > 0 && digits < 3 => {
                self.rest = &text[sign + digits..];
                power
            }
            _ => 1,
        }
    }

    fn operand(&mut self) -> Result<Unit, UnknownUnit> {
        if self.eat(&['(']) {
            self.depth += 1;
            if self.depth > 50 {
                return Err(self.unknown());
            }
            let unit = self.product()?;
            self.depth -= 1;
            return if self.eat(&[')']) { Ok(unit) } else { Err(self.unknown()) };
        }
        self.rest = self.rest.trim_start();
        if let Some(rest) = self.rest.strip_prefix('1') {
            self.rest = rest;
            return Ok(Unit::ONE);
        }
        let letters = self.rest.find(|c: char| !(c.is_alphabetic() || "°%µ_'".contains(c))).unwrap_or(self.rest.len());
        let unit = table::symbol(&self.rest[..letters]).ok_or_else(|| self.unknown())?;
        self.rest = &self.rest[letters..];
        Ok(unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to_si(value: f64, unit: &str) -> f64 {
        let unit = Unit::parse(unit).unwrap();
        unit.convert_written(value, &Unit { factor: 1.0, offset: 0.0, ..unit }).unwrap()
    }

    #[test]
    fn the_units_of_hydraulics() {
        assert_eq!(to_si(210.0, "bar"), 210e5);
        assert_eq!(to_si(0.8, "ml"), 0.8e-6);
        assert_eq!(to_si(5.0, "ml"), 5e-6);
        approx::assert_relative_eq!(to_si(6.0, "l/min"), 1e-4);
        approx::assert_relative_eq!(to_si(1500.0, "rev/min"), 157.079_632_679, epsilon = 1e-6);
        assert_eq!(to_si(40.0, "degC"), 313.15);
        approx::assert_relative_eq!(to_si(46.0, "mm2/s"), 46e-6);
        approx::assert_relative_eq!(to_si(46.0, "cSt"), 46e-6);
        approx::assert_relative_eq!(to_si(1.0, "kW.h"), 3.6e6);
        assert_eq!(to_si(3.0, "1/min"), 0.05);
        approx::assert_relative_eq!(to_si(32.0, "degF"), 273.15);
    }

    #[test]
    fn dimensions() {
        let dimension = |u: &str| Unit::parse(u).unwrap().dimension.to_string();
        assert_eq!(dimension("Pa"), "kg/(m.s2)");
        assert_eq!(dimension("m3/(s.Pa)"), "m4.s/kg");
        assert_eq!(dimension("N.m"), dimension("J"));
        assert_eq!(dimension("rev/min"), "1/s");
        assert_eq!(dimension("J/(kg.K)"), "m2/(s2.K)");
        assert_eq!(dimension("m.s-2"), "m/s2");
        assert_eq!(dimension("V.s/m"), dimension("Wb/m"));
        assert_eq!(dimension("1"), "1");
    }

    #[test]
    fn conversion_between_units() {
        let unit = |u: &str| Unit::parse(u).unwrap();
        assert_eq!(unit("Pa").convert(21e6, &unit("bar")), Some(210.0));
        assert_eq!(unit("K").convert(313.15, &unit("degC")), Some(40.0));
        assert_eq!(unit("m3/s").convert(1e-3, &unit("bar")), None);
    }

    #[test]
    fn quantities() {
        assert_eq!(quantity("0.8 ml").unwrap().0, 0.8);
        assert_eq!(quantity(" -5e5 ").unwrap(), (-5e5, None));
        assert_eq!(quantity("3 eV").unwrap().1.unwrap().dimension, Unit::parse("J").unwrap().dimension);
        assert!(quantity("bar").is_err());
        assert_eq!(quantity("3 foo").unwrap_err().part, "foo");
    }

    #[test]
    fn what_is_no_unit() {
        for text in ["foo", "m/", "(m", "m)", "m..s", "3", "kkg", "m99999", "()"] {
            assert!(Unit::parse(text).is_err(), "{text}");
        }
        assert!(Unit::parse(&"(".repeat(100_000)).is_err());
    }

    proptest::proptest! {
        #[test]
        fn never_panics(text in "[a-zA-Z0-9./()°^ -]{0,20}") {
            let _ = Unit::parse(&text);
            let _ = quantity(&text);
        }
    }
}
