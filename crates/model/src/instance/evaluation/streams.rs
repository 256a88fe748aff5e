//! Stream connectors (MLS 15): `inStream`, `actualStream` and `Connections.inflow` as expressions.
//!
//! `flat` fills in the connection sets first, see [`StreamConnections`](crate::instance::StreamConnections).
//! The results are mixtures of what the other members of a set send out, weighted by their flows.

use crate::instance::{StreamMember, StreamMixing};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp};

/// The `least` of mixtures into a component with `__bramah_mixes`, which keeps them defined without flow.
/// It is so small that mixture times inflow equals what is brought in to the last digit. Otherwise energy would not be
/// conserved.
const LEAST_SHARE: f64 = 1e-20;

/// Total flow to a node, in the unit of the connector's flow, below which a mixture approaches the plain mean.
/// It is a ten thousandth of a usual flow of oil in m3/s, and far less than usual mass flows in kg/s.
pub const LEAST_MIXED: f64 = 1e-8;

impl StreamMixing<'_, '_, '_> {
    /// `inStream(v)`: the value that flows in through the connector of `v` if the flow is inwards (MLS 15.2).
    /// `variable` is an index into `variables`, as in all functions here. An unconnected stream gives `v` itself.
    ///
    /// The mixing rule is that of MLS 15.2. With two connected ports it is the value of the other one.
    /// At a node with a mixing component all others get what leaves that component.
    pub fn in_stream(&mut self, variable: u32) -> ExprId {
        let own = self.instance.exprs.var(self.instance.variables[variable as usize].id);
        let Some(&set) = self.instance.streams.inside.get(&variable) else { return own };
        // Everything at this node passes through the mixing component: the others receive what leaves it.
        if let Some(junction) = self.instance.streams.junction(set) {
            if variable != junction.mixer {
                return self.leaving(junction.mixer);
            }
            let others = junction.others.clone();
            return if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_SHARE) };
        }
        let members = &self.instance.streams.sets[set];
        // An outside connector also contributes what comes from outside of the component.
        let others: Vec<StreamMember> =
            members.iter().filter(|m| m.outside || m.variable != variable).copied().collect();
        if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_MIXED) }
    }

    /// Notes the value with which a stream leaves its port, if it is a number. It is then used instead of the variable.
    pub fn leaves_with(&mut self, variable: u32, value: ExprId) {
        if matches!(self.instance.exprs.node(value), ExprNode::Num(_)) {
            self.instance.streams.constant.insert(variable, value);
        }
    }

    /// The value that leaves through the port of a stream: the noted number, or the variable.
    pub fn leaving(&mut self, variable: u32) -> ExprId {
        match self.instance.streams.constant.get(&variable) {
            Some(&number) => number,
            None => self.instance.exprs.var(self.instance.variables[variable as usize].id),
        }
    }

    /// `Connections.inflow(v)`: how much flows in through the port of `v`, at least 0.
    /// Through a component with `__bramah_mixes` passes all that the others send to its node, even if that is more than
    /// its own flow.
    pub fn inflow(&mut self, variable: u32, flow: u32) -> ExprId {
        let junction = self.instance.streams.inside.get(&variable).and_then(|&set| self.instance.streams.junction(set));
        let Some(junction) = junction.filter(|junction| junction.mixer == variable) else {
            let flow = self.instance.exprs.var(self.instance.variables[flow as usize].id);
            return self.instance.exprs.binary(BinaryFunction::Max, flow, Exprs::ZERO);
        };
        let others = junction.others.clone();
        let sent: Vec<ExprId> = others.iter().map(|m| self.sent(m)).collect();
        self.total(sent)
    }

    /// The mean of what `members` send to their node, each weighted by its flow (MLS 15.2).
    /// Below a total of `least` the weights approach each other, so that the mean exists without flow.
    ///
    /// `members` lack the connector into which the mixture flows; the caller leaves it out.
    /// An outside connector sends what flows in from outside, which is a mixture as well.
    pub fn stream_mixture(&mut self, members: &[StreamMember], least: f64) -> ExprId {
        let mut parts = Vec::with_capacity(members.len());
        for m in members {
            let value = match m.outside {
                true => self.in_stream(m.variable),
                false => self.leaving(m.variable),
            };
            parts.push((value, self.sent(m)));
        }
        // If all send the same value, the mixture is that value, whatever the flows are.
        if let Some((value, rest)) = parts.split_first().map(|(&(value, _), rest)| (value, rest))
            && rest.iter().all(|(other, _)| *other == value)
        {
            return value;
        }
        let total = self.total(parts.iter().map(|(_, sent)| *sent));
        let equal = self.equal_share(total, least);
        let (mut carried, mut all) = (Exprs::ZERO, Exprs::ZERO);
        for (value, sent) in parts {
            let weight = self.instance.exprs.add(sent, equal);
            let part = self.instance.exprs.mul(weight, value);
            carried = self.instance.exprs.add(carried, part);
            all = self.instance.exprs.add(all, weight);
        }
        self.instance.exprs.div(carried, all)
    }

    /// The flow of a member towards its node, at least 0.
    fn sent(&mut self, m: &StreamMember) -> ExprId {
        let flow = self.instance.exprs.var(self.instance.variables[m.flow as usize].id);
        // Flows count into the component: at an inside connector that is away from the node.
        let towards = if m.outside { flow } else { self.instance.exprs.neg(flow) };
        self.instance.exprs.binary(BinaryFunction::Max, towards, Exprs::ZERO)
    }

    /// The sum of expressions.
    fn total(&mut self, parts: impl IntoIterator<Item = ExprId>) -> ExprId {
        parts.into_iter().fold(Exprs::ZERO, |sum, part| self.instance.exprs.add(sum, part))
    }

    /// The amount added to each weight: 0 from a total of `least` on, rising smoothly to `least` without flow.
    fn equal_share(&mut self, total: ExprId, least: f64) -> ExprId {
        let (least, two) = (self.instance.exprs.num(least), self.instance.exprs.num(2.0));
        let over = self.instance.exprs.div(total, least);
        let short = self.instance.exprs.sub(Exprs::ONE, over);
        let short = self.instance.exprs.binary(BinaryFunction::Max, short, Exprs::ZERO);
        let power = self.instance.exprs.binary(BinaryFunction::Pow, short, two);
        self.instance.exprs.mul(least, power)
    }

    /// `actualStream(v)`: the value of what flows at present, inwards or outwards (MLS 15.3).
    pub fn actual_stream(&mut self, variable: u32, flow: u32) -> ExprId {
        let (inward, own) =
            (self.in_stream(variable), self.instance.exprs.var(self.instance.variables[variable as usize].id));
        let flow = self.instance.exprs.var(self.instance.variables[flow as usize].id);
        // No event: the product with the flow, for which `actualStream` is meant, is continuous there.
        let enters = self.instance.exprs.rel(RelationalOp::Gt, flow, Exprs::ZERO);
        self.instance.exprs.if_(enters, inward, own)
    }
}
