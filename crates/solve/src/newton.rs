//! Damped Newton iteration for one algebraic loop, with fallbacks where it does not converge.
//!
//! A [`LoopCode`] and the array of values enter; the solution is left in the slots of the tearing unknowns. Lengths are
//! measured in nominal values. The damping is that of P. Deuflhard (Newton Methods for Nonlinear Problems, the natural
//! monotonicity test): a step is accepted when the simplified correction behind it is shorter than the step itself. The
//! test does not depend on the scaling of the equations. `min` and `max` only limit how far a step may go. Fallbacks
//! are a bracketing search for a single equation, Newton's homotopy, and undamped steps to another root.

use super::linear::{Lu, SingularMatrix};
use crate::lower::{ExecutableSystem, LoopCode};
use bramah_model::structure::Unknown;

/// The iteration ends when the correction is shorter than this, in units of the unknowns' sizes.
const TOLERANCE: f64 = 1e-11;
/// A correction below this that no longer shrinks is rounding error: the iteration ends too.
const ROUND_OFF: f64 = 1e-7;
/// Newton steps before the loop counts as not convergent.
const MAX_ITERATIONS: u32 = 60;
/// Damping factors below this end the iteration.
const SMALLEST_DAMPING: f64 = 1e-5;
/// The shortest step of Newton's homotopy, as a part of the initial residual.
const SMALLEST_PART: f64 = 1.0 / 256.0;
/// Distance beside a possible double root at which the equation is evaluated, in units of the unknown's size.
const ASIDE: f64 = 1e-3;
/// Newton steps of a linear loop at most: the solution and the refinement of its rounding.
const REFINEMENTS: u32 = 3;

/// Sizes and bounds of all variables, indexed by `VarId::index`.
#[derive(Clone, Debug, Default)]
pub struct VariableScales {
    /// Nominal values, positive, in the unit of the variable.
    pub nominal: Vec<f64>,
    /// The attribute `min`, or minus infinity.
    pub min: Vec<f64>,
    /// The attribute `max`, or infinity.
    pub max: Vec<f64>,
}

impl VariableScales {
    /// Evaluates the attributes of all variables with the parameters in `values`.
    pub fn new(system: &ExecutableSystem, values: &[f64]) -> Self {
        let mut scales = VariableScales::default();
        for v in (0..).map(bramah_expr::VarId).take(system.dae.variables.len()) {
            scales.nominal.push(system.nominal(v, values));
            scales.min.push(system.min(v, values).filter(|b| b.is_finite()).unwrap_or(f64::NEG_INFINITY));
            scales.max.push(system.max(v, values).filter(|b| b.is_finite()).unwrap_or(f64::INFINITY));
        }
        scales
    }

    /// Nominal value, minimum and maximum of an unknown. A derivative has the nominal value of its state and no bounds.
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
    /// The Jacobian is singular; holds the unknown without a pivot.
    Singular(Unknown),
    /// A residual is not finite at the first guess.
    NonFinite,
    /// Too many iterations, or damping factors that became too small.
    NoConvergence,
}

/// What is known of a loop that was not solved, for the message to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonFailure {
    /// Why the iteration ended.
    pub reason: NewtonFailureReason,
    /// Number of Newton iterations made.
    pub iterations: u32,
    /// Equations (indices into `Dae::equations`) with their residuals, largest first.
    ///
    /// The unit of a residual is the change that a nominal step of the unknowns causes in it.
    pub residuals: Vec<(u32, f64)>,
    /// Unknowns with first guess and last value; the largest change in nominal values comes first.
    pub unknowns: Vec<(Unknown, f64, f64)>,
    /// Equations whose residual was not finite.
    pub non_finite: Vec<u32>,
}

/// Workspace of one loop with n tearing unknowns, allocated once.
#[derive(Debug)]
pub struct Newton {
    /// Factors of the n x n Jacobian.
    lu: Lu,
    /// The tearing unknowns when `solve` was called.
    guess: Vec<f64>,
    /// The present iterate.
    x: Vec<f64>,
    /// A candidate for the next iterate.
    trial: Vec<f64>,
    /// The Newton correction at `x`.
    step: Vec<f64>,
    /// The simplified correction at `trial`, with the Jacobian of `x`.
    next: Vec<f64>,
    /// Entries of the Jacobian in the order of the loop's pattern.
    matrix: Vec<f64>,
    /// The value that each residual shall reach: 0, except on the way of [`Self::in_parts`].
    rest: Vec<f64>,
    /// Iterations of the present solution.
    iterations: u32,
    /// Whether another root is acceptable where the present one has ended.
    may_jump: bool,
    /// Whether the last solution was found by a search, so that it may be another root.
    searched: bool,
}

/// The result of one damped step.
enum LineSearchTrial {
    /// The step is accepted; holds the length of the simplified correction behind it.
    Accepted(f64),
    /// The simplified correction is not shorter than the step: try a smaller one.
    Longer,
    /// A residual or the correction is not finite.
    NonFinite,
}

impl Newton {
    /// Allocates the workspace of a loop.
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

    /// Sets whether undamped steps are tried where damped ones do not converge. Past a fold they reach another root.
    pub fn may_jump(&mut self, allowed: bool) {
        self.may_jump = allowed;
    }

    /// Whether the last solution was found by a search instead of from the guess. It may then be another root.
    pub fn searched(&self) -> bool {
        self.searched
    }

    /// Sets whether unknowns that the equations leave open may keep their value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// Whether some unknown kept its value in the last solution.
    pub fn keeps(&self) -> bool {
        self.lu.keeps()
    }

    /// Solves the loop from the values in the slots of its tearing unknowns. The inner variables are up to date
    /// afterwards.
    ///
    /// # Errors
    /// [`NewtonFailure`]; the slots hold the first guess again.
    pub fn solve(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> Result<(), NewtonFailure> {
        // a value left over from a failed evaluation must not spoil the start
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
        // recorded before the fallbacks below overwrite iterate and Jacobian
        let failure = self.failure(code, scales, values, reason);
        // a single equation can be solved without a derivative
        if self.x.len() == 1
            && !code.linear
            && (self.is_double_root(code, scales, values) || self.bracket(code, scales, values))
        {
            self.searched = true;
            return Ok(());
        }
        // homotopy follows the same root, so it comes before searches for other roots
        if failure.reason == NewtonFailureReason::NoConvergence && !code.linear && self.in_parts(code, scales, values) {
            return Ok(());
        }
        // only a run that has reached the end of its root allows this
        if self.may_jump && !code.linear && self.in_full_steps(code, scales, values) {
            self.searched = true;
            return Ok(());
        }
        // inner variables must belong to the guess again
        let guess = std::mem::take(&mut self.guess);
        evaluate(code, &guess, values);
        self.guess = guess;
        Err(failure)
    }

    /// Solves a linear loop by one Newton step, and further steps while they remove rounding error of the first guess.
    ///
    /// The signs of values that are tiny against the guess decide about modes, so that rounding error matters.
    fn linear(
        &mut self,
        code: &LoopCode,
        scales: &VariableScales,
        values: &mut [f64],
    ) -> Result<(), NewtonFailureReason> {
        self.iterations = 1;
        // a linear loop can start anywhere, for example at 0
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
        // with kept unknowns an equation remains: if it contradicts the others, its correction does not vanish
        if self.lu.keeps() && self.length(code, scales, &self.step) > TOLERANCE {
            return Err(NewtonFailureReason::NoConvergence);
        }
        Ok(())
    }

    /// The damped Newton iteration from `x`.
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
            // below ROUND_OFF a correction that does not shrink is rounding error
            if length <= TOLERANCE || (length <= ROUND_OFF && length > 0.5 * last) {
                return self.finish(code, values);
            }
            last = length;
            // the limits of the unknowns shorten the first trial only; the test below may shorten it further
            let bound = self.bound(code, scales);
            let (accepted, ahead) = self.damp(code, scales, values, damping.min(bound), length)?;
            std::mem::swap(&mut self.x, &mut self.trial);
            // a full step whose simplified correction is negligible is as good as one more iteration
            if accepted >= 1.0 && ahead <= TOLERANCE {
                return Ok(());
            }
            // the next iteration starts with twice the factor that was accepted
            damping = (2.0 * accepted).min(1.0);
        }
        Err(NewtonFailureReason::NoConvergence)
    }

    /// Takes the last, very small step. Where the residuals are not finite behind it, the iterate stays.
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

    /// Shortens the step until it is accepted. Returns the damping factor and the length of the simplified correction.
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
                // at the level of rounding the test decides nothing
                LineSearchTrial::Longer if length <= ROUND_OFF => return Ok((damping, 0.0)),
                LineSearchTrial::Longer => damping *= 0.5,
                // the domain of a root or logarithm was left: shortened faster than a step that is merely too long
                LineSearchTrial::NonFinite => damping *= 0.25,
            }
            if damping < SMALLEST_DAMPING {
                return Err(NewtonFailureReason::NoConvergence);
            }
        }
    }

    /// Tries the step with one damping factor.
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
        // the natural monotonicity test, relaxed as far as the damping shortens the step
        if ahead <= (1.0 - 0.25 * damping) * length {
            LineSearchTrial::Accepted(ahead)
        } else {
            LineSearchTrial::Longer
        }
    }

    /// Computes and factorizes the Jacobian at the values in the slots.
    fn factor(&mut self, code: &LoopCode, values: &mut [f64]) -> Result<(), NewtonFailureReason> {
        code.jacobian.run(values);
        for (m, &slot) in self.matrix.iter_mut().zip(&code.jacobian_slots) {
            *m = values[slot];
        }
        self.lu
            .factor(&self.matrix)
            .map_err(|SingularMatrix { column }| NewtonFailureReason::Singular(code.tearing[column]))
    }

    /// Computes the Newton correction into `step`.
    fn correction(&mut self, code: &LoopCode, values: &[f64]) {
        for ((b, &slot), rest) in self.step.iter_mut().zip(&code.residual_slots).zip(&self.rest) {
            *b = rest - values[slot];
        }
        self.lu.solve(&mut self.step);
    }

    /// The largest entry of a correction, relative to the larger of value and nominal value of its unknown.
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
                // stops short of the limit, where the equations may have no value
                part = part.min(0.9 * room / dx.abs());
            }
        }
        part.max(0.1)
    }

    /// Newton's homotopy: reduces the residuals of the guess to zero in parts, each solved from the part before.
    ///
    /// The flow over the square root of a pressure drop is flat far from zero, and a Newton step overshoots from one
    /// side to the other. In small parts the iteration follows the curve. True when the whole residual is removed.
    fn in_parts(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        let mut reached = self.guess.clone();
        if !evaluate(code, &reached, values) {
            return false;
        }
        let first: Vec<f64> = code.residual_slots.iter().map(|&slot| values[slot]).collect();
        let (mut at, mut step) = (0.0_f64, 0.25_f64);
        while at < 1.0 && step >= SMALLEST_PART {
            let next = (at + step).min(1.0);
            // F(x) = (1 - s) F(guess), with s from 0 to 1
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

    /// Undamped Newton steps from the guess and from points far from it on both sides.
    ///
    /// Where two roots have met and vanished (a snap-through, a comparator with positive feedback), damped steps end at
    /// the point where they met. True when another root was found.
    fn in_full_steps(&mut self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        [0.0, 1.0, -1.0, 10.0, -10.0].into_iter().any(|far| {
            for ((x, guess), &u) in self.x.iter_mut().zip(&self.guess).zip(&code.tearing) {
                *x = guess + far * guess.abs().max(scales.of(u).0);
            }
            self.full_steps(code, scales, values)
        })
    }

    /// The undamped iteration from `x`; true when it converges.
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

    /// Whether the guess is a double root of a single equation, as of `x^2 + y^2 = 1` at `x = 1`.
    ///
    /// The derivative vanishes there. The residual must be zero at the guess and different from zero on both sides. The
    /// values are those of the guess afterwards.
    fn is_double_root(&self, code: &LoopCode, scales: &VariableScales, values: &mut [f64]) -> bool {
        let guess = self.guess[0];
        let aside = ASIDE * guess.abs().max(scales.of(code.tearing[0]).0);
        let mut at =
            |x: f64| if evaluate(code, &[x], values) { values[code.residual_slots[0]].abs() } else { f64::NAN };
        let (below, above) = (at(guess - aside), at(guess + aside));
        let root = at(guess);
        below > 0.0 && above > 0.0 && root <= f64::EPSILON * below.min(above)
    }

    /// Searches for a root of a single equation around the guess; true when one is found.
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

    /// Collects what is known of the loop at its last iterate.
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

    /// For each residual the change that a nominal change of one unknown causes at most; 1 where that is not usable.
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

/// Sets the tearing unknowns and computes inner variables and residuals; true when all residuals are finite.
fn evaluate(code: &LoopCode, x: &[f64], values: &mut [f64]) -> bool {
    for (&slot, x) in code.tearing_slots.iter().zip(x) {
        values[slot] = *x;
    }
    code.residual.run(values);
    code.residual_slots.iter().all(|&slot| values[slot].is_finite())
}

/// A root of `at` near the guess, found from a change of sign.
///
/// The search widens the interval by powers of four on both sides. `None` when no change of sign is found.
fn find_root(at: &mut impl FnMut(f64) -> f64, guess: f64, nominal: f64, min: f64, max: f64) -> Option<f64> {
    // the widths range from 4^-8 to 4^23 sizes
    let size = nominal.max(guess.abs());
    let (mut below, mut above) = ((guess, at(guess)), (guess, at(guess)));
    for k in -8..24 {
        let width = size * 4.0_f64.powi(k);
        for (x, old) in [((guess - width).max(min), &mut below), ((guess + width).min(max), &mut above)] {
            let f = at(x);
            if !f.is_finite() {
                continue;
            }
            // a change of sign between this point and the previous one on the same side
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

/// Whether the residual at `x` is small compared with its neighbours.
///
/// The residual shrinks towards a root. At a pole or a jump the sign changes too, but the residual does not shrink.
fn is_root(at: &mut impl FnMut(f64) -> f64, x: f64, nominal: f64, min: f64, max: f64) -> bool {
    let near = 1e-6 * nominal.max(x.abs());
    let size = at(x).abs();
    [(x - near).max(min), (x + near).min(max)].into_iter().filter(|&beside| beside != x).all(|beside| {
        let f = at(beside);
        !f.is_finite() || size <= 0.5 * f.abs()
    })
}

/// Bisection with a secant step every other time. Returns the end with the smaller residual.
fn refine(at: &mut impl FnMut(f64) -> f64, [mut a, mut b]: [(f64, f64); 2]) -> f64 {
    for k in 0..200 {
        if b.1 == 0.0 {
            return b.0;
        }
        let secant = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        let middle = 0.5 * (a.0 + b.0);
        let inside = secant.is_finite() && (secant - a.0) * (secant - b.0) < 0.0;
        let x = if inside && k % 2 == 0 { secant } else { middle };
        // neighbouring floating-point numbers: nothing lies between
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
