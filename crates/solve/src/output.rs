//! Output: the interface that receives the rows of a run, and the grid of output times.
//!
//! The driver asks [`OutputGrid`] for the next time and writes rows into the caller's [`RowSink`].

use super::checkpoint::Checkpoint;
use super::modes::same_time;
use bramah_expr::VarId;
use bramah_model::flat::ScalarType;
use bramah_model::structure::Dae;
use bramah_results::{Kind, Signal, Trajectory};
use std::ops::ControlFlow;
use std::time::Duration;

/// Receives the rows of a run in the order of time. Two rows of equal time are an event: before and after it.
pub trait RowSink: Send {
    /// Receives a row. The values are in the order of `Settings::wanted`, followed by their sensitivities, if any.
    ///
    /// `Break` ends the run as interrupted.
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()>;

    /// Receives a checkpoint; all rows before it have been written. `Break` ends the run as interrupted.
    fn checkpoint(&mut self, _at: &Checkpoint) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Time that the sink has spent on slow writing, for statistics.
    ///
    /// Only the sink knows when it writes. Measuring around every row would cost as much as the row.
    fn writing(&self) -> Duration {
        Duration::ZERO
    }
}

impl RowSink for Trajectory {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        self.push(time, values);
        ControlFlow::Continue(())
    }
}

/// The columns of a recording of these variables: names, units, descriptions and kinds.
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

/// The kind of signal of a scalar type.
fn kind(dae: &Dae, ty: ScalarType) -> Kind {
    match ty {
        ScalarType::Real => Kind::Real,
        ScalarType::Integer => Kind::Integer,
        ScalarType::Boolean => Kind::Boolean,
        ScalarType::Enumeration(e) => {
            Kind::Enumeration(dae.enumerations.get(e as usize).map_or_else(Vec::new, |e| e.1.clone()))
        }
    }
}

/// Output times `start + k interval` and the stop time. Each is computed from k, so that no rounding accumulates.
#[derive(Clone, Copy, Debug)]
pub struct OutputGrid {
    /// First output time in seconds.
    start: f64,
    /// Last output time in seconds.
    stop: f64,
    /// Distance of output times in seconds; infinite for the first and last row only.
    interval: f64,
    /// Start and interval in decimal parts of a second; `None` where they are no decimal numbers.
    ///
    /// The k-th time is then the number nearest to its decimal notation: 0.3 and not 0.30000000000000004.
    decimal: Option<DecimalGrid>,
    /// Index of the next row; `u64::MAX` when all rows are written.
    next: u64,
    /// Number of events since the last row of the grid.
    events: u64,
    /// Number of events of each interval that have rows.
    recorded: u64,
    /// Whether some event had no row.
    thinned: bool,
}

/// A grid in integer multiples of a decimal part of a second.
#[derive(Clone, Copy, Debug)]
struct DecimalGrid {
    /// Start in these parts, an integer.
    start: f64,
    /// Interval in these parts, an integer.
    interval: f64,
    /// Number of parts of a second: a power of ten up to 1e9.
    parts: f64,
}

impl DecimalGrid {
    /// The coarsest such grid; `None` where start or interval are no decimal numbers.
    fn new(start: f64, interval: f64) -> Option<Self> {
        let whole = |x: f64| (x.abs() < 1e12 && (x - x.round()).abs() <= 1e-12 * x.abs()).then(|| x.round());
        [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9].into_iter().find_map(|parts| {
            let (start, interval) = (whole(start * parts)?, whole(interval * parts)?);
            (interval > 0.0).then_some(DecimalGrid { start, interval, parts })
        })
    }

    /// The k-th time in seconds.
    fn time(&self, k: u64) -> f64 {
        (self.start + k as f64 * self.interval) / self.parts
    }
}

impl OutputGrid {
    /// A grid at its first row. An interval of 0 or less gives the first and last row only.
    pub fn new(start: f64, stop: f64, interval: f64) -> Self {
        let interval = if interval > 0.0 { interval } else { f64::INFINITY };
        let decimal = DecimalGrid::new(start, interval);
        OutputGrid { start, stop, interval, decimal, next: 0, events: 0, recorded: u64::MAX, thinned: false }
    }

    /// Limits the number of event rows of the run, in equal parts for each interval of the grid.
    pub fn with_event_rows(mut self, most: u64) -> Self {
        let intervals = ((self.stop - self.start) / self.interval).ceil().max(1.0);
        // each event has two rows, before and after it
        self.recorded = ((most / 2) as f64 / intervals) as u64;
        self
    }

    /// Counts an event, and returns whether it has rows.
    pub fn records_event(&mut self) -> bool {
        self.events += 1;
        let recorded = self.events <= self.recorded;
        self.thinned |= !recorded;
        recorded
    }

    /// The number of events of an interval that have rows, if some interval had more; `None` otherwise.
    pub fn thinned(&self) -> Option<u64> {
        self.thinned.then_some(self.recorded)
    }

    /// A grid behind its first `rows` rows, for a run that continues.
    pub fn after(start: f64, stop: f64, interval: f64, rows: u64) -> Self {
        OutputGrid { next: rows, ..OutputGrid::new(start, stop, interval) }
    }

    /// Number of rows of the grid that are written.
    pub fn rows(&self) -> u64 {
        self.next
    }

    /// The next output time; infinite when all rows are written.
    pub fn next(&self) -> f64 {
        let t = match &self.decimal {
            _ if self.next == 0 => self.start,
            Some(decimal) => decimal.time(self.next),
            None => self.start + self.next as f64 * self.interval,
        };
        // a time close to the stop time is replaced by it, so that no two rows are there
        if t < self.stop && !same_time(t, self.stop) {
            t
        } else if self.next == u64::MAX {
            f64::INFINITY
        } else {
            self.stop
        }
    }

    /// Marks rows up to and including `t` as written.
    pub fn pass(&mut self, t: f64) {
        while self.next() <= t || same_time(self.next(), t) {
            if self.next() >= self.stop {
                self.next = u64::MAX;
                return;
            }
            self.next += 1;
            self.events = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(mut grid: OutputGrid) -> Vec<f64> {
        let mut times = vec![];
        while grid.next().is_finite() {
            times.push(grid.next());
            grid.pass(grid.next());
        }
        times
    }

    #[test]
    fn of_each_interval_the_first_events_have_rows() {
        let mut grid = OutputGrid::new(0.0, 1.0, 0.5).with_event_rows(8);
        grid.pass(0.0);
        let mut recorded = |times: &[f64]| {
            let mut one = |&t: &f64| {
                let records = grid.records_event();
                grid.pass(t);
                records
            };
            times.iter().map(&mut one).filter(|r| *r).count()
        };
        assert_eq!(recorded(&[0.1, 0.2, 0.3, 0.4]), 2);
        assert_eq!(recorded(&[0.5, 0.6, 0.7]), 2);
        assert_eq!(grid.thinned(), Some(2));
        assert_eq!(OutputGrid::new(0.0, 1.0, 0.0).with_event_rows(100).recorded, 50);
    }

    #[test]
    fn the_last_row_is_the_stop_time() {
        assert_eq!(times(OutputGrid::new(0.0, 0.3, 0.1)), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(times(OutputGrid::new(1.0, 1.25, 0.1)), [1.0, 1.1, 1.2, 1.25]);
        assert_eq!(times(OutputGrid::new(0.0, 2.0, 0.0)), [0.0, 2.0]);
        assert_eq!(times(OutputGrid::new(0.0, 20.0, 0.01)).len(), 2001);
        assert_eq!(times(OutputGrid::new(0.5, 1.3, 0.2)), [0.5, 0.7, 0.9, 1.1, 1.3]);
        assert_eq!(times(OutputGrid::new(0.0, 1.0, 0.15)), [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0]);
        assert_eq!(times(OutputGrid::new(0.0, 1.0, 1.0 / 3.0)).len(), 4);
    }
}
