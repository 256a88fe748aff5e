//! Physics of the shipped components: balances, passivity, closed forms, published problems, order of convergence.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use rig::{Numbers, at, circuit, column, last, mean_from, near, run, shipped, shipped_with};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

// --- Balances ---------------------------------------------------------------------------------------------------------

#[test]
fn oil_is_neither_made_nor_lost() {
    for (name, masses) in [
        ("ServoPump.DeadZone", ["volume_A.mass", "volume_B.mass", "accumulator.mass"]),
        ("ServoPump.System", ["cylinder.chamber_1.mass", "cylinder.chamber_2.mass", "accumulator.mass"]),
    ] {
        let outcome = shipped(name).run().expect("it runs");
        let t = &outcome.trajectory;
        let sum = |i: usize| masses.iter().map(|m| column(t, m)[i]).sum::<f64>();
        for i in 0..t.len() {
            near(sum(i), sum(0), 1e-6);
        }
    }
}

/// Air that dissolves in the cells of a line, in the chambers of a cylinder and in a volume takes no oil away and brings
/// none, while a force moves oil between them.
#[test]
fn dissolving_air_leaves_the_oil_as_it_is() {
    let air = "redeclare model Air = Hydraulic.EntrainedAir.Dissolving";
    let mut simulation = circuit(
        &format!(
            "inner Oil.ISOVG46 oil(x_u = 0.5);
             Hydraulic.Line line(L = 2, n = 3, volume_a = true, volume_b = true, p_start = 1e7, {air});
             Hydraulic.Cylinder cylinder(A_1 = 1e-3, A_2 = 1e-3, p_1_start = 1e7, p_2_start = 1e7, {air}, s_start = 0.09);
             Hydraulic.Hose hose(p_start = 1e7, {air});
             Hydraulic.Volume volume(p_start = 1e7, {air}), alone(p_start = 1e7, {air});
             Hydraulic.Plug plug, other;
             Mechanical.Translational.Force force;"
        ),
        "connect(plug.port, line.port_a); connect(line.port_b, cylinder.port_1); connect(cylinder.port_2, hose.port_a);
         connect(hose.port_b, volume.port); connect(alone.port, other.port);
         connect(force.flange, cylinder.flange); force.f = 3e3*sin(3*time);",
    );
    simulation.settings().tolerance = 1e-8;
    let t = run(simulation.stop_time(10.0));
    let held = ["line.mass", "cylinder.chamber_1.mass", "cylinder.chamber_2.mass", "hose.volume.mass", "volume.mass"];
    let sum = |i: usize| held.iter().map(|m| column(&t, m)[i]).sum::<f64>();
    for i in 0..t.len() {
        near(sum(i), sum(0), 1e-7);
    }
    for share in
        ["line.air[1].share", "line.air[3].share", "cylinder.chamber_1.air.share", "cylinder.chamber_2.air.share"]
    {
        assert!((0.1..0.45).contains(&last(&t, share)), "{share}: {}", last(&t, share));
    }
    // held above the pressure at which all air is dissolved, the share falls with the time constant of 10 s
    near(last(&t, "alone.air.share"), 0.5 * (-1.0f64).exp(), 1e-5);
    assert!(last(&t, "alone.p") < 0.995e7, "{}", last(&t, "alone.p"));
}

/// A rotor drives a pump against a closed volume and an orifice until it stands: what it had is in the losses, the
/// rest in the oil.
#[test]
fn energy_goes_from_the_rotor_into_oil_and_losses() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.2e9));
         Mechanical.Rotational.Inertia rotor(J = 0.05, w(start = 150));
         Hydraulic.Pump pump(V = 1e-5, starvation = false, compression = false);
         Hydraulic.Volume high(V = 2e-3, p_start = 1e6);
         Hydraulic.Orifice orifice(A = 2e-6);
         Hydraulic.Tank low(p = 1e6);
         Real lost(start = 0, fixed = true, nominal = 100);",
        "connect(rotor.flange_b, pump.flange);
         connect(pump.port_a, high.port);
         connect(high.port, orifice.port_a);
         connect(orifice.port_b, low.port);
         connect(pump.port_b, low.port);
         der(lost) = pump.lossPower + orifice.lossPower;",
    );
    simulation.settings().tolerance = 1e-8;
    let t = run(simulation.stop_time(3.0));
    for time in [0.024, 0.102, 0.504, 0.996, 3.0] {
        // Only the pressure above the low side counts: the rest goes round with the constant low side.
        let oil = 2e-3 * (at(&t, "high.p", time) - 1e6).powi(2) / (2.0 * 1.2e9);
        let rotor = 0.025 * at(&t, "rotor.w", time).powi(2);
        near(rotor + oil + at(&t, "lost", time), 0.025 * 150.0 * 150.0, 1e-5);
    }
}

#[test]
fn a_pendulum_keeps_its_energy() {
    let mut simulation = circuit(
        "Mechanical.Rotational.Inertia arm(J = 2, phi(start = 2));
         Mechanical.Rotational.Torque weight;",
        "weight.tau = -9.81*3*sin(arm.phi); connect(weight.flange, arm.flange_a);",
    );
    simulation.settings().tolerance = 1e-9;
    let t = run(simulation.stop_time(60.0));
    let energy = |i: usize| column(&t, "arm.w")[i].powi(2) - 29.43 * column(&t, "arm.phi")[i].cos();
    for i in 0..t.len() {
        assert!((energy(i) - energy(0)).abs() < 1e-4 * 29.43, "{} at {} s", energy(i) - energy(0), t.times[i]);
    }
}

/// A tolerance a million times tighter is at least ten thousand times closer to the closed form, each step closer.
#[test]
fn the_error_falls_with_the_tolerance() {
    let mut simulation = circuit(
        "Mechanical.Translational.Mass mass(m = 2, s(start = 1));
         Mechanical.Translational.SpringDamper spring(c = 800, d = 4);
         Mechanical.Translational.Fixed wall;",
        "connect(wall.flange, spring.flange_a); connect(spring.flange_b, mass.flange_a);",
    );
    simulation.stop_time(2.0);
    let exact = |time: f64| {
        let (decay, w) = (1.0, (400.0f64 - 1.0).sqrt());
        (-decay * time).exp() * ((w * time).cos() + decay / w * (w * time).sin())
    };
    let mut error = |tolerance: f64| {
        simulation.settings().tolerance = tolerance;
        let t = run(&simulation);
        let errors = t.times.iter().zip(column(&t, "mass.s")).map(|(time, s)| (s - exact(*time)).abs());
        errors.fold(0.0f64, f64::max)
    };
    let found: Vec<f64> = [1e-4, 1e-6, 1e-8, 1e-10].map(&mut error).to_vec();
    assert!(found.windows(2).all(|w| w[1] < w[0] / 10.0) && found[3] < found[0] / 1e4, "{found:?}");
}

// --- Published problems ---------------------------------------------------------------------------------------------

#[test]
fn the_mass_on_the_belt_sticks_27_times() {
    let mut simulation = shipped("Belt");
    let outcome = simulation.run().expect("it runs");
    let t = &outcome.trajectory;
    let locked = column(t, "friction.locked");
    assert_eq!(locked.windows(2).filter(|w| w[0] == 0.0 && w[1] == 1.0).count(), 27);
    simulation.settings().tolerance = 1e-10;
    let exact = simulation.run().expect("it runs").trajectory;
    let (x, e) = (t.index("x").expect("x"), exact.index("x").expect("x"));
    let squares = (0..=2000).map(|k| {
        let time = f64::from(k) * 0.01;
        (t.value(x, time).expect("a value") - exact.value(e, time).expect("a value")).powi(2)
    });
    let rms = (squares.sum::<f64>() / 2001.0).sqrt();
    assert!(rms < 2e-6, "{rms}");
}

#[test]
fn stiff_problems_end_at_their_published_values() {
    let published = [
        ("Robertson", vec![("y_1", 0.7158), ("y_2", 9.185e-6), ("y_3", 0.2842)], 1e-3),
        (
            "AkzoNobel",
            vec![("y_1", 0.1150794920661702), ("y_4", 0.3656156421249283e-3), ("y_6", 0.4873531310307455e-2)],
            1e-4,
        ),
        ("TransistorAmplifier", vec![("y[3]", 2.849958788608128), ("y[8]", 1.236995868091548)], 1e-3),
    ];
    for (name, values, relative) in published {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/stiff").join(format!("{name}.mo"));
        let text = std::fs::read_to_string(root).expect("the file is there");
        let request = Request { source: "model.mo".into(), model: Some(name.into()), ..Request::default() };
        let mut world = MemoryWorld::single("model.mo", text);
        world.add("note.txt", "a world with the file alone");
        let outcome = Simulation::compile(&world, &request).expect("it is right").run().expect("it runs");
        for (variable, wanted) in values {
            near(last(&outcome.trajectory, variable), wanted, relative);
        }
    }
}

// --- Closed forms ---------------------------------------------------------------------------------------------------

#[test]
fn a_fast_stroke_of_the_accumulator_is_adiabatic_and_a_slow_one_isothermal() {
    for (flow, stop, exponent, relative) in [(-1e-2, 0.02, 1.0 + 296.8 / 743.0, 4e-3), (-1e-7, 2000.0, 1.0, 4e-3)] {
        let mut simulation = circuit(
            &format!(
                "inner Oil.Fluid oil;
                 Hydraulic.Accumulator gas(V_0 = 1e-3, p_pre = 50e5, p_start = 100e5);
                 Hydraulic.FlowSource source(q = {flow:e});"
            ),
            "connect(source.port, gas.port);",
        );
        let t = simulation.stop_time(stop).run().expect("it runs").trajectory;
        let (p, v) = (column(&t, "gas.p"), column(&t, "gas.V_gas"));
        let end = p.len() - 1;
        near((p[end] / p[0]).ln() / (v[0] / v[end]).ln(), exponent, relative);
    }
}

/// Filled beyond its capacity the gas keeps what is left of it, and the pressure rises with the modulus of the oil alone.
#[test]
fn a_full_accumulator_stops() {
    for class in ["Accumulator", "AccumulatorPolytropic", "AccumulatorRealGas"] {
        let mut simulation = circuit(
            &format!(
                "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 1.5e9));
                 Hydraulic.{class} gas(V_0 = 1e-3, p_pre = 20e5, p_start = 20e5, p_max = 50e6, V_full = 0.2);
                 Hydraulic.FlowSource source(q = 1e-5);"
            ),
            "connect(source.port, gas.port);",
        );
        simulation.settings().tolerance = 1e-8;
        let t = run(simulation.stop_time(81.5));
        let full = t.times.iter().position(|&time| time > 81.0).expect("a row");
        let (p, v, time) = (column(&t, "gas.p"), column(&t, "gas.V_gas"), &t.times);
        let (end, soft) = (p.len() - 1, if class == "AccumulatorRealGas" { 0.5 } else { 0.01 });
        near(v[end], 0.2e-3, if soft > 0.1 { 0.04 } else { 1e-6 });
        // the oil of 0.82 l, and in the real gas a stop that takes p_max within a hundredth of V_0
        let stiff = (p[end] - p[full]) / (time[end] - time[full]);
        let oil = 1e-5 * 1.5e9 / 0.82e-3;
        assert!(stiff > (1.0 - soft) * oil && stiff < (1.0 + soft) * oil, "{class}: {stiff} instead of {oil} Pa/s");
    }
}

/// Joined to a heat port, leakage and friction of a machine have the viscosity of the temperature there.
#[test]
fn the_gaps_of_a_machine_have_the_temperature_of_its_case() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(lambda = 0.03);
         Hydraulic.AxialPistonMachine own(useHeatPort = true);
         Hydraulic.AxialPistonMachine common;
         Thermal.FixedTemperature warm(T = oil.T_0 + 20);
         Mechanical.Rotational.ConstantSpeed shaft;
         Hydraulic.PressureSource a(p = 200e5);
         Hydraulic.Tank b;",
        "connect(shaft.flange, own.flange); connect(shaft.flange, common.flange);
         connect(a.port, own.port_a); connect(a.port, common.port_a);
         connect(b.port, own.port_b); connect(b.port, common.port_b);
         connect(warm.port, own.heatPort);",
    );
    let t = run(simulation.stop_time(1e-6));
    near(last(&t, "own.Q_leak"), last(&t, "common.Q_leak") * 0.6f64.exp(), 1e-9);
    near(last(&t, "own.T_slipper"), last(&t, "common.T_slipper") * (-0.6f64).exp(), 1e-9);
    near(-last(&t, "warm.port.Q_flow"), -last(&t, "own.lossPower"), 1e-9);
}

/// At half the displacement the pistons move and lean half as much; slippers and valve plate rub as before.
#[test]
fn pistons_rub_less_at_small_displacement() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil;
         parameter Real displacement = 1;
         Hydraulic.AxialPistonMachine machine(useInput = true);
         Mechanical.Rotational.ConstantSpeed shaft;
         Hydraulic.PressureSource a(p = 200e5);
         Hydraulic.Tank b;",
        "connect(shaft.flange, machine.flange); connect(a.port, machine.port_a); connect(b.port, machine.port_b);
         machine.u = displacement;",
    );
    let whole = run(simulation.stop_time(1e-6));
    let half = run(simulation.set("displacement", -0.5).expect("a parameter"));
    near(last(&half, "machine.T_piston"), last(&whole, "machine.T_piston") / 4.0, 1e-9);
    near(last(&half, "machine.T_slipper"), last(&whole, "machine.T_slipper"), 1e-9);
}

/// Options of the axial piston machine against their closed forms, in oil of constant density: orifices before the
/// slippers, oil that the pistons drag along, films that form with speed, and the ways to the case.
#[test]
fn options_of_the_gaps_are_their_closed_forms() {
    let t = run(circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.5e9));
         Hydraulic.AxialPistonMachine plain(h_s = 1e-4), fed(h_s = 1e-4, orificeFed = true), dragging(h_s = 1e-4, drag = 1),
           drained(h_s = 1e-4, useCasePort = true),
           mixed(redeclare function pistonShare = Hydraulic.MixedFriction.stribeck(Sc_0 = 5e-8));
         Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 30);
         Hydraulic.PressureSource a(p = 200e5);
         Hydraulic.Tank b, housing;",
        &["plain", "fed", "dragging", "drained", "mixed"]
            .map(|m| {
                format!("connect(shaft.flange, {m}.flange); connect(a.port, {m}.port_a); connect(b.port, {m}.port_b);")
            })
            .join("\n")
            .replace("connect(shaft.flange, drained", "connect(drained.port_case, housing.port); connect(shaft.flange, drained"),
    )
    .stop_time(1e-6));
    let of = |name: &str| last(&t, name);
    let dp = 200e5 - 101_325.0;
    // the orifice of 1 mm and 5 mm in series with the land of 8 to 12.5 mm
    let (orifice, land) = (128.0 * 5e-3 / (PI * 1e-12), 6.0 * (12.5f64 / 8.0).ln() / (PI * 1e-12));
    near(of("fed.Q_slipper"), of("plain.Q_slipper") * land / (land + orifice), 1e-9);
    // half the gap of 24 um around nine pistons, over their mean speed
    let dragged = 9.0 * PI * 0.02 * 12e-6 * (0.038 * (18.0 * PI / 180.0).tan()) / PI;
    near(of("dragging.Q_A") - of("plain.Q_A"), dragged * 30.0, 1e-6);
    near(of("dragging.T_sh") - of("plain.T_sh"), dragged * dp, 1e-6);
    near(of("dragging.lossPower"), of("plain.lossPower"), 1e-9);
    // with the case at the pressure of the low side nothing is lost but on another way
    near(of("drained.Q_A"), of("plain.Q_A"), 1e-9);
    near(of("drained.port_b.q") - of("plain.port_b.q"), of("drained.Q_case"), 1e-9);
    near(of("drained.Q_case") + of("drained.Q_leak"), of("plain.Q_leak"), 1e-9);
    near(of("drained.lossPower"), of("plain.lossPower"), 1e-9);
    let number = of("oil.mu") * 30.0 / (dp + 1e5);
    let swing: f64 = 0.038 * 0.324_919_696;
    let viscous = |share: f64| share * 4.5 * of("oil.mu") * PI * 0.02 * 0.035 * swing.powi(2) / 24e-6 * 30.0;
    let dry = |share: f64| (1.0 - share) * 0.12 * 1.6 * 0.324_919_696 * of("mixed.V") / (2.0 * PI) * dp;
    let share = 0.7 * (1.0 - (-number / 5e-8).exp());
    near(of("mixed.T_piston"), viscous(share) + dry(share), 2e-3);
}

/// A table over speed instead of Stribeck's formula, the last segment going on.
#[test]
fn a_bearing_rubs_as_its_table_says() {
    let mut simulation = circuit(
        "Mechanical.Rotational.BearingFriction bearing(useTable = true, tau_pos = [0, 2; 1, 1.5; 10, 3]);
         Mechanical.Rotational.ConstantSpeed shaft;",
        "connect(shaft.flange, bearing.flange_a);",
    );
    for (w, torque) in [(0.5, 1.75), (4.0, 2.0), (-4.0, -2.0), (16.0, 4.0)] {
        let t = run(simulation.stop_time(1.0).set("shaft.w_fixed", w).expect("a parameter"));
        near(last(&t, "bearing.flange_a.tau"), torque, 1e-9);
    }
}

/// At the limit of the voltage the flux weakens, the speed is reached all the same, and the voltage is kept.
#[test]
fn beyond_its_nominal_speed_the_flux_of_a_drive_weakens() {
    let t = run(&shipped("Electrical.Examples.FieldWeakeningExample"));
    near(last(&t, "drive.w"), 400.0, 1e-3);
    let limit = 460.0 * (2.0f64 / 3.0).sqrt();
    // currents follow their commands with 10 ms, in which the flux moves little
    let most = column(&t, "drive.u_s").iter().copied().fold(0.0, f64::max);
    assert!(most < 1.02 * limit && most > 0.95 * limit, "{most} V of {limit} V");
    assert!(last(&t, "drive.psi_r") < 0.5, "{} Wb", last(&t, "drive.psi_r"));
    let request = [("drive.voltageLimit", "false")];
    let free = run(&shipped_with("Electrical.Examples.FieldWeakeningExample", &request));
    assert!(last(&free, "drive.u_s") > 2.0 * limit, "{} V", last(&free, "drive.u_s"));
}

/// A trapezoidal spindle of 40 % needs no second efficiency: it locks itself, and the nut does not drive it.
#[test]
fn a_screw_of_low_efficiency_is_not_driven_back() {
    let mut simulation = circuit(
        "Mechanical.Rotational.Screw screw(eta = 0.4, pitch = 5e-3);
         Mechanical.Rotational.ConstantSpeed shaft;
         Mechanical.Translational.ConstantForce load(f_constant = -1000);",
        "connect(shaft.flange, screw.flangeR); connect(screw.flangeT, load.flange);",
    );
    let ideal = 1000.0 * 5e-3 / (2.0 * PI);
    for (w, torque) in [(100.0, ideal / 0.4), (-100.0, 0.0)] {
        let t = run(simulation.set("shaft.w_fixed", w).expect("a parameter").stop_time(1e-6));
        assert!((last(&t, "screw.flangeR.tau") - torque).abs() < 1e-9 * ideal, "at {w} rad/s");
    }
}

/// Merritt, Hydraulic Control Systems, section 3.4: the square root above, a straight line below the transition.
#[test]
fn the_orifice_is_turbulent_above_and_laminar_below_its_transition() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity);
         Hydraulic.PressureSource a;
         Hydraulic.PressureSource b(p = 2e7);
         Hydraulic.Orifice orifice(A = 1e-6);",
        "connect(a.port, orifice.port_a); connect(orifice.port_b, b.port);",
    );
    let mut flow = |dp: f64| {
        let t = run(simulation.set("a.p", 2e7 + dp).expect("a parameter").stop_time(1e-6));
        (last(&t, "orifice.q"), last(&t, "oil.mu"))
    };
    let (q, mu) = flow(1e7);
    near(q, 0.65e-6 * (2.0 * 1e7 / 860.0f64).sqrt(), 1e-3);
    let transition = PI / (8.0 * 1e-6 * 860.0) * (150.0 * mu / 0.65).powi(2);
    near(flow(10.0).0, 0.65e-6 * (2.0 / 860.0 / transition).sqrt() * 10.0, 1e-3);
    assert!(flow(-1e7).0 == -q && flow(0.0).0 == 0.0);
}

/// Hagen and Poiseuille below the critical Reynolds number, Blasius above.
#[test]
fn the_pipe_is_laminar_below_and_turbulent_above() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity);
         Hydraulic.FlowSource source;
         Hydraulic.PipeResistance pipe(L = 2, d = 0.01);
         Hydraulic.Tank tank;",
        "connect(source.port, pipe.port_a); connect(pipe.port_b, tank.port);",
    );
    let mut drop = |q: f64| {
        let t = run(simulation.set("source.q", q).expect("a parameter").stop_time(1e-6));
        (last(&t, "pipe.dp"), last(&t, "oil.mu"))
    };
    let (laminar, mu) = drop(1e-5);
    near(laminar, 128.0 * mu * 2.0 / (PI * 1e-8) * 1e-5, 1e-2);
    let v = 4e-3 / (PI / 4.0 * 1e-4);
    let re = 860.0 * v * 0.01 / mu;
    assert!(re > 5000.0, "{re}");
    near(drop(4e-3).0, 0.316 * re.powf(-0.25) * 2.0 / 0.01 * 860.0 / 2.0 * v * v, 2e-2);
}

/// The motor under flux vector control with the right rotor resistance is the reduced one; a wrong resistance leaves
/// the speed off by its share of the slip.
#[test]
fn a_wrong_rotor_resistance_leaves_the_speed_off() {
    let mut simulation = circuit(
        "Electrical.Drives.FluxVectorDrive drive(w_start = 80);
         Mechanical.Rotational.Inertia rotor(J = 1, w(start = 80));
         Mechanical.Rotational.ConstantTorque load(tau_constant = -100);",
        "drive.w_ref = 80; connect(drive.flange, rotor.flange_a); connect(rotor.flange_b, load.flange);",
    );
    let t = run(simulation.stop_time(20.0));
    near(last(&t, "rotor.w"), 80.0, 1e-5);
    let t = run(simulation.set("drive.R_hat", 1.3).expect("a parameter"));
    near(last(&t, "rotor.w"), 80.0 + 0.3 * last(&t, "drive.w_sl") / 2.0, 1e-5);
}

/// Value and slope of the rounded functions go through their widths without a jump.
#[test]
fn rounded_functions_have_continuous_slopes() {
    for call in [
        "Smooth.sgn(x, 0.1)",
        "Smooth.mag(x, 0.1)",
        "Smooth.step(x)",
        "Smooth.pos(x, 0.1)",
        "Smooth.ramp(x, 0.1)",
        "Smooth.clip(x, 0.1)",
        "Smooth.root(x, 0.1)",
    ] {
        let mut simulation = circuit("Real x; Real y;", &format!("x = 3*time - 1.5; y = {call};"));
        simulation.stop_time(1.0);
        simulation.settings().interval = 1e-4;
        let t = run(&simulation);
        let y = column(&t, "y");
        let slopes: Vec<f64> =
            (1..t.len()).filter(|&i| t.times[i] > t.times[i - 1]).map(|i| (y[i] - y[i - 1]) / 3e-4).collect();
        let jump = slopes.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.05, "{call} jumps in its slope by {jump}");
    }
}

/// Nitrogen at 20 degC and 30 MPa: compressibility 1.13 by tables of properties, 1.0 at 1 MPa.
#[test]
fn the_gas_of_high_pressure_is_less_compressible_than_an_ideal_one() {
    for (pressure, z, relative) in [(30e6, 1.13, 0.04), (1e6, 0.998, 0.004)] {
        let mut simulation = circuit(
            &format!(
                "inner Oil.ISOVG46 oil;
                 Hydraulic.AccumulatorRealGas gas(p_pre = {pressure}, fill = 0.999);
                 Hydraulic.Plug plug;"
            ),
            "connect(gas.port, plug.port);",
        );
        near(last(&run(simulation.stop_time(1.0)), "gas.Z"), z, relative);
    }
}

#[test]
fn closing_a_valve_raises_the_pressure_as_joukowsky_says() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 1.5e9));
         Hydraulic.PressureSource source(p = 50e5);
         Hydraulic.Line pipe(L = 50, d = 2e-2, n = 40, p_start = 50e5, m_flow_start = 0.1);
         Hydraulic.Volume stub(V = 4e-6, p_start = 50e5);",
        "connect(source.port, pipe.port_a);
         connect(pipe.port_b, stub.port);",
    );
    let t = simulation.stop_time(0.03).run().expect("it runs").trajectory;
    let rho = 860.0 * (49e5_f64 / 1.5e9).exp();
    let rise = rho * (1.5e9 / rho).sqrt() * 0.1 / rho / (PI * 1e-4);
    // The wave's front is as wide as a cell and rings; behind it the mean is the rise of the closed form.
    let p = column(&t, "pipe.p[35]");
    let mean = p[p.len() / 2..].iter().sum::<f64>() / (p.len() - p.len() / 2) as f64;
    near(mean - 50e5, rise, 0.08);
}

#[test]
fn the_motor_in_phases_is_the_motor_in_rotor_axes() {
    let tight = |name: &str| {
        let mut simulation = shipped(name);
        simulation.settings().tolerance = 1e-9;
        simulation.run().expect("it runs").trajectory
    };
    let (abc, dq) = (tight("Electrical.Examples.PMSMabcExample"), tight("Electrical.Examples.PMSMdqExample"));
    let (a, b) = (column(&abc, "motor.T_e"), column(&dq, "motor.T_e"));
    let scale = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let (i, j) = (abc.index("motor.T_e").expect("T_e"), dq.index("motor.T_e").expect("T_e"));
    assert_eq!((a.len() > 100, b.len() > 100), (true, true));
    for k in 0..=100 {
        let time = f64::from(k) * 1e-3;
        let difference = abc.value(i, time).expect("a value") - dq.value(j, time).expect("a value");
        assert!(difference.abs() < 1e-6 * scale, "{difference} at {time}");
    }
}

#[test]
fn the_flux_model_of_the_induction_motor_settles_on_its_circuit() {
    let settled = |class: &str, value: &str| {
        let mut simulation = circuit(
            &format!("{class} motor; Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 80);"),
            "connect(shaft.flange, motor.flange); motor.f = 27.74; motor.U = 7.6*27.74/sqrt(3);",
        );
        simulation.settings().tolerance = 1e-9;
        last(&simulation.stop_time(5.0).run().expect("it runs").trajectory, value)
    };
    for value in ["motor.T_e", "motor.P_cu"] {
        let [model, circuit] =
            ["", "Steady"].map(|form| settled(&format!("Electrical.Machines.InductionMotor{form}"), value));
        near(model, circuit, 1e-6);
    }
}

/// At full and half displacement, where the dead volume grows as the plate swings back, and swung over as a motor.
#[test]
fn piston_by_piston_the_pump_loses_what_the_averaged_law_says() {
    for u in [1.0, 0.5, -0.6] {
        let mut simulation = circuit(
            "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 1.5e9));
             parameter Real u = 1;
             Hydraulic.PistonMachine pump(h = 1e-7, p_start = 5e5, useInput = true);
             Hydraulic.Pump averaged(V = 0.8e-6, G = 0, k_p = 0, b = 0, useInput = true);
             Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 60);
             Hydraulic.Tank low(p = 5e5);
             Hydraulic.Tank high(p = 21.5e6);",
            "connect(shaft.flange, pump.flange);
             connect(shaft.flange, averaged.flange);
             connect(pump.port_a, high.port);
             connect(pump.port_b, low.port);
             connect(pump.port_case, low.port);
             connect(averaged.port_a, high.port);
             connect(averaged.port_b, low.port);
             pump.u = u; averaged.u = u;",
        );
        let turn = 2.0 * PI / 60.0;
        simulation.set("u", u).expect("a parameter");
        let settings = simulation.settings();
        (settings.stop_time, settings.interval) = (3.0 * turn, turn / 4000.0);
        let t = simulation.run().expect("it runs").trajectory;
        let mean = |name: &str| mean_from(&t, name, 2.0 * turn);
        near(mean("pump.Q_A"), mean("averaged.Q_A"), 1e-3);
        near(mean("pump.T_sh"), mean("averaged.T_sh"), 1e-3);
        // chambers are compressed at their largest and expand at their least, in densities at A and B
        let density = (21e6f64 / 1.5e9).exp();
        let (large, small) = (0.5 + 0.5 * u + 0.4, 0.5 - 0.5 * u + 0.4);
        near(mean("averaged.Q_A"), 0.8e-6 * 60.0 / (2.0 * PI) * (large / density - small), 2e-4);
    }
}

/// With one-way ports the pistons compress and expand their oil themselves: the flow lacks `(V_s + V_d) dp/beta` of a stroke
/// as with a port plate, the work `V_s dp` is less by `(V_s/2 + V_d) dp^2/beta`, here without neglecting powers of dp/beta.
#[test]
fn one_way_ports_spare_the_work_of_oil_that_rushes_back() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 1.5e9));
         Hydraulic.PistonMachine pump(h = 1e-7, p_start = 5e5, oneWay = true);
         Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 60);
         Hydraulic.Tank low(p = 5e5);
         Hydraulic.Tank high(p = 21.5e6);
         Real work(start = 0, fixed = true), delivered(start = 0, fixed = true, nominal = 1e-6);",
        "connect(shaft.flange, pump.flange); connect(pump.port_a, high.port); connect(pump.port_b, low.port);
         connect(pump.port_case, low.port); der(work) = pump.T_sh*pump.w; der(delivered) = pump.Q_A;",
    );
    let turn = 2.0 * PI / 60.0;
    let settings = simulation.settings();
    (settings.stop_time, settings.interval, settings.tolerance) = (2.0 * turn, turn / 100.0, 1e-8);
    let t = run(&simulation);
    let over = |name: &str| last(&t, name) - at(&t, name, turn);
    let (beta, density) = (1.5e9, (21e6f64 / 1.5e9).exp());
    // chambers of 1.4 strokes are compressed, 0.4 of a stroke expands again
    near(over("delivered"), 0.8e-6 * (1.4 / density - 0.4), 1e-4);
    near(over("work"), 0.8e-6 * beta * (1.4 * (1.0 - 1.0 / density) - 0.4 * (density - 1.0)), 1e-4);
}

/// Flow of the piston machine with stiff oil over one turn against a small pressure, peak to peak over the mean.
fn ripple(more: &str, dp: f64, beta: f64) -> f64 {
    let mut simulation = circuit(
        &format!(
            "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = {beta}));
             Hydraulic.PistonMachine pump(h = 1e-7, p_start = 5e5{more});
             Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 60);
             Hydraulic.Tank low(p = 5e5);
             Hydraulic.Tank high(p = 5e5 + {dp});"
        ),
        "connect(shaft.flange, pump.flange);
         connect(pump.port_a, high.port);
         connect(pump.port_b, low.port);
         connect(pump.port_case, low.port);",
    );
    let turn = 2.0 * PI / 60.0;
    let settings = simulation.settings();
    (settings.stop_time, settings.interval) = (2.0 * turn, turn / 7000.0);
    // the flow into oil of 1e13 Pa is a difference of what the tolerance leaves of the pressure
    settings.tolerance = 1e-8;
    let t = simulation.run().expect("it runs").trajectory;
    let flow = &column(&t, "pump.Q_A")[t.times.partition_point(|&time| time < turn)..];
    let (low, high) = flow.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &q| (l.min(q), h.max(q)));
    (high - low) / mean_from(&t, "pump.Q_A", turn)
}

/// Incompressible oil leaves the ripple of the kinematics, pi/(2 z) tan(pi/(4 z)): 2.5 % for seven pistons. A chamber that
/// opens to the high side at low pressure is filled from there, which is many times as much; a later opening, at which
/// the piston has compressed the oil itself, takes most of that away.
#[test]
fn the_ripple_is_that_of_the_kinematics_and_of_the_timing() {
    let kinematic = PI / 14.0 * (PI / 28.0).tan();
    near(kinematic, 0.025, 0.02);
    near(ripple(", opening = 0.01, A_port = 1e-3", 1e4, 1e13), kinematic, 0.05);
    let abrupt = ripple("", 10e6, 1.5e9);
    let timed = ripple(", timing_a = 0.2", 10e6, 1.5e9);
    assert!(abrupt > 8.0 * kinematic && timed < 0.5 * abrupt, "{abrupt} {timed}");
    let grooved = ripple(", A_groove = 0.3e-6, early = 0.14", 10e6, 1.5e9);
    let one_way = ripple(", oneWay = true", 10e6, 1.5e9);
    assert!(grooved < 0.25 * abrupt && one_way < 0.1 * abrupt, "{grooved} {one_way} of {abrupt}");
}

/// Tips of two gears drag `width h r w` to the high side and take the torque for it: neither a loss nor a gain.
#[test]
fn tooth_tips_drag_oil_to_the_high_side() {
    let mut simulation = circuit(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.5e9));
         Mechanical.Rotational.ConstantSpeed shaft;
         Hydraulic.GearPump pump(V = 1e-5, G = 0, k_p = 0, b = 0, width = 0.03, r_tip = 0.025, h_tip = 2e-5);
         Hydraulic.PressureSource high;
         Hydraulic.Tank low;",
        "connect(shaft.flange, pump.flange); connect(pump.port_a, high.port); connect(pump.port_b, low.port);",
    );
    let displacement = 1e-5 / (2.0 * PI) + 0.03 * 0.025 * 2e-5;
    for (w, p) in [(150.0, 2e7), (-150.0, 2e7), (20.0, 1e5)] {
        simulation.set("shaft.w_fixed", w).expect("a parameter").set("high.p", p).expect("a parameter");
        let t = run(simulation.stop_time(1e-6));
        near(last(&t, "pump.Q_A"), displacement * w, 1e-9);
        near(last(&t, "pump.T_sh"), displacement * (p - 101325.0), 1e-9);
    }
}

/// At the points of its maps and halfway between them, a machine has the efficiencies that stand there.
#[test]
fn a_machine_has_the_efficiencies_of_its_maps() {
    let mut simulation = shipped_with(
        "Hydraulic.Examples.EfficiencyMapFileExample",
        &[("load.p", "20101325"), ("speed.offset", "80"), ("speed.height", "160")],
    );
    let t = run(simulation.stop_time(1.0));
    for (time, w, v, m) in [(0.0, 80.0, 0.920, 0.935), (0.25, 120.0, 0.9375, 0.935), (0.5, 160.0, 0.955, 0.935)] {
        near(at(&t, "pump.w", time), w, 1e-9);
        near(at(&t, "eta_v", time), v, 1e-5);
        near(at(&t, "eta_m", time), m, 1e-5);
    }
    let mut simulation = shipped_with("Hydraulic.Examples.EfficiencyMapFileExample", &[("load.p", "15101325")]);
    let t = run(simulation.stop_time(1e-6));
    near(at(&t, "eta_v", 0.0), 0.5 * (0.84 + 0.72), 1e-5);
    near(at(&t, "eta_m", 0.0), 0.5 * (0.88 + 0.91), 1e-5);
}

// --- Passivity ------------------------------------------------------------------------------------------------------

#[test]
fn machines_take_power_in_all_four_quadrants() {
    let classes = [
        "ServoPump.BenchPump machine(useInput = true)",
        "Hydraulic.Pump machine(V = 1e-5, useInput = true)",
        "Hydraulic.Pump machine(V = 1e-5, useInput = true, compression = false)",
        "Hydraulic.AxialPistonMachine machine(useInput = true)",
        "Hydraulic.AxialPistonMachine machine(useInput = true, starvation = true)",
        "Hydraulic.AxialPistonMachine machine(useInput = true, orificeFed = true, drag = 1,
           redeclare function pistonShare = Hydraulic.MixedFriction.stribeck,
           redeclare function plateShare = Hydraulic.MixedFriction.stribeck)",
        "Hydraulic.AxialPistonMachine machine(useInput = true, drag = 1, useCasePort = true)",
        "Hydraulic.GearPump machine(V = 1e-5, useInput = true)",
        "Hydraulic.WilsonMachine machine(V = 1e-5, useInput = true)",
        "Hydraulic.EfficiencyMapMachine machine(V = 1e-5, useInput = true)",
        "Hydraulic.EfficiencyMapMachine machine(V = 1e-5, fileName = \"modelica://Hydraulic/Resources/efficiency.txt\", useInput = true)",
        "Hydraulic.PolynomialMachine machine(V = 1e-5, useInput = true)",
    ];
    let mut numbers = Numbers(1);
    for class in classes {
        let (housing, drain) = match class.contains("useCasePort") {
            true => ("Hydraulic.Tank housing(p = 2e5);", "connect(machine.port_case, housing.port);"),
            false => ("", ""),
        };
        let mut simulation = circuit(
            &format!(
                "inner Oil.ISOVG46 oil;
                 {class};
                 {housing}
                 parameter Real displacement = 1;
                 Mechanical.Rotational.ConstantSpeed shaft;
                 Hydraulic.PressureSource a;
                 Hydraulic.PressureSource b;"
            ),
            &format!(
                "connect(shaft.flange, machine.flange);
                 connect(a.port, machine.port_a);
                 connect(b.port, machine.port_b);
                 machine.u = displacement;
                 {drain}"
            ),
        );
        simulation.stop_time(1e-6);
        for _ in 0..200 {
            let w = if numbers.next() < 0.3 { numbers.between(-1.0, 1.0) } else { numbers.between(-300.0, 300.0) };
            let (a, b) = (10f64.powf(numbers.between(4.3, 7.5)), 10f64.powf(numbers.between(4.3, 7.5)));
            let u = if numbers.next() < 0.3 { 1.0 } else { numbers.between(-1.0, 1.0) };
            let celsius = numbers.between(-10.0, 90.0);
            let given =
                [("shaft.w_fixed", w), ("a.p", a), ("b.p", b), ("displacement", u), ("oil.T_0", celsius + 273.15)];
            for (name, value) in given {
                simulation.set(name, value).expect("a parameter");
            }
            let t = simulation.run().unwrap_or_else(|e| panic!("{class}: {e}")).trajectory;
            let loss = last(&t, "machine.lossPower");
            assert!(
                loss.is_finite() && loss > -1e-6,
                "{class} gives {loss} W at {w} rad/s, {a} Pa and {b} Pa, {u} of the displacement, {celsius} degC"
            );
        }
    }
}

/// Piston by piston, at every moment: ports, bores with the oil that pistons drag along, friction; over whole turns shaft
/// and oil lose what that adds up to; oil from B to A takes its integral of dp/rho along.
#[test]
fn pistons_take_power_in_all_four_quadrants() {
    for options in ["drag = true, h = 2e-5, k_p = 0.02", "A_groove = 3e-7, early = 0.1, k_p = 0.02", "oneWay = true"] {
        pistons_take_power(options);
    }
}

fn pistons_take_power(options: &str) {
    let parts = format!(
        "inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 1.5e10));
         Hydraulic.PistonMachine machine({options}, useInput = true);
         parameter Real displacement = 1;
         Mechanical.Rotational.ConstantSpeed shaft;
         Hydraulic.PressureSource a;
         Hydraulic.PressureSource b;
         Real given(start = 0, fixed = true);
         Real lost(start = 0, fixed = true);"
    );
    let mut simulation = circuit(
        &parts,
        "connect(shaft.flange, machine.flange);
         connect(a.port, machine.port_a);
         connect(b.port, machine.port_b);
         connect(b.port, machine.port_case);
         machine.u = displacement;
         der(given) = machine.T_sh*machine.w - 1.5e10*(exp(machine.dp/1.5e10) - 1)*machine.Q_A;
         der(lost) = machine.lossPower;",
    );
    for (w, a, b, u) in [
        (60.0, 2e7, 5e5, 1.0),
        (60.0, 5e5, 2e7, 1.0),
        (-60.0, 2e7, 5e5, 0.6),
        (-60.0, 5e5, 2e7, 1.0),
        (60.0, 2e7, 5e5, -0.4),
    ] {
        for (name, value) in [("shaft.w_fixed", w), ("a.p", a), ("b.p", b), ("displacement", u)] {
            simulation.set(name, value).expect("a parameter");
        }
        let turn = 2.0 * PI / 60.0;
        let settings = simulation.settings();
        (settings.stop_time, settings.interval) = (2.0 * turn, turn / 700.0);
        let t = run(&simulation);
        let least = column(&t, "machine.lossPower").iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > -1e-6, "{options}: {least} W at {w} rad/s, {a} and {b} Pa, {u}");
        let over = |name: &str| at(&t, name, 2.0 * turn) - at(&t, name, turn);
        let (given, lost) = (over("given"), over("lost"));
        assert!((given - lost).abs() < 0.05 * lost, "{options}: {given}, {lost} J at {w} rad/s, {a} and {b} Pa, {u}");
    }
}

#[test]
fn restrictions_take_power_in_both_directions() {
    let classes = [
        ("Orifice way", ""),
        ("LaminarGap way", ""),
        ("CheckValve way", ""),
        ("ReliefValve way", ""),
        ("PipeResistance way", ""),
        ("LocalLoss way", ""),
        ("Filter way", ""),
        ("ThrottleCheckValve way", ""),
        ("VariableOrifice way", "way.u = 0.3;"),
        ("VariableOrifice way", "way.u = 0;"),
        ("SpoolEdge way", "way.x = -0.5;"),
        ("SpoolEdge way", "way.x = 0.5;"),
        ("CheckValveDynamic way(x(start = 0.4))", ""),
        ("CheckValveLinear way", ""),
        ("CheckValveLinear way(p_crack = 3e4, G_leak = 0)", ""),
        ("ReliefValveLinear way", ""),
        ("ReliefValveLinear way(p_set = 1e3, w = 1e6)", ""),
        ("ReliefValveDynamic way(x(start = 0.4))", ""),
        ("ReliefValvePoppet way(x(start = 1e-4))", ""),
        ("ProportionalRelief way", "way.u = 0.5;"),
        ("CounterbalanceValve way(x(start = 0.4))", "connect(way.port_x, b.port);"),
        ("PilotCheckValve way(x(start = 0.4))", "connect(way.port_x, a.port);"),
        ("PressureReducer way", ""),
        ("SequenceValve way(x(start = 0.4))", ""),
        ("FlowControlValve way", "way.u = 0.5;"),
        ("Cooler way; Thermal.FixedTemperature bath", "connect(bath.port, way.oilHeat);"),
        ("Valve22 way", "way.u = 1;"),
    ];
    let mut numbers = Numbers(2);
    for (class, command) in classes {
        let mut simulation = circuit(
            &format!(
                "inner Oil.ISOVG46 oil;
                 Hydraulic.{class};
                 Hydraulic.PressureSource a;
                 Hydraulic.PressureSource b;"
            ),
            &format!("connect(a.port, way.port_a); connect(b.port, way.port_b); {command}"),
        );
        simulation.stop_time(1e-6);
        for k in 0..60 {
            let a = 10f64.powf(numbers.between(3.0, 7.5));
            // every third pair is close together, where the corners of the laws are
            let near = (a + numbers.between(-1e5, 1e5)).max(1e3);
            let b = if k % 3 == 0 { near } else { 10f64.powf(numbers.between(3.0, 7.5)) };
            simulation.set("a.p", a).expect("a parameter").set("b.p", b).expect("a parameter");
            let t = run(&simulation);
            let q = -last(&t, "a.port.q");
            let loss = (a - b) * q;
            assert!(loss.is_finite() && loss >= -1e-9, "{class} gives {loss} W from {a} to {b} Pa");
        }
    }
}

#[test]
fn frictions_take_power_in_both_directions() {
    let classes = [
        "Damper way",
        "SmoothBearingFriction way(tau_c = 2, tau_s = 5)",
        "LuGreBearingFriction way(tau_c = 2, tau_s = 5)",
        "BearingFriction way(tau_c = 2, tau_s = 5)",
        "BearingFriction way(useTable = true, tau_pos = [0, 5; 2, 2; 5, 3])",
    ];
    for class in classes {
        // Bristles give back what bends them: at most the square of the force over twice their stiffness.
        let elastic = if class.starts_with("LuGre") { 25.0 / (2.0 * 40.0) } else { 1e-3 };
        let other = if class.starts_with("Damper") { "connect(way.flange_b, housing.flange);" } else { "" };
        let mut simulation = circuit(
            &format!(
                "Mechanical.Rotational.Inertia rotor(J = 0.1, w(start = 5));
                 Mechanical.Rotational.Torque motor;
                 Mechanical.Rotational.{class};
                 Mechanical.Rotational.Fixed housing;
                 Real work(start = 0, fixed = true);"
            ),
            &format!(
                "motor.tau = 6*sin(3*time);
                 connect(motor.flange, rotor.flange_a);
                 connect(rotor.flange_b, way.flange_a);
                 der(work) = way.flange_a.tau*rotor.w;
                 {other}"
            ),
        );
        let t = run(simulation.stop_time(10.0));
        let mut most = 0.0f64;
        for work in column(&t, "work") {
            most = most.max(*work);
            assert!(*work > most - elastic, "{class} gives back {} J", most - work);
        }
        assert!(most > 1.0, "{class}: {most} J");
    }
}

/// Bearings that stick by events and a pump that sticks by bristles hold the sum of both, either way round, and break away
/// above it.
#[test]
fn a_pump_and_its_bearings_hold_the_sum() {
    let mut shaft = circuit(
        "inner Oil.ServoPumpOil oil; parameter Real tau = 0.07;
         Mechanical.Rotational.Torque t; Mechanical.Rotational.Inertia rotor(J = 1.8e-4);
         Mechanical.Rotational.BearingFriction friction(tau_c = 0.01, tau_s = 0.05, w_s = 20, d = 0.2e-4);
         ServoPump.BenchPump pump(compression = false); Hydraulic.Tank tank;",
        "t.tau = tau; connect(t.flange, rotor.flange_a); connect(rotor.flange_b, friction.flange_a);
         connect(friction.flange_b, pump.flange); connect(pump.port_a, tank.port); connect(pump.port_b, tank.port);",
    );
    shaft.stop_time(2.0);
    for tau in [0.03, 0.07, 0.097, -0.07, -0.097] {
        let t = run(shaft.set("tau", tau).expect("a parameter"));
        assert!(last(&t, "rotor.w").abs() < 1e-9, "{tau}: {}", last(&t, "rotor.w"));
        assert!(last(&t, "rotor.phi").abs() < 2e-3, "{tau}: {}", last(&t, "rotor.phi"));
    }
    for tau in [0.105, -0.105] {
        let t = run(shaft.set("tau", tau).expect("a parameter"));
        assert!(last(&t, "rotor.w") * tau.signum() > 100.0, "{tau}: {}", last(&t, "rotor.w"));
    }
}

// --- All examples ---------------------------------------------------------------------------------------------------

fn examples(folder: &Path, root: &Path, out: &mut Vec<String>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("the folder is there").flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            examples(&path, root, out);
        } else if path.to_string_lossy().ends_with("Example.mo") {
            let rest = path.strip_prefix(root).expect("below the root").with_extension("");
            out.push(rest.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join("."));
        }
    }
}

#[test]
fn every_example_runs_to_its_end_with_finite_values() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("components");
    let mut names = Vec::new();
    examples(&root, &root, &mut names);
    assert!(names.len() > 170, "{} examples", names.len());
    let mut bad = Vec::new();
    for name in names {
        match shipped(&name).run() {
            Ok(outcome) => {
                let t = &outcome.trajectory;
                let odd = t.signals.iter().find(|s| column(t, &s.name).iter().any(|x| !x.is_finite()));
                bad.extend(odd.map(|s| format!("{name}: {} is not finite", s.name)));
            }
            Err(e) => bad.push(format!("{name}: {e}")),
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}
