//! What README says is so: its circuit runs, its commands print what stands below them, its figures are those of a run.

#![allow(clippy::disallowed_methods, reason = "reads the page, runs the command")]

use bramah::Simulation;
use bramah::results::Trajectory;
use std::path::Path;
use std::process::Command;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn readme() -> String {
    std::fs::read_to_string(Path::new(ROOT).join("README.md")).expect("the page")
}

/// The texts of the blocks of a language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let begin = format!("```{language}\n");
    page.split(&begin).skip(1).map(|rest| rest.split("\n```").next().expect("an end")).collect()
}

/// Whether two words are the same, or numbers that differ by less than one in twenty: machines round differently.
fn alike(a: &str, b: &str) -> bool {
    let number = |word: &str| word.trim_matches(|c: char| "()%,;`:".contains(c)).parse::<f64>().ok();
    a == b
        || matches!((number(a), number(b)), (Some(a), Some(b)) if (a - b).abs() <= 0.05 * a.abs().max(b.abs()) + 0.11)
}

#[test]
fn commands_print_what_stands_below_them() {
    let page = readme();
    let out = tempfile::tempdir().expect("a folder");
    let shown = blocks(&page, "console");
    assert!(!shown.is_empty());
    for block in shown {
        let (command, expected) = block.split_once('\n').expect("an output");
        let command = command.strip_prefix("$ bramah ").expect("a command of bramah");
        let arguments = command.split(' ').map(|a| a.replace("out/", &format!("{}/", out.path().display())));
        let run = Command::new(env!("CARGO_BIN_EXE_bramah")).current_dir(ROOT).args(arguments).output().expect("a run");
        assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
        let printed = String::from_utf8_lossy(&[run.stdout, run.stderr].concat()).into_owned();
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let (said, wanted) = (words(&printed), words(expected));
        let same = said.len() == wanted.len() && said.iter().zip(&wanted).all(|(a, b)| alike(a, b));
        assert!(same, "README's `{command}` prints\n{printed}");
    }
    assert!(out.path().join("diagnosis.html").exists());
}

#[test]
fn the_first_circuit_runs() {
    let page = readme();
    let texts = blocks(&page, "modelica");
    assert!(!texts.is_empty());
    for text in texts {
        let simulation = Simulation::from_text(text).unwrap_or_else(|e| panic!("{e}"));
        simulation.run().unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Slope and intercept of p_A - p_B over the speed, bar and rev/min, from 50 to 210 bar.
fn dead_zone() -> (f64, f64) {
    let t: Trajectory =
        Simulation::shipped("ServoPump.DeadZone").and_then(|s| s.run()).unwrap_or_else(|e| panic!("{e}")).trajectory;
    let column = |name: &str| t.signals.iter().position(|s| s.name == name).map(|i| t.columns[i].clone()).expect(name);
    let (n, a, b) = (column("N"), column("p_A"), column("p_B"));
    let points = n.iter().zip(a.iter().zip(&b)).map(|(n, (a, b))| (*n, (a - b) / 1e5));
    let points: Vec<(f64, f64)> = points.filter(|(_, dp)| (50.0..=210.0).contains(dp)).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (xx, xy) =
        points.iter().fold((0.0, 0.0), |(xx, xy), p| (xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y)));
    (xy / xx, y - xy / xx * x)
}

#[test]
fn the_figures_of_the_dead_zone_are_those_of_a_run() {
    let page = readme();
    let figure = |name: &str| -> String {
        let row = page.lines().find(|l| l.starts_with(&format!("| {name}"))).expect("a row");
        row.split('|').nth(2).expect("a figure").trim().to_owned()
    };
    let (slope, intercept) = dead_zone();
    assert_eq!((figure("slope"), figure("intercept")), (format!("{slope:.2}"), format!("{intercept:.1}")));
}
