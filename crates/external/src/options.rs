//! Options of tables: the enumerations of `Modelica.Blocks.Types`, read from the numbers of their literals.
//! C functions get literals as numbers from 1, in the order of the declaration in the Modelica Standard Library.

/// `Modelica.Blocks.Types.Smoothness`: how values between points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    /// Linear between points.
    Linear,
    /// Cubic with Akima's slopes: smooth, though it may overshoot.
    Akima,
    /// The value of the last point passed, constant up to the next.
    Constant,
    /// Cubic without extrema between points, by the method of Fritsch and Butland.
    FritschButland,
    /// Cubic without extrema between points, by the method of Steffen.
    Steffen,
    /// Cubic with modified Akima slopes, weighted so that level parts stay level.
    ModifiedAkima,
}

/// `Modelica.Blocks.Types.Extrapolation`: what holds outside the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolation {
    /// The value at the end.
    Hold,
    /// A straight line with the slope of the end.
    Slope,
    /// The table repeated periodically.
    Periodic,
    /// Nothing: values outside are errors (NaN).
    None,
}

/// `Modelica.Blocks.Types.TimeEvents`: where a time table causes events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeEvents {
    /// At every point, if the curve may have a corner there.
    Always,
    /// At the ends and at jumps only.
    Jumps,
    /// Nowhere.
    Never,
}

impl Smoothness {
    /// The literal of a number. `None` if there is no such literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use Smoothness::{Akima, Constant, FritschButland, Linear, ModifiedAkima, Steffen};
        by_number([Linear, Akima, Constant, FritschButland, Steffen, ModifiedAkima], x)
    }
}

impl Extrapolation {
    /// The literal of a number. `None` if there is no such literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use Extrapolation::{Hold, None, Periodic, Slope};
        by_number([Hold, Slope, Periodic, None], x)
    }
}

impl TimeEvents {
    /// The literal of a number. `None` if there is no such literal.
    pub fn from_number(x: f64) -> Option<Self> {
        use TimeEvents::{Always, Jumps, Never};
        by_number([Always, Jumps, Never], x)
    }
}

/// The element of `all` with this number, counted from 1.
fn by_number<T: Copy, const N: usize>(all: [T; N], x: f64) -> Option<T> {
    let first = (1..=N).find(|k| *k as f64 == x)?;
    Some(all[first - 1])
}
