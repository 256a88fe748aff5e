//! The analysis of small models, shown as text.

mod model;
mod random;
mod validity;

use super::{Dae, StateChoice, analyze};
use crate::flat::{FlatModel, OriginKind, StateSelect, Variability};
use model::Model;

fn dae(model: &Model) -> Dae {
    let found = analyze(&model.flat, &StateChoice::default());
    match found.value {
        Some(dae) => {
            validity::check(&dae);
            dae
        }
        None => panic!("{:#?}", found.diagnostics),
    }
}

fn error(model: &Model) -> String {
    let found = analyze(&model.flat, &StateChoice::default());
    assert!(found.value.is_none(), "no error");
    let mut out = String::new();
    for d in &found.diagnostics {
        out += &format!("{}: {}\n", d.code, d.message);
        d.labels.iter().for_each(|l| out += &format!("  at: {}\n", l.text));
        d.notes.iter().for_each(|n| out += &format!("  note: {n}\n"));
        d.help.iter().for_each(|h| out += &format!("  help: {h}\n"));
    }
    out
}

#[test]
fn rc_circuit() {
    let mut m = Model::new();
    m.parameters("R = 2; C = 0.1").reals("u i v iC vR").fixed("v = 0");
    m.equations("u = sin(time); vR = u - v; vR = R*i; C*der(v) = iC; iC = i");
    insta::assert_snapshot!(dae(&m).dae_text());
}

#[test]
fn pendulum() {
    let mut m = Model::new();
    m.parameters("l = 1; g = 9.81").reals("x y vx vy F").guess("x = 1; vx = 0").fixed("y = 0; vy = -7");
    m.equations("vx = der(x); vy = der(y); der(vx) = -F*x; der(vy) = -F*y - g; x^2 + y^2 = l^2");
    let found = dae(&m);
    insta::assert_snapshot!(found.dae_text());
    assert_eq!(found.selections.len(), 1);
    let selection = &found.selections[0];
    assert_eq!(selection.candidates, [m.id("vx"), m.id("vy")]);
    assert_eq!(selection.dummies, [m.id("vx")]);
    let other = analyze(&m.flat, &StateChoice { preferred: vec![m.id("vx")] }).value.expect("works too");
    assert_eq!(other.states, [m.id("x"), m.id("vx")]);
}

#[test]
fn geared_inertias() {
    let mut m = Model::new();
    m.parameters("J1 = 0.2; J2 = 3; ratio = 4").reals("phi1 w1 phi2 w2 t1 t2");
    m.fixed("phi2 = 0; w2 = 2");
    m.equations("w1 = der(phi1); w2 = der(phi2); J1*der(w1) = 1.5 + t1; J2*der(w2) = t2; phi1 = ratio*phi2");
    m.equations("ratio*t1 + t2 = 0");
    insta::assert_snapshot!(dae(&m).dae_text());
}

#[test]
fn second_derivatives_without_names() {
    let mut m = Model::new();
    m.reals("us i1 i2 il vl v1");
    m.equations("us = 3*sin(2*time) + 1; v1 = us; i1 = 0.5*der(v1); il = i1 + i2; i2 = 0.2*der(us); vl = 0.4*der(il)");
    insta::assert_snapshot!(dae(&m).blt_text());
}

#[test]
fn loops_are_torn() {
    let mut m = Model::new();
    m.reals("a b c d").guess("d = 1");
    m.equations("2*a + b = 1; b + 3*c = time; c - a = 0.5*b; d^3 + d = a");
    insta::assert_snapshot!(dae(&m).blt_text());
}

#[test]
fn friction_automaton() {
    let mut m = Model::new();
    m.parameters("Fs = 3; Fc = 2; m = 1; k = 10; vb = 0.25").reals("vr ar f sigma x v");
    m.booleans("startForward startBackward locked").integers("mode slips");
    m.fixed("startForward = false; startBackward = false; mode = 3; x = 0; v = vb; slips = 0");
    m.equations(
        "startForward = pre(mode) == 0 and (sigma > Fs or pre(startForward) and sigma > Fc)
           or pre(mode) == -1 and vr > 1e-10 or initial() and vr > 0;
         startBackward = pre(mode) == 0 and (sigma < -Fs or pre(startBackward) and sigma < -Fc)
           or pre(mode) == 1 and vr < -1e-10 or initial() and vr < 0;
         locked = not (pre(mode) == 1 or startForward or pre(mode) == -1 or startBackward);
         ar = if locked then 0 else if startForward then sigma - Fc else if startBackward then sigma + Fc
           else if pre(mode) == 1 then sigma - Fc else sigma + Fc;
         f = if locked then sigma else if startForward then Fc else if startBackward then -Fc
           else if pre(mode) == 1 then Fc else -Fc;
         mode = if (pre(mode) == 1 or startForward) and vr > 0 then 1
           else if (pre(mode) == -1 or startBackward) and vr < 0 then -1 else 0;
         der(x) = v; vr = v - vb; ar = der(v); m*der(v) = -k*x - f",
    );
    m.when(&[("startBackward", "slips = pre(slips) + 1")]);
    insta::assert_snapshot!(dae(&m).dae_text());
}

#[test]
fn whens_and_samples() {
    let mut m = Model::new();
    m.reals("x").discretes("a b").integers("n c").fixed("x = 2; a = 1; n = 5; c = 7");
    m.equations("der(x) = -x");
    m.when(&[("sample(0.4, 0.4)", "n = pre(n) + 2")]);
    m.when(&[("initial()", "a = 5")]);
    m.when(&[("time > 1 | time >= 1.2", "c = pre(c) + 1"), ("x < 0.5", "b = x; c = 0; reinit x = 3")]);
    m.initial("b = 2.5");
    let found = dae(&m);
    let actions: Vec<String> = found.actions.iter().map(|a| found.text(a.fires)).collect();
    insta::assert_snapshot!(format!("{}actions: {}\n", found.dae_text(), actions.join("; ")));
}

#[test]
fn pre_in_initial_equations() {
    let mut m = Model::new();
    m.integers("n m").fixed("n = 5");
    m.when(&[("sample(0.4, 0.4)", "n = pre(n) + 2; m = pre(m) - 1")]);
    m.initial("pre(m) = 2*pre(n) - 1");
    let found = dae(&m);
    insta::assert_snapshot!(found.blocks_text(&found.initial), @r"
    n := pre(n)
    m := pre(m)
    ");
    let start = found.variables[m.id("m").index()].start.expect("given by the initial equation");
    assert_eq!(found.text(start), "9");
}

#[test]
fn time_events_are_recognised() {
    use super::CrossingKind::Time;
    let mut m = Model::new();
    m.parameters("T = 2").reals("y z");
    m.equations("y = if 2*time - 1 > T then 1 else 0; z = if T > time then 1 else floor(y + time)");
    let found = dae(&m);
    let kinds: Vec<bool> = found.crossings.iter().map(|c| matches!(c.kind, Time(..))).collect();
    assert_eq!(kinds, [true, true, false]);
    insta::assert_snapshot!(found.blocks_text(&found.event));
}

#[test]
fn free_parameters_and_their_dependents() {
    let mut m = Model::new();
    m.parameters("k = 0; k2 = 2*k; g = 3").reals("x");
    let k = m.id("k");
    m.flat.variables[k.index()].fixed = false;
    m.flat.variables[k.index()].binding = None;
    m.equations("der(x) = k2 - g*x").initial("x = 3; der(x) = 0");
    let found = dae(&m);
    assert_eq!(found.free_parameters, [m.id("k"), m.id("k2")]);
    assert_eq!(found.parameters, [m.id("g")]);
    insta::assert_snapshot!(found.blocks_text(&found.initial));
}

#[test]
fn state_select_decides() {
    let mut m = Model::new();
    m.reals("x y s d z p").fixed("s = 3; d = 1");
    m.select("x p", StateSelect::Avoid).select("y", StateSelect::Never);
    m.select("s", StateSelect::Always).select("d", StateSelect::Prefer);
    m.equations("der(x) = -x + 0.5*y + 1; der(y) = 0.3*x - 2*y; s = x + y; d = x - y; z = 2*x; p = 3*y");
    let found = dae(&m);
    assert_eq!(found.states, [m.id("x"), m.id("s")]);
    insta::assert_snapshot!(found.dae_text());
}

#[test]
fn redundant_fixed_starts_become_checks() {
    let mut m = Model::new();
    m.reals("w1 w2 t").fixed("w1 = 1; w2 = 2");
    m.equations("der(w1) = 3 - t; 0.5*der(w2) = t; w2 = 2*w1");
    let found = dae(&m);
    assert_eq!(found.initial_checks.len(), 1);
    assert_eq!(found.text(found.initial_checks[0].0), "w1 - 1");
}

#[test]
fn contradicting_starts() {
    let mut m = Model::new();
    m.reals("x y").fixed("x = 1; y = 3").equations("der(x) = -x; y = 2*x");
    m.initial("der(x) = 0");
    insta::assert_snapshot!(error(&m));
    let mut m = Model::new();
    m.reals("x y").fixed("x = 1; y = 3").equations("der(x) = -x; y = x");
    insta::assert_snapshot!(error(&m), @r"
    E401: `x` and `y` are equal but start at different values
      at: `x` starts at 1, fixed
      at: `y` starts at 3, fixed
      help: fix the start of one of them only, as by `x(fixed = false)`, or give both the same value
    ");
}

#[test]
fn circles_of_parameters() {
    let mut m = Model::new();
    m.parameters("a = b + 1; b = c; c = 2*a; d = 1").reals("x").equations("x = a");
    insta::assert_snapshot!(error(&m));
}

#[test]
fn derivatives_of_inputs() {
    let mut m = Model::new();
    m.inputs("u").reals("x i").equations("x = 2*u; i = 3*der(x)");
    insta::assert_snapshot!(error(&m));
}

/// A pump and a resistance in a closed loop without a tank.
#[test]
fn no_reference_pressure() {
    let mut m = Model::new();
    for name in ["pump", "load"] {
        m.instance(name, "Part").instance(&format!("{name}.a"), "Port").instance(&format!("{name}.b"), "Port");
        m.reals(&format!("{name}.a.p {name}.b.p")).flows(&format!("{name}.a.q {name}.b.q"));
        m.equations_of(name, OriginKind::Declared, &format!("{name}.a.q + {name}.b.q = 0"));
    }
    m.equations_of("pump", OriginKind::Declared, "pump.b.q = -1e-3");
    m.equations_of("load", OriginKind::Declared, "load.a.q = 2*(load.a.p - load.b.p)");
    m.equations_of("", OriginKind::ConnectPotential, "pump.b.p = load.a.p; load.b.p = pump.a.p");
    m.equations_of("", OriginKind::ConnectFlow, "pump.b.q + load.a.q = 0; load.b.q + pump.a.q = 0");
    let names: Vec<usize> = (0..m.flat.variables.len()).filter(|&i| !m.flat.variables[i].flow).collect();
    for i in names {
        m.flat.variables[i].unit = Some("Pa".into());
    }
    insta::assert_snapshot!(error(&m));
}

/// Two resistors in parallel at a source, all floating: every equation could be matched.
#[test]
fn floating_circuit() {
    let mut m = Model::new();
    for name in ["u", "r1", "r2"] {
        m.instance(name, "Part").instance(&format!("{name}.p"), "Pin").instance(&format!("{name}.n"), "Pin");
        m.reals(&format!("{name}.p.v {name}.n.v")).flows(&format!("{name}.p.i {name}.n.i"));
        m.equations_of(name, OriginKind::Declared, &format!("{name}.p.i + {name}.n.i = 0"));
    }
    m.equations("u.p.v - u.n.v = 5; r1.p.v - r1.n.v = 2*r1.p.i; r2.p.v - r2.n.v = 3*r2.p.i");
    m.equations_of("", OriginKind::ConnectPotential, "u.p.v = r1.p.v; u.p.v = r2.p.v; u.n.v = r1.n.v; u.n.v = r2.n.v");
    m.equations_of("", OriginKind::ConnectFlow, "u.p.i + r1.p.i + r2.p.i = 0; u.n.i + r1.n.i + r2.n.i = 0");
    insta::assert_snapshot!(error(&m));
}

/// Two tanks at one node.
#[test]
fn two_ideal_sources() {
    let mut m = Model::new();
    for name in ["tank1", "tank2"] {
        m.instance(name, "Tank").instance(&format!("{name}.a"), "Port");
        m.reals(&format!("{name}.a.p")).flows(&format!("{name}.a.q"));
        m.equations_of(name, OriginKind::Declared, &format!("{name}.a.p = 1e5"));
    }
    m.equations_of("", OriginKind::ConnectPotential, "tank1.a.p = tank2.a.p");
    m.equations_of("", OriginKind::ConnectFlow, "tank1.a.q + tank2.a.q = 0");
    insta::assert_snapshot!(error(&m));
}

#[test]
fn parameters_taken_for_unknowns() {
    let mut m = Model::new();
    m.parameters("k = 2").reals("x y").equations("x = 1; k = 3");
    insta::assert_snapshot!(error(&m));
}

#[test]
fn derivatives_of_inputs_in_equations() {
    let mut m = Model::new();
    m.inputs("u").reals("i").equations("i = 3*der(u)");
    insta::assert_snapshot!(error(&m));
}

#[test]
fn reinit_needs_a_state() {
    let mut m = Model::new();
    m.reals("x y").fixed("x = 1").equations("der(x) = -x; y = 2*x");
    m.when(&[("x < 0.5", "reinit y = 3")]);
    insta::assert_snapshot!(error(&m));
}

#[test]
fn samples_are_shared_with_the_variables_that_name_them() {
    let mut m = Model::new();
    m.booleans("s1 s2").integers("n").fixed("n = 0");
    m.equations("s1 = sample(1, 10); s2 = s1");
    m.when(&[("s2", "n = pre(n) + 1")]);
    let found = dae(&m);
    assert_eq!(found.samples.len(), 1);
    assert_eq!(found.aliases.len(), 2);
    assert_eq!(found.discrete, [m.id("n")]);
}

#[test]
fn signs_of_aliases() {
    let mut m = Model::new();
    m.reals("a b c d x").fixed("d = 2");
    m.equations("a = -b; b + c = 0; 0 = c - d; der(a) = x; x = sin(time)");
    let found = dae(&m);
    insta::assert_snapshot!(found.blt_text());
}

/// The equation that names a derivative is gone when the choice is made.
#[test]
fn a_state_keeps_its_name_though_another_differentiates_its_alias() {
    let mut m = Model::new();
    m.reals("s v t w");
    m.equations("v = der(s); der(v) = -s; t = s; w = 2*der(t)");
    assert_eq!(dae(&m).states, [m.id("s"), m.id("v")]);
}

/// Rigid joints in a row, with speeds: everything moves with one state pair.
#[test]
fn rigid_chain() {
    let mut m = Model::new();
    let n = 5;
    for i in 1..=n {
        m.reals(&format!("s{i} v{i} f{i}"));
        m.equations(&format!("v{i} = der(s{i})"));
    }
    for i in 1..n {
        m.equations(&format!("s{} = s{i} + 0.1*{i}; {i}*der(v{i}) = f{i} - f{}", i + 1, i + 1));
    }
    m.equations(&format!("3*der(v{n}) = f{n}; f1 = sin(time)"));
    m.fixed("s3 = 0; v3 = 0");
    let found = dae(&m);
    assert_eq!(found.states, [m.id("s3"), m.id("v3")]);
    assert!(found.chosen_starts.is_empty());
}

#[test]
fn two_speeds_of_one_position_are_one() {
    let mut m = Model::new();
    m.reals("s v1 v2 a1 a2").fixed("s = 0; v2 = 1");
    m.equations("v1 = der(s); a1 = der(v1); a2 = der(v2); v2 = der(s); a1 = -s; a2 = a1 + 0*v1");
    insta::assert_snapshot!(error(&m));
}

/// `R*i = v1 - v2` between two capacities: with `R = 0` one of them is no state, and `R` and what it comes from are
/// fixed;
/// another parameter of value 0 stays free.
#[test]
fn a_parameter_of_value_0_is_fixed_where_the_structure_hangs_on_it() {
    let text = "model M
          parameter Real R0 = 0, R = 2*R0, G = 0;
          Real v1(start = 1, fixed = true), v2, i;
        equation
          der(v1) = -i - G*v1;
          der(v2) = i;
          R*i = v1 - v2;
        end M;";
    let flat = crate::compile::flatten_text(text, None).value.expect("sound").flat;
    let dae = crate::compile::analyze(&flat).value.expect("sound");
    assert_eq!(dae.states.len(), 1);
    let variability = |name: &str| dae.variables.iter().find(|v| v.name == name).expect("declared").variability;
    assert_eq!(
        ["R0", "R", "G"].map(variability),
        [Variability::Constant, Variability::Constant, Variability::Parameter]
    );
    let varied = crate::compile::analyze(&FlatModel { varied: true, ..flat }).value.expect("sound");
    assert_eq!(varied.states.len(), 2);
}

/// A factor whose 0 shows only once aliases are gone: it decides about the structure again and again, and is looked at
/// once.
#[test]
fn a_product_that_stays_does_not_go_round_for_ever() {
    let text = "model M
          parameter Real p = 0;
          Real x(start = 1, fixed = true), w, i, c, d;
        equation
          d = p;
          0 = c - d;
          der(x) = -i;
          c*i = x - w;
          der(w) = i;
        end M;";
    let flat = crate::compile::flatten_text(text, None).value.expect("sound").flat;
    assert!(crate::compile::analyze(&flat).value.is_some());
}
