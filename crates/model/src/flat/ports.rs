//! Checks of ports and signals: ports that nothing is connected to, inputs without a value, and signals with two
//! sources.
//!
//! Enters: the network and the census. Leaves: messages. [`open_lines`], [`uneven`] and
//! [`SignalConnections::joined_outputs`] are reported always; [`SignalConnections::doubts`] only if the model is
//! singular. `flatten` and `balance` call them.

use super::census::{BalanceCensus, BalanceRole, VariableGroups};
use super::numbers::ComponentNumbers;
use super::{FlatModel, OriginKind};
use crate::instance::{Instance, ScopeId};
use crate::network::Network;
use bramah_expr::VarId;
use bramah_expr::units::MeasurementUnit;
use bramah_syntax::diag::{Code, Diagnostic, Span};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Connectors with different numbers of potentials and flows (MLS 9.3.1), each class once. They are warnings (W107).
pub(super) fn uneven(
    instance: &Instance<'_, '_>,
    flat: &FlatModel,
    census: &BalanceCensus,
    scopes: &[ScopeId],
) -> Vec<Diagnostic> {
    let mut reported: FxHashSet<&str> = FxHashSet::default();
    let mut found = Vec::new();
    for &(port, difference) in &census.uneven {
        let info = &flat.instances[port as usize];
        if !reported.insert(&info.class) {
            continue;
        }
        let class = instance.scope(scopes[port as usize]).template.class;
        let excess = match difference {
            d if d > 0 => format!("{d} more potentials than flows"),
            d => format!("{} more flows than potentials", -d),
        };
        found.push(
            Diagnostic::new(Code::UnevenPort, format!("the connector `{}` has {excess}", info.class))
                .at(instance.library.class(class).name.span, "declared here")
                .at(info.span, format!("used for the port `{}`", info.name))
                .class(info.class.clone())
                .help("write `flow` before what sums to zero at a node; signals are `input` or `output`"),
        );
    }
    found
}

/// Hydraulic ports of components that are not connected.
///
/// In other domains an open port has a meaning: a free shaft, no heat, no current. An open hydraulic port would spill
/// oil; whoever means a closed one says so by a plug.
/// The code is E103.
pub(super) fn open_lines(flat: &FlatModel, census: &BalanceCensus) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for e in flat.equations.iter().filter(|e| e.origin.kind == OriginKind::OpenPort) {
        let Some(v) = super::census::as_variable(flat, e.lhs) else { continue };
        let holder = census.holder[v.index()];
        // Ports of the model itself may be open.
        if holder != 0 && census.role[v.index()] == BalanceRole::Flow && is_volume_flow(flat, v) {
            found.push(open_port(flat, v, holder));
        }
    }
    found
}

/// Whether the unit of a variable has the dimension of a volume flow, which marks a hydraulic port.
fn is_volume_flow(flat: &FlatModel, v: VarId) -> bool {
    let unit = flat.variables[v.index()].unit.as_deref().and_then(|u| MeasurementUnit::parse(u).ok());
    let volume_flow = MeasurementUnit::parse("m3/s").expect("a unit");
    unit.is_some_and(|u| u.dimension == volume_flow.dimension)
}

/// The message about one open port, given its flow and the component it belongs to.
/// The help shows the `connect` with a plug.
fn open_port(flat: &FlatModel, flow: VarId, component: u32) -> Diagnostic {
    let variable = &flat.variables[flow.index()];
    let port = &flat.instances[variable.origin.instance as usize];
    let info = &flat.instances[component as usize];
    let short = port.name.strip_prefix(&info.name).map_or(port.name.as_str(), |s| s.trim_start_matches('.'));
    Diagnostic::new(Code::OpenPort, format!("port `{}` is not connected", port.name))
        .at(info.span, format!("its port `{short}` appears in no `connect`"))
        .at(port.span, "declared here")
        .note(format!("an open port means `{} = 0`", variable.name))
        .help(format!(
            "connect it, or close it on purpose: `Hydraulic.Plug plug;` and `connect({}, plug.port)`",
            port.name
        ))
        .instance(info.name.clone())
        .class(info.class.clone())
}

/// The signals that `connect` joins, grouped by the component in which the connections stand (the level).
pub(super) struct SignalConnections<'s> {
    /// The flat model.
    flat: &'s FlatModel,
    /// The roles of variables.
    census: &'s BalanceCensus,
    /// The members of each group with the `connect` that brought them. The key is the level and the variable that
    /// stands for the group.
    groups: BTreeMap<(u32, u32), Vec<(VarId, Span)>>,
    /// By input of a component: the group around the component that contains it.
    outer: FxHashMap<VarId, (u32, u32)>,
    /// Variables that occur in equations outside their own component.
    mentioned: FxHashSet<VarId>,
}

impl<'s> SignalConnections<'s> {
    /// Groups the joined signals.
    ///
    /// Each component has groups of its own: a signal that passes through a port belongs to one group outside and one
    /// inside.
    pub(super) fn new(
        instance: &Instance<'_, '_>,
        network: &Network,
        flat: &'s FlatModel,
        census: &'s BalanceCensus,
        scopes: &[ScopeId],
    ) -> Self {
        let numbers = ComponentNumbers::new(scopes);
        let mut sets = VariableGroups::default();
        let mut members: Vec<((u32, u32), Span)> = Vec::new();
        let mut seen: FxHashSet<(u32, u32)> = FxHashSet::default();
        for pair in &network.signals {
            let at = numbers.of(pair.scope);
            sets.join((at, pair.a), (at, pair.b));
            for v in [pair.a, pair.b] {
                if seen.insert((at, v)) {
                    members.push(((at, v), pair.span));
                }
            }
        }
        let mut groups: BTreeMap<(u32, u32), Vec<(VarId, Span)>> = BTreeMap::new();
        let mut outer = FxHashMap::default();
        for (key, span) in members {
            let v = instance.variables[key.1 as usize].id;
            let group = sets.root(key);
            // Seen from the level, the variable belongs to a component inside it.
            if census.holder[v.index()] != key.0 {
                outer.insert(v, group);
            }
            groups.entry(group).or_default().push((v, span));
        }
        SignalConnections { flat, census, groups, outer, mentioned: mentioned(flat, census) }
    }

    /// Signals that cannot work: inputs with two sources, then inputs without a value.
    /// The codes are E105 and E106.
    pub(super) fn doubts(&self) -> Vec<Diagnostic> {
        let mut found = self.two_sources(|_| true);
        found.extend(self.without_source());
        found
    }

    /// Outputs that `connect` joins. That is wrong whatever the equations say (MLS 9.3).
    pub(super) fn joined_outputs(&self) -> Vec<Diagnostic> {
        let causal = |v: VarId| matches!(self.census.role[v.index()], BalanceRole::Input | BalanceRole::Own);
        self.two_sources(|members| members.iter().all(|(v, _)| causal(*v)))
    }

    /// The name of a variable.
    fn name(&self, v: VarId) -> &str {
        &self.flat.variables[v.index()].name
    }

    /// Whether a member gives the group its value: an output of a component inside, an input of the level itself, or
    /// anything that an equation may determine.
    fn is_source(&self, level: u32, v: VarId) -> bool {
        let outside = self.census.holder[v.index()] == level;
        match self.census.role[v.index()] {
            BalanceRole::Input => outside,
            BalanceRole::Own => !outside,
            BalanceRole::Fixed | BalanceRole::Potential | BalanceRole::Flow => true,
        }
    }

    /// A message for each group that has two sources, among those for which `wanted` is true.
    /// The places are the `connect`s that brought the first and the last source.
    fn two_sources(&self, wanted: impl Fn(&[(VarId, Span)]) -> bool) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        for (&(level, _), members) in self.groups.iter().filter(|(_, members)| wanted(members)) {
            let sources: Vec<_> = members.iter().filter(|(v, _)| self.is_source(level, *v)).collect();
            let [(a, at_a), .., (b, at_b)] = sources.as_slice() else { continue };
            // The member that needs a value is named in the help.
            let fed = members.iter().find(|(v, _)| !self.is_source(level, *v));
            let place = fed.map_or(String::new(), |(v, _)| format!(" of `{}`", self.name(*v)));
            let made = Diagnostic::new(
                Code::BadConnect,
                format!("two outputs, `{}` and `{}`, are joined", self.name(*a), self.name(*b)),
            )
            .at(*at_b, "this brings a second source")
            .at(*at_a, "the first one comes here");
            found.push(made.help(format!("leave one source{place}; a block such as `Signal.Add` makes a sum of both")));
        }
        found
    }

    /// A message for each input of a component that gets no value. Of inputs that are joined with each other only one
    /// is reported.
    ///
    /// An input has a value if it has a binding, if an equation around its component mentions it, or if its group has a
    /// source.
    fn without_source(&self) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        let mut reported: FxHashSet<(u32, u32)> = FxHashSet::default();
        for (i, role) in (0u32..).zip(&self.census.role) {
            let v = VarId(i);
            let holder = self.census.holder[v.index()];
            if *role != BalanceRole::Input
                || holder == 0
                || self.census.bound.contains(&v)
                || self.mentioned.contains(&v)
            {
                continue;
            }
            let group = self.outer.get(&v);
            if let Some(group) = group {
                let members = &self.groups[group];
                let fed = members.iter().any(|(m, _)| {
                    self.is_source(group.0, *m)
                        || self.mentioned.contains(m)
                        || self.census.bound.contains(m)
                        || self.census.role[m.index()] == BalanceRole::Own
                });
                if fed || !reported.insert(*group) {
                    continue;
                }
            }
            found.push(self.no_value(v, holder, group.map(|g| self.groups[g].as_slice())));
        }
        found
    }

    /// The message about one input. `group` are the signals that it is joined with, if any.
    /// The code is E106.
    fn no_value(&self, v: VarId, holder: u32, group: Option<&[(VarId, Span)]>) -> Diagnostic {
        let info = &self.flat.instances[holder as usize];
        let name = self.name(v);
        let made = Diagnostic::new(Code::NoInput, format!("input `{name}` has no value"));
        let made = match group {
            None => made.at(info.span, "nothing is connected to it, and no equation gives it a value"),
            Some(members) => {
                made.at(info.span, "it is connected to inputs only").at(members[0].1, "nothing here is an output")
            }
        };
        made.at(self.flat.variables[v.index()].origin.span, "declared here")
            .help(format!("connect an output to it, such as that of a `Signal.Constant`, or write `{name} = ...`"))
            .instance(info.name.clone())
            .class(info.class.clone())
    }
}

/// Variables that an equation or `when` outside their own component mentions. Empty where no component has inputs,
/// since only then they are asked for.
///
/// Such an equation may give an input its value instead of a connection.
fn mentioned(flat: &FlatModel, census: &BalanceCensus) -> FxHashSet<VarId> {
    let mut found = FxHashSet::default();
    let inputs = census.role.iter().zip(&census.holder).any(|(r, h)| *r == BalanceRole::Input && *h != 0);
    if !inputs {
        return found;
    }
    let mut by_owner: BTreeMap<u32, Vec<_>> = BTreeMap::new();
    for e in &flat.equations {
        // Equations of connections say who is joined, not who gives a value.
        let connection =
            matches!(e.origin.kind, OriginKind::ConnectPotential | OriginKind::ConnectFlow | OriginKind::OpenPort);
        if !connection {
            by_owner.entry(census.owner[e.origin.instance as usize]).or_default().extend([e.lhs, e.rhs]);
        }
    }
    for (owner, roots) in by_owner {
        let vars = flat.exprs.dependencies(&roots).vars;
        found.extend(vars.into_iter().filter(|v| census.holder[v.index()] != owner));
    }
    for when in &flat.whens {
        let owner = census.owner[when.origin.instance as usize];
        found.extend(when.assigned().filter(|v| census.holder[v.index()] != owner));
    }
    found
}
