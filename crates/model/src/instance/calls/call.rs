//! Calls of functions: built-in functions, record constructors, user functions.
//!
//! [`FunctionCalls`] gets the syntax of a call and returns its value.
//! A user function is evaluated to an expression if its loops and conditions are known or can be merged.
//! Otherwise it becomes a procedure. Calls with known arguments are just computed.

use crate::instance::algorithm::StatementFlow;
use crate::instance::builtin::retyped;
use crate::instance::calls::binding::is_input;
use crate::instance::calls::locals::in_order_of_use;
use crate::instance::evaluation::state::{EvaluationMode, StatementBudget};
use crate::instance::files::FileReference;
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::template::{Template, TemplateElementKind};
use crate::instance::value::ModelicaValue;
use crate::instance::vectorised::CallArguments;
use crate::instance::{ClassRef, FunctionCalls, LookupContext, ScopeId};
use bramah_expr::ExprId;
use bramah_expr::types::{ScalarType, Variability};
use bramah_syntax::ast::{self, CausalityPrefix, ClassKind, ComponentReference, Expr, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// The deepest nesting of calls with symbolic arguments.
const DEEPEST_INLINE: usize = 40;
/// The most statements executed for one call with symbolic arguments.
const MOST_STEPS: usize = 20_000;
/// The most statements executed for one call with known arguments.
const MOST_KNOWN_STEPS: usize = 2_000_000;
/// The deepest nesting of calls with known arguments.
const DEEPEST_KNOWN: usize = 150;

/// A function ready to be called.
pub(in crate::instance) struct Callee<'a> {
    /// The scope of its body, in which its names are looked up.
    pub scope: ScopeId,
    /// Its elements and bases.
    pub template: Rc<Template<'a>>,
    /// Its full name, for messages and keys.
    pub name: String,
}

/// One input, output or protected variable of a function.
pub(in crate::instance) struct FormalParameter<'a> {
    /// Its name.
    pub name: Symbol,
    /// Its declaration.
    pub component: &'a ast::ComponentDeclaration,
    /// Its index in the template of the function.
    pub index: u32,
    /// Where the names of its declaration are looked up.
    pub view: LookupContext,
}

impl<'a> FunctionCalls<'_, 'a, '_> {
    /// The value of a call. `None` after a message.
    ///
    /// `function` is looked up as an input that is a function, then as a built-in function, a class, an enumeration
    /// conversion, and a function in a component.
    ///
    /// Positional and named arguments are not evaluated yet, because some built-in functions take references or
    /// evaluate their arguments in another mode.
    pub(in crate::instance) fn call(
        &mut self,
        function: &'a ComponentReference,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        if let Some((class, bound)) = self.functional_input(function) {
            return self.call_bound(class, args, named, &bound, view, span);
        }
        if !self.is_redefined(function, view)
            && let Some(v) = self.instance.builtins().builtin_call(function, args, named, view, span)
        {
            return v;
        }
        let path = ast::Path {
            global: function.global,
            parts: function.parts.iter().map(|p| p.name).collect(),
            span: function.span,
        };
        match self.instance.names().lookup_path(view, &path) {
            Ok(LookupResult::Class(class)) => self.call_bound(class, args, named, &[], view, span),
            Ok(LookupResult::Builtin(BuiltinType::Enumeration(i))) => self.enumeration_of(i, args, view, span),
            _ => match self.instance_function(function, view) {
                Some(class) => self.call_class(class, args, named, &[], view, span),
                None => {
                    self.instance.builtins().unknown_function(function);
                    None
                }
            },
        }
    }

    /// Whether a class visible at `view` has the name of a built-in function, as after `import
    /// Modelica.ComplexMath.abs`. It is nearer than the built-in function (MLS 5.3.1).
    fn is_redefined(&mut self, function: &ComponentReference, view: LookupContext) -> bool {
        let [part] = function.parts.as_slice() else { return false };
        !function.global
            && matches!(self.instance.names().lookup_nested(view, part.name.name), Some(LookupResult::Class(_)))
    }

    /// Calls a function. `bound` are inputs given before by partial application. `None` after a message.
    ///
    /// A library function that stands for a built-in one, as `Modelica.Math.sin`, is evaluated as that.
    fn call_bound(
        &mut self,
        class: ClassRef<'a>,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        bound: &[(Ident, ModelicaValue)],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        match self.external_builtin(&class) {
            Some(name) => self.instance.builtins().named_mathematics(&name, args, named, view, span),
            None => self.call_class(class, args, named, bound, view, span),
        }
    }

    /// The built-in function that a library function stands for: `sin` for `external "builtin" y = sin(u)`.
    fn external_builtin(&self, class: &ClassRef<'a>) -> Option<String> {
        let ast::ClassBody::Long(body) = &self.instance.library.class(class.class).body else { return None };
        let called = body.external_text.as_deref()?.trim_start().strip_prefix("\"builtin\"")?;
        let called = called.split_once('=').map_or(called, |(_, right)| right);
        Some(called.split('(').next()?.trim().to_string())
    }

    /// A function named through a component, as in `oil.density(p)`. `None`, without a message, if there is none.
    ///
    /// ```text
    /// oil.density(p)          // a function in the class of the component oil
    /// oil.Medium.density(p)   // a function in a package inside
    /// ```
    fn instance_function(&mut self, function: &ComponentReference, view: LookupContext) -> Option<ClassRef<'a>> {
        let LookupResult::Component(scope, index) = self.instance.names().lookup(view, function.parts[0].name.name)?
        else {
            return None;
        };
        let mut node = self.instance.builder().component(scope, index)?;
        let (last, middle) = function.parts[1..].split_last()?;
        for (k, part) in middle.iter().enumerate() {
            let crate::instance::InstanceNode::Object(s) = *self.instance.node(node) else { return None };
            let &i = self.instance.scope(s).template.by_name.get(&part.name.name)?;
            // From the first class on, the rest of the name is looked up in classes.
            if matches!(self.instance.scope(s).template.elements[i as usize].kind, TemplateElementKind::Class(_)) {
                let mut found = self.instance.names().lookup(LookupContext { scope: s, base: 0 }, part.name.name)?;
                for next in middle[k + 1..].iter().chain([last]) {
                    found = self.instance.names().member(&found, next.name.name)?;
                }
                let LookupResult::Class(class) = found else { return None };
                return Some(class);
            }
            node = self.instance.builder().component(s, i)?;
        }
        let crate::instance::InstanceNode::Object(s) = *self.instance.node(node) else { return None };
        match self.instance.names().lookup(LookupContext { scope: s, base: 0 }, last.name.name)? {
            LookupResult::Class(class) => Some(class),
            _ => None,
        }
    }

    /// Evaluates the arguments, and calls a function or a constructor. `None` after a message.
    ///
    /// - An enumeration type converts an Integer.
    /// - Record classes and external objects are constructed, operator records by their own constructors if one fits.
    /// - Functions are called, element by element if arguments are arrays of what the inputs are.
    ///
    /// Other classes are reported.
    /// Arguments that are bound already take the places of their inputs; positional ones fill the others.
    /// Arguments that cannot be evaluated end the call; their messages are enough.
    fn call_class(
        &mut self,
        class: ClassRef<'a>,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        bound: &[(Ident, ModelicaValue)],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let template = self.instance.names().template(class.class, class.parent);
        if let Some(BuiltinType::Enumeration(i)) = template.builtin {
            return self.enumeration_of(i, args, view, span);
        }
        // A function without outputs is called for its assertions, whose texts need values as well.
        let text = gives_text(&template) || gives_nothing(&template);
        let positional: Option<Vec<ModelicaValue>> = args.iter().map(|a| self.argument(a, text, view)).collect();
        let mut by_name = Vec::new();
        for (name, e) in named {
            by_name.push((*name, self.argument(e, text, view)?));
        }
        let mut positional = positional?;
        if !bound.is_empty() {
            let inputs = template
                .elements
                .iter()
                .filter(|e| matches!(e.kind, TemplateElementKind::Component(c) if is_input(c, e.protected)));
            // Positional arguments fill the inputs that partial application has left open (MLS 12.4.2.1).
            let open: Vec<Ident> = inputs
                .filter(|e| bound.iter().all(|(n, _)| n.name != e.name))
                .map(|e| Ident { name: e.name, span })
                .collect();
            if positional.len() <= open.len() {
                by_name.extend(open.into_iter().zip(std::mem::take(&mut positional)));
            }
        }
        by_name.extend_from_slice(bound);
        if template.builtin == Some(BuiltinType::Object) {
            let place = FileReference { call: span, given: None };
            return self.instance.externals().construct_object(
                &class,
                CallArguments { positional, named: by_name },
                place,
            );
        }
        if matches!(template.kind, ClassKind::Record { operator: true }) {
            let given = CallArguments { positional: positional.clone(), named: by_name.clone() };
            if let Some(made) = self.instance.operators().overloaded_constructor(&class, &given, span) {
                return made;
            }
        }
        let scope = self.instance.names().package(&class);
        let name = self.instance.library.full_name(class.class);
        let callee = Callee { scope, template, name };
        match callee.template.kind {
            ClassKind::Record { .. } => self.construct(&callee, positional, by_name, span),
            ClassKind::Function { .. } => match self.instance.externals().file_function(&callee) {
                Some(function) => {
                    let place = self.instance.externals().file_place(args.first(), view, span);
                    self.instance.externals().call_file_function(function, &callee, positional, by_name, place)
                }
                None => self.call_elementwise(&callee, CallArguments { positional, named: by_name }, span),
            },
            _ => {
                let message = format!("`{}` is not a function", callee.name);
                self.instance.fail(Code::UnknownFunction, &message, span)
            }
        }
    }

    /// Evaluates an argument. `None` after a message.
    ///
    /// Integer parameters are taken by value, because sizes and loops of the function may depend on them.
    /// If the function returns a String (`text`), every parameter is: Strings are not part of the run.
    ///
    /// Inside of functions arguments are values already, so only calls outside of functions are concerned.
    /// Parameters that get their value at initialization stay symbolic, except for Strings.
    fn argument(&mut self, e: &'a Expr, text: bool, view: LookupContext) -> Option<ModelicaValue> {
        let value = self.instance.evaluator().eval(e, view)?;
        if text && !value.dims().is_empty() && self.instance.eval.frame == 0 && !self.instance.eval.mode.procedure {
            let mut scalars = Vec::new();
            value.scalars(&mut scalars);
            let fixed = scalars.iter().all(|e| self.instance.variability(*e) <= Variability::Parameter);
            if fixed && !self.all_known(std::slice::from_ref(&value)) {
                return self.instance.evaluator().constant(e, view);
            }
        }
        if let ModelicaValue::Scalar(id, ty) = value
            && (text || ty == ScalarType::Integer)
        {
            let outside = self.instance.eval.frame == 0 && !self.instance.eval.mode.procedure;
            let open =
                self.instance.exprs.as_num(id).is_none() && self.instance.variability(id) <= Variability::Parameter;
            if outside
                && open
                && (text || !self.instance.found_at_start(id))
                // A local keeps its symbolic value: evaluating it again would not give a number.
                && !self.instance.eval.locals.iter().any(|(_, v)| v.scalar().is_some_and(|(l, _)| l == id))
            {
                return self.instance.evaluator().constant(e, view);
            }
        }
        Some(value)
    }

    /// `Color(i)`: the conversion of an Integer to an enumeration value. `None` after a message.
    fn enumeration_of(&mut self, i: u32, args: &'a [Expr], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let [arg] = args else {
            return self.instance.fail(Code::BadCall, "a conversion to an enumeration takes one Integer", span);
        };
        Some(retyped(&self.instance.evaluator().eval(arg, view)?, ScalarType::Enumeration(i)))
    }

    /// The record that the constructor of a record class makes of its arguments (MLS 12.6).
    /// The fields are in declaration order; constants are no inputs of the constructor. `None` after a message.
    ///
    /// Inputs of the constructor are the public fields. Fields that are not given take their declared values.
    pub(in crate::instance) fn construct(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        let formals = self.formals(callee, |c, protected| {
            !protected && !matches!(c.prefix.variability, Some(ast::VariabilityPrefix::Constant))
        });
        let fields = self.instance.in_frame(|s| {
            s.calls().bind(callee, &formals, positional, named, span)?;
            let value = |f: &FormalParameter<'a>| Some((f.name, s.eval.locals[s.local(f.name)?].1.clone()));
            formals.iter().map(value).collect::<Option<Vec<_>>>()
        })?;
        let class = self.instance.operators().operator_class_of(&callee.template);
        Some(ModelicaValue::Record(Rc::new(crate::instance::value::RecordValue { fields, class })))
    }

    /// Calls a function with evaluated arguments. `None` after a message, or with `not_inline` set.
    ///
    /// External functions go to `external` or `c`. Others are evaluated to expressions first.
    /// If that is not possible, and an argument is symbolic, the function becomes a procedure.
    ///
    /// Limits for statements and nesting stop functions that do not end. They are higher if all arguments are known,
    /// because such a call is only computed.
    /// Messages of an attempt that failed are dropped if a procedure is made instead.
    /// `span` is the call. Arguments are bound to inputs when the body is evaluated.
    ///
    /// Functions that are known in Rust come first, then those in C, then those written in Modelica.
    pub(in crate::instance) fn call_function(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        if let Some(how) = self.instance.externals().external_builtin_of(callee) {
            return self.instance.externals().call_external(
                how,
                callee,
                positional,
                named,
                FileReference { call: span, given: None },
            );
        }
        if callee.template.bases[0].ast.prefixes.partial {
            let message = format!("`{}` is partial and cannot be called", callee.name);
            return self.instance.fail(Code::Partial, &message, span);
        }
        if callee.template.bases.iter().any(|b| has_external(b.ast)) {
            // Only with the feature `fmi` can C code be compiled and called.
            #[cfg(feature = "fmi")]
            return self.instance.externals().call_c(callee, positional, named, span);
            #[cfg(not(feature = "fmi"))]
            {
                self.instance.unsupported(span, &format!("the external function `{}`", callee.name));
                return None;
            }
        }
        let known = self.all_known(&positional) && named.iter().all(|(_, v)| self.known(v));
        if !self.well_formed(callee) {
            return None;
        }
        let limit = if known { DEEPEST_KNOWN } else { DEEPEST_INLINE };
        // Without known arguments the recursion may well end at run time, which a procedure can do.
        if self.instance.eval.depth >= limit {
            if known {
                let message = format!("`{}` calls itself without end", callee.name);
                let d = Diagnostic::new(Code::Recursion, message).at(span, "this call");
                if !self.instance.diagnostics.iter().any(|d| d.code == Code::Recursion) {
                    self.instance
                        .report(d.help("a recursive function must reach a case in which it does not call itself"));
                }
                return None;
            }
            self.instance.eval.not_inline = true;
            return None;
        }
        // If the attempt fails, the assertions that it left are removed again.
        let calls = self.instance.eval.calls.len();
        let work = self.instance.eval.work;
        // The outermost call sets the budget for all calls inside of it.
        if self.instance.eval.depth == 0 {
            self.instance.eval.work = StatementBudget::allowed([MOST_STEPS, MOST_KNOWN_STEPS]);
        }
        self.instance.eval.work.known = known;
        self.instance.eval.depth += 1;
        let outer = std::mem::replace(&mut self.instance.eval.not_inline, false);
        let (value, messages) =
            self.instance.attempt(|i| i.calls().inline(callee, positional.clone(), named.clone(), span));
        self.instance.eval.depth -= 1;
        if self.instance.eval.depth == 0 {
            self.instance.eval.work = work;
        }
        self.instance.eval.work.known = work.known;
        let refused = std::mem::replace(&mut self.instance.eval.not_inline, outer);
        if value.is_some() || !refused {
            self.instance.diagnostics.extend(messages);
            return value;
        }
        // Known arguments leave nothing open: only the budget of statements can have stopped it.
        if known && !std::mem::take(&mut self.instance.eval.may_fail) {
            self.instance.diagnostics.extend(messages);
            let message = format!("`{}` does not come to an end", callee.name);
            return self.instance.fail(Code::Recursion, &message, span);
        }
        self.instance.eval.calls.truncate(calls);
        if gives_nothing(&callee.template) {
            return self.call_for_effect(callee, positional, named, span);
        }
        self.instance.procedures().call_procedure(callee, positional, named, span)
    }

    /// Calls a function without outputs whose assertions depend on values that change. `None` as above.
    ///
    /// In a procedure, the body becomes part of that procedure. In a function, the function must become a procedure.
    /// In a model such a call is not supported.
    fn call_for_effect(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        if self.instance.eval.mode.procedure {
            return self.instance.procedures().procedure_body(callee, positional, named, span);
        }
        if self.instance.eval.depth > 0 {
            (self.instance.eval.not_inline, self.instance.eval.may_fail) = (true, true);
            return None;
        }
        let what = format!("a call of `{}`, which has no output, with arguments that change,", callee.name);
        self.instance.unsupported(span, &what);
        None
    }

    /// Whether a function contains only what functions may contain (MLS 12.2). Reports a message otherwise.
    /// Equations are not allowed, and inputs cannot be assigned.
    /// Functions that passed are remembered. A function that did not is checked again and reported once.
    /// A `when` or other statements that functions may not have are reported where they are executed.
    /// The places in base classes are checked as well.
    fn well_formed(&mut self, callee: &Callee<'a>) -> bool {
        let class = callee.template.class;
        if self.instance.classes.checked_functions.contains(&class) {
            return true;
        }
        let inputs = self.formals(callee, is_input);
        let mut wrong = None;
        for base in &callee.template.bases {
            let ast::ClassBody::Long(body) = &base.ast.body else { continue };
            if let Some(e) = body.equations.first().or_else(|| body.initial_equations.first()) {
                let message = format!("the function `{}` holds an equation", callee.name);
                let d = Diagnostic::new(Code::Syntax, message).at(e.span, "a function has statements only");
                wrong = Some(d.help("write `algorithm` and `:=`"));
            }
            let (mut targets, mut in_when) = (Vec::new(), Vec::new());
            body.algorithms
                .iter()
                .for_each(|s| crate::instance::algorithm::assigned(s, false, &mut targets, &mut in_when));
            let names = targets.iter().map(|r| &r.parts[0]);
            if let Some(part) = names.into_iter().find(|p| inputs.iter().any(|f| f.name == p.name.name)) {
                let message =
                    format!("`{}` is an input of `{}` and cannot be assigned to", part.name.name, callee.name);
                let d = Diagnostic::new(Code::TypeMismatch, message).at(part.name.span, "assigned here");
                wrong = Some(d.help("give its value to a protected variable, and change that"));
            }
        }
        match wrong {
            None => self.instance.classes.checked_functions.insert(class),
            Some(d) => {
                if self.instance.diagnostics.iter().all(|other| other.message != d.message) {
                    self.instance.report(d);
                }
                false
            }
        }
    }

    /// Whether all scalars in the values are known numbers.
    fn all_known(&self, values: &[ModelicaValue]) -> bool {
        values.iter().all(|v| self.known(v))
    }

    /// Whether all scalars in a value are known numbers.
    fn known(&self, v: &ModelicaValue) -> bool {
        let mut scalars: Vec<ExprId> = Vec::new();
        v.scalars(&mut scalars);
        scalars.iter().all(|&e| self.instance.exprs.as_num(e).is_some())
    }

    /// Evaluates the body of a function to expressions, in a frame of its own. `None` as for `call_function`.
    /// The frame hides the locals of the caller, and relations in it raise no events.
    fn inline(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        let change = |m: &mut EvaluationMode| {
            // Inside the body expressions are symbolic even if the caller is a procedure; the result becomes part of
            // it.
            m.under_procedure |= m.procedure;
            m.procedure = false;
        };
        self.instance.in_mode(change, |s| s.in_frame(|s| s.calls().inline_body(callee, positional, named, span)))
    }

    /// Binds the arguments, initializes the locals, executes the algorithm sections, and collects the outputs.
    /// `None` as for `call_function`.
    ///
    /// `return` ends the execution. The sections of base classes come in the order of the bases.
    /// The locals are removed by the frame of the caller.
    /// An output without an assignment keeps its initial value.
    fn inline_body(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        let inputs = self.formals(callee, is_input);
        self.bind(callee, &inputs, positional, named, span)?;
        // Initial values may use other locals, so they are evaluated in the order of their dependence.
        let locals = self.formals(callee, |c, p| !is_input(c, p));
        for f in in_order_of_use(&locals) {
            let value = self.declared_local(f)?;
            self.instance.eval.locals.push((f.name, value));
        }
        for (section, view) in sections(callee) {
            if self.instance.statements().execute(section, view)? == StatementFlow::Return {
                break;
            }
        }
        let outputs: Vec<ModelicaValue> = locals
            .iter()
            .filter(|f| f.component.prefix.causality == Some(CausalityPrefix::Output))
            .filter_map(|f| self.instance.local(f.name).map(|i| self.instance.eval.locals[i].1.clone()))
            .collect();
        Self::outputs(outputs)
    }

    /// The value of a call from its outputs: the value itself if there is one, else a tuple.
    pub(in crate::instance) fn outputs(mut outputs: Vec<ModelicaValue>) -> Option<ModelicaValue> {
        match outputs.len() {
            1 => outputs.pop(),
            _ => Some(ModelicaValue::Tuple(Rc::new(outputs))),
        }
    }
}

/// The algorithm sections of a function, those of its bases included, with the place to look up their names.
/// A function has one section at most (MLS 12.2), but base classes may have one each.
pub(in crate::instance) fn sections<'a>(callee: &Callee<'a>) -> Vec<(&'a [ast::Statement], LookupContext)> {
    let mut found = Vec::new();
    for (base, i) in callee.template.bases.iter().zip(0u32..) {
        if let ast::ClassBody::Long(body) = &base.ast.body {
            let view = LookupContext { scope: callee.scope, base: i };
            found.extend(body.algorithms.iter().map(|section| (section.as_slice(), view)));
        }
    }
    found
}

/// Whether a function has no output.
fn gives_nothing(template: &Template<'_>) -> bool {
    matches!(template.kind, ClassKind::Function { .. })
        && !template
            .elements
            .iter()
            .any(|e| matches!(e.kind, TemplateElementKind::Component(c) if c.prefix.causality == Some(CausalityPrefix::Output)))
}

/// Whether a function has a String among its outputs.
/// The type must be written as `String`: types that are based on it are not recognized.
fn gives_text(template: &Template<'_>) -> bool {
    template.elements.iter().any(|e| match e.kind {
        TemplateElementKind::Component(c) => {
            c.prefix.causality == Some(CausalityPrefix::Output) && c.class.parts[0].name == "String"
        }
        TemplateElementKind::Class(_) => false,
    })
}

/// Whether a class has an `external` clause.
fn has_external(class: &ast::Class) -> bool {
    matches!(&class.body, ast::ClassBody::Long(b) if b.external.is_some())
}
