//! A unit as the functions that its Modelica text calls (`text`), each a pure function of its arguments.

use super::FmuError;
use super::pool::InstancePool;
use bramah_expr::function::ExternalFunction;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// The next event of known time where there is none (s).
pub const NEVER: f64 = 1e60;
/// Results that are kept.
const MOST_KEPT: usize = 64;
/// Step of a central difference as a part of the argument's size: the cube root of the precision of an `f64`.
const STEP: f64 = 6e-6;

/// Which of the functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuOperation {
    /// Parameters to the first state: `state`.
    Begin,
    /// At the start: time, inputs to continuous states and discrete outputs.
    Start,
    /// Of Co-Simulation: state, from, to, inputs to the next state and all outputs.
    Advance,
    /// Of Model Exchange: state, time, continuous states, inputs to derivatives, event indicators and all outputs.
    Evaluate,
    /// Of Model Exchange: the same to the next state, the next event of known time, states and discrete outputs.
    Event,
}

/// A result, or why the unit has failed.
type FmuResult = Result<Arc<[f64]>, FmuError>;

/// A function of a unit, or its derivative by one argument.
pub struct FmuFunction {
    pool: Arc<InstancePool>,
    task: FmuOperation,
    by: Option<usize>,
    /// The last results, by the bits of their arguments.
    known: Mutex<VecDeque<(Box<[u64]>, FmuResult)>>,
    /// What went wrong with the last call.
    trouble: Mutex<Option<FmuError>>,
}

impl std::fmt::Debug for FmuFunction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} of {}", self.task, self.pool.description().name)
    }
}

impl FmuFunction {
    /// One of the functions.
    pub fn new(pool: Arc<InstancePool>, task: FmuOperation) -> Self {
        FmuFunction { pool, task, by: None, known: Mutex::default(), trouble: Mutex::default() }
    }

    fn results(&self, args: &[f64]) -> Option<Arc<[f64]>> {
        // a trial step of a solver that leads to nothing is not the unit's fault
        if args.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let found = self.found(args);
        found.as_ref().err().inspect(|why| self.pool.note(why));
        *self.trouble.lock().unwrap_or_else(PoisonError::into_inner) = found.as_ref().err().cloned();
        found.ok()
    }

    fn found(&self, args: &[f64]) -> FmuResult {
        let bits: Box<[u64]> = args.iter().map(|x| x.to_bits()).collect();
        let known =
            |all: &VecDeque<(Box<[u64]>, FmuResult)>| all.iter().rev().find(|k| k.0 == bits).map(|k| k.1.clone());
        if let Some(found) = known(&self.known.lock().unwrap_or_else(PoisonError::into_inner)) {
            return found;
        }
        let found = match self.by {
            None => compute(&self.pool, self.task, args).map(Arc::from),
            Some(by) => derivative(&self.pool, self.task, by, args).map(Arc::from),
        };
        let mut all = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() == MOST_KEPT {
            all.pop_front();
        }
        all.push_back((bits, found.clone()));
        found
    }
}

impl ExternalFunction for FmuFunction {
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        self.results(args).and_then(|all| all.get(output).copied()).unwrap_or(f64::NAN)
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        // the state is a name, and what happens at events has no slope
        let smooth = matches!(self.task, FmuOperation::Evaluate | FmuOperation::Start) && input > 0;
        (self.by.is_none() && smooth).then(|| {
            Arc::new(FmuFunction { by: Some(input), ..FmuFunction::new(self.pool.clone(), self.task) })
                as Arc<dyn ExternalFunction>
        })
    }

    fn trouble(&self) -> Option<String> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|why| self.pool.words(why))
    }

    fn failure(&self) -> Option<String> {
        self.pool.failure()
    }
}

/// The state as the equations pass it.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number below 2^52")]
fn number(state: f64) -> u64 {
    state as u64
}

fn compute(pool: &InstancePool, task: FmuOperation, args: &[f64]) -> Result<Vec<f64>, FmuError> {
    let description = pool.description();
    if task == FmuOperation::Begin {
        return Ok(vec![pool.root(args) as f64]);
    }
    let state = number(args[0]);
    let n = description.states.len();
    match task {
        FmuOperation::Begin | FmuOperation::Start => pool.look(state, args[1], &[], &args[2..], |instance| {
            let mut found = vec![0.0; n];
            if n > 0 {
                instance.states(&mut found)?;
            }
            pool.read(instance, &discrete(pool), &mut found)?;
            Ok(found)
        }),
        FmuOperation::Advance => {
            let (from, to, inputs) = (args[1], args[2], &args[3..]);
            let after = if to > from { pool.step(state, from, to, inputs)? } else { state };
            let mut found = vec![after as f64];
            let outputs = pool.look(after, to, &[], inputs, |instance| {
                let mut outputs = Vec::new();
                pool.read(instance, &pool.outputs, &mut outputs).map(|()| outputs)
            })?;
            found.extend(outputs);
            Ok(found)
        }
        FmuOperation::Evaluate => pool.look(state, args[1], &args[2..2 + n], &args[2 + n..], |instance| {
            let mut found = vec![0.0; n + description.indicators];
            if n > 0 {
                instance.derivatives(&mut found[..n])?;
            }
            if description.indicators > 0 {
                instance.indicators(&mut found[n..])?;
            }
            pool.read(instance, &pool.outputs, &mut found)?;
            Ok(found)
        }),
        FmuOperation::Event => {
            let (time, states, inputs) = (args[1], &args[2..2 + n], &args[2 + n..]);
            let happened = pool.event(state, time, states, inputs)?;
            let mut found = vec![happened.state as f64, happened.next.unwrap_or(NEVER)];
            let outputs = pool.look(happened.state, time, &happened.states, inputs, |instance| {
                let mut outputs = Vec::new();
                pool.read(instance, &discrete(pool), &mut outputs).map(|()| outputs)
            })?;
            found.extend(happened.states);
            found.extend(outputs);
            Ok(found)
        }
    }
}

/// Outputs that change at events only.
pub fn discrete(pool: &InstancePool) -> Vec<usize> {
    let all = pool.outputs.iter().copied();
    all.filter(|&i| !pool.description().variables[i].continuous).collect()
}

/// By the unit's own derivatives where it has them, else by central differences.
fn derivative(pool: &InstancePool, task: FmuOperation, by: usize, args: &[f64]) -> Result<Vec<f64>, FmuError> {
    if task == FmuOperation::Evaluate
        && let Some(found) = directional(pool, by, args)
    {
        return found;
    }
    let states = if task == FmuOperation::Evaluate { pool.description().states.len() } else { 0 };
    let size = args[by].abs().max(nominal(pool, states, by));
    let at = |x: f64| {
        let mut moved = args.to_vec();
        moved[by] = x;
        compute(pool, task, &moved)
    };
    let (low, high) = (args[by] - STEP * size, args[by] + STEP * size);
    let (below, above) = (at(low)?, at(high)?);
    Ok(below.iter().zip(&above).map(|(b, a)| (a - b) / (high - low)).collect())
}

/// The usual size of an argument, where the unit says it; behind state and time come so many states, then inputs.
fn nominal(pool: &InstancePool, n: usize, argument: usize) -> f64 {
    let description = pool.description();
    let of = |i: usize| description.variables[i].limits[2].map_or(1.0, f64::abs);
    match argument {
        0 | 1 => 1.0,
        _ if argument < 2 + n => of(description.states[argument - 2].0),
        _ => {
            let inputs = pool.inputs.iter().flat_map(|&i| std::iter::repeat_n(i, description.variables[i].size()));
            inputs.clone().nth(argument - 2 - n).map_or(1.0, of)
        }
    }
}

/// `None` where the unit does not offer it: for time, event indicators, arrays, and before its start.
fn directional(pool: &InstancePool, by: usize, args: &[f64]) -> Option<Result<Vec<f64>, FmuError>> {
    let description = pool.description();
    let n = description.states.len();
    let scalar = |i: &usize| description.variables[*i].dims.is_empty();
    let simple = description.indicators == 0 && pool.inputs.iter().chain(&pool.outputs).all(scalar);
    let state = number(args[0]);
    if !pool.has_derivatives() || !simple || by < 2 || pool.is_root(state) {
        return None;
    }
    let known = if by < 2 + n { description.states[by - 2].0 } else { *pool.inputs.get(by - 2 - n)? };
    let reference = |i: usize| description.variables[i].reference;
    let derivatives = description.states.iter().map(|s| s.1);
    let all: Vec<usize> = derivatives.chain(pool.outputs.iter().copied()).collect();
    let smooth: Vec<usize> = all.iter().copied().filter(|&i| description.variables[i].continuous).collect();
    let unknowns: Vec<u32> = smooth.iter().map(|&i| reference(i)).collect();
    Some(pool.look(state, args[1], &args[2..2 + n], &args[2 + n..], |instance| {
        let mut slopes = vec![0.0; unknowns.len()];
        instance.directional(&unknowns, reference(known), &mut slopes)?;
        Ok(all.iter().map(|i| smooth.iter().position(|s| s == i).map_or(0.0, |k| slopes[k])).collect())
    }))
}
