//! The network of an instance: which ports are joined, the connection sets that follow, and the ports left open.

mod connect;
pub use connect::component_scopes;
mod graph;
mod overconstrained;

pub use graph::{ComponentBox, ComponentEdge, ComponentGraph};
pub use overconstrained::OverconstrainedLink;
pub use overconstrained::is_graph_statement;

use crate::instance::{Instance, NodeId, ScopeId, StreamMember};
use bramah_syntax::diag::Span;

/// One `connect` equation between two single ports.
#[derive(Clone, Debug)]
pub struct Connection {
    /// One port.
    pub a: NodeId,
    /// The other.
    pub b: NodeId,
    /// Its place.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// Variables that must be equal: indices into `Instance::variables`.
#[derive(Clone, Debug)]
pub struct PotentialSet {
    /// The variables, in the order in which they were joined, each with the `connect` that brought it.
    pub members: Vec<(u32, Span)>,
    /// The instance in which the first connection stands.
    pub scope: ScopeId,
}

/// Flows that must sum up to zero.
#[derive(Clone, Debug)]
pub struct FlowSet {
    /// The variables; `true` for a port of the component itself, seen from inside, which counts negative.
    pub members: Vec<(u32, bool)>,
    /// The `connect` that joined the first two.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// Joined stream variables.
#[derive(Clone, Debug)]
pub struct StreamSet {
    /// The variables with the flows of their connectors.
    pub members: Vec<StreamMember>,
    /// The `connect` that joined the first two.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// Two signals joined by a `connect`: indices into `Instance::variables`.
#[derive(Clone, Copy, Debug)]
pub struct SignalPair {
    /// One variable.
    pub a: u32,
    /// The other.
    pub b: u32,
    /// The `connect`.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// The connections of a model.
#[derive(Clone, Debug, Default)]
pub struct Network {
    /// All connections in the order in which they stand.
    pub connections: Vec<Connection>,
    /// Equal potentials.
    pub potentials: Vec<PotentialSet>,
    /// Flow sums.
    pub flows: Vec<FlowSet>,
    /// Joined streams.
    pub streams: Vec<StreamSet>,
    /// Overconstrained components that are equal by their types' constraint.
    pub constrained: Vec<OverconstrainedLink>,
    /// Joined inputs and outputs.
    pub signals: Vec<SignalPair>,
    /// Variables of expandable connectors that nothing is connected to.
    pub unused: Vec<u32>,
    /// Flow variables of ports that nothing is connected to from outside.
    pub open: Vec<u32>,
}

/// Finds all connections of an instance. Messages go to the instance.
pub fn network(instance: &mut Instance<'_, '_>) -> Network {
    connect::ConnectionCollector::default().collect(instance)
}
