//! Every example of the library does what it did: some of its signals, and the solver's work.
//!
//! `tests/examples.csv` lists them. After a change that is meant, `BRAMAH_RECORD=1 cargo test --test circuits examples::` writes
//! it anew; read the difference before it is committed.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use bramah::results::{Trajectory, number};
use rig::shipped;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Deviation allowed at the middle and at the end, over the range of the signal in the run.
const TOLERANCE: f64 = 2e-3;
/// Steps may be so many times the recorded ones.
const MORE_WORK: f64 = 1.3;
/// Signals recorded of an example.
const SIGNALS: usize = 4;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn examples(folder: &Path, out: &mut Vec<String>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("readable").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            examples(&path, out);
        } else if path.extension().is_some_and(|e| e == "mo") && path.parent().is_some_and(|p| p.ends_with("Examples"))
        {
            let text = std::fs::read_to_string(&path).expect("a text");
            let inside = path.strip_prefix(root().join("components")).expect("below").with_extension("");
            if text.contains("experiment(") {
                out.push(inside.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join("."));
            }
        }
    }
}

/// The first signals that move, those of the circuit itself before those of its parts; any where none does.
fn telling(t: &Trajectory) -> Vec<usize> {
    let still = |i: usize| {
        let (low, high) = range(&t.columns[i]);
        high - low <= 1e-6 * high.abs().max(low.abs())
    };
    let mut out: Vec<usize> = (0..t.signals.len()).collect();
    out.sort_by_key(|&i| (still(i), t.signals[i].name.contains('['), t.signals[i].name.matches('.').count()));
    out.truncate(SIGNALS);
    let moving = out.iter().filter(|i| !still(**i)).count();
    out.truncate(moving.max(1));
    out
}

fn range(column: &[f64]) -> (f64, f64) {
    column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)))
}

/// Values between two events, so that the side of a jump does not matter.
fn places(t: &Trajectory) -> [f64; 2] {
    let (first, last) = (t.times[0], t.times[t.len() - 1]);
    [first + 0.4937 * (last - first), last]
}

/// What a run says: steps, and for each signal its range and its values at the places.
fn summary(class: &str) -> (usize, BTreeMap<String, [f64; 4]>) {
    let outcome = shipped(class).run().unwrap_or_else(|e| panic!("{class}: {e}"));
    let t = &outcome.trajectory;
    let value = |i: usize, time: f64| t.value(i, time).expect("a value");
    let [middle, end] = places(t);
    let signals = telling(t).into_iter().map(|i| {
        let (low, high) = range(&t.columns[i]);
        (t.signals[i].name.clone(), [low, high, value(i, middle), value(i, end)])
    });
    (outcome.statistics.steps as usize, signals.collect())
}

fn record(classes: &[String]) -> String {
    let mut out = String::from("class,steps,signal,lowest,highest,middle,end\n");
    for class in classes {
        let (steps, signals) = summary(class);
        for (signal, values) in signals {
            let values: Vec<String> = values.iter().map(|v| number::rounded(*v, 9)).collect();
            let _ = writeln!(out, "{class},{steps},{signal},{}", values.join(","));
        }
    }
    out
}

/// What is wrong with a line, if anything.
fn deviation(line: &str, found: &(usize, BTreeMap<String, [f64; 4]>)) -> Option<String> {
    let cells: Vec<&str> = line.split(',').collect();
    let [class, steps, signal, ..] = cells[..] else { return Some(format!("not a line: {line}")) };
    let wanted: Vec<f64> = cells[3..].iter().map(|c| c.parse().expect("a number")).collect();
    let steps: f64 = steps.parse().expect("a number");
    if found.0 as f64 > (MORE_WORK * steps).max(steps + 30.0) {
        return Some(format!("{class}: {} steps instead of {steps}", found.0));
    }
    let Some(values) = found.1.get(signal) else { return Some(format!("{class}: no signal {signal}")) };
    let wide = wanted[1] - wanted[0];
    let off = values.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (off.is_nan() || off > TOLERANCE * wide + 1e-6 * wanted[1].abs())
        .then(|| format!("{class}: {signal} is {values:?}, was {wanted:?}"))
}

#[test]
fn examples_do_what_they_did() {
    let file = root().join("tests/examples.csv");
    let mut classes = Vec::new();
    examples(&root().join("components"), &mut classes);
    if std::env::var_os("BRAMAH_RECORD").is_some() {
        std::fs::write(&file, record(&classes)).expect("written");
    }
    let text = std::fs::read_to_string(&file).expect("the record is there");
    let mut bad = Vec::new();
    for class in &classes {
        let lines: Vec<&str> = text.lines().filter(|l| l.split(',').next() == Some(class)).collect();
        if lines.is_empty() {
            bad.push(format!("{class} is not recorded"));
            continue;
        }
        let found = summary(class);
        bad.extend(lines.iter().filter_map(|l| deviation(l, &found)));
    }
    assert!(classes.len() > 180, "only {} examples", classes.len());
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}
