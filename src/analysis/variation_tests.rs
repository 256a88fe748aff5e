use super::*;
use crate::results::Trajectory;
use crate::solve::{Control, Settings, signals, simulate};

fn id(flat: &FlatModel, name: &str) -> VarId {
    let i = flat.variables.iter().position(|v| v.name == name).expect("the model has it");
    VarId(u32::try_from(i).expect("small"))
}

fn flat(text: &str) -> FlatModel {
    crate::flatten_text(text, None).value.expect("sound").flat
}

/// Value and companions of one variable at the end of a run.
fn end(flat: &FlatModel, variation: &Variation, variable: &str, directions: usize, stop: f64) -> Vec<f64> {
    let v = id(flat, variable);
    let wanted: Vec<VarId> =
        std::iter::once(v).chain((0..directions).map(|k| variation.companion(v, k).expect("moves"))).collect();
    let settings =
        Settings { stop_time: stop, interval: stop, tolerance: 1e-10, wanted: wanted.clone(), ..Settings::default() };
    let mut rows = Trajectory::new(signals(&variation.system.dae, &wanted));
    let run = simulate(&variation.system, &settings, &[], None, &mut rows, &mut Control::default());
    assert!(run.end.is_success(), "{:?}", run.diagnostics);
    rows.columns.iter().map(|c| c[c.len() - 1]).collect()
}

#[test]
fn a_decay_by_its_rate_by_its_start_and_by_what_its_rate_follows() {
    let flat = flat(
        "model M parameter Real a = 1, k = 2*a, x0 = 3; Real x(start = x0, fixed = true), y;
         equation der(x) = -k*x; y = x^2; end M;",
    );
    let moved = [(id(&flat, "a"), 1.0), (id(&flat, "k"), 1.0), (id(&flat, "x0"), 3.0)];
    let x = 3.0 * (-2.0f64).exp();
    let all = Variation::new(&flat, &moved, &[], 0).expect("can be differentiated");
    assert!(all.rates.is_empty());
    for (found, exact) in end(&flat, &all, "x", 3, 1.0).into_iter().zip([x, -2.0 * x, -x, x]) {
        assert!((found - exact).abs() < 1e-8, "{found} {exact}");
    }
    for (found, exact) in
        end(&flat, &all, "y", 3, 1.0).into_iter().zip([x * x, -4.0 * x * x, -2.0 * x * x, 2.0 * x * x])
    {
        assert!((found - exact).abs() < 1e-7, "{found} {exact}");
    }
    let apart = Variation::new(&flat, &moved, &[id(&flat, "k")], 0).expect("can be differentiated");
    assert_eq!(end(&flat, &apart, "x", 1, 1.0)[1], 0.0);
}

#[test]
fn what_the_equations_do_not_tell_is_refused() {
    let said = |text: &str| {
        let flat = flat(text);
        let p = id(&flat, "p");
        Variation::new(&flat, &[(p, 1.0)], &[], 0).err().unwrap_or_default()
    };
    let ball = "model M parameter Real p = 1; Real x(start = 1, fixed = true), v(start = 0, fixed = true);
        equation der(x) = v; der(v) = -p; when x < 0 then reinit(v, -pre(v)); end when; end M;";
    assert_eq!(said(ball), "states are set anew at events");
    let sampled = "model M parameter Real p = 1; discrete Real u(start = 0); Real x(start = 1, fixed = true);
        equation der(x) = u - x; when sample(0, 0.1) then u = p*x; end when; end M;";
    assert_eq!(said(sampled), "sampled values depend on what moves");
}

/// A rate that jumps when the state passes a moved threshold ends the run; one that bends does not.
#[test]
fn jumps_are_seen() {
    let jumped = |law: &str| {
        let flat = flat(&format!(
            "model M parameter Real p = 1; Real x(start = 0, fixed = true); equation der(x) = {law}; end M;"
        ));
        let variation = Variation::new(&flat, &[(id(&flat, "p"), 1.0)], &[], 0).expect("can be differentiated");
        let wanted = variation.rates.clone();
        assert_eq!(wanted.len(), 1);
        let settings = Settings { stop_time: 3.0, interval: 0.1, wanted, ..Settings::default() };
        let mut rows = Trajectory::new(Vec::new());
        let mut watch = Watch::new(&mut rows, 1, &[]);
        simulate(&variation.system, &settings, &[], None, &mut watch, &mut Control::default());
        watch.jumped
    };
    assert_eq!(jumped("if x < p then 1 else 1 - (x - p)"), None);
    let at = jumped("if x < p then 1 else 3").expect("a jump");
    assert!((at - 1.0).abs() < 1e-4, "{at}");
}
