//! Poles of a linear model with the participation of its states, and its zeros.
//!
//! A [`StateSpace`] enters; [`Pole`]s and complex zeros leave, for the exports and figures. Matrices are scaled by the
//! nominal values of the states before eigenvalues are computed.

use super::StateSpace;
use nalgebra::linalg::{Schur, balancing};
use nalgebra::{Complex, DMatrix, DVector};
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};

/// An eigenvalue of A; of a conjugate pair the one with positive imaginary part.
#[derive(Clone, Debug, PartialEq)]
pub struct Pole {
    /// Real part in 1/s.
    pub re: f64,
    /// Imaginary part in 1/s, not negative.
    pub im: f64,
    /// Undamped natural frequency in Hz.
    pub frequency: f64,
    /// Damping ratio: from 1 on there is no oscillation, below 0 the motion grows.
    pub damping: f64,
    /// Participating states: index and share, largest share first. Shares add up to 1; those under 2 % are left out.
    pub participation: Vec<(usize, f64)>,
    /// How many poles coincide here with the same states, this one included.
    ///
    /// No state belongs to one of several coinciding poles alone, and their motion may grow with time before it decays.
    pub together: usize,
}

/// Eigenvalues closer than this, relative to their size, count as one. Rounding separates the eigenvalues of a
/// defective matrix from about the eighth digit on.
const COINCIDE: f64 = 1e-6;

/// Smallest share of a state that is listed.
const LEAST_SHARE: f64 = 0.02;

/// Poles in the order of their magnitude; empty where the eigenvalue iteration fails.
///
/// The participation of state k in mode i is |w_ki v_ki| with left and right eigenvectors (I. J. Perez-Arriaga, G. C.
/// Verghese, F. C. Schweppe, IEEE Trans. PAS-101 (1982) 3117).
///
/// Poles are computed for each strongly connected component of the states, because participation is zero outside of it.
/// So poles of different components may coincide, as those of two integrators in a row do, and each keeps its own
/// states. Where poles coincide within a component, eigenvectors are not unique. Each of them then gets the shares of
/// the states in the common invariant subspace: the diagonal of the projector V (W'V)^-1 W'.
pub fn poles(model: &StateSpace) -> Vec<Pole> {
    let a = scaled(model);
    let mut found: Vec<Pole> = circles(&a).iter().flat_map(|states| of_circle(&a, states)).collect();
    found.sort_by(|a, b| a.re.hypot(a.im).total_cmp(&b.re.hypot(b.im)).then(b.re.total_cmp(&a.re)));
    found
}

/// The strongly connected components of the states, each ascending, ordered by their first states.
fn circles(a: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let n = a.nrows();
    let mut graph: DiGraph<(), ()> = DiGraph::with_capacity(n, n);
    let nodes: Vec<NodeIndex> = (0..n).map(|_| graph.add_node(())).collect();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| a[(i, j)] != 0.0) {
        graph.add_edge(nodes[j], nodes[i], ());
    }
    let sorted = |group: Vec<NodeIndex>| {
        let mut states: Vec<usize> = group.into_iter().map(NodeIndex::index).collect();
        states.sort_unstable();
        states
    };
    let mut all: Vec<Vec<usize>> = tarjan_scc(&graph).into_iter().map(sorted).collect();
    all.sort_unstable();
    all
}

/// The poles of one strongly connected component.
fn of_circle(a: &DMatrix<f64>, states: &[usize]) -> Vec<Pole> {
    let own = a.select_rows(states).select_columns(states);
    let mut open = eigenvalues(&own);
    let largest = open.iter().map(|l| l.norm()).fold(0.0, f64::max);
    // What rounding leaves of an integrator's zero.
    open.iter_mut().filter(|l| l.norm() <= 1e-14 * largest).for_each(|l| *l = Complex::new(0.0, 0.0));
    let all = open.clone();
    let mut found = Vec::new();
    // Takes one cluster of coinciding eigenvalues after the other.
    while let Some(first) = open.first().copied() {
        let near = |o: &Complex<f64>| (o - first).norm() <= COINCIDE * first.norm();
        let (together, rest): (Vec<Complex<f64>>, Vec<Complex<f64>>) = open.into_iter().partition(near);
        open = rest;
        let others = all.iter().filter(|o| !near(o));
        let mut centre = together.iter().sum::<Complex<f64>>() / together.len() as f64;
        if together.len() > 1 && centre.im.abs() <= COINCIDE * centre.norm() {
            // A defective real eigenvalue comes out as a complex pair by rounding.
            centre.im = 0.0;
        }
        // The conjugate above it stands for both.
        if centre.im < 0.0 {
            continue;
        }
        let gap = others.map(|o| (o - centre).norm()).fold(f64::INFINITY, f64::min);
        let shares = participation(&own, centre, together.len(), gap);
        let size = centre.norm();
        let pole = Pole {
            re: centre.re,
            im: centre.im,
            frequency: size / std::f64::consts::TAU,
            damping: if size > 0.0 { -centre.re / size } else { 0.0 },
            participation: shares.into_iter().map(|(k, share)| (states[k], share)).collect(),
            together: together.len(),
        };
        found.extend(together.iter().map(|_| pole.clone()));
    }
    found
}

/// A in units of the states' nominal values.
fn scaled(model: &StateSpace) -> DMatrix<f64> {
    let n = model.states.len();
    DMatrix::from_fn(n, n, |i, j| model.a[(i, j)] * model.states[j].nominal / model.states[i].nominal)
}

/// Eigenvalues by the real Schur form; empty where its iteration does not converge.
pub(super) fn eigenvalues(a: &DMatrix<f64>) -> Vec<Complex<f64>> {
    if a.is_empty() {
        return Vec::new();
    }
    let mut balanced = a.clone();
    balancing::balance_parlett_reinsch(&mut balanced);
    let schur = Schur::try_new(balanced, f64::EPSILON, 10_000);
    schur.map_or_else(Vec::new, |s| s.complex_eigenvalues().iter().copied().collect())
}

/// Shares of the states in `count` eigenvalues at one place; `gap` is the distance to the nearest other one.
fn participation(a: &DMatrix<f64>, eigenvalue: Complex<f64>, count: usize, gap: f64) -> Vec<(usize, f64)> {
    if count == a.nrows() {
        // The invariant subspace is the entire space, so all states participate alike.
        return (0..count).map(|k| (k, 1.0 / count as f64)).collect();
    }
    let projector = projector(a, eigenvalue, count, gap);
    let Some(all) = projector.map(|p| p.diagonal().map(Complex::norm)) else { return Vec::new() };
    let sum: f64 = all.sum();
    let mut shares: Vec<(usize, f64)> = all.iter().map(|s| s / sum).enumerate().collect();
    shares.retain(|s| s.1 >= LEAST_SHARE);
    // Shares that are equal up to rounding keep the order of the states.
    let rank = |share: f64| (1e9 * share).round();
    shares.sort_by(|a, b| rank(b.1).total_cmp(&rank(a.1)).then(a.0.cmp(&b.0)));
    shares
}

/// The spectral projector onto the invariant subspace of `count` eigenvalues at one place, along all others.
fn projector(a: &DMatrix<f64>, eigenvalue: Complex<f64>, count: usize, gap: f64) -> Option<DMatrix<Complex<f64>>> {
    let right = invariant(a, eigenvalue, count, gap)?;
    let left = invariant(&a.transpose(), eigenvalue, count, gap)?.transpose();
    Some(&right * (&left * &right).try_inverse()? * left)
}

/// Distance of the shift of inverse iteration from the eigenvalue, as a share of the distance to the next one.
///
/// It is small enough to converge fast, and large enough that for a defective eigenvalue not only its single
/// eigenvector is left in the digits.
const STAND_OFF: f64 = 1e-5;

/// An orthonormal basis of the invariant subspace, by inverse iteration; n by `count`. `None` where it fails.
fn invariant(a: &DMatrix<f64>, eigenvalue: Complex<f64>, count: usize, gap: f64) -> Option<DMatrix<Complex<f64>>> {
    let n = a.nrows();
    let mut shifted = a.map(|v| Complex::new(v, 0.0));
    let shift = eigenvalue + Complex::new((STAND_OFF * gap).max(f64::MIN_POSITIVE), 0.0);
    (0..n).for_each(|k| shifted[(k, k)] -= shift);
    let lu = shifted.lu();
    // The start vectors have a part in every state.
    let begin = |k: usize, j: usize| Complex::new(if k % count == j { 1.0 } else { 0.1 }, 0.1 * ((k + j) % 7) as f64);
    let mut basis = DMatrix::from_fn(n, count, begin);
    for _ in 0..4 {
        basis = lu.solve(&basis)?;
        if !basis.iter().all(|v| v.is_finite()) || basis.iter().all(|v| *v == Complex::new(0.0, 0.0)) {
            return None;
        }
        basis = basis.qr().q();
    }
    Some(basis)
}

/// Invariant zeros from one input to one output, in the order of their magnitude; conjugates are left out.
///
/// With relative degree r they are the eigenvalues of A - b c A^r/(c A^(r-1) b), except for r at zero (the zero
/// dynamics); with a direct path those of A - b c/d.
pub fn zeros(model: &StateSpace, input: usize, output: usize) -> Vec<Complex<f64>> {
    let way = between(model, input, output);
    let n = way.len();
    let size = |k: usize| model.states[way[k]].nominal;
    let a = DMatrix::from_fn(n, n, |i, j| model.a[(way[i], way[j])] * size(j) / size(i));
    // Time is scaled by the fastest rate, so that powers of A stay of the order of 1.
    let rate = if a.is_empty() { 1.0 } else { a.amax().max(f64::MIN_POSITIVE) };
    let a = a / rate;
    let b = DVector::from_fn(n, |i, _| model.b[(way[i], input)] / size(i));
    let mut row = DVector::from_fn(n, |i, _| model.c[(output, way[i])] * size(i)).transpose();
    let direct = model.d[(output, input)];
    if n == 0 {
        return Vec::new();
    }
    let mut order = 0;
    let mut gain = direct;
    // Finds the relative degree: how many derivatives of the output do not depend on the input.
    while gain.abs() <= 1e-11 * row.amax() * b.amax() {
        // The input never reaches the output.
        if order == n {
            return Vec::new();
        }
        if order > 0 {
            row = &row * &a;
        }
        order += 1;
        gain = (&row * &b)[0];
    }
    // `row` is c A^(r-1); with a direct path it is c itself, which is not yet scaled by the rate.
    let next = if order == 0 { row / rate } else { &row * &a };
    let reduced = &a - &b * next / gain;
    let mut found = eigenvalues(&reduced);
    found.sort_by(|x, y| x.norm().total_cmp(&y.norm()));
    let mut kept: Vec<Complex<f64>> = found.into_iter().skip(order).map(|z| z * rate).collect();
    kept.retain(|z| z.im >= 0.0);
    kept
}

/// The states through which the input can reach the output. All others would give zeros that cancel with poles.
fn between(model: &StateSpace, input: usize, output: usize) -> Vec<usize> {
    let n = model.states.len();
    let spread = |seed: &dyn Fn(usize) -> bool, edge: &dyn Fn(usize, usize) -> bool| {
        let mut found: Vec<bool> = (0..n).map(seed).collect();
        let mut ready: Vec<usize> = (0..n).filter(|&k| found[k]).collect();
        while let Some(from) = ready.pop() {
            for to in 0..n {
                if !found[to] && edge(from, to) {
                    found[to] = true;
                    ready.push(to);
                }
            }
        }
        found
    };
    let reached = spread(&|k| model.b[(k, input)] != 0.0, &|from, to| model.a[(to, from)] != 0.0);
    let seen = spread(&|k| model.c[(output, k)] != 0.0, &|from, to| model.a[(from, to)] != 0.0);
    (0..n).filter(|&k| reached[k] && seen[k]).collect()
}
