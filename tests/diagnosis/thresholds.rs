//! Effects that act only beyond a threshold: a recording, or a fold of it, in which they hardly act determines them badly.

#![allow(clippy::unwrap_used, reason = "tests")]

use crate::gap::{Normal, played, verdict};
use crate::rig::Numbers;

use bramah::world::MemoryWorld;

/// A tank with a laminar outlet; the plant has a brim, above which a thousandfold of the outlet's conductance runs off.
const TANK: &str = "
package Brim
  model Open
    Interfaces.HydraulicPort port;
    parameter Real A(unit = \"m2\") = 0.01;
    Real h(unit = \"m\", start = 0.3, fixed = true, nominal = 0.3);
  equation
    A*der(h) = port.q; port.p = 101325 + 9810*h;
  end Open;
  model Outlet
    Interfaces.HydraulicPort port_a; Interfaces.HydraulicPort port_b;
    parameter Real G(unit = \"m3/(s.Pa)\") = 1e-8;
  equation
    port_a.q = G*(port_a.p - port_b.p); port_a.q + port_b.q = 0;
  end Outlet;
  model Nominal
    inner Oil.Water oil;
    Interfaces.RealInput u;
    Hydraulic.FlowSource feed(useInput = true); Open open; Outlet outlet; Hydraulic.Tank drain;
    Real h(unit = \"m\");
  equation
    connect(u, feed.q_in); connect(feed.port, open.port); connect(open.port, outlet.port_a);
    connect(outlet.port_b, drain.port); h = open.h;
  end Nominal;
  model Plant
    extends Nominal(open(A = 0.0102), outlet(G = 1.01e-8));
    parameter Real K(unit = \"m3/(s.Pa)\") = 1e-5;
    Hydraulic.FlowSource over(useInput = true);
  equation
    over.q_in = -K*max(open.port.p - 101325 - 3900, 0);
    connect(over.port, open.port);
  end Plant;
end Brim;";

const STUDY: &str = "
version = 1
model = \"Brim.mo\"
class = \"Brim.Nominal\"
[inputs]
u = { column = \"u\", unit = \"m3/s\", hold = true }
[signals]
h = { variable = \"h\", column = \"h\", unit = \"m\" }
[[recordings]]
file = \"train.csv\"
role = \"train\"
time = \"t\"
[[recordings]]
file = \"held.csv\"
role = \"held\"
time = \"t\"
[parameters]
\"open.A\" = { sigma = \"3 %\" }
\"outlet.G\" = { sigma = \"3 %\" }
";

/// Steps of the inflow, most of which leave the tank below its brim.
fn recording(world: &MemoryWorld, seed: u64) -> String {
    let mut random = Numbers(seed);
    let flows: Vec<f64> = (0..16).map(|_| 5e-5 * random.next()).collect();
    let input: Vec<f64> = flows.iter().flat_map(|u| [*u; 100]).collect();
    let mut noise = Normal(Numbers(seed + 100));
    played(world, ("Brim.mo", "Brim.Plant"), &[], (&input, 2.0), &[("h", "h", 5e-4)], &mut noise)
}

/// A brim without any width: with the width of its corner free the effect fits. Where the level hardly reaches
/// it, all but its height is far from determined, and one undamped Gauss-Newton step of a fold would throw the rest away.
#[test]
fn a_sharp_brim_is_found() {
    let world = MemoryWorld::single("Brim.mo", TANK);
    let (train, held) = (recording(&world, 5), recording(&world, 6));
    let verdict = verdict(world, STUDY, train, held);
    let first = verdict.effects.first().expect("an effect");
    assert_eq!(first.family, "overflow", "{:?}", verdict.effects.iter().map(|e| &e.effect).collect::<Vec<_>>());
    // to a corner's width
    let brim = first.parameters["p_o"].value;
    assert!((brim - 3900.0).abs() < 150.0, "{brim} Pa");
}
