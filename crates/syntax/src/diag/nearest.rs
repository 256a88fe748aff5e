//! "Did you mean": the known name nearest to a misspelt one.
//! All stages call [`nearest`] for messages about unknown names.

/// The length in characters beyond which names are not compared. The time grows with the product of both lengths.
const LONGEST: usize = 200;

/// The candidate that `name` was probably meant to be: equal except for case, or a few letters away.
/// Distance is that of Damerau and Levenshtein: letters inserted, removed, replaced, or two neighbours swapped.
///
/// Of several equally near candidates the first is taken. `None` if none is near, or if `name` is empty or too long.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    if name.is_empty() || length > LONGEST {
        return None;
    }
    let lower = name.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        if candidate.len() > LONGEST || candidate == name {
            continue;
        }
        let distance = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
        // One letter in three may differ, and at least one.
        let allowed = (length.max(candidate.chars().count()) / 3).max(1);
        // Names of one or two letters are near to too many others: only their case may differ.
        let short_swap = length <= 2 && distance > 0;
        if distance <= allowed && !short_swap && best.is_none_or(|(d, _)| distance < d) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn finds_spelling_mistakes_and_nothing_else() {
        let known = ["displacement", "speed", "p_open", "V0"];
        assert_eq!(nearest("displacment", known), Some("displacement"));
        assert_eq!(nearest("P_Open", known), Some("p_open"));
        assert_eq!(nearest("v0", known), Some("V0"));
        assert_eq!(nearest("spede", known), Some("speed"));
        assert_eq!(nearest("pressure", known), None);
        assert_eq!(nearest("q", ["p", "x"]), None);
        assert_eq!(nearest(&"x".repeat(100_000), known), None);
    }
}
