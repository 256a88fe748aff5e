//! Whole circuits as engineers put them together: several valves in series without volumes between, cylinders with
//! masses, closed loops with charge and flushing; they begin and reach their end.

use crate::rig;

use rig::{at, circuit, column, last, run, shipped};

/// Between flushing valve, relief valve and cooler lie nodes without oil; all are closed while the loop changes sides.
#[test]
fn a_hydrostatic_transmission_changes_sides() {
    let mut simulation = circuit(
        "inner Oil.ISOVG46 oil(useTemperatureInput = true);
         Thermal.OilMass heat(C = 60e3, T_start = 303.15);
         Mechanical.Rotational.ConstantSpeed engine(w_fixed = 188);
         Hydraulic.AxialPistonMachine pump(useInput = true, useHeatPort = true);
         Hydraulic.AxialPistonMachine motor(useHeatPort = true);
         Signal.Ramp swash(height = 1, duration = 2, startTime = 0.5);
         Hydraulic.ChargeUnit charge;
         Hydraulic.Volume a(V = 1e-3, p_start = 20e5);
         Hydraulic.Volume b(V = 1e-3, p_start = 20e5);
         Hydraulic.FlushingValve flushing;
         Hydraulic.ReliefValve outlet(p_set = 16e5, useHeatPort = true);
         Hydraulic.Cooler cooler;
         Hydraulic.Tank tank;
         Mechanical.Rotational.Inertia load(J = 5);
         Mechanical.Rotational.QuadraticLoad drag;",
        "connect(engine.flange, pump.flange);
         connect(engine.flange, charge.flange);
         connect(swash.y, pump.u);
         connect(pump.port_a, a.port);
         connect(pump.port_b, b.port);
         connect(motor.port_a, a.port);
         connect(motor.port_b, b.port);
         connect(charge.port_a, a.port);
         connect(charge.port_b, b.port);
         connect(charge.port_tank, tank.port);
         connect(flushing.port_a, a.port);
         connect(flushing.port_b, b.port);
         connect(flushing.port_out, outlet.port_a);
         connect(outlet.port_b, cooler.port_a);
         connect(cooler.port_b, tank.port);
         connect(motor.flange, load.flange_a);
         connect(load.flange_b, drag.flange);
         connect(pump.heatPort, heat.port);
         connect(motor.heatPort, heat.port);
         connect(outlet.heatPort, heat.port);
         connect(cooler.oilHeat, heat.port);
         connect(heat.T, oil.T_in);",
    );
    for tolerance in [1e-5, 1e-6] {
        simulation.settings().tolerance = tolerance;
        let t = run(simulation.stop_time(10.0));
        // full displacement: motor and pump turn alike but for their leakage
        assert!(last(&t, "load.w").abs() > 0.9 * 188.0, "{}", last(&t, "load.w"));
    }
}

/// Compensator and metering orifice are closed, with a node between, when the lever is moved.
#[test]
fn two_consumers_share_a_load_sensing_pump() {
    let mut simulation = circuit(
        "inner Oil.ISOVG46 oil;
         Mechanical.Rotational.ConstantSpeed engine(w_fixed = 200);
         Hydraulic.Pump pump(V = 45e-6, useInput = true);
         Hydraulic.PumpControl.LoadSensingControl control(V = 45e-6);
         Hydraulic.Tank tank;
         Hydraulic.Volume line(V = 1e-3);
         Hydraulic.PressureCompensator before_lift, before_steer;
         Hydraulic.VariableOrifice to_lift, to_steer;
         Hydraulic.ShuttleValve shuttle;
         Hydraulic.SingleActingCylinder lift;
         Hydraulic.Cylinder steer;
         Mechanical.Translational.Mass m_1(m = 2000, s(fixed = false), v(fixed = false));
         Mechanical.Translational.Mass m_2(m = 500, s(fixed = false), v(fixed = false));
         Mechanical.Translational.ConstantForce weight(f_constant = -2e4);
         Mechanical.Translational.SpringDamper tyre(c = 1e5, d = 1e4);
         Mechanical.Translational.Fixed road;
         Signal.Trapezoid u_1(amplitude = 0.5, rising = 0.2, holding = 1, falling = 0.2, startTime = 0.5);
         Signal.Trapezoid u_2(amplitude = 0.8, rising = 0.2, holding = 1, falling = 0.2, startTime = 1);",
        "connect(engine.flange, pump.flange);
         connect(pump.port_b, tank.port);
         connect(pump.port_a, line.port);
         connect(control.port_p, line.port);
         connect(control.u, pump.u);
         connect(line.port, before_lift.port_a);
         connect(line.port, before_steer.port_a);
         connect(before_lift.port_b, to_lift.port_a);
         connect(before_steer.port_b, to_steer.port_a);
         connect(to_lift.port_b, lift.port);
         connect(to_steer.port_b, steer.port_1);
         connect(before_lift.port_y, lift.port);
         connect(before_steer.port_y, steer.port_1);
         connect(shuttle.port_a, lift.port);
         connect(shuttle.port_b, steer.port_1);
         connect(shuttle.port_out, control.port_LS);
         connect(steer.port_2, tank.port);
         connect(u_1.y, to_lift.u);
         connect(u_2.y, to_steer.u);
         connect(lift.flange, m_1.flange_a);
         connect(m_1.flange_b, weight.flange);
         connect(steer.flange, m_2.flange_a);
         connect(m_2.flange_b, tyre.flange_a);
         connect(tyre.flange_b, road.flange);",
    );
    let t = run(simulation.stop_time(4.0));
    assert!(at(&t, "lift.piston.s", 0.9) > at(&t, "lift.piston.s", 0.5) + 1e-3, "the load is lifted");
    assert!(at(&t, "steer.s", 2.0) > at(&t, "steer.s", 1.0) + 0.01, "the wheels turn");
}

/// All of a sudden the drop that lay over the orifice lies over the compensator: Newton's method leaps from one side of
/// the orifice's root to the other.
#[test]
fn an_orifice_opens_at_once_behind_a_closed_compensator() {
    let mut simulation = circuit(
        "inner Oil.ISOVG46 oil;
         Hydraulic.PressureSource source(p = 210e5);
         Hydraulic.PressureCompensator compensator;
         Hydraulic.VariableOrifice meter(A_max = 2e-5);
         Hydraulic.Tank tank;
         Signal.Step lever(height = 0.5, startTime = 0.5);",
        "connect(source.port, compensator.port_a);
         connect(compensator.port_b, meter.port_a);
         connect(meter.port_b, tank.port);
         connect(compensator.port_y, tank.port);
         connect(lever.y, meter.u);",
    );
    let t = run(simulation.stop_time(1.0));
    // 7.2 to 8 bar over half of 20 mm2
    let (least, most) = (0.65e-5 * (2.0 * 7.2e5 / 870.0_f64).sqrt(), 0.65e-5 * (2.0 * 8e5 / 850.0_f64).sqrt());
    let q = last(&t, "meter.q");
    assert!((least..most).contains(&q), "{q} m3/s");
}

/// Of a loop that has no value where it begins, the operation is reported that spoils it, not what reads it.
#[test]
fn what_is_not_finite_in_a_loop_is_told_where_it_is_made() {
    let simulation = circuit(
        "Real x(start = 2);
         Real rho;
         Real q;",
        "rho = min(x, 0);
         q = sin(2/rho);
         x + 0.1*sin(x) = 3 + 0.1*q;",
    );
    let message = simulation.run().expect_err("it divides by zero wherever it looks").to_string();
    assert!(message.contains("2/rho") && message.contains("2/0"), "{message}");
}

/// Oil that comes from a source and goes into another, with no pressure given anywhere.
#[test]
fn oil_between_flow_sources_has_no_level() {
    let simulation = circuit(
        "inner Oil.ISOVG46 oil;
         Hydraulic.FlowSource into(q = 1e-4), out_of(q = -1e-4);
         Hydraulic.Orifice between;",
        "connect(into.port, between.port_a);
         connect(between.port_b, out_of.port);",
    );
    let message = simulation.run().expect_err("no pressures fit").to_string();
    assert!(message.contains("E302") && message.contains("{into, between, out_of}"), "{message}");
    // a volume anywhere is a level: what else is wrong is reported as before
    let held = circuit(
        "inner Oil.ISOVG46 oil;
         Hydraulic.FlowSource into(q = 1e-4), out_of(q = -1e-4);
         Hydraulic.Volume volume(V = 1e-4);
         Hydraulic.Orifice between;",
        "connect(into.port, between.port_a);
         connect(between.port_b, volume.port);
         connect(volume.port, out_of.port);",
    );
    held.run().expect("it runs");
}

/// A rod is pulled out of a closed cylinder with more than the pressure of the air holds.
#[test]
fn a_cavitating_chamber_is_told() {
    let mut simulation = circuit(
        "inner Oil.ISOVG46 oil;
         Hydraulic.Cylinder cylinder;
         Hydraulic.Plug plug;
         Hydraulic.Tank tank;
         Mechanical.Translational.ConstantForce pull(f_constant = 5e3);",
        "connect(cylinder.port_1, plug.port);
         connect(cylinder.port_2, tank.port);
         connect(cylinder.flange, pull.flange);",
    );
    let outcome = simulation.stop_time(0.1).run().expect("it runs on");
    let message: Vec<String> = outcome.diagnostics.iter().map(|d| d.message.clone()).collect();
    assert_eq!(message.len(), 1, "{message:?}");
    assert!(message[0].starts_with("The oil cavitates"), "{message:?}");
}

/// A piston is drawn out of a blocked chamber to ten times its volume and pushed back, three times: the absolute pressure
/// stays above zero, and the oil is all there when the void has closed. Where oil carries heat, the same.
#[test]
fn a_blocked_chamber_is_drawn_apart_and_closes_again() {
    for thermal in ["", "(thermal = true)"] {
        for density in ["entrainedAir", "entrainedAir(alpha_0 = 0)", "dissolvingAir"] {
            let chamber = circuit(
                &format!(
                    "inner Oil.Fluid oil{thermal}(redeclare function density = Oil.Compression.{density});
                     Hydraulic.Chamber chamber(A = 1e-3, V_0 = 1e-4);
                     Hydraulic.Plug plug;
                     Mechanical.Translational.Position piston;
                     Signal.Sine move(amplitude = 0.45, offset = 0.45, phase = -Modelica.Constants.pi/2, f = 1);"
                )
                .replace(")(", ", "),
                "connect(chamber.port, plug.port); connect(piston.flange, chamber.flange); connect(move.y, piston.s_ref);
                 annotation(experiment(StopTime = 3, Interval = 0.01, Tolerance = 1e-8));",
            );
            let t = run(&chamber);
            let (p, mass) = (column(&t, "chamber.p"), column(&t, "chamber.mass"));
            assert!(p.iter().all(|p| *p > 5e3 && *p < 1e6), "{density}: {p:?}");
            assert!(mass.iter().all(|m| (m / mass[0] - 1.0).abs() < 1e-3), "{density}: {mass:?}");
        }
    }
}

/// The load is lifted against the counterbalance valve's check, held by the brake, and let down no faster than the pilot
/// allows: with the high side of the motor at B, as its ports say.
#[test]
fn a_winch_lifts_holds_and_lowers_its_load() {
    let mut simulation = circuit(
        "inner Oil.ISOVG46 oil;
         Hydraulic.Tank tank;
         Hydraulic.FlowSource pump(q = 1.33e-3);
         Hydraulic.ReliefValve relief(p_set = 250e5, q_nom = 1.33e-3);
         Hydraulic.Volume supply(V = 1e-3), up(V = 0.5e-3), held(V = 0.2e-3), down(V = 0.5e-3);
         Hydraulic.Valve43 valve(q_nom = 1.33e-3, overlap = 0.1);
         Hydraulic.CounterbalanceValve holding(p_set = 250e5, q_nom = 1.33e-3);
         Hydraulic.Pump motor(V = 80e-6, G = 2e-12, T_c = 2);
         Mechanical.Rotational.Inertia shaft(J = 0.05);
         Mechanical.Rotational.Brake brake(fn_max = 600, mu_c = 1);
         Mechanical.Rotational.LossyGear gear(ratio = 25);
         Mechanical.Rotational.IdealRackAndPinion drum(ratio = 5);
         Mechanical.Translational.Mass load(m = 2000);
         Mechanical.Translational.Gravity weight(m = 2000);
         Signal.TimeTable lever(table = [0, 0; 1, 0; 1.5, 0.6; 5, 0.6; 5.5, 0; 7, 0; 7.5, -0.5; 10, -0.5; 10.5, 0]);
         Signal.TimeTable engaged(table = [0, 1; 1.1, 1; 1.2, 0; 5.5, 0; 5.7, 1; 7.1, 1; 7.2, 0; 10.5, 0; 10.7, 1]);",
        "connect(pump.port, supply.port);
         connect(supply.port, relief.port_a);
         connect(relief.port_b, tank.port);
         connect(supply.port, valve.port_P);
         connect(valve.port_T, tank.port);
         connect(valve.port_A, up.port);
         connect(up.port, holding.port_a);
         connect(holding.port_b, held.port);
         connect(held.port, motor.port_b);
         connect(motor.port_a, down.port);
         connect(down.port, valve.port_B);
         connect(holding.port_x, down.port);
         connect(lever.y, valve.u);
         connect(motor.flange, shaft.flange_a);
         connect(shaft.flange_b, brake.flange_a);
         connect(engaged.y, brake.f_normalized);
         connect(brake.flange_b, gear.flange_a);
         connect(gear.flange_b, drum.flangeR);
         connect(drum.flangeT, load.flange_a);
         connect(load.flange_b, weight.flange);",
    );
    let t = run(simulation.stop_time(12.0));
    assert!(at(&t, "load.s", 5.4) > 2.0, "lifted by {} m", at(&t, "load.s", 5.4));
    assert!((at(&t, "load.s", 6.9) - at(&t, "load.s", 6.0)).abs() < 1e-6, "held by the brake");
    let v = at(&t, "load.v", 9.0);
    assert!((-1.1..-0.5).contains(&v), "let down at {v} m/s by the pump, not by its weight");
}

/// A body of a hundredth of a gram breaks loose at the force that holds it, and not above.
#[test]
fn dry_friction_holds_a_tiny_mass_up_to_its_limit() {
    for light in ["mass.m", "load.m"] {
        let mut simulation = shipped("Mechanical.Translational.Examples.FrictionExample");
        simulation.set(light, 1e-5).expect("it is a parameter");
        let t = run(&simulation);
        let most = column(&t, "contact.f").iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        assert!((3.99..4.0 + 1e-3).contains(&most), "{light}: {most} N");
    }
}

/// Whatever drives: at no power, in both directions, with any efficiency.
#[test]
fn gears_and_screws_never_give_power() {
    let mut simulation = circuit(
        "Signal.Sine torque(amplitude = 2, f = 0.7);
         Mechanical.Rotational.Torque drive;
         Mechanical.Rotational.Inertia rotor(J = 1e-2);
         Mechanical.Rotational.LossyGear gear(ratio = 3, eta = 0.7);
         Mechanical.Rotational.Screw screw(pitch = 0.02, eta = 0.6, eta_back = 0.05);
         Mechanical.Translational.Mass table(m = 5);
         Mechanical.Translational.Spring spring(c = 2e3);
         Mechanical.Translational.Fixed wall;",
        "connect(torque.y, drive.tau);
         connect(drive.flange, rotor.flange_a);
         connect(rotor.flange_b, gear.flange_a);
         connect(gear.flange_b, screw.flangeR);
         connect(screw.flangeT, table.flange_a);
         connect(table.flange_b, spring.flange_a);
         connect(spring.flange_b, wall.flange);",
    );
    let t = run(simulation.stop_time(5.0));
    for part in ["gear.lossPower", "screw.lossPower"] {
        let least = column(&t, part).iter().fold(f64::INFINITY, |m, p| m.min(*p));
        assert!(least >= 0.0, "{part} falls to {least} W");
        assert!(column(&t, part).iter().any(|p| *p > 0.1), "{part} does something");
    }
}

/// A shaft that stands at any angle has no speed.
#[test]
fn an_encoder_begins_where_the_shaft_stands() {
    let mut simulation = circuit(
        "Mechanical.Rotational.Inertia shaft(J = 1e-3, phi(start = 2));
         Electrical.Drives.Encoder encoder;",
        "connect(shaft.flange_b, encoder.flange);",
    );
    let t = run(simulation.stop_time(0.01));
    assert!(column(&t, "encoder.w").iter().all(|w| *w == 0.0), "{:?}", column(&t, "encoder.w"));
}

/// The same pressure at the start in each accumulator, as it is the same parameter.
#[test]
fn accumulators_begin_at_their_pressure() {
    for class in ["Accumulator", "AccumulatorPolytropic", "AccumulatorRealGas"] {
        for bar in [91.0, 150.0, 300.0] {
            let mut simulation = circuit(
                &format!(
                    "inner Oil.ISOVG46 oil; Hydraulic.{class} gas(V_0 = 1e-2, p_pre = 90e5, p_start = {bar}e5);
                     Hydraulic.Orifice drain(A = 1e-7); Hydraulic.Tank tank;"
                ),
                "connect(gas.port, drain.port_a); connect(drain.port_b, tank.port);",
            );
            let t = run(simulation.stop_time(1.0));
            let found = at(&t, "gas.p", 0.0);
            assert!((found - bar * 1e5).abs() < 1.0, "{class}: {found} Pa instead of {bar} bar");
        }
    }
}

/// What cannot be meant gets a word at its place: oil without a way out, a speed in rev/min, an accumulator that is empty.
#[test]
fn what_no_machine_stands_is_said() {
    let said = |components: &str, equations: &str| -> String {
        let mut simulation = circuit(&format!("inner Oil.ISOVG46 oil; {components}"), equations);
        let run = simulation.stop_time(2.0).run().expect("runs all the same");
        run.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ")
    };
    let pump = |w: f64, relief: &str| {
        said(
            &format!(
                "Mechanical.Rotational.ConstantSpeed motor(w_fixed = {w}); Hydraulic.Pump pump(V = 10e-6);
                Hydraulic.Tank tank; Hydraulic.Volume line(p_start = 1e6); Hydraulic.ReliefValve relief(p_set = 100e5);"
            ),
            &format!(
                "connect(motor.flange, pump.flange); connect(tank.port, pump.port_b); connect(pump.port_a, line.port); {relief}"
            ),
        )
    };
    let right = "connect(line.port, relief.port_a); connect(relief.port_b, tank.port);";
    let wrong = "connect(line.port, relief.port_b); connect(relief.port_a, tank.port);";
    assert_eq!(pump(150.0, right), "");
    assert!(pump(150.0, wrong).contains("joined the wrong way round"));
    assert!(pump(1500.0, right).contains("rev/min"));
    let accumulator = |p_start: &str| {
        said(
            &format!(
                "Hydraulic.Accumulator store(p_pre = 50e5, p_start = {p_start}); Hydraulic.FlowSource source(q = 1e-5);"
            ),
            "connect(source.port, store.port);",
        )
    };
    assert_eq!(accumulator("60e5"), "");
    assert!(accumulator("10e5").contains("empty at the start"));
}

/// A brake and a bearing, beside each other or behind each other, hold one shaft: the sum of what they carry is the
/// load, and the shaft breaks loose at the sum of what they can hold, in both directions.
#[test]
fn two_frictions_hold_one_shaft() {
    let joints = [
        "connect(shaft.flange_b, brake.flange_a); connect(shaft.flange_b, bearing.flange_a);",
        "connect(shaft.flange_b, bearing.flange_a); connect(bearing.flange_b, brake.flange_a);",
    ];
    for (joint, direction) in joints.iter().flat_map(|joint| [(joint, 1.0), (joint, -1.0)]) {
        let mut simulation = circuit(
            "Signal.Ramp load(height = 40, duration = 4);
             Signal.Constant engaged(k = 1);
             Mechanical.Rotational.Torque drive;
             Mechanical.Rotational.Inertia shaft(J = 0.1, w(start = 0, fixed = true), phi(start = 0, fixed = true));
             Mechanical.Rotational.Brake brake(fn_max = 50);
             Mechanical.Rotational.BearingFriction bearing(tau_c = 5, tau_s = 5, d = 0);",
            &format!(
                "connect(load.y, drive.tau); connect(engaged.y, brake.f_normalized);
                 connect(drive.flange, shaft.flange_a); {joint}"
            ),
        );
        simulation.set("load.height", 40.0 * direction).expect("it is a parameter");
        let t = run(simulation.stop_time(4.0));
        for time in [0.0, 0.3, 1.0, 2.0, 2.49] {
            let (brake, bearing) = (at(&t, "brake.tau", time), at(&t, "bearing.tau", time));
            assert!((brake + bearing - 10.0 * time * direction).abs() < 1e-6, "{brake} + {bearing} N.m at {time} s");
            assert!(brake.abs() <= 20.0 + 1e-6 && bearing.abs() <= 5.0 + 1e-6, "{brake}, {bearing} N.m at {time} s");
            assert_eq!(at(&t, "shaft.w", time), 0.0);
        }
        // J dw/dt = 10 t - 25 from 2.5 s on
        let w = direction * (10.0 * 1.5 * 1.5 / 2.0) / 0.1;
        assert!((at(&t, "shaft.w", 4.0) - w).abs() < 1e-4 * w.abs(), "{} rad/s, not {w}", at(&t, "shaft.w", 4.0));
    }
}
