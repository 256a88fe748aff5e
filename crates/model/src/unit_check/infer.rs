//! Units of all variables: the declared ones, and those that follow from the equations.
//!
//! Enters: a [`FlatModel`]. Leaves: the relations in which units must fit, and what is known about the unit of each
//! variable. The parent module calls [`relations`], [`UnitInference::declared`], [`UnitInference::infer`] and
//! [`UnitInference::evaluate`], in this order.
//!
//! Each relation is evaluated bottom-up, from variables to the whole, and then worked through top-down, from the whole
//! to undeclared variables. When that finds the unit of a variable, the relations that contain it are worked through
//! again. Each relation is visited at most [`MOST_VISITS`] times, so the work is linear in the size of the model.

use super::measure::{PartialUnit, UnitKnowledge};
use crate::flat::{FlatModel, FlatVariable, ScalarType, Variability, WhenAction};
use bramah_expr::units::{MeasurementUnit, UnitError};
use bramah_expr::visit::NodeTraversal;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use bramah_syntax::diag::Span;
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// The most visits of one relation.
const MOST_VISITS: u8 = 8;

/// The left side of a relation.
#[derive(Clone, Copy, Debug)]
pub(super) enum RelationSide {
    /// An expression.
    Expr(ExprId),
    /// A variable whose attribute or assignment the relation is about.
    Var(VarId),
}

/// Two sides that must have the same unit, or one expression whose parts must fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnitRelation {
    /// The left side; `None` for a lone expression, such as the condition of an assertion.
    pub lhs: Option<RelationSide>,
    /// The right side, or the lone expression.
    pub rhs: ExprId,
    /// Its place in the text.
    pub span: Span,
    /// The instance that contains it.
    pub instance: u32,
}

/// All places of a model where units must fit: equations, attributes, assignments in `when`, assertions, in this order.
///
/// Attributes are binding, `start`, `min`, `max` and `nominal`. The value of a `reinit` counts as an assignment.
pub(super) fn relations(model: &FlatModel) -> Vec<UnitRelation> {
    let mut found = Vec::with_capacity(model.equations.len() + model.variables.len());
    for equation in model.equations.iter().chain(&model.initial_equations) {
        let (span, instance) = (equation.origin.span, equation.origin.instance);
        found.push(UnitRelation { lhs: Some(RelationSide::Expr(equation.lhs)), rhs: equation.rhs, span, instance });
    }
    for (i, variable) in (0..).zip(&model.variables) {
        let (span, instance) = (variable.origin.span, variable.origin.instance);
        let values = [variable.binding, variable.start, variable.min, variable.max, variable.nominal];
        // A plain number is in the unit of its variable.
        for rhs in values.into_iter().flatten().filter(|&e| model.exprs.as_num(e).is_none()) {
            found.push(UnitRelation { lhs: Some(RelationSide::Var(VarId(i))), rhs, span, instance });
        }
    }
    for branch in model.whens.iter().flat_map(|when| &when.branches) {
        for action in &branch.actions {
            if let WhenAction::Assign { variable, value, origin } | WhenAction::Reinit { variable, value, origin, .. } =
                action
            {
                let (span, instance) = (origin.span, origin.instance);
                found.push(UnitRelation { lhs: Some(RelationSide::Var(*variable)), rhs: *value, span, instance });
            }
        }
    }
    for assert in &model.asserts {
        let (span, instance) = (assert.origin.span, assert.origin.instance);
        found.push(UnitRelation { lhs: None, rhs: assert.condition, span, instance });
    }
    found
}

/// What is known about the units of a model.
pub(super) struct UnitInference<'a> {
    /// The model.
    pub model: &'a FlatModel,
    /// By variable: its unit.
    pub variables: Vec<UnitKnowledge>,
    /// By undeclared variable whose unit was found: the relation that gave it.
    pub found_in: FxHashMap<VarId, u32>,
    /// By node: its unit as of the last relation that contained it and was evaluated.
    nodes: Vec<UnitKnowledge>,
    /// The nodes of all relations, one relation after the other, each in an order of evaluation.
    order: Vec<ExprId>,
    /// By relation: where its nodes begin in `order`, and one more entry for the end.
    starts: Vec<usize>,
    /// Variables whose unit the relation being worked through has given.
    fresh: Vec<VarId>,
}

/// A unit string that cannot be read: a variable that has it, and the error.
pub(super) type UnreadableUnit = (VarId, UnitError);

impl<'a> UnitInference<'a> {
    /// Starts from the declared units. Those that cannot be read are returned and count as unknown.
    pub fn declared(model: &'a FlatModel, relations: &[UnitRelation]) -> (Self, Vec<UnreadableUnit>) {
        let mut cache: FxHashMap<&str, Result<MeasurementUnit, UnitError>> = FxHashMap::default();
        let mut unreadable = Vec::new();
        let mut variables = Vec::with_capacity(model.variables.len());
        for (i, variable) in (0..).zip(&model.variables) {
            // Models have few different units, so each string is parsed once.
            let mut read = |text: &'a str| {
                let unit = cache.entry(text).or_insert_with(|| MeasurementUnit::parse(text)).clone();
                unit.map_err(|error| unreadable.push((VarId(i), error))).ok()
            };
            let unit = variable.unit.as_deref().filter(|text| !text.is_empty()).map(&mut read);
            variable.display_unit.as_deref().filter(|text| !text.is_empty()).map(&mut read);
            variables.push(match unit {
                Some(Some(unit)) => UnitKnowledge::Known(PartialUnit::of(&unit)),
                // An unreadable unit is not inferred either.
                Some(None) => UnitKnowledge::Wild,
                None => undeclared(model, variable),
            });
        }
        let nodes = vec![UnitKnowledge::Unknown; model.exprs.len()];
        let found_in = FxHashMap::default();
        let (order, starts) = orders(&model.exprs, relations);
        let units = UnitInference { model, variables, found_in, nodes, order, starts, fresh: Vec::new() };
        (units, unreadable)
    }

    /// Finds the units of undeclared variables, until nothing more follows.
    ///
    /// It is a work list: a relation enters it again when the unit of one of its variables was found. It does nothing
    /// if all variables declare units.
    pub fn infer(&mut self, relations: &[UnitRelation]) {
        if !self.variables.iter().any(|measure| matches!(measure, UnitKnowledge::Unknown)) {
            return;
        }
        let uses = self.uses(relations);
        let mut visits = vec![0u8; relations.len()];
        // A relation is in the queue once at most.
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

    /// The relations in which each undeclared variable occurs.
    fn uses(&self, relations: &[UnitRelation]) -> RelationUses {
        let mut pairs: Vec<(VarId, u32)> = Vec::new();
        let unknown = |v: VarId| matches!(self.variables[v.index()], UnitKnowledge::Unknown);
        for (i, relation) in (0..).zip(relations) {
            for &e in &self.order[self.nodes_of(i as usize)] {
                if let ExprNode::Var(v) | ExprNode::Der(v) | ExprNode::Pre(v) = self.model.exprs.node(e)
                    && unknown(v)
                {
                    pairs.push((v, i));
                }
            }
            if let Some(RelationSide::Var(v)) = relation.lhs
                && unknown(v)
            {
                pairs.push((v, i));
            }
        }
        pairs.sort_unstable();
        RelationUses { pairs }
    }

    /// The positions of the nodes of a relation in `order`.
    fn nodes_of(&self, relation: usize) -> std::ops::Range<usize> {
        self.starts[relation]..self.starts[relation + 1]
    }

    /// Works through a relation: bottom-up, then across its sides, then top-down.
    ///
    /// The known unit of one side is expected of the other side; the first side may be a variable that gets its unit
    /// so.
    fn work_through(&mut self, number: usize, relation: &UnitRelation) {
        self.evaluate(number, |_, _| {});
        let (left, right) = (self.side(relation.lhs), self.nodes[relation.rhs.index()]);
        if let Some(quantity) = right.known() {
            match relation.lhs {
                Some(RelationSide::Expr(e)) => self.expect(e, quantity),
                Some(RelationSide::Var(v)) => self.assign(v, UnitKnowledge::Known(quantity)),
                None => {}
            }
        }
        if let Some(quantity) = left.known() {
            self.expect(relation.rhs, quantity);
        }
        // Reversed order of evaluation: a node comes before its arguments.
        for i in self.nodes_of(number).rev() {
            self.push_down(self.order[i]);
        }
    }

    /// Evaluates the nodes of a relation bottom-up. `look` sees each node when its arguments have their units, before
    /// its own unit is set.
    /// Nodes shared with other relations keep no unit from them: each evaluation starts from the variables.
    pub fn evaluate(&mut self, relation: usize, mut look: impl FnMut(&Self, ExprId)) {
        for i in self.nodes_of(relation) {
            let e = self.order[i];
            look(self, e);
            self.nodes[e.index()] = self.combine(e);
        }
    }

    /// The unit of a node of the relation that was evaluated last.
    pub fn of(&self, e: ExprId) -> UnitKnowledge {
        self.nodes[e.index()]
    }

    /// The unit of a side of the relation that was evaluated last.
    pub fn side(&self, side: Option<RelationSide>) -> UnitKnowledge {
        match side {
            Some(RelationSide::Expr(e)) => self.of(e),
            Some(RelationSide::Var(v)) => self.variables[v.index()],
            None => UnitKnowledge::Unknown,
        }
    }

    /// The unit of a node from those of its arguments.
    /// Calls have an unknown unit, since functions are not looked into.
    fn combine(&self, e: ExprId) -> UnitKnowledge {
        match self.model.exprs.node(e) {
            ExprNode::Num(bits) => UnitKnowledge::of_number(f64::from_bits(bits)),
            // `sin(time)` and `x = time` are common and harmless.
            ExprNode::Time => UnitKnowledge::Unknown,
            ExprNode::Var(v) | ExprNode::Pre(v) => self.variables[v.index()],
            ExprNode::Der(v) => self.variables[v.index()].over(UnitKnowledge::Known(PartialUnit::SECOND)),
            ExprNode::Unary(op, a) => unary(op, self.of(a)),
            ExprNode::EventFloor(a) | ExprNode::Delay(a, _) => self.of(a),
            ExprNode::Binary(op, a, b) => self.binary(op, a, b),
            ExprNode::Rel(..)
            | ExprNode::EventRel(..)
            | ExprNode::Sample(..)
            | ExprNode::Initial
            | ExprNode::Terminal => UnitKnowledge::Number,
            ExprNode::If(_, a, b) | ExprNode::Homotopy(a, b) => self.of(a).join(self.of(b)),
            ExprNode::Call(..) => UnitKnowledge::Unknown,
        }
    }

    /// The unit of a binary operation.
    fn binary(&self, op: BinaryFunction, a: ExprId, b: ExprId) -> UnitKnowledge {
        let (left, right) = (self.of(a), self.of(b));
        match op {
            BinaryFunction::Add => left.sum(right, 1.0),
            BinaryFunction::Sub => left.sum(right, -1.0),
            BinaryFunction::Mul => left.times(right),
            BinaryFunction::Div => left.over(right),
            BinaryFunction::Min | BinaryFunction::Max => left.join(right),
            BinaryFunction::Pow => match (self.model.exprs.as_num(b), left) {
                (Some(exponent), _) => left.power(exponent),
                // A number to a power that varies is a number; of other units nothing is known then.
                (None, UnitKnowledge::Known(base)) if base.difference(PartialUnit::NUMBER).is_none() => {
                    UnitKnowledge::Number
                }
                (None, UnitKnowledge::Number) => UnitKnowledge::Number,
                _ => UnitKnowledge::Unknown,
            },
            BinaryFunction::Atan2 | BinaryFunction::And | BinaryFunction::Or => UnitKnowledge::Number,
        }
    }

    /// Gives a node without a known unit the one that its place asks for.
    /// A number that fits anywhere keeps its kind.
    fn expect(&mut self, e: ExprId, quantity: PartialUnit) {
        if matches!(self.nodes[e.index()], UnitKnowledge::Unknown) {
            self.nodes[e.index()] = UnitKnowledge::Known(quantity);
        }
    }

    /// [`Self::expect`] where the unit is known; else nothing.
    fn expect_measure(&mut self, e: ExprId, measure: UnitKnowledge) {
        if let UnitKnowledge::Known(quantity) = measure {
            self.expect(e, quantity);
        }
    }

    /// Gives a variable without a known unit the one that was found, and records it in `fresh`.
    /// A unit that is known is never replaced.
    fn assign(&mut self, v: VarId, measure: UnitKnowledge) {
        if matches!((self.variables[v.index()], measure), (UnitKnowledge::Unknown, UnitKnowledge::Known(_))) {
            self.variables[v.index()] = measure;
            self.fresh.push(v);
        }
    }

    /// Passes the unit of a node down to its arguments, where the operation determines theirs.
    ///
    /// Of a product the unit of one factor follows from the other one, of a power that of the base from a constant
    /// exponent. Both sides of a comparison have the same unit.
    fn push_down(&mut self, e: ExprId) {
        let node = self.model.exprs.node(e);
        if let ExprNode::Rel(_, a, b) | ExprNode::EventRel(_, a, b) = node {
            return self.equalize(a, b);
        }
        let UnitKnowledge::Known(quantity) = self.of(e) else { return };
        match node {
            ExprNode::Var(v) | ExprNode::Pre(v) => self.assign(v, UnitKnowledge::Known(quantity)),
            ExprNode::Der(v) => self.assign(v, quantity.times(PartialUnit::SECOND)),
            ExprNode::Unary(UnaryFunction::Neg | UnaryFunction::Abs | UnaryFunction::Floor, a)
            | ExprNode::EventFloor(a) => self.expect(a, quantity),
            ExprNode::Unary(UnaryFunction::Sqrt, a) => self.expect_measure(a, quantity.power(2.0)),
            ExprNode::If(_, a, b)
            | ExprNode::Homotopy(a, b)
            | ExprNode::Binary(BinaryFunction::Min | BinaryFunction::Max, a, b) => {
                self.expect(a, quantity);
                self.expect(b, quantity);
            }
            ExprNode::Binary(BinaryFunction::Add | BinaryFunction::Sub, a, b) => {
                // With a number or a zero point in the sum, that of the other term is not known.
                let term =
                    if quantity.offset == 0.0 && self.is_plain_sum(a, b) { quantity } else { quantity.shifted() };
                self.expect(a, term);
                self.expect(b, term);
            }
            ExprNode::Binary(BinaryFunction::Mul, a, b) => {
                self.expect_measure(a, UnitKnowledge::Known(quantity).over(self.of(b)));
                self.expect_measure(b, UnitKnowledge::Known(quantity).over(self.of(a)));
            }
            ExprNode::Binary(BinaryFunction::Div, a, b) => {
                self.expect_measure(a, UnitKnowledge::Known(quantity).times(self.of(b)));
                self.expect_measure(b, self.of(a).over(UnitKnowledge::Known(quantity)));
            }
            ExprNode::Binary(BinaryFunction::Pow, a, b) => {
                if let Some(exponent) = self.model.exprs.as_num(b).filter(|&x| x != 0.0) {
                    self.expect_measure(a, quantity.power(1.0 / exponent));
                }
            }
            _ => {}
        }
    }

    /// Passes the unit of either node to the other.
    fn equalize(&mut self, a: ExprId, b: ExprId) {
        let (left, right) = (self.of(a), self.of(b));
        self.expect_measure(a, right);
        self.expect_measure(b, left);
    }

    /// Whether neither term of a sum is a number that may be any quantity.
    fn is_plain_sum(&self, a: ExprId, b: ExprId) -> bool {
        !matches!(self.of(a), UnitKnowledge::Wild) && !matches!(self.of(b), UnitKnowledge::Wild)
    }
}

/// What is known about a variable that declares no unit. Integers, Booleans and enumerations are numbers. A parameter
/// with a plain number as its value may stand for anything. The units of all others are to be found.
/// A variable without a unit is not a number: its unit is inferred.
fn undeclared(model: &FlatModel, variable: &FlatVariable) -> UnitKnowledge {
    let is_number = |e: Option<ExprId>| e.is_none_or(|e| model.exprs.as_num(e).is_some());
    if variable.ty != ScalarType::Real {
        UnitKnowledge::Number
    } else if variable.variability <= Variability::Parameter && is_number(variable.binding) {
        variable.binding.and_then(|e| model.exprs.as_num(e)).map_or(UnitKnowledge::Wild, parameter)
    } else {
        UnitKnowledge::Unknown
    }
}

/// What is known about a parameter with this value: a multiple of pi may convert angles; any other value may stand for
/// anything.
fn parameter(value: f64) -> UnitKnowledge {
    match UnitKnowledge::of_number(value) {
        UnitKnowledge::Circle => UnitKnowledge::Circle,
        _ => UnitKnowledge::Wild,
    }
}

/// The unit of a function of one argument.
fn unary(op: UnaryFunction, a: UnitKnowledge) -> UnitKnowledge {
    match op {
        UnaryFunction::Neg | UnaryFunction::Abs | UnaryFunction::Floor => a,
        UnaryFunction::Sqrt => a.power(0.5),
        _ => UnitKnowledge::Number,
    }
}

/// The nodes of each relation in an order of evaluation, and where those of each begin.
fn orders(pool: &Exprs, relations: &[UnitRelation]) -> (Vec<ExprId>, Vec<usize>) {
    let mut walk = NodeTraversal::default();
    let (mut order, mut starts) = (Vec::new(), vec![0]);
    for relation in relations {
        let left = match relation.lhs {
            Some(RelationSide::Expr(e)) => e,
            _ => relation.rhs,
        };
        walk.each(pool, &[left, relation.rhs], |e, _| {
            order.push(e);
            true
        });
        let start = starts[starts.len() - 1];
        // Arguments have smaller ids than their node.
        order[start..].sort_unstable();
        starts.push(order.len());
    }
    (order, starts)
}

/// Which relations contain which variables: pairs in ascending order.
struct RelationUses {
    /// A variable and a relation that contains it. Pairs may be repeated.
    pairs: Vec<(VarId, u32)>,
}

impl RelationUses {
    /// The relations that contain a variable. Binary search.
    fn of(&self, v: VarId) -> impl Iterator<Item = &u32> {
        let from = self.pairs.partition_point(|pair| pair.0 < v);
        self.pairs[from..].iter().take_while(move |pair| pair.0 == v).map(|pair| &pair.1)
    }
}

/// Whether the argument of a function must be a plain number. That of a logarithm need not be: `log(x) + C` is
/// `log(x/c)`, and empirical laws are written so.
pub(super) fn takes_numbers(op: UnaryFunction) -> bool {
    use UnaryFunction::{Acos, Asin, Atan, Cos, Cosh, Exp, Sin, Sinh, Tan, Tanh};
    matches!(op, Sin | Cos | Tan | Asin | Acos | Atan | Sinh | Cosh | Tanh | Exp)
}

/// The names of variables as messages print them.
pub(super) fn name(model: &FlatModel) -> impl Fn(VarId) -> String {
    |v| model.variables[v.index()].name.clone()
}

/// An expression in one short line, cut after 80 characters.
pub(super) fn text(model: &FlatModel, e: ExprId) -> String {
    let pool: &Exprs = &model.exprs;
    pool.print_short(e, &name(model), 80)
}
