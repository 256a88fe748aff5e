//! From a class to the component tree with its modifiers: every scalar variable, with its attributes still as written.
//!
//! [`instantiate`] builds the tree; [`Instance`] is also the place where expressions are evaluated, because names have
//! a meaning only inside an instance. The rooms: [`tree`] (what a class holds, which modifier reaches which element, names),
//! [`building`] (components), [`evaluation`] (expressions and statements, in a mode and a frame), `calls` (built-in
//! functions, user functions, procedures, functions of C code that Rust knows).

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

/// Index of a [`Scope`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ScopeId(pub u32);

/// Index of a [`InstanceNode`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// Where names are looked up: in an instance, as seen from one of the classes it is made of.
///
/// Base 0 is the instance's own class; the others are the classes it extends. A name written in a base class means an
/// element of the instance if that base knows it, else something around the base class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LookupContext {
    /// The instance.
    pub scope: ScopeId,
    /// The base class: index into `Template::bases`.
    pub base: u32,
}

/// The scope of top-level names.
pub const ROOT: LookupContext = LookupContext { scope: ScopeId(0), base: 0 };

/// A class as found by name: the text, where it stands, and what modifies it.
#[derive(Clone)]
pub struct ClassRef<'a> {
    /// The class.
    pub class: ClassId,
    /// Where names in it are looked up after its own elements.
    pub parent: LookupContext,
    /// Modifications, outermost first (of a redeclared or replaceable class).
    pub args: Rc<[Modifier<'a>]>,
}

/// An instance of a class: a component, a package or a function's body.
pub struct Scope<'a> {
    /// What the class holds.
    pub template: Rc<Template<'a>>,
    /// Full dotted name of the component, class name of a package.
    pub name: String,
    /// Modifications of elements, outermost first.
    pub args: Rc<[Modifier<'a>]>,
    /// Value of the whole instance, for records.
    pub binding: Option<Binding<'a>>,
    /// The instance it is a component of.
    pub owner: Option<ScopeId>,
    /// The state of each element.
    pub elements: Vec<ElementState<'a>>,
    /// Inherited prefixes.
    pub prefix: InheritedPrefixes,
    /// Where the component is declared.
    pub span: Span,
    /// True for component instances, false for packages and functions.
    pub component: bool,
}

/// What an element of a scope has become so far.
#[derive(Clone)]
pub enum ElementState<'a> {
    /// Not looked at yet.
    Unknown,
    /// Being built; meeting it again means a circle.
    Busy,
    /// A component.
    Node(NodeId),
    /// A conditional component that is not there.
    Absent,
    /// A class.
    Class(ClassRef<'a>),
}

/// A component, an array of components, or a scalar variable.
#[derive(Clone, Debug)]
pub enum InstanceNode {
    /// A scalar variable: index into `Instance::variables`.
    Var(u32),
    /// An instance of a class.
    Object(ScopeId),
    /// An array. Elements in row-major order.
    Array {
        /// Sizes.
        dims: Vec<usize>,
        /// What counts along each dimension: Integers, truth values or the literals of an enumeration.
        by: Rc<[ScalarType]>,
        /// Elements.
        elements: Rc<[NodeId]>,
    },
}

/// Prefixes that a component passes on to its elements.
#[derive(Clone, Copy, Debug, Default)]
pub struct InheritedPrefixes {
    /// parameter, constant, discrete
    pub variability: Option<ast::VariabilityPrefix>,
    /// input, output
    pub causality: Option<ast::CausalityPrefix>,
    /// flow
    pub flow: bool,
    /// stream
    pub stream: bool,
    /// Inside a protected element.
    pub hidden: bool,
    /// Inside an element annotated `HideResult`.
    pub unwanted: bool,
    /// Inside a port annotated `__bramah_mixes`.
    pub mixes: bool,
    /// Below a component that is not at the top level.
    pub nested: bool,
}

/// A scalar variable with its attributes as written.
pub struct InstanceVariable<'a> {
    /// Full name.
    pub name: String,
    /// Type.
    pub ty: ScalarType,
    /// True for String parameters, which have no place in the flat model.
    pub string: bool,
    /// True for external objects, which have none either.
    pub object: bool,
    /// Declared variability; `Continuous` when nothing is said.
    pub variability: Variability,
    /// input, output
    pub causality: Option<ast::CausalityPrefix>,
    /// A top-level input or output.
    pub top: bool,
    /// `flow`
    pub flow: bool,
    /// `stream`
    pub stream: bool,
    /// protected or hidden
    pub hidden: bool,
    /// annotated `HideResult`
    pub unwanted: bool,
    /// in a port annotated `__bramah_mixes`: what flows through the connection passes through its component
    pub mixes: bool,
    /// Final, so not to be set from outside.
    pub final_: bool,
    /// Its value was needed to build the model.
    pub structural: bool,
    /// A parameter annotated `Evaluate`: conditions of expressions take its value when the model is built.
    pub evaluate: bool,
    /// `= value`
    pub binding: Option<Binding<'a>>,
    /// start, fixed, min, max, nominal, unit, ... as written, outermost first.
    pub attributes: Vec<(Symbol, Binding<'a>)>,
    /// stateSelect
    pub state_select: StateSelect,
    /// Description.
    pub description: Option<&'a str>,
    /// Place of the declaration.
    pub span: Span,
    /// The instance that holds it.
    pub scope: ScopeId,
    /// Value as far as it had to be known.
    pub constant: Option<Result<ModelicaValue, ()>>,
    /// Being evaluated.
    pub busy: bool,
    /// Number in the flat model, given after the tree is complete.
    pub id: VarId,
}

/// A stream variable of a connection set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamMember {
    /// The variable: index into `Instance::variables`.
    pub variable: u32,
    /// The flow of its connector.
    pub flow: u32,
    /// A port of the component itself, seen from inside.
    pub outside: bool,
}

/// Joined stream variables, known once the network is.
#[derive(Default)]
pub struct StreamConnections {
    /// The connection sets.
    pub sets: Vec<Vec<StreamMember>>,
    /// The set in which a variable is a part's port.
    pub inside: FxHashMap<u32, usize>,
    /// Streams of ports that are joined to parts inside: these say what leaves there, whatever the port's class gives.
    pub outside: FxHashSet<u32>,
    /// Streams that always leave with the same number.
    pub constant: FxHashMap<u32, ExprId>,
    /// For each set the one of `junctions` at whose node it lies.
    pub at: Vec<Option<usize>>,
    /// Nodes with a component through which passes what flows there.
    pub junctions: Vec<MixingJunction>,
}

impl StreamConnections {
    /// The junction at whose node a connection set lies.
    pub fn junction(&self, set: usize) -> Option<&MixingJunction> {
        self.at[set].map(|at| &self.junctions[at])
    }
}

/// A node of which one component takes in all that comes, and gives all that leaves.
#[derive(Clone, Debug)]
pub struct MixingJunction {
    /// The stream of that component.
    pub mixer: u32,
    /// The ports of all other components at the node.
    pub others: Vec<StreamMember>,
}

/// An enumeration type.
#[derive(Clone, Debug, PartialEq)]
pub struct EnumerationDefinition {
    /// Full name.
    pub name: String,
    /// Literals.
    pub literals: Vec<Symbol>,
}

/// The component tree of one model, and everything needed to evaluate expressions in it.
pub struct Instance<'a, 'l> {
    /// Where classes come from.
    pub library: &'l mut Library<'a>,
    /// Instances; 0 is the scope of top-level names, 1 the model.
    pub scopes: Vec<Scope<'a>>,
    /// Components.
    pub nodes: Vec<InstanceNode>,
    /// Scalar variables in the order in which they were met.
    pub variables: Vec<InstanceVariable<'a>>,
    /// Variables in declaration order: `VarId` -> index into `variables`.
    pub order: Vec<u32>,
    /// All expressions.
    pub exprs: Exprs,
    /// Enumeration types.
    pub enumerations: Vec<EnumerationDefinition>,
    /// The model itself.
    pub root: ScopeId,
    /// Messages so far.
    pub diagnostics: Vec<Diagnostic>,
    /// Parameters will take other values without compiling again.
    pub varied: bool,
    /// Joined stream variables.
    pub streams: StreamConnections,
    /// How many connections name each port, once the network is known.
    pub connected: FxHashMap<NodeId, u32>,
    /// Overconstrained connectors.
    pub overconstrained: overconstrained::OverconstrainedComponents<'a>,
    classes: ClassTable<'a>,
    functions: FunctionTable<'a>,
    values: ValueTable,
    building: BuildingTable<'a>,
    eval: state::EvaluationState,
}

impl<'a> Instance<'a, '_> {
    /// The instance behind an id.
    pub fn scope(&self, id: ScopeId) -> &Scope<'a> {
        &self.scopes[id.0 as usize]
    }

    fn scope_mut(&mut self, id: ScopeId) -> &mut Scope<'a> {
        &mut self.scopes[id.0 as usize]
    }

    /// The component behind an id.
    pub fn node(&self, id: NodeId) -> &InstanceNode {
        &self.nodes[id.0 as usize]
    }

    fn add_node(&mut self, node: InstanceNode) -> NodeId {
        self.nodes.push(node);
        NodeId(u32::try_from(self.nodes.len() - 1).expect("fewer than 2^32 components"))
    }

    /// The scalar variable behind a number of the flat model.
    pub fn variable(&self, id: VarId) -> &InstanceVariable<'a> {
        &self.variables[self.order[id.index()] as usize]
    }

    /// Does something that may fail without harm: its messages are handed back, to be kept or dropped.
    pub fn attempt<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> (T, Vec<Diagnostic>) {
        let before = self.diagnostics.len();
        let done = act(self);
        (done, self.diagnostics.split_off(before))
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// When an expression may change.
    pub fn variability(&mut self, e: ExprId) -> Variability {
        use bramah_expr::ExprNode as N;
        while self.values.variabilities.len() <= e.index() {
            let id = ExprId(u32::try_from(self.values.variabilities.len()).expect("fewer than 2^32 nodes"));
            let v = match self.exprs.node(id) {
                N::Num(_) => Variability::Constant,
                N::Time | N::Der(_) => Variability::Continuous,
                N::Var(v) => self.leaf_variability(v),
                N::Pre(_) | N::Sample(..) | N::Initial | N::Terminal => Variability::Discrete,
                N::Delay(a, _) if self.values.variabilities[a.index()] > Variability::Parameter => {
                    Variability::Continuous
                }
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

    /// The flow variable of the connector that a stream variable belongs to.
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

    /// The number that an expression of parameters has with their present values, if these can be told.
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

    /// The number that a parameter has, if it can be told, without fixing it.
    pub fn peek(&mut self, i: u32) -> Option<f64> {
        let span = self.variables[i as usize].span;
        let (value, _) = self.attempt(|s| s.without_fixing(|s| s.parameters().known_value(i, span)));
        value?.as_number(&self.exprs)
    }

    /// Looks at values of parameters without fixing any with the structure.
    fn without_fixing<T>(&mut self, look: impl FnOnce(&mut Self) -> T) -> T {
        let structural: Vec<bool> = self.variables.iter().map(|v| v.structural).collect();
        let found = look(self);
        self.variables.iter_mut().zip(structural).for_each(|(v, was)| v.structural = was);
        found
    }

    /// Whether a value that stays the same through the run is only found at its start: it reads a parameter with
    /// `fixed = false`, which initial equations determine.
    pub fn found_at_start(&mut self, e: ExprId) -> bool {
        self.exprs.variables(e).into_iter().any(|v| self.parameter_found_at_start(v))
    }

    fn parameter_found_at_start(&mut self, v: VarId) -> bool {
        let Some(&i) = self.order.get(v.index()) else { return false };
        let data = &self.variables[i as usize];
        if data.variability != Variability::Parameter || data.string || data.object || data.constant.is_some() {
            return false;
        }
        if let Some(&known) = self.values.found_at_start.get(&v) {
            return known;
        }
        // a circle of parameters has a message of its own
        self.values.found_at_start.insert(v, false);
        let fixed = data.attributes.iter().find(|(n, _)| *n == "fixed").cloned();
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

    fn leaf_variability(&self, v: VarId) -> Variability {
        // Numbers past the flat variables are locals of a function being translated.
        if v.index() >= self.order.len() {
            return Variability::Continuous;
        }
        let data = self.variable(v);
        if data.ty != ScalarType::Real { data.variability.min(Variability::Discrete) } else { data.variability }
    }

    fn operand_variability(&self, e: ExprId) -> Variability {
        let operands = self.exprs.operands(e);
        operands.as_slice().iter().map(|o| self.values.variabilities[o.index()]).max().unwrap_or(Variability::Constant)
    }

    /// The name of a component as the user knows it.
    pub fn node_name(&self, node: NodeId) -> String {
        match self.node(node) {
            InstanceNode::Var(i) => self.variables[*i as usize].name.clone(),
            InstanceNode::Object(s) => self.scope(*s).name.clone(),
            InstanceNode::Array { elements, .. } => {
                let first = elements.first().map_or(String::new(), |&e| self.node_name(e));
                first.rsplit_once('[').map_or(first.clone(), |(head, _)| head.to_string())
            }
        }
    }
}
