//! `when` equations: what becomes of variables at events (MLS 8.3.5).
//!
//! Enters: the branches of a `when` with their equations. Leaves: a `WhenClause` in which each branch lists its
//! actions, with loops unrolled and `if`s turned into guards. `EquationFlattener::equation` calls
//! [`EquationFlattener::when_equation`]; `structure` translates the clauses into discrete equations.

use super::equations::{EquationFlattener, EquationSides, message};
use super::{Variability, WhenAction, WhenBranch, WhenClause};
use crate::instance::LookupContext;
use crate::instance::value::ModelicaValue;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::ast::{self, EquationKind, Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};

impl<'a> EquationFlattener<'_, 'a, '_> {
    /// Reads a `when` equation and appends its clause. All branches must determine the same variables.
    ///
    /// `branches` are the `when` and its `elsewhen`s in order of priority; a condition may be an array, any element of
    /// which fires the branch. Branches that determine different variables are reported (E201).
    /// Conditions that cannot be evaluated drop their branch; they have a message already.
    pub(super) fn when_equation(
        &mut self,
        branches: &'a [(Expr, Vec<ast::Equation>)],
        view: LookupContext,
        span: Span,
    ) {
        let mut when = WhenClause { branches: Vec::new(), origin: self.origin(span, view) };
        let mut first: Option<Vec<VarId>> = None;
        for (condition, body) in branches {
            let Some(conditions) = self.instance.statements().when_conditions(condition, view) else { continue };
            self.watch(view);
            let mut actions = Vec::new();
            // The body is evaluated at the event, so relations in it make no events of their own.
            let was = self.instance.statements().set_no_event(true);
            for e in body {
                self.when_body(e, view, Exprs::ONE, &mut actions);
            }
            self.instance.statements().set_no_event(was);
            when.branches.push(WhenBranch { conditions, actions });
            // The list starts empty for each branch.
            let here = std::mem::take(&mut self.determined);
            match &first {
                Some(first) => self.same_variables(first, &here, "when", condition.span),
                None => first = Some(here),
            }
        }
        self.flat.whens.push(when);
    }

    /// Reports two lists of variables that differ: the branches of a `when`, and of an `if` in it, must determine the
    /// same variables (MLS 8.3.5.2). `of` is `when` or `if`.
    ///
    /// The message names one variable that differs and whether it is missing here or extra. The help writes `v =
    /// pre(v)`, which keeps the value. The code is E201.
    /// Nothing happens if the lists agree, whatever their order.
    pub(super) fn same_variables(&mut self, a: &[VarId], b: &[VarId], of: &str, span: Span) {
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

    /// Reports a `when` inside an `if` equation whose condition changes during the run.
    /// The help moves the condition into the `when`. The code is E021.
    /// Such a clause would act at some times only.
    pub(super) fn when_under_if(&mut self, span: Span) {
        let message = "a `when` cannot stand inside an `if` whose condition changes during the run";
        self.instance.diagnostics.push(
            Diagnostic::new(Code::BadCall, message)
                .at(span, "this would act at some times only")
                .help("put the condition into the `when`: `when c and other then`"),
        );
    }

    /// Reads one equation in a `when` and appends its actions to `out`. `guard` is the condition of the `if`s around it
    /// inside the `when`.
    ///
    /// Allowed are equations, `for`, `if` and calls; a `when` or `connect` inside is reported. Array equations give one
    /// action for each element.
    ///
    /// Assertions of called functions become actions of the branch.
    pub(super) fn when_body(
        &mut self,
        e: &'a ast::Equation,
        view: LookupContext,
        guard: ExprId,
        out: &mut Vec<WhenAction>,
    ) {
        match &e.kind {
            EquationKind::Equal(l, r) => {
                let mut pairs = Vec::new();
                self.equal(l, r, view, e.span, &mut pairs);
                // Assertions of functions that the equation calls become actions: they are checked at the event only.
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

    /// Unrolls a `for` equation inside a `when`.
    /// The range must be known before the run, as in other equations.
    /// One action per element and value results.
    /// The local name of the iterator exists only while its body is read.
    pub(super) fn when_for(
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

    /// Reads an `if` equation inside a `when`: both branches are read, each with its condition as an additional guard.
    ///
    /// The guard of a branch is its condition and not that of any earlier branch. The actions of all branches go to one
    /// list; the assignments to one variable are merged by [`Self::when_assign`]. Branches that determine different
    /// variables are reported (E201), because the MLS demands it of conditions that change.
    /// An `if` without `else` has an empty last branch.
    pub(super) fn when_if(
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
        // A condition known before the run selects one branch for the whole run, so the branches may determine
        // different variables.
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
        // What both branches determine is determined once by the whole `if`.
        for &v in first.iter().filter(|v| second.contains(v)) {
            self.determine(v, condition.span);
        }
    }

    /// Records that the branch determines a variable. False, with a message, if it does so already.
    /// The code is E303. The list is that of the branch being read: see `EquationFlattener::determined`.
    pub(super) fn determine(&mut self, variable: VarId, span: Span) -> bool {
        let again = self.determined.contains(&variable);
        if again {
            self.twice(variable, "is determined twice by one branch of a `when`", span);
        } else {
            self.determined.push(variable);
        }
        !again
    }

    /// Reports that a variable gets a value twice. `how` completes the sentence that begins with its name.
    /// The code is E303.
    /// The help is to remove one of the two.
    pub(super) fn twice(&mut self, variable: VarId, how: &str, span: Span) {
        let name = &self.flat.variables[variable.index()].name;
        let d = Diagnostic::new(Code::Overdetermined, format!("`{name}` {how}"));
        self.instance.diagnostics.push(d.at(span, "here again").help("remove one of the two"));
    }

    /// Appends an assignment. Under a guard that does not hold, the variable keeps what it would get otherwise: the
    /// value of an earlier assignment in the other branch of an `if`, or its `pre` value.
    ///
    /// The variable may be on either side; an equation without a lone variable is reported (E017). For `if g then x =
    /// a; else x = b; end if` the result is one action `x = if not g then b else if g then a else pre(x)`.
    pub(super) fn when_assign(
        &mut self,
        p: EquationSides,
        view: LookupContext,
        guard: ExprId,
        out: &mut Vec<WhenAction>,
    ) {
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

    /// Reads `reinit`, `assert`, `terminate` or a function without outputs in a `when`.
    ///
    /// `reinit` of an array gives one action for each element. Two `reinit`s of one variable are reported (E303) if
    /// they have the same guard or one of them has none. A function with outputs is reported (E021).
    /// Messages of `assert` and `terminate` may contain values.
    pub(super) fn when_call(
        &mut self,
        call: &'a Expr,
        view: LookupContext,
        guard: ExprId,
        span: Span,
        out: &mut Vec<WhenAction>,
    ) {
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
                    // Two `reinit`s under different conditions may exclude each other; only certain conflicts are
                    // reported.
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
            // A function without outputs may assert something; other effects are invisible to a model.
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
}
