//! Hypotheses about errors of the recordings: a wrong sign or a wrong unit of a column.
//!
//! Such an error has nothing to fit, so it is the simplest of all hypotheses. Enters: the problem and the library.
//! Leaves: hypotheses that scale a signal or an input by a fixed factor. Called by `study`.
//!
//! The factors are those between units that exist for the quantity of the column, and powers of ten for a shifted
//! point. They are tried in the first step of a search only, before any effect is accepted.

use super::circuit::same_kind;
use super::effects::{EffectCoefficient, EffectModel};
use super::hypotheses::{
    AttachmentSite, CoefficientSharing, EffectAttachment, Hypothesis, MissingQuantity, NetworkLocation,
};
use super::problem::DiagnosisProblem;
use std::sync::Arc;

/// Family of these hypotheses.
pub const FAMILY: &str = "recording_error";

/// Class of the effect that scales a signal by 1 + k.
const SENSOR: &str = "Effects.SensorGain";
/// Class of the effect that scales an input by 1 + k.
const COMMAND: &str = "Effects.CommandGain";

/// Units that are confused: an SI unit, and the size of each other unit in it.
const UNITS: &[(&str, &[f64])] = &[
    ("rad", &[std::f64::consts::PI / 180.0, std::f64::consts::TAU]),
    ("rad/s", &[std::f64::consts::PI / 30.0, std::f64::consts::PI / 180.0, std::f64::consts::TAU]),
    ("Pa", &[1e2, 1e3, 1e5, 1e6, 6_894.757_293_168]),
    ("m3/s", &[1.0 / 6e4, 1.0 / 3.6e3, 1e-3, 1e-6, 1e-6 / 60.0, 6.309_019_64e-5]),
    ("m", &[1e-2, 1e-3, 0.0254]),
    ("m/s", &[1.0 / 3.6, 1e-2, 1e-3]),
    ("N", &[1e3, 9.806_65, 4.448_221_615]),
    ("N.m", &[1e-2, 1e-3, 1.355_817_948]),
    ("A", &[1e-3]),
    ("V", &[1e-3]),
    ("W", &[1e3]),
    // a ratio written in per cent
    ("1", &[1e-2]),
];
/// Factors of a column of any unit: a shifted decimal point.
const ANY: &[f64] = &[10.0, 1e3];
/// Temperatures below this are differences, K.
const COLD: f64 = 150.0;
/// Relative difference up to which factors are the same.
const SAME: f64 = 1e-3;

/// A wrong sign and every wrong unit of each signal and input. Empty if the library lacks the two gain effects.
/// For a temperature difference only the sign can be wrong.
pub fn mistakes(problem: &DiagnosisProblem<'_>, catalogue: &[Arc<EffectModel>]) -> Vec<Hypothesis> {
    let effect = |class: &str| catalogue.iter().find(|e| e.class == class).cloned();
    let (Some(sensor), Some(command)) = (effect(SENSOR), effect(COMMAND)) else { return Vec::new() };
    let signals = problem.signals.iter().zip(&problem.shown).enumerate().flat_map(|(i, (s, shown))| {
        let unit = problem.circuit.units.get(&s.variable).map_or("", String::as_str);
        let site = AttachmentSite::Sensor(s.name.clone());
        let factors = if is_rise(problem, i, unit) { vec![-1.0] } else { factors(unit, Some(1.0 / shown.factor)) };
        factors.into_iter().map(move |f| (site.clone(), s.name.clone(), f)).collect::<Vec<_>>()
    });
    let inputs = problem.circuit.inputs.iter().filter(|i| i.ty == bramah_model::flat::ScalarType::Real).flat_map(|i| {
        let site = AttachmentSite::Command(i.name.clone());
        factors(&i.unit, None).into_iter().map(move |f| (site.clone(), i.name.clone(), f)).collect::<Vec<_>>()
    });
    let signals = signals.map(|(site, name, f)| hypothesis(&sensor, site, &name, MissingQuantity::Sensor, f));
    let inputs = inputs.map(|(site, name, f)| hypothesis(&command, site, &name, MissingQuantity::Signal, f));
    signals.chain(inputs).collect()
}

/// Recorded over correct value of a hypothesis.
pub fn factor(h: &Hypothesis) -> f64 {
    1.0 + h.coefficients.first().and_then(|c| c.max).unwrap_or(0.0)
}

/// Whether a signal is a temperature difference: no machine has such low absolute temperatures.
fn is_rise(problem: &DiagnosisProblem<'_>, signal: usize, unit: &str) -> bool {
    let values = || problem.train.iter().flat_map(|r| r.signals[signal].iter()).filter(|v| v.is_finite());
    same_kind("K", unit) && values().all(|v| v.abs() < COLD)
}

/// Factors by which a column of a quantity may be wrong, the sign first, without repetitions.
/// `declared`: size of the study's unit in SI units; `None` if unknown. Empty for temperatures.
fn factors(unit: &str, declared: Option<f64>) -> Vec<f64> {
    // an absolute temperature cannot have a wrong sign, and its units differ by an offset, not only by a factor
    if same_kind("K", unit) {
        return Vec::new();
    }
    let own = || UNITS.iter().filter(|(u, _)| same_kind(u, unit)).flat_map(|(_, f)| f.iter().copied());
    let others: Vec<f64> = match declared {
        Some(declared) => own().chain([1.0]).map(|meant| declared / meant).collect(),
        // with an unknown unit both directions of a confusion are possible
        None => own().flat_map(|f| [f, 1.0 / f]).collect(),
    };
    let mut all = vec![-1.0];
    for f in others.into_iter().chain(ANY.iter().flat_map(|f| [*f, 1.0 / f])) {
        // two confusions of units may have the same factor
        let known = |k: &f64| (k / f - 1.0).abs() < SAME;
        if f.is_normal() && !known(&1.0) && !all.iter().any(known) {
            all.push(f);
        }
    }
    all
}

/// The hypothesis that a column is wrong by a factor: a gain 1 + k with k fixed at factor - 1.
fn hypothesis(
    effect: &Arc<EffectModel>,
    site: AttachmentSite,
    name: &str,
    kind: MissingQuantity,
    factor: f64,
) -> Hypothesis {
    let place = NetworkLocation { place: name.into(), node: vec![name.into()], kind };
    let attachment =
        EffectAttachment { effect: Some(effect.clone()), site, sense: vec![], base: vec![], temperature: None, place };
    let k = factor - 1.0;
    // equal bounds make the coefficient a share of a whole, which is not free
    let usual = |c: &EffectCoefficient| EffectCoefficient { min: Some(k), max: Some(k), nominal: k, ..c.clone() };
    Hypothesis {
        effect: effect.class.clone(),
        family: FAMILY.into(),
        attachments: vec![attachment],
        sharing: CoefficientSharing::Single,
        coefficients: effect.coefficients.iter().map(usual).collect(),
        shapes: Vec::new(),
        changes_order: false,
        passes: None,
    }
}

#[cfg(test)]
mod tests {
    use super::factors;

    #[test]
    fn units_that_exist_for_a_dimension() {
        let all = factors("rad/s", None);
        let has = |f: f64| all.iter().any(|x| (x / f - 1.0).abs() < 1e-9);
        assert!(has(-1.0) && has(30.0 / std::f64::consts::PI) && has(std::f64::consts::PI / 30.0) && has(0.1));
        assert!(!has(1e5));
        assert!(factors("degC", None).is_empty());
        assert!(factors("1", None).contains(&100.0) && factors("1", None).contains(&0.01), "per cent");
        assert!(factors("Pa", None).iter().filter(|f| (**f - 1e-3).abs() < 1e-9).count() == 1);
        // written in bar, meant in psi
        assert!(factors("Pa", Some(1e5)).iter().any(|f| (f / 14.503_773_77 - 1.0).abs() < 1e-6));
        assert!(!factors("Pa", Some(1e5)).contains(&1.0));
    }
}
