//! The unit symbols that are known, with their prefixes: SI units, common engineering units and labels of sensors.
//! `unit` looks up the symbols of a unit string here.

use super::Dimension;

/// The meaning of a symbol: a value x in it is `x*num*10^decade/den + offset` in coherent SI units.
/// The factor is split so that conversions between decimal multiples have no rounding error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnitSymbol {
    /// The dimension. That of an angle is 1.
    pub dimension: Dimension,
    /// The exponent of the angle: 1 for angles, else 0.
    pub angle: i16,
    /// The numerator of the factor.
    pub num: f64,
    /// The denominator of the factor.
    pub den: f64,
    /// The power of ten of the factor, kept apart so that decimal multiples convert exactly.
    pub decade: i32,
    /// The SI value of the unit's zero (K), for temperatures.
    pub offset: f64,
}

/// The SI prefixes with their powers of ten. `da` comes before `d`, because the first prefix that fits is tried first.
const PREFIXES: [(&str, i32); 22] = [
    ("da", 1),
    ("Y", 24),
    ("Z", 21),
    ("E", 18),
    ("P", 15),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
    ("a", -18),
    ("z", -21),
    ("y", -24),
];

/// A coherent SI unit.
/// Exponents are those of kg, m, s, A, K, mol, cd.
const fn si(dimension: [i16; 7]) -> UnitSymbol {
    UnitSymbol { dimension: Dimension::new(dimension), angle: 0, num: 1.0, den: 1.0, decade: 0, offset: 0.0 }
}

/// A decimal multiple of a coherent SI unit.
const fn decimal(decade: i32, dimension: [i16; 7]) -> UnitSymbol {
    UnitSymbol { decade, ..si(dimension) }
}

/// `num/den` coherent SI units.
const fn scaled(num: f64, den: f64, dimension: [i16; 7]) -> UnitSymbol {
    UnitSymbol { num, den, ..si(dimension) }
}

/// An angle of `num/den` rad.
const fn angle(num: f64, den: f64) -> UnitSymbol {
    UnitSymbol { num, den, angle: 1, ..si(ONE) }
}

/// Exponents of kg, m, s, A, K, mol, cd.
const ONE: [i16; 7] = [0; 7];
const MASS: [i16; 7] = [1, 0, 0, 0, 0, 0, 0];
const LENGTH: [i16; 7] = [0, 1, 0, 0, 0, 0, 0];
const TIME: [i16; 7] = [0, 0, 1, 0, 0, 0, 0];
const TEMPERATURE: [i16; 7] = [0, 0, 0, 0, 1, 0, 0];
const FREQUENCY: [i16; 7] = [0, 0, -1, 0, 0, 0, 0];
const VOLUME: [i16; 7] = [0, 3, 0, 0, 0, 0, 0];
const FLOW: [i16; 7] = [0, 3, -1, 0, 0, 0, 0];
const FORCE: [i16; 7] = [1, 1, -2, 0, 0, 0, 0];
const PRESSURE: [i16; 7] = [1, -1, -2, 0, 0, 0, 0];
const ENERGY: [i16; 7] = [1, 2, -2, 0, 0, 0, 0];
const POWER: [i16; 7] = [1, 2, -3, 0, 0, 0, 0];
const RESISTANCE: [i16; 7] = [1, 2, -3, -2, 0, 0, 0];
/// The angle of one revolution (rad).
const TURN: f64 = std::f64::consts::TAU;
/// The angle of half a revolution (rad).
const HALF_TURN: f64 = std::f64::consts::PI;

/// A symbol that may have a prefix.
/// `None` if it is not known, or takes no prefix.
fn prefixable(name: &str) -> Option<UnitSymbol> {
    Some(match name {
        "m" => si(LENGTH),
        "g" => decimal(-3, MASS),
        "s" => si(TIME),
        "A" => si([0, 0, 0, 1, 0, 0, 0]),
        "K" => si(TEMPERATURE),
        "mol" => si([0, 0, 0, 0, 0, 1, 0]),
        "cd" | "lm" => si([0, 0, 0, 0, 0, 0, 1]),
        "rad" => angle(1.0, 1.0),
        "sr" => si(ONE),
        "Hz" | "Bq" => si(FREQUENCY),
        "N" => si(FORCE),
        // The label of torque sensors; Modelica writes `N.m`.
        "Nm" => si(ENERGY),
        "Pa" => si(PRESSURE),
        "J" => si(ENERGY),
        "W" | "VA" | "var" => si(POWER),
        "C" => si([0, 0, 1, 1, 0, 0, 0]),
        "V" => si([1, 2, -3, -1, 0, 0, 0]),
        "F" => si([-1, -2, 4, 2, 0, 0, 0]),
        "Ohm" | "ohm" | "\u{3a9}" | "\u{2126}" => si(RESISTANCE),
        "S" => si([-1, -2, 3, 2, 0, 0, 0]),
        "Wb" => si([1, 2, -2, -1, 0, 0, 0]),
        "T" => si([1, 0, -2, -1, 0, 0, 0]),
        "H" => si([1, 2, -2, -2, 0, 0, 0]),
        "lx" => si([0, -2, 0, 0, 0, 0, 1]),
        "Gy" | "Sv" => si([0, 2, -2, 0, 0, 0, 0]),
        "kat" => si([0, 0, -1, 0, 0, 1, 0]),
        "bar" => decimal(5, PRESSURE),
        "l" | "L" => decimal(-3, VOLUME),
        "t" => decimal(3, MASS),
        "P" => decimal(-1, [1, -1, -1, 0, 0, 0, 0]),
        "St" => decimal(-4, [0, 2, -1, 0, 0, 0, 0]),
        "eV" => UnitSymbol { num: 1.602_176_634, ..decimal(-19, ENERGY) },
        "Wh" => scaled(3600.0, 1.0, ENERGY),
        "cal" => scaled(4.184, 1.0, ENERGY),
        _ => return None,
    })
}

/// A symbol that has no prefix. It takes precedence, so that `min` is a minute and not a milli-inch.
/// `None` if it is not known.
fn plain(name: &str) -> Option<UnitSymbol> {
    Some(match name {
        "1" => si(ONE),
        "min" => scaled(60.0, 1.0, TIME),
        "h" => scaled(3600.0, 1.0, TIME),
        "d" => scaled(86400.0, 1.0, TIME),
        "deg" | "\u{b0}" => angle(HALF_TURN, 180.0),
        "gon" => angle(HALF_TURN, 200.0),
        "rev" | "r" => angle(TURN, 1.0),
        "rpm" => UnitSymbol { dimension: Dimension::new(FREQUENCY), ..angle(TURN, 60.0) },
        "degC" | "\u{b0}C" => UnitSymbol { offset: 273.15, ..si(TEMPERATURE) },
        "degF" | "\u{b0}F" => UnitSymbol { offset: 459.67 * 5.0 / 9.0, ..scaled(5.0, 9.0, TEMPERATURE) },
        "degRk" => scaled(5.0, 9.0, TEMPERATURE),
        "%" => decimal(-2, ONE),
        "ppm" => decimal(-6, ONE),
        "ha" => decimal(4, [0, 2, 0, 0, 0, 0, 0]),
        "atm" => scaled(101_325.0, 1.0, PRESSURE),
        "psi" => scaled(6_894.757_293_168, 1.0, PRESSURE),
        "cc" => decimal(-6, VOLUME),
        "lpm" => UnitSymbol { den: 60.0, ..decimal(-3, FLOW) },
        // The US gallon.
        "gpm" => UnitSymbol { num: 3_785_411_784.0, den: 60.0, ..decimal(-12, FLOW) },
        "mmHg" => scaled(133.322_387_415, 1.0, PRESSURE),
        "kgf" => scaled(9.80665, 1.0, FORCE),
        "lbf" => scaled(4.448_221_615_260_5, 1.0, FORCE),
        "lb" => scaled(0.453_592_37, 1.0, MASS),
        "in" => UnitSymbol { num: 254.0, ..decimal(-4, LENGTH) },
        "ft" => UnitSymbol { num: 3048.0, ..decimal(-4, LENGTH) },
        "gal" => UnitSymbol { num: 3_785_411_784.0, ..decimal(-12, VOLUME) },
        "PS" => scaled(735.498_75, 1.0, POWER),
        "hp" => scaled(745.699_871_582, 1.0, POWER),
        _ => return None,
    })
}

/// The meaning of a symbol, with or without a prefix. `None` if it is not known.
pub(super) fn lookup(name: &str) -> Option<UnitSymbol> {
    plain(name).or_else(|| prefixable(name)).or_else(|| prefixed(name))
}

/// The meaning of a symbol with a prefix.
fn prefixed(name: &str) -> Option<UnitSymbol> {
    PREFIXES.iter().find_map(|(prefix, decade)| {
        let symbol = prefixable(name.strip_prefix(prefix)?)?;
        Some(UnitSymbol { decade: symbol.decade + decade, ..symbol })
    })
}
