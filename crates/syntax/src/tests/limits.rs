//! Texts that are too deep, too long or no text: an error, not a crash. Test threads have a stack of 2 MB.

use super::good::check_round_trip;
use super::{messages, read};
use crate::diag::Code;

/// The codes of the errors of a text.
fn codes(text: &str) -> Vec<Code> {
    read(text).diagnostics.iter().map(|diagnostic| diagnostic.code).collect()
}

fn equation(text: &str) -> String {
    format!("model A equation {text}; end A;")
}

/// `before` n times, then `middle`, then `after` n times.
fn nest(n: usize, before: &str, middle: &str, after: &str) -> String {
    format!("{}{middle}{}", before.repeat(n), after.repeat(n))
}

#[test]
fn deep_nesting_is_an_error() {
    let n = 100_000;
    let texts = [
        equation(&format!("x = {}", nest(n, "(", "1", ")"))),
        equation(&format!("x = {}", nest(n, "{", "1", "}"))),
        equation(&format!("x = {}", nest(n, "[", "1", "]"))),
        equation(&format!("x = {}", nest(n, "f(", "1", ")"))),
        equation(&format!("x = {}", nest(n, "a[", "1", "]"))),
        equation(&format!("x = {}", nest(n, "(a or b and not c < d + e * ", "1", ")"))),
        equation(&format!("x = {}1", "if a then 1 else ".repeat(n))),
        equation(&format!("x = {}1", "- ".repeat(n))),
        equation(&format!("x = {}1", "not ".repeat(n))),
        equation(&format!("x = {}", nest(n, "f(function g(a = ", "1", "))"))),
        equation(&nest(n, "if a then ", "x = 1;", "end if;")),
        equation(&nest(n, "for i loop ", "x = 1;", "end for;")),
        format!("model A algorithm {}end A;", nest(n, "while a loop ", "x := 1;", "end while;")),
        nest(n, "model A ", "", "end A; "),
        format!("model A Real x{}; end A;", nest(n, "(a", "= 1", ")")),
        format!("model A B b{}; end A;", nest(n, "(redeclare B b", "", ")")),
    ];
    for text in texts {
        assert!(codes(&text).contains(&Code::TooDeep), "{:?} in {}", codes(&text), &text[..60]);
        assert!(codes(&text).len() < 5, "{}", messages(&text));
    }
}

#[test]
fn what_is_just_not_too_deep_is_read_and_printed() {
    let n = 180;
    let texts = [
        equation(&format!("x = {}", nest(n, "f(a + ", "1", ")"))),
        equation(nest(n, "if a then ", "x = 1;", "end if;").trim_end_matches(';')),
        nest(n, "model A ", "", "end A; "),
        equation(&format!("x = {}1", "if a then 1 else ".repeat(n))),
    ];
    for text in texts {
        assert_eq!(messages(&text), "", "{}", &text[..60]);
        check_round_trip(&text);
    }
}

#[test]
fn long_chains_of_operators_are_an_error() {
    for operator in [" + ", " * ", " or ", " .- "] {
        let chain = |n| equation(&format!("x = {}", vec!["a"; n].join(operator)));
        assert_eq!(codes(&chain(500)), []);
        assert_eq!(codes(&chain(100_000)), [Code::TooDeep]);
    }
    let nested = (0..10).fold("a".to_owned(), |inner, _| format!("({inner}){}", " + b".repeat(100)));
    assert_eq!(codes(&equation(&format!("x = {nested}"))), [Code::TooDeep]);
}

#[test]
fn long_texts_are_read() {
    let name = "n".repeat(100_000);
    assert_eq!(messages(&format!("model {name} Real {name}; end {name};")), "");
    let wrong = messages(&format!("model {name} Real {name} {name}; end A;"));
    assert!(
        wrong.len() < 3 * 100_000 + 1000 && wrong.lines().all(|line| !line.contains("found") || line.len() < 100_300)
    );
    let members = vec!["a"; 100_000].join(".");
    assert_eq!(messages(&equation(&format!("x = {members}"))), "");
    let numbers = vec!["1"; 100_000].join(", ");
    assert_eq!(messages(&equation(&format!("x = {{{numbers}}}"))), "");
    assert_eq!(messages(&equation(&"; x = 1".repeat(100_000)[2..])), "");
    let digits = "9".repeat(100_000);
    assert_eq!(codes(&equation(&format!("x = {digits}"))), [Code::Syntax]);
}

#[test]
fn many_errors_are_cut_off() {
    let texts = [
        equation(&"x = ; ".repeat(10_000)),
        "\"a\n\"b\n".repeat(100_000),
        "\\\"\n".repeat(100_000) + "\"a",
        "'\n".repeat(100_000),
        "/* ".repeat(100_000),
        "model ".repeat(100_000),
        ") ".repeat(100_000),
        "model A equation ".to_owned() + &"if ".repeat(100_000),
        "model A equation ".to_owned() + &"if a\n".repeat(100_000),
        "model A equation ".to_owned() + &"end if; ".repeat(100_000),
        "model A ".to_owned() + &"x[1, ".repeat(100_000),
    ];
    for text in texts {
        assert!((1..=130).contains(&codes(&text).len()), "{} in {}", codes(&text).len(), &text[..20]);
    }
}

#[test]
fn what_is_not_text_is_one_error() {
    for text in ["\0", "model A\0 end A;", "model A \"\u{1}\" end A;", "\u{7f}ELF", "\u{1b}[1m"] {
        assert_eq!(codes(text), [Code::NotText], "{text:?}");
    }
}
