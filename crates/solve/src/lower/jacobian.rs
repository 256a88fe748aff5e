//! Exact sparse derivatives by the chain rule (forward accumulation on kernels).
//!
//! Each definition's kernel is differentiated symbolically with respect to those of its inputs that depend on a column.
//! At run time kernels compute these partial derivatives. Sums of products then carry d slot / d column from definition
//! to definition. Used for the IDA Jacobian and for the matrices of loops.

use super::SparsityPattern;
use super::layout::{ValueLayout, ValueSlot, slot};
use super::program::{KernelDefinitions, ProductSums};
use super::shape::{KernelExpression, KernelShaper};
use bramah_expr::{ExprId, ExprNode, Exprs};
use rustc_hash::FxHashMap;

/// The columns that a slot depends on, ascending, each with the slot of the derivative.
pub type SlotGradient = Vec<(u32, ValueSlot)>;

/// Collects the definitions that compute derivatives of slots with respect to columns.
#[derive(Debug, Default)]
pub struct Differentials {
    /// The gradient of each slot that depends on a column.
    gradients: FxHashMap<ValueSlot, SlotGradient>,
    /// Definitions of values and partial derivatives.
    pub defs: KernelDefinitions,
    /// The sums of products of the chain rule, run after `defs`.
    pub products: ProductSums,
}

/// One product of the chain rule: column, slot of the partial derivative, slot of the inner derivative.
type ChainRuleTerm = (u32, ValueSlot, ValueSlot);

impl Differentials {
    /// Declares that `slot` holds a column's unknown (`factor` is the slot of 1) or its derivative (the slot of `cj`).
    pub fn seed(&mut self, slot: ValueSlot, column: u32, factor: ValueSlot) {
        self.gradients.insert(slot, vec![(column, factor)]);
    }

    /// The gradient of a slot; empty where it depends on no column.
    pub fn gradient(&self, slot: ValueSlot) -> &[(u32, ValueSlot)] {
        self.gradients.get(&slot).map_or(&[], Vec::as_slice)
    }

    /// Adds a definition: its derivatives, and its value where `value_is_read`.
    pub fn define(
        &mut self,
        shaper: &mut KernelShaper,
        target: ValueSlot,
        shaped: &KernelExpression,
        value_is_read: bool,
    ) {
        let (mut outputs, mut targets) = (Vec::new(), Vec::new());
        if value_is_read {
            outputs.push(shaped.expr);
            targets.push(target);
        }
        let mut terms: Vec<ChainRuleTerm> = Vec::new();
        for (input, &from) in (0..).zip(&shaped.inputs) {
            if !self.gradients.contains_key(&from) {
                continue;
            }
            let partial = shaper.kernels.partial(shaped.expr, input);
            // structurally zero derivatives do not enter the pattern
            if partial == Exprs::ZERO {
                continue;
            }
            let place = partial_slot(shaper, partial, &shaped.inputs, &mut outputs, &mut targets);
            terms.extend(self.gradients[&from].iter().map(|&(column, inner)| (column, place, inner)));
        }
        if !outputs.is_empty() {
            self.defs.push(&mut shaper.kernels, outputs, &shaped.inputs, &targets);
        }
        // a stable sort: terms of a column are added in the order of the inputs, so that results are reproducible
        terms.sort_by_key(|&(column, ..)| column);
        let gradient: SlotGradient = terms
            .chunk_by(|a, b| a.0 == b.0)
            .map(|terms| (terms[0].0, self.accumulate(&mut shaper.layout, terms)))
            .collect();
        // a slot may be defined again: an old gradient must not remain
        if gradient.is_empty() {
            self.gradients.remove(&target);
        } else {
            self.gradients.insert(target, gradient);
        }
    }

    /// The slot of the sum of these products. Products with 1 need no sum of their own.
    fn accumulate(&mut self, layout: &mut ValueLayout, terms: &[ChainRuleTerm]) -> ValueSlot {
        let one = layout.number(1.0);
        if let &[(_, partial, inner)] = terms {
            if partial == one {
                return inner;
            }
            if inner == one {
                return partial;
            }
        }
        let sum = layout.work(1);
        self.products.factors.extend(terms.iter().map(|&(_, partial, inner)| (partial, inner)));
        self.products.sums.push((sum, slot(self.products.factors.len())));
        sum
    }
}

/// The slot of a partial derivative: that of a number, that of an input, or a new slot that the kernel writes.
fn partial_slot(
    shaper: &mut KernelShaper,
    partial: ExprId,
    inputs: &[ValueSlot],
    outputs: &mut Vec<ExprId>,
    targets: &mut Vec<ValueSlot>,
) -> ValueSlot {
    match shaper.kernels.pool.node(partial) {
        ExprNode::Num(bits) => shaper.layout.number(f64::from_bits(bits)),
        ExprNode::Var(v) => inputs[v.index()],
        _ => {
            let place = shaper.layout.work(1);
            outputs.push(partial);
            targets.push(place);
            place
        }
    }
}

/// A contribution to a matrix entry: `values[plus] - values[minus]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JacobianEntry {
    /// Column of the entry.
    pub column: u32,
    /// Row of the entry.
    pub row: u32,
    /// Slot of the term with plus sign; the slot of 0 where there is none.
    pub plus: ValueSlot,
    /// Slot of the term with minus sign; the slot of 0 where there is none.
    pub minus: ValueSlot,
}

/// Sorts entries into compressed columns and merges those of one place.
///
/// Merged entries must not both have a term of the same sign. Returns the pattern, and for each entry the slots of its
/// two terms.
pub fn compress(
    n: usize,
    mut entries: Vec<JacobianEntry>,
    zero: ValueSlot,
) -> (SparsityPattern, Vec<(ValueSlot, ValueSlot)>) {
    entries.sort_by_key(|e| (e.column, e.row));
    let mut pattern = SparsityPattern { n, colptr: vec![0; n + 1], rowidx: Vec::with_capacity(entries.len()) };
    let mut slots = Vec::with_capacity(entries.len());
    for same in entries.chunk_by(|a, b| (a.column, a.row) == (b.column, b.row)) {
        let either = |part: fn(&JacobianEntry) -> ValueSlot| same.iter().map(part).find(|&s| s != zero).unwrap_or(zero);
        pattern.rowidx.push(same[0].row as usize);
        pattern.colptr[same[0].column as usize + 1] += 1;
        slots.push((either(|e| e.plus), either(|e| e.minus)));
    }
    // counts per column become positions
    for j in 0..n {
        pattern.colptr[j + 1] += pattern.colptr[j];
    }
    (pattern, slots)
}
