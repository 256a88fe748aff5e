//! Surfaces over a grid, as `CombiTable2D` of the Modelica Standard Library has them.
//! Two axes and the values at their crossings enter; a function of two arguments leaves, with its derivatives.
//!
//! In each cell the surface is constant, bilinear, or bicubic with Akima's slopes along both axes.
//! A value is a sum over the four corners of a cell of products of weights, one factor for each axis.

use super::curve::slopes;
use super::options::{Extrapolation, Smoothness};

/// Values over a grid of ascending abscissae.
#[derive(Clone, Debug, PartialEq)]
pub struct TableSurface {
    /// The abscissae of both axes, strictly ascending.
    axes: [Vec<f64>; 2],
    /// At each point: the value, its derivative along the first axis, along the second, and the mixed one. Row by row.
    /// Derivatives are 0 unless the surface is bicubic.
    points: Vec<[f64; 4]>,
    /// The kind of surface.
    smoothness: Smoothness,
    /// The rule outside the grid.
    extrapolation: Extrapolation,
}

/// The position of an argument along one axis.
struct GridPosition {
    /// The index of the point before it.
    at: usize,
    /// The share of the distance to the next point, 0 to 1.
    share: f64,
    /// The distance between both points.
    width: f64,
    /// How far the argument lies beyond the end, for linear extrapolation. Else 0.
    beyond: f64,
    /// False if the value does not depend on the argument, because it is held at the end or the axis has one point.
    moves: bool,
}

impl TableSurface {
    /// Builds a surface. `values` are row by row, one row for each abscissa of the first axis.
    /// Both axes have at least one point.
    pub fn new(axes: [Vec<f64>; 2], values: &[f64], smoothness: Smoothness, extrapolation: Extrapolation) -> Self {
        let [n, m] = [axes[0].len(), axes[1].len()];
        let cubic = !matches!(smoothness, Smoothness::Linear | Smoothness::Constant);
        let mut points: Vec<[f64; 4]> = values.iter().map(|v| [*v, 0.0, 0.0, 0.0]).collect();
        if cubic {
            let periodic = extrapolation == Extrapolation::Periodic;
            let along = |axis: &[f64], line: &[f64]| line_slopes(axis, line, periodic);
            // First the slopes along the first axis, column by column.
            for j in 0..m {
                let line: Vec<f64> = (0..n).map(|i| values[i * m + j]).collect();
                along(&axes[0], &line).into_iter().enumerate().for_each(|(i, s)| points[i * m + j][1] = s);
            }
            // Then those along the second axis, of the values and of the slopes just found, which gives the mixed
            // derivatives.
            for i in 0..n {
                for (from, to) in [(0, 2), (1, 3)] {
                    let line: Vec<f64> = (0..m).map(|j| points[i * m + j][from]).collect();
                    along(&axes[1], &line).into_iter().enumerate().for_each(|(j, s)| points[i * m + j][to] = s);
                }
            }
        }
        TableSurface { axes, points, smoothness, extrapolation }
    }

    /// The smallest abscissa of each axis, then the largest of each.
    /// Tables give them as minimum and maximum abscissae.
    pub fn range(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|end| [0, 1].map(|k| self.axes[k][end * (self.axes[k].len() - 1)]))
    }

    /// The value, or the derivative of these orders along the axes. NaN outside if nothing is to be extrapolated.
    pub fn value(&self, u: [f64; 2], orders: [usize; 2]) -> f64 {
        let (Some(p), Some(q)) = (self.place(0, u[0]), self.place(1, u[1])) else { return f64::NAN };
        // On an axis with one point both corners are that point; the weight of the second one is 0.
        let m = self.axes[1].len();
        let corner =
            |i: usize, j: usize| self.points[(p.at + i).min(self.axes[0].len() - 1) * m + (q.at + j).min(m - 1)];
        let (first, second) = (self.weights(&p, orders[0]), self.weights(&q, orders[1]));
        let mut sum = 0.0;
        for i in 0..2 {
            for j in 0..2 {
                let [z, along_first, along_second, both] = corner(i, j);
                let (a, b) = (first[i], second[j]);
                sum += a[0] * b[0] * z + a[1] * b[0] * along_first + a[0] * b[1] * along_second + a[1] * b[1] * both;
            }
        }
        sum
    }

    /// The position of an argument along an axis. `None` outside if nothing is to be extrapolated.
    /// `axis` is 0 or 1.
    fn place(&self, axis: usize, u: f64) -> Option<GridPosition> {
        let x = &self.axes[axis];
        let n = x.len();
        if n == 1 {
            return Some(GridPosition { at: 0, share: 0.0, width: 1.0, beyond: 0.0, moves: false });
        }
        let (from, to) = (x[0], x[n - 1]);
        let mut inside = u;
        let (mut beyond, mut moves) = (0.0, true);
        if u < from || u > to {
            match self.extrapolation {
                Extrapolation::None => return None,
                Extrapolation::Periodic => inside = from + (u - from).rem_euclid(to - from),
                Extrapolation::Hold => {
                    inside = u.clamp(from, to);
                    moves = false;
                }
                Extrapolation::Slope => {
                    inside = u.clamp(from, to);
                    beyond = u - inside;
                }
            }
        }
        let mut at = x.partition_point(|s| *s <= inside).clamp(1, n) - 1;
        // The last point belongs to the last cell, except for steps, where it has a value of its own.
        if self.smoothness != Smoothness::Constant {
            at = at.min(n - 2);
        }
        let width = if at + 1 < n { x[at + 1] - x[at] } else { 1.0 };
        Some(GridPosition { at, share: (inside - x[at]) / width, width, beyond, moves })
    }

    /// The weights at a position: for the point before and the point after, of the value and of the slope.
    /// With an order they are derivatives by the argument.
    fn weights(&self, p: &GridPosition, order: usize) -> [[f64; 2]; 2] {
        let still = [[1.0, 0.0], [0.0, 0.0]];
        let none = [[0.0; 2]; 2];
        // A step surface, or an axis of one point: the value of the point before, with derivative 0.
        if self.smoothness == Smoothness::Constant || p.width == 1.0 && !p.moves && p.share == 0.0 {
            return if order == 0 { still } else { none };
        }
        if order > 0 && !p.moves {
            return none;
        }
        let of = |order: usize| match self.smoothness {
            Smoothness::Linear => linear(p, order),
            _ => hermite(p, order),
        };
        if p.beyond == 0.0 {
            return of(order);
        }
        // Outside, the surface continues in a straight line with the slope of its end.
        match order {
            0 => sum(of(0), of(1), p.beyond),
            1 => of(1),
            _ => none,
        }
    }
}

/// Akima's slopes at the points of a line. With one point 0, with two points the secant.
/// Axes need not be equidistant.
fn line_slopes(axis: &[f64], line: &[f64], periodic: bool) -> Vec<f64> {
    if axis.len() < 2 {
        return vec![0.0; axis.len()];
    }
    let secants: Vec<f64> = (1..axis.len()).map(|k| (line[k] - line[k - 1]) / (axis[k] - axis[k - 1])).collect();
    if secants.len() == 1 {
        return vec![secants[0]; 2];
    }
    slopes(axis, &secants, Smoothness::Akima, periodic)
}

/// `a + factor*b`, element by element.
/// Both are weights of one axis.
fn sum(a: [[f64; 2]; 2], b: [[f64; 2]; 2], factor: f64) -> [[f64; 2]; 2] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
}

/// The weights of linear interpolation, which uses no slopes.
fn linear(p: &GridPosition, order: usize) -> [[f64; 2]; 2] {
    match order {
        0 => [[1.0 - p.share, 0.0], [p.share, 0.0]],
        1 => [[-1.0 / p.width, 0.0], [1.0 / p.width, 0.0]],
        _ => [[0.0; 2]; 2],
    }
}

/// The weights of cubic Hermite interpolation. With an order their derivatives by the argument.
fn hermite(p: &GridPosition, order: usize) -> [[f64; 2]; 2] {
    let (t, h) = (p.share, p.width);
    let polynomial = |c: [f64; 4]| match order {
        0 => c[0] + t * (c[1] + t * (c[2] + t * c[3])),
        1 => (c[1] + t * (2.0 * c[2] + 3.0 * t * c[3])) / h,
        2 => (2.0 * c[2] + 6.0 * t * c[3]) / (h * h),
        3 => 6.0 * c[3] / (h * h * h),
        _ => 0.0,
    };
    let (near, far) = (polynomial([1.0, 0.0, -3.0, 2.0]), polynomial([0.0, 0.0, 3.0, -2.0]));
    let (leaving, arriving) = (polynomial([0.0, 1.0, -2.0, 1.0]), polynomial([0.0, 0.0, -1.0, 1.0]));
    [[near, h * leaving], [far, h * arriving]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(smoothness: Smoothness, extrapolation: Extrapolation, z: impl Fn(f64, f64) -> f64) -> TableSurface {
        let axes = [vec![0.0, 1.0, 3.0, 4.0], vec![-1.0, 0.0, 2.0]];
        let values: Vec<f64> =
            axes[0].iter().flat_map(|a| axes[1].iter().map(|b| z(*a, *b)).collect::<Vec<_>>()).collect();
        TableSurface::new(axes.clone(), &values, smoothness, extrapolation)
    }

    #[test]
    fn planes_stay_planes_inside_and_outside() {
        for smoothness in [Smoothness::Linear, Smoothness::Akima] {
            let plane = surface(smoothness, Extrapolation::Slope, |a, b| 1.0 + 2.0 * a - 3.0 * b);
            for u in [[0.5, 0.5], [2.9, -0.9], [-2.0, 5.0], [7.0, 0.1]] {
                assert!(
                    (plane.value(u, [0, 0]) - (1.0 + 2.0 * u[0] - 3.0 * u[1])).abs() < 1e-12,
                    "{smoothness:?} {u:?}"
                );
                assert!((plane.value(u, [1, 0]) - 2.0).abs() < 1e-12 && (plane.value(u, [0, 1]) + 3.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for smoothness in [Smoothness::Linear, Smoothness::Akima] {
            let curved = surface(smoothness, Extrapolation::Slope, |a, b| a * a - b * b * b + a * b);
            for u in [[0.4, 0.7], [2.2, -0.3], [5.0, 1.0], [-1.0, 3.0]] {
                let h = 1e-6;
                let first =
                    (curved.value([u[0] + h, u[1]], [0, 0]) - curved.value([u[0] - h, u[1]], [0, 0])) / (2.0 * h);
                let second =
                    (curved.value([u[0], u[1] + h], [0, 0]) - curved.value([u[0], u[1] - h], [0, 0])) / (2.0 * h);
                assert!((first - curved.value(u, [1, 0])).abs() < 1e-5, "{smoothness:?} {u:?}");
                assert!((second - curved.value(u, [0, 1])).abs() < 1e-5, "{smoothness:?} {u:?}");
            }
        }
    }

    #[test]
    fn outside_as_asked() {
        let z = |a: f64, b: f64| 10.0 * a + b;
        let hold = surface(Smoothness::Linear, Extrapolation::Hold, z);
        assert_eq!((hold.value([9.0, 0.0], [0, 0]), hold.value([9.0, 0.0], [1, 0])), (40.0, 0.0));
        assert!(surface(Smoothness::Linear, Extrapolation::None, z).value([9.0, 0.0], [0, 0]).is_nan());
        let steps = surface(Smoothness::Constant, Extrapolation::Hold, z);
        assert_eq!((steps.value([2.9, 1.9], [0, 0]), steps.value([4.0, 2.0], [0, 0])), (10.0, 42.0));
    }
}
