//! The segmented line against the method of characteristics: a water hammer with laminar friction.
//!
//! The characteristics are coded here, on their own grid, from the equations of the line alone: `p + B q` is carried
//! along with the speed of sound and loses what friction takes, by the trapezoidal rule. Source: E. B. Wylie and
//! V. L. Streeter, Fluid Transients in Systems, 1993, chapter 3.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]
#![allow(clippy::print_stdout, reason = "it reports errors and orders")]

use crate::rig;

use rig::{at, circuit, near, run};
use std::f64::consts::PI;

const LENGTH: f64 = 20.0;
const DIAMETER: f64 = 1e-2;
const RHO: f64 = 860.0;
const MODULUS: f64 = 1.4e9;
const MU: f64 = 0.0396;
/// Pressure of the source; the tank is at zero.
const SOURCE: f64 = 50e5;
/// Conductance of the valve, open.
const OPEN: f64 = 1.5e-11;
/// The valve opens from 0 to T and closes from 40 to 40 + T milliseconds, two derivatives continuous.
const MOVE: f64 = 12e-3;
const CLOSING: f64 = 40e-3;
const STOP: f64 = 0.15;

/// Conductance of the valve over time.
fn valve(t: f64) -> f64 {
    let ramp = |t: f64| {
        let x = (t / MOVE).clamp(0.0, 1.0);
        x - (2.0 * PI * x).sin() / (2.0 * PI)
    };
    OPEN * (ramp(t) - ramp(t - CLOSING))
}

/// Pressure at the valve every `dt`, by characteristics on `n` reaches.
fn characteristics(n: usize) -> (f64, Vec<f64>) {
    let area = PI * DIAMETER * DIAMETER / 4.0;
    let c = (MODULUS / RHO).sqrt();
    let dx = LENGTH / n as f64;
    let dt = dx / c;
    let b = RHO * c / area;
    let loss = 128.0 * MU / (PI * DIAMETER.powi(4)) * dx / 2.0;
    let mut p = vec![SOURCE; n + 1];
    let mut q = vec![0.0; n + 1];
    let mut out = vec![p[n]];
    for step in 1..=(STOP / dt) as usize {
        let (old_p, old_q) = (p.clone(), q.clone());
        let forward = |i: usize| old_p[i] + (b - loss) * old_q[i];
        let backward = |i: usize| old_p[i] - (b - loss) * old_q[i];
        for i in 1..n {
            let (plus, minus) = (forward(i - 1), backward(i + 1));
            p[i] = (plus + minus) / 2.0;
            q[i] = (plus - minus) / (2.0 * (b + loss));
        }
        q[0] = (SOURCE - backward(1)) / (b + loss);
        let g = valve(step as f64 * dt);
        p[n] = forward(n - 1) / (1.0 + (b + loss) * g);
        q[n] = g * p[n];
        out.push(p[n]);
    }
    (dt, out)
}

/// The value at a time between two steps.
fn between(trajectory: &(f64, Vec<f64>), time: f64) -> f64 {
    let place = time / trajectory.0;
    let i = (place as usize).min(trajectory.1.len() - 2);
    trajectory.1[i] + (place - i as f64) * (trajectory.1[i + 1] - trajectory.1[i])
}

/// Pressure at the valve from the component, at some times.
fn segmented(n: usize, times: &[f64]) -> Vec<f64> {
    let mut simulation = circuit(
        &format!(
            "model Valve
              Interfaces.HydraulicPort port;
            protected
              function ramp
                input Real t;
                output Real y;
              protected
                Real x;
              algorithm
                x := min(max(t/{MOVE}, 0), 1);
                y := x - sin(2*Modelica.Constants.pi*x)/(2*Modelica.Constants.pi);
              end ramp;
            equation
              port.q = {OPEN}*(ramp(time) - ramp(time - {CLOSING}))*port.p;
            end Valve;
            inner Oil.Fluid oil(rho_0 = {RHO}, mu_ref = {MU},
              redeclare function density = Oil.Compression.constantDensity(beta_0 = {MODULUS}));
            Hydraulic.PressureSource source(p = {SOURCE});
            Hydraulic.Line line(L = {LENGTH}, d = {DIAMETER}, n = {n}, volume_b = true, p_start = {SOURCE});
            Valve valve;"
        ),
        "connect(source.port, line.port_a); connect(line.port_b, valve.port);",
    );
    simulation.stop_time(STOP);
    simulation.settings().interval = STOP / 3000.0;
    simulation.settings().tolerance = 1e-8;
    let t = run(&simulation);
    times.iter().map(|&time| at(&t, "line.port_b.p", time)).collect()
}

fn times() -> Vec<f64> {
    (1..3000).step_by(5).map(|i| STOP * f64::from(i) / 3000.0).collect()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn the_segmented_line_tends_to_the_characteristics_with_second_order() {
    let times = times();
    let sample = |trajectory: (f64, Vec<f64>)| times.iter().map(|&t| between(&trajectory, t)).collect::<Vec<f64>>();
    let (coarse, fine) = (sample(characteristics(2000)), sample(characteristics(8000)));
    let height = fine.iter().copied().fold(0.0, f64::max) - SOURCE;
    // the reference has converged, and the first wave is as deep as the line's impedance says, but for friction
    assert!(rms(&coarse, &fine) < 2e-5 * height, "{}", rms(&coarse, &fine) / height);
    let impedance = RHO * (MODULUS / RHO).sqrt() / (PI * DIAMETER * DIAMETER / 4.0);
    let dip = SOURCE * impedance * OPEN / (1.0 + impedance * OPEN);
    near(SOURCE - between(&characteristics(2000), MOVE), dip, 0.05);
    let counts = [20, 40, 80, 160];
    let errors = counts.map(|n| rms(&segmented(n, &times), &fine) / height);
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    println!("cells {counts:?}: errors {errors:.5?} of the wave, orders {orders:.2?}");
    assert!(orders.iter().all(|o| (1.9..2.1).contains(o)), "{errors:?} {orders:?}");
    assert!(errors[3] < 4e-4, "{errors:?}");
}
