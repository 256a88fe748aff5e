//! Mechanical, electrical and signal components against closed forms.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use rig::{at, circuit, column, last, mean_from, near, run};
use std::f64::consts::PI;

/// Speeds after Willis, torques in proportion, all power that goes in comes out or is lost; whoever drives.
#[test]
fn planetary_gears_obey_willis_and_never_give_power() {
    for (class, eta) in [("IdealPlanetary", 1.0), ("LossyPlanetary", 0.95 * 0.95)] {
        let set = if eta < 1.0 { ", eta_sun = 0.95, eta_ring = 0.95" } else { "" };
        for (w_sun, w_ring, torque) in
            [(50.0, 20.0, 10.0), (50.0, -20.0, -10.0), (-50.0, 20.0, 10.0), (-50.0, 60.0, -10.0)]
        {
            let t = run(circuit(
                &format!(
                    "Mechanical.Rotational.{class} gear(ratio = 3{set});
                    Mechanical.Rotational.ConstantSpeed sun(w_fixed = {w_sun}), ring(w_fixed = {w_ring});
                    Mechanical.Rotational.Torque load;"
                ),
                &format!(
                    "connect(sun.flange, gear.sun); connect(ring.flange, gear.ring); connect(load.flange, gear.carrier);
                    load.tau = {torque};"
                ),
            )
            .stop_time(0.1));
            let w_carrier = (w_sun + 3.0 * w_ring) / 4.0;
            let tau = |flange: &str| last(&t, &format!("gear.{flange}.tau"));
            near(at(&t, "gear.carrier.phi", 0.1) - at(&t, "gear.carrier.phi", 0.05), 0.05 * w_carrier, 1e-6);
            assert!((tau("sun") + tau("ring") + tau("carrier")).abs() < 1e-9);
            let lost = tau("sun") * w_sun + tau("ring") * w_ring + tau("carrier") * w_carrier;
            // what rolls through the meshes, seen from the carrier, loses its part
            let rolling = tau("sun") * (w_sun - w_carrier);
            let ratio = if rolling > 0.0 { eta } else { 1.0 / eta };
            near(tau("ring") / tau("sun"), 3.0 * ratio, 1e-6);
            assert!((lost - rolling * (1.0 - ratio)).abs() < 1e-6 && lost > -1e-9, "{class}: {lost} W");
        }
    }
}

#[test]
fn an_arm_swings_with_its_period_and_a_crank_moves_by_its_kinematics() {
    let t = run(circuit(
        "Mechanical.Rotational.Arm arm(m = 10, l = 1, m_load = 5, rotor(phi(start = -1.5707963267948966 + 0.01, fixed = true), w(fixed = true)));",
        "",
    )
    .stop_time(20.0));
    let (phi, w) = (column(&t, "arm.rotor.phi"), column(&t, "arm.rotor.w"));
    let turns = w.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
    let inertia: f64 = 10.0 / 12.0 + 10.0 * 0.25 + 5.0;
    let period = 2.0 * PI * (inertia / (9.80665 * (5.0 + 5.0))).sqrt();
    // it turns round at half a period, then once a period
    assert_eq!(turns, ((20.0 - period / 2.0) / period) as usize + 1);
    assert!(phi.iter().all(|p| (p + PI / 2.0).abs() < 0.010_01));
    let t = run(circuit(
        "Mechanical.Rotational.Crank crank(r = 0.05, l = 0.2, e = 0.01); Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 20);
        Mechanical.Translational.ConstantForce load(f_constant = -100);",
        "connect(shaft.flange, crank.flangeR); connect(load.flange, crank.flangeT);",
    )
    .stop_time(1.0));
    for time in [0.1, 0.37, 0.9] {
        let phi = at(&t, "crank.phi", time);
        let y: f64 = 0.05 * phi.sin() - 0.01;
        near(at(&t, "crank.flangeT.s", time), 0.05 * phi.cos() + (0.04 - y * y).sqrt(), 1e-6);
        // virtual work
        let way = -0.05 * phi.sin() - 0.05 * phi.cos() * y / (0.04 - y * y).sqrt();
        near(at(&t, "crank.flangeR.tau", time), -way * at(&t, "crank.flangeT.f", time), 1e-5);
    }
}

/// Impacts come back slower the faster they were, and nothing pulls.
#[test]
fn contacts_and_ropes_act_to_one_side_only() {
    let rebound = |v: f64| {
        let t = run(circuit(
            &format!(
                "Mechanical.Translational.Fixed wall; Mechanical.Translational.Contact contact(alpha = 0.05);
                Mechanical.Translational.Mass ball(m = 1, s(start = 0.01, fixed = true), v(start = {}, fixed = true));",
                -v
            ),
            "connect(wall.flange, contact.flange_a); connect(contact.flange_b, ball.flange_a);",
        )
        .stop_time(0.02 / v + 0.01));
        assert!(column(&t, "contact.f_n").iter().all(|f| *f >= 0.0));
        last(&t, "ball.v") / v
    };
    let [slow, fast] = [0.5, 4.0].map(rebound);
    assert!(slow < 1.0 && fast < slow, "{slow} {fast}");
    near(slow, 1.0 - 0.05 * 0.5, 0.005);
    let t = run(circuit(
        "Mechanical.Translational.Fixed ceiling; Mechanical.Translational.Rope rope(c = 1e5, d = 500, l = 1);
        Mechanical.Translational.Mass load(m = 20, s(start = 0.5, fixed = true), v(fixed = true));
        Mechanical.Translational.ConstantForce weight(f_constant = 196.133);",
        "connect(ceiling.flange, rope.flange_a); connect(rope.flange_b, load.flange_a); connect(weight.flange, load.flange_b);",
    )
    .stop_time(5.0));
    assert!(column(&t, "rope.f").iter().all(|f| *f >= 0.0) && column(&t, "rope.lossPower").iter().all(|p| *p >= 0.0));
    near(last(&t, "load.s"), 1.0 + 196.133 / 1e5, 1e-5);
}

#[test]
fn a_battery_answers_a_pulse_as_its_rc_pairs_and_keeps_its_charge() {
    let t = run(circuit(
        "Electrical.Battery battery(twoPairs = true, soc_start = 0.6, ocv = [0, 3.5; 1, 3.5]);
        Electrical.SignalCurrent load; Electrical.Ground ground;",
        "connect(battery.p, load.p); connect(battery.n, load.n); connect(battery.n, ground.p);
        load.i = if time >= 10 and time < 110 then 20 else 0;",
    )
    .stop_time(200.0));
    let part = |r: f64, tau: f64, time: f64| 20.0 * r * (1.0 - (-time / tau).exp());
    let drop = 20.0 * 2e-3 + part(1e-3, 10.0, 50.0) + part(1e-3, 200.0, 50.0);
    near(3.5 - at(&t, "battery.v", 60.0), drop, 1e-4);
    near(0.6 - last(&t, "battery.soc"), 20.0 * 100.0 / 72000.0, 1e-5);
}

/// The mean form against six diodes on three sine voltages, with the drop of commutation.
#[test]
fn the_rectifier_is_the_mean_of_its_diodes() {
    for inductance in [0.5e-3, 3e-3] {
        let t = run(circuit(
            &format!(
                "Electrical.Rectifier mean(U = 400, L = {inductance}); Electrical.Ground ground;
                Electrical.SignalCurrent load;"
            ),
            "connect(mean.p, load.p); connect(mean.n, load.n); connect(mean.n, ground.p); load.i = 20;",
        )
        .stop_time(0.1));
        let wanted = 3.0 * 2.0_f64.sqrt() / PI * 400.0 - 6.0 * 50.0 * inductance * 20.0 - 2.0 * 1e-3 * 20.0;
        near(last(&t, "mean.v"), wanted, 1e-4);
    }
    let t = run(&rig::shipped("Electrical.Examples.DiodeBridgeExample"));
    assert!(mean_from(&t, "bridge.v", 0.5 * t.times[t.len() - 1]) > 400.0);
}

/// At its limit the integral part does not run away: the output leaves the limit as soon as the error turns.
#[test]
fn the_pid_controller_does_not_wind_up() {
    let loop_with = |t_t: f64| {
        let mut simulation = circuit(
            &format!(
                "Signal.PID control(k = 8, T_i = 0.5, T_d = 0, yMax = 1, T_t = {t_t}); Real y(start = 0, fixed = true);"
            ),
            "control.u_s = if time < 0.1 then 0 else 1; control.u_m = y; der(y) = 1.2*control.y - 0.2*y;",
        );
        run(simulation.stop_time(5.0))
    };
    let overshoot = |t_t: f64| column(&loop_with(t_t), "y").iter().copied().fold(0.0, f64::max) - 1.0;
    let (held, free) = (overshoot(0.05), overshoot(1e9));
    assert!(held < 0.01 && free > 0.05, "{held} {free}");
}
