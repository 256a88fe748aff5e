//! Consistent initial values: parameters, guesses, the initial system, and homotopy where the model asks for it.
//!
//! `prepare` fills the slots with parameters and start values. `solve` then solves the blocks of the initial system by
//! damped Newton (MLS 8.6). Where an expression contains `homotopy`, it follows the simplified system to the actual one
//! (MLS 3.7.4). `check_starts` compares redundant fixed starts with the solution. The driver calls them in this order.

use super::blocks::{BlockContext, BlockFailure, BlockWorkspace};
use super::modes::CrossingModes;
use super::newton::{NewtonFailure, NewtonFailureReason, VariableScales};
use super::report;
use super::settings::Settings;
use crate::lower::{ExecutableSystem, ValueLayout};
use bramah_expr::{ExprId, ExprNode, VarId};
use bramah_model::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType, Variability};
use bramah_model::structure::{BltBlock, Dae, Unknown, places, starts};
use bramah_syntax::diag::{Code, Diagnostic};

/// Relative deviation that is allowed between a redundant fixed start and the solution.
const CHECK_TOLERANCE: f64 = 1e-6;

/// The shortest step of the homotopy parameter, which goes from 0 to 1.
const SMALLEST_STEP: f64 = 1e-4;

/// A fresh array of values with the parameters of the settings, and start values as guesses for all other variables.
pub fn prepare(system: &ExecutableSystem, settings: &Settings) -> Vec<f64> {
    let mut values = system.layout.values();
    let mut overridden = vec![false; if settings.parameters.is_empty() { 0 } else { system.dae.variables.len() }];
    // a parameter of the settings replaces its binding
    for &(v, value) in &settings.parameters {
        values[system.layout.var(v)] = value;
        overridden[v.index()] = true;
    }
    system.evaluate_parameters(&mut values, &overridden);
    values[ValueLayout::TIME] = settings.start_time;
    guess(system, &mut values);
    values
}

/// Checks the assertions about parameters alone, when the settings give parameters.
///
/// Assertions with the model's own parameters were checked when its structure was analyzed.
///
/// # Errors
/// The first assertion that does not hold (E503).
pub fn check_parameters(system: &ExecutableSystem, settings: &Settings, values: &[f64]) -> Result<(), Diagnostic> {
    if settings.parameters.is_empty() {
        return Ok(());
    }
    let asserts = system.standing_asserts.iter().map(|&i| &system.dae.asserts[i]);
    match asserts.filter(|a| !a.warning).find(|a| system.eval(a.condition, values) == 0.0) {
        None => Ok(()),
        Some(assert) => {
            let text = report::message_text(system, &assert.message, values);
            let text = format!("{text} (with the parameters given)");
            Err(report::at_origin(&system.dae, Code::AssertionFailed, text, assert.origin, "does not hold").advised())
        }
    }
}

/// Writes start values into the slots of all variables that are no known parameters, and into their `pre` slots.
///
/// Parameters with `fixed = false` are unknowns of the initial system and get a guess too.
fn guess(system: &ExecutableSystem, values: &mut [f64]) {
    for (v, variable) in (0..).map(VarId).zip(&system.dae.variables) {
        let free = system.dae.free_parameters.contains(&v);
        if variable.variability <= Variability::Parameter && !free {
            continue;
        }
        let value = system.start(v, values).filter(|s| s.is_finite()).unwrap_or_else(|| {
            // without `start`: 0, or the first literal of an enumeration, moved between `min` and `max`
            let nothing = if matches!(variable.ty, ScalarType::Enumeration(_)) { 1.0_f64 } else { 0.0 };
            let nothing = system.min(v, values).map_or(nothing, |min| nothing.max(min));
            system.max(v, values).map_or(nothing, |max| nothing.min(max))
        });
        values[system.layout.var(v)] = if value.is_finite() { value } else { 0.0 };
        if let Some(pre) = system.layout.pre(v) {
            values[pre] = values[system.layout.var(v)];
        }
    }
    system.aliases(values);
}

/// Solves the initial system from the guesses in `values`.
///
/// # Errors
/// The block that could not be solved. `values` then holds the point of the failure.
pub fn solve(
    system: &ExecutableSystem,
    scales: &VariableScales,
    modes: &mut CrossingModes,
    values: &mut [f64],
) -> Result<(), BlockFailure> {
    values[ValueLayout::INITIAL] = 1.0;
    modes.after = false;
    let mut start =
        InitialSystemSolver { system, scales, modes, blocks: BlockWorkspace::new(&system.initial, scales, modes) };
    let guesses = values.to_vec();
    // where the model gives a homotopy, it decides to which of several roots the start belongs (MLS 3.7.4)
    let followed = worth_homotopy(&system.dae) && start.homotopy(values, &guesses).is_ok();
    let result = if followed {
        Ok(())
    } else {
        values.copy_from_slice(&guesses);
        values[ValueLayout::LAMBDA] = 1.0;
        start.run(values)
    };
    let result = match result {
        // only a Newton iteration that did not converge can profit from other guesses
        Err(BlockFailure::Loop(failure)) if failure.reason == NewtonFailureReason::NoConvergence => {
            let failed = values.to_vec();
            start.elsewhere(&failure, values, &guesses).map_err(|_| {
                // the message must show the point at which the model's own guesses failed
                values.copy_from_slice(&failed);
                BlockFailure::Loop(failure)
            })
        }
        other => other,
    };
    // from here on the run sees the actual system, without `initial()`
    values[ValueLayout::LAMBDA] = 1.0;
    values[ValueLayout::INITIAL] = 0.0;
    modes.after = true;
    result
}

/// Compares fixed starts that constraints have made redundant with the solution.
///
/// Returns warnings for starts that are only guesses.
///
/// # Errors
/// The first start with `fixed = true` that contradicts the others (E401).
pub fn check_starts(
    system: &ExecutableSystem,
    scales: &VariableScales,
    values: &[f64],
) -> Result<Vec<Diagnostic>, Diagnostic> {
    let mut missed = Vec::new();
    for &(residual, equation) in &system.dae.initial_checks {
        let equation = &system.dae.equations[equation as usize];
        let (found, asked) = (system.eval(equation.lhs, values), system.eval(equation.rhs, values));
        // the nominal value keeps the allowed deviation above zero for values near zero
        let nominal = match system.dae.exprs.node(equation.lhs) {
            ExprNode::Var(v) | ExprNode::Der(v) => scales.nominal[v.index()],
            // the terms of a sum cancel
            _ => terms(system, equation, values),
        };
        let allowed = CHECK_TOLERANCE * (found.abs().max(asked.abs()) + nominal);
        if system.eval(residual, values).abs() > allowed {
            match guessed(&system.dae, equation) {
                Some(v) => missed.push(missed_start(system, v, equation, found, asked)),
                None => return Err(contradiction(system, equation, found, asked)),
            }
        }
    }
    Ok(missed)
}

/// The variable of a check whose start is only a guess, because other starts are fixed (MLS 8.6). `None` otherwise.
fn guessed(dae: &Dae, equation: &FlatEquation) -> Option<VarId> {
    match dae.exprs.node(equation.lhs) {
        ExprNode::Var(v) if equation.origin.kind == OriginKind::Guess => Some(v),
        _ => None,
    }
}

/// The warning that a variable does not start at its `start`, which was only a guess.
///
/// `found` is its value and `asked` its `start`, both in its unit.
fn missed_start(system: &ExecutableSystem, v: VarId, equation: &FlatEquation, found: f64, asked: f64) -> Diagnostic {
    let dae = &system.dae;
    let name = dae.text(equation.lhs);
    let text = format!(
        "`{name}` starts at {}, not at {}: the other start values and the constraints make it so",
        report::number(found),
        report::number(asked)
    );
    let origin = ElementOrigin { span: places::place_of(&dae.variables, &dae.instances, v), ..equation.origin };
    let made = report::at_origin(dae, Code::StartMissed, text, origin, "its `start` was taken as a guess");
    match starts::modifier(&name, true) {
        Some(m) => made.help(format!("if it must hold, write `fixed = true` beside it: `{m}`")),
        None => made.help("if it must hold, write `fixed = true` beside it"),
    }
}

/// The largest absolute value of a variable that an equation reads: a scale for sums whose terms cancel.
fn terms(system: &ExecutableSystem, equation: &FlatEquation, values: &[f64]) -> f64 {
    let dae = &system.dae;
    let read = [equation.lhs, equation.rhs].into_iter().flat_map(|e| dae.exprs.variables(e));
    read.map(|v| values[system.layout.var(v)].abs()).fold(0.0, f64::max)
}

/// E401: a fixed start contradicts the other starts and the constraints.
///
/// `found` is the value that follows from the others, `asked` the fixed one. The help names modifiers that resolve it.
fn contradiction(system: &ExecutableSystem, equation: &FlatEquation, found: f64, asked: f64) -> Diagnostic {
    let dae = &system.dae;
    let name = dae.text(equation.lhs);
    let (found, asked) = (report::number(found), report::number(asked));
    let text =
        format!("`{name}` is to start at {asked}, but the other start values and the constraints make it {found}");
    let ExprNode::Var(v) = dae.exprs.node(equation.lhs) else {
        return report::at_origin(dae, Code::InitialOver, text, equation.origin, "this start is fixed")
            .help("fix fewer of the starts that the constraints tie together, or give values that fit");
    };
    let origin = ElementOrigin { span: places::place_of(&dae.variables, &dae.instances, v), ..equation.origin };
    let label = format!("`{name}` is fixed at the start");
    let behind = starts::parameter_behind(&dae.exprs, &dae.variables, v);
    let freed = starts::modifier(&name, false).map(|m| format!("let it follow from the others: `{m}`"));
    let given = behind.map(|p| format!("give a value that fits: `{p} = {found}`"));
    let ways: Vec<String> = freed.into_iter().chain(given).collect();
    let made = report::at_origin(dae, Code::InitialOver, text, origin, &label);
    if ways.is_empty() { made.help("free one of these starts") } else { made.help(ways.join("; or ")) }
}

/// Whether the model uses `homotopy` and the initial system has a loop in which it can matter.
///
/// Without a loop, every unknown is assigned explicitly and there is only one solution.
fn worth_homotopy(dae: &Dae) -> bool {
    let is_homotopy = |e: u32| matches!(dae.exprs.node(ExprId(e)), ExprNode::Homotopy(..));
    let loops = dae.initial.iter().any(|b| !matches!(b, BltBlock::Assign(_)));
    loops && (0..u32::try_from(dae.exprs.len()).unwrap_or(0)).any(is_homotopy)
}

/// The initial system and what is needed to solve it.
struct InitialSystemSolver<'a> {
    /// The lowered model.
    system: &'a ExecutableSystem,
    /// Sizes and bounds of all variables.
    scales: &'a VariableScales,
    /// Corrections of the modes of crossings.
    modes: &'a CrossingModes,
    /// Workspace of the blocks of the initial system.
    blocks: BlockWorkspace,
}

impl InitialSystemSolver<'_> {
    /// Solves all blocks in order from the values in the slots, then dependent parameters and aliases.
    ///
    /// `Err` with the first block that fails.
    fn run(&mut self, values: &mut [f64]) -> Result<(), BlockFailure> {
        let setting = BlockContext { system: self.system, scales: self.scales, modes: self.modes };
        self.blocks.run(&self.system.initial, &setting, values)?;
        // parameters with `fixed = false` were unknowns; those that depend on them follow now
        if !self.system.dae.free_parameters.is_empty() {
            self.system.parameters_changed(values);
        }
        self.system.aliases(values);
        Ok(())
    }

    /// Tries other guesses for the unknowns of a loop that was not solved: nominal values, ten times these, and a
    /// tenth.
    ///
    /// A pressure without `start` begins at the value of its connector, which may be far from the solution. `Err` with
    /// the last failure when all guesses fail.
    fn elsewhere(&mut self, failure: &NewtonFailure, values: &mut [f64], guesses: &[f64]) -> Result<(), BlockFailure> {
        let mut last = Ok(());
        for part in [1.0, 10.0, 0.1] {
            values.copy_from_slice(guesses);
            values[ValueLayout::LAMBDA] = 1.0;
            for &(unknown, ..) in &failure.unknowns {
                // a derivative has no nominal value of its own
                let Unknown::Var(v) = unknown else { continue };
                let i = v.index();
                let guess = part * self.scales.nominal[i];
                values[self.system.layout.var(v)] = guess.max(self.scales.min[i]).min(self.scales.max[i]);
            }
            last = self.run(values);
            if last.is_ok() {
                break;
            }
        }
        last
    }

    /// Follows the solution from the simplified system (parameter 0) to the actual one (parameter 1).
    ///
    /// The step doubles after a success and is halved after a failure, which starts again from the last solution. `Err`
    /// when the simplified system has no solution, or when the step becomes too small.
    fn homotopy(&mut self, values: &mut [f64], guesses: &[f64]) -> Result<(), BlockFailure> {
        values.copy_from_slice(guesses);
        values[ValueLayout::LAMBDA] = 0.0;
        self.run(values)?;
        let (mut at, mut step) = (0.0_f64, 0.25_f64);
        let mut last = values.to_vec();
        while at < 1.0 {
            let next = (at + step).min(1.0);
            values[ValueLayout::LAMBDA] = next;
            match self.run(values) {
                Ok(()) => {
                    last.copy_from_slice(values);
                    at = next;
                    step *= 2.0;
                }
                Err(failure) => {
                    values.copy_from_slice(&last);
                    step *= 0.5;
                    if step < SMALLEST_STEP {
                        return Err(failure);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lower::{LoweringOptions, lower};
    use std::sync::Arc;

    /// Two wheels in mesh with both speeds fixed.
    fn start(second: &str) -> Result<Vec<Diagnostic>, Diagnostic> {
        let text = format!(
            "model M
               Real w1(start = 1, fixed = true), w2(start = {second}, fixed = true), t;
             equation
               der(w1) = 3 - t;
               0.5*der(w2) = t;
               w2 = 2*w1;
             end M;"
        );
        let flat = bramah_model::compile::flatten_text(&text, None).value.expect("sound").flat;
        let dae = bramah_model::compile::analyze(&flat).value.expect("sound");
        let system = lower(Arc::new(dae), &LoweringOptions::INTERPRETED);
        let mut values = prepare(&system, &Settings::default());
        let scales = VariableScales::new(&system, &values);
        let mut modes = CrossingModes::new(&system, 1e-6);
        assert!(solve(&system, &scales, &mut modes, &mut values).is_ok());
        check_starts(&system, &scales, &values)
    }

    #[test]
    fn redundant_starts_must_agree() {
        assert_eq!(start("2"), Ok(Vec::new()));
        let error = start("3").expect_err("2*1 is not 3");
        assert_eq!(error.code, Code::InitialOver);
        assert!(error.message.contains("`w1` is to start at 1"), "{}", error.message);
    }
}
