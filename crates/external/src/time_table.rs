//! Tables over time, as `ModelicaStandardTables` has them: curves that begin at a time, are shifted in time, and have events
//! at their corners.

use super::curve::TableCurve;
use super::options::{Extrapolation, Smoothness, TimeEvents};

/// Curves over time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeTable {
    /// One a column.
    pub curves: Vec<TableCurve>,
    /// Before this time the value is 0, s.
    pub start: f64,
    /// Added to the times of the table, s.
    pub shift: f64,
    /// Times of the table at which something is said to happen, growing, and the period after which they come again.
    corners: Vec<f64>,
    period: Option<f64>,
}

impl TimeTable {
    /// `times` do not decrease.
    pub fn new(
        times: &[f64],
        columns: &[Vec<f64>],
        (smoothness, extrapolation, events): (Smoothness, Extrapolation, TimeEvents),
        (start, shift): (f64, f64),
    ) -> Self {
        let curves = columns.iter().map(|y| TableCurve::new(times, y, smoothness, extrapolation)).collect();
        let bent = matches!(smoothness, Smoothness::Linear | Smoothness::Constant);
        let last = times.len() - 1;
        let happens = |k: usize| match events {
            TimeEvents::Never => false,
            TimeEvents::Always if bent => true,
            _ => k == 0 || k == last || times[k] == times[k - 1] || times[k] == times[k + 1],
        };
        let mut corners: Vec<f64> = (0..times.len()).filter(|&k| happens(k)).map(|k| times[k]).collect();
        corners.dedup();
        let span = times[last] - times[0];
        let period = (extrapolation == Extrapolation::Periodic && span > 0.0).then_some(span);
        TimeTable { curves, start, shift, corners, period }
    }

    /// The value, or a derivative of this order, where the next event is known: at its time the event has not happened yet
    /// while the value before the event says the same.
    pub fn value(&self, column: usize, [time, next, before]: [f64; 3], order: usize) -> f64 {
        let left = next < f64::MAX && next == before && time >= next;
        if time < self.start || left && next <= self.start {
            return 0.0;
        }
        let curve = &self.curves[column];
        if !left {
            return curve.value(time - self.shift, order, false);
        }
        // the piece that ends at the event goes on a little
        let edge = curve.value(next - self.shift, 0, true);
        let slope = curve.value(next - self.shift, 1, true);
        match order {
            0 => edge + slope * (time - next),
            _ => curve.value(next - self.shift, order, true),
        }
    }

    /// The next event after a time; the largest number where there is none.
    pub fn next_event(&self, time: f64) -> f64 {
        if time < self.start {
            return self.start;
        }
        let Some(first) = self.corners.first() else { return f64::MAX };
        let from = |turn: f64| self.corners.iter().map(move |c| c + turn * self.period.unwrap_or(0.0) + self.shift);
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
