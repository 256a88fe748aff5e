//! Writes a linear model as text for people, JSON, CSV, MATLAB `.mat` and Modelica.
//!
//! A [`StateSpace`] enters; texts or bytes leave, which the command writes. Poles and zeros are computed here.

use super::{Pole, Quantity, StateSpace, poles, zeros};
use crate::steady::moving;
use bramah_results::mat::write_matrix;
use bramah_results::number::{rounded, text};
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::fmt::Write;

impl StateSpace {
    /// The whole model as JSON, with poles and the zeros of all pairs of input and output.
    pub fn json(&self) -> Value {
        let quantity = |q: &Quantity| json!({"name": q.name, "unit": q.unit, "value": q.value});
        let list = |q: &[Quantity]| q.iter().map(quantity).collect::<Vec<_>>();
        let rows = |m: &DMatrix<f64>| m.row_iter().map(|r| r.iter().copied().collect::<Vec<f64>>()).collect::<Vec<_>>();
        let pole = |p: &Pole| {
            let shares: Vec<Value> = p
                .participation
                .iter()
                .map(|&(k, share)| json!({"state": self.states[k].name, "share": share}))
                .collect();
            json!({"re": p.re, "im": p.im, "frequency": p.frequency, "damping": p.damping, "states": shares, "together": p.together})
        };
        json!({
            "class": self.class,
            "time": self.time,
            "states": list(&self.states),
            "inputs": list(&self.inputs),
            "outputs": list(&self.outputs),
            "rates": self.rates,
            "A": rows(&self.a),
            "B": rows(&self.b),
            "C": rows(&self.c),
            "D": rows(&self.d),
            "poles": poles(self).iter().map(pole).collect::<Vec<_>>(),
            "zeros": self.all_zeros(),
        })
    }

    /// For each pair of input and output its zeros.
    fn all_zeros(&self) -> Vec<Value> {
        let pairs = (0..self.outputs.len()).flat_map(|o| (0..self.inputs.len()).map(move |i| (i, o)));
        pairs
            .map(|(i, o)| {
                let found: Vec<Value> = zeros(self, i, o).iter().map(|z| json!({"re": z.re, "im": z.im})).collect();
                json!({"input": self.inputs[i].name, "output": self.outputs[o].name, "zeros": found})
            })
            .collect()
    }
}

/// A table of poles with participating states, and a list of zeros.
pub fn words(model: &StateSpace) -> String {
    let mut out = format!("{} at {} s", model.class, rounded(model.time, 9));
    let _ = writeln!(
        out,
        ": {} states, {} inputs, {} outputs",
        model.states.len(),
        model.inputs.len(),
        model.outputs.len()
    );
    // `moving` distinguishes a steady state, one at constant rates, and none.
    let nominals: Vec<f64> = model.states.iter().map(|s| s.nominal).collect();
    match moving(&model.a, &model.rates, &nominals) {
        None => out.push_str("not a steady state: rates are not zero\n"),
        Some(places) if places.is_empty() => {}
        Some(places) => {
            let names: Vec<&str> = places.iter().map(|&k| model.states[k].name.as_str()).collect();
            let _ = writeln!(out, "steady in motion, at constant rates: {}", names.join(", "));
        }
    }
    let _ = writeln!(out, "{:>14} {:>14} {:>12} {:>9}  states", "re 1/s", "im 1/s", "f Hz", "damping");
    let poles = poles(model);
    for (k, p) in poles.iter().enumerate() {
        let same = |o: &&Pole| (o.re, o.im, &o.participation) == (p.re, p.im, &p.participation);
        // Coinciding poles are one line with their number.
        if p.together > 1 && poles[..k].iter().any(|o| same(&o)) {
            continue;
        }
        let together = if p.together > 1 { format!(" ({} poles)", p.together) } else { String::new() };
        let shares: Vec<String> = p
            .participation
            .iter()
            .take(4)
            .map(|&(k, s)| format!("{} {} %", model.states[k].name, rounded(100.0 * s, 2)))
            .collect();
        let _ = writeln!(
            out,
            "{:>14} {:>14} {:>12} {:>9}  {}{together}",
            rounded(p.re, 6),
            rounded(p.im, 6),
            rounded(p.frequency, 5),
            rounded(p.damping, 4),
            shares.join(", ")
        );
    }
    for (o, output) in model.outputs.iter().enumerate() {
        for (i, input) in model.inputs.iter().enumerate() {
            let found = zeros(model, i, o);
            if !found.is_empty() {
                let list: Vec<String> = found.iter().map(|z| complex(z.re, z.im)).collect();
                let _ = writeln!(out, "zeros from {} to {}: {}", input.name, output.name, list.join(", "));
            }
        }
    }
    out
}

/// A complex number, which for an imaginary part stands for the conjugate pair.
fn complex(re: f64, im: f64) -> String {
    if im == 0.0 { rounded(re, 6) } else { format!("{} +- {}i", rounded(re, 6), rounded(im, 6)) }
}

/// One line for each nonzero entry: matrix, row, column (from 1), names of both, value.
pub fn csv(model: &StateSpace) -> String {
    let mut out = String::from("matrix,row,column,row_name,column_name,value\n");
    let mut part = |name: &str, m: &DMatrix<f64>, rows: &[Quantity], columns: &[Quantity]| {
        for i in 0..m.nrows() {
            for j in 0..m.ncols() {
                if m[(i, j)] != 0.0 {
                    let names = format!("\"{}\",\"{}\"", rows[i].name, columns[j].name);
                    let _ = writeln!(out, "{name},{},{},{names},{}", i + 1, j + 1, text(m[(i, j)]));
                }
            }
        }
    };
    part("A", &model.a, &model.states, &model.states);
    part("B", &model.b, &model.states, &model.inputs);
    part("C", &model.c, &model.outputs, &model.states);
    part("D", &model.d, &model.outputs, &model.inputs);
    out
}

/// A MATLAB file of version 4 with the matrices `A`, `B`, `C`, `D` and the operating point `x0`, `u0`, `y0`.
pub fn mat(model: &StateSpace) -> Vec<u8> {
    let mut out = Vec::new();
    let mut put = |name: &str, rows: usize, values: &[f64]| {
        write_matrix(&mut out, name, rows, values).expect("writing to memory cannot fail");
    };
    for (name, m) in [("A", &model.a), ("B", &model.b), ("C", &model.c), ("D", &model.d)] {
        // nalgebra and MATLAB both store by columns.
        put(name, m.nrows(), m.as_slice());
    }
    for (name, list) in [("x0", &model.states), ("u0", &model.inputs), ("y0", &model.outputs)] {
        let values: Vec<f64> = list.iter().map(|q| q.value).collect();
        put(name, values.len(), &values);
    }
    out
}

/// A Modelica model of the given name. Inputs, states and outputs are the quantities themselves, not deviations.
pub fn modelica(model: &StateSpace, name: &str) -> String {
    let mut out = format!("model {name} \"{} near {} s\"\n", model.class, text(model.time));
    let vector = |list: &[Quantity]| {
        let all: Vec<String> = list.iter().map(|q| text(q.value)).collect();
        format!("{{{}}}", all.join(", "))
    };
    let matrix = |m: &DMatrix<f64>| {
        let rows: Vec<String> =
            m.row_iter().map(|r| r.iter().map(|v| text(*v)).collect::<Vec<_>>().join(", ")).collect();
        format!("[{}]", rows.join("; "))
    };
    let (n, m, p) = (model.states.len(), model.inputs.len(), model.outputs.len());
    for (i, s) in model.states.iter().enumerate() {
        let _ = writeln!(out, "  // x[{}]: {}", i + 1, s.words());
    }
    for (letter, size, list) in [("x", n, &model.states), ("u", m, &model.inputs), ("y", p, &model.outputs)] {
        if size > 0 {
            let _ = writeln!(out, "  parameter Real {letter}_0[{size}] = {};", vector(list));
        }
    }
    // Modelica has no literal for an empty matrix, so matrices without entries are left out.
    for (letter, rows, columns, value) in
        [("A", n, n, &model.a), ("B", n, m, &model.b), ("C", p, n, &model.c), ("D", p, m, &model.d)]
    {
        if rows > 0 && columns > 0 {
            let _ = writeln!(out, "  parameter Real {letter}[{rows}, {columns}] = {};", matrix(value));
        }
    }
    // Away from a steady state the deviation starts with the rates of the operating point.
    let rates: Vec<String> = model.rates.iter().map(|v| text(*v)).collect();
    let _ = writeln!(out, "  parameter Real rate_0[{n}] = {{{}}};", rates.join(", "));
    let _ = writeln!(out, "  Real x[{n}](start = x_0, each fixed = true);");
    for (i, q) in model.inputs.iter().enumerate() {
        let _ = writeln!(out, "  input Real u_{}(start = {}) \"{}\";", i + 1, text(q.value), q.words());
    }
    for (i, q) in model.outputs.iter().enumerate() {
        let _ = writeln!(out, "  output Real y_{} \"{}\";", i + 1, q.words());
    }
    let inputs = (1..=m).map(|i| format!("u_{i} - u_0[{i}]")).collect::<Vec<_>>().join(", ");
    let forced = |letter: &str| if m > 0 { format!(" + {letter}*{{{inputs}}}") } else { String::new() };
    let _ = writeln!(out, "equation\n  der(x) = rate_0 + A*(x - x_0){};", forced("B"));
    for i in 1..=p {
        let direct = if m > 0 { format!(" + D[{i}, :]*{{{inputs}}}") } else { String::new() };
        let _ = writeln!(out, "  y_{i} = y_0[{i}] + C[{i}, :]*(x - x_0){direct};");
    }
    let _ = writeln!(out, "end {name};");
    out
}
