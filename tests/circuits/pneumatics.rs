//! Pneumatics against closed forms: ISO 6358, filling and emptying, adiabatic compression, balances.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use rig::{circuit, column, last, near, run};

const KAPPA: f64 = 1.4;
const R_S: f64 = 288.0;
const T_0: f64 = 293.15;

/// Mass flow of an orifice of 1e-8 m3/(s.Pa) between two reservoirs.
fn flow(p_a: f64, p_b: f64, t_a: f64) -> f64 {
    let simulation = circuit(
        &format!(
            "inner Pneumatic.Gas gas;
            Pneumatic.Reservoir a(p = {p_a}, T = {t_a}), b(p = {p_b}, T = {t_a});
            Pneumatic.Orifice orifice(C = 1e-8, b = 0.3);"
        ),
        "connect(a.port, orifice.port_a); connect(orifice.port_b, b.port);",
    );
    last(&run(&simulation), "orifice.m_flow")
}

#[test]
fn the_flow_is_that_of_iso_6358_choked_and_not_both_ways() {
    let rho_0 = 1e5 / (R_S * T_0);
    for (p_1, p_2, t) in [(7e5, 1e5, T_0), (7e5, 1.6e5, 323.15), (7e5, 4e5, T_0), (7e5, 6e5, 323.15), (2e5, 1.9e5, T_0)]
    {
        let r: f64 = p_2 / p_1;
        let choked = 1e-8 * rho_0 * p_1 * (T_0 / t).sqrt();
        let wanted = if r <= 0.3 { choked } else { choked * (1.0 - ((r - 0.3) / 0.7).powi(2)).sqrt() };
        let found = flow(p_1, p_2, t);
        near(found, wanted, 1e-3);
        near(flow(p_2, p_1, t), -found, 1e-9);
    }
    // laminar where nothing flows: in proportion to a small drop
    near(flow(1e5 + 10.0, 1e5, T_0), 10.0 * flow(1e5 + 1.0, 1e5, T_0), 0.05);
}

/// An adiabatic volume filled from a supply and emptied: gas that comes in brings `c_p T`, what stays expands without heat.
#[test]
fn filling_heats_and_emptying_cools() {
    let simulation = |set: &str, p: f64| {
        let mut s = circuit(
            &format!(
                "inner Pneumatic.Gas gas;
                Pneumatic.Reservoir supply(p = {p});
                Pneumatic.Orifice orifice(C = 1e-8);
                Pneumatic.Volume volume(V = 1e-3{set});"
            ),
            "connect(supply.port, orifice.port_a); connect(orifice.port_b, volume.port);",
        );
        s.stop_time(5.0);
        s.settings().tolerance = 1e-8;
        run(&s)
    };
    let filled = simulation(", p_start = 1e5", 7e5);
    near(last(&filled, "volume.p"), 7e5, 1e-6);
    // T_2 = kappa T_0 / (1 + (kappa - 1) p_1/p_2), for gas that was at T_0 as well
    near(last(&filled, "volume.T"), KAPPA * T_0 / (1.0 + (KAPPA - 1.0) / 7.0), 1e-4);
    let emptied = simulation(", p_start = 7e5", 1e5);
    near(last(&emptied, "volume.T"), T_0 * 7.0_f64.powf((1.0 - KAPPA) / KAPPA), 1e-3);
    let cold = simulation(", p_start = 1e5, G = 1e6", 7e5);
    assert!(column(&cold, "volume.T").iter().all(|t| (t - T_0).abs() < 0.01), "isothermal by its wall");
}

#[test]
fn a_piston_compresses_adiabatically_and_its_work_is_in_the_gas() {
    let mut s = circuit(
        "inner Pneumatic.Gas gas;
        Pneumatic.Chamber chamber(A = 1e-3, V_0 = 2e-5, s_0 = 0);
        Pneumatic.Plug plug;
        Mechanical.Translational.Position piston;
        Real work(start = 0, fixed = true), energy = chamber.U;",
        "connect(chamber.port, plug.port); connect(piston.flange, chamber.flange);
        piston.s_ref = 0.06 + 0.04*cos(6.283185307179586*time);
        der(work) = -(piston.flange.f + 100)*der(piston.s_ref);",
    );
    s.stop_time(2.0);
    s.settings().tolerance = 1e-9;
    let t = run(&s);
    let invariant: Vec<f64> =
        column(&t, "chamber.p").iter().zip(column(&t, "chamber.V")).map(|(p, v)| p * v.powf(KAPPA)).collect();
    let spread = invariant.iter().fold(0.0_f64, |m, x| m.max((x / invariant[0] - 1.0).abs()));
    assert!(spread < 1e-5, "{spread}");
    // what the piston gives against the surroundings is what the gas holds
    let gained = column(&t, "energy").iter().map(|u| u - column(&t, "energy")[0]);
    let off = gained.zip(column(&t, "work")).map(|(u, w)| (u - w).abs()).fold(0.0, f64::max);
    assert!(off < 1e-4, "{off} J");
}

#[test]
fn a_closed_circuit_keeps_its_mass_and_energy() {
    let mut s = circuit(
        "inner Pneumatic.Gas gas;
        Pneumatic.Volume a(V = 1e-3, p_start = 7e5), b(V = 2e-3, p_start = 1e5), c(V = 5e-4, p_start = 3e5, T_start = 350);
        Pneumatic.Orifice ab(C = 1e-8), bc(C = 2e-9), ca(C = 5e-9);",
        "connect(a.port, ab.port_a); connect(ab.port_b, b.port); connect(b.port, bc.port_a);
        connect(bc.port_b, c.port); connect(c.port, ca.port_a); connect(ca.port_b, a.port);",
    );
    s.stop_time(20.0);
    s.settings().tolerance = 1e-8;
    let t = run(&s);
    let sum =
        |what: &str, row: usize| ["a", "b", "c"].iter().map(|v| column(&t, &format!("{v}.{what}"))[row]).sum::<f64>();
    let end = t.len() - 1;
    near(sum("mass", end), sum("mass", 0), 1e-7);
    // each restriction holds a milligram of gas
    near(sum("U", end), sum("U", 0), 1e-3);
    for v in ["b", "c"] {
        near(last(&t, &format!("{v}.p")), last(&t, "a.p"), 1e-4);
    }
}
