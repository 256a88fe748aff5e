//! Random linear networks against a nodal analysis of their own: what depends on what hangs on numbers here, in rings of
//! capacitors, bundles of inductors, and nodes that only dampers meet. Random hydraulic networks with lines run to their end.

use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use faer::Mat;
use faer::prelude::*;
use proptest::prelude::*;

/// Nodes beside the ground.
const NODES: usize = 4;
const STOP: f64 = 2.0;

/// The flow through a branch: in proportion to the difference of its levels, to its derivative, or to its integral.
#[derive(Clone, Copy, Debug)]
enum Law {
    Resistor,
    Capacitor,
    Inductor,
}

#[derive(Clone, Copy, Debug)]
struct Branch {
    law: Law,
    from: usize,
    to: usize,
    value: f64,
}

fn branches(laws: impl Strategy<Value = Law> + Clone) -> impl Strategy<Value = Vec<Branch>> {
    let branch = (laws, 0..=NODES, 0..NODES, 1_u32..6).prop_map(|(law, from, other, value)| {
        let to = if other >= from { other + 1 } else { other };
        Branch { law, from, to, value: f64::from(value) * 0.5 }
    });
    prop::collection::vec(branch, 5..11).prop_filter("all nodes hang together", |branches| {
        let mut group: Vec<usize> = (0..=NODES).collect();
        for b in branches {
            let (a, b) = (group[b.from], group[b.to]);
            group.iter_mut().filter(|g| **g == a).for_each(|g| *g = b);
        }
        group.iter().all(|g| *g == group[0])
    })
}

/// The levels of all nodes but the ground at the end, when `1 - cos(t)` flows into node 1, from `E x' + A x = b`: node
/// balances for the levels, and one equation for the flow of each inductor. Backward differences of second order.
fn levels(branches: &[Branch]) -> Vec<f64> {
    let coils = branches.iter().filter(|b| matches!(b.law, Law::Inductor)).count();
    let n = NODES + coils;
    let (mut e, mut a) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, n));
    let mut coil = NODES;
    for b in branches {
        let ends = [(b.from, 1.0), (b.to, -1.0)];
        let inner = || ends.into_iter().filter(|end| end.0 > 0).map(|(node, sign)| (node - 1, sign));
        let matrix = match b.law {
            Law::Resistor => &mut a,
            Law::Capacitor => &mut e,
            Law::Inductor => {
                e[(coil, coil)] = b.value;
                for (node, sign) in inner() {
                    a[(node, coil)] += sign;
                    a[(coil, node)] -= sign;
                }
                coil += 1;
                continue;
            }
        };
        for (i, s) in inner() {
            for (j, t) in inner() {
                matrix[(i, j)] += s * t * b.value;
            }
        }
    }
    let h = 1e-3;
    let lu = (Scale(1.5 / h) * &e + &a).partial_piv_lu();
    let (mut before, mut now) = (Mat::<f64>::zeros(n, 1), Mat::<f64>::zeros(n, 1));
    for step in 1..=(STOP / h).round() as usize {
        let mut rhs = Scale(1.0 / h) * &e * (Scale(2.0) * &now - Scale(0.5) * &before);
        rhs[(0, 0)] += 1.0 - (step as f64 * h).cos();
        before = std::mem::replace(&mut now, lu.solve(&rhs));
    }
    (0..NODES).map(|i| now[(i, 0)]).collect()
}

/// A model of resistors, capacitors and coils, and of what drives and holds its nodes.
const ELECTRIC: &str = "model M
  connector Pole Real v(nominal = 1); flow Real i; end Pole;
  partial model Two Pole p, n; Real v, i; equation v = p.v - n.v; i = p.i; p.i + n.i = 0; end Two;
  model Resistor extends Two; parameter Real k = 1; equation i = k*v; end Resistor;
  model Capacitor extends Two(v(start = 0)); parameter Real k = 1; equation i = k*der(v); end Capacitor;
  model Inductor extends Two(i(start = 0)); parameter Real k = 1; equation k*der(i) = v; end Inductor;
  model Ground Pole p; equation p.v = 0; end Ground;
  model Source Pole p; equation p.i = cos(time) - 1; end Source;
  model Node Pole p; equation p.i = 0; end Node;
";

/// The components of the library, of which a resistance is a function of a temperature that nothing heats.
const LIBRARY: &str = "model M
  connector Pole = Interfaces.Pin;
  model Resistor extends Electrical.Resistor(R = 1/k); parameter Real k = 1; end Resistor;
  model Capacitor extends Electrical.Capacitor(C = k); parameter Real k = 1; end Capacitor;
  model Inductor extends Electrical.Inductor(L = k); parameter Real k = 1; end Inductor;
  model Ground = Electrical.Ground;
  model Source Pole p; equation p.i = cos(time) - 1; end Source;
  model Node Pole p; equation p.i = 0; end Node;
";

/// The same of springs and dampers: positions for levels, forces for flows.
const MECHANIC: &str = "model M
  connector Pole Real v(nominal = 1); flow Real i; end Pole;
  partial model Two Pole p, n; Real s(start = 0), f; equation s = p.v - n.v; f = p.i; p.i + n.i = 0; end Two;
  model Resistor extends Two; parameter Real k = 1; equation f = k*s; end Resistor;
  model Capacitor extends Two; parameter Real k = 1; Real w; equation w = der(s); f = k*w; end Capacitor;
  model Ground Pole p; equation p.v = 0; end Ground;
  model Source Pole p; equation p.i = cos(time) - 1; end Source;
  model Node Pole p; equation p.i = 0; end Node;
";

fn model(classes: &str, branches: &[Branch]) -> String {
    let mut text = format!("{classes}  Ground g; Source s; Node node[{NODES}];\n");
    for (k, b) in branches.iter().enumerate() {
        text += &format!("  {:?} b{k}(k = {});\n", b.law, b.value);
    }
    text += "equation\n  connect(s.p, node[1].p);\n";
    let pole = |node: usize| if node == 0 { "g.p".to_owned() } else { format!("node[{node}].p") };
    for (k, b) in branches.iter().enumerate() {
        text += &format!("  connect(b{k}.p, {}); connect(b{k}.n, {});\n", pole(b.from), pole(b.to));
    }
    text + "end M;\n"
}

/// What bramah makes of it, or its message.
fn simulated(text: &str) -> Result<Vec<f64>, String> {
    let world = MemoryWorld::single("model.mo", text);
    let request = Request { source: "model.mo".into(), model: Some("M".into()), ..Request::default() };
    let mut simulation = Simulation::compile(&world, &request).map_err(|e| e.to_string())?;
    let settings = simulation.settings();
    (settings.stop_time, settings.interval, settings.tolerance) = (STOP, STOP, 1e-8);
    let run = simulation.run().map_err(|e| e.to_string())?.trajectory;
    let end = |node: usize| *run.column(&format!("node[{node}].p.v")).expect("a level").last().expect("a row");
    Ok((1..=NODES).map(end).collect())
}

fn agree(branches: &[Branch], text: &str) -> Result<(), TestCaseError> {
    let expected = levels(branches);
    let size = expected.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
    let found = simulated(text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
    for (a, b) in found.iter().zip(&expected) {
        prop_assert!((a - b).abs() < 1e-4 * size, "{found:?} instead of {expected:?}\n{text}");
    }
    Ok(())
}

fn electric() -> impl Strategy<Value = Law> + Clone {
    prop_oneof![Just(Law::Resistor), Just(Law::Capacitor), Just(Law::Inductor)]
}

fn mechanical() -> impl Strategy<Value = Law> + Clone {
    prop_oneof![Just(Law::Resistor), Just(Law::Capacitor)]
}

/// Lines from node to node, so that all that flows in finds the tank, and what else joins them: at each node a plug, a flow
/// that jumps into the last one.
fn hydraulic(further: &[(&str, usize, usize)]) -> String {
    let mut text = "model M inner Oil.Fluid oil; Hydraulic.Tank tank; Hydraulic.FlowSource source(useInput = true, q_in = if time < 0.1 then 1e-4 else 2e-4);\n".to_owned();
    let mut joins = format!("connect(tank.port, plug[1].port); connect(source.port, plug[{NODES}].port);\n");
    text += &format!("Hydraulic.Plug plug[{NODES}];\n");
    let chain = (1..NODES).map(|node| ("Hydraulic.Line", node - 1, node));
    for (k, (class, from, to)) in chain.chain(further.iter().copied()).enumerate() {
        text += &format!("{class} b{k};\n");
        joins +=
            &format!("connect(b{k}.port_a, plug[{}].port); connect(b{k}.port_b, plug[{}].port);\n", from + 1, to + 1);
    }
    text + "equation\n" + &joins + "end M;\n"
}

fn joined() -> impl Strategy<Value = Vec<(&'static str, usize, usize)>> {
    let class = prop_oneof![
        2 => Just("Hydraulic.Line"),
        1 => Just("Hydraulic.Orifice"),
        1 => Just("Hydraulic.LaminarGap"),
        1 => Just("Hydraulic.CheckValve"),
        1 => Just("Hydraulic.ReliefValve"),
    ];
    let element = (class, 0..NODES, 0..NODES - 1)
        .prop_map(|(class, from, other)| (class, from, if other >= from { other + 1 } else { other }));
    prop::collection::vec(element, 0..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn lines_join_whatever_there_is(further in joined()) {
        let text = hydraulic(&further);
        let world = MemoryWorld::single("model.mo", &*text);
        let request = Request { source: "model.mo".into(), model: Some("M".into()), ..Request::default() };
        let ran = Simulation::compile(&world, &request).and_then(|mut s| s.stop_time(0.5).run().map(|run| run.trajectory));
        let trajectory = ran.map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        for node in 1..=NODES {
            let p = trajectory.column(&format!("plug[{node}].port.p")).expect("a pressure");
            prop_assert!(p.iter().all(|p| *p > 0.0), "{text}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn resistors_capacitors_and_inductors_as_nodal_analysis_says(branches in branches(electric())) {
        agree(&branches, &model(ELECTRIC, &branches))?;
    }

    #[test]
    fn the_library_as_nodal_analysis_says(branches in branches(electric())) {
        agree(&branches, &model(LIBRARY, &branches))?;
    }

    #[test]
    fn springs_and_dampers_without_mass_as_nodal_analysis_says(branches in branches(mechanical())) {
        agree(&branches, &model(MECHANIC, &branches))?;
    }
}
