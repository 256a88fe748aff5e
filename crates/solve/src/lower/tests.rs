//! Lowering of hand-made DAEs, checked against the reference evaluation of expressions and finite differences.

use super::*;
use approx::assert_relative_eq;
use bramah_expr::{Exprs, RelationalOp, UnaryFunction};
use bramah_model::flat::{self, ElementOrigin, OriginKind, ScalarType, Variability};
use bramah_model::structure::{
    AlgebraicLoop, Alias, BltBlock, CrossingKind, ExplicitAssignment, MixedLoop, ZeroCrossing,
};
use bramah_syntax::diag::{FileId, Span};

pub const ORIGIN: ElementOrigin =
    ElementOrigin { span: Span { file: FileId(0), start: 0, end: 0 }, instance: 0, kind: OriginKind::Declared };

/// A DAE under construction.
#[derive(Default)]
pub struct Model {
    pub dae: Dae,
}

impl Model {
    pub fn variable(&mut self, name: &str, variability: Variability) -> VarId {
        let v = VarId(u32::try_from(self.dae.variables.len()).unwrap());
        self.dae.variables.push(flat::FlatVariable::plain(name, ScalarType::Real, variability, ORIGIN));
        v
    }

    pub fn continuous(&mut self, name: &str) -> (VarId, ExprId) {
        let v = self.variable(name, Variability::Continuous);
        (v, self.dae.exprs.var(v))
    }

    pub fn state(&mut self, name: &str) -> (VarId, ExprId) {
        let (v, e) = self.continuous(name);
        self.dae.states.push(v);
        (v, e)
    }

    pub fn parameter(&mut self, name: &str, binding: ExprId) -> ExprId {
        let v = self.variable(name, Variability::Parameter);
        self.dae.variables[v.index()].binding = Some(binding);
        self.dae.parameters.push(v);
        self.dae.exprs.var(v)
    }

    pub fn number(&mut self, value: f64) -> ExprId {
        self.dae.exprs.num(value)
    }

    pub fn assign(&mut self, unknown: Unknown, value: ExprId) -> ExplicitAssignment {
        ExplicitAssignment { unknown, value, equation: 0 }
    }

    /// An explicit equation of the continuous and the event system.
    pub fn explicit(&mut self, unknown: Unknown, value: ExprId) {
        let block = BltBlock::Assign(self.assign(unknown, value));
        self.dae.continuous.push(block.clone());
        self.dae.event.push(block);
    }

    pub fn lower(self, native: bool) -> ExecutableSystem {
        let mut system = lower(Arc::new(self.dae), &LoweringOptions { native, ..LoweringOptions::default() });
        system.hurry();
        system
    }
}

/// What both ways of running give for one point.
#[derive(Debug)]
pub struct Point {
    pub residual: Vec<f64>,
    pub jacobian: Vec<f64>,
}

/// Residual and Jacobian at `(t, y, yp)`.
pub fn point(system: &ExecutableSystem, values: &mut [f64], y: &[f64], yp: &[f64], cj: f64) -> Point {
    let mut residual = vec![0.0; y.len()];
    let mut jacobian = vec![0.0; system.pattern.nnz()];
    let _ = system.residual(0.3, y, yp, values, &mut residual);
    let _ = system.jacobian(0.3, cj, y, yp, values, &mut jacobian);
    Point { residual, jacobian }
}

/// Compares the Jacobian with central differences of the residual.
pub fn check_jacobian(system: &ExecutableSystem, values: &mut [f64], y: &[f64], yp: &[f64], cj: f64) {
    let n = y.len();
    let exact = point(system, values, y, yp, cj).jacobian;
    let mut dense = vec![vec![0.0; n]; n];
    for (j, column) in dense.iter_mut().enumerate() {
        for k in system.pattern.colptr[j]..system.pattern.colptr[j + 1] {
            column[system.pattern.rowidx[k]] = exact[k];
        }
    }
    for j in 0..n {
        let h = 1e-6 * y[j].abs().max(1.0);
        let shifted = |sign: f64, values: &mut [f64]| {
            let (mut y, mut yp) = (y.to_vec(), yp.to_vec());
            y[j] += sign * h;
            yp[j] += sign * h * cj;
            point(system, values, &y, &yp, cj).residual
        };
        let (up, down) = (shifted(1.0, values), shifted(-1.0, values));
        for i in 0..n {
            let difference = (up[i] - down[i]) / (2.0 * h);
            assert_relative_eq!(dense[j][i], difference, epsilon = 1e-5, max_relative = 1e-4);
        }
    }
}

pub fn values_of(system: &ExecutableSystem) -> Vec<f64> {
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    values
}

/// N volumes in a row with orifices between them: `der(p[i]) = (q[i-1] - q[i])*p[i]/V`, `q[i] = G*(dp)/sqrt(dp^2+1)`.
pub fn line(n: usize) -> Model {
    let mut m = Model::default();
    let (half, one) = (m.number(0.5), m.number(1.0));
    let states: Vec<_> = (0..n).map(|i| m.state(&format!("v[{}].p", i + 1))).collect();
    let mut before = m.dae.exprs.time();
    for i in 0..n {
        let volume = m.parameter(&format!("v[{}].V", i + 1), half);
        let conductance = m.parameter(&format!("o[{}].G", i + 1), one);
        let (drop, dp) = m.continuous(&format!("o[{}].dp", i + 1));
        let (flow, q) = m.continuous(&format!("o[{}].q", i + 1));
        let next = states.get(i + 1).map_or(one, |s| s.1);
        let e = &mut m.dae.exprs;
        let difference = e.sub(states[i].1, next);
        let square = e.square(dp);
        let sum = e.add(square, one);
        let root = e.sqrt(sum);
        let fixed = e.mul(conductance, half);
        let fixed = e.sqrt(fixed);
        let ratio = e.div(dp, root);
        let value = e.mul(fixed, ratio);
        let net = e.sub(before, q);
        let scaled = e.mul(net, states[i].1);
        let rate = e.div(scaled, volume);
        m.explicit(Unknown::Var(drop), difference);
        m.explicit(Unknown::Var(flow), value);
        m.explicit(Unknown::Der(states[i].0), rate);
        before = q;
    }
    m
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| if v.is_nan() { 1 } else { v.to_bits() }).collect()
}

#[test]
fn a_line_is_a_few_loops_and_its_jacobian_is_tridiagonal() {
    let (small, large) = (line(100).lower(true), line(500).lower(true));
    assert_eq!(small.programs.residual.kernels(), large.programs.residual.kernels());
    assert_eq!(small.programs.jacobian.kernels(), large.programs.jacobian.kernels());
    assert!(large.programs.residual.kernels() < 10);
    assert_eq!(large.columns.len(), 500);
    assert_eq!(large.pattern.nnz(), 3 * 500 - 2);
    let y: Vec<f64> = (0..100).map(|i| 3.0 + f64::from(i * i % 7)).collect();
    let yp: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
    let mut values = values_of(&small);
    check_jacobian(&small, &mut values, &y, &yp, 12.5);
    let interpreted = line(100).lower(false);
    let mut other = values_of(&interpreted);
    let (a, b) = (point(&small, &mut values, &y, &yp, 12.5), point(&interpreted, &mut other, &y, &yp, 12.5));
    assert_eq!(bits(&a.residual), bits(&b.residual));
    assert_eq!(bits(&a.jacobian), bits(&b.jacobian));
    small.observe(0.3, &y, &yp, &mut values);
    for assign in small.dae.continuous.iter() {
        let BltBlock::Assign(assign) = assign else { panic!("only assignments") };
        let expected = small.eval(assign.value, &values);
        assert_relative_eq!(values[small.layout.unknown(assign.unknown)], expected, max_relative = 1e-13);
    }
}

#[test]
fn only_what_is_wanted_is_observed() {
    let system = line(20).lower(true);
    let mut values = values_of(&system);
    let find = |name: &str| {
        let index = system.dae.variables.iter().position(|v| v.name == name).unwrap();
        VarId(u32::try_from(index).unwrap())
    };
    let (wanted, other) = (find("o[7].q"), find("o[8].q"));
    let program = system.observe_only(&[wanted]);
    let y: Vec<f64> = (0..20).map(|i| f64::from(i * i)).collect();
    system.load(0.0, &y, &y, &mut values);
    program.run(&mut values);
    let dp = y[6] - y[7];
    assert_relative_eq!(values[system.layout.var(wanted)], 0.5f64.sqrt() * dp / (dp * dp + 1.0).sqrt());
    assert_eq!(values[system.layout.var(other)], 0.0);
}

#[test]
fn parts_of_a_looped_program_fit_into_its_scratch_region() {
    let system = line(200).lower(true);
    let wanted: Vec<VarId> = (0..system.dae.variables.len()).step_by(71).map(|i| VarId(i as u32)).collect();
    let (mut some, mut all) = (values_of(&system), values_of(&system));
    let y: Vec<f64> = (0..200).map(|i| f64::from(i * i % 17)).collect();
    system.load(0.2, &y, &y, &mut some);
    system.observe_only(&wanted).run(&mut some);
    system.observe(0.2, &y, &y, &mut all);
    for v in wanted {
        let slot = system.layout.var(v);
        assert_relative_eq!(some[slot], all[slot], max_relative = 1e-14);
    }
}

#[test]
fn parameters_can_be_overridden() {
    let mut m = Model::default();
    let two = m.number(2.0);
    let a = m.parameter("a", two);
    let double = m.dae.exprs.mul(two, a);
    let b = m.parameter("b", double);
    let (x, e) = m.state("x");
    let root = m.dae.exprs.sqrt(b);
    let rate = m.dae.exprs.mul(root, e);
    m.explicit(Unknown::Der(x), rate);
    let system = m.lower(false);
    let mut values = values_of(&system);
    let mut r = [0.0];
    system.residual(0.0, &[3.0], &[0.0], &mut values, &mut r).unwrap();
    assert_eq!(r[0], -6.0);
    values[system.layout.var(VarId(0))] = 8.0;
    system.evaluate_parameters(&mut values, &[true, false, false]);
    system.residual(0.0, &[3.0], &[0.0], &mut values, &mut r).unwrap();
    assert_eq!(r[0], -12.0);
}

/// `der(x) = -z`, with the loop `z + z^3 = x` torn at `z` through `w = z^2`.
fn looped() -> Model {
    let mut m = Model::default();
    let (x, ex) = m.state("x");
    let (z, ez) = m.continuous("z");
    let (w, ew) = m.continuous("w");
    let e = &mut m.dae.exprs;
    let square = e.square(ez);
    let cube = e.mul(ez, ew);
    let sum = e.add(ez, cube);
    let residual = e.sub(sum, ex);
    let rate = e.neg(ez);
    let inner = ExplicitAssignment { unknown: Unknown::Var(w), value: square, equation: 0 };
    let l = AlgebraicLoop {
        tearing: vec![Unknown::Var(z)],
        inner: vec![inner],
        residuals: vec![(residual, 0)],
        linear: false,
    };
    m.dae.continuous.push(BltBlock::Loop(l.clone()));
    m.dae.event.push(BltBlock::Loop(l));
    m.explicit(Unknown::Der(x), rate);
    m
}

#[test]
fn tearing_variables_are_columns() {
    for native in [false, true] {
        let system = looped().lower(native);
        assert_eq!(system.columns.len(), 2);
        assert!(!system.columns[1].is_state());
        assert_eq!(system.rows[1].kind, ResidualRowKind::Residual);
        let mut values = values_of(&system);
        let p = point(&system, &mut values, &[10.0, 2.0], &[-2.0, 0.0], 3.0);
        assert_eq!(p.residual, [0.0, 0.0]);
        check_jacobian(&system, &mut values, &[10.0, 2.0], &[-2.0, 0.0], 3.0);
    }
}

#[test]
fn a_loop_at_an_event_has_its_own_jacobian() {
    let system = looped().lower(true);
    let mut values = values_of(&system);
    let BlockCode::Loop(l) = &system.event[0] else { panic!("a loop") };
    values[system.layout.var(VarId(0))] = 10.0;
    values[l.tearing_slots[0]] = 1.0;
    l.residual.run(&mut values);
    assert_eq!(values[l.residual_slots[0]], -8.0);
    l.jacobian.run(&mut values);
    assert_eq!(l.pattern.nnz(), 1);
    assert_eq!(values[l.jacobian_slots[0]], 4.0);
}

#[test]
fn a_torn_derivative_is_yp() {
    // m*a = f - d*a, torn at a = der(v).
    let mut m = Model::default();
    let (v, ev) = m.state("v");
    let (f, ef) = m.continuous("f");
    let a = m.dae.exprs.der(v);
    let e = &mut m.dae.exprs;
    let three = e.num(3.0);
    let damped = e.mul(three, a);
    let force = e.sub(ev, damped);
    let residual = e.sub(a, ef);
    let inner = ExplicitAssignment { unknown: Unknown::Var(f), value: force, equation: 0 };
    let l = AlgebraicLoop {
        tearing: vec![Unknown::Der(v)],
        inner: vec![inner],
        residuals: vec![(residual, 0)],
        linear: true,
    };
    m.dae.continuous.push(BltBlock::Loop(l));
    let system = m.lower(true);
    let mut values = values_of(&system);
    assert_eq!(system.columns.len(), 1);
    let p = point(&system, &mut values, &[8.0], &[2.0], 5.0);
    assert_eq!(p.residual, [0.0]);
    assert_eq!(p.jacobian, [4.0 * 5.0 - 1.0]);
    system.observe(0.0, &[8.0], &[2.0], &mut values);
    assert_eq!(values[system.layout.var(f)], 2.0);
}

#[test]
fn large_systems_keep_what_would_fill_the_matrix() {
    // s = sum of all x; der(x[i]) = s - x[i].
    let mut m = Model::default();
    let states: Vec<_> = (0..100).map(|i| m.state(&format!("x[{i}]"))).collect();
    let (s, es) = m.continuous("s");
    let terms: Vec<ExprId> = states.iter().map(|x| x.1).collect();
    let sum = m.dae.exprs.sum(&terms);
    m.explicit(Unknown::Var(s), sum);
    for &(x, ex) in &states {
        let rate = m.dae.exprs.sub(es, ex);
        m.explicit(Unknown::Der(x), rate);
    }
    let system = m.lower(true);
    assert_eq!(system.columns.len(), 101);
    assert_eq!(system.rows[100].kind, ResidualRowKind::Explicit);
    assert_eq!(system.pattern.nnz(), 100 + 100 + 101);
    let mut values = values_of(&system);
    let y: Vec<f64> = (0..101).map(f64::from).collect();
    check_jacobian(&system, &mut values, &y, &y, 2.0);
}

#[test]
fn branches_are_lazy_and_traps_are_found() {
    let mut m = Model::default();
    let (x, ex) = m.state("x");
    let e = &mut m.dae.exprs;
    let positive = e.rel(RelationalOp::Gt, ex, Exprs::ZERO);
    let log = e.unary(UnaryFunction::Log, ex);
    let root = e.sqrt(log);
    let rate = e.if_(positive, root, ex);
    m.explicit(Unknown::Der(x), rate);
    let system = m.lower(true);
    let mut values = values_of(&system);
    let mut r = [0.0];
    assert_eq!(system.residual(0.0, &[-4.0], &[0.0], &mut values, &mut r), Ok(()));
    assert_eq!(r, [4.0]);
    assert_eq!(system.residual(0.0, &[0.5], &[0.0], &mut values, &mut r), Err(NonFinite));
    let trap = system.trap(rate, &values).unwrap();
    assert_eq!(trap.operation, "sqrt(-0.693147)");
    assert_eq!(trap.written, "sqrt(log(x))");
    assert!(trap.value.is_nan());
}

#[test]
fn crossings_are_differences_and_modes_stand_alone() {
    let mut m = Model::default();
    let (x, ex) = m.state("x");
    let (w, ew) = m.continuous("w");
    let mode = m.variable("x > 1", Variability::Discrete);
    m.dae.discrete.push(mode);
    let on = m.dae.exprs.var(mode);
    let e = &mut m.dae.exprs;
    let double = e.add(ex, ex);
    let above = e.rel(RelationalOp::Gt, ew, Exprs::ONE);
    let rate = e.if_(on, ew, Exprs::ONE);
    m.dae.crossings.push(ZeroCrossing {
        mode,
        kind: CrossingKind::Relation(RelationalOp::Gt, ew, Exprs::ONE),
        origin: ORIGIN,
    });
    m.explicit(Unknown::Var(w), double);
    let switch = m.assign(Unknown::Var(mode), above);
    m.dae.event.push(BltBlock::Assign(switch));
    m.explicit(Unknown::Der(x), rate);
    let mixed = MixedLoop { continuous: vec![], discrete: vec![switch] };
    m.dae.event.push(BltBlock::Mixed(mixed));
    let other = m.variable("alias", Variability::Continuous);
    m.dae.aliases.push(Alias { variable: other, target: w, negated: true });
    let system = m.lower(true);
    assert_eq!(system.event.len(), 4);
    let mut values = values_of(&system);
    let mut g = [0.0];
    system.crossings(0.0, &[2.0], &[0.0], &mut values, &mut g);
    assert_eq!(g, [3.0]);
    values[system.layout.var(w)] = 1.5;
    system.crossings_from(&mut values, &mut g);
    assert_eq!(g, [0.5]);
    let BlockCode::Assign(run) = &system.event[1] else { panic!("modes") };
    run.program.run(&mut values);
    assert_eq!(values[system.layout.var(mode)], 1.0);
    system.observe(0.0, &[2.0], &[0.0], &mut values);
    assert_eq!(values[system.layout.var(other)], -4.0);
    assert_eq!(values[system.layout.der(x).unwrap()], 4.0);
}

#[test]
fn homotopy_mixes_in_the_initial_system_only() {
    let mut m = Model::default();
    let (z, _) = m.continuous("z");
    let (two, ten) = (m.number(2.0), m.number(10.0));
    let value = m.dae.exprs.homotopy(two, ten);
    let block = BltBlock::Assign(m.assign(Unknown::Var(z), value));
    m.dae.initial.push(block.clone());
    m.dae.event.push(block);
    let system = m.lower(false);
    let mut values = values_of(&system);
    let run = |blocks: &[BlockCode], lambda: f64, values: &mut [f64]| {
        values[ValueLayout::LAMBDA] = lambda;
        let BlockCode::Assign(run) = &blocks[0] else { panic!("an assignment") };
        run.program.run(values);
        values[system.layout.var(z)]
    };
    assert_eq!(run(&system.initial, 0.0, &mut values), 10.0);
    assert_eq!(run(&system.initial, 0.25, &mut values), 8.0);
    assert_eq!(run(&system.initial, 1.0, &mut values), 2.0);
    assert_eq!(run(&system.event, 0.0, &mut values), 2.0);
}

#[test]
fn systems_can_be_shared() {
    fn shared<T: Send + Sync>(_: &T) {}
    let system = line(3).lower(true);
    shared(&system);
    let copy = system.clone();
    drop(system);
    let mut values = values_of(&copy);
    let p = point(&copy, &mut values, &[1.0, 2.0, 3.0], &[0.0; 3], 1.0);
    assert!(p.residual.iter().all(|r| r.is_finite()));
}
