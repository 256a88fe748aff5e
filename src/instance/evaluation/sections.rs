//! Doors for `flat`, which walks the equations and algorithm sections.

use crate::instance::algorithm::{AlgorithmCall, AlgorithmWhen};
use crate::instance::deduce::Body;
use crate::instance::evaluation::state::Work;
use crate::instance::lookup::Found;
use crate::instance::value::Val;
use crate::instance::{Instance, View};
use crate::syntax::ast::{Equation, Expr, Iterator as LoopIterator, ReferencePart, Statement};
use crate::syntax::symbol::Symbol;

impl<'a> Instance<'a, '_> {
    /// Runs something for every value of the iterators, innermost last.
    pub fn for_each(
        &mut self,
        iterators: &'a [LoopIterator],
        repeated: Body<'a>,
        view: View,
        body: &mut dyn FnMut(&mut Self),
    ) {
        let Some((first, rest)) = iterators.split_first() else { return body(self) };
        let Some(values) = self.iterate(first, repeated, view) else { return };
        for value in values {
            self.eval.locals.push((first.name.name, value));
            self.for_each(rest, repeated, view, body);
            self.eval.locals.pop();
        }
    }

    /// The values of a loop variable.
    pub fn loop_values(&mut self, iterator: &'a LoopIterator, body: &'a [Equation], view: View) -> Option<Vec<Val>> {
        self.iterate(iterator, Body::Equations(body), view)
    }

    /// Enters a loop variable.
    pub fn push_local(&mut self, name: Symbol, value: Val) {
        self.eval.locals.push((name, value));
    }

    /// Leaves the innermost loop variable.
    pub fn pop_local(&mut self) {
        self.eval.locals.pop();
    }

    /// Switches events of relations off or on; returns what was before.
    pub fn set_no_event(&mut self, off: bool) -> bool {
        std::mem::replace(&mut self.eval.mode.no_event, off)
    }

    /// The whole value of an element named in an algorithm section.
    pub fn element_value(&mut self, view: View, part: &ReferencePart) -> Option<Val> {
        match self.lookup(view, part.name.name) {
            Some(Found::Component(scope, index)) => {
                let node = self.component(scope, index)?;
                self.node_value(node, part.name.span)
            }
            _ => {
                let names = self.visible_names(view);
                self.unknown_name(part.name.name, part.name.span, &names);
                None
            }
        }
    }

    /// Carries out an algorithm section of the model on the `count` locals that were pushed for it.
    pub fn run_section(&mut self, section: &'a [Statement], view: View, count: usize) -> Option<()> {
        self.eval.work = Work::allowed([MOST_SECTION_STEPS, MOST_SECTION_STEPS]);
        self.eval.not_inline = false;
        let end = self.eval.locals.len();
        self.eval.section = end - count..end;
        self.eval.calls.clear();
        self.eval.guards.clear();
        let done = self.execute(section, view).map(|_| ());
        self.eval.section = 0..0;
        done
    }

    /// Calls a function for what it asserts.
    pub fn call_keeping_assertions(&mut self, call: &'a Expr, view: View) -> Vec<AlgorithmCall> {
        self.eval.calls.clear();
        self.in_mode(|m| m.keep_asserts = true, |s| s.eval_all(call, view));
        std::mem::take(&mut self.eval.calls)
    }

    /// Removes the last locals and hands out their values.
    pub fn take_locals(&mut self, count: usize) -> Vec<Val> {
        let at = self.eval.locals.len() - count;
        self.eval.locals.split_off(at).into_iter().map(|(_, v)| v).collect()
    }

    /// What must hold besides equations, and `terminate`s, met outside `when` since the last call.
    pub fn take_calls(&mut self) -> Vec<AlgorithmCall> {
        std::mem::take(&mut self.eval.calls)
    }

    /// The `when`s met since the last call.
    pub fn take_whens(&mut self) -> Vec<AlgorithmWhen> {
        std::mem::take(&mut self.eval.whens)
    }
}

/// Most statements of an algorithm section of a model.
pub(in crate::instance) const MOST_SECTION_STEPS: usize = 1_000_000;
