//! Profile likelihood: how far one parameter can be moved while the others are searched for anew.
//!
//! The errors resemble their neighbours, so the sum of squares alone would not be a likelihood: its rise is scaled to the
//! curvature that the corrected deviations say. Source: R. E. Chandler, S. Bate, Biometrika 94 (2007) 167.

use super::chance::student;
use super::least_squares::{StoppingCriteria, VariableBounds, minimise};
use super::{BorrowedResiduals, Identification, ParameterFit, WeightedResiduals};
use bramah_syntax::diag::Diagnostic;

/// How the fit gets worse as one parameter moves.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileLikelihood {
    /// Index of the parameter.
    pub parameter: usize,
    /// Its values, growing, and the rise of twice the negative log-likelihood there, 0 at the estimate.
    pub points: Vec<(f64, f64)>,
    /// The 95 % interval: where the rise is the square of Student's 97.5 % point (3.84 for many degrees of
    /// freedom). Infinite on a side where it does not get there.
    pub interval: (f64, f64),
}

/// Searches along one side at most.
const TRIES: usize = 16;
/// Steps to where the deviation says that the level is, so that the profile shows its form.
const STEPS: f64 = 4.0;
/// As far in these steps, at three deviations for many degrees of freedom; beyond, steps grow.
const EVEN: f64 = 1.5;
/// A crossing counts as found within this part of the level's root.
const NEAR: f64 = 0.02;

impl Identification<'_> {
    /// The profile of one parameter around the fit.
    ///
    /// # Errors
    /// As [`Identification::fit`].
    pub fn profile(&self, fit: &ParameterFit, parameter: usize) -> Result<ProfileLikelihood, Diagnostic> {
        match self.inverse_model()? {
            Some(mut model) => Ok(self.along(&mut model, fit, parameter)),
            None => Ok(self.along(&mut self.output_error()?, fit, parameter)),
        }
    }

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

struct ProfileWalk<'a, 'm> {
    model: &'m mut dyn WeightedResiduals,
    bounds: VariableBounds,
    fit: &'a ParameterFit,
    parameter: usize,
}

impl ProfileWalk<'_, '_> {
    /// Points seen on one side, in even steps until the level is passed, and where the rise reaches it.
    fn side(&mut self, sign: f64) -> (Vec<(f64, f64)>, Option<f64>) {
        let centre = self.fit.z[self.parameter];
        let limit = if sign > 0.0 { self.bounds.high[self.parameter] } else { self.bounds.low[self.parameter] };
        let room = (limit - centre).abs();
        let target = student(self.fit.degrees[self.parameter]);
        let usual = self.fit.spread[self.parameter].sqrt() * target;
        let usual = if usual.is_finite() && usual > 0.0 { usual.min(3.0) } else { 1.0 };
        let even = usual / STEPS;
        let mut step = even.min(room);
        let mut seen = Vec::new();
        let mut warm = self.fit.z.clone();
        // roots of the rise, nearly straight over the distance
        let (mut inside, mut outside) = ((0.0, 0.0), None::<(f64, f64)>);
        for _ in 0..TRIES {
            if step <= 0.0 {
                break;
            }
            let root = match self.rise(centre + sign * step, &warm) {
                Some((rise, z)) => {
                    seen.push((centre + sign * step, rise));
                    warm = z;
                    rise.sqrt()
                }
                // beyond what the model can run with
                None => f64::INFINITY,
            };
            if (root - target).abs() <= NEAR * target {
                return (seen, Some(centre + sign * step));
            }
            if root < target {
                inside = (step, root);
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

    /// The rise where the parameter is held at `z`, and all unknowns there.
    fn rise(&mut self, z: f64, warm: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut start = warm.to_vec();
        start[self.parameter] = z;
        let mut bounds = self.bounds.clone();
        (bounds.low[self.parameter], bounds.high[self.parameter]) = (z, z);
        let found = minimise(
            &mut BorrowedResiduals(self.model),
            &start,
            &bounds,
            StoppingCriteria { iterations: 20, ..StoppingCriteria::default() },
        )?;
        let rise = found.residual.norm_squared() - self.fit.cost;
        Some((rise.max(0.0) * self.fit.plain[self.parameter] / self.fit.spread[self.parameter], found.z))
    }
}

fn between(inside: (f64, f64), outside: (f64, f64), target: f64) -> f64 {
    inside.0 + (outside.0 - inside.0) * (target - inside.1) / (outside.1 - inside.1)
}

/// The next distance to look at.
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
