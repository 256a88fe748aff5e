use super::*;
use crate::lift;
use bramah_model::flat::FlatModel;

fn id(flat: &FlatModel, name: &str) -> VarId {
    let i = flat.variables.iter().position(|v| v.name == name).expect("the model has it");
    VarId(u32::try_from(i).expect("small"))
}

fn local(text: &str, parameters: &[&str], outputs: &[&str], u: &[f64]) -> LocalEvaluator {
    let flat = bramah_model::compile::flatten_text(text, None).value.expect("sound").flat;
    let ids = |names: &[&str]| names.iter().map(|n| id(&flat, n)).collect::<Vec<_>>();
    let lifted = lift(&flat, &ids(parameters), &ids(outputs));
    let plan = Arc::new(EvaluationPlan::new(&lifted).expect("can be sorted"));
    let theta = plan.parameter_values();
    LocalEvaluator::start(plan, 0.0, &theta, u).expect("starts")
}

/// Derivatives against central differences of the values.
fn check(local: &mut LocalEvaluator, x: &[f64], theta: &[f64], u: &[f64]) {
    local.linearize(0.3, x, theta, u).expect("has derivatives");
    let linear = local.linear.clone();
    let all: Vec<f64> = x.iter().chain(theta).chain(u).copied().collect();
    for (j, &value) in all.iter().enumerate() {
        let h = 1e-6 * value.abs().max(1e-3);
        let mut at = |sign: f64| {
            let mut moved = all.clone();
            moved[j] += sign * h;
            let (x, rest) = moved.split_at(x.len());
            let (theta, u) = rest.split_at(theta.len());
            local.evaluate(0.3, x, theta, u).expect("has values");
            local.rates.iter().chain(&local.outputs).copied().collect::<Vec<f64>>()
        };
        let (plus, minus) = (at(1.0), at(-1.0));
        let n = x.len();
        for i in 0..plus.len() {
            let exact = match (i < n, j < n) {
                (true, true) => linear.a[(i, j)],
                (true, false) => linear.b[(i, j - n)],
                (false, true) => linear.c[(i - n, j)],
                (false, false) => linear.d[(i - n, j - n)],
            };
            let found = (plus[i] - minus[i]) / (2.0 * h);
            assert!((found - exact).abs() <= 1e-5 * exact.abs().max(1e-2), "{i} {j}: {found} {exact}");
        }
    }
}

#[test]
fn explicit_models() {
    let text = "model M
        parameter Real k = 3; parameter Real c = 2*k; parameter Real m = 1.5;
        input Real u; Real x(start = 0.2, fixed = true), v(start = 0.1, fixed = true), f;
      equation
        der(x) = v; m*der(v) = u - f; f = c*x + k*x^3 + 0.1*v*abs(v);
      end M;";
    let mut local = local(text, &["k", "m"], &["f", "x"], &[0.7]);
    assert_eq!(local.state(), [0.2, 0.1]);
    assert_eq!(local.plan().implicit(), 0, "a raised mass keeps its sign: one may divide by it");
    check(&mut local, &[0.3, -0.4], &[3.0, 1.5], &[0.7]);
}

#[test]
fn algebraic_loops_and_index_reduction() {
    // two masses with a rigid rod (index 3), and a pressure that follows from a nonlinear loop
    let text = "model M
        parameter Real r = 2, G = 0.3, K = 0.2;
        input Real u; Real a(start = 0.3, fixed = true, stateSelect = StateSelect.always), b;
        Real va(start = 0.2, fixed = true, stateSelect = StateSelect.always), vb, f;
        Real p(start = 1), q;
      equation
        b = r*a; der(a) = va; der(b) = vb;
        der(va) = u - r*f; 3*der(vb) = f - q;
        q = G*p + K*p^3; q = vb - 0.1*p;
      end M;";
    let mut local = local(text, &["r", "G"], &["p", "f"], &[0.5]);
    assert_eq!(local.plan().states(), 2);
    check(&mut local, &[0.4, 0.9], &[2.0, 0.3], &[0.5]);
}

#[test]
fn coefficients_of_known_sign_leave_nothing_implicit() {
    // the modulus of oil with air is positive by its form: a softplus, a floor, powers, and a wall that is rigid
    let text = "model M
        parameter Real V = 1e-3, beta_0 = 1.5e9, wall = Modelica.Constants.inf;
        input Real q; Real p(start = 5e5, fixed = true), p_s, beta, V_p;
      equation
        p_s = max(p, 0) + 5e3*(log(1 + exp(-abs(p)/5e3)) + 1e-6);
        beta = max(1 + 10*(p_s - 1e5)/beta_0, 1e-3)^(-0.1)*beta_0;
        V_p = V*(1 + (p - 1e5)/wall);
        (V_p/beta + V/wall)*der(p) = q;
      end M;";
    let mut local = local(text, &["V", "beta_0"], &["p"], &[1e-5]);
    assert_eq!(local.plan().implicit(), 0);
    assert_eq!(local.plan().implicit_names(), Vec::<String>::new());
    local.linearize(0.0, &[5e5], &[1e-3, 1.5e9], &[1e-5]).expect("has derivatives");
    assert!(local.linear.a[(0, 0)].is_finite() && local.rates[0] > 0.0);
}

#[test]
fn rates_do_not_remember_where_the_model_was_before() {
    let text = "model M
        parameter Real k = 3; input Real u; Real x(start = 0.2, fixed = true), y;
      equation
        der(x) = u - k*x^3; y = k*x^2;
      end M;";
    let mut local = local(text, &["k"], &["y"], &[0.7]);
    let at = |local: &mut LocalEvaluator, x: f64| {
        local.evaluate(0.0, &[x], &[3.0], &[0.7]).expect("has values");
        (local.rates[0], local.outputs[0])
    };
    let before = at(&mut local, 0.1);
    at(&mut local, 1e8);
    assert_eq!(at(&mut local, 0.1), before);
}

/// A damper written with the derivative of a port's position reads the rate of a state.
#[test]
fn rates_that_read_other_rates() {
    let text = "model M
        parameter Real d = 3, m = 2;
        input Real u; Real s(start = 0.2, fixed = true), v(start = 0.1, fixed = true), f, P;
      equation
        v = der(s); f = d*der(s) + 5*s; m*der(v) = u - f; P = f*der(s);
      end M;";
    let mut local = local(text, &["d", "m"], &["f", "P"], &[0.7]);
    check(&mut local, &[0.3, -0.4], &[3.0, 2.0], &[0.7]);
    local.evaluate(0.0, &[0.0, 1.0], &[3.0, 2.0], &[0.0]).expect("has values");
    assert_eq!(local.rates, [1.0, -1.5]);
    local.linearize(0.0, &[0.0, 0.0], &[3.0, 2.0], &[0.0]).expect("has derivatives");
    assert!((local.linear.a[(1, 1)] + 1.5).abs() < 1e-12, "{}", local.linear.a);
}
