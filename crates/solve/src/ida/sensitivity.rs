//! Forward sensitivities by IDAS: after each step of the states one linear solve or two for each direction, with the
//! same factorised matrix, under the same control of the step. Source: W. F. Feehery, J. E. Tolsma, P. I. Barton,
//! Applied Numerical Mathematics 25 (1997) 41.

#![allow(unsafe_code, reason = "calls into SUNDIALS; each block states why it is sound")]

use super::context::{new_vector, on_tangents, slice};
use super::{DifferentiableEquations, Ida, IdaFailure, check};
use std::os::raw::c_int;
use sundials_sys as s;

impl<E: DifferentiableEquations> Ida<E> {
    /// Carries sensitivities along from where the integrator starts: per direction values and rates, consistent with the
    /// equations. Their errors count in the choice of steps where they are `controlled`.
    ///
    /// # Errors
    /// [`IdaFailure::Code`] when SUNDIALS refuses the input.
    pub fn begin_tangents(
        &mut self,
        values: &[Vec<f64>],
        rates: &[Vec<f64>],
        controlled: bool,
    ) -> Result<(), IdaFailure> {
        let count = c_int::try_from(values.len()).expect("fewer than 2^31 directions");
        self.tangents.extend(values.iter().chain(rates).map(|v| new_vector(v, self.sundials)));
        let (first, second) = self.tangents.split_at_mut(values.len());
        // SAFETY: two arrays of `count` vectors that live as long as `self`; IDAS copies them
        unsafe {
            let (first, second) = (first.as_mut_ptr(), second.as_mut_ptr());
            check(s::IDASensInit(self.memory, count, s::IDA_STAGGERED, Some(on_tangents::<E>), first, second))?;
            check(s::IDASensEEtolerances(self.memory))?;
            check(s::IDASetSensErrCon(self.memory, c_int::from(controlled)))
        }
    }

    /// The same again after [`Ida::restart`].
    ///
    /// # Errors
    /// As before.
    pub fn restart_tangents(&mut self, values: &[Vec<f64>], rates: &[Vec<f64>]) -> Result<(), IdaFailure> {
        for (vector, given) in self.tangents.iter().zip(values.iter().chain(rates)) {
            // SAFETY: the vectors are ours and not borrowed
            unsafe { slice(*vector, self.n).copy_from_slice(given) };
        }
        let (first, second) = self.tangents.split_at_mut(values.len());
        // SAFETY: as above
        unsafe { check(s::IDASensReInit(self.memory, s::IDA_STAGGERED, first.as_mut_ptr(), second.as_mut_ptr())) }
    }

    /// The sensitivities (`order` 0) or their rates (1) at a time within the last step, into `out`, one entry a
    /// direction; false where there are none.
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
