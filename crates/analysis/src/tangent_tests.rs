use super::*;
use bramah_results::Trajectory;
use bramah_solve::signals;

fn id(flat: &FlatModel, name: &str) -> VarId {
    let i = flat.variables.iter().position(|v| v.name == name).expect("the model has it");
    VarId(u32::try_from(i).expect("small"))
}

fn flat(text: &str) -> FlatModel {
    bramah_model::compile::flatten_text(text, None).value.expect("sound").flat
}

/// Times, and by direction (the plain run first) the trajectories of variables.
fn carried(text: &str, parameters: &[(&str, f64)], wanted: &[&str], stop: f64) -> (Vec<f64>, Vec<Vec<Vec<f64>>>) {
    let flat = flat(text);
    let moved: Vec<(VarId, f64)> = parameters.iter().map(|(n, size)| (id(&flat, n), *size)).collect();
    let tangent = TangentModel::new(&flat, &moved).expect("can be carried");
    let mut settings = Settings {
        stop_time: stop,
        interval: stop / 20.0,
        tolerance: 1e-10,
        wanted: wanted.iter().map(|n| id(&flat, n)).collect(),
        ..Settings::default()
    };
    settings.tangents = Some(tangent.starts(&settings, &[]).expect("starts"));
    let cells: Vec<VarId> = (0..=moved.len()).flat_map(|_| settings.wanted.clone()).collect();
    let mut rows = Trajectory::new(signals(&tangent.system.dae, &cells));
    let run = simulate(&tangent.system, &settings, &[], None, &mut rows, &mut Control::default());
    assert!(run.end.is_success(), "{:?}", run.diagnostics);
    (rows.times, rows.columns.chunks(wanted.len()).map(<[_]>::to_vec).collect())
}

#[test]
fn a_decay_by_its_rate_by_what_its_rate_follows_and_by_its_start() {
    let text = "model M parameter Real a = 1, k = 2*a, x0 = 3; Real x(start = x0, fixed = true), y;
         equation der(x) = -k*x; y = x^2; end M;";
    let (times, found) = carried(text, &[("a", 1.0), ("k", 1.0), ("x0", 3.0)], &["x", "y"], 1.0);
    for (row, t) in times.iter().enumerate() {
        let x = 3.0 * (-2.0 * t).exp();
        for (direction, dx) in [-2.0 * t * x, -t * x, x].into_iter().enumerate() {
            let [dx_found, dy_found] = [0, 1].map(|v| found[direction + 1][v][row]);
            assert!((dx_found - dx).abs() < 1e-7, "{direction} at {t}: {dx_found} {dx}");
            assert!((dy_found - 2.0 * x * dx).abs() < 1e-6, "{direction} at {t}: {dy_found}");
        }
    }
}

#[test]
fn what_cannot_be_carried_is_refused() {
    let sampled = flat(
        "model M parameter Real p = 1; discrete Real u(start = 0); Real x(start = 1, fixed = true);
        equation der(x) = u - x; when sample(0, 0.1) then u = p*x; end when; end M;",
    );
    let why = TangentModel::new(&sampled, &[(id(&sampled, "p"), 1.0)]).err();
    assert_eq!(why.as_deref(), Some("sampled values depend on what moves"));
}

/// The rate jumps where the state passes a threshold that moves: x = p + 3 (t - p/a) behind it, with x = a t before.
#[test]
fn a_jump_of_the_rate_at_an_event_that_moves() {
    let text = "model M parameter Real p = 1, a = 2; Real x(start = 0, fixed = true);
        equation der(x) = if x < p then a else 3; end M;";
    let (times, found) = carried(text, &[("p", 1.0), ("a", 1.0)], &["x"], 1.0);
    for (row, &t) in times.iter().enumerate().filter(|(_, t)| (**t - 0.5).abs() > 1e-6) {
        let [by_p, by_a] = if t < 0.5 { [0.0, t] } else { [1.0 - 1.5, 3.0 / 4.0] };
        let got = [found[1][0][row], found[2][0][row]];
        assert!((got[0] - by_p).abs() < 1e-7 && (got[1] - by_a).abs() < 1e-7, "{t}: {got:?} {by_p} {by_a}");
    }
}

/// A ball that bounces several times, with gravity, restitution and height moved, against its exact trajectory.
#[test]
fn a_bouncing_ball() {
    let text = "model M parameter Real g = 9.81, e = 0.7, h0 = 1; Real h(start = h0, fixed = true), v(start = 0, fixed = true);
        equation der(h) = v; der(v) = -g; when h < 0 then reinit(v, -e*pre(v)); end when; end M;";
    let height = |[g, e, h0]: [f64; 3], t: f64| {
        let (mut start, mut speed, mut left) = ((2.0 * h0 / g).sqrt(), (2.0 * g * h0).sqrt(), t);
        if left <= start {
            return h0 - g * t * t / 2.0;
        }
        loop {
            left -= start;
            speed *= e;
            start = 2.0 * speed / g;
            if left <= start {
                return speed * left - g * left * left / 2.0;
            }
        }
    };
    let theta = [9.81, 0.7, 1.0];
    let (times, found) = carried(text, &[("g", 1.0), ("e", 1.0), ("h0", 1.0)], &["h"], 1.9);
    let mut seen = 0;
    for (row, &t) in times.iter().enumerate() {
        for k in 0..3 {
            let at = |d: f64| {
                let mut moved = theta;
                moved[k] += d;
                height(moved, t)
            };
            // rows at an event have two values
            let exact = (at(1e-6) - at(-1e-6)) / 2e-6;
            let near = times.iter().enumerate().any(|(other, &u)| other != row && (u - t).abs() < 1e-5);
            if !near {
                seen += 1;
                assert!((found[k + 1][0][row] - exact).abs() < 1e-5, "{k} at {t}: {} {exact}", found[k + 1][0][row]);
            }
        }
    }
    assert!(seen > 50);
}
