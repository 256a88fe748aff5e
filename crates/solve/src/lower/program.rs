//! A [`Program`]: kernels over the array of values, run in order.
//!
//! Definitions of one shape that do not wait for each other run as one loop over a table of slots; the rest is merged
//! into straight code of limited size, in which values pass in registers.

use super::code::Code;
use super::interpret::Bytecode;
use super::layout::{Layout, Slot, slot};
use super::native::{Compiler, Entry, Ticket};
use super::shape::{Kernel, KernelId, Kernels, Shaped, copy_node};
use bramah_expr::function::Function;
use bramah_expr::{ExprId, Exprs, Node, VarId};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

/// Straight code is cut when it has this many nodes; machine code is slow to make beyond.
const STRAIGHT_SIZE: usize = 1200;

/// The same for programs that are made when the scratch region has its size already.
const LATE_STRAIGHT_SIZE: usize = 100;

/// No node needs more scratch places than this: a whole power is written out as up to 7 steps, and its arguments may be
/// numbers without a slot.
const PLACES_PER_NODE: usize = 12;

/// A shape is run as a loop when it has at least this many instances ...
const LOOP_INSTANCES: usize = 4;

/// ... and they have at least this many nodes together.
const LOOP_SIZE: usize = 240;

/// Loops of this many rows are compiled before the first run.
const ALWAYS_COMPILED: usize = 64;

/// All else is compiled when its program has run this often: interpreting it has then cost about as much as making
/// machine code would have, so that at most twice is spent of what the better choice would have cost.
const WORTH_COMPILING: u32 = 1000;

/// The same for what runs at every step or sample: it will go on doing so.
const SOON_COMPILED: u32 = 100;

/// Definitions to be computed: each a kernel with the slots it reads and writes.
#[derive(Clone, Debug, Default)]
pub struct Defs {
    items: Vec<(KernelId, u32)>,
    slots: Vec<Slot>,
}

impl Defs {
    /// Adds the definition of one slot.
    pub fn define(&mut self, kernels: &mut Kernels, target: Slot, shaped: &Shaped) {
        self.push(kernels, vec![shaped.expr], &shaped.inputs, &[target]);
    }

    /// Adds a definition of several slots.
    pub fn push(&mut self, kernels: &mut Kernels, outputs: Vec<ExprId>, inputs: &[Slot], targets: &[Slot]) {
        let kernel = kernels.intern(Kernel { inputs: slot(inputs.len()), outputs });
        self.items.push((kernel, slot(self.slots.len())));
        self.slots.extend_from_slice(inputs);
        self.slots.extend_from_slice(targets);
    }

    /// Adds all definitions of another list.
    pub fn append(&mut self, other: &Defs) {
        let shift = slot(self.slots.len());
        self.items.extend(other.items.iter().map(|&(kernel, start)| (kernel, start + shift)));
        self.slots.extend_from_slice(&other.slots);
    }

    /// All slots that are read or written.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// The definition with this number: kernel, inputs, targets.
    pub fn get(&self, kernels: &Kernels, i: usize) -> (KernelId, &[Slot], &[Slot]) {
        let (kernel, start) = self.items[i];
        let shape = kernels.get(kernel);
        let row = &self.slots[start as usize..][..shape.inputs as usize + shape.outputs.len()];
        let (inputs, targets) = row.split_at(shape.inputs as usize);
        (kernel, inputs, targets)
    }

    /// The definitions with these numbers, in this order.
    pub fn select(&self, kernels: &Kernels, chosen: impl IntoIterator<Item = usize>) -> Defs {
        let mut defs = Defs::default();
        for i in chosen {
            let (kernel, inputs, targets) = self.get(kernels, i);
            defs.items.push((kernel, slot(defs.slots.len())));
            defs.slots.extend_from_slice(inputs);
            defs.slots.extend_from_slice(targets);
        }
        defs
    }
}

/// Sums of products: `v[target] = sum of v[a] * v[b]`, from left to right, one after the other.
#[derive(Clone, Debug, Default)]
pub struct Products {
    /// Per sum, its slot and one past its last factor pair.
    pub sums: Vec<(Slot, u32)>,
    /// The pairs of factors.
    pub factors: Vec<(Slot, Slot)>,
}

impl Products {
    fn run(&self, v: &mut [f64]) {
        let mut start = 0;
        for &(target, end) in &self.sums {
            let terms = &self.factors[start..end as usize];
            v[target as usize] = terms.iter().fold(0.0, |sum, &(a, b)| sum + v[a as usize] * v[b as usize]);
            start = end as usize;
        }
    }
}

/// Something to compute, reading and writing slots of one array of values. Cheap to clone; shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Program {
    steps: Arc<Vec<Step>>,
    late: Option<Arc<Late>>,
    functions: Arc<Vec<Function>>,
    len: usize,
}

#[derive(Debug)]
enum Step {
    Straight { bytecode: Bytecode, native: Native },
    Loop(Loop),
    Products(Products),
}

#[derive(Debug)]
struct Loop {
    kernel: KernelId,
    bytecode: Bytecode,
    native: Native,
    inputs: usize,
    outputs: usize,
    /// Per instance its inputs, then its targets.
    table: Vec<Slot>,
    scratch: usize,
}

#[derive(Debug)]
enum Native {
    None,
    Ordered(Ticket),
    Ready(Entry),
    /// Among the [`Late`] ones.
    Late(Ticket),
}

impl Native {
    fn finish(&mut self, entries: &[Entry]) {
        if let Native::Ordered(ticket) = self {
            *self = entries.get(ticket.index()).map_or(Native::None, |entry| Native::Ready(entry.clone()));
        }
    }

    /// The machine code, if it has been made.
    fn entry<'a>(&'a self, late: &'a [Entry]) -> Option<&'a Entry> {
        match self {
            Native::Ready(entry) => Some(entry),
            Native::Late(ticket) => late.get(ticket.index()),
            Native::None | Native::Ordered(_) => None,
        }
    }
}

/// Machine code that is made when its program has run often, by whichever thread comes to it first. Results do not
/// depend on when that is, for interpreter and machine code agree to the bit.
#[derive(Debug)]
struct Late {
    compiler: Compiler,
    runs: AtomicU32,
    /// Runs before it is made.
    limit: u32,
    entries: OnceLock<Vec<Entry>>,
}

impl Late {
    fn new(compiler: Compiler, limit: u32) -> Arc<Late> {
        Arc::new(Late { compiler, runs: AtomicU32::new(0), limit, entries: OnceLock::new() })
    }

    /// Counts a run.
    fn entries(&self, functions: &[Function]) -> &[Entry] {
        if let Some(entries) = self.entries.get() {
            return entries;
        }
        if self.runs.fetch_add(1, Ordering::Relaxed) < self.limit {
            return &[];
        }
        self.entries.get_or_init(|| self.compiler.compile(functions))
    }
}

impl Program {
    /// Computes. `values` is an array of the layout the program was made for.
    pub fn run(&self, values: &mut [f64]) {
        assert!(values.len() >= self.len, "the array of values belongs to another system");
        let late = self.late.as_ref().map_or(&[] as &[Entry], |late| late.entries(&self.functions));
        for step in self.steps.iter() {
            match step {
                Step::Straight { bytecode, native } => match native.entry(late) {
                    Some(entry) => entry.run(values, &self.functions),
                    None => bytecode.run(&self.functions, values),
                },
                Step::Loop(l) => l.run(late, &self.functions, values),
                Step::Products(products) => products.run(values),
            }
        }
    }

    /// From now on machine code is run, as after many runs.
    #[cfg(test)]
    pub fn hurry(&self) {
        self.late.iter().for_each(|late| _ = late.runs.fetch_max(late.limit, Ordering::Relaxed));
    }

    /// True when there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Number of instructions; those of a loop count once.
    pub fn size(&self) -> usize {
        let size = |step: &Step| match step {
            Step::Straight { bytecode, .. } | Step::Loop(Loop { bytecode, .. }) => bytecode.len(),
            Step::Products(_) => 0,
        };
        self.steps.iter().map(size).sum()
    }

    /// Number of loops and pieces of straight code: with equal parts it does not grow with their number.
    pub fn kernels(&self) -> usize {
        self.steps.len()
    }

    /// How many scratch places the interpreter needs.
    pub(super) fn scratch(&self) -> u32 {
        let need = |step: &Step| match step {
            Step::Straight { bytecode, .. } | Step::Loop(Loop { bytecode, .. }) => bytecode.scratch(),
            Step::Products(_) => 0,
        };
        self.steps.iter().map(need).max().unwrap_or(0)
    }

    /// Last touch: where the scratch region begins, how long the array is, what has been compiled.
    ///
    /// Does nothing to a program that has been cloned before.
    pub(super) fn finish(&mut self, scratch: Slot, len: usize, functions: &Arc<Vec<Function>>, entries: &[Entry]) {
        self.functions = functions.clone();
        self.len = len;
        let Some(steps) = Arc::get_mut(&mut self.steps) else { return };
        for step in steps {
            match step {
                Step::Straight { bytecode, native } => {
                    bytecode.relocate(scratch);
                    native.finish(entries);
                }
                Step::Loop(l) => {
                    l.scratch = scratch as usize;
                    l.bytecode.relocate(scratch);
                    l.native.finish(entries);
                }
                Step::Products(_) => {}
            }
        }
    }
}

impl Loop {
    fn rows(&self) -> usize {
        self.table.len() / (self.inputs + self.outputs)
    }

    fn run(&self, late: &[Entry], functions: &[Function], v: &mut [f64]) {
        if let Some(entry) = self.native.entry(late) {
            return entry.run_table(v, &self.table, self.inputs + self.outputs, functions);
        }
        for row in self.table.chunks_exact(self.inputs + self.outputs) {
            let (inputs, targets) = row.split_at(self.inputs);
            for (place, &input) in (self.scratch..).zip(inputs) {
                v[place] = v[input as usize];
            }
            self.bytecode.run(functions, v);
            for (place, &target) in (self.scratch + self.inputs..).zip(targets) {
                v[target as usize] = v[place];
            }
        }
    }
}

/// How many scratch places programs may need that compute some of `defs` and are made after all others.
pub fn late_scratch(defs: &Defs, kernels: &Kernels) -> usize {
    let distinct: BTreeSet<KernelId> = defs.items.iter().map(|&(kernel, _)| kernel).collect();
    let size = |&kernel: &KernelId| kernels.pool.reachable(&kernels.get(kernel).outputs, |_| true).len();
    PLACES_PER_NODE * (LATE_STRAIGHT_SIZE + distinct.iter().map(size).max().unwrap_or(0))
}

/// How definitions are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// By dependency: each slot is defined before it is read, and equal shapes come together.
    Dependency,
    /// As given: slots may be read before they are defined (values of the last turn of an iteration).
    Given,
}

/// Makes programs.
pub struct Assembler<'a> {
    kernels: &'a Kernels,
    layout: &'a Layout,
    codes: FxHashMap<KernelId, Arc<Code>>,
    tickets: BTreeMap<KernelId, Ticket>,
    compiler: Compiler,
    /// Whether anything is compiled to machine code.
    native: bool,
    /// What the program that is being made compiles when it has run often.
    late: Compiler,
    late_loops: BTreeMap<KernelId, Ticket>,
    limit: u32,
    ready: Option<&'a CompiledLoops>,
    straight_size: usize,
}

/// Loops in machine code, for programs that are made later.
pub type CompiledLoops = FxHashMap<KernelId, Entry>;

impl<'a> Assembler<'a> {
    /// Programs of `kernels` over `layout`; `native`: in machine code where that pays, else interpreted.
    pub fn new(kernels: &'a Kernels, layout: &'a Layout, native: bool) -> Self {
        Assembler {
            kernels,
            layout,
            codes: FxHashMap::default(),
            tickets: BTreeMap::new(),
            compiler: Compiler::default(),
            native,
            late: Compiler::default(),
            late_loops: BTreeMap::new(),
            limit: WORTH_COMPILING,
            ready: None,
            straight_size: STRAIGHT_SIZE,
        }
    }

    /// For programs that are made after all others: with loops that are compiled already, and with pieces of straight
    /// code so short that [`late_scratch`] suffices.
    pub fn with_loops(kernels: &'a Kernels, layout: &'a Layout, native: bool, ready: &'a CompiledLoops) -> Self {
        Assembler { ready: Some(ready), straight_size: LATE_STRAIGHT_SIZE, ..Assembler::new(kernels, layout, native) }
    }

    /// Compiles what was to be compiled: all of it in the order of tickets, and loops by kernel.
    pub fn compile(self, functions: &[Function]) -> (Vec<Entry>, CompiledLoops) {
        let entries = self.compiler.compile(functions);
        let entry = |(&kernel, ticket): (&KernelId, &Ticket)| Some((kernel, entries.get(ticket.index())?.clone()));
        let loops = self.tickets.iter().filter_map(entry).collect();
        (entries, loops)
    }

    /// The kernels that programs are made of.
    pub fn kernels(&self) -> &'a Kernels {
        self.kernels
    }

    /// Whether programs made from here on are known to run often.
    pub fn often(&mut self, often: bool) {
        self.limit = if often { SOON_COMPILED } else { WORTH_COMPILING };
    }

    /// The program that computes `defs`, then `products`.
    pub fn assemble(&mut self, defs: &Defs, order: Order, products: Option<Products>) -> Program {
        let mut steps = Vec::new();
        let looped = self.looped(defs, order);
        let mut straight = Straight::default();
        for i in self.schedule(defs, order, &looped) {
            let (kernel, inputs, targets) = defs.get(self.kernels, i);
            if looped.contains(&kernel) {
                self.flush(&mut straight, &mut steps);
                self.push_loop(kernel, inputs, targets, &mut steps);
            } else {
                if !straight.takes(targets, self.straight_size) {
                    self.flush(&mut straight, &mut steps);
                }
                straight.add(self.kernels, kernel, inputs, targets);
            }
        }
        self.flush(&mut straight, &mut steps);
        for step in &mut steps {
            if let Step::Loop(l) = step {
                l.native = self.order_loop(l);
            }
        }
        steps.extend(products.filter(|p| !p.sums.is_empty()).map(Step::Products));
        self.late_loops.clear();
        let late = std::mem::take(&mut self.late);
        let late = (!late.is_empty()).then(|| Late::new(late, self.limit));
        Program { steps: Arc::new(steps), late, ..Program::default() }
    }

    fn code(&mut self, kernel: KernelId) -> Arc<Code> {
        let kernels = self.kernels;
        let make = || Arc::new(Code::new(&kernels.pool, &kernels.get(kernel).outputs));
        self.codes.entry(kernel).or_insert_with(make).clone()
    }

    /// The kernels that are worth a loop.
    fn looped(&mut self, defs: &Defs, order: Order) -> FxHashSet<KernelId> {
        let mut counts: FxHashMap<KernelId, usize> = FxHashMap::default();
        if order == Order::Dependency {
            defs.items.iter().for_each(|&(kernel, _)| *counts.entry(kernel).or_default() += 1);
        }
        counts.retain(|_, count| *count >= LOOP_INSTANCES);
        counts.retain(|&kernel, count| *count * self.code(kernel).size >= LOOP_SIZE);
        counts.into_keys().collect()
    }

    /// The order of computation: by level, loops before straight code, equal kernels together.
    fn schedule(&self, defs: &Defs, order: Order, looped: &FxHashSet<KernelId>) -> Vec<usize> {
        let mut sequence: Vec<usize> = (0..defs.len()).collect();
        if order == Order::Given || looped.is_empty() {
            return sequence;
        }
        let levels = self.levels(defs);
        let mut first: FxHashMap<KernelId, usize> = FxHashMap::default();
        for (i, &(kernel, _)) in defs.items.iter().enumerate() {
            first.entry(kernel).or_insert(i);
        }
        sequence.sort_by_key(|&i| {
            let kernel = defs.items[i].0;
            let group = if looped.contains(&kernel) { first[&kernel] } else { usize::MAX };
            (levels[i], group, i)
        });
        sequence
    }

    /// One more than the highest level of what a definition reads.
    fn levels(&self, defs: &Defs) -> Vec<u32> {
        let mut defined = vec![0u32; self.layout.len()];
        let mut levels = Vec::with_capacity(defs.len());
        for i in 0..defs.len() {
            let (_, inputs, targets) = defs.get(self.kernels, i);
            let level = inputs.iter().map(|&input| defined[input as usize]).max().unwrap_or(0) + 1;
            targets.iter().for_each(|&target| defined[target as usize] = level);
            levels.push(level);
        }
        levels
    }

    fn push_loop(&mut self, kernel: KernelId, inputs: &[Slot], targets: &[Slot], steps: &mut Vec<Step>) {
        let open = matches!(steps.last(), Some(Step::Loop(l)) if l.kernel == kernel);
        if !open {
            let code = self.code(kernel);
            let bytecode = Bytecode::looped(&code, slot(inputs.len()), self.layout);
            let (inputs, outputs) = (inputs.len(), targets.len());
            let native = Native::None;
            steps.push(Step::Loop(Loop { kernel, bytecode, native, inputs, outputs, table: Vec::new(), scratch: 0 }));
        }
        if let Some(Step::Loop(l)) = steps.last_mut() {
            l.table.extend_from_slice(inputs);
            l.table.extend_from_slice(targets);
        }
    }

    fn order_loop(&mut self, l: &Loop) -> Native {
        if let Some(entry) = self.ready.and_then(|ready| ready.get(&l.kernel)) {
            return Native::Ready(entry.clone());
        }
        let code = self.code(l.kernel);
        if !self.native || code.size > 2 * STRAIGHT_SIZE {
            return Native::None;
        }
        let inputs = slot(l.inputs);
        if l.rows() < ALWAYS_COMPILED && !self.tickets.contains_key(&l.kernel) {
            let order = || self.late.order_loop(code, inputs);
            return Native::Late(*self.late_loops.entry(l.kernel).or_insert_with(order));
        }
        let order = || self.compiler.order_loop(code, inputs);
        Native::Ordered(*self.tickets.entry(l.kernel).or_insert_with(order))
    }

    fn flush(&mut self, straight: &mut Straight, steps: &mut Vec<Step>) {
        let Straight { pool, targets, outputs, .. } = std::mem::take(straight);
        if targets.is_empty() {
            return;
        }
        let code = Code::new(&pool, &outputs);
        let bytecode = Bytecode::straight(&code, &targets, self.layout);
        let native = if self.native && code.size <= 2 * STRAIGHT_SIZE {
            Native::Late(self.late.order_straight(Arc::new(code), targets))
        } else {
            Native::None
        };
        steps.push(Step::Straight { bytecode, native });
    }
}

/// Straight code that is being collected: expressions whose leaves are slots.
#[derive(Default)]
struct Straight {
    pool: Exprs,
    targets: Vec<Slot>,
    outputs: Vec<ExprId>,
    /// What has been computed for a slot so far.
    current: FxHashMap<Slot, ExprId>,
}

impl Straight {
    /// Whether a definition of these slots fits in.
    fn takes(&self, targets: &[Slot], size: usize) -> bool {
        self.pool.len() < size && !targets.iter().any(|target| self.current.contains_key(target))
    }

    fn add(&mut self, kernels: &Kernels, kernel: KernelId, inputs: &[Slot], targets: &[Slot]) {
        let shape = kernels.get(kernel);
        let mut copies: FxHashMap<ExprId, ExprId> = FxHashMap::default();
        for e in kernels.pool.reachable(&shape.outputs, |_| true) {
            let copy = match kernels.pool.node(e) {
                Node::Var(VarId(input)) => self.leaf(inputs[input as usize]),
                _ => copy_node(&kernels.pool, e, &mut self.pool, |operand| copies[&operand]),
            };
            copies.insert(e, copy);
        }
        for (&target, output) in targets.iter().zip(&shape.outputs) {
            let copy = copies[output];
            self.current.insert(target, copy);
            self.targets.push(target);
            self.outputs.push(copy);
        }
    }

    fn leaf(&mut self, slot: Slot) -> ExprId {
        match self.current.get(&slot) {
            Some(&known) => known,
            None => self.pool.var(VarId(slot)),
        }
    }
}
