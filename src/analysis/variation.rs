//! The model with its variational equations: every continuous variable v gets a companion dv/dz for each direction z, and
//! every equation its exact derivative along that direction. The run of the whole gives trajectories with forward
//! sensitivities under the same error control.
//!
//! What this cannot see are jumps of the sensitivities where the rates jump at an event whose time moves: such models are
//! refused where the text shows it, and [`Watch`] ends a run where the rows show it. Source: S. Galan, W. F. Feehery,
//! P. I. Barton, Applied Numerical Mathematics 31 (1999) 17.

use crate::expr::differentiate::Differentiator;
use crate::expr::{ExprId, Exprs, Node, VarId};
use crate::flat::{Equation, FlatModel, Origin, OriginKind, Type, Variability, Variable, WhenAction};
use crate::lower::{Options, System, lower};
use crate::solve::Sink;
use crate::structure::{self, StateChoice};
use std::ops::ControlFlow;
use std::sync::Arc;

/// A model that carries its sensitivities along.
#[derive(Clone, Debug)]
pub struct Variation {
    /// Ready to run.
    pub system: Arc<System>,
    /// Derivatives of the variables whose jumps at an event make the sensitivities wrong; empty where no event depends on
    /// a direction.
    pub rates: Vec<VarId>,
    /// Place of each variable among the continuous ones.
    places: Vec<Option<u32>>,
    /// The first companion, and how many there are a direction.
    first: u32,
    count: u32,
}

impl Variation {
    /// With directions that move parameters, each by its size a unit, and after them `free` directions that nothing moves
    /// until a run starts with a companion that is not zero. Parameters that are `independent` do not follow others,
    /// whatever their bindings say: runs give them values.
    ///
    /// # Errors
    /// In words, why the variational equations do not describe the model.
    pub fn new(
        flat: &FlatModel,
        parameters: &[(VarId, f64)],
        independent: &[VarId],
        free: usize,
    ) -> Result<Variation, String> {
        let mut made = Made::new(flat)?;
        let moved = parameters.iter().map(|p| Some(*p)).chain(std::iter::repeat_n(None, free));
        for direction in moved {
            made.along(direction, independent)?;
        }
        let rates = if made.events { made.rates() } else { Vec::new() };
        let Made { flat, places, first, count, .. } = made;
        let Some(dae) = structure::analyze(&flat, &StateChoice::default()).value else {
            return Err("the equations with their derivatives cannot be sorted".to_owned());
        };
        let system = Arc::new(lower(Arc::new(dae), &Options::default()));
        Ok(Variation { system, rates, places, first, count })
    }

    /// The companion of a variable along a direction; `None` for what only changes at events or not at all.
    pub fn companion(&self, v: VarId, direction: usize) -> Option<VarId> {
        let place = self.places.get(v.index()).copied().flatten()?;
        Some(VarId(self.first + u32::try_from(direction).ok()? * self.count + place))
    }

    /// Whether variable and companion are both integrated, so that a run may start with other values of them.
    pub fn is_state(&self, v: VarId, direction: usize) -> bool {
        let states = &self.system.dae.states;
        states.contains(&v) && self.companion(v, direction).is_some_and(|s| states.contains(&s))
    }
}

/// The augmented model as it grows.
struct Made {
    flat: FlatModel,
    /// How many equations, and initial ones, are the model's own.
    equations: usize,
    initial: usize,
    /// Nodes whose change is an event.
    relations: Vec<ExprId>,
    /// Values given to real variables at events.
    assigned: Vec<ExprId>,
    places: Vec<Option<u32>>,
    first: u32,
    count: u32,
    /// Directions so far.
    directions: u32,
    /// An event depends on a direction.
    events: bool,
}

impl Made {
    fn new(flat: &FlatModel) -> Result<Made, String> {
        let mut places = Vec::with_capacity(flat.variables.len());
        let mut count = 0;
        for v in &flat.variables {
            let moves = v.ty == Type::Real && v.variability == Variability::Continuous && !v.input;
            places.push(moves.then_some(count));
            count += u32::from(moves);
            if v.variability == Variability::Parameter && v.ty == Type::Real && !v.fixed {
                return Err(format!("`{}` is found at the start", v.name));
            }
        }
        if flat
            .whens
            .iter()
            .flat_map(|w| &w.branches)
            .flat_map(|b| &b.actions)
            .any(|a| matches!(a, WhenAction::Reinit { .. }))
        {
            return Err("states are set anew at events".to_owned());
        }
        Ok(Made {
            equations: flat.equations.len(),
            initial: flat.initial_equations.len(),
            relations: relations(flat),
            assigned: assigned(flat),
            places,
            first: u32::try_from(flat.variables.len()).expect("fewer than 2^32 variables"),
            count,
            directions: 0,
            events: false,
            flat: flat.clone(),
        })
    }

    /// Companions and equations of one more direction.
    fn along(&mut self, moved: Option<(VarId, f64)>, independent: &[VarId]) -> Result<(), String> {
        let base = self.first + self.directions * self.count;
        self.directions += 1;
        let seeds = self.seeds(moved, independent, base)?;
        let mut by = Differentiator::along(seeds);
        self.companions(&mut by);
        let derived = |flat: &mut FlatModel, e: &Equation, by: &mut Differentiator| {
            let (lhs, rhs) = (by.derive(&mut flat.exprs, e.lhs), by.derive(&mut flat.exprs, e.rhs));
            // what is discrete on both sides does not move
            (lhs != rhs).then_some(Equation { lhs, rhs, origin: Origin { kind: OriginKind::Made, ..e.origin } })
        };
        for k in 0..self.equations {
            let equation = self.flat.equations[k];
            let made = derived(&mut self.flat, &equation, &mut by);
            self.flat.equations.extend(made);
        }
        for k in 0..self.initial {
            let equation = self.flat.initial_equations[k];
            let made = derived(&mut self.flat, &equation, &mut by);
            self.flat.initial_equations.extend(made);
        }
        for k in 0..self.relations.len() {
            let operands = self.flat.exprs.operands(self.relations[k]).as_slice().to_vec();
            let moves = |e: &ExprId| by.derive(&mut self.flat.exprs, *e) != Exprs::ZERO;
            self.events |= operands.iter().any(moves);
        }
        if self.assigned.iter().any(|e| by.derive(&mut self.flat.exprs, *e) != Exprs::ZERO) {
            return Err("sampled values depend on what moves".to_owned());
        }
        Ok(())
    }

    /// What is known of the leaves: derivatives of parameters, companions of variables.
    fn seeds(
        &mut self,
        moved: Option<(VarId, f64)>,
        independent: &[VarId],
        base: u32,
    ) -> Result<Vec<(ExprId, ExprId)>, String> {
        let pool = &mut self.flat.exprs;
        let mut seeds = Vec::new();
        for (v, place) in (0..).map(VarId).zip(&self.places) {
            let Some(place) = place else { continue };
            let companion = VarId(base + place);
            seeds.push((pool.var(v), pool.var(companion)));
            seeds.push((pool.der(v), pool.der(companion)));
        }
        let Some((p, size)) = moved else { return Ok(seeds) };
        seeds.push((pool.var(p), pool.num(size)));
        let mut open = super::lift::reading(&self.flat, &[p]);
        open.retain(|(v, _)| !independent.contains(v));
        while !open.is_empty() {
            let exprs = &self.flat.exprs;
            let waits = |binding: ExprId| exprs.variables(binding).iter().any(|w| open.iter().any(|(v, _)| v == w));
            let (rest, ready): (Vec<_>, Vec<_>) = open.iter().copied().partition(|&(_, binding)| waits(binding));
            if ready.is_empty() {
                return Err("parameters depend on each other".to_owned());
            }
            let mut by = Differentiator::along(seeds.clone());
            for (v, binding) in ready {
                let derivative = by.derive(&mut self.flat.exprs, binding);
                seeds.push((self.flat.exprs.var(v), derivative));
            }
            open = rest;
        }
        Ok(seeds)
    }

    /// One companion a continuous variable, which starts as the derivative of its start value.
    fn companions(&mut self, by: &mut Differentiator) {
        for k in 0..self.places.len() {
            if self.places[k].is_none() {
                continue;
            }
            let of = &self.flat.variables[k];
            let (start, fixed, nominal, select) = (of.start, of.fixed, of.nominal, of.state_select);
            let name = format!("d {} / d z{}", of.name, self.directions);
            let origin = Origin { kind: OriginKind::Made, ..of.origin };
            let start = start.map(|e| by.derive(&mut self.flat.exprs, e));
            let companion = Variable {
                hidden: true,
                start,
                fixed,
                nominal,
                state_select: select,
                ..Variable::plain(name, Type::Real, Variability::Continuous, origin)
            };
            self.flat.variables.push(companion);
        }
    }

    /// A variable for each derivative that the equations name.
    fn rates(&mut self) -> Vec<VarId> {
        let roots: Vec<ExprId> = self.flat.equations[..self.equations].iter().flat_map(|e| [e.lhs, e.rhs]).collect();
        let nodes = self.flat.exprs.reachable(&roots, |_| true);
        let mut named = Vec::new();
        for node in nodes {
            if let Node::Der(v) = self.flat.exprs.node(node) {
                named.push((v, node));
            }
        }
        let mut rates = Vec::new();
        for (v, der) in named {
            let rate = VarId(u32::try_from(self.flat.variables.len()).expect("fewer than 2^32 variables"));
            let of = &self.flat.variables[v.index()];
            let origin = Origin { kind: OriginKind::Made, ..of.origin };
            let name = format!("rate of {}", of.name);
            let variable =
                Variable { hidden: true, ..Variable::plain(name, Type::Real, Variability::Continuous, origin) };
            self.flat.variables.push(variable);
            let lhs = self.flat.exprs.var(rate);
            self.flat.equations.push(Equation { lhs, rhs: der, origin });
            rates.push(rate);
        }
        rates
    }
}

/// Relations and other nodes whose change is an event.
fn relations(flat: &FlatModel) -> Vec<ExprId> {
    let conditions = flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| b.conditions.iter().copied());
    let roots: Vec<ExprId> = flat.equations.iter().flat_map(|e| [e.lhs, e.rhs]).chain(conditions).collect();
    let nodes = flat.exprs.reachable(&roots, |_| true);
    let event = |e: &ExprId| matches!(flat.exprs.node(*e), Node::EventRel(..) | Node::EventFloor(_) | Node::Sample(..));
    nodes.into_iter().filter(event).collect()
}

/// The values that `when` gives to real variables.
fn assigned(flat: &FlatModel) -> Vec<ExprId> {
    let actions = flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions);
    let values = actions.filter_map(|a| match a {
        WhenAction::Assign { variable, value, .. } if flat.variables[variable.index()].ty == Type::Real => Some(*value),
        _ => None,
    });
    values.collect()
}

/// Hands rows on without their last columns, the rates, and ends the run where these jump at an event.
pub struct Watch<'a> {
    inner: &'a mut dyn Sink,
    /// How many columns are rates.
    rates: usize,
    /// Times at which jumps do no harm, growing: those of held inputs.
    harmless: &'a [f64],
    before: Option<(f64, Vec<f64>)>,
    largest: Vec<f64>,
    /// Where the rates jumped.
    pub jumped: Option<f64>,
}

/// A change of a rate at an event, as a part of its largest value so far, that counts as a jump.
const JUMP: f64 = 1e-5;

impl<'a> Watch<'a> {
    /// In front of a sink.
    pub fn new(inner: &'a mut dyn Sink, rates: usize, harmless: &'a [f64]) -> Watch<'a> {
        Watch { inner, rates, harmless, before: None, largest: vec![0.0; rates], jumped: None }
    }

    fn is_harmless(&self, time: f64) -> bool {
        let k = self.harmless.partition_point(|t| *t < time);
        let near = |t: &f64| (t - time).abs() <= 1e-9 * time.abs().max(1e-9);
        self.harmless[k.saturating_sub(1)..].iter().take(2).any(near)
    }
}

impl Sink for Watch<'_> {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        let (shown, rates) = values.split_at(values.len() - self.rates);
        self.largest.iter_mut().zip(rates).for_each(|(l, r)| *l = l.max(r.abs()));
        if let Some((t, before)) = &self.before
            && *t == time
            && !self.is_harmless(time)
        {
            let jumps = before.iter().zip(rates).zip(&self.largest).any(|((a, b), l)| (a - b).abs() > JUMP * l);
            if jumps {
                self.jumped = Some(time);
                return ControlFlow::Break(());
            }
        }
        self.before = Some((time, rates.to_vec()));
        self.inner.row(time, shown)
    }
}

#[cfg(test)]
#[path = "variation_tests.rs"]
mod tests;
