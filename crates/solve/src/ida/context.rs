//! The C side: what SUNDIALS calls, and the shells of matrix and linear solver that point to our own. A panic inside a
//! callback never unwinds through C: it is caught, IDA is told to stop, and the text is kept.

#![allow(unsafe_code, reason = "functions called by SUNDIALS; each block states why it is sound")]

use super::{DaeEquations, DifferentiableEquations, EvaluationStatus, IntegratorTolerances, operations};
use crate::linear::{Lu, SingularMatrix};
use crate::vectors::LONG;
use std::os::raw::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use sundials_sys as s;

/// What the C side points to.
pub(super) struct IdaContext<E> {
    pub equations: E,
    pub n: usize,
    pub roots: usize,
    pub tolerances: IntegratorTolerances,
    pub lu: Lu,
    pub singular: Option<SingularMatrix>,
    pub residual_calls: u64,
    pub jacobian_calls: u64,
    pub crossing_calls: u64,
    pub non_finite: bool,
    pub panic: Option<String>,
}

/// The values of a vector.
///
/// # Safety
/// `v` is a serial vector of `n` entries that outlives the slice, and no other slice of it is in use.
pub(super) unsafe fn slice<'a>(v: s::N_Vector, n: usize) -> &'a mut [f64] {
    // SAFETY: promised by the caller; serial vectors are contiguous
    unsafe { std::slice::from_raw_parts_mut(s::N_VGetArrayPointer(v), n) }
}

/// Runs a callback; a panic becomes the code -1 (IDA stops) and its text is kept.
fn guarded<E>(context: &mut IdaContext<E>, run: impl FnOnce(&mut IdaContext<E>) -> c_int) -> c_int {
    match catch_unwind(AssertUnwindSafe(|| run(context))) {
        Ok(code) => code,
        Err(payload) => {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(ToString::to_string));
            context.panic = Some(text.unwrap_or_else(|| "no message".to_string()));
            -1
        }
    }
}

fn code_of<E>(context: &mut IdaContext<E>, evaluation: EvaluationStatus) -> c_int {
    context.non_finite = evaluation == EvaluationStatus::Retry;
    c_int::from(context.non_finite)
}

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

unsafe extern "C" fn matrix_id(_: s::SUNMatrix) -> s::SUNMatrix_ID {
    s::SUNMatrix_ID_SUNMATRIX_CUSTOM
}

/// IDA clears the matrix before each Jacobian; ours writes every entry, so nothing needs to be done.
unsafe extern "C" fn matrix_zero(_: s::SUNMatrix) -> s::SUNErrCode {
    0
}

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

unsafe extern "C" fn solver_type(_: s::SUNLinearSolver) -> s::SUNLinearSolver_Type {
    s::SUNLinearSolver_Type_SUNLINEARSOLVER_DIRECT
}

unsafe extern "C" fn solver_id(_: s::SUNLinearSolver) -> s::SUNLinearSolver_ID {
    s::SUNLinearSolver_ID_SUNLINEARSOLVER_CUSTOM
}

unsafe extern "C" fn solver_initialize(_: s::SUNLinearSolver) -> s::SUNErrCode {
    0
}

unsafe extern "C" fn solver_setup<E: DaeEquations>(ls: s::SUNLinearSolver, a: s::SUNMatrix) -> c_int {
    // SAFETY: the content is the context (owned by Ida); the matrix is ours
    let (context, val) = unsafe { (&mut *(*ls).content.cast::<IdaContext<E>>(), &*(*a).content.cast::<Vec<f64>>()) };
    guarded(context, |c| {
        c.singular = c.lu.factor(val).err();
        // positive: recoverable, IDA tries a smaller step
        c_int::from(c.singular.is_some())
    })
}

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
