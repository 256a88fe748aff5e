//! Built-in operators and functions (MLS 3.7, 10.3).
//!
//! [`BuiltinCalls`] gets a call by name and returns its value. [`BuiltinCalls::builtin_call`] is the entry.
//! Most functions evaluate their arguments and build an expression in the pool, which folds known numbers.
//! Operators that depend on the run (`der`, `pre`, `sample`, `initial`) are refused where values must be known.

use crate::instance::value::{ModelicaValue, size_text, wider};
use crate::instance::{BuiltinCalls, LookupContext};
use bramah_expr::differentiate::DerivativeLeaf;
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction};
use bramah_syntax::ast::{ComponentReference, Expr, ExprKind, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

/// The mathematical function of one argument with this name (MLS 3.7.3). `None` for any other name.
/// The functions of two arguments and those that raise events are handled in `builtin_value`.
fn mathematical(name: &str) -> Option<UnaryFunction> {
    Some(match name {
        "abs" => UnaryFunction::Abs,
        "sign" => UnaryFunction::Sign,
        "sqrt" => UnaryFunction::Sqrt,
        "exp" => UnaryFunction::Exp,
        "log" => UnaryFunction::Log,
        "log10" => UnaryFunction::Log10,
        "sin" => UnaryFunction::Sin,
        "cos" => UnaryFunction::Cos,
        "tan" => UnaryFunction::Tan,
        "asin" => UnaryFunction::Asin,
        "acos" => UnaryFunction::Acos,
        "atan" => UnaryFunction::Atan,
        "sinh" => UnaryFunction::Sinh,
        "cosh" => UnaryFunction::Cosh,
        "tanh" => UnaryFunction::Tanh,
        _ => return None,
    })
}

/// The flow used in `semiLinear` where there is none, in the unit of the connector's flow.
///
/// It makes the value determined at zero flow. It is far below what a solver resolves.
/// To pass 1 W it would need a specific enthalpy of 1e10 J/kg.
const LEAST_FLOW: f64 = 1e-10;

/// Built-in functions of Modelica that are not supported: `spatialDistribution` and the clocked operators (MLS 16).
const UNSUPPORTED: [&str; 8] =
    ["spatialDistribution", "previous", "hold", "subSample", "superSample", "shiftSample", "backSample", "interval"];

/// The names under which a built-in function takes arguments. Empty for most: they take them by position only.
fn named_arguments(name: &str) -> &'static [&'static str] {
    match name {
        "homotopy" => &["actual", "simplified"],
        "String" => &["significantDigits", "minimumLength", "leftJustified", "format"],
        _ => &[],
    }
}

/// How many positional arguments a built-in function takes.
/// `None` for functions that check the number themselves when they are evaluated.
fn count_of(name: &str) -> Option<std::ops::RangeInclusive<usize>> {
    Some(match name {
        "initial" | "terminal" | "getInstanceName" => 0..=0,
        "noEvent" | "identity" => 1..=1,
        "smooth" => 2..=2,
        "homotopy" => 0..=2,
        "zeros" | "ones" => 1..=usize::MAX,
        "fill" => 2..=usize::MAX,
        _ => return None,
    })
}

impl<'a> BuiltinCalls<'_, 'a, '_> {
    /// The value of a call of a built-in function.
    ///
    /// `None` if there is no built-in function of this name. `Some(None)` after a message.
    /// Names of two parts are only `Connections.isRoot`, `Connections.rooted` and `Connections.inflow`.
    ///
    /// The name and the number of arguments are checked here, the evaluation is done by `builtin_value`.
    /// Named arguments are an error for functions that do not take any.
    /// `function` may be a name with a leading dot.
    /// A function that is valid in Modelica but not supported gives a message that says so.
    pub(in crate::instance) fn builtin_call(
        &mut self,
        function: &'a ComponentReference,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: LookupContext,
        span: Span,
    ) -> Option<Option<ModelicaValue>> {
        if let [package, query] = function.parts.as_slice() {
            return match (package.name.name.as_str(), query.name.name.as_str()) {
                ("Connections", name @ ("isRoot" | "rooted")) => {
                    Some(self.instance.builder().connection_query(name, args, view, span))
                }
                ("Connections", name @ "inflow") => Some(self.stream(name, args, view, span)),
                _ => None,
            };
        }
        if function.parts.len() != 1 {
            return None;
        }
        let first = function.parts[0].name.name;
        // `.sin(u)` is the built-in function, unless a top-level class has that name.
        if function.global && self.instance.library.top(first).is_some() {
            return None;
        }
        let name = first.as_str();
        if UNSUPPORTED.contains(&name) {
            self.instance.unsupported_function(span, name);
            return Some(None);
        }
        if let Some(count) = count_of(name)
            && !count.contains(&args.len())
        {
            let wanted = match (*count.start(), *count.end()) {
                (0, 0) => "no argument".to_string(),
                (1, 1) => "one argument".to_string(),
                (1, usize::MAX) => "one argument or more".to_string(),
                (low, usize::MAX) => format!("{low} arguments or more"),
                (_, high) => format!("{high} arguments"),
            };
            return Some(self.instance.fail(
                Code::BadCall,
                &format!("`{name}` takes {wanted}, not {}", args.len()),
                span,
            ));
        }
        let value = self.builtin_value(function, args, named, view, span)?;
        let takes = named_arguments(name);
        // Checked after the evaluation, whose messages are more precise; the check only finds names that nobody read.
        match named.iter().find(|(n, _)| !takes.contains(&n.name.as_str())) {
            Some((unknown, _)) if value.is_some() => {
                let message = format!("`{name}` has no argument `{}`", unknown.name);
                let d = Diagnostic::new(Code::BadCall, message).at(unknown.span, "not an argument");
                self.instance.report(match takes {
                    [] => d.help(format!("`{name}` takes its arguments by their place")),
                    _ => d.help(format!("by name it takes `{}`", takes.join("`, `"))),
                });
                Some(None)
            }
            _ => Some(value),
        }
    }

    /// The value of a call by the name of its function, without checks of names and numbers of arguments.
    /// `None` if the function is not built in. `Some(None)` after a message.
    ///
    /// Operators with events or memory: `pre`, `edge`, `change`, `sample`, `initial`, `terminal`, `delay`.
    /// Operators on connectors: `inStream`, `actualStream`, `cardinality`.
    /// Functions on arrays, reductions, rounding, and the mathematical functions of one argument.
    /// Each function checks the number of its arguments if that is not done before.
    fn builtin_value(
        &mut self,
        function: &'a ComponentReference,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: LookupContext,
        span: Span,
    ) -> Option<Option<ModelicaValue>> {
        let name = function.parts[0].name.name.as_str();
        Some(match name {
            "der" => self.one(name, args, view, span).and_then(|v| self.der(&v, span)),
            "noEvent" => self.without_events(args.first(), name, view, span),
            // The first argument of `smooth(p, expr)` only tells how smooth `expr` is; it is not needed here.
            "smooth" => self.without_events(args.get(1), name, view, span),
            "pre" => {
                // In an algorithm section `pre(x)` means the variable, not the value that the section has assigned so
                // far.
                let value = self.instance.in_mode(|m| m.before = true, |s| s.builtins().one(name, args, view, span));
                value.and_then(|v| self.pre(&v, span))
            }
            "edge" | "change" => self.one(name, args, view, span).and_then(|v| self.changes(name, &v, span)),
            "initial" => self.moment(ExprNode::Initial, span),
            "terminal" => self.moment(ExprNode::Terminal, span),
            "sample" => self.sample(args, view, span),
            "inStream" | "actualStream" => self.stream(name, args, view, span),
            "getInstanceName" => Some(ModelicaValue::text(self.instance_name(view))),
            "delay" => self.delay(args, view, span),
            "homotopy" => self.homotopy_call(args, named, view, span),
            "semiLinear" => self.semi_linear(args, view, span),
            "size" | "ndims" | "zeros" | "ones" | "fill" | "identity" | "diagonal" | "linspace" | "transpose"
            | "cat" | "outerProduct" | "symmetric" | "cross" | "skew" | "scalar" | "vector" | "matrix" | "array"
            | "promote" => self.array_function(name, args, view, span),
            "sum" | "product" => self.one(name, args, view, span).and_then(|v| {
                let values = v.elements().to_vec();
                self.reduction(function, values, span)
            }),
            "min" | "max" => self.extremum(function, args, view, span),
            "atan2" => {
                self.two(name, args, view, span).and_then(|(a, b)| self.real_pair(BinaryFunction::Atan2, &a, &b, span))
            }
            "div" | "mod" | "rem" => {
                self.two(name, args, view, span).and_then(|(a, b)| self.division(name, &a, &b, span))
            }
            "floor" | "ceil" | "integer" => {
                self.one(name, args, view, span).and_then(|v| self.rounding(name, &v, span))
            }
            "String" => self.string(args, view, span),
            "Integer" => self.one(name, args, view, span).map(|v| v.map(&mut |e, _| e)).map(as_integer),
            "cardinality" => self.cardinality(args, view, span),
            _ => {
                let op = mathematical(name)?;
                self.one(name, args, view, span).and_then(|v| self.mathematics(op, &v, span))
            }
        })
    }

    /// A mathematical function called by the name of a library function, as `Modelica.Math.sin`.
    ///
    /// `name` is the function behind `external "builtin"`. A single named argument, as in `sin(u = x)`, is accepted.
    /// `None` after a message, if the function is not known.
    /// `atan2` has two arguments; every other one is looked up in the table of mathematical functions.
    pub(in crate::instance) fn named_mathematics(
        &mut self,
        name: &str,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let args = match named {
            [(_, only)] if args.is_empty() => std::slice::from_ref(only),
            _ => args,
        };
        if name == "atan2" {
            let (a, b) = self.two(name, args, view, span)?;
            return self.real_pair(BinaryFunction::Atan2, &a, &b, span);
        }
        match mathematical(name) {
            Some(op) => self.one(name, args, view, span).and_then(|v| self.mathematics(op, &v, span)),
            None => {
                self.instance.unsupported(span, &format!("the external function `{name}`"));
                None
            }
        }
    }

    /// `cardinality(c)`: the number of `connect` equations that name the port `c` (MLS 3.7.4.3).
    /// It is 0 while the network is not known yet. `None` after a message.
    fn cardinality(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let node = match args {
            [Expr { kind: ExprKind::Reference(r), .. }] => self.instance.evaluator().named_node(r, view),
            _ => None,
        };
        let Some(node) = node else { return self.instance.fail(Code::BadCall, "`cardinality` takes one port", span) };
        let count = self.instance.connected.get(&node).copied().unwrap_or(0);
        Some(self.instance.evaluator().integer(f64::from(count)))
    }

    /// Evaluates the only argument of a function. `None` after a message, if there is another number of arguments.
    fn one(&mut self, name: &str, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        match args {
            [a] => self.instance.evaluator().eval(a, view),
            _ => self.instance.fail(Code::BadCall, &format!("`{name}` takes one argument, not {}", args.len()), span),
        }
    }

    /// Evaluates both arguments of a function. `None` after a message, if there is another number of arguments.
    /// `name` is the function, for the message.
    fn two(
        &mut self,
        name: &str,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<(ModelicaValue, ModelicaValue)> {
        match args {
            [a, b] => {
                // Both are evaluated before `?`, so that the messages of both appear.
                let (a, b) = (self.instance.evaluator().eval(a, view), self.instance.evaluator().eval(b, view));
                Some((a?, b?))
            }
            _ => self.instance.fail(Code::BadCall, &format!("`{name}` takes two arguments, not {}", args.len()), span),
        }
    }

    /// Evaluates an argument so that its relations raise no events: `noEvent(expr)`, `smooth(p, expr)` (MLS 3.7.5).
    /// `None` after a message, if the argument is missing.
    fn without_events(
        &mut self,
        arg: Option<&'a Expr>,
        name: &str,
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let Some(arg) = arg else {
            return self.instance.fail(Code::BadCall, &format!("`{name}` needs an expression"), span);
        };
        self.instance.in_mode(|m| m.no_event = true, |s| s.evaluator().eval(arg, view))
    }

    /// `initial()` or `terminal()`: a Boolean that is true at the start or the end of the run.
    /// A message where values must be known before the run.
    fn moment(&mut self, node: ExprNode, span: Span) -> Option<ModelicaValue> {
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "this is not known before the run", span);
        }
        Some(ModelicaValue::Scalar(self.instance.exprs.intern(node), ScalarType::Boolean))
    }

    /// `der(v)` of any Real value, element by element (MLS 3.7.4).
    ///
    /// Expressions are differentiated by the chain rule: `der(x * y)` is `der(x) * y + x * der(y)`.
    /// `None` after a message: for other types, and for what changes at events only.
    ///
    /// - The derivative of a continuous variable is a symbol; which variables are states is decided later.
    /// - Parameters and constants have the derivative 0.
    fn der(&mut self, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "a derivative is not known before the run", span);
        }
        if matches!(v.element_type(), Some(ty) if ty != ScalarType::Real) {
            return self.instance.fail(
                Code::TypeMismatch,
                "only a Real has a derivative, and this has no derivative",
                span,
            );
        }
        let mut failed = false;
        let value = v.map(&mut |e, _| match self.der_scalar(e) {
            Some(d) => d,
            None => {
                failed = true;
                e
            }
        });
        if failed {
            return self.instance.fail(Code::TypeMismatch, "this changes at events only and has no derivative", span);
        }
        Some(value.with_type(ScalarType::Real))
    }

    /// The derivative of an expression with respect to time. `None` if it has none.
    /// Second derivatives are not supported: `der(x)` in the expression gives `None`.
    /// Derivatives of discrete variables do not exist, so an expression with one gives `None`.
    fn der_scalar(&mut self, e: ExprId) -> Option<ExprId> {
        // The closure below reads variabilities while the pool is taken out of the instance, so they are computed
        // first.
        self.instance.variability(e);
        let mut pool = std::mem::take(&mut self.instance.exprs);
        let result = pool.time_derivative(e, &mut |pool, leaf| match leaf {
            DerivativeLeaf::Var(v) => match self.instance.leaf_variability(v) {
                Variability::Continuous => Some(pool.der(v)),
                Variability::Discrete => None,
                // Parameters and constants do not change.
                _ => Some(Exprs::ZERO),
            },
            DerivativeLeaf::Der(_) => None,
        });
        self.instance.exprs = pool;
        result.ok()
    }

    /// `pre(v)`: the value before the present event, element by element (MLS 3.7.5).
    /// `None` after a message, unless each element is a variable or a number.
    ///
    /// A number stays as it is. Expressions have no value before the event, because nobody stores them.
    fn pre(&mut self, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        let mut failed = self.instance.eval.mode.constant;
        let value = v.map(&mut |e, _| match self.instance.exprs.node(e) {
            ExprNode::Var(var) => self.instance.exprs.pre(var),
            ExprNode::Num(_) => e,
            _ => {
                failed = true;
                e
            }
        });
        if failed {
            return self.instance.fail(Code::TypeMismatch, "`pre` needs a variable", span);
        }
        Some(value)
    }

    /// `edge(b)` or `change(v)` (MLS 3.7.5): `b and not pre(b)`, or `v <> pre(v)`. `None` after a message.
    /// The result is Boolean. That `edge` gets a Boolean is not checked here.
    fn changes(&mut self, name: &str, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        let before = self.pre(v, span)?;
        let value = if name == "edge" {
            v.zip(&before, &mut |now, pre, _| {
                let was_not = self.instance.exprs.not(pre);
                self.instance.exprs.and(now, was_not)
            })
        } else {
            v.zip(&before, &mut |now, pre, _| self.instance.exprs.rel(RelationalOp::Ne, now, pre))
        };
        value.map(|v| retyped(&v, ScalarType::Boolean))
    }

    /// `sample(start, interval)`: true at `start` and after each `interval` (MLS 3.7.5).
    /// `None` after a message: both must be parameters, and the interval positive.
    /// In expressions with parameters by value it is refused, because it depends on time.
    ///
    /// ```text
    /// when sample(0, 0.1) then ... end when;   // at 0, 0.1, 0.2, ...
    /// ```
    fn sample(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let (start, interval) = self.two("sample", args, view, span)?;
        let (Some((s, _)), Some((i, _))) = (start.scalar(), interval.scalar()) else {
            return self.instance.evaluator().wrong_type("a number", &start, span);
        };
        if self.instance.variability(s).max(self.instance.variability(i)) > Variability::Parameter {
            return self.instance.fail(
                Code::NotConstant,
                "start and interval of `sample` must be known before the run",
                span,
            );
        }
        if self.instance.exprs.as_num(i).is_some_and(|x| x <= 0.0) {
            return self.instance.fail(Code::OutOfRange, "the interval of `sample` must be positive", span);
        }
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "`sample` is not known before the run", span);
        }
        Some(ModelicaValue::Scalar(self.instance.exprs.sample(s, i), ScalarType::Boolean))
    }

    /// `getInstanceName()`: the simple name of the model, followed by the components down to the call (MLS 3.7.4).
    /// In the component `b.c` of `Package.Model` this is `Model.b.c`.
    fn instance_name(&self, view: LookupContext) -> String {
        let model = self.instance.library.class(self.instance.scope(self.instance.root).template.class).name.name;
        match self.instance.scope(view.scope).name.as_str() {
            "" => model.to_string(),
            path => format!("{model}.{path}"),
        }
    }

    /// `inStream(h)`, `actualStream(h)` or `Connections.inflow(h)`, for a stream variable or an array of them (MLS 15).
    /// `None` after a message, if the argument is no stream variable of a connector with a flow variable.
    /// `name` is the function without `Connections.`. An array gives an array of results.
    /// In expressions with parameters by value it is refused: streams depend on the run.
    fn stream(&mut self, name: &str, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let value = self.one(name, args, view, span)?;
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "this is not known before the run", span);
        }
        let mut scalars = Vec::new();
        value.scalars(&mut scalars);
        let mut results = Vec::with_capacity(scalars.len());
        for e in scalars {
            let found = match self.instance.exprs.node(e) {
                ExprNode::Var(v) => self.instance.order.get(v.index()).copied(),
                _ => None,
            };
            let flow = found
                .filter(|i| self.instance.variables[*i as usize].stream)
                .and_then(|i| self.instance.stream_flow(i));
            let (Some(i), Some(flow)) = (found, flow) else {
                return self.instance.fail(
                    Code::BadCall,
                    &format!("`{name}` needs a stream variable of a connector"),
                    span,
                );
            };
            results.push(match name {
                "inStream" => self.instance.mixing().in_stream(i),
                "inflow" => self.instance.mixing().inflow(i, flow),
                _ => self.instance.mixing().actual_stream(i, flow),
            });
        }
        let mut results = results.into_iter();
        // The scalars were collected in the order in which `map` visits them.
        Some(value.map(&mut |e, _| results.next().unwrap_or(e)))
    }

    /// `delay(expr, time)` (MLS 3.7.4): the value of `expr` before `time` seconds.
    ///
    /// The delay must be fixed during the run. A third argument, the longest delay, is then only checked.
    /// `None` after a message.
    ///
    /// The result is Real.
    fn delay(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let ([delayed, time] | [delayed, time, _]) = args else {
            return self.instance.fail(Code::BadCall, "`delay` takes an expression and a time", span);
        };
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "`delay` is not known before the run", span);
        }
        let longest = args
            .get(2)
            .map(|e| self.instance.evaluator().constant(e, view).and_then(|v| v.as_number(&self.instance.exprs)));
        let (delayed, time) =
            (self.instance.evaluator().eval(delayed, view)?, self.instance.evaluator().eval(time, view)?);
        let Some((time, _)) = time.scalar() else { return self.instance.evaluator().wrong_type("a time", &time, span) };
        if self.instance.variability(time) > Variability::Parameter {
            self.instance.unsupported(span, "a `delay` whose time changes during the run");
            return None;
        }
        if let (Some(Some(longest)), Some(t)) = (longest, self.instance.exprs.as_num(time))
            && t > longest
        {
            let message = format!("the time of `delay` is {t} s, and its largest is {longest} s");
            return self.instance.fail(Code::OutOfRange, &message, span);
        }
        if self.instance.exprs.as_num(time).is_some_and(|t| t <= 0.0) {
            return self.instance.fail(Code::OutOfRange, "the time of `delay` must be positive", span);
        }
        Some(delayed.map(&mut |e, _| self.instance.exprs.delay(e, time)).with_type(ScalarType::Real))
    }

    /// `homotopy(actual, simplified)` (MLS 3.7.4.4), with positional or named arguments.
    /// Both must have the same shape. `None` after a message.
    /// The initialization starts with `simplified` and moves to `actual`; in the flat model both are kept.
    fn homotopy_call(
        &mut self,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let by_name = |n: &str| named.iter().find(|(i, _)| i.name == n).map(|(_, e)| e);
        let actual = args.first().or_else(|| by_name("actual"));
        let simplified = args.get(1).or_else(|| by_name("simplified"));
        let (Some(a), Some(s)) = (actual, simplified) else {
            return self.instance.fail(Code::BadCall, "`homotopy` needs `actual` and `simplified`", span);
        };
        let (a, s) = (self.instance.evaluator().eval(a, view)?, self.instance.evaluator().eval(s, view)?);
        let value = a.zip(&s, &mut |x, y, _| self.instance.exprs.homotopy(x, y));
        value.or_else(|| self.instance.operators().sizes_differ(&a, &s, span))
    }

    /// `semiLinear(x, up, down)`: `if x >= 0 then up * x else down * x` (MLS 3.7.4.5). `None` after a message.
    ///
    /// The condition `x >= 0` raises an event unless it is suppressed.
    /// The exchange flow is added only if a slope changes continuously; known slopes need none.
    ///
    /// ```text
    /// H_flow = semiLinear(m_flow, inStream(h), h);
    /// ```
    fn semi_linear(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let values: Option<Vec<ExprId>> = args
            .iter()
            .map(|a| self.instance.evaluator().eval(a, view).and_then(|v| v.scalar()).map(|(e, _)| e))
            .collect();
        let Ok([x, up, down]) = <[ExprId; 3]>::try_from(values?) else {
            return self.instance.fail(Code::BadCall, "`semiLinear` takes three numbers", span);
        };
        let quiet = self.instance.eval.mode.no_event || self.instance.variability(x) <= Variability::Discrete;
        let c = if quiet {
            self.instance.exprs.rel(RelationalOp::Ge, x, Exprs::ZERO)
        } else {
            self.instance.exprs.event_rel(RelationalOp::Ge, x, Exprs::ZERO)
        };
        let (a, b) = (self.instance.exprs.mul(up, x), self.instance.exprs.mul(down, x));
        let value = self.instance.exprs.if_(c, a, b);
        // At zero flow both slopes do not matter, and unknown slopes would stay undetermined. MLS 3.7.4.5 makes them
        // equal then. A tiny exchange flow does that without a special case.
        let fixed = [up, down].iter().all(|&e| self.instance.variability(e) <= Variability::Discrete);
        if fixed {
            return Some(ModelicaValue::Scalar(value, ScalarType::Real));
        }
        let (difference, least) = (self.instance.exprs.sub(up, down), self.instance.exprs.num(LEAST_FLOW));
        let exchange = self.instance.exprs.mul(least, difference);
        Some(ModelicaValue::Scalar(self.instance.exprs.add(value, exchange), ScalarType::Real))
    }

    /// Applies a mathematical function to a number, or to each element of an array.
    /// The result is Real, except that `abs` keeps the type and `sign` gives Integers. `None` after a message.
    /// `abs` and `sign` raise no events here.
    fn mathematics(&mut self, op: UnaryFunction, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        match v.element_type() {
            Some(ScalarType::Real | ScalarType::Integer) => {}
            None if v.elements().is_empty() => {}
            _ => return self.instance.evaluator().wrong_type("a number", v, span),
        }
        let keeps = matches!(op, UnaryFunction::Abs | UnaryFunction::Sign);
        let value = v.map(&mut |e, _| self.instance.exprs.unary(op, e));
        Some(match op {
            UnaryFunction::Sign => retyped(&value, ScalarType::Integer),
            _ if keeps => value,
            _ => value.with_type(ScalarType::Real),
        })
    }

    /// Applies a function of two numbers to two values of equal shape; the result is Real. `None` after a message.
    /// Used for `atan2`.
    fn real_pair(
        &mut self,
        op: BinaryFunction,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        let value = a.zip(b, &mut |x, y, _| self.instance.exprs.binary(op, x, y));
        value.map(|v| v.with_type(ScalarType::Real)).or_else(|| self.instance.operators().sizes_differ(a, b, span))
    }

    /// The largest whole number not above an expression.
    /// If the expression changes continuously, an event is raised when the result changes (MLS 3.7.2).
    fn whole(&mut self, e: ExprId) -> ExprId {
        if self.instance.eval.mode.no_event
            || self.instance.eval.mode.procedure
            || self.instance.variability(e) <= Variability::Discrete
        {
            self.instance.exprs.floor(e)
        } else {
            self.instance.exprs.event_floor(e)
        }
    }

    /// `floor`, `ceil` or `integer` of a number, or of each element of an array. `None` after a message.
    /// `integer` gives Integers. `floor` and `ceil` keep the type of the argument.
    fn rounding(&mut self, name: &str, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        if !matches!(v.element_type(), Some(ScalarType::Real | ScalarType::Integer)) {
            return self.instance.evaluator().wrong_type("a number", v, span);
        }
        let value = v.map(&mut |e, _| {
            // `ceil(x)` is `-floor(-x)`, so that one function handles the events.
            if name == "ceil" {
                let turned = self.instance.exprs.neg(e);
                let floor = self.whole(turned);
                self.instance.exprs.neg(floor)
            } else {
                self.whole(e)
            }
        });
        Some(if name == "integer" { retyped(&value, ScalarType::Integer) } else { value })
    }

    /// `div`, `mod` or `rem` of two values of equal shape (MLS 3.7.2). `None` after a message.
    /// `div` and `rem` round the quotient towards zero, `mod` rounds it down.
    fn division(&mut self, name: &str, a: &ModelicaValue, b: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        let value = a.zip(b, &mut |x, y, _| {
            let quotient = self.instance.exprs.div(x, y);
            let part = if name == "mod" { self.whole(quotient) } else { self.truncated(quotient) };
            if name == "div" {
                return part;
            }
            let taken = self.instance.exprs.mul(part, y);
            self.instance.exprs.sub(x, taken)
        });
        value.or_else(|| self.instance.operators().sizes_differ(a, b, span))
    }

    /// An expression rounded towards zero, as `div` needs it.
    /// For a positive value that is the floor, for a negative one the ceiling.
    fn truncated(&mut self, e: ExprId) -> ExprId {
        let turned = self.instance.exprs.neg(e);
        // Rounding down and rounding up raise events at the same values, so both may stand in the expression.
        let (down, up) = (self.whole(e), self.whole(turned));
        let up = self.instance.exprs.neg(up);
        let quiet = self.instance.eval.mode.no_event
            || self.instance.eval.mode.procedure
            || self.instance.variability(e) <= Variability::Discrete;
        let positive = if quiet {
            self.instance.exprs.rel(RelationalOp::Ge, e, Exprs::ZERO)
        } else {
            self.instance.exprs.event_rel(RelationalOp::Ge, e, Exprs::ZERO)
        };
        self.instance.exprs.if_(positive, down, up)
    }

    /// `min` or `max`: of the elements of one array, or of two values of equal shape (MLS 10.3.4).
    /// `None` after a message.
    /// The function is recognized by its name, which is `min` or `max`.
    fn extremum(
        &mut self,
        function: &'a ComponentReference,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let name = function.parts[0].name.name.as_str();
        match args {
            [a] => {
                let v = self.instance.evaluator().eval(a, view)?;
                let values = v.elements().to_vec();
                self.reduction(function, values, span)
            }
            [a, b] => {
                let (a, b) = (self.instance.evaluator().eval(a, view)?, self.instance.evaluator().eval(b, view)?);
                let op = if name == "min" { BinaryFunction::Min } else { BinaryFunction::Max };
                let value = a.zip(&b, &mut |x, y, _| self.instance.exprs.binary(op, x, y));
                value.or_else(|| self.instance.operators().sizes_differ(&a, &b, span))
            }
            _ => self.instance.fail(Code::BadCall, &format!("`{name}` takes one array or two numbers"), span),
        }
    }

    /// Combines values by `sum`, `product`, `min` or `max`; also `array`, which stacks them (MLS 10.3.4).
    ///
    /// Without values the result is the neutral element: 0, 1, and the largest or smallest Real number.
    /// `None` after a message, if the shapes differ or the function is no reduction.
    ///
    /// `values` are the elements of the array, or the values of a comprehension, in order.
    /// Elements may be arrays themselves, which are then combined element by element.
    /// The result has the wider type of the values.
    /// Shapes must be equal for all values.
    pub(in crate::instance) fn reduction(
        &mut self,
        function: &'a ComponentReference,
        values: Vec<ModelicaValue>,
        span: Span,
    ) -> Option<ModelicaValue> {
        let name = function.parts[0].name.name.as_str();
        let op = match name {
            "sum" => BinaryFunction::Add,
            "product" => BinaryFunction::Mul,
            "min" => BinaryFunction::Min,
            "max" => BinaryFunction::Max,
            "array" => return self.instance.evaluator().stacked(values, span),
            _ => {
                let message = format!("`{name}` cannot run over iterators; `sum`, `product`, `min` and `max` can");
                return self.instance.fail(Code::UnknownFunction, &message, span);
            }
        };
        let Some(mut result) = values.first().cloned() else {
            return Some(ModelicaValue::Scalar(
                match op {
                    BinaryFunction::Add => Exprs::ZERO,
                    BinaryFunction::Mul => Exprs::ONE,
                    BinaryFunction::Min => self.instance.exprs.num(f64::MAX),
                    _ => self.instance.exprs.num(-f64::MAX),
                },
                ScalarType::Real,
            ));
        };
        for v in &values[1..] {
            match result.zip(v, &mut |x, y, _| self.instance.exprs.binary(op, x, y)) {
                Some(next) => result = next,
                None => return self.instance.operators().sizes_differ(&result, v, span),
            }
        }
        Some(result)
    }

    /// The functions of arrays (MLS 10.3): `size`, `zeros`, `fill`, `cat`, `transpose` and so on.
    ///
    /// `None` after a message, if number, shapes or values of the arguments do not fit the function.
    ///
    /// `size` and `ndims` of a component use its declared sizes, so that the value need not be known.
    /// The matrix functions check the number of dimensions; others report arguments that do not fit.
    ///
    /// `name` is the function. `array` is `{...}` as a function, and `promote` is used inside of the language
    /// definition.
    /// Arguments are evaluated in order, and each function takes them by position.
    fn array_function(
        &mut self,
        name: &str,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        match name {
            // These take sizes only, which must be known; in functions they may depend on known arguments.
            "zeros" | "ones" | "identity" => {
                let dims: Option<Vec<usize>> = args.iter().map(|a| self.dimension_in(a, view)).collect();
                let dims = dims?;
                if name == "identity" {
                    return Some(self.instance.operators().identity(dims.first().copied().unwrap_or(0)));
                }
                let e = if name == "zeros" { Exprs::ZERO } else { Exprs::ONE };
                let count = dims.iter().product();
                return Some(ModelicaValue::array(dims, vec![ModelicaValue::Scalar(e, ScalarType::Integer); count]));
            }
            "fill" => {
                let (first, rest) = args.split_first()?;
                let value = self.instance.evaluator().eval(first, view)?;
                let dims: Option<Vec<usize>> = rest.iter().map(|a| self.dimension_in(a, view)).collect();
                let dims = dims?;
                let count: usize = dims.iter().product();
                let all: Vec<usize> = dims.iter().chain(value.dims()).copied().collect();
                let elements = (0..count).flat_map(|_| value.elements().to_vec()).collect();
                return Some(ModelicaValue::array(all, elements));
            }
            _ => {}
        }
        // Sizes of components are known without their values, so the argument need not be evaluated.
        if let ("size" | "ndims", Some(of)) = (name, args.first())
            && let Some(dims) = self.instance.evaluator().declared_dims(of, view)
        {
            return self.sizes(name, &dims, args.get(1), view, span);
        }
        let values: Option<Vec<ModelicaValue>> = args.iter().map(|a| self.instance.evaluator().eval(a, view)).collect();
        let values = values?;
        let Some(first) = values.first() else {
            return self.instance.fail(Code::BadCall, &format!("`{name}` needs an argument"), span);
        };
        match (name, values.len()) {
            ("array", _) => self.instance.evaluator().stacked(values, span),
            ("ndims", 1) | ("size", 1 | 2) => self.sizes(name, first.dims(), args.get(1), view, span),
            ("scalar", 1) if first.elements().len() == 1 => Some(first.elements()[0].clone()),
            ("vector", 1) => Some(ModelicaValue::array(vec![first.elements().len()], first.elements().to_vec())),
            ("matrix", 1) => self.promote(first, 2, span),
            ("promote", 2) => {
                let n = values[1].as_number(&self.instance.exprs).unwrap_or(0.0) as usize;
                self.promote(first, n, span)
            }
            ("linspace", 3) => {
                let count = self.dimension_in(&args[2], view)?;
                self.linspace(&values, Some(count as f64), span)
            }
            ("cat", _) => {
                let k = first.as_number(&self.instance.exprs).unwrap_or(0.0) as usize;
                self.instance.evaluator().concatenate(k, values[1..].to_vec(), span)
            }
            ("transpose", 1) if first.dims().len() == 2 => Some(transposed(first)),
            // `symmetric(A)` copies the upper triangle to the lower one.
            ("symmetric", 1) if first.dims().len() == 2 => {
                let n = first.dims()[1];
                let t = transposed(first);
                let pick =
                    |i: usize| if i % n >= i / n { first.elements()[i].clone() } else { t.elements()[i].clone() };
                Some(ModelicaValue::array(first.dims().to_vec(), (0..n * n).map(pick).collect()))
            }
            ("diagonal", 1) if first.dims().len() == 1 => {
                let n = first.dims()[0];
                let zero = ModelicaValue::Scalar(Exprs::ZERO, first.element_type().unwrap_or(ScalarType::Real));
                let entry = |i: usize| {
                    if i.is_multiple_of(n + 1) { first.elements()[i / (n + 1)].clone() } else { zero.clone() }
                };
                Some(ModelicaValue::array(vec![n, n], (0..n * n).map(entry).collect()))
            }
            ("outerProduct", 2) => {
                let (n, m) = (first.elements().len(), values[1].elements().len());
                let mut elements = Vec::with_capacity(n * m);
                for a in first.elements() {
                    for b in values[1].elements() {
                        let product = a.zip(b, &mut |x, y, _| self.instance.exprs.mul(x, y));
                        elements.push(product.or_else(|| self.instance.operators().sizes_differ(a, b, span))?);
                    }
                }
                Some(ModelicaValue::array(vec![n, m], elements))
            }
            ("cross", 2) if first.dims() == [3] && values[1].dims() == [3] => self.cross(first, &values[1]),
            ("skew", 1) if first.dims() == [3] => self.skew(first),
            _ => self.instance.fail(Code::BadCall, &format!("these arguments do not fit `{name}`"), span),
        }
    }

    /// `ndims(a)`, `size(a)` or `size(a, k)` for an array with the sizes `dims` (MLS 10.3.1). `None` after a message.
    ///
    /// Without a dimension `k` the result is the vector of all sizes. `along` is the expression for `k`, which must be
    /// known.
    fn sizes(
        &mut self,
        name: &str,
        dims: &[usize],
        along: Option<&'a Expr>,
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        if name == "ndims" {
            return Some(self.instance.evaluator().integer(dims.len() as f64));
        }
        let Some(along) = along else {
            let elements = dims.iter().map(|&n| self.instance.evaluator().integer(n as f64)).collect();
            return Some(ModelicaValue::array(vec![dims.len()], elements));
        };
        let k = self.instance.evaluator().eval(along, view)?.as_number(&self.instance.exprs).unwrap_or(0.0);
        match dims.get((k as usize).wrapping_sub(1)) {
            Some(&n) => Some(self.instance.evaluator().integer(n as f64)),
            None => {
                let what = if dims.is_empty() {
                    "a single value".into()
                } else {
                    format!("an array of size {}", size_text(dims))
                };
                self.instance.fail(Code::BadIndex, &format!("{what} has no dimension {k}"), span)
            }
        }
    }

    /// A size as argument. Outside of functions it must be known before the run.
    /// Inside a function it must be known from the arguments, otherwise `not_inline` is set. Negative sizes count as 0.
    fn dimension_in(&mut self, e: &'a Expr, view: LookupContext) -> Option<usize> {
        if self.instance.eval.frame == 0 && !self.instance.eval.mode.procedure {
            return self.instance.evaluator().dimension(e, view);
        }
        let (x, _) = self.instance.evaluator().known_number(e, view)?;
        Some(x.max(0.0) as usize)
    }

    /// A value as an array with `n` dimensions: sizes of 1 are appended (`promote`, `matrix`; MLS 10.3.2).
    /// `matrix` also drops sizes of 1 if there are more than two dimensions. `None` after a message.
    /// `promote(A, n)` adds dimensions at the end. Its values stay in row-major order.
    fn promote(&mut self, v: &ModelicaValue, n: usize, span: Span) -> Option<ModelicaValue> {
        let mut dims = v.dims().to_vec();
        if n == 2 && dims.len() > 2 {
            dims.retain(|&d| d != 1);
        }
        while dims.len() < n {
            dims.push(1);
        }
        if dims.iter().product::<usize>() != v.elements().len() || dims.len() != n {
            return self.instance.fail(Code::SizeMismatch, &format!("{} has too many dimensions", v.describe()), span);
        }
        Some(ModelicaValue::array(dims, v.elements().to_vec()))
    }

    /// `linspace(from, to, n)`: `n` Reals at equal distances, both ends included (MLS 10.3.3).
    /// `None` after a message, if `n` is below 2.
    /// The third argument must be known. The limits may be symbolic.
    fn linspace(&mut self, values: &[ModelicaValue], count: Option<f64>, span: Span) -> Option<ModelicaValue> {
        let n = count.filter(|n| *n >= 2.0);
        let (Some((a, _)), Some((b, _)), Some(n)) = (values[0].scalar(), values[1].scalar(), n) else {
            return self.instance.fail(
                Code::BadCall,
                "`linspace(from, to, n)` needs two numbers and n of at least 2",
                span,
            );
        };
        let n = n as usize;
        let distance = self.instance.exprs.sub(b, a);
        let elements = (0..n)
            .map(|i| {
                let share = self.instance.exprs.num(i as f64 / (n - 1) as f64);
                let part = self.instance.exprs.mul(distance, share);
                ModelicaValue::Scalar(self.instance.exprs.add(a, part), ScalarType::Real)
            })
            .collect();
        Some(ModelicaValue::array(vec![n], elements))
    }

    /// `cross(a, b)`: the cross product of two vectors of size 3. The caller has checked the sizes.
    /// `None` if the types do not fit.
    fn cross(&mut self, a: &ModelicaValue, b: &ModelicaValue) -> Option<ModelicaValue> {
        let s = |v: &ModelicaValue, i: usize| v.elements()[i].scalar().map_or(Exprs::ZERO, |(e, _)| e);
        let ty = wider(a.element_type()?, b.element_type()?)?;
        let mut elements = Vec::new();
        for (i, j) in [(1, 2), (2, 0), (0, 1)] {
            let p = self.instance.exprs.mul(s(a, i), s(b, j));
            let q = self.instance.exprs.mul(s(a, j), s(b, i));
            elements.push(ModelicaValue::Scalar(self.instance.exprs.sub(p, q), ty));
        }
        Some(ModelicaValue::array(vec![3], elements))
    }

    /// `skew(x)`: the 3 by 3 matrix with `skew(x) * y = cross(x, y)`. The caller has checked the size.
    /// Its entries are those of the vector, with signs.
    fn skew(&mut self, v: &ModelicaValue) -> Option<ModelicaValue> {
        let ty = v.element_type()?;
        let s = |i: usize| v.elements()[i].scalar().map_or(Exprs::ZERO, |(e, _)| e);
        let z = Exprs::ZERO;
        let (n0, n1, n2) =
            (self.instance.exprs.neg(s(0)), self.instance.exprs.neg(s(1)), self.instance.exprs.neg(s(2)));
        let entries = [z, n2, s(1), s(2), z, n0, n1, s(0), z];
        Some(ModelicaValue::array(vec![3, 3], entries.into_iter().map(|e| ModelicaValue::Scalar(e, ty)).collect()))
    }

    /// `String(v)`: the text of a value (MLS 3.7.1). Values that are not known become parts to be inserted later.
    /// Formats and minimum lengths are accepted and not applied. `None` after a message.
    /// Further arguments, such as `significantDigits`, do not change the result.
    /// A String stays as it is. Arrays and records are errors.
    fn string(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let Some(first) = args.first() else {
            return self.instance.fail(Code::BadCall, "`String` needs a value", span);
        };
        match self.instance.evaluator().eval(first, view)? {
            ModelicaValue::Scalar(e, ScalarType::Enumeration(i)) => {
                let known = self.instance.exprs.as_num(e).and_then(|x| {
                    // An enumeration value is shown by the name of its literal.
                    self.instance.enumerations[i as usize].literals.get(x as usize - 1).map(|l| l.as_str())
                });
                Some(match known {
                    Some(name) => ModelicaValue::text(name),
                    None => ModelicaValue::Text(Rc::new(vec![MessagePart::Value(e, ScalarType::Enumeration(i))])),
                })
            }
            ModelicaValue::Scalar(e, ty) => Some(ModelicaValue::Text(Rc::new(vec![MessagePart::Value(e, ty)]))),
            other @ ModelicaValue::Text(_) => Some(other),
            other => self.instance.evaluator().wrong_type("a single value", &other, span),
        }
    }

    /// Reports a call of something that is no function, with the most similar built-in function as a suggestion.
    /// `pow` gets a hint of its own, because programmers look for it.
    pub(in crate::instance) fn unknown_function(&mut self, function: &ComponentReference) {
        let name: Vec<&str> = function.parts.iter().map(|p| p.name.name.as_str()).collect();
        let name = name.join(".");
        const KNOWN: [&str; 40] = [
            "der", "abs", "sign", "sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "atan2",
            "sinh", "cosh", "tanh", "min", "max", "sum", "product", "floor", "ceil", "integer", "div", "mod", "rem",
            "size", "zeros", "ones", "fill", "linspace", "noEvent", "smooth", "pre", "edge", "change", "sample",
            "homotopy", "initial",
        ];
        let mut d = Diagnostic::new(
            Code::UnknownFunction,
            format!("there is no function `{}`", crate::instance::errors::short(&name)),
        )
        .at(function.span, "not found");
        if name == "pow" {
            d = d.help("write `x^y`");
        } else if let Some(near) = crate::instance::errors::nearest(&name, KNOWN) {
            d = d.meant(near);
        }
        self.instance.report(d);
    }
}

/// The transposed matrix.
fn transposed(v: &ModelicaValue) -> ModelicaValue {
    let (n, m) = (v.dims()[0], v.dims()[1]);
    ModelicaValue::array(vec![m, n], (0..n * m).map(|i| v.elements()[(i % n) * m + i / n].clone()).collect())
}

/// The same scalars as values of another type. Strings and records stay as they are.
/// It is used where the meaning changes but not the number, as for a Boolean stored as 0 or 1.
pub(in crate::instance) fn retyped(v: &ModelicaValue, ty: ScalarType) -> ModelicaValue {
    match v {
        ModelicaValue::Scalar(e, _) => ModelicaValue::Scalar(*e, ty),
        ModelicaValue::Array { dims, elements } => {
            ModelicaValue::array(dims.clone(), elements.iter().map(|v| retyped(v, ty)).collect())
        }
        other => other.clone(),
    }
}

/// The same scalars as Integers, for `Integer(e)`, which gives the number of an enumeration literal.
fn as_integer(v: ModelicaValue) -> ModelicaValue {
    retyped(&v, ScalarType::Integer)
}
