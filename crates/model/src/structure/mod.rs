//! Structural analysis: from the flat model to a differential-algebraic system in block lower triangular form.
//!
//! Enters: a [`flat::FlatModel`] and a [`StateChoice`]. Leaves: a [`Dae`], or diagnostics where the model is
//! structurally singular. `compile::analyze` calls [`analyze`]; the crate `solve` lowers the result to kernels.
//!
//! The steps, in this order (`analysis` holds them): parameters are sorted and evaluated (`parameters`); events become
//! discrete variables and equations (`delays`, `events`, `discrete`); aliases are eliminated (`alias`); the system is
//! checked for structural regularity (`regularity`); hidden linear dependence is made explicit (`dependence`); the
//! index is reduced (`pantelides`, `dummy_derivatives`); the equations are matched, sorted and torn (`matching`, `blt`,
//! `tearing`).
//!
//! [`Dae`] holds three sorted systems over one set of variables: `continuous` (the right-hand side between events),
//! `event` (the same with all discrete equations, solved at events) and `initial` (solved once at the start).

mod alias;
mod analysis;
mod assertions;
mod blt;
mod cancelling;
mod closed_groups;
mod conserved;
mod constants;
mod delays;
mod dependence;
mod discrete;
mod draft;
mod dulmage_mendelsohn;
mod dummy_derivatives;
mod duplicates;
mod events;
mod held;
mod incidence;
mod initial;
mod matching;
mod messages;
mod pantelides;
pub mod parameters;
pub mod places;
mod print;
mod regularity;
mod solve_block;
mod sorting;
mod start_derivatives;
pub mod starts;
mod tearing;
mod zeros;

pub use analysis::analyze;

use crate::flat;
use bramah_expr::{ExprId, Exprs, RelationalOp, VarId};

/// The model as the numerical stages see it.
///
/// All `ExprId`s refer to `exprs`, all `VarId`s to `variables`, all numbers of equations to `equations`.
#[derive(Clone, Debug, Default)]
pub struct Dae {
    /// The class, by its full name.
    pub class: String,
    /// All expressions. No `EventRel`, `EventFloor` or `Sample` is reachable from the blocks.
    pub exprs: Exprs,
    /// The flat variables in their order, then those made here (modes, conditions, dummy derivatives); made ones are
    /// `hidden` and carry a name that a message may show, such as `der(cyl.x)` or the text of the relation.
    pub variables: Vec<flat::FlatVariable>,
    /// Component instances, as in the flat model.
    pub instances: Vec<flat::InstanceInfo>,
    /// Enumeration types, as in the flat model.
    pub enumerations: Vec<(String, Vec<String>)>,
    /// The experiment annotation.
    pub experiment: flat::ExperimentAnnotation,
    /// All equations that blocks refer to, for messages.
    /// They include differentiated equations, definitions of modes, and initial conditions.
    pub equations: Vec<flat::FlatEquation>,
    /// Parameters and constants with a binding, sorted so that each binding refers to earlier ones only.
    /// Those that depend on free parameters are not among them.
    pub parameters: Vec<VarId>,
    /// Parameters with `fixed = false`: unknowns of the initial system, then constant.
    pub free_parameters: Vec<VarId>,
    /// Top-level inputs, in declaration order.
    /// The stand-ins of `delays` are not among them.
    pub inputs: Vec<VarId>,
    /// Variables that equal another one, or its negative; the target is never an alias itself.
    pub aliases: Vec<Alias>,
    /// The states, in declaration order: their values are integrated.
    /// The derivative of each is an unknown `Der` of the continuous system, or assigned there from the variable that it
    /// is.
    pub states: Vec<VarId>,
    /// Variables whose derivatives the equations need but that are no states: they must be continuous.
    /// They are the variables whose derivatives became dummies. A jump of one at an event would be an impulse.
    pub differentiated: Vec<VarId>,
    /// Discrete unknowns (user's, modes and conditions), each assigned in exactly one `event` block.
    pub discrete: Vec<VarId>,
    /// All continuous unknowns given time, parameters, inputs, states and discrete values.
    pub continuous: Vec<BltBlock>,
    /// The same with all discrete unknowns, at an event, given `pre` values. Contains `when` equations as
    /// `v = if fires then value else pre(v)`.
    pub event: Vec<BltBlock>,
    /// Everything (states, derivatives, algebraic, discrete, free parameters) at the start.
    pub initial: Vec<BltBlock>,
    /// Relations whose change is an event.
    pub crossings: Vec<ZeroCrossing>,
    /// `sample` expressions: the mode variable is true exactly at its event.
    pub samples: Vec<SampleEvent>,
    /// `delay` expressions.
    pub delays: Vec<DelayInput>,
    /// `reinit`, `terminate` and `assert` inside `when`, in order.
    pub actions: Vec<EventAction>,
    /// `assert`s outside `when`.
    pub asserts: Vec<flat::FlatAssertion>,
    /// Groups of constraints among whose candidates the states were chosen. The solver asks for another choice when the
    /// pivots of a group become small.
    pub selections: Vec<StateSelection>,
    /// Quantities that the solver may integrate in place of states, at most one for each state.
    pub conserved: Vec<ConservedQuantity>,
    /// Expressions that must vanish at the start, each with its equation: fixed starts of variables that constraints
    /// tie to others, which hold only if they are consistent. Checked after the initial system is solved.
    pub initial_checks: Vec<(ExprId, u32)>,
    /// Variables whose start values the compiler fixed to make the initial system determined. Notes list them.
    pub chosen_starts: Vec<VarId>,
}

impl Dae {
    /// Whether results show a variable. They show every public variable. They show a hidden one only if it is a state
    /// and not annotated `HideResult`.
    pub fn is_shown(&self, v: VarId) -> bool {
        let variable = &self.variables[v.index()];
        !variable.hidden || !variable.unwanted && self.states.binary_search(&v).is_ok()
    }
}

/// `variable = target` or `variable = -target`. Results compute the variable from its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Alias {
    /// The variable that is not computed. No block and no equation of a block contains it.
    pub variable: VarId,
    /// The variable that it equals. It is never an alias itself.
    pub target: VarId,
    /// True for `variable = -target`.
    pub negated: bool,
}

/// What a block solves for: a column of a sorted system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unknown {
    /// A variable.
    Var(VarId),
    /// The derivative of a state. Other derivatives are variables of their own.
    Der(VarId),
}

/// A step of a sorted system. Each block reads only known quantities and unknowns of earlier blocks.
/// The blocks of a system come in an order in which they can be solved.
#[derive(Clone, Debug, PartialEq)]
pub enum BltBlock {
    /// One explicit assignment.
    Assign(ExplicitAssignment),
    /// A system of simultaneous equations with its tearing variables.
    Loop(AlgebraicLoop),
    /// A loop through discrete equations. It occurs only in `event` and `initial`.
    Mixed(MixedLoop),
}

/// `unknown := value`: an equation that was solved symbolically.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExplicitAssignment {
    /// What is computed.
    pub unknown: Unknown,
    /// The expression that gives its value. It does not contain the unknown.
    pub value: ExprId,
    /// The equation it was solved from: index into `Dae::equations`.
    pub equation: u32,
}

/// An algebraic loop: given the tearing variables, `inner` follows explicitly, and `residuals` must vanish.
///
/// The loop has `tearing.len() + inner.len()` unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct AlgebraicLoop {
    /// Tearing variables: the unknowns of the iteration, as many as residuals.
    pub tearing: Vec<Unknown>,
    /// Explicit assignments, in an order in which each reads only the tearing variables and earlier ones.
    pub inner: Vec<ExplicitAssignment>,
    /// Expressions that must be zero, each with its equation.
    pub residuals: Vec<(ExprId, u32)>,
    /// True when the residuals are affine in the tearing variables (through `inner`).
    pub linear: bool,
}

/// A loop through discrete equations: iterate `continuous`, then `discrete`, until the discrete values stay.
/// Its members depend on each other, so no order of the two parts is enough.
#[derive(Clone, Debug, PartialEq)]
pub struct MixedLoop {
    /// The continuous part with discrete values frozen, sorted: `ExplicitAssignment` and `AlgebraicLoop` only.
    pub continuous: Vec<BltBlock>,
    /// The discrete equations in an order that follows their dependencies as far as possible.
    pub discrete: Vec<ExplicitAssignment>,
}

/// A relation or a `floor` whose change is an event, with the discrete variable that replaces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroCrossing {
    /// The discrete variable that stands for it in all equations. It keeps its value between events.
    pub mode: VarId,
    /// The expression that the solver watches for a change.
    pub kind: CrossingKind,
    /// The place of the relation and the instance it stands in.
    pub origin: flat::ElementOrigin,
}

/// The expression of a [`ZeroCrossing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CrossingKind {
    /// `left rel right` with at least one continuous side.
    Relation(RelationalOp, ExprId, ExprId),
    /// `time rel at`: `at` depends on parameters and discrete values only, so the event's time is known exactly.
    Time(RelationalOp, ExprId),
    /// `floor(argument)`.
    Floor(ExprId),
}

/// A `sample(start, interval)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleEvent {
    /// True exactly at the sampling events.
    pub mode: VarId,
    /// First time.
    pub start: ExprId,
    /// Time between two events, in seconds. It must be positive.
    pub interval: ExprId,
    /// Where it stands.
    pub origin: flat::ElementOrigin,
}

/// A `delay(source, time)`: to the equations an input, whose trajectory the run itself records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayInput {
    /// The input that stands for it in all equations. At the start it is the source itself.
    pub variable: VarId,
    /// What is delayed; of other delays only earlier ones.
    pub source: ExprId,
    /// By how much, in seconds; over parameters.
    pub time: ExprId,
    /// Where it stands.
    pub origin: flat::ElementOrigin,
}

/// Something that happens once when a `when` fires. `fires` is an expression over discrete values and `pre`.
/// The conditions of earlier branches of the same clause are excluded in `fires`.
#[derive(Clone, Debug, PartialEq)]
pub struct EventAction {
    /// True at the event iteration in which it happens.
    pub fires: ExprId,
    /// What happens.
    pub kind: EventActionKind,
    /// Where it stands.
    pub origin: flat::ElementOrigin,
}

/// The kinds of [`EventAction`].
#[derive(Clone, Debug, PartialEq)]
pub enum EventActionKind {
    /// A state gets a new value.
    Reinit(VarId, ExprId),
    /// The run ends as asked.
    Terminate(flat::MessageTemplate),
    /// A condition is checked.
    Assert(flat::FlatAssertion),
}

/// A quantity that may be integrated in place of a state, which then follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConservedQuantity {
    /// The state, one of `Dae::states`.
    pub state: VarId,
    /// The variable of the solver that stands for the quantity. No block computes it.
    pub variable: VarId,
    /// The quantity as an expression of states and of what the continuous system computes.
    pub quantity: ExprId,
    /// The time derivative of the quantity.
    pub rate: ExprId,
    /// `variable = quantity`: index into `Dae::equations`.
    pub equation: u32,
}

/// A group of constraints with more differentiated candidates than degrees of freedom.
///
/// The matrix `rows` restricted to the columns of `dummies` must stay regular during the run; else the choice of states
/// is no longer valid.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSelection {
    /// Candidates; the derivatives of `candidates.len() - rows.len()` of them are integrated, the rest are dummies.
    pub candidates: Vec<VarId>,
    /// Those chosen as dummies now, as many as rows.
    pub dummies: Vec<VarId>,
    /// The derivative of each constraint by each candidate, by rows.
    pub rows: Vec<Vec<ExprId>>,
}

/// States that should be preferred beyond `stateSelect`. It is empty for a first analysis; the solver fills it from the
/// pivots of a run whose choice of states became singular.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateChoice {
    /// Candidates to take as states.
    pub preferred: Vec<VarId>,
}

#[cfg(test)]
mod tests;
