//! Text to syntax tree. Never fails: errors come beside the tree, several per file.

pub mod ast;
pub mod symbol;
