//! Ports and components that connections and operators such as `inStream(a.b.c)` name.
//!
//! `flat` asks for the components themselves here, not for their values.

use crate::instance::evaluation::references::{NodeSelection, ReferenceTarget};
use crate::instance::lookup::LookupResult;
use crate::instance::{ElementState, Evaluator, InstanceNode, LookupContext, NodeId, ScopeId};
use bramah_syntax::ast::ComponentReference;
use bramah_syntax::diag::Code;
use bramah_syntax::symbol::Symbol;

impl<'a> Evaluator<'_, 'a, '_> {
    /// The ports that a reference in a `connect` equation names, beginning with element `index` of `scope`.
    ///
    /// `None` after a message. `Some(None)` if a conditional component on the way is absent: the connection is then
    /// removed (MLS 4.4.5).
    ///
    /// `view` is the place of the equation, where names in subscripts are looked up.
    /// A subscript of a port must be known when the model is built; a changing one is an error.
    /// The ports are in row-major order.
    pub fn port_selection(
        &mut self,
        r: &'a ComponentReference,
        scope: ScopeId,
        index: u32,
        view: LookupContext,
    ) -> Option<Option<NodeSelection>> {
        let Some(node) = self.instance.builder().component(scope, index) else {
            // An absent component and one that could not be built look alike except for this state.
            let absent = matches!(self.instance.scope(scope).elements[index as usize], ElementState::Absent);
            return absent.then_some(None);
        };
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate() {
            if i > 0 {
                if self.any_absent(&at, p.name.name) {
                    return Some(None);
                }
                match self.descend(&at, p) {
                    ReferenceTarget::Nodes(next) => at = next,
                    _ => return None,
                }
            }
            if !p.subscripts.is_empty() {
                match self.subscript_selection(&at, p, view, r.span)? {
                    Ok(next) => at = next,
                    Err(()) => {
                        return self.instance.fail(
                            Code::NotConstant,
                            "the index of a port must be known before the run",
                            r.span,
                        );
                    }
                }
            }
        }
        Some(Some(at))
    }

    /// The one component that a reference names. `None`, without a message, if it names none or several.
    /// It serves functions such as `cardinality` and `Connections.isRoot`, which take one connector.
    /// Subscripts must be known and select one element.
    pub(in crate::instance) fn named_node(&mut self, r: &'a ComponentReference, view: LookupContext) -> Option<NodeId> {
        let from = if r.global { crate::instance::ROOT } else { view };
        let LookupResult::Component(scope, index) = self.instance.names().lookup(from, r.parts[0].name.name)? else {
            return None;
        };
        let mut node = self.instance.builder().component(scope, index)?;
        for (i, part) in r.parts.iter().enumerate() {
            if i > 0 {
                let InstanceNode::Object(s) = *self.instance.node(node) else { return None };
                let index = *self.instance.scope(s).template.by_name.get(&part.name.name)?;
                node = self.instance.builder().component(s, index)?;
            }
            if !part.subscripts.is_empty() {
                let at = self.selection(node);
                let [one] = self.subscript_selection(&at, part, view, r.span)?.ok()?.nodes[..] else { return None };
                node = one;
            }
        }
        Some(node)
    }

    /// Whether an element of this name is absent in one of the selected components.
    pub(in crate::instance) fn any_absent(&mut self, at: &NodeSelection, name: Symbol) -> bool {
        at.nodes.iter().any(|&n| {
            let InstanceNode::Object(s) = *self.instance.node(n) else { return false };
            let Some(&i) = self.instance.scope(s).template.by_name.get(&name) else { return false };
            matches!(self.instance.scope(s).elements[i as usize], ElementState::Absent)
        })
    }
}
