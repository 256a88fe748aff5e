//! Dimensions of quantities: products of powers of the seven base quantities of the SI.
//! `unit` computes with them, and the unit check of the crate `model` compares them.

/// The exponent 1. Exponents are counted in sixtieths, so that second to sixth roots are exact.
pub(super) const WHOLE: i16 = 60;

/// The base units, in the order in which exponents are stored and printed.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// A dimension: exponents of kilogram, metre, second, ampere, kelvin, mole and candela, in sixtieths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dimension([i16; 7]);

/// Derived units by which messages name a dimension: exponents of kg, m, s, A, K. The first that fits is taken.
const NAMED: [(&str, [i16; 5]); 16] = [
    ("N", [1, 1, -2, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0]),
    ("J", [1, 2, -2, 0, 0]),
    ("W", [1, 2, -3, 0, 0]),
    ("V", [1, 2, -3, -1, 0]),
    ("C", [0, 0, 1, 1, 0]),
    ("Ohm", [1, 2, -3, -2, 0]),
    ("F", [-1, -2, 4, 2, 0]),
    ("Wb", [1, 2, -2, -1, 0]),
    ("T", [1, 0, -2, -1, 0]),
    ("H", [1, 2, -2, -2, 0]),
    ("Pa.s", [1, -1, -1, 0, 0]),
    ("N/m", [1, 0, -2, 0, 0]),
    ("W/K", [1, 2, -3, 0, -1]),
    ("J/K", [1, 2, -2, 0, -1]),
    ("J/(kg.K)", [0, 2, -2, 0, -1]),
];

impl Dimension {
    /// The dimension of a pure number.
    pub const NONE: Dimension = Dimension([0; 7]);
    /// The dimension of time.
    pub const TIME: Dimension = Dimension::new([0, 0, 1, 0, 0, 0, 0]);

    /// A dimension from integer exponents of kg, m, s, A, K, mol, cd.
    pub const fn new(exponents: [i16; 7]) -> Self {
        let mut sixtieths = [0; 7];
        // A loop by hand, since iterators do not work in a `const fn`.
        let mut i = 0;
        while i < 7 {
            sixtieths[i] = exponents[i] * WHOLE;
            i += 1;
        }
        Dimension(sixtieths)
    }

    /// The exponents of kg, m, s, A, K, mol, cd. `None` if one is not an integer.
    pub fn whole(self) -> Option<[i16; 7]> {
        self.0.iter().all(|e| e % WHOLE == 0).then(|| self.0.map(|e| e / WHOLE))
    }

    /// True for the dimension of a pure number.
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The dimension of a product. `None` if an exponent overflows.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        self.each(other, i16::checked_add)
    }

    /// The dimension of a quotient. `None` if an exponent overflows.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.each(other, i16::checked_sub)
    }

    /// The dimension of a power. `None` if an exponent is no multiple of 1/60, or overflows.
    pub fn power(self, exponent: f64) -> Option<Dimension> {
        let mut result = [0; 7];
        for (to, from) in result.iter_mut().zip(self.0) {
            *to = power_of(from, exponent)?;
        }
        Some(Dimension(result))
    }

    /// Combines the exponents of two dimensions.
    fn each(self, other: Dimension, op: impl Fn(i16, i16) -> Option<i16>) -> Option<Dimension> {
        let mut result = [0; 7];
        for (to, (a, b)) in result.iter_mut().zip(self.0.into_iter().zip(other.0)) {
            *to = op(a, b)?;
        }
        Some(Dimension(result))
    }
}

/// An exponent in sixtieths, multiplied. `None` if the product is no whole number of sixtieths, or overflows.
pub fn power_of(sixtieths: i16, exponent: f64) -> Option<i16> {
    let product = f64::from(sixtieths) * exponent;
    let whole = product.round();
    // A third is not exact in binary, so the product may miss a whole number slightly.
    let fits = (product - whole).abs() < 1e-9 && whole.abs() <= f64::from(i16::MAX);
    #[allow(clippy::cast_possible_truncation, reason = "a whole number in the range of i16")]
    fits.then_some(whole as i16)
}

/// Prints the dimension in coherent SI units, such as `Pa`, `m3/s` or `kg/(m.s)`.
impl std::fmt::Display for Dimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let named = NAMED.iter().find(|(_, e)| *self == Dimension::new([e[0], e[1], e[2], e[3], e[4], 0, 0]));
        match named {
            Some((name, _)) => f.write_str(name),
            None => f.write_str(&self.in_base_units()),
        }
    }
}

impl Dimension {
    /// The dimension as a quotient of products of base units.
    fn in_base_units(self) -> String {
        let above: Vec<String> = self.factors(|e| e > 0).collect();
        let below: Vec<String> = self.factors(|e| e < 0).collect();
        let head = if above.is_empty() { "1".into() } else { above.join(".") };
        match below.as_slice() {
            [] => head,
            [one] => format!("{head}/{one}"),
            many => format!("{head}/({})", many.join(".")),
        }
    }

    /// The base units whose exponents are `wanted`, each with the magnitude of its exponent.
    /// The order is that of the base units.
    fn factors(self, wanted: impl Fn(i16) -> bool) -> impl Iterator<Item = String> {
        let pairs = BASE.iter().zip(self.0).filter(move |&(_, exponent)| wanted(exponent));
        pairs.map(|(name, exponent)| match exponent.abs() {
            WHOLE => (*name).to_string(),
            e if e % WHOLE == 0 => format!("{name}{}", e / WHOLE),
            // Fractions have a `^`, so that the point in them is not read as a product.
            e => format!("{name}^{}", crate::print::number(f64::from(e) / f64::from(WHOLE), Some(4))),
        })
    }
}
