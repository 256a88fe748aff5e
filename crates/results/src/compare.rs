//! Two trajectories side by side, signal by signal.

use serde::Serialize;

use super::delay::delay;
use super::trajectory::{Kind, Trajectory};
use super::tube::{ToleranceTube, interpolate};

/// How far a result may lie from the reference: the half widths of the tube around the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeTolerance {
    /// Part of the signal's range (largest minus least value of the reference; of its size where it is constant).
    pub relative: f64,
    /// In the signal's unit; added to the relative part.
    pub absolute: f64,
    /// Seconds; `None` for `relative` times the reference's duration.
    pub time: Option<f64>,
}

impl Default for TubeTolerance {
    /// The width `csv-compare` takes: 0.2 % of the range in both directions.
    fn default() -> Self {
        TubeTolerance { relative: 0.002, absolute: 0.0, time: None }
    }
}

/// What came out for all signals.
#[derive(Clone, Debug, Serialize)]
pub struct TrajectoryComparison {
    /// True when no signal left its tube.
    pub within: bool,
    /// One entry a pair of signals, in the order asked for.
    pub signals: Vec<SignalComparison>,
}

/// What came out for one signal. Numbers are in the reference's unit.
#[derive(Clone, Debug, Serialize)]
pub struct SignalComparison {
    /// The name in the reference.
    pub name: String,
    /// The name in the result, where it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<String>,
    /// The unit of the reference; empty where unknown.
    pub unit: String,
    /// Root mean square of the difference over the reference's rows; `None` where nothing could be compared.
    pub rmse: Option<f64>,
    /// `rmse` over the root mean square of the reference; `None` where that is zero.
    pub normalised: Option<f64>,
    /// The largest difference.
    pub maximum: Option<f64>,
    /// The time of the largest difference in seconds.
    pub maximum_at: Option<f64>,
    /// Seconds by which the result comes later, where both correlate best; `None` for constant and discrete signals.
    pub delay: Option<f64>,
    /// The correlation at that delay.
    pub correlation: Option<f64>,
    /// Half height of the tube.
    pub tolerance: f64,
    /// Half width of the tube in seconds.
    pub time_tolerance: f64,
    /// Points outside the tube.
    pub violations: usize,
    /// Points looked at.
    pub points: usize,
    /// The time of the first point outside, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_violation: Option<f64>,
    /// Why the signal fails although no point lies outside: the result ends early, or there is nothing to compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// True when the signal stays in its tube.
    pub within: bool,
}

/// A curve without empty cells.
struct ComparisonCurve {
    times: Vec<f64>,
    values: Vec<f64>,
    held: bool,
}

impl ComparisonCurve {
    fn new(trajectory: &Trajectory, index: usize) -> Self {
        let column = &trajectory.columns[index];
        let full = trajectory.times.iter().zip(column).filter(|(_, v)| !v.is_nan());
        let (times, values) = full.map(|(&t, &v)| (t, v)).unzip();
        ComparisonCurve { times, values, held: trajectory.signals[index].kind.is_discrete() }
    }

    fn at(&self, time: f64) -> Option<f64> {
        interpolate(&self.times, &self.values, self.held, time)
    }

    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.times.iter().copied().zip(self.values.iter().copied())
    }

    fn span(&self) -> f64 {
        self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Half height of the tube for a relative and an absolute part.
    fn height(&self, tolerance: TubeTolerance) -> f64 {
        let low = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = if high > low { high - low } else { high.abs() };
        tolerance.absolute + if range.is_finite() { tolerance.relative * range } else { 0.0 }
    }
}

/// Compares pairs of signals: index in the reference, index in the result. Times are compared as they stand.
pub fn compare(
    reference: &Trajectory,
    result: &Trajectory,
    pairs: &[(usize, usize)],
    tolerance: TubeTolerance,
) -> TrajectoryComparison {
    let signals: Vec<SignalComparison> =
        pairs.iter().map(|&(a, b)| compare_signal(reference, result, a, b, tolerance)).collect();
    TrajectoryComparison { within: signals.iter().all(|s| s.within), signals }
}

fn compare_signal(
    reference: &Trajectory,
    result: &Trajectory,
    a: usize,
    b: usize,
    tolerance: TubeTolerance,
) -> SignalComparison {
    let (signal, other) = (&reference.signals[a], &result.signals[b]);
    let mut left = ComparisonCurve::new(reference, a);
    let mut right = ComparisonCurve::new(result, b);
    align_literals(&mut right, &signal.kind, &other.kind);
    left.held |= right.held;
    right.held |= left.held;
    let time_tolerance = tolerance.time.unwrap_or(tolerance.relative * left.span());
    let mut out = SignalComparison {
        name: signal.name.clone(),
        other: (signal.name != other.name).then(|| other.name.clone()),
        unit: signal.unit.clone(),
        rmse: None,
        normalised: None,
        maximum: None,
        maximum_at: None,
        delay: None,
        correlation: None,
        tolerance: left.height(tolerance),
        time_tolerance,
        violations: 0,
        points: 0,
        first_violation: None,
        reason: None,
        within: false,
    };
    differences(&mut out, &left, &right);
    if !left.held
        && let Some((shift, score)) = delay((&left.times, &left.values), (&right.times, &right.values))
    {
        (out.delay, out.correlation) = (Some(shift), Some(score));
    }
    violations(&mut out, &left, &right);
    out.reason = reason(&out, &left, &right);
    out.within = out.violations == 0 && out.reason.is_none();
    out
}

/// Two files may number the literals of an enumeration differently: the result's numbers become the reference's.
fn align_literals(curve: &mut ComparisonCurve, reference: &Kind, result: &Kind) {
    let (Kind::Enumeration(ours), Kind::Enumeration(theirs)) = (reference, result) else { return };
    for value in &mut curve.values {
        let literal = theirs.get(*value as usize - 1);
        let place = literal.and_then(|l| ours.iter().position(|o| o == l));
        *value = place.map_or(ours.len() as f64 + *value, |p| p as f64 + 1.0);
    }
}

/// Root mean square and largest difference over the reference's rows that the result covers.
fn differences(out: &mut SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) {
    let (mut sum, mut size, mut n) = (0.0, 0.0, 0.0);
    let mut largest: Option<(f64, f64)> = None;
    for (k, (time, value)) in left.points().enumerate() {
        let Some(other) = nearest_side(right, time, left.times.get(k + 1) == Some(&time)) else { continue };
        let difference = (other - value).abs();
        n += 1.0;
        sum += difference * difference;
        size += value * value;
        if largest.is_none_or(|(d, _)| difference > d) {
            largest = Some((difference, time));
        }
    }
    if n > 0.0 {
        let rmse = f64::sqrt(sum / n);
        out.rmse = Some(rmse);
        out.normalised = (size > 0.0).then(|| rmse / f64::sqrt(size / n));
        (out.maximum, out.maximum_at) = largest.unzip();
    }
}

/// The curve at a time; before the event where the asker stands before it and the curve jumps there too.
fn nearest_side(curve: &ComparisonCurve, time: f64, before: bool) -> Option<f64> {
    let first = curve.times.partition_point(|&t| t < time);
    if before && curve.times.get(first) == Some(&time) {
        return curve.values.get(first).copied();
    }
    curve.at(time)
}

/// Counts the result's points, and its values at the reference's times, that lie outside the tube.
fn violations(out: &mut SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) {
    let mut tube = ToleranceTube::new(&left.times, &left.values, left.held, out.time_tolerance, out.tolerance);
    let between = left.times.iter().filter(|&&t| right.times.binary_search_by(|x| x.total_cmp(&t)).is_err());
    let between = between.filter_map(|&t| right.at(t).map(|v| (t, v)));
    let mut points: Vec<(f64, f64)> = right.points().chain(between).collect();
    points.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (time, value) in points {
        let Some((low, high)) = tube.at(time) else { continue };
        out.points += 1;
        // The edges carry rounding errors of the interpolation.
        let slack = 1e-12 * low.abs().max(high.abs());
        if value < low - slack || value > high + slack {
            out.violations += 1;
            out.first_violation.get_or_insert(time);
        }
    }
}

fn reason(out: &SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) -> Option<String> {
    let (Some(&end), Some(&start)) = (left.times.last(), left.times.first()) else {
        return Some("the reference holds no value".to_owned());
    };
    let (Some(&last), Some(&first)) = (right.times.last(), right.times.first()) else {
        return Some("the result holds no value".to_owned());
    };
    let slack = out.time_tolerance + 1e-9 * left.span();
    if out.points == 0 {
        Some("the two share no time".to_owned())
    } else if last < end - slack {
        Some(format!("the result ends at {last} s, the reference at {end} s"))
    } else if first > start + slack {
        Some(format!("the result begins at {first} s, the reference at {start} s"))
    } else {
        None
    }
}

/// The edges of the tube around a signal, for pictures: times, lower and upper edge.
pub fn tube(reference: &Trajectory, index: usize, height: f64, width: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let curve = ComparisonCurve::new(reference, index);
    let mut tube = ToleranceTube::new(&curve.times, &curve.values, curve.held, width, height);
    // The edges bend half a width before and after each point.
    let mut times: Vec<f64> = curve.times.iter().flat_map(|&t| [t - width, t, t + width]).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut edges = (Vec::new(), Vec::new(), Vec::new());
    let (start, end) = (curve.times.first().copied(), curve.times.last().copied());
    for time in times.into_iter().filter(|&t| Some(t) >= start && Some(t) <= end) {
        if let Some((low, high)) = tube.at(time) {
            edges.0.push(time);
            edges.1.push(low);
            edges.2.push(high);
        }
    }
    edges
}

#[cfg(test)]
#[path = "compare_tests.rs"]
mod tests;
