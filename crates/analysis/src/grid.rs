//! Parses lists of values: `1,2,5` or `200:1000:5` (from, to, count), with one unit at the end for all.
//!
//! Sweeps, `--over` and `--grid` of the command use it.

use bramah_expr::units::{MeasurementUnit, quantity};

/// Parses values and converts them to `unit`, which is empty for a pure number.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn values(text: &str, unit: &str) -> Result<Vec<f64>, String> {
    let text = text.trim();
    let last = text.rfind([',', ':']).map_or(0, |i| i + 1);
    // The unit can only follow the last number.
    let tail = text[last..].trim();
    let digits = number_length(tail);
    let (list, own) = (format!("{}{}", &text[..last], &tail[..digits]), tail[digits..].trim());
    let mut out = Vec::new();
    for item in list.split(',') {
        out.extend(stretch(item)?);
    }
    if own.is_empty() {
        return Ok(out);
    }
    let from = MeasurementUnit::parse(own).map_err(|e| e.to_string())?;
    let to = MeasurementUnit::parse(unit).map_err(|e| e.to_string())?;
    let convert = |v: f64| from.convert(v, &to).ok_or_else(|| format!("`{own}` cannot be converted to `{unit}`"));
    out.into_iter().map(convert).collect()
}

/// The length of the longest prefix that is a number, in bytes.
fn number_length(text: &str) -> usize {
    (1..=text.len()).rev().find(|&n| text.is_char_boundary(n) && text[..n].trim().parse::<f64>().is_ok()).unwrap_or(0)
}

/// The values of one item: a number, or `from:to:count` at equal distances.
fn stretch(item: &str) -> Result<Vec<f64>, String> {
    let number = |t: &str| match quantity(t) {
        Ok((v, None)) if v.is_finite() => Ok(v),
        _ => Err(format!("`{}` is no number", t.trim())),
    };
    let parts: Vec<&str> = item.split(':').collect();
    match parts[..] {
        [one] => Ok(vec![number(one)?]),
        [from, to, count] => {
            let (from, to) = (number(from)?, number(to)?);
            let count: u32 = count.trim().parse().map_err(|_| format!("`{}` is no count", count.trim()))?;
            match count {
                0 => Err("a stretch needs at least one value".to_owned()),
                1 => Ok(vec![from]),
                _ => Ok((0..count).map(|i| from + (to - from) * f64::from(i) / f64::from(count - 1)).collect()),
            }
        }
        _ => Err(format!("`{item}`: a value or FROM:TO:COUNT is expected")),
    }
}

#[cfg(test)]
mod tests {
    use super::values;

    #[test]
    fn lists_and_stretches_with_units() {
        assert_eq!(values("1, 2,5e-1", ""), Ok(vec![1.0, 2.0, 0.5]));
        assert_eq!(values("0:10:3", "Pa"), Ok(vec![0.0, 5.0, 10.0]));
        assert_eq!(values("1,2 bar", "Pa"), Ok(vec![1e5, 2e5]));
        assert_eq!(values("10:20:2bar", "Pa"), Ok(vec![1e6, 2e6]));
        assert_eq!(values("3", "Pa"), Ok(vec![3.0]));
        for bad in ["", "a", "1:2", "1:2:0", "1 bar,2", "1,2 N", "1:2:x"] {
            assert!(values(bad, "Pa").is_err(), "{bad}");
        }
    }
}
