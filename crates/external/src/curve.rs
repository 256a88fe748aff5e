//! Curves through points, as `ModelicaStandardTables` draws them: piecewise constant, linear, or cubic with the slopes of
//! Akima and others.

use super::options::{Extrapolation, Smoothness};

/// One curve: pieces between abscissae, and what lies outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TableCurve {
    /// Where each piece begins, growing.
    starts: Vec<f64>,
    /// Coefficients of each over the distance from its start, from the constant up.
    pieces: Vec<[f64; 4]>,
    /// Where the last piece ends, the value there, and the value where the first one begins: a jump may lie at both.
    end: f64,
    last: f64,
    first: f64,
    smoothness: Smoothness,
    extrapolation: Extrapolation,
}

impl TableCurve {
    /// Through points whose abscissae do not decrease; two equal ones make a jump. At least one point.
    pub fn new(x: &[f64], y: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> Self {
        let (mut starts, mut pieces) = (Vec::new(), Vec::new());
        for run in continuous(x) {
            let (x, y) = (&x[run.clone()], &y[run]);
            for (k, piece) in run_pieces(x, y, smoothness, extrapolation).into_iter().enumerate() {
                starts.push(x[k]);
                pieces.push(piece);
            }
        }
        if pieces.is_empty() {
            starts.push(x[0]);
            pieces.push([y[y.len() - 1], 0.0, 0.0, 0.0]);
        }
        TableCurve { starts, pieces, end: x[x.len() - 1], last: y[y.len() - 1], first: y[0], smoothness, extrapolation }
    }

    /// The least abscissa.
    pub fn from(&self) -> f64 {
        self.starts[0]
    }

    /// The largest abscissa.
    pub fn to(&self) -> f64 {
        self.end
    }

    /// The value, or a derivative of this order; where two pieces meet of the right one, or of the left one. Not a number
    /// where nothing is to be extrapolated.
    pub fn value(&self, u: f64, order: usize, left: bool) -> f64 {
        let (from, to) = (self.from(), self.end);
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

    /// An abscissa of the first period. What is asked from the left does not begin it.
    pub fn wrapped(&self, u: f64, left: bool) -> f64 {
        let (from, period) = (self.from(), self.end - self.from());
        let turned = from + (u - from).rem_euclid(period);
        if left && turned <= from { self.end } else { turned }
    }

    fn inside(&self, u: f64, order: usize, left: bool) -> f64 {
        if left && u <= self.from() {
            return constant(self.first, order);
        }
        let before = |s: &f64| if left { *s < u } else { *s <= u };
        let at = self.starts.partition_point(before).max(1) - 1;
        let constant_at_end = self.smoothness == Smoothness::Constant && !left && u >= self.end;
        if constant_at_end && self.extrapolation != Extrapolation::Periodic {
            return constant(self.last, order);
        }
        cubic(&self.pieces[at], u - self.starts[at], order)
    }

    /// On with the slope of the end.
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

fn constant(value: f64, order: usize) -> f64 {
    if order == 0 { value } else { 0.0 }
}

fn cubic(c: &[f64; 4], d: f64, order: usize) -> f64 {
    match order {
        0 => c[0] + ((c[3] * d + c[2]) * d + c[1]) * d,
        1 => c[1] + (3.0 * c[3] * d + 2.0 * c[2]) * d,
        2 => 2.0 * c[2] + 6.0 * c[3] * d,
        3 => 6.0 * c[3],
        _ => 0.0,
    }
}

/// Ranges of points between jumps.
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

fn run_pieces(x: &[f64], y: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> Vec<[f64; 4]> {
    let n = x.len();
    if n < 2 {
        return Vec::new();
    }
    let secants: Vec<f64> = (0..n - 1).map(|k| (y[k + 1] - y[k]) / (x[k + 1] - x[k])).collect();
    if smoothness == Smoothness::Constant {
        return y[..n - 1].iter().map(|y| [*y, 0.0, 0.0, 0.0]).collect();
    }
    if n == 2 || smoothness == Smoothness::Linear {
        return y.iter().zip(&secants).map(|(y, s)| [*y, *s, 0.0, 0.0]).collect();
    }
    let slopes = slopes(x, &secants, smoothness, extrapolation == Extrapolation::Periodic);
    let piece = |k: usize| {
        let (h, s) = (x[k + 1] - x[k], secants[k]);
        let square = (3.0 * s - 2.0 * slopes[k] - slopes[k + 1]) / h;
        [y[k], slopes[k], square, (slopes[k] + slopes[k + 1] - 2.0 * s) / (h * h)]
    };
    (0..n - 1).map(piece).collect()
}

/// The slope at each point of a cubic curve.
pub fn slopes(x: &[f64], secants: &[f64], smoothness: Smoothness, periodic: bool) -> Vec<f64> {
    match smoothness {
        Smoothness::Akima | Smoothness::ModifiedAkima => {
            akima(secants, smoothness == Smoothness::ModifiedAkima, periodic)
        }
        _ => monotone(x, secants, smoothness == Smoothness::Steffen),
    }
}

/// Akima, J. ACM 17 (1970) 589: the mean of the secants on both sides, each weighed by how much the other side bends.
fn akima(secants: &[f64], modified: bool, periodic: bool) -> Vec<f64> {
    let n = secants.len();
    // two secants more on each side
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

/// Slopes that make no extremum between points: Fritsch, Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300; Steffen, Astron.
/// Astrophys. 239 (1990) 443.
fn monotone(x: &[f64], secants: &[f64], steffen: bool) -> Vec<f64> {
    let n = secants.len();
    let slope = |k: usize| {
        if k == 0 || k == n {
            return secants[k.min(n - 1)];
        }
        let (a, b) = (secants[k - 1], secants[k]);
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
