//! Consistent values at the start: parameters, guesses, the initial system by damped Newton, homotopy where needed.

use super::blocks::{BlockFailure, Blocks, Setting};
use super::modes::Modes;
use super::newton::Scales;
use super::settings::Settings;
use crate::expr::{ExprId, Node};
use crate::flat::{Type, Variability};
use crate::lower::{Layout, System};
use crate::structure::{Block, Dae};

/// The shortest step of the homotopy parameter.
const SMALLEST_STEP: f64 = 1e-4;

/// Parameters as the settings say, and start values as guesses in all other variables.
pub fn prepare(system: &System, settings: &Settings) -> Vec<f64> {
    let mut values = system.layout.values();
    let mut overridden = vec![false; if settings.parameters.is_empty() { 0 } else { system.dae.variables.len() }];
    for &(v, value) in &settings.parameters {
        values[system.layout.var(v)] = value;
        overridden[v.index()] = true;
    }
    system.evaluate_parameters(&mut values, &overridden);
    values[Layout::TIME] = settings.start_time;
    guess(system, &mut values);
    values
}

fn guess(system: &System, values: &mut [f64]) {
    for (v, variable) in (0..).map(crate::expr::VarId).zip(&system.dae.variables) {
        let free = system.dae.free_parameters.contains(&v);
        if variable.variability <= Variability::Parameter && !free {
            continue;
        }
        let value = system.start(v, values).filter(|s| s.is_finite()).unwrap_or_else(|| {
            let nothing = if matches!(variable.ty, Type::Enumeration(_)) { 1.0_f64 } else { 0.0 };
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
/// What could not be solved; `values` is where it failed.
pub fn solve(system: &System, scales: &Scales, modes: &mut Modes, values: &mut [f64]) -> Result<(), BlockFailure> {
    values[Layout::INITIAL] = 1.0;
    modes.after = false;
    let mut start = Start { system, scales, modes, blocks: Blocks::new(&system.initial, scales, modes) };
    let guesses = values.to_vec();
    values[Layout::LAMBDA] = 1.0;
    let direct = start.run(values);
    let result = match direct {
        Err(failure) if worth_homotopy(&system.dae) => {
            let failed = values.to_vec();
            start.homotopy(values, &guesses).or_else(|_| {
                values.copy_from_slice(&failed);
                Err(failure)
            })
        }
        other => other,
    };
    values[Layout::LAMBDA] = 1.0;
    values[Layout::INITIAL] = 0.0;
    modes.after = true;
    result
}

fn worth_homotopy(dae: &Dae) -> bool {
    let is_homotopy = |e: u32| matches!(dae.exprs.node(ExprId(e)), Node::Homotopy(..));
    let loops = dae.initial.iter().any(|b| !matches!(b, Block::Assign(_)));
    loops && (0..u32::try_from(dae.exprs.len()).unwrap_or(0)).any(is_homotopy)
}

struct Start<'a> {
    system: &'a System,
    scales: &'a Scales,
    modes: &'a Modes,
    blocks: Blocks,
}

impl Start<'_> {
    fn run(&mut self, values: &mut [f64]) -> Result<(), BlockFailure> {
        let setting = Setting { system: self.system, scales: self.scales, modes: self.modes };
        self.blocks.run(&self.system.initial, &setting, values)?;
        if !self.system.dae.free_parameters.is_empty() {
            self.system.parameters_changed(values);
        }
        self.system.aliases(values);
        Ok(())
    }

    /// From the simplified system to the actual one in steps that grow while they succeed.
    fn homotopy(&mut self, values: &mut [f64], guesses: &[f64]) -> Result<(), BlockFailure> {
        values.copy_from_slice(guesses);
        values[Layout::LAMBDA] = 0.0;
        self.run(values)?;
        let (mut at, mut step) = (0.0_f64, 0.25_f64);
        let mut last = values.to_vec();
        while at < 1.0 {
            let next = (at + step).min(1.0);
            values[Layout::LAMBDA] = next;
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
