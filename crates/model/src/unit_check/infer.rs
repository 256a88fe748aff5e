//! Units of all variables: the declared ones, and those that follow from the equations.
//!
//! Each relation is worked through bottom-up and then top-down; when that finds the unit of a variable, the relations
//! it occurs in are worked through again. A relation is looked at a few times at most, so the work grows with the size of
//! the model.

use super::measure::{Measure, Quantity};
use crate::flat::{FlatModel, Type, Variability, Variable, WhenAction};
use bramah_expr::units::{Unit, UnitError};
use bramah_expr::visit::Walk;
use bramah_expr::{Binary, ExprId, Exprs, Node, Unary, VarId};
use bramah_syntax::diag::Span;
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// A relation is worked through so often at most.
const MOST_VISITS: u8 = 8;

/// One side of a relation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side {
    Expr(ExprId),
    Var(VarId),
}

/// Two sides that have the same unit, or one expression to look into.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relation {
    pub lhs: Option<Side>,
    pub rhs: ExprId,
    pub span: Span,
    pub instance: u32,
}

/// All places of a model where units must fit.
pub(super) fn relations(model: &FlatModel) -> Vec<Relation> {
    let mut found = Vec::with_capacity(model.equations.len() + model.variables.len());
    for equation in model.equations.iter().chain(&model.initial_equations) {
        let (span, instance) = (equation.origin.span, equation.origin.instance);
        found.push(Relation { lhs: Some(Side::Expr(equation.lhs)), rhs: equation.rhs, span, instance });
    }
    for (i, variable) in (0..).zip(&model.variables) {
        let (span, instance) = (variable.origin.span, variable.origin.instance);
        let values = [variable.binding, variable.start, variable.min, variable.max, variable.nominal];
        for rhs in values.into_iter().flatten().filter(|&e| model.exprs.as_num(e).is_none()) {
            found.push(Relation { lhs: Some(Side::Var(VarId(i))), rhs, span, instance });
        }
    }
    for branch in model.whens.iter().flat_map(|when| &when.branches) {
        for action in &branch.actions {
            if let WhenAction::Assign { variable, value, origin } | WhenAction::Reinit { variable, value, origin, .. } =
                action
            {
                let (span, instance) = (origin.span, origin.instance);
                found.push(Relation { lhs: Some(Side::Var(*variable)), rhs: *value, span, instance });
            }
        }
    }
    for assert in &model.asserts {
        let (span, instance) = (assert.origin.span, assert.origin.instance);
        found.push(Relation { lhs: None, rhs: assert.condition, span, instance });
    }
    found
}

/// What is known about the units of a model.
pub(super) struct Units<'a> {
    pub model: &'a FlatModel,
    /// By variable.
    pub variables: Vec<Measure>,
    /// The relation that gave an undeclared variable its unit.
    pub found_in: FxHashMap<VarId, u32>,
    /// By node, as of the last time that it was worked through.
    nodes: Vec<Measure>,
    /// The nodes of all relations, each in an order of evaluation.
    order: Vec<ExprId>,
    /// Where each relation's nodes begin in `order`, and one more for the end.
    starts: Vec<usize>,
    /// Variables whose unit the last relation gave.
    fresh: Vec<VarId>,
}

/// A unit string that cannot be read, and a variable that has it.
pub(super) type Unreadable = (VarId, UnitError);

impl<'a> Units<'a> {
    /// The declared units; those that cannot be read are unknown.
    pub fn declared(model: &'a FlatModel, relations: &[Relation]) -> (Self, Vec<Unreadable>) {
        let mut cache: FxHashMap<&str, Result<Unit, UnitError>> = FxHashMap::default();
        let mut unreadable = Vec::new();
        let mut variables = Vec::with_capacity(model.variables.len());
        for (i, variable) in (0..).zip(&model.variables) {
            let mut read = |text: &'a str| {
                let unit = cache.entry(text).or_insert_with(|| Unit::parse(text)).clone();
                unit.map_err(|error| unreadable.push((VarId(i), error))).ok()
            };
            let unit = variable.unit.as_deref().filter(|text| !text.is_empty()).map(&mut read);
            variable.display_unit.as_deref().filter(|text| !text.is_empty()).map(&mut read);
            variables.push(match unit {
                Some(Some(unit)) => Measure::Known(Quantity::of(&unit)),
                // An unreadable unit is not inferred either.
                Some(None) => Measure::Wild,
                None => undeclared(model, variable),
            });
        }
        let nodes = vec![Measure::Unknown; model.exprs.len()];
        let found_in = FxHashMap::default();
        let (order, starts) = orders(&model.exprs, relations);
        let units = Units { model, variables, found_in, nodes, order, starts, fresh: Vec::new() };
        (units, unreadable)
    }

    /// Finds the units of undeclared variables, until nothing more follows.
    pub fn infer(&mut self, relations: &[Relation]) {
        if !self.variables.iter().any(|measure| matches!(measure, Measure::Unknown)) {
            return;
        }
        let uses = self.uses(relations);
        let mut visits = vec![0u8; relations.len()];
        let mut waiting = vec![true; relations.len()];
        let mut queue: VecDeque<u32> = (0..).take(relations.len()).collect();
        while let Some(next) = queue.pop_front() {
            let i = next as usize;
            waiting[i] = false;
            visits[i] += 1;
            self.work_through(i, &relations[i]);
            for v in std::mem::take(&mut self.fresh) {
                self.found_in.insert(v, next);
                for &user in uses.of(v) {
                    let user_index = user as usize;
                    if !waiting[user_index] && visits[user_index] < MOST_VISITS {
                        waiting[user_index] = true;
                        queue.push_back(user);
                    }
                }
            }
        }
    }

    /// In which relations each undeclared variable occurs.
    fn uses(&self, relations: &[Relation]) -> Uses {
        let mut pairs: Vec<(VarId, u32)> = Vec::new();
        let unknown = |v: VarId| matches!(self.variables[v.index()], Measure::Unknown);
        for (i, relation) in (0..).zip(relations) {
            for &e in &self.order[self.nodes_of(i as usize)] {
                if let Node::Var(v) | Node::Der(v) | Node::Pre(v) = self.model.exprs.node(e)
                    && unknown(v)
                {
                    pairs.push((v, i));
                }
            }
            if let Some(Side::Var(v)) = relation.lhs
                && unknown(v)
            {
                pairs.push((v, i));
            }
        }
        pairs.sort_unstable();
        Uses { pairs }
    }

    /// Where the nodes of a relation are in `order`.
    fn nodes_of(&self, relation: usize) -> std::ops::Range<usize> {
        self.starts[relation]..self.starts[relation + 1]
    }

    fn work_through(&mut self, number: usize, relation: &Relation) {
        self.evaluate(number, |_, _| {});
        let (left, right) = (self.side(relation.lhs), self.nodes[relation.rhs.index()]);
        if let Some(quantity) = right.known() {
            match relation.lhs {
                Some(Side::Expr(e)) => self.expect(e, quantity),
                Some(Side::Var(v)) => self.assign(v, Measure::Known(quantity)),
                None => {}
            }
        }
        if let Some(quantity) = left.known() {
            self.expect(relation.rhs, quantity);
        }
        for i in self.nodes_of(number).rev() {
            self.push_down(self.order[i]);
        }
    }

    /// Bottom-up through a relation, by its number: the unit of each node, after `look` has seen the node with those of
    /// its arguments.
    pub fn evaluate(&mut self, relation: usize, mut look: impl FnMut(&Self, ExprId)) {
        for i in self.nodes_of(relation) {
            let e = self.order[i];
            look(self, e);
            self.nodes[e.index()] = self.combine(e);
        }
    }

    /// The unit of a node that was just worked through.
    pub fn of(&self, e: ExprId) -> Measure {
        self.nodes[e.index()]
    }

    /// The unit of a side that was just worked through.
    pub fn side(&self, side: Option<Side>) -> Measure {
        match side {
            Some(Side::Expr(e)) => self.of(e),
            Some(Side::Var(v)) => self.variables[v.index()],
            None => Measure::Unknown,
        }
    }

    fn combine(&self, e: ExprId) -> Measure {
        match self.model.exprs.node(e) {
            Node::Num(bits) => Measure::of_number(f64::from_bits(bits)),
            // `sin(time)` and `x = time` are common and harmless.
            Node::Time => Measure::Unknown,
            Node::Var(v) | Node::Pre(v) => self.variables[v.index()],
            Node::Der(v) => self.variables[v.index()].over(Measure::Known(Quantity::SECOND)),
            Node::Unary(op, a) => unary(op, self.of(a)),
            Node::EventFloor(a) | Node::Delay(a, _) => self.of(a),
            Node::Binary(op, a, b) => self.binary(op, a, b),
            Node::Rel(..) | Node::EventRel(..) | Node::Sample(..) | Node::Initial | Node::Terminal => Measure::Number,
            Node::If(_, a, b) | Node::Homotopy(a, b) => self.of(a).join(self.of(b)),
            Node::Call(..) => Measure::Unknown,
        }
    }

    fn binary(&self, op: Binary, a: ExprId, b: ExprId) -> Measure {
        let (left, right) = (self.of(a), self.of(b));
        match op {
            Binary::Add => left.sum(right, 1.0),
            Binary::Sub => left.sum(right, -1.0),
            Binary::Mul => left.times(right),
            Binary::Div => left.over(right),
            Binary::Min | Binary::Max => left.join(right),
            Binary::Pow => match (self.model.exprs.as_num(b), left) {
                (Some(exponent), _) => left.power(exponent),
                (None, Measure::Known(base)) if base.difference(Quantity::NUMBER).is_none() => Measure::Number,
                (None, Measure::Number) => Measure::Number,
                _ => Measure::Unknown,
            },
            Binary::Atan2 | Binary::And | Binary::Or => Measure::Number,
        }
    }

    /// A node without a unit of its own gets the one that its place asks for.
    fn expect(&mut self, e: ExprId, quantity: Quantity) {
        if matches!(self.nodes[e.index()], Measure::Unknown) {
            self.nodes[e.index()] = Measure::Known(quantity);
        }
    }

    fn expect_measure(&mut self, e: ExprId, measure: Measure) {
        if let Measure::Known(quantity) = measure {
            self.expect(e, quantity);
        }
    }

    fn assign(&mut self, v: VarId, measure: Measure) {
        if matches!((self.variables[v.index()], measure), (Measure::Unknown, Measure::Known(_))) {
            self.variables[v.index()] = measure;
            self.fresh.push(v);
        }
    }

    /// Top-down: what a node's unit says about its arguments.
    fn push_down(&mut self, e: ExprId) {
        let node = self.model.exprs.node(e);
        if let Node::Rel(_, a, b) | Node::EventRel(_, a, b) = node {
            return self.equalize(a, b);
        }
        let Measure::Known(quantity) = self.of(e) else { return };
        match node {
            Node::Var(v) | Node::Pre(v) => self.assign(v, Measure::Known(quantity)),
            Node::Der(v) => self.assign(v, quantity.times(Quantity::SECOND)),
            Node::Unary(Unary::Neg | Unary::Abs | Unary::Floor, a) | Node::EventFloor(a) => self.expect(a, quantity),
            Node::Unary(Unary::Sqrt, a) => self.expect_measure(a, quantity.power(2.0)),
            Node::If(_, a, b) | Node::Homotopy(a, b) | Node::Binary(Binary::Min | Binary::Max, a, b) => {
                self.expect(a, quantity);
                self.expect(b, quantity);
            }
            Node::Binary(Binary::Add | Binary::Sub, a, b) => {
                // With a number or a zero point in the sum, that of the other term is not known.
                let term =
                    if quantity.offset == 0.0 && self.is_plain_sum(a, b) { quantity } else { quantity.shifted() };
                self.expect(a, term);
                self.expect(b, term);
            }
            Node::Binary(Binary::Mul, a, b) => {
                self.expect_measure(a, Measure::Known(quantity).over(self.of(b)));
                self.expect_measure(b, Measure::Known(quantity).over(self.of(a)));
            }
            Node::Binary(Binary::Div, a, b) => {
                self.expect_measure(a, Measure::Known(quantity).times(self.of(b)));
                self.expect_measure(b, self.of(a).over(Measure::Known(quantity)));
            }
            Node::Binary(Binary::Pow, a, b) => {
                if let Some(exponent) = self.model.exprs.as_num(b).filter(|&x| x != 0.0) {
                    self.expect_measure(a, quantity.power(1.0 / exponent));
                }
            }
            _ => {}
        }
    }

    fn equalize(&mut self, a: ExprId, b: ExprId) {
        let (left, right) = (self.of(a), self.of(b));
        self.expect_measure(a, right);
        self.expect_measure(b, left);
    }

    fn is_plain_sum(&self, a: ExprId, b: ExprId) -> bool {
        !matches!(self.of(a), Measure::Wild) && !matches!(self.of(b), Measure::Wild)
    }
}

/// Variables that declare no unit: whole numbers and truth values count, a parameter that is just a number may stand for
/// anything, the rest is to be found.
fn undeclared(model: &FlatModel, variable: &Variable) -> Measure {
    let is_number = |e: Option<ExprId>| e.is_none_or(|e| model.exprs.as_num(e).is_some());
    if variable.ty != Type::Real {
        Measure::Number
    } else if variable.variability <= Variability::Parameter && is_number(variable.binding) {
        variable.binding.and_then(|e| model.exprs.as_num(e)).map_or(Measure::Wild, parameter)
    } else {
        Measure::Unknown
    }
}

/// A constant of pi stays one; any other parameter may be set to something else.
fn parameter(value: f64) -> Measure {
    match Measure::of_number(value) {
        Measure::Circle => Measure::Circle,
        _ => Measure::Wild,
    }
}

fn unary(op: Unary, a: Measure) -> Measure {
    match op {
        Unary::Neg | Unary::Abs | Unary::Floor => a,
        Unary::Sqrt => a.power(0.5),
        _ => Measure::Number,
    }
}

/// The nodes of each relation in an order of evaluation, and where those of each begin.
fn orders(pool: &Exprs, relations: &[Relation]) -> (Vec<ExprId>, Vec<usize>) {
    let mut walk = Walk::default();
    let (mut order, mut starts) = (Vec::new(), vec![0]);
    for relation in relations {
        let left = match relation.lhs {
            Some(Side::Expr(e)) => e,
            _ => relation.rhs,
        };
        walk.each(pool, &[left, relation.rhs], |e, _| {
            order.push(e);
            true
        });
        let start = starts[starts.len() - 1];
        order[start..].sort_unstable();
        starts.push(order.len());
    }
    (order, starts)
}

/// Sorted pairs of variable and relation.
struct Uses {
    pairs: Vec<(VarId, u32)>,
}

impl Uses {
    fn of(&self, v: VarId) -> impl Iterator<Item = &u32> {
        let from = self.pairs.partition_point(|pair| pair.0 < v);
        self.pairs[from..].iter().take_while(move |pair| pair.0 == v).map(|pair| &pair.1)
    }
}

/// Whether an argument of this function must be a plain number. Of a logarithm it need not: `log(x) + C` is `log(x/c)`,
/// and empirical laws are written so.
pub(super) fn takes_numbers(op: Unary) -> bool {
    use Unary::{Acos, Asin, Atan, Cos, Cosh, Exp, Sin, Sinh, Tan, Tanh};
    matches!(op, Sin | Cos | Tan | Asin | Acos | Atan | Sinh | Cosh | Tanh | Exp)
}

/// The name under which messages print a variable.
pub(super) fn name(model: &FlatModel) -> impl Fn(VarId) -> String {
    |v| model.variables[v.index()].name.clone()
}

/// The expression in one short line.
pub(super) fn text(model: &FlatModel, e: ExprId) -> String {
    let pool: &Exprs = &model.exprs;
    pool.print_short(e, &name(model), 80)
}
