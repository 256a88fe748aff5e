//! Numbers of variables in the flat model, in declaration order.

use crate::instance::template::TemplateElementKind;
use crate::instance::{ComponentBuilder, ElementState, InstanceNode, NodeId, ScopeId};
use bramah_expr::VarId;

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Gives every variable its number: declaration order, depth first.
    pub(in crate::instance) fn number_variables(&mut self) {
        let mut order = Vec::with_capacity(self.instance.variables.len());
        self.number_scope(self.instance.root, &mut order);
        for i in 0..u32::try_from(self.instance.variables.len()).expect("limited above") {
            // Automatic `inner` components come last; constants of packages stand by their values.
            if self.instance.variables[i as usize].id.0 == u32::MAX
                && self.is_in_model(self.instance.variables[i as usize].scope)
            {
                self.number_variable(i, &mut order);
            }
        }
        self.instance.order = order;
    }

    pub(in crate::instance) fn is_in_model(&self, mut scope: ScopeId) -> bool {
        while let Some(owner) = self.instance.scope(scope).owner {
            scope = owner;
        }
        scope == self.instance.root
    }

    pub(in crate::instance) fn number_variable(&mut self, i: u32, order: &mut Vec<u32>) {
        let data = &mut self.instance.variables[i as usize];
        if data.id.0 == u32::MAX && !data.string && !data.object {
            data.id = VarId(u32::try_from(order.len()).expect("limited above"));
            order.push(i);
        }
    }

    pub(in crate::instance) fn number_scope(&mut self, scope: ScopeId, order: &mut Vec<u32>) {
        for i in 0..self.instance.scope(scope).elements.len() {
            let s = self.instance.scope(scope);
            let outer = matches!(s.template.elements[i].kind, TemplateElementKind::Component(c) if c.prefixes.outer);
            if let (ElementState::Node(node), false) = (&s.elements[i], outer) {
                self.number_node(*node, order);
            }
        }
    }

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
