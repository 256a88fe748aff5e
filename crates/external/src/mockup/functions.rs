//! The functions of an FMU that its Modelica text calls (see `text`), each a pure function of its arguments.
//!
//! The first argument is the state of the unit, a number that the pool turns into an instance (see `pool`).
//! Equations ask for one output at a time, so the last results are kept by their arguments. Derivatives come from the
//! unit where it offers them, else from central differences.

use super::FmuError;
use super::pool::InstancePool;
use bramah_expr::function::ExternalFunction;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// The time of the next event if the unit knows of none (s).
pub const NEVER: f64 = 1e60;
/// The number of results that are kept for each function.
const MOST_KEPT: usize = 64;
/// Step of a central difference, as a fraction of the argument's size: the cube root of the machine precision.
const STEP: f64 = 6e-6;

/// One of the functions of a unit. Each comment lists the arguments, then the outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuOperation {
    /// Parameters; the number of the first state.
    Begin,
    /// At the start. State, time, inputs; continuous states and discrete outputs.
    Start,
    /// Co-Simulation. State, start and end of the step, inputs; the next state and all outputs.
    Advance,
    /// Model Exchange, between events. State, time, continuous states, inputs; derivatives, event indicators, all
    /// outputs.
    Evaluate,
    /// Model Exchange, at an event. The same; next state, time of the next event, continuous states, discrete outputs.
    Event,
}

/// All outputs of a call, or the reason why the unit failed.
type FmuResult = Result<Arc<[f64]>, FmuError>;

/// One of the functions of a unit, or its derivatives by one argument.
pub struct FmuFunction {
    /// The instances of the unit.
    pool: Arc<InstancePool>,
    /// Which function it is.
    task: FmuOperation,
    /// The argument of the derivative. `None` for the function itself.
    by: Option<usize>,
    /// The last results by the bits of their arguments, oldest first. Failures are kept too.
    known: Mutex<VecDeque<(Box<[u64]>, FmuResult)>>,
    /// The failure of the last call. `None` if it succeeded.
    trouble: Mutex<Option<FmuError>>,
}

impl std::fmt::Debug for FmuFunction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} of {}", self.task, self.pool.description().name)
    }
}

impl FmuFunction {
    /// A function of a unit.
    pub fn new(pool: Arc<InstancePool>, task: FmuOperation) -> Self {
        FmuFunction { pool, task, by: None, known: Mutex::default(), trouble: Mutex::default() }
    }

    /// All outputs for some arguments. `None` if the unit failed, or an argument is not finite.
    /// The failure is recorded for messages.
    fn results(&self, args: &[f64]) -> Option<Arc<[f64]>> {
        // Solvers try steps that lead to NaN; the unit must not see such arguments, and it is not its failure.
        if args.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let found = self.found(args);
        found.as_ref().err().inspect(|why| self.pool.note(why));
        *self.trouble.lock().unwrap_or_else(PoisonError::into_inner) = found.as_ref().err().cloned();
        found.ok()
    }

    /// All outputs, from the kept results or from the unit.
    /// At most [`MOST_KEPT`] results are kept, and the oldest goes first.
    fn found(&self, args: &[f64]) -> FmuResult {
        let bits: Box<[u64]> = args.iter().map(|x| x.to_bits()).collect();
        let known =
            |all: &VecDeque<(Box<[u64]>, FmuResult)>| all.iter().rev().find(|k| k.0 == bits).map(|k| k.1.clone());
        if let Some(found) = known(&self.known.lock().unwrap_or_else(PoisonError::into_inner)) {
            return found;
        }
        // The lock is not held during the call, which may take long and may be made by several threads at once.
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
        // The state is an identifier, and what happens at events has no derivative.
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

/// The number of a state as the equations pass it.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number below 2^52")]
fn number(state: f64) -> u64 {
    state as u64
}

/// Calls a function of the unit and gives all its outputs.
/// The order of arguments and outputs is that of [`FmuOperation`].
fn compute(pool: &InstancePool, task: FmuOperation, args: &[f64]) -> Result<Vec<f64>, FmuError> {
    let description = pool.description();
    if task == FmuOperation::Begin {
        return Ok(vec![pool.root(args) as f64]);
    }
    let state = number(args[0]);
    let n = description.states.len();
    match task {
        FmuOperation::Begin | FmuOperation::Start => pool.look(state, args[1], &[], &args[2..], |instance| {
            // The order of the outputs here is the one that `text` reads them in.
            let mut found = vec![0.0; n];
            if n > 0 {
                instance.states(&mut found)?;
            }
            pool.read(instance, &discrete(pool), &mut found)?;
            Ok(found)
        }),
        FmuOperation::Advance => {
            let (from, to, inputs) = (args[1], args[2], &args[3..]);
            // At the start `from` and `to` are equal, and only outputs are wanted.
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
            // Outputs are read after the event, at the states that it has left.
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

/// The outputs that change at events only, as indices of variables.
pub fn discrete(pool: &InstancePool) -> Vec<usize> {
    let all = pool.outputs.iter().copied();
    all.filter(|&i| !pool.description().variables[i].continuous).collect()
}

/// The derivatives of all outputs by argument `by`: by the unit's own derivatives, or by central differences.
/// One call computes the derivatives of all outputs, which are kept like results.
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
    // The quotient uses the difference of the rounded arguments.
    let (low, high) = (args[by] - STEP * size, args[by] + STEP * size);
    let (below, above) = (at(low)?, at(high)?);
    Ok(below.iter().zip(&above).map(|(b, a)| (a - b) / (high - low)).collect())
}

/// The typical size of an argument, by the unit's nominal value or 1.
/// The arguments are state and time, then `n` continuous states, then inputs element by element.
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

/// Derivatives of all outputs by the function of the standard for directional derivatives.
/// `None` if it does not apply: by time, with event indicators or arrays, before the start, or if the unit lacks it.
fn directional(pool: &InstancePool, by: usize, args: &[f64]) -> Option<Result<Vec<f64>, FmuError>> {
    let description = pool.description();
    let n = description.states.len();
    let scalar = |i: &usize| description.variables[*i].dims.is_empty();
    let simple = description.indicators == 0 && pool.inputs.iter().chain(&pool.outputs).all(scalar);
    let state = number(args[0]);
    // In FMI the function may be called only after initialization.
    if !pool.has_derivatives() || !simple || by < 2 || pool.is_root(state) {
        return None;
    }
    let known = if by < 2 + n { description.states[by - 2].0 } else { *pool.inputs.get(by - 2 - n)? };
    let reference = |i: usize| description.variables[i].reference;
    let derivatives = description.states.iter().map(|s| s.1);
    let all: Vec<usize> = derivatives.chain(pool.outputs.iter().copied()).collect();
    // Outputs that change at events only have derivative 0.
    let smooth: Vec<usize> = all.iter().copied().filter(|&i| description.variables[i].continuous).collect();
    let unknowns: Vec<u32> = smooth.iter().map(|&i| reference(i)).collect();
    Some(pool.look(state, args[1], &args[2..2 + n], &args[2 + n..], |instance| {
        let mut slopes = vec![0.0; unknowns.len()];
        instance.directional(&unknowns, reference(known), &mut slopes)?;
        Ok(all.iter().map(|i| smooth.iter().position(|s| s == i).map_or(0.0, |k| slopes[k])).collect())
    }))
}
