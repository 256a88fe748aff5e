//! Loading a compiled wrapper, and all `unsafe` that calling it needs.
//!
//! What a user's C code does cannot be guarded: one that writes where it should not can bring the whole process down.

#![allow(unsafe_code, reason = "calls functions of C by the names that the wrapper gives them")]

use bramah_syntax::world::CompiledC;
use libloading::Library;
use std::ffi::{CStr, c_char, c_int};

/// The functions of a wrapper, as long as its library is loaded.
#[derive(Debug)]
pub struct WrapperLibrary {
    call: unsafe extern "C" fn(*const f64, *mut f64) -> c_int,
    trouble: unsafe extern "C" fn() -> *const c_char,
    // dropped after the pointers into it
    _library: Library,
    _compiled: CompiledC,
}

impl WrapperLibrary {
    /// Loads the library.
    ///
    /// # Errors
    /// Why it cannot be loaded, as the system says it: often a symbol that is missing.
    pub fn load(compiled: CompiledC) -> Result<Self, String> {
        // SAFETY: the user asked for this code to be run; the types are those that the wrapper is written with
        unsafe {
            let library = Library::new(&compiled.path).map_err(|e| e.to_string())?;
            let call = *library.get(b"bramah_call").map_err(|e| e.to_string())?;
            let trouble = *library.get(b"bramah_trouble").map_err(|e| e.to_string())?;
            Ok(WrapperLibrary { call, trouble, _library: library, _compiled: compiled })
        }
    }

    /// Calls the function; `found` must be as long as the wrapper's outputs.
    ///
    /// # Errors
    /// What the code gave to `ModelicaError`.
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
