//! Damped Newton for one algebraic loop, measured in nominal values; a bracketing search when a single equation resists.
//!
//! The damping is that of Deuflhard: a step is accepted when the simplified correction behind it is shorter than the
//! step itself. It does not depend on how equations are scaled. `min` and `max` only bound how far a step may go.

use super::linear::{Lu, SingularMatrix};
use crate::lower::{ExecutableSystem, LoopCode};
use bramah_model::structure::Unknown;

/// A correction below this, in units of the unknown's size, ends the iteration.
const TOLERANCE: f64 = 1e-11;
/// When corrections stop shrinking below this, round-off has been reached.
const ROUND_OFF: f64 = 1e-7;
const MAX_ITERATIONS: u32 = 60;
const SMALLEST_DAMPING: f64 = 1e-5;
/// The smallest part of the first residuals that is taken away at once.
const SMALLEST_PART: f64 = 1.0 / 256.0;
/// How far beside a root its equation is looked at, in units of the unknown's size.
const ASIDE: f64 = 1e-3;
/// Steps of a linear loop at most.
const REFINEMENTS: u32 = 3;

/// Sizes and bounds of all variables, by `VarId::index`.
#[derive(Clone, Debug, Default)]
pub struct VariableScales {
    /// Nominal values, positive.
    pub nominal: Vec<f64>,
    /// `min`, or minus infinity.
    pub min: Vec<f64>,
    /// `max`, or infinity.
    pub max: Vec<f64>,
}

impl VariableScales {
    /// The attributes of all variables with the parameters in `values`.
    pub fn new(system: &ExecutableSystem, values: &[f64]) -> Self {
        let mut scales = VariableScales::default();
        for v in (0..).map(bramah_expr::VarId).take(system.dae.variables.len()) {
            scales.nominal.push(system.nominal(v, values));
            scales.min.push(system.min(v, values).filter(|b| b.is_finite()).unwrap_or(f64::NEG_INFINITY));
            scales.max.push(system.max(v, values).filter(|b| b.is_finite()).unwrap_or(f64::INFINITY));
        }
        scales
    }

    fn of(&self, unknown: Unknown) -> (f64, f64, f64) {
        match unknown {
            Unknown::Var(v) => (self.nominal[v.index()], self.min[v.index()], self.max[v.index()]),
            Unknown::Der(v) => (self.nominal[v.index()], f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

/// Why no solution was found.
#[derive(Clone, Debug, PartialEq)]
pub enum NewtonFailureReason {
    /// The matrix is singular; the unknown without pivot.
    Singular(Unknown),
    /// The equations have no finite value at the first guess.
    NonFinite,
    /// Too many iterations, or steps that shrink to nothing.
    NoConvergence,
}

/// What is known when a loop was not solved.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonFailure {
    /// Why.
    pub reason: NewtonFailureReason,
    /// Iterations made.
    pub iterations: u32,
    /// Equations (indices into `Dae::equations`) with their residuals in units that one nominal step of the unknowns
    /// would cause, largest first.
    pub residuals: Vec<(u32, f64)>,
    /// Unknowns with first guess and last value, largest change (in nominal values) first.
    pub unknowns: Vec<(Unknown, f64, f64)>,
    /// Equations whose value was not finite.
    pub non_finite: Vec<u32>,
}

/// The work space of one loop, allocated once.
#[derive(Debug)]
pub struct Newton {
    lu: Lu,
    guess: Vec<f64>,
    x: Vec<f64>,
    trial: Vec<f64>,
    step: Vec<f64>,
    next: Vec<f64>,
    matrix: Vec<f64>,
    /// What may be left of each residual: 0, but on the way in [`Self::in_parts`].
    rest: Vec<f64>,
    iterations: u32,
    /// Whether another root will do where the one at hand has ended.
    may_jump: bool,
    /// Whether the last solution was found by a search, away from the guess.
    searched: bool,
}

enum LineSearchTrial {
    /// Accepted; the length of the simplified correction.
    Accepted(f64),
    /// Not shorter than the step.
    Longer,
    NonFinite,
}

impl Newton {
    /// Work space for a loop.
    pub fn new(code: &LoopCode, scales: &VariableScales) -> Self {
        let n = code.tearing.len();
        let nominal: Vec<f64> = code.tearing.iter().map(|&u| scales.of(u).0).collect();
        Newton {
            lu: Lu::new(&code.pattern, &nominal),
            guess: vec![0.0; n],
            x: vec![0.0; n],
            trial: vec![0.0; n],
            step: vec![0.0; n],
            next: vec![0.0; n],
            matrix: vec![0.0; code.pattern.nnz()],
            rest: vec![0.0; n],
            iterations: 0,
            may_jump: false,
            searched: false,
        }
    }

    /// Whether full steps are tried where damped ones end nowhere: past a fold they lead to another root.
    pub fn may_jump(&mut self, allowed: bool) {
        self.may_jump = allowed;
    }

    /// Whether the last solution may be another root than that at hand: it was not found from the guess.
    pub fn searched(&self) -> bool {
        self.searched
    }

    /// Whether unknowns that the equations leave open may keep their value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// Whether some did in the last solution.
    pub fn keeps(&self) -> bool {
        self.lu.keeps()
    }

    /// Solves the loop from the values in the slots of its unknowns; inner variables are up to date afterwards.
    ///
    /// # Errors
    /// [`NewtonFailure`]; the slots hold the first guess again.
    pub fn solve(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> Result<(), NewtonFailure> {
        for (x, &slot) in self.x.iter_mut().zip(&code.tearing_slots) {
            *x = if values[slot].is_finite() { values[slot] } else { 0.0 };
        }
        self.guess.copy_from_slice(&self.x);
        self.iterations = 0;
        self.searched = false;
        let result = if code.linear { self.linear(code, scales, values) } else { self.iterate(code, scales, values) };
        let reason = match result {
            Ok(()) => return Ok(()),
            Err(reason) => reason,
        };
        let failure = self.failure(code, scales, values, reason);
        if self.x.len() == 1
            && !code.linear
            && (self.is_double_root(code, scales, values) || self.bracket(code, scales, values))
        {
            self.searched = true;
            return Ok(());
        }
        if failure.reason == NewtonFailureReason::NoConvergence && !code.linear && self.in_parts(code, scales, values) {
            return Ok(());
        }
        if self.may_jump && !code.linear && self.in_full_steps(code, scales, values) {
            self.searched = true;
            return Ok(());
        }
        let guess = std::mem::take(&mut self.guess);
        evaluate(code, &guess, values);
        self.guess = guess;
        Err(failure)
    }

    /// One step, and further ones as long as round-off of the first guess is seen: signs of values that are tiny beside
    /// the guess decide about modes.
    fn linear(
        &mut self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
    ) -> Result<(), NewtonFailureReason> {
        self.iterations = 1;
        if !evaluate(code, &self.x, values) {
            self.x.fill(0.0);
            if !evaluate(code, &self.x, values) {
                return Err(NewtonFailureReason::NonFinite);
            }
        }
        self.factor(code, values)?;
        for _ in 0..REFINEMENTS {
            self.correction(code, values);
            if !self.step.iter().all(|v| v.is_finite()) {
                return Err(NewtonFailureReason::NoConvergence);
            }
            let mut moved = false;
            for (x, dx) in self.x.iter_mut().zip(&self.step) {
                moved |= dx.abs() > 1e-14 * x.abs();
                *x += dx;
            }
            if !evaluate(code, &self.x, values) {
                return Err(NewtonFailureReason::NonFinite);
            }
            if !moved {
                break;
            }
        }
        // an equation that is left over and contradicts the others goes on pulling
        if self.lu.keeps() && self.length(code, scales, &self.step) > TOLERANCE {
            return Err(NewtonFailureReason::NoConvergence);
        }
        Ok(())
    }

    fn iterate(
        &mut self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
    ) -> Result<(), NewtonFailureReason> {
        if !evaluate(code, &self.x, values) {
            return Err(NewtonFailureReason::NonFinite);
        }
        let mut damping = 1.0_f64;
        let mut last = f64::INFINITY;
        while self.iterations < MAX_ITERATIONS {
            self.iterations += 1;
            self.factor(code, values)?;
            self.correction(code, values);
            let length = self.length(code, scales, &self.step);
            if !length.is_finite() {
                return Err(NewtonFailureReason::NoConvergence);
            }
            if length <= TOLERANCE || (length <= ROUND_OFF && length > 0.5 * last) {
                return self.finish(code, values);
            }
            last = length;
            let bound = self.bound(code, scales);
            let (accepted, ahead) = self.damp(code, scales, values, damping.min(bound), length)?;
            std::mem::swap(&mut self.x, &mut self.trial);
            if accepted >= 1.0 && ahead <= TOLERANCE {
                return Ok(());
            }
            damping = (2.0 * accepted).min(1.0);
        }
        Err(NewtonFailureReason::NoConvergence)
    }

    /// The last, tiny step.
    fn finish(&mut self, code: &LoopCode, values: &mut [f64]) -> Result<(), NewtonFailureReason> {
        for ((t, x), dx) in self.trial.iter_mut().zip(&self.x).zip(&self.step) {
            *t = x + dx;
        }
        if evaluate(code, &self.trial, values) {
            std::mem::swap(&mut self.x, &mut self.trial);
        } else {
            evaluate(code, &self.x, values);
        }
        Ok(())
    }

    /// Shortens the step until it is accepted; returns the damping used and the length of the correction behind it.
    fn damp(
        &mut self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
        first: f64,
        length: f64,
    ) -> Result<(f64, f64), NewtonFailureReason> {
        let mut damping = first;
        loop {
            match self.attempt(code, scales, values, damping, length) {
                LineSearchTrial::Accepted(ahead) => return Ok((damping, ahead)),
                LineSearchTrial::Longer if length <= ROUND_OFF => return Ok((damping, 0.0)),
                LineSearchTrial::Longer => damping *= 0.5,
                LineSearchTrial::NonFinite => damping *= 0.25,
            }
            if damping < SMALLEST_DAMPING {
                return Err(NewtonFailureReason::NoConvergence);
            }
        }
    }

    fn attempt(
        &mut self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
        damping: f64,
        length: f64,
    ) -> LineSearchTrial {
        for ((t, x), dx) in self.trial.iter_mut().zip(&self.x).zip(&self.step) {
            *t = x + damping * dx;
        }
        if !evaluate(code, &self.trial, values) {
            return LineSearchTrial::NonFinite;
        }
        for ((b, &slot), rest) in self.next.iter_mut().zip(&code.residual_slots).zip(&self.rest) {
            *b = rest - values[slot];
        }
        if !self.lu.solve(&mut self.next) {
            return LineSearchTrial::NonFinite;
        }
        let ahead = self.length(code, scales, &self.next);
        if ahead <= (1.0 - 0.25 * damping) * length {
            LineSearchTrial::Accepted(ahead)
        } else {
            LineSearchTrial::Longer
        }
    }

    fn factor(&mut self, code: &LoopCode, values: &mut [f64]) -> Result<(), NewtonFailureReason> {
        code.jacobian.run(values);
        for (m, &slot) in self.matrix.iter_mut().zip(&code.jacobian_slots) {
            *m = values[slot];
        }
        self.lu
            .factor(&self.matrix)
            .map_err(|SingularMatrix { column }| NewtonFailureReason::Singular(code.tearing[column]))
    }

    /// The Newton correction into `step`.
    fn correction(&mut self, code: &LoopCode, values: &[f64]) {
        for ((b, &slot), rest) in self.step.iter_mut().zip(&code.residual_slots).zip(&self.rest) {
            *b = rest - values[slot];
        }
        self.lu.solve(&mut self.step);
    }

    /// The largest entry of a correction in units of its unknown's size.
    fn length(&self, code: &LoopCode, scales: &VariableScales, step: &[f64]) -> f64 {
        let sizes = code.tearing.iter().zip(&self.x).map(|(&u, x)| x.abs().max(scales.of(u).0));
        step.iter().zip(sizes).fold(0.0, |m, (dx, size)| if dx.is_nan() { f64::NAN } else { (dx.abs() / size).max(m) })
    }

    /// The part of the step that keeps unknowns between `min` and `max`, but never less than a tenth.
    fn bound(&self, code: &LoopCode, scales: &VariableScales) -> f64 {
        let mut part = 1.0_f64;
        for ((&u, x), dx) in code.tearing.iter().zip(&self.x).zip(&self.step) {
            let (_, min, max) = scales.of(u);
            let room = if *dx < 0.0 { x - min } else { max - x };
            if room > 0.0 && dx.abs() > room {
                part = part.min(0.9 * room / dx.abs());
            }
        }
        part.max(0.1)
    }

    /// Newton's homotopy: the residuals of the guess are taken away in parts, each solved from where the part before has
    /// led. A flow over the root of a pressure drop is flat far from its zero, and Newton's method is thrown from one
    /// side of it to the other; in parts it follows.
    fn in_parts(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        let mut reached = self.guess.clone();
        if !evaluate(code, &reached, values) {
            return false;
        }
        let first: Vec<f64> = code.residual_slots.iter().map(|&slot| values[slot]).collect();
        let (mut at, mut step) = (0.0_f64, 0.25_f64);
        while at < 1.0 && step >= SMALLEST_PART {
            let next = (at + step).min(1.0);
            self.rest.iter_mut().zip(&first).for_each(|(rest, first)| *rest = (1.0 - next) * first);
            self.x.copy_from_slice(&reached);
            self.iterations = 0;
            if self.iterate(code, scales, values).is_ok() {
                reached.copy_from_slice(&self.x);
                at = next;
                step *= 2.0;
            } else {
                step *= 0.5;
            }
        }
        self.rest.fill(0.0);
        at >= 1.0
    }

    /// Newton's method without damping, from the guess and from either side far from it. Where two roots have met and
    /// vanished, as when a snap-through or a comparator with positive feedback lets go, damped steps end at the place where
    /// they met.
    fn in_full_steps(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        [0.0, 1.0, -1.0, 10.0, -10.0].into_iter().any(|far| {
            for ((x, guess), &u) in self.x.iter_mut().zip(&self.guess).zip(&code.tearing) {
                *x = guess + far * guess.abs().max(scales.of(u).0);
            }
            self.full_steps(code, scales, values)
        })
    }

    fn full_steps(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        for _ in 0..MAX_ITERATIONS {
            if !evaluate(code, &self.x, values) || self.factor(code, values).is_err() {
                return false;
            }
            self.correction(code, values);
            let length = self.length(code, scales, &self.step);
            self.x.iter_mut().zip(&self.step).for_each(|(x, dx)| *x += dx);
            if length <= TOLERANCE {
                return evaluate(code, &self.x, values);
            }
        }
        false
    }

    /// Whether the guess solves one equation whose derivative vanishes there, as `x^2 + y^2 = 1` at `x = 1`: a root all the same
    /// where values on both sides differ from 0. Values are those of the guess afterwards.
    fn is_double_root(&self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        let guess = self.guess[0];
        let aside = ASIDE * guess.abs().max(scales.of(code.tearing[0]).0);
        let mut at =
            |x: f64| if evaluate(code, &[x], values) { values[code.residual_slots[0]].abs() } else { f64::NAN };
        let (below, above) = (at(guess - aside), at(guess + aside));
        let root = at(guess);
        below > 0.0 && above > 0.0 && root <= f64::EPSILON * below.min(above)
    }

    /// A search for a root around the guess, for one equation.
    fn bracket(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        let (nominal, min, max) = scales.of(code.tearing[0]);
        let mut at = |x: f64| {
            evaluate(code, &[x], values);
            values[code.residual_slots[0]]
        };
        let Some(x) = find_root(&mut at, self.guess[0], nominal, min, max) else { return false };
        self.x[0] = x;
        at(x).is_finite()
    }

    fn failure(
        &self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
        reason: NewtonFailureReason,
    ) -> NewtonFailure {
        evaluate(code, &self.x, values);
        let weights = self.row_sizes(code, scales);
        let scaled = |i: usize| values[code.residual_slots[i]] / weights[i];
        let mut residuals: Vec<(u32, f64)> = (0..weights.len()).map(|i| (code.residuals[i].1, scaled(i))).collect();
        let non_finite = residuals.iter().filter(|r| !r.1.is_finite()).map(|r| r.0).collect();
        residuals.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let mut unknowns: Vec<(Unknown, f64, f64)> =
            code.tearing.iter().enumerate().map(|(i, &u)| (u, self.guess[i], self.x[i])).collect();
        let change = |u: &(Unknown, f64, f64)| ((u.2 - u.1) / scales.of(u.0).0).abs();
        unknowns.sort_by(|a, b| change(b).total_cmp(&change(a)));
        NewtonFailure { reason, iterations: self.iterations, residuals, unknowns, non_finite }
    }

    /// What a nominal change of the unknowns does to each residual.
    fn row_sizes(&self, code: &LoopCode, scales: &VariableScales) -> Vec<f64> {
        let mut sizes = vec![0.0_f64; code.residuals.len()];
        for j in 0..code.pattern.n {
            let nominal = scales.of(code.tearing[j]).0;
            for k in code.pattern.colptr[j]..code.pattern.colptr[j + 1] {
                let size = &mut sizes[code.pattern.rowidx[k]];
                *size = size.max(self.matrix[k].abs() * nominal);
            }
        }
        sizes.into_iter().map(|s| if s > 0.0 && s.is_finite() { s } else { 1.0 }).collect()
    }
}

/// Sets the tearing unknowns and computes the rest; true when all residuals are finite.
fn evaluate(code: &LoopCode, x: &[f64], values: &mut [f64]) -> bool {
    for (&slot, x) in code.tearing_slots.iter().zip(x) {
        values[slot] = *x;
    }
    code.residual.run(values);
    code.residual_slots.iter().all(|&slot| values[slot].is_finite())
}

/// The root next to the guess that a sign change shows, bisection steered by secants.
fn find_root(at: &mut impl FnMut(f64) -> f64, guess: f64, nominal: f64, min: f64, max: f64) -> Option<f64> {
    let size = nominal.max(guess.abs());
    let (mut below, mut above) = ((guess, at(guess)), (guess, at(guess)));
    for k in -8..24 {
        let width = size * 4.0_f64.powi(k);
        for (x, old) in [((guess - width).max(min), &mut below), ((guess + width).min(max), &mut above)] {
            let f = at(x);
            if !f.is_finite() {
                continue;
            }
            if f == 0.0 || (old.1.is_finite() && f.signum() != old.1.signum()) {
                let root = refine(at, [*old, (x, f)]);
                if is_root(at, root, nominal, min, max) {
                    return Some(root);
                }
            }
            *old = (x, f);
        }
    }
    None
}

/// Residuals shrink towards a root; at a pole or a jump, where the sign changes as well, they do not.
fn is_root(at: &mut impl FnMut(f64) -> f64, x: f64, nominal: f64, min: f64, max: f64) -> bool {
    let near = 1e-6 * nominal.max(x.abs());
    let size = at(x).abs();
    [(x - near).max(min), (x + near).min(max)].into_iter().filter(|&beside| beside != x).all(|beside| {
        let f = at(beside);
        !f.is_finite() || size <= 0.5 * f.abs()
    })
}

/// Bisection, with a secant step every other time.
fn refine(at: &mut impl FnMut(f64) -> f64, [mut a, mut b]: [(f64, f64); 2]) -> f64 {
    for k in 0..200 {
        if b.1 == 0.0 {
            return b.0;
        }
        let secant = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        let middle = 0.5 * (a.0 + b.0);
        let inside = secant.is_finite() && (secant - a.0) * (secant - b.0) < 0.0;
        let x = if inside && k % 2 == 0 { secant } else { middle };
        if x == a.0 || x == b.0 {
            break;
        }
        let f = at(x);
        if f.signum() == a.1.signum() { a = (x, f) } else { b = (x, f) }
    }
    if a.1.abs() < b.1.abs() { a.0 } else { b.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_a_steep_root_far_away() {
        let mut calls = 0;
        let mut f = |x: f64| {
            calls += 1;
            (x - 731.25).powi(3)
        };
        let root = find_root(&mut f, 0.0, 1.0, f64::NEG_INFINITY, f64::INFINITY).expect("there is one");
        assert!((root - 731.25).abs() < 1e-4);
        assert!(calls < 300, "{calls}");
    }

    #[test]
    fn no_bracket_without_a_root() {
        let f = |x: f64| x * x + 1.0;
        assert!(find_root(&mut { f }, 0.0, 1.0, f64::NEG_INFINITY, f64::INFINITY).is_none());
    }

    #[test]
    fn poles_and_jumps_are_no_roots() {
        let pole = |x: f64| 1.0 / (x - 3.0);
        assert!(find_root(&mut { pole }, 1.0, 1.0, f64::NEG_INFINITY, f64::INFINITY).is_none());
        let jump = |x: f64| if x < 3.0 { -1.0 } else { 2.0 };
        assert!(find_root(&mut { jump }, 1.0, 1.0, f64::NEG_INFINITY, f64::INFINITY).is_none());
        let root_behind_pole = |x: f64| 1.0 / (x - 3.0) - 0.01;
        let root = find_root(&mut { root_behind_pole }, 1.0, 1.0, f64::NEG_INFINITY, f64::INFINITY);
        assert!((root.expect("there is one") - 103.0).abs() < 1e-9);
    }

    #[test]
    fn keeps_inside_the_bounds() {
        let mut outside = false;
        let mut f = |x: f64| {
            outside |= x < 0.0;
            x.sqrt() - 30.0
        };
        let root = find_root(&mut f, 1.0, 1.0, 0.0, f64::INFINITY).expect("there is one");
        assert!((root - 900.0).abs() < 1e-6);
        assert!(!outside);
    }
}
