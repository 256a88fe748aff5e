//! Forward sensitivities by IDAS, with the staggered corrector.
//!
//! After the corrector of the states has converged, IDAS solves one or two linear systems for each direction with the
//! factorized matrix of that step. Source: W. F. Feehery, J. E. Tolsma, P. I. Barton, Applied Numerical Mathematics 25
//! (1997) 41. `driver/tangents` sets the sensitivities at the start and after events.

#![allow(unsafe_code, reason = "calls into SUNDIALS; each block states why it is sound")]

use super::context::{new_vector, on_tangents, slice};
use super::{DifferentiableEquations, Ida, IdaFailure, check};
use std::os::raw::c_int;
use sundials_sys as s;

impl<E: DifferentiableEquations> Ida<E> {
    /// Starts sensitivities at the present time: for each direction values and time derivatives, consistent with F.
    ///
    /// With `controlled`, their errors take part in the error test.
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS rejects the input.
    pub fn begin_tangents(
        &mut self,
        values: &[Vec<f64>],
        rates: &[Vec<f64>],
        controlled: bool,
    ) -> Result<(), IdaFailure> {
        let count = c_int::try_from(values.len()).expect("fewer than 2^31 directions");
        self.tangents.extend(values.iter().chain(rates).map(|v| new_vector(v, self.sundials)));
        // IDAS wants two arrays of vectors: values and time derivatives
        let (first, second) = self.tangents.split_at_mut(values.len());
        // SAFETY: two arrays of `count` vectors that live as long as `self`; IDAS copies them
        unsafe {
            let (first, second) = (first.as_mut_ptr(), second.as_mut_ptr());
            check(s::IDASensInit(self.memory, count, s::IDA_STAGGERED, Some(on_tangents::<E>), first, second))?;
            check(s::IDASensEEtolerances(self.memory))?;
            check(s::IDASetSensErrCon(self.memory, c_int::from(controlled)))
        }
    }

    /// Sets the sensitivities again after [`Ida::restart`].
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS rejects the input.
    pub fn restart_tangents(&mut self, values: &[Vec<f64>], rates: &[Vec<f64>]) -> Result<(), IdaFailure> {
        for (vector, given) in self.tangents.iter().zip(values.iter().chain(rates)) {
            // SAFETY: the vectors are ours and not borrowed
            unsafe { slice(*vector, self.n).copy_from_slice(given) };
        }
        let (first, second) = self.tangents.split_at_mut(values.len());
        // SAFETY: as above
        unsafe { check(s::IDASensReInit(self.memory, s::IDA_STAGGERED, first.as_mut_ptr(), second.as_mut_ptr())) }
    }

    /// Writes the sensitivities (`order` 0) or their time derivatives (`order` 1) at a time within the last step.
    ///
    /// `out` has one vector per direction. False when IDAS has none or when the time lies outside.
    pub fn tangents_at(&mut self, t: f64, order: u8, out: &mut [Vec<f64>]) -> bool {
        for (k, out) in (0..).zip(out) {
            // SAFETY: the scratch vector is ours; IDAS writes into it
            unsafe {
                if s::IDAGetSensDky1(self.memory, t, c_int::from(order), k, self.scratch) < 0 {
                    return false;
                }
                out.copy_from_slice(slice(self.scratch, self.n));
            }
        }
        true
    }
}
