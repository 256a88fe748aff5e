//! Calls: built-in functions, user functions written out or translated into procedures, what Rust knows of C functions.

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
