//! Calls of a user's own C functions, with the feature `fmi` and only if the user has allowed them.
//!
//! The C signature follows from the declarations in Modelica (MLS 12.9.1). Annotations name sources and libraries (MLS
//! 12.9.4). A wrapper in C is compiled, loaded, and called like any other external function.

use crate::instance::ExternalCalls;
use crate::instance::call::Callee;
use crate::instance::calls::external::{CCall, ExternalArgument, external_text};
use crate::instance::value::ModelicaValue;
use bramah_expr::function::ExternalFunction;
use bramah_expr::types::ScalarType;
use bramah_external::c::{self, CNumberType, CSignature};
use bramah_syntax::ast::{CausalityPrefix, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::ffi::OsString;
use std::sync::Arc;

/// The folder of libraries for this machine, below that of libraries for all machines (MLS 12.9.4).
const MACHINE: &str = "linux64";

impl<'a> ExternalCalls<'_, 'a, '_> {
    /// Calls a C function of the user. `None` after a message, if this is not allowed or not possible.
    /// `--external` on the command line allows it. Without that the message explains how.
    /// `positional` and `named` are the evaluated arguments.
    pub(in crate::instance) fn call_c(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        if !self.instance.library.calls_c() {
            self.instance.report(
                Diagnostic::new(Code::Unsupported, format!("the external function `{}` is not supported", callee.name))
                    .at(span, "C code is not called unasked")
                    .help("allow it: --external FILE for a C source or a shared library, --external annotations for what the function's annotations name"),
            );
            return None;
        }
        self.instance.calls().with_inputs(callee, positional, named, span, |s| s.externals().carry_out_c(callee, span))
    }

    /// Compiles and calls a C function. The inputs are bound already. `None` after a message.
    ///
    /// Only calls in C are supported, not Fortran.
    /// The wrapper is compiled at the first call with this signature and reused afterwards.
    fn carry_out_c(&mut self, callee: &Callee<'a>, span: Span) -> Option<ModelicaValue> {
        let is_c = !external_text(callee)?.trim_start().starts_with("\"FORTRAN");
        let Some(call) = self.c_call(callee).filter(|_| is_c) else {
            self.instance
                .unsupported(span, &format!("the language or the call of the external function `{}`", callee.name));
            return None;
        };
        self.prepare_locals(callee)?;
        let signature = self.signature(&call, callee, span)?;
        let wrapper = signature.wrapper();
        // The text of the wrapper identifies the function: equal text means the same function and signature.
        let function = match self.instance.functions.compiled_c.get(&wrapper) {
            Some(known) => known.clone(),
            None => self.compiled(&signature, &wrapper, callee, span)?,
        };
        let mut scalars = Vec::new();
        for argument in &call.arguments {
            // Strings are part of the wrapper, and outputs are not handed over; only numbers are arguments.
            if let (ExternalArgument::Name(name), Some(value)) = (argument, self.input_of_c(argument))
                && !self.is_output(callee, *name)
                && !matches!(value, ModelicaValue::Text(_))
            {
                value.scalars(&mut scalars);
            }
        }
        self.external_function(function, &wrapper, &call, callee, &scalars)
    }

    /// Compiles the wrapper of a C function and loads it. `None` after a message.
    ///
    /// A second message tells the user that C code runs and which command compiled it.
    /// The result is kept under the text of the wrapper.
    /// `wrapper` is the C text for `signature`. The message uses the Modelica name of the function.
    /// An error of the compiler or a missing function is reported with the reason.
    fn compiled(
        &mut self,
        signature: &CSignature,
        wrapper: &str,
        callee: &Callee<'a>,
        span: Span,
    ) -> Option<Arc<dyn ExternalFunction>> {
        let arguments = self.compiler_arguments(callee);
        // Utilities are the C functions that Modelica defines for external code, as `ModelicaError`.
        let compiled = self.instance.library.compile_c(wrapper, c::UTILITIES, arguments);
        let ran = compiled.as_ref().map(|c| c.command.clone()).unwrap_or_default();
        match compiled.and_then(|compiled| c::bind(compiled, signature)) {
            Ok(function) => {
                let said = format!("`{}` is C code, which runs unguarded", callee.name);
                self.instance
                    .report(Diagnostic::new(Code::RunsC, said).at(span, "this call").note(format!("ran: {ran}")));
                self.instance.functions.compiled_c.insert(wrapper.to_owned(), function.clone());
                Some(function)
            }
            Err(why) => {
                let said = format!("the external function `{}` cannot be called: {why}", callee.name);
                self.instance.report(
                    Diagnostic::new(Code::BadCall, said)
                        .at(span, "this call")
                        .help("give every C source and library that it takes with --external"),
                );
                None
            }
        }
    }

    /// Whether a name is an output of the function.
    fn is_output(&mut self, callee: &Callee<'a>, name: bramah_syntax::symbol::Symbol) -> bool {
        self.instance
            .calls()
            .formals(callee, |c, _| c.prefix.causality == Some(CausalityPrefix::Output))
            .iter()
            .any(|f| f.name == name)
    }

    /// The C signature of a call: kind and size of each argument and of the result (MLS 12.9.1).
    ///
    /// `None` after a message, if an argument has no counterpart in C or is not known.
    /// Strings and sizes are written into the wrapper, so they must be known.
    /// `call` is the call behind `external`, `span` the Modelica call for messages.
    /// Arrays are passed with their number of elements.
    fn signature(&mut self, call: &CCall, callee: &Callee<'a>, span: Span) -> Option<CSignature> {
        let outputs = self.instance.calls().formals(callee, |c, _| c.prefix.causality == Some(CausalityPrefix::Output));
        let mut arguments = Vec::new();
        for argument in &call.arguments {
            let made = match argument {
                ExternalArgument::Text(words) => Some(c::CArgument::Text(words.clone())),
                ExternalArgument::Number(x) => Some(c::CArgument::Number(*x)),
                ExternalArgument::Size(name, dimension) => {
                    let value = self.input_of_c(&ExternalArgument::Name(*name))?;
                    value.dims().get(dimension - 1).map(|n| c::CArgument::Size(*n))
                }
                ExternalArgument::Name(name) => match outputs.iter().find(|f| f.name == *name) {
                    Some(formal) => {
                        // Outputs are arrays that the C function fills; their declared sizes tell how large they are.
                        let blank = self.instance.calls().declared_local(formal)?;
                        number(&blank).map(|(kind, n)| c::CArgument::Output(kind, n))
                    }
                    None => match self.input_of_c(argument)? {
                        text @ ModelicaValue::Text(_) => text.as_text(&self.instance.exprs).map(c::CArgument::Text),
                        value => number(&value).map(|(kind, n)| c::CArgument::Input(kind, n)),
                    },
                },
                ExternalArgument::Other => None,
            };
            let Some(made) = made else {
                self.instance
                    .unsupported(span, &format!("an argument of `{}` in the C call of `{}`", call.name, callee.name));
                return None;
            };
            arguments.push(made);
        }
        let result = match call.result.and_then(|name| outputs.iter().find(|f| f.name == name)) {
            Some(formal) => Some(number(&self.instance.calls().declared_local(formal)?)?.0),
            None => None,
        };
        let include = annotation_texts(external_text(callee)?, "Include").join("\n");
        Some(CSignature { name: call.name.clone(), result, arguments, include })
    }

    /// The arguments of the C compiler that the annotations ask for: header folders, library folders, libraries.
    ///
    /// A folder that is not named is the usual one of the package, as `Resources/Include` (MLS 12.9.4).
    /// `Library` names become `-l` arguments, in the order of the annotation.
    fn compiler_arguments(&mut self, callee: &Callee<'a>) -> Vec<OsString> {
        let text = external_text(callee).unwrap_or_default();
        let package = callee.name.split('.').next().unwrap_or_default().to_owned();
        let mut folder = |key: &str, usual: &str| {
            let named = annotation_texts(text, key);
            let usual = vec![format!("modelica://{package}/Resources/{usual}")];
            let addresses = if named.is_empty() { usual } else { named };
            addresses.iter().filter_map(|address| self.instance.library.resource(address)).collect::<Vec<_>>()
        };
        let (headers, sources) = (folder("IncludeDirectory", "Include"), folder("SourceDirectory", "Source"));
        let libraries = folder("LibraryDirectory", "Library");
        let mut made: Vec<OsString> = Vec::new();
        let mut flag = |flag: &str, of: &std::path::Path| {
            let mut argument = OsString::from(flag);
            argument.push(of);
            made.push(argument);
        };
        headers.iter().chain(&sources).for_each(|path| flag("-I", path));
        // The folder for this machine is searched before the one for all machines.
        for path in libraries.iter().flat_map(|path| [path.join(MACHINE), path.clone()]) {
            flag("-L", &path);
            flag("-Wl,-rpath,", &path);
        }
        annotation_texts(text, "Library").iter().for_each(|name| flag("-l", std::path::Path::new(name)));
        made
    }
}

/// The kind of numbers in a value, and how many they are; no count for a scalar. `None` for other values.
/// Booleans and enumeration values are Integers in C.
fn number(value: &ModelicaValue) -> Option<(CNumberType, Option<usize>)> {
    let kind = if value.element_type()? == ScalarType::Real { CNumberType::Real } else { CNumberType::Integer };
    let dims = value.dims();
    Some((kind, (!dims.is_empty()).then(|| dims.iter().product())))
}

/// The Strings that an annotation gives under a key: `Library = "a"` or `Library = {"a", "b"}`.
/// The first occurrence as a complete word counts. Empty if there is none.
/// The text is searched, since annotations of external functions are kept as text.
fn annotation_texts(text: &str, key: &str) -> Vec<String> {
    let mut rest = text;
    while let Some(at) = rest.find(key) {
        let before = rest[..at].chars().next_back();
        rest = &rest[at + key.len()..];
        let value = rest.trim_start();
        // `Include` also occurs inside of `IncludeDirectory` and of longer names, which are not this key.
        let is_key = before.is_none_or(|c| !c.is_alphanumeric() && c != '_');
        if let Some(value) = value.strip_prefix('=').filter(|_| is_key) {
            let value = value.trim_start();
            return match value.strip_prefix('{') {
                Some(list) => quoted(list, true),
                None => quoted(value, false),
            };
        }
    }
    Vec::new()
}

/// The Strings in quotes at the beginning of a text, with their escapes resolved.
/// With `list`, all up to the brace that closes the list, otherwise the first one only.
/// Spaces and commas between the entries of a list are skipped. Anything else ends the list.
fn quoted(text: &str, list: bool) -> Vec<String> {
    let (mut found, mut open): (Vec<String>, Option<String>) = (Vec::new(), None);
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        match (&mut open, c) {
            (None, '"') => open = Some(String::new()),
            (None, ',') | (None, ' ' | '\n' | '\t' | '\r') if list => {}
            (None, _) => break,
            (Some(words), '\\') => words.extend(characters.next().map(|c| match c {
                'n' => '\n',
                't' => '\t',
                other => other,
            })),
            (Some(_), '"') => {
                found.extend(open.take());
                if !list {
                    break;
                }
            }
            (Some(words), c) => words.push(c),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn annotations_have_texts_alone_and_in_lists() {
        let text = r##""C" y = f(x) annotation(IncludeDirectory = "modelica://A/B", Include="#include \"f.h\"", Library={"a", "b"});"##;
        assert_eq!(annotation_texts(text, "Include"), ["#include \"f.h\""]);
        assert_eq!(annotation_texts(text, "Library"), ["a", "b"]);
        assert_eq!(annotation_texts(text, "IncludeDirectory"), ["modelica://A/B"]);
        assert!(annotation_texts(text, "LibraryDirectory").is_empty());
    }
}
