//! The tolerance tube around a reference curve, as the tool `csv-compare` of the Modelica Association defines it.
//!
//! The tube is the area that a rectangle of half width `dt` (time) and half height `dy` (value) covers as its centre
//! moves
//! along the curve. At time t it reaches from the smallest value of the curve within `t - dt .. t + dt`, minus `dy`, to
//! the
//! largest one there, plus `dy`. A jump may therefore come `dt` early or late.

use std::collections::VecDeque;

/// The tube around a curve, evaluated at times that do not decrease.
/// The extreme values come from two monotone queues, so that all evaluations together take linear time.
#[derive(Debug)]
pub(super) struct ToleranceTube<'a> {
    /// The times of the curve (s).
    times: &'a [f64],
    /// The values of the curve.
    values: &'a [f64],
    /// True if the curve is a staircase, else it is piecewise linear.
    held: bool,
    /// Half width (s).
    dt: f64,
    /// Half height.
    dy: f64,
    /// The index of the first point that has not entered the window.
    next: usize,
    /// Points of the window that may become its largest value, with decreasing values.
    largest: VecDeque<usize>,
    /// Points of the window that may become its smallest value, with increasing values.
    least: VecDeque<usize>,
}

impl<'a> ToleranceTube<'a> {
    /// The tube around a curve. `times` and `values` have equal length and no NaN.
    pub fn new(times: &'a [f64], values: &'a [f64], held: bool, dt: f64, dy: f64) -> Self {
        ToleranceTube { times, values, held, dt, dy, next: 0, largest: VecDeque::new(), least: VecDeque::new() }
    }

    /// The lower and upper edge at a time. `None` if the curve has no point within `dt`.
    /// Times must not decrease from call to call.
    pub fn at(&mut self, time: f64) -> Option<(f64, f64)> {
        let (from, to) = (time - self.dt, time + self.dt);
        self.advance(from, to);
        let inside = self.least.front().zip(self.largest.front());
        let mut edges = inside.map(|(&low, &high)| (self.values[low], self.values[high]));
        // The window ends between points, where the curve has extreme values too.
        for end in [from, to] {
            if let Some(v) = self.curve(end) {
                edges = Some(edges.map_or((v, v), |(low, high)| (low.min(v), high.max(v))));
            }
        }
        edges.map(|(low, high)| (low - self.dy, high + self.dy))
    }

    /// Moves the window, which holds the points with `from <= time <= to`.
    fn advance(&mut self, from: f64, to: f64) {
        while self.next < self.times.len() && self.times[self.next] <= to {
            let value = self.values[self.next];
            // A point that is smaller and older can never be the largest again.
            while self.largest.back().is_some_and(|&i| self.values[i] <= value) {
                self.largest.pop_back();
            }
            while self.least.back().is_some_and(|&i| self.values[i] >= value) {
                self.least.pop_back();
            }
            self.largest.push_back(self.next);
            self.least.push_back(self.next);
            self.next += 1;
        }
        for queue in [&mut self.largest, &mut self.least] {
            while queue.front().is_some_and(|&i| self.times[i] < from) {
                queue.pop_front();
            }
        }
    }

    /// The curve at a time. `None` outside.
    fn curve(&self, time: f64) -> Option<f64> {
        interpolate(self.times, self.values, self.held, time)
    }
}

/// The value of a piecewise linear curve or staircase (`held`) at a time. At a jump it is the later value. `None`
/// outside.
pub(super) fn interpolate(times: &[f64], values: &[f64], held: bool, time: f64) -> Option<f64> {
    let after = times.partition_point(|&t| t <= time);
    let before = after.checked_sub(1)?;
    if held || times[before] == time {
        // A staircase ends with its last point, although its value would be known beyond.
        return (after < times.len() || times[before] == time).then(|| values[before]);
    }
    let end = *times.get(after)?;
    let part = (time - times[before]) / (end - times[before]);
    Some(values[before] + (values[after] - values[before]) * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_may_come_early_or_late() {
        let (times, values) = ([0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 5.0, 5.0]);
        let mut tube = ToleranceTube::new(&times, &values, false, 0.1, 0.5);
        assert_eq!(tube.at(0.5), Some((-0.5, 0.5)));
        assert_eq!(tube.at(0.95), Some((-0.5, 5.5)));
        assert_eq!(tube.at(1.05), Some((-0.5, 5.5)));
        assert_eq!(tube.at(1.2), Some((4.5, 5.5)));
        assert_eq!(tube.at(2.05), Some((4.5, 5.5)));
        assert_eq!(tube.at(2.2), None);
    }

    #[test]
    fn a_slope_widens_the_tube() {
        let (times, values) = ([0.0, 10.0], [0.0, 10.0]);
        let mut tube = ToleranceTube::new(&times, &values, false, 1.0, 0.5);
        assert_eq!(tube.at(5.0), Some((3.5, 6.5)));
    }

    #[test]
    fn without_width_in_time_an_event_allows_both_values() {
        let (times, values) = ([0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 5.0, 5.0]);
        let mut tube = ToleranceTube::new(&times, &values, false, 0.0, 0.0);
        assert_eq!(tube.at(1.0), Some((0.0, 5.0)));
        assert_eq!(tube.at(1.5), Some((5.0, 5.0)));
    }

    #[test]
    fn staircases_are_not_interpolated() {
        assert_eq!(interpolate(&[0.0, 1.0], &[2.0, 4.0], true, 0.9), Some(2.0));
        assert_eq!(interpolate(&[0.0, 1.0], &[2.0, 4.0], true, 1.0), Some(4.0));
        assert_eq!(interpolate(&[0.0, 1.0], &[2.0, 4.0], true, 1.1), None);
    }
}
