//! Stream variables: what a flow carries with it (MLS 15). What comes into a component is mixed from what the others of its
//! connection set send out, each weighed by its flow.

use super::{Equation, FlatModel, Origin, OriginKind};
use crate::instance::{Instance, Junction, StreamMember};
use crate::network::Network;
use bramah_expr::{Binary, ExprId, Exprs, Node, Rel};

use super::numbers::Numbers;
use petgraph::unionfind::UnionFind;

/// Weight in the mixture of what flows into a component that mixes, where nothing flows. Multiplied by the inflow the mixture
/// must give what is brought in to the last digit, or energy would not be conserved.
const LEAST_SHARE: f64 = 1e-20;

/// Flow to a node, in the unit of the connector's flow, below which its mixture leaves that of the flows for the plain mean: a
/// ten thousandth of a usual flow of oil in m3/s, and far less of usual flows of mass in kg/s.
const LEAST_MIXED: f64 = 1e-8;

/// Tells the instance which stream variables are joined, so that `inStream` has a meaning in its equations.
pub(super) fn prepare(instance: &mut Instance<'_, '_>, network: &Network) {
    for set in &network.streams {
        let number = instance.streams.sets.len();
        for member in &set.members {
            if member.outside {
                instance.streams.outside.insert(member.variable);
            } else {
                instance.streams.inside.insert(member.variable, number);
            }
        }
        instance.streams.sets.push(set.members.clone());
    }
    junctions(instance);
}

/// Finds the nodes with a component that mixes: a node reaches through the ports of components that have parts inside. Of
/// several that mix the one declared first is the junction, and the others hang on it.
fn junctions(instance: &mut Instance<'_, '_>) {
    let streams = &instance.streams;
    let mut nodes = UnionFind::new(streams.sets.len());
    for (i, set) in streams.sets.iter().enumerate() {
        for around in set.iter().filter(|m| m.outside).filter_map(|m| streams.inside.get(&m.variable)) {
            nodes.union(i, *around);
        }
    }
    let mut leaves: Vec<Vec<StreamMember>> = vec![Vec::new(); streams.sets.len()];
    for (i, set) in streams.sets.iter().enumerate() {
        let parts = set.iter().filter(|m| !m.outside && !streams.outside.contains(&m.variable));
        leaves[nodes.find(i)].extend(parts);
    }
    let mut found = vec![None; leaves.len()];
    let mut all = Vec::new();
    for (i, mut others) in leaves.into_iter().enumerate() {
        let mixing = others.iter().map(|m| m.variable).filter(|&v| instance.variables[v as usize].mixes);
        let Some(mixer) = mixing.min() else { continue };
        others.retain(|m| m.variable != mixer);
        found[i] = Some(all.len());
        all.push(Junction { mixer, others });
    }
    instance.streams.at = (0..found.len()).map(|i| found[nodes.find(i)]).collect();
    instance.streams.junctions = all;
}

/// What leaves through the ports of a component itself is the mixture of what its parts send there. Parts come before what
/// holds them, so that numbers are passed on.
pub(super) fn equations(instance: &mut Instance<'_, '_>, network: &Network, numbers: &Numbers, flat: &mut FlatModel) {
    let mut sets: Vec<_> = network.streams.iter().enumerate().collect();
    sets.sort_by_key(|(_, set)| std::cmp::Reverse(numbers.of(set.scope)));
    for (number, set) in sets {
        for member in set.members.iter().filter(|m| m.outside) {
            let others: Vec<StreamMember> = set.members.iter().filter(|m| *m != member).copied().collect();
            let lhs = instance.exprs.var(instance.variables[member.variable as usize].id);
            let rhs = match instance.streams.junction(number).map(|junction| junction.mixer) {
                Some(mixer) => instance.leaving(mixer),
                None => instance.stream_mixture(&others, LEAST_MIXED),
            };
            instance.leaves_with(member.variable, rhs);
            let origin = Origin { span: set.span, instance: numbers.of(set.scope), kind: OriginKind::ConnectPotential };
            flat.equations.push(Equation { lhs, rhs, origin });
        }
    }
}

impl Instance<'_, '_> {
    /// `inStream(v)`: what would come in through the port of `v`.
    pub fn in_stream(&mut self, variable: u32) -> ExprId {
        let own = self.exprs.var(self.variables[variable as usize].id);
        let Some(&set) = self.streams.inside.get(&variable) else { return own };
        if let Some(junction) = self.streams.junction(set) {
            if variable != junction.mixer {
                return self.leaving(junction.mixer);
            }
            let others = junction.others.clone();
            return if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_SHARE) };
        }
        let members = &self.streams.sets[set];
        let others: Vec<StreamMember> =
            members.iter().filter(|m| m.outside || m.variable != variable).copied().collect();
        if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_MIXED) }
    }

    /// Notes what leaves through a port, if it is a number.
    pub fn leaves_with(&mut self, variable: u32, value: ExprId) {
        if matches!(self.exprs.node(value), Node::Num(_)) {
            self.streams.constant.insert(variable, value);
        }
    }

    /// What leaves through the port of a stream.
    fn leaving(&mut self, variable: u32) -> ExprId {
        match self.streams.constant.get(&variable) {
            Some(&number) => number,
            None => self.exprs.var(self.variables[variable as usize].id),
        }
    }

    /// `Connections.inflow(v)`: how much comes in through the port of `v`. Through a component that mixes passes all that
    /// others send to its node, though more than its own flow.
    pub fn inflow(&mut self, variable: u32, flow: u32) -> ExprId {
        let junction = self.streams.inside.get(&variable).and_then(|&set| self.streams.junction(set));
        let Some(junction) = junction.filter(|junction| junction.mixer == variable) else {
            let flow = self.exprs.var(self.variables[flow as usize].id);
            return self.exprs.binary(Binary::Max, flow, Exprs::ZERO);
        };
        let others = junction.others.clone();
        let sent: Vec<ExprId> = others.iter().map(|m| self.sent(m)).collect();
        self.total(sent)
    }

    /// The mean of what members send, each with its flow as its weight. Where all of them together send less than `least`, the
    /// weights become equal (MLS 15.2).
    fn stream_mixture(&mut self, members: &[StreamMember], least: f64) -> ExprId {
        let mut parts = Vec::with_capacity(members.len());
        for m in members {
            let value = match m.outside {
                true => self.in_stream(m.variable),
                false => self.leaving(m.variable),
            };
            parts.push((value, self.sent(m)));
        }
        if let Some((value, rest)) = parts.split_first().map(|(&(value, _), rest)| (value, rest))
            && rest.iter().all(|(other, _)| *other == value)
        {
            return value;
        }
        let total = self.total(parts.iter().map(|(_, sent)| *sent));
        let equal = self.equal_share(total, least);
        let (mut carried, mut all) = (Exprs::ZERO, Exprs::ZERO);
        for (value, sent) in parts {
            let weight = self.exprs.add(sent, equal);
            let part = self.exprs.mul(weight, value);
            carried = self.exprs.add(carried, part);
            all = self.exprs.add(all, weight);
        }
        self.exprs.div(carried, all)
    }

    /// What a member sends to its node.
    fn sent(&mut self, m: &StreamMember) -> ExprId {
        let flow = self.exprs.var(self.variables[m.flow as usize].id);
        let towards = if m.outside { flow } else { self.exprs.neg(flow) };
        self.exprs.binary(Binary::Max, towards, Exprs::ZERO)
    }

    fn total(&mut self, parts: impl IntoIterator<Item = ExprId>) -> ExprId {
        parts.into_iter().fold(Exprs::ZERO, |sum, part| self.exprs.add(sum, part))
    }

    /// What is added to each weight where `total` is sent: nothing from `least` on, and below as much as keeps the mixture
    /// determined and smooth.
    fn equal_share(&mut self, total: ExprId, least: f64) -> ExprId {
        let (least, two) = (self.exprs.num(least), self.exprs.num(2.0));
        let over = self.exprs.div(total, least);
        let short = self.exprs.sub(Exprs::ONE, over);
        let short = self.exprs.binary(Binary::Max, short, Exprs::ZERO);
        let power = self.exprs.binary(Binary::Pow, short, two);
        self.exprs.mul(least, power)
    }

    /// `actualStream(v)`: what flows through the port of `v` one way or the other.
    pub fn actual_stream(&mut self, variable: u32, flow: u32) -> ExprId {
        let (inward, own) = (self.in_stream(variable), self.exprs.var(self.variables[variable as usize].id));
        let flow = self.exprs.var(self.variables[flow as usize].id);
        let enters = self.exprs.rel(Rel::Gt, flow, Exprs::ZERO);
        self.exprs.if_(enters, inward, own)
    }
}
