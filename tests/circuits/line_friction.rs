//! Friction that grows with the frequency, against the transfer function of laminar flow in a pipe.
//!
//! A pipe closed at its far end swings with the pressure at its near end: `p_b/p_a = 1/cosh(L sqrt(Z Y))`, where
//! `Y = i w A/beta` and `Z = i w rho/A/(1 - 2 J_1(z)/(z J_0(z)))` with `z = R sqrt(-i w/nu)`. Source: A. F. D'Souza and
//! R. Oldenburger, J. Basic Eng. 86 (1964) 589.

#![cfg(feature = "analysis")]
#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use nalgebra::Complex;
use rig::{circuit, column, run};
use std::f64::consts::PI;

type C = Complex<f64>;

const LENGTH: f64 = 20.0;
const DIAMETER: f64 = 1e-2;
const RHO: f64 = 860.0;
const MODULUS: f64 = 1.4e9;
const MU: f64 = 0.0396;

/// `J_n(z)` by its power series, for arguments of moderate size.
fn bessel(n: i32, z: C) -> C {
    let mut term = (z / 2.0).powi(n);
    let mut sum = C::new(0.0, 0.0);
    for k in 0..200 {
        sum += term;
        term *= -(z / 2.0).powi(2) / f64::from((k + 1) * (k + 1 + n));
    }
    sum
}

/// Pressure at the closed end over that at the open one; with friction of the past, or quasi-steady.
fn transfer(f: f64, past: bool) -> C {
    let s = C::new(0.0, 2.0 * PI * f);
    let area = PI * DIAMETER.powi(2) / 4.0;
    let impedance = if past {
        let z = (-s * RHO / MU).sqrt() * (DIAMETER / 2.0);
        s * RHO / area / (C::new(1.0, 0.0) - 2.0 * bessel(1, z) / (z * bessel(0, z)))
    } else {
        s * RHO / area + 128.0 * MU / (PI * DIAMETER.powi(4))
    };
    C::new(1.0, 0.0) / ((impedance * s * area / MODULUS).sqrt() * LENGTH).cosh()
}

/// The same from the component, once the start has died away.
fn simulated(f: f64, friction: &str) -> C {
    let mut simulation = circuit(
        &format!(
            "inner Oil.Fluid oil(rho_0 = {RHO}, mu_ref = {MU},
               redeclare function density = Oil.Compression.constantDensity(beta_0 = {MODULUS}));
             Hydraulic.PressureSource source(useInput = true);
             Hydraulic.Line line(redeclare model Friction = Hydraulic.LineFriction.{friction},
               L = {LENGTH}, d = {DIAMETER}, n = 40, volume_b = true, p_start = 1e6);
             Signal.Sine sine(amplitude = 1e4, f = {f}, offset = 1e6);
             Hydraulic.Plug plug;"
        ),
        "connect(source.port, line.port_a); connect(line.port_b, plug.port); connect(sine.y, source.p_in);",
    );
    let periods = (1.5 * f).ceil().max(4.0);
    simulation.stop_time((periods + 2.0) / f);
    simulation.settings().interval = 1.0 / (200.0 * f);
    simulation.settings().tolerance = 1e-8;
    let t = run(&simulation);
    let first = t.times.partition_point(|&time| time < periods / f - 1e-9);
    let part = |i: usize| {
        let turn = C::new(0.0, -2.0 * PI * f * t.times[i]).exp();
        (column(&t, "line.port_b.p")[i] - 1e6) * turn
    };
    // p = Im(P exp(i w t)), so that the mean of p exp(-i w t) over whole periods is P/(2 i)
    let mean = (first..t.len() - 1).map(part).sum::<C>() / (t.len() - 1 - first) as f64;
    mean * C::new(0.0, 2.0) / 1e4
}

/// Below, at and above the first resonance, and at the second.
#[test]
fn the_closed_line_swings_as_laminar_theory_says() {
    let quarter = (MODULUS / RHO).sqrt() / (4.0 * LENGTH);
    for f in [0.5 * quarter, 0.93 * quarter, 1.2 * quarter, 2.8 * quarter] {
        let theory = transfer(f, true);
        for (terms, within) in [(4, 0.03), (6, 0.02), (10, 0.02)] {
            let found = simulated(f, &format!("Unsteady(k = {terms})"));
            let off = (found - theory).norm() / theory.norm();
            assert!(off < within, "{f} Hz, {terms} terms: {found} instead of {theory}, {off:.4} off");
        }
    }
    // quasi-steady friction swings too far there
    let (past, steady) = (transfer(0.93 * quarter, true).norm(), simulated(0.93 * quarter, "Steady"));
    assert!((steady - transfer(0.93 * quarter, false)).norm() < 0.02 * steady.norm(), "{steady}");
    assert!(steady.norm() > 1.15 * past, "{steady} {past}");
}
