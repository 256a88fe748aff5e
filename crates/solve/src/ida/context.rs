//! The functions that SUNDIALS calls, and the shells of matrix and linear solver around our own.
//!
//! Each callback reads its `IdaContext` from the user-data pointer. A panic inside a callback must not unwind through
//! C: it is caught, IDA receives -1 and stops, and the message is kept. Return codes: 0 is success, positive is
//! recoverable (IDA tries a smaller step), negative is fatal. Source: IDAS user guide, user-supplied functions.

#![allow(unsafe_code, reason = "functions called by SUNDIALS; each block states why it is sound")]

use super::{DaeEquations, DifferentiableEquations, EvaluationStatus, IntegratorTolerances, operations};
use crate::linear::{Lu, SingularMatrix};
use crate::vectors::LONG;
use std::os::raw::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use sundials_sys as s;

/// What the callbacks need. It is owned by `Ida` and referenced by the C objects.
pub(super) struct IdaContext<E> {
    /// The equations to evaluate.
    pub equations: E,
    /// Number of unknowns.
    pub n: usize,
    /// Number of crossing functions.
    pub roots: usize,
    /// Tolerances, from which the error weights are computed.
    pub tolerances: IntegratorTolerances,
    /// Factors of the iteration matrix.
    pub lu: Lu,
    /// The column without pivot in the last factorization; `None` when that succeeded.
    pub singular: Option<SingularMatrix>,
    /// Evaluations of the residual since the last restart.
    pub residual_calls: u64,
    /// Evaluations of the Jacobian since the last restart.
    pub jacobian_calls: u64,
    /// Evaluations of the crossing functions since the last restart.
    pub crossing_calls: u64,
    /// Whether the last evaluation gave a value that is not finite.
    pub non_finite: bool,
    /// The message of a panic in a callback, until `Ida` takes it.
    pub panic: Option<String>,
}

/// The values of a vector as a slice.
///
/// # Safety
/// `v` is a serial vector of `n` entries that outlives the slice. No other slice of it is in use.
pub(super) unsafe fn slice<'a>(v: s::N_Vector, n: usize) -> &'a mut [f64] {
    // SAFETY: promised by the caller; serial vectors are contiguous
    unsafe { std::slice::from_raw_parts_mut(s::N_VGetArrayPointer(v), n) }
}

/// Runs a callback; a panic becomes the code -1, which makes IDA stop, and its message is kept.
fn guarded<E>(context: &mut IdaContext<E>, run: impl FnOnce(&mut IdaContext<E>) -> c_int) -> c_int {
    match catch_unwind(AssertUnwindSafe(|| run(context))) {
        // `AssertUnwindSafe`: after a panic IDA stops, and nothing but the message is read
        Ok(code) => code,
        Err(payload) => {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(ToString::to_string));
            context.panic = Some(text.unwrap_or_else(|| "no message".to_string()));
            -1
        }
    }
}

/// Records whether the values are finite and returns IDA's code: 0, or 1 for a smaller step.
fn code_of<E>(context: &mut IdaContext<E>, evaluation: EvaluationStatus) -> c_int {
    context.non_finite = evaluation == EvaluationStatus::Retry;
    c_int::from(context.non_finite)
}

/// The residual `F(t, y, y')` (IDAResFn).
///
/// # Safety
/// Called by IDA with the context as `user` and with distinct serial vectors of n entries.
pub(super) unsafe extern "C" fn on_residual<E: DaeEquations>(
    t: f64,
    y: s::N_Vector,
    yp: s::N_Vector,
    r: s::N_Vector,
    user: *mut c_void,
) -> c_int {
    // SAFETY: `user` is the context given to IDASetUserData; IDA passes distinct serial vectors of n entries
    let (context, y, yp, r) = unsafe {
        let context = &mut *user.cast::<IdaContext<E>>();
        let n = context.n;
        (context, slice(y, n), slice(yp, n), slice(r, n))
    };
    guarded(context, |c| {
        c.residual_calls += 1;
        let evaluation = c.equations.residual(t, y, yp, r);
        code_of(c, evaluation)
    })
}

/// The Jacobian `dF/dy + cj dF/dy'` into the values of our matrix (IDALsJacFn).
///
/// # Safety
/// As `on_residual`; the matrix was made by `new_matrix`.
#[allow(clippy::too_many_arguments, reason = "the signature of IDALsJacFn")]
pub(super) unsafe extern "C" fn on_jacobian<E: DaeEquations>(
    t: f64,
    cj: f64,
    y: s::N_Vector,
    yp: s::N_Vector,
    _r: s::N_Vector,
    matrix: s::SUNMatrix,
    user: *mut c_void,
    _tmp1: s::N_Vector,
    _tmp2: s::N_Vector,
    _tmp3: s::N_Vector,
) -> c_int {
    // SAFETY: as above; the matrix is the one made by `new_matrix`
    let (context, y, yp, val) = unsafe {
        let context = &mut *user.cast::<IdaContext<E>>();
        let n = context.n;
        (context, slice(y, n), slice(yp, n), &mut *(*matrix).content.cast::<Vec<f64>>())
    };
    guarded(context, |c| {
        c.jacobian_calls += 1;
        let evaluation = c.equations.jacobian(t, cj, y, yp, val);
        code_of(c, evaluation)
    })
}

/// The residuals of the sensitivity equations, for `count` directions (IDASensResFn).
///
/// # Safety
/// As `on_residual`; the arrays hold `count` distinct serial vectors each.
#[allow(clippy::too_many_arguments, reason = "the signature of IDASensResFn")]
pub(super) unsafe extern "C" fn on_tangents<E: DifferentiableEquations>(
    count: c_int,
    t: f64,
    y: s::N_Vector,
    yp: s::N_Vector,
    _r: s::N_Vector,
    tangents: *mut s::N_Vector,
    rates: *mut s::N_Vector,
    out: *mut s::N_Vector,
    user: *mut c_void,
    _tmp1: s::N_Vector,
    _tmp2: s::N_Vector,
    _tmp3: s::N_Vector,
) -> c_int {
    // SAFETY: as above
    let (context, y, yp) = unsafe {
        let context = &mut *user.cast::<IdaContext<E>>();
        let n = context.n;
        (context, slice(y, n), slice(yp, n))
    };
    let each = 0..usize::try_from(count).unwrap_or(0);
    guarded(context, |c| {
        // the matrices are the same for all directions and are computed once
        let evaluation = c.equations.differentiate(t, y, yp);
        for k in each.take_while(|_| evaluation == EvaluationStatus::Done) {
            // SAFETY: three arrays of `count` distinct serial vectors of n entries
            let (s, sp, r) =
                unsafe { (slice(*tangents.add(k), c.n), slice(*rates.add(k), c.n), slice(*out.add(k), c.n)) };
            c.equations.along(s, sp, r);
        }
        code_of(c, evaluation)
    })
}

/// The crossing functions (IDARootFn).
///
/// # Safety
/// As `on_residual`; `g` has as many entries as were given to `IDARootInit`.
pub(super) unsafe extern "C" fn on_crossings<E: DaeEquations>(
    t: f64,
    y: s::N_Vector,
    yp: s::N_Vector,
    g: *mut f64,
    user: *mut c_void,
) -> c_int {
    // SAFETY: as above; `g` has as many entries as were announced to IDARootInit
    let (context, y, yp, g) = unsafe {
        let context = &mut *user.cast::<IdaContext<E>>();
        let (n, roots) = (context.n, context.roots);
        (context, slice(y, n), slice(yp, n), std::slice::from_raw_parts_mut(g, roots))
    };
    guarded(context, |c| {
        c.crossing_calls += 1;
        c.equations.crossings(t, y, yp, g);
        0
    })
}

/// The error weights `share / (relative * |y| + absolute)` (IDAEwtFn).
///
/// # Safety
/// As `on_residual`.
pub(super) unsafe extern "C" fn on_weights<E: DaeEquations>(
    y: s::N_Vector,
    w: s::N_Vector,
    user: *mut c_void,
) -> c_int {
    // SAFETY: as above
    let (context, y, w) = unsafe {
        let context = &*user.cast::<IdaContext<E>>();
        (context, slice(y, context.n), slice(w, context.n))
    };
    let IntegratorTolerances { relative, absolute, share } = &context.tolerances;
    for (((w, y), absolute), share) in w.iter_mut().zip(y).zip(absolute).zip(share) {
        *w = share / (relative * y.abs() + absolute);
    }
    0
}

/// Tells SUNDIALS that the matrix type is not one of its own.
unsafe extern "C" fn matrix_id(_: s::SUNMatrix) -> s::SUNMatrix_ID {
    s::SUNMatrix_ID_SUNMATRIX_CUSTOM
}

/// Does nothing: IDA clears the matrix before each Jacobian, and ours writes every entry.
unsafe extern "C" fn matrix_zero(_: s::SUNMatrix) -> s::SUNErrCode {
    0
}

/// Frees the values and the shell of the matrix.
unsafe extern "C" fn matrix_destroy(a: s::SUNMatrix) {
    if !a.is_null() {
        // SAFETY: the content was made by Box::into_raw in `new_matrix` and is dropped once
        unsafe {
            drop(Box::from_raw((*a).content.cast::<Vec<f64>>()));
            (*a).content = null_mut();
            s::SUNMatFreeEmpty(a);
        }
    }
}

/// A direct solver. IDA then scales the correction by 2 / (1 + cj ratio) when cj has changed since the last setup.
unsafe extern "C" fn solver_type(_: s::SUNLinearSolver) -> s::SUNLinearSolver_Type {
    s::SUNLinearSolver_Type_SUNLINEARSOLVER_DIRECT
}

/// Tells SUNDIALS that the solver is not one of its own.
unsafe extern "C" fn solver_id(_: s::SUNLinearSolver) -> s::SUNLinearSolver_ID {
    s::SUNLinearSolver_ID_SUNLINEARSOLVER_CUSTOM
}

/// Does nothing: the context is complete when the solver is created.
unsafe extern "C" fn solver_initialize(_: s::SUNLinearSolver) -> s::SUNErrCode {
    0
}

/// Factorizes the iteration matrix; returns 1 when it is singular.
unsafe extern "C" fn solver_setup<E: DaeEquations>(ls: s::SUNLinearSolver, a: s::SUNMatrix) -> c_int {
    // SAFETY: the content is the context (owned by Ida); the matrix is ours
    let (context, val) = unsafe { (&mut *(*ls).content.cast::<IdaContext<E>>(), &*(*a).content.cast::<Vec<f64>>()) };
    guarded(context, |c| {
        c.singular = c.lu.factor(val).err();
        // positive: recoverable, IDA tries a smaller step
        c_int::from(c.singular.is_some())
    })
}

/// Solves with the factors: copies `b` to `x` and replaces `x` by the solution; returns 1 when it is not finite.
unsafe extern "C" fn solver_solve<E: DaeEquations>(
    ls: s::SUNLinearSolver,
    _: s::SUNMatrix,
    x: s::N_Vector,
    b: s::N_Vector,
    _tolerance: f64,
) -> c_int {
    // SAFETY: as above; x and b are serial vectors of n entries, b is only read, before x is borrowed
    let (context, x) = unsafe {
        let context = &mut *(*ls).content.cast::<IdaContext<E>>();
        let (xp, bp) = (s::N_VGetArrayPointer(x), s::N_VGetArrayPointer(b));
        if xp != bp {
            std::ptr::copy_nonoverlapping(bp, xp, context.n);
        }
        let n = context.n;
        (context, slice(x, n))
    };
    guarded(context, |c| c_int::from(!c.lu.solve(x)))
}

/// Frees the shell of the solver. The context belongs to `Ida`.
unsafe extern "C" fn solver_free(ls: s::SUNLinearSolver) -> s::SUNErrCode {
    if !ls.is_null() {
        // SAFETY: the content belongs to Ida, only the shell is freed
        unsafe {
            (*ls).content = null_mut();
            s::SUNLinSolFreeEmpty(ls);
        }
    }
    0
}

/// A matrix shell with `nnz` values.
pub(super) fn new_matrix(nnz: usize, context: s::SUNContext) -> s::SUNMatrix {
    // SAFETY: a fresh shell, filled before use
    unsafe {
        let a = s::SUNMatNewEmpty(context);
        assert!(!a.is_null(), "SUNDIALS has no memory");
        (*a).content = Box::into_raw(Box::new(vec![0.0_f64; nnz])).cast();
        let ops = &mut *(*a).ops;
        ops.getid = Some(matrix_id);
        ops.zero = Some(matrix_zero);
        ops.destroy = Some(matrix_destroy);
        a
    }
}

/// A solver shell that points to the context.
pub(super) fn new_solver<E: DaeEquations>(content: *mut IdaContext<E>, context: s::SUNContext) -> s::SUNLinearSolver {
    // SAFETY: a fresh shell, filled before use
    unsafe {
        let ls = s::SUNLinSolNewEmpty(context);
        assert!(!ls.is_null(), "SUNDIALS has no memory");
        (*ls).content = content.cast();
        let ops = &mut *(*ls).ops;
        ops.gettype = Some(solver_type);
        ops.getid = Some(solver_id);
        ops.initialize = Some(solver_initialize);
        ops.setup = Some(solver_setup::<E>);
        ops.solve = Some(solver_solve::<E>);
        ops.free = Some(solver_free);
        ls
    }
}

/// A serial vector with these values. Long vectors get our own operations.
pub(super) fn new_vector(values: &[f64], context: s::SUNContext) -> s::N_Vector {
    // SAFETY: a fresh vector of as many entries as are copied
    unsafe {
        let v = s::N_VNew_Serial(i64::try_from(values.len()).expect("fewer than 2^63 unknowns"), context);
        assert!(!v.is_null(), "SUNDIALS has no memory");
        slice(v, values.len()).copy_from_slice(values);
        if values.len() >= LONG {
            operations::install(v);
        }
        v
    }
}
