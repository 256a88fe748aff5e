//! Stiff problems on diffsol's BDF method with an exact Jacobian: MODEL TOLERANCE REPEATS, the result as JSON.

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverState, OdeSolverStopReason};
use std::time::Instant;

/// Right side, its Jacobian by rows, initial values, sizes of the unknowns and the end.
struct Problem {
    rate: fn(&[f64], &mut [f64]),
    slopes: fn(&[f64], &mut [f64]),
    start: &'static [f64],
    size: &'static [f64],
    end: f64,
}

fn robertson(y: &[f64], f: &mut [f64]) {
    f[0] = -0.04 * y[0] + 1e4 * y[1] * y[2];
    f[2] = 3e7 * y[1] * y[1];
    f[1] = -f[0] - f[2];
}

fn robertson_slopes(y: &[f64], j: &mut [f64]) {
    j.copy_from_slice(&[-0.04, 1e4 * y[2], 1e4 * y[1], 0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1], 0.0, 6e7 * y[1], 0.0]);
}

fn van_der_pol(y: &[f64], f: &mut [f64]) {
    f[0] = y[1];
    f[1] = ((1.0 - y[0] * y[0]) * y[1] - y[0]) * 1e6;
}

fn van_der_pol_slopes(y: &[f64], j: &mut [f64]) {
    j.copy_from_slice(&[0.0, 1.0, (-2.0 * y[0] * y[1] - 1.0) * 1e6, (1.0 - y[0] * y[0]) * 1e6]);
}

fn hires(y: &[f64], f: &mut [f64]) {
    let pair = 280.0 * y[5] * y[7];
    f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
    f[1] = 1.71 * y[0] - 8.75 * y[1];
    f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
    f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
    f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
    f[5] = -pair + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
    f[6] = pair - 1.81 * y[6];
    f[7] = -pair + 1.81 * y[6];
}

fn hires_slopes(y: &[f64], j: &mut [f64]) {
    const LINEAR: [(usize, usize, f64); 20] = [
        (0, 0, -1.71), (0, 1, 0.43), (0, 2, 8.32), (1, 0, 1.71), (1, 1, -8.75), (2, 2, -10.03), (2, 3, 0.43),
        (2, 4, 0.035), (3, 1, 8.32), (3, 2, 1.71), (3, 3, -1.12), (4, 4, -1.745), (4, 5, 0.43), (4, 6, 0.43),
        (5, 3, 0.69), (5, 4, 1.71), (5, 5, -0.43), (5, 6, 0.69), (6, 6, -1.81), (7, 6, 1.81),
    ];
    j.fill(0.0);
    LINEAR.iter().for_each(|&(i, k, v)| j[8 * i + k] = v);
    for (i, sign) in [(5, -1.0), (6, 1.0), (7, -1.0)] {
        j[8 * i + 5] += sign * 280.0 * y[7];
        j[8 * i + 7] += sign * 280.0 * y[5];
    }
}

const ROBERTSON: Problem =
    Problem { rate: robertson, slopes: robertson_slopes, start: &[1.0, 0.0, 0.0], size: &[1.0, 1e-6, 1.0], end: 40.0 };
const VAN_DER_POL: Problem =
    Problem { rate: van_der_pol, slopes: van_der_pol_slopes, start: &[2.0, 0.0], size: &[1.0, 1.0], end: 2.0 };
const HIRES: Problem = Problem {
    rate: hires,
    slopes: hires_slopes,
    start: &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
    size: &[1e-3, 1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3],
    end: 321.8122,
};

/// Values at the end, and how many steps led there.
fn solve(problem: &Problem, tolerance: f64) -> Result<(Vec<f64>, usize), diffsol::error::DiffsolError> {
    let n = problem.start.len();
    let (rate, slopes, start) = (problem.rate, problem.slopes, problem.start);
    let along = move |y: &[f64], _: &[f64], _: f64, v: &[f64], out: &mut [f64]| {
        let mut j = [0.0; 64];
        slopes(y, &mut j[..n * n]);
        for i in 0..n {
            out[i] = (0..n).map(|k| j[n * i + k] * v[k]).sum();
        }
    };
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol(problem.size.iter().map(|s| s * tolerance).collect::<Vec<f64>>())
        .rhs_implicit(move |y: &[f64], _: &[f64], _: f64, f: &mut [f64]| rate(y, f), along)
        .init(move |_: &[f64], _: f64, y: &mut [f64]| y.copy_from_slice(start), n)
        .build()
        .map(|p| (p, problem.end))?;
    let mut solver = problem.0.bdf::<NalgebraLU<f64>>()?;
    solver.set_stop_time(problem.1)?;
    let mut steps = 0;
    loop {
        steps += 1;
        if let OdeSolverStopReason::TstopReached = solver.step()? {
            let state = solver.state();
            return Ok(((0..n).map(|i| state.y[i]).collect(), steps));
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let problem = match arguments.get(1).map(String::as_str) {
        Some("Robertson") => ROBERTSON,
        Some("VanDerPol") => VAN_DER_POL,
        Some("HiRes") => HIRES,
        _ => std::process::exit(2),
    };
    let tolerance: f64 = arguments.get(2).and_then(|t| t.parse().ok()).unwrap_or(1e-6);
    let repeats: usize = arguments.get(3).and_then(|t| t.parse().ok()).unwrap_or(1);
    for _ in 0..repeats {
        let begun = Instant::now();
        match solve(&problem, tolerance) {
            Ok((y, steps)) => {
                println!("{{\"solve_s\": {:e}, \"steps\": {steps}, \"y\": {y:?}}}", begun.elapsed().as_secs_f64());
            }
            Err(why) => {
                eprintln!("{why}");
                std::process::exit(1);
            }
        }
    }
}
