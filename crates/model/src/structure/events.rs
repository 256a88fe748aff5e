//! Event generation: relations, `floor` and `sample` become discrete mode variables (MLS 8.5).
//!
//! Enters: the draft with nodes `EventRel`, `EventFloor` and `Sample`. Leaves: the draft without them, with a mode
//! variable in the place of each, an equation `mode = relation`, and a [`ZeroCrossing`] or [`SampleEvent`] that says
//! what to watch. A mode keeps its value between events, so the equations are smooth there. `analysis` calls
//! [`extract`] before `when` clauses are translated.

use super::draft::{DaeDraft, EquationRole, SystemRole, carried};
use super::{CrossingKind, SampleEvent, ZeroCrossing};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction, VarId};
use rustc_hash::FxHashMap;

/// When the value of an expression may change, ordered by how much has to be watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ExpressionVariability {
    /// Never, or at events only. A relation of such expressions needs no crossing.
    AtEvents,
    /// With time alone, and at events. The time of the event may be known in advance.
    WithTime,
    /// With any continuous quantity. The solver must find the crossing.
    Continuously,
}

/// Replaces event-generating nodes everywhere. In asserts, `when` bodies and initial equations a relation makes no
/// event of its own: it becomes the mode of the same relation elsewhere if there is one, and else is evaluated as it
/// stands.
///
/// Nodes that no expression contains any more are left as they are.
pub(super) fn extract(draft: &mut DaeDraft) {
    let origins = eventful_origins(draft);
    let mut extraction = CrossingExtraction { map: Vec::with_capacity(origins.len()), ..CrossingExtraction::default() };
    let live = draft.live_nodes();
    // Ids ascend from arguments to nodes, so the images of all arguments are known.
    for (i, origin) in origins.iter().enumerate() {
        if !live[i] {
            extraction.map.push(ExprId(i as u32));
            extraction.varies.push(ExpressionVariability::AtEvents);
            extraction.rooted.push(false);
            continue;
        }
        let image = extraction.image(draft, ExprId(i as u32), *origin);
        extraction.map.push(image);
        let varies = extraction.variation(draft, ExprId(i as u32));
        extraction.varies.push(varies);
        let operands = draft.exprs.operands(ExprId(i as u32));
        let within = operands.as_slice().iter().any(|a| extraction.rooted[a.index()]);
        extraction.rooted.push(within || root(&draft.exprs, ExprId(i as u32)).is_some());
    }
    draft.map_expressions(&extraction.map);
}

/// By node: the origin of the first equation or `when` condition that contains it. `None` for nodes that occur nowhere
/// else: they make no events.
/// A node that several equations share gets the origin of the first.
fn eventful_origins(draft: &DaeDraft) -> Vec<Option<ElementOrigin>> {
    let mut origins = vec![None; draft.exprs.len()];
    let mut mark = |roots: &[ExprId], origin: ElementOrigin| {
        let mut stack = roots.to_vec();
        while let Some(e) = stack.pop() {
            let seen: &mut Option<ElementOrigin> = &mut origins[e.index()];
            if seen.is_none() {
                *seen = Some(origin);
                stack.extend_from_slice(draft.exprs.operands(e).as_slice());
            }
        }
    };
    for equation in &draft.equations {
        mark(&[equation.lhs, equation.rhs], equation.origin);
    }
    for when in &draft.whens {
        for branch in &when.branches {
            mark(&branch.conditions, when.origin);
        }
    }
    origins
}

/// The images made so far. The lists are indexed by node.
#[derive(Default)]
struct CrossingExtraction {
    /// The image of each node.
    map: Vec<ExprId>,
    /// When each node may change.
    varies: Vec<ExpressionVariability>,
    /// Whether a node contains a root of something that varies.
    rooted: Vec<bool>,
    /// Mode variables with the relations that they stand for.
    watched: FxHashMap<ExprId, ExprId>,
}

impl CrossingExtraction {
    /// The image of one node. `origin` is the place from which it makes events, if any.
    ///
    /// An `if` whose branches contain roots gets continuations of its branches: see [`beyond`].
    fn image(&mut self, draft: &mut DaeDraft, e: ExprId, origin: Option<ElementOrigin>) -> ExprId {
        match draft.exprs.node(e) {
            ExprNode::EventRel(rel, a, b) => self.relation(draft, (rel, a, b), origin),
            ExprNode::EventFloor(a) => self.floor(draft, a, origin),
            ExprNode::Sample(start, interval) => match origin {
                Some(origin) => self.sampling(draft, start, interval, origin),
                // A `sample` outside of equations and conditions never fires.
                None => Exprs::ZERO,
            },
            ExprNode::If(c, a, b) if self.rooted[a.index()] || self.rooted[b.index()] => {
                let [c, a, b] = [c, a, b].map(|e| self.map[e.index()]);
                // The condition as written, with relations instead of modes: it is evaluated where the integrator tries
                // a step.
                let modes = draft.exprs.reachable(&[c], |_| true).into_iter();
                let modes: Vec<(ExprId, ExprId)> = modes.filter_map(|e| Some((e, *self.watched.get(&e)?))).collect();
                let holds = draft.exprs.substitute(c, &modes);
                // The condition has no modes, so no event is delayed and the branches need no continuation.
                if holds == c {
                    return draft.exprs.if_(c, a, b);
                }
                let fails = draft.exprs.not(holds);
                let (a, b) = (beyond(&mut draft.exprs, a, holds), beyond(&mut draft.exprs, b, fails));
                draft.exprs.if_(c, a, b)
            }
            _ => carried(&mut draft.exprs, e, &self.map),
        }
    }

    /// The mode of a relation, or the relation itself where it needs none.
    /// A relation of time alone becomes a time event, whose moment is known exactly. Relations in places that make no
    /// events stay relations.
    fn relation(
        &mut self,
        draft: &mut DaeDraft,
        (rel, a, b): (RelationalOp, ExprId, ExprId),
        origin: Option<ElementOrigin>,
    ) -> ExprId {
        let (left, right) = (self.map[a.index()], self.map[b.index()]);
        let varies = self.varies[a.index()].max(self.varies[b.index()]);
        let (Some(origin), true) = (origin, varies > ExpressionVariability::AtEvents) else {
            return draft.exprs.rel(rel, left, right);
        };
        let timed = if varies == ExpressionVariability::WithTime { time_event(draft, rel, left, right) } else { None };
        let (kind, value) = match timed {
            Some((rel, at)) => {
                let time = draft.exprs.time();
                (CrossingKind::Time(rel, at), draft.exprs.rel(rel, time, at))
            }
            None => (CrossingKind::Relation(rel, left, right), draft.exprs.rel(rel, left, right)),
        };
        // With constant sides the relation folds to a number.
        match draft.exprs.node(value) {
            ExprNode::Num(_) => value,
            _ => {
                let mode = watched(draft, kind, value, ScalarType::Boolean, origin);
                self.watched.insert(mode, value);
                mode
            }
        }
    }

    /// The mode of a `floor`, or the `floor` itself where its argument changes at events only.
    /// The mode has the type Integer.
    fn floor(&self, draft: &mut DaeDraft, a: ExprId, origin: Option<ElementOrigin>) -> ExprId {
        let argument = self.map[a.index()];
        let value = draft.exprs.floor(argument);
        match origin {
            Some(origin) if self.varies[a.index()] > ExpressionVariability::AtEvents => {
                watched(draft, CrossingKind::Floor(argument), value, ScalarType::Integer, origin)
            }
            _ => value,
        }
    }

    /// The mode of a `sample`. The solver sets it; it has no equation.
    fn sampling(&self, draft: &mut DaeDraft, start: ExprId, interval: ExprId, origin: ElementOrigin) -> ExprId {
        let (start, interval) = (self.map[start.index()], self.map[interval.index()]);
        let origin = ElementOrigin { kind: OriginKind::Relation, ..origin };
        let text = draft.exprs.sample(start, interval);
        let name = draft.text(text);
        let mode = draft.make_variable(name, ScalarType::Boolean, SystemRole::Sample, origin);
        draft.samples.push(SampleEvent { mode, start, interval, origin });
        draft.exprs.var(mode)
    }

    /// When a node may change, from its own kind and that of its arguments.
    /// An expression is as variable as its most variable argument.
    fn variation(&self, draft: &DaeDraft, e: ExprId) -> ExpressionVariability {
        match draft.exprs.node(e) {
            ExprNode::Time => ExpressionVariability::WithTime,
            ExprNode::Der(_) => ExpressionVariability::Continuously,
            ExprNode::Var(v) => variable_variation(draft, v),
            ExprNode::EventRel(..) | ExprNode::EventFloor(_) | ExprNode::Sample(..) => ExpressionVariability::AtEvents,
            _ => {
                let operands = draft.exprs.operands(e);
                operands
                    .as_slice()
                    .iter()
                    .map(|a| self.varies[a.index()])
                    .max()
                    .unwrap_or(ExpressionVariability::AtEvents)
            }
        }
    }
}

/// When a variable may change. A Real input may be given as a continuous signal.
fn variable_variation(draft: &DaeDraft, v: VarId) -> ExpressionVariability {
    match draft.role(v) {
        SystemRole::Continuous => ExpressionVariability::Continuously,
        SystemRole::Input if draft.variables[v.index()].ty == ScalarType::Real => ExpressionVariability::Continuously,
        _ => ExpressionVariability::AtEvents,
    }
}

/// Writes `left rel right` as `time rel at`. `None` unless the relation is affine in time with a numeric factor.
/// Examples: `time > 2` and `2*time + 1 < p`.
fn time_event(draft: &mut DaeDraft, rel: RelationalOp, left: ExprId, right: ExprId) -> Option<(RelationalOp, ExprId)> {
    let pool = &mut draft.exprs;
    let time = pool.time();
    if left == time && !pool.contains(right, time) {
        return Some((rel, right));
    }
    let (at, coefficient) = pool.solve_for(left, right, time)?;
    let factor = pool.as_num(coefficient)?;
    // A negative factor turns the relation round.
    Some((if factor > 0.0 { rel } else { mirrored(rel) }, at))
}

/// The relation that holds with its sides exchanged.
fn mirrored(rel: RelationalOp) -> RelationalOp {
    match rel {
        RelationalOp::Lt => RelationalOp::Gt,
        RelationalOp::Le => RelationalOp::Ge,
        RelationalOp::Gt => RelationalOp::Lt,
        RelationalOp::Ge => RelationalOp::Le,
        same => same,
    }
}

/// The argument of a square root, or of a power with a positive exponent that is not whole, unless it is a number.
/// `None` for other nodes.
/// Only such functions have no value below 0.
fn root(pool: &Exprs, e: ExprId) -> Option<ExprId> {
    let argument = match pool.node(e) {
        ExprNode::Unary(UnaryFunction::Sqrt, u) => u,
        ExprNode::Binary(BinaryFunction::Pow, u, n) if pool.as_num(n).is_some_and(|n| n > 0.0 && n.fract() != 0.0) => u,
        _ => return None,
    };
    pool.as_num(argument).is_none().then_some(argument)
}

/// The continuation of a branch of an `if` past its event.
///
/// Between the moment at which the condition fails and the event, which the solver finds a little later, the branch is
/// still evaluated. In `if dp > 0 then sqrt(dp) else 0` the argument becomes negative there. Such a root continues with
/// the opposite sign, `-sqrt(-dp)`, where the condition does not hold, so that the solver finds the crossing.
/// The continuation changes no value where the condition holds.
fn beyond(pool: &mut Exprs, branch: ExprId, holds: ExprId) -> ExprId {
    let mut replaced = Vec::new();
    for e in pool.reachable(&[branch], |_| true) {
        let Some(argument) = root(pool, e) else { continue };
        let opposite = pool.neg(argument);
        let below = match pool.node(e) {
            ExprNode::Binary(_, _, n) => pool.pow(opposite, n),
            _ => pool.sqrt(opposite),
        };
        let below = pool.neg(below);
        let negative = pool.rel(RelationalOp::Lt, argument, Exprs::ZERO);
        let other = pool.if_(negative, below, e);
        // Where the condition holds, the root stays as written.
        replaced.push((e, pool.if_(holds, e, other)));
    }
    if replaced.is_empty() { branch } else { pool.substitute(branch, &replaced) }
}

/// Makes a mode variable with its equation and its crossing. Returns the mode as an expression.
/// Its name is the text of the relation, which messages about events show.
fn watched(draft: &mut DaeDraft, kind: CrossingKind, value: ExprId, ty: ScalarType, origin: ElementOrigin) -> ExprId {
    let origin = ElementOrigin { kind: OriginKind::Relation, ..origin };
    let name = draft.text(value);
    let mode = draft.make_variable(name, ty, SystemRole::Discrete, origin);
    draft.crossings.push(ZeroCrossing { mode, kind, origin });
    let lhs = draft.exprs.var(mode);
    draft.add_equation(FlatEquation { lhs, rhs: value, origin }, EquationRole::Definition);
    lhs
}
