//! Events whose time is known: `sample`, relations of time, held inputs. They are located exactly.

use super::modes::{after, same_time};
use crate::lower::ExecutableSystem;
use bramah_model::structure::CrossingKind;

/// The clocks of `sample`. Times are `start + k interval`, computed anew each time so that nothing accumulates.
#[derive(Clone, Debug, Default)]
pub struct SampleClocks {
    clocks: Vec<SampleClock>,
}

#[derive(Clone, Copy, Debug)]
struct SampleClock {
    start: f64,
    interval: f64,
    next: u64,
}

impl SampleClock {
    fn time(&self) -> f64 {
        self.start + self.next as f64 * self.interval
    }
}

impl SampleClocks {
    /// All clocks, standing at their first instant at or after `t`.
    ///
    /// # Errors
    /// The index of a `sample` whose interval is not positive.
    pub fn new(system: &ExecutableSystem, values: &[f64], t: f64) -> Result<Self, usize> {
        let mut clocks = Vec::new();
        for (i, sample) in system.dae.samples.iter().enumerate() {
            let (start, interval) = (system.eval(sample.start, values), system.eval(sample.interval, values));
            if !(interval > 0.0 && start.is_finite()) {
                return Err(i);
            }
            let mut clock = SampleClock { start, interval, next: 0 };
            if start < t {
                clock.next = (((t - start) / interval).floor() as u64).saturating_sub(1);
                while clock.time() < t && !same_time(clock.time(), t) {
                    clock.next += 1;
                }
            }
            clocks.push(clock);
        }
        Ok(SampleClocks { clocks })
    }

    /// The next instant of any clock.
    pub fn next(&self) -> f64 {
        self.clocks.iter().map(SampleClock::time).fold(f64::INFINITY, f64::min)
    }

    /// Calls `ring` for each clock whose instant is `t`, and moves those on.
    pub fn ring(&mut self, t: f64, mut ring: impl FnMut(usize)) {
        for (i, clock) in self.clocks.iter_mut().enumerate() {
            if same_time(clock.time(), t) || clock.time() < t {
                ring(i);
                clock.next += 1;
            }
        }
    }

    /// Passes over all instants up to and including `t`.
    pub fn skip(&mut self, t: f64) {
        for clock in &mut self.clocks {
            while clock.time() < t || same_time(clock.time(), t) {
                clock.next += 1;
            }
        }
    }
}

/// The next time after `t` at which a relation of time changes, with the values as they are now.
pub fn next_time_crossing(system: &ExecutableSystem, values: &[f64], t: f64) -> f64 {
    let mut next = f64::INFINITY;
    for crossing in &system.dae.crossings {
        let CrossingKind::Time(rel, at) = crossing.kind else { continue };
        let changed = (values[system.layout.var(crossing.mode)] != 0.0) == after(rel);
        if changed {
            continue;
        }
        let at = system.eval(at, values);
        if at.is_finite() && at > t && !same_time(at, t) {
            next = next.min(at);
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_times_do_not_accumulate_rounding() {
        let mut clocks = SampleClocks { clocks: vec![SampleClock { start: 0.1, interval: 0.1, next: 0 }] };
        let mut rung = 0;
        while clocks.next() < 1000.0 {
            let t = clocks.next();
            clocks.ring(t, |_| rung += 1);
        }
        assert_eq!(rung, 9999);
        assert!((clocks.next() - 1000.0).abs() < 1e-12);
    }

    #[test]
    fn clocks_that_coincide_ring_together() {
        let clock = |interval| SampleClock { start: 0.0, interval, next: 0 };
        let mut clocks = SampleClocks { clocks: vec![clock(0.1), clock(0.3)] };
        let mut together = 0;
        for _ in 0..7 {
            let mut count = 0;
            let t = clocks.next();
            clocks.ring(t, |_| count += 1);
            together += usize::from(count == 2);
        }
        assert_eq!(together, 3);
    }
}
