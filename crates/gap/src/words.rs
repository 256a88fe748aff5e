//! The verdict as text for people, about one screen.
//!
//! Enters: a [`Verdict`]. Leaves: text for the command line; `report` uses its parts for the page.
//! Figures have the unit of the study's column, and errors are given as RMS with their share of the signal's range.

use super::verdict::{
    EffectFlow, OpenGap, OptionalNumber, ParameterDrift, ParameterEstimate, PlaceEvidence, RecordingError, SignalGap,
    Verdict, VerdictEffect,
};
use crate::policy::SEEN;
use std::fmt::Write;

/// The text: findings, a table of the gap, and what is left.
pub fn words(v: &Verdict) -> String {
    [findings(v), gaps(v), rest(v)].concat()
}

/// Errors of recordings and effects, or what is said where there are none.
/// Errors of one file share a sentence: all but one of them are alternatives.
pub(super) fn findings(v: &Verdict) -> String {
    let mut text = headline(v);
    // errors that the data cannot tell apart stand in one sentence
    for in_file in v.recording.chunk_by(|a, b| a.file == b.file) {
        let what = |r: &RecordingError| match r.error {
            "sign" => format!("`{}` has the wrong sign", r.signal),
            _ => format!("`{}` is {} times what it should be", r.signal, number(r.value)),
        };
        let all: Vec<String> = in_file.iter().map(what).collect();
        let _ = writeln!(text, "The recording `{}` is wrong: {}.", in_file[0].file, all.join(", or "));
    }
    for (i, e) in v.effects.iter().enumerate() {
        text.push_str(&effect(i, e, v.effects.len()));
    }
    if let Some(said) = &v.asked {
        let _ = writeln!(text, "   It is shown because it was asked for; {said}.");
    }
    text.push_str(&found_nothing(v));
    text
}

/// What is missing and how far the error falls with it, in one or two sentences; empty without effects.
/// The signal named is the one whose error falls most.
fn headline(v: &Verdict) -> String {
    if v.effects.is_empty() {
        return String::new();
    }
    let with = if v.effects.len() == 1 { "it" } else { "them" };
    format!("{}{}\n", lacking(&v.effects), fall(v, with).unwrap_or_default())
}

/// Sentences on what the model lacks and which parameters are off.
/// Effects are joined in one sentence; each parameter gets its own.
fn lacking(effects: &[VerdictEffect]) -> String {
    let (off, missing): (Vec<&VerdictEffect>, Vec<&VerdictEffect>) =
        effects.iter().partition(|e| e.family == "parameter");
    let flow = |f: &EffectFlow| format!(", up to {} in the recordings used", quantity(f.largest, &f.unit));
    let one = |e: &&VerdictEffect| {
        let flow = e.flow.as_ref().map_or_else(String::new, flow);
        format!("{} at {}{flow}", lower(&e.description), places(e))
    };
    let missing: Vec<String> = missing.iter().map(one).collect();
    let missing = (!missing.is_empty()).then(|| format!("The model lacks {}.", missing.join("; and ")));
    let off = off.into_iter().map(|e| format!("{} is off its data sheet.", places(e)));
    missing.into_iter().chain(off).collect::<Vec<_>>().join(" ")
}

/// Places of an effect in words, joined by "and".
fn places(e: &VerdictEffect) -> String {
    e.places.iter().map(|p| format!("`{}`", p.place)).collect::<Vec<_>>().join(" and ")
}

/// Sentence on the signal whose error falls most in parts of its range; `None` if none falls.
/// `with`: pronoun for the effects named before.
fn fall(v: &Verdict, with: &str) -> Option<String> {
    let fall = |g: &SignalGap| Some(g.of_range.nominal? - g.of_range.effects?);
    // a signal whose simulation stops early has no figure and is left out
    let all = v.gap.held.signals.iter().filter_map(|(name, g)| Some((name, g, fall(g)?)));
    let (name, g, by) = all.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let (from, to) = (significant(g.rms.nominal?), quantity(g.rms.effects?, &g.unit));
    (by > 0.0)
        .then(|| format!(" With {with} the error of `{name}` falls from {from} to {to} (RMS on held recordings)."))
}

/// What is left, and what to do about it: open gaps, shapes, parameters off their data sheet, assumptions, and the next
/// experiment.
pub(super) fn rest(v: &Verdict) -> String {
    let mut text = String::new();
    if v.open.is_empty() {
        text.push_str("What is left lies within three times the noise or a quarter of a per cent of the range.\n");
    } else if let Some(share) = v.unexplained.share {
        let at = v.unexplained.place.as_ref().map(|p| format!(", most of it at `{p}`")).unwrap_or_default();
        let _ = writeln!(text, "Not explained: {} of the nominal gap{at}.", percent(share));
    }
    for t in v.unexplained.shape.iter().flatten() {
        let _ = writeln!(
            text,
            "What is missing there has this shape: {}. It closes {} of the gap on left-out data.",
            lower(&t.term),
            percent(t.closes)
        );
    }
    // smaller deviations are what tolerances are for
    let far = |d: &ParameterDrift| d.tolerances.filter(|t| t.abs() >= 2.0);
    for (d, tolerances) in v.drifts.iter().filter_map(|d| Some((d, far(d)?))) {
        let (name, value, nominal) = (&d.parameter, number(d.value), number(d.nominal));
        let _ = writeln!(text, "`{name}` is {value} instead of {nominal} ({tolerances:+.1} tolerances).");
    }
    if !v.assumed.is_empty() {
        let _ = writeln!(text, "{} parameters without a stated tolerance were taken as known to 5 %.", v.assumed.len());
    }
    if let Some(next) = &v.next_experiment {
        let _ = writeln!(text, "To decide: {next}.");
    }
    text
}

/// What is said where no effect is named, by the word of the verdict.
fn found_nothing(v: &Verdict) -> String {
    let named = |p: &PlaceEvidence| format!("`{}` ({})", p.place, p.kind);
    match v.verdict {
        "outside_library" => {
            let at = v.places.iter().find(|p| Some(&p.place) == v.unexplained.place.as_ref()).map(named);
            let at = at.map(|p| format!(" at {p}")).unwrap_or_default();
            format!("Something is missing{at} that none of the known effects explains.\n")
        }
        "gap_open" => open(v, v.places.first().filter(|p| p.evidence > SEEN).map(named)),
        "undecidable" => "The recordings cannot tell: effects of usual size would hardly show in them.\n".into(),
        "nothing_found" => {
            "Nothing is missing that these recordings could show: what is left is within tolerances and noise.\n".into()
        }
        _ => String::new(),
    }
}

/// How large the open gaps are, at which signals, and in how many recordings.
/// `place`: the place that explains most, in words.
fn open(v: &Verdict, place: Option<String>) -> String {
    let one = |o: &OpenGap| {
        let size = match (o.rms, o.of_range) {
            (Some(rms), Some(share)) => {
                format!("{} ({} of its range)", quantity(rms, &o.unit), percent(share))
            }
            _ => "the run stops early".to_string(),
        };
        let (some, all) = o.recordings;
        let recordings = if all == 1 { "recording" } else { "recordings" };
        format!("`{}`: {size}, in {some} of {all} {recordings}", o.signal)
    };
    let signals: Vec<String> = v.open.iter().map(one).collect();
    let most = place.map_or(String::new(), |p| format!(" The place that explains most of it is {p}."));
    // the verdict is `gap_open` because of the parameters alone
    if signals.is_empty() {
        let bent = "The model follows the recordings only with parameters beyond three tolerances: they are wrong, or something";
        return format!("{bent} is missing that no known effect names.{most}\n");
    }
    format!("The gap stays open at {}. No known effect can be named for it.{most}\n", signals.join("; "))
}

/// Table of the gaps on held recordings, one line per signal, in columns of equal width; empty without signals.
fn gaps(v: &Verdict) -> String {
    let signals = &v.gap.held.signals;
    if signals.is_empty() {
        return String::new();
    }
    let head = ["", "nominal", "within tolerances", "with effects", "sensor noise"].map(String::from);
    let rows: Vec<[String; 5]> =
        std::iter::once(head).chain(signals.iter().map(|(name, g)| gap_row(name, g))).collect();
    // counted in characters, since a unit may hold letters of several bytes
    let width = |i: usize| rows.iter().map(|r| r[i].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    let line = |r: &[String; 5]| {
        let cells: Vec<String> = r.iter().zip(&widths).map(|(c, w)| format!("{c:<w$}")).collect();
        format!("  {}\n", cells.join("  ").trim_end())
    };
    let lines: String = rows.iter().map(line).collect();
    format!(
        "Gap on the held recordings: RMS of measured minus simulated, in brackets of the signal's range there.\n{lines}"
    )
}

/// Cells of a signal: name with unit, gap of the three models, and noise. A gap is an RMS with its share of the range.
/// A model whose simulation stops early gets words instead of numbers.
pub(super) fn gap_row(name: &str, g: &SignalGap) -> [String; 5] {
    let cell = |rms: OptionalNumber, share: OptionalNumber| match (rms, share) {
        (Some(rms), Some(share)) => format!("{} ({})", significant(rms), percent(share)),
        _ => "stops early".to_string(),
    };
    [
        if g.unit.is_empty() { name.to_string() } else { format!("{name} in {}", g.unit) },
        cell(g.rms.nominal, g.of_range.nominal),
        cell(g.rms.tolerances, g.of_range.tolerances),
        cell(g.rms.effects, g.of_range.effects),
        significant(g.noise),
    ]
}

/// A number with three significant digits, for errors and flows.
fn significant(v: f64) -> String {
    bramah_results::number::rounded(v, 3)
}

/// A number with three significant digits and its unit.
fn quantity(v: f64, unit: &str) -> String {
    format!("{} {unit}", significant(v)).trim_end().to_string()
}

/// The paragraph on the i-th of `count` effects: class, place, parameters, evidence, what it closes, and what the data
/// cannot tell from it.
fn effect(i: usize, e: &VerdictEffect, count: usize) -> String {
    let values: Vec<String> = e.parameters.iter().map(|(n, p)| format!("{n} = {}", estimate(p, "+-"))).collect();
    let mut text = format!(
        "{}. {} ({}) at {}: {}. Evidence {:.0} nats, t = {:.1}.\n",
        i + 1,
        e.family.replace('_', " "),
        e.effect,
        places(e),
        values.join(", "),
        e.evidence,
        e.t
    );
    if let Some(alone) = e.closes_alone {
        let beside = e.closes_last.filter(|_| count > 1).map(percent);
        let beside = beside.map_or(String::new(), |p| format!(" by itself, {p} beside the other effects"));
        let gap = "of the gap that tolerances leave on the held recordings";
        let _ = writeln!(text, "   It closes {} {gap}{beside}.", percent(alone));
    }
    if !e.indistinguishable.is_empty() {
        let others: Vec<String> = e
            .indistinguishable
            .iter()
            .map(|a| {
                let places: Vec<&str> = a.places.iter().map(|p| p.place.as_str()).collect();
                format!("{} at {} ({})", a.effect, places.join(" and "), distance(a.behind))
            })
            .collect();
        let _ = writeln!(text, "   These data cannot tell it from {}.", others.join(", "));
    }
    text
}

/// A value with its deviation and unit, and `sign` between them; `(fixed)` if it was not free.
/// It is shown in the unit of the study's column where that is known.
pub(super) fn estimate(p: &ParameterEstimate, sign: &str) -> String {
    let (factor, unit) = p.shown.as_ref().map_or((1.0, &p.unit), |s| (s.factor, &s.unit));
    let deviation = if p.std > 0.0 { format!(" {sign} {}", number(factor * p.std)) } else { String::new() };
    let fixed = if p.std > 0.0 { "" } else { " (fixed)" };
    format!("{}{deviation} {unit}", number(factor * p.value)).trim_end().to_string() + fixed
}

/// How far an alternative is from the named effect, in nats. One that is ahead has more parameters or states, or cuts a
/// connection; the named effect is simpler.
pub(super) fn distance(behind: f64) -> String {
    if behind < 0.0 { format!("{:.1} nats ahead, less simple", -behind) } else { format!("{behind:.1} nats behind") }
}

/// Text with a small first letter, for descriptions inside a sentence.
fn lower(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |c| c.to_lowercase().collect::<String>() + characters.as_str())
}

/// A number with four decimals, or in scientific notation if it is very small or large. For values of parameters.
pub(super) fn number(v: f64) -> String {
    if v == 0.0 || (1e-3..1e5).contains(&v.abs()) { format!("{v:.4}") } else { format!("{v:.3e}") }
}

/// A share in per cent with one decimal.
pub(super) fn percent(v: f64) -> String {
    format!("{:.1} %", 100.0 * v)
}

#[cfg(test)]
mod tests {
    use super::super::verdict::PlaceName;
    use super::*;
    use std::collections::BTreeMap;

    fn effect(family: &str, description: &str, place: &str, flow: Option<EffectFlow>) -> VerdictEffect {
        VerdictEffect {
            effect: String::new(),
            family: family.into(),
            description: description.into(),
            places: vec![PlaceName { place: place.into(), node: Vec::new() }],
            flow,
            evidence: 0.0,
            t: 0.0,
            closes_alone: None,
            closes_last: None,
            parameters: BTreeMap::new(),
            indistinguishable: Vec::new(),
        }
    }

    #[test]
    fn what_is_missing_and_what_is_off() {
        let flow = EffectFlow { largest: 3.456, rms: 2.0, unit: "l/min".into() };
        let leak = || effect("external_leak", "Laminar leakage to the low side", "pump.port_a", Some(flow.clone()));
        let drift = || effect("parameter", "", "motor.R_r", None);
        let leaks = "The model lacks laminar leakage to the low side at `pump.port_a`, up to 3.46 l/min in the recordings used.";
        let off = "`motor.R_r` is off its data sheet.";
        assert_eq!(lacking(&[leak()]), leaks);
        assert_eq!(lacking(&[drift()]), off);
        assert_eq!(lacking(&[drift(), leak()]), format!("{leaks} {off}"));
    }
}
