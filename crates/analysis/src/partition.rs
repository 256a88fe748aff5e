//! Zones of a pump's flow over its speed at a load: dead zone, load zone and saturation zone.
//!
//! A prepared model and an operating point enter; [`curve`] returns flow over speed by a chain of operating points, and
//! [`zones`] fits the zones. `bramah partition` calls it.
//!
//! In the load zone the flow is a straight line over the speed. It begins where the pump just covers its leakage, and
//! ends where the flow no longer follows the speed. Source: Zhang et al., Processes 2021, 9, 814, section 2 and Fig. 2.

use super::LocalEvaluator;
use super::linear::LinearizationSetup;
use super::steady::{OperatingPoint, SteadyStateError, reach};
use bramah_expr::VarId;

/// A speed at which no operating point was found.
#[derive(Clone, Debug)]
pub struct OperatingPointFailure {
    /// The speed, in the unit of its variable.
    pub speed: f64,
    /// The reason.
    pub why: SteadyStateError,
}

/// The flow (the first output of `local`) over ascending speeds at a load.
///
/// The operating point is followed from the slowest speed to both sides. Returns the point at the slowest speed, from
/// which another load can be reached, and pairs of speed and flow.
///
/// # Errors
/// [`OperatingPointFailure`].
pub fn curve(
    chosen: &LinearizationSetup,
    local: &mut LocalEvaluator,
    from: &OperatingPoint,
    (speed, speeds): (VarId, &[f64]),
    load: Option<(VarId, f64)>,
) -> Result<(OperatingPoint, Vec<(f64, f64)>), OperatingPointFailure> {
    let mut points = vec![(0.0, 0.0); speeds.len()];
    let mut go = |from: &OperatingPoint, i: usize| {
        let target: Vec<(VarId, f64)> = load.into_iter().chain([(speed, speeds[i])]).collect();
        let point =
            reach(chosen, local, from, &target).map_err(|why| OperatingPointFailure { speed: speeds[i], why })?;
        points[i] = (speeds[i], local.outputs[0]);
        Ok(point)
    };
    let Some(slowest) = (0..speeds.len()).min_by(|&a, &b| speeds[a].abs().total_cmp(&speeds[b].abs())) else {
        return Ok((from.clone(), points));
    };
    let first = go(from, slowest)?;
    (slowest + 1..speeds.len()).try_fold(first.clone(), |from, i| go(&from, i))?;
    (0..slowest).rev().try_fold(first.clone(), |from, i| go(&from, i))?;
    Ok((first, points))
}

/// The zones of one direction of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowCharacteristic {
    /// Speed at which the line of the load zone crosses zero flow: the end of the dead zone.
    pub dead: f64,
    /// Slope of the line, flow over speed.
    pub slope: f64,
    /// Coefficient of determination of the line in the load zone.
    pub straight: f64,
    /// Speed at which the line reaches the largest flow; `None` where the curve ends in the load zone.
    pub saturation: Option<f64>,
}

/// Intervals with a slope above this share of the usual one belong to the load zone: halfway to that of flat zones.
const LOADED: f64 = 0.5;
/// Smallest number of inner points for a line.
const LEAST: usize = 3;

/// The zones for positive and for negative speeds; `None` where a direction has no load zone with at least three inner
/// points.
///
/// `curve` holds pairs of speed and flow at ascending, distinct speeds.
pub fn zones(curve: &[(f64, f64)]) -> [Option<FlowCharacteristic>; 2] {
    let forward: Vec<(f64, f64)> = curve.iter().copied().filter(|p| p.0 >= 0.0).collect();
    // Rotated about the origin, the negative branch is a positive one.
    let backward: Vec<(f64, f64)> = curve.iter().rev().map(|p| (-p.0, -p.1)).filter(|p| p.0 >= 0.0).collect();
    let mirrored =
        |z: FlowCharacteristic| FlowCharacteristic { dead: -z.dead, saturation: z.saturation.map(|s| -s), ..z };
    [one_way(&forward), one_way(&backward).map(mirrored)]
}

/// The zones of a curve at positive speeds.
fn one_way(curve: &[(f64, f64)]) -> Option<FlowCharacteristic> {
    let slopes: Vec<f64> = curve.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
    let usual = usual_slope(curve, &slopes)?;
    let (from, to) = longest(&slopes, |s| s > LOADED * usual)?;
    // The end points belong to the intervals at which the zones change, so the line leaves them out.
    let inner = curve.get(from + 1..to)?;
    if inner.len() < LEAST {
        return None;
    }
    let (slope, offset, straight) = line(inner);
    let saturation = (to + 1 < curve.len()).then(|| {
        let above = &curve[to + 1..];
        let most = above.iter().map(|p| p.1).sum::<f64>() / above.len() as f64;
        (most - offset) / slope
    });
    Some(FlowCharacteristic { dead: -offset / slope, slope, straight, saturation })
}

/// The median slope, weighted by rise: half of the total rise is made at slopes up to it.
///
/// Flat zones contribute little rise however long they are, and so do a few steep intervals where a valve opens.
fn usual_slope(curve: &[(f64, f64)], slopes: &[f64]) -> Option<f64> {
    let rise = |i: usize| curve[i + 1].1 - curve[i].1;
    let mut rising: Vec<usize> = (0..slopes.len()).filter(|&i| slopes[i].is_finite() && rise(i) > 0.0).collect();
    rising.sort_by(|&a, &b| slopes[a].total_cmp(&slopes[b]));
    let half = rising.iter().map(|&i| rise(i)).sum::<f64>() / 2.0;
    let mut made = 0.0;
    let reached = rising.into_iter().find(|&i| {
        made += rise(i);
        made >= half
    });
    reached.map(|i| slopes[i])
}

/// The longest sequence of intervals with slopes that hold, as the indices of its first and last point.
fn longest(slopes: &[f64], holds: impl Fn(f64) -> bool) -> Option<(usize, usize)> {
    let mut best: Option<(usize, usize)> = None;
    let mut start = None;
    for i in 0..=slopes.len() {
        match (slopes.get(i).is_some_and(|s| holds(*s)), start) {
            (true, None) => start = Some(i),
            (false, Some(from)) => {
                if best.is_none_or(|(a, b)| i - from > b - a) {
                    best = Some((from, i));
                }
                start = None;
            }
            _ => {}
        }
    }
    best
}

/// Slope, intercept and coefficient of determination of a least-squares line.
fn line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| of(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, xy, yy) = (sum(&|a, _| a * a), sum(&|a, b| a * b), sum(&|_, b| b * b));
    let slope = xy / xx;
    (slope, y - slope * x, if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (-100..=100).map(|i| f64::from(i) * 10.0).map(|n| (n, of(n))).collect()
    }

    #[test]
    fn ends_of_the_line_are_found_between_the_points() {
        let found = zones(&curve(|n| n.signum() * (n.abs() - 43.0).clamp(0.0, 700.0) * 2.0));
        for (zones, sign) in found.into_iter().zip([1.0, -1.0]) {
            let zones = zones.expect("a load zone");
            assert!((zones.dead - sign * 43.0).abs() < 1e-9, "{zones:?}");
            assert!((zones.saturation.expect("it saturates") - sign * 743.0).abs() < 1e-9, "{zones:?}");
            assert!((zones.slope - 2.0).abs() < 1e-12 && zones.straight > 1.0 - 1e-12, "{zones:?}");
        }
    }

    #[test]
    fn leakage_flows_back_below_the_end_of_the_dead_zone() {
        let [forward, _] = zones(&curve(|n| 2.0 * n - 86.0));
        let forward = forward.expect("a load zone");
        assert!((forward.dead - 43.0).abs() < 1e-9 && forward.saturation.is_none());
    }

    #[test]
    fn nothing_rises_nowhere() {
        assert_eq!(zones(&curve(|_| 1.0)), [None, None]);
        assert_eq!(zones(&[]), [None, None]);
        assert_eq!(zones(&[(0.0, 0.0), (1.0, 1.0)]), [None, None]);
    }
}
