//! Inverters and current control: the switching form against its mean, limits, quadrants, energy.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

mod rig;

use bramah::results::Trajectory;
use rig::{at, circuit, column, near, run, shipped};

const FORMS: [&str; 2] = ["AveragedInverter", "SwitchingInverter"];

/// A motor at constant speed on an inverter with constant commands; integrals of what flows, for exact means.
fn open_loop(form: &str, inverter: &str, w: f64, u: (f64, f64), stop: f64) -> Trajectory {
    let mut simulation = circuit(
        &format!(
            "Electrical.Machines.PMSM motor;
            Electrical.Drives.{form} inverter(p = motor.p{inverter});
            Electrical.ConstantVoltage supply(V = 540);
            Electrical.Ground ground;
            Mechanical.Rotational.ConstantSpeed shaft(w_fixed = {w});
            Real D(start = 0, fixed = true); Real Q(start = 0, fixed = true); Real T(start = 0, fixed = true);
            Real E(start = 0, fixed = true); Real U(start = 0, fixed = true); Real L(start = 0, fixed = true);
            Real C(start = 0, fixed = true);"
        ),
        &format!(
            "inverter.u_d = {}; inverter.u_q = {};
            connect(inverter.v_d, motor.u_d); connect(inverter.v_q, motor.u_q);
            connect(motor.i_d, inverter.i_d); connect(motor.i_q, inverter.i_q);
            inverter.phi = motor.flange.phi; inverter.w = motor.w;
            connect(supply.p, inverter.dc_p); connect(supply.n, inverter.dc_n); connect(supply.n, ground.p);
            connect(shaft.flange, motor.flange);
            der(D) = motor.i_d; der(Q) = motor.i_q; der(T) = motor.T_e; der(E) = 540*inverter.i_dc;
            der(U) = motor.u_q; der(L) = inverter.lossPower; der(C) = motor.P_cu;",
            u.0, u.1
        ),
    );
    simulation.stop_time(stop);
    simulation.settings().tolerance = 1e-7;
    run(&simulation)
}

/// The mean of what an integral grew by.
fn mean(t: &Trajectory, integral: &str, from: f64, to: f64) -> f64 {
    (at(t, integral, to) - at(t, integral, from)) / (to - from)
}

/// 100 Hz electrically: whole periods fit into the windows.
const W: f64 = 2.0 * std::f64::consts::PI * 100.0 / 8.0;

#[test]
fn the_mean_of_the_switches_is_the_averaged_inverter() {
    let [mean_form, switches] = FORMS.map(|form| open_loop(form, "", W, (-6.0, 58.0), 0.04));
    for integral in ["D", "Q", "T", "E", "U"] {
        let (a, b) = (mean(&mean_form, integral, 0.02, 0.04), mean(&switches, integral, 0.02, 0.04));
        assert!((a - b).abs() < 2e-3 * a.abs(), "{integral}: averaged {a}, switching {b}");
    }
}

#[test]
fn dead_time_and_drops_take_from_both_the_same() {
    let set = ", real = true, f_s = 32e3, T_d = 0.3e-6, V_f = 1, R_on = 0.02";
    let [ideal, averaged, switches] = [("AveragedInverter", ""), (FORMS[0], set), (FORMS[1], set)]
        .map(|(form, set)| open_loop(form, set, W, (-11.8, 70.0), 0.04));
    let of = |t: &Trajectory, i: &str| mean(t, i, 0.02, 0.04);
    // what is lost to the command is large, and both forms agree on it
    let (without, a, b) = (of(&ideal, "Q"), of(&averaged, "Q"), of(&switches, "Q"));
    assert!(a < 0.9 * without, "{a} of {without}");
    assert!((a - b).abs() < 0.02 * (without - a), "averaged {a}, switching {b}, ideal {without}");
    near(of(&switches, "L"), of(&averaged, "L"), 0.02);
}

#[test]
fn power_is_conserved_by_every_form_and_losses_are_positive() {
    for form in FORMS {
        for (w, u) in [(W, (-6.0, 62.0)), (W, (4.0, 40.0)), (-W, (-6.0, -62.0)), (-W, (4.0, -40.0))] {
            let t = open_loop(form, ", real = true, V_f = 1, R_on = 0.02", w, u, 0.04);
            let of = |i: &str| mean(&t, i, 0.02, 0.04);
            let (dc, shaft, loss, copper) = (of("E"), of("T") * w, of("L"), of("C"));
            assert!(loss > 0.0 && copper > 0.0, "{form} {w} {u:?}: {loss} {copper}");
            // the magnetic energy at both ends of the window is the same but for the ripple
            assert!((dc - shaft - loss - copper).abs() < 2e-3 * dc.abs().max(shaft.abs()), "{form} {w} {u:?}");
            assert_eq!(dc > 0.0, u.1.abs() > 50.0, "{form} {w} {u:?}: it drives or brakes");
        }
    }
}

/// A servo motor at constant speed with one of each form.
fn servo(control: &str, inverter: &str, w: f64, torque: &str, stop: f64) -> Trajectory {
    let mut simulation = circuit(
        &format!(
            "Electrical.Drives.ServoMotor motor(T_max = 60,
                redeclare Electrical.Drives.{control} control, redeclare Electrical.Drives.{inverter} inverter);
            Mechanical.Rotational.ConstantSpeed shaft(w_fixed = {w});
            Real T(start = 0, fixed = true);"
        ),
        &format!("motor.T_ref = {torque}; connect(shaft.flange, motor.flange); der(T) = motor.T_e;"),
    );
    simulation.stop_time(stop);
    run(&simulation)
}

const DRIVES: [(&str, &str); 4] = [
    ("ContinuousCurrentControl", "AveragedInverter"),
    ("SampledCurrentControl", "AveragedInverter"),
    ("ContinuousCurrentControl", "SwitchingInverter"),
    ("SampledCurrentControl", "SwitchingInverter"),
];

#[test]
fn torque_follows_its_command_in_all_four_quadrants() {
    for (control, inverter) in DRIVES {
        for (w, torque) in [(200.0, 6.0), (200.0, -6.0), (-200.0, 6.0), (-200.0, -6.0)] {
            let t = servo(control, inverter, w, &format!("{torque}"), 0.03);
            let found = mean(&t, "T", 0.02, 0.03);
            assert!((found - torque).abs() < 0.02 * 6.0, "{control}, {inverter}, {w}: {found} for {torque}");
        }
    }
}

#[test]
fn the_voltage_ends_at_the_circle_and_the_integral_part_does_not_run_away() {
    // At 470 rad/s the magnets alone need 301 of 312 V: 39 Nm are left of the 55 asked for.
    for (control, inverter) in DRIVES {
        let t = servo(control, inverter, 470.0, "if time < 0.03 then 55 else 1", 0.06);
        let u = column(&t, "motor.control.u_d").iter().zip(column(&t, "motor.control.u_q"));
        let longest = u.map(|(d, q)| (d * d + q * q).sqrt()).fold(0.0, f64::max);
        assert!(longest <= 540.0 / 3.0f64.sqrt() * (1.0 + 1e-9), "{control}: {longest}");
        let (limited, free) = (mean(&t, "T", 0.02, 0.03), mean(&t, "T", 0.04, 0.06));
        assert!((25.0..42.0).contains(&limited), "{control}, {inverter}: {limited}");
        // 10 ms after the command has become possible, the torque has been there for a while
        assert!((free - 1.0).abs() < 0.06, "{control}, {inverter}: {free}");
    }
}

#[test]
fn sampling_delays_the_current_but_does_not_make_it_ring() {
    let [continuous, sampled] = ["ContinuousCurrentControl", "SampledCurrentControl"]
        .map(|c| servo(c, "AveragedInverter", 50.0, "if time < 0.02 then 0 else 3", 0.03));
    for (time, tolerance) in [(0.0205, 0.15), (0.022, 0.01)] {
        let (a, b) = (at(&continuous, "motor.T_e", time), at(&sampled, "motor.T_e", time));
        assert!((a - b).abs() < tolerance * 3.0, "{time}: {a} and {b}");
    }
    let top = column(&sampled, "motor.T_e").iter().copied().fold(0.0, f64::max);
    assert!(top < 1.05 * 3.0, "it overshoots to {top}");
}

/// Signals of the examples, and the number of events, which is what they cost.
#[test]
fn examples_are_what_they_were() {
    let sampled = shipped("Electrical.Examples.SampledCurrentControlExample");
    let continuous = shipped("Electrical.Examples.PMSMExample");
    let (a, b) = (run(&sampled), run(&continuous));
    for time in [0.05, 0.15, 0.25, 0.45] {
        let (sampled, continuous) = (at(&a, "rotor.w", time), at(&b, "rotor.w", time));
        assert!((sampled - continuous).abs() < 4.0, "{time}: {sampled} and {continuous}");
    }
    let switching = shipped("Electrical.Examples.SwitchingInverterExample");
    let outcome = switching.run().unwrap_or_else(|e| panic!("{e}"));
    // 320 carrier periods of 20 ms: two samples and six edges each, up to six of them delayed
    let events = outcome.statistics.events;
    assert!((2500..4600).contains(&events), "{events} events");
    let averaged = run(&shipped("Electrical.Examples.AveragedInverterExample"));
    let difference = at(&outcome.trajectory, "rotor.w", 0.0099) - at(&averaged, "rotor.w", 0.0099);
    assert!(difference.abs() < 10.0, "{difference} rad/s");
}

#[test]
fn a_braking_motor_charges_its_link_by_what_the_rotor_loses() {
    let t = run(&shipped("Electrical.Examples.ExternalSupplyExample"));
    let energy = |time: f64| {
        let (v, w) = (at(&t, "link.v", time), at(&t, "rotor.w", time));
        (0.5e-3 * v * v, 0.5 * 5e-3 * w * w)
    };
    let ((link_0, rotor_0), (link_1, rotor_1)) = (energy(0.21), energy(0.39));
    let copper = 1.5 * 0.176 * (6.0f64 / 0.96).powi(2) * 0.18;
    near(link_1 - link_0, rotor_0 - rotor_1 - copper, 0.01);
}
