//! Tables over time, as `CombiTimeTable` of the Modelica Standard Library has them (C source `ModelicaStandardTables`).
//! A table has a start time, a shift in time, and time events at its corners and jumps.
//! The parent module makes them and wraps their values and event times as functions for equations.
//!
//! A value depends on whether the event at a jump has happened yet. Functions have no memory, so the equations pass the
//! time of the next event and its value before the event.

use super::curve::TableCurve;
use super::options::{Extrapolation, Smoothness, TimeEvents};

/// Columns over time, with the events that belong to them.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeTable {
    /// One curve for each column that was chosen.
    pub curves: Vec<TableCurve>,
    /// Before this time all values are 0 (s).
    pub start: f64,
    /// Added to the times of the table (s).
    pub shift: f64,
    /// Times of the table at which an event takes place, ascending, without `shift` (s).
    corners: Vec<f64>,
    /// The period after which the events repeat. `None` unless the table is extrapolated periodically (s).
    period: Option<f64>,
}

impl TimeTable {
    /// Builds a table.
    /// `times` do not decrease, and two equal ones are a jump; there is at least one. Each column has one value for
    /// each time.
    /// The pair at the end is the start time and the shift (s).
    pub fn new(
        times: &[f64],
        columns: &[Vec<f64>],
        (smoothness, extrapolation, events): (Smoothness, Extrapolation, TimeEvents),
        (start, shift): (f64, f64),
    ) -> Self {
        let curves = columns.iter().map(|y| TableCurve::new(times, y, smoothness, extrapolation)).collect();
        // Cubic curves have continuous slopes, so that only their ends and jumps need events.
        let bent = matches!(smoothness, Smoothness::Linear | Smoothness::Constant);
        let last = times.len() - 1;
        let happens = |k: usize| match events {
            TimeEvents::Never => false,
            TimeEvents::Always if bent => true,
            // `k == 0` and `k == last` are tested first, which keeps the neighbours in range.
            _ => k == 0 || k == last || times[k] == times[k - 1] || times[k] == times[k + 1],
        };
        let mut corners: Vec<f64> = (0..times.len()).filter(|&k| happens(k)).map(|k| times[k]).collect();
        corners.dedup();
        let span = times[last] - times[0];
        let period = (extrapolation == Extrapolation::Periodic && span > 0.0).then_some(span);
        TimeTable { curves, start, shift, corners, period }
    }

    /// The value of a column, or its derivative of this order.
    ///
    /// The three times are the current one, the next event, and the next event before the current event iteration (s).
    /// If the last two agree, the event at that time has not happened yet: the curve left of the jump still holds.
    pub fn value(&self, column: usize, [time, next, before]: [f64; 3], order: usize) -> f64 {
        let left = next < f64::MAX && next == before && time >= next;
        if time < self.start || left && next <= self.start {
            return 0.0;
        }
        let curve = &self.curves[column];
        if !left {
            return curve.value(time - self.shift, order, false);
        }
        // The solver may step a little beyond the event before it locates it. Continuing the left piece with its slope
        // keeps the
        // function smooth there.
        let edge = curve.value(next - self.shift, 0, true);
        let slope = curve.value(next - self.shift, 1, true);
        match order {
            0 => edge + slope * (time - next),
            _ => curve.value(next - self.shift, order, true),
        }
    }

    /// The time of the next event after `time`. `f64::MAX` if there is none (s).
    pub fn next_event(&self, time: f64) -> f64 {
        if time < self.start {
            // The step from 0 to the first value at the start is an event too.
            return self.start;
        }
        let Some(first) = self.corners.first() else { return f64::MAX };
        let from = |turn: f64| self.corners.iter().map(move |c| c + turn * self.period.unwrap_or(0.0) + self.shift);
        // The next event lies in the current period or in the one after it.
        let turn = self.period.map_or(0.0, |period| ((time - self.shift - first) / period).floor());
        from(turn).chain(from(turn + 1.0)).find(|t| *t > time).unwrap_or(f64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(extrapolation: Extrapolation, start: f64, shift: f64) -> TimeTable {
        let y = vec![vec![0.0, 1.0, 5.0, 6.0]];
        let options = (Smoothness::Linear, extrapolation, TimeEvents::Always);
        TimeTable::new(&[0.0, 1.0, 1.0, 2.0], &y, options, (start, shift))
    }

    #[test]
    fn corners_come_one_after_the_other() {
        let held = table(Extrapolation::Hold, 0.5, 10.0);
        let events: Vec<f64> = [0.0, 0.5, 10.0, 10.5, 11.0, 12.0].iter().map(|t| held.next_event(*t)).collect();
        assert_eq!(events, [0.5, 10.0, 11.0, 11.0, 12.0, f64::MAX]);
        let again = table(Extrapolation::Periodic, 0.0, 0.0);
        let events: Vec<f64> = [0.0, 1.0, 2.0, 3.5, 101.0].iter().map(|t| again.next_event(*t)).collect();
        assert_eq!(events, [1.0, 2.0, 3.0, 4.0, 102.0]);
    }

    #[test]
    fn a_jump_happens_at_its_event() {
        let t = table(Extrapolation::Hold, 0.0, 0.0);
        assert_eq!(t.value(0, [1.0, 1.0, 1.0], 0), 1.0);
        assert_eq!(t.value(0, [1.0, 2.0, 1.0], 0), 5.0);
        assert_eq!(t.value(0, [1.5, 2.0, 2.0], 0), 5.5);
        assert_eq!(table(Extrapolation::Hold, 0.5, 0.0).value(0, [0.2, 0.5, 0.5], 0), 0.0);
    }
}
