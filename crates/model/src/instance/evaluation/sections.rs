//! Entry points for `flat`, which walks through the equations and algorithm sections of the component tree.
//!
//! `flat` enters loop variables, pushes the variables of an algorithm section as locals, runs the section, and collects
//! the results: the locals' values, and the assertions and `when` statements on the way.

use crate::instance::algorithm::{AlgorithmCall, AlgorithmWhen};
use crate::instance::deduce::LoopBody;
use crate::instance::evaluation::state::StatementBudget;
use crate::instance::lookup::LookupResult;
use crate::instance::value::{ModelicaValue, RecordValue};
use crate::instance::{Instance, InstanceNode, LookupContext, NodeId, Statements};
use bramah_syntax::ast::{
    ClassKind, ComponentReference, Equation, Expr, ForIndex as LoopIterator, ReferencePart, Statement,
};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

impl<'a> Statements<'_, 'a, '_> {
    /// Runs `body` once for each combination of the iterators' values; the last iterator varies fastest.
    /// The loop variables are locals meanwhile. Without a valid range nothing is run, and a message was reported.
    /// `repeated` is what the loop repeats, for iterators without a range.
    pub fn for_each(
        &mut self,
        iterators: &'a [LoopIterator],
        repeated: LoopBody<'a>,
        view: LookupContext,
        body: &mut dyn FnMut(&mut Instance<'a, '_>),
    ) {
        let Some((first, rest)) = iterators.split_first() else { return body(self.instance) };
        let Some(values) = self.instance.evaluator().iterate(first, repeated, view) else { return };
        for value in values {
            self.instance.eval.locals.push((first.name.name, value));
            self.for_each(rest, repeated, view, body);
            self.instance.eval.locals.pop();
        }
    }

    /// The values of the variable of a `for` equation, in order. `None` after a message.
    pub fn loop_values(
        &mut self,
        iterator: &'a LoopIterator,
        body: &'a [Equation],
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        self.instance.evaluator().iterate(iterator, LoopBody::Equations(body), view)
    }

    /// Makes a loop variable visible.
    pub fn push_local(&mut self, name: Symbol, value: ModelicaValue) {
        self.instance.eval.locals.push((name, value));
    }

    /// Removes the innermost loop variable.
    pub fn pop_local(&mut self) {
        self.instance.eval.locals.pop();
    }

    /// Switches events of relations off or on. Returns whether they were off before.
    pub fn set_no_event(&mut self, off: bool) -> bool {
        std::mem::replace(&mut self.instance.eval.mode.no_event, off)
    }

    /// The value with which an algorithm section starts for one component: `targets` are the references it assigns.
    ///
    /// All of them begin with the same name. A record is taken completely. A component that is no record has no value,
    /// so only the assigned parts are collected. `None` after a message.
    pub fn assigned_value(&mut self, view: LookupContext, targets: &[&'a ComponentReference]) -> Option<ModelicaValue> {
        let first = &targets.first()?.parts[0];
        match self.instance.names().lookup(view, first.name.name) {
            Some(LookupResult::Component(scope, index)) => {
                let node = self.instance.builder().component(scope, index)?;
                let parts: Vec<&'a [ReferencePart]> = targets.iter().map(|r| &r.parts[1..]).collect();
                self.assigned_parts(node, &parts, first)
            }
            _ => {
                let names = self.instance.evaluator().visible_names(view);
                self.instance.evaluator().unknown_name(first.name.name, first.name.span, &names);
                None
            }
        }
    }

    /// The value of a node, restricted to the parts that `targets` name if it is no record.
    /// `targets` hold the parts of the references below the node; `named` is the part that named it, for messages.
    ///
    /// - A record or a variable gives its complete value.
    /// - An array of components gives an array of what its elements give.
    /// - Another component gives a record with only the assigned parts as fields.
    ///
    /// A name that does not exist is reported.
    /// `targets` may go through the same element several times.
    fn assigned_parts(
        &mut self,
        node: NodeId,
        targets: &[&'a [ReferencePart]],
        named: &ReferencePart,
    ) -> Option<ModelicaValue> {
        let scope = match self.instance.node(node) {
            InstanceNode::Object(scope) => *scope,
            InstanceNode::Array { dims, elements, .. }
                if matches!(self.instance.node(elements.first().copied()?), InstanceNode::Object(_)) =>
            {
                let (dims, elements) = (dims.clone(), elements.clone());
                let values: Option<Vec<ModelicaValue>> =
                    elements.iter().map(|&node| self.assigned_parts(node, targets, named)).collect();
                return Some(ModelicaValue::array(dims, values?));
            }
            _ => return self.instance.evaluator().node_value(node, named.name.span),
        };
        let template = self.instance.scope(scope).template.clone();
        let is_value = matches!(template.kind, ClassKind::Record { .. } | ClassKind::Connector { .. });
        // A record is assigned as one value, and so is a node that a target names itself.
        if is_value || targets.iter().any(|parts| parts.is_empty()) {
            return self.instance.evaluator().node_value(node, named.name.span);
        }
        let mut fields: Vec<(Symbol, ModelicaValue)> = Vec::new();
        for part in targets.iter().map(|parts| &parts[0]) {
            // Several targets may go through one element: it is collected once, with all of them.
            if fields.iter().any(|(name, _)| *name == part.name.name) {
                continue;
            }
            let element = template.elements.iter().position(|e| e.name == part.name.name);
            let Some(node) = element.and_then(|i| self.instance.builder().component(scope, i as u32)) else {
                let names: Vec<Symbol> = template.elements.iter().map(|e| e.name).collect();
                self.instance.evaluator().unknown_name(part.name.name, part.name.span, &names);
                return None;
            };
            let below = targets.iter().filter(|parts| parts[0].name.name == part.name.name).map(|parts| &parts[1..]);
            let below: Vec<&'a [ReferencePart]> = below.collect();
            fields.push((part.name.name, self.assigned_parts(node, &below, part)?));
        }
        Some(ModelicaValue::Record(Rc::new(RecordValue { fields, class: None })))
    }

    /// Executes an algorithm section of the model on the last `count` locals, which stand for its variables.
    /// `None` after a message.
    pub fn run_section(&mut self, section: &'a [Statement], view: LookupContext, count: usize) -> Option<()> {
        self.instance.eval.work = StatementBudget::allowed([MOST_SECTION_STEPS, MOST_SECTION_STEPS]);
        self.instance.eval.not_inline = false;
        let end = self.instance.eval.locals.len();
        self.instance.eval.section = end - count..end;
        self.instance.eval.calls.clear();
        self.instance.eval.guards.clear();
        let done = self.execute(section, view).map(|_| ());
        // An empty range: after the section no local stands for a variable.
        self.instance.eval.section = 0..0;
        done
    }

    /// Calls a function for the sake of its assertions, and returns these.
    pub fn call_keeping_assertions(&mut self, call: &'a Expr, view: LookupContext) -> Vec<AlgorithmCall> {
        self.instance.eval.calls.clear();
        self.instance.in_mode(|m| m.keep_asserts = true, |s| s.evaluator().eval_all(call, view));
        std::mem::take(&mut self.instance.eval.calls)
    }

    /// Removes the last `count` locals and returns their values, in the order in which they were pushed.
    pub fn take_locals(&mut self, count: usize) -> Vec<ModelicaValue> {
        let at = self.instance.eval.locals.len() - count;
        self.instance.eval.locals.split_off(at).into_iter().map(|(_, v)| v).collect()
    }

    /// The assertions and `terminate` calls outside of `when` since the last call of this function.
    pub fn take_calls(&mut self) -> Vec<AlgorithmCall> {
        std::mem::take(&mut self.instance.eval.calls)
    }

    /// The `when` statements since the last call of this function.
    pub fn take_whens(&mut self) -> Vec<AlgorithmWhen> {
        std::mem::take(&mut self.instance.eval.whens)
    }
}

/// The most statements executed for one algorithm section of a model.
pub(in crate::instance) const MOST_SECTION_STEPS: usize = 1_000_000;
