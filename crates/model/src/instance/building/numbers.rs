//! Numbers of variables in the flat model.
//!
//! After the tree is complete, each scalar variable gets its `VarId` in declaration order, depth first.
//! The order does not depend on the order in which components were built on demand.

use crate::instance::template::TemplateElementKind;
use crate::instance::{ComponentBuilder, ElementState, InstanceNode, NodeId, ScopeId};
use bramah_expr::VarId;

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Numbers all variables of the model and fills `Instance::order`.
    /// Strings and external objects get no number. `Instance::variable` works afterwards.
    pub(in crate::instance) fn number_variables(&mut self) {
        let mut order = Vec::with_capacity(self.instance.variables.len());
        self.number_scope(self.instance.root, &mut order);
        for i in 0..u32::try_from(self.instance.variables.len()).expect("limited above") {
            // `inner` components that were added come last. Constants of packages get no number; their values are used
            // instead.
            if self.instance.variables[i as usize].id.0 == u32::MAX
                && self.is_in_model(self.instance.variables[i as usize].scope)
            {
                self.number_variable(i, &mut order);
            }
        }
        self.instance.order = order;
    }

    /// Whether a scope is the model or lies in it. Packages and functions do not.
    pub(in crate::instance) fn is_in_model(&self, mut scope: ScopeId) -> bool {
        while let Some(owner) = self.instance.scope(scope).owner {
            scope = owner;
        }
        scope == self.instance.root
    }

    /// Gives a variable the next number and appends it to `order`.
    /// Strings, external objects and variables with a number are skipped.
    pub(in crate::instance) fn number_variable(&mut self, i: u32, order: &mut Vec<u32>) {
        let data = &mut self.instance.variables[i as usize];
        if data.id.0 == u32::MAX && !data.string && !data.object {
            data.id = VarId(u32::try_from(order.len()).expect("limited above"));
            order.push(i);
        }
    }

    /// Numbers the variables of a scope, in the order of its elements.
    /// An `outer` element is skipped: its variables are numbered where the `inner` component is declared.
    pub(in crate::instance) fn number_scope(&mut self, scope: ScopeId, order: &mut Vec<u32>) {
        for i in 0..self.instance.scope(scope).elements.len() {
            let s = self.instance.scope(scope);
            let outer = matches!(s.template.elements[i].kind, TemplateElementKind::Component(c) if c.prefixes.outer);
            if let (ElementState::Node(node), false) = (&s.elements[i], outer) {
                self.number_node(*node, order);
            }
        }
    }

    /// Numbers the variables of a component: array elements in row-major order, elements of objects in declaration
    /// order.
    pub(in crate::instance) fn number_node(&mut self, node: NodeId, order: &mut Vec<u32>) {
        match self.instance.node(node) {
            InstanceNode::Var(i) => self.number_variable(*i, order),
            InstanceNode::Object(scope) => self.number_scope(*scope, order),
            InstanceNode::Array { elements, .. } => {
                for &e in elements.clone().iter() {
                    self.number_node(e, order);
                }
            }
        }
    }
}
