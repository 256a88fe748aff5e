//! The flat model: scalar variables and equations, each with its origin.
//!
//! Enters: an `Instance` (the component tree) and its `Network` (the connection sets). Leaves: a [`FlatModel`], in
//! which no components, arrays or connections are left. [`flatten()`] makes it; `compile` calls that, and [`explain()`]
//! where `structure` finds the model singular. The text form is close to flat Modelica (MLS 5.6).
//!
//! `equations`, `when_equations` and `algorithm_sections` translate what the classes state; `streams` and
//! `overconstrained` add equations of connections; `census`, `balance`, `ports` and `discrete` check the result.

mod algorithm_sections;
mod balance;
mod census;
mod discrete;
mod equations;
mod explain;
mod flatten;
mod numbers;
mod overconstrained;
mod ports;
mod print;
mod roots;
mod streams;
mod when_equations;

pub use explain::explain;
pub use flatten::flatten;

pub use bramah_expr::types::{MessagePart, ScalarType, StateSelect, Variability};

use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::diag::{Diagnostic, Span};

/// The flattened model. All `ExprId`s refer to `exprs`, all `VarId`s to `variables`.
#[derive(Clone, Debug, Default)]
pub struct FlatModel {
    /// The class that was instantiated, by its full name.
    pub class: String,
    /// All expressions.
    pub exprs: Exprs,
    /// All scalar variables in declaration order; `VarId` indexes here.
    pub variables: Vec<FlatVariable>,
    /// Equations of the `equation` sections, bindings of variables, connection equations.
    pub equations: Vec<FlatEquation>,
    /// Equations of the `initial equation` sections. `fixed` starts are not listed here: see [`FlatVariable::fixed`].
    pub initial_equations: Vec<FlatEquation>,
    /// `when` clauses, also those of algorithms. Each branch assigns a variable at most once.
    pub whens: Vec<WhenClause>,
    /// `assert`s outside `when`.
    pub asserts: Vec<FlatAssertion>,
    /// Statements `Connections.conserved(..)`.
    pub conserved: Vec<ConservationDeclaration>,
    /// Component instances, parents before children; entry 0 is the model itself with an empty name.
    pub instances: Vec<InstanceInfo>,
    /// What seems wrong with signals or with the balance of single components. It is reported only when the equations
    /// turn out not to determine the unknowns.
    pub doubts: Vec<Diagnostic>,
    /// Enumeration types, each with its full name and its literals in order.
    pub enumerations: Vec<(String, Vec<String>)>,
    /// The model's `experiment` annotation.
    pub experiment: ExperimentAnnotation,
    /// Parameters will get other values without compiling again, so none of them may be fixed with the structure
    /// because its value is 0.
    pub varied: bool,
}

impl FlatModel {
    /// Whether a variable is a parameter whose binding reads no other parameter and not the time. All other parameters
    /// follow from such roots.
    pub fn is_root(&self, v: VarId) -> bool {
        let variable = &self.variables[v.index()];
        let reads = |e: ExprId| {
            let variables = self.exprs.variables(e);
            variables.iter().any(|w| self.variables[w.index()].variability == Variability::Parameter)
                || matches!(self.exprs.node(e), ExprNode::Time)
        };
        variable.variability == Variability::Parameter && !variable.binding.is_some_and(reads)
    }
}

/// `annotation(experiment(...))`. A field is `None` where the annotation does not give it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs, reason = "the names of the annotation, in SI units")]
pub struct ExperimentAnnotation {
    pub start_time: Option<f64>,
    pub stop_time: Option<f64>,
    pub interval: Option<f64>,
    pub tolerance: Option<f64>,
}

/// A component instance, for messages and for grouping.
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceInfo {
    /// Full dotted name with indices.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The instance it belongs to (itself for entry 0).
    pub parent: u32,
    /// Where it is declared.
    pub span: Span,
}

/// Where a variable or equation comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementOrigin {
    /// The place in the text.
    pub span: Span,
    /// The instance that contains it: index into `FlatModel::instances`.
    pub instance: u32,
    /// Why it exists.
    pub kind: OriginKind,
}

/// Why a variable or equation exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OriginKind {
    /// Written by the user as an equation, statement or declaration.
    Declared,
    /// The binding of a declaration or a modifier.
    Binding,
    /// Equal potentials of a connection set.
    ConnectPotential,
    /// The sum of flows of a connection set.
    ConnectFlow,
    /// The zero flow of a port that nothing is connected to from outside.
    OpenPort,
    /// The time derivative of another equation, made by index reduction.
    Differentiated,
    /// A relation that makes events.
    Relation,
    /// The condition of a `when`.
    WhenCondition,
    /// A `fixed` start value, or one chosen by the compiler.
    Start,
    /// A start value that is not `fixed` and gives way to one that is.
    Guess,
    /// Made by the compiler for another reason.
    Made,
}

/// A scalar variable with its attributes.
#[derive(Clone, Debug)]
pub struct FlatVariable {
    /// Full dotted name with indices, as in `pump.b.p` or `v[3].p`.
    pub name: String,
    /// Its type.
    pub ty: ScalarType,
    /// When it may change.
    pub variability: Variability,
    /// A top-level `input`: its value comes from outside. Its binding, if any, is the default.
    pub input: bool,
    /// A top-level `output`.
    pub output: bool,
    /// Declared `flow`.
    pub flow: bool,
    /// A parameter that may be given from outside: neither `final` nor protected.
    pub settable: bool,
    /// `protected`, or annotated `HideResult`: left out of results but for protected states.
    pub hidden: bool,
    /// Annotated `HideResult`.
    pub unwanted: bool,
    /// Binding of a parameter or constant, or default of an input. Bindings of variables are equations.
    pub binding: Option<ExprId>,
    /// `start`: a parameter expression. `None` when not given (0 or `false`, first literal).
    pub start: Option<ExprId>,
    /// How much `start` counts beside the starts of others, where not all can hold.
    pub confidence: StartValueConfidence,
    /// `fixed`: the start value holds at the beginning of the run. For a parameter, false means that initialization
    /// finds it.
    pub fixed: bool,
    /// `min`
    pub min: Option<ExprId>,
    /// `max`
    pub max: Option<ExprId>,
    /// `nominal`: a parameter expression.
    pub nominal: Option<ExprId>,
    /// `unit`, as written.
    pub unit: Option<Box<str>>,
    /// A difference of temperatures: a value in degC converts to as many K, without the offset.
    pub difference: bool,
    /// `displayUnit`, as written.
    pub display_unit: Option<Box<str>>,
    /// The description string.
    pub description: Option<Box<str>>,
    /// `stateSelect`
    pub state_select: StateSelect,
    /// Where it was declared.
    pub origin: ElementOrigin,
}

/// Who gave a start value that is not `fixed`.
///
/// Of two start values for one quantity the one given further outside counts (the confidence numbers of MLS 8.6.2). Of
/// two given equally far outside, the one that reaches further in counts. Smaller is more confident; the fields are
/// compared in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct StartValueConfidence {
    /// `fixed = false` was written: the start of any other variable goes first.
    pub free: bool,
    /// Components around the place where the value was written; 0 in the model itself.
    pub depth: u32,
    /// Components from there in to the variable's own class, as a negative number.
    pub reach: i32,
}

impl StartValueConfidence {
    /// Whether the model itself states how one of its components starts.
    pub fn is_said(&self) -> bool {
        !self.free && self.depth == 0 && self.reach < 0
    }

    /// Whether it is the start of a component: given by its class, or by the model that contains it.
    pub fn is_of_component(&self) -> bool {
        self.depth != u32::MAX && (self.depth > 0 || self.reach < 0)
    }
}

impl Default for StartValueConfidence {
    /// The confidence of a variable without a start: the least of all.
    fn default() -> Self {
        StartValueConfidence { free: false, depth: u32::MAX, reach: 0 }
    }
}

impl FlatVariable {
    /// Whether its start is a condition: `fixed`, or stated by the model for one of its components.
    pub fn start_is_said(&self) -> bool {
        self.fixed || self.start.is_some() && self.confidence.is_said()
    }

    /// A variable with nothing but these properties: no attributes, visible, not fixed.
    pub fn plain(name: impl Into<String>, ty: ScalarType, variability: Variability, origin: ElementOrigin) -> Self {
        FlatVariable {
            name: name.into(),
            ty,
            variability,
            input: false,
            output: false,
            flow: false,
            settable: false,
            hidden: false,
            unwanted: false,
            binding: None,
            start: None,
            confidence: StartValueConfidence::default(),
            fixed: false,
            min: None,
            max: None,
            nominal: None,
            unit: None,
            difference: false,
            display_unit: None,
            description: None,
            state_select: StateSelect::Default,
            origin,
        }
    }
}

/// `lhs = rhs`.
///
/// If the left side is a lone discrete-valued variable (Boolean, Integer, enumeration, or `discrete Real`), or both
/// sides are discrete, this is a discrete equation, active at events; else a continuous one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatEquation {
    /// Left side.
    pub lhs: ExprId,
    /// Right side.
    pub rhs: ExprId,
    /// Where it comes from.
    pub origin: ElementOrigin,
}

/// `when c1 then ... elsewhen c2 then ... end when`.
#[derive(Clone, Debug, PartialEq)]
pub struct WhenClause {
    /// The branches in order of priority.
    pub branches: Vec<WhenBranch>,
    /// Where it comes from.
    pub origin: ElementOrigin,
}

impl WhenClause {
    /// The variables that its branches assign, in the order of the assignments. One may come several times.
    pub fn assigned(&self) -> impl Iterator<Item = VarId> {
        self.branches.iter().flat_map(|b| &b.actions).filter_map(|a| match a {
            WhenAction::Assign { variable, .. } => Some(*variable),
            _ => None,
        })
    }
}

/// One branch of a `when`. `when {c1, c2}` has several conditions: it fires when any of them becomes true.
#[derive(Clone, Debug, PartialEq)]
pub struct WhenBranch {
    /// Conditions; `ExprNode::Initial` stands for `initial()`.
    pub conditions: Vec<ExprId>,
    /// What happens when the branch fires, in order.
    pub actions: Vec<WhenAction>,
}

/// A statement in a branch of a `when`.
#[derive(Clone, Debug, PartialEq)]
pub enum WhenAction {
    /// `v = value`
    Assign {
        /// A discrete-time variable.
        variable: VarId,
        /// Its new value.
        value: ExprId,
        /// Where it stands.
        origin: ElementOrigin,
    },
    /// `reinit(x, value)`
    Reinit {
        /// The variable whose derivative appears.
        variable: VarId,
        /// Its new value.
        value: ExprId,
        /// 1 unless it stood in an `if`.
        guard: ExprId,
        /// Where it stands.
        origin: ElementOrigin,
    },
    /// `assert(condition, message, level)`
    Assert(FlatAssertion),
    /// `terminate(message)`
    Terminate {
        /// The message.
        message: MessageTemplate,
        /// 1 unless it stood in an `if`.
        guard: ExprId,
        /// Where it stands.
        origin: ElementOrigin,
    },
}

/// `Connections.conserved(quantity, rate, state)`: a balance that the equations imply. It is stated so that the solver
/// can integrate the quantity and compute the state from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConservationDeclaration {
    /// A quantity that changes by its rate alone: an expression of states.
    pub quantity: ExprId,
    /// Its time derivative.
    pub rate: ExprId,
    /// The variable that follows from it, as an expression `Var`.
    pub state: ExprId,
    /// Where it is stated.
    pub origin: ElementOrigin,
}

/// `assert(condition, message, level)`
#[derive(Clone, Debug, PartialEq)]
pub struct FlatAssertion {
    /// What must hold.
    pub condition: ExprId,
    /// The text for the user where it does not hold.
    pub message: MessageTemplate,
    /// True for `AssertionLevel.warning`.
    pub warning: bool,
    /// Where it stands.
    pub origin: ElementOrigin,
}

/// A text with values in it, `"p = " + String(p)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MessageTemplate {
    /// The pieces in order.
    pub parts: Vec<MessagePart>,
}
