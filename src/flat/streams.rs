//! Stream variables: what a flow carries with it (MLS 15). What comes into a component is mixed from what the others of its
//! connection set send out, each weighed by its flow.

use super::{Equation, FlatModel, Origin, OriginKind};
use crate::expr::{Binary, ExprId, Exprs, Rel};
use crate::instance::{Instance, LEAST_FLOW, StreamMember};
use crate::network::Network;

use super::numbers::Numbers;

/// Tells the instance which stream variables are joined, so that `inStream` has a meaning in its equations.
pub(super) fn prepare(instance: &mut Instance<'_, '_>, network: &Network) {
    for set in &network.streams {
        let number = instance.streams.sets.len();
        for member in &set.members {
            if !member.outside {
                instance.streams.inside.insert(member.variable, number);
            }
        }
        instance.streams.sets.push(set.members.clone());
    }
}

/// What leaves through the ports of a component itself is the mixture of what its parts send there.
pub(super) fn equations(instance: &mut Instance<'_, '_>, network: &Network, numbers: &Numbers, flat: &mut FlatModel) {
    for set in &network.streams {
        for member in set.members.iter().filter(|m| m.outside) {
            let others: Vec<StreamMember> = set.members.iter().filter(|m| *m != member).copied().collect();
            let lhs = instance.exprs.var(instance.variables[member.variable as usize].id);
            let rhs = instance.stream_mixture(&others);
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
        let members = &self.streams.sets[set];
        let others: Vec<StreamMember> =
            members.iter().filter(|m| m.outside || m.variable != variable).copied().collect();
        if others.is_empty() { own } else { self.stream_mixture(&others) }
    }

    fn stream_mixture(&mut self, members: &[StreamMember]) -> ExprId {
        let mut parts = Vec::with_capacity(members.len());
        for m in members {
            let value = match m.outside {
                true => self.in_stream(m.variable),
                false => self.exprs.var(self.variables[m.variable as usize].id),
            };
            let flow = self.exprs.var(self.variables[m.flow as usize].id);
            let towards = if m.outside { flow } else { self.exprs.neg(flow) };
            let least = self.exprs.num(LEAST_FLOW);
            parts.push((value, self.exprs.binary(Binary::Max, towards, least)));
        }
        if let [(value, _)] = parts[..] {
            return value;
        }
        let (mut carried, mut all) = (Exprs::ZERO, Exprs::ZERO);
        for (value, weight) in parts {
            let part = self.exprs.mul(weight, value);
            carried = self.exprs.add(carried, part);
            all = self.exprs.add(all, weight);
        }
        self.exprs.div(carried, all)
    }

    /// `actualStream(v)`: what flows through the port of `v` one way or the other.
    pub fn actual_stream(&mut self, variable: u32, flow: u32) -> ExprId {
        let (inward, own) = (self.in_stream(variable), self.exprs.var(self.variables[variable as usize].id));
        let flow = self.exprs.var(self.variables[flow as usize].id);
        let enters = self.exprs.rel(Rel::Gt, flow, Exprs::ZERO);
        self.exprs.if_(enters, inward, own)
    }
}
