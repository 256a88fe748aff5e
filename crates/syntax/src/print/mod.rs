//! The printer: a syntax tree in, Modelica text out, which reads back as the same tree.
//! Nodes have it as their `Display`. `format`, in contrast, lays out a text without changing its tokens.
//!
//! Comments, annotations other than those of classes and components, and the order of the sections of a class are not
//! in the tree and so not in the text. Numbers that are not finite have no Modelica text.

mod class;
mod equation;
mod expr;

use super::ast::{
    Class, ComponentDeclaration, ComponentReference, Equation, Expr, Modification, ModificationArgument, Path,
    Statement, StoredDefinition,
};
use std::fmt;

/// The text written so far, and the indentation of the next line.
#[derive(Default)]
struct SyntaxPrinter {
    /// The text.
    out: String,
    /// Depth of indentation, two blanks each.
    depth: usize,
}

impl SyntaxPrinter {
    /// Appends a text as it is.
    fn word(&mut self, text: &str) {
        self.out.push_str(text);
    }

    /// A word and a blank, if `is_there`.
    fn prefix(&mut self, is_there: bool, text: &str) {
        if is_there {
            self.word(text);
            self.word(" ");
        }
    }

    /// Begins a line: writes its indentation.
    fn begin(&mut self) {
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
    }

    /// Appends a text and ends the line.
    fn end(&mut self, text: &str) {
        self.word(text);
        self.word("\n");
    }

    /// A line of its own at the present depth.
    fn line(&mut self, text: &str) {
        self.begin();
        self.end(text);
    }

    /// Writes items by `item`, with a separator between them.
    fn separated<T>(&mut self, items: &[T], separator: &str, mut item: impl FnMut(&mut Self, &T)) {
        for (i, x) in items.iter().enumerate() {
            if i > 0 {
                self.word(separator);
            }
            item(self, x);
        }
    }
}

/// Implements `Display` by a method of the printer.
macro_rules! display {
    ($($node:ty, $method:ident;)*) => {
        $(impl fmt::Display for $node {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let mut printer = SyntaxPrinter::default();
                printer.$method(self);
                f.write_str(&printer.out)
            }
        })*
    };
}

display! {
    StoredDefinition, file;
    Class, class;
    ComponentDeclaration, component;
    Modification, modification;
    ModificationArgument, argument;
    Equation, equation;
    Statement, statement;
    Expr, expression;
    ComponentReference, reference;
    Path, path;
}
