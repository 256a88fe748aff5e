//! The network of an instance: which ports are joined, the connection sets that follow, and the ports left open.
//!
//! Enters: an `Instance`. Leaves: a [`Network`], whose sets `flat` turns into equations (MLS 9.2). `compile` calls
//! [`network`] before flattening. `connect` collects the connections, `overconstrained` finds the spanning trees of
//! overconstrained connectors (MLS 9.4), `graph` gives pictures and the diagnosis a graph of the components.

mod connect;
pub use connect::component_scopes;
mod graph;
mod overconstrained;

pub use graph::{ComponentBox, ComponentEdge, ComponentGraph};
pub use overconstrained::OverconstrainedLink;
pub use overconstrained::is_graph_statement;

use crate::instance::{Instance, NodeId, ScopeId, StreamMember};
use bramah_syntax::diag::Span;

/// One `connect` equation between two single ports. Arrays of ports give one entry for each pair of elements.
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

/// A connection set of potentials: variables that must be equal. Variables are indices into `Instance::variables`.
#[derive(Clone, Debug)]
pub struct PotentialSet {
    /// The variables, in the order in which they were joined, each with the `connect` that brought it.
    pub members: Vec<(u32, Span)>,
    /// The instance in which the first connection stands.
    pub scope: ScopeId,
}

/// A connection set of flows: they must sum up to zero.
#[derive(Clone, Debug)]
pub struct FlowSet {
    /// The variables. `true` marks an outside connector: a port of the component that contains the connections, whose
    /// flow counts negative (MLS 9.2).
    pub members: Vec<(u32, bool)>,
    /// The `connect` that joined the first two.
    pub span: Span,
    /// The instance in which it stands.
    pub scope: ScopeId,
}

/// A connection set of stream variables (MLS chapter 15).
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

/// The connections of a model and the sets that they form.
#[derive(Clone, Debug, Default)]
pub struct Network {
    /// All connections, in the order in which they stand in the text, component by component.
    pub connections: Vec<Connection>,
    /// Sets of equal potentials. Signals that are joined are in these sets too.
    pub potentials: Vec<PotentialSet>,
    /// Sets of flows. A flow variable may be in two sets: in one as an inside connector, in one as an outside
    /// connector.
    pub flows: Vec<FlowSet>,
    /// Joined streams.
    pub streams: Vec<StreamSet>,
    /// Connections of overconstrained components that are equal by the constraint of their type, because they would
    /// close a loop of the connection graph.
    pub constrained: Vec<OverconstrainedLink>,
    /// Pairs of joined variables of which one is an input or output.
    pub signals: Vec<SignalPair>,
    /// Variables of expandable connectors that nothing is connected to and that have no binding.
    pub unused: Vec<u32>,
    /// Flow variables of ports that nothing is connected to from outside. Their flow is 0.
    pub open: Vec<u32>,
}

/// Finds all connections of an instance. Messages go to the instance; a connection with an error is left out.
pub fn network(instance: &mut Instance<'_, '_>) -> Network {
    connect::ConnectionCollector::default().collect(instance)
}
