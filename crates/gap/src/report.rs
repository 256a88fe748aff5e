//! The diagnosis as one HTML page: words, the network with the places of the gap, tables, and curves of every signal.
//!
//! Enters: problem, result of the search, verdict and held recordings. Leaves: the text of the page, which needs no
//! network and no other file. Called by `diagnose`.

use super::data::RecordingData;
use super::estimate::candidate::{CandidateModel, RecordingResiduals};
use super::hypotheses::SensorSignal;
use super::problem::DiagnosisProblem;
use super::select::search::EffectSearchResult;
use super::select::weighed::at_nominal;
use super::study::HoldoutData;
use super::verdict::{HypothesisAssessment, ModelGaps, OptionalNumber, RoleGaps, SignalGap, Verdict, VerdictEffect};
use super::whiteness::{Whiteness, whiteness};
use super::words::{distance, estimate, findings, gap_row, number, percent, rest};
use bramah_expr::units::MeasurementUnit;
use bramah_model::compile::flatten;
use bramah_plot::network::{self, HeatMark};
use bramah_plot::svg::escape;
use bramah_plot::{Figure, FigurePanel, PlotSeries, html};
use std::fmt::Write;

/// Deviation in tolerances from which on the table highlights a parameter.
const FAR: f64 = 2.0;

/// Name of a model and the whiteness of its residuals, per signal.
type ModelWhiteness = (&'static str, Vec<Whiteness>);

/// Writes the page. The curves are simulated anew, for train and held recordings.
pub fn report(
    problem: &DiagnosisProblem<'_>,
    found: &EffectSearchResult,
    verdict: &Verdict,
    held: &HoldoutData,
) -> String {
    let used: Vec<(&String, &RecordingData)> = problem.files.iter().zip(&problem.train).collect();
    let others: Vec<(&String, &RecordingData)> = held.files.iter().zip(&held.recordings).collect();
    let mut panels = Vec::new();
    for (i, (file, recording)) in used.iter().enumerate() {
        panels.extend(curves(problem, found, recording, Some(i), &format!("{file}, used")));
    }
    for (file, recording) in others {
        panels.extend(curves(problem, found, recording, None, &format!("{file}, held")));
    }
    let fits = [("within tolerances", &found.base.fit), ("with effects", &found.last.fit)];
    // without effects both models are the same
    let fits = &fits[..1 + usize::from(!verdict.effects.is_empty())];
    let of = |errors: &[RecordingResiduals]| whiteness(errors, &problem.train, &problem.noise_floor);
    let left: Vec<ModelWhiteness> = fits.iter().map(|(stage, fit)| (*stage, of(&fit.evaluated.errors))).collect();
    panels.extend(left.iter().map(|left| spectrum(problem, left)));
    let title = format!("Gap of {}", problem.circuit.class);
    let figure = Figure { title, panels, shared_x: false };
    let facts = [
        ("verdict".to_string(), verdict.verdict.replace('_', " ")),
        ("recordings used".to_string(), problem.files.join(", ")),
        ("held recordings".to_string(), held.files.join(", ")),
        ("hypotheses".to_string(), problem.hypotheses.len().to_string()),
        ("bramah".to_string(), env!("CARGO_PKG_VERSION").to_string()),
    ];
    html::write_around(&figure, &facts, &before(problem, verdict, &left))
}

/// HTML of everything above the curves: words, network and tables.
fn before(problem: &DiagnosisProblem<'_>, v: &Verdict, left: &[ModelWhiteness]) -> String {
    let line = |line: &str| format!("<p>{}</p>\n", escape(line));
    // the text's own table of the gap is left out: an HTML table follows below
    let mut out: String = [findings(v), rest(v)].concat().lines().map(line).collect();
    out.push_str(&picture(problem, v));
    out.push_str(&table("Effects", EFFECTS, &effects(v)));
    out.push_str(&table(
        "Gap: RMS of measured minus simulated, in brackets of the range of these recordings",
        GAPS,
        &gaps(v),
    ));
    out.push_str(&table("Parameters against their tolerances", DRIFTS, &drifts(v)));
    out.push_str(&table("Places where model and recordings differ", PLACES, &places(v)));
    out.push_str(&table("What stays unexplained", UNEXPLAINED, &unexplained(v)));
    out.push_str(&table(
        "What is left of the recordings used, beside the sensors' noise",
        WHITE,
        &white(problem, left),
    ));
    out.push_str(&table("What was weighed", WEIGHED, &weighed(v)));
    out.push_str(&not_fitted(v));
    out.push_str("<h2>Measured and simulated; spectra of what is left</h2>\n");
    out
}

/// Drawing of the network; the stronger the evidence at a place, the deeper its colour. Empty if the model does not
/// compile. Each mark carries the place, its kind and its evidence as a note.
fn picture(problem: &DiagnosisProblem<'_>, v: &Verdict) -> String {
    let Some(flattened) = flatten(problem.world, &problem.request).value else { return String::new() };
    let most = v.places.iter().map(|p| p.evidence).fold(0.0, f64::max);
    let mut marks = Vec::new();
    for p in v.places.iter().filter(|p| p.evidence > 0.0) {
        // the root keeps weaker places visible
        let heat = (p.evidence / most).sqrt();
        let note = format!("{} ({}): {:.0} nats", p.place, p.kind, p.evidence);
        // a sensor has no place in the network, but the variable that it measures has
        let sensed = problem.signals.iter().find(|s| p.kind == "sensor" && s.name == p.place);
        let names = p.node.iter().chain(sensed.map(|s| &s.variable));
        marks.extend(names.map(|name| HeatMark { name: name.clone(), heat, note: note.clone() }));
    }
    let drawn = network::write_marked(&flattened.graph, &problem.circuit.class, &marks);
    format!("<div class=\"network\">{drawn}</div>\n")
}

/// Columns of the table of effects.
const EFFECTS: &[&str] = &[
    "effect",
    "class",
    "places",
    "parameters",
    "evidence in nats",
    "t",
    "closes alone",
    "closes last",
    "indistinguishable from",
];
/// Columns of the table of gaps.
const GAPS: &[&str] = &["recordings", "signal", "nominal", "within tolerances", "with effects", "sensor noise"];
/// Columns of the table of parameters.
const DRIFTS: &[&str] = &["parameter", "nominal", "fitted", "std", "tolerances"];
/// Columns of the table of places.
const PLACES: &[&str] = &["place", "kind", "evidence in nats", "share", "the same place"];
/// Columns of the table of what stays unexplained.
const UNEXPLAINED: &[&str] = &["share of the nominal gap", "place", "shape", "closes"];
/// Columns of the table of judged hypotheses.
const WEIGHED: &[&str] =
    &["step", "effect", "places", "leaves, of full scale", "t", "evidence in nats", "why not taken"];
/// Columns of the table of whiteness; the value of a complete model is in brackets.
const WHITE: &[&str] = &["signal", "model", "mean square (1)", "correlation of neighbours (0)", "white noise at most"];

/// A table of cells that are HTML already; empty without rows.
fn table(title: &str, heads: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut out = format!("<h2>{title}</h2>\n<table class=\"rows\"><tr>");
    for h in heads {
        let _ = write!(out, "<th>{h}</th>");
    }
    for row in rows {
        out.push_str("</tr>\n<tr>");
        for cell in row {
            let _ = write!(out, "<td>{cell}</td>");
        }
    }
    out.push_str("</tr></table>\n");
    out
}

/// Rows of accepted effects, one per effect, with parameters and alternatives in one cell each.
fn effects(v: &Verdict) -> Vec<Vec<String>> {
    let row = |e: &VerdictEffect| {
        let parameters: Vec<String> =
            e.parameters.iter().map(|(n, p)| escape(&format!("{n} = {}", estimate(p, "±")))).collect();
        let others: Vec<String> = e
            .indistinguishable
            .iter()
            .map(|a| {
                let at: Vec<&str> = a.places.iter().map(|p| p.place.as_str()).collect();
                escape(&format!("{} at {} ({})", a.effect, at.join(", "), distance(a.behind)))
            })
            .collect();
        let at: Vec<String> = e.places.iter().map(|p| escape(&p.place)).collect();
        vec![
            escape(&e.family.replace('_', " ")),
            escape(&e.effect),
            at.join("<br>"),
            parameters.join("<br>"),
            format!("{:.1}", e.evidence),
            format!("{:.1}", e.t),
            share(e.closes_alone),
            share(e.closes_last),
            others.join("<br>"),
        ]
    };
    v.effects.iter().map(row).collect()
}

/// A share in per cent; `unknown` if there is none.
fn share(v: OptionalNumber) -> String {
    v.map_or_else(|| "unknown".to_string(), percent)
}

/// Rows of the gaps on held and on train recordings, signal by signal.
fn gaps(v: &Verdict) -> Vec<Vec<String>> {
    let signal = |which: &str, name: &str, g: &SignalGap| {
        let cells = gap_row(name, g).map(|cell| escape(&cell));
        [vec![which.to_string()], cells.to_vec()].concat()
    };
    let all = |which: &str, c: &ModelGaps| {
        let parts = [c.nominal, c.tolerances, c.effects].map(share);
        [vec![which.to_string(), "<b>all, of full scale</b>".to_string()], parts.to_vec(), vec![String::new()]].concat()
    };
    let rows = |which: &str, side: &RoleGaps| -> Vec<Vec<String>> {
        side.signals.iter().map(|(n, g)| signal(which, n, g)).chain([all(which, &side.total)]).collect()
    };
    [rows("held", &v.gap.held), rows("used", &v.gap.train)].concat()
}

/// Rows of the parameters. Deviations of [`FAR`] tolerances and more are highlighted.
fn drifts(v: &Verdict) -> Vec<Vec<String>> {
    let row = |d: &super::verdict::ParameterDrift| {
        let deviation = d.tolerances.map_or_else(|| "free".to_string(), |t| format!("{t:+.2}"));
        let far = d.tolerances.is_some_and(|t| t.abs() >= FAR);
        let deviation = if far { format!("<b class=\"far\">{deviation}</b>") } else { deviation };
        vec![escape(&d.parameter), number(d.nominal), number(d.value), number(d.std), deviation]
    };
    v.drifts.iter().map(row).collect()
}

/// Rows of the places with their evidence.
fn places(v: &Verdict) -> Vec<Vec<String>> {
    let row = |p: &super::verdict::PlaceEvidence| {
        let node = escape(&p.node.join(", "));
        vec![escape(&p.place), p.kind.to_string(), format!("{:.1}", p.evidence), percent(p.share), node]
    };
    v.places.iter().map(row).collect()
}

/// Rows of what no effect explains: one for each term of the shape.
fn unexplained(v: &Verdict) -> Vec<Vec<String>> {
    let u = &v.unexplained;
    let place = u.place.as_deref().map_or_else(|| "unknown".to_string(), escape);
    let row = |shape: String, closes: String| vec![share(u.share), place.clone(), shape, closes];
    match &u.shape {
        None if v.open.is_empty() => Vec::new(),
        Some(terms) => terms.iter().map(|t| row(escape(&t.term), percent(t.closes))).collect(),
        None => vec![row("none that is known".into(), String::new())],
    }
}

/// Rows of fitted hypotheses, with the reason why each was not taken.
fn weighed(v: &Verdict) -> Vec<Vec<String>> {
    let digits = |v: OptionalNumber, digits: usize| v.map_or_else(String::new, |v| format!("{v:.digits$}"));
    let row = |w: &HypothesisAssessment| {
        let at: Vec<String> = w.places.iter().map(|p| escape(&p.place)).collect();
        vec![
            w.step.to_string(),
            escape(&w.effect),
            at.join("<br>"),
            w.gap.map_or_else(String::new, percent),
            digits(w.t, 1),
            digits(w.evidence, 1),
            w.refused.as_deref().map_or_else(|| "<b>taken</b>".to_string(), escape),
        ]
    };
    v.weighed.iter().filter(|w| w.gap.is_some()).map(row).collect()
}

/// Paragraph with the number of hypotheses that were not fitted.
/// They have no scores and would make the table long.
fn not_fitted(v: &Verdict) -> String {
    let count = v.weighed.iter().filter(|w| w.gap.is_none()).count();
    format!("<p>{count} more were not fitted: a linear step promised too little. The JSON verdict lists them.</p>\n")
}

/// Rows of whiteness, one per signal and model. A correlation beyond its limit is highlighted.
fn white(problem: &DiagnosisProblem<'_>, left: &[ModelWhiteness]) -> Vec<Vec<String>> {
    let row = |name: &str, stage: &str, w: &Whiteness| {
        let coloured = w.neighbours.abs() > w.limit;
        let neighbours = format!("{:+.3}", w.neighbours);
        let neighbours = if coloured { format!("<b class=\"far\">{neighbours}</b>") } else { neighbours };
        vec![escape(name), stage.into(), format!("{:.2}", w.power), neighbours, format!("{:.3}", w.limit)]
    };
    let signal = |(i, s): (usize, &SensorSignal)| {
        let models = left.iter().filter_map(move |(stage, left)| Some((left.get(i)?, stage)));
        models.map(|(w, stage)| row(&s.name, stage, w)).collect::<Vec<_>>()
    };
    problem.signals.iter().enumerate().flat_map(signal).collect()
}

/// Panel of the spectra of a model's residuals, in decibels over the sensors' noise.
/// At 0 dB a residual is white noise of the sensor's size.
fn spectrum(problem: &DiagnosisProblem<'_>, (stage, left): &ModelWhiteness) -> FigurePanel {
    let level = |d: &f64| if *d > 0.0 { 10.0 * d.log10() } else { f64::NAN };
    let series = |(i, (s, w)): (usize, (&SensorSignal, &Whiteness))| {
        curve(&s.name, &w.frequencies, &w.density.iter().map(level).collect::<Vec<f64>>(), i)
    };
    FigurePanel {
        x_label: format!("frequency in Hz, {stage}"),
        y_label: "left, dB over the noise".into(),
        series: problem.signals.iter().zip(left).enumerate().map(series).collect(),
        ..FigurePanel::default()
    }
}

/// Figure of the nominal model and every train recording, without a diagnosis. Nothing is fitted but the initial
/// states.
///
/// # Errors
/// File of the first recording whose simulation stops early, and the time at which it stops, s.
pub fn compared(problem: &DiagnosisProblem<'_>, nominal: &CandidateModel) -> Result<Figure, (String, f64)> {
    let x = nominal.present();
    let mut panels = Vec::new();
    for (i, (file, recording)) in problem.files.iter().zip(&problem.train).enumerate() {
        if let Some(time) = nominal.stops(&x, recording) {
            return Err((file.clone(), time));
        }
        let simulated = [("simulated", 1, nominal.errors(&x, recording, Some(i)))];
        panels.extend(beside(problem, recording, &simulated, file));
    }
    Ok(Figure { title: format!("{} and its recordings", problem.circuit.class), panels, shared_x: false })
}

/// Panels of a recording: measured, nominal and corrected model. `number`: index among the train recordings, if it is
/// one. `what`: words for the axis, as the file.
fn curves(
    problem: &DiagnosisProblem<'_>,
    found: &EffectSearchResult,
    recording: &RecordingData,
    number: Option<usize>,
    what: &str,
) -> Vec<FigurePanel> {
    let (base, last) = (&found.base.fit, &found.last.fit);
    let of_nominal = base.candidate.errors(&at_nominal(problem, &base.candidate, &base.x), recording, number);
    let of_last = last.candidate.errors(&last.x, recording, number);
    beside(problem, recording, &[("nominal", 1, of_nominal), ("corrected", 0, of_last)], what)
}

/// Panels of a recording, one per signal, with curves of models given by name, colour and residuals.
/// Values are in the unit of the study's column. A model without residuals has no curve.
fn beside(
    problem: &DiagnosisProblem<'_>,
    recording: &RecordingData,
    models: &[(&str, usize, Option<RecordingResiduals>)],
    what: &str,
) -> Vec<FigurePanel> {
    // residuals begin behind the samples from which the initial state is estimated
    let behind = |errors: &RecordingResiduals| recording.len() - errors.first().map_or(0, Vec::len);
    let panel = |(i, signal): (usize, &SensorSignal)| {
        let measured = &recording.signals[i];
        let (of_model, unit) = (problem.circuit.units.get(&signal.variable), &problem.shown[i].unit);
        let units = of_model.and_then(|u| MeasurementUnit::parse(u).ok()).zip(MeasurementUnit::parse(unit).ok());
        let in_unit = |values: &[f64]| -> Vec<f64> {
            let convert = |v: &f64| units.as_ref().and_then(|(from, to)| from.convert(*v, to)).unwrap_or(*v);
            values.iter().map(convert).collect()
        };
        let mut series = vec![curve("measured", &recording.times, &in_unit(measured), 6)];
        for (name, colour, errors) in models {
            let Some(errors) = errors else { continue };
            let from = behind(errors);
            // simulated is measured minus residual
            let simulated: Vec<f64> = measured[from..].iter().zip(&errors[i]).map(|(y, e)| y - e).collect();
            series.push(curve(name, &recording.times[from..], &in_unit(&simulated), *colour));
        }
        FigurePanel {
            x_label: format!("time in s, {what}"),
            y_label: if unit.is_empty() { signal.name.clone() } else { format!("{} in {unit}", signal.name) },
            series,
            ..FigurePanel::default()
        }
    };
    problem.signals.iter().enumerate().map(panel).collect()
}

/// A curve of a panel; `colour` is an index into the palette.
fn curve(name: &str, x: &[f64], y: &[f64], colour: usize) -> PlotSeries {
    PlotSeries { name: name.into(), x: x.to_vec(), y: y.to_vec(), colour, ..PlotSeries::default() }
}
