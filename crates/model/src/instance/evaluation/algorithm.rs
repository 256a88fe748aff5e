//! Statements, executed on symbolic values: the result of an algorithm is an expression for each variable.
//!
//! Locals hold the values so far, and an assignment replaces one. Loops are unrolled if their range is known.
//! After an `if` with an unknown condition both results are merged: `x` becomes `if c then x1 else x2`.
//! If that is not possible, `not_inline` is set and `None` returned. The caller then makes a procedure of the function
//! or loop. In a model, `when` and `assert` are collected for `flat`.

use crate::instance::deduce::LoopBody;
use crate::instance::evaluation::indices::SubscriptValue;
use crate::instance::evaluation::indices::places;
use crate::instance::lookup::LookupResult;
use crate::instance::template::TemplateElementKind;
use crate::instance::value::{ModelicaValue, size_text};
use crate::instance::{LookupContext, Statements};
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{ExprId, Exprs, RelationalOp};
use bramah_syntax::ast::{
    ComponentDeclaration, ComponentReference, Expr, ExprKind, ReferencePart, Statement, StatementKind, Subscript,
};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// How a sequence of statements ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatementFlow {
    /// At its end.
    Next,
    /// By `break`.
    Break,
    /// By `return`.
    Return,
    /// By `break` if the condition holds, otherwise at its end.
    BreakIf(ExprId),
}

impl StatementFlow {
    /// The condition under which the loop around is left by `break`. `None` after a `return`, which leaves the
    /// function.
    fn left(self) -> Option<ExprId> {
        match self {
            StatementFlow::Next => Some(Exprs::ZERO),
            StatementFlow::Break => Some(Exprs::ONE),
            StatementFlow::BreakIf(condition) => Some(condition),
            StatementFlow::Return => None,
        }
    }

    /// The flow for a loop that is left under a condition.
    fn leaving(condition: ExprId) -> StatementFlow {
        match condition {
            Exprs::ZERO => StatementFlow::Next,
            Exprs::ONE => StatementFlow::Break,
            condition => StatementFlow::BreakIf(condition),
        }
    }
}

/// A `when` statement of an algorithm section of a model, with the conditions and assigned values of each branch.
#[derive(Clone, Debug)]
pub struct AlgorithmWhen {
    /// The branches `when`, `elsewhen` and so on. An earlier one has priority.
    pub branches: Vec<AlgorithmBranch>,
    /// Where it stands, for messages.
    pub span: Span,
}

/// One branch of an [`AlgorithmWhen`].
#[derive(Clone, Debug)]
pub struct AlgorithmBranch {
    /// The conditions. The branch is activated when any of them becomes true.
    pub conditions: Vec<ExprId>,
    /// The assigned locals with their new values. The name is the first part of the assigned references.
    pub values: Vec<(Symbol, ModelicaValue)>,
    /// The `assert` and `terminate` calls in the branch.
    pub calls: Vec<AlgorithmCall>,
}

/// An `assert` or `terminate` of an algorithm section of a model. Its expressions use the values at its place.
#[derive(Clone, Debug)]
pub struct AlgorithmCall {
    /// The condition that must hold; `None` for `terminate`.
    pub condition: Option<ExprId>,
    /// The condition under which the statement is reached.
    pub guard: ExprId,
    /// Its message text.
    pub message: Option<ModelicaValue>,
    /// The level is `AssertionLevel.warning`.
    pub warning: bool,
    /// Where it stands, for messages.
    pub span: Span,
}

/// The evaluated arguments of an `assert`.
#[derive(Clone, Debug)]
pub struct AssertArguments {
    /// The condition that must hold.
    pub condition: ExprId,
    /// The message text. `None` if it is missing or could not be evaluated.
    pub message: Option<ModelicaValue>,
    /// The level is `AssertionLevel.warning`.
    pub warning: bool,
}

impl<'a> Statements<'_, 'a, '_> {
    /// Executes statements in order. The results are in the locals.
    ///
    /// `None` after a message, or with `not_inline` set if they cannot be evaluated to expressions.
    ///
    /// A conditional `break` is handled here: the statements after it are executed for the case that it was not
    /// reached.
    /// A conditional `return` cannot be handled that way.
    pub fn execute(&mut self, statements: &'a [Statement], view: LookupContext) -> Option<StatementFlow> {
        for (i, s) in statements.iter().enumerate() {
            // A loop that never ends would otherwise keep the compiler busy; a procedure has a limit of its own.
            if !self.instance.eval.work.step() {
                self.instance.eval.not_inline = true;
                return None;
            }
            match self.statement(s, view)? {
                StatementFlow::Next => {}
                StatementFlow::BreakIf(left) => {
                    // After `if c then break; end if` the remaining statements apply only where `c` is false.
                    let rest = self.unless_left(left, |s| s.execute(&statements[i + 1..], view))?;
                    let Some(later) = rest.left() else {
                        self.instance.eval.not_inline = true;
                        return None;
                    };
                    return Some(StatementFlow::leaving(self.instance.exprs.or(left, later)));
                }
                other => return Some(other),
            }
        }
        Some(StatementFlow::Next)
    }

    /// Executes `f` for the case that the loop around was not left before.
    /// Afterwards each local keeps its old value where `left` holds.
    fn unless_left<T>(&mut self, left: ExprId, f: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        if left == Exprs::ZERO {
            return f(self);
        }
        let before = self.instance.eval.locals.clone();
        let not = self.instance.exprs.not(left);
        let done = self.guarded(not, f)?;
        self.merge_locals(left, &before)?;
        Some(done)
    }

    /// Sets each local of the frame to `if test then old else present`, where `before` holds the old values.
    /// `None` with `not_inline` set, if the two values of a local differ in shape.
    ///
    /// Locals outside of the frame cannot have changed.
    /// Strings that differ become a text that names the condition.
    fn merge_locals(&mut self, test: ExprId, before: &[(Symbol, ModelicaValue)]) -> Option<()> {
        for i in self.instance.eval.frame..self.instance.eval.locals.len() {
            let (a, b) = (&before[i].1, &self.instance.eval.locals[i].1);
            match a.zip(b, &mut |x, y, _| self.instance.exprs.if_(test, x, y)) {
                Some(merged) => self.instance.eval.locals[i].1 = merged,
                // Nobody knows before the run which of the two Strings applies, and a message can say no more than
                // that.
                None if matches!((a, b), (ModelicaValue::Text(_), ModelicaValue::Text(_))) => {
                    let words = MessagePart::Text("a text by a condition that is ".into());
                    let parts = vec![words, MessagePart::Value(test, ScalarType::Boolean)];
                    self.instance.eval.locals[i].1 = ModelicaValue::Text(Rc::new(parts));
                }
                None => {
                    self.instance.eval.not_inline = true;
                    return None;
                }
            }
        }
        Some(())
    }

    /// Executes one statement. `None` as for [`Self::execute`].
    ///
    /// Assignments change locals. Calls are executed for their assertions. The rest has functions of its own.
    /// `break` and `return` only tell the caller how the sequence ended.
    fn statement(&mut self, s: &'a Statement, view: LookupContext) -> Option<StatementFlow> {
        match &s.kind {
            StatementKind::Assign(target, value) => {
                let value = self.instance.evaluator().eval(value, view)?;
                self.assign(target, value, view, s.span)?;
                Some(StatementFlow::Next)
            }
            StatementKind::AssignTuple(targets, call) => {
                let value = self.instance.evaluator().eval_all(call, view)?;
                self.assign_tuple(targets, value, view, s.span)?;
                Some(StatementFlow::Next)
            }
            StatementKind::Call(call) => self.statement_call(call, view),
            StatementKind::If { branches, otherwise } => self.if_statement(branches, otherwise, view),
            StatementKind::For { .. } | StatementKind::While(..) => self.loop_statement(s, view),
            StatementKind::When(branches) => self.when_statement(branches, view, s.span),
            StatementKind::Break => Some(StatementFlow::Break),
            StatementKind::Return => Some(StatementFlow::Return),
        }
    }

    /// `(a, , c) := f(x)`: assigns the outputs of a call to the targets in order; an omitted target skips one.
    /// `None` after a message, if the call has fewer outputs than there are targets.
    /// A call with a single output counts as a list of one.
    pub(in crate::instance) fn assign_tuple(
        &mut self,
        targets: &'a [Option<Expr>],
        value: ModelicaValue,
        view: LookupContext,
        span: Span,
    ) -> Option<()> {
        let values: Vec<ModelicaValue> = match &value {
            ModelicaValue::Tuple(values) => values.to_vec(),
            other => vec![other.clone()],
        };
        if targets.len() > values.len() {
            let message = format!("{} results are wanted and {} are there", targets.len(), values.len());
            return self.instance.fail(Code::BadCall, &message, span);
        }
        for (target, value) in targets.iter().zip(values) {
            if let Some(t) = target {
                self.assign(t, value, view, span)?;
            }
        }
        Some(())
    }

    /// The reference and the index of the local that an assignment names. `None` after a message.
    /// Inputs of functions are locals as well; that they are not assigned is checked before.
    pub(in crate::instance) fn assigned_local(&mut self, target: &'a Expr) -> Option<(&'a ComponentReference, usize)> {
        let ExprKind::Reference(r) = &target.kind else {
            return self.instance.fail(Code::TypeMismatch, "only a variable can be assigned to", target.span);
        };
        let name = r.parts[0].name;
        let local = self.instance.local(name.name);
        if local.is_none() {
            self.instance.evaluator().unknown_name(name.name, name.span, &[]);
        }
        local.map(|i| (r, i))
    }

    /// `target := value`: replaces the value of a local, or one part of it. `None` as for [`Self::execute`].
    /// Variables of the model that an algorithm section assigns are locals too.
    /// Integers become Reals for a Real variable.
    fn assign(&mut self, target: &'a Expr, value: ModelicaValue, view: LookupContext, span: Span) -> Option<()> {
        let (r, i) = self.assigned_local(target)?;
        let name = r.parts[0].name;
        let value = value.first_output();
        let old = self.instance.eval.locals[i].1.clone();
        let whole = r.parts.len() == 1 && r.parts[0].subscripts.is_empty();
        // `Real x[:]` takes the size of its value; every other variable keeps its size (MLS 12.4.5).
        if whole && old.dims().len() == value.dims().len() && self.is_flexible(view, name.name) {
            self.instance.eval.locals[i].1 = value;
            return Some(());
        }
        let new = self.replaced(&old, r, 0, value, view, span)?;
        self.instance.eval.locals[i].1 = new;
        Some(())
    }

    /// Whether a variable of a function is declared with a flexible size, as `Real x[:]` (MLS 12.4.5).
    pub(in crate::instance) fn is_flexible(&mut self, view: LookupContext, name: Symbol) -> bool {
        self.declaration(view, name).is_some_and(|c| c.subscripts.iter().any(|s| matches!(s, Subscript::All(_))))
    }

    /// The declaration of a variable. `None` if the name is no component.
    /// The first part of a reference names it. Fields of records have no declaration here.
    pub(in crate::instance) fn declaration(
        &mut self,
        view: LookupContext,
        name: Symbol,
    ) -> Option<&'a ComponentDeclaration> {
        let Some(LookupResult::Component(scope, index)) = self.instance.names().lookup(view, name) else { return None };
        match self.instance.scope(scope).template.elements[index as usize].kind {
            TemplateElementKind::Component(c) => Some(c),
            TemplateElementKind::Class(_) => None,
        }
    }

    /// The value `old` in which the part that `r.parts[part..]` names is replaced by `value`.
    ///
    /// `old` is the value of what `r.parts[..part]` names, and the subscripts of `r.parts[part]` are applied here.
    /// `None` as for [`Self::execute`].
    ///
    /// ```text
    /// a[2].x := 1;   // replaces the field x in element 2 of the value of a
    /// ```
    ///
    /// Without subscripts the complete value is replaced. A slice takes an array with as many elements.
    fn replaced(
        &mut self,
        old: &ModelicaValue,
        r: &'a ComponentReference,
        part: usize,
        value: ModelicaValue,
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let p: &'a ReferencePart = &r.parts[part];
        let last = part + 1 == r.parts.len();
        if p.subscripts.is_empty() {
            if last {
                return self.matching(old, value, span);
            }
            return self.replaced_field(old, r, part + 1, value, view, span);
        }
        let ModelicaValue::Array { dims, elements } = old else {
            return self.instance.fail(Code::BadIndex, &format!("`{}` is not an array", p.name.name), span);
        };
        // Only the variable itself has a declaration at hand; index types of fields are not checked.
        let by = if part == 0 { self.instance.evaluator().counted_by(view, p.name.name) } else { Vec::new() };
        let picks = self.picks(dims, &by, p, view, span)?;
        if picks.iter().any(|p| matches!(p, SubscriptValue::Symbolic(_))) {
            return self.replaced_somewhere(dims, elements, &picks, last, &value, span);
        }
        let (_, places) = places(dims, &picks);
        let mut elements = elements.to_vec();
        if last {
            if places.len() != value.elements().len() {
                let message = format!("{} places cannot take {}", places.len(), value.describe());
                return self.instance.fail(Code::SizeMismatch, &message, span);
            }
            for (&place, v) in places.iter().zip(value.elements()) {
                elements[place] = self.matching(&elements[place].clone(), v.clone(), span)?;
            }
        } else {
            let [place] = places[..] else {
                return self.instance.fail(Code::BadIndex, "one element must be named here", span);
            };
            elements[place] = self.replaced_field(&elements[place].clone(), r, part + 1, value, view, span)?;
        }
        Some(ModelicaValue::Array { dims: dims.clone(), elements: Rc::new(elements) })
    }

    /// The record `old` in which the field `r.parts[part]`, or a part of it, is replaced by `value`.
    /// `None` after a message, if there is no such field.
    /// The other fields keep their values. A record value is copied, because other variables may share it.
    fn replaced_field(
        &mut self,
        old: &ModelicaValue,
        r: &'a ComponentReference,
        part: usize,
        value: ModelicaValue,
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let name = r.parts[part].name;
        let ModelicaValue::Record(record) = old else {
            return self.instance.fail(
                Code::UnknownName,
                &format!("{} has no field `{}`", old.describe(), name.name),
                name.span,
            );
        };
        let mut fields = record.fields.clone();
        let Some(i) = fields.iter().position(|(n, _)| *n == name.name) else {
            let names: Vec<Symbol> = fields.iter().map(|(n, _)| *n).collect();
            self.instance.evaluator().unknown_name(name.name, name.span, &names);
            return None;
        };
        fields[i].1 = self.replaced(&fields[i].1.clone(), r, part, value, view, span)?;
        Some(ModelicaValue::Record(Rc::new(crate::instance::value::RecordValue { fields, class: record.class })))
    }

    /// Evaluates the subscripts of a target, one entry for each dimension. Missing subscripts select all.
    /// `None` after a message.
    /// `by` holds the index types of the dimensions, as far as they are known.
    fn picks(
        &mut self,
        dims: &[usize],
        by: &[ScalarType],
        p: &'a ReferencePart,
        view: LookupContext,
        span: Span,
    ) -> Option<Vec<SubscriptValue>> {
        if p.subscripts.len() > dims.len() {
            let message = format!("{} indices for an array of size {}", p.subscripts.len(), size_text(dims));
            return self.instance.fail(Code::BadIndex, &message, span);
        }
        let mut picks = Vec::with_capacity(dims.len());
        for (i, (s, &n)) in p.subscripts.iter().zip(dims).enumerate() {
            picks.push(self.instance.evaluator().index(s, (n, by.get(i).copied()), view, span)?);
        }
        picks.extend(dims[picks.len()..].iter().map(|&n| SubscriptValue::Many((0..n).collect())));
        Some(picks)
    }

    /// `a[k] := value` with a `k` that changes during the run: each element becomes `if k == i then value else a[i]`.
    ///
    /// This is done in algorithm sections of models only. In functions, and for slices or fields, `not_inline` is set
    /// instead.
    ///
    /// `dims` and `elements` are the array before, `picks` its subscripts, at least one of them symbolic.
    /// `last` is false if a field follows the subscripts.
    /// Several symbolic subscripts must all hit the element.
    fn replaced_somewhere(
        &mut self,
        dims: &[usize],
        elements: &[ModelicaValue],
        picks: &[SubscriptValue],
        last: bool,
        value: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        if self.instance.eval.depth > 0 || !last || picks.iter().any(|p| matches!(p, SubscriptValue::Many(_))) {
            self.instance.eval.not_inline = true;
            return None;
        }
        let mut replaced = Vec::with_capacity(elements.len());
        for (at, old) in elements.iter().enumerate() {
            let value = self.matching(old, value.clone(), span)?;
            // The row-major position is taken apart from the last dimension; all subscripts must hit.
            let (mut hit, mut rest) = (Exprs::ONE, at);
            for (p, &n) in picks.iter().zip(dims).rev() {
                let place = rest % n;
                rest /= n;
                let here = match p {
                    SubscriptValue::One(i) => self.instance.exprs.boolean(*i == place),
                    SubscriptValue::Symbolic(e) => {
                        let number = self.instance.exprs.num(place as f64 + 1.0);
                        self.instance.exprs.rel(RelationalOp::Eq, *e, number)
                    }
                    SubscriptValue::Many(_) => Exprs::ZERO,
                };
                hit = self.instance.exprs.and(hit, here);
            }
            replaced.push(value.zip(old, &mut |new, old, _| self.instance.exprs.if_(hit, new, old))?);
        }
        Some(ModelicaValue::array(dims.to_vec(), replaced))
    }

    /// Checks a value against the present value of the variable that takes it: sizes and types must fit.
    /// Integers become Reals where needed. `None` after a message.
    /// The fields of records are not compared.
    fn matching(&mut self, old: &ModelicaValue, value: ModelicaValue, span: Span) -> Option<ModelicaValue> {
        if old.dims() != value.dims() {
            let message = format!("{} cannot take {}", old.describe(), value.describe());
            return self.instance.fail(Code::SizeMismatch, &message, span);
        }
        match (old.element_type(), value.element_type()) {
            (Some(ScalarType::Real), Some(ScalarType::Integer)) => Some(value.with_type(ScalarType::Real)),
            (Some(a), Some(b)) if a != b => self.instance.fail(
                Code::TypeMismatch,
                &format!("{} cannot take {}", old.describe(), value.describe()),
                span,
            ),
            _ => Some(value),
        }
    }

    /// Whether the run may never reach the present statement, because an unknown condition decides.
    fn may_not_come_here(&self) -> bool {
        !self.instance.eval.guards.is_empty()
            || self.instance.eval.mode.procedure
            || self.instance.eval.mode.under_procedure
    }

    /// A call as a statement: `assert`, `terminate`, or a function called for its assertions.
    ///
    /// In a function an assertion that holds is dropped, and one that fails is an error. If its condition is not known,
    /// the function must become a procedure. In an algorithm section of a model assertions are kept for the run.
    ///
    /// - `terminate` is kept for the run. `reinit` is an error, it belongs to equations.
    /// - The outputs of any other function are dropped.
    ///
    /// `None` as for [`Self::execute`].
    /// A condition that is not known sets `not_inline`: the procedure then checks it.
    fn statement_call(&mut self, call: &'a Expr, view: LookupContext) -> Option<StatementFlow> {
        if let ExprKind::Call { function, args, .. } = &call.kind {
            match function.parts[0].name.name.as_str() {
                "assert"
                    if (self.instance.eval.frame > 0 || self.instance.eval.depth > 0)
                        && !self.instance.eval.mode.keep_asserts =>
                {
                    let c = self.instance.evaluator().eval(args.first()?, view)?;
                    return match c.as_number(&self.instance.exprs) {
                        Some(x) if x != 0.0 => Some(StatementFlow::Next),
                        // A failing assertion in a branch that may never be taken is not an error yet.
                        Some(_) if self.may_not_come_here() => {
                            (self.instance.eval.not_inline, self.instance.eval.may_fail) = (true, true);
                            None
                        }
                        Some(_) => {
                            let text = args
                                .get(1)
                                .and_then(|m| self.instance.evaluator().eval(m, view))
                                .map(|v| v.in_words(&self.instance.exprs));
                            let text = text.unwrap_or_else(|| "an assertion".into());
                            self.instance.fail(
                                Code::Evaluation,
                                &format!("an assertion of a function fails: {text}"),
                                call.span,
                            )
                        }
                        None => {
                            self.instance.eval.not_inline = true;
                            None
                        }
                    };
                }
                "assert" => {
                    let a = self.assertion(call, view)?;
                    return self.keep_call(Some(a.condition), a.message, a.warning, call.span);
                }
                "reinit" => {
                    let d = Diagnostic::new(Code::BadCall, "`reinit` cannot stand in an algorithm");
                    let d = d.at(call.span, "an equation is needed here");
                    self.instance
                        .report(d.help("write it below `equation`: `when condition then reinit(x, value); end when;`"));
                    return None;
                }
                "terminate" => {
                    let message = args.first().and_then(|m| self.instance.evaluator().eval(m, view));
                    return self.keep_call(None, message, false, call.span);
                }
                _ => {}
            }
        }
        self.instance.evaluator().eval_all(call, view)?;
        Some(StatementFlow::Next)
    }

    /// Keeps an assertion, or a `terminate` if there is no condition, for the flat model.
    /// It applies where all conditions of the `if`s around it hold.
    ///
    /// `message` is `None` if it was not given. `warning` is the assertion level.
    pub(in crate::instance) fn keep_call(
        &mut self,
        condition: Option<ExprId>,
        message: Option<ModelicaValue>,
        warning: bool,
        span: Span,
    ) -> Option<StatementFlow> {
        let mut guard = Exprs::ONE;
        for g in self.instance.eval.guards.clone() {
            guard = self.instance.exprs.and(guard, g);
        }
        self.instance.eval.calls.push(AlgorithmCall { condition, guard, message, warning, span });
        Some(StatementFlow::Next)
    }

    /// Evaluates the arguments of an `assert` (MLS 8.3.7). Its condition raises no events. `None` after a message.
    ///
    /// Arguments may be positional or named: `condition`, `message`, `level`.
    /// The level must be known. A message that cannot be evaluated is left out.
    pub fn assertion(&mut self, call: &'a Expr, view: LookupContext) -> Option<AssertArguments> {
        let ExprKind::Call { args, named, .. } = &call.kind else { return None };
        let by_name = |n: &str| named.iter().find(|(i, _)| i.name == n).map(|(_, e)| e);
        let Some(condition) = args.first().or_else(|| by_name("condition")) else {
            return self.instance.fail(Code::BadCall, "`assert` needs a condition and a message", call.span);
        };
        let value = self.instance.in_mode(|m| m.no_event = true, |s| s.evaluator().eval(condition, view));
        let value = value?;
        let Some((condition, ScalarType::Boolean)) = value.scalar() else {
            return self.instance.evaluator().wrong_type("a Boolean", &value, condition.span);
        };
        let message = args.get(1).or_else(|| by_name("message")).and_then(|m| self.instance.evaluator().eval(m, view));
        let warning = match args.get(2).or_else(|| by_name("level")) {
            Some(level) => {
                // `AssertionLevel.warning` is the first literal.
                self.instance.evaluator().constant(level, view)?.as_number(&self.instance.exprs) == Some(1.0)
            }
            None => false,
        };
        Some(AssertArguments { condition, message, warning })
    }

    /// An `if` statement.
    ///
    /// A known condition selects its branch. Otherwise both branches are executed on the same locals, and the results
    /// are merged. `break` in one of the branches makes the rest of the loop conditional, in models only.
    ///
    /// `branches` are the conditions with their statements, `otherwise` those of `else`. Conditions are tested in
    /// order.
    /// `None` as for [`Self::execute`].
    fn if_statement(
        &mut self,
        branches: &'a [(Expr, Vec<Statement>)],
        otherwise: &'a [Statement],
        view: LookupContext,
    ) -> Option<StatementFlow> {
        let Some(((condition, body), rest)) = branches.split_first() else { return self.execute(otherwise, view) };
        let c = self.instance.evaluator().eval(condition, view)?;
        let Some((test, ScalarType::Boolean)) = c.scalar() else {
            return self.instance.evaluator().wrong_type("a Boolean", &c, condition.span);
        };
        if let Some(known) = self.instance.exprs.as_num(test) {
            return if known == 0.0 { self.if_statement(rest, otherwise, view) } else { self.execute(body, view) };
        }
        let before = self.instance.eval.locals.clone();
        let not = self.instance.exprs.not(test);
        let first = self.guarded(test, |s| s.execute(body, view))?;
        // The second branch starts from the same values as the first one.
        let after = std::mem::replace(&mut self.instance.eval.locals, before);
        let second = self.guarded(not, |s| s.if_statement(rest, otherwise, view))?;
        let ways = if self.instance.eval.depth == 0 { first.left().zip(second.left()) } else { None };
        let Some((a, b)) = ways
            .or((first == StatementFlow::Next && second == StatementFlow::Next).then_some((Exprs::ZERO, Exprs::ZERO)))
        else {
            self.instance.eval.not_inline = true;
            return None;
        };
        // The locals hold the results of the second branch, and `after` those of the first.
        self.merge_locals(test, &after)?;
        Some(StatementFlow::leaving(self.instance.exprs.if_(test, a, b)))
    }

    /// Runs `f` for statements or expressions that are reached only if `guard` holds.
    /// Guards also tell whether a failing assertion may be unreachable.
    pub(in crate::instance) fn guarded<T>(
        &mut self,
        guard: ExprId,
        f: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        self.instance.eval.guards.push(guard);
        let done = f(self);
        self.instance.eval.guards.pop();
        done
    }

    /// A `for` or `while` loop.
    ///
    /// In an algorithm section of a model a loop that cannot be unrolled becomes a procedure.
    /// In a function `None` is returned with `not_inline` set, and the complete function becomes a procedure.
    fn loop_statement(&mut self, s: &'a Statement, view: LookupContext) -> Option<StatementFlow> {
        let before = self.instance.eval.locals.clone();
        let marks = (self.instance.diagnostics.len(), self.instance.eval.calls.len(), self.instance.eval.whens.len());
        let flow = match &s.kind {
            StatementKind::For { iterators, body } => self.for_statement(iterators, body, view),
            StatementKind::While(condition, body) => self.while_statement(condition, body, view),
            _ => unreachable!("the caller found a loop"),
        };
        let refused = flow.is_none() && self.instance.eval.not_inline && self.instance.diagnostics.len() == marks.0;
        if !refused || self.instance.eval.depth > 0 {
            return flow;
        }
        // The attempt to unroll the loop is undone before the loop is translated.
        self.instance.eval.not_inline = false;
        self.instance.eval.locals = before;
        self.instance.eval.calls.truncate(marks.1);
        self.instance.eval.whens.truncate(marks.2);
        self.instance.procedures().loop_as_procedure(s, view).map(|()| StatementFlow::Next)
    }

    /// Whether the bounds of a range change during the run, so that the number of repetitions is not known.
    /// `None` after a message.
    fn varies(&mut self, range: Option<&'a Expr>, view: LookupContext) -> Option<bool> {
        let Some(ExprKind::Range { from, step, to }) = range.map(|r| &r.kind) else { return Some(false) };
        for e in [Some(&**from), step.as_deref(), Some(&**to)].into_iter().flatten() {
            let value = self.instance.evaluator().eval(e, view)?;
            if value.scalar().is_some_and(|(e, _)| self.instance.variability(e) > Variability::Parameter) {
                return Some(true);
            }
        }
        Some(false)
    }

    /// A `for` statement over several iterators, the last one fastest. Each repetition is executed in turn.
    /// `None` as for [`Self::execute`].
    ///
    /// `left` is the condition under which an earlier repetition has left the loop by `break`.
    /// A loop in a model whose bounds change during the run sets `not_inline`.
    fn for_statement(
        &mut self,
        iterators: &'a [bramah_syntax::ast::ForIndex],
        body: &'a [Statement],
        view: LookupContext,
    ) -> Option<StatementFlow> {
        let Some((first, rest)) = iterators.split_first() else { return self.execute(body, view) };
        if self.instance.eval.depth == 0 && self.varies(first.range.as_ref(), view)? {
            self.instance.eval.not_inline = true;
            return None;
        }
        let mut left = Exprs::ZERO;
        for value in self.instance.evaluator().iterate(first, LoopBody::Statements(body), view)? {
            let flow = self.unless_left(left, |s| {
                s.instance.eval.locals.push((first.name.name, value));
                let flow = s.for_statement(rest, body, view);
                s.instance.eval.locals.pop();
                flow
            })?;
            // A `return` also ends the repetitions that are left.
            let Some(now) = flow.left() else { return Some(StatementFlow::Return) };
            left = self.instance.exprs.or(left, now);
            if left == Exprs::ONE {
                break;
            }
        }
        Some(StatementFlow::Next)
    }

    /// A `while` statement whose condition is known at each repetition. `None` as for [`Self::execute`].
    ///
    /// The condition is a number at each repetition as long as the loop depends on known values only.
    /// Otherwise, or if the budget is used up, `not_inline` is set.
    fn while_statement(
        &mut self,
        condition: &'a Expr,
        body: &'a [Statement],
        view: LookupContext,
    ) -> Option<StatementFlow> {
        loop {
            // Each test counts as a statement, so that a loop with an empty body ends as well.
            let may_go_on = self.instance.eval.work.step();
            let c = self.instance.evaluator().eval(condition, view)?;
            match c.as_number(&self.instance.exprs) {
                Some(0.0) => return Some(StatementFlow::Next),
                Some(_) if may_go_on => {}
                _ => {
                    self.instance.eval.not_inline = true;
                    return None;
                }
            }
            match self.execute(body, view)? {
                StatementFlow::Next => {}
                StatementFlow::Break => return Some(StatementFlow::Next),
                StatementFlow::Return => return Some(StatementFlow::Return),
                StatementFlow::BreakIf(_) => {
                    self.instance.eval.not_inline = true;
                    return None;
                }
            }
        }
    }

    /// `when` in an algorithm section of a model: what each branch assigns is collected for the flat model.
    ///
    /// After the statement the locals have their values from before: a branch applies only at its events (MLS 11.2.7).
    /// `None` after a message.
    ///
    /// Each branch is executed on the values before the `when`, without events of its own.
    /// In functions a `when` is an error (MLS 12.2).
    fn when_statement(
        &mut self,
        branches: &'a [(Expr, Vec<Statement>)],
        view: LookupContext,
        span: Span,
    ) -> Option<StatementFlow> {
        if self.instance.eval.depth > 0 {
            return self.instance.fail(Code::Unsupported, "`when` cannot stand in a function", span);
        }
        let mut collected = AlgorithmWhen { branches: Vec::new(), span };
        let before = self.instance.eval.locals.clone();
        // Assertions inside a branch belong to the branch, those before it to the section.
        let outside = std::mem::take(&mut self.instance.eval.calls);
        for (condition, body) in branches {
            let conditions = self.when_conditions(condition, view)?;
            let done = self.instance.in_mode(|m| m.no_event = true, |s| s.statements().execute(body, view));
            let calls = std::mem::take(&mut self.instance.eval.calls);
            done?;
            let frame = self.instance.eval.frame;
            let mut values = Vec::new();
            // Locals whose expressions differ from those before the branch were assigned by it.
            for (i, (name, value)) in self.instance.eval.locals.iter().enumerate().skip(frame) {
                if !same(&before[i].1, value) {
                    values.push((*name, value.clone()));
                }
            }
            self.instance.eval.locals.clone_from(&before);
            collected.branches.push(AlgorithmBranch { conditions, values, calls });
        }
        self.instance.eval.calls = outside;
        self.instance.eval.whens.push(collected);
        Some(StatementFlow::Next)
    }

    /// The conditions of a `when`: one Boolean, or a vector of which any activates it (MLS 8.3.5).
    /// Conditions that are always false are left out. `None` after a message.
    pub fn when_conditions(&mut self, condition: &'a Expr, view: LookupContext) -> Option<Vec<ExprId>> {
        let value = self.instance.evaluator().eval(condition, view)?;
        let mut conditions = Vec::new();
        for v in value.elements() {
            match v.scalar() {
                Some((e, ScalarType::Boolean)) => conditions.push(e),
                _ => return self.instance.evaluator().wrong_type("a Boolean", v, condition.span),
            }
        }
        conditions.retain(|&c| c != Exprs::ZERO);
        Some(conditions)
    }
}

/// Collects the references that statements assign: outside of `when` in `always`, inside in `in_when`.
/// `inside` is true if the statements themselves stand in a `when`.
///
/// First the statements of the sequence itself, then those nested in `if`, loops and `when`.
/// A variable that is assigned several times appears several times.
/// The lists keep the order in which the assignments are found.
pub fn assigned<'a>(
    statements: &'a [Statement],
    inside: bool,
    always: &mut Vec<&'a ComponentReference>,
    in_when: &mut Vec<&'a ComponentReference>,
) {
    let mut note = |e: &'a Expr| {
        if let ExprKind::Reference(r) = &e.kind {
            if inside { in_when.push(r) } else { always.push(r) }
        }
    };
    for s in statements {
        match &s.kind {
            StatementKind::Assign(target, _) => note(target),
            StatementKind::AssignTuple(targets, _) => targets.iter().flatten().for_each(&mut note),
            _ => {}
        }
    }
    for s in statements {
        match &s.kind {
            StatementKind::If { branches, otherwise } => {
                branches.iter().for_each(|(_, b)| assigned(b, inside, always, in_when));
                assigned(otherwise, inside, always, in_when);
            }
            StatementKind::For { body, .. } | StatementKind::While(_, body) => assigned(body, inside, always, in_when),
            StatementKind::When(branches) => branches.iter().for_each(|(_, b)| assigned(b, true, always, in_when)),
            _ => {}
        }
    }
}

/// Whether two values consist of the same expressions. Shapes are not compared.
pub(in crate::instance) fn same(a: &ModelicaValue, b: &ModelicaValue) -> bool {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    a.scalars(&mut x);
    b.scalars(&mut y);
    x == y
}
