//! Files of a quasi-linear form: a Modelica model that simulates, a MATLAB file.

use super::Quantity;
use super::schedule::{Point, Schedule};
use crate::results::mat::write_matrix;
use crate::results::number::text;
use nalgebra::DMatrix;
use std::fmt::Write as _;

/// A MATLAB file of version 4: `rho` with a row for each point of the grid, `A` and `B` of all points side by side (those of
/// point k are `A(:, (k-1)*n+1 : k*n)` and `B(:, (k-1)*m+1 : k*m)`, the last column of `B` being that of the constant
/// input 1), and the operating point `x0`, `u0`.
pub fn mat(form: &Schedule) -> Vec<u8> {
    let mut out = Vec::new();
    let mut put = |name: &str, rows: usize, values: &[f64]| {
        write_matrix(&mut out, name, rows, values).expect("writing to memory cannot fail");
    };
    let rho: Vec<f64> = (0..form.rho.len()).flat_map(|k| form.points.iter().map(move |p| p.rho[k])).collect();
    put("rho", form.points.len(), &rho);
    let n = form.states.len();
    let side_by_side = |of: &dyn Fn(&Point) -> &DMatrix<f64>| -> Vec<f64> {
        form.points.iter().flat_map(|p| of(p).as_slice().to_vec()).collect()
    };
    put("A", n, &side_by_side(&|p| &p.a));
    put("B", n, &side_by_side(&|p| &p.b));
    for (name, list) in [("x0", &form.states), ("u0", &form.inputs)] {
        let values: Vec<f64> = list.iter().map(|q| q.value).collect();
        put(name, values.len(), &values);
    }
    out
}

/// A Modelica model: states and inputs are the quantities themselves, the matrices are interpolated between the points
/// of the grid, linearly in each scheduling quantity, and go on beyond its ends.
pub fn modelica(form: &Schedule, name: &str) -> String {
    let entries = entries(form);
    let mut out = format!("model {name} \"{}, quasi-linear over ({})\"\n", form.class, form.rho.join(", "));
    out += &matrices(form, &entries);
    for (i, q) in form.states.iter().enumerate() {
        let _ = writeln!(out, "  Real x_{}(start = {}, fixed = true) \"{}\";", i + 1, text(q.value), described(q));
    }
    for (j, q) in form.inputs.iter().enumerate() {
        let _ = writeln!(out, "  input Real u_{}(start = {}) \"{}\";", j + 1, text(q.value), described(q));
    }
    for (k, rho) in form.rho.iter().enumerate() {
        let _ = writeln!(out, "  Real rho_{} \"{rho}\";", k + 1);
    }
    let _ = writeln!(
        out,
        "protected\n  Real e[{}] \"Entries of the matrices that are not 0\";\nequation",
        entries.len().max(1)
    );
    for (k, leg) in form.legs.iter().enumerate() {
        let of = form.symbol(leg.column);
        let _ = writeln!(out, "  rho_{} = {}*({of} - ({}));", k + 1, text(leg.factor), text(leg.origin));
    }
    let rho: Vec<String> = (1..=form.rho.len()).map(|k| format!("rho_{k}")).collect();
    let _ = writeln!(out, "  e = matrices({{{}}});", rho.join(", "));
    for i in 0..form.states.len() {
        let terms: Vec<String> = entries
            .iter()
            .enumerate()
            .filter(|(_, (row, _))| *row == i)
            .map(|(k, (_, column))| format!("e[{}]*{}", k + 1, form.symbol(*column)))
            .collect();
        let sum = if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") };
        let _ = writeln!(out, "  der(x_{}) = {sum};", i + 1);
    }
    let _ = writeln!(out, "end {name};");
    out
}

/// Rows and columns of (A, B) that hold something at a point.
fn entries(form: &Schedule) -> Vec<(usize, usize)> {
    let columns = form.states.len() + form.inputs.len() + 1;
    let all = (0..form.states.len()).flat_map(|i| (0..columns).map(move |j| (i, j)));
    all.filter(|&(i, j)| form.points.iter().any(|p| entry(p, i, j) != 0.0)).collect()
}

fn entry(point: &Point, i: usize, j: usize) -> f64 {
    let n = point.a.ncols();
    if j < n { point.a[(i, j)] } else { point.b[(i, j - n)] }
}

/// The function that interpolates the entries.
fn matrices(form: &Schedule, entries: &[(usize, usize)]) -> String {
    let grid = grid(form);
    let (d, k) = (grid.len(), entries.len().max(1));
    let mut out = format!(
        "  function matrices \"Entries of A and B between the points of the grid\"\n    input Real rho[{d}];\n    output Real e[{k}];\n  protected\n"
    );
    for (at, values) in grid.iter().enumerate() {
        let list: Vec<String> = values.iter().map(|v| text(*v)).collect();
        let _ = writeln!(out, "    constant Real grid_{}[{}] = {{{}}};", at + 1, values.len(), list.join(", "));
    }
    let rows: Vec<String> = form
        .points
        .iter()
        .map(|p| {
            let row: Vec<String> = entries.iter().map(|&(i, j)| text(entry(p, i, j))).collect();
            format!("{{{}}}", if row.is_empty() { "0".to_owned() } else { row.join(", ") })
        })
        .collect();
    let _ = writeln!(out, "    constant Real table[{}, {k}] = {{\n      {}}};", rows.len(), rows.join(",\n      "));
    let _ = writeln!(out, "    Integer cell[{d}];\n    Real part[{d}], weight;\n    Integer row, corner;\n  algorithm");
    for (at, values) in grid.iter().enumerate() {
        let (a, g) = (at + 1, values.len());
        if g == 1 {
            let _ = writeln!(out, "    cell[{a}] := 1;\n    part[{a}] := 0;");
            continue;
        }
        let _ = writeln!(
            out,
            "    cell[{a}] := 1;\n    for i in 2:{} loop\n      if rho[{a}] > grid_{a}[i] then\n        cell[{a}] := i;\n      end if;\n    end for;\n    part[{a}] := (rho[{a}] - grid_{a}[cell[{a}]])/(grid_{a}[cell[{a}] + 1] - grid_{a}[cell[{a}]]);",
            g - 1
        );
    }
    let lengths: Vec<String> = grid.iter().map(|values| values.len().to_string()).collect();
    let single: Vec<String> = grid.iter().map(|values| if values.len() == 1 { "0" } else { "1" }.to_owned()).collect();
    let _ = writeln!(
        out,
        "    e := zeros({k});\n    for c in 0:{} loop\n      corner := c;\n      row := 0;\n      weight := 1;\n      for a in 1:{d} loop\n        row := row*lengths[a] + cell[a] - 1 + mod(corner, 2)*step[a];\n        weight := weight*(if mod(corner, 2) == 1 then part[a] else 1 - part[a]);\n        corner := div(corner, 2);\n      end for;\n      e := e + weight*table[row + 1, :];\n    end for;\n  end matrices;",
        (1_usize << d) - 1
    );
    let constants = format!(
        "    constant Integer lengths[{d}] = {{{}}};\n    constant Integer step[{d}] = {{{}}};\n",
        lengths.join(", "),
        single.join(", ")
    );
    out.replacen("    Integer cell[", &format!("{constants}    Integer cell["), 1)
}

/// The values of each scheduling quantity; the points are all combinations, the last quantity fastest.
fn grid(form: &Schedule) -> Vec<Vec<f64>> {
    (0..form.rho.len())
        .map(|k| {
            let mut values: Vec<f64> = Vec::new();
            form.points.iter().map(|p| p.rho[k]).for_each(|v| {
                if !values.contains(&v) {
                    values.push(v);
                }
            });
            values
        })
        .collect()
}

fn described(q: &Quantity) -> String {
    let unit = if q.unit.is_empty() { "1" } else { &q.unit };
    format!("{} in {unit}", q.name)
}
