//! Closed circuits keep their oil to rounding, however long they run and however often voids open and close in them.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use bramah::Simulation;
use rig::{circuit, column, last, near, run};

/// The largest change of the sum of masses, over the sum.
fn drift(t: &bramah::results::Trajectory, masses: &[&str]) -> f64 {
    let sum = |i: usize| masses.iter().map(|m| column(t, m)[i]).sum::<f64>();
    (0..t.len()).map(|i| (sum(i) / sum(0) - 1.0).abs()).fold(0.0, f64::max)
}

fn without_event_rows(mut simulation: Simulation, stop: f64) -> bramah::results::Trajectory {
    simulation.settings().event_rows = false;
    simulation.settings().interval = stop / 100.0;
    run(simulation.stop_time(stop))
}

#[test]
fn a_closed_chamber_returns_to_its_pressure() {
    for tolerance in [1e-4, 1e-6] {
        let mut simulation = circuit(
            "Hydraulic.Chamber c(A = 1e-3, V_0 = 1e-4, p_start = 5e5);
             Hydraulic.Plug plug;
             Mechanical.Translational.Position drive;",
            "connect(c.port, plug.port); connect(drive.flange, c.flange);
             drive.s_ref = 0.1*(1 - cos(2*Modelica.Constants.pi*time));",
        );
        simulation.settings().tolerance = tolerance;
        let t = without_event_rows(simulation, 1000.0);
        near(last(&t, "c.p"), 5e5, 1e-3);
    }
}

#[test]
fn volumes_of_one_pressure_keep_their_sum() {
    let simulation = circuit(
        "Hydraulic.Cylinder c(stroke = 0.2, s_start = 0.1, p_1_start = 5e6, p_2_start = 5e6);
         Hydraulic.Volume v_1(V = 2e-4, p_start = 5e6), v_2(V = 3e-4, p_start = 5e6), w_2(V = 1e-4, p_start = 5e6);
         Hydraulic.FlowSensor sensor;
         Mechanical.Translational.Position drive;",
        "connect(c.port_1, v_1.port); connect(c.port_2, sensor.port_a); connect(sensor.port_b, v_2.port);
         connect(v_2.port, w_2.port); connect(drive.flange, c.flange);
         drive.s_ref = 0.1 + 0.002*sin(2*Modelica.Constants.pi*time);",
    );
    let work = simulation.clone().stop_time(0.1).run().expect("it runs").statistics;
    assert_eq!((work.states, work.unknowns), (2, 4), "each side has one pressure and one mass");
    let t = without_event_rows(simulation, 600.0);
    // pressures of rows between the steps are interpolated; the last row is a step's end
    let sum = |i: usize| {
        let masses = ["c.chamber_1.mass", "c.chamber_2.mass", "v_1.mass", "v_2.mass", "w_2.mass"];
        masses.iter().map(|m| column(&t, m)[i]).sum::<f64>()
    };
    near(sum(t.len() - 1), sum(0), 1e-9);
}

/// A pump, a line with volumes at its ends, volumes and accumulators, to and fro for an hour.
#[test]
fn a_closed_loop_keeps_its_oil_for_an_hour() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil;
         Hydraulic.GearPump p(V = 1e-5);
         Mechanical.Rotational.Speed drive;
         Hydraulic.Line line(L = 2, n = 2, volume_a = true, volume_b = true, p_start = 3e6);
         Hydraulic.Volume v(V = 1e-4, p_start = 3e6), low(V = 1e-3, p_start = 3e6);
         Hydraulic.Accumulator a(p_pre = 1e6, p_start = 3e6), b(p_pre = 1e6, p_start = 3e6);
         Hydraulic.Orifice o(A = 4e-6);",
        "connect(drive.flange, p.flange); drive.w_ref = 50*sin(0.2*time);
         connect(p.port_a, v.port); connect(v.port, line.port_a); connect(line.port_b, o.port_a);
         connect(line.port_b, a.port); connect(o.port_b, low.port); connect(low.port, b.port);
         connect(low.port, p.port_b);",
    );
    simulation.settings().tolerance = 1e-8;
    let t = without_event_rows(simulation, 3600.0);
    let masses = ["line.mass", "v.mass", "low.mass", "a.mass", "b.mass"];
    assert!(drift(&t, &masses) < 1e-9, "{}", drift(&t, &masses));
}

/// Oil that keeps its density as it is compressed stores by its modulus: a closed chamber returns to its pressure too.
#[test]
fn textbook_oil_returns_to_its_pressure() {
    let simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity);
         Hydraulic.Chamber c(A = 1e-3, V_0 = 1e-4, p_start = 5e6);
         Hydraulic.Plug plug;
         Mechanical.Translational.Position drive;",
        "connect(c.port, plug.port); connect(drive.flange, c.flange);
         drive.s_ref = 1e-4*(1 - cos(2*Modelica.Constants.pi*time));",
    );
    let t = without_event_rows(simulation, 100.0);
    near(last(&t, "c.p"), 5e6, 1e-6);
}

/// Gas in a cylinder that is moved to and fro by itself: mass and, without heat transfer, the work that goes in.
#[test]
fn closed_gas_returns_to_its_state() {
    let simulation = circuit(
        "inner Pneumatic.Gas gas;
         Pneumatic.Chamber c(A = 1e-3, V_0 = 1e-4);
         Pneumatic.Plug plug;
         Mechanical.Translational.Position drive;",
        "connect(c.port, plug.port); connect(drive.flange, c.flange);
         drive.s_ref = 0.1*(1 - cos(2*Modelica.Constants.pi*time));",
    );
    let t = without_event_rows(simulation, 100.0);
    // between the steps, pressure and temperature are interpolated apart; the last row is a step's end
    near(last(&t, "c.mass"), column(&t, "c.mass")[0], 1e-9);
}
