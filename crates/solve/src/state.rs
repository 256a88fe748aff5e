//! The state of a run at one time: saved, stored as bytes, and restored, also for another choice of states.
//!
//! It holds all variables by name, not only the states, so that algebraic loops and discrete values continue from their
//! last solution.

use super::past::DelayHistory;
use crate::lower::ExecutableSystem;
use bramah_expr::VarId;
use bramah_model::flat::Variability;
use rustc_hash::FxHashMap;

/// Everything that a run needs to continue from one time. Vectors have one entry per variable of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// The time in seconds.
    pub time: f64,
    /// Names of the variables.
    pub names: Vec<String>,
    /// Value of each variable.
    pub values: Vec<f64>,
    /// Derivative of each variable; NaN where the model does not use it.
    pub derivatives: Vec<f64>,
    /// The history that delays read; empty without delays.
    pub past: DelayHistory,
}

impl State {
    /// Whether the state belongs to a model with the same variables in the same order.
    pub fn fits(&self, system: &ExecutableSystem) -> bool {
        let variables = &system.dae.variables;
        self.names.len() == variables.len() && self.names.iter().zip(variables).all(|(n, v)| *n == v.name)
    }

    /// The state as bytes, for a model with the same variables: count, time, values, derivatives, history, all as
    /// little-endian 64-bit numbers. Names are left out.
    pub fn bytes(&self) -> Vec<u8> {
        let counts = [self.values.len() as f64];
        let numbers = counts.iter().chain([&self.time]).chain(&self.values).chain(&self.derivatives).copied();
        numbers.chain(self.past.numbers()).flat_map(f64::to_le_bytes).collect()
    }

    /// Reads the bytes of [`State::bytes`] for a model with these variables; `None` for other bytes.
    pub fn from_bytes(names: Vec<String>, bytes: &[u8]) -> Option<Self> {
        let (words, rest) = bytes.as_chunks::<8>();
        let numbers: Vec<f64> = words.iter().map(|w| f64::from_le_bytes(*w)).collect();
        let n = names.len();
        if !rest.is_empty() || numbers.len() < 2 + 2 * n || numbers[0] != n as f64 {
            return None;
        }
        let (values, derivatives) = (numbers[2..2 + n].to_vec(), numbers[2 + n..2 + 2 * n].to_vec());
        let past = DelayHistory::from_numbers(&numbers[2 + 2 * n..])?;
        Some(State { time: numbers[1], names, values, derivatives, past })
    }

    /// Copies the state from the slots in `values`.
    pub fn save(system: &ExecutableSystem, time: f64, values: &[f64], past: DelayHistory) -> Self {
        let ids = || (0..).map(VarId).take(system.dae.variables.len());
        State {
            time,
            names: system.dae.variables.iter().map(|v| v.name.clone()).collect(),
            values: ids().map(|v| values[system.layout.var(v)]).collect(),
            derivatives: ids().map(|v| system.layout.der(v).map_or(f64::NAN, |slot| values[slot])).collect(),
            past,
        }
    }

    /// Writes the state into `values`. Variables that it does not contain keep their values.
    ///
    /// Parameters keep theirs too, except those that the initial system had found, which are part of the state.
    pub fn restore(&self, system: &ExecutableSystem, values: &mut [f64]) {
        let same = self.names.len() == system.dae.variables.len();
        let same = same && self.names.iter().zip(&system.dae.variables).all(|(n, v)| *n == v.name);
        // names are needed only where the variables differ, for example after another choice of states
        let by_name: FxHashMap<&str, usize> = if same {
            FxHashMap::default()
        } else {
            self.names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect()
        };
        for (i, variable) in system.dae.variables.iter().enumerate() {
            let from = if same { Some(i) } else { by_name.get(variable.name.as_str()).copied() };
            let Some(from) = from else { continue };
            let v = VarId(u32::try_from(i).expect("fewer than 2^32 variables"));
            if variable.variability <= Variability::Parameter && !system.dae.free_parameters.contains(&v) {
                continue;
            }
            values[system.layout.var(v)] = self.values[from];
            // a saved state is consistent, so `pre(v)` equals `v`
            if let Some(pre) = system.layout.pre(v) {
                values[pre] = self.values[from];
            }
            if let Some(der) = system.layout.der(v)
                && self.derivatives[from].is_finite()
            {
                values[der] = self.derivatives[from];
            }
        }
    }
}
