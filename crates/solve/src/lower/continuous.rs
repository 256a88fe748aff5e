//! Definitions of the IDA system: residual, Jacobian, root functions, conserved quantities, and observed variables.
//!
//! The plan of `eliminate` enters; drafts leave, from which `ProgramDrafts` makes the programs.

use super::eliminate::{AssignmentFate, ContinuousPlan};
use super::jacobian::{Differentials, JacobianEntry, compress};
use super::layout::{ValueLayout, ValueSlot, slot};
use super::program::KernelDefinitions;
use super::shape::{KernelShaper, KernelTable, ShapingRules};
use super::{ConservedIntegral, ResidualRowKind, SparsityPattern};
use bramah_expr::VarId;
use bramah_model::structure::{CrossingKind, Dae, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// The definitions of residual and Jacobian.
#[derive(Debug)]
pub struct ContinuousDraft {
    /// Explicit variables with slots of their own, and right sides of rows.
    pub residual: KernelDefinitions,
    /// For each row the slot of its right side.
    pub row_slots: Vec<ValueSlot>,
    /// The same definitions with their derivatives.
    pub jacobian: Differentials,
    /// Pattern of the Jacobian.
    pub pattern: SparsityPattern,
    /// For each entry the slots of the terms with plus and minus sign.
    pub entries: Vec<(ValueSlot, ValueSlot)>,
}

/// Makes the definitions of residual and Jacobian.
///
/// Both contain the same definitions: local explicit variables first, then the right sides of rows. The Jacobian adds
/// their derivatives.
pub fn draft(plan: &ContinuousPlan, shaper: &mut KernelShaper) -> ContinuousDraft {
    let rules = ShapingRules { initial: false, inline: &plan.inline, hoist: true };
    let (mut residual, mut jacobian) = (KernelDefinitions::default(), Differentials::default());
    seed(plan, &mut jacobian, &mut shaper.layout);
    let mut define = |value, target, is_read, shaper: &mut KernelShaper| {
        let shaped = shaper.shape(value, &rules);
        residual.define(&mut shaper.kernels, target, &shaped);
        jacobian.define(shaper, target, &shaped, is_read);
    };
    let mut targets: Vec<ValueSlot> = Vec::with_capacity(plan.explicit.len());
    for (i, assign) in plan.explicit.iter().enumerate() {
        let own = slot(shaper.layout.unknown(assign.unknown));
        // a kept variable is an unknown: its own slot holds the value of IDA, so the right side needs another one
        let target = if plan.fates[i] == AssignmentFate::Kept { shaper.layout.work(1) } else { own };
        if let AssignmentFate::Local | AssignmentFate::Kept = plan.fates[i] {
            // the Jacobian needs the values of variables that other definitions read
            let is_read = plan.fates[i] == AssignmentFate::Local && plan.users[i] > 0;
            define(assign.value, target, is_read, shaper);
        }
        targets.push(target);
    }
    let mut row_slots = Vec::with_capacity(plan.rows.len());
    for (row, &explicit) in plan.rows.iter().zip(&plan.row_explicit) {
        row_slots.push(explicit.map_or_else(
            || {
                let target = shaper.layout.work(1);
                define(row.value, target, false, shaper);
                target
            },
            |i| targets[i],
        ));
    }
    let (pattern, entries) = matrix(plan, &row_slots, &jacobian, &mut shaper.layout);
    ContinuousDraft { residual, row_slots, jacobian, pattern, entries }
}

/// Starts the chain rule: an unknown has derivative 1 in its column, the derivative of a state has derivative cj.
fn seed(plan: &ContinuousPlan, jacobian: &mut Differentials, layout: &mut ValueLayout) {
    let one = layout.number(1.0);
    for (j, column) in (0..).zip(&plan.columns) {
        jacobian.seed(slot(layout.var(column.variable)), j, one);
    }
    for &(column, der) in &plan.torn {
        jacobian.seed(der, slot(column), slot(ValueLayout::CJ));
    }
}

/// Pattern and slots of the Jacobian.
///
/// In rows of the form `der(x) - value` and `v - value` the derivatives of the value have a minus sign.
fn matrix(
    plan: &ContinuousPlan,
    row_slots: &[ValueSlot],
    jacobian: &Differentials,
    layout: &mut ValueLayout,
) -> (SparsityPattern, Vec<(ValueSlot, ValueSlot)>) {
    let (zero, one) = (layout.number(0.0), layout.number(1.0));
    let mut entries = Vec::new();
    for (i, (row, &place)) in (0..).zip(plan.rows.iter().zip(row_slots)) {
        let diagonal = match row.kind {
            ResidualRowKind::Derivative => Some(slot(ValueLayout::CJ)),
            ResidualRowKind::Explicit => Some(one),
            ResidualRowKind::Follows(_) => Some(one),
            ResidualRowKind::Residual => None,
        };
        // the row q - quantity(x) has its 1 in the column of the quantity, not on the diagonal
        let own = if let ResidualRowKind::Follows(column) = row.kind { slot(column) } else { i };
        entries.extend(diagonal.map(|plus| JacobianEntry { column: own, row: i, plus, minus: zero }));
        for &(column, derivative) in jacobian.gradient(place) {
            let (plus, minus) = if diagonal.is_some() { (zero, derivative) } else { (derivative, zero) };
            entries.push(JacobianEntry { column, row: i, plus, minus });
        }
    }
    compress(plan.columns.len(), entries, zero)
}

/// Everything that follows explicitly from the unknowns of IDA, for outputs, crossings and assertions.
#[derive(Clone, Debug, Default)]
pub struct Observables {
    /// Explicit assignments in order (without those that are unknowns of IDA), then aliases.
    pub defs: KernelDefinitions,
    /// For each slot the definition that computes it.
    producer: FxHashMap<ValueSlot, u32>,
}

impl Observables {
    /// The definitions of all explicit variables and aliases.
    pub fn new(dae: &Dae, plan: &ContinuousPlan, shaper: &mut KernelShaper) -> Observables {
        let mut observables = Observables::default();
        let inline = FxHashMap::default();
        let rules = ShapingRules { initial: false, inline: &inline, hoist: true };
        for (assign, &fate) in plan.explicit.iter().zip(&plan.fates) {
            if fate != AssignmentFate::Kept {
                let target = slot(shaper.layout.unknown(assign.unknown));
                let shaped = shaper.shape(assign.value, &rules);
                observables.producer.insert(target, slot(observables.defs.len()));
                observables.defs.define(&mut shaper.kernels, target, &shaped);
            }
        }
        for alias in &dae.aliases {
            let input = shaper.kernels.pool.var(VarId(0));
            let value = if alias.negated { shaper.kernels.pool.neg(input) } else { input };
            let (from, to) = (slot(shaper.layout.var(alias.target)), slot(shaper.layout.var(alias.variable)));
            observables.producer.insert(to, slot(observables.defs.len()));
            observables.defs.push(&mut shaper.kernels, vec![value], &[from], &[to]);
        }
        observables
    }

    /// The definitions that these slots depend on, directly or through other definitions, in order.
    pub fn needed(&self, kernels: &KernelTable, slots: impl IntoIterator<Item = ValueSlot>) -> KernelDefinitions {
        let mut wanted: FxHashSet<u32> = FxHashSet::default();
        let mut stack: Vec<ValueSlot> = slots.into_iter().collect();
        while let Some(slot) = stack.pop() {
            if let Some(&i) = self.producer.get(&slot)
                && wanted.insert(i)
            {
                stack.extend_from_slice(self.defs.get(kernels, i as usize).1);
            }
        }
        // hash sets have no fixed order; the numbers of the definitions have
        let mut chosen: Vec<usize> = wanted.into_iter().map(|i| i as usize).collect();
        chosen.sort_unstable();
        self.defs.select(kernels, chosen)
    }

    /// `defs`, preceded by all observables that they depend on.
    pub fn before(&self, kernels: &KernelTable, defs: &KernelDefinitions) -> KernelDefinitions {
        let read = (0..defs.len()).flat_map(|i| defs.get(kernels, i).1.iter().copied());
        let mut all = self.needed(kernels, read);
        all.append(defs);
        all
    }
}

/// The definitions of conserved quantities and their rates.
#[derive(Debug, Default)]
pub struct QuantitiesDraft {
    /// Quantities and rates from the slots of variables.
    pub defs: KernelDefinitions,
    /// Each quantity by itself.
    pub alone: Vec<KernelDefinitions>,
    /// The quantities with their columns and slots. The places in the Jacobian are added later.
    pub integrals: Vec<ConservedIntegral>,
}

/// The definitions of conserved quantities.
///
/// A quantity has a slot of its own, apart from the unknown of the same name in the integrator. Its rate goes into the
/// slot of the derivative.
pub fn quantities(plan: &ContinuousPlan, shaper: &mut KernelShaper) -> QuantitiesDraft {
    let mut draft = QuantitiesDraft::default();
    let inline = FxHashMap::default();
    let rules = ShapingRules { initial: false, inline: &inline, hoist: true };
    for &(conserved, column, state) in &plan.integrals {
        let (slot, slope) = (shaper.layout.work(1), shaper.layout.work(1));
        let rate = self::slot(shaper.layout.unknown(Unknown::Der(conserved.variable)));
        let [quantity, growth] = [conserved.quantity, conserved.rate].map(|e| shaper.shape(e, &rules));
        let mut alone = KernelDefinitions::default();
        alone.define(&mut shaper.kernels, slot, &quantity);
        draft.defs.append(&alone);
        draft.defs.define(&mut shaper.kernels, rate, &growth);
        draft.alone.push(alone);
        draft.integrals.push(ConservedIntegral { column, state, slot, slope, entry: None, row: Vec::new() });
    }
    draft
}

/// The definitions of the root functions.
#[derive(Debug, Default)]
pub struct CrossingsDraft {
    /// The entries of `dae.crossings` that have a root function.
    pub list: Vec<usize>,
    /// The root functions, computed from the slots of variables.
    pub defs: KernelDefinitions,
    /// The slot of each root function.
    pub slots: Vec<ValueSlot>,
}

/// The definitions of the root functions: left minus right side of a relation, or the argument of a `floor`.
pub fn crossings(dae: &Dae, shaper: &mut KernelShaper) -> CrossingsDraft {
    let mut draft = CrossingsDraft::default();
    let inline = FxHashMap::default();
    let rules = ShapingRules { initial: false, inline: &inline, hoist: true };
    for (i, crossing) in dae.crossings.iter().enumerate() {
        let (e, inputs) = match crossing.kind {
            CrossingKind::Relation(_, left, right) => {
                let (sides, inputs) = shaper.shape_all(&[left, right], &rules);
                (shaper.kernels.pool.sub(sides[0], sides[1]), inputs)
            }
            CrossingKind::Floor(argument) => {
                let shaped = shaper.shape(argument, &rules);
                (shaped.expr, shaped.inputs)
            }
            // known times are scheduled, not searched for
            CrossingKind::Time(..) => continue,
        };
        let target = shaper.layout.work(1);
        draft.defs.push(&mut shaper.kernels, vec![e], &inputs, &[target]);
        draft.slots.push(target);
        draft.list.push(i);
    }
    draft
}
