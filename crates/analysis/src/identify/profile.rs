//! Profile likelihood: how the fit gets worse when one parameter is held away from its estimate and the others are
//! estimated anew.
//!
//! A fit and the index of a parameter enter; a [`ProfileLikelihood`] leaves, for `--profile`. Errors are correlated, so
//! the sum of squares is no likelihood: its rise is scaled by the ratio of the white to the corrected variance. Source:
//! R. E. Chandler, S. Bate, Biometrika 94 (2007) 167.

use super::chance::student;
use super::least_squares::{StoppingCriteria, VariableBounds, minimise};
use super::{BorrowedResiduals, Identification, ParameterFit, WeightedResiduals};
use bramah_syntax::diag::Diagnostic;

/// The profile of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileLikelihood {
    /// Index of the parameter in [`super::IdentificationProblem::free`].
    pub parameter: usize,
    /// Values of the parameter in its unit, ascending, each with the rise of twice the negative log-likelihood (0 at
    /// the estimate).
    pub points: Vec<(f64, f64)>,
    /// The 95 % interval: where the rise reaches the square of Student's 97.5 % quantile (3.84 for many degrees of
    /// freedom). Infinite on a side where the rise stays below.
    pub interval: (f64, f64),
}

/// Largest number of searches on one side.
const TRIES: usize = 16;
/// The distance at which the standard deviation predicts the level is divided into so many steps, which show the shape
/// of the profile.
const STEPS: f64 = 4.0;
/// Steps stay equal up to this multiple of that distance, and grow beyond it.
const EVEN: f64 = 1.5;
/// Tolerance of the crossing, relative to the root of the level.
const NEAR: f64 = 0.02;

impl Identification<'_> {
    /// Computes the profile of one parameter around the fit.
    ///
    /// # Errors
    /// As [`Identification::fit`].
    pub fn profile(&self, fit: &ParameterFit, parameter: usize) -> Result<ProfileLikelihood, Diagnostic> {
        match self.inverse_model()? {
            Some(mut model) => Ok(self.along(&mut model, fit, parameter)),
            None => Ok(self.along(&mut self.output_error()?, fit, parameter)),
        }
    }

    /// Walks both sides of the estimate with the weights of the fit.
    fn along(&self, model: &mut dyn WeightedResiduals, fit: &ParameterFit, parameter: usize) -> ProfileLikelihood {
        model.weights().clone_from(&fit.weights);
        let bounds = self.problem.bounds(fit.z.len());
        let mut walk = ProfileWalk { model, bounds, fit, parameter };
        let free = &self.problem.free[parameter];
        let mut points = vec![(fit.values[parameter], 0.0)];
        let mut side = |sign: f64| {
            let (seen, end) = walk.side(sign);
            points.extend(seen.into_iter().map(|(z, rise)| (free.value(z), rise)));
            end.map(|z| free.value(z))
        };
        let (low, high) = (side(-1.0), side(1.0));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let interval = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
        ProfileLikelihood { parameter, points, interval }
    }
}

/// The search along one parameter.
struct ProfileWalk<'a, 'm> {
    /// The residual, with the weights of the fit.
    model: &'m mut dyn WeightedResiduals,
    /// Bounds of all unknowns in z.
    bounds: VariableBounds,
    /// The fit that the profile belongs to.
    fit: &'a ParameterFit,
    /// Index of the parameter held.
    parameter: usize,
}

impl ProfileWalk<'_, '_> {
    /// Walks to one side (`sign` 1 or -1) of the estimate.
    ///
    /// Returns the points seen, each with z and its rise, and z where the rise reaches the level; `None` where it does
    /// not.
    fn side(&mut self, sign: f64) -> (Vec<(f64, f64)>, Option<f64>) {
        let centre = self.fit.z[self.parameter];
        let limit = if sign > 0.0 { self.bounds.high[self.parameter] } else { self.bounds.low[self.parameter] };
        // Distances are measured from the estimate; the bound limits them.
        let room = (limit - centre).abs();
        let target = student(self.fit.degrees[self.parameter]);
        let usual = self.fit.spread[self.parameter].sqrt() * target;
        // Without a finite deviation the walk starts with one usual value of the parameter.
        let usual = if usual.is_finite() && usual > 0.0 { usual.min(3.0) } else { 1.0 };
        let even = usual / STEPS;
        let mut step = even.min(room);
        let mut seen = Vec::new();
        let mut warm = self.fit.z.clone();
        // The root of a quadratic rise is linear in the distance, so roots are interpolated.
        let (mut inside, mut outside) = ((0.0, 0.0), None::<(f64, f64)>);
        for _ in 0..TRIES {
            if step <= 0.0 {
                break;
            }
            let root = match self.rise(centre + sign * step, &warm) {
                Some((rise, z)) => {
                    seen.push((centre + sign * step, rise));
                    // The next search starts from this end, which is close to its own.
                    warm = z;
                    rise.sqrt()
                }
                // The model cannot run there: a wall, which bisection approaches.
                None => f64::INFINITY,
            };
            if (root - target).abs() <= NEAR * target {
                return (seen, Some(centre + sign * step));
            }
            if root < target {
                inside = (step, root);
                // The bound lies below the level: the interval is open on this side.
                if step >= room {
                    break;
                }
            } else {
                outside = Some((step, root));
            }
            step = match outside {
                None if step + 0.5 * even < EVEN * usual => step + even,
                _ => next(inside, outside, target),
            }
            .min(room);
        }
        let crossing = outside.filter(|o| o.1.is_finite()).map(|o| centre + sign * between(inside, o, target));
        (seen, crossing)
    }

    /// The scaled rise with the parameter held at `z`, and all unknowns there. The search starts at `warm`. `None`
    /// where the model cannot be run.
    fn rise(&mut self, z: f64, warm: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut start = warm.to_vec();
        start[self.parameter] = z;
        let mut bounds = self.bounds.clone();
        // Equal bounds hold the parameter.
        (bounds.low[self.parameter], bounds.high[self.parameter]) = (z, z);
        let found = minimise(
            &mut BorrowedResiduals(self.model),
            &start,
            &bounds,
            StoppingCriteria { iterations: 20, ..StoppingCriteria::default() },
        )?;
        // plain/spread scales the curvature of the sum of squares to the corrected variance.
        let rise = found.residual.norm_squared() - self.fit.cost;
        Some((rise.max(0.0) * self.fit.plain[self.parameter] / self.fit.spread[self.parameter], found.z))
    }
}

/// The distance at which the straight line through two (distance, root) pairs reaches the target.
fn between(inside: (f64, f64), outside: (f64, f64), target: f64) -> f64 {
    inside.0 + (outside.0 - inside.0) * (target - inside.1) / (outside.1 - inside.1)
}

/// The next distance to try.
///
/// Without a point outside it extrapolates, with one it interpolates but keeps off both ends, and at a wall it bisects.
fn next(inside: (f64, f64), outside: Option<(f64, f64)>, target: f64) -> f64 {
    match outside {
        None => inside.0 * (1.05 * target / inside.1.max(1e-9)).clamp(1.2, 3.0),
        Some(o) if o.1.is_finite() => {
            let width = o.0 - inside.0;
            between(inside, o, target).clamp(inside.0 + 0.1 * width, o.0 - 0.1 * width)
        }
        Some(o) => 0.5 * (inside.0 + o.0),
    }
}
