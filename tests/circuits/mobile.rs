//! Valves of mobile machines, freewheel, worm gear, relative sensors and water-based fluids: against closed forms.

use crate::rig;

use bramah::Simulation;
use rig::{Numbers, at, circuit, column, last, near, run, shipped};

const OIL: &str = "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.4e9));";

/// A valve with a source of pressure at each of its ports, `s0`, `s1` and so on.
fn at_sources(instance: &str, ports: &[&str], more: &str, equations: &str) -> Simulation {
    let sources: String = (0..ports.len()).map(|i| format!("Hydraulic.PressureSource s{i}; ")).collect();
    let joined: String =
        ports.iter().enumerate().map(|(i, port)| format!("connect(s{i}.port, valve.port_{port}); ")).collect();
    circuit(&format!("{OIL} Hydraulic.{instance}; {sources}{more}"), &format!("{joined}{equations}"))
}

fn settled(simulation: &mut Simulation, set: &[(&str, f64)]) -> bramah::results::Trajectory {
    for (name, value) in set {
        simulation.set(name, *value).expect("a parameter");
    }
    run(simulation)
}

const LEVER: &str = "Signal.Constant lever(k = 0);";
const MOVED: &str = "connect(lever.y, valve.u);";

/// In the middle the by-pass is an orifice of `q_C` at `dp_C`; its curve is the same both ways and ends in leakage.
#[test]
fn the_by_pass_of_an_open_centre_valve_closes_either_way() {
    let instance = "Valve63 valve(redeclare Hydraulic.Spool.Ideal spool, q_C = 1e-3, dp_C = 3e5)";
    let mut valve = at_sources(instance, &["P1", "C", "P", "T", "A", "B"], LEVER, MOVED);
    valve.stop_time(0.1);
    let mut share = |u: f64, dp: f64| {
        let t = settled(&mut valve, &[("lever.k", u), ("s0.p", 20e5 + dp), ("s1.p", 20e5)]);
        last(&t, "valve.edge_C.q") / (1e-3 * (dp.abs() / 3e5).sqrt() * dp.signum())
    };
    for dp in [0.5e5, 3e5, -12e5] {
        near(share(0.0, dp), 1.0, 1e-3);
    }
    // the line of the curve at half the travel, with its roundings
    let z = 0.5_f64.hypot(0.02) - 0.02;
    let (fall_1, fall_2) = (0.85 / 0.30, 0.15 / 0.40);
    let x = 1.0 - fall_1 * (z - 0.05 - 0.01) + (fall_1 - fall_2) * (z - 0.35 - 0.01);
    let wanted = (1e-4 + x - 0.01) / (1.0 + 1e-4 - 0.01);
    near(share(0.5, 3e5), wanted, 1e-3);
    near(share(-0.5, 3e5), wanted, 1e-3);
    let mut before = 1.1;
    for u in [0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.7] {
        let now = share(u, 3e5);
        assert!(now < before, "{now} at {u}");
        before = now;
    }
    assert!(share(0.85, 3e5) < 1e-3 && share(-1.0, 3e5) < 1e-3);
}

/// Load sensing carries the pressure of the consumer that is fed, before its edge opens, and that of T in the middle.
#[test]
fn load_sensing_carries_the_pressure_of_the_consumer() {
    let instance = "Valve43LoadSensing valve(redeclare Hydraulic.Spool.Ideal spool, q_P = 1e-3, dp_P = 15e5)";
    let more = format!("{LEVER} Hydraulic.Plug plug;");
    let joined = format!("{MOVED} connect(plug.port, valve.port_LS);");
    let mut valve = at_sources(instance, &["P", "T", "A", "B"], &more, &joined);
    valve.stop_time(0.1);
    let mut found = |u: f64| {
        let set = [("lever.k", u), ("s0.p", 120e5), ("s1.p", 2e5), ("s2.p", 60e5), ("s3.p", 20e5)];
        let t = settled(&mut valve, &set);
        (last(&t, "valve.port_LS.p"), last(&t, "valve.edge_PA.q"), last(&t, "valve.edge_PB.q"))
    };
    for (u, p) in [(1.0, 60e5), (0.5, 60e5), (0.13, 60e5), (-0.13, 20e5), (-0.5, 20e5), (-1.0, 20e5), (0.0, 2e5)] {
        near(found(u).0, p, 1e-3);
    }
    // at 0.13 the metering edge is closed still; at full travel it passes q_P at dp_P
    assert!(found(0.13).1 < 1e-6);
    near(found(1.0).1, 1e-3 * (60.0_f64 / 15.0).sqrt(), 1e-3);
    near(found(-1.0).2, 1e-3 * (100.0_f64 / 15.0).sqrt(), 1e-3);
}

/// The pilot force is the spring force: a line from `p_begin` to `p_end`, and the pilots take the oil that moves.
#[test]
fn the_piloted_spool_stands_where_pilot_and_springs_balance() {
    let mut valve = at_sources("PilotedValve43 valve(q_nom = 1e-3)", &["P", "T", "A", "B", "X", "Y"], "", "");
    valve.stop_time(0.5);
    let fixed = [("s0.p", 15e5), ("s1.p", 5e5), ("s2.p", 10e5), ("s3.p", 10e5)];
    for (x, y) in [(9e5, 1e5), (20e5, 10e5), (18e5, 1e5), (5e5, 17.5e5), (1e5, 11e5)] {
        let t = settled(&mut valve, &[&fixed[..], &[("s4.p", x), ("s5.p", y)]].concat());
        let dp: f64 = x - y;
        let travel = (dp.abs() - 5e5) / 15e5;
        near(last(&t, "valve.s"), dp.signum() * travel * 7e-3, 1e-3);
        let open = (1e-4 + travel - 0.1 - 0.01) / 0.9 / (1.0 + 1e-4 - 0.01 / 0.9);
        let edge = if dp > 0.0 { "valve.valve.edge_PA.q" } else { "valve.valve.edge_PB.q" };
        if travel > 0.3 {
            near(last(&t, edge), open * 1e-3, 5e-3);
        }
        let q = column(&t, "valve.port_X.q");
        let taken: f64 = (1..t.len()).map(|i| (q[i - 1] + q[i]) / 2.0 * (t.times[i] - t.times[i - 1])).sum();
        near(taken, 3e-4 * last(&t, "valve.s"), 0.05);
    }
    // less than the springs hold, and more than full travel
    let t = settled(&mut valve, &[&fixed[..], &[("s4.p", 4e5), ("s5.p", 1e5)]].concat());
    assert!(last(&t, "valve.s") < 5e-5, "{}", last(&t, "valve.s"));
    let t = settled(&mut valve, &[&fixed[..], &[("s4.p", 26e5), ("s5.p", 1e5)]].concat());
    assert!((7e-3..7.2e-3).contains(&last(&t, "valve.s")));
    near(last(&t, "valve.valve.edge_PA.q"), 1e-3, 1e-3);
}

/// A pump at its limit: the flows keep the ratio of the openings, whichever consumer has the higher load.
#[test]
fn compensators_behind_the_edges_share_a_flow_that_is_too_small() {
    let mut pair = circuit(
        &format!(
            "{OIL} Hydraulic.FlowSource pump(q = 6e-4); Hydraulic.Volume line(V = 1e-4, p_start = 20e5);
            Hydraulic.Orifice m_1(A = 8e-6), m_2(A = 4e-6); Hydraulic.PostCompensator c_1, c_2;
            Hydraulic.PressureSource a, b; Hydraulic.ShuttleValve highest;"
        ),
        "connect(pump.port, line.port); connect(line.port, m_1.port_a); connect(line.port, m_2.port_a);
        connect(m_1.port_b, c_1.port_a); connect(m_2.port_b, c_2.port_a);
        connect(c_1.port_b, a.port); connect(c_2.port_b, b.port);
        connect(a.port, highest.port_a); connect(b.port, highest.port_b);
        connect(highest.port_out, c_1.port_LS); connect(highest.port_out, c_2.port_LS);",
    );
    pair.stop_time(0.8);
    for q in [6e-4, 3e-4, 1.5e-4] {
        for (a, b) in [(120e5, 40e5), (40e5, 120e5), (80e5, 79e5)] {
            let t = settled(&mut pair, &[("pump.q", q), ("a.p", a), ("b.p", b)]);
            let (one, two) = (last(&t, "m_1.q"), last(&t, "m_2.q"));
            near(one / two, 2.0, 0.02);
            near(one + two, q, 1e-3);
            // the pressure behind both edges is a spring above load sensing
            for edge in ["m_1.port_b.p", "m_2.port_b.p"] {
                let above = last(&t, edge) - f64::max(a, b);
                assert!((3e5..3.6e5).contains(&above), "{edge}: {above} Pa");
            }
            let back = column(&t, "m_1.q").iter().chain(column(&t, "m_2.q")).copied().fold(0.0, f64::min);
            assert!(back > -1e-9, "a load flows back: {back}");
        }
    }
}

#[test]
fn the_check_valve_closes_on_its_pilot() {
    let mut valve = at_sources(
        "PilotClosedCheckValve valve",
        &["x"],
        "Hydraulic.PressureSource a, b;",
        "connect(a.port, valve.port_a); connect(b.port, valve.port_b);",
    );
    valve.stop_time(0.2);
    let mut flow =
        |a: f64, b: f64, x: f64| last(&settled(&mut valve, &[("a.p", a), ("b.p", b), ("s0.p", x)]), "valve.q");
    let free = |dp: f64| 0.65 * 1e-5 * (2.0 * dp / 860.0).sqrt();
    // a pilot below the outlet does nothing
    near(flow(20e5, 10e5, 0.0), free(10e5), 1e-3);
    near(flow(20e5, 10e5, 9e5), free(10e5), 1e-3);
    // half open where 10 bar - 1.5*6 bar lies in the middle between p_crack and p_open
    near(flow(20e5, 10e5, 16e5), free(10e5) / 2.0, 1e-3);
    for (a, b, x) in [(20e5, 10e5, 17e5), (300e5, 1e5, 300e5), (10e5, 20e5, 0.0)] {
        assert!(flow(a, b, x).abs() < 1e-10);
    }
}

#[test]
fn valves_of_mobile_machines_take_power_whatever_their_pressures() {
    let ideal = "valve(redeclare Hydraulic.Spool.Ideal spool)";
    let mut numbers = Numbers(11);
    for (class, instance, ports, lever) in [
        ("Valve63", ideal, &["P", "T", "A", "B", "P1", "C"][..], true),
        ("Valve43LoadSensing", ideal, &["P", "T", "A", "B", "LS"][..], true),
        ("PilotedValve43", "valve", &["P", "T", "A", "B", "X", "Y"][..], false),
        ("PostCompensator", "valve", &["a", "b", "LS"][..], false),
        ("PilotClosedCheckValve", "valve", &["a", "b", "x"][..], false),
    ] {
        let (more, moved) = if lever { (LEVER, MOVED) } else { ("", "") };
        let mut valve = at_sources(&format!("{class} {instance}"), ports, more, moved);
        valve.stop_time(0.5);
        for _ in 0..20 {
            let near_tank = numbers.next() < 0.3;
            for i in 0..ports.len() {
                let p = numbers.between(1e5, if near_tank { 2e5 } else { 300e5 });
                valve.set(&format!("s{i}.p"), p).expect("a parameter");
            }
            if lever {
                valve.set("lever.k", numbers.between(-1.2, 1.2)).expect("a parameter");
            }
            let t = run(&valve);
            let power: f64 = ports
                .iter()
                .map(|port| last(&t, &format!("valve.port_{port}.p")) * last(&t, &format!("valve.port_{port}.q")))
                .sum();
            assert!(power.is_finite() && power > -1e-6, "{class} gives {power} W");
        }
    }
}

#[test]
fn the_open_centre_valve_moves_its_cylinder_as_its_lever_says() {
    let t = run(&shipped("Hydraulic.Examples.Valve63Example"));
    // in the middle the pump idles over the by-pass: 5e-4 m3/s at 3 bar and the tank
    near(at(&t, "line.p", 1.3), 3e5 + 101_325.0, 0.01);
    // at full travel all of it moves the cylinder
    near(at(&t, "cylinder.v", 0.9), 5e-4 / 12.57e-4, 0.01);
    // between, cylinder and by-pass share it
    let (cylinder, by_pass) = (at(&t, "valve.edge_PA.q", 0.6), at(&t, "valve.edge_C.q", 0.6));
    assert!(cylinder > 5e-5 && by_pass > 5e-5, "{cylinder} and {by_pass}");
    near(cylinder + by_pass, 5e-4, 0.01);
    assert!(at(&t, "cylinder.v", 1.8) < -0.1);
}

#[test]
fn the_load_sensing_valve_idles_and_keeps_its_margin() {
    let t = run(&shipped("Hydraulic.Examples.Valve43LoadSensingExample"));
    near(at(&t, "sensing.p", 0.25), 101_325.0, 0.01);
    near(at(&t, "sensing.p", 1.25), 101_325.0, 0.01);
    for time in [0.8, 1.6] {
        let margin = at(&t, "line.p", time) - at(&t, "sensing.p", time);
        assert!((16e5..20.5e5).contains(&margin), "{time}: {margin} Pa");
    }
    near(at(&t, "sensing.p", 0.8), at(&t, "cylinder.p_1", 0.8), 1e-3);
    near(at(&t, "sensing.p", 1.6), at(&t, "cylinder.p_2", 1.6), 1e-3);
}

/// Together while driven, apart while the drive falls back, together again without a jump.
#[test]
fn the_freewheel_drives_one_way() {
    let mut shafts = circuit(
        "Mechanical.Rotational.Inertia a(J = 2), b(J = 3); Mechanical.Rotational.Freewheel way;
        Mechanical.Rotational.Torque drive;",
        "connect(drive.flange, a.flange_a); connect(a.flange_b, way.flange_a); connect(way.flange_b, b.flange_a);
        drive.tau = if time < 1 then 10 elseif time < 2 then -10 else 20;",
    );
    let t = run(shafts.stop_time(3.0));
    for (time, a, b, tau) in [
        (0.5, 1.0, 1.0, -6.0),
        (0.98, 1.96, 1.96, -6.0),
        (1.5, -0.5, 2.0, 0.0),
        (1.98, -2.9, 2.0, 0.0),
        (2.3, 0.0, 2.0, 0.0),
        (2.6, 2.4, 2.4, -12.0),
        (2.98, 3.92, 3.92, -12.0),
    ] {
        for (name, wanted) in [("a.w", a), ("b.w", b), ("way.tau", tau)] {
            let found = at(&t, name, time);
            assert!((found - wanted).abs() < 0.03, "{name} at {time}: {found}, not {wanted}");
        }
    }
}

/// Two freewheels in a row between two drives: never slower than the driving side, and no energy from nowhere.
#[test]
fn freewheels_never_give_energy() {
    let mut shafts = circuit(
        "Mechanical.Rotational.Inertia a(J = 1, w(start = 5)), b(J = 0.5, w(start = 8)), c(J = 2, w(start = 10));
        Mechanical.Rotational.Freewheel one, two(tau_drag = 0.5);
        Mechanical.Rotational.Torque drive_a, drive_c;
        Mechanical.Rotational.Damper d_a(d = 0.3), d_b(d = 2), d_c(d = 1);
        Mechanical.Rotational.Fixed housing;
        Real E(unit = \"J\", start = 0, fixed = true, nominal = 100);",
        "drive_a.tau = 30*sin(14.45*time); drive_c.tau = 40*sin(23.25*time);
        der(E) = a.w*drive_a.tau + c.w*drive_c.tau - d_a.d*a.w^2 - d_b.d*b.w^2 - d_c.d*c.w^2;
        connect(drive_a.flange, a.flange_a); connect(a.flange_b, one.flange_a); connect(one.flange_b, b.flange_a);
        connect(b.flange_b, two.flange_a); connect(two.flange_b, c.flange_a); connect(c.flange_b, drive_c.flange);
        connect(d_a.flange_a, a.flange_a); connect(d_a.flange_b, housing.flange);
        connect(d_b.flange_a, b.flange_a); connect(d_b.flange_b, housing.flange);
        connect(d_c.flange_a, c.flange_a); connect(d_c.flange_b, housing.flange);",
    );
    let t = run(shafts.stop_time(10.0));
    let changes = column(&t, "one.mode").windows(2).filter(|w| w[0] != w[1]).count();
    assert!(changes > 20, "only {changes} changes");
    let mut before = f64::INFINITY;
    for i in 0..t.len() {
        let of = |name: &str| column(&t, name)[i];
        for way in ["one", "two"] {
            assert!(of(&format!("{way}.w_rel")) > -1e-6 && of(&format!("{way}.lossPower")) > -1e-6);
        }
        assert!(of("one.tau") < 1e-4 && of("two.tau") < 0.5001);
        let stored = (of("a.w").powi(2) + 0.5 * of("b.w").powi(2) + 2.0 * of("c.w").powi(2)) / 2.0 - of("E");
        assert!(stored < before + 0.02, "{stored} J after {before} J at {}", t.times[i]);
        before = before.min(stored);
    }
}

#[test]
fn a_freewheel_does_not_start_with_b_behind() {
    let mut shafts = circuit(
        "Mechanical.Rotational.Inertia a(w(start = 5)), b(w(start = 2)); Mechanical.Rotational.Freewheel way;",
        "connect(a.flange_b, way.flange_a); connect(way.flange_b, b.flange_a);",
    );
    let error = shafts.stop_time(1.0).run().expect_err("b is slower").to_string();
    assert!(error.contains("E503") && error.contains("slower"), "{error}");
}

/// Efficiency tan(g)/tan(g + rho) when the worm drives, tan(g - rho)/tan(g) when the wheel does, in four quadrants.
#[test]
fn the_worm_gear_has_the_efficiency_of_its_angles() {
    let mut gear = circuit(
        "Mechanical.Rotational.ConstantSpeed worm(w_fixed = 50); Mechanical.Rotational.ConstantTorque load;
        Mechanical.Rotational.WormGear gear(ratio = 20, gamma = 0.1, mu = 0.06, alpha = 0.349);",
        "connect(worm.flange, gear.flange_a); connect(gear.flange_b, load.flange);",
    );
    gear.stop_time(0.1);
    let rho = (0.06 / 0.349_f64.cos()).atan();
    for gamma in [0.1_f64, 0.04] {
        for w in [50.0, -50.0] {
            for load in [100.0, -100.0] {
                let t = settled(&mut gear, &[("worm.w_fixed", w), ("load.tau_constant", load), ("gear.gamma", gamma)]);
                let ideal = -load / 20.0;
                let friction = if w * ideal > 0.0 { rho } else { -rho };
                near(last(&t, "gear.flange_a.tau"), ideal * (gamma + friction).tan() / gamma.tan(), 1e-6);
                assert!(last(&t, "gear.lossPower") > 0.0);
            }
        }
    }
}

/// Below the angle of friction the load creeps at w_0 artanh(g/rho); above it runs away with the closed acceleration.
#[test]
fn the_worm_gear_locks_below_the_angle_of_friction() {
    let mut gear = circuit(
        "Mechanical.Rotational.Inertia worm(J = 0.05), wheel(J = 1);
        Mechanical.Rotational.ConstantTorque load(tau_constant = -100);
        Mechanical.Rotational.WormGear gear(ratio = 20, gamma = 0.04, mu = 0.06, alpha = 0.349, w_0 = 0.1);",
        "connect(worm.flange_b, gear.flange_a); connect(gear.flange_b, wheel.flange_a);
        connect(wheel.flange_b, load.flange);",
    );
    gear.stop_time(5.0);
    let rho = (0.06 / 0.349_f64.cos()).atan();
    let t = settled(&mut gear, &[("gear.gamma", 0.04)]);
    near(last(&t, "worm.w"), -0.1 * (0.04 / rho).atanh(), 1e-3);
    let t = settled(&mut gear, &[("gear.gamma", 0.1)]);
    let back = (0.1 - rho).tan() / 0.1_f64.tan();
    near(last(&t, "worm.w"), -5.0 * 5.0 * back / (0.05 + back / 400.0), 2e-3);
}

#[test]
fn relative_sensors_give_differences() {
    for (class, sensor, state) in [
        ("Rotational.Examples.RelativeSpeedSensorExample", "sensor.w_rel", "w"),
        ("Rotational.Examples.RelativePositionSensorExample", "sensor.phi_rel", "phi"),
        ("Translational.Examples.RelativeSpeedSensorExample", "sensor.v_rel", "v"),
        ("Translational.Examples.RelativePositionSensorExample", "sensor.s_rel", "s"),
    ] {
        let t = run(&shipped(&format!("Mechanical.{class}")));
        let (load, mass) = (column(&t, &format!("load.{state}")), column(&t, &format!("mass.{state}")));
        for (i, found) in column(&t, sensor).iter().enumerate() {
            assert!((found - (load[i] - mass[i])).abs() < 1e-9, "{class} at {}", t.times[i]);
        }
        assert!(column(&t, sensor).iter().any(|v| v.abs() > 1e-3), "{class} rests");
    }
}

/// Viscosity at 40 degC and the warming behind a throttle, (1 - gamma T_0) dp/(rho c_p).
#[test]
fn water_and_water_glycol_have_their_values() {
    for (fluid, mu, rho, c_p, gamma) in
        [("Water", 0.653e-3, 992.2, 4179.0, 3.85e-4), ("WaterGlycol", 46e-6 * 1063.8, 1063.8, 3300.0, 6e-4)]
    {
        let throttle = |dp: f64| {
            circuit(
                &format!(
                    "inner Oil.{fluid} oil(thermal = true); Hydraulic.PressureSource supply(p = {});
                    Hydraulic.Orifice orifice(A = 1e-6); Hydraulic.FlowSensor line; Hydraulic.TemperatureSensor behind;
                    Hydraulic.Tank tank;",
                    101_325.0 + dp
                ),
                "connect(supply.port, orifice.port_a); connect(orifice.port_b, line.port_a);
                connect(line.port_b, tank.port); connect(behind.port, line.port_a);",
            )
        };
        let t = run(throttle(10e5).stop_time(0.1));
        near(last(&t, "oil.mu"), mu, 1e-4);
        near(last(&t, "behind.T") - 313.15, (1.0 - gamma * 313.15) * 10e5 / (rho * c_p), 0.01);
        near(last(&t, "orifice.q"), 0.65 * 1e-6 * (2.0 * 10e5 / rho).sqrt(), 0.01);
    }
}
