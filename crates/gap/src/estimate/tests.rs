//! Simulation from the inputs alone against closed forms, and where a recording is said to begin.

use super::super::data::RecordingData;
use super::simulation::{RecordingRun, TrajectorySensitivities, from_start};
use super::start::ParameterisedModel;
use bramah_analysis::lift;
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use bramah_expr::VarId;
use nalgebra::DMatrix;
use std::sync::Arc;

/// The largest correction that any study lets pass.
const CORRECTION: f64 = 1e-4;

fn plan(text: &str, parameters: &[&str], outputs: &[&str]) -> Arc<EvaluationPlan> {
    let flat = bramah_model::compile::flatten_text(text, None).value.expect("a model").flat;
    let id = |name: &&str| {
        let i = flat.variables.iter().position(|v| v.name == *name).expect("the model has it");
        VarId(u32::try_from(i).expect("small"))
    };
    let ids = |names: &[&str]| names.iter().map(id).collect::<Vec<_>>();
    Arc::new(EvaluationPlan::new(&lift(&flat, &ids(parameters), &ids(outputs))).expect("can be sorted"))
}

fn recording(samples: usize, step: f64, input: &[fn(f64) -> f64], signals: &[&dyn Fn(f64) -> f64]) -> RecordingData {
    let times: Arc<[f64]> = (0..samples).map(|k| k as f64 * step).collect();
    RecordingData {
        inputs: input.iter().map(|u| times.iter().map(|t| u(*t)).collect()).collect(),
        linear: vec![true; input.len()],
        signals: signals.iter().map(|y| times.iter().map(|t| y(*t)).collect()).collect(),
        times,
    }
}

/// The largest distance of the first output from a closed form.
fn farthest(plan: &Arc<EvaluationPlan>, sizes: &[f64], recording: &RecordingData, exact: impl Fn(f64) -> f64) -> f64 {
    let theta = plan.parameter_values();
    let found = from_start(plan, &theta, (sizes, CORRECTION), recording).expect("a trajectory");
    found[0].iter().zip(recording.times.iter()).map(|(y, t)| (y - exact(*t)).abs()).fold(0.0, f64::max)
}

/// x' = -x^2 has x = 1/(1 + t). The steps keep to it however far apart the samples are, and far better than the correction
/// that they let pass (1e-4) although it is made over and over.
#[test]
fn a_curved_rate_is_followed_between_samples_near_and_far() {
    let plan = plan("model M Real x(start = 1, fixed = true); equation der(x) = -x^2; end M;", &[], &["x"]);
    for (samples, step) in [(501, 0.01), (101, 0.05), (26, 0.2), (6, 1.0)] {
        let off = farthest(&plan, &[1.0], &recording(samples, step, &[], &[]), |t| 1.0 / (1.0 + t));
        assert!(off < 5e-5, "samples {step} s apart: {off:.1e} off");
    }
}

/// Of a fast lag behind a curved rate nothing adds up: z follows x^2 with 1 ms, z = x^2 + 2 x^3/1000 + ...
#[test]
fn a_fast_lag_behind_a_curved_rate_is_followed() {
    let text = "model M Real x(start = 1, fixed = true); Real z(start = 1.002, fixed = true);
        equation der(x) = -x^2; der(z) = 1000*(x^2 - z); end M;";
    let exact = |t: f64| {
        let x = 1.0 / (1.0 + t);
        x * x + 2e-3 * x.powi(3) + 6e-6 * x.powi(4)
    };
    let off = farthest(&plan(text, &[], &["z"]), &[1.0, 1.0], &recording(101, 0.05, &[], &[]), exact);
    assert!(off < 1e-4, "{off:.1e} off");
}

/// A ramp of an input through a square: x' = u^2 with u = t has x = t^3/3.
#[test]
fn an_input_on_the_way_from_one_sample_to_the_next_is_seen() {
    let text = "model M input Real u; Real x(start = 0, fixed = true); equation der(x) = u^2; end M;";
    let off = farthest(&plan(text, &[], &["x"]), &[1.0], &recording(21, 0.1, &[|t| t], &[]), |t| t.powi(3) / 3.0);
    assert!(off < 1e-4, "{off:.1e} off");
}

/// x' = -a x^2 has dx/da = -t/(1 + a t)^2.
#[test]
fn slopes_go_along() {
    let text = "model M parameter Real a = 1; Real x(start = 1, fixed = true); equation der(x) = -a*x^2; end M;";
    let plan = plan(text, &["a"], &["x"]);
    let recording = recording(101, 0.02, &[], &[]);
    let mut local = LocalEvaluator::start(plan.clone(), 0.0, &[1.0], &[]).expect("starts");
    let slopes = Some(TrajectorySensitivities::new(DMatrix::zeros(1, 1), vec![Some((0, 1.0))], 1));
    let mut run = RecordingRun {
        local: &mut local,
        theta: &[1.0],
        sizes: &[1.0],
        correction: CORRECTION,
        state: vec![1.0],
        slopes,
        left: usize::MAX,
    };
    let mut off = 0.0_f64;
    run.along(&recording, 0..recording.len(), |k, _, slopes| {
        let t = recording.times[k];
        off = off.max((slopes.expect("slopes")[(0, 0)] + t / (1.0 + t).powi(2)).abs());
        std::ops::ControlFlow::Continue(())
    })
    .expect("a trajectory");
    assert!(off < 1e-4, "{off:.1e} off");
}

/// A mass that falls on a stiff spring: its law is positively homogeneous, so that its height depends on gravity and height
/// of fall together as on itself, bounce after bounce.
#[test]
fn slopes_pass_corners() {
    let text = "model M parameter Real g = 1; Real x(start = 1, fixed = true); Real v(start = 0, fixed = true);
        equation der(x) = v; der(v) = -g + 1e4*max(-x, 0); end M;";
    let plan = plan(text, &["g"], &["x"]);
    let recording = recording(801, 0.02, &[], &[]);
    let mut local = LocalEvaluator::start(plan.clone(), 0.0, &[1.0], &[]).expect("starts");
    let states = DMatrix::from_row_slice(2, 1, &[1.0, 0.0]);
    let slopes = Some(TrajectorySensitivities::new(states, vec![Some((0, 1.0))], 1));
    let mut run = RecordingRun {
        local: &mut local,
        theta: &[1.0],
        sizes: &[1.0, 1.0],
        correction: CORRECTION,
        state: vec![1.0, 0.0],
        slopes,
        left: usize::MAX,
    };
    let (mut off, mut bounces, mut fell) = (0.0_f64, 0, false);
    run.along(&recording, 0..recording.len(), |_, local, slopes| {
        off = off.max((slopes.expect("slopes")[(0, 0)] - local.outputs[0]).abs());
        let falls = local.state()[1] < 0.0;
        bounces += usize::from(fell && !falls);
        fell = falls;
        std::ops::ControlFlow::Continue(())
    })
    .expect("a trajectory");
    assert!(bounces >= 5, "{bounces}");
    assert!(off < 0.02, "{off:.1e} off");
}

/// A store that runs empty gives way within microseconds, until a valve opens: for that moment slopes grow as fast as they
/// fall behind it. Sampled beside the snap, what grows must not be stretched over a step of 20 ms.
#[test]
fn slopes_pass_a_snap() {
    let text = "model M parameter Real a = 1; Real x(start = 2, fixed = true); equation
        (1e-4 + 0.5*(1 + tanh((x - 1)/0.01)))*der(x) = -a + 10*max(0.5 - x, 0); end M;";
    let plan = plan(text, &["a"], &["x"]);
    // before the store is empty x = 2 - a t; behind it the valve gives x = 0.5 - a/10
    for shift in 0..20 {
        let mut recording = recording(100, 0.02, &[], &[]);
        let times = (0..100).map(|k| 0.02 * f64::from(k) + if k > 0 { 0.001 * f64::from(shift) } else { 0.0 });
        recording.times = times.collect::<Vec<_>>().into();
        let mut local = LocalEvaluator::start(plan.clone(), 0.0, &[1.0], &[]).expect("starts");
        let slopes = Some(TrajectorySensitivities::new(DMatrix::zeros(1, 1), vec![Some((0, 1.0))], 1));
        let mut run = RecordingRun {
            local: &mut local,
            theta: &[1.0],
            sizes: &[1.0],
            correction: CORRECTION,
            state: vec![2.0],
            slopes,
            left: usize::MAX,
        };
        run.along(&recording, 0..recording.len(), |k, _, slopes| {
            let (t, slope) = (recording.times[k], slopes.expect("slopes")[(0, 0)]);
            let exact = if t < 0.9 { -t } else { -0.1 };
            let settled = !(0.9..=1.1).contains(&t);
            assert!(!settled || (slope - exact).abs() < 1e-2, "{slope} for {exact} at {t} s, shifted by {shift} ms");
            std::ops::ControlFlow::Continue(())
        })
        .expect("a trajectory");
    }
}

fn valued<'a>(
    plan: &'a Arc<EvaluationPlan>,
    theta: &'a [f64],
    sizes: &'a [f64],
    deviations: &'a [f64],
    units: &'a [String],
) -> ParameterisedModel<'a> {
    ParameterisedModel { plan, theta, sizes, correction: CORRECTION, travel: &[0.0, 0.0], units, deviations }
}

/// A recording begins where its first samples show it, far from the model's own start as that may be: a pendulum that the
/// model lets hang and the recording finds at 2.5 rad, where its law is another.
#[test]
fn a_measured_state_begins_where_the_first_samples_show_it() {
    let text = "model M Real phi(start = 0, nominal = 1); Real w(start = 0, nominal = 1);
        equation der(phi) = w; der(w) = -9*sin(phi) - 0.1*w; end M;";
    let plan = plan(text, &[], &["phi"]);
    let elsewhere = text.replace("start = 0, nominal = 1); Real w", "start = 2.5, nominal = 1); Real w");
    let elsewhere = self::plan(&elsewhere, &[], &["phi"]);
    let mut recording = recording(200, 0.01, &[], &[&|_| 0.0]);
    let sizes = [1.0, 1.0];
    let swung = from_start(&elsewhere, &[], (&sizes, CORRECTION), &recording).expect("a trajectory").remove(0);
    recording.signals[0] = swung.clone().into();
    let units = ["rad".to_string()];
    let begun = valued(&plan, &[], &sizes, &[1e-3], &units).begin(&recording, None, None).expect("a start");
    assert!((begun.off[0] - 2.5).abs() < 1e-3, "{:?}", begun.off);
    let settled = recording.settled();
    assert!((begun.state[0] - swung[settled]).abs() < 1e-3, "{:?} for {}", begun.state, swung[settled]);
}

/// What nothing measures is not led where the model has no value: at a level of 0.04 beside the model's own 1 the linear
/// model of the outflow promises 0.2 at a level of -0.6, and the root has no value there.
#[test]
fn an_unmeasured_state_is_led_a_usual_way_at_a_time() {
    let text = "model M Real x(start = 0.2, nominal = 1); Real level(start = 1, nominal = 1);
        equation der(x) = 100*(sqrt(level) - x); der(level) = -0.01*level; end M;";
    let plan = plan(text, &[], &["x"]);
    let recording = recording(200, 0.01, &[], &[&|t: f64| 0.2 * (-0.005 * t).exp()]);
    let units = ["m/s".to_string()];
    let begun = valued(&plan, &[], &[1.0, 1.0], &[1e-3], &units).begin(&recording, None, None).expect("a start");
    let level = begun.state[1];
    assert!(level > 0.0 && (level.sqrt() - 0.2).abs() < 0.02, "{level}");
}

/// How far a level that nothing measures begins off the model's own start, where a signal follows it by a tenth and stands 0.01
/// above the model's own, and swings about that as no level makes it.
fn level_beside(swing: f64) -> f64 {
    let text = "model M Real x(start = 1, nominal = 1); Real level(start = 1, nominal = 1);
        equation der(x) = 10*(0.1*level + 0.9 - x); der(level) = 0; end M;";
    let plan = plan(text, &[], &["x"]);
    let recording = recording(200, 0.01, &[], &[&move |t: f64| 1.01 + swing * (20.0 * t).sin()]);
    let units = ["m/s".to_string()];
    let begun = valued(&plan, &[], &[1.0, 1.0], &[1e-3], &units).begin(&recording, None, None).expect("a start");
    begun.state[1] - 1.0
}

/// What nothing measures is found where the model is right; where errors are left that it cannot make up for, it stays nearer
/// to the model's own start.
#[test]
fn an_unmeasured_state_does_not_make_up_for_a_wrong_model() {
    let (right, wrong) = (level_beside(0.0), level_beside(0.1));
    assert!((right - 0.1).abs() < 0.02, "{right}");
    assert!(wrong.abs() < 0.1, "{wrong}");
}
