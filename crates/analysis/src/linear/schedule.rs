//! The quasi-linear parameter-varying form x' = A(rho) x + B(rho) (u, 1) over a grid of scheduling quantities rho.
//!
//! A prepared model ([`LinearizationSetup::scheduled`]) and a state enter; a [`QuasiLpvModel`] leaves. The form is
//! exact where the equations are affine in everything but rho.
//!
//! At fixed rho the rates are x' = g(rho) + H(rho) z, where z are the other states and inputs and H is the exact
//! Jacobian. g is distributed along a path from rho = 0, one quantity after the other, inputs first. The change of g on
//! a segment over the change of its quantity is the column of this quantity: a secant, not a slope, so that the sum
//! over all columns reproduces g. What remains at rho = 0 belongs to the constant input 1.

use super::{LinearizationSetup, Quantity, SchedulingSource};
use crate::local::LocalEvaluator;
use bramah_expr::VarId;
use bramah_solve::State;
use bramah_syntax::diag::{Code, Diagnostic};
use nalgebra::DMatrix;
use serde_json::{Value, json};

/// A model of n states and m inputs in quasi-linear form over a grid.
#[derive(Clone, Debug)]
pub struct QuasiLpvModel {
    /// The name of the model's class.
    pub class: String,
    /// Names of the scheduling quantities.
    pub rho: Vec<String>,
    /// The state or input that each scheduling quantity is a multiple of.
    pub(super) legs: Vec<SchedulingCoordinate>,
    /// The states, with their values at the operating point.
    pub states: Vec<Quantity>,
    /// The m inputs, without the constant one.
    pub inputs: Vec<Quantity>,
    /// For each scheduling quantity its values, ascending.
    pub grid: Vec<Vec<f64>>,
    /// The matrices at all combinations of these values; the last quantity changes fastest.
    pub points: Vec<LpvGridPoint>,
    /// For each state the largest difference between A x + B u and its rate at random states and inputs, relative to
    /// the largest term of the row. Up to about 1e-12 where the form is exact.
    pub error: Vec<f64>,
    /// Number of random points at which the model has a value.
    pub tried: usize,
}

/// The matrices at one point of the grid.
#[derive(Clone, Debug)]
pub struct LpvGridPoint {
    /// Values of the scheduling quantities.
    pub rho: Vec<f64>,
    /// n by n.
    pub a: DMatrix<f64>,
    /// n by (m + 1); the last column belongs to the constant input 1.
    pub b: DMatrix<f64>,
}

/// A scheduling quantity as a multiple of one state or input w: `factor * (w - origin)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SchedulingCoordinate {
    /// The place of w among states, then parameters and inputs.
    pub column: usize,
    /// d rho/d w.
    pub factor: f64,
    /// The value of w at rho = 0.
    pub origin: f64,
}

/// Rates as a function of w: states, then parameters, then inputs.
struct VectorField {
    /// The model, evaluated point by point.
    local: LocalEvaluator,
    /// Time of the operating point in seconds.
    time: f64,
    /// Number of states.
    states: usize,
    /// Number of parameters.
    parameters: usize,
}

impl VectorField {
    /// The parts of w: states, parameters, inputs.
    fn split<'w>(&self, w: &'w [f64]) -> (&'w [f64], &'w [f64], &'w [f64]) {
        let (x, rest) = w.split_at(self.states);
        let (theta, u) = rest.split_at(self.parameters);
        (x, theta, u)
    }

    /// The rates at w; `None` where the equations have no solution.
    fn rates(&mut self, w: &[f64]) -> Option<Vec<f64>> {
        let (x, theta, u) = self.split(w);
        self.local.evaluate(self.time, x, theta, u).ok()?;
        Some(self.local.rates.clone())
    }

    /// The rates and their derivatives by all of w; `None` where the equations have no solution.
    fn slopes(&mut self, w: &[f64]) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let (x, theta, u) = self.split(w);
        self.local.linearize(self.time, x, theta, u).ok()?;
        let (a, b) = (&self.local.linear.a, &self.local.linear.b);
        let all =
            DMatrix::from_fn(
                self.states,
                w.len(),
                |i, j| {
                    if j < self.states { a[(i, j)] } else { b[(i, j - self.states)] }
                },
            );
        Some((self.local.rates.clone(), all))
    }
}

/// Builds the quasi-linear form of `chosen` around a state.
///
/// `chosen` comes from [`LinearizationSetup::scheduled`]. `grid` holds the values of each scheduling quantity, or
/// `None` for five over its range. `ranges` holds the smallest and largest values of
/// [`LinearizationSetup::quantities`], for the check at random points.
///
/// # Errors
/// [`Code::BadArgument`] when a scheduling quantity is not affine in one state or input, or where the equations have no
/// value on the grid.
pub fn schedule(
    chosen: &LinearizationSetup,
    state: &State,
    grid: &[Option<Vec<f64>>],
    ranges: &[(f64, f64)],
) -> Result<QuasiLpvModel, Diagnostic> {
    let local = chosen.at(state).map_err(|e| no_value(&e.to_string()))?;
    let (theta, u) = chosen.given(state);
    let w0: Vec<f64> = local.state().into_iter().chain(theta.iter().copied()).chain(u).collect();
    let plan = chosen.plan.clone();
    let mut field = VectorField { time: state.time, states: plan.states(), parameters: plan.parameters(), local };
    let rho: Vec<String> = chosen.rho.iter().map(|r| r.name.clone()).collect();
    let legs = legs(&mut field, &w0, ranges, chosen)?;
    let even = |leg: &SchedulingCoordinate| {
        let (low, high) = ranges[leg.column];
        let at = |i: u32| leg.factor * (low + (high - low) * f64::from(i) / 4.0 - leg.origin);
        (0..5).map(at).collect::<Vec<f64>>()
    };
    let mut grid: Vec<Vec<f64>> = legs.iter().zip(grid).map(|(l, g)| g.clone().unwrap_or_else(|| even(l))).collect();
    for values in &mut grid {
        values.sort_by(f64::total_cmp);
        // Equal values would make cells of width zero, over which nothing can be interpolated.
        values.dedup();
    }
    let mut points = Vec::new();
    for values in products(&grid) {
        let found = factorised(&mut field, &legs, &w0, &values);
        let (a, b) = found.ok_or_else(|| no_value(&format!("at {}", shown(&rho, &values))))?;
        points.push(LpvGridPoint { rho: values, a, b });
    }
    let (error, tried) = check(&mut field, &legs, &w0, ranges);
    let variables = &plan.system.dae.variables;
    let quantity = |(v, value): (VarId, &f64)| Quantity::of(&variables[v.index()], *value, 1.0);
    let mut states: Vec<Quantity> = chosen.quantities().zip(&w0).map(quantity).collect();
    let inputs = states.split_off(field.states);
    let class = plan.system.dae.class.clone();
    Ok(QuasiLpvModel { class, rho, legs, states, inputs, grid, points, error, tried })
}

/// The message that the equations have no value on the grid.
fn no_value(why: &str) -> Diagnostic {
    Diagnostic::new(Code::BadArgument, format!("the equations have no value on the grid: {why}"))
}

/// A point of the grid as text.
fn shown(names: &[String], values: &[f64]) -> String {
    let all: Vec<String> =
        names.iter().zip(values).map(|(n, v)| format!("{n} = {}", bramah_results::number::rounded(*v, 6))).collect();
    all.join(", ")
}

/// Finds for each scheduling quantity the state or input that it is a multiple of.
///
/// # Errors
/// [`Code::BadArgument`] where it depends on several of them or not linearly.
fn legs(
    field: &mut VectorField,
    w0: &[f64],
    ranges: &[(f64, f64)],
    chosen: &LinearizationSetup,
) -> Result<Vec<SchedulingCoordinate>, Diagnostic> {
    let mut seen = Vec::new();
    // A coefficient that agrees at two points off the operating point is taken as constant.
    for part in [0.3, 0.62] {
        let w: Vec<f64> = w0.iter().zip(ranges).map(|(w, (low, high))| w + part * 0.2 * (high - low)).collect();
        field.slopes(&w).ok_or_else(|| no_value("near the operating point"))?;
        let linear = &field.local.linear;
        let row = |k: usize| linear.c.row(k).iter().chain(linear.d.row(k).iter()).copied().collect::<Vec<f64>>();
        let rows: Vec<(Vec<f64>, f64)> = (0..linear.c.nrows()).map(|k| (row(k), field.local.outputs[k])).collect();
        seen.push((w, rows));
    }
    let legs = chosen.rho.iter().map(|r| match r.source {
        SchedulingSource::Given(place) => {
            Ok(SchedulingCoordinate { column: field.states + place, factor: 1.0, origin: 0.0 })
        }
        SchedulingSource::Output(k) => leg(&seen, k).ok_or_else(|| {
            let text = format!("`{}` is not a multiple of one state or input, so it cannot schedule", r.name);
            Diagnostic::new(Code::BadArgument, text)
        }),
    });
    legs.collect()
}

/// The coordinate of output `k`; `None` where it depends on several quantities, or with another coefficient at the
/// second point.
fn leg(seen: &[(Vec<f64>, Vec<(Vec<f64>, f64)>)], k: usize) -> Option<SchedulingCoordinate> {
    let [(w, first), (_, second)] = seen else { return None };
    let ((row, value), (again, _)) = (&first[k], &second[k]);
    let mut used = (0..row.len()).filter(|&j| row[j] != 0.0 || again[j] != 0.0);
    let j = used.next()?;
    let same = (row[j] - again[j]).abs() <= 1e-12 * row[j].abs();
    (used.next().is_none() && same).then(|| SchedulingCoordinate {
        column: j,
        factor: row[j],
        origin: w[j] - value / row[j],
    })
}

/// All combinations of values; the last quantity changes fastest.
fn products(grid: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for values in grid {
        all = all.iter().flat_map(|head: &Vec<f64>| values.iter().map(|v| [head.as_slice(), &[*v]].concat())).collect();
    }
    all
}

/// A and B at values of the scheduling quantities, the other quantities being at `w0`. `None` where the equations have
/// no value there.
fn factorised(
    field: &mut VectorField,
    legs: &[SchedulingCoordinate],
    w0: &[f64],
    rho: &[f64],
) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = field.states;
    let place = |leg: &SchedulingCoordinate, value: f64| leg.origin + value / leg.factor;
    let mut w = w0.to_vec();
    legs.iter().zip(rho).for_each(|(leg, &value)| w[leg.column] = place(leg, value));
    let scheduled = |j: usize| legs.iter().any(|l| l.column == j);
    let (_, slopes) = field.slopes(&w)?;
    let mut all = slopes.clone();
    // Inputs first: a command of zero may be the one value at which the equations cannot be evaluated.
    let mut order: Vec<usize> = (0..legs.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(legs[k].column));
    // The path is walked from its end back to rho = 0.
    let mut constant = vec![0.0; n];
    let mut here = free_part(field, &w, w0, &scheduled)?;
    for (at, &k) in order.iter().enumerate().rev() {
        let leg = legs[k];
        let step = w[leg.column] - leg.origin;
        let mut before = w.clone();
        before[leg.column] = leg.origin;
        let there = free_part(field, &before, w0, &scheduled);
        let Some(there) = there else {
            // A segment that cannot be evaluated stays with the constant input, and so do those before it.
            order[..=at].iter().for_each(|&k| all.column_mut(legs[k].column).fill(0.0));
            break;
        };
        // At rho = 0 the secant is 0/0; the slope from `slopes` stays.
        if step != 0.0 {
            (0..n).for_each(|i| all[(i, leg.column)] = (here[i] - there[i]) / step);
        }
        // The column multiplies w, not w - origin: the offset goes to the constant input.
        (0..n).for_each(|i| constant[i] -= all[(i, leg.column)] * leg.origin);
        w = before;
        here = there;
    }
    (0..n).for_each(|i| constant[i] += here[i]);
    let a = all.columns(0, n).into_owned();
    let inputs = all.ncols() - n;
    let b = DMatrix::from_fn(n, inputs + 1, |i, j| if j < inputs { all[(i, n + j)] } else { constant[i] });
    Some((a, b))
}

/// g: the rates minus the part that is linear in what does not schedule.
fn free_part(field: &mut VectorField, w: &[f64], w0: &[f64], scheduled: &dyn Fn(usize) -> bool) -> Option<Vec<f64>> {
    let (rates, slopes) = field.slopes(w)?;
    let rest = |i: usize| (0..w.len()).filter(|&j| !scheduled(j)).map(|j| slopes[(i, j)] * w0[j]).sum::<f64>();
    Some((0..rates.len()).map(|i| rates[i] - rest(i)).collect())
}

/// Number of random points of the check.
const TRIES: usize = 200;

/// Compares A x + B u with the rates at quasi-random states and inputs within `ranges`.
///
/// Returns the largest relative difference of each row, and at how many points the model had a value.
fn check(
    field: &mut VectorField,
    legs: &[SchedulingCoordinate],
    w0: &[f64],
    ranges: &[(f64, f64)],
) -> (Vec<f64>, usize) {
    let n = field.states;
    let mut error = vec![0.0f64; n];
    let mut tried = 0;
    for k in 1..=TRIES {
        let w: Vec<f64> = ranges.iter().enumerate().map(|(j, (low, high))| low + halton(k, j) * (high - low)).collect();
        let rho: Vec<f64> = legs.iter().map(|l| l.factor * (w[l.column] - l.origin)).collect();
        // Points without a solution, as beyond a physical limit, do not count.
        let (Some(rates), Some((a, b))) = (field.rates(&w), factorised(field, legs, w0, &rho)) else { continue };
        tried += 1;
        for i in 0..n {
            let terms = (0..w.len()).map(|j| if j < n { a[(i, j)] * w[j] } else { b[(i, j - n)] * w[j] });
            let terms: Vec<f64> = terms.chain([b[(i, w.len() - n)]]).collect();
            let largest = terms.iter().fold(rates[i].abs(), |m, t| m.max(t.abs())).max(f64::MIN_POSITIVE);
            error[i] = error[i].max((terms.iter().sum::<f64>() - rates[i]).abs() / largest);
        }
    }
    (error, tried)
}

/// Coordinate `j` of point `k` of Halton's sequence, between 0 and 1.
fn halton(k: usize, j: usize) -> f64 {
    const PRIMES: [usize; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
    let base = PRIMES[j % PRIMES.len()];
    // From 17 coordinates on bases repeat; an offset keeps two coordinates of one base apart.
    let mut index = k + j / PRIMES.len() * 409;
    let (mut value, mut digit) = (0.0, 1.0 / base as f64);
    while index > 0 {
        value += digit * (index % base) as f64;
        index /= base;
        digit /= base as f64;
    }
    value
}

impl QuasiLpvModel {
    /// Whether the form agrees with the model at all points tried.
    pub fn is_exact(&self) -> bool {
        self.tried > 0 && self.error.iter().all(|e| *e <= 1e-12)
    }

    /// The whole form as JSON.
    pub fn json(&self) -> Value {
        let rows = |m: &DMatrix<f64>| m.row_iter().map(|r| r.iter().copied().collect::<Vec<f64>>()).collect::<Vec<_>>();
        let points: Vec<Value> =
            self.points.iter().map(|p| json!({"rho": p.rho, "A": rows(&p.a), "B": rows(&p.b)})).collect();
        json!({
            "rho": self.rho,
            "states": self.states.iter().map(|q| &q.name).collect::<Vec<_>>(),
            "inputs": self.inputs.iter().map(|q| q.name.as_str()).chain(["1"]).collect::<Vec<_>>(),
            "exact": self.is_exact(),
            "error": self.error,
            "points": points,
        })
    }

    /// One line for each point of the grid: the scheduling quantities, then A and B by rows.
    pub fn csv(&self) -> String {
        let entry = |letter: char, i: usize, j: usize| format!("\"{letter}[{},{}]\"", i + 1, j + 1);
        let (n, m) = (self.states.len(), self.inputs.len() + 1);
        let mut head: Vec<String> = self.rho.iter().map(|r| format!("\"{r}\"")).collect();
        head.extend((0..n).flat_map(|i| (0..n).map(move |j| entry('A', i, j))));
        head.extend((0..n).flat_map(|i| (0..m).map(move |j| entry('B', i, j))));
        let mut out = head.join(",") + "\n";
        for p in &self.points {
            let by_rows = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
            let all: Vec<f64> = [p.rho.clone(), by_rows(&p.a), by_rows(&p.b)].concat();
            out += &(all.iter().map(|v| bramah_results::number::text(*v)).collect::<Vec<_>>().join(",") + "\n");
        }
        out
    }

    /// Size and accuracy of the form as text.
    pub fn words(&self) -> String {
        let mut out = format!("quasi-linear form over ({}): {} points\n", self.rho.join(", "), self.points.len());
        let most = self.error.iter().fold(0.0f64, |m, e| m.max(*e));
        let said = bramah_results::number::rounded(most, 2);
        if self.is_exact() {
            out +=
                &format!("exact: A x + B u meets the rates to {said} of the largest term, at {} states\n", self.tried);
        } else {
            out += &format!("not exact: A x + B u misses the rates by up to {said} of the largest term\n");
            for (state, error) in self.states.iter().zip(&self.error).filter(|(_, e)| **e > 1e-12) {
                let name = &state.name;
                out += &format!("  der({name}): {}\n", bramah_results::number::rounded(*error, 2));
            }
        }
        out
    }
}
