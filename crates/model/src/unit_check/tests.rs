//! Cases are texts: declarations `name unit` (`?` declares none, `=1e5` makes it a parameter with that value), a line
//! of
//! equations, and the warnings that are expected, each as code and message.

use super::*;
use crate::flat::{ElementOrigin, FlatEquation, FlatVariable, InstanceInfo, OriginKind, ScalarType, Variability};
use bramah_expr::Exprs;
use bramah_syntax::diag::FileId;

fn span(at: usize) -> Span {
    let at = u32::try_from(at).expect("a short text");
    Span { file: FileId(0), start: at, end: at + 1 }
}

fn origin(at: usize) -> ElementOrigin {
    ElementOrigin { span: span(at), instance: 0, kind: OriginKind::Declared }
}

fn variable(name: &str, unit: &str, at: usize, pool: &mut Exprs) -> FlatVariable {
    let value = unit.strip_prefix('=').map(|text| pool.num(text.parse().expect("a number")));
    let ty = if unit == "Integer" { ScalarType::Integer } else { ScalarType::Real };
    let declared = !matches!(unit, "?" | "Integer") && value.is_none();
    FlatVariable {
        binding: value,
        unit: declared.then(|| unit.into()),
        ..FlatVariable::plain(
            name,
            ty,
            if value.is_some() { Variability::Parameter } else { Variability::Continuous },
            origin(at),
        )
    }
}

fn model(declarations: &str, equations: &str) -> FlatModel {
    let mut model = FlatModel::default();
    model.instances.push(InstanceInfo { name: String::new(), class: "M".into(), parent: 0, span: span(0) });
    for (i, declaration) in declarations.split(", ").enumerate() {
        let (name, unit) = declaration.split_once(' ').expect("name and unit");
        let variable = variable(name, unit, i, &mut model.exprs);
        model.variables.push(variable);
    }
    for (i, equation) in equations.split("; ").enumerate() {
        let (lhs, rhs) = equation.split_once(" = ").expect("an equation");
        let (lhs, rhs) = (expression(&mut model, lhs), expression(&mut model, rhs));
        model.equations.push(FlatEquation { lhs, rhs, origin: origin(1000 + i) });
    }
    model
}

fn expression(model: &mut FlatModel, text: &str) -> ExprId {
    let FlatModel { variables, exprs, .. } = model;
    let find = |name: &str| {
        let found = variables.iter().position(|v| v.name == name);
        VarId(u32::try_from(found.unwrap_or_else(|| panic!("no {name}"))).expect("few"))
    };
    bramah_expr::from_text::read(exprs, text, &find)
}

fn warnings(declarations: &str, equations: &str) -> Vec<String> {
    let model = model(declarations, equations);
    check(&model).iter().map(|d| format!("{}: {}", d.code.id(), d.message)).collect()
}

/// Sound models, and those where a number hides what cannot be known.
const QUIET: &[(&str, &str)] = &[
    ("p Pa, F N, A m2", "p*A = F"),
    ("p Pa, x ?", "p = 1e5*x"),
    ("p Pa, x ?, F N, k ?", "p = 1e5*x; F = k*x"),
    ("w rad/s, n rev/min", "w = 2*pi*n"),
    ("w rad/s, n rev/min", "w = 2*pi/60*n"),
    ("w rad/s, n rev/min", "w = n*pi/30"),
    ("w rad/s, f Hz", "w = 2*pi*f"),
    ("n rev/s, f Hz, m 1/min, N rev/min", "n = f; m = N"),
    ("q m3/s, A m2, dp Pa, rho kg/m3, C 1", "q = C*A*sqrt(2*abs(dp)/rho)*sign(dp)"),
    ("q m3/s, A m2, dp Pa", "q = 0.6*A*sqrt(2*dp/850)"),
    ("A m2, d m, V m3", "A = pi*d^2/4; V = 4/3*pi*d^3"),
    ("F N, m kg", "F = 9.81*m"),
    ("m kg, v m/s, F N, x m", "m*der(v) = F; der(x) = v"),
    ("E J, tau N.m, phi rad", "E = tau*phi"),
    ("P W, tau N.m, w rad/s, v m/s, F N, r m", "P = tau*w; v = w*r; P = F*v"),
    ("q m3/s, D m3/rev, n rev/s", "q = D*n"),
    ("q l/min, D l, n 1/min", "q = D*n"),
    ("q l/min, D ml, n rev/min", "q = D*n/1000"),
    ("T K, t degC", "t = T - 273.15"),
    ("T K, t degC, s degC", "T = t + 273.15; T = t - s; t = s + T; t = 0.5*(t + s)"),
    ("Q W, k W/K, T K, s K", "Q = k*(T - s)"),
    ("y ?, u ?, p Pa, q Pa", "u = p; y = 2*u; q = y"),
    ("x m, y m, v m/s", "x = if v > 0 then y else 0"),
    ("x ?, T s", "T*der(x) = -x"),
    ("F N, w rad/s, k N.m, phi rad", "F = 100*sin(w*time); F = sin(w*time); F = 3*sin(phi)"),
    ("x m, v m/s, d m", "x = d*tanh(v/1e-3); x = v*time; x = time"),
    ("mu Pa.s, p Pa, a 1/Pa, m Pa.s", "mu = m*exp(a*p)"),
    ("p Pa, p0 Pa, V m3, V0 m3, n 1", "p/p0 = (V0/V)^n; p = p0*(V0/V)^1.4"),
    ("q m3/s, p Pa, eps =1e-3", "q = q*p/(abs(p) + eps); q = q*q/(abs(q) + eps)"),
    ("i Integer, L m, N Integer", "L = i*L/N"),
    ("y ?, k =2, u bar, v bar", "y = k*u; v = 3*y"),
    ("P W, p Pa, q m3/s, eta %, e 1", "P = p*q; P*e = p*q"),
    ("dp Pa, Re 1, lambda 1, L m, d m, rho kg/m3, v m/s", "dp = lambda*L/d*rho/2*v^2; lambda = 0.3164/Re^0.25"),
    ("q m3/s, k ?, dp Pa", "q = k*sqrt(dp)"),
    ("mu Pa.s, m Pa.s, p Pa, Z 1", "mu = m*exp((log(m) + 9.67)*((1 + 5.1e-9*p)^Z - 1))"),
    ("t Pa, A m2, rho kg/m3, Re 1, mu Pa.s, C 1", "t = max(pi/(8*A*rho)*(Re*mu/C)^2, 500)"),
    (
        "n Hz, w rad/s, V m3, D m3/rad, T N.m, dp Pa, b Hz",
        "n = w/(2*pi); D = V/(2*pi); T = D*dp; b = sqrt(n*n + 1e-6) - 1e-3",
    ),
    ("path ?, tau N.m, a rad/s2, one_a rad/s2, one_f N.m", "a/one_a = path - tau/one_f; tau = one_f*path"),
];

/// Mistakes: declarations, equations, warnings.
const WRONG: &[(&str, &str, &[&str])] = &[
    ("p_A Pa, F N", "p_A = F", &["W230: `p_A = F`: the left side is in Pa, the right side in N"]),
    ("w rad/s, N rev/min", "w = N", &["W231: `w = N`: the left side is in rad/s, the right side in rev/min"]),
    ("p Pa, b bar", "p = b", &["W231: `p = b`: the left side is in Pa, the right side in bar"]),
    ("p Pa, b bar", "p = 2*b", &["W231: `p = 2*b`: the left side is in Pa, the right side in 1e5 Pa"]),
    ("T K, t degC", "T = t", &["W231: `T = t`: the left side is in K, the right side in degC"]),
    ("P kW, p Pa, q m3/s", "P = p*q", &["W231: `P = p*q`: the left side is in kW, the right side in W"]),
    ("p Pa, F N, A m2", "p = F/A + F", &["W230: `F/A + F` adds Pa and N"]),
    ("p Pa, F N, x m, y m", "x = if p > F then x else y", &["W230: `p > F` compares Pa with N"]),
    (
        "x m, y m, v m/s",
        "x = if v > 0 then v else y",
        &["W230: the two values of `if v > 0 then v else y` are in m/s and m"],
    ),
    ("y 1, p Pa", "y = exp(p)", &["W230: the argument of `exp(p)` is in Pa, not a number"]),
    ("y 1, a deg", "y = sin(a)", &["W231: the argument of `sin(a)` is in deg, not a number"]),
    (
        "q m3/s, A m2, dp Pa, rho kg/m3",
        "q = A*sqrt(2*dp*rho)",
        &["W230: `q = A*sqrt(2*dp*rho)`: the left side is in m3/s, the right side in kg/s"],
    ),
    // Through intermediate variables without unit.
    ("y ?, u ?, p Pa, F N", "F = y; y = 2*u; u = p", &["W230: `u = p`: the left side is in N, the right side in Pa"]),
    ("v ?, x m, p Pa", "der(x) = v; p = v", &["W230: `p = v`: the left side is in Pa, the right side in m/s"]),
    (
        "a foo, b Pa, c N/bar/q",
        "b = b*2/2",
        &[
            "W232: `foo` in the unit `foo` is not known (variable `a`)",
            "W232: `q` in the unit `N/bar/q` is not known (variable `c`)",
        ],
    ),
];

#[test]
fn sound_models_are_quiet() {
    for (declarations, equations) in QUIET {
        assert_eq!(warnings(declarations, equations), Vec::<String>::new(), "{declarations}: {equations}");
    }
}

#[test]
fn mistakes_are_found() {
    for (declarations, equations, expected) in WRONG {
        assert_eq!(warnings(declarations, equations), *expected, "{declarations}: {equations}");
    }
}

#[test]
fn a_message_tells_where_an_inferred_unit_comes_from() {
    let model = model("v ?, x m, p Pa", "der(x) = v; p = v");
    let [found] = check(&model).try_into().expect("one warning");
    assert_eq!(found.notes, ["`v` has no unit; the equations put it in m/s", "`p` is in Pa"]);
    let labels: Vec<_> = found.labels.iter().map(|label| (label.span, label.text.as_str())).collect();
    assert_eq!(labels, [(span(1001), "Pa = m/s"), (span(1000), "the unit of `v` follows from this")]);
}

#[test]
fn a_place_is_reported_once() {
    let mut model = model("p Pa, F N, q Pa, G N", "p = F; q = G");
    model.equations[1].origin = model.equations[0].origin;
    assert_eq!(check(&model).len(), 1);
}

#[test]
fn long_chains_without_units_are_followed() {
    let n = 20_000;
    let mut model = FlatModel::default();
    model.instances.push(InstanceInfo { name: String::new(), class: "M".into(), parent: 0, span: span(0) });
    for i in 0..=n {
        let unit = if i == n { "Pa" } else { "?" };
        let variable = variable(&format!("x{i}"), unit, i, &mut model.exprs);
        model.variables.push(variable);
    }
    let vars: Vec<ExprId> = (0..).take(n + 1).map(|i| model.exprs.var(VarId(i))).collect();
    for i in 0..n {
        model.equations.push(FlatEquation { lhs: vars[i], rhs: vars[i + 1], origin: origin(i) });
    }
    let variable = variable("F", "N", n + 1, &mut model.exprs);
    model.variables.push(variable);
    let force = model.exprs.var(VarId(u32::try_from(n + 1).expect("small")));
    model.equations.push(FlatEquation { lhs: vars[0], rhs: force, origin: origin(n) });
    assert_eq!(check(&model).len(), 1);
}
