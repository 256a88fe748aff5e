//! What flows carry with them (MLS 15): `inStream`, `actualStream` and `Connections.inflow` as expressions of the streams and
//! flows of a connection set.

use crate::instance::{StreamMember, StreamMixing};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp};

/// Weight in the mixture of what flows into a component that mixes, where nothing flows. Multiplied by the inflow the mixture
/// must give what is brought in to the last digit, or energy would not be conserved.
const LEAST_SHARE: f64 = 1e-20;

/// Flow to a node, in the unit of the connector's flow, below which its mixture leaves that of the flows for the plain mean: a
/// ten thousandth of a usual flow of oil in m3/s, and far less of usual flows of mass in kg/s.
pub const LEAST_MIXED: f64 = 1e-8;

impl StreamMixing<'_, '_, '_> {
    /// `inStream(v)`: what would come in through the port of `v`.
    pub fn in_stream(&mut self, variable: u32) -> ExprId {
        let own = self.instance.exprs.var(self.instance.variables[variable as usize].id);
        let Some(&set) = self.instance.streams.inside.get(&variable) else { return own };
        if let Some(junction) = self.instance.streams.junction(set) {
            if variable != junction.mixer {
                return self.leaving(junction.mixer);
            }
            let others = junction.others.clone();
            return if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_SHARE) };
        }
        let members = &self.instance.streams.sets[set];
        let others: Vec<StreamMember> =
            members.iter().filter(|m| m.outside || m.variable != variable).copied().collect();
        if others.is_empty() { own } else { self.stream_mixture(&others, LEAST_MIXED) }
    }

    /// Notes what leaves through a port, if it is a number.
    pub fn leaves_with(&mut self, variable: u32, value: ExprId) {
        if matches!(self.instance.exprs.node(value), ExprNode::Num(_)) {
            self.instance.streams.constant.insert(variable, value);
        }
    }

    /// What leaves through the port of a stream.
    pub fn leaving(&mut self, variable: u32) -> ExprId {
        match self.instance.streams.constant.get(&variable) {
            Some(&number) => number,
            None => self.instance.exprs.var(self.instance.variables[variable as usize].id),
        }
    }

    /// `Connections.inflow(v)`: how much comes in through the port of `v`. Through a component that mixes passes all that
    /// others send to its node, though more than its own flow.
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

    /// The mean of what members send, each with its flow as its weight. Where all of them together send less than `least`, the
    /// weights become equal (MLS 15.2).
    pub fn stream_mixture(&mut self, members: &[StreamMember], least: f64) -> ExprId {
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
            let weight = self.instance.exprs.add(sent, equal);
            let part = self.instance.exprs.mul(weight, value);
            carried = self.instance.exprs.add(carried, part);
            all = self.instance.exprs.add(all, weight);
        }
        self.instance.exprs.div(carried, all)
    }

    /// What a member sends to its node.
    fn sent(&mut self, m: &StreamMember) -> ExprId {
        let flow = self.instance.exprs.var(self.instance.variables[m.flow as usize].id);
        let towards = if m.outside { flow } else { self.instance.exprs.neg(flow) };
        self.instance.exprs.binary(BinaryFunction::Max, towards, Exprs::ZERO)
    }

    fn total(&mut self, parts: impl IntoIterator<Item = ExprId>) -> ExprId {
        parts.into_iter().fold(Exprs::ZERO, |sum, part| self.instance.exprs.add(sum, part))
    }

    /// What is added to each weight where `total` is sent: nothing from `least` on, and below as much as keeps the mixture
    /// determined and smooth.
    fn equal_share(&mut self, total: ExprId, least: f64) -> ExprId {
        let (least, two) = (self.instance.exprs.num(least), self.instance.exprs.num(2.0));
        let over = self.instance.exprs.div(total, least);
        let short = self.instance.exprs.sub(Exprs::ONE, over);
        let short = self.instance.exprs.binary(BinaryFunction::Max, short, Exprs::ZERO);
        let power = self.instance.exprs.binary(BinaryFunction::Pow, short, two);
        self.instance.exprs.mul(least, power)
    }

    /// `actualStream(v)`: what flows through the port of `v` one way or the other.
    pub fn actual_stream(&mut self, variable: u32, flow: u32) -> ExprId {
        let (inward, own) =
            (self.in_stream(variable), self.instance.exprs.var(self.instance.variables[variable as usize].id));
        let flow = self.instance.exprs.var(self.instance.variables[flow as usize].id);
        let enters = self.instance.exprs.rel(RelationalOp::Gt, flow, Exprs::ZERO);
        self.instance.exprs.if_(enters, inward, own)
    }
}
