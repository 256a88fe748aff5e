//! Power balances: the power into each component through its ports, and from component to component.
//!
//! A flat model gives the ports ([`ports`]) and the variables to record ([`wanted`]); the rows of a run give powers in
//! W ([`powers`]); the graph of connections turns them into balances ([`budgets`]) and flows for a Sankey diagram
//! ([`streams`]). `bramah steady --balance` calls it.

use bramah_expr::VarId;
use bramah_expr::units::{Dimension, MeasurementUnit};
use bramah_model::flat::FlatModel;
use bramah_model::network::ComponentGraph;
use bramah_results::Trajectory;
use std::collections::BTreeMap;

/// A port of a top-level component through which power flows.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerPort {
    /// The component.
    pub component: String,
    /// The port, relative to it.
    pub name: String,
    /// The flow variable, positive into the component.
    flow: VarId,
    /// What the flow is multiplied with.
    partner: ConjugateVariable,
}

/// What a flow variable is multiplied with to give power.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ConjugateVariable {
    /// Nothing: the flow itself is power, as heat flow.
    Own,
    /// A potential, such as pressure, voltage or speed.
    Potential(VarId),
    /// The derivative of a position or angle.
    Rate(VarId),
}

/// Dimension of power, kg m^2 s^-3.
const POWER: Dimension = Dimension::new([1, 2, -3, 0, 0, 0, 0]);
/// Dimension of energy, kg m^2 s^-2.
const ENERGY: Dimension = Dimension::new([1, 2, -2, 0, 0, 0, 0]);

/// The power ports of the model's top-level components, recognised by the units of their variables.
pub fn ports(flat: &FlatModel) -> Vec<PowerPort> {
    let ids = || (0..).map(VarId).zip(&flat.variables);
    let mut found = Vec::new();
    for (flow, variable) in ids().filter(|(_, v)| v.flow) {
        let Some((connector, _)) = variable.name.rsplit_once('.') else { continue };
        let Some((component, port)) = connector.split_once('.') else { continue };
        // Ports of parts inside a component do not cross its boundary.
        if port.contains('.') {
            continue;
        }
        let siblings = ids().filter(|(_, v)| {
            !v.flow
                && v.name.strip_prefix(connector).and_then(|r| r.strip_prefix('.')).is_some_and(|r| !r.contains('.'))
        });
        let siblings: Vec<(VarId, Dimension)> =
            siblings.filter_map(|(v, s)| Some((v, dimension(s.unit.as_deref()?)?))).collect();
        let partner = variable.unit.as_deref().and_then(dimension).and_then(|d| partner(d, &siblings));
        if let Some(partner) = partner {
            found.push(PowerPort { component: component.to_owned(), name: port.to_owned(), flow, partner });
        }
    }
    found
}

/// The dimension of a unit; `None` for a text that is no unit.
fn dimension(unit: &str) -> Option<Dimension> {
    MeasurementUnit::parse(unit).ok().map(|u| u.dimension)
}

/// The variable of the same connector whose product with the flow is power, or energy for a position. `None` where
/// there is none, so that the port carries no power.
fn partner(flow: Dimension, siblings: &[(VarId, Dimension)]) -> Option<ConjugateVariable> {
    if flow == POWER {
        return Some(ConjugateVariable::Own);
    }
    let times = |wanted: Dimension| siblings.iter().find(|s| s.1.times(flow) == Some(wanted)).map(|s| s.0);
    times(POWER).map(ConjugateVariable::Potential).or_else(|| times(ENERGY).map(ConjugateVariable::Rate))
}

/// The variables to record for [`powers`], each once, in the order of their ids.
pub fn wanted(ports: &[PowerPort]) -> Vec<VarId> {
    let of = |p: &PowerPort| match p.partner {
        ConjugateVariable::Own => vec![p.flow],
        ConjugateVariable::Potential(v) | ConjugateVariable::Rate(v) => vec![p.flow, v],
    };
    let mut all: Vec<VarId> = ports.iter().flat_map(of).collect();
    all.sort();
    all.dedup();
    all
}

/// The mean power into each port over a run, in W. The first columns of `rows` are those of [`wanted`].
pub fn powers(ports: &[PowerPort], rows: &Trajectory) -> Vec<f64> {
    let wanted = wanted(ports);
    let column = |v: VarId| wanted.binary_search(&v).ok().map_or(&[] as &[f64], |k| rows.columns[k].as_slice());
    let duration = rows.times.last().zip(rows.times.first()).map_or(0.0, |(a, b)| a - b);
    let one = |p: &PowerPort| {
        let flow = column(p.flow);
        let steps = rows.times.windows(2).enumerate();
        let energy: f64 = match p.partner {
            ConjugateVariable::Own => steps.map(|(k, t)| 0.5 * (flow[k] + flow[k + 1]) * (t[1] - t[0])).sum(),
            // Trapezoidal rule over the product.
            ConjugateVariable::Potential(v) => {
                let p = column(v);
                steps.map(|(k, t)| 0.5 * (p[k] * flow[k] + p[k + 1] * flow[k + 1]) * (t[1] - t[0])).sum()
            }
            ConjugateVariable::Rate(v) => {
                let s = column(v);
                // Force times displacement. The two rows of an event have the same time, and a position jumps only by
                // `reinit`.
                let moves = steps.filter(|(_, t)| t[1] > t[0]);
                moves.map(|(k, _)| 0.5 * (flow[k] + flow[k + 1]) * (s[k + 1] - s[k])).sum()
            }
        };
        if duration > 0.0 { energy / duration } else { f64::NAN }
    };
    ports.iter().map(one).collect()
}

/// The power balance of a component.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerBalance {
    /// Its name.
    pub component: String,
    /// Its class; empty where the component has no connection.
    pub class: String,
    /// Power into each port in W.
    pub ports: Vec<(String, f64)>,
    /// Their sum in W: lost or stored power; negative for a source.
    pub net: f64,
}

/// The balances of all components, largest net power first.
pub fn budgets(ports: &[PowerPort], powers: &[f64], graph: &ComponentGraph) -> Vec<PowerBalance> {
    let mut by: BTreeMap<&str, PowerBalance> = BTreeMap::new();
    for (port, &power) in ports.iter().zip(powers) {
        let class = graph.node_weights().find(|n| n.name == port.component).map_or("", |n| n.class.as_str());
        let budget = by.entry(&port.component).or_insert_with(|| PowerBalance {
            component: port.component.clone(),
            class: class.to_owned(),
            ports: Vec::new(),
            net: 0.0,
        });
        budget.ports.push((port.name.clone(), power));
        budget.net += power;
    }
    let mut all: Vec<PowerBalance> = by.into_values().collect();
    all.sort_by(|a, b| b.net.total_cmp(&a.net));
    all
}

/// Power that flows from one component to another.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerFlow {
    /// The component that it leaves.
    pub from: String,
    /// The component that it enters.
    pub to: String,
    /// In W, positive.
    pub power: f64,
}

/// The flows through the connections. Where more than two ports meet, each consumer is fed by all suppliers, in
/// proportion to their powers.
pub fn streams(ports: &[PowerPort], powers: &[f64], graph: &ComponentGraph) -> Vec<PowerFlow> {
    let mut streams: BTreeMap<(String, String), f64> = BTreeMap::new();
    for set in meetings(ports, graph) {
        let given: f64 = set.iter().map(|&p| (-powers[p]).max(0.0)).sum();
        for &a in set.iter().filter(|&&p| powers[p] < 0.0) {
            for &b in set.iter().filter(|&&p| powers[p] > 0.0) {
                let power = -powers[a] * powers[b] / given;
                *streams.entry((ports[a].component.clone(), ports[b].component.clone())).or_default() += power;
            }
        }
    }
    let all = streams.into_iter().filter(|(ends, _)| ends.0 != ends.1);
    all.map(|((from, to), power)| PowerFlow { from, to, power }).collect()
}

/// What components that pass power on lose or store, as flows to `name`.
///
/// Losses that are not conducted away as heat have no port, so no connection shows them. A component that only takes
/// power, as a load, is the end of its flow already.
pub fn left(budgets: &[PowerBalance], name: &str) -> Vec<PowerFlow> {
    let passing = budgets.iter().filter(|b| b.net > 0.0 && b.ports.iter().any(|p| p.1 < 0.0));
    passing.map(|b| PowerFlow { from: b.component.clone(), to: name.to_owned(), power: b.net }).collect()
}

/// Groups of connected ports, by their indices in `ports`.
fn meetings(ports: &[PowerPort], graph: &ComponentGraph) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..ports.len()).collect();
    let find = |component: &str, name: &str| ports.iter().position(|p| p.component == component && p.name == name);
    for edge in graph.edge_indices() {
        let Some((a, b)) = graph.edge_endpoints(edge) else { continue };
        let wire = &graph[edge];
        let ends = find(&graph[a].name, &wire.from).zip(find(&graph[b].name, &wire.to));
        // The graph is undirected, so the ends of an edge may come in either order.
        let swapped = find(&graph[b].name, &wire.from).zip(find(&graph[a].name, &wire.to));
        if let Some((a, b)) = ends.or(swapped) {
            let (low, high) = (group[a].min(group[b]), group[a].max(group[b]));
            group.iter_mut().filter(|g| **g == high).for_each(|g| *g = low);
        }
    }
    let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    group.into_iter().enumerate().for_each(|(port, g)| sets.entry(g).or_default().push(port));
    sets.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_circuit::Simulation;
    use bramah_model::compile::Request;
    use bramah_syntax::world::MemoryWorld;

    #[test]
    fn a_resistor_takes_what_a_source_gives() {
        let text = "model M
            connector Pin Real v(unit = \"V\"); flow Real i(unit = \"A\"); end Pin;
            model Source Pin p, n; equation p.v - n.v = 12; p.i + n.i = 0; end Source;
            model Resistor Pin p, n; parameter Real R(unit = \"Ohm\") = 3; equation p.v - n.v = R*p.i; p.i + n.i = 0; end Resistor;
            model Ground Pin p; equation p.v = 0; end Ground;
            Source s; Resistor r; Resistor q; Ground g;
          equation
            connect(s.p, r.p); connect(r.n, q.p); connect(q.n, s.n); connect(s.n, g.p);
          end M;";
        let world = MemoryWorld::single("m.mo", text);
        let mut simulation =
            Simulation::compile(&world, &Request { source: "m.mo".into(), ..Request::default() }).expect("sound");
        let model = simulation.model().clone();
        let ports = ports(&model.flat);
        simulation.settings().wanted = wanted(&ports);
        let rows = simulation.run().expect("runs").trajectory;
        let powers = powers(&ports, &rows);
        let budgets = budgets(&ports, &powers, &model.graph);
        let net = |c: &str| budgets.iter().find(|b| b.component == c).expect("there").net;
        assert!((net("r") - 12.0).abs() < 1e-9 && (net("q") - 12.0).abs() < 1e-9 && (net("s") + 24.0).abs() < 1e-9);
        assert!(budgets.iter().map(|b| b.net).sum::<f64>().abs() < 1e-9);
        let streams = streams(&ports, &powers, &model.graph);
        let stream = |a: &str, b: &str| streams.iter().find(|s| s.from == a && s.to == b).map(|s| s.power);
        assert_eq!(stream("s", "r").map(f64::round), Some(24.0));
        assert_eq!(stream("r", "q").map(f64::round), Some(12.0));
    }

    /// A motor drives a pump on a throttle: what the pump loses flows out of it, so that as much leaves as goes in.
    #[test]
    fn what_a_machine_loses_flows_out_of_it() {
        let world = MemoryWorld::default();
        let request = Request { source: "Hydraulic.Examples.PumpExample".into(), ..Request::default() };
        let mut simulation = Simulation::compile(&world, &request).expect("sound");
        let model = simulation.model().clone();
        let ports = ports(&model.flat);
        let loss = model.flat.variables.iter().position(|v| v.name == "pump.lossPower").expect("there");
        let mut wanted = wanted(&ports);
        wanted.push(VarId(u32::try_from(loss).expect("small")));
        simulation.settings().wanted = wanted;
        let rows = simulation.run().expect("runs").trajectory;
        let powers = powers(&ports, &rows);
        let budgets = budgets(&ports, &powers, &model.graph);
        let mut all = streams(&ports, &powers, &model.graph);
        all.extend(left(&budgets, "lost"));
        let of_pump = |s: &&PowerFlow| s.from == "pump" || s.to == "pump";
        let net: f64 = all.iter().filter(of_pump).map(|s| if s.to == "pump" { s.power } else { -s.power }).sum();
        let lost = all.iter().find(|s| s.from == "pump" && s.to == "lost").expect("a stream").power;
        let said = rows.columns.last().and_then(|c| c.last()).copied().expect("rows");
        assert!(net.abs() < 1e-6 * lost && (lost - said).abs() < 0.2 * said, "{net} {lost} {said}");
        assert!(left(&budgets, "lost").iter().all(|s| s.power > 0.0));
    }
}
