//! Products that the value of a parameter takes out of the equations, where the structure depends on it.
//!
//! `L*der(i) = v` with `L = 0` leaves no state, `R*i = v1 - v2` with `R = 0` ties two voltages together. As long as the
//! equations can be matched without such products, the parameter may have another value in the next run; where they
//! cannot, it is fixed with the structure, and so is whatever it is computed from.

use super::Unknown;
use super::draft::{Draft, Role};
use super::dulmage_mendelsohn::decompose;
use super::incidence::{Incidence, NONE, Scanner};
use super::matching::maximum;
use super::parameters::{self, Known};
use super::sorting::{System, SystemRow};
use crate::expr::{Binary, ExprId, Exprs, Node, Unary, VarId};

/// Takes out all products whose factors are 0 by the values of these parameters.
pub(super) fn take_out(draft: &mut Draft, known: &mut Known, decisive: &[VarId]) {
    if decisive.is_empty() {
        return;
    }
    let zeros = Zeros::find(draft, known);
    let map = zeros.taken_out(draft, known, |used| used.iter().all(|v| decisive.contains(v)));
    draft.map_expressions(&map);
    parameters::fix(draft, decisive);
}

/// The parameters with value 0 without whose products the system cannot be matched.
pub(super) fn decisive(draft: &mut Draft, known: &mut Known, system: &System) -> Vec<VarId> {
    let zeros = Zeros::find(draft, known);
    if zeros.products.is_empty() {
        return Vec::new();
    }
    let map = zeros.taken_out(draft, known, |_| true);
    let incidence = without(draft, system, &map);
    let matching = maximum(&incidence, system.columns.len());
    let mut found = Vec::new();
    for row in decompose(&incidence, &matching).over.rows {
        let equation = &system.rows[row as usize].equation;
        for e in draft.exprs.reachable(&[equation.lhs, equation.rhs], |_| true) {
            if let Some(factor) = zeros.factor(e) {
                found.extend(zeros.parameters(draft, known, factor));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// What is 0 by the values of parameters, and the products that such factors take out.
struct Zeros {
    /// By expression.
    zero: Vec<bool>,
    /// By variable: the expression that it equals and that is 0.
    definition: Vec<Option<ExprId>>,
    /// Products with the factor that is 0, by their place in the pool.
    products: Vec<(ExprId, ExprId)>,
}

impl Zeros {
    fn find(draft: &Draft, known: &mut Known) -> Self {
        let count = draft.variables.len();
        let mut found = Zeros { zero: Vec::new(), definition: vec![None; count], products: Vec::new() };
        let defined: Vec<(VarId, ExprId)> =
            draft.equations.iter().filter_map(|e| defined(draft, e.lhs).map(|v| (v, e.rhs))).collect();
        loop {
            found.spread(draft, known);
            let mut grown = false;
            for &(v, value) in &defined {
                if found.zero[value.index()] && found.definition[v.index()].is_none() {
                    found.definition[v.index()] = Some(value);
                    grown = true;
                }
            }
            if !grown {
                break;
            }
        }
        for e in (0..draft.exprs.len() as u32).map(ExprId) {
            let Node::Binary(Binary::Mul, a, b) = draft.exprs.node(e) else { continue };
            for (factor, other) in [(a, b), (b, a)] {
                let taken = found.zero[factor.index()] && draft.exprs.as_num(factor).is_none();
                if taken && !found.zero[other.index()] && known.value(&draft.exprs, other).is_none() {
                    found.products.push((e, factor));
                }
            }
        }
        found
    }

    /// From what expressions are made of to the expressions.
    fn spread(&mut self, draft: &Draft, known: &mut Known) {
        self.zero.clear();
        for e in (0..draft.exprs.len() as u32).map(ExprId) {
            let zero = match known.value(&draft.exprs, e) {
                Some(value) => value == 0.0,
                None => self.is_zero(draft, known, draft.exprs.node(e)),
            };
            self.zero.push(zero);
        }
    }

    fn is_zero(&self, draft: &Draft, known: &mut Known, node: Node) -> bool {
        let zero = |a: ExprId| self.zero[a.index()];
        match node {
            Node::Var(v) => self.definition[v.index()].is_some(),
            Node::Unary(op, a) => KEEP_ZERO.contains(&op) && zero(a),
            Node::Binary(Binary::Mul, a, b) => zero(a) || zero(b),
            Node::Binary(Binary::Div, a, _) => zero(a),
            Node::Binary(Binary::Add | Binary::Sub | Binary::Min | Binary::Max, a, b) => zero(a) && zero(b),
            Node::If(condition, a, b) => match known.value(&draft.exprs, condition) {
                Some(value) => zero(if value == 0.0 { b } else { a }),
                None => zero(a) && zero(b),
            },
            _ => false,
        }
    }

    /// The parameters that make an expression 0.
    fn parameters(&self, draft: &Draft, known: &mut Known, e: ExprId) -> Vec<VarId> {
        let (mut open, mut seen, mut found) = (vec![e], rustc_hash::FxHashSet::default(), Vec::new());
        while let Some(e) = open.pop() {
            if !seen.insert(e) {
                continue;
            }
            match draft.exprs.node(e) {
                Node::Var(v) if draft.role(v) == Role::Parameter => found.push(v),
                Node::Var(v) => open.extend(self.definition[v.index()]),
                Node::Binary(Binary::Mul, a, _) if self.zero[a.index()] => open.push(a),
                Node::Binary(Binary::Mul, _, b) if self.zero[b.index()] => open.push(b),
                Node::Binary(Binary::Div, a, _) if self.zero[a.index()] => open.push(a),
                Node::If(condition, a, b) => match known.value(&draft.exprs, condition) {
                    Some(value) => open.extend([condition, if value == 0.0 { b } else { a }]),
                    None => open.extend([a, b]),
                },
                _ => open.extend_from_slice(draft.exprs.operands(e).as_slice()),
            }
        }
        found
    }

    fn factor(&self, product: ExprId) -> Option<ExprId> {
        self.products.binary_search_by_key(&product, |p| p.0).ok().map(|i| self.products[i].1)
    }

    /// The image of every expression without the products that are 0 by parameters that `which` accepts.
    fn taken_out(&self, draft: &mut Draft, known: &mut Known, which: impl Fn(&[VarId]) -> bool) -> Vec<ExprId> {
        let taken: rustc_hash::FxHashSet<Node> = self
            .products
            .iter()
            .filter(|(_, factor)| which(&self.parameters(draft, known, *factor)))
            .map(|(product, _)| draft.exprs.node(*product))
            .collect();
        draft.rewritten(|_, node| taken.contains(&node).then_some(Exprs::ZERO))
    }
}

/// Functions that are 0 at 0.
const KEEP_ZERO: [Unary; 9] =
    [Unary::Neg, Unary::Abs, Unary::Sign, Unary::Sqrt, Unary::Sin, Unary::Tan, Unary::Atan, Unary::Sinh, Unary::Tanh];

/// The continuous variable that an equation with this left side defines.
fn defined(draft: &Draft, lhs: ExprId) -> Option<VarId> {
    match draft.exprs.node(lhs) {
        Node::Var(v) if draft.role(v) == Role::Continuous => Some(v),
        _ => None,
    }
}

/// The incidence of a system after its expressions have been replaced; an equation may still be solved for what it could
/// be solved for before, if that still occurs.
fn without(draft: &Draft, system: &System, map: &[ExprId]) -> Incidence {
    let image = |e: ExprId| map.get(e.index()).copied().unwrap_or(e);
    let (mut of_var, mut of_der) = (vec![NONE; draft.variables.len()], vec![NONE; draft.variables.len()]);
    for (i, unknown) in system.columns.iter().enumerate() {
        match unknown {
            Unknown::Var(v) => of_var[v.index()] = i as u32,
            Unknown::Der(v) => of_der[v.index()] = i as u32,
        }
    }
    let column = |node: Node| match node {
        Node::Var(v) => Some(of_var[v.index()]).filter(|&c| c != NONE),
        Node::Der(v) => Some(of_der[v.index()]).filter(|&c| c != NONE),
        _ => None,
    };
    let (mut left, mut made) = (Incidence::default(), Incidence::default());
    let mut scanner = Scanner::default();
    for (row, SystemRow { equation, discrete, .. }) in system.rows.iter().enumerate() {
        let row = row as u32;
        let before = system.incidence.solvable(row);
        let sides = [image(equation.lhs), image(equation.rhs)];
        if *discrete || sides == [equation.lhs, equation.rhs] {
            made.push(before, &[]);
            continue;
        }
        scanner.push(&draft.exprs, sides, column, |_| true, &mut left);
        let still = left.solvable(left.rows() as u32 - 1);
        let kept: Vec<u32> = before.iter().filter(|c| still.contains(c)).copied().collect();
        made.push(&kept, &[]);
    }
    made
}
