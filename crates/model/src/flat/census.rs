//! The census of equations: which component brings which equations, and which it owes (MLS 4.8, balanced models).
//!
//! A component owes one equation for each variable of its own and one for each flow of its ports. The circuit around it
//! supplies the other half of every port and the values of its inputs. Enters: the flat model with its component tree.
//! Leaves: a [`BalanceCensus`], from which `balance` and `ports` make their messages. `flatten` takes it once.

use super::numbers::ComponentNumbers;
use super::{FlatModel, OriginKind, Variability};
use crate::instance::{Instance, ScopeId};
use crate::network::Network;
use bramah_expr::{ExprId, ExprNode, VarId};
use bramah_syntax::ast::{CausalityPrefix, ClassKind};
use bramah_syntax::symbol::Symbol;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// What a variable is to the component that contains it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BalanceRole {
    /// A parameter or constant: no equation is owed.
    Fixed,
    /// A variable of its own: the component owes an equation.
    Own,
    /// An input: its value comes from outside.
    Input,
    /// The potential of a port: the connections supply the equation.
    Potential,
    /// The flow of a port: the component owes an equation.
    Flow,
}

/// The roles of all variables and the counts of equations, by component. A component goes by the number of its
/// instance.
pub(super) struct BalanceCensus {
    /// By instance: the component that it is part of. Connectors and records belong to the component around them.
    pub owner: Vec<u32>,
    /// By component: the component around it; the model is its own.
    pub around: Vec<u32>,
    /// By flat variable: its role.
    pub role: Vec<BalanceRole>,
    /// By flat variable: its component.
    pub holder: Vec<u32>,
    /// By component: how many equations it owes.
    pub owed: Vec<usize>,
    /// By component: how many equations it brings.
    pub brought: Vec<usize>,
    /// Inputs of components that a binding gives a value.
    pub bound: FxHashSet<VarId>,
    /// Ports with different numbers of potentials and flows: the connector's instance, and its potentials less its
    /// flows.
    pub uneven: Vec<(u32, i64)>,
    /// By component: whether it cannot be judged alone, because some of its ports have no pairs of potential and flow.
    pub unjudged: Vec<bool>,
}

impl BalanceCensus {
    /// Takes the census. `scopes` are the component instances in the order of `FlatModel::instances`. `constraints`
    /// lists the overconstrained records with their variables and the number of their constraints.
    ///
    /// The counts are over `FlatModel::equations` and `whens`, so this must come after all equations are written.
    pub(super) fn take(
        instance: &Instance<'_, '_>,
        network: &Network,
        flat: &FlatModel,
        scopes: &[ScopeId],
        constraints: &[(Vec<u32>, usize)],
    ) -> Self {
        let components = components(instance, flat, scopes);
        let n = scopes.len();
        let around = (0..n).map(|i| components[flat.instances[components[i] as usize].parent as usize]).collect();
        let mut census = BalanceCensus {
            owner: components,
            around,
            role: Vec::with_capacity(flat.variables.len()),
            holder: Vec::with_capacity(flat.variables.len()),
            owed: vec![0; n],
            brought: vec![0; n],
            bound: FxHashSet::default(),
            uneven: Vec::new(),
            unjudged: vec![false; n],
        };
        census.roles(instance, flat, scopes, constraints);
        census.equations(flat);
        census.connections(instance, network, scopes);
        census.debts();
        census
    }

    /// Gives each variable its role and finds uneven ports.
    /// A variable in a protected connector counts as the component's own, since nothing outside can be joined to it.
    fn roles(
        &mut self,
        instance: &Instance<'_, '_>,
        flat: &FlatModel,
        scopes: &[ScopeId],
        constraints: &[(Vec<u32>, usize)],
    ) {
        // By port: potentials less flows.
        let mut pairs: BTreeMap<u32, i64> = BTreeMap::new();
        for (i, v) in flat.variables.iter().enumerate() {
            let data = &instance.variables[instance.order[i] as usize];
            let holder = self.owner[v.origin.instance as usize];
            let (port, public) = self.place(instance, flat, scopes, v.origin.instance, &data.name);
            let role = match (v.variability <= Variability::Parameter, data.causality) {
                (true, _) => BalanceRole::Fixed,
                (_, Some(CausalityPrefix::Input)) if public => BalanceRole::Input,
                // What leaves through a port is determined by the component (MLS 15.1).
                _ if data.stream => BalanceRole::Own,
                (_, None) if port.is_some() && public && v.flow => BalanceRole::Flow,
                (_, None) if port.is_some() && public => BalanceRole::Potential,
                _ => BalanceRole::Own,
            };
            if let (Some(port), BalanceRole::Potential | BalanceRole::Flow) = (port, role) {
                *pairs.entry(port).or_default() += if role == BalanceRole::Flow { -1 } else { 1 };
            }
            self.role.push(role);
            self.holder.push(holder);
        }
        for (variables, size) in constraints {
            self.overconstrained(instance, flat, scopes, variables, *size, &mut pairs);
        }
        for (port, difference) in pairs {
            if difference != 0 {
                // The members of a bus are no pairs of potential and flow by intention.
                if !instance.scope(scopes[port as usize]).template.is_expandable() {
                    self.uneven.push((port, difference));
                }
                self.doubt(self.owner[port as usize]);
            }
        }
    }

    /// Counts an overconstrained record of a port by its constraints instead of its variables, and excludes the
    /// component from the balance: branches of the connection graph decide which of its equations hold (MLS 9.4.1).
    fn overconstrained(
        &mut self,
        instance: &Instance<'_, '_>,
        flat: &FlatModel,
        scopes: &[ScopeId],
        variables: &[u32],
        size: usize,
        pairs: &mut BTreeMap<u32, i64>,
    ) {
        let first = variables.first().map(|&i| &instance.variables[i as usize]);
        // Variables that are not in the flat model have no number.
        let Some(data) = first.filter(|d| d.id.0 != u32::MAX) else { return };
        let origin = flat.variables[data.id.index()].origin.instance;
        if let (Some(port), true) = self.place(instance, flat, scopes, origin, &data.name) {
            self.doubt(self.owner[port as usize]);
            *pairs.entry(port).or_default() += count(size) - count(variables.len());
        }
    }

    /// The outermost connector around a variable inside its component, and whether it can be seen from outside. `None`
    /// for a variable in no connector.
    /// `at` is the instance that declares the variable, `name` its full name.
    fn place(
        &self,
        instance: &Instance<'_, '_>,
        flat: &FlatModel,
        scopes: &[ScopeId],
        mut at: u32,
        name: &str,
    ) -> (Option<u32>, bool) {
        let holder = self.owner[at as usize];
        let mut port = None;
        let mut element = name;
        while at != holder {
            if is_connector(instance, scopes[at as usize]) {
                port = Some(at);
            }
            element = &flat.instances[at as usize].name;
            at = flat.instances[at as usize].parent;
        }
        // The element of the component itself decides about visibility: what is protected is no port.
        let last = element.rsplit('.').next().unwrap_or(element);
        let last = Symbol::new(last.split('[').next().unwrap_or(last));
        let template = &instance.scope(scopes[holder as usize]).template;
        let protected = template.by_name.get(&last).is_some_and(|&i| template.elements[i as usize].protected);
        (port, !protected)
    }

    /// Marks a component and the one around it as not to be judged alone.
    /// The balance of the one around depends on the connections of the port.
    fn doubt(&mut self, component: u32) {
        self.unjudged[component as usize] = true;
        self.unjudged[self.around[component as usize] as usize] = true;
    }

    /// Counts the equations that components bring by themselves.
    /// Equations of connections are counted by [`Self::connections`].
    fn equations(&mut self, flat: &FlatModel) {
        for e in &flat.equations {
            let owner = self.owner[e.origin.instance as usize];
            match e.origin.kind {
                OriginKind::ConnectPotential | OriginKind::ConnectFlow | OriginKind::OpenPort => continue,
                OriginKind::Binding => {
                    let var = as_variable(flat, e.lhs);
                    // The binding of an input is brought by whoever uses the component, not by the component.
                    if let Some(v) = var.filter(|v| self.role[v.index()] == BalanceRole::Input) {
                        self.bound.insert(v);
                        continue;
                    }
                }
                _ => {}
            }
            self.brought[owner as usize] += 1;
        }
        // A variable that a `when` assigns counts once, however many branches assign it.
        let mut assigned: FxHashSet<VarId> = FxHashSet::default();
        for when in &flat.whens {
            let owner = self.owner[when.origin.instance as usize];
            for variable in when.assigned() {
                if assigned.insert(variable) {
                    self.brought[owner as usize] += 1;
                }
            }
        }
    }

    /// Counts the equations that connections bring to the component in which they stand: one for each joined pair of
    /// signals, one for each flow or stream of its own ports that is joined inside.
    /// Flows of inside connectors are owed by the components that contain them.
    fn connections(&mut self, instance: &Instance<'_, '_>, network: &Network, scopes: &[ScopeId]) {
        let numbers = ComponentNumbers::new(scopes);
        for set in &network.flows {
            for &(i, outside) in &set.members {
                let v = instance.variables[i as usize].id;
                if outside {
                    self.brought[self.holder[v.index()] as usize] += 1;
                }
            }
        }
        for member in network.streams.iter().flat_map(|s| &s.members).filter(|m| m.outside) {
            let v = instance.variables[member.variable as usize].id;
            self.brought[self.holder[v.index()] as usize] += 1;
        }
        for &i in &network.open {
            let v = instance.variables[i as usize].id;
            if self.role[v.index()] == BalanceRole::Own {
                self.brought[self.holder[v.index()] as usize] += 1;
            }
        }
        let mut groups = VariableGroups::default();
        for pair in &network.signals {
            let at = numbers.of(pair.scope);
            // A pair of variables that are joined already adds no equation.
            if groups.join((at, pair.a), (at, pair.b)) {
                self.brought[at as usize] += 1;
            }
        }
        for set in &network.potentials {
            for &(i, _) in &set.members {
                let data = &instance.variables[i as usize];
                // A joined variable that is neither signal nor potential: it is not clear which component owes its
                // equation.
                if data.causality.is_none() && self.role[data.id.index()] == BalanceRole::Own {
                    self.doubt(self.holder[data.id.index()]);
                }
            }
        }
    }

    /// Counts what components owe. An input without a binding is owed by the component around.
    /// Potentials and parameters are owed by nobody.
    fn debts(&mut self) {
        for (i, role) in self.role.iter().enumerate() {
            let holder = self.holder[i] as usize;
            match role {
                BalanceRole::Own | BalanceRole::Flow => self.owed[holder] += 1,
                BalanceRole::Input => {
                    let v = VarId(u32::try_from(i).expect("limited sizes"));
                    // Inputs of the model itself are given from outside.
                    if holder != 0 && !self.bound.contains(&v) {
                        self.owed[self.around[holder] as usize] += 1;
                    }
                }
                BalanceRole::Fixed | BalanceRole::Potential => {}
            }
        }
    }
}

/// A length as a signed number.
fn count(n: usize) -> i64 {
    i64::try_from(n).expect("limited sizes")
}

/// The variable that an expression is; `None` for other expressions.
pub(super) fn as_variable(flat: &FlatModel, e: ExprId) -> Option<VarId> {
    match flat.exprs.node(e) {
        ExprNode::Var(v) => Some(v),
        _ => None,
    }
}

/// By instance: the component that it is part of.
/// Parents come before their parts, so one pass is enough.
fn components(instance: &Instance<'_, '_>, flat: &FlatModel, scopes: &[ScopeId]) -> Vec<u32> {
    let mut owner: Vec<u32> = Vec::with_capacity(scopes.len());
    for (i, &scope) in (0u32..).zip(scopes) {
        let part = matches!(
            instance.scope(scope).template.kind,
            ClassKind::Connector { .. } | ClassKind::Record { .. } | ClassKind::Type
        );
        let parent = flat.instances[i as usize].parent;
        // Parents come before their children.
        owner.push(if part && parent < i { owner[parent as usize] } else { i });
    }
    owner
}

/// Whether the class of a scope is a connector.
/// Expandable connectors count as well.
fn is_connector(instance: &Instance<'_, '_>, scope: ScopeId) -> bool {
    matches!(instance.scope(scope).template.kind, ClassKind::Connector { .. })
}

/// Disjoint sets of variables. A key is the component in which variables are joined, and the variable, so each set
/// stays within one component.
/// The same variable may be in groups of two components: the one that contains it and the one around.
#[derive(Default)]
pub(super) struct VariableGroups {
    /// By key: a key nearer to the root. A key without an entry is a root.
    parent: FxHashMap<(u32, u32), (u32, u32)>,
}

impl VariableGroups {
    /// The key that stands for the set of a key.
    pub(super) fn root(&mut self, mut key: (u32, u32)) -> (u32, u32) {
        while let Some(&up) = self.parent.get(&key).filter(|up| **up != key) {
            key = up;
        }
        key
    }

    /// Joins two sets. True if they were apart.
    /// The set of the second key is attached to that of the first.
    pub(super) fn join(&mut self, a: (u32, u32), b: (u32, u32)) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent.insert(b, a);
        }
        a != b
    }
}
