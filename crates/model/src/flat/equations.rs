//! Equation and algorithm sections of every component, made scalar.

use super::numbers::ComponentNumbers;
use super::{
    ConservationDeclaration, ElementOrigin, FlatAssertion, FlatEquation, FlatModel, MessagePart, MessageTemplate,
    OriginKind, ScalarType, Variability, WhenAction, WhenBranch, WhenClause,
};
use crate::instance::algorithm::{AlgorithmBranch, AlgorithmCall, AlgorithmWhen, AssertArguments, assigned};
use crate::instance::value::ModelicaValue;
use crate::instance::{Instance, LookupContext, ScopeId};
use crate::network;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::ast::{self, ClassBody, EquationKind, Expr, ExprKind, Statement};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashSet;

/// Scalar sides of an equation with the place it comes from.
struct EquationSides {
    lhs: ExprId,
    rhs: ExprId,
    span: Span,
}

pub(super) struct EquationFlattener<'w, 'a, 'l> {
    instance: &'w mut Instance<'a, 'l>,
    numbers: &'w ComponentNumbers,
    flat: &'w mut FlatModel,
    /// Assertions met inside the equations of an `if` with their conditions.
    guards: Vec<ExprId>,
    /// Variables determined so far by the branch of a `when` that is being walked.
    determined: Vec<VarId>,
}

impl<'w, 'a, 'l> EquationFlattener<'w, 'a, 'l> {
    pub(super) fn new(
        instance: &'w mut Instance<'a, 'l>,
        numbers: &'w ComponentNumbers,
        flat: &'w mut FlatModel,
    ) -> Self {
        EquationFlattener { instance, numbers, flat, guards: Vec::new(), determined: Vec::new() }
    }

    pub(super) fn walk(&mut self, scopes: &[ScopeId]) {
        for &scope in scopes {
            let mark = self.instance.diagnostics.len();
            let template = self.instance.scope(scope).template.clone();
            for (base, i) in template.bases.iter().zip(0u32..) {
                let ClassBody::Long(body) = &base.ast.body else { continue };
                self.body(body, LookupContext { scope, base: i });
            }
            if self.instance.diagnostics.len() > mark
                && let Some(outermost) = self.instance.outermost(scope)
            {
                let (name, span) = (self.instance.scope(outermost).name.clone(), self.instance.scope(outermost).span);
                self.instance.point_at(mark, &name, span);
            }
        }
    }

    fn body(&mut self, body: &'a ast::LongBody, view: LookupContext) {
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

    fn origin(&self, span: Span, view: LookupContext) -> ElementOrigin {
        let instance = self.numbers.of(view.scope);
        ElementOrigin { span, instance, kind: OriginKind::Declared }
    }

    fn push(&mut self, pairs: Vec<EquationSides>, view: LookupContext, initial: bool) {
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

    /// Scalar equations of a list; `when` and `assert` go straight into the flat model.
    fn equations(&mut self, equations: &'a [ast::Equation], view: LookupContext) -> Vec<EquationSides> {
        let mut pairs = Vec::new();
        for e in equations {
            self.equation(e, view, &mut pairs);
            self.watch(view);
        }
        pairs
    }

    /// What the equation just read needs to have a meaning, under the conditions around it.
    fn watch(&mut self, view: LookupContext) {
        let mut calls = self.instance.statements().take_calls();
        for call in &mut calls {
            for &guard in &self.guards {
                call.guard = self.instance.exprs.and(guard, call.guard);
            }
        }
        watch(self.instance, self.flat, calls, self.numbers.of(view.scope));
    }

    fn equation(&mut self, e: &'a ast::Equation, view: LookupContext, out: &mut Vec<EquationSides>) {
        match &e.kind {
            EquationKind::Connect(..) => {}
            EquationKind::Equal(l, r) => self.equal(l, r, view, e.span, out),
            EquationKind::For { iterators, body } => self.for_equation(iterators, body, view, out),
            EquationKind::If { branches, otherwise } => self.if_equation(branches, otherwise, view, e.span, out),
            EquationKind::When(_) if !self.guards.is_empty() => self.when_under_if(e.span),
            EquationKind::When(branches) => self.when_equation(branches, view, e.span),
            EquationKind::Call(call) => self.call(call, view, e.span),
        }
    }

    fn for_equation(
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

    fn equal(&mut self, l: &'a Expr, r: &'a Expr, view: LookupContext, span: Span, out: &mut Vec<EquationSides>) {
        if let ExprKind::Tuple(targets) = &l.kind {
            self.tuple(targets, r, view, span, out);
            return;
        }
        let (a, b) = (self.instance.evaluator().eval(l, view), self.instance.evaluator().eval(r, view));
        if let (Some(a), Some(b)) = (a, b) {
            self.equal_values(&a, &b, span, out);
        }
    }

    fn tuple(
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

    fn equal_values(&mut self, a: &ModelicaValue, b: &ModelicaValue, span: Span, out: &mut Vec<EquationSides>) {
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

    /// An `if` decided by parameters is decided now; another becomes conditional equations.
    fn if_equation(
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

    /// `if c then a = x; else a = y;` becomes `a = if c then x else y`; branches must have equally many equations.
    fn merge(
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
            let at = b.iter().position(|q| q.lhs == p.lhs).unwrap_or(0);
            let q = b.remove(at);
            let span = p.span;
            if p.lhs == q.lhs {
                out.push(EquationSides { lhs: p.lhs, rhs: pool.if_(test, p.rhs, q.rhs), span });
            } else {
                let (x, y) = (pool.sub(p.lhs, p.rhs), pool.sub(q.lhs, q.rhs));
                out.push(EquationSides { lhs: pool.if_(test, x, y), rhs: Exprs::ZERO, span });
            }
        }
    }

    fn when_equation(&mut self, branches: &'a [(Expr, Vec<ast::Equation>)], view: LookupContext, span: Span) {
        let mut when = WhenClause { branches: Vec::new(), origin: self.origin(span, view) };
        let mut first: Option<Vec<VarId>> = None;
        for (condition, body) in branches {
            let Some(conditions) = self.instance.statements().when_conditions(condition, view) else { continue };
            self.watch(view);
            let mut actions = Vec::new();
            let was = self.instance.statements().set_no_event(true);
            for e in body {
                self.when_body(e, view, Exprs::ONE, &mut actions);
            }
            self.instance.statements().set_no_event(was);
            when.branches.push(WhenBranch { conditions, actions });
            let here = std::mem::take(&mut self.determined);
            match &first {
                Some(first) => self.same_variables(first, &here, "when", condition.span),
                None => first = Some(here),
            }
        }
        self.flat.whens.push(when);
    }

    /// The branches of a `when`, and of an `if` in it, must determine the same variables (MLS 8.3.5.2).
    fn same_variables(&mut self, a: &[VarId], b: &[VarId], of: &str, span: Span) {
        let alone = |a: &[VarId], b: &[VarId]| a.iter().find(|v| !b.contains(v)).copied();
        let (where_, variable) = match (alone(a, b), alone(b, a)) {
            (Some(v), _) if of == "when" => ("is not determined here", v),
            (Some(v), _) | (None, Some(v)) => ("is determined only here", v),
            (None, None) => return,
        };
        let name = &self.flat.variables[variable.index()].name;
        let message = format!("the branches of this `{of}` determine different variables");
        let help = match of {
            "if" => format!("give it a value in each branch, `else` too: `{name} = pre({name})` keeps the one it has"),
            _ => format!("give it a value in each branch: `{name} = pre({name})` keeps the one it has"),
        };
        let d = Diagnostic::new(Code::Balance, message).at(span, format!("`{name}` {where_}")).help(help);
        self.instance.diagnostics.push(d);
    }

    fn when_under_if(&mut self, span: Span) {
        let message = "a `when` cannot stand inside an `if` whose condition changes during the run";
        self.instance.diagnostics.push(
            Diagnostic::new(Code::BadCall, message)
                .at(span, "this would act at some times only")
                .help("put the condition into the `when`: `when c and other then`"),
        );
    }

    fn when_body(&mut self, e: &'a ast::Equation, view: LookupContext, guard: ExprId, out: &mut Vec<WhenAction>) {
        match &e.kind {
            EquationKind::Equal(l, r) => {
                let mut pairs = Vec::new();
                self.equal(l, r, view, e.span, &mut pairs);
                for mut call in self.instance.statements().take_calls() {
                    call.guard = self.instance.exprs.and(guard, call.guard);
                    self.algorithm_action(call, view, out);
                }
                for p in pairs {
                    self.when_assign(p, view, guard, out);
                }
            }
            EquationKind::For { iterators, body } => self.when_for(iterators, body, view, guard, out),
            EquationKind::If { branches, otherwise } => self.when_if(branches, otherwise, view, guard, out),
            EquationKind::Call(call) => self.when_call(call, view, guard, e.span, out),
            EquationKind::When(_) => {
                self.instance
                    .diagnostics
                    .push(Diagnostic::new(Code::Unsupported, "a `when` cannot stand inside a `when`").at(e.span, ""));
            }
            EquationKind::Connect(..) => {
                self.instance
                    .diagnostics
                    .push(Diagnostic::new(Code::BadConnect, "`connect` cannot stand inside a `when`").at(e.span, ""));
            }
        }
    }

    fn when_for(
        &mut self,
        iterators: &'a [ast::ForIndex],
        body: &'a [ast::Equation],
        view: LookupContext,
        guard: ExprId,
        out: &mut Vec<WhenAction>,
    ) {
        let Some((first, rest)) = iterators.split_first() else {
            for e in body {
                self.when_body(e, view, guard, out);
            }
            return;
        };
        let Some(values) = self.instance.statements().loop_values(first, body, view) else { return };
        for value in values {
            self.instance.statements().push_local(first.name.name, value);
            self.when_for(rest, body, view, guard, out);
            self.instance.statements().pop_local();
        }
    }

    fn when_if(
        &mut self,
        branches: &'a [(Expr, Vec<ast::Equation>)],
        otherwise: &'a [ast::Equation],
        view: LookupContext,
        guard: ExprId,
        out: &mut Vec<WhenAction>,
    ) {
        let Some(((condition, body), rest)) = branches.split_first() else {
            for e in otherwise {
                self.when_body(e, view, guard, out);
            }
            return;
        };
        let Some(test) = self.instance.evaluator().eval(condition, view).and_then(|c| c.scalar()).map(|(e, _)| e)
        else {
            return;
        };
        let pool = &mut self.instance.exprs;
        let yes = pool.and(guard, test);
        let no = pool.not(test);
        let no = pool.and(guard, no);
        // known before the run: which branch remains is for the parameter to say, so only what all determine counts
        let chosen = self.instance.variability(test) <= Variability::Parameter;
        let before = std::mem::take(&mut self.determined);
        for e in body {
            self.when_body(e, view, yes, out);
        }
        let first = std::mem::take(&mut self.determined);
        self.when_if(rest, otherwise, view, no, out);
        let second = std::mem::replace(&mut self.determined, before);
        if !chosen {
            self.same_variables(&first, &second, "if", condition.span);
        }
        for &v in first.iter().filter(|v| second.contains(v)) {
            self.determine(v, condition.span);
        }
    }

    /// Notes what a branch of a `when` determines; false, with a message, if it already does.
    fn determine(&mut self, variable: VarId, span: Span) -> bool {
        let again = self.determined.contains(&variable);
        if again {
            self.twice(variable, "is determined twice by one branch of a `when`", span);
        } else {
            self.determined.push(variable);
        }
        !again
    }

    fn twice(&mut self, variable: VarId, how: &str, span: Span) {
        let name = &self.flat.variables[variable.index()].name;
        let d = Diagnostic::new(Code::Overdetermined, format!("`{name}` {how}"));
        self.instance.diagnostics.push(d.at(span, "here again").help("remove one of the two"));
    }

    /// An assignment; under a guard the variable keeps what it would otherwise get.
    fn when_assign(&mut self, p: EquationSides, view: LookupContext, guard: ExprId, out: &mut Vec<WhenAction>) {
        let pool = &mut self.instance.exprs;
        let (variable, value) = match (pool.node(p.lhs), pool.node(p.rhs)) {
            (ExprNode::Var(v), _) => (v, p.rhs),
            (_, ExprNode::Var(v)) => (v, p.lhs),
            _ => {
                self.instance.diagnostics.push(
                    Diagnostic::new(Code::Unsupported, "an equation in a `when` must have a variable on its left side")
                        .at(p.span, "solve it for the variable it determines"),
                );
                return;
            }
        };
        if !self.determine(variable, p.span) {
            return;
        }
        let origin = self.origin(p.span, view);
        let earlier = out.iter_mut().find_map(|a| match a {
            WhenAction::Assign { variable: v, value, .. } if *v == variable => Some(value),
            _ => None,
        });
        let pool = &mut self.instance.exprs;
        match earlier {
            Some(old) if guard != Exprs::ONE => *old = pool.if_(guard, value, *old),
            _ => {
                let pre = pool.pre(variable);
                let value = pool.if_(guard, value, pre);
                out.push(WhenAction::Assign { variable, value, origin });
            }
        }
    }

    fn when_call(&mut self, call: &'a Expr, view: LookupContext, guard: ExprId, span: Span, out: &mut Vec<WhenAction>) {
        let ExprKind::Call { function, args, .. } = &call.kind else { return };
        let origin = self.origin(span, view);
        match function.parts[0].name.name.as_str() {
            "reinit" => {
                let [target, value] = args.as_slice() else {
                    self.bad_call(span, "`reinit` takes a variable and its new value");
                    return;
                };
                let (Some(t), Some(v)) =
                    (self.instance.evaluator().eval(target, view), self.instance.evaluator().eval(value, view))
                else {
                    return;
                };
                let mut pairs = Vec::new();
                self.equal_values(&t, &v, span, &mut pairs);
                for p in pairs {
                    let ExprNode::Var(variable) = self.instance.exprs.node(p.lhs) else {
                        self.bad_call(span, "`reinit` needs a variable as its first argument");
                        return;
                    };
                    // under conditions of their own they may exclude each other
                    let meets = |earlier: ExprId| earlier == guard || earlier == Exprs::ONE || guard == Exprs::ONE;
                    let again = |a: &WhenAction| match a {
                        WhenAction::Reinit { variable: v, guard, .. } => *v == variable && meets(*guard),
                        _ => false,
                    };
                    if out.iter().any(again) {
                        self.twice(variable, "gets a new value twice from one branch of a `when`", p.span);
                        return;
                    }
                    out.push(WhenAction::Reinit { variable, value: p.rhs, guard, origin });
                }
            }
            "assert" => {
                if let Some(mut a) = self.assertion(call, view, span) {
                    a.condition = self.instance.exprs.implies(guard, a.condition);
                    out.push(WhenAction::Assert(a));
                }
            }
            "terminate" => {
                let text = args.first().and_then(|m| self.instance.evaluator().eval(m, view));
                out.push(WhenAction::Terminate { message: message(text), guard, origin });
            }
            // a function without outputs says what must hold, or does what no model can see
            _ => match self.instance.evaluator().eval_all(call, view) {
                Some(ModelicaValue::Tuple(values)) if values.is_empty() => {}
                None => {}
                _ => self.bad_call(
                    span,
                    "only `reinit`, `assert`, `terminate` and functions without outputs can be called here",
                ),
            },
        }
    }

    /// `Connections.conserved(quantity, rate, state)`, of scalars.
    fn conserved(&mut self, call: &'a Expr, view: LookupContext, span: Span) {
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

    fn at_start_only(&mut self, condition: ExprId) -> ExprId {
        let start = self.instance.exprs.intern(ExprNode::Initial);
        self.instance.exprs.implies(start, condition)
    }

    fn bad_call(&mut self, span: Span, message: &str) {
        self.instance.diagnostics.push(Diagnostic::new(Code::BadCall, message).at(span, ""));
    }

    fn only_in_when(&mut self, name: &str, span: Span) {
        self.instance.diagnostics.push(
            Diagnostic::new(Code::BadCall, format!("`{name}` can only stand inside a `when`"))
                .at(span, "")
                .help("write `when condition then ... end when;` around it"),
        );
    }

    fn call(&mut self, call: &'a Expr, view: LookupContext, span: Span) {
        let ExprKind::Call { function, .. } = &call.kind else { return };
        match function.parts[0].name.name.as_str() {
            "assert" => {
                let assert = self.assertion(call, view, span);
                self.push_guarded(assert);
            }
            "reinit" | "terminate" => {
                self.only_in_when(function.parts[0].name.name.as_str(), span);
            }
            // a statement about the connection graph, which `network` has read
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

    /// An assertion in the branches of the `if` equations around it.
    fn push_guarded(&mut self, assert: Option<FlatAssertion>) {
        let Some(mut assert) = assert else { return };
        for guard in self.guards.clone().into_iter().rev() {
            assert.condition = self.instance.exprs.implies(guard, assert.condition);
        }
        if assert.condition != Exprs::ONE {
            self.flat.asserts.push(assert);
        }
    }

    fn assertion(&mut self, call: &'a Expr, view: LookupContext, span: Span) -> Option<FlatAssertion> {
        let AssertArguments { condition, message: text, warning } = self.instance.statements().assertion(call, view)?;
        Some(FlatAssertion { condition, message: message(text), warning, origin: self.origin(span, view) })
    }

    /// An algorithm section: every variable it assigns gets the value it has at the end (MLS 11.1).
    fn algorithm(&mut self, section: &'a [Statement], view: LookupContext, initial: bool) {
        let (mut always, mut in_when) = (Vec::new(), Vec::new());
        assigned(section, false, &mut always, &mut in_when);
        let mut originals: Vec<AlgorithmTarget> = Vec::new();
        let mut count = 0;
        for name in always.iter().chain(&in_when).map(|r| r.parts[0].name.name) {
            if originals.iter().any(|o| o.name == name) {
                continue;
            }
            let of = |targets: &[&'a ast::ComponentReference]| -> Vec<&'a ast::ComponentReference> {
                targets.iter().copied().filter(|r| r.parts[0].name.name == name).collect()
            };
            let (always, in_when) = (of(&always), of(&in_when));
            let targets: Vec<&'a ast::ComponentReference> = always.iter().chain(&in_when).copied().collect();
            let Some(own) = self.instance.statements().assigned_value(view, &targets) else { return };
            let scalars = |targets: &[&'a ast::ComponentReference]| {
                let mut found = FxHashSet::default();
                let below: Vec<&[ast::ReferencePart]> = targets.iter().map(|r| &r.parts[1..]).collect();
                scalars_of(&own, &below, &mut found);
                found
            };
            let (all, in_when) = (scalars(&targets), scalars(&in_when));
            let start = self.algorithm_start(&own, &all, &in_when);
            originals.push(AlgorithmTarget { name, own, in_when });
            self.instance.statements().push_local(name, start);
            count += 1;
        }
        let done = self.instance.statements().run_section(section, view, count);
        let results: Vec<ModelicaValue> = self.instance.statements().take_locals(count);
        let whens = self.instance.statements().take_whens();
        let calls = self.instance.statements().take_calls();
        if done.is_none() {
            self.section_failed(section);
            return;
        }
        self.section_results(&originals, &results, &whens, view, section, initial);
        for when in in_order(self.instance, whens, &originals) {
            self.algorithm_when(when, &originals, view);
        }
        for call in calls {
            self.algorithm_call(call, view, initial);
        }
    }

    /// An `assert` or `terminate` of an algorithm section outside `when`; one of an initial section counts at the start only.
    fn algorithm_call(&mut self, call: AlgorithmCall, view: LookupContext, initial: bool) {
        let span = call.span;
        let origin = self.origin(span, view);
        if call.condition.is_none() && initial {
            let mut actions = Vec::new();
            self.algorithm_action(call, view, &mut actions);
            let conditions = vec![self.instance.exprs.intern(ExprNode::Initial)];
            self.flat.whens.push(WhenClause { branches: vec![WhenBranch { conditions, actions }], origin });
            return;
        }
        let Some(mut assert) = assert_of(self.instance, call, origin) else {
            self.only_in_when("terminate", span);
            return;
        };
        if initial {
            assert.condition = self.at_start_only(assert.condition);
        }
        if assert.condition != Exprs::ONE {
            self.flat.asserts.push(assert);
        }
    }

    /// An `assert` or `terminate` inside a `when` of an algorithm section.
    fn algorithm_action(&mut self, call: AlgorithmCall, view: LookupContext, out: &mut Vec<WhenAction>) {
        let origin = self.origin(call.span, view);
        if call.condition.is_none() {
            out.push(WhenAction::Terminate { message: message(call.message), guard: call.guard, origin });
            return;
        }
        out.extend(assert_of(self.instance, call, origin).map(WhenAction::Assert));
    }

    fn section_failed(&mut self, section: &'a [Statement]) {
        if !self.instance.diagnostics.iter().any(Diagnostic::is_error)
            && let Some(first) = section.first()
        {
            self.instance.diagnostics.push(
                Diagnostic::new(
                    Code::Unsupported,
                    "this algorithm needs loops or indices that depend on changing values",
                )
                .at(first.span, "in the section that begins here")
                .help("move it into a function"),
            );
        }
    }

    /// What the variables that the section assigns hold before it: their `pre` value if discrete, their start value else.
    fn algorithm_start(
        &mut self,
        own: &ModelicaValue,
        assigned: &FxHashSet<ExprId>,
        in_when: &FxHashSet<ExprId>,
    ) -> ModelicaValue {
        let variables = &self.flat.variables;
        let pool = &mut self.instance.exprs;
        own.map(&mut |e, ty| match pool.node(e) {
            ExprNode::Var(v) if in_when.contains(&e) || ty != ScalarType::Real && assigned.contains(&e) => pool.pre(v),
            ExprNode::Var(v) if assigned.contains(&e) => match variables[v.index()].variability {
                Variability::Discrete => pool.pre(v),
                _ => variables[v.index()].start.unwrap_or(Exprs::ZERO),
            },
            _ => e,
        })
    }

    /// The equations that the section comes to, for all that it does not hold between the events of its `when`s.
    fn section_results(
        &mut self,
        originals: &[AlgorithmTarget],
        results: &[ModelicaValue],
        whens: &[AlgorithmWhen],
        view: LookupContext,
        section: &'a [Statement],
        initial: bool,
    ) {
        let span = section.first().map_or(self.flat.instances[0].span, |s| s.span);
        for (AlgorithmTarget { name, own, in_when }, result) in originals.iter().zip(results) {
            let held = whens.iter().any(|w| w.branches.iter().any(|b| b.values.iter().any(|(n, _)| n == name)));
            let mut pairs = Vec::new();
            own.zip(result, &mut |x, y, _| {
                // a variable that nothing assigns is what it was
                if x != y && !(held && in_when.contains(&x)) {
                    pairs.push(EquationSides { lhs: x, rhs: y, span });
                }
                x
            });
            self.push(pairs, view, initial);
        }
    }

    fn algorithm_when(&mut self, when: AlgorithmWhen, originals: &[AlgorithmTarget], view: LookupContext) {
        let origin = self.origin(when.span, view);
        let mut made = WhenClause { branches: Vec::new(), origin };
        for branch in when.branches {
            let mut actions = Vec::new();
            for (name, value) in &branch.values {
                let Some(AlgorithmTarget { own, in_when, .. }) = originals.iter().find(|o| o.name == *name) else {
                    continue;
                };
                let (mut to, mut from) = (Vec::new(), Vec::new());
                own.scalars(&mut to);
                value.scalars(&mut from);
                for (t, value) in to.into_iter().zip(from).filter(|(t, _)| in_when.contains(t)) {
                    if let ExprNode::Var(variable) = self.instance.exprs.node(t) {
                        actions.push(WhenAction::Assign { variable, value, origin });
                    }
                }
            }
            for call in branch.calls {
                self.algorithm_action(call, view, &mut actions);
            }
            made.branches.push(WhenBranch { conditions: branch.conditions, actions });
        }
        self.flat.whens.push(made);
    }
}

/// An element of which an algorithm section assigns something.
struct AlgorithmTarget {
    name: Symbol,
    /// Its variables.
    own: ModelicaValue,
    /// Those that are assigned in a `when`.
    in_when: FxHashSet<ExprId>,
}

/// The scalars of a value that references name, which begin below it; of an array all, whatever its indices say.
fn scalars_of(value: &ModelicaValue, targets: &[&[ast::ReferencePart]], found: &mut FxHashSet<ExprId>) {
    match value {
        _ if targets.iter().any(|parts| parts.is_empty()) => found.extend(value.all_scalars()),
        ModelicaValue::Array { elements, .. } => {
            elements.iter().for_each(|element| scalars_of(element, targets, found))
        }
        ModelicaValue::Record(record) => {
            for (name, field) in &record.fields {
                let below: Vec<&[ast::ReferencePart]> =
                    targets.iter().filter(|parts| parts[0].name.name == *name).map(|parts| &parts[1..]).collect();
                if !below.is_empty() {
                    scalars_of(field, &below, found);
                }
            }
        }
        _ => {}
    }
}

/// Several `when`s of an algorithm that assign one variable become one: of those that fire at once the last one counts
/// (MLS 11.2.7). Where one of them reads what another one assigns, or a branch leaves the variable alone, they stay as they
/// are, and the variable is determined twice.
fn in_order(
    instance: &Instance<'_, '_>,
    mut whens: Vec<AlgorithmWhen>,
    originals: &[AlgorithmTarget],
) -> Vec<AlgorithmWhen> {
    let assigned = |w: &AlgorithmWhen| -> Vec<Symbol> {
        w.branches.iter().flat_map(|b| &b.values).map(|(name, _)| *name).collect()
    };
    let read = |w: &AlgorithmWhen, name: Symbol| {
        let own = originals.iter().find(|o| o.name == name).map(|o| o.own.all_scalars()).unwrap_or_default();
        let values: Vec<ExprId> =
            w.branches.iter().flat_map(|b| &b.values).flat_map(|(_, v)| v.all_scalars()).collect();
        let before = instance.exprs.dependencies(&values).pres;
        own.iter().any(|&e| matches!(instance.exprs.node(e), ExprNode::Var(v) if before.contains(&v)))
    };
    let mut seen: Vec<Symbol> = Vec::new();
    for name in whens.iter().flat_map(assigned).collect::<Vec<_>>() {
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let of: Vec<usize> = (0..whens.len()).filter(|&i| assigned(&whens[i]).contains(&name)).collect();
        let all = of.iter().all(|&i| whens[i].branches.iter().all(|b| b.values.iter().any(|(n, _)| *n == name)));
        let [first, .., last] = of[..] else { continue };
        if !all || of[1..].iter().any(|&i| read(&whens[i], name)) {
            continue;
        }
        let mut branches = Vec::new();
        for &i in of.iter().rev() {
            for branch in &mut whens[i].branches {
                let at = branch.values.iter().position(|(n, _)| *n == name).expect("seen above");
                let value = branch.values.remove(at);
                let conditions = branch.conditions.clone();
                branches.push(AlgorithmBranch { conditions, values: vec![value], calls: Vec::new() });
            }
        }
        let span = whens[first].span;
        whens.insert(last + 1, AlgorithmWhen { branches, span });
    }
    whens.retain(|w| w.branches.iter().any(|b| !b.values.is_empty() || !b.calls.is_empty()));
    whens
}

/// What expressions of an instance need to have a meaning, each once.
pub(super) fn watch(instance: &mut Instance<'_, '_>, flat: &mut FlatModel, calls: Vec<AlgorithmCall>, holder: u32) {
    for call in calls {
        let origin = ElementOrigin { span: call.span, instance: holder, kind: OriginKind::Declared };
        let Some(assert) = assert_of(instance, call, origin) else { continue };
        let known = |a: &FlatAssertion| a.condition == assert.condition && a.origin.span == origin.span;
        if assert.condition != Exprs::ONE && !flat.asserts.iter().rev().take(8).any(known) {
            flat.asserts.push(assert);
        }
    }
}

/// An `assert` of an algorithm as one of the model; `None` for a `terminate`.
pub(super) fn assert_of(
    instance: &mut Instance<'_, '_>,
    call: AlgorithmCall,
    origin: ElementOrigin,
) -> Option<FlatAssertion> {
    let condition = instance.exprs.implies(call.guard, call.condition?);
    Some(FlatAssertion { condition, message: message(call.message), warning: call.warning, origin })
}

fn message(text: Option<ModelicaValue>) -> MessageTemplate {
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
