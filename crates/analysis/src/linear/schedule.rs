//! The quasi-linear form: x' = A(rho) x + B(rho) (u, 1), exact where the equations are affine in everything but rho.
//!
//! With the scheduling quantities fixed, x' = g(rho) + H(rho) z, where z are the other states and inputs and H is the
//! exact Jacobian. g is shared out along a path from rho = 0, one quantity after the other, inputs first: the change of
//! g on each leg over the quantity itself is its column (the secant, not the slope, so nothing is lost), and what is
//! left at rho = 0 belongs to the constant input 1.

use super::{LinearizationSetup, Quantity, SchedulingSource};
use crate::local::LocalEvaluator;
use bramah_expr::VarId;
use bramah_solve::State;
use bramah_syntax::diag::{Code, Diagnostic};
use nalgebra::DMatrix;
use serde_json::{Value, json};

/// A model in quasi-linear form over a grid.
#[derive(Clone, Debug)]
pub struct QuasiLpvModel {
    /// The class.
    pub class: String,
    /// Names of the scheduling quantities.
    pub rho: Vec<String>,
    /// What each of them is a multiple of.
    pub(super) legs: Vec<SchedulingCoordinate>,
    /// The states, with their values at the operating point.
    pub states: Vec<Quantity>,
    /// The inputs; behind them stands the constant one.
    pub inputs: Vec<Quantity>,
    /// The values of each scheduling quantity, ascending.
    pub grid: Vec<Vec<f64>>,
    /// All combinations of them, the last quantity fastest.
    pub points: Vec<LpvGridPoint>,
    /// Per state the largest difference between A x + B u and the rate, over the largest term of the row, at random
    /// states and inputs: at most about 1e-12 where the form is exact.
    pub error: Vec<f64>,
    /// How many random states were tried.
    pub tried: usize,
}

/// The matrices at one point.
#[derive(Clone, Debug)]
pub struct LpvGridPoint {
    /// Values of the scheduling quantities.
    pub rho: Vec<f64>,
    /// By states and states.
    pub a: DMatrix<f64>,
    /// By states and inputs, the constant one last.
    pub b: DMatrix<f64>,
}

/// A scheduling quantity: `factor * (w - origin)` of a state or input w.
#[derive(Clone, Copy, Debug)]
pub(super) struct SchedulingCoordinate {
    /// Among states, then inputs.
    pub column: usize,
    pub factor: f64,
    pub origin: f64,
}

/// Evaluates the rates over states and inputs together.
struct VectorField {
    local: LocalEvaluator,
    time: f64,
    states: usize,
    parameters: usize,
}

impl VectorField {
    fn split<'w>(&self, w: &'w [f64]) -> (&'w [f64], &'w [f64], &'w [f64]) {
        let (x, rest) = w.split_at(self.states);
        let (theta, u) = rest.split_at(self.parameters);
        (x, theta, u)
    }

    fn rates(&mut self, w: &[f64]) -> Option<Vec<f64>> {
        let (x, theta, u) = self.split(w);
        self.local.evaluate(self.time, x, theta, u).ok()?;
        Some(self.local.rates.clone())
    }

    /// Rates and their derivatives by all of w.
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

/// Builds the form of `chosen`, which was made by [`LinearizationSetup::scheduled`], around a state. `grid` holds the
/// values of each scheduling quantity, or nothing for five over its range. `ranges` are the smallest and largest values
/// of [`LinearizationSetup::quantities`], for the random check.
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

fn no_value(why: &str) -> Diagnostic {
    Diagnostic::new(Code::BadArgument, format!("the equations have no value on the grid: {why}"))
}

fn shown(names: &[String], values: &[f64]) -> String {
    let all: Vec<String> =
        names.iter().zip(values).map(|(n, v)| format!("{n} = {}", bramah_results::number::rounded(*v, 6))).collect();
    all.join(", ")
}

/// The state or input that each scheduling quantity is a multiple of.
fn legs(
    field: &mut VectorField,
    w0: &[f64],
    ranges: &[(f64, f64)],
    chosen: &LinearizationSetup,
) -> Result<Vec<SchedulingCoordinate>, Diagnostic> {
    let mut seen = Vec::new();
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

/// An output that is affine in one quantity alone: its derivatives are the same at two points.
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

/// All combinations, the last quantity fastest.
fn products(grid: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for values in grid {
        all = all.iter().flat_map(|head: &Vec<f64>| values.iter().map(|v| [head.as_slice(), &[*v]].concat())).collect();
    }
    all
}

/// A and B at values of the scheduling quantities; other quantities enter through exact derivatives at `w0`.
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
    // inputs first: a command of zero may be the one value that the equations do not take
    let mut order: Vec<usize> = (0..legs.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(legs[k].column));
    // g along the path, from its end back to rho = 0
    let mut constant = vec![0.0; n];
    let mut here = free_part(field, &w, w0, &scheduled)?;
    for (at, &k) in order.iter().enumerate().rev() {
        let leg = legs[k];
        let step = w[leg.column] - leg.origin;
        let mut before = w.clone();
        before[leg.column] = leg.origin;
        let there = free_part(field, &before, w0, &scheduled);
        let Some(there) = there else {
            // what cannot be followed to zero stays with the constant input
            order[..=at].iter().for_each(|&k| all.column_mut(legs[k].column).fill(0.0));
            break;
        };
        if step != 0.0 {
            (0..n).for_each(|i| all[(i, leg.column)] = (here[i] - there[i]) / step);
        }
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

/// g: the rates without the part that is linear in what does not schedule.
fn free_part(field: &mut VectorField, w: &[f64], w0: &[f64], scheduled: &dyn Fn(usize) -> bool) -> Option<Vec<f64>> {
    let (rates, slopes) = field.slopes(w)?;
    let rest = |i: usize| (0..w.len()).filter(|&j| !scheduled(j)).map(|j| slopes[(i, j)] * w0[j]).sum::<f64>();
    Some((0..rates.len()).map(|i| rates[i] - rest(i)).collect())
}

/// Random points for the check.
const TRIES: usize = 200;

/// Compares A x + B u with the rates at random states and inputs.
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

/// The k-th number of Halton's sequence in the j-th direction: spread evenly between 0 and 1.
fn halton(k: usize, j: usize) -> f64 {
    const PRIMES: [usize; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
    let base = PRIMES[j % PRIMES.len()];
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
    /// Whether the form is exact at all states tried.
    pub fn is_exact(&self) -> bool {
        self.tried > 0 && self.error.iter().all(|e| *e <= 1e-12)
    }

    /// All matrices.
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

    /// One line a point: the scheduling quantities, then the entries by rows.
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

    /// What was found, in words.
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
