//! The tolerance tube around a reference curve, as `csv-compare` of the Modelica Association draws it.
//!
//! The tube is what a rectangle of half width `dt` (time) and half height `dy` (value) sweeps when its centre moves
//! along the curve: at time `t` it reaches from the curve's least value within `t - dt .. t + dt` minus `dy` to its
//! largest value there plus `dy`. A jump is thereby allowed to come `dt` early or late.

use std::collections::VecDeque;

/// A tube over a piecewise linear curve. Times asked for must not fall.
#[derive(Debug)]
pub(super) struct ToleranceTube<'a> {
    times: &'a [f64],
    values: &'a [f64],
    held: bool,
    dt: f64,
    dy: f64,
    next: usize,
    largest: VecDeque<usize>,
    least: VecDeque<usize>,
}

impl<'a> ToleranceTube<'a> {
    /// `held`: the curve is a staircase. `times` and `values` are of equal length and without NaN.
    pub fn new(times: &'a [f64], values: &'a [f64], held: bool, dt: f64, dy: f64) -> Self {
        ToleranceTube { times, values, held, dt, dy, next: 0, largest: VecDeque::new(), least: VecDeque::new() }
    }

    /// Lower and upper edge at a time; `None` where the curve has no point within `dt`.
    pub fn at(&mut self, time: f64) -> Option<(f64, f64)> {
        let (from, to) = (time - self.dt, time + self.dt);
        self.advance(from, to);
        let inside = self.least.front().zip(self.largest.front());
        let mut edges = inside.map(|(&low, &high)| (self.values[low], self.values[high]));
        for end in [from, to] {
            if let Some(v) = self.curve(end) {
                edges = Some(edges.map_or((v, v), |(low, high)| (low.min(v), high.max(v))));
            }
        }
        edges.map(|(low, high)| (low - self.dy, high + self.dy))
    }

    /// Keeps the points with `from <= time <= to`, monotone queues giving the extremes.
    fn advance(&mut self, from: f64, to: f64) {
        while self.next < self.times.len() && self.times[self.next] <= to {
            let value = self.values[self.next];
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

    /// The curve between its points.
    fn curve(&self, time: f64) -> Option<f64> {
        interpolate(self.times, self.values, self.held, time)
    }
}

/// A piecewise linear curve, or a staircase; at a jump the later value. `None` outside.
pub(super) fn interpolate(times: &[f64], values: &[f64], held: bool, time: f64) -> Option<f64> {
    let after = times.partition_point(|&t| t <= time);
    let before = after.checked_sub(1)?;
    if held || times[before] == time {
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
