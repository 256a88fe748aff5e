//! Where rows go, and the grid of output times.

use super::modes::same_time;
use crate::expr::VarId;
use crate::flat::Type;
use crate::results::{Kind, Signal, Trajectory};
use crate::structure::Dae;
use std::ops::ControlFlow;

/// Takes the rows of a run in the order of time. Rows of equal time are an event: before and after it.
pub trait Sink {
    /// A row; the values are in the order of `Settings::wanted`. `Break` ends the run as interrupted.
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()>;
}

impl Sink for Trajectory {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        self.push(time, values);
        ControlFlow::Continue(())
    }
}

/// The columns of a recording of these variables.
pub fn signals(dae: &Dae, wanted: &[VarId]) -> Vec<Signal> {
    let text = |t: &Option<Box<str>>| t.as_deref().unwrap_or("").to_string();
    let signal = |v: &VarId| {
        let variable = &dae.variables[v.index()];
        Signal {
            name: variable.name.clone(),
            unit: text(&variable.unit),
            display_unit: text(&variable.display_unit),
            description: text(&variable.description),
            kind: kind(dae, variable.ty),
        }
    };
    wanted.iter().map(signal).collect()
}

fn kind(dae: &Dae, ty: Type) -> Kind {
    match ty {
        Type::Real => Kind::Real,
        Type::Integer => Kind::Integer,
        Type::Boolean => Kind::Boolean,
        Type::Enumeration(e) => {
            Kind::Enumeration(dae.enumerations.get(e as usize).map_or_else(Vec::new, |e| e.1.clone()))
        }
    }
}

/// Output times `start + k interval` and the stop time; nothing accumulates.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    start: f64,
    stop: f64,
    interval: f64,
    next: u64,
}

impl Grid {
    /// Standing at the first row.
    pub fn new(start: f64, stop: f64, interval: f64) -> Self {
        Grid { start, stop, interval: if interval > 0.0 { interval } else { f64::INFINITY }, next: 0 }
    }

    /// The next output time; infinite when all rows are out.
    pub fn next(&self) -> f64 {
        let t = if self.next == 0 { self.start } else { self.start + self.next as f64 * self.interval };
        if t < self.stop && !same_time(t, self.stop) {
            t
        } else if self.next == u64::MAX {
            f64::INFINITY
        } else {
            self.stop
        }
    }

    /// Marks rows up to and including `t` as out.
    pub fn pass(&mut self, t: f64) {
        while self.next() <= t || same_time(self.next(), t) {
            if self.next() >= self.stop {
                self.next = u64::MAX;
                return;
            }
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(mut grid: Grid) -> Vec<f64> {
        let mut times = vec![];
        while grid.next().is_finite() {
            times.push(grid.next());
            grid.pass(grid.next());
        }
        times
    }

    #[test]
    fn the_last_row_is_the_stop_time() {
        assert_eq!(times(Grid::new(0.0, 0.3, 0.1)), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(times(Grid::new(1.0, 1.25, 0.1)), [1.0, 1.1, 1.2, 1.25]);
        assert_eq!(times(Grid::new(0.0, 2.0, 0.0)), [0.0, 2.0]);
        assert_eq!(times(Grid::new(0.0, 20.0, 0.01)).len(), 2001);
    }
}
