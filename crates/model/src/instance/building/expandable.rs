//! Expandable connectors (MLS 9.1.3), also called buses.
//!
//! `connect(sensor.y, bus.speed)` adds a member `speed` to `bus` if the bus has none.
//! Buses that are connected get the same members. This is done on the tree, before connection sets are formed, and is
//! repeated until no bus gets a new member.

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

/// The most repetitions, each of which carries members one bus further. No chain of buses is that long.
const ROUNDS: usize = 100;

/// One side of a connection.
enum ExpandableSide {
    /// A member that the bus does not have: the scope of the bus and the name.
    Missing(ScopeId, Symbol),
    /// A complete bus.
    Bus(ScopeId),
    /// Any other port.
    Port(NodeId),
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Adds to all buses the members that connections ask for.
    ///
    /// Each round looks at the connections of all components and adds what is missing.
    /// A member that was added may be missing in a bus that is connected to this one, so there are several rounds.
    pub(in crate::instance) fn expand_connectors(&mut self) {
        // Most models have no bus, and looking at all connections takes time.
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
            // New members are new nodes: without any the work is finished.
            if self.instance.nodes.len() == before {
                return;
            }
        }
    }

    /// Looks at the connections among some equations, inside `for` and `if` as well.
    ///
    /// `view` is the place of the equations. `for` equations are repeated with their loop variables.
    /// Of an `if` equation only the branch that is known to apply counts.
    /// `when` equations contain no connections.
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
                        // A condition that is not known has no connections, or its message is reported with the
                        // network.
                        // Its messages are dropped here.
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

    /// What one side of a connection names.
    ///
    /// `None`, without a message, if it names nothing that matters here. The network reports errors later.
    ///
    /// Only the last part of a reference may be missing in its bus, and it must have no subscripts.
    /// Components on the way are built on demand.
    /// A reference to an element of an array must select exactly one.
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

    /// Adds the members that one connection asks for.
    ///
    /// - A missing member and a port: the member is added like the port.
    /// - A missing member and a bus: the member is a bus itself, with what the other bus has.
    /// - Two buses: each gets the members of the other one.
    /// - Nothing is to be done for other pairs.
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
            // Both directions: each bus gets the members of the other one.
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

    /// The node of an instance. A linear search, because buses are few.
    fn node_of(&self, scope: ScopeId) -> Option<NodeId> {
        let at = self.instance.nodes.iter().position(|n| matches!(n, InstanceNode::Object(s) if *s == scope))?;
        Some(NodeId(u32::try_from(at).expect("fewer than 2^32 components")))
    }

    /// Adds a member to a bus, with class, sizes and attributes of the port `like`, but without `input` or `output`.
    ///
    /// The direction follows from the other connections of the bus. Does nothing if the port has no declaration.
    ///
    /// Prefixes such as `flow` come from the class of the port, not from its declaration.
    /// The member is hidden in the results if the bus is.
    /// Its name in the results is that of the bus, followed by the name of the member.
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
        // Templates are shared, so the bus gets its own copy with the additional element.
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

    /// The declaration, class and sizes of a port. `None` for an empty array, or if no declaration is found.
    ///
    /// A variable gives its predefined type, so modifiers of its declared type do not get here; `take_attributes`
    /// copies the attributes. An object gives its class with its modifiers.
    /// For an array the declaration of its first element is used.
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
        // The last part of the full name, without subscripts, is the name in the declaration.
        let last = name.rsplit('.').next().unwrap_or(&name);
        let last = Symbol::new(last.split('[').next().unwrap_or(last));
        let template = &self.instance.scope(owner).template;
        let TemplateElementKind::Component(declared) = template.elements[*template.by_name.get(&last)? as usize].kind
        else {
            return None;
        };
        Some((declared, found, dims))
    }

    /// Builds a member with a class and sizes. `None` after a message.
    fn build_like(&mut self, plan: &ComponentPlan<'a>, found: &LookupResult<'a>, dims: &[usize]) -> Option<NodeId> {
        let extents: Vec<crate::instance::evaluation::ranges::ArrayExtent> = dims
            .iter()
            .map(|&size| crate::instance::evaluation::ranges::ArrayExtent { size, by: ScalarType::Integer })
            .collect();
        self.build_shaped(plan, found, &extents, ElementModifiers::default())
    }

    /// Copies the attributes of a port to the new member, so that units and bounds apply to it as well.
    /// Objects have their attributes from their class and modifiers, so nothing is copied for them.
    /// The direction is removed, since a member of a bus has none of its own.
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
