//! Text functions of `ModelicaStrings`, behind `Modelica.Utilities.Strings`. Positions count bytes from 1.
//! The scanning functions take white space, then a token, and give the position behind it.

/// The part of a text between two positions, both included. Positions outside are moved to the nearest end.
/// A position within a character of several bytes gives an empty text.
pub fn substring(text: &str, from: f64, to: f64) -> String {
    let first = from.max(1.0) as usize - 1;
    let last = (to.max(0.0) as usize).min(text.len());
    text.get(first..last.max(first)).unwrap_or_default().to_owned()
}

/// Compares two texts: 1 for less, 2 for equal, 3 for greater, as the literals of `Modelica.Utilities.Types.Compare`.
pub fn compare(a: &str, b: &str, case_sensitive: bool) -> f64 {
    let ordering = if case_sensitive { a.cmp(b) } else { a.to_lowercase().cmp(&b.to_lowercase()) };
    f64::from(ordering as i8) + 2.0
}

/// The first position at or after `from` that is not white space. One past the end if there is none.
/// White space is that of ASCII.
pub fn skip_white_space(text: &str, from: f64) -> f64 {
    let first = (from.max(1.0) as usize - 1).min(text.len());
    let blank = text.as_bytes()[first..].iter().take_while(|b| b.is_ascii_whitespace()).count();
    (first + blank + 1) as f64
}

/// Skips white space and reads a token, by a function that gives its length and value.
/// Gives the position behind the token and its value, or position 1 and `None` if there is no such token.
pub fn scan<T>(text: &str, from: f64, token: impl Fn(&str) -> Option<(usize, T)>) -> (f64, Option<T>) {
    let first = skip_white_space(text, from) as usize - 1;
    match text.get(first..).and_then(token) {
        Some((length, value)) => ((first + length + 1) as f64, Some(value)),
        None => (1.0, None),
    }
}

/// An identifier at the beginning of a text, with its length in bytes.
/// It begins with a letter.
pub fn identifier(text: &str) -> Option<(usize, String)> {
    let length = text.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
    let begins = text.bytes().next().is_some_and(|b| b.is_ascii_alphabetic());
    begins.then(|| (length, text[..length].to_owned()))
}

/// A string literal at the beginning of a text: its length with the quotation marks, and its content.
/// Escapes are not resolved.
pub fn quoted(text: &str) -> Option<(usize, String)> {
    let inner = text.strip_prefix('"')?;
    let mut escaped = false;
    let end = inner.char_indices().find(|(_, c)| {
        let ends = *c == '"' && !escaped;
        // A backslash that is escaped itself escapes nothing.
        escaped = *c == '\\' && !escaped;
        ends
    })?;
    Some((end.0 + 2, inner[..end.0].to_owned()))
}

/// An integer at the beginning of a text, with its length. `None` if a real number stands there or it exceeds 32 bits.
/// With `unsigned` no sign may stand before it.
pub fn integer(text: &str, unsigned: bool) -> Option<(usize, f64)> {
    let sign = usize::from(!unsigned && text.starts_with(['+', '-']));
    let digits = text[sign..].bytes().take_while(u8::is_ascii_digit).count();
    let length = sign + digits;
    let goes_on = text[length..].starts_with(['.', 'e', 'E']);
    (digits > 0 && !goes_on).then_some(())?;
    Some((length, f64::from(text[..length].parse::<i32>().ok()?)))
}

/// A real number at the beginning of a text, with its length. With `unsigned` no sign may stand before it.
/// The form is that of Modelica numbers, with or without an exponent.
pub fn real(text: &str, unsigned: bool) -> Option<(usize, f64)> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = usize::from(!unsigned && text.starts_with(['+', '-']));
    let mut count = digits(at);
    at += count;
    if bytes.get(at) == Some(&b'.') {
        let fraction = digits(at + 1);
        (count, at) = (count + fraction, at + 1 + fraction);
    }
    // A point alone is no number.
    if count == 0 {
        return None;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    Some((at, text[..at].parse().ok()?))
}

/// The hash of `ModelicaStrings_hashString`: Arash Partow's AP hash, as a signed number of 32 bits.
pub fn hash(text: &str) -> f64 {
    let step = |h: u32, (k, byte): (usize, u8)| {
        let c = u32::from(byte);
        h ^ if k % 2 == 0 { (h << 7) ^ c.wrapping_mul(h >> 3) } else { !(h << 11).wrapping_add(c ^ (h >> 5)) }
    };
    let hash = text.bytes().enumerate().fold(0xAAAA_AAAA_u32, step);
    #[allow(clippy::cast_possible_wrap, reason = "a signed number of 32 bits")]
    f64::from(hash as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_comparisons() {
        assert_eq!((substring("word", 2.0, 3.0), substring("word", 3.0, 9.0)), ("or".into(), "rd".into()));
        assert_eq!((compare("a", "B", true), compare("a", "A", false), compare("a", "B", false)), (3.0, 2.0, 1.0));
    }

    #[test]
    fn scanning() {
        assert_eq!(scan("  x_1 = 2", 1.0, identifier), (6.0, Some("x_1".into())));
        assert_eq!(scan("-12 a", 1.0, |t| integer(t, false)), (4.0, Some(-12.0)));
        assert_eq!(scan("-12", 1.0, |t| integer(t, true)), (1.0, None));
        assert_eq!(scan("a 1.5e-3;", 2.0, |t| real(t, false)), (9.0, Some(1.5e-3)));
        assert_eq!(scan("1.", 1.0, |t| integer(t, false)).1, None);
        assert_eq!(scan(r#""a\"b" c"#, 1.0, quoted), (7.0, Some(r#"a\"b"#.into())));
    }

    /// As the documentation of `Modelica.Utilities.Strings.hashString` says.
    #[test]
    fn hashes() {
        assert_eq!((hash("this is a test"), hash("Controller.noise1")), (1_827_717_433.0, -1_025_762_750.0));
    }
}
