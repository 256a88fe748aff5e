//! Functions of time alone, written out in the order of evaluation: for a time, and in bounds over a stretch of time.

use super::bounds::{Bounds, Span};
use crate::lower::System;
use bramah_expr::function::Function;
use bramah_expr::{Binary, ExprId, Exprs, FunctionId, Node, Rel, Unary, VarId, math};
use bramah_model::structure::{Assign, Block, Unknown};
use rustc_hash::{FxHashMap, FxHashSet};

/// Longer functions and deeper ones are left to the integrator.
const MOST_STEPS: usize = 2000;
const DEEPEST: u32 = 500;

#[derive(Clone, Debug)]
enum Step {
    Number(f64),
    Time,
    /// What stands between events, by its place in `Tape::held`.
    Held(usize),
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
    Relation(Rel, usize, usize),
    Choice(usize, usize, usize),
    Call(FunctionId, usize, Vec<usize>),
}

/// The difference of the sides of a relation that time alone changes between events.
#[derive(Clone, Debug)]
pub struct Tape {
    steps: Vec<Step>,
    /// Slots of parameters and discrete values.
    pub held: Vec<usize>,
    /// No step of it is without bounds.
    pub bounded: bool,
}

impl Tape {
    /// The difference at a time.
    pub fn at(&self, functions: &[Function], held: &[f64], t: f64, scratch: &mut Vec<f64>) -> f64 {
        scratch.clear();
        for step in &self.steps {
            let of = |i: usize| scratch[i];
            let value = match *step {
                Step::Number(x) => x,
                Step::Time => t,
                Step::Held(i) => held[i],
                Step::Unary(op, a) => math::unary(op, of(a)),
                Step::Binary(op, a, b) => math::binary(op, of(a), of(b)),
                Step::Relation(rel, a, b) => math::truth(math::holds(rel, of(a), of(b))),
                Step::Choice(c, a, b) => of(if of(c) == 0.0 { b } else { a }),
                Step::Call(function, output, ref args) => {
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

    /// The difference and its slope over a stretch of time.
    pub fn over(&self, held: &[f64], time: Span, scratch: &mut Vec<Bounds>) -> Bounds {
        scratch.clear();
        for step in &self.steps {
            let of = |i: usize| scratch[i];
            let bounds = match *step {
                Step::Number(x) => Bounds::constant(x),
                Step::Time => Bounds { value: time, slope: Span::exactly(1.0) },
                Step::Held(i) => Bounds::constant(held[i]),
                Step::Unary(op, a) => Bounds::unary(op, of(a)),
                Step::Binary(Binary::Mul, a, b) if a == b => Bounds::square(of(a)),
                Step::Binary(op, a, b) => Bounds::binary(op, of(a), of(b)),
                Step::Relation(rel, a, b) => Bounds::relation(rel, of(a), of(b)),
                Step::Choice(c, a, b) => Bounds::choice(of(c), of(a), of(b)),
                Step::Call(..) => Bounds::UNKNOWN,
            };
            scratch.push(bounds);
        }
        scratch.last().copied().unwrap_or(Bounds::UNKNOWN)
    }
}

/// Writes tapes of one system.
pub struct Writer<'a> {
    system: &'a System,
    /// What blocks between events compute by one formula.
    formulas: FxHashMap<VarId, ExprId>,
    /// What else moves between events.
    moving: FxHashSet<VarId>,
}

impl<'a> Writer<'a> {
    pub fn new(system: &'a System) -> Self {
        let dae = &system.dae;
        let delayed = dae.delays.iter().map(|d| d.variable);
        let columns = system.columns.iter().map(|c| c.variable);
        let mut moving: FxHashSet<VarId> =
            dae.inputs.iter().chain(&dae.states).copied().chain(columns).chain(delayed).collect();
        // parameters that an analysis has made states stand still
        let still = dae.continuous.iter().filter_map(|block| match block {
            Block::Assign(Assign { unknown: Unknown::Der(v), value: Exprs::ZERO, .. }) => Some(v),
            _ => None,
        });
        still.for_each(|v| _ = moving.remove(v));
        let mut formulas = FxHashMap::default();
        for block in &dae.continuous {
            match block {
                Block::Assign(Assign { unknown: Unknown::Var(v), value, .. }) => _ = formulas.insert(*v, *value),
                Block::Assign(_) => {}
                Block::Loop(found) => {
                    let inner = found.inner.iter().map(|assign| &assign.unknown);
                    moving.extend(found.tearing.iter().chain(inner).map(|unknown| match unknown {
                        Unknown::Var(v) | Unknown::Der(v) => *v,
                    }));
                }
                Block::Mixed(_) => unreachable!("only at events and at the start"),
            }
        }
        Writer { system, formulas, moving }
    }

    /// The difference of two expressions; `None` where more than time moves them.
    pub fn difference(&self, left: ExprId, right: ExprId) -> Option<Tape> {
        let tape = Tape { steps: Vec::new(), held: Vec::new(), bounded: true };
        let mut sheet = Sheet { writer: self, tape, places: FxHashMap::default() };
        let (left, right) = (sheet.place(left, 0)?, sheet.place(right, 0)?);
        sheet.step(Step::Binary(Binary::Sub, left, right))?;
        Some(sheet.tape)
    }
}

/// A tape that is being written.
struct Sheet<'a> {
    writer: &'a Writer<'a>,
    tape: Tape,
    places: FxHashMap<ExprId, usize>,
}

impl Sheet<'_> {
    fn step(&mut self, step: Step) -> Option<usize> {
        self.tape.steps.push(step);
        (self.tape.steps.len() < MOST_STEPS).then_some(self.tape.steps.len() - 1)
    }

    fn held(&mut self, slot: usize) -> Option<usize> {
        self.tape.held.push(slot);
        self.step(Step::Held(self.tape.held.len() - 1))
    }

    /// Where the value of an expression stands.
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
            Node::Num(bits) => self.step(Step::Number(f64::from_bits(bits))),
            Node::Time => self.step(Step::Time),
            Node::Var(v) if self.writer.moving.contains(&v) => None,
            Node::Var(v) => match self.writer.formulas.get(&v) {
                Some(&formula) => self.place(formula, depth),
                None => self.held(layout.var(v)),
            },
            Node::Pre(v) => self.held(layout.pre(v)?),
            Node::Unary(op, a) => {
                let a = self.place(a, depth)?;
                self.step(Step::Unary(op, a))
            }
            Node::Binary(op, a, b) => {
                let (a, b) = (self.place(a, depth)?, self.place(b, depth)?);
                self.tape.bounded &= op != Binary::Atan2;
                self.step(Step::Binary(op, a, b))
            }
            Node::Rel(rel, a, b) => {
                let (a, b) = (self.place(a, depth)?, self.place(b, depth)?);
                self.step(Step::Relation(rel, a, b))
            }
            Node::If(c, a, b) => {
                let (c, a, b) = (self.place(c, depth)?, self.place(a, depth)?, self.place(b, depth)?);
                self.step(Step::Choice(c, a, b))
            }
            Node::Homotopy(a, _) => self.place(a, depth),
            Node::Call(function, output, args) => {
                let args = dae.exprs.args(args).iter().map(|&a| self.place(a, depth)).collect::<Option<_>>()?;
                self.tape.bounded = false;
                self.step(Step::Call(function, output as usize, args))
            }
            Node::Initial => self.step(Step::Number(0.0)),
            _ => None,
        }?;
        self.places.insert(e, place);
        Some(place)
    }
}
