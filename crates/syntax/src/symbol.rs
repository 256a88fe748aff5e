//! Interned names: one small number per distinct word, for the life of the process.

use std::collections::HashMap;
use std::fmt;
use std::sync::{LazyLock, RwLock};

/// An interned name. Equality is equality of the words; there is no order, so none can leak into results.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Symbol(u32);

#[derive(Default)]
struct SymbolTable {
    index: HashMap<&'static str, u32>,
    names: Vec<&'static str>,
}

static TABLE: LazyLock<RwLock<SymbolTable>> = LazyLock::new(RwLock::default);

impl Symbol {
    /// The symbol of a word.
    pub fn new(name: &str) -> Symbol {
        if let Some(&i) = TABLE.read().expect("no writer panics").index.get(name) {
            return Symbol(i);
        }
        let mut table = TABLE.write().expect("no writer panics");
        if let Some(&i) = table.index.get(name) {
            return Symbol(i);
        }
        let i = u32::try_from(table.names.len()).expect("fewer than 2^32 names");
        let name: &'static str = Box::leak(name.into());
        table.names.push(name);
        table.index.insert(name, i);
        Symbol(i)
    }

    /// The word.
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
