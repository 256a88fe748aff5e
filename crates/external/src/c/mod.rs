//! C functions of a user, declared `external "C"` in a Modelica library (Modelica 3.6, section 12.9).
//! A [`CSignature`] enters; a function for equations leaves ([`bind`]). The crate `model` calls both.
//!
//! The function is compiled together with a generated wrapper, which takes all arguments as an array of `double` and
//! gives all results in another one.
//!
//! Such a function counts as pure: equal arguments give equal results. Its derivatives are central differences.
//! Included files and libraries come from the annotations of the declaration.

mod native;

use bramah_expr::function::ExternalFunction;
use bramah_syntax::world::CompiledC;
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};

/// Step of a central difference, as a fraction of the argument's size.
/// It is the cube root of the machine precision, which balances rounding against truncation.
const REACH: f64 = 6e-6;
/// The smallest size of an argument, so that the step near 0 is not too small.
const SMALL: f64 = 1e-3;

/// The type of a number in C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CNumberType {
    /// `double`
    Real,
    /// `int`, also for Boolean values and enumerations.
    Integer,
}

impl CNumberType {
    /// The name of the type in C.
    fn c(self) -> &'static str {
        match self {
            CNumberType::Real => "double",
            CNumberType::Integer => "int",
        }
    }
}

/// An argument of the C function, in the order of its parameters.
/// Arrays are passed row by row.
#[derive(Clone, Debug, PartialEq)]
pub enum CArgument {
    /// A number that is passed in, or an array of so many numbers.
    Input(CNumberType, Option<usize>),
    /// A number that is passed out, or an array of so many numbers.
    Output(CNumberType, Option<usize>),
    /// A text that is known before the run. It becomes a literal in the wrapper.
    Text(String),
    /// A number known before the run. It becomes a literal in the wrapper.
    Number(f64),
    /// The size of an array, as `size_t`. It becomes a literal in the wrapper.
    Size(usize),
}

/// The call of a C function: name, result, arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct CSignature {
    /// The name of the function in C.
    pub name: String,
    /// The type of the return value. `None` for `void`.
    pub result: Option<CNumberType>,
    /// The arguments in order.
    pub arguments: Vec<CArgument>,
    /// The text of the `Include` annotation, which declares the function. If empty, the wrapper declares it by these
    /// types.
    pub include: String,
}

impl CSignature {
    /// The number of outputs: the return value, and all numbers of the output arguments.
    pub fn outputs(&self) -> usize {
        let of = |a: &CArgument| if let CArgument::Output(_, n) = a { n.unwrap_or(1) } else { 0 };
        usize::from(self.result.is_some()) + self.arguments.iter().map(of).sum::<usize>()
    }

    /// The C source of the wrapper, `int bramah_call(const double *in, double *out)`.
    /// It gives 0, or 1 if the function called `ModelicaError`.
    pub fn wrapper(&self) -> String {
        let (mut before, mut after, mut passed, mut types) = (String::new(), String::new(), Vec::new(), Vec::new());
        // Positions in `in` and `out`: the return value is the first output, arguments follow in order.
        let (mut read, mut written) = (0, 0);
        // The result is written only after the call.
        if self.result.is_some() {
            after += "  out[0] = result;\n";
            written = 1;
        }
        for (k, argument) in self.arguments.iter().enumerate() {
            let name = format!("a{k}");
            match argument {
                CArgument::Text(text) => {
                    passed.push(literal(text));
                    types.push("const char *".to_owned());
                    continue;
                }
                CArgument::Number(x) => {
                    passed.push(format!("{x}"));
                    types.push(if x.fract() == 0.0 { "int" } else { "double" }.to_owned());
                    continue;
                }
                CArgument::Size(n) => {
                    passed.push(format!("{n}"));
                    types.push("size_t".to_owned());
                    continue;
                }
                CArgument::Input(kind, None) => {
                    let _ = writeln!(before, "  {0} {name} = ({0}) in[{read}];", kind.c());
                    read += 1;
                    types.push(kind.c().to_owned());
                }
                CArgument::Input(kind, Some(n)) => {
                    // Static, because large arrays do not fit on the stack; calls are serialised by the caller.
                    // C has no arrays of length 0, so one element is declared at least.
                    let _ = writeln!(before, "  static {0} {name}[{1}];", kind.c(), n.max(&1));
                    let _ = writeln!(before, "  for (i = 0; i < {n}; i++) {name}[i] = ({}) in[{read} + i];", kind.c());
                    read += n;
                    types.push(format!("const {} *", kind.c()));
                }
                CArgument::Output(kind, n) => {
                    let count = n.unwrap_or(1);
                    let _ = writeln!(before, "  static {0} {name}[{1}];", kind.c(), count.max(1));
                    let _ = writeln!(after, "  for (i = 0; i < {count}; i++) out[{written} + i] = {name}[i];");
                    written += count;
                    types.push(format!("{} *", kind.c()));
                }
            }
            passed.push(name);
        }
        let result = self.result.map_or("void", CNumberType::c);
        let parameters = if types.is_empty() { "void".to_owned() } else { types.join(", ") };
        let declared = match self.include.is_empty() {
            true => format!("extern {result} {}({parameters});\n", self.name),
            false => format!("{}\n", self.include),
        };
        let call = format!("{}({})", self.name, passed.join(", "));
        let (local, call) = match self.result {
            Some(kind) => (format!("  {} result;\n", kind.c()), format!("result = {call}")),
            None => (String::new(), call),
        };
        format!(
            "{HEAD}{declared}\nint bramah_call(const double *in, double *out) {{\n  int i;\n{local}{before}  (void) in; (void) out; (void) i;\n  \
             // `longjmp` from `ModelicaError` returns to this point.
             if (setjmp(bramah_back)) return 1;\n  {call};\n{after}  return 0;\n}}\n"
        )
    }
}

/// The beginning of every wrapper: the functions of `ModelicaUtilities.h` (Modelica 3.6, section 12.9.6).
/// An error is stored and ends the call by `longjmp`; messages go to the standard error output.
const HEAD: &str = "#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static jmp_buf bramah_back;
static char bramah_words[1000];
const char *bramah_trouble(void) { return bramah_words; }
void ModelicaVFormatError(const char *text, va_list args) { vsnprintf(bramah_words, sizeof bramah_words, text, args); longjmp(bramah_back, 1); }
void ModelicaFormatError(const char *text, ...) { va_list args; va_start(args, text); ModelicaVFormatError(text, args); }
void ModelicaError(const char *text) { ModelicaFormatError(\"%s\", text); }
void ModelicaVFormatMessage(const char *text, va_list args) { vfprintf(stderr, text, args); }
void ModelicaFormatMessage(const char *text, ...) { va_list args; va_start(args, text); ModelicaVFormatMessage(text, args); va_end(args); }
void ModelicaMessage(const char *text) { ModelicaFormatMessage(\"%s\", text); }
void ModelicaFormatWarning(const char *text, ...) { va_list args; va_start(args, text); ModelicaVFormatMessage(text, args); va_end(args); }
void ModelicaWarning(const char *text) { ModelicaFormatMessage(\"%s\", text); }
char *ModelicaAllocateStringWithErrorReturn(size_t length) { return (char *) calloc(length + 1, 1); }
char *ModelicaAllocateString(size_t length) {
  char *text = ModelicaAllocateStringWithErrorReturn(length);
  if (!text) ModelicaError(\"no memory\");
  return text;
}
";

/// The text of `ModelicaUtilities.h`, which C sources of a user may include. Every wrapper defines these functions.
pub const UTILITIES: &str = "#ifndef MODELICA_UTILITIES_H
#define MODELICA_UTILITIES_H
#include <stdarg.h>
#include <stddef.h>
void ModelicaMessage(const char *text);
void ModelicaFormatMessage(const char *text, ...);
void ModelicaVFormatMessage(const char *text, va_list args);
void ModelicaWarning(const char *text);
void ModelicaFormatWarning(const char *text, ...);
void ModelicaError(const char *text);
void ModelicaFormatError(const char *text, ...);
void ModelicaVFormatError(const char *text, va_list args);
char *ModelicaAllocateString(size_t length);
char *ModelicaAllocateStringWithErrorReturn(size_t length);
#endif
";

/// A text as a C string literal. Bytes outside ASCII become octal escapes.
/// Texts must not contain zero bytes, as C ends a string there.
fn literal(text: &str) -> String {
    let mut out = String::from("\"");
    for byte in text.bytes() {
        match byte {
            b'"' | b'\\' => out.extend(['\\', byte as char]),
            b' '..=b'~' => out.push(byte as char),
            _ => {
                let _ = write!(out, "\\{byte:03o}");
            }
        }
    }
    out + "\""
}

/// Loads a compiled wrapper as a function of numbers. The signature must be the one it was written from.
/// Inputs are the numbers of the input arguments in order, arrays element by element; outputs as in
/// [`CSignature::outputs`].
///
/// # Errors
/// The message of the system, if the library cannot be loaded.
pub fn bind(compiled: CompiledC, signature: &CSignature) -> Result<Arc<dyn ExternalFunction>, String> {
    // Only Real inputs may take any value, so only they have derivatives.
    let smooth = signature.arguments.iter().flat_map(|argument| match argument {
        CArgument::Input(kind, n) => vec![*kind == CNumberType::Real; n.unwrap_or(1)],
        _ => Vec::new(),
    });
    let called = CallState { native: native::WrapperLibrary::load(compiled)?, last: None, trouble: None };
    let (smooth, outputs) = (smooth.collect(), signature.outputs());
    let library = Arc::new(CLibrary { name: signature.name.clone(), outputs, smooth, called: Mutex::new(called) });
    Ok(Arc::new(CFunction { library, by: None }))
}

/// A compiled C function with its library.
/// All functions and derivatives of one declaration share it.
#[derive(Debug)]
struct CLibrary {
    /// The name of the function, for messages.
    name: String,
    /// The number of outputs.
    outputs: usize,
    /// For each input, whether it is Real and may take any value.
    smooth: Vec<bool>,
    /// The library and what is known of its last call. One call runs at a time.
    called: Mutex<CallState>,
}

/// The state that a call changes. A mutex guards it, because C code need not be safe in several threads.
#[derive(Debug)]
/// The loaded wrapper.
struct CallState {
    native: native::WrapperLibrary,
    /// The bits of the last arguments, with all outputs. Equations ask for one output at a time.
    last: Option<(Vec<u64>, Vec<f64>)>,
    /// The message of the last call that failed.
    trouble: Option<String>,
}

impl CLibrary {
    /// One output. NaN if the call failed.
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        let bits: Vec<u64> = args.iter().map(|x| x.to_bits()).collect();
        let mut called = self.called.lock().unwrap_or_else(PoisonError::into_inner);
        if called.last.as_ref().is_none_or(|(of, _)| *of != bits) {
            let mut found = vec![f64::NAN; self.outputs];
            // Outputs that a failed call has not written must not look like results.
            if let Err(words) = called.native.call(args, &mut found) {
                found.fill(f64::NAN);
                called.trouble = Some(format!("`{}`: {words}", self.name));
            }
            called.last = Some((bits, found));
        }
        called.last.as_ref().and_then(|(_, found)| found.get(output).copied()).unwrap_or(f64::NAN)
    }
}

/// The function itself, or its derivatives by one input.
/// It computes derivatives by calling the function twice.
#[derive(Debug)]
struct CFunction {
    /// The compiled code, shared by the function and its derivatives.
    library: Arc<CLibrary>,
    /// The input of the derivative. `None` for the function itself.
    by: Option<usize>,
}

impl ExternalFunction for CFunction {
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        let Some(by) = self.by else { return self.library.value(output, args) };
        // Two calls, one on each side of the argument.
        let reach = REACH * args[by].abs().max(SMALL);
        let mut beside = args.to_vec();
        let mut at = |x: f64| {
            beside[by] = x;
            self.library.value(output, &beside)
        };
        (at(args[by] + reach) - at(args[by] - reach)) / (2.0 * reach)
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        // Differences of differences would be too inaccurate: there are no second derivatives.
        let smooth = self.by.is_none() && self.library.smooth.get(input) == Some(&true);
        smooth.then(|| {
            Arc::new(CFunction { library: self.library.clone(), by: Some(input) }) as Arc<dyn ExternalFunction>
        })
    }

    fn trouble(&self) -> Option<String> {
        self.library.called.lock().unwrap_or_else(PoisonError::into_inner).trouble.clone()
    }

    fn failure(&self) -> Option<String> {
        self.trouble()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_keep_their_order_and_texts_are_written_out() {
        let signature = CSignature {
            name: "f".into(),
            result: Some(CNumberType::Real),
            arguments: vec![
                CArgument::Input(CNumberType::Real, None),
                CArgument::Input(CNumberType::Integer, Some(2)),
                CArgument::Size(2),
                CArgument::Output(CNumberType::Real, Some(3)),
                CArgument::Text("a\"b".into()),
            ],
            include: String::new(),
        };
        let text = signature.wrapper();
        assert!(text.contains("extern double f(double, const int *, size_t, double *, const char *);"), "{text}");
        assert!(text.contains(r#"result = f(a0, a1, 2, a3, "a\"b");"#), "{text}");
        assert_eq!(signature.outputs(), 4);
    }
}
