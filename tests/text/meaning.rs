//! What models mean: `tests/meaning/*.mo`, each with values that were worked out by other means.
//!
//! Lines at the top of a file say what is expected:
//! - `//! model P.M`: the class, where the file holds several;
//! - `//! stop 2`: the end of the run, where it is not 1 s;
//! - `//! tolerance 1e-4`: relative to the value or 1, where it is not 1e-5;
//! - `//! y[2](0.4) = 1.6`: the value of a variable at a time, a hundredth of the run or a multiple of it; the last one
//!   where an event makes two.
#![allow(clippy::disallowed_methods, reason = "reads its cases")]

use approx::relative_eq;
use bramah::results::Trajectory;
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};

struct Case {
    model: Option<String>,
    stop: f64,
    tolerance: f64,
    values: Vec<(String, f64, f64)>,
}

fn case(name: &str, text: &str) -> Case {
    let mut case = Case { model: None, stop: 1.0, tolerance: 1e-5, values: Vec::new() };
    for line in text.lines().map_while(|l| l.strip_prefix("//! ")) {
        let number = |s: &str| s.parse().unwrap_or_else(|_| panic!("{name}: cannot read `{line}`"));
        match line.split_once(' ') {
            Some(("model", model)) => case.model = Some(model.into()),
            Some(("stop", stop)) => case.stop = number(stop),
            Some(("tolerance", tolerance)) => case.tolerance = number(tolerance),
            _ => {
                let (left, value) = line.split_once(" = ").unwrap_or_else(|| panic!("{name}: cannot read `{line}`"));
                let (variable, time) = left.rsplit_once('(').unwrap_or_else(|| panic!("{name}: no time in `{line}`"));
                case.values.push((variable.into(), number(time.trim_end_matches(')')), number(value)));
            }
        }
    }
    assert!(!case.values.is_empty(), "{name}: nothing is expected");
    case
}

/// The last value at a time.
fn at(run: &Trajectory, variable: &str, time: f64) -> Option<f64> {
    let row = run.times.iter().rposition(|&t| (t - time).abs() < 1e-9)?;
    run.column(variable).map(|c| c[row])
}

fn failures(name: &str, text: &str) -> Vec<String> {
    let case = case(name, text);
    let world = MemoryWorld::single("model.mo", text);
    let request = Request { source: "model.mo".into(), model: case.model.clone(), ..Request::default() };
    let made = Simulation::compile(&world, &request).and_then(|mut simulation| {
        let settings = simulation.settings();
        (settings.stop_time, settings.interval, settings.tolerance) = (case.stop, case.stop / 100.0, 1e-8);
        simulation.run()
    });
    let run = match made {
        Ok(run) => run.trajectory,
        Err(e) => return vec![format!("{name}: {e}")],
    };
    let wrong = case.values.iter().filter_map(|(variable, time, value)| {
        let got = at(&run, variable, *time);
        let fits =
            got.is_some_and(|x| relative_eq!(x, *value, epsilon = case.tolerance, max_relative = case.tolerance));
        (!fits).then(|| format!("{name}: {variable}({time}) is {got:?}, not {value}"))
    });
    wrong.collect()
}

#[test]
fn models_do_what_their_text_means() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meaning");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("the folder").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let wrong: Vec<String> = files
        .iter()
        .flat_map(|path| {
            failures(
                &path.file_stem().expect("a name").to_string_lossy(),
                &std::fs::read_to_string(path).expect("a text"),
            )
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
