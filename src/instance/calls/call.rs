//! Calls: built-in functions, record constructors, user functions (written out as expressions where that is possible).

use crate::instance::builtin::retyped;
use crate::instance::expressions::Work;
use crate::instance::files::Place;
use crate::instance::lookup::{Builtin, Found};
use crate::instance::template::{Kind, Template};
use crate::instance::value::{Val, size_text};
use crate::instance::vectorised::Given;
use crate::instance::{ClassRef, Instance, ScopeId, View};
use crate::diag::{Code, Diagnostic, Span};
use crate::expr::{ExprId, Exprs};
use crate::types::{Type, Variability};
use crate::syntax::ast::{self, Causality, ClassKind, Expr, Ident, Reference};
use crate::syntax::symbol::Symbol;
use std::rc::Rc;

/// Deepest nesting of function calls that are written out.
const DEEPEST_INLINE: usize = 40;
/// Most statements executed to write one call out.
const MOST_STEPS: usize = 20_000;
/// The same when all arguments are known, so that the call is simply carried out.
const MOST_KNOWN_STEPS: usize = 2_000_000;
/// Deepest nesting when all arguments are known.
const DEEPEST_KNOWN: usize = 150;

/// A function ready to be called.
pub(in crate::instance) struct Callee<'a> {
    pub scope: ScopeId,
    pub template: Rc<Template<'a>>,
    pub name: String,
}

/// One declared input, output or local of a function.
pub(in crate::instance) struct Formal<'a> {
    pub name: Symbol,
    pub component: &'a ast::Component,
    pub index: u32,
    pub view: View,
}

impl<'a> Instance<'a, '_> {
    pub(in crate::instance) fn call(
        &mut self,
        function: &'a Reference,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        view: View,
        span: Span,
    ) -> Option<Val> {
        if let Some((class, bound)) = self.functional_input(function) {
            return self.call_bound(class, args, named, &bound, view, span);
        }
        if !self.is_redefined(function, view)
            && let Some(v) = self.builtin_call(function, args, named, view, span)
        {
            return v;
        }
        let path = ast::Path {
            global: function.global,
            parts: function.parts.iter().map(|p| p.name).collect(),
            span: function.span,
        };
        match self.lookup_path(view, &path) {
            Ok(Found::Class(class)) => self.call_bound(class, args, named, &[], view, span),
            Ok(Found::Builtin(Builtin::Enumeration(i))) => self.enumeration_of(i, args, view, span),
            _ => match self.instance_function(function, view) {
                Some(class) => self.call_class(class, args, named, &[], view, span),
                None => {
                    self.unknown_function(function);
                    None
                }
            },
        }
    }

    /// Whether a class that is visible here bears the name of a built-in function, as after
    /// `import Modelica.ComplexMath.abs`: it is nearer (MLS 5.3.1).
    fn is_redefined(&mut self, function: &Reference, view: View) -> bool {
        let [part] = function.parts.as_slice() else { return false };
        !function.global && matches!(self.lookup_nested(view, part.name.name), Some(Found::Class(_)))
    }

    /// Calls a function some of whose inputs were given before.
    fn call_bound(
        &mut self,
        class: ClassRef<'a>,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        bound: &[(Ident, Val)],
        view: View,
        span: Span,
    ) -> Option<Val> {
        match self.external_builtin(&class) {
            Some(name) => self.named_mathematics(&name, args, named, view, span),
            None => self.call_class(class, args, named, bound, view, span),
        }
    }

    /// The built-in function that `external "builtin" y = sin(u)` stands for.
    fn external_builtin(&self, class: &ClassRef<'a>) -> Option<String> {
        let ast::ClassBody::Long(body) = &self.library.class(class.class).body else { return None };
        let called = body.external_text.as_deref()?.trim_start().strip_prefix("\"builtin\"")?;
        let called = called.split_once('=').map_or(called, |(_, right)| right);
        Some(called.split('(').next()?.trim().to_string())
    }

    /// A function named through a component, as in `oil.density(p)`.
    fn instance_function(&mut self, function: &Reference, view: View) -> Option<ClassRef<'a>> {
        let Found::Component(scope, index) = self.lookup(view, function.parts[0].name.name)? else { return None };
        let mut node = self.component(scope, index)?;
        let (last, middle) = function.parts[1..].split_last()?;
        for (k, part) in middle.iter().enumerate() {
            let crate::instance::Node::Object(s) = *self.node(node) else { return None };
            let &i = self.scope(s).template.by_name.get(&part.name.name)?;
            if matches!(self.scope(s).template.elements[i as usize].kind, Kind::Class(_)) {
                let mut found = self.lookup(View { scope: s, base: 0 }, part.name.name)?;
                for next in middle[k + 1..].iter().chain([last]) {
                    found = self.member(&found, next.name.name)?;
                }
                let Found::Class(class) = found else { return None };
                return Some(class);
            }
            node = self.component(s, i)?;
        }
        let crate::instance::Node::Object(s) = *self.node(node) else { return None };
        match self.lookup(View { scope: s, base: 0 }, last.name.name)? {
            Found::Class(class) => Some(class),
            _ => None,
        }
    }

    fn call_class(
        &mut self,
        class: ClassRef<'a>,
        args: &'a [Expr],
        named: &'a [(Ident, Expr)],
        bound: &[(Ident, Val)],
        view: View,
        span: Span,
    ) -> Option<Val> {
        let template = self.template(class.class, class.parent);
        if let Some(Builtin::Enumeration(i)) = template.builtin {
            return self.enumeration_of(i, args, view, span);
        }
        // a function without outputs only asserts
        let text = gives_text(&template) || gives_nothing(&template);
        let positional: Option<Vec<Val>> = args.iter().map(|a| self.argument(a, text, view)).collect();
        let mut by_name = Vec::new();
        for (name, e) in named {
            by_name.push((*name, self.argument(e, text, view)?));
        }
        let mut positional = positional?;
        if !bound.is_empty() {
            let inputs =
                template.elements.iter().filter(|e| matches!(e.kind, Kind::Component(c) if is_input(c, e.protected)));
            let open: Vec<Ident> = inputs
                .filter(|e| bound.iter().all(|(n, _)| n.name != e.name))
                .map(|e| Ident { name: e.name, span })
                .collect();
            if positional.len() <= open.len() {
                by_name.extend(open.into_iter().zip(std::mem::take(&mut positional)));
            }
        }
        by_name.extend_from_slice(bound);
        if template.builtin == Some(Builtin::Object) {
            let place = Place { call: span, given: None };
            return self.construct_object(&class, Given { positional, named: by_name }, place);
        }
        if matches!(template.kind, ClassKind::Record { operator: true }) {
            let given = Given { positional: positional.clone(), named: by_name.clone() };
            if let Some(made) = self.overloaded_constructor(&class, &given, span) {
                return made;
            }
        }
        let scope = self.package(&class);
        let name = self.library.full_name(class.class);
        let callee = Callee { scope, template, name };
        match callee.template.kind {
            ClassKind::Record { .. } => self.construct(&callee, positional, by_name, span),
            ClassKind::Function { .. } => match self.file_function(&callee) {
                Some(function) => {
                    let place = self.file_place(args.first(), view, span);
                    self.call_file_function(function, &callee, positional, by_name, place)
                }
                None => self.call_elementwise(&callee, Given { positional, named: by_name }, span),
            },
            _ => {
                let message = format!("`{}` is not a function", callee.name);
                self.fail(Code::UnknownFunction, &message, span)
            }
        }
    }

    /// An argument; whole numbers that parameters give are taken by value, for sizes and loops depend on them, and
    /// whatever a text depends on.
    fn argument(&mut self, e: &'a Expr, text: bool, view: View) -> Option<Val> {
        let value = self.eval(e, view)?;
        if text && !value.dims().is_empty() && self.eval.frame == 0 && !self.eval.procedure {
            let mut scalars = Vec::new();
            value.scalars(&mut scalars);
            let fixed = scalars.iter().all(|e| self.variability(*e) <= Variability::Parameter);
            if fixed && !self.all_known(std::slice::from_ref(&value)) {
                return self.constant(e, view);
            }
        }
        if let Val::Scalar(id, ty) = value
            && (text || ty == Type::Integer)
        {
            let outside = self.eval.frame == 0 && !self.eval.procedure;
            let open = self.exprs.as_num(id).is_none() && self.variability(id) <= Variability::Parameter;
            if outside
                && open
                && (text || !self.found_at_start(id))
                && !self.eval.locals.iter().any(|(_, v)| v.scalar().is_some_and(|(l, _)| l == id))
            {
                return self.constant(e, view);
            }
        }
        Some(value)
    }

    fn enumeration_of(&mut self, i: u32, args: &'a [Expr], view: View, span: Span) -> Option<Val> {
        let [arg] = args else {
            return self.fail(Code::BadCall, "a conversion to an enumeration takes one Integer", span);
        };
        Some(retyped(&self.eval(arg, view)?, Type::Enumeration(i)))
    }

    /// Components of a function or record that pass a test.
    pub(in crate::instance) fn formals(
        &self,
        callee: &Callee<'a>,
        wanted: impl Fn(&ast::Component, bool) -> bool,
    ) -> Vec<Formal<'a>> {
        let with_index = (0u32..).zip(&callee.template.elements);
        let found = with_index.filter_map(|(index, e)| match e.kind {
            Kind::Component(component) if wanted(component, e.protected) => {
                Some(Formal { name: e.name, component, index, view: View { scope: callee.scope, base: e.base } })
            }
            _ => None,
        });
        found.collect()
    }

    /// A value of a record class from its constructor.
    fn construct(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<Val> {
        let formals = self.formals(callee, |c, protected| {
            !protected && !matches!(c.prefix.variability, Some(ast::Variability::Constant))
        });
        let before = self.enter_frame();
        let bound = self.bind(callee, &formals, positional, named, span);
        let mut fields = Vec::new();
        if bound.is_some() {
            for f in &formals {
                let i = self.local(f.name);
                fields.push((f.name, i.map(|i| self.eval.locals[i].1.clone())));
            }
        }
        self.leave_frame(before);
        bound?;
        let fields: Option<Vec<_>> = fields.into_iter().map(|(n, v)| Some((n, v?))).collect();
        let fields = fields?;
        let class = self.operator_class_of(&callee.template);
        Some(Val::Record(Rc::new(crate::instance::value::Record { fields, class })))
    }

    pub(in crate::instance) fn enter_frame(&mut self) -> (usize, usize, bool) {
        let before = (self.eval.frame, self.eval.locals.len(), self.eval.no_event);
        self.eval.frame = self.eval.locals.len();
        self.eval.no_event = true;
        before
    }

    pub(in crate::instance) fn leave_frame(&mut self, before: (usize, usize, bool)) {
        self.eval.locals.truncate(before.1);
        (self.eval.frame, _, self.eval.no_event) = before;
    }

    /// Does something in a frame of its own, with the arguments of a call bound to the inputs of its function.
    pub(in crate::instance) fn with_inputs<T>(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
        f: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let inputs = self.formals(callee, is_input);
        let before = self.enter_frame();
        let value = self.bind(callee, &inputs, positional, named, span).and_then(|()| f(self));
        self.leave_frame(before);
        value
    }

    /// Binds arguments to inputs in a fresh frame; defaults may use inputs before them.
    pub(in crate::instance) fn bind(
        &mut self,
        callee: &Callee<'a>,
        formals: &[Formal<'a>],
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<()> {
        if positional.len() > formals.len() {
            let message =
                format!("`{}` takes {} arguments, and {} are given", callee.name, formals.len(), positional.len());
            return self.fail(Code::BadCall, &message, span);
        }
        if let Some((name, _)) = named.iter().find(|(n, _)| formals.iter().all(|f| f.name != n.name)) {
            let names: Vec<Symbol> = formals.iter().map(|f| f.name).collect();
            let mut d = Diagnostic::new(Code::BadCall, format!("`{}` has no input `{}`", callee.name, name.name))
                .at(name.span, "not an input");
            d = match crate::instance::errors::nearest(name.name.as_str(), names.iter().map(|n| n.as_str())) {
                Some(near) => d.help(format!("did you mean `{near}`?")),
                None => d.help(crate::instance::errors::list_names("it takes", &names)),
            };
            self.report(d);
            return None;
        }
        let mut positional = positional.into_iter();
        for f in formals {
            let given =
                positional.next().or_else(|| named.iter().find(|(n, _)| n.name == f.name).map(|(_, v)| v.clone()));
            let given_here = given.is_some();
            let value = match given {
                Some(v @ Val::Function(..)) if self.is_functional(f) => v,
                Some(v) => self.fit_argument(callee, f, v, span)?,
                None => match self.default_value(f)? {
                    Some(v) => v,
                    None => {
                        let message = format!("`{}` needs a value for its input `{}`", callee.name, f.name);
                        let d = Diagnostic::new(Code::BadCall, message)
                            .at(span, "this call")
                            .at(f.component.name.span, "declared here without a default");
                        self.report(d);
                        return None;
                    }
                },
            };
            let place = match given_here {
                true => span,
                false => self.reached(f.view.scope, f.index).binding.map_or(span, |b| b.expr.span),
            };
            self.check_bounds(callee, f, &value, place);
            self.eval.locals.push((f.name, value));
        }
        Some(())
    }

    /// A number given to an input must lie within the bounds of its declaration; reported once however often it is called.
    fn check_bounds(&mut self, callee: &Callee<'a>, f: &Formal<'a>, value: &Val, span: Span) {
        let Some(x) = value.as_number(&self.exprs) else { return };
        let bound = match (declared_number(f.component, "min"), declared_number(f.component, "max")) {
            (Some(low), _) if x < low => format!("less than its `min`, {low}"),
            (_, Some(high)) if x > high => format!("more than its `max`, {high}"),
            _ => return,
        };
        let message = format!("the input `{}` of `{}` is {x}, {bound}", f.name, callee.name);
        if self.diagnostics.iter().all(|d| d.message != message) {
            self.report(
                Diagnostic::new(Code::OutOfRange, message)
                    .at(span, "this value")
                    .at(f.component.name.span, "declared here")
                    .help("give a value within the bounds, in the unit of the input"),
            );
        }
    }

    /// Checks an argument against the declared type and number of dimensions.
    fn fit_argument(&mut self, callee: &Callee<'a>, f: &Formal<'a>, value: Val, span: Span) -> Option<Val> {
        let wanted = match self.class_at(f.view, &f.component.class)? {
            Found::Builtin(b) => Some(b),
            Found::Class(c) => {
                let t = self.template(c.class, c.parent);
                if matches!(t.kind, ClassKind::Function { .. }) {
                    let message = format!(
                        "input `{}` of `{}` is a function, and this is {}",
                        f.name,
                        callee.name,
                        value.describe()
                    );
                    return self.fail(Code::BadCall, &message, span);
                }
                if t.dims.is_empty() { t.builtin } else { None }
            }
            Found::Component(..) => None,
        };
        let Some(b) = wanted else { return Some(value) };
        let declared = f.component.subscripts.len();
        if value.dims().len() != declared {
            let message = format!(
                "input `{}` of `{}` is {}, and this is {}",
                f.name,
                callee.name,
                if declared == 0 { "a single value".into() } else { format!("an array of {declared} dimensions") },
                value.describe()
            );
            return self.fail(Code::BadCall, &message, span);
        }
        let fits = match (b, value.element_type()) {
            (Builtin::Real, Some(Type::Real | Type::Integer)) => true,
            (Builtin::Integer, Some(Type::Integer)) | (Builtin::Boolean, Some(Type::Boolean)) => true,
            (Builtin::Enumeration(a), Some(Type::Enumeration(b))) => a == b,
            (Builtin::Object, _) => matches!(value, Val::Object(_)),
            (Builtin::String, _) => matches!(value.elements().first(), Some(Val::Text(_)) | None),
            (_, None) => value.elements().is_empty(),
            _ => false,
        };
        if !fits {
            let message = format!(
                "input `{}` of `{}` is of type {}, and this is {}",
                f.name,
                callee.name,
                crate::instance::errors::builtin_name(b),
                value.describe()
            );
            return self.fail(Code::BadCall, &message, span);
        }
        Some(if b == Builtin::Real { value.with_type(Type::Real) } else { value })
    }

    /// The declared default: `None` on failure, `Some(None)` when there is none.
    fn default_value(&mut self, f: &Formal<'a>) -> Option<Option<Val>> {
        let reached = self.reached(f.view.scope, f.index);
        match reached.binding {
            Some(b) => {
                // In the frame of the call, so that earlier inputs are seen.
                let value = if b.access.is_empty() { self.eval(b.expr, b.view) } else { self.binding_value(&b, true) };
                value.map(Some)
            }
            None => match self.class_at(f.view, &f.component.class)? {
                // A record without a value takes its fields' defaults.
                Found::Class(c) if f.component.subscripts.is_empty() => self.default_record(&c),
                _ => Some(None),
            },
        }
    }

    fn default_record(&mut self, class: &ClassRef<'a>) -> Option<Option<Val>> {
        let template = self.template(class.class, class.parent);
        if !matches!(template.kind, ClassKind::Record { .. }) {
            return Some(None);
        }
        let scope = self.package(class);
        let name = self.library.full_name(class.class);
        let callee = Callee { scope, template, name };
        let span = self.library.class(class.class).name.span;
        let mark = self.diagnostics.len();
        let value = self.construct(&callee, Vec::new(), Vec::new(), span);
        if value.is_none() {
            self.diagnostics.truncate(mark);
        }
        Some(value)
    }

    pub(in crate::instance) fn call_function(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<Val> {
        if let Some(how) = self.external_builtin_of(callee) {
            return self.call_external(how, callee, positional, named, Place { call: span, given: None });
        }
        if callee.template.bases.iter().any(|b| has_external(b.ast)) {
            self.unsupported(span, &format!("the external function `{}`", callee.name));
            return None;
        }
        if callee.template.bases[0].ast.prefixes.partial {
            let message = format!("`{}` is partial and cannot be called", callee.name);
            return self.fail(Code::Partial, &message, span);
        }
        let known = self.all_known(&positional) && named.iter().all(|(_, v)| self.known(v));
        if !self.well_formed(callee) {
            return None;
        }
        let limit = if known { DEEPEST_KNOWN } else { DEEPEST_INLINE };
        if self.eval.depth >= limit {
            if known {
                let message = format!("`{}` calls itself without end", callee.name);
                let d = Diagnostic::new(Code::Recursion, message).at(span, "this call");
                if !self.diagnostics.iter().any(|d| d.code == Code::Recursion) {
                    self.report(d.help("a recursive function must reach a case in which it does not call itself"));
                }
                return None;
            }
            self.eval.not_inline = true;
            return None;
        }
        let mark = (self.diagnostics.len(), self.eval.calls.len());
        let work = self.eval.work;
        if self.eval.depth == 0 {
            self.eval.work = Work::allowed([MOST_STEPS, MOST_KNOWN_STEPS]);
        }
        self.eval.work.known = known;
        self.eval.depth += 1;
        let outer = std::mem::replace(&mut self.eval.not_inline, false);
        let value = self.inline(callee, positional.clone(), named.clone(), span);
        self.eval.depth -= 1;
        if self.eval.depth == 0 {
            self.eval.work = work;
        }
        self.eval.work.known = work.known;
        let refused = std::mem::replace(&mut self.eval.not_inline, outer);
        if value.is_some() || !refused {
            return value;
        }
        if known && !std::mem::take(&mut self.eval.may_fail) {
            let message = format!("`{}` does not come to an end", callee.name);
            return self.fail(Code::Recursion, &message, span);
        }
        self.diagnostics.truncate(mark.0);
        self.eval.calls.truncate(mark.1);
        if gives_nothing(&callee.template) {
            return self.call_for_effect(callee, positional, named, span);
        }
        self.call_procedure(callee, positional, named, span)
    }

    /// A call of a function without outputs whose assertions values that change decide: part of the procedure around it.
    fn call_for_effect(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<Val> {
        if self.eval.procedure {
            return self.procedure_body(callee, positional, named, span);
        }
        if self.eval.depth > 0 {
            (self.eval.not_inline, self.eval.may_fail) = (true, true);
            return None;
        }
        let what = format!("a call of `{}`, which has no output, with arguments that change,", callee.name);
        self.unsupported(span, &what);
        None
    }

    /// Whether a function keeps to what functions may do (MLS 12.2).
    fn well_formed(&mut self, callee: &Callee<'a>) -> bool {
        let class = callee.template.class;
        if self.functions_checked.contains(&class) {
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
            body.algorithms.iter().for_each(|s| crate::instance::algorithm::assigned(s, false, &mut targets, &mut in_when));
            if let Some(part) = targets.iter().find(|p| inputs.iter().any(|f| f.name == p.name.name)) {
                let message =
                    format!("`{}` is an input of `{}` and cannot be assigned to", part.name.name, callee.name);
                let d = Diagnostic::new(Code::TypeMismatch, message).at(part.name.span, "assigned here");
                wrong = Some(d.help("give its value to a protected variable, and change that"));
            }
        }
        match wrong {
            None => self.functions_checked.insert(class),
            Some(d) => {
                if self.diagnostics.iter().all(|other| other.message != d.message) {
                    self.report(d);
                }
                false
            }
        }
    }

    fn all_known(&self, values: &[Val]) -> bool {
        values.iter().all(|v| self.known(v))
    }

    fn known(&self, v: &Val) -> bool {
        let mut scalars: Vec<ExprId> = Vec::new();
        v.scalars(&mut scalars);
        scalars.iter().all(|&e| self.exprs.as_num(e).is_some())
    }

    /// Carries the function out on symbolic values.
    fn inline(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<Val> {
        let was = std::mem::replace(&mut self.eval.procedure, false);
        let under = self.eval.under_procedure;
        self.eval.under_procedure |= was;
        let before = self.enter_frame();
        let value = self.inline_body(callee, positional, named, span);
        self.leave_frame(before);
        (self.eval.procedure, self.eval.under_procedure) = (was, under);
        value
    }

    fn inline_body(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<Val>,
        named: Vec<(Ident, Val)>,
        span: Span,
    ) -> Option<Val> {
        let inputs = self.formals(callee, is_input);
        self.bind(callee, &inputs, positional, named, span)?;
        let locals = self.formals(callee, |c, p| !is_input(c, p));
        for f in in_order_of_use(&locals) {
            let value = self.declared_local(f)?;
            self.eval.locals.push((f.name, value));
        }
        for (i, base) in callee.template.bases.iter().enumerate() {
            let ast::ClassBody::Long(body) = &base.ast.body else { continue };
            let view = View { scope: callee.scope, base: u32::try_from(i).expect("few bases") };
            for section in &body.algorithms {
                if self.execute(section, view)? == crate::instance::algorithm::Flow::Return {
                    break;
                }
            }
        }
        let outputs: Vec<Val> = locals
            .iter()
            .filter(|f| f.component.prefix.causality == Some(Causality::Output))
            .filter_map(|f| self.local(f.name).map(|i| self.eval.locals[i].1.clone()))
            .collect();
        Self::outputs(outputs)
    }

    pub(in crate::instance) fn outputs(mut outputs: Vec<Val>) -> Option<Val> {
        match outputs.len() {
            1 => outputs.pop(),
            _ => Some(Val::Tuple(Rc::new(outputs))),
        }
    }

    /// The initial value of an output or protected component of a function; zero where nothing is said.
    pub(in crate::instance) fn declared_local(&mut self, f: &Formal<'a>) -> Option<Val> {
        let reached = self.reached(f.view.scope, f.index);
        let value = match reached.binding {
            Some(b) if b.access.is_empty() => Some(self.eval(b.expr, b.view)?),
            Some(b) => Some(self.binding_value(&b, true)?),
            None => None,
        };
        let blank = self.blank(f, value.as_ref())?;
        match value {
            None => Some(blank),
            Some(v) => {
                if v.dims() != blank.dims() {
                    let message = format!(
                        "`{}` has size {}, and its value {}",
                        f.name,
                        size_text(blank.dims()),
                        size_text(v.dims())
                    );
                    return self.fail(Code::SizeMismatch, &message, f.component.name.span);
                }
                let ty = blank.element_type().unwrap_or(Type::Real);
                Some(if ty == Type::Real { v.with_type(ty) } else { v })
            }
        }
    }

    /// Zeros in the declared shape.
    fn blank(&mut self, f: &Formal<'a>, value: Option<&Val>) -> Option<Val> {
        let mut found = self.class_at(f.view, &f.component.class)?;
        // `output R r(x = u)`: fields take what the declaration says of them
        let given = self.reached(f.view.scope, f.index).args;
        if let Found::Class(c) = &mut found
            && !given.is_empty()
        {
            c.args = given.into_iter().chain(c.args.iter().cloned()).collect();
        }
        let one = self.blank_one(&found, f.component.name.span)?;
        let mut dims = Vec::new();
        for (i, s) in f.component.subscripts.iter().enumerate() {
            dims.push(match s {
                // without a value of its own it takes the size of what is assigned to it (MLS 12.4.5)
                ast::Subscript::All(_) => value.and_then(|v| v.dims().get(i).copied()).unwrap_or(0),
                ast::Subscript::Expr(e) => match self.enumeration_range(e, f.view) {
                    Some(all) => all.len(),
                    None => self.known_number(e, f.view)?.0.max(0.0) as usize,
                },
            });
        }
        if dims.iter().product::<usize>() > 1_000_000 {
            return self.fail(Code::TooLarge, "this array has more than a million elements", f.component.name.span);
        }
        Some(repeated(&one, dims))
    }

    fn blank_one(&mut self, found: &Found<'a>, span: Span) -> Option<Val> {
        let of = |b: Builtin| match b {
            Builtin::Real => Val::Scalar(Exprs::ZERO, Type::Real),
            Builtin::Integer => Val::Scalar(Exprs::ZERO, Type::Integer),
            Builtin::Boolean => Val::Scalar(Exprs::ZERO, Type::Boolean),
            Builtin::Enumeration(i) => Val::Scalar(Exprs::ONE, Type::Enumeration(i)),
            // an output of this type is made by what Rust knows of the function
            Builtin::String | Builtin::Object => Val::text(""),
        };
        match found {
            Found::Builtin(b) => Some(of(*b)),
            Found::Class(c) => {
                let t = self.template(c.class, c.parent);
                let dims = self.type_dims(&t)?;
                if let Some(b) = t.builtin {
                    return Some(repeated(&of(b), dims));
                }
                let mut fields = Vec::new();
                let scope = self.package(c);
                let callee = Callee { scope, template: t, name: String::new() };
                for f in self.formals(&callee, |_, _| true) {
                    let value = self.declared_local(&f)?;
                    fields.push((f.name, value));
                }
                let class = self.operator_class(c);
                let one = Val::Record(Rc::new(crate::instance::value::Record { fields, class }));
                Some(repeated(&one, dims))
            }
            Found::Component(..) => self.fail(Code::WrongClassKind, "a type is needed here", span),
        }
    }

    /// The dimensions that a type brings, as `type Orientation = Real[3, 3]` does.
    fn type_dims(&mut self, t: &Template<'a>) -> Option<Vec<usize>> {
        let mut dims = Vec::new();
        for (subscripts, base) in t.dims.iter().rev() {
            let view = t.bases[*base as usize].parent;
            for s in *subscripts {
                dims.push(match s {
                    ast::Subscript::All(span) => return self.fail(Code::NoValue, "this size is not given", *span),
                    ast::Subscript::Expr(e) => self.extent(e, view)?.size,
                });
            }
        }
        Some(dims)
    }
}

/// Locals so that each comes after those that its sizes and its value name (MLS 12.4.4).
pub(in crate::instance) fn in_order_of_use<'f, 'a>(locals: &'f [Formal<'a>]) -> Vec<&'f Formal<'a>> {
    let named: Vec<Vec<Symbol>> = locals.iter().map(|f| crate::instance::deduce::names_of_declaration(f.component)).collect();
    let mut sorted: Vec<&Formal<'a>> = Vec::with_capacity(locals.len());
    let mut open: Vec<usize> = (0..locals.len()).collect();
    while !open.is_empty() {
        let waits = |k: usize, on: usize| on != k && named[k].contains(&locals[on].name);
        // those that use each other stay as they are declared
        let at = open.iter().position(|&k| !open.iter().any(|&on| waits(k, on))).unwrap_or(0);
        sorted.push(&locals[open.remove(at)]);
    }
    sorted
}

/// An array of these dimensions, all elements of which are one value.
fn repeated(one: &Val, dims: Vec<usize>) -> Val {
    if dims.is_empty() {
        return one.clone();
    }
    let inner = one.dims().to_vec();
    let elements = (0..dims.iter().product()).flat_map(|_| one.elements().to_vec()).collect();
    Val::array(dims.into_iter().chain(inner).collect(), elements)
}

/// Whether a function has no output.
fn gives_nothing(template: &Template<'_>) -> bool {
    matches!(template.kind, ClassKind::Function { .. })
        && !template
            .elements
            .iter()
            .any(|e| matches!(e.kind, Kind::Component(c) if c.prefix.causality == Some(Causality::Output)))
}

/// Whether a function has a text as an output.
fn gives_text(template: &Template<'_>) -> bool {
    template.elements.iter().any(|e| match e.kind {
        Kind::Component(c) => c.prefix.causality == Some(Causality::Output) && c.class.parts[0].name == "String",
        Kind::Class(_) => false,
    })
}

/// An attribute that is written as a number.
fn declared_number(component: &ast::Component, attribute: &str) -> Option<f64> {
    let arguments = &component.modification.as_ref()?.arguments;
    let value = arguments.iter().find_map(|argument| match &argument.kind {
        ast::ArgumentKind::Modify { path, modification, .. } if path.parts[0].name.as_str() == attribute => {
            modification.as_ref()?.value.as_ref()
        }
        _ => None,
    });
    value?.as_number()
}

pub(in crate::instance) fn is_input(c: &ast::Component, protected: bool) -> bool {
    !protected && c.prefix.causality == Some(Causality::Input)
}

fn has_external(class: &ast::Class) -> bool {
    matches!(&class.body, ast::ClassBody::Long(b) if b.external.is_some())
}
