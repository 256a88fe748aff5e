//! Compares two trajectories signal by signal: errors, delay, and whether the result stays in a tolerance tube.
//! Reference and result enter, a [`TrajectoryComparison`] leaves. The command `compare` and tests call [`compare`].

use serde::Serialize;

use super::delay::delay;
use super::trajectory::{Kind, Trajectory};
use super::tube::{ToleranceTube, interpolate};

/// The tolerance of a comparison: the half height and half width of the tube around the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeTolerance {
    /// Fraction of the signal's range, the difference of its largest and smallest value. For a constant, of its size.
    pub relative: f64,
    /// Added to the relative part, in the unit of the signal.
    pub absolute: f64,
    /// Half width (s). `None` for `relative` times the duration of the reference.
    pub time: Option<f64>,
}

impl Default for TubeTolerance {
    /// The tolerance of `csv-compare`: 0.2 % of the range, in both directions.
    fn default() -> Self {
        TubeTolerance { relative: 0.002, absolute: 0.0, time: None }
    }
}

/// The result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct TrajectoryComparison {
    /// True if no signal left its tube and none failed for another reason.
    pub within: bool,
    /// One entry for each pair of signals, in the order requested.
    pub signals: Vec<SignalComparison>,
}

/// The result for one signal. Values are in the unit of the reference.
#[derive(Clone, Debug, Serialize)]
pub struct SignalComparison {
    /// The name of the signal in the reference.
    pub name: String,
    /// The name in the result. `None` if it is the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<String>,
    /// The unit of the reference. Empty if it is not known.
    pub unit: String,
    /// The root mean square of the difference at the rows of the reference. `None` if nothing could be compared.
    pub rmse: Option<f64>,
    /// `rmse` divided by the root mean square of the reference. `None` if that is zero.
    pub normalised: Option<f64>,
    /// The largest absolute difference. `None` if nothing could be compared.
    pub maximum: Option<f64>,
    /// The time of the largest difference (s).
    pub maximum_at: Option<f64>,
    /// The shift by which the result comes later, where both correlate best (s). `None` for constant and discrete
    /// signals.
    pub delay: Option<f64>,
    /// The correlation at that delay.
    pub correlation: Option<f64>,
    /// The half height of the tube.
    pub tolerance: f64,
    /// The half width of the tube (s).
    pub time_tolerance: f64,
    /// The number of points outside the tube.
    pub violations: usize,
    /// The number of points that were checked.
    pub points: usize,
    /// The time of the first point outside (s). `None` if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_violation: Option<f64>,
    /// The reason why a signal fails although no point lies outside: it ends early, or there is nothing to compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// True if the signal stays in its tube and does not fail for another reason.
    pub within: bool,
}

/// A signal without its empty cells.
struct ComparisonCurve {
    /// The times of the points (s).
    times: Vec<f64>,
    /// The values of the points.
    values: Vec<f64>,
    /// True if the signal is a staircase.
    held: bool,
}

impl ComparisonCurve {
    /// The curve of a column.
    fn new(trajectory: &Trajectory, index: usize) -> Self {
        let column = &trajectory.columns[index];
        let full = trajectory.times.iter().zip(column).filter(|(_, v)| !v.is_nan());
        let (times, values) = full.map(|(&t, &v)| (t, v)).unzip();
        ComparisonCurve { times, values, held: trajectory.signals[index].kind.is_discrete() }
    }

    /// The value at a time. `None` outside.
    fn at(&self, time: f64) -> Option<f64> {
        interpolate(&self.times, &self.values, self.held, time)
    }

    /// The points as pairs of time and value.
    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.times.iter().copied().zip(self.values.iter().copied())
    }

    /// The duration (s).
    fn span(&self) -> f64 {
        self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// The half height of the tube around the curve.
    fn height(&self, tolerance: TubeTolerance) -> f64 {
        let low = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = if high > low { high - low } else { high.abs() };
        tolerance.absolute + if range.is_finite() { tolerance.relative * range } else { 0.0 }
    }
}

/// Compares pairs of signals, given by their index in the reference and in the result.
/// Times are compared as they are, without a shift.
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

/// Compares one pair of signals.
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
    // A signal that is discrete on one side is compared as a staircase on both.
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
    // A staircase has no useful correlation.
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

/// Makes the numbers of enumeration literals those of the reference, because two files may number them differently.
/// Literals that the reference lacks get numbers beyond its own.
fn align_literals(curve: &mut ComparisonCurve, reference: &Kind, result: &Kind) {
    let (Kind::Enumeration(ours), Kind::Enumeration(theirs)) = (reference, result) else { return };
    for value in &mut curve.values {
        let literal = theirs.get(*value as usize - 1);
        let place = literal.and_then(|l| ours.iter().position(|o| o == l));
        *value = place.map_or(ours.len() as f64 + *value, |p| p as f64 + 1.0);
    }
}

/// Computes the root mean square and the largest difference, at the rows of the reference that the result covers.
fn differences(out: &mut SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) {
    let (mut sum, mut size, mut n) = (0.0, 0.0, 0.0);
    let mut largest: Option<(f64, f64)> = None;
    for (k, (time, value)) in left.points().enumerate() {
        // At an event the row before it is compared with the value before it.
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

/// The value of a curve at a time.
/// With `before`, it is the value before an event, if the curve jumps there too.
fn nearest_side(curve: &ComparisonCurve, time: f64, before: bool) -> Option<f64> {
    let first = curve.times.partition_point(|&t| t < time);
    if before && curve.times.get(first) == Some(&time) {
        return curve.values.get(first).copied();
    }
    curve.at(time)
}

/// Counts the points outside the tube: those of the result, and its values at the times of the reference.
fn violations(out: &mut SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) {
    let mut tube = ToleranceTube::new(&left.times, &left.values, left.held, out.time_tolerance, out.tolerance);
    // A result with few points could cross the tube between them.
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

/// The reason for a failure other than points outside. `None` if there is none.
fn reason(out: &SignalComparison, left: &ComparisonCurve, right: &ComparisonCurve) -> Option<String> {
    let (Some(&end), Some(&start)) = (left.times.last(), left.times.first()) else {
        return Some("the reference holds no value".to_owned());
    };
    let (Some(&last), Some(&first)) = (right.times.last(), right.times.first()) else {
        return Some("the result holds no value".to_owned());
    };
    // The relative part covers rounding of times.
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

/// The edges of the tube around a signal, for plots: times, lower edge, upper edge.
/// `height` and `width` are halves.
pub fn tube(reference: &Trajectory, index: usize, height: f64, width: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let curve = ComparisonCurve::new(reference, index);
    let mut tube = ToleranceTube::new(&curve.times, &curve.values, curve.held, width, height);
    // The edges have corners half a width before and after each point.
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
