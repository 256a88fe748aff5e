//! Valves that hold flows and pressures, controls of variable pumps, the reservoir: against closed forms.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use bramah::Simulation;
use rig::{at, circuit, column, last, near, run, shipped};

const OIL: &str = "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.4e9));";

/// A valve between two pressures, settled.
fn between(class: &str, more: &str) -> Simulation {
    let mut simulation = circuit(
        &format!("{OIL} Hydraulic.{class}; Hydraulic.PressureSource a; Hydraulic.PressureSource b;"),
        &format!("connect(a.port, way.port_a); connect(b.port, way.port_b); {more}"),
    );
    simulation.stop_time(0.5);
    simulation
}

fn flow(simulation: &mut Simulation, a: f64, b: f64) -> f64 {
    simulation.set("a.p", a).expect("a parameter").set("b.p", b).expect("a parameter");
    -last(&run(simulation), "a.port.q")
}

#[test]
fn the_flow_control_valve_holds_its_flow() {
    let mut valve = between("FlowControlValve way(q_nom = 5e-4)", "way.u = 0.6;");
    for (a, b) in [(20e5, 5e5), (100e5, 5e5), (200e5, 5e5), (200e5, 185e5), (300e5, 50e5)] {
        near(flow(&mut valve, a, b), 3e-4, 0.03);
    }
    // too little is left for the compensator: two open orifices in series, 0.6 q_nom at 7.6 bar and q_nom at 3 bar
    let needed: f64 = 7.6e5 / 0.36 + 3e5;
    let in_series = 5e-4 * (4e5 / needed).sqrt();
    near(flow(&mut valve, 10e5, 6e5), in_series, 0.01);
    near(flow(&mut valve, 6e5, 10e5), -in_series, 0.01);
}

/// Half the play to either side: at 3 V coming from below the setting is that of 2.8 V, coming from above of 3.2 V.
#[test]
fn the_magnet_of_the_proportional_relief_valve_sticks() {
    let mut valve = circuit(
        &format!(
            "{OIL} Hydraulic.ProportionalRelief valve(hysteretic = true, h = 0.4, k_u = 2e6);
             Signal.Trapezoid command(amplitude = 4, offset = 1, rising = 1, holding = 1, falling = 1);
             Hydraulic.FlowSource source;
             Hydraulic.Tank tank;"
        ),
        "connect(command.y, valve.u); connect(source.port, valve.port_a); connect(valve.port_b, tank.port);",
    );
    let t = run(valve.stop_time(3.5));
    // the lag of 50 ms and of the play at 4 V/s: 0.2 V
    for (time, u) in [(0.5, 3.0 - 0.2 - 0.2), (1.9, 4.8), (2.5, 3.0 + 0.2 + 0.2), (3.5, 1.2)] {
        near(at(&t, "valve.p_set", time), 2e6 * u, 0.02);
    }
}

#[test]
fn valves_on_spools_take_power_in_both_directions() {
    for (class, more) in [
        ("PressureCompensator way", "connect(way.port_y, b.port);"),
        ("SequenceValve way(p_set = 50e5)", ""),
        ("UnloadingValve way(p_set = 50e5)", "connect(way.port_x, a.port);"),
        ("FlowControlValve way", "way.u = 0.3;"),
    ] {
        let mut valve = between(class, more);
        for (a, b) in [(1e5, 3e5), (3e5, 1e5), (49e5, 10e5), (55e5, 10e5), (55e5, 90e5), (200e5, 199e5), (2e7, 1e3)] {
            let loss = (a - b) * flow(&mut valve, a, b);
            assert!(loss.is_finite() && loss >= 0.0, "{class} gives {loss} W from {a} to {b} Pa");
        }
    }
}

#[test]
fn the_sequence_valve_looks_at_its_inlet_only() {
    let mut valve = between("SequenceValve way(p_set = 100e5)", "");
    for outlet in [0.0, 40e5, 80e5] {
        assert!(flow(&mut valve, 100e5, outlet) < 2e-7, "it is closed below its pressure, against {outlet} Pa");
    }
    // beyond override and rounding it is open: q_nom at 5 bar
    near(flow(&mut valve, 110e5, 105e5), 1e-3, 0.01);
}

/// Relief valves begin to open at `p_set` and pass `q_nom`, fully open, at `p_set (1 + override)`.
#[test]
fn relief_valves_are_open_where_their_pages_say() {
    for (class, reversed) in [("ReliefValve", false), ("ReliefValveDynamic", false), ("CounterbalanceValve", true)] {
        for (p_set, over, q_nom) in [(200e5, 0.1, 1e-3), (350e5, 0.05, 2e-3), (50e5, 0.2, 1e-4)] {
            let more = if reversed { "connect(way.port_x, a.port);" } else { "" };
            let mut valve = between(&format!("{class} way(p_set = {p_set}, override = {over}, q_nom = {q_nom})"), more);
            let mut at_drop = |dp: f64| {
                let (a, b) = if reversed { (1e5, 1e5 + dp) } else { (1e5 + dp, 1e5) };
                valve.set("a.p", a).expect("a parameter").set("b.p", b).expect("a parameter");
                let t = run(&valve);
                (last(&t, "way.x"), last(&t, "way.q").abs())
            };
            assert!(at_drop(p_set).0 < 1e-6, "{class} is shut at {p_set} Pa");
            near(at_drop(p_set * (1.0 + over / 2.0)).0, 0.5, 1e-6);
            let (x, q) = at_drop(p_set * (1.0 + over));
            near(x, 1.0, 1e-6);
            near(q, q_nom, 5e-3);
        }
    }
}

/// The areas and the spring of a cartridge valve say where it opens, from either side, and a closed pilot line holds it.
#[test]
fn the_cartridge_valve_opens_as_its_areas_say() {
    let pilot = "Hydraulic.PressureSource x(p = 50e5)";
    let cartridge = |pilot: &str| {
        let class = format!("CartridgeValve way(ratio = 1.5, p_crack = 2e5, p_open = 4e5); {pilot}");
        between(&class, "connect(way.port_x, x.port);")
    };
    let mut valve = cartridge(pilot);
    let shut = |q: f64| q.abs() < 1e-7;
    // p_A + 0.5 p_B = 1.5*50 bar + 2 bar
    assert!(shut(flow(&mut valve, 76.0e5, 1e5)) && !shut(flow(&mut valve, 77.0e5, 1e5)));
    assert!(shut(flow(&mut valve, 26.0e5, 101e5)) && flow(&mut valve, 27.0e5, 101e5) < -1e-5);
    // held open by the spring, but for the flow force: 2 C_d cos(alpha) A(x) |dp|, |dp| rounded over 0.1 bar
    let mut open = cartridge("Hydraulic.Tank x(p = 1e5)");
    let t = run(open.set("a.p", 3.0e5).expect("a parameter").set("b.p", 2.0e5).expect("a parameter"));
    let lift = last(&t, "way.x");
    let (d, alpha) = (16e-3, std::f64::consts::FRAC_PI_4);
    let area = std::f64::consts::FRAC_PI_4 * d * d;
    let window = std::f64::consts::PI * d * alpha.sin() * (lift - 0.005 * 4e-3);
    let flow_force = 2.0 * 0.65 * alpha.cos() * window * (1e5f64.hypot(1e4) - 1e4);
    assert!((0.5e-3..1.5e-3).contains(&lift), "{lift}");
    near(area * (2e5 + 2e5 * lift / 4e-3) + flow_force, area * (3.0e5 + 0.5 * 2.0e5 - 1.5 * 1e5), 1e-4);
    let mut held = cartridge("Hydraulic.Plug x");
    assert!(shut(flow(&mut held, 300e5, 1e5)));
}

#[test]
fn the_reducing_valve_relieves_what_is_pushed_back() {
    let t = run(&shipped("Hydraulic.Examples.PressureReducerRelievingExample"));
    let settled = |time: f64| at(&t, "volume.p", time) - 101_325.0;
    // feeding: below p_set by the part of the droop that the flow needs; relieving: above the overlap
    let (fed, relieved) = (settled(0.875), settled(0.625));
    assert!((0.97 * 50e5..50e5).contains(&fed), "{fed}");
    assert!((1.02 * 50e5..1.12 * 50e5).contains(&relieved), "{relieved}");
    let mean = |name: &str| column(&t, name).iter().sum::<f64>();
    assert!(mean("valve.feeding.q") > 0.0 && mean("valve.relieving.q") > 0.0);
}

#[test]
fn pressure_control_goes_along_its_line_and_below_its_torque() {
    let t = run(&shipped("Hydraulic.Examples.PressureControlExample"));
    let line = |p: f64| ((200e5 - p) / 8e5).clamp(0.0, 1.0);
    for time in [0.15, 0.6, 1.45, 1.6, 1.95] {
        let (u, p) = (at(&t, "control.u", time), at(&t, "control.p", time));
        assert!((u - line(p)).abs() < 0.03, "{time}: {u} at {p} Pa");
    }
    // between both it is the torque: u V p/(2 pi) = 90 Nm
    let (u, p) = (at(&t, "control.u", 1.2), at(&t, "control.p", 1.2));
    near(u * 45e-6 * p / (2.0 * std::f64::consts::PI), 90.0, 0.025);
    assert!(column(&t, "control.p").iter().all(|p| *p < 203e5));
}

#[test]
fn load_sensing_keeps_its_margin_and_cuts_off() {
    let t = run(&shipped("Hydraulic.Examples.LoadSensingControlExample"));
    for time in [0.25, 0.7, 1.2, 1.6] {
        let margin = at(&t, "volume.p", time) - at(&t, "load.port.p", time);
        assert!((16e5..20e5).contains(&margin), "{time}: {margin} Pa");
    }
    // the flow follows the orifice, not the load: 0.7 then 2.4 times 1 at loads from 40 to 150 bar
    near(at(&t, "metering.q", 1.2), at(&t, "metering.q", 0.25), 0.01);
    near(last(&t, "control.p"), 199.5e5, 0.005);
}

#[test]
fn the_unloading_valve_keeps_the_accumulator_between_its_limits() {
    let t = run(&shipped("Hydraulic.Examples.UnloadingValveExample"));
    let p = column(&t, "accumulator.p");
    let late = &p[p.len() / 5..];
    let (low, high) = late.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(*v), h.max(*v)));
    assert!((0.82 * 150e5..0.87 * 150e5).contains(&low) && (150e5..154e5).contains(&high), "{low} to {high}");
    let switched = column(&t, "valve.unloading").windows(2).filter(|w| w[0] != w[1]).count();
    assert!(switched >= 4, "{switched}");
}

#[test]
fn the_reservoir_keeps_its_oil_and_its_gas() {
    // of constant density, for the oil of the example grows by a few parts in a thousand as its air expands
    let t = run(&circuit(
        "extends Hydraulic.Examples.ReservoirExample(oil(redeclare function density = Oil.Compression.constantDensity));",
        "",
    ));
    let (h, p) = (column(&t, "reservoir.h"), column(&t, "reservoir.p"));
    for (i, time) in t.times.iter().enumerate() {
        let omega = 2.0 * std::f64::consts::PI * 0.2;
        let taken = 1e-3 / omega * (1.0 - (omega * time).cos());
        assert!((h[i] - (0.2 - taken / 0.02)).abs() < 1e-6, "{time}: {}", h[i]);
        near(p[i], 101_325.0 * (0.1 / (0.3 - h[i])).powf(1.2), 1e-9);
    }
    let empty = circuit(
        &format!("{OIL} Hydraulic.Reservoir tank(A = 0.01, h_start = 0.1); Hydraulic.FlowSource pump(q = -1e-3);"),
        "connect(tank.port, pump.port);",
    );
    let mut empty = empty;
    let error = empty.stop_time(10.0).run().expect_err("it runs dry").to_string();
    assert!(error.contains("E503") && error.contains("runs dry"), "{error}");
}

/// What the middle position of each centre joins: flow of each edge over that of an open one, P-A, P-B, A-T, B-T.
#[test]
fn the_centre_of_a_spool_joins_what_it_says() {
    for (centre, joined) in [
        ("closed", [0.0, 0.0, 0.0, 0.0]),
        ("open", [0.5, 0.5, 0.5, 0.5]),
        ("tandem", [0.0, 0.0, 0.0, 0.0]),
        ("float", [0.0, 0.0, 0.5, 0.5]),
        ("regenerative", [0.5, 0.5, 0.0, 0.0]),
    ] {
        for (u, expected) in [(0.0, joined), (1.0, [1.0, 0.0, 0.0, 1.0]), (-1.0, [0.0, 1.0, 1.0, 0.0])] {
            let mut valve = circuit(
                &format!(
                    "{OIL} Hydraulic.Valve43Centre valve(centre = Hydraulic.SpoolCentre.{centre}, q_nom = 1e-3, dp_nom = 5e5);
                    Hydraulic.PressureSource p(p = 15e5), a(p = 10e5), b(p = 10e5), t(p = 5e5);"
                ),
                &format!(
                    "connect(p.port, valve.port_P); connect(a.port, valve.port_A); connect(b.port, valve.port_B);
                    connect(t.port, valve.port_T); valve.u = {u};"
                ),
            );
            let t = run(valve.stop_time(2.0));
            for (edge, part) in ["PA", "PB", "AT", "BT"].iter().zip(expected) {
                let found = last(&t, &format!("valve.edge_{edge}.q")) / 1e-3;
                assert!((found - part).abs() < 0.01, "{centre} at {u}: {edge} {found}, not {part}");
            }
            if centre == "tandem" {
                let found = last(&t, "valve.edge_PT.q") / 1e-3;
                let wanted = if u == 0.0 { 2.0_f64.sqrt() } else { 0.0 };
                assert!((found - wanted).abs() < 0.01, "tandem P to T at {u}: {found}");
            }
        }
    }
}

#[test]
fn the_flow_divider_shares_whatever_the_loads_dividing_and_combining() {
    for (p_a, p_b, q) in
        [(50e5, 50e5, 1e-3), (20e5, 120e5, 1e-3), (120e5, 20e5, 1e-3), (80e5, 60e5, -1e-3), (60e5, 80e5, -1e-3)]
    {
        let mut divider = circuit(
            &format!(
                "{OIL} Hydraulic.FlowDivider divider(share = 2/3); Hydraulic.FlowSource common(q = {q});
                Hydraulic.PressureSource a(p = {p_a}), b(p = {p_b});"
            ),
            "connect(common.port, divider.port_P); connect(a.port, divider.port_A); connect(b.port, divider.port_B);",
        );
        let t = run(divider.stop_time(1.0));
        near(last(&t, "divider.edge_A.q") / q, 2.0 / 3.0, 0.02);
    }
}

#[test]
fn power_control_follows_its_hyperbola() {
    let t = run(&shipped("Hydraulic.Examples.PowerControlExample"));
    let power = |time: f64| {
        at(&t, "control.u", time) * 45e-6 / (2.0 * std::f64::consts::PI)
            * 157.0
            * (at(&t, "control.p", time) - 101_325.0)
    };
    let (u, p) = (column(&t, "control.u"), column(&t, "control.p"));
    let on: Vec<f64> = t
        .times
        .iter()
        .copied()
        .zip(u.iter().zip(p))
        .filter(|(_, (u, p))| **u < 0.95 && **p < 235e5)
        .map(|(time, _)| time)
        .collect();
    assert!(on.len() > 20, "{} rows on the hyperbola", on.len());
    on.iter().for_each(|time| near(power(*time), 11e3, 0.06));
}

#[test]
fn the_hose_break_valve_closes_above_its_flow_and_opens_when_oil_comes_back() {
    let mut fuse = circuit(
        &format!(
            "{OIL} Hydraulic.HydraulicFuse fuse(q_close = 5e-4, dp_close = 4e5); Hydraulic.PressureSource a(useInput = true), b(p = 10e5);"
        ),
        "connect(a.port, fuse.port_a); connect(b.port, fuse.port_b);
        a.p_in = 10e5 + (if time < 1 then 3.5e5*time else if time < 2 then 5e5 else if time < 3 then 2e5 else -1e5);",
    );
    let t = run(fuse.stop_time(4.0));
    near(at(&t, "fuse.q", 0.99), 5e-4 * (3.465_f64 / 4.0).sqrt(), 0.01);
    assert!(at(&t, "fuse.q", 1.9) < 1e-5 && at(&t, "fuse.q", 2.9) < 1e-5, "closed, and still closed above dp_reset");
    near(at(&t, "fuse.q", 3.9), -5e-4 * 0.5, 0.02);
}

/// Pressure under a load, stage by stage, from what each stage's area carries; the largest stage moves first.
#[test]
fn the_stages_of_a_telescopic_cylinder_follow_in_their_order() {
    let t = run(&shipped("Hydraulic.Examples.TelescopicCylinderExample"));
    let reached = |stage: usize| {
        let s = column(&t, &format!("cylinder.s_rel[{stage}]"));
        t.times[s.iter().position(|s| *s > 0.495).expect("it extends")]
    };
    let end = [1, 2, 3].map(reached);
    assert!(end[0] < end[1] && end[1] < end[2], "{end:?}");
    for (stage, area) in [(1, 113.1e-4), (2, 63.6e-4), (3, 28.3e-4)] {
        let before = if stage == 1 { 0.0 } else { end[stage - 2] };
        let time = 0.5 * (before + end[stage - 1]);
        let friction: f64 = 100.0 + 2000.0 * at(&t, &format!("cylinder.v_rel[{stage}]"), time);
        near(at(&t, "cylinder.p", time), 101_325.0 + (20e3 + friction) / area, 0.01);
    }
}

/// A cylinder of any size rests on its stops no deeper than a thousandth of its stroke, and a stiffness of one's own stays.
#[test]
fn a_cylinder_rests_on_its_stop() {
    let rest = |area: f64, stroke: f64, p: f64, own: &str| {
        let mut cylinder = circuit(
            &format!(
                "inner Oil.ISOVG46 oil; Hydraulic.PressureSource p(p = {p}); Hydraulic.Tank t;
                Hydraulic.Orifice o_1(A = {0}), o_2(A = {0});
                Hydraulic.Cylinder c(A_1 = {area}, A_2 = 0.6*{area}, stroke = {stroke}, s_start = 0.5*{stroke}{own});",
                1e-3 * area
            ),
            "connect(p.port, o_1.port_a); connect(o_1.port_b, c.port_1); connect(c.port_2, o_2.port_a);
            connect(o_2.port_b, t.port);",
        );
        let t = run(cylinder.stop_time(20.0));
        (last(&t, "c.s") - stroke) / stroke
    };
    for (area, stroke, p) in [(314e-4, 0.5, 250e5), (800e-4, 1.2, 350e5), (12.6e-4, 0.05, 350e5), (78e-4, 0.01, 420e5)]
    {
        let depth = rest(area, stroke, p, "");
        assert!((0.0..1e-3).contains(&depth), "{depth} of {stroke} m");
    }
    near(rest(12.6e-4, 0.05, 350e5, ", stops(k = 2e8, d_0 = 1e-6)") * 0.05, 12.6e-4 * 350e5 / 2e8, 0.02);
}

#[test]
fn a_rotary_actuator_turns_with_its_torque_and_holds_at_its_stops() {
    let mut actuator = circuit(
        &format!(
            "{OIL} Hydraulic.RotaryActuator actuator(C_i = 0); Hydraulic.PressureSource p_1(p = 101e5), p_2(p = 1e5);
            Mechanical.Rotational.Torque load;"
        ),
        "connect(p_1.port, actuator.port_1); connect(p_2.port, actuator.port_2); connect(load.flange, actuator.flange);
        load.tau = if time < 0.5 then -800 else -500;",
    );
    let t = run(actuator.stop_time(3.0));
    // D = w (r_o^2 - r_i^2)/2 = 89.25 ml/rad: 892 Nm, less 5 Nm and a twentieth of dry friction
    let ideal = 0.06 * (0.06_f64.powi(2) - 0.025_f64.powi(2)) / 2.0 * 100e5;
    near(ideal, 892.5, 1e-3);
    assert!(at(&t, "actuator.flange.phi", 3.0) > 270.0_f64.to_radians() - 1e-3, "at the stop");
    let w = at(&t, "actuator.w", 0.45);
    assert!(w > 0.0 && w < 60.0, "{w}");
}

/// Every loss takes power in all four quadrants, and shaft and oil differ by the losses.
#[test]
fn the_machines_lose_power_in_all_four_quadrants() {
    for class in ["VaneMachine", "GerotorMachine", "OrbitMotor", "RadialPistonMachine", "Pump", "GearPump"] {
        for w in [-150.0, -3.0, 3.0, 150.0] {
            for dp in [-150e5, -5e5, 5e5, 150e5] {
                let mut machine = circuit(
                    &format!(
                        "{OIL} Hydraulic.{class} machine; Hydraulic.PressureSource a(p = {}), b(p = {});
                        Mechanical.Rotational.ConstantSpeed shaft(w_fixed = {w});",
                        160e5 + dp / 2.0,
                        160e5 - dp / 2.0
                    ),
                    "connect(a.port, machine.port_a); connect(b.port, machine.port_b); connect(shaft.flange, machine.flange);",
                );
                let t = run(machine.stop_time(0.1));
                let (shaft, oil, loss) =
                    (last(&t, "machine.T_sh") * w, dp * last(&t, "machine.Q_A"), last(&t, "machine.lossPower"));
                assert!(loss > 0.0, "{class} at {w} rad/s and {dp} Pa: {loss} W");
                assert!((shaft - oil - loss).abs() < 1e-6 * shaft.abs().max(oil.abs()).max(loss), "{class} {w} {dp}");
            }
        }
    }
}
