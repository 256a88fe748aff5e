//! Functions of time alone as a list of operations, evaluated at a time or as bounds over a stretch of time.
//!
//! [`TapeWriter`] follows the formulas of explicit variables from the sides of a relation. `foresight` evaluates the
//! tape.

use super::bounds::{IntervalEnclosure, RealInterval};
use crate::lower::ExecutableSystem;
use bramah_expr::function::Function;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, FunctionId, RelationalOp, UnaryFunction, VarId, math};
use bramah_model::structure::{BltBlock, ExplicitAssignment, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// Longer functions are left to the integrator.
const MOST_STEPS: usize = 2000;
/// Deeper expressions are left to the integrator.
const DEEPEST: u32 = 500;

/// One operation. Operands are indices of earlier operations.
#[derive(Clone, Debug)]
enum TapeOperation {
    /// A number.
    Number(f64),
    /// The time.
    Time,
    /// A value that is constant between events, by its index in `RelationTape::held`.
    Held(usize),
    /// A function of one operand.
    Unary(UnaryFunction, usize),
    /// A function of two operands.
    Binary(BinaryFunction, usize, usize),
    /// A relation as it is: 1 or 0.
    Relation(RelationalOp, usize, usize),
    /// Condition, and the values for true and false.
    Choice(usize, usize, usize),
    /// A user function: number of the function, number of its output, arguments.
    Call(FunctionId, usize, Vec<usize>),
}

/// The difference of the sides of a relation that only time changes between events.
#[derive(Clone, Debug)]
pub struct RelationTape {
    /// The operations; the last one is the result.
    steps: Vec<TapeOperation>,
    /// Slots of parameters and discrete values.
    pub held: Vec<usize>,
    /// Whether all operations have bounds.
    pub bounded: bool,
}

impl RelationTape {
    /// The difference at time `t`.
    pub fn at(&self, functions: &[Function], held: &[f64], t: f64, scratch: &mut Vec<f64>) -> f64 {
        scratch.clear();
        for step in &self.steps {
            let of = |i: usize| scratch[i];
            let value = match *step {
                TapeOperation::Number(x) => x,
                TapeOperation::Time => t,
                TapeOperation::Held(i) => held[i],
                TapeOperation::Unary(op, a) => math::unary(op, of(a)),
                TapeOperation::Binary(op, a, b) => math::binary(op, of(a), of(b)),
                TapeOperation::Relation(rel, a, b) => math::truth(math::holds(rel, of(a), of(b))),
                TapeOperation::Choice(c, a, b) => of(if of(c) == 0.0 { b } else { a }),
                TapeOperation::Call(function, output, ref args) => {
                    let function = &functions[function.0 as usize];
                    let args: Vec<f64> = args.iter().map(|&a| of(a)).collect();
                    let mut out = vec![f64::NAN; function.outputs.len()];
                    function.call(functions, &args, &mut out);
                    out[output]
                }
            };
            scratch.push(value);
        }
        scratch.last().copied().unwrap_or(f64::NAN)
    }

    /// Bounds of the difference and its slope over a stretch of time.
    pub fn over(&self, held: &[f64], time: RealInterval, scratch: &mut Vec<IntervalEnclosure>) -> IntervalEnclosure {
        scratch.clear();
        for step in &self.steps {
            let of = |i: usize| scratch[i];
            let bounds = match *step {
                TapeOperation::Number(x) => IntervalEnclosure::constant(x),
                TapeOperation::Time => IntervalEnclosure { value: time, slope: RealInterval::exactly(1.0) },
                TapeOperation::Held(i) => IntervalEnclosure::constant(held[i]),
                TapeOperation::Unary(op, a) => IntervalEnclosure::unary(op, of(a)),
                // a square is bounded more narrowly than a product of two independent values
                TapeOperation::Binary(BinaryFunction::Mul, a, b) if a == b => IntervalEnclosure::square(of(a)),
                TapeOperation::Binary(op, a, b) => IntervalEnclosure::binary(op, of(a), of(b)),
                TapeOperation::Relation(rel, a, b) => IntervalEnclosure::relation(rel, of(a), of(b)),
                TapeOperation::Choice(c, a, b) => IntervalEnclosure::choice(of(c), of(a), of(b)),
                TapeOperation::Call(..) => IntervalEnclosure::UNKNOWN,
            };
            scratch.push(bounds);
        }
        scratch.last().copied().unwrap_or(IntervalEnclosure::UNKNOWN)
    }
}

/// Writes the tapes of one system.
pub struct TapeWriter<'a> {
    /// The lowered model.
    system: &'a ExecutableSystem,
    /// The definitions of explicit variables between events.
    formulas: FxHashMap<VarId, ExprId>,
    /// All other variables that change between events.
    moving: FxHashSet<VarId>,
}

impl<'a> TapeWriter<'a> {
    /// Sorts the variables of a system into formulas and moving ones.
    pub fn new(system: &'a ExecutableSystem) -> Self {
        let dae = &system.dae;
        let delayed = dae.delays.iter().map(|d| d.variable);
        let columns = system.columns.iter().map(|c| c.variable);
        let mut moving: FxHashSet<VarId> =
            dae.inputs.iter().chain(&dae.states).copied().chain(columns).chain(delayed).collect();
        // parameters that an analysis has turned into states are constant
        let still = dae.continuous.iter().filter_map(|block| match block {
            BltBlock::Assign(ExplicitAssignment { unknown: Unknown::Der(v), value: Exprs::ZERO, .. }) => Some(v),
            _ => None,
        });
        still.for_each(|v| _ = moving.remove(v));
        let mut formulas = FxHashMap::default();
        for block in &dae.continuous {
            match block {
                BltBlock::Assign(ExplicitAssignment { unknown: Unknown::Var(v), value, .. }) => {
                    _ = formulas.insert(*v, *value)
                }
                BltBlock::Assign(_) => {}
                BltBlock::Loop(found) => {
                    let inner = found.inner.iter().map(|assign| &assign.unknown);
                    moving.extend(found.tearing.iter().chain(inner).map(|unknown| match unknown {
                        Unknown::Var(v) | Unknown::Der(v) => *v,
                    }));
                }
                BltBlock::Mixed(_) => unreachable!("only at events and at the start"),
            }
        }
        TapeWriter { system, formulas, moving }
    }

    /// The difference of two expressions; `None` where it depends on more than time, or where it is too long.
    pub fn difference(&self, left: ExprId, right: ExprId) -> Option<RelationTape> {
        let tape = RelationTape { steps: Vec::new(), held: Vec::new(), bounded: true };
        let mut sheet = TapeDraft { writer: self, tape, places: FxHashMap::default() };
        let (left, right) = (sheet.place(left, 0)?, sheet.place(right, 0)?);
        sheet.step(TapeOperation::Binary(BinaryFunction::Sub, left, right))?;
        Some(sheet.tape)
    }
}

/// A tape that is being written.
struct TapeDraft<'a> {
    /// Formulas and moving variables.
    writer: &'a TapeWriter<'a>,
    /// The tape so far.
    tape: RelationTape,
    /// The operation that computes each expression.
    places: FxHashMap<ExprId, usize>,
}

impl TapeDraft<'_> {
    /// Appends an operation and returns its index; `None` when the tape is too long.
    fn step(&mut self, step: TapeOperation) -> Option<usize> {
        self.tape.steps.push(step);
        (self.tape.steps.len() < MOST_STEPS).then_some(self.tape.steps.len() - 1)
    }

    /// Appends a value that is constant between events.
    fn held(&mut self, slot: usize) -> Option<usize> {
        self.tape.held.push(slot);
        self.step(TapeOperation::Held(self.tape.held.len() - 1))
    }

    /// The operation that computes an expression; `None` where more than time changes it.
    fn place(&mut self, e: ExprId, depth: u32) -> Option<usize> {
        if let Some(&place) = self.places.get(&e) {
            return Some(place);
        }
        if depth > DEEPEST {
            return None;
        }
        let depth = depth + 1;
        let system = self.writer.system;
        let (dae, layout) = (&system.dae, &system.layout);
        let place = match dae.exprs.node(e) {
            ExprNode::Num(bits) => self.step(TapeOperation::Number(f64::from_bits(bits))),
            ExprNode::Time => self.step(TapeOperation::Time),
            // states, inputs and unknowns of loops
            ExprNode::Var(v) if self.writer.moving.contains(&v) => None,
            ExprNode::Var(v) => match self.writer.formulas.get(&v) {
                Some(&formula) => self.place(formula, depth),
                None => self.held(layout.var(v)),
            },
            ExprNode::Pre(v) => self.held(layout.pre(v)?),
            ExprNode::Unary(op, a) => {
                let a = self.place(a, depth)?;
                self.step(TapeOperation::Unary(op, a))
            }
            ExprNode::Binary(op, a, b) => {
                let (a, b) = (self.place(a, depth)?, self.place(b, depth)?);
                self.tape.bounded &= op != BinaryFunction::Atan2;
                self.step(TapeOperation::Binary(op, a, b))
            }
            ExprNode::Rel(rel, a, b) => {
                let (a, b) = (self.place(a, depth)?, self.place(b, depth)?);
                self.step(TapeOperation::Relation(rel, a, b))
            }
            ExprNode::If(c, a, b) => {
                let (c, a, b) = (self.place(c, depth)?, self.place(a, depth)?, self.place(b, depth)?);
                self.step(TapeOperation::Choice(c, a, b))
            }
            ExprNode::Homotopy(a, _) => self.place(a, depth),
            ExprNode::Call(function, output, args) => {
                let args = dae.exprs.args(args).iter().map(|&a| self.place(a, depth)).collect::<Option<_>>()?;
                self.tape.bounded = false;
                self.step(TapeOperation::Call(function, output as usize, args))
            }
            ExprNode::Initial => self.step(TapeOperation::Number(0.0)),
            _ => None,
        }?;
        self.places.insert(e, place);
        Some(place)
    }
}
