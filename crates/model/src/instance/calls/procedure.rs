//! Procedures: functions whose loops, conditions or indices depend on values of the run.
//!
//! Such a function is translated into a [`Function`], a small program over numbered slots.
//! The expression pool then holds calls of it, one for each scalar output.
//! While the body is translated, locals are variables numbered from [`LOCAL`] on, in the same pool as all expressions.
//! `term` turns such expressions into terms over slots. Loops of algorithm sections are translated in the same way.

use crate::instance::FunctionCalls;
use crate::instance::algorithm::assigned;
use crate::instance::call::{Callee, FormalParameter, sections};
use crate::instance::calls::binding::is_input;
use crate::instance::calls::locals::in_order_of_use;
use crate::instance::deduce::LoopBody;
use crate::instance::evaluation::indices::SubscriptValue;
use crate::instance::evaluation::state::EvaluationMode;
use crate::instance::value::ModelicaValue;
use crate::instance::{LookupContext, ProcedureTranslator};
use bramah_expr::function::{Function, SlotExpr, SlotStatement};
use bramah_expr::types::ScalarType;
use bramah_expr::{ExprId, ExprNode, Exprs, FunctionId, VarId};
use bramah_syntax::ast::{self, CausalityPrefix, ComponentReference, Expr, ExprKind, Ident, Statement, StatementKind};
use bramah_syntax::diag::{Code, Span};
use bramah_syntax::symbol::Symbol;

/// The number of the variable that stands for slot 0. It is above all numbers of flat variables.
const LOCAL: u32 = 0x4000_0000;
/// A function id that no function has.
/// A call of it stands for an array element whose index is known only during the run: output number is the first slot.
const ELEMENT: FunctionId = FunctionId(u32::MAX);

/// The procedure that is being translated.
#[derive(Default)]
pub struct ProcedureDraft {
    /// The number of slots so far.
    slots: u32,
    /// The list of statements to which the translation appends.
    statements: Vec<SlotStatement>,
    /// The expressions of the model that a loop reads, in the order of the first slots.
    /// `None` in functions, which read their inputs only.
    captures: Option<Vec<ExprId>>,
}

/// What a loop variable is at each value of the counter.
enum LoopValues {
    /// The counter itself, as a value of this type.
    Counter(ScalarType),
    /// The element of an array at the counter.
    Elements(ModelicaValue),
}

impl<'a> ProcedureTranslator<'_, 'a, '_> {
    /// Calls a function through its procedure, which is translated at the first call. `None` after a message.
    ///
    /// The value consists of one call for each scalar output. Equal calls are one node of the pool.
    ///
    /// 1. The arguments are bound to the inputs in a frame, which also evaluates defaults.
    /// 2. The procedure is found by its key, or translated.
    /// 3. The scalars of all arguments that are not built in are handed over.
    pub(in crate::instance) fn call_procedure(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        let values = self.instance.calls().with_inputs(callee, positional, named, span, |s| {
            // Binding fills in the defaults, so that the procedure gets a value for each input.
            Some(s.eval.locals[s.eval.frame..].iter().map(|(_, v)| v.clone()).collect::<Vec<ModelicaValue>>())
        })?;
        let key = self.procedure_key(callee, &values);
        let known = self.instance.functions.procedures.get(&key).cloned();
        let (function, shapes) = match known {
            Some(found) => found,
            None => self.translate(callee, &values, key, span)?,
        };
        // The order is that of the inputs, scalar by scalar, as the slots of the inputs are numbered.
        let mut args: Vec<ExprId> = Vec::new();
        // Arguments that are built into the procedure are not handed over.
        for v in values.iter().filter(|v| !self.specialised(v)) {
            v.scalars(&mut args);
        }
        let mut number = 0;
        let outputs = shapes
            .iter()
            .map(|shape| {
                shape.map(&mut |_, _| {
                    number += 1;
                    self.instance.exprs.call(function, number - 1, &args)
                })
            })
            .collect();
        FunctionCalls::outputs(outputs)
    }

    /// Whether an argument is built into the procedure: a known Integer, Boolean or enumeration value, or a String.
    /// Sizes and loop bounds may depend on those, and Strings have no slots.
    fn specialised(&self, v: &ModelicaValue) -> bool {
        match v {
            ModelicaValue::Scalar(e, ScalarType::Integer | ScalarType::Boolean | ScalarType::Enumeration(_)) => {
                self.instance.exprs.as_num(*e).is_some()
            }
            ModelicaValue::Text(_) => true,
            _ => false,
        }
    }

    /// The key of a procedure: the function with its scope, the values that are built in, and the shapes of the others.
    /// Calls with equal keys use the same procedure.
    /// Functions as arguments are part of the key, because a procedure calls a certain function.
    fn procedure_key(&self, callee: &Callee<'a>, values: &[ModelicaValue]) -> String {
        let mut key = format!("{}@{}", callee.name, callee.scope.0);
        for v in values {
            if self.specialised(v) {
                key.push_str(&format!("={:?}{:?}", v.as_number(&self.instance.exprs), v.as_text(&self.instance.exprs)));
            } else {
                let mut scalars = Vec::new();
                v.scalars(&mut scalars);
                key.push_str(&format!(",{:?}{}", v.dims(), scalars.len()));
                if let ModelicaValue::Function(f, _) = v {
                    key.push_str(&format!("f{f}"));
                }
            }
        }
        key
    }

    /// Translates a function for arguments of these shapes. `None` after a message.
    ///
    /// `values` are the arguments in the order of the inputs. The result is the procedure with the shapes of its
    /// outputs.
    fn translate(
        &mut self,
        callee: &Callee<'a>,
        values: &[ModelicaValue],
        key: String,
        span: Span,
    ) -> Option<(FunctionId, Vec<ModelicaValue>)> {
        let outer = std::mem::take(&mut self.instance.eval.translation);
        let not_inline = std::mem::replace(&mut self.instance.eval.not_inline, false);
        let change = |m: &mut EvaluationMode| (m.procedure, m.constant) = (true, false);
        let result =
            self.instance.in_mode(change, |s| s.in_frame(|s| s.procedures().translate_body(callee, values, key)));
        let refused = std::mem::replace(&mut self.instance.eval.not_inline, not_inline);
        self.instance.eval.translation = outer;
        // In a procedure nothing can be postponed any more: what must be known there and is not is an error.
        if result.is_none() && refused {
            let message = format!("`{}` has sizes or ranges that are only known at run time", callee.name);
            return self.instance.fail(Code::NotConstant, &message, span);
        }
        result
    }

    /// Translates the body of a function, in a frame of its own. `None` after a message, or with `not_inline` set.
    ///
    /// Slots are given out in the order: inputs, outputs and protected variables, temporaries.
    /// Output shapes are known before the statements are translated, so recursive calls can use them.
    /// The result of a translation that fails is removed from the table.
    fn translate_body(
        &mut self,
        callee: &Callee<'a>,
        values: &[ModelicaValue],
        key: String,
    ) -> Option<(FunctionId, Vec<ModelicaValue>)> {
        let inputs = self.instance.calls().formals(callee, is_input);
        for (f, v) in inputs.iter().zip(values) {
            let local = if self.specialised(v) { v.clone() } else { self.slots_like(v) };
            self.instance.eval.locals.push((f.name, local));
        }
        // The inputs have the first slots; only those that are handed over have any.
        let count = self.instance.eval.translation.slots;
        let locals = self.locals_in_slots(callee)?;
        let shapes: Vec<ModelicaValue> = locals
            .iter()
            .filter(|f| f.component.prefix.causality == Some(CausalityPrefix::Output))
            .filter_map(|f| self.instance.local(f.name).map(|i| self.instance.eval.locals[i].1.clone()))
            .collect();
        let mut outputs = Vec::new();
        shapes.iter().for_each(|s| s.scalars(&mut outputs));
        let outputs: Vec<u32> = outputs.iter().filter_map(|&e| self.slot(e)).collect();
        // Entered before the body is translated, so that a recursive call finds it. The body is filled in at the end.
        let blank =
            Function { name: callee.name.clone(), inputs: count, slots: 0, outputs: outputs.clone(), body: Vec::new() };
        let id = self.instance.exprs.add_function(blank);
        self.instance.functions.procedures.insert(key.clone(), (id, shapes.clone()));
        for (section, view) in sections(callee) {
            if self.procedure_statements(section, view).is_none() {
                // A failed translation must not be found by the next call.
                self.instance.functions.procedures.remove(&key);
                return None;
            }
        }
        let body = std::mem::take(&mut self.instance.eval.translation.statements);
        let slots = self.instance.eval.translation.slots;
        let f = &mut self.instance.exprs.functions[id.0 as usize];
        (f.slots, f.body) = (slots, body);
        Some((id, shapes))
    }

    /// Gives outputs and protected variables slots with their initial values, and makes them locals.
    /// `None` after a message. The result lists them in the order of their declaration.
    fn locals_in_slots(&mut self, callee: &Callee<'a>) -> Option<Vec<FormalParameter<'a>>> {
        let locals = self.instance.calls().formals(callee, |c, p| !is_input(c, p));
        for f in in_order_of_use(&locals) {
            let value = self.instance.calls().declared_local(f)?;
            let slots = self.kept(&value);
            self.instance.eval.locals.push((f.name, slots));
        }
        Some(locals)
    }

    /// Translates a loop of a model's algorithm section into a procedure of what the loop reads. `None` after a
    /// message.
    ///
    /// It is used if the number of repetitions depends on values of the run. The assigned locals become calls of the
    /// procedure. Relations inside raise no events (MLS 11.2.3).
    ///
    /// `view` is the place of the section. The locals have their values before the loop again while it is translated.
    /// The procedure is named after the class of the model, for messages during the run.
    /// A `when` inside the loop is an error.
    pub(in crate::instance) fn loop_as_procedure(&mut self, s: &'a Statement, view: LookupContext) -> Option<()> {
        let changed = self.assigned_locals(s)?;
        let before = self.instance.eval.locals.clone();
        let outer = std::mem::take(&mut self.instance.eval.translation);
        let mut captures = Vec::new();
        let mut made = None;
        // The first pass finds what the loop reads. The second one numbers its slots after those of the captures.
        for _ in 0..2 {
            self.instance.eval.locals.clone_from(&before);
            let slots = u32::try_from(captures.len()).expect("limited sizes");
            self.instance.eval.translation = ProcedureDraft { slots, statements: Vec::new(), captures: Some(captures) };
            made = self.instance.in_mode(|m| m.procedure = true, |i| i.procedures().translate_loop(s, &changed, view));
            captures = self.instance.eval.translation.captures.take().unwrap_or_default();
            if made.is_none() {
                break;
            }
        }
        let done = std::mem::replace(&mut self.instance.eval.translation, outer);
        self.instance.eval.locals = before;
        let shapes = made?;
        let mut outputs = Vec::new();
        shapes.iter().for_each(|v| v.scalars(&mut outputs));
        let function = self.instance.exprs.add_function(Function {
            name: self.instance.library.full_name(self.instance.scope(view.scope).template.class),
            inputs: u32::try_from(captures.len()).expect("limited sizes"),
            slots: done.slots,
            outputs: outputs.iter().filter_map(|&e| self.slot(e)).collect(),
            body: done.statements,
        });
        let mut number = 0;
        for (i, shape) in changed.into_iter().zip(shapes) {
            self.instance.eval.locals[i].1 = shape.map(&mut |_, _| {
                number += 1;
                self.instance.exprs.call(function, number - 1, &captures)
            });
        }
        Some(())
    }

    /// The indices of the locals that a statement assigns, in increasing order.
    /// `None` after a message, if there is a `when` in the loop.
    /// Locals outside of the loop that it does not assign are only read.
    fn assigned_locals(&mut self, s: &'a Statement) -> Option<Vec<usize>> {
        let (mut targets, mut in_when) = (Vec::new(), Vec::new());
        assigned(std::slice::from_ref(s), false, &mut targets, &mut in_when);
        if let Some(target) = in_when.first() {
            let message = "a `when` cannot stand in a loop that runs as often as changing values say";
            return self.instance.fail(Code::Unsupported, message, target.parts[0].name.span);
        }
        let mut changed: Vec<usize> =
            targets.iter().filter_map(|r| self.instance.local(r.parts[0].name.name)).collect();
        changed.sort_unstable();
        changed.dedup();
        Some(changed)
    }

    /// Translates a loop. The result is, for each changed local, the slots that hold its value at the end.
    /// `None` after a message.
    /// `changed` are the locals that the loop assigns.
    fn translate_loop(
        &mut self,
        s: &'a Statement,
        changed: &[usize],
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        // Each changed variable starts with its value before the loop.
        for &i in changed {
            let value = self.instance.eval.locals[i].1.clone();
            self.instance.eval.locals[i].1 = self.kept(&value);
        }
        self.procedure_statement(s, view)?;
        Some(changed.iter().map(|&i| self.instance.eval.locals[i].1.clone()).collect())
    }

    /// New slots in the shape of a value, as variables of the pool.
    /// They are consecutive and in row-major order, which indexed access relies on.
    fn slots_like(&mut self, v: &ModelicaValue) -> ModelicaValue {
        // The pool is taken out while the closure changes it and the number of slots together.
        let mut pool = std::mem::take(&mut self.instance.exprs);
        let slots = &mut self.instance.eval.translation.slots;
        let made = v.map(&mut |_, _| {
            *slots += 1;
            pool.var(VarId(LOCAL + *slots - 1))
        });
        self.instance.exprs = pool;
        made
    }

    /// The slot for which a variable of the pool stands. `None` for any other expression.
    fn slot(&self, e: ExprId) -> Option<u32> {
        match self.instance.exprs.node(e) {
            ExprNode::Var(v) if v.0 >= LOCAL => Some(v.0 - LOCAL),
            _ => None,
        }
    }

    /// Appends a statement to the list that is being filled.
    fn emit(&mut self, s: SlotStatement) {
        self.instance.eval.translation.statements.push(s);
    }

    /// Emits the assignment of a value to slots of the same shape.
    ///
    /// Several scalars go through temporary slots: all are read before one is written, as in `(a, b) := (b, a)`.
    /// Both values must have the same shape, which the caller has checked.
    fn store(&mut self, slots: &ModelicaValue, value: &ModelicaValue) {
        let (mut to, mut from) = (Vec::new(), Vec::new());
        slots.scalars(&mut to);
        value.scalars(&mut from);
        let terms: Vec<SlotExpr> = from.iter().map(|&e| self.term(e)).collect();
        let targets: Vec<u32> = to.iter().filter_map(|&e| self.slot(e)).collect();
        if terms.len() == 1 {
            self.emit(SlotStatement::Assign(targets[0], terms[0].clone()));
            return;
        }
        let first = self.instance.eval.translation.slots;
        self.instance.eval.translation.slots += u32::try_from(terms.len()).expect("limited sizes");
        for (i, t) in (first..).zip(terms) {
            self.emit(SlotStatement::Assign(i, t));
        }
        for (i, t) in (first..).zip(targets) {
            self.emit(SlotStatement::Assign(t, SlotExpr::Slot(i)));
        }
    }

    /// A value as it is now, in slots of its own that nothing else writes.
    fn kept(&mut self, value: &ModelicaValue) -> ModelicaValue {
        let slots = self.slots_like(value);
        self.store(&slots, value);
        slots
    }

    /// Runs `f` and returns the statements that it emitted as a list of their own, for a branch or the body of a loop.
    fn nested(&mut self, f: impl FnOnce(&mut Self) -> Option<()>) -> Option<Vec<SlotStatement>> {
        let outer = std::mem::take(&mut self.instance.eval.translation.statements);
        let done = f(self);
        let inner = std::mem::replace(&mut self.instance.eval.translation.statements, outer);
        done.map(|()| inner)
    }

    /// Translates statements in order. `None` after a message, or with `not_inline` set.
    fn procedure_statements(&mut self, statements: &'a [Statement], view: LookupContext) -> Option<()> {
        statements.iter().try_for_each(|s| self.procedure_statement(s, view))
    }

    /// Translates one statement. `None` as above.
    /// Unlike in `Statements`, conditions and indices need not be known.
    ///
    /// - Assignments store values in slots. A call with several outputs stores each of them.
    /// - `if`, `for` and `while` become statements of the procedure, with translated bodies.
    /// - `break` and `return` are statements too. `when` is an error.
    ///
    /// A condition is evaluated to a term, which the procedure computes at each test.
    fn procedure_statement(&mut self, s: &'a Statement, view: LookupContext) -> Option<()> {
        match &s.kind {
            StatementKind::Assign(target, value) => {
                let value = self.instance.evaluator().eval(value, view)?;
                self.procedure_assign(target, &value, view, s.span)
            }
            StatementKind::AssignTuple(targets, call) => {
                let value = self.instance.evaluator().eval_all(call, view)?;
                let ModelicaValue::Tuple(values) = &value else {
                    return self.instance.fail(Code::BadCall, "this function has one result only", s.span);
                };
                let wanted: Vec<_> =
                    targets.iter().zip(values.iter()).filter_map(|(t, v)| Some((t.as_ref()?, v))).collect();
                // All outputs are computed before one is assigned: `(a, b) := f(b, a)` reads both as they were.
                let several = wanted.len() > 1;
                let kept: Vec<ModelicaValue> =
                    wanted.iter().map(|&(_, v)| if several { self.kept(v) } else { v.clone() }).collect();
                wanted.iter().zip(&kept).try_for_each(|((t, _), v)| self.procedure_assign(t, v, view, s.span))
            }
            StatementKind::Call(call) => self.procedure_call_statement(call, view),
            StatementKind::If { branches, otherwise } => self.procedure_if(branches, otherwise, view),
            StatementKind::For { iterators, body } => self.procedure_for(iterators, body, view),
            StatementKind::While(condition, body) => {
                // Evaluated once: the term reads the slots again at each repetition.
                let c = self.instance.evaluator().eval(condition, view)?;
                let test = self.boolean_term(&c, condition.span)?;
                let body = self.nested(|s| s.procedure_statements(body, view))?;
                self.emit(SlotStatement::While(test, body));
                Some(())
            }
            StatementKind::When(_) => {
                self.instance.fail(Code::Unsupported, "`when` cannot stand in a function", s.span)
            }
            StatementKind::Break => {
                self.emit(SlotStatement::Break);
                Some(())
            }
            StatementKind::Return => {
                self.emit(SlotStatement::Return);
                Some(())
            }
        }
    }

    /// Translates a call as a statement: an `assert`, or a function without outputs. `None` as above.
    /// An assertion in the procedure stops the run with its message when it fails.
    /// The level of the assertion is not looked at.
    fn procedure_call_statement(&mut self, call: &'a Expr, view: LookupContext) -> Option<()> {
        if let ExprKind::Call { function, args, .. } = &call.kind
            && function.parts[0].name.name == "assert"
        {
            let c = self.instance.evaluator().eval(args.first()?, view)?;
            let test = self.boolean_term(&c, call.span)?;
            let text = args
                .get(1)
                .and_then(|m| self.instance.evaluator().eval(m, view))
                // The message is fixed when the model is built: symbolic values in it appear as dots.
                .map(|v| v.in_words(&self.instance.exprs));
            self.emit(SlotStatement::Assert(test, text.unwrap_or_default()));
            return Some(());
        }
        self.instance.evaluator().eval_all(call, view).map(|_| ())
    }

    /// Inserts the statements of a function without outputs into the procedure being translated. `None` after a
    /// message.
    ///
    /// A `return` in it would end the procedure around, so that is refused.
    pub(in crate::instance) fn procedure_body(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<ModelicaValue> {
        self.instance.calls().with_inputs(callee, positional, named, span, |s| {
            s.procedures().locals_in_slots(callee)?;
            for (section, view) in sections(callee) {
                if let Some(end) = section.iter().find(|s| returns(s)) {
                    return s.fail(Code::Unsupported, "a `return` of a function without outputs", end.span);
                }
                s.procedures().procedure_statements(section, view)?;
            }
            Some(ModelicaValue::Tuple(Vec::new().into()))
        })
    }

    /// A Boolean value as a term. `None` after a message, if it is no Boolean.
    /// `span` is the place of the condition for the message.
    fn boolean_term(&mut self, v: &ModelicaValue, span: Span) -> Option<SlotExpr> {
        match v.scalar() {
            Some((e, ScalarType::Boolean)) => Some(self.term(e)),
            _ => self.instance.evaluator().wrong_type("a Boolean", v, span),
        }
    }

    /// Translates `target := value`, where the target may have subscripts and fields. `None` as above.
    ///
    /// The target is followed part by part to the slots that it names. Sizes must agree.
    /// A symbolic subscript at the end is stored through an offset.
    /// Each field of a record has its own slots, which are found by its name.
    fn procedure_assign(
        &mut self,
        target: &'a Expr,
        value: &ModelicaValue,
        view: LookupContext,
        span: Span,
    ) -> Option<()> {
        let (r, i) = self.instance.statements().assigned_local(target)?;
        let name = r.parts[0].name;
        let value = value.first_output();
        let mut place = self.instance.eval.locals[i].1.clone();
        let whole = r.parts.len() == 1 && r.parts[0].subscripts.is_empty() && place.dims() != value.dims();
        // A protected `Real x[:]` has no slots until it gets its first value.
        if whole && place.elements().is_empty() && self.takes_any_size(view, name.name) {
            place = self.slots_like(&value);
            self.instance.eval.locals[i].1 = place.clone();
        }
        for (k, part) in r.parts.iter().enumerate() {
            if k > 0 {
                place = self.instance.evaluator().field(&place, part.name.name, part.name.span)?;
            }
            if !part.subscripts.is_empty() {
                // A symbolic subscript ends the walk: it is stored through an offset, not by naming slots.
                if let Some(done) = self.store_element(&place, (r, k), &value, view, span)? {
                    return Some(done);
                }
                place = self.instance.evaluator().subscript(place, &part.subscripts, view, span)?;
            }
        }
        if place.dims() != value.dims() {
            let message = format!("{} cannot take {}", place.describe(), value.describe());
            return self.instance.fail(Code::SizeMismatch, &message, span);
        }
        self.store(&place, &value);
        Some(())
    }

    /// Whether a protected variable takes the size of what is assigned to it, as `Real x[:]` does.
    /// Outputs do not: their size must be known to the caller before.
    fn takes_any_size(&mut self, view: LookupContext, name: Symbol) -> bool {
        self.instance.statements().is_flexible(view, name)
            && self.instance.statements().declaration(view, name).is_some_and(|c| c.prefix.causality.is_none())
    }

    /// Translates `a[i] := value` with an index that is known only during the run.
    ///
    /// `Some(None)` if all subscripts are known or some are missing: then it is no such assignment.
    /// `None` after a message. `k` is the index of the part of the reference that has the subscripts.
    ///
    /// Only a scalar element of an array of scalars can be stored this way, with no field after the subscripts.
    /// Every other form with a symbolic subscript is reported as unsupported.
    fn store_element(
        &mut self,
        place: &ModelicaValue,
        (r, k): (&'a ComponentReference, usize),
        value: &ModelicaValue,
        view: LookupContext,
        span: Span,
    ) -> Option<Option<()>> {
        let ModelicaValue::Array { dims, elements } = place else { return Some(None) };
        let part = &r.parts[k];
        if part.subscripts.len() != dims.len() {
            return Some(None);
        }
        let mut picks = Vec::new();
        let by = if k == 0 { self.instance.evaluator().counted_by(view, part.name.name) } else { Vec::new() };
        for (i, (s, &n)) in part.subscripts.iter().zip(dims).enumerate() {
            picks.push(self.instance.evaluator().index(s, (n, by.get(i).copied()), view, span)?);
        }
        if !picks.iter().any(|p| matches!(p, SubscriptValue::Symbolic(_))) {
            return Some(None);
        }
        // The elements of a local lie in consecutive slots, so the first slot and an offset suffice.
        let base = elements.first().and_then(|v| v.scalar()).and_then(|(e, _)| self.slot(e));
        let (Some(base), Some((e, _)), true) = (base, value.scalar(), k + 1 == r.parts.len()) else {
            return self.instance.fail(Code::Unsupported, "this assignment needs an index known before the run", span);
        };
        let offset = self.offset(dims, &picks);
        let (offset, value) = (self.term(offset), self.term(e));
        let len = u32::try_from(elements.len()).expect("limited sizes");
        self.emit(SlotStatement::AssignAt { base, len, offset, value });
        Some(Some(()))
    }

    /// The row-major offset of an element as an expression, counted from 0.
    /// There is one entry of `picks` for each dimension, and none of them selects several positions.
    /// `a[i, j]` of size `[2, 3]` has the offset `(i - 1) * 3 + (j - 1)`.
    fn offset(&mut self, dims: &[usize], picks: &[SubscriptValue]) -> ExprId {
        let mut offset = Exprs::ZERO;
        for (p, &d) in picks.iter().zip(dims) {
            let size = self.instance.exprs.num(d as f64);
            offset = self.instance.exprs.mul(offset, size);
            let place = match p {
                SubscriptValue::One(i) => self.instance.exprs.num(*i as f64),
                SubscriptValue::Symbolic(e) => self.instance.exprs.sub(*e, Exprs::ONE),
                SubscriptValue::Many(_) => Exprs::ZERO,
            };
            offset = self.instance.exprs.add(offset, place);
        }
        offset
    }

    /// The element of an array at an index that is known only during the run, as a call of [`ELEMENT`].
    ///
    /// The elements must lie in consecutive slots. An array that does not is copied into new slots first.
    /// `None` if the array has no scalar elements or a subscript selects several: the caller goes on without slots.
    ///
    /// `dims` and `elements` are the array, `picks` the subscripts, one for each dimension.
    /// A copy is made of the values at this point of the procedure, so later assignments do not change it.
    pub(in crate::instance) fn indexed_slot(
        &mut self,
        dims: &[usize],
        elements: &[ModelicaValue],
        picks: &[SubscriptValue],
    ) -> Option<ModelicaValue> {
        if picks.iter().any(|p| matches!(p, SubscriptValue::Many(_))) {
            return None;
        }
        let ty = elements.first()?.scalar()?.1;
        let scalars: Option<Vec<ExprId>> = elements.iter().map(|v| v.scalar().map(|(e, _)| e)).collect();
        let scalars = scalars?;
        let first = self.slot(scalars[0]);
        let lined_up = first.is_some_and(|b| (b..).zip(&scalars).all(|(s, &e)| self.slot(e) == Some(s)));
        let base = match first {
            Some(b) if lined_up => b,
            _ => {
                let base = self.instance.eval.translation.slots;
                self.instance.eval.translation.slots += u32::try_from(scalars.len()).expect("limited sizes");
                for (s, e) in (base..).zip(scalars) {
                    let t = self.term(e);
                    self.emit(SlotStatement::Assign(s, t));
                }
                base
            }
        };
        let offset = self.offset(dims, picks);
        let len = self.instance.exprs.num(elements.len() as f64);
        Some(ModelicaValue::Scalar(self.instance.exprs.call(ELEMENT, base, &[offset, len]), ty))
    }

    /// Translates an `if` statement. Branches that are known to be false are left out. `None` as above.
    /// If all conditions are known to be false, the statements of `else` are inserted without a test.
    fn procedure_if(
        &mut self,
        branches: &'a [(Expr, Vec<Statement>)],
        otherwise: &'a [Statement],
        view: LookupContext,
    ) -> Option<()> {
        let mut tests = Vec::new();
        for (condition, body) in branches {
            let c = self.instance.evaluator().eval(condition, view)?;
            // The branch is dropped only if the condition is false; a true one stays a test, and what follows is never
            // taken.
            if c.as_number(&self.instance.exprs) == Some(0.0) {
                continue;
            }
            let test = self.boolean_term(&c, condition.span)?;
            tests.push((test, self.nested(|s| s.procedure_statements(body, view))?));
        }
        let otherwise = self.nested(|s| s.procedure_statements(otherwise, view))?;
        if tests.is_empty() {
            self.instance.eval.translation.statements.extend(otherwise);
        } else {
            self.emit(SlotStatement::If(tests, otherwise));
        }
        Some(())
    }

    /// Translates a `for` statement over several iterators, the last one innermost. `None` as above.
    /// A range becomes a counting loop. Other vectors are copied into slots, and the loop counts their elements.
    /// The number of repetitions need not be known: the bounds are terms that the procedure evaluates.
    /// An enumeration type gives the numbers of its literals.
    fn procedure_for(
        &mut self,
        iterators: &'a [ast::ForIndex],
        body: &'a [Statement],
        view: LookupContext,
    ) -> Option<()> {
        let Some((first, rest)) = iterators.split_first() else { return self.procedure_statements(body, view) };
        match first.range.as_ref().map(|r| &r.kind) {
            Some(ExprKind::Range { from, step, to }) => {
                let from = self.instance.evaluator().eval(from, view)?;
                // The bounds are terms, so they may depend on inputs and on earlier statements.
                let step = match step {
                    Some(s) => self.instance.evaluator().eval(s, view)?,
                    None => self.instance.evaluator().integer(1.0),
                };
                let to = self.instance.evaluator().eval(to, view)?;
                let ty = from.element_type().unwrap_or(ScalarType::Integer);
                let bounds: Option<Vec<SlotExpr>> =
                    [from, step, to].iter().map(|v| v.scalar().map(|(e, _)| self.term(e))).collect();
                let Some([from, step, to]) = bounds.and_then(|b| <[SlotExpr; 3]>::try_from(b).ok()) else {
                    return self.instance.fail(
                        Code::TypeMismatch,
                        "the bounds of a range are numbers",
                        first.name.span,
                    );
                };
                self.loop_over((first.name.name, LoopValues::Counter(ty)), (from, step, to), rest, body, view)
            }
            _ => {
                let values = self.instance.evaluator().iterate(first, LoopBody::Statements(body), view)?;
                let n = values.len();
                if values.is_empty() {
                    return Some(());
                }
                let elements = LoopValues::Elements(ModelicaValue::array(vec![n], values));
                let bounds = (SlotExpr::Num(1.0), SlotExpr::Num(1.0), SlotExpr::Num(n as f64));
                self.loop_over((first.name.name, elements), bounds, rest, body, view)
            }
        }
    }

    /// Emits a loop over the slot of a counter. `None` as above.
    ///
    /// The counter goes `from` a value by a step `to` its last value.
    /// `rest` are the remaining iterators, which are translated inside.
    fn loop_over(
        &mut self,
        (name, values): (Symbol, LoopValues),
        (from, step, to): (SlotExpr, SlotExpr, SlotExpr),
        rest: &'a [ast::ForIndex],
        body: &'a [Statement],
        view: LookupContext,
    ) -> Option<()> {
        let counter = self.slots_like(&ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Integer));
        let (index, _) = counter.scalar()?;
        let slot = self.slot(index)?;
        // The loop variable is a slot or an element; it is visible in the body only.
        let value = match &values {
            LoopValues::Counter(ty) => ModelicaValue::Scalar(index, *ty),
            LoopValues::Elements(a) => self.indexed_slot(a.dims(), a.elements(), &[SubscriptValue::Symbolic(index)])?,
        };
        self.instance.eval.locals.push((name, value));
        let body = self.nested(|s| s.procedure_for(rest, body, view));
        self.instance.eval.locals.pop();
        self.emit(SlotStatement::For { slot, from, step, to, body: body? });
        Some(())
    }

    /// An expression of the pool as a term over slots.
    ///
    /// Relations and roundings raise no events in a procedure, and `homotopy` is its actual expression.
    ///
    /// Variables from [`LOCAL`] on are slots. Calls of [`ELEMENT`] are elements at a computed offset.
    /// Calls of other functions stay calls.
    fn term(&mut self, e: ExprId) -> SlotExpr {
        match self.instance.exprs.node(e) {
            ExprNode::Num(bits) => SlotExpr::Num(f64::from_bits(bits)),
            ExprNode::Var(v) if v.0 >= LOCAL => SlotExpr::Slot(v.0 - LOCAL),
            // A loop of a model may read anything of the model; that is handed over instead of being translated.
            _ if self.instance.eval.translation.captures.is_some() && !self.uses_slots(e) => self.captured(e),
            ExprNode::Unary(op, a) => SlotExpr::Unary(op, self.boxed(a)),
            ExprNode::Binary(op, a, b) => SlotExpr::Binary(op, self.boxed(a), self.boxed(b)),
            ExprNode::Rel(rel, a, b) | ExprNode::EventRel(rel, a, b) => {
                SlotExpr::Rel(rel, self.boxed(a), self.boxed(b))
            }
            ExprNode::EventFloor(a) => SlotExpr::Unary(bramah_expr::UnaryFunction::Floor, self.boxed(a)),
            ExprNode::If(c, a, b) => SlotExpr::If(self.boxed(c), self.boxed(a), self.boxed(b)),
            ExprNode::Homotopy(a, _) => self.term(a),
            ExprNode::Call(ELEMENT, base, args) => {
                let args = self.instance.exprs.args(args);
                let (offset, len) = (args[0], self.instance.exprs.as_num(args[1]).unwrap_or(0.0) as u32);
                SlotExpr::At { base, len, offset: self.boxed(offset) }
            }
            ExprNode::Call(f, output, args) => {
                let args = self.instance.exprs.args(args).to_vec();
                SlotExpr::Call(f, output, args.into_iter().map(|a| self.term(a)).collect())
            }
            // No other node can occur in a function. NaN makes an error of the compiler visible in the results.
            _ => SlotExpr::Num(f64::NAN),
        }
    }

    /// A boxed term, as operators need their operands.
    fn boxed(&mut self, e: ExprId) -> Box<SlotExpr> {
        Box::new(self.term(e))
    }

    /// Whether an expression reads slots of the procedure, directly or through array elements.
    fn uses_slots(&self, e: ExprId) -> bool {
        let slot = |e: &ExprId| match self.instance.exprs.node(*e) {
            ExprNode::Var(v) => v.0 >= LOCAL,
            ExprNode::Call(f, ..) => f == ELEMENT,
            _ => false,
        };
        self.instance.exprs.reachable(&[e], |_| true).iter().any(slot)
    }

    /// The slot in which an expression of the model is handed over to a loop. It is added if it is new.
    fn captured(&mut self, e: ExprId) -> SlotExpr {
        let captures = self.instance.eval.translation.captures.get_or_insert_default();
        let at = captures.iter().position(|&c| c == e).unwrap_or_else(|| {
            captures.push(e);
            captures.len() - 1
        });
        SlotExpr::Slot(u32::try_from(at).expect("limited sizes"))
    }
}

/// Whether a statement contains a `return`.
/// `when` statements are not searched: they cannot stand in a function.
fn returns(s: &Statement) -> bool {
    match &s.kind {
        StatementKind::Return => true,
        StatementKind::If { branches, otherwise } => {
            branches.iter().flat_map(|(_, body)| body).chain(otherwise).any(returns)
        }
        StatementKind::For { body, .. } | StatementKind::While(_, body) => body.iter().any(returns),
        _ => false,
    }
}
