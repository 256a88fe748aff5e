//! Equation sections of every component, made scalar.
//!
//! [`EquationFlattener`] walks the classes of all components. `for` equations are unrolled, `if` equations are decided
//! or become conditional expressions (MLS 8.3), array equations become one equation for each element. `when_equations`
//! and `algorithm_sections` have the rest of its methods. `flatten` calls [`EquationFlattener::walk`] once.

use super::numbers::ComponentNumbers;
use super::{
    ConservationDeclaration, ElementOrigin, FlatAssertion, FlatEquation, FlatModel, MessagePart, MessageTemplate,
    OriginKind, ScalarType, Variability,
};
use crate::instance::algorithm::{AlgorithmCall, AssertArguments};
use crate::instance::value::ModelicaValue;
use crate::instance::{Instance, LookupContext, ScopeId};
use crate::network;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::ast::{self, ClassBody, EquationKind, Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};

/// The two sides of a scalar equation with the place it comes from.
pub(super) struct EquationSides {
    pub(super) lhs: ExprId,
    pub(super) rhs: ExprId,
    pub(super) span: Span,
}

/// Translates equation and algorithm sections and writes the results into the flat model.
pub(super) struct EquationFlattener<'w, 'a, 'l> {
    /// The component tree, which evaluates expressions.
    pub(super) instance: &'w mut Instance<'a, 'l>,
    /// The numbers of components in the flat model.
    pub(super) numbers: &'w ComponentNumbers,
    /// The result.
    pub(super) flat: &'w mut FlatModel,
    /// The conditions of the `if` equations around the equation being read, outermost first. Assertions hold only under
    /// them.
    pub(super) guards: Vec<ExprId>,
    /// The variables that the branch of a `when` being read has determined so far.
    pub(super) determined: Vec<VarId>,
}

impl<'w, 'a, 'l> EquationFlattener<'w, 'a, 'l> {
    /// A walker that has read nothing yet.
    pub(super) fn new(
        instance: &'w mut Instance<'a, 'l>,
        numbers: &'w ComponentNumbers,
        flat: &'w mut FlatModel,
    ) -> Self {
        EquationFlattener { instance, numbers, flat, guards: Vec::new(), determined: Vec::new() }
    }

    /// Reads the sections of all components, in their order, and of all base classes of each.
    ///
    /// The sections of a base class are read with the names of that base (its [`LookupContext`]). Diagnostics that come
    /// up in a component get the place of the outermost component that contains it.
    pub(super) fn walk(&mut self, scopes: &[ScopeId]) {
        for &scope in scopes {
            let mark = self.instance.diagnostics.len();
            let template = self.instance.scope(scope).template.clone();
            for (base, i) in template.bases.iter().zip(0u32..) {
                let ClassBody::Long(body) = &base.ast.body else { continue };
                self.body(body, LookupContext { scope, base: i });
            }
            // Messages of a library component get the place of the component in the user's model.
            if self.instance.diagnostics.len() > mark
                && let Some(outermost) = self.instance.outermost(scope)
            {
                let (name, span) = (self.instance.scope(outermost).name.clone(), self.instance.scope(outermost).span);
                self.instance.point_at(mark, &name, span);
            }
        }
    }

    /// Reads the sections of one class body. Assertions of initial sections hold at the start only.
    ///
    /// The order is: equations, initial equations, algorithms, initial algorithms.
    pub(super) fn body(&mut self, body: &'a ast::LongBody, view: LookupContext) {
        let pairs = self.equations(&body.equations, view);
        self.push(pairs, view, false);
        let before = self.flat.asserts.len();
        let pairs = self.equations(&body.initial_equations, view);
        self.push(pairs, view, true);
        for at in before..self.flat.asserts.len() {
            self.flat.asserts[at].condition = self.at_start_only(self.flat.asserts[at].condition);
        }
        for section in &body.algorithms {
            self.algorithm(section, view, false);
        }
        for section in &body.initial_algorithms {
            self.algorithm(section, view, true);
        }
    }

    /// The origin of what stands at a place in a component.
    /// The kind is `Declared`.
    pub(super) fn origin(&self, span: Span, view: LookupContext) -> ElementOrigin {
        let instance = self.numbers.of(view.scope);
        ElementOrigin { span, instance, kind: OriginKind::Declared }
    }

    /// Appends scalar equations to the model or to its initial equations.
    /// All of them belong to the component of `view`.
    pub(super) fn push(&mut self, pairs: Vec<EquationSides>, view: LookupContext, initial: bool) {
        for p in pairs {
            let origin = self.origin(p.span, view);
            let equation = FlatEquation { lhs: p.lhs, rhs: p.rhs, origin };
            if initial {
                self.flat.initial_equations.push(equation);
            } else {
                self.flat.equations.push(equation);
            }
        }
    }

    /// The scalar equations of a list. `when`, `assert` and calls go straight into the flat model.
    /// The order is that of the text; loops are unrolled in place.
    /// A `when` inside an `if` that is not decided is reported.
    pub(super) fn equations(&mut self, equations: &'a [ast::Equation], view: LookupContext) -> Vec<EquationSides> {
        let mut pairs = Vec::new();
        for e in equations {
            self.equation(e, view, &mut pairs);
            self.watch(view);
        }
        pairs
    }

    /// Adds assertions that the equation just read needs to have a meaning, such as those of called functions, under
    /// the conditions around it.
    /// It is called after each equation, because the instance collects the calls of all expressions that it evaluates.
    pub(super) fn watch(&mut self, view: LookupContext) {
        let mut calls = self.instance.statements().take_calls();
        for call in &mut calls {
            for &guard in &self.guards {
                call.guard = self.instance.exprs.and(guard, call.guard);
            }
        }
        watch(self.instance, self.flat, calls, self.numbers.of(view.scope));
    }

    /// Reads one equation and appends its scalar equations to `out`.
    pub(super) fn equation(&mut self, e: &'a ast::Equation, view: LookupContext, out: &mut Vec<EquationSides>) {
        match &e.kind {
            // `network` has read connections.
            EquationKind::Connect(..) => {}
            EquationKind::Equal(l, r) => self.equal(l, r, view, e.span, out),
            EquationKind::For { iterators, body } => self.for_equation(iterators, body, view, out),
            EquationKind::If { branches, otherwise } => self.if_equation(branches, otherwise, view, e.span, out),
            EquationKind::When(_) if !self.guards.is_empty() => self.when_under_if(e.span),
            EquationKind::When(branches) => self.when_equation(branches, view, e.span),
            EquationKind::Call(call) => self.call(call, view, e.span),
        }
    }

    /// Unrolls a `for` equation (MLS 8.3.2): reads the body once for each combination of values of its iterators, the
    /// last iterator fastest.
    ///
    /// The range must be known before the run. The iterator is a local name of the instance while the body is read.
    pub(super) fn for_equation(
        &mut self,
        iterators: &'a [ast::ForIndex],
        body: &'a [ast::Equation],
        view: LookupContext,
        out: &mut Vec<EquationSides>,
    ) {
        let Some((first, rest)) = iterators.split_first() else {
            for e in body {
                self.equation(e, view, out);
            }
            return;
        };
        let Some(values) = self.instance.statements().loop_values(first, body, view) else { return };
        for value in values {
            self.instance.statements().push_local(first.name.name, value);
            self.for_equation(rest, body, view, out);
            self.instance.statements().pop_local();
        }
    }

    /// Reads an equation between two expressions. A tuple on the left takes the results of a call.
    /// A side that cannot be evaluated has a message already and gives no equation.
    pub(super) fn equal(
        &mut self,
        l: &'a Expr,
        r: &'a Expr,
        view: LookupContext,
        span: Span,
        out: &mut Vec<EquationSides>,
    ) {
        if let ExprKind::Tuple(targets) = &l.kind {
            self.tuple(targets, r, view, span, out);
            return;
        }
        let (a, b) = (self.instance.evaluator().eval(l, view), self.instance.evaluator().eval(r, view));
        if let (Some(a), Some(b)) = (a, b) {
            self.equal_values(&a, &b, span, out);
        }
    }

    /// Reads `(a, , b) = f(x)`: one equation for each target that is given. The call may have more results than
    /// targets.
    ///
    /// Too many targets are reported (E021). A single result counts as a tuple of one.
    pub(super) fn tuple(
        &mut self,
        targets: &'a [Option<Expr>],
        r: &'a Expr,
        view: LookupContext,
        span: Span,
        out: &mut Vec<EquationSides>,
    ) {
        let Some(value) = self.instance.evaluator().eval_all(r, view) else { return };
        let values = match &value {
            ModelicaValue::Tuple(values) => values.to_vec(),
            other => vec![other.clone()],
        };
        if targets.len() > values.len() {
            self.instance.diagnostics.push(
                Diagnostic::new(Code::BadCall, format!("{} results are wanted", targets.len()))
                    .at(r.span, format!("this gives {}", values.len())),
            );
            return;
        }
        for (target, value) in targets.iter().zip(&values) {
            let Some(target) = target else { continue };
            if let Some(t) = self.instance.evaluator().eval(target, view) {
                self.equal_values(&t, value, span, out);
            }
        }
    }

    /// Appends one scalar equation for each pair of elements of two values. Reports values of different shape or type,
    /// and texts, which have no equations.
    ///
    /// Codes: E210 for different types, E211 for different sizes.
    pub(super) fn equal_values(
        &mut self,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
        out: &mut Vec<EquationSides>,
    ) {
        // Of several results of a call an expression takes the first (MLS 12.4.3).
        let first = |v: &ModelicaValue| match v {
            ModelicaValue::Tuple(values) => values[0].clone(),
            other => other.clone(),
        };
        let (a, b) = (first(a), first(b));
        let mut pairs = Vec::new();
        let zipped = a.zip(&b, &mut |x, y, _| {
            pairs.push(EquationSides { lhs: x, rhs: y, span });
            x
        });
        if zipped.is_none() || matches!(a, ModelicaValue::Text(_)) {
            let code = if a.dims() == b.dims() { Code::TypeMismatch } else { Code::SizeMismatch };
            self.instance.diagnostics.push(
                Diagnostic::new(code, "the two sides of this equation do not fit")
                    .at(span, format!("{} on the left, {} on the right", a.describe(), b.describe())),
            );
            return;
        }
        out.extend(pairs);
    }

    /// Reads an `if` equation. A condition over parameters selects its branch now (MLS 8.3.4); any other becomes part
    /// of conditional equations.
    ///
    /// `branches` are the conditions with their equations, `otherwise` is the `else` branch. The function calls itself
    /// for the branches after the first. A condition that is no Boolean is reported (E210).
    pub(super) fn if_equation(
        &mut self,
        branches: &'a [(Expr, Vec<ast::Equation>)],
        otherwise: &'a [ast::Equation],
        view: LookupContext,
        span: Span,
        out: &mut Vec<EquationSides>,
    ) {
        let Some(((condition, body), rest)) = branches.split_first() else {
            for e in otherwise {
                self.equation(e, view, out);
            }
            return;
        };
        let Some(c) = self.instance.evaluator().eval(condition, view) else { return };
        let Some((test, ScalarType::Boolean)) = c.scalar() else {
            self.instance.diagnostics.push(
                Diagnostic::new(Code::TypeMismatch, "a condition must be a Boolean")
                    .at(condition.span, format!("this is {}", c.describe())),
            );
            return;
        };
        // A parameter that is found at the start is not known now.
        if self.instance.variability(test) <= Variability::Parameter && !self.instance.found_at_start(test) {
            match self.instance.evaluator().constant_boolean(condition, view) {
                Some(true) => {
                    for e in body {
                        self.equation(e, view, out);
                    }
                }
                Some(false) => self.if_equation(rest, otherwise, view, span, out),
                None => {}
            }
            return;
        }
        // Both branches are read, each under its condition, with the following branches nested in `else`.
        self.guards.push(test);
        let a = self.equations(body, view);
        self.guards.pop();
        let not = self.instance.exprs.not(test);
        self.guards.push(not);
        let mut b = Vec::new();
        self.if_equation(rest, otherwise, view, span, &mut b);
        self.guards.pop();
        self.merge(test, a, b, span, out);
    }

    /// Merges the equations of two branches into conditional ones: `if c then a = x; else a = y;` becomes
    /// `a = if c then x else y`. Branches must have the same number of equations (MLS 8.3.4).
    ///
    /// `a` are the equations of the branch for `test`, `b` those of the other one. Different numbers are reported
    /// (E201).
    pub(super) fn merge(
        &mut self,
        test: ExprId,
        a: Vec<EquationSides>,
        mut b: Vec<EquationSides>,
        span: Span,
        out: &mut Vec<EquationSides>,
    ) {
        if a.len() != b.len() {
            self.instance.diagnostics.push(
                Diagnostic::new(Code::Balance, "the branches of this `if` have different numbers of equations")
                    .at(span, format!("{} in one, {} in another", a.len(), b.len()))
                    .help("each branch must determine the same variables when the condition can change during the run"),
            );
            return;
        }
        let pool = &mut self.instance.exprs;
        for p in a {
            // Equations with the same left side belong together; the others are paired in their order.
            let at = b.iter().position(|q| q.lhs == p.lhs).unwrap_or(0);
            let q = b.remove(at);
            let span = p.span;
            if p.lhs == q.lhs {
                out.push(EquationSides { lhs: p.lhs, rhs: pool.if_(test, p.rhs, q.rhs), span });
            } else {
                // Different left sides: the residuals are selected instead.
                let (x, y) = (pool.sub(p.lhs, p.rhs), pool.sub(q.lhs, q.rhs));
                out.push(EquationSides { lhs: pool.if_(test, x, y), rhs: Exprs::ZERO, span });
            }
        }
    }

    /// Reads `Connections.conserved(quantity, rate, state)`, of scalars. It is no statement of the MLS but of this
    /// compiler.
    /// Wrong arguments are reported (E021).
    pub(super) fn conserved(&mut self, call: &'a Expr, view: LookupContext, span: Span) {
        const FORM: &str =
            "`Connections.conserved(quantity, rate, state)` takes three real numbers, the last one a variable";
        let ExprKind::Call { args, .. } = &call.kind else { return };
        let mut values = Vec::with_capacity(args.len());
        for arg in args {
            let Some(value) = self.instance.evaluator().eval(arg, view) else { return };
            values.extend(value.scalar().filter(|(_, ty)| *ty == ScalarType::Real).map(|(e, _)| e));
        }
        let origin = self.origin(span, view);
        match values[..] {
            [quantity, rate, state] if matches!(self.instance.exprs.node(state), ExprNode::Var(_)) => {
                self.flat.conserved.push(ConservationDeclaration { quantity, rate, state, origin });
            }
            _ => self.bad_call(span, FORM),
        }
    }

    /// A condition that needs to hold at the start only.
    /// It is `initial()` implies the condition.
    pub(super) fn at_start_only(&mut self, condition: ExprId) -> ExprId {
        let start = self.instance.exprs.intern(ExprNode::Initial);
        self.instance.exprs.implies(start, condition)
    }

    /// Reports a call that is not as it must be.
    /// The code is E021.
    pub(super) fn bad_call(&mut self, span: Span, message: &str) {
        self.instance.diagnostics.push(Diagnostic::new(Code::BadCall, message).at(span, ""));
    }

    /// Reports a call that is allowed inside `when` only.
    /// The help shows a `when` around the call.
    pub(super) fn only_in_when(&mut self, name: &str, span: Span) {
        self.instance.diagnostics.push(
            Diagnostic::new(Code::BadCall, format!("`{name}` can only stand inside a `when`"))
                .at(span, "")
                .help("write `when condition then ... end when;` around it"),
        );
    }

    /// Reads an equation that is a call: `assert`, a statement about connections, or a function without results.
    ///
    /// `reinit` and `terminate` are reported, since they are allowed in `when` only. Assertions in a called function
    /// become assertions of the model.
    pub(super) fn call(&mut self, call: &'a Expr, view: LookupContext, span: Span) {
        let ExprKind::Call { function, .. } = &call.kind else { return };
        match function.parts[0].name.name.as_str() {
            "assert" => {
                let assert = self.assertion(call, view, span);
                self.push_guarded(assert);
            }
            "reinit" | "terminate" => {
                self.only_in_when(function.parts[0].name.name.as_str(), span);
            }
            // A statement about the connection graph, which `network` has read.
            "Connections" if network::is_graph_statement(function) => {}
            "Connections" if function.parts.get(1).is_some_and(|p| p.name.name.as_str() == "conserved") => {
                self.conserved(call, view, span);
            }
            _ => {
                for call in self.instance.statements().call_keeping_assertions(call, view) {
                    let origin = self.origin(call.span, view);
                    let assert = assert_of(self.instance, call, origin);
                    self.push_guarded(assert);
                }
            }
        }
    }

    /// Appends an assertion under the conditions around it. One that always holds is dropped.
    /// The guards become premises: `g` implies the condition.
    pub(super) fn push_guarded(&mut self, assert: Option<FlatAssertion>) {
        let Some(mut assert) = assert else { return };
        for guard in self.guards.clone().into_iter().rev() {
            assert.condition = self.instance.exprs.implies(guard, assert.condition);
        }
        if assert.condition != Exprs::ONE {
            self.flat.asserts.push(assert);
        }
    }

    /// Reads an `assert`. `None` after a message.
    /// The level is `error` or `warning`.
    pub(super) fn assertion(&mut self, call: &'a Expr, view: LookupContext, span: Span) -> Option<FlatAssertion> {
        let AssertArguments { condition, message: text, warning } = self.instance.statements().assertion(call, view)?;
        Some(FlatAssertion { condition, message: message(text), warning, origin: self.origin(span, view) })
    }
}

/// Appends assertions that expressions need to have a meaning, each once. `holder` is the component that contains the
/// expressions.
/// One call may come up more than once.
pub(super) fn watch(instance: &mut Instance<'_, '_>, flat: &mut FlatModel, calls: Vec<AlgorithmCall>, holder: u32) {
    for call in calls {
        let origin = ElementOrigin { span: call.span, instance: holder, kind: OriginKind::Declared };
        let Some(assert) = assert_of(instance, call, origin) else { continue };
        // Only the last few assertions are compared, so that the search stays short.
        let known = |a: &FlatAssertion| a.condition == assert.condition && a.origin.span == origin.span;
        if assert.condition != Exprs::ONE && !flat.asserts.iter().rev().take(8).any(known) {
            flat.asserts.push(assert);
        }
    }
}

/// An `assert` of an algorithm or function as one of the model; `None` for a `terminate`, which has no condition.
pub(super) fn assert_of(
    instance: &mut Instance<'_, '_>,
    call: AlgorithmCall,
    origin: ElementOrigin,
) -> Option<FlatAssertion> {
    let condition = instance.exprs.implies(call.guard, call.condition?);
    Some(FlatAssertion { condition, message: message(call.message), warning: call.warning, origin })
}

/// The template of a message text, with adjacent texts joined. Empty without a text.
/// Values stay expressions and are evaluated when the message is shown.
pub(super) fn message(text: Option<ModelicaValue>) -> MessageTemplate {
    match text {
        Some(ModelicaValue::Text(parts)) => {
            let mut joined: Vec<MessagePart> = Vec::new();
            for part in parts.iter() {
                match (joined.last_mut(), part) {
                    (Some(MessagePart::Text(a)), MessagePart::Text(b)) => a.push_str(b),
                    _ => joined.push(part.clone()),
                }
            }
            MessageTemplate { parts: joined }
        }
        _ => MessageTemplate::default(),
    }
}
