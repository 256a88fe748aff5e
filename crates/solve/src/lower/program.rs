//! Programs: kernels over the array of values, run in order.
//!
//! Kernel definitions enter [`ProgramAssembler::assemble`]; a [`Program`] leaves it. Definitions of one kernel that do
//! not depend on each other run as one loop over a table of slots. All others are merged into straight code of limited
//! size, in which intermediate values stay in registers. Programs start interpreted. Machine code is made when a
//! program has run often, except for long loops, which are compiled at once.

use super::code::KernelCode;
use super::interpret::Bytecode;
use super::layout::{ValueLayout, ValueSlot, slot};
use super::native::{CodeTicket, NativeCompiler, NativeEntry};
use super::shape::{Kernel, KernelExpression, KernelId, KernelTable, copy_node};
use bramah_expr::function::Function;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

/// A piece of straight code is closed at this number of nodes. Cranelift's compile time grows more than linearly.
const STRAIGHT_SIZE: usize = 1200;

/// The same limit for programs that are made when the size of the scratch region is already fixed.
const LATE_STRAIGHT_SIZE: usize = 100;

/// Upper bound of the scratch places that one node needs.
///
/// An integer power is written out in up to 7 steps, and its arguments may be numbers without a slot.
const PLACES_PER_NODE: usize = 12;

/// A kernel runs as a loop when it has at least this many instances ...
const LOOP_INSTANCES: usize = 4;

/// ... which have at least this many nodes together.
const LOOP_SIZE: usize = 240;

/// Loops with this many rows are compiled before the first run.
const ALWAYS_COMPILED: usize = 64;

/// Number of runs after which any other code is compiled.
///
/// Interpreting has then cost about as much as compiling. The total is at most twice the cost of the better choice.
const WORTH_COMPILING: u32 = 1000;

/// The same for programs that run at every step or sample, and so will certainly run often.
const SOON_COMPILED: u32 = 100;

/// A list of definitions, each a kernel with the slots that it reads and writes.
#[derive(Clone, Debug, Default)]
pub struct KernelDefinitions {
    /// For each definition its kernel, and where its slots begin in `slots`.
    items: Vec<(KernelId, u32)>,
    /// The slots of all definitions: inputs, then targets.
    slots: Vec<ValueSlot>,
}

impl KernelDefinitions {
    /// Adds the definition of one slot.
    pub fn define(&mut self, kernels: &mut KernelTable, target: ValueSlot, shaped: &KernelExpression) {
        self.push(kernels, vec![shaped.expr], &shaped.inputs, &[target]);
    }

    /// Adds a definition of several slots, which share one kernel.
    pub fn push(
        &mut self,
        kernels: &mut KernelTable,
        outputs: Vec<ExprId>,
        inputs: &[ValueSlot],
        targets: &[ValueSlot],
    ) {
        let kernel = kernels.intern(Kernel { inputs: slot(inputs.len()), outputs });
        self.items.push((kernel, slot(self.slots.len())));
        self.slots.extend_from_slice(inputs);
        self.slots.extend_from_slice(targets);
    }

    /// Adds all definitions of another list.
    pub fn append(&mut self, other: &KernelDefinitions) {
        let shift = slot(self.slots.len());
        self.items.extend(other.items.iter().map(|&(kernel, start)| (kernel, start + shift)));
        self.slots.extend_from_slice(&other.slots);
    }

    /// All slots that are read or written; a slot may occur more than once.
    pub fn slots(&self) -> &[ValueSlot] {
        &self.slots
    }

    /// Number of definitions.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Kernel, inputs and targets of definition `i`.
    pub fn get(&self, kernels: &KernelTable, i: usize) -> (KernelId, &[ValueSlot], &[ValueSlot]) {
        let (kernel, start) = self.items[i];
        let shape = kernels.get(kernel);
        let row = &self.slots[start as usize..][..shape.inputs as usize + shape.outputs.len()];
        let (inputs, targets) = row.split_at(shape.inputs as usize);
        (kernel, inputs, targets)
    }

    /// The definitions with these numbers, in this order.
    pub fn select(&self, kernels: &KernelTable, chosen: impl IntoIterator<Item = usize>) -> KernelDefinitions {
        let mut defs = KernelDefinitions::default();
        for i in chosen {
            let (kernel, inputs, targets) = self.get(kernels, i);
            defs.items.push((kernel, slot(defs.slots.len())));
            defs.slots.extend_from_slice(inputs);
            defs.slots.extend_from_slice(targets);
        }
        defs
    }
}

/// Sums of products, `v[target] = sum of v[a] * v[b]`, computed one after the other.
#[derive(Clone, Debug, Default)]
pub struct ProductSums {
    /// For each sum its slot, and the index one past its last pair of factors.
    pub sums: Vec<(ValueSlot, u32)>,
    /// The pairs of factors of all sums.
    pub factors: Vec<(ValueSlot, ValueSlot)>,
}

impl ProductSums {
    /// Computes all sums, each from left to right.
    fn run(&self, v: &mut [f64]) {
        let mut start = 0;
        for &(target, end) in &self.sums {
            let terms = &self.factors[start..end as usize];
            v[target as usize] = terms.iter().fold(0.0, |sum, &(a, b)| sum + v[a as usize] * v[b as usize]);
            start = end as usize;
        }
    }
}

/// A computation that reads and writes slots of one array of values. Cheap to clone, shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// What is run, in order.
    steps: Arc<Vec<ProgramStep>>,
    /// Machine code that is made once the program has run often; `None` where nothing is to be compiled.
    late: Option<Arc<LazyNativeCode>>,
    /// User functions that the code calls.
    functions: Arc<Vec<Function>>,
    /// Length that the array of values must have at least.
    len: usize,
}

/// One step of a program.
#[derive(Debug)]
enum ProgramStep {
    /// Straight code of several definitions.
    Straight { bytecode: Bytecode, native: NativeStatus },
    /// One kernel for all rows of a table.
    Loop(KernelLoop),
    /// The sums of the chain rule.
    Products(ProductSums),
}

/// A kernel that runs once for each row of a table of slots.
#[derive(Debug)]
struct KernelLoop {
    /// The kernel.
    kernel: KernelId,
    /// Interpreted form, with inputs and outputs in the scratch region.
    bytecode: Bytecode,
    /// Compiled form.
    native: NativeStatus,
    /// Number of inputs of a row.
    inputs: usize,
    /// Number of outputs of a row.
    outputs: usize,
    /// For each instance the slots of its inputs, then those of its targets.
    table: Vec<ValueSlot>,
    /// First slot of the scratch region.
    scratch: usize,
}

/// The state of the machine code of a step.
#[derive(Debug)]
enum NativeStatus {
    /// Never compiled.
    None,
    /// Will be compiled before the first run of the system.
    Ordered(CodeTicket),
    /// Compiled.
    Ready(NativeEntry),
    /// Compiled when the program has run often; an index into [`LazyNativeCode`].
    Late(CodeTicket),
}

impl NativeStatus {
    /// Replaces an order by the compiled code. Where nothing was compiled, the step stays interpreted.
    fn finish(&mut self, entries: &[NativeEntry]) {
        if let NativeStatus::Ordered(ticket) = self {
            *self = entries.get(ticket.index()).map_or(NativeStatus::None, |entry| NativeStatus::Ready(entry.clone()));
        }
    }

    /// The machine code; `None` if it has not been made.
    fn entry<'a>(&'a self, late: &'a [NativeEntry]) -> Option<&'a NativeEntry> {
        match self {
            NativeStatus::Ready(entry) => Some(entry),
            NativeStatus::Late(ticket) => late.get(ticket.index()),
            NativeStatus::None | NativeStatus::Ordered(_) => None,
        }
    }
}

/// Machine code that is made when its program has run often, by the thread that reaches the limit first.
///
/// The results do not depend on when that happens, because interpreter and machine code agree to the bit.
#[derive(Debug)]
struct LazyNativeCode {
    /// Holds the code to be compiled.
    compiler: NativeCompiler,
    /// Number of runs so far, of all threads.
    runs: AtomicU32,
    /// Number of runs after which the code is compiled.
    limit: u32,
    /// The compiled code, once it exists.
    entries: OnceLock<Vec<NativeEntry>>,
}

impl LazyNativeCode {
    /// Nothing is compiled yet.
    fn new(compiler: NativeCompiler, limit: u32) -> Arc<LazyNativeCode> {
        Arc::new(LazyNativeCode { compiler, runs: AtomicU32::new(0), limit, entries: OnceLock::new() })
    }

    /// Counts a run, and returns the machine code if it exists or is due; an empty slice otherwise.
    fn entries(&self, functions: &[Function]) -> &[NativeEntry] {
        if let Some(entries) = self.entries.get() {
            return entries;
        }
        // relaxed: the exact number of runs does not matter
        if self.runs.fetch_add(1, Ordering::Relaxed) < self.limit {
            return &[];
        }
        self.entries.get_or_init(|| self.compiler.compile(functions))
    }
}

impl Program {
    /// Runs all steps. `values` must be an array of the layout that the program was made for.
    pub fn run(&self, values: &mut [f64]) {
        // machine code does not check its slots, so this check must stay
        assert!(values.len() >= self.len, "the array of values belongs to another system");
        let late = self.late.as_ref().map_or(&[] as &[NativeEntry], |late| late.entries(&self.functions));
        for step in self.steps.iter() {
            match step {
                ProgramStep::Straight { bytecode, native } => match native.entry(late) {
                    Some(entry) => entry.run(values, &self.functions),
                    None => bytecode.run(&self.functions, values),
                },
                ProgramStep::Loop(l) => l.run(late, &self.functions, values),
                ProgramStep::Products(products) => products.run(values),
            }
        }
    }

    /// From now on machine code is run, as after many runs.
    #[cfg(test)]
    pub fn hurry(&self) {
        self.late.iter().for_each(|late| _ = late.runs.fetch_max(late.limit, Ordering::Relaxed));
    }

    /// Whether there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Number of instructions; those of a loop count once.
    pub fn size(&self) -> usize {
        let size = |step: &ProgramStep| match step {
            ProgramStep::Straight { bytecode, .. } | ProgramStep::Loop(KernelLoop { bytecode, .. }) => bytecode.len(),
            ProgramStep::Products(_) => 0,
        };
        self.steps.iter().map(size).sum()
    }

    /// Number of loops and pieces of straight code. With equal parts it does not grow with the number of parts.
    pub fn kernels(&self) -> usize {
        self.steps.len()
    }

    /// Number of scratch places that the interpreter needs.
    pub(super) fn scratch(&self) -> u32 {
        let need = |step: &ProgramStep| match step {
            ProgramStep::Straight { bytecode, .. } | ProgramStep::Loop(KernelLoop { bytecode, .. }) => {
                bytecode.scratch()
            }
            ProgramStep::Products(_) => 0,
        };
        self.steps.iter().map(need).max().unwrap_or(0)
    }

    /// Completes the program: start of the scratch region, length of the array, user functions and compiled code.
    ///
    /// Has no effect on the steps of a program that has been cloned before.
    pub(super) fn finish(
        &mut self,
        scratch: ValueSlot,
        len: usize,
        functions: &Arc<Vec<Function>>,
        entries: &[NativeEntry],
    ) {
        self.functions = functions.clone();
        self.len = len;
        let Some(steps) = Arc::get_mut(&mut self.steps) else { return };
        for step in steps {
            match step {
                ProgramStep::Straight { bytecode, native } => {
                    bytecode.relocate(scratch);
                    native.finish(entries);
                }
                ProgramStep::Loop(l) => {
                    l.scratch = scratch as usize;
                    l.bytecode.relocate(scratch);
                    l.native.finish(entries);
                }
                ProgramStep::Products(_) => {}
            }
        }
    }
}

impl KernelLoop {
    /// Number of instances.
    fn rows(&self) -> usize {
        self.table.len() / (self.inputs + self.outputs)
    }

    /// Runs the kernel for all rows.
    fn run(&self, late: &[NativeEntry], functions: &[Function], v: &mut [f64]) {
        if let Some(entry) = self.native.entry(late) {
            return entry.run_table(v, &self.table, self.inputs + self.outputs, functions);
        }
        for row in self.table.chunks_exact(self.inputs + self.outputs) {
            let (inputs, targets) = row.split_at(self.inputs);
            // the interpreter works on fixed scratch places, so inputs are copied in and outputs are copied out
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

/// Upper bound of the scratch places of programs that compute some of `defs` and are made after all others.
pub fn late_scratch(defs: &KernelDefinitions, kernels: &KernelTable) -> usize {
    let distinct: BTreeSet<KernelId> = defs.items.iter().map(|&(kernel, _)| kernel).collect();
    let size = |&kernel: &KernelId| kernels.pool.reachable(&kernels.get(kernel).outputs, |_| true).len();
    PLACES_PER_NODE * (LATE_STRAIGHT_SIZE + distinct.iter().map(size).max().unwrap_or(0))
}

/// How definitions are ordered in a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefinitionOrder {
    /// Each slot is defined before it is read; equal kernels come together.
    Dependency,
    /// As given. A slot may be read before it is defined: its value is then that of the last iteration.
    Given,
}

/// Makes programs from definitions.
pub struct ProgramAssembler<'a> {
    /// The kernels of the model.
    kernels: &'a KernelTable,
    /// The slots of the model.
    layout: &'a ValueLayout,
    /// The intermediate code of each kernel that has been used.
    codes: FxHashMap<KernelId, Arc<KernelCode>>,
    /// Loops to be compiled before the first run.
    tickets: BTreeMap<KernelId, CodeTicket>,
    /// Collects the code to be compiled before the first run.
    compiler: NativeCompiler,
    /// Whether anything is compiled to machine code.
    native: bool,
    /// Collects the code of the present program that is compiled when the program has run often.
    late: NativeCompiler,
    /// Loops among that code.
    late_loops: BTreeMap<KernelId, CodeTicket>,
    /// Number of runs before that code is compiled.
    limit: u32,
    /// Loops that are compiled already; `None` while the system is made.
    ready: Option<&'a CompiledLoops>,
    /// Nodes at which a piece of straight code is closed.
    straight_size: usize,
}

/// Compiled loops by kernel, for programs that are made later.
pub type CompiledLoops = FxHashMap<KernelId, NativeEntry>;

impl<'a> ProgramAssembler<'a> {
    /// Makes programs of `kernels` over `layout`. With `native`, code is compiled where that pays.
    pub fn new(kernels: &'a KernelTable, layout: &'a ValueLayout, native: bool) -> Self {
        ProgramAssembler {
            kernels,
            layout,
            codes: FxHashMap::default(),
            tickets: BTreeMap::new(),
            compiler: NativeCompiler::default(),
            native,
            late: NativeCompiler::default(),
            late_loops: BTreeMap::new(),
            limit: WORTH_COMPILING,
            ready: None,
            straight_size: STRAIGHT_SIZE,
        }
    }

    /// Makes programs after all others.
    ///
    /// It uses loops that are compiled already. Its pieces of straight code are so short that [`late_scratch`]
    /// suffices.
    pub fn with_loops(
        kernels: &'a KernelTable,
        layout: &'a ValueLayout,
        native: bool,
        ready: &'a CompiledLoops,
    ) -> Self {
        ProgramAssembler {
            ready: Some(ready),
            straight_size: LATE_STRAIGHT_SIZE,
            ..ProgramAssembler::new(kernels, layout, native)
        }
    }

    /// Compiles what must be compiled before the first run: all code in the order of tickets, and loops by kernel.
    pub fn compile(self, functions: &[Function]) -> (Vec<NativeEntry>, CompiledLoops) {
        let entries = self.compiler.compile(functions);
        let entry = |(&kernel, ticket): (&KernelId, &CodeTicket)| Some((kernel, entries.get(ticket.index())?.clone()));
        let loops = self.tickets.iter().filter_map(entry).collect();
        (entries, loops)
    }

    /// The kernels of which programs are made.
    pub fn kernels(&self) -> &'a KernelTable {
        self.kernels
    }

    /// Sets whether programs made from now on are known to run often.
    pub fn often(&mut self, often: bool) {
        self.limit = if often { SOON_COMPILED } else { WORTH_COMPILING };
    }

    /// Makes the program that computes `defs` and then `products`.
    pub fn assemble(
        &mut self,
        defs: &KernelDefinitions,
        order: DefinitionOrder,
        products: Option<ProductSums>,
    ) -> Program {
        let mut steps = Vec::new();
        let looped = self.looped(defs, order);
        let mut straight = StraightLineCode::default();
        for i in self.schedule(defs, order, &looped) {
            let (kernel, inputs, targets) = defs.get(self.kernels, i);
            if looped.contains(&kernel) {
                self.flush(&mut straight, &mut steps);
                self.push_loop(kernel, inputs, targets, &mut steps);
            } else {
                // a full piece is closed; so is one that would define a slot twice
                if !straight.takes(targets, self.straight_size) {
                    self.flush(&mut straight, &mut steps);
                }
                straight.add(self.kernels, kernel, inputs, targets);
            }
        }
        self.flush(&mut straight, &mut steps);
        // ordered only now, because the number of rows decides when a loop is compiled
        for step in &mut steps {
            if let ProgramStep::Loop(l) = step {
                l.native = self.order_loop(l);
            }
        }
        steps.extend(products.filter(|p| !p.sums.is_empty()).map(ProgramStep::Products));
        self.late_loops.clear();
        let late = std::mem::take(&mut self.late);
        let late = (!late.is_empty()).then(|| LazyNativeCode::new(late, self.limit));
        Program { steps: Arc::new(steps), late, ..Program::default() }
    }

    /// The intermediate code of a kernel, made at its first use.
    fn code(&mut self, kernel: KernelId) -> Arc<KernelCode> {
        let kernels = self.kernels;
        let make = || Arc::new(KernelCode::new(&kernels.pool, &kernels.get(kernel).outputs));
        self.codes.entry(kernel).or_insert_with(make).clone()
    }

    /// The kernels that run as loops. None where the order of definitions is given.
    fn looped(&mut self, defs: &KernelDefinitions, order: DefinitionOrder) -> FxHashSet<KernelId> {
        let mut counts: FxHashMap<KernelId, usize> = FxHashMap::default();
        if order == DefinitionOrder::Dependency {
            defs.items.iter().for_each(|&(kernel, _)| *counts.entry(kernel).or_default() += 1);
        }
        counts.retain(|_, count| *count >= LOOP_INSTANCES);
        counts.retain(|&kernel, count| *count * self.code(kernel).size >= LOOP_SIZE);
        counts.into_keys().collect()
    }

    /// The order of computation: by level, in each level loops before straight code, equal kernels together.
    fn schedule(&self, defs: &KernelDefinitions, order: DefinitionOrder, looped: &FxHashSet<KernelId>) -> Vec<usize> {
        let mut sequence: Vec<usize> = (0..defs.len()).collect();
        if order == DefinitionOrder::Given || looped.is_empty() {
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

    /// The level of each definition: one more than the highest level of what it reads.
    fn levels(&self, defs: &KernelDefinitions) -> Vec<u32> {
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

    /// Adds a row to the last step if that is a loop of this kernel, else starts a new loop.
    fn push_loop(
        &mut self,
        kernel: KernelId,
        inputs: &[ValueSlot],
        targets: &[ValueSlot],
        steps: &mut Vec<ProgramStep>,
    ) {
        let open = matches!(steps.last(), Some(ProgramStep::Loop(l)) if l.kernel == kernel);
        if !open {
            let code = self.code(kernel);
            let bytecode = Bytecode::looped(&code, slot(inputs.len()), self.layout);
            let (inputs, outputs) = (inputs.len(), targets.len());
            let native = NativeStatus::None;
            steps.push(ProgramStep::Loop(KernelLoop {
                kernel,
                bytecode,
                native,
                inputs,
                outputs,
                table: Vec::new(),
                scratch: 0,
            }));
        }
        if let Some(ProgramStep::Loop(l)) = steps.last_mut() {
            l.table.extend_from_slice(inputs);
            l.table.extend_from_slice(targets);
        }
    }

    /// Orders the machine code of a loop: at once for long loops, otherwise when the program has run often.
    fn order_loop(&mut self, l: &KernelLoop) -> NativeStatus {
        if let Some(entry) = self.ready.and_then(|ready| ready.get(&l.kernel)) {
            return NativeStatus::Ready(entry.clone());
        }
        let code = self.code(l.kernel);
        // very large kernels would take too long to compile
        if !self.native || code.size > 2 * STRAIGHT_SIZE {
            return NativeStatus::None;
        }
        let inputs = slot(l.inputs);
        if l.rows() < ALWAYS_COMPILED && !self.tickets.contains_key(&l.kernel) {
            let order = || self.late.order_loop(code, inputs);
            return NativeStatus::Late(*self.late_loops.entry(l.kernel).or_insert_with(order));
        }
        let order = || self.compiler.order_loop(code, inputs);
        NativeStatus::Ordered(*self.tickets.entry(l.kernel).or_insert_with(order))
    }

    /// Closes the open piece of straight code and adds it to the steps.
    fn flush(&mut self, straight: &mut StraightLineCode, steps: &mut Vec<ProgramStep>) {
        let StraightLineCode { pool, targets, outputs, .. } = std::mem::take(straight);
        if targets.is_empty() {
            return;
        }
        let code = KernelCode::new(&pool, &outputs);
        let bytecode = Bytecode::straight(&code, &targets, self.layout);
        let native = if self.native && code.size <= 2 * STRAIGHT_SIZE {
            NativeStatus::Late(self.late.order_straight(Arc::new(code), targets))
        } else {
            NativeStatus::None
        };
        steps.push(ProgramStep::Straight { bytecode, native });
    }
}

/// A piece of straight code that is being collected: expressions whose leaves are slots.
#[derive(Default)]
struct StraightLineCode {
    /// Its expressions. Equal ones of different kernels are shared.
    pool: Exprs,
    /// The slots that it writes.
    targets: Vec<ValueSlot>,
    /// The expression of each of them.
    outputs: Vec<ExprId>,
    /// The expression last computed for a slot.
    current: FxHashMap<ValueSlot, ExprId>,
}

impl StraightLineCode {
    /// Whether a definition of these slots fits in: there is room, and none of the slots is defined here already.
    fn takes(&self, targets: &[ValueSlot], size: usize) -> bool {
        self.pool.len() < size && !targets.iter().any(|target| self.current.contains_key(target))
    }

    /// Copies a kernel into the piece, with its inputs replaced by slots or by expressions computed before.
    fn add(&mut self, kernels: &KernelTable, kernel: KernelId, inputs: &[ValueSlot], targets: &[ValueSlot]) {
        let shape = kernels.get(kernel);
        let mut copies: FxHashMap<ExprId, ExprId> = FxHashMap::default();
        for e in kernels.pool.reachable(&shape.outputs, |_| true) {
            let copy = match kernels.pool.node(e) {
                ExprNode::Var(VarId(input)) => self.leaf(inputs[input as usize]),
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

    /// The expression of a slot: what the piece has computed for it, else a leaf that reads the slot.
    fn leaf(&mut self, slot: ValueSlot) -> ExprId {
        match self.current.get(&slot) {
            Some(&known) => known,
            None => self.pool.var(VarId(slot)),
        }
    }
}
