//! What `Modelica.Blocks.Types` offers for tables, by the numbers of its literals.

/// `Smoothness`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    /// Straight between points.
    Linear,
    /// Cubic with Akima's slopes.
    Akima,
    /// The value of the last point passed.
    Constant,
    /// Cubic without extrema between points, by Fritsch and Butland.
    FritschButland,
    /// The same by Steffen.
    Steffen,
    /// Akima's slopes, weighed so that level parts stay level.
    ModifiedAkima,
}

/// `Extrapolation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolation {
    /// The value of the end.
    Hold,
    /// On with the slope of the end.
    Slope,
    /// The table again and again.
    Periodic,
    /// No value.
    None,
}

/// `TimeEvents`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeEvents {
    /// At every point of the table.
    Always,
    /// At its jumps.
    Jumps,
    /// Never.
    Never,
}

impl Smoothness {
    /// By the number of the literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use Smoothness::{Akima, Constant, FritschButland, Linear, ModifiedAkima, Steffen};
        by_number([Linear, Akima, Constant, FritschButland, Steffen, ModifiedAkima], x)
    }
}

impl Extrapolation {
    /// By the number of the literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use Extrapolation::{Hold, None, Periodic, Slope};
        by_number([Hold, Slope, Periodic, None], x)
    }
}

impl TimeEvents {
    /// By the number of the literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use TimeEvents::{Always, Jumps, Never};
        by_number([Always, Jumps, Never], x)
    }
}

fn by_number<T: Copy, const N: usize>(all: [T; N], x: f64) -> Option<T> {
    let first = (1..=N).find(|k| *k as f64 == x)?;
    Some(all[first - 1])
}
