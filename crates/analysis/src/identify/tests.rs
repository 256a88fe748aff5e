use super::*;
use crate::study::{RecordingRole, Study};
use bramah_syntax::diag::Sources;
use bramah_syntax::world::MemoryWorld;
use std::path::Path;

/// Evenly spread numbers between -1 and 1, from a congruential generator.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

const LAG: &str = "model Lag
  parameter Real T(unit = \"s\", min = 0) = 1; parameter Real k = 1; parameter Real g = 1; parameter Real idle = 1;
  input Real u; Real x(start = 0, fixed = true); Real middle;
equation
  middle = g*u; T*der(x) = k*middle - x;
end Lag;";

/// T = 0.5, k g = 2, from x = 0.7: exact, with held inputs and noise of this amplitude.
fn lag_recording(seed: u64, amplitude: f64) -> String {
    let mut dice = Dice(seed);
    let mut text = "time,u,x\n".to_owned();
    let (mut x, mut u) = (0.7f64, 0.0);
    for k in 0..300 {
        if k % 20 == 0 {
            u = dice.roll().round() + 0.5;
        }
        text.push_str(&format!("{},{u},{}\n", f64::from(k) * 0.02, x + amplitude * dice.roll()));
        x = 2.0 * u + (x - 2.0 * u) * (-0.02f64 / 0.5).exp();
    }
    text
}

fn study(parameters: &str) -> String {
    format!(
        "version = 1\nmodel = \"m.mo\"\n[inputs]\nu = {{}}\n[signals]\nx = {{}}\n[[recordings]]\nfile = \"a.csv\"\n\
         [[recordings]]\nfile = \"b.csv\"\nrole = \"held\"\n[parameters]\n{parameters}"
    )
}

pub(super) fn world(model: &str, study: &str, train: String, held: String) -> MemoryWorld {
    let mut world = MemoryWorld::single("m.mo", model);
    world.add("study.toml", study);
    world.add("a.csv", train);
    world.add("b.csv", held);
    world
}

/// Runs everything and hands the fit to `see`.
pub(super) fn with_fit<T>(
    world: &MemoryWorld,
    method: IdentifyMethod,
    see: impl FnOnce(&IdentificationProblem<'_>, &Identification<'_>, &ParameterFit) -> T,
) -> T {
    let mut sources = Sources::default();
    let study = Study::read(world, Path::new("study.toml"), &mut sources).value.expect("a study");
    let outcome =
        bramah_circuit::compiled::compile(world, &study.request(), &bramah_solve::lower::LoweringOptions::INTERPRETED);
    let model = outcome.value.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics));
    let bound = study.bind(&model.flat).value.expect("fits");
    let train = bound.load(world, None, RecordingRole::Train, &mut sources).value.expect("readable");
    let problem = IdentificationProblem::new(&model, &bound, &train).expect("can be asked");
    let found = Identification::new(&problem, &train, method).expect("runs");
    let fit = found.fit().expect("runs");
    see(&problem, &found, &fit)
}

/// Runs everything and hands the report to `see`.
fn identified<T>(world: &MemoryWorld, method: IdentifyMethod, see: impl FnOnce(&IdentificationReport, &str) -> T) -> T {
    with_fit(world, method, |problem, found, fit| {
        let mut sources = Sources::default();
        let held = problem.bound.load(world, None, RecordingRole::Held, &mut sources).value.expect("readable");
        let held = found.judge_held(fit, &held).expect("runs");
        let words = separation_words(problem, found) + &fit_words(problem, fit, &held);
        see(&IdentificationReport::new(problem, found, fit, &held, &[]), &words)
    })
}

/// Normal numbers that resemble their neighbours: each is 0.7 of the one before plus new noise; deviation about 1.
struct Coloured(Dice, f64);

impl Coloured {
    fn next(&mut self) -> f64 {
        let fresh: f64 = (0..12).map(|_| self.0.roll()).sum::<f64>() / 2.0;
        self.1 = 0.7 * self.1 + (1.0 - 0.7f64 * 0.7).sqrt() * fresh;
        self.1
    }
}

/// Over many recordings with coloured noise the 95 % intervals hold the truth about as often as they say. The truth
/// starts at the model's own state.
#[test]
fn intervals_cover_the_truth_under_coloured_noise() {
    const RUNS: u64 = 100;
    let text = study("T = { min = 0.01 }\nk = { min = 0.1 }\n");
    let covered: usize = (0..RUNS)
        .map(|seed| {
            let mut noise = Coloured(Dice(977 * seed + 13), 0.0);
            let clean = lag_recording(seed, 0.0);
            let mut lines = clean.lines();
            let mut noisy = format!("{}\n", lines.next().expect("the names"));
            for line in lines {
                let (head, x) = line.rsplit_once(',').expect("three columns");
                let x: f64 = x.parse().expect("a number");
                noisy.push_str(&format!("{head},{}\n", x + 0.05 * noise.next()));
            }
            let world = world(LAG, &text, noisy, clean);
            with_fit(&world, IdentifyMethod::Output, |problem, _, fit| {
                let holds = |j: usize, truth: f64| {
                    let (low, high) = fit.interval(problem, j);
                    usize::from(low <= truth && truth <= high)
                };
                holds(0, 0.5) + holds(1, 2.0)
            })
        })
        .sum();
    // 190 of 200 expected; the two parameters of one run are not independent
    assert!((183..=198).contains(&covered), "{covered} of {}", 2 * RUNS);
}

fn number(report: &IdentificationReport, name: &str, what: &str) -> f64 {
    report.parameters[name][what].as_f64().expect("a number")
}

#[test]
fn parameters_and_the_unknown_initial_state_are_found() {
    let text = study("T = { min = 0.01 }\nk = { sigma = \"80 %\" }\n");
    let world = world(LAG, &text, lag_recording(1, 0.02), lag_recording(2, 0.02));
    identified(&world, IdentifyMethod::Auto, |report, _| {
        assert_eq!((report.method, report.converged, report.derivatives.as_str()), ("output error", true, "exact"));
        for (name, truth) in [("T", 0.5), ("k", 2.0)] {
            let (value, std) = (number(report, name, "value"), number(report, name, "std"));
            assert!((value - truth).abs() < 3.0 * std && std < 0.01 * truth, "{name}: {value} +- {std}");
        }
        let held = report.fit.held["x"].as_f64().unwrap();
        assert!((held - 0.02 / 3f64.sqrt()).abs() < 2e-3, "{held}");
        assert!(report.inseparable.is_empty() && report.at_bound.is_empty());
    });
}

#[test]
fn what_cannot_be_told_apart_is_said_with_the_sensor_that_would() {
    let text = study("T = { min = 0.01 }\nk = { min = 0.1 }\ng = { min = 0.1 }\nidle = { min = 0.1 }\n");
    let world = world(LAG, &text, lag_recording(1, 0.02), lag_recording(2, 0.02));
    identified(&world, IdentifyMethod::Output, |report, words| {
        assert_eq!(report.inseparable.len(), 2);
        assert_eq!(report.inseparable[0], ["idle"]);
        assert!(report.inseparable[1].contains(&"k".to_owned()) && report.inseparable[1].contains(&"g".to_owned()));
        assert!(words.contains("measuring one of these would help: middle"), "{words}");
    });
}

#[test]
fn a_bound_that_holds_is_named() {
    let text = study("T = { min = 0.8 }\nk = { min = 0.1 }\n");
    let world = world(LAG, &text, lag_recording(1, 0.02), lag_recording(2, 0.02));
    identified(&world, IdentifyMethod::Output, |report, words| {
        assert_eq!(report.at_bound, ["T"]);
        assert!(words.contains("`T` ended at a bound"));
    });
}

#[test]
fn the_inverse_model_finds_mass_and_friction() {
    let model = "model Slider
      parameter Real M(unit = \"kg\", min = 0) = 1; parameter Real d(unit = \"N.s/m\", min = 0) = 1;
      input Real u(unit = \"N\"); Real x(unit = \"m\", start = 0, fixed = true); Real v(unit = \"m/s\");
    equation
      der(x) = v; M*der(v) = u - d*v;
    end Slider;";
    // x = sin(3 t) + sin(7 t)/3 with M = 4, d = 3
    let recording = |amplitude: f64, seed: u64| {
        let mut dice = Dice(seed);
        let mut text = "time,u,x\n".to_owned();
        for k in 0..4000 {
            let t = f64::from(k) * 0.002;
            let x = (3.0 * t).sin() + (7.0 * t).sin() / 3.0;
            let v = 3.0 * (3.0 * t).cos() + 7.0 / 3.0 * (7.0 * t).cos();
            let a = -9.0 * (3.0 * t).sin() - 49.0 / 3.0 * (7.0 * t).sin();
            text.push_str(&format!("{t},{},{}\n", 4.0 * a + 3.0 * v + amplitude * dice.roll(), x + 1e-5 * dice.roll()));
        }
        text
    };
    let world = world(model, &study("M = { min = 0.1 }\nd = { min = 0.0 }\n"), recording(1.0, 3), recording(0.0, 4));
    identified(&world, IdentifyMethod::Auto, |report, _| {
        assert_eq!(report.method, "inverse model");
        for (name, truth) in [("M", 4.0), ("d", 3.0)] {
            let (value, std) = (number(report, name, "value"), number(report, name, "std"));
            assert!((value - truth).abs() < 0.01 * truth && std < 0.05 * truth, "{name}: {value} +- {std}");
        }
    });
}

/// Derivatives by parameters and by an unknown initial state, with gaps in the data, against differences.
#[test]
fn derivatives_of_runs_agree_with_differences() {
    let model = "model Tank parameter Real a = 1, k(min = 0) = 2; input Real u; Real x(start = 0.5, fixed = true);
        equation der(x) = k*u - a*x^3 - sin(x); end Tank;";
    let text = study("a = { min = -5.0, max = 5.0 }\nk = { sigma = \"10 %\" }\n");
    let line = |(k, line): (usize, &str)| match line.rsplit_once(',') {
        Some((head, _)) if k % 7 == 3 => format!("{head},\n"),
        _ => format!("{line}\n"),
    };
    let gap: String = lag_recording(1, 0.02).lines().enumerate().map(line).collect();
    let world = world(model, &text, gap, lag_recording(2, 0.02));
    with_fit(&world, IdentifyMethod::Output, |problem, found, fit| {
        assert_eq!(fit.differences, None);
        let mut exact = found.output_error().expect("starts");
        let mut plain = OutputError::new(problem, found.train, None).expect("starts");
        (exact.runner.tolerance, plain.runner.tolerance) = (1e-11, 1e-11);
        let z = [0.2, -0.1, 0.3];
        let (r, s) = (exact.residual(&z).expect("runs"), plain.residual(&z).expect("runs"));
        let (j, d) = (exact.jacobian(&z, &r).expect("runs"), plain.jacobian(&z, &s).expect("runs"));
        assert!(exact.differences().is_none() && plain.differences().is_some());
        for k in 0..3 {
            let apart = (j.column(k) - d.column(k)).amax() / d.column(k).amax();
            assert!(apart < 1e-6, "{k}: {apart}");
        }
    });
}

/// An unstable motion under feedback: one run over the whole recording leaves it, pieces that find their own start do
/// not.
#[test]
fn pieces_of_an_unstable_recording() {
    let model =
        "model Rod parameter Real a(min = 0) = 2, k(min = 0) = 1; input Real u; Real x(start = 0, fixed = true);
        equation der(x) = a*x + k*u; end Rod;";
    let (mut dice, mut x, mut text) = (Dice(3), 0.3f64, "time,u,x\n".to_owned());
    for i in 0..1000 {
        let t = 0.01 * f64::from(i);
        let u = -2.2 * x + 0.5 * (0.9 * t).sin() + if i / 60 % 2 == 0 { -0.3 } else { 0.3 };
        text.push_str(&format!("{t},{u},{}\n", x + 0.02 * dice.roll()));
        let growth = 0.03f64.exp();
        x = x * growth + 2.0 * u * (growth - 1.0) / 3.0;
    }
    let pieces: String =
        (0..10).map(|i| format!("[[recordings]]\nfile = \"a.csv\"\nwindow = [{i}, {i}.99]\n")).collect();
    let study = format!(
        "version = 1\nmodel = \"m.mo\"\n[inputs]\nu = {{ hold = true }}\n[signals]\nx = {{}}\n{pieces}\
         [parameters]\na = {{ min = 0.1 }}\nk = {{ min = 0.1 }}\n"
    );
    let world = world(model, &study, text.clone(), text);
    with_fit(&world, IdentifyMethod::Output, |_, _, fit| {
        assert!(fit.converged && fit.differences.is_none());
        for (j, truth) in [3.0, 2.0].into_iter().enumerate() {
            let (value, std) = (fit.values[j], fit.deviations[j]);
            assert!((value - truth).abs() < 3.0 * std && std < 0.01 * truth, "{j}: {value} +- {std}");
        }
    });
}

/// As many unknowns as samples (two parameters and the start) meet them whatever they are: no deviation is reported.
#[test]
fn no_more_samples_than_unknowns_tell_nothing_about_deviations() {
    let few = |samples: usize| -> String {
        let all = lag_recording(1, 0.01);
        all.lines().take(1 + samples).flat_map(|line| [line, "\n"]).collect()
    };
    let parameters = "T = { min = 0.1, max = 10.0 }\nk = { min = 0.1, max = 10.0 }";
    for (samples, known) in [(3, false), (60, true)] {
        let world = world(LAG, &study(parameters), few(samples), few(samples));
        identified(&world, IdentifyMethod::Output, |report, words| {
            let finite = |key: &str| ["T", "k"].map(|name| report.parameters[name][key].is_number());
            assert_eq!((finite("std"), finite("degrees")), ([known; 2], [known; 2]), "{words}");
            assert_eq!(words.contains("nothing tells how sure the values are"), !known, "{words}");
        });
    }
}

/// A sampled value that depends on a parameter is left to differences, which is said.
#[test]
fn sampled_models_are_fitted_by_differences() {
    let model = "model Held parameter Real k(min = 0) = 1; input Real u; discrete Real g(start = 0, fixed = true);
        Real x(start = 0.7, fixed = true);
        equation when sample(0, 0.1) then g = k*u; end when; 0.5*der(x) = g - x; end Held;";
    let world = world(model, &study("k = { min = 0.1 }\n"), lag_recording(1, 0.02), lag_recording(2, 0.02));
    identified(&world, IdentifyMethod::Output, |report, words| {
        assert_eq!(report.derivatives, "differences: sampled values depend on what moves");
        assert!(words.contains("derivatives: differences: sampled values depend on what moves"));
    });
}

#[test]
fn questions_without_sense() {
    let said = |text: &str| {
        let world = world(LAG, text, lag_recording(1, 0.02), lag_recording(2, 0.02));
        let mut sources = Sources::default();
        let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.expect("a study");
        let model = bramah_circuit::compiled::compile(
            &world,
            &study.request(),
            &bramah_solve::lower::LoweringOptions::INTERPRETED,
        )
        .value
        .unwrap();
        let bound = study.bind(&model.flat).value.expect("fits");
        let train = bound.load(&world, None, RecordingRole::Train, &mut sources).value.expect("readable");
        match IdentificationProblem::new(&model, &bound, &train) {
            Err(d) => d[0].message.clone(),
            Ok(p) => Identification::new(&p, &train, IdentifyMethod::Inverse).err().expect("no inverse").message,
        }
    };
    assert_eq!(said(&study("T = \"exact\"\n")), "the study has no parameters to find");
    assert_eq!(said(&study("T = { min = 2 }\n")), "the bounds of `T` exclude its value in the model, 1");
    assert_eq!(said(&study("T = { min = 0.1 }\n")), "the model cannot be inverted with this study");
}

/// In a model whose output is linear in its parameters the profile is the parabola that the deviations say.
#[test]
fn profiles_of_a_linear_fit_agree_with_the_deviations_and_open_ones_are_open() {
    let model =
        "model Line parameter Real a = 1, b = 1, idle = 1; input Real u; Real x; Real y(start = 0, fixed = true);
        equation der(y) = 0; x = a*u + b*time + y; end Line;";
    let mut dice = Dice(5);
    let rows: String = (0..200)
        .map(|k| {
            let (t, u) = (f64::from(k) * 0.01, (f64::from(k) * 0.3).sin());
            format!("{t},{u},{}\n", 2.0 * u + 3.0 * t + 0.1 * dice.roll())
        })
        .collect();
    let text =
        study("a = { min = -9.0, max = 9.0 }\nb = { min = -9.0, max = 9.0 }\nidle = { min = -2.0, max = 2.0 }\n");
    let world = world(model, &text, format!("time,u,x\n{rows}"), format!("time,u,x\n{rows}"));
    with_fit(&world, IdentifyMethod::Output, |problem, found, fit| {
        for (j, truth) in [2.0, 3.0].into_iter().enumerate() {
            let profile = found.profile(fit, j).expect("runs");
            let (value, half) = (fit.values[j], chance::student(fit.degrees[j]) * fit.deviations[j]);
            let (low, high) = profile.interval;
            assert!(
                (low - value + half).abs() < 0.04 * half && (high - value - half).abs() < 0.04 * half,
                "{profile:?}"
            );
            assert!(low < truth && truth < high);
            // a trajectory, not only its ends: about as many points on both sides, each on the parabola
            let level = chance::student(fit.degrees[j]).powi(2);
            assert!((9..=13).contains(&profile.points.len()), "{profile:?}");
            assert!(profile.points[0].1 >= 0.9 * level && profile.points.last().expect("some").1 >= 0.9 * level);
            for &(at, rise) in &profile.points {
                let parabola = level * ((at - value) / half).powi(2);
                assert!((rise - parabola).abs() < 0.05 * level, "{at}: {rise} {parabola}");
            }
            let (low, high) = fit.interval(problem, j);
            assert!((low - value + half).abs() < 1e-3 * half && (high - value - half).abs() < 1e-3 * half);
        }
        let idle = found.profile(fit, 2).expect("runs");
        assert_eq!(idle.interval, (f64::NEG_INFINITY, f64::INFINITY), "{idle:?}");
        assert!(fit.residuals[0].white(), "{:?}", fit.residuals);
        let (x, y) = fit.ellipse(problem, 0, 1).expect("both are found");
        let reach = x.iter().fold(0.0f64, |m, v| m.max((v - fit.values[0]).abs()));
        assert!((reach - 2.4477 * fit.deviations[0]).abs() < 0.01 * reach && y.len() == x.len());
        assert!(fit.deviations[2].is_infinite() && fit.ellipse(problem, 0, 2).is_none());
        assert_eq!(picture(problem, fit, &[idle]).panels.len(), 1 + 1 + 1 + 1);
    });
}

/// The least squares of a frequency have many hollows: one start stays in a wrong one, several find the truth and say
/// how many of them did.
#[test]
fn several_starts_find_the_least_of_many_minima() {
    let model = "model Tone parameter Real w(min = 0.1) = 1; input Real u; Real x; Real y(start = 0, fixed = true);
        equation der(y) = 0; x = sin(w*time) + u + y; end Tone;";
    let mut dice = Dice(5);
    let row = |t: f64| format!("{t},0,{}\n", (2.2 * t).sin() + 0.1 * dice.roll());
    let rows: String = (0..400).map(|k| 0.05 * f64::from(k)).map(row).collect();
    let text = format!("time,u,x\n{rows}");
    let world = world(model, &study("w = { min = 0.1, max = 9.0 }\n"), text.clone(), text);
    with_fit(&world, IdentifyMethod::Output, |problem, found, fit| {
        assert!((fit.values[0] - 2.2).abs() > 0.5 && fit.starts.tried == 1, "{:?}", fit.values);
        let several = found.fit_from(24, 1).expect("runs");
        assert!((several.values[0] - 2.2).abs() < 0.01, "{:?} {:?}", several.values, several.starts);
        let MultistartSummary { tried, here, worse, failed } = several.starts;
        assert!(tried == 24 && here > 0 && worse > 0 && here + worse + failed == tried, "{:?}", several.starts);
        let words = fit_words(problem, &several, &[]);
        assert!(words.contains(&format!("of 24 starts {here} led to this least value, {worse} to larger ones")));
        assert_eq!(found.fit_from(24, 1).expect("runs").values, several.values);
    });
}

/// A signal whose derivative has no value at the start, though the signal has: said, and left to differences.
#[test]
fn a_derivative_without_a_value_is_left_to_differences() {
    let model = "model Root parameter Real k(min = 0) = 1; input Real u; Real z(start = 0, fixed = true); Real x;
        equation der(z) = 1; x = sqrt(k*z); end Root;";
    let rows: String = (0..50).map(|i| 0.02 * f64::from(i)).map(|t| format!("{t},0,{}\n", (2.0 * t).sqrt())).collect();
    let text = format!("time,u,x\n{rows}");
    let world = world(model, &study("k = { min = 0.1 }\n"), text.clone(), text);
    with_fit(&world, IdentifyMethod::Output, |_, _, fit| {
        assert!(fit.differences.as_ref().is_some_and(|why| why.contains("not finite")), "{:?}", fit.differences);
        assert!(fit.values[0].is_finite() && fit.deviations[0] > 0.0, "{:?}", fit.values);
    });
}

#[test]
fn columns_of_another_sign_or_unit_are_suspected() {
    let text = study("T = { min = 0.01 }\nk = { sigma = \"80 %\" }\n");
    let times = |factor: f64| {
        let line = |l: &str| match l.rsplit_once(',').map(|(rest, x)| (rest, x.parse::<f64>())) {
            Some((rest, Ok(x))) => format!("{rest},{}\n", factor * x),
            _ => format!("{l}\n"),
        };
        lag_recording(1, 0.02).lines().map(line).collect::<String>()
    };
    for (factor, cause) in [(1.0, None), (-1.0, Some("a `sign`, of")), (1000.0, Some("a `unit`, of"))] {
        let world = world(LAG, &text, times(factor), times(factor));
        with_fit(&world, IdentifyMethod::Output, |_, found, _| {
            let said: Vec<&String> = found.suspicions.iter().flat_map(|d| &d.help).collect();
            match cause {
                Some(cause) => assert!(said.len() == 1 && said[0].contains(cause), "{factor}: {said:?}"),
                None => assert!(said.is_empty(), "{said:?}"),
            }
        });
    }
}
