//! The layout of the array of values: one flat array of `f64` per run.
//!
//! `lower` makes it; kernels address all their inputs and outputs by slots of it.

use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_model::structure::{BltBlock, Dae, Unknown};
use rustc_hash::FxHashMap;

/// An index into the array of values. Byte offsets of slots fit into 31 bits.
pub type ValueSlot = u32;

/// No slot.
const NONE: ValueSlot = ValueSlot::MAX;

/// The slots of a model.
///
/// One array of [`ValueLayout::len`] numbers holds everything that kernels read and write. In order: time and flags of
/// the run, variables, then derivatives, `pre` values, constants and work slots as they were needed, scratch at the
/// end.
#[derive(Clone, Debug)]
pub struct ValueLayout {
    /// For each variable the slot of its derivative, or `NONE`.
    der: Vec<ValueSlot>,
    /// For each variable the slot of its value before the event, or `NONE`.
    pre: Vec<ValueSlot>,
    /// The slot of each constant, by its bits.
    numbers: FxHashMap<u64, ValueSlot>,
    /// Slots with values that a fresh array must hold.
    preset: Vec<(ValueSlot, f64)>,
    /// Number of slots so far.
    len: u32,
}

impl ValueLayout {
    /// Slot of the simulated time in seconds.
    pub const TIME: usize = 0;
    /// Slot of the homotopy parameter of the initial system: 0 is the simplified system, 1 the actual one.
    pub const LAMBDA: usize = 1;
    /// Slot of `initial()`: 1 during initialization, else 0.
    pub const INITIAL: usize = 2;
    /// Slot of `terminal()`: 1 at the end of a successful run, else 0.
    pub const TERMINAL: usize = 3;
    /// Slot of the factor `cj` in the Jacobian.
    pub(super) const CJ: usize = 4;
    /// Slot of the first variable.
    const VARIABLES: u32 = 5;

    /// Gives slots to all variables of `dae`, and to all derivatives, `pre` values and constants that occur in it.
    pub fn new(dae: &Dae) -> ValueLayout {
        let variables = u32::try_from(dae.variables.len()).expect("fewer than 2^32 variables");
        let mut layout = ValueLayout {
            der: vec![NONE; dae.variables.len()],
            pre: vec![NONE; dae.variables.len()],
            numbers: FxHashMap::default(),
            preset: vec![(slot(Self::LAMBDA), 1.0)],
            len: Self::VARIABLES + variables,
        };
        dae.states.iter().for_each(|&x| layout.add_der(x));
        dae.conserved.iter().for_each(|c| layout.add_der(c.variable));
        dae.discrete.iter().for_each(|&v| layout.add_pre(v));
        for block in dae.continuous.iter().chain(&dae.event).chain(&dae.initial) {
            layout.add_unknowns(block);
        }
        layout.add_leaves(&dae.exprs);
        layout
    }

    /// Length of the array of values.
    #[inline]
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// Always false: the slots of time and flags always exist.
    #[inline]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The slot of a variable's value.
    #[inline]
    pub fn var(&self, v: VarId) -> usize {
        Self::VARIABLES as usize + v.index()
    }

    /// The slot of a variable's time derivative; `None` where the model does not use it.
    #[inline]
    pub fn der(&self, v: VarId) -> Option<usize> {
        existing(self.der[v.index()])
    }

    /// The slot of a variable's value before the event; `None` where it is neither discrete nor used.
    #[inline]
    pub fn pre(&self, v: VarId) -> Option<usize> {
        existing(self.pre[v.index()])
    }

    /// The slots of all values before the event.
    pub(super) fn pre_slots(&self) -> impl Iterator<Item = ValueSlot> {
        self.pre.iter().copied().filter(|&slot| slot != NONE)
    }

    /// The slot of an unknown of a block.
    #[inline]
    pub fn unknown(&self, unknown: Unknown) -> usize {
        match unknown {
            Unknown::Var(v) => self.var(v),
            Unknown::Der(v) => self.der(v).expect("every derivative that is solved for has a slot"),
        }
    }

    /// A fresh array: constants are in place, the homotopy parameter is 1, all else is 0.
    #[inline]
    pub fn values(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.len()];
        for &(slot, number) in &self.preset {
            values[slot as usize] = number;
        }
        values
    }

    /// The slot that a leaf of an expression reads; `None` for other nodes and for leaves without a slot.
    pub(super) fn leaf(&self, node: ExprNode) -> Option<ValueSlot> {
        let found = match node {
            ExprNode::Num(bits) => *self.numbers.get(&bits)?,
            ExprNode::Time => slot(Self::TIME),
            ExprNode::Var(v) => Self::VARIABLES + v.0,
            ExprNode::Der(v) => self.der[v.index()],
            ExprNode::Pre(v) => self.pre[v.index()],
            ExprNode::Initial => slot(Self::INITIAL),
            ExprNode::Terminal => slot(Self::TERMINAL),
            _ => return None,
        };
        (found != NONE).then_some(found)
    }

    /// The slot that always holds this number. A new slot is made where there is none.
    pub(super) fn number(&mut self, value: f64) -> ValueSlot {
        if let Some(&found) = self.numbers.get(&value.to_bits()) {
            return found;
        }
        let fresh = self.work(1);
        self.numbers.insert(value.to_bits(), fresh);
        self.preset.push((fresh, value));
        fresh
    }

    /// The slot of the number with these bits; `None` where there is none.
    pub(super) fn known_number(&self, bits: u64) -> Option<ValueSlot> {
        self.numbers.get(&bits).copied()
    }

    /// Adds `count` neighbouring slots and returns the first.
    pub(super) fn work(&mut self, count: usize) -> ValueSlot {
        let first = self.len;
        self.len += slot(count);
        assert!(self.len < 1 << 28, "the byte offset of every slot fits into 31 bits");
        first
    }

    /// Gives a derivative a slot, unless it has one.
    fn add_der(&mut self, v: VarId) {
        if self.der[v.index()] == NONE {
            self.der[v.index()] = self.work(1);
        }
    }

    /// Gives a value before the event a slot, unless it has one.
    fn add_pre(&mut self, v: VarId) {
        if self.pre[v.index()] == NONE {
            self.pre[v.index()] = self.work(1);
        }
    }

    /// Gives slots to all derivatives that a block solves for.
    fn add_unknowns(&mut self, block: &BltBlock) {
        let mut add = |unknown: Unknown| {
            if let Unknown::Der(v) = unknown {
                self.add_der(v);
            }
        };
        match block {
            BltBlock::Assign(assign) => add(assign.unknown),
            BltBlock::Loop(l) => {
                l.tearing.iter().for_each(|&u| add(u));
                l.inner.iter().for_each(|a| add(a.unknown));
            }
            BltBlock::Mixed(mixed) => {
                mixed.discrete.iter().for_each(|a| add(a.unknown));
                mixed.continuous.iter().for_each(|b| self.add_unknowns(b));
            }
        }
    }

    /// Gives slots to all derivatives, `pre` values and constants in the pool of expressions.
    fn add_leaves(&mut self, exprs: &Exprs) {
        for id in 0..exprs.len() {
            match exprs.node(ExprId(slot(id))) {
                ExprNode::Der(v) => self.add_der(v),
                ExprNode::Pre(v) => self.add_pre(v),
                ExprNode::Num(bits) => {
                    self.number(f64::from_bits(bits));
                }
                _ => {}
            }
        }
    }
}

/// An index as a slot.
pub(super) fn slot(index: usize) -> ValueSlot {
    ValueSlot::try_from(index).expect("fewer than 2^32 slots")
}

/// `None` for the missing slot.
fn existing(slot: ValueSlot) -> Option<usize> {
    (slot != NONE).then_some(slot as usize)
}
