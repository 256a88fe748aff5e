//! The layout: tokens and comments stay, a second time changes nothing, line breaks and blanks may be anything.

use super::FILE;
use crate::format::format;
use crate::lexer::lex;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// Tokens as words, and the words of comments.
fn content(text: &str) -> (Vec<&str>, Vec<String>) {
    let tokens = lex(FILE, text).tokens;
    let words: Vec<&str> = tokens.iter().map(|t| &text[t.start as usize..t.end as usize]).collect();
    let mut comments: Vec<String> = Vec::new();
    let mut end = 0;
    for token in &tokens {
        let gap = text[end..token.start as usize].trim_start_matches('\u{feff}');
        comments.extend(gap.split_whitespace().map(str::to_owned));
        end = token.end as usize;
    }
    (words, comments)
}

fn laid_out(text: &str, name: &str) -> String {
    let once = format(FILE, text).unwrap_or_else(|d| panic!("{name}: {}", d[0].message));
    let (before, after) = (content(text), content(&once));
    assert_eq!(before.0, after.0, "{name}: other tokens");
    assert_eq!(before.1, after.1, "{name}: other comments");
    assert_eq!(format(FILE, &once).expect("still Modelica"), once, "{name}: a second time changes it");
    once
}

/// Texts of the project below a folder.
fn texts(folder: &Path, found: &mut Vec<(PathBuf, String)>) {
    for entry in std::fs::read_dir(folder).expect("readable").flatten() {
        let path = entry.path();
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|e| e == "mo") {
            found.extend(std::fs::read_to_string(&path).ok().map(|text| (path, text)));
        }
    }
}

fn of_project(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = Vec::new();
    folders.iter().for_each(|f| texts(&root.join(f), &mut found));
    found.sort();
    found
}

#[test]
fn library_and_models_have_the_layout() {
    let other: Vec<PathBuf> = of_project(&["components", "models", "examples", "tests/meaning"])
        .into_iter()
        .filter(|(path, text)| laid_out(text, &path.display().to_string()) != *text)
        .map(|(path, _)| path)
        .collect();
    assert!(other.is_empty(), "`bramah fmt` changes {other:#?}");
}

#[test]
fn what_stands_where() {
    let text = "\u{feff}within A ;  // of A
model  M \"text\" +
\"more\"


  extends  B( redeclare model C=D(a=- 1) ,
  x( start=1 ));
Real a [2]=if b then - c*d else -e ^ 2,q; /* inside */ Real r;
// before protected
protected
parameter Integer n=size( x,1 )-1;
type T=Real( unit=\"m\" );
record R end R;
  // of the equations
initial equation
a=2;
equation
if a>b and not (c<d) then
// first
x[1:end-1]=y[end];
elseif (if a then b else c) then
for i in 1:n loop when {a,b} then reinit(x,-x); end when; end for;
else
z=w
+(u
-v);
// last
end if;
connect(a.b,c.d)
annotation(Line(points={{1,2},{3,4}}));
  // end
end M ;
function f external \"C\" y=g(x); end f;
";
    insta::assert_snapshot!(laid_out(text, "text"));
}

#[test]
fn lines_end_as_they_did() {
    let text = "model M \"two\r\nlines\"\r\nReal x=1;\r\nend M;\r\n";
    assert_eq!(format(FILE, text).expect("Modelica"), "model M \"two\r\nlines\"\r\n  Real x = 1;\r\nend M;\r\n");
}

#[test]
fn a_text_with_errors_is_left_alone() {
    let errors = format(FILE, "model M\n  Real x = ;\nend M;").expect_err("not Modelica");
    assert_eq!(errors.len(), 1);
}

proptest! {
    /// Line breaks, blanks and comments anywhere.
    #[test]
    fn any_blanks_between_tokens(which in any::<prop::sample::Index>(), seed in any::<u64>()) {
        let all = of_project(&["components/Hydraulic", "tests/meaning"]);
        let (path, text) = &all[which.index(all.len())];
        let mut state = seed | 1;
        let mut mixed = String::new();
        for token in lex(FILE, text).tokens {
            // a generator of Marsaglia's
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            mixed.push_str(&text[token.start as usize..token.end as usize]);
            mixed.push_str([" ", "\n", "\n\n\n", "\t ", " // line\n", " /* block */ ", " /* two\n   lines */\n", "  "][(state % 8) as usize]);
        }
        laid_out(&mixed, &path.display().to_string());
    }
}
