//! Chooses what is drawn of trajectories: which signals, in which panel, in which unit.
//!
//! Trajectories with labels and the user's options enter, a [`Figure`] leaves. Without a choice of the user, constants
//! and copies of the same signal are left out, and signals of one unit share a panel. The conversion to display units
//! stands here too.

use indexmap::IndexMap;
use rustc_hash::FxHasher;
use std::hash::Hasher;

use super::figure::{Figure, FigurePanel, PlotSeries};
use bramah_expr::units::MeasurementUnit;
use bramah_results::{GlobPatterns, Kind, Signal, Trajectory};

/// Curves in a panel. With more, the colours of the palette would repeat.
const CURVES: usize = 7;
/// Signals that are drawn at most when the user has not chosen any.
const UNASKED: usize = 28;

/// What to draw.
#[derive(Clone, Debug, Default)]
pub struct FigureOptions {
    /// Signals by name. Empty for all.
    pub variables: GlobPatterns,
    /// Panels composed by the user, each with its patterns. Empty for panels by unit.
    pub panels: Vec<GlobPatterns>,
    /// The signal on the horizontal axis. `None` for time.
    pub x: Option<String>,
    /// Text above the picture.
    pub title: String,
}

/// The units for signals without a `displayUnit`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnitSystem {
    /// The units of the model.
    #[default]
    AsGiven,
    /// The units of drawings and data sheets: bar, l/min, rev/min, mm, degC.
    Engineering,
}

/// SI units and what engineers write instead.
const ENGINEERING: [(&str, &str); 8] = [
    ("Pa", "bar"),
    ("m3/s", "l/min"),
    ("rad/s", "rev/min"),
    ("m", "mm"),
    ("m/s", "mm/s"),
    ("K", "degC"),
    ("rad", "deg"),
    ("N", "kN"),
];

impl UnitSystem {
    /// Gives signals without a display unit that of the system. Values are not changed.
    pub fn apply(self, trajectory: &mut Trajectory) {
        if self == UnitSystem::AsGiven {
            return;
        }
        for signal in trajectory.signals.iter_mut().filter(|s| s.display_unit.is_empty()) {
            if let Some((_, shown)) = ENGINEERING.iter().find(|(unit, _)| *unit == signal.unit) {
                signal.display_unit = (*shown).to_owned();
            }
        }
    }
}

/// A trajectory with a label that distinguishes its curves from those of other runs.
#[derive(Clone, Copy, Debug)]
pub struct LabelledTrajectory<'a> {
    /// Label such as the file name. It is shown when several runs are drawn.
    pub label: &'a str,
    /// The signals.
    pub trajectory: &'a Trajectory,
}

/// A figure, and what was left out of it.
#[derive(Clone, Debug, Default)]
pub struct FigureSelection {
    /// What to draw.
    pub figure: Figure,
    /// Number of signals left out because there were too many and the user had not chosen.
    pub left_out: usize,
}

/// Chooses the signals and groups them into panels.
///
/// Real signals are grouped by unit, Booleans together, each enumeration has its own panel. Without a unit, signals
/// with the same last name share a panel. Values are converted to their display units.
///
/// # Errors
/// A sentence, when nothing matches or the signal of the horizontal axis does not exist.
pub fn figure(runs: &[LabelledTrajectory<'_>], choice: &FigureOptions) -> Result<FigureSelection, String> {
    if !choice.panels.is_empty() {
        return by_hand(runs, choice);
    }
    let mut chosen = chosen_names(runs, choice)?;
    if choice.variables.is_empty() {
        worth_drawing(runs, &mut chosen);
    }
    let limit = if choice.variables.is_empty() { UNASKED } else { usize::MAX };
    let left_out = chosen.len().saturating_sub(limit);
    let mut groups: IndexMap<String, Vec<&Signal>> = IndexMap::new();
    for signal in chosen.into_iter().take(limit) {
        groups.entry(group(signal)).or_default().push(signal);
    }
    let mut panels = Vec::new();
    // `groups` keeps the order in which the units first appear.
    for signals in groups.values() {
        // Each run has its own curve, so several runs leave room for fewer signals.
        for part in signals.chunks((CURVES / runs.len()).max(1)) {
            panels.push(panel(runs, part, choice.x.as_deref())?);
        }
    }
    let figure = Figure { title: choice.title.clone(), panels, shared_x: choice.x.is_none() };
    Ok(FigureSelection { figure, left_out })
}

/// The panels that the user composed. All values of a panel are shown in the unit of its first signal.
///
/// `Err`: nothing matches, or a panel would hold signals of different units.
fn by_hand(runs: &[LabelledTrajectory<'_>], choice: &FigureOptions) -> Result<FigureSelection, String> {
    let mut panels = Vec::new();
    for globs in &choice.panels {
        let one = FigureOptions { variables: globs.clone(), panels: Vec::new(), ..choice.clone() };
        let mut signals = chosen_names(runs, &one)?;
        // The user's order of patterns is the order of the legend.
        signals.sort_by_key(|s| globs.position(&s.name));
        let like_first: Vec<Signal> = signals.iter().map(|s| shown_like(s, signals[0])).collect();
        if let Some(other) = like_first.iter().find(|s| group(s) != group(&like_first[0])) {
            let of = |s: &Signal| axis_label(&format!("`{}`", s.name), s);
            return Err(format!("one panel cannot hold both {} and {}", of(signals[0]), of(other)));
        }
        panels.push(panel(runs, &like_first.iter().collect::<Vec<_>>(), choice.x.as_deref())?);
    }
    let figure = Figure { title: choice.title.clone(), panels, shared_x: choice.x.is_none() };
    Ok(FigureSelection { figure, left_out: 0 })
}

/// A signal that is shown in the unit of another one, if its unit can be converted; else unchanged.
fn shown_like(signal: &Signal, first: &Signal) -> Signal {
    let like = Signal { display_unit: shown_unit(first).to_owned(), ..signal.clone() };
    if conversion(&like).is_some() || like.display_unit == like.unit { like } else { signal.clone() }
}

/// The chosen signals, each name once, in the order in which they first occur in the runs. `Err`: there is none.
fn chosen_names<'a>(runs: &[LabelledTrajectory<'a>], choice: &FigureOptions) -> Result<Vec<&'a Signal>, String> {
    let mut chosen: IndexMap<&str, &Signal> = IndexMap::new();
    for run in runs {
        for signal in &run.trajectory.signals {
            let wanted = choice.variables.is_empty() || choice.variables.matches(&signal.name);
            // The signal of the horizontal axis would be a diagonal line.
            if wanted && choice.x.as_deref() != Some(signal.name.as_str()) {
                chosen.entry(&signal.name).or_insert(signal);
            }
        }
    }
    if chosen.is_empty() {
        return Err("no variable matches".to_owned());
    }
    Ok(chosen.into_values().collect())
}

/// Removes what is not worth drawing when the user has not chosen: constants, and signals with the values of another
/// one.
///
/// Of equal signals the one with the shortest name stays. When nothing changes at all, everything is kept.
fn worth_drawing(runs: &[LabelledTrajectory<'_>], chosen: &mut Vec<&Signal>) {
    let mut seen: IndexMap<u64, Vec<&Signal>> = IndexMap::new();
    for &signal in chosen.iter() {
        // Connections make many equal signals. They are recognised by a hash of their bits.
        let (mut moves, mut values) = (false, FxHasher::default());
        for run in runs {
            let Some(index) = run.trajectory.index(&signal.name) else { continue };
            let column = &run.trajectory.columns[index];
            moves |= column.windows(2).any(|w| w[0].to_bits() != w[1].to_bits());
            column.iter().for_each(|v| values.write_u64(v.to_bits()));
        }
        if moves {
            seen.entry(values.finish()).or_default().push(signal);
        }
    }
    let depth = |s: &&&Signal| (s.name.matches('.').count(), s.name.len());
    let kept: Vec<&Signal> = seen.values().filter_map(|same| same.iter().min_by_key(depth).copied()).collect();
    // A figure of constants is better than an empty one.
    if !kept.is_empty() {
        *chosen = kept;
    }
}

/// The group of a signal; signals of one group share a panel.
fn group(signal: &Signal) -> String {
    match &signal.kind {
        Kind::Boolean => "Boolean".to_owned(),
        Kind::Enumeration(_) => format!("enumeration {}", signal.name),
        Kind::Real | Kind::Integer if !shown_unit(signal).is_empty() => format!("in {}", shown_unit(signal)),
        Kind::Real | Kind::Integer => format!("like {}", last_name(&signal.name)),
    }
}

/// The last part of a name without index and suffix: `p` of `pump.b.p`, `v[3].p` and `p_A`. Such signals probably
/// measure the same quantity.
fn last_name(name: &str) -> &str {
    let last = name.rsplit('.').next().unwrap_or(name);
    let end = last.find(['_', '[']).filter(|&i| i > 0).unwrap_or(last.len());
    &last[..end]
}

/// The display unit where values can be converted to it, else the unit.
pub fn shown_unit(signal: &Signal) -> &str {
    if conversion(signal).is_some() { &signal.display_unit } else { &signal.unit }
}

/// The units for a conversion to the display unit. `None`: there is no other one, or it has another dimension.
fn conversion(signal: &Signal) -> Option<(MeasurementUnit, MeasurementUnit)> {
    if signal.display_unit.is_empty() || signal.display_unit == signal.unit {
        return None;
    }
    let (from, to) = (MeasurementUnit::parse(&signal.unit).ok()?, MeasurementUnit::parse(&signal.display_unit).ok()?);
    (from.dimension == to.dimension).then_some((from, to))
}

/// A column of values in the display unit.
pub fn shown_values(signal: &Signal, column: &[f64]) -> Vec<f64> {
    match conversion(signal) {
        Some((from, to)) => column.iter().map(|&v| from.convert(v, &to).unwrap_or(v)).collect(),
        None => column.to_vec(),
    }
}

/// The label of an axis, such as `pump.b.p in bar`.
pub fn axis_label(name: &str, signal: &Signal) -> String {
    match shown_unit(signal) {
        "" => name.to_owned(),
        unit => format!("{name} in {unit}").trim_start().to_owned(),
    }
}

/// One panel with the given signals of all runs. `Err`: a run lacks the signal of the horizontal axis.
///
/// All signals belong to one group. The curves of all runs but the first are dashed.
fn panel(runs: &[LabelledTrajectory<'_>], signals: &[&Signal], x: Option<&str>) -> Result<FigurePanel, String> {
    let mut panel =
        FigurePanel { x_label: "time in s".to_owned(), y_label: y_label(signals), ..FigurePanel::default() };
    panel.words = words(signals[0]);
    for (r, run) in runs.iter().enumerate() {
        let horizontal = match x {
            None => run.trajectory.times.clone(),
            Some(name) => {
                let index = run.trajectory.index(name).ok_or_else(|| format!("there is no variable `{name}`"))?;
                let signal = &run.trajectory.signals[index];
                panel.x_label = axis_label(&signal.name, signal);
                shown_values(signal, &run.trajectory.columns[index])
            }
        };
        for (s, signal) in signals.iter().enumerate() {
            // A signal may be missing in some of the runs.
            let Some(index) = run.trajectory.index(&signal.name) else { continue };
            panel.series.push(PlotSeries {
                name: if runs.len() > 1 { format!("{} ({})", signal.name, run.label) } else { signal.name.clone() },
                x: horizontal.clone(),
                y: plotted(signal, &run.trajectory.columns[index]),
                // A staircase needs time on the horizontal axis.
                held: signal.kind.is_discrete() && x.is_none(),
                colour: s * runs.len() + r,
                dashed: r > 0,
                crosses: false,
            });
        }
    }
    Ok(panel)
}

/// Values as drawn: in the display unit, and literals of enumerations from 0, where their words are.
fn plotted(signal: &Signal, column: &[f64]) -> Vec<f64> {
    match signal.kind {
        Kind::Enumeration(_) => column.iter().map(|v| v - 1.0).collect(),
        _ => shown_values(signal, column),
    }
}

/// The words of the vertical axis for Booleans and enumerations; empty for numbers.
fn words(signal: &Signal) -> Vec<String> {
    match &signal.kind {
        Kind::Boolean => vec!["false".to_owned(), "true".to_owned()],
        Kind::Enumeration(literals) => literals.clone(),
        Kind::Real | Kind::Integer => Vec::new(),
    }
}

/// The label of the vertical axis: the name of a single curve, or the common last name of several, with the unit.
fn y_label(signals: &[&Signal]) -> String {
    let first = signals[0];
    if !words(first).is_empty() {
        // The words at the axis say enough.
        return String::new();
    }
    let last = last_name(&first.name);
    let common = signals.iter().all(|s| last_name(&s.name) == last);
    let name = if signals.len() == 1 && first.name.len() <= 24 {
        first.name.as_str()
    } else if common {
        last
    } else {
        ""
    };
    axis_label(name, first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Trajectory {
        let p = |name: &str| Signal { display_unit: "bar".into(), ..Signal::new(name).unit("Pa") };
        let mode = Kind::Enumeration(vec!["stick".into(), "slip".into()]);
        let mut t = Trajectory::new(vec![
            p("pump.p"),
            Signal::new("pump.q").unit("m3/s"),
            p("tank.p"),
            Signal { kind: Kind::Boolean, ..Signal::new("on") },
            Signal { kind: mode, ..Signal::new("mode") },
        ]);
        t.push(0.0, &[1e5, 1e-4, 2e5, 0.0, 1.0]);
        t.push(1.0, &[3e5, 2e-4, 4e5, 1.0, 2.0]);
        t
    }

    #[test]
    fn unasked_constants_and_copies_are_left_out() {
        let mut t = Trajectory::new(["line.port_a.p", "line.p", "k", "q"].map(Signal::new).to_vec());
        t.push(0.0, &[1.0, 1.0, 5.0, 0.0]);
        t.push(1.0, &[2.0, 2.0, 5.0, 1.0]);
        let run = LabelledTrajectory { label: "a", trajectory: &t };
        let drawn = |variables: &[&str]| {
            let choice = FigureOptions { variables: GlobPatterns::new(variables), ..FigureOptions::default() };
            let figure = figure(&[run], &choice).unwrap().figure;
            let names = figure.panels.iter().flat_map(|p| p.series.iter().map(|s| s.name.clone()));
            names.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(drawn(&[]), "line.p q");
        assert_eq!(drawn(&["*"]), "line.port_a.p line.p k q");
    }

    #[test]
    fn engineering_units_are_for_signals_without_their_own() {
        let mut t =
            Trajectory::new(vec![Signal::new("p").unit("Pa"), Signal::new("T").unit("K"), Signal::new("x").unit("m2")]);
        UnitSystem::Engineering.apply(&mut t);
        let shown: Vec<&str> = t.signals.iter().map(|s| s.display_unit.as_str()).collect();
        assert_eq!(shown, ["bar", "degC", ""]);
    }

    #[test]
    fn panels_by_unit() {
        let t = sample();
        let run = LabelledTrajectory { label: "a", trajectory: &t };
        let figure = figure(&[run], &FigureOptions::default()).unwrap().figure;
        let labels: Vec<(&str, usize)> = figure.panels.iter().map(|p| (p.y_label.as_str(), p.series.len())).collect();
        assert_eq!(labels, [("p in bar", 2), ("pump.q in m3/s", 1), ("", 1), ("", 1)]);
        assert_eq!(figure.panels[0].series[0].y, [1.0, 3.0]);
        assert_eq!(figure.panels[3].words, ["stick", "slip"]);
        assert_eq!(figure.panels[3].series[0].y, [0.0, 1.0]);
    }

    #[test]
    fn panels_by_hand() {
        let t = sample();
        let run = LabelledTrajectory { label: "a", trajectory: &t };
        let drawn = |panels: &[&str]| {
            let panels = panels.iter().map(|p| GlobPatterns::new(&[p])).collect();
            let found = figure(&[run], &FigureOptions { panels, ..FigureOptions::default() })?.figure;
            let names = |p: &FigurePanel| p.series.iter().map(|s| s.name.clone()).collect::<Vec<_>>().join(" ");
            Ok::<_, String>(found.panels.iter().map(names).collect::<Vec<_>>())
        };
        assert_eq!(drawn(&["tank.p,pump.p", "on", "*.p"]).unwrap(), ["tank.p pump.p", "on", "pump.p tank.p"]);
        let like = shown_like(&Signal::new("p").unit("Pa"), &t.signals[0]);
        assert_eq!(plotted(&like, &[2e5]), [2.0]);
        assert_eq!(drawn(&["pump.*"]).unwrap_err(), "one panel cannot hold both `pump.p` in bar and `pump.q` in m3/s");
        assert_eq!(drawn(&["nothing"]).unwrap_err(), "no variable matches");
    }

    #[test]
    fn two_runs_against_a_variable() {
        let t = sample();
        let runs =
            [LabelledTrajectory { label: "a", trajectory: &t }, LabelledTrajectory { label: "b", trajectory: &t }];
        let choice = FigureOptions {
            variables: GlobPatterns::new(&["tank.p"]),
            x: Some("pump.p".into()),
            ..FigureOptions::default()
        };
        let figure = figure(&runs, &choice).unwrap().figure;
        assert!(!figure.shared_x);
        assert_eq!(figure.panels[0].x_label, "pump.p in bar");
        assert_eq!(figure.panels[0].series[1].name, "tank.p (b)");
        let wrong = FigureOptions { x: Some("nothing".into()), ..choice };
        assert_eq!(super::figure(&runs, &wrong).unwrap_err(), "there is no variable `nothing`");
    }

    #[test]
    fn names_without_units() {
        assert_eq!(last_name("pump.b.p"), "p");
        assert_eq!(last_name("v[3].p"), "p");
        assert_eq!(last_name("p_A"), "p");
        assert_eq!(last_name("x[2]"), "x");
        assert_eq!(last_name("_x"), "_x");
    }
}
