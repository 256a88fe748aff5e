//! Trajectory sensitivities: how the trajectories of variables change with parameters.
//!
//! A compiled model, settings of a run and parameters enter; a [`Sensitivity`] leaves, for `bramah sensitivity`, the
//! trait [`crate::Analyze`] and Python. The user's page is `docs/sensitivity.md`.
//!
//! Sensitivities are integrated with the states ([`TangentModel`]) and are right across events. They are checked once
//! against a finite difference in which all parameters move. Where they fail, central differences of tight runs replace
//! them, in which each run finds the moved event times itself. Where a jump moves in time, the difference between the
//! two event times is the jump over the step.

use super::TangentModel;
use super::lift::reading;
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::structure::StateChoice;
use bramah_results::Trajectory;
use bramah_solve::{Control, Settings, TangentRequest, signals, simulate};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Trajectories of variables and their derivatives by parameters.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// The run with the parameters' own values; its columns are the variables.
    pub plain: Trajectory,
    /// Name of each parameter, and the change that its columns refer to.
    pub parameters: Vec<(String, f64)>,
    /// For each parameter one column for each variable: derivative times the parameter's size, at the rows of `plain`.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// For each parameter why its columns are finite differences; `None` where they were integrated.
    pub differences: Vec<Option<String>>,
}

/// A parameter by which to differentiate.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitivityParameter {
    /// The model's parameter.
    pub variable: VarId,
    /// Its dotted name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The change that its sensitivity refers to: its absolute value, or its nominal value where that is zero.
    pub size: f64,
}

impl SensitivityParameter {
    /// A parameter with its value and size. `values` holds the values of all parameters.
    pub fn of(model: &CompiledModel, variable: VarId, values: &[f64]) -> Self {
        let system = &model.system;
        let value = values[system.layout.var(variable)];
        let size = if value == 0.0 { system.nominal(variable, values) } else { value.abs() };
        SensitivityParameter { variable, name: model.flat.variables[variable.index()].name.clone(), value, size }
    }
}

/// Largest relative tolerance of runs with sensitivities.
pub const TOLERANCE: f64 = 1e-9;

/// Step of central differences, relative to a parameter's size.
const STEP: f64 = 1e-4;

/// Largest number of failed trials; after these the remaining parameters get differences.
const MOST_DOUBTS: usize = 16;

/// For each parameter its integrated columns, or why there are none.
type SensitivityColumns = Vec<Result<Vec<Vec<f64>>, String>>;

/// Computes the sensitivities to `moved`, each by its own size.
///
/// # Errors
/// The message of the first run that failed.
pub fn sensitivity(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    interrupt: &AtomicBool,
) -> Result<Sensitivity, String> {
    let settings = Settings { event_rows: false, ..settings.clone() };
    let (mut plain, mut doubts) = (None, MOST_DOUBTS);
    let carried = carried(model, &settings, moved, (&mut plain, &mut doubts), interrupt);
    let plain = plain.map_or_else(|| run(model, &settings, None, interrupt), Ok)?;
    let doubtful = moved.iter().zip(&carried).filter(|(_, c)| c.is_err()).map(|(m, _)| m.clone());
    let doubtful: Vec<SensitivityParameter> = doubtful.collect();
    let tight = Settings { tolerance: settings.tolerance.min(TIGHT), ..settings.clone() };
    // Tight runs may fail where those with the tolerance of the settings do not.
    let mut others = by_differences(model, &tight, &doubtful, interrupt)
        .or_else(|_| by_differences(model, &settings, &doubtful, interrupt))?
        .into_iter();
    let mut found = Sensitivity {
        plain,
        parameters: moved.iter().map(|m| (m.name.clone(), m.size)).collect(),
        columns: Vec::new(),
        differences: Vec::new(),
    };
    for carried in carried {
        found.differences.push(carried.as_ref().err().cloned());
        found.columns.push(carried.unwrap_or_else(|_| others.next().expect("one for each doubtful parameter")));
    }
    Ok(found)
}

/// Integrates the sensitivities to all parameters at once; where that fails, to each half of them, and so on.
///
/// One parameter without valid sensitivities thus leaves those of the others exact. `plain` receives the rows of a run,
/// `doubts` counts the failures left.
fn carried(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    (plain, doubts): (&mut Option<Trajectory>, &mut usize),
    interrupt: &AtomicBool,
) -> SensitivityColumns {
    match by_equations(model, settings, moved, interrupt) {
        Ok((rows, columns)) => {
            plain.get_or_insert(rows);
            columns.into_iter().map(Ok).collect()
        }
        Err(why) if moved.len() < 2 || *doubts == 0 => moved.iter().map(|_| Err(why.clone())).collect(),
        Err(_) => {
            *doubts -= 1;
            let (first, second) = moved.split_at(moved.len() / 2);
            let mut found = carried(model, settings, first, (plain, doubts), interrupt);
            found.extend(carried(model, settings, second, (plain, doubts), interrupt));
            found
        }
    }
}

/// Largest difference between a sensitivity and a finite difference, relative to the largest value of the column.
const AGREE: f64 = 1e-3;

/// Tolerance of runs whose differences must not show integration errors. Behind events these errors jump with the
/// parameters, because the number of steps does.
const TIGHT: f64 = 1e-12;

/// Steps of the check relative to the parameters' sizes, and tolerances of its runs (1.0 keeps that of the settings).
///
/// First a long step, out of which integration errors do not show; then tight runs; then a shorter step for strongly
/// curved trajectories. Wrong sensitivities agree with none of them.
const CHECKS: [(f64, f64); 3] = [(1e-3, 1.0), (1e-3, TIGHT), (1e-4, TIGHT)];
/// Share of rows that may disagree, because they lie between the shifted times of an event.
const BETWEEN: f64 = 0.02;

/// Integrates the sensitivities to `moved` and checks them.
///
/// # Errors
/// Why they cannot be integrated or are not valid.
fn by_equations(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    interrupt: &AtomicBool,
) -> Result<(Trajectory, Vec<Vec<Vec<f64>>>), String> {
    let directions: Vec<(VarId, f64)> = moved.iter().map(|m| (m.variable, m.size)).collect();
    let tangent = TangentModel::new(&model.flat, &directions)?;
    let carried = tangent.starts(settings, &[])?;
    // Usually only the states control the step size. Steps that suit them may be too long for the sensitivities; then
    // these control the step too.
    let run = |controlled: bool| {
        let carried = TangentRequest { controlled, ..carried.clone() };
        along_the_run(model, (&tangent, carried), settings, moved, interrupt)
    };
    run(false).or_else(|why| run(true).map_err(|_| why))
}

/// One run with sensitivities that start as `carried` says. Returns its rows and the columns of each parameter.
fn along_the_run(
    model: &CompiledModel,
    (tangent, carried): (&TangentModel, TangentRequest),
    settings: &Settings,
    moved: &[SensitivityParameter],
    interrupt: &AtomicBool,
) -> Result<(Trajectory, Vec<Vec<Vec<f64>>>), String> {
    let all = Settings { tangents: Some(carried), ..settings.clone() };
    // The run records `wanted` once for the values and once more for each parameter.
    let cells: Vec<VarId> = (0..=moved.len()).flat_map(|_| settings.wanted.iter().copied()).collect();
    let mut rows = Trajectory::new(signals(&tangent.system.dae, &cells));
    let mut control = Control { interrupt: Some(interrupt), ..Control::default() };
    let run = simulate(&tangent.system, &all, &[], None, &mut rows, &mut control);
    let finite = rows.columns.iter().flatten().all(|v| v.is_finite());
    if !run.end.is_success() || !finite {
        let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
        return Err(said.unwrap_or_else(|| "the run with sensitivities did not reach its end".to_owned()));
    }
    let wanted = settings.wanted.len();
    let carried = rows.columns.split_off(wanted);
    rows.signals.truncate(wanted);
    let columns: Vec<Vec<Vec<f64>>> = carried.chunks(wanted.max(1)).map(<[_]>::to_vec).collect();
    agrees(model, settings, moved, (&rows, &columns), interrupt)?;
    Ok((rows, columns))
}

/// Checks against a finite difference along one direction in which all parameters move.
fn agrees(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    (plain, columns): (&Trajectory, &[Vec<Vec<f64>>]),
    interrupt: &AtomicBool,
) -> Result<(), String> {
    // A parameter bound to another moved one follows it. Moved itself it would lose its binding.
    let follows = |m: &SensitivityParameter| {
        let others = moved.iter().filter(|o| o.variable != m.variable);
        others.into_iter().any(|o| reading(&model.flat, &[o.variable]).iter().any(|(v, _)| *v == m.variable))
    };
    let share = |(k, m): (usize, &SensitivityParameter)| {
        // Different shares, so that errors of several columns do not cancel.
        let part = (1.0 + k as f64).cos();
        if follows(m) { 0.0 } else { inward(model, m).map_or(part, |side| side * part.abs()) }
    };
    let share: Vec<f64> = moved.iter().enumerate().map(share).collect();
    let over = |&(step, tolerance): &(f64, f64)| {
        let settings = Settings { tolerance: settings.tolerance.min(tolerance), ..settings.clone() };
        agrees_over(model, &settings, moved, (&share, step), (plain, columns), interrupt)
    };
    let mut checks = CHECKS.iter().map(over);
    let first = checks.next().expect("there are some");
    first.or_else(|why| checks.find_map(Result::ok).ok_or(why))
}

/// The side (1 or -1) on which a parameter has room, where it stands at a bound; `None` for room on both sides.
fn inward(model: &CompiledModel, moved: &SensitivityParameter) -> Option<f64> {
    let system = &model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let room = CHECKS[0].0 * moved.size;
    let below = system.min(moved.variable, &values).is_some_and(|min| moved.value - min < room);
    let above = system.max(moved.variable, &values).is_some_and(|max| max - moved.value < room);
    if below { Some(1.0) } else { above.then_some(-1.0) }
}

/// The derivative of the wanted variables along a change of parameters, one column for each variable.
///
/// Central differences; where the runs on one side fail, as at a bound, one-sided ones of second order.
fn along(
    model: &CompiledModel,
    settings: &Settings,
    change: &(impl Fn(f64) -> Vec<(VarId, f64)> + Sync),
    step: f64,
    interrupt: &AtomicBool,
) -> Result<Vec<Vec<f64>>, String> {
    let at = |steps: f64| run(model, settings, change(steps * step), interrupt);
    let (up, down) = rayon::join(|| at(1.0), || at(-1.0));
    let combined = match (up, down) {
        (Ok(up), Ok(down)) => combine(&[(&up, 0.5), (&down, -0.5)]),
        (Ok(near), Err(_)) => combine(&[(&at(0.0)?, -1.5), (&near, 2.0), (&at(2.0)?, -0.5)]),
        (Err(_), Ok(near)) => combine(&[(&at(0.0)?, 1.5), (&near, -2.0), (&at(-2.0)?, 0.5)]),
        (Err(why), Err(_)) => return Err(why),
    };
    let mut columns = combined.ok_or("moved runs end elsewhere")?;
    columns.iter_mut().flatten().for_each(|d| *d /= step);
    Ok(columns)
}

/// The weighted sum of runs; `None` where they have different numbers of rows.
fn combine(runs: &[(&Trajectory, f64)]) -> Option<Vec<Vec<f64>>> {
    let first = runs.first()?.0;
    runs.iter().all(|(run, _)| run.times.len() == first.times.len()).then_some(())?;
    let cell = |v: usize, row: usize| runs.iter().map(|(run, weight)| weight * run.columns[v][row]).sum();
    Some((0..first.columns.len()).map(|v| (0..first.times.len()).map(|row| cell(v, row)).collect()).collect())
}

/// Checks over one step, of which each parameter takes its share. `Err` says why the check failed.
fn agrees_over(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    (share, step): (&[f64], f64),
    (plain, columns): (&Trajectory, &[Vec<Vec<f64>>]),
    interrupt: &AtomicBool,
) -> Result<(), String> {
    let change = |by: f64| -> Vec<(VarId, f64)> {
        let movers = moved.iter().zip(share).filter(|(_, s)| **s != 0.0);
        movers.map(|(m, s)| (m.variable, m.value + by * s * m.size)).collect()
    };
    let differences = along(model, settings, &change, step, interrupt)?;
    let rows = columns.first().and_then(|c| c.first()).map_or(0, Vec::len);
    if differences.iter().any(|d| d.len() != rows) {
        return Err("moved runs end elsewhere".to_owned());
    }
    for v in 0..settings.wanted.len() {
        let sum = |row: usize| columns.iter().zip(share).map(|(c, s)| s * c[v][row]).sum::<f64>();
        let most = (0..rows).map(|row| sum(row).abs()).fold(0.0, f64::max);
        let size = plain.columns[v].iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let apart = |row: &usize| (differences[v][*row] - sum(*row)).abs() > AGREE * most + 1e-6 * size;
        // Between the two times at which an event happens, a difference quotient jumps: such rows say nothing.
        if (0..rows).filter(apart).count() > (rows as f64 * BETWEEN).ceil() as usize {
            let name = &model.flat.variables[settings.wanted[v].index()].name;
            return Err(format!("`{name}` does not follow its derivatives"));
        }
    }
    Ok(())
}

/// For each parameter its columns by central differences; all parameters in parallel.
fn by_differences(
    model: &CompiledModel,
    settings: &Settings,
    moved: &[SensitivityParameter],
    interrupt: &AtomicBool,
) -> Result<Vec<Vec<Vec<f64>>>, String> {
    let by = |m: &SensitivityParameter| {
        let change = |by: f64| vec![(m.variable, m.value + by * m.size)];
        along(model, settings, &change, STEP, interrupt)
    };
    moved.par_iter().map(by).collect()
}

/// A run with some parameters changed; the message of its error where it fails.
fn run(
    model: &CompiledModel,
    settings: &Settings,
    change: impl IntoIterator<Item = (VarId, f64)>,
    interrupt: &AtomicBool,
) -> Result<Trajectory, String> {
    let mut settings = settings.clone();
    settings.parameters.extend(change);
    let mut rows = Trajectory::new(signals(&model.dae, &settings.wanted));
    let mut reselect = |choice: &StateChoice| model.with_states(choice);
    let mut control = Control { interrupt: Some(interrupt), reselect: Some(&mut reselect), ..Control::default() };
    let run = simulate(&model.system, &settings, &[], None, &mut rows, &mut control);
    if run.end.is_success() {
        return Ok(rows);
    }
    let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
    Err(said.unwrap_or_else(|| run.end.word().to_owned()))
}

impl Sensitivity {
    /// How strongly a variable depends on a parameter: root mean square of the sensitivity over the range of the
    /// variable (or its size, where it is constant).
    ///
    /// A change of the parameter by 1 % changes the variable by this many per cent of its range.
    pub fn weight(&self, parameter: usize, variable: usize) -> f64 {
        let moved = &self.columns[parameter][variable];
        let plain = &self.plain.columns[variable];
        let rms = (moved.iter().map(|v| v * v).sum::<f64>() / moved.len().max(1) as f64).sqrt();
        let low = plain.iter().copied().fold(f64::INFINITY, f64::min);
        let high = plain.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let size = low.abs().max(high.abs());
        let scale = if high - low > 1e-9 * size { high - low } else { size };
        if scale > 0.0 { rms / scale } else { 0.0 }
    }

    /// Indices of the parameters by the sum of their weights over all variables, largest first.
    pub fn ranking(&self) -> Vec<usize> {
        let sum = |p: usize| (0..self.plain.columns.len()).map(|v| self.weight(p, v)).sum::<f64>();
        let mut order: Vec<(usize, f64)> = (0..self.parameters.len()).map(|p| (p, sum(p))).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        order.into_iter().map(|o| o.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_syntax::world::MemoryWorld;

    fn found(text: &str, parameters: &[&str], variable: &str, stop: f64) -> Sensitivity {
        let (model, settings, moved) = asked("m.mo", text, parameters, variable, stop);
        sensitivity(&model, &settings, &moved, &AtomicBool::new(false)).expect("runs")
    }

    /// A file's text, or a shipped class, and what is asked of it.
    fn asked(
        source: &str,
        text: &str,
        parameters: &[&str],
        variable: &str,
        stop: f64,
    ) -> (CompiledModel, Settings, Vec<SensitivityParameter>) {
        let world = MemoryWorld::single("m.mo", text);
        let request =
            bramah_model::compile::Request { source: source.into(), ..bramah_model::compile::Request::default() };
        let model =
            bramah_circuit::compiled::compile(&world, &request, &bramah_solve::lower::LoweringOptions::INTERPRETED)
                .value
                .expect("sound");
        let id = |n: &str| {
            let i = model.flat.variables.iter().position(|v| v.name == n).expect("there");
            VarId(u32::try_from(i).expect("small"))
        };
        let mut values = model.system.layout.values();
        model.system.evaluate_parameters(&mut values, &[]);
        let moved: Vec<SensitivityParameter> = parameters
            .iter()
            .map(|n| {
                let value = values[model.system.layout.var(id(n))];
                SensitivityParameter { variable: id(n), name: (*n).to_owned(), value, size: value.abs() }
            })
            .collect();
        let settings = Settings {
            stop_time: stop,
            interval: stop / 50.0,
            tolerance: 1e-9,
            wanted: vec![id(variable)],
            ..Settings::default()
        };
        (model, settings, moved)
    }

    #[test]
    fn a_decay_and_its_ranking() {
        let text = "model M parameter Real k = 2, x0 = 3, idle = 1; Real x(start = x0, fixed = true);
            equation der(x) = -k*x; end M;";
        let s = found(text, &["idle", "k", "x0"], "x", 1.0);
        for (row, &t) in s.plain.times.iter().enumerate() {
            let x = 3.0 * (-2.0 * t).exp();
            assert!((s.columns[1][0][row] + 2.0 * t * x).abs() < 3e-4, "{t}");
            assert!((s.columns[2][0][row] - x).abs() < 3e-4, "{t}");
        }
        assert_eq!((s.ranking(), s.differences.as_slice()), (vec![2, 1, 0], [None, None, None].as_slice()));
        assert_eq!(s.weight(0, 0), 0.0);
    }

    /// Both ways of very tight runs: a pressure with a valve that opens (a bend at an event), and shipped tanks.
    #[test]
    fn equations_and_differences_agree() {
        let valve = "model M parameter Real c = 3, G = 2, p_set = 0.4, a = 2*c; Real p(start = 0.1, fixed = true), v(start = 0, fixed = true), q;
            equation der(p) = c - a*v - q; der(v) = 4*p - v*abs(v); q = if p > p_set then G*(p - p_set) else 0; end M;";
        let tanks = ["outlet_1.a", "lower.A", "h_2_start"];
        for (source, parameters, variable, stop) in
            [("m.mo", &["c", "G", "p_set", "a"][..], "p", 4.0), ("CascadedTanks.Nominal", &tanks[..], "lower.h", 200.0)]
        {
            let (model, settings, moved) = asked(source, valve, parameters, variable, stop);
            let settings = Settings { event_rows: false, tolerance: 1e-12, ..settings };
            let quiet = AtomicBool::new(false);
            let exact = by_equations(&model, &settings, &moved, &quiet).expect("hold").1;
            let differences = by_differences(&model, &settings, &moved, &quiet).expect("run");
            for ((exact, other), m) in exact.iter().zip(&differences).zip(&moved) {
                let most = exact[0].iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let apart = exact[0].iter().zip(&other[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart <= 1e-6 * most && most > 0.0, "{source} {}: {apart} of {most}", m.name);
            }
        }
    }

    /// A parameter at its bound, beyond which an assertion stops the run, is moved to the other side alone.
    #[test]
    fn a_parameter_at_its_bound_moves_inwards() {
        for (bound, law) in [("min = 1", "p >= 1"), ("max = 1", "p <= 1")] {
            let text = format!(
                "model M parameter Real p({bound}) = 1, k = 2; Real x(start = 3, fixed = true);
                 equation assert({law}, \"beyond\"); der(x) = -k*p*noEvent(abs(x)); end M;"
            );
            let s = found(&text, &["p", "k"], "x", 1.0);
            assert_eq!(s.differences, [None, None], "{bound}");
            for (row, &t) in s.plain.times.iter().enumerate() {
                let exact = -2.0 * t * 3.0 * (-2.0 * t).exp();
                assert!((0..2).all(|p| (s.columns[p][0][row] - exact).abs() < 1e-4), "{bound} {t}");
            }
            let (model, settings, moved) = asked("m.mo", &text, &["p"], "x", 1.0);
            let settings = Settings { tolerance: 1e-11, event_rows: false, ..settings };
            let differences = by_differences(&model, &settings, &moved, &AtomicBool::new(false)).expect("one side");
            let exact = -2.0 * 3.0 * (-2.0_f64).exp();
            let end = differences[0][0].last().copied().unwrap_or_default();
            assert!((end - exact).abs() < 1e-6, "{bound}: {end} {exact}");
        }
    }

    /// The rate jumps where the state passes a threshold that moves: at an event this is carried, without one it is
    /// not.
    #[test]
    fn jumps_without_events_are_left_to_differences() {
        for (law, why) in [
            ("if x < p then 1 else 3", None),
            ("noEvent(if x < p then 1 else 3)", Some("`x` does not follow its derivatives")),
        ] {
            let text = format!(
                "model M parameter Real p = 1; Real x(start = 0, fixed = true); equation der(x) = {law}; end M;"
            );
            let s = found(&text, &["p"], "x", 2.0);
            assert_eq!(s.differences[0].as_deref(), why);
            // x = p + 3 (t - p) in the end
            assert!((s.columns[0][0][50] + 2.0).abs() < 1e-3, "{}", s.columns[0][0][50]);
        }
    }

    /// A check valve closes while the steps of the pressures are long: by its own derivatives the speed's offset was 8
    /// % off behind it, until their errors counted.
    #[test]
    fn derivatives_that_move_within_a_step_of_the_states() {
        let (model, settings, mut moved) = asked("ServoPump.DeadZone", "", &["speed.offset"], "p_A", 100.0);
        moved[0].size = 1.0;
        let settings = Settings { interval: 0.1, ..settings };
        let s = sensitivity(&model, &settings, &moved, &AtomicBool::new(false)).expect("runs");
        assert_eq!(s.differences, [None]);
        let tight = Settings { tolerance: TIGHT, event_rows: false, ..settings };
        let other = by_differences(&model, &tight, &moved, &AtomicBool::new(false)).expect("run");
        let most = other[0][0].iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let apart = s.columns[0][0].iter().zip(&other[0][0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-4 * most, "{apart} of {most}");
    }

    /// A parameter that a run cannot carry along leaves the others exact.
    #[test]
    fn one_parameter_alone_is_left_to_differences() {
        let text = "model M parameter Real p = 1, k = 2, q = 3, c = 1; Real x(start = 0, fixed = true), y(start = q, fixed = true);
            equation der(x) = noEvent(if x < p then 1 else 3); der(y) = c - k*y + 0.01*x; end M;";
        let s = found(text, &["k", "q", "p", "c"], "y", 2.0);
        let why: Vec<bool> = s.differences.iter().map(Option::is_some).collect();
        assert_eq!(why, [false, false, true, false], "{:?}", s.differences);
    }

    /// Across events against differences of tight runs: a mass that sticks and slips on a belt, and relief valves that
    /// open.
    #[test]
    fn events_of_shipped_models() {
        let belt = ("Belt", &["k", "F_s", "F_c", "v_belt", "m"][..], "x", 4.0);
        let valve = ("Hydraulic.Examples.ReliefValveExample", &["valve.p_set", "volume.V"][..], "volume.p", 1.0);
        let poppet = ("Hydraulic.Examples.ReliefValvePoppetExample", &["valve.p_set", "volume.V"][..], "volume.p", 1.0);
        for (source, parameters, variable, stop) in [belt, valve, poppet] {
            let (model, settings, moved) = asked(source, "", parameters, variable, stop);
            let settings = Settings { event_rows: false, tolerance: 1e-11, ..settings };
            let quiet = AtomicBool::new(false);
            let carried = by_equations(&model, &settings, &moved, &quiet).expect(source).1;
            let differences = by_differences(&model, &settings, &moved, &quiet).expect("run");
            for ((exact, other), m) in carried.iter().zip(&differences).zip(&moved) {
                let most = exact[0].iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let mut apart: Vec<f64> = exact[0].iter().zip(&other[0]).map(|(a, b)| (a - b).abs()).collect();
                apart.sort_by(f64::total_cmp);
                // but for the rows between the moved times of events
                let apart = apart[apart.len() - 1 - apart.len() / 20];
                assert!(apart <= 1e-4 * most && most > 0.0, "{source} {}: {apart} of {most}", m.name);
            }
        }
    }

    /// The height of a bouncing ball after its first bounce, exact: h = v1 s - g s^2/2 with s since the bounce.
    #[test]
    fn across_events() {
        let text =
            "model M parameter Real g = 9.81, e = 0.7; Real h(start = 1, fixed = true), v(start = 0, fixed = true);
            equation der(h) = v; der(v) = -g; when h < 0 then reinit(v, -e*pre(v)); end when; end M;";
        let s = found(text, &["g", "e"], "h", 0.8);
        assert_eq!(s.differences, [None, None]);
        let height = |g: f64, e: f64, t: f64| {
            let fall = (2.0 / g).sqrt();
            if t < fall { 1.0 - g * t * t / 2.0 } else { e * g * fall * (t - fall) - g * (t - fall).powi(2) / 2.0 }
        };
        for (row, &t) in s.plain.times.iter().enumerate() {
            let d = 1e-6;
            let by_g = 9.81 * (height(9.81 + d, 0.7, t) - height(9.81 - d, 0.7, t)) / (2.0 * d);
            let by_e = 0.7 * (height(9.81, 0.7 + d, t) - height(9.81, 0.7 - d, t)) / (2.0 * d);
            assert!((s.columns[0][0][row] - by_g).abs() < 1e-3, "g at {t}: {} {by_g}", s.columns[0][0][row]);
            assert!((s.columns[1][0][row] - by_e).abs() < 1e-3, "e at {t}: {} {by_e}", s.columns[1][0][row]);
        }
    }
}
