//! Events of known time: the clocks of `sample`, and relations of time. They are located exactly, without root finding.

use super::modes::{after, same_time};
use crate::lower::ExecutableSystem;
use bramah_model::structure::CrossingKind;

/// The clocks of all `sample` operators. Times are `start + k interval`, computed from k, so that no rounding
/// accumulates.
#[derive(Clone, Debug, Default)]
pub struct SampleClocks {
    /// One clock per entry of `Dae::samples`.
    clocks: Vec<SampleClock>,
}

/// One clock. Times are in seconds.
#[derive(Clone, Copy, Debug)]
struct SampleClock {
    /// Time of the first tick.
    start: f64,
    /// Time between ticks, positive.
    interval: f64,
    /// Index of the next tick.
    next: u64,
}

impl SampleClock {
    /// Time of the next tick.
    fn time(&self) -> f64 {
        self.start + self.next as f64 * self.interval
    }
}

impl SampleClocks {
    /// All clocks, each at its first tick at or after `t`.
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
                // starts one tick too early, because the division may round up
                clock.next = (((t - start) / interval).floor() as u64).saturating_sub(1);
                while clock.time() < t && !same_time(clock.time(), t) {
                    clock.next += 1;
                }
            }
            clocks.push(clock);
        }
        Ok(SampleClocks { clocks })
    }

    /// The next tick of any clock; infinite without clocks.
    pub fn next(&self) -> f64 {
        self.clocks.iter().map(SampleClock::time).fold(f64::INFINITY, f64::min)
    }

    /// Calls `ring` for each clock whose tick is due at `t`, and moves those clocks on.
    pub fn ring(&mut self, t: f64, mut ring: impl FnMut(usize)) {
        for (i, clock) in self.clocks.iter_mut().enumerate() {
            if same_time(clock.time(), t) || clock.time() < t {
                ring(i);
                clock.next += 1;
            }
        }
    }

    /// Moves all clocks past `t`.
    pub fn skip(&mut self, t: f64) {
        for clock in &mut self.clocks {
            while clock.time() < t || same_time(clock.time(), t) {
                clock.next += 1;
            }
        }
    }
}

/// The next time after `t` at which a relation of time changes; infinite when there is none.
///
/// The time that a relation compares with may depend on discrete values, so it is evaluated again after each event.
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
