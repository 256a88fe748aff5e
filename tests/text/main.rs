//! Tests of what is written: the language, its messages, the library as text, documents and architecture.

mod architecture;
mod bad;
mod data;
#[path = "../diagnose/mod.rs"]
mod diagnose;
#[path = "../disk/mod.rs"]
mod disk;
mod errors;
mod external_c;
mod language;
mod library;
mod meaning;
mod msl;
mod readme;
mod tables;
