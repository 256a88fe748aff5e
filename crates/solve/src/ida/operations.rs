//! What SUNDIALS does with long vectors, handed to [`crate::vectors`]: its own loops are built for any processor,
//! and combine vectors one by one.

#![allow(unsafe_code, reason = "functions called by SUNDIALS; each block states why it is sound")]

use crate::vectors;
use std::os::raw::c_int;
use sundials_sys as s;

/// Most vectors in a combination: the integrator's past of order 5, and what it adds.
const MOST: usize = 16;

/// Gives a serial vector, and all that are cloned from it, our operations.
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

/// Where the values of a vector begin, and how many there are.
///
/// # Safety
/// `v` is a serial vector.
unsafe fn place(v: s::N_Vector) -> (*mut f64, usize) {
    // SAFETY: promised by the caller; the length is not negative
    unsafe { (s::N_VGetArrayPointer(v), s::N_VGetLength(v) as usize) }
}

/// # Safety
/// Called by SUNDIALS with serial vectors of one length, each the same as another or apart from it.
unsafe extern "C" fn linear_sum(a: f64, x: s::N_Vector, b: f64, y: s::N_Vector, z: s::N_Vector) {
    // SAFETY: promised; the vector written is never borrowed a second time
    unsafe {
        let ((x, n), (y, _), (z, _)) = (place(x), place(y), place(z));
        let read = |from: *mut f64| std::slice::from_raw_parts(from, n);
        let out = std::slice::from_raw_parts_mut(z, n);
        match (x == z, y == z) {
            (false, false) => vectors::sum(a, read(x), b, read(y), out),
            (false, true) => vectors::add(a, read(x), b, out),
            (true, false) => vectors::add(b, read(y), a, out),
            (true, true) => vectors::scale_in_place(a + b, out),
        }
    }
}

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

/// # Safety
/// As [`linear_sum`]; there are `count` factors and vectors, and only the first of these may be `z`.
unsafe extern "C" fn linear_combination(count: c_int, c: *mut f64, x: *mut s::N_Vector, z: s::N_Vector) -> c_int {
    let count = count as usize;
    if count == 0 || count > MOST {
        return s::SUN_ERR_ARG_OUTOFRANGE;
    }
    // SAFETY: as above
    unsafe {
        let (out, n) = place(z);
        let factors = std::slice::from_raw_parts(c, count);
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

/// # Safety
/// As [`linear_sum`].
unsafe extern "C" fn weighted_norm(x: s::N_Vector, w: s::N_Vector) -> f64 {
    // SAFETY: as above; both are only read
    unsafe {
        let ((x, n), (w, _)) = (place(x), place(w));
        vectors::weighted_norm(std::slice::from_raw_parts(x, n), std::slice::from_raw_parts(w, n))
    }
}
