//! Products that the value 0 of a parameter removes from the equations, where the structure depends on it.
//!
//! `L*der(i) = v` with `L = 0` leaves no state, `R*i = v1 - v2` with `R = 0` makes two voltages equal. As long as the
//! equations can be matched without such products, the parameter may have another value in the next run. Where they
//! cannot, it is fixed with the structure, and so is whatever it is computed from.
//!
//! `analysis` calls [`decisive`] at the end of a pass and [`take_out`] at the beginning of the next one.

use super::draft::{DaeDraft, SystemRole};
use super::dulmage_mendelsohn::decompose;
use super::incidence::{IncidenceMatrix, IncidenceScanner};
use super::matching::maximum;
use super::parameters::{self, SignAnalysis};
use super::sorting::{EquationSystem, SystemRow, UnknownColumns};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use rustc_hash::{FxHashMap, FxHashSet};

/// Replaces by 0 all products that a factor made 0 by these parameters removes, and fixes the parameters.
/// Nothing happens for an empty list.
pub(super) fn take_out(draft: &mut DaeDraft, known: &mut SignAnalysis, decisive: &[VarId]) {
    if decisive.is_empty() {
        return;
    }
    let zeros = ZeroAnalysis::find(draft, known);
    // A factor that another parameter makes 0 as well may not be removed.
    let mut by_these = |factor: ExprId| zeros.parameters(draft, known, factor).iter().all(|v| decisive.contains(v));
    let taken: Vec<ExprId> = zeros.products.iter().filter(|(_, f)| by_these(*f)).map(|(e, _)| *e).collect();
    let map = without_products(draft, &taken);
    draft.map_expressions(&map);
    parameters::fix(draft, decisive);
}

/// The parameters with value 0 without whose products one of the systems cannot be matched. Ascending.
///
/// `systems` are the running and the initial system. All products with a factor 0 are removed from both at once; where
/// a perfect matching remains, no parameter decides.
pub(super) fn decisive(draft: &mut DaeDraft, known: &mut SignAnalysis, systems: [&EquationSystem; 2]) -> Vec<VarId> {
    let zeros = ZeroAnalysis::find(draft, known);
    if zeros.products.is_empty() {
        return Vec::new();
    }
    let products: Vec<ExprId> = zeros.products.iter().map(|p| p.0).collect();
    let map = without_products(draft, &products);
    let mut found = Vec::new();
    for system in systems {
        let incidence = without(draft, system, &map);
        let matching = maximum(&incidence, system.columns.len());
        // Only products in the overdetermined part matter; elsewhere a matching exists without them.
        for row in decompose(&incidence, &matching).over.rows {
            let equation = &system.rows[row as usize].equation;
            for e in draft.exprs.reachable(&[equation.lhs, equation.rhs], |_| true) {
                if let Some(factor) = zeros.factor(e) {
                    found.extend(zeros.parameters(draft, known, factor));
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// By expression: its image with 0 in the place of these products.
/// Products are compared as nodes of the pool.
fn without_products(draft: &mut DaeDraft, products: &[ExprId]) -> Vec<ExprId> {
    let taken: FxHashSet<ExprNode> = products.iter().map(|e| draft.exprs.node(*e)).collect();
    draft.rewritten(|_, node| taken.contains(&node).then_some(Exprs::ZERO))
}

/// What is 0 by the values of parameters, and the products that such factors remove.
///
/// It is made anew for each question, since the pool has grown in between.
struct ZeroAnalysis {
    /// By expression: whether it is 0.
    zero: Vec<bool>,
    /// By variable: an expression that it equals and that is 0.
    definition: Vec<Option<ExprId>>,
    /// Products with the factor that is 0, in the order of the pool.
    products: Vec<(ExprId, ExprId)>,
}

impl ZeroAnalysis {
    /// Evaluates all expressions of the draft.
    /// First by ascending ids, which settles what follows from parameters alone; then through definitions of variables.
    /// `zero` has an entry for every node of the pool, live or not.
    fn find(draft: &DaeDraft, known: &mut SignAnalysis) -> Self {
        let (count, pool) = (draft.variables.len(), &draft.exprs);
        let mut found =
            ZeroAnalysis { zero: vec![false; pool.len()], definition: vec![None; count], products: Vec::new() };
        let mut open: Vec<ExprId> = Vec::new();
        for e in (0..pool.len() as u32).map(ExprId) {
            found.zero[e.index()] = found.is_zero(draft, known, e);
            open.extend(found.zero[e.index()].then_some(e));
        }
        found.spread(draft, known, open);
        for e in (0..draft.exprs.len() as u32).map(ExprId) {
            let ExprNode::Binary(BinaryFunction::Mul, a, b) = draft.exprs.node(e) else { continue };
            for (factor, other) in [(a, b), (b, a)] {
                // A literal does not change with a parameter, and a product of known value contains no unknown.
                let taken = found.zero[factor.index()] && draft.exprs.as_num(factor).is_none();
                if taken && !found.zero[other.index()] && known.value(&draft.exprs, other).is_none() {
                    found.products.push((e, factor));
                }
            }
        }
        found
    }

    /// Carries zeros from expressions to the variables that equal them, and on to the expressions that contain these.
    /// A work list of expressions that are newly known to be 0. Each expression enters it once.
    fn spread(&mut self, draft: &DaeDraft, known: &mut SignAnalysis, mut open: Vec<ExprId>) {
        let mut defined: FxHashMap<ExprId, Vec<VarId>> = FxHashMap::default();
        for equation in &draft.equations {
            if let Some(v) = defined_by(draft, equation.lhs) {
                defined.entry(equation.rhs).or_default().push(v);
            }
        }
        if !defined.keys().any(|value| self.zero[value.index()]) {
            return;
        }
        // Made only where some equation defines a variable to be 0.
        let users = ExpressionUsers::new(draft);
        while let Some(e) = open.pop() {
            for v in defined.remove(&e).unwrap_or_default() {
                self.definition[v.index()].get_or_insert(e);
                if let Some(leaf) = users.leaf[v.index()]
                    && !std::mem::replace(&mut self.zero[leaf.index()], true)
                {
                    open.push(leaf);
                }
            }
            for user in users.of(e) {
                if !self.zero[user.index()] && self.is_zero(draft, known, user) {
                    self.zero[user.index()] = true;
                    open.push(user);
                }
            }
        }
    }

    /// Whether an expression is 0, from what is known about its arguments.
    ///
    /// A sum is 0 if both terms are. A quotient is 0 if its numerator is. An unknown `if` is 0 if both branches are.
    /// A product is 0 if one of its factors is, which is what this analysis looks for.
    fn is_zero(&self, draft: &DaeDraft, known: &mut SignAnalysis, e: ExprId) -> bool {
        if let Some(value) = known.value(&draft.exprs, e) {
            return value == 0.0;
        }
        let zero = |a: ExprId| self.zero[a.index()];
        match draft.exprs.node(e) {
            ExprNode::Var(v) => self.definition[v.index()].is_some(),
            ExprNode::Unary(op, a) => KEEP_ZERO.contains(&op) && zero(a),
            ExprNode::Binary(BinaryFunction::Mul, a, b) => zero(a) || zero(b),
            ExprNode::Binary(BinaryFunction::Div, a, _) => zero(a),
            ExprNode::Binary(
                BinaryFunction::Add | BinaryFunction::Sub | BinaryFunction::Min | BinaryFunction::Max,
                a,
                b,
            ) => zero(a) && zero(b),
            ExprNode::If(condition, a, b) => match known.value(&draft.exprs, condition) {
                Some(value) => zero(if value == 0.0 { b } else { a }),
                None => zero(a) && zero(b),
            },
            _ => false,
        }
    }

    /// The parameters that make an expression 0. Of a product only the factor that is 0 counts, of an `if` with a known
    /// condition the condition and the chosen branch.
    /// The walk follows definitions of variables and visits each expression once.
    fn parameters(&self, draft: &DaeDraft, known: &mut SignAnalysis, e: ExprId) -> Vec<VarId> {
        let (mut open, mut seen, mut found) = (vec![e], FxHashSet::default(), Vec::new());
        while let Some(e) = open.pop() {
            if !seen.insert(e) {
                continue;
            }
            match draft.exprs.node(e) {
                ExprNode::Var(v) if draft.role(v) == SystemRole::Parameter => found.push(v),
                ExprNode::Var(v) => open.extend(self.definition[v.index()]),
                ExprNode::Binary(BinaryFunction::Mul, a, _) if self.zero[a.index()] => open.push(a),
                ExprNode::Binary(BinaryFunction::Mul, _, b) if self.zero[b.index()] => open.push(b),
                ExprNode::Binary(BinaryFunction::Div, a, _) if self.zero[a.index()] => open.push(a),
                ExprNode::If(condition, a, b) => match known.value(&draft.exprs, condition) {
                    Some(value) => open.extend([condition, if value == 0.0 { b } else { a }]),
                    None => open.extend([a, b]),
                },
                _ => open.extend_from_slice(draft.exprs.operands(e).as_slice()),
            }
        }
        found
    }

    /// The factor that is 0 of a product in `products`; `None` for other expressions. Binary search.
    /// The list is sorted, because the pool is scanned in order.
    fn factor(&self, product: ExprId) -> Option<ExprId> {
        self.products.binary_search_by_key(&product, |p| p.0).ok().map(|i| self.products[i].1)
    }
}

/// The inverse of operands: the expressions that contain each expression as an operand.
/// It is stored as a compressed list, as in the incidence matrix.
struct ExpressionUsers {
    /// By expression: where its users begin in `users`, and one more entry for the end.
    starts: Vec<u32>,
    /// The users of all expressions, one after the other.
    users: Vec<ExprId>,
    /// By variable: its node in the pool, if there is one.
    leaf: Vec<Option<ExprId>>,
}

impl ExpressionUsers {
    /// Collects the users of all nodes of the pool, by counting sort.
    fn new(draft: &DaeDraft) -> Self {
        let pool = &draft.exprs;
        let all = || (0..pool.len() as u32).map(ExprId);
        let mut starts = vec![0_u32; pool.len() + 1];
        let mut leaf = vec![None; draft.variables.len()];
        for e in all() {
            pool.operands(e).as_slice().iter().for_each(|a| starts[a.index() + 1] += 1);
            if let ExprNode::Var(v) = pool.node(e)
                && let Some(place) = leaf.get_mut(v.index())
            {
                *place = Some(e);
            }
        }
        (0..pool.len()).for_each(|i| starts[i + 1] += starts[i]);
        let mut next = starts.clone();
        let mut users = vec![Exprs::ZERO; starts[pool.len()] as usize];
        for e in all() {
            for a in pool.operands(e).as_slice() {
                users[next[a.index()] as usize] = e;
                next[a.index()] += 1;
            }
        }
        ExpressionUsers { starts, users, leaf }
    }

    /// The expressions that contain an expression as an operand.
    fn of(&self, e: ExprId) -> impl Iterator<Item = ExprId> {
        self.users[self.starts[e.index()] as usize..self.starts[e.index() + 1] as usize].iter().copied()
    }
}

/// Functions whose value at 0 is 0.
/// Functions such as `exp` and `cos` are not among them.
const KEEP_ZERO: [UnaryFunction; 9] = [
    UnaryFunction::Neg,
    UnaryFunction::Abs,
    UnaryFunction::Sign,
    UnaryFunction::Sqrt,
    UnaryFunction::Sin,
    UnaryFunction::Tan,
    UnaryFunction::Atan,
    UnaryFunction::Sinh,
    UnaryFunction::Tanh,
];

/// The continuous variable that an equation with this left side defines; `None` for other left sides.
/// Only equations with the variable alone on the left side count.
fn defined_by(draft: &DaeDraft, lhs: ExprId) -> Option<VarId> {
    match draft.exprs.node(lhs) {
        ExprNode::Var(v) if draft.role(v) == SystemRole::Continuous => Some(v),
        _ => None,
    }
}

/// The solvable incidence of a system after its expressions have been replaced. An equation may be solved for what it
/// could be solved for before, if that still occurs.
/// Discrete rows keep their entries, because they are solved for the variable on one side.
fn without(draft: &DaeDraft, system: &EquationSystem, map: &[ExprId]) -> IncidenceMatrix {
    let image = |e: ExprId| map.get(e.index()).copied().unwrap_or(e);
    let columns = UnknownColumns::new(&system.columns, draft.variables.len());
    let (mut left, mut made) = (IncidenceMatrix::default(), IncidenceMatrix::default());
    let mut scanner = IncidenceScanner::default();
    for (row, SystemRow { equation, discrete, .. }) in system.rows.iter().enumerate() {
        let row = row as u32;
        let before = system.incidence.solvable(row);
        let sides = [image(equation.lhs), image(equation.rhs)];
        // An unchanged row keeps its entries; scanning it again would be wasted work.
        if *discrete || sides == [equation.lhs, equation.rhs] {
            made.push(before, &[]);
            continue;
        }
        scanner.push(&draft.exprs, sides, |node| columns.of_node(node), |_| true, &mut left);
        let still = left.solvable(left.rows() as u32 - 1);
        let kept: Vec<u32> = before.iter().filter(|c| still.contains(c)).copied().collect();
        made.push(&kept, &[]);
    }
    made
}
