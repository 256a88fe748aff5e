//! The result of an identification in numbers and in words.

use super::{
    Identification, IdentificationProblem, IdentifyMethod, MultistartSummary, ParameterFit, ProfileLikelihood,
    ResidualTest, SignalFit,
};
use bramah_results::number::rounded;
use serde::Serialize;
use serde_json::{Map, json};
use std::fmt::Write;

/// `result.json`.
#[derive(Clone, Debug, Serialize)]
pub struct IdentificationReport {
    /// `output error` or `inverse model`.
    pub method: &'static str,
    /// The parameters found: value, one standard deviation, its degrees of freedom and 95 % interval (null where the data say nothing) and unit.
    pub parameters: Map<String, serde_json::Value>,
    /// Groups that the data cannot tell apart; a group of one has no influence.
    pub inseparable: Vec<Vec<String>>,
    /// Root mean square errors in the signals' units.
    pub fit: FitErrors,
    /// The same over the signals' own variation.
    pub fit_relative: FitErrors,
    /// Over how many samples the errors on the train recordings resemble each other.
    pub residual_correlation: Map<String, serde_json::Value>,
    /// What the errors on the train recordings look like.
    pub residuals: Map<String, serde_json::Value>,
    /// Correlations of the estimates, in the order of `parameters`.
    pub correlation: Vec<Vec<f64>>,
    /// Profiles asked for: 95 % interval (null on a side that the data leave open) and points.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub profiles: Map<String, serde_json::Value>,
    /// `exact`, or `differences` and why.
    pub derivatives: String,
    /// Where searches from several places ended, if there were several.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub starts: Map<String, serde_json::Value>,
    /// How the pieces of cut recordings join: how many `count`, the largest `jump` left as a part of the range of its
    /// `state`.
    #[serde(skip_serializing_if = "Map::is_empty")]
    pub joints: Map<String, serde_json::Value>,
    /// Whether a least value was reached.
    pub converged: bool,
    /// Parameters that ended at a bound.
    pub at_bound: Vec<String>,
    /// Steps of the search.
    pub iterations: usize,
}

/// By role and signal.
#[derive(Clone, Debug, Serialize)]
pub struct FitErrors {
    /// On the recordings used.
    pub train: Map<String, serde_json::Value>,
    /// On those kept back.
    pub held: Map<String, serde_json::Value>,
}

impl IdentificationReport {
    /// Puts the result together.
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

fn derivatives(fit: &ParameterFit) -> String {
    fit.differences.as_ref().map_or_else(|| "exact".to_owned(), |why| format!("differences: {why}"))
}

fn starts(fit: &ParameterFit) -> Map<String, serde_json::Value> {
    let MultistartSummary { tried, here, worse, failed } = fit.starts;
    let all = [("tried", tried), ("here", here), ("worse", worse), ("failed", failed)];
    all.into_iter().filter(|_| tried > 1).map(|(name, n)| (name.to_owned(), json!(n))).collect()
}

fn joints(fit: &ParameterFit) -> Map<String, serde_json::Value> {
    let entry = |j: &super::ContinuityDefects| {
        [("count", json!(j.count)), ("jump", json!(j.jump)), ("state", json!(j.state))].map(|(n, v)| (n.to_owned(), v))
    };
    fit.joints.iter().flat_map(entry).collect()
}

/// JSON knows no infinity.
fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

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

fn profile(p: &ProfileLikelihood) -> serde_json::Value {
    let (value, rise): (Vec<f64>, Vec<f64>) = p.points.iter().copied().unzip();
    json!({"interval": [finite(p.interval.0), finite(p.interval.1)], "value": value, "rise": rise})
}

fn word(method: IdentifyMethod) -> &'static str {
    if method == IdentifyMethod::Inverse { "inverse model" } else { "output error" }
}

/// What can be found at all, in words.
pub fn separation_words(problem: &IdentificationProblem<'_>, found: &Identification<'_>) -> String {
    let s = &found.separation;
    let mut text = format!(
        "{} parameters, {} independent combinations in the data (condition {})\n",
        problem.free.len(),
        s.rank,
        rounded(s.condition, 3)
    );
    for (i, (blind, advice)) in s.blind.iter().zip(&found.advice).enumerate() {
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

/// The parameters found and how well the signals are met, in words.
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

/// What the errors of a signal look like.
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

/// Profiles, in words.
pub fn profile_words(problem: &IdentificationProblem<'_>, profiles: &[ProfileLikelihood]) -> String {
    let end = |v: f64| if v.is_finite() { rounded(v, 6) } else { "open".to_owned() };
    let line = |p: &ProfileLikelihood| {
        let free = &problem.free[p.parameter];
        format!("  {}: 95 % from {} to {} {}\n", free.name, end(p.interval.0), end(p.interval.1), free.unit)
    };
    let lines: String = profiles.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("profile likelihood:\n{lines}") }
}
