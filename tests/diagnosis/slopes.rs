//! Simulations of recordings: how the signals depend on the parameters, along recordings and through corners, beside central
//! differences; and that they do not depend on how often a recording was sampled.

#![allow(clippy::disallowed_methods, reason = "tests look for their files")]
#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

use bramah::internals::diag::Sources;
use bramah::internals::gap::data::RecordingData;
use bramah::internals::gap::estimate::simulation::from_start;
use bramah::internals::gap::problem::DiagnosisProblem;
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
fn farthest(problem: &DiagnosisProblem<'_>) -> (f64, String) {
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

/// What a study asks; nothing where it is not there.
fn with_problem(study: &str, test: impl Fn(&DiagnosisProblem<'_>)) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(study);
    if !path.exists() {
        println!("skipped: no {}", path.display());
        return;
    }
    let mut sources = Sources::default();
    let study = Study::read(&DiskWorld, &path, &mut sources).value.unwrap();
    let asked = question(&DiskWorld, &study, None, &mut sources).ok().unwrap();
    test(&asked.problem);
}

/// Slopes of the nominal model of a study are its differences.
fn are_right(study: &str) {
    with_problem(study, |problem| {
        let (off, name) = farthest(problem);
        assert!(off < BORNE, "{name}: {off:.3}");
    });
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

/// Samples of a recording that are left out for each that is kept, and the largest difference between the simulations of what
/// is kept with and without samples between them, in deviations of the sensors (root of the mean square).
const COARSER: usize = 10;
const SAME: f64 = 0.1;

/// The inputs of a recording at times, straight between its samples.
fn at_times(recording: &RecordingData, times: Vec<f64>) -> RecordingData {
    let between = |samples: &[f64]| {
        let one = |t: &f64| {
            let after = recording.times.partition_point(|x| x <= t).clamp(1, recording.len() - 1);
            let (t_0, t_1) = (recording.times[after - 1], recording.times[after]);
            samples[after - 1] + (samples[after] - samples[after - 1]) * (t - t_0) / (t_1 - t_0)
        };
        times.iter().map(one).collect()
    };
    RecordingData {
        inputs: recording.inputs.iter().map(|i| between(i)).collect(),
        linear: vec![true; recording.inputs.len()],
        signals: recording.signals.iter().map(|_| vec![f64::NAN; times.len()].into()).collect(),
        times: times.into(),
    }
}

/// However far samples are apart, the simulation between them is the same.
fn does_not_depend_on_sampling(study: &str) {
    with_problem(study, |problem| {
        let candidate = models::nominal(problem).unwrap();
        let model = &candidate.model;
        let recording = &problem.train[0];
        let coarse = at_times(recording, recording.times.iter().copied().step_by(COARSER).collect());
        let split =
            |w: &[f64]| (0..COARSER).map(|k| w[0] + (w[1] - w[0]) * k as f64 / COARSER as f64).collect::<Vec<_>>();
        let fine = at_times(&coarse, coarse.times.windows(2).flat_map(split).collect());
        let run =
            |r: &RecordingData| from_start(&model.plan, &model.theta, (&model.sizes, model.correction), r).unwrap();
        let (coarse, fine) = (run(&coarse), run(&fine));
        for (i, signal) in problem.signals.iter().enumerate() {
            let off: Vec<f64> = fine[i].iter().step_by(COARSER).zip(&coarse[i]).map(|(a, b)| (a - b).powi(2)).collect();
            let rms = (off.iter().sum::<f64>() / off.len() as f64).sqrt() / candidate.deviations[i];
            assert!(rms < SAME, "{}: {rms:.3} deviations", signal.name);
        }
    });
}

#[test]
fn of_coarse_samples_of_a_closed_circuit() {
    does_not_depend_on_sampling("examples/diagnosis/gap.toml");
}

#[test]
fn of_coarse_samples_of_a_cylinder() {
    does_not_depend_on_sampling("../shared/gapbench/papers/force/study.toml");
}
