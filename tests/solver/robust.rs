//! Nothing panics and everything ends: models with random damage go the whole way, from the text to a run.
//!
//! What it has found stands below as tests of their own. `PROPTEST_CASES=100000` searches longer.

#![allow(clippy::disallowed_methods, reason = "reads its cases")]

use bramah::Diagnostic;
use bramah::Request;
use bramah::internals::compile::CompileOutcome;
use bramah::internals::compile::compile;
use bramah::internals::expr::VarId;
use bramah::internals::lower::LoweringOptions;
use bramah::internals::solve::{Control, Progress, Settings, signals, simulate};
use bramah::results::Trajectory;
use bramah::world::MemoryWorld;
use proptest::prelude::*;
use std::path::Path;
use std::sync::LazyLock;

/// Texts to damage: the project's own models and mistakes.
static TEXTS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts = Vec::new();
    for folder in ["tests/bad", "tests/robust", "models", "models/stiff"] {
        let entries = std::fs::read_dir(root.join(folder)).expect("the folder is there").flatten();
        let mut files: Vec<_> =
            entries.map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "mo")).collect();
        files.sort();
        texts.extend(files.iter().map(|f| std::fs::read_to_string(f).expect("a text")));
    }
    texts
});

/// Words that change the meaning of what is around them.
const WORDS: [&str; 40] = [
    "0",
    "1",
    "-1",
    "2.5",
    "1e300",
    "1e-300",
    "{}",
    "{1, 2}",
    "1:0",
    "true",
    "\"text\"",
    "time",
    "der",
    "pre",
    "edge",
    "initial()",
    "sample(0, 0.1)",
    "when",
    "if",
    "for",
    "end",
    "connect",
    "parameter",
    "Integer",
    "Real",
    "Boolean",
    "input",
    "flow",
    "each",
    "final",
    "redeclare",
    "extends",
    "=",
    ":=",
    "(",
    ")",
    "[",
    ";",
    "^",
    "/",
];

/// One piece of damage, at places counted modulo the number of tokens.
#[derive(Clone, Debug)]
enum Damage {
    Delete(u16),
    Double(u16),
    Swap(u16, u16),
    Copy(u16, u16),
    Word(u16, usize),
    DeleteStatement(u16),
    DoubleStatement(u16),
    Cut(u16),
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = any::<u16>;
    prop_oneof![
        at().prop_map(Damage::Delete),
        at().prop_map(Damage::Double),
        (at(), at()).prop_map(|(a, b)| Damage::Swap(a, b)),
        (at(), at()).prop_map(|(a, b)| Damage::Copy(a, b)),
        (at(), 0..WORDS.len()).prop_map(|(a, w)| Damage::Word(a, w)),
        at().prop_map(Damage::DeleteStatement),
        at().prop_map(Damage::DoubleStatement),
        at().prop_map(Damage::Cut),
    ]
}

/// Words, numbers and single other characters; spaces go with the token before them.
fn tokens(text: &str) -> Vec<&str> {
    let kind = |c: char| (c.is_alphanumeric() || c == '_' || c == '.', c.is_whitespace());
    let mut tokens = Vec::new();
    let mut start = 0;
    let mut before: Option<(bool, bool)> = None;
    for (i, c) in text.char_indices() {
        let now = kind(c);
        let goes_on = before.is_some_and(|b| (b.0 && now.0) || now.1);
        if !goes_on && i > start {
            tokens.push(&text[start..i]);
            start = i;
        }
        before = Some(now);
    }
    tokens.push(&text[start..]);
    tokens
}

fn apply(text: &str, damage: &Damage) -> String {
    let mut t = tokens(text);
    let n = t.len();
    let at = |k: u16| usize::from(k) % n;
    // from the token to the next semicolon
    let statement = |k: u16| (at(k), (at(k)..n).find(|&i| t[i].starts_with(';')).map_or(n, |i| i + 1));
    match *damage {
        Damage::Delete(k) => drop(t.remove(at(k))),
        Damage::Double(k) => t.insert(at(k), t[at(k)]),
        Damage::Swap(a, b) => t.swap(at(a), at(b)),
        Damage::Copy(a, b) => t[at(a)] = t[at(b)],
        Damage::Word(k, word) => t[at(k)] = WORDS[word],
        Damage::DeleteStatement(k) => drop(t.drain(statement(k).0..statement(k).1)),
        Damage::DoubleStatement(k) => {
            let (from, to) = statement(k);
            let copy = t[from..to].to_vec();
            t.splice(from..from, copy);
        }
        Damage::Cut(k) => t.truncate(at(k)),
    }
    // a word put in must not grow together with its neighbours
    t.iter().map(|s| format!("{s}{}", if s.ends_with(char::is_whitespace) { "" } else { " " })).collect()
}

/// The whole way; a run is ended after so many rows and pauses.
fn go(text: &str) -> Vec<Diagnostic> {
    let world = MemoryWorld::single("model.mo", text);
    for model in [None, Some("M".to_string())] {
        let request = Request { source: "model.mo".into(), model, ..Request::default() };
        let CompileOutcome { mut diagnostics, value, .. } = compile(&world, &request, &LoweringOptions::INTERPRETED);
        let Some(model) = value else {
            if diagnostics.iter().any(|d| d.code.id() == "E022") {
                continue;
            }
            return diagnostics;
        };
        let all = (0..model.flat.variables.len()).map(|i| VarId(u32::try_from(i).expect("few variables")));
        let settings = Settings { wanted: all.collect(), ..Settings::from_experiment(&model.flat.experiment) };
        let mut rows = Trajectory::new(signals(&model.dae, &settings.wanted));
        let mut left = 300;
        let mut patient = |_: &Progress| {
            left -= 1;
            left > 0
        };
        let mut control = Control { progress: Some(&mut patient), ..Control::default() };
        diagnostics.extend(simulate(&model.system, &settings, &[], None, &mut rows, &mut control).diagnostics);
        return diagnostics;
    }
    Vec::new()
}

proptest! {
    #[test]
    fn damaged_models_end(which in any::<proptest::sample::Index>(), all in prop::collection::vec(damage(), 1..4)) {
        let mut text = TEXTS[which.index(TEXTS.len())].clone();
        for one in &all {
            text = apply(&text, one);
        }
        if std::panic::catch_unwind(|| go(&text)).is_err() {
            return Err(TestCaseError::fail(format!("panics:\n{text}")));
        }
    }
}

/// Packages that extend, import and redeclare each other at random: whatever their names mean, looking them up ends.
fn entangled(choices: &[u8]) -> String {
    let mut choices = choices.iter().copied();
    let mut next = |below: u8| choices.next().unwrap_or(0) % below;
    let mut open: Vec<char> = Vec::new();
    let mut text = String::from("package T\n");
    for _ in 0..40 {
        let name = |n: u8| char::from(b'A' + n);
        let path = |next: &mut dyn FnMut(u8) -> u8| -> String {
            let parts: Vec<String> = (0..=next(3)).map(|_| name(next(4)).to_string()).collect();
            parts.join(".")
        };
        let redeclared =
            |p: &str, n: char, on: u8| if on == 0 { format!("(redeclare package {n} = {p})") } else { String::new() };
        let (kind, n, m) = (next(8), name(next(4)), name(next(4)));
        let (a, b) = (path(&mut next), path(&mut next));
        let on = next(2);
        text += &match kind {
            0 | 1 if open.len() < 3 => {
                open.push(n);
                format!("package {n}\n")
            }
            2 => open.pop().map_or(String::new(), |n| format!("end {n};\n")),
            3 => format!("replaceable package {n} = {a}{};\n", redeclared(&b, m, on)),
            4 => format!("import {a}.*;\n"),
            5 => format!("model {n} {a} x; end {n};\n"),
            6 => format!("import {n} = {a};\n"),
            _ => format!("extends {a}{};\n", redeclared(&b, m, on)),
        };
    }
    while let Some(n) = open.pop() {
        text += &format!("end {n};\n");
    }
    text + "model M extends A; B y; Real x = 1; end M;\nend T;\n"
}

proptest! {
    #[test]
    fn entangled_packages_end(choices in prop::collection::vec(any::<u8>(), 200..400)) {
        let text = entangled(&choices);
        let world = MemoryWorld::single("model.mo", &text);
        let request = Request { source: "model.mo".into(), model: Some("T.M".into()), ..Request::default() };
        let ended = std::panic::catch_unwind(|| bramah::internals::compile::flatten(&world, &request).diagnostics.len());
        if ended.is_err() {
            return Err(TestCaseError::fail(format!("panics:\n{text}")));
        }
    }
}

/// Found by the test above: without a bound on all bases together each of ten `extends A` looks through all of them again.
#[test]
fn packages_that_go_in_circles_many_times_over_are_told() {
    let again = "extends A(redeclare package A = A);".repeat(10);
    let text = format!(
        "package T import C = D.D;
         package A import D = C.B;
           package B extends D; replaceable package B = B.B; model B C x; end B;
             package C extends D.D(redeclare package C = A.C); import C = C; extends A.A(redeclare package C = D);
               extends A(redeclare package A = D.B); replaceable package C = D.A; import A = A.A.B; import B.C.D.*;
               model B D x; end B; replaceable package B = D.C.B(redeclare package B = B.B.A);
               extends D.C(redeclare package B = A); extends B.B.C(redeclare package B = B.C.B); import C.*;
               extends C.C; import D.A.A.*; extends A.B; extends A.B; end C;
             replaceable package B = C.D; import D.B.C.*;
             package D extends A.B.B(redeclare package B = D); extends D.C; {again} end D;
           end B;
         end A;
         model M extends A; B y; Real x = 1; end M;
         end T;"
    );
    let world = MemoryWorld::single("model.mo", &text);
    let request = Request { source: "model.mo".into(), model: Some("T.M".into()), ..Request::default() };
    let diagnostics = bramah::internals::compile::flatten(&world, &request).diagnostics;
    assert!(diagnostics.iter().any(|d| d.code.id() == "E014" && d.message.contains("need each other")));
}

fn model(body: &str) -> String {
    format!("model M {body} end M;")
}

/// The code of the first error.
fn first_error(text: &str) -> Option<&'static str> {
    go(text).iter().find(|d| d.is_error()).map(|d| d.code.id())
}

#[test]
fn what_is_too_large_is_told() {
    let name = "a".repeat(100_000);
    let texts = [
        model("Real x[1000000000]; equation for i in 1:1000000000 loop x[i] = i; end for;"),
        model("Real x = sum(1:1000000000);"),
        model("Real x[100000, 100000] = zeros(100000, 100000);"),
        model("equation for i in 1:1000000000 loop assert(i > 0, \"\"); end for;"),
        format!("model {name} Real x = {name}y; end {name};"),
        model(&format!("Real x = {}1{};", "(".repeat(50_000), ")".repeat(50_000))),
        model(&format!("Real x = 1{};", " + 1".repeat(50_000))),
        "\u{0}\u{1}\u{7f}\u{fffd}".repeat(1000),
        "package A extends B; end A; package B extends A; model M extends A.X; end M; end B;".into(),
        model("Real x; function f input Real a; output Real b; algorithm b := f(a); end f; equation x = f(time);"),
        model("Real x; algorithm x := 0; while true loop x := x + 1; end while;"),
    ];
    for text in &texts {
        first_error(text);
    }
}
