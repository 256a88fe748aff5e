//! Algorithm sections of components: every variable that a section assigns gets the value it has at the end (MLS 11.1).

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
    /// An algorithm section: every variable it assigns gets the value it has at the end (MLS 11.1).
    pub(super) fn algorithm(&mut self, section: &'a [Statement], view: LookupContext, initial: bool) {
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

    /// An `assert` or `terminate` inside a `when` of an algorithm section.
    pub(super) fn algorithm_action(&mut self, call: AlgorithmCall, view: LookupContext, out: &mut Vec<WhenAction>) {
        let origin = self.origin(call.span, view);
        if call.condition.is_none() {
            out.push(WhenAction::Terminate { message: message(call.message), guard: call.guard, origin });
            return;
        }
        out.extend(assert_of(self.instance, call, origin).map(WhenAction::Assert));
    }

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

    /// What the variables that the section assigns hold before it: their `pre` value if discrete, their start value else.
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
