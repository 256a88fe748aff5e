//! Interned names: each distinct word has one small number, for the life of the process.
//! Trees and tables hold [`Symbol`]s in place of strings, so that copying and comparing names costs little.
//! The table is global and only grows; its size is bounded by the distinct words that were read.

use std::collections::HashMap;
use std::fmt;
use std::sync::{LazyLock, RwLock};

/// An interned name. Two symbols are equal if their words are.
/// There is no order, because numbers depend on the order of reading and must not influence results.
/// Copying it is as cheap as copying an integer.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Symbol(u32);

/// The words and their numbers, both ways.
#[derive(Default)]
struct SymbolTable {
    /// The number of each word.
    index: HashMap<&'static str, u32>,
    /// The word of each number.
    names: Vec<&'static str>,
}

/// The one table of the process.
static TABLE: LazyLock<RwLock<SymbolTable>> = LazyLock::new(RwLock::default);

impl Symbol {
    /// The symbol of a word, which is added to the table if it is new.
    pub fn new(name: &str) -> Symbol {
        // Most words are known, and readers do not block each other.
        if let Some(&i) = TABLE.read().expect("no writer panics").index.get(name) {
            return Symbol(i);
        }
        let mut table = TABLE.write().expect("no writer panics");
        // Another thread may have added the word between the two locks.
        if let Some(&i) = table.index.get(name) {
            return Symbol(i);
        }
        let i = u32::try_from(table.names.len()).expect("fewer than 2^32 names");
        // Leaked on purpose: words live as long as the process, so that symbols can hand out `&'static str`.
        let name: &'static str = Box::leak(name.into());
        table.names.push(name);
        table.index.insert(name, i);
        Symbol(i)
    }

    /// The word of the symbol.
    /// It takes a lock for reading.
    #[inline]
    pub fn as_str(self) -> &'static str {
        TABLE.read().expect("no writer panics").names[self.0 as usize]
    }
}

impl From<&str> for Symbol {
    fn from(name: &str) -> Symbol {
        Symbol::new(name)
    }
}

impl PartialEq<&str> for Symbol {
    fn eq(&self, other: &&str) -> bool {
        self.as_str() == *other
    }
}

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.as_str())
    }
}
