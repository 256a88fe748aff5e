//! Identifiability: which parameters and which combinations of them the data can determine, before a fit.
//!
//! The information matrix J'J of the parameters enters (weighted sensitivities at the start values); an
//! [`IdentifiabilityAnalysis`] leaves. Its eigenvectors with small eigenvalues are directions in which the parameters
//! can move without a visible effect. `fit` uses the same analysis to find infinite variances.

use nalgebra::{DMatrix, DVector};
use petgraph::unionfind::UnionFind;

/// A direction in z along which the data do not see a movement.
#[derive(Clone, Debug, PartialEq)]
pub struct UnidentifiableDirection {
    /// Indices of the parameters that take part, strongest first; ascending where several directions share them.
    pub group: Vec<usize>,
    /// The direction in z, of length 1, with one entry for each parameter.
    pub direction: Vec<f64>,
    /// One standard deviation along it, in z; infinite where the data do not see it at all.
    pub deviation: f64,
}

/// The outcome for p parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiabilityAnalysis {
    /// How many independent combinations the data determine: p minus the number of `blind` directions.
    pub rank: usize,
    /// Ratio of the largest to the smallest singular value of the sensitivities, with columns scaled to length 1.
    /// Infinite where a parameter has no influence.
    pub condition: f64,
    /// The directions that the data cannot determine.
    pub blind: Vec<UnidentifiableDirection>,
    /// One standard deviation of each parameter in z from the data alone, with the other parameters estimated too.
    pub deviation: Vec<f64>,
}

/// An eigenvalue below this share of the largest one is zero, within the accuracy of differences of runs.
const ALIKE: f64 = 1e-7;
/// A parameter takes part in a direction from this share of the largest entry on.
const SHARE: f64 = 0.1;

/// Analyses `information`, J'J by z with initial states eliminated (see [`without_rest`]).
pub fn separate(information: &DMatrix<f64>) -> IdentifiabilityAnalysis {
    let p = information.nrows();
    let size: Vec<f64> = (0..p).map(|j| information[(j, j)].max(0.0).sqrt()).collect();
    // size is the inverse of a deviation in z. Up to 1 it means: even a movement by the entire usual value would hide
    // in the noise, so the parameter has no influence.
    let seen: Vec<usize> = (0..p).filter(|&j| size[j] > 1.0).collect();
    let mut blind: Vec<UnidentifiableDirection> = (0..p)
        .filter(|j| !seen.contains(j))
        .map(|j| UnidentifiableDirection { group: vec![j], direction: unit(p, j), deviation: 1.0 / size[j] })
        .collect();
    // Columns scaled to length 1: what remains are the cosines of the angles between them.
    let alike = DMatrix::from_fn(seen.len(), seen.len(), |a, b| {
        information[(seen[a], seen[b])] / (size[seen[a]] * size[seen[b]])
    });
    // nalgebra cannot decompose an empty matrix.
    if seen.is_empty() {
        let deviation = size.iter().map(|s| 1.0 / s).collect();
        return IdentifiabilityAnalysis { rank: 0, condition: f64::INFINITY, blind, deviation };
    }
    let eigen = alike.symmetric_eigen();
    let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let smallest = eigen.eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
    let mut variance = vec![0.0; p];
    for (k, &value) in eigen.eigenvalues.iter().enumerate() {
        // Back from scaled columns to z.
        let mut direction = DVector::zeros(p);
        seen.iter().enumerate().for_each(|(a, &j)| direction[j] = eigen.eigenvectors[(a, k)] / size[j]);
        let length = direction.norm();
        let hidden = value < ALIKE * largest;
        let deviation = if hidden { f64::INFINITY } else { length / value.sqrt() };
        // The inverse by its eigenvalues: the variance of each parameter is the sum over all directions.
        for j in 0..p {
            variance[j] += if direction[j] == 0.0 { 0.0 } else { direction[j].powi(2) / value.max(0.0) };
        }
        // A combination that may move by more than its entire value is as good as unknown.
        if deviation > 1.0 {
            let direction: Vec<f64> = direction.iter().map(|d| d / length).collect();
            blind.push(UnidentifiableDirection { group: group(&direction), direction, deviation });
        }
    }
    merge_hidden(&mut blind, p);
    (0..p).filter(|j| !seen.contains(j)).for_each(|j| variance[j] = size[j].powi(-2));
    IdentifiabilityAnalysis {
        rank: p - blind.len(),
        condition: if seen.len() < p || smallest <= 0.0 { f64::INFINITY } else { (largest / smallest).sqrt() },
        blind,
        deviation: variance.into_iter().map(f64::sqrt).collect(),
    }
}

/// The unit vector of parameter `j` among `p`.
fn unit(p: usize, j: usize) -> Vec<f64> {
    (0..p).map(|i| f64::from(u8::from(i == j))).collect()
}

/// The parameters with at least [`SHARE`] of the largest entry of a direction, strongest first.
fn group(direction: &[f64]) -> Vec<usize> {
    let most = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
    let mut group: Vec<usize> = (0..direction.len()).filter(|&j| direction[j].abs() >= SHARE * most).collect();
    group.sort_by(|&a, &b| direction[b].abs().total_cmp(&direction[a].abs()));
    group
}

/// Gives unseen directions that share parameters one common group.
///
/// Several unseen directions span a space whose basis is arbitrary and depends on rounding; the union of their
/// parameters does not.
fn merge_hidden(blind: &mut [UnidentifiableDirection], parameters: usize) {
    let hidden: Vec<&mut UnidentifiableDirection> =
        blind.iter_mut().filter(|b| b.deviation.is_infinite() && !b.group.is_empty()).collect();
    let mut sets = UnionFind::<usize>::new(parameters);
    for b in &hidden {
        b.group.windows(2).for_each(|pair| _ = sets.union(pair[0], pair[1]));
    }
    let set: Vec<usize> = hidden.iter().map(|b| sets.find(b.group[0])).collect();
    for (b, own) in hidden.into_iter().zip(&set) {
        if set.iter().filter(|other| *other == own).count() > 1 {
            b.group = (0..parameters).filter(|&j| sets.find(j) == *own).collect();
        }
    }
}

/// Eliminates the unknowns after the first `keep` from an information matrix, by the Schur complement.
///
/// The result is the information about the first ones when the others are estimated too.
pub fn without_rest(information: &DMatrix<f64>, keep: usize) -> DMatrix<f64> {
    let rest = information.nrows() - keep;
    let own = information.view((0, 0), (keep, keep)).into_owned();
    if rest == 0 {
        return own;
    }
    let cross = information.view((0, keep), (keep, rest)).into_owned();
    match information.view((keep, keep), (rest, rest)).into_owned().cholesky() {
        Some(inner) => own - &cross * inner.solve(&cross.transpose()),
        // Singular: the rest is not determined, and nothing can be eliminated.
        None => own,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_that_act_alike_and_parameters_without_influence() {
        // the first two act as their sum, the third alone, the fourth not at all
        let jacobian = DMatrix::from_fn(50, 4, |t, j| {
            let t = t as f64;
            [1e3 * (0.1 * t).sin(), 1e3 * (0.1 * t).sin(), 10.0 * t, 0.0][j]
        });
        let found = separate(&jacobian.tr_mul(&jacobian));
        assert_eq!(found.rank, 2);
        let groups: Vec<Vec<usize>> = found.blind.iter().map(|b| b.group.clone()).collect();
        assert!(groups[0] == [3] && (groups[1] == [0, 1] || groups[1] == [1, 0]), "{groups:?}");
        assert!(found.deviation[2] < 1e-2 && found.deviation[3].is_infinite());
    }

    #[test]
    fn parameters_that_all_have_no_influence() {
        let found = separate(&DMatrix::zeros(2, 2));
        assert_eq!((found.rank, found.blind.len()), (0, 2));
        assert!(found.blind.iter().all(|b| b.deviation.is_infinite()));
    }

    #[test]
    fn unknowns_that_are_found_too_cost_information() {
        let jacobian = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 0.0]);
        let left = without_rest(&jacobian.tr_mul(&jacobian), 1);
        assert!((left[(0, 0)] - 1.0).abs() < 1e-12);
    }
}
