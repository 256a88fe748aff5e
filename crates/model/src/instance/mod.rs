//! The component tree of one model: classes with their modifiers go in, scalar variables with their attributes come
//! out.
//!
//! [`instantiate`] takes a [`ModelRequest`] and returns an [`Instance`]. The module `compile` calls it, and `flat` then
//! reads the tree and writes equations. Attributes and binding equations stay syntax trees until somebody evaluates
//! them.
//! Expressions are evaluated here, because a name has a meaning only inside an instance.
//!
//! - [`tree`]: what a class holds, which modifier reaches which element, what a name means.
//! - [`building`]: components from declarations.
//! - [`evaluation`]: expressions and statements, in a mode (how) and a frame (which locals are visible).
//! - `calls`: built-in functions, user functions, procedures, and C functions that have an implementation in Rust.
//! - [`views`]: the types that borrow an [`Instance`], each for one task.

pub mod building;
mod calls;
mod errors;
pub mod evaluation;
mod tables;
pub mod tree;
pub mod views;

pub use building::components::{ModelRequest, instantiate};
pub use building::given::{GIVEN, Override};
use building::{components, overconstrained};
use calls::{builtin, call, files, procedure, vectorised};
use evaluation::state;
pub use evaluation::{algorithm, deduce, references, value};
use tables::{BuildingTable, ClassTable, FunctionTable, ValueTable};
pub use tree::{lookup, modifiers, template};
pub use views::{
    BuiltinCalls, ComponentBuilder, Evaluator, ExternalCalls, FunctionCalls, NameLookup, Operators, ParameterValues,
    ProcedureTranslator, Statements, StreamMixing,
};

use crate::resolve::{ClassId, Library};
use bramah_expr::types::{ScalarType, StateSelect, Variability};
use bramah_expr::{ExprId, Exprs, VarId};
use bramah_syntax::ast;
use bramah_syntax::diag::{Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use modifiers::{Binding, Modifier};
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;
use template::Template;
use value::ModelicaValue;

/// Index of a [`Scope`] in [`Instance::scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ScopeId(pub u32);

/// Index of an [`InstanceNode`] in [`Instance::nodes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// Where names are looked up: an instance, seen from one of the classes it is made of.
///
/// Base 0 is the instance's own class. The others are the classes that it extends, directly or not.
/// A name written in a base class means an element of the instance if that base declares or inherits it.
/// Otherwise lookup continues in what encloses the base class, not in what encloses the instance (MLS 5.3).
///
/// ```text
/// package P constant Real k = 1; model B Real x = k; end B; end P;
/// model M extends P.B; end M;    // k is found around P.B, not around M
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LookupContext {
    /// The instance whose elements are visible.
    pub scope: ScopeId,
    /// The base class: index into `Template::bases`.
    pub base: u32,
}

/// The scope of top-level names: built-in types and the classes of the library. It holds no elements.
pub const ROOT: LookupContext = LookupContext { scope: ScopeId(0), base: 0 };

/// A class as found by name: its text, the place it stands in, and the modifiers it has collected.
/// Two references with one `class` and different `parent` or `args` are different types.
#[derive(Clone)]
pub struct ClassRef<'a> {
    /// The class as written.
    pub class: ClassId,
    /// Where a name goes on to be looked up when the class itself does not know it.
    pub parent: LookupContext,
    /// Modifiers that came with the reference, outermost first. Filled for redeclared and replaceable classes.
    pub args: Rc<[Modifier<'a>]>,
}

/// An instance of a class: a component, a package, or the body of a function during a call.
pub struct Scope<'a> {
    /// The elements and bases of the class. All instances of one class at one place share it.
    pub template: Rc<Template<'a>>,
    /// Full dotted name of a component, as in `tank[2].level`; full class name of a package or function.
    pub name: String,
    /// Modifiers of the elements, outermost first. Each still names the element that it is for.
    pub args: Rc<[Modifier<'a>]>,
    /// Value of the complete instance, for records: `R r = f(x)`. Fields without their own modifier take their part of
    /// it.
    pub binding: Option<Binding<'a>>,
    /// The instance of which this one is a component. `None` for packages, functions and the model itself.
    pub owner: Option<ScopeId>,
    /// The state of each element, in the order of `Template::elements`.
    pub elements: Vec<ElementState<'a>>,
    /// Prefixes that the elements inherit from the component.
    pub prefix: InheritedPrefixes,
    /// The name in the declaration of the component, for messages.
    pub span: Span,
    /// True for component instances, false for packages and functions.
    pub component: bool,
}

/// What an element of a scope has become so far. Elements are built on demand, as soon as a name asks for them.
#[derive(Clone)]
pub enum ElementState<'a> {
    /// Nobody has asked for it yet.
    Unknown,
    /// Being built. Meeting it again means that it depends on itself.
    Busy,
    /// A component that is built.
    Node(NodeId),
    /// A conditional component whose condition is false, or a component that could not be built.
    Absent,
    /// A class, with redeclarations applied.
    Class(ClassRef<'a>),
}

/// A component, an array of components, or a scalar variable.
#[derive(Clone, Debug)]
pub enum InstanceNode {
    /// A scalar variable: index into [`Instance::variables`].
    Var(u32),
    /// An instance of a class that has components.
    Object(ScopeId),
    /// An array. Elements in row-major order.
    Array {
        /// The size along each dimension.
        dims: Vec<usize>,
        /// The index type of each dimension: Integer, Boolean or an enumeration.
        by: Rc<[ScalarType]>,
        /// One node for each element.
        elements: Rc<[NodeId]>,
    },
}

/// Prefixes that a component passes on to its elements, as `flow Complex i` does to `re` and `im`.
#[derive(Clone, Copy, Debug, Default)]
pub struct InheritedPrefixes {
    /// `parameter`, `constant` or `discrete`: the strictest one on the way to the component.
    pub variability: Option<ast::VariabilityPrefix>,
    /// `input` or `output`: the innermost one on the way to the component.
    pub causality: Option<ast::CausalityPrefix>,
    /// Declared `flow`, here or further out.
    pub flow: bool,
    /// Declared `stream`, here or further out.
    pub stream: bool,
    /// Inside a protected element. The annotation `HideResult` overrides it.
    pub hidden: bool,
    /// Inside an element annotated `HideResult = true`.
    pub unwanted: bool,
    /// Inside a port annotated `__bramah_mixes`: its component mixes what flows through.
    pub mixes: bool,
    /// Inside a component that is no connector. Inputs and outputs there are not inputs and outputs of the model.
    pub nested: bool,
}

/// A scalar variable. Binding equation and attributes are kept as written, with the place to look up their names.
pub struct InstanceVariable<'a> {
    /// Full name as the user writes it: `a.b[2].c`.
    pub name: String,
    /// Its type. `Real` stands in for Strings and external objects, see `string` and `object`.
    pub ty: ScalarType,
    /// True for Strings, which have no variable in the flat model.
    pub string: bool,
    /// True for external objects, which have no variable in the flat model either.
    pub object: bool,
    /// Declared variability. Without a prefix, Reals are continuous and all other types discrete (MLS 3.8.4).
    pub variability: Variability,
    /// `input` or `output`, its own or inherited.
    pub causality: Option<ast::CausalityPrefix>,
    /// An input or output of the model itself: declared at its top level or in a public connector there.
    pub top: bool,
    /// Has the prefix `flow`, its own or inherited.
    pub flow: bool,
    /// Has the prefix `stream`, its own or inherited.
    pub stream: bool,
    /// Protected, or hidden by `HideResult = true`.
    pub hidden: bool,
    /// Annotated `HideResult = true`.
    pub unwanted: bool,
    /// Belongs to a port annotated `__bramah_mixes`: what flows in through the connection passes through its component.
    pub mixes: bool,
    /// Declared or modified as `final`. A value from outside is an error.
    pub final_: bool,
    /// A parameter whose value was needed to build the model, for a size or a condition. It is constant in the flat
    /// model.
    pub structural: bool,
    /// A parameter annotated `Evaluate = true`. Conditions of expressions use its value when the model is built.
    pub evaluate: bool,
    /// The binding equation `= value`, or the value given from outside.
    pub binding: Option<Binding<'a>>,
    /// `start`, `fixed`, `min`, `max`, `nominal`, `unit` and so on, at most one entry each: the outermost modifier
    /// wins.
    pub attributes: Vec<(Symbol, Binding<'a>)>,
    /// The attribute `stateSelect`. It is evaluated when the variable is built.
    pub state_select: StateSelect,
    /// The description text of the declaration.
    pub description: Option<&'a str>,
    /// The name in the declaration, for messages.
    pub span: Span,
    /// The instance that declares it.
    pub scope: ScopeId,
    /// Its value, once asked for. `Err` means that it has none and that a message was reported.
    pub constant: Option<Result<ModelicaValue, ()>>,
    /// Its value is being evaluated. Asking again means that it depends on itself.
    pub busy: bool,
    /// Number in the flat model. `u32::MAX` until the tree is complete.
    pub id: VarId,
}

/// A stream variable of a connection set (MLS 15.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamMember {
    /// The stream variable: index into [`Instance::variables`].
    pub variable: u32,
    /// The flow variable of the same connector: index into [`Instance::variables`].
    pub flow: u32,
    /// True for a port of the component that holds the `connect` equations (an outside connector, MLS 9.1.2).
    pub outside: bool,
}

/// Connected stream variables. `flat` fills it in after it has found the connection sets.
#[derive(Default)]
pub struct StreamConnections {
    /// The stream variables of each connection set.
    pub sets: Vec<Vec<StreamMember>>,
    /// The set in which a variable stands as an inside connector: index into `sets`.
    pub inside: FxHashMap<u32, usize>,
    /// Streams of outside connectors that are connected to components inside.
    /// These connections determine what leaves through the port, whatever equations the port's class has.
    pub outside: FxHashSet<u32>,
    /// Streams whose outflow value is the same number at all times, with that number.
    pub constant: FxHashMap<u32, ExprId>,
    /// For each set, the entry of `junctions` at whose node it lies. `None` where the usual mixing rule holds.
    pub at: Vec<Option<usize>>,
    /// Nodes at which one component mixes all that flows in.
    pub junctions: Vec<MixingJunction>,
}

impl StreamConnections {
    /// The junction at whose node a connection set lies. `None` for a set without one.
    pub fn junction(&self, set: usize) -> Option<&MixingJunction> {
        self.at[set].map(|at| &self.junctions[at])
    }
}

/// A node at which one component receives all inflow and supplies all outflow.
/// Its port has the annotation `__bramah_mixes`.
#[derive(Clone, Debug)]
pub struct MixingJunction {
    /// The stream variable of that component: index into [`Instance::variables`].
    pub mixer: u32,
    /// The stream variables of all other components at the node.
    pub others: Vec<StreamMember>,
}

/// An enumeration type.
#[derive(Clone, Debug, PartialEq)]
pub struct EnumerationDefinition {
    /// Full name of the class.
    pub name: String,
    /// Literals in the order of their numbers, which begin at 1.
    pub literals: Vec<Symbol>,
}

/// The component tree of one model, and everything needed to evaluate expressions in it.
///
/// It holds the data. The types of [`views`] borrow it and hold the algorithms.
pub struct Instance<'a, 'l> {
    /// The classes. It grows while names are looked up, because it loads files on demand.
    pub library: &'l mut Library<'a>,
    /// All instances of classes; 0 is the scope of top-level names, 1 usually the model (see `root`).
    pub scopes: Vec<Scope<'a>>,
    /// All components, addressed by [`NodeId`].
    pub nodes: Vec<InstanceNode>,
    /// Scalar variables in the order in which they were built. Building on demand makes it differ from the text.
    pub variables: Vec<InstanceVariable<'a>>,
    /// The variables in declaration order: index by `VarId`, entries are indices into `variables`.
    pub order: Vec<u32>,
    /// The pool of all symbolic expressions. A `VarId` in it is a number of `order`, or a local of a procedure.
    pub exprs: Exprs,
    /// Enumeration types. The predefined ones come first.
    pub enumerations: Vec<EnumerationDefinition>,
    /// The scope of the model itself.
    pub root: ScopeId,
    /// Messages so far, in the order in which they were found.
    pub diagnostics: Vec<Diagnostic>,
    /// Parameters will get other values without another compilation, so their present values must not be built in.
    pub varied: bool,
    /// Connected stream variables; empty until `flat` has found the connection sets.
    pub streams: StreamConnections,
    /// The number of `connect` equations that name each port, for `cardinality`. Empty until the network is known.
    pub connected: FxHashMap<NodeId, u32>,
    /// Components of overconstrained types (MLS 9.4).
    pub overconstrained: overconstrained::OverconstrainedComponents<'a>,
    /// Results of class lookup.
    classes: ClassTable<'a>,
    /// Functions that were called, and what was made of them.
    functions: FunctionTable<'a>,
    /// Values of arrays and properties of expressions.
    values: ValueTable,
    /// What concerns components while they are being built.
    building: BuildingTable<'a>,
    /// Mode and locals of the evaluation that is going on.
    eval: state::EvaluationState,
}

impl<'a> Instance<'a, '_> {
    /// The instance behind an id.
    pub fn scope(&self, id: ScopeId) -> &Scope<'a> {
        &self.scopes[id.0 as usize]
    }

    /// The instance behind an id, to be changed.
    fn scope_mut(&mut self, id: ScopeId) -> &mut Scope<'a> {
        &mut self.scopes[id.0 as usize]
    }

    /// The component behind an id.
    pub fn node(&self, id: NodeId) -> &InstanceNode {
        &self.nodes[id.0 as usize]
    }

    /// Stores a component and returns its id. The caller enters it into its scope.
    fn add_node(&mut self, node: InstanceNode) -> NodeId {
        self.nodes.push(node);
        NodeId(u32::try_from(self.nodes.len() - 1).expect("fewer than 2^32 components"))
    }

    /// The scalar variable behind a number of the flat model. Valid once the variables are numbered.
    pub fn variable(&self, id: VarId) -> &InstanceVariable<'a> {
        &self.variables[self.order[id.index()] as usize]
    }

    /// Runs `act` and returns its result together with the messages that it reported.
    /// The messages are removed from the instance. The caller reports them again or drops them.
    pub fn attempt<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> (T, Vec<Diagnostic>) {
        let before = self.diagnostics.len();
        let done = act(self);
        (done, self.diagnostics.split_off(before))
    }

    /// Adds a message.
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The variability of an expression, which is that of its most variable operand (MLS 3.8).
    ///
    /// The results are kept by the number of the expression. Operands have lower numbers than what uses them.
    ///
    /// - Numbers are constants. Variables have their declared variability, but at most discrete if they are no Reals.
    /// - `time` and derivatives are continuous; `pre(v)`, `sample`, `initial` and `terminal` are discrete.
    /// - Relations with events are at most discrete, because they change only at events.
    /// - Everything else has the highest variability of its operands.
    pub fn variability(&mut self, e: ExprId) -> Variability {
        use bramah_expr::ExprNode as N;
        // Nodes are numbered from operands to users, so one pass upwards finds every operand done.
        while self.values.variabilities.len() <= e.index() {
            let id = ExprId(u32::try_from(self.values.variabilities.len()).expect("fewer than 2^32 nodes"));
            let v = match self.exprs.node(id) {
                N::Num(_) => Variability::Constant,
                N::Time | N::Der(_) => Variability::Continuous,
                N::Var(v) => self.leaf_variability(v),
                N::Pre(_) | N::Sample(..) | N::Initial | N::Terminal => Variability::Discrete,
                // A delayed value also depends on time, unless the delayed expression never changes.
                N::Delay(a, _) if self.values.variabilities[a.index()] > Variability::Parameter => {
                    Variability::Continuous
                }
                // Comparisons and roundings that raise events change at events only, even between continuous operands.
                N::EventRel(..) | N::EventFloor(_) => {
                    let below = self.operand_variability(id);
                    below.min(Variability::Discrete)
                }
                _ => self.operand_variability(id),
            };
            self.values.variabilities.push(v);
        }
        self.values.variabilities[e.index()]
    }

    /// The flow variable of the connector that a stream variable belongs to: index into `variables`.
    ///
    /// The search goes outwards to the nearest connector, because the stream may lie in a record inside of it.
    /// `None` if there is no connector around it, or the connector has no scalar flow variable.
    pub fn stream_flow(&self, variable: u32) -> Option<u32> {
        let mut scope = Some(self.variables[variable as usize].scope);
        while let Some(s) = scope {
            let around = self.scope(s);
            if matches!(around.template.kind, ast::ClassKind::Connector { .. }) {
                return around.elements.iter().find_map(|e| match e {
                    ElementState::Node(n) => match self.node(*n) {
                        InstanceNode::Var(i) if self.variables[*i as usize].flow => Some(*i),
                        _ => None,
                    },
                    _ => None,
                });
            }
            scope = around.owner;
        }
        None
    }

    /// The number that an expression of parameters has with their present values.
    /// `None` if one of them has no known value. Messages about that are dropped.
    /// The parameters become structural; [`Instance::peek`] avoids that.
    pub fn number_of(&mut self, e: ExprId) -> Option<f64> {
        let mut values = Vec::new();
        for v in self.exprs.variables(e) {
            let i = *self.order.get(v.index())?;
            let span = self.variables[i as usize].span;
            let (value, _) = self.attempt(|s| s.parameters().known_value(i, span));
            values.push((self.exprs.var(v), value?.scalar()?.0));
        }
        let number = self.exprs.substitute(e, &values);
        self.exprs.as_num(number)
    }

    /// The present value of variable `i` (index into `variables`) if it is a known number.
    /// Unlike [`Instance::number_of`] it does not make parameters structural. Messages are dropped.
    pub fn peek(&mut self, i: u32) -> Option<f64> {
        let span = self.variables[i as usize].span;
        let (value, _) = self.attempt(|s| s.without_fixing(|s| s.parameters().known_value(i, span)));
        value?.as_number(&self.exprs)
    }

    /// Runs `look` and restores all `structural` marks afterwards.
    fn without_fixing<T>(&mut self, look: impl FnOnce(&mut Self) -> T) -> T {
        let structural: Vec<bool> = self.variables.iter().map(|v| v.structural).collect();
        let found = look(self);
        self.variables.iter_mut().zip(structural).for_each(|(v, was)| v.structural = was);
        found
    }

    /// Whether an expression of parameters gets its value only at initialization.
    /// This is so if it reads a parameter with `fixed = false`, directly or through binding equations (MLS 8.6).
    pub fn found_at_start(&mut self, e: ExprId) -> bool {
        self.exprs.variables(e).into_iter().any(|v| self.parameter_found_at_start(v))
    }

    /// Whether a parameter has `fixed = false` and no binding equation, or a binding equation that reads such a
    /// parameter.
    ///
    /// A known value or another type of variable gives false. Results are kept, because binding equations form long
    /// chains.
    /// Messages of the evaluation are dropped: they appear when somebody needs the value.
    fn parameter_found_at_start(&mut self, v: VarId) -> bool {
        let Some(&i) = self.order.get(v.index()) else { return false };
        let data = &self.variables[i as usize];
        if data.variability != Variability::Parameter || data.string || data.object || data.constant.is_some() {
            return false;
        }
        if let Some(&known) = self.values.found_at_start.get(&v) {
            return known;
        }
        // A circle of parameters ends here, at `false`; evaluating their values reports it.
        self.values.found_at_start.insert(v, false);
        let fixed = data.attributes.iter().find(|(n, _)| *n == "fixed").cloned();
        // A binding equation determines the parameter whatever `fixed` says, so it is looked at first.
        let found = match (data.binding.clone(), fixed) {
            (Some(b), _) => {
                let (value, _) = self.attempt(|s| s.parameters().bound(i, &b, false));
                let scalar = value.and_then(|v| v.scalar());
                scalar.is_some_and(|(e, _)| self.found_at_start(e))
            }
            (None, Some((name, b))) => self.parameters().known_attribute(i, name, &b, ScalarType::Boolean) == Some(0.0),
            (None, None) => false,
        };
        self.values.found_at_start.insert(v, found);
        found
    }

    /// Variability of a variable; at most discrete if it is not a Real (MLS 3.8.4).
    fn leaf_variability(&self, v: VarId) -> Variability {
        // Numbers past the flat variables are locals of a function being translated.
        if v.index() >= self.order.len() {
            return Variability::Continuous;
        }
        let data = self.variable(v);
        if data.ty != ScalarType::Real { data.variability.min(Variability::Discrete) } else { data.variability }
    }

    /// The highest variability among the operands; constant if there are none. Their own must be known already.
    fn operand_variability(&self, e: ExprId) -> Variability {
        let operands = self.exprs.operands(e);
        operands.as_slice().iter().map(|o| self.values.variabilities[o.index()]).max().unwrap_or(Variability::Constant)
    }

    /// The name of a component as the user writes it. An array has the name of its first element without the
    /// subscripts.
    pub fn node_name(&self, node: NodeId) -> String {
        match self.node(node) {
            InstanceNode::Var(i) => self.variables[*i as usize].name.clone(),
            InstanceNode::Object(s) => self.scope(*s).name.clone(),
            InstanceNode::Array { elements, .. } => {
                let first = elements.first().map_or(String::new(), |&e| self.node_name(e));
                // An empty array has no element to take a name from, and gives an empty text.
                first.rsplit_once('[').map_or(first.clone(), |(head, _)| head.to_string())
            }
        }
    }
}
