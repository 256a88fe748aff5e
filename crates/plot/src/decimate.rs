//! Reduces the points of long curves without a visible change, so that pictures stay small.

/// Points of a curve, each with its horizontal and vertical coordinate.
pub type CurvePoints = Vec<(f64, f64)>;

/// The corners of a staircase in which each value holds until the next point.
pub fn staircase(x: &[f64], y: &[f64]) -> CurvePoints {
    let mut out: CurvePoints = Vec::with_capacity(2 * x.len());
    for (&x, &y) in x.iter().zip(y) {
        // A corner is added only where the value changes.
        if let Some(&(_, last)) = out.last()
            && last != y
        {
            out.push((x, last));
        }
        out.push((x, y));
    }
    out
}

/// Reduces a curve that is drawn `columns` pixels wide.
///
/// The horizontal range is cut into that many equal parts; of each part the first, lowest, highest and last point are
/// kept. The drawn curve looks the same. A curve whose `x` goes back and forth only loses points that are closer than a
/// quarter of such a part in both directions. NaN points stay as gaps.
pub fn decimate(points: CurvePoints, columns: usize) -> CurvePoints {
    // Each part keeps up to four points, so a shorter curve cannot become shorter.
    if points.len() <= 4 * columns {
        return points;
    }
    let forward = points.windows(2).all(|w| w[0].0 <= w[1].0);
    if forward { extremes(&points, columns) } else { thinned(&points, columns) }
}

/// Keeps first, lowest, highest and last point of each part of an ascending curve.
///
/// The points are in ascending order of `x`.
fn extremes(points: &[(f64, f64)], columns: usize) -> CurvePoints {
    let (low, high) = (points[0].0, points[points.len() - 1].0);
    let scale = columns as f64 / (high - low);
    let column = |p: &(f64, f64)| ((p.0 - low) * scale) as usize;
    let mut out = CurvePoints::new();
    // A gap ends a part, so that it is kept.
    for bin in points.chunk_by(|a, b| column(a) == column(b) && a.1.is_nan() == b.1.is_nan()) {
        let mut kept = vec![0, bin.len() - 1];
        let by_value = |i: &usize, j: &usize| bin[*i].1.total_cmp(&bin[*j].1);
        kept.extend((0..bin.len()).min_by(by_value));
        kept.extend((0..bin.len()).max_by(by_value));
        // In their original order, else the line would go backwards.
        kept.sort_unstable();
        kept.dedup();
        out.extend(kept.into_iter().map(|i| bin[i]));
    }
    out
}

/// Drops points close to the last kept one; for curves such as loops.
fn thinned(points: &[(f64, f64)], columns: usize) -> CurvePoints {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.filter(|v| v.is_finite()).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
        // A curve without extent in one direction must not divide by zero.
        (high - low).max(f64::MIN_POSITIVE)
    };
    let dx = range(&mut points.iter().map(|p| p.0)) / (4 * columns) as f64;
    let dy = range(&mut points.iter().map(|p| p.1)) / (4 * columns) as f64;
    let mut out = vec![points[0]];
    for (i, &p) in points.iter().enumerate().skip(1) {
        let last = out[out.len() - 1];
        let near = (p.0 - last.0).abs() < dx && (p.1 - last.1).abs() < dy;
        if !near || i == points.len() - 1 {
            out.push(p);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spikes_survive() {
        let points: CurvePoints = (0..100_000).map(|i| (f64::from(i), if i == 54_321 { 7.0 } else { 0.0 })).collect();
        let short = decimate(points, 500);
        assert!(short.len() <= 2_000, "{}", short.len());
        assert!(short.contains(&(54_321.0, 7.0)));
        assert_eq!((short[0].0, short[short.len() - 1].0), (0.0, 99_999.0));
    }

    #[test]
    fn loops_keep_their_shape() {
        let circle: CurvePoints = (0..100_000).map(|i| (f64::from(i) * 1e-3).sin_cos()).collect();
        let short = decimate(circle, 100);
        assert!(short.len() < 40_000);
        assert!(short.iter().any(|p| p.0 > 0.999) && short.iter().any(|p| p.1 < -0.999));
    }

    #[test]
    fn gaps_and_steps() {
        assert_eq!(staircase(&[0.0, 1.0, 2.0], &[5.0, 5.0, 6.0]), [(0.0, 5.0), (1.0, 5.0), (2.0, 5.0), (2.0, 6.0)]);
        let mut points: CurvePoints = (0..1000).map(|i| (f64::from(i), 1.0)).collect();
        points[500].1 = f64::NAN;
        assert!(decimate(points, 10).iter().any(|p| p.1.is_nan()));
    }
}
