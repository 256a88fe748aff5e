//! The hypotheses of one step as models that are fitted.

use super::super::effects::Coefficient;
use super::super::estimate::Fit;
use super::super::hypotheses::Hypothesis;
use super::super::policy::FRONT;
use super::super::problem::Problem;
use super::compare::Sensors;
use super::criteria::Rival;
use super::screen::Screened;
use super::weighed::{Weighed, at_the_noise, from_nominal, no_worse};
use rayon::prelude::*;

/// Fits from all starts, beside the model before; the front by both weightings.
pub fn fitted(problem: &Problem<'_>, sensors: &Sensors, before: &Fit, screened: Vec<Screened>) -> Vec<Rival> {
    let one = |(hypothesis, starts): Screened| {
        let fits = starts.into_iter().filter_map(|s| no_worse(problem, before, s.candidate, s.x));
        let fit = fits.reduce(Fit::better_of)?;
        let h = &problem.hypotheses[hypothesis];
        let (places, is_parameter) = (h.attachments.len(), h.family == "parameter");
        Some(Rival { hypothesis, places, size: 0.0, is_parameter, model: Weighed::new(problem, fit) })
    };
    let mut rivals: Vec<Rival> = screened.into_par_iter().filter_map(one).collect();
    rivals.sort_by(|a, b| a.model.gap(sensors).total_cmp(&b.model.gap(sensors)));
    let front = FRONT.min(rivals.len());
    rivals[..front].par_iter_mut().for_each(|rival| {
        for other in [from_nominal, at_the_noise] {
            if let Some(better) = other(problem, sensors, &rival.model) {
                rival.model = better;
            }
        }
    });
    rivals.par_iter_mut().for_each(|r| r.size = size(problem, &problem.hypotheses[r.hypothesis], &r.model.fit));
    rivals
}

/// By how many of its standard deviations the largest free coefficient of a model's last cause differs from nothing; a
/// parameter that is said to be out of tolerance from its data sheet, what is known of both counted.
fn size(problem: &Problem<'_>, h: &Hypothesis, fit: &Fit) -> f64 {
    let Some(places) = fit.candidate.model.attached.last().filter(|_| !h.is_shape()) else { return f64::INFINITY };
    let deviations = fit.deviations();
    if let ("parameter", Some(&k)) = (h.family.as_str(), places.first()) {
        let t = &problem.tolerances[k];
        return (fit.x[k] - t.nominal / t.sigma).abs() / deviations[k].hypot(1.0);
    }
    let coordinates = &fit.candidate.coordinates;
    let one = |(c, &place): (&Coefficient, &usize)| {
        let k = coordinates.iter().position(|own| own.parameter == place)?;
        let off = (fit.x[k] - coordinates[k].of(c.off)).abs();
        Some(if off > 0.0 { off / deviations[k] } else { 0.0 })
    };
    h.coefficients.iter().zip(places).filter_map(one).reduce(f64::max).unwrap_or(f64::INFINITY)
}
