//! Cut recordings: motions that one long run cannot follow.

use super::tests::{Dice, with_fit, world};
use super::*;

fn study(pieces: usize, inputs: &str, parameters: &str) -> String {
    format!(
        "version = 1\nmodel = \"m.mo\"\n{inputs}[signals]\nx = {{}}\n[[recordings]]\nfile = \"a.csv\"\n\
         pieces = {pieces}\n[parameters]\n{parameters}"
    )
}

/// Lorenz' equations with 10, 28 and 8/3, x alone read every 0.02 s for 12 s, by steps of the fourth order.
fn butterfly(noise: f64) -> String {
    let rate = |s: [f64; 3]| [10.0 * (s[1] - s[0]), s[0] * (28.0 - s[2]) - s[1], s[0] * s[1] - 8.0 / 3.0 * s[2]];
    let along = |s: [f64; 3], k: [f64; 3], h: f64| [s[0] + h * k[0], s[1] + h * k[1], s[2] + h * k[2]];
    let (mut dice, mut s, mut text) = (Dice(11), [-8.0, 7.0, 27.0], "time,x\n".to_owned());
    for i in 0..600 {
        text.push_str(&format!("{},{}\n", 0.02 * f64::from(i), s[0] + noise * dice.roll()));
        for _ in 0..20 {
            let h = 1e-3;
            let k1 = rate(s);
            let k2 = rate(along(s, k1, 0.5 * h));
            let k3 = rate(along(s, k2, 0.5 * h));
            let k4 = rate(along(s, k3, h));
            (0..3).for_each(|j| s[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
        }
    }
    text
}

const LORENZ: &str = "model Lorenz parameter Real s(min = 0) = 8, r(min = 0) = 24, b(min = 0) = 2.2;
    Real x(start = -8, fixed = true, nominal = 10); Real y(start = 7, fixed = true, nominal = 10);
    Real z(start = 27, fixed = true, nominal = 10);
    equation der(x) = s*(y - x); der(y) = x*(r - z) - y; der(z) = x*y - b*z; end Lorenz;";

/// A chaotic motion forgets where it began: one run over the recording finds nothing, pieces that join find the truth.
#[test]
fn joined_pieces_of_a_chaotic_recording() {
    let fitted = |pieces: usize| {
        let parameters = "s = { min = 0.1 }\nr = { min = 0.1 }\nb = { min = 0.1 }\n";
        let text = butterfly(0.5);
        let world = world(LORENZ, &study(pieces, "", parameters), text.clone(), text);
        with_fit(&world, IdentifyMethod::Output, |_, _, fit| fit.clone())
    };
    let truth = [10.0, 28.0, 8.0 / 3.0];
    let whole = fitted(1);
    assert!((0..3).any(|j| (whole.values[j] / truth[j] - 1.0).abs() > 0.02), "{:?}", whole.values);
    let cut = fitted(24);
    for (j, truth) in truth.into_iter().enumerate() {
        let (value, std) = (cut.values[j], cut.deviations[j]);
        assert!((value - truth).abs() < 3.0 * std && std < 1e-2 * truth, "{j}: {value} +- {std}");
    }
    let joints = cut.joints.clone().expect("there are some");
    assert!(cut.converged && joints.count == 23 && joints.jump < 1e-6, "{joints:?}");
}

/// An unstable rod under feedback: pieces that join say more than pieces alone, for each end is a start.
#[test]
fn joined_pieces_of_an_unstable_recording() {
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
    let study = study(10, "[inputs]\nu = { hold = true }\n", "a = { min = 0.1 }\nk = { min = 0.1 }\n");
    let world = world(model, &study, text.clone(), text);
    with_fit(&world, IdentifyMethod::Output, |problem, _, fit| {
        assert!(fit.converged && fit.differences.is_none(), "{:?}", fit.differences);
        for (j, truth) in [3.0, 2.0].into_iter().enumerate() {
            // the pieces alone leave 0.012 and 0.007
            let (value, std) = (fit.values[j], fit.deviations[j]);
            assert!((value - truth).abs() < 3.0 * std && std < [0.009, 0.006][j], "{j}: {value} +- {std}");
        }
        let words = fit_words(problem, fit, &[]);
        assert!(words.contains("the pieces join: at 9 places `x` jumps by"), "{words}");
    });
}

/// What is moved at a joint is seen in both pieces, by equations and by differences.
#[test]
fn derivatives_across_joints_agree_with_differences() {
    let parameters = "s = { min = 0.1 }\nr = { min = 0.1 }\nb = { min = 0.1 }\n";
    let text: String = butterfly(0.5).lines().take(80).map(|line| format!("{line}\n")).collect();
    let world = world(LORENZ, &study(4, "", parameters), text.clone(), text);
    with_fit(&world, IdentifyMethod::Output, |problem, found, _| {
        let mut exact = found.output_error().expect("starts");
        let mut plain = OutputError::new(problem, found.train, None).expect("starts");
        (exact.runner.tolerance, plain.runner.tolerance) = (1e-11, 1e-11);
        let z: Vec<f64> = (0..exact.unknowns()).map(|j| 0.02 * (1.0 + j as f64).cos()).collect();
        let (r, s) = (exact.residual(&z).expect("runs"), plain.residual(&z).expect("runs"));
        let (j, d) = (exact.jacobian(&z, &r).expect("runs"), plain.jacobian(&z, &s).expect("runs"));
        assert!(exact.differences().is_none() && plain.differences().is_some());
        for k in 0..z.len() {
            let apart = (j.column(k) - d.column(k)).amax() / d.column(k).amax();
            assert!(apart < 1e-5, "{k}: {apart}");
        }
    });
}
