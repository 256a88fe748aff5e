//! The types that borrow an [`Instance`], each for one task.
//!
//! Each view holds `&mut Instance` and nothing else, so making one costs nothing and none outlives its use.
//! Views call each other through the instance, which makes each change of task visible in the code:
//! `self.instance.evaluator().eval(..)`. Their methods stand in the files of their task, not here.

use crate::instance::Instance;

/// Defines the view types and, for each, the method of [`Instance`] that makes it.
macro_rules! views {
    ($($(#[$doc:meta])* $name:ident by $make:ident;)*) => {
        $(
            $(#[$doc])*
            pub struct $name<'i, 'a, 'l> {
                /// The component tree and its tables.
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
    /// Finds what names mean: elements of a class and its bases, imports, enclosing classes, full names (MLS 5.3).
    NameLookup by names;
    /// Builds components from declarations and the modifiers that reach them, and checks what a class may hold.
    ComponentBuilder by builder;
    /// Evaluates expressions to symbolic values: references, array constructors, subscripts, ranges, conditions.
    Evaluator by evaluator;
    /// Applies operators to values, also those that operator records define (MLS 10.6, 14).
    Operators by operators;
    /// Finds values and attributes of parameters, and marks those that the structure depends on.
    ParameterValues by parameters;
    /// Executes the statements of functions and algorithm sections on symbolic values (MLS 11.2).
    Statements by statements;
    /// Calls user functions: binds arguments, creates the scope of locals, executes the body (MLS 12.4).
    FunctionCalls by calls;
    /// Calls built-in functions and operators with function syntax (MLS 3.7).
    BuiltinCalls by builtins;
    /// Translates functions whose loops or conditions depend on variables into procedures of slots.
    ProcedureTranslator by procedures;
    /// Calls functions declared `external` (MLS 12.9).
    ExternalCalls by externals;
    /// Writes the mixing equations of stream connectors (MLS 15).
    StreamMixing by mixing;
}
