//! Expandable connectors (MLS 9.1.3): what is connected to a name that a bus does not have becomes a member of it, and buses
//! that are joined have the same members.

use crate::instance::components::ComponentPlan;
use crate::instance::deduce::LoopBody;
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::modifiers::ElementModifiers;
use crate::instance::template::{TemplateElement, TemplateElementKind};
use crate::instance::{
    ClassRef, ComponentBuilder, ElementState, InheritedPrefixes, InstanceNode, LookupContext, NodeId, ScopeId,
};
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{self, ClassBody, Equation, EquationKind, Expr, ExprKind};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// Times that members travel from bus to bus; more than any chain of buses is long.
const ROUNDS: usize = 100;

/// One side of a connection.
enum ExpandableSide {
    /// A member that a bus lacks.
    Missing(ScopeId, Symbol),
    /// A bus.
    Bus(ScopeId),
    /// Another port.
    Port(NodeId),
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Gives all buses the members that connections ask for.
    pub(in crate::instance) fn expand_connectors(&mut self) {
        if !self.instance.scopes.iter().any(|s| s.component && s.template.is_expandable()) {
            return;
        }
        for _ in 0..ROUNDS {
            let before = self.instance.nodes.len();
            let scopes = (0u32..).zip(&self.instance.scopes).filter(|(_, s)| s.component).map(|(i, _)| ScopeId(i));
            for scope in scopes.collect::<Vec<_>>() {
                let template = self.instance.scope(scope).template.clone();
                for (base, i) in template.bases.iter().zip(0u32..) {
                    if let ClassBody::Long(body) = &base.ast.body {
                        self.expand_by(&body.equations, LookupContext { scope, base: i });
                    }
                }
            }
            if self.instance.nodes.len() == before {
                return;
            }
        }
    }

    fn expand_by(&mut self, equations: &'a [Equation], view: LookupContext) {
        for e in equations {
            match &e.kind {
                EquationKind::Connect(a, b) => {
                    if let (Some(a), Some(b)) = (self.side(a, view), self.side(b, view)) {
                        self.expand_pair(&a, &b);
                    }
                }
                EquationKind::For { iterators, body } => {
                    self.instance.statements().for_each(iterators, LoopBody::Equations(body), view, &mut |s| {
                        s.builder().expand_by(body, view)
                    });
                }
                EquationKind::If { branches, otherwise } => {
                    let mut chosen = Some(otherwise.as_slice());
                    for (condition, body) in branches {
                        // what cannot be known before the run has no connections, or its message comes with the network
                        let (known, _) = self.instance.attempt(|i| i.evaluator().constant_boolean(condition, view));
                        match known {
                            Some(true) => chosen = Some(body),
                            Some(false) => continue,
                            None => chosen = None,
                        }
                        break;
                    }
                    if let Some(body) = chosen {
                        self.expand_by(body, view);
                    }
                }
                _ => {}
            }
        }
    }

    /// What a side of a connection names; `None` where the network has to say what is wrong, or nothing is there.
    fn side(&mut self, e: &'a Expr, view: LookupContext) -> Option<ExpandableSide> {
        let ExprKind::Reference(r) = &e.kind else { return None };
        let LookupResult::Component(scope, index) = self.instance.names().lookup(view, r.parts[0].name.name)? else {
            return None;
        };
        let mut node = self.component(scope, index)?;
        let last = r.parts.len() - 1;
        for (i, part) in r.parts.iter().enumerate() {
            if i > 0 {
                let InstanceNode::Object(s) = *self.instance.node(node) else { return None };
                let template = self.instance.scope(s).template.clone();
                match template.by_name.get(&part.name.name) {
                    Some(&k) => node = self.component(s, k)?,
                    None if template.is_expandable() && i == last && part.subscripts.is_empty() => {
                        return Some(ExpandableSide::Missing(s, part.name.name));
                    }
                    None => return None,
                }
            }
            if !part.subscripts.is_empty() {
                let at = self.instance.evaluator().selection(node);
                let picked = self.instance.evaluator().subscript_selection(&at, part, view, r.span)?.ok()?;
                let [one] = picked.nodes[..] else { return None };
                node = one;
            }
        }
        match self.instance.node(node) {
            InstanceNode::Object(s) if self.instance.scope(*s).template.is_expandable() => {
                Some(ExpandableSide::Bus(*s))
            }
            _ => Some(ExpandableSide::Port(node)),
        }
    }

    fn expand_pair(&mut self, a: &ExpandableSide, b: &ExpandableSide) {
        match (a, b) {
            (ExpandableSide::Missing(bus, name), ExpandableSide::Port(port))
            | (ExpandableSide::Port(port), ExpandableSide::Missing(bus, name)) => {
                self.add_member(*bus, *name, *port);
            }
            (ExpandableSide::Missing(bus, name), ExpandableSide::Bus(other))
            | (ExpandableSide::Bus(other), ExpandableSide::Missing(bus, name)) => {
                let node = self.node_of(*other);
                if let Some(node) = node {
                    self.add_member(*bus, *name, node);
                }
            }
            (ExpandableSide::Bus(x), ExpandableSide::Bus(y)) => {
                for (from, to) in [(*x, *y), (*y, *x)] {
                    let template = self.instance.scope(from).template.clone();
                    for (i, element) in (0u32..).zip(&template.elements) {
                        let known = self.instance.scope(to).template.by_name.contains_key(&element.name);
                        if !known && let Some(node) = self.component(from, i) {
                            self.add_member(to, element.name, node);
                        }
                    }
                }
            }
            _ => {}
        }
    }

    fn node_of(&self, scope: ScopeId) -> Option<NodeId> {
        let at = self.instance.nodes.iter().position(|n| matches!(n, InstanceNode::Object(s) if *s == scope))?;
        Some(NodeId(u32::try_from(at).expect("fewer than 2^32 components")))
    }

    /// A new member of a bus, like the port that is connected to it, but with no direction of its own.
    fn add_member(&mut self, bus: ScopeId, name: Symbol, like: NodeId) {
        let Some((declared, found, dims)) = self.declaration_of(like) else { return };
        let around = self.instance.scope(bus);
        let full = if around.name.is_empty() { name.as_str().to_owned() } else { format!("{}.{name}", around.name) };
        let (span, hidden) = (around.span, around.prefix.hidden);
        let plan = ComponentPlan {
            name: full,
            scope: bus,
            index: None,
            declared,
            prefix: InheritedPrefixes { hidden, nested: true, ..InheritedPrefixes::default() },
            span,
            depth: 0,
        };
        let Some(node) = self.build_like(&plan, &found, &dims) else { return };
        self.take_attributes(node, like);
        let mut template = (*self.instance.scope(bus).template).clone();
        let index = u32::try_from(template.elements.len()).expect("fewer than 2^32 elements");
        template.by_name.insert(name, index);
        template.bases[0].names.insert(name);
        template.elements.push(TemplateElement {
            name,
            kind: TemplateElementKind::Component(declared),
            base: 0,
            modified: Vec::new(),
            protected: false,
            span,
        });
        let s = self.instance.scope_mut(bus);
        s.template = Rc::new(template);
        s.elements.push(ElementState::Node(node));
    }

    /// The declaration, class and sizes of a port.
    fn declaration_of(
        &mut self,
        node: NodeId,
    ) -> Option<(&'a ast::ComponentDeclaration, LookupResult<'a>, Vec<usize>)> {
        let (dims, one) = match self.instance.node(node) {
            InstanceNode::Array { dims, elements, .. } => (dims.clone(), *elements.first()?),
            _ => (Vec::new(), node),
        };
        let (owner, name, found) = match self.instance.node(one) {
            InstanceNode::Var(i) => {
                let data = &self.instance.variables[*i as usize];
                let builtin = match data.ty {
                    ScalarType::Real => BuiltinType::Real,
                    ScalarType::Integer => BuiltinType::Integer,
                    ScalarType::Boolean => BuiltinType::Boolean,
                    ScalarType::Enumeration(e) => BuiltinType::Enumeration(e),
                };
                (data.scope, data.name.clone(), LookupResult::Builtin(builtin))
            }
            InstanceNode::Object(s) => {
                let s = self.instance.scope(*s);
                let base = &s.template.bases[0];
                let class = ClassRef { class: base.class, parent: base.parent, args: s.args.clone() };
                (s.owner?, s.name.clone(), LookupResult::Class(class))
            }
            InstanceNode::Array { .. } => return None,
        };
        let last = name.rsplit('.').next().unwrap_or(&name);
        let last = Symbol::new(last.split('[').next().unwrap_or(last));
        let template = &self.instance.scope(owner).template;
        let TemplateElementKind::Component(declared) = template.elements[*template.by_name.get(&last)? as usize].kind
        else {
            return None;
        };
        Some((declared, found, dims))
    }

    fn build_like(&mut self, plan: &ComponentPlan<'a>, found: &LookupResult<'a>, dims: &[usize]) -> Option<NodeId> {
        let extents: Vec<crate::instance::evaluation::ranges::ArrayExtent> = dims
            .iter()
            .map(|&size| crate::instance::evaluation::ranges::ArrayExtent { size, by: ScalarType::Integer })
            .collect();
        self.build_shaped(plan, found, &extents, ElementModifiers::default())
    }

    /// Units and bounds of the port hold for the member, too.
    fn take_attributes(&mut self, to: NodeId, from: NodeId) {
        match (self.instance.node(to).clone(), self.instance.node(from).clone()) {
            (InstanceNode::Var(a), InstanceNode::Var(b)) => {
                self.instance.variables[a as usize].attributes = self.instance.variables[b as usize].attributes.clone();
                self.instance.variables[a as usize].causality = None;
            }
            (InstanceNode::Array { elements: a, .. }, InstanceNode::Array { elements: b, .. }) => {
                for (a, b) in a.iter().zip(b.iter()) {
                    self.take_attributes(*a, *b);
                }
            }
            _ => {}
        }
    }
}
