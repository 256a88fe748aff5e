//! Loads a compiled wrapper of C code, and holds all `unsafe` that calling it needs.
//!
//! Faults of the C code cannot be contained: code that writes to a wrong address can bring the process down.

#![allow(unsafe_code, reason = "calls functions of C by the names that the wrapper gives them")]

use bramah_syntax::world::CompiledC;
use libloading::Library;
use std::ffi::{CStr, c_char, c_int};

/// The functions of a wrapper. They are valid as long as the library is loaded, which this owns.
#[derive(Debug)]
pub struct WrapperLibrary {
    /// `bramah_call`: reads inputs, writes outputs, and gives 0 unless the code reported an error.
    call: unsafe extern "C" fn(*const f64, *mut f64) -> c_int,
    /// `bramah_trouble`: the text of the last error.
    trouble: unsafe extern "C" fn() -> *const c_char,
    // Fields are dropped in order: the library after the pointers into it, its file after the library.
    _library: Library,
    _compiled: CompiledC,
}

impl WrapperLibrary {
    /// Loads the library.
    ///
    /// # Errors
    /// The message of the system, often about a missing symbol.
    pub fn load(compiled: CompiledC) -> Result<Self, String> {
        // SAFETY: the user asked for this code to be run; the types are those that the wrapper is written with
        unsafe {
            let library = Library::new(&compiled.path).map_err(|e| e.to_string())?;
            let call = *library.get(b"bramah_call").map_err(|e| e.to_string())?;
            let trouble = *library.get(b"bramah_trouble").map_err(|e| e.to_string())?;
            Ok(WrapperLibrary { call, trouble, _library: library, _compiled: compiled })
        }
    }

    /// Calls the function. `args` and `found` must be as long as the inputs and outputs that the wrapper was written
    /// for.
    ///
    /// # Errors
    /// The text that the code passed to `ModelicaError`.
    pub fn call(&mut self, args: &[f64], found: &mut [f64]) -> Result<(), String> {
        // SAFETY: the lengths are those that the wrapper was written for; `&mut self` keeps other threads out
        unsafe {
            if (self.call)(args.as_ptr(), found.as_mut_ptr()) == 0 {
                return Ok(());
            }
            Err(CStr::from_ptr((self.trouble)()).to_string_lossy().into_owned())
        }
    }
}
