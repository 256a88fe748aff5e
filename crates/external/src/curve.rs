//! Curves through points, as `ModelicaStandardTables` of the Modelica Standard Library draws them.
//! Abscissae and values enter; a piecewise constant, linear or cubic function leaves, with its derivatives.
//! `time_table` uses one for each column, `surface` uses the slopes along both axes.
//!
//! Points with equal abscissae separate a curve into runs, between which it jumps. Each run is interpolated on its own.

use super::options::{Extrapolation, Smoothness};

/// One curve: a polynomial for each interval, and a rule for arguments outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TableCurve {
    /// The abscissa at which each piece begins, strictly ascending.
    starts: Vec<f64>,
    /// The coefficients of each piece by powers of the distance from its start, constant first.
    pieces: Vec<[f64; 4]>,
    /// The abscissa at which the last piece ends.
    /// The value at `end`, right of a jump that may be there.
    end: f64,
    /// The value at the first abscissa, left of a jump that may be there.
    last: f64,
    /// The kind of pieces.
    first: f64,
    /// The rule outside.
    smoothness: Smoothness,
    extrapolation: Extrapolation,
}

impl TableCurve {
    /// Interpolates points whose abscissae do not decrease. There is at least one point; two equal abscissae make a
    /// jump.
    pub fn new(x: &[f64], y: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> Self {
        let (mut starts, mut pieces) = (Vec::new(), Vec::new());
        for run in continuous(x) {
            let (x, y) = (&x[run.clone()], &y[run]);
            for (k, piece) in run_pieces(x, y, smoothness, extrapolation).into_iter().enumerate() {
                starts.push(x[k]);
                pieces.push(piece);
            }
        }
        // A single point, or only jumps at one place: the curve is constant.
        if pieces.is_empty() {
            starts.push(x[0]);
            pieces.push([y[y.len() - 1], 0.0, 0.0, 0.0]);
        }
        TableCurve { starts, pieces, end: x[x.len() - 1], last: y[y.len() - 1], first: y[0], smoothness, extrapolation }
    }

    /// The smallest abscissa.
    /// Tables give it as `minimumAbscissa`.
    pub fn from(&self) -> f64 {
        self.starts[0]
    }

    /// Tables give it as `maximumAbscissa`.
    /// The largest abscissa.
    pub fn to(&self) -> f64 {
        self.end
    }

    /// The value, or the derivative of this order.
    /// Where two pieces meet, the right one counts, or the left one if `left` is true.
    /// NaN outside if nothing is to be extrapolated.
    pub fn value(&self, u: f64, order: usize, left: bool) -> f64 {
        let (from, to) = (self.from(), self.end);
        // A curve of one point has no period and no slope: it is constant everywhere.
        let single = from == to;
        if single || (from..=to).contains(&u) {
            return self.inside(u, order, left);
        }
        match self.extrapolation {
            Extrapolation::Periodic => self.inside(self.wrapped(u, left), order, left),
            Extrapolation::None => f64::NAN,
            Extrapolation::Hold => constant(if u < from { self.first } else { self.last }, order),
            Extrapolation::Slope => self.beyond(u, order),
        }
    }

    /// The abscissa of the first period that corresponds to `u`.
    /// Seen from the left, the end of a period belongs to the period before.
    pub fn wrapped(&self, u: f64, left: bool) -> f64 {
        let (from, period) = (self.from(), self.end - self.from());
        let turned = from + (u - from).rem_euclid(period);
        if left && turned <= from { self.end } else { turned }
    }

    /// The value or derivative at an abscissa within the range of the curve.
    /// From the left, the first point belongs to what lies before it.
    fn inside(&self, u: f64, order: usize, left: bool) -> f64 {
        if left && u <= self.from() {
            return constant(self.first, order);
        }
        let before = |s: &f64| if left { *s < u } else { *s <= u };
        let at = self.starts.partition_point(before).max(1) - 1;
        // A step curve takes its last value at the end, where no piece begins any more.
        let constant_at_end = self.smoothness == Smoothness::Constant && !left && u >= self.end;
        if constant_at_end && self.extrapolation != Extrapolation::Periodic {
            return constant(self.last, order);
        }
        cubic(&self.pieces[at], u - self.starts[at], order)
    }

    /// Continues the curve outside in a straight line with the slope of its end.
    /// The slope outside is constant, and higher derivatives are 0.
    fn beyond(&self, u: f64, order: usize) -> f64 {
        let (edge, value, slope) = if u < self.from() {
            (self.from(), self.first, self.pieces[0][1])
        } else {
            let at = self.pieces.len() - 1;
            (self.end, self.last, cubic(&self.pieces[at], self.end - self.starts[at], 1))
        };
        match order {
            0 => value + slope * (u - edge),
            1 => slope,
            _ => 0.0,
        }
    }
}

/// The derivative of a constant: the value itself for order 0, else 0.
fn constant(value: f64, order: usize) -> f64 {
    if order == 0 { value } else { 0.0 }
}

/// The value or derivative of a cubic at distance `d` from the start of its piece.
/// Orders above 3 give 0.
fn cubic(c: &[f64; 4], d: f64, order: usize) -> f64 {
    match order {
        0 => c[0] + ((c[3] * d + c[2]) * d + c[1]) * d,
        1 => c[1] + (3.0 * c[3] * d + 2.0 * c[2]) * d,
        2 => 2.0 * c[2] + 6.0 * c[3] * d,
        3 => 6.0 * c[3],
        _ => 0.0,
    }
}

/// The ranges of points between jumps, in order. Each has at least one point.
/// Jumps separate them.
fn continuous(x: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut begin = 0;
    for k in 1..=x.len() {
        if k == x.len() || x[k] == x[k - 1] {
            runs.push(begin..k);
            begin = k;
        }
    }
    runs
}

/// The pieces of one run, one fewer than its points. A run of one point has none.
/// Coefficients are in powers of the distance from the start, constant first.
fn run_pieces(x: &[f64], y: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> Vec<[f64; 4]> {
    let n = x.len();
    if n < 2 {
        return Vec::new();
    }
    let secants: Vec<f64> = (0..n - 1).map(|k| (y[k + 1] - y[k]) / (x[k + 1] - x[k])).collect();
    if smoothness == Smoothness::Constant {
        return y[..n - 1].iter().map(|y| [*y, 0.0, 0.0, 0.0]).collect();
    }
    // Two points determine a line, whatever the method.
    if n == 2 || smoothness == Smoothness::Linear {
        return y.iter().zip(&secants).map(|(y, s)| [*y, *s, 0.0, 0.0]).collect();
    }
    let slopes = slopes(x, &secants, smoothness, extrapolation == Extrapolation::Periodic);
    // The cubic with the given values and slopes at both ends (Hermite).
    let piece = |k: usize| {
        let (h, s) = (x[k + 1] - x[k], secants[k]);
        let square = (3.0 * s - 2.0 * slopes[k] - slopes[k + 1]) / h;
        [y[k], slopes[k], square, (slopes[k] + slopes[k + 1] - 2.0 * s) / (h * h)]
    };
    (0..n - 1).map(piece).collect()
}

/// The slope of a cubic curve at each point, from the secants between neighbours.
/// There is one secant fewer than points, and at least two.
/// `smoothness` must be one of the cubic kinds.
pub fn slopes(x: &[f64], secants: &[f64], smoothness: Smoothness, periodic: bool) -> Vec<f64> {
    match smoothness {
        Smoothness::Akima | Smoothness::ModifiedAkima => {
            akima(secants, smoothness == Smoothness::ModifiedAkima, periodic)
        }
        _ => monotone(x, secants, smoothness == Smoothness::Steffen),
    }
}

/// Akima's slopes (J. ACM 17 (1970) 589): the mean of the secants on both sides.
/// Each secant is weighted by how much the curve bends on the other side, so that a corner does not disturb its
/// surroundings.
/// `modified` adds the mean size of the secants to the weights, so that level parts stay level.
/// There is one slope for each point, which is one more than secants.
fn akima(secants: &[f64], modified: bool, periodic: bool) -> Vec<f64> {
    let n = secants.len();
    // The weights need two secants beyond each end: those of the next period, or linear extrapolations of the secants.
    let mut d = vec![0.0; n + 4];
    d[2..n + 2].copy_from_slice(secants);
    if periodic {
        (d[0], d[1], d[n + 2], d[n + 3]) = (secants[n - 2], secants[n - 1], secants[0], secants[1]);
    } else {
        d[1] = 2.0 * d[2] - d[3];
        d[0] = 2.0 * d[1] - d[2];
        d[n + 2] = 2.0 * d[n + 1] - d[n];
        d[n + 3] = 2.0 * d[n + 2] - d[n + 1];
    }
    let bend = |a: f64, b: f64| (b - a).abs() + if modified { 0.5 * (b + a).abs() } else { 0.0 };
    let slope = |k: usize| {
        let (left, right) = (bend(d[k], d[k + 1]), bend(d[k + 2], d[k + 3]));
        let sum = left + right;
        // Without any bend on both sides the weights are undefined; the plain mean is taken.
        if sum > 0.0 {
            (right * d[k + 1] + left * d[k + 2]) / sum
        } else if modified {
            0.0
        } else {
            0.5 * (d[k + 1] + d[k + 2])
        }
    };
    (0..=n).map(slope).collect()
}

/// Slopes that make no extremum between points.
/// Methods: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300; Steffen, Astron. Astrophys. 239 (1990) 443.
/// The end points have the slope of the secant there.
fn monotone(x: &[f64], secants: &[f64], steffen: bool) -> Vec<f64> {
    let n = secants.len();
    let slope = |k: usize| {
        if k == 0 || k == n {
            return secants[k.min(n - 1)];
        }
        let (a, b) = (secants[k - 1], secants[k]);
        // At a local extremum of the points the slope must be 0.
        if a * b <= 0.0 {
            return 0.0;
        }
        let (before, after) = (x[k] - x[k - 1], x[k + 1] - x[k]);
        if steffen {
            let half = 0.5 * ((a * after + b * before) / (before + after)).abs();
            return 2.0 * half.min(a.abs()).min(b.abs()) * a.signum();
        }
        3.0 * (before + after) / ((before + 2.0 * after) / a + (2.0 * before + after) / b)
    };
    (0..=n).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(y: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> TableCurve {
        let x: Vec<f64> = (0..y.len()).map(|k| k as f64).collect();
        TableCurve::new(&x, y, smoothness, extrapolation)
    }

    #[test]
    fn cubic_curves_meet_their_points_and_lines_stay_lines() {
        use Smoothness::{Akima, FritschButland, ModifiedAkima, Steffen};
        for smoothness in [Akima, FritschButland, Steffen, ModifiedAkima] {
            let y = [0.0, 1.0, 0.5, 2.0, 2.0, 5.0];
            let curve = through(&y, smoothness, Extrapolation::Slope);
            for (k, y) in y.iter().enumerate() {
                let off = [false, true].map(|left| (curve.value(k as f64, 0, left) - y).abs());
                assert!(off.iter().all(|o| *o < 1e-12), "{smoothness:?} at {k}: {off:?}");
            }
            let line = through(&[1.0, 3.0, 5.0, 7.0], smoothness, Extrapolation::Slope);
            for u in [-2.0, 0.3, 1.7, 9.0] {
                assert!((line.value(u, 0, false) - 1.0 - 2.0 * u).abs() < 1e-12, "{smoothness:?} at {u}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let curve = through(&[0.0, 1.0, 0.5, 2.0, 2.0], Smoothness::Akima, Extrapolation::Slope);
        for u in [-1.0, 0.4, 1.5, 2.2, 3.9, 6.0] {
            for order in [0, 1] {
                let h = 1e-6;
                let difference = (curve.value(u + h, order, false) - curve.value(u - h, order, false)) / (2.0 * h);
                assert!((difference - curve.value(u, order + 1, false)).abs() < 1e-5, "{order} at {u}");
            }
        }
    }

    #[test]
    fn monotone_points_make_monotone_curves() {
        for smoothness in [Smoothness::FritschButland, Smoothness::Steffen] {
            let curve = through(&[0.0, 0.0, 0.1, 4.0, 4.1, 9.0], smoothness, Extrapolation::Hold);
            let values: Vec<f64> = (0..=500).map(|k| curve.value(f64::from(k) / 100.0, 0, false)).collect();
            assert!(values.windows(2).all(|w| w[1] >= w[0] - 1e-12), "{smoothness:?}");
        }
    }

    #[test]
    fn outside_as_asked() {
        let at = |extrapolation, u| through(&[1.0, 2.0, 4.0], Smoothness::Linear, extrapolation).value(u, 0, false);
        assert_eq!((at(Extrapolation::Hold, -1.0), at(Extrapolation::Hold, 5.0)), (1.0, 4.0));
        assert_eq!((at(Extrapolation::Slope, -1.0), at(Extrapolation::Slope, 3.0)), (0.0, 6.0));
        assert_eq!((at(Extrapolation::Periodic, 2.5), at(Extrapolation::Periodic, -0.5)), (1.5, 3.0));
        assert!(at(Extrapolation::None, 2.5).is_nan());
    }

    #[test]
    fn a_jump_has_two_sides() {
        let curve =
            TableCurve::new(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0], Smoothness::Linear, Extrapolation::Hold);
        assert_eq!((curve.value(1.0, 0, true), curve.value(1.0, 0, false)), (1.0, 5.0));
        let on = TableCurve::new(&[2.0, 2.0, 4.0], &[0.0, 1.0, 0.0], Smoothness::Constant, Extrapolation::Hold);
        assert_eq!([1.0, 2.0, 3.0, 5.0].map(|u| on.value(u, 0, false)), [0.0, 1.0, 1.0, 0.0]);
        let steps = through(&[1.0, 2.0, 3.0], Smoothness::Constant, Extrapolation::Hold);
        assert_eq!(
            (steps.value(1.0, 0, true), steps.value(1.0, 0, false), steps.value(2.0, 0, false)),
            (1.0, 2.0, 3.0)
        );
    }
}
