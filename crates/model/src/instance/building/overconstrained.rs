//! Overconstrained connectors (MLS 9.4), such as those with orientations.
//!
//! Their types have more variables than degrees of freedom, and a function `equalityConstraint` that tells when two
//! values are equal. Components of such types are noted here while the tree is built. The network finds which
//! connections need the constraint, and `flat` asks here for its equations.

use crate::instance::algorithm::AlgorithmCall;
use crate::instance::call::Callee;
use crate::instance::lookup::LookupResult;
use crate::instance::template::{Template, TemplateElementKind};
use crate::instance::value::ModelicaValue;
use crate::instance::{ClassRef, ComponentBuilder, ElementState, InstanceNode, LookupContext, NodeId};
use bramah_expr::types::ScalarType;
use bramah_expr::{ExprId, Exprs};
use bramah_syntax::ast::{self, Expr, ExprKind};
use bramah_syntax::diag::{Code, Span};
use bramah_syntax::symbol::Symbol;
use indexmap::IndexMap;
use rustc_hash::{FxBuildHasher, FxHashSet};

/// The function that tells when two values of the type are equal.
const CONSTRAINT: &str = "equalityConstraint";

/// The overconstrained components of a model, and what the network has found about them.
pub struct OverconstrainedComponents<'a> {
    /// The symbol of `equalityConstraint`, made once.
    name: Symbol,
    /// All these components in the order in which they were built.
    /// Variables and arrays come with their class; records know it from their scope.
    nodes: IndexMap<NodeId, Option<ClassRef<'a>>, FxBuildHasher>,
    /// The roots of the connection graphs, for `Connections.isRoot`. Empty until the network is known.
    pub roots: FxHashSet<NodeId>,
    /// First sides of branches that are nearer to the root than the second sides, for `Connections.rooted`.
    pub rooted: FxHashSet<NodeId>,
}

/// The equations that make two overconstrained components equal.
pub struct EqualityResidue {
    /// Expressions that must be 0: the outputs of `equalityConstraint`.
    pub values: Vec<ExprId>,
    /// Assertions in that function, to be checked during the run.
    pub asserts: Vec<AlgorithmCall>,
}

impl Default for OverconstrainedComponents<'_> {
    fn default() -> Self {
        OverconstrainedComponents {
            name: Symbol::new(CONSTRAINT),
            nodes: IndexMap::default(),
            roots: FxHashSet::default(),
            rooted: FxHashSet::default(),
        }
    }
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Notes a component whose type has an `equalityConstraint`. For an array of records each element is noted.
    ///
    /// `one` is true if the declaration has no dimensions: an array then comes from the type and is one value.
    /// `found` is the class of the component, `template` its elements.
    /// A type without the function is left out at once.
    pub(in crate::instance) fn note_constraints(
        &mut self,
        node: NodeId,
        one: bool,
        found: &LookupResult<'a>,
        template: &Template<'a>,
    ) {
        let at = template.by_name.get(&self.instance.overconstrained.name);
        // The name of the function is compared as a symbol, because this runs for every component.
        if !at.is_some_and(|&i| matches!(template.elements[i as usize].kind, TemplateElementKind::Class(_))) {
            return;
        }
        // Objects know their class from their scope; for the others it is stored.
        let class = match found {
            LookupResult::Class(class) => template.builtin.map(|_| class.clone()),
            _ => None,
        };
        let nodes = match self.instance.node(node) {
            InstanceNode::Array { elements, .. } if !one => elements.to_vec(),
            _ => vec![node],
        };
        for node in nodes {
            self.instance.overconstrained.nodes.insert(node, class.clone());
        }
    }

    /// Whether a component is overconstrained.
    pub fn is_overconstrained(&self, node: NodeId) -> bool {
        self.instance.overconstrained.nodes.contains_key(&node)
    }

    /// The function `equalityConstraint` of a component. `None` if it has none.
    /// An array or variable gets it from the class that was noted with it.
    fn constraint_of(&mut self, node: NodeId) -> Option<ClassRef<'a>> {
        let name = self.instance.overconstrained.name;
        let found = match *self.instance.node(node) {
            InstanceNode::Object(scope) => self.instance.names().lookup(LookupContext { scope, base: 0 }, name),
            _ => {
                let class = self.instance.overconstrained.nodes.get(&node)?.clone()?;
                self.instance.names().member(&LookupResult::Class(class), name)
            }
        };
        match found {
            Some(LookupResult::Class(function)) => Some(function),
            _ => None,
        }
    }

    /// The equations for equality of two overconstrained components. `None` after a message.
    /// `span` is the connection.
    ///
    /// ```text
    /// connect(a.frame, b.frame);   // equalityConstraint(a.frame.R, b.frame.R) = zeros(3)
    /// ```
    /// Assertions in the function are not evaluated now: they are checked during the run.
    pub fn constraint_residue(&mut self, a: NodeId, b: NodeId, span: Span) -> Option<EqualityResidue> {
        let function = self.constraint_of(a)?;
        let values =
            vec![self.instance.evaluator().node_value(a, span)?, self.instance.evaluator().node_value(b, span)?];
        let template = self.instance.names().template(function.class, function.parent);
        let name = self.instance.library.full_name(function.class);
        let callee = Callee { scope: self.instance.names().package(&function), template, name };
        // Assertions of the function are collected behind what others have collected.
        let mark = self.instance.eval.calls.len();
        let value = self
            .instance
            .in_mode(|m| m.keep_asserts = true, |s| s.calls().call_function(&callee, values, Vec::new(), span));
        let asserts = self.instance.eval.calls.split_off(mark);
        let mut values = Vec::new();
        value?.scalars(&mut values);
        Some(EqualityResidue { values, asserts })
    }

    /// The number of equations for equality of two such components: the size of the function's output.
    /// `None` if it is not known, as with an output declared with `:`.
    /// Its dimensions are evaluated at the place of the function.
    fn constraint_size(&mut self, node: NodeId) -> Option<usize> {
        let function = self.constraint_of(node)?;
        let template = self.instance.names().template(function.class, function.parent);
        let scope = self.instance.names().package(&function);
        let output = template.elements.iter().find_map(|e| match e.kind {
            TemplateElementKind::Component(c) if c.prefix.causality == Some(ast::CausalityPrefix::Output) => {
                Some((c, e.base))
            }
            _ => None,
        });
        let (output, base) = output?;
        let mut size = 1;
        for s in &output.subscripts {
            let ast::Subscript::Expr(e) = s else { return None };
            size *= self.instance.evaluator().dimension(e, LookupContext { scope, base })?;
        }
        Some(size)
    }

    /// The variables of each overconstrained component, with the number of its equality equations.
    /// The number of variables is used if the output of the function has no known size.
    pub fn constraint_sizes(&mut self) -> Vec<(Vec<u32>, usize)> {
        let mut found = Vec::new();
        for k in 0..self.instance.overconstrained.nodes.len() {
            let (&node, _) = self.instance.overconstrained.nodes.get_index(k).expect("counted");
            let mut variables = Vec::new();
            self.variables_of(node, &mut variables);
            // Without a known size each variable counts as one equation.
            let size = self.constraint_size(node).unwrap_or(variables.len());
            found.push((variables, size));
        }
        found
    }

    /// Collects the variables of a component in the order of its elements.
    /// Elements that are absent or are classes have no variables.
    fn variables_of(&self, node: NodeId, found: &mut Vec<u32>) {
        match self.instance.node(node) {
            InstanceNode::Var(i) => found.push(*i),
            InstanceNode::Array { elements, .. } => elements.iter().for_each(|&e| self.variables_of(e, found)),
            InstanceNode::Object(s) => {
                for e in &self.instance.scope(*s).elements {
                    if let ElementState::Node(n) = e {
                        self.variables_of(*n, found);
                    }
                }
            }
        }
    }

    /// `Connections.isRoot(R)` or `Connections.rooted(R)` (MLS 9.4.1). `None` after a message.
    /// The answer is a constant, which is false until the network is known.
    ///
    /// ```text
    /// if Connections.isRoot(frame.R) then ... end if;
    /// ```
    pub(in crate::instance) fn connection_query(
        &mut self,
        name: &str,
        args: &'a [Expr],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let [arg] = args else {
            return self.instance.fail(Code::BadCall, &format!("`{name}` takes one overconstrained component"), span);
        };
        let node = self.overconstrained_node(arg, view)?;
        let found = &self.instance.overconstrained;
        let holds = if name == "isRoot" { found.roots.contains(&node) } else { found.rooted.contains(&node) };
        Some(ModelicaValue::Scalar(if holds { Exprs::ONE } else { Exprs::ZERO }, ScalarType::Boolean))
    }

    /// The overconstrained component that an argument names. `None` after a message.
    /// Any other expression than a reference to one such component is an error.
    pub fn overconstrained_node(&mut self, e: &'a Expr, view: LookupContext) -> Option<NodeId> {
        let node = match &e.kind {
            ExprKind::Reference(r) => {
                self.instance.evaluator().named_node(r, view).filter(|&n| self.is_overconstrained(n))
            }
            _ => None,
        };
        if node.is_some() {
            return node;
        }
        self.instance.fail(Code::BadConnect, "this is no component of a type with an `equalityConstraint`", e.span)
    }
}
