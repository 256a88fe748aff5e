//! Overconstrained connectors (MLS 9.4): types whose values depend on each other, such as an orientation, and that say by a
//! function `equalityConstraint` when two of them are equal. `network` finds out which connections need it.

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

/// The function by which a type says when two of its values are equal.
const CONSTRAINT: &str = "equalityConstraint";

/// The overconstrained components of a model, and what the network says of them.
pub struct OverconstrainedComponents<'a> {
    /// `equalityConstraint`
    name: Symbol,
    /// All of them, with the classes of those that are variables and arrays; records know theirs themselves.
    nodes: IndexMap<NodeId, Option<ClassRef<'a>>, FxBuildHasher>,
    /// Roots of the connection graph, once the network is known.
    pub roots: FxHashSet<NodeId>,
    /// First sides of branches that are nearer to the root than their second sides.
    pub rooted: FxHashSet<NodeId>,
}

/// When two overconstrained components are equal.
pub struct EqualityResidue {
    /// All are zero.
    pub values: Vec<ExprId>,
    /// What must hold besides.
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
    /// Remembers a component of a type with a constraint, or all of an array of such records.
    pub(in crate::instance) fn note_constraints(
        &mut self,
        node: NodeId,
        one: bool,
        found: &LookupResult<'a>,
        template: &Template<'a>,
    ) {
        let at = template.by_name.get(&self.instance.overconstrained.name);
        if !at.is_some_and(|&i| matches!(template.elements[i as usize].kind, TemplateElementKind::Class(_))) {
            return;
        }
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

    /// The constraint function of a component.
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

    /// What holds where two overconstrained components are equal; `None` after a message.
    pub fn constraint_residue(&mut self, a: NodeId, b: NodeId, span: Span) -> Option<EqualityResidue> {
        let function = self.constraint_of(a)?;
        let values =
            vec![self.instance.evaluator().node_value(a, span)?, self.instance.evaluator().node_value(b, span)?];
        let template = self.instance.names().template(function.class, function.parent);
        let name = self.instance.library.full_name(function.class);
        let callee = Callee { scope: self.instance.names().package(&function), template, name };
        let mark = self.instance.eval.calls.len();
        let value = self
            .instance
            .in_mode(|m| m.keep_asserts = true, |s| s.calls().call_function(&callee, values, Vec::new(), span));
        let asserts = self.instance.eval.calls.split_off(mark);
        let mut values = Vec::new();
        value?.scalars(&mut values);
        Some(EqualityResidue { values, asserts })
    }

    /// The number of equations that equality of two such components means: the size of the function's output.
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

    /// The variables of all overconstrained components, each with the size of their constraint.
    pub fn constraint_sizes(&mut self) -> Vec<(Vec<u32>, usize)> {
        let mut found = Vec::new();
        for k in 0..self.instance.overconstrained.nodes.len() {
            let (&node, _) = self.instance.overconstrained.nodes.get_index(k).expect("counted");
            let mut variables = Vec::new();
            self.variables_of(node, &mut variables);
            let size = self.constraint_size(node).unwrap_or(variables.len());
            found.push((variables, size));
        }
        found
    }

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

    /// `Connections.isRoot(R)` and `Connections.rooted(R)`.
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

    /// The overconstrained component that an argument names, or a message.
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
