use super::super::Code;
use super::*;

const TEXT: &str = "model M\n  Pump pump1(D = 16e-6);\n  Line line1;\nequation\n  connect(pump1.b, line1.a);\nend M;\n";

fn open_port() -> (Sources, Diagnostic) {
    let mut sources = Sources::default();
    let file = sources.add("M.mo", TEXT);
    let span = |word: &str| {
        let start = TEXT.find(word).expect("word is in the text") as u32;
        Span { file, start, end: start + word.len() as u32 }
    };
    let diagnostic = Diagnostic::new(Code::OpenPort, "port `pump1.a` is not connected")
        .at(span("pump1"), "its port `a` appears in no connect()")
        .at(span("pump1.b"), "only `b` is connected")
        .note("an open port means `pump1.a.q = 0`")
        .help("connect it, or close it with a `Plug`")
        .instance("pump1")
        .class("Pump");
    (sources, diagnostic)
}

#[test]
fn human_shows_place_and_labels() {
    let (sources, d) = open_port();
    insta::assert_snapshot!(render(&sources, &[d], DiagnosticFormat::Human, 100, false));
}

#[test]
fn short_is_one_line() {
    let (sources, d) = open_port();
    assert_eq!(short_list(&sources, &[d]), "M.mo:2:8: error[E103]: port `pump1.a` is not connected\n");
}

#[test]
fn json_has_the_promised_keys() {
    let (sources, d) = open_port();
    let text = render(&sources, &[d], DiagnosticFormat::Json, 100, false);
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["labels"][0]["end"]["column"], 13);
    assert_eq!(value["instance"], "pump1");
    assert_eq!(text.lines().count(), 1);
}

#[test]
fn labels_in_two_files_and_at_the_end_of_text() {
    let (mut sources, d) = open_port();
    let other = sources.add("P.mo", "model P\nend P;");
    let d = d.at(Span { file: other, start: 14, end: 14 }, "something is missing here");
    insta::assert_snapshot!(render(&sources, &[d], DiagnosticFormat::Human, 100, false));
}

#[test]
fn long_lists_are_cut() {
    let (sources, mut d) = open_port();
    d.notes = (0..24).map(|i| format!("fact {i}")).collect();
    d.help = vec![(0..30).map(|i| format!("  line {i}")).collect::<Vec<_>>().join("\n")];
    let text = render(&sources, &[d], DiagnosticFormat::Human, 100, false);
    assert!(text.contains("and 14 more"), "{text}");
    assert!(!text.contains("fact 10"), "{text}");
    assert!(!text.contains("line 11"), "{text}");
}

#[test]
fn a_line_of_100_kb_and_control_characters_do_no_harm() {
    let mut sources = Sources::default();
    let name = "x\u{1}\u{fe}".repeat(30_000);
    let file = sources.add("Big.mo", name.clone());
    let d = Diagnostic::new(Code::Syntax, "odd \u{7} text").at(Span { file, start: 60_001, end: u32::MAX }, "here");
    let text = render(&sources, &[d], DiagnosticFormat::Human, 100, false);
    assert!(text.len() < 5_000, "{}", text.len());
    assert!(text.contains("Big.mo:1:"));
    assert!(!text.contains('\u{7}'));
}

#[test]
fn messages_without_place_have_no_margin() {
    let d = Diagnostic::new(Code::BadArgument, "no such model").note("there are two").help("name one");
    insta::assert_snapshot!(render(&Sources::default(), &[d], DiagnosticFormat::Human, 100, false), @r"
    error[E901]: no such model
     = note: there are two
     = help: name one
    ");
}

#[test]
fn counts() {
    let (_, d) = open_port();
    assert_eq!(count(&[d.clone(), d]).as_deref(), Some("2 errors"));
    assert_eq!(count(&[]), None);
}

proptest::proptest! {
    #[test]
    fn never_panics(text in "(?s).{0,80}", start in 0u32..100, length in 0u32..100, width in 0usize..200) {
        let mut sources = Sources::default();
        let file = sources.add("x.mo", text);
        let d = Diagnostic::new(Code::Syntax, "m").at(Span { file, start, end: start + length }, "here");
        for format in [DiagnosticFormat::Human, DiagnosticFormat::Short, DiagnosticFormat::Json] {
            render(&sources, std::slice::from_ref(&d), format, width, true);
        }
    }
}
