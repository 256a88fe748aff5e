//! How the signals depend on the parameters, along recordings and through corners, beside central differences.

#![allow(clippy::disallowed_methods, reason = "tests look for their files")]
#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

use bramah::internals::diag::Sources;
use bramah::internals::gap::problem::Problem;
use bramah::internals::gap::select::models;
use bramah::internals::gap::study::question;
use bramah::internals::study::Study;
use bramah::world::DiskWorld;
use std::path::Path;

/// Step of a difference, in tolerances.
const STEP: f64 = 0.01;
/// Slopes that move no signal by this part of its sensor's deviation over a tolerance are round-off.
const SEEN: f64 = 0.1;

/// The largest distance of a slope from its difference, root of the mean square over a recording, as part of the difference.
fn farthest(problem: &Problem<'_>) -> (f64, String) {
    let mut model = models::nominal(problem).unwrap();
    let x = model.present();
    model.off = model.evaluate(&x, &problem.train).unwrap().off;
    let (signals, width) = (problem.signals.len(), x.len());
    let mut worst = (0.0, String::new());
    for (number, recording) in problem.train.iter().enumerate() {
        let slopes = model.slopes(&x, recording, number).unwrap();
        for k in 0..width {
            let at = |step: f64| {
                let mut x = x.clone();
                x[k] += step;
                model.errors(&x, recording, Some(number)).unwrap()
            };
            let (below, above) = (at(-STEP), at(STEP));
            for i in 0..signals {
                let (mut off, mut all, mut count) = (0.0, 0.0, 0.0);
                for (s, (a, b)) in below[i].iter().zip(&above[i]).enumerate() {
                    // errors are measured minus simulated
                    let difference = (a - b) / (2.0 * STEP);
                    if difference.is_finite() {
                        off += (f64::from(slopes[(s * signals + i) * width + k]) - difference).powi(2);
                        all += difference * difference;
                        count += 1.0;
                    }
                }
                if (all / count).sqrt() > SEEN * model.deviations[i] {
                    let name = format!("{} at {}", problem.tolerances[k].name, problem.signals[i].name);
                    worst = if (off / all).sqrt() > worst.0 { ((off / all).sqrt(), name) } else { worst };
                }
            }
        }
    }
    worst
}

/// As part of a difference, what a Gauss-Newton step bears. Where signals jump, and in a limit cycle, the differences
/// themselves scatter by some per cent.
const BORNE: f64 = 0.3;

/// Slopes of the nominal model of a study are its differences.
fn are_right(study: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(study);
    if !path.exists() {
        println!("skipped: no {}", path.display());
        return;
    }
    let mut sources = Sources::default();
    let study = Study::read(&DiskWorld, &path, &mut sources).value.unwrap();
    let asked = question(&DiskWorld, &study, None, &mut sources).ok().unwrap();
    let (off, name) = farthest(&asked.problem);
    assert!(off < BORNE, "{name}: {off:.3}");
}

#[test]
fn of_a_closed_circuit() {
    are_right("examples/diagnosis/gap.toml");
}

#[test]
fn of_a_closed_circuit_with_an_induction_motor() {
    are_right("../shared/gapbench/papers/leak_3/study.toml");
}

/// Its valves chatter at rest, friction sticks and slips: a limit cycle of 50 Hz. What carries the matrix of a step's beginning
/// over a corner is off by a factor of a hundred there.
#[test]
fn of_a_cylinder_in_a_limit_cycle() {
    are_right("../shared/gapbench/papers/force/study.toml");
}
