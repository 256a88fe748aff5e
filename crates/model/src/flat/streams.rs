//! Stream variables: what a flow carries with it, such as its enthalpy (MLS chapter 15).
//!
//! What enters a component is mixed from what the other members of its connection set send out, each weighed by its
//! flow into the node. [`prepare`] gives the instance the connection sets before expressions are evaluated, so that
//! `inStream` has a meaning; [`equations`] states what leaves through ports of components that have parts inside.
//! `flatten` calls both.

use super::{ElementOrigin, FlatEquation, FlatModel, OriginKind};
use crate::instance::{Instance, MixingJunction, StreamMember};
use crate::network::Network;

use super::numbers::ComponentNumbers;
use petgraph::unionfind::UnionFind;

/// Stores in the instance which stream variables are joined. Outside connectors are those of the component that
/// contains the connections.
/// The sets keep the order of [`Network::streams`].
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

/// Finds the nodes with a component that mixes, and records them as junctions.
///
/// A node extends through the ports of components that have parts inside. Of several mixing components at one node the
/// one declared first is the junction; the others are connected to it like any other component.
fn junctions(instance: &mut Instance<'_, '_>) {
    let streams = &instance.streams;
    // Sets that share a port, once from inside and once from outside, are one node.
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
        // Most nodes have no mixing component; their streams are mixed by the equations of `inStream`.
        let Some(mixer) = mixing.min() else { continue };
        others.retain(|m| m.variable != mixer);
        found[i] = Some(all.len());
        all.push(MixingJunction { mixer, others });
    }
    instance.streams.at = (0..found.len()).map(|i| found[nodes.find(i)]).collect();
    instance.streams.junctions = all;
}

/// Appends an equation for each stream variable of a port whose component has parts joined to it: what leaves is the
/// mixture of what the parts send there.
///
/// At a junction it is what the mixing component sends out. The same expression is noted in the instance, where
/// `inStream` of others reads it.
pub(super) fn equations(
    instance: &mut Instance<'_, '_>,
    network: &Network,
    numbers: &ComponentNumbers,
    flat: &mut FlatModel,
) {
    let mut sets: Vec<_> = network.streams.iter().enumerate().collect();
    // Parts have larger numbers than what contains them. They come first, so that the mixture outside can read theirs.
    sets.sort_by_key(|(_, set)| std::cmp::Reverse(numbers.of(set.scope)));
    for (number, set) in sets {
        for member in set.members.iter().filter(|m| m.outside) {
            let others: Vec<StreamMember> = set.members.iter().filter(|m| *m != member).copied().collect();
            let lhs = instance.exprs.var(instance.variables[member.variable as usize].id);
            let rhs = match instance.streams.junction(number).map(|junction| junction.mixer) {
                Some(mixer) => instance.mixing().leaving(mixer),
                None => instance.mixing().stream_mixture(&others, crate::instance::evaluation::streams::LEAST_MIXED),
            };
            instance.mixing().leaves_with(member.variable, rhs);
            let origin =
                ElementOrigin { span: set.span, instance: numbers.of(set.scope), kind: OriginKind::ConnectPotential };
            flat.equations.push(FlatEquation { lhs, rhs, origin });
        }
    }
}
