//! Algorithm sections of components: every variable that a section assigns gets the value it has at the end (MLS 11.1).
//!
//! Enters: the statements of a section. Leaves: one equation for each scalar that the section assigns, a `WhenClause`
//! for each `when` statement, and assertions. The statements are executed on symbolic values: the assigned variables
//! are local copies that start from their values before the section. `EquationFlattener::body` calls
//! [`EquationFlattener::algorithm`].

use super::equations::{EquationFlattener, EquationSides, assert_of, message};
use super::{ScalarType, Variability, WhenAction, WhenBranch, WhenClause};
use crate::instance::algorithm::{AlgorithmBranch, AlgorithmCall, AlgorithmWhen, assigned};
use crate::instance::value::ModelicaValue;
use crate::instance::{Instance, LookupContext};
use bramah_expr::{ExprId, ExprNode, Exprs};
use bramah_syntax::ast::{self, Statement};
use bramah_syntax::diag::{Code, Diagnostic};
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashSet;

impl<'a> EquationFlattener<'_, 'a, '_> {
    /// Translates a section. `initial` sections give initial equations.
    ///
    /// Loops over known ranges are executed; a section with other loops is refused (E017) unless the instance can make
    /// a program of it. The order of the results is: equations, clauses, assertions.
    pub(super) fn algorithm(&mut self, section: &'a [Statement], view: LookupContext, initial: bool) {
        let (mut always, mut in_when) = (Vec::new(), Vec::new());
        assigned(section, false, &mut always, &mut in_when);
        let mut originals: Vec<AlgorithmTarget> = Vec::new();
        let mut count = 0;
        // An element is assigned as a whole or in parts, at several places: one copy serves all of them.
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
            // Which scalars of the element are assigned at all, and which of them inside a `when`.
            let (all, in_when) = (scalars(&targets), scalars(&in_when));
            let start = self.algorithm_start(&own, &all, &in_when);
            originals.push(AlgorithmTarget { name, own, in_when });
            self.instance.statements().push_local(name, start);
            count += 1;
        }
        // All copies must be taken off the stack again, also after an error.
        let done = self.instance.statements().run_section(section, view, count);
        let results: Vec<ModelicaValue> = self.instance.statements().take_locals(count);
        let whens = self.instance.statements().take_whens();
        let calls = self.instance.statements().take_calls();
        // The message for this is made only if no other error explains it.
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

    /// Adds an `assert` or `terminate` of a section outside `when`. One of an initial section counts at the start only:
    /// a `terminate` there becomes an action of `when initial()`.
    /// A `terminate` in a section that is not initial is reported (E021).
    pub(super) fn algorithm_call(&mut self, call: AlgorithmCall, view: LookupContext, initial: bool) {
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

    /// Adds an `assert` or `terminate` inside a `when` to the actions of its branch. A call without a condition is a
    /// `terminate`.
    /// `when` equations use it for the calls inside them as well.
    pub(super) fn algorithm_action(&mut self, call: AlgorithmCall, view: LookupContext, out: &mut Vec<WhenAction>) {
        let origin = self.origin(call.span, view);
        if call.condition.is_none() {
            out.push(WhenAction::Terminate { message: message(call.message), guard: call.guard, origin });
            return;
        }
        out.extend(assert_of(self.instance, call, origin).map(WhenAction::Assert));
    }

    /// Reports a section that could not be executed, unless another error explains it.
    /// The code is E017; the help is to move the section into a function.
    pub(super) fn section_failed(&mut self, section: &'a [Statement]) {
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

    /// The value of an element before the section. A scalar that the section assigns holds its `pre` value if it is
    /// discrete, else its start value (MLS 11.1.2). A scalar that it does not assign is itself.
    ///
    /// Scalars that are assigned inside a `when`, and scalars that are not Real, are discrete.
    pub(super) fn algorithm_start(
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

    /// Adds one equation for each scalar that the section changes. Scalars that a `when` assigns are left to the
    /// clause.
    ///
    /// The place of all equations is the first statement of the section.
    /// Initial sections give initial equations.
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
                // Equal expressions: nothing was assigned to the scalar.
                if x != y && !(held && in_when.contains(&x)) {
                    pairs.push(EquationSides { lhs: x, rhs: y, span });
                }
                x
            });
            self.push(pairs, view, initial);
        }
    }

    /// Adds the clause of a `when` statement: an assignment for each scalar of its branches, then its assertions.
    /// Only the scalars in `in_when` are assigned; for the others the section has equations.
    /// Branches keep their order and conditions.
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

/// An element of which a section assigns something.
/// A record or an array that is assigned in parts is one target.
struct AlgorithmTarget {
    /// Its name.
    name: Symbol,
    /// Its variables, as a value of the same shape.
    own: ModelicaValue,
    /// The scalars of it that are assigned inside a `when`.
    in_when: FxHashSet<ExprId>,
}

/// Collects the scalars of a value that references name. `targets` are the parts of the references below the value; an
/// empty one names all of it. Of an array all elements count, whatever the indices say.
/// So an algorithm that assigns `x[i]` counts as one that may assign every element of `x`.
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

/// Merges several `when` statements that assign one variable into one clause: of those that fire at once the last one
/// counts (MLS 11.2.7).
///
/// Where one of them reads what another assigns, or a branch does not assign the variable, they stay as they are; the
/// variable is then determined twice, which is reported later.
///
/// The merged clause lists the branches of the last statement first. It is placed after the last of the statements.
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
        // The first branch of a clause has priority, so the last statement comes first.
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
    // Statements whose assignments have all moved are empty.
    whens.retain(|w| w.branches.iter().any(|b| !b.values.is_empty() || !b.calls.is_empty()));
    whens
}
