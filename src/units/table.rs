//! The symbols of units and prefixes.

use super::{Dimension, Unit};

const fn d(m: i8, kg: i8, s: i8, a: i8) -> Dimension {
    Dimension([m, kg, s, a, 0, 0, 0])
}

const KELVIN: Dimension = Dimension([0, 0, 0, 0, 1, 0, 0]);
const MOLE: Dimension = Dimension([0, 0, 0, 0, 0, 1, 0]);
const CANDELA: Dimension = Dimension([0, 0, 0, 0, 0, 0, 1]);
const LENGTH: Dimension = d(1, 0, 0, 0);
const VOLUME: Dimension = d(3, 0, 0, 0);
const MASS: Dimension = d(0, 1, 0, 0);
const TIME: Dimension = d(0, 0, 1, 0);
const PRESSURE: Dimension = d(-1, 1, -2, 0);
const FORCE: Dimension = d(1, 1, -2, 0);
const ENERGY: Dimension = d(2, 1, -2, 0);
const POWER: Dimension = d(2, 1, -3, 0);
const FREQUENCY: Dimension = d(0, 0, -1, 0);
const TURN: f64 = std::f64::consts::TAU;

/// Symbol, dimension, factor, and whether SI prefixes may stand before it.
const SYMBOLS: &[(&str, Dimension, f64, bool)] = &[
    ("m", LENGTH, 1.0, true),
    ("g", MASS, 1e-3, true),
    ("s", TIME, 1.0, true),
    ("A", d(0, 0, 0, 1), 1.0, true),
    ("K", KELVIN, 1.0, true),
    ("mol", MOLE, 1.0, true),
    ("cd", CANDELA, 1.0, true),
    ("rad", Dimension::ONE, 1.0, true),
    ("sr", Dimension::ONE, 1.0, false),
    ("deg", Dimension::ONE, TURN / 360.0, false),
    ("°", Dimension::ONE, TURN / 360.0, false),
    ("rev", Dimension::ONE, TURN, false),
    ("r", Dimension::ONE, TURN, false),
    ("rpm", FREQUENCY, TURN / 60.0, false),
    ("%", Dimension::ONE, 1e-2, false),
    ("ppm", Dimension::ONE, 1e-6, false),
    ("Hz", FREQUENCY, 1.0, true),
    ("Bq", FREQUENCY, 1.0, true),
    ("N", FORCE, 1.0, true),
    ("Pa", PRESSURE, 1.0, true),
    ("bar", PRESSURE, 1e5, true),
    ("psi", PRESSURE, 6_894.757_293_168, false),
    ("atm", PRESSURE, 101_325.0, false),
    ("mmHg", PRESSURE, 133.322_387_415, false),
    ("J", ENERGY, 1.0, true),
    ("eV", ENERGY, 1.602_176_634e-19, true),
    ("Wh", ENERGY, 3600.0, true),
    ("cal", ENERGY, 4.184, true),
    ("W", POWER, 1.0, true),
    ("VA", POWER, 1.0, true),
    ("var", POWER, 1.0, true),
    ("C", d(0, 0, 1, 1), 1.0, true),
    ("V", d(2, 1, -3, -1), 1.0, true),
    ("F", d(-2, -1, 4, 2), 1.0, true),
    ("Ohm", d(2, 1, -3, -2), 1.0, true),
    ("Ω", d(2, 1, -3, -2), 1.0, true),
    ("S", d(-2, -1, 3, 2), 1.0, true),
    ("Wb", d(2, 1, -2, -1), 1.0, true),
    ("T", d(0, 1, -2, -1), 1.0, true),
    ("H", d(2, 1, -2, -2), 1.0, true),
    ("lm", CANDELA, 1.0, true),
    ("lx", Dimension([-2, 0, 0, 0, 0, 0, 1]), 1.0, true),
    ("Gy", d(2, 0, -2, 0), 1.0, true),
    ("Sv", d(2, 0, -2, 0), 1.0, true),
    ("kat", Dimension([0, 0, -1, 0, 0, 1, 0]), 1.0, true),
    ("min", TIME, 60.0, false),
    ("h", TIME, 3600.0, false),
    ("d", TIME, 86_400.0, false),
    ("l", VOLUME, 1e-3, true),
    ("L", VOLUME, 1e-3, true),
    ("t", MASS, 1e3, true),
    ("St", d(2, 0, -1, 0), 1e-4, true),
    ("P", d(-1, 1, -1, 0), 0.1, true),
    ("in", LENGTH, 0.0254, false),
    ("ft", LENGTH, 0.3048, false),
    ("lb", MASS, 0.453_592_37, false),
    ("lbf", FORCE, 4.448_221_615_260_5, false),
    ("degC", KELVIN, 1.0, false),
    ("°C", KELVIN, 1.0, false),
    ("degF", KELVIN, 5.0 / 9.0, false),
    ("°F", KELVIN, 5.0 / 9.0, false),
];

/// Prefixes; `da` stands before `d` so that the longer one is tried first.
const PREFIXES: &[(&str, f64)] = &[
    ("da", 1e1),
    ("Y", 1e24),
    ("Z", 1e21),
    ("E", 1e18),
    ("P", 1e15),
    ("T", 1e12),
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("h", 1e2),
    ("d", 1e-1),
    ("c", 1e-2),
    ("m", 1e-3),
    ("u", 1e-6),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("n", 1e-9),
    ("p", 1e-12),
    ("f", 1e-15),
    ("a", 1e-18),
    ("z", 1e-21),
    ("y", 1e-24),
];

fn offset(symbol: &str) -> f64 {
    match symbol {
        "degC" | "°C" => 273.15,
        "degF" | "°F" => 273.15 - 32.0 * 5.0 / 9.0,
        _ => 0.0,
    }
}

/// The unit of a symbol, with or without prefix; a symbol as it stands goes before a prefixed one (`min`, `Pa`).
pub(super) fn symbol(text: &str) -> Option<Unit> {
    let plain = |name: &str| SYMBOLS.iter().find(|s| s.0 == name);
    if let Some(&(name, dimension, factor, _)) = plain(text) {
        return Some(Unit { dimension, factor, offset: offset(name) });
    }
    PREFIXES.iter().find_map(|&(prefix, scale)| {
        let &(_, dimension, factor, _) = plain(text.strip_prefix(prefix)?).filter(|s| s.3)?;
        Some(Unit { dimension, factor: scale * factor, offset: 0.0 })
    })
}
