//! Where rows go, and the grid of output times.

use super::checkpoint::Checkpoint;
use super::modes::same_time;
use bramah_expr::VarId;
use bramah_model::flat::ScalarType;
use bramah_model::structure::Dae;
use bramah_results::{Kind, Signal, Trajectory};
use std::ops::ControlFlow;
use std::time::Duration;

/// Takes the rows of a run in the order of time. Rows of equal time are an event: before and after it.
pub trait RowSink: Send {
    /// A row; the values are in the order of `Settings::wanted`. `Break` ends the run as interrupted.
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()>;

    /// A point from which the run can be taken up; all rows before it have come. `Break` ends the run as interrupted.
    fn checkpoint(&mut self, _at: &Checkpoint) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// How long it has been writing to a slow place, for statistics: only the sink knows when it does, and a clock
    /// around every row would cost as much as the row.
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

/// Output times `start + k interval` and the stop time; nothing accumulates.
#[derive(Clone, Copy, Debug)]
pub struct OutputGrid {
    start: f64,
    stop: f64,
    interval: f64,
    /// Start and interval as whole numbers of this part of a second, where they are decimal numbers: then the k-th time
    /// is the number nearest to its decimal notation, 0.3 and not 0.30000000000000004.
    decimal: Option<DecimalGrid>,
    next: u64,
    /// Events since the last row of the grid, how many of an interval have rows, and whether some had none.
    events: u64,
    recorded: u64,
    thinned: bool,
}

#[derive(Clone, Copy, Debug)]
struct DecimalGrid {
    start: f64,
    interval: f64,
    parts: f64,
}

impl DecimalGrid {
    fn new(start: f64, interval: f64) -> Option<Self> {
        let whole = |x: f64| (x.abs() < 1e12 && (x - x.round()).abs() <= 1e-12 * x.abs()).then(|| x.round());
        [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9].into_iter().find_map(|parts| {
            let (start, interval) = (whole(start * parts)?, whole(interval * parts)?);
            (interval > 0.0).then_some(DecimalGrid { start, interval, parts })
        })
    }

    fn time(&self, k: u64) -> f64 {
        (self.start + k as f64 * self.interval) / self.parts
    }
}

impl OutputGrid {
    /// Standing at the first row.
    pub fn new(start: f64, stop: f64, interval: f64) -> Self {
        let interval = if interval > 0.0 { interval } else { f64::INFINITY };
        let decimal = DecimalGrid::new(start, interval);
        OutputGrid { start, stop, interval, decimal, next: 0, events: 0, recorded: u64::MAX, thinned: false }
    }

    /// With so many event rows in all at most, in equal parts for each interval of the grid.
    pub fn with_event_rows(mut self, most: u64) -> Self {
        let intervals = ((self.stop - self.start) / self.interval).ceil().max(1.0);
        self.recorded = ((most / 2) as f64 / intervals) as u64;
        self
    }

    /// Counts an event, and says whether it has rows.
    pub fn records_event(&mut self) -> bool {
        self.events += 1;
        let recorded = self.events <= self.recorded;
        self.thinned |= !recorded;
        recorded
    }

    /// How many events of an interval have rows, where some interval had more.
    pub fn thinned(&self) -> Option<u64> {
        self.thinned.then_some(self.recorded)
    }

    /// Standing behind some rows.
    pub fn after(start: f64, stop: f64, interval: f64, rows: u64) -> Self {
        OutputGrid { next: rows, ..OutputGrid::new(start, stop, interval) }
    }

    /// How many rows of the grid are out.
    pub fn rows(&self) -> u64 {
        self.next
    }

    /// The next output time; infinite when all rows are out.
    pub fn next(&self) -> f64 {
        let t = match &self.decimal {
            _ if self.next == 0 => self.start,
            Some(decimal) => decimal.time(self.next),
            None => self.start + self.next as f64 * self.interval,
        };
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
