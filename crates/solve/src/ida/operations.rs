//! Vector operations for SUNDIALS, carried out by [`crate::vectors`].
//!
//! SUNDIALS' own loops are compiled for the baseline processor and combine vectors one pair at a time. `install` puts
//! these functions into the operation table of long vectors. The semantics are those of N_VLinearSum, N_VScale,
//! N_VLinearCombination and N_VWrmsNorm of the SUNDIALS manual.

#![allow(unsafe_code, reason = "functions called by SUNDIALS; each block states why it is sound")]

use crate::vectors;
use std::os::raw::c_int;
use sundials_sys as s;

/// Most vectors in one combination. IDA combines its past of order 5 and a few more.
const MOST: usize = 16;

/// Gives a serial vector, and all vectors cloned from it, our operations.
///
/// # Safety
/// `v` is a serial vector that nothing else uses now.
pub(super) unsafe fn install(v: s::N_Vector) {
    // SAFETY: every vector has a table of operations of its own, which clones copy
    let table = unsafe { &mut *(*v).ops };
    table.nvlinearsum = Some(linear_sum);
    table.nvscale = Some(scale);
    table.nvlinearcombination = Some(linear_combination);
    table.nvwrmsnorm = Some(weighted_norm);
}

/// Pointer to the values of a vector, and their number.
///
/// # Safety
/// `v` is a serial vector.
unsafe fn place(v: s::N_Vector) -> (*mut f64, usize) {
    // SAFETY: promised by the caller; the length is not negative
    unsafe { (s::N_VGetArrayPointer(v), s::N_VGetLength(v) as usize) }
}

/// `z = a x + b y`.
///
/// # Safety
/// Called by SUNDIALS with serial vectors of one length. Two of them are either the same vector or do not overlap.
unsafe extern "C" fn linear_sum(a: f64, x: s::N_Vector, b: f64, y: s::N_Vector, z: s::N_Vector) {
    // SAFETY: promised; the vector written is never borrowed a second time
    unsafe {
        let ((x, n), (y, _), (z, _)) = (place(x), place(y), place(z));
        let read = |from: *mut f64| std::slice::from_raw_parts(from, n);
        let out = std::slice::from_raw_parts_mut(z, n);
        // an operand that is also the result must not be borrowed twice
        match (x == z, y == z) {
            (false, false) => vectors::sum(a, read(x), b, read(y), out),
            (false, true) => vectors::add(a, read(x), b, out),
            (true, false) => vectors::add(b, read(y), a, out),
            (true, true) => vectors::scale_in_place(a + b, out),
        }
    }
}

/// `z = a x`.
///
/// # Safety
/// As [`linear_sum`].
unsafe extern "C" fn scale(a: f64, x: s::N_Vector, z: s::N_Vector) {
    // SAFETY: as above
    unsafe {
        let ((x, n), (z, _)) = (place(x), place(z));
        let out = std::slice::from_raw_parts_mut(z, n);
        if x == z {
            vectors::scale_in_place(a, out);
        } else {
            vectors::scale(a, std::slice::from_raw_parts(x, n), out);
        }
    }
}

/// `z = c[0] x[0] + c[1] x[1] + ...`; an error code when there are none or too many.
///
/// # Safety
/// As [`linear_sum`]; there are `count` factors and vectors. Only the first vector may be `z`.
unsafe extern "C" fn linear_combination(count: c_int, c: *mut f64, x: *mut s::N_Vector, z: s::N_Vector) -> c_int {
    let count = count as usize;
    if count == 0 || count > MOST {
        return s::SUN_ERR_ARG_OUTOFRANGE;
    }
    // SAFETY: as above
    unsafe {
        let (out, n) = place(z);
        let factors = std::slice::from_raw_parts(c, count);
        // an array on the stack: this runs at every step
        let mut all: [&[f64]; MOST] = [&[]; MOST];
        let onto = place(*x).0 == out;
        for k in usize::from(onto)..count {
            all[k] = std::slice::from_raw_parts(place(*x.add(k)).0, n);
        }
        let out = std::slice::from_raw_parts_mut(out, n);
        if onto {
            vectors::combine_onto(factors[0], &factors[1..], &all[1..count], out);
        } else {
            vectors::combine(factors, &all[..count], out);
        }
    }
    s::SUN_SUCCESS as c_int
}

/// The root mean square of `x[i] w[i]`.
///
/// # Safety
/// As [`linear_sum`].
unsafe extern "C" fn weighted_norm(x: s::N_Vector, w: s::N_Vector) -> f64 {
    // SAFETY: as above; both are only read
    unsafe {
        let ((x, n), (w, _)) = (place(x), place(w));
        vectors::weighted_norm(std::slice::from_raw_parts(x, n), std::slice::from_raw_parts(w, n))
    }
}
