//! The diagnosis as one HTML page: words, the network with the places of the gap, tables, and curves of every signal.
//!
//! The page needs no network and no other file; the curves can be zoomed like those of `bramah plot`.

use super::data::Recording;
use super::diagnose::Search;
use super::held;
use super::hypotheses::{Hypothesis, Site};
use super::locate;
use super::problem::Problem;
use super::verdict::{Columns, Effect, Maybe, Side, SignalGap, Verdict};
use super::whiteness::{Whiteness, whiteness};
use super::words::{distance, findings, gap_row, number, percent, rest};
use crate::compile::flatten;
use crate::plot::network::{self, Mark};
use crate::plot::svg::escape;
use crate::plot::{Figure, Panel, Series, html};
use std::fmt::Write;

/// Deviations of so many tolerances are set off in the table.
const FAR: f64 = 2.0;

/// What a model left, signal by signal, with the model's name.
type Left = (&'static str, Vec<Whiteness>);

/// Writes the page. `held` are the recordings that were not used; of these and of those that were used the first is
/// drawn.
pub fn report(problem: &Problem<'_>, search: &Search, verdict: &Verdict, held: &[Recording]) -> String {
    let mut panels = panels(problem, search, &problem.train, "a recording that was used");
    panels.extend(self::panels(problem, search, held, "a held recording"));
    // without effects both are one
    let fits = [("within tolerances", search.tolerated().0), ("with effects", search.last().0)];
    let fits = &fits[..1 + usize::from(!verdict.effects.is_empty())];
    let left: Vec<Left> = fits.iter().map(|(stage, fit)| (*stage, whiteness(fit, &problem.train))).collect();
    panels.extend(left.iter().map(|left| spectrum(problem, left)));
    panels.extend(missing(problem, search, verdict));
    let title = format!("Gap of {}", problem.circuit.class);
    let figure = Figure { title, panels, shared_x: false };
    let facts = [
        ("verdict".to_string(), verdict.verdict.replace('_', " ")),
        ("recordings used".to_string(), problem.files.join(", ")),
        ("held recordings".to_string(), held.len().to_string()),
        ("hypotheses".to_string(), problem.hypotheses.len().to_string()),
        ("bramah".to_string(), env!("CARGO_PKG_VERSION").to_string()),
    ];
    html::write_around(&figure, &facts, &before(problem, verdict, &left))
}

/// Everything above the curves.
fn before(problem: &Problem<'_>, v: &Verdict, left: &[Left]) -> String {
    let line = |line: &str| format!("<p>{}</p>\n", escape(line));
    // the gap has a table of its own below
    let mut out: String = [findings(v), rest(v)].concat().lines().map(line).collect();
    out.push_str(&picture(problem, v));
    out.push_str(&table("Effects", EFFECTS, &effects(v)));
    out.push_str(&table(
        "Gap: RMS of measured minus simulated, in brackets of the range of these recordings",
        GAPS,
        &gaps(v),
    ));
    out.push_str(&table("Parameters against their tolerances", DRIFTS, &drifts(v)));
    out.push_str(&table("Places where model and bench part", PLACES, &places(v)));
    out.push_str(&table("What stays unexplained", UNEXPLAINED, &unexplained(v)));
    out.push_str(&table("What the filter did not expect", WHITE, &white(problem, left)));
    out.push_str("<h2>Measured and simulated; spectra of what the filter did not expect</h2>\n");
    out
}

/// The network; the more certain a gap at a place, the deeper its colour.
fn picture(problem: &Problem<'_>, v: &Verdict) -> String {
    let Some(flattened) = flatten(problem.world, &problem.request).value else { return String::new() };
    let most = v.places.iter().map(|p| p.evidence).fold(0.0, f64::max);
    let mut marks = Vec::new();
    for p in v.places.iter().filter(|p| p.evidence > 0.0) {
        let heat = (p.evidence / most).sqrt();
        let note = format!("{} ({}): {:.0} nats", p.place, p.kind, p.evidence);
        let sensed = problem.signals.iter().find(|s| p.kind == "sensor" && s.name == p.place);
        let names = p.node.iter().chain(sensed.map(|s| &s.variable));
        marks.extend(names.map(|name| Mark { name: name.clone(), heat, note: note.clone() }));
    }
    let drawn = network::write_marked(&flattened.graph, &problem.circuit.class, &marks);
    format!("<div class=\"network\">{drawn}</div>\n")
}

const EFFECTS: &[&str] = &[
    "effect",
    "class",
    "places",
    "parameters",
    "evidence in nats",
    "t",
    "closes alone",
    "closes last",
    "cannot be told from",
];
const GAPS: &[&str] = &["recordings", "signal", "nominal", "within tolerances", "with effects", "sensor noise"];
const DRIFTS: &[&str] = &["parameter", "nominal", "fitted", "std", "tolerances"];
const PLACES: &[&str] = &["place", "kind", "evidence in nats", "share", "the same place"];
const UNEXPLAINED: &[&str] = &["share of the nominal gap", "place", "shape", "part of the gap's square"];
const WHITE: &[&str] = &["signal", "model", "mean square (1)", "correlation of neighbours (0)", "white noise at most"];

/// A table of cells that are HTML already; nothing without rows.
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

fn effects(v: &Verdict) -> Vec<Vec<String>> {
    let row = |e: &Effect| {
        let parameters: Vec<String> = e
            .parameters
            .iter()
            .map(|(n, p)| escape(format!("{n} = {} ± {} {}", number(p.value), number(p.std), p.unit).trim_end()))
            .collect();
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

fn share(v: Maybe) -> String {
    v.map_or_else(|| "unknown".to_string(), percent)
}

fn gaps(v: &Verdict) -> Vec<Vec<String>> {
    let signal = |which: &str, name: &str, g: &SignalGap| {
        let cells = gap_row(name, g).map(|cell| escape(&cell));
        [vec![which.to_string()], cells.to_vec()].concat()
    };
    let all = |which: &str, c: &Columns| {
        let parts = [c.nominal, c.tolerances, c.effects].map(share);
        [vec![which.to_string(), "<b>all, of full scale</b>".to_string()], parts.to_vec(), vec![String::new()]].concat()
    };
    let rows = |which: &str, side: &Side| -> Vec<Vec<String>> {
        side.signals.iter().map(|(n, g)| signal(which, n, g)).chain([all(which, &side.total)]).collect()
    };
    [rows("held", &v.gap.held), rows("used", &v.gap.train)].concat()
}

fn drifts(v: &Verdict) -> Vec<Vec<String>> {
    let row = |d: &super::verdict::Drift| {
        let deviation = format!("{:+.2}", d.tolerances);
        let far = d.tolerances.abs() >= FAR;
        let deviation = if far { format!("<b class=\"far\">{deviation}</b>") } else { deviation };
        vec![escape(&d.parameter), number(d.nominal), number(d.value), number(d.std), deviation]
    };
    v.drifts.iter().map(row).collect()
}

fn places(v: &Verdict) -> Vec<Vec<String>> {
    let row = |p: &super::verdict::Located| {
        let node = escape(&p.node.join(", "));
        vec![escape(&p.place), p.kind.to_string(), format!("{:.1}", p.evidence), percent(p.share), node]
    };
    v.places.iter().map(row).collect()
}

/// What no effect explains, by its shape.
fn unexplained(v: &Verdict) -> Vec<Vec<String>> {
    let u = &v.unexplained;
    let place = u.place.as_deref().map_or_else(|| "unknown".to_string(), escape);
    let row = |shape: String, r2: String| vec![share(u.share), place.clone(), shape, r2];
    match &u.shape {
        Some(terms) => terms.iter().map(|t| row(escape(&t.term), percent(t.r2))).collect(),
        None => vec![row("none that is known".into(), String::new())],
    }
}

/// How far innovations are from white noise of the size expected.
fn white(problem: &Problem<'_>, left: &[Left]) -> Vec<Vec<String>> {
    let row = |name: &str, stage: &str, w: &Whiteness| {
        let coloured = w.neighbours.abs() > w.limit;
        let neighbours = format!("{:+.3}", w.neighbours);
        let neighbours = if coloured { format!("<b class=\"far\">{neighbours}</b>") } else { neighbours };
        vec![escape(name), stage.into(), format!("{:.2}", w.power), neighbours, format!("{:.3}", w.limit)]
    };
    let signal = |(i, s): (usize, &super::hypotheses::Signal)| {
        let models = left.iter().filter_map(move |(stage, left)| Some((left.get(i)?, stage)));
        models.map(|(w, stage)| row(&s.name, stage, w)).collect::<Vec<_>>()
    };
    problem.signals.iter().enumerate().flat_map(signal).collect()
}

/// Spectra of the innovations of all signals, in decibels over white noise.
fn spectrum(problem: &Problem<'_>, (stage, left): &Left) -> Panel {
    let level = |d: &f64| if *d > 0.0 { 10.0 * d.log10() } else { f64::NAN };
    let series = |(i, (s, w)): (usize, (&super::hypotheses::Signal, &Whiteness))| {
        curve(&s.name, &w.frequencies, &w.density.iter().map(level).collect::<Vec<f64>>(), i)
    };
    Panel {
        x_label: format!("frequency in Hz, {stage}"),
        y_label: "unexpected, dB over white".into(),
        series: problem.signals.iter().zip(left).enumerate().map(series).collect(),
        ..Panel::default()
    }
}

/// Per signal the first of the recordings against the nominal model and the corrected one.
fn panels(problem: &Problem<'_>, search: &Search, recordings: &[Recording], what: &str) -> Vec<Panel> {
    let Some(recording) = recordings.first() else { return Vec::new() };
    let settings = [search.nominal(problem), search.last().0.setting.clone()];
    let runs = settings.map(|s| held::simulate(&s, recording));
    let panel = |(i, signal): (usize, &super::hypotheses::Signal)| {
        let unit = problem.circuit.units.get(&signal.variable).map_or("", String::as_str);
        let mut series = vec![curve("measured", &recording.times, &recording.signals[i], 6)];
        for ((name, colour), run) in [("nominal", 1), ("corrected", 0)].into_iter().zip(&runs) {
            let Some(run) = run else { continue };
            series.push(curve(name, &recording.times[run.from..], &run.simulated[i], colour));
        }
        Panel {
            x_label: format!("time in s, {what}"),
            y_label: if unit.is_empty() { signal.name.clone() } else { format!("{} in {unit}", signal.name) },
            series,
            ..Panel::default()
        }
    };
    problem.signals.iter().enumerate().map(panel).collect()
}

/// What is missing over time at the place that stays unexplained; of two ports, at the first.
fn missing(problem: &Problem<'_>, search: &Search, v: &Verdict) -> Option<Panel> {
    let place = v.unexplained.place.as_deref()?.split('|').next()?;
    let there = |h: &Hypothesis| h.places().iter().any(|p| p.place == place || p.node.iter().any(|n| n == place));
    let disturbance = problem.disturbances.iter().position(there)?;
    let recording = problem.train.first()?;
    let values = locate::course(problem, search.last().0, search.accepted(), disturbance, recording)?;
    let attachment = &problem.disturbances[disturbance].attachments[0];
    let circuit = &problem.circuit;
    let of = |variable: &str| circuit.units.get(variable).map_or("", String::as_str);
    let unit = match &attachment.site {
        Site::Node(p) | Site::Into(p) | Site::Across(p, _) => circuit.ports[*p].through.unit.as_str(),
        Site::Sensor(name) => problem.signals.iter().find(|s| s.name == *name).map_or("", |s| of(&s.variable)),
        Site::Command(name) | Site::Parameter(name) => of(name),
    };
    let place = &attachment.place.place;
    Some(Panel {
        x_label: "time in s, a recording that was used: what the filter makes of the samples so far".into(),
        y_label: format!("missing at {place}{}{unit}", if unit.is_empty() { "" } else { " in " }),
        series: vec![curve("estimated", &recording.times[..values.len()], &values, 2)],
        ..Panel::default()
    })
}

fn curve(name: &str, x: &[f64], y: &[f64], colour: usize) -> Series {
    Series { name: name.into(), x: x.to_vec(), y: y.to_vec(), colour, ..Series::default() }
}
