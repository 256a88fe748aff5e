//! Runs examples and draws what a class does in them.

use bramah::internals::plot::figure::Figure;
use bramah::internals::plot::select::{FigureOptions, LabelledTrajectory, figure};
use bramah::internals::plot::svg;
use bramah::results::{GlobPatterns, Trajectory};
use bramah::{Code, Error, Simulation};
use std::collections::BTreeMap;

/// More panels than this are not drawn unasked.
const PANELS: usize = 4;
/// Nor more curves in one of them.
const CURVES: usize = 4;

/// Runs of examples, each made once.
#[derive(Default)]
pub struct Runs {
    done: BTreeMap<String, Option<Trajectory>>,
    /// What went wrong, for the end of the work.
    pub failed: Vec<String>,
}

impl Runs {
    /// The trajectory of a shipped example; nothing where its inputs have no values, or where it fails, which is remembered.
    pub fn of(&mut self, class: &str) -> Option<&Trajectory> {
        if !self.done.contains_key(class) {
            let run = Simulation::shipped(class).and_then(|s| s.run());
            let kept = match run {
                Ok(outcome) => Some(outcome.trajectory),
                // its inputs are recordings
                Err(error) if error.diagnostics.iter().all(|d| d.code == Code::NoInput) => None,
                Err(error) => {
                    self.failed.push(format!("{class}: {error}"));
                    None
                }
            };
            self.done.insert(class.to_owned(), kept);
        }
        self.done[class].as_ref()
    }
}

/// What the component `at` does in a run: its own variables that move, in few panels.
pub fn picture(trajectory: &Trajectory, at: &str) -> Option<String> {
    let inside = format!("{at}.");
    let depth = |name: &str| name.matches('.').count();
    let own: Vec<&str> = trajectory
        .signals
        .iter()
        .enumerate()
        .filter(|(i, s)| (s.name == at || s.name.starts_with(&inside)) && moves(&trajectory.columns[*i]))
        .map(|(_, s)| s.name.as_str())
        .filter(|name| !name.contains('['))
        .collect();
    let shallow: Vec<&str> = own.iter().copied().filter(|n| depth(n) <= 1).collect();
    let chosen = if shallow.is_empty() { own } else { shallow };
    if chosen.is_empty() {
        return None;
    }
    draw(trajectory, &GlobPatterns::new(&chosen)).map(|f| svg::write(&few(f)))
}

/// What a whole circuit does: its own variables, else those of its components.
pub fn overview(trajectory: &Trajectory) -> Option<String> {
    let moving = |depth: usize| -> Vec<&str> {
        let signals = trajectory.signals.iter().zip(&trajectory.columns);
        let chosen = signals.filter(|(s, c)| s.name.matches('.').count() == depth && !s.name.contains('[') && moves(c));
        chosen.map(|(s, _)| s.name.as_str()).collect()
    };
    let names = [moving(0), moving(1)].into_iter().find(|names| !names.is_empty())?;
    draw(trajectory, &GlobPatterns::new(&names)).map(|f| svg::write(&few(f)))
}

fn draw(trajectory: &Trajectory, variables: &GlobPatterns) -> Option<Figure> {
    let choice = FigureOptions { variables: variables.clone(), ..FigureOptions::default() };
    figure(&[LabelledTrajectory { label: "", trajectory }], &choice).ok().map(|s| s.figure)
}

fn few(mut figure: Figure) -> Figure {
    figure.panels.truncate(PANELS);
    figure.panels.iter_mut().for_each(|p| p.series.truncate(CURVES));
    figure
}

fn moves(column: &[f64]) -> bool {
    let (low, high) = column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    high - low > 1e-9 * high.abs().max(low.abs())
}

/// Runs a circuit of the book and draws the variables named; `x` is the one on the horizontal axis.
///
/// # Errors
/// What is wrong with the circuit, or that there is no such variable.
pub fn circuit(text: &str, variables: &[&str], x: Option<&str>) -> Result<String, String> {
    let outcome = Simulation::from_text(text).and_then(|s| s.run()).map_err(|e: Error| e.to_string())?;
    let choice =
        FigureOptions { variables: GlobPatterns::new(variables), x: x.map(str::to_owned), ..FigureOptions::default() };
    let drawn = figure(&[LabelledTrajectory { label: "", trajectory: &outcome.trajectory }], &choice)?;
    Ok(svg::write(&drawn.figure))
}
