//! A search from several places, so that a least value near the start is not taken for the least of all.

use super::{IdentificationProblem, LeastSquaresSolution, WeightedResiduals, search, search_once};
use crate::sweep::XorshiftGenerator;

/// Where searches from several places ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MultistartSummary {
    /// How many places there were, the values of the model among them.
    pub tried: usize,
    /// How many ended where the best one did: sums of squares within a thousandth.
    pub here: usize,
    /// How many ended at a larger sum of squares.
    pub worse: usize,
    /// How many places the model could not be run at.
    pub failed: usize,
}

/// Sums of squares that differ by less than this part are the same end.
const SAME: f64 = 1e-3;
/// How far a place lies at most from the model's value where neither bounds nor tolerances are closer: a factor of e
/// on a logarithmic scale, once the usual value on a linear one.
const REACH: f64 = 1.0;

/// Searches from the values of the model and from `count - 1` places around them, and goes on from the best end. The
/// same `seed` gives the same places.
pub(super) fn search_several(
    problem: &IdentificationProblem<'_>,
    model: &mut dyn WeightedResiduals,
    floor: &[f64],
    count: usize,
    seed: u64,
) -> Option<(LeastSquaresSolution, MultistartSummary)> {
    let unknowns = model.unknowns();
    let mut random = XorshiftGenerator::new(seed);
    // the first end sets the scale by which all are compared
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
    let stays = cost(&ends[0]) <= (1.0 + SAME) * least;
    let found = if stays { ends.swap_remove(0) } else { search(problem, model, floor, &ends[best].z)? };
    Some((found, starts))
}

/// A place within the bounds, and within three deviations of what is known beforehand; initial states as the model has
/// them.
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
