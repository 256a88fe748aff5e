//! Calls of external functions that [`bramah_external`] knows by their C names.
//!
//! The call behind `external` is parsed: it tells the C name and the order of the arguments (MLS 12.9).
//! If all arguments are known, the function is computed at once. Otherwise the call stays in the flat model.
//! The functions in `c` use the same parts for C code of the user.

use crate::instance::ExternalCalls;
use crate::instance::FunctionCalls;
use crate::instance::call::Callee;
use crate::instance::files::FileReference;
use crate::instance::value::ModelicaValue;
use bramah_expr::ExprId;
use bramah_expr::function::{ExternalFunction, ExternalFunctionHandle, Function, SlotExpr, SlotStatement};
use bramah_expr::types::ScalarType;
use bramah_external::{BuiltinImplementation, ExternalValue, NO_NAME};
use bramah_syntax::ast::{CausalityPrefix, ClassBody, Ident};
use bramah_syntax::diag::Code;
use bramah_syntax::symbol::Symbol;
use std::sync::Arc;

/// The C call behind `external`: `result = name(arguments)`.
pub(super) struct CCall {
    /// The name of the C function.
    pub name: String,
    /// The output that takes the result of the C function. `None` if it returns nothing.
    pub result: Option<Symbol>,
    /// The arguments in the order of the call.
    pub arguments: Vec<ExternalArgument>,
}

/// An argument of a C call.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ExternalArgument {
    /// An input, output or protected variable of the Modelica function.
    Name(Symbol),
    /// A String literal.
    Text(String),
    /// A number, or a Boolean as 0 or 1.
    Number(f64),
    /// `size(name, dimension)`, with the dimension counted from 1.
    Size(Symbol, usize),
    /// Any other expression, which is not supported.
    Other,
}

impl ExternalArgument {
    /// Parses one argument, without the spaces around it.
    /// Booleans become 0 and 1: they are integers in C (MLS 12.9.1).
    fn parse(text: &str) -> Self {
        match text {
            "true" => ExternalArgument::Number(1.0),
            "false" => ExternalArgument::Number(0.0),
            _ if is_name(text) => ExternalArgument::Name(Symbol::new(text)),
            _ => match (text.parse(), text.strip_prefix('"').and_then(|t| t.strip_suffix('"'))) {
                (Ok(number), _) => ExternalArgument::Number(number),
                (_, Some(words)) => ExternalArgument::Text(words.to_owned()),
                _ => Self::size(text).unwrap_or(ExternalArgument::Other),
            },
        }
    }

    /// Parses `size(name, dimension)`. `None` for anything else.
    fn size(text: &str) -> Option<Self> {
        let (name, dimension) = text.strip_prefix("size(")?.strip_suffix(')')?.split_once(',')?;
        let dimension = dimension.trim().parse().ok().filter(|d| *d > 0)?;
        is_name(name.trim()).then(|| ExternalArgument::Size(Symbol::new(name.trim()), dimension))
    }

    /// The name, if the argument is one.
    fn name(&self) -> Option<Symbol> {
        match self {
            ExternalArgument::Name(name) => Some(*name),
            _ => None,
        }
    }
}

impl CCall {
    /// Parses the text between `external` and its semicolon. A language string in front is skipped.
    ///
    /// `None` if there is no call: the function's own name, inputs and output are meant then (MLS 12.9), which is not
    /// supported.
    fn parse(text: &str) -> Option<Self> {
        let text = text.trim_start();
        // `external "C" y = f(x)`: the language in quotes is no part of the call.
        let text = text.strip_prefix('"').map_or(text, |t| t.split_once('"').map_or("", |(_, rest)| rest));
        let (head, rest) = text.split_once('(')?;
        let (result, name) = match head.split_once('=') {
            Some((result, name)) => (Some(result.trim()), name.trim()),
            None => (None, head.trim()),
        };
        if name.is_empty() || name.contains(char::is_whitespace) {
            return None;
        }
        Some(CCall {
            name: name.to_owned(),
            result: result.map(Symbol::new),
            arguments: arguments(rest).into_iter().map(ExternalArgument::parse).collect(),
        })
    }
}

/// Splits arguments at their commas, up to the parenthesis that closes the list.
/// Commas inside strings, parentheses, brackets and braces do not count.
/// The closing parenthesis of the call must be in the text; what follows it is not read.
fn arguments(text: &str) -> Vec<&str> {
    let (mut depth, mut begin, mut found, mut quoted) = (0, 0, Vec::new(), false);
    for (at, c) in text.char_indices() {
        quoted ^= c == '"';
        match c {
            _ if quoted => {}
            '(' | '[' | '{' => depth += 1,
            ')' if depth == 0 => {
                found.push(text[begin..at].trim());
                break;
            }
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(text[begin..at].trim());
                begin = at + 1;
            }
            _ => {}
        }
    }
    found
}

/// Whether a text is an identifier.
fn is_name(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.chars().all(letter) && text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

/// The text behind `external` in a function or one of its bases, annotations included. `None` if there is none.
pub(super) fn external_text<'a>(callee: &Callee<'a>) -> Option<&'a str> {
    callee.template.bases.iter().find_map(|b| match &b.ast.body {
        ClassBody::Long(body) => body.external_text.as_deref(),
        _ => None,
    })
}

impl<'a> ExternalCalls<'_, 'a, '_> {
    /// The implementation in Rust of an external function. `None` if its C name is not known.
    pub(in crate::instance) fn external_builtin_of(&self, callee: &Callee<'a>) -> Option<BuiltinImplementation> {
        bramah_external::builtin(&self.c_call(callee)?.name)
    }

    /// The C call of an external function. `None` if it has no call that can be parsed.
    pub(super) fn c_call(&self, callee: &Callee<'a>) -> Option<CCall> {
        CCall::parse(external_text(callee)?)
    }

    /// Calls an external function that is implemented in Rust. `None` after a message.
    /// `place` tells messages where the call stands and where a file name was given.
    pub(in crate::instance) fn call_external(
        &mut self,
        how: BuiltinImplementation,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        place: FileReference,
    ) -> Option<ModelicaValue> {
        self.instance.calls().with_inputs(callee, positional, named, place.call, |s| {
            s.externals().carry_out_external(how, callee, place)
        })
    }

    /// Computes an external function, or leaves its call in the flat model. The inputs are bound already.
    ///
    /// `None` after a message. What happens depends on the kind of implementation:
    /// - an FMU, or an external object such as a table, is created while the model is built;
    /// - values need known arguments;
    /// - a function of numbers stays a call, unless all arguments are known.
    ///
    /// `how` is the implementation, `place` the call and the file name for messages.
    /// Arguments that are not known before the run are passed on as such to implementations that accept it.
    fn carry_out_external(
        &mut self,
        how: BuiltinImplementation,
        callee: &Callee<'a>,
        place: FileReference,
    ) -> Option<ModelicaValue> {
        let call = self.c_call(callee)?;
        self.prepare_locals(callee)?;
        // Evaluated before the implementation is asked: it decides by which arguments are known.
        let values: Vec<Option<ModelicaValue>> = call.arguments.iter().map(|a| self.input_of_c(a)).collect();
        let given: Vec<ExternalValue> = values.iter().map(|v| self.given(v.as_ref())).collect();
        match how {
            #[cfg(feature = "fmi")]
            BuiltinImplementation::MockUp => self.instance.builder().mock_up(&given, place),
            #[cfg(not(feature = "fmi"))]
            BuiltinImplementation::MockUp => {
                self.instance.fail(Code::Unsupported, "this build has no functional mock-up units", place.call)
            }
            BuiltinImplementation::Nothing => Some(ModelicaValue::Tuple(Vec::new().into())),
            BuiltinImplementation::Object(make) => {
                let given = self.table_given(given, place)?;
                match make(&given) {
                    Ok(object) => Some(ModelicaValue::Object(object)),
                    Err(why) => {
                        self.instance.fail(Code::BadCall, &format!("the table cannot be used: {why}"), place.call)
                    }
                }
            }
            BuiltinImplementation::Values(make) => match make(&given) {
                Some(found) => self.external_values(found, &call, callee),
                None => {
                    let message = format!("the arguments of `{}` must be known before the run", callee.name);
                    self.instance.fail(Code::NotConstant, &message, place.call)
                }
            },
            BuiltinImplementation::Function(make) => {
                let Some(function) = make(&given) else {
                    let message = format!("these arguments do not fit `{}`", callee.name);
                    return self.instance.fail(Code::BadCall, &message, place.call);
                };
                // Functions of one table differ by the table, so its address is part of the key.
                let object = given.iter().find_map(|g| match g {
                    ExternalValue::Object(object) => Some(object.address()),
                    _ => None,
                });
                let mut scalars = Vec::new();
                values.iter().flatten().for_each(|v| v.scalars(&mut scalars));
                let key = format!("{} of {:x}", call.name, object.unwrap_or(0));
                self.external_function(function, &key, &call, callee, &scalars)
            }
        }
    }

    /// The value of an argument that is a local of the function or a literal. `None` for all others.
    pub(super) fn input_of_c(&mut self, argument: &ExternalArgument) -> Option<ModelicaValue> {
        match argument {
            ExternalArgument::Name(name) => self.instance.local(*name).map(|i| self.instance.eval.locals[i].1.clone()),
            ExternalArgument::Text(words) => Some(ModelicaValue::text(words.as_str())),
            ExternalArgument::Number(x) => Some(ModelicaValue::Scalar(self.instance.exprs.num(*x), ScalarType::Real)),
            ExternalArgument::Size(..) | ExternalArgument::Other => None,
        }
    }

    /// Makes locals of the outputs and protected variables that are declared with a value.
    /// C code may read them as arguments. `None` after a message.
    pub(super) fn prepare_locals(&mut self, callee: &Callee<'a>) -> Option<()> {
        let formals = self.instance.calls().formals(callee, |c, p| {
            !crate::instance::calls::binding::is_input(c, p)
                && c.modification.as_ref().is_some_and(|m| m.value.is_some())
        });
        for f in crate::instance::calls::locals::in_order_of_use(&formals) {
            let value = self.instance.calls().declared_local(f)?;
            self.instance.eval.locals.push((f.name, value));
        }
        Some(())
    }

    /// An argument in the form in which [`bramah_external`] takes it. Numbers that are not known are `None` in it.
    /// A missing argument, such as an output, is an empty list of numbers.
    fn given(&self, value: Option<&ModelicaValue>) -> ExternalValue {
        match value {
            Some(text @ ModelicaValue::Text(_)) => match text.as_text(&self.instance.exprs) {
                Some(text) => ExternalValue::Text(text),
                None => ExternalValue::Numbers { dims: Vec::new(), values: vec![None] },
            },
            Some(ModelicaValue::Object(object)) => ExternalValue::Object(object.clone()),
            Some(value) => {
                let mut scalars = Vec::new();
                value.scalars(&mut scalars);
                let values = scalars.iter().map(|e| self.instance.exprs.as_num(*e)).collect();
                ExternalValue::Numbers { dims: value.dims().to_vec(), values }
            }
            None => ExternalValue::Numbers { dims: Vec::new(), values: Vec::new() },
        }
    }

    /// Replaces the matrix among the arguments of a table by that of the file, if a file and a table are named.
    /// `None` after a message, if it cannot be read.
    /// The first argument is the file, the second the table, the third the matrix given in the model.
    fn table_given(&mut self, mut given: Vec<ExternalValue>, place: FileReference) -> Option<Vec<ExternalValue>> {
        let (Some(ExternalValue::Text(file)), Some(ExternalValue::Text(name))) = (given.first(), given.get(1)) else {
            return Some(given);
        };
        // `NO_NAME` in the place of the file means that the matrix is given in the model.
        if file == NO_NAME {
            return Some(given);
        }
        let name = if name == NO_NAME { String::new() } else { name.clone() };
        let matrix = self.table(&file.clone(), &name, place)?;
        let values = matrix.values.iter().copied().map(Some).collect();
        given[2] = ExternalValue::Numbers { dims: vec![matrix.rows, matrix.columns], values };
        Some(given)
    }

    /// The outputs in the order of the C call: the result first, then the outputs among the arguments.
    fn c_outputs(&mut self, call: &CCall, callee: &Callee<'a>) -> Vec<Symbol> {
        let formals = self.instance.calls().formals(callee, |c, _| c.prefix.causality == Some(CausalityPrefix::Output));
        let outputs =
            call.arguments.iter().filter_map(ExternalArgument::name).filter(|n| formals.iter().any(|f| f.name == *n));
        call.result.into_iter().chain(outputs).collect()
    }

    /// The outputs of a function from values that Rust has computed, in the order of their declaration.
    /// `None` if one is missing or not a number.
    /// Values that are Strings or external objects are taken as they are. Numbers get the declared type.
    fn external_values(
        &mut self,
        found: Vec<ExternalValue>,
        call: &CCall,
        callee: &Callee<'a>,
    ) -> Option<ModelicaValue> {
        let names = self.c_outputs(call, callee);
        // The implementation returns values in the order of the C call, Modelica wants that of the declaration.
        let mut outputs = Vec::new();
        for f in self.instance.calls().formals(callee, |c, _| c.prefix.causality == Some(CausalityPrefix::Output)) {
            let at = names.iter().position(|n| *n == f.name)?;
            let ty = self.instance.calls().declared_local(&f)?.element_type().unwrap_or(ScalarType::Real);
            outputs.push(match found.get(at)? {
                ExternalValue::Text(text) => ModelicaValue::text(text.as_str()),
                ExternalValue::Object(object) => ModelicaValue::Object(object.clone()),
                ExternalValue::Numbers { dims, values } => {
                    let number = |x: &Option<f64>| Some(ModelicaValue::Scalar(self.instance.exprs.num((*x)?), ty));
                    let mut numbers: Vec<ModelicaValue> = values.iter().map(number).collect::<Option<_>>()?;
                    if dims.is_empty() { numbers.pop()? } else { ModelicaValue::array(dims.clone(), numbers) }
                }
            });
        }
        FunctionCalls::outputs(outputs)
    }

    /// The outputs of an external function of numbers: computed if all arguments are known, otherwise as calls.
    ///
    /// `key` identifies the function, so that equal ones are stored once. `scalars` are the arguments without shape.
    /// `None` after a message.
    ///
    /// Outputs are counted scalar by scalar in the order of the C call.
    /// For known arguments each of them is computed now. Otherwise each is a call with its number.
    /// The shapes of the outputs come from their declarations.
    pub(super) fn external_function(
        &mut self,
        function: Arc<dyn ExternalFunction>,
        key: &str,
        call: &CCall,
        callee: &Callee<'a>,
        scalars: &[ExprId],
    ) -> Option<ModelicaValue> {
        let names = self.c_outputs(call, callee);
        let formals = self.instance.calls().formals(callee, |c, _| c.prefix.causality == Some(CausalityPrefix::Output));
        let mut blanks = Vec::new();
        for name in &names {
            let f = formals.iter().find(|f| f.name == *name)?;
            blanks.push((*name, self.instance.calls().declared_local(f)?));
        }
        let count: usize = blanks.iter().map(|(_, v)| v.elements().len()).sum();
        // A single unknown scalar makes the call part of the run.
        let known: Option<Vec<f64>> = scalars.iter().map(|e| self.instance.exprs.as_num(*e)).collect();
        let results: Vec<ExprId> = match known {
            Some(args) => (0..count).map(|k| self.instance.exprs.num(function.value(k, &args))).collect(),
            None => {
                let id = self.external_id(function, key, &callee.name, scalars.len(), count);
                let output = |k: usize| u32::try_from(k).expect("few outputs");
                (0..count).map(|k| self.instance.exprs.call(id, output(k), scalars)).collect()
            }
        };
        let mut results = results.into_iter();
        let mut filled: Vec<(Symbol, ModelicaValue)> = Vec::new();
        for (name, blank) in blanks {
            filled.push((name, blank.map(&mut |e, _| results.next().unwrap_or(e))));
        }
        // Back from the order of the C call to that of the declaration.
        let output = |f: &crate::instance::call::FormalParameter<'a>| {
            filled.iter().find(|(n, _)| *n == f.name).map(|(_, v)| v.clone())
        };
        let outputs: Option<Vec<ModelicaValue>> = formals.iter().map(output).collect();
        FunctionCalls::outputs(outputs?)
    }

    /// The function of the pool that calls an external function; it is added if `key` is new.
    ///
    /// Its procedure has one slot for each input and each output, and one statement for each output.
    /// `name` is that of the Modelica function, for messages during the run.
    fn external_id(
        &mut self,
        function: Arc<dyn ExternalFunction>,
        key: &str,
        name: &str,
        inputs: usize,
        outputs: usize,
    ) -> bramah_expr::FunctionId {
        if let Some(&id) = self.instance.functions.externals.get(key) {
            return id;
        }
        let small = |n: usize| u32::try_from(n).expect("few arguments");
        let handle = ExternalFunctionHandle(function);
        let args: Vec<SlotExpr> = (0..small(inputs)).map(SlotExpr::Slot).collect();
        let slots: Vec<u32> = (0..outputs).map(|k| small(inputs + k)).collect();
        let assign = |(k, slot): (usize, &u32)| {
            SlotStatement::Assign(*slot, SlotExpr::External(handle.clone(), small(k), args.clone()))
        };
        let id = self.instance.exprs.add_function(Function {
            name: name.to_owned(),
            inputs: small(inputs),
            slots: small(inputs + outputs),
            outputs: slots.clone(),
            body: slots.iter().enumerate().map(assign).collect(),
        });
        self.instance.functions.externals.insert(key.to_owned(), id);
        id
    }

    /// Calls the constructor of an external object by the name of its class (MLS 12.9.7).
    /// `None` after a message, if there is no constructor or its C function is not known.
    /// `given` are the evaluated arguments, `class` is the class that extends `ExternalObject`.
    pub(in crate::instance) fn construct_object(
        &mut self,
        class: &crate::instance::ClassRef<'a>,
        given: crate::instance::vectorised::CallArguments,
        place: FileReference,
    ) -> Option<ModelicaValue> {
        let constructor = match self
            .instance
            .names()
            .member(&crate::instance::lookup::LookupResult::Class(class.clone()), Symbol::new("constructor"))
        {
            Some(crate::instance::lookup::LookupResult::Class(c)) => c,
            _ => {
                let message = format!("`{}` has no `constructor`", self.instance.library.full_name(class.class));
                return self.instance.fail(Code::BadCall, &message, place.call);
            }
        };
        let template = self.instance.names().template(constructor.class, constructor.parent);
        let scope = self.instance.names().package(&constructor);
        let callee = Callee { scope, template, name: self.instance.library.full_name(constructor.class) };
        match self.external_builtin_of(&callee) {
            Some(how) => self.call_external(how, &callee, given.positional, given.named, place),
            None => {
                self.instance.unsupported(place.call, &format!("the external object `{}`", callee.name));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_read_as_they_are_written() {
        let call = CCall::parse(r#""C" y = f_x(a, size(b, 1), b) annotation(Library="m")"#).expect("a call");
        assert_eq!((call.name.as_str(), call.result), ("f_x", Some(Symbol::new("y"))));
        let name = |n| ExternalArgument::Name(Symbol::new(n));
        assert_eq!(call.arguments, [name("a"), ExternalArgument::Size(Symbol::new("b"), 1), name("b")]);
        let literal = CCall::parse(r#"f("x, y", 2.5, true)"#).expect("a call");
        assert_eq!(
            literal.arguments,
            [ExternalArgument::Text("x, y".into()), ExternalArgument::Number(2.5), ExternalArgument::Number(1.0)]
        );
        assert!(CCall::parse("\"C\"").is_none());
    }
}
