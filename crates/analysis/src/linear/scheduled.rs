//! Writes a quasi-linear form as a Modelica model and as a MATLAB file.
//!
//! A [`QuasiLpvModel`] enters; texts or bytes leave. The Modelica model interpolates the matrices by a function of its
//! own, multilinearly over the cells of the grid.

use super::schedule::{LpvGridPoint, QuasiLpvModel};
use bramah_results::mat::write_matrix;
use bramah_results::number::text;
use nalgebra::DMatrix;
use std::fmt::Write as _;

impl QuasiLpvModel {
    /// A MATLAB file of version 4.
    ///
    /// It holds `rho` with a row for each point of the grid, and `A` and `B` of all points side by side: those of point
    /// k are `A(:, (k-1)*n+1 : k*n)` and `B(:, (k-1)*m+1 : k*m)`, where m counts the constant input 1, the last column
    /// of `B`. `x0` and `u0` are the operating point.
    pub fn mat(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut put = |name: &str, rows: usize, values: &[f64]| {
            write_matrix(&mut out, name, rows, values).expect("writing to memory cannot fail");
        };
        let rho: Vec<f64> = (0..self.rho.len()).flat_map(|k| self.points.iter().map(move |p| p.rho[k])).collect();
        put("rho", self.points.len(), &rho);
        let side_by_side = |of: &dyn Fn(&LpvGridPoint) -> &DMatrix<f64>| -> Vec<f64> {
            self.points.iter().flat_map(|p| of(p).as_slice().to_vec()).collect()
        };
        put("A", self.states.len(), &side_by_side(&|p| &p.a));
        put("B", self.states.len(), &side_by_side(&|p| &p.b));
        for (name, list) in [("x0", &self.states), ("u0", &self.inputs)] {
            let values: Vec<f64> = list.iter().map(|q| q.value).collect();
            put(name, values.len(), &values);
        }
        out
    }

    /// A Modelica model whose states and inputs are the quantities themselves.
    ///
    /// Its matrices are interpolated between the points of the grid, linearly in each scheduling quantity, and
    /// extrapolated beyond its ends.
    pub fn modelica(&self, name: &str) -> String {
        // Only entries that are nonzero somewhere are tabulated.
        let entries = self.entries();
        let mut out = format!("model {name} \"{}, quasi-linear over ({})\"\n", self.class, self.rho.join(", "));
        out += &self.interpolation(&entries);
        for (i, q) in (1..).zip(&self.states) {
            let _ = writeln!(out, "  Real x_{i}(start = {}, fixed = true) \"{}\";", text(q.value), q.words());
        }
        for (j, q) in (1..).zip(&self.inputs) {
            let _ = writeln!(out, "  input Real u_{j}(start = {}) \"{}\";", text(q.value), q.words());
        }
        for (k, rho) in (1..).zip(&self.rho) {
            let _ = writeln!(out, "  Real rho_{k} \"{rho}\";");
        }
        let count = entries.len().max(1);
        let _ = writeln!(out, "protected\n  Real e[{count}] \"Entries of the matrices that are not 0\";\nequation");
        for (k, leg) in (1..).zip(&self.legs) {
            let of = self.symbol(leg.column);
            let _ = writeln!(out, "  rho_{k} = {}*({of} - ({}));", text(leg.factor), text(leg.origin));
        }
        let rho: Vec<String> = (1..=self.rho.len()).map(|k| format!("rho_{k}")).collect();
        let _ = writeln!(out, "  e = matrices({{{}}});", rho.join(", "));
        for i in 0..self.states.len() {
            let of_row = (1..).zip(&entries).filter(|(_, (row, _))| *row == i);
            let terms: Vec<String> = of_row.map(|(k, (_, j))| format!("e[{k}]*{}", self.symbol(*j))).collect();
            let _ = writeln!(out, "  der(x_{}) = {};", i + 1, or_zero(terms.join(" + ")));
        }
        let _ = writeln!(out, "end {name};");
        out
    }

    /// The Modelica name for a column of (A, B): a state, an input, or the constant 1.
    fn symbol(&self, column: usize) -> String {
        match column.checked_sub(self.states.len()) {
            None => format!("x_{}", column + 1),
            Some(j) if j < self.inputs.len() => format!("u_{}", j + 1),
            Some(_) => "1".to_owned(),
        }
    }

    /// Row and column of each entry of (A, B) that is nonzero at some point.
    fn entries(&self) -> Vec<(usize, usize)> {
        let columns = self.states.len() + self.inputs.len() + 1;
        let all = (0..self.states.len()).flat_map(|i| (0..columns).map(move |j| (i, j)));
        all.filter(|&(i, j)| self.points.iter().any(|p| entry(p, i, j) != 0.0)).collect()
    }

    /// The Modelica function that interpolates the entries: a weighted sum over the corners of a cell.
    fn interpolation(&self, entries: &[(usize, usize)]) -> String {
        let (d, k) = (self.grid.len(), entries.len().max(1));
        // A cell of d quantities has 2^d corners; bit a of a corner's number says on which side of quantity a it lies.
        let last = (1_usize << d) - 1;
        format!(
            "  function matrices \"Entries of A and B between the points of the grid\"
    input Real rho[{d}];
    output Real e[{k}];
  protected
{}    Integer cell[{d}], row, corner;
    Real part[{d}], weight;
  algorithm
{}    e := zeros({k});
    for c in 0:{last} loop
      corner := c;
      row := 0;
      weight := 1;
      for a in 1:{d} loop
        row := row*lengths[a] + cell[a] - 1 + mod(corner, 2)*step[a];
        weight := weight*(if mod(corner, 2) == 1 then part[a] else 1 - part[a]);
        corner := div(corner, 2);
      end for;
      e := e + weight*table[row + 1, :];
    end for;
  end matrices;
",
            self.constants(entries),
            self.cells()
        )
    }

    /// Declarations of the grid and of the entries at its points.
    fn constants(&self, entries: &[(usize, usize)]) -> String {
        let numbers = |values: &mut dyn Iterator<Item = f64>| values.map(text).collect::<Vec<_>>().join(", ");
        let mut out = String::new();
        for (a, values) in (1..).zip(&self.grid) {
            let list = numbers(&mut values.iter().copied());
            let _ = writeln!(out, "    constant Real grid_{a}[{}] = {{{list}}};", values.len());
        }
        let row = |p: &LpvGridPoint| {
            let row = numbers(&mut entries.iter().map(|&(i, j)| entry(p, i, j)));
            format!("{{{}}}", or_zero(row))
        };
        let rows: Vec<String> = self.points.iter().map(row).collect();
        let (count, width, d) = (rows.len(), entries.len().max(1), self.grid.len());
        let _ = writeln!(out, "    constant Real table[{count}, {width}] = {{\n      {}}};", rows.join(",\n      "));
        let whole = |of: &dyn Fn(usize) -> usize| {
            let all: Vec<String> = self.grid.iter().map(|values| of(values.len()).to_string()).collect();
            all.join(", ")
        };
        let _ = writeln!(out, "    constant Integer lengths[{d}] = {{{}}};", whole(&|n| n));
        let _ = writeln!(out, "    constant Integer step[{d}] = {{{}}};", whole(&|n| usize::from(n > 1)));
        out
    }

    /// Statements that find the cell of a point, and its relative position in it.
    fn cells(&self) -> String {
        let mut out = String::new();
        for (a, values) in (1..).zip(&self.grid) {
            let _ = writeln!(out, "    cell[{a}] := 1;");
            if values.len() == 1 {
                // A quantity with one value has no cell: its matrices are constant in it.
                let _ = writeln!(out, "    part[{a}] := 0;");
                continue;
            }
            let _ = writeln!(
                out,
                "    for i in 2:{} loop
      if rho[{a}] > grid_{a}[i] then
        cell[{a}] := i;
      end if;
    end for;
    part[{a}] := (rho[{a}] - grid_{a}[cell[{a}]])/(grid_{a}[cell[{a}] + 1] - grid_{a}[cell[{a}]]);",
                values.len() - 1
            );
        }
        out
    }
}

/// An entry of (A, B) at a point of the grid.
fn entry(point: &LpvGridPoint, i: usize, j: usize) -> f64 {
    let n = point.a.ncols();
    if j < n { point.a[(i, j)] } else { point.b[(i, j - n)] }
}

/// `0` in place of an empty sum or list.
fn or_zero(terms: String) -> String {
    if terms.is_empty() { "0".to_owned() } else { terms }
}
