//! Zones of the flow over the speed of a pump under a load: dead, load and saturation zone.
//!
//! In the load zone the flow is a straight line over the speed. It ends below where the pump just covers its leakage,
//! above where the flow follows the speed no longer. Source: Zhang et al., Processes 2021, 9, 814, section 2 and Fig.
//! 2.

use super::LocalEvaluator;
use super::linear::LinearizationSetup;
use super::steady::{OperatingPoint, SteadyStateError, reach};
use bramah_expr::VarId;

/// No operating point was found at a speed.
#[derive(Clone, Debug)]
pub struct OperatingPointFailure {
    /// The speed.
    pub speed: f64,
    /// Why.
    pub why: SteadyStateError,
}

/// Flow, the first output of `local`, over increasing speeds at a load: the operating point is followed from the
/// slowest speed to either side. The point at the slowest speed comes with it, from which another load is reached.
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

/// What a curve of flow over speed says of one direction of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowCharacteristic {
    /// Speed at which the line of the load zone has no flow: the end of the dead zone.
    pub dead: f64,
    /// Flow over speed in the load zone.
    pub slope: f64,
    /// Share of the variance in the load zone that the line explains.
    pub straight: f64,
    /// Speed at which the line reaches the flow that is not exceeded; `None` where the curve ends before.
    pub saturation: Option<f64>,
}

/// Intervals whose slope is above this part of the usual one belong to the load zone: half way between it and the flat
/// zones.
const LOADED: f64 = 0.5;
/// Points that a line needs beside its ends.
const LEAST: usize = 3;

/// The zones for positive speeds, and for negative ones with the sign of the curve; `None` where a direction has no
/// load zone of at least three points.
///
/// `curve` holds speed and flow, the speeds increasing, none twice.
pub fn zones(curve: &[(f64, f64)]) -> [Option<FlowCharacteristic>; 2] {
    let forward: Vec<(f64, f64)> = curve.iter().copied().filter(|p| p.0 >= 0.0).collect();
    let backward: Vec<(f64, f64)> = curve.iter().rev().map(|p| (-p.0, -p.1)).filter(|p| p.0 >= 0.0).collect();
    let mirrored =
        |z: FlowCharacteristic| FlowCharacteristic { dead: -z.dead, saturation: z.saturation.map(|s| -s), ..z };
    [one_way(&forward), one_way(&backward).map(mirrored)]
}

fn one_way(curve: &[(f64, f64)]) -> Option<FlowCharacteristic> {
    let slopes: Vec<f64> = curve.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
    let usual = usual_slope(curve, &slopes)?;
    let (from, to) = longest(&slopes, |s| s > LOADED * usual)?;
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

/// The slope up to which half of the whole rise is made: flat zones add little to it however long they are, and a few
/// steep intervals, where a valve opens, not much.
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

/// The longest run of intervals that hold, as the indices of its first and last point.
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

/// Slope and intercept by least squares, and the share of the variance that the line explains.
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
