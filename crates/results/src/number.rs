//! Numbers as text, with the fewest digits that read back as the same value, and the other way round.
//! All writers and readers of this crate use these functions, and so do messages.

/// Appends a number with the fewest digits that read back as the same value.
/// NaN appends nothing, which is an empty cell.
///
/// Exponents are used unless `1e-5 <= |value| < 1e16`.
pub fn push(out: &mut String, value: f64) {
    if value.is_nan() {
        return;
    }
    // The sign of a zero is dropped.
    if value == 0.0 {
        return out.push('0');
    }
    out.push_str(digits(&mut ryu::Buffer::new(), value));
}

/// The fewest digits that read back as the same value. Whole numbers have no decimals. The text is in the buffer.
pub(super) fn digits(buffer: &mut ryu::Buffer, value: f64) -> &str {
    let text = buffer.format(value);
    text.strip_suffix(".0").unwrap_or(text)
}

/// The number as a new text. NaN is spelled out.
pub fn text(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    let mut out = String::new();
    push(&mut out, value);
    out
}

/// A number for people, with so many significant digits and without trailing zeros.
pub fn rounded(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return text(value);
    }
    let digits = digits.max(1);
    // The text with an exponent rounds to significant digits; reading it back gives the number to be printed.
    let short: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    text(short)
}

/// Reads a number as people and measuring programs write it. `None` if the cell is no number.
/// With `decimal_comma` a comma may stand for the point; that is allowed only where commas do not separate cells.
pub fn parse(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim();
    if let Ok(value) = cell.parse::<f64>() {
        return Some(value);
    }
    // A comma together with a point is a separator of thousands, whose meaning is not clear.
    if decimal_comma && cell.matches(',').count() == 1 && !cell.contains('.') {
        return cell.replace(',', ".").parse().ok();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_digits_and_short_exponents() {
        let shown: Vec<String> =
            [0.0, -0.0, 0.1, 1e5, -2.5e-7, 1e300, 123_456_789.0, 1.0 / 3.0].map(text).into_iter().collect();
        assert_eq!(shown, ["0", "0", "0.1", "100000", "-2.5e-7", "1e300", "123456789", "0.3333333333333333"]);
        assert_eq!(rounded(123_456.0, 3), "123000");
        assert_eq!(rounded(0.000_123_456, 3), "0.000123");
    }

    #[test]
    fn decimal_commas() {
        assert_eq!(parse("1,5", true), Some(1.5));
        assert_eq!(parse("1,5", false), None);
        assert_eq!(parse("1,234.5", true), None);
        assert_eq!(parse(" -2.5E3 ", false), Some(-2500.0));
    }

    proptest::proptest! {
        #[test]
        fn reads_back_the_same(bits in proptest::num::u64::ANY) {
            let value = f64::from_bits(bits);
            if !value.is_nan() {
                assert_eq!(parse(&text(value), false), Some(value));
            }
        }
    }
}
