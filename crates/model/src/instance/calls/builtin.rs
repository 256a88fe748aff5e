//! Built-in operators and functions (MLS 3.7, 10.3).

use crate::instance::value::{ModelicaValue, size_text, wider};
use crate::instance::{BuiltinCalls, LookupContext};
use bramah_expr::differentiate::DerivativeLeaf;
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction};
use bramah_syntax::ast::{ComponentReference, Expr, ExprKind, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

/// Mathematical functions of one argument.
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

/// Flow that counts at least, in the unit of the connector's flow, so that what it carries is determined where nothing flows:
/// far below what a solver resolves. A watt of heat needs an enthalpy of 1e10 J/kg to pass with it.
const LEAST_FLOW: f64 = 1e-10;

/// Names that are built in and valid, but not supported.
const UNSUPPORTED: [&str; 8] =
    ["spatialDistribution", "previous", "hold", "subSample", "superSample", "shiftSample", "backSample", "interval"];

/// The arguments that a built-in function takes by name; MLS names them for these alone.
fn named_arguments(name: &str) -> &'static [&'static str] {
    match name {
        "homotopy" => &["actual", "simplified"],
        "String" => &["significantDigits", "minimumLength", "leftJustified", "format"],
        _ => &[],
    }
}

/// How many arguments a built-in function takes by place, where the function itself does not count them.
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
    /// A built-in function; `None` if the name is not one, `Some(None)` after a message.
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
        // `.sin(u)`: a built-in function, unless a class of the top level bears its name
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

    /// The value of a call by the name of its function; `None` if that is not built in.
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
            "smooth" => self.without_events(args.get(1), name, view, span),
            "pre" => {
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

    /// A mathematical function called by its full name, as `Modelica.Math.sin`.
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

    /// `cardinality(c)`: the number of connections of a port (MLS 3.7.4.3).
    fn cardinality(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let node = match args {
            [Expr { kind: ExprKind::Reference(r), .. }] => self.instance.evaluator().named_node(r, view),
            _ => None,
        };
        let Some(node) = node else { return self.instance.fail(Code::BadCall, "`cardinality` takes one port", span) };
        let count = self.instance.connected.get(&node).copied().unwrap_or(0);
        Some(self.instance.evaluator().integer(f64::from(count)))
    }

    fn one(&mut self, name: &str, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        match args {
            [a] => self.instance.evaluator().eval(a, view),
            _ => self.instance.fail(Code::BadCall, &format!("`{name}` takes one argument, not {}", args.len()), span),
        }
    }

    fn two(
        &mut self,
        name: &str,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<(ModelicaValue, ModelicaValue)> {
        match args {
            [a, b] => {
                let (a, b) = (self.instance.evaluator().eval(a, view), self.instance.evaluator().eval(b, view));
                Some((a?, b?))
            }
            _ => self.instance.fail(Code::BadCall, &format!("`{name}` takes two arguments, not {}", args.len()), span),
        }
    }

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

    fn moment(&mut self, node: ExprNode, span: Span) -> Option<ModelicaValue> {
        if self.instance.eval.mode.constant {
            return self.instance.fail(Code::NotConstant, "this is not known before the run", span);
        }
        Some(ModelicaValue::Scalar(self.instance.exprs.intern(node), ScalarType::Boolean))
    }

    /// `der` of any expression, by the chain rule where it is not a plain variable.
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

    fn der_scalar(&mut self, e: ExprId) -> Option<ExprId> {
        // Variabilities are read before the pool is borrowed for the derivative.
        self.instance.variability(e);
        let mut pool = std::mem::take(&mut self.instance.exprs);
        let result = pool.time_derivative(e, &mut |pool, leaf| match leaf {
            DerivativeLeaf::Var(v) => match self.instance.leaf_variability(v) {
                Variability::Continuous => Some(pool.der(v)),
                Variability::Discrete => None,
                _ => Some(Exprs::ZERO),
            },
            DerivativeLeaf::Der(_) => None,
        });
        self.instance.exprs = pool;
        result.ok()
    }

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

    /// The simple name of the model that runs, and the components from it to the place of the call (MLS 3.7.4.3).
    fn instance_name(&self, view: LookupContext) -> String {
        let model = self.instance.library.class(self.instance.scope(self.instance.root).template.class).name.name;
        match self.instance.scope(view.scope).name.as_str() {
            "" => model.to_string(),
            path => format!("{model}.{path}"),
        }
    }

    /// `inStream(h)`, `actualStream(h)`, `Connections.inflow(h)`.
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
        Some(value.map(&mut |e, _| results.next().unwrap_or(e)))
    }

    /// `delay(expression, time)`; the largest time as a third argument says nothing that a fixed time does not.
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

    /// `semiLinear(x, k+, k-) = if x >= 0 then k+*x else k-*x`
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
        // where nothing flows the slopes of unknowns are equal (MLS 3.7.4.5): a flow far below others says so
        let fixed = [up, down].iter().all(|&e| self.instance.variability(e) <= Variability::Discrete);
        if fixed {
            return Some(ModelicaValue::Scalar(value, ScalarType::Real));
        }
        let (difference, least) = (self.instance.exprs.sub(up, down), self.instance.exprs.num(LEAST_FLOW));
        let exchange = self.instance.exprs.mul(least, difference);
        Some(ModelicaValue::Scalar(self.instance.exprs.add(value, exchange), ScalarType::Real))
    }

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

    /// Whole part of a quotient with the events that Modelica asks for (MLS 3.7.2).
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

    fn rounding(&mut self, name: &str, v: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        if !matches!(v.element_type(), Some(ScalarType::Real | ScalarType::Integer)) {
            return self.instance.evaluator().wrong_type("a number", v, span);
        }
        let value = v.map(&mut |e, _| {
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

    /// Towards zero.
    fn truncated(&mut self, e: ExprId) -> ExprId {
        let turned = self.instance.exprs.neg(e);
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

    /// `sum`, `product`, `min`, `max` over values.
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

    fn array_function(
        &mut self,
        name: &str,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        match name {
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

    /// `ndims(a)`, `size(a)` or `size(a, k)` of sizes that are known.
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

    /// A size: known before the run, or known inside the function being evaluated.
    fn dimension_in(&mut self, e: &'a Expr, view: LookupContext) -> Option<usize> {
        if self.instance.eval.frame == 0 && !self.instance.eval.mode.procedure {
            return self.instance.evaluator().dimension(e, view);
        }
        let (x, _) = self.instance.evaluator().known_number(e, view)?;
        Some(x.max(0.0) as usize)
    }

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

    fn skew(&mut self, v: &ModelicaValue) -> Option<ModelicaValue> {
        let ty = v.element_type()?;
        let s = |i: usize| v.elements()[i].scalar().map_or(Exprs::ZERO, |(e, _)| e);
        let z = Exprs::ZERO;
        let (n0, n1, n2) =
            (self.instance.exprs.neg(s(0)), self.instance.exprs.neg(s(1)), self.instance.exprs.neg(s(2)));
        let entries = [z, n2, s(1), s(2), z, n0, n1, s(0), z];
        Some(ModelicaValue::array(vec![3, 3], entries.into_iter().map(|e| ModelicaValue::Scalar(e, ty)).collect()))
    }

    fn string(&mut self, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let Some(first) = args.first() else {
            return self.instance.fail(Code::BadCall, "`String` needs a value", span);
        };
        match self.instance.evaluator().eval(first, view)? {
            ModelicaValue::Scalar(e, ScalarType::Enumeration(i)) => {
                let known = self.instance.exprs.as_num(e).and_then(|x| {
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

    /// Reports a call of something that is no function.
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

fn transposed(v: &ModelicaValue) -> ModelicaValue {
    let (n, m) = (v.dims()[0], v.dims()[1]);
    ModelicaValue::array(vec![m, n], (0..n * m).map(|i| v.elements()[(i % n) * m + i / n].clone()).collect())
}

/// The same scalars under another type.
pub(in crate::instance) fn retyped(v: &ModelicaValue, ty: ScalarType) -> ModelicaValue {
    match v {
        ModelicaValue::Scalar(e, _) => ModelicaValue::Scalar(*e, ty),
        ModelicaValue::Array { dims, elements } => {
            ModelicaValue::array(dims.clone(), elements.iter().map(|v| retyped(v, ty)).collect())
        }
        other => other.clone(),
    }
}

fn as_integer(v: ModelicaValue) -> ModelicaValue {
    retyped(&v, ScalarType::Integer)
}
