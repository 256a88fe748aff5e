//! Doors for `flat`, which walks the equations and algorithm sections.

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
    /// Runs something for every value of the iterators, innermost last.
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

    /// The values of a loop variable.
    pub fn loop_values(
        &mut self,
        iterator: &'a LoopIterator,
        body: &'a [Equation],
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        self.instance.evaluator().iterate(iterator, LoopBody::Equations(body), view)
    }

    /// Enters a loop variable.
    pub fn push_local(&mut self, name: Symbol, value: ModelicaValue) {
        self.instance.eval.locals.push((name, value));
    }

    /// Leaves the innermost loop variable.
    pub fn pop_local(&mut self) {
        self.instance.eval.locals.pop();
    }

    /// Switches events of relations off or on; returns what was before.
    pub fn set_no_event(&mut self, off: bool) -> bool {
        std::mem::replace(&mut self.instance.eval.mode.no_event, off)
    }

    /// The value of an element of which an algorithm section assigns these parts; of a component that is no value only these.
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

    /// What these references, which begin below it, name of a node.
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
        if is_value || targets.iter().any(|parts| parts.is_empty()) {
            return self.instance.evaluator().node_value(node, named.name.span);
        }
        let mut fields: Vec<(Symbol, ModelicaValue)> = Vec::new();
        for part in targets.iter().map(|parts| &parts[0]) {
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

    /// Carries out an algorithm section of the model on the `count` locals that were pushed for it.
    pub fn run_section(&mut self, section: &'a [Statement], view: LookupContext, count: usize) -> Option<()> {
        self.instance.eval.work = StatementBudget::allowed([MOST_SECTION_STEPS, MOST_SECTION_STEPS]);
        self.instance.eval.not_inline = false;
        let end = self.instance.eval.locals.len();
        self.instance.eval.section = end - count..end;
        self.instance.eval.calls.clear();
        self.instance.eval.guards.clear();
        let done = self.execute(section, view).map(|_| ());
        self.instance.eval.section = 0..0;
        done
    }

    /// Calls a function for what it asserts.
    pub fn call_keeping_assertions(&mut self, call: &'a Expr, view: LookupContext) -> Vec<AlgorithmCall> {
        self.instance.eval.calls.clear();
        self.instance.in_mode(|m| m.keep_asserts = true, |s| s.evaluator().eval_all(call, view));
        std::mem::take(&mut self.instance.eval.calls)
    }

    /// Removes the last locals and hands out their values.
    pub fn take_locals(&mut self, count: usize) -> Vec<ModelicaValue> {
        let at = self.instance.eval.locals.len() - count;
        self.instance.eval.locals.split_off(at).into_iter().map(|(_, v)| v).collect()
    }

    /// What must hold besides equations, and `terminate`s, met outside `when` since the last call.
    pub fn take_calls(&mut self) -> Vec<AlgorithmCall> {
        std::mem::take(&mut self.instance.eval.calls)
    }

    /// The `when`s met since the last call.
    pub fn take_whens(&mut self) -> Vec<AlgorithmWhen> {
        std::mem::take(&mut self.instance.eval.whens)
    }
}

/// Most statements of an algorithm section of a model.
pub(in crate::instance) const MOST_SECTION_STEPS: usize = 1_000_000;
