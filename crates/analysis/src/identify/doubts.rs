//! Warnings about a study that does not fit its recordings: columns with another sign or unit, and signals that the fit
//! predicts worse than a constant would.
//!
//! Measured and modelled signals enter ([`SignalTrajectory`], [`SignalFit`]); diagnostics leave. `foreign` runs before
//! the fit, [`doubts`] after it. Both compare a signal with a multiple of the model's, by linear regression.

use super::{IdentificationProblem, IdentifyMethod, ParameterFit, SignalFit, SignalTrajectory};
use bramah_results::number::rounded;
use bramah_syntax::diag::{Code, Diagnostic};

/// A relative error of 1 is that of a constant. Noise and sampling may add a little, so warnings begin above it.
const CONSTANT: f64 = 1.05;
/// A multiple of the model is reported when it explains at least this share of the measured variance.
const EXPLAINED: f64 = 0.5;

/// A factor between measurement and model above this, or below its inverse, points to another unit.
const FAR: f64 = 300.0;

/// Warnings ([`Code::ForeignColumn`]) about signals that follow the run with the model's own values, but with the
/// opposite sign or a far larger or smaller size.
pub(super) fn foreign(problem: &IdentificationProblem<'_>, trajectories: &[SignalTrajectory]) -> Vec<Diagnostic> {
    let strange = |f: &f64| *f < 0.0 || !(1.0 / FAR..FAR).contains(f);
    let found = trajectories.iter().filter_map(|c| Some((c, multiple(c).filter(strange)?)));
    found.map(|(trajectory, factor)| suspicion(problem, trajectory, factor)).collect()
}

/// The warning about one signal whose measured values are `factor` times those of the model.
fn suspicion(problem: &IdentificationProblem<'_>, trajectory: &SignalTrajectory, factor: f64) -> Diagnostic {
    let times = rounded(factor, 3);
    let text = format!("`{}` goes {times} times as in a run with the values of the model", trajectory.name);
    let d = Diagnostic::new(Code::ForeignColumn, text);
    let d = match problem.bound.signals.iter().find(|s| s.name == trajectory.name) {
        Some(signal) => d.at(signal.entry.span, "compared here"),
        None => d,
    };
    let cause = match (factor < 0.0, (1.0 / FAR..FAR).contains(&factor.abs())) {
        (true, true) => "a `sign`, of this column or of an input",
        (true, false) => "a `sign` and a `unit`, of this column or of an input",
        _ => "a `unit`, of this column or of an input",
    };
    d.help(format!("likely causes: {cause}; a parameter of the model that is far off"))
}

/// Warnings ([`Code::WorseThanConstant`]) about signals whose errors exceed their own standard deviation, on the train
/// recordings or on the held ones.
pub fn doubts(problem: &IdentificationProblem<'_>, fit: &ParameterFit, held: &[SignalFit]) -> Vec<Diagnostic> {
    let roles = [("train", fit.train.as_slice()), ("held", held)];
    let found = roles.into_iter().flat_map(|(role, fits)| fits.iter().map(move |f| (role, f)));
    let doubtful = found.filter(|(_, f)| f.relative > CONSTANT);
    doubtful.map(|(role, signal)| doubt(problem, fit, role, signal)).collect()
}

/// The warning about one signal, with likely causes. `role` is `train` or `held`.
fn doubt(problem: &IdentificationProblem<'_>, fit: &ParameterFit, role: &str, signal: &SignalFit) -> Diagnostic {
    let (name, share) = (&signal.name, rounded(100.0 * signal.relative, 3));
    let text = format!("`{name}` is met worse than by a constant: on {role} recordings the error is {share} %");
    let mut d = Diagnostic::new(Code::WorseThanConstant, text).note("in parts of the signal's own deviation");
    let span = problem.bound.signals.iter().find(|s| s.name == *name).map(|s| s.entry.span);
    if let Some(span) = span {
        d = d.at(span, "compared here");
    }
    // The inverse model has no trajectories of signals to compare.
    let trajectory = fit.trajectories.iter().find(|c| c.name == *name && fit.method == IdentifyMethod::Output);
    if let Some(factor) = trajectory.and_then(multiple) {
        d = d.help(advice(factor));
    }
    let held: Vec<&str> = problem.bound.inputs.iter().filter(|i| i.entry.hold).map(|i| i.entry.name.as_str()).collect();
    let hold = match held[..] {
        [] => "`hold` of an input (now all are joined by straight lines)".to_owned(),
        _ => format!("`hold` of an input (now each sample of {} holds until the next)", held.join(", ")),
    };
    d.help(format!("likely causes: {hold}, the `sign` or `unit` of a column, a wrong column"))
        .help("where the columns are right the search may have ended far off: try `--starts 12`, or `pieces`")
}

/// The regression coefficient of the measured values on the modelled ones, both without their means.
///
/// `None` where the regression explains half of the measured variance or less.
fn multiple(trajectory: &SignalTrajectory) -> Option<f64> {
    let n = trajectory.measured.len() as f64;
    let modelled: Vec<f64> = trajectory.measured.iter().zip(&trajectory.errors).map(|(m, e)| m + e).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (a, b) = (mean(&trajectory.measured), mean(&modelled));
    let pairs = trajectory.measured.iter().zip(&modelled).map(|(m, s)| (m - a, s - b));
    let (mut own, mut both, mut other) = (0.0, 0.0, 0.0);
    for (m, s) in pairs {
        (own, both, other) = (own + m * m, both + m * s, other + s * s);
    }
    // The squared correlation coefficient.
    let explained = both * both / (own * other);
    (explained > EXPLAINED).then(|| both / other)
}

/// The help text for a factor between measurement and model.
fn advice(factor: f64) -> String {
    let times = rounded(factor, 3);
    if factor < 0.0 {
        format!("what was measured goes {times} times as the model goes: its `sign` may be wrong, or that of an input")
    } else {
        format!("what was measured goes {times} times as the model goes: a `unit` may be wrong")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory(factor: f64) -> SignalTrajectory {
        let modelled: Vec<f64> = (0..50).map(|k| (0.3 * f64::from(k)).sin()).collect();
        let measured: Vec<f64> = modelled.iter().map(|m| 5.0 + factor * m).collect();
        let errors = modelled.iter().zip(&measured).map(|(s, m)| s - m).collect();
        SignalTrajectory { name: "y".into(), unit: "1".into(), times: vec![0.0; 50], measured, errors }
    }

    #[test]
    fn factors_are_seen_and_told() {
        for factor in [-1.0, 1000.0] {
            assert!((multiple(&trajectory(factor)).expect("a multiple") / factor - 1.0).abs() < 1e-9);
        }
        assert!(advice(-1.0).contains("`sign`") && advice(1000.0).contains("`unit`"));
        let mut other = trajectory(1.0);
        other.errors = other.measured.iter().enumerate().map(|(k, m)| (k as f64).sqrt() - m).collect();
        assert_eq!(multiple(&other), None);
    }
}
