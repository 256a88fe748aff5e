//! Amounts as data sheets state them: `3 %`, `0.5 bar` or a plain number.
//!
//! Texts and numbers of a study or sweep enter; values in the unit of a variable leave. Temperatures need care: `2
//! degC` is 275.15 K as a value, but 2 K as a difference.

use bramah_expr::units::{MeasurementUnit, quantity};
use bramah_results::number;
use std::fmt;

/// An amount of a quantity whose unit is known from the context.
#[derive(Clone, Debug, PartialEq)]
pub enum Amount {
    /// A share of something else: 0.03 for `3 %`.
    Part(f64),
    /// A value in the unit given, or without one in the unit of the quantity.
    Value(f64, Option<String>),
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Amount::Part(part) => write!(f, "{} %", number::rounded(100.0 * part, 12)),
            Amount::Value(value, Some(unit)) => write!(f, "{} {unit}", number::text(*value)),
            Amount::Value(value, None) => f.write_str(&number::text(*value)),
        }
    }
}

impl Amount {
    /// Reads `3 %`, `0.5 bar` or `2e-3`.
    ///
    /// # Errors
    /// A sentence saying what is wrong.
    pub fn parse(text: &str) -> Result<Amount, String> {
        if let Some(percent) = text.trim().strip_suffix('%') {
            let value: Option<f64> = percent.trim().parse().ok().filter(|v: &f64| v.is_finite());
            return value.map(|v| Amount::Part(v / 100.0)).ok_or_else(|| format!("`{text}` is no percentage"));
        }
        let (value, unit) = quantity(text).map_err(|e| e.to_string())?;
        if !value.is_finite() {
            return Err(format!("`{text}` is not finite"));
        }
        // The unit is kept as written, for messages and for the later conversion.
        let written = text.trim().trim_start_matches(|c: char| c.is_ascii_digit() || "+-.eE".contains(c)).trim();
        Ok(Amount::Value(value, unit.map(|_| written.to_owned())))
    }

    /// The number without its unit; 0.03 for `3 %`.
    pub fn number(&self) -> f64 {
        match self {
            Amount::Part(x) | Amount::Value(x, _) => *x,
        }
    }

    /// The amount as a value in `unit`; a share is taken of `whole`.
    ///
    /// # Errors
    /// A sentence where its unit cannot be converted.
    pub fn in_unit(&self, unit: &str, whole: f64) -> Result<f64, String> {
        match self {
            Amount::Part(part) => Ok(part * whole),
            Amount::Value(value, None) => Ok(*value),
            Amount::Value(value, Some(own)) => convert(own, unit, *value, false),
        }
    }

    /// The amount as a difference in `unit`: offsets of temperature scales do not count.
    ///
    /// # Errors
    /// As [`Amount::in_unit`].
    pub fn difference_in_unit(&self, unit: &str, whole: f64) -> Result<f64, String> {
        match self {
            Amount::Value(value, Some(own)) => convert(own, unit, *value, true),
            _ => self.in_unit(unit, whole),
        }
    }
}

/// Converts a value between two units; `difference` leaves out offsets of temperature scales.
fn convert(own: &str, unit: &str, value: f64, difference: bool) -> Result<f64, String> {
    let from = MeasurementUnit::parse(own).map_err(|e| e.to_string())?.meant(difference);
    let to = MeasurementUnit::parse(unit).map_err(|e| e.to_string())?.meant(difference);
    from.convert(value, &to).ok_or_else(|| {
        let unit = if unit.is_empty() { "a pure number" } else { unit };
        format!("`{own}` cannot be converted to {unit}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts() {
        assert_eq!(Amount::parse("3 %"), Ok(Amount::Part(0.03)));
        assert_eq!(Amount::parse("0.5 bar").unwrap().in_unit("Pa", 0.0), Ok(5e4));
        assert_eq!(Amount::parse("2e-3").unwrap().in_unit("Pa", 0.0), Ok(2e-3));
        assert_eq!(Amount::parse("2e-3m3/s").unwrap().in_unit("l/min", 0.0), Ok(120.0));
        assert_eq!(Amount::parse("5 %").unwrap().in_unit("Pa", 10.0), Ok(0.5));
        assert_eq!(Amount::parse("2 degC").unwrap().difference_in_unit("K", 0.0), Ok(2.0));
        assert!(Amount::parse("2 bar").unwrap().in_unit("N", 0.0).unwrap_err().contains("cannot be converted"));
        assert!(Amount::parse("soon").is_err() && Amount::parse("x %").is_err() && Amount::parse("2 foo").is_err());
    }
}
