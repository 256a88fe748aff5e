//! Who works on an [`Instance`]: each of these borrows it whole and knows one thing. They call each other through it,
//! so that every step from one task to another is written out: `self.instance.evaluator().eval(..)`.

use crate::instance::Instance;

/// A type that borrows the instance, and the method of the instance that makes one.
macro_rules! views {
    ($($(#[$doc:meta])* $name:ident by $make:ident;)*) => {
        $(
            $(#[$doc])*
            pub struct $name<'i, 'a, 'l> {
                pub(in crate::instance) instance: &'i mut Instance<'a, 'l>,
            }
        )*

        impl<'a, 'l> Instance<'a, 'l> {
            $(
                $(#[$doc])*
                pub fn $make(&mut self) -> $name<'_, 'a, 'l> {
                    $name { instance: self }
                }
            )*
        }
    };
}

views! {
    /// Finds what names mean: elements of a class and of its bases, imports, classes by their full names.
    NameLookup by names;
    /// Builds components from declarations and the modifiers that reach them.
    ComponentBuilder by builder;
    /// Evaluates expressions: references, array constructors, indices, ranges, conditions.
    Evaluator by evaluator;
    /// Applies operators to values, those of operator records included.
    Operators by operators;
    /// Finds the values and attributes of parameters, as far as the structure of the model needs them.
    ParameterValues by parameters;
    /// Carries out statements of functions and algorithm sections on symbolic values.
    Statements by statements;
    /// Calls functions of the user: binds arguments, makes locals, writes the body out.
    FunctionCalls by calls;
    /// Calls built-in functions.
    BuiltinCalls by builtins;
    /// Translates functions that cannot be written out into procedures.
    ProcedureTranslator by procedures;
    /// Calls functions that are declared `external`.
    ExternalCalls by externals;
    /// Mixes what flows carry.
    StreamMixing by mixing;
}
