//! SUNDIALS IDA (as part of IDAS) behind a safe interface.
//!
//! [`Ida`] integrates `F(t, y, y') = 0` with variable-order BDF (order 1 to 5) and finds sign changes of functions. The
//! equations come through the trait [`DaeEquations`]; the matrix and the linear solver are our own ([`Lu`]). `context`
//! holds the functions that C calls, `operations` our vector loops, `sensitivity` the forward sensitivities.
//! This module is the only one that knows SUNDIALS. Source: A. Hindmarsh et al., User Documentation for IDAS.

#![allow(unsafe_code, reason = "calls into SUNDIALS; each block states why it is sound")]

mod context;
mod operations;
mod sensitivity;

use super::linear::{Lu, SingularMatrix};
use crate::lower::SparsityPattern;
use context::{
    IdaContext, new_matrix, new_solver, new_vector, on_crossings, on_jacobian, on_residual, on_weights, slice,
};
use std::os::raw::{c_int, c_long, c_void};
use std::ptr::null_mut;
use sundials_sys as s;

/// Number of failures within one step before IDA gives up, unless the shortest step comes first.
///
/// IDA's default of 10 stops at a millionth of the usual step. That is too early at the edge of a valve, where the
/// pressure between closed valves changes fast as one of them opens.
const MOST_FAILURES: c_int = 30;

/// The result of an evaluation of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvaluationStatus {
    /// All values are finite.
    Done,
    /// Some value is not finite: IDA shall repeat the step with a smaller one.
    Retry,
}

/// The equations `F(t, y, y') = 0`, their Jacobian and their crossing functions. All vectors have n entries.
pub trait DaeEquations {
    /// Writes `F(t, y, yp)` to `r`.
    fn residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> EvaluationStatus;

    /// As `residual`, with rows `y' - f` for as many unknowns as possible. The default is `residual` itself.
    fn rate_residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> EvaluationStatus {
        self.residual(t, y, yp, r)
    }

    /// Writes all entries of `dF/dy + cj dF/dyp` to `val`, in the order of the sparsity pattern.
    fn jacobian(&mut self, t: f64, cj: f64, y: &[f64], yp: &[f64], val: &mut [f64]) -> EvaluationStatus;

    /// Writes the functions whose sign changes are events to `g`, one entry per root function.
    fn crossings(&mut self, t: f64, y: &[f64], yp: &[f64], g: &mut [f64]);
}

/// Equations with directional derivatives, for sensitivities.
pub trait DifferentiableEquations: DaeEquations {
    /// Computes dF/dy and dF/dyp at a point; does nothing when they are stored for this point.
    fn differentiate(&mut self, t: f64, y: &[f64], yp: &[f64]) -> EvaluationStatus;

    /// Discards the stored derivatives, because the equations have changed, for example at an event.
    fn forget(&mut self);

    /// Writes `dF/dy s + dF/dyp sp` at the stored point to `r`.
    fn along(&self, s: &[f64], sp: &[f64], r: &mut [f64]);
}

/// Why a call of [`Ida::advance`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdvanceReturn {
    /// The requested time is reached; the values are interpolated within the last step.
    Output,
    /// The stop time is reached exactly, at the end of a step.
    Stop,
    /// A crossing function has changed sign. The time returned lies just behind the root.
    Root,
    /// The number of steps given to [`Ida::pause_after`] has been made; nothing else is due.
    Pause,
}

/// Why IDA gave up.
#[derive(Clone, Debug, PartialEq)]
pub enum IdaFailure {
    /// The error test failed too often within one step, or with the shortest step.
    ErrorTest,
    /// The corrector did not converge.
    Convergence,
    /// The iteration matrix stayed singular; holds the column without pivot, if known.
    Singular(Option<SingularMatrix>),
    /// The residual or the Jacobian was not finite however small the step.
    NonFinite,
    /// The tolerance is too small for the precision of 64-bit numbers.
    TooMuchAccuracy,
    /// A callback panicked; holds its message.
    Panic(String),
    /// Any other negative return code of IDA.
    Code(i32),
}

/// Error tolerances. The weight of unknown i in IDA's norm is `share[i] / (relative * |y[i]| + absolute[i])`.
#[derive(Clone, Debug)]
pub struct IntegratorTolerances {
    /// Tolerance relative to the values.
    pub relative: f64,
    /// Absolute tolerances, one per unknown, positive.
    pub absolute: Vec<f64>,
    /// Factor on the weighted error, one per unknown. IDA's norm is the root mean square over all unknowns; a step is
    /// accepted when the norm of its error is below 1.
    pub share: Vec<f64>,
}

/// Work done since the integrator was created, restarts included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IntegratorCounters {
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the residual.
    pub residuals: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
    /// Factorizations of the iteration matrix.
    pub factorizations: u64,
    /// Steps repeated because their estimated error was too large.
    pub error_test_failures: u64,
    /// Steps in which the corrector did not converge.
    pub convergence_failures: u64,
    /// Evaluations of the crossing functions.
    pub crossings: u64,
}

/// One integrator with its equations. It owns all C objects and frees them when dropped.
pub struct Ida<E: DaeEquations> {
    /// The SUNDIALS context in which all objects are created.
    sundials: s::SUNContext,
    /// IDA's memory block.
    memory: *mut c_void,
    /// Unknowns at the time last returned.
    y: s::N_Vector,
    /// Derivatives at that time.
    yp: s::N_Vector,
    /// A vector into which IDA writes for short queries.
    scratch: s::N_Vector,
    /// Shell of the Jacobian; its content is a `Vec<f64>` with one value per entry of the pattern.
    matrix: s::SUNMatrix,
    /// Shell of the linear solver; its content is `context`.
    solver: s::SUNLinearSolver,
    /// Equations, tolerances and LU, which the callbacks reach by this pointer. Made by `Box::into_raw`.
    context: *mut IdaContext<E>,
    /// Number of unknowns.
    n: usize,
    /// Vectors for sensitivities: the values of all directions, then their time derivatives.
    tangents: Vec<s::N_Vector>,
    /// Work done before the last restart; IDA's own counters start again there.
    before: IntegratorCounters,
    /// Directions of the roots last found, one entry per crossing function.
    found: Vec<c_int>,
}

// SAFETY: the C objects are owned by this value alone and SUNDIALS keeps no thread-local state.
unsafe impl<E: DaeEquations + Send> Send for Ida<E> {}

impl<E: DaeEquations> Ida<E> {
    /// Creates an integrator at time `t` with consistent `y` and `yp`. There must be at least one unknown.
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS rejects the input.
    pub fn new(
        equations: E,
        pattern: &SparsityPattern,
        lu: Lu,
        roots: usize,
        tolerances: &IntegratorTolerances,
        (t, y, yp): (f64, &[f64], &[f64]),
    ) -> Result<Self, IdaFailure> {
        let n = pattern.n;
        assert!(n > 0 && y.len() == n && yp.len() == n && tolerances.absolute.len() == n, "sizes agree");
        let mut sundials = null_mut();
        // SAFETY: creates a context; without error handlers nothing is printed
        unsafe {
            assert_eq!(s::SUNContext_Create(s::comm_no_mpi(), &raw mut sundials), 0, "SUNDIALS has no memory");
            s::SUNContext_ClearErrHandlers(sundials);
        }
        // a raw pointer, since C code keeps it while Rust code uses it too
        let context = Box::into_raw(Box::new(IdaContext {
            equations,
            n,
            roots,
            tolerances: tolerances.clone(),
            lu,
            singular: None,
            residual_calls: 0,
            jacobian_calls: 0,
            crossing_calls: 0,
            non_finite: false,
            panic: None,
        }));
        let mut ida = Ida {
            sundials,
            // SAFETY: the context lives until drop
            memory: unsafe { s::IDACreate(sundials) },
            y: new_vector(y, sundials),
            yp: new_vector(yp, sundials),
            scratch: new_vector(y, sundials),
            matrix: new_matrix(pattern.nnz(), sundials),
            solver: new_solver(context, sundials),
            context,
            n,
            tangents: Vec::new(),
            before: IntegratorCounters::default(),
            found: vec![0; roots],
        };
        ida.configure(t)?;
        Ok(ida)
    }

    /// Makes all settings that do not change later.
    fn configure(&mut self, t: f64) -> Result<(), IdaFailure> {
        let roots = c_int::try_from(self.found.len()).expect("fewer than 2^31 crossings");
        // SAFETY: all objects are alive
        unsafe {
            let results = [
                s::IDAInit(self.memory, Some(on_residual::<E>), t, self.y, self.yp),
                s::IDAWFtolerances(self.memory, Some(on_weights::<E>)),
                s::IDASetUserData(self.memory, self.context.cast()),
                s::IDASetLinearSolver(self.memory, self.solver, self.matrix),
                s::IDASetJacFn(self.memory, Some(on_jacobian::<E>)),
                if roots > 0 { s::IDARootInit(self.memory, roots, Some(on_crossings::<E>)) } else { 0 },
                // after an event a root function may be exactly zero; the driver handles that itself
                s::IDASetNoInactiveRootWarn(self.memory),
                s::IDASetMaxConvFails(self.memory, MOST_FAILURES),
                s::IDASetMaxErrTestFails(self.memory, MOST_FAILURES),
            ];
            results.into_iter().try_for_each(check)
        }
    }

    /// The equations, to be changed between calls of [`Ida::advance`].
    pub fn equations(&mut self) -> &mut E {
        // SAFETY: the context is ours; no callback runs while `self` is borrowed here
        unsafe { &mut (*self.context).equations }
    }

    /// Whether unknowns that the equations leave open may keep their value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        // SAFETY: the context is ours; no callback runs while `self` is borrowed here
        unsafe { (*self.context).lu.may_keep(allowed) }
    }

    /// The equations, read only.
    pub fn watch(&self) -> &E {
        // SAFETY: the context is ours; it is only changed through `&mut self`
        unsafe { &(*self.context).equations }
    }

    /// The unknowns at the time last returned.
    pub fn y(&self) -> &[f64] {
        // SAFETY: only read while `self` is borrowed
        unsafe { slice(self.y, self.n) }
    }

    /// The derivatives at the time last returned.
    pub fn yp(&self) -> &[f64] {
        // SAFETY: only read while `self` is borrowed
        unsafe { slice(self.yp, self.n) }
    }

    /// Equations, unknowns and derivatives together.
    pub fn parts(&mut self) -> (&mut E, &[f64], &[f64]) {
        // SAFETY: three distinct objects, borrowed as long as `self`
        unsafe { (&mut (*self.context).equations, slice(self.y, self.n), slice(self.yp, self.n)) }
    }

    /// Sets how far the corrector iterates, as a part of the error tolerance. IDA's default is 0.33.
    pub fn set_corrector_tolerance(&mut self, part: f64) {
        // SAFETY: plain setter
        unsafe { s::IDASetNonlinConvCoef(self.memory, part) };
    }

    /// Leaves the marked unknowns out of the error test from now on. The corrector still solves for them.
    ///
    /// An empty slice, or one without `true`, tests all unknowns again.
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS rejects the input.
    pub fn leave_out(&mut self, untested: &[bool]) -> Result<(), IdaFailure> {
        let some = untested.contains(&true);
        // SAFETY: the vectors are ours and not borrowed; IDA copies the marks
        unsafe {
            if some {
                // IDA's id vector: 1 is differential, 0 is algebraic and left out
                let marks = slice(self.scratch, self.n);
                marks.iter_mut().zip(untested).for_each(|(mark, &out)| *mark = if out { 0.0 } else { 1.0 });
                check(s::IDASetId(self.memory, self.scratch))?;
            }
            check(s::IDASetSuppressAlg(self.memory, c_int::from(some)))
        }
    }

    /// Discards the past and starts again at `t` from these values, with order 1.
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS rejects the input.
    pub fn restart(&mut self, t: f64, y: &[f64], yp: &[f64]) -> Result<(), IdaFailure> {
        // IDAReInit sets IDA's counters to zero, so ours are set to zero too
        self.before = self.work();
        // SAFETY: the vectors are ours and not borrowed; IDA copies them
        unsafe {
            slice(self.y, self.n).copy_from_slice(y);
            slice(self.yp, self.n).copy_from_slice(yp);
            let context = &mut *self.context;
            context.residual_calls = 0;
            context.jacobian_calls = 0;
            context.crossing_calls = 0;
            context.lu.factorizations = 0;
            check(s::IDAReInit(self.memory, t, self.y, self.yp))
        }
    }

    /// The correction that a backward Euler step of length `h` adds to its predictor `y + h yp`, to first order.
    ///
    /// It estimates the second derivative: `restart` chooses the first step from it. It costs one residual, and a
    /// factorization where `explicit` is false (rows do not give their own derivative). False when it is not finite.
    pub fn euler_correction(
        &mut self,
        t: f64,
        h: f64,
        y: &[f64],
        yp: &[f64],
        explicit: bool,
        out: &mut Vec<f64>,
    ) -> bool {
        // SAFETY: no callback runs while the context is borrowed here; the matrix is ours
        let (context, val) = unsafe { (&mut *self.context, &mut *(*self.matrix).content.cast::<Vec<f64>>()) };
        let predicted: Vec<f64> = y.iter().zip(yp).map(|(y, yp)| y + h * yp).collect();
        out.clear();
        out.resize(self.n, 0.0);
        context.residual_calls += 1;
        // F = y' - f, so the correction of one Newton step is -h F with the identity as matrix
        if explicit {
            let done = context.equations.rate_residual(t + h, &predicted, yp, out) == EvaluationStatus::Done;
            out.iter_mut().for_each(|r| *r *= -h);
            return done;
        }
        if context.equations.residual(t + h, &predicted, yp, out) == EvaluationStatus::Retry {
            return false;
        }
        // backward Euler: y' = (y - y0) / h, so cj = 1 / h
        context.jacobian_calls += 1;
        if context.equations.jacobian(t + h, 1.0 / h, &predicted, yp, val) == EvaluationStatus::Retry
            || context.lu.factor(val).is_err()
        {
            return false;
        }
        out.iter_mut().for_each(|r| *r = -*r);
        context.lu.solve(out)
    }

    /// The residual of the present equations at the end of the last step, which may lie behind the time last returned.
    ///
    /// After a root it shows whether the changed equations agree with that step. False when it is not finite.
    pub fn residual_ahead(&mut self, out: &mut Vec<f64>) -> bool {
        let t = self.internal_time();
        out.clear();
        out.resize(self.n, 0.0);
        // SAFETY: two vectors of our own that no one else borrows
        unsafe {
            let rate = s::N_VClone(self.scratch);
            // IDAGetDky evaluates the interpolation polynomial (order 0) and its derivative (order 1)
            let known =
                s::IDAGetDky(self.memory, t, 0, self.scratch) >= 0 && s::IDAGetDky(self.memory, t, 1, rate) >= 0;
            let context = &mut *self.context;
            context.residual_calls += 1;
            let (y, yp) = (slice(self.scratch, self.n), slice(rate, self.n));
            let done = known && context.equations.rate_residual(t, y, yp, out) == EvaluationStatus::Done;
            s::N_VDestroy(rate);
            done
        }
    }

    /// Unknowns and derivatives at a time within the last step; false where the time lies outside.
    pub fn at(&mut self, t: f64, y: &mut Vec<f64>, yp: &mut Vec<f64>) -> bool {
        let mut known = true;
        for (order, out) in [(0, y), (1, yp)] {
            out.clear();
            // SAFETY: the scratch vector is ours; IDA writes into it
            unsafe {
                known &= s::IDAGetDky(self.memory, t, order, self.scratch) >= 0;
                out.extend_from_slice(slice(self.scratch, self.n));
            }
        }
        known
    }

    /// Sets the length of the first step after a start or restart, in seconds. 0 lets IDA choose.
    pub fn set_first_step(&mut self, h: f64) {
        // SAFETY: plain setter
        unsafe { s::IDASetInitStep(self.memory, h) };
    }

    /// Sets the longest step in seconds; 0 or infinity for no limit.
    pub fn set_longest_step(&mut self, h: f64) {
        // SAFETY: plain setter
        unsafe { s::IDASetMaxStep(self.memory, if h.is_finite() { h } else { 0.0 }) };
    }

    /// Sets the shortest step in seconds. IDA gives up where it needs a shorter one.
    ///
    /// Without a limit it would approach a singularity with ever shorter steps.
    pub fn set_shortest_step(&mut self, h: f64) {
        // SAFETY: plain setter
        unsafe { s::IDASetMinStep(self.memory, h) };
    }

    /// Sets the time that IDA must not pass, in seconds.
    pub fn set_stop(&mut self, t: f64) {
        // SAFETY: plain setter
        unsafe { s::IDASetStopTime(self.memory, t) };
    }

    /// Makes [`Ida::advance`] return [`AdvanceReturn::Pause`] after this number of steps in one call; 0 never does.
    pub fn pause_after(&mut self, steps: u32) {
        // SAFETY: plain setter; a negative number means no limit
        unsafe { s::IDASetMaxNumSteps(self.memory, if steps == 0 { -1 } else { c_long::from(steps) }) };
    }

    /// Integrates until `to`, the stop time or a root, whichever comes first; returns the time reached in seconds.
    ///
    /// # Errors
    /// [`IdaFailure`] and the time reached. `y` and `yp` hold the last accepted values.
    pub fn advance(&mut self, to: f64) -> Result<(AdvanceReturn, f64), (IdaFailure, f64)> {
        let mut t = 0.0;
        // SAFETY: all objects are alive; callbacks reach the context through its own pointer while no reference to it
        // is held here
        let code = unsafe { s::IDASolve(self.memory, to, &raw mut t, self.y, self.yp, s::IDA_NORMAL) };
        match code {
            // the order matters: all these codes but `IDA_TOO_MUCH_WORK` are positive and would match `0..`
            s::IDA_TSTOP_RETURN => Ok((AdvanceReturn::Stop, t)),
            s::IDA_ROOT_RETURN => Ok((AdvanceReturn::Root, t)),
            s::IDA_TOO_MUCH_WORK => Ok((AdvanceReturn::Pause, t)),
            0.. => Ok((AdvanceReturn::Output, t)),
            _ => Err((self.failure(code), t)),
        }
    }

    /// Translates a return code, using what the callbacks have recorded.
    fn failure(&mut self, code: c_int) -> IdaFailure {
        // SAFETY: no callback runs
        let context = unsafe { &mut *self.context };
        if let Some(text) = context.panic.take() {
            return IdaFailure::Panic(text);
        }
        match code {
            // IDA may report an evaluation that is not finite as a corrector that did not converge: the callbacks'
            // flags decide
            s::IDA_ERR_FAIL => IdaFailure::ErrorTest,
            s::IDA_REP_RES_ERR | s::IDA_FIRST_RES_FAIL => IdaFailure::NonFinite,
            _ if context.non_finite && context.singular.is_none() => IdaFailure::NonFinite,
            s::IDA_CONV_FAIL if context.singular.is_some() => IdaFailure::Singular(context.singular),
            s::IDA_CONV_FAIL => IdaFailure::Convergence,
            s::IDA_LSETUP_FAIL | s::IDA_LSOLVE_FAIL => IdaFailure::Singular(context.singular),
            s::IDA_TOO_MUCH_ACC => IdaFailure::TooMuchAccuracy,
            _ => IdaFailure::Code(code),
        }
    }

    /// The directions of the crossing functions at the root just found: -1 falling, 1 rising, 0 no crossing.
    pub fn found(&mut self) -> &[c_int] {
        if !self.found.is_empty() {
            // SAFETY: the array has as many entries as there are functions
            unsafe { s::IDAGetRootInfo(self.memory, self.found.as_mut_ptr()) };
        }
        &self.found
    }

    /// Writes the estimated local error of the last attempted step, in units of the tolerance, one entry per unknown.
    pub fn weighted_errors(&mut self, out: &mut Vec<f64>) {
        out.clear();
        // SAFETY: the scratch vector is ours; IDA copies into it
        unsafe {
            s::IDAGetEstLocalErrors(self.memory, self.scratch);
            out.extend(slice(self.scratch, self.n).iter());
        }
        let mut weights = Vec::new();
        self.weights(&mut weights);
        for (e, w) in out.iter_mut().zip(weights) {
            *e *= w;
        }
    }

    /// Writes the error weights of the last step: the reciprocal tolerances times their shares.
    pub fn weights(&mut self, out: &mut Vec<f64>) {
        out.clear();
        // SAFETY: as above
        unsafe {
            s::IDAGetErrWeights(self.memory, self.scratch);
            out.extend(slice(self.scratch, self.n).iter());
        }
    }

    /// Lengths of the last step and of the next one, in seconds.
    pub fn step_lengths(&self) -> (f64, f64) {
        let (mut last, mut next) = (0.0, 0.0);
        // SAFETY: plain getters
        unsafe {
            s::IDAGetLastStep(self.memory, &raw mut last);
            s::IDAGetCurrentStep(self.memory, &raw mut next);
        }
        (last, next)
    }

    /// BDF order of the last step.
    pub fn order(&self) -> u32 {
        let mut order = 0;
        // SAFETY: plain getter
        unsafe { s::IDAGetLastOrder(self.memory, &raw mut order) };
        order.unsigned_abs()
    }

    /// The end of the last step in seconds. It is never before the time last returned.
    pub fn internal_time(&self) -> f64 {
        let mut t = 0.0;
        // SAFETY: plain getter
        unsafe { s::IDAGetCurrentTime(self.memory, &raw mut t) };
        t
    }

    /// Work done since the integrator was created.
    pub fn work(&self) -> IntegratorCounters {
        let (mut steps, mut failures, mut convergence) = (0, 0, 0);
        // SAFETY: plain getters; the context is only read
        unsafe {
            s::IDAGetNumSteps(self.memory, &raw mut steps);
            s::IDAGetNumErrTestFails(self.memory, &raw mut failures);
            s::IDAGetNumNonlinSolvConvFails(self.memory, &raw mut convergence);
            let (c, b) = (&*self.context, &self.before);
            IntegratorCounters {
                steps: b.steps + steps.unsigned_abs(),
                residuals: b.residuals + c.residual_calls,
                jacobians: b.jacobians + c.jacobian_calls,
                factorizations: b.factorizations + c.lu.factorizations,
                error_test_failures: b.error_test_failures + failures.unsigned_abs(),
                convergence_failures: b.convergence_failures + convergence.unsigned_abs(),
                crossings: b.crossings + c.crossing_calls,
            }
        }
    }
}

impl<E: DaeEquations> Drop for Ida<E> {
    fn drop(&mut self) {
        // SAFETY: each object is freed once, users before what they use
        unsafe {
            s::IDAFree(&raw mut self.memory);
            s::SUNLinSolFree(self.solver);
            s::SUNMatDestroy(self.matrix);
            for v in [self.y, self.yp, self.scratch].into_iter().chain(self.tangents.drain(..)) {
                s::N_VDestroy(v);
            }
            s::SUNContext_Free(&raw mut self.sundials);
            drop(Box::from_raw(self.context));
        }
    }
}

/// Turns a negative return code into an error; positive codes are warnings.
fn check(code: c_int) -> Result<(), IdaFailure> {
    if code >= 0 { Ok(()) } else { Err(IdaFailure::Code(code)) }
}

#[cfg(test)]
mod tests;
