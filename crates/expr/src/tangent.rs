//! Exact forward differentiation of functions, as a program transformation.
//!
//! The tangent of a function with `n` inputs takes the inputs and `n` input tangents and returns the tangents of the
//! outputs. Every slot gets a second one that holds its tangent, and every assignment is preceded by that of the
//! tangent. Calls become calls of the tangent of the called function, which is reserved before its body is made, so
//! that recursive functions end. A tangent is a function like any other: its tangent gives second derivatives.

use super::function::{Function, Handle, Stmt, Term};
use super::rules::{self, Algebra};
use super::{Binary, Exprs, FunctionId, Rel, Unary, math};

impl Exprs {
    /// The function that takes the inputs of `f` and returns the derivatives of its outputs by one input.
    pub fn derivative_function(&mut self, f: FunctionId, input: u32) -> FunctionId {
        if let Some(&known) = self.partials.get(&(f, input)) {
            return known;
        }
        let tangent = self.tangent_function(f);
        let original = &self.functions[f.0 as usize];
        let inputs = original.inputs;
        let outputs = u32::try_from(original.outputs.len()).expect("fewer than 2^32 outputs");
        let results: Vec<u32> = (inputs..inputs + outputs).collect();
        let values = (0..inputs).map(Term::Slot);
        let direction = (0..inputs).map(|i| Term::Num(math::truth(i == input)));
        let partial = Function {
            name: original.name.clone(),
            inputs,
            slots: inputs + outputs,
            outputs: results.clone(),
            body: vec![Stmt::Call {
                function: tangent,
                args: values.chain(direction).collect(),
                outputs: results.into_iter().map(Some).collect(),
            }],
        };
        let id = self.add_function(partial);
        self.partials.insert((f, input), id);
        id
    }

    /// The function that takes the inputs of `f`, then a tangent for each, and returns the tangents of its outputs.
    pub fn tangent_function(&mut self, f: FunctionId) -> FunctionId {
        if let Some(&known) = self.tangents.get(&f) {
            return known;
        }
        let original = self.functions[f.0 as usize].clone();
        let layout = Layout { inputs: original.inputs, slots: original.slots };
        let id = self.add_function(Function {
            name: original.name,
            inputs: 2 * original.inputs,
            slots: 2 * original.slots,
            outputs: original.outputs.iter().map(|&slot| layout.tangent(slot)).collect(),
            body: Vec::new(),
        });
        self.tangents.insert(f, id);
        let body = Tangent { pool: self, layout }.statements(&original.body);
        self.functions[id.0 as usize].body = body;
        id
    }

    /// Adds a function to the pool.
    pub fn add_function(&mut self, function: Function) -> FunctionId {
        let id = FunctionId(u32::try_from(self.functions.len()).expect("fewer than 2^32 functions"));
        self.functions.push(function);
        id
    }
}

/// Where the slots of a function and their tangents are in its tangent function: input values, input tangents, other
/// values, other tangents. Arrays stay together.
#[derive(Clone, Copy)]
struct Layout {
    inputs: u32,
    slots: u32,
}

impl Layout {
    fn value(self, slot: u32) -> u32 {
        if slot < self.inputs { slot } else { self.inputs + slot }
    }

    fn tangent(self, slot: u32) -> u32 {
        if slot < self.inputs { self.inputs + slot } else { self.slots + slot }
    }
}

/// Transforms the body of one function.
struct Tangent<'a> {
    pool: &'a mut Exprs,
    layout: Layout,
}

impl Tangent<'_> {
    fn statements(&mut self, body: &[Stmt]) -> Vec<Stmt> {
        let mut out = Vec::new();
        for stmt in body {
            self.statement(stmt, &mut out);
        }
        out
    }

    fn statement(&mut self, stmt: &Stmt, out: &mut Vec<Stmt>) {
        match stmt {
            Stmt::Assign(slot, value) => {
                let change = self.tangent_or_zero(value);
                out.push(Stmt::Assign(self.layout.tangent(*slot), change));
                out.push(Stmt::Assign(self.layout.value(*slot), self.value(value)));
            }
            Stmt::AssignAt { base, len, offset, value } => {
                let change = self.tangent_or_zero(value);
                let at = |base, value| Stmt::AssignAt { base, len: *len, offset: self.value(offset), value };
                out.push(at(self.layout.tangent(*base), change));
                out.push(at(self.layout.value(*base), self.value(value)));
            }
            Stmt::Call { function, args, outputs } => self.call(*function, args, outputs, out),
            Stmt::If(branches, otherwise) => {
                let branches = branches.iter().map(|(c, body)| (self.value(c), self.statements(body))).collect();
                let otherwise = self.statements(otherwise);
                out.push(Stmt::If(branches, otherwise));
            }
            Stmt::For { slot, from, step, to, body } => {
                let mut inside = vec![Stmt::Assign(self.layout.tangent(*slot), Term::Num(0.0))];
                inside.extend(self.statements(body));
                let (from, step, to) = (self.value(from), self.value(step), self.value(to));
                out.push(Stmt::For { slot: self.layout.value(*slot), from, step, to, body: inside });
            }
            Stmt::While(condition, body) => {
                let body = self.statements(body);
                out.push(Stmt::While(self.value(condition), body));
            }
            Stmt::Break => out.push(Stmt::Break),
            Stmt::Return => out.push(Stmt::Return),
            Stmt::Assert(condition, message) => out.push(Stmt::Assert(self.value(condition), message.clone())),
        }
    }

    fn call(&mut self, function: FunctionId, args: &[Term], outputs: &[Option<u32>], out: &mut Vec<Stmt>) {
        let tangent = self.pool.tangent_function(function);
        let changes = outputs.iter().map(|slot| slot.map(|slot| self.layout.tangent(slot))).collect();
        let values = outputs.iter().map(|slot| slot.map(|slot| self.layout.value(slot))).collect();
        let both = self.with_tangents(args);
        // The arguments may be outputs too: tangents are written first, and values are not read after they are.
        out.push(Stmt::Call { function: tangent, args: both, outputs: changes });
        out.push(Stmt::Call { function, args: args.iter().map(|arg| self.value(arg)).collect(), outputs: values });
    }

    fn with_tangents(&mut self, args: &[Term]) -> Vec<Term> {
        let mut both: Vec<Term> = args.iter().map(|arg| self.value(arg)).collect();
        for arg in args {
            both.push(self.tangent_or_zero(arg));
        }
        both
    }

    /// The term itself, over the new slots.
    fn value(&self, term: &Term) -> Term {
        let layout = self.layout;
        match term {
            Term::Num(value) => Term::Num(*value),
            Term::Slot(slot) => Term::Slot(layout.value(*slot)),
            Term::At { base, len, offset } => self.element(layout.value(*base), *len, offset),
            Term::Unary(op, a) => Term::Unary(*op, Box::new(self.value(a))),
            Term::Binary(op, a, b) => Term::Binary(*op, Box::new(self.value(a)), Box::new(self.value(b))),
            Term::Rel(rel, a, b) => Term::Rel(*rel, Box::new(self.value(a)), Box::new(self.value(b))),
            Term::If(c, a, b) => Term::If(Box::new(self.value(c)), Box::new(self.value(a)), Box::new(self.value(b))),
            Term::Call(f, output, args) => Term::Call(*f, *output, args.iter().map(|arg| self.value(arg)).collect()),
            Term::External(f, output, args) => {
                Term::External(f.clone(), *output, args.iter().map(|arg| self.value(arg)).collect())
            }
        }
    }

    fn element(&self, base: u32, len: u32, offset: &Term) -> Term {
        Term::At { base, len, offset: Box::new(self.value(offset)) }
    }

    fn tangent_or_zero(&mut self, term: &Term) -> Term {
        self.tangent(term).unwrap_or(Term::Num(0.0))
    }

    /// The tangent of a term; `None` when it is always 0.
    fn tangent(&mut self, term: &Term) -> Option<Term> {
        match term {
            Term::Num(_) | Term::Rel(..) => None,
            Term::Slot(slot) => Some(Term::Slot(self.layout.tangent(*slot))),
            Term::At { base, len, offset } => Some(self.element(self.layout.tangent(*base), *len, offset)),
            Term::Unary(op, a) => {
                let da = self.tangent(a)?;
                rules::unary(&mut Terms, *op, &self.value(a), &self.value(term), da)
            }
            Term::Binary(op, a, b) => {
                let (da, db) = (self.tangent(a), self.tangent(b));
                rules::binary(&mut Terms, *op, (&self.value(a), &self.value(b), &self.value(term)), da, db)
            }
            Term::If(c, a, b) => {
                let (da, db) = (self.tangent(a), self.tangent(b));
                rules::branch(&mut Terms, self.value(c), da, db)
            }
            Term::Call(function, output, args) => {
                let tangent = self.pool.tangent_function(*function);
                Some(Term::Call(tangent, *output, self.with_tangents(args)))
            }
            Term::External(function, output, args) => {
                let values: Vec<Term> = args.iter().map(|arg| self.value(arg)).collect();
                let mut sum = None;
                for (i, arg) in args.iter().enumerate() {
                    let (Some(partial), Some(change)) = (function.0.partial(i), self.tangent(arg)) else { continue };
                    let slope = Term::External(Handle(partial), *output, values.clone());
                    let part = Terms.binary(Binary::Mul, slope, change);
                    sum = Some(match sum {
                        Some(before) => Terms.binary(Binary::Add, before, part),
                        None => part,
                    });
                }
                sum
            }
        }
    }
}

/// Builds terms, dropping neutral elements as the pool of expressions does.
struct Terms;

impl Algebra for Terms {
    type E = Term;

    fn num(&mut self, value: f64) -> Term {
        Term::Num(value)
    }

    fn unary(&mut self, op: Unary, a: Term) -> Term {
        match (op, a) {
            (Unary::Neg, Term::Num(x)) => Term::Num(-x),
            (Unary::Neg, Term::Unary(Unary::Neg, inner)) => *inner,
            (op, a) => Term::Unary(op, Box::new(a)),
        }
    }

    fn binary(&mut self, op: Binary, a: Term, b: Term) -> Term {
        match (op, &a, &b) {
            (Binary::Mul, Term::Num(0.0), _) | (Binary::Mul, _, Term::Num(0.0)) => Term::Num(0.0),
            (Binary::Mul | Binary::Div | Binary::Pow, _, Term::Num(1.0)) => a,
            (Binary::Mul, Term::Num(1.0), _) => b,
            (Binary::Add | Binary::Sub, _, Term::Num(0.0)) => a,
            (Binary::Add, Term::Num(0.0), _) => b,
            (Binary::Pow, _, Term::Num(0.0)) => Term::Num(1.0),
            (_, Term::Num(x), Term::Num(y)) if math::binary(op, *x, *y).is_finite() => {
                Term::Num(math::binary(op, *x, *y))
            }
            _ => Term::Binary(op, Box::new(a), Box::new(b)),
        }
    }

    fn rel(&mut self, rel: Rel, a: Term, b: Term) -> Term {
        Term::Rel(rel, Box::new(a), Box::new(b))
    }

    fn if_(&mut self, c: Term, a: Term, b: Term) -> Term {
        Term::If(Box::new(c), Box::new(a), Box::new(b))
    }
}
