//! Tables that models read from files: the same as tables written in the model, and mistakes reported at their place.

use bramah::internals::compile::compile;
use bramah::internals::diag::render::{DiagnosticFormat, render};
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};

/// A model whose table comes from `trajectory.csv` beside it.
fn model(block: &str) -> String {
    format!("model M\n  {block}\n  Real x = t.y;\nend M;\n")
}

/// What is said about a block that reads `data`.
fn said(block: &str, data: &str) -> String {
    let mut world = MemoryWorld::single("bench/M.mo", model(block));
    world.add("bench/t.csv", data);
    let request = Request { source: "bench/M.mo".into(), ..Request::default() };
    let outcome = compile(&world, &request, &bramah::internals::lower::LoweringOptions::INTERPRETED);
    render(&outcome.sources, &outcome.diagnostics, DiagnosticFormat::Short, 200, false)
}

const CURVE: &str = "Signal.Table1D t(u = time, fileName = \"t.csv\");";
const MAP: &str = "Signal.Table2D t(u1 = time, u2 = time, fileName = \"t.csv\");";
const COURSE: &str = "Signal.TimeTable t(fileName = \"t.csv\");";

#[test]
fn mistakes_are_told_at_their_place() {
    let all = [
        said(CURVE, "x,y\n0,0\n1,2\n1,3\n"),
        said(CURVE, "x,y\n0,0\n1,two\n"),
        said(CURVE, "x,y\n0,0\n1\n"),
        said(CURVE, "x,y\n"),
        said(CURVE, "x,y,z\n0,0,0\n1,1,1\n"),
        said(MAP, "0,1,2\n0,1,2\n0,1,2\n"),
        said(MAP, "0,2,1\n0,1,2\n1,1,2\n"),
        said(MAP, "0,1\n1,2\n"),
        said(COURSE, "0,1\n1,1\n0.5,2\n"),
        said(COURSE, "#1\ndouble other(2, 2)\n0 1\n1 1\n"),
        said("Signal.Table1D t(u = time, fileName = \"t.csv\", tableName = \"a\");", "#1\ndouble b(2, 2)\n0 1\n1 1\n"),
        said("Signal.Table1D t(u = time, fileName = \"none.csv\");", ""),
        said("Signal.Table1D t(u = time, fileName = \"modelica://Signal/none.csv\");", ""),
        said("Signal.Table1D t(u = time, fileName = \"modelica://Nowhere/t.csv\");", ""),
    ];
    insta::assert_snapshot!(all.join(""));
}

/// The last value of `x` of a block.
fn last(block: &str, data: &str, name: &str) -> f64 {
    let mut world = MemoryWorld::single("M.mo", model(block));
    world.add(name, data);
    let request = Request { source: "M.mo".into(), ..Request::default() };
    let run = Simulation::compile(&world, &request).and_then(|s| s.run()).unwrap_or_else(|e| panic!("{e}"));
    *run.trajectory.column("x").and_then(|x| x.last()).expect("a row")
}

#[test]
fn tables_are_the_same_from_files() {
    let listing = "#1\n# of the bench\ndouble a(2, 2)\n0 0\n1 1\nfloat b(3, 2) # another\n0, 0\n1, 4\n2, 5\n";
    let b = "fileName = \"t.txt\", tableName = \"b\"";
    let written = "table = [0, 0; 1, 4; 2, 5]";
    for (block, more) in
        [("Table1D", ""), ("Table1D", ", hold = false"), ("AkimaTable", ""), ("AkimaTable", ", hold = true")]
    {
        for u in ["0.3*time", "2.5*time", "-time"] {
            let from = |what: &str| last(&format!("Signal.{block} t(u = {u}, {what}{more});"), listing, "t.txt");
            assert_eq!(from(b), from(written), "{block} {more} {u}");
        }
    }
    let jump = "time;value\r\n0;0,5\r\n0,5;0,5\r\n0,5;2\r\n2;2\r\n";
    assert_eq!(last("Signal.TimeTable t(fileName = \"t.csv\");", jump, "t.csv"), 2.0);
    let map = "n\\p\t0\t1\n0\t0\t1\n2\t4\t5\n";
    let at = |u: &str, v: &str, more: &str| {
        last(&format!("Signal.Table2D t(u1 = {u}*time, u2 = {v}*time, fileName = \"t.csv\"{more});"), map, "t.csv")
    };
    assert_eq!(at("1", "0.5", ""), 2.5);
    assert_eq!((at("3", "2", ""), at("3", "2", ", hold = false")), (5.0, 8.0));
}

/// The name of a file needs no quotes within those of the shell.
#[test]
fn the_file_of_a_table_may_be_given_from_outside() {
    let text = "model M\n  Signal.Table1D t(u = time, fileName = \"none.csv\");\n  Real x = t.y;\nend M;\n";
    for given in ["t.csv", "data/t-1.csv", "\"t.csv\"", "table 1.csv"] {
        let mut world = MemoryWorld::single("M.mo", text);
        world.add(given.trim_matches('"'), "x,y\n0,0\n1,4\n");
        let set = bramah::Override { name: "t.fileName".into(), value: given.into() };
        let request = Request { source: "M.mo".into(), overrides: vec![set], ..Request::default() };
        let run =
            Simulation::compile(&world, &request).and_then(|s| s.run()).unwrap_or_else(|e| panic!("{given}: {e}"));
        assert_eq!(run.trajectory.column("x").and_then(|x| x.last()), Some(&4.0), "{given}");
    }
}

/// Akima's curves are exact for parabolas away from the edges, and straight beyond them.
#[test]
fn a_smooth_map() {
    let map = "x,0,1,2,3,4\n0,0,1,4,9,16\n1,1,2,5,10,17\n2,4,5,8,13,20\n3,9,10,13,18,25\n4,16,17,20,25,32\n";
    let at = |u: &str, v: &str, more: &str| {
        last(&format!("Signal.AkimaTable2D t(u1 = {u}*time, u2 = {v}*time, fileName = \"t.csv\"{more});"), map, "t.csv")
    };
    assert!((at("1.7", "2.2", "") - (1.7 * 1.7 + 2.2 * 2.2)).abs() < 1e-12);
    assert_eq!((at("4", "4", ""), at("9", "9", "")), (32.0, 32.0));
    // the slope at the edge is that of a parabola through the last points
    assert!((at("5", "2", ", hold = false") - (4.0 + 16.0 + 8.0)).abs() < 1e-9);
}

/// The trajectory of the next two tests.
const JUMPING: &str = "0.1,0\n0.2,1\n0.3,1\n0.3,-1\n0.5,0\n";

fn jumping(t: f64) -> f64 {
    match t {
        t if t < 0.1 => 0.0,
        t if t < 0.2 => (t - 0.1) / 0.1,
        t if t < 0.3 => 1.0,
        t if t < 0.5 => -1.0 + (t - 0.3) / 0.2,
        _ => 0.0,
    }
}

/// Corners are met whatever rounding makes of their times.
#[test]
fn a_course_may_begin_at_any_time() {
    for k in 0..40 {
        let start = 0.493 + 0.0137 * f64::from(k);
        let found = last(&format!("Signal.TimeTable t(startTime = {start}, fileName = \"t.csv\");"), JUMPING, "t.csv");
        let wanted = jumping(1.0 - start);
        assert!((found - wanted).abs() < 1e-9, "{found} instead of {wanted} with startTime {start}");
    }
    let all = "Signal.TimeTable t(startTime = 0.03, fileName = \"t.csv\");";
    assert!(last(all, JUMPING, "t.csv").abs() < 1e-12);
}

/// A cycle of work, in whole rounds, begun at any place.
#[test]
fn a_course_may_be_repeated() {
    for k in 0..40 {
        let start = -0.7 + 0.0237 * f64::from(k);
        let block = format!("Signal.TimeTable t(startTime = {start}, periodic = true, fileName = \"t.csv\");");
        let (found, wanted) = (last(&block, JUMPING, "t.csv"), jumping((0.9 - start).rem_euclid(0.4) + 0.1));
        assert!((found - wanted).abs() < 1e-9, "{found} instead of {wanted} with startTime {start}");
    }
}

#[test]
fn a_guarded_table_is_not_left() {
    let map = "n\\p,0,1\n0,0,1\n2,4,5\n";
    for (block, data) in [
        ("Signal.Table1D t(u = 2.5*time, guarded = true, fileName = \"t.csv\");", "x,y\n0,0\n1,1\n2,4\n"),
        ("Signal.AkimaTable t(u = 0.5 - time, guarded = true, fileName = \"t.csv\");", "x,y\n0,0\n1,1\n2,4\n"),
        ("Signal.Table2D t(u1 = 0, u2 = 1.5*time, guarded = true, fileName = \"t.csv\");", map),
        ("Signal.AkimaTable2D t(u1 = 3*time, u2 = 0, guarded = true, fileName = \"t.csv\");", map),
    ] {
        let mut world = MemoryWorld::single("M.mo", model(block));
        world.add("t.csv", data);
        let request = Request { source: "M.mo".into(), ..Request::default() };
        let error = Simulation::compile(&world, &request).and_then(|s| s.run()).expect_err("the table is left");
        assert!(error.to_string().contains("lies outside the table"), "{error}");
    }
}
