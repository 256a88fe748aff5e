//! Exact forward differentiation of functions, as a program transformation.
//!
//! The tangent function of a function with n inputs takes the inputs and n input tangents, and returns the tangents of
//! the
//! outputs. Every slot gets a second one for its tangent, and every assignment is preceded by one of the tangent.
//! Calls become calls of the callee's tangent function, which is reserved before its body is built, so that recursion
//! ends. A tangent function is a function like any other, and its own tangent gives second derivatives.

use super::function::{ExternalFunctionHandle, Function, SlotExpr, SlotStatement};
use super::rules::{self, ExprAlgebra};
use super::{BinaryFunction, Exprs, FunctionId, RelationalOp, UnaryFunction, math};

impl Exprs {
    /// The function that takes the inputs of `f` and returns the derivatives of all its outputs by one input.
    /// It is built once for each input.
    /// The body is one call of the tangent function.
    pub fn derivative_function(&mut self, f: FunctionId, input: u32) -> FunctionId {
        if let Some(&known) = self.partials.get(&(f, input)) {
            return known;
        }
        let tangent = self.tangent_function(f);
        let original = &self.functions[f.0 as usize];
        let inputs = original.inputs;
        let outputs = u32::try_from(original.outputs.len()).expect("fewer than 2^32 outputs");
        let results: Vec<u32> = (inputs..inputs + outputs).collect();
        let values = (0..inputs).map(SlotExpr::Slot);
        // The direction is the unit vector of the input.
        let direction = (0..inputs).map(|i| SlotExpr::Num(math::truth(i == input)));
        let partial = Function {
            name: original.name.clone(),
            inputs,
            slots: inputs + outputs,
            outputs: results.clone(),
            body: vec![SlotStatement::Call {
                function: tangent,
                args: values.chain(direction).collect(),
                outputs: results.into_iter().map(Some).collect(),
            }],
        };
        let id = self.add_function(partial);
        self.partials.insert((f, input), id);
        id
    }

    /// The tangent function of `f`: it takes the inputs, then a tangent for each, and returns the tangents of the
    /// outputs.
    /// It is built once.
    /// A function carried out in Rust has tangents from its `partial` functions.
    pub fn tangent_function(&mut self, f: FunctionId) -> FunctionId {
        if let Some(&known) = self.tangents.get(&f) {
            return known;
        }
        let original = self.functions[f.0 as usize].clone();
        let layout = TangentLayout { inputs: original.inputs, slots: original.slots };
        let id = self.add_function(Function {
            name: original.name,
            inputs: 2 * original.inputs,
            slots: 2 * original.slots,
            outputs: original.outputs.iter().map(|&slot| layout.tangent(slot)).collect(),
            body: Vec::new(),
        });
        // Known before its body exists: the body may call the function itself.
        self.tangents.insert(f, id);
        let body = TangentTransform { pool: self, layout }.statements(&original.body);
        self.functions[id.0 as usize].body = body;
        id
    }

    /// Adds a function to the pool. Equal functions are not shared.
    pub fn add_function(&mut self, function: Function) -> FunctionId {
        let id = FunctionId(u32::try_from(self.functions.len()).expect("fewer than 2^32 functions"));
        self.functions.push(function);
        id
    }
}

/// The slots of a tangent function: input values, input tangents, other values, other tangents.
/// Arrays stay contiguous, as elements are addressed relative to their base.
#[derive(Clone, Copy)]
/// The number of inputs of the original.
struct TangentLayout {
    /// The number of slots of the original.
    inputs: u32,
    slots: u32,
}

impl TangentLayout {
    /// The slot of a value.
    fn value(self, slot: u32) -> u32 {
        if slot < self.inputs { slot } else { self.inputs + slot }
    }

    /// The slot of its tangent.
    fn tangent(self, slot: u32) -> u32 {
        if slot < self.inputs { self.inputs + slot } else { self.slots + slot }
    }
}

/// Transforms the body of one function.
/// Borrowing the pool allows it to make the tangent functions of callees on the way.
struct TangentTransform<'a> {
    /// The pool, to which tangent functions of callees are added.
    pool: &'a mut Exprs,
    /// The slots of the tangent function.
    layout: TangentLayout,
}

impl TangentTransform<'_> {
    /// The transformed statements, in order.
    /// Each statement becomes one or two.
    fn statements(&mut self, body: &[SlotStatement]) -> Vec<SlotStatement> {
        let mut out = Vec::new();
        for stmt in body {
            self.statement(stmt, &mut out);
        }
        out
    }

    /// Appends the statements that compute what `stmt` does and its tangent.
    fn statement(&mut self, stmt: &SlotStatement, out: &mut Vec<SlotStatement>) {
        match stmt {
            SlotStatement::Assign(slot, value) => {
                // The tangent comes first, since it needs the values before the assignment: `x := x*x`.
                let change = self.tangent_or_zero(value);
                out.push(SlotStatement::Assign(self.layout.tangent(*slot), change));
                out.push(SlotStatement::Assign(self.layout.value(*slot), self.value(value)));
            }
            SlotStatement::AssignAt { base, len, offset, value } => {
                let change = self.tangent_or_zero(value);
                let at = |base, value| SlotStatement::AssignAt { base, len: *len, offset: self.value(offset), value };
                out.push(at(self.layout.tangent(*base), change));
                out.push(at(self.layout.value(*base), self.value(value)));
            }
            SlotStatement::Call { function, args, outputs } => self.call(*function, args, outputs, out),
            SlotStatement::If(branches, otherwise) => {
                let branches = branches.iter().map(|(c, body)| (self.value(c), self.statements(body))).collect();
                let otherwise = self.statements(otherwise);
                out.push(SlotStatement::If(branches, otherwise));
            }
            SlotStatement::For { slot, from, step, to, body } => {
                // A loop variable does not depend on the inputs.
                let mut inside = vec![SlotStatement::Assign(self.layout.tangent(*slot), SlotExpr::Num(0.0))];
                inside.extend(self.statements(body));
                let (from, step, to) = (self.value(from), self.value(step), self.value(to));
                out.push(SlotStatement::For { slot: self.layout.value(*slot), from, step, to, body: inside });
            }
            SlotStatement::While(condition, body) => {
                let body = self.statements(body);
                out.push(SlotStatement::While(self.value(condition), body));
            }
            SlotStatement::Break => out.push(SlotStatement::Break),
            SlotStatement::Return => out.push(SlotStatement::Return),
            SlotStatement::Assert(condition, message) => {
                out.push(SlotStatement::Assert(self.value(condition), message.clone()))
            }
        }
    }

    /// A call, preceded by one of the tangent function.
    /// Outputs that are dropped have no tangent either.
    fn call(&mut self, function: FunctionId, args: &[SlotExpr], outputs: &[Option<u32>], out: &mut Vec<SlotStatement>) {
        let tangent = self.pool.tangent_function(function);
        let changes = outputs.iter().map(|slot| slot.map(|slot| self.layout.tangent(slot))).collect();
        let values = outputs.iter().map(|slot| slot.map(|slot| self.layout.value(slot))).collect();
        let both = self.with_tangents(args);
        // Outputs may be arguments too. Tangents are stored first, so both calls read the values from before.
        out.push(SlotStatement::Call { function: tangent, args: both, outputs: changes });
        out.push(SlotStatement::Call {
            function,
            args: args.iter().map(|arg| self.value(arg)).collect(),
            outputs: values,
        });
    }

    /// The arguments of a tangent function: values, then tangents.
    /// The order is that of [`TangentLayout`].
    fn with_tangents(&mut self, args: &[SlotExpr]) -> Vec<SlotExpr> {
        let mut both: Vec<SlotExpr> = args.iter().map(|arg| self.value(arg)).collect();
        for arg in args {
            both.push(self.tangent_or_zero(arg));
        }
        both
    }

    /// The expression itself, over the new slots.
    /// Its slots are renumbered, and nothing else changes.
    fn value(&self, term: &SlotExpr) -> SlotExpr {
        let layout = self.layout;
        match term {
            SlotExpr::Num(value) => SlotExpr::Num(*value),
            SlotExpr::Slot(slot) => SlotExpr::Slot(layout.value(*slot)),
            SlotExpr::At { base, len, offset } => self.element(layout.value(*base), *len, offset),
            SlotExpr::Unary(op, a) => SlotExpr::Unary(*op, Box::new(self.value(a))),
            SlotExpr::Binary(op, a, b) => SlotExpr::Binary(*op, Box::new(self.value(a)), Box::new(self.value(b))),
            SlotExpr::Rel(rel, a, b) => SlotExpr::Rel(*rel, Box::new(self.value(a)), Box::new(self.value(b))),
            SlotExpr::If(c, a, b) => {
                SlotExpr::If(Box::new(self.value(c)), Box::new(self.value(a)), Box::new(self.value(b)))
            }
            SlotExpr::Call(f, output, args) => {
                SlotExpr::Call(*f, *output, args.iter().map(|arg| self.value(arg)).collect())
            }
            SlotExpr::External(f, output, args) => {
                SlotExpr::External(f.clone(), *output, args.iter().map(|arg| self.value(arg)).collect())
            }
        }
    }

    /// An element of an array at a new base.
    /// The offset is that of the original.
    fn element(&self, base: u32, len: u32, offset: &SlotExpr) -> SlotExpr {
        SlotExpr::At { base, len, offset: Box::new(self.value(offset)) }
    }

    /// The tangent of an expression, as a number if it is 0.
    /// Assignments need a value even if it is 0.
    fn tangent_or_zero(&mut self, term: &SlotExpr) -> SlotExpr {
        self.tangent(term).unwrap_or(SlotExpr::Num(0.0))
    }

    /// The tangent of an expression. `None` if it is always 0.
    fn tangent(&mut self, term: &SlotExpr) -> Option<SlotExpr> {
        match term {
            SlotExpr::Num(_) | SlotExpr::Rel(..) => None,
            SlotExpr::Slot(slot) => Some(SlotExpr::Slot(self.layout.tangent(*slot))),
            // An index does not depend on the inputs in a differentiable way.
            SlotExpr::At { base, len, offset } => Some(self.element(self.layout.tangent(*base), *len, offset)),
            SlotExpr::Unary(op, a) => {
                let da = self.tangent(a)?;
                rules::unary(&mut SlotExprBuilder, *op, &self.value(a), &self.value(term), da)
            }
            SlotExpr::Binary(op, a, b) => {
                let (da, db) = (self.tangent(a), self.tangent(b));
                rules::binary(&mut SlotExprBuilder, *op, (&self.value(a), &self.value(b), &self.value(term)), da, db)
            }
            SlotExpr::If(c, a, b) => {
                let (da, db) = (self.tangent(a), self.tangent(b));
                rules::branch(&mut SlotExprBuilder, self.value(c), da, db)
            }
            SlotExpr::Call(function, output, args) => {
                let tangent = self.pool.tangent_function(*function);
                Some(SlotExpr::Call(tangent, *output, self.with_tangents(args)))
            }
            SlotExpr::External(function, output, args) => {
                let values: Vec<SlotExpr> = args.iter().map(|arg| self.value(arg)).collect();
                let mut sum = None;
                for (i, arg) in args.iter().enumerate() {
                    let (Some(partial), Some(change)) = (function.0.partial(i), self.tangent(arg)) else { continue };
                    let slope = SlotExpr::External(ExternalFunctionHandle(partial), *output, values.clone());
                    let part = SlotExprBuilder.binary(BinaryFunction::Mul, slope, change);
                    sum = Some(match sum {
                        Some(before) => SlotExprBuilder.binary(BinaryFunction::Add, before, part),
                        None => part,
                    });
                }
                sum
            }
        }
    }
}

/// Builds expressions over slots, and drops neutral elements as the pool does.
/// It keeps the programs small, since most tangents have many factors 0 and 1.
struct SlotExprBuilder;

impl ExprAlgebra for SlotExprBuilder {
    type E = SlotExpr;

    fn num(&mut self, value: f64) -> SlotExpr {
        SlotExpr::Num(value)
    }

    fn unary(&mut self, op: UnaryFunction, a: SlotExpr) -> SlotExpr {
        match (op, a) {
            (UnaryFunction::Neg, SlotExpr::Num(x)) => SlotExpr::Num(-x),
            (UnaryFunction::Neg, SlotExpr::Unary(UnaryFunction::Neg, inner)) => *inner,
            (op, a) => SlotExpr::Unary(op, Box::new(a)),
        }
    }

    fn binary(&mut self, op: BinaryFunction, a: SlotExpr, b: SlotExpr) -> SlotExpr {
        match (op, &a, &b) {
            (BinaryFunction::Mul, SlotExpr::Num(0.0), _) | (BinaryFunction::Mul, _, SlotExpr::Num(0.0)) => {
                SlotExpr::Num(0.0)
            }
            (BinaryFunction::Mul | BinaryFunction::Div | BinaryFunction::Pow, _, SlotExpr::Num(1.0)) => a,
            (BinaryFunction::Mul, SlotExpr::Num(1.0), _) => b,
            (BinaryFunction::Add | BinaryFunction::Sub, _, SlotExpr::Num(0.0)) => a,
            (BinaryFunction::Add, SlotExpr::Num(0.0), _) => b,
            (BinaryFunction::Pow, _, SlotExpr::Num(0.0)) => SlotExpr::Num(1.0),
            (_, SlotExpr::Num(x), SlotExpr::Num(y)) if math::binary(op, *x, *y).is_finite() => {
                SlotExpr::Num(math::binary(op, *x, *y))
            }
            _ => SlotExpr::Binary(op, Box::new(a), Box::new(b)),
        }
    }

    fn rel(&mut self, rel: RelationalOp, a: SlotExpr, b: SlotExpr) -> SlotExpr {
        SlotExpr::Rel(rel, Box::new(a), Box::new(b))
    }

    fn if_(&mut self, c: SlotExpr, a: SlotExpr, b: SlotExpr) -> SlotExpr {
        SlotExpr::If(Box::new(c), Box::new(a), Box::new(b))
    }
}
