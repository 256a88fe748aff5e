//! Calls of functions.
//!
//! - `call` is the entry: it finds the function and decides how to call it; `binding` and `locals` prepare the call.
//! - `builtin` has the built-in functions, `vectorised` applies functions element by element.
//! - `procedure` translates functions that cannot be evaluated to expressions; `functional` passes functions as
//!   arguments.
//! - `external`, `files` and `c` call external functions.

pub(in crate::instance) mod binding;
pub(in crate::instance) mod builtin;
#[cfg(feature = "fmi")]
mod c;
pub(in crate::instance) mod call;
pub(in crate::instance) mod external;
pub(in crate::instance) mod files;
pub(in crate::instance) mod functional;
pub(in crate::instance) mod locals;
pub(in crate::instance) mod procedure;
pub(in crate::instance) mod vectorised;
