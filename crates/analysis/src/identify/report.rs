//! The result of an identification as numbers (`result.json`) and as text for people.
//!
//! A problem, its fit, held scores and profiles enter; an [`IdentificationReport`] or a text leaves. The keys of
//! `result.json` are described in `docs/identify.md`.

use super::{
    Identification, IdentificationProblem, IdentifyMethod, MultistartSummary, ParameterFit, ProfileLikelihood,
    ResidualTest, SignalFit,
};
use bramah_results::number::rounded;
use serde::Serialize;
use serde_json::{Map, json};
use std::fmt::Write;

/// The contents of `result.json`, in the order of its keys.
#[derive(Clone, Debug, Serialize)]
pub struct IdentificationReport {
    /// `output error` or `inverse model`.
    pub method: &'static str,
    /// For each parameter its value, one standard deviation, degrees of freedom, 95 % interval and unit. `null` stands
    /// for an infinite number.
    pub parameters: Map<String, serde_json::Value>,
    /// Groups of parameters that the data cannot separate; a group of one has no influence.
    pub inseparable: Vec<Vec<String>>,
    /// Root mean square errors in the units of the signals.
    pub fit: FitErrors,
    /// The same, relative to the standard deviations of the signals.
    pub fit_relative: FitErrors,
    /// For each signal, over how many samples the errors on the train recordings are correlated.
    pub residual_correlation: Map<String, serde_json::Value>,
    /// For each signal the tests of the errors on the train recordings.
    pub residuals: Map<String, serde_json::Value>,
    /// Correlations of the estimates, in the order of `parameters`.
    pub correlation: Vec<Vec<f64>>,
    /// The profiles requested: 95 % interval (`null` on an open side) and points.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub profiles: Map<String, serde_json::Value>,
    /// `exact`, or `differences` and the reason.
    pub derivatives: String,
    /// How many of several searches ended where; empty for one search.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub starts: Map<String, serde_json::Value>,
    /// How the pieces of cut recordings join: the number of joints (`count`), and the largest `jump` left, relative to
    /// the range of its `state`. Empty where none is cut.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub joints: Map<String, serde_json::Value>,
    /// Whether a minimum was reached.
    pub converged: bool,
    /// Parameters that ended at a bound.
    pub at_bound: Vec<String>,
    /// Iterations of the search.
    pub iterations: usize,
}

/// An error for each signal, by the role of the recordings.
#[derive(Clone, Debug, Serialize)]
pub struct FitErrors {
    /// On the train recordings.
    pub train: Map<String, serde_json::Value>,
    /// On the held recordings.
    pub held: Map<String, serde_json::Value>,
}

impl IdentificationReport {
    /// Collects the numbers of a fit.
    pub fn new(
        problem: &IdentificationProblem<'_>,
        found: &Identification<'_>,
        fit: &ParameterFit,
        held: &[SignalFit],
        profiles: &[ProfileLikelihood],
    ) -> IdentificationReport {
        let values = problem.free.iter().enumerate().map(|(j, f)| {
            let std = finite(fit.deviations[j]);
            let (low, high) = fit.interval(problem, j);
            let interval = [finite(low), finite(high)];
            let all = json!({
                "value": fit.values[j], "std": std, "degrees": finite(fit.degrees[j]), "interval": interval,
                "unit": f.unit,
            });
            (f.name.clone(), all)
        });
        let by = |fits: &[SignalFit], of: fn(&SignalFit) -> f64| {
            fits.iter().map(|f| (f.name.clone(), json!(of(f)))).collect()
        };
        let errors = |of: fn(&SignalFit) -> f64| FitErrors { train: by(&fit.train, of), held: by(held, of) };
        let names = |group: &Vec<usize>| group.iter().map(|&j| problem.free[j].name.clone()).collect();
        let ends = problem.free.iter().zip(&fit.at_bound).filter(|(_, at)| **at);
        IdentificationReport {
            method: word(fit.method),
            parameters: values.collect(),
            inseparable: found.separation.blind.iter().map(|b| names(&b.group)).collect(),
            fit: errors(|f| f.rmse),
            fit_relative: errors(|f| f.relative),
            residual_correlation: by(&fit.train, |f| f.correlation),
            residuals: fit.residuals.iter().map(residual).collect(),
            profiles: profiles.iter().map(|p| (problem.free[p.parameter].name.clone(), profile(p))).collect(),
            correlation: fit.correlation.row_iter().map(|r| r.iter().copied().collect()).collect(),
            derivatives: derivatives(fit),
            starts: starts(fit),
            joints: joints(fit),
            converged: fit.converged,
            at_bound: ends.map(|(f, _)| f.name.clone()).collect(),
            iterations: fit.iterations,
        }
    }
}

/// The text of the key `derivatives`.
fn derivatives(fit: &ParameterFit) -> String {
    fit.differences.as_ref().map_or_else(|| "exact".to_owned(), |why| format!("differences: {why}"))
}

/// The entries of the key `starts`; none for a single search.
fn starts(fit: &ParameterFit) -> Map<String, serde_json::Value> {
    let MultistartSummary { tried, here, worse, failed } = fit.starts;
    let all = [("tried", tried), ("here", here), ("worse", worse), ("failed", failed)];
    all.into_iter().filter(|_| tried > 1).map(|(name, n)| (name.to_owned(), json!(n))).collect()
}

/// The entries of the key `joints`.
fn joints(fit: &ParameterFit) -> Map<String, serde_json::Value> {
    let entry = |j: &super::ContinuityDefects| {
        [("count", json!(j.count)), ("jump", json!(j.jump)), ("state", json!(j.state))].map(|(n, v)| (n.to_owned(), v))
    };
    fit.joints.iter().flat_map(entry).collect()
}

/// `None` for an infinite number, which JSON cannot express.
fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

/// A signal's name and the entry of the key `residuals`.
fn residual(test: &ResidualTest) -> (String, serde_json::Value) {
    let follow = |d: &super::InputCrossCorrelation| {
        (d.input.clone(), json!({"lag": d.lag, "correlation": d.correlation, "chance": d.chance}))
    };
    let inputs: Map<String, serde_json::Value> = test.inputs.iter().map(follow).collect();
    let (white, chance) = (test.white(), test.chance);
    let all = json!({
        "samples": test.samples, "white": white, "chance": chance, "statistic": test.statistic,
        "autocorrelation": test.autocorrelation, "inputs": inputs,
    });
    (test.name.clone(), all)
}

/// The entry of the key `profiles`.
fn profile(p: &ProfileLikelihood) -> serde_json::Value {
    let (value, rise): (Vec<f64>, Vec<f64>) = p.points.iter().copied().unzip();
    json!({"interval": [finite(p.interval.0), finite(p.interval.1)], "value": value, "rise": rise})
}

/// The value of the key `method`.
fn word(method: IdentifyMethod) -> &'static str {
    if method == IdentifyMethod::Inverse { "inverse model" } else { "output error" }
}

/// The identifiability analysis as text, before the fit.
pub fn separation_words(problem: &IdentificationProblem<'_>, found: &Identification<'_>) -> String {
    let s = &found.separation;
    let mut text = format!(
        "{} parameters, {} independent combinations in the data (condition {})\n",
        problem.free.len(),
        s.rank,
        rounded(s.condition, 3)
    );
    for (i, (blind, advice)) in s.blind.iter().zip(&found.advice).enumerate() {
        // Directions that share a group would repeat the same line.
        if s.blind[..i].iter().any(|b| b.group == blind.group) {
            continue;
        }
        let names: Vec<String> = blind.group.iter().map(|&j| format!("`{}`", problem.free[j].name)).collect();
        let line = match &names[..] {
            [one] => format!("the data say nothing about {one}"),
            all => format!("the data cannot tell apart {}", all.join(", ")),
        };
        let help = match &advice[..] {
            [] => "no variable of the model would tell in these recordings: another excitation is needed".to_owned(),
            some => format!("measuring one of these would help: {}", some.join(", ")),
        };
        let _ = writeln!(text, "{line}; {help}");
    }
    text
}

/// Estimates, errors and residual tests as text.
pub fn fit_words(problem: &IdentificationProblem<'_>, fit: &ParameterFit, held: &[SignalFit]) -> String {
    let mut text = String::new();
    if !fit.converged {
        text.push_str("the search did not reach a least value: the numbers below are where it stopped\n");
    }
    let MultistartSummary { tried, here, worse, failed } = fit.starts;
    if tried > 1 {
        let _ = write!(text, "of {tried} starts {here} led to this least value, {worse} to larger ones");
        text.push_str(&if failed > 0 { format!(", {failed} could not be run\n") } else { "\n".to_owned() });
    }
    if let Some(j) = &fit.joints {
        let (jump, joined) = (rounded(j.jump, 2), if j.jump <= super::pieces::APART { "" } else { "do not " });
        let _ = writeln!(
            text,
            "the pieces {joined}join: at {} places `{}` jumps by {jump} of its range at most",
            j.count, j.state
        );
    }
    for (free, _) in problem.free.iter().zip(&fit.at_bound).filter(|(_, at)| **at) {
        let _ = writeln!(text, "`{}` ended at a bound: its deviation is that of the bounded problem", free.name);
    }
    if fit.deviations.iter().all(|d| d.is_infinite()) {
        text.push_str(
            "the recordings have no more to say than the unknowns take up: nothing tells how sure the values are\n",
        );
    }
    let width = problem.free.iter().map(|f| f.name.len()).max().unwrap_or(0);
    for (j, free) in problem.free.iter().enumerate() {
        let value = rounded(fit.values[j], 6);
        let deviation = finite(fit.deviations[j]).map_or_else(|| "unknown".to_owned(), |d| rounded(d, 2));
        let _ = writeln!(text, "  {:width$}  {value} +- {deviation} {}", free.name, free.unit);
    }
    for (role, fits) in [("train", fit.train.as_slice()), ("held", held)] {
        for f in fits {
            let (rmse, share) = (rounded(f.rmse, 4), rounded(100.0 * f.relative, 3));
            // Up to two samples the errors are close to white.
            let coloured = if f.correlation > 2.0 {
                format!(", errors resemble each other over {} samples", rounded(f.correlation, 2))
            } else {
                String::new()
            };
            let _ = writeln!(text, "  {role}: {} rmse {rmse} {} ({share} %){coloured}", f.name, f.unit);
        }
    }
    if fit.method == IdentifyMethod::Output {
        let _ = writeln!(text, "  derivatives: {}", derivatives(fit));
    }
    for test in &fit.residuals {
        let _ = writeln!(text, "  {}", residual_words(test));
    }
    text
}

/// The tests of one signal's residuals as text.
fn residual_words(test: &ResidualTest) -> String {
    let (name, chance) = (&test.name, rounded(test.chance, 2));
    let lags = test.autocorrelation.len();
    let mut text = if test.white() {
        format!("errors of {name} may be white (chance {chance}, {lags} lags)")
    } else {
        format!("errors of {name} are not white (chance {chance}, {lags} lags); deviations are corrected for it")
    };
    for d in test.followed() {
        let (correlation, chance) = (rounded(d.correlation, 2), rounded(d.chance, 2));
        let _ = write!(text, "\n    they follow {} after {} samples: correlation {correlation}", d.input, d.lag);
        let _ = write!(text, " (chance {chance}); something is missing in the model");
    }
    text
}

/// The intervals of profiles as text; empty without profiles.
pub fn profile_words(problem: &IdentificationProblem<'_>, profiles: &[ProfileLikelihood]) -> String {
    let end = |v: f64| if v.is_finite() { rounded(v, 6) } else { "open".to_owned() };
    let line = |p: &ProfileLikelihood| {
        let free = &problem.free[p.parameter];
        format!("  {}: 95 % from {} to {} {}\n", free.name, end(p.interval.0), end(p.interval.1), free.unit)
    };
    let lines: String = profiles.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("profile likelihood:\n{lines}") }
}
