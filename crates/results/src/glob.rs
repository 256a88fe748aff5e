//! Patterns that select variables by name: `*` for any text, `?` for one character, everything else literally.
//!
//! Brackets are literal, since names contain them: `v[1].p`, `v[*].p`. The name of an array selects all its elements.
//! Options of the command and outputs in Python are such patterns.

use wildmatch::WildMatch;

/// A list of patterns. A name is selected if at least one of them matches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GlobPatterns {
    /// The patterns in the order given.
    patterns: Vec<String>,
}

impl GlobPatterns {
    /// Patterns from lists such as `cyl.*,pump.b.p`. Commas inside brackets or quotes do not separate patterns.
    pub fn new<S: AsRef<str>>(lists: &[S]) -> Self {
        GlobPatterns { patterns: lists.iter().flat_map(|list| split_list(list.as_ref())).collect() }
    }

    /// True if there is no pattern.
    pub fn is_empty(&self) -> bool {
        self.patterns.is_empty()
    }

    /// True if a pattern matches the complete name, or that of its array.
    pub fn matches(&self, name: &str) -> bool {
        self.patterns.iter().any(|p| matches(p, name))
    }

    /// True if a pattern is literally this name, or that of its array.
    pub fn names(&self, name: &str) -> bool {
        self.patterns.iter().any(|p| p == name || array(name) == Some(p.as_str()))
    }

    /// The index of the first pattern that matches. `usize::MAX` if none does, so that such names sort last.
    pub fn position(&self, name: &str) -> usize {
        self.patterns.iter().position(|p| matches(p, name)).unwrap_or(usize::MAX)
    }

    /// The patterns that match none of these names. They are probably misspelt.
    pub fn unused<'a>(&self, names: impl Iterator<Item = &'a str> + Clone) -> Vec<&str> {
        let none = |pattern: &&String| !names.clone().any(|name| matches(pattern, name));
        self.patterns.iter().filter(none).map(String::as_str).collect()
    }
}

/// Splits a list at commas outside of brackets, braces and quotes. Blanks and quotes around items are removed.
pub fn split_list(text: &str) -> Vec<String> {
    let mut items = Vec::new();
    let mut item = String::new();
    let (mut depth, mut quoted) = (0i32, false);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            // A closing bracket too many must not hide the commas after it.
            ',' if depth <= 0 && !quoted => items.push(std::mem::take(&mut item)),
            _ => {
                depth += i32::from(matches!(c, '[' | '{' | '(')) - i32::from(matches!(c, ']' | '}' | ')'));
                item.push(c);
            }
        }
    }
    items.push(item);
    items.into_iter().map(|i| i.trim().to_owned()).filter(|i| !i.is_empty()).collect()
}

/// True if a pattern matches a name or its array.
fn matches(pattern: &str, name: &str) -> bool {
    // A pattern for an array selects its elements, which are separate signals.
    whole(pattern, name) || array(name).is_some_and(|array| whole(pattern, array))
}

/// The array that a name is an element of: `v` for `v[1]`, `A` for `A[1,2]`. `None` if it is no element.
fn array(name: &str) -> Option<&str> {
    name.strip_suffix(']')?.rsplit_once('[').map(|(array, _)| array)
}

/// True if a pattern matches all of a name.
fn whole(pattern: &str, name: &str) -> bool {
    WildMatch::new(pattern).matches(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        let yes = |p: &str, n: &str| assert!(GlobPatterns::new(&[p]).matches(n), "{p} should match {n}");
        let no = |p: &str, n: &str| assert!(!GlobPatterns::new(&[p]).matches(n), "{p} should not match {n}");
        yes("cyl.*", "cyl.a.p");
        yes("v[1].p", "v[1].p");
        no("v[1].p", "v1.p");
        yes("v[*].p", "v[12].p");
        yes("v[?].p", "v[1].p");
        no("v[?].p", "v[12].p");
        yes("*", "anything");
        yes("*.p*", "a.b.pump");
        no("cyl", "cyl.a");
        yes("x,A[1,2]", "A[1,2]");
        yes("\"A[1,2]\"", "A[1,2]");
        yes("A[1,*]", "A[1,7]");
        no("", "x");
        yes("A", "A[1,7]");
        yes("cyl.v*", "cyl.v[2]");
        yes("*.p", "a[1].p[2]");
        no("v", "v[1].p");
        no("v[1]", "v[12]");
        assert!(GlobPatterns::new(&["A"]).names("A[1,2]"));
    }

    #[test]
    fn unused_patterns() {
        let globs = GlobPatterns::new(&["a.*,b", "c?"]);
        assert_eq!(globs.unused(["a.x", "cd"].into_iter()), ["b"]);
    }

    #[test]
    fn hard_patterns_end() {
        let name = "a".repeat(2_000);
        assert!(!matches(&"*a".repeat(30), &format!("{name}b")));
    }
}
