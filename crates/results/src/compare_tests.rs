use super::super::trajectory::Signal;
use super::*;

fn curve(n: u32, f: impl Fn(f64) -> f64) -> Trajectory {
    let mut t = Trajectory::new(vec![Signal::new("x").unit("m")]);
    for i in 0..=n {
        let time = f64::from(i) / f64::from(n);
        t.push(time, &[f(time)]);
    }
    t
}

fn one(a: &Trajectory, b: &Trajectory, tolerance: TubeTolerance) -> SignalComparison {
    compare(a, b, &[(0, 0)], tolerance).signals.remove(0)
}

#[test]
fn equal_curves_on_other_grids() {
    let (a, b) = (curve(100, |t| t), curve(37, |t| t));
    let c = one(&a, &b, TubeTolerance { relative: 0.0, absolute: 1e-12, time: Some(0.0) });
    assert!(c.within, "{c:?}");
    assert!(c.rmse.unwrap() < 1e-15);
}

#[test]
fn an_offset_is_measured_and_violates() {
    let (a, b) = (curve(100, |t| 2.0 + t), curve(100, |t| 2.1 + t));
    let c = one(&a, &b, TubeTolerance::default());
    approx::assert_relative_eq!(c.rmse.unwrap(), 0.1, epsilon = 1e-12);
    approx::assert_relative_eq!(c.normalised.unwrap(), 0.1 / 6.3383_f64.sqrt(), epsilon = 1e-3);
    assert_eq!((c.violations, c.points, c.first_violation), (101, 101, Some(0.0)));
    assert!(!c.within);
    assert!(one(&a, &b, TubeTolerance { relative: 0.0, absolute: 0.11, time: None }).within);
}

#[test]
fn a_late_step_is_within_the_width_in_time_only() {
    let step = |at: f64| move |t: f64| if t < at { 0.0 } else { 1.0 };
    let (a, b) = (curve(1000, step(0.5)), curve(1000, step(0.51)));
    let tolerance = |time| TubeTolerance { relative: 0.002, absolute: 0.0, time: Some(time) };
    assert!(one(&a, &b, tolerance(0.011)).within);
    let c = one(&a, &b, tolerance(0.005));
    assert!(!c.within);
    approx::assert_abs_diff_eq!(c.delay.unwrap(), 0.01, epsilon = 1e-3);
}

#[test]
fn a_result_that_ends_early_fails() {
    let (a, mut b) = (curve(100, |t| t), curve(100, |t| t));
    b.times.truncate(60);
    b.columns[0].truncate(60);
    let c = one(&a, &b, TubeTolerance::default());
    assert_eq!(c.reason.as_deref(), Some("the result ends at 0.59 s, the reference at 1 s"));
    assert!(!c.within);
}

#[test]
fn empty_cells_are_left_out() {
    let (mut a, b) = (curve(10, |t| t), curve(10, |t| t));
    a.columns[0][3] = f64::NAN;
    let c = one(&a, &b, TubeTolerance::default());
    assert!(c.within && c.maximum == Some(0.0));
}

#[test]
fn literals_are_matched_by_name() {
    let kind = |words: [&str; 2]| Kind::Enumeration(words.map(str::to_owned).to_vec());
    let mut a = Trajectory::new(vec![Signal { kind: kind(["off", "on"]), ..Signal::new("m") }]);
    let mut b = Trajectory::new(vec![Signal { kind: kind(["on", "off"]), ..Signal::new("m") }]);
    a.push(0.0, &[1.0]);
    a.push(1.0, &[2.0]);
    b.push(0.0, &[2.0]);
    b.push(1.0, &[1.0]);
    let exact = TubeTolerance { relative: 0.0, absolute: 0.0, time: Some(0.0) };
    assert!(one(&a, &b, exact).within);
    b.columns[0][1] = 2.0;
    assert!(!one(&a, &b, exact).within);
}

#[test]
fn rows_at_events_are_compared_side_by_side() {
    let mut a = Trajectory::new(vec![Signal::new("x")]);
    for (t, v) in [(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (1.0, 1.0)] {
        a.push(t, &[v]);
    }
    let c = one(&a, &a.clone(), TubeTolerance { relative: 0.0, absolute: 0.0, time: Some(0.0) });
    assert_eq!((c.maximum, c.violations), (Some(0.0), 0));
}
