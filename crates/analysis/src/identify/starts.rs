//! Multistart: searches from several places, so that a local minimum near the start is recognised as such.
//!
//! A problem and a residual enter; the best minimum and a [`MultistartSummary`] leave.

use super::{IdentificationProblem, LeastSquaresSolution, WeightedResiduals, search, search_once};
use crate::sweep::XorshiftGenerator;

/// How many searches ended where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MultistartSummary {
    /// Number of searches, the one from the values of the model included.
    pub tried: usize,
    /// How many ended at the best sum of squares, within a thousandth.
    pub here: usize,
    /// How many ended at a larger one.
    pub worse: usize,
    /// How many could not run the model at their start.
    pub failed: usize,
}

/// Sums of squares within this relative difference count as the same minimum.
const SAME: f64 = 1e-3;
/// Largest distance in z between a random place and the model's values: a factor of e on a logarithmic scale, the usual
/// value on a linear one. Bounds and priors may make it smaller.
const REACH: f64 = 1.0;

/// Searches from the values of the model and from `count - 1` random places, and continues from the best end.
///
/// `floor` holds the smallest deviation of each signal. The same `seed` gives the same places. `None` when no search
/// found a minimum.
pub(super) fn search_several(
    problem: &IdentificationProblem<'_>,
    model: &mut dyn WeightedResiduals,
    floor: &[f64],
    count: usize,
    seed: u64,
) -> Option<(LeastSquaresSolution, MultistartSummary)> {
    let unknowns = model.unknowns();
    let mut random = XorshiftGenerator::new(seed);
    // Only this search learns the deviations of the signals. All others keep them, so that sums of squares are
    // comparable.
    let first = search(problem, model, floor, &vec![0.0; unknowns]);
    let mut ends: Vec<LeastSquaresSolution> = first.into_iter().collect();
    for _ in 1..count {
        let place = place(problem, unknowns, &mut random);
        model.loosen();
        ends.extend(search_once(problem, model, &place));
    }
    let cost = |end: &LeastSquaresSolution| end.residual.norm_squared();
    let best = (0..ends.len()).min_by(|&a, &b| cost(&ends[a]).total_cmp(&cost(&ends[b])))?;
    let least = cost(&ends[best]);
    let here = ends.iter().filter(|e| cost(e) <= (1.0 + SAME) * least).count();
    let starts =
        MultistartSummary { tried: count.max(1), here, worse: ends.len() - here, failed: count.max(1) - ends.len() };
    // Unless another end is clearly better, the result is the same as that of a single search.
    let stays = cost(&ends[0]) <= (1.0 + SAME) * least;
    let found = if stays { ends.swap_remove(0) } else { search(problem, model, floor, &ends[best].z)? };
    Some((found, starts))
}

/// A random place within the bounds and within three deviations of the priors; free states as the model has them.
fn place(problem: &IdentificationProblem<'_>, unknowns: usize, random: &mut XorshiftGenerator) -> Vec<f64> {
    let bounds = problem.bounds(unknowns);
    let mut z = vec![0.0; unknowns];
    for (j, free) in problem.free.iter().enumerate() {
        let reach = REACH.min(3.0 * free.prior);
        let (low, high) = (bounds.low[j].max(-reach), bounds.high[j].min(reach));
        z[j] = low + (high - low) * random.roll();
    }
    z
}
