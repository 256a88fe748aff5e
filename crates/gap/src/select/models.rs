//! Candidate models: the nominal model with hypotheses attached, and the coordinates that are free in it.
//!
//! Enters: a problem and a list of causes (hypotheses with values). Leaves: a `CandidateModel` for `estimate`, with
//! bounds and priors of its coordinates. Also the starting values of a hypothesis. Called by `screen`, `weighed`,
//! `search`, `plan`.

use super::super::effects::{EffectCoefficient, ShapeParameter};
use super::super::estimate::{CandidateModel, FitCoordinate};
use super::super::hypotheses::Hypothesis;
use super::super::problem::{DiagnosisProblem, HypothesisValues};
use super::compare::SensorAccuracy;
use crate::policy::{ACCURACY, GRID};
use bramah_syntax::diag::Diagnostic;

/// A shape with a grid may lie beyond the ends of its grid by this factor.
const BEYOND: f64 = 3.0;
/// A width may differ from its value by this factor, which is also one standard deviation of its prior.
const WIDER: f64 = 10.0;

/// Noise and full scales of a problem's sensors.
pub fn sensors(problem: &DiagnosisProblem<'_>) -> SensorAccuracy {
    SensorAccuracy { noise: problem.noise_floor.clone(), full_scale: problem.full_scale.clone() }
}

/// A model with these causes; `None` if it does not compile.
/// `tolerances`: values of the tolerance parameters, SI; `None` means nominal ones. `taken`: the first so many causes
/// have free widths.
pub fn candidate(
    problem: &DiagnosisProblem<'_>,
    causes: &[HypothesisValues],
    tolerances: Option<&[f64]>,
    taken: usize,
) -> Option<CandidateModel> {
    attached(problem, causes, tolerances, taken, causes.len()).ok()
}

/// The nominal model with its tolerance parameters free and no causes.
///
/// # Errors
/// The diagnostics of the compiler.
pub fn nominal(problem: &DiagnosisProblem<'_>) -> Result<CandidateModel, Vec<Diagnostic>> {
    attached(problem, &[], None, 0, 0)
}

/// As [`candidate`], but only the first `shapes` causes have free shapes.
///
/// # Errors
/// The diagnostics of the compiler.
pub fn attached(
    problem: &DiagnosisProblem<'_>,
    causes: &[HypothesisValues],
    tolerances: Option<&[f64]>,
    taken: usize,
    shapes: usize,
) -> Result<CandidateModel, Vec<Diagnostic>> {
    let mut model = problem.assembled(causes, &[], shapes)?;
    if let Some(values) = tolerances {
        model.theta[model.free.clone()].copy_from_slice(values);
    }
    let hypothesis = |c: &HypothesisValues| &problem.hypotheses[c.hypothesis];
    let mut coordinates: Vec<FitCoordinate> = Vec::new();
    // coordinates begin with the tolerance parameters, in the order of the problem
    for (i, t) in problem.tolerances.iter().enumerate() {
        let mut c = FitCoordinate::plain(i, t.sigma, t.min, t.max);
        c.prior = (!t.free).then_some((t.nominal / t.sigma, 1.0));
        coordinates.push(c);
    }
    let mut own = 0;
    for (k, (cause, places)) in causes.iter().zip(&model.attached).enumerate() {
        let h = hypothesis(cause);
        // a parameter out of tolerance loses its prior; it counts as one coefficient
        if h.family == "parameter" {
            coordinates[places[0]].prior = None;
            own += 1;
            continue;
        }
        let (linear, shaped) = places.split_at(h.coefficients.len());
        let coefficients = h.coefficients.iter().zip(linear).filter_map(|(c, &p)| coefficient(c, p));
        let is_taken = k < taken;
        let shapes = h.shapes.iter().zip(shaped).filter_map(|(s, &p)| shape(s, p, is_taken));
        let of_cause: Vec<FitCoordinate> = coefficients.chain(shapes).collect();
        // a width has a prior and does not count as a coefficient
        own += of_cause.iter().filter(|c| c.prior.is_none()).count();
        coordinates.extend(of_cause);
    }
    // where a recording begins, errors within the sensors' accuracy count as one deviation
    let deviation = |(n, f): (&f64, &f64)| n.max(ACCURACY * f);
    let deviations = problem.noise_floor.iter().zip(&problem.full_scale).map(deviation).collect();
    let units = problem.signals.iter().map(|s| problem.unit(s)).collect();
    let (off, allowed) = (Vec::new(), Vec::new());
    Ok(CandidateModel { causes: causes.to_vec(), taken, model, coordinates, own, units, deviations, off, allowed })
}

/// The coordinate of a coefficient. `None` for a share of a whole, which is not free: the effect is there or not.
fn coefficient(c: &EffectCoefficient, parameter: usize) -> Option<FitCoordinate> {
    let bound = |b: Option<f64>, none: f64| b.unwrap_or(none);
    let free = c.whole().is_none();
    free.then(|| {
        FitCoordinate::plain(parameter, c.nominal.abs(), bound(c.min, f64::NEG_INFINITY), bound(c.max, f64::INFINITY))
    })
}

/// The coordinate of a shape; `None` if it is fixed.
///
/// A shape with a single grid value is a width. It is free only in an accepted effect (`is_taken`), so that no second
/// effect makes up for a corner of another form. Its prior is one factor of ten.
fn shape(s: &ShapeParameter, parameter: usize, is_taken: bool) -> Option<FitCoordinate> {
    let (least, most) = s.grid.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(*x), m.max(*x)));
    let (min, max) = (s.min.unwrap_or(f64::NEG_INFINITY), s.max.unwrap_or(f64::INFINITY));
    if s.grid.len() < 2 {
        let free = is_taken && least > 0.0;
        return free.then(|| {
            // a width may be as large as what occurs at its place, since it then rounds all of the law
            let widest = s.occurs.unwrap_or(0.0).max(most * WIDER);
            let width = FitCoordinate::by_logarithm(parameter, min.max(least / WIDER), max.min(widest));
            FitCoordinate { prior: Some((least.ln(), WIDER.ln())), ..width }
        });
    }
    // a positive shape may be off by orders of magnitude, so it is fitted by its logarithm
    Some(if least > 0.0 {
        FitCoordinate::by_logarithm(parameter, min.max(least / BEYOND), max.min(most * BEYOND))
    } else {
        let width = most - least;
        FitCoordinate::plain(parameter, width, min.max(least - width), max.min(most + width))
    })
}

/// Starting values of a hypothesis, one list for each combination of grid values: coefficients first, then shapes.
/// Coefficients start where the effect vanishes, shares as the whole. Of more than [`GRID`] combinations some are left
/// out.
pub fn beginnings(h: &Hypothesis) -> Vec<Vec<f64>> {
    // an effect that changes the order of the model has no linear model at its off value
    let size = if h.changes_order { 1.0 } else { 0.0 };
    let value = |c: &EffectCoefficient| match c.whole() {
        Some(whole) => whole,
        None => (c.off + size * c.nominal).clamp(c.min.unwrap_or(f64::MIN), c.max.unwrap_or(f64::MAX)),
    };
    let with = |variant: Vec<(String, f64)>| -> Vec<f64> {
        h.coefficients.iter().map(value).chain(variant.into_iter().map(|v| v.1)).collect()
    };
    let mut all: Vec<Vec<f64>> = h.variants().into_iter().map(with).collect();
    let count = all.len();
    // spread evenly, the first and the last combination included
    if count > GRID {
        all = (0..GRID).map(|i| all[i * (count - 1) / (GRID - 1)].clone()).collect();
    }
    all
}
